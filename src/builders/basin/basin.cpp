/// A round basin whose floor turns up to a rim: what rolls comes back to the middle. Deep and narrow it is a vessel.
///
/// Frame    M: middle of the floor.
/// Heights  0 within the floor; beyond it depth * t^2, where t goes from 0 to 1 at the rim.
/// Limits   no file: `sandlot convert` writes a mesh of it. Snapshots and recordings carry its heights. Beyond the rim, up to the
///          square that holds it, it is flat.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "builders/builder.h"
#include "builders/parts.h"
#include "geometry/height_grid.h"

namespace sandlot::builders::basin {
namespace {

struct Spec {
  double diameter_m = 6, floor_m = 2, depth_m = 1, cell_m = 0.1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"diameter", "m", "Diameter of the rim.", 0.1, 1e3}, s.diameter_m);
    visit(Field{"floor", "m", "Diameter of the flat floor.", 0, 1e3}, s.floor_m);
    visit(Field{"depth", "m", "Height of the rim above the floor.", 0, 100}, s.depth_m);
    visit(Field{"cell", "m", "Distance between neighbouring grid points.", 1e-3, 100}, s.cell_m);
  }
  Status check(const Node& node, const std::string& path) const {
    if (floor_m >= diameter_m)
      return parameter_error(node, path, "floor", "the floor would be wider than the rim",
                             "give a diameter below that of the rim");
    constexpr double most = 1025;
    if (diameter_m / cell_m < most && diameter_m / cell_m >= 1) return {};
    return parameter_error(node, path, "cell",
                           "a side would have " + number_text(std::floor(diameter_m / cell_m)) + " cells",
                           "choose cells so that each side has 1 to 1024");
  }
};

Result<Built> build(const Spec& s) {
  auto grid = std::make_shared<HeightGrid>();
  grid->columns = grid->rows = std::max(2, static_cast<int>(std::floor(s.diameter_m / s.cell_m + 0.5)) + 1);
  grid->size_x_m = grid->size_y_m = s.diameter_m;
  grid->source_height_m = s.depth_m;
  const double rim = s.diameter_m / 2, floor = s.floor_m / 2;
  for (int row = 0; row < grid->rows; ++row)
    for (int column = 0; column < grid->columns; ++column) {
      const double x = column * grid->cell_x_m() - rim, y = row * grid->cell_y_m() - rim;
      const double t = std::clamp((std::sqrt(x * x + y * y) - floor) / (rim - floor), 0.0, 1.0);
      grid->height_m.push_back(static_cast<float>(s.depth_m * t * t));
    }
  Built out;
  out.model.is_static = true;
  const std::uint32_t ground = add_link(out.model, "ground", {});
  add_part(out.model, ground, {.shape = Heightfield{std::move(grid)}, .color = colors::stone});
  add_mass(out.model, ground, 1, 1);  // a static body's is never used
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "basin",
    .help = "Round basin whose floor turns up to a rim; deep and narrow, a vessel.",
});

}  // namespace sandlot::builders::basin
