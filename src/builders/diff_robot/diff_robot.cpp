/// A round robot on two driven wheels and two balls that slide.
///
/// Frame    M: on the ground below the axle's middle, x forward, y left.
/// Moves    `drive`, a diff_drive.
/// Senses   `joints`, `imu`.
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::diff_robot {
namespace {

struct Spec {
  double wheel_radius_m = 0.08, track_m = 0.36, mass_kg = 6;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"wheel_radius", "m", "Radius of the wheels.", 0.005, 10}, s.wheel_radius_m);
    visit(Field{"track", "m", "Distance between the middles of the wheels.", 0.01, 10}, s.track_m);
    visit(Field{"mass", "kg", "Mass of the whole robot; each wheel has a twentieth of it.", 0.01, 1e5},
          s.mass_kg);
  }
  Status check(const Node& node, const std::string& path) const {
    if (track_m >= 2 * wheel_radius_m) return {};
    return parameter_error(node, path, "track", "there is no room for a body between the wheels",
                           "give a track of at least two wheel radii", "wheel_radius");
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double r = s.wheel_radius_m, radius = 0.47 * s.track_m, width = 0.15 * r;
  const std::uint32_t base = add_link(m, "base", {});
  const double ball = 0.3 * r;
  add_round_body(m, base, radius, 1.3 * r, 2 * ball, 0.88 * s.mass_kg, colors::orange);
  model::Surface smooth;
  smooth.mu = smooth.mu2 = 0;
  for (const double x : {0.8, -0.8})
    add_part(m, base, {Sphere{ball}, {{x * radius, 0, ball}, {}}, 0.01 * s.mass_kg, colors::grey, smooth});
  for (const double side : {1.0, -1.0})
    add_wheel(m, {.name = side > 0 ? "left" : "right",
                  .centre_M = {0, side * s.track_m / 2, r},
                  .radius_m = r,
                  .width_m = width,
                  .mass_kg = 0.05 * s.mass_kg});
  add_device(m, "drive", "diff_drive", {{"left_joint", "left_joint"}, {"right_joint", "right_joint"}});
  add_senses(m);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "diff_robot",
    .help = "Round robot on two driven wheels.",
});

}  // namespace sandlot::builders::diff_robot
