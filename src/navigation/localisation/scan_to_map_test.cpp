#include "navigation/localisation/scan_to_map.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "navigation/localisation/test_rooms.h"

namespace sandlot::navigation {
namespace {

using namespace test;

Stream map_match_stream(std::uint64_t sample) {
  return Stream(12, entity_key("scan to map"), Purpose::experiment, sample);
}

TEST(ScanToMap, RefinesAGuessInATurnedMap) {
  const Room room = furnished_room();
  const Laser laser;
  for (const double angle : {0.0, 0.4}) {
    const MapMatcher matcher = *MapMatcher::make({}, room.map(0.05, angle));
    for (std::uint64_t k = 0; k < 8; ++k) {
      Stream random = map_match_stream(k);
      const Pose2 truth = placed(room, random);
      const msg::LaserScan scan = scan_at(room, laser, truth, {}, random, 0.05);
      const Pose2 guess = compose(
          truth, {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.15, 0.15)});
      const MapMatch match = matcher.refine(scan, laser.X_BL, guess);
      ASSERT_EQ(match.outcome, MatchOutcome::matched) << k;
      EXPECT_EQ(match.observable, 3);
      // The centres of a wall's cells lie between 0 and a cell behind its surface. On average they are half a cell off,
      // the same on both sides of a room: half a cell along x and y is the most that a pose is off.
      EXPECT_LT(distance(match.pose, truth), 0.025 * std::numbers::sqrt2) << k;
      EXPECT_LT(turn(match.pose, truth), 0.01) << k;
    }
  }
}

TEST(ScanToMap, ACorridorShowsTwoDirections) {
  const Room corridor{40, 2, {}};
  Laser laser;
  laser.range_max_m = 8;
  for (const double angle : {0.0, 0.3}) {
    const MapMatcher matcher = *MapMatcher::make({}, corridor.map(0.05, angle));
    Stream random = map_match_stream(50);
    const Pose2 truth{20, 0.9, 0.2};
    const msg::LaserScan scan = scan_at(corridor, laser, truth, {}, random);
    const Pose2 guess{20.3, 1.0, 0.15};
    const MapMatch match = matcher.refine(scan, laser.X_BL, guess);
    ASSERT_EQ(match.outcome, MatchOutcome::matched);
    EXPECT_EQ(match.observable, 2);
    EXPECT_NEAR(match.pose.x, 20.3, 0.02) << "kept";
    EXPECT_NEAR(match.pose.y, 0.9, 0.03);
    EXPECT_NEAR(match.pose.theta, 0.2, 0.01);
    EXPECT_GT(match.covariance[0], 1e5);
    // Across it is known, but for the direction of the unknown axis.
    EXPECT_LT(match.covariance[4], 1e-3 * unknown_variance);
    EXPECT_LT(match.covariance[8], 1e-3 * unknown_variance);
    // With an end in sight it shows all three.
    const Pose2 end{35, 0.9, 0.2};
    const MapMatch whole = matcher.refine(scan_at(corridor, laser, end, {}, random), laser.X_BL,
                                          {34.8, 1.0, 0.15});
    EXPECT_EQ(whole.observable, 3);
    EXPECT_NEAR(whole.pose.x, 35, 0.03);
  }
}

TEST(ScanToMap, SearchFindsTheBestOffsetOfTheWindow) {
  const Room room = furnished_room();
  const Laser laser;
  MapMatchSpec spec;
  spec.search_distance_m = 0.4;
  spec.search_angle_rad = 0.1;
  spec.search_points = 40;
  spec.search_deviation_m = 0.04;  // a peak within a cell, which a wrong bound would miss
  spec.min_score = 0.1;
  const GridMap map = room.map(0.1);
  const MapMatcher matcher = *MapMatcher::make(spec, map);
  // The reference tries all offsets one by one, with the score as it is defined.
  const DistanceField field = *DistanceField::make(map, 65, 5);
  const Pose2 truth{3.3, 2.7, 0.8};
  for (std::uint64_t round = 0; round < 6; ++round) {
    Stream random = map_match_stream(60 + round);
    const msg::LaserScan scan = scan_at(room, laser, truth, {}, random);
    const Pose2 guess = compose(
        truth, {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.09, 0.09)});
    ScanPoints points;
    ASSERT_EQ(take_points(scan, laser.X_BL, {0, 100, spec.max_points}, points), ScanFault::none);
    std::vector<Vec2> chosen;
    double farthest = 0.1;
    for (std::size_t k = 0; k < 40; ++k) {
      chosen.push_back(points.p_B[k * points.p_B.size() / 40]);
      farthest = std::max(farthest, math::hypot(chosen.back().x, chosen.back().y));
    }
    const int turns = static_cast<int>(std::ceil(0.1 / (0.1 / farthest)));
    double best = 0;
    for (int t = -turns; t <= turns; ++t) {
      double sums[9][9] = {};
      for (const Vec2 p : chosen) {
        const Pose2 end = compose({guess.x, guess.y, guess.theta + t * 0.1 / turns}, {p.x, p.y, 0});
        const Vec2 g = field.frame().to_grid({end.x, end.y});
        for (int dy = -4; dy <= 4; ++dy)
          for (int dx = -4; dx <= 4; ++dx) {
            const Cell cell{static_cast<int>(std::floor(g.x)) + dx, static_cast<int>(std::floor(g.y)) + dy};
            if (!field.geometry().contains(cell)) continue;
            const auto d = static_cast<double>(field.at(cell));
            sums[dy + 4][dx + 4] += std::floor(255 * math::exp(-d * d / (2 * 0.0016)) + 0.5);
          }
      }
      for (const auto& row : sums) best = std::max(best, *std::max_element(row, row + 9) / (255 * 40));
    }
    const MapMatch match = matcher.search(scan, laser.X_BL, guess);
    ASSERT_EQ(match.outcome, MatchOutcome::matched);
    EXPECT_NEAR(match.score, best, 1e-12) << round;
    EXPECT_LT(match.evaluations, 81 * (2 * turns + 1)) << "fewer than one by one";
    EXPECT_LT(distance(match.pose, truth), 0.1);
  }
}

