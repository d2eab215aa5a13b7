/// polygon: an area on the ground with straight sides.
#include <algorithm>

#include "geometry/polygon.h"
#include "markers/marker.h"

namespace sandlot::markers::polygon {
namespace {

struct Spec {
  std::vector<std::array<double, 2>> corners_m;
  std::array<double, 3> color{0.2, 0.6, 1};
  bool visible = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"corners", "m", "Corners x y in the world, in order; no two sides may cross.",
                -max_distance_m, max_distance_m, Field::required, 1000, 3},
          s.corners_m);
    visit(color_field, s.color);
    visit(visible_field, s.visible);
  }
};

struct Polygon {
  using Spec = polygon::Spec;
  using State = NoFields;
  Spec spec;
  State state;
  std::vector<Vec3> corners_W;  ///< counter-clockwise
  std::vector<Vec2> corners;    ///< the same

  Status init(const ElementBuild& build) {
    for (const auto& [x, y] : spec.corners_m) corners_W.push_back({x, y, 0});
    if (const auto crossing = polygon_crossing(corners_W))
      return build.error("corners",
                         "side " + std::to_string(crossing->first + 1) + " meets side " +
                             std::to_string(crossing->second + 1),
                         "list the corners in order around the area, each once");
    if (polygon_area(corners_W) < 0) std::reverse(corners_W.begin(), corners_W.end());
    for (const Vec3& corner : corners_W) corners.push_back({corner.x, corner.y});
    return {};
  }
  bool contains(Vec3 point_W) const { return polygon_contains(corners_W, point_W); }
  bool meets(const RoundedHull& hull) const { return sandlot::meets(hull, corners); }
  std::vector<std::vector<Vec3>> outlines_W() const { return {corners_W}; }
};

}  // namespace

extern const MarkerKind kind;
constinit const MarkerKind kind = make_marker<Polygon>(
    {.name = "polygon", .help = "Area on the ground with straight sides."});

}  // namespace sandlot::markers::polygon
