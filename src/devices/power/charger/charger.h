#pragma once
/// Charger: gives energy to the batteries of robots within its reach, without wires.
///
/// Reach    batteries whose place on their link is within `reach` of the charger's own place, in any direction and through
///          walls. Those of its own robot take no part.
/// Shares   `power` is what it gives in all: of the batteries in reach that can take something each gets an equal share, and
///          what one cannot take goes to those behind it, in the order in which their robots came into the world.
/// Source   without a battery on its own robot or object: the mains, which never end. With one: from there, power /
///          `transfer_efficiency`; what is drawn in a tick is given in the next one, and what nobody takes then is kept.
/// Command  level `power`: std_msgs/Bool switches it on and off.
/// Output   level `power`: std_msgs/Float64, the power that it gives [W].
/// Time     in every tick, from the places at its beginning.
/// Limits   no contacts, no alignment: everything within reach is charged alike.
/// Cost     in a tick in which a charger is on: a grid of all batteries' places, and a distance per charger and battery near it; no
///          allocation after the first ones.
/// Errors   none beyond the ranges of the keys.
#include <vector>

#include "devices/kind.h"
#include "media/places.h"
#include "messages/messages.h"

namespace sandlot::charger {

struct Spec {
  double power_W = 10, reach_m = 0.5, transfer_efficiency = 1;
  bool on = true;
  double rate_hz = 10;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"power", "W", "Greatest power that it gives in all.", 0, 1e9, Field::tunable}, s.power_W);
    visit(Field{"reach", "m", "Distance up to which batteries are charged.", 0, 1e4, Field::tunable},
          s.reach_m);
    visit(Field{"transfer_efficiency", "1", "Energy given per energy drawn from the charger's own battery.",
                1e-3, 1, Field::tunable},
          s.transfer_efficiency);
    visit(Field{"on", "", "Whether it is on before its first command."}, s.on);
    visit(Field{"rate", "Hz", "Messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct State {
  std::uint64_t taken = 0;
  bool on = true;
  double asked_J = 0, held_J = 0, power_given_W = 0, given_J = 0;
  std::uint32_t batteries = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen."}, s.taken);
    visit(Field{"on_now", "", "Whether it is on."}, s.on);
    visit(Field{"asked", "J", "Energy asked of its own battery in the latest tick."}, s.asked_J);
    visit(Field{"held", "J", "Energy drawn from its own battery and not given yet."}, s.held_J);
    visit(Field{"power_given", "W", "Power given in the latest tick."}, s.power_given_W);
    visit(Field{"given", "J", "Energy given so far."}, s.given_J);
    visit(Field{"batteries", "1", "Number of batteries in reach."}, s.batteries);
  }
};

struct Charger {
  using Spec = charger::Spec;
  using State = charger::State;
  Spec spec;
  State state;

  BodyId body;
  Vec3 p_LS;
  EnergyMeter* energy = nullptr;
  Topic<msg::Float64>* power = nullptr;
  Topic<msg::Bool>* command = nullptr;
  /// Places of all batteries in this tick. Scratch: that of the first charger of the pool serves all.
  struct Batteries {
    std::vector<std::uint32_t> bodies;
    std::vector<BodyState> states;
    media::Places places;
    std::vector<std::uint32_t> found;

    void locate(const Context& context);
  };
  Batteries batteries;
  std::vector<EnergyAccount*> near;  ///< scratch

  static Result<Charger> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Charger> pool, const Context& context);
  static void sense(PoolView<Charger> pool, const Context& context);
  bool fits() const;

 private:
  void find_near(const Context& context, Batteries& of_all);
  double give(double available_J, double dt_s);
  void work(const Context& context, Batteries& of_all);
};

extern const Kind kind;

}  // namespace sandlot::charger
