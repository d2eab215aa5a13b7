/// Recordings of a run, and that recording does not change it.
#include "record/recorder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "base/test_folder.h"
#include "messages/cdr.h"
#include "messages/make_info.h"
#include "record/glob.h"
#include "record/layout.h"
#include "record/mcap/repair.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

class RecorderTest : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_.file(name); }
  const TestFolder folder_;
};

/// Runs two rovers for `ticks` of 10 ms with a recorder. @return the hash at the end
std::uint64_t record(const model::Recording& recording, int ticks, Recorder::Report& report, Status& status) {
  const auto simulation = build(arena("planar", 2));
  auto recorder = Recorder::start({.recording = recording, .version = "test"}, *simulation);
  EXPECT_TRUE(recorder) << recorder.error().text();
  if (!recorder) return 0;
  simulation->add_observer(recorder->get());
  advance(*simulation, ticks);
  status = (*recorder)->finish();
  report = (*recorder)->report();
  return simulation->state_hash();
}

std::uint64_t hash_without(int ticks) {
  const auto simulation = build(arena("planar", 2));
  advance(*simulation, ticks);
  return simulation->state_hash();
}

TEST(Glob, StarsAndQuestionMarks) {
  EXPECT_TRUE(glob_matches("/rover/*", "/rover/laser/ranges"));
  EXPECT_TRUE(glob_matches("*laser*", "/rover/laser/ranges"));
  EXPECT_TRUE(glob_matches("/rover?/tf", "/rover1/tf"));
  EXPECT_TRUE(glob_matches("/rover?tf", "/rover/tf"));
  EXPECT_TRUE(glob_matches("*a*b", "/aab/ab"));
  EXPECT_FALSE(glob_matches("/rover/*", "/rover1/laser"));
  EXPECT_FALSE(glob_matches("/rover", "/rover/laser"));
  EXPECT_FALSE(glob_matches("", "x"));
}

/// The programs of tick 1 act upon what was measured when the world was made, so that a program which is fed from the recording needs it.
TEST_F(RecorderTest, BeginsWithTheMessagesOfTheMomentAtWhichItBegins) {
  Recorder::Report report;
  Status status;
  record({.file = file("r.mcap")}, 20, report, status);
  ASSERT_TRUE(status) << status.error().text();
  std::vector<std::string> expected, found;
  const auto simulation = build(arena("planar", 2));
  simulation->for_each_topic([&](const TopicBase& topic, const std::string&) {
    if (topic.count > 0) expected.push_back(topic.name());
  });
  EXPECT_GE(expected.size(), 2u) << "a sensor of each rover";
  const auto reader = mcap::Reader::open(file("r.mcap"));
  ASSERT_TRUE(reader);
  mcap::Cursor cursor = reader->messages({.to = 0});
  while (true) {
    const auto message = cursor.next();
    ASSERT_TRUE(message);
    if (!*message) break;
    const std::string& topic = (*message)->channel->topic;
    if (topic.rfind("/rover", 0) == 0) found.push_back(topic);
  }
  EXPECT_EQ(found, expected);
}

TEST_F(RecorderTest, TheProofIsInTheFileAndTheRunDidNotNotice) {
  Recorder::Report report;
  Status status;
  const std::uint64_t hash = record({.file = file("r.mcap")}, 200, report, status);
  ASSERT_TRUE(status) << status.error().text();
  EXPECT_EQ(hash, hash_without(200));
  EXPECT_EQ(report.frames, 200u);
  EXPECT_TRUE(report.complete());
  EXPECT_EQ(report.dropped_messages, 0u);
  const auto examined = mcap::examine(file("r.mcap"));
  ASSERT_TRUE(examined);
  EXPECT_TRUE(examined->whole());

  const auto reader = mcap::Reader::open(file("r.mcap"));
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->summary().statistics.message_count, report.messages);
  EXPECT_EQ(reader->metadata(recording::end_metadata)->at("complete"), "true");
  // One hash per tick and that of the beginning; 2 s at 50 Hz of /tf and the one at tick 1, since 0 s was due then.
  mcap::Cursor hashes = reader->messages({.topics = {recording::hash_topic}});
  std::uint64_t tick = 0, last = 0;
  for (;;) {
    const auto message = hashes.next();
    ASSERT_TRUE(message);
    if (!*message) break;
    msg::StateHash found;
    ASSERT_TRUE(read_cdr(message_info<msg::StateHash>(), (*message)->data, &found));
    EXPECT_EQ(found.tick, tick++);
    EXPECT_EQ((*message)->log_time, static_cast<std::uint64_t>(found.stamp.ns));
    last = found.hash;
  }
  EXPECT_EQ(tick, 201u);
  EXPECT_EQ(last, hash);
  const mcap::Channel* const tf = reader->find_channel(recording::tf_topic);
  ASSERT_TRUE(tf);
  EXPECT_EQ(reader->summary().statistics.channel_message_counts.at(tf->id), 101u);
  // The snapshot is the beginning: 200 ticks from it lead to the same end.
  const auto snapshot = reader->attachment(recording::snapshot_attachment);
  ASSERT_TRUE(snapshot);
  Diagnostics diagnostics;
  const auto again = Simulation::restore(*snapshot, {}, diagnostics);
  ASSERT_TRUE(again);
  advance(**again, 200);
  EXPECT_EQ((*again)->state_hash(), hash);
}

