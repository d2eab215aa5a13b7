#include "navigation/estimation/datum.h"

#include "base/math.h"

namespace sandlot::navigation {
namespace {

geodesy::LocalPlane datum_plane(const Datum& datum) {
  return geodesy::LocalPlane({datum.latitude_rad, datum.longitude_rad, datum.altitude_m});
}

}  // namespace

Vec3 to_world(const Datum& datum, const geodesy::Geodetic& place) {
  const Vec3 enu = datum_plane(datum).to_enu(place);
  const auto [s, c] = math::sincos(datum.yaw_rad);
  return Vec3{c * enu.x + s * enu.y, -s * enu.x + c * enu.y, enu.z} + datum.offset_m;
}

geodesy::Geodetic to_geodetic(const Datum& datum, Vec3 p_W) {
  const Vec3 p = p_W - datum.offset_m;
  const auto [s, c] = math::sincos(datum.yaw_rad);
  return datum_plane(datum).to_geodetic({c * p.x - s * p.y, s * p.x + c * p.y, p.z});
}

}  // namespace sandlot::navigation
