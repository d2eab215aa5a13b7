/// Findings of `check`. Each file of tests/suspicious begins with all that it expects
/// (base/test_expectations.h), or with `expect: nothing` in the twins named *_not, which lie just on the
/// other side of a rule's bound.
#include "sim/lint/lint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/test_expectations.h"
#include "command.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "sim/load/load.h"
#include "sim/test_world.h"

namespace sandlot {
namespace {

using test::Expectation;
using test::expectations_in;
using test::files_in;

std::vector<Finding> findings_of(const std::string& file) {
  Diagnostics diagnostics;
  auto setup = load(file, {}, diagnostics);
  if (!setup) {
    ADD_FAILURE() << setup.error().text();
    return {};
  }
  for (const Error& warning : diagnostics.warnings) ADD_FAILURE() << warning.text();
  const auto simulation = test::build(std::move(*setup));
  if (!simulation) return {};
  std::vector<Finding> findings = lint(*simulation);
  if (file.ends_with(".yaml"))
    for (Finding& finding : lint(*formats::read_scenario(file, {}, diagnostics)))
      findings.push_back(std::move(finding));
  return findings;
}

TEST(Lint, SuspiciousFilesAreToldWhatIsExpectedAndNothingElse) {
  const std::vector<std::string> files = files_in("tests/suspicious");
  ASSERT_GE(files.size(), 50u);
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    std::vector<Expectation> expected = expectations_in(file);
    ASSERT_FALSE(expected.empty()) << "the file does not say what it expects";
    if (expected[0].words == "nothing") expected.clear();
    EXPECT_EQ(expected.empty(), file.find("_not.") != std::string::npos);
    const std::vector<Finding> findings = findings_of(file);
    for (const Finding& finding : findings) {
      const auto found = std::find_if(expected.begin(), expected.end(), [&](const Expectation& e) {
        const std::string text = finding.text.what + "; " + finding.text.fix;
        return e.line == finding.text.place.line && text.find(e.words) != std::string::npos;
      });
      EXPECT_FALSE(finding.text.fix.empty()) << finding.text.text();
      EXPECT_FALSE(finding.rule.empty());
      if (found == expected.end()) ADD_FAILURE() << "not expected: " << finding.text.text();
      else expected.erase(found);
    }
    for (const Expectation& missing : expected) ADD_FAILURE() << "missing: " << missing.words;
  }
}

TEST(Lint, OurOwnScenariosAndModelsHaveNothingSuspicious) {
  std::vector<std::string> files;
  for (const std::string& file : files_in("scenarios")) files.push_back(file);
  for (const std::string& file : files_in("worlds"))
    if (file.ends_with(".sdf")) files.push_back(file);
  for (const auto& folder : std::filesystem::directory_iterator("models"))
    if (std::filesystem::exists(folder.path() / "model.sdf"))
      files.push_back((folder.path() / "model.sdf").string());
  int checked = 0;
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    if (!file.ends_with(".yaml") && !file.ends_with(".sdf") && !file.ends_with(".sim")) continue;
    // Whether they load without a warning is content_test's affair.
    Diagnostics diagnostics;
    auto setup = load(file, {}, diagnostics);
    if (!setup) continue;
    const auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
    if (!simulation) continue;
    ++checked;
    for (const Finding& finding : lint(**simulation)) {
      // The layers of the pile are meant to tumble, and some boxes start up to 32 mm within each other.
      if (file.find("/pile.") != std::string::npos && finding.rule == "overlap") continue;
      ADD_FAILURE() << finding.text.text();
    }
  }
  EXPECT_GE(checked, 6);
}

/// A world without files: one static thing and one that moves.
model::Setup setup_with(Shape ground, Shape thing, Vec3 at) {
  model::Setup setup;
  setup.name = "w";
  const auto add = [&](const char* name, Shape shape, bool is_static, Vec3 p) {
    auto model = std::make_shared<model::Model>();
    model->name = name;
    model->is_static = is_static;
    model::Link link;
    link.name = "link";
    link.inertial.mass_kg = 1000 * volume_m3(shape);
    if (!is_static) link.inertial.moments = inertia_kg_m2(shape, link.inertial.mass_kg);
    link.collisions.push_back({"c", {}, shape, {}, {}});
    model->links.push_back(link);
    model::Instance instance;
    instance.name = instance.original_name = name;
    instance.model = model;
    instance.X_WM.p = p;
    setup.instances.push_back(instance);
  };
  add("ground", std::move(ground), true, {});
  add("thing", std::move(thing), false, at);
  return setup;
}

