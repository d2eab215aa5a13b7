/// What a session keeps so that it can go back: snapshots, and what came from outside.
#include <algorithm>
#include <chrono>

#include "sim/session/session.h"

namespace sandlot {
namespace {

constexpr std::size_t most_kept = 512;

double wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

/// Queues what the tape has for the next tick. @return its measured length, if it had one
std::optional<Time> Session::feed_input_log() {
  std::optional<Time> measured;
  const auto found = past_.entries.find(simulation_->tick_index() + 1);
  if (found == past_.entries.end()) return measured;
  for (const LogEntry& entry : found->second) {
    if (entry.kind == LogEntry::step) {
      ByteReader r(entry.bytes);
      Time length;
      read(r, length.ns);
      if (r.ok() && length.ns > 0) measured = length;
    } else if (entry.kind == LogEntry::command) {
      simulation_->submit(CommandRequest{entry.target, entry.type, entry.bytes}, entry.source);
    } else {
      ByteReader r(entry.bytes);
      Request request;
      if (read_request(r, request)) simulation_->submit(std::move(request), entry.source);
    }
  }
  return measured;
}

/// Snapshots are taken where they cost little, and thinned out so that their number and size stay bounded: the older, the
/// further apart.
void Session::keep_snapshot() {
  if (options_.history_mb <= 0) return;
  const Time now = simulation_->now();
  const double at_s = wall_s();
  constexpr double share = 0.02;
  if (!history_.empty()) {
    if (now - history_.back().now < Time::from_s(history_gap_s_)) return;
    if (snapshot_cost_s_ > share * (at_s - snapshot_at_s_)) return;
  }
  history_.push_back({simulation_->tick_index(), now, simulation_->snapshot()});
  history_bytes_ += history_.back().bytes.size();
  snapshot_cost_s_ = wall_s() - at_s;
  snapshot_at_s_ = at_s;
  const auto most_bytes = static_cast<std::size_t>(options_.history_mb * 1024 * 1024);
  while (history_.size() > 2 && (history_bytes_ > most_bytes || history_.size() > most_kept)) {
    std::deque<Kept> thinner;
    history_bytes_ = 0;
    for (std::size_t i = 0; i < history_.size(); ++i) {
      if (i % 2 != 0) continue;
      history_bytes_ += history_[i].bytes.size();
      thinner.push_back(std::move(history_[i]));
    }
    history_ = std::move(thinner);
    history_gap_s_ *= 2;
  }
}

/// The run goes on from here: what it had become behind is no more.
void Session::forget_future() {
  rerun_until_ = 0;
  if (options_.input_log) return;
  past_.entries.erase(past_.entries.upper_bound(simulation_->tick_index()), past_.entries.end());
  while (history_.size() > 1 && history_.back().tick > simulation_->tick_index()) {
    history_bytes_ -= history_.back().bytes.size();
    history_.pop_back();
  }
}

}  // namespace sandlot
