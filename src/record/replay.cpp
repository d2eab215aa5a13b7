#include "record/replay.h"

#include <algorithm>
#include <map>

#include "base/text.h"

namespace sandlot::record {
namespace {

constexpr std::size_t most_named = 8;

std::string list_of(const std::vector<std::string>& names, const char* between) {
  std::string out;
  for (std::size_t i = 0; i < std::min(names.size(), most_named); ++i)
    out.append(i ? between : "").append(names[i]);
  if (names.size() > most_named)
    out.append(between).append("and ").append(std::to_string(names.size() - most_named)).append(" more");
  return out;
}

bool of_program(const LogEntry& entry) {
  return !entry.is_input() && entry.source.kind == Source::Kind::program;
}

std::string kind_text(const LogEntry& entry) {
  return entry.kind == LogEntry::step ? "length of the tick" : request_kind(entry.kind);
}

/// "command for rover/drive"
std::string entry_text(const LogEntry& entry) {
  return kind_text(entry) + (entry.target.empty() ? "" : " for " + entry.target);
}

Error damaged_entry(const RecordedTick& recorded, const LogEntry& entry, const char* what) {
  return {tick_text(recorded.tick, recorded.now) + ": the " + entry_text(entry) + " in the log " + what,
          "the recording is damaged there"};
}

}  // namespace

std::string tick_text(std::uint64_t tick, Time now) {
  return "tick " + std::to_string(tick) + " (" + number_text(now.s()) + " s)";
}

std::string Difference::text() const {
  std::string out = tick_text(tick, now) + ": ";
  out += list_of(orders, "; ");
  if (!parts.empty()) out += (orders.empty() ? "" : "; ") + ("the state differs of " + list_of(parts, ", "));
  return out;
}

std::vector<std::string> differing_parts(const std::vector<std::string>& names_a,
                                         std::span<const std::uint64_t> a,
                                         const std::vector<std::string>& names_b,
                                         std::span<const std::uint64_t> b,
                                         std::span<const std::string> ignored) {
  std::vector<std::string> out;
  const auto add = [&](const std::string& name) {
    if (std::find(ignored.begin(), ignored.end(), name) == ignored.end()) out.push_back(name);
  };
  const auto name_of = [](const std::vector<std::string>& names, std::size_t i) {
    return i < names.size() ? names[i] : "part " + std::to_string(i);
  };
  if (&names_a == &names_b || names_a == names_b) {
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i)
      if (i >= a.size() || i >= b.size() || a[i] != b[i]) add(name_of(names_a, i));
    return out;
  }
  std::map<std::string, std::uint64_t> theirs;
  for (std::size_t i = 0; i < b.size(); ++i) theirs[name_of(names_b, i)] = b[i];
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto found = theirs.find(name_of(names_a, i));
    if (found == theirs.end()) {
      add(name_of(names_a, i));
    } else {
      if (found->second != a[i]) add(found->first);
      theirs.erase(found);
    }
  }
  for (const auto& [name, hash] : theirs) add(name);
  return out;
}

/// Keeps the frame of the latest tick.
struct Replay::Watch final : Observer {
  bool compare = true;
  bool hash = false;
  std::shared_ptr<const Frame> frame;
  Wants wants() const override { return {.log = compare, .hash = hash}; }
  void on_frame(const std::shared_ptr<const Frame>& shown) override { frame = shown; }
};

Replay::Replay(std::unique_ptr<Simulation> simulation, const Options& options)
    : options_(options), watch_(std::make_unique<Watch>()), simulation_(std::move(simulation)) {
  watch_->compare = options.compare;
  simulation_->add_observer(watch_.get());
}
Replay::Replay(Replay&&) noexcept = default;
Replay::~Replay() = default;

Result<Replay> Replay::begin(std::span<const std::byte> snapshot, const Options& options,
                             Diagnostics& diagnostics) {
  const bool run_programs = options.programs == Programs::recompute;
  SL_ASSIGN(auto simulation,
            Simulation::restore(
                snapshot, {.threads = options.threads, .run_programs = run_programs, .paths = options.paths},
                diagnostics));
  return Replay(std::move(simulation), options);
}

std::optional<std::uint64_t> Replay::hash() const {
  if (!watch_->frame || watch_->frame->parts.empty()) return std::nullopt;
  return watch_->frame->hash;
}

/// Queues what the log has for this tick. @return its measured length, if it had one
Result<std::optional<Time>> Replay::submit(const RecordedTick& recorded) {
  std::optional<Time> measured;
  for (const LogEntry& entry : recorded.log) {
    if (entry.kind == LogEntry::step) {
      ByteReader r(entry.bytes);
      Time length;
      read(r, length.ns);
      if (!r.ok() || r.remaining() != 0 || length.ns <= 0 || measured)
        return damaged_entry(recorded, entry, "cannot be read");
      measured = length;
      continue;
    }
    if (entry.source.kind > Source::last_kind) return damaged_entry(recorded, entry, "has no known source");
    if (entry.source.kind == Source::Kind::rule) continue;  // rules judge again, whatever drives the programs
    if (of_program(entry) && options_.programs == Programs::recompute) continue;
    if (entry.kind == LogEntry::command) {
      simulation_->repeat(CommandRequest{entry.target, entry.type, entry.bytes}, entry.source);
      continue;
    }
    ByteReader r(entry.bytes);
    Request request;
    if (!read_request(r, request) || request.index() != entry.kind || request_target(request) != entry.target)
      return damaged_entry(recorded, entry, "cannot be read");
    simulation_->repeat(std::move(request), entry.source);
  }
  return measured;
}

