/// `sandlot tournament`: games are played, kept and not played again; mistakes are named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "command.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string hashes_of(const nlohmann::json& tournament) {
  std::string out;
  for (const auto& game : tournament["games"])
    out += game["left"].get<std::string>() + game["right"].get<std::string>() +
           game["state_hash"].get<std::string>() + "\n";
  return out;
}

/// A team whose robots wander about.
std::string wanderers(const TestFolder& folder, const std::string& name, double speed) {
  fs::create_directory(folder.path / name);
  folder.write(name + "/team.yaml", "version: 1\nname: " + name +
                                        "\nplayers: 1\nrobots: [{controller: {kind: wander, speed: " +
                                        std::to_string(speed) + "}}]\n");
  return folder.file(name);
}

TEST(TournamentCommand, PlaysOnceAndGoesOn) {
  const TestFolder scratch;
  const std::string teams = "tournament " + wanderers(scratch, "Fast", 0.8) + " " +
                            wanderers(scratch, "Slow", 0.2) +
                            " --duration '2 s' --level world --drive ideal "
                            "--physics planar --seeds 2 --out ";
  const std::string out = scratch.file("cup");
  const Printed first = sandlot(teams + out + " --jobs 2");
  ASSERT_EQ(first.exit_code, 0) << first.out;
  for (const char* const name :
       {"index.html", "table.csv", "pairs.csv", "games.csv", "tournament.json", "results.db"})
    EXPECT_TRUE(fs::exists(out + "/" + name)) << name;
  EXPECT_TRUE(fs::exists(out + "/games/r1_Fast_Slow_s1.mcap"));
  EXPECT_TRUE(fs::exists(out + "/games/r1_Slow_Fast_s2.mcap"));
  const auto played = read_json(out + "/tournament.json");
  ASSERT_EQ(played["games"].size(), 2u);
  EXPECT_EQ(played["stored"], 0);

  const Printed again = sandlot(teams + out + " --json");
  ASSERT_EQ(again.exit_code, 0) << again.out;
  const auto stored = nlohmann::json::parse(again.out, nullptr, false);
  EXPECT_EQ(stored["stored"], 2);
  EXPECT_EQ(hashes_of(stored), hashes_of(played));
  EXPECT_EQ(stored["games"][0]["recording"], played["games"][0]["recording"]);

  // Played anew, one after the other and without recordings: the same games.
  const Printed alone = sandlot(teams + scratch.file("again") + " --jobs 1 --no-recordings");
  ASSERT_EQ(alone.exit_code, 0) << alone.out;
  const auto other = read_json(scratch.file("again/tournament.json"));
  EXPECT_EQ(other["stored"], 0);
  EXPECT_EQ(hashes_of(other), hashes_of(played));
  EXPECT_FALSE(fs::exists(scratch.file("again/games")));
}

TEST(TournamentCommand, NamesMistakes) {
  const TestFolder scratch;
  const std::string out = " --out " + scratch.file("cup");
  const auto refused = [&](const std::string& arguments, const char* words) {
    const Printed printed = sandlot("tournament " + arguments);
    EXPECT_EQ(printed.exit_code, 2) << arguments;
    EXPECT_THAT(printed.out, HasSubstr(words));
  };
  refused("teams/passing" + out, "two teams at least");
  refused("teams/nobody teams/passing" + out, "teams/nobody");
  refused("docs teams/passing" + out, "there is no team in 'docs'");
  refused("teams --format league" + out, "--format");
  refused("teams --rounds 3" + out, "only a swiss tournament");
  refused("teams --seeds 0" + out, "--seeds");
  refused("teams", "--out");
  refused("teams --out /dev/null/cup", "--out /dev/null/cup");
}

}  // namespace
}  // namespace sandlot::test
