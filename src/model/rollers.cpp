#include "model/rollers.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/math.h"
#include "geometry/barrel.h"
#include "geometry/bounds.h"
#include "geometry/mesh.h"

namespace sandlot::model {
namespace {

constexpr int most_rollers = 200, most_rows = 8;

/// The arc whose curve keeps to the wheel's rim as the wheel turns.
///
/// At z along the roller's axis, which is turned by a about the outward radius, its axis is z sin(a) off that radius.
/// The outermost point of the slice there lies at R to second order in z if
///
///   1 / profile = sin(a)^2 / (R - r cos(a)^2)
///
/// For an omni wheel (90 deg) that is the rim itself, exactly; for thin rollers R / sin(a)^2. What is left is of fourth
/// order: for the usual Mecanum wheel 0.1 % of R at the ends.
double profile_m(const RollerWheel& w) {
  const math::SinCos a = math::sincos(w.angle_rad);
  return (w.radius_m - w.roller_radius_m * a.cos * a.cos) / (a.sin * a.sin);
}

/// In a frame whose z is the wheel's axis, with z along the roller's axis and x outwards.
Pose pose_of(const RollerWheel& w, int row, int i) {
  const double turn = math::tau * (i + static_cast<double>(row) / w.rows) / w.count;
  const math::SinCos t = math::sincos(turn);
  const double out = w.radius_m - w.roller_radius_m;
  return {{out * t.cos, out * t.sin, (row - 0.5 * (w.rows - 1)) * w.row_spacing_m},
          quat_from_axis_angle({0, 0, 1}, turn) * quat_from_axis_angle({1, 0, 0}, w.angle_rad)};
}

/// How deep what lies just below the running surface of one roller reaches into the other. Further in rollers may reach
/// into each other: real ones have hollow ends, so that the rim has no gaps.
/// Rows are apart as a whole.
/// @param one, other  in a frame whose z is the wheel's axis
double overlap_m(const RollerWheel& w, const Barrel& b, const Pose& one, const Pose& other, bool same_row) {
  const Vec3 apart = one.p - other.p;
  const double reach = 2 * bounding_radius_m(b), skin = same_row ? 0.15 * w.roller_radius_m : 0,
               rim = same_row ? w.radius_m - 1.2 * skin : 0;
  if (dot(apart, apart) > reach * reach) return 0;
  const Pose X_OtherH = inverse(other);
  double deepest = 0;
  constexpr int around = 96, along = 32;
  for (int k = 0; k <= along; ++k) {
    const double z = b.length_m * (static_cast<double>(k) / along - 0.5), r = radius_at_m(b, z) - skin;
    for (int i = 0; i < around; ++i) {
      const math::SinCos a = math::sincos(math::tau * i / around);
      const Vec3 p = one * Vec3{r * a.cos, r * a.sin, z};
      if (p.x * p.x + p.y * p.y < rim * rim) continue;
      deepest = std::max(deepest, -nearest(b, X_OtherH * p).distance_m);
    }
  }
  return deepest;
}

Status check(const Model& model, const Joint& joint) {
  const RollerWheel& w = *joint.rollers;
  const auto wrong = [&](const std::string& what, const std::string& right) {
    return Error{"the rollers of joint '" + joint.name + "': " + what, right, joint.place};
  };
  const auto length = [](double x) { return x > 0 && x < 1e6; };
  if (joint.type != JointType::continuous && joint.type != JointType::revolute)
    return wrong("a wheel turns about an axis", "make the joint continuous");
  if (!length(w.radius_m))
    return wrong("the wheel's radius is not positive", "give the radius over the rollers");
  if (w.count < 2 || w.count > most_rollers)
    return wrong("a wheel with a count of " + std::to_string(w.count) + " cannot be built",
                 "2 to " + std::to_string(most_rollers) + " rollers per row");
  if (w.rows < 1 || w.rows > most_rows)
    return wrong("a wheel with " + std::to_string(w.rows) + " rows cannot be built",
                 "1 to " + std::to_string(most_rows) + " rows");
  if (w.rows > 1 && !length(w.row_spacing_m))
    return wrong("the spacing of the rows is not positive", "the distance between their middles");
  if (!length(w.roller_radius_m) || !length(w.roller_length_m))
    return wrong("a roller has no size", "give its radius (in the middle) and its length");
  if (!(w.roller_radius_m < 0.9 * w.radius_m))
    return wrong("a roller is as thick as the wheel", "a smaller radius of the rollers, or a larger wheel");
  if (!(std::abs(math::sin(w.angle_rad)) > 0.17) || !(std::abs(w.angle_rad) < 2 * math::pi))
    return wrong("with rollers along its axis it could not be driven",
                 "an angle of 10 to 170 deg: 90 deg for an omni wheel, 45 or -45 deg for a Mecanum wheel");
  if (!(w.roller_mass_kg > 0 && w.roller_mass_kg < 1e6))
    return wrong("the mass of a roller is not positive", "give it in kg");
  if (!(w.bearing_friction_Nm >= 0 && w.bearing_friction_Nm < 1e6))
    return wrong("the bearing friction is negative", "0 switches it off");
  const Barrel barrel{w.roller_radius_m, profile_m(w), w.roller_length_m};
  if (!is_barrel(barrel))
    return wrong("a roller is too long to keep to the rim: it would end in a point before its ends",
                 "shorter or thicker rollers");
  const Pose first = pose_of(w, 0, 0);
  for (int row = 0; row < std::min(w.rows, 2); ++row)
    for (int i = row == 0 ? 1 : 0; i < w.count; ++i)
      if (overlap_m(w, barrel, first, pose_of(w, row, i), row == 0) > 0.05 * w.roller_radius_m)
        return wrong(row == 0 ? "neighbouring rollers overlap" : "rollers of neighbouring rows overlap",
                     row == 0 ? "fewer, shorter or thinner rollers" : "a larger spacing of the rows");
  // The hub stays below what the rollers reach over.
  const Link& link = model.links[joint.child];
  const Pose X_HL = inverse(joint.X_CJ * Pose{{}, quat_between({0, 0, 1}, joint.axis_J)});
  for (const Collision& c : link.collisions) {
    if (std::holds_alternative<Plane>(c.shape) || std::holds_alternative<Heightfield>(c.shape))
      return wrong("collision '" + c.name + "' of its wheel has no end", "a cylinder smaller than the wheel");
    const Pose X_HC = X_HL * c.X_LC;
    double reach = 0;
    for (const Vec3& v : tessellate(c.shape).vertices) {
      const Vec3 p = X_HC * v;
      reach = std::max(reach, std::sqrt(p.x * p.x + p.y * p.y));
    }
    if (!(reach < 0.995 * w.radius_m))
      return wrong("collision '" + c.name + "' of its wheel reaches as far as the rollers do",
                   "make it smaller, or leave it out: the rollers bring their own");
  }
  return {};
}

Link link_of(const RollerWheel& w, const Barrel& barrel, const std::string& name, int number) {
  Link link;
  link.name = name;
  link.inertial.mass_kg = w.roller_mass_kg;
  link.inertial.moments = inertia_kg_m2(barrel, w.roller_mass_kg);
  Collision collision;
  collision.name = "collision";
  collision.shape = barrel;
  collision.surface = w.surface;
  link.collisions.push_back(std::move(collision));
  Visual visual;
  visual.name = "visual";
  visual.shape = barrel;
  // Two greys by turns, so that one sees the wheel turn.
  const float grey = number % 2 ? 0.22f : 0.1f;
  visual.material.diffuse = {grey, grey, grey, 1};
  visual.material.from_mesh = false;
  link.visuals.push_back(std::move(visual));
  return link;
}

}  // namespace

bool is_wheel(const RollerWheel& w) {
  const auto length = [](double x) { return x > 1e-9 && x < 1e6; };
  return length(w.radius_m) && length(w.roller_radius_m) && length(w.roller_length_m) &&
         w.roller_radius_m < w.radius_m && w.count >= 1 && w.count <= most_rollers && w.rows >= 1 &&
         w.rows <= most_rows && w.row_spacing_m >= 0 && w.row_spacing_m < 1e3 && std::abs(w.angle_rad) < 10 &&
         w.roller_mass_kg >= 0 && w.bearing_friction_Nm >= 0 && w.bearing_friction_Nm < 1e9;
}

Status add_rollers(Model& model) {
  const std::size_t declared = model.joints.size();
  for (std::uint32_t j = 0; j < declared; ++j) {
    if (!model.joints[j].rollers) continue;
    if (std::any_of(model.joints.begin(), model.joints.end(),
                    [&](const Joint& x) { return x.roller_of == j; }))
      continue;
    const Joint wheel = model.joints[j];
    const RollerWheel& w = *wheel.rollers;
    SL_TRY(check(model, wheel));
    const Barrel barrel{w.roller_radius_m, profile_m(w), w.roller_length_m};
    const Pose X_MH = model.links[wheel.child].X_ML * wheel.X_CJ *
                      Pose{{}, quat_between({0, 0, 1}, wheel.axis_J)};
    for (int row = 0; row < w.rows; ++row)
      for (int i = 0; i < w.count; ++i) {
        const int number = row * w.count + i;
        const std::string name = model.links[wheel.child].name + "_roller_" + std::to_string(number);
        if (model.find_link(name) || model.find_joint(name + "_axle"))
          return Error{"the rollers of joint '" + wheel.name + "': there is a '" + name + "' already",
                       "rename that", wheel.place};
        Link link = link_of(w, barrel, name, number);
        link.X_ML = X_MH * pose_of(w, row, i);
        link.X_ML.q = normalised(link.X_ML.q);
        link.gravity = model.links[wheel.child].gravity;
        link.place = wheel.place;
        link.collisions.front().place = link.visuals.front().place = wheel.place;
        Joint joint;
        joint.name = name + "_axle";
        joint.type = JointType::continuous;
        joint.parent = wheel.child;
        joint.child = static_cast<std::uint32_t>(model.links.size());
        joint.friction = w.bearing_friction_Nm;
        joint.roller_of = j;
        joint.place = wheel.place;
        model.links.push_back(std::move(link));
        model.joints.push_back(std::move(joint));
      }
  }
  return {};
}

}  // namespace sandlot::model
