#pragma once
/// Stages of errors of a picture (noise/image_noise.h), on values from 0 (black) to 1 (full scale).
///
/// x is what comes in, y what goes out, e the factor `errors`; n ~ Normal(0, 1) and u ~ Uniform(0, 1) are
/// independent draws. A stage that is `fixed` draws once per device: the same pixels err in the same way in
/// every picture.
///
/// Source   EMVA Standard 1288, Release 4.0 (2021), sec. 2 and 4 (shot noise, dark noise, fixed pattern); T.
///          Braunl et al., EyeSim (salt and pepper, hundreds and thousands: with the probability P a pixel is
///          black or white, or of a random colour).
#include <span>

#include "base/random.h"
#include "base/read.h"

namespace sandlot {

/// A piece of a row of a picture while it is being corrupted.
struct ImagePiece {
  std::span<float>
      values;  ///< of its pixels, channel by channel within a pixel; 0..1, may run over in between
  int channels = 1;
  int x = 0, y = 0;           ///< of its first pixel; x is a multiple of image_piece
  int width = 1, height = 1;  ///< of the picture
  double errors = 1;
};
inline constexpr int image_piece = 64;  ///< pixels at most in a piece

namespace image_stage {

/// y = x + e std n.   `apart`: n is drawn for each channel of a pixel; `together`: once for the pixel, a grey error.
struct Gaussian {
  static constexpr const char* name = "gaussian";
  static constexpr const char* help = "Independent normal errors of every pixel in every picture.";
  enum class Channels : std::uint8_t { apart, together };
  double std = 0;
  Channels channels = Channels::apart;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"std", "1", "Standard deviation of the error; 1 is full scale.", 0, 10,
                Field::tunable | Field::required},
          s.std);
    visit(Field{"channels", "", "Errors of each channel apart, or the same for all channels of a pixel."},
          s.channels);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};
inline std::span<const EnumName<Gaussian::Channels>> enum_names(Gaussian::Channels) {
  static constexpr EnumName<Gaussian::Channels> names[] = {{"apart", Gaussian::Channels::apart},
                                                           {"together", Gaussian::Channels::together}};
  return names;
}

/// y = x + e sqrt(x / full_well) n, per channel: the Poisson noise of so many electrons, in its normal limit.
/// The variance grows with the light.
struct Shot {
  static constexpr const char* name = "shot";
  static constexpr const char* help = "Noise of counted light: the variance grows with the brightness.";
  double full_well = 10000;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"full_well", "1", "Electrons at full scale.", 1, 1e9, Field::tunable | Field::required},
          s.full_well);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

/// With the probability e salt a pixel is white, with e pepper black.
struct SaltAndPepper {
  static constexpr const char* name = "salt_and_pepper";
  static constexpr const char* help = "Single pixels that are white or black.";
  double salt = 0, pepper = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"salt", "1", "Probability that a pixel is white.", 0, 1, Field::tunable}, s.salt);
    visit(Field{"pepper", "1", "Probability that a pixel is black.", 0, 1, Field::tunable}, s.pepper);
  }
  Status check(const Node& node, const std::string& path) const {
    if (salt + pepper <= 1) return {};
    return node.error("salt and pepper together are more than 1", "they are probabilities of one pixel",
                      path);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

/// With the probability e rate a pixel shows a random colour: each channel uniform.
struct HundredsAndThousands {
  static constexpr const char* name = "hundreds_and_thousands";
  static constexpr const char* help = "Single pixels of random colours.";
  double rate = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"rate", "1", "Probability per pixel that it has a random colour.", 0, 1,
                Field::tunable | Field::required},
          s.rate);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

/// y = x (1 + e gain_std n1) + e offset_std n2,   n1, n2 drawn once per pixel and channel.
struct FixedPattern {
  static constexpr const char* name = "fixed_pattern";
  static constexpr const char* help = "Differences between pixels that are the same in every picture.";
  static constexpr bool fixed = true;
  double offset_std = 0, gain_std = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"offset_std", "1", "Standard deviation of the pixels' dark values.", 0, 10, Field::tunable},
          s.offset_std);
    visit(Field{"gain_std", "1", "Standard deviation of the pixels' gains.", 0, 10, Field::tunable},
          s.gain_std);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

/// A share e dead of the pixels is always black, a share e hot always white.
struct DeadPixels {
  static constexpr const char* name = "dead_pixels";
  static constexpr const char* help =
      "Pixels that are always black or always white, the same in every picture.";
  static constexpr bool fixed = true;
  double dead = 0, hot = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"dead", "1", "Share of the pixels that are black.", 0, 1, Field::tunable}, s.dead);
    visit(Field{"hot", "1", "Share of the pixels that are white.", 0, 1, Field::tunable}, s.hot);
  }
  Status check(const Node& node, const std::string& path) const {
    if (dead + hot <= 1) return {};
    return node.error("dead and hot together are more than 1", "they are shares of the pixels", path);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

/// y = x + e std n,   n drawn per row of each picture: lines that flicker.
struct Rows {
  static constexpr const char* name = "rows";
  static constexpr const char* help = "Errors that all pixels of a row share, drawn for every picture.";
  double std = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"std", "1", "Standard deviation of the error of a row; 1 is full scale.", 0, 10,
                Field::tunable | Field::required},
          s.std);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

/// y = x (1 - e strength (r / r_corner)^2), not below 0;   r is the distance from the middle of the picture.
struct Vignetting {
  static constexpr const char* name = "vignetting";
  static constexpr const char* help = "A picture that is darker towards its corners.";
  double strength = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"strength", "1", "Share of the light that is lost in the corners.", 0, 1,
                Field::tunable | Field::required},
          s.strength);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

}  // namespace image_stage
}  // namespace sandlot
