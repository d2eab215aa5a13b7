/// <sandlot:rollers> and <sandlot:barrel>: read, written and read again, and what is wrong with them.
#include <gtest/gtest.h>

#include "base/math.h"
#include "formats/sdf/sdf.h"
#include "formats/sdf/write.h"

namespace sandlot::formats {
namespace {

Result<WorldContent> parse_rollers(const std::string& text, Diagnostics& diagnostics) {
  return parse_sdf(text, "f.sdf", diagnostics, {});
}
constexpr const char* inertial =
    "<inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>";
std::string robot(const std::string& rollers) {
  return "<sdf version='1.9' xmlns:sandlot='urn:sandlot:sdf'><model name='m'><link name='base'>" +
         std::string(inertial) + "</link>\n<link name='wheel'>" + inertial +
         "<collision name='c'><geometry><sandlot:barrel><radius>0.03</radius>"
         "<profile>0.1</profile><length>0.02</length></sandlot:barrel></geometry></collision></link>\n"
         "<joint name='axle' type='continuous'><parent>base</parent><child>wheel</child>\n"
         "<axis><xyz>0 0 1</xyz></axis>\n" +
         rollers + "</joint></model></sdf>";
}
constexpr const char* good =
    "<sandlot:rollers><radius>0.05</radius><count>9</count><angle degrees='true'>-45</angle>\n"
    "<roller_radius>0.01</roller_radius><roller_length>0.04</roller_length><roller_mass>0.02</roller_mass>\n"
    "<bearing_friction>1e-4</bearing_friction>"
    "<surface><friction><ode><mu>0.7</mu></ode></friction></surface></sandlot:rollers>";

TEST(SdfRollers, AreReadAndWrittenWithoutDoublingThem) {
  Diagnostics diagnostics;
  const auto content = parse_rollers(robot(good), diagnostics);
  ASSERT_TRUE(content) << content.error().text();
  EXPECT_TRUE(diagnostics.warnings.empty()) << diagnostics.warnings.front().text();
  const model::Model& m = *content->instances.at(0).model;
  ASSERT_EQ(m.links.size(), 11u);
  EXPECT_EQ(std::get<Barrel>(m.links[1].collisions.at(0).shape).profile_m, 0.1);
  const model::RollerWheel& w = *m.joints.at(0).rollers;
  EXPECT_EQ(w.count, 9);
  EXPECT_NEAR(w.angle_rad, -math::pi / 4, 1e-15);
  EXPECT_EQ(w.bearing_friction_Nm, 1e-4);
  EXPECT_EQ(w.surface.mu, 0.7);
  EXPECT_EQ(m.links[2].inertial.mass_kg, 0.02);
  EXPECT_EQ(m.joints[1].friction, 1e-4);

  auto xml = sdf_of(content->instances[0], diagnostics);
  ASSERT_TRUE(xml);
  const std::string text = xml_text(*xml, "");
  EXPECT_EQ(text.find("wheel_roller_0"), std::string::npos);
  const auto again = parse_rollers(text, diagnostics);
  ASSERT_TRUE(again) << again.error().text() << text;
  const model::Model& n = *again->instances.at(0).model;
  ASSERT_EQ(n.links.size(), m.links.size());
  for (std::size_t l = 0; l < m.links.size(); ++l) EXPECT_EQ(n.links[l].X_ML, m.links[l].X_ML) << l;
  EXPECT_EQ(n.joints.at(0).rollers->angle_rad, w.angle_rad);
  EXPECT_EQ(n.joints.at(0).rollers->surface.mu, 0.7);
}

TEST(SdfRollers, FaultsNameTheirLine) {
  const auto error = [](const std::string& rollers) {
    Diagnostics diagnostics;
    const auto content = parse_rollers(robot(rollers), diagnostics);
    return content ? std::string("none") : content.error().text();
  };
  const auto changed = [](std::string from, std::string to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const std::pair<const char*, std::string> cases[] = {
      {"f.sdf:5", error(changed("<count>9</count>", "<count>1</count>"))},
      {"a whole number", error(changed("<count>9</count>", "<count>2.5</count>"))},
      {"has no <count>", error(changed("<count>9</count>", ""))},
      {"f.sdf:5", error(changed("<radius>0.05</radius>", "<radius>0</radius>"))},
      {"overlap", error(changed("<count>9</count>", "<count>40</count>"))},
      {"could not be driven", error(changed("-45", "0"))},
      {"has no <diameter>", error(changed("<roller_radius>0.01</roller_radius>", "<diameter>1</diameter>"))},
  };
  for (const auto& [says, said] : cases) {
    EXPECT_NE(said.find(says), std::string::npos) << said;
    EXPECT_EQ(said.rfind("f.sdf:", 0), 0u) << said;
  }
  Diagnostics diagnostics;
  std::string barrel = robot("");
  barrel.replace(barrel.find("<profile>0.1"), 12, "<profile>0.005");
  const auto wrong = parse_rollers(barrel, diagnostics);
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text().find("no such arc"), std::string::npos) << wrong.error().text();
}

}  // namespace
}  // namespace sandlot::formats
