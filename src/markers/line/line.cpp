/// line: a line on the ground: all points within half of its width of a polyline, so that its ends and corners are round.
///
/// Crossings  belong to the area once; a line may cross itself, as tracks do.
/// Drawing    round ends and corners are polygons, inside the true arc by less than 2 % of half the width.
#include <cmath>

#include "base/math.h"
#include "markers/marker.h"

namespace sandlot::markers::line {
namespace {

struct Spec {
  std::vector<std::array<double, 2>> points_m;
  double width_m = 0.02;
  bool closed = false;
  std::array<double, 3> color{0.1, 0.1, 0.1};
  bool visible = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"points", "m", "Points x y in the world, in order.", -max_distance_m, max_distance_m,
                Field::required, 1000, 2},
          s.points_m);
    visit(Field{"width", "m", "Width of the line.", 1e-4, 1e3}, s.width_m);
    visit(Field{"closed", "", "Whether the last point is joined to the first."}, s.closed);
    visit(color_field, s.color);
    visit(visible_field, s.visible);
  }
};

struct Line {
  using Spec = line::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  struct Segment {
    Vec2 from, to;
  };
  std::vector<Segment> segments;

  Status init(const ElementBuild& build) {
    const std::size_t n = spec.points_m.size();
    const auto at = [&](std::size_t i) { return Vec2{spec.points_m[i % n][0], spec.points_m[i % n][1]}; };
    if (spec.closed && n < 3)
      return build.error("closed", "a closed line needs three points", "add a point, or leave closed out");
    for (std::size_t i = 0; i < (spec.closed ? n : n - 1); ++i) {
      if (at(i) == at(i + 1))
        return build.error(
            "points",
            "points " + std::to_string(i + 1) + " and " + std::to_string((i + 1) % n + 1) + " are equal",
            i + 1 < n ? "list each point once" : "leave the last one out: closed joins it to the first");
      segments.push_back({at(i), at(i + 1)});
    }
    return {};
  }
  bool contains(Vec3 point_W) const {
    for (const Segment& segment : segments)
      if (distance_m(Vec2{point_W.x, point_W.y}, segment.from, segment.to) <= spec.width_m / 2) return true;
    return false;
  }
  bool meets(const RoundedHull& hull) const {
    for (const Segment& segment : segments)
      if (distance_m(hull.corners, segment.from, segment.to) <= hull.radius_m + spec.width_m / 2) return true;
    return false;
  }
  /// A strip with two half discs per segment.
  std::vector<std::vector<Vec3>> outlines_W() const {
    constexpr int steps = 8;
    std::vector<std::vector<Vec3>> out;
    for (const Segment& segment : segments) {
      const Vec2 along = segment.to - segment.from;
      const double begin = math::atan2(along.y, along.x) - math::pi / 2;
      std::vector<Vec3>& strip = out.emplace_back();
      for (int i = 0; i <= 2 * steps + 1; ++i) {
        const Vec2 middle = i <= steps ? segment.to : segment.from;
        const double angle = begin + math::pi * (i <= steps ? i : i - 1) / steps;
        strip.push_back({middle.x + spec.width_m / 2 * math::cos(angle),
                         middle.y + spec.width_m / 2 * math::sin(angle), 0});
      }
    }
    return out;
  }
};

}  // namespace

extern const MarkerKind kind;
constinit const MarkerKind kind = make_marker<Line>(
    {.name = "line", .help = "Line on the ground through a list of points."});

}  // namespace sandlot::markers::line
