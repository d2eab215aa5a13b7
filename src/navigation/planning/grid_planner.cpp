#include "navigation/planning/grid_planner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#include "navigation/planning/open_list.h"

namespace sandlot::navigation {
namespace {

constexpr std::array<EnumName<GridMethod>, 2> grid_methods{
    {{"astar", GridMethod::astar}, {"theta", GridMethod::theta}}};
constexpr std::array<int, 8> grid_dx{1, 0, -1, 0, 1, -1, -1, 1}, grid_dy{0, 1, 0, -1, 1, 1, -1, -1};
constexpr double grid_never = std::numeric_limits<double>::infinity();

/// Search over a copy of the costs with a blocked rim, so that neighbours need no test of bounds. Lengths are in
/// cells. Costs and parents of cells that were not reached stay unwritten: a search near by touches little memory.
template <bool any_angle>
class GridSearch {
 public:
  GridSearch(const CostMap& map, double cost_weight) : stride_(map.geometry.width + 2) {
    const std::size_t cells = static_cast<std::size_t>(stride_) *
                              (static_cast<std::size_t>(map.geometry.height) + 2);
    cost_.assign(cells, inscribed_cost);
    for (int y = 0; y < map.geometry.height; ++y)
      std::copy_n(map.cost.data() + map.geometry.index({0, y}), map.geometry.width,
                  cost_.data() + id({0, y}));
    state_.assign(cells, unseen);
    way_ = std::make_unique_for_overwrite<double[]>(cells);
    parent_ = std::make_unique_for_overwrite<std::uint32_t[]>(cells);
    for (int c = 0; c < 256; ++c)
      weight_[static_cast<std::size_t>(c)] = c >= inscribed_cost ? grid_never : 1 + cost_weight * c / 252;
  }

  /// False when the goal can't be reached.
  bool run(Cell start, Cell goal) {
    goal_ = goal;
    const std::uint32_t from = id(start), to = id(goal);
    reach(from, 0, from, start);
    const std::array<int, 8> step{1,           stride_,      -1,           -stride_,
                                  1 + stride_, -1 + stride_, -1 - stride_, 1 - stride_};
    while (!open_.empty()) {
      const std::uint32_t at = open_.pop().item();
      // An entry whose cell has been closed is out of date; a cell whose cost fell later is open again.
      if (state_[at] == closed) continue;
      state_[at] = closed;
      ++expanded_;
      if (at == to) return true;
      const Cell here = cell(at);
      for (std::size_t k = 0; k < step.size(); ++k) {
        const std::uint32_t next = moved(at, step[k]);
        if (cost_[next] >= inscribed_cost || (!any_angle && state_[next] == closed)) continue;
        // Diagonal: both cells beside it must be free.
        if (k >= 4 && (cost_[moved(at, step[k - 4])] >= inscribed_cost ||
                       cost_[moved(at, step[(k - 3) % 4])] >= inscribed_cost))
          continue;
        const double length = k >= 4 ? std::numbers::sqrt2 : 1,
                     known = state_[next] == unseen ? grid_never : way_[next];
        double cost = way_[at] + length * 0.5 * (weight(at) + weight(next));
        std::uint32_t parent = at;
        const Cell there{here.x + grid_dx[k], here.y + grid_dy[k]};
        if constexpr (any_angle) {
          // Only a line that may be cheaper than what is known is worth walking.
          const std::uint32_t far = parent_[at];
          const double room = std::min(cost, known - 1e-9) - way_[far];
          const double straight = far == at ? grid_never : line_cost(cell(far), there, room);
          if (straight <= room) {
            cost = way_[far] + straight;
            parent = far;
          }
        }
        if (cost < known) reach(next, cost, parent, there);
      }
    }
    return false;
  }

