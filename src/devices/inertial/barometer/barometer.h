#pragma once
/// Barometer: pressure of the air, from which height follows.
///
///   p = p0 (1 - L z / T0)^(g M / (R L))     z: height above sea level
///
/// with p0 = 101325 Pa, T0 = 288.15 K, L = 6.5 K/km, g M / (R L) = 5.25588 of the standard atmosphere.
///
/// Output   level `pressure`: sensor_msgs/FluidPressure [Pa]; variance of the noise configured.
/// Time     the end of the tick.
/// Noise    noise/channel_noise.h. Weather is its drifting bias: 100 Pa over hours.
/// Limits   standard atmosphere up to 11 km, no wind pressure. Sea level is `reference_altitude` below the
///          world's z = 0; not given, the world's elevation on the Earth, or 0 where it has none.
/// Cost     one power per sample, no allocation.
/// Source   ISO 2533 (standard atmosphere), troposphere; SDF 1.9 <air_pressure>.
#include <optional>

#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/channel_noise.h"

namespace sandlot::barometer {

struct Spec {
  ChannelNoiseSpec noise;
  std::optional<double> reference_altitude_m;
  double rate_hz = 20;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"noise", "Pa", "Errors of the pressure."}, s.noise);
    visit(Field{"reference_altitude", "m", "Height of the world's z = 0 above sea level.", -1000, 11000},
          s.reference_altitude_m);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  ChannelNoise noise;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"noise", "Pa", "Errors of the pressure."}, s.noise);
  }
};

struct Barometer {
  using Spec = barometer::Spec;
  using State = barometer::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;
  Vec3 p_LS;
  double altitude_m = 0;  ///< of the world's z = 0
  Topic<msg::FluidPressure>* pressure = nullptr;

  static Result<Barometer> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Barometer> pool, const Context& context);
};

/// Pressure of the standard atmosphere.
double pressure_Pa(double altitude_m);

extern const Kind kind;

}  // namespace sandlot::barometer
