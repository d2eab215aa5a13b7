#pragma once
/// A run with a server in a thread of its own, and a viewer that talks to it: for the tests of server.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <deque>
#include <thread>

#include <nlohmann/json.hpp>

#include "console/console.h"
#include "messages/cdr.h"
#include "messages/registry.h"
#include "server/server.h"
#include "sim/session/session.h"
#include "sim/test_world.h"
#include "wire/foxglove.h"

namespace sandlot::server::test {

using nlohmann::json;
using namespace std::chrono_literals;  // NOLINT(google-global-names-in-headers): a header of tests

/// What a test waits for comes at once, or the machine is very busy.
inline constexpr double patience_s = 20;

inline std::uint32_t u32_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t out = 0;
  if (at + 4 <= bytes.size()) std::memcpy(&out, bytes.data() + at, 4);
  return out;
}
inline std::uint64_t u64_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint64_t out = 0;
  if (at + 8 <= bytes.size()) std::memcpy(&out, bytes.data() + at, 8);
  return out;
}

class Viewer {
 public:
  explicit Viewer(const std::string& url, const std::string& query = "",
                  std::string_view subprotocol = "foxglove.sdk.v1") {
    std::string ws = "ws" + url.substr(4) + query;
    auto made = WebSocketClient::connect(ws, subprotocol, patience_s);
    EXPECT_TRUE(made) << made.error().text();
    if (made) socket_ = std::move(*made);
  }
  bool connected() const { return socket_ && socket_->open(); }

  struct Data {
    std::uint32_t subscription = 0;
    std::uint64_t ns = 0;
    std::vector<std::byte> bytes;
    std::string text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
    json parsed() const { return json::parse(text(), nullptr, false); }
  };

  void send(const json& message) { send_text(message.dump()); }
  void send_text(const std::string& text) {
    ASSERT_TRUE(socket_);
    EXPECT_TRUE(try_to_send(text));
  }
  bool try_to_send(const std::string& text) {
    return socket_ && static_cast<bool>(socket_->send(std::as_bytes(std::span(text)), true));
  }
  void send_bytes(std::span<const std::byte> bytes) {
    ASSERT_TRUE(socket_);
    const Status sent = socket_->send(bytes, false);
    EXPECT_TRUE(sent) << sent.error().text();
  }

