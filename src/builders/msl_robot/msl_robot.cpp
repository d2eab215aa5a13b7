/// A robot of the RoboCup Middle Size League: a chassis, a tower in its team's colour with a number, a mirror
/// on top, room for a scanner and a camera head.
///
/// Frame    M: on the ground below the middle, x forward, y left.
/// Chassis  `omni`: three or four omni wheels on a circle, symmetric to x with none in front, their axes
///          radial. `differential`: two wheels on an axle through the middle and two balls that slide.
///          `swerve`: four wheels that are driven and steered each by itself.
/// Moves    `drive`: an omni_drive, a diff_drive or a swerve_drive; all take the same commands.
/// Senses   `joints`, `imu`, `truth` (a ground_truth: where it really is).
/// Links    `mirror` has its origin at the focus of the mirror, z up: an omni camera belongs there, and sees
///          all but that link. A SICK LD fits at (0.12, 0, 0.37), a Sony D100 at (0.135, 0, 0.525).
/// Ball     lies in front between two arms; its middle cannot come nearer than 0.305 m (rigid; the disc of the
///          planar engine: 0.33 m), where the arms cover 0.3 of its diameter. Arms are seen and touch nothing: a
///          ball_handler at (0, 0, 0.11) holds the ball, a kicker fits at (0.2, 0, 0.11).
/// Size     0.49 x 0.44 m, 0.79 m high, as the league allows (at most 0.5 x 0.5 x 0.8 m, 40 kg).
#include <algorithm>

#include "base/math.h"
#include "builders/builder.h"
#include "builders/wheeled.h"

namespace sandlot::builders::msl_robot {
namespace {

enum class Paint : std::uint8_t { cyan, magenta, blue, red, yellow, white };
std::span<const EnumName<Paint>> enum_names(Paint) {
  static constexpr EnumName<Paint> names[] = {{"cyan", Paint::cyan},     {"magenta", Paint::magenta},
                                              {"blue", Paint::blue},     {"red", Paint::red},
                                              {"yellow", Paint::yellow}, {"white", Paint::white}};
  return names;
}
Color color_of(Paint paint) {
  switch (paint) {
    case Paint::cyan: return {0.0f, 0.68f, 0.85f, 1};
    case Paint::magenta: return {0.85f, 0.05f, 0.5f, 1};
    case Paint::blue: return colors::blue;
    case Paint::red: return colors::red;
    case Paint::yellow: return colors::yellow;
    case Paint::white: break;
  }
  return colors::white;
}

enum class Chassis : std::uint8_t { omni, differential, swerve };
std::span<const EnumName<Chassis>> enum_names(Chassis) {
  static constexpr EnumName<Chassis> names[] = {
      {"omni", Chassis::omni}, {"differential", Chassis::differential}, {"swerve", Chassis::swerve}};
  return names;
}

struct Spec {
  Chassis chassis = Chassis::omni;
  int number = 1, wheels = 3, rollers = 0;
  Paint color = Paint::cyan;
  double mass_kg = 26;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"number", "1", "Number painted on the tower.", 0, 99}, s.number);
    visit(Field{"color", "", "Colour of the team's marker."}, s.color);
    visit(Field{"chassis", "", "Wheels and how they drive the robot."}, s.chassis);
    visit(Field{"wheels", "1", "Number of wheels of the chassis omni.", 3, 4}, s.wheels);
    visit(Field{"rollers", "1",
                "Number of rollers in each of the two rows of a wheel, from 4 on; 0: wheels that slide along "
                "their axes.",
                0, 24},
          s.rollers);
    visit(Field{"mass", "kg", "Mass of the whole robot without rollers; each wheel has 0.5 kg of it.", 5, 40},
          s.mass_kg);
  }
  Status check(const Node& node, const std::string& path) const {
    if (chassis != Chassis::omni) {
      // Rollers that are none suit every chassis: a team lays such a robot over another's description.
      const char* const key = rollers > 0 ? "rollers" : "wheels";
      if (const Node* const given = node.find(key))
        return given->error("only the chassis omni can choose its wheels", "leave it out", path + "/" + key);
    }
    if (rollers == 0 || rollers >= 4) return {};
    return node.find("rollers")->error("a wheel cannot go round on " + std::to_string(rollers) + " rollers",
                                       "give at least 4, or 0 for wheels that slide", path + "/rollers");
  }
};

