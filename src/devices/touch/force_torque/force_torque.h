#pragma once
/// Force-torque sensor in a joint: force and torque that the two links exert on each other through it.
///
/// Frame    acts at the joint's origin. Axes by `frame`: `child` (the default) those of the child link,
///          `parent` of the parent link, `sensor` of the device's own pose on the child link.
/// Output   level `wrench`: geometry_msgs/WrenchStamped [N, Nm]. `direction`: child_to_parent (the default):
///          what the child does to the parent, so a sensor that carries a load at rest reads its weight,
///          downwards; parent_to_child: the opposite.
/// Time     means over the interval since the previous sample, as the filter of a real sensor gives.
/// Noise    noise/channel_noise.h for each axis of force and torque.
/// Limits   no cross-talk between axes, hysteresis or overload. What the motor of the joint puts in is part
///          of the load, as in a real joint. On a base that moves on rails (a drive's level ideal) joints
///          that move carry only what the rails leave to them. Of a fixed joint in a ring of fixed joints the
///          load is not determined.
/// Cost     the engine's: physics/rigid/loads.cpp; two rotations per sub-step.
/// Errors   a joint that is not there; an engine that does not report loads.
/// Source   SDF 1.9 <force_torque>.
#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/axes_noise.h"

namespace sandlot::force_torque {

enum class Axes : std::uint8_t { child, parent, sensor };
inline std::span<const EnumName<Axes>> enum_names(Axes) {
  static constexpr EnumName<Axes> names[] = {
      {"child", Axes::child}, {"parent", Axes::parent}, {"sensor", Axes::sensor}};
  return names;
}
enum class Direction : std::uint8_t { child_to_parent, parent_to_child };
inline std::span<const EnumName<Direction>> enum_names(Direction) {
  static constexpr EnumName<Direction> names[] = {{"child_to_parent", Direction::child_to_parent},
                                                  {"parent_to_child", Direction::parent_to_child}};
  return names;
}

struct Spec {
  std::string joint;
  Axes frame = Axes::child;
  Direction direction = Direction::child_to_parent;
  AxesNoiseSpec force, torque;
  double rate_hz = 100;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"joint", "", "Name of the joint.", 0, 0, Field::required, 1000}, s.joint);
    visit(Field{"frame", "", "Frame of the measured components."}, s.frame);
    visit(Field{"direction", "", "Link that acts, and link that is acted on."}, s.direction);
    visit(Field{"force", "", "Errors of the forces [N]."}, s.force);
    visit(Field{"torque", "", "Errors of the torques [Nm]."}, s.torque);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct State {
  Vec3 impulse, turning;  ///< [N s], [Nm s] in the axes shown, parent on child, since the previous sample
  double counted_s = 0;
  AxesNoise force, torque;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"impulse", "N s", "Force integrated since the previous sample."}, s.impulse);
    visit(Field{"turning", "Nm s", "Torque integrated since the previous sample."}, s.turning);
    visit(Field{"counted", "s", "Time since the previous sample."}, s.counted_s);
    visit(Field{"force", "N", "Errors of the forces."}, s.force);
    visit(Field{"torque", "Nm", "Errors of the torques."}, s.torque);
  }
};

struct Sensor {
  using Spec = force_torque::Spec;
  using State = force_torque::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  JointId joint;
  std::uint32_t child = 0, parent = ~0u;  ///< bodies; no parent: the world
  Quat q_CJ, q_SC;                        ///< the child's axes in the sensor's
  Topic<msg::WrenchStamped>* wrench = nullptr;

  static Result<Sensor> create(const DeviceBuild& build, Spec spec);
  static void pre_substep(PoolView<Sensor> pool, const Context& context, double h_s);
  static void post_substep(PoolView<Sensor> pool, const Context& context, double h_s);
  static void sense(PoolView<Sensor> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::force_torque
