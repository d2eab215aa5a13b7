#include "formats/sdf/model_reader.h"

#include <algorithm>
#include <map>

#include "base/text.h"

namespace sandlot::formats {
namespace {

constexpr const char* model_children = "pose static self_collide link* joint* frame* model* plugin*";
constexpr const char* silent_model_children = "allow_auto_disable enable_wind";
constexpr double unlimited = 1e16;  ///< SDF's own word for it

Result<model::JointType> joint_type(const Xml& joint) {
  static constexpr std::pair<const char*, model::JointType> types[] = {
      {"fixed", model::JointType::fixed},
      {"revolute", model::JointType::revolute},
      {"continuous", model::JointType::continuous},
      {"prismatic", model::JointType::prismatic},
      {"ball", model::JointType::ball}};
  const std::string* const text = joint.attribute("type");
  const std::string name = "joint '" + *joint.attribute("name") + "'";
  if (!text) return joint.error(name + " has no type", "write type=\"revolute\"");
  std::vector<std::string> known;
  for (const auto& [word, type] : types) {
    if (*text == word) return type;
    known.emplace_back(word);
  }
  for (const char* const later : {"universal", "screw", "revolute2", "gearbox"})
    if (*text == later) return joint.error(name + ": type '" + *text + "' is not supported yet");
  return joint.error(name + ": there is no type '" + text->substr(0, 40) + "'", suggestion(*text, known));
}

/// SDF says "no limit" as -1, an infinity or 1e16.
Status read_maximum(const Xml& limit, const char* key, double& out) {
  const Xml* const child = limit.child(key);
  if (!child) return {};
  double x = 0;
  if (parse_number(child->text, x) && (x == -1 || x == HUGE_VAL)) return out = unlimited, Status();
  SL_ASSIGN(out, read_double(*child, not_negative));
  return {};
}

Status read_bound(const Xml& limit, const char* key, double& out) {
  const Xml* const child = limit.child(key);
  if (!child) return {};
  double x = 0;
  if (parse_number(child->text, x) && std::isinf(x)) return out = x < 0 ? -unlimited : unlimited, Status();
  SL_ASSIGN(out, read_double(*child, {-unlimited, unlimited}));
  return {};
}

Status read_axis(const Xml& axis, const ResolvedFrames& frames, model::Joint& out, Notes& notes) {
  notes.unused(axis, "xyz limit dynamics", "initial_position");
  Vec3 direction{0, 0, 1};
  SL_TRY(read_child(axis, "xyz", position_range, direction));
  if (const auto resolved = frames.axes.find(&axis); resolved != frames.axes.end())
    direction = resolved->second;
  if (!(norm(direction) > 1e-6))
    return axis.child("xyz")->error("the axis of this joint is zero", "write 0 0 1");
  out.axis_J = normalised(direction);
  if (const Xml* const limit = axis.child("limit")) {
    notes.unused(*limit, "lower upper effort velocity", "stiffness dissipation");
    SL_TRY(read_bound(*limit, "lower", out.lower));
    SL_TRY(read_bound(*limit, "upper", out.upper));
    SL_TRY(read_maximum(*limit, "effort", out.max_effort));
    SL_TRY(read_maximum(*limit, "velocity", out.max_velocity));
    if (out.lower > out.upper)
      return limit->error("the lower limit " + number_text(out.lower) + " is above the upper limit " +
                          number_text(out.upper));
  }
  if (const Xml* const dynamics = axis.child("dynamics")) {
    notes.unused(*dynamics, "damping friction spring_stiffness spring_reference");
    SL_TRY(read_child(*dynamics, "damping", not_negative, out.damping));
    SL_TRY(read_child(*dynamics, "friction", not_negative, out.friction));
    SL_TRY(read_child(*dynamics, "spring_stiffness", not_negative, out.spring_stiffness));
    SL_TRY(read_child(*dynamics, "spring_reference", {-1e6, 1e6}, out.spring_reference));
  }
  return {};
}

/// Reads one top model: its own elements and those of the models nested in it.
class ModelReader {
 public:
  ModelReader(const ResolvedFrames& frames, Notes& notes) : frames_(frames), notes_(notes) {}

