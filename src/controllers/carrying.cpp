#include "controllers/carrying.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::carrying {
namespace {

using steering::flat, steering::heading_of;

constexpr double kept = 0.5;
constexpr double at_post_m = 0.07, at_post_rad = 0.15;
constexpr double least_worth = 1e-3;
constexpr double robot_clearance_m = 0.35, load_clearance_m = 0.3, private_m = 0.8;
constexpr double sideways_gain = 3;  // pushing: back to the post's line
constexpr double least_speed = 0.2, largest_speed = 1.5;
constexpr double freshness = 0.1;

}  // namespace

Load look_at(const Keys& keys, const Pose& X_WL) {
  Load load;
  load.middle = flat(X_WL.p);
  const Vec3 way = Vec3{keys.destination_m[0], keys.destination_m[1], 0} - load.middle;
  load.ahead = steering::towards(yaw_of(X_WL.q));
  if (dot(load.ahead, way) < 0) load.ahead = -load.ahead;
  load.left = {-load.ahead.y, load.ahead.x, 0};
  load.arrived = norm(way) < keys.tolerance_m;
  if (norm(way) > keys.tolerance_m)
    load.error_rad = math::wrap_angle(heading_of(way) - heading_of(load.ahead));
  return load;
}

Vec3 place(const Keys& keys, const Load& load, std::size_t post) {
  return load.middle - keys.standoff_m * load.ahead + keys.posts_m[post] * load.left;
}

void bid(const Keys& keys, const Load& load, const Pose& X_WB, Member& member) {
  member.bids.assign(keys.posts_m.size(), no_bid);
  if (member.charge < keys.least_charge || member.health < keys.least_health) return;
  const double worth = std::max(member.charge * member.health, least_worth);
  for (std::size_t k = 0; k < keys.posts_m.size(); ++k) {
    const double way = norm(place(keys, load, k) - flat(X_WB.p));
    const double share = member.post == static_cast<std::int32_t>(k) ? kept : 1.0;
    member.bids[k] = std::min(share * way / worth * (1 + member.load), 0.5 * no_bid);
  }
}

double charge_of(const View<msg::BatteryState>& battery, double before) {
  const double percentage = battery.message.percentage;
  return battery.valid && percentage >= 0 ? std::min(percentage, 1.0) : before;
}

double health_of(const View<msg::PropertyStamped>& health, double before) {
  const msg::Property& property = health.message.property;
  const double range = property.max - property.min;
  if (!health.valid || !(range > 0)) return before;
  const double share = (property.value - property.min) / range;
  return share > 0 ? std::min(share, 1.0) : 0;
}

bool at_post(const Keys& keys, const Load& load, const Pose& X_WB, std::size_t post) {
  const Vec3 off = flat(X_WB.p) - place(keys, load, post);
  const double turn = math::wrap_angle(heading_of(load.ahead) - yaw_of(X_WB.q));
  return std::abs(dot(off, load.left)) < at_post_m && std::abs(dot(off, load.ahead)) < 2 * at_post_m &&
         std::abs(turn) < at_post_rad;
}

void settle(std::span<const Member* const> members, std::size_t post_count,
            std::vector<std::int32_t>& posts) {
  posts.assign(members.size(), no_post);
  std::array<bool, most_posts> manned{};
  for (std::size_t round = 0; round < std::min(post_count, most_posts); ++round) {
    std::size_t best = members.size(), best_post = 0;
    double least = no_bid;
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (posts[i] != no_post) continue;
      for (std::size_t k = 0; k < std::min({post_count, members[i]->bids.size(), most_posts}); ++k) {
        const double cost = members[i]->bids[k];
        if (manned[k] || !(cost < no_bid)) continue;
        if (best < members.size() &&
            (cost > least || (cost == least && members[i]->robot >= members[best]->robot)))
          continue;
        best = i, best_post = k, least = cost;
      }
    }
    if (best == members.size()) return;
    posts[best] = static_cast<std::int32_t>(best_post);
    manned[best_post] = true;
  }
}

msg::Twist drive(const Keys& keys, const Load& load, const msg::ObjectPoseArray& world,
                 const msg::ObjectPose& self, std::int32_t post, bool pushing,
                 std::vector<steering::Disc>& scratch) {
  const Pose& X_WB = self.pose;
  const Vec3 here = flat(X_WB.p);
  if (load.arrived) return {};
  const steering::Limits limits{keys.speed_mps, keys.turn_speed_radps};
  if (post == no_post) {  // out of the way
    for (const msg::ObjectPose& other : world.objects)
      if (other.name != self.name && other.name != keys.load && norm(flat(other.pose.p) - here) < private_m)
        return steering::drive_along(X_WB, heading_of(here - flat(other.pose.p)),
                                     {0.5 * keys.speed_mps, keys.turn_speed_radps});
    return {};
  }
  const auto index = static_cast<std::size_t>(post);
  const Vec3 target = place(keys, load, index);
  const Vec3 off = here - target;
  if (pushing) {
    double widest = 1e-3;
    for (const double each : keys.posts_m) widest = std::max(widest, std::abs(each));
    const double part = 1 - keys.turn_gain * load.error_rad * keys.posts_m[index] / widest;
    msg::Twist twist;
    twist.linear.x = keys.push_speed_mps * std::clamp(part, least_speed, largest_speed);
    const double heading = heading_of(load.ahead) -
                           std::clamp(sideways_gain * dot(off, load.left), -0.5, 0.5);
    twist.angular.z = steering::turn_to(X_WB, heading, limits).angular.z;
    return twist;
  }
  if (norm(off) < at_post_m) return steering::turn_to(X_WB, heading_of(load.ahead), limits);
  scratch.clear();
  for (const msg::ObjectPose& other : world.objects)
    if (other.name != self.name && other.name != keys.load)
      scratch.push_back({other.pose.p, robot_clearance_m});
  // The beam, as discs along its axis, keeps robots in front of it from driving through it.
  if (dot(here - load.middle, load.ahead) > -0.5 * keys.standoff_m) {
    for (const double along : keys.posts_m)
      scratch.push_back({load.middle + along * load.left, load_clearance_m});
    scratch.push_back({load.middle, load_clearance_m});
  }
  return steering::drive_to(X_WB, steering::way_around(here, target, scratch), limits);
}

void Effort::follow(Vec3 at, Time stamp) {
  const double dt = (stamp - seen_at).s();
  if (dt > 0 && seen_at.ns > 0 && ordered_mps > 1e-3) {
    const double lost = std::clamp(1 - norm(flat(at - seen)) / (dt * ordered_mps), 0.0, 1.0);
    load += freshness * (lost - load);
  }
  seen = at, seen_at = stamp;
}

}  // namespace sandlot::controllers::carrying
