/// What a scenario shares, as attacks: a token opens its robots and what is shared by name, by each face, and nothing else.
#include "server/test_bridge.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

model::Setup sharing(std::vector<std::string> topics,
                     model::Sharing::Spectators spectators = model::Sharing::Spectators::world) {
  model::Setup setup = arena("planar", 2, "");
  for (std::string& each : topics) setup.sharing.topics.push_back({std::move(each), {}});
  setup.sharing.spectators = spectators;
  return setup;
}

ServerOptions with_tokens() {
  ServerOptions options;
  options.transport.tokens = {{"secret of admin", {.role = Role::admin}},
                              {"secret of one", {.role = Role::robot, .name = "rover1"}}};
  return options;
}

std::string refused(Bridge& bridge, const json& message) {
  bridge.send(message);
  return bridge.next("status").value("msg", "");
}
json subscribe(const std::string& topic) { return {{"op", "subscribe"}, {"topic", topic}}; }

bool is_time(std::string_view topic) { return topic == "/clock" || topic == "/sandlot/step_times"; }

TEST(Sharing, ARobotsTokenSeesWhatIsSharedByNameAndNothingElse) {
  Running run(sharing({"/rover2/truth*", "/tf_static"}), {.pace = {1.0}}, with_tokens());
  run.go();
  Bridge one(run.url());
  EXPECT_EQ(one.claim({{"robot", "rover1"}, {"token", "secret of one"}})["op"], "sandlot.claimed");
  const json topics = one.call("/rosapi/topics", json::object())["values"]["topics"];
  std::string shared;
  for (const json& each : topics) {
    const auto name = each.get<std::string>();
    if (name.rfind("/rover2/", 0) == 0) shared = name;
    EXPECT_TRUE(name.rfind("/rover1/", 0) == 0 || name.rfind("/rover2/truth", 0) == 0 ||
                name == "/tf_static" || is_time(name))
        << name;
  }
  ASSERT_EQ(shared.rfind("/rover2/truth", 0), 0u);
  one.send(subscribe(shared));
  EXPECT_EQ(one.next("publish")["topic"], shared);
  one.send(subscribe("/tf_static"));
  json next = one.next("publish");
  while (!next.is_null() && next["topic"] == shared) next = one.next("publish");
  EXPECT_EQ(next["topic"], "/tf_static");
  for (const char* topic :
       {"/tf", "/rosout", "/rover2/laser/ranges", "/sandlot/world", "/sandlot/poses", "/sandlot/commands",
        "/sandlot/contacts", "/sandlot/batteries", "/rover2/drive/ideal/command", "/rover2/tru"})
    EXPECT_EQ(refused(one, subscribe(topic)).substr(0, 17), "there is no topic") << topic;
  // Seeing is not commanding.
  EXPECT_EQ(refused(one, {{"op", "publish"}, {"topic", "/rover2/drive"}, {"msg", json::object()}}),
            "nothing takes messages on '/rover2/drive'; did you mean '/rover1/drive'?");
  for (const char* service : {"/get_entities", "/get_entity_state", "/sandlot/watch", "/sandlot/console",
                              "/get_named_poses", "/spawn_entity", "/load_world", "/get_current_world"})
    EXPECT_EQ(one.call(service, json::object())["result"], false) << service;
  for (const char* service : {"/rosapi/get_param", "/rosapi/set_param", "/rosapi/get_param_names"})
    EXPECT_EQ(one.call(service, {{"name", "rover2/laser.noise.white"}, {"value", "0"}})["result"], false)
        << service;
  const json nodes = one.call("/rosapi/nodes", json::object())["values"]["nodes"];
  for (const json& each : nodes) {
    const auto name = each.get<std::string>();
    EXPECT_TRUE(name.rfind("/rover1", 0) == 0 || name == "/rover2/truth" || name == "/sandlot") << name;
  }
}

TEST(Sharing, HoldsByTheOtherFaceToo) {
  Running run(sharing({"/rover2/truth*", "/sandlot/poses"}), {.pace = {1.0}}, with_tokens());
  run.go();
  Viewer one(run.url(), "?token=secret%20of%20one");
  ASSERT_NE(one.channel("/sandlot/poses"), 0u);
  one.listen(0.2);
  for (const auto& [topic, channel] : one.channels)
    EXPECT_TRUE(topic == "/sandlot/poses" || topic == "/sandlot/status" || is_time(topic) ||
                topic.rfind("/rover2/truth", 0) == 0)
        << topic;
  EXPECT_TRUE(one.next(one.subscribe("/sandlot/poses")));
  // By number, although it was never told: those of an administrator.
  Viewer admin(run.url(), "?token=secret%20of%20admin");
  const std::uint32_t world = admin.channel("/sandlot/world"), tf = admin.channel("/tf");
  std::uint32_t subscription = 500;
  for (const std::uint32_t channel : {world, tf}) {
    const std::size_t before = one.statuses.size();
    one.send({{"op", "subscribe"}, {"subscriptions", {{{"id", ++subscription}, {"channelId", channel}}}}});
    ASSERT_TRUE(one.until([&] { return one.statuses.size() > before; }));
    EXPECT_EQ(one.statuses.back()["level"], 2);
  }
  const std::size_t before = one.statuses.size();
  one.send({{"op", "getParameters"}, {"parameterNames", json::array()}, {"id", "all"}});
  one.send({{"op", "subscribeConnectionGraph"}});
  ASSERT_TRUE(one.until([&] { return one.statuses.size() >= before + 2; }));
  EXPECT_TRUE(one.parameters.empty() && one.graphs.empty());
}

