#include "optics/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/check.h"
#include "base/math.h"

namespace sandlot::optics {
namespace {

using math::pi;
using Place2 = std::array<double, 2>;

constexpr int max_side = 8192;
constexpr double max_pixels = 1 << 24;
constexpr double degree = pi / 180;
/// Half the widest field of view of a pinhole; its image of a point near 90 degrees is anywhere.
constexpr double max_pinhole_rad = 89.5 * degree;

// ---- pinhole

bool is_distorted(const Pinhole& p) { return p.k1 != 0 || p.k2 != 0 || p.p1 != 0 || p.p2 != 0 || p.k3 != 0; }

struct Bent {
  Place2 at;
  double xx, xy, yy;  ///< derivative, symmetric
  double radial;      ///< derivative of the radial part alone: falls to 0 where the image folds over
};

/// OpenCV's plumb_bob: from the ideal place (x, y) at distance 1 to the distorted one.
Bent bend(const Pinhole& p, double x, double y) {
  const double r2 = x * x + y * y;
  const double s = 1 + r2 * (p.k1 + r2 * (p.k2 + r2 * p.k3));
  const double ds = p.k1 + r2 * (2 * p.k2 + r2 * 3 * p.k3);  // ds / d(r2)
  return {{x * s + 2 * p.p1 * x * y + p.p2 * (r2 + 2 * x * x),
           y * s + p.p1 * (r2 + 2 * y * y) + 2 * p.p2 * x * y},
          s + 2 * x * x * ds + 2 * p.p1 * y + 6 * p.p2 * x,
          2 * x * y * ds + 2 * p.p1 * x + 2 * p.p2 * y,
          s + 2 * y * y * ds + 6 * p.p1 * y + 2 * p.p2 * x,
          s + 2 * r2 * ds};
}

/// The radius, in focal lengths, within which the radial part grows: beyond, the image folds over.
double fold_radius(const Pinhole& p) {
  // Where 1 + 3 k1 q + 5 k2 q^2 + 7 k3 q^3 first falls to 0, q = r^2: walked along, then halved.
  const auto growth = [&](double q) { return 1 + q * (3 * p.k1 + q * (5 * p.k2 + q * 7 * p.k3)); };
  double below = 0;
  for (double r = 0.01; r < 100; r *= 1.02) {
    if (growth(r * r) > 0) {
      below = r;
      continue;
    }
    double above = r;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (below + above);
      (growth(middle * middle) > 0 ? below : above) = middle;
    }
    return below;
  }
  return std::numeric_limits<double>::infinity();
}

std::optional<LensRay> ray(const Pinhole& p, double u, double v, double fold) {
  const Place2 target{(u - p.cx) / p.fx, (v - p.cy) / p.fy};
  double x = target[0], y = target[1];
  if (is_distorted(p)) {
    // Newton with damped steps: from the middle outwards, it cannot jump over the fold.
    if (x * x + y * y > fold * fold) {
      const double shorter = 0.9 * fold / std::sqrt(x * x + y * y);
      x *= shorter, y *= shorter;
    }
    bool found = false;
    for (int i = 0; i < 60 && !found; ++i) {
      const Bent b = bend(p, x, y);
      const double ex = target[0] - b.at[0], ey = target[1] - b.at[1];
      found = ex * ex + ey * ey < 1e-24;
      const double determinant = b.xx * b.yy - b.xy * b.xy;
      if (!(determinant > 0)) return std::nullopt;
      double sx = (b.yy * ex - b.xy * ey) / determinant, sy = (b.xx * ey - b.xy * ex) / determinant;
      const double step = std::sqrt(sx * sx + sy * sy), most = 0.2 + 0.3 * std::sqrt(x * x + y * y);
      if (step > most) sx *= most / step, sy *= most / step;
      x += sx, y += sy;
    }
    if (!found || x * x + y * y > fold * fold) return std::nullopt;
  }
  return LensRay{{}, normalised(Vec3{1, -x, -y})};
}

std::optional<Place2> see(const Pinhole& p, Vec3 d, double fold) {
  if (!(d.x > 0)) return std::nullopt;
  Place2 at{-d.y / d.x, -d.z / d.x};
  if (is_distorted(p)) {
    if (at[0] * at[0] + at[1] * at[1] > fold * fold) return std::nullopt;
    at = bend(p, at[0], at[1]).at;
  }
  return Place2{p.cx + p.fx * at[0], p.cy + p.fy * at[1]};
}

// ---- fisheye

/// Image radius in focal lengths, and its derivative.
std::array<double, 2> radius_of(const Fisheye& f, double theta) {
  switch (f.mapping) {
    case Fisheye::Mapping::equidistant: return {theta, 1};
    case Fisheye::Mapping::equisolid: return {2 * math::sin(theta / 2), math::cos(theta / 2)};
    case Fisheye::Mapping::stereographic: {
      const double t = math::tan(theta / 2);
      return {2 * t, 1 + t * t};
    }
    case Fisheye::Mapping::orthographic: return {math::sin(theta), math::cos(theta)};
    case Fisheye::Mapping::kannala_brandt: break;
  }
  const double q = theta * theta;
  return {theta * (1 + q * (f.k1 + q * (f.k2 + q * (f.k3 + q * f.k4)))),
          1 + q * (3 * f.k1 + q * (5 * f.k2 + q * (7 * f.k3 + q * 9 * f.k4)))};
}

/// As far as the lens is one to one, and no farther than requested.
double max_theta(const Fisheye& f) {
  double most = std::min(f.max_theta_rad, pi);
  if (f.mapping == Fisheye::Mapping::orthographic) most = std::min(most, pi / 2);
  if (f.mapping == Fisheye::Mapping::stereographic) most = std::min(most, pi - 1e-3);
  if (f.mapping != Fisheye::Mapping::kannala_brandt) return most;
  double theta = 0;
  while (theta < most && radius_of(f, theta + 1e-3)[1] > 0) theta += 1e-3;
  return std::min(theta, most);
}

std::optional<double> theta_of(const Fisheye& f, double r, double most) {
  if (r > radius_of(f, most)[0] * (1 + 1e-12)) return std::nullopt;
  switch (f.mapping) {
    case Fisheye::Mapping::equidistant: return r;
    case Fisheye::Mapping::equisolid: return 2 * math::asin(std::min(1.0, r / 2));
    case Fisheye::Mapping::stereographic: return 2 * math::atan(r / 2);
    case Fisheye::Mapping::orthographic: return math::asin(std::min(1.0, r));
    case Fisheye::Mapping::kannala_brandt: break;
  }
  double low = 0, high = most, theta = std::min(r, most);
  for (int i = 0; i < 60; ++i) {  // Newton between bounds
    const auto [at, slope] = radius_of(f, theta);
    (at < r ? low : high) = theta;
    const double next = theta - (at - r) / slope;
    const double into = next > low && next < high ? next : 0.5 * (low + high);
    if (std::abs(into - theta) < 1e-15) break;
    theta = into;
  }
  return theta;
}

std::optional<LensRay> ray(const Fisheye& f, double u, double v, double most) {
  const double x = (u - f.cx) / f.fx, y = (v - f.cy) / f.fy, r = math::hypot(x, y);
  const std::optional<double> theta = theta_of(f, r, most);
  if (!theta) return std::nullopt;
  if (r < 1e-300) return LensRay{{}, {1, 0, 0}};
  const auto [s, c] = math::sincos(*theta);
  return LensRay{{}, normalised(Vec3{c, -s * x / r, -s * y / r})};
}

std::optional<Place2> see(const Fisheye& f, Vec3 d, double most) {
  const double across = math::hypot(d.y, d.z), theta = math::atan2(across, d.x);
  if (theta > most || norm(d) < 1e-300) return std::nullopt;
  if (across < 1e-300) return Place2{f.cx, f.cy};
  const double r = radius_of(f, theta)[0];
  return Place2{f.cx - f.fx * r * d.y / across, f.cy - f.fy * r * d.z / across};
}

// ---- mirrors: everything happens in a half plane through the axis, (r, z)

struct Flat {
  double r, z;
};
/// A point of the mirror and where the camera sees from there.
struct Glance {
  Flat point, direction;
};

/// @param q  radius in the image: the tangent of the angle from the axis; of the parabolic mirror, metres
std::optional<Glance> glance(const Catadioptric& m, double q) {
  const double a = m.a_m, b = m.b_m;
  if (m.mirror == Catadioptric::Mirror::parabolic) {
    if (q > m.rim_m) return std::nullopt;
    const double z = (q * q - a * a) / (2 * a), n = (q * q + a * a) / (2 * a);
    return Glance{{q, z}, {q / n, z / n}};
  }
  const double n = std::sqrt(1 + q * q), s = 1 / n,
               c = q / n;  // elevation of the camera's ray: its sine and cosine
  if (m.mirror == Catadioptric::Mirror::hyperbolic) {
    const double focal = std::sqrt(a * a + b * b), below = a * a * s * s - b * b * c * c;
    if (!(below > 0)) return std::nullopt;  // beyond the asymptote
    const double along = a * a * (focal * s + b) / below;
    const Flat point{along * c, along * s - 2 * focal};
    if (point.r > m.rim_m) return std::nullopt;
    const double d = math::hypot(point.r, point.z);
    return Glance{point, {point.r / d, point.z / d}};
  }
  const double square = a * a - b * b * c * c;
  if (!(square > 0)) return std::nullopt;
  const double along = b * s - std::sqrt(square);
  const Flat point{along * c, along * s - b}, normal{point.r / a, point.z / a};
  if (point.r > m.rim_m) return std::nullopt;
  const double towards = 2 * (c * normal.r + s * normal.z);
  return Glance{point, {c - towards * normal.r, s - towards * normal.z}};
}

std::optional<LensRay> ray(const Catadioptric& m, double u, double v) {
  const double x = (u - m.cx) / m.fx, y = (v - m.cy) / m.fy, q = math::hypot(x, y);
  const std::optional<Glance> g = glance(m, q);
  if (!g) return std::nullopt;
  // Upwards in the image is x of S, to the right y: the camera looks up.
  const double forward = q > 0 ? -y / q : 1, left = q > 0 ? x / q : 0;
  const auto in_S = [&](Flat f) { return Vec3{f.r * forward, f.r * left, f.z}; };
  return LensRay{in_S(g->point), normalised(in_S(g->direction))};
}

/// The image radius at which the mirror ends.
double rim_radius(const Catadioptric& m) {
  const double a = m.a_m, b = m.b_m, rim = m.rim_m;
  switch (m.mirror) {
    case Catadioptric::Mirror::parabolic: return rim;
    case Catadioptric::Mirror::hyperbolic:
      return rim / (b * std::sqrt(1 + rim * rim / (a * a)) + std::sqrt(a * a + b * b));
    case Catadioptric::Mirror::spherical: break;
  }
  // The part of the sphere that the camera sees ends where its rays graze.
  const double grazing = a * std::sqrt(1 - a * a / (b * b)), r = std::min(rim, grazing);
  return r / (b - std::sqrt(a * a - r * r));
}

std::optional<Place2> see(const Catadioptric& m, Vec3 d) {
  const double across = std::sqrt(d.x * d.x + d.y * d.y), length = norm(d);
  if (length < 1e-300) return std::nullopt;
  double q = 0;
  const double rim = rim_radius(m);
  if (m.mirror == Catadioptric::Mirror::spherical) {
    // Which ray passes the point: those farther out pass it farther above. Halved until it is sure.
    const auto passes_below = [&](double at) {
      const std::optional<Glance> g = glance(m, at);
      if (!g) return false;
      return g->direction.r * (d.z - g->point.z) - g->direction.z * (across - g->point.r) > 0;
    };
    double low = 0, high = rim * (1 - 1e-12);
    if (across > 0 && passes_below(high)) return std::nullopt;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (passes_below(middle) ? low : high) = middle;
    }
    q = across > 0 ? 0.5 * (low + high) : 0;
  } else {
    double xi = 1, k = m.a_m;
    if (m.mirror == Catadioptric::Mirror::hyperbolic) {
      const double a2 = m.a_m * m.a_m, b2 = m.b_m * m.b_m, focal2 = a2 + b2;
      xi = 2 * m.b_m * std::sqrt(focal2) / (b2 + focal2);
      k = a2 / (b2 + focal2);
    }
    const double below = xi - d.z / length;
    if (!(below > 0)) return std::nullopt;
    q = k * (across / length) / below;
  }
  if (q > rim) return std::nullopt;
  if (across < 1e-300) return Place2{m.cx, m.cy};
  return Place2{m.cx + m.fx * q * d.y / across, m.cy - m.fy * q * d.x / across};
}

