// Motion from exact and from noisy places, and from images of a room along known ways.
#include "navigation/visual_odometry/stereo_odometry.h"

#include <gtest/gtest.h>

#include "base/bytes.h"
#include "base/node.h"
#include "base/read.h"
#include "navigation/visual_odometry/test_drive.h"

namespace sandlot::navigation::vo {
namespace {

using test::Picture;

StereoSpec stereo_small() {
  StereoSpec spec;
  spec.camera = {test::small_focal_px, test::small_focal_px, 0.5 * (test::small_width - 1),
                 0.5 * (test::small_height - 1), test::baseline_m};
  spec.matching.radius_px = 60;
  spec.matching.max_disparity_px = 64;
  spec.matching.bucket_px = 32;
  spec.keyframe_motion_px = 8;
  spec.growth = {0, 0};  // the scenes' cameras are exactly known
  return spec;
}

struct StereoPictures {
  Picture left, right;
};
StereoPictures pictures_at(const test::Scene& scene, const Pose& X_WS) {
  return {scene.render(X_WS, test::small_width, test::small_height, test::small_focal_px),
          scene.render(test::right_of(X_WS, test::baseline_m), test::small_width, test::small_height,
                       test::small_focal_px)};
}
StereoPictures noisy(StereoPictures pictures, double deviation, std::uint64_t seed) {
  test::add_noise(pictures.left, deviation, 2 * seed);
  test::add_noise(pictures.right, deviation, 2 * seed + 1);
  return pictures;
}
Step advance(const StereoSpec& spec, StereoState& state, const StereoPictures& pictures) {
  return advance(spec, state, pictures.left.view(), pictures.right.view());
}

/// Places of points of the world in both images, by the camera's definition; points behind a camera are left out.
std::vector<StereoMatch> exact_matches(const StereoSpec& spec, int count, const Pose& X_KS, Stream& random) {
  std::vector<StereoMatch> out;
  const StereoCamera& c = spec.camera;
  const auto place = [&](const Pose& X_WS, Vec3 p_W) {
    const Vec3 p = inverse(X_WS) * p_W;
    return Vec2{c.cx_px - c.fx_px * p.y / p.x, c.cy_px - c.fy_px * p.z / p.x};
  };
  while (static_cast<int>(out.size()) < count) {
    const double x = random.uniform(1, 8);
    const Vec3 p{x, random.uniform(-0.8, 0.8) * x, random.uniform(-0.6, 0.6) * x};
    if ((inverse(X_KS) * p).x < 0.3) continue;
    const Pose right{{0, -c.baseline_m, 0}, {}};
    out.push_back({place({}, p), place(right, p), place(X_KS, p), place(X_KS * right, p)});
  }
  return out;
}

Pose some_motion() { return {{0.21, -0.04, 0.03}, quat_from_rpy(0.02, -0.03, 0.11)}; }

// The places are exact: the motion is found but for rounding, from the identity.
TEST(VoStereoMotion, ExactPlacesGiveTheExactMotion) {
  const StereoSpec spec = stereo_small();
  Stream random(1, 2, Purpose::experiment, 3);
  for (const Pose& X_KS : {Pose{}, some_motion(), Pose{{-0.3, 0.2, 0}, quat_from_rpy(0, 0, -0.3)}}) {
    const auto matches = exact_matches(spec, 60, X_KS, random);
    const StereoMotion motion = estimate_motion(spec, matches, {}, random);
    ASSERT_EQ(motion.outcome, Outcome::moved);
    EXPECT_EQ(motion.inliers.size(), 60u);
    EXPECT_NEAR(norm(motion.X_KS.p - X_KS.p), 0, 1e-9);
    EXPECT_NEAR(test::angle_between(motion.X_KS.q, X_KS.q), 0, 1e-9);
    // Places are taken to have an error of 0.05 px at least, for the covariance.
    EXPECT_EQ(motion.residual_px, 0.05);
    EXPECT_GT(motion.errors[0], 0);
  }
}

// Different focal lengths and a middle that is not in the middle: axes must not be mixed up.
TEST(VoStereoMotion, EveryNumberOfTheCameraCounts) {
  StereoSpec spec = stereo_small();
  spec.camera = {200, 150, 100, 140, 0.3};
  Stream random(4, 2, Purpose::experiment, 3);
  const auto matches = exact_matches(spec, 60, some_motion(), random);
  const StereoMotion motion = estimate_motion(spec, matches, {}, random);
  ASSERT_EQ(motion.outcome, Outcome::moved);
  EXPECT_NEAR(norm(motion.X_KS.p - some_motion().p), 0, 1e-9);
  EXPECT_NEAR(test::angle_between(motion.X_KS.q, some_motion().q), 0, 1e-9);
}

// 40 % of the points move otherwise, half of them together: as a moving object does.
TEST(VoStereoMotion, OutliersDoNotCount) {
  const StereoSpec spec = stereo_small();
  Stream random(2, 2, Purpose::experiment, 3);
  auto matches = exact_matches(spec, 100, some_motion(), random);
  for (std::size_t i = 0; i < 40; ++i) {
    matches[i].left1.x += i < 20 ? 12 : random.uniform(-30, 30);
    matches[i].right1.x += i < 20 ? 12 : random.uniform(-30, 30);
    matches[i].left1.y += i < 20 ? -5 : random.uniform(-30, 30);
    matches[i].right1.y += i < 20 ? -5 : random.uniform(-30, 30);
  }
  const StereoMotion motion = estimate_motion(spec, matches, {}, random);
  ASSERT_EQ(motion.outcome, Outcome::moved);
  EXPECT_GE(motion.inliers.size(), 60u);
  EXPECT_LE(motion.inliers.size(), 62u);  // an outlier may fit by accident
  EXPECT_NEAR(norm(motion.X_KS.p - some_motion().p), 0, 1e-3);
}

// Normal errors of all places: the normalised squared error of 6 numbers is chi-square, so the mean of 300 runs lies in
// 6 +- 5 sqrt(2 * 6 / 300) = 6 +- 1. The noise is estimated from 4 * 80 - 6 numbers, which adds 2 / 314 of it.
TEST(VoStereoMotion, CovarianceIsThatOfTheErrors) {
  StereoSpec spec = stereo_small();
  spec.common_error_px = 0;
  for (const double noise_px : {0.15, 0.4}) {
    double sum = 0, residual = 0;
    constexpr int runs = 300;
    for (std::uint64_t run = 0; run < runs; ++run) {
      Stream random(11, run, Purpose::experiment, 0);
      auto matches = exact_matches(spec, 80, some_motion(), random);
      for (StereoMatch& m : matches) {
        for (Vec2* p : {&m.left0, &m.right0, &m.left1, &m.right1}) {
          p->x += noise_px * random.normal();
          p->y += noise_px * random.normal();
        }
      }
      const StereoMotion motion = estimate_motion(spec, matches, {}, random);
      ASSERT_EQ(motion.outcome, Outcome::moved);
      sum += test::squared_error(motion.errors, test::error_of(motion.X_KS, some_motion()));
      residual += motion.residual_px;
    }
    EXPECT_NEAR(sum / runs, 6, 1.1) << noise_px;
    EXPECT_NEAR(residual / runs, noise_px, 0.03 * noise_px);
  }
}

TEST(VoStereoMotion, OpenMotionsAreReported) {
  StereoSpec spec = stereo_small();
  Stream random(3, 2, Purpose::experiment, 3);
  const auto exact = exact_matches(spec, 60, some_motion(), random);
  EXPECT_EQ(estimate_motion(spec, {}, {}, random).outcome, Outcome::too_few_matches);
  EXPECT_EQ(estimate_motion(spec, std::span(exact).first(11), {}, random).outcome, Outcome::too_few_matches);
  // Without disparity nothing has a depth.
  auto far = exact;
  for (StereoMatch& m : far) m.right0 = m.left0, m.right1 = m.left1;
  EXPECT_EQ(estimate_motion(spec, far, {}, random).outcome, Outcome::too_few_matches);
  auto wild = exact;
  for (StereoMatch& m : wild)
    m.left1.x += random.uniform(-50, 0), m.right1.x += random.uniform(-50, 0),
        m.left1.y += random.uniform(-50, 50);
  EXPECT_EQ(estimate_motion(spec, wild, {}, random).outcome, Outcome::too_few_inliers);
  for (StereoMatch& m : wild) m.left1.x = std::nan("");
  EXPECT_NE(estimate_motion(spec, wild, {}, random).outcome, Outcome::moved);
  auto alike = exact;
  for (StereoMatch& m : alike) m = exact.front();
  EXPECT_NE(estimate_motion(spec, alike, {}, random).outcome, Outcome::moved);
  // With errors of 0.05 px the translation is known to millimetres: that is not enough when the limit is 10 micrometres.
  spec.max_position_deviation_m = 1e-5;
  EXPECT_EQ(estimate_motion(spec, exact, {}, random).outcome, Outcome::uncertain);
}

// Required: 2 % of the way.
TEST(VoStereo, DriftAlongAnArc) {
  const StereoSpec spec = stereo_small();
  const test::Scene scene;
  const std::vector<Pose> way = test::arc(28, 0.1, 0.03);
  StereoState state;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Step step = advance(spec, state, noisy(pictures_at(scene, way[i]), 2, i));
    ASSERT_EQ(step.outcome, i == 0 ? Outcome::first_image : Outcome::moved) << i;
    if (i == 0) continue;
    const Pose X_PS = inverse(way[i - 1]) * way[i];
    EXPECT_NEAR(norm(step.motion.p - X_PS.p), 0, 0.02);
    EXPECT_NEAR(test::angle_between(step.motion.q, X_PS.q), 0, 0.006);
  }
  const Pose X_WS = pose_W(state.track), truth = inverse(way.front()) * way.back();
  EXPECT_LT(norm(X_WS.p - truth.p), 0.02 * test::path_length(way));
  EXPECT_LT(test::angle_between(X_WS.q, truth.q), 0.02);
  EXPECT_GT(state.track.keyframes, 3u);
  EXPECT_EQ(state.track.gaps, 0u);
  EXPECT_EQ(state.track.counts[static_cast<std::size_t>(Outcome::moved)], way.size() - 1);
  RecordProperty("drift_percent", std::to_string(100 * norm(X_WS.p - truth.p) / test::path_length(way)));
  // The error lies within four standard deviations, and these are small.
  const Covariance P = covariance_W(state.track);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs((X_WS.p - truth.p)[i]), 4 * std::sqrt(P[7 * i]) + 1e-9);
    EXPECT_LT(std::sqrt(P[7 * i]), 0.1);
  }
}

