#pragma once
/// Thermometer: temperature of the air.
///
///   T = ambient - 6.5 K/km (z - 0)      z: height in the world
///
/// Output   level `temperature`: sensor_msgs/Temperature [degC], as ROS has it; variance of the noise
///          configured.
/// Time     follows the air with the time constant `response`: T' = (T_air - T) / response, exact over each
///          interval; the first sample shows the air.
/// Noise    noise/channel_noise.h.
/// Limits   the air alone: nothing in the world is warm, there is no wind, sun or weather. Give each
///          thermometer of a world the same `ambient`.
/// Cost     one exponential per sample, no allocation.
/// Source   ISO 2533 (standard atmosphere): 15 degC, 6.5 K/km.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/channel_noise.h"

namespace sandlot::thermometer {

struct Spec {
  double ambient_degC = 15, gradient_degC_per_m = -0.0065, response_s = 0;
  ChannelNoiseSpec noise;
  double rate_hz = 1;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"ambient", "degC", "Temperature of the air where the world's z is 0.", -273.15, 1e4},
          s.ambient_degC);
    visit(Field{"gradient", "degC/m", "Change of the air's temperature with the height.", -10, 10},
          s.gradient_degC_per_m);
    visit(Field{"response", "s", "Time constant of the probe; 0: no delay.", 0, 1e6}, s.response_s);
    visit(Field{"noise", "degC", "Errors of the temperature."}, s.noise);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  ChannelNoise noise;
  double probe_degC = 0;  ///< without errors
  bool begun = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"noise", "degC", "Errors of the temperature."}, s.noise);
    visit(Field{"probe", "degC", "Temperature of the probe itself."}, s.probe_degC);
    visit(Field{"begun", "", "Whether a sample has been taken."}, s.begun);
  }
};

struct Thermometer {
  using Spec = thermometer::Spec;
  using State = thermometer::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;
  Vec3 p_LS;
  Topic<msg::Temperature>* temperature = nullptr;

  static Result<Thermometer> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Thermometer> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::thermometer
