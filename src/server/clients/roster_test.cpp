/// Figures of clients, with times made up by the test.
#include "server/clients/roster.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace sandlot::server {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using Moment = Roster::Moment;

const Access robot{.role = Role::robot, .name = "red1", .robots = {"red1"}};

json parsed(const Roster& roster, Moment now) { return json::parse(clients_json(roster.rows(now), {})); }

TEST(DurationMeter, RecentFiguresAreThoseOfTheLatestThousand) {
  DurationMeter meter;
  EXPECT_EQ(meter.recent().count, 0u);
  for (int i = 0; i < 500; ++i) meter.add(1.0);  // pushed out by what follows
  for (int i = 1; i <= 1000; ++i) meter.add(0.001 * i);
  const DurationMeter::Figures recent = meter.recent();
  EXPECT_EQ(recent.count, 1000u);
  EXPECT_NEAR(recent.mean_s, 0.5005, 1e-6);
  // Nearest rank: the 990th of 1000. Kept as float, whose last digit is 6e-8 of the number.
  EXPECT_NEAR(recent.p99_s, 0.990, 1e-6);
  EXPECT_NEAR(recent.max_s, 1.0, 1e-6);
  EXPECT_DOUBLE_EQ(recent.last_s, 1.0);
}

TEST(DurationMeter, TheHistogramKnowsAllOfThemToABin) {
  DurationMeter meter;
  for (int i = 0; i < 98; ++i) meter.add(0.0015);
  meter.add(0.2);
  meter.add(0.2);
  const DurationMeter::Figures all = meter.all();
  EXPECT_EQ(all.count, 100u);
  EXPECT_NEAR(all.mean_s, (98 * 0.0015 + 2 * 0.2) / 100, 1e-12);
  EXPECT_DOUBLE_EQ(all.max_s, 0.2);
  // The 99th of 100 is 0.2; its bin ends at 10^(-0.65) = 0.2239, beyond the longest.
  EXPECT_DOUBLE_EQ(all.p99_s, 0.2);
  // One less among the long ones, and the 99th is 1.5 ms, in the bin from 10^(-2.85) to 10^(-2.8) s.
  DurationMeter shorter;
  for (int i = 0; i < 99; ++i) shorter.add(0.0015);
  shorter.add(0.2);
  EXPECT_NEAR(shorter.all().p99_s, 1.584893e-3, 1e-8);
  // 1 ms begins a decade: two above the first bin, 10 us.
  EXPECT_DOUBLE_EQ(DurationMeter::lower_edge_s(40), 1e-3);
  DurationMeter edges;
  for (const double each : {0.0, 1e-6, 1e-3, 99.0, 5000.0}) edges.add(each);
  EXPECT_EQ(edges.histogram()[0], 2u);
  EXPECT_EQ(edges.histogram()[40], 1u);
  EXPECT_EQ(edges.histogram()[139], 2u);
  // Together they are as one.
  meter.add(shorter);
  EXPECT_EQ(meter.all().count, 200u);
  EXPECT_NEAR(meter.all().mean_s, (197 * 0.0015 + 3 * 0.2) / 200, 1e-12);
}

TEST(RateMeter, IsOfTheLatestSeconds) {
  RateMeter meter;
  const Moment begin(1000s);
  for (int i = 0; i < 200; ++i) meter.add(begin + i * 20ms);  // 50 per second, for four
  EXPECT_NEAR(meter.per_s(begin + 4s), 50, 1);
  EXPECT_NEAR(meter.per_s(begin + 6s), 50.0 / 3, 1);  // one second of the four is left
  EXPECT_EQ(meter.per_s(begin + 20s), 0);
  EXPECT_EQ(RateMeter().per_s(begin), 0);
}

TEST(Roster, LatencyIsFromTheTickToItsAnswer) {
  Roster roster;
  const Moment begin(500s);
  roster.connected(7, Protocol::rosbridge, {.address = "10.0.0.9:4000", .name = "by its URL"}, {}, begin);
  roster.claimed(7, robot, Mode::lockstep, 0.05, "wander\n.py");
  const auto counts = roster.answers_for(7, "red1/brain", 0.1, 20);
  ASSERT_TRUE(counts);
  // Steps 100 ms apart, answered after 1, 2, ... 10 ms; the eleventh waits.
  for (int i = 1; i <= 11; ++i) {
    roster.told(7, "red1/brain", begin + i * 100ms);
    ++counts->steps;
    if (i <= 10) roster.answered(7, "red1/brain", begin + i * 100ms + i * 1ms);
  }
  counts->misses = 3;
  const json all = parsed(roster, begin + 1100ms + 30ms);
  const json& client = all["clients"][0];
  EXPECT_EQ(client["id"], 7);
  EXPECT_EQ(client["name"], "wander .py");
  EXPECT_EQ(client["protocol"], "rosbridge");
  EXPECT_EQ(client["address"], "10.0.0.9:4000");
  EXPECT_EQ(client["role"], "robot");
  EXPECT_EQ(client["drives"], "red1");
  EXPECT_EQ(client["mode"], "lockstep");
  EXPECT_NEAR(client["connected_s"].get<double>(), 1.13, 1e-9);
  const json& program = client["programs"][0];
  EXPECT_EQ(program["path"], "red1/brain");
  EXPECT_EQ(program["steps"], 11);
  EXPECT_EQ(program["misses"], 3);
  EXPECT_EQ(program["deadline_s"], 0.05);
  EXPECT_NEAR(program["waiting_s"].get<double>(), 0.03, 1e-9);
  EXPECT_NEAR(program["latency_s"]["last"].get<double>(), 0.010, 1e-6);
  EXPECT_NEAR(program["latency_s"]["mean"].get<double>(), 0.0055, 1e-6);
  EXPECT_NEAR(program["latency_s"]["p99"].get<double>(), 0.010, 1e-6);
  EXPECT_NEAR(program["step_s"]["mean"].get<double>(), 0.1, 1e-6);
  // 1 ms to 10 ms: a decade and its end, 21 bins, the first at 1 ms.
  EXPECT_DOUBLE_EQ(program["latencies"]["first_s"].get<double>(), 1e-3);
  EXPECT_EQ(program["latencies"]["counts"].size(), 21u);
  EXPECT_EQ(program["latencies"]["counts"][0], 1);
  // An answer to nothing counts nothing.
  roster.answered(7, "red1/brain", begin + 2s);
  roster.answered(7, "red1/brain", begin + 3s);
  EXPECT_NEAR(parsed(roster, begin + 3s)["clients"][0]["programs"][0]["latency_s"]["last"].get<double>(), 0.9,
              1e-6);
}

