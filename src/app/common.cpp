#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "app/commands.h"
#include "base/program.h"
#include "record/playback.h"
#include "sim/load/load.h"

namespace sandlot::app {
namespace {

std::atomic<bool> interrupt_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

}  // namespace

Result<std::unique_ptr<Simulation>> build(const std::string& file, const FileOptions& options,
                                          Diagnostics& diagnostics) {
  SL_ASSIGN(model::Setup setup,
            load(file, {options.overrides, {}, {}, options.paths, options.skip_missing}, diagnostics));
  SL_TRY(record::resolve_playbacks(setup, options.paths));
  return Simulation::create(std::move(setup), {}, diagnostics);
}

int complain(const Error& error) {
  std::fprintf(stderr, "error: %s\n", error.text().c_str());
  return exit_bad_input;
}

int finish_output(int code) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
  std::fputs("error: not all of the output could be written\n", stderr);
  return code == exit_ok ? exit_failed : code;
}

void print_warnings(const Diagnostics& diagnostics) {
  for (const Error& warning : diagnostics.warnings)
    std::fprintf(stderr, "warning: %s\n", warning.text().c_str());
}

bool interrupted() { return interrupt_requested.load(std::memory_order_relaxed); }

void catch_interrupts() {
  const auto handler = [](int signal) {
    // A second signal ends the program at once, unless it is the echo of the first: timeout(1) and some shells
    // signal the process and then its whole group.
    static std::atomic<std::int64_t> first_ns{0};
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const std::int64_t now_ns = now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
    if (!interrupt_requested.exchange(true)) first_ns = now_ns;
    else if (now_ns - first_ns > 500'000'000) std::_Exit(128 + signal);
  };
  std::signal(SIGINT, handler);
  std::signal(SIGTERM, handler);
}

namespace {

/// Where scenarios may lie: beside the program or above it, and here.
std::vector<std::filesystem::path> scenario_folders() {
  namespace fs = std::filesystem;
  std::vector<fs::path> folders;
  for (const std::string& program : program_files())
    for (fs::path folder = fs::path(program).parent_path(); !folder.empty(); folder = folder.parent_path()) {
      folders.push_back(folder / "scenarios");
      folders.push_back(folder / "share" / "sandlot" / "scenarios");
      if (folder == folder.root_path()) break;
    }
  folders.emplace_back("scenarios");
  return folders;
}

/// Names of the scenarios in the first such folder that is there, sorted.
std::vector<std::string> demo_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& folder : scenario_folders()) {
    if (!std::filesystem::is_directory(folder, error)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
      if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
    break;
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

int list_demos() {
  for (const std::string& name : demo_names()) std::printf("%s\n", name.c_str());
  return exit_ok;
}

Result<std::string> demo_file(const std::string& name) {
  std::error_code error;
  for (const auto& folder : scenario_folders())
    if (std::filesystem::is_regular_file(folder / (name + ".yaml"), error))
      return (folder / (name + ".yaml")).lexically_normal().string();
  std::string known;
  for (const std::string& each : demo_names()) known += (known.empty() ? "" : ", ") + each;
  return Error{"there is no demo '" + name + "'",
               known.empty() ? "no folder 'scenarios' was found near the program" : "there are: " + known};
}

}  // namespace sandlot::app
