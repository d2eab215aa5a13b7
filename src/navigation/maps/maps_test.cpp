#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "navigation/maps/cost_map.h"
#include "navigation/maps/distance.h"
#include "navigation/maps/footprint.h"
#include "navigation/maps/occupancy.h"

namespace sandlot::navigation {
namespace {

Stream maps_stream(std::uint64_t sample) {
  return Stream(11, entity_key("maps"), Purpose::experiment, sample);
}

GridMap maps_empty(int width, int height, double resolution = 1, Pose2 origin = {}) {
  GridMap map{{width, height, resolution, origin}, {}};
  map.occupancy.assign(map.geometry.cells(), 0);
  return map;
}

TEST(Grid, TurnedOriginTakesPointsThereAndBack) {
  // Origin at (1, 2), turned left by 90 degrees: columns run along +y of the map, rows along -x.
  const GridGeometry g{10, 5, 0.5, {1, 2, math::pi / 2}};
  const GridFrame frame(g);
  const Vec2 centre = frame.centre({3, 1});  // 1.75 m along, 0.75 m across
  EXPECT_NEAR(centre.x, 1 - 0.75, 1e-12);
  EXPECT_NEAR(centre.y, 2 + 1.75, 1e-12);
  EXPECT_EQ(frame.cell(centre), (Cell{3, 1}));
  EXPECT_FALSE(frame.cell({1.1, 2.1}));
  EXPECT_FALSE(frame.cell({std::nan(""), 2.1}));
  EXPECT_FALSE(frame.cell({std::numeric_limits<double>::infinity(), 2.1}));
}

TEST(Grid, TooManyCellsAreRefused) {
  EXPECT_TRUE(check_geometry({8192, 8192, 0.05}));
  for (const GridGeometry& g :
       {GridGeometry{31623, 31623, 0.05}, GridGeometry{1000000000, 1, 0.05}, GridGeometry{0, 5, 0.05},
        GridGeometry{-3, 5, 0.05}, GridGeometry{5, 5, 0}, GridGeometry{5, 5, std::nan("")},
        GridGeometry{5, 5, 1, {std::nan(""), 0, 0}}})
    EXPECT_FALSE(check_geometry(g)) << g.width << " x " << g.height;
  EXPECT_NE(check_geometry({31623, 31623, 0.05}).error().text().find("too large"), std::string::npos);
}

TEST(Distance, EqualsBruteForceOnRandomMaps) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Stream random = maps_stream(seed);
    const int w = 1 + static_cast<int>(random.below(40)), h = 1 + static_cast<int>(random.below(40));
    const double density = seed % 3 == 0 ? 0.003 : seed % 3 == 1 ? 0.05 : 0.4;
    std::vector<std::uint8_t> marked(static_cast<std::size_t>(w * h));
    for (auto& m : marked) m = random.uniform() < density;
    const auto got = squared_distances(marked, w, h);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        std::uint32_t best = no_distance;
        for (int v = 0; v < h; ++v)
          for (int u = 0; u < w; ++u)
            if (marked[static_cast<std::size_t>(v * w + u)])
              best = std::min(best, static_cast<std::uint32_t>((x - u) * (x - u) + (y - v) * (y - v)));
        ASSERT_EQ(got[static_cast<std::size_t>(y * w + x)], best) << seed << ": " << x << " " << y;
      }
  }
}

TEST(CostMap, DecaysAsTheInflationLayerDoes) {
  GridMap map = maps_empty(41, 41, 0.1);
  map.occupancy[map.geometry.index({20, 20})] = 100;
  const auto costs = make_cost_map(map, {.inflation_radius_m = 1.0, .cost_scaling_per_m = 3}, 0.3);
  ASSERT_TRUE(costs);
  const auto at = [&](int x, int y) { return int{costs->cost[costs->geometry.index({x, y})]}; };
  EXPECT_EQ(at(20, 20), 254);
  EXPECT_EQ(at(21, 20), 253);
  EXPECT_EQ(at(22, 22), 253);  // 0.283 m
  EXPECT_EQ(at(24, 20), 186);  // 252 exp(-3 * 0.1) = 186.7
  EXPECT_EQ(at(24, 23), 138);  // 0.5 m: 252 exp(-0.6) = 138.3
  EXPECT_EQ(at(28, 26), 30);   // 1.0 m is the last with a cost: 252 exp(-2.1) = 30.9
  EXPECT_EQ(at(29, 25), 0);    // 1.03 m
  EXPECT_NEAR(costs->distance_m[costs->geometry.index({24, 23})], 0.5, 1e-6);
}

