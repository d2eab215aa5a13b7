#include "sim/load/load.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "base/text.h"
#include "builders/builder.h"
#include "devices/kind.h"
#include "files/resources.h"
#include "formats/ros2_control/ros2_control.h"
#include "formats/sdf/sdf.h"
#include "geometry/bounds.h"
#include "noise/chain.h"
#include "physics/engine.h"
#include "sim/load/attach.h"
#include "sim/load/joint_controllers.h"
#include "sim/load/placement.h"
#include "sim/load/plugin.h"
#include "sim/load/presets.h"

namespace sandlot {
namespace {

namespace fs = std::filesystem;

/// The file that a scenario names. A folder stands for its model.sdf or, without one, for its only .urdf; "builder:..." is
/// not a file and stays as it is.
Result<std::string> locate(const std::string& written, const std::string& folder_of_file,
                           const SearchPath& path, const Place& place) {
  if (builder_words(written)) return written;
  SL_ASSIGN(const std::string found, find_resource(written, folder_of_file, path, place));
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

Result<std::uint32_t> link_named(const model::Model& model, const Node& name, const std::string& path) {
  if (const auto index = model.find_link(name.text())) return *index;
  std::vector<std::string> names;
  for (const model::Link& link : model.links) names.push_back(link.name);
  return name.error("model '" + model.name + "' has no link '" + name.text() + "'",
                    suggestion(name.text(), names), path);
}

/// What a file called a device, as a user would recognise it.
std::string sdf_name(const model::DeviceDecl& decl) {
  if (decl.sdf_types.empty()) return "'" + decl.name + "'";
  const std::string& type = decl.sdf_types.front();
  if (starts_with(type, "sensor:")) return "<sensor type=\"" + type.substr(7) + "\">";
  return "plugin '" + type.substr(starts_with(type, "plugin:") ? 7 : 0) + "'";
}

/// Devices that an SDF file declared become Sandlot's kinds; those nobody answers to are named and dropped.
Status translate_devices(model::Instance& instance, const SearchPath& path, Diagnostics& diagnostics) {
  std::vector<model::DeviceDecl> kept, controllers;
  for (model::DeviceDecl& decl : instance.devices) {
    if (decl.kind.empty()) {
      if (is_ros_control_plugin(decl)) {
        SL_ASSIGN(auto more, controllers_of_plugin(decl, path, diagnostics));
        std::move(more.begin(), more.end(), std::back_inserter(controllers));
        continue;
      }
      const Kind* const kind = find_device_kind_for_sdf(decl);
      if (!kind) {
        diagnostics.warn({sdf_name(decl) + " is not supported", "it is ignored", decl.place});
        continue;
      }
      auto config = kind->from_sdf(decl.config, diagnostics);
      if (!config) {
        if (!config.error().place.file) config.error().place = decl.place;
        return std::move(config.error());
      }
      decl.config = std::move(*config);
      decl.kind = kind->name;
      if (const Node* const link = decl.config.find("link")) {
        SL_ASSIGN(decl.link, link_named(*instance.model, *link, ""));
        decl.config.erase("link");
      }
    }
    kept.push_back(std::move(decl));
  }
  instance.devices = std::move(kept);
  return add_devices(instance, std::move(controllers));
}

/// Lays the scenario's `devices:` upon the model's own: known names change keys, new names need a kind.
Status merge_devices(model::Instance& instance, const Node& devices) {
  for (const Node::Entry& entry : devices.entries()) {
    const auto found = std::find_if(instance.devices.begin(), instance.devices.end(),
                                    [&](const model::DeviceDecl& d) { return d.name == entry.key; });
    const bool fresh = found == instance.devices.end();
    model::DeviceDecl decl = fresh ? model::DeviceDecl{} : *found;
    Node keys = entry.value;
    if (!keys.is_map() && !keys.is_null()) return wrong_type(keys, "a map of keys", "/devices/" + entry.key);
    const std::string path = "/devices/" + entry.key;
    decl.name = entry.key;
    decl.place = entry.key_place;
    if (const Node* kind = keys.find("kind")) decl.kind = kind->text();
    if (decl.kind.empty()) {
      std::vector<std::string> names;
      for (const model::DeviceDecl& d : instance.devices) names.push_back(d.name);
      return Error{"model '" + instance.model->name + "' has no device '" + entry.key + "'",
                   "give it a kind, or " + suggestion(entry.key, names), entry.key_place, path};
    }
    if (const Node* link = keys.find("link")) {
      SL_ASSIGN(decl.link, link_named(*instance.model, *link, path + "/link"));
    }
    if (const Node* pose = keys.find("pose")) {
      SL_ASSIGN(decl.X_LS, formats::read_pose(*pose, path + "/pose"));
    }
    for (const char* own : {"kind", "link", "pose"}) keys.erase(own);
    if (decl.config.is_null()) decl.config = Node::map(decl.place);
    if (keys.find("level") || keys.find("levels")) {
      decl.config.erase("level");
      decl.config.erase("levels");
    }
    // A preset goes before what the model said, and what stands beside it before both.
    SL_TRY(lay_preset(keys, decl.kind));
    merge(decl.config, keys);
    if (fresh) instance.devices.push_back(std::move(decl));
    else *found = std::move(decl);
  }
  return {};
}

/// Fixes the scenario's modules to a robot, in order, so that one may carry the next.
Status attach_modules(model::Instance& robot, const formats::RobotGroup& group,
                      const formats::Scenario& scenario, const SearchPath& search, const LoadOptions& options,
                      Diagnostics& diagnostics) {
  for (const formats::Module& module : group.modules) {
    SL_ASSIGN(const std::string file, locate(module.model, formats::base_folder(scenario, module.model_place),
                                             search, module.model_place));
    SL_ASSIGN(model::Instance part,
              load_instance(file, module.id, {}, diagnostics, options.paths, options.skip_missing));
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

/// Takes world instances over: their devices translated, names checked.
Status take_world(formats::SdfContent content, const SearchPath& path, model::Setup& setup,
                  Diagnostics& diagnostics) {
  setup.gravity = content.gravity_mps2;
  setup.ambient = content.ambient;
  setup.background = content.background;
  setup.geography = content.geography;
  setup.magnetic_field_T = content.magnetic_field_T;
  setup.gravity_place = content.gravity_place;
  setup.lights = std::move(content.lights);
  for (model::Instance& instance : content.instances) {
    SL_TRY(translate_devices(instance, path, diagnostics));
    instance.is_robot = instance.is_robot || !instance.devices.empty();
    setup.instances.push_back(std::move(instance));
  }
  return {};
}

/// The ground of a scenario without a world, or of a model by itself.
model::Instance bare_ground() {
  auto ground = std::make_shared<model::Model>();
  ground->name = "ground";
  ground->is_static = true;
  model::Link link;
  link.name = "link";
  link.collisions.push_back({"collision", {}, Plane{{0, 0, 1}}, {}, {}});
  link.visuals.push_back({"visual", {}, Plane{{0, 0, 1}}, {}, true, {}});
  ground->links.push_back(std::move(link));
  model::Instance instance;
  instance.name = instance.original_name = "ground";
  instance.model = std::move(ground);
  return instance;
}

/// The light of a scenario without a world, or of a model by itself: what Gazebo's empty world has.
model::Light sun() {
  model::Light light;
  light.name = "sun";
  light.X_PLight = {{0, 0, 10}, quat_between({0, 0, -1}, normalised(Vec3{-0.5, 0.1, -0.9}))};
  light.color = {0.8f, 0.8f, 0.8f, 1};
  light.specular = {0.2f, 0.2f, 0.2f, 1};
  light.cast_shadows = true;
  return light;
}

/// What a builder made, standing on the ground at the origin.
Result<model::Instance> built_instance(const Node& map, const std::string& name, const std::string& path) {
  SL_ASSIGN(Built built, build_model(map, path));
  model::Instance instance;
  instance.name = sanitised(name);
  instance.original_name = name;
  instance.X_WM = built.X_WM;
  instance.devices = built.model.devices;
  instance.is_robot = !instance.devices.empty();
  instance.place = map.place();
  instance.model = std::make_shared<const model::Model>(std::move(built.model));
  return instance;
}

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

Result<model::Setup> load_bare_world(const std::string& path, const formats::SdfOptions& options,
                                     Diagnostics& diagnostics) {
  SL_ASSIGN(formats::SdfContent content, formats::read_sdf(path, diagnostics, options));
  model::Setup setup;
  setup.name = content.world_name.empty() ? fs::path(path).stem().string() : content.world_name;
  // Gazebo's default; a scenario has its own.
  setup.step = Time::from_s(content.max_step_s.value_or(0.001));
  setup.physics = std::move(content.physics);
  const bool alone = content.world_name.empty() && !content.instances.front().model->is_static;
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

formats::SdfOptions sdf_options(std::span<const std::string> paths, bool skip_missing) {
  formats::SdfOptions out;
  out.path = search_path(paths);
  out.skip_missing = skip_missing;
  return out;
}

/// Ten robots whose plugin nobody answers to are one thing to know, not ten: warnings that say the same of places in
/// one file become the first of them.
void fold(Diagnostics& diagnostics) {
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

Result<model::Setup> load_all(const std::string& path, const LoadOptions& options, Diagnostics& diagnostics);

}  // namespace

Result<model::Instance> load_instance(const std::string& model_file, const std::string& name,
                                      const Pose& X_WM, Diagnostics& diagnostics,
                                      std::span<const std::string> paths, bool skip_missing) {
  if (const auto words = builder_words(model_file)) {
    SL_ASSIGN(const Node map, *words);
    SL_ASSIGN(model::Instance built, built_instance(map, name, ""));
    built.X_WM = X_WM * built.X_WM;
    return built;
  }
  SL_ASSIGN(formats::SdfContent content,
            formats::read_sdf(model_file, diagnostics, sdf_options(paths, skip_missing)));
  if (content.instances.size() != 1 || !content.world_name.empty())
    return Error{"'" + model_file + "' is a world, not a model", "name a file with one <model>"};
  model::Instance instance = std::move(content.instances.front());
  SL_TRY(translate_devices(instance, search_path(paths), diagnostics));
  instance.name = sanitised(name);
  instance.original_name = name;
  instance.X_WM = X_WM * instance.X_WM;
  instance.is_robot = !instance.devices.empty();
  return instance;
}

Result<model::Setup> load(const std::string& path, const LoadOptions& options, Diagnostics& diagnostics) {
  Result<model::Setup> setup = load_all(path, options, diagnostics);
  fold(diagnostics);
  return setup;
}

namespace {

Result<model::Setup> load_all(const std::string& path, const LoadOptions& options, Diagnostics& diagnostics) {
  const std::string extension = fs::path(path).extension().string();
  const formats::SdfOptions sdf = sdf_options(options.paths, options.skip_missing);
  const SearchPath& search = sdf.path;
  model::Setup setup;
  if (const auto words = builder_words(path)) {
    if (!options.overrides.empty())
      return Error{"--set changes scenarios, and '" + path + "' is a model",
                   "write its parameters behind a ?, such as builder:snake?segments=12"};
    SL_ASSIGN(const Node map, *words);
    SL_ASSIGN(setup, load_built(map));
  } else if (extension == ".sdf" || extension == ".world" || extension == ".urdf" || extension == ".xacro") {
    if (!options.overrides.empty())
      return Error{"--set changes scenarios, and '" + path + "' is a world",
                   "write a scenario that names this world"};
    SL_ASSIGN(setup, load_bare_world(path, sdf, diagnostics));
  } else if (extension == ".yaml" || extension == ".yml") {
    SL_ASSIGN(const formats::Scenario scenario,
              options.text ? formats::parse_scenario(*options.text, path, options.overrides, diagnostics)
                           : formats::read_scenario(path, options.overrides, diagnostics));
    if (!scenario.world.empty()) {
      SL_ASSIGN(const std::string world,
                locate(scenario.world, formats::base_folder(scenario, scenario.world_place), search,
                       scenario.world_place));
      SL_ASSIGN(formats::SdfContent content, formats::read_sdf(world, diagnostics, sdf));
      SL_TRY(take_world(std::move(content), search, setup, diagnostics));
    } else {
      setup.instances.push_back(bare_ground());
      setup.lights.push_back(sun());
    }
    setup.errors = scenario.errors;
    if (auto engine = find_engine(scenario.engine); !engine) {
      engine.error().place = scenario.engine_place;
      return std::move(engine.error());
    }
    setup.name = scenario.name;
    setup.engine = scenario.engine;
    setup.physics = scenario.physics;
    setup.step = Time::from_s(scenario.step_s);
    setup.clock = scenario.clock;
    setup.record = scenario.record;
    setup.substeps = scenario.substeps;
    setup.control_interval = scenario.control_interval;
    setup.seed = scenario.seed;
    setup.values = scenario.values;
    setup.events = scenario.events;
    setup.log = scenario.log;
    setup.zones = scenario.zones;
    if (scenario.stop_s) setup.stop = Time::from_s(*scenario.stop_s);
    if (options.seed) setup.seed = *options.seed;
    for (const auto& [written, place] : scenario.plugins) {
      SL_ASSIGN(std::string file,
                find_plugin(written, formats::base_folder(scenario, place), options.paths, place));
      setup.plugins.push_back({std::move(file), "", 0, place});
    }
    std::map<std::string, model::Instance> loaded;
    const auto pattern_of = [&](const formats::RobotGroup& group,
                                const std::string& where) -> Result<model::Instance> {
      if (!group.builder.is_null()) return built_instance(group.builder, group.name, where + "/model");
      if (const auto parameters = builder_words(group.model, group.model_place)) {
        SL_ASSIGN(const Node map, *parameters);
        return built_instance(map, group.name, where + "/model");
      }
      SL_ASSIGN(const std::string file, locate(group.model, formats::base_folder(scenario, group.model_place),
                                               search, group.model_place));
      if (const auto known = loaded.find(file); known != loaded.end()) return known->second;
      auto instance = load_instance(file, group.name, {}, diagnostics, options.paths, options.skip_missing);
      if (!instance) {
        if (!instance.error().place.file) instance.error().place = group.model_place;
        return std::move(instance.error());
      }
      return loaded.emplace(file, std::move(*instance)).first->second;
    };
    const auto add_group = [&](const formats::RobotGroup& group, const model::Instance& pattern,
                               std::span<const Pose> poses) {
      for (int i = 0; i < group.count; ++i) {
        model::Instance instance = pattern;
        instance.label = group.label;
        instance.original_name = group.count == 1 ? group.name : group.name + std::to_string(i + 1);
        instance.name = sanitised(instance.original_name);
        instance.X_WM = poses[static_cast<std::size_t>(i)] * pattern.X_WM;
        setup.instances.push_back(std::move(instance));
      }
    };
    const auto fence = [&](Placer& placer, const formats::RobotGroup& group) {
      auto walls = walls_of(group);
      if (!walls) return;
      placer.add(*walls);
      setup.instances.push_back(std::move(*walls));
    };
    // Things first: robots find their places between them.
    Placer thing_placer(setup.instances, setup.seed);
    for (std::size_t i = 0; i < scenario.things.size(); ++i) {
      const formats::RobotGroup& group = scenario.things[i];
      SL_ASSIGN(model::Instance pattern, pattern_of(group, "/things/" + std::to_string(i)));
      pattern.place = group.place;
      fence(thing_placer, group);
      SL_ASSIGN(const std::vector<Pose> poses, thing_placer.place(group));
      add_group(group, pattern, poses);
    }
    Placer placer(setup.instances, setup.seed);
    for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
      const formats::RobotGroup& group = scenario.robots[i];
      SL_ASSIGN(model::Instance pattern, pattern_of(group, "/robots/" + std::to_string(i)));
      pattern.is_robot = true;
      pattern.team = group.team;
      pattern.controllers = group.controllers;
      pattern.place = group.place;
      SL_TRY(attach_modules(pattern, group, scenario, search, options, diagnostics));
      for (const std::string& written : group.joint_controllers) {
        const Place& place = group.joint_controllers_place;
        SL_ASSIGN(const std::string found,
                  find_resource(written, formats::base_folder(scenario, place), search, place));
        SL_ASSIGN(auto controllers, formats::read_joint_controllers(found, diagnostics));
        SL_TRY(add_devices(pattern, std::move(controllers)));
      }
      SL_TRY(merge_devices(pattern, group.devices));
      pattern.errors = group.errors;
      fence(placer, group);
      SL_ASSIGN(const std::vector<Pose> poses, placer.place(group));
      add_group(group, pattern, poses);
    }
  } else {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return Error{"'" + path + "' is not there"};
    return Error{"'" + path + "' is neither a scenario (.yaml) nor a world or robot (.sdf, .world, .urdf)"};
  }
  setup.errors = std::min(max_errors, setup.errors * options.errors);
  if (options.seed) setup.seed = *options.seed;
  if (options.stop_s) setup.stop = Time::from_s(*options.stop_s);
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
  return setup;
}

}  // namespace
}  // namespace sandlot
