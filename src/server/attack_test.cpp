/// Attacks of a team's program, and of who has no token, on other teams, the run and the server: each is refused and counted, and nobody
/// else is harmed. Nonsense, floods and slow readers: http/hostile_test.cpp, flood_test.cpp.
#include <atomic>

#include "server/services/service.h"
#include "server/test_bridge.h"
#include "sim/watch/values.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

ServerOptions with_tokens() {
  ServerOptions options;
  options.transport.tokens = {{"secret of admin", {.role = Role::admin}},
                              {"secret of red", {.role = Role::team, .name = "red"}},
                              {"secret of blue", {.role = Role::team, .name = "blue"}},
                              {"secret of spectators", {.role = Role::spectator}}};
  return options;
}

/// Team red with rover1, team blue with rover2.
model::Setup match() {
  model::Setup setup = arena("planar", 2, "");
  model::DeviceDecl odometry;
  odometry.name = "odometry";
  odometry.kind = "wheel_odometry";
  odometry.config = sandlot::test::map({{"left_joint", "left_wheel_joint"},
                                        {"right_joint", "right_wheel_joint"},
                                        {"wheel_radius", "0.07"},
                                        {"wheel_separation", "0.3"}});
  for (model::Instance& each : setup.instances) {
    if (!each.is_robot) continue;
    each.team = each.name == "rover1" ? "red" : "blue";
    each.devices.push_back(odometry);
  }
  setup.teams = {{.name = "red"}, {.name = "blue"}};
  return setup;
}

struct Match : Running {
  explicit Match(ServerOptions options = with_tokens(), Session::Options session_options = {.pace = {1.0}})
      : Running(match(), std::move(session_options), std::move(options)) {
    go();
  }
  std::uint64_t refused() const { return server->counters().refused; }
  Bridge red() {
    Bridge out(url());
    EXPECT_EQ(out.claim({{"team", "red"}, {"token", "secret of red"}})["op"], "sandlot.claimed");
    return out;
  }
};

std::string refusal(Bridge& bridge, const json& message) {
  bridge.send(message);
  return bridge.next("status").value("msg", "");
}

json subscribe(const std::string& topic) { return {{"op", "subscribe"}, {"topic", topic}}; }

/// Binary call of a service by its number, whether it was offered or not.
void call_number(Viewer& viewer, std::uint32_t number, std::uint32_t call) {
  std::vector<std::byte> bytes{std::byte{2}};
  const auto put = [&](const void* from, std::size_t size) {
    const auto* const begin = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), begin, begin + size);
  };
  const std::uint32_t length = 4;
  put(&number, 4);
  put(&call, 4);
  put(&length, 4);
  put("json{}", 6);
  viewer.send_bytes(bytes);
}

TEST(Attacks, NoServiceIsOpenToATeamByAnyFace) {
  Match run;
  Viewer admin(run.url(), "?token=secret%20of%20admin");
  ASSERT_TRUE(admin.until([&] { return admin.services.size() >= services().size(); }));
  std::vector<std::string> names;
  for (const Service& row : services()) names.emplace_back(row.name);
  for (const auto& [name, number] : admin.services)
    if (name.rfind("/rover2/", 0) == 0) names.push_back(name);
  EXPECT_GT(names.size(), services().size()) << "devices of blue have services";

  Bridge red = run.red();
  const std::uint64_t before = run.refused();
  for (const std::string& name : names) {
    const json answer = red.call(name, json::object());
    EXPECT_EQ(answer["result"], false) << name;
    const auto why = answer["values"].get<std::string>();
    EXPECT_EQ(why.rfind("there is no service '" + name + "'", 0), 0u) << why;
  }
  EXPECT_GE(run.refused(), before + names.size());
  EXPECT_EQ(red.call("/rover1/odometry/reset", json::object())["result"], true) << "its own are";

  Viewer red_viewer(run.url(), "?token=secret%20of%20red");
  std::uint32_t call = 1000;
  for (const auto& [name, number] : admin.services) {
    call_number(red_viewer, number, ++call);
    ASSERT_TRUE(red_viewer.until([&] { return red_viewer.answers[call] > 0; })) << name;
    EXPECT_EQ(red_viewer.failures[call], "there is no service " + std::to_string(number)) << name;
  }
  EXPECT_TRUE(red_viewer.services.empty());
  EXPECT_EQ(run.session.report().state, Session::State::playing) << "it was not paused";
  EXPECT_EQ(run.session.report().epoch, 1u) << "it was not reset";
  EXPECT_TRUE(admin.console("list entities")["ok"]);
}

