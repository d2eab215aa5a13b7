/// A round robot on omni wheels: rollers around their rims let them slide along their axes.
///
/// Frame    M: on the ground below the middle, x forward, y left. Wheels stand on a circle, symmetric to x
///          with none in front, their axes radial.
/// Moves    `drive`, an omni_drive.
/// Senses   `joints`, `imu`.
/// Rollers  in two rows that are turned by half a pitch, as long as it takes to leave no gap between both.
#include <algorithm>

#include "base/math.h"
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::omni_robot {
namespace {

struct Spec {
  int wheels = 3, rollers = 8;
  double wheel_radius_m = 0.06, radius_m = 0.2, mass_kg = 8;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"wheels", "1", "Number of wheels.", 3, 16}, s.wheels);
    visit(Field{"rollers", "1", "Number of rollers in each of the two rows of a wheel.", 4, 40}, s.rollers);
    visit(Field{"wheel_radius", "m", "Radius of the wheels over the rollers.", 0.005, 10}, s.wheel_radius_m);
    visit(Field{"radius", "m", "Radius of the circle on which the wheels stand.", 0.01, 10}, s.radius_m);
    visit(Field{"mass", "kg", "Mass of the whole robot without rollers; each wheel has a fortieth of it.",
                0.01, 1e5},
          s.mass_kg);
  }
  Status check(const Node& node, const std::string& path) const {
    // Neighbours along the circle are 2 R sin(pi / n) apart.
    if (2 * radius_m * math::sin(math::pi / wheels) > 2.1 * wheel_radius_m) return {};
    return parameter_error(node, path, "radius", "the wheels would touch each other",
                           "give fewer or smaller wheels, or a larger radius", "wheels");
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double r = s.wheel_radius_m;
  const std::uint32_t base = add_link(m, "base", {});
  model::RollerWheel rollers;
  rollers.radius_m = r;
  rollers.count = s.rollers;
  rollers.rows = 2;
  // Both rows together have 2 n rollers: each covers a 2n-th of the rim, and a tenth more.
  rollers.roller_length_m = 2 * r * math::sin(1.1 * math::pi / (2 * s.rollers));
  rollers.roller_radius_m = std::min(0.2 * r, 0.4 * rollers.roller_length_m);
  rollers.row_spacing_m = 2.1 * rollers.roller_radius_m;
  rollers.roller_mass_kg = 0.025 * s.mass_kg * 0.4 / (2 * s.rollers);
  const double width = 2 * rollers.row_spacing_m;
  add_round_body(m, base, std::max(0.3 * s.radius_m, s.radius_m - width / 2 - 0.05 * r), 1.2 * r, 0.7 * r,
                 s.mass_kg * (1 - s.wheels / 40.0), colors::teal);
  std::vector<std::string> joints;
  for (int i = 0; i < s.wheels; ++i) {
    const math::SinCos at = math::sincos(math::tau * (i + 0.5) / s.wheels);
    const std::string name = numbered("wheel", i + 1);
    add_wheel(m, {.name = name,
                  .centre_M = {s.radius_m * at.cos, s.radius_m * at.sin, r},
                  .axis_M = {at.cos, at.sin, 0},
                  .radius_m = r,
                  .width_m = width,
                  .mass_kg = 0.025 * s.mass_kg,
                  .rollers = rollers});
    joints.push_back(name + "_joint");
  }
  add_device(m, "drive", "omni_drive", {{"wheel_joint", joints}});
  add_senses(m);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "omni_robot",
    .help = "Round robot on three or more omni wheels.",
});

}  // namespace sandlot::builders::omni_robot
