/// A hollow ball that rolls because three masses inside of it slide along its axes. After the
/// sphererobot3masses of LpzRobots: diameter 1, shell 0.3 kg, masses of 1 kg, range 0.2, power 100.
///
/// Frame    M: centre of the shell; it stands half a diameter above the ground.
/// Moves    motors `x`, `y`, `z` move the masses along those axes of the shell [m].
/// Senses   `joints`, `imu`.
/// Limits   the masses pass through each other: they have no geometry, and their rails no mass.
#include "builders/inner_masses.h"

namespace sandlot::builders::sphere_robot {
namespace {

struct Spec {
  double diameter_m = 1, shell_mass_kg = 0.3;
  InnerMassSpec inner{.mass_kg = 1, .range_m = 0.2, .power_N = 100, .speed_mps = 2};
  Units units = Units::si;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"diameter", "m", "Diameter of the shell.", 0.02, 20}, s.diameter_m);
    visit(Field{"shell_mass", "kg", "Mass of the shell.", 1e-4, 1e5}, s.shell_mass_kg);
    visit(Field{"mass", "kg", "Mass of each of the three inner masses.", 1e-4, 1e5}, s.inner.mass_kg);
    InnerMassSpec::fields(s.inner, visit);
    visit(units_field, s.units);
  }
  Status check(const Node& node, const std::string& path) const {
    return inner.check(node, path, diameter_m, "shell");
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double radius = s.diameter_m / 2, ball = 0.14 * radius;
  out.X_WM.p.z = radius;
  const std::uint32_t shell = add_link(m, "shell", {});
  add_part(m, shell, {Sphere{radius}, {}, 0, {0.75f, 0.85f, 0.95f, 0.3f}});
  // All the shell's mass lies on it: 2/3 m r^2.
  m.links[shell].inertial = {
      s.shell_mass_kg, {}, 2.0 / 3.0 * s.shell_mass_kg * radius * radius * Vec3{1, 1, 1}, {}};
  constexpr Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  constexpr Color shades[] = {colors::red, colors::green, colors::blue};
  constexpr const char* names[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i)
    add_inner_mass(m, shell, names[i], axes[i], s.inner, Cylinder{0.02 * radius, 1.98 * radius},
                   {Sphere{ball}, {}, s.inner.mass_kg, shades[i], {}, false});
  add_senses(m);
  set_units(m, s.units);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "sphere_robot",
    .help = "Ball that rolls by three masses inside (sphererobot3masses).",
});

}  // namespace sandlot::builders::sphere_robot
