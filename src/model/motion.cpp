#include "model/motion.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/math.h"

namespace sandlot::model {
namespace {

/// Axis times angle of the short way.
Vec3 rotation_vector(Quat q) {
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const Vec3 v{q.x, q.y, q.z};
  const double s = norm(v);
  return s > 0 ? 2 * math::atan2(s, q.w) / s * v : Vec3{};
}

/// Which round it is, counted from 0; before the first and where there are none, 0.
double round_at(const Motion& motion, double time_s) {
  const double length = motion.keys.back().time_s, t = time_s - motion.delay_s;
  return motion.loop && length > 0 && t > 0 ? std::floor(t / length) : 0;
}

}  // namespace

Pose pose_at(const Motion& motion, double time_s) {
  SL_CHECK(!motion.keys.empty());
  const auto& keys = motion.keys;
  const double t = time_s - motion.delay_s - round_at(motion, time_s) * keys.back().time_s;
  const auto next = std::upper_bound(keys.begin(), keys.end(), t,
                                     [](double at, const Motion::Key& key) { return at < key.time_s; });
  if (next == keys.begin()) return keys.front().X_WM;
  if (next == keys.end()) return keys.back().X_WM;
  const Motion::Key &a = *(next - 1), &b = *next;
  const double s = (t - a.time_s) / (b.time_s - a.time_s);
  const Vec3 turn = rotation_vector(conjugate(a.X_WM.q) * b.X_WM.q);
  const double angle = norm(turn);
  return {a.X_WM.p + s * (b.X_WM.p - a.X_WM.p),
          normalised(a.X_WM.q * quat_from_axis_angle(normalised(turn), s * angle))};
}

Moved moved(const Motion& motion, double from_s, double to_s) {
  const Pose before = pose_at(motion, from_s), after = pose_at(motion, to_s);
  const Pose &first = motion.keys.front().X_WM, &last = motion.keys.back().X_WM;
  const bool closed = norm(last.p - first.p) < 1e-9 &&
                      norm(rotation_vector(conjugate(first.q) * last.q)) < 1e-9;
  if (!closed && round_at(motion, from_s) != round_at(motion, to_s)) return {after, {}};
  const double h = to_s - from_s;
  return {after, {(after.p - before.p) / h, rotation_vector(after.q * conjugate(before.q)) / h}};
}

}  // namespace sandlot::model
