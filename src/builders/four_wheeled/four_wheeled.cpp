/// A body on four driven wheels. After the nimm4 of LpzRobots: size 1, force 3, speed 15, tyres of rubber.
///
/// Frame    M: middle of the four axles, x forward, y left; it stands one wheel radius above the ground.
/// Moves    motors `front_left`, `front_right`, `rear_left`, `rear_right` follow speeds [rad/s].
/// Senses   `joints`, `imu`.
/// Source   proportions chosen after the pictures of LpzRobots; size, force and speed are its defaults.
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::four_wheeled {
namespace {

struct Spec {
  double size_m = 1, force_Nm = 3, speed_radps = 15, body_mass_kg = 4, wheel_mass_kg = 0.5;
  WheelShape wheels = WheelShape::discs;
  Units units = Units::si;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"size", "m", "Length of the body; all other lengths follow from it.", 0.02, 20}, s.size_m);
    visit(Field{"force", "Nm", "Largest torque of a wheel's motor.", 0, 1e6}, s.force_Nm);
    visit(Field{"speed", "rad/s", "Fastest turn of a wheel.", 0, 1e3}, s.speed_radps);
    visit(Field{"body_mass", "kg", "Mass of the body.", 1e-4, 1e5}, s.body_mass_kg);
    visit(Field{"wheel_mass", "kg", "Mass of each wheel.", 1e-4, 1e5}, s.wheel_mass_kg);
    visit(Field{"wheels", "", "Shape of the wheels."}, s.wheels);
    visit(units_field, s.units);
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double size = s.size_m, radius = 0.15 * size, width = 0.12 * size;
  out.X_WM.p.z = radius;
  const std::uint32_t body = add_link(m, "body", {});
  add_part(m, body,
           {Box{{size, 0.4 * size, 0.16 * size}}, {{0, 0, 0.06 * size}, {}}, s.body_mass_kg, colors::blue});
  add_part(m, body,
           {.shape = Box{{0.4 * size, 0.32 * size, 0.12 * size}},
            .X_LP = {{-0.08 * size, 0, 0.2 * size}, {}},
            .color = colors::white,
            .touches = false});
  for (const double y : {-0.12, 0.12})
    add_part(m, body,
             {.shape = Sphere{0.04 * size},
              .X_LP = {{0.5 * size, y * size, 0.07 * size}, {}},
              .color = colors::yellow,
              .touches = false});
  model::Surface rubber;
  rubber.mu = rubber.mu2 = 1.2;
  for (const auto& [corner, x, y] : corners) {
    const std::string name = corner;
    const Vec3 at{x * 0.32 * size, y * (0.2 * size + width / 2 + 0.02 * size), 0};
    const std::uint32_t wheel = add_link(m, name + "_wheel", {at, {}});
    add_part(m, wheel, creature_wheel(s.wheels, radius, width, s.wheel_mass_kg, rubber));
    add_part(
        m, wheel,
        {.shape = Box{{1.3 * radius, 1.04 * width, 0.2 * radius}}, .color = colors::grey, .touches = false});
    add_motor(m, name,
              add_joint(m, name + "_joint", body, wheel, at,
                        {.type = model::JointType::continuous,
                         .axis_M = {0, 1, 0},
                         .max_effort = s.force_Nm,
                         .max_velocity = s.speed_radps}));
  }
  add_senses(m);
  set_units(m, s.units);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "four_wheeled",
    .help = "Robot on four driven wheels (nimm4).",
});

}  // namespace sandlot::builders::four_wheeled
