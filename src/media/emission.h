#pragma once
/// Emission: what a device gives to a medium in a tick, such as a spoken word or a radio packet.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/time.h"
#include "geometry/pose.h"
#include "physics/engine.h"

namespace sandlot {

struct Emission {
  std::uint32_t medium = 0;   ///< index in the world's list, see DeviceBuild::medium
  std::uint64_t emitter = 0;  ///< key of the device
  BodyId body;                ///< that carries it
  Time at;                    ///< when it began
  Vec3 point_W;
  Vec3 direction_W;  ///< unit; zero: all round
  std::int32_t channel = 0;
  double strength = 0;                                ///< in the medium's unit
  std::uint32_t payload_begin = 0, payload_size = 0;  ///< in EmissionBuffer::payload
};

/// Emissions of one tick. Devices emit in the actuate and sub-step phases, which are sequential, so the order is that of the
/// pools: creation order within a kind, and one robot more does not change the order of the others.
struct EmissionBuffer {
  std::vector<Emission> emissions;
  std::vector<std::byte> payload;
  void emit(Emission e, std::span<const std::byte> bytes) {
    e.payload_begin = static_cast<std::uint32_t>(payload.size());
    e.payload_size = static_cast<std::uint32_t>(bytes.size());
    payload.insert(payload.end(), bytes.begin(), bytes.end());
    emissions.push_back(e);
  }
  std::span<const std::byte> bytes(const Emission& e) const {
    return std::span(payload).subspan(e.payload_begin, e.payload_size);
  }
  void clear() {
    emissions.clear();
    payload.clear();
  }
};

}  // namespace sandlot
