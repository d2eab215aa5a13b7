/// Any text as a log of an agent: an error with its line, or a table whose rows have a number for each column. The lines also go to the
/// console of an agent, where each is answered and none may crash.
#include "base/check.h"
#include "base/text.h"
#include "selforg/console.h"

namespace {

using namespace sandlot;

struct Still : selforg::Robot {
  std::size_t sensors() const override { return 2; }
  std::size_t motors() const override { return 2; }
  void read_sensors(std::span<double> x) override { x[0] = 0.5, x[1] = -0.25; }
  void set_motors(std::span<const double>) override {}
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto table = selforg::read_log_text(text, "fuzz");
  if (table) {
    for (const auto& row : table->rows) SL_CHECK(row.size() == table->columns.size());
  } else {
    SL_CHECK(!table.error().what.empty() && table.error().place.line > 0);
  }
  Still robot;
  auto agent = selforg::make_agent(robot, {.controller = "sox"});
  SL_CHECK(agent);
  selforg::AgentConsole console(**agent);
  int lines = 0;
  for (const std::string_view line : split(text, '\n')) {
    const std::string_view word = trim(line);
    // Files are not what is tested.
    if (starts_with(word, "store") || starts_with(word, "load") || starts_with(word, "log")) continue;
    if (++lines > 20) break;
    const auto answer = console.execute(line);
    SL_CHECK(answer || !answer.error().what.empty());
    (*agent)->step(0.01);
    for (const double each : (*agent)->last_motors()) SL_CHECK(each >= -1 && each <= 1);
  }
  return 0;
}
