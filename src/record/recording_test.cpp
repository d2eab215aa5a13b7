#include "record/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/test_folder.h"
#include "messages/cdr.h"
#include "record/mcap/writer.h"
#include "record/playback.h"
#include "record/recorder.h"
#include "record/values_diff.h"
#include "sim/test_world.h"

namespace sandlot::record {
namespace {

using testing::HasSubstr;

/// Records 200 ticks of two rovers that wander on the planar engine, in short chunks.
std::unique_ptr<Simulation> record(const std::string& file, std::uint64_t seed = 7) {
  model::Setup setup = test::arena("planar", 2);
  setup.seed = seed;
  auto simulation = test::build(setup);
  RecordOptions options;
  options.recording.file = file;
  options.recording.chunk_s = 0.25;
  options.recording.compression = model::Recording::Compression::none;
  auto recorder = Recorder::start(options, *simulation);
  EXPECT_TRUE(static_cast<bool>(recorder));
  simulation->add_observer(recorder->get());
  test::advance(*simulation, 200);
  EXPECT_TRUE(static_cast<bool>((*recorder)->finish()));
  return simulation;
}

struct Verdict {
  std::uint64_t ticks = 0;  ///< that were replayed
  std::string text;         ///< first difference or error
  bool torn = false;
  std::uint64_t hash = 0;
};
Verdict verify(const std::string& file, Programs programs = Programs::recompute) {
  Verdict out;
  auto recording = Recording::open(file);
  if (!recording) return {0, recording.error().text()};
  out.torn = recording->torn().has_value();
  Diagnostics diagnostics;
  auto replay = Replay::begin(recording->snapshot(), {.programs = programs}, diagnostics);
  if (!replay) return {0, replay.error().text()};
  for (;;) {
    auto tick = recording->next();
    if (!tick) out.text = tick.error().text();
    if (!tick || !*tick) break;
    auto difference = replay->tick(**tick);
    if (!difference) out.text = difference.error().text();
    else if (*difference) out.text = (*difference)->text();
    if (!out.text.empty()) break;
  }
  out.ticks = replay->simulation().tick_index();
  out.hash = replay->simulation().state_hash();
  return out;
}

/// Copies a recording message by message. `change(message, data)` may change the bytes; false leaves the message out.
template <class Change>
void copy(const std::string& from, const std::string& to, Change&& change) {
  auto reader = mcap::Reader::open(from);
  ASSERT_TRUE(static_cast<bool>(reader));
  auto writer = mcap::Writer::create(to, {});
  ASSERT_TRUE(static_cast<bool>(writer));
  auto snapshot = reader->attachment(recording::snapshot_attachment);
  ASSERT_TRUE(static_cast<bool>(snapshot));
  ASSERT_TRUE(static_cast<bool>(writer->attach(recording::snapshot_attachment, "", 0, *snapshot)));
  std::map<std::uint16_t, std::uint16_t> ids;
  mcap::Cursor cursor = reader->messages({});
  for (;;) {
    auto message = cursor.next();
    ASSERT_TRUE(static_cast<bool>(message));
    if (!*message) break;
    const mcap::Channel& channel = *(*message)->channel;
    std::vector<std::byte> data((*message)->data.begin(), (*message)->data.end());
    if (!change(**message, data)) continue;
    if (!ids.contains(channel.id)) {
      const mcap::Schema& schema = *reader->schema_of(channel);
      const std::string_view text(reinterpret_cast<const char*>(schema.data.data()), schema.data.size());
      ids[channel.id] = writer->add_channel(writer->add_schema(schema.name, schema.encoding, text),
                                            channel.topic, channel.message_encoding);
    }
    ASSERT_TRUE(static_cast<bool>(writer->write(ids[channel.id], (*message)->log_time, data)));
  }
  ASSERT_TRUE(static_cast<bool>(writer->finish()));
}

TEST(Recording, ReplaysToTheHashOfTheRunBothWays) {
  const test::TestFolder folder;
  const auto simulation = record(folder.file("r.mcap"));
  for (const Programs programs : {Programs::recompute, Programs::logged}) {
    const Verdict verdict = verify(folder.file("r.mcap"), programs);
    EXPECT_EQ(verdict.text, "");
    EXPECT_EQ(verdict.ticks, 200u);
    EXPECT_FALSE(verdict.torn);
    // `logged` leaves the programs' own state as it was at the beginning.
    EXPECT_EQ(verdict.hash == simulation->state_hash(), programs == Programs::recompute);
  }
}

TEST(Recording, AChangedByteOfACommandNamesItsTickAndTarget) {
  const test::TestFolder folder;
  record(folder.file("r.mcap"));
  std::uint64_t changed = 0;
  copy(folder.file("r.mcap"), folder.file("changed.mcap"), [&](const mcap::Message& message, auto& data) {
    if (message.channel->topic != recording::log_topic || changed || message.log_time < 1'000'000'000)
      return true;
    msg::LogEntry entry;
    EXPECT_TRUE(read_cdr(message_info<msg::LogEntry>(), data, &entry));
    entry.bytes[3] ^= 1;
    changed = entry.tick;
    write_cdr(message_info<msg::LogEntry>(), &entry, data);
    return true;
  });
  const std::string tick = "tick " + std::to_string(changed) + " (";
  EXPECT_THAT(verify(folder.file("changed.mcap")).text,
              testing::AllOf(testing::StartsWith(tick), HasSubstr("rover1/drive")));
  EXPECT_THAT(verify(folder.file("changed.mcap"), Programs::logged).text, testing::StartsWith(tick));
}

TEST(Recording, TornOffItGoesAsFarAsItsLastWholeChunk) {
  const test::TestFolder folder;
  record(folder.file("r.mcap"));
  std::filesystem::resize_file(folder.file("r.mcap"),
                               std::filesystem::file_size(folder.file("r.mcap")) * 6 / 10);
  const Verdict verdict = verify(folder.file("r.mcap"));
  EXPECT_EQ(verdict.text, "");
  EXPECT_TRUE(verdict.torn);
  EXPECT_GT(verdict.ticks, 50u);
  EXPECT_LT(verdict.ticks, 150u);
}

TEST(Recording, SaysWhatKeepsItFromBeingReplayed) {
  const test::TestFolder folder;
  const std::string file = folder.file("r.mcap"), other = folder.file("other.mcap");
  record(file);
  const auto without = [&](const auto& wanted) {
    copy(file, other, wanted);
    return verify(other);
  };
  const Verdict gap = without([](const mcap::Message& m, auto&) {
    const bool ours = m.channel->topic == recording::log_topic || m.channel->topic == recording::hash_topic;
    return !(ours && m.log_time == 900'000'000);
  });
  EXPECT_THAT(gap.text, HasSubstr("the log is incomplete: tick 90 is missing"));
  EXPECT_EQ(gap.ticks, 89u);
  const Verdict no_hash = without([](const mcap::Message& m, auto&) {
    return !(m.channel->topic == recording::hash_topic && m.log_time == 510'000'000);
  });
  EXPECT_THAT(no_hash.text,
              testing::AnyOf(HasSubstr("tick 51 has no state hash"), HasSubstr("tick 51 is missing")));
  EXPECT_THAT(
      without([](const mcap::Message& m, auto&) { return m.channel->topic != recording::hash_topic; }).text,
      HasSubstr("without hashes"));
  const Verdict damaged = without([](const mcap::Message& m, auto& data) {
    if (m.channel->topic == recording::log_topic && m.log_time == 910'000'000) data.resize(data.size() / 2);
    return true;
  });
  EXPECT_THAT(damaged.text, HasSubstr(recording::log_topic));
  // Messages of devices do not matter.
  EXPECT_EQ(
      without([](const mcap::Message& m, auto&) { return m.channel->topic.starts_with("/sandlot/"); }).text,
      "");
  std::ofstream(other, std::ios::binary) << "no recording";
  EXPECT_THAT(verify(other).text, HasSubstr("other.mcap"));
}

TEST(Recording, ValuesTellWhereTwoSeedsDiffer) {
  const test::TestFolder folder;
  const auto a = record(folder.file("a.mcap"), 7), b = record(folder.file("b.mcap"), 8);
  EXPECT_THAT(differing_setups(*a, *b), testing::ElementsAre("seed: 7 against 8"));
  const std::string parts[] = {"rover1", "rover1/laser"};
  const ValueDifferences found = differing_values(*a, *b, parts, 1000);
  EXPECT_EQ(found.entries, found.first.size());
  const auto has = [&](const std::string& address) {
    for (const ValueDifference& value : found.first)
      if (value.address == address) return value.a && value.b && *value.a != *value.b;
    return false;
  };
  EXPECT_TRUE(has("rover1.pose.x"));
  // A list is one entry, so that it hides nothing of what comes after it.
  const auto is_range = [](const ValueDifference& value) {
    return value.address.starts_with("rover1/laser.ranges[");
  };
  ASSERT_EQ(std::count_if(found.first.begin(), found.first.end(), is_range), 1);
  const ValueDifference& range = *std::find_if(found.first.begin(), found.first.end(), is_range);
  EXPECT_GT(range.more, 0u);
  EXPECT_THAT(range.text(), HasSubstr(" more of the list)"));
  std::size_t all = 0;
  for (const ValueDifference& value : found.first) all += 1 + value.more;
  EXPECT_EQ(all, found.count);
  EXPECT_EQ(differing_values(*a, *b, parts, 1).first.size(), 1u);
  EXPECT_EQ(differing_values(*a, *b, parts, 1).count, found.count);
  EXPECT_TRUE(differing_values(*a, *a, parts, 1000).first.empty());
}

TEST(Playback, OrdersOfARecordedRobotLeadAnotherOneAlongTheSamePath) {
  const test::TestFolder folder;
  const auto original = record(folder.file("r.mcap"));
  model::Setup setup = test::arena("planar", 2);
  ASSERT_EQ(setup.instances.back().name, "rover2");
  const auto configure = [&](std::initializer_list<std::pair<const char*, std::string>> keys) {
    model::ControllerDecl& controller = setup.instances.back().controllers.front();
    controller.kind = "playback";
    controller.config = test::map(keys);
    return resolve_playbacks(setup, {});
  };
  ASSERT_TRUE(configure({{"file", folder.file("r.mcap")}, {"commands", "rover2/drive"}}));
  const auto again = test::build(setup);
  test::advance(*again, 200);
  const auto pose = [](const Simulation& s) { return s.engine().pose(*s.find_instance("rover2")); };
  EXPECT_EQ(pose(*again).p, pose(*original).p) << "the same orders in the same ticks: to the last bit";

  const auto complaint = [&](std::initializer_list<std::pair<const char*, std::string>> keys) {
    const Status status = configure(keys);
    return status ? "" : status.error().text();
  };
  // A team's are filled, too.
  model::Setup other = test::arena("planar", 1);
  other.teams.push_back({"red", {}, {}});
  model::ControllerDecl of_team;
  of_team.name = "player", of_team.kind = "playback";
  of_team.config = test::map({{"file", folder.file("r.mcap")}, {"commands", "rover2/drive"}});
  other.teams.back().controllers.push_back(of_team);
  ASSERT_TRUE(resolve_playbacks(other, {}));
  EXPECT_NE(std::as_const(other.teams.back().controllers)[0].config.find("samples"), nullptr);

  const std::string file = folder.file("r.mcap");
  EXPECT_THAT(complaint({{"file", file}, {"topic", "/nowhere"}}),
              testing::AllOf(HasSubstr("no topic '/nowhere'"), HasSubstr("/rover1/")));
  EXPECT_THAT(complaint({{"file", file}, {"topic", "/rover1/laser/ranges"}}), HasSubstr("tells no velocity"));
  EXPECT_THAT(complaint({{"file", file}, {"commands", "rover3/drive"}}), HasSubstr("rover1/drive"));
  EXPECT_THAT(complaint({{"file", file}, {"commands", "x"}, {"topic", "y"}}),
              HasSubstr("both a topic and commands"));
  EXPECT_THAT(complaint({{"file", folder.file("none.mcap")}}), HasSubstr("none.mcap"));
  std::ofstream(folder.file("t.csv")) << "time,vx,vy,wz\n0,1,0,0\n1,1,0\n";
  EXPECT_THAT(complaint({{"file", folder.file("t.csv")}}), HasSubstr("row 3 has 3 numbers"));
}

}  // namespace
}  // namespace sandlot::record
