/// Hills that follow from a seed, for driving over. After LpzRobots' TerrainGround.
///
/// Frame    M: middle of the terrain, at its lowest possible height.
/// Heights  three octaves of smooth noise between random heights on grids of cells `hill` wide, half of it
///          and a quarter; towards the edge they sink to 0, so that it can be driven onto from the ground.
/// Limits   no file: `sandlot convert` writes a mesh of it. Snapshots and recordings carry its heights.
#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "builders/builder.h"
#include "builders/parts.h"
#include "geometry/height_grid.h"

namespace sandlot::builders::terrain {
namespace {

struct Spec {
  double size_x_m = 10, size_y_m = 10, height_m = 1, hill_m = 2.5, cell_m = 0.1;
  std::uint64_t seed = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"size_x", "m", "Extent of the terrain along x.", 0.1, 1e4}, s.size_x_m);
    visit(Field{"size_y", "m", "Extent of the terrain along y.", 0.1, 1e4}, s.size_y_m);
    visit(Field{"height", "m", "Largest possible height.", 0, 100}, s.height_m);
    visit(Field{"hill", "m", "Width of the hills.", 0.01, 1e4}, s.hill_m);
    visit(Field{"cell", "m", "Distance between neighbouring grid points.", 1e-3, 100}, s.cell_m);
    visit(Field{"seed", "1", "Seed of the hills.", 0, 9007199254740991.0}, s.seed);
  }
  Status check(const Node& node, const std::string& path) const {
    constexpr double most = 1025;
    if (size_x_m / cell_m < most && size_y_m / cell_m < most && size_x_m / cell_m >= 1 &&
        size_y_m / cell_m >= 1)
      return {};
    return parameter_error(
        node, path, "cell",
        "a side would have " + number_text(std::floor(std::max(size_x_m, size_y_m) / cell_m)) + " cells",
        "choose cells so that each side has 1 to 1024");
  }
};

/// Random height in [0, 1) of a corner of the grid of one octave.
double corner(std::uint64_t seed, std::uint64_t octave, int x, int y) {
  const auto bits = [](int i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)); };
  return Stream(seed, octave, Purpose::initial, bits(x) << 32 | bits(y)).uniform();
}

double smooth(double t) { return t * t * (3 - 2 * t); }

double noise(std::uint64_t seed, std::uint64_t octave, double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const double tx = smooth(x - fx), ty = smooth(y - fy);
  const double low = corner(seed, octave, ix, iy) * (1 - tx) + corner(seed, octave, ix + 1, iy) * tx;
  const double high = corner(seed, octave, ix, iy + 1) * (1 - tx) + corner(seed, octave, ix + 1, iy + 1) * tx;
  return low * (1 - ty) + high * ty;
}

Result<Built> build(const Spec& s) {
  auto grid = std::make_shared<HeightGrid>();
  grid->columns = static_cast<int>(std::floor(s.size_x_m / s.cell_m + 0.5)) + 1;
  grid->rows = static_cast<int>(std::floor(s.size_y_m / s.cell_m + 0.5)) + 1;
  grid->columns = std::max(2, grid->columns);
  grid->rows = std::max(2, grid->rows);
  grid->size_x_m = s.size_x_m;
  grid->size_y_m = s.size_y_m;
  grid->source_height_m = s.height_m;
  for (int row = 0; row < grid->rows; ++row)
    for (int column = 0; column < grid->columns; ++column) {
      const double x = column * grid->cell_x_m(), y = row * grid->cell_y_m();
      double height = 0, share = 4.0 / 7, width = s.hill_m;
      for (std::uint64_t octave = 0; octave < 3; ++octave, share /= 2, width /= 2)
        height += share * noise(s.seed, octave, x / width, y / width);
      const double edge = std::min({x, y, s.size_x_m - x, s.size_y_m - y});
      height *= smooth(
          std::clamp(edge / std::min(s.hill_m, 0.25 * std::min(s.size_x_m, s.size_y_m)), 0.0, 1.0));
      grid->height_m.push_back(static_cast<float>(s.height_m * height));
    }
  Built out;
  out.model.is_static = true;
  const std::uint32_t ground = add_link(out.model, "ground", {});
  add_part(out.model, ground, {.shape = Heightfield{std::move(grid)}, .color = {0.30f, 0.42f, 0.20f, 1}});
  add_mass(out.model, ground, 1, 1);  // a static body's is never used
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "terrain",
    .help = "Hills that follow from a seed.",
});

}  // namespace sandlot::builders::terrain
