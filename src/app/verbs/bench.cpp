#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "app/commands.h"
#include "base/program.h"

namespace sandlot::app {

/// Replaces this process by `sandlot-bench`, which lies in the same folder.
int bench(const BenchOptions& options) {
  std::string program;
  for (const std::string& file : program_files())
    if (const auto beside = std::filesystem::path(file).parent_path() / "sandlot-bench";
        program.empty() && std::filesystem::exists(beside))
      program = beside.string();
  if (program.empty())
    return complain({"bench: there is no program sandlot-bench beside this one",
                     "`./dev bench` builds it, in a copy of the source"});
  std::vector<std::string> words = {program};
  if (!options.suite.empty()) words.push_back(options.suite);
  if (options.guard) words.emplace_back("--guard");
  if (options.json) words.emplace_back("--json");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::fflush(nullptr);
  execv(program.c_str(), arguments.data());
  return complain({"bench: cannot start '" + program + "': " + std::strerror(errno), ""});
}

}  // namespace sandlot::app
