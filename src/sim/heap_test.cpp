/// No heap allocation of ours per tick once everything has reached its size.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "sim/test_world.h"

namespace {
std::atomic<bool> counting{false};
std::atomic<std::uint64_t> allocations{0};

void* counted(std::size_t size) {
  if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
}  // namespace

// All our code allocates through operator new; ODE, Embree and TBB have allocators of their own.
void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
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

class Heap : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Engines, Heap, testing::Values("rigid", "planar"), [](const auto& p) { return std::string(p.param); });

TEST_P(Heap, a_tick_allocates_nothing_after_warm_up) {
  for (const int threads : {1, 2}) {
    const auto simulation = build(arena(GetParam(), 10), {.threads = threads});
    PoseWatcher watcher;
    simulation->add_observer(&watcher);
    advance(*simulation, 1000);  // warm-up: contacts, scans and commands have reached their largest size
    const std::uint64_t library_before = simulation->engine().counters().library_allocations;
    allocations = 0;
    counting = true;
    advance(*simulation, 200);
    counting = false;
    const std::uint64_t library = simulation->engine().counters().library_allocations - library_before;
    std::printf("%s, %d threads: %llu allocations of ours, %llu of the physics library in 200 ticks\n", GetParam(), threads,
                static_cast<unsigned long long>(allocations.load()), static_cast<unsigned long long>(library));
    EXPECT_EQ(allocations.load(), 0u) << threads << " threads";
  }
  // The counter itself works.
  allocations = 0;
  counting = true;
  const auto proof = std::make_unique<std::vector<int>>(100);
  counting = false;
  EXPECT_GE(allocations.load(), 2u);
}

}  // namespace
}  // namespace sandlot::test
