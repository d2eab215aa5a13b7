#include "controllers/carriers/carriers.h"

#include <algorithm>

namespace sandlot::controllers::carriers {

using namespace carrying;

Status Carriers::init(const Description& team, Outputs& out) {
  if (team.members.empty() && !(team.readings.empty() && team.actuators.empty()))
    return Error{
        "'" + team.robot + "' is a robot, and carriers drives a team",
        "write it as the controller of a team, or use carrier: teams: [{name: red, controller: carriers}]"};
  robots.clear();
  for (const Description& member : team.members) {
    Robot& robot = robots.emplace_back();
    robot.name = member.robot;
    SL_ASSIGN(robot.drive, member.actuator<msg::Twist>(spec.drive));
    if (!spec.battery.empty()) { SL_ASSIGN(robot.battery, member.reading<msg::BatteryState>(spec.battery)); }
    if (!spec.health.empty()) { SL_ASSIGN(robot.health, member.reading<msg::PropertyStamped>(spec.health)); }
  }
  if (!team.members.empty()) {
    SL_ASSIGN(camera, team.members.front().reading<msg::ObjectPoseArray>(spec.camera));
  }
  pushing = out.publish<msg::UInt32>("pushing");
  return {};
}

bool Carriers::fits() const {
  const auto post_count = static_cast<std::int32_t>(spec.posts_m.size());
  return state.members.size() <= 100'000 && state.members.size() == state.efforts.size() &&
         std::all_of(state.members.begin(), state.members.end(), [&](const Member& member) {
           return member.bids.size() <= most_posts && member.post >= no_post && member.post < post_count;
         });
}

/// One member of the state per robot, in their order: robots may have come or gone.
void Carriers::match() {
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (i < state.members.size() && state.members[i].robot == robots[i].name) continue;
    std::size_t known = i;
    while (known < state.members.size() && state.members[known].robot != robots[i].name) ++known;
    if (known < state.members.size()) {
      std::swap(state.members[i], state.members[known]);
      std::swap(state.efforts[i], state.efforts[known]);
    } else {
      const auto at = static_cast<std::ptrdiff_t>(i);
      state.members.insert(state.members.begin() + at, Member());
      state.members[i].robot = robots[i].name;
      state.efforts.insert(state.efforts.begin() + at, Effort());
    }
  }
  state.members.resize(robots.size());
  state.efforts.resize(robots.size());
}

void Carriers::step(const Observation& obs, Command& cmd) {
  match();
  const auto stand = [&] {
    for (const Robot& robot : robots) cmd.set(robot.drive, msg::Twist());
    cmd.publish(pushing, msg::UInt32{});
  };
  if (robots.empty()) return stand();
  const auto seen = obs.get(camera);
  const msg::ObjectPose* const beam = seen.valid ? steering::find(seen.message, spec.load) : nullptr;
  if (!beam) return stand();
  const Load load = look_at(spec, beam->pose);
  members.clear();
  for (std::size_t i = 0; i < robots.size(); ++i) {
    Member& member = state.members[i];
    members.push_back(&member);
    if (!spec.battery.empty()) member.charge = charge_of(obs.get(robots[i].battery), member.charge);
    if (!spec.health.empty()) member.health = health_of(obs.get(robots[i].health), member.health);
    const msg::ObjectPose* const self = steering::find(seen.message, robots[i].name);
    if (!self) {
      member.bids.clear();
      continue;
    }
    if (seen.fresh) state.efforts[i].follow(steering::flat(self->pose.p), seen.stamp);
    member.load = state.efforts[i].load;
    bid(spec, load, self->pose, member);
  }
  settle(members, spec.posts_m.size(), posts);
  std::size_t manned = 0;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    Member& member = state.members[i];
    const bool stays = posts[i] == member.post;
    if (!stays) ++state.settled;
    member.post = posts[i];
    const msg::ObjectPose* const self = steering::find(seen.message, robots[i].name);
    member.ready = self && member.post != no_post &&
                   ((state.pushing && stays) ||
                    at_post(spec, load, self->pose, static_cast<std::size_t>(member.post)));
    manned += member.ready;
  }
  state.pushing = manned == spec.posts_m.size();
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const msg::ObjectPose* const self = steering::find(seen.message, robots[i].name);
    const msg::Twist order = self ? carrying::drive(spec, load, seen.message, *self, state.members[i].post,
                                                    state.pushing, discs)
                                  : msg::Twist();
    state.efforts[i].ordered_mps = order.linear.x;
    cmd.set(robots[i].drive, order);
  }
  cmd.publish(pushing, msg::UInt32{static_cast<std::uint32_t>(state.pushing ? manned : 0)});
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Carriers>({
    .name = "carriers",
    .help = "Pushes a long load with all robots of a team, with roles that one program gives.",
});

}  // namespace sandlot::controllers::carriers
