#include "base/log.h"
#include "messages/nav_msgs.h"
#include "messages/rcl_interfaces.h"
#include "messages/sandlot_msgs.h"
#include "messages/sensor_msgs.h"
#include "messages/tf2_msgs.h"
#include "server/test_viewer.h"
#include "sim/test_radios.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

/// One rover in a walled square, 10 ms a tick, a scan each 0.1 s.
model::Setup one_rover(const char* controller = "") { return arena("rigid", 1, controller); }

TEST(Server, SaysWhoItIsAndWhatThereIs) {
  Running run(one_rover(), {.paused = true}, {.name = "arena", .version = "1.2.3"});
  run.go();
  for (const char* subprotocol : {"foxglove.websocket.v1", "foxglove.sdk.v1"}) {
    Viewer viewer(run.url(), "", subprotocol);
    ASSERT_TRUE(viewer.until([&] { return viewer.channels.count("/rover1/laser/ranges") > 0; }));
    EXPECT_EQ(viewer.info["name"], "arena");
    EXPECT_EQ(viewer.info["metadata"]["ROS_DISTRO"], "humble");
    EXPECT_EQ(viewer.info["metadata"]["sandlot_version"], "1.2.3");
    EXPECT_EQ(viewer.info["metadata"]["sandlot_role"], "admin");
    const json& laser = viewer.channels["/rover1/laser/ranges"];
    EXPECT_EQ(laser["encoding"], "cdr");
    EXPECT_EQ(laser["schemaName"], "sensor_msgs/msg/LaserScan");
    EXPECT_EQ(laser["schemaEncoding"], "ros2msg");
    EXPECT_EQ(laser["schema"], message_info<msg::LaserScan>().schema);
    for (const char* topic :
         {"/tf", "/tf_static", "/clock", "/rosout", "/sandlot/world", "/sandlot/poses", "/sandlot/status",
          "/sandlot/commands", "/sandlot/contacts", "/sandlot/deliveries", "/sandlot/batteries"})
      EXPECT_EQ(viewer.channels.count(topic), 1u) << topic;
    EXPECT_EQ(viewer.services.size(), 34u);
  }
}

TEST(Server, TellsTheWorldThePosesAndTheLatestMessagesAlsoOfARunThatStandsStill) {
  Running run(one_rover(), {.paused = true});
  // 30 ticks of 10 ms: the scans of 0.1 s steps are there, the latest is of 0.3 s.
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(run.session.simulation().tick());
  run.go();
  Viewer viewer(run.url());
  const auto world = viewer.next(viewer.subscribe("/sandlot/world"));
  ASSERT_TRUE(world);
  EXPECT_EQ(world->parsed()["instances"].size(), 10u);  // ground, 4 walls, 2 pillars, 2 crates, the rover
  EXPECT_EQ(world->ns, 300'000'000u);
  const auto poses = viewer.next(viewer.subscribe("/sandlot/poses"));
  ASSERT_TRUE(poses);
  EXPECT_EQ(poses->bytes[1], std::byte{1}) << "a key frame";
  EXPECT_EQ(u64_at(poses->bytes, 8), 30u) << "tick";
  EXPECT_GE(u32_at(poses->bytes, 24), 3u) << "the rover and two crates can move";
  const auto scan = viewer.next(viewer.subscribe("/rover1/laser/ranges"));
  ASSERT_TRUE(scan);
  const auto message = viewer.read<msg::LaserScan>(*scan);
  EXPECT_EQ(message.ranges.size(), 61u);
  EXPECT_EQ(message.header.stamp, Time::from_s(0.3));
  EXPECT_EQ(scan->ns, 300'000'000u);
  const auto fixed = viewer.next(viewer.subscribe("/tf_static"));
  ASSERT_TRUE(fixed);
  EXPECT_FALSE(viewer.read<msg::TFMessage>(*fixed).transforms.empty());
  const auto moving = viewer.next(viewer.subscribe("/tf"));
  ASSERT_TRUE(moving);
  EXPECT_EQ(viewer.read<msg::TFMessage>(*moving).transforms.size(), 5u);  // 3 links of the rover, 2 crates
  const auto status = viewer.next(viewer.subscribe("/sandlot/status"));
  ASSERT_TRUE(status);
  EXPECT_EQ(status->parsed()["state"], "paused");
  EXPECT_EQ(status->parsed()["tick"], 30);
  EXPECT_EQ(status->parsed()["may_steer"], true);
}

