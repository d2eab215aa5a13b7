#include "devices/cameras/pan_tilt/pan_tilt.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/math.h"
#include "devices/cameras/zoom.h"

namespace sandlot::pan_tilt {
namespace {

constexpr double arrived_rad = 0.01;

Status check_levels(std::uint32_t levels) {
  if (std::popcount(levels) == 1) return {};
  return Error{"a pan-tilt unit runs at exactly one level", "give 'joints' or 'view'"};
}

Result<Unit::Axis> axis_of(const DeviceBuild& build, const std::string& name, const char* key) {
  Unit::Axis axis;
  if (name.empty()) return axis;
  SL_ASSIGN(const std::uint32_t index, build.joint_index(name, key));
  const model::Joint& joint = build.instance.model->joints[index];
  if (joint.type != model::JointType::revolute && joint.type != model::JointType::continuous) {
    return build.error(key, "joint '" + name + "' does not turn",
                       "a pan-tilt unit needs revolute or continuous joints");
  }
  const bool bounded = joint.type == model::JointType::revolute;
  axis = {true,
          build.joints[index],
          build.bodies[joint.child].index,
          joint.X_CJ,
          joint.axis_J,
          bounded ? joint.lower : -1e16,
          bounded ? joint.upper : 1e16,
          joint.max_effort,
          joint.max_velocity,
          name};
  return axis;
}

/// Devices of a module are called by the module's name and theirs: in the module "head" `eye` means head_eye.
Result<const model::DeviceDecl*> camera_of(const DeviceBuild& build, const std::string& name) {
  std::string prefix;
  for (const char c : build.decl.scope)
    if (c != ':') prefix += c;
    else if (prefix.back() != '_') prefix += '_';
  std::vector<std::string> names;
  for (const std::string& wanted : {prefix + name, name})
    for (const model::DeviceDecl& each : build.instance.devices) {
      if (each.name == wanted) return &each;
      names.push_back(each.name);
    }
  return build.error("camera", "'" + build.instance.name + "' has no device '" + name + "'",
                     suggestion(name, names));
}

Vec3 axis_W(const Unit::Axis& axis, const Context& context) {
  return rotate(context.engine.states()[axis.child].X_WB.q, rotate(axis.X_CJ.q, axis.axis_J));
}

/// The angle that is `turn` from where the joint is: the one within its limits, the nearer one of two.
/// @return false: it was cut to a limit
bool aim(const Unit::Axis& axis, const JointState& joint, double turn, AxisState& state) {
  if (!axis.there) return std::abs(turn) < arrived_rad;
  state.turns_on = false;
  double wanted = joint.position + turn;
  for (const double round : {0.0, math::tau, -math::tau})
    if (wanted + round >= axis.lower && wanted + round <= axis.upper)
      return state.target = wanted + round, true;
  state.target = std::clamp(wanted, axis.lower, axis.upper);
  return false;
}

const JointState& joint_of(const Unit::Axis& axis, const Context& context) {
  static constexpr JointState none{};
  return axis.there ? context.engine.joint_states()[axis.id.index] : none;
}

Pose eye_pose(const Unit& unit, const Context& context) {
  return context.engine.states()[unit.eye_body].X_WB * unit.X_LE;
}

/// The latest command to the camera's zoom; null: it has no zoom lens or has failed.
const Topic<msg::Float64>* zoom_command(const Unit& unit, Time now) {
  return unit.zoom_order ? topic_cast<msg::Float64>(unit.zoom_order->latest(now)) : nullptr;
}

void zoom_to(const Unit& unit, double wanted, const Context& context) {
  const Time now = context.now - context.tick;
  const Topic<msg::Float64>* const slot = zoom_command(unit, now);
  wanted = std::clamp(wanted, 1.0, unit.longest_zoom);
  if (!slot || (slot->count > 0 && slot->message.data == wanted)) return;
  unit.zoom_order->give(msg::Float64{wanted}, now);
}

/// @return [0]: the zoom, [1]: what it shall become
std::array<double, 2> zoom_of(const Unit& unit, const Context& context) {
  if (unit.zoom_topic.empty() || !context.topics) return {1, 1};
  const auto* const now = topic_cast<msg::Float64>(context.topics->find_topic(unit.zoom_topic));
  const double zoom = now && now->count > 0 ? now->message.data : 1;
  const Topic<msg::Float64>* const command = zoom_command(unit, context.now);
  return {zoom,
          command && command->count > 0 ? std::clamp(command->message.data, 1.0, unit.longest_zoom) : zoom};
}

/// Turns both joints so that the eye's x axis comes to the point. In the frame F of the axes (y: tilt, z:
/// pan) the two angles are azimuth and elevation; the camera moves a little as it turns, so this is done
/// again in every tick.
void look_at(Unit& unit, Vec3 point_W, const Context& context) {
  const Pose X_WE = eye_pose(unit, context);
  const Vec3 ahead = rotate(X_WE.q, {1, 0, 0});
  Vec3 z = unit.pan.there ? axis_W(unit.pan, context) : Vec3{};
  Vec3 y = unit.tilt.there ? axis_W(unit.tilt, context) : cross(z, ahead);
  if (!unit.pan.there) z = cross(ahead, y);
  z = normalised(z, {0, 0, 1});
  y = normalised(y - z * dot(y, z), {0, 1, 0});
  const Vec3 x = cross(y, z);
  const Vec3 wanted = normalised(point_W - X_WE.p, ahead);
  const auto azimuth = [&](Vec3 d) { return math::atan2(dot(d, y), dot(d, x)); };
  const auto elevation = [&](Vec3 d) { return math::asin(std::clamp(dot(d, z), -1.0, 1.0)); };
  double turn = azimuth(wanted) - azimuth(ahead);
  turn -= math::tau * std::round(turn / math::tau);
  // Straight above or below there is no azimuth: pan stays.
  if (std::abs(dot(wanted, z)) > 1 - 1e-9) turn = 0;
  const bool pan = aim(unit.pan, joint_of(unit.pan, context), turn, unit.state.pan);
  // A turn about y lowers what lies along x and raises what lies behind: with a pan axis that points down,
  // the eye does.
  const double down = dot(ahead, x) < 0 ? -1 : 1;
  const bool tilt = aim(unit.tilt, joint_of(unit.tilt, context),
                        down * (elevation(ahead) - elevation(wanted)), unit.state.tilt);
  unit.state.out_of_reach = !(pan && tilt);
}

void take_joints(Unit& unit) {
  const msg::JointState& message = unit.joints_command->message;
  const auto take = [&](const Unit::Axis& axis, std::size_t place, AxisState& state) {
    if (!axis.there) return;
    std::size_t i = place;
    if (!message.name.empty()) {
      i = static_cast<std::size_t>(std::find(message.name.begin(), message.name.end(), axis.name) -
                                   message.name.begin());
      if (i == message.name.size()) return;
    }
    if (i < message.position.size() && std::isfinite(message.position[i])) {
      state.turns_on = false;
      state.target = std::clamp(message.position[i], axis.lower, axis.upper);
    } else if (i < message.velocity.size() && std::isfinite(message.velocity[i])) {
      state.turns_on = true;
      state.target = message.velocity[i];
    }
  };
  take(unit.pan, 0, unit.state.pan);
  take(unit.tilt, unit.pan.there ? 1 : 0, unit.state.tilt);
  unit.state.task = Task::hold;
}

void hold(Unit& unit, const Context& context) {
  unit.state.task = Task::hold;
  unit.state.pan.turns_on = unit.state.tilt.turns_on = false;
  unit.state.pan.target = joint_of(unit.pan, context).position;
  unit.state.tilt.target = joint_of(unit.tilt, context).position;
}

void take_point(Unit& unit) {
  const msg::PointStamped& message = unit.point_command->message;
  const std::string& frame = message.header.frame_id;
  std::int32_t link = -1;
  if (!frame.empty() && frame != "world") {
    const auto found = std::find_if(unit.frames.begin(), unit.frames.end(),
                                    [&](const auto& each) { return each.first == frame; });
    if (found == unit.frames.end()) return;  // a frame nobody knows: the old command stays
    link = static_cast<std::int32_t>(found - unit.frames.begin());
  }
  if (!is_finite(message.point)) return;
  unit.state.task = Task::look;
  unit.state.link = link;
  unit.state.point = message.point;
}

void take_text(Unit& unit, const Context& context) {
  const std::string_view text = unit.text_command->message.data;
  if (text == "stop") return hold(unit, context);
  const std::size_t space = text.find(' ');
  const std::string_view verb = text.substr(0, space);
  if (space == std::string_view::npos || (verb != "search" && verb != "track")) return;
  State& state = unit.state;
  state.task = verb == "search" ? Task::search : Task::track;
  state.label = text.substr(space + 1, 100);
  state.sighted = false;
  state.out_of_reach = false;
  state.row = 0;
}

/// Place of the labelled object, if the camera has a new message; of several objects the one nearest to the
/// last.
std::optional<Vec3> sighting(Unit& unit, const Context& context) {
  if (unit.objects_topic.empty() || !context.topics) return std::nullopt;
  const auto* const topic = topic_cast<msg::ObjectArray>(context.topics->find_topic(unit.objects_topic));
  if (!topic || topic->count == unit.state.looked) return std::nullopt;
  unit.state.looked = topic->count;
  // Between the camera's sample and now nothing has moved: both are at the end of the last tick.
  const Pose X_WE = eye_pose(unit, context);
  std::optional<Vec3> best;
  double least = 0;
  for (const msg::Object& object : topic->message.objects) {
    if (object.label != unit.state.label) continue;
    const Vec3 place_W = X_WE * object.position;
    const double cost = unit.state.sighted ? norm(place_W - unit.state.point) : -object.confidence;
    if (!best || cost < least) best = place_W, least = cost;
  }
  return best;
}

/// Sweeps pan from one end to the other, row by row.
void sweep(Unit& unit, const Context& context) {
  State& state = unit.state;
  const auto& tilts = unit.spec.search_tilts;
  if (unit.tilt.there) {
    state.tilt.turns_on = false;
    state.tilt.target = std::clamp(tilts[state.row % tilts.size()], unit.tilt.lower, unit.tilt.upper);
  }
  const double lower = std::max(unit.pan.lower, -math::pi), upper = std::min(unit.pan.upper, math::pi);
  const AxisState& axis = unit.pan.there ? state.pan : state.tilt;
  if (unit.pan.there) {
    state.pan.turns_on = false;
    state.pan.target = state.row % 2 == 0 ? upper : lower;
  }
  const Unit::Axis& moving = unit.pan.there ? unit.pan : unit.tilt;
  if (std::abs(axis.target - joint_of(moving, context).position) < arrived_rad) ++state.row;
}

void follow_task(Unit& unit, const Context& context) {
  State& state = unit.state;
  if (state.task == Task::search || state.task == Task::track) {
    if (const auto place_W = sighting(unit, context)) {
      state.sighted = true;
      state.sighted_at = context.now;
      state.point = *place_W;
      state.link = -1;
    }
    if (state.task == Task::track && state.sighted &&
        (context.now - state.sighted_at).s() > unit.spec.lost_after_s)
      state.sighted = false;
    if (!state.sighted) {
      if (unit.spec.search_zoom > 0) zoom_to(unit, unit.spec.search_zoom, context);
      return sweep(unit, context);
    }
  } else if (state.task != Task::look) {
    return;
  }
  const Pose X_WF = state.link < 0
                        ? Pose{}
                        : context.engine.states()[unit.frames[static_cast<std::size_t>(state.link)].second]
                              .X_WB;
  const Vec3 point_W = X_WF * state.point;
  look_at(unit, point_W, context);
  if (unit.spec.zoom_per_m > 0)
    zoom_to(unit, unit.spec.zoom_per_m * norm(point_W - eye_pose(unit, context).p), context);
}

void drive(const Unit& unit, const Unit::Axis& axis, AxisState& state, double fastest, const Context& context,
           double h_s) {
  if (!axis.there) return;
  const double acceleration = unit.spec.max_acceleration_radps2;
  fastest = std::min(fastest, axis.max_velocity);
  const double position = joint_of(axis, context).position;
  double wanted = 0;
  if (state.turns_on) {
    wanted = std::clamp(state.target, -fastest, fastest);
    if ((wanted > 0 && position >= axis.upper) || (wanted < 0 && position <= axis.lower)) wanted = 0;
  } else {
    const double error = state.target - position;
    // The last part closes a fifth of the error per sub-step, as joint_motor's exact servo.
    const double most = std::min(
        {fastest, std::sqrt(2 * acceleration * std::abs(error)), 0.2 * std::abs(error) / h_s});
    wanted = std::copysign(most, error);
  }
  // Braking may be a little harder than speeding up: what is late by a sub-step is made up for.
  const bool brakes = std::abs(wanted) < std::abs(state.speed);
  const double change = (brakes ? 2 : 1) * acceleration * h_s;
  state.speed += std::clamp(wanted - state.speed, -change, change);
  context.actuation.joints.push_back({.joint = axis.id,
                                      .mode = JointTarget::Mode::velocity,
                                      .velocity = state.speed,
                                      .max_effort = std::min(unit.spec.max_effort_Nm, axis.max_effort)});
}

std::uint8_t status_of(const Unit& unit, bool zoomed, const Context& context) {
  using S = msg::PanTiltState;
  const State& state = unit.state;
  const auto there = [&](const Unit::Axis& axis, const AxisState& s) {
    return !axis.there ||
           (!s.turns_on && std::abs(s.target - joint_of(axis, context).position) < arrived_rad);
  };
  const bool arrived = zoomed && there(unit.pan, state.pan) && there(unit.tilt, state.tilt);
  if (state.task == Task::hold) return arrived ? S::idle : S::moving;
  if (state.task != Task::look && !state.sighted)
    return state.task == Task::track && state.sighted_at.ns > 0 ? S::lost : S::searching;
  if (state.out_of_reach) return S::out_of_reach;
  if (state.task == Task::track) return S::tracking;
  return arrived ? S::arrived : S::moving;
}

}  // namespace

Result<Unit> Unit::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(check_levels(build.levels));
  if (!build.engine.joints)
    return Error{"the engine '" + std::string(build.engine.name) + "' does not simulate joints"};
  if (spec.pan_joint.empty() && spec.tilt_joint.empty())
    return Error{"a pan-tilt unit without joints", "give pan_joint, tilt_joint or both"};
  Unit unit{std::move(spec), {}};
  SL_ASSIGN(unit.pan, axis_of(build, unit.spec.pan_joint, "pan_joint"));
  SL_ASSIGN(unit.tilt, axis_of(build, unit.spec.tilt_joint, "tilt_joint"));
  unit.eye_body = unit.tilt.there ? unit.tilt.child : unit.pan.child;
  unit.robot = build.instance.name;
  if (!unit.spec.camera.empty()) {
    SL_ASSIGN(const model::DeviceDecl* const camera, camera_of(build, unit.spec.camera));
    unit.eye_body = build.bodies[camera->link].index;
    unit.X_LE = camera->X_LS;
    const std::string device = "/" + build.path.substr(0, build.path.rfind('/') + 1) +
                               sanitised(camera->name);
    unit.objects_topic = device + "/objects";
    if (const Node* const zoom = camera->config.find("zoom"); zoom && !zoom->is_null()) {
      SL_ASSIGN(const Zoom lens, read_spec<Zoom>(*zoom));
      unit.longest_zoom = lens.max;
      unit.zoom_topic = device + "/zoom";
      unit.zoom_order = build.order<msg::Float64>(device.substr(1), "zoom", "camera");
    }
  }
  for (const char* const key : {"search_zoom", "zoom_per_m"}) {
    const bool wanted = (key[0] == 's' ? unit.spec.search_zoom : unit.spec.zoom_per_m) > 0;
    if (!wanted || !unit.zoom_topic.empty()) continue;
    return build.error(key, "this unit has no camera that zooms",
                       "give the camera a 'zoom', or leave this out");
  }
  const auto& links = build.instance.model->links;
  unit.frames.emplace_back(unit.robot, build.bodies[0].index);
  for (std::size_t i = 0; i < links.size(); ++i)
    unit.frames.emplace_back(unit.robot + "/" + links[i].name, build.bodies[i].index);