  /// Takes one message and files it. False: nothing came in time.
  bool take(double timeout_s = patience_s) {
    if (!socket_) return false;
    auto got = socket_->receive(timeout_s);
    if (!got) return false;
    const std::span<const std::byte> bytes = got->bytes;
    if (got->text) {
      const json received = json::parse(reinterpret_cast<const char*>(bytes.data()),
                                        reinterpret_cast<const char*>(bytes.data()) + bytes.size());
      ++texts;
      file(received);
    } else if (bytes[0] == std::byte{1}) {
      data.push_back({u32_at(bytes, 1), u64_at(bytes, 5), {bytes.begin() + 13, bytes.end()}});
    } else if (bytes[0] == std::byte{2}) {
      time_ns = u64_at(bytes, 1);
      ++times;
    } else if (bytes[0] == std::byte{3}) {
      const std::size_t length = u32_at(bytes, 9);
      const std::string encoding(reinterpret_cast<const char*>(bytes.data()) + 13, length);
      responses[u32_at(bytes, 5)] = {encoding,
                                     {bytes.begin() + 13 + static_cast<std::ptrdiff_t>(length), bytes.end()}};
      ++answers[u32_at(bytes, 5)];
    } else if (bytes[0] == std::byte{4}) {
      assets[u32_at(bytes, 1)] = {bytes.begin(), bytes.end()};
    }
    return true;
  }
  /// Takes messages until `done`.
  template <class F>
  bool until(F&& done, double timeout_s = patience_s) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
    while (!done()) {
      const double left = std::chrono::duration<double>(end - std::chrono::steady_clock::now()).count();
      if (left <= 0 || !take(left)) return done();
    }
    return true;
  }
  /// Takes what comes for a while.
  void listen(double seconds) {
    until([] { return false; }, seconds);
  }

  /// The number of a channel, once it is advertised; 0: it never was.
  std::uint32_t channel(const std::string& topic) {
    until([&] { return channels.count(topic) > 0; });
    return channels.count(topic) ? channels[topic]["id"].get<std::uint32_t>() : 0;
  }
  /// @return the subscription
  std::uint32_t subscribe(const std::string& topic) {
    const std::uint32_t id = channel(topic);
    EXPECT_NE(id, 0u) << topic;
    const std::uint32_t subscription = ++last_subscription_;
    send({{"op", "subscribe"}, {"subscriptions", {{{"id", subscription}, {"channelId", id}}}}});
    return subscription;
  }
  /// The next message of a subscription (those before it are forgotten).
  std::optional<Data> next(std::uint32_t subscription, double timeout_s = patience_s) {
    std::optional<Data> out;
    until(
        [&] {
          while (!data.empty()) {
            Data first = std::move(data.front());
            data.pop_front();
            if (first.subscription != subscription) continue;
            out = std::move(first);
            return true;
          }
          return false;
        },
        timeout_s);
    return out;
  }
  template <class M>
  M read(const Data& message) {
    M out{};
    const Status status = read_cdr(message_info<M>(), message.bytes, &out);
    EXPECT_TRUE(status) << status.error().text();
    return out;
  }

  /// Calls a service and waits for its answer; null: it failed, see `failures`.
  json call(const std::string& service, const json& request) {
    const std::uint32_t id = start_call(service, request.dump());
    until([&] { return responses.count(id) > 0 || failures.count(id) > 0; });
    if (!responses.count(id)) return {};
    EXPECT_EQ(responses[id].first, "json");
    const auto& bytes = responses[id].second;
    return json::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  std::uint32_t start_call(const std::string& service, const std::string& request,
                           const std::string& encoding = "json") {
    until([&] { return !services.empty(); });
    const std::uint32_t id = ++last_call_;
    std::vector<std::byte> bytes{std::byte{2}};
    const auto put = [&](const void* from, std::size_t size) {
      const auto* const begin = static_cast<const std::byte*>(from);
      bytes.insert(bytes.end(), begin, begin + size);
    };
    const std::uint32_t number = services.count(service) ? services[service] : 9999;
    const auto length = static_cast<std::uint32_t>(encoding.size());
    put(&number, 4);
    put(&id, 4);
    put(&length, 4);
    put(encoding.data(), encoding.size());
    put(request.data(), request.size());
    send_bytes(bytes);
    return id;
  }
  json console(const std::string& line) { return call("/sandlot/console", {{"line", line}}); }
  void publish(std::uint32_t id, std::string_view payload) {
    std::vector<std::byte> bytes{std::byte{1}};
    const auto* const number = reinterpret_cast<const std::byte*>(&id);
    bytes.insert(bytes.end(), number, number + 4);
    const auto text = std::as_bytes(std::span(payload));
    bytes.insert(bytes.end(), text.begin(), text.end());
    send_bytes(bytes);
  }

  json info;
  std::map<std::string, json> channels;  ///< by topic
  std::map<std::string, std::uint32_t> services;
  std::deque<Data> data;
  std::vector<json> statuses, parameters, graphs;
  std::vector<std::uint32_t> unadvertised;
  std::map<std::uint32_t, std::pair<std::string, std::vector<std::byte>>> responses;
  std::map<std::uint32_t, int> answers;  ///< how many each call got
  std::map<std::uint32_t, std::string> failures;
  std::map<std::uint32_t, std::vector<std::byte>> assets;
  std::uint64_t time_ns = 0;
  int times = 0, texts = 0;

 private:
  void file(const json& received) {
    const std::string op = received.value("op", "");
    if (op == "serverInfo") info = received;
    if (op == "advertise")
      for (const json& each : received["channels"]) channels[each["topic"]] = each;
    if (op == "unadvertise")
      for (const json& each : received["channelIds"]) {
        unadvertised.push_back(each);
        std::erase_if(channels, [&](const auto& known) { return known.second["id"] == each; });
      }
    if (op == "unadvertiseServices")
      for (const json& each : received["serviceIds"])
        std::erase_if(services, [&](const auto& known) { return known.second == each; });
    if (op == "advertiseServices")
      for (const json& each : received["services"]) services[each["name"]] = each["id"];
    if (op == "status") statuses.push_back(received);
    if (op == "parameterValues") parameters.push_back(received);
    if (op == "connectionGraphUpdate") graphs.push_back(received);
    if (op == "serviceCallFailure") {
      failures[received["callId"]] = received["message"];
      ++answers[received["callId"]];
    }
  }
  std::unique_ptr<WebSocketClient> socket_;
  std::uint32_t last_subscription_ = 100, last_call_ = 0;
};

/// A session that runs in a thread of its own.
struct Running {
  explicit Running(model::Setup setup, Session::Options options = {}, ServerOptions server_options = {})
      : session(sandlot::test::build(std::move(setup)), std::move(options)), console(session, {}) {
    server_options.transport.port = 0;
    auto made = Server::start(server_options, session, console);
    EXPECT_TRUE(made) << made.error().text();
    server = std::move(*made);
  }
  ~Running() { end(); }
  void go() {
    thread = std::thread([this] {
      RunReport report;
      status = session.run(report);
    });
  }
  void end() {
    if (thread.joinable()) {
      session.quit();
      thread.join();
    }
    server->stop();
  }
  std::string url() const { return server->url(); }

  Session session;
  Console console;
  std::unique_ptr<Server> server;
  std::thread thread;
  Status status;
};

}  // namespace sandlot::server::test
