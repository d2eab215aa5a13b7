/// A box on four driven wheels that all point ahead; it turns because they slide sideways.
///
/// Frame    M: on the ground below the middle of the wheels, x forward, y left.
/// Moves    `drive`, a skid_drive.
/// Senses   `joints`, `imu`.
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::skid_robot {
namespace {

struct Spec {
  double wheel_radius_m = 0.1, track_m = 0.44, wheelbase_m = 0.34, mass_kg = 15;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"wheel_radius", "m", "Radius of the wheels.", 0.005, 10}, s.wheel_radius_m);
    visit(Field{"track", "m", "Distance between the left and the right wheels.", 0.01, 10}, s.track_m);
    visit(Field{"wheelbase", "m", "Distance between the front and the rear axle.", 0.01, 10}, s.wheelbase_m);
    visit(Field{"mass", "kg", "Mass of the whole robot; each wheel has a twentieth of it.", 0.01, 1e5},
          s.mass_kg);
  }
  Status check(const Node& node, const std::string& path) const {
    if (wheelbase_m < 2.05 * wheel_radius_m)
      return parameter_error(node, path, "wheelbase", "the wheels of a side would touch each other",
                             "give more than two wheel radii");
    if (track_m < 1.5 * wheel_radius_m)
      return parameter_error(node, path, "track", "there is no room for a body between the wheels",
                             "give one and a half wheel radii or more");
    return {};
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double r = s.wheel_radius_m, width = 0.6 * r;
  const std::uint32_t base = add_link(m, "base", {});
  add_box_body(m, base, {s.wheelbase_m + 1.6 * r, s.track_m - width - 0.04 * s.track_m, 1.1 * r}, 0.6 * r,
               0.8 * s.mass_kg, colors::blue);
  for (const auto& [corner, x, y] : corners)
    add_wheel(m, {.name = corner,
                  .centre_M = {x * s.wheelbase_m / 2, y * s.track_m / 2, r},
                  .radius_m = r,
                  .width_m = width,
                  .mass_kg = 0.05 * s.mass_kg});
  using Names = std::vector<std::string>;
  add_device(m, "drive", "skid_drive",
             {{"left_joint", Names{"front_left_joint", "rear_left_joint"}},
              {"right_joint", Names{"front_right_joint", "rear_right_joint"}}});
  add_senses(m);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "skid_robot",
    .help = "Box on four driven wheels that turns by skidding.",
});

}  // namespace sandlot::builders::skid_robot
