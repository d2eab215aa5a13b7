#include "navigation/planning/grid_planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <queue>

#include "base/random.h"

namespace sandlot::navigation {
namespace {

Stream grid_stream(std::uint64_t sample) {
  return Stream(3, entity_key("grid planner"), Purpose::experiment, sample);
}

GridMap grid_random(Stream& random, int width, int height, double density, double resolution = 1) {
  GridMap map{{width, height, resolution, {-2, 3, 0.4}}, {}};
  for (std::size_t i = 0; i < map.geometry.cells(); ++i)
    map.occupancy.push_back(random.uniform() < density ? 100 : 0);
  return map;
}

std::optional<Cell> grid_any_free(const CostMap& map, Stream& random) {
  for (int tries = 0; tries < 1000; ++tries) {
    const Cell c{static_cast<int>(random.below(static_cast<std::uint32_t>(map.geometry.width))),
                 static_cast<int>(random.below(static_cast<std::uint32_t>(map.geometry.height)))};
    if (map.cost[map.geometry.index(c)] < inscribed_cost) return c;
  }
  return std::nullopt;
}

/// Least cost from a cell to every other one [m], by Dijkstra's algorithm with a queue of the standard library.
std::vector<double> grid_dijkstra(const CostMap& map, Cell from, double cost_weight) {
  const auto& g = map.geometry;
  std::vector<double> best(g.cells(), std::numeric_limits<double>::infinity());
  std::priority_queue<std::pair<double, std::size_t>, std::vector<std::pair<double, std::size_t>>,
                      std::greater<>>
      queue;
  best[g.index(from)] = 0;
  queue.push({0, g.index(from)});
  const auto free = [&](int x, int y) { return g.contains({x, y}) && map.cost[g.index({x, y})] < 253; };
  const auto price = [&](std::size_t i) { return 1 + cost_weight * map.cost[i] / 252; };
  while (!queue.empty()) {
    const auto [d, i] = queue.top();
    queue.pop();
    if (d > best[i]) continue;
    const int x = static_cast<int>(i) % g.width, y = static_cast<int>(i) / g.width;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || !free(x + dx, y + dy) || !free(x + dx, y) || !free(x, y + dy)) continue;
        const std::size_t j = g.index({x + dx, y + dy});
        const double next = d + std::sqrt(dx * dx + dy * dy) * g.resolution_m * (price(i) + price(j)) / 2;
        if (next < best[j]) best[j] = next, queue.push({next, j});
      }
  }
  return best;
}

TEST(AStar, CostIsThatOfDijkstraOnRandomMaps) {
  int found = 0, none = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    Stream random = grid_stream(seed);
    const GridMap map = grid_random(random, 20 + static_cast<int>(random.below(30)),
                                    20 + static_cast<int>(random.below(30)),
                                    seed % 3 == 0   ? 0.03
                                    : seed % 3 == 1 ? 0.2
                                                    : 0.4,
                                    0.1);
    const auto costs = make_cost_map(
        map, {.inflation_radius_m = seed % 2 ? 0.4 : 0.0, .cost_scaling_per_m = 4}, 0);
    const auto from = grid_any_free(*costs, random), to = grid_any_free(*costs, random);
    if (!from || !to) continue;
    const GridFrame frame(costs->geometry);
    const double weight = seed % 4 == 0 ? 0 : 3;
    const double best = grid_dijkstra(*costs, *from, weight)[costs->geometry.index(*to)];
    const auto plan = plan_grid(*costs, {GridMethod::astar, weight}, frame.centre(*from), frame.centre(*to));
    const auto any = plan_grid(*costs, {GridMethod::theta, weight}, frame.centre(*from), frame.centre(*to));
    ASSERT_EQ(static_cast<bool>(plan), std::isfinite(best)) << seed;
    ASSERT_EQ(static_cast<bool>(any), std::isfinite(best)) << seed;
    if (!plan) {
      EXPECT_NE(plan.error().what.find("no way"), std::string::npos);
      ++none;
      continue;
    }
    ++found;
    EXPECT_NEAR(plan->cost_m, best, 1e-7) << seed;
    EXPECT_LE(any->cost_m, plan->cost_m + 1e-9) << seed << ": any angle is never more expensive";
    // With weight 0 the cost is the length.
    if (weight == 0) {
      EXPECT_NEAR(plan->length_m, plan->cost_m, 1e-9);
      EXPECT_NEAR(any->length_m, any->cost_m, 1e-9);
    }
  }
  EXPECT_GT(found, 60);
  EXPECT_GT(none, 5);
}

