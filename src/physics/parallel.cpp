#include "physics/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "base/sanitizers.h"
#if SL_THREAD_SANITIZER
#include <thread>
#include <vector>
#endif

namespace sandlot {
namespace {

/// The chunks that tbb::simple_partitioner makes, one after the other.
void run_alone(std::size_t begin, std::size_t end, std::size_t grain, const void* closure,
               void (*body)(const void* closure, std::size_t begin, std::size_t end)) {
  while (end - begin > grain) {
    const std::size_t middle = begin + (end - begin) / 2;
    run_alone(begin, middle, grain, closure, body);
    begin = middle;
  }
  body(closure, begin, end);
}

}  // namespace

std::size_t parallel_threads() {
  return static_cast<std::size_t>(std::max(1, tbb::this_task_arena::max_concurrency()));
}

void parallel_for(std::size_t count, std::size_t grain, const void* closure,
                  void (*body)(const void* closure, std::size_t begin, std::size_t end)) {
  if (count == 0) return;
  if (count <= grain) return body(closure, 0, count);
  // A task costs more than a small chunk.
  if (parallel_threads() == 1) return run_alone(0, count, grain, closure, body);
#if SL_THREAD_SANITIZER
  // The sanitizer cannot see how libtbb hands work over and would call every hand-over a race. Plain threads
  // it understands, so there the bodies run on those and real races between them show.
  const std::size_t workers = std::min(parallel_threads(), (count + grain - 1) / grain);
  std::vector<std::thread> threads;
  for (std::size_t worker = 0; worker < workers; ++worker)
    threads.emplace_back([=] {
      for (std::size_t begin = worker * grain; begin < count; begin += workers * grain)
        body(closure, begin, std::min(count, begin + grain));
    });
  for (std::thread& thread : threads) thread.join();
#else
  // Chunks are given by count and grain alone, not by who happens to be idle.
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [=](const auto& range) { body(closure, range.begin(), range.end()); }, tbb::simple_partitioner());
#endif
}

}  // namespace sandlot