TEST(Server, EveryMessageOfATopicComesOnceAndInOrder) {
  model::Setup setup = one_rover();
  setup.stop = Time::from_s(5);
  Running run(std::move(setup), {.paused = true, .stay = true});
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t scans = viewer.subscribe("/rover1/laser/ranges");
  viewer.console("list entities");  // by its answer the subscription is carried out
  viewer.listen(0.1);
  run.session.play();
  // At 10 Hz from 0 s to 5 s; that of 0 s was taken when the world was made.
  std::vector<double> stamps;
  while (stamps.empty() || stamps.back() < 5) {
    const auto scan = viewer.next(scans);
    ASSERT_TRUE(scan);
    stamps.push_back(viewer.read<msg::LaserScan>(*scan).header.stamp.s());
  }
  ASSERT_EQ(stamps.size(), 51u);
  for (std::size_t i = 0; i < stamps.size(); ++i) EXPECT_DOUBLE_EQ(stamps[i], 0.1 * static_cast<double>(i));
}

TEST(Server, AStepIsOneTickAndItsPosesComeAlthoughTheRunStandsStillAgain) {
  Running run(one_rover(), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t poses = viewer.subscribe("/sandlot/poses");
  ASSERT_TRUE(viewer.next(poses));
  for (std::uint64_t tick = 1; tick <= 3; ++tick) {
    const json answer = viewer.call("/step_simulation", {{"steps", 1}});
    EXPECT_EQ(answer["result"]["result"], 1) << answer;
    std::uint64_t seen = 0;
    while (seen < tick) {
      const auto message = viewer.next(poses);
      ASSERT_TRUE(message);
      seen = u64_at(message->bytes, 8);
    }
    EXPECT_EQ(seen, tick);
  }
}

/// Two radios that float, one of them with a battery that 5 W empty in 2 s.
model::Setup two_radios() {
  sandlot::test::Radios world(sandlot::test::keys_of({{"jitter", "0"}}));
  model::DeviceDecl battery;
  battery.name = battery.kind = "battery";
  battery.config = sandlot::test::keys_of({{"capacity", "10 J"}, {"drain", "5 W"}});
  world.add("ann", {}).devices.push_back(battery);
  world.add("bob", {10, 0, 0});
  return world.setup;
}

void send_a_packet_and_run_3_s(Viewer& viewer) {
  viewer.send({{"op", "advertise"},
               {"channels",
                {{{"id", 1},
                  {"topic", "/ann/radio/send/command"},
                  {"encoding", "json"},
                  {"schemaName", "sandlot_msgs/msg/RadioPacket"}}}}});
  viewer.publish(1, R"({"to": "", "data": [1, 2, 3]})");
  viewer.console("list entities");  // by its answer the packet is there
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 300}})["result"]["result"], 1);
}

