#include "navigation/localisation/scan_to_map.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

#include "navigation/localisation/plane_fit.h"

namespace sandlot::navigation {
namespace {

constexpr int map_match_levels = 8;  ///< the largest squares have 128 cells a side
constexpr int map_match_least_points = 8;

MatchOutcome map_match_outcome(ScanFault fault) {
  switch (fault) {
    case ScanFault::bad_scan: return MatchOutcome::bad_scan;
    case ScanFault::bad_mount: return MatchOutcome::bad_mount;
    case ScanFault::no_beams: return MatchOutcome::no_beams;
    case ScanFault::none: break;
  }
  return MatchOutcome::matched;
}

/// Length that makes turns comparable to shifts: root mean square of the points' distances.
double map_match_length(const ScanPoints& points) {
  double squares = 0;
  for (const Vec2 p : points.p_B) squares += dot(p, p);
  return std::max(0.1, std::sqrt(squares / static_cast<double>(points.p_B.size())));
}

/// Square of offsets of one turn: `side` cells from (x, y) on.
struct MapMatchNode {
  int score = 0;  ///< upper bound of the sum over the points
  int level = 0, turn = 0, x = 0, y = 0;
  /// For the heap: the greatest score comes first; of equal ones the smallest square, then the order of the window.
  friend bool operator<(const MapMatchNode& a, const MapMatchNode& b) {
    return std::tuple(a.score, b.level, b.turn, b.y, b.x) < std::tuple(b.score, a.level, a.turn, a.y, a.x);
  }
};

}  // namespace

std::span<const EnumName<MatchOutcome>> enum_names(MatchOutcome) {
  static constexpr EnumName<MatchOutcome> names[] = {{"matched", MatchOutcome::matched},
                                                     {"bad_scan", MatchOutcome::bad_scan},
                                                     {"bad_mount", MatchOutcome::bad_mount},
                                                     {"no_beams", MatchOutcome::no_beams},
                                                     {"bad_guess", MatchOutcome::bad_guess},
                                                     {"few_points", MatchOutcome::few_points},
                                                     {"not_converged", MatchOutcome::not_converged},
                                                     {"low_score", MatchOutcome::low_score},
                                                     {"gave_up", MatchOutcome::gave_up}};
  return names;
}

Status MapMatchSpec::check(const Node& node, const std::string& path) const {
  if (!(min_range_m < max_range_m))
    return node.error("min_range is not below max_range", "a shorter min_range", path + "/min_range");
  return {};
}

MapMatcher::Level MapMatcher::first_level(const DistanceField& field, double deviation_m) {
  const GridGeometry& g = field.geometry();
  Level out{1, g.width, g.height, std::vector<std::uint8_t>(g.cells())};
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) {
      const double d = static_cast<double>(field.at({x, y})) / deviation_m;
      out.score[g.index({x, y})] = static_cast<std::uint8_t>(std::floor(255 * math::exp(-d * d / 2) + 0.5));
    }
  return out;
}

/// Squares of twice the side, from four of those there are.
MapMatcher::Level MapMatcher::next_level(const Level& level) {
  Level out{2 * level.side, level.width + level.side, level.height + level.side, {}};
  out.score.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
  const int first = 1 - out.side;
  for (int j = 0; j < out.height; ++j)
    for (int i = 0; i < out.width; ++i) {
      const int x = i + first, y = j + first, s = level.side;
      out.score[static_cast<std::size_t>(j) * static_cast<std::size_t>(out.width) +
                static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::max({level.at(x, y),
                                                                                   level.at(x + s, y),
                                                                                   level.at(x, y + s),
                                                                                   level.at(x + s, y + s)}));
    }
  return out;
}

Result<MapMatcher> MapMatcher::make(const MapMatchSpec& spec, const GridMap& map) {
  SL_TRY(check_ranges(spec));
  SL_TRY(spec.check(Node{}, ""));
  SL_ASSIGN(auto field, DistanceField::make(map, spec.occupied_percent,
                                            std::max(2 * spec.reach_m, 5 * spec.search_deviation_m)));
  MapMatcher out(spec, std::move(field));
  out.levels_.push_back(first_level(out.field_, spec.search_deviation_m));
  const double window = 2 * spec.search_distance_m / map.geometry.resolution_m;
  while (out.levels_.size() < map_match_levels && out.levels_.back().side < window)
    out.levels_.push_back(next_level(out.levels_.back()));
  return out;
}

