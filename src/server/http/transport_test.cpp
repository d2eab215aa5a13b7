/// HTTP and who is let in, over real sockets. WebSocket's own matters: websocket_test.cpp.
#include "server/http/transport.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "server/test_socket.h"

namespace sandlot::server {
namespace {

constexpr std::string_view page = "<p>here</p>";

HttpAnswer files(std::string_view target) {
  if (target == "/" || target == "/a b")
    return {.type = "text/html", .body = std::as_bytes(std::span(page)), .etag = "v1"};
  if (target == "/big") {
    const auto big = std::make_shared<const std::vector<std::byte>>(20'000'000, std::byte{7});
    return {.owned = big, .body = *big};
  }
  if (target == "/throws") throw std::runtime_error("as planned");
  return {.status = 404};
}

std::unique_ptr<Transport> start(TransportOptions options = {}, Handler handler = {.get = files}) {
  if (options.port == 8765) options.port = 0;
  if (options.subprotocols.empty()) options.subprotocols = {"one", "two"};
  auto result = Transport::start(options, std::move(handler));
  EXPECT_TRUE(result) << (result ? "" : result.error().text());
  return std::move(*result);
}

std::string get(std::string_view target, std::string_view more = "", std::string_view method = "GET") {
  return std::string(method) + " " + std::string(target) + " HTTP/1.1\r\nHost: localhost\r\n" +
         std::string(more) + "\r\n";
}

int status(const std::string& answer) {
  return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9, 3)) : 0;
}
std::string body(const std::string& answer) {
  const auto end = answer.find("\r\n\r\n");
  return end == answer.npos ? "" : answer.substr(end + 4);
}
bool says(const std::string& answer, std::string_view line) {
  return answer.find("\r\n" + std::string(line) + "\r\n") != answer.npos;
}

TEST(Transport, AnswersOneAfterTheOtherOnOneConnection) {
  const auto t = start();
  Socket s(t->port());
  const auto first = s.ask(get("/?token=x"));
  EXPECT_EQ(status(first), 200);
  EXPECT_EQ(body(first), page);
  EXPECT_TRUE(says(first, "Content-Type: text/html") && says(first, "ETag: \"v1\"") &&
              says(first, "Cache-Control: no-cache") && says(first, "X-Content-Type-Options: nosniff") &&
              says(first, "Referrer-Policy: no-referrer"))
      << first;
  EXPECT_NE(first.find("\r\nContent-Security-Policy: default-src 'self';"), first.npos);
  EXPECT_EQ(status(s.ask(get("/nowhere"))), 404);

  const auto head = s.ask(get("/", "", "HEAD"));
  EXPECT_EQ(status(head), 200);
  EXPECT_TRUE(says(head, "Content-Length: 11")) << head;
  EXPECT_EQ(body(head), "");
  EXPECT_EQ(s.seen, "");

  const auto unchanged = s.ask(get("/", "If-None-Match: \"v0\", \"v1\"\r\n"));
  EXPECT_EQ(status(unchanged), 304);
  EXPECT_EQ(body(unchanged), "");
  EXPECT_EQ(unchanged.find("Content-Length"), unchanged.npos);
  EXPECT_EQ(status(s.ask(get("/", "If-None-Match: \"v0\"\r\n"))), 200);
  EXPECT_EQ(body(s.ask(get("/a%20b"))), page);

  EXPECT_EQ(status(s.ask(get("/throws"))), 500);
  EXPECT_EQ(status(s.ask(get("/"))), 200);

  const auto last = s.ask(get("/", "Connection: close\r\n"));
  EXPECT_TRUE(says(last, "Connection: close"));
  EXPECT_EQ(s.rest(), "");
  EXPECT_TRUE(s.ended);
  Socket old(t->port());
  old.send("GET / HTTP/1.0\r\n\r\n");
  EXPECT_EQ(body(old.rest()), page);
  EXPECT_TRUE(old.ended);
  EXPECT_EQ(t->counters().refused, 0u);
}

TEST(Transport, AnswersPipelinedRequestsInOrder) {
  const auto t = start();
  Socket s(t->port());
  s.send(get("/") + get("/x") + get("/a%20b") + get("/y"));
  EXPECT_EQ(status(s.answer()), 200);
  EXPECT_EQ(status(s.answer()), 404);
  EXPECT_EQ(status(s.answer()), 200);
  EXPECT_EQ(status(s.answer()), 404);
}

