#include "optics/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.h"
#include "base/hash.h"
#include "base/math.h"

namespace sandlot::optics {
namespace {

using lanes::broadcast;
using lanes::F;
using lanes::F3;
using lanes::I;

/// Digits of i in a base, mirrored behind the point.
double mirrored(int i, int base) {
  double value = 0, digit = 1;
  for (; i > 0; i /= base) {
    digit /= base;
    value += digit * (i % base);
  }
  return value;
}

constexpr std::size_t turns = 64;  // of the lens's samples
std::array<std::array<float, 2>, turns> make_turns() {
  std::array<std::array<float, 2>, turns> out;
  for (std::size_t i = 0; i < turns; ++i) {
    const auto [s, c] = math::sincos(math::tau * static_cast<double>(i) / turns);
    out[i] = {static_cast<float>(c), static_cast<float>(s)};
  }
  return out;
}

std::uint64_t mixed(std::uint64_t x) {  // finaliser of MurmurHash3
  x = (x ^ x >> 33) * 0xff51afd7ed558ccdull;
  x = (x ^ x >> 33) * 0xc4ceb9fe1a85ec53ull;
  return x ^ x >> 33;
}

F3 turned(const float* m, const F3& a) {
  return {m[0] * a.x + m[1] * a.y + m[2] * a.z, m[3] * a.x + m[4] * a.y + m[5] * a.z,
          m[6] * a.x + m[7] * a.y + m[8] * a.z};
}

}  // namespace

Pose moved(const Pose& X, const Velocity& v, double t_s) {
  const double rate = norm(v.angular);
  if (rate == 0 || t_s == 0) return {X.p + t_s * v.linear, X.q};
  return {X.p + t_s * v.linear, quat_from_axis_angle(v.angular / rate, rate * t_s) * X.q};
}

CameraRays::CameraRays(const PictureJob& job) : job_(job), lens_(job.lens->lens()) {
  const Exposure& e = job.exposure;
  SL_CHECK(job.lens);
  SL_CHECK(e.samples >= 1 && e.samples <= 256 && e.slices >= 0 && e.slices <= 1024);
  SL_CHECK(e.shutter_s >= 0 && e.readout_s >= 0 && e.aperture_m >= 0 && e.focus_m > 0);
  SL_CHECK(job.near_m >= 0 && job.far_m > job.near_m);
  for (std::size_t i = 0; i < 3; ++i) base_[i] = job.X_WS.p[i];
  if (const auto* p = std::get_if<Pinhole>(&lens_.model)) {
    pinhole_ = true;
    plain_ = job.lens->is_plain_pinhole();
    per_fx_ = static_cast<float>(1 / p->fx), per_fy_ = static_cast<float>(1 / p->fy);
    cx_ = static_cast<float>(p->cx), cy_ = static_cast<float>(p->cy);
  }
  samples_ = e.samples;
  rolling_ = e.readout_s > 0;
  aperture_ = pinhole_ && e.aperture_m > 0;
  first_s_ = -e.shutter_s / 2;
  last_s_ = e.readout_s + e.shutter_s / 2;
  moving_ = last_s_ > first_s_;  // half of the shortest time is none
  if (moving_) {
    slices_ = e.slices > 0 ? e.slices : rolling_ ? 16 : 8;
    if (e.shutter_s > 0 && !rolling_) samples_ = std::max(samples_, slices_);
  }
  still_ = view(0);
  // A step that visits all strata of time in an order that has nothing to do with the places on the pixel.
  int step = std::max(1, static_cast<int>(0.618 * samples_));
  while (std::gcd(step, samples_) != 1) ++step;
  for (int i = 0; i < samples_; ++i) {
    const double n = samples_;
    double x = (i + 0.5) / n - 0.5, y = mirrored(i, 2) + 0.5 / n - 0.5;
    if (samples_ == 1) x = y = 0;
    on_pixel_.push_back({static_cast<float>(x), static_cast<float>(y)});
    when_s_.push_back(((i * step % samples_ + 0.5) / n - 0.5) * e.shutter_s);
    // On the lens: equal areas, golden angles.
    const double r = 0.5 * e.aperture_m * std::sqrt(mirrored(i, 3) + 0.5 / n);
    const auto [s, c] = math::sincos(math::tau * 0.6180339887 * i);
    on_lens_.push_back({static_cast<float>(std::min(r, 0.5 * e.aperture_m) * c),
                        static_cast<float>(std::min(r, 0.5 * e.aperture_m) * s)});
  }
  cone_scale_ = static_cast<float>(1 / std::sqrt(static_cast<double>(samples_)));
}

CameraRays::View CameraRays::view(double t_s) const {
  const Pose X = moved(job_.X_WS, job_.velocity, t_s);
  View v;
  const Vec3 axes[] = {rotate(X.q, {1, 0, 0}), rotate(X.q, {0, 1, 0}), rotate(X.q, {0, 0, 1})};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      v.axes[3 * row + column] = static_cast<float>(axes[column][row]);
    v.offset[row] = static_cast<float>(X.p[row] - job_.X_WS.p[row]);
  }
  return v;
}

