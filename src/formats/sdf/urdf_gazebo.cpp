#include <algorithm>
#include <cctype>

#include "base/text.h"
#include "formats/sdf/urdf_parts.h"

namespace sandlot::formats::urdf {
namespace {

/// What <gazebo> elements copy into collisions and visuals stays below this many elements together...
constexpr std::size_t max_copied = 1'000'000;
/// ...and below this many in each, since they are joined by comparing names.
constexpr std::size_t max_laid = 1000;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Finds or makes the element at a path below `parent`.
Xml& at_path(Xml& parent, std::initializer_list<const char*> path, const Xml& from) {
  Xml* here = &parent;
  for (const char* const name : path) {
    Xml* const found = here->child(name);
    here = found ? found : &add(*here, name, from);
  }
  return *here;
}

/// SDF written before version 1.7, as most <gazebo> elements are, calls relative_to frame.
void modernise_extension(Xml& element) {
  if (element.name == "pose")
    for (auto& [key, value] : element.attributes)
      if (key == "frame") key = "relative_to";
  for (Xml& child : element.children) modernise_extension(child);
}

Xml copy_of(const Xml& element) {
  Xml out = element;
  modernise_extension(out);
  return out;
}

/// Lays `over` upon `base`: children of the same name are joined, others added. What stands in `base` loses.
void lay(Xml& base, const Xml& over) {
  for (const Xml& child : over.children) {
    Xml* const present = base.child(child.name);
    if (!present) base.children.push_back(child);
    else if (child.children.empty()) present->text = child.text, present->place = child.place;
    else lay(*present, child);
  }
}

/// Element of SDF's collision for an extension, an element of <gazebo reference="link">.
struct SurfaceKey {
  const char* urdf;
  std::initializer_list<const char*> sdf;
};
const SurfaceKey surface_keys[] = {
    {"mu1", {"surface", "friction", "ode", "mu"}},
    {"mu2", {"surface", "friction", "ode", "mu2"}},
    {"fdir1", {"surface", "friction", "ode", "fdir1"}},
    {"slip1", {"surface", "friction", "ode", "slip1"}},
    {"slip2", {"surface", "friction", "ode", "slip2"}},
    {"kp", {"surface", "contact", "ode", "kp"}},
    {"kd", {"surface", "contact", "ode", "kd"}},
    {"minDepth", {"surface", "contact", "ode", "min_depth"}},
    {"maxVel", {"surface", "contact", "ode", "max_vel"}},
    {"softCfm", {"surface", "contact", "ode", "soft_cfm"}},
    {"softErp", {"surface", "contact", "ode", "soft_erp"}},
    {"maxContacts", {"max_contacts"}},
    {"laserRetro", {"laser_retro"}},
};
const SurfaceKey* surface_key(const std::string& name) {
  for (const SurfaceKey& key : surface_keys)
    if (name == key.urdf) return &key;
  return nullptr;
}

/// Element names that say something of a joint; of the rest, what a link and a joint share goes to the link.
bool is_joint_key(const std::string& name) {
  return is_one_of(name, {"springStiffness", "springReference", "stopCfm", "stopErp", "provideFeedback",
                          "implicitSpringDamper", "fudgeFactor", "cfmDamping", "preserveFixedJoint",
                          "disableFixedJointLumping", "physics"});
}

class Extensions {
 public:
  Extensions(const Robot& robot, Xml& model, const std::vector<std::size_t>& links,
             const std::vector<std::size_t>& joints, Notes& notes)
      : robot_(robot), model_(model), links_(links), joints_(joints), notes_(notes) {}

  Status apply() {
    // Links and joints are changed where they stand, so nothing may be added to the model until all is done.
    std::map<std::size_t, std::vector<const Xml*>> of_links, of_joints;
    for (const Xml& gazebo : robot_.element->children) {
      if (gazebo.name != "gazebo") continue;
      unused_attributes(gazebo, "reference", notes_);
      const std::string* const reference = gazebo.attribute("reference");
      if (!reference || trim(*reference).empty()) {
        for (const Xml& child : gazebo.children) apply_to_model(child);
        continue;
      }
      const auto link = robot_.link_index.find(*reference);
      const auto joint = robot_.joint_index.find(*reference);
      const bool has_link = link != robot_.link_index.end(), has_joint = joint != robot_.joint_index.end();
      if (!has_link && !has_joint) {
        notes_.warn(gazebo,
                    "there is no link or joint '" + reference->substr(0, 60) + "': its <gazebo> is not used",
                    near_name(*reference));
        continue;
      }
      for (const Xml& child : gazebo.children)
        if (has_joint && (!has_link || is_joint_key(child.name))) of_joints[joint->second].push_back(&child);
        else of_links[link->second].push_back(&child);
    }
    for (const auto& [l, children] : of_links) SL_TRY(apply_to_link(l, children));
    for (const auto& [j, children] : of_joints) apply_to_joint(j, children);
    for (Xml& each : added_) model_.children.push_back(std::move(each));
    return {};
  }

