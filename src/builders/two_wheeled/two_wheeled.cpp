/// Two driven wheels on one axle and a round body between them that all but touches the ground: it nods when
/// it speeds up. After the nimm2 of LpzRobots: size 1, force 5, speed 12, balls for wheels.
///
/// Frame    M: middle of the axle, x forward, y left; it stands one wheel radius (size/4 + size/600) above
///          the ground.
/// Moves    motors `left` and `right` follow speeds [rad/s].
/// Senses   `joints`, `imu`; with `range` two range finders, `ir_left` and `ir_right`, in the nose.
/// Source   proportions chosen after the pictures of LpzRobots; force, speed and range are its defaults.
#include "base/text.h"
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::two_wheeled {
namespace {

struct Spec {
  double size_m = 1, force_Nm = 5, speed_radps = 12, body_mass_kg = 8, wheel_mass_kg = 1, range_m = 3;
  WheelShape wheels = WheelShape::balls;
  Units units = Units::si;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"size", "m", "Length of the whole robot; all other lengths follow from it.", 0.02, 20},
          s.size_m);
    visit(Field{"force", "Nm", "Largest torque of a wheel's motor.", 0, 1e6}, s.force_Nm);
    visit(Field{"speed", "rad/s", "Fastest turn of a wheel.", 0, 1e3}, s.speed_radps);
    visit(Field{"body_mass", "kg", "Mass of the body.", 1e-4, 1e5}, s.body_mass_kg);
    visit(Field{"wheel_mass", "kg", "Mass of each wheel.", 1e-4, 1e5}, s.wheel_mass_kg);
    visit(Field{"wheels", "", "Shape of the wheels."}, s.wheels);
    visit(Field{"range", "m", "Range of the two range finders; 0: the robot has none.", 0, 1e3}, s.range_m);
    visit(units_field, s.units);
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double radius = s.size_m / 4 + s.size_m / 600, body_radius = s.size_m / 4;
  out.X_WM.p.z = radius;
  const std::uint32_t body = add_link(m, "body", {});
  model::Surface smooth;
  smooth.mu = smooth.mu2 = 0.1;
  add_part(m, body,
           {Capsule{body_radius, s.size_m / 2}, along({1, 0, 0}), s.body_mass_kg, colors::orange, smooth});
  const double nose_x = s.size_m / 2 - 0.04 * s.size_m;
  add_part(m, body,
           {.shape = Sphere{0.09 * s.size_m},
            .X_LP = {{nose_x, 0, 0}, {}},
            .color = colors::white,
            .touches = false});
  const bool balls = s.wheels == WheelShape::balls;
  const double width = balls ? 2 * radius : s.size_m / 10;
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "left" : "right";
    const Vec3 at{0, side * (body_radius + width / 2 + 0.01 * s.size_m), 0};
    const std::uint32_t wheel = add_link(m, name + "_wheel", {at, {}});
    add_part(m, wheel, creature_wheel(s.wheels, radius, width, s.wheel_mass_kg));
    // A disc that shows how the wheel turns.
    for (const double x : {-0.55, 0.55})
      add_part(m, wheel,
               {.shape = Sphere{0.2 * radius},
                .X_LP = {{x * radius, side * (balls ? 0.75 * radius : width / 2), 0}, {}},
                .color = colors::yellow,
                .touches = false});
    add_motor(m, name,
              add_joint(m, name + "_joint", body, wheel, at,
                        {.type = model::JointType::continuous,
                         .axis_M = {0, 1, 0},
                         .max_effort = s.force_Nm,
                         .max_velocity = s.speed_radps}));
  }
  add_senses(m);
  if (s.range_m > 0)
    for (const double side : {1.0, -1.0})
      add_device(m, side > 0 ? "ir_left" : "ir_right", "range_finder",
                 {{"min_range", "0"}, {"max_range", number_text(s.range_m)}, {"rate", "20"}}, body,
                 pose_from_rpy({0.4 * s.size_m, side * 0.16 * s.size_m, 0.1 * s.size_m}, {0, 0, side * 0.4}));
  set_units(m, s.units);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "two_wheeled",
    .help = "Robot on two wheels that nods as it speeds up (nimm2).",
});

}  // namespace sandlot::builders::two_wheeled
