#include "sim/world/pull.h"

#include "base/math.h"

namespace sandlot {

double mass_kg(const model::Model& model) {
  double sum = 0;
  for (const model::Link& link : model.links) sum += link.inertial.mass_kg;
  return sum;
}

Wrench wrench_of(const Pull& pull, BodyId body, const BodyState& state, const model::Link& link,
                 double mass_kg) {
  constexpr double w = 2 * math::pi, most_mps2 = 50;
  const Vec3 arm_W = rotate(state.X_WB.q, pull.point_L);
  const Vec3 v = state.V_WB.linear + cross(state.V_WB.angular, arm_W);
  Vec3 a = (pull.target_W - (state.X_WB.p + arm_W)) * (w * w) - v * (2 * w);
  if (const double size = norm(a); size > most_mps2) a = a * (most_mps2 / size);
  const Vec3 force = a * mass_kg;
  return {body, force, cross(arm_W - rotate(state.X_WB.q, link.inertial.X_LCo.p), force)};
}

}  // namespace sandlot
