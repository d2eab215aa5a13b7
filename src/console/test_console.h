#pragma once
/// A session that runs, and somebody who talks to it.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <future>
#include <thread>

#include "base/test_folder.h"
#include "console/console.h"
#include "sim/test_world.h"

namespace sandlot::test {

inline bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

class Talk {
 public:
  explicit Talk(model::Setup setup, Console::Options options = {}, Session::Options of_session = {})
      : session(build(std::move(setup)), paused(std::move(of_session))),
        console(session, std::move(options)) {
    runner_ = std::thread([this] {
      RunReport report;
      status = session.run(report);
    });
  }
  ~Talk() {
    session.quit();
    if (runner_.joinable()) runner_.join();
  }

  Answer say(const std::string& line, bool may_steer = true) {
    std::promise<Answer> promise;
    auto answered = promise.get_future();
    EXPECT_TRUE(session.post([&](Session&) {
      console.execute(line, {.may_steer = may_steer},
                      [&](const Answer& answer) { promise.set_value(answer); });
    }));
    return answered.get();
  }
  /// The answer of a line that must succeed, or fail.
  std::string ok(const std::string& line) {
    const Answer answer = say(line);
    EXPECT_TRUE(answer.ok) << line << ": " << answer.text;
    return answer.text;
  }
  std::string refused(const std::string& line, bool may_steer = true) {
    const Answer answer = say(line, may_steer);
    EXPECT_FALSE(answer.ok) << line << ": " << answer.text;
    return answer.text;
  }
  /// So many ticks, and then it stands still.
  void step(std::uint64_t ticks = 1) {
    const std::uint64_t goal = session.report().tick + ticks;
    ok("step " + std::to_string(ticks));
    for (;;) {
      const Session::Report report = session.report();
      if (report.tick >= goal && report.state != Session::State::playing) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  /// What `f` makes of the world, asked on the simulation's thread.
  template <class F>
  auto ask(F f) {
    std::promise<decltype(f(std::as_const(session).simulation()))> promise;
    session.post([&](Session& s) { promise.set_value(f(std::as_const(s).simulation())); });
    return promise.get_future().get();
  }
  Vec3 place(const std::string& name) {
    return ask([&](const Simulation& sim) { return sim.engine().pose(sim.find_entity(name)->id).p; });
  }
  std::vector<std::string> complete(const std::string& line) {
    return ask([&](const Simulation&) { return console.complete(line); });
  }

  Session session;
  Console console;
  Status status;

 private:
  static Session::Options paused(Session::Options options) {
    options.paused = true;
    options.stay = true;
    return options;
  }
  std::thread runner_;
};

}  // namespace sandlot::test
