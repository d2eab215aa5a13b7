#include "navigation/visual_odometry/patch.h"

#include <algorithm>
#include <cmath>

namespace sandlot::navigation::vo {
namespace {

// Fractions of a pixel in weights; their products have twice as many bits, of which the sums keep patch_value_bits.
constexpr int patch_fraction_bits = 8, patch_fraction = 1 << patch_fraction_bits, patch_value_bits = 5;
constexpr int patch_steps = 12;
constexpr double patch_rest_px = 0.01;
/// Least mean square of the difference between the pixels before and after one, in the direction in which it is least.
constexpr double patch_least_gradient = 4;

}  // namespace

std::optional<Patch> Patch::of(const PaddedImage& image, int u, int v) {
  constexpr int r = patch_radius_px;
  if (u < r + 1 || v < r + 1 || u > image.width - r - 2 || v > image.height - r - 2) return std::nullopt;
  Patch out;
  std::int32_t uu = 0, uv = 0, vv = 0, sum = 0, squares = 0;
  for (int y = 0; y < side; ++y) {
    const std::uint8_t *above = image.row(v - r + y - 1) + u - r, *row = image.row(v - r + y) + u - r,
                       *below = image.row(v - r + y + 1) + u - r;
    auto& value = out.value_[static_cast<std::size_t>(y)];
    auto& du = out.du_[static_cast<std::size_t>(y)];
    auto& dv = out.dv_[static_cast<std::size_t>(y)];
    for (int x = 0; x < side; ++x) {
      const auto i = static_cast<std::size_t>(x);
      value[i] = row[x] << patch_value_bits;
      du[i] = row[x + 1] - row[x - 1];
      dv[i] = below[x] - above[x];
      uu += du[i] * du[i];
      uv += du[i] * dv[i];
      vv += dv[i] * dv[i];
      out.sum_du_ += du[i];
      out.sum_dv_ += dv[i];
      sum += row[x];
      squares += row[x] * row[x];
    }
  }
  out.variance_ = squares - double{1} * sum * sum / pixels;
  // Scatter about the mean, since the brightness is free.
  const double a = uu - double{1} * out.sum_du_ * out.sum_du_ / pixels,
               b = uv - double{1} * out.sum_du_ * out.sum_dv_ / pixels,
               c = vv - double{1} * out.sum_dv_ * out.sum_dv_ / pixels;
  const double least = 0.5 * (a + c - std::sqrt((a - c) * (a - c) + 4 * b * b));
  if (!(least > patch_least_gradient * pixels)) return std::nullopt;
  const double determinant = a * c - b * b;
  out.inverse_uu_ = c / determinant;
  out.inverse_uv_ = -b / determinant;
  out.inverse_vv_ = a / determinant;
  return out;
}

std::optional<Vec2> Patch::find(const PaddedImage& image, Vec2 start, double reach_px) const {
  constexpr int r = patch_radius_px;
  Vec2 at = start;
  for (int step = 0; step < patch_steps; ++step) {
    if (!(std::abs(at.x - start.x) <= reach_px && std::abs(at.y - start.y) <= reach_px)) return std::nullopt;
    // The place in steps of 1/256 pixel is where the sums hold.
    const double floor_u = std::floor(at.x), floor_v = std::floor(at.y);
    if (!(floor_u >= r && floor_v >= r && floor_u <= image.width - r - 2 && floor_v <= image.height - r - 2))
      return std::nullopt;
    const int u = static_cast<int>(floor_u) - r, v = static_cast<int>(floor_v) - r;
    const int right = static_cast<int>(std::floor((at.x - floor_u) * patch_fraction + 0.5)),
              lower = static_cast<int>(std::floor((at.y - floor_v) * patch_fraction + 0.5));
    at = {floor_u + static_cast<double>(right) / patch_fraction,
          floor_v + static_cast<double>(lower) / patch_fraction};
    const std::int32_t w00 = (patch_fraction - right) * (patch_fraction - lower),
                       w10 = right * (patch_fraction - lower), w01 = (patch_fraction - right) * lower,
                       w11 = right * lower;
    constexpr int shift = 2 * patch_fraction_bits - patch_value_bits;
    std::int32_t by_u = 0, by_v = 0, sum = 0;
    Rows difference;
    for (int y = 0; y < side; ++y) {
      const std::uint8_t* __restrict upper = image.row(v + y) + u, * __restrict under = image.row(v + y + 1) +
                                                                                        u;
      const auto& value = value_[static_cast<std::size_t>(y)];
      const auto& du = du_[static_cast<std::size_t>(y)];
      const auto& dv = dv_[static_cast<std::size_t>(y)];
      auto& d = difference[static_cast<std::size_t>(y)];
      for (std::size_t x = 0; x < lanes; ++x)
        d[x] = ((w00 * upper[x] + w10 * upper[x + 1] + w01 * under[x] + w11 * under[x + 1] +
                 (1 << (shift - 1))) >>
                shift) -
               value[x];
      for (std::size_t x = 0; x < lanes; ++x) by_u += du[x] * d[x];
      for (std::size_t x = 0; x < lanes; ++x) by_v += dv[x] * d[x];
      for (std::size_t x = 0; x < side; ++x) sum += d[x];
    }
    const double mean = static_cast<double>(sum) / pixels;
    const double bu = by_u - mean * sum_du_, bv = by_v - mean * sum_dv_;
    // Gradients are over two pixels, differences in 32nds.
    constexpr double unit = 2.0 / (1 << patch_value_bits);
    const Vec2 move{-unit * (inverse_uu_ * bu + inverse_uv_ * bv),
                    -unit * (inverse_uv_ * bu + inverse_vv_ * bv)};
    at = at + move;
    if (!(std::abs(move.x) < patch_rest_px && std::abs(move.y) < patch_rest_px)) continue;
    double squares = 0;
    for (const auto& row : difference)
      for (std::size_t x = 0; x < side; ++x) squares += double{1} * row[x] * row[x];
    const double left = (squares - mean * sum) / ((1 << patch_value_bits) * (1 << patch_value_bits));
    if (left > 0.5 * variance_) return std::nullopt;
    return at;
  }
  return std::nullopt;
}

}  // namespace sandlot::navigation::vo
