// Friction of the ground on bodies that stand on it otherwise than on wheels.
//
// Friction of a patch with even pressure on its supports: F = mu N against the sliding of the centre of mass,
// and T = mu N times the mean distance of the patch from it against turning, bound together by the ellipsoid
// (F / F_max)^2 + (T / T_max)^2 <= 1, with the sliding along its normal (S. Goyal, A. Ruina, J. Papadopoulos,
// Planar sliding with dry friction, 1991; the ellipsoid after I. Kao, M. Cutkosky, 1992). Each step solves it
// for the velocities it ends with, so what comes to rest stays at rest. Exact for pure sliding and pure
// turning; between them the ellipsoid is off by at most 10 % for a disc.
#include <algorithm>
#include <cmath>

#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

const model::Surface default_floor;

}  // namespace

/// The highest floor at or below a body at this place; null: there is none.
const PlanarEngine::Floor* PlanarEngine::floor_under(std::uint32_t k, Vec2 at_W) const {
  const double bottom = instances_[groups_[k].slot].plan->bottom_m + spec_.clearance_m;
  const Floor* best = nullptr;
  for (const Floor& floor : floors_) {
    if (floor.z_m > bottom || (best && floor.z_m < best->z_m)) continue;
    if (floor.wall != none && nearest(map_.walls()[floor.wall].outline, map_.edges(), at_W).distance_m > 0)
      continue;
    best = &floor;
  }
  return best;
}

/// Contact parameters of a foot and the ground at a place of the group's frame; the belt is that of the
/// ground as the foot sees it.
PairSurface PlanarEngine::on_ground(std::uint32_t k, ContactFace foot, Vec2 at) const {
  const RigidGroup& group = groups_[k];
  const Instance& instance = instances_[group.slot];
  foot.slot = group.slot;
  foot.group = &group;
  const Vec2 p = group.p + rotate(group.heading, at);
  const Floor* const floor = floor_under(k, ground_varies_ ? p : group.p);
  const ContactFace ground = floor ? floor->face : ContactFace{.surface = &default_floor};
  const Vec3 point{p.x, p.y, floor ? floor->z_m : instance.plan->bottom_m};
  if (floor && instances_[floor->face.slot].created > instance.created)
    return surfaces_at(foot, ground, point, {0, 0, -1});
  PairSurface pair = surfaces_at(ground, foot, point, {0, 0, 1});
  pair.belt_velocity_W_mps = -pair.belt_velocity_W_mps;
  return pair;
}

