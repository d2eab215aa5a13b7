#include "geometry/pose.h"

namespace sandlot {

Pose pose_from_rpy(Vec3 p_m, Vec3 rpy_rad) { return {p_m, quat_from_rpy(rpy_rad.x, rpy_rad.y, rpy_rad.z)}; }

std::span<const Component> components(const Pose&) {
  static constexpr Component names[] = {{"x", "m"},      {"y", "m"},       {"z", "m"},
                                        {"roll", "rad"}, {"pitch", "rad"}, {"yaw", "rad"}};
  return names;
}

double component(const Pose& X, std::size_t i) { return i < 3 ? X.p[i] : rpy_from_quat(X.q)[i - 3]; }

}  // namespace sandlot
