#pragma once
/// Set pieces: who stands where while one is prepared and taken.
#include "soccer/field.h"
#include "soccer/game.h"
#include "soccer/rules.h"

namespace sandlot::soccer {

/// All that a law may look at.
struct Scene {
  const Rules& rules;
  const Dimensions& field;
  const State& state;
  const Input& input;
  /// Null: not there. Robots that are out of play are not in `robots` of the scene.
  const SeenRobot* find(Who who) const;
  bool is_goalkeeper(Who who) const { return who.number == rules.goalkeeper; }
};

/// Spot of a set piece at a place.
Vec3 spot_of(const Scene& scene, SetPiece piece, int team, Vec3 place_m);

/// The robot of the team that is nearest to the spot: the one that takes the set piece. A goalkeeper takes it only where the
/// team has no other.
Who nearest_taker(const Scene& scene);

/// The first robot, by team and number, that stands where the set piece does not allow it; none: all is right.
/// @param started  START was given: only robots of the team that does not take it are bound
struct Violation {
  Who who;
  const char* what = "";
};
Violation violation(const Scene& scene, bool started);

/// Whether all robots stand.
bool all_stand(const Scene& scene);

}  // namespace sandlot::soccer