TEST(VoStereo, TurningOnTheSpot) {
  const StereoSpec spec = stereo_small();
  const test::Scene scene;
  StereoState state;
  for (int i = 0; i < 8; ++i) {
    const Step step = advance(spec, state, pictures_at(scene, test::camera_at(-1, 0, 0.09 * i)));
    ASSERT_NE(i > 0, step.outcome == Outcome::first_image);
    ASSERT_TRUE(i == 0 || step.outcome == Outcome::moved);
  }
  const Pose X_WS = pose_W(state.track),
             truth = inverse(test::camera_at(-1, 0, 0)) * test::camera_at(-1, 0, 0.63);
  EXPECT_NEAR(norm(X_WS.p), 0, 0.01);
  EXPECT_NEAR(test::angle_between(X_WS.q, truth.q), 0, 0.004);
}

// Every image has noise of its own. Without keyframes the position would walk: it stays within the error of one comparison.
TEST(VoStereo, StandingDoesNotDrift) {
  const StereoSpec spec = stereo_small();
  const StereoPictures still = pictures_at({}, test::camera_at(-1, 0, 0.2));
  StereoState state;
  double farthest = 0, first_variance = 0;
  for (std::uint64_t i = 0; i < 25; ++i) {
    const Step step = advance(spec, state, noisy(still, 4, i));
    if (i == 0) continue;
    ASSERT_EQ(step.outcome, Outcome::moved);
    farthest = std::max(farthest, norm(pose_W(state.track).p));
    const double variance = covariance_W(state.track)[0];
    if (i == 1) first_variance = variance;
    EXPECT_LT(variance, 2 * first_variance);
  }
  EXPECT_EQ(state.track.keyframes, 1u);
  EXPECT_LT(farthest, 6 * std::sqrt(3 * first_variance));
  EXPECT_LT(farthest, 0.005);
}

