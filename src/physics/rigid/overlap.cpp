#include "physics/rigid/overlap.h"

#include <algorithm>

namespace sandlot::rigid {
namespace {

struct Distance {
  Vec3 p;
  double operator()(const Box& b) const {
    const auto outside = [](double x, double size) { return std::max(std::abs(x) - 0.5 * size, 0.0); };
    return norm(Vec3{outside(p.x, b.size_m.x), outside(p.y, b.size_m.y), outside(p.z, b.size_m.z)});
  }
  double operator()(const Sphere& s) const { return std::max(norm(p) - s.radius_m, 0.0); }
  double operator()(const Cylinder& c) const {
    const double side = std::max(std::sqrt(p.x * p.x + p.y * p.y) - c.radius_m, 0.0);
    const double cap = std::max(std::abs(p.z) - 0.5 * c.length_m, 0.0);
    return std::sqrt(side * side + cap * cap);
  }
  double operator()(const Capsule& c) const {
    const double along = std::clamp(p.z, -0.5 * c.length_m, 0.5 * c.length_m);
    return std::max(norm(p - Vec3{0, 0, along}) - c.radius_m, 0.0);
  }
  double operator()(const Plane& plane) const {
    return std::max(dot(p, normalised(plane.normal, {0, 0, 1})), 0.0);
  }
  template <class Other>
  double operator()(const Other& other) const {
    return std::max(norm(p) - bounding_radius_m(other), 0.0);
  }
};

}  // namespace

double distance_m(const Shape& shape, Vec3 point_G) { return std::visit(Distance{point_G}, shape); }

}  // namespace sandlot::rigid
