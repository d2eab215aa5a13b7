#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/interrupt.h"
#include "base/json_text.h"
#include "base/text.h"
#include "record/recording.h"
#include "record/values_diff.h"
#include "run/snapshot_files.h"
#include "run/summary.h"
#include "sim/world/snapshot.h"

namespace sandlot::app {
namespace {

using record::RecordedTick;
using record::Recording;
using record::Replay;

/// Side of a comparison: a recording that is read tick by tick, or a snapshot.
struct Side {
  std::string file;
  std::optional<Recording> recording;
  std::vector<std::byte> snapshot;  ///< where it begins
  SnapshotInfo begin;
  std::optional<RecordedTick> tick;  ///< last one read

  std::uint64_t at() const { return tick ? tick->tick : begin.tick; }
  Time now() const { return tick ? tick->now : begin.now; }
  /// Reads the next tick of the recording. @return false at its end
  Result<bool> advance() {
    SL_ASSIGN(const RecordedTick* const next, recording->next());
    if (!next) return false;
    tick = *next;
    return true;
  }
};

Error about(Error error, const std::string& file) {
  if (!error.place.file) error.place.file = std::make_shared<const std::string>(file);
  return error;
}

Result<Side> open(const std::string& file) {
  Side side;
  side.file = file;
  if (is_snapshot_file(file)) {
    SL_ASSIGN(side.snapshot, read_snapshot_file(file));
    auto info = examine_snapshot(side.snapshot);
    if (!info) return about(std::move(info.error()), file);
    side.begin = std::move(*info);
    return side;
  }
  SL_ASSIGN(Recording recording, Recording::open(file));
  side.snapshot = recording.snapshot();
  side.begin = recording.begin();
  side.recording.emplace(std::move(recording));
  return side;
}

/// World of one side at `tick`, run again from its beginning.
Result<Replay> world_at(const Side& side, std::uint64_t tick, const DiffOptions& options) {
  Diagnostics diagnostics;
  auto replay = Replay::begin(
      side.snapshot, {.threads = options.threads, .compare = false, .paths = options.paths}, diagnostics);
  if (!replay) return about(std::move(replay.error()), side.file);
  if (!side.recording) return replay;
  SL_ASSIGN(Recording recording, Recording::open(side.file));
  while (replay->simulation().tick_index() < tick) {
    SL_ASSIGN(const RecordedTick* const next, recording.next());
    if (!next)
      return Error{"'" + side.file + "' ends at tick " + std::to_string(replay->simulation().tick_index()) +
                   ", before tick " + std::to_string(tick)};
    auto done = replay->tick(*next);
    if (!done) return about(std::move(done.error()), side.file);
  }
  return replay;
}

struct Found {
  std::vector<std::string> setups;
  bool differs = false;
  bool interrupted = false;
  std::uint64_t tick = 0;  ///< first that differs, or last that was compared
  Time now;
  std::uint64_t compared = 0;
  std::vector<std::string> parts;
  record::ValueDifferences values;
  std::string note;
};

/// Compares the two worlds themselves: all parts, or those that are known to differ.
Status compare_worlds(const Replay& a, const Replay& b, const DiffOptions& options, Found& found) {
  const Simulation &x = a.simulation(), &y = b.simulation();
  std::vector<std::string> names_a, names_b;
  std::vector<std::uint64_t> hashes_a, hashes_b;
  for (const SubHash& sub : x.sub_hashes()) names_a.push_back(sub.path), hashes_a.push_back(sub.hash);
  for (const SubHash& sub : y.sub_hashes()) names_b.push_back(sub.path), hashes_b.push_back(sub.hash);
  auto parts = record::differing_parts(names_a, hashes_a, names_b, hashes_b);
  if (found.parts.empty()) found.parts = parts;
  found.differs = found.differs || !parts.empty();
  found.setups = record::differing_setups(x, y);
  found.values = record::differing_values(x, y, parts, options.limit);
  return {};
}

Result<Found> compare_sides(Side& a, Side& b, const DiffOptions& options) {
  Found found;
  const auto both_at = [&](std::uint64_t tick) -> Status {
    SL_ASSIGN(Replay x, world_at(a, tick, options));
    SL_ASSIGN(Replay y, world_at(b, tick, options));
    found.tick = tick;
    found.now = x.simulation().now();
    return compare_worlds(x, y, options, found);
  };
  if (!a.recording || !b.recording) {
    // A snapshot is one moment: the other side is brought there.
    const Side& moment = a.recording ? b : a;
    const Side& other = a.recording ? a : b;
    if (other.begin.tick > moment.begin.tick || (!other.recording && other.begin.tick != moment.begin.tick))
      return Error{
          fmt::format("'{}' is of tick {}, '{}' {} tick {}: they have no tick in common", moment.file,
                      moment.begin.tick, other.file, other.recording ? "begins at" : "of", other.begin.tick),
          "compare states of the same time"};
    SL_TRY(both_at(moment.begin.tick));
    found.compared = 1;
    return found;
  }
  // Two recordings: their hashes give the first tick that differs, which may be that of the beginning.
  const std::uint64_t begin = std::max(a.begin.tick, b.begin.tick);
  for (Side* side : {&a, &b})
    while (side->at() < begin) {
      SL_ASSIGN(const bool more, side->advance());
      if (!more) return Error{"the two recordings have no tick in common"};
    }
  SL_TRY(both_at(begin));
  found.compared = 1;
  static const std::vector<std::string> none;
  while (!found.differs) {
    if (interrupted()) {
      found.note = "interrupted: what comes behind was not compared";
      found.interrupted = true;
      break;
    }
    bool more_a = true, more_b = true;
    do {
      // A recording may hold the hashes of its first state, or lack a tick.
      const std::uint64_t at_a = a.at(), at_b = b.at();
      if (at_a <= at_b) { SL_ASSIGN(more_a, a.advance()); }
      if (at_b <= at_a) { SL_ASSIGN(more_b, b.advance()); }
    } while (more_a && more_b && (a.at() != b.at() || a.at() <= begin));
    if (!more_a || !more_b) {
      if (more_a != more_b)
        found.note = "'" + (more_a ? a : b).file + "' goes on, '" + (more_a ? b : a).file + "' ends here";
      break;
    }
    ++found.compared;
    found.tick = a.at();
    found.now = a.now();
    if (a.tick->hash == b.tick->hash && a.tick->parts == b.tick->parts && a.tick->now == b.tick->now)
      continue;
    found.parts = record::differing_parts(a.tick->part_names ? *a.tick->part_names : none, a.tick->parts,
                                          b.tick->part_names ? *b.tick->part_names : none, b.tick->parts);
    if (a.tick->now != b.tick->now)
      found.note = "times: " + number_text(a.now().s()) + " s against " + number_text(b.now().s()) + " s";
    found.differs = true;
    const auto parts = found.parts;
    if (Status status = both_at(found.tick); !status) found.note = "no values: " + status.error().text();
    found.parts = parts;
  }
  return found;
}

}  // namespace

int diff(const DiffOptions& options) {
  auto a = open(options.a);
  if (!a) return complain(a.error());
  auto b = open(options.b);
  if (!b) return complain(b.error());
  catch_interrupts();
  auto compared = compare_sides(*a, *b, options);
  if (!compared) return complain(compared.error());
  const Found& found = *compared;
  if (options.json) {
    using Json = nlohmann::ordered_json;
    Json json{{"same", !found.differs && !found.interrupted},
              {"tick", found.tick},
              {"time", found.now.s()},
              {"compared", found.compared},
              {"setup", found.setups},
              {"parts", found.parts},
              {"value_count", found.values.count},
              {"values", Json::array()},
              {"note", found.note}};
    for (const record::ValueDifference& v : found.values.first)
      json["values"].push_back({{"address", v.address},
                                {"unit", v.unit},
                                {"a", v.a ? Json(*v.a) : Json()},
                                {"b", v.b ? Json(*v.b) : Json()},
                                {"more", v.more}});
    fmt::print("{}\n", json_text(json));
    return found.differs || found.interrupted ? exit_failed : exit_ok;
  }
  for (const std::string& text : found.setups) fmt::print("{}\n", text);
  if (!found.differs) {
    fmt::print("no difference in {} {}, up to {}\n", found.compared, found.compared == 1 ? "state" : "states",
               record::tick_text(found.tick, found.now));
  } else {
    std::string parts;
    for (std::size_t i = 0; i < std::min<std::size_t>(found.parts.size(), 12); ++i)
      parts += (i ? ", " : "") + found.parts[i];
    if (found.parts.size() > 12) parts += fmt::format(" and {} more", found.parts.size() - 12);
    fmt::print("first difference at {}: {}\n", record::tick_text(found.tick, found.now), parts);
    for (const record::ValueDifference& value : found.values.first) fmt::print("  {}\n", value.text());
    if (found.values.entries > found.values.first.size())
      fmt::print("  ... {} values differ in all (--limit shows more)\n", found.values.count);
  }
  if (!found.note.empty()) fmt::print("{}\n", found.note);
  return found.differs || found.interrupted ? exit_failed : exit_ok;
}

}  // namespace sandlot::app
