#include "formats/sdf/sdf.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#ifdef SANDLOT_HAS_SDFORMAT
#include <sdf/sdf.hh>
#endif

#include "base/math.h"

namespace sandlot::formats::sdf_test {
namespace {

struct Read {
  std::optional<WorldContent> content;
  std::string error;
  std::vector<std::string> warnings;
};

Read parse(const std::string& text, const XmlLimits& limits = {}) {
  Diagnostics diagnostics;
  auto result = parse_sdf(text, "f.sdf", diagnostics, {.limits = limits});
  Read out;
  if (result) out.content = std::move(*result);
  else out.error = result.error().text();
  for (const Error& warning : diagnostics.warnings) out.warnings.push_back(warning.text());
  return out;
}

std::string world(const std::string& content) {
  return "<sdf version='1.9'><world name='w'>\n" + content + "\n</world></sdf>";
}
std::string model(const std::string& content) {
  return "<sdf version='1.9'><model name='m'>\n" + content + "\n</model></sdf>";
}

constexpr const char* body =
    "<inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz><ixy>0.01</ixy></inertia></"
    "inertial>";
std::string link(const std::string& name, const std::string& content = "") {
  return "<link name='" + name + "'>" + body + content + "</link>";
}

void expect_pose(const Pose& X, Vec3 p, double yaw, double tolerance = 1e-12) {
  EXPECT_NEAR(X.p.x, p.x, tolerance);
  EXPECT_NEAR(X.p.y, p.y, tolerance);
  EXPECT_NEAR(X.p.z, p.z, tolerance);
  EXPECT_NEAR(yaw_of(X.q), yaw, tolerance);
}

TEST(Sdf, ReadsShapesSurfacesAndInertia) {
  const Read r = parse(model(R"(<pose>1 2 3 0 0 1.5</pose><link name="l">
    <pose>0 0 0.5 0 0 0</pose>
    <inertial><pose>0.1 0 0 0 0 0</pose><mass>2</mass>
      <inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz><ixy>0.1</ixy><ixz>0.2</ixz><iyz>0.3</iyz></inertia></inertial>
    <collision name="box"><geometry><box><size>1 2 3</size></box></geometry>
      <surface><friction><ode><mu>0.5</mu><mu2>0.25</mu2><fdir1>0 2 0</fdir1><slip1>0.01</slip1></ode></friction>
        <bounce><restitution_coefficient>0.75</restitution_coefficient><threshold>0.1</threshold></bounce>
        <contact><ode><soft_cfm>0.001</soft_cfm><soft_erp>0.3</soft_erp></ode></contact></surface></collision>
    <collision name="ball"><pose>1 0 0 0 0 0</pose><geometry><sphere><radius>0.5</radius></sphere></geometry>
      <surface><friction><ode><mu>0.3</mu></ode></friction></surface></collision>
    <collision name="can"><geometry><cylinder><radius>0.5</radius><length>2</length></cylinder></geometry></collision>
    <collision name="pill"><geometry><capsule><radius>0.25</radius><length>1.5</length></capsule></geometry></collision>
    <collision name="ground"><geometry><plane><normal>0 3 4</normal><size>9 9</size></plane></geometry></collision>
    <visual name="v"><transparency>0.5</transparency><geometry><box><size>1 1 1</size></box></geometry>
      <material><ambient>1 1 1</ambient><diffuse>0.25 0.5 0.75 0.5</diffuse></material></visual>
    </link>)"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  ASSERT_EQ(r.content->instances.size(), 1u);
  expect_pose(r.content->instances[0].X_WM, {1, 2, 3}, 1.5);
  EXPECT_FALSE(r.content->instances[0].is_robot);
  const model::Link& l = r.content->instances[0].model->links.at(0);
  EXPECT_EQ(l.X_ML.p, (Vec3{0, 0, 0.5}));
  EXPECT_EQ(l.place.line, 2);
  EXPECT_EQ(l.inertial.mass_kg, 2);
  EXPECT_EQ(l.inertial.X_LCo.p.x, 0.1);
  EXPECT_EQ(l.inertial.moments, (Vec3{1, 2, 2.5}));
  EXPECT_EQ(l.inertial.products, (Vec3{0.1, 0.2, 0.3}));
  ASSERT_EQ(l.collisions.size(), 5u);
  EXPECT_EQ(std::get<Box>(l.collisions[0].shape).size_m, (Vec3{1, 2, 3}));
  const model::Surface& s = l.collisions[0].surface;
  EXPECT_EQ(s.mu, 0.5);
  EXPECT_EQ(s.mu2, 0.25);
  EXPECT_EQ(s.fdir1, (Vec3{0, 1, 0}));
  EXPECT_EQ(s.slip1, 0.01);
  EXPECT_EQ(s.restitution, 0.75);
  EXPECT_EQ(s.restitution_threshold_mps, 0.1);
  EXPECT_EQ(s.soft_cfm, 0.001);
  EXPECT_EQ(s.soft_erp, 0.3);
  EXPECT_EQ(std::get<Sphere>(l.collisions[1].shape).radius_m, 0.5);
  EXPECT_EQ(l.collisions[1].X_LC.p.x, 1);
  EXPECT_EQ(l.collisions[1].surface.mu2, 0.3) << "mu alone means both directions";
  EXPECT_EQ(std::get<Cylinder>(l.collisions[2].shape).length_m, 2);
  EXPECT_EQ(std::get<Capsule>(l.collisions[3].shape).length_m, 1.5);
  EXPECT_EQ(std::get<Plane>(l.collisions[4].shape).normal, (Vec3{0, 0.6, 0.8}));
  EXPECT_EQ(l.visuals.at(0).material.diffuse.b, 0.75f);
  EXPECT_EQ(l.visuals.at(0).material.diffuse.a, 0.25f) << "half of what is half transparent";
}

TEST(Sdf, ReadsWhatASurfaceIsMadeOf) {
  const auto collision = [](const std::string& surface) {
    return model(R"(<link name="l"><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy>
<izz>1</izz></inertia></inertial><collision name="c"><geometry><box><size>1 1 1</size></box></geometry><surface>)" +
                 surface + "</surface></collision></link>");
  };
  Read r = parse(collision(R"(<contact><ode><kp>3000</kp><kd>4</kd><max_vel>0.5</max_vel></ode></contact>
    <sandlot:substance>rubber(20)</sandlot:substance>
    <sandlot:skin><axis>0 2 0</axis><ratio>0.1</ratio></sandlot:skin>
    <sandlot:rolling_resistance>0.003</sandlot:rolling_resistance>
    <sandlot:belt_velocity>0.7 0 0</sandlot:belt_velocity><sandlot:no_contact>true</sandlot:no_contact>)"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  const model::Surface& s = r.content->instances[0].model->links[0].collisions[0].surface;
  EXPECT_EQ(s.stiffness_N_per_m, 3000);
  EXPECT_EQ(s.damping_N_s_per_m, 4);
  EXPECT_EQ(s.max_correction_mps, 0.5);
  EXPECT_EQ(s.substance, (model::Substance{3, 0, 20, 0.95}));
  EXPECT_EQ(s.skin->axis, (Vec3{0, 1, 0}));
  EXPECT_EQ(s.skin->ratio, 0.1);
  EXPECT_EQ(s.rolling_resistance_m, 0.003);
  EXPECT_EQ(s.belt_velocity_mps, (Vec3{0.7, 0, 0}));
  EXPECT_FALSE(s.touches);

  r = parse(collision("<contact><ode><kp>1e12</kp><kd>1</kd></ode></contact>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_FALSE(r.content->instances[0].model->links[0].collisions[0].surface.stiffness_N_per_m)
      << "SDF's default means hard";
  r = parse(collision("<sandlot:substance>rubber(60)</sandlot:substance>"));
  ASSERT_TRUE(r.content) << r.error;
  ASSERT_EQ(r.warnings.size(), 1u);
  EXPECT_NE(r.warnings[0].find("rubber(60) is outside"), std::string::npos) << r.warnings[0];

  for (const auto& [surface, message] :
       {std::pair{"<sandlot:substance>wood</sandlot:substance>", "'wood' is not a substance"},
        std::pair{"<sandlot:substance>foam(0)</sandlot:substance>", "no foam(0)"},
        std::pair{"<sandlot:skin><axis>0 0 0</axis><ratio>1</ratio></sandlot:skin>", "no length"},
        std::pair{"<sandlot:skin><axis>1 0 0</axis></sandlot:skin>", "no <ratio>"},
        std::pair{"<sandlot:skin><ratio>-1</ratio></sandlot:skin>", "-1"},
        std::pair{"<sandlot:rolling_resistance>-1</sandlot:rolling_resistance>", "-1"},
        std::pair{"<sandlot:belt_velocity>fast</sandlot:belt_velocity>", "fast"},
        std::pair{"<sandlot:belt>1</sandlot:belt>", "has no <sandlot:belt>"},
        std::pair{"<contact><ode><kp>0</kp></ode></contact>", "stiffness of 0"}}) {
    r = parse(collision(surface));
    ASSERT_FALSE(r.content) << surface;
    EXPECT_NE(r.error.find(message), std::string::npos) << r.error;
    EXPECT_NE(r.error.find(":"), std::string::npos);
  }
}

TEST(Sdf, ReadsJoints) {
  const Read r = parse(model(link("a") + link("b", "<pose>1 0 0 0 0 0</pose>") + link("c") + R"(
    <joint name="hinge" type="revolute"><parent>a</parent><child>b</child><pose>0 0 0.5 0 0 0</pose>
      <axis><xyz>0 2 0</xyz><limit><lower>-1</lower><upper>2</upper><effort>3</effort><velocity>4</velocity></limit>
        <dynamics><damping>0.1</damping><friction>0.2</friction><spring_stiffness>5</spring_stiffness>
          <spring_reference>0.3</spring_reference></dynamics></axis></joint>
    <joint name="wheel" type="continuous"><parent>a</parent><child>c</child>
      <axis><limit><lower>-inf</lower><upper>inf</upper><effort>-1</effort></limit></axis></joint>
    <joint name="mount" type="fixed"><parent>world</parent><child>a</child></joint>)"));
  ASSERT_TRUE(r.content) << r.error;
  const model::Model& m = *r.content->instances[0].model;
  ASSERT_EQ(m.joints.size(), 3u);
  const model::Joint& hinge = m.joints[0];
  EXPECT_EQ(hinge.type, model::JointType::revolute);
  EXPECT_EQ(hinge.parent, 0u);
  EXPECT_EQ(hinge.child, 1u);
  EXPECT_EQ(hinge.X_CJ.p, (Vec3{0, 0, 0.5}));
  EXPECT_EQ(hinge.axis_J, (Vec3{0, 1, 0}));
  EXPECT_EQ(hinge.lower, -1);
  EXPECT_EQ(hinge.upper, 2);
  EXPECT_EQ(hinge.max_effort, 3);
  EXPECT_EQ(hinge.max_velocity, 4);
  EXPECT_EQ(hinge.damping, 0.1);
  EXPECT_EQ(hinge.friction, 0.2);
  EXPECT_EQ(hinge.spring_stiffness, 5);
  EXPECT_EQ(hinge.spring_reference, 0.3);
  EXPECT_EQ(m.joints[1].lower, -1e16);
  EXPECT_EQ(m.joints[1].max_effort, 1e16);
  EXPECT_EQ(m.joints[2].parent, model::world_link);
}

TEST(Sdf, ResolvesFramesByHand) {
  // Link b is 1 m ahead of a frame that is turned left by 90 degrees and 2 m ahead of link a, which is 1 m up:
  // b is at (2, 1, 1) and turned by 90 degrees. The axis y of the model is the axis x of the turned joint.
  const Read r = parse(model("<link name='a'><pose>0 0 1 0 0 0</pose>" + std::string(body) + R"(</link>
    <frame name="f" attached_to="a"><pose degrees="true">2 0 0 0 0 90</pose></frame>
    <link name="b"><pose relative_to="f">1 0 0 0 0 0</pose>)" +
                             body + R"(
      <collision name="c"><pose relative_to="a">2 1 0 0 0 0</pose><geometry><sphere><radius>1</radius></sphere></geometry></collision>
      <sensor name="s" type="no_such_sensor"><pose relative_to="__model__">0 0 0 0 0 0</pose></sensor></link>
    <joint name="j" type="revolute"><parent>a</parent><child>b</child>
      <axis><xyz expressed_in="__model__">0 1 0</xyz></axis></joint>)"));
  ASSERT_TRUE(r.content) << r.error;
  const model::Model& m = *r.content->instances[0].model;
  expect_pose(m.links[1].X_ML, {2, 1, 1}, math::pi / 2);
  expect_pose(m.links[1].collisions[0].X_LC, {0, 0, 0}, -math::pi / 2);
  expect_pose(m.devices.at(0).X_LS, {-1, 2, -1}, -math::pi / 2);
  EXPECT_NEAR(m.joints[0].axis_J.x, 1, 1e-12);
  ASSERT_EQ(m.frames.size(), 1u);
  EXPECT_EQ(m.frames[0].link, 0u);
  expect_pose(m.frames[0].X_LF, {2, 0, 0}, math::pi / 2);
}

TEST(Sdf, FlattensNestedModels) {
  const std::string text = model(
      link("base") + "<model name='arm'><pose>1 0 0 0 0 1.5707963267948966</pose>" +
      "<link name='lower'><pose>1 0 0 0 0 0</pose>" + body + "</link>" + link("upper") +
      "<joint name='elbow' "
      "type='revolute'><parent>lower</parent><child>upper</child><axis/></joint></model>" +
      "<joint name='fix' type='fixed'><parent>base</parent><child>arm::lower</child></joint>");
  const Read r = parse(text);
  ASSERT_TRUE(r.content) << r.error;
  const model::Model& m = *r.content->instances[0].model;
  ASSERT_EQ(m.links.size(), 3u);
  EXPECT_EQ(m.links[1].name, "arm::lower");
  expect_pose(m.links[1].X_ML, {1, 1, 0}, math::pi / 2);
  ASSERT_EQ(m.joints.size(), 2u);
  EXPECT_EQ(m.joints[0].name, "arm::elbow");
  EXPECT_EQ(m.joints[0].parent, 1u);
  EXPECT_EQ(m.joints[1].name, "fix");
  EXPECT_EQ(m.joints[1].child, 1u);
  // The canonical link comes first.
  std::string turned = text;
  turned.replace(turned.find("name='m'"), 8, "name='m' canonical_link='arm::upper'");
  const Read c = parse(turned);
  ASSERT_TRUE(c.content) << c.error;
  EXPECT_EQ(c.content->instances[0].model->links[0].name, "arm::upper");
  EXPECT_EQ(c.content->instances[0].model->joints[0].child, 0u);
}

TEST(Sdf, ReadsWorlds) {
  const Read r = parse(
      world("<gravity>0 0 -1.6</gravity><physics type='ode'><max_step_size>0.002</max_step_size></physics>" +
            std::string("<scene><sky/></scene><plugin name='gz::sim::systems::Physics' filename='x'/>") +
            "<light name='sun' type='directional'><pose>0 0 9 0 0 1.5707963267948966</pose><diffuse>1 0.5 0 "
            "1</diffuse>"
            "<direction>1 0 0</direction></light>"
            "<model name='my robot'><pose>1 0 0 0 0 0</pose>" +
            link("l") +
            "</model>"
            "<model name='wall'><static>true</static><link name='l'/></model>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  EXPECT_EQ(r.content->world_name, "w");
  EXPECT_EQ(r.content->gravity.z, -1.6);
  EXPECT_EQ(r.content->max_step_s, 0.002);
  ASSERT_EQ(r.content->lights.size(), 1u);
  const Vec3 beam = rotate(r.content->lights[0].X_PLight.q, {0, 0, -1});
  EXPECT_NEAR(beam.y, 1, 1e-15) << "the direction is given in the light's frame, which is turned to the left";
  ASSERT_EQ(r.content->instances.size(), 2u);
  EXPECT_EQ(r.content->instances[0].name, "my_robot");
  EXPECT_EQ(r.content->instances[0].original_name, "my robot");
  EXPECT_TRUE(r.content->instances[1].model->is_static);
}

TEST(Sdf, ALabelIsTheModelsAndNoDevice) {
  const std::string label = R"(<plugin name="gz::sim::systems::Label" filename="gz-sim-label-system">)";
  const Read r = parse(
      model("<link name='base'>" + std::string(body) + "</link>" + label + "<label> 40 </label></plugin>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_EQ(r.content->instances[0].model->label, "40");
  EXPECT_TRUE(r.content->instances[0].model->devices.empty());
  EXPECT_FALSE(r.content->instances[0].is_robot);
  EXPECT_NE(parse(model("<link name='base'/>" + label + "</plugin>")).error.find("gives no <label>"),
            std::string::npos);
}

TEST(Sdf, TurnsSensorsAndPluginsIntoDevices) {
  const Read r = parse(model(R"(<link name="base">)" + std::string(body) + R"(
      <sensor name="lidar" type="gpu_lidar"><pose>0.1 0 0.2 0 0 0</pose><always_on>1</always_on><update_rate>10</update_rate>
        <ray><scan><horizontal><samples>181</samples></horizontal></scan><noise type="gaussian"><mean>0</mean></noise></ray>
      </sensor><sensor name="cam" type="camera"/></link>
    <link name="head">)" + body +
                             R"(<sensor name="cam" type="camera"/></link>
    <joint name="neck" type="fixed"><parent>base</parent><child>head</child>
      <sensor name="force" type="force_torque"/></joint>
    <plugin name="gz::sim::systems::DiffDrive" filename="libignition-gazebo-diff-drive-system.so">
      <left_joint>a</left_joint><left_joint>b</left_joint><topic n="1">t</topic></plugin>
    <plugin name="gz::sim::systems::DiffDrive" filename="x"/>
    <sandlot:device name="laser" kind="laser_scanner" link="head"><pose>1 0 0 0 0 0</pose><beams>181</beams>
      <angles>[1, 2]</angles><noise><white>1 cm</white></noise></sandlot:device>)"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_TRUE(r.content->instances[0].is_robot);
  const auto& d = r.content->instances[0].model->devices;
  ASSERT_EQ(d.size(), 7u);
  EXPECT_EQ(d[0].name, "lidar");
  EXPECT_EQ(d[0].kind, "");
  EXPECT_EQ(d[0].sdf_types, std::vector<std::string>{"sensor:gpu_lidar"});
  EXPECT_EQ(d[0].X_LS.p, (Vec3{0.1, 0, 0.2}));
  EXPECT_EQ(d[0].place.line, 3);
  EXPECT_EQ(d[0].config.find("update_rate")->text(), "10");
  EXPECT_EQ(d[0].config.find("@type")->text(), "gpu_lidar");
  EXPECT_EQ(d[0].config.find("ray")->find("scan")->find("horizontal")->find("samples")->text(), "181");
  EXPECT_EQ(d[0].config.find("ray")->find("noise")->find("@type")->text(), "gaussian");
  EXPECT_EQ(d[0].config.find("ray")->place().line, 4);
  EXPECT_EQ(d[1].name, "base_cam");
  EXPECT_EQ(d[2].name, "head_cam");
  EXPECT_EQ(d[2].link, 1u);
  EXPECT_EQ(d[3].name, "force");
  EXPECT_EQ(d[3].link, 1u);
  EXPECT_EQ(d[3].config.find("@joint")->text(), "neck");
  EXPECT_EQ(d[4].name, "diff_drive");
  EXPECT_EQ(d[4].sdf_types,
            (std::vector<std::string>{"plugin:DiffDrive", "plugin:ignition-gazebo-diff-drive-system"}));
  EXPECT_EQ(d[4].config.find("left_joint")->items().at(1).text(), "b");
  EXPECT_EQ(d[4].config.find("topic")->find("#text")->text(), "t");
  EXPECT_EQ(d[5].name, "diff_drive_2");
  EXPECT_EQ(d[6].kind, "laser_scanner");
  EXPECT_EQ(d[6].link, 1u);
  EXPECT_EQ(d[6].X_LS.p.x, 1);
  EXPECT_EQ(d[6].config.find("pose"), nullptr);
  EXPECT_EQ(d[6].config.find("@name"), nullptr);
  EXPECT_EQ(d[6].config.find("beams")->text(), "181");
  EXPECT_EQ(d[6].config.find("angles")->items().at(1).text(), "2");
  EXPECT_EQ(d[6].config.find("noise")->find("white")->text(), "1 cm");
}

TEST(Sdf, GazebosCommunicationIsARadio) {
  const std::string endpoint =
      "<model name='box'>" + link("l") +
      "<plugin filename='gz-sim-comms-endpoint-system' "
      "name='gz::sim::systems::CommsEndpoint'><address>addr1</address></plugin></model>";
  const Read r = parse(
      world("<plugin filename='gz-sim-rf-comms-system' name='gz::sim::systems::RFComms'>"
            "<range_config><max_range>500000.0</max_range><fading_exponent>1.5</fading_exponent>"
            "<l0>42</l0><sigma>9</sigma></range_config>"
            "<radio_config><capacity>1000000</capacity><tx_power>21</tx_power>"
            "<noise_floor>-85</noise_floor><modulation>QPSK</modulation></radio_config></plugin>" +
            endpoint));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  ASSERT_EQ(r.content->media.size(), 1u);
  const model::ElementDecl& medium = r.content->media[0];
  EXPECT_EQ(medium.kind, "radio");
  const auto key = [&](const char* name) { return medium.config.find(name)->text(); };
  EXPECT_EQ(key("model"), "log_distance");
  EXPECT_EQ(std::stod(key("range")), 500000);
  EXPECT_EQ(key("exponent"), "1.5");
  EXPECT_EQ(key("reference_loss"), "42");
  EXPECT_EQ(key("fading"), "3");
  EXPECT_EQ(std::stod(key("bandwidth")), 1e6);
  EXPECT_EQ(key("noise_floor"), "-85");
  EXPECT_EQ(key("modulation"), "qpsk");
  const model::DeviceDecl device = r.content->instances.at(0).devices.at(0);
  EXPECT_EQ(device.kind, "radio");
  EXPECT_EQ(device.config.find("address")->text(), "addr1");
  EXPECT_EQ(device.config.find("power")->text(), "21");
  const Read perfect = parse(world(
      "<plugin filename='gz-sim-perfect-comms-system' name='gz::sim::systems::PerfectComms'/>" + endpoint));
  ASSERT_TRUE(perfect.content) << perfect.error;
  EXPECT_EQ(perfect.content->media.at(0).name, "perfect_comms");
  // What names topics of Gazebo's transport has no effect, and is named where it stands.
  const Read more = parse(
      world("<plugin filename='gz-sim-perfect-comms-system' name='gz::sim::systems::PerfectComms'/><model "
            "name='a'>" +
            link("l") +
            "<plugin filename='gz-sim-comms-endpoint-system' name='gz::sim::systems::CommsEndpoint'>\n"
            "<address>a</address>\n<topic>a/rx</topic>\n"
            "<broker><bind_service>/bind</bind_service></broker></plugin></model>"));
  ASSERT_TRUE(more.content) << more.error;
  ASSERT_EQ(more.warnings.size(), 2u);
  EXPECT_EQ(more.warnings[0],
            "f.sdf:4: <topic> of the plugin CommsEndpoint is not supported and has no effect");
  EXPECT_EQ(more.warnings[1],
            "f.sdf:5: <broker> of the plugin CommsEndpoint is not supported and has no effect");
  EXPECT_EQ(more.content->instances.at(0).devices.at(0).config.find("address")->text(), "a");
  // Without a medium an endpoint stays what it was.
  const Read none = parse(world(endpoint));
  ASSERT_TRUE(none.content) << none.error;
  EXPECT_TRUE(none.content->media.empty());
  EXPECT_EQ(none.content->instances.at(0).devices.at(0).kind, "");
}

TEST(Sdf, NamesWhatIsNotUsedOnce) {
  const Read r = parse(world(
      "<model name='m'>\n<link name='l'>\n<collision "
      "name='c'><geometry>\n<image><uri>x</uri></image></geometry>"
      "</collision><other:thing/>\n<projector/></link></model>\n<road/><plugin name='Magic' filename='f'/>"));
  ASSERT_TRUE(r.content) << r.error;
  const std::vector<std::string> expected = {
      "f.sdf:7: <road> in <world> is not used", "f.sdf:6: <projector> in <link> is not used",
      "f.sdf:5: geometry <image> is not supported; <collision> 'c' is left out",
      "f.sdf:3: link 'l' has no <inertial>; taken as 1 kg with moments of 1 kg m^2",
      "f.sdf:7: plugin 'Magic' of the world is not used"};
  EXPECT_EQ(r.warnings, expected);
}

TEST(Sdf, AMisspeltElementIsAnsweredWithTheNearest) {
  const Read r = parse(
      world("<model name='m'><static>1</static>\n<pse>1 0 0 0 0 0</pse><link name='l'/></model>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_EQ(r.warnings,
            std::vector<std::string>{"f.sdf:3: <pse> in <model> is not used; did you mean <pose>?"});
}

TEST(Sdf, OlderVersionsMeanTheSame) {
  const Read r = parse(
      "<sdf version='1.5'><world name='w'><physics><gravity>0 0 -5</gravity></physics><model name='m'>" +
      link("a", "<pose>0 0 0 0 0 1.5707963267948966</pose>") +
      link("b", "<pose frame='a'>1 0 0 0 0 0</pose>") +
      "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz>"
      "<use_parent_model_frame>1</use_parent_model_frame></axis></joint></model></world></sdf>");
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_EQ(r.content->gravity.z, -5);
  const model::Model& m = *r.content->instances[0].model;
  expect_pose(m.links[1].X_ML, {0, 1, 0}, math::pi / 2);
  EXPECT_NEAR(m.joints[0].axis_J.y, -1, 1e-12) << "the model's x is the turned joint's -y";
  const Read newer = parse("<sdf version='1.11'><model name='m'>" + link("l") + "</model></sdf>");
  ASSERT_TRUE(newer.content) << newer.error;
  EXPECT_EQ(newer.warnings,
            std::vector<std::string>{
                "f.sdf:1: version 1.11 of SDF is newer than 1.9; not all of what it added is understood"});
}

TEST(Sdf, IncludesFilesAndFolders) {
  const std::string folder = testing::TempDir() + "sandlot_sdf/";
  std::filesystem::create_directories(folder + "models/box");
  std::ofstream(folder + "models/box/model.config")
      << "<model><sdf version='1.4'>old.sdf</sdf><sdf version='1.6'>new.sdf</sdf></model>";
  std::ofstream(folder + "models/box/new.sdf") << "<sdf version='1.6'><model name='box'>\n"
                                               << link("l") << "</model></sdf>";
  std::ofstream(folder + "w.sdf")
      << "<sdf version='1.9'><world name='w'>"
         "<include><uri>models/box</uri></include>"
         "<include><uri>file://models/box/new.sdf</uri><name>second</name><pose>1 2 3 0 0 0</pose>"
         "<static>1</static></include>"
         "<include><uri>model://box</uri><name>third</name></include></world></sdf>";
  setenv("SANDLOT_PATH", ("/nowhere:" + folder + "models").c_str(), 1);
  Diagnostics diagnostics;
  const auto r = read_sdf(folder + "w.sdf", diagnostics);
  unsetenv("SANDLOT_PATH");
  ASSERT_TRUE(r) << r.error().text();
  ASSERT_EQ(r->instances.size(), 3u);
  EXPECT_EQ(r->instances[0].name, "box");
  EXPECT_EQ(to_string(r->instances[0].model->links[0].place), folder + "models/box/new.sdf:2");
  EXPECT_EQ(r->instances[1].name, "second");
  EXPECT_EQ(r->instances[1].X_WM.p, (Vec3{1, 2, 3}));
  EXPECT_TRUE(r->instances[1].model->is_static);
  EXPECT_EQ(r->instances[2].name, "third");

  std::ofstream(folder + "a.sdf")
      << "<sdf version='1.9'><model name='a'>\n<include><uri>b.sdf</uri></include></model></sdf>";
  std::ofstream(folder + "b.sdf")
      << "<sdf version='1.9'><model name='b'>\n\n<include><uri>a.sdf</uri></include></model></sdf>";
  const auto loop = read_sdf(folder + "a.sdf", diagnostics);
  ASSERT_FALSE(loop);
  EXPECT_EQ(loop.error().text(), folder + "b.sdf:3: 'a.sdf' includes itself");
  const auto gone = parse_sdf(
      "<sdf version='1.9'><world name='w'><include><uri>model://x</uri></include></world></sdf>", "f.sdf",
      diagnostics);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().text().find("f.sdf:1: 'model://x' is not there; looked for "), 0u);
  EXPECT_NE(gone.error().text().find("--path FOLDER or SANDLOT_PATH"), std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(Sdf, BoundsSizeDepthAndCount) {
  const auto nest = [](int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += "<a>\n";
    for (int i = 0; i < n; ++i) text += "</a>";
    return text;
  };
  EXPECT_EQ(parse(nest(65)).error, "f.sdf:65: nested too deeply; at most 64 levels are allowed");
  EXPECT_NE(parse(nest(1'000'000)).error, "");
  EXPECT_NE(parse(nest(5), {.max_elements = 4}).error.find("f.sdf:5: too many elements"), std::string::npos);
  EXPECT_NE(parse(nest(5), {.max_bytes = 4}).error.find("is too large"), std::string::npos);
  std::string attributes = "<sdf ";
  for (int i = 0; i < 100'000; ++i) attributes += "a" + std::to_string(i) + "='1' ";
  EXPECT_NE(parse(attributes + "/>").error.find("too many attributes"), std::string::npos);
}

#ifdef SANDLOT_HAS_SDFORMAT
/// libsdformat reads the same file its own way; the values must agree.
TEST(Sdf, AgreesWithLibsdformat) {
  const std::string text = model(
      link("a", R"(<pose>1 2 3 0.1 0.2 0.3</pose>
      <collision name="c"><pose>0.1 0.2 0.3 0.4 0.5 0.6</pose><geometry><cylinder><radius>0.3</radius><length>0.7</length></cylinder></geometry></collision>)") +
      R"(<frame name="f"><pose>0 1 0 0.5 0.6 0.7</pose></frame>)" +
      link("b", "<pose relative_to='f'>4 5 6 0.7 0.8 0.9</pose>") +
      R"(<joint name="j" type="revolute"><pose>0.1 0 0 0 0 0.1</pose><parent>a</parent><child>b</child><axis><xyz expressed_in="f">1 2 3</xyz></axis></joint>)");
  const Read ours = parse(text);
  ASSERT_TRUE(ours.content) << ours.error;
  const model::Model& m = *ours.content->instances[0].model;
  sdf::Root root;
  ASSERT_TRUE(root.LoadSdfString(text).empty());
  const auto expect_same = [](const Pose& X, const ignition::math::Pose3d& Y) {
    // Both compose fewer than ten rotations of unit length: 1e-14 is some tens of roundings.
    EXPECT_NEAR(norm(X.p - Vec3{Y.Pos().X(), Y.Pos().Y(), Y.Pos().Z()}), 0, 1e-13);
    EXPECT_NEAR(
        std::abs(X.q.w * Y.Rot().W() + X.q.x * Y.Rot().X() + X.q.y * Y.Rot().Y() + X.q.z * Y.Rot().Z()), 1,
        1e-14);
  };
  for (std::size_t i = 0; i < 2; ++i) {
    const sdf::Link* const theirs = root.Model()->LinkByIndex(i);
    ignition::math::Pose3d X;
    ASSERT_TRUE(theirs->SemanticPose().Resolve(X).empty());
    expect_same(m.links[i].X_ML, X);
    EXPECT_EQ(m.links[i].inertial.mass_kg, theirs->Inertial().MassMatrix().Mass());
    EXPECT_EQ(m.links[i].inertial.moments.y, theirs->Inertial().MassMatrix().Iyy());
    EXPECT_EQ(m.links[i].inertial.products.x, theirs->Inertial().MassMatrix().Ixy());
  }
  expect_same(m.links[0].collisions[0].X_LC, root.Model()->LinkByIndex(0)->CollisionByIndex(0)->RawPose());
  const sdf::Joint* const joint = root.Model()->JointByIndex(0);
  ignition::math::Pose3d X;
  ignition::math::Vector3d axis;
  ASSERT_TRUE(joint->SemanticPose().Resolve(X, "b").empty());
  ASSERT_TRUE(joint->Axis(0)->ResolveXyz(axis).empty());
  expect_same(m.joints[0].X_CJ, X);
  EXPECT_NEAR(norm(m.joints[0].axis_J - Vec3{axis.X(), axis.Y(), axis.Z()}), 0, 1e-14);
}
#endif

}  // namespace
}  // namespace sandlot::formats::sdf_test
