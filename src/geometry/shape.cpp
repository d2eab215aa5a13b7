#include "geometry/shape.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "base/math.h"
#include "geometry/barrel.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot {
namespace {

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;

}  // namespace

const char* shape_name(const Shape& shape) {
  static constexpr const char* names[] = {"box",  "sphere",    "cylinder", "capsule",   "plane",
                                          "cone", "ellipsoid", "mesh",     "heightmap", "sandlot:barrel"};
  static_assert(std::size(names) == std::variant_size_v<Shape>);
  return names[shape.index()];
}

double bounding_radius_m(const Shape& shape) {
  return std::visit(
      Overload{
          [](const Box& b) { return 0.5 * norm(b.size_m); }, [](const Sphere& s) { return s.radius_m; },
          [](const Cylinder& c) {
            return std::sqrt(c.radius_m * c.radius_m + 0.25 * c.length_m * c.length_m);
          },
          [](const Capsule& c) { return c.radius_m + 0.5 * c.length_m; },
          [](const Plane&) { return std::numeric_limits<double>::infinity(); },
          [](const Cone& c) { return std::sqrt(c.radius_m * c.radius_m + 0.25 * c.length_m * c.length_m); },
          [](const Ellipsoid& e) {
            return std::max({e.radii_m.x, e.radii_m.y, e.radii_m.z});
          },
          [](const Mesh& m) {
            double r2 = 0;
            for (const Vec3& v : m.mesh->vertices) r2 = std::max(r2, dot(v, v));
            return std::sqrt(r2);
          },
          [](const Heightfield& h) {
            double z = 0;
            for (const float x : h.grid->height_m) z = std::max(z, std::abs(static_cast<double>(x)));
            return norm(Vec3{0.5 * h.grid->size_x_m, 0.5 * h.grid->size_y_m, z});
          },
          [](const Barrel& b) {
            const double end = end_radius_m(b);
            return std::max(b.radius_m, std::sqrt(end * end + 0.25 * b.length_m * b.length_m));
          }},
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
               [](const Plane&) { return 0.0; },
               [](const Cone& c) { return math::pi / 3 * c.radius_m * c.radius_m * c.length_m; },
               [&](const Ellipsoid& e) { return ball * e.radii_m.x * e.radii_m.y * e.radii_m.z; },
               [](const Mesh& m) { return std::abs(mass_properties(*m.mesh).volume_m3); },
               [](const Heightfield&) { return 0.0; }, [](const Barrel& b) { return moments(b).volume; }},
      shape);
}

Vec3 inertia_kg_m2(const Shape& shape, double mass_kg) {
  const double m = mass_kg;
  return std::visit(
      Overload{
          [&](const Box& b) {
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
          [](const Plane&) { return Vec3{}; },
          [&](const Cone& c) {
            // About G, which lies half way up: l/4 above the centre of mass.
            const double r2 = c.radius_m * c.radius_m, l2 = c.length_m * c.length_m;
            const double side = m * (0.15 * r2 + 3.0 / 80 * l2 + l2 / 16);
            return Vec3{side, side, 0.3 * m * r2};
          },
          [&](const Ellipsoid& e) {
            const Vec3 s{e.radii_m.x * e.radii_m.x, e.radii_m.y * e.radii_m.y, e.radii_m.z * e.radii_m.z};
            return m / 5 * Vec3{s.y + s.z, s.x + s.z, s.x + s.y};
          },
          [&](const Mesh& mesh) {
            const MassProperties p = mass_properties(*mesh.mesh);
            const Vec3 c = p.centre_m, s{c.x * c.x, c.y * c.y, c.z * c.z};
            return m * (p.moments + Vec3{s.y + s.z, s.x + s.z, s.x + s.y});
          },
          [](const Heightfield&) { return Vec3{}; },
          [&](const Barrel& b) {
            const BarrelMoments i = moments(b);
            const double side = m / i.volume * (0.5 * i.r2 + i.z2);
            return Vec3{side, side, m / i.volume * i.r2};
          }},
      shape);
}

}  // namespace sandlot
