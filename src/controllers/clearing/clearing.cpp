#include "controllers/clearing/clearing.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace sandlot::controllers::clearing {
namespace {

constexpr double back_off_s = 0.9, back_off_mps = 0.25;
constexpr double progress_m = 0.05;
constexpr double behind_m = 0.05;     // off the line through object and destination, when pushing begins
constexpr double aligned_rad = 0.12;  // off the direction to the destination, when pushing begins
constexpr double heading_gain = 1.5;  // pushing: towards the destination
constexpr double offset_gain = 2.5;   // pushing: towards the side to which the object slides
constexpr double least_turn_m =
    0.35;  // pushing: radius of the narrowest arc, on which the object stays at the blade
constexpr double private_m = 0.6;                  // without anything to do: distance kept from others
constexpr std::uint64_t to_send = 1, to_wait = 2;  // uses of random numbers
constexpr double moved_m = 0.06, moved_rad = 0.35;
constexpr Time forget = Time::from_s(2), jam = Time::from_s(3);
constexpr double soonest_s = 0.2,
                 latest_s = 0.6;  // from one message to the next: at random, lest two robots keep colliding

exact::Vec at(const msg::ObjectPose& object) { return {object.pose.p.x, object.pose.p.y}; }

msg::Twist twist_of(const exact::Motion& motion) {
  return {.linear = {motion.forward_mps, 0, 0}, .angular = {0, 0, motion.turn_radps}};
}

/// "box3 1250"; false for anything else, such as what bit errors have made of it.
bool parse(const std::vector<std::uint8_t>& data, std::string_view& object, std::uint32_t& bid_mm) {
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos) return false;
  object = text.substr(0, blank);
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data() + blank + 1, end, bid_mm);
  return error == std::errc() && last == end;
}

}  // namespace

Status Clearing::init(const Description& robot) {
  name = robot.robot;
  SL_ASSIGN(camera, robot.reading<msg::ObjectPoseArray>(spec.camera));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  if (spec.radio.empty()) return {};
  SL_ASSIGN(receiver, robot.reading<msg::RadioReceptionArray>(spec.radio));
  SL_ASSIGN(sender, robot.actuator<msg::RadioPacket>(spec.radio));
  return {};
}

void Clearing::receive(const Observation& obs, const msg::ObjectPoseArray& world) {
  const auto heard = obs.get(receiver);
  if (!heard.valid || !heard.fresh) return;
  for (const msg::RadioReception& packet : heard.message.packets) {
    std::string_view object;
    std::uint32_t bid_mm = 0;
    if (packet.from == name || !parse(packet.data, object, bid_mm)) continue;
    if (!object.empty() && !steering::find(world, object)) continue;
    auto known = std::find_if(state.claims.begin(), state.claims.end(),
                              [&](const Claim& claim) { return claim.robot == packet.from; });
    if (known == state.claims.end()) {
      if (state.claims.size() >= most_claims) continue;
      state.claims.emplace_back().robot = packet.from;
      known = state.claims.end() - 1;
    }
    known->object.assign(object);
    known->bid_mm = bid_mm;
    known->received = obs.now();
  }
}

/// Sends the choice when it is another, and now and then.
void Clearing::send(const View& view, Command& cmd) {
  if (state.object == state.sent_object && view.now < state.resend) return;
  std::array<char, 16> digits{};
  const msg::ObjectPose* const object = steering::find(view.world, state.object);
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(),
                                          object ? bid_mm(*object, view) : 0u);
  if (error != std::errc()) return;
  msg::RadioPacket packet;
  packet.data.assign(state.object.begin(), state.object.end());
  packet.data.push_back(' ');
  packet.data.insert(packet.data.end(), digits.data(), end);
  cmd.set(sender, packet);
  state.sent_object = state.object;
  state.resend = view.now +
                 Time::from_s(soonest_s + (latest_s - soonest_s) * exact::draw(view.random, to_send));
}

/// Distance of an object from where it counts as inside; negative within.
double Clearing::outside_m(const msg::ObjectPose& object) const {
  return exact::norm(at(object) - destination()) - std::max(0.0, spec.radius_m - spec.margin_m);
}

