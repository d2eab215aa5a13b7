#pragma once
/// Ray query of range sensors: a fan of rays from one pose. Answered in batches by the planar engine's
/// grid or by the ray scene (optics), so a device does not know which physics runs.
#include <cstdint>
#include <limits>
#include <span>

#include "geometry/pose.h"

namespace sandlot {

/// A fan of rays that leave one point together.
struct RayJob {
  Pose X_WS;                         ///< sensor frame in the world
  std::span<const Vec3> directions;  ///< unit vectors in S
  double min_m = 0;                  ///< nearer surfaces are not seen at all (rays start there)
  double max_m = 0;                  ///< farther surfaces are not seen
  std::uint32_t ignore_body =
      std::numeric_limits<std::uint32_t>::max();  ///< index of the body that carries the sensor
  std::span<float> distance_m;    ///< out, one per direction: distance, or +inf where nothing is hit
  std::span<std::uint32_t> body;  ///< out, optional (empty): index of the body hit, or no_body
};

inline constexpr std::uint32_t no_body = std::numeric_limits<std::uint32_t>::max();

/// Answers ray jobs against the world as it was at the last scene update.
class RayCaster {
 public:
  virtual ~RayCaster() = default;
  /// Thread-safe: called from several threads with disjoint jobs. The answer depends on the job alone.
  virtual void cast(std::span<const RayJob> jobs) const = 0;
};

}  // namespace sandlot
