/// Loose boxes of random sizes in layers, which settle into a pile. After LpzRobots' BoxPile.
///
/// Frame    M: middle of the pile, on the ground.
/// Layout   as many boxes as there is room for side by side in `length` by `width`, then the next layer; each
///          is drawn from the seed between the smallest and the largest edge, and stands clear of its
///          neighbours at the start.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/random.h"
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::box_pile {
namespace {

struct Spec {
  int count = 30;
  double length_m = 1.5, width_m = 1.5, smallest_m = 0.1, largest_m = 0.3, density = 200;
  std::uint64_t seed = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"count", "1", "Number of boxes.", 1, 5000}, s.count);
    visit(Field{"length", "m", "Length of the pile's place along x.", 0.01, 1e3}, s.length_m);
    visit(Field{"width", "m", "Width of the pile's place along y.", 0.01, 1e3}, s.width_m);
    visit(Field{"smallest", "m", "Shortest edge of a box.", 1e-3, 10}, s.smallest_m);
    visit(Field{"largest", "m", "Longest edge of a box.", 1e-3, 10}, s.largest_m);
    visit(Field{"density", "kg/m^3", "Density of the boxes.", 0.1, 3e4}, s.density);
    visit(Field{"seed", "1", "Seed of sizes and places of the boxes.", 0, 9007199254740991.0}, s.seed);
  }
  Status check(const Node& node, const std::string& path) const {
    if (smallest_m > largest_m)
      return parameter_error(node, path, "smallest", "the smallest box is larger than the largest",
                             "exchange smallest and largest");
    // Turned by up to 45 deg, a box takes the diagonal of its place.
    if (std::min(length_m, width_m) < 1.5 * largest_m)
      return parameter_error(node, path, "largest", "no box of the largest size has room in the pile's place",
                             "give at least one and a half times of it as length and width");
    return {};
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  m.self_collide = true;
  Stream random(s.seed, entity_key("box_pile"), Purpose::initial, 0);
  const double cell = 1.5 * s.largest_m;
  const int columns = static_cast<int>(std::floor(s.length_m / cell)),
            rows = static_cast<int>(std::floor(s.width_m / cell));
  constexpr Color shades[] = {colors::wood, colors::orange, colors::stone, colors::yellow, colors::teal};
  for (int i = 0; i < s.count; ++i) {
    const int layer = i / (columns * rows), place = i % (columns * rows);
    Vec3 size;
    for (std::size_t axis = 0; axis < 3; ++axis) size[axis] = random.uniform(s.smallest_m, s.largest_m);
    const double turn = random.uniform(-math::pi / 4, math::pi / 4);
    // Every second layer is shifted, so that a pile grows instead of columns.
    const double shift = layer % 2 == 1 && columns > 1 ? cell / 2 : 0;
    const Vec3 at{(place % columns - (columns - 1) / 2.0) * cell + shift,
                  (place / columns - (rows - 1) / 2.0) * cell,
                  layer * 1.02 * s.largest_m + size.z / 2 + 0.001};
    const std::uint32_t box = add_link(m, numbered("box", i + 1),
                                       {at, quat_from_axis_angle({0, 0, 1}, turn)});
    add_part(m, box, {Box{size}, {}, s.density * size.x * size.y * size.z, shades[i % 5]});
  }
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "box_pile",
    .help = "Loose boxes of random sizes that settle into a pile.",
});

}  // namespace sandlot::builders::box_pile
