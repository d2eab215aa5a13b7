#pragma once
/// Keys that the stereo and the mono odometry share.
#include <cstdint>

#include "navigation/visual_odometry/track.h"

namespace sandlot::navigation::vo {

/// Of a rectified camera.
struct PinholeKeys {
  double fx_px = 350, fy_px = 350, cx_px = 319.5, cy_px = 239.5;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"fx", "px", "Focal length along u: P[0] of CameraInfo.", 1, 1e5}, s.fx_px);
    visit(Field{"fy", "px", "Focal length along v: P[5] of CameraInfo.", 1, 1e5}, s.fy_px);
    visit(Field{"cx", "px", "Column of the optical axis: P[2] of CameraInfo.", -1e5, 1e5}, s.cx_px);
    visit(Field{"cy", "px", "Row of the optical axis: P[6] of CameraInfo.", -1e5, 1e5}, s.cy_px);
  }
};

/// What makes a motion certain, and an image the keyframe.
struct KeyframeKeys {
  double min_inlier_share = 0.35, max_position_deviation_m = 0.2;
  double keyframe_motion_px = 15, keyframe_share = 0.6;
  int patience = 2;
  Growth growth;
  std::uint64_t seed = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"min_inlier_share", "1", "Least share of the matches that are inliers.", 0, 1},
          s.min_inlier_share);
    visit(Field{"max_position_deviation", "m",
                "Standard deviation of a motion's translation above which it is uncertain.", 1e-6, 1e6},
          s.max_position_deviation_m);
    visit(Field{"keyframe_motion", "px", "Median flow after which an image becomes the keyframe.", 0, 1000},
          s.keyframe_motion_px);
    visit(Field{"keyframe_share", "1",
                "Share of the keyframe's first inliers below which an image becomes the keyframe.", 0, 1},
          s.keyframe_share);
    visit(Field{"patience", "1", "Images in a row without a pose after which one becomes the keyframe.", 0,
                1000},
          s.patience);
    visit(Field{"growth", "", "Errors that all points have in common, such as those of calibration."},
          s.growth);
    visit(Field{"seed", "1", "Seed of the random samples.", 0, 9007199254740992.0}, s.seed);
  }
};

}  // namespace sandlot::navigation::vo
