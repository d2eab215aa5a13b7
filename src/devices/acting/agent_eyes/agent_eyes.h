#pragma once
/// Eyes of a high-level agent: all robots and objects in sight with all their properties, as a simulator of agents gives them
/// instead of sensors.
///
/// Frame    the device's frame S: x forward, y left, z up. Poses and velocities are along its axes.
/// Output   level `objects`: sandlot_msgs/VisibleObjectArray: name, label, team, colour, pose, velocity, size, mass and the user's
///          own properties of each robot and object, the own robot left out, whose middle is within `range` and `fov`; of
///          those that cannot move only with `fixed`. Objects are in order of creation, properties in that of the scenario.
/// Sight    a ray to the middle of its bounds, or to one of four places at 0.8 of its extent to the left, right, top and bottom,
///          meets it first; or the middle ray meets nothing, as in a goal. Links of the own robot hide nothing. With
///          `through_walls`: whatever stands between.
/// Time     the end of the tick.
/// Noise    none: see the levels objects and world of cameras for detectors with errors.
/// Limits   sizes are those of the declared pose of all joints. On the engine planar, objects are upright prisms to rays.
/// Cost     five rays per object in range and view, none with through_walls; no picture is drawn.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::agent_eyes {

struct Spec {
  double range_m = 10, fov_rad = 6.283185307179586;
  bool through_walls = false, fixed = false;
  std::vector<std::string> labels;
  double rate_hz = 10;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"range", "m", "Farthest distance at which objects are seen.", 1e-3, 1e6, tunable}, s.range_m);
    visit(Field{"fov", "rad", "Angle of view from left to right.", 0.01, 6.2832, tunable}, s.fov_rad);
    visit(Field{"through_walls", "", "Whether objects are seen behind others.", 0, 1, tunable},
          s.through_walls);
    visit(Field{"fixed", "", "Whether objects that cannot move are reported, too."}, s.fixed);
    visit(Field{"labels", "", "Labels of the objects to report; none: all.", 0, 0, Field::none, 1000},
          s.labels);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct AgentEyes {
  using Spec = agent_eyes::Spec;
  using State = NoFields;
  Spec spec;
  State state;

  BodyId body;
  Pose X_LS;
  Topic<msg::VisibleObjectArray>* objects = nullptr;

  static Result<AgentEyes> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<AgentEyes> pool, const Context& context);
  /// @param self  the own robot; null: it has no bounds
  bool sees(const LabelledObject& target, const Pose& X_WS, Vec3 middle_W, const LabelledObject* self,
            const Context& context) const;
  /// The body that a ray to a place meets first, as far as `behind_m` behind it; none of `self`.
  std::uint32_t first_body(const Pose& X_WS, Vec3 place_W, double behind_m, const LabelledObject* self,
                           const Context& context) const;
};

extern const Kind kind;

}  // namespace sandlot::agent_eyes
