/// Sessions: clients that drive robots, by token, freely or in lockstep.
#include "base/random.h"
#include "server/test_bridge.h"
#include "sim/test_input.h"
#include "sim/watch/values.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

/// Robots whose programs are clients.
model::Setup remote(int robots, const std::string& engine = "planar", const char* on_miss = "stop") {
  model::Setup setup = arena(engine, robots, "");
  for (model::Instance& each : setup.instances)
    if (each.is_robot)
      each.controllers.push_back(
          {"brain", "remote", sandlot::test::map({{"on_miss", on_miss}, {"deadline", "20 s"}}), {}});
  return setup;
}

/// Drives faster step by step, and turns with what the laser sees ahead; waits a random time before each answer.
struct Driver {
  Driver(const std::string& url, const std::string& robot, double longest_wait_s, unsigned seed = 1)
      : thread([=, this] { drive(url, robot, longest_wait_s, seed); }) {}
  ~Driver() { thread.join(); }

  void drive(const std::string& url, const std::string& robot, double longest_wait_s, unsigned seed) {
    Stream random(seed, entity_key(robot), Purpose::experiment, 0);
    const auto pause = [&] {
      std::this_thread::sleep_for(std::chrono::duration<double>(random.uniform(0, longest_wait_s)));
    };
    pause();
    Bridge bridge(url);
    bridge.send({{"op", "subscribe"}, {"topic", "/" + robot + "/laser/ranges"}});
    const json claimed = bridge.claim({{"robot", robot}, {"mode", "lockstep"}, {"deadline_ms", 20'000}});
    ASSERT_EQ(claimed["op"], "sandlot.claimed") << claimed.dump();
    double ahead = 0;
    for (json message = bridge.take(); !message.is_null(); message = bridge.take()) {
      if (message["op"] == "publish") {
        const json& range = message["msg"]["ranges"][30];
        ahead = range.is_number() ? range.get<double>() : 9;
      }
      if (message["op"] != "sandlot.tick") continue;
      pause();
      ++steps;
      bridge.send({{"op", "publish"},
                   {"topic", "/" + robot + "/drive"},
                   {"msg", {{"linear", {{"x", 0.01 * steps}}}, {"angular", {{"z", 1 / (1 + ahead)}}}}}});
      bridge.send({{"op", "sandlot.done"}, {"step", message["step"]}});
    }
  }
  int steps = 0;
  std::thread thread;
};

std::uint64_t hash_with(int robots, double longest_wait_s, unsigned seed) {
  model::Setup setup = remote(robots);
  setup.stop = Time::from_s(1);
  Running run(std::move(setup));
  std::vector<std::unique_ptr<Driver>> drivers;
  for (int i = 0; i < robots; ++i) {
    const int of = seed % 2 == 0 ? i : robots - 1 - i;
    drivers.push_back(std::make_unique<Driver>(run.url(), "rover" + std::to_string(of + 1), longest_wait_s,
                                               seed + static_cast<unsigned>(i)));
  }
  run.go();
  run.thread.join();
  EXPECT_TRUE(run.status) << run.status.error().text();
  EXPECT_GE(run.session.simulation().now(), Time::from_s(1));
  const std::uint64_t hash = run.session.simulation().state_hash();
  run.server->stop();
  drivers.clear();
  return hash;
}

TEST(Sessions, LockstepGivesOneHashWhateverTheDelaysAndTheOrderOfClients) {
  const std::uint64_t quick = hash_with(3, 0, 1);
  EXPECT_EQ(hash_with(3, 0.02, 2), quick);
  EXPECT_EQ(hash_with(3, 0.02, 3), quick);
}

TEST(Sessions, AClientThatMissesItsDeadlineIsCountedAndItsRobotStops) {
  model::Setup setup = remote(1);
  setup.stop = Time::from_s(0.5);
  Running run(std::move(setup));
  std::thread client([&] {
    Bridge bridge(run.url());
    const json claimed = bridge.claim({{"robot", "rover1"}, {"mode", "lockstep"}, {"deadline_ms", 30}});
    EXPECT_EQ(claimed["programs"][0]["name"], "rover1/brain");
    const json first = bridge.next("sandlot.tick");
    bridge.send({{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", {{"linear", {{"x", 0.3}}}}}});
    bridge.send({{"op", "sandlot.done"}, {"step", first["step"]}});
    // It says nothing more, and the run goes on without it.
    while (!bridge.take().is_null()) {}
  });
  run.go();
  run.thread.join();
  EXPECT_TRUE(run.status) << run.status.error().text();
  const Simulation& simulation = run.session.simulation();
  const auto read = [&](const char* address) {
    auto found = NamedValue::find(simulation, address);
    EXPECT_TRUE(found) << address;
    return found ? found->read().value_or(-1) : -1;
  };
  EXPECT_EQ(read("rover1/brain.answers"), 1);
  EXPECT_GT(read("rover1/brain.misses"), 2);
  EXPECT_LT(std::abs(read("rover1.twist.linear.x")), 0.01);
  run.server->stop();
  client.join();
}

/// Claims a robot in lockstep and answers so many steps, each after a pause.
std::thread answering(std::string url, std::string robot, int deadline_ms, std::chrono::milliseconds pause,
                      int steps = 1000) {
  return std::thread([=] {
    Bridge bridge(url);
    const json claimed = bridge.claim({{"robot", robot}, {"mode", "lockstep"}, {"deadline_ms", deadline_ms}});
    EXPECT_EQ(claimed["op"], "sandlot.claimed") << claimed.dump();
    for (int left = steps; left > 0; --left) {
      const json step = bridge.next("sandlot.tick");
      if (step.is_null()) return;
      std::this_thread::sleep_for(pause);
      bridge.send({{"op", "sandlot.done"}, {"step", step["step"]}});
    }
  });
}

/// Five deadlines of one that is late pass while another one, who has time, is waited for; one goes away and one never comes.
/// Each loses its own steps alone, and the log repeats all of it without any client.
TEST(Sessions, EachClientIsHeldToItsOwnDeadlineWhoeverElseIsWaitedFor) {
  model::Setup setup = remote(4);
  setup.stop = Time::from_s(0.5);
  setup.instances.back().controllers.edit().front().config.set("patience", Node::scalar("0.1 s"));
  Running run(std::move(setup));
  const std::vector<std::byte> start = run.session.simulation().snapshot();
  sandlot::test::InputLog log;
  run.session.add_observer(&log);
  std::vector<std::thread> clients;
  clients.push_back(answering(run.url(), "rover1", 20, 60ms));
  clients.push_back(answering(run.url(), "rover2", 20'000, 100ms));
  clients.push_back(answering(run.url(), "rover3", 20'000, 0ms, 1));
  run.go();
  run.thread.join();
  EXPECT_TRUE(run.status) << run.status.error().text();
  const auto read = [&](const std::string& address) {
    auto found = NamedValue::find(run.session.simulation(), address);
    EXPECT_TRUE(found) << address;
    return found ? found->read().value_or(-1) : -1;
  };
  // The control steps of 0.5 s at 20 Hz but the last one, whose answer would act in the tick after the end.
  constexpr double steps = 10;
  EXPECT_EQ(read("rover2/brain.answers"), steps);
  EXPECT_EQ(read("rover2/brain.misses"), 0);
  // Its late answers act, with steps that it was not sent.
  EXPECT_EQ(read("rover1/brain.misses"), steps);
  EXPECT_GE(read("rover1/brain.answers"), 3);
  EXPECT_EQ(read("rover3/brain.answers"), 1);
  EXPECT_EQ(read("rover3/brain.misses"), steps - 1);
  EXPECT_EQ(read("rover4/brain.answers"), 0);
  EXPECT_EQ(read("rover4/brain.misses"), steps);
  run.session.remove_observer(&log);
  run.server->stop();
  for (std::thread& each : clients) each.join();

  Diagnostics diagnostics;
  const auto again = Simulation::restore(start, {}, diagnostics);
  ASSERT_TRUE(again);
  for (const auto& [tick, hash] : log.hash) {
    if (tick == 0) continue;
    sandlot::test::feed(**again, log.input[tick]);
    ASSERT_TRUE((*again)->tick());
    ASSERT_EQ((*again)->state_hash(), hash) << tick;
  }
}

TEST(Sessions, ATokenOpensItsRobotAlone) {
  ServerOptions options;
  options.transport.tokens = {{"secret of admin", {.role = Role::admin}},
                              {"secret of one", {.role = Role::robot, .name = "rover1"}},
                              {"secret of two", {.role = Role::robot, .name = "rover2"}}};
  Running run(arena("planar", 2, ""), {.pace = {1.0}}, options);
  run.go();
  Bridge one(run.url()), thief(run.url());
  const json claimed = one.claim({{"robot", "rover1"}, {"token", "secret of one"}});
  EXPECT_EQ(claimed["robots"], json::array({"rover1"}));

  EXPECT_EQ(thief.claim({{"robot", "rover1"}})["msg"], "this is not the token of 'rover1'");
  EXPECT_EQ(thief.claim({{"robot", "rover1"}, {"token", "secret of two"}})["msg"],
            "this is not the token of 'rover1'");
  // What belongs to others, or to all, is not there for it.
  const auto refused = [](Bridge& bridge, const json& message) {
    bridge.send(message);
    return bridge.next("status")["msg"].get<std::string>();
  };
  const auto subscribe = [](const char* topic) { return json{{"op", "subscribe"}, {"topic", topic}}; };
  for (const char* topic : {"/rover2/laser/ranges", "/tf", "/tf_static", "/rosout"})
    EXPECT_EQ(refused(one, subscribe(topic)).substr(0, 17), "there is no topic") << topic;
  EXPECT_EQ(refused(one, {{"op", "publish"}, {"topic", "/rover2/drive"}, {"msg", json::object()}}),
            "nothing takes messages on '/rover2/drive'; did you mean '/rover1/drive'?");
  EXPECT_EQ(refused(one, {{"op", "publish"}, {"topic", "/drive"}, {"msg", json::object()}}),
            "nothing takes messages on '/drive'; did you mean '/rover1/drive'?");
  for (const char* service : {"/set_simulation_state", "/sandlot/console", "/sandlot/watch",
                              "/get_entity_state", "/delete_entity", "/step_simulation"})
    EXPECT_EQ(one.call(service, json::object())["result"], false) << service;
  const json services = one.call("/rosapi/services", json::object())["values"]["services"];
  for (const json& each : services) EXPECT_EQ(each.get<std::string>().rfind("/rover1/", 0), 0u) << each;
  // A guest by default: it changes nothing.
  EXPECT_EQ(refused(thief, {{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", json::object()}}),
            "nothing takes messages on '/rover1/drive'; a client commands what it has claimed");

  // The same token takes over; the one before is told, and gone.
  Bridge again(run.url());
  EXPECT_EQ(again.claim({{"robot", "rover1"}, {"token", "secret of one"}})["op"], "sandlot.claimed");
  EXPECT_TRUE(one.ended());
  // Not so another right to it.
  Bridge admin(run.url());
  EXPECT_EQ(admin.claim({{"robot", "rover1"}, {"token", "secret of admin"}})["msg"],
            "'rover1' is driven by another client; take it over with the token of that one");
  // Guessing ends the connection.
  for (int i = 0; i < 10; ++i) thief.send({{"op", "sandlot.claim"}, {"robot", "rover2"}, {"token", "guess"}});
  EXPECT_TRUE(thief.ended());
}

TEST(Sessions, ARobotWhoseClientFallsSilentOrGoesIsStopped) {
  ServerOptions options;
  options.watchdog_s = 0.2;
  Running run(arena("planar", 2, ""), {.pace = {1.0}}, options);
  run.go();
  const auto drive = [&](Bridge& bridge, const char* robot) {
    EXPECT_EQ(bridge.claim({{"robot", robot}})["op"], "sandlot.claimed");
    bridge.send({{"op", "publish"},
                 {"topic", "/" + std::string(robot) + "/drive"},
                 {"msg", {{"linear", {{"x", 0.2}}}}}});
  };
  Bridge silent(run.url());
  drive(silent, "rover1");
  EXPECT_EQ(silent.next("status", 0.05), json());
  silent.send({{"op", "set_level"}, {"level", "warning"}});
  EXPECT_EQ(silent.next("status")["msg"], "no command for long: 'rover1' was stopped");
  {
    Bridge leaving(run.url());
    drive(leaving, "rover2");
    std::this_thread::sleep_for(50ms);
  }
  // Both stand: seen by an administrator's own eyes.
  Bridge admin(run.url());
  const auto speed = [&](const char* robot) {
    const json answer = admin.call("/get_entity_state", {{"entity", robot}});
    const json& v = answer["values"]["state"]["twist"]["linear"];
    const auto x = v["x"].get<double>(), y = v["y"].get<double>();
    return std::sqrt(x * x + y * y);
  };
  const auto stands = [&](const char* robot) {
    for (int i = 0; i < 100; ++i) {
      if (speed(robot) < 0.01) return true;
      std::this_thread::sleep_for(20ms);
    }
    return false;
  };
  EXPECT_TRUE(stands("rover1"));
  EXPECT_TRUE(stands("rover2"));
}

}  // namespace
}  // namespace sandlot::server::test
