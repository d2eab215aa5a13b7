/// Energy of devices: accounts of robots with a battery, meters, what is drawn and paid in a tick.
#include <algorithm>
#include <cmath>

#include "sim/world/device_pools.h"
#include "sim/world/faults.h"

namespace sandlot {

Status DevicePools::open_account(Entity& entity, const Engine& engine) {
  const model::DeviceDecl* battery = nullptr;
  for (const model::DeviceDecl& decl : std::as_const(entity.instance.devices)) {
    const Kind* const kind = find_kind(decl.kind);
    if (!kind || !kind->stores_energy) continue;
    if (battery)
      return Error{"robot '" + entity.instance.name + "' has two batteries, '" + battery->name + "' and '" +
                       decl.name + "'",
                   "keep one, with the capacity of both", decl.place};
    battery = &decl;
  }
  if (!battery) return {};
  entity.energy = EnergyLedger::open(*entity.instance.model, engine.bodies(entity.id));
  ledger_.add(*entity.energy);
  return {};
}

std::unique_ptr<EnergyMeter> DevicePools::meter_of(Entity& entity, const Kind& kind) {
  auto meter = std::make_unique<EnergyMeter>();
  meter->account = entity.energy.get();
  const bool commanded = std::any_of(kind.levels.begin(), kind.levels.end(),
                                     [](const LevelInfo& level) { return *level.command != '\0'; });
  meter->uses_by_commands = commanded;
  meter->uses_by_samples = !commanded && (kind.phases & phase_sense) != 0;
  return meter;
}

/// False: the bytes are no state of a meter.
bool DevicePools::load_meter(EnergyMeter& meter, ByteReader& r) {
  EnergyMeter::State& state = meter.state;
  read(r, state);
  constexpr double most_J = 1e18;
  const auto within = [](double number, double least, double most) {
    return number >= least && number <= most;
  };
  return r.ok() && within(state.drawn_J, -most_J, most_J) && within(state.missing_J, 0, most_J) &&
         within(state.pending_J, -most_J, most_J) && within(state.share, 0, 1);
}

/// What devices draw all the time, for the tick that begins.
void DevicePools::drain(const Context& context) {
  ledger_.begin_tick();
  const Time begin = context.now - context.tick;
  for (const Pool& pool : pools_) {
    if (pool.metered == 0) continue;
    for (Device* const device : pool.devices)
      if (device->energy && device->energy->rates.drain_W > 0 &&
          !(device->faults && device->faults->at(begin).dead))
        device->energy->draw(device->energy->rates.drain_W * context.tick.s());
  }
}

/// Draws for the samples that are due, and has the batteries pay for the tick. @pre what is due has been found
void DevicePools::settle(const Context& context) {
  for (const Pool& pool : pools_) {
    if (pool.metered == 0 || !(pool.kind->phases & phase_sense)) continue;
    for (const std::uint32_t index : pool.due) {
      Device& device = *pool.devices[index];
      if (device.energy && device.energy->uses_by_samples && device.energy->rates.per_use_J > 0 &&
          !(device.faults && device.faults->at(context.now).dead))
        device.energy->draw(device.energy->rates.per_use_J);
    }
  }
  ledger_.after_physics(context.engine, context.tick.s(), norm(setup_.gravity));
  for (const Pool& pool : pools_)
    if ((pool.kind->phases & phase_settle) && !pool.devices.empty())
      pool.pool->settle(context, {pool.all, pool.sample, pool.levels, pool.since});
}

}  // namespace sandlot
