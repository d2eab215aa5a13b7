/// grid: the lines of a grid on the ground: bars of one width, every `spacing` from the low corner of a rectangle.
///
/// Extent   the last line lies at the greatest multiple of `spacing` that fits into `size`; bars end flush with the outer
///          edges of the last lines across them.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "markers/marker.h"

namespace sandlot::markers::grid {
namespace {

constexpr int most_lines = 500;  ///< in one direction

struct Spec {
  std::array<double, 2> corner_m{};
  std::array<double, 2> size_m{1, 1};
  double spacing_m = 0.1, width_m = 0.01, yaw_rad = 0;
  std::array<double, 3> color{0.1, 0.1, 0.1};
  bool visible = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"corner", "m", "Crossing of the first two lines in the world: x y.", -max_distance_m,
                max_distance_m},
          s.corner_m);
    visit(Field{"size", "m", "Extent along the two directions from the corner.", 1e-3, max_distance_m,
                Field::required},
          s.size_m);
    visit(Field{"spacing", "m", "Distance from line to line.", 1e-3, max_distance_m}, s.spacing_m);
    visit(Field{"width", "m", "Width of the lines.", 1e-4, 1e3}, s.width_m);
    visit(Field{"yaw", "rad", "Turn of the grid about its corner.", -7, 7}, s.yaw_rad);
    visit(color_field, s.color);
    visit(visible_field, s.visible);
  }
};

struct Grid {
  using Spec = grid::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  std::array<int, 2> lines{};  ///< across x and across y of the grid
  Vec2 ahead{1, 0};            ///< x of the grid

  Status init(const ElementBuild& build) {
    if (spec.width_m >= spec.spacing_m)
      return build.error("width", "the lines are as wide as their spacing", "less than spacing");
    for (std::size_t i = 0; i < 2; ++i) {
      // A size that is meant to be a multiple of the spacing misses it by rounding.
      const double gaps = std::floor(spec.size_m[i] / spec.spacing_m + 1e-6);
      if (gaps + 1 > most_lines)
        return build.error("spacing",
                           "the grid has more than " + std::to_string(most_lines) + " lines side by side",
                           "a wider spacing, or a smaller size");
      lines[i] = static_cast<int>(gaps) + 1;
    }
    ahead = {math::cos(spec.yaw_rad), math::sin(spec.yaw_rad)};
    return {};
  }
  Vec2 in_grid(Vec2 point_W) const {
    const Vec2 off = point_W - Vec2{spec.corner_m[0], spec.corner_m[1]};
    return {dot(off, ahead), ahead.x * off.y - ahead.y * off.x};
  }
  double last_m(std::size_t axis) const { return spec.spacing_m * (lines[axis] - 1); }

  bool contains(Vec3 point_W) const {
    const Vec2 p = in_grid({point_W.x, point_W.y});
    const double half = spec.width_m / 2;
    const auto within = [&](double at, std::size_t axis) { return at >= -half && at <= last_m(axis) + half; };
    const auto on_line = [&](double at) {
      return std::abs(at - spec.spacing_m * std::floor(at / spec.spacing_m + 0.5)) <= half;
    };
    return within(p.x, 0) && within(p.y, 1) && (on_line(p.x) || on_line(p.y));
  }

  /// Bar `i` across an axis, in the grid's frame: low corner and high corner.
  std::pair<Vec2, Vec2> bar(std::size_t axis, int i) const {
    const double half = spec.width_m / 2, at = spec.spacing_m * i, end = last_m(1 - axis);
    if (axis == 0) return {{at - half, -half}, {at + half, end + half}};
    return {{-half, at - half}, {end + half, at + half}};
  }
  static std::array<Vec2, 4> corners_of(const std::pair<Vec2, Vec2>& bar) {
    const auto& [low, high] = bar;
    return {low, Vec2{high.x, low.y}, high, Vec2{low.x, high.y}};
  }

  bool meets(const RoundedHull& hull) const {
    RoundedHull seen{{}, hull.radius_m};
    Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
    for (const Vec2 corner : hull.corners) {
      const Vec2 p = in_grid(corner);
      seen.corners.push_back(p);
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const double wide = hull.radius_m + spec.width_m;
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
      // Lines out of the hull's reach are passed over.
      const double from = (axis == 0 ? low.x : low.y) - wide, to = (axis == 0 ? high.x : high.y) + wide;
      const double last = lines[axis] - 1;
      const int first = static_cast<int>(std::clamp(std::floor(from / spec.spacing_m), 0.0, last));
      const int end = static_cast<int>(std::clamp(std::ceil(to / spec.spacing_m), 0.0, last));
      for (int i = first; i <= end; ++i)
        if (sandlot::meets(seen, corners_of(bar(axis, i)))) return true;
    }
    return false;
  }

  std::vector<std::vector<Vec3>> outlines_W() const {
    std::vector<std::vector<Vec3>> out;
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}})
      for (int i = 0; i < lines[axis]; ++i) {
        std::vector<Vec3>& outline = out.emplace_back();
        for (const Vec2 p : corners_of(bar(axis, i)))
          outline.push_back({spec.corner_m[0] + ahead.x * p.x - ahead.y * p.y,
                             spec.corner_m[1] + ahead.y * p.x + ahead.x * p.y, 0});
      }
    return out;
  }
};

}  // namespace

extern const MarkerKind kind;
constinit const MarkerKind kind = make_marker<Grid>(
    {.name = "grid", .help = "Lines of a rectangular grid on the ground."});

}  // namespace sandlot::markers::grid
