/// A ring of staves whose joints are hinges and sliders by turns: it rolls by changing its shape. After the
/// sliderwheelie of LpzRobots: 8 segments, 0.4 long, 0.2 thick, 0.4 kg, power 5, hinges to 60 deg inwards.
///
/// Frame    M: middle of the ring, its axis along y; it stands on stave 1, the yellow one, and rolls along x.
/// Moves    motors `hinge_1`, `slider_2`, `hinge_3` ...: builders/ring.h.
/// Senses   `joints`, `imu` in stave 1.
#include "base/math.h"
#include "builders/ring.h"

namespace sandlot::builders::slider_wheelie {
namespace {

struct Spec {
  RingSpec ring{.segments = 8,
                .length_m = 0.4,
                .diameter_m = 0.2,
                .mass_kg = 0.4,
                .power_Nm = 5,
                .speed_radps = 5,
                .limit_in_rad = math::pi / 3,
                .limit_out_rad = math::pi / 8,
                .sliders = true,
                .slide_m = 0.06,
                .color = colors::violet};

  static void fields(auto& s, auto&& visit) {
    visit(Field{"segments", "1", "Number of staves; an even number.", 4, 100}, s.ring.segments);
    visit(Field{"length", "m", "Length of a stave, along the ring's axis.", 0.01, 10}, s.ring.length_m);
    RingSpec::fields(s.ring, visit);
    visit(Field{"slide", "m", "Largest travel of a slider each way.", 0, 10}, s.ring.slide_m);
  }
  Status check(const Node& node, const std::string& path) const {
    if (ring.segments % 2 != 0)
      return parameter_error(node, path, "segments",
                             "hinges and sliders cannot take turns around a ring of an odd number",
                             "give an even number of segments");
    if (ring.length_m < ring.diameter_m)
      return parameter_error(node, path, "length", "a stave would be shorter than it is thick",
                             "give a length of at least the diameter");
    if (ring.slide_m > 0.5 * ring.diameter_m)
      return parameter_error(node, path, "slide", "neighbours would slide through each other",
                             "choose at most half the diameter");
    return {};
  }
};

Result<Built> build(const Spec& s) { return build_ring(s.ring); }

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "slider_wheelie",
    .help = "Ring of staves on hinges and sliders that rolls by changing its shape.",
});

}  // namespace sandlot::builders::slider_wheelie
