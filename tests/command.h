#pragma once
/// Runs the sandlot command as a user would and returns what it printed.
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "base/test_folder.h"

namespace sandlot::test {

struct Printed {
  int exit_code = -1;
  std::string out;  ///< standard output and error together
};

/// @param command  as typed in a shell
inline Printed shell(const std::string& command) {
  Printed printed;
  const std::string line = "{ " + command + "; } 2>&1 </dev/null";
  FILE* const pipe = popen(line.c_str(), "r");
  if (!pipe) return printed;
  std::array<char, 4096> buffer;
  for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    printed.out.append(buffer.data(), n);
  const int status = pclose(pipe);
  printed.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return printed;
}

/// @param arguments  as typed in a shell, after "sandlot "
inline Printed sandlot(const std::string& arguments) {
  return shell(std::string(SANDLOT_BIN) + " " + arguments);
}

inline nlohmann::json read_json(const std::string& path) {
  std::ifstream in(path);
  return nlohmann::json::parse(in, nullptr, false);
}

/// Runs a scenario and returns its summary.
inline nlohmann::json summary_of(const std::string& arguments) {
  const TestFolder scratch;
  const std::string file = scratch.file("s.json");
  const Printed printed = sandlot("run " + arguments + " --headless --summary " + file);
  if (printed.exit_code != 0) return {{"failed", printed.out}};
  return read_json(file);
}

}  // namespace sandlot::test
