#include "sim/load/scenario.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "base/text.h"
#include "builders/builder.h"
#include "controllers/controllers.h"
#include "controllers/grid_map.h"
#include "files/resources.h"
#include "files/text.h"
#include "formats/kind.h"
#include "formats/ros2_control/ros2_control.h"
#include "navigation/maps/map_file.h"
#include "physics/engine.h"
#include "programs/programs.h"
#include "sim/load/attach.h"
#include "sim/load/declared_devices.h"
#include "sim/load/device_settings.h"
#include "sim/load/instance.h"
#include "sim/load/joint_controllers.h"
#include "sim/load/placement.h"
#include "sim/load/plugin.h"
#include "sim/load/world.h"

namespace sandlot {
namespace {

namespace fs = std::filesystem;

class ScenarioLoader {
 public:
  ScenarioLoader(formats::Scenario scenario, const LoadOptions& options, Diagnostics& diagnostics)
      : scenario_(std::move(scenario)),
        options_(options),
        search_(search_path(options.paths)),
        diagnostics_(diagnostics),
        setup_(std::move(scenario_.setup)) {}

  Result<model::Setup> load() {
    if (options_.seed) setup_.seed = *options_.seed;
    SL_TRY(add_world());
    SL_TRY(check_engine());
    SL_TRY(add_plugins());
    SL_TRY(add_things());  // before the robots, which find their places between them
    SL_TRY(add_robots());
    for (model::TeamDecl& team : setup_.teams) {
      set_program_folders(team.controllers);
      SL_TRY(embed_maps(team.controllers));
    }
    return std::move(setup_);
  }

 private:
  Status add_world() {
    if (scenario_.world.empty()) {
      setup_.instances.push_back(bare_ground());
      setup_.lights.push_back(sun());
      return {};
    }
    SL_ASSIGN(const std::string file, locate(scenario_.world, scenario_.world_place));
    SL_ASSIGN(formats::WorldContent content,
              formats::read_world(file, {search_, options_.skip_missing}, diagnostics_));
    return take_world(std::move(content), search_, setup_, diagnostics_);
  }

  Status check_engine() const {
    auto engine = find_engine(setup_.engine);
    if (engine) return {};
    engine.error().place = scenario_.engine_place;
    return std::move(engine.error());
  }

  Status add_plugins() {
    for (const auto& [written, place] : scenario_.plugins) {
      SL_ASSIGN(std::string file, find_plugin(written, folder_at(place), options_.paths, place));
      setup_.plugins.push_back({std::move(file), "", 0, place});
    }
    return {};
  }

  Status add_things() {
    Placer placer(setup_.instances, setup_.seed);
    for (std::size_t i = 0; i < scenario_.things.size(); ++i) {
      const formats::RobotGroup& group = scenario_.things[i];
      SL_ASSIGN(const model::Instance thing, instance_of(group, "/things/" + std::to_string(i)));
      SL_TRY(place_copies(group, thing, placer));
    }
    return {};
  }

  Status add_robots() {
    Placer placer(setup_.instances, setup_.seed);
    for (std::size_t i = 0; i < scenario_.robots.size(); ++i) {
      const formats::RobotGroup& group = scenario_.robots[i];
      SL_ASSIGN(model::Instance robot, instance_of(group, "/robots/" + std::to_string(i)));
      robot.is_robot = true;
      set_program_folders(robot.controllers);
      SL_TRY(embed_maps(robot.controllers));
      SL_TRY(attach_modules(robot, group));
      SL_TRY(add_joint_controllers(robot, group));
      SL_TRY(merge_devices(robot, group.devices));
      if (group.rate_hz > 0)
        for (model::DeviceDecl& device : robot.devices.edit())
          set_default_rate(device, group.rate_hz, group.rate_place);
      SL_TRY(place_copies(group, robot, placer));
    }
    return {};
  }