TEST(GridPlanner, CostOfAnyAngleIsTheIntegralAlongIt) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Stream random = grid_stream(500 + seed);
    const GridMap map = grid_random(random, 60, 50, 0.02, 0.1);
    const auto costs = make_cost_map(map, {.inflation_radius_m = 0.6, .cost_scaling_per_m = 4}, 0.12);
    const auto from = grid_any_free(*costs, random), to = grid_any_free(*costs, random);
    const GridFrame frame(costs->geometry);
    const auto plan = plan_grid(*costs, {GridMethod::theta, 2.5}, frame.centre(*from), frame.centre(*to));
    ASSERT_TRUE(plan) << plan.error().text();
    // Midpoint rule: an error of a step where the cost jumps, some 60 jumps of at most 2.5 per 0.05 mm.
    double sum = 0;
    for (std::size_t i = 1; i < plan->points.size(); ++i) {
      const Vec2 a = plan->points[i - 1], d = plan->points[i] - a;
      const double length = math::hypot(d.x, d.y);
      const int steps = static_cast<int>(length / 5e-5) + 1;
      for (int k = 0; k < steps; ++k) {
        const auto cell = frame.cell(a + ((k + 0.5) / steps) * d);
        ASSERT_TRUE(cell);
        const int cost = costs->cost[costs->geometry.index(*cell)];
        ASSERT_LT(cost, 253) << seed << ": the path enters a blocked cell";
        sum += length / steps * (1 + 2.5 * cost / 252);
      }
    }
    EXPECT_NEAR(plan->cost_m, sum, 0.01) << seed;
  }
}

struct GridRectangle {
  int x0, y0, x1, y1;  ///< cells [x0, x1) x [y0, y1)
};

/// Whether a segment, in cells, stays out of the rectangles' interiors.
bool grid_sees(const std::vector<GridRectangle>& rectangles, Vec2 a, Vec2 b) {
  for (const auto& r : rectangles) {
    double begin = 0, end = 1;
    const auto cut = [&](double p, double d, double low, double high) {
      if (d == 0) {
        if (p <= low || p >= high) end = -1;
        return;
      }
      begin = std::max(begin, std::min((low - p) / d, (high - p) / d));
      end = std::min(end, std::max((low - p) / d, (high - p) / d));
    };
    cut(a.x, b.x - a.x, r.x0, r.x1);
    cut(a.y, b.y - a.y, r.y0, r.y1);
    if (end - begin > 1e-9) return false;
  }
  return true;
}

/// Length of the shortest path of a point among rectangles [cells], over the graph of corners that see each other.
double grid_visibility(const std::vector<GridRectangle>& rectangles, Vec2 from, Vec2 to) {
  std::vector<Vec2> points{from, to};
  for (const auto& r : rectangles)
    for (const int x : {r.x0, r.x1})
      for (const int y : {r.y0, r.y1}) points.push_back({double(x), double(y)});
  std::vector<double> best(points.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> done(points.size());
  best[0] = 0;
  for (;;) {
    std::size_t at = points.size();
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!done[i] && (at == points.size() || best[i] < best[at])) at = i;
    if (at == 1 || !std::isfinite(best[at])) return best[1];
    done[at] = true;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!done[i] && grid_sees(rectangles, points[at], points[i]))
        best[i] = std::min(best[i],
                           best[at] + math::hypot(points[i].x - points[at].x, points[i].y - points[at].y));
  }
}

