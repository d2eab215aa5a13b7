#pragma once
/// Instance pictures of cameras that label objects: pixels hold numbers of instances.
#include <algorithm>
#include <span>

#include "devices/cameras/camera_picture.h"

namespace sandlot::cameras {

/// Object of an instance number, or null. Objects are in the order of their creation, and so of their
/// numbers.
inline const LabelledObject* labelled_object(std::span<const LabelledObject> objects,
                                             std::uint32_t instance) {
  const auto found = std::lower_bound(
      objects.begin(), objects.end(), instance,
      [](const LabelledObject& target, std::uint32_t n) { return target.instance < n; });
  return found != objects.end() && found->instance == instance ? &*found : nullptr;
}

/// Fills the plane `seen` of each camera that is due.
template <class Camera>
void draw_instances(PoolView<Camera> pool, const Context& context) {
  JobBatch batch(context);
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    optics::PictureJob job = camera.mount.job({camera.spec.near_m, camera.spec.far_m}, context);
    job.instance = camera.seen;
    batch.add(std::move(job));
  }
  batch.flush();
}

}  // namespace sandlot::cameras