  unit.joints_command = build.accept<msg::JointState>(joints, "joints");
  unit.point_command = build.accept<msg::PointStamped>(view, "view");
  unit.text_command = build.accept<msg::String>(view, "view/task");
  constexpr std::uint32_t always = 2;
  if (!unit.zoom_topic.empty()) unit.zoom_command = build.accept<msg::Float64>(always, "zoom");
  unit.joint_state = build.publish<msg::JointState>(always, "state");
  unit.status = build.publish<msg::PanTiltState>(always, "status");
  unit.joint_state->message.header.frame_id = unit.status->message.header.frame_id = build.frame_id();
  unit.energy = build.energy;
  for (const Axis* axis : {&unit.pan, &unit.tilt}) {
    if (!axis->there) continue;
    unit.joint_state->message.name.push_back(axis->name);
    if (unit.energy) unit.energy->can_turn(axis->id);
  }
  return unit;
}

void Unit::actuate(PoolView<Unit> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Unit& unit = pool.all[index];
    State& state = unit.state;
    if (!state.begun) hold(unit, context), state.begun = true;
    if (unit.energy) unit.energy->turn_joints();
    const auto fresh = [&](const TopicBase& slot, std::size_t which) {
      const bool is = slot.count != state.taken[which];
      state.taken[which] = slot.count;
      return is;
    };
    // All are looked at in every tick: a command for a level that is not active is not kept for later.
    const bool angles = fresh(*unit.joints_command, 0), point = fresh(*unit.point_command, 1),
               text = fresh(*unit.text_command, 2);
    if (unit.zoom_command && fresh(*unit.zoom_command, 3))
      zoom_to(unit, unit.zoom_command->message.data, context);
    if (pool.levels[index] >> joints & 1) {
      if (angles) take_joints(unit);
    } else {
      if (point) take_point(unit);
      if (text) take_text(unit, context);
      follow_task(unit, context);
    }
  }
}

