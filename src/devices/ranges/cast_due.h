#pragma once
/// Casting of the fans of rays that are due, in batches on all threads; for devices with one fan per sample.
#include <algorithm>
#include <array>
#include <cstddef>

#include "devices/kind.h"
#include "physics/parallel.h"

namespace sandlot {

/// For each device that is due: casts what `distances_of(device)` has room for along its `directions_S`, from
/// its place on its link, up to its `max_range_m`; then calls `finish(device, sample, since, context)`, on
/// any thread, each device once. The link that carries the device is not seen. No allocation of its own.
template <class Device, class DistancesOf, class Finish>
void cast_due(PoolView<Device> pool, const Context& context, const DistancesOf& distances_of,
              const Finish& finish) {
  const auto states = context.engine.states();
  // Several devices per batch, so that a caster may sort rays of neighbours; few enough to stay on the stack.
  constexpr std::size_t batch = 16;
  parallel_for(pool.due.size(), batch, [&](std::size_t begin, std::size_t end) {
    std::array<RayJob, batch> jobs;
    while (begin < end) {
      const std::size_t count = std::min(batch, end - begin);
      for (std::size_t i = 0; i < count; ++i) {
        Device& device = pool.all[pool.due[begin + i]];
        jobs[i] = {.X_WS = states[device.body].X_WB * device.X_LS,
                   .directions = device.directions_S,
                   .min_m = 0,
                   .max_m = device.spec.max_range_m,
                   .ignore_body = device.body,
                   .distance_m = distances_of(device)};
      }
      context.rays.cast({jobs.data(), count});
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t index = pool.due[begin + i];
        finish(pool.all[index], pool.sample[index], pool.since[index], context);
      }
      begin += count;
    }
  });
}

}  // namespace sandlot