TEST(Server, WhoHearsWhomAndChargesOfBatteriesAreSentToThoseWhoWantThem) {
  Running run(two_radios(), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t deliveries = viewer.subscribe("/sandlot/deliveries");
  const std::uint32_t batteries = viewer.subscribe("/sandlot/batteries");
  const auto full = viewer.next(batteries);
  ASSERT_TRUE(full) << "at once";
  EXPECT_EQ(u32_at(full->bytes, 24), 0x3f800000u) << "1.0 as a float";
  send_a_packet_and_run_3_s(viewer);
  std::optional<Viewer::Data> heard, charge;
  viewer.until([&] {
    for (; !viewer.data.empty(); viewer.data.pop_front()) {
      if (viewer.data.front().subscription == deliveries) heard = viewer.data.front();
      if (viewer.data.front().subscription == batteries) charge = viewer.data.front();
    }
    return heard && charge && u32_at(charge->bytes, 24) == 0;
  });
  ASSERT_TRUE(heard);
  ASSERT_EQ(heard->bytes.size(), 20u + 20);
  EXPECT_EQ(u32_at(heard->bytes, 16), 1u);
  const Simulation& simulation = run.session.simulation();
  EXPECT_EQ(u32_at(heard->bytes, 20), simulation.find_entity("ann")->serial);
  EXPECT_EQ(u32_at(heard->bytes, 24), simulation.find_entity("bob")->serial);
  ASSERT_TRUE(charge);
  EXPECT_EQ(u32_at(charge->bytes, 16), 1u);
  EXPECT_EQ(u32_at(charge->bytes, 20), simulation.find_entity("ann")->serial);
  EXPECT_EQ(u32_at(charge->bytes, 24), 0u) << "empty";
}

TEST(Server, WhoLooksAtDeliveriesAndBatteriesChangesNothing) {
  const auto hash_after = [](bool subscribed) {
    Running run(two_radios(), {.paused = true});
    run.go();
    Viewer viewer(run.url());
    if (subscribed)
      for (const char* topic : {"/sandlot/deliveries", "/sandlot/batteries"}) viewer.subscribe(topic);
    send_a_packet_and_run_3_s(viewer);
    return viewer.console("hash")["text"].get<std::string>();
  };
  EXPECT_EQ(hash_after(true), hash_after(false));
}

TEST(Server, NumbersAreWatchedAtEveryTickAndAtARate) {
  Running run(one_rover(), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  const json all = viewer.call("/sandlot/watch", {{"values", {"sim.time", "sim.tick * 2"}}, {"rate_hz", 0}});
  ASSERT_EQ(all["ok"], true) << all;
  const json some = viewer.call("/sandlot/watch", {{"values", {"sim.tick"}}, {"rate_hz", 25}});
  ASSERT_EQ(some["ok"], true) << some;
  const std::uint32_t every_tick = viewer.subscribe(all["topic"]);
  const std::uint32_t at_25_Hz = viewer.subscribe(some["topic"]);
  // Where it stands is told at once.
  for (const std::uint32_t watched : {every_tick, at_25_Hz}) {
    const auto now = viewer.next(watched);
    ASSERT_TRUE(now);
    EXPECT_EQ(now->ns, 0u);
  }
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 20}})["result"]["result"], 1);
  std::vector<msg::Samples> first, second;
  viewer.until([&] {
    for (; !viewer.data.empty(); viewer.data.pop_front()) {
      const auto samples = viewer.read<msg::Samples>(viewer.data.front());
      if (viewer.data.front().subscription == every_tick) first.push_back(samples);
      if (viewer.data.front().subscription == at_25_Hz) second.push_back(samples);
    }
    return first.size() >= 20 && second.size() >= 5;
  });
  ASSERT_EQ(first.size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) {
    const double tick = static_cast<double>(i) + 1;
    ASSERT_EQ(first[i].values.size(), 2u);
    EXPECT_DOUBLE_EQ(first[i].values[0], 0.01 * tick);
    EXPECT_DOUBLE_EQ(first[i].values[1], 2 * tick);
  }
  // Due at 0, 0.04, 0.08 ... s; ticks end at 0.01, 0.02 ...: the first one not before each.
  const double due[] = {1, 4, 8, 12, 16, 20};
  ASSERT_EQ(second.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ(second[i].values[0], due[i]);
  // Tick 21 is not due, but the run stands still there.
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 1}})["result"]["result"], 1);
  const auto still = viewer.next(at_25_Hz);
  ASSERT_TRUE(still);
  EXPECT_EQ(still->ns, 210'000'000u);

  const json wrong = viewer.call("/sandlot/watch", {{"values", {"rover1.pose.xx"}}, {"rate_hz", 0}});
  EXPECT_EQ(wrong["ok"], false);
  EXPECT_NE(wrong["text"].get<std::string>().find("rover1.pose.x"), std::string::npos) << wrong;
  const json costly = viewer.call("/sandlot/watch",
                                  {{"values", {"sum(min(rover*.pose.x - r*.pose.x))"}}, {"rate_hz", 0}});
  EXPECT_EQ(costly["ok"], false);
  EXPECT_NE(costly["text"].get<std::string>().find("aggregates within each other"), std::string::npos)
      << costly;
  const json many = viewer.call("/sandlot/watch",
                                {{"values", std::vector<std::string>(199, "sim.time")}, {"rate_hz", 0}});
  EXPECT_EQ(many["ok"], false) << "3 + 199 numbers are more than 200";
}