  /// Programs in processes of their own work in the scenario's folder, also after a restore from elsewhere.
  void set_program_folders(SharedList<model::ControllerDecl>& controllers) const {
    for (std::size_t i = 0; i < controllers.size(); ++i) {
      const model::ControllerDecl& decl = controllers.get()[i];
      const auto kinds = program_kinds();
      const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                     [&](const ProgramKind* each) { return decl.kind == each->name; });
      if (kind == kinds.end()) continue;
      const std::vector<FieldInfo> fields = (*kind)->describe();
      if (std::none_of(fields.begin(), fields.end(), [](const FieldInfo& f) { return f.path == "folder"; }))
        continue;
      const Node* const given = decl.config.find("folder");
      const fs::path written = given ? given->text() : "";
      const Place place = given ? given->place() : decl.place;
      Node& config = controllers.edit()[i].config;
      // A file named without its folder is in ".": absolute() throws where it gets nothing.
      const std::string beside = folder_at(place);
      const fs::path folder = fs::absolute(fs::path(beside.empty() ? "." : beside) / written);
      config.set("folder", Node::scalar(folder.lexically_normal().string(), place));
    }
  }

  /// Controllers open no files: what `map` names is put into `map_data` (controllers/grid_map.h), which snapshots carry.
  Status embed_maps(SharedList<model::ControllerDecl>& controllers) {
    for (std::size_t i = 0; i < controllers.size(); ++i) {
      const model::ControllerDecl& decl = controllers.get()[i];
      const auto kinds = sandlot::controller_kinds();
      const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                     [&](const ControllerKind* each) { return decl.kind == each->name; });
      const Node* const given = decl.config.is_map() ? decl.config.find("map") : nullptr;
      if (kind == kinds.end() || !given || given->text().empty() || decl.config.find("map_data")) continue;
      const std::vector<FieldInfo> fields = (*kind)->describe();
      if (std::none_of(fields.begin(), fields.end(), [](const FieldInfo& f) { return f.path == "map_data"; }))
        continue;
      const Place place = given->place();
      SL_ASSIGN(std::string text, map_data_of(given->text(), place));
      controllers.edit()[i].config.set("map_data", Node::scalar(std::move(text), place));
    }
    return {};
  }

  /// The map behind a name in the scenario, as text; each file is read once.
  Result<std::string> map_data_of(const std::string& written, const Place& place) {
    constexpr std::size_t most_yaml = 64 * 1024, most_picture = std::size_t{256} << 20;
    const std::string file = beside(folder_at(place), written);
    if (const auto known = maps_.find(file); known != maps_.end()) return known->second;
    // A file that cannot be read is an error of the line that names it.
    const auto named_at = [](const Error& error, const Place& there) {
      return Error{to_string(error.place) + ": " + error.what, error.fix, there};
    };
    const auto text = read_text_file(file, most_yaml);
    if (!text) return named_at(text.error(), place);
    SL_TRY(check_text(*text, file));
    SL_ASSIGN(const navigation::MapHeader header, navigation::parse_map_header(*text, diagnostics_, file));
    const std::string image = beside(folder_of(file), header.image);
    const auto picture = read_text_file(image, most_picture);
    if (!picture) {
      Place line = place_in(file);
      line.line = header.image_line;
      return named_at(picture.error(), line);
    }
    SL_ASSIGN(const navigation::GridMap map, navigation::decode_map(header, *picture, image));
    return maps_.emplace(file, controllers::map_text(map)).first->second;
  }

  /// One instance of a group, at the model's own pose: what the scenario declares of it, with the model of its file.
  Result<model::Instance> instance_of(const formats::RobotGroup& group, const std::string& where) {
    SL_ASSIGN(model::Instance loaded, model_of(group, where));
    model::Instance out = group.instance;
    out.model = std::move(loaded.model);
    out.X_WM = loaded.X_WM;
    out.is_robot = loaded.is_robot;
    out.devices = std::move(loaded.devices);
    out.motion = std::move(loaded.motion);
    return out;
  }

  /// The model of a group, made by a builder or read from its file; each file is read once.
  Result<model::Instance> model_of(const formats::RobotGroup& group, const std::string& where) {
    if (!group.builder.is_null()) return built_instance(group.builder, group.name, where + "/model");
    if (const auto parameters = parse_builder(group.model, group.model_place)) {
      SL_ASSIGN(const Node map, *parameters);
      return built_instance(map, group.name, where + "/model");
    }
    SL_ASSIGN(const std::string file, locate(group.model, group.model_place));
    if (const auto known = loaded_.find(file); known != loaded_.end()) return known->second;
    auto instance = load_instance(file, group.name, {}, diagnostics_, options_.paths, options_.skip_missing);
    if (!instance) {
      if (!instance.error().place.file) instance.error().place = group.model_place;
      return std::move(instance.error());
    }
    return loaded_.emplace(file, std::move(*instance)).first->second;
  }

