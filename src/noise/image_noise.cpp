#include "noise/image_noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "noise/deviates.h"

namespace sandlot {
SL_COMPILE_FIELDS(ImageStageSpec);
template void write_tunables(ByteWriter&, const ImageStageSpec&);
template void read_tunables(ByteReader&, ImageStageSpec&);

namespace {

constexpr int most_channels = 4;
constexpr std::size_t most_values = image_piece * most_channels;

/// Place where the numbers of a piece begin if each pixel takes so many bits. No pixel takes more than a
/// block of 128.
std::uint32_t first_block(const ImagePiece& piece, int bits_per_pixel) {
  const auto row = static_cast<std::uint32_t>(piece.y) * static_cast<std::uint32_t>(piece.width);
  return row + static_cast<std::uint32_t>(piece.x * bits_per_pixel / 128);
}
std::size_t pixels(const ImagePiece& piece) {
  return piece.values.size() / static_cast<std::size_t>(piece.channels);
}

/// Draws of one stage for a piece.
class Draws {
 public:
  std::span<const float> normals_per_value(const ImagePiece& piece, const Stream& random) {
    const std::span<float> out(numbers_.data(), piece.values.size());
    fill_normals(random, first_block(piece, 16 * piece.channels), out);
    return out;
  }
  std::span<const float> normals_per_pixel(const ImagePiece& piece, const Stream& random) {
    const std::span<float> out(numbers_.data(), pixels(piece));
    fill_normals(random, first_block(piece, 16), out);
    return out;
  }
  std::span<const float> uniforms_per_pixel(const ImagePiece& piece, const Stream& random) {
    const std::span<float> out(numbers_.data(), pixels(piece));
    fill_uniforms(random, first_block(piece, 32), out);
    return out;
  }

 private:
  std::array<float, most_values> numbers_;
};

/// Pixels that turn white with one probability and black with another.
void white_or_black(ImagePiece& piece, double white, double black, const Stream& random) {
  const double share = piece.errors * (white + black);
  if (share <= 0) return;
  // More often than always cannot be; the two keep their proportion.
  const double scale = share > 1 ? 1 / (white + black) : piece.errors;
  const auto white_below = static_cast<float>(scale * white);
  const auto black_below = static_cast<float>(scale * (white + black));
  Draws draws;
  const auto u = draws.uniforms_per_pixel(piece, random);
  const auto channels = static_cast<std::size_t>(piece.channels);
  for (std::size_t i = 0; i < u.size(); ++i)
    if (u[i] < black_below)
      std::fill_n(piece.values.begin() + static_cast<std::ptrdiff_t>(i * channels), channels,
                  u[i] < white_below ? 1.0F : 0.0F);
}

}  // namespace

namespace image_stage {

void Gaussian::corrupt(ImagePiece& piece, const Stream& random) const {
  const auto scale = static_cast<float>(piece.errors * std);
  Draws draws;
  if (channels == Channels::apart || piece.channels == 1) {
    const auto n = draws.normals_per_value(piece, random);
    for (std::size_t i = 0; i < n.size(); ++i) piece.values[i] += scale * n[i];
    return;
  }
  const auto n = draws.normals_per_pixel(piece, random);
  float* value = piece.values.data();
  for (const float each : n)
    for (int c = 0; c < piece.channels; ++c) *value++ += scale * each;
}

void Shot::corrupt(ImagePiece& piece, const Stream& random) const {
  const auto scale = static_cast<float>(piece.errors / std::sqrt(full_well));
  Draws draws;
  const auto n = draws.normals_per_value(piece, random);
  for (std::size_t i = 0; i < n.size(); ++i)
    piece.values[i] += scale * std::sqrt(std::max(piece.values[i], 0.0F)) * n[i];
}

void SaltAndPepper::corrupt(ImagePiece& piece, const Stream& random) const {
  white_or_black(piece, salt, pepper, random);
}

void HundredsAndThousands::corrupt(ImagePiece& piece, const Stream& random) const {
  const auto below = static_cast<float>(std::min(1.0, piece.errors * rate));
  Draws draws;
  const auto u = draws.uniforms_per_pixel(piece, random);
  const Stream colours = random.fork(1);
  const auto channels = static_cast<std::size_t>(piece.channels);
  std::array<float, most_channels> colour;
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (u[i] >= below) continue;
    fill_uniforms(colours, first_block(piece, 128) + static_cast<std::uint32_t>(i),
                  {colour.data(), channels});
    // 256 steps, each as probable as the others.
    for (std::size_t c = 0; c < channels; ++c)
      piece.values[i * channels + c] = std::floor(256 * colour[c]) / 255;
  }
}

void FixedPattern::corrupt(ImagePiece& piece, const Stream& random) const {
  const auto offset = static_cast<float>(piece.errors * offset_std);
  const auto gain = static_cast<float>(piece.errors * gain_std);
  Draws draws;
  if (gain > 0) {
    const auto n = draws.normals_per_value(piece, random.fork(1));
    for (std::size_t i = 0; i < n.size(); ++i) piece.values[i] *= 1 + gain * n[i];
  }
  if (offset > 0) {
    const auto n = draws.normals_per_value(piece, random);
    for (std::size_t i = 0; i < n.size(); ++i) piece.values[i] += offset * n[i];
  }
}

void DeadPixels::corrupt(ImagePiece& piece, const Stream& random) const {
  white_or_black(piece, hot, dead, random);
}

void Rows::corrupt(ImagePiece& piece, const Stream& random) const {
  float n = 0;
  fill_normals(random, static_cast<std::uint32_t>(piece.y), {&n, 1});
  const float error = static_cast<float>(piece.errors * std) * n;
  for (float& value : piece.values) value += error;
}

void Vignetting::corrupt(ImagePiece& piece, const Stream&) const {
  const double middle_x = 0.5 * (piece.width - 1), middle_y = 0.5 * (piece.height - 1);
  const double corner2 = middle_x * middle_x + middle_y * middle_y;
  if (corner2 <= 0) return;
  const double scale = piece.errors * strength / corner2, dy = piece.y - middle_y;
  float* value = piece.values.data();
  for (std::size_t i = 0; i < pixels(piece); ++i) {
    const double dx = piece.x + static_cast<double>(i) - middle_x;
    const auto keeps = static_cast<float>(std::max(0.0, 1 - scale * (dx * dx + dy * dy)));
    for (int c = 0; c < piece.channels; ++c) *value++ *= keeps;
  }
}

}  // namespace image_stage