constexpr double wheel_radius_m = 0.0506, wheel_circle_m = 0.2;  // as CAMBADA's
constexpr double plain_wheel_radius_m = 0.06;
constexpr double wheel_kg = 0.5, fork_kg = 0.2, mirror_kg = 0.3;
constexpr double body_radius_m = 0.22, tower_radius_m = 0.085;
constexpr Color black{0.035f, 0.035f, 0.04f, 1}, metal{0.6f, 0.61f, 0.63f, 1};

void see(model::Model& m, std::uint32_t link, Shape shape, Pose X_LP, Color color) {
  add_part(m, link, {.shape = std::move(shape), .X_LP = X_LP, .color = color, .touches = false});
}

/// A digit of seven bars on the outside of a wall, in the plane y, z of P, which looks along x.
void add_digit(model::Model& m, std::uint32_t link, int digit, const Pose& X_LP, double height) {
  // Bit k: bar k is lit. 0 top, 1 upper right, 2 lower right, 3 bottom, 4 lower left, 5 upper left, 6 middle.
  static constexpr unsigned lit[] = {0x3f, 0x06, 0x5b, 0x4f, 0x66, 0x6d, 0x7d, 0x07, 0x7f, 0x6f};
  const double w = 0.5 * height, t = 0.17 * height;
  // Whoever looks at it looks against x, so its right is +y.
  const auto bar = [&](double y, double z, double size_y, double size_z) {
    see(m, link, Box{{0.003, size_y, size_z}}, X_LP * Pose{{0, y, z}, {}}, colors::white);
  };
  const double side = (w - t) / 2, half = (height - t) / 4, across = w, up = (height + t) / 2;
  for (unsigned k = 0; k < 7; ++k) {
    if (((lit[digit] >> k) & 1u) == 0) continue;
    if (k == 0) bar(0, 2 * half, across, t);
    if (k == 1) bar(side, half, t, up);
    if (k == 2) bar(side, -half, t, up);
    if (k == 3) bar(0, -2 * half, across, t);
    if (k == 4) bar(-side, -half, t, up);
    if (k == 5) bar(-side, half, t, up);
    if (k == 6) bar(0, 0, across, t);
  }
}

void add_number(model::Model& m, std::uint32_t link, int number, const Pose& X_LP, double height) {
  if (number < 10) return add_digit(m, link, number, X_LP, height);
  const double off = 0.32 * height;
  add_digit(m, link, number / 10, X_LP * Pose{{0, -off, 0}, {}}, height);
  add_digit(m, link, number % 10, X_LP * Pose{{0, off, 0}, {}}, height);
}

/// Two arms that hold a ball, and the plate that kicks it.
void add_ball_handling(model::Model& m, std::uint32_t base) {
  see(m, base, Box{{0.012, 0.12, 0.09}}, {{0.225, 0, 0.11}, {}}, metal);
  for (const double side : {1.0, -1.0}) {
    see(m, base, Box{{0.09, 0.02, 0.03}}, {{0.215, side * 0.105, 0.185}, {}}, black);
    see(m, base, Cylinder{0.025, 0.024}, along({0, 1, 0}, {0.245, side * 0.08, 0.18}), colors::grey);
  }
}

