#pragma once
/// The ideal drive: an instance moves as if its base ran on rails.
///
/// Frame    the base link's x and y axes span the plane of the rails; motion along its z, roll and pitch are
///          left to gravity and contacts.
/// Motion   planar velocity and yaw rate of the base approach the target, each by at most its acceleration
///          times the sub-step. Every body gets the force that its own mass needs, so joints carry nothing of
///          it. On an arc the base is moved along the chord, hence it stays on the exact arc: the velocity of
///          the sub-step has the heading of its middle.
/// Limits   the weight along the plane is carried without bound, and so is the centripetal force; what the
///          bodies pull or an additional push that is limited to mass * max_accel. What pushes the base
///          without being known beforehand slows it by what it does within one sub-step: a base whose z leans
///          by `a` against the ground's normal moves g a h away from its target velocity.
#include "physics/rigid/parts.h"

namespace sandlot::rigid {

/// Adds this sub-step's forces and torques. @pre instance.drive.active
void push_drive(Instance& instance, Vec3 gravity_mps2, double h_s);

}  // namespace sandlot::rigid
