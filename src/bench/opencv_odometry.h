#pragma once
/// Stereo odometry as one writes it with OpenCV: corners followed by Lucas-Kanade from the left picture to the right one and to the next
/// left one, triangulated, PnP with RANSAC. Ours is judged by it, in speed here and in drift in tests/vision.
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>
#include <vector>

#include "navigation/visual_odometry/test_drive.h"

namespace sandlot::bench {

namespace vo = navigation::vo;

inline constexpr int odometry_width = 640, odometry_height = 480;
inline constexpr double odometry_focal_px = 350;

struct OdometryPair {
  vo::test::Picture left, right;
};
/// What a camera in test_scene.h's room sees.
/// @param number  of the pair, for its noise
inline OdometryPair odometry_pair(const Pose& X_WS, std::uint64_t number) {
  const vo::test::Scene scene;
  OdometryPair out{scene.render(X_WS, odometry_width, odometry_height, odometry_focal_px),
                   scene.render(vo::test::right_of(X_WS, vo::test::baseline_m), odometry_width,
                                odometry_height, odometry_focal_px)};
  vo::test::add_noise(out.left, 3, 2 * number);
  vo::test::add_noise(out.right, 3, 2 * number + 1);
  return out;
}

inline cv::Mat odometry_mat(vo::test::Picture& picture) {
  return {picture.height, picture.width, CV_8UC1, picture.pixels.data()};
}

/// Pose of S in that of the pair before, by OpenCV.
inline std::optional<Pose> opencv_motion(OdometryPair& before, OdometryPair& now) {
  const cv::Mat left0 = odometry_mat(before.left), right0 = odometry_mat(before.right),
                left1 = odometry_mat(now.left);
  const double cx = 0.5 * (odometry_width - 1), cy = 0.5 * (odometry_height - 1);
  std::vector<cv::Point2f> corners, right, next;
  cv::goodFeaturesToTrack(left0, corners, 600, 0.01, 10);
  if (corners.size() < 20) return std::nullopt;
  std::vector<std::uint8_t> found_right, found_next;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(left0, right0, corners, right, found_right, errors);
  cv::calcOpticalFlowPyrLK(left0, left1, corners, next, found_next, errors);
  std::vector<cv::Point3f> points;
  std::vector<cv::Point2f> places;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const float disparity = corners[i].x - right[i].x;
    if (!found_right[i] || !found_next[i] || disparity < 1 || std::abs(corners[i].y - right[i].y) > 1)
      continue;
    const double z = odometry_focal_px * vo::test::baseline_m / static_cast<double>(disparity);
    points.emplace_back(static_cast<float>((static_cast<double>(corners[i].x) - cx) * z / odometry_focal_px),
                        static_cast<float>((static_cast<double>(corners[i].y) - cy) * z / odometry_focal_px),
                        static_cast<float>(z));
    places.push_back(next[i]);
  }
  if (points.size() < 20) return std::nullopt;
  const cv::Matx33d K(odometry_focal_px, 0, cx, 0, odometry_focal_px, cy, 0, 0, 1);
  cv::Mat turn, translation, inliers;
  if (!cv::solvePnPRansac(points, places, K, cv::noArray(), turn, translation, false, 200, 2, 0.999, inliers))
    return std::nullopt;
  const auto axis = [](const cv::Mat& m) { return Vec3{m.at<double>(0), m.at<double>(1), m.at<double>(2)}; };
  const double angle = norm(axis(turn));
  const Pose X_10{axis(translation), quat_from_axis_angle(normalised(axis(turn)), angle)};
  const Pose X_S_optical{{}, vo::q_S_optical};
  return X_S_optical * inverse(X_10) * inverse(X_S_optical);
}

}  // namespace sandlot::bench
