/// Any bytes, as a stream of messages of a base station and as a command of a box: one error sentence, or a message within the
/// limits; what a stream hands out in pieces is what it hands out at once; a command that is read is written the same.
#include <cmath>

#include "base/check.h"
#include "wire/refbox.h"

namespace {

using namespace sandlot;
using namespace sandlot::refbox;

std::vector<std::string> messages(std::string_view bytes, std::size_t piece) {
  MessageStream stream;
  std::vector<std::string> out;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    stream.append(bytes.substr(at, piece));
    while (true) {
      const auto next = stream.next();
      if (!next) return out.emplace_back("refused"), out;
      if (!*next) break;
      SL_CHECK((*next)->size() <= most_bytes && !(*next)->empty());
      out.emplace_back(**next);
    }
  }
  return out;
}

void check_state(std::string_view text) {
  const auto state = read_world_state(text);
  if (!state) {
    SL_CHECK(!state.error().what.empty() && state.error().text().size() < 400);
    return;
  }
  SL_CHECK(state->robots.size() <= most_entries && state->balls.size() <= most_entries &&
           state->obstacles.size() <= most_entries);
  for (const RobotReport& robot : state->robots)
    for (std::size_t i = 0; i < 3; ++i)
      SL_CHECK(std::isfinite(robot.pose[i]) && std::isfinite(robot.velocity[i]));
  for (const PointReport& ball : state->balls)
    for (const double each : ball.position) SL_CHECK(std::isfinite(each));
}

void check_command(std::string_view text) {
  const TeamIds ids;
  const auto word = read_json(text, ids);
  if (!word) {
    SL_CHECK(!word.error().what.empty() && word.error().text().size() < 400);
    return;
  }
  auto written = json_of(*word, ids);
  SL_CHECK(written && written->back() == '\0');
  written->pop_back();
  const auto again = read_json(*written, ids);
  SL_CHECK(again && again->command == word->command && again->side == word->side);
  if (const auto byte = byte_of(*word)) SL_CHECK(word_of(*byte)->command == word->command);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto whole = messages(text, std::max<std::size_t>(1, size));
  SL_CHECK(whole == messages(text, 3));
  for (const std::string& each : whole) {
    check_state(each);
    check_command(each);
  }
  check_state(text);
  return 0;
}
