/// Any lines, said to a small session: each is answered exactly once, whatever it does to the run, and none does harm to a
/// file. They are completed and scheduled too.
#include "base/check.h"
#include "base/text.h"
#include "console/console.h"
#include "files/resources.h"
#include "sim/load/load.h"

namespace {

using namespace sandlot;

const std::vector<std::byte>& first_state() {
  static const std::vector<std::byte> state = [] {
    Diagnostics diagnostics;
    auto setup = load(own_folder("scenarios") + "/indoor.yaml", {}, diagnostics);
    SL_CHECK_MSG(setup, setup ? "" : setup.error().what.c_str());
    auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
    SL_CHECK(simulation);
    return (*simulation)->snapshot();
  }();
  return state;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t most_lines = 20;
  const auto lines = split({reinterpret_cast<const char*>(data), size}, '\n');
  Diagnostics diagnostics;
  auto simulation = Simulation::restore(first_state(), {}, diagnostics);
  SL_CHECK(simulation);
  Session session(std::move(*simulation), {.history_mb = 1});
  Console console(session, {.folder = "a folder that is not there"});
  std::vector<int> answers(std::min(lines.size(), most_lines), 0);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const bool may_steer = i % 4 != 3;
    SL_CHECK(session.post([&, i, may_steer](Session&) {
      console.execute(lines[i], {.may_steer = may_steer}, [&, i](const Answer& answer) {
        ++answers[i];
        SL_CHECK(answer.ok || !answer.text.empty());
      });
    }));
    SL_CHECK(console.complete(lines[i]).size() <= 100);
    (void)console.schedule(lines[i]);
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
