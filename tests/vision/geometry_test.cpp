/// Geometry of pictures, judged by software that was written for real cameras: OpenCV.
#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/video/tracking.hpp>

#include "base/random.h"
#include "devices/cameras/camera_lens.h"
#include "perception/camera_model.h"
#include "studio.h"

namespace sandlot::test {
namespace {

using optics::Fisheye;
using optics::Lens;
using optics::Pinhole;

constexpr double degree = math::pi / 180;
constexpr Pinhole bent{
    .fx = 420, .fy = 424, .cx = 236, .cy = 183, .k1 = -0.25, .k2 = 0.08, .p1 = 0.001, .p2 = -0.0015};

cv::Matx33d matrix(const Lens& lens) {
  const auto k = optics::intrinsics(lens);
  return {k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7], k[8]};
}
cv::Vec3d optical(Vec3 v_S) {
  const Vec3 v = rotate_inverse(q_S_optical, v_S);
  return {v.x, v.y, v.z};
}
double median(std::vector<double> of) {
  std::nth_element(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2), of.end());
  return of[of.size() / 2];
}

/// A wall of coloured tiles at random depths, as something to look at.
void add_clutter(Studio& studio, double from_m, double to_m, int tiles, double spread,
                 bool speckled = false) {
  Stream random(7, 8, Purpose::noise, 9);
  std::vector<std::uint8_t> speckles(std::size_t{3} * 256 * 256);
  for (std::uint8_t& s : speckles) s = static_cast<std::uint8_t>(90 + 165 * random.uniform());
  const auto texture = optics::Texture::make(256, 256, speckles);
  optics::PictureShape& wall = studio.add(Box{{0.1, 6, 6}}, {{to_m + 0.5, 0, 0}, {}}, {0.7f, 0.7f, 0.7f, 1});
  if (speckled) wall.appearance.texture = texture;
  const auto small = optics::Texture::make(24, 24, std::span(speckles).first(std::size_t{3} * 24 * 24));
  for (int i = 0; i < tiles; ++i) {
    const double depth = from_m + (to_m - from_m) * random.uniform();
    const double y = spread * depth * (random.uniform() - 0.5),
                 z = 0.75 * spread * depth * (random.uniform() - 0.5);
    const double size = depth * (0.02 + 0.08 * random.uniform());
    const auto shade = [&] { return static_cast<float>(0.1 + 0.9 * random.uniform()); };
    const float r = shade(), g = shade(), b = shade();
    optics::PictureShape& tile = studio.add(Box{{0.02, size, size * 0.8}},
                                            {{depth, y, z}, quat_from_rpy(math::pi * random.uniform(), 0, 0)},
                                            {r, g, b, 1});
    if (speckled) tile.appearance.texture = small;
  }
}

TEST(SlowVision, ChessboardsGiveTheIntrinsicsBack) {
  const Lens lens{480, 360, bent};
  Studio studio;
  add_chessboard(studio, 0);
  studio.ready();
  std::vector<std::vector<cv::Point3f>> world;
  std::vector<std::vector<cv::Point2f>> seen;
  const Vec3 places[] = {{0.5, 0.06, 0.02},   {0.55, -0.08, 0.05}, {0.6, 0.12, -0.06},  {0.5, 0, 0},
                         {0.52, -0.1, -0.06}, {0.55, 0.05, 0.07},  {0.45, 0.03, -0.02}, {0.6, -0.14, 0.09}};
  const Vec3 turns[] = {{0, 0.5, 0.3},     {0.3, -0.4, 0.5}, {-0.4, 0.3, -0.6}, {1.5, 0.6, 0.1},
                        {0.1, -0.6, -0.3}, {-1.4, 0.1, 0.6}, {0.2, 0.05, -0.5}, {0.6, 0.4, 0.4}};
  std::vector<double> off;
  int boards = 0;
  for (int i = 0; i < 8; ++i) {
    studio.frame.X_WG[0] = board_at(places[i], turns[i]);
    studio.scene.update(studio.frame);
    std::vector<cv::Point2f> corners;
    const Studio::Shot shot = studio.shoot(lens, {}, 4);
    if (!cv::findChessboardCorners(shot.gray, {9, 6}, corners)) continue;
    cv::cornerSubPix(shot.gray, corners, {4, 4}, {-1, -1},
                     {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 40, 1e-3});
    // Where the board's pose puts each corner: within a tenth of a pixel.
    bool turned = false;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const cv::Point3f p = chessboard_points()[k];
      const auto at = *optics::project(lens, studio.frame.X_WG[0] * Vec3{p.x, p.y, 0});
      if (k == 0)
        turned = cv::norm(corners[0] - cv::Point2f(static_cast<float>(at[0]), static_cast<float>(at[1]))) > 5;
      const cv::Point2f c = corners[turned ? corners.size() - 1 - k : k];
      off.push_back(math::hypot(c.x - at[0], c.y - at[1]));
    }
    world.push_back(chessboard_points());
    seen.push_back(corners);
    ++boards;
  }
  ASSERT_GE(boards, 7);
  EXPECT_LT(median(off), 0.1);
  EXPECT_LT(*std::max_element(off.begin(), off.end()), 0.5);
  cv::Mat k, d;
  std::vector<cv::Mat> r, t;
  const double rms = cv::calibrateCamera(world, seen, {480, 360}, k, d, r, t, cv::CALIB_FIX_K3);
  EXPECT_LT(rms, 0.15);
  EXPECT_NEAR(k.at<double>(0, 0), bent.fx, 0.005 * bent.fx);
  EXPECT_NEAR(k.at<double>(1, 1), bent.fy, 0.005 * bent.fy);
  EXPECT_NEAR(k.at<double>(0, 2), bent.cx, 0.005 * 480);
  EXPECT_NEAR(k.at<double>(1, 2), bent.cy, 0.005 * 480);
  EXPECT_NEAR(d.at<double>(0), bent.k1, 0.02);
}

