#include "noise/depth_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "noise/deviates.h"

namespace sandlot {
SL_COMPILE_FIELDS(DepthStageSpec);
template void write_tunables(ByteWriter&, const DepthStageSpec&);
template void read_tunables(ByteReader&, DepthStageSpec&);

namespace {

constexpr float nowhere = std::numeric_limits<float>::infinity();
constexpr float no_number = std::numeric_limits<float>::quiet_NaN();

/// Calls work(value, number) for each pixel of a row, with numbers of `fill`, drawn a few at a time.
template <class Fill, class Work>
void with_numbers(ImagePiece& row, const Stream& random, const Fill& fill, const Work& work) {
  std::array<float, image_piece> numbers;
  const auto first = static_cast<std::uint32_t>(row.y) * static_cast<std::uint32_t>(row.width);
  for (std::size_t at = 0; at < row.values.size(); at += image_piece) {
    const std::span<float> here(numbers.data(), std::min<std::size_t>(image_piece, row.values.size() - at));
    fill(random, first + static_cast<std::uint32_t>(at), here);  // no pixel takes more than a block
    for (std::size_t i = 0; i < here.size(); ++i) work(at + i, here[i]);
  }
}

}  // namespace

namespace depth_stage {

void Gaussian::corrupt(ImagePiece& row, const Stream& random) const {
  const auto scale = static_cast<float>(row.errors * std);
  with_numbers(row, random, fill_normals, [&](std::size_t i, float n) { row.values[i] += scale * n; });
}

void Quadratic::corrupt(ImagePiece& row, const Stream& random) const {
  const auto scale = static_cast<float>(row.errors * std);
  with_numbers(row, random, fill_normals, [&](std::size_t i, float n) {
    float& z = row.values[i];
    if (std::isfinite(z)) z += scale * z * z * n;
  });
}

void Disparity::corrupt(ImagePiece& row, const Stream&) const {
  const double s = row.errors * step;
  if (s <= 0) return;
  for (float& z : row.values) {
    if (!(std::isfinite(z) && z > 0)) continue;
    const double steps = std::floor(focal_baseline_m / (static_cast<double>(z) * s) + 0.5);
    z = steps > 0 ? static_cast<float>(focal_baseline_m / (s * steps)) : nowhere;
  }
}

void Edges::corrupt(ImagePiece& row, const Stream& random) const {
  const auto below = static_cast<float>(std::min(1.0, row.errors * rate));
  const auto jump = static_cast<float>(jump_m);
  const Stream between = random.fork(1);
  const auto first = static_cast<std::uint32_t>(row.y) * static_cast<std::uint32_t>(row.width);
  float before = row.values.empty() ? 0 : row.values[0];
  with_numbers(row, random, fill_uniforms, [&](std::size_t i, float u) {
    float& z = row.values[i];
    const float here = z, after = i + 1 < row.values.size() ? row.values[i + 1] : here;
    const auto apart = [&](float other) {
      return std::isfinite(here) && (std::isfinite(other) ? std::abs(other - here) > jump : other == nowhere);
    };
    const bool left = apart(before), right = apart(after);
    if ((left || right) && u < below) {
      if (shows == Shows::nan) {
        z = no_number;
      } else if (shows == Shows::inf) {
        z = nowhere;
      } else {
        const float other = left && std::isfinite(before)   ? before
                            : right && std::isfinite(after) ? after
                                                            : here;
        float share = 0;
        fill_uniforms(between, first + static_cast<std::uint32_t>(i), {&share, 1});
        z = here + share * (other - here);
      }
    }
    before = here;
  });
}

void Dropouts::corrupt(ImagePiece& row, const Stream& random) const {
  const auto below = static_cast<float>(std::min(1.0, row.errors * rate));
  const float instead = shows == Shows::nan ? no_number : nowhere;
  with_numbers(row, random, fill_uniforms, [&](std::size_t i, float u) {
    if (u < below) row.values[i] = instead;
  });
}

}  // namespace depth_stage

std::vector<StageType> depth_stage_types() { return types_of<DepthStageSpec>("m"); }

void corrupt_depth(const DepthNoiseSpec& spec, std::span<float> depth_m, int width, int height,
                   const Stream& random, double errors, int first_row) {
  if (spec.stages.empty() || errors == 0 || depth_m.empty()) return;
  SL_CHECK(width > 0 && depth_m.size() % static_cast<std::size_t>(width) == 0);
  SL_CHECK(spec.stages.size() <= max_stages);
  std::array<std::uint64_t, DepthStageSpec::types> before{};
  std::array<std::uint64_t, max_stages> keys{};
  for (std::size_t i = 0; i < spec.stages.size(); ++i)
    keys[i] = hash_combine(hash64(spec.stages[i].name()), before[spec.stages[i].stage.index()]++);
  const auto row_size = static_cast<std::size_t>(width);
  for (std::size_t row = 0; row * row_size < depth_m.size(); ++row) {
    ImagePiece piece{depth_m.subspan(row * row_size, row_size),
                     1,
                     0,
                     first_row + static_cast<int>(row),
                     width,
                     height,
                     errors};
    for (std::size_t i = 0; i < spec.stages.size(); ++i)
      std::visit(
          [&]<class Stage>(const Stage& stage) {
            if constexpr (!std::is_same_v<Stage, std::monostate>) stage.corrupt(piece, random.fork(keys[i]));
          },
          spec.stages[i].stage);
    for (float& z : piece.values)
      if (z < 0) z = nowhere;
  }
}

}  // namespace sandlot
