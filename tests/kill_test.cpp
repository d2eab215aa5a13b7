/// Recording processes that are killed: what is on the disk opens after repair, in order, at most one chunk
/// short.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "base/random.h"
#include "base/test_folder.h"
#include "record/mcap/repair.h"

namespace sandlot::test {
namespace {

pid_t start(const std::string& file) {
  const pid_t child = fork();
  if (child != 0) return child;
  if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(3);
  execl(SANDLOT_BIN, SANDLOT_BIN, "run", "scenarios/indoor.yaml", "--duration", "60s", "--record",
        file.c_str(), nullptr);
  _exit(3);
}

TEST(SlowKill, AtFiftyRandomMomentsEveryFileOpensAndIsTheBeginningOfTheUndisturbedOne) {
  const test::TestFolder folder;
  const std::string whole = folder.file("whole.mcap"), killed = folder.file("killed.mcap");
  int status = 0;
  waitpid(start(whole), &status, 0);
  ASSERT_EQ(status, 0);
  const auto reference = mcap::Reader::open(whole);
  ASSERT_TRUE(reference);
  std::uint64_t largest = 0;
  for (const mcap::ChunkIndex& chunk : reference->summary().chunks)
    largest = std::max(largest, chunk.length + chunk.message_index_length);
  Stream random(1, entity_key("kill"), Purpose::controller, 0);
  int torn = 0;
  for (int i = 0; i < 50; ++i) {
    const pid_t child = start(killed);
    usleep(static_cast<useconds_t>(random.uniform(20e3, 500e3)));
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    const auto examined = mcap::examine(killed);
    if (!examined) {  // killed before its first bytes
      std::filesystem::remove(killed);
      continue;
    }
    if (!examined->whole()) {
      ++torn;
      const auto repaired = mcap::repair(killed, *examined);
      ASSERT_TRUE(repaired) << repaired.error().text();
      EXPECT_LE(repaired->lost_bytes, largest) << "more than the one chunk whose writing was cut off";
    }
    const auto reader = mcap::Reader::open(killed);
    ASSERT_TRUE(reader && reader->indexed());
    // Every chunk that reached the disk whole is kept: their places are those in the undisturbed recording.
    const auto on_disk = std::ranges::count_if(
        reference->summary().chunks,
        [&](const mcap::ChunkIndex& chunk) { return chunk.offset + chunk.length <= examined->file_bytes; });
    EXPECT_EQ(std::ssize(reader->summary().chunks), on_disk);
    // The same chunks as the undisturbed run's, from the first on: what was closed is all there.
    mcap::Cursor ours = reader->messages({}), theirs = reference->messages({});
    for (std::uint64_t n = 0; n < reader->summary().statistics.message_count; ++n) {
      const auto a = ours.next(), b = theirs.next();
      ASSERT_TRUE(a && b && *a && *b);
      ASSERT_EQ((*a)->channel->topic, (*b)->channel->topic) << n;
      ASSERT_EQ((*a)->log_time, (*b)->log_time) << n;
      ASSERT_TRUE(std::equal((*a)->data.begin(), (*a)->data.end(), (*b)->data.begin(), (*b)->data.end()))
          << n;
    }
    std::filesystem::remove(killed);
  }
  EXPECT_GT(torn, 10) << "the moments were not random enough to prove anything";
}

}  // namespace
}  // namespace sandlot::test
