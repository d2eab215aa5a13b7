#pragma once
/// Line camera: one row of pixels, such as a linear sensor array for following lines.
///
/// Frame    sensor frame S: it looks along x, through a pinhole; the first pixel is the leftmost one (y).
/// Output   level `image`: sensor_msgs/Image of one row, mono8 (red, green and blue count with 0.2126,
///          0.7152, 0.0722) or rgb8. Frame: S itself, not an optical frame.
/// Time     all pixels at the end of the tick.
/// Noise    a chain of stages (noise/chain.h) on all values at once, U = 1/255 (mono8: pixels; rgb8: their
///          channels, too); then rounded and cut to 0..255.
/// Housing  the link that carries it is not seen.
/// Limits   a pinhole without distortion; no motion blur. Pixels are square: `fov` across and fov / pixels
///          along the line.
/// Cost     `pixels` times `samples` rays and the shadow rays of the lights.
/// Errors   a bad spec: place and path of the key.
#include "devices/kind.h"
#include "messages/messages.h"
#include "messages/sensor_images.h"
#include "noise/chain.h"
#include "optics/lens.h"

namespace sandlot::line_camera {

enum class Format : std::uint8_t { mono8, rgb8 };
inline std::span<const EnumName<Format>> enum_names(Format) {
  static constexpr EnumName<Format> names[] = {{"mono8", Format::mono8}, {"rgb8", Format::rgb8}};
  return names;
}

struct Spec {
  int pixels = 128;
  double fov_rad = 1, max_range_m = 100;
  int samples = 1;
  Format format = Format::mono8;
  double gain = 1;
  ChainSpec noise;
  double rate_hz = 50;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"pixels", "1", "Number of pixels of the row.", 1, 8192}, s.pixels);
    visit(Field{"fov", "rad", "Opening angle across the row.", 1e-3, 3.1}, s.fov_rad);
    visit(Field{"max_range", "m", "Farthest visible distance.", 1e-3, 1e4}, s.max_range_m);
    visit(Field{"samples", "1", "Number of rays per pixel.", 1, 256}, s.samples);
    visit(Field{"format", "", "Format of the pixels."}, s.format);
    visit(Field{"gain", "1", "Factor on all light.", 0, 1e3, Field::tunable}, s.gain);
    visit(Field{"noise", "", "Errors of the pixels, in steps of 1/255."}, s.noise);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  ChannelChain noise;
  static void fields(auto& s, auto&& visit) { visit(Field{"noise", "", "Errors of the pixels."}, s.noise); }
};

struct LineCamera {
  using Spec = line_camera::Spec;
  using State = line_camera::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;
  Pose X_LS;
  std::shared_ptr<const optics::LensTable> lens;
  std::vector<std::uint8_t> rgb;  ///< of the sample being taken
  std::vector<float> values;      ///< likewise
  Topic<msg::Image>* image = nullptr;

  static Result<LineCamera> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<LineCamera> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::line_camera