TEST_F(RecorderTest, OnlyTheChosenTopicsAndTheProof) {
  Recorder::Report report;
  Status status;
  record({.file = file("r.mcap"), .topics = {"/rover1/laser*"}}, 50, report, status);
  ASSERT_TRUE(status);
  const auto reader = mcap::Reader::open(file("r.mcap"));
  ASSERT_TRUE(reader);
  bool laser = false;
  for (const auto& [id, channel] : reader->summary().channels) {
    const bool chosen = channel.topic.rfind("/rover1/laser", 0) == 0;
    laser |= chosen;
    EXPECT_TRUE(chosen || channel.topic.rfind("/sandlot/", 0) == 0) << channel.topic;
  }
  EXPECT_TRUE(laser);
}

TEST_F(RecorderTest, APipeThatNobodyEmptiesCostsMessagesAndNotTheRun) {
  ASSERT_EQ(mkfifo(file("pipe").c_str(), 0600), 0);
  const int reader = ::open(file("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  const auto simulation = build(arena("planar", 2));
  model::Recording recording{.file = file("pipe"), .compression = model::Recording::Compression::none};
  recording.queue_mb = 1;
  recording.chunk_mb = 0.01;
  auto recorder = Recorder::start({.recording = recording, .version = "test"}, *simulation);
  ASSERT_TRUE(recorder) << recorder.error().text();
  simulation->add_observer(recorder->get());
  advance(*simulation, 3000);
  EXPECT_EQ(simulation->state_hash(), hash_without(3000));
  ::close(reader);  // the writer's wait ends with a broken pipe, which is not an end of the process
  const Status status = (*recorder)->finish();
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, testing::HasSubstr("pipe"));
  EXPECT_GT((*recorder)->report().dropped_messages, 0u);
}

/// Reads a pipe to its end into a file.
std::thread empty_into(int pipe, const std::string& file) {
  fcntl(pipe, F_SETFL, 0);  // from now on a read waits
  return std::thread([pipe, file] {
    std::ofstream out(file, std::ios::binary);
    std::vector<char> bytes(1 << 16);
    for (ssize_t n = 0; (n = ::read(pipe, bytes.data(), bytes.size())) > 0;) out.write(bytes.data(), n);
    ::close(pipe);
  });
}

TEST_F(RecorderTest, WhileItIsBehindItKeepsTheProofAsFarAsAQuarterOfTheQueueAndGoesOnWhenItCan) {
  ASSERT_EQ(mkfifo(file("pipe").c_str(), 0600), 0);
  const int reader_end = ::open(file("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader_end, 0);
  const auto simulation = build(arena("planar", 2));
  model::Recording recording{.file = file("pipe"), .compression = model::Recording::Compression::none};
  recording.queue_mb = 1;
  recording.chunk_mb = 0.01;
  auto recorder = Recorder::start({.recording = recording, .version = "test"}, *simulation);
  ASSERT_TRUE(recorder) << recorder.error().text();
  simulation->add_observer(recorder->get());
  // Nobody reads: the queue fills, then the quarter of it for proofs; ticks after that are lost whole.
  for (int i = 0; i < 20000 && (*recorder)->so_far().lost_frames < 100; ++i) advance(*simulation, 1);
  ASSERT_GE((*recorder)->so_far().lost_frames, 100u)
      << "logs and hashes of ticks may not wait without a limit";
  const std::uint64_t behind_ticks = simulation->tick_index();
  // The tick that brings a robot is lost, too.
  simulation->submit(SpawnRequest{rover("late", rover_model(), {0, -2, 0}, 0, "")});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->outcomes()[0].status) << simulation->outcomes()[0].status.error().text();
  std::thread emptied = empty_into(reader_end, file("r.mcap"));
  // Whole frames again once there is room.
  const std::uint64_t lost = (*recorder)->so_far().dropped_messages;
  std::uint64_t dropped = lost;
  for (int i = 0; i < 2000; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    advance(*simulation, 1);
    const std::uint64_t now = (*recorder)->so_far().dropped_messages;
    if (i > 100 && now == dropped) break;
    dropped = now;
  }
  advance(*simulation, 50);
  const std::uint64_t hash = simulation->state_hash();
  const Status status = (*recorder)->finish();
  const Recorder::Report report = (*recorder)->report();
  recorder->reset();
  emptied.join();
  ASSERT_TRUE(status) << status.error().text();

  const auto reader = mcap::Reader::open(file("r.mcap"));
  ASSERT_TRUE(reader) << reader.error().text();
  EXPECT_EQ(reader->metadata(recording::end_metadata)->at("complete"), "false");
  EXPECT_EQ(reader->summary().statistics.message_count, report.messages);
  std::uint64_t hashes = 0, last_hash = 0, waited_bytes = 0;
  bool late = false;
  mcap::Cursor cursor = reader->messages({});
  for (;;) {
    const auto message = cursor.next();
    ASSERT_TRUE(message);
    if (!*message) break;
    const std::string& topic = (*message)->channel->topic;
    if (topic == recording::hash_topic) {
      msg::StateHash found;
      ASSERT_TRUE(read_cdr(message_info<msg::StateHash>(), (*message)->data, &found));
      last_hash = found.hash;
      ++hashes;
    } else if (topic == recording::tf_static_topic) {
      const std::string_view bytes(reinterpret_cast<const char*>((*message)->data.data()),
                                   (*message)->data.size());
      late |= bytes.find("late/") != std::string_view::npos;
    } else if ((*message)->log_time <= behind_ticks * 10'000'000) {
      waited_bytes += (*message)->data.size();
    }
  }
  // That of the beginning, and one for each tick that was not lost.
  EXPECT_EQ(hashes, 1 + report.frames - report.lost_frames);
  EXPECT_EQ(last_hash, hash);
  EXPECT_TRUE(late) << "the transforms of a robot that came in a lost tick are still owed";
  // What waited fits the queue; the pipe holds 64 KiB and the writer a chunk besides.
  EXPECT_LT(waited_bytes, (1 << 20) + (1 << 16) + 100'000u);
}

TEST_F(RecorderTest, APlaceThatCannotBeWrittenIsKnownAtTheStart) {
  const auto simulation = build(arena("planar", 1));
  EXPECT_FALSE(Recorder::start({.recording = {.file = file("no/such/folder.mcap")}}, *simulation));
  const auto full = Recorder::start({.recording = {.file = "/dev/full"}}, *simulation);
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().what, testing::HasSubstr("/dev/full"));
}

TEST_F(RecorderTest, MoreTopicsThanAFileCanHaveAreAnError) {
  const auto simulation = build(arena("planar", 1));
  auto writer = FrameWriter::create({.recording = {.file = file("r.mcap")}, .version = "test"}, *simulation);
  ASSERT_TRUE(writer) << writer.error().text();
  Frame frame;
  for (int i = 0; i < 70'000; ++i)
    frame.topics.push_back(std::make_shared<Topic<msg::Clock>>("/t" + std::to_string(i)));
  const Status status = writer->write(frame, nullptr);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, testing::HasSubstr("as many topics as a file can have"));
  EXPECT_TRUE(writer->finish({}));
  EXPECT_TRUE(mcap::examine(file("r.mcap"))->whole());
}

}  // namespace
}  // namespace sandlot::test