// ---- what is refused

Error refuse(std::string what, std::string fix) { return Error{std::move(what), std::move(fix), {}, ""}; }

Status check_scale(double fx, double fy, double cx, double cy) {
  const auto good = [](double f) { return std::isfinite(f) && f > 1e-6 && f < 1e9; };
  if (!good(fx) || !good(fy))
    return refuse("the focal length of a lens is a number of pixels above 0", "for instance 500");
  if (!std::isfinite(cx) || !std::isfinite(cy) || std::abs(cx) > 1e6 || std::abs(cy) > 1e6)
    return refuse("the optical axis of a lens is a place in its image",
                  "the middle: (width - 1) / 2, (height - 1) / 2");
  return {};
}

Status check_model(const Lens& lens, const Pinhole& p) {
  SL_TRY(check_scale(p.fx, p.fy, p.cx, p.cy));
  for (const double k : {p.k1, p.k2, p.p1, p.p2, p.k3})
    if (!(std::abs(k) < 1e6)) return refuse("the distortion of a lens is five numbers", "k1 k2 p1 p2 k3");
  const double half = std::max(p.cx + 0.5, lens.width - 0.5 - p.cx) / p.fx;
  if (!is_distorted(p) && half > math::tan(max_pinhole_rad))
    return refuse("a pinhole camera sees less than 179 degrees", "a longer focal length, or a fisheye lens");
  return {};
}

