/// Clients by UDP: who has not shown that it receives gets no more than it sent, and nobody speaks for another.
#include "server/test_bridge.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

/// A socket with a port of its own.
class Datagrams {
 public:
  explicit Datagrams(const std::string& url)
      : port_(static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)))) {
    fd_ = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port_);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  ~Datagrams() { ::close(fd_); }
  Datagrams(const Datagrams&) = delete;

  void send_text(const std::string& text) {
    sent += text.size();
    (void)!::send(fd_, text.data(), text.size(), 0);
  }
  /// With the nonce, where there is one.
  void send(json message) {
    if (!nonce.empty()) message["nonce"] = nonce;
    send_text(message.dump());
  }
  std::string take_text(double timeout_s = patience_s) {
    pollfd p{.fd = fd_, .events = POLLIN, .revents = 0};
    if (::poll(&p, 1, static_cast<int>(timeout_s * 1000)) <= 0) return "";
    char bytes[1 << 16];
    const auto n = ::recv(fd_, bytes, sizeof bytes, 0);
    if (n <= 0) return "";
    received += static_cast<std::size_t>(n);
    return {bytes, static_cast<std::size_t>(n)};
  }
  json take(double timeout_s = patience_s) {
    const std::string text = take_text(timeout_s);
    return text.empty() ? json() : json::parse(text);
  }
  json next(const std::string& op, double timeout_s = patience_s) {
    while (true) {
      json message = take(timeout_s);
      if (message.is_null() || message["op"] == op) return message;
    }
  }
  static std::string hello(std::size_t size) {
    std::string text = R"({"op":"sandlot.hello","pad":""})";
    if (text.size() < size) text.insert(text.size() - 2, size - text.size(), '.');
    return text;
  }
  /// Shows that it receives.
  void come() {
    send_text(hello(100));
    const json challenge = next("sandlot.challenge");
    ASSERT_FALSE(challenge.is_null());
    nonce = challenge["nonce"];
    send({{"op", "sandlot.hello"}});
    EXPECT_EQ(next("sandlot.welcome")["op"], "sandlot.welcome");
  }
  json call(const std::string& service, const json& args, int fragment_size = 0) {
    json message{{"op", "call_service"}, {"service", service}, {"args", args}, {"id", "call"}};
    if (fragment_size > 0) message["fragment_size"] = fragment_size;
    send(message);
    return next("service_response");
  }

  std::string nonce;
  std::size_t sent = 0, received = 0;

 private:
  int fd_ = -1;
  std::uint16_t port_;
};

ServerOptions by_udp() {
  ServerOptions options;
  options.transport.udp = true;
  return options;
}

