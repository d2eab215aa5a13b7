#pragma once
/// Steering: twists for a robot that turns on the spot, ways around discs, and objects in what a camera above the field reports.
///
/// Frame    all points and headings in the frame of the pose that is given, seen from above; z is ignored.
/// Limits   a way goes around one disc at a time: of several that overlap it may find none.
/// Cost     one or two arc tangents per call, no allocation.
#include <span>
#include <string_view>

#include "messages/messages.h"

namespace sandlot::steering {

/// Largest rates of a robot.
struct Limits {
  double speed_mps = 0.3;
  double turn_speed_radps = 2;
};

/// An area to keep out of.
struct Disc {
  Vec3 centre;
  double radius_m = 0;
};

/// The vector without its height.
constexpr Vec3 flat(Vec3 v) { return {v.x, v.y, 0}; }
/// Direction of a vector.
double heading_of(Vec3 v);
/// Unit vector in a direction.
Vec3 towards(double heading_rad);

/// The object of this name; null when the camera does not report it.
const msg::ObjectPose* find(const msg::ObjectPoseArray& world, std::string_view name);

/// Turns to a heading on the spot.
msg::Twist turn_to(const Pose& X_WB, double heading_rad, const Limits& limits);
/// Drives along a heading: turns with 3/s of the error, and is the slower the larger it is; beyond 90 degrees it stands.
msg::Twist drive_along(const Pose& X_WB, double heading_rad, const Limits& limits);
/// Drives to a point: turns to it on the spot until it is within 60 degrees, then along it, slower in the last `slow_m`.
msg::Twist drive_to(const Pose& X_WB, Vec3 point, const Limits& limits, double slow_m = 0.1);

/// Where to head for to come from `from` to `to` without entering the discs: `to` itself, or a point beside the nearest disc in
/// the way, on the shorter side. Discs around `to` are left out; from within a disc the way leads along its edge.
Vec3 way_around(Vec3 from, Vec3 to, std::span<const Disc> discs);

}  // namespace sandlot::steering
