#pragma once
/// Exceptions from the contact law, as a function of the user's: who touches whom, and what shall come of it.
///
/// The simulator calls it for every point where two shapes touch, in every sub-step. It has to be a pure
/// function of what it is given and of constants: its own state would be no part of a snapshot.
#include <functional>
#include <optional>
#include <string_view>

#include "geometry/pose.h"
#include "model/model.h"

namespace sandlot {

/// One side of a contact.
struct ContactSide {
  std::string_view instance;
  const model::Link& link;
  const model::Collision& collision;
  Pose X_WC;
};

/// Contact parameters of two touching surfaces.
struct PairSurface {
  bool touches = true;          ///< false: they pass through each other
  double mu = 1, mu2 = 1;       ///< along fdir1_W and across
  Vec3 fdir1_W;                 ///< zero: isotropic
  double slip1 = 0, slip2 = 0;  ///< [m/(s N)] force-dependent slip
  double restitution = 0, restitution_threshold_mps = 0.05;
  std::optional<double> stiffness_N_per_m,
      damping_N_s_per_m;                     ///< both or neither; unset: soft_erp, soft_cfm hold
  std::optional<double> soft_erp, soft_cfm;  ///< unset: the engine's own
  std::optional<double> max_correction_mps;  ///< fastest correction of a penetration; unset: the engine's own
  double rolling_resistance_m = 0;
  Vec3 belt_velocity_W_mps;  ///< of b's surface relative to a's, in addition to the motion of the bodies
};

/// @param a  created before b
/// @param normal_W  from a towards b
/// @param pair  what the surfaces and zones make of it; to be changed
using ContactRule = std::function<void(const ContactSide& a, const ContactSide& b, Vec3 point_W,
                                       Vec3 normal_W, PairSurface& pair)>;

}  // namespace sandlot
