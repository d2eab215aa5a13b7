/// Topics that programs read: clients of both protocols publish on them, and find them in the lists.
#include "messages/registry.h"
#include "server/test_bridge.h"
#include "sim/watch/values.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

/// Two rovers that stand; the second one waits for its first pose.
model::Setup with_localiser() {
  model::Setup setup = arena("planar", 2, "");
  setup.instances.back().controllers.push_back(
      {"localiser",
       "localise",
       sandlot::test::map({{"map_data", "90 90 0.1 -4.5 -4.5 0\n450*100 7650*0"},
                           {"odometry", "truth"},
                           {"begin", "topic"},
                           {"max_particles", "500"}}),
       {}});
  return setup;
}

constexpr const char* topic = "/rover2/initialpose";
constexpr const char* type = "geometry_msgs/msg/PoseWithCovarianceStamped";

json shown(Viewer& viewer, const std::string& address) {
  const json answer = viewer.console("show " + address + " --json");
  return json::parse(answer["text"].get<std::string>())[0]["value"];
}

/// Asks until it holds.
template <class F>
bool comes(F&& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

TEST(ProgramTopics, AClientOfFoxglovePublishesInTwoEncodings) {
  Running run(with_localiser(), {.pace = {1.0}});
  run.go();
  Viewer viewer(run.url());
  const auto advertise = [&](int id, const char* encoding, const char* name, const char* schema) {
    viewer.send(
        {{"op", "advertise"},
         {"channels", {{{"id", id}, {"topic", name}, {"encoding", encoding}, {"schemaName", schema}}}}});
  };
  const auto arrived = [&](double count) {
    return comes([&] { return shown(viewer, "rover2/localiser.poses") == count; });
  };
  advertise(1, "json", topic, type);
  viewer.publish(1,
                 R"({"header": {"frame_id": "map"}, "pose": {"pose": {"position": {"x": 1.5, "y": -0.5}}}})");
  EXPECT_TRUE(arrived(1));
  // A pose without covariance: all particles are there, and no scan moves them.
  EXPECT_NEAR(shown(viewer, "rover2/localiser/amcl_pose.pose.pose.position.x").get<double>(), 1.5, 1e-9);
  msg::PoseWithCovarianceStamped message;
  message.pose.pose.p = {-2, 1, 0};
  std::vector<std::byte> cdr;
  write_cdr(message_info<msg::PoseWithCovarianceStamped>(), &message, cdr);
  advertise(2, "cdr", topic, type);
  viewer.publish(2, {reinterpret_cast<const char*>(cdr.data()), cdr.size()});
  EXPECT_TRUE(arrived(2));
  EXPECT_EQ(shown(viewer, "rover2/initialpose.pose.pose.position.x"), -2);
  // What is no such message, of another type, or for nobody is answered.
  const std::size_t before = viewer.statuses.size();
  viewer.publish(2, "no pose");
  advertise(3, "json", topic, "geometry_msgs/msg/Twist");
  advertise(4, "json", "/rover1/initialpose", type);
  ASSERT_TRUE(viewer.until([&] { return viewer.statuses.size() >= before + 3; }));
  const auto said = [&](std::size_t i) { return viewer.statuses[before + i]["message"].get<std::string>(); };
  EXPECT_NE(said(1).find("takes geometry_msgs/msg/PoseWithCovarianceStamped, not geometry_msgs/msg/Twist"),
            std::string::npos)
      << said(1);
  EXPECT_NE(said(2).find("did you mean '/rover2/initialpose'?"), std::string::npos) << said(2);
  EXPECT_EQ(shown(viewer, "rover2/localiser.poses"), 2);
  // The world's message has the topic with its program.
  const auto world = viewer.next(viewer.subscribe("/sandlot/world"));
  ASSERT_TRUE(world);
  int seen = 0;
  const json instances = world->parsed()["instances"];
  for (const json& instance : instances)
    if (instance["name"] == "rover2") {
      EXPECT_EQ(instance["controllers"][0]["inputs"], json({{{"name", topic}, {"type", type}}}));
      ++seen;
    }
  EXPECT_EQ(seen, 1);
}

TEST(ProgramTopics, SpectatorsDoNotPublish) {
  Running run(with_localiser(), {.pace = {1.0}});
  run.go();
  Viewer viewer(run.url(), "?role=spectator");
  viewer.send({{"op", "advertise"},
               {"channels", {{{"id", 1}, {"topic", topic}, {"encoding", "json"}, {"schemaName", type}}}}});
  viewer.publish(1, R"({"pose": {"pose": {"position": {"x": 1.5}}}})");
  ASSERT_TRUE(viewer.until([&] { return !viewer.statuses.empty(); }));
  EXPECT_EQ(shown(viewer, "rover2/initialpose.count"), 0);
}

TEST(ProgramTopics, AClientThatDrivesARobotPublishesForNoOther) {
  Running run(with_localiser(), {.pace = {1.0}});
  run.go();
  Bridge bridge(run.url());
  ASSERT_EQ(bridge.claim({{"robot", "rover1"}})["op"], "sandlot.claimed");
  bridge.send({{"op", "publish"}, {"topic", topic}, {"msg", json::object()}});
  const json refusal = bridge.next("status");
  ASSERT_FALSE(refusal.is_null());
  EXPECT_NE(refusal["msg"].get<std::string>().find("rover2/initialpose"), std::string::npos) << refusal;
  Viewer admin(run.url());
  EXPECT_EQ(shown(admin, "rover2/initialpose.count"), 0);
}

TEST(ProgramTopics, AClientOfRosbridgePublishesAndFindsThemByRosapi) {
  Running run(with_localiser(), {.pace = {1.0}});
  run.go();
  Bridge bridge(run.url());
  const auto ask = [&](const std::string& service, const json& args) {
    return bridge.call("/rosapi/" + service, args)["values"];
  };
  const auto shown = [&](const std::string& address) {
    const json answer = bridge.call("/sandlot/console", {{"line", "show " + address + " --json"}});
    return json::parse(answer["values"]["text"].get<std::string>())[0]["value"];
  };
  EXPECT_EQ(ask("subscribers", {{"topic", topic}})["subscribers"], json({"/rover2/localiser"}));
  const json reads = ask("node_details", {{"node", "/rover2/localiser"}})["subscribing"];
  EXPECT_EQ(std::count(reads.begin(), reads.end(), topic), 1) << reads;
  bridge.send({{"op", "advertise"}, {"topic", topic}, {"type", "geometry_msgs/PoseWithCovarianceStamped"}});
  bridge.send(
      {{"op", "publish"}, {"topic", topic}, {"msg", {{"pose", {{"pose", {{"position", {{"x", 1.25}}}}}}}}}});
  EXPECT_TRUE(comes([&] { return shown("rover2/localiser.poses") == 1; }));
  EXPECT_EQ(shown("rover2/initialpose.pose.pose.position.x"), 1.25);
  const json publishers = ask("publishers", {{"topic", topic}})["publishers"];
  EXPECT_EQ(publishers.size(), 1u) << publishers;
}

/// A client that has claimed a robot and sends it somewhere drives nothing by that: it may be silent while the robot's
/// program goes there, and the robot is not stopped.
TEST(ProgramTopics, WhoSendsAGoalMayBeSilent) {
  ServerOptions options;
  options.watchdog_s = 0.2;
  Running run(with_localiser(), {.pace = {1.0}}, options);
  run.go();
  Bridge bridge(run.url());
  ASSERT_EQ(bridge.claim({{"robot", "rover2"}})["op"], "sandlot.claimed");
  bridge.send({{"op", "set_level"}, {"level", "warning"}});
  bridge.send({{"op", "publish"}, {"topic", topic}, {"msg", json::object()}});
  EXPECT_EQ(bridge.next("status", 1), json());
  Viewer admin(run.url());
  EXPECT_EQ(shown(admin, "rover2/localiser.poses"), 1);
  // In contrast to who drives it.
  bridge.send({{"op", "publish"}, {"topic", "/rover2/drive"}, {"msg", json::object()}});
  EXPECT_EQ(bridge.next("status")["msg"], "no command for long: 'rover2' was stopped");
}

}  // namespace
}  // namespace sandlot::server::test
