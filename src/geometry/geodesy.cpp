#include "geometry/geodesy.h"

#include "base/math.h"

namespace sandlot::geodesy {
namespace {
constexpr double e2 = flattening * (2 - flattening);  // first eccentricity squared
}

Vec3 to_ecef(const Geodetic& place) {
  const auto [s, c] = math::sincos(place.latitude_rad);
  const auto [sl, cl] = math::sincos(place.longitude_rad);
  const double n = semi_major_m / std::sqrt(1 - e2 * s * s);
  return {(n + place.height_m) * c * cl, (n + place.height_m) * c * sl, (n * (1 - e2) + place.height_m) * s};
}

Geodetic to_geodetic(Vec3 p) {
  const double semi_minor = semi_major_m * (1 - flattening), from_axis = math::hypot(p.x, p.y);
  // Bowring's formula by the reduced latitude; a step gains some five digits near the Earth.
  double reduced = math::atan2(p.z * semi_major_m, from_axis * semi_minor), latitude = 0;
  for (int i = 0; i < 4; ++i) {
    const auto [s, c] = math::sincos(reduced);
    latitude = math::atan2(p.z + e2 / (1 - e2) * semi_minor * s * s * s,
                           from_axis - e2 * semi_major_m * c * c * c);
    const auto [sl, cl] = math::sincos(latitude);
    reduced = math::atan2((1 - flattening) * sl, cl);
  }
  const auto [s, c] = math::sincos(latitude);
  // The projection on the normal, which is well defined at the poles too.
  const double height = from_axis * c + p.z * s - semi_major_m * std::sqrt(1 - e2 * s * s);
  return {latitude, math::atan2(p.y, p.x), height};
}

LocalPlane::LocalPlane(const Geodetic& origin) : origin_(to_ecef(origin)) {
  const auto [s, c] = math::sincos(origin.latitude_rad);
  const auto [sl, cl] = math::sincos(origin.longitude_rad);
  east_ = {-sl, cl, 0};
  north_ = {-s * cl, -s * sl, c};
  up_ = {c * cl, c * sl, s};
}

Geodetic LocalPlane::to_geodetic(Vec3 enu) const {
  return geodesy::to_geodetic(origin_ + enu.x * east_ + enu.y * north_ + enu.z * up_);
}

Vec3 LocalPlane::to_enu(const Geodetic& place) const {
  const Vec3 d = to_ecef(place) - origin_;
  return {dot(d, east_), dot(d, north_), dot(d, up_)};
}

}  // namespace sandlot::geodesy