bool is_everybodys(std::string_view topic) {
  return topic == "/clock" || topic == "/sandlot/step_times" || topic == "/sandlot/status";
}

TEST(Attacks, NoTopicOfOthersOrOfTheWorldIsThereForATeam) {
  Match run;
  Viewer admin(run.url(), "?token=secret%20of%20admin");
  ASSERT_NE(admin.channel("/rover2/laser/ranges"), 0u);
  Bridge red = run.red();
  Viewer red_viewer(run.url(), "?token=secret%20of%20red");
  red_viewer.listen(0.1);
  for (const auto& [topic, channel] : red_viewer.channels) EXPECT_TRUE(is_everybodys(topic)) << topic;
  std::size_t hidden = 0;
  for (const auto& [topic, channel] : admin.channels) {
    if (topic.rfind("/rover1/", 0) == 0 || is_everybodys(topic)) continue;
    ++hidden;
    EXPECT_EQ(refusal(red, subscribe(topic)).rfind("there is no topic", 0), 0u) << topic;
    const std::size_t told = red_viewer.statuses.size();
    red_viewer.send(
        {{"op", "subscribe"}, {"subscriptions", {{{"id", hidden}, {"channelId", channel["id"]}}}}});
    ASSERT_TRUE(red_viewer.until([&] { return red_viewer.statuses.size() > told; })) << topic;
  }
  EXPECT_GT(hidden, 12u);
  red_viewer.listen(0.2);
  EXPECT_TRUE(red_viewer.data.empty());
  // Parameters, the graph and assets. Twenty refusals a second are told.
  red_viewer.listen(1.1);
  const auto refused = [&](const json& message) {
    const std::size_t told = red_viewer.statuses.size();
    red_viewer.send(message);
    return red_viewer.until([&] { return red_viewer.statuses.size() > told; });
  };
  EXPECT_TRUE(refused({{"op", "getParameters"}, {"parameterNames", json::array()}, {"id", "1"}}));
  EXPECT_TRUE(refused({{"op", "getParameters"}, {"parameterNames", {"sandlot.speed"}}, {"id", "2"}}));
  EXPECT_TRUE(refused({{"op", "setParameters"},
                       {"parameters", {{{"name", "sandlot.paused"}, {"value", true}}}},
                       {"id", "3"}}));
  EXPECT_TRUE(refused({{"op", "setParameters"},
                       {"parameters", {{{"name", "rover2/laser.rate"}, {"value", 0.1}}}},
                       {"id", "4"}}));
  EXPECT_TRUE(refused({{"op", "subscribeParameterUpdates"}, {"parameterNames", json::array()}}));
  EXPECT_TRUE(refused({{"op", "subscribeConnectionGraph"}}));
  EXPECT_TRUE(red_viewer.parameters.empty());
  EXPECT_TRUE(red_viewer.graphs.empty());
  red_viewer.send({{"op", "fetchAsset"}, {"uri", "sandlot://mesh/a0"}, {"requestId", 9}});
  ASSERT_TRUE(red_viewer.until([&] { return red_viewer.assets.count(9) > 0; }));
  const std::vector<std::byte>& asset = red_viewer.assets[9];
  EXPECT_NE(std::string(reinterpret_cast<const char*>(asset.data()), asset.size()).find("administrators"),
            std::string::npos);
  EXPECT_EQ(run.session.report().state, Session::State::playing);
}

