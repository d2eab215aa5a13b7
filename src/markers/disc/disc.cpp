/// disc: a round area on the ground.
#include "base/math.h"
#include "markers/marker.h"

namespace sandlot::markers::disc {
namespace {

struct Spec {
  std::array<double, 2> centre_m{};
  double radius_m = 0.5;
  std::array<double, 3> color{0.2, 0.6, 1};
  bool visible = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"centre", "m", "Middle of the disc in the world: x y.", -max_distance_m, max_distance_m},
          s.centre_m);
    visit(Field{"radius", "m", "Radius of the disc.", 1e-3, max_distance_m}, s.radius_m);
    visit(color_field, s.color);
    visit(visible_field, s.visible);
  }
};

struct Disc {
  using Spec = disc::Spec;
  using State = NoFields;
  Spec spec;
  State state;

  Status init(const ElementBuild&) { return {}; }
  bool contains(Vec3 point_W) const {
    const double x = point_W.x - spec.centre_m[0], y = point_W.y - spec.centre_m[1];
    return x * x + y * y <= spec.radius_m * spec.radius_m;
  }
  bool meets(const RoundedHull& hull) const {
    const Vec2 centre{spec.centre_m[0], spec.centre_m[1]};
    return distance_m(hull.corners, centre, centre) <= hull.radius_m + spec.radius_m;
  }
  std::vector<std::vector<Vec3>> outlines_W() const {
    constexpr int corners = 48;
    std::vector<Vec3> out;
    for (int i = 0; i < corners; ++i) {
      const double angle = math::tau * i / corners;
      out.push_back({spec.centre_m[0] + spec.radius_m * math::cos(angle),
                     spec.centre_m[1] + spec.radius_m * math::sin(angle), 0});
    }
    return {out};
  }
};

}  // namespace

extern const MarkerKind kind;
constinit const MarkerKind kind = make_marker<Disc>({.name = "disc", .help = "Round area on the ground."});

}  // namespace sandlot::markers::disc
