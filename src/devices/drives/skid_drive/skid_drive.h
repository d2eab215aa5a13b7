#pragma once
/// Skid drive: two sides of wheels that all point ahead; it turns because they slide sideways.
///
/// Frame    D: middle of the wheel joints, axes as the canonical link's. It moves along x and turns.
/// Levels, commands, output, motors, power and odometry: devices/drives/wheeled_base.h.
/// Geometry the track ratio is the factor by which it turns slower than its wheels. Not given, it is that of
/// isotropic friction while
///          turning in place, 1 + (wheelbase / track)^2 for four wheels (kinematics/skid.h). On level `ideal`
///          the wheels turn as on the ground, by the same ratio.
/// Source   kinematics/skid.h.
#include "devices/drives/wheeled_drive.h"

namespace sandlot::skid_drive {

struct Spec : wheeled::Common {
  std::vector<std::string> left_joint, right_joint;
  std::optional<double> track_m, track_ratio;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned required = Field::required;
    visit(Field{"left_joint", "", "Wheel joints on the left side.", 0, 0, required, 32, 1}, s.left_joint);
    visit(Field{"right_joint", "", "Wheel joints on the right side.", 0, 0, required, 32, 1}, s.right_joint);
    visit(Field{"track", "m", "Distance between left and right wheels; not given: from the joints.", 1e-3,
                1000},
          s.track_m);
    visit(Field{"track_ratio", "1",
                "Ratio of effective to geometric track; not given: that of isotropic friction.", 0.1, 100},
          s.track_ratio);
    Common::fields(s, visit);
  }
};

struct Skid {
  using Spec = skid_drive::Spec;
  static constexpr bool has_rollers = false;
  static Result<wheeled::Base> build(const DeviceBuild& build, const Spec& spec);
};

extern const Kind kind;

}  // namespace sandlot::skid_drive
