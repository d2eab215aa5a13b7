/// A chain of two-wheeled robots. After the robotchain of LpzRobots: each member has two driven wheels; the couplings between
/// members bend freely, and no member knows of the others but by what it is pulled to.
///
/// Frame    M: middle of the first member's axle, x forward, y left; the others follow towards -x.
/// Moves    motors `left_1`, `right_1`, `left_2` ... follow speeds [rad/s].
/// Senses   `joints`: the wheels in the order of the motors, then yaw and pitch of each coupling; `imu` in the first member.
/// Limits   a coupling is two hinges with a light link between them; it does not twist.
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::wheel_chain {
namespace {

struct Spec {
  int members = 5;
  double size_m = 0.4, force_Nm = 2, speed_radps = 12, body_mass_kg = 1, wheel_mass_kg = 0.2;
  WheelShape wheels = WheelShape::balls;
  Units units = Units::si;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"members", "1", "Number of two-wheeled robots.", 1, 100}, s.members);
    visit(Field{"size", "m", "Length of a member; all other lengths follow from it.", 0.02, 20}, s.size_m);
    visit(Field{"force", "Nm", "Largest torque of a wheel's motor.", 0, 1e6}, s.force_Nm);
    visit(Field{"speed", "rad/s", "Fastest turn of a wheel.", 0, 1e3}, s.speed_radps);
    visit(Field{"body_mass", "kg", "Mass of a member's body.", 1e-4, 1e5}, s.body_mass_kg);
    visit(Field{"wheel_mass", "kg", "Mass of each wheel.", 1e-4, 1e5}, s.wheel_mass_kg);
    visit(Field{"wheels", "", "Shape of the wheels."}, s.wheels);
    visit(units_field, s.units);
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double radius = 0.25 * s.size_m, body_radius = 0.24 * s.size_m;
  const double width = s.wheels == WheelShape::balls ? 2 * radius : 0.12 * s.size_m;
  const double pitch = 1.25 * s.size_m;
  out.X_WM.p.z = radius;
  model::Surface smooth;
  smooth.mu = smooth.mu2 = 0.1;
  std::vector<std::uint32_t> bodies;
  for (int i = 0; i < s.members; ++i) {
    const double x = -i * pitch;
    const std::uint32_t body = add_link(m, i == 0 ? "body" : numbered("body", i + 1), {{x, 0, 0}, {}});
    bodies.push_back(body);
    add_part(m, body,
             {Capsule{body_radius, 0.5 * s.size_m}, along({1, 0, 0}), s.body_mass_kg,
              i == 0       ? colors::orange
              : i % 2 == 0 ? colors::teal
                           : colors::green,
              smooth});
    if (i == 0)
      for (const double side : {0.4, -0.4})
        add_part(m, body,
                 {.shape = Sphere{0.2 * body_radius},
                  .X_LP = {{0.44 * s.size_m, side * body_radius, 0.5 * body_radius}, {}},
                  .color = colors::dark,
                  .touches = false});
    for (const double side : {1.0, -1.0}) {
      const std::string name = numbered(side > 0 ? "left" : "right", i + 1);
      const Vec3 at{x, side * (body_radius + width / 2 + 0.02 * s.size_m), 0};
      const std::uint32_t wheel = add_link(m, name + "_wheel", {at, {}});
      add_part(m, wheel, creature_wheel(s.wheels, radius, width, s.wheel_mass_kg));
      add_part(m, wheel,
               {.shape = Sphere{0.2 * radius},
                .X_LP = {{0.6 * radius, side * 0.4 * width, 0}, {}},
                .color = colors::yellow,
                .touches = false});
      add_motor(m, name,
                add_joint(m, name + "_joint", body, wheel, at,
                          {.type = model::JointType::continuous,
                           .axis_M = {0, 1, 0},
                           .max_effort = s.force_Nm,
                           .max_velocity = s.speed_radps}));
    }
  }
  for (int i = 0; i + 1 < s.members; ++i) {
    const Vec3 at{-(i + 0.5) * pitch, 0, 0};
    const std::uint32_t cross = add_link(m, numbered("coupling", i + 1), {at, {}});
    add_mass(m, cross, 0.1 * s.body_mass_kg, 0.1 * s.size_m);
    add_part(m, cross, {.shape = Sphere{0.08 * s.size_m}, .color = colors::grey, .touches = false});
    JointOptions yaw{.axis_M = {0, 0, 1}, .lower = -1, .upper = 1, .damping = 0.01};
    JointOptions nod{.axis_M = {0, 1, 0}, .lower = -0.6, .upper = 0.6, .damping = 0.01};
    add_joint(m, numbered("yaw", i + 1), bodies[static_cast<std::size_t>(i)], cross, at, yaw);
    add_joint(m, numbered("pitch", i + 1), cross, bodies[static_cast<std::size_t>(i) + 1], at, nod);
  }
  add_senses(m);
  set_units(m, s.units);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "wheel_chain",
    .help = "Chain of two-wheeled robots on couplings that bend freely (robotchain).",
});

}  // namespace sandlot::builders::wheel_chain
