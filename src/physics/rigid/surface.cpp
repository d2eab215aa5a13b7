#include "physics/rigid/surface.h"

#include <algorithm>

namespace sandlot::rigid {
namespace {

bool is_directed(const model::Surface& s) { return dot(s.fdir1, s.fdir1) > 0; }
/// Without a direction of its own a surface is isotropic: mu and slip1 hold both ways.
double mu2(const model::Surface& s) { return is_directed(s) ? s.mu2 : s.mu; }
double slip2(const model::Surface& s) { return is_directed(s) ? s.slip2 : s.slip1; }

}  // namespace

SurfacePair combine(const model::Surface& a, const model::Surface& b, double world_cfm, bool slippery) {
  SurfacePair pair;
  dSurfaceParameters& p = pair.parameters;
  p.mode = dContactFDir1 | dContactApprox1;
  if (!slippery) {
    p.mu = std::min(a.mu, b.mu);
    p.mu2 = std::min(mu2(a), mu2(b));
  }
  if (p.mu2 != p.mu) p.mode |= dContactMu2 | dContactAxisDep;
  if (is_directed(a) || is_directed(b)) {
    // Where both have a direction, the more slippery surface decides: it gives way first.
    const bool a_decides = is_directed(a) &&
                           (!is_directed(b) || std::min(a.mu, a.mu2) <= std::min(b.mu, b.mu2));
    pair.directed = a_decides ? &a : &b;
  }
  if (const double slip = a.slip1 + b.slip1; slip > 0) p.mode |= dContactSlip1, p.slip1 = slip + world_cfm;
  if (const double slip = slip2(a) + slip2(b); slip > 0) p.mode |= dContactSlip2, p.slip2 = slip + world_cfm;
  const model::Surface& bouncer = b.restitution > a.restitution ? b : a;
  if (bouncer.restitution > 0) {
    p.mode |= dContactBounce;
    p.bounce = bouncer.restitution;
    p.bounce_vel = bouncer.restitution_threshold_mps;
  }
  if (a.soft_erp || b.soft_erp) {
    p.mode |= dContactSoftERP;
    p.soft_erp = a.soft_erp && b.soft_erp ? std::min(*a.soft_erp, *b.soft_erp)
                 : a.soft_erp             ? *a.soft_erp
                                          : *b.soft_erp;
  }
  if (a.soft_cfm || b.soft_cfm) {
    p.mode |= dContactSoftCFM;
    p.soft_cfm = a.soft_cfm.value_or(0) + b.soft_cfm.value_or(0);
  }
  return pair;
}

}  // namespace sandlot::rigid