TEST(Server, AViewersAggregatesReadSoMuchTogether) {
  Running run(test::arena("planar", 50), {.paused = true});
  run.go();
  Viewer one(run.url()), other(run.url());
  const std::string sum = "sum(rover*.pose.x + rover*.pose.y + rover*.pose.z + rover*.errors";  // 200 values
  const auto watch = [&](Viewer& viewer, int count) {
    return viewer.call(
        "/sandlot/watch",
        {{"values", std::vector<std::string>(static_cast<std::size_t>(count), sum + ")")}, {"rate_hz", 0}});
  };
  EXPECT_EQ(watch(one, 60)["ok"], true);
  const json refused = watch(one, 41);
  EXPECT_EQ(refused["ok"], false);
  EXPECT_NE(refused["text"].get<std::string>().find("reads 20200 values; at most 20000"), std::string::npos)
      << refused;
  EXPECT_EQ(watch(one, 40)["ok"], true);
  EXPECT_EQ(watch(other, 100)["ok"], true) << "another viewer has its own share";
}

TEST(Server, AWatchIsItsClientsOwnAndGoesWithItsSubscription) {
  Running run(one_rover(), {.paused = true});
  run.go();
  Viewer one(run.url()), other(run.url());
  const std::string topic = one.call("/sandlot/watch", {{"values", {"sim.time"}}, {"rate_hz", 0}})["topic"];
  const std::uint32_t subscription = one.subscribe(topic);
  const std::uint32_t channel = one.channels[topic]["id"];
  other.console("list entities");
  EXPECT_EQ(other.channels.count(topic), 0u);
  other.send({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", channel}}}}});
  ASSERT_TRUE(other.until([&] { return !other.statuses.empty(); }));
  EXPECT_EQ(other.statuses[0]["level"], 2);
  one.send({{"op", "unsubscribe"}, {"subscriptionIds", {subscription}}});
  EXPECT_TRUE(one.until([&] { return !one.unadvertised.empty(); }));
  EXPECT_EQ(one.unadvertised, std::vector{channel});
}

TEST(Server, AParameterChangesTheRunAndEverybodyHearsOfIt) {
  Running run(one_rover("wander"), {});
  run.go();
  Viewer viewer(run.url()), other(run.url());
  other.send({{"op", "subscribeParameterUpdates"}, {"parameterNames", {"rover1/laser.noise.white"}}});
  const std::uint32_t commands = other.subscribe("/sandlot/commands");
  other.console("list entities");
  other.listen(0.1);
  viewer.send({{"op", "getParameters"}, {"parameterNames", json::array()}, {"id", "all"}});
  ASSERT_TRUE(viewer.until([&] { return !viewer.parameters.empty(); }));
  std::map<std::string, json> values;
  for (const json& each : viewer.parameters[0]["parameters"]) values[each["name"]] = each["value"];
  EXPECT_EQ(values["rover1/laser.noise.white"], 0.01);
  EXPECT_EQ(values.count("rover1/controller.speed"), 1u);
  EXPECT_EQ(values["sim.errors"], 1);
  EXPECT_EQ(values["rover1.errors"], 1);
  EXPECT_EQ(values["sandlot.paused"], false);
  EXPECT_EQ(values["sandlot.speed"], 0) << "as fast as possible";

  viewer.send({{"op", "setParameters"},
               {"parameters", {{{"name", "rover1/laser.noise.white"}, {"value", 0.5}}}},
               {"id", "set"}});
  ASSERT_TRUE(viewer.until([&] { return viewer.parameters.size() == 2; }));
  EXPECT_EQ(viewer.parameters[1]["id"], "set");
  EXPECT_EQ(viewer.parameters[1]["parameters"][0]["value"], 0.5);
  ASSERT_TRUE(other.until([&] { return !other.parameters.empty(); }));
  EXPECT_EQ(other.parameters[0]["parameters"][0]["value"], 0.5);
  const auto logged = other.next(commands);
  ASSERT_TRUE(logged);
  EXPECT_EQ(logged->parsed()["commands"][0]["kind"], "parameter");
  EXPECT_EQ(logged->parsed()["commands"][0]["target"], "rover1/laser");

  viewer.send({{"op", "setParameters"},
               {"parameters", {{{"name", "rover1/laser.noise.white"}, {"value", -1}}}},
               {"id", "bad"}});
  ASSERT_TRUE(viewer.until([&] { return viewer.parameters.size() == 3; }));
  EXPECT_EQ(viewer.parameters[2]["parameters"][0]["value"], 0.5) << "the old one";
  ASSERT_EQ(viewer.statuses.size(), 1u);
  EXPECT_EQ(viewer.statuses[0]["level"], 2);
  EXPECT_EQ(viewer.statuses[0]["id"], "bad");

  viewer.send({{"op", "setParameters"}, {"parameters", {{{"name", "sandlot.paused"}, {"value", true}}}}});
  EXPECT_TRUE(viewer.until([&] { return run.session.report().state == Session::State::paused; }));
}

TEST(Server, ClientsPublishCommandsByThreeNamesInTwoEncodings) {
  Running run(one_rover(), {.pace = {1.0}});
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t commands = viewer.subscribe("/sandlot/commands");
  viewer.console("list entities");
  viewer.listen(0.1);
  const char* names[] = {"/rover1/cmd_vel", "/rover1/drive", "/rover1/drive/contact/command"};
  for (std::uint32_t i = 0; i < 3; ++i) {
    viewer.send({{"op", "advertise"},
                 {"channels",
                  {{{"id", i},
                    {"topic", names[i]},
                    {"encoding", "json"},
                    {"schemaName", i == 1 ? "" : "geometry_msgs/Twist"}}}}});
    viewer.publish(i, R"({"linear": {"x": 0.25}})");
    const auto logged = viewer.next(commands);
    ASSERT_TRUE(logged) << names[i] << (viewer.statuses.empty() ? "" : viewer.statuses.back().dump());
    const json entry = logged->parsed()["commands"][0];
    EXPECT_EQ(entry["source"], "robot");
    EXPECT_EQ(entry["kind"], "command");
    EXPECT_EQ(entry["refused"], i == 2) << "the contact level is not active: " << entry;
  }
  msg::Twist twist;
  twist.linear.x = 0.5;
  std::vector<std::byte> cdr;
  write_cdr(message_info<msg::Twist>(), &twist, cdr);
  viewer.send({{"op", "advertise"},
               {"channels",
                {{{"id", 7},
                  {"topic", "/rover1/cmd_vel"},
                  {"encoding", "cdr"},
                  {"schemaName", "geometry_msgs/msg/Twist"}}}}});
  viewer.publish(7, {reinterpret_cast<const char*>(cdr.data()), cdr.size()});
  ASSERT_TRUE(viewer.next(commands));
  const json now = viewer.console("show rover1/drive/ideal/command.linear.x");
  EXPECT_NE(now["text"].get<std::string>().find("0.5"), std::string::npos) << now;
  const std::size_t before = viewer.statuses.size();
  viewer.publish(7, "no twist");
  viewer.publish(99, "nothing");
  viewer.send(
      {{"op", "advertise"},
       {"channels", {{{"id", 8}, {"topic", "/rover1/cmd_val"}, {"encoding", "json"}, {"schemaName", ""}}}}});
  ASSERT_TRUE(viewer.until([&] { return viewer.statuses.size() >= before + 3; }));
  EXPECT_NE(viewer.statuses.back()["message"].get<std::string>().find("/rover1/cmd_vel"), std::string::npos)
      << viewer.statuses.back();
}

TEST(Server, SpectatorsSeeButCannotSteer) {
  Running run(one_rover("wander"), {.pace = {1.0}});
  run.go();
  Viewer viewer(run.url(), "?role=spectator");
  ASSERT_TRUE(viewer.next(viewer.subscribe("/sandlot/world")));
  EXPECT_EQ(viewer.info["metadata"]["sandlot_role"], "spectator");
  const auto status = viewer.next(viewer.subscribe("/sandlot/status"));
  ASSERT_TRUE(status);
  EXPECT_EQ(status->parsed()["may_steer"], false);
  EXPECT_EQ(viewer.console("list entities")["ok"], true);
  EXPECT_EQ(viewer.console("pause")["ok"], false);
  EXPECT_EQ(viewer.call("/get_entities", {{"filters", json::object()}})["result"]["result"], 1);
  EXPECT_TRUE(viewer.call("/set_simulation_state", {{"state", {{"state", 2}}}}).is_null());
  ASSERT_TRUE(viewer.until([&] { return !viewer.statuses.empty(); }));
  const std::size_t before = viewer.statuses.size();
  viewer.send({{"op", "setParameters"}, {"parameters", {{{"name", "sandlot.paused"}, {"value", true}}}}});
  viewer.send(
      {{"op", "advertise"},
       {"channels", {{{"id", 1}, {"topic", "/rover1/cmd_vel"}, {"encoding", "json"}, {"schemaName", ""}}}}});
  viewer.publish(1, "{}");
  ASSERT_TRUE(viewer.until([&] { return viewer.statuses.size() >= before + 3; }));
  for (const json& each : viewer.statuses) EXPECT_EQ(each["level"], 2);
  EXPECT_EQ(run.session.report().state, Session::State::playing);
  EXPECT_GE(run.server->counters().refused, 4u);
}

TEST(Server, SimulationInterfacesAreAnsweredWithTheirCodes) {
  Running run(one_rover(), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  EXPECT_EQ(viewer.call("/get_simulation_state", json::object())["state"]["state"], 2);
  EXPECT_EQ(viewer.call("/set_simulation_state", {{"state", {{"state", 2}}}})["result"]["result"], 101);
  const json all = viewer.call("/get_entities", {{"filters", {{"filter", "^crate[12]$"}}}});
  EXPECT_EQ(all["entities"], json({"crate1", "crate2"}));
  const json robots = viewer.call("/get_entities", {{"filters", {{"categories", {{{"category", 1}}}}}}});
  EXPECT_EQ(robots["entities"], json({"rover1"}));
  EXPECT_EQ(viewer.call("/get_entities", {{"filters", {{"filter", "(a|b"}}}})["result"]["result"], 4);
  EXPECT_EQ(viewer.call("/get_entity_state", {{"entity", "nobody"}})["result"]["result"], 2);
  const json crate = viewer.call("/get_entity_state", {{"entity", "crate1"}});
  EXPECT_EQ(crate["state"]["pose"]["position"]["y"], -2.1);
  const json set = viewer.call("/set_entity_state",
                               {{"entity", "crate1"},
                                {"set_pose", true},
                                {"state", {{"pose", {{"position", {{"x", 1}, {"y", 2}, {"z", 0.2}}}}}}}});
  EXPECT_EQ(set["result"]["result"], 1) << set;
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 1}})["result"]["result"], 1);
  const json moved = viewer.call("/get_entity_state", {{"entity", "crate1"}});
  EXPECT_NEAR(moved["state"]["pose"]["position"]["x"].get<double>(), 1, 1e-6);
  EXPECT_EQ(viewer.call("/delete_entity", {{"entity", "crate1"}})["result"]["result"], 1);
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 1}})["result"]["result"], 1);
  EXPECT_EQ(viewer.call("/get_entity_state", {{"entity", "crate1"}})["result"]["result"], 2);
  const json reset = viewer.call("/reset_simulation", {{"scope", 0}});
  EXPECT_EQ(reset["result"]["result"], 1) << reset;
  EXPECT_EQ(viewer.call("/get_entity_state", {{"entity", "crate1"}})["result"]["result"], 1);
  EXPECT_EQ(run.session.report().tick, 0u);
  EXPECT_EQ(viewer.call("/set_simulation_state", {{"state", {{"state", 1}}}})["result"]["result"], 1);
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 1}})["result"]["result"], 4) << "it is not paused";
}

