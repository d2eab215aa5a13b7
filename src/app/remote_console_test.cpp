#include "app/remote_console.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "console/console.h"
#include "server/server.h"
#include "sim/session/session.h"
#include "sim/test_world.h"

namespace sandlot::app {
namespace {

TEST(RemoteConsole, AddressesAsPeopleWriteThem) {
  EXPECT_EQ(*console_url("", ""), "ws://127.0.0.1:8765/");
  EXPECT_EQ(*console_url("9000", ""), "ws://127.0.0.1:9000/");
  EXPECT_EQ(*console_url("robolab", ""), "ws://robolab:8765/");
  EXPECT_EQ(*console_url("[::1]", ""), "ws://[::1]:8765/");
  EXPECT_EQ(*console_url("[::1]:9000", ""), "ws://[::1]:9000/");
  EXPECT_EQ(*console_url("http://robolab:80/", ""), "ws://robolab:80/");
  EXPECT_EQ(*console_url("http://robolab:80/?token=a%20b#x", ""), "ws://robolab:80/?token=a%20b");
  EXPECT_EQ(*console_url("ws://robolab:80/?role=spectator", "a b&c"),
            "ws://robolab:80/?role=spectator&token=a%20b%26c");
  EXPECT_FALSE(console_url("https://robolab", ""));
  EXPECT_FALSE(console_url("ws://", ""));
}

TEST(RemoteConsole, NobodyThereIsAnError) {
  // Port 1 is privileged and unused.
  const auto connected = RemoteConsole::connect("ws://127.0.0.1:1/");
  ASSERT_FALSE(connected);
  EXPECT_FALSE(connected.error().what.empty());
}

TEST(RemoteConsole, TalksToARunThroughItsServer) {
  Session session(test::build(test::arena("rigid", 1)), {.paused = true, .stay = true});
  Console console(session, {});
  auto server = server::Server::start({.transport = {.port = 0}}, session, console);
  ASSERT_TRUE(server) << server.error().text();
  std::thread runner([&] {
    RunReport report;
    EXPECT_TRUE(session.run(report));
  });
  {
    const auto url = console_url((*server)->url(), "");
    ASSERT_TRUE(url);
    auto admin = RemoteConsole::connect(*url);
    ASSERT_TRUE(admin) << admin.error().text();
    EXPECT_EQ((*admin)->role(), "admin");
    const auto set = (*admin)->say("set rover1/laser.noise.white 2 cm", nullptr);
    ASSERT_TRUE(set) << set.error().text();
    EXPECT_EQ(set->text, "rover1/laser.noise.white = 0.02 m with the next tick");
    const auto wrong = (*admin)->say("set rover1/laser.noise.white 2 kg", nullptr);
    ASSERT_TRUE(wrong);
    EXPECT_FALSE(wrong->ok);
    const auto words = (*admin)->complete("set rover1/laser.noise.w");
    EXPECT_NE(std::find(words.begin(), words.end(), "rover1/laser.noise.white"), words.end());

    auto spectator = RemoteConsole::connect(*url + "?role=spectator");
    ASSERT_TRUE(spectator) << spectator.error().text();
    EXPECT_EQ((*spectator)->role(), "spectator");
    const auto refused = (*spectator)->say("step", nullptr);
    ASSERT_TRUE(refused);
    EXPECT_FALSE(refused->ok);
    const auto seen = (*spectator)->say("show sim.tick", nullptr);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->text, "sim.tick = 0");

    session.quit();
    runner.join();
    (*server)->stop();
    EXPECT_FALSE((*admin)->say("time", nullptr));
  }
}

}  // namespace
}  // namespace sandlot::app
