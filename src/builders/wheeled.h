#pragma once
/// What the robots that show drives have in common: a base whose frame lies on the ground below its middle, wheels, and marks
/// that tell front from rear.
#include <optional>

#include "builders/parts.h"

namespace sandlot::builders {

struct WheelWords {
  std::string name;  ///< the link is name_wheel, its joint name_joint
  std::uint32_t parent = 0;
  Vec3 centre_M;
  Vec3 axis_M{0, 1, 0};
  double radius_m = 0.1, width_m = 0.05, mass_kg = 0.5;
  double max_effort_Nm = 10, max_speed_radps = 60;
  double friction = 1;
  std::optional<model::RollerWheel> rollers;
};
/// A wheel with spokes, so that one sees it turn. Returns its joint.
std::uint32_t add_wheel(model::Model& model, const WheelWords& words);

/// A body of a robot: a box from `low_z` up, with a light deck, a nose and two lamps at its front.
void add_box_body(model::Model& model, std::uint32_t base, Vec3 size_m, double low_z_m, double mass_kg,
                  Color color);
/// The same, round.
void add_round_body(model::Model& model, std::uint32_t base, double radius_m, double height_m, double low_z_m,
                    double mass_kg, Color color);
/// An upright link at `pivot_M` for a wheel that is steered, and its joint: name_steering.
std::uint32_t add_steering(model::Model& model, const std::string& name, std::uint32_t base, Vec3 pivot_M,
                           double limit_rad, double wheel_radius_m, double mass_kg);

}  // namespace sandlot::builders