double CameraRays::row_time(const Block& block) const {
  if (!rolling_ || lens_.height < 2) return 0;
  return job_.exposure.readout_s * block.v[0] / (lens_.height - 1);
}
int CameraRays::slice_at(double t_s) const {
  if (slices_ == 1) return 0;
  const double at = (t_s - first_s_) / (last_s_ - first_s_) * slices_;
  return std::clamp(static_cast<int>(at), 0, slices_ - 1);
}
int CameraRays::slice_of(const Block& block, int sample) const {
  if (slices_ == 1) return 0;
  return slice_at(row_time(block) + when_s_[static_cast<std::size_t>(sample)]);
}
double CameraRays::time_of_slice(int slice) const {
  return first_s_ + (slice + 0.5) / slices_ * (last_s_ - first_s_);
}

Block CameraRays::block(int u0, int v0) const {
  Block b;
  b.width = lens_.width;
  b.u = u0 + (rolling_ ? I{0, 1, 2, 3, 4, 5, 6, 7} : I{0, 1, 2, 3, 0, 1, 2, 3});
  b.v = v0 + (rolling_ ? I{} : I{0, 0, 0, 0, 1, 1, 1, 1});
  b.inside = (b.u < lens_.width) & (b.v < lens_.height);
  return b;
}

Aim CameraRays::centre(const Block& block) const {
  const F zero = broadcast(0.0f);
  return aim(block, zero, zero, moving_ ? view(row_time(block)) : still_, -1);
}

Aim CameraRays::aim(const Block& block, int sample) const {
  const auto i = static_cast<std::size_t>(sample);
  return aim(block, broadcast(on_pixel_[i][0]), broadcast(on_pixel_[i][1]),
             moving_ ? view(row_time(block) + when_s_[i]) : still_, aperture_ ? sample : -1);
}

Aim CameraRays::aim(const Block& block, F du, F dv, const View& view, int lens_sample) const {
  Aim aim;
  Rays& rays = aim.rays;
  rays.base = base_;
  rays.valid = block.inside;
  F3 d;      // in S
  F length;  // of it for each metre along the optical axis
  if (plain_) {
    const F x = (lanes::to_float(block.u) + du - cx_) * per_fx_,
            y = (lanes::to_float(block.v) + dv - cy_) * per_fy_;
    length = lanes::sqrt(1 + x * x + y * y);
    const F forward = 1 / length;
    d = {forward, -x * forward, -y * forward};
    // The pixel's solid angle is forward^3 / (fx fy).
    aim.cone = std::sqrt(per_fx_ * per_fy_) * (forward * lanes::sqrt(forward));
  } else {
    d = from_table(block, du, dv, rays.valid, aim.cone);
    length = pinhole_ ? 1 / d.x : broadcast(1.0f);
  }
  aim.cone = cone_scale_ * aim.cone;
  F3 from{};
  rays.from_base = !moving_;
  if (job_.lens->has_origins()) {
    const auto& origins = job_.lens->origins();
    for (int i = 0; i < lanes::width; ++i) {
      if (!rays.valid[i]) continue;
      const auto& o = origins[block.index(i)];
      from.x[i] = o[0], from.y[i] = o[1], from.z[i] = o[2];
    }
    rays.from_base = false;
  }
  rays.near = static_cast<float>(job_.near_m) * length;
  rays.far = static_cast<float>(job_.far_m) * length;
  if (lens_sample >= 0) {
    static const std::array<std::array<float, 2>, turns> turn = make_turns();
    const auto [x, y] = on_lens_[static_cast<std::size_t>(lens_sample)];
    for (int i = 0; i < lanes::width; ++i) {
      const auto& t =
          turn[mixed(job_.key ^ (block.inside[i] ? block.index(i) * 0x9e3779b97f4a7c15ull : 0)) % turns];
      from.y[i] = t[0] * x - t[1] * y;
      from.z[i] = t[1] * x + t[0] * y;
    }
    // All rays of a pixel meet on the plane that is sharp.
    const F3 sharp = (static_cast<float>(job_.exposure.focus_m) * length) * d;
    d = normalised(sharp - from);
    rays.from_base = false;
  }
  rays.direction = turned(view.axes, d);
  rays.from = rays.from_base ? from : turned(view.axes, from) + lanes::broadcast3(view.offset);
  return aim;
}

