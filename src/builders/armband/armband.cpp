/// A closed band of staves on hinges, like an arm band laid on its edge: it rolls like a caterpillar's track. After the
/// arm band that LpzRobots guides by cross-motor teaching.
///
/// Frame    M: middle of the ring, its axis along y; it stands on stave 1, the yellow one, and rolls along x.
/// Moves    motors `hinge_1`, `hinge_2` ...: builders/ring.h.
/// Senses   `joints`, `imu` in stave 1.
/// Source   the numbers are ours.
#include "base/math.h"
#include "builders/ring.h"

namespace sandlot::builders::armband {
namespace {

struct Spec {
  int segments = 12;
  double length_m = 0.5, diameter_m = 0.2, mass_kg = 0.3, power_Nm = 6, speed_radps = 5;
  double limit_in_rad = math::pi / 4, limit_out_rad = math::pi / 4;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"segments", "1", "Number of staves.", 4, 100}, s.segments);
    visit(Field{"length", "m", "Length of a stave, which is the band's width.", 0.01, 10}, s.length_m);
    visit(Field{"diameter", "m", "Diameter of a stave.", 0.005, 5}, s.diameter_m);
    visit(Field{"mass", "kg", "Mass of a stave.", 1e-4, 1e4}, s.mass_kg);
    visit(Field{"power", "Nm", "Largest torque of a hinge.", 0, 1e6}, s.power_Nm);
    visit(Field{"speed", "rad/s", "Fastest turn of a hinge.", 0, 1e3}, s.speed_radps);
    visit(Field{"limit_in", "rad", "Largest angle of a hinge inwards.", 0, 3}, s.limit_in_rad);
    visit(Field{"limit_out", "rad", "Largest angle of a hinge outwards.", 0, 3}, s.limit_out_rad);
  }
  Status check(const Node& node, const std::string& path) const {
    if (length_m >= diameter_m) return {};
    const Node* const key = node.find(node.find("length") ? "length" : "diameter");
    return (key ? *key : node)
        .error("a stave would be shorter than it is thick", "give a length of at least the diameter",
               path + "/length");
  }
};

Result<Built> build(const Spec& s) {
  return build_ring({s.segments, s.length_m, s.diameter_m, s.mass_kg, s.power_Nm, s.speed_radps,
                     s.limit_in_rad, s.limit_out_rad, false, 0, colors::teal});
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "armband",
    .help = "Closed band of staves on hinges that rolls like a track.",
});

}  // namespace sandlot::builders::armband
