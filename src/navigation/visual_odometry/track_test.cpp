// Poses and covariances of a track, predicted by hand.
#include "navigation/visual_odometry/track.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "navigation/visual_odometry/sampling.h"
#include "navigation/visual_odometry/test_drive.h"

namespace sandlot::navigation::vo {
namespace {

Covariance diagonal(std::array<double, 6> variances) {
  Covariance out{};
  for (std::size_t i = 0; i < 6; ++i) out[7 * i] = variances[i];
  return out;
}

// B's heading has the variance 0.01; C lies 2 m ahead and looks to the left: C's x axis is B's y axis. A turn by a moves C by 2 a
// along it: variance 4 * 0.01, covariance with the heading 2 * 0.01.
TEST(VoTrack, LeverTurnsErrorsOfHeadingIntoErrorsOfPosition) {
  const Pose X_BC{{2, 0, 0}, quat_from_rpy(0, 0, math::pi / 2)};
  const Covariance C = composed(diagonal({0, 0, 0, 0, 0, 0.01}), X_BC, diagonal({0.1, 0.2, 0.3, 0, 0, 0}));
  Covariance expected = diagonal({0.1 + 0.04, 0.2, 0.3, 0, 0, 0.01});
  expected[5] = expected[30] = 0.02;
  for (std::size_t i = 0; i < 36; ++i) EXPECT_NEAR(C[i], expected[i], 1e-15) << i;
  // Roll of B at 2 m above: C moves along -y of B, that is -x of C.
  const Pose above{{0, 0, 2}, quat_from_rpy(0, 0, math::pi / 2)};
  const Covariance D = composed(diagonal({0, 0, 0, 0.01, 0, 0}), above, {});
  EXPECT_NEAR(D[0], 0.04, 1e-15);
  // B's x axis is C's -y axis: a turn of a about it is one of -a about C's y, and moves C's origin by -2 a along C's x.
  EXPECT_NEAR(D[4], 0.02, 1e-15);
  EXPECT_NEAR(D[28], 0.01, 1e-15);
}

// Pitch of B by a, 2 m below C: C moves by 2 a along B's x, which is C's -y; B's y is C's x.
TEST(VoTrack, LeverOfPitch) {
  const Pose above{{0, 0, 2}, quat_from_rpy(0, 0, math::pi / 2)};
  const Covariance C = composed(diagonal({0, 0, 0, 0, 0.01, 0}), above, {});
  EXPECT_NEAR(C[7], 0.04, 1e-15);
  EXPECT_NEAR(C[9], -0.02, 1e-15);
  EXPECT_NEAR(C[21], 0.01, 1e-15);
}

// Two keyframes and an image: poses multiply, errors of both add in W's axes.
TEST(VoTrack, PosesAndErrorsAccumulate) {
  Track track;
  Step step;
  const Pose ahead{{1, 0, 0}, quat_from_rpy(0, 0, math::pi / 2)};
  const Covariance errors = diagonal({1e-4, 4e-4, 9e-4, 0, 0, 0});
  enter_pose(track, ahead, errors, step);
  EXPECT_EQ(step.motion.p, ahead.p);
  EXPECT_EQ(step.motion_errors, errors);
  enter_keyframe(track, step);
  EXPECT_TRUE(step.keyframe);
  EXPECT_EQ(track.X_KS, Pose{});
  Step next;
  enter_pose(track, ahead, errors, next);
  const Pose X_WS = pose_W(track);
  EXPECT_NEAR(norm(X_WS.p - Vec3{1, 1, 0}), 0, 1e-12);
  EXPECT_NEAR(test::angle_between(X_WS.q, quat_from_rpy(0, 0, math::pi)), 0, 1e-7);
  // S's axes at the first keyframe: x is W's y. At the second one x is W's -x.
  const Covariance P = covariance_W(track);
  EXPECT_NEAR(P[0], 4e-4 + 1e-4, 1e-12);
  EXPECT_NEAR(P[7], 1e-4 + 4e-4, 1e-12);
  EXPECT_NEAR(P[14], 18e-4, 1e-12);
  // From the same keyframe again: the motion is the difference, its errors those of both images.
  Step last;
  enter_pose(track, {{1, 0.5, 0}, ahead.q}, errors, last);
  EXPECT_NEAR(norm(last.motion.p - Vec3{0.5, 0, 0}), 0, 1e-12);
  EXPECT_NEAR(last.motion_errors[0], 2e-4, 1e-12);
  EXPECT_NEAR(last.motion_errors[7], 8e-4, 1e-12);
}

// Ten images straight on by 0.1 m, keyframes or not: the variance of each axis is 10 * 0.1 k. Then ten turns of 0.1 rad on the spot:
// the heading has t, and what it was before stays.
TEST(VoTrack, GrowsWithTheWayAndTheTurn) {
  constexpr double k = 2e-3, t = 5e-3;
  for (const int images_per_keyframe : {1, 5, 100}) {
    Track track;
    int number = 0;
    const auto image = [&](const Pose& moved) {
      Step step;
      enter_pose(track, track.X_KS * moved, {}, step);
      grow(track, {k, t}, step);
      if (++number % images_per_keyframe == 0) enter_keyframe(track, step);
      return step;
    };
    Step step;
    for (int i = 0; i < 10; ++i) step = image({{0.1, 0, 0}, {}});
    EXPECT_NEAR(step.motion_errors[0], 0.1 * k, 1e-12);
    EXPECT_NEAR(step.motion_errors[35], 0, 1e-12);
    Covariance P = covariance_W(track);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(P[7 * i], k, 1e-12);
    EXPECT_NEAR(P[35], 0, 1e-12);
    for (int i = 0; i < 10; ++i) step = image({{}, quat_from_rpy(0, 0, 0.1)});
    EXPECT_NEAR(step.motion_errors[35], 0.1 * t, 1e-12);
    P = covariance_W(track);
    EXPECT_NEAR(P[35], t, 1e-12);
    EXPECT_NEAR(P[0], k, 1e-12);
    // Away from where it turned, the heading's error moves it across: by 1 m, t.
    image({{1, 0, 0}, {}});
    P = covariance_S(track);
    EXPECT_NEAR(P[0], 2 * k, 1e-12);
    EXPECT_NEAR(P[7], 2 * k + t, 1e-12);
    EXPECT_NEAR(P[35], t, 1e-12);
  }
}

TEST(VoTrack, GapsLeaveThePoseUnknown) {
  Track track;
  Step step;
  enter_pose(track, {{1, 2, 0}, {}}, diagonal({1, 1, 1, 1, 1, 1}), step);
  enter_gap(track, step);
  EXPECT_EQ(pose_W(track).p, (Vec3{1, 2, 0}));
  EXPECT_EQ(step.motion, Pose{});
  EXPECT_EQ(track.gaps, 1u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_GE(covariance_W(track)[7 * i], unknown_variance);
    EXPECT_EQ(step.motion_errors[7 * i], unknown_variance);
  }
}

// Samples of different indices, all of them drawn in time; the number of samples is ln 0.0001 / ln(1 - share^3).
TEST(VoTrack, Sampling) {
  Stream random(1, 2, Purpose::experiment, 3);
  std::array<int, 5> drawn{};
  for (int i = 0; i < 200; ++i) {
    std::array<std::uint32_t, 3> index{};
    draw_distinct(random, 5, index);
    EXPECT_TRUE(index[0] != index[1] && index[1] != index[2] && index[0] != index[2]);
    for (const std::uint32_t k : index) ++drawn[k];
  }
  for (const int count : drawn) EXPECT_NEAR(count, 120, 35);  // 5 sqrt(200 * 0.6 * 0.4)
  const auto samples = [](double share) {
    RansacEnd end(3, 20, 1000);
    int count = 0;
    while (end.another())
      if (++count == 5) end.found(share);
    return count;
  };
  EXPECT_EQ(samples(1), 20);
  EXPECT_EQ(samples(0.5), 69);  // 9.21 / 0.1335 = 68.97
  EXPECT_EQ(samples(0.01), 1000);
  std::vector<double> values{5, 1, 4, 2};
  EXPECT_EQ(median(values), 4);
}

}  // namespace
}  // namespace sandlot::navigation::vo
