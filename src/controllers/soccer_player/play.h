#pragma once
/// Play: what a player does with its task: get the ball, aim, shoot, pass, dribble, keep the goal, take and await set pieces.
///
/// Attack   goes to where it meets the ball; a slow ball is approached from behind as seen from the aim, or with a handler straight.
///          What to do with it: aims.h.
/// Keeper   stands on the line from the ball to the goal, 0.6 m before it; a shot is met where it crosses; a ball nearer than 2.5 m
///          that no team-mate reaches sooner is fetched and cleared.
/// Pieces   own: the attacker stands behind the ball and passes, or shoots from a penalty, once play runs; others keep 2.2 m. Of
///          the opponents: all keep 3.2 m until the ball is in play; from a dropped ball 1.3 m. Own half at kick-off.
/// Cost     that of aims.h when an aim is chosen, five times in two seconds; else a few operations.
#include "controllers/soccer_player/roles.h"

namespace sandlot::controllers::soccer_player {

/// @param memory  the aim is kept in it; in A during the call
Intent decide(const Scene& scene, const Task& task, Memory& memory);

}  // namespace sandlot::controllers::soccer_player
