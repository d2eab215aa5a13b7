#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "base/random.h"
#include "physics/planar/test_world.h"

namespace sandlot::planar {
namespace {

using namespace test;

TEST(PlanarRays, DiscsAndWallsAreMetWhereTheyAre) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(3, 0));
  const InstanceId wall = w.add(model_of(Box{{1, 1, 1}}, true), at(0, 4, math::pi / 4, 0.5));
  std::uint32_t body = 0;
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 100, no_body, &body), 2.8f);
  EXPECT_EQ(body, w.engine.bodies(robot)[0].index);
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {0, 1, 0}, 100, no_body, &body), static_cast<float>(4 - std::sqrt(0.5)));
  EXPECT_EQ(body, w.engine.bodies(wall)[0].index);
  EXPECT_FLOAT_EQ(w.see({0, 4, 0.1}, {1, -1, 0}), 0.5f);  // from inside
  EXPECT_EQ(w.see({0, 0, 0.1}, {-1, 0, 0}, 100, no_body, &body), std::numeric_limits<float>::infinity());
  EXPECT_EQ(body, no_body);
  EXPECT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 2.7), std::numeric_limits<float>::infinity());
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 100, no_body, nullptr, 2.9), 3.2f);  // starts inside
  EXPECT_EQ(w.see({3, 0, 0.1}, {1, 0, 0}, 100, w.engine.bodies(robot)[0].index),
            std::numeric_limits<float>::infinity());
  EXPECT_EQ(w.see({0, 0, 0.1}, {0, 0, 1}), std::numeric_limits<float>::infinity());
}

TEST(PlanarRays, ACarrierThatStandsStillDoesNotSeeItself) {
  World w;
  const InstanceId mast = w.add(model_of(Box{{0.2, 0.2, 1}}, true), at(0, 0, 0, 0.5));
  w.add(model_of(Box{{1, 1, 1}}, true), at(3, 0, 0, 0.5));
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.5}, {1, 0, 0}), 0.1f);
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.5}, {1, 0, 0}, 100, w.engine.bodies(mast)[0].index), 2.5f);
}

TEST(PlanarRays, OfTwoAtTheSameDistanceTheSmallerIndexIsReported) {
  World w;
  const auto can = model_of(Cylinder{0.25, 0.5});
  const InstanceId first = w.add(can, at(2, 0));
  w.add(can, at(2, 0));
  w.add(model_of(Box{{1, 1, 1}}, true), at(2.25, 0));  // its face at 1.75, as the cans' rims
  std::uint32_t body = 0;
  EXPECT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 100, no_body, &body), 1.75f);
  EXPECT_EQ(body, w.engine.bodies(first)[0].index);
  const InstanceId wall = w.add(model_of(Box{{1, 1, 1}}, true), at(2.25, 9));
  const InstanceId later = w.add(can, at(2, 9));
  EXPECT_EQ(w.see({0, 9, 0.1}, {1, 0, 0}, 100, no_body, &body), 1.75f);
  EXPECT_EQ(body, w.engine.bodies(wall)[0].index);
  EXPECT_LT(w.engine.bodies(wall)[0].index, w.engine.bodies(later)[0].index);
}

TEST(PlanarRays, ShortOnesSeeWhatLongOnesSee) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  const std::uint32_t self = w.engine.bodies(robot)[0].index;
  w.add(robot_model(), at(0.5, 0));
  EXPECT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 0.29, self), std::numeric_limits<float>::infinity());
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 0.31, self), 0.3f);
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 0.31), 0.2f);  // who is nobody's sees the rim from inside
  w.add(model_of(Box{{0.1, 1, 1}}, true), at(0, 0.3, math::pi / 2, 0.5));
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {0, 1, 0}, 0.31, self), 0.25f);
  // Many near ones, of which the last to be filed is the nearest.
  World many;
  for (int i = 0; i < 60; ++i) many.add(model_of(Cylinder{0.01, 1}), at(0.3 - 0.003 * i, 0));
  EXPECT_FLOAT_EQ(many.see({0, 0, 0.1}, {1, 0, 0}, 0.4), static_cast<float>(0.3 - 0.003 * 59 - 0.01));
}

