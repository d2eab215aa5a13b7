#pragma once
/// Inner masses of a rolling shell: masses on motors that slide along rails through its middle, and so roll
/// it.
///
/// Limits   the masses pass through each other: they have no geometry, and their rails no mass.
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders {

struct InnerMassSpec {
  double mass_kg = 1;
  double range_m = 0.2, power_N = 100, speed_mps = 2;

  /// All but `mass`, whose text names the number of masses.
  static void fields(auto& s, auto&& visit) {
    visit(Field{"range", "m", "Largest travel of an inner mass to each side of the middle.", 1e-3, 10},
          s.range_m);
    visit(Field{"power", "N", "Largest force on an inner mass.", 0, 1e6}, s.power_N);
    visit(Field{"speed", "m/s", "Largest speed of an inner mass.", 0, 1e3}, s.speed_mps);
  }
  /// @param shell  "barrel", for the message
  Status check(const Node& node, const std::string& path, double diameter_m, const char* shell) const;
};

/// One mass along an axis of the link `shell`, with its rail, joint and motor `name`.
/// @param part  the mass itself
void add_inner_mass(model::Model& model, std::uint32_t shell, const char* name, Vec3 axis,
                    const InnerMassSpec& spec, const Shape& rail, const Part& part);

}  // namespace sandlot::builders