TEST(Sharing, CommandsAreNeverSharedWhateverThePattern) {
  Running run(sharing({"/sandlot/*", "/*"}), {.pace = {1.0}}, with_tokens());
  run.go();
  Bridge one(run.url());
  EXPECT_EQ(one.claim({{"robot", "rover1"}, {"token", "secret of one"}})["op"], "sandlot.claimed");
  EXPECT_EQ(refused(one, subscribe("/sandlot/commands")).substr(0, 17), "there is no topic");
  one.send(subscribe("/tf"));
  EXPECT_EQ(one.next("publish")["topic"], "/tf") << "the author's choice";
  // Watched numbers of an administrator are his.
  Viewer admin(run.url(), "?token=secret%20of%20admin");
  const json watch = admin.call("/sandlot/watch", {{"values", {"rover2.pose.x"}}, {"rate_hz", 0}});
  EXPECT_EQ(refused(one, subscribe(watch["topic"])).substr(0, 17), "there is no topic");
}

TEST(Sharing, SpectatorsSeeTheSharedTopicsAloneWhereTheScenarioSaysSo) {
  ServerOptions options = with_tokens();
  options.transport.tokens.push_back({"", {.role = Role::spectator}});  // everybody may look on
  Running run(sharing({"/rover2/truth*"}, model::Sharing::Spectators::topics), {.pace = {1.0}}, options);
  run.go();
  Bridge spectator(run.url());
  const json topics = spectator.call("/rosapi/topics", json::object())["values"]["topics"];
  ASSERT_FALSE(topics.empty());
  std::string shared;
  for (const json& each : topics) {
    const auto name = each.get<std::string>();
    if (!is_time(name)) shared = name;
    EXPECT_TRUE(is_time(name) || name.rfind("/rover2/truth", 0) == 0) << name;
  }
  spectator.send(subscribe(shared));
  EXPECT_EQ(spectator.next("publish")["topic"], shared);
  EXPECT_EQ(refused(spectator, subscribe("/tf")).substr(0, 17), "there is no topic");
  for (const char* service : {"/get_entities", "/sandlot/console", "/sandlot/watch", "/rosapi/get_param"})
    EXPECT_EQ(spectator.call(service, {{"name", "x"}})["result"], false) << service;
  Viewer viewer(run.url());
  ASSERT_NE(viewer.channel(shared), 0u);
  viewer.listen(0.2);
  EXPECT_EQ(viewer.channels.count("/sandlot/world") + viewer.channels.count("/sandlot/poses"), 0u);
  EXPECT_TRUE(viewer.services.empty());
  // A token makes it more than that.
  EXPECT_EQ(spectator.claim({{"robot", "rover1"}, {"token", "secret of one"}})["op"], "sandlot.claimed");
  spectator.send(subscribe("/rover1/laser/ranges"));
  json message;
  do message = spectator.next("publish");
  while (message.is_object() && message["topic"] == shared);  // still on their way
  EXPECT_EQ(message["topic"], "/rover1/laser/ranges");
}

/// Names of robots are anybody's choice.
TEST(Sharing, ARobotCalledAsATopicOfTheServerOpensNothing) {
  const model::Sharing nothing;
  const Access tf{.role = Role::robot, .name = "tf", .robots = {"tf"}};
  const Access own{.role = Role::robot, .name = "sandlot", .robots = {"sandlot"}};
  EXPECT_FALSE(sees_topic(tf, nothing, "/tf"));
  EXPECT_TRUE(sees_topic(tf, nothing, "/tf/laser/ranges"));
  for (const std::string_view each : model::world_topics)
    EXPECT_EQ(sees_topic(own, nothing, each),
              each == "/clock" || each == "/sandlot/step_times" || each == "/sandlot/status")
        << each;
  EXPECT_FALSE(sees_topic(own, nothing, model::commands_topic));
}

/// The list that scenarios are held against is what there is.
TEST(Sharing, TheNamedTopicsOfTheWorldAreThoseOfTheServer) {
  Running run(arena("planar", 1, ""), {.paused = true});
  run.go();
  Viewer admin(run.url());
  ASSERT_NE(admin.channel("/rover1/laser/ranges"), 0u);
  std::size_t others = 0;
  for (const auto& [topic, channel] : admin.channels) others += topic.rfind("/rover1/", 0) != 0;
  for (const std::string_view each : model::world_topics)
    EXPECT_EQ(admin.channels.count(std::string(each)), 1u) << each;
  EXPECT_EQ(others, std::size(model::world_topics) + 1) << "and the commands";
}

}  // namespace
}  // namespace sandlot::server::test
