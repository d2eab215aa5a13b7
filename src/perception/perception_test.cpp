#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "base/math.h"
#include "base/random.h"
#include "perception/finder.h"
#include "perception/scan_match.h"

namespace sandlot::perception {
namespace {

constexpr double degree = math::pi / 180;

msg::Image picture(std::uint32_t width, std::uint32_t height) {
  msg::Image image;
  image.width = width, image.height = height, image.step = 3 * width, image.encoding = "rgb8";
  image.data.assign(std::size_t{3} * width * height, 90);
  return image;
}
void dot_at(msg::Image& image, std::uint32_t u, std::uint32_t v, std::array<std::uint8_t, 3> colour) {
  std::copy(colour.begin(), colour.end(), image.data.begin() + image.step * v + 3 * u);
}
constexpr std::array<std::uint8_t, 3> orange{255, 120, 10}, blue{20, 40, 230}, grey{90, 90, 90};

msg::CameraInfo camera(std::uint32_t width, std::uint32_t height, double f) {
  msg::CameraInfo info;
  info.width = width, info.height = height, info.distortion_model = "plumb_bob";
  info.k = {f, 0, 0.5 * (width - 1), 0, f, 0.5 * (height - 1), 0, 0, 1};
  return info;
}
/// VStone's mirror, five times as large; its rim fills the image.
msg::CameraInfo mirror(std::uint32_t side) {
  msg::CameraInfo info = camera(side, side, 0);
  const double a = 5e-3 * std::sqrt(233.3), b = 5e-3 * std::sqrt(1135.7), rim = 0.05;
  const double at = b * std::sqrt(1 + rim * rim / (a * a)) + std::sqrt(a * a + b * b);
  info.k[0] = info.k[4] = 0.5 * side * at / rim;
  info.distortion_model = "mirror_hyperbolic";
  info.d = {a, b, rim};
  return info;
}

/// A camera on a robot whose pictures are painted: each pixel by what its ray, from the middle of the lens,
/// meets.
struct Painter {
  const char* name;
  CameraModel model;
  Pose X_BS;
  std::vector<std::optional<Vec3>> directions_B;

