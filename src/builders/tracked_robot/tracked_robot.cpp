/// A box on two tracks, each a row of wheels that turn alike.
///
/// Frame    M: on the ground below the middle, x forward, y left.
/// Moves    `drive`, a track_drive.
/// Senses   `joints`, `imu`.
/// Limits   the belts are drawn, not simulated: friction acts under the wheels.
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::tracked_robot {
namespace {

struct Spec {
  int wheels = 4;
  double wheel_radius_m = 0.07, track_m = 0.42, length_m = 0.6, mass_kg = 20;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"wheels", "1", "Number of wheels on each side.", 2, 16}, s.wheels);
    visit(Field{"wheel_radius", "m", "Radius of the wheels over the belt.", 0.005, 10}, s.wheel_radius_m);
    visit(Field{"track", "m", "Distance between the middles of the tracks.", 0.01, 10}, s.track_m);
    visit(Field{"length", "m", "Length of a track.", 0.02, 20}, s.length_m);
    visit(Field{"mass", "kg", "Mass of the whole robot; the wheels have a quarter of it.", 0.01, 1e5},
          s.mass_kg);
  }
  Status check(const Node& node, const std::string& path) const {
    if (length_m - 2 * wheel_radius_m < 2.05 * wheel_radius_m * (wheels - 1))
      return parameter_error(node, path, "length", "the wheels of a track would touch each other",
                             "give fewer or smaller wheels, or a longer track");
    if (track_m < 2 * wheel_radius_m)
      return parameter_error(node, path, "track", "there is no room for a body between the tracks",
                             "give two wheel radii or more");
    return {};
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double r = s.wheel_radius_m, width = r, run = s.length_m - 2 * r;
  const std::uint32_t base = add_link(m, "base", {});
  add_box_body(m, base, {s.length_m - 0.4 * r, s.track_m - 1.2 * width, 1.4 * r}, 0.7 * r, 0.75 * s.mass_kg,
               colors::stone);
  std::vector<std::string> left, right;
  for (const double y : {1.0, -1.0}) {
    const double at = y * s.track_m / 2;
    for (const double z : {0.04 * r, 1.96 * r})  // the belt's two runs
      add_part(m, base,
               {.shape = Box{{run, 1.02 * width, 0.08 * r}},
                .X_LP = {{0, at, z}, {}},
                .color = colors::grey,
                .touches = false});
    for (int i = 0; i < s.wheels; ++i) {
      const std::string name = numbered(y > 0 ? "left" : "right", i + 1);
      add_wheel(m, {.name = name,
                    .centre_M = {run / 2 - run * i / (s.wheels - 1), at, r},
                    .radius_m = r,
                    .width_m = width,
                    .mass_kg = 0.125 * s.mass_kg / s.wheels});
      (y > 0 ? left : right).push_back(name + "_joint");
    }
  }
  add_device(m, "drive", "track_drive", {{"left_joint", left}, {"right_joint", right}});
  add_senses(m);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "tracked_robot",
    .help = "Box on two tracks.",
});

}  // namespace sandlot::builders::tracked_robot