TEST(PlanarRays, SeeWhatIsLostFarAwayAndDoNotWalkThere) {
  World w;
  const auto can = model_of(Cylinder{0.25, 0.5});
  w.add(can, at(2, 0));
  w.add(model_of(Box{{1, 1, 1}}, true), at(5, 1, 0, 0.5));
  w.add(model_of(Box{{1, 1, 1}}), at(0, -7, math::pi / 4, 0.5));
  for (const double far_m : {1e3, 1e11}) {
    const InstanceId lost = w.add(can, at(far_m, 2));
    std::uint32_t body = 0;
    EXPECT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 2e12), 1.75f);
    EXPECT_EQ(w.see({0, 1, 0.1}, {1, 0, 0}, 2e12), 4.5f);
    EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {0, -1, 0}, 2e12), static_cast<float>(7 - std::sqrt(0.5)));
    EXPECT_FLOAT_EQ(w.see({0, 2, 0.1}, {1, 0, 0}, 2e12, no_body, &body), static_cast<float>(far_m - 0.25));
    EXPECT_EQ(body, w.engine.bodies(lost)[0].index);
    EXPECT_FLOAT_EQ(w.see({-far_m, 0, 0.1}, {1, 0, 0}, 2e12), static_cast<float>(far_m + 1.75));
    w.engine.remove(lost);
  }
  EXPECT_FLOAT_EQ(w.see({-1e18, 0, 0.1}, {1, 0, 0}, 1e19), 1e18f);
}

TEST(PlanarRays, MayBeNextToParallelToTheCells) {
  World w;
  for (const double x : {-30.0, 30.0}) w.add(robot_model(), at(x, 0)), w.add(robot_model(), at(0, x));
  for (const double aside :
       {5e-324, -5e-324, 1e-308, -1e-308, -1e-300, 1e-299})  // from a corner of the cells
    for (const double ahead : {-1.0, 1.0}) {
      EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {ahead, aside, 0}), 29.8f) << aside;
      EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {aside, ahead, 0}), 29.8f) << aside;
    }
}

TEST(PlanarRays, HeightsCount) {
  World w;
  w.add(robot_model(), at(3, 0));  // 0 .. 0.4
  EXPECT_EQ(w.see({0, 0, 0.41}, {1, 0, 0}), std::numeric_limits<float>::infinity());
  EXPECT_EQ(w.see({0, 0, -0.01}, {1, 0, 0}), std::numeric_limits<float>::infinity());
  EXPECT_NEAR(w.see({0, 0, 1.6}, {2.8, 0, -1.4}), std::sqrt(2.8 * 2.8 + 1.4 * 1.4),
              1e-6);                                                 // the side, aslant
  EXPECT_NEAR(w.see({0, 0, 1.4}, {3, 0, -1}), std::sqrt(10), 1e-6);  // the lid
  EXPECT_EQ(w.see({0, 0, 2.4}, {2.5, 0, -0.5}), std::numeric_limits<float>::infinity());
}

TEST(PlanarRays, WhatIsGoneIsNotSeen) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(3, 0)),
                   wall = w.add(model_of(Box{{1, 1, 1}}, true), at(5, 0));
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), 2.8f);
  w.engine.remove(robot);
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), 4.5f);
  w.engine.set_pose(wall, at(7, 0));
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), 6.5f);
  w.engine.remove(wall);
  EXPECT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), std::numeric_limits<float>::infinity());
  const InstanceId again = w.add(robot_model(), at(2, 0));
  EXPECT_NE(again, robot);
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), 1.8f);
}