/// With what has State outside of robots, and a robot that came: it is gone again.
TEST(Server, AfterAResetTheRunIsTheSameAgain) {
  model::Setup setup = arena("rigid", 2);
  setup.media.push_back({"wind", "wind", Node::map(), {}});
  setup.rules.push_back({"impact", "impact", sandlot::test::map({{"threshold", "0.001"}}), {}});
  Running run(std::move(setup), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  const auto hash_after = [&](int steps) {
    EXPECT_EQ(viewer.call("/step_simulation", {{"steps", steps}})["result"]["result"], 1);
    return viewer.console("hash")["text"].get<std::string>();
  };
  const std::string expected = hash_after(60);
  EXPECT_EQ(viewer.console("add copy of rover1 as late 2.8 2.6")["ok"], true);
  EXPECT_EQ(viewer.console("set media/wind.velocity [3, 0, 0]")["ok"], true);
  EXPECT_NE(hash_after(20), expected);
  EXPECT_EQ(viewer.call("/reset_simulation", {{"scope", 0}})["result"]["result"], 1);
  EXPECT_EQ(viewer.call("/get_entity_state", {{"entity", "late"}})["result"]["result"], 2);
  EXPECT_EQ(hash_after(60), expected);
}

TEST(Server, AnotherWorldIsToldAnewAndChannelsStay) {
  Running run(one_rover(), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t world = viewer.subscribe("/sandlot/world"), poses = viewer.subscribe("/sandlot/poses");
  const auto first = viewer.next(world);
  ASSERT_TRUE(first);
  ASSERT_TRUE(viewer.next(poses));
  const json watch = viewer.call("/sandlot/watch", {{"values", {"rover1.pose.x"}}, {"rate_hz", 0}});
  const std::uint32_t watched = viewer.subscribe(watch["topic"]);
  const std::uint32_t laser = viewer.channels["/rover1/laser/ranges"]["id"];
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 5}})["result"]["result"], 1);
  EXPECT_EQ(viewer.call("/reset_simulation", {{"scope", 0}})["result"]["result"], 1);
  const auto again = viewer.next(world);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->parsed()["epoch"], first->parsed()["epoch"].get<int>() + 1);
  std::optional<Viewer::Data> key;
  do key = viewer.next(poses);
  while (key && u64_at(key->bytes, 8) != 0);
  ASSERT_TRUE(key);
  EXPECT_EQ(key->bytes[1], std::byte{1}) << "a key frame";
  EXPECT_EQ(viewer.channels["/rover1/laser/ranges"]["id"], laser);
  EXPECT_TRUE(viewer.unadvertised.empty());
  viewer.data.clear();
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 1}})["result"]["result"], 1);
  auto sample = viewer.next(watched);
  while (sample && sample->ns == 0) sample = viewer.next(watched);  // where it stood after the reset
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->ns, 10'000'000u);
  // What goes takes its channels with it.
  EXPECT_EQ(viewer.call("/delete_entity", {{"entity", "rover1"}})["result"]["result"], 1);
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 1}})["result"]["result"], 1);
  EXPECT_TRUE(viewer.until([&] { return viewer.channels.count("/rover1/laser/ranges") == 0; }));
}