  Result<std::shared_ptr<const model::Model>> read(const Xml& element) {
    out_.name = *element.attribute("name");
    out_.place = element.place;
    SL_TRY(read_child(element, "static", out_.is_static));
    SL_TRY(read_child(element, "self_collide", out_.self_collide));
    SL_TRY(read_links(element, "", {}));
    if (out_.links.empty()) return element.error("model '" + out_.name + "' has no link", "give it a <link>");
    bring_to_front(element);
    for (std::uint32_t i = 0; i < out_.links.size(); ++i) index_[out_.links[i].name] = i;
    SL_TRY(read_rest(element, "", 0));
    SL_TRY(name_devices(out_));
    return std::make_shared<const model::Model>(std::move(out_));
  }

 private:
  /// The links of a model and, after them, those of the models in it. `X_MN` places the model in the top one.
  Status read_links(const Xml& element, const std::string& prefix, const Pose& X_MN) {
    for (const Xml& child : element.children) {
      if (child.name != "link") continue;
      SL_ASSIGN(model::Link link, read_link(child, frames_, out_.is_static, notes_));
      link.name = prefix + link.name;
      link.X_ML = X_MN * link.X_ML;
      out_.links.push_back(std::move(link));
    }
    for (const Xml& child : element.children) {
      if (child.name != "model") continue;
      SL_ASSIGN(const Pose X_NP, model_pose(child, frames_));
      const std::size_t before = out_.links.size();
      SL_TRY(read_links(child, prefix + *child.attribute("name") + "::", X_MN * X_NP));
      if (out_.links.size() == before)
        return child.error("model '" + *child.attribute("name") + "' has no link", "give it a <link>");
      first_links_[&child] = out_.links[before].name;
    }
    return {};
  }

  void bring_to_front(const Xml& element) {
    const std::string* const canonical = element.attribute("canonical_link");
    if (!canonical) return;
    const auto found = std::find_if(out_.links.begin(), out_.links.end(),
                                    [&](const model::Link& l) { return l.name == *canonical; });
    if (found != out_.links.end()) std::rotate(out_.links.begin(), found, found + 1);
  }

  /// Everything that refers to links.
  Status read_rest(const Xml& element, const std::string& prefix, std::uint32_t first_link) {
    notes_.unused(element, model_children, silent_model_children);
    for (const Xml& child : element.children) {
      if (child.name == "link") {
        SL_TRY(read_link_devices(child, prefix));
      } else if (child.name == "joint") {
        SL_TRY(read_joint(child, prefix));
      } else if (child.name == "frame") {
        read_frame(child, prefix);
      } else if (child.name == "plugin") {
        SL_ASSIGN(model::DeviceDecl device, read_plugin(child));
        device.link = first_link;
        add(std::move(device), prefix);
      } else if (child.name == "model") {
        SL_TRY(
            read_rest(child, prefix + *child.attribute("name") + "::", index_.at(first_links_.at(&child))));
      } else if (starts_with(child.name, "sandlot:")) {
        SL_ASSIGN(model::DeviceDecl device, read_native_device(child));
        device.link = first_link;
        if (const std::string* const link = child.attribute("link")) {
          SL_ASSIGN(device.link, link_index(child, *link, prefix));
        }
        add(std::move(device), prefix);
      }
    }
    return {};
  }

  void add(model::DeviceDecl device, const std::string& prefix) {
    device.name = prefix + device.name;
    device.scope = prefix;
    out_.devices.push_back(std::move(device));
  }

  Result<std::uint32_t> link_index(const Xml& at, const std::string& name, const std::string& prefix) const {
    const auto found = index_.find(prefix + name);
    if (found != index_.end()) return found->second;
    std::vector<std::string> known;
    for (const model::Link& link : out_.links)
      if (starts_with(link.name, prefix)) known.push_back(link.name.substr(prefix.size()));
    return at.error("no link '" + name.substr(0, 60) + "' in model '" + out_.name + "'",
                    suggestion(name, known));
  }

