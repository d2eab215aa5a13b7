/// A box on four Mecanum wheels: their rollers stand at 45 degrees, seen from above they point to the middle.
///
/// Frame    M: on the ground below the middle of the wheels, x forward, y left.
/// Moves    `drive`, a mecanum_drive.
/// Senses   `joints`, `imu`.
/// Rollers  as long as it takes to leave no gap, seen from the side: 2 R sin(pi / n) / sin(45 deg).
/// Source   of that length: A. Gfrerrer, Geometry and kinematics of the Mecanum wheel, CAGD 25 (2008).
#include "base/math.h"
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::mecanum_robot {
namespace {

struct Spec {
  int rollers = 10;
  double wheel_radius_m = 0.1, track_m = 0.46, wheelbase_m = 0.4, mass_kg = 15;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"rollers", "1", "Number of rollers of a wheel.", 6, 40}, s.rollers);
    visit(Field{"wheel_radius", "m", "Radius of the wheels over the rollers.", 0.005, 10}, s.wheel_radius_m);
    visit(Field{"track", "m", "Distance between the left and the right wheels.", 0.01, 10}, s.track_m);
    visit(Field{"wheelbase", "m", "Distance between the front and the rear axle.", 0.01, 10}, s.wheelbase_m);
    visit(Field{"mass", "kg", "Mass of the whole robot without rollers; each wheel has a fortieth of it.",
                0.01, 1e5},
          s.mass_kg);
  }
  Status check(const Node& node, const std::string& path) const {
    if (wheelbase_m < 2.1 * wheel_radius_m)
      return parameter_error(node, path, "wheelbase", "the wheels of a side would touch each other",
                             "give more than two wheel radii");
    if (track_m < 2 * wheel_radius_m)
      return parameter_error(node, path, "track", "there is no room for a body between the wheels",
                             "give two wheel radii or more");
    return {};
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double r = s.wheel_radius_m, tilt = math::pi / 4;
  const std::uint32_t base = add_link(m, "base", {});
  model::RollerWheel rollers;
  rollers.radius_m = r;
  rollers.count = s.rollers;
  rollers.rows = 1;
  rollers.roller_length_m = 2 * r * math::sin(math::pi / s.rollers) / math::sin(tilt);
  rollers.roller_radius_m = 0.4 * r * math::sin(math::pi / s.rollers);
  rollers.roller_mass_kg = 0.025 * s.mass_kg * 0.5 / s.rollers;
  const double width = rollers.roller_length_m * math::cos(tilt);
  add_box_body(m, base, {s.wheelbase_m + 1.6 * r, s.track_m - width - 0.06 * s.track_m, 1.1 * r}, 0.6 * r,
               0.9 * s.mass_kg, colors::green);
  for (const auto& [corner, x, y] : corners) {
    rollers.angle_rad = x * y > 0 ? -tilt : tilt;
    add_wheel(m, {.name = corner,
                  .centre_M = {x * s.wheelbase_m / 2, y * s.track_m / 2, r},
                  .radius_m = r,
                  .width_m = 0.8 * width,
                  .mass_kg = 0.025 * s.mass_kg,
                  .rollers = rollers});
  }
  add_device(m, "drive", "mecanum_drive",
             {{"front_left_joint", "front_left_joint"},
              {"front_right_joint", "front_right_joint"},
              {"back_left_joint", "rear_left_joint"},
              {"back_right_joint", "rear_right_joint"}});
  add_senses(m);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "mecanum_robot",
    .help = "Box on four Mecanum wheels.",
});

}  // namespace sandlot::builders::mecanum_robot
