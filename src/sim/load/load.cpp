#include "sim/load/load.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "base/text.h"
#include "builders/builder.h"
#include "devices/scaled_errors.h"
#include "files/resources.h"
#include "files/text.h"
#include "formats/kind.h"
#include "geometry/bounds.h"
#include "sim/load/instance.h"
#include "sim/load/scenario.h"
#include "sim/load/world.h"

namespace sandlot {
namespace {

namespace fs = std::filesystem;

/// "builder:snake?segments=12" on a plane, at the step of scenarios.
Result<model::Setup> load_built(const Node& map) {
  model::Setup setup;
  SL_ASSIGN(model::Instance instance, built_instance(map, map.find("builder")->text(), ""));
  setup.name = instance.name;
  setup.instances.push_back(bare_ground());
  setup.lights.push_back(sun());
  setup.instances.push_back(std::move(instance));
  return setup;
}

Result<model::Setup> load_bare_world(const std::string& path, std::optional<std::string_view> text,
                                     const formats::ReadOptions& options, Diagnostics& diagnostics) {
  SL_ASSIGN(formats::WorldContent content,
            text ? formats::find_format(path)->world(*text, path, options, diagnostics)
                 : formats::read_world(path, options, diagnostics));
  model::Setup setup;
  setup.name = content.is_world() ? content.world_name : fs::path(path).stem().string();
  // Gazebo's default; a scenario has its own.
  setup.step = Time::from_s(content.max_step_s.value_or(0.001));
  setup.physics = std::move(content.physics);
  const bool alone = !content.is_world() && !content.instances.front().model->is_static;
  SL_TRY(take_world(std::move(content), options.path, setup, diagnostics));
  // A robot by itself has nothing to stand on in its file. Many have their origin above the ground.
  if (alone && setup.instances.front().name != "ground") {
    const model::Instance& robot = setup.instances.front();
    Bounds bounds;
    for (const model::Link& link : robot.model->links)
      for (const model::Collision& each : link.collisions)
        bounds.include(bounds_of(each.shape, robot.X_WM * link.X_ML * each.X_LC));
    model::Instance ground = bare_ground();
    ground.X_WM.p.z = bounds.empty() ? 0 : std::min(0.0, bounds.low.z);
    setup.instances.push_back(std::move(ground));
    if (setup.lights.empty()) setup.lights.push_back(sun());
  }
  return setup;
}

/// Error of a file that does not exist; its remedy is the nearest file or model.
Error no_such_file(const std::string& path, const LoadOptions& options) {
  const std::string near = nearest_resource(path, search_path(options.paths));
  return {"no such file", near.empty() ? "files that are read end in " + formats::known_extensions() : near,
          place_in(path)};
}

/// Loads a file by its format, or a model with parameters.
Result<model::Setup> load_file(const std::string& path, const LoadOptions& options,
                               Diagnostics& diagnostics) {
  const auto words = parse_builder(path);
  std::error_code ignored;
  if (!words && !options.text && !path.empty() && !fs::exists(path, ignored))
    return no_such_file(path, options);
  const formats::FormatKind* const format = words ? nullptr : formats::find_format(path);
  if (format && format->scenario) {
    const formats::ReadOptions reading{search_path(options.paths), options.skip_missing};
    SL_ASSIGN(formats::Scenario scenario,
              options.text ? format->scenario(*options.text, path, reading, options.overrides, diagnostics)
                           : formats::read_scenario_file(path, reading, options.overrides, diagnostics));
    return load_scenario(std::move(scenario), options, diagnostics);
  }
  if (words) {
    if (!options.overrides.empty())
      return Error{"--set changes scenarios, and '" + path + "' is a model",
                   "write its parameters behind a ?, such as builder:snake?segments=12"};
    SL_ASSIGN(const Node map, *words);
    return load_built(map);
  }
  if (format) {
    if (!options.overrides.empty())
      return Error{"--set changes scenarios, and '" + path + "' is a world",
                   "write a scenario that names this world"};
    return load_bare_world(path, options.text, {search_path(options.paths), options.skip_missing},
                           diagnostics);
  }
  if (fs::is_directory(path, ignored)) return Error{"is a folder", "name a file in it", place_in(path)};
  return Error{"'" + path + "' is neither a scenario nor a world or robot",
               "files that are read end in " + formats::known_extensions()};
}

/// The caller's options take precedence over the file.
void apply_options(const LoadOptions& options, model::Setup& setup) {
  setup.errors = std::min(max_errors, setup.errors * options.errors);
  if (options.seed) setup.seed = *options.seed;
  if (options.stop_s) setup.stop = Time::from_s(*options.stop_s);
}

Status check_names(const model::Setup& setup) {
  std::map<std::string_view, const model::Instance*> names;
  for (const model::Instance& instance : setup.instances) {
    const auto [known, fresh] = names.emplace(instance.name, &instance);
    if (!fresh)
      return Error{
          "there are two things named '" + instance.name + "'",
          (known->second->place.file ? "the other one is at " + to_string(known->second->place) + "; " : "") +
              "give one of them another name",
          instance.place};
  }
  return {};
}

Result<model::Setup> load_checked(const std::string& path, const LoadOptions& options,
                                  Diagnostics& diagnostics) {
  SL_ASSIGN(model::Setup setup, load_file(path, options, diagnostics));
  apply_options(options, setup);
  SL_TRY(check_names(setup));
  return setup;
}

/// Merges warnings that are the same but for their places in one file into the first of them: ten robots with one unknown
/// plugin are one warning.
void merge_repeated(Diagnostics& diagnostics) {
  struct Seen {
    std::size_t index;
    std::set<std::pair<int, int>> places;
  };
  std::map<std::tuple<std::string, std::string, std::string, std::string>, Seen> seen;
  std::vector<Error> kept;
  for (Error& warning : diagnostics.warnings) {
    const std::string file = warning.place.file ? *warning.place.file : "";
    const auto [known, fresh] = seen.try_emplace({file, warning.path, warning.what, warning.fix},
                                                 Seen{kept.size(), {}});
    known->second.places.emplace(warning.place.line, warning.place.column);
    if (fresh) kept.push_back(std::move(warning));
  }
  for (const auto& [key, group] : seen) {
    if (group.places.size() < 2) continue;
    Error& first = kept[group.index];
    (first.fix.empty() ? first.what : first.fix) += " (and " + std::to_string(group.places.size() - 1) +
                                                    " more like it)";
  }
  diagnostics.warnings = std::move(kept);
}

}  // namespace

Result<model::Setup> load(const std::string& path, const LoadOptions& options, Diagnostics& diagnostics) {
  Result<model::Setup> setup = load_checked(path, options, diagnostics);
  merge_repeated(diagnostics);
  return setup;
}

}  // namespace sandlot
