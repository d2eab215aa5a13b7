#include "physics/rigid/surface.h"

namespace sandlot::rigid {

dSurfaceParameters parameters_of(const PairSurface& pair, double h, double world_cfm, bool slippery) {
  dSurfaceParameters p{};
  p.mode = dContactFDir1 | dContactApprox1;
  if (!slippery) {
    p.mu = pair.mu;
    p.mu2 = pair.mu2;
  }
  if (p.mu2 != p.mu) p.mode |= dContactMu2 | dContactAxisDep;
  if (pair.slip1 > 0) p.mode |= dContactSlip1, p.slip1 = pair.slip1 + world_cfm;
  if (pair.slip2 > 0) p.mode |= dContactSlip2, p.slip2 = pair.slip2 + world_cfm;
  if (pair.restitution > 0) {
    p.mode |= dContactBounce;
    p.bounce = pair.restitution;
    p.bounce_vel = pair.restitution_threshold_mps;
  }
  if (pair.stiffness_N_per_m) {
    const double kp = *pair.stiffness_N_per_m, kd = pair.damping_N_s_per_m.value_or(0);
    p.mode |= dContactSoftERP | dContactSoftCFM;
    p.soft_erp = h * kp / (h * kp + kd);
    p.soft_cfm = 1 / (h * kp + kd);
  } else {
    if (pair.soft_erp) p.mode |= dContactSoftERP, p.soft_erp = *pair.soft_erp;
    if (pair.soft_cfm) p.mode |= dContactSoftCFM, p.soft_cfm = *pair.soft_cfm;
  }
  if (pair.rolling_resistance_m > 0 && !slippery) {
    p.mode |= dContactRolling | dContactMu2 | dContactAxisDep;
    p.rho = p.rho2 = pair.rolling_resistance_m;
    p.rhoN = -1;  // none; of 0 ODE makes an empty row
  }
  return p;
}

}  // namespace sandlot::rigid
