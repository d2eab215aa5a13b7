#pragma once
/// What cameras share that tell things apart: a picture of instance numbers, and the things they name.
#include <algorithm>
#include <span>

#include "devices/cameras/camera_picture.h"

namespace sandlot::eye {

/// Null for what is no thing. Things stand in the order of their creation, and so of their numbers.
inline const LabelledObject* thing_of(std::span<const LabelledObject> things, std::uint32_t instance) {
  const auto found = std::lower_bound(
      things.begin(), things.end(), instance,
      [](const LabelledObject& thing, std::uint32_t n) { return thing.instance < n; });
  return found != things.end() && found->instance == instance ? &*found : nullptr;
}

/// Fills the plane `seen` of each camera that is due.
template <class Camera>
void draw_instances(PoolView<Camera> pool, const Context& context) {
  JobBatch batch(context);
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    optics::PictureJob job = camera.eye.job({camera.spec.near_m, camera.spec.far_m}, context);
    job.instance = camera.seen;
    batch.add(std::move(job));
  }
  batch.flush();
}

}  // namespace sandlot::eye
