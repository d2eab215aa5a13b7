#include "soccer/set_pieces.h"

#include "soccer/areas.h"

namespace sandlot::soccer {
namespace {

double distance_m(Vec3 a, Vec3 b) { return norm(Vec3{a.x - b.x, a.y - b.y, 0}); }

}  // namespace

const SeenRobot* Scene::find(Who who) const {
  for (const SeenRobot& each : input.robots)
    if (each.who == who) return &each;
  return nullptr;
}

Vec3 spot_of(const Scene& scene, SetPiece piece, int team, Vec3 place_m) {
  const Dimensions& field = scene.field;
  const int other_side = team < 0 ? 1 : scene.state.attacks(team);
  switch (piece) {
    case SetPiece::throw_in: return throw_in_spot(field, place_m);
    case SetPiece::corner: return corner_spot(field, {static_cast<double>(other_side), place_m.y, 0});
    case SetPiece::goal_kick: return restart_spot(field, place_m, -other_side);
    case SetPiece::free_kick:
    case SetPiece::dropped_ball: return free_spot(field, place_m);
    case SetPiece::penalty: return penalty_mark(field, other_side);
    case SetPiece::kickoff:
    case SetPiece::none: break;
  }
  return {};
}

Who nearest_taker(const Scene& scene) {
  Who best, keeper;
  double nearest_m = 1e9;
  for (const SeenRobot& each : scene.input.robots) {
    if (each.who.team != scene.state.team) continue;
    if (scene.is_goalkeeper(each.who)) {
      keeper = each.who;
      continue;
    }
    const double d_m = distance_m(each.position_m, scene.state.spot_m);
    if (d_m < nearest_m) nearest_m = d_m, best = each.who;
  }
  return best ? best : keeper;
}

namespace {

/// What a robot does wrong at a kick-off.
const char* at_kickoff(const Scene& scene, const SeenRobot& robot, bool takes, double d_m) {
  const State& state = scene.state;
  const Rules& rules = scene.rules;
  if (!takes && robot.position_m.x * state.attacks(robot.who.team) > rules.tolerance_m)
    return "is in the other half";
  if (robot.who.team != state.team && d_m < rules.opponents_m - rules.tolerance_m)
    return "is too near to the ball";
  if (robot.who.team == state.team && !takes && d_m < rules.teammates_m - rules.tolerance_m)
    return "is too near to the ball";
  return nullptr;
}

const char* at_penalty(const Scene& scene, const SeenRobot& robot, bool takes, double d_m) {
  const State& state = scene.state;
  const bool at_home = in_penalty_area(scene.field, robot.position_m, state.own_side(robot.who.team));
  if (takes || (at_home && scene.is_goalkeeper(robot.who))) return nullptr;
  if (in_any_penalty_area(scene.field, robot.position_m)) return "is in a penalty area";
  return d_m < scene.rules.opponents_m - scene.rules.tolerance_m ? "is too near to the ball" : nullptr;
}

}  // namespace

Violation violation(const Scene& scene, bool started) {
  const State& state = scene.state;
  const Rules& rules = scene.rules;
  const Who taker = nearest_taker(scene);
  int near = 0;  // team-mates besides the taker
  for (const SeenRobot& each : scene.input.robots) {
    if (started && each.who.team == state.team) continue;
    const bool takes = each.who == taker;
    const double d_m = distance_m(each.position_m, state.spot_m);
    const bool at_home = in_penalty_area(scene.field, each.position_m, state.own_side(each.who.team));
    const char* what = nullptr;
    switch (state.piece) {
      case SetPiece::kickoff: what = at_kickoff(scene, each, takes, d_m); break;
      case SetPiece::penalty: what = at_penalty(scene, each, takes, d_m); break;
      case SetPiece::dropped_ball:
        if (d_m < rules.dropped_ball_m - rules.tolerance_m && !at_home) what = "is too near to the ball";
        break;
      case SetPiece::throw_in:
      case SetPiece::corner:
      case SetPiece::goal_kick:
      case SetPiece::free_kick:
        if (each.who.team != state.team) {
          if (d_m < rules.opponents_m - rules.tolerance_m && !at_home) what = "is too near to the ball";
        } else if (!takes && d_m < rules.teammates_m - rules.tolerance_m && ++near > 1) {
          what = "is the second team-mate too near to the ball";
        }
        break;
      case SetPiece::none: break;
    }
    if (what) return {each.who, what};
  }
  return {};
}

bool all_stand(const Scene& scene) {
  for (const SeenRobot& each : scene.input.robots)
    if (!(norm(each.velocity_mps) <= scene.rules.ready_mps)) return false;
  return true;
}

}  // namespace sandlot::soccer
