/// An experiment in C++: every two seconds a ball falls into the rover's room; what does it bump into?
///
///   experiment balls.yaml --duration 20s --command 'at 5s move ball1 0 0.5'
#include <sandlot/experiment.h>

#include <cstdio>
#include <map>

using namespace sandlot;

int main(int argc, char** argv) {
  int balls = 0;
  std::map<std::string, int> bumps;  // by what the rover touched
  Hooks hooks;

  hooks.after_tick = [](Experiment& experiment) -> Status {
    if (experiment.simulation().tick_index() % 200 == 0) experiment.emit("serve");
    return {};
  };

  hooks.on_event = [&](Experiment& experiment, const std::string& name) -> Status {
    if (name != "serve") return {};
    Simulation& sim = experiment.simulation();
    // The ball's place depends on the seed and its number alone: the same in every run.
    Stream random(sim.setup().seed, entity_key("balls"), Purpose::experiment,
                  static_cast<std::uint64_t>(balls));
    const Vec3 at{random.uniform(-2.5, 2.5), random.uniform(-1.5, 1.5), 1.0};
    Diagnostics warnings;
    SL_ASSIGN(model::Instance ball,
              load_instance(HERE "/ball.sdf", "ball" + std::to_string(++balls), {at, {}}, warnings));
    sim.submit(SpawnRequest{std::move(ball)});  // in the world from the next tick on, and in the log
    return {};
  };

  hooks.on_contact = [&](Experiment&, const Touch& touch) -> Status {
    if (!touch.began) return {};
    if (touch.a == "rover") ++bumps[touch.b];
    if (touch.b == "rover" && touch.a != "ground") ++bumps[touch.a];
    return {};
  };

  hooks.commands.push_back(
      {"move", "move NAME X Y: puts a thing somewhere else",
       [](Experiment& experiment, std::span<const std::string> words) -> Result<std::string> {
         double x = 0, y = 0;
         if (words.size() != 3 || !parse_number(words[1], x) || !parse_number(words[2], y))
           return Error{"move takes a name and two numbers"};
         SL_ASSIGN(Pose to, pose(experiment.simulation(), words[0]));
         to.p.x = x, to.p.y = y;
         experiment.simulation().submit(PoseRequest{words[0], to});
         return words[0] + " moved";
       }});

  hooks.on_end = [&](Experiment&) -> Status {
    std::printf("%d balls\n", balls);
    for (const auto& [name, count] : bumps) std::printf("touched %s %d times\n", name.c_str(), count);
    return {};
  };

  return experiment_main(argc, argv, hooks);
}
