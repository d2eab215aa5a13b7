/// Hostile clients, which must not change a run or end it: many viewers, viewers that do not read, and
/// nonsense.
#include "server/test_viewer.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

model::Setup short_run() {
  model::Setup setup = arena("rigid", 2);
  setup.stop = Time::from_s(3);
  return setup;
}

std::uint64_t hash_without_server() {
  const auto simulation = sandlot::test::build(short_run());
  while (!simulation->stop_reason()) EXPECT_TRUE(simulation->tick());
  return simulation->state_hash();
}

/// Subscribes to all there is.
void look_at_everything(Viewer& viewer) {
  ASSERT_NE(viewer.channel("/rover1/laser/ranges"), 0u);
  json all = json::array();
  std::uint32_t id = 1;
  for (const auto& [topic, channel] : viewer.channels)
    all.push_back({{"id", id++}, {"channelId", channel["id"]}});
  viewer.send({{"op", "subscribe"}, {"subscriptions", all}});
  viewer.send({{"op", "subscribeParameterUpdates"}, {"parameterNames", json::array()}});
  viewer.send({{"op", "subscribeConnectionGraph"}});
  viewer.call("/sandlot/watch", {{"values", {"rover1.pose.x", "rover1/laser.ranges[3]"}}, {"rate_hz", 0}});
}

TEST(ServerRun, IsTheSameWithNoViewerWithOneWithFiveAndWithOneThatNeverReads) {
  const std::uint64_t expected = hash_without_server();
  for (const int viewers : {0, 1, 5}) {
    Running run(short_run(), {.paused = true, .stay = true});
    run.go();
    std::vector<std::unique_ptr<Viewer>> all;
    for (int i = 0; i < viewers; ++i)
      look_at_everything(*all.emplace_back(std::make_unique<Viewer>(run.url())));
    // The last one of five never takes anything from now on.
    std::vector<std::thread> readers;
    for (std::size_t i = 0; i + (viewers == 5 ? 1 : 0) < all.size(); ++i)
      readers.emplace_back([&viewer = *all[i]] {
        while (viewer.take(1)) viewer.data.clear();
      });
    run.session.play();
    while (run.session.report().state != Session::State::ended) std::this_thread::sleep_for(5ms);
    run.end();
    for (std::thread& reader : readers) reader.join();
    EXPECT_EQ(run.session.simulation().state_hash(), expected) << viewers << " viewers";
  }
}

TEST(ServerRun, NonsenseIsRefusedWithAReasonAndCounted) {
  Running run(arena("rigid", 1), {});
  run.go();
  Viewer viewer(run.url());
  ASSERT_NE(viewer.channel("/rover1/laser/ranges"), 0u);
  const char* texts[] = {"",
                         "{",
                         "[]",
                         R"({"op": "dance"})",
                         R"({"op": "subscribe"})",
                         R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 999999}]})",
                         R"({"op": "unsubscribe", "subscriptionIds": [77]})",
                         R"({"op": "setParameters", "parameters": [{"name": "nobody.nothing", "value": 1}]})",
                         R"({"op": "setParameters", "parameters": [{"name": "x"}]})",
                         R"({"op": "advertise", "channels": [{"id": 1, "topic": "/x", "encoding": "protobuf",
                             "schemaName": ""}]})"};
  std::size_t refused = 0;
  for (const char* text : texts) {
    const std::size_t before = viewer.statuses.size();
    viewer.send_text(text);
    ASSERT_TRUE(viewer.until([&] { return viewer.statuses.size() > before; })) << text;
    EXPECT_EQ(viewer.statuses.back()["level"], 2) << text;
    ++refused;
  }
  std::vector<std::byte> bytes;
  for (const int length : {1, 4, 13, 100}) {
    bytes.assign(static_cast<std::size_t>(length), std::byte{0xff});
    const std::size_t before = viewer.statuses.size();
    viewer.send_bytes(bytes);
    ASSERT_TRUE(viewer.until([&] { return viewer.statuses.size() > before; })) << length;
    ++refused;
  }
  // The same subscription twice, the same channel twice.
  const std::uint32_t channel = viewer.channels["/clock"]["id"];
  for (int i = 0; i < 3; ++i)
    viewer.send({{"op", "subscribe"}, {"subscriptions", {{{"id", 5 + i / 2}, {"channelId", channel}}}}});
  ASSERT_TRUE(viewer.until([&] { return viewer.statuses.size() >= refused + 2; }));
  EXPECT_GE(run.server->counters().refused, refused + 2);
  const auto state = run.session.report().tick;
  EXPECT_TRUE(viewer.console("list entities")["ok"]);
  EXPECT_GE(run.session.report().tick, state) << "it goes on";
}