TEST(Lint, ManyAlikeAreSaidOnceAndManyDifferentOnesAreCounted) {
  // 14 boxes in the floor: ten lines, then the number of the others.
  model::Setup setup = setup_with(Plane{{0, 0, 1}}, Box{{0.2, 0.2, 0.2}}, {0, 0, 0.05});
  const model::Instance pattern = setup.instances.back();
  for (int i = 1; i < 14; ++i) {
    model::Instance another = pattern;
    another.name = another.original_name = "thing" + std::to_string(i);
    another.X_WM.p.x = i;
    setup.instances.push_back(another);
  }
  const auto simulation = test::build(setup);
  ASSERT_TRUE(simulation);
  std::vector<Finding> findings = lint(*simulation);
  ASSERT_EQ(findings.size(), 11u);
  EXPECT_EQ(findings[0].text.what, "'thing' starts 50 mm inside 'ground'");
  EXPECT_EQ(findings[10].text.what, "4 more of the kind 'overlap' are not shown");
  // Their mass is a slip of the model they share.
  auto heavy = std::make_shared<model::Model>(*pattern.model);
  heavy->links[0].inertial.mass_kg = 1e6;
  heavy->links[0].inertial.moments = 1e5 * Vec3{1, 1, 1} / 15;
  for (model::Instance& instance : setup.instances)
    if (!instance.model->is_static) instance.model = heavy, instance.X_WM.p.z = 0.1;
  const auto heavies = test::build(setup);
  ASSERT_TRUE(heavies);
  findings = lint(*heavies);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].rule, "density");
}

TEST(Lint, AShellMayBeAsLightAsItLikes) {
  // 0.3 kg on a ball of 0.52 m^3: 2/3 m r^2 says that all of it lies outside, 2/5 m r^2 that it is a solid.
  for (const bool hollow : {true, false}) {
    model::Setup setup = setup_with(Plane{{0, 0, 1}}, Sphere{0.5}, {0, 0, 0.5});
    auto ball = std::make_shared<model::Model>(*setup.instances.back().model);
    ball->links[0].inertial.mass_kg = 0.3;
    ball->links[0].inertial.moments = (hollow ? 2.0 / 3 : 2.0 / 5) * 0.3 * 0.25 * Vec3{1, 1, 1};
    setup.instances.back().model = ball;
    const auto simulation = test::build(setup);
    ASSERT_TRUE(simulation);
    const std::vector<Finding> findings = lint(*simulation);
    ASSERT_EQ(findings.size(), hollow ? 0u : 1u);
    for (const Finding& finding : findings) EXPECT_EQ(finding.rule, "density");
  }
}

TEST(Lint, TheCommandCountsWarningsAsFailuresWhenItIsStrict) {
  using test::sandlot;
  const std::string file = "tests/suspicious/overlap_ground.sdf";
  const auto lenient = sandlot("check " + file);
  EXPECT_EQ(lenient.exit_code, 0) << lenient.out;
  EXPECT_NE(lenient.out.find("warning: " + file + ":5: 'thing' starts 3 mm inside 'ground'"),
            std::string::npos)
      << lenient.out;
  EXPECT_NE(lenient.out.find("[overlap]"), std::string::npos);
  EXPECT_NE(lenient.out.find("ok, 2 things, 1 warning\n"), std::string::npos);
  EXPECT_EQ(sandlot("check --strict " + file).exit_code, 2);
  EXPECT_EQ(sandlot("check --strict tests/suspicious/overlap_ground_not.sdf").exit_code, 0);
  const auto json = nlohmann::json::parse(sandlot("check --json " + file).out);
  ASSERT_EQ(json.size(), 1u);
  EXPECT_EQ(json[0]["severity"], "warning");
  EXPECT_EQ(json[0]["rule"], "overlap");
  EXPECT_EQ(json[0]["line"], 5);
  EXPECT_EQ(json[0]["file"], file);
  EXPECT_NE(json[0]["fix"].get<std::string>().find("[0, 0, 0.003]"), std::string::npos);
}

/// Every faulty file, through the command: exit code, line and words.
TEST(Lint, FaultyFilesEndTheCheckWithTwoAndTheirLine) {
  std::vector<std::string> files = files_in("tests/bad");
  for (const std::string& file : files_in("tests/bad/build")) files.push_back(file);
  ASSERT_GE(files.size(), 90u);
  for (const std::string& file : files) {
    const bool ours = file.ends_with(".sdf") || file.ends_with(".yaml");
    if (!ours) continue;
    SCOPED_TRACE(file);
    const std::vector<Expectation> expected = expectations_in(file);
    ASSERT_EQ(expected.size(), 1u);
    const test::Printed printed = test::sandlot("check --json " + file + " 2>/dev/null");
    EXPECT_EQ(printed.exit_code, 2);
    const auto json = nlohmann::json::parse(printed.out, nullptr, false);
    ASSERT_TRUE(json.is_array() && !json.empty()) << printed.out;
    int errors = 0;
    for (const auto& entry : json) {
      if (entry["severity"] != "error") continue;
      ++errors;
      const std::string path = entry["path"], what = entry["what"], fix = entry["fix"];
      const std::string text = (path.empty() ? "" : path + ": ") + what + (fix.empty() ? "" : "; " + fix);
      EXPECT_NE(text.find(expected[0].words), std::string::npos) << text;
      EXPECT_EQ(entry["file"], file);
      if (expected[0].line > 0) { EXPECT_EQ(entry["line"], expected[0].line) << text; }
    }
    EXPECT_EQ(errors, 1);
  }
}

}  // namespace
}  // namespace sandlot
