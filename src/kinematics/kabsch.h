#pragma once
/// Odometry by Kabsch: the rigid motion that takes where the wheels were best to where they are now.
///
/// P: points before, Q: after. With both centred, the angle that minimises sum |R p + t - q|^2 is in the
/// plane
///
///   theta = atan2(sum (p_x q_y - p_y q_x), sum (p_x q_x + p_y q_y)),     t = mean(q) - R mean(p),
///
/// which is what the singular value decomposition of P^T Q with its sign rule comes to. The root mean square
/// deviation that remains is zero for wheels that roll: a measure of their slip.
///
/// rolled() makes Q of wheels that rolled r dphi along their heading: in a step the chassis turns, so that a
/// wheel runs on an arc whose chord points half the turn further. The turn is found without and then twice
/// with that correction; what remains is of seventh order in the turn per step.
///
/// Units    m, rad. Frame: that of the chassis before the step.
/// Errors   none at run time. @pre two points that differ
/// Cost     an arc tangent and a sine-cosine pair per fit.
/// Source   W. Kabsch, Acta Crystallographica A32 (1976) 922-923; its use as odometry: the MARIO paper, eq.
///          12-13.
#include <span>

#include "kinematics/wheels.h"

namespace sandlot::kinematics {

struct RigidFit {
  double x_m = 0, y_m = 0, turn_rad = 0;  ///< pose of the frame after in the frame before
  double rmsd_m = 0;
};
RigidFit kabsch(std::span<const Direction> before, std::span<const Direction> after);

/// The displacement of D over a step, as PlanarMotion counts it (integrate() makes a pose of it), and the
/// deviation.
/// @param turns  of each wheel [rad] during the step; wheels that are not `counted` are left out. At most
///               64. @pre all are ordinary wheels
Estimate rolled(std::span<const Wheel> wheels, std::span<const double> turns);

}  // namespace sandlot::kinematics
