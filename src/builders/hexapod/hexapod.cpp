/// Six legs on two servo joints each. After the hexapod of LpzRobots: size 1, mass 1, legs 0.6, motor power
/// 1, joints to 45 deg to front and back and 22.5 deg up and down; with `knees` a third joint of power 1.2.
///
/// Frame    M: middle of the body, x forward, y left; it stands on its six feet.
/// Moves    motors leg by leg, left front, middle, rear, then right: `left_front_swing` (positive moves the
///          foot backwards), `left_front_lift` (positive lifts it) and with knees `left_front_knee` (positive
///          stretches outwards) [rad].
/// Senses   `joints`, `imu`.
/// Limits   legs do not touch each other; a swing axis is a light link without geometry.
#include "base/math.h"
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::hexapod {
namespace {

struct Spec {
  double size_m = 1, mass_kg = 1, leg_length_m = 0.6, power_Nm = 2, knee_power_Nm = 1.2, speed_radps = 5;
  double swing_limit_rad = math::pi / 4, lift_limit_rad = math::pi / 8;
  double spread_rad = math::pi / 6;
  bool knees = false;
  Units units = Units::si;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"size", "m", "Length of the body.", 0.02, 20}, s.size_m);
    visit(Field{"mass", "kg", "Mass of the whole robot; the legs have three tenths of it.", 1e-3, 1e4},
          s.mass_kg);
    visit(Field{"leg_length", "m", "Length of a leg from hip to foot.", 0.01, 10}, s.leg_length_m);
    visit(Field{"spread", "rad", "Angle between the legs and straight down.", 0, 1.4}, s.spread_rad);
    visit(Field{"power", "Nm", "Largest torque at the hip.", 0, 1e6}, s.power_Nm);
    visit(Field{"speed", "rad/s", "Fastest turn of a joint.", 0, 1e3}, s.speed_radps);
    visit(Field{"swing_limit", "rad", "Largest swing of a leg each way.", 0.01, 1.5}, s.swing_limit_rad);
    visit(Field{"lift_limit", "rad", "Largest angle by which a leg lifts and presses.", 0.01, 1.5},
          s.lift_limit_rad);
    visit(Field{"knees", "", "Whether the lower half of a leg turns, too."}, s.knees);
    visit(Field{"knee_power", "Nm", "Largest torque at a knee.", 0, 1e6}, s.knee_power_Nm);
    visit(units_field, s.units);
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double size = s.size_m, thick = 0.05 * s.leg_length_m, foot = 0.07 * s.leg_length_m;
  const auto [sine, cosine] = math::sincos(s.spread_rad);
  out.X_WM.p.z = s.leg_length_m * cosine + foot;
  const std::uint32_t body = add_link(m, "body", {});
  add_part(m, body, {Box{{size, 0.4 * size, 0.14 * size}}, {}, 0.7 * s.mass_kg, colors::red});
  add_part(m, body,
           {.shape = Sphere{0.13 * size},
            .X_LP = {{0.52 * size, 0, 0.02 * size}, {}},
            .color = colors::orange,
            .touches = false});
  for (const double y : {0.06, -0.06})
    add_part(m, body,
             {.shape = Sphere{0.03 * size},
              .X_LP = {{0.61 * size, y * size, 0.08 * size}, {}},
              .color = colors::dark,
              .touches = false});
  constexpr const char* rows[] = {"front", "middle", "rear"};
  const double leg_mass = 0.3 * s.mass_kg / 6;
  for (const double side : {1.0, -1.0})
    for (int row = 0; row < 3; ++row) {
      const std::string name = std::string(side > 0 ? "left_" : "right_") + rows[row];
      const Vec3 hip{(1 - row) * 0.4 * size, side * 0.24 * size, 0};
      const Vec3 down{0, side * sine, -cosine};
      const std::uint32_t coxa = add_link(m, name + "_coxa", {hip, {}});
      add_mass(m, coxa, 0.2 * leg_mass, foot);
      add_part(m, coxa, {.shape = Sphere{1.3 * foot}, .color = colors::grey, .touches = false});
      const std::uint32_t leg = add_link(m, name + "_leg", {hip, {}});
      const double upper = s.knees ? 0.5 : 1.0;
      add_part(m, leg,
               {Capsule{thick, upper * s.leg_length_m}, along(down, upper * 0.5 * s.leg_length_m * down),
                0.7 * upper * leg_mass, colors::orange});
      const auto motor = [&](const char* what, std::uint32_t parent, std::uint32_t child, Vec3 at, Vec3 axis,
                             double limit, double power) {
        add_motor(m, name + what,
                  add_joint(m, name + what + "_joint", parent, child, at,
                            {.axis_M = axis,
                             .lower = -limit,
                             .upper = limit,
                             .max_effort = power,
                             .max_velocity = s.speed_radps}));
      };
      motor("_swing", body, coxa, hip, {0, 0, side}, s.swing_limit_rad, s.power_Nm);
      motor("_lift", coxa, leg, hip, {side, 0, 0}, s.lift_limit_rad, s.power_Nm);
      std::uint32_t last = leg;
      Vec3 end = s.leg_length_m * down;
      if (s.knees) {
        const Vec3 knee = hip + 0.5 * s.leg_length_m * down;
        last = add_link(m, name + "_shin", {knee, {}});
        add_part(m, last,
                 {Capsule{0.8 * thick, 0.5 * s.leg_length_m}, along(down, 0.25 * s.leg_length_m * down),
                  0.35 * leg_mass, colors::yellow});
        motor("_knee", leg, last, knee, {side, 0, 0}, s.lift_limit_rad, s.knee_power_Nm);
        end = 0.5 * s.leg_length_m * down;
      }
      add_part(m, last, {Sphere{foot}, {end, {}}, 0.1 * leg_mass, colors::dark});
    }
  add_senses(m);
  set_units(m, s.units);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "hexapod",
    .help = "Six legs on two servo joints each, with or without knees.",
});

}  // namespace sandlot::builders::hexapod
