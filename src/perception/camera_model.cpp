#include "perception/camera_model.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "base/math.h"

namespace sandlot::perception {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The radius at which x (1 + k1 r^2 + k2 r^4 + k3 r^6) stops growing.
double fold_radius(double k1, double k2, double k3) {
  for (double r = 0.01; r < 20; r += 0.01) {
    const double q = r * r;
    if (1 + q * (3 * k1 + q * (5 * k2 + q * 7 * k3)) <= 0) return r;
  }
  return infinity;
}

}  // namespace

Result<CameraModel> CameraModel::of(const msg::CameraInfo& info) {
  CameraModel model;
  const auto fault = [&](const char* what) { return Error{"camera_info: " + std::string(what)}; };
  if (info.width < 1 || info.height < 1 || info.width > 8192 || info.height > 8192)
    return fault("a picture of 1 to 8192 pixels a side is needed");
  model.width_ = static_cast<int>(info.width), model.height_ = static_cast<int>(info.height);
  model.fx_ = info.k[0], model.fy_ = info.k[4], model.cx_ = info.k[2], model.cy_ = info.k[5];
  const auto good = [](double x) { return std::isfinite(x) && std::abs(x) < 1e9; };
  if (!(model.fx_ > 1e-6) || !(model.fy_ > 1e-6) || !good(model.fx_) || !good(model.fy_) ||
      !good(model.cx_) || !good(model.cy_))
    return fault("the focal lengths in K must be positive");
  for (std::size_t i = 0; i < info.d.size() && i < 5; ++i) {
    if (!good(info.d[i])) return fault("D has a number that is none");
    model.d_[i] = info.d[i];
  }
  const std::string& name = info.distortion_model;
  if (name.empty() || name == "plumb_bob") model.kind_ = Kind::pinhole;
  else if (name == "equidistant") model.kind_ = Kind::equidistant;
  else if (name == "equisolid") model.kind_ = Kind::equisolid;
  else if (name == "stereographic") model.kind_ = Kind::stereographic;
  else if (name == "orthographic") model.kind_ = Kind::orthographic;
  else if (name == "mirror_hyperbolic") model.kind_ = Kind::hyperbolic;
  else if (name == "mirror_parabolic") model.kind_ = Kind::parabolic;
  else if (name == "mirror_spherical") model.kind_ = Kind::spherical;
  else
    return Error{"camera_info: the model '" + name.substr(0, 40) + "' is not known",
                 "plumb_bob, equidistant, equisolid, stereographic, orthographic, mirror_hyperbolic, "
                 "mirror_parabolic and mirror_spherical are"};
  if (model.around() && !(model.d_[0] > 0 && model.d_[2] > 0 && model.d_[1] >= 0))
    return fault("a mirror needs D = a, b, rim, all positive");
  if (model.kind_ == Kind::pinhole) model.fold_ = fold_radius(model.d_[0], model.d_[1], model.d_[4]);
  return model;
}

Result<CameraModel> CameraModel::fit_polynomial(int width, int height, double cx, double cy,
                                                std::span<const Sighting> sightings) {
  CameraModel model;
  model.kind_ = Kind::polynomial;
  model.width_ = width, model.height_ = height;
  model.cx_ = cx, model.cy_ = cy;
  model.scale_ = 0.5 * std::max(1, std::min(width, height));
  const auto rows = static_cast<Eigen::Index>(sightings.size());
  Eigen::MatrixXd powers(rows, 5);
  Eigen::VectorXd climb(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Sighting& s = sightings[static_cast<std::size_t>(i)];
    const double r = math::hypot(s.u - cx, s.v - cy) / model.scale_,
                 out = math::hypot(s.point_S.x, s.point_S.y);
    if (!(r > 1e-6) || !(out > 1e-9) || !is_finite(s.point_S))
      return Error{"a sighting in the middle of the image tells nothing",
                   "points beside the axis are needed"};
    // Weighted by the ray's own length, so that an error of the fit is an error of the angle.
    const double weight = 1 / (r * math::hypot(1.0, s.point_S.z / out));
    double power = weight;
    for (Eigen::Index k = 0; k < 5; ++k, power *= r) powers(i, k) = power;
    climb(i) = weight * r * s.point_S.z / out;
  }
  const auto qr = powers.colPivHouseholderQr();
  if (rows < 10 || qr.rank() < 5)
    return Error{"too few sightings to fit the lens", "at least ten, at different distances from the middle"};
  const Eigen::VectorXd a = qr.solve(climb);
  for (std::size_t k = 0; k < 5; ++k) model.d_[k] = a(static_cast<Eigen::Index>(k));
  return model;
}

