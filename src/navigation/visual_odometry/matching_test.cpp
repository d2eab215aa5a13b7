// Places of patches and matches in images with known shifts.
#include "navigation/visual_odometry/matching.h"

#include <gtest/gtest.h>

#include <cmath>

#include <map>

#include "base/math.h"
#include "navigation/visual_odometry/test_scene.h"

namespace sandlot::navigation::vo {
namespace {

using test::Picture;

/// Waves of random direction, 5 to 25 pixels long, so that any shift is exact: pixel (u, v) shows the place (u - shift).
Picture waves(int width, int height, Vec2 shift, std::uint64_t seed, double brightness = 0) {
  struct Wave {
    double ku, kv, phase, strength;
  };
  std::vector<Wave> all;
  Stream random(seed, 1, Purpose::noise, 0);
  for (int i = 0; i < 14; ++i) {
    const double length = random.uniform(5, 25), angle = random.uniform(0, math::tau);
    all.push_back({math::tau / length * math::cos(angle), math::tau / length * math::sin(angle),
                   random.uniform(0, math::tau), 13});
  }
  Picture out(width, height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      double sum = 120 + brightness;
      for (const Wave& w : all)
        sum += w.strength * math::sin(w.ku * (u - shift.x) + w.kv * (v - shift.y) + w.phase);
      out.at(u, v) = static_cast<std::uint8_t>(std::min(std::max(sum + 0.5, 0.0), 255.0));
    }
  return out;
}

PaddedImage image_of(const Picture& picture) { return padded(picture.view()); }

// What is left is the bilinear interpolation's error: for waves of length L at half a pixel their amplitude shrinks by
// 1 - cos(pi / L), which is symmetric; 0.03 px is a third of the required tenth.
TEST(VoPatch, FindsShiftsToATenthOfAPixel) {
  const PaddedImage still = image_of(waves(60, 50, {}, 1));
  const auto patch = Patch::of(still, 30, 25);
  ASSERT_TRUE(patch);
  for (const Vec2 shift :
       {Vec2{0, 0}, Vec2{0.5, 0.5}, Vec2{0.3, -0.7}, Vec2{-1.2, 0.9}, Vec2{0.1, 0.1}, Vec2{1.5, -1.5}}) {
    const auto found = patch->find(image_of(waves(60, 50, shift, 1, 25)), {30, 25}, 2);
    ASSERT_TRUE(found) << shift.x << " " << shift.y;
    EXPECT_NEAR(found->x, 30 + shift.x, 0.03);
    EXPECT_NEAR(found->y, 25 + shift.y, 0.03);
  }
}

// With noise of standard deviation s in both images the error has the covariance 2 s^2 H^-1, H the scatter of the gradients.
TEST(VoPatch, NoiseGivesTheErrorOfTheGradients) {
  const Picture still = waves(60, 50, {}, 2), moved = waves(60, 50, {0.4, 0.2}, 2);
  double uu = 0, uv = 0, vv = 0, su = 0, sv = 0;
  Picture copy = still;
  for (int v = 20; v <= 30; ++v)
    for (int u = 25; u <= 35; ++u) {
      const double gu = 0.5 * (copy.at(u + 1, v) - copy.at(u - 1, v)),
                   gv = 0.5 * (copy.at(u, v + 1) - copy.at(u, v - 1));
      uu += gu * gu, uv += gu * gv, vv += gv * gv, su += gu, sv += gv;
    }
  uu -= su * su / 121, uv -= su * sv / 121, vv -= sv * sv / 121;
  const double s = 4, expected = 2 * s * s * vv / (uu * vv - uv * uv);
  double squares = 0;
  constexpr int runs = 400;
  for (std::uint64_t run = 0; run < runs; ++run) {
    Picture a = still, b = moved;
    test::add_noise(a, s, 2 * run);
    test::add_noise(b, s, 2 * run + 1);
    const auto patch = Patch::of(image_of(a), 30, 25);
    ASSERT_TRUE(patch);
    const auto found = patch->find(image_of(b), {30, 25}, 2);
    ASSERT_TRUE(found);
    squares += (found->x - 30.4) * (found->x - 30.4);
  }
  // The mean of 400 squares of normals is within 5 sqrt(2 / 400) = 35 % of the variance; interpolation makes the noise of the
  // moved image smaller, by up to 64 % of its variance for a shift of (0.4, 0.2).
  EXPECT_LT(squares / runs, 1.35 * expected);
  EXPECT_GT(squares / runs, 0.65 * (1 - 0.32) * expected);
}

TEST(VoPatch, RefusesWhatHasNoPlace) {
  const Picture picture = waves(60, 50, {}, 1);
  const PaddedImage image = image_of(picture);
  EXPECT_FALSE(Patch::of(image, 5, 25));
  EXPECT_TRUE(Patch::of(image, 6, 25));
  EXPECT_TRUE(Patch::of(image, 53, 25));
  EXPECT_FALSE(Patch::of(image, 54, 25));
  EXPECT_FALSE(Patch::of(image, 30, 44));
  EXPECT_FALSE(Patch::of(image_of(Picture(60, 50, 90)), 30, 25));
  Picture edge(60, 50);  // an edge has a place across only
  for (int v = 0; v < 50; ++v)
    for (int u = 30; u < 60; ++u) edge.at(u, v) = 200;
  EXPECT_FALSE(Patch::of(image_of(edge), 30, 25));
  const auto patch = Patch::of(image, 30, 25);
  ASSERT_TRUE(patch);
  EXPECT_FALSE(patch->find(image_of(waves(60, 50, {}, 8)), {30, 25}, 2));      // something else
  EXPECT_FALSE(patch->find(image_of(waves(60, 50, {4, 0}, 1)), {30, 25}, 2));  // too far
  EXPECT_FALSE(patch->find(image, {2, 25}, 100));                              // over the edge
  EXPECT_FALSE(patch->find(image, {std::nan(""), 25}, 2));
  EXPECT_FALSE(patch->find(image_of(Picture(60, 50, 90)), {30, 25}, 2));
}

/// Texture of the test scene, two pixels per texel, bilinear: any shift is exact.
Picture field(int width, int height, Vec2 shift) {
  static const test::Texture texture(21);
  Picture out(width, height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      out.at(u, v) = static_cast<std::uint8_t>(
          std::floor(texture.at(0.5 * (u - shift.x), 0.5 * (v - shift.y), 1) + 0.5));
  return out;
}

StereoView pair_of(const Picture& left, const Picture& right, const FeatureSpec& spec = {}) {
  return {view_of(left.view(), spec), view_of(right.view(), spec)};
}

constexpr double disparity0 = 10.4, disparity1 = 12.2;
constexpr Vec2 flow{7.3, -4.6};

// One in twenty may be found by accident: RANSAC's task.
TEST(VoMatching, CircleOfShiftedImages) {
  for (const bool half : {false, true}) {
    const FeatureSpec spec{.half_resolution = half, .threshold = 30};
    const StereoView from = pair_of(field(280, 200, {}), field(280, 200, {-disparity0, 0}), spec);
    const StereoView to = pair_of(field(280, 200, flow), field(280, 200, {flow.x - disparity1, flow.y}),
                                  spec);
    const auto matches = match_circle(from, to, {.radius_px = 40, .max_disparity_px = 40});
    ASSERT_GT(matches.size(), 25u) << half;
    std::size_t good = 0;
    for (const StereoMatch& m : matches)
      good += std::abs(m.left0.x - m.right0.x - disparity0) < 0.1 && std::abs(m.right0.y - m.left0.y) < 0.1 &&
              std::abs(m.left1.x - m.left0.x - flow.x) < 0.1 &&
              std::abs(m.left1.y - m.left0.y - flow.y) < 0.1 &&
              std::abs(m.left1.x - m.right1.x - disparity1) < 0.15 && std::abs(m.left1.y - m.right1.y) < 0.1;
    EXPECT_GE(20 * good, 19 * matches.size()) << half;
  }
}

TEST(VoMatching, BackAndForthBetweenTwoImages) {
  for (const bool half : {false, true}) {
    const FeatureSpec spec{.half_resolution = half, .threshold = 30};
    const auto matches = match_flow(view_of(field(280, 200, {}).view(), spec),
                                    view_of(field(280, 200, flow).view(), spec), {.radius_px = 40});
    ASSERT_GT(matches.size(), 25u) << half;
    std::size_t good = 0;
    for (const FlowMatch& m : matches)
      good += std::abs(m.p1.x - m.p0.x - flow.x) < 0.1 && std::abs(m.p1.y - m.p0.y - flow.y) < 0.1;
    EXPECT_GE(20 * good, 19 * matches.size()) << half;
  }
}

TEST(VoMatching, LimitsAreKept) {
  const FeatureSpec spec{.threshold = 30};
  const Picture still = field(200, 140, {});
  const StereoView from = pair_of(still, field(200, 140, {-disparity0, 0}), spec);
  const MatchSpec wide{.radius_px = 40, .max_disparity_px = 40};
  const auto near = [](std::size_t few, std::size_t many) { return few * 5 <= many; };
  const std::size_t many = match_circle(from, from, wide).size();
  ASSERT_GT(many, 20u);
  // Rows that differ by four, flow and disparity out of bounds: what is found by accident is less than a fifth.
  const StereoView skew = pair_of(still, field(200, 140, {-disparity0, 4}), spec);
  EXPECT_TRUE(near(match_circle(from, skew, wide).size(), many));
  EXPECT_TRUE(near(match_circle(from, from, {.radius_px = 40, .max_disparity_px = 7}).size(), many));
  const StereoView far = pair_of(field(200, 140, {20, 0}), field(200, 140, {20 - disparity0, 0}), spec);
  EXPECT_GT(match_circle(from, far, wide).size(), many / 2);
  EXPECT_TRUE(near(match_circle(from, far, {.radius_px = 15, .max_disparity_px = 40}).size(), many));
  // At most so many in each square.
  const MatchSpec few{.radius_px = 40, .max_disparity_px = 40, .bucket_px = 60, .bucket_matches = 1};
  std::map<std::pair<int, int>, int> squares;
  for (const StereoMatch& m : match_circle(from, from, few))
    EXPECT_EQ(++squares[std::pair(static_cast<int>(m.left0.x) / 60, static_cast<int>(m.left0.y) / 60)], 1);
  EXPECT_GT(squares.size(), 4u);
  EXPECT_TRUE(
      match_circle(pair_of(Picture(64, 64), Picture(64, 64)), pair_of(Picture(64, 64), Picture(64, 64)), {})
          .empty());
}

// Dots that move by (5, 0), one of them with its surroundings by (25, 15): no neighbour supports it.
TEST(VoMatching, LonelyMatchesAreDropped) {
  const FeatureSpec spec{.threshold = 700};
  Picture a = waves(200, 140, {}, 4), b = waves(200, 140, {5, 0}, 4);
  Stream random(9, 1, Purpose::noise, 0);
  const auto add_dot = [](Picture& picture, int u, int v) {
    picture.at(u, v) = static_cast<std::uint8_t>(std::min(picture.at(u, v) + 120, 255));
  };
  int lone_u = 0, lone_v = 0;
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 9; ++x) {
      const int u = 17 + 20 * x + static_cast<int>(random.below(7)),
                v = 17 + 20 * y + static_cast<int>(random.below(7));
      add_dot(a, u, v);
      if (x == 4 && y == 3) lone_u = u, lone_v = v;
      else add_dot(b, u + 5, v);
    }
  for (int v = -6; v <= 6; ++v)
    for (int u = -6; u <= 6; ++u) b.at(lone_u + 25 + u, lone_v + 15 + v) = a.at(lone_u + u, lone_v + v);
  const auto lone = [&](double tolerance_px, std::size_t& all) {
    const auto matches = match_flow(view_of(a.view(), spec), view_of(b.view(), spec),
                                    {.radius_px = 40, .outlier_px = tolerance_px});
    all = matches.size();
    int count = 0;
    for (const FlowMatch& m : matches) {
      const bool is = m.p0.x == lone_u && m.p0.y == lone_v;
      EXPECT_NEAR(m.p1.x - m.p0.x, is ? 25 : 5, 0.1);
      EXPECT_NEAR(m.p1.y - m.p0.y, is ? 15 : 0, 0.1);
      count += is;
    }
    return count;
  };
  std::size_t all = 0, left = 0;
  EXPECT_EQ(lone(1000, all), 1);
  EXPECT_GT(all, 20u);
  EXPECT_EQ(lone(5, left), 0);
  EXPECT_EQ(left, all - 1);
}

}  // namespace
}  // namespace sandlot::navigation::vo