TEST(Vision, AChessboardsPoseIsFound) {
  const Lens lens{480, 360, bent};
  Studio studio;
  add_chessboard(studio, 0);
  studio.frame.X_WG[0] = board_at({0.6, 0.05, -0.03}, {0.2, 0.4, -0.3});
  studio.ready();
  std::vector<cv::Point2f> corners;
  const Studio::Shot shot = studio.shoot(lens, {}, 9);
  ASSERT_TRUE(cv::findChessboardCorners(shot.gray, {9, 6}, corners));
  cv::cornerSubPix(shot.gray, corners, {4, 4}, {-1, -1},
                   {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 40, 1e-3});
  const auto first = *optics::project(lens, studio.frame.X_WG[0].p);
  if (math::hypot(corners[0].x - first[0], corners[0].y - first[1]) > 5)
    std::reverse(corners.begin(), corners.end());
  cv::Vec3d turn, place;
  ASSERT_TRUE(cv::solvePnP(chessboard_points(), corners, matrix(lens),
                           cv::Vec<double, 5>{bent.k1, bent.k2, bent.p1, bent.p2, 0}, turn, place));
  // 54 corners, each known to 0.1 px of 420: across the view 0.6 m * 0.1 / 420 = 0.14 mm each; along it the
  // board's size, 0.27 m, is known to 0.2 mm, which is 0.5 mm in 0.6 m; its tilt to about 0.2 mm / 0.13 m.
  const cv::Vec3d p = optical(studio.frame.X_WG[0].p);
  EXPECT_NEAR(place[0], p[0], 0.0005);
  EXPECT_NEAR(place[1], p[1], 0.0005);
  EXPECT_NEAR(place[2], p[2], 0.002);
  cv::Matx33d found;
  cv::Rodrigues(turn, found);
  const Quat q = conjugate(q_S_optical) * studio.frame.X_WG[0].q;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 wanted = rotate(q, {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0});
    EXPECT_NEAR(found(0, axis), wanted.x, 0.005);
    EXPECT_NEAR(found(1, axis), wanted.y, 0.005);
    EXPECT_NEAR(found(2, axis), wanted.z, 0.005);
  }
}

