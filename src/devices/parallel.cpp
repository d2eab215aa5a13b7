#include "devices/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

namespace sandlot {

void parallel_for(std::size_t count, std::size_t grain, const void* closure,
                  void (*body)(const void* closure, std::size_t begin, std::size_t end)) {
  if (count == 0) return;
  if (count <= grain) return body(closure, 0, count);
  // Chunks are given by count and grain alone, not by who happens to be idle.
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [=](const auto& range) { body(closure, range.begin(), range.end()); }, tbb::simple_partitioner());
}

}  // namespace sandlot
