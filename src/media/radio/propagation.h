#pragma once
/// Propagation: which radios a transmission reaches, and with what power.
///
///   range          received = sent - obstacles, up to `range`
///   log_distance   received = sent - PL(d0) - 10 n log10(d / d0) - X - Y - obstacles;  nearer than d0 the loss stays PL(d0)
///
/// X is the shadowing: normal, drawn once per pair of radios from the two keys, the same both ways and for the whole run,
/// wherever they go. Y is the fading: normal, drawn for each packet and receiver. Both are cut off at three deviations.
/// Obstacles: each body that stands in the straight line counts once, up to 8; those of the sender's and the receiver's own
/// robots do not.
///
/// Limits   no antenna pattern, no reflection, no diffraction; a body's thickness does not count; shadowing does not change
///          with the place.
/// Source   T. S. Rappaport, Wireless Communications, 2nd ed. (2002), sec. 4.9: log-distance path loss, log-normal shadowing.
/// Cost     a grid finds those in reach; rays only where obstacles have a loss: one per radio in reach and one per surface met.
#include <cstdint>
#include <vector>

#include "media/medium.h"
#include "media/places.h"
#include "media/radio/spec.h"

namespace sandlot::media::radio {

/// Whom a transmission reaches. Kept for its memory.
struct Reached {
  std::vector<Places::Near> near;        ///< memory of find_within()
  std::vector<std::uint32_t> receivers;  ///< indices, in any order
  std::vector<double> distances_m;
  std::vector<double> powers_dBm;  ///< as received
  // For the rays.
  std::vector<Vec3> directions;
  std::vector<float> hit_m;
  std::vector<std::uint32_t> hit_bodies;
};

/// A transmission that leaves a radio.
struct Start {
  Time at;
  std::uint32_t sender = 0;  ///< index of its receiver
  std::uint64_t number = 0;  ///< of the packet, in its head
  std::int32_t channel = 0;
  double power_dBm = 0;
};

/// Power below which a signal means nothing to a receiver.
inline double floor_dBm(const Spec& spec) {
  return spec.collisions || spec.access == Access::csma ? std::min(spec.noise_floor_dBm, spec.sensitivity_dBm)
                                                        : spec.sensitivity_dBm;
}

/// Finds whom a transmission reaches. Called in parallel.
void look(const Spec& spec, const Start& start, const Places& places, const MediumContext& context,
          Reached& to);

}  // namespace sandlot::media::radio