// Poles of one cell, where a neighbouring offset scores nothing: a bound that misses one cell would miss the place.
TEST(ScanToMap, SearchMissesNoOffset) {
  Room field{10, 10, {}};
  for (const Vec2 pole :
       {Vec2{6.05, 5.55}, {3.25, 4.65}, {5.15, 7.85}, {4.75, 2.45}, {7.35, 6.95}, {2.85, 6.25}})
    field.boxes.push_back({pole, 0.04, 0.04, 0});
  Laser laser;
  laser.beams = 721;
  laser.first_rad = -math::pi, laser.span_rad = math::tau;
  laser.range_max_m = 4;  // the walls are farther
  laser.deviation_m = 0;
  MapMatchSpec spec;
  spec.search_distance_m = 0.4, spec.search_angle_rad = 0, spec.search_deviation_m = 0.01,
  spec.min_score = 0.1;
  const MapMatcher matcher = *MapMatcher::make(spec, field.map(0.1));
  Stream random = map_match_stream(90);
  const Pose2 truth{5.02, 4.97, 0};
  const msg::LaserScan scan = scan_at(field, laser, truth, {}, random);
  for (int dy = -4; dy <= 4; ++dy)
    for (int dx = -4; dx <= 4; ++dx) {
      const MapMatch match = matcher.search(scan, laser.X_BL, {truth.x - 0.1 * dx, truth.y - 0.1 * dy, 0});
      EXPECT_NEAR(match.score, 1, 1e-12) << dx << " " << dy;
    }
}

