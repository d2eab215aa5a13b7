#include "bench/msl_scene.h"

namespace sandlot::bench {
namespace {

constexpr double carpet_x = 24, carpet_y = 16, line = 0.125;

/// Whether there is white at (x, y), by the sizes of the rule book of 2023.
bool is_line(double x, double y) {
  x = std::abs(x), y = std::abs(y);
  // An outline whose outer edges lie at (length, width).
  const auto box = [&](double near, double length, double width) {
    const bool inside = x <= length && y <= width && x >= near;
    return inside && (x > length - line || y > width - line || (near > 0 && x < near + line));
  };
  if (box(0, 11, 7) || (x < line / 2 && y < 7)) return true;
  if (box(11 - 2.25, 11, 3.45) || box(11 - 0.75, 11, 1.95)) return true;
  const double centre = math::hypot(x, y), corner = math::hypot(11 - x, 7 - y);
  if (centre < 2 && centre > 2 - line) return true;
  if (x < 11 && y < 7 && corner < 0.75 && corner > 0.75 - line) return true;
  return math::hypot(x - 7.4, y) < 0.075 || centre < 0.075;
}

/// A body like that of a robot, turned and with facets: 2064 triangles.
std::shared_ptr<const TriangleMesh> robot_mesh() {
  auto mesh = std::make_shared<TriangleMesh>();
  constexpr std::uint32_t around = 43, rings = 25;
  for (std::uint32_t r = 0; r < rings; ++r)
    for (std::uint32_t i = 0; i < around; ++i) {
      const double z = 0.72 * r / (rings - 1), a = math::tau * i / around;
      const double radius = 0.25 * (z < 0.4 ? 1 : 0.55 + 0.45 * (0.72 - z) / 0.32) + 0.01 * math::cos(3 * a);
      const auto [s, c] = math::sincos(a);
      mesh->vertices.push_back({radius * c, radius * s, z});
    }
  for (std::uint32_t r = 0; r + 1 < rings; ++r)
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t a = r * around + i, b = r * around + (i + 1) % around;
      mesh->triangles.push_back({a, b, b + around});
      mesh->triangles.push_back({a, b + around, a + around});
    }
  return mesh;
}

Pose at(double x, double y, double z, double yaw = 0) { return pose_from_rpy({x, y, z}, {0, 0, yaw}); }

}  // namespace

std::shared_ptr<const optics::Texture> field_texture() {
  constexpr int per_m = 100, width = static_cast<int>(carpet_x) * per_m,
                height = static_cast<int>(carpet_y) * per_m;
  std::vector<std::uint8_t> rgb;
  rgb.reserve(std::size_t{3} * width * height);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const double x = (column + 0.5) / per_m - carpet_x / 2, y = carpet_y / 2 - (row + 0.5) / per_m;
      if (is_line(x, y)) rgb.insert(rgb.end(), {235, 235, 235});
      else rgb.insert(rgb.end(), {30, 120, 45});
    }
  return optics::Texture::make(width, height, rgb);
}

MslScene::MslScene() {
  frame.X_WG.push_back({});
  std::uint32_t count = 0;
  const auto add = [&](std::uint32_t group, Shape shape, Pose X, Color color,
                       std::uint16_t label) -> optics::SurfaceAppearance& {
    optics::PictureShape s;
    s.group = group;
    s.X_GC = X;
    s.shape = std::move(shape);
    s.body = group;
    s.moves = group > 0;
    s.appearance.diffuse = color;
    s.label = label;
    s.instance = ++count;
    shapes.push_back(std::move(s));
    return shapes.back().appearance;
  };
  add(0, Plane{{0, 0, 1}}, at(0, 0, -0.01), {0.45f, 0.45f, 0.42f, 1}, 1);
  add(0, Box{{carpet_x, carpet_y, 0.01}}, at(0, 0, -0.005), {1, 1, 1, 1}, 1).texture = field_texture();
  for (const double side : {-1.0, 1.0}) {
    const Color white{0.9f, 0.9f, 0.9f, 1},
        net = side > 0 ? Color{0.9f, 0.8f, 0.1f, 1} : Color{0.1f, 0.3f, 0.9f, 1};
    for (const double post : {-1.2625, 1.2625})
      add(0, Box{{0.125, 0.125, 1.125}}, at(side * 11, post, 0.5625), white, 2);
    add(0, Box{{0.125, 2.65, 0.125}}, at(side * 11, 0, 1.0625), white, 2);
    add(0, Box{{0.02, 2.4, 1}}, at(side * 11.6, 0, 0.5), net, 2);
  }
  Stream r(1, entity_key("field"), Purpose::placement, 0);
  const auto body = robot_mesh();
  const auto group = [&](Pose X) {
    frame.X_WG.push_back(X);
    return static_cast<std::uint32_t>(frame.X_WG.size() - 1);
  };
  for (int i = 0; i < 12; ++i) {
    const double x = -9 + 6 * (i % 4) + r.uniform(-1, 1), y = -5 + 5 * (i / 4) + r.uniform(-1, 1);
    robots.push_back(at(x, y, 0, r.uniform(-3, 3)));
    const std::uint32_t g = group(robots.back());
    const Color team = i % 2 ? Color{0.1f, 0.75f, 0.85f, 1} : Color{0.85f, 0.15f, 0.6f, 1};
    optics::SurfaceAppearance& appearance = add(g, Mesh{body}, at(0, 0, 0.03), {0.12f, 0.12f, 0.13f, 1}, 3);
    appearance.specular = {0.4f, 0.4f, 0.4f, 1};
    appearance.shininess = 30;
    add(g, Cylinder{0.2, 0.08}, at(0, 0, 0.6), team, 3);
    add(g, Box{{0.12, 0.34, 0.08}}, at(0.22, 0, 0.1), {0.3f, 0.3f, 0.3f, 1}, 3);
  }
  optics::SurfaceAppearance& ball = add(group(at(0.3, 0.2, 0.11)), Sphere{0.11}, {}, {0.95f, 0.5f, 0.05f, 1},
                                        4);
  ball.specular = {0.5f, 0.5f, 0.5f, 1};
  ball.shininess = 60;
  for (const double x : {-6.0, 1.0, 7.0})
    add(group(at(x, 7.4, 0.9)), Capsule{0.2, 1.4}, {}, {0.2f, 0.25f, 0.5f, 1}, 5);
  optics::PictureLight sun;
  sun.light.X_PLight.q = quat_between({0, 0, -1}, normalised(Vec3{0.4, 0.3, -1}));
  sun.light.color = {0.7f, 0.7f, 0.68f, 1};
  sun.light.specular = {0.5f, 0.5f, 0.5f, 1};
  sun.light.cast_shadows = true;
  lights.push_back(sun);
}

}  // namespace sandlot::bench
