/// A chain of segments on servo joints. After the snakes (schlange...) of LpzRobots: 10 segments, 0.8 long,
/// 0.2 thick, 0.1 kg, motor power 1, joints to 45 deg.
///
/// Frame    M: middle of the head, which is the first segment and looks along x; it lies half a diameter
///          above the ground.
/// Moves    motors `joint_1` ... from the head on, angles [rad]; on universal joints `joint_1_yaw`,
///          `joint_1_pitch`.
/// Senses   `joints`, `imu` in the head.
/// Skin     `friction_along` its segments and `friction_across`: with less along than across, waves from the
///          head to the tail drive it forward.
/// Limits   neighbours do not touch each other; a universal joint is two hinges with a light link between
///          them.
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::snake {
namespace {

enum class Joints : std::uint8_t { yaw, pitch, alternating, universal };
std::span<const EnumName<Joints>> enum_names(Joints) {
  static constexpr EnumName<Joints> names[] = {{"yaw", Joints::yaw},
                                               {"pitch", Joints::pitch},
                                               {"alternating", Joints::alternating},
                                               {"universal", Joints::universal}};
  return names;
}

struct Spec {
  int segments = 10;
  double length_m = 0.8, diameter_m = 0.2, mass_kg = 0.1, power_Nm = 1, limit_rad = 0.7853981633974483,
         speed_radps = 5;
  double friction_along = 0.1, friction_across = 1;
  Joints joints = Joints::yaw;
  Units units = Units::si;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"segments", "1", "Number of segments.", 2, 200}, s.segments);
    visit(Field{"length", "m", "Length of a segment from joint to joint.", 0.01, 10}, s.length_m);
    visit(Field{"diameter", "m", "Diameter of a segment.", 0.002, 5}, s.diameter_m);
    visit(Field{"mass", "kg", "Mass of a segment.", 1e-4, 1e4}, s.mass_kg);
    visit(Field{"joints", "", "Axes of the joints: sideways, up and down, by turns, or both at once."},
          s.joints);
    visit(Field{"power", "Nm", "Largest torque of a joint's motor.", 0, 1e6}, s.power_Nm);
    visit(Field{"limit", "rad", "Largest angle of a joint each way.", 0.01, 3}, s.limit_rad);
    visit(Field{"speed", "rad/s", "Fastest turn of a joint.", 0, 1e3}, s.speed_radps);
    visit(Field{"friction_along", "1", "Coulomb coefficient of the skin along a segment.", 0, 10},
          s.friction_along);
    visit(Field{"friction_across", "1", "Coulomb coefficient of the skin across a segment.", 0, 10},
          s.friction_across);
    visit(units_field, s.units);
  }
  Status check(const Node& node, const std::string& path) const {
    if (length_m >= diameter_m) return {};
    return parameter_error(node, path, "length", "a segment would be shorter than it is thick",
                           "give a length of at least the diameter", "diameter");
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const double radius = s.diameter_m / 2;
  out.X_WM.p.z = radius;
  model::Surface skin;
  skin.fdir1 = {0, 0, 1};  // of a capsule: its axis
  skin.mu = s.friction_along;
  skin.mu2 = s.friction_across;
  const auto joint = [&](const std::string& name, std::uint32_t parent, std::uint32_t child, Vec3 at,
                         Vec3 axis) {
    add_motor(m, name,
              add_joint(m, "hinge" + name.substr(5), parent, child, at,
                        {.axis_M = axis,
                         .lower = -s.limit_rad,
                         .upper = s.limit_rad,
                         .max_effort = s.power_Nm,
                         .max_velocity = s.speed_radps}));
  };
  constexpr Vec3 up{0, 0, 1}, left{0, 1, 0};
  std::uint32_t previous = 0;
  for (int i = 1; i <= s.segments; ++i) {
    const double x = -(i - 1) * s.length_m;
    const bool universal = s.joints == Joints::universal && i > 1;
    const Vec3 at{x + s.length_m / 2, 0, 0};
    const std::string name = numbered("joint", i - 1);
    if (universal) {
      const std::uint32_t between = add_link(m, numbered("cross", i - 1), {at, {}});
      add_mass(m, between, 0.1 * s.mass_kg, radius);
      joint(name + "_yaw", previous, between, at, up);
      previous = between;
    }
    const std::uint32_t segment = add_link(m, i == 1 ? "head" : numbered("segment", i), {{x, 0, 0}, {}});
    // Capsules that overlap by half a ball at each joint.
    add_part(m, segment,
             {Capsule{radius, s.length_m - 0.9 * radius}, along({1, 0, 0}), s.mass_kg,
              i == 1       ? colors::orange
              : i % 2 == 0 ? colors::green
                           : Color{0.45f, 0.62f, 0.20f, 1},
              skin});
    if (i == 1)
      for (const double y : {0.5, -0.5})
        add_part(m, segment,
                 {.shape = Sphere{0.22 * radius},
                  .X_LP = {{s.length_m / 2 + 0.15 * radius, y * radius, 0.6 * radius}, {}},
                  .color = colors::dark,
                  .touches = false});
    if (universal) joint(name + "_pitch", previous, segment, at, left);
    else if (i > 1)
      joint(name, previous, segment, at,
            s.joints == Joints::pitch || (s.joints == Joints::alternating && i % 2 == 1) ? left : up);
    previous = segment;
  }
  add_senses(m);
  set_units(m, s.units);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "snake",
    .help = "Chain of segments on servo joints, with a skin that slides along more easily than across.",
});

}  // namespace sandlot::builders::snake
