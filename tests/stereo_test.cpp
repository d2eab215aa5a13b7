/// Disparities in scenarios/stereo.yaml: what matching finds, held against what the depths say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "messages/stereo_msgs.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::test {
namespace {

std::vector<float> disparities(const Simulation& simulation, const char* topic) {
  const auto* const found = dynamic_cast<const Topic<msg::DisparityImage>*>(simulation.find_topic(topic));
  if (!found) return {};
  const auto& image = found->message.image;
  std::vector<float> values(image.data.size() / 4);
  if (!values.empty()) std::memcpy(values.data(), image.data.data(), image.data.size());
  return values;
}

TEST(Stereo, MatchingFindsMostOfWhatIsThere) {
  Diagnostics diagnostics;
  const std::string devices = "robots[0].modules[0].devices.stereo.";
  const std::vector<formats::Override> overrides{{devices + "levels", "[disparity, closed_form]"},
                                                 {devices + "match_std", "0"},
                                                 {devices + "points", "true"}};
  LoadOptions options;
  options.overrides = overrides;
  auto setup = load("scenarios/stereo.yaml", options, diagnostics);
  ASSERT_TRUE(setup) << setup.error().text();
  auto made = Simulation::create(std::move(*setup), {.threads = 2}, diagnostics);
  ASSERT_TRUE(made) << made.error().text();
  Simulation& simulation = **made;
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(simulation.tick());
  const auto matched = disparities(simulation, "/rig/stereo/disparity"),
             truth = disparities(simulation, "/rig/stereo/closed_form");
  ASSERT_FALSE(truth.empty());
  ASSERT_EQ(matched.size(), truth.size());
  std::size_t there = 0, both = 0, false_alarms = 0;
  std::vector<float> errors;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    there += truth[i] >= 0;
    if (matched[i] < 0) continue;
    if (truth[i] < 0) {
      ++false_alarms;
      continue;
    }
    ++both;
    errors.push_back(std::abs(matched[i] - truth[i]));
  }
  std::printf("%zu pixels, %zu with a surface that both eyes see, %zu matched, %zu where there is none\n",
              truth.size(), there, both, false_alarms);
  ASSERT_GT(both, there / 4);
  std::sort(errors.begin(), errors.end());
  std::printf("error: median %.3f px, nine tenths below %.3f px\n",
              static_cast<double>(errors[errors.size() / 2]),
              static_cast<double>(errors[errors.size() * 9 / 10]));
  EXPECT_LT(errors[errors.size() / 2], 0.25F);  // docs/perception.md: what OpenCV reaches on such a pair
  EXPECT_LT(errors[errors.size() * 9 / 10], 2.0F);
}

}  // namespace
}  // namespace sandlot::test