/// The camera that looks up, three rods and the mirror: a cone that ends below its focus.
void add_mirror(model::Model& m, std::uint32_t base) {
  constexpr double focus_m = 0.72, top_m = 0.79;
  see(m, base, Cylinder{0.028, 0.05}, {{0, 0, 0.635}, {}}, metal);
  const std::uint32_t mirror = add_link(m, "mirror", {{0, 0, focus_m}, {}});
  add_part(m, mirror,
           {.shape = Cylinder{0.062, 0.012},
            .X_LP = {{0, 0, top_m - 0.006 - focus_m}, {}},
            .mass_kg = mirror_kg,
            .color = black,
            .touches = false});
  see(m, mirror, Cone{0.055, 0.07}, along({0, 0, -1}, {0, 0, top_m - 0.012 - 0.035 - focus_m}),
      {0.75f, 0.77f, 0.8f, 1});
  for (int i = 0; i < 3; ++i) {
    const math::SinCos at = math::sincos(math::tau * (i + 0.5) / 3);
    see(m, mirror, Cylinder{0.0025, top_m - 0.61},
        {{0.058 * at.cos, 0.058 * at.sin, (top_m + 0.61) / 2 - focus_m}, {}}, metal);
  }
  add_joint(m, "mirror_joint", base, mirror, {0, 0, focus_m}, {.type = model::JointType::fixed});
}

/// Wheels on a circle, with rollers or without.
std::vector<std::string> add_omni_wheels(model::Model& m, const Spec& s) {
  std::optional<model::RollerWheel> rollers;
  if (s.rollers > 0) {
    rollers.emplace();
    rollers->radius_m = wheel_radius_m;
    rollers->count = s.rollers;
    rollers->rows = 2;
    // Both rows together have 2 n rollers: each covers a 2n-th of the rim, and a tenth more.
    rollers->roller_length_m = 2 * wheel_radius_m * math::sin(1.1 * math::pi / (2 * s.rollers));
    rollers->roller_radius_m = std::min(0.2 * wheel_radius_m, 0.4 * rollers->roller_length_m);
    rollers->row_spacing_m = 2.1 * rollers->roller_radius_m;
    rollers->roller_mass_kg = 0.1 / s.rollers;
  }
  std::vector<std::string> joints;
  for (int i = 0; i < s.wheels; ++i) {
    const math::SinCos at = math::sincos(math::tau * (i + 0.5) / s.wheels);
    const std::string name = numbered("wheel", i + 1);
    add_wheel(m, {.name = name,
                  .centre_M = {wheel_circle_m * at.cos, wheel_circle_m * at.sin, wheel_radius_m},
                  .axis_M = {at.cos, at.sin, 0},
                  .radius_m = wheel_radius_m,
                  .width_m = 0.035,
                  .mass_kg = wheel_kg,
                  .max_effort_Nm = 5,
                  .rollers = rollers});
    joints.push_back(name + "_joint");
  }
  return joints;
}

std::vector<std::string> add_axle(model::Model& m, std::uint32_t base) {
  constexpr double ball_m = 0.02;
  model::Surface smooth;
  smooth.mu = smooth.mu2 = 0;
  for (const double x : {0.15, -0.15})
    add_part(m, base,
             {.shape = Sphere{ball_m}, .X_LP = {{x, 0, ball_m}, {}}, .color = metal, .surface = smooth});
  for (const double side : {1.0, -1.0})
    add_wheel(m, {.name = side > 0 ? "left" : "right",
                  .centre_M = {0, side * 0.175, plain_wheel_radius_m},
                  .radius_m = plain_wheel_radius_m,
                  .width_m = 0.03,
                  .mass_kg = wheel_kg,
                  .max_effort_Nm = 6});
  return {"left_joint", "right_joint"};
}

/// Names of the joints that drive, and of those that steer.
struct SwerveJoints {
  std::vector<std::string> wheels, steering;
};
SwerveJoints add_swerve_wheels(model::Model& m, std::uint32_t base) {
  SwerveJoints joints;
  for (const auto& [corner, x, y] : corners) {
    const std::string name = corner;
    const Vec3 at{0.12 * x, 0.12 * y, plain_wheel_radius_m};
    const std::uint32_t fork = add_steering(m, name, base, at, math::pi / 2, plain_wheel_radius_m, fork_kg);
    add_wheel(m, {.name = name,
                  .parent = fork,
                  .centre_M = at,
                  .radius_m = plain_wheel_radius_m,
                  .width_m = 0.03,
                  .mass_kg = wheel_kg,
                  .max_effort_Nm = 4});
    joints.wheels.push_back(name + "_joint");
    joints.steering.push_back(name + "_steering");
  }
  return joints;
}

