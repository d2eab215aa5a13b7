/// A car: driven wheels at the rear, steered ones at the front.
///
/// Frame    M: on the ground below the middle of the wheels, x forward, y left.
/// Moves    `drive`, an ackermann_drive.
/// Senses   `joints`, `imu`.
#include "base/text.h"
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::ackermann_robot {
namespace {

struct Spec {
  double wheel_radius_m = 0.09, track_m = 0.4, wheelbase_m = 0.56, steering_rad = 0.6, mass_kg = 15;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"wheel_radius", "m", "Radius of the wheels.", 0.005, 10}, s.wheel_radius_m);
    visit(Field{"track", "m", "Distance between the left and the right wheels.", 0.01, 10}, s.track_m);
    visit(Field{"wheelbase", "m", "Distance between the front and the rear axle.", 0.01, 20}, s.wheelbase_m);
    visit(Field{"steering", "rad", "Largest steering angle of the inner wheel.", 0.05, 1.2}, s.steering_rad);
    visit(Field{"mass", "kg", "Mass of the whole robot; each wheel has a twentieth of it.", 0.01, 1e5},
          s.mass_kg);
  }
  Status check(const Node& node, const std::string& path) const {
    if (wheelbase_m < 2.05 * wheel_radius_m)
      return parameter_error(node, path, "wheelbase", "the wheels of a side would touch each other",
                             "give more than two wheel radii");
    if (track_m < 3 * wheel_radius_m)
      return parameter_error(node, path, "track", "there is no room for a body between steered wheels",
                             "give three wheel radii or more");
    return {};
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double r = s.wheel_radius_m, width = 0.5 * r;
  const std::uint32_t base = add_link(m, "base", {});
  add_box_body(m, base, {s.wheelbase_m + 1.8 * r, s.track_m - 2 * r, r}, 0.8 * r, 0.78 * s.mass_kg,
               colors::red);
  for (const double y : {1.0, -1.0}) {
    const std::string side = y > 0 ? "left" : "right";
    WheelOptions wheel{.name = "rear_" + side,
                       .parent = base,
                       .centre_M = {-s.wheelbase_m / 2, y * s.track_m / 2, r},
                       .radius_m = r,
                       .width_m = width,
                       .mass_kg = 0.05 * s.mass_kg};
    add_wheel(m, wheel);
    wheel.name = "front_" + side;
    wheel.centre_M.x = s.wheelbase_m / 2;
    wheel.parent = add_steering(m, wheel.name, base, wheel.centre_M, 1.1 * s.steering_rad, r,
                                0.01 * s.mass_kg);
    add_wheel(m, wheel);
  }
  using Names = std::vector<std::string>;
  add_device(m, "drive", "ackermann_drive",
             {{"left_joint", Names{"rear_left_joint"}},
              {"right_joint", Names{"rear_right_joint"}},
              {"passive_joint", Names{"front_left_joint", "front_right_joint"}},
              {"left_steering_joint", "front_left_steering"},
              {"right_steering_joint", "front_right_steering"},
              {"max_steering_angle", number_text(s.steering_rad)}});
  add_senses(m);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "ackermann_robot",
    .help = "Car with a driven axle and two steered wheels.",
});

}  // namespace sandlot::builders::ackermann_robot
