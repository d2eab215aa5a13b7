#pragma once
/// Errors of depth pictures as a chain of stages in the user's order: float distances [m], +inf where nothing
/// is seen.
///
///   noise: [{disparity: {step: 0.125, focal_baseline: 43.5 m}}, {quadratic: {std: 1.4 mm}}, {edges: {jump: 5
///   cm}}]
///
/// z is what comes in, y what goes out, e the factor `errors`; n ~ Normal(0, 1), u ~ Uniform(0, 1). What is
/// not finite stays as it is; what becomes negative is nothing seen.
///
/// Random, rows, cost   as noise/image_noise.h.
/// Limits   edges are looked for along rows alone, so that rows can be done in any order.
/// Source   K. Khoshelham, S. Oude Elberink, Accuracy and Resolution of Kinect Depth Data (2012): disparity
///          in steps of 1/8 pixel and the error that grows with the square of the distance (1.4 mm at 1 m, 3
///          cm at 4.6 m).
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "noise/chain.h"
#include "noise/image_stages.h"

namespace sandlot {

namespace depth_stage {

/// y = z + e std n.
struct Gaussian {
  static constexpr const char* name = "gaussian";
  static constexpr const char* help = "Independent normal errors of every pixel, equal at any distance.";
  double std = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"std", "m", "Standard deviation of the error.", 0, 1e3, Field::tunable | Field::required},
          s.std);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

/// y = z + e std (z / 1 m)^2 n: the error of a depth that was computed from disparities.
struct Quadratic {
  static constexpr const char* name = "quadratic";
  static constexpr const char* help = "Normal errors that grow with the square of the distance.";
  double std = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"std", "m", "Standard deviation of the error at 1 m.", 0, 1e3,
                Field::tunable | Field::required},
          s.std);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

/// y = f b / (s floor(f b / (z s) + 1/2)),   s = e step: the disparity f b / z comes in steps. Steps at the distance z are
/// about s z^2 / (f b) apart. A disparity of less than half a step is nothing seen.
struct Disparity {
  static constexpr const char* name = "disparity";
  static constexpr const char* help = "Distances in steps, as computed from disparities in steps.";
  double step = 0, focal_baseline_m = 0;
  static void fields(auto& s, auto&& visit) {
    constexpr unsigned flags = Field::tunable | Field::required;
    visit(Field{"step", "1", "Step of the disparity [pixels].", 0, 100, flags}, s.step);
    visit(Field{"focal_baseline", "m", "Focal length [pixels] times baseline.", 1e-6, 1e9, flags},
          s.focal_baseline_m);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};

/// Beside a jump along its row a pixel is with the probability e rate not seen, or with `shows: mixed`
/// somewhere between both surfaces: y = z + u (z' - z).
struct Edges {
  static constexpr const char* name = "edges";
  static constexpr const char* help =
      "Pixels beside a jump of the distance are lost, or between both surfaces.";
  enum class Shows : std::uint8_t { nan, inf, mixed };
  double jump_m = 0.05, rate = 1;
  Shows shows = Shows::nan;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"jump", "m", "Smallest difference between neighbours that counts as an edge.", 0, 1e3,
                Field::tunable},
          s.jump_m);
    visit(
        Field{"rate", "1", "Probability per pixel at an edge that it shows an error.", 0, 1, Field::tunable},
        s.rate);
    visit(Field{"shows", "", "Value of such a pixel: no number, nothing seen, or something between."},
          s.shows);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};
inline std::span<const EnumName<Edges::Shows>> enum_names(Edges::Shows) {
  using Shows = Edges::Shows;
  static constexpr EnumName<Shows> names[] = {
      {"nan", Shows::nan}, {"inf", Shows::inf}, {"mixed", Shows::mixed}};
  return names;
}

/// With the probability e rate a pixel is not seen.
struct Dropouts {
  static constexpr const char* name = "dropouts";
  static constexpr const char* help = "Single pixels that are lost.";
  enum class Shows : std::uint8_t { nan, inf };
  double rate = 0;
  Shows shows = Shows::nan;
  static void fields(auto& s, auto&& visit) {
    visit(
        Field{"rate", "1", "Probability per pixel that it is lost.", 0, 1, Field::tunable | Field::required},
        s.rate);
    visit(Field{"shows", "", "Value of a lost pixel: no number, or nothing seen."}, s.shows);
  }
  void corrupt(ImagePiece& piece, const Stream& random) const;
};
inline std::span<const EnumName<Dropouts::Shows>> enum_names(Dropouts::Shows) {
  static constexpr EnumName<Dropouts::Shows> names[] = {{"nan", Dropouts::Shows::nan},
                                                        {"inf", Dropouts::Shows::inf}};
  return names;
}

}  // namespace depth_stage

namespace noise_detail {
struct DepthSorts {
  static constexpr const char* described_as = "depth_noise";
  using Spec = std::variant<std::monostate, depth_stage::Gaussian, depth_stage::Quadratic,
                            depth_stage::Disparity, depth_stage::Edges, depth_stage::Dropouts>;
};
}  // namespace noise_detail
using DepthStageSpec = StageOf<noise_detail::DepthSorts>;

struct DepthNoiseSpec {
  static constexpr const char* list_key = "stages";
  std::vector<DepthStageSpec> stages;

  static void fields(auto& s, auto&& visit) { visit(stages_field, s.stages); }
};

/// Corrupts a depth picture, or the whole rows of it from `first_row` on that `depth_m` holds, in place.
/// @param random  stream of the device for this picture, Purpose::noise; its position does not matter
void corrupt_depth(const DepthNoiseSpec& spec, std::span<float> depth_m, int width, int height,
                   const Stream& random, double errors = 1, int first_row = 0);

std::vector<StageType> depth_stage_types();

SL_EXTERN_FIELDS(DepthStageSpec);
extern template void write_tunables(ByteWriter&, const DepthStageSpec&);
extern template void read_tunables(ByteReader&, DepthStageSpec&);

}  // namespace sandlot
