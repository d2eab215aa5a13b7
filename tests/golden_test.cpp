/// Golden hashes: the state at the end of each scenario, the same in every build and for any number of
/// threads. They change only with a commit that says why.
#include <gtest/gtest.h>

#include "base/sanitizers.h"
#include "command.h"

namespace sandlot::test {
namespace {

struct Golden {
  const char* run;
  const char* state_hash;
};

void PrintTo(const Golden& golden, std::ostream* out) { *out << golden.run; }

constexpr Golden goldens[] = {
    {"scenarios/indoor.yaml --duration 20s", "5e30c80bc20f5c45"},
    {"scenarios/indoor.yaml --duration 20s --set physics=planar", "44a696a51eac3ada"},
    {"scenarios/fleet.yaml --duration 20s", "56186bb4bac537f8"},
    {"scenarios/fleet.yaml --duration 20s --set physics=planar", "c8cabdad76be560e"},
    {"scenarios/swarm.yaml --duration 10s", "0f65edf31c26363a"},
    {"scenarios/pile.yaml --duration 10s", "de905fdd039c8d8e"},
    {"scenarios/primitives.yaml --duration 5s", "e64215f7e3264314"},
    {"scenarios/fig1_robot.yaml --duration 10s", "7d799912c67bc39a"},
    {"scenarios/mario.yaml --duration 10s", "b8e49a88e8a755bc"},
    {"scenarios/mario_drive.yaml --duration 20s", "51e06cefbaeb7a2b"},
    {"scenarios/mario_step.yaml", "e25337ab27670b5d"},
    {"scenarios/yard.yaml --duration 5s", "fdb66b73be7b9b5e"},
    {"scenarios/creatures.yaml --duration 3s", "d867a75aaccd8cf2"},
    {"scenarios/wheels.yaml --duration 3s", "b1c5c75a0b698dfa"},
    {"scenarios/wheels.yaml --duration 20s --set level2=ideal --set level3=ideal --set physics=planar",
     "9178fbf258163f78"},
    {"scenarios/materials.yaml --duration 10s", "9c38c2a0c26c86f3"},
    {"scenarios/gripping.yaml", "cfa82616cb99b098"},
    {"scenarios/gripping.yaml --set physics=planar", "540699f015cce607"},
    {"scenarios/msl_field.yaml --duration 300ms --set level=image", "e5c379e8469687a4"},
    {"scenarios/msl_field.yaml --duration 2s --set level=objects", "129a7022dc8f67f0"},
    {"scenarios/stereo.yaml --duration 300ms", "b2f8f1076e57f6f3"},
    {"scenarios/motor_ramp.yaml", "2957344ac78e6184"},
    {"scenarios/joint_step.yaml", "0a74600422c86148"},
    {"scenarios/errors.yaml --duration 10s", "0a3615b10f6471bd"},
    {"scenarios/beach.yaml --duration 10s", "a6a5b07300a6c135"},
    {"scenarios/ball.yaml", "b88a5c8229dac5a8"},
    {"scenarios/ball.yaml --set level=objects", "d792c187631dd7a8"},
    {"scenarios/formation.yaml", "f39e7746684f0ac7"},
    {"scenarios/clearing.yaml --set disturbers=1", "d2d4082651c76f01"},
    {"scenarios/clearing.yaml --set physics=rigid --duration 20s", "8166a0acf73bfe6d"},
    {"scenarios/predator_prey.yaml", "bdd26c3b26c42ab9"},
    {"scenarios/transport.yaml --duration 20s", "ec208b623a04833c"},
    {"scenarios/foraging.yaml --duration 20s", "bd2df449de057e61"},
    {"scenarios/football.yaml --duration 20s", "754333b19408fc7d"},
    {"scenarios/charging.yaml --duration 60s", "d15b3814c935654e"},
    {"scenarios/office_localise.yaml --duration 30s", "162ccb418accda5e"},
    {"scenarios/office_goals.yaml --duration 30s", "3a064743e084bf21"},
    {"scenarios/clutter.yaml --duration 20s", "baedacfa7734112a"},
};

class GoldenRun : public testing::TestWithParam<Golden> {};
INSTANTIATE_TEST_SUITE_P(Scenarios, GoldenRun, testing::ValuesIn(goldens));

std::vector<int> thread_counts() {
  if (SL_ADDRESS_SANITIZER) return {4};  // it looks at what is done, not at how many threads do it
  return {1, 2, 4};
}

TEST_P(GoldenRun, EndsInTheKnownStateFor12And4Threads) {
  for (const int threads : thread_counts()) {
    const auto summary = summary_of(std::string(GetParam().run) + " --threads " + std::to_string(threads));
    ASSERT_FALSE(summary.contains("failed")) << summary["failed"];
    EXPECT_EQ(summary["state_hash"], GetParam().state_hash)
        << threads << " threads, profile " << summary["profile"];
  }
}

}  // namespace
}  // namespace sandlot::test
