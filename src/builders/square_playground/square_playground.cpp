/// Four walls around a yard that lies on the ground. After LpzRobots' Playground: 7 long, walls 0.2 thick,
/// 0.5 high.
///
/// Frame    M: middle of the yard, on the ground.
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::square_playground {
namespace {

struct Spec {
  double length_m = 7, wall_m = 0.2, height_m = 0.5, factor_xy = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"length", "m", "Inner length along x.", 0.05, 1e4}, s.length_m);
    visit(Field{"factor_xy", "1", "Ratio of the inner length along y to that along x.", 0.01, 100},
          s.factor_xy);
    visit(Field{"wall", "m", "Thickness of the walls.", 1e-3, 100}, s.wall_m);
    visit(Field{"height", "m", "Height of the walls.", 1e-3, 100}, s.height_m);
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  out.model.is_static = true;
  const std::uint32_t walls = add_link(out.model, "walls", {});
  const double x = s.length_m / 2 + s.wall_m / 2, y = s.length_m * s.factor_xy / 2 + s.wall_m / 2;
  const auto wall = [&](Vec3 at, Vec3 size) {
    add_part(out.model, walls, {.shape = Box{size}, .X_LP = {at, {}}, .color = colors::wood});
  };
  for (const double side : {1.0, -1.0}) {  // the walls along x have the corners
    wall({0, side * y, s.height_m / 2}, {s.length_m + 2 * s.wall_m, s.wall_m, s.height_m});
    wall({side * x, 0, s.height_m / 2}, {s.wall_m, s.length_m * s.factor_xy, s.height_m});
  }
  add_mass(out.model, walls, 1, 1);  // a static body's is never used
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "square_playground",
    .help = "Four walls around a yard.",
});

}  // namespace sandlot::builders::square_playground
