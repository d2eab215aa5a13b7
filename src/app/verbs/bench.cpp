#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

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
  std::string first = program, name = options.name, json = "--json";
  char* arguments[4] = {first.data()};
  int n = 1;
  if (!name.empty()) arguments[n++] = name.data();
  if (options.json) arguments[n++] = json.data();
  std::fflush(nullptr);
  execv(program.c_str(), arguments);
  return complain({"bench: cannot start '" + program + "': " + std::strerror(errno), ""});
}

}  // namespace sandlot::app
