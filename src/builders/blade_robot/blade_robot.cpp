/// A small round robot on two driven wheels with a blade in front, to push things with.
///
/// Frame    M: on the ground below the axle's middle, x forward, y left.
/// Moves    `drive`, a diff_drive.
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::blade_robot {
namespace {

struct Spec {
  double radius_m = 0.09, blade_m = 0.22, mass_kg = 2, wheel_radius_m = 0.03;
  std::array<double, 3> color{0.9, 0.36, 0.06};

  static void fields(auto& s, auto&& visit) {
    visit(Field{"radius", "m", "Radius of the body.", 0.02, 10}, s.radius_m);
    visit(Field{"blade", "m", "Width of the blade.", 0.01, 20}, s.blade_m);
    visit(Field{"mass", "kg", "Mass of the whole robot; each wheel has a twentieth of it.", 0.01, 1e5},
          s.mass_kg);
    visit(Field{"wheel_radius", "m", "Radius of the wheels.", 0.005, 10}, s.wheel_radius_m);
    visit(Field{"color", "1", "Colour of the body: red, green and blue.", 0, 1}, s.color);
  }
  Status check(const Node& node, const std::string& path) const {
    if (radius_m >= 2 * wheel_radius_m) return {};
    return parameter_error(node, path, "radius", "there is no room for the wheels in the body",
                           "give a radius of at least two wheel radii", "wheel_radius");
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double r = s.wheel_radius_m, track = 1.3 * s.radius_m, width = 0.3 * r, ball = 0.25 * r;
  const std::uint32_t base = add_link(m, "base", {});
  const Color color{static_cast<float>(s.color[0]), static_cast<float>(s.color[1]),
                    static_cast<float>(s.color[2]), 1};
  add_round_body(m, base, s.radius_m, 2 * r, 2 * ball, 0.8 * s.mass_kg, color);
  model::Surface smooth;
  smooth.mu = smooth.mu2 = 0;
  for (const double x : {0.7, -0.7})
    add_part(m, base,
             {Sphere{ball}, {{x * s.radius_m, 0, ball}, {}}, 0.01 * s.mass_kg, colors::grey, smooth});
  model::Surface blade;
  blade.mu = blade.mu2 = 0.5;
  const double thickness = 0.1 * s.radius_m;
  add_part(m, base,
           {Box{{thickness, s.blade_m, 1.8 * r}},
            {{s.radius_m + 0.5 * thickness, 0, ball + 0.9 * r}, {}},
            0.08 * s.mass_kg,
            colors::grey,
            blade});
  for (const double side : {1.0, -1.0})
    add_wheel(m, {.name = side > 0 ? "left" : "right",
                  .centre_M = {0, side * track / 2, r},
                  .radius_m = r,
                  .width_m = width,
                  .mass_kg = 0.05 * s.mass_kg});
  add_device(m, "drive", "diff_drive", {{"left_joint", "left_joint"}, {"right_joint", "right_joint"}});
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "blade_robot",
    .help = "Small round robot on two driven wheels with a blade to push things with.",
});

}  // namespace sandlot::builders::blade_robot
