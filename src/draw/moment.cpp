#include "draw/moment.h"

#include <algorithm>

#include "base/check.h"
#include "base/math.h"
#include "sim/world/simulation.h"

namespace sandlot::draw {
namespace {

constexpr double leap_m = 0.1;

Quat interpolated_turn(Quat a, Quat b, double share) {
  double dot = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  const double sign = dot < 0 ? -1 : 1;
  dot *= sign;
  double from = 1 - share, to = share;
  if (dot < 0.9995) {  // else a chord is as good as the arc, and the sine below too small
    const double angle = math::acos(dot), whole = math::sin(angle);
    from = math::sin((1 - share) * angle) / whole;
    to = math::sin(share * angle) / whole;
  }
  to *= sign;
  return normalised(
      Quat{from * a.w + to * b.w, from * a.x + to * b.x, from * a.y + to * b.y, from * a.z + to * b.z});
}

}  // namespace

Pose interpolated(const Pose& a, const Pose& b, double share) {
  return {a.p + share * (b.p - a.p), interpolated_turn(a.q, b.q, share)};
}

TickPoses TickPoses::of(const Simulation& simulation) {
  TickPoses out{simulation.now(), simulation.revision(), {}};
  for (const auto& state : simulation.engine().states())
    out.bodies.push_back({state.X_WB, norm(state.V_WB.linear)});
  return out;
}

Moment moment_between(const TickPoses& a, const TickPoses& b, Time at) {
  SL_CHECK(a.at <= at && at <= b.at);
  Moment out{at, {}};
  const bool same = a.revision == b.revision && a.bodies.size() == b.bodies.size();
  const double step_s = (b.at - a.at).s(), share = step_s > 0 ? (at - a.at).s() / step_s : 1;
  const TickPoses& base = same && share < 1 ? a : b;
  for (const TickPoses::Body& state : base.bodies) out.X_WB.push_back(state.X_WB);
  if (&base == &b) return out;
  for (std::size_t i = 0; i < out.X_WB.size(); ++i) {
    const TickPoses::Body &before = a.bodies[i], &after = b.bodies[i];
    const double speed_mps = before.speed_mps + after.speed_mps;
    if (norm(after.X_WB.p - before.X_WB.p) <= speed_mps * step_s + leap_m)
      out.X_WB[i] = interpolated(before.X_WB, after.X_WB, share);
  }
  return out;
}

}  // namespace sandlot::draw
