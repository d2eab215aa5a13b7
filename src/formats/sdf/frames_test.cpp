/// Our frames against libsdformat's, on random models: nested models, frames on frames, everything relative to anything.
#ifdef SANDLOT_HAS_SDFORMAT
#include "formats/sdf/frames.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <sdf/sdf.hh>

#include "base/random.h"
#include "formats/sdf/sdf.h"

namespace sandlot::formats {
namespace {

class Writer {
 public:
  explicit Writer(std::uint64_t seed) : random_(seed, 1, Purpose::experiment, 0) {}

  std::string model(const std::string& name, int depth, const std::string& relative_to = "") {
    std::vector<std::string> known;  // what later elements may be relative to
    std::string text;
    const auto any = [&]() -> std::string { return known.empty() ? "" : known[pick(known.size())]; };
    const auto relative = [&](int percent) {
      const bool wanted = percent > static_cast<int>(pick(100));
      const std::string to = wanted ? any() : "";
      return to.empty() ? std::string() : " relative_to='" + to + "'";
    };
    for (int i = 0; i < 3; ++i) {
      const std::string link = "l" + std::to_string(i);
      // One draw per statement: the order within an expression is the compiler's.
      text += "<link name='" + link + "'>";
      text += pose(relative(50));
      text += "<collision name='c'>";
      text += pose(relative(50));
      text += "<geometry><sphere><radius>1</radius></sphere></geometry></collision></link>\n";
      known.push_back(link);
      const std::string frame = "f" + std::to_string(i);
      text += "<frame name='" + frame + "' attached_to='" + any() + "'>";
      text += pose(relative(30));
      text += "</frame>\n";
      known.push_back(frame);
      if (i == 1 && depth > 0) {
        const std::string origin = relative(50);
        text += model("n", depth - 1, origin);
        known.insert(known.end(), {"n", "n::l0", "n::f2", "n::j"});
        if (depth > 1) known.push_back("n::n::l2");
      }
    }
    const std::string child = pick(2) ? "f2" : depth > 0 ? "n::l1" : "l1";
    text += "<joint name='j' type='revolute'><parent>l0</parent><child>" + child + "</child>";
    text += pose(relative(30));
    text += "<axis><xyz expressed_in='" + any() + "'>";
    for (int i = 0; i < 3; ++i) text += number();
    text += "</xyz></axis></joint>\n";
    // A top model is placed in no world here, so it has no placement frame to compare.
    const bool placed = depth < 2 && pick(2) == 0;
    const std::string head = "<model name='" + name + "'" + (placed ? " placement_frame='f1'" : "") + ">";
    return head + pose(relative_to) + "\n" + text + "</model>\n";
  }

