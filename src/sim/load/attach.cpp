#include "sim/load/attach.h"

#include <algorithm>

#include "base/check.h"
#include "base/text.h"

namespace sandlot {

Status attach_module(model::Instance& robot, const model::Instance& module, const std::string& id,
                     std::uint32_t link, const Pose& X_LM) {
  SL_CHECK(link < robot.model->links.size());
  auto composed = std::make_shared<model::Model>(*robot.model);
  const model::Model& part = *module.model;
  const std::string prefix = id + "::";
  const auto first_link = static_cast<std::uint32_t>(composed->links.size());
  const auto first_joint = static_cast<std::uint32_t>(composed->joints.size());
  // The module's own pose, if its file gives it one, is where its frame stands on the mount.
  const Pose X_MP = composed->links[link].X_ML * X_LM * module.X_WM;

  for (model::Link each : part.links) {
    each.name = prefix + each.name;
    each.X_ML = X_MP * each.X_ML;
    composed->links.push_back(std::move(each));
  }
  model::Joint mount;
  mount.name = prefix + "mount";
  mount.type = model::JointType::fixed;
  mount.parent = link;
  mount.child = first_link;
  mount.place = module.place;
  for (model::Joint each : part.joints) {
    if (each.parent == model::world_link)
      return Error{"joint '" + each.name + "' of module '" + id + "' holds on to the world",
                   "a module can only hold on to its robot", each.place};
    each.name = prefix + each.name;
    each.parent += first_link;
    each.child += first_link;
    if (each.mimic) each.mimic->joint += first_joint;
    if (each.roller_of != model::Joint::no_joint) each.roller_of += first_joint;
    composed->joints.push_back(std::move(each));
  }
  composed->joints.push_back(std::move(mount));
  for (model::Frame each : part.frames) {
    each.name = prefix + each.name;
    each.link += first_link;
    composed->frames.push_back(std::move(each));
  }
  for (model::LinkLight each : part.lights) {
    each.light.name = prefix + each.light.name;
    each.link += first_link;
    composed->lights.push_back(std::move(each));
  }
  for (model::DeviceDecl each : module.devices) {
    each.scope = prefix + each.scope;
    each.name = module.devices.size() == 1 ? id : id + "_" + each.name;
    each.link += first_link;
    const auto same = std::find_if(
        robot.devices.begin(), robot.devices.end(),
        [&](const model::DeviceDecl& other) { return sanitised(other.name) == sanitised(each.name); });
    if (same != robot.devices.end())
      return Error{"two devices have the address '" + sanitised(each.name) + "'",
                   "the other one is at " + to_string(same->place) + "; give the module another id",
                   each.place};
    robot.devices.push_back(std::move(each));
  }
  robot.model = std::move(composed);
  return {};
}

}  // namespace sandlot
