/// Requests on their way into a tick, and what the tick records of them.
#include "sim/world/commands.h"

#include <algorithm>
#include <tuple>

namespace sandlot {

std::uint64_t Commands::submit(Request request, Source source) {
  const std::lock_guard lock(mutex_);
  inbox_.push_back({source, next_sequence_, std::move(request)});
  return next_sequence_++;
}

std::span<Commands::Pending> Commands::take() {
  taken_.clear();
  {
    const std::lock_guard lock(mutex_);
    std::swap(taken_, inbox_);
  }
  std::sort(taken_.begin(), taken_.end(), [](const Pending& a, const Pending& b) {
    return std::tuple(a.source.kind, a.source.id, a.sequence) <
           std::tuple(b.source.kind, b.source.id, b.sequence);
  });
  return taken_;
}

void Commands::begin_tick(Time now) {
  outcomes_.clear();
  std::erase_if(overrides_, [&](const ManualOverride& each) { return each.until <= now; });
}

void Commands::conclude(const Pending& pending, Status status, bool logged, std::vector<std::byte> response) {
  outcomes_.push_back({pending.source, pending.sequence, std::move(status), std::move(response)});
  if (logged) log_request(pending.request, outcomes_.back());
}

void Commands::override_manually(const SimulationParts::Device& device, Time now) {
  std::erase_if(overrides_, [&](const ManualOverride& each) { return each.device == device.key; });
  overrides_.push_back({device.key, now + Time::from_s(manual_override_s)});
}

LogEntry& Commands::log_entry(std::uint8_t kind, const Source& source, std::uint64_t sequence) {
  if (spare_log_.empty()) spare_log_.emplace_back();
  LogEntry& entry = log_.emplace_back(std::move(spare_log_.back()));
  spare_log_.pop_back();
  entry.kind = kind;
  entry.source = source;
  entry.sequence = sequence;
  entry.target.clear();
  entry.type.clear();
  entry.bytes.clear();
  entry.refused = false;
  entry.why.clear();
  return entry;
}

void Commands::clear_log() {
  for (LogEntry& entry : log_) spare_log_.push_back(std::move(entry));
  log_.clear();
}

void Commands::log_request(const Request& request, const Outcome& outcome) {
  LogEntry& entry = log_entry(static_cast<std::uint8_t>(request.index()), outcome.source, outcome.sequence);
  entry.target = request_target(request);
  entry.refused = !outcome.status;
  if (entry.refused) entry.why = outcome.status.error().text();
  if (const auto* command = std::get_if<CommandRequest>(&request)) {
    entry.type = command->type;
    entry.bytes = command->bytes;
  } else {
    ByteWriter w;
    write_request(w, request);
    entry.bytes = std::move(w.buffer());
  }
}

}  // namespace sandlot
