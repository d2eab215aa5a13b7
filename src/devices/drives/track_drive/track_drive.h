#pragma once
/// Tracked drive: two tracks; it turns because they slide sideways.
///
/// A track is the wheels that it runs over (sprockets and road wheels, all driven at one speed). Without
/// joints there are two tracks in thought that run on level `ideal` alone: what becomes of Gazebo's tracked
/// vehicles.
///
/// Frame    D: middle between the tracks, or the canonical link's origin without joints. It moves along x and
///          turns.
/// Levels, commands, output, motors, power and odometry: devices/drives/wheeled_base.h.
/// Geometry as the skid drive's. Two tracks in thought have the ratio 1 if none is given.
/// Limits   no belt between the wheels: friction acts under the wheels.
/// Source   kinematics/skid.h.
#include "devices/drives/wheeled_drive.h"

namespace sandlot::track_drive {

struct Spec : wheeled::Common {
  std::vector<std::string> left_joint, right_joint;
  std::optional<double> track_m, track_ratio;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"left_joint", "", "Joints of the wheels under the left track.", 0, 0, Field::none, 32},
          s.left_joint);
    visit(Field{"right_joint", "", "Joints of the wheels under the right track.", 0, 0, Field::none, 32},
          s.right_joint);
    visit(Field{"track", "m", "Distance between the tracks; not given: from the joints.", 1e-3, 1000},
          s.track_m);
    visit(Field{"track_ratio", "1",
                "Ratio of effective to geometric track; not given: that of isotropic friction.", 0.1, 100},
          s.track_ratio);
    Common::fields(s, visit);
  }
};

struct Tracks {
  using Spec = track_drive::Spec;
  static constexpr bool has_rollers = false;
  static Result<wheeled::Base> build(const DeviceBuild& build, const Spec& spec);
};

/// SDF plugin to spec keys (from_sdf.cpp).
Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics);

extern const Kind kind;

}  // namespace sandlot::track_drive
