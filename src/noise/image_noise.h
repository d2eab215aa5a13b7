#pragma once
/// Errors of pictures as a chain of stages in the user's order (noise/image_stages.h):
///
///   noise: [{shot: {full_well: 8000}}, {gaussian: {std: 2 %}}, {salt_and_pepper: {salt: 0.1 %, pepper: 0.1
///   %}}]
///
/// A camera holds an ImageNoiseSpec in its Spec and an ImageNoise next to its State, calls reset() when it is
/// created and corrupt() on each picture it has rendered, with its factor `errors`.
///
/// Pixels   8 bits per channel, 1 to 4 channels, rows without gaps, top row first; 0 is black and 255 full
///          scale. Between the stages values are not rounded nor cut; at the end they are.
/// Time     pictures are independent of each other; only stages that are fixed stay as they are. Nothing is
///          State.
/// Random   each stage has a stream of its own, keyed by the device, the type of stage and how many of that
///          type come before it; each row begins at a place of its own in it. So the result is the same for
///          any split into rows over threads, and adding a stage moves no other's numbers.
/// errors   0 leaves every byte as it is.
/// Limits   normal deviates have 2^16 values: 4.3 standard deviations are the most. No correlation between
///          neighbours (Bayer mosaics, compression), no blooming, no temperature.
/// Cost     2 to 4 ns per deviate; about 10 ns per pixel of three channels for gaussian. No allocation.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "noise/chain.h"
#include "noise/image_stages.h"

namespace sandlot {

namespace noise_detail {
struct ImageSorts {
  static constexpr const char* described_as = "image_noise";
  using Spec =
      std::variant<std::monostate, image_stage::Gaussian, image_stage::Shot, image_stage::SaltAndPepper,
                   image_stage::HundredsAndThousands, image_stage::FixedPattern, image_stage::DeadPixels,
                   image_stage::Rows, image_stage::Vignetting>;
};
}  // namespace noise_detail
using ImageStageSpec = StageOf<noise_detail::ImageSorts>;

struct ImageNoiseSpec {
  static constexpr const char* list_key = "stages";
  std::vector<ImageStageSpec> stages;

  static void fields(auto& s, auto&& visit) { visit(stages_field, s.stages); }
};

/// Image errors of one device. No State: the same streams yield them again.
struct ImageNoise {
  /// @param device  stream of the device, Purpose::initial
  void reset(const ImageNoiseSpec& spec, const Stream& device);
  /// Corrupts a picture, or the rows of it from `first_row` on that `pixels` holds, in place.
  /// @param pixels  whole rows: a multiple of width * channels
  /// @param random  stream of the device for this picture, Purpose::noise; its position does not matter
  /// @param errors  factor on all of it
  /// @pre reset() was called with stages of the same types
  void corrupt(const ImageNoiseSpec& spec, std::span<std::uint8_t> pixels, int width, int height,
               int channels, const Stream& random, double errors = 1, int first_row = 0) const;

 private:
  std::vector<std::uint64_t> keys_;  ///< per stage: which fork of a stream is its own
  std::optional<Stream> device_;
};

/// All types of stages, for lists and the schema.
std::vector<StageType> image_stage_types();

SL_EXTERN_FIELDS(ImageStageSpec);
extern template void write_tunables(ByteWriter&, const ImageStageSpec&);
extern template void read_tunables(ByteReader&, ImageStageSpec&);

}  // namespace sandlot