  /// Fixes the scenario's modules to a robot, in order, so that one may carry the next.
  Status attach_modules(model::Instance& robot, const formats::RobotGroup& group) {
    for (const formats::Module& module : group.modules) {
      SL_ASSIGN(const std::string file, locate(module.model, module.model_place));
      SL_ASSIGN(model::Instance part,
                load_instance(file, module.id, {}, diagnostics_, options_.paths, options_.skip_missing));
      part.place = module.place;
      SL_TRY(merge_devices(part, module.devices));
      std::uint32_t link = 0;
      if (!module.link.empty()) {
        const auto found = robot.model->find_link(module.link);
        std::vector<std::string> names;
        for (const model::Link& each : robot.model->links) names.push_back(each.name);
        if (!found)
          return Error{"robot '" + group.name + "' has no link '" + module.link + "'",
                       suggestion(module.link, names), module.link_place, "/modules/" + module.id + "/link"};
        link = *found;
      }
      auto attached = attach_module(robot, part, module.id, link, module.X_LM);
      if (!attached) return std::move(attached.error());
    }
    return {};
  }

  Status add_joint_controllers(model::Instance& robot, const formats::RobotGroup& group) {
    const Place& place = group.joint_controllers_place;
    for (const std::string& written : group.joint_controllers) {
      SL_ASSIGN(const std::string found, find_resource(written, folder_at(place), search_, place));
      SL_ASSIGN(auto controllers, formats::read_joint_controllers(found, diagnostics_));
      SL_TRY(add_devices(robot, std::move(controllers)));
    }
    return {};
  }

  /// Adds all instances of a group, and the walls about their area.
  Status place_copies(const formats::RobotGroup& group, const model::Instance& pattern, Placer& placer) {
    if (auto walls = walls_of(group)) {
      placer.add(*walls);
      setup_.instances.push_back(std::move(*walls));
    }
    SL_ASSIGN(const std::vector<Pose> poses, placer.place(group));
    for (int i = 0; i < group.count; ++i) {
      model::Instance instance = pattern;
      instance.original_name = group.count == 1 ? group.name : group.name + std::to_string(i + 1);
      instance.name = sanitised(instance.original_name);
      instance.X_WM = poses[static_cast<std::size_t>(i)] * pattern.X_WM;
      setup_.instances.push_back(std::move(instance));
    }
    return {};
  }

  /// The folder that a path written at `place` starts from.
  std::string folder_at(const Place& place) const { return formats::base_folder(scenario_, place); }

  /// The file behind a name in the scenario. A folder stands for its model.sdf or, without one, for its only .urdf;
  /// "builder:..." is not a file and stays as it is.
  Result<std::string> locate(const std::string& written, const Place& place) const {
    if (parse_builder(written)) return written;
    SL_ASSIGN(const std::string found, find_resource(written, folder_at(place), search_, place));
    std::error_code ignored;
    if (!fs::is_directory(found, ignored)) return found;
    const std::string file = (fs::path(found) / "model.sdf").string();
    if (fs::is_regular_file(file, ignored)) return file;
    std::vector<std::string> robots;
    for (const auto& entry : fs::directory_iterator(found, ignored))
      if (entry.path().extension() == ".urdf") robots.push_back(entry.path().string());
    if (robots.size() == 1) return robots.front();
    return Error{"folder '" + found + "' holds " +
                     (robots.empty() ? "no model.sdf" : "several .urdf files and no model.sdf"),
                 "name the file", place};
  }

  formats::Scenario scenario_;  ///< its setup moved into setup_
  const LoadOptions& options_;
  SearchPath search_;
  Diagnostics& diagnostics_;
  model::Setup setup_;
  std::map<std::string, model::Instance> loaded_;  ///< by file
  std::map<std::string, std::string> maps_;        ///< texts of map files by path
};

}  // namespace

Result<model::Setup> load_scenario(formats::Scenario scenario, const LoadOptions& options,
                                   Diagnostics& diagnostics) {
  return ScenarioLoader(std::move(scenario), options, diagnostics).load();
}

}  // namespace sandlot
