#include "optics/surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "geometry/mesh.h"
#include "optics/sample.h"

namespace sandlot::optics {
namespace {

TEST(Texture, EachLevelHasTheMeanOfTheOneBelow) {
  std::vector<std::uint8_t> rgb;
  double sum = 0;
  constexpr int w = 37, h = 22;
  for (int i = 0; i < w * h; ++i) {
    const auto x = static_cast<std::uint8_t>(i * 7919 % 256);
    rgb.insert(rgb.end(), {x, 100, static_cast<std::uint8_t>(255 - x)});
    sum += x;
  }
  const auto t = Texture::make(w, h, rgb);
  const Texture::Level last = t->levels().back();
  EXPECT_EQ(last.width, 1u);
  const std::uint32_t texel = t->texels()[last.first];
  // Every level rounds to the nearest: less than half a grey each.
  EXPECT_NEAR(texel & 255, sum / (w * h), 0.5 * static_cast<double>(t->levels().size()));
  EXPECT_EQ(texel >> 8 & 255, 100u);
  EXPECT_EQ(texel >> 24, 0u);  // not plain
}

TEST(Texture, PlainRegionsAreWhatFilteringWouldGive) {
  // Grey with one white dot: wherever the footprint is, the answer lies between; and grey exactly where the
  // dot is far.
  constexpr int side = 256;
  std::vector<std::uint8_t> rgb(3 * side * side, 90);
  for (std::size_t k = 0; k < 3; ++k) rgb[3 * (100 * side + 130) + k] = 255;
  const auto texture = Texture::make(side, side, rgb);
  const double u0 = 130.5 / side, v0 = 1 - 100.5 / side;
  for (const double length : {0.3, 2.0, 9.0, 40.0})
    for (int k = 0; k < 32; ++k) {
      const double angle = math::tau * k / 32, away = (0.5 * length + 1.2) / side;
      const auto [s, c] = math::sincos(angle);
      Footprint8 f{};
      const auto broadcast = [](double x) { return lanes::broadcast(static_cast<float>(x)); };
      // The footprint points at the dot and ends 1.2 texels before it: level 0 would not see it across.
      f.u = broadcast(u0 + away * c), f.v = broadcast(v0 + away * s);
      f.du[0] = broadcast(length / side * c), f.dv[0] = broadcast(length / side * s);
      f.du[1] = broadcast(-0.5 / side * s), f.dv[1] = broadcast(0.5 / side * c);
      const auto near = sample(*texture, f, lanes::broadcast(-1));
      EXPECT_GE(near.x[0], 90 / 255.0f - 1e-6f);
      // On the dot it must be felt.
      f.u = broadcast(u0), f.v = broadcast(v0);
      EXPECT_GT(sample(*texture, f, lanes::broadcast(-1)).x[3], 90.4f / 255) << length << " " << k;
    }
}

TEST(Surface, NormalsAndGradientsOfSolids) {
  const auto f3 = [](Vec3 a) {
    return lanes::F3{lanes::broadcast(static_cast<float>(a.x)), lanes::broadcast(static_cast<float>(a.y)),
                     lanes::broadcast(static_cast<float>(a.z))};
  };
  const double k = std::sqrt(0.5);
  struct Case {
    Shape shape;
    Vec3 at, normal;
  };
  const Case cases[] = {
      {Box{{2, 1, 0.5}}, {1, 0.2, 0.1}, {1, 0, 0}},
      {Box{{2, 1, 0.5}}, {0.3, -0.5, 0.1}, {0, -1, 0}},
      {Box{{2, 1, 0.5}}, {0.3, 0.2, -0.25}, {0, 0, -1}},
      {Sphere{2}, {2 * k, 0, 2 * k}, {k, 0, k}},
      {Sphere{2}, {-1.2, 1.6, 0}, {-0.6, 0.8, 0}},
      {Cylinder{0.5, 2}, {0.3, 0.4, 0.7}, {0.6, 0.8, 0}},
      {Cylinder{0.5, 2}, {0.2, 0.1, -1}, {0, 0, -1}},
      {Capsule{0.5, 2}, {0.5, 0, 0.3}, {1, 0, 0}},
      {Capsule{0.5, 2}, {0.5 * k, 0, 1 + 0.5 * k}, {k, 0, k}},
      {Cone{1, 2}, {0.5, 0, 0}, {2 / std::sqrt(5.0), 0, 1 / std::sqrt(5.0)}},
      {Cone{1, 2}, {0.5, 0.2, -1}, {0, 0, -1}},
      // x^2/4 + y^2 + z^2 = 1 at (1, sqrt(3)/2, 0): gradient (1/2, sqrt(3), 0).
      {Ellipsoid{{2, 1, 1}}, {1, std::sqrt(0.75), 0}, {0.5 / std::sqrt(3.25), std::sqrt(3 / 3.25), 0}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(shape_name(c.shape));
    const Solid solid = make_solid(c.shape, 0);
    const Surface8 s = surface_of(solid, f3(c.at), true);
    EXPECT_NEAR(s.normal.x[0], c.normal.x, 1e-5);
    EXPECT_NEAR(s.normal.y[3], c.normal.y, 1e-5);
    EXPECT_NEAR(s.face_normal.z[7], c.normal.z, 1e-5);
    // u and v change along the surface by their gradients: steps of 1 mm, so up to 1e-3 of curvature and
    // rounding.
    const Vec3 t1 = normalised(cross(c.normal, {0.3, 0.5, 0.8})), t2 = cross(c.normal, t1);
    for (const Vec3 t : {t1, t2}) {
      const double h = 1e-3;
      const Surface8 more = surface_of(solid, f3(c.at + h * t), true),
                     less = surface_of(solid, f3(c.at - h * t), true);
      const auto slope = [&](const lanes::F3& g) {
        return static_cast<double>(g.x[0]) * t.x + static_cast<double>(g.y[0]) * t.y +
               static_cast<double>(g.z[0]) * t.z;
      };
      EXPECT_NEAR(static_cast<double>(more.u[0] - less.u[0]) / (2 * h), slope(s.u_gradient), 2e-3);
      if (!std::holds_alternative<Capsule>(c.shape)) {
        EXPECT_NEAR(static_cast<double>(more.v[0] - less.v[0]) / (2 * h), slope(s.v_gradient), 2e-3);
      }
    }
  }
}

TEST(Surface, MeshesAreSmoothButForTheirCreases) {
  const auto at = [](const TriangleMesh& mesh, bool smooth, std::size_t triangle) {
    const Skin skin(Mesh{std::make_shared<TriangleMesh>(mesh)}, smooth);
    const Surface8 s = skin.surface(lanes::broadcast(-1), lanes::broadcast(static_cast<int>(triangle)),
                                    lanes::broadcast(0.0f), lanes::broadcast(0.0f), lanes::F3{}, false);
    return Vec3{static_cast<double>(s.normal.x[0]), static_cast<double>(s.normal.y[0]),
                static_cast<double>(s.normal.z[0])};
  };
  // At its vertices a sphere of triangles has the sphere's normals, within what 32 segments leave.
  const TriangleMesh ball = tessellate(Sphere{1});
  const TriangleMesh cube = tessellate(Box{{1, 1, 1}});
  for (std::size_t t = 0; t < ball.triangles.size(); t += 37) {
    const Vec3 place = ball.vertices[ball.triangles[t][0]];
    EXPECT_GT(dot(at(ball, true, t), place), 0.995);
  }
  for (std::size_t t = 0; t < cube.triangles.size(); ++t)
    EXPECT_NEAR(norm(at(cube, true, t) - at(cube, false, t)), 0, 1e-6);
}

}  // namespace
}  // namespace sandlot::optics