Status check_model(const Lens&, const Fisheye& f) {
  SL_TRY(check_scale(f.fx, f.fy, f.cx, f.cy));
  for (const double k : {f.k1, f.k2, f.k3, f.k4})
    if (!(std::abs(k) < 1e6)) return refuse("the distortion of a fisheye is four numbers", "k1 k2 k3 k4");
  if (!(f.max_theta_rad > 0) || f.max_theta_rad > 3.15)
    return refuse("half the field of view of a fisheye is an angle above 0 and up to 180 degrees",
                  "1.5708 for a lens of 180 degrees");
  if (!(max_theta(f) > 0))
    return refuse("this fisheye's distortion folds its image over in the middle", "smaller k1");
  return {};
}

Status check_model(const Lens& lens, const Catadioptric& m) {
  SL_TRY(check_scale(m.fx, m.fy, m.cx, m.cy));
  const auto length = [](double x) { return std::isfinite(x) && x > 1e-6 && x < 1e3; };
  const bool two = m.mirror != Catadioptric::Mirror::parabolic;
  if (!length(m.a_m) || (two && !length(m.b_m)) || !length(m.rim_m))
    return refuse("the size of a mirror is lengths above 0",
                  "a and b of its curve and the radius of its rim, in metres");
  if (m.mirror == Catadioptric::Mirror::spherical) {
    if (!(m.b_m > m.a_m))
      return refuse("the camera is inside its spherical mirror",
                    "b, its distance from the centre, above the radius a");
    if (m.rim_m > m.a_m) return refuse("the rim of a spherical mirror is wider than the sphere", "at most a");
  }
  // The place of the image next to the axis must lie within the mirror's picture.
  const double u = std::clamp(m.cx, 0.0, lens.width - 1.0), v = std::clamp(m.cy, 0.0, lens.height - 1.0);
  if (math::hypot((u - m.cx) / m.fx, (v - m.cy) / m.fy) > rim_radius(m))
    return refuse("the mirror is outside the image",
                  "move cx and cy into the image, or widen the mirror's rim");
  if (rim_radius(m) * std::min(m.fx, m.fy) < 1)
    return refuse("the mirror is smaller than a pixel", "a wider rim, or a longer focal length");
  return {};
}

