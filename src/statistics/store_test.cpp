/// The store of results: what is put in comes out, in this process and the next, and other files stay as they are.
#include "statistics/store.h"

#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace sandlot::statistics {
namespace {

using test::TestFolder;

StoredRun run_of(std::uint64_t seed) {
  return {seed, 12.5, "event 'done'", "00ff", {{"", 0.75, true}, {"red", std::nullopt, std::nullopt}}};
}

TEST(ResultStore, GivesBackWhatWasAddedAlsoAfterItWasClosed) {
  const TestFolder folder;
  const std::string file = folder.file("results.db");
  {
    auto store = ResultStore::open(file);
    ASSERT_TRUE(store) << store.error().text();
    const auto id = store->experiment({"abc", "clearing", "planar", "duration 60 s"});
    ASSERT_TRUE(id);
    for (const std::uint64_t seed : {3u, 1u, 2u, 9u}) ASSERT_TRUE(store->add(*id, run_of(seed)));
  }
  auto store = ResultStore::open(file);
  ASSERT_TRUE(store) << store.error().text();
  const auto id = store->experiment({"abc", "clearing", "planar", "duration 60 s"});
  const auto other = store->experiment({"abd", "clearing", "planar", "duration 60 s"});
  ASSERT_TRUE(id && other);
  EXPECT_NE(*id, *other);
  const auto runs = store->runs(*id, 1, 3);
  ASSERT_TRUE(runs) << runs.error().text();
  ASSERT_EQ(runs->size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ((*runs)[i].seed, i + 1);
  const StoredRun& one = runs->front();
  EXPECT_EQ(one.end_s, 12.5);
  EXPECT_EQ(one.stopped, "event 'done'");
  EXPECT_EQ(one.state_hash, "00ff");
  ASSERT_EQ(one.criteria.size(), 2u);
  EXPECT_EQ(one.criteria[0].value, 0.75);
  EXPECT_EQ(one.criteria[0].success, true);
  EXPECT_EQ(one.criteria[1].team, "red");
  EXPECT_FALSE(one.criteria[1].value || one.criteria[1].success);
  EXPECT_TRUE(store->runs(*other, 1, 3)->empty());
}

TEST(ResultStore, ARunThatIsAddedAgainReplacesTheFirst) {
  const TestFolder folder;
  auto store = ResultStore::open(folder.file("results.db"));
  ASSERT_TRUE(store);
  const auto id = store->experiment({"abc", "x", "rigid", ""});
  ASSERT_TRUE(id && store->add(*id, run_of(5)));
  ASSERT_TRUE(store->add(*id, {5, 1, "", "", {{"blue", 2.0, false}}}));
  const auto runs = store->runs(*id, 0, 100);
  ASSERT_TRUE(runs && runs->size() == 1);
  EXPECT_EQ(runs->front().end_s, 1);
  ASSERT_EQ(runs->front().criteria.size(), 1u);
  EXPECT_EQ(runs->front().criteria[0].success, false);
}

TEST(ResultStore, OtherFilesAreRefusedAndStayAsTheyAre) {
  const TestFolder folder;
  const std::string text = folder.write("notes.txt", std::string(4096, 'x'));
  const auto refused = ResultStore::open(text);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("is not a store of results"), std::string::npos)
      << refused.error().text();
  EXPECT_EQ(folder.read("notes.txt"), std::string(4096, 'x'));
  EXPECT_FALSE(ResultStore::open(folder.file("no/such/folder.db")));
}

}  // namespace
}  // namespace sandlot::statistics