  Painter(const char* called, const msg::CameraInfo& info, const Pose& at)
      : name(called), model(*CameraModel::of(info)), X_BS(at) {
    for (int v = 0; v < model.height(); ++v)
      for (int u = 0; u < model.width(); ++u) {
        const auto ray = model.ray(u, v);
        directions_B.push_back(ray ? std::optional(rotate(X_BS.q, ray->direction)) : std::nullopt);
      }
  }
  msg::Image paint(
      const std::function<std::array<std::uint8_t, 3>(Vec3 origin, Vec3 direction)>& colour) const {
    msg::Image image = picture(static_cast<std::uint32_t>(model.width()),
                               static_cast<std::uint32_t>(model.height()));
    for (std::uint32_t i = 0; i < directions_B.size(); ++i)
      if (directions_B[i]) dot_at(image, i % image.width, i / image.width, colour(X_BS.p, *directions_B[i]));
    return image;
  }
};

bool meets_ball(Vec3 origin, Vec3 direction, Vec3 middle, double radius) {
  const Vec3 to = middle - origin;
  const double along = dot(to, direction);
  return along > 0 && dot(to, to) - along * along < radius * radius;
}
/// An upright cylinder from the ground up.
bool meets_post(Vec3 o, Vec3 d, Vec3 foot, double radius, double height) {
  const double x = o.x - foot.x, y = o.y - foot.y, a = d.x * d.x + d.y * d.y, b = x * d.x + y * d.y;
  const double root = b * b - a * (x * x + y * y - radius * radius);
  if (root < 0) return false;
  const double t = (-b - std::sqrt(root)) / a, z = o.z + t * d.z;
  return t > 0 && z > 0 && z < height;
}

TEST(Perception, HuesAreThoseOfTheHexagon) {
  const auto hue = [](double r, double g, double b) { return hsv_of(r, g, b).hue_rad / degree; };
  EXPECT_NEAR(hue(1, 0, 0), 0, 1e-12);
  EXPECT_NEAR(hue(1, 0.5, 0), 30, 1e-12);
  EXPECT_NEAR(hue(0, 1, 0), 120, 1e-12);
  EXPECT_NEAR(hue(0, 0.25, 1), 225, 1e-12);
  EXPECT_NEAR(hue(1, 0, 0.5), 330, 1e-12);
  EXPECT_NEAR(hsv_of(0.8, 0.4, 0.4).saturation, 0.5, 1e-12);
  ColourRange red;
  red.hue_rad = -0.1, red.hue_tolerance_rad = 0.2;  // across 0
  EXPECT_TRUE(red.holds({6.1, 1, 1}));
  EXPECT_TRUE(red.holds({0.05, 1, 1}));
  EXPECT_FALSE(red.holds({0.2, 1, 1}));
  EXPECT_FALSE(red.holds({0.05, 0.2, 1}));
}

TEST(Perception, AColourIsKnownInShadowAndWhiteIsNoColour) {
  const ColourRange ball = range_around(1, 0.5, 0.05);
  const ColourRange ranges[] = {ball, range_around(0.95, 0.95, 0.95)};
  const ColourTable table(ranges);
  EXPECT_EQ(table.of(255, 128, 13), 1);
  EXPECT_EQ(table.of(64, 32, 3), 1);     // a quarter of the light
  EXPECT_EQ(table.of(255, 160, 80), 1);  // a highlight
  EXPECT_EQ(table.of(240, 240, 240), 2);
  EXPECT_EQ(table.of(20, 120, 30), 0);  // grass
  EXPECT_EQ(table.of(100, 100, 100), 0);
}

TEST(Perception, PatchesAreCountedAcrossSpecks) {
  // A ring of 5 x 4 with a speck of noise in each row, another colour next to it, and one pixel alone.
  msg::Image image = picture(20, 10);
  for (std::uint32_t v = 2; v < 6; ++v)
    for (std::uint32_t u = 3; u < 8; ++u) dot_at(image, u, v, orange);
  for (std::uint32_t v = 2; v < 6; ++v) dot_at(image, 5, v, grey);  // cuts it in two
  for (std::uint32_t u = 8; u < 12; ++u) dot_at(image, u, 3, blue);
  dot_at(image, 15, 8, orange);
  const ColourRange ranges[] = {range_around(1, 0.47, 0.04), range_around(0.08, 0.16, 0.9)};
  const ColourTable table(ranges);
  const ImageView view = *image_view(image);
  BlobFinder finder;
  finder.find(view, table, 1, 2);
  ASSERT_EQ(finder.blobs().size(), 2u);
  const Blob whole = finder.blobs()[0];
  EXPECT_EQ(whole.colour, 0);
  EXPECT_EQ(whole.pixels, 16u);
  EXPECT_EQ((std::array{whole.left, whole.top, whole.right, whole.bottom}), (std::array{3, 2, 7, 5}));
  EXPECT_DOUBLE_EQ(whole.u, 5);
  EXPECT_DOUBLE_EQ(whole.v, 3.5);
  EXPECT_EQ(finder.blobs()[1].colour, 1);
  EXPECT_EQ(finder.blobs()[1].pixels, 4u);
  finder.find(view, table, 0, 1);  // without bridges: two halves, the blue one, the single one
  ASSERT_EQ(finder.blobs().size(), 4u);
  EXPECT_EQ(finder.blobs()[0].pixels, 8u);
  EXPECT_EQ(finder.blobs()[3].pixels, 1u);

  // U shapes are one patch though their legs meet in the last row only; diagonals hold together.
  image = picture(20, 10);
  for (std::uint32_t v = 0; v < 5; ++v) dot_at(image, 2, v, orange), dot_at(image, 9, v, orange);
  for (std::uint32_t u = 3; u < 9; ++u) dot_at(image, u, 5, orange);
  finder.find(*image_view(image), table, 0, 1);
  ASSERT_EQ(finder.blobs().size(), 1u);
  EXPECT_EQ(finder.blobs()[0].pixels, 16u);
}

TEST(Perception, RaysOfLensesByHand) {
  msg::CameraInfo info = camera(100, 80, 50);
  const CameraModel pinhole = *CameraModel::of(info);
  // 25 pixels right and 10 down of the middle: x : y : z = 50 : -25 : -10.
  EXPECT_NEAR(norm(pinhole.ray(74.5, 49.5)->direction - normalised(Vec3{50, -25, -10})), 0, 1e-15);
  // k1: the point (a, 0) is seen at a (1 + k1 a^2).
  info.d = {-0.2, 0, 0, 0, 0};
  const double a = 0.4, u = 49.5 + 50 * a * (1 - 0.2 * a * a);
  EXPECT_NEAR(norm(CameraModel::of(info)->ray(u, 39.5)->direction - normalised(Vec3{1, -a, 0})), 0, 1e-9);
  // It folds over where 1 - 0.6 a^2 = 0: at 50 * 1.29 * (2 / 3) = 43 pixels.
  EXPECT_TRUE(CameraModel::of(info)->ray(49.5 + 42, 39.5));
  EXPECT_FALSE(CameraModel::of(info)->ray(49.5 + 44, 39.5));
  info.d = {};
  for (const auto& [name, r] : {std::pair{"equidistant", math::pi / 3},
                                {"equisolid", 1.0},
                                {"stereographic", 2 * std::sqrt(1.0 / 3)},
                                {"orthographic", std::sqrt(0.75)}}) {
    info.distortion_model = name;  // r is that of 60 degrees
    EXPECT_NEAR(
        norm(CameraModel::of(info)->ray(49.5 + 50 * r, 39.5)->direction - Vec3{0.5, -std::sqrt(0.75), 0}), 0,
        1e-12)
        << name;
  }
  // The hyperbola's point level with its focus is a^2 / b from the axis: there it shows the horizon.
  info = mirror(200);
  const double ma = info.d[0], mb = info.d[1], c = std::sqrt(ma * ma + mb * mb);
  const CameraModel omni = *CameraModel::of(info);
  const double r = info.k[0] * (ma * ma / mb) / (2 * c);
  EXPECT_NEAR(norm(omni.ray(99.5, 99.5 - r)->direction - Vec3{1, 0, 0}), 0, 1e-12);  // up in the image: ahead
  EXPECT_NEAR(norm(omni.ray(99.5 + r, 99.5)->direction - Vec3{0, 1, 0}), 0, 1e-12);  // right: left
  EXPECT_LT(omni.ray(99.5, 99.5 - 0.9 * r)->direction.z, 0);
  EXPECT_FALSE(omni.ray(99.5, 99.5 - 101));
  EXPECT_TRUE(omni.around());
  // A parabola shows the horizon at the radius a; a sphere the direction 2 alpha + 2 asin(...) by its normal.
  info.distortion_model = "mirror_parabolic";
  info.d = {0.03, 0, 0.05};
  info.k[0] = info.k[4] = 1000;
  EXPECT_NEAR(norm(CameraModel::of(info)->ray(99.5, 69.5)->direction - Vec3{1, 0, 0}), 0, 1e-12);
  info.distortion_model = "mirror_spherical";
  info.d = {0.05, 0.15, 0.05};
  const auto sphere = CameraModel::of(info)->ray(99.5, 99.5);
  EXPECT_NEAR(norm(sphere->origin - Vec3{0, 0, -0.05}), 0, 1e-12);
  EXPECT_NEAR(norm(sphere->direction - Vec3{0, 0, -1}), 0, 1e-12);
}

TEST(Perception, AMirrorIsFittedFromPointsOfTheGround) {
  // Points every 25 cm on the ground 0.6 m below, where the mirror itself shows them; one in a thousand of
  // noise on the places.
  const CameraModel truth = *CameraModel::of(mirror(400));
  std::vector<Sighting> seen;
  Stream random(1, 2, Purpose::noise, 3);
  for (double v = 10; v < 390; v += 19)
    for (double u = 10; u < 390; u += 19) {
      const auto ray = truth.ray(u, v);
      if (!ray || ray->direction.z > -0.03 || math::hypot(u - 199.5, v - 199.5) < 8) continue;
      seen.push_back({u + 0.2 * (random.uniform() - 0.5), v + 0.2 * (random.uniform() - 0.5),
                      (0.6 / -ray->direction.z) * ray->direction});
    }
  const auto fitted = CameraModel::fit_polynomial(400, 400, 199.5, 199.5, seen);
  ASSERT_TRUE(fitted);
  double worst = 0;
  for (const Sighting& s : seen) {
    const Vec3 got = fitted->ray(s.u, s.v)->direction, wanted = normalised(s.point_S);
    worst = std::max(worst, norm(got - wanted));
  }
  // 0.1 pixels of up to 0.5 degrees each are 1 mrad; the polynomial's own error is below that.
  EXPECT_LT(worst, 0.003);
  EXPECT_FALSE(CameraModel::fit_polynomial(400, 400, 199.5, 199.5, std::span(seen).first(5)));
}

std::span<const Painter> painters() {
  static const Painter all[] = {
      {"directed", camera(320, 240, 260), {{0.1, 0, 0.5}, quat_from_rpy(0, 15 * degree, 0)}},
      {"omni", mirror(480), {{0, 0, 0.7}, {}}}};
  return all;
}

TEST(Perception, BallsAreWhereTheyAre) {
  for (const Painter& c : painters()) {
    Finder finder({.targets = {Target{.colour = range_around(1, 0.47, 0.04)}}}, c.model, c.X_BS);
    for (const Vec3 at : {Vec3{1.5, 0.3, 0.11}, Vec3{3, -0.8, 0.11}, Vec3{2, 0, 0.11}}) {
      const msg::Image image = c.paint(
          [&](Vec3 o, Vec3 d) { return meets_ball(o, d, at, 0.11) ? orange : grey; });
      std::vector<Found> found;
      ASSERT_TRUE(finder.find(*image_view(image), found));
      ASSERT_EQ(found.size(), 1u) << c.name << " " << at.x;
      // The middle of a patch of n pixels lies within about 1 / sqrt(12 n) of a pixel, whatever its edge. At
      // 3 m a pixel of the mirror is 0.4 degrees, which over a height of 0.6 m is 10 cm along the ground, and
      // n is 100 or more: 5 sigma are 1.5 cm.
      EXPECT_NEAR(found[0].position_B.x, at.x, 0.02) << c.name;
      EXPECT_NEAR(found[0].position_B.y, at.y, 0.01) << c.name;
      EXPECT_NEAR(found[0].position_B.z, 0.11, 1e-6);
      EXPECT_NEAR(found[0].bearing_rad, math::atan2(at.y, at.x), 0.005);
      EXPECT_GT(found[0].visible, 0.9);
    }
  }
}

TEST(Perception, RobotsAndPostsStandWhereTheyStand) {
  for (const Painter& c : painters()) {
    Finder finder({.targets = {Target{.label = "robot",
                                      .colour = range_around(0.08, 0.16, 0.9),
                                      .form = Form::standing,
                                      .depth_m = 0.2}}},
                  c.model, c.X_BS);
    const Vec3 a{2.4, 0.5, 0}, b{1.6, -0.5, 0};
    const msg::Image image = c.paint([&](Vec3 o, Vec3 d) {
      return meets_post(o, d, a, 0.2, 0.4) || meets_post(o, d, b, 0.2, 0.4) ? blue : grey;
    });
    std::vector<Found> found;
    ASSERT_TRUE(finder.find(*image_view(image), found));
    ASSERT_EQ(found.size(), 2u) << c.name;
    // The front is an arc: its mean lies up to a third of the radius behind its nearest point; and a pixel of
    // the mirror is 8 cm long at 2.4 m.
    EXPECT_NEAR(found[0].position_B.x, b.x, 0.1) << c.name;
    EXPECT_NEAR(found[0].position_B.y, b.y, 0.05) << c.name;
    EXPECT_NEAR(found[1].position_B.x, a.x, 0.12) << c.name;
    EXPECT_NEAR(found[1].bearing_rad, math::atan2(a.y, a.x), 0.01) << c.name;
  }
}

TEST(Perception, WhatCannotBeABallIsNone) {
  const Painter& c = painters()[0];
  Finder finder({.targets = {Target{.colour = range_around(1, 0.47, 0.04)}}}, c.model, c.X_BS);
  const auto seen = [&](Vec3 at, double radius) {
    std::vector<Found> found;
    EXPECT_TRUE(finder.find(
        *image_view(c.paint([&](Vec3 o, Vec3 d) { return meets_ball(o, d, at, radius) ? orange : grey; })),
        found));
    return found.size();
  };
  EXPECT_EQ(seen({2, 0, 0.11}, 0.11), 1u);
  EXPECT_EQ(seen({2, 0, 0.11}, 0.3), 0u);    // far too large for its place
  EXPECT_EQ(seen({2, 0, 0.11}, 0.025), 0u);  // far too small
  std::vector<Found> found;
  const msg::Image other = picture(100, 100);
  EXPECT_FALSE(finder.find(*image_view(other), found));
}

TEST(Perception, AnEdgeOfMixedColourIsNoBall) {
  // Row 85 looks down by 15 - atan(35 / 260) = 7.4 degrees, at a ball 3 m away: 19 pixels wide, 285 in all. A
  // line of 36 has more than the 26 that would be enough for a ball that is hidden for the most part.
  const Painter& c = painters()[0];
  Finder finder({.targets = {Target{.colour = range_around(1, 0.47, 0.04)}}}, c.model, c.X_BS);
  const auto balls_in = [&](std::uint32_t width, std::uint32_t height) {
    msg::Image image = c.paint([](Vec3, Vec3) { return grey; });
    const std::uint32_t u0 = (image.width - width) / 2, v0 = 85 - height / 2;
    for (std::uint32_t v = v0; v < v0 + height; ++v)
      for (std::uint32_t u = u0; u < u0 + width; ++u) dot_at(image, u, v, orange);
    std::vector<Found> found;
    EXPECT_TRUE(finder.find(*image_view(image), found));
    return found.size();
  };
  EXPECT_EQ(balls_in(6, 6), 1u);
  EXPECT_EQ(balls_in(1, 36), 0u);
  EXPECT_EQ(balls_in(36, 1), 0u);
  EXPECT_EQ(balls_in(3, 12), 1u);  // that may be the part next to a post
}

TEST(Perception, ABallBehindANetIsOne) {
  for (const Painter& c : painters()) {
    Finder finder({.targets = {Target{.colour = range_around(1, 0.47, 0.04)}}}, c.model, c.X_BS);
    const Vec3 at{1.5, 0.1, 0.11}, beside{1.5, 0.45, 0.11};
    // A cord of 4 cm before its middle, upright, parts it in two halves; the other ball is a ball.
    const auto colour = [&](Vec3 o, Vec3 d) {
      const double side = o.y + d.y * (1.5 - o.x) / d.x;
      if (std::abs(side - 0.1) < 0.02) return blue;
      return meets_ball(o, d, at, 0.11) || meets_ball(o, d, beside, 0.11) ? orange : grey;
    };
    std::vector<Found> found;
    ASSERT_TRUE(finder.find(*image_view(c.paint(colour)), found));
    ASSERT_EQ(found.size(), 2u) << c.name;
    // Half a pixel of the mirror, 0.4 degrees, is 0.5 cm at 1.5 m across and 1.5 cm along; each half is
    // symmetric to the other.
    EXPECT_NEAR(found[0].position_B.y, 0.1, 0.015) << c.name;
    EXPECT_NEAR(found[0].position_B.x, 1.5, 0.03) << c.name;
    EXPECT_NEAR(found[1].position_B.y, 0.45, 0.015) << c.name;
    // A strip of 4 of 22 cm through the middle: 1 - 0.23 of the disc.
    EXPECT_NEAR(found[0].visible, 0.77, 0.08) << c.name;
  }
}

TEST(Perception, BadPicturesAndCamerasAreRefused) {
  msg::Image image = picture(8, 8);
  EXPECT_TRUE(image_view(image));
  image.data.pop_back();
  EXPECT_FALSE(image_view(image));
  image = picture(8, 8);
  image.step = 23;
  EXPECT_FALSE(image_view(image));
  image.step = 0xffffffff;
  EXPECT_FALSE(image_view(image));
  image = picture(8, 8);
  image.encoding = "mono8";
  EXPECT_FALSE(image_view(image));
  image.encoding = "rgb8", image.width = 0xffffffff;
  EXPECT_FALSE(image_view(image));

  const auto refused = [](auto&& change) {
    msg::CameraInfo info = camera(100, 80, 50);
    change(info);
    return !CameraModel::of(info);
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& i) { i.k[0] = 0; }));
  EXPECT_TRUE(refused([](auto& i) { i.k[4] = std::nan(""); }));
  EXPECT_TRUE(refused([](auto& i) { i.width = 100000; }));
  EXPECT_TRUE(refused([](auto& i) { i.d = {std::numeric_limits<double>::infinity()}; }));
  EXPECT_TRUE(refused([](auto& i) { i.distortion_model = "wonky"; }));
  EXPECT_TRUE(refused([](auto& i) { i.distortion_model = "mirror_hyperbolic"; }));
}

