/// Devices in their pools: State as bytes.
#include <algorithm>
#include <cstring>

#include "sim/world/device_keys.h"
#include "sim/world/device_pools.h"

namespace sandlot {

namespace {

constexpr std::uint8_t is_requested = 1, has_late = 2;

bool has_late_level(const SimulationParts::Slot& slot) { return slot.level == late_level; }

/// Whether a topic or command that is State from its first message on has had one.
bool has_late_messages(const SimulationParts::Device& device) {
  const auto had = [](const SimulationParts::Slot& slot) {
    return has_late_level(slot) && slot.topic->count > 0;
  };
  return std::any_of(device.topics.begin(), device.topics.end(), had) ||
         std::any_of(device.commands.begin(), device.commands.end(), had);
}

}  // namespace

void DevicePools::save(const Device& device, ByteWriter& w) const {
  const Timing& when = timing(device);
  write(w, device.levels);
  write(w, when.start);
  write(w, when.sample);
  write(w, when.last);
  const bool late = has_late_messages(device);
  write(w, static_cast<std::uint8_t>((when.requested ? is_requested : 0) | (late ? has_late : 0)));
  for (const auto* const slots : {&device.topics, &device.commands})
    for (const Slot& slot : *slots)
      if (late || !has_late_level(slot)) slot.topic->save(w);
  if (device.inbox()) device.inbox()->save(w);
  if (device.energy) write(w, device.energy->state);
  if (device.light()) device.light()->save(w);
  if (device.keys) {
    const std::size_t at = w.size();
    write(w, std::uint64_t{0});
    device.keys->save(device, w);
    const std::uint64_t size = w.size() - at - 8;
    w.patch(at, size);
  }
  pools_[device.kind].pool->save(device.index, w);
}

void DevicePools::load(Device& device, ByteReader& r, Time now) {
  Timing& when = pools_[device.kind].timing[device.index];
  std::uint32_t levels = 0;
  read(r, levels);
  // Kinds look for their active levels without asking whether there are any.
  const std::size_t known = std::max<std::size_t>(pools_[device.kind].kind->levels.size(), 1);
  if (levels == 0 || (known < 32 && levels >> known != 0)) return r.fail();
  set_active_levels(device, levels);
  read(r, when.start);
  read(r, when.sample);
  read(r, when.last);
  std::uint8_t flags = 0;
  read(r, flags);
  if (flags > (is_requested | has_late)) return r.fail();
  when.requested = flags & is_requested;
  const bool late = flags & has_late;
  // Due times are computed from these: what cannot be would overflow.
  constexpr std::uint64_t most_samples = std::uint64_t{1} << 53;
  if (when.start < Time{} || when.start > now || when.last < Time{} || when.last > now ||
      when.sample > most_samples)
    return r.fail();
  for (Slot& slot : device.topics)
    if (late || !has_late_level(slot)) slot.topic->load(r);
  for (Slot& slot : device.commands) {
    if (late || !has_late_level(slot)) slot.topic->load(r);
    // What assign() refuses does not come in by another door.
    if (r.ok() && !check_command(slot.topic->info(), slot.topic->data())) return r.fail();
  }
  if (device.inbox()) device.inbox()->load(r);
  if (device.energy && !load_meter(*device.energy, r)) return r.fail();
  if (device.light()) device.light()->load(r);
  PoolBase& pool = *pools_[device.kind].pool;
  if (!device.keys) {
    pool.load(device.index, r);
  } else {
    // The state of the kind first: whether it can go on with a message on its way depends on it.
    std::uint64_t size = 0;
    read(r, size);
    ByteReader common(r.take(size));
    pool.load(device.index, r);
    const auto fits = [&] { return pool.fits(device.index); };
    if (!r.ok() || !device.keys->load(device, common, now, fits) || common.remaining() != 0) r.fail();
    note_keys(device);
  }
  if (r.ok()) plan_next_sample(device);
}

}  // namespace sandlot