/// A jump back runs tick 1 again with the order it had then; the next one that viewers hear of is that of tick 4.
TEST(Server, WhatIsRunAgainIsNotToldAgain) {
  Running run(one_rover(), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t commands = viewer.subscribe("/sandlot/commands");
  EXPECT_TRUE(viewer.console("pose rover1 1 1")["ok"]);
  viewer.listen(0.1);  // until the run knows who looks
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 5}})["result"]["result"], 1);
  const auto first = viewer.next(commands);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->parsed()["commands"][0]["tick"], 1);
  EXPECT_TRUE(viewer.console("jump 0.03 s")["ok"]);
  EXPECT_TRUE(viewer.until([&] {
    viewer.listen(0.02);
    const Session::Report report = run.session.report();
    return report.epoch == 2 && report.tick == 3 && report.state == Session::State::paused;
  }));
  EXPECT_TRUE(viewer.console("pose rover1 2 2")["ok"]);
  EXPECT_EQ(viewer.call("/step_simulation", {{"steps", 1}})["result"]["result"], 1);
  const auto second = viewer.next(commands);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->parsed()["commands"][0]["tick"], 4);
}

TEST(Server, DevicesOfferServicesThatComeAndGoWithThem) {
  model::Setup setup = one_rover();
  model::DeviceDecl odometry;
  odometry.name = "odometry";
  odometry.kind = "wheel_odometry";
  odometry.config = sandlot::test::map({{"left_joint", "left_wheel_joint"},
                                        {"right_joint", "right_wheel_joint"},
                                        {"wheel_radius", "0.07"},
                                        {"wheel_separation", "0.3"},
                                        {"rate", "0"}});
  setup.instances.back().devices.push_back(odometry);
  Running run(std::move(setup), {.paused = false});
  run.go();
  Viewer viewer(run.url());
  const auto offered = [&] { return viewer.services.count("/rover1/odometry/set_pose") > 0; };
  ASSERT_TRUE(viewer.until(offered));
  EXPECT_EQ(viewer.call("/rover1/odometry/reset", json::object()),
            (json{{"success", true}, {"message", "the odometry is at zero"}}));
  const json pose{{"header", {{"frame_id", "rover1/odom"}}},
                  {"pose", {{"pose", {{"position", {{"x", 3}}}}}}}};
  EXPECT_EQ(viewer.call("/rover1/odometry/set_pose", {{"pose", pose}}), json::object());
  const auto shown = viewer.subscribe("/rover1/odometry/odometry");
  std::optional<Viewer::Data> data = viewer.next(shown);
  while (data && std::abs(viewer.read<msg::Odometry>(*data).pose.pose.p.x - 3) > 0.1)
    data = viewer.next(shown);
  ASSERT_TRUE(data) << "the rover stands still at x = 3 of its odometry";

  json wrong = pose;
  wrong["header"]["frame_id"] = "map";
  const std::uint32_t refused = viewer.start_call("/rover1/odometry/set_pose", json{{"pose", wrong}}.dump());
  ASSERT_TRUE(viewer.until([&] { return viewer.failures.count(refused) > 0; }));
  EXPECT_EQ(viewer.failures[refused], "the pose is in 'map'; give it in 'rover1/odom'");
  const json said = viewer.console("call rover1/odometry reset");
  EXPECT_TRUE(said["ok"]);
  EXPECT_NE(said["text"].get<std::string>().find("the odometry is at zero"), std::string::npos) << said;
  EXPECT_TRUE(viewer.call("/delete_entity", {{"entity", "rover1"}})["result"]["result"] == 1);
  EXPECT_TRUE(viewer.until([&] { return !offered(); }));
  EXPECT_EQ(viewer.services.size(), 29u);
}