msg::LaserScan scan_of(std::span<const Wall> walls, Pose2 at, Stream* noise = nullptr) {
  msg::LaserScan scan;
  scan.angle_min = static_cast<float>(-math::pi);
  scan.angle_increment = static_cast<float>(math::pi / 90);
  for (int i = 0; i < 180; ++i) {
    const double angle = at.theta + static_cast<double>(scan.angle_min) +
                         i * static_cast<double>(scan.angle_increment);
    const double dx = math::cos(angle), dy = math::sin(angle);
    double best = std::numeric_limits<double>::infinity();
    for (const Wall& w : walls) {
      const double wx = w.x1 - w.x0, wy = w.y1 - w.y0, det = wx * dy - wy * dx;
      const double t = (wx * (w.y0 - at.y) - wy * (w.x0 - at.x)) / det,
                   k = (dx * (w.y0 - at.y) - dy * (w.x0 - at.x)) / det;
      if (std::abs(det) > 1e-9 && t > 0 && k >= 0 && k <= 1) best = std::min(best, t);
    }
    if (noise) best += 0.02 * noise->normal();
    scan.ranges.push_back(static_cast<float>(best));
  }
  return scan;
}

TEST(Perception, AScanTellsWhereItWasTaken) {
  const Wall room[] = {{0, 0, 6, 0}, {6, 0, 6, 4}, {6, 4, 0, 4}, {0, 4, 0, 0}, {2, 4, 2, 3}};
  const Pose2 truth{2.6, 1.3, 0.4};
  msg::LaserScan scan = scan_of(room, truth);
  ScanMatch match = match_scan(scan, {}, room, {2.3, 1.6, 0.25});
  EXPECT_TRUE(match.converged);
  EXPECT_NEAR(match.pose.x, truth.x, 1e-4);  // ranges and angles are floats
  EXPECT_NEAR(match.pose.y, truth.y, 1e-4);
  EXPECT_NEAR(match.pose.theta, truth.theta, 1e-4);
  EXPECT_GT(match.points, 170);
  // Noise of 2 cm on about 60 beams across each wall's direction: 2 cm / sqrt(60), five of them. Somebody
  // stands in eight beams.
  Stream random(1, 2, Purpose::noise, 3);
  scan = scan_of(room, truth, &random);
  for (std::size_t i = 40; i < 48; ++i) scan.ranges[i] = 0.5f;
  match = match_scan(scan, {}, room, {2.4, 1.45, 0.3});
  EXPECT_NEAR(match.pose.x, truth.x, 5 * 0.02 / std::sqrt(60));
  EXPECT_NEAR(match.pose.y, truth.y, 5 * 0.02 / std::sqrt(60));
  EXPECT_NEAR(match.rms_m, 0.02, 0.004);
  // Along a corridor nothing is known: the guess stays.
  const Wall corridor[] = {{-500, 1, 500, 1}, {-500, -1, 500, -1}};
  match = match_scan(scan_of(corridor, {3, 0.2, 0.1}), {}, corridor, {2, 0, 0});
  EXPECT_NEAR(match.pose.y, 0.2, 1e-3);
  EXPECT_NEAR(match.pose.theta, 0.1, 1e-3);
  EXPECT_NEAR(match.pose.x, 2, 0.05);
}

}  // namespace
}  // namespace sandlot::perception
