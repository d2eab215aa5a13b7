#pragma once
/// Energy: what the devices of a robot draw from its battery.
///
/// Every device of a robot with a battery has a meter, DeviceBuild::energy; null: the robot has none, and there is nothing to
/// count. A device that knows what it consumes keeps the pointer, which lives as long as the device, and draws in any phase:
///
///   if (energy) energy->draw(static_cast<double>(bits) * spec.energy_per_bit_J);    // [J]; below 0: it gives back
///
/// The keys `drain` and `drain_per_use` of every device are counted by the simulation. A device that moves its robot without
/// an electrical model leaves its mechanical work to be counted: when it is built it says so (can_ride(), can_turn()), then in
/// actuate of each tick calls ride() (on rails) or turn_joints() (by its motors).
///
///   rails    F = m min(|v* - v| / dt, a_max), M = J min(|w* - w| / dt, alpha_max) with the velocity v, w of the base at the
///            beginning of the tick, its target v*, w*, the whole robot's mass m and moment of inertia J about the vertical
///            through the base's origin; P = F . v_mean + M w_mean + c m g |v_mean|, c: `rolling_resistance`
///   joints   P = sum of max(0, effort x speed), in each sub-step
///   drawn    max(0, P) / `efficiency`; nothing comes back
///
/// Time     what is drawn in a tick until the end of its physics is paid at the end of that tick, before the sensors; what is
///          drawn while sensing, with the next tick.
/// Short    an empty battery, or one that cannot deliver so much power, pays a part of each draw, the same of all; the rest is
///          counted as missing. Devices need not know.
/// Limits   rails: coupling of turning and moving by a centre of mass off the base's origin; what others push.
/// Cost     a few additions per meter and tick, over all threads; nothing for robots without a battery. No allocation in a tick.
#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/fields.h"
#include "base/prefetch.h"
#include "geometry/pose.h"
#include "model/model.h"
#include "physics/engine.h"

namespace sandlot {

struct EnergyAccount;

/// What a device has drawn from the battery of its robot. What every tick reads lies on its first cache line, what rails need on
/// its second.
class alignas(64) EnergyMeter {
 public:
  struct State {
    double drawn_J = 0, missing_J = 0, pending_J = 0, share = 1;

    static void fields(auto& s, auto&& visit) {
      visit(Field{"drawn", "J", "Energy drawn from the battery so far, less what was given back."},
            s.drawn_J);
      visit(Field{"missing", "J", "Energy that the battery could not deliver."}, s.missing_J);
      visit(Field{"pending", "J", "Energy drawn while sensing, to be paid with the next tick."}, s.pending_J);
      visit(Field{"share", "1", "Share of what was drawn in the latest tick that was delivered."}, s.share);
    }
  };
  /// From the common keys of devices.
  struct Rates {
    double drain_W = 0, per_use_J = 0, efficiency = 1, rolling_resistance = 0;

    static void fields(auto& s, auto&& visit) {
      constexpr unsigned saved_with_meter = Field::tunable | Field::apart;
      visit(Field{"drain", "W", "Power drawn from the battery of the robot all the time.", 0, 1e9,
                  saved_with_meter},
            s.drain_W);
      visit(Field{"drain_per_use", "J", "Energy drawn from the battery per command or sample taken.", 0, 1e9,
                  saved_with_meter},
            s.per_use_J);
      visit(Field{"efficiency", "1",
                  "Mechanical work per energy drawn, of drives and motors without a model of the current.",
                  1e-3, 1, saved_with_meter},
            s.efficiency);
      visit(Field{"rolling_resistance", "1", "Rolling resistance of an ideal drive: force per weight.", 0,
                  100, saved_with_meter},
            s.rolling_resistance);
    }
  };

  /// What `drain_per_use` counts.
  enum class Use : std::uint8_t { nothing, commands, samples };

  explicit EnergyMeter(EnergyAccount* account = nullptr, Use use = Use::nothing)
      : account_(account), use_(use) {}

  /// Draws energy [J]; below 0: gives back.
  void draw(double energy_J) { state.pending_J += energy_J; }
  void draw_for_use() { draw(per_use_J_); }
  /// In actuate: the device moves its robot on rails in this tick.
  void ride(const DriveTarget& target) { rails_ = target; }
  /// In actuate: the motors of its joints work in this tick, as the engine computes it.
  void turn_joints() { turning_ = true; }
  /// In create: what the device will call. Motors are added up.
  void can_ride() { rides_ = true; }
  void can_turn(JointId joint) { joints_.push_back(joint); }
  bool rides() const { return rides_; }
  /// Whether it does mechanical work.
  bool moves() const { return rides_ || !joints_.empty(); }

