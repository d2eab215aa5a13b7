#pragma once
/// The exact pose and velocity of a point on a link: what no real sensor knows.
///
/// Frame    sensor frame S: the link's frame moved by the device's own pose.
/// Output   level `pose`: nav_msgs/Odometry. Pose of S in the world (frame "world"); velocity of S's origin and
///          angular velocity of the link, relative to the world, expressed in S. Covariances are zero: exact.
/// Time     the end of the tick.
/// Noise    none, by definition.
/// Limits   none.
/// Cost     a few multiplications per sample, no allocation.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::ground_truth {

struct Spec {
  double rate_hz = 50.0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct GroundTruth {
  using Spec = ground_truth::Spec;
  using State = NoFields;
  Spec spec;
  State state;

  std::uint32_t body = 0;  ///< index of the link
  Pose X_LS;
  Topic<msg::Odometry>* odometry = nullptr;

  static Result<GroundTruth> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<GroundTruth> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::ground_truth
