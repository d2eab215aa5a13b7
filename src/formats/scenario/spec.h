#pragma once
/// The keys of a scenario file, once: the reader and the schema both come from these lists. A key whose value is a field of
/// model::Setup or model::Instance is read into it at once; the others are taken over in scenario.cpp.
/// long file: one list of keys, as users see them
#include <optional>
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/node.h"
#include "formats/scenario/annotation_spec.h"
#include "formats/scenario/team_spec.h"
#include "formats/scenario/watch_spec.h"
#include "formats/scenario/zone_spec.h"
#include "geometry/vec3.h"
#include "model/model.h"

namespace sandlot::formats::scenario_spec {

inline constexpr double max_angle_rad = 1e4;
inline constexpr int max_robots = 1'000'000;

struct Time {
  model::Clock::Mode clock = model::Clock::Mode::fixed;
  double min_step_s = 1e-4, max_step_s = 0.1;
  double step_s = 0.01;
  int substeps = 1;
  int control_interval = 1;
  std::optional<double> stop_s;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"clock", "",
                "Kind of clock. fixed: every tick has the same length; continuous: each takes the time that "
                "computing the last one took, so that the run keeps up with the wall clock; that time is "
                "recorded."},
          s.clock);
    visit(Field{"step", "s", "Length of a tick; of a continuous clock the first one's.", 1e-6, 10}, s.step_s);
    visit(Field{"min_step", "s", "Shortest tick of a continuous clock.", 1e-6, 10}, s.min_step_s);
    visit(Field{"max_step", "s",
                "Longest tick of a continuous clock; the run falls behind when it takes more.", 1e-6, 10},
          s.max_step_s);
    visit(Field{"substeps", "1", "Physics steps per tick.", 1, 1000}, s.substeps);
    visit(Field{"control_interval", "1", "Ticks from one control step to the next.", 1, 1e6},
          s.control_interval);
    visit(Field{"stop", "s", "Simulated time at which the run ends by itself.", 0, 9e9}, s.stop_s);
  }
};

struct PoseKeys {
  double x_m = 0, y_m = 0, z_m = 0, roll_rad = 0, pitch_rad = 0, yaw_rad = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Position along x, forward.", -max_distance_m, max_distance_m}, s.x_m);
    visit(Field{"y", "m", "Position along y, to the left.", -max_distance_m, max_distance_m}, s.y_m);
    visit(Field{"z", "m", "Position along z, up.", -max_distance_m, max_distance_m}, s.z_m);
    visit(Field{"roll", "rad", "Rotation about x, first.", -max_angle_rad, max_angle_rad}, s.roll_rad);
    visit(Field{"pitch", "rad", "Rotation about y, second.", -max_angle_rad, max_angle_rad}, s.pitch_rad);
    visit(Field{"yaw", "rad", "Rotation about z, last.", -max_angle_rad, max_angle_rad}, s.yaw_rad);
  }
};

struct Grid {
  Vec3 centre_m;
  double spacing_m = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"centre", "m", "Middle of the grid: x y z.", -max_distance_m, max_distance_m}, s.centre_m);
    visit(Field{"spacing", "m", "Distance between neighbours.", 1e-3, 1e4}, s.spacing_m);
  }
};

struct Uniform {
  Vec3 centre_m;
  std::optional<double> width_m, height_m, density_per_m2;
  double clearance_m = 0.5;
  double wall_height_m = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"centre", "m", "Middle of the area: x y z.", -max_distance_m, max_distance_m}, s.centre_m);
    visit(Field{"width", "m", "Extent of the area along x.", 1e-3, max_distance_m}, s.width_m);
    visit(Field{"height", "m", "Extent of the area along y.", 1e-3, max_distance_m}, s.height_m);
    visit(Field{"density", "1/m^2",
                "In place of width and height: robots per square metre, in a square that holds them all.",
                1e-6, 1e6},
          s.density_per_m2);
    visit(Field{"clearance", "m", "Smallest distance between two origins.", 0, 1e4}, s.clearance_m);
    visit(Field{"wall_height", "m", "Height of walls about the area; 0: none.", 0, 1e3}, s.wall_height_m);
  }
};

struct Distribution {
  std::optional<Grid> grid;
  std::optional<Uniform> uniform;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"grid", "", "Arrangement in rows and columns."}, s.grid);
    visit(Field{"uniform", "", "Random places in a rectangle with random headings."}, s.uniform);
  }
};

