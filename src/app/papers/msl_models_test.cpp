/// Numbers of the ramp of Figure 3, and pictures with marks.
#include "app/papers/msl_models.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "app/papers/pictures.h"

namespace sandlot::app {
namespace {

TEST(RampResponse, IsThatOfTheRiseAndTheTop) {
  // Up from 0 to 4 in steps of 1, three samples at the top, down again. The second half of the rise is 2 and 3: behind by 1 and 0.5.
  const std::vector<double> target{0, 0, 1, 2, 3, 4, 4, 4, 3, 2};
  const std::vector<double> speed{0, 0, 0, 1, 2.5, 3.5, 4.75, 3.9, 9, 9};
  const RampResponse out = ramp_response(target, speed);
  EXPECT_NEAR(out.behind, 0.75, 1e-12);
  EXPECT_NEAR(out.overshoot, 0.75, 1e-12);  // what comes after the top does not count
  EXPECT_NEAR(out.short_of, 0.1, 1e-12);
}

TEST(RampResponse, WithoutOvershootIsZero) {
  const RampResponse out = ramp_response(std::vector<double>{0, 1, 2, 2}, std::vector<double>{0, 0, 1, 1.5});
  EXPECT_EQ(out.overshoot, 0);
  EXPECT_NEAR(out.behind, 1, 1e-12);
  EXPECT_NEAR(out.short_of, 0.5, 1e-12);
}

TEST(PictureSvg, PutsMarksAroundTheirPixels) {
  const assets::Picture picture{4, 2, std::vector<std::uint8_t>(24, 7)};
  PictureTile first = tile_of(picture), second = tile_of(picture);
  first.scale = second.scale = 10;
  second.marks.push_back({1, 0, 2, 1, "ball <1>"});
  const std::string svg = picture_svg({first, second}, 2);
  // Two pictures of 40 x 20 with 12 between them and no line of titles.
  EXPECT_THAT(svg, testing::HasSubstr("viewBox=\"0 0 92 20\""));
  // Columns 1 and 2 are 10 to 30 in the second picture, which begins at 52; 15 of air on each side.
  EXPECT_THAT(svg, testing::HasSubstr("<rect x=\"47\" y=\"-15\" width=\"50\" height=\"50\""));
  EXPECT_THAT(svg, testing::HasSubstr("ball &lt;1&gt;"));
  first.title = "left";
  EXPECT_THAT(picture_svg({first, second}, 1), testing::HasSubstr("viewBox=\"0 0 40 100\""));
}

}  // namespace
}  // namespace sandlot::app
