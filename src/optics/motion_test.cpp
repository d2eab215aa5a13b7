/// Meshes and lights that move while the picture is taken, against the mean over the exposure in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "geometry/mesh.h"
#include "optics/test_studio.h"

namespace sandlot::optics {
namespace {

using namespace test;

Shape as_mesh(const Shape& shape) { return Mesh{std::make_shared<TriangleMesh>(tessellate(shape))}; }

/// The integral of the part of [-width / 2, width / 2] below x.
double ramp(double x, double width) {
  const double inside = std::clamp(x + width / 2, 0.0, width);
  return inside * inside / 2 + width * std::max(0.0, x - width / 2);
}

TEST(Motion, AMovingMeshCoversEachPixelForItsShareOfTheExposure) {
  // A board 1 m wide at 2 m, 0.4 m to the left during the exposure: 40 px and 16 px. How long its left edge,
  // which moves from 16 px / 2 right of its middle place to as much left, has been past a place is a ramp,
  // and a pixel the mean of it.
  Studio studio;
  studio.glow(as_mesh(Box{{0.01, 1, 1}}), {{2.005, 0, 0}, {}});
  studio.velocities = {Velocity{{0, 10, 0}, {}}};
  PictureJob job;
  job.lens = pinhole(160, 8);  // 80 px per metre at 1 m
  job.exposure.shutter_s = 0.04;
  job.exposure.samples = 256;
  job.exposure.slices = 64;
  const Shot shot(studio, job);
  const double moved_px = 16, left = 79.5 - 20, right = 79.5 + 20;
  const auto past = [&](double edge, double u) {  // share of pixel and time right of the edge
    return (ramp(u + 0.5 - edge, moved_px) - ramp(u - 0.5 - edge, moved_px)) / moved_px;
  };
  for (int u = 0; u < 160; ++u) {
    const double share = past(left, u) - past(right, u);
    // An edge crosses a pixel in 4 of the 64 slices; what each covers of the pixel is estimated by 4 samples,
    // half of one too much or too little, and the slices at both ends of the crossing may be off as a whole.
    EXPECT_NEAR(shot.red(u, 4) / 255.0, share, (4 * 0.125 + 1) / 64 + 1 / 255.0) << u;
  }
}

TEST(Motion, ATurningMeshCoversAnAngleForItsShareOfTheExposure) {
  // A triangle from the optical axis outwards, 0.2 rad to each side of the left-hand direction, turns by 0.8
  // rad.
  constexpr double half = 0.2, turned = 0.8, length = 3;
  auto blade = std::make_shared<TriangleMesh>();
  blade->vertices = {{0, 0, 0},
                     {0, length * math::cos(half), -length * math::sin(half)},
                     {0, length * math::cos(half), length * math::sin(half)}};
  blade->triangles = {{0, 1, 2}};
  Studio studio;
  studio.glow(Mesh{blade}, {{2, 0, 0}, {}});
  studio.velocities = {Velocity{{}, {turned / 0.01, 0, 0}}};
  PictureJob job;
  job.lens = pinhole(161, 161);
  job.exposure.shutter_s = 0.01;
  job.exposure.samples = 256;
  job.exposure.slices = 64;
  const Shot shot(studio, job);
  int seen = 0;
  for (int i = -40; i <= 40; ++i) {
    const double angle = 0.02 * i;
    const int u = 80 - static_cast<int>(std::lround(70 * math::cos(angle))),
              v = 80 - static_cast<int>(std::lround(70 * math::sin(angle)));
    const double there = math::atan2(80.0 - v, 80.0 - u);
    const double low = std::max(there - half, -turned / 2), high = std::min(there + half, turned / 2);
    const double share = std::max(0.0, high - low) / turned;
    seen += share > 0 && share < 0.5;
    // An edge needs 1.4 px / 70 px = 0.02 rad = 2 slices to cross a pixel; the kinks of the share are rounded
    // off within it.
    EXPECT_NEAR(shot.red(u, v) / 255.0, share, 2 / 64.0 + 1 / 255.0) << angle;
  }
  EXPECT_GT(seen, 10);
}

TEST(Motion, RollingShutterShearsAMeshRowByRow) {
  Studio studio;
  studio.glow(as_mesh(Box{{0.01, 40, 80}}), {{2.005, 20, 0}, {}});
  studio.velocities = {Velocity{{0, -4, 0}, {}}};
  PictureJob job;
  job.lens = pinhole(160, 121);
  job.exposure.readout_s = 0.05;
  job.exposure.slices = 121;
  const Shot shot(studio, job);
  for (int v = 0; v < 121; ++v) {
    // 0.2 m at 2 m from the first row to the last: 8 px. A slice is 8 / 121 px long.
    const double edge = 79.5 + 8 * v / 120.0;
    for (int u = 70; u < 100; ++u) {
      if (std::abs(u - edge) < 8 / 121.0) continue;
      EXPECT_EQ(shot.red(u, v), u < edge ? 255 : 0) << u << ", " << v;
      EXPECT_EQ(shot.label[shot.index(u, v)], u < edge ? 1 : 0) << u << ", " << v;
    }
  }
}

/// A white floor below a camera, and a lamp 1 m above it that hangs on a group of its own, moving along y.
struct Lamp : Studio {
  Lamp(double speed_mps) {
    add(as_mesh(Box{{20, 20, 0.1}}), {{0, 0, -0.05}, {}});
    frame.X_WG.push_back({{0, 0, 1}, {}});
    light(model::Light::Type::point, {}).range_m = 1000;
    lights.back().group = 1;
    velocities = {Velocity{}, Velocity{{0, speed_mps, 0}, {}}};
  }
};

TEST(Motion, AMovingLightLightsByTheMeanOverTheExposure) {
  // Without attenuation the floor at y shows 1 / sqrt(1 + (y - s)^2), the light being at s; s goes from -1 m
  // to 1 m.
  Lamp lamp(50);
  PictureJob job;
  job.X_WS = above(0, 0, 3);
  job.lens = pinhole(121, 121);
  job.exposure.shutter_s = 0.04;
  job.exposure.samples = 64;
  const Shot shot(lamp, job);
  const double f = std::get<Pinhole>(job.lens->lens().model).fx;
  for (int u = 0; u < 121; u += 5) {
    const double y = (60 - u) / f * 3;
    const auto integral = [](double x) {
      return math::log(x + std::sqrt(x * x + 1));
    };  // of 1 / sqrt(x^2 + 1)
    const double mean = (integral(y + 1) - integral(y - 1)) / 2;
    // Eight slices of 0.25 m: the midpoint rule is off by 0.25^2 / 24 times the largest curvature, which is
    // 1. A pixel is 0.05 m: the mean over it differs by less.
    EXPECT_NEAR(shot.red(u, 60) / 255.0, mean, 0.25 * 0.25 / 24 + 0.05 * 0.05 / 24 + 0.5 / 255) << y;
  }
}

TEST(Motion, UnderARollingShutterEachRowHasTheLightOfItsTime) {
  Lamp lamp(40);
  PictureJob job;
  job.X_WS = above(0, 0, 3);
  job.lens = pinhole(121, 121);
  job.exposure.readout_s = 0.05;
  job.exposure.slices = 100;
  const Shot shot(lamp, job);
  const double f = std::get<Pinhole>(job.lens->lens().model).fx;
  for (int v = 0; v < 121; v += 10) {
    const double x = (60 - v) / f * 3, s = 2 * v / 120.0;
    // The light jumps 0.02 m from slice to slice, and brightness changes by less than 0.385 per metre.
    EXPECT_NEAR(shot.red(60, v) / 255.0, 1 / std::sqrt(1 + x * x + s * s), 0.385 * 0.01 + 0.5 / 255) << v;
  }
}

TEST(Motion, ATurningSunLightsByTheMeanOverTheExposure) {
  Studio studio;
  studio.add(as_mesh(Box{{20, 20, 0.1}}), {{0, 0, -0.05}, {}});
  studio.light(model::Light::Type::directional, {{}, along({0, 0.6, -0.8})});
  constexpr double turned = 1.0;
  studio.velocities = {Velocity{}, Velocity{{}, {turned / 0.02, 0, 0}}};
  studio.frame.X_WG.push_back({});
  studio.lights.back().group = 1;
  PictureJob job;
  job.X_WS = above(0, 0, 3);
  job.lens = pinhole(9, 9);
  job.exposure.shutter_s = 0.02;
  job.exposure.samples = 32;
  job.exposure.slices = 32;
  const Shot shot(studio, job);
  // The cosine's mean over a turn by `turned` about it is its value in the middle times sin(turned / 2) /
  // (turned / 2). The midpoint rule with 32 slices is off by (1 / 32)^2 / 24.
  const double mean = 0.8 * math::sin(turned / 2) / (turned / 2);
  EXPECT_NEAR(shot.red(4, 4) / 255.0, mean, 1 / 1024.0 / 24 + 0.5 / 255 + 1e-4);
}

}  // namespace
}  // namespace sandlot::optics
