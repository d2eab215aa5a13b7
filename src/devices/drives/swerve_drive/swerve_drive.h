#pragma once
/// Swerve drive (4WD4S): every wheel is driven and steered by itself.
///
/// Frame    D: middle of the wheel joints, axes as the canonical link's. It moves along x and y and turns:
///          stop, crab, turn on the spot and turn about a centre follow from the command.
/// Levels, commands, output, motors, power and odometry: devices/drives/wheeled_base.h.
///          A wheel takes the shorter way: it turns backward rather than round (kinematics/swerve.h). While
///          it is being steered it is driven at the part of its speed that lies along it.
/// Geometry from the joints; wheel_joint i hangs on steering_joint i.
/// Errors   in addition to those of wheeled_base.h: a wheel that hangs on no steering joint.
/// Source   kinematics/swerve.h, kinematics/kabsch.h.
#include "devices/drives/wheeled_drive.h"

namespace sandlot::swerve_drive {

struct Spec : wheeled::Common {
  std::vector<std::string> wheel_joint, steering_joint;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"wheel_joint", "", "Joints that drive the wheels.", 0, 0, Field::required, 64, 2},
          s.wheel_joint);
    visit(Field{"steering_joint", "", "Upright joints that steer them.", 0, 0, Field::required, 64, 2},
          s.steering_joint);
    steering_fields(s, visit);
    Common::fields(s, visit);
  }
};

struct Swerve {
  using Spec = swerve_drive::Spec;
  static constexpr bool has_rollers = false;
  static Result<wheeled::Base> build(const DeviceBuild& build, const Spec& spec);
};

extern const Kind kind;

}  // namespace sandlot::swerve_drive