TEST(Server, WarningsOfTheProgramAreLogLines) {
  Running run(one_rover(), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t lines = viewer.subscribe("/rosout");
  viewer.console("list entities");
  viewer.listen(0.1);
  log::warning("the floor is wet");
  const auto line = viewer.next(lines);
  ASSERT_TRUE(line);
  const auto log = viewer.read<msg::Log>(*line);
  EXPECT_EQ(log.level, 30);
  EXPECT_EQ(log.msg, "the floor is wet");
}

TEST(Server, WhoSubscribesLateHasTheLatestLogLines) {
  Running run(one_rover(), {.paused = true});
  run.go();
  for (int i = 0; i < 250; ++i) log::info("line " + std::to_string(i));
  Viewer viewer(run.url());
  const std::uint32_t lines = viewer.subscribe("/rosout");
  const auto first = viewer.next(lines);
  ASSERT_TRUE(first);
  EXPECT_EQ(viewer.read<msg::Log>(*first).msg, "line 50");
  for (int i = 51; i < 249; ++i) ASSERT_TRUE(viewer.next(lines));
  const auto last = viewer.next(lines);
  ASSERT_TRUE(last);
  EXPECT_EQ(viewer.read<msg::Log>(*last).msg, "line 249");
}

TEST(Server, TheGraphNamesWhoTalksToWhom) {
  Running run(one_rover("wander"), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  ASSERT_NE(viewer.channel("/rover1/laser/ranges"), 0u);
  viewer.subscribe("/rover1/laser/ranges");
  viewer.send({{"op", "subscribeConnectionGraph"}});
  const auto ids = [&](const char* side, const char* topic) {
    std::vector<std::string> out;
    for (const json& each : viewer.graphs.back()[side])
      if (each["name"] == topic)
        for (const json& id : each[std::string(side) == "publishedTopics" ? "publisherIds" : "subscriberIds"])
          out.push_back(id);
    return out;
  };
  ASSERT_TRUE(viewer.until(
      [&] { return !viewer.graphs.empty() && ids("subscribedTopics", "/rover1/laser/ranges").size() == 2; }));
  EXPECT_EQ(ids("publishedTopics", "/rover1/laser/ranges"), std::vector<std::string>{"rover1/laser"});
  EXPECT_EQ(ids("subscribedTopics", "/rover1/laser/ranges")[0], "rover1/controller");
  EXPECT_EQ(ids("publishedTopics", "/rover1/drive/ideal/command"),
            std::vector<std::string>{"rover1/controller"});
}

}  // namespace
}  // namespace sandlot::server::test