void PlanarEngine::find_ground(std::uint32_t k) {
  const RigidGroup& group = groups_[k];
  Instance& instance = instances_[group.slot];
  const RigidGroupPlan& plan = instance.plan->groups[group.index];
  constexpr Vec3 up{0, 0, 1};
  bool wheeled = false;
  std::size_t caster = 0;
  for (Wheel& wheel : instance.wheels) {
    if (wheel.group != k) continue;
    wheeled = true;
    double weight_N;
    ContactFace foot;
    Vec2 ahead{1, 0};
    if (wheel.plan) {
      const WheelPlan& w = *wheel.plan;
      weight_N = w.weight_kg * gravity_mps2_;
      foot = {w.surface, w.collision, group.slot, instance.model->joints[w.joint].child};
      ahead = w.rollers ? w.grip : Vec2{w.axle.y, -w.axle.x};
      if (wheel.steering != none && ground_varies_)
        ahead = rotate(turn_of(w.steering_sign * joint_states_[wheel.steering].position), ahead);
    } else {
      while (!(plan.supports[caster].surface->mu > 0)) ++caster;
      const Support& s = plan.supports[caster++];
      weight_N = s.weight_kg * gravity_mps2_;
      foot = {s.surface, s.collision, group.slot, s.link};
    }
    const PairSurface pair = on_ground(k, foot, wheel.at);
    const Vec2 ahead_W = rotate(group.heading, ahead);
    wheel.limit_N = pair.touches ? weight_N * friction_along(pair, up, {ahead_W.x, ahead_W.y, 0}) : 0;
    wheel.rolling_Nm = pair.touches ? weight_N * pair.rolling_resistance_m : 0;
    wheel.belt_mps = {pair.belt_velocity_W_mps.x, pair.belt_velocity_W_mps.y};
  }
  GroundFriction& friction = ground_friction_[k];
  friction = {.impulse = friction.impulse, .twist = friction.twist};
  if (wheeled) return;
  Vec2 pull;  // of the belts
  for (const Support& s : plan.supports) {
    const PairSurface pair = on_ground(k, {s.surface, s.collision, group.slot, s.link}, s.at);
    if (!pair.touches) continue;
    const double weight_N = s.weight_kg * gravity_mps2_;
    const Vec2 belt{pair.belt_velocity_W_mps.x, pair.belt_velocity_W_mps.y};
    if (plan.rolls) {
      // The torque of rolling resistance slows the ball's way and its spin: rho N / r = (m + I / r^2) a.
      const double inertia = group.rolls ? 1 : 1 + plan.spin();
      friction.force_N = friction.side_N = pair.rolling_resistance_m * weight_N / (s.ball_radius_m * inertia);
      friction.belt_mps = belt;
      return;
    }
    double along = pair.mu, across = pair.mu;
    if (const Vec2 f{pair.fdir1_W.x, pair.fdir1_W.y}; dot(f, f) > 1e-12) {
      friction.along = (1 / std::sqrt(dot(f, f))) * f;
      across = pair.mu2;
    }
    friction.force_N += along * weight_N;
    friction.side_N += across * weight_N;
    const double mean_N = 0.5 * (along + across) * weight_N;
    friction.torque_Nm += mean_N * s.mean_distance_m;
    pull = pull + mean_N * belt;
  }
  if (const double sum = 0.5 * (friction.force_N + friction.side_N); sum > 0)
    friction.belt_mps = (1 / sum) * pull;
}

void PlanarEngine::rub(std::uint32_t k, double h_s) {
  GroundFriction& r = ground_friction_[k];
  RigidGroup& group = groups_[k];
  if (!(r.force_N > 0 || r.side_N > 0) || (drives_[group.slot].active && group.index == 0)) return;
  // Against the ground, without what friction has given so far in this step.
  const Vec2 before = group.v - group.inverse_kg * r.impulse, v = before - r.belt_mps,
             side = left_of(r.along);
  const double w = group.w_radps - group.inverse_kgm2 * r.twist;
  struct Way {
    double speed, limit, inverse_mass;
  } ways[] = {{dot(v, r.along), h_s * r.force_N, group.inverse_kg},
              {dot(v, side), h_s * r.side_N, group.inverse_kg},
              {w, h_s * r.torque_Nm, group.inverse_kgm2}};
  double needed = 0;
  for (const Way& way : ways)
    if (way.limit > 0) {
      const double share = way.speed / (way.inverse_mass * way.limit);
      needed += share * share;
    }
  if (needed <= 1) {
    for (Way& way : ways)
      if (way.limit > 0) way.speed = 0;
  } else {
    // Impulses -x L^2 u' with u' = u + impulse / m, along each way: find x so that the ellipsoid holds. The
    // left side below grows with x and bends down, so Newton's steps from 0 never pass the root.
    double x = 0;
    for (int i = 0; i < 50; ++i) {
      double sum = 0, slower = 0;
      for (const Way& way : ways) {
        const double p = 1 / (1 + x * way.limit * way.limit * way.inverse_mass),
                     f = way.limit * way.speed * p;
        sum += f * f;
        slower += f * f * p;
      }
      const double size = std::sqrt(sum), slope = slower / size, step = (1 - x * size) / slope;
      x += step;
      if (!(step > 1e-14 * x)) break;
    }
    for (Way& way : ways) way.speed /= 1 + x * way.limit * way.limit * way.inverse_mass;
  }
  group.v = r.belt_mps + ways[0].speed * r.along + ways[1].speed * side;
  group.w_radps = ways[2].speed;
  r.impulse = group.inverse_kg > 0 ? (1 / group.inverse_kg) * (group.v - before) : Vec2{};
  r.twist = group.inverse_kgm2 > 0 && r.torque_Nm > 0 ? (group.w_radps - w) / group.inverse_kgm2 : 0;
}

}  // namespace sandlot::planar
