#include "geometry/shape.h"

#include <algorithm>
#include <limits>

#include "base/math.h"

namespace sandlot {
namespace {

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;

}  // namespace

double bounding_radius_m(const Shape& shape) {
  return std::visit(
      Overload{[](const Box& b) { return 0.5 * norm(b.size_m); }, [](const Sphere& s) { return s.radius_m; },
               [](const Cylinder& c) {
                 return std::sqrt(c.radius_m * c.radius_m + 0.25 * c.length_m * c.length_m);
               },
               [](const Capsule& c) { return c.radius_m + 0.5 * c.length_m; },
               [](const Plane&) { return std::numeric_limits<double>::infinity(); }},
      shape);
}

double volume_m3(const Shape& shape) {
  const double ball = 4.0 / 3.0 * math::pi;
  return std::visit(
      Overload{[](const Box& b) { return b.size_m.x * b.size_m.y * b.size_m.z; },
               [&](const Sphere& s) { return ball * s.radius_m * s.radius_m * s.radius_m; },
               [](const Cylinder& c) { return math::pi * c.radius_m * c.radius_m * c.length_m; },
               [&](const Capsule& c) {
                 return math::pi * c.radius_m * c.radius_m * c.length_m +
                        ball * c.radius_m * c.radius_m * c.radius_m;
               },
               [](const Plane&) { return 0.0; }},
      shape);
}

Vec3 inertia_kg_m2(const Shape& shape, double mass_kg) {
  const double m = mass_kg;
  return std::visit(
      Overload{[&](const Box& b) {
                 const Vec3 s{b.size_m.x * b.size_m.x, b.size_m.y * b.size_m.y, b.size_m.z * b.size_m.z};
                 return m / 12 * Vec3{s.y + s.z, s.x + s.z, s.x + s.y};
               },
               [&](const Sphere& s) {
                 const double i = 0.4 * m * s.radius_m * s.radius_m;
                 return Vec3{i, i, i};
               },
               [&](const Cylinder& c) {
                 const double r2 = c.radius_m * c.radius_m;
                 const double side = m / 12 * (3 * r2 + c.length_m * c.length_m);
                 return Vec3{side, side, 0.5 * m * r2};
               },
               [&](const Capsule& c) {
                 // Cylinder of length l plus two half spheres whose centres of mass sit l/2 + 3r/8 from G.
                 const double r = c.radius_m, l = c.length_m;
                 const double mc = m * l / (l + 4.0 / 3.0 * r), ms = m - mc;
                 const double side = mc / 12 * (3 * r * r + l * l) +
                                     ms * (0.4 * r * r + 0.25 * l * l + 0.375 * l * r);
                 return Vec3{side, side, 0.5 * mc * r * r + 0.4 * ms * r * r};
               },
               [](const Plane&) { return Vec3{}; }},
      shape);
}

}  // namespace sandlot