TEST(Attacks, NoAnswerTellsOfOthers) {
  Match run;
  Bridge red = run.red();
  for (const char* service :
       {"topics", "topics_and_raw_types", "services", "nodes", "node_details", "publishers", "subscribers",
        "service_node", "action_servers", "get_time", "get_ros_version"}) {
    const std::string answer = red.call("/rosapi/" + std::string(service), json::object()).dump();
    EXPECT_EQ(answer.find("rover2"), std::string::npos) << service;
    EXPECT_EQ(answer.find("blue"), std::string::npos) << service;
  }
  const json types = red.call("/rosapi/topics_for_type", {{"type", "sensor_msgs/LaserScan"}});
  EXPECT_EQ(types["values"]["topics"], json::array({"/rover1/laser/ranges"}));
  EXPECT_EQ(red.call("/rosapi/topic_type", {{"topic", "/rover2/laser/ranges"}})["values"]["type"], "");
  // One letter off a name of blue's: the nearest one that is told is red's own, or none.
  const auto tells = [](const std::string& text, const char* name) {
    return text.find(name) != std::string::npos;
  };
  const std::string published = refusal(
      red, {{"op", "publish"}, {"topic", "/rover2/driv"}, {"msg", json::object()}});
  EXPECT_FALSE(tells(published, "rover2/drive")) << published;
  EXPECT_TRUE(tells(published, "rover1/drive")) << published;
  const std::string there = refusal(red,
                                    {{"op", "publish"}, {"topic", "/rover2/drive"}, {"msg", json::object()}});
  const std::string not_there = refusal(
      red, {{"op", "publish"}, {"topic", "/rover3/drive"}, {"msg", json::object()}});
  EXPECT_EQ(there.substr(there.find(';')), not_there.substr(not_there.find(';'))) << "both say the same";
  EXPECT_FALSE(tells(refusal(red, subscribe("/rover2/laser/range")), "rover2/laser/ranges"));
  EXPECT_FALSE(tells(red.call("/rover2/odometry/rese", json::object()).dump(), "rover2/odometry/reset"));
  Bridge other(run.url());
  const json claimed = other.claim({{"team", "blu"}, {"token", "secret of red"}});
  EXPECT_EQ(claimed["msg"], "this is not the token of 'blu'");
}

