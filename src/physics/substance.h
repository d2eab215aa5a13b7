#pragma once
/// Contact of two substances, after LpzRobots.
///
///   mu        = r1 r2                                roughness r
///   slip      = s1 + s2                              slip s, [m/(s N)] per contact point
///   stiffness = 100 h1 h2 / (h1 + h2)                hardness h; [N/m] per contact point
///   damping   =  50 ((1 - e1) h2 + (1 - e2) h1) / (h1 + h2)      elasticity e; [N s/m] per contact point
///
/// The description has the law without the factors 100 and 50; LpzRobots' code has them, and without them a
/// robot of 1 kg on plastic would stand half a metre deep in the ground. They are the ones that its
/// experiments ran with.
///
/// A contact point is a spring with a damper, so a ball of mass m rests m g / stiffness deep. For engines
/// that think in a share of the error corrected per step (ERP) and a compliance (CFM), a step of h is
///
///   ERP = h stiffness / (h stiffness + damping),   CFM = 1 / (h stiffness + damping)
///
/// which is the spring integrated implicitly: stable at any step, and the more damped the longer the step.
/// The height of a bounce follows from its mass, the stiffness and the damping: elasticity is not a
/// coefficient of restitution.
///
/// Source   G. Martius (2010), eq. 2.2, 2.3; the factors: LpzRobots, ode_robots.
#include "model/substance.h"

namespace sandlot {

struct SubstancePair {
  double mu, slip, stiffness_N_per_m, damping_N_s_per_m;
};

inline SubstancePair combine(const model::Substance& a, const model::Substance& b) {
  constexpr double stiffness_N_per_m = 100, damping_N_s_per_m = 50;  // of hardness 1
  const double hardness = a.hardness + b.hardness;
  return {a.roughness * b.roughness, a.slip + b.slip, stiffness_N_per_m * a.hardness * b.hardness / hardness,
          damping_N_s_per_m * ((1 - a.elasticity) * b.hardness + (1 - b.elasticity) * a.hardness) / hardness};
}

}  // namespace sandlot
