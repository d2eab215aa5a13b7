/// A plank on a pivot that is fixed to the world. After LpzRobots' Seesaw.
///
/// Frame    M: on the ground below the pivot; the plank lies along x and tips about y.
/// Start    level; until something weighs on it, it stays so.
#include "base/math.h"
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::seesaw {
namespace {

struct Spec {
  double length_m = 3, width_m = 0.8, thickness_m = 0.05, height_m = 0.25, mass_kg = 8;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"length", "m", "Length of the plank.", 0.05, 100}, s.length_m);
    visit(Field{"width", "m", "Width of the plank.", 0.01, 100}, s.width_m);
    visit(Field{"thickness", "m", "Thickness of the plank.", 1e-3, 1}, s.thickness_m);
    visit(Field{"height", "m", "Height of the pivot, which is in the middle of the plank.", 0.01, 10},
          s.height_m);
    visit(Field{"mass", "kg", "Mass of the plank.", 1e-3, 1e5}, s.mass_kg);
  }
  Status check(const Node& node, const std::string& path) const {
    if (height_m <= thickness_m)
      return parameter_error(node, path, "height", "the plank would lie in the ground",
                             "choose a height above its thickness");
    if (height_m >= length_m / 2)
      return parameter_error(node, path, "height", "the plank's ends could not reach the ground",
                             "choose a height below half its length");
    return {};
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const Vec3 pivot{0, 0, s.height_m};
  const std::uint32_t base = add_link(m, "base", {});
  // Two cheeks at the plank's sides, an axle through it.
  const double cheek = 0.06 * s.length_m, y = s.width_m / 2 + 0.03 * s.length_m;
  for (const double side : {1.0, -1.0})
    add_part(m, base,
             {Box{{cheek, 0.02 * s.length_m, 1.2 * s.height_m}},
              {{0, side * y, 0.6 * s.height_m}, {}},
              1,
              colors::stone});
  add_part(m, base,
           {.shape = Cylinder{0.3 * cheek, 2 * y},
            .X_LP = along({0, 1, 0}, pivot),
            .color = colors::grey,
            .touches = false});
  const std::uint32_t plank = add_link(m, "plank", {pivot, {}});
  add_part(m, plank, {Box{{s.length_m, s.width_m, s.thickness_m}}, {}, s.mass_kg, colors::wood});
  for (const double x : {-0.45, 0.45})
    add_part(m, plank,
             {.shape = Box{{0.04 * s.length_m, s.width_m, 1.02 * s.thickness_m}},
              .X_LP = {{x * s.length_m, 0, 0}, {}},
              .color = colors::red,
              .touches = false});
  add_joint(m, "to_world", model::world_link, base, {}, {.type = model::JointType::fixed});
  const double tip = math::asin(s.height_m / (s.length_m / 2)) + 0.1;
  add_joint(m, "pivot", base, plank, pivot,
            {.axis_M = {0, 1, 0}, .lower = -tip, .upper = tip, .damping = 0.05 * s.mass_kg});
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "seesaw",
    .help = "Plank on a pivot that tips under what drives over it.",
});

}  // namespace sandlot::builders::seesaw
