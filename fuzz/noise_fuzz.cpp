/// Any text as lists of stages for a scan, an axis, a picture and a depth picture: one error, or errors that leave scans
/// within their range, and no crash whatever the numbers are.
#include <cmath>
#include <limits>

#include "base/check.h"
#include "files/yaml.h"
#include "noise/channel_noise.h"
#include "noise/depth_noise.h"
#include "noise/image_noise.h"
#include "noise/range_noise.h"

namespace {

using namespace sandlot;

struct All {
  RangeNoiseSpec scan;
  ChannelNoiseSpec axis;
  ImageNoiseSpec image;
  DepthNoiseSpec depth;
  double errors = 1, interval_s = 0.1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"scan", "m", "Of a scan."}, s.scan);
    visit(Field{"axis", "rad/s", "Of an axis."}, s.axis);
    visit(Field{"image", "1", "Of a picture."}, s.image);
    visit(Field{"depth", "m", "Of a depth picture."}, s.depth);
    visit(errors_field, s.errors);
    visit(Field{"interval", "s", "Between samples.", 1e-9, 1e9}, s.interval_s);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto node = parse_yaml(text, "fuzz.yaml", {.max_bytes = 1 << 14, .max_depth = 16, .max_nodes = 1000});
  if (!node) return 0;
  const auto read = read_spec<All>(*node);
  if (!read) {
    SL_CHECK(!read.error().what.empty());
    return 0;
  }
  const All& spec = *read;
  Stream initial(1, 2, Purpose::initial, 0);
  RangeNoise scan;
  scan.reset(spec.scan, initial);
  ChannelNoise axis;
  axis.reset(spec.axis, initial, "x");
  ImageNoise image;
  image.reset(spec.image, initial);
  const float inf = std::numeric_limits<float>::infinity();
  for (std::uint64_t k = 0; k < 4; ++k) {
    Stream random(1, 2, Purpose::noise, k);
    std::vector<float> ranges{1, 2, inf, -inf, 5, 0.1F, 5, 9.9F};
    scan.corrupt(spec.scan, spec.interval_s, random, 0.1, 10, ranges, spec.errors);
    for (const float r : ranges) SL_CHECK(!std::isfinite(r) || (r >= static_cast<float>(0.1) && r <= 10));
    axis.corrupt(spec.axis, 0.5, spec.interval_s, random, spec.errors);
    std::vector<std::uint8_t> pixels(70 * 3 * 3, static_cast<std::uint8_t>(60 * k));
    image.corrupt(spec.image, pixels, 70, 3, 3, random, spec.errors);
    std::vector<float> depth_m(70 * 3, 2);
    depth_m[4] = inf, depth_m[70] = 0.001F, depth_m[99] = 1e9F;
    corrupt_depth(spec.depth, depth_m, 70, 3, random, spec.errors);
    for (const float z : depth_m) SL_CHECK(!(z < 0));
  }
  return 0;
}
