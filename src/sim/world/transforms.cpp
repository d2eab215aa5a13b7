#include "sim/world/transforms.h"

#include <algorithm>

#include "sim/world/simulation.h"

namespace sandlot {
namespace {

void set(msg::TransformStamped& out, Time now, std::string_view parent, std::string_view child,
         const Pose& X) {
  out.header.stamp = now;
  out.header.frame_id = parent;
  out.child_frame_id = child;
  out.transform.translation = X.p;
  out.transform.rotation = X.q;
}

}  // namespace

void transforms_of(const Frame& frame, msg::TFMessage& out) {
  std::size_t used = 0;
  const auto next = [&]() -> msg::TransformStamped& {
    if (used == out.transforms.size()) out.transforms.emplace_back();
    return out.transforms[used++];
  };
  std::string parent, child;
  for (const FrameInstance& instance : frame.instances) {
    if (instance.model->is_static || instance.X_WL.empty()) continue;
    const auto& links = instance.model->links;
    parent.assign(instance.name).append("/").append(links.front().name);
    set(next(), frame.now, "world", parent, instance.X_WL.front());
    const Pose X_BW = inverse(instance.X_WL.front());
    for (std::size_t i = 1; i < std::min(links.size(), instance.X_WL.size()); ++i) {
      child.assign(instance.name).append("/").append(links[i].name);
      set(next(), frame.now, parent, child, X_BW * instance.X_WL[i]);
    }
  }
  out.transforms.resize(used);
}

msg::TFMessage static_transforms(const Simulation& simulation) {
  msg::TFMessage message;
  const Time now = simulation.now();
  for (const auto& entity : simulation.entities()) {
    const model::Instance& instance = entity->instance;
    const auto& links = instance.model->links;
    const auto frame_of = [&](std::size_t link) { return instance.name + "/" + links[link].name; };
    if (instance.model->is_static) {
      const Pose X_WM = simulation.engine().pose(entity->id);  // somebody may have put it elsewhere
      for (std::size_t i = 0; i < links.size(); ++i)
        set(message.transforms.emplace_back(), now, "world", frame_of(i), X_WM * links[i].X_ML);
    }
    for (const auto& device : entity->devices) {
      // A device named as a link would have two parents; the link's place is the better one.
      const bool taken = std::any_of(links.begin(), links.end(), [&](const model::Link& l) {
        return instance.name + "/" + l.name == device->path;
      });
      if (!taken)
        set(message.transforms.emplace_back(), now, frame_of(device->decl.link), device->path,
            device->decl.X_LS);
      for (const auto& [name, X_SF] : device->frames())
        set(message.transforms.emplace_back(), now, device->path, name, X_SF);
    }
  }
  return message;
}

}  // namespace sandlot
