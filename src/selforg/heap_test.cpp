// unity: alone (it replaces malloc)
/// No heap in a step of an agent. Sanitizers bring a malloc of their own: there this test is not built.
#include "base/sanitizers.h"
#include "selforg/agent.h"
#include "selforg/store.h"
#include "selforg/teaching.h"

#include <gtest/gtest.h>

#if !SL_ADDRESS_SANITIZER && !SL_THREAD_SANITIZER && defined(__GLIBC__)
namespace {
std::uint64_t allocations = 0;
}
// Eigen does not allocate by operator new but by malloc, so that is counted; operator new calls it.
extern "C" void* __libc_malloc(std::size_t size);  // NOLINT(bugprone-reserved-identifier)
extern "C" void* malloc(std::size_t size) { return ++allocations, __libc_malloc(size); }  // NOLINT

namespace sandlot::selforg {
namespace {

struct Still : Robot {
  std::size_t sensors() const override { return 5; }
  std::size_t motors() const override { return 4; }
  void read_sensors(std::span<double> x) override {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.1 * static_cast<double>(i);
  }
  void set_motors(std::span<const double>) override {}
};

TEST(Heap, AStepAllocatesNothing) {
  auto* const probe = new int;
  ASSERT_GT(allocations, 0u) << "the counter counts";
  delete probe;
  for (const char* kind : {"sox", "semox", "dep", "experts", "sine", "babbling"}) {
    Still robot;
    AgentSpec spec;
    spec.controller = kind;
    spec.wiring = {{"derivative", {}}, {"feedback", {}}, {"motor_noise", {}}, {"one_to_one", {}}};
    auto agent = make_agent(robot, spec);
    ASSERT_TRUE(static_cast<bool>(agent));
    auto teaching = CrossMotorTeaching::make({{1}, {0}, {3}, {2}}, 0);
    ASSERT_TRUE(static_cast<bool>((*agent)->start_log("/dev/null", {.interval = 1})));
    const auto steps = [&] {
      for (int k = 0; k < 50; ++k) {
        if (auto* teachable = (*agent)->controller().teachable()) teaching->teach(*teachable);
        if (auto* rewardable = (*agent)->controller().rewardable()) rewardable->set_reward(0.5);
        (*agent)->step(0.01);
      }
    };
    steps();
    (*agent)->wired().babble(20);
    const std::uint64_t before = allocations;
    steps();
    EXPECT_EQ(allocations - before, 0u) << kind;
  }
}

}  // namespace
}  // namespace sandlot::selforg
#endif
