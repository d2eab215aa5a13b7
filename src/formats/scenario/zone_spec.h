#pragma once
/// The keys of a zone of the ground in a scenario file.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/node.h"

namespace sandlot::formats::scenario_spec {

inline constexpr double max_distance_m = 1e6;

struct Zone {
  std::string name;
  std::vector<std::array<double, 2>> polygon_m;
  std::optional<std::array<double, 2>> centre_m;
  double radius_m = 1;
  double friction = 1;
  std::string substance;
  double rolling_resistance_m = 0;
  std::array<double, 2> belt_velocity_mps{};
  bool no_contact = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the zone; unique.", 0, 0, Field::required, 100}, s.name);
    visit(Field{"polygon", "m", "Corners x y in order; no two sides may cross.", -max_distance_m,
                max_distance_m, Field::none, 1000, 3},
          s.polygon_m);
    visit(Field{"centre", "m", "Middle x y of a round zone.", -max_distance_m, max_distance_m}, s.centre_m);
    visit(Field{"radius", "m", "Radius of a round zone.", 1e-3, max_distance_m}, s.radius_m);
    visit(Field{"friction", "1", "Coulomb coefficient; of a pair the smaller counts.", 0, 1e6}, s.friction);
    visit(Field{"substance", "",
                "Material, for bodies with a material of their own: metal(0.5), plastic, rubber(20), "
                "foam(10), snow(0.5), or roughness, slip, hardness and elasticity.",
                0, 0, Field::none, 100},
          s.substance);
    visit(Field{"rolling_resistance", "m", "Torque against rolling per normal force; of a pair the sum.", 0,
                1e3},
          s.rolling_resistance_m);
    visit(Field{"belt_velocity", "m/s", "Velocity x y, in the world, of the surface as a conveyor belt.",
                -1e3, 1e3},
          s.belt_velocity_mps);
    visit(Field{"no_contact", "", "Whether the zone is a hole, through which things fall."}, s.no_contact);
  }
};

}  // namespace sandlot::formats::scenario_spec