TEST(CostMap, UnknownCellsCostWhatTheSpecSays) {
  GridMap map = maps_empty(20, 1);
  map.occupancy[3] = -1;
  map.occupancy[9] = 64;
  EXPECT_EQ(int{make_cost_map(map, {.inflation_radius_m = 0}, 0)->cost[3]}, 0);
  EXPECT_EQ(int{make_cost_map(map, {.inflation_radius_m = 0, .unknown_cost = 80}, 0)->cost[3]}, 80);
  const auto wall = make_cost_map(map, {.inflation_radius_m = 0, .unknown_cost = 254}, 1.5);
  EXPECT_EQ(int{wall->cost[3]}, 254);
  EXPECT_EQ(int{wall->cost[4]}, 253);
  EXPECT_EQ(int{wall->cost[9]}, 0) << "64 % is below the threshold";
  EXPECT_FALSE(make_cost_map(map, {.inflation_radius_m = std::nan("")}, 0));
  EXPECT_FALSE(make_cost_map(map, {}, -1));
  map.occupancy.pop_back();
  EXPECT_FALSE(make_cost_map(map, {}, 0));
}

TEST(Footprint, RadiiAreThoseOfThePolygon) {
  const auto box = Footprint::rectangle(0.6, 0.2, 0.3, 0.3);
  ASSERT_TRUE(box);
  EXPECT_NEAR(box->inscribed_m(), 0.2, 1e-12);
  EXPECT_NEAR(box->circumscribed_m(), std::sqrt(0.36 + 0.09), 1e-12);
  EXPECT_EQ(Footprint::polygon({{1, 1}, {2, 1}, {2, 2}})->inscribed_m(), 0) << "the origin lies outside";
  EXPECT_FALSE(Footprint::polygon({{0, 0}, {1, 0}}));
  EXPECT_FALSE(Footprint::polygon({{0, 0}, {1, 1}, {1, 0}, {0, 1}})) << "crossing sides";
  EXPECT_FALSE(Footprint::polygon({{0, 0}, {1, 0}, {std::nan(""), 1}}));
  EXPECT_FALSE(Footprint::circle(0));
  EXPECT_FALSE(Footprint::circle(std::numeric_limits<double>::infinity()));
}

TEST(Footprint, GrowsByItsMarginOnEverySide) {
  for (const bool clockwise : {false, true}) {
    std::vector<Vec2> corners{{0.6, 0.3}, {-0.2, 0.3}, {-0.2, -0.3}, {0.6, -0.3}};
    if (clockwise) std::reverse(corners.begin(), corners.end());
    const auto grown = Footprint::polygon(corners)->grown(0.1);
    ASSERT_TRUE(grown);
    EXPECT_NEAR(grown->inscribed_m(), 0.3, 1e-12);
    EXPECT_NEAR(grown->circumscribed_m(), std::sqrt(0.49 + 0.16), 1e-12);
  }
  EXPECT_NEAR(Footprint::circle(0.3)->grown(0.1)->circumscribed_m(), 0.4, 1e-12);
  EXPECT_FALSE(Footprint::circle(0.3)->grown(-0.1));
}

/// Whether a footprint overlaps a lethal cell, by dense points: finds overlaps deeper than the spacing.
bool maps_overlap_by_points(const CostMap& map, const Footprint& footprint, const Pose2& X, double margin_m) {
  const GridFrame frame(map.geometry);
  const double reach = footprint.circumscribed_m() + 0.05, step = 0.02;
  for (double x = -reach; x <= reach; x += step)
    for (double y = -reach; y <= reach; y += step) {
      bool inside = true;
      const auto corners = footprint.corners();
      if (corners.empty()) inside = math::hypot(x, y) < footprint.circumscribed_m() - margin_m;
      for (std::size_t i = 0; i < corners.size() && inside; ++i) {
        // Counter-clockwise and convex: left of every side by the margin.
        const Vec2 a = corners[i], d = corners[(i + 1) % corners.size()] - a;
        inside = (d.x * (y - a.y) - d.y * (x - a.x)) / std::sqrt(dot(d, d)) > margin_m;
      }
      if (!inside) continue;
      const auto [s, c] = math::sincos(X.theta);
      const auto cell = frame.cell({X.x + c * x - s * y, X.y + s * x + c * y});
      if (cell && map.cost[map.geometry.index(*cell)] == lethal_cost) return true;
    }
  return false;
}

