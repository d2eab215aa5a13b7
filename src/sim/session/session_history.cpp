/// History of a session: the snapshots that it can go back to, and the input since then.
#include <algorithm>
#include <chrono>

#include "base/text.h"
#include "sim/session/input_recorder.h"

namespace sandlot {
namespace {

constexpr std::size_t most_kept = 512;

double wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void Session::InputRecorder::on_frame(const std::shared_ptr<const Frame>& frame) {
  std::vector<LogEntry> entries;
  for (const LogEntry& entry : frame->log)
    if (entry.is_input()) entries.push_back(entry);
  if (entries.empty()) input.entries.erase(frame->tick);
  else input.entries[frame->tick] = std::move(entries);
}

/// Submits the logged input of the next tick. @return the logged length of the tick, if it was measured
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
      simulation_->repeat(CommandRequest{entry.target, entry.type, entry.bytes}, entry.source);
    } else {
      ByteReader r(entry.bytes);
      Request request;
      if (read_request(r, request)) simulation_->repeat(std::move(request), entry.source);
    }
  }
  return measured;
}

/// Takes a snapshot where that costs little, and thins them out so that their number and size stay bounded: the older, the
/// farther apart.
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

/// Drops snapshots and input after the present tick: the run goes on from here in another way.
void Session::forget_future() {
  rerun_until_ = 0;
  if (options_.input_log) return;
  past_.entries.erase(past_.entries.upper_bound(simulation_->tick_index()), past_.entries.end());
  while (history_.size() > 1 && history_.back().tick > simulation_->tick_index()) {
    history_bytes_ -= history_.back().bytes.size();
    history_.pop_back();
  }
}

/// Builds the world of a snapshot in place of the present one. Requests that still wait are refused.
Status Session::replace(std::span<const std::byte> bytes, const std::string& why) {
  Diagnostics given_before;  // these warnings were given when the run began
  SL_ASSIGN(auto world, Simulation::restore(bytes, options_.simulation, given_before));
  for (Observer* observer : observers_) world->add_observer(observer);
  if (input_recorder_) world->add_observer(input_recorder_.get());
  std::map<std::uint64_t, Waiting> waiting;
  {
    const std::lock_guard lock(mutex_);
    std::swap(simulation_, world);
    std::swap(waiting, waiting_);
    ++epoch_;
    // Before anybody can submit to the new world: ticks that are repeated have their input already.
    report_.takes_no_input = why_no_input();
  }
  for (const auto& [sequence, answer] : waiting)
    answer({{}, sequence, Error{"the run was " + why + " before"}});
  if (options_.on_world) options_.on_world(*simulation_, why);
  return {};
}

/// Restores the latest snapshot not after `to`, unless running on from here is the shorter way.
Status Session::go_back(Time to) {
  // The latest one not after `to`; the first is the beginning of the run.
  std::size_t best = 0;
  for (std::size_t i = 0; i < history_.size(); ++i)
    if (history_[i].now <= to) best = i;
  const Time now = simulation_->now();
  const bool ahead = to >= now && status_;
  if (ahead && (history_.empty() || history_[best].now <= now)) return {};  // forward: only run on
  SL_TRY(may_rewind());  // the run may have passed the target since the order
  const std::uint64_t frontier = simulation_->tick_index();
  const std::uint64_t before = rerun_until_;
  if (!options_.input_log) rerun_until_ = std::max(frontier, rerun_until_);
  Status status = replace(history_[best].bytes, "rewound to " + number_text(to.s()) + " s");
  if (!status) rerun_until_ = before;
  return status;
}

}  // namespace sandlot
