#pragma once
/// Pictures on surfaces: an image and its halves, quarters ... so that far away each pixel meets about one
/// texel.
///
/// Frame    u to the right, v upwards, the image is [0, 1) x [0, 1) and repeats; as meshes have it.
/// Limits   opaque: no alpha. 8 bits per channel.
/// Cost     5.4 bytes per texel.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace sandlot::optics {

class Texture {
 public:
  struct Level {
    std::uint32_t width = 0, height = 0;
    std::uint32_t first = 0;  ///< index into texels()
  };

  /// @param rgb  rows from the top, width * height * 3 bytes, each side 1 to 8192
  static std::shared_ptr<const Texture> make(int width, int height, std::span<const std::uint8_t> rgb);
  /// Magenta and black: what a texture that could not be read looks like.
  static std::shared_ptr<const Texture> missing();

  int width() const { return static_cast<int>(levels_[0].width); }
  int height() const { return static_cast<int>(levels_[0].height); }
  /// Level k + 1 has half the sides of level k, rounded up, down to 1 x 1; each texel the mean of what it
  /// covers.
  std::span<const Level> levels() const { return levels_; }
  /// R | G << 8 | B << 16 | plain << 24. Each level has a further column and row that repeat its first ones.
  /// Plain: the image has one colour wherever this texel and its eight neighbours cover it.
  const std::uint32_t* texels() const { return texels_.data(); }

 private:
  std::vector<Level> levels_;
  std::vector<std::uint32_t> texels_;
};

}  // namespace sandlot::optics
