#include "optics/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/math.h"

namespace sandlot::optics {
namespace {

using Mapping = Fisheye::Mapping;
using Mirror = Catadioptric::Mirror;

constexpr Catadioptric hyperbolic{.mirror = Mirror::hyperbolic, .a_m = 0.0306, .b_m = 0.0674, .rim_m = 0.02};
constexpr Catadioptric parabolic{.mirror = Mirror::parabolic, .a_m = 0.03, .rim_m = 0.04};
constexpr Catadioptric spherical{.mirror = Mirror::spherical, .a_m = 0.05, .b_m = 0.15, .rim_m = 0.035};

std::vector<std::pair<const char*, Lens>> all_lenses() {
  Lens bent = pinhole_of_fov(320, 240, 1.2).value();
  auto& p = std::get<Pinhole>(bent.model);
  p.k1 = -0.28, p.k2 = 0.09, p.p1 = 0.001, p.p2 = -0.002, p.k3 = -0.01;
  Lens measured = fisheye_of_fov(320, 240, 2.6, Mapping::kannala_brandt).value();
  auto& f = std::get<Fisheye>(measured.model);
  f.k1 = -0.02, f.k2 = 0.004, f.k3 = -0.001, f.k4 = 0.0001;
  return {{"pinhole", pinhole_of_fov(320, 240, 1.2).value()},
          {"plumb_bob", bent},
          {"equidistant", fisheye_of_fov(320, 240, 3.4, Mapping::equidistant).value()},
          {"equisolid", fisheye_of_fov(320, 240, 3.4, Mapping::equisolid).value()},
          {"stereographic", fisheye_of_fov(320, 240, 3.4, Mapping::stereographic).value()},
          {"orthographic", fisheye_of_fov(320, 240, 3.0, Mapping::orthographic).value()},
          {"kannala_brandt", measured},
          {"hyperbolic", omni_that_fills(320, 240, hyperbolic).value()},
          {"parabolic", omni_that_fills(320, 240, parabolic).value()},
          {"spherical", omni_that_fills(320, 240, spherical).value()}};
}

TEST(Lens, ProjectionUndoesRays) {
  for (const auto& [name, lens] : all_lenses()) {
    SCOPED_TRACE(name);
    int seen = 0;
    for (double v = -0.4; v < 240; v += 13.7)
      for (double u = -0.4; u < 320; u += 11.3) {
        const auto ray = ray_through(lens, u, v);
        if (!ray) continue;
        ++seen;
        ASSERT_NEAR(norm(ray->direction), 1, 1e-12);
        const auto back = project(lens, ray->origin + 3.0 * ray->direction);
        ASSERT_TRUE(back) << u << " " << v;
        ASSERT_NEAR((*back)[0], u, 1e-5);
        ASSERT_NEAR((*back)[1], v, 1e-5);
      }
    EXPECT_GT(seen, 200);
  }
}

TEST(Lens, PinholeByHand) {
  const Lens lens = pinhole_of_fov(640, 480, math::pi / 2).value();
  const auto k = intrinsics(lens);
  EXPECT_NEAR(k[0], 320, 1e-9);  // half the width / tan 45 degrees
  EXPECT_EQ(k[2], 319.5);
  EXPECT_EQ(k[5], 239.5);
  const Vec3 d = ray_through(lens, 319.5 + 320, 239.5)->direction;  // the right edge is at 45 degrees
  EXPECT_NEAR(d.x, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(d.y, -std::sqrt(0.5), 1e-12);
  const auto at = *project(lens, {2, 1, 0.5});  // to the left and above
  EXPECT_NEAR(at[0], 319.5 - 160, 1e-9);
  EXPECT_NEAR(at[1], 239.5 - 80, 1e-9);
  EXPECT_FALSE(project(lens, {-2, 1, 0.5}));
}

TEST(Lens, DistortionAsOpenCvDefinesIt) {
  const Lens lens{640, 480, Pinhole{500, 510, 320, 240, 0.1, -0.05, 0.002, -0.003, 0.02}};
  // x = 0.5, y = -0.25: r2 = 0.3125, radial = 1 + 0.1 r2 - 0.05 r2^2 + 0.02 r2^3 = 1.026977539;
  // x' = 0.5 radial + 2 p1 x y + p2 (r2 + 2 x^2) = 0.513488770 - 0.0005 - 0.0024375,
  // y' = -0.25 radial + p1 (r2 + 2 y^2) + 2 p2 x y = -0.256744385 + 0.000875 + 0.00075.
  const auto at = *project(lens, {1, -0.5, 0.25});
  EXPECT_NEAR(at[0], 320 + 500 * 0.510551270, 1e-5);
  EXPECT_NEAR(at[1], 240 - 510 * 0.255119385, 1e-5);
}

TEST(Lens, ADistortionThatFoldsShowsNothingBeyondTheFold) {
  // r (1 - r^2 / 3) has its largest value, 2/3, at r = 1.
  const Lens lens{640, 480, Pinhole{300, 300, 320, 240, -1.0 / 3, 0, 0, 0, 0}};
  EXPECT_TRUE(ray_through(lens, 320 + 300 * 0.66, 240));
  EXPECT_FALSE(ray_through(lens, 320 + 300 * 0.67, 240));
  EXPECT_TRUE(project(lens, {1, 0.99, 0}));
  EXPECT_FALSE(project(lens, {1, 1.01, 0}));
}

TEST(Lens, FisheyeMappingsByHand) {
  struct Case {
    Mapping mapping;
    double theta, r;
  };
  for (const Case c :
       {Case{Mapping::equidistant, math::pi / 2, math::pi / 2}, Case{Mapping::equidistant, 2.5, 2.5},
        Case{Mapping::equisolid, math::pi / 2, std::sqrt(2.0)}, Case{Mapping::stereographic, math::pi / 2, 2},
        Case{Mapping::orthographic, math::pi / 6, 0.5}}) {
    const Lens lens{1000, 1000, Fisheye{c.mapping, 100, 100, 499.5, 499.5}};
    ASSERT_TRUE(check(lens));
    const auto [s, co] = math::sincos(c.theta);
    const auto left = *project(lens, {5 * co, 5 * s, 0});
    EXPECT_NEAR(left[0], 499.5 - 100 * c.r, 1e-9);
    EXPECT_NEAR(left[1], 499.5, 1e-9);
  }
}

TEST(Lens, HyperbolicMirrorIsTheClosedForm) {
  const Lens lens = omni_that_fills(640, 480, hyperbolic).value();
  const auto& m = std::get<Catadioptric>(lens.model);
  const double a = m.a_m, b = m.b_m, c = std::sqrt(a * a + b * b);
  for (double r = 5; r < 239; r += 9) {
    const double gamma = math::atan(m.fx / r), s = math::sin(gamma);
    const double alpha = math::atan(((b * b + c * c) * s - 2 * b * c) / ((b * b - c * c) * math::cos(gamma)));
    const Vec3 ahead = ray_through(lens, m.cx, m.cy - r)->direction;  // upwards in the image: forward
    EXPECT_NEAR(math::atan2(ahead.z, ahead.x), alpha, 1e-12);
    EXPECT_NEAR(ahead.y, 0, 1e-15);
    const Vec3 right = ray_through(lens, m.cx + r, m.cy)->direction;  // seen from below: the robot's left
    EXPECT_GT(right.y, 0);
  }
  // What is level with the focus is seen where the mirror has the radius a^2 / b.
  const auto horizon = *project(lens, {100, 0, 0});
  const auto there = ray_through(lens, horizon[0], horizon[1]);
  EXPECT_NEAR(there->origin.x, a * a / b, 1e-9);
}

TEST(Lens, EveryMirrorReflects) {
  for (const Catadioptric& mirror : {hyperbolic, parabolic, spherical}) {
    const Lens lens = omni_that_fills(640, 480, mirror).value();
    const auto& m = std::get<Catadioptric>(lens.model);
    const double a = m.a_m, b = m.b_m, c = std::sqrt(a * a + b * b);
    const auto surface = [&](Vec3 p) {  // 0 on the mirror
      const double r2 = p.x * p.x + p.y * p.y;
      if (m.mirror == Mirror::hyperbolic) return r2 / (a * a) - (p.z + c) * (p.z + c) / (b * b) + 1;
      if (m.mirror == Mirror::parabolic) return (p.z - (r2 - a * a) / (2 * a)) / a;
      return dot(p, p) / (a * a) - 1;
    };
    for (const double u : {300.0, 350.5, 480.0, 230.0}) {
      const auto ray = ray_through(lens, u, 190);
      ASSERT_TRUE(ray);
      const Vec3 p = ray->origin;
      EXPECT_NEAR(surface(p), 0, 1e-9);
      Vec3 incoming{0, 0, 1};
      if (m.mirror == Mirror::hyperbolic) incoming = normalised(p - Vec3{0, 0, -2 * c});
      if (m.mirror == Mirror::spherical) incoming = normalised(p - Vec3{0, 0, -b});
      const double h = 1e-7;
      const Vec3 n = normalised(Vec3{surface(p + Vec3{h, 0, 0}) - surface(p - Vec3{h, 0, 0}),
                                     surface(p + Vec3{0, h, 0}) - surface(p - Vec3{0, h, 0}),
                                     surface(p + Vec3{0, 0, h}) - surface(p - Vec3{0, 0, h})});
      const Vec3 out = incoming - 2 * dot(incoming, n) * n;
      EXPECT_NEAR(norm(out - ray->direction), 0, 1e-6);
      EXPECT_LT(p.z, 0);  // the side that the camera sees
    }
  }
}

TEST(Lens, TheRimFillsTheImage) {
  for (const Catadioptric& mirror : {hyperbolic, parabolic, spherical}) {
    const Lens lens = omni_that_fills(640, 480, mirror).value();
    EXPECT_TRUE(ray_through(lens, 319.5, -0.4));
    EXPECT_FALSE(ray_through(lens, 319.5, -0.6));
    EXPECT_FALSE(ray_through(lens, 0, 239.5));
  }
}

TEST(Lens, BadOnesAreRefused) {
  const auto says = [](const auto& result) { return result ? std::string() : result.error().what; };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(says(pinhole_of_fov(100000, 100000, 1)), "");
  EXPECT_NE(says(pinhole_of_fov(8192, 8192, 1)), "");  // each side fits, 67 million pixels do not
  EXPECT_EQ(says(pinhole_of_fov(4096, 4096, 1)), "");
  EXPECT_NE(says(pinhole_of_fov(0, 480, 1)), "");
  EXPECT_NE(says(pinhole_of_fov(640, -1, 1)), "");
  for (const double fov : {0.0, -1.0, math::pi, 4.0, nan})
    EXPECT_NE(says(pinhole_of_fov(640, 480, fov)), "") << fov;
  for (const double fov : {0.0, 7.0, nan})
    EXPECT_NE(says(fisheye_of_fov(640, 480, fov, Mapping::equidistant)), "") << fov;
  EXPECT_NE(says(fisheye_of_fov(640, 480, 3.5, Mapping::orthographic)), "");
  EXPECT_EQ(says(fisheye_of_fov(640, 480, math::tau, Mapping::equidistant)), "");
  const auto omni = [&](auto change) {
    Lens lens = omni_that_fills(640, 480, hyperbolic).value();
    change(std::get<Catadioptric>(lens.model));
    return says(check(lens));
  };
  EXPECT_EQ(omni([](Catadioptric&) {}), "");
  EXPECT_NE(omni([](Catadioptric& m) { m.cx = 2000; }), "");  // the mirror's picture is beside the image
  EXPECT_NE(omni([](Catadioptric& m) { m.rim_m = 0; }), "");
  EXPECT_NE(omni([](Catadioptric& m) { m.rim_m = 1e-5; }), "");
  EXPECT_NE(omni([](Catadioptric& m) { m.a_m = -1; }), "");
  EXPECT_NE(omni([&](Catadioptric& m) { m.b_m = nan; }), "");
  EXPECT_NE(omni([](Catadioptric& m) { m.fx = 0; }), "");
  Catadioptric inside = spherical;
  inside.b_m = 0.04;
  EXPECT_NE(says(omni_that_fills(640, 480, inside)), "");
  EXPECT_NE(says(check(Lens{640, 480, Pinhole{}})), "");
  EXPECT_NE(says(check(Lens{640, 480, Pinhole{500, 500, 320, 240, nan}})), "");
}

TEST(Lens, TablesAreTheRays) {
  for (const auto& [name, lens] : all_lenses()) {
    const auto table = LensTable::make(lens);
    EXPECT_EQ(table->is_plain_pinhole(), std::string(name) == "pinhole");
    EXPECT_EQ(table->has_origins(), std::holds_alternative<Catadioptric>(lens.model));
    if (table->is_plain_pinhole()) continue;
    for (const int v : {0, 100, 239})
      for (int u = 0; u < 320; u += 29) {
        const auto& d = table->directions()[static_cast<std::size_t>(v * 320 + u)];
        const auto ray = ray_through(lens, u, v);
        ASSERT_EQ(ray.has_value(), d[0] == d[0]);
        if (ray) { EXPECT_EQ(d[1], static_cast<float>(ray->direction.y)); }
      }
  }
}

}  // namespace
}  // namespace sandlot::optics
