/// Reading of the parts of a document, each result worked out by hand.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "base/math.h"
#include "formats/sdf/sdf.h"

namespace sandlot::formats::reading_test {
namespace {

struct Read {
  std::optional<WorldContent> content;
  std::string error;
  std::vector<std::string> warnings;

  const model::Model& model() const { return *content->instances.at(0).model; }
};

Read parse(const std::string& text, const SdfOptions& options = {}) {
  Diagnostics diagnostics;
  auto result = parse_sdf(text, "f.sdf", diagnostics, options);
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
std::string link(const std::string& name, const std::string& content = "") {
  return "<link name='" + name +
         "'><inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>" +
         content + "</link>";
}
std::string joint(const std::string& name, const std::string& type, const std::string& content) {
  return "<joint name='" + name + "' type='" + type + "'><parent>a</parent><child>b</child>" + content +
         "</joint>";
}
std::string box(const std::string& name, const std::string& size, const std::string& content = "") {
  return "<collision name='" + name + "'>" + content + "<geometry><box><size>" + size +
         "</size></box></geometry></collision>";
}

void expect_near(Vec3 a, Vec3 b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(SdfInertia, OfTwoBoxesByHand) {
  // Two cubes of 1 m and 1 t each, 1 m left and right of the middle: m/6 each about their own axes, and m 1^2 more
  // about the two axes that they are away from.
  const Read r = parse(model("<link name='l'>" + box("p", "1 1 1", "<pose>0 1 0 0 0 0.5</pose>") +
                             box("q", "1 1 1", "<pose>0 -1 0 0.3 0 0</pose>") + "</link>"));
  ASSERT_TRUE(r.content) << r.error;
  const model::Inertial& i = r.model().links[0].inertial;
  EXPECT_NEAR(i.mass_kg, 2000, 1e-9);
  expect_near(i.X_LCo.p, {});
  expect_near(i.moments, {2000.0 / 6 + 2000, 2000.0 / 6, 2000.0 / 6 + 2000}, 1e-9);
  expect_near(i.products, {}, 1e-9);
  EXPECT_EQ(r.warnings,
            std::vector<std::string>{
                "f.sdf:2: link 'l' has no <inertial>; taken as solid, of the density of water: 2000 kg"});
}

TEST(SdfInertia, OfDensitiesThatTheFileGives) {
  // A 1 x 2 x 3 box turned by a quarter about z, of 600 kg: its x and y change places. The second weighs 400 kg, so
  // the middle lies at 0.4 of the 10 m between them.
  const Read r = parse(model("<link name='l'><inertial auto='true'><density>100</density></inertial>" +
                             box("p", "1 2 3", "<pose degrees='true'>0 0 0 0 0 90</pose>") +
                             box("q", "1 1 1", "<pose>10 0 0 0 0 0</pose><density>400</density>") +
                             "</link>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  const model::Inertial& i = r.model().links[0].inertial;
  EXPECT_NEAR(i.mass_kg, 1000, 1e-9);
  expect_near(i.X_LCo.p, {4, 0, 0});
  const double apart = 600 * 16.0 + 400 * 36.0;
  expect_near(i.moments,
              {600.0 / 12 * (1 + 9) + 400.0 / 6, 600.0 / 12 * (4 + 9) + 400.0 / 6 + apart,
               600.0 / 12 * (1 + 4) + 400.0 / 6 + apart},
              1e-8);
}

TEST(SdfInertia, OfAConeHasItsCentreBelowTheMiddle) {
  const Read r = parse(model(
      "<link name='l'><inertial auto='true'/><collision name='c'><pose>0 0 0 3.141592653589793 0 0</pose>"
      "<geometry><cone><radius>1</radius><length>4</length></cone></geometry></collision></link>"));
  ASSERT_TRUE(r.content) << r.error;
  const model::Inertial& i = r.model().links[0].inertial;
  EXPECT_NEAR(i.mass_kg, 1000 * math::pi * 4 / 3, 1e-9);
  expect_near(i.X_LCo.p, {0, 0, 1});  // a quarter of 4 m, upside down
  EXPECT_NEAR(i.moments.z, 0.3 * i.mass_kg, 1e-9);
}

TEST(SdfJoints, TakeAnyNumberBeyondAllBoundsForNoLimit) {
  const std::string limits[] = {"-1.79769e+308 1.79769e+308", "-inf inf", "-1e308 1e308", "-1e16 1e16"};
  for (const std::string& pair : limits) {
    const std::size_t gap = pair.find(' ');
    const Read r = parse(model(link("a") + link("b") +
                               joint("j", "revolute",
                                     "<axis><limit><lower>" + pair.substr(0, gap) + "</lower><upper>" +
                                         pair.substr(gap) + "</upper><effort>" + pair.substr(gap) +
                                         "</effort><velocity>-1</velocity></limit></axis>")));
    ASSERT_TRUE(r.content) << r.error;
    const model::Joint& j = r.model().joints[0];
    EXPECT_EQ(j.lower, -1e16);
    EXPECT_EQ(j.upper, 1e16);
    EXPECT_EQ(j.max_effort, 1e16);
    EXPECT_EQ(j.max_velocity, 1e16);
  }
}

TEST(SdfJoints, WithTwoAxesOrAThread) {
  for (const char* const type : {"universal", "revolute2"}) {
    const Read r = parse(
        model(link("a") + link("b", "<pose degrees='true'>0 0 0 0 0 90</pose>") +
              joint("j", type,
                    "<axis><xyz>1 0 0</xyz><dynamics><damping>3</damping></dynamics></axis><axis2><xyz "
                    "expressed_in='__model__'>2 0 0</xyz><limit><lower>-0.5</lower><upper>1</upper></limit>"
                    "<dynamics><friction>4</friction></dynamics></axis2>")));
    ASSERT_TRUE(r.content) << r.error;
    const model::Joint& j = r.model().joints[0];
    EXPECT_EQ(j.type, model::JointType::universal);
    EXPECT_EQ(j.damping, 3);
    ASSERT_TRUE(j.second);
    expect_near(j.second->axis_J, {0, -1, 0});  // the model's x, seen from a link that looks along y
    EXPECT_EQ(j.second->lower, -0.5);
    EXPECT_EQ(j.second->upper, 1);
    EXPECT_EQ(j.second->friction, 4);
  }
  const auto screw = [](const std::string& pitch) {
    const Read r = parse(model(link("a") + link("b") + joint("j", "screw", "<axis/>" + pitch)));
    EXPECT_TRUE(r.content) << r.error;
    return r.content ? r.model().joints[0].thread_pitch_m : 0;
  };
  EXPECT_EQ(screw("<screw_thread_pitch>0.25</screw_thread_pitch>"), 0.25);
  EXPECT_NEAR(screw("<thread_pitch>-6.283185307179586</thread_pitch>"), 1, 1e-15);
}

TEST(SdfJoints, FollowOthersOrAreLeftOut) {
  const Read r = parse(
      model(link("a") + link("b") + link("c") + "<model name='n'>" + link("a") + link("b") +
            joint("f", "revolute",
                  "<axis><mimic joint='g'><multiplier>-2</multiplier><offset>0.5</offset>"
                  "<reference>0.25</reference></mimic></axis>") +
            "<joint name='g' type='prismatic'><parent>world</parent><child>a</child><axis/></joint></model>" +
            joint("box", "gearbox", "<axis/><gearbox_ratio>2</gearbox_ratio>")));
  ASSERT_TRUE(r.content) << r.error;
  const model::Model& m = r.model();
  ASSERT_EQ(m.joints.size(), 2u);
  ASSERT_TRUE(m.joints[0].mimic);
  EXPECT_EQ(m.joints[m.joints[0].mimic->joint].name, "n::g");
  EXPECT_EQ(m.joints[0].mimic->multiplier, -2);
  EXPECT_EQ(m.joints[0].mimic->offset, 0.5);
  EXPECT_EQ(m.joints[0].mimic->reference, 0.25);
  ASSERT_EQ(r.warnings.size(), 1u);
  EXPECT_NE(r.warnings[0].find("joint 'box' is a gearbox"), std::string::npos);
}

TEST(SdfJoints, OfTheWorldBelongToTheModelOfTheirChild) {
  const Read r = parse(world("<model name='m'><pose>5 0 0 0 0 0</pose>" + link("a") + "<model name='n'>" +
                             link("b", "<pose>0 0 2 0 0 0</pose>") + "</model></model>" +
                             "<frame name='hook'><pose>5 0 3 0 0 0</pose></frame>" +
                             "<joint name='hang' type='ball'><pose relative_to='hook'/><parent>world</parent>"
                             "<child>m::n::b</child></joint>"
                             "<joint name='in' type='fixed'><parent>m</parent><child>m::n</child></joint>"));
  ASSERT_TRUE(r.content) << r.error;
  ASSERT_EQ(r.model().joints.size(), 2u);
  EXPECT_EQ(r.model().joints[0].parent, model::world_link);
  EXPECT_EQ(r.model().joints[0].child, 1u);
  expect_near(r.model().joints[0].X_CJ.p, {0, 0, 1});
  EXPECT_EQ(r.model().joints[1].parent, 0u) << "a model stands for its first link";
}

TEST(SdfJoints, OfTheWorldMayHaveTheNameOfOneInAModel) {
  const std::string fixed = "<joint name='j' type='fixed'><parent>world</parent><child>";
  const Read r = parse(world("<model name='m'>" + link("a") + link("b") + fixed +
                             "a</child></joint></model>" + fixed + "m::b</child></joint>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_EQ(r.model().joints.at(0).name, "j");
  EXPECT_EQ(r.model().joints.at(1).name, "world::j");
}

TEST(SdfNames, WithColonsOfFlattenedFilesAreKept) {
  const Read r = parse(
      "<sdf version='1.7'><world name='w'><model name='old::robot'>" + link("arm::upper") +
      "<frame name='arm::__model__' attached_to='arm::upper'><pose>1 0 0 0 0 0</pose></frame>" +
      link("hand", "<pose relative_to='arm::__model__'>0 2 0 0 0 0</pose>") +
      "<joint name='arm::wrist' type='fixed'><parent>arm::upper</parent><child>hand</child></joint>"
      "<model name='tool'>" +
      link("hand") + "</model></model></world></sdf>");
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_EQ(r.content->instances[0].original_name, "old::robot");
  EXPECT_EQ(r.content->instances[0].name.find(':'), std::string::npos);
  const model::Model& m = r.model();
  EXPECT_EQ(m.links[0].name, "arm::upper");
  expect_near(m.links[1].X_ML.p, {1, 2, 0});
  EXPECT_EQ(m.joints[0].parent, 0u);
}

TEST(SdfNames, LinkAndJointMayShareOne) {
  const Read r = parse(model(link("a") +
                             "<joint name='b' type='fixed'><parent>a</parent><child>b</child></joint>" +
                             link("b", "<pose>0 0 4 0 0 0</pose>") + "<frame name='f' attached_to='b'/>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_EQ(r.model().joints.at(0).name, "b");
  EXPECT_EQ(r.model().frames.at(0).link, 1u);
}

TEST(SdfLook, LightsWithAllTheirNumbers) {
  const Read r = parse(world(
      "<frame name='mast'><pose>0 0 8 0 0 0</pose></frame>"
      "<light name='s' type='spot'><pose relative_to='mast'>1 0 0 0 0 0</pose><diffuse>1 0.5 0.25</diffuse>"
      "<specular>0.5 0.5 0.5 1</specular><intensity>2</intensity><cast_shadows>1</cast_shadows>"
      "<attenuation><range>1e308</range><constant>0.5</constant><linear>0.25</linear><quadratic>0.125"
      "</quadratic></attenuation><spot><inner_angle>0.1</inner_angle><outer_angle>0.6</outer_angle>"
      "<falloff>0.8</falloff></spot></light>"
      "<light name='off' type='point'><light_on>false</light_on></light><model name='m'>" +
      link("l", "<light name='lamp' type='point'><pose>0 0 0.5 0 0 0</pose></light>") + "</model>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  const model::Light& s = r.content->lights.at(0);
  expect_near(s.X_PLight.p, {1, 0, 8});
  EXPECT_EQ(s.color, (Color{2, 1, 0.5f, 1}));
  EXPECT_EQ(s.specular, (Color{1, 1, 1, 1}));
  EXPECT_TRUE(s.cast_shadows);
  EXPECT_EQ(s.range_m, 1e6);
  EXPECT_EQ(s.constant, 0.5);
  EXPECT_EQ(s.linear, 0.25);
  EXPECT_EQ(s.quadratic, 0.125);
  EXPECT_EQ(s.inner_rad, 0.1);
  EXPECT_EQ(s.outer_rad, 0.6);
  EXPECT_EQ(s.falloff, 0.8);
  EXPECT_EQ(r.content->lights.at(1).color, (Color{0, 0, 0, 1}));
  ASSERT_EQ(r.model().lights.size(), 1u);
  EXPECT_EQ(r.model().lights[0].light.X_PLight.p.z, 0.5);
}

TEST(SdfLook, MaterialsBecomeColours) {
  const auto material = [](const std::string& content) {
    const Read r = parse(model(link("l",
                                    "<visual name='v'><cast_shadows>0</cast_shadows><geometry><box/>"
                                    "</geometry>" +
                                        content + "</visual>")));
    EXPECT_TRUE(r.content) << r.error;
    return r.content ? r.model().links[0].visuals[0] : model::Visual{};
  };
  EXPECT_TRUE(material("").material.from_mesh);
  EXPECT_FALSE(material("").cast_shadows);
  const model::Material plain =
      material(
          "<material><ambient>0 0 0</ambient><diffuse>0.5 0.25 1 1</diffuse><specular>0.125 0 0</specular>"
          "<emissive>0 0 0.5</emissive><shininess>12</shininess></material>")
          .material;
  EXPECT_EQ(plain.diffuse, (Color{0.5f, 0.25f, 1, 1}));
  EXPECT_EQ(plain.specular, (Color{0.125f, 0, 0, 1}));
  EXPECT_EQ(plain.emissive, (Color{0, 0, 0.5f, 1}));
  EXPECT_EQ(plain.shininess, 12);
  EXPECT_FALSE(plain.from_mesh);
  const auto script = [&](const std::string& name) {
    return material("<material><script><uri>file://x</uri><name>" + name + "</name></script></material>")
        .material;
  };
  EXPECT_EQ(script("Gazebo/Red").diffuse, (Color{1, 0, 0, 1}));
  EXPECT_EQ(script("Gazebo/Grey").diffuse, (Color{0.7f, 0.7f, 0.7f, 1}));
  EXPECT_EQ(script("Gazebo/BlueTransparent").diffuse, (Color{0, 0, 1, 0.5f}));
  EXPECT_TRUE(script("Mine/Own").from_mesh);
}

TEST(SdfWorld, SceneGeographyAndPhysics) {
  const Read r = parse(world(
      "<scene><ambient>0.25 0.5 0.75</ambient><background>1 0 0</background><sky/></scene>"
      "<magnetic_field>1e-5 2e-5 -3e-5</magnetic_field>"
      "<spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>45</latitude_deg>"
      "<longitude_deg>-90</longitude_deg><elevation>100</elevation><heading_deg>180</heading_deg>"
      "</spherical_coordinates><wind><linear_velocity>1 0 0</linear_velocity></wind>"
      "<physics type='ode'><real_time_factor>2</real_time_factor><ode><solver><type>quick</type><iters>70"
      "</iters><sor>1.3</sor></solver><constraints><cfm>0</cfm><erp>0.5</erp></constraints></ode></"
      "physics>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_EQ(r.content->ambient, (Color{0.25f, 0.5f, 0.75f, 1}));
  EXPECT_EQ(r.content->background, (Color{1, 0, 0, 1}));
  EXPECT_EQ(r.content->magnetic_field_T, (Vec3{1e-5, 2e-5, -3e-5}));
  ASSERT_TRUE(r.content->geography);
  EXPECT_NEAR(r.content->geography->latitude_rad, math::pi / 4, 1e-15);
  EXPECT_NEAR(r.content->geography->longitude_rad, -math::pi / 2, 1e-15);
  EXPECT_NEAR(r.content->geography->heading_rad, math::pi, 1e-15);
  EXPECT_EQ(r.content->geography->elevation_m, 100);
  ASSERT_TRUE(r.content->physics.find("quick_iterations"));
  EXPECT_EQ(r.content->physics.find("quick_iterations")->text(), "70");
  EXPECT_EQ(r.content->physics.find("erp")->text(), "0.5");
  EXPECT_EQ(r.content->physics.find("cfm"), nullptr) << "0 means nothing to our solver";
  EXPECT_EQ(r.warnings, std::vector<std::string>{"f.sdf:2: <wind> is not used; the air stands still"});
}

TEST(SdfGeometry, PolylinesBecomeSolids) {
  // A square of 2 m with a hole of 1 m, 3 m high: 9 m^3.
  const auto square = [](double h) {
    const std::string p = std::to_string(h), m = std::to_string(-h);
    return "<polyline><point>" + m + " " + m + "</point><point>" + p + " " + m + "</point><point>" + p + " " +
           p + "</point><point>" + m + " " + p + "</point><height>3</height></polyline>";
  };
  const Read r = parse(model("<link name='l'><inertial auto='true'/><collision name='c'><geometry>" +
                             square(1) + square(0.5) + "</geometry></collision></link>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  EXPECT_NEAR(r.model().links[0].inertial.mass_kg, 9000, 1e-6);
  EXPECT_NEAR(r.model().links[0].inertial.X_LCo.p.z, 1.5, 1e-9);
}

TEST(SdfActors, FollowTheirScript) {
  const Read r = parse(world(R"(<actor name="ann"><pose>10 0 0 0 0 1.5707963267948966</pose>
    <skin><filename>walk.dae</filename></skin><animation name="walk"><filename>walk.dae</filename></animation>
    <script><loop>false</loop><delay_start>3</delay_start><trajectory id="0" type="walk">
      <waypoint><time>1</time><pose>2 0 1 0 0 0</pose></waypoint>
      <waypoint><time>4</time><pose>2 5 1 0 0 0</pose></waypoint></trajectory></script></actor>
    <actor name="ben"><script><auto_start>false</auto_start><trajectory id="0" type="walk">
      <waypoint><time>0</time><pose>1 0 0 0 0 0</pose></waypoint>
      <waypoint><time>4</time><pose>2 0 0 0 0 0</pose></waypoint></trajectory></script>)" +
                             link("body", box("c", "1 1 1")) + "</actor>"));
  ASSERT_TRUE(r.content) << r.error;
  EXPECT_TRUE(r.warnings.empty()) << r.warnings.front();
  const model::Instance& ann = r.content->instances.at(0);
  ASSERT_TRUE(ann.motion);
  EXPECT_FALSE(ann.motion->loop);
  EXPECT_EQ(ann.motion->delay_s, 3);
  // It stands at its pose until the first waypoint; ahead of it is the world's y.
  ASSERT_EQ(ann.motion->keys.size(), 3u);
  EXPECT_EQ(ann.motion->keys[0].time_s, 0);
  expect_near(ann.motion->keys[0].X_WM.p, {10, 0, 0});
  EXPECT_EQ(ann.motion->keys[1].time_s, 1);
  expect_near(ann.motion->keys[1].X_WM.p, {10, 2, 1});
  expect_near(ann.motion->keys[2].X_WM.p, {5, 2, 1});
  const model::Collision& body = ann.model->links.at(0).collisions.at(0);
  EXPECT_EQ(std::get<Capsule>(body.shape).radius_m, 0.25);
  EXPECT_EQ(std::get<Capsule>(body.shape).length_m + 2 * 0.25, 1.8);
  EXPECT_EQ(body.X_LC.p.z, -0.1) << "from 1 m below to 0.8 m above the hips";
  const model::Instance& ben = r.content->instances.at(1);
  EXPECT_EQ(ben.motion->keys.size(), 1u);
  expect_near(ben.X_WM.p, {1, 0, 0});
  EXPECT_EQ(ben.model->links.at(0).name, "body");
}

TEST(SdfNotes, FoldWarningsOfOneCause) {
  std::string text;
  for (int i = 0; i < 200; ++i) text += link("l" + std::to_string(i), "<projector/>") + "\n";
  const Read r = parse(model(text + "<link name='x'/>\n<link name='y'/>"));
  EXPECT_EQ(r.warnings,
            (std::vector<std::string>{
                "f.sdf:2: <projector> in <link> is not used (and 199 more like it)",
                "f.sdf:202: link 'x' has no <inertial>; taken as 1 kg with moments of 1 kg m^2 (and 1 more "
                "like it)"}));
}

TEST(SdfVersions, OldOnesAreRewritten) {
  const std::string content = link("a") + link("b", "<pose>0 0 0 0 0 1.5707963267948966</pose>") +
                              joint("j", "revolute", "<axis><xyz>1 0 0</xyz></axis>") +
                              link("c",
                                   "<sensor name='s' type='imu'><imu><noise><type>gaussian</type><rate>"
                                   "<stddev>0.5</stddev></rate></noise></imu></sensor>");
  const Read old = parse("<sdf version='1.4'><model name='m'>" + content + "</model></sdf>");
  ASSERT_TRUE(old.content) << old.error;
  ASSERT_EQ(old.warnings.size(), 1u);
  expect_near(old.model().joints[0].axis_J, {0, -1, 0});
  const Node* const imu = old.model().devices.at(0).config.find("imu");
  const Node* const noise = imu->find("angular_velocity")->find("y")->find("noise");
  EXPECT_EQ(noise->find("@type")->text(), "gaussian");
  EXPECT_EQ(noise->find("stddev")->text(), "0.5");
  const Read then = parse("<sdf version='1.5'><model name='m'>" + content + "</model></sdf>");
  ASSERT_TRUE(then.content) << then.error;
  EXPECT_TRUE(then.warnings.empty());
  expect_near(then.model().joints[0].axis_J, {1, 0, 0});
}

}  // namespace
}  // namespace sandlot::formats::reading_test
