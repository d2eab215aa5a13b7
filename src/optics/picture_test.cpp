#include "optics/picture.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>

#include "base/hash.h"
#include "base/math.h"
#include "geometry/mesh.h"
#include "optics/camera_rays.h"
#include "optics/test_studio.h"

namespace sandlot::optics {
namespace {

using namespace test;

/// The same lens with an image of one pixel, which looks through (u, v).
Lens through(Lens lens, double u, double v) {
  lens.width = lens.height = 1;
  std::visit([&](auto& m) { m.cx -= u, m.cy -= v; }, lens.model);
  return lens;
}

// ---- geometry

TEST(Picture, CornersOfABoxAreWhereTheLensProjectsThem) {
  using Mirror = Catadioptric::Mirror;
  Lens bent = pinhole_of_fov(640, 480, 1.2).value();
  std::get<Pinhole>(bent.model).k1 = -0.25;
  std::get<Pinhole>(bent.model).p1 = 0.002;
  const Pose ahead{{2, 0.3, -0.2}, quat_from_rpy(0, 0, 0.1)};
  const Lens lenses[] = {
      pinhole_of_fov(640, 480, 1.2).value(),
      bent,
      fisheye_of_fov(640, 480, 3.3, Fisheye::Mapping::equidistant).value(),
      fisheye_of_fov(640, 480, 3.3, Fisheye::Mapping::stereographic).value(),
      omni_that_fills(640, 480, {.mirror = Mirror::hyperbolic, .a_m = 0.0306, .b_m = 0.0674, .rim_m = 0.02})
          .value(),
      omni_that_fills(640, 480, {.mirror = Mirror::parabolic, .a_m = 0.03, .rim_m = 0.04}).value(),
      omni_that_fills(640, 480, {.mirror = Mirror::spherical, .a_m = 0.05, .b_m = 0.15, .rim_m = 0.035})
          .value()};
  const Vec3 size{0.001, 0.8, 0.6};
  Studio studio;
  studio.add(Box{size}, ahead);
  const Pose X_WS{{0.1, -0.05, 0.02}, quat_from_rpy(0.05, 0.02, -0.1)};
  for (const Lens& lens : lenses) {
    SCOPED_TRACE(lens.model.index());
    const auto seen = [&](Vec3 corner_B) { return *project(lens, inverse(X_WS) * (ahead * corner_B)); };
    const auto middle = seen({-size.x / 2, 0, 0});
    for (const double y : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5}) {
        const auto corner = seen({-size.x / 2, y * size.y, z * size.z});
        const double du = middle[0] - corner[0], dv = middle[1] - corner[1], length = math::hypot(du, dv);
        for (const double inwards : {-0.1, 0.1}) {
          PictureJob job;
          job.X_WS = X_WS;
          job.lens = LensTable::make(
              through(lens, corner[0] + inwards * du / length, corner[1] + inwards * dv / length));
          EXPECT_EQ(Shot(studio, job).label[0], inwards > 0 ? 1 : 0) << y << " " << z;
        }
      }
  }
}

TEST(Picture, DepthIsAlongTheAxisOrAllTheWay) {
  Studio studio;
  studio.add(Box{{1, 100, 100}}, {{3.5, 0, 0}, {}});
  PictureJob job;
  job.lens = pinhole();
  const Shot flat(studio, job);
  for (const float d : flat.depth_m) ASSERT_NEAR(d, 3, 2e-6);
  const Lens fish = fisheye_of_fov(161, 121, 1.5, Fisheye::Mapping::equidistant).value();
  job.lens = LensTable::make(fish);
  const Shot round(studio, job);
  EXPECT_NEAR(round.depth_m[round.index(80, 60)], 3, 2e-6);
  const double theta = 40 / std::get<Fisheye>(fish.model).fx;
  EXPECT_NEAR(round.depth_m[round.index(120, 60)], 3 / math::cos(theta), 1e-5);
  // A mirror: from its focus, although rays begin on its surface.
  const Lens omni = omni_that_fills(161, 121,
                                    {.mirror = Catadioptric::Mirror::parabolic, .a_m = 0.03, .rim_m = 0.05})
                        .value();
  job.lens = LensTable::make(omni);
  const Shot about(studio, job);
  const auto wall = *project(omni, {3, 0, 0.2});
  const int row = static_cast<int>(std::lround(wall[1]));
  const Vec3 d = ray_through(omni, 80, row)->direction;
  EXPECT_NEAR(about.depth_m[about.index(80, row)], 3 / d.x, 1e-4);
}

TEST(Picture, TheSameFarFromTheOrigin) {
  const auto shot = [](Vec3 place) {
    Studio studio;
    studio.frame.X_WG[0].p = place;
    studio.add(Plane{{0, 0, 1}}, {});
    studio.add(Sphere{0.2}, {{2, 0.3, 0.2}, {}});
    studio.add(Cylinder{0.2, 0.5}, {{2, -0.3, 0.25}, {}});
    PictureJob job;
    job.X_WS = {place + Vec3{0, 0, 0.4}, {}};
    job.lens = pinhole();
    return Shot(studio, job);
  };
  const Shot here = shot({}), there = shot({20000, -30000, 10});
  int other = 0;
  for (std::size_t i = 0; i < here.label.size(); ++i) {
    other += here.label[i] != there.label[i];
    if (here.label[i] == there.label[i] && here.label[i] > 0) {
      ASSERT_NEAR(here.depth_m[i], there.depth_m[i], 1e-4 * here.depth_m[i]);
    }
  }
  EXPECT_LE(other, 4);  // pixels on an edge may fall to either side
}

TEST(Picture, OfTwoThingsInOnePlaneTheLaterIsSeen) {
  for (const bool decal_last : {true, false}) {
    Studio studio;
    if (!decal_last) studio.add(Box{{6, 6, 0.02}}, {{4, 0, -0.01}, {}});
    studio.add(Plane{{0, 0, 1}}, {});
    if (decal_last) studio.add(Box{{6, 6, 0.02}}, {{4, 0, -0.01}, quat_from_rpy(0, 0, 0.3)});
    PictureJob job;
    job.X_WS = {{0, 0, 0.5}, {}};
    job.lens = pinhole(320, 240);
    const Shot shot(studio, job);
    // Well inside the decal: 2 m to 6 m ahead.
    for (double x = 2; x < 6; x += 0.05)
      for (double y = -1.2; y <= 1.2; y += 0.1) {
        const auto at = *project(job.lens->lens(), {x, y, -0.5});
        if (at[0] < 0 || at[0] > 318 || at[1] > 238) continue;
        ASSERT_EQ(shot.label[shot.index(static_cast<int>(std::lround(at[0])),
                                        static_cast<int>(std::lround(at[1])))],
                  2)
            << x << " " << y;
      }
  }
}

TEST(Picture, WhatIsIgnoredIsNotSeenButThrowsItsShadow) {
  Studio studio;
  studio.add(Plane{{0, 0, 1}}, {});
  studio.add(Box{{0.2, 0.2, 0.2}}, {{0, 0, 1}, {}}).body = 7;
  studio.light(model::Light::Type::directional, {{}, along({0, 0, -1})});
  PictureJob job;
  job.X_WS = above(0, 0, 3);
  job.lens = pinhole(81, 61);
  EXPECT_EQ(Shot(studio, job).label[30 * 81 + 40], 2);
  EXPECT_EQ(Shot(studio, job).instance[30 * 81 + 40], 1001u);
  job.ignore_body = 7;
  const Shot shot(studio, job);
  EXPECT_EQ(shot.label[shot.index(40, 30)], 1);
  EXPECT_EQ(shot.red(40, 30), 0);
  EXPECT_EQ(shot.red(60, 30), 255);
  job.exposure.shadows = false;
  EXPECT_EQ(Shot(studio, job).red(40, 30), 255);
}

// ---- light

TEST(Picture, LambertBlinnAndAmbientByHand) {
  Studio studio;
  PictureShape& floor = studio.add(Plane{{0, 0, 1}}, {}, {0.8f, 0.4f, 0, 1});
  floor.appearance.specular = {0.2f, 0.2f, 0.2f, 1};
  floor.appearance.shininess = 40;
  studio.surroundings.ambient = {0.1f, 0.1f, 0.1f, 1};
  // 60 degrees from the normal, in the plane of x and z.
  model::Light& sun = studio.light(model::Light::Type::directional,
                                   {{}, along({math::sin(math::pi / 3), 0, -0.5})});
  sun.color = {0.5f, 0.5f, 0.5f, 1};
  sun.specular = white;
  PictureJob job;
  job.lens = pinhole(1, 1, 0.1);
  job.X_WS = above(0, 0, 2);
  // Seen from above, half way between light and camera is 30 degrees off: cos^40 = 0.00317.
  const Shot matt(studio, job);
  EXPECT_NEAR(matt.rgb[0], 255 * (0.8 * (0.1 + 0.5 * 0.5) + 0.2 * 0.00317), 0.51);
  EXPECT_NEAR(matt.rgb[1], 255 * (0.4 * (0.1 + 0.5 * 0.5) + 0.2 * 0.00317), 0.51);
  EXPECT_NEAR(matt.rgb[2], 255 * 0.2 * 0.00317, 0.51);
  // Where the light is reflected to: all of the highlight.
  job.X_WS = {{2 * math::sin(math::pi / 3), 0, 1}, quat_from_rpy(0, math::pi / 6, math::pi)};
  EXPECT_NEAR(Shot(studio, job).rgb[2], 255 * 0.2, 0.51);
  // Gain multiplies, sRGB encodes: 0.2 * 2 -> 1.055 * 0.4^(1/2.4) - 0.055 (the specular colour 0.484529 is
  // 0.2 decoded).
  studio.shapes[0].appearance.specular = {0.484529f, 0.484529f, 0.484529f, 1};
  job.exposure.srgb = true;
  job.exposure.gain = 2;
  EXPECT_NEAR(Shot(studio, job).rgb[2], 255 * (1.055 * math::pow(0.4, 1 / 2.4) - 0.055), 0.6);
}

TEST(Picture, PointAndSpotLightsFadeByTheirFormulas) {
  Studio studio;
  studio.add(Plane{{0, 0, 1}}, {});
  model::Light& lamp = studio.light(model::Light::Type::point, {{0, 0, 1}, {}});
  lamp.constant = 1, lamp.linear = 0.3, lamp.quadratic = 0.7, lamp.range_m = 3;
  PictureJob job;
  job.lens = pinhole(1, 1, 0.05);
  const auto red = [&](double x) {
    job.X_WS = above(x, 0, 5);
    return static_cast<double>(Shot(studio, job).rgb[0]);
  };
  for (const double x : {0.0, 0.5, 1.0, 2.0}) {
    const double d = math::hypot(1, x);
    EXPECT_NEAR(red(x), 255 * (1 / d) / (1 + 0.3 * d + 0.7 * d * d), 0.6) << x;
  }
  EXPECT_EQ(red(2.9), 0);  // 3.07 m away
  // A spot from the same place: whole cones of 40 and 80 degrees.
  lamp.type = model::Light::Type::spot;
  lamp.inner_rad = 40 * math::pi / 180, lamp.outer_rad = 80 * math::pi / 180, lamp.falloff = 2;
  const auto fade = [&](double degrees) {
    const double c = math::cos(degrees * math::pi / 180), inner = math::cos(lamp.inner_rad / 2),
                 outer = math::cos(lamp.outer_rad / 2);
    const double d = 1 / c, part = std::min(1.0, std::max(0.0, (c - outer) / (inner - outer)));
    return 255 * c / (1 + 0.3 * d + 0.7 * d * d) * part * part;
  };
  for (const double degrees : {0.0, 15.0, 25.0, 30.0, 38.0, 42.0})
    EXPECT_NEAR(red(math::tan(degrees * math::pi / 180)), fade(degrees), 0.7) << degrees;
}

TEST(Picture, ShadowsEndWhereGeometrySays) {
  // A wall 1 m high at x = 0: the sun 45 degrees high throws 1 m; a lamp 3 m high and 2 m behind it 1 m: 2 /
  // 2 * 1.
  for (const auto type : {model::Light::Type::directional, model::Light::Type::point}) {
    Studio studio;
    studio.add(Plane{{0, 0, 1}}, {});
    studio.add(Box{{0.002, 4, 2}}, {{-0.001, 0, 0}, {}});
    model::Light& light = studio.light(type, {{-2, 0, 3}, along({1, 0, -1})});
    light.range_m = 100;
    PictureJob job;
    job.lens = pinhole(1, 1, 0.05);
    const auto lit = [&](double x) {
      job.X_WS = above(x, 0, 3);
      return Shot(studio, job).rgb[0] > 50;
    };
    EXPECT_FALSE(lit(0.1));
    EXPECT_FALSE(lit(0.998));
    EXPECT_TRUE(lit(1.002));
    studio.shapes[1].cast_shadows = false;
    EXPECT_TRUE(lit(0.5));
  }
}

TEST(Picture, NoSurfaceShadesItself) {
  Studio studio;
  for (int i = 0; i < 5; ++i) {
    const Pose X{{4, 2.0 * i - 4, 0}, quat_from_rpy(0.3, 0.2, 0.5 * i)};
    if (i == 0) studio.add(Sphere{0.8}, X);
    if (i == 1) studio.add(Box{{1, 1, 1}}, X);
    if (i == 2) studio.add(Cylinder{0.6, 1}, X);
    if (i == 3) studio.add(Cone{0.7, 1}, X);
    if (i == 4) studio.add(Mesh{std::make_shared<TriangleMesh>(tessellate(Box{{1, 1, 1}}))}, X);
  }
  studio.light(model::Light::Type::directional, {{}, along({1, -0.3, -0.4})});
  PictureJob job;
  job.lens = pinhole(320, 240);
  const Shot with(studio, job);
  job.exposure.shadows = false;
  EXPECT_EQ(with.rgb, Shot(studio, job).rgb);
}

TEST(Picture, NorFarAway) {
  // 3 km away a place is known to 0.2 mm, and to ten times that along a wall that is seen and lit aslant.
  Studio studio;
  studio.add(Mesh{std::make_shared<TriangleMesh>(tessellate(Box{{1, 400, 400}}))},
             {{3000, 0, 0}, quat_from_rpy(0.2, 0.3, 1.2)});
  studio.light(model::Light::Type::directional, {{}, along({1, 0.2, -0.1})});
  PictureJob job;
  job.lens = pinhole(320, 240, 0.1);
  const Shot with(studio, job);
  job.exposure.shadows = false;
  const Shot without(studio, job);
  EXPECT_EQ(with.rgb, without.rgb);
  EXPECT_GT(std::count_if(without.rgb.begin(), without.rgb.end(), [](auto x) { return x > 50 && x < 200; }),
            10000);
}

// ---- textures

TEST(Picture, ACheckerboardFadesIntoGreyTowardsTheHorizon) {
  std::vector<std::uint8_t> rgb;
  constexpr int side = 64, square = 8;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (int k = 0; k < 3; ++k) rgb.push_back((x / square + y / square) % 2 ? 255 : 0);
  Studio studio;
  PictureShape& floor = studio.add(Plane{{0, 0, 1}}, {{}, quat_from_rpy(0, 0, 0.4)});
  floor.appearance.texture = Texture::make(side, side, rgb);
  floor.appearance.tile_m = 1;  // squares of 12.5 cm
  studio.surroundings.ambient = white;
  PictureJob job;
  job.X_WS = {{0, 0, 1}, {}};
  job.lens = pinhole(320, 240);
  const Shot shot(studio, job);
  const auto row = [&](int v) {
    double sum = 0, square_sum = 0;
    for (int u = 0; u < 320; ++u) sum += shot.red(u, v), square_sum += shot.red(u, v) * shot.red(u, v);
    const double mean = sum / 320;
    return std::array{mean, std::sqrt(square_sum / 320 - mean * mean)};
  };
  // At row v a pixel is 160 / (v - 119.5)^2 m long and 1 / (v - 119.5) m wide. Five rows below the horizon
  // that is 18 cm across, more than a square: the pattern is gone. (The rounding of each level of the pyramid
  // may add half a grey.)
  for (const int v : {120, 121, 122, 124}) {
    EXPECT_NEAR(row(v)[0], 127.5, 3) << v;
    EXPECT_LT(row(v)[1], 6) << v;
  }
  // At the bottom it is 8 mm: nearly all is black or white, 127 from the mean but for edges.
  EXPECT_GT(row(239)[1], 105);
  EXPECT_EQ(shot.red(10, 10), 0);
}

TEST(Picture, TexturesLieWhereTheirCoordinatesSay) {
  // Four colours: red above left, green above right, blue below left, white below right.
  const std::vector<std::uint8_t> rgb{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  Studio studio;
  PictureShape& box = studio.add(Box{{1, 1, 1}}, {});
  box.appearance.texture = Texture::make(2, 2, rgb);
  studio.surroundings.ambient = white;
  PictureJob job;
  job.lens = pinhole(1, 1, 0.05);
  const auto color = [&](Vec3 eye, Vec3 rpy, Vec3 target) {
    job.X_WS = pose_from_rpy(eye + target, rpy);
    const Shot s(studio, job);
    return std::array<int, 3>{s.rgb[0], s.rgb[1], s.rgb[2]};
  };
  const std::array<int, 3> red{255, 0, 0}, green{0, 255, 0}, blue{0, 0, 255}, all{255, 255, 255};
  // Looking at the face towards +x from outside, its left is +y... of the world: -y is to the left.
  EXPECT_EQ(color({3, 0, 0}, {0, 0, math::pi}, {0, -0.25, 0.25}), red);
  EXPECT_EQ(color({3, 0, 0}, {0, 0, math::pi}, {0, 0.25, 0.25}), green);
  EXPECT_EQ(color({3, 0, 0}, {0, 0, math::pi}, {0, -0.25, -0.25}), blue);
  EXPECT_EQ(color({0, 3, 0}, {0, 0, -math::pi / 2}, {0.25, 0, 0.25}), red);
  EXPECT_EQ(color({0, -3, 0}, {0, 0, math::pi / 2}, {-0.25, 0, 0.25}), red);
  EXPECT_EQ(color({-3, 0, 0}, {0, 0, 0}, {0, 0.25, 0.25}), red);
  EXPECT_EQ(color({0, 0, 3}, {0, math::pi / 2, 0}, {-0.25, 0.25, 0}), red);
  EXPECT_EQ(color({0, 0, 3}, {0, math::pi / 2, 0}, {0.25, -0.25, 0}), all);
  // A mesh says itself.
  auto quad = std::make_shared<TriangleMesh>();
  quad->vertices = {{0, 0.5, -0.5}, {0, -0.5, -0.5}, {0, -0.5, 0.5}, {0, 0.5, 0.5}};
  quad->triangles = {{0, 1, 2}, {0, 2, 3}};
  quad->texture_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  studio.shapes[0].shape = Mesh{quad};
  EXPECT_EQ(color({-3, 0, 0}, {0, 0, 0}, {0, 0.25, 0.25}), red);
  EXPECT_EQ(color({-3, 0, 0}, {0, 0, 0}, {0, -0.25, -0.25}), all);
}

// ---- lens and time

/// How the brightness of a row falls from white to black: place and spread of the edge.
struct Edge {
  double place = 0, variance = 0;
  Edge(const Shot& shot, int v) {
    std::vector<double> weight;
    double sum = 0;
    for (int u = 0; u + 1 < shot.width; ++u) {
      weight.push_back((shot.red(u, v) - shot.red(u + 1, v)) / 255.0);
      sum += weight.back();
      place += weight.back() * (u + 0.5);
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    for (std::size_t u = 0; u < weight.size(); ++u) {
      const double d = static_cast<double>(u) + 0.5 - place;
      variance += weight[u] * d * d;
    }
  }
};

TEST(Picture, CircleOfConfusionIsThatOfAThinLens) {
  Studio studio;
  // A white half plane at 4 m, its edge on the optical axis.
  studio.glow(Box{{0.01, 40, 80}}, {{4.005, 20, 0}, {}});
  PictureJob job;
  job.lens = pinhole(200, 1, 0.5);
  const double f = std::get<Pinhole>(job.lens->lens().model).fx;
  job.exposure.samples = 256;
  job.exposure.aperture_m = 0.1;
  for (const double focus : {2.0, 4.0, 8.0}) {
    job.exposure.focus_m = focus;
    const Edge edge(Shot(studio, job), 0);
    // Its diameter in pixels; an edge seen through a disc of diameter c has a variance of c^2 / 16, and a
    // pixel adds 1 / 12.
    const double c = f * 0.1 * std::abs(4 - focus) / (4 * focus);
    EXPECT_NEAR(edge.place, 99.5, 0.1);
    EXPECT_NEAR(edge.variance, c * c / 16 + 1 / 12.0, 0.05 * c * c / 16 + 0.2) << focus;
  }
}

TEST(Picture, WhatIsSharpLiesInAPlane) {
  Studio studio;
  // A white half plane at 4 m, its edge 45 degrees to the left: 5.7 m from the lens.
  studio.glow(Box{{0.001, 40, 80}}, {{4.0005, 24, 0}, {}});
  PictureJob job;
  job.lens = pinhole(200, 1, 2);
  const double f = std::get<Pinhole>(job.lens->lens().model).fx;
  job.exposure.samples = 256;
  job.exposure.aperture_m = 1;
  job.exposure.focus_m = 4;
  const Edge edge(Shot(studio, job), 0);
  EXPECT_NEAR(edge.place, 99.5 - f, 0.1);
  // On a sphere of 4 m the edge would lie behind what is sharp by 1.2 m: (f / 9.7)^2 / 16 = 2.7 more.
  EXPECT_NEAR(edge.variance, 1 / 12.0, 0.2);
}

TEST(Picture, RollingShutterShearsWhatMoves) {
  for (const bool camera_moves : {false, true}) {
    Studio studio;
    studio.glow(Box{{0.01, 40, 80}}, {{2.005, 20, 0}, {}});
    PictureJob job;
    job.lens = pinhole(160, 121);
    job.exposure.readout_s = 0.05;
    job.exposure.slices = 121;  // one for each row
    // To the right at 4 m/s against the camera: 80 px/m at 2 m, 40 cm... 40 mm from one row to the 25th next.
    if (camera_moves) job.velocity.linear = {0, 4, 0};
    else studio.velocities = {Velocity{{0, -4, 0}, {}}};
    const Shot shot(studio, job);
    const auto edge = [&](int v) {
      int u = 0;
      while (u < 160 && shot.label[shot.index(u, v)] == 1) ++u;
      return u - 0.5;
    };
    // 0.05 s of 4 m/s at 2 m: 0.2 m * 80 px / 2 m = 8 px.
    EXPECT_NEAR(edge(0), 79.5, 0.51);
    EXPECT_NEAR(edge(60), 83.5, 0.51);
    EXPECT_NEAR(edge(120), 87.5, 0.51);
  }
}

TEST(Picture, AShutterSmearsWhatMoves) {
  Studio studio;
  studio.glow(Box{{0.01, 40, 80}}, {{2.005, 20, 0}, {}});
  studio.velocities = {Velocity{{0, -10, 0}, {}}};
  PictureJob job;
  job.lens = pinhole(160, 8);
  job.exposure.shutter_s = 0.04;
  job.exposure.samples = 64;
  job.exposure.slices = 32;
  const Edge edge(Shot(studio, job), 3);
  // 0.4 m at 2 m: a ramp of 16 px about the middle; its variance is 16^2 / 12.
  EXPECT_NEAR(edge.place, 79.5, 0.1);
  EXPECT_NEAR(edge.variance, 16 * 16 / 12.0, 0.6);
  // And a picture after it is sharp again.
  job.exposure = Exposure{};
  EXPECT_NEAR(Edge(Shot(studio, job), 3).variance, 0, 0.3);
}

// ---- repeatability

std::uint64_t hash_of(const Shot& shot) {
  std::uint64_t h = hash64(std::string_view(reinterpret_cast<const char*>(shot.rgb.data()), shot.rgb.size()));
  return h ^ hash64(std::string_view(reinterpret_cast<const char*>(shot.depth_m.data()),
                                     4 * shot.depth_m.size()));
}

TEST(Picture, TheSamePixelsForAnyNumberOfThreadsAndAgain) {
  const auto draw = [](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute([] {
      Studio studio;
      studio.add(Plane{{0, 0, 1}}, {}).appearance.texture = Texture::missing();
      for (int i = 0; i < 20; ++i)
        studio.add(Sphere{0.2}, {{2 + 0.3 * i, 0.4 * (i % 5) - 1, 0.2}, {}},
                   {0.5f, 0.05f * static_cast<float>(i), 0.3f, 1});
      studio.add(Mesh{std::make_shared<TriangleMesh>(tessellate(Sphere{0.3}))}, {{1.5, 0.8, 0.5}, {}});
      studio.light(model::Light::Type::directional, {{}, along({0.4, 0.2, -1})});
      studio.light(model::Light::Type::point, {{1, 1, 2}, {}});
      studio.velocities = {Velocity{{0.5, 0, 0}, {0, 0, 1}}};
      PictureJob job;
      job.X_WS = {{0, 0, 0.6}, {}};
      job.lens = pinhole(130, 70);
      job.key = 42;
      job.exposure.samples = 4;
      job.exposure.aperture_m = 0.02;
      job.exposure.focus_m = 3;
      const Shot first(studio, job);
      job.exposure.shutter_s = 0.02;
      const Shot blurred(studio, job);
      EXPECT_NE(hash_of(first), hash_of(blurred));
      job.exposure.shutter_s = 0;
      EXPECT_EQ(hash_of(first), hash_of(Shot(studio, job)));
      job.key = 43;
      EXPECT_NE(hash_of(first), hash_of(Shot(studio, job)));
      return std::array{hash_of(first), hash_of(blurred)};
    });
  };
  const auto one = draw(1);
  EXPECT_EQ(one, draw(2));
  EXPECT_EQ(one, draw(4));
}

TEST(Picture, AShutterTooShortToBeHalvedStandsStill) {
  PictureJob job;
  job.lens = pinhole(16, 16);
  for (const double shutter_s : {0.0, 5e-324, 1e-320, 0.01}) {
    job.exposure.shutter_s = shutter_s;
    EXPECT_EQ(CameraRays(job).slices(), shutter_s > 5e-324 ? 8 : 1) << shutter_s;
  }
}

TEST(Picture, SamplesDoNotMoveThePicture) {
  // An edge at a place between pixels: what the samples cover of the pixel is where it is cut.
  Studio studio;
  PictureJob job;
  job.lens = pinhole(161, 8);
  job.exposure.samples = 64;
  studio.glow(Box{{0.01, 40, 80}}, {{2.005, 20 + 0.3 / 40.25, 0}, {}});  // 40.25 px/m at 2 m: cut at 80 - 0.3
  const Shot shot(studio, job);
  EXPECT_NEAR(shot.red(80, 4), 255 * 0.2, 255 * 1.5 / 64);
  EXPECT_EQ(shot.red(79, 4), 255);
  EXPECT_EQ(shot.red(81, 4), 0);
}

}  // namespace
}  // namespace sandlot::optics
