// What the ground does to bodies that stand on it otherwise than on wheels.
//
// Friction of a patch with even pressure on its supports: F = mu N against the sliding of the centre of mass, and
// T = mu N times the mean distance of the patch from it against turning, bound together by the ellipsoid
// (F / F_max)^2 + (T / T_max)^2 <= 1, with the sliding along its normal (S. Goyal, A. Ruina, J. Papadopoulos, Planar sliding
// with dry friction, 1991; the ellipsoid after I. Kao, M. Cutkosky, 1992). Each step solves it for the velocities it ends
// with, so what comes to rest stays at rest. Exact for pure sliding and pure turning; between them the ellipsoid is off
// by at most 10 % for a disc.
#include <algorithm>
#include <cmath>

#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

const model::Surface default_floor;

}  // namespace

/// The highest floor at or below a body at this place.
const model::Surface& PlanarEngine::floor_under(std::uint32_t k, Vec2 at_W) const {
  const double bottom = instances_[lumps_[k].slot].plan->bottom_m + spec_.clearance_m;
  const Floor* best = nullptr;
  for (const Floor& floor : floors_) {
    if (floor.z_m > bottom || (best && floor.z_m < best->z_m)) continue;
    if (floor.wall != none && nearest(map_.walls()[floor.wall].outline, map_.edges(), at_W).distance_m > 0)
      continue;
    best = &floor;
  }
  return best ? *best->surface : default_floor;
}

void PlanarEngine::find_ground(std::uint32_t k) {
  const Lump& lump = lumps_[k];
  Instance& instance = instances_[lump.slot];
  const LumpPlan& plan = instance.plan->lumps[lump.index];
  Rubbing& rubbing = rubbing_[k];
  rubbing.force_N = rubbing.torque_Nm = 0;
  const auto floor_at = [&](Vec2 at) -> const model::Surface& {
    return floor_under(k, low_floors_ ? lump.p + rotate(lump.heading, at) : lump.p);
  };
  bool wheeled = false;
  std::size_t caster = 0;
  for (Wheel& wheel : instance.wheels) {
    if (wheel.lump != k) continue;
    wheeled = true;
    double weight_kg;
    const model::Surface* surface;
    if (wheel.plan) {
      weight_kg = wheel.plan->weight_kg;
      surface = wheel.plan->surface;
    } else {
      while (!(plan.supports[caster].surface->mu > 0)) ++caster;
      weight_kg = plan.supports[caster].weight_kg;
      surface = plan.supports[caster++].surface;
    }
    wheel.limit_N = std::min(surface->mu, floor_at(wheel.at).mu) * weight_kg * gravity_mps2_;
  }
  if (wheeled) return;
  for (const Support& s : plan.supports) {
    const model::Surface& floor = floor_at(s.at);
    const double weight_N = s.weight_kg * gravity_mps2_;
    if (plan.rolls) {
      // The torque of rolling resistance slows a homogeneous ball, of which 2/7 of the energy is in its spin.
      rubbing.force_N = (s.surface->rolling_resistance_m + floor.rolling_resistance_m) * weight_N /
                        (1.4 * s.ball_radius_m);
      return;
    }
    const double mu = std::min(s.surface->mu, floor.mu);
    rubbing.force_N += mu * weight_N;
    rubbing.torque_Nm += mu * weight_N * s.mean_distance_m;
  }
}

void PlanarEngine::rub(std::uint32_t k, double h_s) {
  Rubbing& r = rubbing_[k];
  Lump& lump = lumps_[k];
  if (!(r.force_N > 0) || (drives_[lump.slot].active && lump.index == 0)) return;
  // Without what friction has given so far in this step.
  Vec2 v = lump.v - lump.inverse_kg * r.impulse;
  double w = lump.w_radps - lump.inverse_kgm2 * r.twist;
  const double F = h_s * r.force_N, T = h_s * r.torque_Nm;
  const double stop_v2 = dot(v, v) / (lump.inverse_kg * lump.inverse_kg * F * F);
  const double stop_w = T > 0 ? w / (lump.inverse_kgm2 * T) : 0;
  if (stop_v2 + stop_w * stop_w <= 1) {
    lump.v = {};
    if (T > 0) lump.w_radps = w = 0;
    else lump.w_radps = w;
  } else {
    // P = -x F^2 v', L = -x T^2 w' with v' = v + P / m, w' = w + L / I: find x so that the ellipsoid holds. The left side
    // below grows with x and bends down, so Newton's steps from 0 never pass the root.
    const double fm = F * F * lump.inverse_kg, ti = T * T * lump.inverse_kgm2;
    const double a = F * F * dot(v, v), b = T * T * w * w;
    double x = 0;
    for (int i = 0; i < 50; ++i) {
      const double p = 1 / (1 + x * fm), q = 1 / (1 + x * ti);
      const double value = std::sqrt(x * x * (a * p * p + b * q * q));
      const double slope = value > 0 ? x * (a * p * p * p + b * q * q * q) / value : std::sqrt(a + b);
      const double step = (1 - value) / slope;
      x += step;
      if (!(step > 1e-14 * x)) break;
    }
    lump.v = (1 / (1 + x * fm)) * v;
    lump.w_radps = w / (1 + x * ti);
  }
  const Vec2 impulse = lump.inverse_kg > 0 ? (1 / lump.inverse_kg) * (lump.v - v) : Vec2{};
  r.impulse = impulse;
  r.twist = lump.inverse_kgm2 > 0 && T > 0 ? (lump.w_radps - w) / lump.inverse_kgm2 : 0;
}

}  // namespace sandlot::planar