  Status read_link_devices(const Xml& link, const std::string& prefix) {
    const std::uint32_t index = index_.at(prefix + *link.attribute("name"));
    for (const Xml& child : link.children) {
      if (child.name == "sensor") {
        SL_ASSIGN(model::DeviceDecl device, read_sensor(child, frames_));
        device.link = index;
        add(std::move(device), prefix);
      } else if (starts_with(child.name, "sandlot:")) {
        SL_ASSIGN(model::DeviceDecl device, read_native_device(child));
        device.link = index;
        if (child.attribute("link"))
          return child.error("a device inside a <link> is mounted on it", "leave the attribute link out");
        add(std::move(device), prefix);
      }
    }
    return {};
  }

  void read_frame(const Xml& frame, const std::string& prefix) {
    const auto link = frames_.frame_links.find(&frame);
    const auto pose = frames_.poses.find(&frame);
    if (link == frames_.frame_links.end() || pose == frames_.poses.end()) return;
    const auto index = index_.find(prefix + link->second);
    if (index != index_.end())
      out_.frames.push_back({prefix + *frame.attribute("name"), index->second, pose->second});
  }

  Status read_joint(const Xml& element, const std::string& prefix) {
    notes_.unused(element, "parent child pose axis sensor*", "physics");
    model::Joint joint;
    joint.name = prefix + *element.attribute("name");
    joint.place = element.place;
    SL_ASSIGN(joint.type, joint_type(element));
    const auto end = [&](const char* key, const std::unordered_map<const Xml*, std::string>& resolved) {
      const auto found = resolved.find(&element);
      return found == resolved.end() ? element.child(key)->text : found->second;
    };
    const std::string parent = end("parent", frames_.parent_links), child = end("child", frames_.child_links);
    SL_ASSIGN(joint.child, link_index(*element.child("child"), child, prefix));
    joint.parent = model::world_link;
    if (parent != "world") { SL_ASSIGN(joint.parent, link_index(*element.child("parent"), parent, prefix)); }
    if (joint.parent == joint.child)
      return element.error("joint '" + joint.name + "' joins link '" + child + "' to itself");
    const auto pose = frames_.poses.find(&element);
    if (pose != frames_.poses.end()) {
      joint.X_CJ = pose->second;
    } else {
      SL_ASSIGN(joint.X_CJ, read_child_pose(element));
    }
    const bool turns = joint.type != model::JointType::fixed && joint.type != model::JointType::ball;
    const Xml* const axis = element.child("axis");
    if (turns && !axis)
      return element.error("joint '" + joint.name + "' has no <axis>", "write <axis><xyz>0 0 1</xyz></axis>");
    if (axis) SL_TRY(read_axis(*axis, frames_, joint, notes_));
    if (joint.type == model::JointType::continuous) {
      joint.lower = -unlimited;
      joint.upper = unlimited;
    }
    for (const Xml& each : element.children) {
      if (each.name != "sensor") continue;
      SL_ASSIGN(model::DeviceDecl device, read_sensor(each, frames_));
      device.link = joint.child;
      device.X_LS = joint.X_CJ * device.X_LS;
      device.config.set("@joint", Node::scalar(joint.name, each.place));
      add(std::move(device), prefix);
    }
    out_.joints.push_back(std::move(joint));
    return {};
  }

  const ResolvedFrames& frames_;
  Notes& notes_;
  model::Model out_;
  std::map<std::string, std::uint32_t> index_;               ///< of links
  std::unordered_map<const Xml*, std::string> first_links_;  ///< of nested models
};

}  // namespace

Result<Pose> model_pose(const Xml& element, const ResolvedFrames& frames) {
  const auto resolved = frames.poses.find(&element);
  if (resolved != frames.poses.end()) return resolved->second;
  return read_child_pose(element);
}

Result<std::shared_ptr<const model::Model>> read_model(const Xml& element, const ResolvedFrames& frames,
                                                       Notes& notes) {
  return ModelReader(frames, notes).read(element);
}

}  // namespace sandlot::formats
