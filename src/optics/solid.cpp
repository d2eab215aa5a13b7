#include "optics/solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "geometry/barrel.h"

namespace sandlot::optics {
namespace {

using lanes::broadcast;
using lanes::F;
using lanes::I;
using lanes::max;
using lanes::min;
using lanes::select;

constexpr float inf = std::numeric_limits<float>::infinity();

/// The part of each ray's line inside a convex solid; empty when first > last.
struct Interval {
  F first, last;
};

/// Intersection. A NaN in `b` (a ray that runs exactly in a face) leaves the bound of `a`; in `a` it means
/// "missed" and stays.
Interval meet(Interval a, Interval b) { return {max(b.first, a.first), min(b.last, a.last)}; }

/// Union of intervals that overlap or of which one is empty (`first` = inf, `last` = -inf).
Interval join(Interval a, Interval b) { return {min(b.first, a.first), max(b.last, a.last)}; }

Interval unless_empty(Interval a) {
  const I valid = a.first <= a.last;
  return {select(valid, a.first, broadcast(inf)), select(valid, a.last, broadcast(-inf))};
}

/// Between the planes -half and +half. A ray parallel to them divides by zero: +-inf puts it inside or
/// outside.
template <class O>
Interval slab(O o, F d, float half) {
  const F towards = select(I(d) < 0, broadcast(-half),
                           broadcast(half));  // by sign bit, so that -0 and +0 stay consistent
  return {(-towards - o) / d, (towards - o) / d};
}

template <class O>
Interval ball(O ox, O oy, O oz, const LocalRaysOf<O>& ray, float radius) {
  const F along = -(ox * ray.dx + oy * ray.dy + oz * ray.dz);
  const F px = ox + along * ray.dx, py = oy + along * ray.dy, pz = oz + along * ray.dz;
  const F half = lanes::sqrt(radius * radius - (px * px + py * py + pz * pz));  // NaN: missed
  return {along - half, along + half};
}

F which(bool yes, float a, float b) { return broadcast(yes ? a : b); }
F which(I yes, float a, float b) { return select(yes, broadcast(a), broadcast(b)); }

/// Inside the infinite cylinder about z.
template <class O>
Interval tube(const LocalRaysOf<O>& ray, float radius) {
  const F a = ray.dx * ray.dx + ray.dy * ray.dy;
  const F b = ray.ox * ray.dx + ray.oy * ray.dy;
  const F side = ray.ox * ray.dy - ray.oy * ray.dx;  // |side| / sqrt(a): distance between axis and ray
  const F half = lanes::sqrt(a * (radius * radius) - side * side);
  const auto inside = ray.ox * ray.ox + ray.oy * ray.oy <= radius * radius;
  // Within 1e-10 rad of the axis the ray never leaves a tube that it is in, and squares would underflow.
  const I parallel = a < 1e-20f;
  return {select(parallel, which(inside, -inf, inf), (-b - half) / a),
          select(parallel, which(inside, inf, -inf), (-b + half) / a)};
}

template <class O>
Interval capped(const LocalRaysOf<O>& ray, float radius, float half_length) {
  return meet(tube(ray, radius), slab(ray.oz, ray.dz, half_length));
}

/// Inside the ellipsoid with these radii about the origin.
template <class O>
Interval oval(const LocalRaysOf<O>& ray, const float* r) {
  // From the point of the ray nearest to the centre, so that the squares below do not grow with the distance;
  // then in space scaled to a unit ball.
  const F along = -(ray.ox * ray.dx + ray.oy * ray.dy + ray.oz * ray.dz);
  const F dx = ray.dx / r[0], dy = ray.dy / r[1], dz = ray.dz / r[2];
  F px = (ray.ox + along * ray.dx) / r[0], py = (ray.oy + along * ray.dy) / r[1],
    pz = (ray.oz + along * ray.dz) / r[2];
  const F length2 = dx * dx + dy * dy + dz * dz;
  const F more = -(px * dx + py * dy + pz * dz) / length2;
  px = px + more * dx, py = py + more * dy, pz = pz + more * dz;
  const F half = lanes::sqrt((1 - (px * px + py * py + pz * pz)) / length2);  // NaN: missed
  return {along + more - half, along + more + half};
}

/// Inside the cone whose base of `radius` lies at -half and whose apex at +half.
///
/// With the apex as origin and k = radius / (2 half) the double cone is f(p, p) = x x + y y - k k z z <= 0.
/// Along a ray f = a t^2 + 2 b t + c. Flat rays (a > 0) are inside between the roots and steep ones outside
/// of them, below the lower root when they rise; the slab of the height takes the upper half of the double
/// cone away.
template <class O>
Interval pointed(const LocalRaysOf<O>& ray, float radius, float half) {
  const F along = -(ray.ox * ray.dx + ray.oy * ray.dy + ray.oz * ray.dz);
  const F x = ray.ox + along * ray.dx, y = ray.oy + along * ray.dy, z = ray.oz + along * ray.dz - half;
  const float k = radius / (2 * half), k2 = k * k;
  const F a = ray.dx * ray.dx + ray.dy * ray.dy - k2 * (ray.dz * ray.dz);
  const F b = x * ray.dx + y * ray.dy - k2 * (z * ray.dz);
  const F c = x * x + y * y - k2 * (z * z);
  // b b - a c without its cancellation.
  const F xy = x * ray.dy - y * ray.dx, xz = z * ray.dx - x * ray.dz, yz = z * ray.dy - y * ray.dz;
  const F square = k2 * (xz * xz + yz * yz) - xy * xy;
  const I steep = a < 0;
  const F s = lanes::sqrt(select(steep, max(square, broadcast(0.0f)), square));  // NaN: missed
  const F q = select(b < 0, s - b, -(b + s));
  const F one = q / a, other = select(q == 0, one, c / q);
  const F low = min(one, other), high = max(one, other);
  const I rises = ray.dz > 0;
  return {along + select(steep, select(rises, broadcast(-inf), high), low),
          along + select(steep, select(rises, low, broadcast(inf)), high)};
}

template <class O>
Interval inside(const Solid& solid, const LocalRaysOf<O>& ray) {
  const float* s = solid.size;
  switch (solid.type) {
    case Solid::Type::box: {
      const Interval everywhere{broadcast(-inf), broadcast(inf)};
      return meet(meet(meet(everywhere, slab(ray.ox, ray.dx, s[0])), slab(ray.oy, ray.dy, s[1])),
                  slab(ray.oz, ray.dz, s[2]));
    }
    case Solid::Type::sphere: return ball(ray.ox, ray.oy, ray.oz, ray, s[0]);
    case Solid::Type::cylinder: return capped(ray, s[0], s[1]);
    case Solid::Type::cone: return meet(pointed(ray, s[0], s[1]), slab(ray.oz, ray.dz, s[1]));
    case Solid::Type::ellipsoid: return oval(ray, s);
    case Solid::Type::barrel: {
      const float radii[] = {s[0], s[0], s[2]};
      return meet(oval(ray, radii), slab(ray.oz, ray.dz, s[1]));
    }
    case Solid::Type::capsule:
    case Solid::Type::triangles: break;
  }
  // Convex, so its interval is the union of those of its three parts.
  const O up = ray.oz + s[1], down = ray.oz - s[1];
  const Interval top = unless_empty(ball(ray.ox, ray.oy, down, ray, s[0]));
  const Interval bottom = unless_empty(ball(ray.ox, ray.oy, up, ray, s[0]));
  return join(join(top, bottom), unless_empty(capped(ray, s[0], s[1])));
}

struct Dimensions {
  Solid::Type type;
  double a, b, c;
};
Dimensions dimensions(const Box& s) {
  return {Solid::Type::box, s.size_m.x / 2, s.size_m.y / 2, s.size_m.z / 2};
}
Dimensions dimensions(const Sphere& s) { return {Solid::Type::sphere, s.radius_m, 0, 0}; }
Dimensions dimensions(const Cylinder& s) { return {Solid::Type::cylinder, s.radius_m, s.length_m / 2, 0}; }
Dimensions dimensions(const Capsule& s) { return {Solid::Type::capsule, s.radius_m, s.length_m / 2, 0}; }
Dimensions dimensions(const Cone& s) { return {Solid::Type::cone, s.radius_m, s.length_m / 2, 0}; }
Dimensions dimensions(const Ellipsoid& s) {
  return {Solid::Type::ellipsoid, s.radii_m.x, s.radii_m.y, s.radii_m.z};
}
Dimensions dimensions(const Barrel& s) {
  // A cylinder nearly: a spheroid so long that its middle part is straight in single precision.
  const double thin = end_radius_m(s) / s.radius_m, half = 0.5 * s.length_m;
  return {Solid::Type::barrel, s.radius_m, half, half / std::sqrt(std::max(1e-4, 1 - thin * thin))};
}
template <class Other>
Dimensions dimensions(const Other&) {
  SL_CHECK_MSG(false, "no primitive solid");
  return {};
}

Solid make(Dimensions d, std::uint32_t body) {
  Solid solid{};
  solid.size[0] = static_cast<float>(d.a);
  solid.size[1] = static_cast<float>(d.b);
  solid.size[2] = static_cast<float>(d.c);
  solid.body = body;
  solid.type = d.type;
  solid.place({});
  return solid;
}

}  // namespace

void Solid::place(const Pose& X_WC) {
  const Vec3 x = rotate(X_WC.q, {1, 0, 0}), y = rotate(X_WC.q, {0, 1, 0}), z = rotate(X_WC.q, {0, 0, 1});
  for (std::size_t i = 0; i < 3; ++i) {
    position[i] = X_WC.p[i];
    axes[i] = static_cast<float>(x[i]);
    axes[3 + i] = static_cast<float>(y[i]);
    axes[6 + i] = static_cast<float>(z[i]);
  }
}

Solid make_solid(const Shape& shape, std::uint32_t body) {
  return make(std::visit([](const auto& s) { return dimensions(s); }, shape), body);
}

Solid make_triangles(Vec3 half_size_m, std::uint32_t body) {
  return make({Solid::Type::triangles, half_size_m.x, half_size_m.y, half_size_m.z}, body);
}

Bounds bounds(const Solid& solid) {
  Bounds result;
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = std::abs(solid.axes[i]), y = std::abs(solid.axes[3 + i]),
                 z = std::abs(solid.axes[6 + i]);
    const double a = solid.size[0], b = solid.size[1], c = solid.size[2];
    double half = a;
    if (solid.type == Solid::Type::box || solid.type == Solid::Type::triangles) half = x * a + y * b + z * c;
    if (solid.type == Solid::Type::cylinder || solid.type == Solid::Type::barrel)
      half = std::sqrt(x * x + y * y) * a + z * b;
    if (solid.type == Solid::Type::capsule) half = a + z * b;
    if (solid.type == Solid::Type::ellipsoid) half = std::sqrt(x * x * a * a + y * y * b * b + z * z * c * c);
    if (solid.type == Solid::Type::cone) {
      const double disc = std::sqrt(x * x + y * y) * a, apex = b * solid.axes[6 + i];
      result.lower[i] = solid.position[i] + std::min(apex, -apex - disc);
      result.upper[i] = solid.position[i] + std::max(apex, -apex + disc);
      continue;
    }
    result.lower[i] = solid.position[i] - half;
    result.upper[i] = solid.position[i] + half;
  }
  return result;
}

