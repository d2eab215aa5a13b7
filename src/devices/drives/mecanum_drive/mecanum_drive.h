#pragma once
/// Mecanum drive: four wheels that point ahead, their rollers at 45 degrees.
///
/// Frame    D: middle of the wheel joints, axes as the canonical link's. It moves along x and y and turns.
/// Levels, commands, output, motors, power and odometry: devices/drives/wheeled_base.h.
/// Geometry r phi' = vx -+ vy -+ (wheelbase + track) / 2 w, with the signs FL (-,-), FR (+,+), BL (+,-), BR
/// (-,+): rollers that,
///          seen from above, point to the middle. Where the model has rollers, their angles count
///          (model/wheel.h).
/// Errors   in addition to those of wheeled_base.h: a wheel that is not in the corner of its name; rollers
///          the wrong way round on a square chassis, which cannot turn.
/// Source   kinematics/wheels.h.
#include "devices/drives/wheeled_drive.h"

namespace sandlot::mecanum_drive {

struct Spec : wheeled::Common {
  std::string front_left_joint, front_right_joint, back_left_joint, back_right_joint;
  std::optional<double> wheelbase_m, track_m;
  double roller_angle_rad = 0.7853981633974483;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned required = Field::required;
    visit(Field{"front_left_joint", "", "Joint of the front left wheel.", 0, 0, required, 1000},
          s.front_left_joint);
    visit(Field{"front_right_joint", "", "Joint of the front right wheel.", 0, 0, required, 1000},
          s.front_right_joint);
    visit(Field{"back_left_joint", "", "Joint of the back left wheel.", 0, 0, required, 1000},
          s.back_left_joint);
    visit(Field{"back_right_joint", "", "Joint of the back right wheel.", 0, 0, required, 1000},
          s.back_right_joint);
    visit(Field{"wheelbase", "m", "Distance from the front to the back wheels; not given: from the joints.",
                1e-3, 1000},
          s.wheelbase_m);
    visit(Field{"track", "m", "Distance from the left to the right wheels; not given: from the joints.", 1e-3,
                1000},
          s.track_m);
    visit(Field{"roller_angle", "rad",
                "Angle of the rollers of FR and BL, where the model has none; FL and BR have the opposite.",
                -1.5, 1.5},
          s.roller_angle_rad);
    Common::fields(s, visit);
  }
};

struct Mecanum {
  using Spec = mecanum_drive::Spec;
  static constexpr bool has_rollers = true;
  static Result<wheeled::Base> build(const DeviceBuild& build, const Spec& spec);
};

/// SDF plugin to spec keys (from_sdf.cpp).
Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics);

extern const Kind kind;

}  // namespace sandlot::mecanum_drive
