#pragma once
/// Ground sensor: how bright the floor is below a few spots, for following lines and telling zones.
///
/// Frame    sensor frame S: x forward, y left, z up. Spot i looks down, along -z, from (x, y, 0) of `spots`.
/// Output   level `reflectance`: std_msgs/Float32MultiArray, one value per spot in the order of `spots`: 0
///          black, 1 white, in steps of 1/255; 0 where nothing lies within `range`, from where no light comes
///          back. Red, green and blue count with 0.2126, 0.7152, 0.0722. Each spot has its own lamp: it sees
///          the floor's own colour, whatever light and shadow there is.
/// Time     the end of the tick.
/// Noise    a chain of stages (noise/chain.h) on all spots at once; then cut to 0..1.
/// Housing  the link that carries it is not seen.
/// Limits   infra-red sensors weigh colours in other ways; no fall-off with the height, no light from
///          elsewhere.
/// Cost     one pixel of `samples` rays and one of depth per spot.
/// Errors   a bad spec: place and path of the key.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/chain.h"
#include "optics/lens.h"

namespace sandlot::ground_sensor {

struct Spot {
  double x_m = 0, y_m = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Position of the spot, forward.", -100, 100}, s.x_m);
    visit(Field{"y", "m", "Position of the spot, to the left.", -100, 100}, s.y_m);
  }
};

struct Spec {
  std::vector<Spot> spots{{}};
  double fov_rad = 0.2, range_m = 0.1;
  int samples = 4;
  ChainSpec noise;
  double rate_hz = 50;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"spots", "", "Spots on the floor that are measured: [{x: 0, y: 1 cm}, ...].", 0, 0,
                Field::none, 256, 1},
          s.spots);
    visit(Field{"fov", "rad", "Opening angle of each spot.", 1e-3, 2.8}, s.fov_rad);
    visit(Field{"range", "m", "Farthest distance of the floor.", 1e-3, 1e3}, s.range_m);
    visit(Field{"samples", "1", "Number of rays that are averaged.", 1, 256}, s.samples);
    visit(Field{"noise", "1", "Errors of the brightness."}, s.noise);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  ChannelChain noise;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"noise", "", "Errors of the brightness."}, s.noise);
  }
};

struct GroundSensor {
  using Spec = ground_sensor::Spec;
  using State = ground_sensor::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;
  std::vector<Pose> X_LSpot;  ///< x of a spot's own frame points down
  std::shared_ptr<const optics::LensTable> lens;
  Topic<msg::Float32MultiArray>* reflectance = nullptr;

  static Result<GroundSensor> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<GroundSensor> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::ground_sensor
