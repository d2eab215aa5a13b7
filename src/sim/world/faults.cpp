/// Failures and clocks of devices.
#include "sim/world/faults.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace sandlot {

Status FailureSpec::check(const Node& node, const std::string& path) const {
  if (from_s < until_s) return {};
  return node.error("until is not later than from", "it begins at " + number_text(from_s) + " s", path);
}

Result<std::unique_ptr<Faults>> take_faults(Node& config, bool has_errors, std::string_view kind) {
  FaultsSpec spec;
  Place clock_place;
  Status status;
  bool any = false;
  FaultsSpec::fields(spec, [&](const Field& field, auto& member) {
    const Node* const value = config.find(field.key);
    if (!value || !status) return;
    status = read_value(*value, field, member, std::string("/") + field.key);
    const bool noisy = std::any_of(spec.failures.begin(), spec.failures.end(),
                                   [](const auto& each) { return each.kind == FailureSpec::Kind::noisy; });
    if (status && noisy && !has_errors)
      status = value->error("a " + std::string(kind) + " has no errors that could grow",
                            "it can be stuck or dead", "/failures");
    clock_place = value->place();
    config.erase(field.key);
    any = true;
  });
  if (!status) return std::move(status.error());
  if (!any) return std::unique_ptr<Faults>();
  return std::make_unique<Faults>(Faults{std::move(spec), {}, clock_place, {}});
}

Failing failing_at(const FaultsSpec& spec, Time now) {
  Failing out;
  for (const FailureSpec& failure : spec.failures) {
    if (now < Time::from_s(failure.from_s) || now >= Time::from_s(failure.until_s)) continue;
    out.stuck = out.stuck || failure.kind == FailureSpec::Kind::stuck;
    out.dead = out.dead || failure.kind == FailureSpec::Kind::dead;
    if (failure.kind == FailureSpec::Kind::noisy) out.factor *= failure.factor;
  }
  return out;
}

Result<FailureOrder> read_failure_order(const Node& value) {
  FailureOrder order;
  Node whole = value;
  if (value.is_scalar()) {
    whole = Node::map(value.place());
    whole.set("kind", value);
  }
  SL_TRY(read_value(whole, Field{failure_field, "", "What goes wrong."}, order,
                    std::string("/") + failure_field));
  return order;
}

Failing Faults::at(Time now) const {
  switch (order.kind) {
    case FailureOrder::Kind::planned: return failing_at(spec, now);
    case FailureOrder::Kind::none: return {};
    case FailureOrder::Kind::stuck: return {.stuck = true};
    case FailureOrder::Kind::dead: return {.dead = true};
    case FailureOrder::Kind::noisy: return {.factor = order.factor};
  }
  return {};
}

bool Faults::idle() const {
  return order.kind == FailureOrder::Kind::planned && spec.failures.empty() && !spec.clock;
}

Time clock_at(const ClockSpec& spec, Time now, double errors, const Stream& random) {
  Stream own = random.fork(hash64("clock"));
  const double n = spec.jitter_s > 0 ? own.normal() : 0;
  const double error_s = errors * (spec.offset_s + spec.drift * now.s() + spec.jitter_s * n);
  return std::max(Time{}, now + Time::from_s(error_s));
}

/// A clock needs times to be wrong about.
Status Faults::check(std::span<SimulationParts::Slot> topics) const {
  if (!spec.clock) return {};
  for (SimulationParts::Slot& slot : topics)
    if (slot.topic->restamp(slot.topic->stamp)) return {};
  return Error{"this device publishes no messages with a time in them", "leave the clock out", clock_place,
               "/clock"};
}

Status order_failure(SimulationParts::Device& device, bool has_errors, std::uint32_t& faulty,
                     const FailureOrder& order) {
  if (order.kind == FailureOrder::Kind::noisy && !has_errors)
    return Error{"a " + device.decl.kind + " has no errors that could grow", "it can be stuck or dead"};
  if (!device.faults) {
    device.faults = std::make_shared<Faults>();
    ++faulty;
  }
  device.faults->order = order;
  if (device.faults->idle()) {
    device.faults = nullptr;
    --faulty;
  }
  return {};
}

}  // namespace sandlot
