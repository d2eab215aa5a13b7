#pragma once
/// Shortest paths of a car in the open: Reeds-Shepp (forward and backward) and Dubins (forward only).
///
/// Paths of arcs at the least turning radius and straights; of the 48 Reeds-Shepp words (6 Dubins words) the one
/// of least price, where metres backward may count more and a change of direction may cost something.
///
/// Frame    poses in one frame; lengths in metres.
/// Errors   none: poses are finite and the radius positive, or the answer is empty.
/// Limits   steering changes at once (no clothoids). With prices other than 1 and 0 the best path may lie
///          outside the 48 words, which are complete only for the shortest.
/// Cost     Reeds-Shepp about 6 us, Dubins 2 us.
/// Source   J. A. Reeds, L. A. Shepp, Optimal paths for a car that goes both forwards and backwards (1990),
///          formulas 8.1 to 8.11 with the corrections of OMPL (ReedsSheppStateSpace); L. E. Dubins (1957);
///          A. M. Shkel, V. Lumelsky, Classification of the Dubins set (2001).
#include <array>

#include "navigation/planning/motion.h"

namespace sandlot::navigation {

struct CarPath {
  std::array<Move, 5> moves;
  int count = 0;
  double length_m = 0;
  double price = 0;
};

struct CarPrices {
  double backward_factor = 1;  ///< price of a metre backward; forward: 1
  double change = 0;           ///< price of a change between forward and backward
};

CarPath reeds_shepp(const Pose2& from, const Pose2& to, double radius_m, const CarPrices& prices = {});
CarPath dubins(const Pose2& from, const Pose2& to, double radius_m);

}  // namespace sandlot::navigation