 private:
  std::size_t pick(std::size_t n) { return random_.below(static_cast<std::uint32_t>(n)); }
  std::string number() { return std::to_string(random_.uniform(-2, 2)) + " "; }
  std::string pose(const std::string& attribute) {
    std::string text = "<pose" + attribute + ">";
    for (int i = 0; i < 6; ++i) text += number();
    return text + "</pose>";
  }
  Stream random_;
};

/// Beyond what rounding explains: libsdformat keeps a merged model's pose as text of six digits, which moves what is
/// ten metres away by 1e-4 m.
double written_rad = 0;

void expect_same(const Pose& X, const ignition::math::Pose3d& Y) {
  // Some twenty poses of a few metres are chained; each product rounds coordinates below 100 m by 1.4e-14 a few times.
  EXPECT_NEAR(norm(X.p - Vec3{Y.Pos().X(), Y.Pos().Y(), Y.Pos().Z()}), 0, 1e-11 + 20 * written_rad);
  EXPECT_NEAR(std::abs(X.q.w * Y.Rot().W() + X.q.x * Y.Rot().X() + X.q.y * Y.Rot().Y() + X.q.z * Y.Rot().Z()),
              1, 1e-12 + written_rad * written_rad);
}

int compared = 0;

void compare(const model::Model& ours, const sdf::Model& theirs, const std::string& prefix,
             const ignition::math::Pose3d& X_MN) {
  for (std::uint64_t i = 0; i < theirs.LinkCount(); ++i) {
    const sdf::Link& link = *theirs.LinkByIndex(i);
    const auto index = ours.find_link(prefix + link.Name());
    ASSERT_TRUE(index);
    ignition::math::Pose3d X, X_LC;
    ASSERT_TRUE(link.SemanticPose().Resolve(X).empty());
    expect_same(ours.links[*index].X_ML, X_MN * X);
    ASSERT_TRUE(link.CollisionByIndex(0)->SemanticPose().Resolve(X_LC).empty());
    expect_same(ours.links[*index].collisions.at(0).X_LC, X_LC);
    ++compared;
  }
  for (std::uint64_t i = 0; i < theirs.FrameCount(); ++i) {
    const sdf::Frame& frame = *theirs.FrameByIndex(i);
    std::string body;
    ignition::math::Pose3d X;
    ASSERT_TRUE(frame.ResolveAttachedToBody(body).empty());
    ASSERT_TRUE(frame.SemanticPose().Resolve(X, body).empty());
    bool found = false;
    for (const model::Frame& each : ours.frames) {
      if (each.name != prefix + frame.Name()) continue;
      found = true;
      EXPECT_EQ(ours.links[each.link].name, prefix + body);
      expect_same(each.X_LF, X);
    }
    EXPECT_TRUE(found) << frame.Name();
  }
  const sdf::Joint& joint = *theirs.JointByName("j");
  const auto index = ours.find_joint(prefix + "j");
  ASSERT_TRUE(index);
  std::string child;
  ignition::math::Pose3d X;
  ignition::math::Vector3d axis;
  ASSERT_TRUE(joint.ResolveChildLink(child).empty());
  EXPECT_EQ(ours.links[ours.joints[*index].child].name, prefix + child);
  ASSERT_TRUE(joint.SemanticPose().Resolve(X, child).empty());
  expect_same(ours.joints[*index].X_CJ, X);
  ASSERT_TRUE(joint.Axis(0)->ResolveXyz(axis).empty());
  EXPECT_NEAR(norm(ours.joints[*index].axis_J - Vec3{axis.X(), axis.Y(), axis.Z()}), 0,
              1e-12 + 2 * written_rad);
  for (std::uint64_t i = 0; i < theirs.ModelCount(); ++i) {
    ignition::math::Pose3d X_NP;
    ASSERT_TRUE(theirs.ModelByIndex(i)->SemanticPose().Resolve(X_NP).empty());
    compare(ours, *theirs.ModelByIndex(i), prefix + theirs.ModelByIndex(i)->Name() + "::", X_MN * X_NP);
  }
}

TEST(Frames, AgreeWithLibsdformatOnRandomModels) {
  compared = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const std::string text = "<sdf version='1.9'>" + Writer(seed).model("m", 2) + "</sdf>";
    Diagnostics diagnostics;
    const auto ours = parse_sdf(text, "f.sdf", diagnostics);
    sdf::Root theirs;
    const sdf::Errors errors = theirs.LoadSdfString(text);
    if (!ours || !errors.empty()) {
      // A random child may be the link that is the parent; then both refuse.
      EXPECT_FALSE(ours) << errors.front().Message() << "\n" << text;
      EXPECT_TRUE(ours || ours.error().what.find("to itself") != std::string::npos)
          << ours.error().text() << "\n"
          << text;
      continue;
    }
    compare(*ours->instances[0].model, *theirs.Model(), "", {});
  }
  EXPECT_GE(compared, 5 * 9) << "nine links per model; most seeds must give a valid one";
}

/// A random model merged into another, by its own frame or by one in it.
TEST(Frames, MergedIncludesAgreeWithLibsdformat) {
  compared = 0;
  written_rad = 1e-5;
  const std::string file = testing::TempDir() + "sandlot_merged.sdf";
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    std::ofstream(file) << "<sdf version='1.9'>" + Writer(seed).model("inner", 1) + "</sdf>";
    const std::string text =
        "<sdf version='1.9'><model name='m'><link name='base'><pose>1 2 3 0.1 0.2 0.3</pose>"
        "<collision name='c'><geometry><sphere><radius>1</radius></sphere></geometry></collision></link>"
        "<include merge='true'><uri>file://" +
        file + "</uri><pose relative_to='base'>3 1 2 0.5 -0.4 2</pose>" +
        (seed % 2 ? "<placement_frame>f1</placement_frame>" : "") + "</include></model></sdf>";
    Diagnostics diagnostics;
    const auto ours = parse_sdf(text, "/f.sdf", diagnostics);
    sdf::Root theirs;
    const sdf::Errors errors = theirs.LoadSdfString(text);
    if (!ours || !errors.empty()) {
      EXPECT_FALSE(ours) << errors.front().Message();
      EXPECT_TRUE(ours || ours.error().what.find("to itself") != std::string::npos) << ours.error().text();
      continue;
    }
    compare(*ours->instances[0].model, *theirs.Model(), "", {});
  }
  std::filesystem::remove(file);
  written_rad = 0;
  EXPECT_GE(compared, 3 * 7) << "seven links per model; most seeds must give a valid one";
}

TEST(Frames, LongChainsAreFollowedWithoutRecursion) {
  constexpr int n = 20'000;
  std::string text = "<sdf version='1.9'><model name='m'><static>1</static>";
  for (int i = n; i > 0; --i)
    text += "<frame name='f" + std::to_string(i) + "' attached_to='f" + std::to_string(i - 1) +
            "'><pose>0.5 0 0 0 0 0</pose></frame>\n";
  text += "<link name='f0'/><link name='end'><pose relative_to='f" + std::to_string(n) +
          "'/></link></model></sdf>";
  Diagnostics diagnostics;
  const auto result = parse_sdf(text, "f.sdf", diagnostics);
  ASSERT_TRUE(result) << result.error().text();
  EXPECT_EQ(result->instances[0].model->links[1].X_ML.p.x, 0.5 * n);
  EXPECT_EQ(result->instances[0].model->frames.size(), static_cast<std::size_t>(n));
}

}  // namespace
}  // namespace sandlot::formats
#endif
