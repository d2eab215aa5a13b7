#pragma once
/// Track: pose of a camera accumulated over keyframes, with its covariance.
///
/// Frames     S: x forward along the optical axis, y left, z up, at the (left) camera's centre. W is S at the first image, K is S
///            at the keyframe, P is S at the last image before this one that had a pose.
/// Covariance 6 x 6, row by row, order x y z rx ry rz. Errors are small displacements and turns of S about its own axes:
///            X_true = X * Exp(error). In W's axes for covariance_W.
/// Keyframes  images are compared with the keyframe, so that a robot that stands does not drift: errors accumulate with
///            keyframes, not with images.
/// Growth     what errors of the points do not tell, above all wrong calibration: variances that grow with the way and the turn
///            (Growth), which keyframes do not take back.
/// Gap        a new keyframe without a motion from the old one: the pose stays, its variances become unknown_variance.
#include <array>
#include <cstdint>

#include "base/fields.h"
#include "geometry/pose.h"

namespace sandlot::navigation::vo {

using Covariance = std::array<double, 36>;
/// Variance of what is not known, [m^2] or [rad^2], as in viso2_ros.
inline constexpr double unknown_variance = 9999;

/// Errors that all points of an image have in common, as a random walk. Defaults are for a calibration whose scale is wrong by 0.4 %, which
/// on a way of 40 m is as much as the walk's sqrt(7e-4 * 40) = 0.17 m, and by 0.7 % in a turn of 360 degrees, sqrt(3e-4 * 2 pi) =
/// 2.5 degrees: a rotation of one eye by 0.02 degrees shifts disparities by 0.12 pixels of some 14 at 3 m.
struct Growth {
  double distance_variance = 7e-4;  ///< [m^2/m]
  double turn_variance = 3e-4;      ///< [rad^2/rad]

  static void fields(auto& s, auto&& visit) {
    visit(
        Field{"distance_variance", "m^2/m", "Variance of the position along each axis per distance.", 0, 100},
        s.distance_variance);
    visit(Field{"turn_variance", "rad^2/rad", "Variance of the turn about each axis per turn.", 0, 100},
          s.turn_variance);
  }
};

/// Answer to an image.
enum class Outcome : std::uint8_t {
  first_image,  ///< became the first keyframe
  moved,        ///< has a pose
  turned,  ///< mono: too little parallax for a translation; has an orientation, the position is the keyframe's
  too_few_features,  ///< is dark, uniform or blurred
  too_few_matches,   ///< has nothing in common with the keyframe
  too_few_inliers,   ///< has matches that do not agree about one motion
  uncertain,         ///< has matches that leave the motion open, such as all far away
  no_ground,         ///< mono: no ground at the camera's height, so no scale
  size_changed,      ///< has another size: became the keyframe, after a gap
  refused,           ///< does not fit its own size, or is too small or too large (check() tells why)
};
inline constexpr std::size_t outcomes = 10;
inline std::span<const EnumName<Outcome>> enum_names(Outcome) {
  static constexpr EnumName<Outcome> names[] = {{"first_image", Outcome::first_image},
                                                {"moved", Outcome::moved},
                                                {"turned", Outcome::turned},
                                                {"too_few_features", Outcome::too_few_features},
                                                {"too_few_matches", Outcome::too_few_matches},
                                                {"too_few_inliers", Outcome::too_few_inliers},
                                                {"uncertain", Outcome::uncertain},
                                                {"no_ground", Outcome::no_ground},
                                                {"size_changed", Outcome::size_changed},
                                                {"refused", Outcome::refused}};
  return names;
}
/// Whether an image has a pose.
constexpr bool has_pose(Outcome outcome) { return outcome == Outcome::moved || outcome == Outcome::turned; }

/// State of a track.
struct Track {
  Pose motion;                             ///< from the image with a pose before the last one to it
  Pose X_WK, X_KS;                         ///< X_KS of the last image with a pose
  Covariance keyframe_errors{}, errors{};  ///< of X_WK and X_KS
  Covariance drift{};                      ///< of X_WS, by growth
  std::uint64_t images = 0, keyframes = 0, gaps = 0;
  std::uint32_t failures_in_row = 0;             ///< images without a pose since the last one with one
  std::uint32_t keyframe_inliers = 0;            ///< of the first image after the keyframe; 0: none yet
  std::array<std::uint64_t, outcomes> counts{};  ///< of each Outcome

  static void fields(auto& s, auto&& visit) {
    visit(Field{"motion", "", "Motion between the last two images with a pose."}, s.motion);
    visit(Field{"keyframe", "", "Pose of the keyframe in W."}, s.X_WK);
    visit(Field{"from_keyframe", "", "Pose of the last image in the keyframe."}, s.X_KS);
    visit(Field{"keyframe_errors", "", "Covariance of the keyframe's pose."}, s.keyframe_errors);
    visit(Field{"errors", "", "Covariance of the last image's pose in the keyframe."}, s.errors);
    visit(Field{"drift", "", "What of the last image's covariance grew with the way."}, s.drift);
    visit(Field{"images", "1", "Number of images."}, s.images);
    visit(Field{"keyframes", "1", "Number of keyframes."}, s.keyframes);
    visit(Field{"gaps", "1", "Number of keyframes without a motion from the one before."}, s.gaps);
    visit(Field{"failures", "1", "Number of images in a row without a pose."}, s.failures_in_row);
    visit(Field{"keyframe_inliers", "1", "Number of inliers of the first image after the keyframe."},
          s.keyframe_inliers);
    visit(Field{"counts", "1", "Number of images with each outcome."}, s.counts);
  }
};

/// What an image changed.
struct Step {
  Outcome outcome = Outcome::refused;
  bool keyframe = false;  ///< the image became the keyframe
  bool gap = false;       ///< ... without a motion from the one before
  int features = 0, matches = 0, inliers = 0;
  double residual_px = 0;  ///< standard deviation of places in an image, by the inliers
  /// X_PS and its covariance; with a gap the identity and unknown variances. The errors of P and S are taken as independent:
  /// the keyframe's part, which they share, is counted twice.
  Pose motion;
  Covariance motion_errors{};
};

Pose pose_W(const Track& track);
/// Covariance of pose_W in the axes of S.
Covariance covariance_S(const Track& track);
/// Covariance of pose_W: positions in W's axes, turns about W's axes, as in nav_msgs/Odometry.
Covariance covariance_W(const Track& track);

/// Covariance of X_AC = X_AB * X_BC from those of its factors, independent.
Covariance composed(const Covariance& AB, const Pose& X_BC, const Covariance& BC);

/// Angle and length of a motion make the track and the step less sure; after enter_pose.
void grow(Track& track, const Growth& growth, Step& step);
/// Enters the pose of an image in the keyframe; fills the step's motion.
void enter_pose(Track& track, const Pose& X_KS, const Covariance& errors, Step& step);
/// The last image with a pose becomes the keyframe.
void enter_keyframe(Track& track, Step& step);
/// The present image becomes the keyframe though it has no pose.
void enter_gap(Track& track, Step& step);

/// Rotation of the optical frame (x right, y down, z forward) in S.
inline constexpr Quat q_S_optical{0.5, -0.5, 0.5, -0.5};

}  // namespace sandlot::navigation::vo
