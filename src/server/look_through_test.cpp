/// Viewers of devices that sample on request.
#include "server/test_viewer.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::advance;
using sandlot::test::arena;
using sandlot::test::build;

TEST(LookThrough, AViewerSeesADeviceThatNobodyAsksAndLeavesNoTrace) {
  model::Setup setup = arena("planar", 1, "");
  setup.instances.back().devices[1].config.set("on_request", Node::scalar("true"));
  setup.stop = Time::from_s(3);
  Running run(setup, {.pace = {2.0}});
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t subscription = viewer.subscribe("/rover1/laser/ranges");
  std::uint64_t before = 0;
  for (int i = 0; i < 8; ++i) {
    const auto scan = viewer.next(subscription);
    ASSERT_TRUE(scan);
    if (i > 1) { EXPECT_GE(scan->ns - before, 100'000'000u) << "its rate is 10 Hz"; }
    before = scan->ns;
  }
  run.end();
  const Simulation& seen = run.session.simulation();
  EXPECT_EQ(seen.find_topic("rover1/laser")->count, 0u);
  const auto alone = build(setup);
  advance(*alone, static_cast<int>(seen.tick_index()));
  EXPECT_EQ(alone->state_hash(), seen.state_hash());
}

}  // namespace
}  // namespace sandlot::server::test
