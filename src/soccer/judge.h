#pragma once
/// Judge: one function per law of the running game. Each looks at a scene and says what follows, if anything.
#include <optional>

#include "soccer/set_pieces.h"

namespace sandlot::soccer {

/// A law that applies.
struct Call {
  Law law = Law::begin;
  SetPiece piece = SetPiece::none;  ///< how the game goes on
  std::int8_t team = -1;            ///< in whose favour
  Who robot;                        ///< who it is about
  Vec3 place_m;                     ///< where it happened
  std::string reason;
};

/// The ball left the field: goal, corner kick, goal kick, throw-in or dropped ball. A goal counts as Law::goal or own_goal, with
/// the team that conceded it as the one that kicks off.
std::optional<Call> judge_ball_out(const Scene& scene);
std::optional<Call> judge_double_touch(const Scene& scene, bool again);
std::optional<Call> judge_dribble(const Scene& scene);
/// Reads the times that robots and teams have been where they should not be.
std::optional<Call> judge_goal_area(const Scene& scene);
std::optional<Call> judge_penalty_area(const Scene& scene);
std::optional<Call> judge_pushing(const Scene& scene);
std::optional<Call> judge_blocked_ball(const Scene& scene);

// Times and impulses that the laws read.
void follow_areas(const Scene& scene, State& state);
void follow_pushes(const Scene& scene, State& state);
void follow_ball(const Scene& scene, State& state);

}  // namespace sandlot::soccer