/// The drive of a chassis and its wheels. Returns the joints.
std::vector<std::string> add_drive(model::Model& m, std::uint32_t base, const Spec& s) {
  const KeyValue speed = "3", turning = "6", acceleration = "2.5", angular = "6";
  const auto with_limits = [&](const char* kind, Keys keys) {
    add_device(m, "drive", kind, keys);
    Node& config = m.devices.back().config;
    config.set("max_linear_speed", speed);
    config.set("max_angular_speed", turning);
    config.set("max_linear_acceleration", acceleration);
    config.set("max_angular_acceleration", angular);
  };
  switch (s.chassis) {
    case Chassis::differential: {
      std::vector<std::string> joints = add_axle(m, base);
      with_limits("diff_drive", {{"left_joint", joints[0]}, {"right_joint", joints[1]}});
      return joints;
    }
    case Chassis::swerve: {
      SwerveJoints joints = add_swerve_wheels(m, base);
      with_limits("swerve_drive", {{"wheel_joint", joints.wheels}, {"steering_joint", joints.steering}});
      joints.wheels.insert(joints.wheels.end(), joints.steering.begin(), joints.steering.end());
      return std::move(joints.wheels);
    }
    case Chassis::omni: break;
  }
  std::vector<std::string> joints = add_omni_wheels(m, s);
  with_limits("omni_drive", {{"wheel_joint", joints}});
  return joints;
}

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const Color team = color_of(s.color);
  const std::uint32_t base = add_link(m, "base", {});
  const int wheels = s.chassis == Chassis::omni ? s.wheels : s.chassis == Chassis::swerve ? 4 : 2;
  const double rest_kg = s.mass_kg - wheels * wheel_kg -
                         (s.chassis == Chassis::swerve ? wheels * fork_kg : 0) - mirror_kg;
  const auto solid = [&](Shape shape, Pose at, double kg, Color color) {
    add_part(m, base, {.shape = std::move(shape), .X_LP = at, .mass_kg = kg, .color = color});
  };
  solid(Cylinder{body_radius_m - 0.025, 0.16}, {{0, 0, 0.11}, {}}, 0.75 * rest_kg, black);  // batteries low
  solid(Cylinder{body_radius_m, 0.07}, {{0, 0, 0.225}, {}}, 0.15 * rest_kg, team);
  solid(Cylinder{tower_radius_m, 0.35}, {{0, 0, 0.435}, {}}, 0.1 * rest_kg, black);
  see(m, base, Cylinder{tower_radius_m + 0.004, 0.05}, {{0, 0, 0.575}, {}}, team);
  // The shelf of the camera head, held by the tower.
  see(m, base, Box{{0.14, 0.11, 0.012}}, {{0.13, 0, 0.429}, {}}, metal);
  // Numbers to the left, the right and the back, on plates before the round tower.
  for (const double turn : {0.5, 1.0, 1.5}) {
    const Pose X_ML{{}, quat_from_axis_angle({0, 0, 1}, turn * math::pi)};
    see(m, base, Box{{0.02, 0.11, 0.16}}, X_ML * Pose{{tower_radius_m - 0.006, 0, 0.36}, {}}, black);
    add_number(m, base, s.number, X_ML * Pose{{tower_radius_m + 0.0045, 0, 0.36}, {}}, 0.13);
  }
  add_ball_handling(m, base);

  const std::vector<std::string> joints = add_drive(m, base, s);
  add_mirror(m, base);
  add_device(m, "joints", "joint_state", {{"joints", joints}, {"rate", "50"}});
  add_device(m, "imu", "imu", {{"rate", "50"}});
  add_device(m, "truth", "ground_truth", {{"rate", "50"}});
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "msl_robot",
    .help = "Football robot of the Middle Size League.",
});

}  // namespace sandlot::builders::msl_robot
