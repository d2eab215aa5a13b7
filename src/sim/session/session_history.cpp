/// History of a session: the snapshots that it can go back to, and the input since then.
#include <algorithm>
#include <chrono>

#include "base/text.h"
#include "sim/session/input_recorder.h"

namespace sandlot {
namespace {

constexpr std::size_t most_kept = 512;

/// Memory of a tick's input: its entries, what they hold, and the node of the map.
std::size_t input_size(const std::vector<LogEntry>& input) {
  std::size_t size = 80 + input.size() * sizeof(LogEntry);
  for (const LogEntry& entry : input)
    size += entry.target.capacity() + entry.type.capacity() + entry.bytes.capacity() + entry.why.capacity();
  return size;
}

double wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void Session::InputRecorder::on_frame(const std::shared_ptr<const Frame>& frame) {
  std::vector<LogEntry> entries;
  for (const LogEntry& entry : frame->log)
    if (entry.is_input()) entries.push_back(entry);
  input.set(frame->tick, std::move(entries));
}

void InputLog::set(std::uint64_t tick, std::vector<LogEntry> input) {
  if (const auto before = entries.find(tick); before != entries.end()) forget(before, std::next(before));
  if (input.empty()) return;
  input.shrink_to_fit();
  size_ += input_size(input);
  entries.emplace(tick, std::move(input));
}

void InputLog::forget_before(std::uint64_t tick) { forget(entries.begin(), entries.lower_bound(tick)); }

void InputLog::forget_after(std::uint64_t tick) { forget(entries.upper_bound(tick), entries.end()); }

void InputLog::forget(Entries::iterator first, Entries::iterator last) {
  for (auto at = first; at != last; ++at) size_ -= input_size(at->second);
  entries.erase(first, last);
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

/// Takes a snapshot where that costs little.
void Session::keep_snapshot() {
  if (options_.history_mb <= 0) return;
  const Time now = simulation_->now();
  const double at_s = wall_s();
  if (!history_.empty()) {
    if (now - history_.back().now < Time::from_s(history_gap_s_)) return;
    if (snapshot_cost_s_ > options_.history_share * (at_s - snapshot_at_s_)) return;
  }
  history_.push_back({simulation_->tick_index(), now, simulation_->snapshot()});
  if (options_.save_beside) history_.back().beside = options_.save_beside();
  history_bytes_ += history_.back().size();
  snapshot_cost_s_ = wall_s() - at_s;
  snapshot_at_s_ = at_s;
  keep_within_limits();
}

/// Thins snapshots out so that their number and size stay bounded: the older, the farther apart. Forgets the older half of
/// the input, and the snapshots of that time but for the first, where it would fill more than the snapshots may.
void Session::keep_within_limits() {
  const auto most_bytes = static_cast<std::size_t>(options_.history_mb * 1024 * 1024);
  while (history_.size() > 2 && (history_bytes_ > most_bytes || history_.size() > most_kept)) {
    std::deque<Kept> thinner;
    history_bytes_ = 0;
    for (std::size_t i = 0; i < history_.size(); ++i) {
      if (i % 2 != 0) continue;
      history_bytes_ += history_[i].size();
      thinner.push_back(std::move(history_[i]));
    }
    history_ = std::move(thinner);
    history_gap_s_ *= 2;
    if (begins_late_) past_.forget_before(history_[1].tick + 1);
  }
  if (past_.size() <= most_bytes || history_.size() < 2) return;
  std::size_t oldest = 1;  // snapshot, behind the first, that stays
  past_.forget_before(history_[oldest].tick + 1);
  while (past_.size() > most_bytes / 2 && oldest + 1 < history_.size())
    past_.forget_before(history_[++oldest].tick + 1);
  for (std::size_t i = 1; i < oldest; ++i) history_bytes_ -= history_[i].bytes.size();
  history_.erase(history_.begin() + 1, history_.begin() + static_cast<std::ptrdiff_t>(oldest));
  begins_late_ = true;
}

/// @return an error where the input that leads to `to` was forgotten
Status Session::may_go_back(Time to) const {
  if (to >= kept_from()) return {};
  return forgotten_before(kept_from());
}

/// Time of the first snapshot behind which all input is known.
Time Session::kept_from() const {
  return begins_late_ && history_.size() > 1 ? history_[1].now
         : history_.empty()                  ? Time()
                                             : history_.front().now;
}

/// Drops snapshots and input after the present tick: the run goes on from here in another way.
void Session::forget_future() {
  rerun_until_ = 0;
  if (options_.input_log) return;
  past_.forget_after(simulation_->tick_index());
  while (history_.size() > 1 && history_.back().tick > simulation_->tick_index()) {
    history_bytes_ -= history_.back().size();
    history_.pop_back();
  }
  if (history_.size() < 2) begins_late_ = false;
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

Status Session::restore_kept(std::size_t index, const std::string& why) {
  SL_TRY(replace(history_[index].bytes, why));
  if (options_.load_beside)
    options_.load_beside(index == 0 ? std::span<const std::byte>() : history_[index].beside);
  return {};
}

/// Restores the latest snapshot not after `to`, unless running on from here is the shorter way.
Status Session::go_back(Time to) {
  // The latest one not after `to`; the first is the beginning of the run.
  std::size_t best = 0;
  for (std::size_t i = 0; i < history_.size(); ++i)
    if (options_.load_beside && i > 0 ? history_[i].now < to : history_[i].now <= to) best = i;
  const Time now = simulation_->now();
  const bool ahead = to >= now && status_;
  if (ahead && (history_.empty() || history_[best].now <= now)) return {};  // forward: only run on
  // Since the order the run may have passed the target, and forgotten it.
  SL_TRY(may_rewind());
  SL_TRY(may_go_back(to));
  const std::uint64_t frontier = simulation_->tick_index();
  const std::uint64_t before = rerun_until_;
  if (!options_.input_log) rerun_until_ = std::max(frontier, rerun_until_);
  Status status = restore_kept(best, "rewound to " + number_text(to.s()) + " s");
  if (!status) rerun_until_ = before;
  return status;
}

}  // namespace sandlot
