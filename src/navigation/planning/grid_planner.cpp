#include "navigation/planning/grid_planner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "navigation/planning/open_list.h"

namespace sandlot::navigation {
namespace {

constexpr std::array<EnumName<GridMethod>, 2> grid_methods{
    {{"astar", GridMethod::astar}, {"theta", GridMethod::theta}}};
constexpr double grid_never = std::numeric_limits<double>::infinity();

/// Search over a copy of the costs with a blocked rim, so that neighbours need no test of bounds. Lengths are in
/// cells.
class GridSearch {
 public:
  GridSearch(const CostMap& map, double cost_weight) : stride_(map.geometry.width + 2) {
    const std::size_t cells = static_cast<std::size_t>(stride_) *
                              (static_cast<std::size_t>(map.geometry.height) + 2);
    cost_.assign(cells, inscribed_cost);
    for (int y = 0; y < map.geometry.height; ++y)
      std::copy_n(map.cost.data() + map.geometry.index({0, y}), map.geometry.width,
                  cost_.data() + id({0, y}));
    nodes_.assign(cells, {});
    for (int c = 0; c < 256; ++c)
      weight_[static_cast<std::size_t>(c)] = c >= inscribed_cost ? grid_never : 1 + cost_weight * c / 252;
  }

  /// False when the goal can't be reached.
  bool run(Cell start, Cell goal, GridMethod method) {
    goal_ = goal;
    nodes_[id(start)] = {0, id(start), false};
    open_.push({0, 0, id(start)});
    return method == GridMethod::astar ? search<false>() : search<true>();
  }

  /// Cells at which the path turns, with the first and the last.
  std::vector<Cell> path() const {
    std::vector<Cell> out{goal_};
    for (std::uint32_t at = id(goal_); nodes_[at].parent != at;) {
      at = nodes_[at].parent;
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
  double cost() const { return nodes_[id(goal_)].cost; }
  std::size_t expanded() const { return expanded_; }

 private:
  struct Node {
    double cost = grid_never;
    std::uint32_t parent = 0;
    bool closed = false;
  };

  std::uint32_t id(Cell c) const { return static_cast<std::uint32_t>((c.y + 1) * stride_ + c.x + 1); }
  Cell cell(std::uint32_t i) const {
    return {static_cast<int>(i) % stride_ - 1, static_cast<int>(i) / stride_ - 1};
  }
  double weight(std::uint32_t i) const { return weight_[cost_[i]]; }

  template <bool any_angle>
  double heuristic(Cell c) const {
    const double dx = std::abs(c.x - goal_.x), dy = std::abs(c.y - goal_.y);
    if (any_angle) return std::sqrt(dx * dx + dy * dy);
    return std::max(dx, dy) + (std::numbers::sqrt2 - 1) * std::min(dx, dy);
  }

  template <bool any_angle>
  bool search() {
    const std::uint32_t to = id(goal_);
    const std::array<int, 8> step{1,           stride_,      -1,           -stride_,
                                  1 + stride_, -1 + stride_, -1 - stride_, 1 - stride_};
    while (!open_.empty()) {
      const OpenList::Entry entry = open_.pop();
      const std::uint32_t at = entry.item;
      Node& node = nodes_[at];
      // An entry whose cell has been closed is out of date; a cell whose cost fell later is open again.
      if (node.closed) continue;
      node.closed = true;
      ++expanded_;
      if (at == to) return true;
      const double here = weight(at);
      for (std::size_t k = 0; k < step.size(); ++k) {
        const auto next = static_cast<std::uint32_t>(static_cast<int>(at) + step[k]);
        Node& neighbour = nodes_[next];
        if (cost_[next] >= inscribed_cost || (!any_angle && neighbour.closed)) continue;
        double length = 1;
        if (k >= 4) {
          // Diagonal: both cells beside it must be free.
          const auto beside = static_cast<std::uint32_t>(static_cast<int>(at) + step[k - 4]),
                     other = static_cast<std::uint32_t>(static_cast<int>(at) + step[(k - 3) % 4]);
          if (cost_[beside] >= inscribed_cost || cost_[other] >= inscribed_cost) continue;
          length = std::numbers::sqrt2;
        }
        double cost = node.cost + length * 0.5 * (here + weight(next));
        std::uint32_t parent = at;
        if constexpr (any_angle) {
          if (node.parent != at) {
            const Node& far = nodes_[node.parent];
            const double room = std::min(cost, neighbour.cost) - far.cost;
            if (const double straight = line_cost(cell(node.parent), cell(next), room); straight <= room) {
              cost = far.cost + straight;
              parent = node.parent;
            }
          }
        }
        if (!(cost < neighbour.cost)) continue;
        neighbour = {cost, parent, false};
        const double ahead = heuristic<any_angle>(cell(next));
        open_.push({cost + ahead, static_cast<float>(ahead), next});
      }
    }
    return false;
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
  std::vector<std::uint8_t> cost_;
  std::array<double, 256> weight_{};
  std::vector<Node> nodes_;
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
  GridSearch search(map, spec.cost_weight);
  if (!search.run(start, goal, spec.method))
    return Error{"there is no way from " + point_text(start_M) + " to " + point_text(goal_M),
                 "obstacles, or gaps narrower than the robot, lie between them"};

  GridPlan plan;
  plan.cost_m = search.cost() * map.geometry.resolution_m;
  plan.expanded = search.expanded();
  plan.points.push_back(start_M);
  const auto add = [&](Vec2 p) {
    const double step = math::hypot(p.x - plan.points.back().x, p.y - plan.points.back().y);
    if (step <= 1e-9) return;
    plan.length_m += step;
    plan.points.push_back(p);
  };
  for (const Cell c : search.path()) add(frame.centre(c));
  if (frame.cell(goal_M) == goal) add(goal_M);
  return plan;
}

}  // namespace sandlot::navigation
