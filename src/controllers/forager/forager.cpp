#include "controllers/forager/forager.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::forager {
namespace {

using steering::flat, steering::heading_of;

constexpr double item_clearance_m = 0.25, robot_clearance_m = 0.35;
constexpr double back_off_s = 1, back_off_mps = 0.25;
constexpr double in_front_rad = 0.2;
constexpr double inside = 0.7;  // of the nest's radius: here the gripper opens
constexpr double creep_mps = 0.1;

}  // namespace

Status Forager::init(const Description& robot) {
  name = robot.robot;
  SL_ASSIGN(camera, robot.reading<msg::ObjectPoseArray>(spec.camera));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  SL_ASSIGN(held, robot.reading<msg::GripperState>(spec.gripper));
  SL_ASSIGN(gripper, robot.actuator<msg::Bool>(spec.gripper));
  if (!spec.battery.empty()) { SL_ASSIGN(battery, robot.reading<msg::BatteryState>(spec.battery)); }
  return {};
}

/// The nearest item outside the nest that no robot of the same label is nearer to.
const msg::ObjectPose* Forager::choose(const View& view) const {
  const Vec3 here = flat(view.self.pose.p);
  const msg::ObjectPose* best = nullptr;
  for (const msg::ObjectPose& item : view.world.objects) {
    if (item.label != spec.items || norm(flat(item.pose.p) - nest()) < spec.nest_radius_m) continue;
    if (item.name == state.left_alone && view.now < state.left_alone_until) continue;
    const double distance = norm(flat(item.pose.p) - here);
    if (best && distance >= norm(flat(best->pose.p) - here)) continue;
    const bool others = std::any_of(view.world.objects.begin(), view.world.objects.end(),
                                    [&](const msg::ObjectPose& other) {
                                      return other.label == view.self.label && other.name != name &&
                                             norm(flat(other.pose.p) - flat(item.pose.p)) < distance;
                                    });
    if (!others) best = &item;
  }
  return best;
}

Vec3 Forager::way(const View& view, Vec3 to, bool around_items) {
  discs.clear();
  for (const msg::ObjectPose& other : view.world.objects) {
    if (other.name == name || other.name == state.item) continue;
    const bool item = other.label == spec.items;
    if (item && !around_items) continue;
    discs.push_back({other.pose.p, item ? item_clearance_m : robot_clearance_m});
  }
  return steering::way_around(view.self.pose.p, to, discs);
}

msg::Twist Forager::search(const View& view) {
  const msg::ObjectPose* item = state.item.empty() ? nullptr : steering::find(view.world, state.item);
  if (item && view.now - state.since > Time::from_s(spec.patience_s)) {
    state.left_alone = state.item;
    state.left_alone_until = view.now + Time::from_s(spec.patience_s);
    item = nullptr;
  }
  // Another robot may have been faster.
  if (!item || norm(flat(item->pose.p) - nest()) < spec.nest_radius_m) {
    item = choose(view);
    state.item = item ? item->name : std::string();
    state.since = view.now;
    state.closed = false;
  }
  if (!item) return {};
  const Vec3 off = flat(item->pose.p - view.self.pose.p);
  const double turn = math::wrap_angle(heading_of(off) - yaw_of(view.self.pose.q));
  const bool near = norm(off) < 2 * spec.grip_m;
  if (near && std::abs(turn) > in_front_rad) {
    state.closed = false;
    return steering::turn_to(view.self.pose, heading_of(off), limits());
  }
  // Closing again is another try: open in one step, closed in the next.
  state.closed = norm(off) < spec.grip_m && !state.closed;
  if (near) return steering::drive_along(view.self.pose, heading_of(off), {creep_mps, spec.turn_speed_radps});
  return steering::drive_to(view.self.pose, way(view, flat(item->pose.p), true), limits());
}

msg::Twist Forager::carry(const View& view) {
  state.closed = true;
  const Vec3 here = flat(view.self.pose.p);
  const msg::ObjectPose* const item = steering::find(view.world, state.item);
  const Vec3 carried = item ? flat(item->pose.p) : here;
  if (norm(carried - nest()) < inside * spec.nest_radius_m) {
    ++state.brought;
    state.closed = false;
    state.item.clear();
    state.phase = Phase::back_off;
    state.backing_until = view.now + Time::from_s(back_off_s);
    return {};
  }
  return steering::drive_to(view.self.pose, way(view, nest(), false), limits());
}

msg::Twist Forager::charge(const View& view) {
  state.closed = false;
  state.item.clear();
  if (view.charge >= spec.full_charge) {
    state.phase = Phase::search;
    return {};
  }
  const Vec3 here = flat(view.self.pose.p);
  const auto point = [](const std::array<double, 2>& xy) { return Vec3{xy[0], xy[1], 0}; };
  const auto nearest = std::min_element(
      spec.stations_m.begin(), spec.stations_m.end(),
      [&](const auto& a, const auto& b) { return norm(point(a) - here) < norm(point(b) - here); });
  if (norm(point(*nearest) - here) < spec.station_radius_m) return {};
  return steering::drive_to(view.self.pose, way(view, point(*nearest), true), limits());
}

msg::Twist Forager::decide(const View& view) {
  if (state.phase != Phase::charge && view.charge < spec.low_charge && !spec.stations_m.empty()) {
    state.phase = Phase::charge;
    ++state.charged;
  }
  if (state.phase == Phase::charge) return charge(view);
  if (state.phase == Phase::back_off) {
    if (view.now < state.backing_until) return {.linear = {-back_off_mps, 0, 0}};
    state.phase = Phase::search;
  }
  if (state.phase == Phase::carry && !view.holds) {  // it was torn off
    state.phase = Phase::search;
    state.closed = false;
  }
  if (state.phase == Phase::search && view.holds && !state.item.empty()) state.phase = Phase::carry;
  return state.phase == Phase::carry ? carry(view) : search(view);
}

void Forager::step(const Observation& obs, Command& cmd) {
  const auto seen = obs.get(camera);
  const auto grip = obs.get(held);
  const msg::ObjectPose* const self = seen.valid ? steering::find(seen.message, name) : nullptr;
  if (!self) return cmd.set(drive, msg::Twist());
  View view{obs.now(), seen.message, *self, grip.valid && !grip.message.held.empty(), 1};
  if (!spec.battery.empty()) {
    const auto charge = obs.get(battery);
    if (charge.valid && charge.message.percentage >= 0) view.charge = charge.message.percentage;
  }
  // What it holds is what counts, whichever item it went for: "item3::body".
  if (view.holds && state.phase == Phase::search) {
    const std::string& link = grip.message.held;
    state.item.assign(link, 0, std::min(link.find(':'), link.size()));
  }
  cmd.set(drive, decide(view));
  cmd.set(gripper, msg::Bool{state.closed});
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Forager>({
    .name = "forager",
    .help = "Fetches items with a gripper and brings them home; charges in time.",
});

}  // namespace sandlot::controllers::forager
