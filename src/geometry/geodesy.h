#pragma once
/// WGS 84: the ellipsoid of satellite receivers, and a plane that touches it.
///
///   N = a / sqrt(1 - e^2 sin^2 lat)
///   x = (N + h) cos lat cos lon,  y = (N + h) cos lat sin lon,  z = (N (1 - e^2) + h) sin lat
///
/// Frame    ECEF: x through latitude 0, longitude 0, z through the north pole. ENU: x east, y north, z up
///          along the normal of the ellipsoid at its origin.
/// Accuracy the inverse is good to 1e-9 m from the ellipsoid to 1000 km above it; poles included.
/// Cost     to_geodetic: about six sine-cosine pairs.
/// Source   NIMA TR8350.2, 3rd ed. (2000), ch. 4; inverse: B. R. Bowring, Survey Review 23 (1976) 323-327,
///          iterated.
#include "geometry/pose.h"

namespace sandlot::geodesy {

inline constexpr double semi_major_m = 6378137.0, flattening = 1 / 298.257223563;

struct Geodetic {
  double latitude_rad = 0, longitude_rad = 0, height_m = 0;  ///< above the ellipsoid
};

Vec3 to_ecef(const Geodetic& place);
Geodetic to_geodetic(Vec3 ecef_m);

/// The plane that touches the Earth at a place.
class LocalPlane {
 public:
  explicit LocalPlane(const Geodetic& origin);
  Geodetic to_geodetic(Vec3 enu_m) const;
  Vec3 to_enu(const Geodetic& place) const;

 private:
  Vec3 origin_, east_, north_, up_;  ///< in ECEF
};

}  // namespace sandlot::geodesy
