#pragma once
/// Colour sensor: the colour of the surface right before it.
///
/// Frame    sensor frame S: it looks along x, through a square cone of `fov`.
/// Output   level `color`: std_msgs/ColorRGBA, red, green and blue 0..1 in steps of 1/255, a = 1; all 0, a
///          too, when nothing lies within `range`.
/// Lamp     with its own lamp (the default), which drowns all other light, it sees the surface's own colour;
///          without, the light that the surface sends back, shadows of its robot included.
/// Time     the end of the tick.
/// Noise    a chain of stages (noise/chain.h) on red, green and blue; then cut to 0..1. None while nothing is
///          there.
/// Housing  the link that carries it is not seen.
/// Limits   the mean of `samples` rays, not of the whole cone; no gloss, no fall-off with the distance.
/// Cost     one pixel of `samples` rays and one of depth.
/// Errors   a bad spec: place and path of the key.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/chain.h"
#include "optics/lens.h"

namespace sandlot::color_sensor {

struct Spec {
  double fov_rad = 0.2, range_m = 0.1;
  int samples = 4;
  bool lamp = true;
  ChainSpec noise;
  double rate_hz = 20;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"fov", "rad", "Opening angle of the sensor.", 1e-3, 2.8}, s.fov_rad);
    visit(Field{"range", "m", "Farthest visible distance.", 1e-3, 1e3}, s.range_m);
    visit(Field{"samples", "1", "Number of rays that are averaged.", 1, 256}, s.samples);
    visit(Field{"lamp", "", "Whether the sensor lights the surface itself."}, s.lamp);
    visit(Field{"noise", "1", "Errors of red, green and blue."}, s.noise);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  ChannelChain noise;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"noise", "", "Errors of red, green and blue."}, s.noise);
  }
};

struct ColorSensor {
  using Spec = color_sensor::Spec;
  using State = color_sensor::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;
  Pose X_LS;
  std::shared_ptr<const optics::LensTable> lens;
  Topic<msg::ColorRGBA>* color = nullptr;

  static Result<ColorSensor> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<ColorSensor> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::color_sensor