std::optional<SightRay> CameraModel::ray(double u, double v) const {
  const double x = (u - cx_) / fx_, y = (v - cy_) / fy_;  // right, down
  const auto around_axis = [&](double out, double up, Vec3 origin = {}) {
    // Below a mirror x is upwards in the image and y to its right.
    const double r = math::hypot(x, y);
    const double c = r > 0 ? -y / r : 1, s = r > 0 ? x / r : 0;
    return SightRay{{origin.x * c, origin.x * s, origin.z},
                    normalised(Vec3{out * c, out * s, up}, {0, 0, -1})};
  };
  switch (kind_) {
    case Kind::pinhole: {
      // Newton on OpenCV's plumb_bob.
      double a = x, b = y;
      const double far = math::hypot(a, b);
      if (far > 0.9 * fold_) a *= 0.9 * fold_ / far, b *= 0.9 * fold_ / far;
      const auto& [k1, k2, p1, p2, k3] = d_;
      bool found = false;
      for (int i = 0; i < 40 && !found; ++i) {
        const double q = a * a + b * b, s = 1 + q * (k1 + q * (k2 + q * k3)),
                     ds = k1 + q * (2 * k2 + q * 3 * k3);
        const double ex = x - (a * s + 2 * p1 * a * b + p2 * (q + 2 * a * a)),
                     ey = y - (b * s + p1 * (q + 2 * b * b) + 2 * p2 * a * b);
        found = ex * ex + ey * ey < 1e-20;
        const double xx = s + 2 * a * a * ds + 2 * p1 * b + 6 * p2 * a,
                     xy = 2 * a * b * ds + 2 * p1 * a + 2 * p2 * b,
                     yy = s + 2 * b * b * ds + 6 * p1 * b + 2 * p2 * a, determinant = xx * yy - xy * xy;
        if (!(std::abs(determinant) > 1e-12)) return std::nullopt;
        a += (yy * ex - xy * ey) / determinant;
        b += (xx * ey - xy * ex) / determinant;
      }
      if (!found || !(a * a + b * b < fold_ * fold_)) return std::nullopt;
      return SightRay{{}, normalised(Vec3{1, -a, -b})};
    }
    case Kind::equidistant:
    case Kind::equisolid:
    case Kind::stereographic:
    case Kind::orthographic: {
      const double r = math::hypot(x, y);
      double theta = r;
      if (kind_ == Kind::equisolid) theta = r < 2 ? 2 * math::asin(r / 2) : infinity;
      else if (kind_ == Kind::stereographic) theta = 2 * math::atan(r / 2);
      else if (kind_ == Kind::orthographic) theta = r < 1 ? math::asin(r) : infinity;
      else
        for (int i = 0; i < 30; ++i) {
          const double q = theta * theta;
          const double slope = 1 + q * (3 * d_[0] + q * (5 * d_[1] + q * (7 * d_[2] + q * 9 * d_[3])));
          if (!(slope > 1e-6)) return std::nullopt;
          theta -= (theta * (1 + q * (d_[0] + q * (d_[1] + q * (d_[2] + q * d_[3])))) - r) / slope;
        }
      if (!(theta >= 0 && theta <= math::pi)) return std::nullopt;
      const auto [s, c] = math::sincos(theta);
      const double out = r > 0 ? s / r : 1;
      return SightRay{{}, normalised(Vec3{c, -out * x, -out * y})};
    }
    case Kind::hyperbolic: {
      // From the camera, one focus, under the angle alpha to the mirror at the distance s; the other focus,
      // S, is 2 c above.
      const double a = d_[0], b = d_[1], c = std::sqrt(a * a + b * b), tan_alpha = math::hypot(x, y);
      const double cos_alpha = 1 / math::hypot(1.0, tan_alpha), sin_alpha = tan_alpha * cos_alpha;
      const double under = c * cos_alpha - b;
      if (!(under > 0)) return std::nullopt;
      const double s = a * a / under;
      if (s * sin_alpha > d_[2]) return std::nullopt;
      return around_axis(s * sin_alpha, s * cos_alpha - 2 * c);
    }
    case Kind::parabolic: {
      const double r = math::hypot(x, y);  // fx: pixels per metre
      if (r > d_[2]) return std::nullopt;
      return around_axis(r, (r * r - d_[0] * d_[0]) / (2 * d_[0]));
    }
    case Kind::spherical: {
      const double radius = d_[0], below = d_[1], tan_alpha = math::hypot(x, y);
      const double cos_alpha = 1 / math::hypot(1.0, tan_alpha), sin_alpha = tan_alpha * cos_alpha;
      const double inside = radius * radius - below * below * sin_alpha * sin_alpha;
      if (!(inside >= 0) || !(below > radius)) return std::nullopt;
      const double s = below * cos_alpha - std::sqrt(inside);
      const double out = s * sin_alpha, up = s * cos_alpha - below;
      if (out > d_[2]) return std::nullopt;
      const double along = (sin_alpha * out + cos_alpha * up) /
                           radius;  // of the ray on the outward normal: negative
      return around_axis(sin_alpha - 2 * along * out / radius, cos_alpha - 2 * along * up / radius,
                         {out, 0, up});
    }
    case Kind::polynomial: {
      const double r = math::hypot(u - cx_, v - cy_) / scale_;
      if (r > 1) return std::nullopt;  // beyond the circle that was measured
      return around_axis(r, d_[0] + r * (d_[1] + r * (d_[2] + r * (d_[3] + r * d_[4]))));
    }
  }
  return std::nullopt;
}

}  // namespace sandlot::perception