 private:
  /// What was meant, perhaps. Comparing names takes its time, so only the first few are helped.
  std::string near_name(const std::string& reference) {
    if (++lost_ > 20) return "";
    std::vector<std::string> known;
    for (const auto* const index : {&robot_.link_index, &robot_.joint_index})
      for (const auto& [name, i] : *index) known.push_back(name);
    return suggestion(reference, known);
  }

  void not_used(const Xml& child) {
    if (child.name.find(':') == std::string::npos)
      notes_.warn(child, "<" + child.name.substr(0, 60) + "> in <gazebo> is not used");
  }

  void apply_to_model(const Xml& child) {
    if (child.name == "plugin") add_plugin(child);
    else if (child.name == "selfCollide") added_.push_back(renamed(child, "self_collide"));
    else if (is_one_of(child.name, {"static", "self_collide", "enable_wind", "allow_auto_disable", "link",
                                    "joint", "frame", "model"}) ||
             starts_with(child.name, "sandlot:"))
      added_.push_back(copy_of(child));
    else if (!is_joint_key(child.name)) not_used(child);
  }

  void add_plugin(const Xml& child) {
    Xml plugin = copy_of(child);
    rename_joints(plugin);
    added_.push_back(std::move(plugin));
  }
  /// Joints that got another name in SDF, where a plugin names them.
  void rename_joints(Xml& element) {
    if (lower(element.name).find("joint") != std::string::npos && element.children.empty())
      if (const auto joint = robot_.joint_index.find(element.text); joint != robot_.joint_index.end())
        element.text = robot_.joint_names[joint->second];
    for (Xml& child : element.children) rename_joints(child);
  }

  static Xml renamed(const Xml& element, const char* name) {
    Xml out = element;
    out.name = name;
    return out;
  }

  Status apply_to_link(std::size_t l, const std::vector<const Xml*>& children) {
    if (links_[l] == nothing) {
      for (const Xml* const child : children)
        if (child->name == "plugin") add_plugin(*child);
        else not_used(*child);
      return {};
    }
    Xml& link = model_.children[links_[l]];
    std::map<const SurfaceKey*, const Xml*> surface;  // the last of each counts
    Xml visual, collision;
    const Xml* material = nullptr;
    for (const Xml* const each : children) {
      const Xml& child = *each;
      if (const SurfaceKey* const key = surface_key(child.name)) surface[key] = &child;
      else if (child.name == "material") material = &child;
      else if ((child.name == "visual" || child.name == "collision") && !child.attribute("name"))
        SL_TRY(gather(child, child.name == "visual" ? visual : collision));
      else if (child.name == "visual" || child.name == "collision") SL_TRY(lay_on_named(link, child));
      else if (child.name == "selfCollide") link.children.push_back(renamed(child, "self_collide"));
      else if (child.name == "turnGravityOff") SL_TRY(turn_gravity_off(link, child));
      else if (child.name == "gravity") link.children.push_back(child);
      else if (child.name == "dampingFactor") {
        Xml& decay = at_path(link, {"velocity_decay"}, child);
        add(decay, "linear", child, child.text);
        add(decay, "angular", child, child.text);
      } else if (child.name == "plugin") add_plugin(child);
      else if (is_one_of(child.name, {"sensor", "light", "velocity_decay", "self_collide", "enable_wind",
                                      "kinematic", "must_be_base_link", "audio_source", "audio_sink",
                                      "battery", "projector", "particle_emitter"}) ||
               starts_with(child.name, "sandlot:"))
        link.children.push_back(copy_of(child));
      else if (!is_joint_key(child.name)) not_used(child);
    }
    for (Xml& part : link.children) {
      if (part.name == "collision") {
        for (const SurfaceKey& key : surface_keys)
          if (const auto said = surface.find(&key); said != surface.end()) {
            Xml& target = at_path(part, key.sdf, *said->second);
            target.text = said->second->text;
            target.place = said->second->place;
          }
        SL_TRY(count(collision, link));
        lay(part, collision);
      } else if (part.name == "visual") {
        SL_TRY(count(visual, link));
        if (material) SL_TRY(apply_material(*material, part));
        lay(part, visual);
      }
    }
    return {};
  }

