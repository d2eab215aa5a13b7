/// Floods, churn, slow readers and broken encodings beside a victim, which gets all its messages; limits of connections.
#include <gmock/gmock.h>

#include <atomic>

#include "server/test_bridge.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

std::uint16_t port_of(const Running& run) {
  return static_cast<std::uint16_t>(std::stoi(run.url().substr(run.url().rfind(':') + 1)));
}

/// Drives rover2 and takes its odometry in a thread of its own. Messages come with every sample: a gap between their stamps is a loss.
class Victim {
 public:
  explicit Victim(const Running& run) : bridge_(run.url()) {
    EXPECT_EQ(bridge_.claim({{"robot", "rover2"}})["op"], "sandlot.claimed");
    bridge_.send({{"op", "subscribe"}, {"topic", "/rover2/laser/ranges"}});
    thread_ = std::thread([this] {
      while (!end_) {
        const json message = bridge_.take(0.2);
        if (message.is_null()) continue;
        if (message["op"] == "status") ++refusals;
        if (message["op"] != "publish") continue;
        const json& stamp = message["msg"]["header"]["stamp"];
        stamps_ns.push_back(stamp["sec"].get<std::int64_t>() * 1'000'000'000 +
                            stamp["nanosec"].get<std::int64_t>());
        got_ = stamps_ns.size();
        bridge_.send({{"op", "publish"}, {"topic", "/rover2/drive"}, {"msg", {{"angular", {{"z", 0.1}}}}}});
      }
    });
  }
  ~Victim() { finish(); }
  void finish() {
    end_ = true;
    if (thread_.joinable()) thread_.join();
  }
  /// Its messages are all there, and go on coming: a slow machine takes its time for that.
  void expect_whole(std::size_t at_least) {
    EXPECT_TRUE(soon([&] { return got_ >= at_least; }, patience_s)) << got_;
    finish();
    for (std::size_t i = 2; i < stamps_ns.size(); ++i)
      ASSERT_EQ(stamps_ns[i] - stamps_ns[i - 1], stamps_ns[1] - stamps_ns[0]) << i;
    EXPECT_EQ(refusals, 0u);
  }
  std::vector<std::int64_t> stamps_ns;
  std::size_t refusals = 0;

 private:
  Bridge bridge_;
  std::atomic<bool> end_ = false;
  std::atomic<std::size_t> got_ = 0;
  std::thread thread_;
};

TEST(Floods, ChurnOfSubscriptionsHarmsNobody) {
  Running run(arena("planar", 2, ""), {.pace = {1.0}});
  run.go();
  Victim victim(run);
  Bridge churning(run.url());
  Viewer viewer(run.url());
  const std::uint32_t laser = viewer.channel("/rover1/laser/ranges"),
                      status = viewer.channel("/sandlot/status");
  const auto begin = std::chrono::steady_clock::now();
  const auto lasted = [&](double s) {
    return std::chrono::steady_clock::now() - begin > std::chrono::duration<double>(s);
  };
  const auto refused = [&] { return run.server->counters().refused; };
  while (!lasted(1.5) || (refused() <= 100 && !lasted(patience_s))) {
    for (int i = 0; i < 4; ++i) {
      churning.send({{"op", "subscribe"}, {"topic", "/rover1/laser/ranges"}, {"id", std::to_string(i)}});
      churning.send({{"op", "unsubscribe"}, {"topic", "/rover1/laser/ranges"}});
    }
    viewer.try_to_send(
        json({{"op", "subscribe"},
              {"subscriptions", {{{"id", 1}, {"channelId", laser}}, {{"id", 2}, {"channelId", status}}}}})
            .dump());
    viewer.try_to_send(R"({"op":"unsubscribe","subscriptionIds":[1,2]})");
    viewer.try_to_send(R"({"op":"subscribeConnectionGraph"})");
    viewer.listen(0.004);
    viewer.data.clear();
  }
  victim.expect_whole(10);
  EXPECT_GT(refused(), 100u) << "beyond the requests of a second";
}

