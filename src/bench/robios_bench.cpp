/// A time slot of a RoBIOS program that does nothing in it: the turn to its process and back.
///
/// Measured is the wall time of a run of one robot with such a program less that of the same run without, per slot. The reference
/// is a bare exchange of turns between two processes by one futex in shared memory.
#include <linux/futex.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "base/check.h"
#include "base/test_folder.h"
#include "bench/bench.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::bench {
namespace {

constexpr int slots = 4000;

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Seconds per tick of a rover in an empty plane, with a slot in every tick.
double one_run(bool with_program) {
  const test::TestFolder folder;
  std::filesystem::permissions(folder.path, std::filesystem::perms(0755));
  folder.write("idle.c", "#include \"eyebot.h\"\nint main() {\n  for (;;) OSWait(20);\n}\n");
  std::ofstream(folder.file("run.yaml"))
      << "version: 1\nphysics: planar\ntime: {step: 20 ms}\nrobots:\n  - {name: rover1, model: rover"
      << (with_program
              ? ", controller: {kind: robios, program: idle.c, slot: 20 ms, delays: off, sandbox: off}"
              : "")
      << "}\n";
  Diagnostics diagnostics;
  auto setup = load(folder.file("run.yaml"), {}, diagnostics);
  SL_CHECK_MSG(setup, setup ? "" : setup.error().text().c_str());
  auto made = Simulation::create(std::move(*setup), {.threads = 1, .start_programs = true}, diagnostics);
  SL_CHECK_MSG(made, made ? "" : made.error().text().c_str());
  for (int i = 0; i < 100; ++i) SL_CHECK((*made)->tick());
  const double begin = wall_seconds();
  for (int i = 0; i < slots; ++i) SL_CHECK((*made)->tick());
  return (wall_seconds() - begin) / slots;
}

using Turn = std::atomic<std::uint32_t>;

void await(Turn& turn, std::uint32_t mine) {
  for (std::uint32_t now; (now = turn.load()) != mine;)
    syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&turn), FUTEX_WAIT, now, nullptr, nullptr, 0);
}
void give(Turn& turn, std::uint32_t to) {
  turn.store(to);
  syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&turn), FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

/// Seconds per turn there and back.
double exchange() {
  void* const at = mmap(nullptr, sizeof(Turn), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  SL_CHECK(at != MAP_FAILED);
  Turn& turn = *new (at) Turn(0);
  const pid_t other = fork();
  SL_CHECK(other >= 0);
  if (other == 0)
    for (;;) {
      await(turn, 1);
      give(turn, 0);
    }
  const double begin = wall_seconds();
  for (int i = 0; i < slots; ++i) {
    give(turn, 1);
    await(turn, 0);
  }
  const double used_s = wall_seconds() - begin;
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
  munmap(at, sizeof(Turn));
  return used_s / slots;
}

}  // namespace

std::vector<Row> robios() {
  std::vector<double> ours, reference;
  for (int i = 0; i < 4; ++i) {  // the first warms up
    const double alone_s = one_run(false);
    ours.push_back(one_run(true) - alone_s);
    reference.push_back(exchange());
  }
  const auto median = [](std::vector<double>& all) {
    all.erase(all.begin());
    std::sort(all.begin(), all.end());
    return all[all.size() / 2];
  };
  // Wall time between processes: it swings with the machine's load.
  return {row("a RoBIOS slot without calls", "us", 1e6 * median(ours), 1e6 * median(reference), 2, 8)};
}

}  // namespace sandlot::bench
