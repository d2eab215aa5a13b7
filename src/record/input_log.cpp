#include "record/input_log.h"

#include "base/text.h"

namespace sandlot::record {
namespace {

/// Whether a Session can feed it again.
bool readable(const LogEntry& entry) {
  if (entry.source.kind > Source::last_kind) return false;
  ByteReader r(entry.bytes);
  if (entry.kind == LogEntry::step) {
    Time length;
    read(r, length.ns);
    return r.ok() && r.remaining() == 0 && length.ns > 0;
  }
  if (entry.kind == LogEntry::command) return true;
  Request request;
  return read_request(r, request) && request.index() == entry.kind && request_target(request) == entry.target;
}

}  // namespace

Result<RecordedRun> read_run(Recording& recording) {
  RecordedRun out;
  out.first_tick = recording.begin().tick;
  out.input_log.last_tick = out.first_tick;
  out.input_log.end = recording.begin().now;
  const auto hash_of = [&](std::uint64_t tick) -> std::optional<std::uint64_t>& {
    const std::size_t index = tick - out.first_tick;
    if (out.hashes.size() <= index) out.hashes.resize(index + 1);
    return out.hashes[index];
  };
  for (;;) {
    auto next = recording.next();
    if (!next) {
      out.cut = std::move(next.error());
      break;
    }
    if (!*next) {
      out.cut = recording.torn();
      break;
    }
    const RecordedTick& tick = **next;
    if (tick.tick < out.first_tick) continue;
    if (tick.tick > out.input_log.last_tick + 1) {
      out.cut = Error{"the log is incomplete: tick " + std::to_string(out.input_log.last_tick + 1) +
                          " is missing, it goes on with tick " + std::to_string(tick.tick),
                      "nothing behind it can be played"};
      break;
    }
    if (!tick.parts.empty()) hash_of(tick.tick) = tick.hash;
    if (tick.tick == out.first_tick) continue;
    std::vector<LogEntry> outside;
    for (const LogEntry& entry : tick.log) {
      if (!entry.is_input()) continue;
      if (!readable(entry))
        return Error{tick_text(tick.tick, tick.now) + ": an entry of the log for '" + entry.target +
                         "' cannot be read",
                     "the recording is damaged there"};
      outside.push_back(entry);
    }
    if (!outside.empty()) out.input_log.entries.emplace(tick.tick, std::move(outside));
    out.input_log.last_tick = tick.tick;
    out.input_log.end = tick.now;
  }
  return out;
}

void RunCheck::on_frame(const std::shared_ptr<const Frame>& frame) {
  if (frame->tick < run_.first_tick || frame->tick - run_.first_tick >= run_.hashes.size()) return;
  const auto& recorded = run_.hashes[frame->tick - run_.first_tick];
  if (!recorded) return;
  ++compared_;
  if (*recorded == frame->hash) return;
  ++different_;
  if (!std::exchange(differing_, true)) differs_(frame->tick, frame->now);
}

}  // namespace sandlot::record