void Unit::pre_substep(PoolView<Unit> pool, const Context& context, double h_s) {
  for (const std::uint32_t index : pool.due) {
    Unit& unit = pool.all[index];
    const State& state = unit.state;
    const bool sweeps = (state.task == Task::search || state.task == Task::track) && !state.sighted;
    const double slow = sweeps ? unit.spec.search_speed_radps : 1e16;
    drive(unit, unit.pan, unit.state.pan, std::min(slow, unit.spec.max_pan_speed_radps), context, h_s);
    drive(unit, unit.tilt, unit.state.tilt, unit.spec.max_tilt_speed_radps, context, h_s);
  }
}

void Unit::sense(PoolView<Unit> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Unit& unit = pool.all[index];
    msg::JointState& shown = unit.joint_state->message;
    shown.position.clear(), shown.velocity.clear(), shown.effort.clear();
    for (const Axis* axis : {&unit.pan, &unit.tilt}) {
      if (!axis->there) continue;
      const JointState& joint = joint_of(*axis, context);
      shown.position.push_back(joint.position);
      shown.velocity.push_back(joint.velocity);
      shown.effort.push_back(joint.effort);
    }
    unit.joint_state->publish(context.now);
    msg::PanTiltState& status = unit.status->message;
    const auto [zoom, zoom_target] = zoom_of(unit, context);
    status.zoom = zoom;
    status.zoom_target = zoom_target;
    status.status = status_of(unit, zoom == zoom_target, context);
    const bool labelled = unit.state.task == Task::search || unit.state.task == Task::track;
    if (labelled) status.label = unit.state.label;
    else status.label.clear();
    status.pan = joint_of(unit.pan, context).position;
    status.tilt = joint_of(unit.tilt, context).position;
    status.pan_target = unit.state.pan.turns_on ? status.pan : unit.state.pan.target;
    status.tilt_target = unit.state.tilt.turns_on ? status.tilt : unit.state.tilt.target;
    unit.status->publish(context.now);
  }
}

void Unit::release(const Context& context) {
  for (const Axis* axis : {&pan, &tilt})
    if (axis->there && state.begun) context.actuation.joints.push_back({.joint = axis->id});
}

Status Unit::switch_level(std::uint32_t before, std::uint32_t after, const Context&) {
  SL_TRY(check_levels(after));
  if (before != after) state.task = Task::hold;
  return {};
}

namespace {
constexpr LevelInfo levels[] = {
    {"joints", "", msg::JointState::ros_type, "Turns to angles, or at given speeds."},
    {"view", "", msg::PointStamped::ros_type, "Looks at points; searches and tracks objects by name."},
};
}  // namespace

constinit const Kind kind = make_kind<Unit>({
    .name = "pan_tilt",
    .help = "Pan-tilt head that turns a camera about two joints: to angles, to a point, or after an object.",
    .levels = levels,
});

}  // namespace sandlot::pan_tilt
