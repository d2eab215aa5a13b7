#include "controllers/soccer_player/play.h"

#include <algorithm>

#include "base/math.h"
#include "control/steering.h"
#include "controllers/soccer_player/aims.h"
#include "controllers/soccer_player/tracking.h"

namespace sandlot::controllers::soccer_player {
namespace {

/// Time before a ball arrives in which the player begins to move with it.
constexpr double gives_way_s = 0.4;

double heading(Vec3 v) { return math::atan2(v.y, v.x); }

/// Lets a moving ball come to the front: a ball that comes is met on its way, by a player that faces it and gives way as fast as the
/// handler needs; one that goes away is followed.
Intent receive(const Scene& scene, const Meeting& meeting, Intent out) {
  const Vec3 off = flat(scene.ball - scene.me), way = normalised(scene.ball_velocity);
  const double front = scene.keys->front_m, speed = norm(scene.ball_velocity), ahead = -dot(off, way);
  out.yaw_rad = heading(off);
  if (ahead < 0) {
    out.target = meeting.at - front * normalised(off);
    return out;
  }
  out.target = meeting.at + front * way;
  const double comes_mps = speed - dot(scene.velocity, way), beside = norm(off + ahead * way);
  if (beside < 0.3 && comes_mps > catch_mps && ahead - front < gives_way_s * comes_mps)
    out.moves_on = (speed - catch_mps) * way;
  return out;
}

/// Gets the ball and plays it to where the memory aims.
Intent play_ball(const Scene& scene, Memory& memory) {
  const Vec3 ball = scene.ball, off = flat(ball - scene.me);
  const double distance = norm(off);
  const Vec3 direction = normalised(memory.at - ball);
  Intent out;
  out.speed_mps = scene.keys->speed_mps;
  out.handler = scene.has_handler && distance < 1.2;
  out.yaw_rad = heading(direction);
  out.kick = memory.aim != Aim::dribble;
  if (scene.holds) {
    out.keeps_clear = memory.aim == Aim::dribble;
    if (memory.aim == Aim::dribble) {
      out.name = "dribble";
      out.target = scene.me + 1.5 * normalised(memory.at - scene.me);
      out.speed_mps = 2.2;
    } else {
      out.name = name_of(memory.aim);
      out.target = scene.me + 0.15 * direction;
      out.speed_mps = 0.5;
      // The ball has the robot's velocity, too.
      out.yaw_rad = heading(memory.speed_mps * direction - scene.velocity);
    }
    return out;
  }
  const double speed = norm(scene.ball_velocity);
  const double along = dot(off, direction), across = std::abs(off.x * direction.y - off.y * direction.x);
  const bool right_behind = along > 0.15 && across < 0.06 + 0.3 * std::max(0.0, along - 0.32);
  if (speed > 0.7 && distance > 0.6) {  // meets it where it comes
    const Meeting meeting = meet(scene);
    out.name = "intercept";
    if (scene.has_handler) return receive(scene, meeting, out);
    // Not in its way from the front: the place beside which it passes is met head on.
    out.target = meeting.at - scene.keys->front_m * normalised(ball - meeting.at, direction) +
                 0.6 * scene.keys->front_m * normalised(ball - meeting.at, direction);
    if (dot(scene.ball_velocity, direction) > 0.3 * speed) out.target = meeting.at - 0.45 * direction;
    else out.yaw_rad = heading(off);
    return out;
  }
  if (scene.has_handler) {
    out.name = "get";
    out.yaw_rad = heading(off);
    out.target = ball - 0.2 * normalised(off);
    out.moves_on = scene.ball_velocity;
    out.keeps_clear = distance > 0.8;
    if (distance < 1) out.speed_mps = std::min(out.speed_mps, speed + 0.6 + distance);
    return out;
  }
  if (right_behind) {
    out.name = name_of(memory.aim);
    out.target = ball + 0.3 * direction;
    out.moves_on = scene.ball_velocity;
    out.keeps_clear = false;
    out.speed_mps = std::min(out.speed_mps, 1.0 + distance);
    return out;
  }
  out.name = "go behind";
  const Vec3 behind = ball - 0.62 * direction;
  const steering::Disc disc{ball, 0.5};
  out.target = steering::way_around(scene.me, behind, {&disc, along > 0.45 ? 0u : 1u});
  out.moves_on = scene.ball_velocity;
  if (distance > 1.5) out.yaw_rad = heading(off);
  return out;
}

Intent stand_at(const Scene& scene, const char* name, Vec3 place, double speed_mps, double ball_room_m) {
  Intent out;
  out.name = name;
  out.target = place;
  out.speed_mps = speed_mps;
  out.yaw_rad = heading(scene.ball - scene.me);
  out.ball_room_m = ball_room_m;
  return out;
}

Intent keep(const Scene& scene, Memory& memory, bool may_leave) {
  const double gx = scene.goal_x(), half = 0.5 * scene.field.goal_width_m;
  const Vec3 goal{-gx, 0, 0}, ball = scene.ball;
  if (!scene.ball_known) return stand_at(scene, "keep", {0.4 - gx, 0, 0}, scene.keys->speed_mps, 0);
  // A shot: where it crosses the line on which the keeper stands.
  const double line_x = 0.45 - gx, v = scene.ball_velocity.x;
  if (v < -0.6 && ball.x > line_x) {
    const double t = (line_x - ball.x) / v;
    const double y = ball.y + scene.ball_velocity.y * t;
    if (t < 3 && std::abs(y) < half + 0.4) {
      Intent out = stand_at(scene, "save", {line_x, std::clamp(y, -half, half), 0}, 5, 0);
      out.keeps_clear = false;
      out.handler = scene.has_handler;
      // It brakes late: a shot gives no time to come to rest.
      out.moves_on = {0, std::clamp(2.5 * (out.target.y - scene.me.y), -2.0, 2.0), 0};
      return out;
    }
  }
  const bool near = std::abs(ball.y) < 0.5 * scene.field.penalty_area_width_m && ball.x < 2.2 - gx &&
                    ball.x > -gx - 0.1;
  double sooner = 1e9;
  for (const Mate& mate : scene.mates) sooner = std::min(sooner, mate.cost_s);
  const double mine = meet(scene).after_s;
  if (may_leave &&
      (scene.holds || (near && norm(scene.ball_velocity) < 1.5 && (mine < sooner || ball.x < 0.9 - gx)))) {
    if (scene.now_s > memory.until_s || memory.aim == Aim::none || memory.aim == Aim::dribble)
      aim_of_keeper(scene, memory);
    return play_ball(scene, memory);
  }
  const Vec3 to_ball = normalised(ball - goal);
  Vec3 place = goal + 0.75 * to_ball;
  place.x = std::max(place.x, 0.4 - gx);
  place.y = std::clamp(place.y, 0.15 - half, half - 0.15);
  // On its way home it stays clear of a ball that waits for its set piece.
  return stand_at(scene, "keep", place, scene.keys->speed_mps, may_leave ? 0 : 0.8);
}

/// Own set piece: the taker stands behind the ball until play may go on, comes straight, kicks once, and leaves the ball alone.
Intent take_ball(const Scene& scene, Memory& memory) {
  if (memory.aim == Aim::none || memory.aim == Aim::dribble || scene.now_s > memory.until_s)
    aim_of_piece(scene, memory);
  const Vec3 direction = normalised(memory.at - scene.ball), off = flat(scene.ball - scene.me);
  const double along = dot(off, direction), across = std::abs(off.x * direction.y - off.y * direction.x);
  const double error = std::abs(math::wrap_angle(heading(direction) - scene.yaw_rad));
  Intent out = stand_at(scene, "take", scene.ball - 0.85 * direction, scene.keys->speed_mps, 0);
  out.yaw_rad = heading(direction);
  if (scene.game.phase == Phase::running && along > 0.2 && along < 1.2 &&
      across < (along < 0.7 ? 0.11 : 0.08) && error < 0.12) {
    out.target = scene.ball + 0.3 * direction;
    out.speed_mps = 0.9;
    out.keeps_clear = false;
    out.kick = true;
    return out;
  }
  const Vec3 behind = out.target;
  if (norm(off) < 1.8) out.speed_mps = 1.1;
  if (norm(behind - scene.me) < 0.36) return out;
  const steering::Disc disc{scene.ball, 0.78};
  out.target = steering::way_around(scene.me, behind, {&disc, along > 0.78 ? 0u : 1u});
  out.rests = false;
  return out;
}

}  // namespace

Intent decide(const Scene& scene, const Task& task, Memory& memory) {
  const Game& game = scene.game;
  const bool ours = game.whose == Whose::ours, piece = game.piece != Piece::none && !scene.open;
  if (game.phase == Phase::stopped || game.out) {
    // The ball comes to where it left the field: nobody may stand there.
    const double x = scene.goal_x() - 0.4, y = 0.5 * scene.field.width_m - 0.15;
    const Vec3 spot{std::clamp(game.spot.x, -x, x), std::clamp(game.spot.y, -y, y), 0};
    const Vec3 off = flat(scene.me - spot);
    const double distance = norm(off);
    if (!scene.ball_known || game.out || distance > 1.1) return stand_at(scene, "stop", scene.me, 0.5, 0);
    const Vec3 away = normalised(off, Vec3{-1, 0, 0});
    return stand_at(scene, "leave", spot + 1.3 * away, 1, 0);
  }
  if (task.role == Role::keeper) {
    const bool may = scene.open;
    return keep(scene, memory, may);
  }
  if (piece) {
    if (ours && task.role == Role::attacker && game.piece != Piece::dropped_ball)
      return take_ball(scene, memory);
    double room = ours ? 2.3 : 3.4;
    if (game.piece == Piece::dropped_ball) room = 1.4;
    Vec3 place = task.target;
    if (task.role == Role::attacker)
      place = scene.ball + room * normalised(Vec3{-scene.goal_x(), 0, 0} - scene.ball);
    if (ours && task.place == 1) {  // to receive
      place = {scene.ball.x + (game.piece == Piece::kickoff ? -0.6 : 0.8), scene.ball.y + 2.6 * scene.side,
               0};
      if (game.piece == Piece::corner) place.x = scene.ball.x - 2.6;
    }
    if (game.piece == Piece::penalty) {
      const double back = std::min(scene.ball.x, scene.goal_x() - 3.6) - room;
      const double fore = std::max(scene.ball.x, 3.6 - scene.goal_x()) + room;
      place.x = ours ? std::min(place.x, back) : std::max(place.x, fore);
    }
    place = legal(scene, place, task, room);
    if (game.piece == Piece::kickoff) place.x = std::min(place.x, -0.4);
    return stand_at(scene, "wait", place, scene.keys->speed_mps, room - 0.15);
  }
  if (!scene.ball_known) {
    Intent out = stand_at(
        scene, "search", legal(scene, task.role == Role::attacker ? scene.me : task.target, task, 0), 1.5, 0);
    out.yaw_rad = scene.yaw_rad + 1;
    return out;
  }
  if (memory.taken)  // the ball is for others now
    return stand_at(scene, "leave", legal(scene, task.target, task, 1.5), scene.keys->speed_mps, 1);
  if (task.role == Role::attacker) {
    const double gx = scene.goal_x(), edge = gx - scene.field.goal_area_depth_m;
    const bool shut = std::abs(scene.ball.x) > edge + 0.05 &&
                      std::abs(scene.ball.y) < 0.5 * scene.field.goal_area_width_m + 0.05;
    if (shut && !scene.holds)  // the ball is in a goal area: that is for goalkeepers
      return stand_at(scene, "await", legal(scene, scene.ball, task, 0), scene.keys->speed_mps, 0);
    if (scene.now_s > memory.until_s || memory.aim == Aim::none ||
        (memory.aim == Aim::dribble && !scene.has_handler))
      choose_aim(scene, memory);
    Intent out = play_ball(scene, memory);
    // The body stays out of the goal areas.
    if (std::abs(out.target.y) < 0.5 * scene.field.goal_area_width_m + 0.3)
      out.target.x = std::clamp(out.target.x, 0.3 - edge, edge - 0.3);
    out.target.x = std::clamp(out.target.x, -gx - 0.3, gx + 0.3);
    out.target.y = std::clamp(out.target.y, -0.5 * scene.field.width_m - 0.5,
                              0.5 * scene.field.width_m + 0.5);
    return out;
  }
  if (!scene.style.places && task.place == 0) return stand_at(scene, "stand", scene.me, 0.5, 0);
  return stand_at(scene, "position",
                  legal(scene, task.target, task, task.place == 2 && scene.style.pressers > 0 ? 0.9 : 1.5),
                  scene.keys->speed_mps, 0.6);
}

}  // namespace sandlot::controllers::soccer_player
