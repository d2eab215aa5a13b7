// Motion from exact and from noisy places with ground in sight, and from images of a room along known ways.
#include "navigation/visual_odometry/mono_odometry.h"

#include <gtest/gtest.h>

#include "base/bytes.h"
#include "navigation/visual_odometry/test_drive.h"

namespace sandlot::navigation::vo {
namespace {

using test::Picture;

MonoSpec mono_small() {
  MonoSpec spec;
  spec.camera = {test::small_focal_px,           test::small_focal_px,  0.5 * (test::small_width - 1),
                 0.5 * (test::small_height - 1), test::camera_height_m, test::camera_pitch_rad};
  spec.matching.radius_px = 60;
  spec.matching.bucket_px = 32;
  spec.keyframe_motion_px = 8;
  return spec;
}

Picture mono_picture(const test::Scene& scene, const Pose& X_WS, double deviation = 0,
                     std::uint64_t seed = 0) {
  Picture out = scene.render(X_WS, test::small_width, test::small_height, test::small_focal_px);
  if (deviation > 0) test::add_noise(out, deviation, seed);
  return out;
}

/// Places of points by the camera's definition: `ground` of them on the ground, the others above it.
std::vector<FlowMatch> mono_matches(const MonoSpec& spec, int ground, int others, const Pose& X_W0,
                                    const Pose& X_W1, Stream& random) {
  std::vector<FlowMatch> out;
  const MonoCamera& c = spec.camera;
  const auto place = [&](const Pose& X_WS, Vec3 p_W) -> std::optional<Vec2> {
    const Vec3 p = inverse(X_WS) * p_W;
    const Vec2 at{c.cx_px - c.fx_px * p.y / p.x, c.cy_px - c.fy_px * p.z / p.x};
    if (p.x < 0.2 || std::abs(at.x - 160) > 160 || std::abs(at.y - 120) > 120) return std::nullopt;
    return at;
  };
  while (static_cast<int>(out.size()) < ground + others) {
    const bool low = static_cast<int>(out.size()) < ground;
    const Vec3 p = X_W0.p + Vec3{random.uniform(0.5, low ? 4 : 8), random.uniform(-4, 4),
                                 low ? -test::camera_height_m : random.uniform(-0.4, 2)};
    const auto a = place(X_W0, p), b = place(X_W1, p);
    if (a && b) out.push_back({*a, *b});
  }
  return out;
}

const Pose mono_from = test::camera_at(0, 0, 0);
Pose mono_to() { return test::camera_at(0.2, 0.03, 0.06); }

TEST(VoMonoMotion, ExactPlacesGiveTheExactMotion) {
  const MonoSpec spec = mono_small();
  Stream random(1, 2, Purpose::experiment, 3);
  for (const Pose& to : {mono_to(), test::camera_at(-0.2, 0, -0.05), test::camera_at(0, 0.25, 0)}) {
    const Pose X_KS = inverse(mono_from) * to;
    const auto matches = mono_matches(spec, 40, 60, mono_from, to, random);
    const MonoMotion motion = estimate_motion(spec, matches, {}, random);
    ASSERT_EQ(motion.outcome, Outcome::moved);
    EXPECT_EQ(motion.inliers.size(), 100u);
    EXPECT_NEAR(test::angle_between(motion.X_KS.q, X_KS.q), 0, 1e-6);
    EXPECT_NEAR(norm(normalised(motion.X_KS.p) - normalised(X_KS.p)), 0, 1e-5);
    // The scale is that of a peak of heights, to which points just above the ground belong.
    EXPECT_NEAR(norm(motion.X_KS.p), norm(X_KS.p), 0.01 * norm(X_KS.p));
    EXPECT_GE(motion.ground_points, 25);
  }
}

TEST(VoMonoMotion, ScaleIsThatOfTheHeight) {
  MonoSpec spec = mono_small();
  Stream random(1, 2, Purpose::experiment, 3);
  const auto matches = mono_matches(spec, 40, 60, mono_from, mono_to(), random);
  const double length = norm(estimate_motion(spec, matches, {}, random).X_KS.p);
  spec.camera.height_m *= 3;
  EXPECT_NEAR(norm(estimate_motion(spec, matches, {}, random).X_KS.p), 3 * length, 1e-6);
}

TEST(VoMonoMotion, OutliersDoNotCount) {
  const MonoSpec spec = mono_small();
  Stream random(5, 2, Purpose::experiment, 3);
  auto matches = mono_matches(spec, 60, 60, mono_from, mono_to(), random);
  for (std::size_t i = 0; i < matches.size(); i += 4) {
    matches[i].p1.x += i % 8 == 0 ? 9 : random.uniform(-30, 30);
    matches[i].p1.y += i % 8 == 0 ? -14 : random.uniform(-30, 30);
  }
  const MonoMotion motion = estimate_motion(spec, matches, {}, random);
  const Pose X_KS = inverse(mono_from) * mono_to();
  ASSERT_EQ(motion.outcome, Outcome::moved);
  EXPECT_NEAR(test::angle_between(motion.X_KS.q, X_KS.q), 0, 2e-3);
  EXPECT_NEAR(norm(motion.X_KS.p - X_KS.p), 0, 0.02 * norm(X_KS.p));
}

// As for stereo, with two directions and the turn only, whose errors are normal: 5 numbers, 5 +- 5 sqrt(10 / 300) = 5 +- 0.9. The
// scale's error is that of a mode: its share of the whole is bounded instead.
TEST(VoMonoMotion, CovarianceIsThatOfTheErrors) {
  MonoSpec spec = mono_small();
  spec.common_error_px = 0;
  const Pose X_KS = inverse(mono_from) * mono_to();
  double sum = 0, scale = 0;
  constexpr int runs = 300;
  for (std::uint64_t run = 0; run < runs; ++run) {
    Stream random(11, run, Purpose::experiment, 0);
    auto matches = mono_matches(spec, 60, 60, mono_from, mono_to(), random);
    for (FlowMatch& m : matches)
      for (Vec2* p : {&m.p0, &m.p1}) p->x += 0.1 * random.normal(), p->y += 0.1 * random.normal();
    const MonoMotion motion = estimate_motion(spec, matches, {}, random);
    ASSERT_EQ(motion.outcome, Outcome::moved);
    // With the true length, the error along the translation vanishes, and that direction adds next to nothing.
    Pose directed = motion.X_KS;
    directed.p = norm(X_KS.p) / norm(motion.X_KS.p) * motion.X_KS.p;
    sum += test::squared_error(motion.errors, test::error_of(directed, X_KS));
    const double relative = norm(motion.X_KS.p) / norm(X_KS.p) - 1;
    scale += relative * relative;
  }
  EXPECT_NEAR(sum / runs, 5, 1.2);
  EXPECT_LT(std::sqrt(scale / runs), 0.03);
}

TEST(VoMonoMotion, TurnsHaveNoTranslation) {
  const MonoSpec spec = mono_small();
  Stream random(7, 2, Purpose::experiment, 3);
  const Pose to = test::camera_at(0, 0, 0.12);
  auto matches = mono_matches(spec, 50, 50, mono_from, to, random);
  for (FlowMatch& m : matches) m.p1.x += 0.1 * random.normal(), m.p1.y += 0.1 * random.normal();
  const MonoMotion motion = estimate_motion(spec, matches, {}, random);
  ASSERT_EQ(motion.outcome, Outcome::turned);
  EXPECT_EQ(norm(motion.X_KS.p), 0);
  EXPECT_NEAR(test::angle_between(motion.X_KS.q, (inverse(mono_from) * to).q), 0, 1e-3);
  EXPECT_LT(motion.parallax_px, 0.5);
}

TEST(VoMonoMotion, OpenMotionsAreReported) {
  const MonoSpec spec = mono_small();
  Stream random(3, 2, Purpose::experiment, 3);
  const auto exact = mono_matches(spec, 40, 60, mono_from, mono_to(), random);
  EXPECT_EQ(estimate_motion(spec, {}, {}, random).outcome, Outcome::too_few_matches);
  EXPECT_EQ(estimate_motion(spec, std::span(exact).first(19), {}, random).outcome, Outcome::too_few_matches);
  auto wild = exact;
  for (FlowMatch& m : wild) m.p1.x += random.uniform(-50, 50), m.p1.y += random.uniform(-50, 50);
  EXPECT_EQ(estimate_motion(spec, wild, {}, random).outcome, Outcome::too_few_inliers);
  for (FlowMatch& m : wild) m.p1.x = std::nan("");
  EXPECT_FALSE(has_pose(estimate_motion(spec, wild, {}, random).outcome));
  auto alike = exact;
  for (FlowMatch& m : alike) m = exact.front();
  EXPECT_NE(estimate_motion(spec, alike, {}, random).outcome, Outcome::moved);
  // Nothing on the ground: heights of all sizes.
  const auto air = mono_matches(spec, 0, 60, mono_from, mono_to(), random);
  EXPECT_EQ(estimate_motion(spec, air, {}, random).outcome, Outcome::no_ground);
}

// Required: 5 % of the way.
TEST(VoMono, DriftAlongAnArc) {
  const MonoSpec spec = mono_small();
  const test::Scene scene;
  const std::vector<Pose> way = test::arc(28, 0.1, 0.03);
  MonoState state;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Step step = advance(spec, state, mono_picture(scene, way[i], 2, i).view());
    ASSERT_TRUE(i == 0 ? step.outcome == Outcome::first_image : has_pose(step.outcome))
        << i << name_of(step.outcome);
  }
  const Pose X_WS = pose_W(state.track), truth = inverse(way.front()) * way.back();
  EXPECT_LT(norm(X_WS.p - truth.p), 0.05 * test::path_length(way));
  EXPECT_LT(test::angle_between(X_WS.q, truth.q), 0.03);
  EXPECT_EQ(state.track.gaps, 0u);
  RecordProperty("drift_percent", std::to_string(100 * norm(X_WS.p - truth.p) / test::path_length(way)));
}

TEST(VoMono, TurningOnTheSpotAndStanding) {
  const MonoSpec spec = mono_small();
  const test::Scene scene;
  MonoState state;
  for (int i = 0; i < 8; ++i) {
    const Step step = advance(
        spec, state,
        mono_picture(scene, test::camera_at(-1, 0, 0.09 * std::min(i, 5)), 2, static_cast<std::uint64_t>(i))
            .view());
    if (i > 0) { ASSERT_EQ(step.outcome, Outcome::turned) << i; }
  }
  const Pose X_WS = pose_W(state.track),
             truth = inverse(test::camera_at(-1, 0, 0)) * test::camera_at(-1, 0, 0.45);
  EXPECT_EQ(norm(X_WS.p), 0);
  EXPECT_NEAR(test::angle_between(X_WS.q, truth.q), 0, 0.01);
  // Where it is has become unsure by what may be hidden in the parallax.
  EXPECT_GT(covariance_W(state.track)[0], 1e-4);
}

TEST(VoMono, BlindImagesLeaveThePose) {
  const MonoSpec spec = mono_small();
  const test::Scene scene;
  MonoState state;
  Picture noise(test::small_width, test::small_height, 128);
  test::add_noise(noise, 50, 7);
  const Picture dark(test::small_width, test::small_height);
  EXPECT_EQ(advance(spec, state, dark.view()).outcome, Outcome::too_few_features);
  EXPECT_EQ(advance(spec, state, mono_picture(scene, test::camera_at(-1, 0, 0)).view()).outcome,
            Outcome::first_image);
  EXPECT_EQ(advance(spec, state, mono_picture(scene, test::camera_at(-0.85, 0, 0)).view()).outcome,
            Outcome::moved);
  const Pose before = pose_W(state.track);
  EXPECT_EQ(advance(spec, state, dark.view()).outcome, Outcome::too_few_features);
  EXPECT_FALSE(has_pose(advance(spec, state, noise.view()).outcome));
  EXPECT_EQ(advance(spec, state, {}).outcome, Outcome::refused);
  EXPECT_EQ(state.track.gaps, 0u);
  EXPECT_TRUE(advance(spec, state, dark.view()).outcome == Outcome::too_few_features);
  Picture other(test::small_width, test::small_height, 128);
  test::add_noise(other, 50, 8);
  const Step lost = advance(spec, state, other.view());
  EXPECT_FALSE(has_pose(lost.outcome));
  EXPECT_TRUE(lost.gap);
  EXPECT_EQ(pose_W(state.track).p, before.p);
  EXPECT_NEAR(test::angle_between(pose_W(state.track).q, before.q), 0, 1e-12);
  EXPECT_GE(covariance_W(state.track)[35], unknown_variance);
  EXPECT_EQ(advance(spec, state, scene.render(test::camera_at(0, 0, 0), 160, 120, 87).view()).outcome,
            Outcome::size_changed);
}

TEST(VoMono, StateIsAllThereIs) {
  const MonoSpec spec = mono_small();
  const test::Scene scene;
  MonoState state, restored;
  advance(spec, state, mono_picture(scene, test::camera_at(-1, 0, 0)).view());
  MonoState copy = state;
  ByteWriter bytes;
  write(bytes, state);
  ByteReader reader(bytes.bytes());
  read(reader, restored);
  ASSERT_TRUE(reader.ok());
  const Picture next = mono_picture(scene, test::camera_at(-0.85, 0, 0.02));
  const auto end_of = [&](MonoState& from) {
    EXPECT_EQ(advance(spec, from, next.view()).outcome, Outcome::moved);
    ByteWriter out;
    write(out, from);
    return std::vector<std::byte>(out.bytes().begin(), out.bytes().end());
  };
  const auto expected = end_of(state);
  EXPECT_EQ(end_of(copy), expected);
  EXPECT_EQ(end_of(restored), expected);
}

TEST(VoMono, BadSpecsAreRefused) {
  EXPECT_TRUE(validate(MonoSpec{}));
  MonoSpec spec;
  spec.camera.height_m = -1;
  EXPECT_FALSE(validate(spec));
  spec = {};
  spec.min_parallax_px = std::nan("");
  EXPECT_FALSE(validate(spec));
  spec = {};
  spec.matching.radius_px = 5;
  EXPECT_FALSE(validate(spec));
}

TEST(SlowVoMono, DriftOfLongWays) {
  MonoSpec spec;
  spec.camera.pitch_rad = test::camera_pitch_rad;
  const test::Scene scene;
  for (const double turn : {0.08, -0.03}) {
    const std::vector<Pose> way = test::arc(turn > 0.05 ? 80 : 45, 0.1, turn);
    MonoState state;
    for (std::size_t i = 0; i < way.size(); ++i) {
      Picture picture = scene.render(way[i], 640, 480, 350);
      test::add_noise(picture, 3, i);
      const Step step = advance(spec, state, picture.view());
      ASSERT_TRUE(i == 0 || has_pose(step.outcome)) << i << name_of(step.outcome);
    }
    const Pose truth = inverse(way.front()) * way.back();
    const double drift = norm(pose_W(state.track).p - truth.p) / test::path_length(way);
    EXPECT_LT(drift, 0.05);
    RecordProperty(turn > 0.05 ? "circle_percent" : "arc_percent", std::to_string(100 * drift));
  }
}

}  // namespace
}  // namespace sandlot::navigation::vo
