/// RoBIOS programs: a time slot in which one does nothing, and four robots with cameras.
///
/// A slot       the wall time of a run of one robot with such a program less that of the same run without, per slot. The reference
///              is a bare exchange of turns between two processes by one futex in shared memory.
/// Four robots  examples/robios/four.sim: each takes, searches and shows a picture per slot. The reference is the same world with
///              the controller `wander`, and as many pictures. Wall time, as programs run in processes of their own.
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
#include <iterator>

#include "base/check.h"
#include "base/test_folder.h"
#include "bench/bench.h"
#include "bench/one_processor.h"
#include "files/resources.h"
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

struct Crowd {
  double wall_s = 0;           ///< per simulated second
  std::uint64_t pictures = 0;  ///< of all robots
};

/// @param programs  what stands in the place of the programs
Crowd four_robots(const std::string& programs) {
  constexpr int warm_up = 20, ticks = 160;  // of 50 ms
  const std::string file = own_folder("examples/robios") + "/four.sim", own = "crowd.c";
  std::ifstream in(file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t at = text.find(own); at != std::string::npos; at = text.find(own, at + programs.size()))
    text.replace(at, own.size(), programs);
  Diagnostics diagnostics;
  auto setup = load(file, {.text = text}, diagnostics);
  SL_CHECK_MSG(setup, setup ? "" : setup.error().text().c_str());
  const double tick_s = setup->step.s();
  auto made = Simulation::create(std::move(*setup), {.threads = 1, .start_programs = true}, diagnostics);
  SL_CHECK_MSG(made, made ? "" : made.error().text().c_str());
  const auto pictures = [&] {
    std::uint64_t count = 0;
    for (const char* const camera : {"LabBot/camera", "LabBot_2/camera", "S4/camera", "S4_2/camera"})
      if (const TopicBase* const topic = (*made)->find_topic(camera)) count += topic->count;
    return count;
  };
  for (int i = 0; i < warm_up; ++i) SL_CHECK((*made)->tick());
  const std::uint64_t before = pictures();
  const double begin = wall_seconds();
  for (int i = 0; i < ticks; ++i) SL_CHECK((*made)->tick());
  return {(wall_seconds() - begin) / (ticks * tick_s), pictures() - before};
}

double median(std::vector<double>& all) {
  all.erase(all.begin());  // the first warms up
  std::sort(all.begin(), all.end());
  return all[all.size() / 2];
}

/// Nothing where the examples are not installed.
void add_four_robots(std::vector<Row>& rows) {
  if (own_folder("examples/robios").empty()) return;
  std::vector<double> ours, reference;
  for (int i = 0; i < 4; ++i) {
    const Crowd programs = four_robots("crowd.c"), controllers = four_robots("controller:wander");
    // A robot that turns takes none: three quarters of all at least.
    SL_CHECK(4 * programs.pictures >= 3 * controllers.pictures);
    ours.push_back(programs.wall_s);
    reference.push_back(controllers.wall_s);
  }
  rows.push_back(
      row("four RoBIOS robots with cameras, 1 s", "ms", 1e3 * median(ours), 1e3 * median(reference), 1.5));
}

}  // namespace

std::vector<Row> robios() {
  std::vector<double> ours, reference;
  for (int i = 0; i < 4; ++i) {
    const OneProcessor one;
    const double alone_s = one_run(false);
    ours.push_back(one_run(true) - alone_s);
    reference.push_back(exchange());
  }
  // Wall time between processes: it swings with the machine's load.
  std::vector<Row> rows{
      row("a RoBIOS slot without calls", "us", 1e6 * median(ours), 1e6 * median(reference), 2, 8)};
  add_four_robots(rows);
  return rows;
}

}  // namespace sandlot::bench
