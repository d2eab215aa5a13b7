#pragma once
/// Features of an image: local extremes of a blob and of a corner filter, with descriptors of gradients.
///
///            -1 -1 -1 -1 -1            -1 -1  0  1  1
///            -1  1  1  1 -1            -1 -1  0  1  1
///   blob     -1  1  8  1 -1   corner    0  0  0  0  0
///            -1  1  1  1 -1             1  1  0 -1 -1
///            -1 -1 -1 -1 -1             1  1  0 -1 -1
///
/// Extremes   a pixel whose response is the greatest (least) within nms_radius pixels, and threshold at least in size. Of equal
///            ones the first in the order of rows counts. Four classes: features are compared within theirs only.
/// Descriptor 16 samples of the Sobel gradients du, dv within 5 pixels, each as a quarter of its value, cut to 8 bits. Compared
///            by the sum of absolute differences.
/// Buckets    of each class the strongest bucket_features of each square are kept, so that strong texture takes no more than
///            its share.
/// Invariance to brightness; not to contrast, turns about the optical axis above about 15 degrees, or scale beyond about 20 %.
/// Cost       integers only, the same bits everywhere: 5 ms for 640 x 480 pixels, most of it extremes and descriptors.
/// Source     A. Geiger, J. Ziegler, C. Stiller, StereoScan: dense 3d reconstruction in real-time (2011), fig. 3 and sec. III-A;
///            extremes: A. Neubeck, L. Van Gool, Efficient non-maximum suppression (2006). Layout of the samples is ours.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "navigation/visual_odometry/image.h"

namespace sandlot::navigation::vo {

struct FeatureSpec {
  bool half_resolution = false;
  int nms_radius = 3, threshold = 50;
  int bucket_px = 32, bucket_features = 2;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"half_resolution", "",
                "Whether features are found in an image of half the size; their places are refined in the "
                "whole one."},
          s.half_resolution);
    visit(Field{"nms_radius", "px", "Distance within which a feature has the greatest response.", 1, 10},
          s.nms_radius);
    visit(Field{"threshold", "1", "Least response of a feature, of at most 4080 (blobs) and 2040 (corners).",
                1, 4080},
          s.threshold);
    visit(Field{"bucket", "px", "Side of the squares among which features are distributed.", 8, 256},
          s.bucket_px);
    visit(Field{"bucket_features", "1", "Greatest number of features of each class in a square.", 1, 100},
          s.bucket_features);
  }
};

enum class FeatureClass : std::uint8_t { blob_max, blob_min, corner_max, corner_min };
inline constexpr int feature_classes = 4;
/// Features keep this distance from the image's edges, for the descriptor.
inline constexpr int feature_margin_px = 8;

struct Feature {
  std::int16_t u = 0, v = 0;  ///< pixel, of the half image with half_resolution
  std::int16_t response = 0;
  std::array<std::uint8_t, 32> descriptor{};

  static void fields(auto& s, auto&& visit) {
    visit(Field{"u", "px", "Column.", 0, greatest_side_px}, s.u);
    visit(Field{"v", "px", "Row.", 0, greatest_side_px}, s.v);
    visit(Field{"response", "1", "Response of the filter.", -4080, 4080}, s.response);
    visit(Field{"descriptor", "1", "Gradients around the feature.", 0, 255}, s.descriptor);
  }
};

/// Features of an image in the order (class, square by rows, response), with an index of the squares.
struct FeatureSet {
  int scale = 1;  ///< pixels of the whole image per pixel of u and v
  int bucket_px = 32, columns = 0, rows = 0;
  std::vector<Feature> features;
  std::vector<std::uint32_t> first;  ///< of each class and square, then the number of features

  static void fields(auto& s, auto&& visit) {
    visit(Field{"scale", "1", "Pixels of the image per pixel of the features.", 1, 2}, s.scale);
    visit(Field{"bucket", "px", "Side of the squares.", 1, 256}, s.bucket_px);
    visit(Field{"columns", "1", "Number of columns of squares.", 0, 4096}, s.columns);
    visit(Field{"rows", "1", "Number of rows of squares.", 0, 4096}, s.rows);
    visit(Field{"features", "1", "Features.", 0, 0, Field::none, 1 << 24}, s.features);
    visit(Field{"first", "1", "Index of the first feature of each class and square.", 0, 1 << 24, Field::none,
                1 << 24},
          s.first);
  }
};

/// Responses of the two filters, row by row with the image's stride; 0 within two pixels of its edges.
struct Responses {
  std::vector<std::int16_t> blob, corner;
};
Responses responses(const PaddedImage& image);

/// @param image  at full size
/// @pre   the spec's numbers lie in their ranges (check_ranges); the image's sides are 32 at least
FeatureSet find_features(const PaddedImage& image, const FeatureSpec& spec);

/// Sum of absolute differences, in [0, 8160].
inline int distance(const Feature& a, const Feature& b) {
  int sum = 0;
  for (std::size_t i = 0; i < 32; ++i) sum += std::abs(int{a.descriptor[i]} - int{b.descriptor[i]});
  return sum;
}

/// Whether the index and the places fit an image. False for a set from a damaged snapshot.
bool sound(const FeatureSet& set, const PaddedImage& image);

}  // namespace sandlot::navigation::vo
