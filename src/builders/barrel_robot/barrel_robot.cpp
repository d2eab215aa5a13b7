/// A barrel that rolls because two masses inside of it slide across its axis. After the barrel2masses of
/// LpzRobots: diameter 1, shell 0.3 kg, masses of 1 kg, range 0.25, power 150.
///
/// Frame    M: middle of the barrel, its axis along y; it stands half a diameter above the ground and rolls
///          along x.
/// Moves    motors `x` and `z` move the masses along those axes of the barrel [m].
/// Senses   `joints`, `imu`.
/// Limits   the masses pass through each other: they have no geometry, and their rails no mass.
#include "builders/inner_masses.h"

namespace sandlot::builders::barrel_robot {
namespace {

struct Spec {
  double diameter_m = 1, length_m = 1, shell_mass_kg = 0.3;
  InnerMassSpec inner{.mass_kg = 1, .range_m = 0.25, .power_N = 150, .speed_mps = 2};
  Units units = Units::si;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"diameter", "m", "Diameter of the barrel.", 0.02, 20}, s.diameter_m);
    visit(Field{"length", "m", "Length of the barrel.", 0.02, 20}, s.length_m);
    visit(Field{"shell_mass", "kg", "Mass of the barrel without what is inside.", 1e-4, 1e5},
          s.shell_mass_kg);
    visit(Field{"mass", "kg", "Mass of each of the two inner masses.", 1e-4, 1e5}, s.inner.mass_kg);
    InnerMassSpec::fields(s.inner, visit);
    visit(units_field, s.units);
  }
  Status check(const Node& node, const std::string& path) const {
    return inner.check(node, path, diameter_m, "barrel");
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double radius = s.diameter_m / 2, half = s.length_m / 2;
  out.X_WM.p.z = radius;
  const std::uint32_t shell = add_link(m, "shell", {});
  add_part(m, shell, {Cylinder{radius, s.length_m}, along({0, 1, 0}), 0, {0.95f, 0.80f, 0.55f, 0.35f}});
  for (const double side : {-1.0, 1.0})
    add_part(m, shell,
             {.shape = Cylinder{1.01 * radius, 0.06 * s.length_m},
              .X_LP = along({0, 1, 0}, {0, side * 0.97 * half, 0}),
              .color = {0.60f, 0.40f, 0.22f, 0.45f},
              .touches = false});
  // All mass lies on the curved side: m r^2 about the axis, m r^2 / 2 + m l^2 / 12 across it.
  const double mrr = s.shell_mass_kg * radius * radius;
  const double across = mrr / 2 + s.shell_mass_kg * s.length_m * s.length_m / 12;
  m.links[shell].inertial = {s.shell_mass_kg, {}, {across, mrr, across}, {}};
  constexpr Vec3 axes[] = {{1, 0, 0}, {0, 0, 1}};
  constexpr Color shades[] = {colors::red, colors::blue};
  constexpr const char* names[] = {"x", "z"};
  for (std::size_t i = 0; i < 2; ++i)
    add_inner_mass(
        m, shell, names[i], axes[i], s.inner, Cylinder{0.03 * radius, 1.98 * radius},
        {Cylinder{0.16 * radius, 0.5 * s.length_m}, along({0, 1, 0}), s.inner.mass_kg, shades[i], {}, false});
  add_senses(m);
  set_units(m, s.units);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "barrel_robot",
    .help = "Barrel that rolls by two masses inside (barrel2masses).",
});

}  // namespace sandlot::builders::barrel_robot