TEST(Vision, LensesProjectAsOpencvDoes) {
  const Lens pinhole{480, 360, bent};
  const Fisheye kb{.mapping = Fisheye::Mapping::kannala_brandt,
                   .fx = 150,
                   .fy = 151,
                   .cx = 240,
                   .cy = 178,
                   .k1 = 0.02,
                   .k2 = -0.01,
                   .k3 = 0.003,
                   .k4 = -0.0005};
  const Lens fisheye{480, 360, kb};
  Stream random(1, 2, Purpose::noise, 3);
  std::vector<cv::Vec3d> points;
  std::vector<Vec3> points_S;
  for (int i = 0; i < 200; ++i) {
    const Vec3 p{1 + random.uniform(), 1.2 * (random.uniform() - 0.5), 0.9 * (random.uniform() - 0.5)};
    points_S.push_back(p);
    points.push_back(optical(p));
  }
  std::vector<cv::Vec2d> plain, round;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix(pinhole),
                    cv::Vec<double, 5>{bent.k1, bent.k2, bent.p1, bent.p2, 0}, plain);
  cv::fisheye::projectPoints(points, round, cv::Vec3d(), cv::Vec3d(), matrix(fisheye),
                             cv::Vec4d{kb.k1, kb.k2, kb.k3, kb.k4});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto a = optics::project(pinhole, points_S[i]), b = optics::project(fisheye, points_S[i]);
    ASSERT_TRUE(a && b);
    EXPECT_NEAR((*a)[0], plain[i][0], 1e-8);
    EXPECT_NEAR((*a)[1], plain[i][1], 1e-8);
    EXPECT_NEAR((*b)[0], round[i][0], 1e-8);
    EXPECT_NEAR((*b)[1], round[i][1], 1e-8);
  }
  // And back: OpenCV's own inverses stop after a few steps, some 1e-4 short.
  std::vector<cv::Vec2d> straight;
  cv::fisheye::undistortPoints(round, straight, matrix(fisheye), cv::Vec4d{kb.k1, kb.k2, kb.k3, kb.k4});
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(straight[i][0], points[i][0] / points[i][2], 1e-3);
    EXPECT_NEAR(straight[i][1], points[i][1] / points[i][2], 1e-3);
  }
}

TEST(Vision, RobotsReadCameraInfoAsTheSimulatorMeansIt) {
  // perception/ knows nothing of optics/: every lens means the same ray to both.
  const double a = std::sqrt(233.3) * 5e-3, b = std::sqrt(1135.7) * 5e-3;
  using optics::Catadioptric;
  std::vector<Lens> lenses{
      {480, 360, bent},
      *optics::omni_that_fills(300, 300, {.a_m = a, .b_m = b, .rim_m = 0.05}),
      *optics::omni_that_fills(300, 300,
                               {.mirror = Catadioptric::Mirror::parabolic, .a_m = 0.03, .rim_m = 0.05}),
      *optics::omni_that_fills(
          300, 300, {.mirror = Catadioptric::Mirror::spherical, .a_m = 0.05, .b_m = 0.2, .rim_m = 0.045})};
  for (const auto mapping : {Fisheye::Mapping::equidistant, Fisheye::Mapping::equisolid,
                             Fisheye::Mapping::stereographic, Fisheye::Mapping::orthographic})
    lenses.push_back(*optics::fisheye_of_fov(320, 240, 150 * degree, mapping));
  for (const Lens& lens : lenses) {
    msg::CameraInfo info;
    cameras::fill_info(info, lens, "eye");
    SCOPED_TRACE(info.distortion_model);
    const auto model = perception::CameraModel::of(info);
    ASSERT_TRUE(model);
    int both = 0;
    for (int v = 0; v < lens.height; v += 13)
      for (int u = 0; u < lens.width; u += 13) {
        const auto ours = optics::ray_through(lens, u, v);
        const auto theirs = model->ray(u, v);
        if (!ours || !theirs) continue;  // at the rim one may see what the other does not
        ++both;
        EXPECT_NEAR(norm(ours->direction - theirs->direction), 0, 1e-8) << u << " " << v;
        // The simulator's begins on the mirror: the same line.
        EXPECT_NEAR(norm(cross(ours->origin - theirs->origin, ours->direction)), 0, 1e-9) << u << " " << v;
      }
    EXPECT_GT(both, lens.width * lens.height / 169 / 2);
  }
}

TEST(Vision, UndistortedPicturesAreThoseOfAStraightLens) {
  const Lens lens{320, 240, Pinhole{.fx = 250, .fy = 250, .cx = 159.5, .cy = 119.5, .k1 = -0.3, .k2 = 0.1}};
  const Lens straight{320, 240, Pinhole{.fx = 250, .fy = 250, .cx = 159.5, .cy = 119.5}};
  Studio studio;
  add_clutter(studio, 2, 2.2, 150, 1.6);
  studio.ready();
  cv::Mat undone;
  cv::undistort(studio.shoot(lens, {}, 9).gray, undone, matrix(lens), cv::Vec4d{-0.3, 0.1, 0, 0});
  const cv::Mat plain = studio.shoot(straight, {}, 9).gray;
  // What differs is the blur of undistort's interpolation at edges, on few pixels. A shift by one pixel
  // differs much more.
  const cv::Rect middle(40, 30, 240, 180);
  const double difference = cv::mean(
      cv::abs(cv::Mat(undone(middle) - plain(middle)) + cv::Mat(plain(middle) - undone(middle))))[0];
  const double shifted = cv::mean(cv::abs(cv::Mat(plain(middle) - plain(middle + cv::Point(1, 0))) +
                                          cv::Mat(plain(middle + cv::Point(1, 0)) - plain(middle))))[0];
  EXPECT_LT(difference, 0.35 * shifted);
}

