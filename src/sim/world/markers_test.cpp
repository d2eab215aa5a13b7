/// Markers, values about them, and the rule `zone`: areas whose every point can be said beforehand.
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "geometry/polygon.h"
#include "markers/marker.h"
#include "sim/test_values.h"
#include "sim/test_world.h"
#include "sim/watch/monitor.h"
#include "sim/watch/values.h"

namespace sandlot::test {
namespace {

Node node_list(std::initializer_list<Node> items) {
  Node out = Node::sequence();
  for (const Node& item : items) out.push(item);
  return out;
}
Node number_list(std::initializer_list<double> values) {
  Node out = Node::sequence();
  for (const double value : values) out.push(Node::scalar(std::to_string(value)));
  return out;
}
Node with_key(Node node, const char* key, const Node& value) {
  node.set(key, value);
  return node;
}
model::ElementDecl marker_element(const char* kind, Node config, const char* name = nullptr) {
  return {name ? name : kind, kind, std::move(config), {}};
}
model::ElementDecl disc(const char* name, double x, double y, const char* radius) {
  return marker_element("disc", with_key(map({{"radius", radius}}), "centre", number_list({x, y})), name);
}
model::ElementDecl line(Node points, std::initializer_list<std::pair<const char*, std::string>> keys) {
  return marker_element("line", with_key(map(keys), "points", points));
}
model::ElementDecl grid(std::initializer_list<std::pair<const char*, std::string>> keys) {
  return marker_element(
      "grid", with_key(with_key(map(keys), "size", number_list({1, 0.5})), "corner", number_list({2, 1})));
}

std::string why_refused(model::Setup setup) {
  Diagnostics diagnostics;
  const auto made = Simulation::create(std::move(setup), {}, diagnostics);
  return made ? "" : made.error().text();
}
double evaluated(const Simulation& simulation, const std::string& text) {
  auto compiled = ValueExpression::compile(simulation, text);
  if (!compiled) ADD_FAILURE() << compiled.error().text();
  const auto result = compiled ? compiled->evaluate() : std::nullopt;
  return result ? result->value : NAN;
}
std::string complaint(const Simulation& simulation, const std::string& text) {
  const auto compiled = ValueExpression::compile(simulation, text);
  return compiled ? "" : compiled.error().text();
}

/// Three boxes of 0.4 m x 0.2 m at x = 0, 1, 2, without weight, with a disc of 0.5 m about (1, 0).
model::Setup boxes(const char* engine = "rigid") {
  model::Setup setup;
  setup.engine = engine;
  setup.step = Time::from_s(0.01);
  setup.gravity = {0, 0, engine == std::string("planar") ? -9.81 : 0.0};
  const auto box = one_shape("box", Box{{0.4, 0.2, 0.2}}, 1);
  for (int i = 0; i < 3; ++i)
    setup.instances.push_back(placed("box" + std::to_string(i + 1), box, {{1.0 * i, 0, 0.1}, {}}));
  setup.markers.push_back(disc("goal", 1, 0, "0.5"));
  return setup;
}

void put(Simulation& simulation, const char* name, Vec3 at, double yaw = 0) {
  simulation.submit(PoseRequest{name, {at, quat_from_rpy(0, 0, yaw)}});
  advance(simulation, 1);
}

// ---------------------------------------------------------------------------------------------------------- values

TEST(AreaValues, AreOneInsideAndZeroOutsideAndAggregatesCountThem) {
  for (const char* const engine : {"rigid", "planar"}) {
    const auto simulation = build(boxes(engine));
    EXPECT_EQ(value(*simulation, "box1.in.goal"), 0);
    EXPECT_EQ(value(*simulation, "box2.in.goal"), 1);
    EXPECT_EQ(evaluated(*simulation, "count(box*.in.goal)"), 1);
    EXPECT_EQ(evaluated(*simulation, "all(box*.in.goal)"), 0);
    put(*simulation, "box1", {1.3, 0.3, 0.1});
    put(*simulation, "box3", {0.6, -0.25, 0.1});
    EXPECT_EQ(evaluated(*simulation, "count(box*.in.goal)"), 3);
    EXPECT_EQ(evaluated(*simulation, "all(box*.in.goal)"), 1);
  }
}

TEST(AreaValues, OverlapsBeginWhereTheOutlineTouches) {
  // The disc ends at x = 1.5. A box of 0.4 m across reaches it from x = 1.7, turned by 45 degrees from 1.5 + the half
  // diagonal extent (0.2 + 0.1) / sqrt(2); a can of 0.15 m from 1.65.
  for (const char* const engine : {"rigid", "planar"}) {
    model::Setup setup = boxes(engine);
    setup.instances.push_back(placed("can", one_shape("can", Cylinder{0.15, 0.2}, 1), {{5, 0, 0.1}, {}}));
    const auto simulation = build(setup);
    const auto overlaps = [&](const char* name, double x, double yaw = 0) {
      put(*simulation, name, {x, 0, 0.1}, yaw);
      return value(*simulation, std::string(name) + ".overlaps.goal");
    };
    EXPECT_EQ(overlaps("box3", 1.7 + 1e-6), 0) << engine;
    EXPECT_EQ(overlaps("box3", 1.7 - 1e-6), 1) << engine;
    EXPECT_EQ(value(*simulation, "box3.in.goal"), 0) << engine;
    const double corner = 1.5 + 0.3 / std::sqrt(2.0);
    // Off its middle line by (0.2 - 0.1) / sqrt(2), the corner meets the disc a little later.
    const double off = 0.1 / std::sqrt(2.0), later = 0.5 - std::sqrt(0.25 - off * off);
    EXPECT_EQ(overlaps("box3", corner - later + 1e-6, math::pi / 4), 0) << engine;
    EXPECT_EQ(overlaps("box3", corner - later - 1e-6, math::pi / 4), 1) << engine;
    put(*simulation, "box3", {9, 0, 0.1});
    EXPECT_EQ(overlaps("can", 1.65 + 1e-6), 0) << engine;
    EXPECT_EQ(overlaps("can", 1.65 - 1e-6), 1) << engine;
  }
}

TEST(AreaValues, WhatIsBelowTheGroundDoesNotOverlap) {
  const auto simulation = build(boxes());
  EXPECT_EQ(value(*simulation, "box2.overlaps.goal"), 1);
  put(*simulation, "box2", {1, 0, -0.11});
  EXPECT_EQ(value(*simulation, "box2.overlaps.goal"), 0);
  EXPECT_EQ(value(*simulation, "box2.in.goal"), 1);
  put(*simulation, "box2", {1, 0, -0.09});
  EXPECT_EQ(value(*simulation, "box2.overlaps.goal"), 1);
}

TEST(AreaValues, EventsBeginWhenSomethingEntersAndLeaves) {
  model::Setup setup = boxes();
  setup.events = {{"enter", "box1.in.goal", {}, false, false, {}},
                  {"leave", "not box1.in.goal and sim.tick > 1", {}, false, false, {}}};
  const auto simulation = build(setup);
  std::vector<std::string> happened;
  for (const double x : {0.2, 0.4, 0.6, 1.0, 1.4, 1.6, 1.0}) {
    put(*simulation, "box1", {x, 0.4 * (x < 0.5) + 0.25, 0.1});
    for (const std::string& name : simulation->monitor().happened())
      happened.push_back(name + "@" + std::to_string(simulation->tick_index()));
  }
  EXPECT_EQ(happened, (std::vector<std::string>{"leave@2", "enter@3", "leave@6", "enter@7"}));
}

TEST(AreaValues, ErrorsNameTheNearestMarker) {
  const auto simulation = build(boxes());
  const auto has = [&](const std::string& text, const char* words) {
    EXPECT_NE(complaint(*simulation, text).find(words), std::string::npos) << complaint(*simulation, text);
  };
  has("box1.in.gaol", "there is no marker 'gaol'; did you mean 'goal'?");
  has("count(box*.in.gaol)", "there is no marker 'gaol'; did you mean 'goal'?");
  has("box1.overlaps.gol", "there is no marker 'gol'; did you mean 'goal'?");
  has("box1.in", "a group of them");
  has("box1.on.goal", "has no value 'on.goal'");
  model::Setup bare = boxes();
  bare.markers.clear();
  const auto without = build(bare);
  EXPECT_NE(complaint(*without, "box1.in.goal").find("declare it: markers:"), std::string::npos);
}

// --------------------------------------------------------------------------------------------------- lines and grids

const Marker& marker(const Simulation& simulation, const char* name) {
  const Marker* const found = simulation.elements().find_marker(name);
  SL_CHECK(found != nullptr);
  return *found;
}

TEST(LineMarker, HoldsWhatIsWithinHalfOfItsWidth) {
  model::Setup setup = boxes();
  setup.markers.push_back(
      line(node_list({number_list({0, 0}), number_list({2, 0}), number_list({2, 1})}), {{"width", "0.2"}}));
  const auto simulation = build(setup);
  const Marker& l = marker(*simulation, "line");
  for (const Vec3 in :
       {Vec3{1, 0.09, 0}, {1, -0.09, 5}, {-0.09, 0, 0}, {2.06, -0.06, 0}, {2.09, 0.5, 0}, {2, 1.09, 0}})
    EXPECT_TRUE(l.contains(in)) << in.x << ", " << in.y;
  for (const Vec3 out :
       {Vec3{1, 0.11, 0}, {-0.11, 0, 0}, {-0.08, -0.08, 0}, {2.08, -0.08, 0}, {2.11, 0.5, 0}, {1, 1, 0}})
    EXPECT_FALSE(l.contains(out)) << out.x << ", " << out.y;
}

TEST(LineMarker, ClosesAndMayCrossItself) {
  model::Setup setup = boxes();
  const Node eight = node_list(
      {number_list({0, 0}), number_list({2, 2}), number_list({2, 0}), number_list({0, 2})});
  setup.markers.push_back(line(eight, {{"width", "0.2"}, {"closed", "true"}}));
  const auto simulation = build(setup);
  const Marker& l = marker(*simulation, "line");
  EXPECT_TRUE(l.contains({1, 1, 0})) << "the crossing";
  EXPECT_TRUE(l.contains({0, 1, 0})) << "the segment that closes it";
  EXPECT_FALSE(l.contains({1, 0.5, 0}));
}

TEST(GridMarker, HoldsItsBars) {
  model::Setup setup = boxes();
  setup.markers.push_back(grid({{"spacing", "0.25"}, {"width", "0.05"}}));
  const auto simulation = build(setup);
  const Marker& g = marker(*simulation, "grid");
  EXPECT_EQ(g.outlines_W().size(), 5u + 3u);
  for (const Vec3 in :
       {Vec3{2, 1, 0}, {2.25, 1.1, 0}, {2.1, 1.25, 0}, {2.976, 1.1, 0}, {3.024, 1.524, 0}, {1.976, 0.976, 0}})
    EXPECT_TRUE(g.contains(in)) << in.x << ", " << in.y;
  for (const Vec3 out : {Vec3{2.1, 1.1, 0}, {2.22, 1.22, 0}, {3.026, 1.1, 0}, {2.1, 1.526, 0}, {1.974, 1, 0}})
    EXPECT_FALSE(g.contains(out)) << out.x << ", " << out.y;
}

/// Over random points, an area is the union of its outlines but for a rim where arcs are polygons; and a small disc meets it
/// where a point of it does.
TEST(Markers, AreTheUnionOfTheirOutlines) {
  model::Setup setup = boxes();
  setup.markers.push_back(line(
      node_list({number_list({1, 1}), number_list({2, 1.2}), number_list({1.2, 1.6})}), {{"width", "0.15"}}));
  setup.markers.push_back(grid({{"spacing", "0.2"}, {"width", "0.05"}, {"yaw", "0.4"}}));
  const auto simulation = build(setup);
  Stream random(1, 2, Purpose::noise, 3);
  for (const char* const name : {"goal", "line", "grid"}) {
    const Marker& area = marker(*simulation, name);
    const auto outlines = area.outlines_W();
    const auto near_rim = [&](Vec2 p, double rim_m) {
      for (const auto& outline : outlines)
        for (std::size_t i = 0; i < outline.size(); ++i) {
          const Vec3 a = outline[i], b = outline[(i + 1) % outline.size()];
          if (distance_m(p, Vec2{a.x, a.y}, Vec2{b.x, b.y}) < rim_m) return true;
        }
      return false;
    };
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec2 p{random.uniform(0.4, 3.2), random.uniform(-0.6, 2)};
      if (near_rim(p, 0.003)) continue;  // the sagitta of the disc's 48 sides is 0.0011 m
      bool covered = false;
      for (const auto& outline : outlines) covered = covered || polygon_contains(outline, {p.x, p.y, 0});
      EXPECT_EQ(area.contains({p.x, p.y, 0}), covered) << name << " " << p.x << ", " << p.y;
      EXPECT_EQ(area.meets({{p}, 1e-6}), covered) << name << " " << p.x << ", " << p.y;
      const bool clear = near_rim(p, 0.097) || !near_rim(p, 0.103);
      EXPECT_TRUE(!clear || area.meets({{p}, 0.1}) == (covered || near_rim(p, 0.1)))
          << name << " " << p.x << ", " << p.y;
      inside += covered;
    }
    EXPECT_GT(inside, 100) << name;
  }
}

TEST(Markers, BadOnesAreRefusedByWhatIsWrong) {
  const auto error = [](model::ElementDecl decl) {
    model::Setup setup = boxes();
    setup.markers.push_back(std::move(decl));
    return why_refused(std::move(setup));
  };
  const auto has = [](const std::string& text, const char* words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  const Node two = node_list({number_list({0, 0}), number_list({1, 0})});
  has(error(line(node_list({number_list({0, 0})}), {})), "points");
  has(error(line(node_list({number_list({0, 0}), number_list({0, 0})}), {})), "points 1 and 2 are equal");
  has(error(line(
          node_list({number_list({0, 0}), number_list({1, 0}), number_list({1, 1}), number_list({0, 0})}),
          {{"closed", "true"}})),
      "points 4 and 1 are equal; leave the last one out");
  has(error(line(two, {{"closed", "true"}})), "a closed line needs three points");
  has(error(line(two, {{"width", "0"}})), "width");
  has(error(line(two, {{"width", "-1"}})), "width");
  Node many = Node::sequence();
  for (int i = 0; i <= 1000; ++i) many.push(number_list({0.1 * i, 0}));
  has(error(line(many, {})), "1000");
  has(error(grid({{"spacing", "0.1"}, {"width", "0.1"}})), "as wide as their spacing");
  has(error(grid({{"spacing", "0.001"}, {"width", "0.0005"}})), "more than 500 lines");
  has(error(grid({{"spacing", "0"}})), "spacing");
}

// ------------------------------------------------------------------------------------------------------------ zone

model::Setup zoned(const char* stop_when = "never", const char* objects = "box*") {
  model::Setup setup = boxes();
  setup.rules.push_back(marker_element("zone", with_key(map({{"marker", "goal"}, {"stop_when", stop_when}}),
                                                        "objects", node_list({Node::scalar(objects)}))));
  return setup;
}

TEST(Zone, CountsEntriesExitsAndTimePerObject) {
  const auto simulation = build(zoned());  // judged at tick 0: box2 is inside
  EXPECT_EQ(value(*simulation, "rules/zone.inside"), 1);
  put(*simulation, "box1", {0.8, 0.3, 0.1});  // tick 1
  EXPECT_EQ(value(*simulation, "rules/zone.inside"), 2);
  advance(*simulation, 3);                    // ticks 2 to 4
  put(*simulation, "box1", {0, 0, 0.1});      // tick 5
  put(*simulation, "box1", {0.8, 0.3, 0.1});  // tick 6
  EXPECT_EQ(value(*simulation, "rules/zone.visitors[0].entered"), 2);
  EXPECT_EQ(value(*simulation, "rules/zone.visitors[0].left"), 1);
  EXPECT_NEAR(value(*simulation, "rules/zone.visitors[0].time"), 0.05, 1e-12) << "ticks 1 to 4 and 6";
  EXPECT_EQ(value(*simulation, "rules/zone.entered"), 3);
  EXPECT_EQ(value(*simulation, "rules/zone.left"), 1);
  simulation->submit(DeleteRequest{"box2"});
  advance(*simulation, 1);
  EXPECT_EQ(value(*simulation, "rules/zone.left"), 2) << "what is removed leaves";
  EXPECT_EQ(value(*simulation, "rules/zone.inside"), 1);
  simulation->submit(
      SpawnRequest{placed("box2", one_shape("box", Box{{0.4, 0.2, 0.2}}, 1), {{1.2, -0.2, 0.1}, {}})});
  advance(*simulation, 1);
  EXPECT_EQ(value(*simulation, "rules/zone.visitors[1].entered"), 2) << "it goes on under its name";
}

TEST(Zone, EndsTheRunWhenAnyAllOrNoneIsInside) {
  EXPECT_EQ(build(zoned("any"))->stop_reason(), "an object is in 'goal'");
  EXPECT_FALSE(build(zoned("never"))->stop_reason());
  const auto all = build(zoned("all"));
  put(*all, "box1", {0.8, 0.3, 0.1});
  EXPECT_FALSE(all->stop_reason());
  put(*all, "box3", {0.8, -0.3, 0.1});
  EXPECT_EQ(all->stop_reason(), "all objects are in 'goal'");
  const auto none = build(zoned("none"));
  EXPECT_FALSE(none->stop_reason());
  put(*none, "box2", {5, 0, 0.1});
  EXPECT_EQ(none->stop_reason(), "no object is left in 'goal'");
  EXPECT_FALSE(build(zoned("none", "box1"))->stop_reason()) << "none was there yet";
}

TEST(Zone, WithOverlapsAPartIsEnough) {
  model::Setup setup = zoned();
  setup.rules.front().config.set("overlaps", Node::scalar("true"));
  const auto simulation = build(setup);
  put(*simulation, "box3", {1.6, 0, 0.1});
  EXPECT_EQ(value(*simulation, "rules/zone.inside"), 2);
  EXPECT_EQ(value(*simulation, "box3.in.goal"), 0);
}

TEST(Zone, NamesThatAreNotThereAreRefused) {
  EXPECT_NE(why_refused(zoned("never", "bax1")).find("did you mean 'box1'?"), std::string::npos);
  model::Setup setup = zoned();
  setup.rules.front().config.set("marker", Node::scalar("gaol"));
  EXPECT_NE(why_refused(setup).find("did you mean 'goal'?"), std::string::npos);
}

TEST(Zone, GoesOnFromASnapshotAndRefusesForgedState) {
  const auto whole = build(zoned());
  const auto play = [](Simulation& simulation, std::uint64_t until) {
    while (simulation.tick_index() < until) {
      const double x = 0.1 * static_cast<double>(simulation.tick_index() % 20);
      put(simulation, "box1", {x, 0.35, 0.1});
    }
  };
  play(*whole, 60);
  const auto half = build(zoned());
  play(*half, 27);
  for (const int threads : {1, 2, 4}) {
    const auto rest = again(*half, {.threads = threads});
    EXPECT_EQ(rest->state_hash(), half->state_hash());
    play(*rest, 60);
    EXPECT_EQ(rest->state_hash(), whole->state_hash()) << threads;
  }
  const auto elements_of = [](Simulation& s) -> WorldElements& {
    return const_cast<WorldElements&>(s.elements());
  };
  const WorldElements::Part& part = *whole->elements().find_part("rules/zone");
  ByteWriter w;
  whole->elements().save(part, w);
  std::vector<std::byte> bytes(w.bytes().begin(), w.bytes().end());
  const auto fresh = build(zoned());
  const WorldElements::Part& own = *fresh->elements().find_part("rules/zone");
  ByteReader good(bytes);
  EXPECT_TRUE(elements_of(*fresh).load(own, good));
  bytes[0] = static_cast<std::byte>(static_cast<unsigned>(bytes[0]) ^
                                    5u);  // of `inside`: not as many as visitors say
  ByteReader forged(bytes);
  EXPECT_FALSE(elements_of(*fresh).load(own, forged));
}

}  // namespace
}  // namespace sandlot::test
