#pragma once
/// Roles without a coach, and the places that belong to them.
///
/// Method   each player solves the same small problem from what it heard: the goalkeeper is fixed; the smallest cost of getting the
///          ball makes the attacker, whose own cost counts 0.5 s less so that roles do not flutter; the others take the places of
///          supporter, defender and sweeper so that the sum of their squared ways is least, over all permutations of up to four.
/// Limits   players that hear different things may for a moment take the same role.
/// Cost     at most 24 permutations, no allocation.
#include "controllers/soccer_player/scene.h"

namespace sandlot::controllers::soccer_player {

/// Least time for a way that begins at a speed along it (negative: away), with the keys' acceleration and largest speed.
double time_for(const Keys& keys, double way_m, double speed_mps);
/// Where and when the player meets the ball at the earliest, being there 0.2 s before a ball that comes.
struct Meeting {
  Vec3 at;
  double after_s = 0;
};
Meeting meet(const Scene& scene);
/// Cost of getting the ball and playing it forward [s].
double cost_of(const Scene& scene, const Memory& memory);

struct Task {
  Role role = Role::none;
  int place = 0;  ///< 0 attacker; 1, 2, 3: of the places
  Vec3 target;
};
Task task_of(const Scene& scene, const Memory& memory, double own_cost_s);

/// The nearest legal place: in the field, out of goal areas, out of the opponents' penalty area but for the attacker and out of the
/// own one but for the first defender; with `room_m` that far from the ball.
Vec3 legal(const Scene& scene, Vec3 place, const Task& task, double room_m);

}  // namespace sandlot::controllers::soccer_player
