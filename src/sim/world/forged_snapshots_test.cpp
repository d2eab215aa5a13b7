/// Snapshots with bytes changed and the checksum made right again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "base/hash.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

/// A mass or moment of inertia that is next to nothing made the library stop in the middle of a step. Zeros across the
/// border of two numbers make such: the first keeps its mantissa and loses its exponent.
TEST(ForgedSnapshots, AreRefusedBeforeTheLibraryMeetsTheirNumbers) {
  for (const char* const engine : {"rigid", "planar"}) {
    model::Setup setup;
    setup.engine = engine;
    setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
    setup.instances.push_back(rover("rover", rover_model(), {}, 0, ""));
    setup.instances.back().devices.edit().resize(1);  // the drive
    const auto simulation = build(setup);
    advance(*simulation, 5);
    const std::vector<std::byte> good = simulation->snapshot();
    int refused = 0;
    for (std::size_t at = Simulation::profile().size() + 16; at + 16 < good.size(); at += 3) {
      std::vector<std::byte> forged = good;
      std::fill_n(forged.begin() + static_cast<std::ptrdiff_t>(at), 8, std::byte{});
      const std::uint64_t checksum = hash64(std::span(forged).first(forged.size() - 8));
      std::memcpy(&forged[forged.size() - 8], &checksum, 8);
      Diagnostics diagnostics;
      const auto restored = Simulation::restore(forged, {}, diagnostics);
      if (!restored) {
        ++refused;
        continue;
      }
      Status status;
      for (int i = 0; i < 2 && status; ++i) status = (*restored)->tick();
      ASSERT_TRUE(status || status.error().what.find("ODE") == std::string::npos)
          << engine << ", byte " << at << ": " << status.error().text();
    }
    EXPECT_GT(refused, 50) << engine;
  }
}

}  // namespace
}  // namespace sandlot::test
