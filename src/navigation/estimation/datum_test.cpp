#include "navigation/estimation/datum.h"

#include <gtest/gtest.h>

#include "base/math.h"

namespace sandlot::navigation {
namespace {

constexpr double datum_deg = math::pi / 180;

TEST(Datum, ThereAndBackAgain) {
  for (const double latitude : {-89.0, -33.0, 0.0, 47.8, 71.0})
    for (const double longitude : {-179.9, 0.0, 9.2, 179.9})
      for (const double yaw : {0.0, 1.2, -3.0}) {
        const Datum datum{latitude * datum_deg, longitude * datum_deg, 420, yaw, {3, -2, 1}};
        for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{1, 2, 3}, Vec3{-5000, 800, 50}, Vec3{90'000, -70'000, 2000}})
          EXPECT_LT(norm(to_world(datum, to_geodetic(datum, p)) - p), 1e-6);
        // One ulp of a longitude of pi is 4e-16 rad: 3e-9 m.
        EXPECT_LT(norm(to_world(datum, {datum.latitude_rad, datum.longitude_rad, 420}) - datum.offset_m),
                  1e-8);
      }
}

// Closed formulas of WGS 84, written out here. A degree of latitude by its radius of curvature at the place, M deg, is
// 110574.3 m at the equator and 111131.8 m at 45 degrees (H. Moritz, Geodetic Reference System 1980, and any table of the
// lengths of a degree).
TEST(Datum, DistancesOnTheEllipsoid) {
  const double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f);
  for (const double lat : {0.0, 45.0}) {
    const double s = math::sin(lat * datum_deg), w = 1 - e2 * s * s, N = a / std::sqrt(w),
                 M = N * (1 - e2) / w;
    const Datum datum{lat * datum_deg, 9 * datum_deg, 0};
    // A millionth of a degree, 0.1 m: the curvature of the ground is 1e-9 m.
    const Vec3 north = to_world(datum, {(lat + 1e-6) * datum_deg, 9 * datum_deg, 0});
    EXPECT_NEAR(north.y, M * 1e-6 * datum_deg, 2e-8);
    EXPECT_NEAR(north.y * 1e6, lat == 0 ? 110574.3 : 111131.8, 0.05);
    EXPECT_NEAR(north.x, 0, 1e-8);
    const Vec3 east = to_world(datum, {lat * datum_deg, (9 + 1e-6) * datum_deg, 0});
    EXPECT_NEAR(east.x, N * math::cos(lat * datum_deg) * 1e-6 * datum_deg, 2e-8);
  }
  // The whole chord by coordinates: from (48 N, 11 E, 500 m) to (48.01 N, 11.02 E, 620 m).
  const auto ecef = [&](double lat, double lon, double h) {
    const double s = math::sin(lat * datum_deg), c = math::cos(lat * datum_deg),
                 N = a / std::sqrt(1 - e2 * s * s);
    return Vec3{(N + h) * c * math::cos(lon * datum_deg), (N + h) * c * math::sin(lon * datum_deg),
                (N * (1 - e2) + h) * s};
  };
  const Vec3 d = ecef(48.01, 11.02, 620) - ecef(48, 11, 500);
  const double sp = math::sin(48 * datum_deg), cp = math::cos(48 * datum_deg), sl = math::sin(11 * datum_deg),
               cl = math::cos(11 * datum_deg);
  const Vec3 enu{-sl * d.x + cl * d.y, -sp * cl * d.x - sp * sl * d.y + cp * d.z,
                 cp * cl * d.x + cp * sl * d.y + sp * d.z};
  const Vec3 p = to_world(Datum{48 * datum_deg, 11 * datum_deg, 500},
                          {48.01 * datum_deg, 11.02 * datum_deg, 620});
  EXPECT_LT(norm(p - enu), 1e-6);
}

TEST(Datum, WorldTurnedFromEast) {
  // x points north: 10 m north is x = 10, 10 m east is y = -10.
  const Datum plain{48 * datum_deg, 11 * datum_deg, 0},
      turned{48 * datum_deg, 11 * datum_deg, 0, math::pi / 2, {100, 0, 0}};
  const Vec3 north = to_world(turned, to_geodetic(plain, {0, 10, 0}));
  EXPECT_LT(norm(north - Vec3{110, 0, 0}), 1e-7);
  const Vec3 east = to_world(turned, to_geodetic(plain, {10, 0, 0}));
  EXPECT_LT(norm(east - Vec3{100, -10, 0}), 1e-7);
}

}  // namespace
}  // namespace sandlot::navigation
