#include "formats/sdf/urdf.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "formats/sdf/urdf_parts.h"

namespace sandlot::formats {
namespace urdf {

Xml& add(Xml& parent, std::string name, const Xml& from, std::string text) {
  Xml& child = parent.children.emplace_back();
  child.name = std::move(name);
  child.text = std::move(text);
  child.place = from.place;
  return child;
}

Result<std::string> required(const Xml& element, const char* key, const char* example) {
  const std::string* const value = element.attribute(key);
  if (!value || trim(*value).empty())
    return element.error("<" + element.name + "> has no " + key,
                         "write " + std::string(key) + "=\"" + example + "\"");
  return *value;
}

std::vector<double> values_of(const std::string& text) {
  std::vector<double> out;
  for (const std::string_view each : split(text, ' ')) {
    double x = 0;
    if (parse_number(each, x)) out.push_back(x);
  }
  return out;
}

Result<std::string> numbers(const Xml& element, const char* key, std::size_t n, const char* fallback) {
  static constexpr const char* count[] = {"no number", "a number", "two numbers", "three numbers",
                                          "four numbers"};
  const std::string* const written = element.attribute(key);
  if (!written && fallback) return std::string(fallback);
  if (!written)
    return element.error("<" + element.name + "> has no " + key, "expected " + std::string(count[n]));
  std::string out;
  std::size_t found = 0;
  bool good = true;
  constexpr const char* blanks = " \t\r\n";
  for (std::size_t from = written->find_first_not_of(blanks); from != std::string::npos && good;) {
    const std::size_t to = std::min(written->find_first_of(blanks, from), written->size());
    const std::string word = written->substr(from, to - from);
    double x = 0;
    good = ++found <= n && parse_number(word, x) && std::isfinite(x);
    out += (out.empty() ? "" : " ") + word;
    from = written->find_first_not_of(blanks, to);
  }
  if (!good || found != n)
    return element.error(std::string(key) + " of <" + element.name + "> is '" + written->substr(0, 40) + "'",
                         "expected " + std::string(count[n]));
  return out;
}

void unused_attributes(const Xml& element, std::string_view known, Notes& notes) {
  const std::vector<std::string_view> names = split(known, ' ');
  for (const auto& [key, value] : element.attributes)
    if (key.find(':') == std::string::npos && key != "xmlns" &&
        std::find(names.begin(), names.end(), key) == names.end()) {
      std::vector<std::string> listed(names.begin(), names.end());
      notes.warn(element, "attribute '" + key.substr(0, 60) + "' of <" + element.name + "> is not used",
                 known.empty() ? "" : suggestion(key, listed));
    }
}

Status add_pose(const Xml& owner, Xml& out, Notes& notes, const char* relative_to) {
  const Xml* const origin = owner.child("origin");
  if (!origin && !relative_to) return {};
  std::string text = "0 0 0 0 0 0";
  if (origin) {
    unused_attributes(*origin, "xyz rpy", notes);
    SL_ASSIGN(const std::string xyz, numbers(*origin, "xyz", 3, "0 0 0"));
    SL_ASSIGN(const std::string rpy, numbers(*origin, "rpy", 3, "0 0 0"));
    text = xyz + " " + rpy;
  }
  Xml& pose = add(out, "pose", origin ? *origin : owner, std::move(text));
  if (relative_to) pose.set_attribute("relative_to", relative_to);
  return {};
}

namespace {

/// xacro is a language of its own: it is known by its elements, or by what stands for values.
Status refuse_xacro(const Xml& element) {
  const auto refuse = [&](const std::string& what) {
    return element.error("this is xacro, which has to be expanded first: " + what,
                         "write: xacro FILE > robot.urdf");
  };
  if (starts_with(element.name, "xacro:")) return refuse("<" + element.name.substr(0, 60) + ">");
  for (const auto& [key, value] : element.attributes)
    if (value.find("${") != std::string::npos || value.find("$(") != std::string::npos)
      return refuse(key + "=\"" + value.substr(0, 60) + "\"");
  if (element.text.find("${") != std::string::npos || element.text.find("$(find") != std::string::npos)
    return refuse(element.text.substr(0, 60));
  for (const Xml& child : element.children) SL_TRY(refuse_xacro(child));
  return {};
}

/// A name as SDF takes it.
std::string without_colons(std::string name) {
  for (std::size_t at = name.find("::"); at != std::string::npos; at = name.find("::", at))
    name.replace(at, 2, "__");
  return name;
}

Result<std::string> name_attribute(const Xml& element) {
  SL_ASSIGN(std::string name, required(element, "name", "..."));
  if (name.size() > 200) return element.error("the name of this <" + element.name + "> is too long");
  return name;
}

/// Links and joints by name; the same name twice is an error.
Status list(const Xml& robot, const char* sort, std::vector<const Xml*>& elements,
            std::map<std::string, std::size_t>& index) {
  for (const Xml& child : robot.children) {
    if (child.name != sort) continue;
    SL_ASSIGN(const std::string name, name_attribute(child));
    const auto [known, fresh] = index.emplace(name, elements.size());
    if (!fresh)
      return child.error("there are two " + std::string(sort) + "s called '" + name.substr(0, 60) + "'",
                         "the other one is in line " + std::to_string(elements[known->second]->place.line));
    elements.push_back(&child);
  }
  return {};
}

std::vector<std::string> keys_of(const std::map<std::string, std::size_t>& index) {
  std::vector<std::string> out;
  for (const auto& [name, i] : index) out.push_back(name);
  return out;
}

/// Who is whose parent.
Status connect(Robot& robot) {
  robot.parent_joint.assign(robot.links.size(), nothing);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Xml& joint = *robot.joints[j];
    const std::string said = "joint '" + joint.attribute("name")->substr(0, 60) + "'";
    std::size_t ends[2] = {nothing, nothing};
    for (const bool is_child : {false, true}) {
      const char* const key = is_child ? "child" : "parent";
      const Xml* const end = joint.child(key);
      if (!end)
        return joint.error(said + " has no <" + key + ">", "write <" + std::string(key) + " link=\"...\"/>");
      SL_ASSIGN(const std::string link, required(*end, "link", "..."));
      auto found = robot.link_index.find(link);
      if (found == robot.link_index.end() && link == "world" && !is_child)
        return end->error(said + ": there is no link 'world'", "add <link name=\"world\"/>");
      if (found == robot.link_index.end())
        return end->error(said + ": there is no link '" + link.substr(0, 60) + "'",
                          suggestion(link, keys_of(robot.link_index)));
      ends[is_child] = found->second;
    }
    if (ends[0] == ends[1]) return joint.error(said + " joins a link to itself");
    robot.parent_link.push_back(ends[0]);
    robot.child_link.push_back(ends[1]);
    std::size_t& parent = robot.parent_joint[ends[1]];
    if (parent != nothing)
      return joint.error("link '" + *robot.links[ends[1]]->attribute("name") + "' has two parent joints, '" +
                             *robot.joints[parent]->attribute("name") + "' and '" + *joint.attribute("name") +
                             "'",
                         "URDF describes trees; the other joint is in line " +
                             std::to_string(robot.joints[parent]->place.line));
    parent = j;
  }
  return {};
}

/// The one link without a parent, from which all others hang.
Status find_root(Robot& robot) {
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    if (robot.parent_joint[l] != nothing) continue;
    if (robot.root != nothing)
      return robot.links[l]->error("links '" + *robot.links[robot.root]->attribute("name") + "' and '" +
                                       *robot.links[l]->attribute("name") + "' both have no parent joint",
                                   "a robot has one root; join them, perhaps by a fixed joint");
    robot.root = l;
  }
  // A link whose way upwards does not end is in a circle, or hangs from one.
  std::vector<int> state(robot.links.size(), 0);  // 0 new, 1 on the way, 2 ends at the root
  for (std::size_t start = 0; start < robot.links.size(); ++start) {
    std::vector<std::size_t> walked;
    std::size_t at = start;
    while (at != nothing && state[at] == 0) {
      state[at] = 1;
      walked.push_back(at);
      const std::size_t joint = robot.parent_joint[at];
      at = joint == nothing ? nothing : robot.parent_link[joint];
    }
    if (at != nothing && state[at] == 1) {
      const Xml& joint = *robot.joints[robot.parent_joint[at]];
      return joint.error("link '" + *robot.links[at]->attribute("name") +
                             "' is its own ancestor, by joint '" + *joint.attribute("name") + "'",
                         "URDF describes trees");
    }
    for (const std::size_t each : walked) state[each] = 2;
  }
  robot.root_is_world = *robot.links[robot.root]->attribute("name") == "world";
  return {};
}

/// Names that are unique among links and joints together, as SDF wants them.
void name_all(Robot& robot, Notes& notes) {
  std::set<std::string> taken;
  const auto unique = [&](const Xml& element, const char* added) {
    const std::string& written = *element.attribute("name");
    std::string name = without_colons(written);
    while (taken.count(name) > 0) name += added;
    if (name != written)
      notes.warn(element,
                 element.name + " '" + written.substr(0, 60) + "' is called '" + name.substr(0, 80) + "'",
                 added == std::string("_joint") && name.find("__") == std::string::npos
                     ? "SDF has one list of names for links and joints"
                     : "'::' separates nested models in SDF");
    taken.insert(name);
    return name;
  };
  for (const Xml* const link : robot.links) robot.link_names.push_back(unique(*link, "_link"));
  for (const Xml* const joint : robot.joints) robot.joint_names.push_back(unique(*joint, "_joint"));
}

Result<Robot> index_robot(const Xml& element, Notes& notes) {
  Robot robot;
  robot.element = &element;
  SL_TRY(list(element, "link", robot.links, robot.link_index));
  SL_TRY(list(element, "joint", robot.joints, robot.joint_index));
  if (robot.links.empty()) return element.error("this robot has no link", "give it a <link>");
  SL_TRY(connect(robot));
  SL_TRY(find_root(robot));
  name_all(robot, notes);
  return robot;
}

/// The first definition of a name counts, as in the ROS parser; those of the robot go before those of visuals.
Materials list_materials(const Xml& robot) {
  Materials out;
  const auto take = [&](const Xml& material) {
    const std::string* const name = material.attribute("name");
    if (name && !name->empty() && (material.child("color") || material.child("texture")))
      out.emplace(*name, &material);
  };
  for (const Xml& child : robot.children)
    if (child.name == "material") take(child);
  for (const Xml& link : robot.children)
    if (link.name == "link")
      for (const Xml& visual : link.children)
        if (const Xml* const material = visual.name == "visual" ? visual.child("material") : nullptr)
          take(*material);
  return out;
}

Status add_limit(const Xml& joint, const std::string& type, Xml& axis, Notes& notes) {
  const Xml* const limit = joint.child("limit");
  if (!limit) {
    if (type == "continuous") return {};
    return joint.error(
        "joint '" + joint.attribute("name")->substr(0, 60) + "' has no <limit>, which a " + type +
            " joint needs",
        type == "revolute"
            ? "write <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/>, or type=\"continuous\""
            : "write <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/>");
  }
  unused_attributes(*limit, "lower upper effort velocity acceleration deceleration jerk", notes);
  Xml& out = add(axis, "limit", *limit);
  for (const char* const key : {"lower", "upper"}) {
    SL_ASSIGN(std::string value, numbers(*limit, key, 1, "0"));
    if (type != "continuous") add(out, key, *limit, std::move(value));
  }
  for (const char* const key : {"effort", "velocity"}) {
    if (!limit->attribute(key)) {
      notes.warn(*limit, "<limit> has no " + std::string(key), "taken as unlimited");
      continue;
    }
    SL_ASSIGN(std::string value, numbers(*limit, key, 1, nullptr));
    if (values_of(value).front() == 0)
      notes.warn(*limit, std::string(key) + " of <limit> is 0: no motor can move this joint",
                 "write what it can do, or a large number");
    add(out, key, *limit, std::move(value));
  }
  return {};
}

Status add_axis(const Robot& robot, const Xml& joint, const std::string& type, Xml& out, Notes& notes) {
  const Xml* const written = joint.child("axis");
  Xml& axis = add(out, "axis", written ? *written : joint);
  std::string direction = "1 0 0";
  if (written) {
    unused_attributes(*written, "xyz", notes);
    SL_ASSIGN(direction, numbers(*written, "xyz", 3, "1 0 0"));
  }
  add(axis, "xyz", written ? *written : joint, std::move(direction));
  SL_TRY(add_limit(joint, type, axis, notes));
  if (const Xml* const dynamics = joint.child("dynamics")) {
    unused_attributes(*dynamics, "damping friction", notes);
    Xml& sdf = add(axis, "dynamics", *dynamics);
    for (const char* const key : {"damping", "friction"}) {
      SL_ASSIGN(std::string value, numbers(*dynamics, key, 1, "0"));
      if (dynamics->attribute(key)) add(sdf, key, *dynamics, std::move(value));
    }
  }
  if (const Xml* const safety = joint.child("safety_controller")) {
    unused_attributes(*safety, "soft_lower_limit soft_upper_limit k_position k_velocity", notes);
    SL_TRY(required(*safety, "k_velocity", "10"));
    Xml& sdf = add(out, "sandlot:safety", *safety);
    for (const auto& [key, ours] : {std::pair{"soft_lower_limit", "soft_lower"},
                                    {"soft_upper_limit", "soft_upper"},
                                    {"k_position", "k_position"},
                                    {"k_velocity", "k_velocity"}}) {
      SL_ASSIGN(std::string value, numbers(*safety, key, 1, "0"));
      const bool limit = key[0] == 's';
      if (limit && type == "continuous" && !safety->attribute(key)) continue;
      add(sdf, ours, *safety, std::move(value));
    }
  }
  if (const Xml* const mimic = joint.child("mimic")) {
    unused_attributes(*mimic, "joint multiplier offset", notes);
    SL_ASSIGN(const std::string leader, required(*mimic, "joint", "..."));
    const auto found = robot.joint_index.find(leader);
    if (found == robot.joint_index.end())
      return mimic->error("joint '" + joint.attribute("name")->substr(0, 60) + "' mimics '" +
                              leader.substr(0, 60) + "', which is not a joint",
                          suggestion(leader, keys_of(robot.joint_index)));
    if (robot.joints[found->second] == &joint)
      return mimic->error("joint '" + leader.substr(0, 60) + "' mimics itself");
    Xml& sdf = add(axis, "mimic", *mimic);
    sdf.set_attribute("joint", robot.joint_names[found->second]);
    SL_ASSIGN(std::string multiplier, numbers(*mimic, "multiplier", 1, "1"));
    SL_ASSIGN(std::string offset, numbers(*mimic, "offset", 1, "0"));
    add(sdf, "multiplier", *mimic, std::move(multiplier));
    add(sdf, "offset", *mimic, std::move(offset));
    add(sdf, "reference", *mimic, "0");
  }
  return {};
}

/// @return the index of the joint's element in `model`, or `nothing` for a floating one
Result<std::size_t> add_joint(const Robot& robot, std::size_t j, Xml& model, Notes& notes) {
  const Xml& joint = *robot.joints[j];
  notes.unused(joint, "origin parent child axis limit dynamics mimic safety_controller", "calibration");
  unused_attributes(joint, "name type", notes);
  SL_ASSIGN(const std::string type, required(joint, "type", "revolute"));
  if (type == "floating") return nothing;
  if (type == "planar")
    return joint.error("joint '" + *joint.attribute("name") + "': planar joints are not supported",
                       "use two prismatic joints and a revolute one, with links between them");
  static const std::vector<std::string> known{"fixed",     "revolute", "continuous",
                                              "prismatic", "floating", "planar"};
  if (std::find(known.begin(), known.end(), type) == known.end())
    return joint.error(
        "joint '" + *joint.attribute("name") + "': there is no type '" + type.substr(0, 40) + "'",
        suggestion(type, known));
  Xml out;
  out.name = "joint";
  out.place = joint.place;
  out.set_attribute("name", robot.joint_names[j]);
  out.set_attribute("type", type);
  const std::size_t parent = robot.parent_link[j];
  const bool to_world = robot.root_is_world && parent == robot.root;
  add(out, "parent", *joint.child("parent"), to_world ? "world" : robot.link_names[parent]);
  add(out, "child", *joint.child("child"), robot.link_names[robot.child_link[j]]);
  if (type != "fixed") SL_TRY(add_axis(robot, joint, type, out, notes));
  model.children.push_back(std::move(out));
  return model.children.size() - 1;
}

Result<std::size_t> add_link(const Robot& robot, std::size_t l, const MassNote& mass,
                             const Materials& materials, Xml& model, Notes& notes) {
  const Xml& link = *robot.links[l];
  if (l == robot.root && robot.root_is_world) {
    for (const Xml& child : link.children)
      notes.warn(child, "<" + child.name + "> of link 'world' is not used", "that link stands for the world");
    return nothing;
  }
  Xml out;
  out.name = "link";
  out.place = link.place;
  out.set_attribute("name", robot.link_names[l]);
  if (const std::size_t j = robot.parent_joint[l]; j != nothing) {
    const std::size_t parent = robot.parent_link[j];
    const bool in_model = robot.root_is_world && parent == robot.root;
    SL_TRY(add_pose(*robot.joints[j], out, notes, in_model ? "__model__" : robot.link_names[parent].c_str()));
  }
  SL_TRY(translate_link(link, mass, materials, out, notes));
  model.children.push_back(std::move(out));
  return model.children.size() - 1;
}

Status add_sensors(const Robot& robot, Xml& model, const std::vector<std::size_t>& links, Notes& notes) {
  for (const Xml& child : robot.element->children) {
    if (child.name != "sensor") continue;
    SL_ASSIGN([[maybe_unused]] const std::string name, name_attribute(child));
    const Xml* const parent = child.child("parent");
    if (!parent)
      return child.error("sensor '" + name.substr(0, 60) + "' has no <parent>",
                         "write <parent link=\"...\"/>");
    SL_ASSIGN(const std::string link, required(*parent, "link", "..."));
    const auto found = robot.link_index.find(link);
    if (found == robot.link_index.end())
      return parent->error(
          "sensor '" + name.substr(0, 60) + "': there is no link '" + link.substr(0, 60) + "'",
          suggestion(link, keys_of(robot.link_index)));
    SL_ASSIGN(Xml sensor, translate_sensor(child, notes));
    if (links[found->second] == nothing) notes.warn(child, "a sensor of the world is not used");
    else model.children[links[found->second]].children.push_back(std::move(sensor));
  }
  return {};
}

}  // namespace
}  // namespace urdf

