/// A robot with every device that remembers something, and what snapshots make of it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/hash.h"
#include "base/random.h"
#include "command.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::test {
namespace {

const std::string scenario = "tests/scenarios/all_devices.yaml";

TEST(AllDevices, GoOnFromHalfTimeToTheSameHashInAnyNumberOfThreads) {
  const TestFolder scratch;
  const std::string half = scratch.file("half.snapshot");
  const auto whole = summary_of(scenario + " --snapshot-at 2s --snapshot " + half);
  ASSERT_FALSE(whole.contains("failed")) << whole["failed"];
  for (const int threads : {1, 2, 4}) {
    const std::string more = " --threads " + std::to_string(threads);
    EXPECT_EQ(summary_of(scenario + more)["state_hash"], whole["state_hash"]) << threads << " threads";
    const auto rest = summary_of("--from " + half + " --duration 2s" + more);
    EXPECT_EQ(rest["end_tick"], whole["end_tick"]);
    EXPECT_EQ(rest["state_hash"], whole["state_hash"]) << threads << " threads, from half time";
  }
}

/// A checksum finds damage, not forgery: whatever the bytes say, they are refused or run without a crash.
TEST(AllDevices, ForgedStateIsRefusedOrHarmless) {
  Diagnostics diagnostics;
  auto setup = load(scenario, {}, diagnostics);
  ASSERT_TRUE(setup) << setup.error().text();
  auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
  ASSERT_TRUE(simulation) << simulation.error().text();
  for (int i = 0; i < 215; ++i) ASSERT_TRUE((*simulation)->tick());  // against the wall, samples held back
  const std::vector<std::byte> good = (*simulation)->snapshot();
  constexpr double numbers[] = {-1, 1e-300, 1e300, std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::quiet_NaN()};
  Stream random(1, 2, Purpose::noise, 3);
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
  };
  int refused = 0, run = 0;
  for (int round = 0; round < 400; ++round) {
    std::vector<std::byte> forged = good;
    for (std::size_t i = 0, changes = 1 + below(3); i < changes; ++i) {
      // The setup comes first; the state of the devices fills the last part.
      const std::size_t at = good.size() / 2 + below(good.size() / 2 - 16);
      if (random.uniform() < 0.5) std::memcpy(&forged[at], &numbers[below(std::size(numbers))], 8);
      else forged[at] = static_cast<std::byte>(below(256));
    }
    const std::uint64_t checksum = hash64(std::span(forged).first(forged.size() - 8));
    std::memcpy(&forged[forged.size() - 8], &checksum, 8);
    auto restored = Simulation::restore(forged, {}, diagnostics);
    if (!restored) {
      EXPECT_FALSE(restored.error().text().empty());
      ++refused;
      continue;
    }
    ++run;
    for (int i = 0; i < 12; ++i)  // every device takes a sample
      if (!(*restored)->tick()) break;
  }
  EXPECT_GT(run, 50);
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace sandlot::test
