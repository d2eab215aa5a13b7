#pragma once
/// Rule: a judgement of the run once per tick, after sensing and before control, such as a stop condition. It sees the true
/// state and may end the run.
#include <optional>
#include <string>

#include "base/bytes.h"
#include "base/text.h"
#include "physics/engine.h"

namespace sandlot {

struct RuleContext {
  Time now;
  std::uint64_t tick_index = 0;
  const Engine& engine;
};

class Rule {
 public:
  virtual ~Rule() = default;
  virtual const char* name() const = 0;
  /// The reason to stop, or nothing.
  virtual std::optional<std::string> judge(const RuleContext& context) = 0;
  virtual void save(ByteWriter& w) const = 0;
  virtual void load(ByteReader& r) = 0;
};

/// Ends the run at a simulated time. The time is part of the setup, so there is no State.
class StopAfter final : public Rule {
 public:
  explicit StopAfter(Time end) : end_(end) {}
  const char* name() const override { return "stop_after"; }
  std::optional<std::string> judge(const RuleContext& context) override {
    if (context.now < end_) return std::nullopt;
    return "simulated time reached " + number_text(end_.s()) + " s";
  }
  void save(ByteWriter&) const override {}
  void load(ByteReader&) override {}

 private:
  Time end_;
};

}  // namespace sandlot
