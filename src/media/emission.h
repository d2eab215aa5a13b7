#pragma once
/// Something that spreads: sound, light, radio, smell. Devices emit while they act or sense; the media phase
/// delivers what was emitted in this tick, in a stable order.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/time.h"
#include "geometry/rays.h"
#include "physics/engine.h"

namespace sandlot {

struct Emission {
  std::uint64_t medium = 0;   ///< entity_key of the medium's name
  std::uint64_t emitter = 0;  ///< entity_key of the emitting device
  Vec3 point_W;
  double strength = 0;                                ///< in the medium's unit
  std::uint32_t payload_begin = 0, payload_size = 0;  ///< in EmissionBuffer::payload
};

/// Emissions of one tick. Devices emit from sequential phases only, so the order is that of the pools: creation
/// order within a kind, and a robot more does not change the order of the others.
struct EmissionBuffer {
  std::vector<Emission> emissions;
  std::vector<std::byte> payload;
  void emit(Emission e, std::span<const std::byte> bytes) {
    e.payload_begin = static_cast<std::uint32_t>(payload.size());
    e.payload_size = static_cast<std::uint32_t>(bytes.size());
    payload.insert(payload.end(), bytes.begin(), bytes.end());
    emissions.push_back(e);
  }
  void clear() {
    emissions.clear();
    payload.clear();
  }
};

struct MediumContext {
  Time now;
  std::uint64_t tick_index = 0;
  std::uint64_t seed = 0;
  const Engine& engine;
  const RayCaster& rays;
};

/// A medium decides who receives what, when and how attenuated. It keeps what is still under way as State.
class Medium {
 public:
  virtual ~Medium() = default;
  virtual const char* name() const = 0;
  /// @param buffer  all emissions of this tick; the medium takes those with its own key
  virtual void deliver(const EmissionBuffer& buffer, const MediumContext& context) = 0;
  virtual void save(ByteWriter& w) const = 0;
  virtual void load(ByteReader& r) = 0;
};

}  // namespace sandlot