  EnergyAccount* account() const { return account_; }
  Use use() const { return use_; }
  const Rates& rates() const { return rates_; }
  void set_rates(const Rates& rates) {
    rates_ = rates;
    per_use_J_ = rates.per_use_J;
    efficiency_ = rates.efficiency;
    rolling_resistance_ = rates.rolling_resistance;
    set_dead(false);
  }
  /// A dead device drains nothing. Said again in each tick of those that may fail.
  void set_dead(bool dead) { drain_W_ = dead ? 0 : rates_.drain_W; }

  State state;

 private:
  friend class EnergyLedger;
  void draw_work(double work_J) {
    if (work_J > 0) draw(work_J / efficiency_);
  }

  double drain_W_ = 0, per_use_J_ = 0;
  EnergyAccount* account_;
  Use use_;
  bool rides_ = false, turning_ = false;
  DriveTarget rails_{.active = false};
  double efficiency_ = 1, rolling_resistance_ = 0;
  Rates rates_;
  std::vector<JointId> joints_;  ///< whose motors it has
};

/// Account of a robot with a battery.
struct alignas(64) EnergyAccount {
  std::vector<EnergyMeter*> meters;  ///< in the order of the robot's devices
  /// From chargers, in this tick. @pre within room()
  double offered_J = 0;
  // Shown by the battery, after each tick:
  double energy_J = 0, fraction = 0;
  double room_J = 0, max_charge_W = 0;  ///< what it can take
  bool empty = false;
  BodyId body;
  Vec3 p_LS;  ///< place of the battery on its link

  BodyId base;
  double mass_kg = 0, inertia_kgm2 = 0;  ///< of the whole robot; about the vertical through the base's origin

  double room(double dt_s) const {
    const double most = std::min(room_J, max_charge_W * dt_s) - offered_J;
    return most > 0 ? most : 0;
  }

  /// What is to be paid now.
  struct Bill {
    double drawn_J = 0, given_J = 0;  ///< both >= 0
  };
  Bill bill() const;
  /// Pays the bill: these shares of it.
  void settle(double drawn_share, double given_share);
  /// Asks for the memory of the account that is served `by` accounts later: the nearer, the farther along the pointers.
  void expect(std::size_t by) const {
    if (by == 1)
      for (const EnergyMeter* const meter : meters) prefetch(&meter->state, 1);
    else if (by == 2) prefetch(meters.data(), meters.size());
    else prefetch(this, 1);
  }
};

/// The accounts of a world, and the mechanical work of drives and joint motors.
class EnergyLedger {
 public:
  std::span<EnergyAccount* const> accounts() const { return accounts_; }
  bool empty() const { return accounts_.empty(); }

  // For the simulation:
  /// @param model  with the masses of the devices
  static std::unique_ptr<EnergyAccount> open(const model::Model& model, std::span<const BodyId> bodies);
  void add(EnergyAccount& account) { accounts_.push_back(&account); }
  void remove(const EnergyAccount* account) { std::erase(accounts_, account); }
  /// A device that is complete, and one that goes.
  void add(EnergyMeter& meter);
  void remove(const EnergyMeter& meter);
  void begin_tick(double tick_s);            ///< before the actuators act: what devices draw all the time
  void begin_physics(const Engine& engine);  ///< after they have
  void after_substep(const Engine& engine, double h_s);                          ///< work of joints
  void after_physics(const Engine& engine, double tick_s, double gravity_mps2);  ///< work of rails

 private:
  /// Of a base, in its own frame.
  struct PlanarVelocity {
    double x_mps = 0, y_mps = 0, turn_radps = 0;
  };
  /// Calls take(i, velocity of the i-th rider's base).
  template <class Take>
  void visit_velocities(const Engine& engine, std::size_t begin, std::size_t end, Take&& take) const;

  std::vector<EnergyAccount*> accounts_;
  std::vector<EnergyMeter*> movers_;            ///< of devices that do mechanical work
  std::vector<EnergyMeter*> riders_, turners_;  ///< those that do in this tick
  std::vector<std::uint32_t> bodies_;           ///< bases of the riders
  std::vector<PlanarVelocity> before_;
};

}  // namespace sandlot