std::vector<StageType> image_stage_types() { return types_of<ImageStageSpec>("1"); }

void ImageNoise::reset(const ImageNoiseSpec& spec, const Stream& device) {
  device_ = device;
  keys_.clear();
  std::array<std::uint64_t, ImageStageSpec::types> before{};
  for (const ImageStageSpec& each : spec.stages)
    keys_.push_back(hash_combine(hash64(each.name()), before[each.stage.index()]++));
}

namespace {

/// Whether a stage changes nothing as it is set now. A chain of those costs nothing, so that it may be there for a slider.
template <class Stage>
bool is_idle(const Stage& stage) {
  using namespace image_stage;
  if constexpr (std::is_same_v<Stage, Gaussian>) return stage.std == 0;
  else if constexpr (std::is_same_v<Stage, SaltAndPepper>) return stage.salt == 0 && stage.pepper == 0;
  else if constexpr (std::is_same_v<Stage, HundredsAndThousands>) return stage.rate == 0;
  else return false;
}

}  // namespace

void ImageNoise::corrupt(const ImageNoiseSpec& spec, std::span<std::uint8_t> pixels, int width, int height,
                         int channels, const Stream& random, double errors, int first_row) const {
  if (errors == 0 || pixels.empty()) return;
  if (std::all_of(spec.stages.begin(), spec.stages.end(), [](const ImageStageSpec& each) {
        return std::visit([](const auto& stage) { return is_idle(stage); }, each.stage);
      }))
    return;
  SL_CHECK(keys_.size() == spec.stages.size() && keys_.size() <= max_stages && device_);
  SL_CHECK(width > 0 && channels > 0 && channels <= most_channels);
  const std::size_t row_bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
  SL_CHECK(pixels.size() % row_bytes == 0);

  std::array<std::optional<Stream>, max_stages> own;
  for (std::size_t i = 0; i < keys_.size(); ++i)
    std::visit(
        [&]<class Stage>(const Stage&) {
          if constexpr (requires { Stage::fixed; }) own[i] = device_->fork(keys_[i]);
          else own[i] = random.fork(keys_[i]);
        },
        spec.stages[i].stage);

  std::array<float, most_values> values;
  const auto rows = static_cast<int>(pixels.size() / row_bytes);
  for (int row = 0; row < rows; ++row)
    for (int x = 0; x < width; x += image_piece) {
      const auto at = static_cast<std::size_t>(row) * row_bytes + static_cast<std::size_t>(x * channels);
      const auto count = static_cast<std::size_t>(std::min(image_piece, width - x) * channels);
      std::uint8_t* const bytes = pixels.data() + at;
      for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<float>(bytes[i]) * (1.0F / 255);
      ImagePiece piece{{values.data(), count}, channels, x, first_row + row, width, height, errors};
      for (std::size_t i = 0; i < keys_.size(); ++i)
        std::visit(
            [&]<class Stage>(const Stage& stage) {
              if constexpr (!std::is_same_v<Stage, std::monostate>) stage.corrupt(piece, *own[i]);
            },
            spec.stages[i].stage);
      for (std::size_t i = 0; i < count; ++i) {
        const float level = 255 * values[i];  // no number if it ran over on the way: black
        bytes[i] = static_cast<std::uint8_t>(level > 0 ? std::min(level, 255.0F) + 0.5F : 0.0F);
      }
    }
}

}  // namespace sandlot
