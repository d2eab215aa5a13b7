#pragma once
/// Omnidirectional drive: three or more wheels with rollers, at any places and angles.
///
/// Frame    D: middle of the wheel joints, axes as the canonical link's. It moves along x and y and turns.
/// Levels, commands, output, motors, power and odometry: devices/drives/wheeled_base.h.
/// Geometry from the joints: wheel i rolls across its joint's axis, wherever that points. The rollers' angle
/// is the model's
///          (model/wheel.h), else roller_angle for all: 90 degrees, rollers that roll across the wheel.
/// Errors   in addition to those of wheeled_base.h: wheels that together cannot move or turn the drive.
/// Source   kinematics/wheels.h.
#include "devices/drives/wheeled_drive.h"

namespace sandlot::omni_drive {

struct Spec : wheeled::Common {
  std::vector<std::string> wheel_joint;
  double roller_angle_rad = 1.5707963267948966;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"wheel_joint", "", "Joints of the wheels.", 0, 0, Field::required, 64, 3}, s.wheel_joint);
    visit(
        Field{"roller_angle", "rad",
              "Angle of the rollers' axes from the wheel's axis, where the model has no rollers.", -3.2, 3.2},
        s.roller_angle_rad);
    Common::fields(s, visit);
  }
};

struct Omni {
  using Spec = omni_drive::Spec;
  static constexpr bool has_rollers = true;
  static Result<wheeled::Base> build(const DeviceBuild& build, const Spec& spec);
};

extern const Kind kind;

}  // namespace sandlot::omni_drive