// Maps that were built from scans: walls of one cell, unknown behind.
TEST(ScanToMap, RefinesWithThinWalls) {
  const Room room = furnished_room();
  const Laser laser;
  GridMap map = room.map(0.05, 0.2);
  const GridFrame frame(map.geometry);
  for (int y = 0; y < map.geometry.height; ++y)
    for (int x = 0; x < map.geometry.width; ++x)
      if (std::int8_t& cell = map.occupancy[map.geometry.index({x, y})]; cell == 100) {
        bool surface = false;
        for (const Cell beside : {Cell{x - 1, y}, Cell{x + 1, y}, Cell{x, y - 1}, Cell{x, y + 1}}) {
          const Vec2 p = frame.centre(beside);
          surface = surface || room.clearance(p) > 0;
        }
        if (!surface) cell = GridMap::unknown;
      }
  const MapMatcher matcher = *MapMatcher::make({}, map);
  for (std::uint64_t k = 0; k < 8; ++k) {
    Stream random = map_match_stream(300 + k);
    const Pose2 truth = placed(room, random);
    const Pose2 guess = compose(
        truth, {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.1, 0.1)});
    const MapMatch match = matcher.refine(scan_at(room, laser, truth, {}, random), laser.X_BL, guess);
    ASSERT_EQ(match.outcome, MatchOutcome::matched) << k;
    EXPECT_LT(distance(match.pose, truth), 0.025 * std::numbers::sqrt2) << k;
    EXPECT_LT(turn(match.pose, truth), 0.01) << k;
  }
}

TEST(ScanToMap, SearchOverTheWholeMap) {
  const Room room = furnished_room();
  const Laser laser;
  MapMatchSpec spec;
  spec.search_distance_m = 8;
  spec.search_angle_rad = math::pi;
  spec.search_points = 60;
  const MapMatcher matcher = *MapMatcher::make(spec, room.map(0.1, 0.2));
  Stream random = map_match_stream(70);
  const Pose2 truth{8.2, 4.4, -2.0};
  const MapMatch match = matcher.search(scan_at(room, laser, truth, {}, random), laser.X_BL, {5, 3.5, 0});
  ASSERT_EQ(match.outcome, MatchOutcome::matched);
  EXPECT_LT(distance(match.pose, truth), 0.06);
  EXPECT_LT(turn(match.pose, truth), 0.02);
}

TEST(ScanToMap, BadInputIsAnswered) {
  const Room room = furnished_room();
  const Laser laser;
  MapMatchSpec spec;
  spec.max_evaluations = 300;
  const MapMatcher matcher = *MapMatcher::make(spec, room.map());
  Stream random = map_match_stream(80);
  const Pose2 truth{3.3, 2.7, 0.8};
  const msg::LaserScan good = scan_at(room, laser, truth, {}, random);
  const auto both = [&](const msg::LaserScan& scan, const Pose& X_BL, const Pose2& guess,
                        MatchOutcome refined, MatchOutcome searched) {
    const MapMatch a = matcher.refine(scan, X_BL, guess), b = matcher.search(scan, X_BL, guess);
    EXPECT_EQ(name_of(a.outcome), std::string(name_of(refined)));
    EXPECT_EQ(name_of(b.outcome), std::string(name_of(searched)));
    if (a.outcome != MatchOutcome::matched) { EXPECT_EQ(a.covariance, unknown_covariance); }
  };
  msg::LaserScan scan = good;
  const double nan = std::nan("");
  both(good, laser.X_BL, {nan, 0, 0}, MatchOutcome::bad_guess, MatchOutcome::bad_guess);
  both(good, laser.X_BL, {0, 1e9, 0}, MatchOutcome::bad_guess, MatchOutcome::bad_guess);
  both(good, {{nan, 0, 0}, {}}, truth, MatchOutcome::bad_mount, MatchOutcome::bad_mount);
  both(good, laser.X_BL, {500, 500, 0}, MatchOutcome::few_points, MatchOutcome::low_score);
  scan.angle_increment = std::numeric_limits<float>::infinity();
  both(scan, laser.X_BL, truth, MatchOutcome::bad_scan, MatchOutcome::bad_scan);
  scan = good;
  for (float& r : scan.ranges) r = std::numeric_limits<float>::quiet_NaN();
  both(scan, laser.X_BL, truth, MatchOutcome::no_beams, MatchOutcome::no_beams);
  scan.ranges = {1, 2, 1};
  EXPECT_EQ(matcher.refine(scan, laser.X_BL, truth).outcome, MatchOutcome::few_points);
  EXPECT_NE(matcher.search(scan, laser.X_BL, truth).outcome, MatchOutcome::matched);
  EXPECT_EQ(matcher.search(good, laser.X_BL, compose(truth, {0.7, 0.7, 0.4})).outcome, MatchOutcome::gave_up);

  const auto refusal = [&](auto&& change) {
    MapMatchSpec bad;
    GridMap map = room.map(0.2);
    change(bad, map);
    const auto made = MapMatcher::make(bad, map);
    return made ? "" : made.error().text();
  };
  EXPECT_EQ(refusal([](auto&, auto&) {}), "");
  EXPECT_NE(
      refusal([](auto&, auto& m) { m.occupancy.assign(m.occupancy.size(), -1); }).find("no occupied cell"),
      std::string::npos);
  EXPECT_NE(refusal([](auto&, auto& m) { m.occupancy.clear(); }).find("0 cells"), std::string::npos);
  EXPECT_NE(refusal([](auto& s, auto&) { s.reach_m = -1; }).find("reach"), std::string::npos);
  EXPECT_NE(refusal([&](auto& s, auto&) { s.search_angle_rad = nan; }).find("search_angle"),
            std::string::npos);
  EXPECT_NE(refusal([](auto& s, auto&) { s.min_range_m = 200; }).find("min_range"), std::string::npos);
}

