/// A simulation inside a program: load, step, read, command, save. Usage: embed room.yaml
#include <sandlot/simulation.h>

#include <algorithm>
#include <cinttypes>

using namespace sandlot;

/// Drives until the time has come: ahead where there is room, else turning left.
static void drive(Simulation& sim, double until_s) {
  while (sim.now().s() < until_s) {
    const auto scan = or_exit(reading<msg::LaserScan>(sim, "rover/laser"));
    const std::vector<float>& ranges = scan.message.ranges;
    const bool room = scan.valid && *std::min_element(ranges.begin(), ranges.end()) > 0.6f;
    or_exit(command(sim, "rover/drive",
                    msg::Twist{.linear = {room ? 0.4 : 0.05, 0, 0}, .angular = {0, 0, room ? 0 : 1.0}}));
    or_exit(sim.tick());
  }
  const Pose at = or_exit(pose(sim, "rover"));
  std::printf("%5.1f s  x %.3f  y %.3f  state %016" PRIx64 "\n", sim.now().s(), at.p.x, at.p.y,
              sim.state_hash());
}

int main(int argc, char** argv) {
  auto sim = or_exit(load_simulation(argc > 1 ? argv[1] : "room.yaml"));
  drive(*sim, 5);
  const std::vector<std::byte> half = sim->snapshot();
  drive(*sim, 10);
  auto again = or_exit(restore_simulation(half));  // the second half once more: the same state
  drive(*again, 10);
  return sim->state_hash() == again->state_hash() ? 0 : 1;
}
