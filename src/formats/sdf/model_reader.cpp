#include "formats/sdf/model_reader.h"

#include <algorithm>
#include <map>

#include "base/text.h"
#include "model/rollers.h"

namespace sandlot::formats {
namespace {

constexpr const char* model_children = "pose static self_collide link* joint* frame* model* plugin* gripper*";
constexpr const char* silent_model_children = "allow_auto_disable enable_wind";
constexpr const char* silent_actor_children =
    "allow_auto_disable enable_wind skin animation script";  ///< the script is read with the world

/// Reads one top model: its own elements and those of the models nested in it.
class ModelReader {
 public:
  explicit ModelReader(const Reading& in) : in_(in) {}

  Result<std::shared_ptr<const model::Model>> read(const Xml& element,
                                                   const std::vector<const Xml*>& world_joints) {
    out_.name = *element.attribute("name");
    out_.place = element.place;
    SL_TRY(read_child(element, "static", out_.is_static));
    SL_TRY(read_child(element, "self_collide", out_.self_collide));
    SL_TRY(read_links(element, "", {}));
    if (out_.links.empty()) return element.error("model '" + out_.name + "' has no link", "give it a <link>");
    bring_to_front(element);
    for (std::uint32_t i = 0; i < out_.links.size(); ++i)
      if (const auto [known, fresh] = index_.emplace(out_.links[i].name, i); !fresh)
        return Error{
            "the name '" + known->first + "' is given to two links",
            "the other one is at " + to_string(out_.links[known->second].place) + "; '::' stands for nesting",
            out_.links[i].place};
    SL_TRY(read_rest(element, "", 0));
    for (const Xml* const joint : world_joints)
      SL_TRY(read_joint(*joint, "", *element.attribute("name") + "::"));
    SL_TRY(connect_mimics());
    SL_TRY(model::add_rollers(out_));
    SL_TRY(name_devices(out_));
    return std::make_shared<const model::Model>(std::move(out_));
  }

