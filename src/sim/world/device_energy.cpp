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
  const bool commanded = std::any_of(kind.levels.begin(), kind.levels.end(),
                                     [](const LevelInfo& level) { return *level.command != '\0'; });
  const bool sampled = !commanded && (kind.phases & phase_sense) != 0;
  return std::make_unique<EnergyMeter>(entity.energy.get(), commanded ? EnergyMeter::Use::commands
                                                            : sampled ? EnergyMeter::Use::samples
                                                                      : EnergyMeter::Use::nothing);
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
  const Time begin = context.now - context.tick;
  for (const Pool& pool : pools_) {
    if (pool.metered == 0 || pool.faulty == 0) continue;
    for (Device* const device : pool.devices)
      if (device->energy && device->faults) device->energy->set_dead(device->faults->at(begin).dead);
  }
  ledger_.begin_tick(context.tick.s());
}

/// Draws for the samples that are due, and has the batteries pay for the tick. @pre what is due has been found
void DevicePools::settle(const Context& context) {
  for (const Pool& pool : pools_) {
    if (pool.metered == 0 || !(pool.kind->phases & phase_sense)) continue;
    for (const std::uint32_t index : pool.due) {
      EnergyMeter* const meter = pool.meters[index];
      if (!meter || meter->use() != EnergyMeter::Use::samples) continue;
      if (pool.faulty > 0)
        if (const auto& faults = pool.devices[index]->faults; faults && faults->at(context.now).dead)
          continue;
      meter->draw_for_use();
    }
  }
  ledger_.after_physics(context.engine, context.tick.s(), norm(setup_.gravity));
  for (const Pool& pool : pools_)
    if ((pool.kind->phases & phase_settle) && !pool.devices.empty())
      pool.pool->settle(context, {pool.all, pool.sample, pool.levels, pool.since});
}

}  // namespace sandlot