TEST(ServerRun, EveryCallIsAnsweredOnce) {
  Running run(arena("rigid", 1), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  const std::uint32_t bad[] = {viewer.start_call("/no_such_service", "{}"),
                               viewer.start_call("/sandlot/console", "{"),
                               viewer.start_call("/sandlot/console", R"({"lime": "x"})"),
                               viewer.start_call("/sandlot/console", "{}", "protobuf"),
                               viewer.start_call("/get_entities", "abc", "cdr")};
  for (const std::uint32_t each : bad) {
    ASSERT_TRUE(viewer.until([&] { return viewer.answers[each] > 0; })) << each;
    EXPECT_FALSE(viewer.failures[each].empty()) << each;
  }
  // 300 at once: no more than 100 wait, the others are told so; all are answered, also when the run is over.
  std::vector<std::uint32_t> calls;
  for (int i = 0; i < 300; ++i)
    calls.push_back(viewer.start_call(i % 2 ? "/get_entities" : "/sandlot/console",
                                      i % 2 ? "{}" : R"({"line": "list entities"})"));
  run.session.quit();
  for (const std::uint32_t each : calls)
    ASSERT_TRUE(viewer.until([&] { return viewer.answers[each] > 0; })) << each;
  viewer.listen(0.2);
  for (const auto& [id, count] : viewer.answers) EXPECT_EQ(count, 1) << id;
}

TEST(ServerRun, AMillionSubscriptionsAreRefusedBeyondTheLimit) {
  Running run(arena("rigid", 1), {});
  run.go();
  {
    Viewer viewer(run.url());
    ASSERT_NE(viewer.channel("/rover1/laser/ranges"), 0u);
    std::string many = R"({"op":"subscribe","subscriptions":[)";
    for (int i = 0; i < 1'000'000; ++i) many += R"({"id":1,"channelId":1},)";
    many.back() = ']';
    viewer.try_to_send(many + "}");
    viewer.until([&] { return !viewer.connected(); }, 5);
    EXPECT_FALSE(viewer.connected()) << "24 MB are more than a text message may have";
  }
  Viewer viewer(run.url());
  ASSERT_NE(viewer.channel("/rover1/laser/ranges"), 0u);
  std::string many = R"({"op":"subscribe","subscriptions":[)";
  for (int i = 0; i < 10'500; ++i) many += R"({"id":)" + std::to_string(i) + R"(,"channelId":1},)";
  many.back() = ']';
  viewer.send_text(many + "}");
  ASSERT_TRUE(viewer.until([&] { return !viewer.statuses.empty(); }));
  EXPECT_TRUE(viewer.console("list entities")["ok"]) << "one channel was subscribed to, the run goes on";
}

TEST(ServerRun, TooManyRequestsAreRefused) {
  Running run(arena("rigid", 1), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  ASSERT_NE(viewer.channel("/rover1/laser/ranges"), 0u);
  // 500 in a second may be asked, and they are sent at once: of 1000 about half is refused, but 20 complaints are enough.
  for (int i = 0; i < 1000; ++i) viewer.send({{"op", "unsubscribeConnectionGraph"}});
  viewer.listen(0.5);
  EXPECT_GE(viewer.statuses.size(), 1u);
  EXPECT_LE(viewer.statuses.size(), 45u);
  EXPECT_GE(run.server->counters().refused, 200u);
}

/// Each name is looked up between two ticks: twenty thousand of them would be felt.
TEST(ServerRun, SoManyParametersMayBeAskedForByName) {
  Running run(arena("rigid", 1), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  std::vector<std::string> names(1000, "rover1/laser.noise.white");
  viewer.send({{"op", "getParameters"}, {"parameterNames", names}, {"id", "many"}});
  ASSERT_TRUE(viewer.until([&] { return !viewer.parameters.empty(); }));
  EXPECT_EQ(viewer.parameters[0]["parameters"].size(), 1000u);
  names.emplace_back("rover1/laser.rate");
  viewer.send({{"op", "getParameters"}, {"parameterNames", names}, {"id", "more"}});
  ASSERT_TRUE(viewer.until([&] { return !viewer.statuses.empty(); }));
  EXPECT_EQ(viewer.statuses[0]["id"], "more");
  EXPECT_EQ(viewer.parameters.size(), 1u);
}

TEST(ServerRun, AWatchThatNeverCameToBeTakesNoRoom) {
  Running run(arena("rigid", 1), {.paused = true});
  run.go();
  Viewer viewer(run.url());
  run.session.quit();
  const auto fails = [&](const char* service, const json& request) {
    const std::uint32_t id = viewer.start_call(service, request.dump());
    EXPECT_TRUE(viewer.until([&] { return viewer.answers[id] > 0; }));
    return viewer.failures.count(id) > 0 && !viewer.failures[id].empty();
  };
  int tries = 0;
  while (!fails("/sandlot/console", {{"line", "time"}}) && ++tries < 100) viewer.listen(0.02);
  const json watch = {{"values", std::vector<std::string>(200, "sim.time")}, {"rate_hz", 1}};
  EXPECT_TRUE(fails("/sandlot/watch", watch));
  EXPECT_TRUE(fails("/sandlot/watch", watch)) << "the first one took all room";
}

TEST(ServerRun, ViewersThatComeAndGoLeaveNothingBehind) {
  Running run(arena("planar", 1), {});
  run.go();
  for (int i = 0; i < 100; ++i) {
    Viewer viewer(run.url());
    if (i % 3 == 0) look_at_everything(viewer);
    if (i % 3 == 1) viewer.start_call("/sandlot/watch", R"({"values": ["sim.time"], "rate_hz": 0})");
  }
  Viewer last(run.url());
  const std::uint32_t status = last.subscribe("/sandlot/status");
  json told;
  const bool alone = last.until([&] {
    const auto message = last.next(status);
    if (message) told = message->parsed();
    return message && told["viewers"] == 1;
  });
  EXPECT_TRUE(alone) << told;
  // Nobody watches any more: all numbers may be asked for again.
  for (int i = 0; i < 10; ++i) {
    Viewer viewer(run.url());
    const json answer = viewer.call("/sandlot/watch",
                                    {{"values", std::vector<std::string>(200, "sim.time")}, {"rate_hz", 1}});
    EXPECT_EQ(answer["ok"], true) << answer;
  }
}

TEST(ServerRun, EndsWhileViewersLookAndStartsWithoutARun) {
  for (int i = 0; i < 5; ++i) {
    Running run(arena("planar", 1), {});
    Viewer early(run.url());  // before the run goes
    run.go();
    look_at_everything(early);
  }
}

}  // namespace
}  // namespace sandlot::server::test
