/// Any pictures, calibrations and states with bytes changed to the odometry of two eyes and of one: each picture has an outcome, one that is
/// counted, and a pose that is claimed is finite, with a covariance that is one.
///
/// Pictures are of a few bytes: their size, a texture that is shifted, flat, or the bytes themselves.
#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/check.h"
#include "input.h"
#include "navigation/visual_odometry/mono_odometry.h"
#include "navigation/visual_odometry/stereo_odometry.h"

namespace {

using namespace sandlot;
namespace vo = navigation::vo;

using fuzz::Input;

struct Picture {
  std::vector<std::uint8_t> pixels;
  vo::GreyImage image;
};

/// Blobs of three pixels, the same for the same seed.
std::uint8_t texture(std::uint32_t seed, int u, int v) {
  std::uint32_t x = seed * 2654435761U + static_cast<std::uint32_t>(u / 3) * 2246822519U +
                    static_cast<std::uint32_t>(v / 3) * 3266489917U;
  x ^= x >> 15, x *= 2246822519U, x ^= x >> 13;
  return static_cast<std::uint8_t>(x);
}

Picture picture_of(Input& in) {
  Picture out;
  const std::uint8_t how = in.byte();
  int width = 96, height = 64;
  if (how >= 192) width = in.byte(), height = in.byte();
  // Each pixel taken, or none: a size that is claimed only.
  const int rows = how >= 240 ? std::min(height, 8) : height, stride = how >= 224 ? in.byte() : width;
  const std::uint8_t kind = in.byte();
  const std::uint32_t seed = kind / 64;
  const int du = static_cast<int>(in.byte()) / 4, dv = static_cast<int>(in.byte()) / 32;
  out.pixels.resize(static_cast<std::size_t>(std::max(0, stride) * rows));
  for (std::size_t i = 0; i < out.pixels.size(); ++i) {
    const int u = static_cast<int>(i) % stride, v = static_cast<int>(i) / stride;
    out.pixels[i] = kind % 16 == 0   ? std::uint8_t{128}
                    : kind % 16 == 1 ? in.byte()
                                     : texture(seed, u + du, v + dv);
  }
  out.image = {out.pixels, width, how == 255 ? -height : height, stride};
  return out;
}

/// Keys that make work for small pictures.
template <class Spec>
Spec spec_of(Input& in) {
  Spec spec;
  const std::uint8_t flags = in.byte();
  spec.features.half_resolution = flags & 1;
  spec.features.bucket_px = 8;
  spec.matching.radius_px = 40;
  spec.matching.bucket_px = 8;
  spec.ransac_iterations = 20;
  spec.min_inliers = 8;
  spec.max_position_deviation_m = flags & 2 ? 1e6 : 0.2;
  spec.patience = flags & 4 ? 0 : 2;
  auto& camera = spec.camera;
  camera.fx_px = camera.fy_px = 80, camera.cx_px = 47.5, camera.cy_px = 31.5;
  if (flags & 8) camera.fx_px = in.number();
  if (flags & 16) camera.fy_px = in.number();
  if (flags & 32) camera.cx_px = in.number();
  if (flags & 64) camera.cy_px = in.number();
  if constexpr (std::is_same_v<Spec, vo::StereoSpec>) {
    if (flags & 128) camera.baseline_m = in.number();
  } else {
    if (flags & 128) camera.height_m = in.number(), camera.pitch_rad = in.number();
  }
  return spec;
}

/// Changes a few bytes of a state. @return whether it can still be read
template <class State>
bool forge(State& state, Input& in) {
  ByteWriter w;
  write(w, state);
  std::vector<std::byte> bytes(w.bytes().begin(), w.bytes().end());
  for (int changes = in.byte() % 4; changes > 0; --changes) {
    const std::size_t at = static_cast<std::size_t>(in.byte() << 16 | in.byte() << 8 | in.byte());
    bytes[at % bytes.size()] = std::byte{in.byte()};
  }
  State forged;
  ByteReader r(bytes);
  read(r, forged);
  if (!r.ok() || r.remaining() > 0) return false;
  // As the controller's fits().
  for (const Pose& X : {forged.track.X_WK, forged.track.X_KS, forged.track.motion})
    for (const double x : {X.p.x, X.p.y, X.p.z, X.q.w, X.q.x, X.q.y, X.q.z})
      if (!(std::abs(x) < 1e12)) return false;
  state = std::move(forged);
  return true;
}

void check(const vo::Step& step, const vo::Track& track, bool forged) {
  SL_CHECK(step.features >= 0 && step.inliers >= 0 && step.inliers <= std::max(step.matches, 0));
  if (forged || !vo::has_pose(step.outcome)) return;
  SL_CHECK(is_finite(vo::pose_W(track)) && is_finite(step.motion));
  const vo::Covariance covariance = vo::covariance_W(track);
  for (std::size_t i = 0; i < 36; ++i)
    SL_CHECK(std::isfinite(covariance[i]) && std::isfinite(step.motion_errors[i]));
  for (std::size_t i = 0; i < 6; ++i) SL_CHECK(covariance[7 * i] >= 0 && step.motion_errors[7 * i] >= 0);
}

template <class Spec, class State>
void run(Input& in, auto&& advance) {
  const Spec spec = spec_of<Spec>(in);
  if (const Status valid = validate(spec); !valid) {
    SL_CHECK(!valid.error().what.empty());
    return;
  }
  State state;
  bool forged = false;
  for (int pictures = 0; !in.empty() && pictures < 12; ++pictures) {
    if (in.byte() % 8 == 7) {
      if (!forge(state, in)) return;
      forged = true;
    }
    const std::uint64_t before = state.track.images;
    const vo::Step step = advance(spec, state, in);
    SL_CHECK(state.track.images == before + 1);
    check(step, state.track, forged);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input in(data, size);
  if (in.byte() % 2 == 0)
    run<vo::StereoSpec, vo::StereoState>(in, [](const auto& spec, auto& state, Input& bytes) {
      const Picture left = picture_of(bytes), right = picture_of(bytes);
      return vo::advance(spec, state, left.image, right.image);
    });
  else
    run<vo::MonoSpec, vo::MonoState>(in, [](const auto& spec, auto& state, Input& bytes) {
      return vo::advance(spec, state, picture_of(bytes).image);
    });
  return 0;
}
