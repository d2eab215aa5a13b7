#include "geometry/geodesy.h"

#include <gtest/gtest.h>

#include "base/math.h"

namespace sandlot::geodesy {
namespace {

constexpr double deg = math::pi / 180;

TEST(Geodesy, TheAxesOfTheEllipsoid) {
  // WGS 84: a = 6378137 m, b = 6356752.3142 m. One ulp at 6e6 is 1e-9.
  EXPECT_NEAR(to_ecef({0, 0, 100}).x, 6378237, 1e-8);
  EXPECT_NEAR(to_ecef({0, math::pi / 2, 0}).y, 6378137, 1e-8);
  EXPECT_NEAR(to_ecef({math::pi / 2, 0, 0}).z, 6356752.3142, 1e-4);
}

TEST(Geodesy, ThereAndBackAgain) {
  for (const double lat : {-90.0, -45.0, 0.0, 1e-7, 33.3, 89.9999, 90.0})
    for (const double lon : {-179.0, 0.0, 11.5, 180.0})
      for (const double height : {-100.0, 0.0, 9000.0, 1e6}) {
        const Vec3 p = to_ecef({lat * deg, lon * deg, height});
        const Geodetic back = to_geodetic(p);
        EXPECT_NEAR(back.latitude_rad, lat * deg, 3e-16 * 7);  // 1e-9 m on the ground are 1.6e-16 rad
        EXPECT_NEAR(back.height_m, height, 4e-9);
        const Vec3 q = to_ecef(back);
        EXPECT_NEAR(norm(p - q), 0, 1e-8);
      }
}

TEST(Geodesy, AMetreOnTheGround) {
  // Radii of curvature at 48 deg: N = a / sqrt(1 - e^2 s^2) across, M = N (1 - e^2) / (1 - e^2 s^2) along the
  // meridian.
  const double lat = 48 * deg, s = math::sin(lat), e2 = flattening * (2 - flattening);
  const double w = 1 - e2 * s * s, n = semi_major_m / std::sqrt(w), m = n * (1 - e2) / w;
  const LocalPlane plane({lat, 9 * deg, 0});
  // Seconds order: 10^2 / (2 a) = 8e-6 m along and up.
  const Geodetic north = plane.to_geodetic({0, 10, 0}), east = plane.to_geodetic({10, 0, 0});
  EXPECT_NEAR((north.latitude_rad - lat) * m, 10, 1e-5);
  EXPECT_NEAR((east.longitude_rad - 9 * deg) * n * math::cos(lat), 10, 1e-5);
  EXPECT_NEAR(north.height_m, 100 / (2 * m), 1e-7);  // the plane leaves the ground
  EXPECT_NEAR(east.height_m, 100 / (2 * n), 1e-7);
  EXPECT_NEAR(plane.to_geodetic({0, 0, 10}).height_m, 10, 1e-8);
  const Vec3 p = plane.to_enu(plane.to_geodetic({300, -200, 50}));
  EXPECT_NEAR(norm(p - Vec3{300, -200, 50}), 0, 1e-8);
}

}  // namespace
}  // namespace sandlot::geodesy