 private:
  /// The links of a model and, after them, those of the models in it. `X_MN` places the model in the top one.
  Status read_links(const Xml& element, const std::string& prefix, const Pose& X_MN) {
    for (const Xml& child : element.children) {
      if (child.name != "link") continue;
      SL_ASSIGN(model::Link link, read_link(child, out_.is_static, in_));
      link.name = prefix + link.name;
      link.X_ML = X_MN * link.X_ML;
      out_.links.push_back(std::move(link));
    }
    for (const Xml& child : element.children) {
      if (child.name != "model") continue;
      SL_ASSIGN(const Pose X_NP, in_.pose(child));
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
    in_.notes.unused(element, model_children,
                     element.attribute("sandlot:actor") ? silent_actor_children : silent_model_children);
    if (const Xml* const gripper = element.child("gripper"))
      in_.notes.warn(*gripper, "<gripper> is not used", "things are held by friction alone");
    SL_TRY(hold_still(element, prefix));
    for (const Xml& child : element.children) {
      if (child.name == "link") {
        SL_TRY(read_link_devices(child, prefix));
      } else if (child.name == "joint") {
        SL_TRY(read_joint(child, prefix, ""));
      } else if (child.name == "frame") {
        read_frame(child, prefix);
      } else if (child.name == "plugin") {
        SL_ASSIGN(model::DeviceDecl device, read_plugin(child));
        if (is_label(device)) {
          if (prefix.empty()) SL_TRY(read_label(child));
          continue;
        }
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

  /// Number of a model for segmentation cameras, from Gazebo's Label plugin.
  static bool is_label(const model::DeviceDecl& plugin) { return plugin.sdf_types.front() == "plugin:Label"; }
  Status read_label(const Xml& plugin) {
    const Xml* const label = plugin.child("label");
    out_.label = label ? std::string(trim(label->text)) : "";
    if (out_.label.empty()) return plugin.error("this plugin gives no <label>", "<label>40</label>");
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
        SL_ASSIGN(model::DeviceDecl device, read_sensor(child, in_));
        device.link = index;
        add(std::move(device), prefix);
      } else if (child.name == "light") {
        SL_ASSIGN(model::Light light, read_light(child, in_));
        light.name = prefix + light.name;
        out_.lights.push_back({index, std::move(light)});
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
    const auto link = in_.frames.frame_links.find(&frame);
    const auto pose = in_.frames.poses.find(&frame);
    if (link == in_.frames.frame_links.end() || pose == in_.frames.poses.end()) return;
    const auto index = index_.find(prefix + link->second);
    if (index != index_.end())
      out_.frames.push_back({prefix + *frame.attribute("name"), index->second, pose->second});
  }

  /// A nested model may be static in one that is not: its links are then fixed to the world.
  Status hold_still(const Xml& element, const std::string& prefix) {
    bool still = false;
    SL_TRY(read_child(element, "static", still));
    if (prefix.empty() || !still || out_.is_static) return {};
    for (const Xml& child : element.children) {
      if (child.name != "link") continue;
      model::Joint joint;
      joint.name = prefix + *child.attribute("name") + "__static__";
      joint.parent = model::world_link;
      joint.child = index_.at(prefix + *child.attribute("name"));
      joint.place = child.place;
      out_.joints.push_back(std::move(joint));
    }
    return {};
  }

  /// @param scope  what the names of links begin with beyond `prefix`: a joint of the world has `model::link`
  Status read_joint(const Xml& element, const std::string& prefix, const std::string& scope) {
    model::Joint joint;
    joint.name = prefix + *element.attribute("name");
    joint.place = element.place;
    if (is_gearbox(element)) {
      in_.notes.warn(element, "joint '" + joint.name + "' is a gearbox, which does not exist here",
                     "it is left out: both links turn freely", "gearbox");
      return {};
    }
    SL_TRY(read_joint_motion(element, joint, in_));
    SL_TRY(read_safety(element, joint, in_));
    SL_TRY(read_rollers(element, joint, in_));
    const auto end = [&](const char* key, const std::unordered_map<const Xml*, std::string>& resolved) {
      const auto found = resolved.find(&element);
      return found == resolved.end() ? element.child(key)->text : found->second;
    };
    const std::string parent = end("parent", in_.frames.parent_links),
                      child = end("child", in_.frames.child_links);
    const auto link = [&](const char* key, const std::string& name) -> Result<std::uint32_t> {
      const Xml& said = *element.child(key);
      if (starts_with(name, scope)) return link_index(said, name.substr(scope.size()), prefix);
      return said.error("joint '" + joint.name + "' joins two models of the world",
                        "put both into one <model>, each as a nested model");
    };
    SL_ASSIGN(joint.child, link("child", child));
    joint.parent = model::world_link;
    if (parent != "world") { SL_ASSIGN(joint.parent, link("parent", parent)); }
    if (joint.parent == joint.child)
      return element.error("joint '" + joint.name + "' joins link '" + child + "' to itself");
    const auto index = static_cast<std::uint32_t>(out_.joints.size());
    bool fresh = joints_.emplace(joint.name, index).second;
    if (!fresh && !scope.empty()) {
      // The world and its models name their joints apart.
      joint.name = "world::" + joint.name;
      fresh = joints_.emplace(joint.name, index).second;
    }
    if (!fresh) return element.error("the name '" + joint.name + "' is given to two joints", "rename one");
    SL_ASSIGN(joint.X_CJ, in_.pose(element));
    const Xml* const mimic = descend(element, {"axis", "mimic"});
    if (mimic) mimics_.push_back({mimic, static_cast<std::uint32_t>(out_.joints.size()), prefix});
    for (const Xml& each : element.children) {
      if (each.name != "sensor") continue;
      SL_ASSIGN(model::DeviceDecl device, read_sensor(each, in_));
      device.link = joint.child;
      device.X_LS = joint.X_CJ * device.X_LS;
      device.config.set("@joint", Node::scalar(joint.name, each.place));
      add(std::move(device), prefix);
    }
    out_.joints.push_back(std::move(joint));
    return {};
  }

  /// <mimic> may name a joint that comes later.
  Status connect_mimics() {
    for (const PendingMimic& pending : mimics_) {
      const Xml& element = *pending.element;
      in_.notes.unused(element, "multiplier offset reference");
      const std::string* const name = element.attribute("joint");
      if (!name || name->empty())
        return element.error("<mimic> names no joint", "write <mimic joint=\"...\">");
      if (const std::string* const axis = element.attribute("axis"); axis && *axis == "axis2")
        return element.error("a second axis cannot be mimicked", "name a joint with one axis");
      const auto leader = joints_.find(pending.prefix + *name);
      if (leader == joints_.end()) {
        std::vector<std::string> known;
        for (const auto& [joint, index] : joints_)
          if (starts_with(joint, pending.prefix)) known.push_back(joint.substr(pending.prefix.size()));
        return element.error("no joint '" + name->substr(0, 60) + "' in model '" + out_.name + "'",
                             suggestion(*name, known));
      }
      model::Mimic mimic;
      mimic.joint = leader->second;
      SL_TRY(read_child(element, "multiplier", {-1e6, 1e6}, mimic.multiplier));
      SL_TRY(read_child(element, "offset", {-1e6, 1e6}, mimic.offset));
      SL_TRY(read_child(element, "reference", {-1e6, 1e6}, mimic.reference));
      const model::Joint& led = out_.joints[mimic.joint];
      if (led.type == model::JointType::fixed || led.type == model::JointType::ball)
        return element.error("joint '" + led.name + "' has no position that could be mimicked",
                             "name a joint that turns or slides");
      out_.joints[pending.joint].mimic = mimic;
    }
    return check_mimics();
  }
  /// Nobody may follow itself, through however many others.
  Status check_mimics() const {
    for (const PendingMimic& pending : mimics_) {
      std::size_t steps = 0;
      for (auto at = out_.joints[pending.joint].mimic; at; at = out_.joints[at->joint].mimic)
        if (at->joint == pending.joint || ++steps > max_followers)
          return pending.element->error("joint '" + out_.joints[pending.joint].name +
                                            "' follows itself, or a chain of more than 100 joints",
                                        "let one of them lead");
    }
    return {};
  }
  static constexpr std::size_t max_followers = 100;

  struct PendingMimic {
    const Xml* element;
    std::uint32_t joint;
    std::string prefix;
  };

  const Reading& in_;
  model::Model out_;
  std::map<std::string, std::uint32_t> joints_;
  std::vector<PendingMimic> mimics_;
  std::map<std::string, std::uint32_t> index_;               ///< of links
  std::unordered_map<const Xml*, std::string> first_links_;  ///< of nested models
};

}  // namespace

Result<std::shared_ptr<const model::Model>> read_model(const Xml& element,
                                                       const std::vector<const Xml*>& world_joints,
                                                       const Reading& in) {
  return ModelReader(in).read(element, world_joints);
}

}  // namespace sandlot::formats
