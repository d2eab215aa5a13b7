/// Disparities of pictures whose true ones are known.
#include "devices/cameras/disparity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/math.h"
#include "base/random.h"

namespace sandlot::cameras {
namespace {

constexpr int width = 120, height = 40;
using Pixels = std::vector<std::uint8_t>;

/// A smooth random surface: a sum of waves of up to a quarter of a cycle per pixel, so that it may be shifted by parts of a pixel.
class Texture {
 public:
  explicit Texture(std::uint64_t sample) {
    Stream r(9, 0, Purpose::experiment, sample);
    for (Wave& w : waves_) w = {r.uniform(-1.4, 1.4), r.uniform(-1.4, 1.4), r.uniform(0, 6.28)};
  }
  std::uint8_t at(double u, double v) const {
    double sum = 0;
    for (const Wave& w : waves_) sum += math::sin(w.u * u + w.v * v + w.phase);
    return static_cast<std::uint8_t>(std::clamp(std::lround(128 + 9 * sum), 0L, 255L));
  }

 private:
  struct Wave {
    double u, v, phase;
  };
  std::array<Wave, 60> waves_;
};

/// The right picture shows what the left one has `shift` farther right.
void pair_of(const Texture& texture, double shift, Pixels& left, Pixels& right) {
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      left.push_back(texture.at(u, v));
      right.push_back(texture.at(u + shift, v));
    }
}

std::vector<float> match(const MatchKeys& keys, const Pixels& left, const Pixels& right) {
  std::vector<float> d(left.size(), 99);
  match_rows(keys, left, right, width, height, 0, height, d);
  return d;
}

float at(const std::vector<float>& d, int u, int v) {
  return d[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)];
}

TEST(Disparity, FindsTheWholePixelAndItsPartToATenth) {
  for (const double shift : {0.0, 3.0, 7.0, 31.0, 5.25, 5.5, 5.75, 12.4}) {
    Pixels left, right;
    pair_of(Texture(1), shift, left, right);
    const auto d = match({.window = 11, .count = 40}, left, right);
    int found = 0;
    double sum = 0, square = 0;
    // As far from the border as window and shift: there is nothing that could go wrong.
    for (int v = 6; v < height - 6; ++v)
      for (int u = 48; u < width - 6; ++u) {
        if (at(d, u, v) < 0) continue;
        ++found;
        const double error = static_cast<double>(at(d, u, v)) - shift;
        ASSERT_LT(std::abs(error), 0.4) << u << " " << v << " shift " << shift;
        sum += error, square += error * error;
      }
    EXPECT_GT(found, 28 * 66 * 9 / 10) << shift;
    EXPECT_LT(std::abs(sum / found), 0.05) << shift;
    EXPECT_LT(std::sqrt(square / found), 0.1) << shift;
  }
}

TEST(Disparity, OfAnEyeThatIsBrighterIsTheSame) {
  Pixels left, right;
  pair_of(Texture(2), 6, left, right);
  const auto plain = match({}, left, right);
  for (std::uint8_t& p : right) p = static_cast<std::uint8_t>(std::min(255, p + 15));
  const auto brighter = match({}, left, right);
  int same = 0, all = 0;
  for (std::size_t i = 0; i < plain.size(); ++i)
    if (plain[i] >= 0) ++all, same += plain[i] == brighter[i];
  EXPECT_GT(all, 2000);
  EXPECT_GT(same, all * 95 / 100);  // but where 255 cuts it off
}

TEST(Disparity, IsRefusedWithoutTextureAndWhereItRepeatsItself) {
  const Pixels grey(width * height, 100);
  for (const float d : match({}, grey, grey)) ASSERT_EQ(d, no_disparity);
  // Stripes of a period of 8 pixels match at 0, 8, 16 ... equally well.
  Pixels stripes;
  for (int i = 0; i < width * height; ++i) stripes.push_back(i % width % 8 < 4 ? 50 : 200);
  const auto d = match({.window = 9, .count = 32}, stripes, stripes);
  for (int v = 0; v < height; ++v)
    for (int u = 40; u < width - 8; ++u) ASSERT_EQ(at(d, u, v), no_disparity) << u << " " << v;
  // Where only one of them is looked for, it is found.
  const auto one = match({.window = 9, .count = 6}, stripes, stripes);
  EXPECT_NEAR(at(one, 60, 20), 0, 1e-6);
}

/// A near square before a far wall: beside it the right eye does not see the wall.
TEST(Disparity, IsRefusedWhereTheRightEyeDoesNotSee) {
  const Texture wall(3), square(4);
  constexpr int far = 2, near = 14, begin = 50, end = 80;
  Pixels left, right;
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      left.push_back(u >= begin && u < end ? square.at(u, v) : wall.at(u, v));
      right.push_back(u >= begin - near && u < end - near ? square.at(u + near, v) : wall.at(u + far, v));
    }
  const auto d = match({.window = 7, .count = 24}, left, right);
  int hidden = 0, wrong = 0;
  for (int v = 4; v < height - 4; ++v) {
    EXPECT_NEAR(at(d, 65, v), near, 0.2) << v;
    EXPECT_NEAR(at(d, 105, v), far, 0.2) << v;
    // In the right picture the square covers the wall's columns from begin - near + far to begin.
    for (int u = begin - near + far + 4; u < begin - 4; ++u) {
      ++hidden;
      wrong += at(d, u, v) >= 0;
    }
  }
  EXPECT_LT(wrong, hidden / 10);
}

TEST(Disparity, DependsNeitherOnHowRowsAreSplitNorOnThoseAround) {
  Pixels left, right;
  pair_of(Texture(5), 4.5, left, right);
  const MatchKeys keys{.window = 9, .count = 16};
  const auto whole = match(keys, left, right);
  std::vector<float> parts(whole.size(), 99);
  for (int first = 0; first < height; first += 7) {
    const int last = std::min(first + 7, height);
    match_rows(keys, left, right, width, height, first, last,
               std::span(parts).subspan(static_cast<std::size_t>(first) * width,
                                        static_cast<std::size_t>(last - first) * width));
  }
  EXPECT_EQ(parts, whole);
}

TEST(Disparity, OfAPictureThatIsTooSmallIsNone) {
  for (const MatchKeys keys :
       {MatchKeys{.window = 31, .count = 2}, MatchKeys{.window = 3, .count = 512, .least = 4096}}) {
    const Pixels little(30 * 4, 7);
    std::vector<float> d(little.size(), 99);
    match_rows(keys, little, little, 30, 4, 0, 4, d);
    for (const float each : d) ASSERT_EQ(each, no_disparity);
  }
  std::vector<float> none;
  match_rows({}, {}, {}, 0, 0, 0, 0, none);
}

TEST(Disparity, OfTheLeastThatIsLookedForOn) {
  Pixels left, right;
  pair_of(Texture(6), 20, left, right);
  const auto d = match({.window = 9, .count = 8, .least = 16}, left, right);
  EXPECT_NEAR(at(d, 70, 20), 20, 0.2);
  for (const float each : match({.window = 9, .count = 8, .least = 4}, left, right))
    if (each >= 0) { ASSERT_TRUE(each >= 4 && each <= 11) << each; }
}

}  // namespace
}  // namespace sandlot::cameras