struct Crowd {
  World w;
  std::vector<Vec3> robots;  ///< x, y, and the radius in z
  std::vector<std::pair<Pose, Vec3>> boxes;
  Crowd(std::uint64_t sample, double size_m, bool floor, int count = 60) {
    Stream r(4, 0, Purpose::experiment, sample);
    for (int i = 0; i < count; ++i) {
      const double x = r.uniform(-size_m, size_m), y = r.uniform(-size_m, size_m),
                   radius = r.uniform(0.03, 0.5);
      robots.push_back({x, y, radius});
      w.add(model_of(Cylinder{radius, 1}, false, 1, {{0, 0, 0.5}, {}}), at(x, y));
    }
    for (int i = 0; i < 8; ++i) {
      const double x = r.uniform(-size_m, size_m), y = r.uniform(-size_m, size_m), yaw = r.uniform(-3, 3);
      const double length = i < 2 ? size_m : r.uniform(0.05, 1), width = r.uniform(0.05, 1);
      boxes.push_back({at(x, y, yaw, 0.5), {length, width, 1}});
      w.add(model_of(Box{{length, width, 1}}, true), boxes.back().first);
    }
    if (floor) w.add(model_of(Box{{8 * size_m, 8 * size_m, 0.2}}, true), at(0, 0, 0, -0.1));
  }
};

TEST(PlanarRays, AgreeWithBruteForceOnRandomScenes) {
  int hits = 0, rays = 0;
  for (std::uint64_t sample = 0; sample < 40; ++sample) {
    // Of twelve, all are looked at; rays among sixty go from cell to cell.
    Crowd crowd(sample, sample % 2 ? 4 : 300, sample % 3 == 0, sample % 4 == 3 ? 12 : 60);
    Stream r(5, 0, Purpose::experiment, sample);
    for (int k = 0; k < 200; ++k) {
      const Vec3 target = crowd.robots[static_cast<std::size_t>(k) % crowd.robots.size()];
      const double x = target.x + r.uniform(-3, 3), y = target.y + r.uniform(-3, 3);
      const double min_m = k % 4 ? 0 : r.uniform(0, 1), max_m = r.uniform(1, 20);
      Vec3 d{r.normal(), r.normal(), 0};
      if (k % 10 == 0) d.x = 0;
      if (k % 10 == 1) d.y = 0;
      d = normalised(d);
      double best = std::numeric_limits<double>::infinity();
      const auto see = [&](double t) {
        if (t >= min_m && t <= max_m) best = std::min(best, t);
      };
      for (const Vec3 c : crowd.robots) {
        const double b = (x - c.x) * d.x + (y - c.y) * d.y;
        const double disc = b * b - ((x - c.x) * (x - c.x) + (y - c.y) * (y - c.y) - c.z * c.z);
        if (disc < 0) continue;
        see(-b - std::sqrt(disc));
        see(-b + std::sqrt(disc));
      }
      for (const auto& [X, size] : crowd.boxes) {
        const Vec3 o = inverse(X) * Vec3{x, y, 0.5}, e = rotate_inverse(X.q, d);
        for (std::size_t i = 0; i < 2; ++i)
          for (const double side : {-0.5, 0.5}) {
            const double t = (side * size[i] - o[i]) / e[i];
            if (std::abs(o[1 - i] + t * e[1 - i]) <= size[1 - i] / 2) see(t);
          }
      }
      const float seen = crowd.w.see({x, y, 0.5}, d, max_m, no_body, nullptr, min_m);
      // The reference loses digits to b^2 - c near the silhouette; 1e-6 covers the float too.
      if (best < 1e9) ASSERT_NEAR(seen, best, 2e-6) << sample << " " << k;
      else ASSERT_EQ(seen, std::numeric_limits<float>::infinity()) << sample << " " << k;
      hits += best < 1e9;
      ++rays;
    }
  }
  EXPECT_GT(hits, rays / 4);
  EXPECT_LT(hits, rays * 3 / 4);
}