MapMatch MapMatcher::refine(const msg::LaserScan& scan, const Pose& X_BL, const Pose2& guess) const {
  MapMatch out{.pose = guess};
  if (!is_bounded(guess)) return out.outcome = MatchOutcome::bad_guess, out;
  ScanPoints points;
  out.outcome = map_match_outcome(
      take_points(scan, X_BL, {spec_.min_range_m, spec_.max_range_m, spec_.max_points}, points));
  if (out.outcome != MatchOutcome::matched) return out;
  return refine(points, guess);
}

MapMatch MapMatcher::search(const msg::LaserScan& scan, const Pose& X_BL, const Pose2& guess) const {
  MapMatch out{.pose = guess};
  if (!is_bounded(guess)) return out.outcome = MatchOutcome::bad_guess, out;
  ScanPoints points;
  out.outcome = map_match_outcome(
      take_points(scan, X_BL, {spec_.min_range_m, spec_.max_range_m, spec_.max_points}, points));
  if (out.outcome != MatchOutcome::matched) return out;
  out = correlate(points, guess);
  if (out.outcome != MatchOutcome::matched) return out;
  MapMatch refined = refine(points, out.pose);
  refined.score = out.score;
  refined.evaluations = out.evaluations;
  return refined;
}

MapMatch MapMatcher::refine(const ScanPoints& given, const Pose2& guess) const {
  ScanPoints points = given;
  add_normals(points, spec_.normal_radius_m, spec_.max_gap_m);
  const double cell = field_.geometry().resolution_m;
  MapMatch out{.outcome = MatchOutcome::not_converged, .pose = guess};
  PlaneFit fit(map_match_length(points));
  double reach = spec_.reach_m, gain = 1;
  int surfaces = 0;
  for (const Vec2 n : points.normal_B) surfaces += n != Vec2{};
  for (out.steps = 0; out.steps < spec_.max_steps; ++out.steps) {
    fit.clear();
    const auto [s, c] = math::sincos(out.pose.theta);
    for (std::size_t i = 0; i < points.p_B.size(); ++i) {
      const Vec2 p = points.p_B[i], n = points.normal_B[i];
      if (n == Vec2{}) continue;
      const Vec2 r{c * p.x - s * p.y, s * p.x + c * p.y}, n_M{c * n.x - s * n.y, s * n.x + c * n.y};
      DistanceField::Sample at;
      if (!field_.sample(Vec2{out.pose.x, out.pose.y} + r, at) || std::abs(at.distance_m) > reach) continue;
      const double side = dot(at.gradient_M, n_M);
      // A wall that runs another way than the scan's surface is another wall; within a cell the field has no direction.
      if (std::abs(side) < 0.5 && std::abs(at.distance_m) > cell) continue;
      const double error = at.distance_m * side;
      // Huber's weight: points off the wall by more than twice the deviation count less.
      const double bound = 2 * std::max(spec_.range_deviation_m, cell / 2);
      fit.add(n_M, r, error, std::abs(error) > bound ? bound / std::abs(error) : 1);
    }
    out.points = fit.points();
    out.rms_m = fit.rms();
    if (out.points < map_match_least_points || out.points < spec_.min_share * surfaces) {
      out.outcome = MatchOutcome::few_points;
      out.pose = guess;
      return out;
    }
    const PlaneFit::Step step = fit.solve(spec_.weakest_direction);
    out.observable = step.observable;
    // Points that come and go, which is a matter of millimetres, would never let it rest.
    if (out.steps >= 15) gain *= 0.8;
    out.pose = {out.pose.x + gain * step.x, out.pose.y + gain * step.y,
                math::wrap_angle(out.pose.theta + gain * step.theta)};
    // What is far from all walls once it lies about right is not in the map: people, other robots.
    reach = std::clamp(4 * out.rms_m, std::min(4 * cell, reach), reach);
    if (gain * math::hypot(step.x, step.y) < 1e-4 && gain * std::abs(step.theta) < 1e-4) {
      out.outcome = MatchOutcome::matched;
      break;
    }
  }
  if (out.outcome != MatchOutcome::matched) return out;
  out.covariance = fit.covariance(std::max(out.rms_m, spec_.range_deviation_m), spec_.weakest_direction);
  const double grid = cell * cell / 12, length = map_match_length(points);
  out.covariance[0] += grid, out.covariance[4] += grid, out.covariance[8] += grid / (length * length);
  return out;
}

