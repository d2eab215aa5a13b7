// unity: alone (it replaces operator new)
/// No heap allocation of ours per tick once everything has reached its size.
// Sanitizers bring their own operator new, which must stay in place and hides who asked: there this test is not built.
#include "base/sanitizers.h"
#if !SL_ADDRESS_SANITIZER && !SL_THREAD_SANITIZER

#include <dlfcn.h>
#include <execinfo.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include "sim/test_world.h"

namespace {
std::atomic<bool> counting{false};
std::atomic<std::uint64_t> ours{0}, of_libraries{0};

/// Whether the call of operator new came out of a shared library: code of the standard library, which is
/// instantiated wherever it is used, is passed over; the first frame that is not decides.
bool asked_by_a_library() {
  void* frames[24];
  const int count = backtrace(frames, 24);
  Dl_info here{};
  dladdr(reinterpret_cast<void*>(&asked_by_a_library), &here);
  for (int i = 2; i < count; ++i) {  // 0 is this function, 1 the counter
    Dl_info frame{};
    if (!dladdr(frames[i], &frame)) continue;
    if (frame.dli_sname && std::strncmp(frame.dli_sname, "_Zn", 3) == 0) continue;  // operator new itself
    const auto is_named = [&](const char* begin) {
      return std::strncmp(frame.dli_sname, begin, std::strlen(begin)) == 0;
    };
    if (frame.dli_fbase == here.dli_fbase && frame.dli_sname &&
        (is_named("_ZNSt") || is_named("_ZSt") || is_named("_ZNSa") || is_named("_ZN9__gnu_cxx")))
      continue;
    if (frame.dli_fname && std::strstr(frame.dli_fname, "libstdc++")) continue;
    return frame.dli_fbase != here.dli_fbase;
  }
  return false;
}

[[gnu::noinline]] void* counted(std::size_t size) {
  if (counting.exchange(false, std::memory_order_relaxed)) {
    ++(asked_by_a_library() ? of_libraries : ours);
    counting = true;
  }
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
}  // namespace

// All our code allocates through operator new. Embree uses it too (its names of tree builders), so who asked counts.
void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return counted(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return counted(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace sandlot::test {
namespace {

struct PoseWatcher : Observer {
  void on_frame(const std::shared_ptr<const Frame>& frame) override { last = frame->tick; }
  std::uint64_t last = 0;
};

/// Wants all that a recorder wants and holds frames for a while, as its queue does.
struct Holder : Observer {
  Wants wants() const override { return {.messages = true, .log = true, .hash = true, .links = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override { held[frame->tick % 20] = frame; }
  std::array<std::shared_ptr<const Frame>, 20> held;
};

class Heap : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Engines, Heap, testing::Values("rigid", "planar"),
                         [](const auto& p) { return std::string(p.param); });

TEST_P(Heap, ATickAllocatesNothingAfterWarmUp) {
  for (const int threads : {1, 2}) {
    const auto simulation = build(arena(GetParam(), 10), {.threads = threads});
    PoseWatcher watcher;
    simulation->add_observer(&watcher);
    advance(*simulation, 1000);  // warm-up: contacts, scans and commands have reached their largest size
    const std::uint64_t library_before = simulation->engine().counters().library_allocations;
    ours = of_libraries = 0;
    counting = true;
    advance(*simulation, 200);
    counting = false;
    const std::uint64_t physics = simulation->engine().counters().library_allocations - library_before;
    std::printf(
        "%s, %d threads, per tick: %.2f allocations of ours, %.2f of ODE, %.2f of Embree and others\n",
        GetParam(), threads, static_cast<double>(ours) / 200, static_cast<double>(physics) / 200,
        static_cast<double>(of_libraries) / 200);
    EXPECT_EQ(ours.load(), 0u) << threads << " threads";
  }
  // The counter itself works.
  ours = 0;
  counting = true;
  const auto proof = std::make_unique<std::vector<int>>(100);
  counting = false;
  EXPECT_EQ(ours.load(), 2u);
}

TEST_P(Heap, NorDoesOneWhoseFramesAreHeldForAWhile) {
  const auto simulation = build(arena(GetParam(), 10));
  Holder holder;
  simulation->add_observer(&holder);
  advance(*simulation, 1000);
  ours = of_libraries = 0;
  counting = true;
  advance(*simulation, 200);
  counting = false;
  EXPECT_EQ(ours.load(), 0u);
}

TEST_P(Heap, NorDoesOneWithProgramsThatPublishAtRatesOfTheirOwn) {
  model::Setup setup = arena(GetParam(), 10);
  for (model::Instance& instance : setup.instances)
    if (instance.is_robot)
      instance.controllers.push_back(
          {"estimator", "odometry_estimator", map({{"odometry", "drive"}, {"rate", "25"}}), {}});
  const auto simulation = build(setup);
  Holder holder;
  simulation->add_observer(&holder);
  advance(*simulation, 1000);
  const std::uint64_t before = simulation->find_topic("/rover1/estimator/estimate")->count;
  ours = of_libraries = 0;
  counting = true;
  advance(*simulation, 200);
  counting = false;
  EXPECT_EQ(ours.load(), 0u);
  EXPECT_EQ(simulation->find_topic("/rover1/estimator/estimate")->count, before + 50);
}

/// Commands and scans on their way, commands with errors.
TEST_P(Heap, NorDoesOneWithCommonKeysOfDevices) {
  model::Setup setup = arena(GetParam(), 5);
  for (model::Instance& instance : setup.instances) {
    if (instance.devices.empty()) continue;
    Node stage = Node::map(), stages = Node::sequence(), errors = Node::map();
    stage.set("gaussian", map({{"std", "0.02"}}));
    stages.push(stage);
    stage = Node::map();
    stage.set("lag", map({{"time_constant", "0.1"}}));
    stages.push(stage);
    errors.set("linear", stages);
    instance.devices[0].config.set("command_errors", errors);
    instance.devices[0].config.set("delay", Node::scalar("30 ms"));
    instance.devices[0].config.set("max_rate", Node::scalar("10"));
    instance.devices[1].config.set("delay", Node::scalar("250 ms"));
  }
  const auto simulation = build(std::move(setup));
  Holder holder;
  simulation->add_observer(&holder);
  advance(*simulation, 1000);
  ours = of_libraries = 0;
  counting = true;
  advance(*simulation, 200);
  counting = false;
  EXPECT_EQ(ours.load(), 0u);
}

}  // namespace
}  // namespace sandlot::test

#endif
