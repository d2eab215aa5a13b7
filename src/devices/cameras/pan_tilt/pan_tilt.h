#pragma once
/// Pan-tilt unit: turns a camera about two joints, or one, to angles, to a point, or after a thing.
///
/// Levels   `joints` (the default): sensor_msgs/JointState; `position` [rad] turns there, else `velocity`
///          [rad/s] goes on turning. Joints by name; without names pan comes first. `view`:
///          geometry_msgs/PointStamped: look at a point in
///          `world` (or ""), or in the frame of a link of the own robot ("robot1/base_link"; "robot1": its
///          canonical link). std_msgs/String: "search ball" scans from limit to limit, one row of
///          `search_tilts` after the other, until the camera's objects hold a ball, and looks at it; "track
///          ball" keeps it in the middle, and searches when it was lost for `lost_after`; "stop". Exactly one
///          level is active.
/// Camera   `camera` names a camera of the robot on the tilted link: its x axis is what is turned to the
///          point, and its level `objects` must be active for search and track. Without it the child link's x
///          axis is turned.
/// Zoom     of a camera with a zoom lens (devices/cameras/zoom.h), whose speed and limits hold.
///          std_msgs/Float64 at either level goes on to the camera. At level `view` the unit zooms by itself
///          where set: to `search_zoom` while it searches, and to `zoom_per_m` times the distance of what it
///          looks at or tracks, which then keeps its size in the picture.
/// Output   <device>/state: sensor_msgs/JointState; <device>/status: sandlot_msgs/PanTiltState. Every tick.
/// Control  once per sub-step: each joint's speed follows sqrt(2 a |error|), at most its largest speed, with
///          at most its largest acceleration; the engine holds the joint to that speed. Angles are cut to the
///          joint's limits; a joint that can turn all around takes the shorter way.
/// Engines  both. On planar a vertical pan joint is a pivot, a tilt joint kinematic: it follows its command
///          exactly.
/// Switch   what was turned to last is held. Before the first command it holds where it is.
/// Limits   one thing at a time: of several of a label the one nearest to the last is tracked. Aiming takes
///          the axes as perpendicular.
/// Cost     a few dozen operations per tick; no allocation after the first messages.
/// Errors   joints that are not there or do not turn, no joint at all, a camera that is not there, zoom keys
///          without a zoom lens.
#include <array>

#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::pan_tilt {

struct Spec {
  std::string pan_joint, tilt_joint, camera;
  double max_pan_speed_radps = 2, max_tilt_speed_radps = 2, max_acceleration_radps2 = 20, max_effort_Nm = 1e9;
  double search_speed_radps = 1, lost_after_s = 1;
  std::vector<double> search_tilts{0.0};
  double search_zoom = 0, zoom_per_m = 0;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"pan_joint", "", "Name of the joint that turns left and right.", 0, 0, Field::none, 1000},
          s.pan_joint);
    visit(Field{"tilt_joint", "", "Name of the joint that turns up and down.", 0, 0, Field::none, 1000},
          s.tilt_joint);
    visit(Field{"camera", "", "Name of the robot's camera that is turned.", 0, 0, Field::none, 1000},
          s.camera);
    visit(Field{"max_pan_speed", "rad/s", "Largest speed of the pan joint, within the joint's own limit.",
                1e-3, 1e3, tunable},
          s.max_pan_speed_radps);
    visit(Field{"max_tilt_speed", "rad/s", "Largest speed of the tilt joint, within the joint's own limit.",
                1e-3, 1e3, tunable},
          s.max_tilt_speed_radps);
    visit(Field{"max_acceleration", "rad/s^2", "Largest acceleration of both joints.", 1e-3, 1e5, tunable},
          s.max_acceleration_radps2);
    visit(
        Field{"max_effort", "Nm", "Largest effort of both joints, within their own limits.", 0, 1e9, tunable},
        s.max_effort_Nm);
    visit(Field{"search_speed", "rad/s", "Speed of the pan joint during a search.", 1e-3, 1e3, tunable},
          s.search_speed_radps);
    visit(Field{"search_tilts", "rad", "Angles of the tilt joint during a search, in turn.", -7, 7,
                Field::none, 100, 1},
          s.search_tilts);
    visit(Field{"search_zoom", "1", "Zoom during a search; 0: unchanged.", 0, 1000, tunable}, s.search_zoom);
    visit(
        Field{
            "zoom_per_m", "1/m",
            "Zoom per metre of distance to the target, which so keeps its size in the picture; 0: unchanged.",
            0, 1e4, tunable},
        s.zoom_per_m);
    visit(Field{"lost_after", "s", "Time without a sight after which the tracked object counts as lost.", 0,
                1e6, tunable},
          s.lost_after_s);
  }
};