TEST(Transport, ALongAnswerArrivesWhole) {
  const auto t = start();
  Socket s(t->port());
  const auto big = body(s.ask(get("/big")));
  EXPECT_EQ(big.size(), 20'000'000u);
  EXPECT_EQ(big.find_first_not_of('\7'), big.npos);
}

TEST(Transport, RefusesEachWrongRequestWithItsStatusAndEndsTheConnection) {
  const auto t = start();
  const std::pair<int, std::string> cases[] = {
      {400, "garbage\r\n\r\n"},
      {400, "GET / HTTP/1.1\r\n\r\n"},  // no Host
      {400, "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"},
      {400, "GET / HTTP/1.0\r\nHost: a b\r\n\r\n"},
      {400, "GET / HTTP/1.1\r\nHost: \r\n\r\n"},
      {400, "GET / HTTP/1.1\r\nHost: localhost\r\nno colon\r\n\r\n"},
      {400, "GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: x\r\n\r\n"},
      {400, get("/../etc/passwd")},
      {400, get("/%2e%2e/etc/passwd")},
      {400, get("/..%2fetc/passwd")},
      {400, get("/a\\..\\b")},
      {400, get("/%00")},
      {400, get("*")},
      {405, get("/", "", "POST")},
      {405, get("/", "Content-Length: 3\r\n", "POST") + "abc"},
      {405, get("/", "", "DELETE")},
      {405, get("/", "", "OPTIONS")},
      {413, get("/", "Content-Length: 3\r\n") + "abc"},
      {413, get("/", "Content-Length: 18446744073709551615\r\n")},
      {413, get("/", "Transfer-Encoding: chunked\r\n") + "3\r\nabc\r\n0\r\n\r\n"},
      {431, get("/", "X: " + std::string(20'000, 'x') + "\r\n")},
      {431, "GET /" + std::string(100'000, 'x')},
      {403, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"},
      {403, "GET / HTTP/1.1\r\nHost: evil.example:" + std::to_string(t->port()) + "\r\n\r\n"},
      {403, get("/", "Origin: http://evil.example\r\n")},
      {403, get("/", "Origin: null\r\n")},
      {403, get("/", "X-Forwarded-Host: evil.example\r\nOrigin: http://evil.example\r\n")},
  };
  std::uint64_t refused = 0;
  for (const auto& [expected, request] : cases) {
    Socket s(t->port());
    s.send(request);
    const auto answer = s.rest();
    EXPECT_EQ(status(answer), expected) << request.substr(0, 200) << answer;
    EXPECT_GT(body(answer).size(), 10u) << "no reason";
    EXPECT_TRUE(s.ended);
    EXPECT_TRUE(says(answer, "Connection: close"));
    EXPECT_EQ(says(answer, "Allow: GET, HEAD"), expected == 405);
    EXPECT_EQ(t->counters().refused, ++refused);
  }
  Socket s(t->port());
  EXPECT_EQ(status(s.ask(get("/"))), 200) << "the others go on";
}

TEST(Transport, AnotherSiteThatIsListedMayRead) {
  const auto t = start({.origins = {"https://lab.example"}});
  Socket s(t->port());
  const auto answer = s.ask(get("/", "Origin: https://lab.example\r\n"));
  EXPECT_EQ(status(answer), 200);
  EXPECT_TRUE(says(answer, "Access-Control-Allow-Origin: https://lab.example")) << answer;
  EXPECT_EQ(s.ask(get("/")).find("Access-Control"), std::string::npos);
  Socket by_its_name(t->port());
  EXPECT_EQ(status(by_its_name.ask("GET / HTTP/1.1\r\nHost: lab.example\r\n\r\n")), 200);
}

TEST(Transport, SlowRequestsAreEnded) {
  const auto t = start({.handshake_s = 0.5});
  Socket slow(t->port());
  slow.send("GET / HTTP/1.1\r\nHost: local");
  Socket drops(t->port());
  // A drop at a time does not buy more: the whole head has to come in time.
  std::string_view drop = "GET / HTTP/1.1\r\n";
  for (int i = 0; i < 500 && !drops.more(0.02); ++i)
    drops.send(i < 16 ? drop.substr(static_cast<std::size_t>(i), 1) : "x");
  EXPECT_EQ(status(drops.seen), 408);
  EXPECT_EQ(status(slow.rest()), 408);
  EXPECT_TRUE(slow.ended);
  Socket silent(t->port());
  EXPECT_EQ(silent.rest(), "");
  EXPECT_TRUE(silent.ended);
}

TEST(Transport, ConnectionsThatAskNothingMoreAreEnded) {
  const auto t = start({.idle_s = 0.2});
  Socket s(t->port());
  EXPECT_EQ(status(s.ask(get("/"))), 200);
  EXPECT_EQ(s.rest(), "");
  EXPECT_TRUE(s.ended);
}

TEST(Transport, TooManyConnectionsAreTurnedAwayAndTheOthersGoOn) {
  const auto t = start({.most_sockets = 256});
  std::vector<Socket> sockets;
  for (int i = 0; i < 300; ++i) sockets.emplace_back(t->port());
  ASSERT_TRUE(soon([&] { return t->counters().refused == 44; })) << t->counters().refused;
  // Accepted in the order in which they came: the first 256 are served.
  EXPECT_EQ(status(sockets[299].rest()), 503);
  EXPECT_EQ(status(sockets[256].rest()), 503);
  EXPECT_EQ(status(sockets[255].ask(get("/"))), 200);
  EXPECT_EQ(status(sockets[0].ask(get("/"))), 200);
  // These two have asked and have their answers: one of them makes room.
  Socket next(t->port());
  EXPECT_EQ(status(next.ask(get("/"))), 200);
  EXPECT_FALSE(sockets[0].more());
  EXPECT_TRUE(sockets[0].ended);
  sockets.clear();
  Socket after(t->port());
  EXPECT_EQ(status(after.ask(get("/"))), 200);
}

TEST(Transport, TakenPortsAreNamed) {
  const auto first = start();
  const std::vector<std::string> names{"one"};
  const auto again = Transport::start({.port = first->port(), .subprotocols = names}, {});
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().text().find(std::to_string(first->port())), std::string::npos)
      << again.error().text();
  EXPECT_NE(again.error().text().find("--port"), std::string::npos);
  const auto next = Transport::start({.port = first->port(), .next_free = true, .subprotocols = names}, {});
  ASSERT_TRUE(next);
  EXPECT_GT((*next)->port(), first->port());
  EXPECT_LE((*next)->port(), first->port() + 20);
}

TEST(Transport, APortIsFreeAtOnceWhenItsServerHasStopped) {
  auto t = start();
  const auto port = t->port();
  Socket s(port);
  EXPECT_EQ(status(s.ask(get("/"))), 200);
  t->stop();  // it ends the connection, so the port stays in TIME_WAIT on its side
  EXPECT_TRUE(Transport::start({.port = port}, {}));
}

TEST(Transport, AddressesAndUrls) {
  EXPECT_EQ(start()->url().substr(0, 17), "http://127.0.0.1:");
  const auto everywhere = start({.address = "0.0.0.0"});
  EXPECT_EQ(everywhere->url(), "http://127.0.0.1:" + std::to_string(everywhere->port()) + "/");
  Socket s(everywhere->port());  // elsewhere than on loopback any name may be this machine's
  EXPECT_EQ(status(s.ask("GET / HTTP/1.1\r\nHost: lab.example\r\n\r\n")), 200);
  EXPECT_EQ(start({.address = "localhost"})->url().substr(0, 17), "http://127.0.0.1:");
  for (const auto& address : {"no.such.machine.invalid", "256.1.1.1", "203.0.113.7", ""}) {
    const auto wrong = Transport::start({.address = address, .port = 0}, {});
    ASSERT_FALSE(wrong) << address;
    EXPECT_NE(wrong.error().text().find(address), std::string::npos) << wrong.error().text();
  }
}

TEST(Transport, SpeaksIpv6) {
  auto result = Transport::start({.address = "::1", .port = 0, .subprotocols = {"one"}}, {.get = files});
  if (!result) GTEST_SKIP() << "this machine has no IPv6: " << result.error().text();
  const auto url = (*result)->url();
  EXPECT_EQ(url, "http://[::1]:" + std::to_string((*result)->port()) + "/");
  const auto client = WebSocketClient::connect(url, "one", 5);
  EXPECT_TRUE(client) << client.error().text();
  const auto both = Transport::start({.address = "::", .port = 0}, {.get = files});
  ASSERT_TRUE(both);
  EXPECT_EQ((*both)->url(), "http://[::1]:" + std::to_string((*both)->port()) + "/");
  Socket v4((*both)->port());
  EXPECT_EQ(status(v4.ask(get("/"))), 200);
}

TEST(Transport, WebSocketsAreRefusedWithAReason) {
  const auto t = start({.tokens = {{"secret", {.role = Role::admin}}}, .most_clients = 2});
  const auto port = ":" + std::to_string(t->port());
  const std::tuple<int, std::string, std::string_view> cases[] = {
      {400, handshake("/", ""), "one, two"},
      {400, handshake("/", "three, ONE"), "one, two"},
      {401, handshake("/?token=wrong"), "token"},
      {401, handshake("/?token=secre"), "token"},
      {401, handshake("/", "one", "Authorization: Bearer wrong\r\n"), "token"},
      {400, handshake("/?role=king"), "spectator"},
      {400, handshake("/../x"), ".."},
      {403, handshake("/?token=secret", "one", "Origin: http://evil.example\r\n"), "other sites"},
      {403, handshake("/?token=secret", "one", "Origin: http://localhost" + port + "\r\n"), "other sites"},
      {403, handshake("/?token=secret", "one", "", "evil.example" + port), "evil.example"},
      {403,
       handshake("/?token=secret", "one", "Origin: http://evil.example" + port + "\r\n",
                 "evil.example" + port),
       "evil.example"},
      {400, handshake("/?token=secret") + frame(1, "early"), "handshake"},
  };
  std::uint64_t refused = 0;
  for (const auto& [expected, request, reason] : cases) {
    Socket s(t->port());
    s.send(request);
    const auto answer = s.rest();
    EXPECT_EQ(status(answer), expected) << request << answer;
    EXPECT_NE(body(answer).find(reason), std::string::npos) << request << answer;
    EXPECT_TRUE(s.ended);
    EXPECT_EQ(t->counters().refused, ++refused);
  }
  for (const std::string_view line :
       {"Sec-WebSocket-Version: 13\r\n", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"}) {
    auto request = handshake();
    request.erase(request.find(line), line.size());
    Socket s(t->port());
    s.send(request);
    const auto answer = s.rest();
    EXPECT_TRUE(status(answer) == 400 || status(answer) == 426) << answer;
    EXPECT_EQ(t->counters().refused, ++refused);
  }
  Socket a(t->port()), b(t->port()), c(t->port());
  EXPECT_EQ(status(a.ask(handshake())), 101);
  EXPECT_EQ(status(b.ask(handshake())), 101);
  EXPECT_EQ(status(c.ask(handshake())), 503);
  EXPECT_EQ(t->counters().clients, 2u);
  ::shutdown(a.fd, SHUT_RDWR);  // which makes room
  ASSERT_TRUE(soon([&] { return t->counters().clients == 1; }));
  Socket d(t->port());
  EXPECT_EQ(status(d.ask(handshake())), 101);
}

TEST(Transport, RolesAndSubprotocolsAreTold) {
  std::mutex mutex;
  std::string log;
  const Handler handler{.connected = [&](ClientId, const Access& access, std::string_view name) {
    const std::lock_guard lock(mutex);
    log += std::string(name_of(access.role)) + " " + std::string(name) + "; ";
  }};
  const auto t = start({.tokens = {{"s+/=", {.role = Role::admin}}}, .origins = {"https://lab.example"}},
                       handler);
  const auto port = ":" + std::to_string(t->port());
  std::vector<Socket> sockets;
  const auto connect = [&](const std::string& request) {
    sockets.emplace_back(t->port());
    const auto answer = sockets.back().ask(request);
    EXPECT_EQ(status(answer), 101) << answer;
    const auto name = answer.find("Sec-WebSocket-Protocol: ");
    EXPECT_NE(name, answer.npos);
    EXPECT_TRUE(soon([&] {
      const std::lock_guard lock(mutex);
      return log.ends_with(answer.substr(name + 24, 3) + "; ");
    }));
    const std::lock_guard lock(mutex);
    return std::exchange(log, "");
  };
  EXPECT_EQ(connect(handshake("/", "two, one")), "spectator one; ");
  EXPECT_EQ(connect(handshake("/?token=s%2B%2f%3D", "two")), "admin two; ");
  EXPECT_EQ(connect(handshake("/?token=s+/=", "zero,two", "Origin: https://lab.example\r\n")), "admin two; ");
  EXPECT_EQ(connect(handshake("/any?token=s+/=&role=spectator", "one")), "spectator one; ");
  EXPECT_EQ(
      connect(handshake("/", "one", "Authorization: Bearer s+/=\r\nOrigin: http://127.0.0.1" + port + "\r\n",
                        "127.0.0.1" + port)),
      "admin one; ");
  EXPECT_EQ(connect(handshake("/", "zero", "Sec-WebSocket-Protocol: one\r\n")),
            "spectator one; ");  // offered in two headers
}

}  // namespace
}  // namespace sandlot::server
