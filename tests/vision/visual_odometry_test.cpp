/// Stereo odometry judged by OpenCV: corners followed by Lucas-Kanade, triangulated, PnP with RANSAC, on the same images.
#include <gtest/gtest.h>

#include "bench/opencv_odometry.h"
#include "navigation/visual_odometry/stereo_odometry.h"

namespace sandlot::test {
namespace {

namespace vo = navigation::vo;
using bench::odometry_pair;
using bench::OdometryPair;
using bench::opencv_motion;

// The same images for both: ours drifts at most 2 % of the way, and not a fifth more than OpenCV's where that is worse than 0.5 %.
TEST(SlowVisionOdometry, DriftsNoMoreThanOpenCvs) {
  vo::StereoSpec spec;
  for (const double turn : {0.06, -0.03}) {
    const std::vector<Pose> way = vo::test::arc(50, 0.1, turn);
    vo::StereoState state;
    Pose X_W_opencv;
    OdometryPair before;
    for (std::size_t i = 0; i < way.size(); ++i) {
      OdometryPair now = odometry_pair(way[i], i);
      vo::advance(spec, state, now.left.view(), now.right.view());
      if (i > 0) {
        const auto motion = opencv_motion(before, now);
        ASSERT_TRUE(motion);
        X_W_opencv = X_W_opencv * *motion;
      }
      before = std::move(now);
    }
    const Pose truth = inverse(way.front()) * way.back();
    const double length = vo::test::path_length(way),
                 ours = norm(vo::pose_W(state.track).p - truth.p) / length,
                 opencvs = norm(X_W_opencv.p - truth.p) / length;
    RecordProperty(turn > 0 ? "ours_left_percent" : "ours_right_percent", std::to_string(100 * ours));
    RecordProperty(turn > 0 ? "opencv_left_percent" : "opencv_right_percent", std::to_string(100 * opencvs));
    EXPECT_LT(ours, 0.02);
    EXPECT_LT(ours, std::max(1.2 * opencvs, 0.005)) << opencvs;
    EXPECT_LT(opencvs, 0.1);  // it does its work
  }
}

}  // namespace
}  // namespace sandlot::test