  /// Cells at which the path turns, with the first and the last.
  std::vector<Cell> path() const {
    std::vector<Cell> out{goal_};
    for (std::uint32_t at = id(goal_); parent_[at] != at;) {
      at = parent_[at];
      const Cell c = cell(at);
      if (const std::size_t n = out.size(); n >= 2) {
        const std::int64_t ax = out[n - 1].x - out[n - 2].x, ay = out[n - 1].y - out[n - 2].y,
                           bx = c.x - out[n - 1].x, by = c.y - out[n - 1].y;
        if (ax * by == ay * bx && ax * bx + ay * by > 0) out.pop_back();
      }
      out.push_back(c);
    }
    std::reverse(out.begin(), out.end());
    return out;
  }
  double cost() const { return way_[id(goal_)]; }
  std::size_t expanded() const { return expanded_; }

 private:
  enum : std::uint8_t { unseen, open, closed };

  std::uint32_t id(Cell c) const { return static_cast<std::uint32_t>((c.y + 1) * stride_ + c.x + 1); }
  Cell cell(std::uint32_t i) const {
    return {static_cast<int>(i) % stride_ - 1, static_cast<int>(i) / stride_ - 1};
  }
  static std::uint32_t moved(std::uint32_t at, int step) {
    return static_cast<std::uint32_t>(static_cast<int>(at) + step);
  }
  double weight(std::uint32_t i) const { return weight_[cost_[i]]; }

  double heuristic(Cell c) const {
    const double dx = std::abs(c.x - goal_.x), dy = std::abs(c.y - goal_.y);
    if (any_angle) return std::sqrt(dx * dx + dy * dy);
    return std::max(dx, dy) + (std::numbers::sqrt2 - 1) * std::min(dx, dy);
  }
  void reach(std::uint32_t at, double cost, std::uint32_t parent, Cell c) {
    way_[at] = cost;
    parent_[at] = parent;
    state_[at] = open;
    open_.push(OpenList::entry(cost, heuristic(c), at));
  }

  /// Integral of the weight along the line between two centres; infinite where it is blocked, or surely above
  /// `limit`. A line through a corner needs both cells beside it.
  double line_cost(Cell a, Cell b, double limit) const {
    const std::int64_t dx = std::abs(b.x - a.x), dy = std::abs(b.y - a.y);
    const double length = std::sqrt(static_cast<double>(dx * dx + dy * dy));
    if (length > limit) return grid_never;
    const int sx = b.x > a.x ? 1 : -1, sy = b.y > a.y ? stride_ : -stride_;
    // Border k of the columns is crossed at (2 k + 1) / (2 dx) of the length, of the rows at (2 m + 1) / (2 dy).
    const double per_x = dx ? 0.5 / static_cast<double>(dx) : 0,
                 per_y = dy ? 0.5 / static_cast<double>(dy) : 0;
    int at = static_cast<int>(id(a));
    double sum = 0, before = 0;
    for (std::int64_t k = 0, m = 0; k < dx || m < dy;) {
      const std::int64_t order = m >= dy ? -1 : k >= dx ? 1 : (2 * k + 1) * dy - (2 * m + 1) * dx;
      const double now = order <= 0 ? static_cast<double>(2 * k + 1) * per_x
                                    : static_cast<double>(2 * m + 1) * per_y;
      sum += (now - before) * weight(static_cast<std::uint32_t>(at));
      if ((sum + 1 - now) * length > limit) return grid_never;
      before = now;
      if (order == 0 && (cost_[static_cast<std::size_t>(at + sx)] >= inscribed_cost ||
                         cost_[static_cast<std::size_t>(at + sy)] >= inscribed_cost))
        return grid_never;
      if (order <= 0) at += sx, ++k;
      if (order >= 0) at += sy, ++m;
      if (cost_[static_cast<std::size_t>(at)] >= inscribed_cost) return grid_never;
    }
    return length * (sum + (1 - before) * weight(static_cast<std::uint32_t>(at)));
  }