TEST(SlowScanToMap, CovarianceIsThatOfTheErrors) {
  const Room room = furnished_room();
  Laser laser;
  laser.deviation_m = 0.03;
  for (const double resolution : {0.05, 0.02}) {
    const MapMatcher matcher = *MapMatcher::make({}, room.map(resolution));
    double nees = 0;
    constexpr int runs = 200;
    int matched = 0;
    for (std::uint64_t k = 0; k < runs; ++k) {
      Stream random = map_match_stream(1000 + k);
      const Pose2 truth = placed(room, random);
      const MapMatch match = matcher.refine(
          scan_at(room, laser, truth, {}, random), laser.X_BL,
          compose(truth,
                  {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.05, 0.05)}));
      if (match.outcome != MatchOutcome::matched || match.observable < 3) continue;
      ++matched;
      Eigen::Matrix3d P;
      for (int i = 0; i < 9; ++i) P(i / 3, i % 3) = match.covariance[static_cast<std::size_t>(i)];
      const Eigen::Vector3d e(match.pose.x - truth.x, match.pose.y - truth.y,
                              math::wrap_angle(match.pose.theta - truth.theta));
      nees += e.dot(P.inverse() * e);
    }
    std::printf("resolution %.2f: %d of %d matched, NEES %.2f of 3\n", resolution, matched, runs,
                nees / matched);
    EXPECT_GE(matched, 195);
    EXPECT_LT(nees / matched, 9);
    EXPECT_GT(nees / matched, 0.5);
  }
}

TEST(SlowScanToMap, SearchSurvivesGuessesAMetreOff) {
  const Room room = furnished_room();
  const Laser laser;
  MapMatchSpec spec;
  spec.search_distance_m = 1.5;
  spec.search_angle_rad = 1;
  const MapMatcher matcher = *MapMatcher::make(spec, room.map());
  int found = 0;
  double evaluations = 0;
  for (std::uint64_t k = 0; k < 50; ++k) {
    Stream random = map_match_stream(2000 + k);
    const Pose2 truth = placed(room, random);
    const MapMatch match = matcher.search(
        scan_at(room, laser, truth, {}, random, 0.1), laser.X_BL,
        compose(truth, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.9, 0.9)}));
    found += match.outcome == MatchOutcome::matched && distance(match.pose, truth) < 0.05;
    evaluations += match.evaluations;
  }
  std::printf("found %d of 50, %.0f evaluations\n", found, evaluations / 50);
  EXPECT_GE(found, 48);
}

}  // namespace
}  // namespace sandlot::navigation