TEST(PlanarRays, ManyOfOneJobSeeWhatEachSeesAlone) {
  constexpr std::size_t count = 300;
  std::size_t hits = 0;
  for (std::uint64_t sample = 0; sample < 60; ++sample) {
    Crowd crowd(sample, 4, sample % 3 == 0, sample % 4 == 3 ? 12 : 40);
    // Shapes that are more than a disc, and one that the fan starts in or touches.
    crowd.w.add(model_of(Box{{2, 0.3, 1}}), at(1, 1, 0.3 + static_cast<double>(sample), 0.5));
    const InstanceId self = crowd.w.add(model_of(Box{{0.4, 0.4, 1}}), at(-2, 1, 0, 0.5));
    Stream r(6, 0, Purpose::experiment, sample);
    const Vec3 from = sample % 5 == 0 ? Vec3{-2.2, 1, 0.5} : Vec3{r.uniform(-6, 6), r.uniform(-6, 6), 0.5};
    const std::uint32_t ignore = sample % 2 ? no_body : crowd.w.engine.bodies(self)[0].index;
    std::vector<Vec3> directions;
    for (std::size_t k = 0; k < count; ++k) {
      Vec3 d{r.normal(), r.normal(), k % 7 == 0 ? 0.1 * r.normal() : 0};
      if (k < 8)
        d = {k % 4 == 0   ? 1.0
             : k % 4 == 1 ? -1.0
                          : 0.0,
             k % 4 == 2   ? 1.0
             : k % 4 == 3 ? -1.0
             : k < 4      ? 0.0
                          : -0.0,
             0};
      directions.push_back(normalised(d));
    }
    const double min_m = sample % 4 ? 0 : 0.3,
                 max_m = sample % 6 == 5 ? std::numeric_limits<double>::infinity() : 20;
    std::vector<float> together(count);
    std::vector<std::uint32_t> bodies(count);
    const RayJob job{{from, {}}, directions, min_m, max_m, ignore, together, bodies};
    crowd.w.engine.rays()->cast({&job, 1});
    for (std::size_t k = 0; k < count; ++k) {
      std::uint32_t body = 0;
      const float alone = crowd.w.see(from, directions[k], max_m, ignore, &body, min_m);
      ASSERT_EQ(together[k], alone) << sample << " " << k;
      ASSERT_EQ(bodies[k], body) << sample << " " << k;
      hits += body != no_body;
    }
  }
  EXPECT_GT(hits, 60 * count / 4);
  EXPECT_LT(hits, 60 * count);
}

TEST(PlanarRays, TheSensorsPoseTurnsTheFan) {
  World w;
  w.add(robot_model(), at(3, 0));
  const Vec3 directions[] = {{1, 0, 0}, {0, -1, 0}};
  float distance[2];
  const RayJob job{at(0, 0, math::pi / 2, 0.1), directions, 0, 10, no_body, distance, {}};
  w.engine.rays()->cast({&job, 1});
  EXPECT_EQ(distance[0], std::numeric_limits<float>::infinity());
  EXPECT_FLOAT_EQ(distance[1], 2.8f);
}

/// A box that moves is an outline of edges within a circle through its corners, which is looked at first: it must lose none.
TEST(PlanarRays, MeetAMovingBoxUpToItsCorners) {
  World w;
  const double yaw = 0.5;
  const InstanceId box = w.add(model_of(Box{{2, 1, 1}}), at(5, 3, yaw, 0.5));
  const std::uint32_t index = w.engine.bodies(box)[0].index;
  const math::SinCos turn = math::sincos(yaw);
  for (const Vec2 corner : {Vec2{1, 0.5}, Vec2{-1, 0.5}, Vec2{-1, -0.5}, Vec2{1, -0.5}}) {
    const Vec3 out = normalised(
        Vec3{turn.cos * corner.x - turn.sin * corner.y, turn.sin * corner.x + turn.cos * corner.y, 0});
    const Vec3 along{-out.y, out.x, 0}, centre{5, 3, 0.2};
    const double radius_m = std::sqrt(1.25);
    for (const double off : {-1e-3, 1e-3}) {
      const Vec3 beside = centre + out * (radius_m + off);
      for (const double from_m : {0.05, 4.0}) {  // within the circle but outside of the box, and from afar
        std::uint32_t body = no_body;
        const float seen = w.see(beside - along * from_m, along, 100, no_body, &body);
        EXPECT_EQ(body, off < 0 ? index : no_body) << corner.x << " " << corner.y << " " << off;
        if (off < 0) { EXPECT_NEAR(seen, from_m, 3e-3); }
      }
      const OverlapQuery ball{{beside.x, beside.y, 0.2}, 5e-4};
      std::vector<std::uint32_t> bodies, ends;
      w.engine.overlaps({&ball, 1}, bodies, ends);
      EXPECT_EQ(bodies.size(), off < 0 ? 1U : 0U);
    }
    // The far side of a box around the origin, beyond min_m.
    EXPECT_NEAR(w.see(centre, out, 100, no_body, nullptr, 1e-6), radius_m, 1e-6);
  }
}

