#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "base/text.h"
#include "sim/simulation.h"

namespace sandlot::app {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

const char* joint_name(model::JointType type) {
  static constexpr const char* names[] = {"fixed", "revolute",  "continuous", "prismatic",
                                          "ball",  "universal", "screw"};
  return names[static_cast<std::size_t>(type)];
}

std::string pose_text(const Pose& X) {
  const Vec3 rpy = rpy_from_quat(X.q);
  return fmt::format("[{:.4g} {:.4g} {:.4g}  {:.4g} {:.4g} {:.4g}]", X.p.x, X.p.y, X.p.z, rpy.x, rpy.y,
                     rpy.z);
}

void print_tree(const Simulation& simulation) {
  const model::Setup& setup = simulation.setup();
  fmt::print("{}: {} physics, step {} s in {} sub-steps, control every {} ticks, seed {}\n", setup.name,
             setup.engine, number_text(setup.step.s()), setup.substeps, setup.control_interval, setup.seed);
  for (const model::Instance* instance : simulation.instances()) {
    const model::Model& model = *instance->model;
    double mass_kg = 0;
    for (const model::Link& link : model.links) mass_kg += link.inertial.mass_kg;
    fmt::print("{} {}", instance->is_robot ? "robot" : model.is_static ? "static" : "object", instance->name);
    if (instance->original_name != instance->name) fmt::print(" (in the file: {})", instance->original_name);
    fmt::print(" at {}", pose_text(instance->X_WM));
    if (!model.is_static) fmt::print(", {:.4g} kg", mass_kg);
    fmt::print("\n");
    for (const model::Link& link : model.links) {
      std::vector<std::string> shapes;
      for (const model::Collision& collision : link.collisions)
        shapes.emplace_back(shape_name(collision.shape));
      fmt::print("  link {} at {}{}{}\n", link.name, pose_text(link.X_ML), shapes.empty() ? "" : ": ",
                 joined(shapes));
    }
    for (const model::Joint& joint : model.joints)
      fmt::print("  joint {} ({}): {} -> {}\n", joint.name, joint_name(joint.type),
                 joint.parent == model::world_link ? "world" : model.links[joint.parent].name,
                 model.links[joint.child].name);
    for (const auto& device : simulation.devices(instance->name)) {
      fmt::print("  device {} ({}, level {})\n", device.path, device.kind, joined(device.active_levels));
      for (const TopicBase* topic : device.topics)
        fmt::print("    publishes {} [{}]\n", topic->name(), topic->type());
      for (const TopicBase* slot : device.commands)
        fmt::print("    takes     {} [{}]\n", slot->name(), slot->type());
    }
    for (const model::ControllerDecl& controller : instance->controllers)
      fmt::print("  controller {} ({})\n", controller.name, controller.kind);
  }
}

nlohmann::ordered_json tree_json(const Simulation& simulation) {
  using Json = nlohmann::ordered_json;
  const auto vec = [](Vec3 v) { return Json{v.x, v.y, v.z}; };
  const auto pose = [&](const Pose& X) {
    return Json{{"position", vec(X.p)}, {"orientation_wxyz", {X.q.w, X.q.x, X.q.y, X.q.z}}};
  };
  const model::Setup& setup = simulation.setup();
  Json root{{"name", setup.name},
            {"physics", setup.engine},
            {"step_s", setup.step.s()},
            {"substeps", setup.substeps},
            {"control_interval", setup.control_interval},
            {"seed", setup.seed}};
  Json& instances = root["instances"] = Json::array();
  for (const model::Instance* instance : simulation.instances()) {
    const model::Model& model = *instance->model;
    Json entry{{"name", instance->name},      {"original_name", instance->original_name},
               {"robot", instance->is_robot}, {"static", model.is_static},
               {"team", instance->team},      {"pose", pose(instance->X_WM)}};
    Json links = Json::array(), joints = Json::array(), devices = Json::array(), controllers = Json::array();
    for (const model::Link& link : model.links) {
      Json shapes = Json::array();
      for (const model::Collision& collision : link.collisions) shapes.push_back(shape_name(collision.shape));
      links.push_back({{"name", link.name},
                       {"pose", pose(link.X_ML)},
                       {"mass_kg", link.inertial.mass_kg},
                       {"collisions", shapes}});
    }
    for (const model::Joint& joint : model.joints)
      joints.push_back(
          {{"name", joint.name},
           {"type", joint_name(joint.type)},
           {"parent", joint.parent == model::world_link ? "world" : model.links[joint.parent].name},
           {"child", model.links[joint.child].name}});
    for (const auto& device : simulation.devices(instance->name)) {
      Json topics = Json::object(), commands = Json::object();
      for (const TopicBase* topic : device.topics) topics[topic->name()] = topic->type();
      for (const TopicBase* slot : device.commands) commands[slot->name()] = slot->type();
      devices.push_back({{"path", device.path},
                         {"kind", device.kind},
                         {"levels", device.active_levels},
                         {"topics", topics},
                         {"commands", commands}});
    }
    for (const model::ControllerDecl& controller : instance->controllers)
      controllers.push_back({{"name", controller.name}, {"kind", controller.kind}});
    entry["links"] = links;
    entry["joints"] = joints;
    entry["devices"] = devices;
    entry["controllers"] = controllers;
    instances.push_back(std::move(entry));
  }
  return root;
}

}  // namespace

int info(const FileOptions& options) {
  for (const std::string& file : options.files) {
    Diagnostics diagnostics;
    const auto built = build(file, options, diagnostics);
    print_warnings(diagnostics);
    if (!built) return complain(built.error());
    if (options.json) fmt::print("{}\n", tree_json(**built).dump(2));
    else print_tree(**built);
  }
  return exit_ok;
}

}  // namespace sandlot::app
