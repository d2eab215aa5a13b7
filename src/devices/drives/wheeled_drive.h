#pragma once
/// The pool device of a drive: devices/drives/wheeled_base.h for a kind K with
///   struct K { using Spec = ...;  static constexpr bool has_rollers;  static Result<Base> build(const
///   DeviceBuild&, const Spec&); };
#include "devices/drives/wheeled_base.h"

namespace sandlot::wheeled {

template <class K>
struct Device {
  using Spec = typename K::Spec;
  using State = wheeled::State;
  Spec spec;
  State state;
  Boxed<maneuver::Late> late;
  Base base;

  static Result<Device> create(const DeviceBuild& build, Spec spec) {
    Device device{std::move(spec)};
    SL_ASSIGN(device.base, K::build(build, device.spec));
    SL_TRY(finish(device.base, device.state, build, device.spec, K::has_rollers));
    return device;
  }
  bool fits() const { return wheeled::fits(base, state) && maneuver::fits(late, base.wheels.size()); }
  wheeled::Drive parts() { return {spec, state, late, base}; }

  static void actuate(PoolView<Device> pool, const Context& context) {
    for (const std::uint32_t i : pool.due) wheeled::actuate(pool.all[i].parts(), pool.levels[i], context);
  }
  static void pre_substep(PoolView<Device> pool, const Context& context, double h_s) {
    for (const std::uint32_t i : pool.due)
      wheeled::pre_substep(pool.all[i].parts(), pool.levels[i], context, h_s);
  }
  static void post_substep(PoolView<Device> pool, const Context& context, double h_s) {
    for (const std::uint32_t i : pool.due)
      wheeled::post_substep(pool.all[i].parts(), pool.levels[i], context, h_s);
  }
  static void sense(PoolView<Device> pool, const Context& context) {
    for (const std::uint32_t i : pool.due) wheeled::sense(pool.all[i].parts(), pool.levels[i], context);
  }
  void release(const Context& context) { wheeled::release(parts(), context); }
  Status switch_level(std::uint32_t before, std::uint32_t after, const Context& context) {
    return wheeled::switch_level(parts(), before, after, context);
  }
};

/// The levels of drives, for their Kinds: the third is that of wheels with rollers.
inline constexpr LevelInfo levels[] = {
    {"ideal", msg::Odometry::ros_type, msg::Twist::ros_type, "The base moves as commanded, as if on rails."},
    {"contact", msg::Odometry::ros_type, msg::Twist::ros_type,
     "Motors turn the wheels, friction moves the robot."},
    {"rollers", msg::Odometry::ros_type, msg::Twist::ros_type,
     "Motors and friction as at level contact, with every roller as a separate body."},
};
inline constexpr std::span<const LevelInfo> plain_levels{levels, 2}, roller_levels{levels, 3};

}  // namespace sandlot::wheeled
