/// Golden hashes: the state at the end of each scenario, the same in every build and for any number of threads.
/// They change only with a commit that says why.
#include <gtest/gtest.h>

#include "command.h"

namespace sandlot::test {
namespace {

struct Golden {
  const char* run;
  const char* state_hash;
};

void PrintTo(const Golden& golden, std::ostream* out) { *out << golden.run; }

constexpr Golden goldens[] = {
    {"scenarios/indoor.yaml --duration 20s", "cc10795d35b47444"},
    {"scenarios/indoor.yaml --duration 20s --set physics=planar", "cdd72b600460e2be"},
    {"scenarios/fleet.yaml --duration 20s", "dcf5e57224ad794f"},
    {"scenarios/fleet.yaml --duration 20s --set physics=planar", "7ce7e02fb28e0e7d"},
    {"scenarios/swarm.yaml --duration 10s", "0f65edf31c26363a"},
    {"scenarios/pile.yaml --duration 10s", "de905fdd039c8d8e"},
    {"scenarios/primitives.yaml --duration 5s", "e64215f7e3264314"},
    {"scenarios/fig1_robot.yaml --duration 10s", "dfc571904ac15daa"},
    {"scenarios/mario.yaml --duration 10s", "9e2b3e1b2e9c7fa8"},
    {"scenarios/demo.yaml --duration 5s", "22bfd28396518353"},
    {"scenarios/creatures.yaml --duration 5s", "85cacfa7ca883f9a"},
    {"scenarios/wheels.yaml --duration 8s", "bda01d56cdbbda27"},
    {"scenarios/wheels.yaml --duration 20s --set level2=ideal --set level3=ideal --set physics=planar",
     "912e822c522d3cf2"},
    {"scenarios/materials.yaml --duration 10s", "9c38c2a0c26c86f3"},
    {"scenarios/motor_ramp.yaml", "2957344ac78e6184"},
    {"scenarios/joint_step.yaml", "0a74600422c86148"},
};

class GoldenRun : public testing::TestWithParam<Golden> {};
INSTANTIATE_TEST_SUITE_P(Scenarios, GoldenRun, testing::ValuesIn(goldens));

TEST_P(GoldenRun, ends_in_the_known_state_for_1_2_and_4_threads) {
  for (const int threads : {1, 2, 4}) {
    const auto summary = summary_of(std::string(GetParam().run) + " --threads " + std::to_string(threads));
    ASSERT_FALSE(summary.contains("failed")) << summary["failed"];
    EXPECT_EQ(summary["state_hash"], GetParam().state_hash)
        << threads << " threads, profile " << summary["profile"];
  }
}

}  // namespace
}  // namespace sandlot::test
