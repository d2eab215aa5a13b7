#include <unistd.h>

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
#include "sim/load.h"

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

void print_warnings(const Diagnostics& diagnostics) {
  for (const Error& warning : diagnostics.warnings)
    std::fprintf(stderr, "warning: %s\n", warning.text().c_str());
}

std::string part_of(const std::string& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  // A device or a pipe is written to: a file renamed over /dev/null would take its place.
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) ? path : path + ".part";
}

Status put_in_place(const std::string& part, const std::string& path) {
  if (part == path || std::rename(part.c_str(), path.c_str()) == 0) return {};
  const std::string reason = std::strerror(errno);
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  return Error{"cannot write '" + path + "': " + reason};
}

Status write_file(const std::string& path, std::string_view content) {
  const std::string part = part_of(path);
  std::ofstream out(part, std::ios::binary | std::ios::trunc);
  if (out) out.write(content.data(), static_cast<std::streamsize>(content.size()));
  if (out) out.close();
  if (out) return put_in_place(part, path);
  const std::string reason = std::strerror(errno);
  std::error_code ignored;
  if (part != path) std::filesystem::remove(part, ignored);
  return Error{"cannot write '" + path + "': " + reason};
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

Result<std::string> demo_file(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<fs::path> folders;
  for (const std::string& program : program_files())
    for (fs::path folder = fs::path(program).parent_path(); !folder.empty(); folder = folder.parent_path()) {
      folders.push_back(folder / "scenarios");
      folders.push_back(folder / "share" / "sandlot" / "scenarios");
      if (folder == folder.root_path()) break;
    }
  folders.emplace_back("scenarios");
  for (const fs::path& folder : folders)
    if (fs::is_regular_file(folder / (name + ".yaml"), error))
      return (folder / (name + ".yaml")).lexically_normal().string();
  for (const fs::path& folder : folders) {
    if (!fs::is_directory(folder, error)) continue;
    std::string known;
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (entry.path().extension() == ".yaml")
        known += (known.empty() ? "" : ", ") + entry.path().stem().string();
    return Error{"there is no demo '" + name + "'", "there are: " + known};
  }
  return Error{"there is no demo '" + name + "'", "no folder 'scenarios' was found near the program"};
}

}  // namespace sandlot::app