Status check_size(int width, int height) {
  if (width >= 1 && height >= 1 && width <= max_side && height <= max_side &&
      static_cast<double>(width) * height <= max_pixels)
    return {};
  return refuse(
      "an image of " + std::to_string(width) + " x " + std::to_string(height) + " pixels cannot be taken",
      "1 to 8192 a side, at most 16.8 million together");
}

/// Derived quantities for ray() and project(), computed once for a whole table.
double limit(const Pinhole& p) { return is_distorted(p) ? fold_radius(p) : 0; }
double limit(const Fisheye& f) { return max_theta(f); }
double limit(const Catadioptric&) { return 0; }
std::optional<LensRay> ray(const Catadioptric& m, double u, double v, double) { return ray(m, u, v); }
std::optional<Place2> see(const Catadioptric& m, Vec3 d, double) { return see(m, d); }

}  // namespace

Status check(const Lens& lens) {
  SL_TRY(check_size(lens.width, lens.height));
  return std::visit([&](const auto& m) { return check_model(lens, m); }, lens.model);
}

std::optional<LensRay> ray_through(const Lens& lens, double u, double v) {
  return std::visit([&](const auto& m) { return ray(m, u, v, limit(m)); }, lens.model);
}

std::optional<Place2> project(const Lens& lens, Vec3 point_S) {
  return std::visit([&](const auto& m) { return see(m, point_S, limit(m)); }, lens.model);
}

