#pragma once
/// Wheels with rollers, as files declare them.
#include "model/surface.h"

namespace sandlot::model {

/// The child of the joint is a wheel with rollers around its rim: an omni or Mecanum wheel.
///
/// model/rollers.h makes links and joints of them. These are the data of the whole wheel, so that an engine can also
/// let it roll as one body whose contact grips along the axis of the roller on the ground alone.
struct RollerWheel {
  double radius_m = 0.05;  ///< of the wheel, over the rollers
  int count = 10;          ///< rollers per row
  int rows = 1;            ///< side by side; each row is turned by a part of the pitch
  double row_spacing_m = 0.02;
  /// Of a roller's axis from the wheel's axis, about the outward radius: 90 deg an omni wheel (the axes lie along the rim),
  /// +45 and -45 deg the two kinds of Mecanum wheels.
  double angle_rad = 1.5707963267948966;
  double roller_radius_m = 0.01;  ///< at its thick middle
  double roller_length_m = 0.03;
  double roller_mass_kg = 0.01;
  double bearing_friction_Nm = 0;  ///< of each roller on its axle
  Surface surface;                 ///< of the rollers

  static void fields(auto& s, auto&& visit) {
    visit(Field{"radius", "m", "Radius of the wheel over the rollers."}, s.radius_m);
    visit(Field{"count", "1", "Rollers per row."}, s.count);
    visit(Field{"rows", "1", "Rows side by side."}, s.rows);
    visit(Field{"row_spacing", "m", "Distance of neighbouring rows."}, s.row_spacing_m);
    visit(Field{"angle", "rad", "Angle from the wheel's axis to a roller's."}, s.angle_rad);
    visit(Field{"roller_radius", "m", "Radius of a roller in its middle."}, s.roller_radius_m);
    visit(Field{"roller_length", "m", "Length of a roller."}, s.roller_length_m);
    visit(Field{"roller_mass", "kg", "Mass of a roller."}, s.roller_mass_kg);
    visit(Field{"bearing_friction", "Nm", "Friction of a roller on its axle."}, s.bearing_friction_Nm);
    visit(Field{"surface", "", "Surface of the rollers."}, s.surface);
  }
};

}  // namespace sandlot::model
