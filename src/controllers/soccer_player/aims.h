#pragma once
/// Aims: what a player does with the ball, chosen by what each thing that it could do is worth.
///
/// Worth    of a ball at a place, in the hands of the team: about how likely it comes to a goal, more in front of the goal and less
///          beside the touch lines. What may be done is worth the probability that it comes off times the worth of where the
///          ball is then:
///          shot      1 if it passes opponents and lies between the posts. An opponent reaches 0.36 m and what it drives until the ball
///                    is there; the ball scatters by 0.05 m and 3.5 % of the way, and the reach by 0.15 m;
///          pass      to where a team-mate will be, on a line that no opponent reaches sooner, better where no opponent is near it;
///          carry     with the handler, in seven directions, as far as the rules let it;
///          push on   a soft kick ahead to where the player itself is sooner than anybody else;
///          clearance far ahead, away from opponents.
///          Turning towards the aim costs time, more where an opponent is near.
/// Styles   multiply the worth of passes, of carrying and of pushing on (keys.h). The style `run_and_kick` does none of it: it
///          kicks at the goal from wherever it is.
/// Limits   opponents are taken to stand where they are, and to drive at any ball that passes near.
/// Cost     about thirty lines against all opponents.
#include "controllers/soccer_player/scene.h"

namespace sandlot::controllers::soccer_player {

void choose_aim(const Scene& scene, Memory& memory);
/// Aim of an own set piece: where the one that offers itself will stand, else any free team-mate, else ahead.
void aim_of_piece(const Scene& scene, Memory& memory);
/// Aim of a goalkeeper with the ball: a free team-mate, else the side without opponents.
void aim_of_keeper(const Scene& scene, Memory& memory);

/// Place in front of the ball where the supporter can be reached by a pass, of 15 at 3 to 6 m from the ball the one where the
/// ball would be worth most, less 0.002 per metre of its own way there; `usual` is a sixteenth. One on the other
/// side of the way to the goal counts less.
Vec3 free_place(const Scene& scene, Vec3 usual);

/// Speed with which to kick a ball that shall arrive after a way at `catch_mps`.
double pass_speed(const Scene& scene, double way_m);

/// Point of the goal's mouth that a shot from `from` has the best chance at, and that chance, 0 to 1.
struct Shot {
  Vec3 at;
  double chance = 0;
};
Shot best_shot(const Scene& scene, Vec3 from);

/// Least distance of opponents from a ball's way beside what they reach until it is there [m], at most 2.
/// @param speed_mps  of the ball, constant; @param reach_m  of an opponent that stands still; @param drive_mps2  with which it starts
double room_beside(const Scene& scene, Vec3 from, Vec3 to, double speed_mps, double reach_m,
                   double drive_mps2);

}  // namespace sandlot::controllers::soccer_player
