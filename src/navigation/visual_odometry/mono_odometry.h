#pragma once
/// Mono odometry: motion of one camera from its images, with the scale from its height above flat ground.
///
///   MonoState state;
///   const Step step = advance(spec, state, image);
///   if (has_pose(step.outcome)) use(pose_W(state.track), covariance_W(state.track));
///
/// Method     features are matched back and forth with the keyframe's. Rotation and direction of the translation make the Sampson
///            distances from the epipolar lines least: Levenberg-Marquardt steps in samples of five (RANSAC), then over all
///            inliers. The points are triangulated; the height below the camera at which most of them lie is the ground's, and its
///            ratio to `height` the scale.
/// Parallax   without a median parallax of min_parallax the translation is not known: the image has the outcome `turned`, its
///            rotation is that which maps the directions best, and its position the keyframe's.
/// Frames     track.h; pixels as in image.h, the image rectified. The camera looks down by `pitch`, without roll.
/// Covariance inverse of the normal equations, times the mean square of the errors plus common_error^2 times the number of
///            inliers, as if all of them erred alike; of the scale by the scatter of the ground's
///            points. Of a position while `turned`: the translation that hides in min_parallax at five camera heights.
/// Keyframes  as in stereo_odometry.h, and when fewer than 3 min_ground_points are left. While `turned` only when flow exceeds half
///            of the matching's radius.
/// Errors     an Outcome; the pose changes with `moved` and `turned` only.
/// Limits     flat ground in sight, height and pitch constant: an error of 1 % in height or of 0.01 / tan(angle below the horizon)
///            rad in pitch is one of 1 % in each translation, and not in the covariance. Translations below min_parallax that end
///            in a new keyframe while the camera turns are lost. A scene of one plane has two solutions; the one with level
///            ground is not searched for, but the other has no ground in most cases.
/// Random     base/random.h, by (seed, number of the image).
/// Cost       16 ms for 640 x 480 pixels.
/// Source     essential matrix by five points: D. Nister, An efficient solution to the five-point relative pose problem (2004);
///            by steps in place of its polynomial: T. Botterill et al., Fast RANSAC hypothesis generation for essential matrix
///            estimation (2011). Scale: as in libviso2, A. Geiger et al. (2011); votes by relative height are ours.
#include "base/node.h"
#include "base/random.h"
#include "navigation/visual_odometry/keys.h"
#include "navigation/visual_odometry/matching.h"

namespace sandlot::navigation::vo {

struct MonoCamera : PinholeKeys {
  double height_m = 0.5, pitch_rad = 0.2;

  static void fields(auto& s, auto&& visit) {
    PinholeKeys::fields(s, visit);
    visit(Field{"height", "m", "Height above the ground.", 1e-3, 1e4}, s.height_m);
    visit(Field{"pitch", "rad", "Angle of the optical axis below the horizon.", -1.5, 1.5707963267948966},
          s.pitch_rad);
  }
};

struct MonoSpec : KeyframeKeys {
  MonoCamera camera;
  FeatureSpec features;
  MatchSpec matching;
  int ransac_iterations = 500;
  double inlier_px = 1, min_parallax_px = 2, least_noise_px = 0.05, common_error_px = 0.01;
  int min_inliers = 20, min_ground_points = 12;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"camera", "", "Rectified camera."}, s.camera);
    visit(Field{"features", "", "Features of an image."}, s.features);
    visit(Field{"matching", "", "Matches of features."}, s.matching);
    visit(Field{"ransac_iterations", "1", "Greatest number of samples of five points.", 1, 100000},
          s.ransac_iterations);
    visit(Field{"inlier", "px", "Sampson distance of inliers.", 0.01, 100}, s.inlier_px);
    visit(Field{"min_parallax", "px", "Median parallax from which a translation counts.", 0.01, 100},
          s.min_parallax_px);
    visit(Field{"least_noise", "px", "Least standard deviation that distances are taken to have.", 0.001, 10},
          s.least_noise_px);
    visit(
        Field{
            "common_error", "px",
            "Standard deviation of an error that all places share, of interpolation: more points do not make "
            "it less.",
            0, 10},
        s.common_error_px);
    visit(Field{"min_inliers", "1", "Least number of inliers.", 8, 100000}, s.min_inliers);
    visit(Field{"min_ground_points", "1", "Least number of points on the ground.", 3, 100000},
          s.min_ground_points);
    KeyframeKeys::fields(s, visit);
  }
  /// keyframe_motion lies within the matching's radius.
  Status check(const Node& node, const std::string& path) const;
};
/// Every range of the field lists, and check().
Status validate(const MonoSpec& spec);

struct MonoState {
  View keyframe;
  Track track;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"keyframe", "", "Image and features of the keyframe."}, s.keyframe);
    visit(Field{"track", "", "Pose of the camera."}, s.track);
  }
};

/// Takes the next image.
/// @pre  validate(spec) succeeds
Step advance(const MonoSpec& spec, MonoState& state, const GreyImage& image);

/// Motion from matches.
struct MonoMotion {
  /// moved, turned, too_few_matches, too_few_inliers, uncertain, no_ground
  Outcome outcome = Outcome::too_few_matches;
  Pose X_KS;
  Covariance errors{};                 ///< of X_KS
  std::vector<std::uint32_t> inliers;  ///< indices of matches
  double residual_px = 0, parallax_px = 0;
  int ground_points = 0;
};
/// @param guess  X_KS, where the search begins
/// @pre   validate(spec) succeeds
MonoMotion estimate_motion(const MonoSpec& spec, std::span<const FlowMatch> matches, const Pose& guess,
                           Stream& random);

}  // namespace sandlot::navigation::vo
