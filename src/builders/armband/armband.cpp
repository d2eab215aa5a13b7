/// A closed band of staves on hinges, like an arm band laid on its edge: it rolls like a caterpillar's track.
/// After the arm band that LpzRobots guides by cross-motor teaching.
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
  RingSpec ring{.segments = 12,
                .length_m = 0.5,
                .diameter_m = 0.2,
                .mass_kg = 0.3,
                .power_Nm = 6,
                .speed_radps = 5,
                .limit_in_rad = math::pi / 4,
                .limit_out_rad = math::pi / 4,
                .color = colors::teal};

  static void fields(auto& s, auto&& visit) {
    visit(Field{"segments", "1", "Number of staves.", 4, 100}, s.ring.segments);
    visit(Field{"length", "m", "Length of a stave, which is the band's width.", 0.01, 10}, s.ring.length_m);
    RingSpec::fields(s.ring, visit);
  }
  Status check(const Node& node, const std::string& path) const {
    if (ring.length_m >= ring.diameter_m) return {};
    return parameter_error(node, path, "length", "a stave would be shorter than it is thick",
                           "give a length of at least the diameter", "diameter");
  }
};

Result<Built> build(const Spec& s) { return build_ring(s.ring); }

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "armband",
    .help = "Closed band of staves on hinges that rolls like a track.",
});

}  // namespace sandlot::builders::armband
