/// Four wheels that are driven and steered each by itself (4WD4S), after MARIO.
///
/// Frame    M: on the ground below the middle of the wheels, x forward, y left.
/// Moves    `drive`, a swerve_drive.
/// Senses   `joints`, `imu`.
/// Source   size of the base: Sharifi et al., the paper on MARIO (0.52 x 0.52 x 0.33 m). It does not give the
///          wheels' places, size they are, what they weigh and how far they steer: those numbers are ours.
#include "base/math.h"
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::swerve_robot {
namespace {

struct Spec {
  double wheel_radius_m = 0.075, track_m = 0.42, wheelbase_m = 0.42, steering_rad = math::pi / 2,
         height_m = 0.33, mass_kg = 20;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"wheel_radius", "m", "Radius of the wheels.", 0.005, 10}, s.wheel_radius_m);
    visit(Field{"track", "m", "Distance between the left and the right wheels.", 0.01, 10}, s.track_m);
    visit(Field{"wheelbase", "m", "Distance between the front and the rear wheels.", 0.01, 10},
          s.wheelbase_m);
    visit(
        Field{"steering", "rad",
              "Largest steering angle of a wheel each way; a quarter turn reaches every direction.", 0.1, 7},
        s.steering_rad);
    visit(Field{"height", "m", "Height of the whole robot.", 0.02, 10}, s.height_m);
    visit(Field{"mass", "kg", "Mass of the whole robot.", 0.01, 1e5}, s.mass_kg);
  }
  Status check(const Node& node, const std::string& path) const {
    if (wheelbase_m < 2.2 * wheel_radius_m)
      return parameter_error(node, path, "wheelbase", "the wheels of a side would touch each other",
                             "give more than two wheel radii");
    if (track_m < 2.2 * wheel_radius_m)
      return parameter_error(node, path, "track", "steered wheels of an axle would touch each other",
                             "give more than two wheel radii");
    if (height_m < 2.4 * wheel_radius_m)
      return parameter_error(node, path, "height", "there is no room for a body above the wheels",
                             "give more than two and a half wheel radii");
    return {};
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double r = s.wheel_radius_m, low = 2.15 * r;
  const std::uint32_t base = add_link(m, "base", {});
  add_box_body(m, base, {s.wheelbase_m + 0.1, s.track_m + 0.1, s.height_m - low}, low, 0.72 * s.mass_kg,
               colors::yellow);
  // Batteries between the wheels, which put the weight low.
  add_part(m, base,
           {Box{{0.5 * s.wheelbase_m, 0.5 * s.track_m, r}},
            {{0, 0, 1.5 * r}, {}},
            0.12 * s.mass_kg,
            colors::grey});
  std::vector<std::string> wheels, steering;
  for (const auto& [corner, x, y] : corners) {
    const std::string name = corner;
    const Vec3 at{x * s.wheelbase_m / 2, y * s.track_m / 2, r};
    const std::uint32_t fork = add_steering(m, name, base, at, s.steering_rad, r, 0.01 * s.mass_kg);
    add_wheel(m, {.name = name,
                  .parent = fork,
                  .centre_M = at,
                  .radius_m = r,
                  .width_m = 0.5 * r,
                  .mass_kg = 0.03 * s.mass_kg});
    wheels.push_back(name + "_joint");
    steering.push_back(name + "_steering");
  }
  add_device(m, "drive", "swerve_drive", {{"wheel_joint", wheels}, {"steering_joint", steering}});
  add_senses(m);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "swerve_robot",
    .help = "Four wheels driven and steered each by itself (MARIO).",
});

}  // namespace sandlot::builders::swerve_robot
