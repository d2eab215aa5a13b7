#pragma once
/// Motion: the velocity that leads to a place and a heading, around what is in the way.
///
/// Method   the wanted velocity is turned by steps of 15 degrees to either side; the direction counts that loses the least: its
///          deviation and how soon it meets something within 1.2 s, weighed. A robot that is already touched is left along the
///          directions that lead away.
/// Drives   holonomic ones move in any direction while they turn; others turn towards the way and drive forward or backwards.
/// Cost     13 directions x discs of a few operations, two sines, no allocation.
#include <span>

#include "controllers/soccer_player/beliefs.h"
#include "messages/messages.h"
#include "soccer/field.h"

namespace sandlot::controllers::soccer_player {

struct Limits {
  double speed_mps = 2, turn_speed_radps = 5, acceleration_mps2 = 2;
};
struct Moving {
  Vec3 at, velocity;
  double radius_m = 0;  ///< sum of both radii
};

/// Velocity in F towards a place that moves on with a velocity of its own.
Vec3 velocity_to(Vec3 from, Vec3 to, Vec3 moves_on, const Limits& limits);
Vec3 around(Vec3 from, Vec3 wanted, std::span<const Moving> discs);
/// @param yaw_rad  heading to have; of a drive that does not move sideways only when it stands
msg::Twist drive(const Self& self, Vec3 velocity, double yaw_rad, const Limits& limits, bool holonomic);

/// The target, or where to go before: who stands in a goal or beside it comes back to the field first, straight along it.
Vec3 beside_goals(const soccer::Dimensions& field, Vec3 from, Vec3 to);

}  // namespace sandlot::controllers::soccer_player
