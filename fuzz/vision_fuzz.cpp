/// Any bytes as a picture of any size, lens and colours of things: what is found has finite numbers and lies in the picture.
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/check.h"
#include "perception/finder.h"
#include "perception/scan_match.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  using namespace sandlot::perception;
  constexpr const char* models[] = {"plumb_bob",        "equidistant",     "equisolid",
                                    "stereographic",    "orthographic",    "mirror_hyperbolic",
                                    "mirror_parabolic", "mirror_spherical"};
  if (size < 64) return 0;
  const auto number = [&](std::size_t i) {
    float x = 0;
    std::memcpy(&x, data + i, 4);
    return static_cast<double>(x);
  };
  msg::CameraInfo info;
  info.width = data[0] % 64 + (data[1] == 7 ? 9000u : 0u);
  info.height = data[2] % 48;
  info.distortion_model = models[data[3] % 8];
  info.k = {number(4), 0, number(8), 0, number(12), number(16), 0, 0, 1};
  info.d = {number(20), number(24), number(28), number(32), number(36)};

  msg::Image image;
  image.width = info.width, image.height = info.height;
  image.step = 3 * info.width + data[40] % 3;
  image.encoding = data[41] % 16 == 0 ? "mono8" : data[41] % 2 ? "rgb8" : "bgr8";
  image.data.assign(data + 64, data + size);
  if (data[42] % 4 != 0 && info.width < 100)
    image.data.resize(std::size_t{image.step} * info.height, data[43]);
  const auto view = image_view(image);

  FinderSpec spec;
  spec.min_pixels = data[44] % 16 + 1;
  spec.gap = data[45] % 17;
  spec.targets.push_back({.label = "post",
                          .colour = range_around(data[46] / 255.0, data[47] / 255.0, data[48] / 255.0),
                          .form = Form::standing,
                          .depth_m = 0.1});
  const auto camera = CameraModel::of(info);
  if (!view || !camera) return 0;
  const Pose X_BS{{0.1, 0, data[49] / 100.0}, quat_from_rpy(data[50], data[51], data[52])};
  Finder finder(spec, *camera, X_BS);
  std::vector<Found> found;
  SL_CHECK(finder.find(*view, found));
  for (const Found& f : found) {
    SL_CHECK(f.target < spec.targets.size() && is_finite(f.position_B) && std::isfinite(f.bearing_rad));
    SL_CHECK(f.range_m >= 0 && f.range_m <= spec.max_range_m && f.visible >= 0 && f.visible <= 1);
    SL_CHECK(f.patch.left >= 0 && f.patch.right < view->width && f.patch.bottom < view->height);
    SL_CHECK(f.confidence >= 0 && f.confidence <= 1);
  }

  msg::LaserScan scan;
  scan.angle_min = static_cast<float>(number(4));
  scan.angle_increment = static_cast<float>(number(8));
  for (std::size_t i = 64; i + 4 <= size && scan.ranges.size() < 64; i += 4)
    scan.ranges.push_back(static_cast<float>(number(i)));
  const Wall walls[] = {{0, 0, 4, 0}, {4, 0, 4, 3}, {number(20), number(24), number(28), number(32)}};
  (void)match_scan(scan, X_BS, walls, {1, 1, 0.1});
  return 0;
}
