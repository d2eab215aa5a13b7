/// The client library for C++ against a server of the test's own: every line that goes over the wire is ours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <thread>

#include "base/test_folder.h"
#include "sandlot_client/client.h"

namespace sandlot::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Answers one client, line by line, until it goes or the script closes.
class Server {
 public:
  /// Returns what to send; "close" closes.
  using Script = std::function<std::vector<std::string>(const Json& line)>;

  explicit Server(Script script, const std::string& unix_path = "") : script_(std::move(script)) {
    if (unix_path.empty()) {
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      socklen_t size = sizeof address;
      listener_ = ::socket(AF_INET, SOCK_STREAM, 0);
      EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
      EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
      options.url = "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    } else {
      sockaddr_un address{};
      address.sun_family = AF_UNIX;
      unix_path.copy(address.sun_path, sizeof address.sun_path - 1);
      listener_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
      EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
      options.url = "unix:" + unix_path;
    }
    EXPECT_EQ(::listen(listener_, 1), 0);
    thread_ = std::thread([this] { serve(); });
  }
  ~Server() {
    ::shutdown(listener_, SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
    ::close(listener_);
  }
  /// What the client sent. @pre it has gone
  const std::vector<Json>& lines() {
    if (thread_.joinable()) thread_.join();
    return lines_;
  }

  Options options;

 private:
  void serve() {
    const int client = ::accept(listener_, nullptr, nullptr);
    std::string rest;
    char bytes[4096];
    for (ssize_t n; client >= 0 && (n = ::recv(client, bytes, sizeof bytes, 0)) > 0;) {
      rest.append(bytes, static_cast<std::size_t>(n));
      for (std::size_t end; (end = rest.find('\n')) != std::string::npos; rest.erase(0, end + 1)) {
        lines_.push_back(Json::parse(rest.substr(0, end)));
        for (const std::string& each : script_(lines_.back())) {
          if (each == "close") return void(::close(client));
          // In two pieces: a line need not come whole.
          const std::string line = each + "\n";
          const std::size_t half = line.size() / 2;
          ::send(client, line.data(), half, MSG_NOSIGNAL);
          ::send(client, line.data() + half, line.size() - half, MSG_NOSIGNAL);
        }
      }
    }
    if (client >= 0) ::close(client);
  }

  Script script_;
  std::vector<Json> lines_;
  int listener_ = -1;
  std::thread thread_;
};

std::string response(const Json& call, const Json& values, bool result = true) {
  return Json{{"op", "service_response"}, {"id", call["id"]}, {"values", values}, {"result", result}}.dump();
}
std::string status(const std::string& text, const Json& id = nullptr) {
  Json out{{"op", "status"}, {"level", "error"}, {"msg", text}};
  if (!id.is_null()) out["id"] = id;
  return out.dump();
}
std::string published(const std::string& topic, const Json& message) {
  return Json{{"op", "publish"}, {"topic", topic}, {"msg", message}}.dump();
}
std::string tick(int number) {
  return R"({"op":"sandlot.tick","program":"rover/controller","step":)" + std::to_string(number) +
         R"(,"time":{"sec":3000000,"nanosec":600000000},"random":"18446744073709551557"})";
}

/// A run with one rover: ends after three steps.
std::vector<std::string> run_of_three_steps(const Json& line) {
  if (line["op"] == "call_service")
    return {response(line, {{"topics", {"/clock", "/rover/laser/ranges", "/rover/laserwheel/x"}},
                            {"types", {"a", "b", "c"}}})};
  if (line["op"] == "sandlot.claim") {
    Json claimed{{"op", "sandlot.claimed"}, {"id", line["id"]}, {"programs", Json::array()}};
    if (line["mode"] == "free") return {claimed.dump()};
    claimed["programs"] = {{{"name", "rover/controller"}, {"control_period_s", 0.05}}};
    return {claimed.dump(), published("/rover/laser/ranges", {{"ranges", {1.5, nullptr}}}), tick(0)};
  }
  if (line["op"] == "sandlot.done" && line["step"] == 2) return {"close"};
  if (line["op"] == "sandlot.done") return {tick(line["step"].get<int>() + 1)};
  return {};
}

TEST(CppClient, EndsAStepWhenItAsksForTheNext) {
  Server server(run_of_three_steps);
  {
    Options options = server.options;
    options.lockstep = true;
    options.deadline_s = 0.25;
    options.token = "sesame-one";
    Robot rover("rover", options);
    Reading& laser = rover.subscribe("laser");
    EXPECT_EQ(laser.topic, "/rover/laser/ranges");
    EXPECT_TRUE(laser.message.is_null());
    EXPECT_FALSE(rover.period_s());
    int steps = 0;
    while (const auto step = rover.next_step()) {
      EXPECT_EQ(step->number, static_cast<std::uint64_t>(steps));
      EXPECT_EQ(step->program, "rover/controller");
      EXPECT_EQ(step->time_ns, 3'000'000'600'000'000);
      EXPECT_EQ(step->time_s(), 3000000.6);
      EXPECT_EQ(step->random, 18446744073709551557u);
      EXPECT_EQ(rover.period_s(), 0.05);
      EXPECT_EQ(laser.fresh(), steps == 0);
      EXPECT_EQ(laser.message["ranges"], (Json{1.5, nullptr}));
      rover.command("drive", {{"linear", {{"x", 0.25 * steps}}}});
      ++steps;
    }
    EXPECT_EQ(steps, 3);
    EXPECT_FALSE(rover.next_step()) << "the run has ended";
  }
  std::vector<std::string> sent;
  for (const Json& line : server.lines())
    sent.push_back(line["op"].get<std::string>() +
                   (line.contains("mode") ? " " + line["mode"].get<std::string>() : "") +
                   (line.contains("step") ? " " + line["step"].dump() : "") +
                   (line["op"] == "publish" ? " " + line["msg"].dump() : ""));
  EXPECT_THAT(sent, ElementsAre("sandlot.claim free", "call_service", "subscribe", "sandlot.claim lockstep",
                                R"(publish {"linear":{"x":0.0}})", "sandlot.done 0",
                                R"(publish {"linear":{"x":0.25}})", "sandlot.done 1",
                                R"(publish {"linear":{"x":0.5}})", "sandlot.done 2"));
  EXPECT_EQ(server.lines()[3]["token"], "sesame-one");
  EXPECT_EQ(server.lines()[3]["deadline_ms"], 250);
  EXPECT_EQ(server.lines()[4]["topic"], "/rover/drive");
}

TEST(CppClient, ATeamNamesItsRobots) {
  Server server(run_of_three_steps);
  {
    Team team("red", server.options);
    EXPECT_EQ(team.subscribe("rover", "laser/ranges").topic, "/rover/laser/ranges");
    EXPECT_THROW(team.subscribe("rover", "las"), Refused);
    EXPECT_THROW(team.next_step(), Refused) << "it is free";
    team.command("rover", "drive", Json::object());
  }
  EXPECT_EQ(server.lines()[0]["team"], "red");
  EXPECT_EQ(server.lines().back()["topic"], "/rover/drive");
}

TEST(CppClient, NumbersComeBackAsTheyWent) {
  Server server([](const Json& line) {
    return line["op"] == "publish" ? std::vector<std::string>{line.dump()} : std::vector<std::string>();
  });
  const std::vector<double> numbers{0.1 + 0.2, -0.0, 5e-324, 1.7976931348623157e308, 1.0 / 3, 2.5};
  std::vector<double> heard;
  Connection connection(server.options);
  Reading& echo = connection.subscribe_topic(
      "/echo", [&](const Json& message) { heard = message["data"].get<std::vector<double>>(); });
  connection.publish("/echo", {{"data", numbers}, {"text", "\xff is no text, \u00e4 is"}});
  while (echo.count == 0) ASSERT_TRUE(connection.poll(10));
  ASSERT_EQ(heard.size(), numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(heard[i]), std::bit_cast<std::uint64_t>(numbers[i])) << numbers[i];
  EXPECT_EQ(echo.message["text"], "\ufffd is no text, \u00e4 is");
  connection.publish("/echo", {{"data", {std::numeric_limits<double>::infinity()}}, {"text", ""}});
  connection.subscribe_topic("/other");
  EXPECT_THROW(
      {
        while (echo.count == 1) connection.poll(10);
      },
      Json::exception)
      << "what is not finite is null, which is no double";
}

TEST(CppClient, ALongMessageComesWhole) {
  const std::string text(3'000'000, 'x');
  Server server([&](const Json&) { return std::vector{published("/long", {{"data", text}})}; });
  Connection connection(server.options);
  const Reading& reading = connection.subscribe_topic("/long");
  while (reading.count == 0) ASSERT_TRUE(connection.poll(10));
  EXPECT_EQ(reading.message["data"], text);
}

TEST(CppClient, RefusalsCarryTheServersReason) {
  Server server([](const Json& line) -> std::vector<std::string> {
    if (line["op"] == "sandlot.claim") return {status("this is not the token of 'rover'", line["id"])};
    return {};
  });
  try {
    Robot rover("rover", server.options);
    ADD_FAILURE() << "it was refused";
  } catch (const Refused& refused) { EXPECT_STREQ(refused.what(), "this is not the token of 'rover'"); }

  Server other([](const Json& line) -> std::vector<std::string> {
    if (line["op"] != "call_service") return {status("nobody asked")};
    return {response(line, line["service"] == "/yes" ? Json(line["args"]) : Json("a spectator may not"),
                     line["service"] == "/yes")};
  });
  Connection connection(other.options);
  std::vector<std::string> told;
  connection.on_status = [&](const Json& each) { told.push_back(each["msg"]); };
  EXPECT_EQ(connection.call("/yes", {{"a", 1}}), (Json{{"a", 1}}));
  try {
    connection.call("/no");
    ADD_FAILURE() << "it was refused";
  } catch (const Refused& refused) { EXPECT_STREQ(refused.what(), "a spectator may not"); }
  connection.publish("/x", {});
  while (told.empty()) ASSERT_TRUE(connection.poll(10));
  EXPECT_THAT(told, ElementsAre("nobody asked"));
}

TEST(CppClient, AnEndedConnectionIsNoticed) {
  Server server([](const Json& line) -> std::vector<std::string> {
    if (line["service"] == "/slow") return {};
    return {status("too many messages"), "close"};
  });
  Connection connection(server.options);
  connection.on_status = [](const Json&) {};
  EXPECT_THROW(connection.call("/slow", {}, 0.05), TimedOut);
  try {
    connection.call("/any");
    ADD_FAILURE() << "it was closed";
  } catch (const Disconnected& gone) {
    EXPECT_STREQ(gone.what(), "the server has closed the connection: too many messages");
  }
  EXPECT_THROW(connection.publish("/x", {}), Disconnected);
  EXPECT_THROW(connection.poll(1), Disconnected);
}

TEST(CppClient, AddressesThatLeadNowhere) {
  const auto why = [](const std::string& url) -> std::string {
    Options options;
    options.url = url;
    options.timeout_s = 0.1;
    try {
      Connection connection(options);
      return "connected";
    } catch (const Disconnected& error) { return error.what(); }
  };
  EXPECT_THAT(why("http://127.0.0.1:1"), HasSubstr("is not an address: tcp://HOST:PORT or unix:PATH"));
  EXPECT_THAT(why("tcp://127.0.0.1"), HasSubstr("is not an address"));
  EXPECT_THAT(why("tcp://127.0.0.1:1"), HasSubstr("nobody answers at tcp://127.0.0.1:1"));
  EXPECT_THAT(why("unix:/nowhere/at/all"), HasSubstr("nobody answers"));
  EXPECT_THAT(why("unix:" + std::string(200, 'x')), HasSubstr("too long"));
}

TEST(CppClient, ReachesARunByAUnixSocket) {
  const test::TestFolder folder;
  Server server(run_of_three_steps, folder.file("socket"));
  Robot rover("rover", server.options);
  EXPECT_EQ(rover.topics().size(), 3u);
}

TEST(CppClient, BytesAreBase64) {
  // The examples of RFC 4648, section 10.
  const std::pair<const char*, const char*> known[] = {
      {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : known) {
    EXPECT_EQ(to_base64(bytes), text);
    EXPECT_EQ(from_base64(text), bytes);
  }
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  EXPECT_EQ(data_of(packet(all)), all);
  EXPECT_EQ(data_of(Json{{"data", {104, 105}}}), "hi");
  EXPECT_THROW(from_base64("no base64!"), Refused);
}

}  // namespace
}  // namespace sandlot::client
