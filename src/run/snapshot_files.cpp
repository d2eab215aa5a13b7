#include "run/snapshot_files.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/atomic_file.h"
#include "base/text.h"
#include "sim/world/snapshot.h"

namespace sandlot {
namespace {

Error about(Error error, const std::string& path) {
  if (!error.place.file) error.place.file = std::make_shared<const std::string>(path);
  return error;
}

}  // namespace

Status check_snapshot_options(const SnapshotOptions& options) {
  if (options.file.empty() && options.at_s)
    return Error{"--snapshot-at gives a time, but there is no file", "add --snapshot FILE"};
  if (options.file.empty() && options.every_s)
    return Error{"--snapshot-every gives a time, but there is no file", "add --snapshot FILE"};
  if (options.every_s && !(*options.every_s >= 1e-3))
    return Error{"--snapshot-every: must be at least 0.001 s, as the files are named by milliseconds"};
  if (options.keep > 0 && !options.every_s)
    return Error{"--snapshot-keep says how many stay, but only one is taken", "add --snapshot-every 10s"};
  return {};
}

std::string numbered_file(const std::string& file, Time now) {
  const std::filesystem::path path(file);
  const std::int64_t ms = now.ns / 1'000'000;
  const std::string name = fmt::format("{}-{:06}.{:03}{}", path.stem().string(), ms / 1000, ms % 1000,
                                       path.has_extension() ? path.extension().string() : ".snapshot");
  return (path.parent_path() / name).string();
}

SnapshotFiles::SnapshotFiles(const SnapshotOptions& options, const Simulation& simulation)
    : options_(options), taken_(options.file.empty()) {
  if (!options.every_s) return;
  // Multiples of the interval, counted from time zero, so that a run that is continued goes on with the same
  // names.
  const Time every = Time::from_s(*options.every_s);
  next_ = every * (simulation.now().ns / every.ns + 1);
}

Status SnapshotFiles::write(const Simulation& simulation, const std::string& file) {
  const auto bytes = simulation.snapshot();
  return write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Status SnapshotFiles::after_tick(const Simulation& simulation) {
  Status status;
  if (next_ && simulation.now() >= *next_) {
    const Time every = Time::from_s(*options_.every_s);
    next_ = every * (simulation.now().ns / every.ns + 1);
    const std::string file = numbered_file(options_.file, simulation.now());
    status = write(simulation, file);
    if (status) {
      written_.push_back(file);
      // An older file is removed only when the newer one is written.
      for (; options_.keep > 0 && written_.size() > static_cast<std::size_t>(options_.keep);
           written_.pop_front()) {
        std::error_code ignored;
        std::filesystem::remove(written_.front(), ignored);
      }
    }
  }
  if (!taken_ && options_.at_s && simulation.now() >= Time::from_s(*options_.at_s)) {
    taken_ = true;
    if (Status at = write(simulation, options_.file); status) status = std::move(at);
  }
  if (status || std::exchange(failed_, true)) return {};
  return status;
}

Status SnapshotFiles::finish(const Simulation& simulation, Diagnostics& diagnostics) {
  if (taken_) return {};
  taken_ = true;
  if (options_.at_s)
    diagnostics.warn(
        {fmt::format("the run ended before {} s: '{}' is its state at the end, {} s",
                     number_text(*options_.at_s), options_.file, number_text(simulation.now().s()))});
  return write(simulation, options_.file);
}

Result<std::vector<std::byte>> read_snapshot_file(const std::string& path) {
  constexpr std::uint64_t most_bytes = std::uint64_t{4} << 30;
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) return Error{"cannot read '" + path + "': it is a folder"};
  std::ifstream in(path, std::ios::binary);
  if (!in) return Error{"cannot read '" + path + "': " + std::strerror(errno)};
  std::vector<std::byte> bytes;
  constexpr std::size_t piece = std::size_t{1} << 20;
  for (;;) {
    const std::size_t at = bytes.size();
    bytes.resize(at + piece);
    in.read(reinterpret_cast<char*>(bytes.data() + at), piece);
    bytes.resize(at + static_cast<std::size_t>(in.gcount()));
    if (bytes.size() > most_bytes)
      return Error{"'" + path + "' has more than " + std::to_string(most_bytes) + " bytes"};
    if (in.eof()) return bytes;
    if (!in) return Error{"cannot read '" + path + "': " + std::strerror(errno)};
  }
}

bool is_snapshot_file(const std::string& path) {
  std::array<char, snapshot_magic.size()> head{};
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), head.size());
  return in && head == snapshot_magic;
}

Result<std::vector<std::pair<std::string, std::string>>> snapshot_facts(const std::string& path) {
  SL_ASSIGN(const std::vector<std::byte> bytes, read_snapshot_file(path));
  auto examined = examine_snapshot(bytes);
  if (!examined) return about(std::move(examined.error()), path);
  const SnapshotInfo& info = *examined;
  std::size_t robots = 0;
  for (const model::Instance& instance : info.setup.instances) robots += instance.is_robot;
  using Facts = std::vector<std::pair<std::string, std::string>>;
  return Facts{
      {"version", fmt::format("{}, {} bytes, whole", info.version, bytes.size())},
      {"profile",
       info.profile +
           (info.profile == Simulation::profile() ? "" : "; this machine's is " + Simulation::profile())},
      {"scenario", fmt::format("{} ({}, seed {})", info.setup.name, info.setup.engine, info.setup.seed)},
      {"time", fmt::format("{} s, tick {}", number_text(info.now.s()), info.tick)},
      {"model", fmt::format("revision {}, {} of {} instances are robots", info.revision, robots,
                            info.setup.instances.size())}};
}

Result<std::unique_ptr<Simulation>> restore_snapshot_file(const std::string& path,
                                                          const SimulationOptions& options,
                                                          Diagnostics& diagnostics) {
  SL_ASSIGN(const std::vector<std::byte> bytes, read_snapshot_file(path));
  auto simulation = Simulation::restore(bytes, options, diagnostics);
  if (!simulation) return about(std::move(simulation.error()), path);
  return simulation;
}

}  // namespace sandlot