// A board of a fifth of the image moves aside by 6 cm per image; the camera goes ahead.
TEST(VoStereo, MovingObjectIsNotFollowed) {
  const StereoSpec spec = stereo_small();
  test::Scene scene;
  // At 2 m the image is 3.7 m wide and 2.7 m high: 1.4 m by 1.4 m is a fifth.
  scene.board = test::Board{.x = 1, .y0 = -0.9, .y1 = 0.5, .z0 = 0, .z1 = 1.4};
  StereoState state;
  Pose first, last;
  for (int i = 0; i < 6; ++i) {
    last = test::camera_at(-1 + 0.05 * i, 0, 0);
    if (i == 0) first = last;
    const Step step = advance(spec, state, pictures_at(scene, last));
    ASSERT_TRUE(i == 0 || step.outcome == Outcome::moved);
    scene.board->y0 += 0.06, scene.board->y1 += 0.06, scene.board->texture_y += 0.06;
  }
  EXPECT_NEAR(norm(pose_W(state.track).p - (inverse(first) * last).p), 0, 0.01);
}

// Images with noise of their own each time, rendered once: e^T P^-1 e of the motion. For 60 runs the mean of chi-square with 6
// degrees of freedom is in 6 +- 5 sqrt(12 / 60) = 6 +- 2.2. Half more above for what is the same in every run: the textures' own
// errors, of perspective within patches.
TEST(VoStereo, CovarianceIsConsistentWithNoiseOfImages) {
  const StereoSpec spec = stereo_small();
  const Pose X_W0 = test::camera_at(-1, 0, 0.1), X_W1 = test::camera_at(-0.96, 0.01, 0.11);
  const StereoPictures a = pictures_at({}, X_W0), b = pictures_at({}, X_W1);
  double sum = 0;
  constexpr int runs = 60;
  for (std::uint64_t run = 0; run < runs; ++run) {
    StereoState state;
    advance(spec, state, noisy(a, 5, 1000 + 2 * run));
    const Step step = advance(spec, state, noisy(b, 5, 1001 + 2 * run));
    ASSERT_EQ(step.outcome, Outcome::moved);
    sum += test::squared_error(step.motion_errors, test::error_of(step.motion, inverse(X_W0) * X_W1));
  }
  RecordProperty("nees", std::to_string(sum / runs));
  EXPECT_GT(sum / runs, 6 - 2.2);
  EXPECT_LT(sum / runs, 1.5 * 6 + 2.2);
}

