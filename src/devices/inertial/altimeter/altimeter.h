#pragma once
/// Altimeter: height above where it started, and how fast that changes.
///
/// Frame    the origin of the device's own pose on its link.
/// Output   level `height`: sandlot_msgs/Altimeter. vertical_reference is the height of that point in the
///          world when the device was built, in the declared pose of its model.
/// Time     the end of the tick.
/// Noise    noise/channel_noise.h on position and velocity.
/// Limits   no weather, no delay; for what pressure does see the barometer.
/// Cost     two channels per sample, no allocation.
/// Source   SDF 1.9 <altimeter>.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/channel_noise.h"

namespace sandlot::altimeter {

struct Spec {
  ChannelNoiseSpec position, velocity;
  double rate_hz = 20;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"position", "m", "Errors of the height."}, s.position);
    visit(Field{"velocity", "m/s", "Errors of the vertical velocity."}, s.velocity);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  double reference_m = 0;
  ChannelNoise position, velocity;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"reference", "m", "Height at the start."}, s.reference_m);
    visit(Field{"position", "m", "Errors of the height."}, s.position);
    visit(Field{"velocity", "m/s", "Errors of the vertical velocity."}, s.velocity);
  }
};

struct Altimeter {
  using Spec = altimeter::Spec;
  using State = altimeter::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;
  Vec3 p_LS;
  Topic<msg::Altimeter>* height = nullptr;

  static Result<Altimeter> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Altimeter> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::altimeter
