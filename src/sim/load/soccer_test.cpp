/// Fields, goals and balls of robot soccer, as scenarios make them.
#include <gtest/gtest.h>

#include "builders/builder.h"
#include "geometry/mesh.h"
#include "sim/load/load.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"
#include "soccer/field.h"

namespace sandlot {
namespace {

std::unique_ptr<Simulation> soccer_world(const std::string& engine, const std::string& rest) {
  Diagnostics diagnostics;
  LoadOptions options;
  const std::string text = "version: 1\nname: t\nphysics: " + engine + "\ntime: {step: 4 ms, substeps: 2}\n" +
                           rest;
  options.text = text;
  auto setup = load("t.yaml", options, diagnostics);
  EXPECT_TRUE(setup) << setup.error().text();
  return setup ? test::build(std::move(*setup)) : nullptr;
}

Vec3 ball_place(const Simulation& simulation) {
  return simulation.engine().pose(*simulation.find_instance("ball")).p;
}

Result<Built> field(const std::string& words) {
  return build_model(**parse_builder("builder:soccer_field" + words));
}

/// Whether the lines cover a place.
bool white(const Built& built, double x, double y) {
  const auto& visuals = built.model.links[0].visuals;
  const TriangleMesh& lines = *std::get<Mesh>(visuals[1].shape).mesh;
  for (const auto& t : lines.triangles) {
    const auto turn = [&](std::uint32_t from, std::uint32_t to) {
      const Vec3 a = lines.vertices[from], b = lines.vertices[to];
      return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    };
    if (turn(t[0], t[1]) >= 0 && turn(t[1], t[2]) >= 0 && turn(t[2], t[0]) >= 0) return true;
  }
  return false;
}

TEST(SoccerField, HasTheLinesOfTheRuleBookAtTheirOutsides) {
  for (const auto& name : soccer::enum_names(soccer::FieldSize{})) {
    SCOPED_TRACE(name.name);
    const auto built = field("?size=" + std::string(name.name));
    ASSERT_TRUE(built) << built.error().text();
    const soccer::Dimensions d = soccer::dimensions_of(name.value);
    const double x = d.length_m / 2, y = d.width_m / 2, w = d.line_m, e = 0.005;
    const auto edge = [&](double inside_x, double inside_y, double outside_x, double outside_y) {
      EXPECT_TRUE(white(*built, inside_x, inside_y)) << inside_x << " " << inside_y;
      EXPECT_FALSE(white(*built, outside_x, outside_y)) << outside_x << " " << outside_y;
    };
    for (const double side : {1.0, -1.0}) {
      edge(0.7, side * (y - e), 0.7, side * (y + e));
      edge(0.7, side * (y - w + e), 0.7, side * (y - w - e));
      edge(side * (x - e), 0.6, side * (x + e), 0.6);
      edge(side * (w / 2 - e), 3.1, side * (w / 2 + e), 3.1);
      const double penalty = side * (x - d.penalty_area_depth_m), goal = side * (x - d.goal_area_depth_m);
      edge(penalty + side * e, 0.3, penalty - side * e, 0.3);
      edge(penalty + side * (w - e), 0.3, penalty + side * (w + e), 0.3);
      edge(goal + side * e, 0.3, goal - side * e, 0.3);
      const double between = side * (x - d.goal_area_depth_m - 0.2);
      edge(between, d.penalty_area_width_m / 2 - e, between, d.penalty_area_width_m / 2 + e);
      const double near = side * (x - 0.3);
      edge(near, d.goal_area_width_m / 2 - e, near, d.goal_area_width_m / 2 + e);
      const double mark = side * (x - d.penalty_mark_m);
      edge(mark, d.mark_diameter_m / 2 - e, mark, d.mark_diameter_m / 2 + e);
      edge(side * (d.circle_radius_m - e) * 0.8, (d.circle_radius_m - e) * 0.6,
           side * (d.circle_radius_m + e) * 0.8, (d.circle_radius_m + e) * 0.6);
      for (const double other : {1.0, -1.0}) {
        const auto at = [&](double r) { return std::pair(side * (x - 0.8 * r), other * (y - 0.6 * r)); };
        const double r = d.corner_radius_m;
        edge(at(r - e).first, at(r - e).second, at(r + e).first, at(r + e).second);
        edge(at(r - w + e).first, at(r - w + e).second, at(r - w - e).first, at(r - w - e).second);
      }
    }
  }
}

TEST(SoccerField, TakesDimensionsThatAreGivenAndTheOthersFromItsSize) {
  const auto built = field("?size=12x8&penalty_mark=2.5&board=0.2&border=0.5");
  ASSERT_TRUE(built);
  EXPECT_TRUE(white(*built, 6 - 2.5, 0));
  EXPECT_FALSE(white(*built, 6 - 2, 0));
  EXPECT_TRUE(white(*built, 5.99, 0));
  const auto& boards = built->model.links[0].collisions;
  ASSERT_EQ(boards.size(), 4u) << "carpet and lines touch nothing";
  EXPECT_NEAR(boards[1].X_LC.p.x, 6.5 + 0.025, 1e-12);
  EXPECT_NEAR(std::get<Box>(boards[1].shape).size_m.z, 0.2, 1e-12);
  EXPECT_TRUE(field("?board=0")->model.links[0].collisions.empty());
  const auto wide = field("?size=12x8&goal_area_width=9");
  ASSERT_FALSE(wide);
  EXPECT_NE(wide.error().text().find("/goal_area_width: the area is wider than the field"), std::string::npos)
      << wide.error().text();
  EXPECT_FALSE(field("?size=30x20"));
}

/// A goal at x = 11 and the ball of the league, shot.
std::unique_ptr<Simulation> shot(const std::string& engine, Vec3 from, Vec3 velocity) {
  auto simulation = soccer_world(engine,
                                 "things:\n  - {name: field, model: {builder: soccer_field}}\n"
                                 "  - {name: goal, model: {builder: soccer_goal}, pose: [11, 0, 0]}\n"
                                 "  - {name: ball, model: models/msl_ball/model.sdf, pose: [" +
                                     std::to_string(from.x) + ", " + std::to_string(from.y) + ", " +
                                     std::to_string(from.z) + ", 0, 0, 0]}\n");
  if (simulation) simulation->submit(VelocityRequest{"ball", {velocity, {}}});
  return simulation;
}

TEST(SoccerGoal, HoldsWhatIsShotIntoItAndKeepsOutWhatHitsItFromOutside) {
  for (const char* const engine : {"rigid", "planar"}) {
    struct Shot {
      Vec3 from, velocity;
      bool scores;
    };
    const Shot shots[] = {
        {{8, 0, 0}, {10, 0, 0}, true},         {{8, 0.6, 0}, {9.6, 1.5, 0}, true},
        {{8, -1, 0}, {12, 0, 0}, true},        {{11.3, 3, 0}, {0, -10, 0}, false},
        {{11.95, -3, 0}, {-1.3, 8, 0}, false}, {{11.95, 0.3, 0}, {-10, 0, 0}, false},
    };
    for (const Shot& s : shots) {
      const auto simulation = shot(engine, s.from, s.velocity);
      ASSERT_TRUE(simulation);
      bool was_in = false;
      for (int i = 0; i < 100; ++i) {
        test::advance(*simulation, 10);
        const Vec3 p = ball_place(*simulation);
        const bool in = p.x > 11 + 0.11 && p.x < 11.6 && std::abs(p.y) < 1.2 && p.z < 1;
        EXPECT_TRUE(s.scores ? in || !was_in : !in) << engine << ": out again, or through the net " << p.x;
        was_in = was_in || in;
      }
      EXPECT_EQ(was_in, s.scores) << engine << " from " << s.from.x << " " << s.from.y;
    }
  }
}

TEST(SoccerBall, RollsOutAsFarAsItsDeceleration) {
  for (const char* const engine : {"rigid", "planar"}) {
    const auto simulation = soccer_world(
        engine, "things: [{name: ball, model: models/msl_ball/model.sdf, pose: [0, 0, 0]}]\n");
    ASSERT_TRUE(simulation);
    // Rolling from the start: w = v / r about y.
    simulation->submit(VelocityRequest{"ball", {{2, 0, 0}, {0, 2 / 0.11, 0}}});
    const double a = 0.6 * 0.0056 * 9.81 / 0.11;
    EXPECT_NEAR(a, 0.3, 1e-3);
    test::advance(*simulation, static_cast<int>((2 / a + 0.5) / 0.004));
    EXPECT_NEAR(ball_place(*simulation).x, 2 * 2 / (2 * a), 0.02 * 2 * 2 / (2 * a)) << engine;
  }
}

TEST(SoccerBall, BouncesToTheSquareOfItsRestitution) {
  const auto simulation = soccer_world(
      "rigid", "things: [{name: ball, model: models/msl_ball/model.sdf, pose: [0, 0, 1, 0, 0, 0]}]\n");
  ASSERT_TRUE(simulation);
  // The file's pose is added: the ball begins 1 m above the ground.
  double lowest = 2, highest = 0;
  const double start = ball_place(*simulation).z;
  int ticks = 0;
  for (; ticks < 300 && ball_place(*simulation).z <= lowest; ++ticks) {
    lowest = ball_place(*simulation).z;
    test::advance(*simulation, 1);
  }
  for (int i = 0; i < 100; ++i) {
    highest = std::max(highest, ball_place(*simulation).z);
    test::advance(*simulation, 1);
  }
  // It falls by h, hits the ground at sqrt(2 g h) and rises by e^2 h. A step of 2 ms is 0.4 % of the fall.
  EXPECT_NEAR(highest - 0.11, 0.36 * (start - 0.11), 0.02 * (start - 0.11));
}

}  // namespace
}  // namespace sandlot
