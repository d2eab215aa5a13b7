/// Who is connected, as what, how late: /sandlot/clients, and the figures that are left when they have gone.
#include "server/test_bridge.h"
#include "sim/watch/values.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

model::Setup patient_remote(int robots) {
  model::Setup setup = arena("planar", robots, "");
  for (model::Instance& each : setup.instances)
    if (each.is_robot)
      each.controllers.push_back({"brain", "remote", sandlot::test::map({{"deadline", "20 s"}}), {}});
  return setup;
}

/// The first message of /sandlot/clients in which `wanted` finds something.
template <class F>
json clients_with(Viewer& viewer, std::uint32_t subscription, F&& wanted) {
  json found;
  for (int i = 0; i < 60; ++i) {
    const auto message = viewer.next(subscription);
    if (!message) break;
    const json all = message->parsed();
    found = wanted(all);
    if (!found.is_null()) return found;
  }
  ADD_FAILURE() << "it did not come";
  return found;
}

json client_with(const json& message, const char* key, const json& value) {
  for (const json& each : message["clients"])
    if (each[key] == value) return each;
  return {};
}

TEST(Clients, AClientThatMissesThreeStepsShowsThree) {
  // Control steps at 0, 50, 100, 150 and 200 ms. The first is answered, three are not; the last one ends the run, and nobody
  // waits for its answer any more.
  model::Setup setup = patient_remote(1);
  setup.stop = Time::from_s(0.2);
  Running run(std::move(setup));
  Viewer viewer(run.url(), "?name=page");
  const std::uint32_t subscription = viewer.subscribe("/sandlot/clients");
  run.go();
  const json waits = clients_with(viewer, subscription, [](const json& all) {
    return all["programs"].empty() ? json() : all["programs"][0];
  });
  EXPECT_EQ(waits["path"], "rover1/brain");
  EXPECT_EQ(waits["kind"], "remote");
  EXPECT_EQ(waits["is_client"], true);
  Bridge bridge(run.url());
  const json claimed = bridge.claim(
      {{"robot", "rover1"}, {"mode", "lockstep"}, {"deadline_ms", 300}, {"name", "slow.py"}});
  ASSERT_EQ(claimed["op"], "sandlot.claimed") << claimed.dump();
  const json first = bridge.next("sandlot.tick");
  std::this_thread::sleep_for(2ms);
  ASSERT_FALSE(first.is_null());
  bridge.send_text(json{{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", json::object()}}.dump() +
                   json{{"op", "sandlot.done"}, {"step", first["step"]}}.dump());
  run.thread.join();
  EXPECT_TRUE(run.status) << run.status.error().text();
  auto state = NamedValue::find(run.session.simulation(), "rover1/brain.misses");
  ASSERT_TRUE(state);
  EXPECT_EQ(state->read().value_or(-1), 3);

  const json seen = clients_with(viewer, subscription, [](const json& all) {
    const json client = client_with(all, "name", "slow.py");
    return !client.is_null() && client["programs"][0]["misses"] == 3 ? client : json();
  });
  EXPECT_EQ(seen["protocol"], "rosbridge, TCP");
  EXPECT_EQ(seen["address"].get<std::string>().substr(0, 10), "127.0.0.1:");
  EXPECT_EQ(seen["role"], "robot");
  EXPECT_EQ(seen["drives"], "rover1");
  EXPECT_EQ(seen["mode"], "lockstep");
  EXPECT_EQ(seen["commands"], 1);
  EXPECT_GE(seen["messages"], 3);
  EXPECT_GT(seen["bytes_in"], 100);
  EXPECT_GT(seen["bytes_out"], 50);
  const json& program = seen["programs"][0];
  EXPECT_EQ(program["steps"], 5);
  EXPECT_EQ(program["deadline_s"], 0.3);
  // It waited 2 ms, and came before the deadline.
  EXPECT_GE(program["latency_s"]["last"], 0.002);
  EXPECT_LE(program["latency_s"]["last"], 0.3);
  EXPECT_GT(program["waiting_s"], 0) << "it was told of the second step, and has not answered";
  EXPECT_EQ(program["latencies"]["counts"], json::array({1}));
  // The viewer finds itself by its number.
  const json itself = clients_with(viewer, subscription, [&](const json& all) {
    return client_with(all, "id", std::stoi(viewer.info["metadata"]["sandlot_client"].get<std::string>()));
  });
  EXPECT_EQ(itself["protocol"], "page");
  EXPECT_EQ(itself["mode"], "watching");

  run.server->stop();
  const auto totals = run.server->clients();
  ASSERT_EQ(totals.size(), 1u);
  EXPECT_EQ(totals[0].name, "slow.py");
  EXPECT_EQ(totals[0].role, Role::robot);
  EXPECT_EQ(totals[0].mode, Mode::lockstep);
  EXPECT_EQ(totals[0].steps, 5u);
  EXPECT_EQ(totals[0].misses, 3u);
  EXPECT_EQ(totals[0].latency.all().count, 1u);
}

TEST(Clients, FiguresGoOnInAWorldThatWasReset) {
  Running run(patient_remote(1));
  run.go();
  Viewer viewer(run.url());
  Bridge bridge(run.url());
  ASSERT_EQ(bridge.claim({{"robot", "rover1"}, {"mode", "lockstep"}, {"deadline_ms", 20'000}})["op"],
            "sandlot.claimed");
  const auto expect_step = [&](int step) {
    const json tick = bridge.next("sandlot.tick");
    ASSERT_FALSE(tick.is_null());
    EXPECT_EQ(tick["step"], step);
  };
  const auto answer = [&](int step) { bridge.send({{"op", "sandlot.done"}, {"step", step}}); };
  for (const int step : {0, 1}) {
    expect_step(step);
    answer(step);
  }
  expect_step(2);
  EXPECT_EQ(viewer.console("reset")["ok"], true);
  expect_step(0);
  answer(0);
  expect_step(1);
  // Three steps of the first world, one of them without an answer, and two of the second.
  const json program = clients_with(viewer, viewer.subscribe("/sandlot/clients"), [](const json& all) {
    const json client = client_with(all, "drives", "rover1");
    return !client.is_null() && !client["programs"].empty() ? client["programs"][0] : json();
  });
  EXPECT_EQ(program["steps"], 5);
  EXPECT_EQ(program["misses"], 0);
  EXPECT_FALSE(program["waiting_s"].is_null());
  int answers = 0;
  for (const json& each : program["latencies"]["counts"]) answers += each.get<int>();
  EXPECT_EQ(answers, 3);
}

TEST(Clients, OthersSeeThemselvesAloneAndDrivingClientsNobody) {
  ServerOptions options;
  options.transport.tokens = {{"secret of admin", {.role = Role::admin}},
                              {"secret of one", {.role = Role::robot, .name = "rover1"}},
                              {"secret of all", {.role = Role::spectator}}};
  Running run(arena("planar", 2, ""), {.pace = {1.0}}, options);
  run.go();
  Viewer admin(run.url(), "?token=secret%20of%20admin");
  Bridge one(run.url());
  ASSERT_EQ(one.claim({{"robot", "rover1"}, {"token", "secret of one"}})["op"], "sandlot.claimed");
  const json all = clients_with(admin, admin.subscribe("/sandlot/clients"), [](const json& message) {
    return message["clients"].size() == 2 ? message : json();
  });
  EXPECT_FALSE(client_with(all, "drives", "rover1").is_null());

  Viewer spectator(run.url(), "?token=secret%20of%20all");
  const std::uint32_t subscription = spectator.subscribe("/sandlot/clients");
  for (int i = 0; i < 2; ++i) {
    const auto message = spectator.next(subscription);
    ASSERT_TRUE(message);
    const json seen = message->parsed();
    ASSERT_EQ(seen["clients"].size(), 1u) << seen;
    EXPECT_EQ(seen["clients"][0]["role"], "spectator");
    EXPECT_EQ(std::to_string(seen["clients"][0]["id"].get<int>()),
              spectator.info["metadata"]["sandlot_client"].get<std::string>());
    EXPECT_TRUE(seen["programs"].empty());
  }
  EXPECT_EQ(spectator.console("clients")["text"], "only an administrator sees who is connected");
  EXPECT_TRUE(spectator.call("/sandlot/disconnect_client", {{"client", 1}}).is_null());
  // Who drives a robot has no such topic, by either protocol, nor the service.
  one.send({{"op", "subscribe"}, {"topic", "/sandlot/clients"}});
  EXPECT_EQ(one.next("status")["msg"].get<std::string>().substr(0, 17), "there is no topic");
  EXPECT_EQ(one.call("/sandlot/disconnect_client", {{"client", 1}})["result"], false);
  Viewer scoped(run.url(), "?token=secret%20of%20one");
  ASSERT_TRUE(scoped.until([&] { return scoped.channels.count("/clock") > 0; }));
  scoped.listen(0.2);
  EXPECT_EQ(scoped.channels.count("/sandlot/clients"), 0u);
  EXPECT_EQ(scoped.services.count("/sandlot/disconnect_client"), 0u);
}

TEST(Clients, AnAdministratorEndsAConnection) {
  Running run(arena("planar", 1, ""), {.pace = {1.0}});
  run.go();
  Viewer viewer(run.url());
  Bridge bridge(run.url());
  ASSERT_EQ(bridge.claim({{"robot", "rover1"}, {"name", "guest"}})["op"], "sandlot.claimed");
  const json table = viewer.console("clients");
  EXPECT_NE(table["text"].get<std::string>().find("robot rover1"), std::string::npos) << table;
  const json listed = json::parse(viewer.console("clients --json")["text"].get<std::string>());
  const json guest = client_with(listed, "name", "guest");
  ASSERT_FALSE(guest.is_null()) << listed;
  EXPECT_EQ(guest["mode"], "free");
  EXPECT_EQ(viewer.call("/sandlot/disconnect_client", {{"client", 4711}})["text"], "there is no client 4711");
  EXPECT_EQ(viewer.call("/sandlot/disconnect_client", {{"client", guest["id"]}})["ok"], true);
  EXPECT_EQ(bridge.next("status")["msg"], "an administrator has ended the connection");
  EXPECT_TRUE(bridge.ended());
  // The robot is free for others.
  Bridge next(run.url());
  EXPECT_EQ(next.claim({{"robot", "rover1"}})["op"], "sandlot.claimed");
}

TEST(Clients, AWatchdogStopAndCommandsOfAFreeClientAreCounted) {
  ServerOptions options;
  options.watchdog_s = 0.2;
  Running run(arena("planar", 1, ""), {.pace = {1.0}}, options);
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t subscription = viewer.subscribe("/sandlot/clients");
  Bridge bridge(run.url());
  ASSERT_EQ(bridge.claim({{"robot", "rover1"}})["op"], "sandlot.claimed");
  for (int i = 0; i < 3; ++i)
    bridge.send({{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", {{"linear", {{"x", 0.1}}}}}});
  bridge.send({{"op", "publish"}, {"topic", "/rover2/drive"}, {"msg", json::object()}});
  const json client = clients_with(viewer, subscription, [](const json& all) {
    const json found = client_with(all, "drives", "rover1");
    return !found.is_null() && found["stops"] == 1 ? found : json();
  });
  EXPECT_EQ(client["commands"], 3);
  EXPECT_EQ(client["refused"], 1);
  EXPECT_EQ(client["mode"], "free");
  EXPECT_TRUE(client["programs"].empty());
}

}  // namespace
}  // namespace sandlot::server::test
