#pragma once
/// The world as files declare it: plain structs, resolved and checked, in SI. Nothing here changes during a run.
///
/// Frames: W world, M model, L link, C collision or visual, J joint, S sensor. `X_ML` is the pose of L in M.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/node.h"
#include "base/shared_list.h"
#include "base/time.h"
#include "geometry/color.h"
#include "geometry/pose.h"
#include "geometry/shape.h"
#include "model/recording.h"
#include "model/surface.h"
#include "model/wheel.h"

namespace sandlot::model {

struct Inertial {
  double mass_kg = 1;
  Pose X_LCo;             ///< centre of mass, axes of the tensor below
  Vec3 moments{1, 1, 1};  ///< [kg m^2] ixx iyy izz about Co
  Vec3 products;          ///< [kg m^2] ixy ixz iyz
};

/// What a visual looks like. PBR and scripts of materials are reduced to this.
struct Material {
  Color diffuse;  ///< times the texture, if there is one
  Color specular{0, 0, 0, 1}, emissive{0, 0, 0, 1};
  float shininess = 0;    ///< exponent of the highlight; 0: matt
  std::string texture;    ///< file of the colour texture; "" for none
  bool from_mesh = true;  ///< a mesh shows its own colours: the file said nothing of a material
};

struct Collision {
  std::string name;
  Pose X_LC;
  Shape shape;
  Surface surface;
  Place place;
};

struct Visual {
  std::string name;
  Pose X_LC;
  Shape shape;
  Material material;
  bool cast_shadows = true;
  Place place;
};

struct Link {
  std::string name;
  Pose X_ML;
  Inertial inertial;
  std::vector<Collision> collisions;
  std::vector<Visual> visuals;
  bool gravity = true;
  Place place;
};

/// A universal joint turns about `axis_J` and then about `second->axis_J`; a screw turns and slides along one axis.
enum class JointType : std::uint8_t { fixed, revolute, continuous, prismatic, ball, universal, screw };

/// One axis of a joint follows another joint of the model: position = multiplier * (leader - reference) + offset.
struct Mimic {
  std::uint32_t joint = 0;  ///< index of the leader
  double multiplier = 1, offset = 0, reference = 0;
};

/// The second axis of a universal joint. It is passive: it can be limited and damped, not driven or read.
struct SecondAxis {
  Vec3 axis_J{0, 1, 0};                ///< unit, in J, across the first
  double lower = -1e16, upper = 1e16;  ///< [rad]
  double damping = 0, friction = 0;    ///< [Nm s/rad], [Nm]
};

/// Joins child to parent. The joint frame J is fixed in the child; positions are 0 in the declared pose.
struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  std::uint32_t parent = 0;  ///< index of the link, or world_link
  std::uint32_t child = 0;
  Pose X_CJ;                           ///< J in the child link
  Vec3 axis_J{0, 0, 1};                ///< unit, in J
  double lower = -1e16, upper = 1e16;  ///< [rad] or [m]
  double max_effort = 1e16;            ///< [Nm] or [N]
  double max_velocity = 1e16;          ///< [rad/s] or [m/s]
  double damping = 0, friction = 0;    ///< [Nm s/rad], [Nm] (prismatic: [N s/m], [N])
  double spring_stiffness = 0, spring_reference = 0;
  double thread_pitch_m = 0;         ///< of a screw: slide per turn, right-handed when positive
  std::optional<SecondAxis> second;  ///< of universal joints only
  std::optional<Mimic> mimic;
  std::optional<RollerWheel> rollers;  ///< about axis_J
  std::uint32_t roller_of = no_joint;  ///< of a roller: the joint of its wheel
  Place place;
  static constexpr std::uint32_t no_joint = ~0u;
};
inline constexpr std::uint32_t world_link = ~0u;

/// Directional and spot lights shine along -z of their frame.
struct Light {
  enum class Type : std::uint8_t { directional, point, spot } type = Type::directional;
  std::string name;
  Pose X_PLight;  ///< P: the world, or the link that carries it
  Color color;    ///< times the intensity
  Color specular{0, 0, 0, 1};
  bool cast_shadows = false;
  double range_m = 10;  ///< of point and spot lights: dark beyond
  double constant = 1, linear = 0,
         quadratic = 0;  ///< attenuation = 1 / (constant + linear d + quadratic d^2)
  double inner_rad = 0, outer_rad = 0, falloff = 1;  ///< of spot lights: full within, dark without
};

/// A light on a link.
struct LinkLight {
  std::uint32_t link = 0;
  Light light;
};

/// A named frame attached to a link.
struct Frame {
  std::string name;
  std::uint32_t link = 0;
  Pose X_LF;
};

/// A device as a file declares it. `kind` is Sandlot's name for it; a declaration taken from SDF leaves it empty
/// and lists what the file called it (`sensor:gpu_lidar`, `plugin:DiffDrive`), most specific first.
struct DeviceDecl {
  std::string name;
  std::string kind;
  std::vector<std::string> sdf_types;
  std::string
      scope;  ///< of a part of a composed model, such as "arm::": names in `config` are looked up there first
  std::uint32_t link = 0;
  Pose X_LS;
  Node config;  ///< keys of the kind's spec, or the SDF element's children when `kind` is empty
  Place place;
};

