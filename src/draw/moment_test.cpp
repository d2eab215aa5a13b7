#include "draw/moment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sandlot::draw {
namespace {

constexpr double pi = std::numbers::pi;

Quat about(Vec3 axis, double rad) { return quat_from_axis_angle(axis, rad); }

void expect_near(Quat a, Quat b) {
  const double sign = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0 ? -1 : 1;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(a[i], sign * b[i], 1e-12) << i;
}

TEST(Moment, GoesStraightAndTurnsAtAConstantRateAboutOneAxis) {
  const Vec3 axis{2.0 / 3, -1.0 / 3, 2.0 / 3};
  const Pose a{{1, 2, 3}, about({0, 0, 1}, 0.4)}, b{{2, 0, 3.5}, about(axis, 1.3) * a.q};
  for (const double share : {0.0, 0.25, 0.5, 0.9, 1.0}) {
    const Pose at = interpolated(a, b, share);
    EXPECT_NEAR(norm(at.p - Vec3{1 + share, 2 - 2 * share, 3 + 0.5 * share}), 0, 1e-15);
    expect_near(at.q, about(axis, 1.3 * share) * a.q);
    // -q is the same orientation as q.
    expect_near(interpolated(a, {b.p, {-b.q.w, -b.q.x, -b.q.y, -b.q.z}}, share).q,
                about(axis, 1.3 * share) * a.q);
  }
  // 350 degrees to 10: over 0, and not back over 180.
  expect_near(
      interpolated({{}, about({0, 0, 1}, 350 * pi / 180)}, {{}, about({0, 0, 1}, 10 * pi / 180)}, 0.75).q,
      about({0, 0, 1}, 5 * pi / 180));
  // Where arc and chord are the same to the last digits, on both sides of the limit: 1 - cos(rad / 2) = 0.0005.
  for (const double rad : {1e-9, 0.06, 0.064})
    expect_near(interpolated({{}, {}}, {{}, about({1, 0, 0}, rad)}, 0.5).q, about({1, 0, 0}, rad / 2));
}

TEST(Moment, LeavesOutWhatWasPutElsewhereAndWorldsThatHaveChanged) {
  const auto at = [](double s, double x_m, double y_m, std::uint64_t revision) {
    // The first body drives at 2 m/s, the second stands and is put elsewhere.
    TickPoses out{Time::from_s(s), revision, {}};
    out.bodies.push_back({{{x_m, 0, 0}, {}}, 2});
    out.bodies.push_back({{{0, y_m, 0}, {}}, 0});
    return out;
  };
  const TickPoses a = at(1, 5, 0, 3), b = at(1.05, 5.1, 0.11, 3);
  const Moment half = moment_between(a, b, Time::from_s(1.025));
  EXPECT_NEAR(half.X_WB[0].p.x, 5.05, 1e-12);
  EXPECT_EQ(half.X_WB[1].p.y, 0);
  EXPECT_NEAR(moment_between(a, at(1.05, 5.1, 0.09, 3), Time::from_s(1.025)).X_WB[1].p.y, 0.045, 1e-12);
  EXPECT_EQ(moment_between(a, b, Time::from_s(1.05)).X_WB[1].p.y, 0.11);
  EXPECT_EQ(moment_between(a, at(1.05, 5.1, 0, 4), Time::from_s(1.025)).X_WB[0].p.x, 5.1) << "another world";
}

}  // namespace
}  // namespace sandlot::draw
