#pragma once
/// Matches of features between images: in a circle of two stereo pairs, and back and forth between two images.
///
/// Circle     left 0 -> right 0 -> right 1 -> left 1 -> left 0, each step to the feature of the same class with the nearest
///            descriptor; kept when the circle ends where it began. Between left and right only within epipolar_px rows.
/// Outliers   a match of which fewer than two neighbours (of at least four) have about the same flow and disparity is dropped.
/// Buckets    of each square bucket_matches are kept, the strongest features first.
/// Places     refined (patch.h): the patch around the feature of left 0 is found in the other three images.
/// Limits     images are rectified: same rows, left and right. Flow up to radius_px, disparity up to max_disparity_px.
/// Cost       5 ms for 640 x 480 pixels and 400 matches, half of it refinement.
/// Source     A. Geiger, J. Ziegler, C. Stiller, StereoScan (2011), sec. III. There outliers are found by a triangulation.
#include <vector>

#include "navigation/visual_odometry/features.h"
#include "navigation/visual_odometry/patch.h"

namespace sandlot::navigation::vo {

struct MatchSpec {
  int radius_px = 100, max_disparity_px = 128, epipolar_px = 1;
  double outlier_px = 5;
  int bucket_px = 50, bucket_matches = 4;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"radius", "px", "Greatest flow along u and along v.", 1, 1000}, s.radius_px);
    visit(Field{"max_disparity", "px",
                "Greatest disparity: focal length times baseline over the least depth.", 1, 2000},
          s.max_disparity_px);
    visit(Field{"epipolar", "px", "Greatest difference of rows between left and right.", 0, 10},
          s.epipolar_px);
    visit(Field{"outlier", "px",
                "Difference of flow and of disparity, in addition to a fifth of them, up to which neighbours "
                "agree.",
                0.1, 100},
          s.outlier_px);
    visit(Field{"bucket", "px", "Side of the squares among which matches are distributed.", 8, 1000},
          s.bucket_px);
    visit(Field{"bucket_matches", "1", "Greatest number of matches in a square.", 1, 1000}, s.bucket_matches);
  }
};

/// Smoothed image, and the features of the image before.
struct View {
  PaddedImage image;
  FeatureSet features;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"image", "", "Smoothed image."}, s.image);
    visit(Field{"features", "", "Features of the image."}, s.features);
  }
};
/// @pre  check(image) succeeds, the spec's numbers lie in their ranges
View view_of(const GreyImage& image, const FeatureSpec& spec);
bool sound(const View& view);

struct StereoView {
  View left, right;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"left", "", "Image of the left camera."}, s.left);
    visit(Field{"right", "", "Image of the right camera."}, s.right);
  }
};

/// Places of a point, in pixels of the whole images.
struct FlowMatch {
  Vec2 p0, p1;
};
struct StereoMatch {
  Vec2 left0, right0, left1, right1;
};

/// @pre  images of the same size, features of the same spec; the spec's numbers lie in their ranges
std::vector<StereoMatch> match_circle(const StereoView& from, const StereoView& to, const MatchSpec& spec);
std::vector<FlowMatch> match_flow(const View& from, const View& to, const MatchSpec& spec);

}  // namespace sandlot::navigation::vo
