/// Places of rollers on a wheel, and wheels that cannot be built.
#include "model/rollers.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "geometry/barrel.h"

namespace sandlot::model {
namespace {

Model with(const RollerWheel& rollers) {
  Model m;
  m.name = "m";
  for (const char* name : {"base", "wheel"}) m.links.emplace_back().name = name;
  Joint joint;
  joint.name = "axle";
  joint.type = JointType::continuous;
  joint.child = 1;
  joint.axis_J = {0, 1, 0};
  joint.rollers = rollers;
  m.joints.push_back(joint);
  return m;
}
RollerWheel mecanum(double angle) {
  RollerWheel w;
  w.angle_rad = angle;
  w.count = 9;
  w.roller_length_m = 0.04;
  return w;
}

/// How far the surface of the rollers lies from the wheel's axis, at most, by the angle about it: points all over them.
std::pair<double, double> rim_of(const Model& m, double within_rad) {
  double least = 1e9, most = 0;
  const Link& roller = m.links[2];
  const Barrel& b = std::get<Barrel>(roller.collisions[0].shape);
  const Vec3 out = normalised(roller.X_ML.p), along = cross({0, 1, 0}, out);
  for (double angle = -within_rad; angle <= within_rad; angle += within_rad / 20) {
    // In the direction of that angle the rim is where the support of the roller is, over all widths.
    const auto [s, c] = math::sincos(angle);
    const Vec3 n = rotate_inverse(roller.X_ML.q, c * out + s * along);
    const double reach = dot(c * out + s * along, roller.X_ML.p) + reach_m(b, n.z);
    least = std::min(least, reach), most = std::max(most, reach);
  }
  return {least, most};
}

TEST(Rollers, OfAnOmniWheelKeepExactlyToTheRim) {
  Model m = with({});
  ASSERT_TRUE(add_rollers(m));
  ASSERT_EQ(m.links.size(), 12u);
  ASSERT_EQ(m.joints.size(), 11u);
  EXPECT_EQ(m.links[5].name, "wheel_roller_3");
  EXPECT_EQ(m.joints[4].name, "wheel_roller_3_axle");
  EXPECT_EQ(m.joints[4].roller_of, 0u);
  EXPECT_EQ(m.joints[4].parent, 1u);
  EXPECT_EQ(m.joints[4].type, JointType::continuous);
  for (std::size_t i = 2; i < 12; ++i) {
    EXPECT_NEAR(norm(m.links[i].X_ML.p), 0.04, 1e-12) << "R - r from the axis";
    EXPECT_NEAR(m.links[i].X_ML.p.y, 0, 1e-12) << "in the wheel's plane";
    // Axes along the rim: across the wheel's axis and the radius.
    const Vec3 axis = rotate(m.links[i].X_ML.q, {0, 0, 1});
    EXPECT_NEAR(axis.y, 0, 1e-12);
    EXPECT_NEAR(dot(axis, m.links[i].X_ML.p), 0, 1e-12);
  }
  const auto [least, most] = rim_of(m, 0.29);
  EXPECT_NEAR(least, 0.05, 1e-12);
  EXPECT_NEAR(most, 0.05, 1e-12);
  EXPECT_NEAR(std::get<Barrel>(m.links[2].collisions[0].shape).profile_m, 0.05, 1e-15);
  ASSERT_TRUE(add_rollers(m));
  EXPECT_EQ(m.links.size(), 12u) << "once is enough";
}

/// To second order exact, so the fourth remains: z^4 sin^4 cos^2 / (8 R^3) at z = 14 mm off the middle, times a few for
/// the thickness of the roller.
TEST(Rollers, OfAMecanumWheelKeepToTheRimAndLeanAsTold) {
  for (const double angle : {math::pi / 4, -math::pi / 4}) {
    Model m = with(mecanum(angle));
    const Status added = add_rollers(m);
    ASSERT_TRUE(added) << added.error().what;
    const auto [least, most] = rim_of(m, 0.33);
    EXPECT_NEAR(least, 0.05, 1.5e-4);
    EXPECT_NEAR(most, 0.05, 1.5e-4);
    // The axis of the wheel, turned about the outward radius.
    const Vec3 out = normalised(m.links[2].X_ML.p);
    const Vec3 axis = rotate(m.links[2].X_ML.q, {0, 0, 1});
    const Vec3 told = rotate(quat_from_axis_angle(out, angle), {0, 1, 0});
    EXPECT_NEAR(dot(axis, told), 1, 1e-12);
  }
}

TEST(Rollers, OfTwoRowsStandInTheGapsOfEachOther) {
  RollerWheel w;
  w.count = 6, w.rows = 2, w.row_spacing_m = 0.025;
  Model m = with(w);
  ASSERT_TRUE(add_rollers(m));
  ASSERT_EQ(m.links.size(), 14u);
  EXPECT_NEAR(m.links[2].X_ML.p.y, -0.0125, 1e-12);
  EXPECT_NEAR(m.links[8].X_ML.p.y, 0.0125, 1e-12);
  const Vec3 a = m.links[2].X_ML.p, b = m.links[8].X_ML.p;
  EXPECT_NEAR(a.x * b.x + a.z * b.z, 0.0016 * math::cos(math::pi / 6), 1e-12) << "half a pitch of 60 deg";
}

TEST(Rollers, ThatCannotBeAreErrorsThatSayWhatWouldBeRight) {
  const auto error = [](auto change) {
    RollerWheel w;
    change(w);
    Model m = with(w);
    m.joints[0].place = Place{std::make_shared<const std::string>("f.sdf"), 7, 3};
    const Status made = add_rollers(m);
    return made ? std::string("none") : made.error().text();
  };
  const struct {
    const char* says;
    std::string said;
  } cases[] = {
      {"radius is not positive", error([](RollerWheel& w) { w.radius_m = 0; })},
      {"radius is not positive", error([](RollerWheel& w) { w.radius_m = std::nan(""); })},
      {"count of 1", error([](RollerWheel& w) { w.count = 1; })},
      {"count of 100000", error([](RollerWheel& w) { w.count = 100000; })},
      {"0 rows", error([](RollerWheel& w) { w.rows = 0; })},
      {"neighbouring rollers overlap", error([](RollerWheel& w) { w.count = 12; })},
      {"neighbouring rows overlap",
       error([](RollerWheel& w) { w.count = 6, w.rows = 2, w.row_spacing_m = 0.01; })},
      {"along its axis", error([](RollerWheel& w) { w.angle_rad = 0; })},
      {"along its axis", error([](RollerWheel& w) { w.angle_rad = math::pi; })},
      {"as thick as the wheel", error([](RollerWheel& w) { w.roller_radius_m = 0.05; })},
      {"too long", error([](RollerWheel& w) { w.roller_length_m = 0.09; })},
      {"no size", error([](RollerWheel& w) { w.roller_length_m = 0; })},
      {"mass of a roller", error([](RollerWheel& w) { w.roller_mass_kg = 0; })},
      {"bearing friction", error([](RollerWheel& w) { w.bearing_friction_Nm = -1; })},
  };
  for (const auto& c : cases) {
    EXPECT_NE(c.said.find(c.says), std::string::npos) << c.said;
    EXPECT_EQ(c.said.rfind("f.sdf:7", 0), 0u) << c.said;
  }
  Model m = with({});
  m.links[1].collisions.push_back(
      {"tyre", {{}, quat_from_rpy(math::pi / 2, 0, 0)}, Cylinder{0.05, 0.02}, {}, {}});
  EXPECT_FALSE(add_rollers(m)) << "a hub as large as the wheel";
  std::get<Cylinder>(m.links[1].collisions[0].shape).radius_m = 0.045;
  EXPECT_TRUE(add_rollers(m));
}

}  // namespace
}  // namespace sandlot::model