enum Level : std::uint32_t { joints, view };
enum class Task : std::uint8_t { hold, look, search, track };
inline constexpr EnumName<Task> task_names[] = {
    {"hold", Task::hold}, {"look", Task::look}, {"search", Task::search}, {"track", Task::track}};
constexpr std::span<const EnumName<Task>> enum_names(Task) { return task_names; }

struct AxisState {
  bool turns_on = false;  ///< at `target` [rad/s], else to `target` [rad]
  double target = 0, speed = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"turns_on", "", "Whether the joint goes on turning."}, s.turns_on);
    visit(Field{"target", "", "Target angle, or target speed of a joint that goes on turning."}, s.target);
    visit(Field{"speed", "rad/s", "Speed commanded to the engine."}, s.speed);
  }
};

struct State {
  bool begun = false, out_of_reach = false;
  Task task = Task::hold;
  std::array<std::uint64_t, 4> taken{};  ///< commands seen: joints, point, text, zoom
  std::uint64_t looked = 0;              ///< messages of the camera seen
  std::string label;
  std::int32_t link = -1;  ///< whose frame `point` is in; -1: the world
  Vec3 point;
  bool sighted = false;
  Time sighted_at;
  std::uint32_t row = 0;  ///< of the search; every other one runs back
  AxisState pan, tilt;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"begun", "", "Whether the device holds its joints."}, s.begun);
    visit(Field{"out_of_reach", "", "Whether joint limits keep the view from the point."}, s.out_of_reach);
    visit(Field{"task", "", "Current task."}, s.task);
    visit(Field{"taken", "1", "Number of commands seen."}, s.taken);
    visit(Field{"looked", "1", "Number of messages of the camera seen."}, s.looked);
    visit(Field{"label", "", "Label of the object that is searched or tracked.", 0, 0, Field::none, 100},
          s.label);
    visit(Field{"link", "1", "Link whose frame the point is in; -1: the world."}, s.link);
    visit(Field{"point", "m", "Point that the camera looks at."}, s.point);
    visit(Field{"sighted", "", "Whether the object that is searched or tracked has been seen."}, s.sighted);
    visit(Field{"sighted_at", "ns", "Time at which the object was last seen."}, s.sighted_at);
    visit(Field{"row", "1", "Current row of the search."}, s.row);
    visit(Field{"pan", "", "State of the pan joint."}, s.pan);
    visit(Field{"tilt", "", "State of the tilt joint."}, s.tilt);
  }
};

struct Unit {
  using Spec = pan_tilt::Spec;
  using State = pan_tilt::State;
  Spec spec;
  State state;

  struct Axis {
    bool there = false;
    JointId id;
    std::uint32_t child = 0;  ///< index of the body
    Pose X_CJ;
    Vec3 axis_J;
    double lower = 0, upper = 0, max_effort = 0, max_velocity = 0;
    std::string name;
  };
  Axis pan, tilt;
  EnergyMeter* energy = nullptr;  ///< draws its mechanical work (devices/energy.h)
  std::uint32_t eye_body = 0;
  Pose X_LE;  ///< the eye on its link
  std::string objects_topic, robot;
  std::string zoom_topic;             ///< of the camera; empty: it has no zoom lens
  DeviceOrder* zoom_order = nullptr;  ///< to the camera; null likewise
  double longest_zoom = 1;
  std::vector<std::pair<std::string, std::uint32_t>> frames;  ///< names of links, and their bodies
  Topic<msg::JointState>* joints_command = nullptr;
  Topic<msg::PointStamped>* point_command = nullptr;
  Topic<msg::String>* text_command = nullptr;
  Topic<msg::Float64>* zoom_command = nullptr;  ///< null: the camera has no zoom lens
  Topic<msg::JointState>* joint_state = nullptr;
  Topic<msg::PanTiltState>* status = nullptr;

  static Result<Unit> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Unit> pool, const Context& context);
  static void pre_substep(PoolView<Unit> pool, const Context& context, double h_s);
  static void sense(PoolView<Unit> pool, const Context& context);
  void release(const Context& context);
  Status switch_level(std::uint32_t before, std::uint32_t after, const Context& context);
  bool fits() const { return state.link >= -1 && state.link < static_cast<std::int32_t>(frames.size()); }
};

extern const Kind kind;

}  // namespace sandlot::pan_tilt
