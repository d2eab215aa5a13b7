#pragma once
/// A closed ring of staves on joints, standing like a wheel.
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders {

struct RingSpec {
  int segments = 12;
  double length_m = 0.5;    ///< of a stave, along the ring's axis
  double diameter_m = 0.2;  ///< of a stave
  double mass_kg = 0.3;     ///< of a stave
  double power_Nm = 6;      ///< of a hinge; a slider has that torque's force at a stave's distance
  double speed_radps = 5;   ///< of a hinge
  double limit_in_rad = 0, limit_out_rad = 0;  ///< of a hinge: how far it bends inwards and straightens
  bool sliders = false;                        ///< every second joint slides along the rim
  double slide_m = 0;                          ///< travel of a slider each way
  Color color;
  Units units = Units::si;

  /// Parameters whose texts are the same for all rings.
  static void fields(auto& s, auto&& visit) {
    visit(Field{"diameter", "m", "Diameter of a stave.", 0.005, 5}, s.diameter_m);
    visit(Field{"mass", "kg", "Mass of a stave.", 1e-4, 1e4}, s.mass_kg);
    visit(Field{"power", "Nm", "Largest torque of a hinge.", 0, 1e6}, s.power_Nm);
    visit(Field{"speed", "rad/s", "Fastest turn of a hinge.", 0, 1e3}, s.speed_radps);
    visit(Field{"limit_in", "rad", "Largest angle of a hinge inwards.", 0, 3}, s.limit_in_rad);
    visit(Field{"limit_out", "rad", "Largest angle of a hinge outwards.", 0, 3}, s.limit_out_rad);
    visit(units_field, s.units);
  }
};

/// Frame M: middle of the ring, its axis along y. Staves are capsules along y, joint k joins stave k to the
/// next and the last one closes the ring; motors `hinge_k` are positive inwards [rad], `slider_k` when it
/// pulls apart [m].
Built build_ring(const RingSpec& spec);

}  // namespace sandlot::builders
