/// Drives with wheels of any kind: from the names in a spec to joints, places and topics.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/text.h"
#include "devices/drives/wheeled_base.h"
#include "kinematics/skid.h"

namespace sandlot::wheeled {
namespace {

using model::JointType;

/// Radius of the largest round collision shape of a wheel link; 0 when there is none.
double round_shape_m(const model::Link& link) {
  double radius_m = 0;
  for (const model::Collision& collision : link.collisions) {
    if (const auto* s = std::get_if<Sphere>(&collision.shape)) radius_m = std::max(radius_m, s->radius_m);
    if (const auto* c = std::get_if<Cylinder>(&collision.shape)) radius_m = std::max(radius_m, c->radius_m);
    if (const auto* c = std::get_if<Capsule>(&collision.shape)) radius_m = std::max(radius_m, c->radius_m);
  }
  return radius_m;
}

Pose X_BJ(const model::Model& model, const model::Joint& joint) {
  return inverse(model.links[0].X_ML) * model.links[joint.child].X_ML * joint.X_CJ;
}

Result<std::uint32_t> turning_joint(const Base& base, const DeviceBuild& build, const std::string& name,
                                    const char* key) {
  SL_ASSIGN(const std::uint32_t index, build.joint_index(name, key));
  const JointType type = build.instance.model->joints[index].type;
  if (type != JointType::continuous && type != JointType::revolute)
    return build.error(key, "joint '" + name + "' does not turn",
                       std::string(base.noun) + " needs revolute or continuous joints");
  const auto taken = [&](const auto& each) { return each.joint == build.joints[index]; };
  if (std::any_of(base.wheels.begin(), base.wheels.end(), taken) ||
      std::any_of(base.pivots.begin(), base.pivots.end(), taken))
    return build.error(key, "joint '" + name + "' is named twice", "each wheel has a joint of its own");
  return index;
}

/// The pivot that carries a link, or -1.
int pivot_of(const Base& base, const model::Model& model, std::uint32_t link) {
  for (std::size_t steps = 0; steps < model.joints.size() && link != 0 && link != model::world_link;
       ++steps) {
    for (std::size_t i = 0; i < base.pivots.size(); ++i)
      if (base.pivots[i].link == link) return static_cast<int>(i);
    const auto above = std::find_if(model.joints.begin(), model.joints.end(),
                                    [&](const model::Joint& joint) { return joint.child == link; });
    if (above == model.joints.end()) break;
    link = above->parent;
  }
  return -1;
}

}  // namespace

Status add_pivots(Base& base, const DeviceBuild& build, std::span<const std::string> names, const char* key) {
  const model::Model& model = *build.instance.model;
  for (const std::string& name : names) {
    SL_ASSIGN(const std::uint32_t index, turning_joint(base, build, name, key));
    const model::Joint& joint = model.joints[index];
    const Pose X = X_BJ(model, joint);
    const double up = rotate(X.q, joint.axis_J).z;
    if (std::abs(up) < 0.9)
      return build.error(key, "the axis of joint '" + name + "' does not stand upright",
                         "steering joints turn about the z axis of the base");
    Pivot pivot{.joint = build.joints[index],
                .sign = up > 0 ? 1.0 : -1.0,
                .max_effort = joint.max_effort,
                .max_speed = joint.max_velocity,
                .x_m = X.p.x,
                .y_m = X.p.y,
                .link = joint.child,
                .name = name};
    if (joint.type == JointType::revolute) {
      pivot.lower = up > 0 ? joint.lower : -joint.upper;
      pivot.upper = up > 0 ? joint.upper : -joint.lower;
    }
    base.pivots.push_back(std::move(pivot));
  }
  return {};
}

Status add_wheels(Base& base, const DeviceBuild& build, const Common& spec,
                  std::span<const std::string> names, const char* key, const WheelOptions& options) {
  const model::Model& model = *build.instance.model;
  for (const std::string& name : names) {
    SL_ASSIGN(const std::uint32_t index, turning_joint(base, build, name, key));
    const model::Joint& joint = model.joints[index];
    const Pose X = X_BJ(model, joint);
    const Vec3 axis = rotate(X.q, joint.axis_J);
    if (options.across && std::abs(axis.y) < 0.9)
      return build.error(key, "the axis of joint '" + name + "' does not lie across the robot",
                         "wheels turn about the y axis of the base");
    if (std::abs(axis.z) > 0.3)
      return build.error(key, "the axis of joint '" + name + "' does not lie level",
                         "a wheel's axis is parallel to the ground");
    Wheel wheel{.joint = build.joints[index],
                .driven = options.driven,
                .max_effort = joint.max_effort,
                .max_speed = joint.max_velocity,
                .pivot = pivot_of(base, model, joint.parent),
                .has_rollers = joint.rollers.has_value(),
                .name = name};
    // A wheel that turns about its axis a rolls along a x z.
    if (options.across) wheel.sign = axis.y > 0 ? 1.0 : -1.0;
    else wheel.heading_rad = math::atan2(-axis.x, axis.y);
    double radius = spec.wheel_radius_m.value_or(joint.rollers ? joint.rollers->radius_m
                                                               : round_shape_m(model.links[joint.child]));
    if (radius <= 0)
      return build.error(key, "the wheel of joint '" + name + "' has no round collision shape",
                         "give wheel_radius");
    std::optional<double> roller = options.roller_rad;
    if (!options.ordinary && joint.rollers) roller = joint.rollers->angle_rad;
    kinematics::Wheel geometry = roller && !options.ordinary
                                     ? kinematics::roller_wheel(X.p.x, X.p.y, radius, wheel.heading_rad,
                                                                *roller)
                                     : kinematics::ordinary_wheel(X.p.x, X.p.y, radius, wheel.heading_rad);
    geometry.counted = options.driven;
    base.geometry.push_back(geometry);
    base.wheels.push_back(std::move(wheel));
  }
  return {};
}

void put_frame(Base& base, double x_m, double y_m) {
  base.dx_m = x_m;
  base.dy_m = y_m;
  for (kinematics::Wheel& wheel : base.geometry) wheel.x_m -= x_m, wheel.y_m -= y_m;
}

void put_frame_in_the_middle(Base& base) {
  double x = 0, y = 0;
  for (const kinematics::Wheel& wheel : base.geometry) x += wheel.x_m, y += wheel.y_m;
  const auto n = static_cast<double>(std::max<std::size_t>(1, base.geometry.size()));
  put_frame(base, x / n, y / n);
}

Result<Base> skid_base(const char* noun, const DeviceBuild& build, const Common& spec, const Sides& sides) {
  Base base{.noun = noun, .engine = build.engine};
  base.body = build.bodies[0];
  if (sides.left_joint.empty() != sides.right_joint.empty())
    return build.error(sides.left_joint.empty() ? "right_joint" : "left_joint", "one side has no joints",
                       "give left_joint and right_joint");
  const WheelOptions holds_along{.ordinary = false, .roller_rad = 0.5 * math::pi};
  SL_TRY(add_wheels(base, build, spec, sides.left_joint, "left_joint", holds_along));
  const std::size_t split = base.wheels.size();
  SL_TRY(add_wheels(base, build, spec, sides.right_joint, "right_joint", holds_along));
  double track = sides.track_m.value_or(0);
  if (base.wheels.empty()) {
    if (!(track > 0)) return build.error("track", "tracks without joints need a distance", "give track");
    for (const double side : {0.5, -0.5}) {
      base.wheels.push_back({.has_joint = false, .name = side > 0 ? "left" : "right"});
      base.geometry.push_back(kinematics::roller_wheel(0, side * track * sides.track_ratio.value_or(1),
                                                       spec.wheel_radius_m.value_or(0.1), 0, 0.5 * math::pi));
    }
    base.pivot_x_m = 0;
    return base;
  }
  // The middle between the middles of the sides, which may have different numbers of wheels.
  kinematics::Direction left{0, 0}, right{0, 0};
  for (std::size_t i = 0; i < base.geometry.size(); ++i) {
    const auto of_side = static_cast<double>(i < split ? split : base.geometry.size() - split);
    kinematics::Direction& side = i < split ? left : right;
    side.x += base.geometry[i].x_m / of_side;
    side.y += base.geometry[i].y_m / of_side;
  }
  put_frame(base, 0.5 * (left.x + right.x), 0.5 * (left.y + right.y));
  std::vector<double> along;
  for (const kinematics::Wheel& wheel : base.geometry) along.push_back(wheel.x_m);
  const double between = left.y - right.y;
  if (std::abs(between) < 1e-3)
    return build.error("left_joint", "the left and the right wheels have no distance between them",
                       "move them apart, left to +y and right to -y");
  if (between < 0)
    return build.error("left_joint", "the left wheels are not to the left of the right ones",
                       "exchange left_joint and right_joint");
  if (!(track > 0)) track = between;
  const double ratio = sides.track_ratio.value_or(kinematics::track_ratio(along, track));
  for (std::size_t i = 0; i < base.geometry.size(); ++i)
    base.geometry[i].y_m = (i < split ? 0.5 : -0.5) * track * ratio;
  base.pivot_x_m = 0;
  return base;
}

Status check_levels(const Base& base, std::uint32_t levels) {
  const std::string engine = base.engine.name;
  if (levels != 1u << ideal && levels != 1u << contact && levels != 1u << rollers)
    return Error{std::string(base.noun) + " runs at exactly one level", "give one of its levels"};
  if (levels == 1u << ideal) {
    if (base.engine.ideal_drives) return {};
    return Error{"the engine '" + engine + "' has no ideal drives", "use the level 'contact'"};
  }
  if (!base.engine.contact_drives)
    return Error{"the engine '" + engine + "' has no wheels that drive by contact",
                 "use the level 'ideal' or the engine 'rigid'"};
  for (const Wheel& wheel : base.wheels)
    if (!wheel.has_joint)
      return Error{std::string(base.noun) + " without joints moves on the level 'ideal' alone",
                   "name the wheels' joints in left_joint and right_joint"};
  if (levels == 1u << contact) return {};
  if (!base.engine.rollers)
    return Error{"the engine '" + engine + "' has no rollers under the wheels of " + base.noun,
                 "use the level 'contact' or 'ideal', or the engine 'rigid'"};
  for (const Wheel& wheel : base.wheels)
    if (!wheel.has_rollers)
      return Error{"the wheel of joint '" + wheel.name + "' has no rollers",
                   "give it some (sandlot:rollers), or use the level 'contact' or 'ideal'"};
  return {};
}

Status finish(Base& base, State& state, const DeviceBuild& build, const Common& spec, bool has_rollers) {
  for (std::size_t i = 0; i < base.wheels.size(); ++i) base.geometry[i].name = base.wheels[i].name.c_str();
  if (base.wheels.size() > 64)
    return Error{std::string(base.noun) + " has " + std::to_string(base.wheels.size()) + " wheels",
                 "64 are the most", build.decl.place};
  if (Status fine = kinematics::check(base.geometry, base.pivot_x_m); !fine) {
    fine.error().place = build.decl.place;
    return fine;
  }
  SL_TRY(check_levels(base, build.levels));
  if (spec.odometry == Odometry::kabsch &&
      std::any_of(base.geometry.begin(), base.geometry.end(), [](const auto& w) { return !w.ordinary; }))
    return build.error("odometry", "Kabsch needs wheels that hold across their heading",
                       "write 'odometry: least_squares'");
  state.wheels.resize(base.wheels.size());
  state.pivots.resize(base.pivots.size());
  base.energy = build.energy;
  if (base.energy) {
    base.energy->can_ride();
    for (const Wheel& wheel : base.wheels)
      if (wheel.has_joint && wheel.driven) base.energy->can_turn(wheel.joint);
    for (const Pivot& pivot : base.pivots) base.energy->can_turn(pivot.joint);
  }
  if (build.levels == 1u << rollers) state.handover = hand_wheels;
  base.turns.resize(base.wheels.size());
  base.running.resize(base.wheels.size());

  msg::JointState joints;
  joints.header.frame_id = build.frame_id();
  for (const Wheel& wheel : base.wheels) joints.name.push_back(wheel.name);
  for (const Pivot& pivot : base.pivots) joints.name.push_back(pivot.name);
  joints.position.resize(joints.name.size());
  joints.velocity.resize(joints.name.size());
  joints.effort.resize(joints.name.size());
  const char* const names[] = {"ideal", "contact", "rollers"};
  for (std::uint32_t level = 0; level < (has_rollers ? 3u : 2u); ++level) {
    const std::string name = names[level];
    base.command[level] = build.accept<msg::Twist>(level, name.c_str());
    base.wheel_command[level] = build.accept<msg::JointState>(level, (name + "/wheels").c_str());
    base.odometry[level] = build.publish<msg::Odometry>(level, name.c_str());
    base.odometry[level]->message.header.frame_id = build.instance.name + "/odom";
    base.odometry[level]->message.child_frame_id = build.instance.name + "/" +
                                                   build.instance.model->links[0].name;
    base.wheel_message[level] = build.publish<msg::JointState>(level, (name + "/wheels").c_str());
    base.wheel_message[level]->message = joints;
    if (spec.encoder_ticks == 0) continue;
    base.ticks[level] = build.publish<msg::Int64MultiArray>(level, (name + "/ticks").c_str());
    base.ticks[level]->message.data.resize(base.wheels.size());
  }
  base.maneuver = maneuver::make_topics(build,
                                        base.car ? std::optional(base.car->max_curvature()) : std::nullopt);
  return {};
}

void release(Drive drive, const Context& context) {
  context.actuation.drives.push_back({.base = drive.base.body, .active = false});
  for (const Wheel& wheel : drive.base.wheels) {
    if (wheel.has_joint) context.actuation.joints.push_back({.joint = wheel.joint});
    if (wheel.has_rollers) context.actuation.wheels.push_back({.wheel = wheel.joint, .rollers = false});
  }
  for (const Pivot& pivot : drive.base.pivots) context.actuation.joints.push_back({.joint = pivot.joint});
}

bool fits(const Base& base, const State& state) {
  return state.wheels.size() == base.wheels.size() && state.pivots.size() == base.pivots.size();
}

}  // namespace sandlot::wheeled
