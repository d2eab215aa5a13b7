#include "controllers/soccer_player/aims.h"

#include <algorithm>

#include "base/math.h"
#include "controllers/soccer_player/tracking.h"

namespace sandlot::controllers::soccer_player {
namespace {

constexpr double keeps_aim_s = 0.4;
/// The referee lets a robot keep the ball for 3 m from where it got it.
constexpr double last_way_m = 2.5, brakes_mps2 = 2.6;
/// A kicked ball slides, and rolls on with this share of its speed: 1 / (1 + I / (m r^2)) of a hollow ball.
constexpr double rolls_on = 0.6;
/// Mean share on its way to the goal, part of which it slides.
constexpr double shot_share = 0.7;
/// Uncertainty of what an opponent reaches: it may have begun to move, or see the ball late.
constexpr double reach_std_m = 0.15;
/// A place across the way from the ball to the goal counts this much to a supporter, which else would run from side to side.
constexpr double across_lane = 0.7;
constexpr double body_m = 0.36;  ///< robot and ball side by side

/// Speed of a clearance from a set piece.
constexpr double piece_clearance_mps = 4.5;

void aim(Memory& memory, Aim kind, Vec3 at, double tolerance_rad, double speed_mps, double until_s) {
  memory.aim = kind;
  memory.at = at;
  memory.tolerance_rad = tolerance_rad;
  memory.speed_mps = speed_mps;
  memory.until_s = until_s;
}

/// What a ball at a place is worth to the team that has it.
double worth(const Scene& scene, Vec3 at) {
  const Vec3 goal{scene.goal_x(), 0, 0};
  const double edge = 0.5 * scene.field.width_m - std::abs(at.y), behind = at.x - (scene.goal_x() - 0.6);
  double value = 0.03 + 0.3 * math::exp(-norm(goal - at) / 4.0);
  if (edge < 0.8) value *= std::max(0.1, edge / 0.8);
  if (behind > 0 && std::abs(at.y) > 0.5 * scene.field.goal_width_m) value *= 0.2;
  return value;
}

double nearest_opponent(const Scene& scene, Vec3 at) {
  double nearest = 9;
  for (const Moving& each : scene.opponents) nearest = std::min(nearest, norm(flat(each.at - at)));
  return nearest;
}

bool inside(const Scene& scene, Vec3 at, double margin_m) {
  return std::abs(at.x) < 0.5 * scene.field.length_m - margin_m &&
         std::abs(at.y) < 0.5 * scene.field.width_m - margin_m;
}

/// The area of a goal, where no field player may be.
bool in_goal_area(const Scene& scene, Vec3 at) {
  return std::abs(at.x) > scene.goal_x() - scene.field.goal_area_depth_m - 0.35 &&
         std::abs(at.y) < 0.5 * scene.field.goal_area_width_m + 0.35;
}

/// Chance that the ball is still there after the turn towards a direction.
double after_turn(const Scene& scene, Vec3 direction, double nearest_m) {
  if (!scene.holds) return 1;
  const double angle = std::abs(math::wrap_angle(math::atan2(direction.y, direction.x) - scene.yaw_rad));
  const double pressed = std::clamp((1.6 - nearest_m) / 1.0, 0.05, 0.8);
  return std::max(0.05, 1 - pressed * angle / 3.0);
}

/// Chance of a pass: of its way, and that the receiver has it under control before an opponent comes.
double pass_chance(const Scene& scene, Vec3 to) {
  const double way = norm(to - scene.ball);
  const double room = room_beside(scene, scene.ball, to, rolls_on * pass_speed(scene, way), body_m, 1.2);
  const double alone = std::clamp(0.4 * nearest_opponent(scene, to), 0.2, 1.0);
  return std::clamp(0.45 + room, 0.0, 0.9) * (1 - 0.03 * way) * alone;
}

/// Where a team-mate will be when the ball comes: on the way to its target, which it reaches and does not pass.
Vec3 receives_at(const Mate& mate) {
  const Vec3 lead = 0.4 * mate.velocity, left = flat(mate.target - mate.at);
  const double way = norm(left), most = norm(lead);
  return mate.at + (most > way ? way / most : 1.0) * lead;
}

struct Option {
  Aim kind = Aim::none;
  Vec3 at;
  double value = -1, tolerance_rad = 0.1, speed_mps = 0;
};

const Mate* best_receiver(const Scene& scene, double least_gain_m, double& value) {
  const Mate* best = nullptr;
  value = 0;
  for (const Mate& mate : scene.mates) {
    if (mate.number == scene.keys->keeper) continue;
    const Vec3 to = receives_at(mate);
    const double way = norm(to - scene.ball), gain = to.x - scene.ball.x;
    if (way < 1.8 || way > 10 || gain < least_gain_m || !inside(scene, to, 0.3)) continue;
    // Who runs is hard to meet, and has to brake before it can wait for the ball.
    const double stands = std::max(0.2, 1 - 0.25 * norm(mate.velocity));
    const double each = stands * pass_chance(scene, to) * worth(scene, to);
    if (each > value) value = each, best = &mate;
  }
  return best;
}

}  // namespace

double pass_speed(const Scene& scene, double way_m) {
  const double rolls_mps = std::sqrt(catch_mps * catch_mps + 2 * rolling_mps2 * way_m);
  return std::clamp(rolls_mps / rolls_on, scene.keys->pass_speed_mps, 8.0);
}

Vec3 free_place(const Scene& scene, Vec3 usual) {
  const Vec3 ahead = normalised(Vec3{scene.goal_x(), 0, 0} - scene.ball);
  const auto beside = [&](Vec3 at) {
    return ahead.x * (at.y - scene.ball.y) - ahead.y * (at.x - scene.ball.x);
  };
  Vec3 best = usual;
  double most = -1;
  const auto consider = [&](Vec3 at) {
    if (!inside(scene, at, 0.8) || at.x > scene.goal_x() - scene.field.penalty_area_depth_m - 0.5) return;
    double value = pass_chance(scene, at) * worth(scene, at) - 0.002 * norm(at - scene.me);
    if (beside(at) * beside(scene.me) < 0 && std::abs(beside(scene.me)) > 1) value *= across_lane;
    if (value > most) most = value, best = at;
  };
  consider(usual);
  for (const double way : {3.0, 4.5, 6.0})
    for (const double turn : {-1.4, -0.7, 0.0, 0.7, 1.4}) {
      const auto [s, c] = math::sincos(turn);
      consider(scene.ball + way * turned(ahead, s, c));
    }
  return best;
}

double room_beside(const Scene& scene, Vec3 from, Vec3 to, double speed_mps, double reach_m,
                   double drive_mps2) {
  const Vec3 way = flat(to - from);
  const double length = norm(way);
  double room = 2;
  if (length < 1e-6) return room;
  const Vec3 u = (1 / length) * way;
  for (const Moving& each : scene.opponents) {
    const Vec3 off = flat(each.at - from);
    const double along = dot(off, u);
    if (along < 0.1 || along > length + 0.3) continue;
    const double t = std::max(0.0, along / speed_mps - 0.15);
    room = std::min(room, std::abs(off.x * u.y - off.y * u.x) - reach_m - 0.5 * drive_mps2 * t * t);
  }
  return room;
}

Shot best_shot(const Scene& scene, Vec3 from) {
  const double half = 0.5 * scene.field.goal_width_m;
  Shot best{{scene.goal_x() + 0.2, 0, 0}, -1};
  for (const int k : {0, -1, 1, -2, 2, -3, 3, -4, 4}) {
    const Vec3 at{scene.goal_x() + 0.2, 0.22 * half * k, 0};
    const Vec3 way = flat(at - from);
    const double length = norm(way);
    if (length < 0.3 || way.x <= 0) continue;
    const double room = room_beside(scene, from, at, shot_share * scene.keys->shot_speed_mps, body_m,
                                    1.3 * scene.keys->acceleration_mps2);
    // Seen from aside the mouth is narrower.
    const double post = (half - std::abs(at.y) - ball_radius_m) * way.x / length;
    const double scatter = 0.05 + 0.035 * length;
    const double chance = std::clamp(0.5 + 0.5 * std::min(room / (scatter + reach_std_m), post / scatter),
                                     0.0, 1.0);
    if (chance > best.chance + 1e-9) best = {at, chance};
  }
  best.chance = std::max(0.0, best.chance);
  return best;
}

void choose_aim(const Scene& scene, Memory& memory) {
  const double until = scene.now_s + keeps_aim_s;
  const Keys& keys = *scene.keys;
  const Style& style = scene.style;
  const Vec3 goal{scene.goal_x(), 0, 0};
  const double way = norm(goal - scene.ball);
  const Vec3 held_at = scene.game.positive ? memory.held_at : -memory.held_at;
  const double speed = norm(scene.velocity);
  const double carried = scene.holds ? norm(scene.ball - held_at) + speed * speed / (2 * brakes_mps2) : 0;
  // Before the way with the ball is over it must go, well aimed or not.
  const bool at_once = scene.holds && norm(scene.ball - held_at) > last_way_m;
  if (keys.play == Play::run_and_kick) {
    const double tolerance = at_once ? 1.2 : std::clamp(0.8 / std::max(0.5, way), 0.05, 0.3);
    return aim(memory, Aim::shot, goal, tolerance, keys.shot_speed_mps, until);
  }
  const double nearest = nearest_opponent(scene, scene.ball);
  Option best;
  const auto offer = [&](Option each) {
    each.value *= after_turn(scene, flat(each.at - scene.ball), nearest);
    if (each.value > best.value) best = each;
  };
  if (way < keys.shot_range_m) {
    const Shot shot = best_shot(scene, scene.ball);
    const double off_post = 0.5 * scene.field.goal_width_m - std::abs(shot.at.y);
    offer({Aim::shot, shot.at, shot.chance, std::clamp(0.35 * off_post / std::max(0.5, way), 0.03, 0.15),
           keys.shot_speed_mps});
  }
  double value = 0;
  if (const Mate* const mate = best_receiver(scene, -4, value); mate != nullptr) {
    const Vec3 to = receives_at(*mate);
    offer({Aim::pass, to, style.passes * value, 0.07, pass_speed(scene, norm(to - scene.ball))});
  }
  const Vec3 ahead = normalised(goal - scene.ball);
  for (const int k : {0, -1, 1, -2, 2, -3, 3}) {
    const auto [s, c] = math::sincos(0.4 * k);
    const Vec3 direction = turned(ahead, s, c);
    const double left = last_way_m - 0.4 - carried;
    if (scene.has_handler && left > 0.1) {
      const Vec3 to = scene.ball + std::min(left, 1.5) * direction;
      const double room = room_beside(scene, scene.ball, scene.ball + 1.8 * direction, 1.8, 0.5, 0.8);
      if (inside(scene, to, 0.3) && !in_goal_area(scene, to))
        offer({Aim::dribble, scene.ball + 3.0 * direction,
               style.carries * std::clamp(0.75 + 0.5 * room, 0.05, 1.0) * worth(scene, to), 0, 0});
    }
    constexpr double push_m = 3.0;
    const Vec3 to = scene.ball + push_m * direction;
    if (!inside(scene, to, 0.6) || in_goal_area(scene, to)) continue;
    const double lead = nearest_opponent(scene, to) - norm(to - scene.me);
    const double room = room_beside(scene, scene.ball, to, 1.5, body_m, 0.8);
    const double chance = std::clamp(0.5 + 0.5 * std::min(lead, room), 0.0, 0.85);
    offer({Aim::push, to, style.pushes * chance * worth(scene, to), 0.15, 3.2});
  }
  // Far ahead to the side where nobody stands.
  for (const double y : {-0.3, 0.3}) {
    const Vec3 to{std::min(scene.ball.x + 6, scene.goal_x() - 1), y * scene.field.width_m, 0};
    const double room = room_beside(scene, scene.ball, to, 4, body_m, 0.8);
    offer({Aim::clearance, to, std::clamp(0.25 + 0.15 * room, 0.02, 0.4) * worth(scene, to), 0.2,
           pass_speed(scene, norm(to - scene.ball))});
  }
  if (at_once) best.tolerance_rad = 1.2;
  aim(memory, best.kind, best.at, best.tolerance_rad, best.speed_mps, until);
}

void aim_of_keeper(const Scene& scene, Memory& memory) {
  const double until = scene.now_s + keeps_aim_s;
  double value = 0;
  if (const Mate* const mate = best_receiver(scene, 1.5, value);
      mate != nullptr && pass_chance(scene, mate->at) > 0.6)
    return aim(memory, Aim::pass, mate->at, 0.08, pass_speed(scene, norm(mate->at - scene.ball)), until);
  // Away to the side that is free, not across the own goal.
  Vec3 best;
  double most = -1e9;
  for (const double y : {-5.0, -2.5, 2.5, 5.0}) {
    const Vec3 to{-0.2 * scene.goal_x(), y, 0};
    const double room = room_beside(scene, scene.ball, to, 6, body_m, 0.8) + 0.05 * y * scene.ball.y;
    if (room > most) most = room, best = to;
  }
  aim(memory, Aim::clearance, best, 0.3, 7, until);
}

void aim_of_piece(const Scene& scene, Memory& memory) {
  const double until = scene.now_s + 0.5;
  const Vec3 goal{scene.goal_x(), 0, 0};
  if (scene.game.piece == Piece::penalty) {
    const Shot shot = best_shot(scene, scene.ball);
    return aim(memory, Aim::shot, shot.at, 0.06, scene.keys->shot_speed_mps, until);
  }
  // A goal straight from it would not count.
  if (scene.keys->play == Play::run_and_kick)
    return aim(memory, Aim::clearance, goal, 0.1, piece_clearance_mps, until);
  for (const Mate& mate : scene.mates) {
    const double way = norm(mate.target - scene.ball);
    if (mate.role == Role::supporter && way > 1.8 && way < 6 && pass_chance(scene, mate.target) > 0.5)
      return aim(memory, Aim::pass, mate.target, 0.08, pass_speed(scene, way), until);
  }
  double value = 0;
  if (const Mate* const mate = best_receiver(scene, -6, value))
    return aim(memory, Aim::pass, mate->at, 0.08, pass_speed(scene, norm(mate->at - scene.ball)), until);
  aim(memory, Aim::clearance, {scene.ball.x + 4, 0.5 * scene.ball.y, 0}, 0.1, piece_clearance_mps, until);
}

}  // namespace sandlot::controllers::soccer_player
