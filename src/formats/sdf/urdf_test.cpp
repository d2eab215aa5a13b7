#include "formats/sdf/urdf.h"

#include <gtest/gtest.h>
#ifdef SANDLOT_HAS_SDFORMAT
#include <sdf/sdf.hh>
#endif

#include "base/math.h"
#include "base/text.h"
#include "formats/sdf/sdf.h"

namespace sandlot::formats::urdf_test {
namespace {

struct Read {
  std::shared_ptr<const model::Model> model;
  model::Instance instance;
  std::string error;
  std::vector<std::string> warnings;
};

Read parse(const std::string& text) {
  Diagnostics diagnostics;
  auto result = parse_sdf(text, "r.urdf", diagnostics);
  Read out;
  if (result) out.instance = std::move(result->instances.at(0)), out.model = out.instance.model;
  else out.error = result.error().text();
  for (const Error& warning : diagnostics.warnings) out.warnings.push_back(warning.text());
  return out;
}

std::string robot(const std::string& content) { return "<robot name='r'>\n" + content + "\n</robot>"; }

constexpr const char* body =
    "<inertial><mass value='2'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial>";
std::string link(const std::string& name, const std::string& content = body) {
  return "<link name='" + name + "'>" + content + "</link>";
}
std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& content = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
         child + "'/>" + content + "</joint>";
}

void expect_vec(Vec3 a, Vec3 b, double tolerance = 1e-15) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

bool mentions(const std::vector<std::string>& warnings, const std::string& words) {
  for (const std::string& each : warnings)
    if (each.find(words) != std::string::npos) return true;
  return false;
}

TEST(Urdf, PlacesAChainAsWorkedOutByHand) {
  // b: 1 ahead of a, turned left by 90 degrees. c: 2 ahead of b, which is 2 to the left in a, and rolled by 90 degrees.
  // d: 3 along c's y. c's y axis: Rz(90) Rx(90) ey = Rz(90) ez = ez. So d is at (1, 2, 3).
  const Read r = parse(robot(
      link("a") + link("b") + link("c") + link("d") +
      joint("ab", "continuous", "a", "b",
            "<origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/><axis xyz='0 0 2'/>") +
      joint("bc", "prismatic", "b", "c",
            "<origin rpy='1.5707963267948966 0 0' xyz='2 0 0'/>"
            "<limit lower='-0.5' upper='1.5' effort='3' velocity='4'/>"
            "<dynamics damping='0.25' friction='0.5'/>"
            "<safety_controller soft_lower_limit='-0.25' soft_upper_limit='1' k_position='8' k_velocity='6'/>"
            "<calibration rising='0'/>") +
      joint("cd", "fixed", "c", "d", "<origin xyz='0 3 0'/>")));
  ASSERT_TRUE(r.model) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  const model::Model& m = *r.model;
  ASSERT_EQ(m.links.size(), 4u);
  EXPECT_EQ(m.links[0].X_ML, Pose());
  expect_vec(m.links[1].X_ML.p, {1, 0, 0});
  expect_vec(m.links[2].X_ML.p, {1, 2, 0}, 1e-15);
  expect_vec(m.links[3].X_ML.p, {1, 2, 3}, 1e-15);
  expect_vec(rotate(m.links[2].X_ML.q, {1, 0, 0}), {0, 1, 0});
  expect_vec(rotate(m.links[2].X_ML.q, {0, 1, 0}), {0, 0, 1});
  ASSERT_EQ(m.joints.size(), 3u);
  for (const model::Joint& each : m.joints) EXPECT_EQ(each.X_CJ, Pose()) << "exactly in the child's frame";
  EXPECT_EQ(m.joints[0].type, model::JointType::continuous);
  EXPECT_EQ(m.joints[0].axis_J, (Vec3{0, 0, 1}));
  EXPECT_EQ(m.joints[1].axis_J, (Vec3{1, 0, 0})) << "URDF's default";
  EXPECT_EQ(m.joints[1].lower, -0.5);
  EXPECT_EQ(m.joints[1].upper, 1.5);
  EXPECT_EQ(m.joints[1].max_effort, 3);
  EXPECT_EQ(m.joints[1].max_velocity, 4);
  EXPECT_EQ(m.joints[1].damping, 0.25);
  EXPECT_EQ(m.joints[1].friction, 0.5);
  ASSERT_TRUE(m.joints[1].safety);
  EXPECT_EQ(m.joints[1].safety->soft_lower, -0.25);
  EXPECT_EQ(m.joints[1].safety->soft_upper, 1);
  EXPECT_EQ(m.joints[1].safety->k_position, 8);
  EXPECT_EQ(m.joints[1].safety->k_velocity, 6);
  EXPECT_FALSE(m.joints[0].safety);
  EXPECT_EQ(m.joints[2].type, model::JointType::fixed);
  EXPECT_EQ(m.joints[1].place.line, 2);
}

TEST(Urdf, SafetyLimitsAreWholeOrRefused) {
  const auto with = [](const char* type, const char* safety) {
    return parse(robot(link("a") + link("b") +
                       joint("j", type, "a", "b",
                             std::string("<limit lower='-1' upper='1' effort='3' velocity='4'/>") + safety)));
  };
  const Read turns = with("continuous", "<safety_controller k_velocity='10'/>");
  ASSERT_TRUE(turns.model) << turns.error;
  EXPECT_EQ(turns.model->joints[0].safety->soft_upper, 1e16) << "a continuous joint has no end";
  EXPECT_EQ(turns.model->joints[0].safety->k_velocity, 10);
  const auto refused = [&](const char* safety, const char* words) {
    const std::string error = with("revolute", safety).error;
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  refused("<safety_controller k_position='1'/>", "has no k_velocity");
  refused("<safety_controller soft_lower_limit='1' soft_upper_limit='0' k_position='1' k_velocity='1'/>",
          "leave no room");
  refused("<safety_controller k_position='-1' k_velocity='1'/>", "k_position");
}

TEST(Urdf, TheRootIsTheCanonicalLinkWhereverItStands) {
  const Read r = parse(robot(link("wheel") + link("base") +
                             joint("j", "continuous", "base", "wheel", "<origin xyz='0 1 0'/>")));
  ASSERT_TRUE(r.model) << r.error;
  EXPECT_EQ(r.model->links[0].name, "base");
  EXPECT_EQ(r.model->links[1].X_ML.p, (Vec3{0, 1, 0}));
}

TEST(Urdf, ReadsInertiaShapesAndMaterials) {
  const Read r = parse(robot(R"(<material name="blue"><color rgba="0 0.25 0.5 1"/></material>
    <link name="l"><inertial><origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><mass value="4"/>
        <inertia ixx="1" ixy="0.1" ixz="0.2" iyy="1.5" iyz="0.3" izz="2"/></inertial>
      <visual><geometry><box size=" 1  2
 3"/></geometry><material name="blue"/></visual>
      <visual name="l_visual"><geometry><sphere radius="0.5"/></geometry>
        <material name="red"><color rgba="1 0 0 0.5"/></material></visual>
      <visual><geometry><cylinder radius="0.5" length="2"/></geometry><material name="red"/></visual>
      <visual name="v"><geometry><capsule radius="0.25" length="2"/></geometry></visual>
      <collision name="same"><origin xyz="1 0 0"/><geometry><box size="1 1 1"/></geometry></collision>
      <collision name="same"><geometry><box size="1 1 1"/></geometry></collision>
    </link>)"));
  ASSERT_TRUE(r.model) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  const model::Link& l = r.model->links.at(0);
  EXPECT_EQ(l.inertial.mass_kg, 4);
  EXPECT_EQ(l.inertial.X_LCo.p, (Vec3{0.1, 0.2, 0.3}));
  EXPECT_NEAR(yaw_of(l.inertial.X_LCo.q), math::pi / 2, 1e-15);
  EXPECT_EQ(l.inertial.moments, (Vec3{1, 1.5, 2}));
  EXPECT_EQ(l.inertial.products, (Vec3{0.1, 0.2, 0.3}));
  ASSERT_EQ(l.visuals.size(), 4u);
  EXPECT_EQ(l.visuals[0].name, "l_visual_1") << "the name without a number is taken";
  EXPECT_EQ(l.visuals[1].name, "l_visual");
  EXPECT_EQ(l.visuals[2].name, "l_visual_2");
  EXPECT_EQ(l.visuals[3].name, "v");
  EXPECT_EQ(std::get<Box>(l.visuals[0].shape).size_m, (Vec3{1, 2, 3}));
  EXPECT_EQ(l.visuals[0].material.diffuse, (Color{0, 0.25f, 0.5f, 1}));
  EXPECT_EQ(l.visuals[1].material.diffuse, (Color{1, 0, 0, 0.5f}));
  EXPECT_EQ(l.visuals[2].material.diffuse, (Color{1, 0, 0, 0.5f})) << "defined by the visual before";
  EXPECT_EQ(std::get<Capsule>(l.visuals[3].shape).length_m, 2);
  ASSERT_EQ(l.collisions.size(), 2u);
  EXPECT_EQ(l.collisions[0].name, "same");
  EXPECT_EQ(l.collisions[1].name, "same_1");
  EXPECT_EQ(l.collisions[0].X_LC.p.x, 1);
}

TEST(Urdf, LinksWithoutMassAreFrames) {
  // base_footprint, base and a sensor's frame are one body of 2 kg, whatever the frames add.
  const Read r = parse(robot(
      link("base_footprint", "") + link("base") + link("laser", "<inertial><mass value='0'/></inertial>") +
      link("tip", "<inertial><mass value='0.5'/><inertia ixx='0' iyy='0' izz='0'/></inertial>") +
      joint("j1", "fixed", "base_footprint", "base") + joint("j2", "fixed", "base", "laser") +
      joint("j3", "fixed", "laser", "tip")));
  ASSERT_TRUE(r.model) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  ASSERT_EQ(r.model->links.size(), 4u);
  EXPECT_EQ(r.model->joints.size(), 3u);
  double mass_kg = 0;
  for (const model::Link& l : r.model->links) mass_kg += l.inertial.mass_kg;
  EXPECT_NEAR(mass_kg, 2.5, 2.5e-9);
  for (const int frame : {0, 2}) {
    const model::Inertial& i = r.model->links[static_cast<std::size_t>(frame)].inertial;
    EXPECT_GT(i.mass_kg, 0);
    EXPECT_LT(i.mass_kg, 1e-11);
    EXPECT_LT(i.moments.x, 1e-14);
  }
  EXPECT_EQ(r.model->links[3].inertial.mass_kg, 0.5) << "a point mass";
  EXPECT_LT(r.model->links[3].inertial.moments.z, 1e-13);
}

TEST(Urdf, WhatMovesWithoutMassIsSaid) {
  const Read r = parse(
      robot(link("base") + "\n" +
            link("caster", "<collision><geometry><sphere radius='0.1'/></geometry></collision>") +
            joint("j", "continuous", "base", "caster")));
  ASSERT_TRUE(r.model) << r.error;
  ASSERT_EQ(r.warnings.size(), 1u);
  EXPECT_NE(r.warnings[0].find("r.urdf:3: link 'caster' has no <inertial>"), std::string::npos)
      << r.warnings[0];
}

TEST(Urdf, ALinkCalledWorldIsTheWorld) {
  const Read r = parse(robot(link("world", "") + link("base", "") + link("arm") +
                             joint("foot", "fixed", "world", "base", "<origin xyz='1 2 3'/>") +
                             joint("turn", "continuous", "base", "arm")));
  ASSERT_TRUE(r.model) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  ASSERT_EQ(r.model->links.size(), 2u);
  EXPECT_EQ(r.model->links[0].X_ML.p, (Vec3{1, 2, 3}));
  EXPECT_EQ(r.model->joints[0].parent, model::world_link);
}

TEST(Urdf, FloatingJointsLeaveTheirChildFree) {
  const Read r = parse(robot(link("world", "") + link("base") +
                             joint("free", "floating", "world", "base", "<origin xyz='0 0 1'/>")));
  ASSERT_TRUE(r.model) << r.error;
  EXPECT_TRUE(r.model->joints.empty());
  EXPECT_EQ(r.model->links[0].X_ML.p, (Vec3{0, 0, 1}));
}

TEST(Urdf, NamesThatSdfCannotHaveAreChangedEverywhere) {
  const Read r = parse(
      robot(link("a::b") + link("wheel") + joint("wheel", "continuous", "a::b", "wheel") + R"(
    <gazebo><plugin name="gz::sim::systems::DiffDrive" filename="x"><left_joint>wheel</left_joint></plugin></gazebo>)"));
  ASSERT_TRUE(r.model) << r.error;
  EXPECT_EQ(r.model->links[0].name, "a__b");
  EXPECT_EQ(r.model->joints[0].name, "wheel_joint");
  EXPECT_TRUE(mentions(r.warnings, "joint 'wheel' is called 'wheel_joint'"));
  EXPECT_TRUE(mentions(r.warnings, "link 'a::b' is called 'a__b'"));
  EXPECT_EQ(r.model->devices.at(0).config.find("left_joint")->text(), "wheel_joint");
}

TEST(Urdf, GazeboElementsGoWhereTheyBelong) {
  const Read r = parse(
      robot(link("l", std::string(body) +
                          "<collision name='c'><geometry><sphere radius='1'/></geometry></collision>"
                          "<collision name='d'><geometry><sphere radius='1'/></geometry></collision>") +
            link("m") + joint("j", "continuous", "l", "m") + R"(
    <gazebo reference="l">
      <mu1>0.25</mu1><mu2 value="unread">0.5</mu2><fdir1>0 1 0</fdir1><selfCollide>true</selfCollide>
      <turnGravityOff>true</turnGravityOff>
      <collision name="d"><surface><friction><ode><mu>0.75</mu></ode></friction></surface></collision>
      <collision><surface><bounce><restitution_coefficient>0.5</restitution_coefficient></bounce></surface></collision>
      <sensor name="scan" type="no_such_sensor"><pose>1 0 0 0 0 0</pose></sensor>
      <nonsense/>
    </gazebo>
    <gazebo reference="j"><springStiffness>3</springStiffness><springReference>0.5</springReference>
      <provideFeedback>true</provideFeedback><preserveFixedJoint>true</preserveFixedJoint></gazebo>
    <gazebo reference="lost"><mu1>1</mu1></gazebo>
    <gazebo><static>false</static><plugin name="p" filename="libp.so"/></gazebo>)"));
  ASSERT_TRUE(r.model) << r.error;
  const model::Link& l = r.model->links[0];
  EXPECT_EQ(l.collisions.at(0).surface.mu, 0.25);
  EXPECT_EQ(l.collisions[0].surface.mu2, 0.5);
  EXPECT_EQ(l.collisions[0].surface.fdir1, (Vec3{0, 1, 0}));
  EXPECT_EQ(l.collisions[0].surface.restitution, 0.5);
  EXPECT_EQ(l.collisions.at(1).surface.restitution, 0.5);
  EXPECT_FALSE(l.gravity);
  ASSERT_EQ(r.model->devices.size(), 2u);
  EXPECT_EQ(r.model->devices[0].name, "scan");
  EXPECT_EQ(r.model->devices[0].X_LS.p, (Vec3{1, 0, 0}));
  EXPECT_EQ(r.model->devices[0].place.line, 8);
  EXPECT_EQ(r.model->devices[1].name, "p");
  EXPECT_EQ(r.model->joints[0].spring_stiffness, 3);
  EXPECT_EQ(r.model->joints[0].spring_reference, 0.5);
  EXPECT_TRUE(mentions(r.warnings, "r.urdf:9: <nonsense> in <gazebo> is not used"));
  EXPECT_TRUE(mentions(r.warnings, "r.urdf:13: there is no link or joint 'lost'"));
  EXPECT_EQ(r.warnings.size(), 2u) << r.warnings.back();
}

TEST(Urdf, TransmissionsAndRos2ControlDriveTheirJoints) {
  const std::string links = link("a") + link("b") + link("c") + link("d") +
                            joint("j", "continuous", "a", "b") + joint("k", "continuous", "a", "c") +
                            joint("f", "fixed", "a", "d");
  const std::string drives = R"(
    <transmission name="t"><type>transmission_interface/SimpleTransmission</type>
      <joint name="j"><hardwareInterface>hardware_interface/VelocityJointInterface</hardwareInterface></joint>
      <actuator name="m"><mechanicalReduction>1</mechanicalReduction></actuator></transmission>
    <ros2_control name="s" type="system"><joint name="k"><command_interface name="effort"/></joint>
      <joint name="j"><command_interface name="position"/></joint>
      <joint name="f"><state_interface name="position"/></joint></ros2_control>)";
  const auto of = [](const Read& r) {
    std::string out;
    for (const model::DeviceDecl& d : r.model->devices)
      if (d.kind == "joint_motor")
        out += d.name + ":" + d.config.find("joint")->text() + ":" + d.config.find("level")->text() + " ";
    return out;
  };
  const Read plain = parse(robot(links + drives));
  ASSERT_TRUE(plain.model) << plain.error;
  EXPECT_TRUE(plain.warnings.empty()) << plain.warnings.front();
  EXPECT_EQ(of(plain), "j:j:velocity k:k:effort ");
  const Read driven = parse(
      robot(links + drives +
            "<gazebo><plugin name='DiffDrive' filename='x'><left_joint>j</left_joint></plugin></gazebo>"));
  EXPECT_EQ(of(driven), "k:k:effort ") << "the plugin is the master of j";
  const Read watched = parse(robot(links + drives +
                                   "<gazebo><plugin name='JointStatePublisher' "
                                   "filename='x'><joint_name>j</joint_name></plugin></gazebo>"));
  EXPECT_EQ(of(watched), "j:j:velocity k:k:effort ");
  const Read ros = parse(
      robot(links + drives +
            "<gazebo><plugin name='gz_ros2_control' filename='libgz_ros2_control-system.so'/></gazebo>"));
  EXPECT_EQ(of(ros), "") << "its controllers are the masters";
}

TEST(Urdf, SensorsOfUrdfItselfAreSensorsOfTheirLink) {
  const Read r = parse(robot(link("l") + R"(
    <sensor name="eye" update_rate="20"><parent link="l"/><origin xyz="0 0 1"/>
      <camera><image width="640" height="480" format="RGB8" hfov="1.5" near="0.1" far="50"/></camera></sensor>
    <sensor name="scan"><parent link="l"/><ray><horizontal samples="90" min_angle="-1" max_angle="1"/></ray></sensor>)"));
  ASSERT_TRUE(r.model) << r.error;
  ASSERT_EQ(r.model->devices.size(), 2u);
  EXPECT_EQ(r.model->devices[0].sdf_types.at(0), "sensor:camera");
  EXPECT_EQ(r.model->devices[0].X_LS.p.z, 1);
  EXPECT_EQ(r.model->devices[0].config.find("update_rate")->text(), "20");
  EXPECT_EQ(r.model->devices[1].config.find("ray")->find("scan")->find("horizontal")->find("samples")->text(),
            "90");
}

TEST(Urdf, WhatIsUnknownIsNamedOnceWithItsLine) {
  const Read r = parse("<robot name='r' color='red'>\n<link name='l'>" + std::string(body) +
                       "<wings/><visual><orign/><geometry><sphere radius='1' size='2'/></geometry>"
                       "<material name='blu'/></visual></link>\n<engine/>\n<material name='blue'><color "
                       "rgba='0 0 1 1'/></material></robot>");
  ASSERT_TRUE(r.model) << r.error;
  EXPECT_TRUE(mentions(r.warnings, "r.urdf:1: attribute 'color' of <robot>"));
  EXPECT_TRUE(mentions(r.warnings, "r.urdf:2: <wings> in <link> is not used"));
  EXPECT_TRUE(mentions(r.warnings, "r.urdf:2: <orign> in <visual> is not used"));
  EXPECT_TRUE(mentions(r.warnings, "r.urdf:2: attribute 'size' of <sphere>"));
  EXPECT_TRUE(mentions(r.warnings, "r.urdf:2: material 'blu' is not defined; did you mean 'blue'?"));
  EXPECT_TRUE(mentions(r.warnings, "r.urdf:3: <engine> in <robot> is not used"));
  EXPECT_EQ(r.warnings.size(), 6u);
}

#ifdef SANDLOT_HAS_SDFORMAT
/// Poses of links against libsdformat's own URDF reader, for chains of movable joints, which it keeps.
TEST(Urdf, AgreesWithLibsdformatOnWhereLinksAre) {
  std::uint32_t state = 12345;
  const auto random = [&] {  // in [-1, 1)
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state >> 8) / 8388608.0 - 1;
  };
  const auto three = [&](double size) {
    return number_text(size * random()) + " " + number_text(size * random()) + " " +
           number_text(size * random());
  };
  for (int round = 0; round < 20; ++round) {
    std::string text = link("l0");
    for (int i = 1; i < 12; ++i) {
      const int parent = std::min(i - 1, static_cast<int>((random() + 1) / 2 * i));
      text += link("l" + std::to_string(i)) + joint("j" + std::to_string(i), "continuous",
                                                    "l" + std::to_string(parent), "l" + std::to_string(i),
                                                    "<origin xyz='" + three(2) + "' rpy='" + three(1.5) +
                                                        "'/><axis xyz='" + three(1) + "'/>");
    }
    const Read ours = parse(robot(text));
    ASSERT_TRUE(ours.model) << ours.error;
    sdf::Root root;
    const sdf::Errors errors = root.LoadSdfString(robot(text));
    ASSERT_TRUE(errors.empty()) << errors.front().Message();
    ASSERT_NE(root.Model(), nullptr);
    for (const model::Link& l : ours.model->links) {
      const sdf::Link* const theirs = root.Model()->LinkByName(l.name);
      ASSERT_NE(theirs, nullptr) << l.name;
      ignition::math::Pose3d X;
      ASSERT_TRUE(theirs->SemanticPose().Resolve(X, "__model__").empty());
      // Its poses go through text of six digits behind the point or so on their way.
      expect_vec(l.X_ML.p, {X.Pos().X(), X.Pos().Y(), X.Pos().Z()}, 1e-4);
      const ignition::math::Vector3d turned = X.Rot().RotateVector({1, 2, 3});
      expect_vec(rotate(l.X_ML.q, {1, 2, 3}), {turned.X(), turned.Y(), turned.Z()}, 1e-4);
    }
    for (const model::Joint& j : ours.model->joints) {
      const sdf::Joint* const theirs = root.Model()->JointByName(j.name);
      ASSERT_NE(theirs, nullptr);
      ignition::math::Vector3d axis;
      ASSERT_TRUE(theirs->Axis()->ResolveXyz(axis, j.name).empty());
      axis.Normalize();
      expect_vec(j.axis_J, {axis.X(), axis.Y(), axis.Z()}, 1e-4);
    }
  }
}
#endif

}  // namespace
}  // namespace sandlot::formats::urdf_test
