/// Commands of a user's program (sim/session/run_hooks.h), scheduled by the console.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "console/console.h"
#include "sim/session/run_hooks.h"
#include "sim/test_world.h"

namespace sandlot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(HookCommands, RunBeforeTheFirstTickAtTheirTimeOrLater) {
  Hooks hooks;
  hooks.commands.push_back(
      {"kick", "kick WORD", [](RunHooks& run, std::span<const std::string> words) -> Result<std::string> {
         if (words.empty() || words[0] == "hard") return Error{"ouch"};
         return std::to_string(run.simulation().now().ns / 1'000'000) + " " + words[0];
       }});
  model::Setup setup = test::arena("planar", 1);
  setup.stop = Time::from_s(0.08);
  auto world = test::build(std::move(setup));
  RunHooks run(*world, hooks);
  Console* lines = nullptr;
  Session session(std::move(world), {.history_mb = 0, .tick = [&](Simulation&, std::optional<Time> measured) {
                                       Status status = lines->before_tick();
                                       return status ? run.tick(measured) : status;
                                     }});
  Console console(session, {.experiment = &run});
  lines = &console;
  for (const char* line : {"at 45ms kick late", "kick now", "at 0.02 kick b", "at 0.02 kick c"})
    EXPECT_TRUE(console.schedule(line)) << line;
  for (const char* line : {"at", "at 2s", "at noon kick", "at -1s kick", "fly", "at 2s fly", ""})
    EXPECT_FALSE(console.schedule(line)) << line;
  EXPECT_TRUE(console.schedule("at 0.06 kick hard"));
  RunReport report;
  const Status failed = session.run(report);
  EXPECT_THAT(console.take_answers(),
              ElementsAre("at 0 s: 0 now", "at 0.02 s: 20 b", "at 0.02 s: 20 c", "at 0.05 s: 50 late"));
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().what, HasSubstr("at 0.06 s: ouch"));
}

}  // namespace
}  // namespace sandlot