void Replay::compare_log(const RecordedTick& recorded, Difference& difference) const {
  const std::vector<LogEntry>& now = watch_->frame->log;
  const std::size_t n = std::max(now.size(), recorded.log.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (i >= now.size()) {
      difference.orders.push_back("the " + entry_text(recorded.log[i]) + " that was logged did not come");
      return;
    }
    if (i >= recorded.log.size()) {
      difference.orders.push_back("a " + entry_text(now[i]) + " came that is not in the log");
      return;
    }
    const LogEntry &a = recorded.log[i], &b = now[i];
    const auto differs = [&](const std::string& what) {
      difference.orders.push_back("the " + entry_text(a) + " " + what);
    };
    // Behind the first entry that is another one nothing can be paired.
    if (a.kind != b.kind || a.target != b.target || a.type != b.type || a.source.kind != b.source.kind ||
        a.source.id != b.source.id)
      return differs("was logged where now comes a " + entry_text(b));
    if (a.bytes != b.bytes)
      differs(a.is_input()    ? "is not what was carried out"
              : of_program(a) ? "is not what the program orders now"
                              : "is not what the rule requests now");
    if (a.refused != b.refused)
      differs(a.refused ? "was refused, and is not now" : "was carried out, and is refused now");
  }
}

void Replay::compare_state(const RecordedTick& recorded, Difference& difference) const {
  const Frame& frame = *watch_->frame;
  static const std::vector<std::string> none;
  const auto& theirs = recorded.part_names ? *recorded.part_names : none;
  std::vector<std::string> ignored;
  if (options_.programs == Programs::logged) {
    for (const auto& entity : simulation_->entities())
      for (const auto& program : entity->programs) ignored.push_back(program->path);
    for (const auto& team : simulation_->teams())
      for (const auto& program : team.programs) ignored.push_back(program->path);
  } else if (frame.hash == recorded.hash && frame.parts == recorded.parts) {
    return;
  }
  difference.parts = differing_parts(theirs, recorded.parts, *frame.part_names, frame.parts, ignored);
  // A recording that contradicts itself: no part differs, the whole does.
  if (difference.parts.empty() && options_.programs == Programs::recompute && frame.hash != recorded.hash)
    difference.parts.push_back("the whole (its hash alone)");
}

/// A recording may tell the hashes of the state that it begins with.
std::optional<Difference> Replay::compare_start(const RecordedTick& recorded) const {
  if (!options_.compare || watch_->frame || recorded.parts.empty() || !recorded.part_names) return {};
  std::vector<std::string> names;
  std::vector<std::uint64_t> hashes;
  for (SubHash& sub : simulation_->sub_hashes()) {
    names.push_back(std::move(sub.path));
    hashes.push_back(sub.hash);
  }
  Difference difference{recorded.tick, recorded.now, {}, {}};
  difference.parts = differing_parts(*recorded.part_names, recorded.parts, names, hashes);
  if (difference.parts.empty()) return {};
  return difference;
}

Result<std::optional<Difference>> Replay::tick(const RecordedTick& recorded) {
  if (recorded.tick == simulation_->tick_index()) return compare_start(recorded);
  if (recorded.tick < simulation_->tick_index()) return std::optional<Difference>();
  if (failed_)
    return Error{"the run failed before " + tick_text(recorded.tick, recorded.now) + ": " + failed_->what,
                 "the recorded one went on"};
  if (recorded.tick != simulation_->tick_index() + 1)
    return Error{"the log is incomplete: tick " + std::to_string(simulation_->tick_index() + 1) +
                     " is missing, it goes on with tick " + std::to_string(recorded.tick),
                 "nothing behind it can be replayed"};
  SL_ASSIGN(const std::optional<Time> measured, submit(recorded));
  watch_->hash = options_.compare && !recorded.parts.empty();
  watch_->frame.reset();
  if (Status status = simulation_->tick(measured); !status) failed_ = status.error();
  if (!options_.compare || !watch_->frame) return std::optional<Difference>();
  Difference difference{recorded.tick, recorded.now, {}, {}};
  compare_log(recorded, difference);
  if (watch_->frame->now != recorded.now)
    difference.orders.push_back("it ended at " + number_text(watch_->frame->now.s()) + " s");
  if (watch_->hash) compare_state(recorded, difference);
  if (difference.orders.empty() && difference.parts.empty()) return std::optional<Difference>();
  return std::optional<Difference>(std::move(difference));
}

}  // namespace sandlot::record