struct Module {
  std::string id;
  std::string model;
  Node pose;
  std::string link;
  Node devices;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"id", "", "Name of the module in its robot; unique there.", 0, 0, Field::required, 100},
          s.id);
    visit(Field{"model", "", "Model file of the module, or a name in the search path.", 0, 0, Field::required,
                4096},
          s.model);
    visit(Field{"pose", "m", "Pose on the link, in the same forms as that of a robot."}, s.pose);
    visit(
        Field{"link", "",
              "Link of the robot, or id::link of a module above, that carries it; the first one by default.",
              0, 0, Field::none, 200},
        s.link);
    visit(Field{"devices", "", "Changes to the module's devices, by name: rates, levels, noise."}, s.devices);
  }
};

inline constexpr Field label_field{
    "label",     "", "What detectors call it, such as ball; its model's name if left out.", 0, 0,
    Field::none, 100};

inline constexpr Field properties_field{
    "properties", "", "Properties by name, such as fuel: a number, or a map with value, unit, min and max."};

/// Property of a robot or a thing.
struct Property {
  Node value, min, max;
  std::string unit = "1";

  static void fields(auto& s, auto&& visit) {
    visit(Field{"value", "", "Value at the start, in the unit or with a unit.", 0, 0, Field::required},
          s.value);
    visit(Field{"unit", "", "Unit of the value.", 0, 0, Field::none, 30}, s.unit);
    visit(Field{"min", "", "Least value."}, s.min);
    visit(Field{"max", "", "Greatest value."}, s.max);
  }
};

/// Object in the world that is not a robot.
struct LabelledObject {
  std::string name;
  Node model;
  int count = 1;
  Node pose;
  std::optional<Distribution> distribution;
  Node properties;
  model::Instance instance;  ///< label

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the thing; with count > 1 the stem of name1, name2, ...", 0, 0,
                Field::required, 100},
          s.name);
    visit(Field{"model", "", "Model of the thing, in the same forms as that of a robot.", 0, 0,
                Field::required},
          s.model);
    visit(Field{"count", "1", "Number of things; 0: none.", 0, max_robots}, s.count);
    visit(Field{"pose", "m", "Pose of the thing, in the same forms as that of a robot."}, s.pose);
    visit(Field{"distribution", "", "Places of several things."}, s.distribution);
    visit(label_field, s.instance.label);
    visit(properties_field, s.properties);
    model::EntityInfo::fields(s.instance.info, visit);
  }
};

struct Robot {
  std::string name;
  Node model;
  int count = 1;
  Node pose;
  std::optional<Distribution> distribution;
  model::Instance instance;  ///< team, label, errors
  std::vector<Module> modules;
  Node controller;
  Node controllers;
  std::vector<std::string> joint_controllers;
  Node devices;
  std::optional<double> rate_hz;
  Node properties;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the robot; with count > 1 the stem of name1, name2, ...", 0, 0,
                Field::required, 100},
          s.name);
    visit(Field{"model", "",
                "Model file (SDF or URDF), relative to this file, or a folder of models; or a map with "
                "builder and its parameters, or builder:NAME?key=value.",
                0, 0, Field::required},
          s.model);
    visit(Field{"count", "1", "Number of robots; 0: none.", 0, max_robots}, s.count);
    visit(
        Field{"pose", "m", "Pose at the start: [x, y, yaw], [x, y, z, roll, pitch, yaw] or a map of these."},
        s.pose);
    visit(Field{"distribution", "", "Places of several robots."}, s.distribution);
    visit(Field{"team", "", "Team of the robot.", 0, 0, Field::none, 100}, s.instance.team);
    visit(label_field, s.instance.label);
    visit(Field{"modules", "", "Models attached to the robot's own: scanners, camera heads, arms.", 0, 0,
                Field::none, 1000},
          s.modules);
    visit(Field{"controller", "", "Kind of the robot's controller, or a map with kind and the kind's keys."},
          s.controller);
    visit(
        Field{"controllers", "", "Several controllers: a list of maps with name, kind and the kind's keys."},
        s.controllers);
    visit(Field{"joint_controllers", "",
                "Files of ROS joint controllers (ros2_control, ros_control), relative to this file.", 0, 0,
                Field::none, 100},
          s.joint_controllers);
    visit(Field{"devices", "",
                "Devices by name: a new device (kind, link, pose, ...) or changes to one of the model's."},
          s.devices);
    visit(Field{"errors", "1", "Factor on the errors of all devices of the robot: 0 none, 1 as configured.",
                0, 1000},
          s.instance.errors);
    visit(Field{"rate", "Hz",
                "Control steps per second of the robot's programs, and samples per second of its devices, "
                "where neither the scenario nor the model gives a rate.",
                1e-3, 1e5},
          s.rate_hz);
    visit(properties_field, s.properties);
    model::EntityInfo::fields(s.instance.info, visit);
  }
};