TEST(Vision, TrackedFeaturesMoveAsTheCameraDoes) {
  const Lens lens{320, 240, Pinhole{.fx = 260, .fy = 260, .cx = 159.5, .cy = 119.5}};
  Studio studio;
  add_clutter(studio, 1.5, 4, 250, 1.4);
  studio.ready();
  const Studio::Shot before = studio.shoot(lens, {}, 9);
  const Pose X_WS{{0.02, 0.03, -0.01}, quat_from_rpy(0.01, -0.005, 0.012)};
  const Studio::Shot after = studio.shoot(lens, X_WS, 9);
  std::vector<cv::Point2f> from, to;
  cv::goodFeaturesToTrack(before.gray, from, 200, 0.02, 6);
  ASSERT_GT(from.size(), 100u);
  std::vector<unsigned char> found;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(before.gray, after.gray, from, to, found, error, {13, 13}, 3);
  std::vector<double> off, way;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!found[i]) continue;
    // A corner lies on the nearest surface about it: the frontmost depth of its neighbours.
    float depth = 1e9f;
    const int u = static_cast<int>(std::lround(from[i].x)), v = static_cast<int>(std::lround(from[i].y));
    if (u < 2 || v < 2 || u > 317 || v > 237) continue;
    for (int dv = -2; dv <= 2; ++dv)
      for (int du = -2; du <= 2; ++du) depth = std::min(depth, before.depth.at<float>(v + dv, u + du));
    const auto ray = optics::ray_through(lens, from[i].x, from[i].y);
    const Vec3 point = (static_cast<double>(depth) / ray->direction.x) * ray->direction;
    const auto at = optics::project(lens, inverse(X_WS) * point);
    ASSERT_TRUE(at);
    off.push_back(math::hypot(to[i].x - (*at)[0], to[i].y - (*at)[1]));
    way.push_back(math::hypot(to[i].x - from[i].x, to[i].y - from[i].y));
  }
  ASSERT_GT(off.size(), 100u);
  EXPECT_GT(median(way), 2);
  // Corners where a near edge crosses a far one move as neither does: the median and three quarters are
  // asked.
  EXPECT_LT(median(off), 0.2);
  EXPECT_GT(std::count_if(off.begin(), off.end(), [](double x) { return x < 0.7; }),
            0.75 * static_cast<double>(off.size()));
}

TEST(Vision, StereoGivesTheDepthThatIsThere) {
  const Lens lens{320, 240, Pinhole{.fx = 260, .fy = 260, .cx = 159.5, .cy = 119.5}};
  constexpr double baseline = 0.12;
  Studio studio;
  add_clutter(studio, 1.2, 4, 60, 1.4, true);
  studio.ready();
  const Studio::Shot left = studio.shoot(lens), right = studio.shoot(lens, {{0, -baseline, 0}, {}});
  const auto matcher = cv::StereoSGBM::create(0, 48, 5, 200, 800, 1, 0, 10, 50, 2);
  cv::Mat disparity;
  matcher->compute(left.gray, right.gray, disparity);
  std::vector<double> off;
  int right_ones = 0;
  for (int v = 10; v < 230; ++v)
    for (int u = 50; u < 310; ++u) {
      const int raw = disparity.at<std::int16_t>(v, u);
      if (raw <= 0) continue;
      // depth = f baseline / disparity; compared in disparity, whose error does not grow with the distance.
      const double wanted = 260 * baseline / static_cast<double>(left.depth.at<float>(v, u));
      off.push_back(std::abs(raw / 16.0 - wanted));
      right_ones += off.back() < 1 ? 1 : 0;
    }
  EXPECT_GT(off.size(), 0.6 * 220 * 260);
  EXPECT_LT(median(off), 0.25);
  EXPECT_GT(right_ones, 0.85 * static_cast<double>(off.size()));
}

}  // namespace
}  // namespace sandlot::test
