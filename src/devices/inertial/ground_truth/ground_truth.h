#pragma once
/// The pose and velocity of a point on a link: exact, what no real sensor knows, or with errors, as a camera
/// above the field or a motion capture system measures it.
///
/// Frame    sensor frame S: the link's frame moved by the device's own pose.
/// Output   level `pose`: nav_msgs/Odometry. Pose of S in the world (frame "world"); velocity of S's origin
///          and angular velocity of the link, relative to the world, expressed in S. Covariances are zero.
/// Time     the end of the tick.
/// Noise    none by default; else noise/chain.h on each of x, y, z, of roll, pitch, yaw and of the components
///          of the velocities, one chain for three of them. A latency or drop-outs with `whole` that all
///          parts shall share must be given to all of them.
/// Limits   none.
/// Cost     a few multiplications per sample, no allocation.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/chain.h"

namespace sandlot::ground_truth {

struct NoiseSpec {
  ChainSpec position, orientation, velocity, angular_velocity;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"position", "m", "Errors of x, y and z."}, s.position);
    visit(Field{"orientation", "rad", "Errors of roll, pitch and yaw."}, s.orientation);
    visit(Field{"velocity", "m/s", "Errors of the velocity's three components."}, s.velocity);
    visit(Field{"angular_velocity", "rad/s", "Errors of the angular velocity's three components."},
          s.angular_velocity);
  }
};

struct Spec {
  double rate_hz = 50.0;
  NoiseSpec noise;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"noise", "", "Errors of pose and velocity."}, s.noise);
    visit(errors_field, s.errors);
  }
};

/// The chains of three components.
struct Axes {
  ChannelChain x, y, z;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "", "Error of x, or of roll."}, s.x);
    visit(Field{"y", "", "Error of y, or of pitch."}, s.y);
    visit(Field{"z", "", "Error of z, or of yaw."}, s.z);
  }
};

struct State {
  Axes position, orientation, velocity, angular_velocity;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"position", "", "Errors of the position."}, s.position);
    visit(Field{"orientation", "", "Errors of the orientation."}, s.orientation);
    visit(Field{"velocity", "", "Errors of the velocity."}, s.velocity);
    visit(Field{"angular_velocity", "", "Errors of the angular velocity."}, s.angular_velocity);
  }
};

struct GroundTruth {
  using Spec = ground_truth::Spec;
  using State = ground_truth::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;  ///< index of the link
  Pose X_LS;
  Topic<msg::Odometry>* odometry = nullptr;

  static Result<GroundTruth> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<GroundTruth> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::ground_truth
