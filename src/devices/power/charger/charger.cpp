#include "devices/power/charger/charger.h"

#include <algorithm>

namespace sandlot::charger {

Result<Charger> Charger::create(const DeviceBuild& build, Spec spec) {
  Charger charger{spec};
  charger.state.on = spec.on;
  charger.body = build.body();
  charger.p_LS = build.decl.X_LS.p;
  charger.energy = build.energy;
  charger.power = build.publish<msg::Float64>(0, "power");
  charger.command = build.accept<msg::Bool>(0, "power");
  return charger;
}

void Charger::Batteries::locate(const Context& context) {
  if (!context.energy) return;
  const auto accounts = context.energy->accounts();
  bodies.clear();
  for (const EnergyAccount* account : accounts) bodies.push_back(account->body.index);
  states.resize(bodies.size());
  context.engine.states_of(bodies, states);
  places.update(accounts.size(), [&](std::size_t i) -> media::Places::Place {
    return {.p_W = states[i].X_WB * accounts[i]->p_LS};
  });
}

/// Lists the accounts of batteries in reach, in the order in which their robots came into the world.
void Charger::find_near(const Context& context, Batteries& of_all) {
  near.clear();
  if (!context.energy) return;
  const auto accounts = context.energy->accounts();
  BodyState own;
  context.engine.states_of({&body.index, 1}, {&own, 1});
  const Vec3 here = own.X_WB * p_LS;
  // The grid may round otherwise than the distance that decides: 1 mm is far above what it can lose within 1e9 m.
  of_all.places.find_within(here, spec.reach_m + 1e-3, of_all.found);
  for (const std::uint32_t i : of_all.found) {
    EnergyAccount* const account = accounts[i];
    if (energy && account == energy->account()) continue;
    const Vec3 to = of_all.places.point(i) - here;
    if (dot(to, to) <= spec.reach_m * spec.reach_m) near.push_back(account);
  }
}

/// @return what was given
double Charger::give(double available_J, double dt_s) {
  double left_J = available_J;
  auto takers = static_cast<double>(std::count_if(
      near.begin(), near.end(), [&](const EnergyAccount* each) { return each->room(dt_s) > 0; }));
  for (EnergyAccount* account : near) {
    const double room_J = account->room(dt_s);
    if (room_J <= 0) continue;
    const double part_J = std::min(left_J / takers, room_J);
    account->offered_J += part_J;
    left_J -= part_J;
    takers -= 1;
  }
  return available_J - left_J;
}

void Charger::work(const Context& context, Batteries& of_all) {
  const double dt_s = context.tick.s(), most_J = spec.power_W * dt_s;
  state.power_given_W = 0;
  state.batteries = 0;
  // What its battery paid of what was asked for in the tick before.
  if (energy) state.held_J += state.asked_J * energy->state.share * spec.transfer_efficiency;
  state.asked_J = 0;
  if (!state.on) return;
  find_near(context, of_all);
  state.batteries = static_cast<std::uint32_t>(near.size());
  if (near.empty()) return;
  const double given_J = give(energy ? std::min(state.held_J, most_J) : most_J, dt_s);
  state.given_J += given_J;
  state.power_given_W = given_J / dt_s;
  if (!energy) return;
  state.held_J = std::max(0.0, state.held_J - given_J);
  double room_J = 0;
  for (const EnergyAccount* account : near) room_J += account->room(dt_s);
  state.asked_J = std::max(0.0, std::min(most_J, room_J) - state.held_J) / spec.transfer_efficiency;
  energy->draw(state.asked_J);
}

void Charger::actuate(PoolView<Charger> pool, const Context& context) {
  bool any_on = false;
  for (const std::uint32_t index : pool.due) {
    Charger& charger = pool.all[index];
    if (charger.command->count != charger.state.taken) {
      charger.state.taken = charger.command->count;
      charger.state.on = charger.command->message.data;
    }
    any_on = any_on || charger.state.on;
  }
  if (pool.due.empty()) return;
  Batteries& batteries = pool.all.front().batteries;
  if (any_on) batteries.locate(context);
  for (const std::uint32_t index : pool.due) pool.all[index].work(context, batteries);
}

void Charger::sense(PoolView<Charger> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Charger& charger = pool.all[index];
    charger.power->message.data = charger.state.power_given_W;
    charger.power->publish(context.now);
  }
}

bool Charger::fits() const {
  constexpr double most_J = 1e18;
  for (const double number : {state.asked_J, state.held_J, state.power_given_W, state.given_J})
    if (!(number >= 0 && number <= most_J)) return false;
  return true;
}

namespace {
constexpr LevelInfo levels[] = {
    {"power", msg::Float64::ros_type, msg::Bool::ros_type, "Power that it gives; a command switches it."},
};
}  // namespace

constinit const Kind kind = make_kind<Charger>({
    .name = "charger",
    .help = "Charger of the batteries of other robots within its reach.",
    .levels = levels,
});

}  // namespace sandlot::charger
