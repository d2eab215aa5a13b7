#pragma once
/// The world as files declare it: plain structs, resolved and checked, in SI. Nothing here changes during a run.
///
/// Frames: W world, M model, L link, C collision or visual, J joint, S sensor. `X_ML` is the pose of L in M.
///
/// Each struct has one list of its fields; snapshots hold them in the order of the list (model/model_bytes.h). Places
/// in files are not part of the value, so no list has them.
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/node.h"
#include "base/shared_list.h"
#include "base/time.h"
#include "geometry/color.h"
#include "geometry/pose.h"
#include "model/annotations.h"
#include "model/declarations.h"
#include "model/joint.h"
#include "model/light.h"
#include "model/link.h"
#include "model/recording.h"
#include "model/surface.h"

namespace sandlot::model {

/// A named frame attached to a link.
struct Frame {
  std::string name;
  std::uint32_t link = 0;
  Pose X_LF;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the frame."}, s.name);
    visit(Field{"link", "", "Index of the link."}, s.link);
    visit(Field{"pose", "", "Pose in the link."}, s.X_LF);
  }
};

struct Model {
  std::string name;  ///< as the file spells it
  bool is_static = false;
  bool self_collide = false;
  std::string label;
  std::vector<Link> links;  ///< [0] is the canonical link
  std::vector<Joint> joints;
  std::vector<Frame> frames;
  std::vector<LinkLight> lights;
  std::vector<DeviceDecl> devices;
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name in the file."}, s.name);
    visit(Field{"label", "", "Class that detectors report; empty: the name."}, s.label);
    visit(Field{"static", "", "Whether the model never moves."}, s.is_static);
    visit(Field{"self_collide", "", "Whether links of the model collide with each other."}, s.self_collide);
    visit(Field{"links", "", "Links, the canonical one first."}, s.links);
    visit(Field{"joints", "", "Joints."}, s.joints);
    visit(Field{"frames", "", "Named frames."}, s.frames);
    visit(Field{"lights", "", "Lights on links."}, s.lights);
    visit(Field{"devices", "", "Devices."}, s.devices);
  }

  std::optional<std::uint32_t> find_link(std::string_view name) const;
  std::optional<std::uint32_t> find_joint(std::string_view name) const;
};

/// A path that an instance follows whatever happens to it (SDF <actor>): it pushes and is not pushed.
struct Motion {
  struct Key {
    double time_s = 0;  ///< since the beginning of a round, ascending, the first at 0
    Pose X_WM;

    static void fields(auto& s, auto&& visit) {
      visit(Field{"time", "s", "Time since the beginning of a round; ascending, the first 0."}, s.time_s);
      visit(Field{"pose", "", "Pose in the world."}, s.X_WM);
    }
  };
  std::vector<Key> keys;  ///< at least one; between keys the pose is interpolated
  double delay_s = 0;     ///< before the first round; until then it stands at the first key
  bool loop = true;       ///< begin again after the last key, else stay there

  static void fields(auto& s, auto&& visit) {
    visit(Field{"keys", "", "Poses at times, interpolated in between."}, s.keys);
    visit(Field{"delay", "s", "Time before the first round."}, s.delay_s);
    visit(Field{"loop", "", "Whether the motion begins again after the last key."}, s.loop);
  }
};

/// A model placed in the world. Robots are instances that have devices or controllers.
struct Instance {
  std::string name;  ///< address: unique, sanitised
  std::string original_name;
  std::shared_ptr<const Model> model;
  Pose X_WM;
  bool is_robot = false;
  std::string team;
  std::string label;
  SharedList<DeviceDecl> devices;  ///< the model's own with the scenario's changes
  SharedList<ControllerDecl> controllers;
  std::optional<Motion> motion;
  double errors = 1;
  std::vector<PropertyDecl> properties;
  EntityInfo info;
  Place place;

  const PropertyDecl* find_property(std::string_view property) const {
    for (const PropertyDecl& each : properties)
      if (each.name == property) return &each;
    return nullptr;
  }

  /// All but the model, which instances share.
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Address: unique, without characters that addresses do not have."}, s.name);
    visit(Field{"original_name", "", "Name in the file."}, s.original_name);
    visit(Field{"pose", "", "Pose in the world at the start."}, s.X_WM);
    visit(Field{"robot", "", "Whether it is a robot."}, s.is_robot);
    visit(Field{"team", "", "Team of the robot."}, s.team);
    visit(Field{"label", "", "Class that detectors report, such as ball; empty: that of the model."},
          s.label);
    visit(Field{"errors", "1", "Factor on the errors of all its devices.", 0, 1000}, s.errors);
    visit(Field{"devices", "", "Devices of the model, with the changes of the scenario."}, s.devices);
    visit(Field{"controllers", "", "Control programs."}, s.controllers);
    visit(Field{"motion", "", "Path that it follows whatever happens to it."}, s.motion);
    visit(Field{"properties", "", "Properties of the user's own."}, s.properties);
    visit(Field{"info", "", "Category, description and tags."}, s.info);
  }
};

/// Where the world's origin lies on the Earth (SDF <spherical_coordinates>), for satellite receivers and compasses.
struct Geography {
  double latitude_rad = 0, longitude_rad = 0, elevation_m = 0;
  double heading_rad = 0;  ///< of the world's x axis, counter-clockwise from east