TEST(Attacks, WhoHasNoTokenOfATeamsRunSeesTheTimeAlone) {
  Match run;
  Bridge guest(run.url());
  for (const char* topic : {"/tf", "/tf_static", "/rosout", "/rover1/laser/ranges"})
    EXPECT_EQ(refusal(guest, subscribe(topic)).rfind("there is no topic", 0), 0u) << topic;
  EXPECT_EQ(guest.call("/rosapi/topics", json::object())["values"]["topics"],
            json::array({"/clock", "/sandlot/step_times"}));
  EXPECT_EQ(guest.call("/get_entity_state", {{"entity", "rover2"}})["result"], false);
  EXPECT_NE(refusal(guest, {{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", json::object()}})
                .find("what it has claimed"),
            std::string::npos);
  const auto connects = [&](const char* query) {
    return static_cast<bool>(
        WebSocketClient::connect("ws" + run.url().substr(4) + query, "foxglove.sdk.v1", patience_s));
  };
  EXPECT_FALSE(connects(""));
  EXPECT_FALSE(connects("?role=spectator"));
  EXPECT_FALSE(connects("?role=spectator&token=secret%20of%20red")) << "a team does not look on";
  EXPECT_TRUE(connects("?token=secret%20of%20spectators"));
  EXPECT_TRUE(connects("?role=spectator&token=secret%20of%20admin"));
  // By HTTP there are files of the page and meshes, and nothing else.
  const auto port = static_cast<std::uint16_t>(std::stoi(run.url().substr(run.url().rfind(':') + 1)));
  for (const char* target :
       {"/recording", "/run.mcap", "/summary.json", "/tokens", "/etc/passwd", "/assets/../tokens",
        "/assets/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/assets//etc/passwd"}) {
    Socket socket(port);
    const std::string answer = socket.ask("GET " + std::string(target) +
                                          " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const std::string status = answer.substr(9, 3);
    EXPECT_TRUE(status == "404" || status == "400") << target << ": " << answer.substr(0, 40);
  }
}

TEST(Attacks, ARowForEverybodyLetsEverybodyLookOn) {
  ServerOptions options = with_tokens();
  options.transport.tokens.push_back({"", {.role = Role::spectator}});
  Match run(options);
  Viewer viewer(run.url());
  EXPECT_NE(viewer.channel("/rover2/laser/ranges"), 0u);
  EXPECT_EQ(viewer.info["metadata"]["sandlot_role"], "spectator");
}

TEST(Attacks, WhatWasAllowedByAClaimEndsWithIt) {
  Match run;
  Bridge red = run.red();
  const json command = {{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", {{"linear", {{"x", 0.2}}}}}};
  red.send(subscribe("/rover1/laser/ranges"));
  red.send(command);
  ASSERT_EQ(red.next("publish")["topic"], "/rover1/laser/ranges");
  red.send({{"op", "sandlot.release"}});
  EXPECT_NE(refusal(red, command).find("nothing takes messages"), std::string::npos);
  EXPECT_EQ(red.call("/rosapi/topics", json::object())["values"]["topics"],
            json::array({"/clock", "/sandlot/step_times"}));
  EXPECT_EQ(red.next("publish", 0.3), json()) << "its subscriptions have ended, too";
  // Claimed again in another way, a client keeps what it has subscribed to.
  EXPECT_EQ(red.claim({{"team", "red"}, {"token", "secret of red"}})["op"], "sandlot.claimed");
  red.send(subscribe("/rover1/laser/ranges"));
  EXPECT_EQ(red.claim({{"team", "red"}, {"token", "secret of red"}})["op"], "sandlot.claimed");
  EXPECT_EQ(red.next("publish")["topic"], "/rover1/laser/ranges");
}

TEST(Attacks, GuessingIsCountedByAddressAndReconnectingDoesNotHelp) {
  ServerOptions options = with_tokens();
  options.transport.wrong_tokens_at_once = 6;
  options.transport.wrong_token_pause_s = 1e6;
  Match run(options);
  Bridge blue(run.url());
  EXPECT_EQ(blue.claim({{"team", "blue"}, {"token", "secret of blue"}})["op"], "sandlot.claimed");
  for (int i = 0; i < 3; ++i) {
    Bridge guesser(run.url());
    for (int k = 0; k < 2; ++k)
      EXPECT_EQ(guesser.claim({{"team", "red"}, {"token", "guess"}})["msg"],
                "this is not the token of 'red'");
  }
  Bridge late(run.url());
  EXPECT_EQ(late.claim({{"team", "red"}, {"token", "secret of red"}})["msg"],
            "too many wrong tokens came from your address; wait some seconds")
      << "the right one tells nothing any more";
  const auto port = static_cast<std::uint16_t>(std::stoi(run.url().substr(run.url().rfind(':') + 1)));
  Socket socket(port);
  const std::string answer = socket.ask(handshake("/?token=secret%20of%20red", ""));
  EXPECT_EQ(answer.substr(9, 3), "429") << answer.substr(0, 40);
  // Who is in stays in.
  blue.send({{"op", "publish"}, {"topic", "/rover2/drive"}, {"msg", {{"linear", {{"x", 0.1}}}}}});
  EXPECT_EQ(blue.call("/rosapi/get_time", json::object())["result"], true);
  EXPECT_GE(run.refused(), 8u);
}

TEST(Attacks, HundredsOfGuessesInOneSegmentAreStillOnlyFive) {
  Match run;
  Bridge guesser(run.url());
  std::string many;
  for (int i = 0; i < 100; ++i)
    many += json({{"op", "sandlot.claim"},
                  {"team", "red"},
                  {"id", "claim"},
                  {"token", i == 50 ? "secret of red" : "guess"}})
                .dump();
  guesser.send_text(many);
  int looked_at = 0;
  for (json message = guesser.take(); !message.is_null(); message = guesser.take()) {
    EXPECT_NE(message["op"], "sandlot.claimed");
    looked_at += message.value("msg", "") == "this is not the token of 'red'" ? 1 : 0;
  }
  EXPECT_EQ(looked_at, 5);
}

TEST(Attacks, OfClaimsAtTheSameMomentOneHolds) {
  Match run;
  for (int i = 0; i < 20; ++i) {
    Bridge one(run.url()), two(run.url());
    // The same token: whoever is second takes over, and the first is closed.
    const json claim = {
        {"op", "sandlot.claim"}, {"id", "claim"}, {"team", "red"}, {"token", "secret of red"}};
    std::thread other([&] { two.send(claim); });
    one.send(claim);
    other.join();
    const auto answered = [](Bridge& bridge) {
      const json answer = bridge.next("sandlot.claimed");
      return !answer.is_null();
    };
    EXPECT_TRUE(answered(one));
    EXPECT_TRUE(answered(two));
    const auto holds = [](Bridge& bridge) {
      bridge.send({{"op", "call_service"}, {"service", "/rosapi/topics"}, {"id", "t"}});
      return !bridge.next("service_response").is_null();
    };
    EXPECT_NE(holds(one), holds(two)) << i;
  }
  for (int i = 0; i < 20; ++i) {
    Bridge one(run.url()), two(run.url());
    // Different ones: who is second is refused, whatever it has.
    std::thread other([&] {
      two.send({{"op", "sandlot.claim"}, {"id", "claim"}, {"team", "red"}, {"token", "secret of admin"}});
    });
    one.send({{"op", "sandlot.claim"}, {"id", "claim"}, {"team", "red"}, {"token", "secret of red"}});
    other.join();
    const auto claimed = [](Bridge& bridge) {
      while (true) {
        const json message = bridge.take();
        if (message.is_null() || message.value("id", "") == "claim")
          return message.value("op", "") == "sandlot.claimed";
      }
    };
    const bool first = claimed(one), second = claimed(two);
    EXPECT_NE(first, second) << i;
  }
}

/// Robots whose programs are clients.
model::Setup remote_until(double stop_s) {
  model::Setup setup = arena("planar", 1, "");
  for (model::Instance& each : setup.instances)
    if (each.is_robot)
      each.controllers.push_back({"brain", "remote", sandlot::test::map({{"deadline", "20 s"}}), {}});
  setup.stop = Time::from_s(stop_s);
  return setup;
}

double value_of(const Simulation& simulation, const char* address) {
  auto found = NamedValue::find(simulation, address);
  EXPECT_TRUE(found) << address;
  return found ? found->read().value_or(-1) : -1;
}

TEST(Attacks, AnswersTwiceForThePastAndForTheFutureAreRefused) {
  Running run(remote_until(1));
  std::size_t refusals = 0;
  int steps = 0;
  std::thread client([&] {
    Bridge bridge(run.url());
    EXPECT_EQ(bridge.claim({{"robot", "rover1"}, {"mode", "lockstep"}, {"deadline_ms", 20'000}})["op"],
              "sandlot.claimed");
    for (json message = bridge.take(); !message.is_null(); message = bridge.take()) {
      if (message["op"] == "status") ++refusals;
      if (message["op"] != "sandlot.tick") continue;
      const auto step = message["step"].get<std::uint64_t>();
      ++steps;
      const auto done = [&](const json& number) { bridge.send({{"op", "sandlot.done"}, {"step", number}}); };
      done(step + 1);
      done(step + 1000);
      if (step > 0) done(step - 1);
      done(1e15);
      done(-1);
      done(step);
      done(step);
    }
  });
  run.go();
  run.thread.join();
  EXPECT_TRUE(run.status) << run.status.error().text();
  const double answers = value_of(run.session.simulation(), "rover1/brain.answers");
  const double misses = value_of(run.session.simulation(), "rover1/brain.misses");
  run.server->stop();
  client.join();
  EXPECT_GE(answers, 20);
  EXPECT_EQ(misses, 0);
  EXPECT_LE(std::abs(steps - answers), 1);
  EXPECT_GT(refusals, 15u) << "twenty a second are told";
  EXPECT_GE(run.server->counters().refused, static_cast<std::uint64_t>(5 * (steps - 1)));
}

/// Each claim would begin the deadline anew, for ever.
TEST(Attacks, WhoClaimsAgainAndAgainDoesNotHoldUpTheRun) {
  Running run(remote_until(1e6));
  std::atomic<bool> end = false;
  run.go();
  std::thread client([&] {
    Bridge bridge(run.url());
    while (!end) {
      bridge.send({{"op", "sandlot.claim"}, {"robot", "rover1"}, {"mode", "lockstep"}, {"deadline_ms", 150}});
      std::this_thread::sleep_for(60ms);
    }
  });
  // A step begins every 50 ms of the run; each takes at most two deadlines of the wall clock.
  const bool goes_on = soon([&] { return run.session.report().tick >= 15; }, 10);
  end = true;
  client.join();
  EXPECT_TRUE(goes_on) << run.session.report().tick;
}

TEST(Attacks, NoCommandOfARobotEndsTheRun) {
  Match run(with_tokens(), {});
  Bridge red = run.red();
  const auto drive = [&](const std::string& number) {
    for (const char* part : {"linear", "angular"})
      red.send_text(R"({"op":"publish","topic":"/rover1/drive","msg":{")" + std::string(part) + R"(":{"x":)" +
                    number + R"(,"y":)" + number + R"(,"z":)" + number + "}}}\n");
    std::this_thread::sleep_for(20ms);
  };
  for (const char* number : {"1e308", "-1e308", "1e-320", "null", "\"NaN\"", "\"inf\"", "NaN", "Infinity",
                             "1e999", "12345678901234567890123"})
    drive(number);
  const std::uint64_t tick = run.session.report().tick;
  EXPECT_TRUE(soon([&] { return run.session.report().tick > tick + 200; }));
  EXPECT_EQ(run.session.report().state, Session::State::playing) << run.session.report().reason;
  EXPECT_EQ(red.call("/rosapi/get_time", json::object())["result"], true);
}

}  // namespace
}  // namespace sandlot::server::test