  Status count(const Xml& copied, const Xml& link) {
    copied_ += count_elements(copied);
    if (copied_ > max_copied)
      return link.error("the <gazebo> elements of link '" + link.attribute("name")->substr(0, 60) +
                            "' become too many elements",
                        "at most " + std::to_string(max_copied) + " are copied");
    return {};
  }

  static Status gather(const Xml& from, Xml& into) {
    if (count_elements(from) + count_elements(into) > max_laid)
      return from.error("<" + from.name + "> in <gazebo> has too many elements",
                        "at most " + std::to_string(max_laid) + " are read");
    lay(into, from);
    return {};
  }

  Status lay_on_named(Xml& link, const Xml& over) {
    copied_ += link.children.size();  // searched through
    SL_TRY(count(over, link));
    for (Xml& part : link.children)
      if (part.name == over.name && *part.attribute("name") == *over.attribute("name"))
        return gather(over, part);
    notes_.warn(over, "link '" + *link.attribute("name") + "' has no " + over.name + " '" +
                          over.attribute("name")->substr(0, 60) + "': this is not used");
    return {};
  }

  /// The name of one of Gazebo's own materials, or a material in SDF's form.
  Status apply_material(const Xml& material, Xml& visual) {
    if (!material.children.empty()) {
      std::erase_if(visual.children, [](const Xml& child) { return child.name == "material"; });
      SL_TRY(count(material, visual));
      visual.children.push_back(material);
      return {};
    }
    Xml& script = at_path(visual, {"material", "script"}, material);
    script.place = material.place;
    Xml& uri = at_path(script, {"uri"}, material);
    uri.text = "file://media/materials/scripts/gazebo.material";
    at_path(script, {"name"}, material).text = material.text;
    return {};
  }

  static Status turn_gravity_off(Xml& link, const Xml& child) {
    SL_ASSIGN(const bool off, read_flag(child));
    add(link, "gravity", child, off ? "false" : "true");
    return {};
  }

  void apply_to_joint(std::size_t j, const std::vector<const Xml*>& children) {
    for (const Xml* const each : children) {
      const Xml& child = *each;
      if (child.name == "plugin") add_plugin(child);
      if (child.name == "plugin" || joints_[j] == nothing) continue;
      Xml& joint = model_.children[joints_[j]];
      const bool moves = joint.child("axis") != nullptr;
      const auto put = [&](std::initializer_list<const char*> path) {
        Xml& target = at_path(joint, path, child);
        target.text = child.text;
        target.place = child.place;
      };
      if (child.name == "springStiffness" && moves) put({"axis", "dynamics", "spring_stiffness"});
      else if (child.name == "springReference" && moves) put({"axis", "dynamics", "spring_reference"});
      else if (child.name == "stopCfm") put({"physics", "ode", "limit", "cfm"});
      else if (child.name == "stopErp") put({"physics", "ode", "limit", "erp"});
      else if (child.name == "provideFeedback") put({"physics", "ode", "provide_feedback"});
      else if (child.name == "implicitSpringDamper") put({"physics", "ode", "implicit_spring_damper"});
      else if (child.name == "sensor" || child.name == "physics") joint.children.push_back(copy_of(child));
      else if (!is_joint_key(child.name)) not_used(child);
    }
  }

  const Robot& robot_;
  Xml& model_;
  const std::vector<std::size_t>&links_, &joints_;
  Notes& notes_;
  std::vector<Xml> added_;
  std::size_t copied_ = 0;
  int lost_ = 0;
};

// ---- transmissions ----

/// Which level of a joint_motor an interface of ROS stands for; null for others.
const char* level_of(const std::string& interface) {
  const std::string text = lower(interface);
  // A position-velocity interface is a position servo with a feed-forward.
  if (text.find("pos") != std::string::npos) return "position";
  if (text.find("vel") != std::string::npos) return "velocity";
  if (text.find("effort") != std::string::npos) return "effort";
  return nullptr;
}

struct Commanded {
  bool by_ros_control = false;
  std::set<std::string> joints;  ///< named by plugins that command something
};

void collect_texts(const Xml& element, std::set<std::string>& out) {
  if (!element.text.empty()) out.insert(element.text);
  for (const Xml& child : element.children) collect_texts(child, out);
}

Commanded commanded_by_plugins(const Xml& model) {
  Commanded out;
  for (const Xml& child : model.children) {
    if (child.name != "plugin") continue;
    std::string name;
    for (const char* const key : {"name", "filename"})
      if (const std::string* const value = child.attribute(key)) name += lower(*value) + " ";
    if (name.find("ros_control") != std::string::npos || name.find("ros2_control") != std::string::npos)
      out.by_ros_control = true;
    if (name.find("state") == std::string::npos)
      collect_texts(child, out.joints);  // publishers of states only look
  }
  return out;
}

class Drives {
 public:
  Drives(const Robot& robot, Xml& model, Notes& notes) : robot_(robot), model_(model), notes_(notes) {
    commanded_ = commanded_by_plugins(model);
    for (const Xml& child : model.children) {
      if (child.name == "sandlot:device") take_name(child);
      for (const Xml& part : child.children)
        if (part.name == "sensor" || part.name == "sandlot:device") take_name(part);
    }
  }

