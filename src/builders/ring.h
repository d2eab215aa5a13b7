#pragma once
/// A closed ring of staves on joints, standing like a wheel.
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders {

struct RingWords {
  int segments;
  double length_m, diameter_m, mass_kg;  ///< of a stave: along the ring's axis, thickness, mass
  double power_Nm, speed_radps;        ///< of a hinge; a slider has that torque's force at a stave's distance
  double limit_in_rad, limit_out_rad;  ///< of a hinge: how far it bends inwards and straightens
  bool sliders;                        ///< every second joint slides along the rim
  double slide_m;                      ///< how far, each way
  Color color;
};

/// Frame M: middle of the ring, its axis along y. Staves are capsules along y, joint k joins stave k to the next and the last
/// one closes the ring; motors `hinge_k` are positive inwards [rad], `slider_k` when it pulls apart [m].
Built build_ring(const RingWords& words);

}  // namespace sandlot::builders