F3 CameraRays::from_table(const Block& block, F du, F dv, I& valid, F& cone) const {
  const auto& table = job_.lens->directions();
  F3 out{broadcast(1.0f), broadcast(0.0f), broadcast(0.0f)};
  cone = broadcast(1e-3f);
  for (int i = 0; i < lanes::width; ++i) {
    if (!valid[i]) continue;
    const std::size_t at = block.index(i);
    const auto& d = table[at];
    if (!(d[0] == d[0])) {
      valid[i] = 0;
      continue;
    }
    // Differences to the neighbours: the way within a pixel, and how much it sees.
    const auto slope = [&](int place, int size, std::size_t stride) {
      std::array<float, 3> s{};
      const bool after = place + 1 < size && table[at + stride][0] == table[at + stride][0];
      const bool before = place > 0 && table[at - stride][0] == table[at - stride][0];
      const auto& high = after ? table[at + stride] : d;
      const auto& low = before ? table[at - stride] : d;
      const float share = after && before ? 0.5f : 1.0f;
      for (std::size_t k = 0; k < 3; ++k) s[k] = share * (high[k] - low[k]);
      return s;
    };
    const auto su = slope(block.u[i], lens_.width, 1),
               sv = slope(block.v[i], lens_.height, static_cast<std::size_t>(lens_.width));
    const auto square = [](const std::array<float, 3>& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; };
    cone[i] = std::sqrt(std::sqrt(square(su) * square(sv)));
    const float a = du[i], b = dv[i];
    out.x[i] = d[0] + a * su[0] + b * sv[0];
    out.y[i] = d[1] + a * su[1] + b * sv[1];
    out.z[i] = d[2] + a * su[2] + b * sv[2];
  }
  return normalised(out);
}

F CameraRays::depth(const Block& block, const Rays& rays, F t) const {
  if (plain_) {
    const F x = (lanes::to_float(block.u) - cx_) * per_fx_, y = (lanes::to_float(block.v) - cy_) * per_fy_;
    return t / lanes::sqrt(1 + x * x + y * y);
  }
  F out = t;
  if (pinhole_) {
    for (int i = 0; i < lanes::width; ++i)
      if (rays.valid[i]) out[i] = t[i] * job_.lens->directions()[block.index(i)][0];
    return out;
  }
  if (!job_.lens->has_origins()) return t;
  const auto& directions = job_.lens->directions();
  const auto& origins = job_.lens->origins();
  for (int i = 0; i < lanes::width; ++i) {
    if (!rays.valid[i]) continue;
    const auto &o = origins[block.index(i)], &d = directions[block.index(i)];
    float square = 0;
    for (std::size_t k = 0; k < 3; ++k) square += (o[k] + t[i] * d[k]) * (o[k] + t[i] * d[k]);
    out[i] = std::sqrt(square);
  }
  return out;
}

}  // namespace sandlot::optics
