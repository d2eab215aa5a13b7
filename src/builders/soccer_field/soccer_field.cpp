/// A field of robot soccer: a green carpet with white lines, and a low board around it.
///
/// Frame    M: on the ground in the middle of the field, x along it.
/// Size     a size of the league, or each dimension by itself (soccer/field.h). Lines belong to the areas that
///          they bound; the border is outside of them, and the board outside of the border.
/// Touches  the board alone. Carpet and lines are pictures on the ground that the scenario or world has, 3 and
///          5 mm above it so that no camera and no page mixes them up; with `ground` the field brings its own.
/// Limits   goals, balls and flags are things of their own. Restart spots are not marked. No file:
///          snapshots and recordings carry its meshes, and `convert` leaves them out.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "builders/builder.h"
#include "builders/parts.h"
#include "geometry/mesh.h"
#include "soccer/field.h"

namespace sandlot::builders::soccer_field {
namespace {

constexpr double carpet_m = 0.003, paint_m = 0.005, board_thickness_m = 0.05;

struct Spec : soccer::Dimensions {
  soccer::FieldSize size = soccer::FieldSize::m22x14;
  double board_m = 0.1;
  bool ground = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"size", "", "Size of the field, which gives all dimensions that are not given."}, s.size);
    soccer::Dimensions::fields(s, [&](const Field& field, auto& value) {
      const std::string_view key = field.key;
      if (key == "restart_y" || key == "goal_width" || key == "goal_height" || key == "goal_depth")
        return;  // no line shows them
      visit(field, value);
    });
    visit(Field{"board", "m", "Height of the board around the border; 0: none.", 0, 10}, s.board_m);
    visit(Field{"ground", "", "Ground of its own, for worlds that have none."}, s.ground);
  }
  Status check(const Node& node, const std::string& path) const {
    const auto wrong = [&](const char* key, const char* what, const char* fix, const char* other = "") {
      return parameter_error(node, path, key, what, fix, other);
    };
    if (penalty_area_width_m > width_m || goal_area_width_m > width_m)
      return wrong(penalty_area_width_m > width_m ? "penalty_area_width" : "goal_area_width",
                   "the area is wider than the field", "give less than its width", "width");
    if (2 * std::max({penalty_area_depth_m, goal_area_depth_m, penalty_mark_m}) > length_m)
      return wrong("length", "areas or marks of one side lie beyond the halfway line",
                   "give a longer field, or less depth", "penalty_area_depth");
    if (2 * std::max(circle_radius_m, corner_radius_m) > std::min(length_m, width_m))
      return wrong("circle_radius", "the circle in the middle or the arcs do not fit into the field",
                   "give a smaller radius", "corner_radius");
    return {};
  }
};

/// Flat figures at one height, facing up.
class Figures {
 public:
  explicit Figures(double z_m) : z_m_(z_m) {}

  void rectangle(double x0, double x1, double y0, double y1) {
    const std::uint32_t first = corner(x0, y0);
    corner(x1, y0), corner(x1, y1), corner(x0, y1);
    mesh_.triangles.push_back({first, first + 1, first + 2});
    mesh_.triangles.push_back({first, first + 2, first + 3});
  }
  /// The lines inside the edge of a rectangle.
  void frame(double x0, double x1, double y0, double y1, double line) {
    if (x1 - x0 <= 2 * line || y1 - y0 <= 2 * line) return rectangle(x0, x1, y0, y1);
    rectangle(x0, x1, y0, y0 + line);
    rectangle(x0, x1, y1 - line, y1);
    rectangle(x0, x0 + line, y0 + line, y1 - line);
    rectangle(x1 - line, x1, y0 + line, y1 - line);
  }
  /// What lies between two radii, from one angle to another.
  void ring(double x, double y, double inner, double outer, double from_rad, double to_rad) {
    if (!(outer > 0)) return;
    // Chords of at most 5 cm stay within 0.2 mm of a circle of 2 m.
    const int steps = std::clamp(static_cast<int>(std::ceil((to_rad - from_rad) * outer / 0.05)), 8, 2048);
    std::uint32_t before = 0;
    for (int i = 0; i <= steps; ++i) {
      const math::SinCos at = math::sincos(from_rad + (to_rad - from_rad) * i / steps);
      const std::uint32_t now = corner(x + std::max(inner, 0.0) * at.cos, y + std::max(inner, 0.0) * at.sin);
      corner(x + outer * at.cos, y + outer * at.sin);
      if (i > 0) {
        mesh_.triangles.push_back({before, before + 1, now + 1});
        mesh_.triangles.push_back({before, now + 1, now});
      }
      before = now;
    }
  }
  std::shared_ptr<const TriangleMesh> mesh() && {
    return std::make_shared<const TriangleMesh>(std::move(mesh_));
  }

