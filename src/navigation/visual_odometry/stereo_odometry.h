#pragma once
/// Stereo odometry: motion of a stereo camera from its images.
///
///   const StereoSpec spec = ...;                     // read_spec<StereoSpec>(node), or validate(spec)
///   StereoState state;
///   const Step step = advance(spec, state, left, right);
///   if (has_pose(step.outcome)) use(pose_W(state.track), covariance_W(state.track));
///
/// Method     features are matched in a circle with the keyframe's (matching.h). Its points are triangulated (depth = fx b / d);
///            the motion minimises their reprojection errors in both images: Gauss-Newton steps in samples of three (RANSAC; the
///            motion before, continued, takes part and needs to be beaten by a tenth), then over all inliers, each error weighted by its covariance, the triangulated point's part included. Points are
///            inliers within 4.3 standard deviations, estimated from the median error.
/// Frames     track.h; pixels as in image.h, images rectified: fx, fy, cx, cy hold for both, the right camera is baseline_m to
///            the right of the left one.
/// Covariance inverse of the normal equations, times the mean square of the weighted errors plus common_error^2 times the number
///            of inliers, as if all of them erred alike.
/// Keyframes  a new one when the median flow exceeds keyframe_motion, or the inliers become fewer than keyframe_share of those of
///            the keyframe's first image; after `patience` images in a row without a pose too, which is a gap.
/// Errors     an Outcome; the pose changes with `moved` only. Robust to dark, uniform, noisy images and to other sizes.
/// Limits     most of the matches are on what stands still. Errors common to all points, by wrong calibration, rolling shutter,
///            exposure blur, are in the covariance as `growth` alone, a random walk. No loop closure, no bundle adjustment.
/// Random     base/random.h, by (seed, number of the image).
/// Cost       15 to 19 ms for two images of 640 x 480 pixels, more than half of it features.
/// Source     A. Geiger, J. Ziegler, C. Stiller, StereoScan (2011), sec. IV; defaults in part as in its libviso2. Weights: first
///            order propagation, L. Matthies, S. Shafer, Error modeling in stereo navigation (1987).
#include "base/node.h"
#include "base/random.h"
#include "navigation/visual_odometry/keys.h"
#include "navigation/visual_odometry/matching.h"

namespace sandlot::navigation::vo {

struct StereoCamera : PinholeKeys {
  double baseline_m = 0.12;

  static void fields(auto& s, auto&& visit) {
    PinholeKeys::fields(s, visit);
    visit(Field{"baseline", "m", "Distance of the cameras: -P[3] / P[0] of the right camera's CameraInfo.",
                1e-4, 100},
          s.baseline_m);
  }
};

struct StereoSpec : KeyframeKeys {
  StereoCamera camera;
  FeatureSpec features;
  MatchSpec matching;
  int ransac_iterations = 200;
  double inlier_px = 2, min_disparity_px = 1, least_noise_px = 0.05, common_error_px = 0.01;
  int min_inliers = 12;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"camera", "", "Rectified stereo camera."}, s.camera);
    visit(Field{"features", "", "Features of an image."}, s.features);
    visit(Field{"matching", "", "Matches of features."}, s.matching);
    visit(Field{"ransac_iterations", "1", "Greatest number of samples of three points.", 1, 100000},
          s.ransac_iterations);
    visit(Field{"inlier", "px", "Reprojection error of inliers, in each image.", 0.01, 100}, s.inlier_px);
    visit(Field{"min_disparity", "px", "Disparity below which points are not used.", 0.01, 100},
          s.min_disparity_px);
    visit(Field{"least_noise", "px", "Least standard deviation that places in images are taken to have.",
                0.001, 10},
          s.least_noise_px);
    visit(
        Field{
            "common_error", "px",
            "Standard deviation of an error that all places share, of interpolation: more points do not make "
            "it less.",
            0, 10},
        s.common_error_px);
    visit(Field{"min_inliers", "1", "Least number of inliers.", 6, 100000}, s.min_inliers);
    KeyframeKeys::fields(s, visit);
  }
  /// keyframe_motion lies within the matching's radius.
  Status check(const Node& node, const std::string& path) const;
};
/// Every range of the field lists, and check().
Status validate(const StereoSpec& spec);

struct StereoState {
  StereoView keyframe;
  Track track;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"keyframe", "", "Images and features of the keyframe."}, s.keyframe);
    visit(Field{"track", "", "Pose of the camera."}, s.track);
  }
};

/// Takes the next pair of images.
/// @pre  validate(spec) succeeds
Step advance(const StereoSpec& spec, StereoState& state, const GreyImage& left, const GreyImage& right);

/// Motion from matches.
struct StereoMotion {
  Outcome outcome = Outcome::too_few_matches;  ///< moved, too_few_matches, too_few_inliers, uncertain
  Pose X_KS;
  Covariance errors{};                 ///< of X_KS
  int matches = 0;                     ///< with enough disparity
  std::vector<std::uint32_t> inliers;  ///< indices of matches
  double residual_px = 0;
};
/// @param guess  X_KS, where the search begins
/// @pre   validate(spec) succeeds
StereoMotion estimate_motion(const StereoSpec& spec, std::span<const StereoMatch> matches, const Pose& guess,
                             Stream& random);

}  // namespace sandlot::navigation::vo
