#pragma once
/// Joints on ODE: what each kind of joint is made of, and its position, velocity and effort.
///
/// A revolute or continuous joint is a hinge with its motor; a prismatic one a slider with a separate linear
/// motor; a universal one ODE's, a screw a piston (which slides and turns about one axis), both with separate
/// angular motors. Limits, spring with damping, and friction are rows of their own (`extra`), made only where
/// the declaration has them, so that a motor at a limit, or against friction, gets its exact effort.
///
///   limit     unwrapped position, corrected by ERP: overshoot of at most one sub-step's motion
///   spring    implicit: (d + h k) v + effort = -k (x - x0), stable for any stiffness and sub-step
///   friction  Coulomb: velocity 0 with at most `friction`
///   thread    slide = pitch / (2 pi) * turn, as one two-sided contact between the flanks of the thread: the
///             two bodies do not move against each other along the direction that lies on a flank's normal
///   motor     of its own: effort - (damping + inertia / h) (v - v_before) ..., one row, compliant by the
///             inverse of that slope; friction of a motor is a row in the contacts' group, made in every
///             sub-step
///   mimic     a velocity motor with at most the joint's max_effort: the leader's velocity times the
///             multiplier, and ERP of the position error per sub-step
///
/// Universal  position and velocity are those about the first axis, which the parent carries; the second,
///            which the child carries, is passive. Its limits act within half a turn to either side.
/// Screw      position is the angle [rad], effort the torque about the axis.
/// Limits     ball joints have damping and friction about each axis of J, no limits, motor or position.
///            max_velocity bounds velocity targets only. A leader does not feel its followers; targets of a
///            follower are ignored.
#include "physics/rigid/parts.h"

namespace sandlot::rigid {

/// Makes the ODE joints. @pre the bodies stand in the declared pose, the model at X_WM (identity unless the
/// joint holds on to the world).
void make_joint(dWorldID world, Joint& joint);
/// Fixes the world side of a joint again. @pre as above
void anchor_joint(Joint& joint, const Pose& X_WM);
void destroy_joint(Joint& joint);

/// The row of a screw's thread for this sub-step, in a group that is emptied after it.
void add_thread_row(dWorldID world, dJointGroupID group, Joint& joint, double erp, double h_s);
/// The row of the motor's own friction, likewise.
void add_friction_row(dWorldID world, dJointGroupID group, Joint& joint);

/// Tells ODE about joint.target.
void set_motor(Joint& joint);
/// Rows that depend on the state and the sub-step: limits, spring, effort, followers.
void prepare_joint(Joint& joint, double erp, double h_s);
/// After the solver: the effort of a velocity motor.
void measure_effort(Joint& joint);
/// Lets ODE report the forces of all rows of this joint in this sub-step. @pre prepared
void watch_load(Joint& joint);
/// No longer.
void silence(Joint& joint);
/// Sum of the forces that watch_load() requested. @pre solved, and the bodies have not moved yet
struct Transmitted {
  Vec3 point_W;             ///< origin of J
  Vec3 force_N, torque_Nm;  ///< on the child, the torque about that point, in W
};
Transmitted transmitted(const Joint& joint);
/// After the bodies moved: velocity, then position from the old one and `h_s` of that velocity.
void measure_position(Joint& joint, double h_s, const Pose& X_WM);
/// From the bodies as they are.
void measure_velocity(Joint& joint, const Pose& X_WM);

}  // namespace sandlot::rigid
