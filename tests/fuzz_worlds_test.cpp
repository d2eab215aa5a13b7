/// The worlds that fuzzers forge: a fuzzer runs seldom, what it begins with should hold always.
#include <gmock/gmock.h>

#include "../fuzz/small_worlds.h"

namespace sandlot {
namespace {

TEST(FuzzWorlds, HoldEveryKind) { EXPECT_THAT(fuzz::missing_kinds(), testing::IsEmpty()); }

TEST(FuzzWorlds, GoOnFromTheirSnapshots) {
  for (const fuzz::SmallWorld& world : fuzz::small_worlds) {
    Diagnostics diagnostics;
    const auto restored = Simulation::restore(fuzz::small_snapshot(world), {}, diagnostics);
    ASSERT_TRUE(restored) << world.name << ": " << restored.error().text();
    EXPECT_TRUE((*restored)->tick()) << world.name;
  }
}

}  // namespace
}  // namespace sandlot
