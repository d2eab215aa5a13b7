#include "wire/refbox.h"

#include <gtest/gtest.h>

#include <set>

namespace sandlot::refbox {
namespace {

using namespace std::string_literals;  // NOLINT(google-build-using-namespace): NULs in texts

const TeamIds ids{.cyan = "224.16.32.39", .magenta = "224.16.32.74"};

std::string error_of(const std::string& text) {
  const auto state = read_world_state(text);
  return state ? "" : state.error().text();
}

/// A world state with other content for one key. Empty: the key is left out.
std::string state_with(const std::string& key, const std::string& value) {
  std::string out = "{";
  for (const auto& [name, usual] : std::vector<std::pair<std::string, std::string>>{
           {"type", R"("worldstate")"},
           {"teamName", R"("Owls")"},
           {"intention", R"("attack")"},
           {"ageMs", "20"},
           {"robots",
            R"([{"id":1,"pose":[1.5,-2,0.25],"targetPose":[0,0],"velocity":[0.5,0,0],"ballEngaged":true}])"},
           {"balls", R"([{"position":[1,2,0.11],"velocity":[0,0,0],"confidence":0.9}])"},
           {"obstacles", R"([{"position":[3,4],"radius":0.25}])"}}) {
    const std::string& written = name == key ? value : usual;
    if (written.empty()) continue;
    if (out.size() > 1) out += ",";
    out += "\"" + name + "\":" + written;
  }
  return out + "}";
}

TEST(RefboxWords, AreTheBytesOf2009) {
  // The list of the league's base stations, without the request for a world state, the dummy and the second byte of a double
  // yellow card, which no word of ours means.
  const std::string bytes = "SsNhezZWVv1234LKkFfGgTtCcPpAaDdOoIiRrYyBb";
  std::set<char> seen;
  for (const char byte : bytes) {
    const auto word = word_of(byte);
    ASSERT_TRUE(word) << byte;
    const auto back = byte_of(*word);
    ASSERT_TRUE(back) << back.error().text();
    EXPECT_EQ(*back, byte);
    EXPECT_TRUE(seen.insert(byte).second);
  }
  for (int each = -128; each < 128; ++each)
    EXPECT_EQ(word_of(static_cast<char>(each)).has_value(), seen.count(static_cast<char>(each)) > 0) << each;
  EXPECT_EQ(*byte_of({"KICKOFF", Side::cyan}), 'K');
  EXPECT_EQ(*byte_of({"KICKOFF", Side::magenta}), 'k');
  EXPECT_EQ(*byte_of({"STOP", Side::both}), 'S');
  EXPECT_EQ(*byte_of({"STOP", Side::magenta}), 'S') << "s is START";
  EXPECT_EQ(*byte_of({"REPAIR", Side::magenta, 3}), 'o');
}

TEST(RefboxWords, ThatCannotBeSentAreNamed) {
  EXPECT_EQ(byte_of({"DANCE", Side::both}).error().text(),
            "the league's referee box has no word 'DANCE'; such as STOP, KICKOFF, START");
  EXPECT_EQ(byte_of({"KICKOFF", Side::both}).error().text(),
            "KICKOFF is said of one team, but none is named");
  EXPECT_EQ(byte_of({"SUBSTITUTION", Side::cyan, 2}).error().text(),
            "the protocol of 2009 has no byte for SUBSTITUTION");
  EXPECT_EQ(byte_of({"END_PART", Side::both}).error().text(),
            "the protocol of 2009 has no byte for END_PART");
  EXPECT_FALSE(json_of({"REPAIR", Side::cyan, 1000}, ids));
  EXPECT_EQ(side_of("red").error().text(), "no team 'red'; cyan or magenta");
}

TEST(RefboxWords, AreTheJsonOf2020) {
  EXPECT_EQ(*json_of({"STOP", Side::both}, ids), R"({"command":"STOP","targetTeam":""})" + "\0"s);
  EXPECT_EQ(*json_of({"KICKOFF", Side::cyan}, ids),
            R"({"command":"KICKOFF","targetTeam":"224.16.32.39"})" + "\0"s);
  EXPECT_EQ(*json_of({"SUBSTITUTION", Side::magenta, 4}, ids),
            R"({"command":"SUBSTITUTION","targetTeam":"224.16.32.74","robotID":4})" + "\0"s);
  for (const WordInfo& each : words()) {
    const Word word{std::string(each.command), each.of_team ? Side::magenta : Side::both,
                    each.names_robot ? 2 : 0};
    std::string text = *json_of(word, ids);
    EXPECT_EQ(text.back(), '\0');
    text.pop_back();
    const auto back = read_json(text, ids);
    ASSERT_TRUE(back) << back.error().text();
    EXPECT_EQ(*back, word) << text;
  }
  EXPECT_FALSE(read_json(R"({"command":"STOP"})", ids));
  EXPECT_FALSE(read_json(R"({"command":"STOP","targetTeam":"224.16.32.1"})", ids));
  EXPECT_FALSE(read_json(R"({"command":"KICKOFF","targetTeam":""})", ids));
}

TEST(RefboxWorldStates, AreRead) {
  const auto state = read_world_state(state_with("", ""));
  ASSERT_TRUE(state) << state.error().text();
  EXPECT_EQ(state->team, "Owls");
  EXPECT_EQ(state->age_ms, 20);
  ASSERT_EQ(state->robots.size(), 1u);
  EXPECT_EQ(state->robots[0].pose, (std::array<double, 3>{1.5, -2, 0.25}));
  EXPECT_TRUE(state->robots[0].ball_engaged);
  ASSERT_EQ(state->balls.size(), 1u);
  EXPECT_EQ(state->balls[0].position[2], 0.11);
  EXPECT_EQ(state->obstacles.size(), 1u);
}

TEST(RefboxWorldStates, NeedTheKeysOfTheLeague) {
  for (const char* key : {"type", "teamName", "intention", "ageMs", "robots", "balls", "obstacles"}) {
    EXPECT_NE(error_of(state_with(key, "")).find(key), std::string::npos) << key;
    EXPECT_NE(error_of(state_with(key, "{}")).find(key), std::string::npos) << key << " of another type";
  }
  EXPECT_EQ(error_of(state_with("type", R"("chat")")), "a message of type 'chat'; worldstate");
  EXPECT_EQ(error_of("hello"), "a message that is not JSON");
  EXPECT_EQ(error_of(state_with("robots", "[7]")), "robots[0] is not an object");
}

TEST(RefboxWorldStates, WithNumbersThatAreNoneAreRefusedByName) {
  EXPECT_EQ(error_of(state_with("robots", R"([{"pose":[0,0,0]},{"pose":[0,NaN,0]}])")),
            "robots[1].pose[1] is not a finite number; leave out what is not known");
  EXPECT_EQ(error_of(state_with("balls", R"([{"position":[-Infinity,0,0]}])")),
            "balls[0].position[0] is not a finite number; leave out what is not known");
  EXPECT_EQ(error_of(state_with("robots", R"([{"pose":[null,0,0]}])")),
            "robots[0].pose[0] is not a finite number; leave out what is not known");
  EXPECT_EQ(error_of(state_with("obstacles", R"([{"position":[0,1e999]}])")),
            "obstacles[0].position[1] is not a finite number; leave out what is not known");
  EXPECT_EQ(error_of(state_with("robots", R"([{"pose":[0,0,1e7]}])")),
            "robots[0].pose[2] is not within a million; metres, radians and their like");
  EXPECT_EQ(error_of(state_with("balls", R"([{"position":[0,0,0],"confidence":nan}])")),
            "a number that is NaN or infinite; leave out what is not known");
  EXPECT_EQ(error_of(state_with("intention", R"("NaN, \"Infinity\"")")), "") << "a text may hold it";
}

TEST(RefboxWorldStates, HaveLimits) {
  std::string many = "[{}";
  for (std::size_t i = 0; i < most_entries; ++i) many += ",{}";
  EXPECT_EQ(error_of(state_with("obstacles", many + "]")), "'obstacles' has 65 entries; at most 64");
  EXPECT_NE(error_of(state_with("balls", std::string(100, '[') + std::string(100, ']'))), "");
  EXPECT_NE(error_of(std::string(most_bytes + 1, ' ')).find("at most 100000"), std::string::npos);
}

TEST(RefboxStream, HandsOutWhatEndsInANul) {
  MessageStream stream;
  stream.append("one\0\0tw"s);
  EXPECT_EQ(*stream.next(), "one");
  EXPECT_EQ(*stream.next(), std::nullopt);
  stream.append("o\0"s);
  EXPECT_EQ(*stream.next(), "two");
  EXPECT_EQ(*stream.next(), std::nullopt);
  EXPECT_EQ(stream.waiting(), 0u);
  stream.append(std::string(most_bytes, 'x'));
  EXPECT_TRUE(stream.next());
  stream.append("x");
  EXPECT_FALSE(stream.next());
}

}  // namespace
}  // namespace sandlot::refbox
