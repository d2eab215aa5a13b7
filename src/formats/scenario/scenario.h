#pragma once
/// Scenario files (YAML): which world, which robots with which controllers, how time runs, when it stops.
///
/// The reader resolves `include`, `vars` and `--set`, checks the whole schema and returns plain structs; files the
/// scenario names (worlds, models) are opened by sim/load. An unknown key names the nearest known one.
///
/// Limits   includes 16 deep and 100 in all; a robot name stands for at most 1e6 robots, all together too.
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/describe.h"
#include "base/node.h"
#include "geometry/pose.h"
#include "model/model.h"

namespace sandlot::formats {

/// Where a group of robots starts.
struct Placement {
  enum class Kind { pose, grid, uniform } kind = Kind::pose;
  Pose X_WM;                 ///< pose
  Vec3 centre_m;             ///< grid, uniform: centre of the area
  double width_m = 0;        ///< uniform: extent along x
  double height_m = 0;       ///< uniform: extent along y
  double spacing_m = 1;      ///< grid: distance of neighbours
  double clearance_m = 0.5;  ///< uniform: no other instance's origin is nearer than this
  double wall_height_m = 0;  ///< uniform: of walls about the area; 0: none
  Place place;
};

/// A model fixed to a link of a robot.
struct Module {
  std::string id;
  std::string model;  ///< as RobotGroup::model
  std::string link;   ///< of the robot; "" for its first
  Pose X_LM;
  Node devices;  ///< map: changes to its devices
  Place place, model_place, link_place;
};

/// Robots of one kind, or things: those have a name, a model, a label, a number and a place only.
struct RobotGroup {
  model::Instance
      instance;       ///< each of them: team, label, controllers, errors, place; sim/load adds the rest
  std::string name;   ///< of the robot, or the stem when count > 1: name1, name2, ...
  std::string model;  ///< file as written (see base_folder), a name in the search path, or "builder:..."
  Node builder;       ///< in place of `model`: a map with `builder` and its parameters, else null
  int count = 1;
  Placement placement;
  std::vector<Module> modules;
  std::vector<std::string> joint_controllers;  ///< files as written (see base_folder), formats/ros2_control
  Place joint_controllers_place;
  Node devices;  ///< map: device name -> {kind, link, pose, level(s), keys...}; merged onto the model's own
  double rate_hz = 0;  ///< of devices that have a rate and were given none; 0: their kind's default
  Place model_place, rate_place;
};

/// The part of a Setup that a scenario gives, and the files that sim/load adds to it.
struct Scenario {
  std::string file;    ///< as given
  model::Setup setup;  ///< but for its world, plugins and instances
  Place engine_place;
  std::string world;  ///< file as written (see base_folder); "" for an empty plane
  Place world_place;
  std::vector<std::pair<std::string, Place>> plugins;  ///< files as written (see base_folder), or names
  std::vector<RobotGroup> robots;
  std::vector<RobotGroup> things;
  std::vector<std::pair<std::string, Place>> unused_vars;  ///< entries of `vars` that no ${name} uses
};

/// One `--set path=value`; a path names a variable (`vars.x` or just `x`) or a place in the file (`robots.count`,
/// `robots[0].devices.laser.beams`, `robots.bot1.devices.laser.beams`). An element of a list is chosen by its index or by
/// its `name` or `id`; a list with one element needs neither. A variable precedes a key of the same name, and the name of
/// an element a key of the only element. `physics=planar` leaves the other keys of a physics map alone. The value is YAML.
struct Override {
  std::string path;
  std::string value;
};

/// Reads a scenario file.
Result<Scenario> read_scenario(const std::string& path, std::span<const Override> overrides,
                               Diagnostics& diagnostics);
/// As above from text; `file` names it in messages and is the base of relative paths.
Result<Scenario> parse_scenario(std::string_view text, const std::string& file,
                                std::span<const Override> overrides, Diagnostics& diagnostics);

/// As above from the tree of a file, for formats whose files are scenarios in other words.
Result<Scenario> scenario_of_tree(Node root, const std::string& file, std::span<const Override> overrides,
                                  Diagnostics& diagnostics);

/// The folder that a relative path written at `place` starts from: that of the file it stands in (an included file's
/// own), the scenario's for what came from `--set`.
std::string base_folder(const Scenario& scenario, const Place& place);

/// What the team.yaml of a folder says of the team's software.
struct TeamSoftware {
  std::string file, name, description;
};
/// Errors   there is no such file; it is not a team's.
Result<TeamSoftware> read_team_software(const std::string& folder);

/// Reads a pose as scenario files write it: `[x, y, yaw]`, `[x, y, z, roll, pitch, yaw]` or a map of these keys.
Result<Pose> read_pose(const Node& node, const std::string& path);

/// A kind's name and its fields, for the schema.
using KindFields = std::pair<std::string, std::vector<FieldInfo>>;

/// "noise" and the types of stages that such a list may hold.
using StageFields = std::pair<std::string, std::vector<KindFields>>;
using ElementFields = std::pair<std::string, std::vector<KindFields>>;

/// What `distribution` of robots and things may be.
struct DistributionKind {
  std::string name, help;
  std::vector<FieldInfo> fields;
};
std::vector<DistributionKind> distribution_kinds();

/// JSON schema (draft 2020-12) of an object with these fields, as JSON text.
std::string schema_of(const std::vector<FieldInfo>& fields);
/// JSON schema (draft 2020-12) of scenario files, from the same field lists that read them, as JSON text.
/// @param stages    what lists of stages of errors may hold, by the name they are described under (FieldInfo::elements)
/// @param builders  of models with parameters
/// @param elements  of the world, by the key of the scenario: media, rules, markers
/// @param device_keys  keys that every device has in addition to its kind's
std::string scenario_schema(std::span<const KindFields> devices = {},
                            std::span<const KindFields> controllers = {},
                            std::span<const StageFields> stages = {},
                            std::span<const KindFields> builders = {},
                            std::span<const FieldInfo> device_keys = {},
                            std::span<const ElementFields> elements = {});

}  // namespace sandlot::formats
