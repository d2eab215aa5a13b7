#pragma once
/// Satellite receiver (GPS): latitude, longitude, altitude and velocity.
///
/// Frame    the antenna is the origin of the device's own pose on its link. The world's origin and heading on
///          the Earth come from the world file (<spherical_coordinates>) or the scenario; the world's plane
///          touches the WGS 84 ellipsoid there, exactly (geometry/geodesy.h).
/// Levels   `fix` (the default): sensor_msgs/NavSatFix; covariance diagonal, of the errors configured.
///          `velocity`: geometry_msgs/TwistStamped, east, north, up [m/s]. `pose`:
///          geometry_msgs/PoseWithCovarianceStamped of the canonical link in `world`, as estimated by a
///          filter that has the receiver and a compass; errors of its own: `pose:` (noise/pose_estimate.h),
///          roll and pitch true. Any of them at once; `pose` alone computes no fix.
/// Time     the end of the tick.
/// Noise    noise/channel_noise.h on east and north (`horizontal`, each with its own draw), up (`vertical`)
///          and the three velocities (`speed`). The drifting bias is a first-order Gauss-Markov process: the
///          error that atmosphere, orbits and multipath make is correlated over minutes, and averaging over
///          seconds does not help.
/// Limits   no satellites, so no dilution of precision, shadowing, loss of fix or jumps between float and
///          fixed; errors of two receivers are independent, so they do not cancel between neighbours.
/// Cost     six channels and six sine-cosine pairs per sample, no allocation.
/// Errors   a world without a place on the Earth.
/// Source   P. D. Groves, Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems, 2nd
///          ed. (2013), sec. 9.3, 9.5 (error sources, correlation times); presets: their help.
#include <optional>

#include "devices/kind.h"
#include "geometry/geodesy.h"
#include "messages/messages.h"
#include "noise/channel_noise.h"
#include "noise/pose_estimate.h"

namespace sandlot::gps {

struct Spec {
  ChannelNoiseSpec horizontal, vertical, speed;
  PoseEstimateSpec pose;
  int status = 0;
  double rate_hz = 10;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"horizontal", "m", "Errors to the east and to the north."}, s.horizontal);
    visit(Field{"vertical", "m", "Errors of the altitude."}, s.vertical);
    visit(Field{"speed", "m/s", "Errors of each component of the velocity."}, s.speed);
    visit(Field{"pose_error", "", "Errors of the level pose."}, s.pose);
    visit(
        Field{"status", "1",
              "Status of the fix. 0: fix, 1: with satellite based, 2: with ground based augmentation (RTK).",
              0, 2},
        s.status);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  ChannelNoise east, north, up, v_east, v_north, v_up;
  PoseEstimate pose;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"east", "m", "Errors to the east."}, s.east);
    visit(Field{"north", "m", "Errors to the north."}, s.north);
    visit(Field{"up", "m", "Errors of the altitude."}, s.up);
    visit(Field{"v_east", "m/s", "Errors of the velocity to the east."}, s.v_east);
    visit(Field{"v_north", "m/s", "Errors of the velocity to the north."}, s.v_north);
    visit(Field{"v_up", "m/s", "Errors of the vertical velocity."}, s.v_up);
    visit(Field{"pose_error", "", "Errors of the level pose."}, s.pose);
  }
};

struct Receiver {
  using Spec = gps::Spec;
  using State = gps::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;
  std::uint32_t base = 0;  ///< of the canonical link
  Pose X_LS;
  Quat q_EW;  ///< world in ENU
  geodesy::LocalPlane plane{{}};
  Topic<msg::NavSatFix>* fix = nullptr;
  Topic<msg::TwistStamped>* velocity = nullptr;
  Topic<msg::PoseWithCovarianceStamped>* pose = nullptr;

  static Result<Receiver> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Receiver> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::gps
