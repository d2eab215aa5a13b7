#include "navigation/planning/disc_tracker.h"

#include <algorithm>
#include <cmath>

namespace sandlot::navigation {
namespace {

struct TrackerObject {
  Vec2 centre;
  double radius = 0;
};

double tracker_distance(Vec2 a, Vec2 b) { return math::hypot(a.x - b.x, a.y - b.y); }

/// Objects whose whole visible side the scan shows.
std::vector<TrackerObject> tracker_objects(const TrackerSpec& spec, std::span<const Echo> echoes) {
  std::vector<TrackerObject> out;
  for (std::size_t first = 0, next = 0; first < echoes.size(); first = next) {
    next = first + 1;
    while (next < echoes.size() && tracker_distance(echoes[next].p_M, echoes[next - 1].p_M) <= spec.gap_m)
      ++next;
    if (next - first < 2 || out.size() >= TrackerState::max_tracks) continue;
    // A neighbouring beam that ends nearer may hide the rest.
    const bool hidden_before = first > 0 && echoes[first].beam - echoes[first - 1].beam <= 2 &&
                               echoes[first - 1].range_m < echoes[first].range_m,
               hidden_after = next < echoes.size() && echoes[next].beam - echoes[next - 1].beam <= 2 &&
                              echoes[next].range_m < echoes[next - 1].range_m;
    if (hidden_before || hidden_after || first == 0 || next == echoes.size()) continue;
    Vec2 low = echoes[first].p_M, high = low;
    for (std::size_t i = first; i < next; ++i) {
      low = {std::min(low.x, echoes[i].p_M.x), std::min(low.y, echoes[i].p_M.y)};
      high = {std::max(high.x, echoes[i].p_M.x), std::max(high.y, echoes[i].p_M.y)};
    }
    TrackerObject object{0.5 * (low + high), 0};
    for (std::size_t i = first; i < next; ++i)
      object.radius = std::max(object.radius, tracker_distance(echoes[i].p_M, object.centre));
    if (object.radius <= spec.max_radius_m) out.push_back(object);
  }
  return out;
}

void tracker_correct(const TrackerSpec& spec, Track& t, const TrackerObject& object) {
  const double s = t.pp + spec.position_std_m * spec.position_std_m, kp = t.pp / s, kv = t.pv / s;
  const double dx = object.centre.x - t.x_m, dy = object.centre.y - t.y_m;
  t.x_m += kp * dx, t.y_m += kp * dy;
  t.vx_mps += kv * dx, t.vy_mps += kv * dy;
  t.vv -= kv * t.pv;
  t.pv -= kp * t.pv;
  t.pp -= kp * t.pp;
  // A smaller side of the object does not make it smaller at once.
  t.radius_m = std::max(object.radius, 0.98 * t.radius_m);
  t.unseen_s = 0;
  ++t.seen;
  const double speed = math::hypot(t.vx_mps, t.vy_mps);
  if (!t.moving) {
    // The way it has come is what tells: the velocity of a moment is less sure than people are fast.
    t.moving = speed > spec.min_speed_mps && t.seen >= 4 &&
               tracker_distance({t.x_m, t.y_m}, {t.first_x_m, t.first_y_m}) >
                   std::max(spec.min_way_m, t.radius_m);
  } else if (speed < spec.min_speed_mps / 2) {
    t.moving = false;
    t.first_x_m = t.x_m, t.first_y_m = t.y_m;
  }
}

}  // namespace

void predict(const TrackerSpec& spec, TrackerState& state, double dt) {
  const double q = spec.acceleration_std_mps2 * spec.acceleration_std_mps2;
  for (Track& t : state.tracks) {
    t.x_m += dt * t.vx_mps, t.y_m += dt * t.vy_mps;
    t.pp += dt * (2 * t.pv + dt * t.vv) + q * dt * dt * dt / 3;
    t.pv += dt * t.vv + q * dt * dt / 2;
    t.vv += q * dt;
    t.unseen_s += dt;
  }
  std::erase_if(state.tracks, [&](const Track& t) { return t.unseen_s > spec.keep_s; });
}

void update(const TrackerSpec& spec, TrackerState& state, std::span<const Echo> echoes) {
  const std::vector<TrackerObject> objects = tracker_objects(spec, echoes);
  struct Pair {
    double distance;
    std::uint32_t track, object;
  };
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < state.tracks.size(); ++t)
    for (std::size_t o = 0; o < objects.size(); ++o) {
      const double d = tracker_distance({state.tracks[t].x_m, state.tracks[t].y_m}, objects[o].centre);
      if (d <= spec.match_m)
        pairs.push_back({d, static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(o)});
    }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return a.distance != b.distance ? a.distance < b.distance
           : a.track != b.track     ? a.track < b.track
                                    : a.object < b.object;
  });
  std::vector<std::uint8_t> track_done(state.tracks.size()), object_done(objects.size());
  for (const Pair& pair : pairs) {
    if (track_done[pair.track] || object_done[pair.object]) continue;
    track_done[pair.track] = object_done[pair.object] = 1;
    tracker_correct(spec, state.tracks[pair.track], objects[pair.object]);
  }
  const double place = spec.position_std_m * spec.position_std_m;
  for (std::size_t o = 0; o < objects.size(); ++o) {
    if (object_done[o] || state.tracks.size() >= TrackerState::max_tracks) continue;
    const Vec2 c = objects[o].centre;
    state.tracks.push_back({.x_m = c.x,
                            .y_m = c.y,
                            .radius_m = objects[o].radius,
                            .pp = place,
                            .first_x_m = c.x,
                            .first_y_m = c.y,
                            .seen = 1});
  }
}

void moving_discs(const TrackerState& state, std::vector<MovingDisc>& out) {
  out.clear();
  for (const Track& t : state.tracks)
    if (t.moving) out.push_back({{t.x_m, t.y_m}, {t.vx_mps, t.vy_mps}, t.radius_m});
}

}  // namespace sandlot::navigation