TEST(Udp, AClientDrivesARobotAndHearsItsTopics) {
  Running run(arena("planar", 1, ""), {.pace = {1.0}}, by_udp());
  run.go();
  Datagrams client(run.url());
  client.come();
  client.send({{"op", "sandlot.claim"}, {"robot", "rover1"}, {"id", "1"}});
  EXPECT_EQ(client.next("sandlot.claimed")["robots"], json::array({"rover1"}));
  client.send({{"op", "subscribe"}, {"topic", "/rover1/laser/ranges"}});
  const json scan = client.next("publish");
  EXPECT_EQ(scan["topic"], "/rover1/laser/ranges");
  EXPECT_EQ(scan["msg"]["ranges"].size(), 61u);
  Bridge admin(run.url());
  const auto x = [&] {
    return admin.call("/get_entity_state", {{"entity", "rover1"}})["values"]["state"]["pose"]["position"]["x"]
        .get<double>();
  };
  const double before = x();
  for (int i = 0; i < 100 && x() < before + 0.02; ++i) {
    client.send({{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", {{"linear", {{"x", 0.3}}}}}});
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_GE(x(), before + 0.02);
}

TEST(Udp, WithoutTheOptionNobodyListens) {
  Running run(arena("planar", 1, ""), {.paused = true});
  run.go();
  Datagrams client(run.url());
  client.send_text(Datagrams::hello(100));
  EXPECT_EQ(client.take_text(0.2), "");
}

TEST(Udp, WhoHasNotShownThatItReceivesGetsNoMoreThanItSent) {
  Running run(arena("planar", 1, ""), {.paused = true}, by_udp());
  run.go();
  Datagrams client(run.url());
  // Short of the answer's length: silence.
  for (const std::size_t size : {std::size_t{31}, std::size_t{60}}) client.send_text(Datagrams::hello(size));
  // All that a client could ask for, and what nobody could.
  for (const char* text :
       {R"({"op":"subscribe","topic":"/sandlot/world"})", R"({"op":"subscribe","topic":"/tf"})",
        R"({"op":"call_service","service":"/rosapi/topics_and_raw_types"})",
        R"({"op":"sandlot.claim","robot":"rover1"})",
        R"({"op":"fragment","id":"a","num":0,"total":2,"data":"x"})", R"({"op":"dance"})", "{", "", "garbage",
        "[]", R"({"op":"sandlot.hello","nonce":"00000000000000000000000000000000"})"})
    client.send_text(text);
  client.send_text("{\"op\":\"sandlot.hello\",\"pad\":\"" + std::string(8000, '.') + "\"}");
  EXPECT_EQ(client.take_text(0.3), "");
  EXPECT_EQ(run.server->counters().clients, 0u);
  client.sent = client.received = 0;
  for (int i = 0; i < 10; ++i) {
    client.send_text(Datagrams::hello(80));
    EXPECT_EQ(client.take()["op"], "sandlot.challenge");
  }
  EXPECT_LE(client.received, client.sent);
  EXPECT_GE(run.server->counters().refused, 10u);
  EXPECT_EQ(run.server->counters().clients, 0u) << "challenges cost no memory";
}

TEST(Udp, NobodySpeaksForAnotherAddress) {
  Running run(arena("planar", 1, ""), {.pace = {1.0}}, by_udp());
  run.go();
  Datagrams owner(run.url()), thief(run.url());
  owner.come();
  owner.send({{"op", "sandlot.claim"}, {"robot", "rover1"}});
  EXPECT_EQ(owner.next("sandlot.claimed")["op"], "sandlot.claimed");
  // Another port with the owner's nonce is nobody; and so is the owner's address without it, which is what a forged sender
  // can send.
  thief.send_text(json{{"op", "sandlot.hello"}, {"nonce", owner.nonce}}.dump());
  EXPECT_EQ(thief.take_text(0.2), "");
  const std::uint64_t refused = run.server->counters().refused;
  owner.send_text(R"({"op":"sandlot.release"})");
  owner.send_text(R"({"op":"sandlot.release","nonce":"00000000000000000000000000000000"})");
  EXPECT_TRUE(soon([&] { return run.server->counters().refused >= refused + 2; }));
  Bridge other(run.url());
  EXPECT_EQ(other.claim({{"robot", "rover1"}})["op"], "status") << "it is the owner's still";
  owner.send({{"op", "sandlot.hello"}});
  EXPECT_EQ(owner.next("sandlot.welcome")["role"], "robot");
}

TEST(Udp, TokensOpenWhatTheyDoByOtherWays) {
  ServerOptions options = by_udp();
  options.transport.tokens = {{"secret of admin", {.role = Role::admin}},
                              {"secret of one", {.role = Role::robot, .name = "rover1"}}};
  Running run(arena("planar", 2, ""), {.pace = {1.0}}, options);
  run.go();
  Datagrams client(run.url());
  client.come();
  client.send({{"op", "sandlot.hello"}});
  EXPECT_EQ(client.next("sandlot.welcome")["role"], "guest") << "without a token it sees the time";
  client.send({{"op", "publish"}, {"topic", "/rover1/drive"}, {"msg", json::object()}});
  EXPECT_EQ(client.next("status")["msg"],
            "nothing takes messages on '/rover1/drive'; a client commands what it has claimed");
  client.send({{"op", "sandlot.claim"}, {"robot", "rover1"}, {"token", "secret of two"}});
  EXPECT_EQ(client.next("status")["msg"], "this is not the token of 'rover1'");
  client.send({{"op", "sandlot.claim"}, {"robot", "rover1"}, {"token", "secret of one"}});
  EXPECT_EQ(client.next("sandlot.claimed")["robot"], "rover1");
  for (const char* topic : {"/tf", "/rover2/laser/ranges"}) {
    client.send({{"op", "subscribe"}, {"topic", topic}});
    EXPECT_EQ(client.next("status")["msg"].get<std::string>().substr(0, 17), "there is no topic");
  }
  // Guessing ends the session.
  Datagrams guesser(run.url());
  guesser.come();
  for (int i = 0; i < 10; ++i)
    guesser.send({{"op", "sandlot.claim"}, {"robot", "rover2"}, {"token", "guess"}});
  EXPECT_TRUE(soon([&] { return run.server->counters().clients == 1; }));
  // Its nonce is spent, and so is its address for a while.
  guesser.send({{"op", "sandlot.hello"}});
  guesser.send_text(Datagrams::hello(100));
  EXPECT_TRUE(guesser.next("sandlot.challenge", 0.2).is_null());
  EXPECT_EQ(run.server->counters().clients, 1u);
}

TEST(Udp, AFloodFromStrangersLeavesTheClientsAlone) {
  Running run(arena("planar", 1, ""), {.pace = {1.0}}, by_udp());
  run.go();
  Datagrams client(run.url()), flood(run.url());
  client.come();
  for (int i = 0; i < 20'000; ++i)
    flood.send_text(i % 2 == 0 ? Datagrams::hello(100) : R"({"op":"subscribe"})");
  json answer;
  // Datagrams may be lost in a full socket: a client asks again.
  for (int i = 0; i < 50 && answer.is_null(); ++i) {
    client.send({{"op", "call_service"}, {"service", "/rosapi/get_ros_version"}});
    answer = client.next("service_response", 0.2);
  }
  EXPECT_FALSE(answer.is_null());
  std::size_t challenges = 0;
  while (!flood.take_text(0.1).empty()) ++challenges;
  // 50 a second, for as long as it took.
  EXPECT_LE(challenges, 500u);
  EXPECT_LE(flood.received, flood.sent);
  EXPECT_EQ(run.server->counters().clients, 1u);
  // A client that says too much is sent away like others.
  EXPECT_TRUE(soon([&] {
    for (int i = 0; i < 200; ++i) client.send({{"op", "sandlot.hello"}});
    return run.server->counters().clients == 0;
  }));
}

TEST(Udp, WhatFitsNoDatagramComesInFragmentsOrNotAtAll) {
  Running run(arena("planar", 14, ""), {.paused = true}, by_udp());
  run.go();
  Datagrams client(run.url());
  client.come();
  const json failed = client.call("/rosapi/topics_and_raw_types", json::object());
  ASSERT_EQ(failed["result"], false) << "65 kB of schemas and more";
  EXPECT_NE(failed["values"].get<std::string>().find("fragment_size"), std::string::npos);
  client.send(
      {{"op", "call_service"}, {"service", "/rosapi/topics_and_raw_types"}, {"fragment_size", 10'000}});
  std::map<int, std::string> parts;
  std::size_t total = 1;
  while (parts.size() < total) {
    const json part = client.next("fragment");
    ASSERT_FALSE(part.is_null());
    total = part["total"];
    parts[part["num"]] = part["data"];
  }
  EXPECT_GT(total, 6u);
  std::string whole;
  for (const auto& [number, part] : parts) whole += part;
  EXPECT_EQ(json::parse(whole)["result"], true);
  client.send({{"op", "fragment"}, {"id", "a"}, {"num", 0}, {"total", 2}, {"data", "x"}});
  EXPECT_EQ(client.next("status")["msg"], "fragments do not come by datagrams, which have no order");
  client.send({{"op", "subscribe"}, {"topic", "/tf"}, {"compression", "cbor"}});
  EXPECT_EQ(client.next("status")["msg"], "cbor comes by WebSocket alone");
}

TEST(Udp, ASessionEndsAfterSilenceAndABeginnerMayComeAgain) {
  ServerOptions options = by_udp();
  options.transport.udp_silence_s = 0.2;
  Running run(arena("planar", 1, ""), {.pace = {1.0}}, options);
  run.go();
  Datagrams client(run.url());
  client.come();
  EXPECT_EQ(client.next("status")["msg"], "silent for too long");
  EXPECT_TRUE(soon([&] { return run.server->counters().clients == 0; }));
  client.nonce.clear();
  client.come();
  EXPECT_EQ(run.server->counters().clients, 1u);
  // The same port with a fresh nonce: a program that was begun again.
  const std::string before = std::exchange(client.nonce, "");
  client.come();
  EXPECT_EQ(run.server->counters().clients, 1u);
  run.end();
  EXPECT_EQ(client.next("status")["msg"], "the server ends");
}

TEST(Udp, OneAddressHasSixteenClientsAtMost) {
  Running run(arena("planar", 1, ""), {.paused = true}, by_udp());
  run.go();
  std::vector<std::unique_ptr<Datagrams>> clients;
  for (int i = 0; i < 16; ++i) {
    clients.push_back(std::make_unique<Datagrams>(run.url()));
    clients.back()->come();
  }
  Datagrams one_more(run.url());
  one_more.send_text(Datagrams::hello(100));
  one_more.nonce = one_more.next("sandlot.challenge")["nonce"];
  one_more.send({{"op", "sandlot.hello"}});
  EXPECT_EQ(one_more.take_text(0.2), "");
  EXPECT_EQ(run.server->counters().clients, 16u);
}

}  // namespace
}  // namespace sandlot::server::test