struct Root {
  int version = 1;
  model::Setup setup;  ///< name, seed, errors, record
  std::string world;
  Node physics;
  Time time;
  Node vars;
  std::vector<std::string> plugins;
  std::vector<Team> teams;
  std::vector<Robot> robots;
  std::vector<LabelledObject> things;
  Node values, criterion;
  std::vector<Event> events;
  std::optional<Log> log;
  std::vector<Zone> zones;
  Node media, rules, markers;
  std::vector<NamedPose> poses;
  std::optional<Share> share;
  Node include;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"version", "1", "Version of the scenario format: 1.", 1, 1, Field::required}, s.version);
    visit(Field{"name", "", "Name of the scenario.", 0, 0, Field::none, 200}, s.setup.name);
    visit(
        Field{"world", "", "World file (SDF), relative to this file; an empty plane in sunlight if left out.",
              0, 0, Field::none, 4096},
        s.world);
    visit(Field{"physics", "", "Engine: rigid or planar, or a map with engine and the engine's keys."},
          s.physics);
    visit(Field{"time", "", "Clock and steps of the run."}, s.time);
    // Numbers in files are doubles: beyond 2^53 two seeds could be the same one.
    visit(Field{"seed", "1", "Seed of all random numbers.", 0, 9007199254740991.0}, s.setup.seed);
    visit(Field{"vars", "", "Values of the variables written ${name}."}, s.vars);
    visit(Field{"plugins", "",
                "Shared libraries with controllers: files relative to this one, or names in the search path.",
                0, 0, Field::none, 100},
          s.plugins);
    visit(
        Field{"teams", "",
              "Teams with controllers that drive all robots of the team; where given, a robot's team is one "
              "of them.",
              0, 0, Field::none, 1000},
        s.teams);
    visit(Field{"robots", "", "Robots of the scenario.", 0, 0, Field::none, 100'000}, s.robots);
    visit(Field{"things", "", "Models in the world that are not robots: walls, ramps, things to push.", 0, 0,
                Field::none, 100'000},
          s.things);
    visit(Field{"errors", "1", "Factor on the errors of all devices: 0 none, 1 as configured.", 0, 1000},
          s.setup.errors);
    visit(Field{"values", "", "Expressions over addresses, by name."}, s.values);
    visit(Field{"events", "", "Events that happen when a condition holds.", 0, 0, Field::none, 1000},
          s.events);
    visit(Field{"criterion", "",
                "What the run is judged by: an expression over addresses, or a map with value and success."},
          s.criterion);
    visit(Field{"log", "", "Values written to a CSV file."}, s.log);
    visit(Field{"record", "", "Recording of the run."}, s.setup.record);
    visit(
        Field{"ground_zones", "",
              "Parts of the ground with a surface of their own, seen from above; of several the last counts.",
              0, 0, Field::none, 1000},
        s.zones);
    visit(Field{"media", "",
                "Media between robots, such as sound: a list of maps with kind, name and the kind's keys."},
          s.media);
    visit(Field{"rules", "", "Rules of the world: a list of maps with kind, name and the kind's keys."},
          s.rules);
    visit(Field{"markers", "", "Areas on the ground: a list of maps with kind, name and the kind's keys."},
          s.markers);
    visit(Field{"poses", "", "Poses that have names: places to spawn at, to park, goals.", 0, 0, Field::none,
                10'000},
          s.poses);
    visit(Field{"share", "", "What remote programs see that are no administrators, besides what is theirs."},
          s.share);
    visit(Field{"include", "", "Files merged below this one."}, s.include);
  }
};

}  // namespace sandlot::formats::scenario_spec
