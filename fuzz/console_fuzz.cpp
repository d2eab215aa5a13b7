/// Any lines, three at most, sent to a small session: each is answered exactly once, whatever it does to the run, and none
/// does harm to a file. They are completed too; the third is not sent but scheduled.
#include "base/text.h"
#include "console/console.h"
#include "small_worlds.h"

namespace {

using namespace sandlot;

constexpr fuzz::SmallWorld world{"console", "planar", R"(
things: [{name: box1, model: msl_ball, pose: [0.4, 0, 0.11]}]
robots:
  - name: rover1
    model: {builder: diff_robot}
    devices: {laser: {kind: laser_scanner, beams: 4, noise: {white: 0.01}}}
    controller: {kind: sequence, steps: [{at: 0 s, orders: {drive: [0.1, 0, 0.2]}}]}
)"};

/// Ticks are so short that a slow run does not wait for the wall clock.
std::vector<std::byte> first_state() {
  Diagnostics diagnostics;
  auto simulation = Simulation::create(fuzz::small_setup(world, "10 us"), {}, diagnostics);
  SL_CHECK(simulation);
  return (*simulation)->snapshot();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t most_lines = 3;
  static const std::vector<std::byte> state = first_state();
  const auto lines = split({reinterpret_cast<const char*>(data), size}, '\n');
  Diagnostics diagnostics;
  auto simulation = Simulation::restore(state, {}, diagnostics);
  SL_CHECK(simulation);
  Session session(std::move(*simulation), {.history_mb = 1});
  Console console(session, {.folder = "a folder that is not there"});
  std::vector<int> answers(std::min(lines.size(), most_lines), 0);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    SL_CHECK(console.complete(lines[i]).size() <= 100);
    if (i == 2) {
      (void)console.schedule(lines[i]);
      answers[i] = 1;
      continue;
    }
    const bool may_steer = size % 4 != 3;
    SL_CHECK(session.post([&, i, may_steer](Session&) {
      console.execute(lines[i], {.may_steer = may_steer}, [&, i](const Answer& answer) {
        ++answers[i];
        SL_CHECK(answer.ok || !answer.text.empty());
      });
    }));
  }
  RunReport report;
  int calls = 0;
  (void)session.run(report, [&](const Simulation&) {
    (void)console.before_tick();
    return ++calls < 4 && session.report().state == Session::State::playing;
  });
  for (const int count : answers) SL_CHECK(count == 1);
  return 0;
}
