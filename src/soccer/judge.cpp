#include "soccer/judge.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "soccer/areas.h"

namespace sandlot::soccer {
namespace {

constexpr double ball_radius_m = 0.11;
constexpr double lost_below_m = -0.5;

/// Place at which the ball's middle passed the coordinate `limit` on its way in this tick.
Vec3 passed(const State& state, Vec3 to, double from_value, double to_value, double limit) {
  if (!state.ball_known || std::abs(from_value) >= limit || from_value == to_value) return to;
  const double part = std::clamp((limit - std::abs(from_value)) / (std::abs(to_value) - std::abs(from_value)),
                                 0.0, 1.0);
  return state.ball_m + part * (to - state.ball_m);
}

/// Whether a goal straight from the set piece, touched by its taker alone, counts.
bool counts(const Rules& rules, SetPiece piece) {
  switch (piece) {
    case SetPiece::kickoff: return rules.goal_from_kickoff;
    case SetPiece::throw_in: return rules.goal_from_throw_in;
    case SetPiece::free_kick: return rules.goal_from_free_kick;
    case SetPiece::corner: return rules.goal_from_corner;
    case SetPiece::goal_kick: return rules.goal_from_goal_kick;
    case SetPiece::dropped_ball: return rules.goal_from_dropped_ball;
    case SetPiece::penalty:
    case SetPiece::none: break;
  }
  return true;
}

Call over_goal_line(const Scene& scene, int side, Vec3 at) {
  const State& state = scene.state;
  const std::int8_t defends = state.defender(side), attacks = other(defends);
  const Who last = state.touches.last;
  if (!last)
    return {Law::lost_ball, SetPiece::dropped_ball, -1, {}, {}, "nobody is known to have touched the ball"};
  if (last.team == defends)
    return {
        Law::corner, SetPiece::corner, attacks, last, at, "over the goal line, last touched by a defender"};
  return {Law::goal_kick,
          SetPiece::goal_kick,
          defends,
          last,
          at,
          "over the goal line, last touched by an attacker"};
}

}  // namespace

std::optional<Call> judge_ball_out(const Scene& scene) {
  const State& state = scene.state;
  const Dimensions& field = scene.field;
  const Vec3 ball = scene.input.ball_m;
  if (ball.z < lost_below_m)
    return Call{Law::lost_ball, SetPiece::dropped_ball, -1, {}, {}, "the ball is below the field"};
  const double x = length_half_m(field) + ball_radius_m, y = width_half_m(field) + ball_radius_m;
  const bool out_x = std::abs(ball.x) > x, out_y = std::abs(ball.y) > y;
  if (!out_x && !out_y) return std::nullopt;
  const Vec3 over_x = passed(state, ball, state.ball_m.x, ball.x, x);
  const Vec3 over_y = passed(state, ball, state.ball_m.y, ball.y, y);
  // A ball that left over both lines in one tick is judged by the one that it passed first.
  if (out_y && !(out_x && std::abs(over_x.y) <= y)) {
    const Who last = state.touches.last;
    if (!last)
      return Call{
          Law::lost_ball, SetPiece::dropped_ball, -1, {}, {}, "nobody is known to have touched the ball"};
    return Call{Law::throw_in, SetPiece::throw_in, other(last.team), last, over_y, "over the touch line"};
  }
  const int side = ball.x < 0 ? -1 : 1;
  const bool between = std::abs(over_x.y) < field.goal_width_m / 2;
  Call out = over_goal_line(scene, side, over_x);
  if (!between) return out;
  if (over_x.z >= field.goal_height_m) {
    out.reason = "over the bar; " + out.reason;
    return out;
  }
  const std::int8_t defends = state.defender(side);
  const Touches& touches = state.touches;
  if (!touches.last)
    return Call{Law::no_goal, SetPiece::dropped_ball, -1, {}, {}, "nobody is known to have touched the ball"};
  if (state.piece != SetPiece::none && !touches.others && !counts(scene.rules, state.piece)) {
    out.law = Law::no_goal;
    out.reason = std::string("straight from the ") + name_of(state.piece);
    return out;
  }
  const bool own = touches.last.team == defends;
  return Call{own ? Law::own_goal : Law::goal,
              SetPiece::kickoff,
              defends,
              touches.last,
              {},
              own ? "fully over the goal line, by a robot of the team itself" : "fully over the goal line"};
}

std::optional<Call> judge_double_touch(const Scene& scene, bool again) {
  const State& state = scene.state;
  const Touches& touches = state.touches;
  if (!touches.taker || touches.others || state.piece == SetPiece::none ||
      state.piece == SetPiece::dropped_ball)
    return std::nullopt;
  const bool pushes_on = touches.taker_since_s == 0 &&
                         norm(scene.input.ball_m - touches.taken_m) > scene.rules.take_m;
  if (!again && !pushes_on) return std::nullopt;
  return Call{Law::double_touch,
              SetPiece::free_kick,
              other(touches.taker.team),
              touches.taker,
              scene.input.ball_m,
              again ? "the taker touched the ball again before any other robot" : "the taker kept the ball"};
}

std::optional<Call> judge_dribble(const Scene& scene) {
  const Touches& touches = scene.state.touches;
  if (!touches.holder || touches.holder_since_s > 0) return std::nullopt;
  if (norm(scene.input.ball_m - touches.got_m) <= scene.rules.dribble_m) return std::nullopt;
  return Call{Law::dribble,   SetPiece::free_kick, other(touches.holder.team),
              touches.holder, scene.input.ball_m,  "kept the ball for too long a way"};
}

std::optional<Call> judge_goal_area(const Scene& scene) {
  for (const RobotRecord& each : scene.state.robots)
    if (each.goal_area_s > scene.rules.goal_area_s)
      if (const SeenRobot* const robot = scene.find(each.who))
        return Call{Law::goal_area, SetPiece::free_kick, other(each.who.team),
                    each.who,       robot->position_m,   "a field player stayed in a goal area"};
  return std::nullopt;
}

std::optional<Call> judge_penalty_area(const Scene& scene) {
  for (const std::int8_t team : {std::int8_t{0}, std::int8_t{1}})
    for (const int side : {-1, 1}) {
      if (scene.state.teams[static_cast<std::size_t>(team)].crowded_s[side < 0 ? 0 : 1] <=
          scene.rules.penalty_area_s)
        continue;
      const bool own = scene.state.own_side(team) == side;
      return Call{Law::penalty_area,
                  SetPiece::free_kick,
                  other(team),
                  {},
                  {side * length_half_m(scene.field), scene.input.ball_m.y, 0},
                  own ? "too many defenders stayed in their penalty area"
                      : "too many attackers stayed in the other team's penalty area"};
    }
  return std::nullopt;
}

std::optional<Call> judge_pushing(const Scene& scene) {
  for (const RobotRecord& each : scene.state.robots) {
    if (each.pushed_Ns <= scene.rules.push_Ns) continue;
    const SeenRobot* const robot = scene.find(each.who);
    if (!robot) continue;
    const bool at_home = in_penalty_area(scene.field, robot->position_m, scene.state.own_side(each.who.team));
    return Call{Law::pushing,         at_home ? SetPiece::penalty : SetPiece::free_kick,
                other(each.who.team), each.who,
                robot->position_m,    "pushed a robot of the other team"};
  }
  return std::nullopt;
}

std::optional<Call> judge_blocked_ball(const Scene& scene) {
  const State& state = scene.state;
  if (state.anchor_s <= std::min(scene.rules.scrum_s, scene.rules.stuck_s)) return std::nullopt;
  bool near[2] = {};
  for (const SeenRobot& each : scene.input.robots)
    if (norm(each.position_m - Vec3{scene.input.ball_m.x, scene.input.ball_m.y, each.position_m.z}) <=
        scene.rules.scrum_robot_m)
      near[each.who.team == 0 ? 0 : 1] = true;
  if (near[0] && near[1] && state.anchor_s > scene.rules.scrum_s)
    return Call{Law::scrum, SetPiece::dropped_ball, -1,
                {},         scene.input.ball_m,     "robots of both teams block the ball"};
  if (state.anchor_s > scene.rules.stuck_s)
    return Call{Law::stuck_ball,    SetPiece::dropped_ball,  -1, {},
                scene.input.ball_m, "the ball does not move"};
  return std::nullopt;
}

// -------------------------------------------------------------------------------------------------- what laws read

void follow_areas(const Scene& scene, State& state) {
  int inside[2][2] = {};  // team, side
  for (RobotRecord& record : state.robots) {
    const SeenRobot* const robot = scene.find(record.who);
    if (!robot || scene.is_goalkeeper(record.who)) {
      record.goal_area_s = 0;
      if (!robot) continue;
    }
    const int team = record.who.team == 0 ? 0 : 1;
    bool in_goal_area_now = false;
    for (const int side : {-1, 1}) {
      const bool own_keeper = scene.is_goalkeeper(record.who) && state.own_side(team) == side;
      if (own_keeper) continue;
      if (in_penalty_area(scene.field, robot->position_m, side)) ++inside[team][side < 0 ? 0 : 1];
      in_goal_area_now = in_goal_area_now || in_goal_area(scene.field, robot->position_m, side);
    }
    record.goal_area_s = in_goal_area_now ? record.goal_area_s + scene.input.dt_s : 0;
  }
  for (const int team : {0, 1})
    for (const int side : {-1, 1}) {
      const int most = state.own_side(team) == side ? scene.rules.defenders : scene.rules.attackers;
      double& time_s = state.teams[static_cast<std::size_t>(team)].crowded_s[side < 0 ? 0 : 1];
      time_s = inside[team][side < 0 ? 0 : 1] > most ? time_s + scene.input.dt_s : 0;
    }
}

/// The impulse counts for the robot that came with more speed along it, by its velocity before the tick. What was counted fades
/// with a time constant of a second.
void follow_pushes(const Scene& scene, State& state) {
  const double keep = math::exp(-scene.input.dt_s);
  for (RobotRecord& each : state.robots) each.pushed_Ns *= keep;
  const auto record_of = [&](Who who) -> RobotRecord* {
    for (RobotRecord& each : state.robots)
      if (each.who == who) return &each;
    return nullptr;
  };
  for (const Blow& blow : scene.input.blows) {
    RobotRecord *const a = record_of(blow.a), *const b = record_of(blow.b);
    const SeenRobot *const at_a = scene.find(blow.a), *const at_b = scene.find(blow.b);
    if (!a || !b || !at_a || !at_b) continue;
    const Vec3 between{at_b->position_m.x - at_a->position_m.x, at_b->position_m.y - at_a->position_m.y, 0};
    const double distance_m = norm(between);
    if (distance_m <= 0) continue;
    const Vec3 n = (1 / distance_m) * between;
    const double towards_b = dot(a->velocity_mps, n), towards_a = -dot(b->velocity_mps, n);
    RobotRecord* const pusher = towards_b >= towards_a ? a : b;
    const double faster = std::max(towards_a, towards_b),
                 slower = std::max(0.0, std::min(towards_a, towards_b));
    if (faster - slower < scene.rules.push_mps) continue;
    pusher->pushed_Ns += std::abs(dot(blow.impulse_Ns, n));
  }
}

void follow_ball(const Scene& scene, State& state) {
  const Vec3 ball = scene.input.ball_m;
  if (norm(ball - state.anchor_m) > scene.rules.scrum_m) {
    state.anchor_m = ball;
    state.anchor_s = 0;
    return;
  }
  state.anchor_s += scene.input.dt_s;
}

}  // namespace sandlot::soccer