  Status add_all() {
    for (const Xml& child : robot_.element->children) {
      if (child.name == "transmission") SL_TRY(add_transmission(child));
      if (child.name == "ros2_control") SL_TRY(add_ros2_control(child));
    }
    return {};
  }

 private:
  void take_name(const Xml& element) {
    if (const std::string* const name = element.attribute("name")) names_.insert(sanitised(*name));
  }

  Status add_transmission(const Xml& transmission) {
    notes_.unused(transmission, "type joint* actuator*", "leftActuator rightActuator flexJoint rollJoint");
    const Xml* const type = transmission.child("type");
    const std::string* const old_type = transmission.attribute("type");
    const std::string said = type ? type->text : old_type ? *old_type : "";
    if (lower(said).find("simple") == std::string::npos) {
      notes_.warn(transmission, "transmissions of type '" + said.substr(0, 80) + "' are not used",
                  "simple ones are: transmission_interface/SimpleTransmission");
      return {};
    }
    for (const Xml& joint : transmission.children) {
      if (joint.name != "joint") continue;
      // Old files say it of the actuator.
      const Xml* interface = joint.child("hardwareInterface");
      const Xml* const actuator = transmission.child("actuator");
      if (!interface && actuator) interface = actuator->child("hardwareInterface");
      const char* const level = interface ? level_of(interface->text) : nullptr;
      if (!level) {
        notes_.warn(
            interface ? *interface : joint,
            "this transmission has no hardwareInterface for position, velocity or effort: it is not used",
            "write hardware_interface/EffortJointInterface");
        continue;
      }
      SL_TRY(add_motor(joint, level));
    }
    return {};
  }

  Status add_ros2_control(const Xml& system) {
    for (const Xml& joint : system.children) {
      if (joint.name != "joint") continue;
      for (const Xml& interface : joint.children) {
        const std::string* const name = interface.attribute("name");
        const char* const level = interface.name == "command_interface" && name ? level_of(*name) : nullptr;
        if (!level) continue;
        SL_TRY(add_motor(joint, level));
        break;  // the first one; the others can be asked for as levels of the same device
      }
    }
    return {};
  }

  Status add_motor(const Xml& joint, const char* level) {
    SL_ASSIGN(const std::string name, required(joint, "name", "..."));
    const auto found = robot_.joint_index.find(name);
    if (found == robot_.joint_index.end()) {
      std::vector<std::string> known;
      for (const auto& [key, i] : robot_.joint_index) known.push_back(key);
      return joint.error("there is no joint '" + name.substr(0, 60) + "'", suggestion(name, known));
    }
    const std::string& sdf_name = robot_.joint_names[found->second];
    const std::string type = *robot_.joints[found->second]->attribute("type");
    const bool moves = type == "revolute" || type == "continuous" || type == "prismatic";
    if (!moves || commanded_.by_ros_control || commanded_.joints.count(sdf_name) > 0) return {};
    if (!driven_.insert(found->second).second) return {};
    std::string device = sdf_name;
    while (!names_.insert(sanitised(device)).second) device += "_motor";
    Xml& motor = add(model_, "sandlot:device", joint);
    motor.set_attribute("name", device);
    motor.set_attribute("kind", "joint_motor");
    motor.set_attribute("link", robot_.link_names[robot_.child_link[found->second]]);
    add(motor, "joint", joint, sdf_name);
    add(motor, "level", joint, level);
    return {};
  }

  const Robot& robot_;
  Xml& model_;
  Notes& notes_;
  Commanded commanded_;
  std::set<std::string> names_;  ///< of other devices, as addresses
  std::set<std::size_t> driven_;
};

}  // namespace

Status apply_extensions(const Robot& robot, Xml& model, const std::vector<std::size_t>& links,
                        const std::vector<std::size_t>& joints, Notes& notes) {
  return Extensions(robot, model, links, joints, notes).apply();
}

Status add_drives(const Robot& robot, Xml& model, Notes& notes) {
  return Drives(robot, model, notes).add_all();
}

}  // namespace sandlot::formats::urdf