std::uint32_t Clearing::bid_mm(const msg::ObjectPose& object, const View& view) const {
  if (state.phase == Phase::push) return 0;
  const double distance = std::min(exact::norm(at(object) - view.here.at), 1e6);
  return 1 + static_cast<std::uint32_t>(1000 * distance);
}

/// Whether a team-mate has the better claim.
bool Clearing::taken(const std::string& object, std::uint32_t bid_mm, Time now) const {
  return std::any_of(state.claims.begin(), state.claims.end(), [&](const Claim& claim) {
    return claim.object == object && now - claim.received < forget &&
           (claim.bid_mm < bid_mm || (claim.bid_mm == bid_mm && claim.robot < name));
  });
}

/// Whether the object can be steered from here: ahead, near, and the destination beyond it.
bool Clearing::in_zone(const msg::ObjectPose& object, const View& view) const {
  const exact::Vec seen = exact::seen_from(view.here, at(object));
  const double turn = exact::turn_between(view.here.heading, destination() - at(object));
  return seen.x > 0 && seen.x < spec.reach_m && std::abs(seen.y) < spec.zone_m &&
         std::abs(turn) < spec.zone_angle_rad;
}

/// Step 1.
const msg::ObjectPose* Clearing::choose(const View& view) {
  const msg::ObjectPose* best = nullptr;
  std::uint32_t best_mm = 0;
  for (const msg::ObjectPose& object : view.world.objects) {
    if (object.label != spec.objects || object.name.empty() || outside_m(object) <= 0) continue;
    if (object.name == state.left_alone && view.now < state.left_alone_until) continue;
    const std::uint32_t bid = bid_mm(object, view);
    if ((best && bid >= best_mm) || taken(object.name, bid, view.now)) continue;
    best = &object, best_mm = bid;
  }
  if (!best) return nullptr;
  state.object = best->name;
  state.nearest_m = outside_m(*best);
  state.progress = view.now;
  state.patience_s = spec.patience_s * (0.75 + 0.5 * exact::draw(view.random, to_wait));
  state.phase = Phase::approach;
  return best;
}

void Clearing::back_off(Time now) {
  state.phase = Phase::back_off;
  state.backing_until = state.stood_since = now + Time::from_s(back_off_s);
}

/// Whether it has hardly moved for a while, though it is on its way: something is in between.
bool Clearing::jammed(const View& view) {
  const auto& [here, heading] = view.here;
  const Vec3 now{here.x, here.y, exact::angle_of(heading)};
  const bool moved = exact::norm(here - exact::Vec{state.stood.x, state.stood.y}) > moved_m ||
                     std::abs(exact::angle_between(state.stood.z, now.z)) > moved_rad;
  if (moved || state.phase == Phase::choose || state.phase == Phase::back_off) {
    state.stood = now;
    state.stood_since = view.now;
  }
  return view.now - state.stood_since > jam;
}

exact::Vec Clearing::way(const View& view, exact::Vec to) {
  discs.clear();
  for (const msg::ObjectPose& other : view.world.objects)
    if (other.name != name)
      discs.push_back(
          {at(other), other.label == spec.objects ? spec.object_clearance_m : spec.robot_clearance_m});
  return exact::way_around(view.here.at, to, discs);
}

/// Step 2; goes on to 3 when the robot stands behind the object and looks at it.
msg::Twist Clearing::approach(const msg::ObjectPose& object, const View& view) {
  const exact::Limits limits{spec.speed_mps, spec.turn_speed_radps};
  const exact::Vec along = exact::unit(destination() - at(object));
  const exact::Vec off = at(object) - view.here.at;
  const double ahead = exact::dot(off, along), beside = std::abs(exact::cross(along, off));
  if (ahead > 0 && beside < behind_m && ahead < spec.standoff_m + 2 * behind_m) {
    if (std::abs(exact::turn_between(view.here.heading, along)) > aligned_rad)
      return twist_of(exact::turn_to(view.here, along, limits));
    state.phase = Phase::push;
    return push(object, view);
  }
  return twist_of(exact::drive_to(view.here, way(view, at(object) - spec.standoff_m * along), limits));
}