TEST(VoStereo, BlindImagesLeaveThePose) {
  const StereoSpec spec = stereo_small();
  const std::vector<Pose> way = test::arc(4, 0.05, 0);
  const StereoPictures begin = pictures_at({}, way[0]), next = pictures_at({}, way[1]),
                       last = pictures_at({}, way[2]);
  StereoPictures noise{Picture(test::small_width, test::small_height, 128),
                       Picture(test::small_width, test::small_height, 128)};
  noise = noisy(noise, 50, 7);
  const StereoPictures dark{Picture(test::small_width, test::small_height),
                            Picture(test::small_width, test::small_height)};
  test::Scene dim;
  dim.brightness = 0.02;

  StereoState state;
  EXPECT_EQ(advance(spec, state, dark).outcome, Outcome::too_few_features);
  EXPECT_EQ(advance(spec, state, begin).outcome, Outcome::first_image);
  EXPECT_EQ(advance(spec, state, next).outcome, Outcome::moved);
  const Pose before = pose_W(state.track);
  const Covariance sure = covariance_W(state.track);
  EXPECT_EQ(advance(spec, state, dark).outcome, Outcome::too_few_features);
  EXPECT_EQ(advance(spec, state, pictures_at(dim, way[1])).outcome, Outcome::too_few_features);
  const Step lost = advance(spec, state, noise);
  EXPECT_TRUE(lost.outcome == Outcome::too_few_matches || lost.outcome == Outcome::too_few_inliers);
  // The third failure in a row: the keyframe goes, and what was between is not known.
  EXPECT_TRUE(lost.gap);
  EXPECT_EQ(pose_W(state.track).p, before.p);
  EXPECT_NEAR(test::angle_between(pose_W(state.track).q, before.q), 0, 1e-12);
  EXPECT_GE(covariance_W(state.track)[0], sure[0] + 0.99 * unknown_variance);
  EXPECT_GE(lost.motion_errors[35], 0.99 * unknown_variance);
  EXPECT_EQ(state.track.gaps, 1u);
  // From the noise there is no way back but another gap.
  EXPECT_NE(advance(spec, state, last).outcome, Outcome::moved);
  EXPECT_EQ(pose_W(state.track).p, before.p);
  EXPECT_NEAR(test::angle_between(pose_W(state.track).q, before.q), 0, 1e-12);
}

