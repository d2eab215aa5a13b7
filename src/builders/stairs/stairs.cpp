/// Steps up to a platform and, if wanted, down again on its other side.
///
/// Frame    M: middle of the first step's front edge, on the ground; the steps go up along x.
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::stairs {
namespace {

struct Spec {
  int steps = 5;
  double rise_m = 0.1, tread_m = 0.3, width_m = 1.2, platform_m = 1;
  bool down = true;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"steps", "1", "Number of steps up to the platform, its edge included.", 1, 1000}, s.steps);
    visit(Field{"rise", "m", "Height of a step.", 1e-3, 10}, s.rise_m);
    visit(Field{"tread", "m", "Depth of a step.", 1e-3, 10}, s.tread_m);
    visit(Field{"width", "m", "Width of the stairs.", 0.01, 1e3}, s.width_m);
    visit(Field{"platform", "m", "Depth of the platform.", 1e-3, 1e3}, s.platform_m);
    visit(Field{"down", "", "Whether steps lead down behind the platform."}, s.down);
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  out.model.is_static = true;
  const std::uint32_t link = add_link(out.model, "stairs", {});
  const double run = (s.steps - 1) * s.tread_m;
  for (int i = 1; i <= s.steps; ++i) {
    // Each step is a block from the ground: the next higher one stands behind it, not upon it.
    const double height = i * s.rise_m, depth = i < s.steps ? s.tread_m : s.platform_m;
    const auto block = [&](double x) {
      add_part(out.model, link,
               {.shape = Box{{depth, s.width_m, height}},
                .X_LP = {{x, 0, height / 2}, {}},
                .color = i % 2 == 0 ? colors::stone : Color{0.66f, 0.63f, 0.58f, 1}});
    };
    const double front = (i - 1) * s.tread_m;
    block(front + depth / 2);
    if (s.down && i < s.steps) block(2 * run + s.platform_m - front - depth / 2);
  }
  add_mass(out.model, link, 1, 1);  // a static body's is never used
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "stairs",
    .help = "Steps up to a platform, and down again.",
});

}  // namespace sandlot::builders::stairs