MapMatch MapMatcher::correlate(const ScanPoints& points, const Pose2& guess) const {
  MapMatch out{.outcome = MatchOutcome::gave_up, .pose = guess};
  const double cell = field_.geometry().resolution_m;
  const auto most = static_cast<std::size_t>(spec_.search_points);
  std::vector<Vec2> chosen;
  double farthest = cell;
  for (std::size_t k = 0, n = std::min(most, points.p_B.size()); k < n; ++k) {
    chosen.push_back(points.p_B[k * points.p_B.size() / n]);
    farthest = std::max(farthest, std::sqrt(dot(chosen.back(), chosen.back())));
  }
  // Turns by a cell at the farthest point, both ways from the guess; offsets by cells.
  const double finest = std::clamp(cell / farthest, 0.002, 0.1);
  const int turns = static_cast<int>(std::ceil(spec_.search_angle_rad / finest));
  const double turn_step = turns > 0 ? spec_.search_angle_rad / turns : 0;
  const int reach = static_cast<int>(std::min(std::ceil(spec_.search_distance_m / cell), 65'536.0));
  const Vec2 at = field_.frame().to_grid({guess.x, guess.y});
  const double heading = guess.theta - field_.geometry().origin.theta;

  struct Offset {
    int x, y;
  };
  const std::size_t n = chosen.size();
  std::vector<Offset> cells(static_cast<std::size_t>(2 * turns + 1) * n);
  for (int t = -turns; t <= turns; ++t) {
    const auto [s, c] = math::sincos(heading + t * turn_step);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 p = chosen[i];
      const auto whole = [](double x) { return static_cast<int>(std::clamp(std::floor(x), -1e8, 1e8)); };
      cells[static_cast<std::size_t>(t + turns) * n + i] = {whole(at.x + (c * p.x - s * p.y) / cell),
                                                            whole(at.y + (s * p.x + c * p.y) / cell)};
    }
  }
  const auto scored = [&](int level, int t, int x, int y) {
    const Level& squares = levels_[static_cast<std::size_t>(level)];
    const Offset* first = &cells[static_cast<std::size_t>(t + turns) * n];
    int sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += squares.at(first[i].x + x, first[i].y + y);
    ++out.evaluations;
    return MapMatchNode{sum, level, t, x, y};
  };
  const double least = spec_.min_score * 255 * static_cast<double>(n);
  std::priority_queue<MapMatchNode> open;
  const auto visit = [&](int level, int t, int x, int y) {
    if (x > reach || y > reach) return;
    if (const MapMatchNode node = scored(level, t, x, y); node.score >= least) open.push(node);
  };
  const int top = static_cast<int>(levels_.size()) - 1, side = levels_.back().side;
  for (int t = -turns; t <= turns; ++t)
    for (int y = -reach; y <= reach; y += side)
      for (int x = -reach; x <= reach; x += side) {
        if (out.evaluations >= spec_.max_evaluations) return out;
        visit(top, t, x, y);
      }
  while (!open.empty()) {
    const MapMatchNode node = open.top();
    open.pop();
    if (node.level == 0) {
      const Vec2 d_G{node.x * cell, node.y * cell};
      // Offsets are along the grid's axes; direction_to_grid's transpose turns them into the map's.
      const Vec2 ex = field_.frame().direction_to_grid({1, 0}), ey = field_.frame().direction_to_grid({0, 1});
      out.pose = {guess.x + dot(ex, d_G), guess.y + dot(ey, d_G),
                  math::wrap_angle(guess.theta + node.turn * turn_step)};
      out.score = node.score / (255.0 * static_cast<double>(n));
      out.outcome = MatchOutcome::matched;
      return out;
    }
    if (out.evaluations >= spec_.max_evaluations) return out;
    const int half = levels_[static_cast<std::size_t>(node.level)].side / 2;
    for (const int dy : {0, half})
      for (const int dx : {0, half}) visit(node.level - 1, node.turn, node.x + dx, node.y + dy);
  }
  out.outcome = MatchOutcome::low_score;
  return out;
}

}  // namespace sandlot::navigation