 private:
  std::uint32_t corner(double x, double y) {
    mesh_.vertices.push_back({x, y, z_m_});
    return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
  }
  double z_m_;
  TriangleMesh mesh_;
};

std::shared_ptr<const TriangleMesh> lines_of(const Spec& s) {
  Figures out(paint_m);
  const double x = s.length_m / 2, y = s.width_m / 2, line = s.line_m, mark = s.mark_diameter_m / 2;
  out.frame(-x, x, -y, y, line);
  out.rectangle(-line / 2, line / 2, -y + line, y - line);
  out.ring(0, 0, s.circle_radius_m - line, s.circle_radius_m, 0, math::tau);
  out.ring(0, 0, 0, mark, 0, math::tau);
  for (const double side : {1.0, -1.0}) {
    const auto area = [&](double width, double depth) {
      if (!(width > 0 && depth > 0)) return;
      const double in = side * (x - depth), edge = side * x;
      out.frame(std::min(in, edge), std::max(in, edge), -width / 2, width / 2, line);
    };
    area(s.penalty_area_width_m, s.penalty_area_depth_m);
    area(s.goal_area_width_m, s.goal_area_depth_m);
    out.ring(side * (x - s.penalty_mark_m), 0, 0, mark, 0, math::tau);
    for (const double other : {1.0, -1.0}) {
      // The quarter that lies in the field.
      const double from = side > 0 ? (other > 0 ? math::pi : math::pi / 2) : (other > 0 ? -math::pi / 2 : 0);
      out.ring(side * x, other * y, s.corner_radius_m - line, s.corner_radius_m, from, from + math::pi / 2);
    }
  }
  return std::move(out).mesh();
}

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  m.is_static = true;
  const std::uint32_t field = add_link(m, "field", {});
  const double x = s.length_m / 2 + s.border_m, y = s.width_m / 2 + s.border_m;
  if (s.ground) add_part(m, field, {.shape = Plane{{0, 0, 1}}, .color = {0.62f, 0.52f, 0.4f, 1}});
  Figures carpet(carpet_m);
  carpet.rectangle(-x, x, -y, y);
  add_part(m, field,
           {.shape = Mesh{std::move(carpet).mesh()}, .color = {0.15f, 0.43f, 0.19f, 1}, .touches = false});
  add_part(m, field, {.shape = Mesh{lines_of(s)}, .color = {0.94f, 0.94f, 0.92f, 1}, .touches = false});
  if (s.board_m > 0) {
    constexpr double thick = board_thickness_m;
    const auto board = [&](Vec3 at, Vec3 size) {
      add_part(m, field, {.shape = Box{size}, .X_LP = {at, {}}, .color = {0.25f, 0.26f, 0.28f, 1}});
    };
    for (const double side : {1.0, -1.0}) {  // those along x have the corners
      board({0, side * (y + thick / 2), s.board_m / 2}, {2 * (x + thick), thick, s.board_m});
      board({side * (x + thick / 2), 0, s.board_m / 2}, {thick, 2 * y, s.board_m});
    }
  }
  add_mass(m, field, 1, 1);  // a static body's is never used
  return out;
}

/// As make_builder does it, but what is not given comes from the size.
Result<Built> read_and_build(const Node& config, const std::string& path) {
  Spec spec;
  if (const Node* const size = config.find("size"))
    SL_TRY(read_value(*size, Field{"size", "", "Size."}, spec.size, path + "/size"));
  static_cast<soccer::Dimensions&>(spec) = soccer::dimensions_of(spec.size);
  SL_TRY(read_fields(config, spec, path));
  return build(spec);
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = [] {
  Builder made = make_builder<Spec, build>({
      .name = "soccer_field",
      .help = "Field of robot soccer with its lines, by the size of the league or by each dimension.",
  });
  made.build = read_and_build;
  return made;
}();

}  // namespace sandlot::builders::soccer_field
