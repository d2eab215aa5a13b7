#pragma once
/// Pictures for the tests of vision: things put together in one statement, seen through a lens.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/math.h"
#include "optics/picture.h"

namespace sandlot::test {

/// From OpenCV's and ROS's optical frame (x right, y down, z forward) to S.
inline constexpr Quat q_S_optical{0.5, -0.5, 0.5, -0.5};

struct Studio {
  std::vector<optics::PictureShape> shapes;
  SceneFrame frame{.X_WG = {Pose{}}};
  optics::Surroundings surroundings{{0.75f, 0.8f, 0.85f, 1},
                                    {1, 1, 1, 1}};  ///< light from everywhere: colours as they are
  std::vector<optics::PictureLight> lights;
  optics::PictureScene scene;

  optics::PictureShape& add(Shape shape, Pose X_WC, Color color, std::uint32_t group = 0) {
    optics::PictureShape s;
    s.group = group;
    s.X_GC = X_WC;
    s.shape = std::move(shape);
    s.appearance.diffuse = color;
    s.instance = static_cast<std::uint32_t>(shapes.size() + 1);
    shapes.push_back(std::move(s));
    return shapes.back();
  }
  void ready() {
    scene.set_shapes(shapes);
    scene.set_lights(lights);
    scene.set_surroundings(surroundings);
    scene.update(frame);
  }
  struct Shot {
    cv::Mat rgb, gray, depth;  ///< 8UC3, 8UC1, 32FC1
  };
  /// @pre ready()
  Shot shoot(const optics::Lens& lens, const Pose& X_WS = {}, int samples = 4) {
    Shot shot{cv::Mat(lens.height, lens.width, CV_8UC3), {}, cv::Mat(lens.height, lens.width, CV_32FC1)};
    const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
    optics::PictureJob job;
    job.X_WS = X_WS;
    job.lens = optics::LensTable::make(lens);
    job.exposure.samples = samples;
    job.rgb = {shot.rgb.data, 3 * pixels};
    job.depth_m = {shot.depth.ptr<float>(), pixels};
    scene.render({&job, 1});
    cv::cvtColor(shot.rgb, shot.gray, cv::COLOR_RGB2GRAY);
    return shot;
  }
};

/// 10 x 7 squares of 30 mm with a white rim, in group `group`; frame K as OpenCV has it: corners at (30 mm i,
/// 30 mm j, 0), i < 9, j < 6.
inline void add_chessboard(Studio& studio, std::uint32_t group) {
  constexpr double side = 0.03;
  studio.add(Box{{0.42, 0.33, 0.01}}, {{0.12, 0.075, 0.00505}, {}}, {0.95f, 0.95f, 0.95f, 1}, group);
  for (int i = -1; i < 9; ++i)
    for (int j = -1; j < 6; ++j)
      if ((i + j) % 2 == 0)
        studio.add(Box{{side, side, 0.001}}, {{(i + 0.5) * side, (j + 0.5) * side, 0.0005}, {}},
                   {0.05f, 0.05f, 0.05f, 1}, group);
}
inline std::vector<cv::Point3f> chessboard_points() {
  std::vector<cv::Point3f> points;
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 9; ++i)
      points.emplace_back(0.03f * static_cast<float>(i), 0.03f * static_cast<float>(j), 0.0f);
  return points;
}
/// K such that the board's middle is at `p` and its axes are those of an image seen from S, turned by rpy
/// about S's axes.
inline Pose board_at(Vec3 p, Vec3 rpy) {
  const Pose X_WM{p, quat_from_rpy(rpy.x, rpy.y, rpy.z) * q_S_optical};
  return X_WM * Pose{{-0.12, -0.075, 0}, {}};
}

}  // namespace sandlot::test
