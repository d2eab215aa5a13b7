#pragma once
/// Kicker: gives the nearest thing in front of it an impulse, as the solenoids of robot soccer do.
///
/// Frame    the device's frame S: it kicks along x, upwards by `elevation`.
/// Command  level `kick`: std_msgs/Float64, the impulse [Ns], at most `max_impulse`; 0 and below: none.
/// Acts     rays leave S's origin within `opening` about x, in S's xy plane, at most 5 degrees apart. The collision of
///          another robot or object that one of them meets first, within `reach`, takes the impulse at the point that is met;
///          of several rays the shortest counts. The kicker's link takes the opposite impulse along the same line. What
///          stands still takes it too: the robot is pushed back.
/// Energy   The store fills linearly in `recharge_time`, first full when the robot comes into the world. A kick of J takes the
///          part (J / max_impulse)^2 of a full store, as the energy of a given mass grows. With less than that in store
///          the kick is weaker: max_impulse * sqrt(charge). A kick into the air takes as much. With `energy` the robot's battery,
///          if it has one, pays what fills the store: it fills by the share that the battery delivered in the tick before.
/// Output   sandlot_msgs/KickerState at `rate`: charge, ready, kicks, hits, impulse and name of what was met.
/// Time     a command acts in the first physics step of its tick: force J / h over that step of h.
/// Noise    none; see the common key command_errors.
/// Limits   the impulse is along the kicker's direction whatever the surface: no friction of a plate, no restitution. What is
///          thinner than the gap between two rays may be missed. A thing that the robot's gripper holds is kicked
///          together with the robot: nothing moves.
/// Cost     nothing but a comparison until a kick; then a query of a ball and a few distances per ray.
/// Errors   an elevation on an engine that is planar.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::kicker {

struct Spec {
  double max_impulse_Ns = 1;
  double reach_m = 0.05;
  double opening_rad = 0;
  double elevation_rad = 0;
  double recharge_time_s = 1;
  double energy_J = 0;
  double rate_hz = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"max_impulse", "Ns", "Largest impulse, of a kick with the full store.", 1e-6, 1e6,
                Field::tunable},
          s.max_impulse_Ns);
    visit(
        Field{"reach", "m", "Largest distance of what is kicked, along the ray.", 1e-4, 1e3, Field::tunable},
        s.reach_m);
    visit(Field{"opening", "rad",
                "Angle in front of the kicker, half to each side, in which it meets something.", 0, 3.1,
                Field::tunable},
          s.opening_rad);
    visit(Field{"elevation", "rad", "Angle of the kick above x.", -1.6, 1.6}, s.elevation_rad);
    visit(Field{"recharge_time", "s", "Time in which the empty store is filled; 0: at once.", 0, 1e6,
                Field::tunable},
          s.recharge_time_s);
    visit(Field{"energy", "J", "Energy of the full store, which the battery of the robot pays; 0: none.", 0,
                1e9, Field::tunable},
          s.energy_J);
    visit(Field{"rate", "Hz", "Messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct State {
  std::uint64_t taken = 0;
  double charge = 1;
  std::uint64_t kicks = 0, hits = 0;
  double impulse_Ns = 0;
  std::string object;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen."}, s.taken);
    visit(Field{"charge", "1", "Energy stored, as a part of a full store.", 0, 1}, s.charge);
    visit(Field{"kicks", "1", "Number of kicks so far."}, s.kicks);
    visit(Field{"hits", "1", "Number of kicks that met something."}, s.hits);
    visit(Field{"impulse", "Ns", "Impulse of the latest kick; 0 where it met nothing."}, s.impulse_Ns);
    visit(Field{"object", "", "Robot or object that the latest kick met; empty: nothing."}, s.object);
  }
};

struct Kicker {
  using Spec = kicker::Spec;
  using State = kicker::State;
  Spec spec;
  State state;

  BodyId body;
  EnergyMeter* energy = nullptr;
  std::string robot;
  Pose X_LS;
  Topic<msg::KickerState>* kick = nullptr;
  Topic<msg::Float64>* command = nullptr;
  /// Impulse for the first sub-step of this tick; never from tick to tick.
  struct Blow {
    BodyId body;
    Vec3 point_W, impulse_W_Ns;
  };
  std::optional<Blow> blow;

  static Result<Kicker> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Kicker> pool, const Context& context);
  static void pre_substep(PoolView<Kicker> pool, const Context& context, double h_s);
  static void sense(PoolView<Kicker> pool, const Context& context);
  bool fits() const { return state.charge >= 0 && state.charge <= 1; }
  void take(double impulse_Ns, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::kicker