Result<Xml> urdf_to_sdf(const Xml& element, Notes& notes) {
  using namespace urdf;
  SL_TRY(refuse_xacro(element));
  SL_ASSIGN(const std::string name, required(element, "name", "robot"));
  unused_attributes(element, "name version", notes);
  notes.unused(element, "link* joint* material* gazebo* transmission* ros2_control* sensor*");
  SL_ASSIGN(const Robot robot, index_robot(element, notes));
  SL_ASSIGN(const std::vector<MassNote> masses, weigh(robot));
  const Materials materials = list_materials(element);

  Xml sdf;
  sdf.name = "sdf";
  sdf.place = element.place;
  sdf.set_attribute("version", "1.9");
  Xml model;
  model.name = "model";
  model.place = element.place;
  model.set_attribute("name", without_colons(name));
  if (!robot.root_is_world) model.set_attribute("canonical_link", robot.link_names[robot.root]);
  std::vector<std::size_t> links, joints;
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    SL_ASSIGN(const std::size_t at, add_link(robot, l, masses[l], materials, model, notes));
    links.push_back(at);
  }
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    SL_ASSIGN(const std::size_t at, add_joint(robot, j, model, notes));
    joints.push_back(at);
  }
  SL_TRY(add_sensors(robot, model, links, notes));
  SL_TRY(apply_extensions(robot, model, links, joints, notes));
  SL_TRY(add_drives(robot, model, notes));
  sdf.children.push_back(std::move(model));
  return sdf;
}

}  // namespace sandlot::formats
