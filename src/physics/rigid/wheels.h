#pragma once
/// Wheels with rollers: which rollers are bodies of their own, and what the others are.
///
/// Solid    all rollers are part of the wheel's body. It touches as one tyre-shaped barrel, and friction
///          holds along the axis of the roller that would be at the contact; across it there is the rollers'
///          bearing friction alone.
/// Rollers  a roller near a contact of the wheel is a body on its hinge ("awake"); the others are frozen.
/// Near     within half a roller and 10 degrees, about the wheel's axis, of a point where the wheel, 2 %
///          thicker than it is, touches something, whatever and wherever that is; it freezes again beyond 5
///          degrees more. A wheel in the air has no roller awake. A roller wakes in the sub-step in which the
///          thicker wheel touches, before contacts are sought, so that nothing falls between rollers.
/// Mass     of all rollers is always the wheel's, and so is their inertia but for I (that about a roller's
///          own axis) of each that is awake, about all three axes. An awake roller has that I about all axes
///          and `awake_share` of its mass in addition. A rotor that sits symmetrically in its carrier moves
///          exactly so, up to that share; and since nothing moves when a roller wakes or freezes, linear and
///          angular momentum stay what they are.
/// Spin     of a frozen roller is kept: it turns on freely but for bearing friction, without acting on the
///          wheel, and has that spin when it wakes. A wheel that becomes solid loses those spins (its rollers
///          stand).
/// Solvers  islands with awake rollers are solved directly up to four times direct_limit. Solved quickly a
///          robot of 11 kg on 30 rollers of 10 g sinks in by 1 mm at 1 ms and is 1 % too slow; directly it is
///          within 0.01 %.
/// Limits   loads of fixed joints within a wheel leave out its rollers; no gyroscopic torque of frozen
///          rollers; wheel-to-ground contact of the solid wheel stays in its middle plane.
/// Cost     of a frozen roller 40 ns per sub-step.
#include "geometry/barrel.h"
#include "physics/rigid/parts.h"

namespace sandlot::rigid {

/// Share of its mass that an awake roller has in addition to the wheel that carries it: enough for the
/// solvers, little for the world.
inline constexpr double awake_share = 0.2;

/// Takes the rollers' masses and inertias into their wheels' groups.
void lock_rollers(const model::Model& model, RigidGroups& groups);

/// The wheels of an instance whose bodies and joints are made; all rollers frozen. Without shapes yet.
void make_wheels(Instance& instance);

/// Tells ODE which rollers and joints count and what the wheel weighs, from the State.
void settle(Wheel& wheel);
/// Poses and velocities of frozen rollers, from the wheel's.
void follow(Wheel& wheel);
/// Turns frozen rollers by their own spin, then the same.
void roll_on(Wheel& wheel, double h_s);
void stop_frozen(Wheel& wheel);

/// Forgets and collects where the wheel is touched (`points`, in W).
void touch(Wheel& wheel, Vec3 point_W);
/// Wakes and freezes. @return whether any roller is awake
void choose_awake(Wheel& wheel);

/// Axis of the roller that is, or would be, at a point of the wheel.
Vec3 roller_axis_W(const Wheel& wheel, Vec3 point_W);

}  // namespace sandlot::rigid