TEST(Roster, ADeadlineIsTheShorterOfTheClientsAndTheProgramsOwn) {
  Roster roster;
  roster.connected(1, Protocol::rosbridge_tcp, {}, {}, Moment());
  roster.claimed(1, robot, Mode::lockstep, 2, "");
  roster.answers_for(1, "red1/brain", 0.1, 0.5);
  EXPECT_EQ(parsed(roster, Moment())["clients"][0]["programs"][0]["deadline_s"], 0.5);
}

TEST(Roster, WhoHasGoneStaysInTheTotals) {
  Roster roster;
  const Moment begin(500s);
  const auto session = [&](ClientId id, const std::string& name, int steps) {
    roster.connected(id, Protocol::rosbridge, {}, {}, begin);
    roster.claimed(id, robot, Mode::lockstep, 1, name);
    const auto counts = roster.answers_for(id, "red1/brain", 0.1, 1);
    for (int i = 0; i < steps; ++i) {
      roster.told(id, "red1/brain", begin + i * 1s);
      roster.answered(id, "red1/brain", begin + i * 1s + 4ms);
    }
    counts->steps = static_cast<std::uint64_t>(steps);
    counts->misses = 1;
  };
  session(1, "a.py", 10);
  roster.disconnected(1);
  session(2, "a.py", 5);
  roster.released(2, {});
  session(3, "b.py", 2);                               // is still there
  roster.connected(4, Protocol::page, {}, {}, begin);  // drives nothing
  roster.connected(5, Protocol::rosbridge, {}, {.role = Role::admin}, begin);
  roster.commanded(5, begin);  // without a claim
  const auto totals = roster.totals();
  ASSERT_EQ(totals.size(), 3u);
  EXPECT_EQ(totals[0].name, "a.py");
  EXPECT_EQ(totals[0].drives, "red1");
  EXPECT_EQ(totals[0].connections, 2u);
  EXPECT_EQ(totals[0].steps, 15u);
  EXPECT_EQ(totals[0].misses, 2u);
  EXPECT_EQ(totals[0].latency.all().count, 15u);
  EXPECT_NEAR(totals[0].latency.all().mean_s, 0.004, 1e-9);
  EXPECT_EQ(totals[0].step.all().count, 13u);
  EXPECT_EQ(totals[1].name, "b.py");
  EXPECT_EQ(totals[2].role, Role::admin);
  EXPECT_EQ(totals[2].mode, Mode::free);
  EXPECT_EQ(totals[2].commands, 1u);
  EXPECT_EQ(roster.totals().size(), 3u) << "to ask changes nothing";
}

TEST(Roster, NamesWithoutEndFillNoMemory) {
  Roster roster;
  for (int i = 0; i < 1000; ++i) {
    roster.connected(1, Protocol::rosbridge, {}, {.role = Role::admin}, Moment());
    roster.claimed(1, robot, Mode::free, 1, std::string(1000, 'x') + std::to_string(i));
    roster.commanded(1, Moment());
    roster.disconnected(1);
    roster.connected(1, Protocol::rosbridge, {}, {.role = Role::admin}, Moment());
    roster.claimed(1, robot, Mode::free, 1, "client " + std::to_string(i));
    roster.commanded(1, Moment());
    roster.disconnected(1);
  }
  const auto totals = roster.totals();
  EXPECT_EQ(totals.size(), Roster::most_totals + 1);
  EXPECT_EQ(totals[0].name, std::string(Roster::longest_name, 'x'));
  EXPECT_EQ(totals[0].connections, 1000u);
  EXPECT_EQ(totals.back().name, "others");
  EXPECT_EQ(totals.back().connections, 1000u - (Roster::most_totals - 1));
}

TEST(Roster, ATableForPeople) {
  Roster roster;
  const Moment begin(500s);
  roster.connected(3, Protocol::rosbridge_tcp, {.address = "127.0.0.1:5000"}, {}, begin);
  roster.claimed(3, robot, Mode::lockstep, 1, "wander.py");
  const auto counts = roster.answers_for(3, "red1/brain", 0.1, 1);
  roster.told(3, "red1/brain", begin);
  roster.answered(3, "red1/brain", begin + 2500us);
  counts->steps = 4;
  counts->misses = 3;
  EXPECT_EQ(clients_text(roster.rows(begin + 1s)),
            "id  name       protocol        address         role        mode      msg/s  latency ms      "
            " missed\n"
            "3   wander.py  rosbridge, TCP  127.0.0.1:5000  robot red1  lockstep  0.0    2.5 (99 %: 2.5) "
            " 3 of 4");
}

}  // namespace
}  // namespace sandlot::server