struct Model {
  std::string name;  ///< as the file spells it
  bool is_static = false;
  bool self_collide = false;
  std::string label;        ///< what detectors call it; "": its name
  std::vector<Link> links;  ///< [0] is the canonical link
  std::vector<Joint> joints;
  std::vector<Frame> frames;
  std::vector<LinkLight> lights;
  std::vector<DeviceDecl> devices;
  Place place;

  std::optional<std::uint32_t> find_link(std::string_view name) const;
  std::optional<std::uint32_t> find_joint(std::string_view name) const;
};

struct ControllerDecl {
  std::string name;  ///< unique within its robot; "controller" by default
  std::string kind;
  Node config;
  Place place;
};

/// A shared library with controllers of the user's own.
struct PluginDecl {
  std::string file;
  std::string name;        ///< as the library calls itself; known once it is loaded
  std::uint64_t hash = 0;  ///< of the file's bytes, so that a snapshot notices another build
  Place place;
};

/// A path that an instance follows whatever happens to it (SDF <actor>): it pushes and is not pushed.
struct Motion {
  struct Key {
    double time_s;  ///< since the beginning of a round, ascending, the first at 0
    Pose X_WM;
  };
  std::vector<Key> keys;  ///< at least one; between keys the pose is interpolated
  double delay_s = 0;     ///< before the first round; until then it stands at the first key
  bool loop = true;       ///< begin again after the last key, else stay there
};

/// A model placed in the world. Robots are instances that have devices or controllers.
struct Instance {
  std::string name;  ///< address: unique, sanitised
  std::string original_name;
  std::shared_ptr<const Model> model;
  Pose X_WM;
  bool is_robot = false;
  std::string team;
  std::string label;               ///< what detectors call it: "ball"; "" for its model's label
  SharedList<DeviceDecl> devices;  ///< the model's own with the scenario's changes
  SharedList<ControllerDecl> controllers;
  std::optional<Motion> motion;
  double errors = 1;  ///< factor on the errors of all its devices
  Place place;
};

/// Where the world's origin lies on the Earth (SDF <spherical_coordinates>), for satellite receivers and compasses.
struct Geography {
  double latitude_rad = 0, longitude_rad = 0, elevation_m = 0;
  double heading_rad = 0;  ///< of the world's x axis, counter-clockwise from east
};

/// How long a tick is.
struct Clock {
  enum class Mode : std::uint8_t {
    fixed,       ///< Setup::step
    continuous,  ///< as long as computing the last one took, within these bounds
  } mode = Mode::fixed;
  Time min_step = Time::from_s(1e-4), max_step = Time::from_s(0.1);
};

/// A value that a scenario names: an expression over addresses (sim/watch/expression.h).
struct ValueDecl {
  std::string name;
  std::string expression;
  Place place;
};

/// Something that happens when a condition has held for a while.
struct EventDecl {
  std::string name;
  std::string when;  ///< an expression; other than 0: it holds
  Time hold;         ///< how long it must hold without a break
  bool once = false;
  bool stop = false;  ///< it ends the run
  Place place;
};

/// Values written to a CSV file while the run goes on. No part of a snapshot: what goes on from one starts another file.
struct LogDecl {
  std::string file;
  double rate_hz = 0;  ///< 0: every tick
  struct Column {
    std::string expression;
    Place place;
  };
  std::vector<Column> values;
  Place place;
};

/// Everything a Simulation is built from.
struct Setup {
  std::string name;
  std::string engine = "rigid";    ///< "rigid" or "planar"
  Node physics;                    ///< further keys of `physics:`, read by the engine's spec
  Vec3 gravity{0, 0, -9.81};       ///< [m/s^2]
  Place gravity_place;             ///< where a file gives it; nowhere when none does
  Time step = Time::from_s(0.01);  ///< length of a tick; of a continuous clock the first one's
  Clock clock;
  int substeps = 1;          ///< physics steps per tick; a longer tick of a continuous clock has more
  int control_interval = 1;  ///< ticks between control steps
  std::uint64_t seed = 1;
  double errors = 1;                ///< factor on the errors of all devices
  std::optional<Time> stop;         ///< simulated time at which the run ends by itself
  std::optional<Recording> record;  ///< how the run is to be recorded: no part of it, nor of its snapshots
  std::vector<PluginDecl> plugins;
  std::vector<Instance> instances;
  std::vector<ValueDecl> values;
  std::vector<EventDecl> events;
  std::vector<std::string>
      addresses;  ///< that values and events use: known although what they name may be gone
  std::optional<LogDecl> log;
  std::vector<SurfaceZone> zones;
  std::vector<Light> lights;
  Color ambient{0.4f, 0.4f, 0.4f, 1}, background{0.7f, 0.7f, 0.7f, 1};
  std::optional<Geography> geography;
  Vec3 magnetic_field_T{5.5645e-6, 22.8758e-6, -42.3884e-6};  ///< SDF's own default
};

}  // namespace sandlot::model
