#include "selforg/terminal/terminal.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>

namespace sandlot::selforg {

void Terminal::print(std::string_view text) const {
  while (!text.empty()) {
    const ssize_t written = ::write(options_.out, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// @return whether something came
bool Terminal::read_more(bool wait) {
  if (ended_) return false;
  pollfd watched{options_.in, POLLIN, 0};
  int ready = 0;
  do ready = ::poll(&watched, 1, wait ? -1 : 0);
  while (ready < 0 && errno == EINTR);
  if (ready <= 0) return false;
  char block[4096];
  const ssize_t got = ::read(options_.in, block, sizeof block);
  if (got < 0 && (errno == EINTR || errno == EAGAIN)) return false;
  if (got <= 0) {
    ended_ = true;
    if (!pending_.empty()) pending_ += '\n';  // a last line without an end
    return !pending_.empty();
  }
  pending_.append(block, static_cast<std::size_t>(got));
  if (pending_.size() > (std::size_t{1} << 20) && pending_.find('\n') == std::string::npos) pending_.clear();
  return true;
}

/// @return false: quit
bool Terminal::execute(std::string_view line) {
  const auto words = words_of(line);
  if (!words.empty() && words.size() <= 2) {
    const std::string_view command = words.front();
    if (command == "quit" || command == "exit") return false;
    if (command == "pause" && words.size() == 1) return state_ = State::paused, true;
    if (command == "run" && words.size() == 1) return state_ = State::running, true;
    if (command == "step") {
      const auto steps = words.size() == 1 ? Result<std::uint64_t>(1) : number_of_steps(words[1]);
      if (steps) state_ = State::stepping, steps_left_ = *steps;
      else print(steps.error().text() + "\n");
      return true;
    }
  }
  const auto answer = console_.execute(line);
  print(answer ? *answer : answer.error().text() + "\n");
  return true;
}

bool Terminal::serve() {
  for (;;) {
    if (state_ == State::stepping) {
      if (steps_left_ > 0) return --steps_left_, true;
      state_ = State::paused;
    }
    if (const std::size_t end = pending_.find('\n'); end != std::string::npos) {
      const std::string line = pending_.substr(0, end);
      pending_.erase(0, end + 1);
      if (!execute(line)) return false;
      continue;
    }
    const bool paused = state_ == State::paused;
    if (paused && options_.prompt && !ended_) print("selforg> ");
    if (read_more(paused)) continue;
    if (!paused) return true;
    if (ended_) return false;
  }
}

}  // namespace sandlot::selforg
