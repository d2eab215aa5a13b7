/// EyeSim's files of worlds, mazes, robot types and objects.
#include <filesystem>

#include "formats/eyesim/lines.h"
#include "formats/eyesim/plan.h"
#include "formats/eyesim/robi.h"
#include "formats/eyesim/sim.h"
#include "formats/kind.h"

namespace sandlot::formats {
namespace {

std::string stem_of(const std::string& file) { return std::filesystem::path(file).stem().string(); }

Result<WorldContent> read_wld_content(std::string_view text, const std::string& file,
                                      const ReadOptions& options, Diagnostics& diagnostics) {
  SL_ASSIGN(const eyesim::Plan plan, eyesim::read_wld(text, file, diagnostics));
  return eyesim::world_of(plan, stem_of(file), file, options, diagnostics);
}

Result<WorldContent> read_maze_content(std::string_view text, const std::string& file,
                                       const ReadOptions& options, Diagnostics& diagnostics) {
  SL_ASSIGN(const eyesim::Plan plan, eyesim::read_maze(text, file, diagnostics));
  return eyesim::world_of(plan, stem_of(file), file, options, diagnostics);
}

Result<WorldContent> read_robi_content(std::string_view text, const std::string& file,
                                       const ReadOptions& options, Diagnostics& diagnostics) {
  SL_ASSIGN(eyesim::Robi robot, eyesim::read_robi(text, file, options, diagnostics));
  WorldContent out;
  out.instances.push_back(std::move(robot.instance));
  return out;
}

Result<WorldContent> read_object_content(std::string_view text, const std::string& file,
                                         const ReadOptions& options, Diagnostics& diagnostics) {
  SL_ASSIGN(model::Instance object, eyesim::read_object(text, file, options, diagnostics));
  WorldContent out;
  out.instances.push_back(std::move(object));
  return out;
}

Result<Scenario> read_sim(std::string_view text, const std::string& file, const ReadOptions& options,
                          std::span<const Override> overrides, Diagnostics& diagnostics) {
  SL_ASSIGN(Node root, eyesim::sim_tree(text, file, options, diagnostics));
  return scenario_of_tree(std::move(root), file, overrides, diagnostics);
}

constexpr std::string_view wld_extensions[] = {".wld"};
constexpr std::string_view maze_extensions[] = {".maz", ".maze"};
constexpr std::string_view robi_extensions[] = {".robi"};
constexpr std::string_view object_extensions[] = {".esObj", ".esobj"};
constexpr std::string_view sim_extensions[] = {".sim"};

}  // namespace

extern const FormatKind eyesim_world_format, eyesim_maze_format, eyesim_robot_format, eyesim_object_format,
    eyesim_scenario_format;

constinit const FormatKind eyesim_world_format{
    .name = "wld",
    .help = "Worlds of EyeSim and Saphira: walls by their ends.",
    .contents = "worlds",
    .extensions = wld_extensions,
    .max_bytes = eyesim::most_bytes,
    .world = read_wld_content,
    .write_plain_world = eyesim::wld_of,
};
constinit const FormatKind eyesim_maze_format{
    .name = "maze",
    .help = "Mazes of EyeSim, drawn with characters.",
    .contents = "worlds",
    .extensions = maze_extensions,
    .max_bytes = eyesim::most_bytes,
    .world = read_maze_content,
    .write_plain_world = eyesim::maze_of,
};
constinit const FormatKind eyesim_robot_format{
    .name = "robi",
    .help = "Robot types of EyeSim: drive, wheels, psd, camera, lidar.",
    .contents = "robots",
    .extensions = robi_extensions,
    .max_bytes = eyesim::most_bytes,
    .world = read_robi_content,
    .write_plain_model = eyesim::robi_of,
};
constinit const FormatKind eyesim_object_format{
    .name = "esobj",
    .help = "Objects of EyeSim: a mesh with its mass and colliders.",
    .contents = "objects",
    .extensions = object_extensions,
    .max_bytes = eyesim::most_bytes,
    .world = read_object_content,
};
constinit const FormatKind eyesim_scenario_format{
    .name = "sim",
    .help = "Scenarios of EyeSim: a world, robots with their programs, objects, markers.",
    .contents = "scenarios",
    .extensions = sim_extensions,
    .max_bytes = eyesim::most_bytes,
    .scenario = read_sim,
    .scenario_tree = eyesim::sim_tree,
    .write_scenario = eyesim::sim_of,
};

}  // namespace sandlot::formats
