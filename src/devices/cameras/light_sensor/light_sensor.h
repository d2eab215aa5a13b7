#pragma once
/// Light sensor (photo cell): how much light falls on it.
///
///   E = lux (ambient + sum of the lights: max(0, n.l) colour / attenuation, where no shadow lies)
///
/// Frame    sensor frame S: it faces along x and sees the half space before it, with the cosine.
/// Output   level `illuminance`: sensor_msgs/Illuminance [lx]. Red, green and blue count with 0.2126, 0.7152,
///          0.0722, as the eye weighs them. World files give light without a unit: `lux` is the illuminance
///          that light of strength 1, falling straight on it, is worth.
/// Time     the end of the tick.
/// Noise    noise/channel_noise.h; never below 0.
/// Limits   direct light and the world's ambient alone, nothing reflected or emitted by surfaces. Visuals
///          throw shadows, its own robot's too, but the link that carries the sensor does so only with
///          `own_shadow`: it is its housing, which light comes through a window of. Lights with cast_shadows
///          off shine through all.
/// Cost     one shadow ray per light, no allocation by this kind.
/// Errors   a bad spec: place and path of the key.
/// Source   J. H. Lambert's cosine law; ITU-R BT.709 (weights); attenuation as in pictures: optics/shade.h.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/channel_noise.h"

namespace sandlot::light_sensor {

struct Spec {
  double lux = 1000;
  bool own_shadow = false;
  ChannelNoiseSpec noise;
  double rate_hz = 20;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"lux", "lx", "Illuminance from light of strength 1.", 1e-6, 1e6}, s.lux);
    visit(Field{"own_shadow", "", "Whether the link that carries the sensor throws shadows on it, too.", 0, 1,
                Field::tunable},
          s.own_shadow);
    visit(Field{"noise", "lx", "Errors of the illuminance."}, s.noise);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  ChannelNoise noise;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"noise", "lx", "Errors of the illuminance."}, s.noise);
  }
};

struct LightSensor {
  using Spec = light_sensor::Spec;
  using State = light_sensor::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;
  Pose X_LS;
  Topic<msg::Illuminance>* illuminance = nullptr;

  static Result<LightSensor> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<LightSensor> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::light_sensor