void origin_in(const Solid& solid, const double origin[3], float out[3]) {
  const double px = origin[0] - solid.position[0];
  const double py = origin[1] - solid.position[1];
  const double pz = origin[2] - solid.position[2];
  const float* m = solid.axes;
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = static_cast<float>(m[3 * i] * px + m[3 * i + 1] * py + m[3 * i + 2] * pz);
}

LocalRays8 to_local(const Solid& solid, const double origin[3], const Rays8& rays) {
  float o[3];
  origin_in(solid, origin, o);
  const float* m = solid.axes;
  // The same rounded axes turn origin and directions: an error of the axes only turns the solid a little.
  return {o[0],
          o[1],
          o[2],
          m[0] * rays.dx + m[1] * rays.dy + m[2] * rays.dz,
          m[3] * rays.dx + m[4] * rays.dy + m[5] * rays.dz,
          m[6] * rays.dx + m[7] * rays.dy + m[8] * rays.dz};
}

LocalSpread8 to_local(const Solid& solid, const double origin[3], const Spread8& from, const Rays8& rays) {
  const LocalRays8 one = to_local(solid, origin, rays);
  const float* m = solid.axes;
  return {one.ox + (m[0] * from.x + m[1] * from.y + m[2] * from.z),
          one.oy + (m[3] * from.x + m[4] * from.y + m[5] * from.z),
          one.oz + (m[6] * from.x + m[7] * from.y + m[8] * from.z),
          one.dx,
          one.dy,
          one.dz};
}

namespace {
F first_behind(F near, Interval part) {
  const F seen = select(part.first >= near, part.first, part.last);
  return select(part.first <= part.last, seen, broadcast(inf));
}
}  // namespace

F distance_to(const Solid& solid, const double origin[3], const Rays8& rays) {
  return first_behind(rays.near, inside(solid, to_local(solid, origin, rays)));
}
F distance_to(const Solid& solid, const LocalSpread8& rays, F near) {
  return first_behind(near, inside(solid, rays));
}

}  // namespace sandlot::optics
