#include "programs/process_tree.h"

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "base/text.h"

namespace sandlot::programs {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_processes = 100'000;

std::string proc_file(int process, const char* name) {
  std::ifstream in("/proc/" + std::to_string(process) + "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number out{};
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), out);
  return failure == std::errc() && end == text.data() + text.size() ? std::optional(out) : std::nullopt;
}

/// Fields of /proc/PID/stat behind the name, which may hold anything; the first is the third of proc(5).
std::vector<std::string_view> stat_fields(const std::string& text) {
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos || name_end + 2 > text.size()) return {};
  return split(std::string_view(text).substr(name_end + 2), ' ');
}

std::uint64_t field(const std::vector<std::string_view>& fields, std::size_t number_of_proc5) {
  const std::size_t index = number_of_proc5 - 3;
  return index < fields.size() ? number_in<std::uint64_t>(fields[index]).value_or(0) : 0;
}

/// Memory that is not a file's: RssAnon and RssShmem of /proc/PID/status, which are in kB.
std::uint64_t memory_of(int process) {
  const std::string status = proc_file(process, "status");
  std::uint64_t kb = 0;
  for (const char* const key : {"\nRssAnon:", "\nRssShmem:"}) {
    const std::size_t at = status.find(key);
    if (at == std::string::npos) continue;
    const std::size_t begin = status.find_first_of("0123456789", at), end = status.find(' ', begin);
    if (begin == std::string::npos || end == std::string::npos) continue;
    kb += number_in<std::uint64_t>(std::string_view(status).substr(begin, end - begin)).value_or(0);
  }
  return kb * 1024;
}

}  // namespace

std::vector<int> processes_below(int process) {
  std::vector<int> out;
  for (std::size_t next = 0; out.size() < most_processes; ++next) {
    const int parent = next == 0 ? process : next <= out.size() ? out[next - 1] : -1;
    if (parent < 0) break;
    std::error_code gone;
    // A child belongs to the thread that made it.
    for (fs::directory_iterator thread("/proc/" + std::to_string(parent) + "/task", gone), end;
         !gone && thread != end; thread.increment(gone)) {
      std::ifstream in(thread->path() / "children");
      for (int child = 0; in >> child;) out.push_back(child);
    }
  }
  return out;
}

void halt(int process, bool halted) {
  kill(process, halted ? SIGSTOP : SIGCONT);
  for (const int each : processes_below(process)) kill(each, halted ? SIGSTOP : SIGCONT);
}

std::uint64_t threads_of_user(unsigned user) {
  std::uint64_t out = 0;
  std::error_code failed;
  for (fs::directory_iterator entry("/proc", failed), end; !failed && entry != end; entry.increment(failed)) {
    const auto process = number_in<int>(entry->path().filename().string());
    struct stat info {};
    if (!process || ::stat(entry->path().c_str(), &info) != 0 || info.st_uid != user) continue;
    constexpr std::size_t num_threads = 20;
    const std::string text = proc_file(*process, "stat");
    out += field(stat_fields(text), num_threads);
  }
  return out;
}

ProcessMeter::Usage ProcessMeter::sample(int process) {
  Usage out;
  std::map<int, Ticks> ticks;
  std::vector<int> all = processes_below(process);
  all.push_back(process);
  std::uint64_t own = 0, collected = 0;
  for (const int each : all) {
    const std::string text = proc_file(each, "stat");
    const auto fields = stat_fields(text);
    if (fields.empty()) continue;
    const Ticks now{field(fields, 14) + field(fields, 15), field(fields, 16) + field(fields, 17)};
    const auto found = ticks_.find(each);
    const Ticks before = found == ticks_.end() ? Ticks{0, 0} : found->second;
    own += now.own - std::min(now.own, before.own);
    collected += now.collected - std::min(now.collected, before.collected);
    ticks[each] = now;
    out.memory_bytes += memory_of(each);
    ++out.processes;
  }
  // What was counted while a child lived comes again with what its parent has collected.
  std::uint64_t counted = 0;
  for (const auto& [each, before] : ticks_)
    if (!ticks.contains(each)) counted += before.own + before.collected;
  ticks_ = std::move(ticks);
  out.cpu_s = static_cast<double>(own + collected - std::min(collected, counted)) /
              static_cast<double>(sysconf(_SC_CLK_TCK));
  return out;
}

}  // namespace sandlot::programs