TEST(Footprint, ContactAgreesWithDensePoints) {
  const auto box = Footprint::rectangle(0.9, 0.4, 0.35, 0.35), disc = Footprint::circle(0.5),
             wedge = Footprint::polygon({{0.8, 0}, {-0.3, 0.5}, {-0.3, -0.5}});
  int touching = 0, free = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    Stream random = maps_stream(1000 + seed);
    GridMap map = maps_empty(30, 24, 0.2, {-2, 1, seed % 2 ? 0.7 : 0});
    for (int k = 0; k < 14; ++k)
      map.occupancy[random.below(static_cast<std::uint32_t>(map.occupancy.size()))] = 100;
    const auto costs = make_cost_map(map, {}, 0.3);
    const GridFrame frame(map.geometry);
    const Vec2 p = frame.to_map({random.uniform(6, 24), random.uniform(6, 18)});
    const Pose2 X{p.x, p.y, random.uniform(-4, 4)};
    const Footprint& footprint = seed % 3 == 0 ? *box : seed % 3 == 1 ? *disc : *wedge;
    const Contact contact = footprint_contact(*costs, frame, footprint, X);
    if (contact == Contact::obstacle) {
      // A footprint larger by the spacing of the points touches at one of them.
      EXPECT_TRUE(maps_overlap_by_points(*costs, footprint, X, -0.03)) << seed;
      ++touching;
    } else {
      EXPECT_EQ(contact, Contact::none) << seed;
      EXPECT_FALSE(maps_overlap_by_points(*costs, footprint, X, 1e-9)) << seed;
      ++free;
    }
  }
  EXPECT_GT(touching, 80);
  EXPECT_GT(free, 80);
}

TEST(Footprint, ReachingBeyondTheMapIsOffTheMap) {
  const auto costs = make_cost_map(maps_empty(20, 20, 0.1), {}, 0.1);
  const GridFrame frame(costs->geometry);
  const auto box = Footprint::rectangle(0.5, 0.1, 0.1, 0.1);
  EXPECT_EQ(footprint_contact(*costs, frame, *box, {1.6, 1, 0}), Contact::off_map);
  EXPECT_EQ(footprint_contact(*costs, frame, *box, {1.6, 1, math::pi}), Contact::none);
  EXPECT_EQ(footprint_contact(*costs, frame, *box, {5, 1, 0}), Contact::off_map);
  EXPECT_EQ(footprint_contact(*costs, frame, *box, {1, 1, std::nan("")}), Contact::off_map);
}

msg::LaserScan maps_beam(float range, float max = 10) {
  msg::LaserScan scan;
  scan.angle_min = 0;
  scan.angle_increment = 1;
  scan.range_min = 0.1f;
  scan.range_max = max;
  scan.ranges = {range};
  return scan;
}

TEST(Occupancy, BeamClearsItsWayAndMarksItsEnd) {
  // The grid is turned by 90 degrees about its corner: the beam along +y of the map runs along its columns.
  const GridGeometry g{12, 3, 0.5, {0, 0, math::pi / 2}};
  auto mapper = OccupancyMapper::make({}, g);
  ASSERT_TRUE(mapper);
  mapper->add(maps_beam(3.0f), {-0.75, 0.25, math::pi / 2});  // from cell (0, 1) to 3.25 m: cell (6, 1)
  const GridMap map = mapper->map();
  for (int x = 0; x < 12; ++x) {
    // Log odds of 0.4 and 0.7 are the probabilities themselves after one scan.
    EXPECT_EQ(int{map.occupancy[g.index({x, 1})]}, x < 6 ? 40 : x == 6 ? 70 : -1) << x;
    EXPECT_EQ(int{map.occupancy[g.index({x, 0})]}, -1) << x;
  }
  mapper->add(maps_beam(3.0f), {-0.75, 0.25, math::pi / 2});
  // Odds multiply: (7/3)^2 / (1 + (7/3)^2) = 84.5 %.
  EXPECT_EQ(int{mapper->map().occupancy[g.index({6, 1})]}, 84);
  for (int k = 0; k < 100; ++k) mapper->add(maps_beam(3.0f), {-0.75, 0.25, math::pi / 2});
  EXPECT_EQ(int{mapper->map().occupancy[g.index({6, 1})]}, 97);
  EXPECT_EQ(int{mapper->map().occupancy[g.index({2, 1})]}, 3);
}

