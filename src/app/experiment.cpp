#include "app/experiment.h"

#include "app/commands.h"

namespace sandlot {

int experiment_main(int argc, char** argv, const Hooks& hooks) {
  std::string verb = "run";
  std::vector<char*> arguments(argv, argv + argc);
  arguments.insert(arguments.begin() + (argc > 0 ? 1 : 0), verb.data());
  return app::command(static_cast<int>(arguments.size()), arguments.data(), &hooks);
}

}  // namespace sandlot
