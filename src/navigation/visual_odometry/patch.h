#pragma once
/// Patch of an image, and its place in another one to a fraction of a pixel (Lucas-Kanade, translation and brightness).
///
/// Minimises the sum over 11 x 11 pixels of (other(p + x) - patch(x) - offset)^2 by Gauss-Newton steps with the patch's
/// gradients (inverse compositional), other interpolated bilinearly at 1/256 of a pixel.
///
/// Accuracy   0.02 px for shifted images without noise; with noise of standard deviation s about s / sqrt(sum of squared
///            gradients) each way.
/// Limits     no change of scale or shear within the patch; start within about 2 px.
/// Cost       about 0.3 us per step; sums are integers, the same bits everywhere.
/// Source     S. Baker, I. Matthews, Lucas-Kanade 20 years on (2004), sec. 3.2.
#include <array>
#include <optional>

#include "geometry/vec2.h"
#include "navigation/visual_odometry/image.h"

namespace sandlot::navigation::vo {

inline constexpr int patch_radius_px = 5;

class Patch {
 public:
  /// None too near to the image's edge, or without gradients in two directions.
  static std::optional<Patch> of(const PaddedImage& image, int u, int v);
  /// Place of the patch's centre in another image; none when that leaves the image, moves more than `reach_px` from the start,
  /// does not converge, or the patch looks otherwise there (more than half of its variance is left).
  std::optional<Vec2> find(const PaddedImage& image, Vec2 start, double reach_px) const;

 private:
  static constexpr int side = 2 * patch_radius_px + 1, lanes = 16, pixels = side * side;
  using Rows = std::array<std::array<std::int32_t, lanes>, side>;
  /// Columns beyond the patch have weight and gradients 0.
  Rows value_{}, du_{}, dv_{};
  std::int32_t sum_du_ = 0, sum_dv_ = 0;
  double variance_ = 0;                                      ///< times the number of pixels
  double inverse_uu_ = 0, inverse_uv_ = 0, inverse_vv_ = 0;  ///< of the gradients' scatter matrix
};

}  // namespace sandlot::navigation::vo