/// Step 3.
msg::Twist Clearing::push(const msg::ObjectPose& object, const View& view) const {
  const double goal = exact::turn_between(view.here.heading, destination() - view.here.at);
  const double side = exact::angle_of(exact::seen_from(view.here, at(object)));
  const double widest = spec.push_speed_mps / least_turn_m;
  const double turn = heading_gain * goal + offset_gain * side;
  return twist_of({spec.push_speed_mps, std::clamp(turn, -widest, widest)});
}

/// Nothing to do: away from whoever is near.
msg::Twist Clearing::wait(const View& view) const {
  const msg::ObjectPose* nearest = nullptr;
  double nearest_m = private_m;
  for (const msg::ObjectPose& other : view.world.objects) {
    const double apart = exact::norm(at(other) - view.here.at);
    if (other.name == name || other.label == spec.objects || apart >= nearest_m) continue;
    nearest = &other, nearest_m = apart;
  }
  if (!nearest) return {};
  return twist_of(exact::drive_along(view.here, exact::unit(view.here.at - at(*nearest)),
                                     {0.5 * spec.speed_mps, spec.turn_speed_radps}));
}

msg::Twist Clearing::decide(const View& view) {
  if (state.phase == Phase::back_off) {
    if (view.now < state.backing_until) return {.linear = {-back_off_mps, 0, 0}};
    state.phase = state.object.empty() ? Phase::choose : Phase::approach;
  }
  if (jammed(view)) {
    ++state.jammed;
    return back_off(view.now), msg::Twist{};
  }
  const msg::ObjectPose* object = state.object.empty() ? nullptr : steering::find(view.world, state.object);
  if (object && taken(state.object, bid_mm(*object, view), view.now)) {
    const bool touching = state.phase == Phase::push;
    ++state.yielded;
    state.object.clear();
    state.phase = Phase::choose;
    if (touching) return back_off(view.now), msg::Twist{};
    object = nullptr;
  }
  if (object && outside_m(*object) <= 0) {  // step 5
    const bool pushed = state.phase == Phase::push;
    state.delivered += pushed;
    state.object.clear();
    state.phase = Phase::choose;
    if (pushed) return back_off(view.now), msg::Twist{};
    object = nullptr;
  }
  if (object && outside_m(*object) < state.nearest_m - progress_m) {
    state.nearest_m = outside_m(*object);
    state.progress = view.now;
  }
  if (object && view.now - state.progress > Time::from_s(state.patience_s)) {
    state.left_alone = state.object;
    state.left_alone_until = view.now + Time::from_s(state.patience_s);
    state.object.clear();
    return back_off(view.now), msg::Twist{};
  }
  // An object that is not reported in this picture is not forgotten: the robot stands until it is seen again.
  if (!object && !state.object.empty() && view.now - state.progress <= Time::from_s(state.patience_s))
    return {};
  if (!object) {
    state.object.clear();
    state.phase = Phase::choose;
    object = choose(view);
  }
  if (!object) return wait(view);
  if (state.phase == Phase::push && !in_zone(*object, view)) {  // step 4
    ++state.slid;
    back_off(view.now);
    return {};
  }
  return state.phase == Phase::push ? push(*object, view) : approach(*object, view);
}

void Clearing::step(const Observation& obs, Command& cmd) {
  const auto seen = obs.get(camera);
  const msg::ObjectPose* const self = seen.valid ? steering::find(seen.message, name) : nullptr;
  if (!self) return cmd.set(drive, msg::Twist());
  const Pose& pose = self->pose;
  Stream random = obs.random();
  const View view{obs.now(), seen.message,
                  exact::place(pose.p.x, pose.p.y, pose.q.x, pose.q.y, pose.q.z, pose.q.w), random.bits64()};
  if (!spec.radio.empty()) receive(obs, seen.message);
  cmd.set(drive, decide(view));
  if (!spec.radio.empty()) send(view, cmd);
}

}  // namespace sandlot::controllers::clearing
