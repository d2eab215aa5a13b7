#pragma once
/// Surface properties for contacts.
#include <optional>
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/result.h"
#include "geometry/vec3.h"

namespace sandlot::model {

/// What a surface is made of, after LpzRobots; presets are in model/substance.h, the law in
/// physics/substance.h.
struct Substance {
  double roughness = 0.8;
  double slip = 0.01;
  double hardness = 40;     ///< > 0
  double elasticity = 0.5;  ///< 0..1
  friend bool operator==(const Substance&, const Substance&) = default;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"roughness", "1", "Roughness."}, s.roughness);
    visit(Field{"slip", "1", "Slip under load."}, s.slip);
    visit(Field{"hardness", "1", "Hardness; positive."}, s.hardness);
    visit(Field{"elasticity", "1", "Elasticity.", 0, 1}, s.elasticity);
  }
};

/// Friction along `axis` is `ratio` times that across: scales, runners, a fur.
struct Skin {
  Vec3 axis{1, 0, 0};  ///< unit, in the collision frame
  double ratio = 1;    ///< >= 0

  static void fields(auto& s, auto&& visit) {
    visit(Field{"axis", "1", "Unit vector along the scales, in the collision's frame."}, s.axis);
    visit(Field{"ratio", "1", "Ratio of the friction along the axis to that across."}, s.ratio);
  }
};

/// Contact behaviour of a collision shape (SDF <surface>, <sandlot:substance> ...).
struct Surface {
  double mu = 1.0;   ///< Coulomb coefficient; pairs combine by min(), as Gazebo does
  double mu2 = 1.0;  ///< across the first friction direction
  Vec3 fdir1;        ///< first friction direction in the collision frame; zero: isotropic, aligned with slip
  double slip1 = 0, slip2 = 0;  ///< [m/(s N)] force-dependent slip
  double restitution = 0;       ///< 0..1
  double restitution_threshold_mps = 0.05;
  std::optional<double> soft_erp, soft_cfm;  ///< unset: the engine's own
  /// SDF's kp and kd: a spring with a damper in place of soft_erp and soft_cfm. Springs in series, dampers add.
  std::optional<double> stiffness_N_per_m, damping_N_s_per_m;
  std::optional<double> max_correction_mps;  ///< fastest correction of a penetration; the smaller counts
  /// Where both of a pair have one, it decides instead of all the above.
  std::optional<Substance> substance;
  std::optional<Skin> skin;         ///< on top of either law; it takes precedence over fdir1
  double rolling_resistance_m = 0;  ///< torque against rolling per normal force; those of a pair add
  Vec3 belt_velocity_mps;           ///< of the surface itself, in the collision frame: a conveyor belt
  bool touches = true;              ///< false: nothing ever collides with it

  static void fields(auto& s, auto&& visit) {
    visit(Field{"mu", "1", "Coulomb coefficient; of a pair the smaller counts."}, s.mu);
    visit(Field{"mu2", "1", "Coulomb coefficient across the first friction direction."}, s.mu2);
    visit(Field{"fdir1", "1", "First friction direction; zero: isotropic."}, s.fdir1);
    visit(Field{"slip1", "m/(s N)", "Force-dependent slip along the first direction."}, s.slip1);
    visit(Field{"slip2", "m/(s N)", "Force-dependent slip across the first direction."}, s.slip2);
    visit(Field{"restitution", "1", "Coefficient of restitution.", 0, 1}, s.restitution);
    visit(Field{"restitution_threshold", "m/s", "Speed below which impacts do not bounce."},
          s.restitution_threshold_mps);
    visit(Field{"soft_erp", "1", "Error reduction per step."}, s.soft_erp);
    visit(Field{"soft_cfm", "1", "Softness of the contact."}, s.soft_cfm);
    visit(Field{"stiffness", "N/m", "Spring of the contact."}, s.stiffness_N_per_m);
    visit(Field{"damping", "N s/m", "Damper of the contact."}, s.damping_N_s_per_m);
    visit(Field{"max_correction", "m/s", "Fastest correction of a penetration."}, s.max_correction_mps);
    visit(Field{"substance", "", "Material of the surface."}, s.substance);
    visit(Field{"skin", "", "Direction-dependent friction."}, s.skin);
    visit(Field{"rolling_resistance", "m", "Torque against rolling per normal force."},
          s.rolling_resistance_m);
    visit(Field{"belt_velocity", "m/s", "Velocity of the surface as a conveyor belt."}, s.belt_velocity_mps);
    visit(Field{"touches", "", "Whether anything collides with the surface."}, s.touches);
  }
};

/// A part of the ground with a surface of its own: wet, icy, a carpet, a belt. It holds for contacts with what stands
/// still (static models) whose points lie in the outline, seen from above. Of several the last counts.
struct SurfaceZone {
  std::string name;
  std::vector<Vec3> outline_W;  ///< a simple polygon's corners, z unused; empty: a circle
  Vec3 centre_W;                ///< of the circle
  double radius_m = 0;
  Surface surface;  ///< in place of the ground's; belt_velocity_mps in W
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the zone."}, s.name);
    visit(Field{"outline", "m", "Corners of a polygon in the world; none: a circle."}, s.outline_W);
    visit(Field{"centre", "m", "Centre of the circle in the world."}, s.centre_W);
    visit(Field{"radius", "m", "Radius of the circle."}, s.radius_m);
    visit(Field{"surface", "", "Surface in place of the ground's."}, s.surface);
  }
};

}  // namespace sandlot::model
