#include "physics/rigid/library.h"

#include <ode/ode.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <vector>

#include "base/check.h"
#include "base/hash.h"

namespace sandlot::rigid::library {
namespace {

thread_local Counts thread_counts;
thread_local std::uint64_t thread_seed = 0;

int draw(int n) {
  ++thread_counts.draws;
  const std::uint64_t bits = mix64(thread_seed ^ mix64(static_cast<std::uint64_t>(n)));
  return static_cast<int>(((bits >> 32) * static_cast<std::uint64_t>(n)) >> 32);
}

void count_message(int, const char*, va_list) { ++thread_counts.messages; }

// ODE ends the process after these two. A run that has blown up must end with a name and its results instead.
[[noreturn]] void fail(int, const char* text, va_list arguments) {
  char message[512];
  std::vsnprintf(message, sizeof message, text, arguments);
  throw Fault{message};
}

void* allocate(std::size_t size) {
  ++thread_counts.allocations;
  return std::malloc(size);
}
void* reallocate(void* block, std::size_t, std::size_t size) {
  ++thread_counts.allocations;
  return std::realloc(block, size);
}
void release(void* block, std::size_t) { std::free(block); }

// Two spheres on each other and on a plane, solved quickly: enough constraints for ODE to shuffle.
void check_random_numbers_are_ours() {
  const dWorldID world = dWorldCreate();
  const dJointGroupID group = dJointGroupCreate(0);
  const std::uint64_t before = thread_counts.draws;
  for (int i = 0; i < 2; ++i) {
    const dBodyID body = dBodyCreate(world);
    dContact contact{};
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = 1;
    contact.geom.normal[2] = 1;
    contact.geom.depth = 0.01;
    dJointAttach(dJointCreateContact(world, group, &contact), body, nullptr);
    dBodySetLinearVel(body, 1, 0, -1);
  }
  dWorldSetQuickStepNumIterations(world, 20);
  dWorldQuickStep(world, 0.01);
  dJointGroupDestroy(group);
  dWorldDestroy(world);
  SL_CHECK_MSG(thread_counts.draws > before,
               "ODE does not use Sandlot's dRandInt: the program is linked wrongly");
}

}  // namespace

void prepare_thread() {
  thread_local bool ready = false;
  if (ready) return;
  static std::once_flag once;
  std::call_once(once, [] {
    dSetAllocHandler(allocate);
    dSetReallocHandler(reallocate);
    dSetFreeHandler(release);
    dSetMessageHandler(count_message);
    dSetErrorHandler(fail);
    dSetDebugHandler(fail);
    dInitODE2(0);
    dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll));
    check_random_numbers_are_ours();
  });
  dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll));
  ready = true;
}

void abandon(void* item) {
  static std::mutex mutex;
  static std::vector<void*>& items = *new std::vector<void*>;
  const std::lock_guard lock(mutex);
  items.push_back(item);
}

void seed(std::uint64_t key) { thread_seed = mix64(key ^ 0x6f64655f72616e64u); }

const Counts& counts() { return thread_counts; }

}  // namespace sandlot::rigid::library

// The one symbol of ODE that Sandlot replaces; see library.h.
extern "C" int dRandInt(int n) { return sandlot::rigid::library::draw(n); }
