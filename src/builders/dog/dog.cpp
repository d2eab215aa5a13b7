/// Four legs with a hip and a knee each. After the vierbeiner of LpzRobots: hips to 60 deg, knees to 45 deg, hips twice as strong
/// as knees.
///
/// Frame    M: middle of the trunk, x forward, y left; it stands on its four feet, knees bent.
/// Moves    motors leg by leg, left front, left rear, then right: `left_front_hip` (positive swings the leg backwards),
///          `left_front_knee` (positive bends it) [rad].
/// Senses   `joints`, `imu` in the trunk.
/// Limits   head and tail do not move; legs do not touch each other.
#include "base/math.h"
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::dog {
namespace {

struct Spec {
  double size_m = 1, mass_kg = 2, hip_power_Nm = 6, knee_power_Nm = 4, speed_radps = 5;
  double hip_limit_rad = math::pi / 3, knee_limit_rad = math::pi / 4;
  Units units = Units::si;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"size", "m", "Length of the trunk; all other lengths follow from it.", 0.02, 20}, s.size_m);
    visit(Field{"mass", "kg", "Mass of the whole robot; the legs have three tenths of it.", 1e-3, 1e4},
          s.mass_kg);
    visit(Field{"hip_power", "Nm", "Largest torque of a hip.", 0, 1e6}, s.hip_power_Nm);
    visit(Field{"knee_power", "Nm", "Largest torque of a knee.", 0, 1e6}, s.knee_power_Nm);
    visit(Field{"hip_limit", "rad", "Largest swing of a leg each way.", 0.01, 1.5}, s.hip_limit_rad);
    visit(Field{"knee_limit", "rad", "Largest angle of a knee each way.", 0.01, 1.5}, s.knee_limit_rad);
    visit(Field{"speed", "rad/s", "Fastest turn of a joint.", 0, 1e3}, s.speed_radps);
    visit(units_field, s.units);
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double size = s.size_m, half_leg = 0.22 * size, foot = 0.06 * size;
  const auto [sine, cosine] = math::sincos(0.35);  // of the bent legs at joint angle 0
  out.X_WM.p.z = 2 * half_leg * cosine + foot;
  const std::uint32_t trunk = add_link(m, "trunk", {});
  add_part(m, trunk, {Box{{size, 0.34 * size, 0.2 * size}}, {}, 0.7 * s.mass_kg, colors::wood});
  const auto ornament = [&](const Shape& shape, const Pose& X, Color color) {
    add_part(m, trunk, {.shape = shape, .X_LP = X, .color = color, .touches = false});
  };
  ornament(Box{{0.3 * size, 0.22 * size, 0.2 * size}}, {{0.62 * size, 0, 0.2 * size}, {}}, colors::wood);
  ornament(Capsule{0.03 * size, 0.3 * size},
           along(normalised(Vec3{-1, 0, 0.7}), {-0.6 * size, 0, 0.16 * size}), colors::dark);
  for (const double side : {1.0, -1.0})
    ornament(Sphere{0.03 * size}, {{0.78 * size, side * 0.07 * size, 0.25 * size}, {}}, colors::dark);
  const double leg_mass = 0.3 * s.mass_kg / 4;
  for (const double side : {1.0, -1.0})
    for (const double end : {1.0, -1.0}) {
      const std::string name = std::string(side > 0 ? "left_" : "right_") + (end > 0 ? "front" : "rear");
      const Vec3 hip{end * 0.42 * size, side * 0.28 * size, 0};
      const Vec3 back{-sine, 0, -cosine}, front{sine, 0, -cosine};
      const auto joint = [&](const char* what, std::uint32_t parent, std::uint32_t child, Vec3 at,
                             double limit, double power) {
        add_motor(m, name + what,
                  add_joint(m, name + what + "_joint", parent, child, at,
                            {.axis_M = {0, 1, 0},
                             .lower = -limit,
                             .upper = limit,
                             .max_effort = power,
                             .max_velocity = s.speed_radps}));
      };
      const std::uint32_t thigh = add_link(m, name + "_thigh", {hip, {}});
      add_part(m, thigh,
               {Capsule{0.045 * size, half_leg}, along(front, 0.5 * half_leg * front), 0.5 * leg_mass,
                colors::orange});
      joint("_hip", trunk, thigh, hip, s.hip_limit_rad, s.hip_power_Nm);
      const Vec3 knee = hip + half_leg * front;
      const std::uint32_t shin = add_link(m, name + "_shin", {knee, {}});
      add_part(m, shin,
               {Capsule{0.035 * size, half_leg}, along(back, 0.5 * half_leg * back), 0.4 * leg_mass,
                colors::yellow});
      add_part(m, shin, {Sphere{foot}, {half_leg * back, {}}, 0.1 * leg_mass, colors::dark});
      joint("_knee", thigh, shin, knee, s.knee_limit_rad, s.knee_power_Nm);
    }
  add_senses(m);
  set_units(m, s.units);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "dog",
    .help = "Four legs with a hip and a knee each.",
});

}  // namespace sandlot::builders::dog
