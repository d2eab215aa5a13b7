#pragma once
/// Logs and hashes of all ticks, for tests that repeat them.
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/world/simulation.h"

namespace sandlot::test {

struct TickLog : Observer {
  Wants wants() const override { return {.log = true, .hash = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    ticks.push_back(frame->log);
    hashes.push_back(frame->hash);
  }
  std::vector<std::vector<LogEntry>> ticks;
  std::vector<std::uint64_t> hashes;
};

}  // namespace sandlot::test
