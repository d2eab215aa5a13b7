/// A humanoid on two legs. After the skeleton of LpzRobots: torques of hips and back 20, knees 10, arms 8, elbows 4, ankles 3 and
/// neck 2; here the ankles are as strong as the knees, so that it stands.
///
/// Frame    M: middle of the pelvis, x forward, y left; it stands on its feet, arms down.
/// Moves    motors [rad]: `back` (positive bends forwards), `neck`, then left and right `hip` (positive swings the leg
///          backwards), `spread` (positive spreads it), `knee` (positive bends it), `ankle`, `shoulder`, `lift` (positive lifts the
///          arm sideways), `elbow` (negative bends it): `left_hip` ...
/// Senses   `joints`, `imu` in the pelvis.
/// Limits   no hands; trunk, arms and legs do not touch each other; the second axes of hips and shoulders are light links without
///          geometry.
/// Source   proportions of a person of this height, rounded; torques as above, in proportion to `power`.
#include "base/math.h"
#include "builders/builder.h"
#include "builders/parts.h"

namespace sandlot::builders::humanoid {
namespace {

struct Spec {
  double height_m = 1.2, mass_kg = 10, power = 1, speed_radps = 5;
  Units units = Units::si;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"height", "m", "Height of the robot; all other lengths follow from it.", 0.05, 20},
          s.height_m);
    visit(Field{"mass", "kg", "Mass of the whole robot.", 1e-3, 1e4}, s.mass_kg);
    visit(Field{"power", "1", "Factor on the largest torques of all joints.", 0, 1e5}, s.power);
    visit(Field{"speed", "rad/s", "Fastest turn of a joint.", 0, 1e3}, s.speed_radps);
    visit(units_field, s.units);
  }
};

struct Body {
  const Spec& s;
  model::Model& m;

  std::uint32_t limb(const std::string& name, Vec3 top, double length, double radius, double share,
                     Color color) const {
    const std::uint32_t link = add_link(m, name, {top, {}});
    add_part(
        m, link,
        {Capsule{radius, length - radius}, along({0, 0, 1}, {0, 0, -length / 2}), share * s.mass_kg, color});
    return link;
  }
  std::uint32_t between(const std::string& name, Vec3 at) const {
    const std::uint32_t link = add_link(m, name, {at, {}});
    add_mass(m, link, 0.005 * s.mass_kg, 0.04 * s.height_m);
    return link;
  }
  void joint(const std::string& name, std::uint32_t parent, std::uint32_t child, Vec3 at, Vec3 axis,
             double lower, double upper, double torque) const {
    add_motor(m, name,
              add_joint(m, name + "_joint", parent, child, at,
                        {.axis_M = axis,
                         .lower = lower,
                         .upper = upper,
                         .max_effort = s.power * torque,
                         .max_velocity = s.speed_radps}));
  }
};

Result<Built> build(const Spec& s) {
  Built out;
  model::Model& m = out.model;
  const Body b{s, m};
  const double h = s.height_m, thigh = 0.245 * h, shin = 0.245 * h, foot = 0.03 * h, hip_z = 0.02 * h;
  constexpr Vec3 left{0, 1, 0};
  out.X_WM.p.z = thigh + shin + foot + hip_z;
  const std::uint32_t pelvis = add_link(m, "pelvis", {});
  add_part(m, pelvis, {Box{{0.11 * h, 0.18 * h, 0.1 * h}}, {}, 0.15 * s.mass_kg, colors::blue});
  const Vec3 waist{0, 0, 0.06 * h};
  const std::uint32_t chest = add_link(m, "chest", {waist, {}});
  add_part(m, chest,
           {Box{{0.11 * h, 0.2 * h, 0.24 * h}}, {{0, 0, 0.13 * h}, {}}, 0.29 * s.mass_kg, colors::orange});
  b.joint("back", pelvis, chest, waist, left, -0.4, 0.6, 20);
  const Vec3 throat = waist + Vec3{0, 0, 0.27 * h};
  const std::uint32_t head = add_link(m, "head", {throat, {}});
  add_part(m, head, {Sphere{0.065 * h}, {{0, 0, 0.07 * h}, {}}, 0.06 * s.mass_kg, colors::yellow});
  for (const double side : {0.4, -0.4})
    add_part(m, head,
             {.shape = Sphere{0.012 * h},
              .X_LP = {{0.057 * h, side * 0.065 * h, 0.085 * h}, {}},
              .color = colors::dark,
              .touches = false});
  b.joint("neck", chest, head, throat, left, -0.5, 0.5, 2);
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "left_" : "right_";
    const Vec3 outwards{side, 0, 0};
    const Vec3 hip{0, side * 0.065 * h, -hip_z}, knee = hip + Vec3{0, 0, -thigh},
                                                 ankle = knee + Vec3{0, 0, -shin};
    const std::uint32_t cross = b.between(name + "hip_cross", hip);
    const std::uint32_t upper = b.limb(name + "thigh", hip, thigh, 0.045 * h, 0.1, colors::blue);
    const std::uint32_t lower = b.limb(name + "shin", knee, shin, 0.035 * h, 0.06, colors::blue);
    b.joint(name + "hip", pelvis, cross, hip, left, -1.2, 0.5, 20);
    b.joint(name + "spread", cross, upper, hip, outwards, -0.2, 0.6, 20);
    b.joint(name + "knee", upper, lower, knee, left, -0.05, 1.6, 10);
    const std::uint32_t sole = add_link(m, name + "foot", {ankle, {}});
    add_part(
        m, sole,
        {Box{{0.17 * h, 0.08 * h, foot}}, {{0.025 * h, 0, -foot / 2}, {}}, 0.02 * s.mass_kg, colors::dark});
    b.joint(name + "ankle", lower, sole, ankle, left, -0.5, 0.5, 10);
    const Vec3 shoulder = waist + Vec3{0, side * 0.145 * h, 0.225 * h},
               elbow = shoulder + Vec3{0, 0, -0.16 * h};
    const std::uint32_t yoke = b.between(name + "shoulder_cross", shoulder);
    const std::uint32_t arm = b.limb(name + "arm", shoulder, 0.16 * h, 0.03 * h, 0.035, colors::orange);
    const std::uint32_t forearm = b.limb(name + "forearm", elbow, 0.2 * h, 0.025 * h, 0.025, colors::yellow);
    b.joint(name + "shoulder", chest, yoke, shoulder, left, -1.5, 1, 8);
    b.joint(name + "lift", yoke, arm, shoulder, outwards, -0.1, 1.4, 8);
    b.joint(name + "elbow", arm, forearm, elbow, left, -1.8, 0.05, 4);
  }
  add_senses(m);
  set_units(m, s.units);
  return out;
}

}  // namespace

extern const Builder builder;
constinit const Builder builder = make_builder<Spec, build>({
    .name = "humanoid",
    .help = "Humanoid on two legs, with arms, waist and neck.",
});

}  // namespace sandlot::builders::humanoid