  int stride_;
  std::vector<std::uint8_t> cost_, state_;
  std::unique_ptr<double[]> way_;  ///< cost from the start
  std::unique_ptr<std::uint32_t[]> parent_;
  std::array<double, 256> weight_{};
  OpenList open_;
  Cell goal_;
  std::size_t expanded_ = 0;
};

bool grid_free(const CostMap& map, Cell c) {
  return map.geometry.contains(c) && map.cost[map.geometry.index(c)] < inscribed_cost;
}

/// Cell of an end of the path, or why there is none.
Result<Cell> grid_end(const CostMap& map, const GridFrame& frame, Vec2 point, double tolerance_m,
                      const char* name) {
  if (!std::isfinite(point.x) || !std::isfinite(point.y))
    return Error{std::string("the ") + name + " is not a point: " + point_text(point), ""};
  const auto cell = frame.cell(point);
  if (!cell)
    return Error{std::string("the ") + name + " " + point_text(point) + " is off the map",
                 "it covers " + std::to_string(map.geometry.width) + " x " +
                     std::to_string(map.geometry.height) + " cells of " +
                     number_text(map.geometry.resolution_m) + " m"};
  if (grid_free(map, *cell)) return *cell;
  if (const auto near = nearest_free_cell(map, point, tolerance_m)) return *near;
  const bool wall = map.cost[map.geometry.index(*cell)] == lethal_cost;
  return Error{
      std::string("the ") + name + " " + point_text(point) +
          (wall ? " lies in an obstacle" : " is nearer to an obstacle than the robot's inscribed radius"),
      "choose a free point, or a tolerance over " + number_text(tolerance_m) + " m"};
}

}  // namespace

std::span<const EnumName<GridMethod>> enum_names(GridMethod) { return grid_methods; }

std::optional<Cell> nearest_free_cell(const CostMap& map, Vec2 point_M, double radius_m) {
  const GridFrame frame(map.geometry);
  const auto middle = frame.cell(point_M);
  if (!middle || !(radius_m >= 0)) return std::nullopt;
  const Vec2 p = frame.to_grid(point_M);
  const double radius = std::min<double>(radius_m / frame.resolution_m(), max_side);
  const int reach = static_cast<int>(radius) + 1;
  std::optional<Cell> best;
  double least = radius * radius;
  for (int y = std::max(0, middle->y - reach); y <= std::min(map.geometry.height - 1, middle->y + reach); ++y)
    for (int x = std::max(0, middle->x - reach); x <= std::min(map.geometry.width - 1, middle->x + reach);
         ++x) {
      if (!grid_free(map, {x, y})) continue;
      const double dx = x + 0.5 - p.x, dy = y + 0.5 - p.y, square = dx * dx + dy * dy;
      if (square > least || (best && square == least)) continue;
      least = square;
      best = {x, y};
    }
  return best;
}

Result<GridPlan> plan_grid(const CostMap& map, const GridPlannerSpec& spec, Vec2 start_M, Vec2 goal_M) {
  SL_TRY(check_ranges(spec));
  SL_TRY(check_geometry(map.geometry));
  if (map.cost.size() != map.geometry.cells()) return Error{"the cost map does not fit its size", ""};
  const GridFrame frame(map.geometry);
  SL_ASSIGN(const Cell start, grid_end(map, frame, start_M, spec.start_tolerance_m, "start"));
  SL_ASSIGN(const Cell goal, grid_end(map, frame, goal_M, spec.goal_tolerance_m, "goal"));

  GridPlan plan;
  std::vector<Cell> corners;
  const auto search = [&]<bool any_angle>(GridSearch<any_angle> grid) {
    const bool found = grid.run(start, goal);
    if (found) {
      corners = grid.path();
      plan.cost_m = grid.cost() * map.geometry.resolution_m;
      plan.expanded = grid.expanded();
    }
    return found;
  };
  const bool found = spec.method == GridMethod::astar ? search(GridSearch<false>(map, spec.cost_weight))
                                                      : search(GridSearch<true>(map, spec.cost_weight));
  if (!found)
    return Error{"there is no way from " + point_text(start_M) + " to " + point_text(goal_M),
                 "obstacles, or gaps narrower than the robot, lie between them"};
  plan.points.push_back(start_M);
  const auto add = [&](Vec2 p) {
    const double step = math::hypot(p.x - plan.points.back().x, p.y - plan.points.back().y);
    if (step <= 1e-9) return;
    plan.length_m += step;
    plan.points.push_back(p);
  };
  for (const Cell c : corners) add(frame.centre(c));
  if (frame.cell(goal_M) == goal) add(goal_M);
  return plan;
}

}  // namespace sandlot::navigation
