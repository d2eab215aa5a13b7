#pragma once
/// Datum: where the world frame lies on the Earth, so that fixes of satellite receivers become positions in metres.
///
/// Frame    the plane that touches the WGS 84 ellipsoid's surface (at the datum's altitude) in the datum's place; W's x axis
///          is turned by `yaw` from east, counter-clockwise, z is up. p_W = Rz(-yaw) p_ENU + offset.
/// Accuracy formulas by ECEF, exact: back and forth within 1e-6 m up to 1000 km from the datum.
/// Limits   the plane leaves the curved ground: 0.08 m at 1 km, 8 m at 10 km.
/// Source   geometry/geodesy.h.
#include "geometry/geodesy.h"

namespace sandlot::navigation {

struct Datum {
  double latitude_rad = 0, longitude_rad = 0;
  double altitude_m = 0;  ///< above the ellipsoid
  double yaw_rad = 0;     ///< of W's x axis from east, counter-clockwise
  Vec3 offset_m;          ///< position of the datum in W

  static void fields(auto& s, auto&& visit) {
    visit(Field{"latitude", "rad", "Latitude of the datum, north positive.", -1.5707963267948966,
                1.5707963267948966},
          s.latitude_rad);
    visit(Field{"longitude", "rad", "Longitude of the datum, east positive.", -6.2831853071795865,
                6.2831853071795865},
          s.longitude_rad);
    visit(Field{"altitude", "m", "Altitude of the datum above the ellipsoid.", -1e5, 1e6}, s.altitude_m);
    visit(Field{"yaw", "rad", "Direction of the world's x axis, from east, counter-clockwise.", -7, 7},
          s.yaw_rad);
    visit(Field{"offset", "m", "Position of the datum in the world.", -1e6, 1e6}, s.offset_m);
  }
};

/// Position in W of a place on the Earth.
Vec3 to_world(const Datum& datum, const geodesy::Geodetic& place);
/// Place on the Earth of a position in W.
geodesy::Geodetic to_geodetic(const Datum& datum, Vec3 p_W);

}  // namespace sandlot::navigation
