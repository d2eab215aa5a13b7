#pragma once
/// Parts of robots on wheels: wheels, forks that steer them, and bodies with marks that show the front. The
/// base's frame lies on the ground below its middle.
#include <optional>

#include "base/fields.h"
#include "builders/parts.h"

namespace sandlot::builders {

struct WheelOptions {
  std::string name;  ///< the link is name_wheel, its joint name_joint
  std::uint32_t parent = 0;
  Vec3 centre_M;
  Vec3 axis_M{0, 1, 0};
  double radius_m = 0.1, width_m = 0.05, mass_kg = 0.5;
  double max_effort_Nm = 10, max_speed_radps = 60;
  double friction = 1;
  std::optional<model::RollerWheel> rollers;
};
/// Corner of a robot on four wheels: sign of its x and y, and the beginning of its wheel's names.
struct Corner {
  const char* name;
  double x, y;
};
inline constexpr Corner corners[] = {
    {"front_left", 1, 1}, {"front_right", 1, -1}, {"rear_left", -1, 1}, {"rear_right", -1, -1}};

/// Shape of the wheels of creatures.
enum class WheelShape : std::uint8_t { balls, discs };
inline constexpr EnumName<WheelShape> wheel_shape_names[] = {{"balls", WheelShape::balls},
                                                             {"discs", WheelShape::discs}};
constexpr std::span<const EnumName<WheelShape>> enum_names(WheelShape) { return wheel_shape_names; }
/// Tyre of such a wheel, with its axle along y.
Part creature_wheel(WheelShape shape, double radius_m, double width_m, double mass_kg,
                    const model::Surface& surface = {});

/// A wheel with spokes, so that one sees it turn. Returns its joint.
std::uint32_t add_wheel(model::Model& model, const WheelOptions& options);

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