std::array<double, 9> intrinsics(const Lens& lens) {
  return std::visit(
      [](const auto& m) { return std::array<double, 9>{m.fx, 0, m.cx, 0, m.fy, m.cy, 0, 0, 1}; }, lens.model);
}

Result<Lens> pinhole_of_fov(int width, int height, double hfov_rad) {
  SL_TRY(check_size(width, height));
  if (!(hfov_rad >= 1e-3) || hfov_rad > 2 * max_pinhole_rad)
    return refuse("a pinhole camera sees more than 0 and less than 179 degrees",
                  "a field of view of 1.047 (60 degrees), or a fisheye lens");
  const double f = 0.5 * width / math::tan(hfov_rad / 2);
  Lens lens{width, height, Pinhole{f, f, 0.5 * (width - 1), 0.5 * (height - 1)}};
  SL_TRY(check(lens));
  return lens;
}

Result<Lens> fisheye_of_fov(int width, int height, double hfov_rad, Fisheye::Mapping mapping) {
  SL_TRY(check_size(width, height));
  Fisheye f{mapping, 1, 1, 0.5 * (width - 1), 0.5 * (height - 1)};
  f.max_theta_rad = pi;
  if (!(hfov_rad >= 1e-3) || hfov_rad > 2 * max_theta(f) + 1e-9)
    return refuse("a fisheye of this mapping cannot see that wide",
                  "a field of view above 0 and up to " + std::to_string(2 * max_theta(f)));
  f.max_theta_rad = hfov_rad / 2;
  f.fx = f.fy = 0.5 * width / radius_of(f, hfov_rad / 2)[0];
  Lens lens{width, height, f};
  SL_TRY(check(lens));
  return lens;
}

Result<Lens> omni_that_fills(int width, int height, Catadioptric m) {
  SL_TRY(check_size(width, height));
  m.cx = 0.5 * (width - 1), m.cy = 0.5 * (height - 1);
  m.fx = m.fy = 1e6;  // any that is checked for nothing but the mirror
  Lens lens{width, height, m};
  SL_TRY(check(lens));
  m.fx = m.fy = 0.5 * std::min(width, height) / rim_radius(m);
  lens.model = m;
  SL_TRY(check(lens));
  return lens;
}

LensTable::LensTable(const Lens& lens) : lens_(lens) {
  const auto* plain = std::get_if<Pinhole>(&lens.model);
  if (plain && !is_distorted(*plain)) return;
  const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
  directions_.reserve(pixels);
  if (std::holds_alternative<Catadioptric>(lens.model)) origins_.reserve(pixels);
  const auto narrow = [](Vec3 a) {
    return std::array{static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
  };
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::visit(
      [&](const auto& model) {
        const double most = limit(model);
        for (int v = 0; v < lens.height; ++v)
          for (int u = 0; u < lens.width; ++u) {
            const std::optional<LensRay> r = ray(model, u, v, most);
            directions_.push_back(narrow(r ? r->direction : Vec3{none, none, none}));
            if (origins_.capacity() > 0) origins_.push_back(narrow(r ? r->origin : Vec3{}));
          }
      },
      lens.model);
}

std::shared_ptr<const LensTable> LensTable::make(const Lens& lens) {
  SL_CHECK(check(lens));
  return std::shared_ptr<const LensTable>(new LensTable(lens));
}

}  // namespace sandlot::optics
