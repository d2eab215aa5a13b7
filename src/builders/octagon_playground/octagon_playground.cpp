/// Walls along a regular polygon, eight corners by default, that lies on the ground. After LpzRobots'
/// OctaPlayground: 7 across, walls 0.2 thick, 0.5 high.
///
/// Frame    M: middle of the yard, on the ground; the first wall stands across x.
#include "base/math.h"
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::octagon_playground {
namespace {

struct Spec {
  int corners = 8;
  double length_m = 7, wall_m = 0.2, height_m = 0.5;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"corners", "1", "Number of corners and of walls.", 3, 200}, s.corners);
    visit(Field{"length", "m", "Distance between the insides of opposite walls (twice that from the middle).",
                0.05, 1e4},
          s.length_m);
    visit(Field{"wall", "m", "Thickness of the walls.", 1e-3, 100}, s.wall_m);
    visit(Field{"height", "m", "Height of the walls.", 1e-3, 100}, s.height_m);
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  out.model.is_static = true;
  const std::uint32_t walls = add_link(out.model, "walls", {});
  const double half = math::pi / s.corners, outside = s.length_m / 2 + s.wall_m;
  // As long as the outer edge: the ends of neighbours overlap, and no corner is open.
  const double length = 2 * outside * math::tan(half);
  for (int i = 0; i < s.corners; ++i) {
    const auto [sine, cosine] = math::sincos(2 * half * i);
    const double r = s.length_m / 2 + s.wall_m / 2;
    add_part(out.model, walls,
             {.shape = Box{{s.wall_m, length, s.height_m}},
              .X_LP = {{r * cosine, r * sine, s.height_m / 2}, quat_from_axis_angle({0, 0, 1}, 2 * half * i)},
              .color = i % 2 == 0 ? colors::wood : Color{0.68f, 0.48f, 0.28f, 1}});
  }
  add_mass(out.model, walls, 1, 1);  // a static body's is never used
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "octagon_playground",
    .help = "Walls along a regular polygon, eight of them by default.",
});

}  // namespace sandlot::builders::octagon_playground