/// What one asks for at once does not come to all who look on.
TEST(Floods, WhoSubscribesToTheStatusAgainAndAgainMakesNoMessagesForOthers) {
  Running run(arena("planar", 1, ""), {.paused = true});
  run.go();
  Viewer onlooker(run.url()), churning(run.url());
  const std::uint32_t subscription = onlooker.subscribe("/sandlot/status");
  ASSERT_TRUE(onlooker.next(subscription));
  onlooker.send({{"op", "subscribeConnectionGraph"}});
  ASSERT_TRUE(onlooker.until([&] { return !onlooker.graphs.empty(); }));
  onlooker.data.clear();
  const std::size_t graphs = onlooker.graphs.size();
  const std::uint32_t status = churning.channel("/sandlot/status");
  for (int i = 0; i < 100; ++i) {
    churning.send({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", status}}}}});
    churning.send({{"op", "unsubscribe"}, {"subscriptionIds", {1}}});
    churning.send({{"op", "subscribeConnectionGraph"}});
  }
  ASSERT_TRUE(churning.until([&] { return churning.graphs.size() >= 100; }));
  onlooker.listen(0.3);
  // Five a second come anyhow.
  EXPECT_LT(onlooker.data.size(), 60u);
  EXPECT_LE(onlooker.graphs.size(), graphs + 3);
}

TEST(Floods, ASlowReaderIsClosedAndTheOthersGetTheirMessages) {
  ServerOptions options;
  options.transport.queue_bytes = 256 << 10;
  Running run(arena("planar", 2, ""), {.pace = {1.0}}, options);
  run.go();
  Victim victim(run);
  Socket slow(port_of(run), 4096);
  for (const char* topic : {"/rover1/laser/ranges", "/clock", "/tf"})
    slow.send(json({{"op", "subscribe"}, {"topic", topic}}).dump());
  for (int i = 0; i < 300; ++i)
    slow.send(R"({"op":"call_service","service":"/rosapi/topics_and_raw_types","id":"x"})");
  ASSERT_TRUE(soon([&] { return run.server->counters().accepted == 2; }));
  EXPECT_TRUE(soon([&] { return run.server->counters().clients == 1; }, 10)) << "it was not closed";
  EXPECT_GT(run.server->counters().dropped, 0u);
  victim.expect_whole(10);
}

/// What one reads slowly takes memory: all together have a bound, and who holds least is not the one to go.
TEST(Floods, ManySlowReadersTogetherHoldABoundedNumberOfBytes) {
  ServerOptions options;
  options.transport.queue_bytes = 1 << 20;
  Running run(arena("planar", 2, ""), {.pace = {1.0}}, options);
  run.go();
  Victim victim(run);
  std::vector<Socket> slow;
  for (int i = 0; i < 30; ++i) {
    slow.emplace_back(port_of(run), 4096);
    slow.back().send("{\"op\":\"set_level\",\"level\":\"none\"}");
  }
  ASSERT_TRUE(soon([&] { return run.server->counters().accepted == 31; }));
  Bridge reader(run.url());
  const json whole = reader.call("/rosapi/topics_and_raw_types", json::object());
  // What each is sent is nine tenths of its queue of 1 MiB; what the kernel does not take of that is more than the 4 MiB of all.
  const std::size_t calls = (900 << 10) / (whole.dump().size() + 1);
  ASSERT_GE(calls, 5u);
  for (std::size_t i = 0; i < calls; ++i)
    for (Socket& each : slow)
      each.send(R"({"op":"call_service","service":"/rosapi/topics_and_raw_types","id":"call"})");
  EXPECT_TRUE(soon([&] { return run.server->counters().clients < 25; }, 15))
      << run.server->counters().clients;
  victim.expect_whole(10);
}

TEST(Floods, BrokenCborIsRefusedWithAReason) {
  Running run(arena("planar", 1, ""), {.paused = true});
  run.go();
  const auto made = WebSocketClient::connect("ws" + run.url().substr(4), "", patience_s);
  ASSERT_TRUE(made);
  WebSocketClient& client = **made;
  const auto refused = [&](const std::string& bytes) {
    EXPECT_TRUE(client.send(std::as_bytes(std::span(bytes)), false));
    while (true) {
      const auto got = client.receive(patience_s);
      if (!got) return std::string("nothing came");
      const json message = json::parse(reinterpret_cast<const char*>(got->bytes.data()),
                                       reinterpret_cast<const char*>(got->bytes.data()) + got->bytes.size());
      if (message["op"] == "status") return message["msg"].get<std::string>();
    }
  };
  using namespace std::string_literals;
  const std::string cases[] = {
      "\xbf"s,  // a map of indefinite length that never ends
      "\xbf\x62op\x7f\x63"
      "abc"s,                                     // a text of indefinite length within
      std::string(100'000, '\x9f'),               // lists of indefinite length, 10^5 deep
      std::string(100'000, '\x81'),               // of one element each
      std::string(100'000, '\xc1'),               // tags
      std::string(1000, '\xa1'),                  // maps as keys
      "\x9b\x7f\xff\xff\xff\xff\xff\xff\xff"s,    // a list of 2^63 elements
      "\xbb\xff\xff\xff\xff\xff\xff\xff\xff"s,    // a map of 2^64
      "\x5b\x7f\xff\xff\xff\xff\xff\xff\xff"s,    // as many bytes
      "\x7b\xff\xff\xff\xff\xff\xff\xff\xff"s,    // as many letters
      "\xa1\x62op\xd8\x56\x44\x01\x02\x03\x04"s,  // a typed array where a text belongs
      "\xa2\x62op\x61x\x62op\x61y"s,              // a key twice
      "\xa1\x01\x02"s,                            // a key that is no text
      "\xff"s,
      "\x1c"s,
      "\xfc"s,
      "\xa0garbage"s};
  for (const std::string& each : cases) {
    const std::uint64_t before = run.server->counters().refused;
    EXPECT_NE(refused(each), "nothing came") << testing::PrintToString(each.substr(0, 20));
    EXPECT_GT(run.server->counters().refused, before);
    std::this_thread::sleep_for(60ms);  // twenty a second are told
  }
  // The same without an end, as a whole message: a map of indefinite length is well-formed.
  const std::string well =
      "\xbf\x62op\x6c"
      "call_service\x67service\x70/rosapi/get_time\xff";
  EXPECT_TRUE(client.send(std::as_bytes(std::span(well)), false));
  const auto got = client.receive(patience_s);
  ASSERT_TRUE(got);
  EXPECT_NE(std::string(reinterpret_cast<const char*>(got->bytes.data()), got->bytes.size()).find("nanosec"),
            std::string::npos);
}

TEST(Floods, NothingIsDecompressed) {
  Running run(arena("planar", 1, ""), {.paused = true});
  run.go();
  Socket socket(port_of(run));
  const std::string answer = socket.ask(
      handshake("/", "", "Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits\r\n"));
  EXPECT_EQ(answer.substr(9, 3), "101") << answer;
  EXPECT_EQ(answer.find("permessage-deflate"), std::string::npos) << answer;
  // A frame that says it is compressed ends its client.
  socket.send(frame_head(1, 6, true, true, 4) + std::string("\xaa\x56\x2a\xa9\x02\x00", 6));
  EXPECT_EQ(socket.closing().code(), 1002);
  ::shutdown(socket.fd, SHUT_RDWR);
  EXPECT_TRUE(soon([&] { return run.server->counters().refused > 0; }));
}

TEST(Floods, FragmentsThatNeverEndHoldOneMessageAtMost) {
  Running run(arena("planar", 2, ""), {.pace = {1.0}});
  run.go();
  Victim victim(run);
  std::vector<std::unique_ptr<Bridge>> all;
  for (int i = 0; i < 10; ++i) all.push_back(std::make_unique<Bridge>(run.url()));
  const std::string data(50'000, 'x');
  for (int k = 0; k < 23; ++k)
    for (const auto& each : all)
      each->send({{"op", "fragment"}, {"id", "endless"}, {"num", k}, {"total", 10'000}, {"data", data}});
  // 1.15 MB each: above the 1 MiB of a message they are thrown away, or before, where a slow machine takes long for them.
  for (const auto& each : all)
    EXPECT_THAT(each->next("status")["msg"].get<std::string>(),
                testing::AnyOf("a fragment comes twice, or does not fit the others",
                               "fragments of 'endless' are thrown away"));
  EXPECT_GE(run.server->counters().refused, 10u);
  victim.expect_whole(8);
}

TEST(Floods, HugeMessagesOfManyClientsDoNotKeepTheVictimWaiting) {
  Running run(arena("planar", 2, ""), {.pace = {1.0}});
  run.go();
  Victim victim(run);
  std::string numbers = "[0";
  for (int i = 0; i < 150'000; ++i) numbers += ",0.125";
  const std::string huge = R"({"op":"publish","topic":"/rover1/drive","msg":{"linear":)" + numbers + "]}}";
  std::atomic<bool> end = false;
  std::vector<std::thread> flooding;
  for (int i = 0; i < 4; ++i)
    flooding.emplace_back([&] {
      Socket socket(port_of(run));
      while (!end) {
        // Not blocking: who is read late must not hold up the test's end.
        for (std::string_view left = huge; !left.empty() && !end;) {
          const auto n = ::send(socket.fd, left.data(), left.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
          if (n > 0) left.remove_prefix(static_cast<std::size_t>(n));
          else ::usleep(1000);
        }
      }
    });
  victim.expect_whole(10);  // while the flood goes on
  end = true;
  for (std::thread& each : flooding) each.join();
}

TEST(Floods, WhoTakesMuchTimeIsReadLaterAndLosesNothing) {
  std::atomic<int> heavy = 0, heavy_when_light_came = -1;
  TransportOptions options;
  options.port = 0;
  options.raw_json = true;
  options.work_share = 0.05;
  Handler handler;
  handler.message = [&](ClientId, std::span<const std::byte> bytes, bool) {
    if (bytes.size() < 10) {  // {"light"} and the like
      heavy_when_light_came = heavy.load();
      return;
    }
    ++heavy;
    const auto used = [] {
      timespec t{};
      ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
      return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    };
    for (const double begin = used(); used() < begin + 0.03;) {}
  };
  auto transport = Transport::start(options, std::move(handler));
  ASSERT_TRUE(transport);
  Socket one((*transport)->port()), two((*transport)->port());
  std::string many;
  for (int i = 0; i < 8; ++i) many += R"({"heavy":"message"})";
  one.send(many);
  EXPECT_TRUE(soon([&] { return heavy >= 4; }));
  two.send(R"({"a":1})");
  // 4 x 30 ms are more than the 100 ms that it may take at once; the other four are spread over 2.4 s.
  EXPECT_TRUE(soon([&] { return heavy_when_light_came >= 0; }));
  EXPECT_GE(heavy_when_light_came, 4);
  EXPECT_LT(heavy_when_light_came, 8);
  EXPECT_TRUE(soon([&] { return heavy == 8; }, 10)) << heavy;
  (*transport)->stop();
}

TEST(Floods, ConnectionsOfAnAddressAreLimitedAndWhoAsksNothingMakesRoom) {
  ServerOptions options;
  options.transport.most_from_loopback = 3;
  Running run(arena("planar", 1, ""), {.paused = true}, options);
  run.go();
  Bridge one(run.url());
  EXPECT_EQ(one.call("/rosapi/get_time", json::object())["result"], true);
  Socket silent(port_of(run)), half(port_of(run));
  half.send("GET / HT");
  ::usleep(50'000);
  Socket many(port_of(run));
  EXPECT_EQ(many.rest().substr(9, 3), "503");
  EXPECT_EQ(run.server->counters().refused, 1u);
  // After a second they are in the way of others.
  ::usleep(1'100'000);
  Bridge two(run.url());
  EXPECT_EQ(two.call("/rosapi/get_time", json::object())["result"], true);
  Bridge three(run.url());
  EXPECT_EQ(three.call("/rosapi/get_time", json::object())["result"], true);
  EXPECT_EQ(silent.rest(0.5), "");
  EXPECT_TRUE(silent.ended && (half.rest(0.5), half.ended));
  EXPECT_EQ(one.call("/rosapi/get_time", json::object())["result"], true) << "who talks stays";
}

TEST(Floods, GuestsMakeRoomForThoseWithTokens) {
  ServerOptions options;
  options.transport.tokens = {{"secret of one", {.role = Role::robot, .name = "rover1"}},
                              {"secret of two", {.role = Role::robot, .name = "rover2"}}};
  options.transport.most_clients = 3;
  Running run(arena("planar", 2, ""), {.pace = {1.0}}, options);
  run.go();
  Bridge one(run.url());
  EXPECT_EQ(one.claim({{"robot", "rover1"}, {"token", "secret of one"}})["op"], "sandlot.claimed");
  Socket guest(port_of(run)), other_guest(port_of(run));
  for (Socket* each : {&guest, &other_guest}) each->send("{");
  ASSERT_TRUE(soon([&] { return run.server->counters().clients == 3; }));
  Bridge early(run.url());
  early.send_text("{");
  EXPECT_TRUE(early.ended()) << "there is no room";
  ::usleep(2'100'000);
  Bridge two(run.url());
  EXPECT_EQ(two.claim({{"robot", "rover2"}, {"token", "secret of two"}})["op"], "sandlot.claimed");
  EXPECT_EQ(run.server->counters().clients, 3u);
  EXPECT_EQ(one.call("/rosapi/get_time", json::object())["result"], true) << "who has claimed stays";
}

}  // namespace
}  // namespace sandlot::server::test