TEST(PlanarOverlaps, NameBodiesOnceAndInOrder) {
  World w;
  const InstanceId wall = w.add(model_of(Box{{5, 0.2, 1}}, true), at(0, 1, 0, 0.5));
  const InstanceId a = w.add(robot_model(), at(0, 0)), b = w.add(robot_model(), at(1, 0));
  const OverlapQuery queries[] = {{{0, 0, 0.2}, 0.7},  {{0, 0.3, 0.2}, 0.59}, {{0, 0.3, 0.2}, 0.61},
                                  {{0, 0, 0.5}, 0.09}, {{0, 0, 0.5}, 0.11},   {{0.6, 0, 0}, 3}};
  std::vector<std::uint32_t> out, ends;
  w.engine.overlaps(queries, out, ends);
  const std::uint32_t W = w.engine.bodies(wall)[0].index, A = w.engine.bodies(a)[0].index,
                      B = w.engine.bodies(b)[0].index;
  EXPECT_EQ(ends, (std::vector<std::uint32_t>{1, 2, 4, 4, 5, 8}));
  EXPECT_EQ(out, (std::vector<std::uint32_t>{A, A, W, A, A, W, A, B}));
}

TEST(PlanarOverlaps, ABallIsNarrowerAwayFromItsMiddle) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(0, 0));  // radius 0.2, up to 0.4
  const InstanceId wall = w.add(model_of(Box{{2, 2, 0.4}}, true), at(5, 0, 0, 0.2));
  // 0.3 above the top a ball of radius 0.5 has a circle of 0.4.
  const OverlapQuery queries[] = {
      {{0.59, 0, 0.7}, 0.5}, {{0.61, 0, 0.7}, 0.5}, {{3.61, 0, 0.7}, 0.5}, {{3.59, 0, 0.7}, 0.5}};
  std::vector<std::uint32_t> out, ends;
  w.engine.overlaps(queries, out, ends);
  EXPECT_EQ(ends, (std::vector<std::uint32_t>{1, 1, 2, 2}));
  EXPECT_EQ(out,
            (std::vector<std::uint32_t>{w.engine.bodies(robot)[0].index, w.engine.bodies(wall)[0].index}));
}

TEST(PlanarRays, SeveralThreadsMayAskFirst) {
  // Nothing has read them since the step, so the first reader makes the map and the links' states.
  Crowd crowd(7, 4, false);
  Crowd twin(7, 4, false);
  for (int round = 0; round < 20; ++round) {
    crowd.w.run(1);
    twin.w.run(1);
    std::array<float, 4> seen{};
    std::array<double, 4> x{};
    std::vector<std::thread> pool;
    for (std::size_t k = 0; k < 4; ++k)
      pool.emplace_back([&, k] {
        seen[k] = crowd.w.see({0, 0, 0.5}, {1, 0.1 * static_cast<double>(k), 0});
        x[k] = crowd.w.engine.states()[k].X_WB.p.x;
      });
    for (std::thread& t : pool) t.join();
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(seen[k], twin.w.see({0, 0, 0.5}, {1, 0.1 * static_cast<double>(k), 0}));
      EXPECT_EQ(x[k], twin.w.engine.states()[k].X_WB.p.x);
    }
  }
}

}  // namespace
}  // namespace sandlot::planar
