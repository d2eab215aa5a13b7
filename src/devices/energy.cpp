#include "devices/energy.h"

#include <algorithm>
#include <cmath>

#include "physics/parallel.h"

namespace sandlot {
namespace {

/// Moment of inertia of a link about the z axis of B. @param X_BL  of the link
double inertia_about_z(const model::Inertial& inertial, const Pose& X_BL) {
  const Pose X_BC = X_BL * inertial.X_LCo;
  const Vec3 u = rotate_inverse(X_BC.q, {0, 0, 1}), p = X_BC.p;
  const Vec3 &d = inertial.moments, &o = inertial.products;
  const double own = d.x * u.x * u.x + d.y * u.y * u.y + d.z * u.z * u.z +
                     2 * (o.x * u.x * u.y + o.y * u.x * u.z + o.z * u.y * u.z);
  return own + inertial.mass_kg * (p.x * p.x + p.y * p.y);
}

/// Accounts that a thread serves at a time.
constexpr std::size_t accounts_at_a_time = 256;

struct PlanarVelocity {
  double x = 0, y = 0, turn = 0;
};
/// Of a base, in its own frame.
PlanarVelocity in_plane(const BodyState& state) {
  const Vec3 v = rotate_inverse(state.X_WB.q, state.V_WB.linear);
  return {v.x, v.y, rotate_inverse(state.X_WB.q, state.V_WB.angular).z};
}

}  // namespace

EnergyAccount::Bill EnergyAccount::bill() const {
  Bill out;
  for (const EnergyMeter* meter : meters) {
    const double pending = meter->state.pending_J;
    (pending > 0 ? out.drawn_J : out.given_J) += std::abs(pending);
  }
  return out;
}

void EnergyAccount::settle(double drawn_share, double given_share) {
  for (EnergyMeter* meter : meters) {
    EnergyMeter::State& state = meter->state;
    state.share = drawn_share;
    if (state.pending_J > 0) {
      const double paid = drawn_share * state.pending_J;
      state.drawn_J += paid;
      state.missing_J += state.pending_J - paid;
    } else {
      state.drawn_J += given_share * state.pending_J;
    }
    state.pending_J = 0;
  }
  offered_J = 0;
}

std::unique_ptr<EnergyAccount> EnergyLedger::open(const model::Model& model, std::span<const BodyId> bodies) {
  auto account = std::make_unique<EnergyAccount>();
  account->base = bodies.front();
  const Pose X_BM = inverse(model.links.front().X_ML);
  for (const model::Link& link : model.links) {
    account->mass_kg += link.inertial.mass_kg;
    account->inertia_kgm2 += inertia_about_z(link.inertial, X_BM * link.X_ML);
  }
  return account;
}

void EnergyLedger::add(EnergyMeter& meter) {
  meter.account_->meters.push_back(&meter);
  if (meter.moves()) movers_.push_back(&meter);
}

void EnergyLedger::remove(const EnergyMeter& meter) {
  std::erase(meter.account_->meters, &meter);
  std::erase(movers_, &meter);
}

void EnergyLedger::begin_tick(double tick_s) {
  for (EnergyMeter* const meter : movers_) meter->rails_.active = meter->turning_ = false;
  parallel_for(accounts_.size(), accounts_at_a_time, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (EnergyMeter* const meter : accounts_[i]->meters) meter->draw(meter->drain_W_ * tick_s);
  });
}

void EnergyLedger::begin_physics(const Engine& engine) {
  bodies_.clear();
  riders_.clear();
  turners_.clear();
  for (EnergyMeter* const meter : movers_) {
    if (meter->turning_) turners_.push_back(meter);
    if (!meter->rails_.active) continue;
    riders_.push_back(meter);
    bodies_.push_back(meter->account_->base.index);
  }
  before_.resize(bodies_.size());
  if (!bodies_.empty()) engine.states_of(bodies_, before_);
}

void EnergyLedger::after_substep(const Engine& engine, double h_s) {
  if (turners_.empty()) return;
  const auto joints = engine.joint_states();
  for (EnergyMeter* const meter : turners_) {
    double work_J = 0;
    for (const JointId id : meter->joints_) {
      const JointState& joint = joints[id.index];
      work_J += std::max(0.0, joint.effort * joint.velocity * h_s);
    }
    meter->draw_work(work_J);
  }
}

void EnergyLedger::after_physics(const Engine& engine, double tick_s, double gravity_mps2) {
  if (riders_.empty()) return;
  after_.resize(bodies_.size());
  engine.states_of(bodies_, after_);
  const auto draw_work = [&](std::size_t i) {
    EnergyMeter& meter = *riders_[i];
    const EnergyAccount& account = *meter.account_;
    const DriveTarget& to = meter.rails_;
    const PlanarVelocity a = in_plane(before_[i]), b = in_plane(after_[i]);
    const PlanarVelocity mean{0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.turn + b.turn)};
    const double dx = to.vx_mps - a.x, dy = to.vy_mps - a.y, change = std::sqrt(dx * dx + dy * dy);
    const double most = to.max_accel_mps2 * tick_s;
    const double push = account.mass_kg / tick_s * (change > most ? most / change : 1);  // [N] per m/s
    const double most_turn = to.max_angular_accel_radps2 * tick_s;
    const double twist = account.inertia_kgm2 / tick_s *
                         std::clamp(to.wz_radps - a.turn, -most_turn, most_turn);
    const double speed = std::sqrt(mean.x * mean.x + mean.y * mean.y);
    const double power_W = push * (dx * mean.x + dy * mean.y) + twist * mean.turn +
                           meter.rates_.rolling_resistance * account.mass_kg * gravity_mps2 * speed;
    meter.draw_work(power_W * tick_s);
  };
  parallel_for(riders_.size(), accounts_at_a_time, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) draw_work(i);
  });
  riders_.clear();
}

}  // namespace sandlot
