#pragma once
/// Input from outside of a run, to feed another run with.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "sim/test_values.h"
#include "sim/world/simulation.h"

namespace sandlot::test {

/// Logs and hashes of a run, by tick.
struct InputLog : Observer {
  Wants wants() const override { return {.log = true, .hash = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    input[frame->tick] = frame->log;
    hash[frame->tick] = frame->hash;
  }
  std::map<std::uint64_t, std::vector<LogEntry>> input;
  std::map<std::uint64_t, std::uint64_t> hash;
};

/// Submits what came from outside in a tick.
inline void feed(Simulation& simulation, const std::vector<LogEntry>& entries) {
  for (const LogEntry& entry : entries) {
    if (entry.source.kind == Source::Kind::program) continue;
    ByteReader r(entry.bytes);
    Request request;
    ASSERT_TRUE(read_request(r, request));
    simulation.submit(std::move(request), entry.source);
  }
}

}  // namespace sandlot::test
