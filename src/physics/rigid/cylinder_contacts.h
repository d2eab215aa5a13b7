#pragma once
/// Contacts of cylinders with cylinders, capsules and barrels, and of barrels with each other, which ODE
/// leaves out.
///
/// Method   penetration is the least overlap over all directions n, from A to B:
///          f(n) = s_A(n) + s_B(-n) - n . (p_B - p_A), with s the support functions h |n.a| + r sqrt(1 -
///          (n.a)^2) of a cylinder, h |n.a| + r of a capsule, and reach_m() of a barrel. Its minima lie on
///          kinks (n along an axis, n across an axis) or, where two rims meet, in between; the kinks are
///          tried in closed form, a pattern search does the rest. Contact points come from the parts that
///          face each other: disc, line or point.
/// Output   at most 4 points. ODE's convention: the normal points into A.
/// Limits   where the bodies overlap by more than half their size the direction may be any that parts them.
/// Cost     about 5 us per pair whose boxes overlap, less where a first direction already separates.
#include <ode/ode.h>

#include "geometry/pose.h"
#include "geometry/shape.h"

namespace sandlot::rigid {

/// Whether this is a pair that collide_round() serves (in either order).
bool is_round_pair(const Shape& a, const Shape& b);

/// Writes up to `most` contact geometries, `skip` bytes apart, as dCollide does (without g1, g2). @pre
/// is_round_pair
int collide_round(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, int most,
                  dContactGeom* out, int skip);

}  // namespace sandlot::rigid