TEST(ThetaStar, IsWithinTwoPercentOfTheVisibilityGraph) {
  double worst = 1, sum = 0, sum_astar = 0;
  int runs = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Stream random = grid_stream(900 + seed);
    constexpr int side = 200;
    std::vector<GridRectangle> rectangles;
    while (rectangles.size() < 14) {
      const int w = 5 + static_cast<int>(random.below(50)), h = 5 + static_cast<int>(random.below(50)),
                x = 2 + static_cast<int>(random.below(side - 4 - 55)),
                y = 2 + static_cast<int>(random.below(side - 4 - 55));
      bool apart = true;
      for (const auto& r : rectangles)
        apart = apart && (x > r.x1 + 2 || r.x0 > x + w + 2 || y > r.y1 + 2 || r.y0 > y + h + 2);
      if (apart) rectangles.push_back({x, y, x + w, y + h});
      else if (random.below(30) == 0) break;
    }
    GridMap map{{side, side, 1, {}}, std::vector<std::int8_t>(side * side)};
    for (const auto& r : rectangles)
      for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x) map.occupancy[map.geometry.index({x, y})] = 100;
    const auto costs = make_cost_map(map, {.inflation_radius_m = 0}, 0);
    const auto from = grid_any_free(*costs, random), to = grid_any_free(*costs, random);
    const GridFrame frame(map.geometry);
    const double best = grid_visibility(rectangles, frame.centre(*from), frame.centre(*to));
    if (best < 40) continue;
    const auto any = plan_grid(*costs, {GridMethod::theta, 0}, frame.centre(*from), frame.centre(*to));
    const auto plain = plan_grid(*costs, {GridMethod::astar, 0}, frame.centre(*from), frame.centre(*to));
    ASSERT_TRUE(any && plain);
    EXPECT_GE(any->length_m, best - 1e-9) << seed;
    EXPECT_LE(any->length_m, 1.02 * best) << seed;
    EXPECT_LE(any->length_m, plain->length_m + 1e-9) << seed;
    worst = std::max(worst, any->length_m / best);
    sum += any->length_m / best;
    sum_astar += plain->length_m / best;
    ++runs;
  }
  EXPECT_GT(runs, 25);
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("mean", std::to_string(sum / runs));
  EXPECT_GT(sum_astar / runs, 1.02) << "the maps would be too easy";
}

CostMap grid_two_rooms() {
  // Two rooms, 2 m x 2 m each, with a wall between them at x in [2, 2.1).
  GridMap map{{41, 20, 0.1, {}}, std::vector<std::int8_t>(41 * 20)};
  for (int y = 0; y < 20; ++y) map.occupancy[map.geometry.index({20, y})] = 100;
  return *make_cost_map(map, {}, 0.2);
}

TEST(GridPlanner, BadEndsAndMissingWaysAreNamed) {
  const CostMap map = grid_two_rooms();
  const auto fault = [&](Vec2 start, Vec2 goal, GridPlannerSpec spec = {}) {
    const auto plan = plan_grid(map, spec, start, goal);
    return plan ? std::string("found") : plan.error().what;
  };
  EXPECT_EQ(fault({1, 1}, {3, 1}), "there is no way from (1, 1) to (3, 1)");
  EXPECT_EQ(fault({1, 1}, {2.05, 1}), "the goal (2.05, 1) lies in an obstacle");
  EXPECT_EQ(fault({1, 1}, {1.95, 1}),
            "the goal (1.95, 1) is nearer to an obstacle than the robot's inscribed radius");
  EXPECT_EQ(fault({1, 1}, {9, 1}), "the goal (9, 1) is off the map");
  EXPECT_EQ(fault({-1, 1}, {1, 1}), "the start (-1, 1) is off the map");
  EXPECT_NE(fault({std::nan(""), 1}, {1, 1}).find("the start is not a point"), std::string::npos);
  EXPECT_EQ(fault({1, 1}, {1.5, 1}, {.cost_weight = std::nan("")}), "cost_weight is nan");
  EXPECT_EQ(fault({1, 1}, {1.95, 1}, {.goal_tolerance_m = 0.5}), "found");
  EXPECT_EQ(fault({1.95, 1}, {1, 1}), "found") << "a robot in the inflated zone may leave it";
  EXPECT_NE(fault({1.95, 1}, {1, 1}, {.start_tolerance_m = 0}), "found");
  CostMap cut = map;
  cut.cost.pop_back();
  EXPECT_FALSE(plan_grid(cut, {}, {1, 1}, {1.5, 1}));
}

TEST(GridPlanner, PathEndsAtTheGoalItself) {
  const CostMap map = grid_two_rooms();
  const auto plan = plan_grid(map, {}, {0.512, 0.33}, {1.31, 1.77});
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->points.front(), (Vec2{0.512, 0.33}));
  EXPECT_EQ(plan->points.back(), (Vec2{1.31, 1.77}));
  const auto same = plan_grid(map, {}, {0.512, 0.33}, {0.512, 0.33});
  ASSERT_TRUE(same);
  EXPECT_NEAR(same->cost_m, 0, 1e-12);
  const auto near = plan_grid(map, {.goal_tolerance_m = 0.5}, {1, 1}, {1.95, 1.05});
  ASSERT_TRUE(near);
  // Free cells are over 0.2 m (centre to centre) from the wall's, at 2.05 m: 1.75 m is the nearest.
  EXPECT_NEAR(near->points.back().x, 1.75, 1e-9);
  EXPECT_NEAR(near->points.back().y, 1.05, 1e-9);
}

}  // namespace
}  // namespace sandlot::navigation
