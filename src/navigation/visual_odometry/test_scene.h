#pragma once
/// Scene of the tests: a room with textured walls, ground and ceiling, and a textured board in it, seen by a ray caster.
///
/// Textures are tables with levels of half the size each, blended by the size of a pixel, so that images of a moving camera do not
/// flicker. W: x and y level, z up, ground at z = 0. S as in track.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/random.h"
#include "geometry/pose.h"
#include "navigation/visual_odometry/image.h"

namespace sandlot::navigation::vo::test {

/// Image of a test.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  Picture() = default;
  Picture(int w, int h, std::uint8_t grey = 0)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), grey) {}
  std::uint8_t& at(int u, int v) { return pixels[static_cast<std::size_t>(v * width + u)]; }
  GreyImage view() const { return {pixels, width, height, width}; }
};

/// Normal noise, rounded and cut to 8 bits.
inline void add_noise(Picture& picture, double deviation, std::uint64_t seed) {
  static const std::vector<double> normals = [] {
    Stream random(77, 1, Purpose::noise, 0);
    std::vector<double> out(1 << 16);
    for (double& x : out) x = random.normal();
    return out;
  }();
  std::uint64_t state = seed * 0x9e3779b97f4a7c15u + 1;
  for (std::uint8_t& pixel : picture.pixels) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const double value = pixel + deviation * normals[state >> 48] + 0.5;
    pixel = static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
  }
}

/// Grey values with detail of every size from one texel to 32, period 512 texels, and their means over 2^level texels.
class Texture {
 public:
  explicit Texture(std::uint64_t seed) {
    std::vector<double> sum(side * side, 128.0);
    for (int octave = 0; octave < 6; ++octave) {
      const int size = 1 << octave, count = side / size;
      Stream random(seed, 2, Purpose::noise, static_cast<std::uint64_t>(octave));
      std::vector<double> values(static_cast<std::size_t>(count * count));
      for (double& x : values) x = random.uniform(-1, 1);
      const double strength = octave == 0 ? 25 : 40;
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
          sum[static_cast<std::size_t>(y * side + x)] +=
              strength * values[static_cast<std::size_t>(y / size * count + x / size)];
    }
    levels_[0].resize(sum.size());
    for (std::size_t i = 0; i < sum.size(); ++i)
      levels_[0][i] = static_cast<float>(std::min(std::max(sum[i], 10.0), 245.0));
    for (std::size_t level = 1; level < levels_.size(); ++level) {
      const int n = side >> level;
      const std::vector<float>& finer = levels_[level - 1];
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          const float* at = finer.data() + 4 * y * n + 2 * x;
          levels_[level].push_back((at[0] + at[1] + at[2 * n] + at[2 * n + 1]) / 4);
        }
    }
  }
  /// @param size  of a pixel, in texels
  double at(double x, double y, double size) const {
    std::size_t level = 0;
    while (size > 2 && level + 2 < levels_.size()) size *= 0.5, ++level;
    const double blend = size <= 1 ? 0 : size >= 2 ? 1 : size - 1;
    const double fine = sample(level, x, y);
    return blend > 0 ? fine + blend * (sample(level + 1, x, y) - fine) : fine;
  }

 private:
  static constexpr int side = 512;
  double sample(std::size_t level, double x, double y) const {
    const double scale = 1.0 / static_cast<double>(1 << level);
    const double u = (x + 51200) * scale - 0.5, v = (y + 51200) * scale - 0.5;
    const int n = side >> level, iu = static_cast<int>(u), iv = static_cast<int>(v);
    const double a = u - iu, b = v - iv;
    const float *upper = levels_[level].data() + (iv & (n - 1)) * n,
                *lower = levels_[level].data() + ((iv + 1) & (n - 1)) * n;
    const int left = iu & (n - 1), right = (iu + 1) & (n - 1);
    return (1 - b) * ((1 - a) * upper[left] + a * upper[right]) +
           b * ((1 - a) * lower[left] + a * lower[right]);
  }
  std::array<std::vector<float>, 8> levels_;
};

/// Board in a plane x = const.
struct Board {
  double x = 0, y0 = 0, y1 = 0, z0 = 0, z1 = 0;
  double texture_y = 0;  ///< by which its texture has moved with it
};

struct Scene {
  Vec3 low{-4, -5, 0}, high{8, 5, 3};
  std::optional<Board> board;
  double brightness = 1;

  /// @param X_WS   pose of the camera
  /// @param focal  [px]; the optical axis is in the middle of the image
  Picture render(const Pose& X_WS, int width, int height, double focal) const {
    static const Texture texture(5);
    constexpr double texels_per_m = 60;
    Picture out(width, height);
    const Vec3 forward = rotate(X_WS.q, {1, 0, 0}), left = rotate(X_WS.q, {0, 1, 0}),
               up = rotate(X_WS.q, {0, 0, 1}), p = X_WS.p;
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        const double a = (0.5 * (width - 1) - u) / focal, b = (0.5 * (height - 1) - v) / focal;
        const double dx = forward.x + a * left.x + b * up.x, dy = forward.y + a * left.y + b * up.y,
                     dz = forward.z + a * left.z + b * up.z;
        const double tx = dx > 0   ? (high.x - p.x) / dx
                          : dx < 0 ? (low.x - p.x) / dx
                                   : 1e9,
                     ty = dy > 0   ? (high.y - p.y) / dy
                          : dy < 0 ? (low.y - p.y) / dy
                                   : 1e9,
                     tz = dz > 0   ? (high.z - p.z) / dz
                          : dz < 0 ? (low.z - p.z) / dz
                                   : 1e9;
        double t = 0, s0 = 0, s1 = 0, slope = 0;
        if (tx <= ty && tx <= tz) {
          t = tx, s0 = p.y + t * dy + (dx > 0 ? 1.3 : 2.7), s1 = p.z + t * dz, slope = std::abs(dx);
        } else if (ty <= tz) {
          t = ty, s0 = p.x + t * dx + (dy > 0 ? 0.6 : 3.4), s1 = p.z + t * dz + 2.1, slope = std::abs(dy);
        } else {
          t = tz, s0 = p.x + t * dx, s1 = p.y + t * dy + (dz > 0 ? 1.7 : 0), slope = std::abs(dz);
        }
        if (board && dx > 0) {
          const double t_board = (board->x - p.x) / dx, y = p.y + t_board * dy, z = p.z + t_board * dz;
          if (t_board > 0.05 && t_board < t && y > board->y0 && y < board->y1 && z > board->z0 &&
              z < board->z1)
            t = t_board, s0 = y - board->texture_y + 0.9, s1 = z + 3.1, slope = dx;
        }
        // A pixel is t / focal wide, and longer by 1 / slope along the slant: the geometric mean.
        const double size = texels_per_m * t / (focal * std::sqrt(std::max(slope, 0.05)));
        out.at(u, v) = static_cast<std::uint8_t>(
            std::floor(brightness * texture.at(texels_per_m * s0, texels_per_m * s1, size) + 0.5));
      }
    return out;
  }
};

/// Pose of the right camera.
inline Pose right_of(const Pose& X_WS, double baseline_m) { return X_WS * Pose{{0, -baseline_m, 0}, {}}; }

}  // namespace sandlot::navigation::vo::test
