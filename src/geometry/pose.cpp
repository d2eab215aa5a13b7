#include "geometry/pose.h"

namespace sandlot {

Pose pose_from_rpy(Vec3 p_m, Vec3 rpy_rad) { return {p_m, quat_from_rpy(rpy_rad.x, rpy_rad.y, rpy_rad.z)}; }

}  // namespace sandlot