TEST(Occupancy, BeamsWithoutEchoClearAndBadOnesDoNothing) {
  const GridGeometry g{40, 3, 0.5, {}};
  const auto seen = [&](float range, Pose2 pose = {0.25, 0.75, 0}, OccupancySpec spec = {}) {
    auto mapper = OccupancyMapper::make(spec, g);
    mapper->add(maps_beam(range), pose);
    int free = 0, occupied = 0;
    for (const auto o : mapper->map().occupancy) free += o >= 0 && o<50, occupied += o> 50;
    return std::pair(free, occupied);
  };
  constexpr float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(seen(inf), std::pair(21, 0)) << "10 m, cells 0 to 20";
  EXPECT_EQ(seen(inf, {0.25, 0.75, 0}, {.clear_without_echo = false}), std::pair(0, 0));
  EXPECT_EQ(seen(-inf), std::pair(0, 0));
  EXPECT_EQ(seen(std::nanf("")), std::pair(0, 0));
  EXPECT_EQ(seen(0.05f), std::pair(0, 0));
  EXPECT_EQ(seen(5.0f, {0.25, std::nan(""), 0}), std::pair(0, 0));
  EXPECT_EQ(seen(5.0f), std::pair(10, 1));
  EXPECT_EQ(seen(5.0f, {0.25, 0.75, 0}, {.max_range_m = 3}), std::pair(7, 0))
      << "bounded range: no echo in it";
  EXPECT_EQ(seen(5.0f, {-3, 0.75, 0}), std::pair(4, 1)) << "a laser off the map sees what lies on it";
  EXPECT_EQ(seen(5.0f, {1e12, 0.75, 0}), std::pair(0, 0));
  EXPECT_FALSE(OccupancyMapper::make({.hit_probability = 0.3}, g));
  EXPECT_FALSE(OccupancyMapper::make({}, {100000, 100000, 0.05}));
}

TEST(Occupancy, GrazingBeamsDoNotEraseAWall) {
  // A long wall along y = 1 seen at grazing angles, by ranges of closed form.
  const GridGeometry g{200, 60, 0.05, {0, 0, 0}};
  auto mapper = OccupancyMapper::make({}, g);
  msg::LaserScan scan;
  scan.angle_min = 0.05f;
  scan.angle_increment = 0.005f;
  scan.range_max = 20;
  for (int i = 0; i < 200; ++i) scan.ranges.push_back(static_cast<float>(0.52 / math::sin(0.05 + 0.005 * i)));
  for (int k = 0; k < 5; ++k) mapper->add(scan, {0.5, 0.5, 0});
  const GridMap map = mapper->map();
  int ends = 0;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto cell = GridFrame(g).cell(
        {0.5 + static_cast<double>(scan.ranges[i]) * math::cos(0.05 + 0.005 * static_cast<double>(i)), 1.02});
    if (!cell) continue;
    EXPECT_GT(map.occupancy[g.index(*cell)], 90) << i;
    ++ends;
  }
  EXPECT_GT(ends, 150);
}

TEST(Occupancy, SavedStateGoesOnToTheBit) {
  const GridGeometry g{40, 30, 0.1, {-1, -1, 0.3}};
  auto a = OccupancyMapper::make({}, g), b = OccupancyMapper::make({}, g);
  a->add(maps_beam(1.0f), {0, 0, 0.2});
  ASSERT_TRUE(b->restore(a->state()));
  a->add(maps_beam(1.5f), {0, 0, 0.9});
  b->add(maps_beam(1.5f), {0, 0, 0.9});
  EXPECT_EQ(a->state().log_odds, b->state().log_odds);
  EXPECT_FALSE(b->restore({}));
}

TEST(Occupancy, MessageKeepsPlaceAndCells) {
  GridMap map = maps_empty(4, 3, 0.25, {1, -2, 2.5});
  map.occupancy[5] = -1;
  map.occupancy[7] = 100;
  const auto back = from_message(to_message(map));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->occupancy, map.occupancy);
  EXPECT_NEAR(back->geometry.origin.theta, 2.5, 1e-12);
  msg::OccupancyGrid bad = to_message(map);
  bad.data.pop_back();
  EXPECT_FALSE(from_message(bad));
  bad.info.width = 4000000000u;
  EXPECT_FALSE(from_message(bad));
}

}  // namespace
}  // namespace sandlot::navigation