  static void fields(auto& s, auto&& visit) {
    visit(Field{"latitude", "rad", "Latitude of the world's origin."}, s.latitude_rad);
    visit(Field{"longitude", "rad", "Longitude of the world's origin."}, s.longitude_rad);
    visit(Field{"elevation", "m", "Height of the world's origin above the ellipsoid."}, s.elevation_m);
    visit(Field{"heading", "rad", "Direction of the world's x axis, counter-clockwise from east."},
          s.heading_rad);
  }
};

/// How long a tick is.
struct Clock {
  enum class Mode : std::uint8_t {
    fixed,       ///< Setup::step
    continuous,  ///< as long as computing the last one took, within these bounds
  } mode = Mode::fixed;
  Time min_step = Time::from_s(1e-4), max_step = Time::from_s(0.1);

  static void fields(auto& s, auto&& visit) {
    visit(Field{"mode", "", "Kind of clock."}, s.mode);
    visit(Field{"min_step", "s", "Shortest tick of a continuous clock."}, s.min_step);
    visit(Field{"max_step", "s", "Longest tick of a continuous clock."}, s.max_step);
  }
};

inline std::span<const EnumName<Clock::Mode>> enum_names(Clock::Mode) {
  using Mode = Clock::Mode;
  static constexpr EnumName<Mode> names[] = {{"fixed", Mode::fixed}, {"continuous", Mode::continuous}};
  return names;
}

/// The surroundings of the models of a world.
struct Environment {
  Vec3 gravity{0, 0, -9.81};
  Place gravity_place;  ///< without a file: no file gives it
  std::vector<Light> lights;
  Color ambient{0.4f, 0.4f, 0.4f, 1}, background{0.7f, 0.7f, 0.7f, 1};
  std::optional<Geography> geography;
  Vec3 magnetic_field_T{5.5645e-6, 22.8758e-6, -42.3884e-6};  ///< SDF's own default
};

/// Everything a Simulation is built from.
struct Setup : Environment {
  std::string name;
  std::string engine = "rigid";
  Node physics;  ///< read by the engine's spec
  Time step = Time::from_s(0.01);
  Clock clock;
  int substeps = 1;
  int control_interval = 1;
  std::uint64_t seed = 1;
  double errors = 1;
  std::optional<Time> stop;
  std::optional<Recording> record;
  std::vector<PluginDecl> plugins;
  std::vector<TeamDecl> teams;
  std::vector<Instance> instances;
  std::vector<ValueDecl> values;
  std::vector<EventDecl> events;
  std::optional<CriterionDecl> criterion;
  std::vector<std::string> addresses;
  std::optional<LogDecl> log;
  std::vector<SurfaceZone> zones;
  std::vector<ElementDecl> media, rules, markers;
  std::vector<NamedPose> poses;
  Sharing sharing;

  /// All but the instances, whose models are written apart, and `record` and `log`: outputs are not part of the run.
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the scenario or world."}, s.name);
    visit(Field{"engine", "", "Physics engine: rigid or planar."}, s.engine);
    visit(Field{"physics", "", "Keys of the engine."}, s.physics);
    visit(Field{"gravity", "m/s^2", "Acceleration of free fall in the world."}, s.gravity);
    visit(Field{"step", "s", "Length of a tick; of a continuous clock the first one's."}, s.step);
    visit(Field{"clock", "", "Kind of clock, with its limits."}, s.clock);
    visit(Field{"substeps", "1", "Physics steps per tick; a longer tick of a continuous clock has more."},
          s.substeps);
    visit(Field{"control_interval", "1", "Ticks from one control step to the next."}, s.control_interval);
    visit(Field{"seed", "1", "Seed of all random numbers."}, s.seed);
    visit(Field{"errors", "1", "Factor on the errors of all devices.", 0, 1000}, s.errors);
    visit(Field{"stop", "s", "Simulated time at which the run ends by itself."}, s.stop);
    visit(Field{"plugins", "", "Shared libraries with controllers."}, s.plugins);
    visit(Field{"teams", "", "Teams of robots."}, s.teams);
    visit(Field{"zones", "", "Parts of the ground with a surface of their own."}, s.zones);
    visit(Field{"lights", "", "Lights of the world."}, s.lights);
    visit(Field{"ambient", "1", "Light that comes from everywhere."}, s.ambient);
    visit(Field{"background", "1", "Colour of pictures where nothing is."}, s.background);
    visit(Field{"geography", "", "Where the world's origin lies on the Earth."}, s.geography);
    visit(Field{"magnetic_field", "T", "Magnetic field in the world."}, s.magnetic_field_T);
    visit(Field{"values", "", "Named expressions."}, s.values);
    visit(Field{"events", "", "Conditions that are events."}, s.events);
    visit(Field{"criterion", "", "What the run is judged by."}, s.criterion);
    visit(Field{"addresses", "", "Addresses in values and events; known even when their object is gone."},
          s.addresses);
    visit(Field{"media", "", "Media between robots."}, s.media);
    visit(Field{"rules", "", "Rules of the world."}, s.rules);
    visit(Field{"markers", "", "Areas on the ground."}, s.markers);
    visit(Field{"poses", "", "Poses that have names."}, s.poses);
    visit(Field{"sharing", "", "What clients see that are no administrators."}, s.sharing);
  }
};

}  // namespace sandlot::model
