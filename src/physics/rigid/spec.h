#pragma once
/// Keys of a scenario's `physics:` for the engine `rigid`.
#include <cstdint>
#include <span>

#include "base/fields.h"

namespace sandlot::rigid {

enum class Solver : std::uint8_t {
  automatic,  ///< per island: direct while it is small, quick when it is large
  direct,     ///< ODE's dWorldStep: exact complementarity, cost cubic in the contacts of an island
  quick,      ///< ODE's dWorldQuickStep: iterative, cost linear
};

inline std::span<const EnumName<Solver>> enum_names(Solver) {
  static constexpr EnumName<Solver> names[] = {
      {"auto", Solver::automatic}, {"direct", Solver::direct}, {"quick", Solver::quick}};
  return names;
}

struct Spec {
  Solver solver = Solver::automatic;
  int quick_iterations = 50;
  /// Measured on stacks: equal cost at 24, direct 1.5 times as expensive at 32, exact until there.
  int direct_limit = 32;
  double erp = 0.2;
  double cfm = 1e-6;
  double contact_correction_mps = 1;
  int max_contacts = 8;
  bool sleeping = true;
  double sleep_speed_mps = 0.01;
  double sleep_spin_radps = 0.05;
  double sleep_time_s = 0.5;
  double max_speed_mps = 1e4, max_spin_radps = 1e5;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"solver", "", "Solver of an island of touching bodies."}, s.solver);
    visit(Field{"quick_iterations", "1", "Iterations of the quick solver.", 1, 10000}, s.quick_iterations);
    visit(Field{"direct_limit", "1",
                "Number of contact points of an island above which solver auto is the quick one.", 0, 1e6},
          s.direct_limit);
    visit(Field{"erp", "1", "Share of a position error that one sub-step corrects.", 0, 1}, s.erp);
    visit(Field{"cfm", "1/kg s", "Compliance of all constraints.", 1e-12, 1}, s.cfm);
    visit(Field{"contact_correction", "m/s", "Fastest correction of a penetration.", 0, 1e6},
          s.contact_correction_mps);
    visit(Field{"max_contacts", "1", "Largest number of contact points per pair of shapes.", 1, 64},
          s.max_contacts);
    visit(Field{"sleeping", "",
                "Whether bodies at rest that belong to no robot are left out of the computation."},
          s.sleeping);
    visit(Field{"sleep_speed", "m/s", "Speed below which a body may sleep.", 0, 1e3}, s.sleep_speed_mps);
    visit(Field{"sleep_spin", "rad/s", "Turning rate below which a body may sleep.", 0, 1e3},
          s.sleep_spin_radps);
    visit(Field{"sleep_time", "s", "Time at rest after which an island sleeps.", 0, 1e6}, s.sleep_time_s);
    visit(Field{"max_speed", "m/s",
                "Largest speed of a body; beyond it the run ends with an error that names the body.", 1e-3,
                1e9},
          s.max_speed_mps);
    visit(Field{"max_spin", "rad/s",
                "Largest turning rate of a body; beyond it the run ends with an error that names the body.",
                1e-3, 1e9},
          s.max_spin_radps);
  }
};

}  // namespace sandlot::rigid
