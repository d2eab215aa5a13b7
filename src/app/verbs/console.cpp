/// `sandlot console`: talks to a run in another program, by hand or from a script.
#include <editline/readline.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/remote_console.h"
#include "base/json_text.h"
#include "base/text.h"

namespace sandlot::app {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t interrupt_seen = 0;

bool take_interrupt() {
  const bool seen = interrupt_seen != 0;
  interrupt_seen = 0;
  return seen;
}

/// ctrl-c ends a line or the wait for an answer, not the program.
void watch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = [](int) { interrupt_seen = 1; };
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);  // without SA_RESTART: reading the terminal ends
}

/// Prints an answer. @return whether the line succeeded
bool tell(const std::string& line, const RemoteAnswer& answer, bool json) {
  if (json) {
    nlohmann::ordered_json out{{"line", line}, {"ok", answer.ok}};
    auto data = nlohmann::ordered_json::parse(answer.text, nullptr, false);
    if (answer.ok && (data.is_array() || data.is_object())) out["data"] = std::move(data);
    else out["text"] = answer.text;
    std::printf("%s\n", out.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
  } else if (!answer.ok) {
    std::fprintf(stderr, "error: %s\n", answer.text.c_str());
  } else if (!answer.text.empty()) {
    std::printf("%s\n", answer.text.c_str());
  }
  std::fflush(stdout);
  return answer.ok;
}

std::string first_word(std::string_view line) {
  line = trim(line);
  return std::string(line.substr(0, line.find_first_of(" \t")));
}

/// The line with --json added for a program, where the command has data.
std::string asked_for(const std::string& line, bool json) {
  if (!json) return line;
  for (const char* word : {"list", "ls", "show", "view", "get", "values", "events"})
    if (first_word(line) == word && line.find("--json") == std::string::npos) return line + " --json";
  return line;
}

enum class After { go_on, failed, leave, lost };

After say(RemoteConsole& console, const std::string& line, bool json) {
  if (trim(line).empty()) return After::go_on;
  if (first_word(line) == "exit") return After::leave;
  auto answer = console.say(asked_for(line, json), take_interrupt);
  // The run may end before it answers.
  if (!answer && first_word(line) == "quit") return After::leave;
  if (!answer) {
    // The run may still carry out a line that was not waited for: only a lost connection ends the loop.
    std::fprintf(stderr, "error: %s\n", answer.error().text().c_str());
    return answer.error().what.find("connection") == std::string::npos ? After::failed : After::lost;
  }
  if (!tell(line, *answer, json)) return After::failed;
  return first_word(line) == "quit" ? After::leave : After::go_on;
}

// --- by hand: libedit knows only functions without a context ---
RemoteConsole* completing = nullptr;

char** candidates_for(const char*, int, int end) {
  rl_attempted_completion_over = 1;  // never names of files
  const std::string line(rl_line_buffer, static_cast<std::size_t>(end));
  const std::vector<std::string> words = completing->complete(line);
  if (words.empty()) return nullptr;
  // The common beginning, then each word; the library frees them.
  std::string common = words.front();
  for (const std::string& word : words) {
    std::size_t n = 0;
    while (n < common.size() && n < word.size() && common[n] == word[n]) ++n;
    common.resize(n);
  }
  const bool open = words.size() == 1 &&
                    (common.back() == '/' || common.back() == '.' || common.back() == '[');
  rl_completion_append_character = open ? 0 : ' ';
  // The library looks at the third entry also when there is one word only.
  const std::size_t more = words.size();
  char** const out = static_cast<char**>(std::calloc(more + 3, sizeof(char*)));
  if (!out) return nullptr;
  out[0] = ::strdup(common.c_str());
  for (std::size_t i = 0; i < more; ++i) out[i + 1] = ::strdup(words[i].c_str());
  return out;
}

/// $XDG_STATE_HOME/sandlot/history, or below ~/.local/state; "" without a home.
std::string history_file() {
  const char* const state = std::getenv("XDG_STATE_HOME");
  const char* const home = std::getenv("HOME");
  fs::path folder;
  if (state && *state) folder = state;
  else if (home && *home) folder = fs::path(home) / ".local" / "state";
  else return "";
  std::error_code failed;
  fs::create_directories(folder / "sandlot", failed);
  return failed ? "" : (folder / "sandlot" / "history").string();
}

std::optional<std::string> read_line(const char* prompt) {
  char* const line = ::readline(prompt);
  if (!line) return std::nullopt;
  std::string out(line);
  std::free(line);
  return out;
}

int by_hand(RemoteConsole& console, const std::string& url) {
  constexpr int kept_lines = 1000;
  static char blanks[] = " \t";
  rl_readline_name = const_cast<char*>("sandlot");
  rl_completer_word_break_characters = blanks;
  rl_basic_word_break_characters = blanks;
  rl_attempted_completion_function = candidates_for;
  completing = &console;
  using_history();
  stifle_history(kept_lines);
  const std::string history = history_file();
  if (!history.empty()) read_history(history.c_str());
  const std::string address = url.substr(0, url.find('?'));
  std::printf("%s%s: `help` lists the commands, tab completes, ctrl-d leaves\n", address.c_str(),
              console.role() == "spectator" ? " (spectator: look, do not steer)" : "");
  std::string previous;
  int code = exit_ok;
  while (true) {
    auto line = read_line("sandlot> ");
    if (!line) {
      std::printf("\n");
      if (take_interrupt()) continue;
      break;
    }
    take_interrupt();
    if (trim(*line).empty()) continue;
    if (*line != previous) {
      add_history(line->c_str());
      if (!history.empty()) write_history(history.c_str());
    }
    previous = *line;
    if (first_word(*line) == "quit") {
      const auto which = read_line("End the run (r), or only leave this console (c)? ");
      if (which && first_word(*which) == "c") break;
      if (!which || first_word(*which) != "r") continue;
    }
    const After after = say(console, *line, false);
    if (after == After::lost) code = exit_failed;
    if (after == After::leave || after == After::lost) break;
  }
  return code;
}

/// Lines of a script, or of another program on standard input.
int from_stream(RemoteConsole& console, std::istream& in, const std::string& name, bool json) {
  int code = exit_ok, number = 0;
  std::string line;
  while (std::getline(in, line)) {
    ++number;
    const std::string_view text = trim(line);
    if (text.empty() || text.front() == '#') continue;
    const After after = say(console, std::string(text), json);
    if (after == After::failed || after == After::lost) code = exit_failed;
    // Later lines of a script rely on earlier ones.
    if (after == After::failed && !name.empty()) {
      std::fprintf(stderr, "error: %s:%d: the script ends here\n", name.c_str(), number);
      break;
    }
    if (after == After::leave || after == After::lost) break;
  }
  return code;
}

}  // namespace

int console(const ConsoleOptions& options) {
  const char* const environment = std::getenv("SANDLOT_TOKEN");
  const auto url = console_url(options.url,
                               options.token.empty() && environment ? environment : options.token);
  if (!url) return complain(url.error());
  std::ifstream script;
  if (!options.script_file.empty()) {
    script.open(options.script_file);
    if (!script) return complain({"cannot read the script '" + options.script_file + "'"});
  }
  auto connected = RemoteConsole::connect(*url);
  if (!connected) return complain(connected.error());
  RemoteConsole& remote = **connected;
  watch_interrupts();
  for (const std::string& line : options.lines) {
    const After after = say(remote, line, options.json);
    if (after == After::leave) return exit_ok;
    if (after != After::go_on) return exit_failed;
  }
  if (!options.script_file.empty()) return from_stream(remote, script, options.script_file, options.json);
  if (!options.lines.empty()) return exit_ok;
  if (isatty(STDIN_FILENO) && !options.json) return by_hand(remote, *url);
  return from_stream(remote, std::cin, "", options.json);
}

}  // namespace sandlot::app
