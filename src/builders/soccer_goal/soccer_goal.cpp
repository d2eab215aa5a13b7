/// A goal with a net: posts, crossbar, and walls of net behind.
///
/// Frame    M: on the ground in the middle of the goal line's outer edge, x out of the field: the front of
///          the posts is at x = 0.
/// Size     inside, between the posts and below the bar. Default: the Middle Size League's, rule book of
///          2023.
/// Touches  as whole walls, so that neither balls nor lasers pass the net; one sees its cords. Nothing
///          bounces off the net: what flies into it drops, and stays behind the line.
#include <algorithm>
#include <cmath>

#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::soccer_goal {
namespace {

enum class Paint : std::uint8_t { white, blue, yellow };
std::span<const EnumName<Paint>> enum_names(Paint) {
  static constexpr EnumName<Paint> names[] = {
      {"white", Paint::white}, {"blue", Paint::blue}, {"yellow", Paint::yellow}};
  return names;
}

struct Spec {
  double width_m = 2.4, height_m = 1, depth_m = 0.6, post_m = 0.125, mesh_m = 0.1;
  Paint color = Paint::white;
  bool walls = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"width", "m", "Distance between the posts.", 0.1, 20}, s.width_m);
    visit(Field{"height", "m", "Height of the bar over the ground.", 0.1, 10}, s.height_m);
    visit(Field{"depth", "m", "Distance from the goal line to the back.", 0.05, 10}, s.depth_m);
    visit(Field{"post", "m", "Thickness of posts and bar, which are square.", 0.005, 1}, s.post_m);
    visit(Field{"mesh", "m", "Distance between the net's cords.", 0.02, 10}, s.mesh_m);
    visit(Field{"color", "", "Colour of net or walls; posts and bar are white."}, s.color);
    visit(Field{"walls", "", "Walls instead of the net, as in the league's early years."}, s.walls);
  }
  Status check(const Node& node, const std::string& path) const {
    if (width_m / mesh_m > 100 || height_m / mesh_m > 100 || depth_m / mesh_m > 100)
      return node.error("the net would have more than 100 cords to a side", "give a wider mesh",
                        path + "/mesh");
    if (depth_m > post_m) return {};
    return node.error("the goal is no deeper than its posts are thick", "give a larger depth",
                      path + "/depth");
  }
};

Color color_of(Paint paint) {
  switch (paint) {
    case Paint::blue: return {0.05f, 0.2f, 0.8f, 1};
    case Paint::yellow: return {0.95f, 0.8f, 0.05f, 1};
    case Paint::white: break;
  }
  return {0.8f, 0.8f, 0.8f, 1};
}

Result<Built> build(const Spec& s) {
  constexpr double cord = 0.008, wall = 0.02;
  Built out;
  model::Model& m = out.model;
  m.is_static = true;
  const std::uint32_t frame = add_link(m, "frame", {});
  const Color white{0.95f, 0.95f, 0.95f, 1}, net = color_of(s.color);
  const double side_y = s.width_m / 2 + s.post_m / 2, top_z = s.height_m + s.post_m / 2;
  for (const double side : {1.0, -1.0})
    add_part(m, frame,
             {.shape = Box{{s.post_m, s.post_m, s.height_m + s.post_m}},
              .X_LP = {{s.post_m / 2, side * side_y, (s.height_m + s.post_m) / 2}, {}},
              .color = white});
  add_part(m, frame,
           {.shape = Box{{s.post_m, s.width_m, s.post_m}},
            .X_LP = {{s.post_m / 2, 0, top_z}, {}},
            .color = white});

  // Walls of the net: their insides are flush with those of the posts. They begin behind the posts.
  const double length = s.depth_m + wall - s.post_m, middle_x = s.post_m + length / 2;
  model::Surface slack;
  if (!s.walls) slack.restitution_threshold_mps = 1000;
  const auto part = [&](Vec3 at, Vec3 size, bool touches) {
    add_part(m, frame,
             {.shape = Box{size},
              .X_LP = {at, {}},
              .color = net,
              .surface = slack,
              .touches = touches,
              .shown = !touches || s.walls});
  };
  const double wall_y = s.width_m / 2 + wall / 2, wall_z = s.height_m + wall / 2;
  part({s.depth_m + wall / 2, 0, s.height_m / 2}, {wall, s.width_m, s.height_m}, true);
  part({middle_x, 0, wall_z}, {length, s.width_m + 2 * wall, wall}, true);
  for (const double side : {1.0, -1.0})
    part({middle_x, side * wall_y, s.height_m / 2}, {length, wall, s.height_m}, true);
  if (s.walls) {
    add_mass(m, frame, 1, 1);  // a static body's is never used
    return out;
  }

  // Cords along a side of `length_m`, at equal distances of about the mesh, both ends included.
  const auto places = [&](double from, double to) {
    const int fields = std::max(1, static_cast<int>(std::floor((to - from) / s.mesh_m + 0.5)));
    std::vector<double> at;
    for (int i = 0; i <= fields; ++i) at.push_back(from + (to - from) * i / fields);
    return at;
  };
  const double back_x = s.depth_m + cord / 2, net_y = s.width_m / 2 + cord / 2, net_z = s.height_m + cord / 2;
  const double deep = s.depth_m + cord - s.post_m, deep_x = s.post_m + deep / 2;
  for (const double y : places(-net_y, net_y)) {
    part({back_x, y, s.height_m / 2}, {cord, cord, s.height_m}, false);
    part({deep_x, y, net_z}, {deep, cord, cord}, false);
  }
  for (const double z : places(cord / 2, s.height_m - s.mesh_m)) {
    part({back_x, 0, z}, {cord, s.width_m, cord}, false);
    for (const double side : {1.0, -1.0}) part({deep_x, side * net_y, z}, {deep, cord, cord}, false);
  }
  for (const double x : places(s.post_m + s.mesh_m, s.depth_m - s.mesh_m)) {
    part({x, 0, net_z}, {cord, s.width_m, cord}, false);
    for (const double side : {1.0, -1.0})
      part({x, side * net_y, s.height_m / 2}, {cord, cord, s.height_m}, false);
  }
  part({back_x, 0, net_z}, {cord, s.width_m, cord}, false);
  add_mass(m, frame, 1, 1);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "soccer_goal",
    .help = "Goal with a net, or with walls.",
});

}  // namespace sandlot::builders::soccer_goal
