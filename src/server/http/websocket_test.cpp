/// WebSocket connections and their ends: raw frames against the transport, and our own client.
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "server/http/transport.h"
#include "server/test_socket.h"

namespace sandlot::server {
namespace {

Payload payload(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
}

/// A transport that notes what happens and sends "echo " and what it was told back, as the same kind of message.
struct Echo {
  std::mutex mutex;
  std::vector<ClientId> came, gone;
  std::vector<std::string> heard;
  std::unique_ptr<Transport> transport;

  explicit Echo(TransportOptions options = {}) {
    options.port = 0;
    options.subprotocols = {"one"};
    Handler handler;
    handler.connected = [this](ClientId id, const Access&, std::string_view) {
      const std::lock_guard lock(mutex);
      came.push_back(id);
    };
    handler.disconnected = [this](ClientId id) {
      const std::lock_guard lock(mutex);
      gone.push_back(id);
    };
    handler.message = [this](ClientId id, std::span<const std::byte> bytes, bool text) {
      const std::string message(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      if (message == "throw") throw std::runtime_error("as planned");
      {
        const std::lock_guard lock(mutex);
        heard.push_back(message.substr(0, 20));
      }
      transport->send(id, std::as_bytes(std::span(std::string_view("echo "))), payload(message), text, false);
    };
    auto result = Transport::start(options, handler);
    EXPECT_TRUE(result);
    transport = std::move(*result);
  }
  ~Echo() { transport->stop(); }

  std::size_t count(std::vector<ClientId> Echo::*which) {
    const std::lock_guard lock(mutex);
    return (this->*which).size();
  }
  ClientId last() {
    const std::lock_guard lock(mutex);
    return came.back();
  }
  /// A raw client whose handshake is done. @param receive_bytes  see Socket
  Socket connect(std::string_view target = "/", int receive_bytes = 0) {
    const auto before = count(&Echo::came);
    Socket s(transport->port(), receive_bytes);
    EXPECT_TRUE(s.ask(handshake(target)).starts_with("HTTP/1.1 101"));
    EXPECT_TRUE(soon([&] { return count(&Echo::came) > before; }));
    return s;
  }
  std::unique_ptr<WebSocketClient> client(std::string_view query = "") {
    const auto before = count(&Echo::came);
    auto result = WebSocketClient::connect("ws" + transport->url().substr(4) + std::string(query), "one", 5);
    EXPECT_TRUE(result) << result.error().text();
    EXPECT_TRUE(soon([&] { return count(&Echo::came) > before; }));
    return std::move(*result);
  }
  void expect_alive() {
    auto s = connect();
    s.send(frame(1, "still there?"));
    EXPECT_EQ(s.frame().payload, "echo still there?");
  }
};

std::string words_of(const Result<WebSocketClient::Message>& m) {
  return m ? std::string(reinterpret_cast<const char*>(m->bytes.data()), m->bytes.size()) : m.error().text();
}

TEST(WebSocket, EchoesWholeAndFragmentedMessagesOfBothKinds) {
  Echo echo;
  auto s = echo.connect();
  s.send(frame(1, "héllo"));
  auto f = s.frame();
  EXPECT_EQ(f.opcode, 1);
  EXPECT_TRUE(f.fin);
  EXPECT_EQ(f.payload, "echo héllo");
  s.send(frame(2, std::string_view("\0\xff", 2)) + frame(2, ""));
  f = s.frame();
  EXPECT_EQ(f.opcode, 2);
  EXPECT_EQ(f.payload, std::string_view("echo \0\xff", 7));
  EXPECT_EQ(s.frame().payload, "echo ");
  // In three parts, one of them empty, a letter torn apart, a ping between.
  s.send(frame(1, "h\xc3", false) + frame(0, "", false) + frame(9, "p") + frame(0, "\xa9!"));
  f = s.frame();
  EXPECT_EQ(f.opcode, 10);
  EXPECT_EQ(f.payload, "p");
  EXPECT_EQ(s.frame().payload, "echo hé!");
  // Byte by byte.
  for (const char c : frame(1, "slow")) s.send(std::string_view(&c, 1));
  EXPECT_EQ(s.frame().payload, "echo slow");
  EXPECT_EQ(echo.transport->counters().refused, 0u);
  // RFC 6455, 5.5.1: the good-bye is answered with the same code.
  s.send(frame(8, "\x03\xe8 bye"));
  EXPECT_EQ(s.closing().code(), 1000);
  EXPECT_EQ(s.rest(), "");
  EXPECT_TRUE(s.ended);
  EXPECT_TRUE(soon([&] { return echo.count(&Echo::gone) == 1; }));
  EXPECT_EQ(echo.transport->counters().refused, 0u);
}

TEST(WebSocket, MalformedFramesEndTheirClientWithTheRightCode) {
  const std::tuple<const char*, std::string, int> cases[] = {
      {"unmasked", frame_head(1, 2, true, false) + "hi", 1002},
      {"reserved bit 1 without compression", frame_head(1, 2, true, true, 4) + "hi", 1002},
      {"reserved bit 3", frame_head(2, 2, true, true, 1) + "hi", 1002},
      {"opcode 3", frame(3, "hi"), 1002},
      {"opcode 11", frame(11, "hi"), 1002},
      {"fragmented ping", frame(9, "hi", false), 1002},
      {"long ping", frame(9, std::string(126, 'x')), 1002},
      {"continuation of nothing", frame(0, "hi"), 1002},
      {"a message in a message", frame(1, "a", false) + frame(1, "b"), 1002},
      {"length not in its shortest form", std::string("\x81\xfe\0\2\0\0\0\0hi", 10), 1002},
      {"length with its highest bit", frame_head(2, 0x8000000000000000u), 1009},
      {"no UTF-8", frame(1, "a\xff"), 1007},
      {"overlong UTF-8", frame(1, "\xc0\xaf"), 1007},
      {"half a letter", frame(1, "\xe2\x82"), 1007},
      {"a surrogate", frame(1, "\xed\xa0\x80"), 1007},
      {"close with one byte", frame(8, "x"), 1002},
      {"close with code 1005", frame(8, "\x03\xed"), 1002},
      {"close with bad UTF-8", frame(8, "\x03\xe8\xff"), 1002},
      {"giant binary announced", frame_head(2, (16u << 20) + 1), 1009},
      {"very giant binary announced", frame_head(2, 0x7fffffffffffffffu), 1009},
      {"giant text", frame(1, std::string((1u << 20) + 1, 'x')), 1009},
  };
  Echo echo;
  std::uint64_t refused = 0;
  for (const auto& [what, bytes, code] : cases) {
    auto s = echo.connect();
    s.send(bytes);
    const auto f = s.closing();
    EXPECT_EQ(f.code(), code) << what;
    s.send(frame(8, ""));  // answers the good-bye: a client that does not is ended a little later
    s.rest();
    EXPECT_TRUE(s.ended) << what;
    ++refused;
    EXPECT_TRUE(soon([&] { return echo.transport->counters().refused == refused; })) << what;
  }
  EXPECT_TRUE(echo.heard.empty());
  echo.expect_alive();
  EXPECT_TRUE(soon([&] { return echo.transport->counters().clients == 0; }));
  EXPECT_EQ(echo.count(&Echo::gone), std::size(cases) + 1);
}

TEST(WebSocket, LimitsOfMessages) {
  Echo echo({.tokens = {{"t", {.role = Role::admin}}}, .queue_bytes = 40u << 20});
  const auto admin = echo.client("?token=t");
  const auto all = [&](std::size_t size, bool text) {
    EXPECT_TRUE(admin->send(std::vector<std::byte>(size, std::byte{'x'}), text));
    const auto back = admin->receive(10);
    return back && back->text == text ? back->bytes.size() : 0;
  };
  EXPECT_EQ(all(1 << 20, true), (1u << 20) + 5);
  EXPECT_EQ(all(16 << 20, false), (16u << 20) + 5);
  // Spectators have nothing long to say.
  auto spectator = echo.connect();
  spectator.send(frame(2, std::string(1 << 20, 'x')));
  EXPECT_EQ(spectator.frame().payload.size(), (1u << 20));  // a fragment
  EXPECT_EQ(spectator.frame().payload.size(), 5u);
  spectator.send(frame_head(2, (1 << 20) + 1));
  EXPECT_EQ(spectator.closing().code(), 1009);
}

TEST(WebSocket, AFloodIsEndedAndABurstIsNot) {
  // A slow machine reads fewer than 2000 a second: a flood is what goes far beyond any machine's 20.
  Echo echo({.messages_per_s = 20, .messages_at_once = 4000});
  auto burst = echo.connect();
  std::string many;
  for (int i = 0; i < 3000; ++i) many += frame(2, "x");
  burst.send(many);
  for (int i = 0; i < 3000; ++i) ASSERT_EQ(burst.frame().payload, "echo x") << i;
  auto flood = echo.connect();
  std::atomic<bool> stop = false;
  std::thread sender([&] {
    while (!stop) flood.send(many);
  });
  std::thread reader([&] {
    const auto f = flood.closing();
    EXPECT_EQ(f.code(), 1008);
    EXPECT_NE(f.payload.find("more than 20 messages a second"), std::string::npos) << f.payload;
    stop = true;
    ::shutdown(flood.fd, SHUT_RDWR);
  });
  reader.join();
  sender.join();
  // Pings count too.
  auto pings = echo.connect();
  std::string many_pings;
  for (int i = 0; i < 6000; ++i) many_pings += frame(9, "");
  pings.send(many_pings);
  EXPECT_EQ(pings.closing().code(), 1008);
  // And the crumbs of a message that never ends.
  auto crumbs = echo.connect();
  std::string many_crumbs = frame(2, "x", false);
  for (int i = 0; i < 6000; ++i) many_crumbs += frame(0, "x", false);
  crumbs.send(many_crumbs);
  EXPECT_EQ(crumbs.closing().code(), 1008);
  burst.send(frame(1, "me too"));
  EXPECT_EQ(burst.frame().payload, "echo me too");
}

TEST(WebSocket, HeadAndPayloadAreOneMessageHoweverLong) {
  Echo echo;
  const auto client = echo.client();
  const std::string head = "0123456789abc";
  // Around the places where a fragment ends.
  for (const std::size_t size :
       {0ul, 1ul, 125ul, 65535ul, (1ul << 20) - 13, (1ul << 20) - 12, 1ul << 20, 3'000'001ul}) {
    std::string body(size, 0);
    for (std::size_t i = 0; i < size; ++i) body[i] = static_cast<char>(i * i >> 7);
    ASSERT_TRUE(
        echo.transport->send(echo.last(), std::as_bytes(std::span(head)), payload(body), false, true));
    const auto got = client->receive(5);
    EXPECT_TRUE(words_of(got) == head + body) << size;
  }
  EXPECT_TRUE(echo.transport->send(echo.last(), std::as_bytes(std::span(head)), nullptr, false, true));
  EXPECT_EQ(words_of(client->receive(5)), head);
  EXPECT_TRUE(echo.transport->send_text(echo.last(), "text"));
  const auto text = client->receive(5);
  EXPECT_TRUE(text && text->text);
  EXPECT_FALSE(echo.transport->send_text(echo.last() + 1000, "nobody"));
}

TEST(WebSocket, AStalledReaderLosesFramesAndTheOthersDoNot) {
  Echo echo({.queue_bytes = 2'000'000});
  auto stalled = echo.connect("/", 4096);
  const auto slow_id = echo.last();
  const auto client = echo.client();
  const auto id = echo.last();
  const auto frame_bytes = payload(std::string(100'000, 'f'));
  // The kernel takes some megabytes for the stalled one; then its queue fills to its half and stays there.
  std::size_t sent = 0, most_waiting = 0;
  for (int i = 0; i < 300; ++i) {
    sent += echo.transport->send(slow_id, {}, frame_bytes, false, true);
    most_waiting = std::max(most_waiting, echo.transport->waiting_bytes(slow_id));
    ASSERT_TRUE(echo.transport->send(id, {}, frame_bytes, false, true)) << i;
    ASSERT_EQ(words_of(client->receive(5)).size(), 100'000u) << i;
  }
  EXPECT_LT(sent, 300u);
  EXPECT_EQ(echo.transport->counters().dropped, 300 - sent);
  EXPECT_LE(most_waiting, 1'100'200u);  // one message beyond the half
  EXPECT_GT(most_waiting, 900'000u);
  // What must arrive has the other half.
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(echo.transport->send(slow_id, {}, frame_bytes, false, false)) << i;
  EXPECT_LE(echo.transport->waiting_bytes(slow_id), 2'000'000u);
}

TEST(WebSocket, WhoTakesNothingForLongIsEnded) {
  Echo echo({.stall_s = 0.3});
  auto stalled = echo.connect("/", 4096);
  const auto id = echo.last();
  const auto big = payload(std::string(30'000'000, 'x'));  // NOLINT(bugprone-string-constructor)
  ASSERT_TRUE(echo.transport->send(id, {}, big, false, true));
  EXPECT_TRUE(soon([&] { return echo.count(&Echo::gone) == 1; }));
  EXPECT_FALSE(echo.transport->send(id, {}, payload("x"), false, true));
  EXPECT_EQ(echo.transport->counters().refused, 1u);
  echo.expect_alive();
}

TEST(WebSocket, WhoCannotTakeWhatMustArriveIsToldAndEnded) {
  Echo echo({.queue_bytes = 300'000});
  auto slow = echo.connect("/", 4096);
  const auto id = echo.last();
  const auto big = payload(std::string(100'000, 'x'));
  int sent = 0;
  while (echo.transport->send(id, {}, big, false, false) && sent < 10'000) ++sent;
  ASSERT_LT(sent, 10'000);
  // It begins to read again: what was being written, then why it is ended.
  const auto f = slow.closing();
  EXPECT_EQ(f.code(), 1013);
  EXPECT_NE(f.payload.find("queue"), std::string::npos);
  slow.send(frame(8, f.payload));
  EXPECT_TRUE(soon([&] { return echo.count(&Echo::gone) == 1; }));
}

TEST(WebSocket, AnEmptyQueueTakesAMessageOfAnySize) {
  Echo echo({.queue_bytes = 1000});
  const auto client = echo.client();
  EXPECT_TRUE(echo.transport->send(echo.last(), {}, payload(std::string(5'000'000, 'x')), false, true));
  EXPECT_EQ(words_of(client->receive(5)).size(), 5'000'000u);
}

TEST(WebSocket, ManyEmptyMessagesAreBoundedToo) {
  std::atomic<bool> go = false;
  Echo echo({.queue_bytes = 128'000});
  auto slow = echo.connect("/", 4096);
  // Nothing is sent while the transport's thread is held here.
  echo.transport->post([&] {
    while (!go) ::usleep(1000);
  });
  int sent = 0;
  for (int i = 0; i < 10'000; ++i) sent += echo.transport->send(echo.last(), {}, nullptr, false, true);
  go = true;
  EXPECT_LE(sent, 1001);
}

TEST(WebSocket, SilentClientsAreEndedAndThoseThatAnswerPingsAreNot) {
  Echo echo({.silence_s = 1});
  auto silent = echo.connect();  // says no pong
  const auto client = echo.client();
  auto f = silent.frame();
  EXPECT_EQ(f.opcode, 9) << "a ping";
  silent.rest();
  EXPECT_TRUE(silent.ended);
  EXPECT_TRUE(soon([&] { return echo.count(&Echo::gone) == 1; }));
  ::usleep(2'200'000);
  EXPECT_TRUE(client->open()) << "its thread answers although nobody receives";
  EXPECT_EQ(echo.transport->counters().clients, 1u);
}

TEST(WebSocket, CloseClientSendsWhatIsQueuedThenTheReason) {
  Echo echo;
  auto s = echo.connect();
  const auto id = echo.last();
  echo.transport->send_text(id, "first");
  echo.transport->close_client(id, "too many subscriptions " + std::string(200, 'x'));
  EXPECT_EQ(s.frame().payload, "first");
  const auto f = s.closing();
  EXPECT_EQ(f.code(), 1008);
  EXPECT_EQ(f.payload.size(), 125u);  // RFC 6455, 5.5
  EXPECT_TRUE(f.payload.substr(2).starts_with("too many subscriptions xx"));
  // It never answers the good-bye.
  EXPECT_EQ(s.rest(), "");
  EXPECT_TRUE(s.ended);
  EXPECT_TRUE(soon([&] { return echo.count(&Echo::gone) == 1; }));
  // A reason is not cut within a letter.
  const auto client = echo.client();
  echo.transport->close_client(echo.last(), std::string(122, 'x') + "é");
  const auto end = words_of(client->receive(5));
  EXPECT_TRUE(end.ends_with(std::string(122, 'x'))) << end;
  EXPECT_FALSE(client->open());
  echo.transport->close_client(123456, "nobody");
}

TEST(WebSocket, AnExceptionOfTheHandlerEndsOneClient) {
  Echo echo;
  auto a = echo.connect(), b = echo.connect();
  a.send(frame(1, "throw"));
  a.rest();
  EXPECT_TRUE(a.ended);
  b.send(frame(1, "fine"));
  EXPECT_EQ(b.frame().payload, "echo fine");
  echo.transport->post([] { throw std::runtime_error("as planned"); });
  b.send(frame(1, "still"));
  EXPECT_EQ(b.frame().payload, "echo still");
}

TEST(WebSocket, TheTimerComes) {
  std::atomic<int> beats = 0;
  const auto t = Transport::start({.port = 0}, {.timer = [&] {
                                    if (++beats == 2) throw std::runtime_error("as planned");
                                  }});
  ASSERT_TRUE(t);
  EXPECT_TRUE(soon([&] { return beats > 5; }));
}

TEST(WebSocket, StopSaysGoodByeAndDoesNotWaitForTheStalled) {
  Echo echo;
  auto polite = echo.connect(), stalled = echo.connect("/", 4096);
  const auto big = payload(std::string(20'000'000, 'x'));  // NOLINT(bugprone-string-constructor)
  echo.transport->send(echo.last(), {}, big, false, true);
  Socket silent(echo.transport->port()), half(echo.transport->port()), reading(echo.transport->port(), 4096);
  half.send("GET / HT");
  const auto client = echo.client();
  ASSERT_TRUE(soon([&] { return echo.transport->waiting_bytes(echo.last()) == 0; }));
  const auto begin = std::chrono::steady_clock::now();
  std::thread twice([&] { echo.transport->stop(); });
  echo.transport->stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(2500));
  twice.join();
  EXPECT_EQ(echo.count(&Echo::gone), 3u) << "no client is forgotten";
  EXPECT_EQ(polite.closing().code(), 1001);
  EXPECT_NE(words_of(client->receive(5)).find("the server ends"), std::string::npos);
  half.rest();
  EXPECT_TRUE(half.ended);
  EXPECT_FALSE(echo.transport->send_text(echo.last(), "late"));
  echo.transport->post([] { ADD_FAILURE() << "nothing runs after stop()"; });
  EXPECT_EQ(echo.transport->counters().clients, 0u);
}

TEST(WebSocket, ManyThreadsMaySendWhileClientsComeAndGoAndTheServerStops) {
  for (int round = 0; round < 3; ++round) {
    Echo echo({.queue_bytes = 100'000});
    std::atomic<bool> done = false;
    std::vector<std::thread> threads;
    for (int i = 0; i < 2; ++i)
      threads.emplace_back([&] {
        const auto bytes = payload(std::string(1000, 'x'));
        while (!done)
          for (ClientId id = 0; id < 40; ++id) {
            echo.transport->send(id, {}, bytes, false, true);
            echo.transport->waiting_bytes(id);
            if (id % 7 == 0) echo.transport->close_client(id, "go");
          }
      });
    for (int i = 0; i < 2; ++i)
      threads.emplace_back([&] {
        for (int k = 0; k < 15; ++k) {
          const auto c = WebSocketClient::connect("ws" + echo.transport->url().substr(4), "one", 2);
          if (c && (*c)->send(std::as_bytes(std::span(std::string_view("x"))), true))
            (void)(*c)->receive(0.01);
        }
      });
    ::usleep(100'000);
    echo.transport->stop();
    done = true;
    for (auto& t : threads) t.join();
    EXPECT_EQ(echo.count(&Echo::gone), echo.count(&Echo::came));
  }
}

TEST(WebSocketClient, SaysWhyItCannotConnect) {
  Echo echo({.tokens = {{"t", {.role = Role::admin}}}});
  const auto why = [](const std::string& url, double timeout_s = 5) {
    const auto c = WebSocketClient::connect(url, "one", timeout_s);
    return c ? "connected" : c.error().text();
  };
  const auto base = "ws" + echo.transport->url().substr(4);
  EXPECT_EQ(why(base + "?token=t"), "connected");
  EXPECT_NE(why(base + "?token=u").find("401): this is not the token"), std::string::npos)
      << why(base + "?token=u");
  const auto other = WebSocketClient::connect(base, "three", 5);
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().text().find("known are: one"), std::string::npos);
  EXPECT_NE(why("127.0.0.1:1").find("ws://HOST:PORT"), std::string::npos);
  EXPECT_NE(why("ws://no.such.machine.invalid").find("no.such.machine.invalid"), std::string::npos);
  const auto port = echo.transport->port();
  echo.transport->stop();
  EXPECT_NE(why("ws://127.0.0.1:" + std::to_string(port)).find("nobody listens"), std::string::npos);

  // Something listens and never answers.
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  ASSERT_EQ(::bind(fd, reinterpret_cast<const sockaddr*>(&at), size), 0);
  ASSERT_EQ(::listen(fd, 5), 0);
  ASSERT_EQ(::getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size), 0);
  EXPECT_NE(why("ws://127.0.0.1:" + std::to_string(ntohs(at.sin_port)), 0.2).find("does not answer"),
            std::string::npos);
  ::close(fd);
}

TEST(WebSocketClient, WaitsAndKeepsTheOrderAndTellsWhenItIsOver) {
  Echo echo;
  const auto client = echo.client();
  EXPECT_EQ(words_of(client->receive(0.05)), "nothing came in time");
  EXPECT_TRUE(client->open());
  for (int i = 0; i < 100; ++i) {
    const auto number = std::to_string(i);
    EXPECT_TRUE(client->send(std::as_bytes(std::span(number)), true));
  }
  for (int i = 0; i < 100; ++i) EXPECT_EQ(words_of(client->receive(5)), "echo " + std::to_string(i));
  // What came before the end is still received.
  echo.transport->send_text(echo.last(), "last words");
  echo.transport->close_client(echo.last(), "enough");
  EXPECT_TRUE(soon([&] { return echo.count(&Echo::gone) == 1; }));
  EXPECT_TRUE(client->open());
  EXPECT_EQ(words_of(client->receive(5)), "last words");
  EXPECT_EQ(words_of(client->receive(5)), "the server ended the connection: enough");
  EXPECT_FALSE(client->open());
  EXPECT_FALSE(client->send({}, true));
}

TEST(WebSocketClient, StopsReadingWhatNobodyReceives) {
  Echo echo({.queue_bytes = 400u << 20});
  const auto client = echo.client();
  const auto part = payload(std::string(1'000'000, 'x'));
  for (int i = 0; i < 150; ++i) ASSERT_TRUE(echo.transport->send(echo.last(), {}, part, false, false));
  // 64 MiB wait in the client, and what the kernel's buffers grow to, up to 40 MB; the rest stays with the server.
  ASSERT_TRUE(soon([&] { return echo.transport->waiting_bytes(echo.last()) < 85'000'000; }));
  ::usleep(200'000);
  EXPECT_GT(echo.transport->waiting_bytes(echo.last()), 40'000'000u);
  for (int i = 0; i < 150; ++i) ASSERT_EQ(words_of(client->receive(5)).size(), 1'000'000u) << i;
}

}  // namespace
}  // namespace sandlot::server
