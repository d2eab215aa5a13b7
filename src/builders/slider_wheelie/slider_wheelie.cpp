/// A ring of staves whose joints are hinges and sliders by turns: it rolls by changing its shape. After the sliderwheelie of
/// LpzRobots: 8 segments, 0.4 long, 0.2 thick, 0.4 kg, power 5, hinges to 60 deg inwards.
///
/// Frame    M: middle of the ring, its axis along y; it stands on stave 1, the yellow one, and rolls along x.
/// Moves    motors `hinge_1`, `slider_2`, `hinge_3` ...: builders/ring.h.
/// Senses   `joints`, `imu` in stave 1.
#include "base/math.h"
#include "builders/ring.h"

namespace sandlot::builders::slider_wheelie {
namespace {

struct Spec {
  int segments = 8;
  double length_m = 0.4, diameter_m = 0.2, mass_kg = 0.4, power_Nm = 5, speed_radps = 5;
  double limit_in_rad = math::pi / 3, limit_out_rad = math::pi / 8, slide_m = 0.06;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"segments", "1", "Number of staves; an even number.", 4, 100}, s.segments);
    visit(Field{"length", "m", "Length of a stave, along the ring's axis.", 0.01, 10}, s.length_m);
    visit(Field{"diameter", "m", "Diameter of a stave.", 0.005, 5}, s.diameter_m);
    visit(Field{"mass", "kg", "Mass of a stave.", 1e-4, 1e4}, s.mass_kg);
    visit(Field{"power", "Nm", "Largest torque of a hinge.", 0, 1e6}, s.power_Nm);
    visit(Field{"speed", "rad/s", "Fastest turn of a hinge.", 0, 1e3}, s.speed_radps);
    visit(Field{"limit_in", "rad", "Largest angle of a hinge inwards.", 0, 3}, s.limit_in_rad);
    visit(Field{"limit_out", "rad", "Largest angle of a hinge outwards.", 0, 3}, s.limit_out_rad);
    visit(Field{"slide", "m", "Largest travel of a slider each way.", 0, 10}, s.slide_m);
  }
  Status check(const Node& node, const std::string& path) const {
    const auto wrong = [&](const char* key, const char* what, const char* fix) {
      const Node* const at = node.find(key);
      return (at ? *at : node).error(what, fix, path + "/" + key);
    };
    if (segments % 2 != 0)
      return wrong("segments", "hinges and sliders cannot take turns around a ring of an odd number",
                   "give an even number of segments");
    if (length_m < diameter_m)
      return wrong("length", "a stave would be shorter than it is thick",
                   "give a length of at least the diameter");
    if (slide_m > 0.5 * diameter_m)
      return wrong("slide", "neighbours would slide through each other", "choose at most half the diameter");
    return {};
  }
};

Result<Built> build(const Spec& s) {
  return build_ring({s.segments, s.length_m, s.diameter_m, s.mass_kg, s.power_Nm, s.speed_radps,
                     s.limit_in_rad, s.limit_out_rad, true, s.slide_m, colors::violet});
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "slider_wheelie",
    .help = "Ring of staves on hinges and sliders that rolls by changing its shape.",
});

}  // namespace sandlot::builders::slider_wheelie
