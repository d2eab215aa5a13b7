#pragma once
/// What surfaces do when they touch.
#include <optional>
#include <string>
#include <vector>

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
};

/// Friction along `axis` is `ratio` times that across: scales, runners, a fur.
struct Skin {
  Vec3 axis{1, 0, 0};  ///< unit, in the collision frame
  double ratio = 1;    ///< >= 0
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
  std::optional<Skin> skin;         ///< on top of either law; it goes before fdir1
  double rolling_resistance_m = 0;  ///< torque against rolling per normal force; those of a pair add
  Vec3 belt_velocity_mps;           ///< of the surface itself, in the collision frame: a conveyor belt
  bool touches = true;              ///< false: nothing ever collides with it
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
};

}  // namespace sandlot::model