// A blink: two dark images and one of noise do not lose the way when patience is greater.
TEST(VoStereo, BlinkIsBridged) {
  StereoSpec spec = stereo_small();
  spec.patience = 5;
  const std::vector<Pose> way = test::arc(3, 0.05, 0);
  StereoState state;
  advance(spec, state, pictures_at({}, way[0]));
  StereoPictures noise{Picture(test::small_width, test::small_height, 128),
                       Picture(test::small_width, test::small_height, 128)};
  noise = noisy(noise, 50, 7);
  for (int i = 0; i < 3; ++i) EXPECT_NE(advance(spec, state, noise).outcome, Outcome::moved);
  const Step step = advance(spec, state, pictures_at({}, way[2]));
  EXPECT_EQ(step.outcome, Outcome::moved);
  EXPECT_FALSE(step.gap);
  EXPECT_NEAR(norm(pose_W(state.track).p - (inverse(way[0]) * way[2]).p), 0, 0.005);
}

TEST(VoStereo, OtherSizesAndBadImages) {
  const StereoSpec spec = stereo_small();
  const test::Scene scene;
  const Pose at = test::camera_at(-1, 0, 0);
  const StereoPictures good = pictures_at(scene, at);
  StereoState state;
  EXPECT_EQ(advance(spec, state, good.left.view(), {}).outcome, Outcome::refused);
  EXPECT_EQ(state.track.images, 1u);
  EXPECT_EQ(advance(spec, state, good).outcome, Outcome::first_image);
  EXPECT_EQ(advance(spec, state, good).outcome, Outcome::moved);
  const Picture smaller = scene.render(at, 160, 120, 87);
  EXPECT_EQ(advance(spec, state, good.left.view(), smaller.view()).outcome, Outcome::refused);
  GreyImage cut = good.left.view();
  cut.pixels = cut.pixels.first(1000);
  EXPECT_EQ(advance(spec, state, cut, cut).outcome, Outcome::refused);
  const Step step = advance(spec, state, smaller.view(), smaller.view());
  EXPECT_EQ(step.outcome, Outcome::size_changed);
  EXPECT_TRUE(step.gap && step.keyframe);
  EXPECT_EQ(state.track.gaps, 1u);
  EXPECT_EQ(state.track.counts[static_cast<std::size_t>(Outcome::refused)], 3u);
  EXPECT_EQ(state.track.images, 6u);
}

