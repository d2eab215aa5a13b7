#include "devices/energy.h"

#include <algorithm>
#include <array>
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
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t by = 1; by <= 3 && i + by < end; ++by) accounts_[i + by]->expect(by);
      for (EnergyMeter* const meter : accounts_[i]->meters) meter->draw(meter->drain_W_ * tick_s);
    }
  });
}

template <class Take>
void EnergyLedger::visit_velocities(const Engine& engine, std::size_t begin, std::size_t end,
                                    Take&& take) const {
  std::array<BodyState, 16> states;  // few at a time: they stay near the processor
  for (std::size_t first = begin; first < end; first += states.size()) {
    const std::size_t count = std::min(states.size(), end - first);
    engine.states_of(std::span(bodies_).subspan(first, count), std::span(states).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      const Quat& q_WB = states[i].X_WB.q;
      const Vec3 v_B = rotate_inverse(q_WB, states[i].V_WB.linear);
      take(first + i, PlanarVelocity{v_B.x, v_B.y, rotate_inverse(q_WB, states[i].V_WB.angular).z});
    }
  }
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
  parallel_for(bodies_.size(), accounts_at_a_time, [&](std::size_t begin, std::size_t end) {
    visit_velocities(engine, begin, end, [&](std::size_t i, PlanarVelocity v_B) { before_[i] = v_B; });
  });
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
  constexpr std::size_t ahead = 4;
  const auto draw_work = [&](std::size_t i, PlanarVelocity b) {
    if (i + ahead < riders_.size()) prefetch(riders_[i + ahead], 1);
    EnergyMeter& meter = *riders_[i];
    const EnergyAccount& account = *meter.account_;
    const DriveTarget& to = meter.rails_;
    const PlanarVelocity a = before_[i];
    const PlanarVelocity mean{0.5 * (a.x_mps + b.x_mps), 0.5 * (a.y_mps + b.y_mps),
                              0.5 * (a.turn_radps + b.turn_radps)};
    const double dx = to.vx_mps - a.x_mps, dy = to.vy_mps - a.y_mps, change = std::sqrt(dx * dx + dy * dy);
    const double most = to.max_accel_mps2 * tick_s;
    const double push = account.mass_kg / tick_s * (change > most ? most / change : 1);  // [N] per m/s
    const double most_turn = to.max_angular_accel_radps2 * tick_s;
    const double twist = account.inertia_kgm2 / tick_s *
                         std::clamp(to.wz_radps - a.turn_radps, -most_turn, most_turn);
    const double speed = std::sqrt(mean.x_mps * mean.x_mps + mean.y_mps * mean.y_mps);
    const double power_W = push * (dx * mean.x_mps + dy * mean.y_mps) + twist * mean.turn_radps +
                           meter.rolling_resistance_ * account.mass_kg * gravity_mps2 * speed;
    meter.draw_work(power_W * tick_s);
  };
  parallel_for(riders_.size(), accounts_at_a_time,
               [&](std::size_t begin, std::size_t end) { visit_velocities(engine, begin, end, draw_work); });
  riders_.clear();
}

}  // namespace sandlot
