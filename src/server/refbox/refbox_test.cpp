/// Referee box: base stations are told what the referee says, and none of them harms the box, the other team or the run.
#include "server/refbox/refbox.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "messages/command.h"
#include "messages/sandlot_soccer.h"
#include "server/test_socket.h"
#include "sim/session/session.h"
#include "sim/test_world.h"

namespace sandlot::server {
namespace {

using namespace std::string_literals;  // NOLINT(google-build-using-namespace): NULs in texts
using refbox::Side;
using refbox::Word;

constexpr const char* good_state =
    R"({"type":"worldstate","teamName":"Owls","intention":"attack","ageMs":0,"robots":[{"id":1,"pose":[1,2,0]}],"balls":[],"obstacles":[]})";

LogEntry said(std::uint64_t sequence, const std::string& command, const std::string& team,
              const std::string& robot = "cyan1") {
  msg::RefereeCommand message;
  message.sequence = sequence;
  message.command = command;
  message.team = team;
  LogEntry out;
  out.source.kind = Source::Kind::rule;
  out.target = robot + "/referee";
  out.type = msg::RefereeCommand::ros_type;
  out.bytes = command_bytes(message);
  return out;
}

/// A box whose run stands still, and base stations of it.
struct ServedBox {
  explicit ServedBox(const std::string& teams = "", const std::string& protocols = "",
                     RefboxOptions options = {})
      : session(sandlot::test::build(sandlot::test::arena("planar", 1, "")), {}) {
    auto read = read_refbox_teams(teams, protocols);
    EXPECT_TRUE(read) << read.error().text();
    options.port = 0;
    options.teams = *read;
    auto made = Refbox::start(options, session);
    EXPECT_TRUE(made) << made.error().text();
    box = std::move(*made);
  }
  Socket station() const { return Socket(box->port()); }
  RefboxReport team(Side side) const { return box->teams()[side == Side::cyan ? 0 : 1]; }
  /// Waits until the box has taken what came.
  bool soon_connected(Side side) const {
    return soon([&] { return !team(side).address.empty(); });
  }
  Session session;
  std::unique_ptr<Refbox> box;
};

/// The next message of a base station of JSON.
std::string next(Socket& socket) {
  std::size_t end = 0;
  while ((end = socket.seen.find('\0')) == std::string::npos)
    if (!socket.more()) return "";
  std::string out = socket.take(end + 1);
  out.pop_back();
  return out;
}

TEST(RefereeWords, AreGivenOnceAndInOrder) {
  Frame frame;
  frame.log = {said(1, "STOP", "", "cyan1"), said(2, "KICKOFF", "cyan", "cyan1"),
               said(1, "STOP", "", "magenta1"), said(2, "KICKOFF", "cyan", "magenta1")};
  RefereeWords words;
  EXPECT_EQ(words.take(frame, true), (std::vector<Word>{{"STOP"}, {"KICKOFF", Side::cyan}}));
  EXPECT_TRUE(words.take(frame, false).empty()) << "they were given";
  frame.log = {said(3, "START", "")};
  EXPECT_EQ(words.take(frame, false), (std::vector<Word>{{"START"}}));
  frame.log = {said(2, "GOAL", "magenta")};
  EXPECT_EQ(words.take(frame, true), (std::vector<Word>{{"GOAL", Side::magenta}})) << "the run was rewound";
}

TEST(RefereeWords, AreThoseOfRulesAlone) {
  Frame frame;
  for (const auto kind : {Source::Kind::admin, Source::Kind::robot, Source::Kind::program}) {
    frame.log.push_back(said(1, "GOAL", "cyan"));
    frame.log.back().source.kind = kind;
  }
  frame.log.push_back(said(1, "GOAL", "red"));
  frame.log.push_back(said(1, "GOAL", "cyan"));
  frame.log.back().bytes.pop_back();
  RefereeWords words;
  EXPECT_TRUE(words.take(frame, true).empty());
  EXPECT_EQ(words.wrong(), 2u);
}

TEST(RefboxTeams, AreRead) {
  auto teams = read_refbox_teams("magenta=172.16.39.*, cyan=127.0.0.2@224.16.32.7", "cyan=2009");
  ASSERT_TRUE(teams) << teams.error().text();
  EXPECT_EQ(teams->all[0].pattern, "127.0.0.2");
  EXPECT_EQ(teams->all[0].protocol, refbox::Protocol::bytes_2009);
  EXPECT_EQ(teams->all[1].protocol, refbox::Protocol::json);
  EXPECT_EQ(teams->ids.cyan, "224.16.32.7");
  EXPECT_EQ(teams->ids.magenta, "224.16.32.39") << "as in the league's list of teams";
  teams = read_refbox_teams("cyan=172.16.39.*,magenta=172.16.39.*", "2009");
  EXPECT_EQ(teams->ids.cyan, "224.16.32.39:1") << "a team against itself";
  EXPECT_EQ(teams->all[1].protocol, refbox::Protocol::bytes_2009);
  EXPECT_TRUE(address_matches("172.16.39.5", "172.16.39.*"));
  EXPECT_FALSE(address_matches("172.16.3.5", "172.16.39.*"));
  EXPECT_FALSE(address_matches("::1", "172.16.39.*"));
  for (const char* wrong :
       {"cyan", "red=127.0.0.1,cyan=127.0.0.2", "cyan=1.2.3.4", "cyan=1.2.3,magenta=*", "cyan=*,cyan=*",
        "cyan=1.2.3.400,magenta=*", "cyan=1.*.3.4,magenta=*", "cyan=*@x,magenta=*"}) {
    teams = read_refbox_teams(wrong, "");
    ASSERT_FALSE(teams) << wrong;
    EXPECT_EQ(teams.error().text().rfind("--refbox-teams: ", 0), 0u) << teams.error().text();
  }
  for (const char* wrong : {"xml", "red=json", "cyan=2010"})
    EXPECT_FALSE(read_refbox_teams("", wrong)) << wrong;
}

TEST(Refbox, TellsASetPieceInBothProtocols) {
  ServedBox box("", "cyan=json,magenta=2009");
  Socket cyan = box.station();
  EXPECT_EQ(next(cyan), R"({"command":"WELCOME","targetTeam":"224.16.32.1"})");
  Socket magenta = box.station();
  ASSERT_TRUE(magenta.wait_for_bytes(1));
  EXPECT_EQ(magenta.take(1), "W");
  box.box->say({{"STOP"}, {"THROWIN", Side::magenta}, {"START"}});
  EXPECT_EQ(next(cyan), R"({"command":"STOP","targetTeam":""})");
  EXPECT_EQ(next(cyan), R"({"command":"THROWIN","targetTeam":"224.16.32.2"})");
  EXPECT_EQ(next(cyan), R"({"command":"START","targetTeam":""})");
  ASSERT_TRUE(magenta.wait_for_bytes(3));
  EXPECT_EQ(magenta.take(3), "Sts");
  box.box->say({{"SUBSTITUTION", Side::cyan, 2}, {"DANCE"}});
  EXPECT_EQ(next(cyan), R"({"command":"SUBSTITUTION","targetTeam":"224.16.32.1","robotID":2})");
  ASSERT_TRUE(soon([&] { return box.team(Side::magenta).unsent == 2; })) << "2009 has no byte for them";
  EXPECT_EQ(box.team(Side::cyan).unsent, 1u);
  EXPECT_EQ(box.team(Side::cyan).words, 5u);
}

TEST(Refbox, PassesOnWhatARuleOfTheRunSays) {
  ServedBox box;
  Socket cyan = box.station();
  EXPECT_NE(next(cyan), "");
  Simulation& world = box.session.simulation();
  const auto say = [&](std::uint64_t sequence, const char* command, const char* team, Source::Kind kind) {
    const LogEntry entry = said(sequence, command, team);
    // A rule asks at the end of a tick; a robot without the device loses nothing but its own word.
    world.submit(CommandRequest{"rover1/referee", entry.type, entry.bytes}, {kind, 0});
  };
  say(1, "STOP", "", Source::Kind::rule);
  say(7, "GOAL", "magenta", Source::Kind::admin);
  EXPECT_TRUE(world.tick());
  say(2, "KICKOFF", "cyan", Source::Kind::rule);
  say(2, "KICKOFF", "cyan", Source::Kind::rule);
  EXPECT_TRUE(world.tick());
  say(3, "START", "", Source::Kind::rule);
  EXPECT_TRUE(world.tick());
  EXPECT_EQ(next(cyan), R"({"command":"STOP","targetTeam":""})");
  EXPECT_EQ(next(cyan), R"({"command":"KICKOFF","targetTeam":"224.16.32.1"})");
  EXPECT_EQ(next(cyan), R"({"command":"START","targetTeam":""})");
}

TEST(Refbox, KeepsTheLatestWorldStateAndGoesOnAfterWrongOnes) {
  ServedBox box;
  Socket cyan = box.station();
  EXPECT_NE(next(cyan), "");
  cyan.send("hello\0"s + good_state + "\0"s + R"({"type":"worldstate"})" + "\0"s);
  ASSERT_TRUE(soon([&] { return box.team(Side::cyan).wrong == 2; }));
  RefboxReport report = box.team(Side::cyan);
  EXPECT_EQ(report.world_states, 1u);
  EXPECT_EQ(report.latest.team, "Owls");
  EXPECT_LT(report.latest_age_s, 60);
  EXPECT_EQ(report.error, "a world state without a text 'teamName'");
  std::string nan = good_state;
  nan.replace(nan.find("[1,2,0]"), 7, "[1,NaN,0]");
  cyan.send(nan + "\0"s);
  ASSERT_TRUE(soon([&] { return box.team(Side::cyan).wrong == 3; }));
  EXPECT_EQ(box.team(Side::cyan).error,
            "robots[0].pose[1] is not a finite number; leave out what is not known");
  box.box->say({{"STOP"}});
  EXPECT_EQ(next(cyan), R"({"command":"STOP","targetTeam":""})");
}

TEST(RefboxAttacks, AFloodWithoutNulEndsItsConnectionAlone) {
  ServedBox box;
  Socket cyan = box.station();
  EXPECT_NE(next(cyan), "");
  Socket magenta = box.station();
  EXPECT_NE(next(magenta), "");
  cyan.send(std::string(300'000, 'x'));
  cyan.rest();
  EXPECT_TRUE(cyan.ended);
  EXPECT_EQ(box.team(Side::cyan).error, "more than 100000 bytes without a NUL; end each message with a NUL");
  EXPECT_EQ(box.team(Side::cyan).wrong, 1u) << "once";
  box.box->say({{"STOP"}});
  EXPECT_EQ(next(magenta), R"({"command":"STOP","targetTeam":""})");
  Socket again = box.station();
  EXPECT_NE(next(again), "") << "its place is free";
}

TEST(RefboxAttacks, AFloodOfMessagesIsDroppedBeyondItsRate) {
  ServedBox box;
  Socket cyan = box.station();
  EXPECT_NE(next(cyan), "");
  std::string flood;
  for (int i = 0; i < 1000; ++i) flood += good_state + "\0"s;
  cyan.send(flood);
  ASSERT_TRUE(soon([&] {
    const RefboxReport report = box.team(Side::cyan);
    return report.world_states + report.dropped == 1000;
  }));
  EXPECT_GT(box.team(Side::cyan).dropped, 400u);
  EXPECT_GE(box.team(Side::cyan).world_states, 200u);
}

TEST(RefboxAttacks, HalfAMessageIsCountedAndForgottenWithItsConnection) {
  ServedBox box;
  {
    Socket cyan = box.station();
    EXPECT_NE(next(cyan), "");
    cyan.send(std::string_view(good_state).substr(0, 40));
  }
  ASSERT_TRUE(soon([&] { return box.team(Side::cyan).address.empty(); }));
  EXPECT_EQ(box.team(Side::cyan).wrong, 1u);
  EXPECT_EQ(box.team(Side::cyan).error, "the connection ended within a message, after 40 bytes without NUL");
  Socket again = box.station();
  EXPECT_NE(next(again), "");
  again.send(good_state + "\0"s);
  ASSERT_TRUE(soon([&] { return box.team(Side::cyan).world_states == 1; }));
  EXPECT_EQ(box.team(Side::cyan).wrong, 1u);
  EXPECT_EQ(box.team(Side::cyan).connections, 2u);
}

TEST(RefboxAttacks, TeamsFromOneAddressAreTakenInTurnAndAThirdIsSentAway) {
  ServedBox box;
  Socket cyan = box.station();
  EXPECT_EQ(next(cyan), R"({"command":"WELCOME","targetTeam":"224.16.32.1"})");
  Socket magenta = box.station();
  EXPECT_EQ(next(magenta), R"({"command":"WELCOME","targetTeam":"224.16.32.2"})");
  Socket third = box.station();
  EXPECT_EQ(third.rest(), "");
  EXPECT_TRUE(third.ended);
  EXPECT_EQ(box.box->refused(), 1u);
  box.box->say({{"STOP"}});
  EXPECT_NE(next(cyan), "");
  EXPECT_NE(next(magenta), "");
}

TEST(RefboxAttacks, WhoIsOfNoTeamIsSentAway) {
  ServedBox box("cyan=127.0.0.1,magenta=127.0.0.9");
  Socket cyan = box.station();
  EXPECT_NE(next(cyan), "");
  Socket other = box.station();
  EXPECT_EQ(other.rest(), "") << "cyan is there, and nobody else speaks for it";
  EXPECT_TRUE(other.ended);
  EXPECT_TRUE(box.team(Side::magenta).address.empty());
}

TEST(RefboxAttacks, WhoNeverReadsIsDisconnected) {
  ServedBox box("", "", {.queue_bytes = 4096, .send_buffer_bytes = 4096});
  Socket cyan(box.box->port(), 2048);
  ASSERT_TRUE(box.soon_connected(Side::cyan));
  Socket magenta = box.station();
  EXPECT_NE(next(magenta), "");
  std::uint64_t sent = 0;
  const bool gone = soon(
      [&] {
        for (int i = 0; i < 20; ++i, ++sent) box.box->say({{"STOP"}});
        for (int i = 0; i < 20; ++i) EXPECT_EQ(next(magenta), R"({"command":"STOP","targetTeam":""})");
        return box.team(Side::cyan).address.empty();
      },
      20);
  EXPECT_TRUE(gone) << sent;
}

TEST(RefboxAttacks, NothingThatStationsDoChangesTheRun) {
  const auto hash_of = [](bool attacked) {
    ServedBox box;
    std::vector<std::uint64_t> hashes;
    std::optional<Socket> cyan;
    if (attacked) {
      cyan.emplace(box.box->port());
      EXPECT_NE(next(*cyan), "");
    }
    for (int i = 0; i < 20; ++i) {
      if (attacked) cyan->send(good_state + "\0garbage\0"s);
      EXPECT_TRUE(box.session.simulation().tick());
      hashes.push_back(box.session.simulation().state_hash());
    }
    return hashes;
  };
  EXPECT_EQ(hash_of(true), hash_of(false));
}

}  // namespace
}  // namespace sandlot::server