// The same images give the same bits; a copy, and one through bytes, go on as the original does.
TEST(VoStereo, StateIsAllThereIs) {
  const StereoSpec spec = stereo_small();
  const std::vector<Pose> way = test::arc(3, 0.08, 0.05);
  std::vector<StereoPictures> images;
  for (const Pose& X_WS : way) images.push_back(pictures_at({}, X_WS));
  StereoState state;
  advance(spec, state, images[0]);
  advance(spec, state, images[1]);
  StereoState copy = state, restored;
  ByteWriter bytes;
  write(bytes, state);
  ByteReader reader(bytes.bytes());
  read(reader, restored);
  ASSERT_TRUE(reader.ok());
  const auto end_of = [&](StereoState& from) {
    advance(spec, from, images[2]);
    ByteWriter out;
    write(out, from);
    return std::vector<std::byte>(out.bytes().begin(), out.bytes().end());
  };
  const auto expected = end_of(state);
  EXPECT_EQ(end_of(copy), expected);
  EXPECT_EQ(end_of(restored), expected);
  // A damaged keyframe counts as lost.
  StereoState damaged = copy;
  damaged.keyframe.left.image.width = 100000;
  EXPECT_EQ(advance(spec, damaged, images[2]).outcome, Outcome::size_changed);
}

TEST(VoStereo, BadSpecsAreRefused) {
  EXPECT_TRUE(validate(StereoSpec{}));
  const auto broken = [](auto&& change) {
    StereoSpec spec;
    change(spec);
    return validate(spec) ? std::string() : validate(spec).error().text();
  };
  EXPECT_NE(broken([](StereoSpec& s) { s.camera.fx_px = std::nan(""); }).find("fx"), std::string::npos);
  EXPECT_NE(broken([](StereoSpec& s) { s.camera.baseline_m = 0; }).find("baseline"), std::string::npos);
  EXPECT_NE(broken([](StereoSpec& s) { s.inlier_px = -1; }).find("inlier"), std::string::npos);
  EXPECT_NE(broken([](StereoSpec& s) { s.features.threshold = 0; }).find("threshold"), std::string::npos);
  EXPECT_NE(broken([](StereoSpec& s) { s.matching.radius_px = 10; }).find("keyframe_motion"),
            std::string::npos);
}

// The whole way at full size, both turns, several seeds: figures for the docs.
TEST(SlowVoStereo, DriftOfLongWays) {
  StereoSpec spec;
  const test::Scene scene;
  for (const double turn : {0.08, -0.03}) {
    const std::vector<Pose> way = test::arc(turn > 0.05 ? 80 : 45, 0.1, turn);
    for (const bool half : {false, true}) {
      spec.features.half_resolution = half;
      StereoState state;
      for (std::size_t i = 0; i < way.size(); ++i) {
        StereoPictures pair{scene.render(way[i], 640, 480, 350),
                            scene.render(test::right_of(way[i], 0.12), 640, 480, 350)};
        const Step step = advance(spec, state, noisy(std::move(pair), 3, i));
        ASSERT_EQ(step.outcome, i == 0 ? Outcome::first_image : Outcome::moved) << i;
      }
      const Pose truth = inverse(way.front()) * way.back();
      const double drift = norm(pose_W(state.track).p - truth.p) / test::path_length(way);
      EXPECT_LT(drift, 0.02);
      RecordProperty((turn > 0.05 ? "circle" : "arc") + std::string(half ? "_half" : "") + "_percent",
                     std::to_string(100 * drift));
    }
  }
}

}  // namespace
}  // namespace sandlot::navigation::vo
