#include "navigation/planning/hybrid_astar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "navigation/planning/car_paths.h"
#include "navigation/planning/open_list.h"

namespace sandlot::navigation {
namespace {

constexpr double hybrid_never = std::numeric_limits<double>::infinity();
constexpr std::uint32_t hybrid_none = std::numeric_limits<std::uint32_t>::max();

/// Distance of the robot's origin to the goal over cells that are no obstacles [m], each cell priced by its
/// cost: Dijkstra's algorithm from the goal, as far as the search asks for.
class HybridDistances {
 public:
  HybridDistances(const CostMap& map, double cost_weight, Cell goal)
      : map_(map),
        weight_(cost_weight),
        way_(map.geometry.cells(), hybrid_never),
        closed_(map.geometry.cells(), 0) {
    way_[map.geometry.index(goal)] = 0;
    open_.push(OpenList::entry(0, 0, static_cast<std::uint32_t>(map.geometry.index(goal))));
  }
  /// Infinite where there is no way.
  double to_goal(Cell c) {
    const std::size_t wanted = map_.geometry.index(c);
    while (!closed_[wanted] && !open_.empty()) {
      const std::uint32_t at = open_.pop().item();
      if (!closed_[at]) expand(at);
    }
    return way_[wanted];
  }

 private:
  void expand(std::uint32_t at) {
    closed_[at] = 1;
    const int width = map_.geometry.width, x0 = static_cast<int>(at) % width,
              y0 = static_cast<int>(at) / width;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell c{x0 + dx, y0 + dy};
        if (!map_.geometry.contains(c)) continue;
        const std::size_t next = map_.geometry.index(c);
        if (closed_[next] || map_.cost[next] == lethal_cost) continue;
        const double length = (dx != 0 && dy != 0 ? std::numbers::sqrt2 : 1) * map_.geometry.resolution_m,
                     cost = way_[at] + length * (1 + weight_ * (map_.cost[at] + map_.cost[next]) / (2 * 252));
        if (!(cost < way_[next])) continue;
        way_[next] = cost;
        open_.push(OpenList::entry(cost / map_.geometry.resolution_m, 0, static_cast<std::uint32_t>(next)));
      }
  }
  const CostMap& map_;
  double weight_;
  std::vector<double> way_;
  std::vector<std::uint8_t> closed_;
  OpenList open_;
};

class HybridSearch {
 public:
  HybridSearch(const CostMap& map, const Footprint& footprint, const HybridSpec& spec, const Pose2& goal,
               Cell goal_cell, const std::function<bool(const Pose2&)>& known)
      : map_(map),
        frame_(map.geometry),
        footprint_(footprint),
        spec_(spec),
        known_(known),
        goal_(goal),
        distances_(map, spec.cost_weight, goal_cell),
        spacing_m_(map.geometry.resolution_m / 2),
        spacing_rad_(map.geometry.resolution_m / 2 /
                     std::max(footprint.circumscribed_m(), map.geometry.resolution_m)) {
    const auto both = [&](const Move& move) {
      moves_.push_back(move);
      if (!spec.backward) return;
      moves_.push_back(move);
      moves_.back().direction_B.x = -1;
    };
    for (const double share : {0.0, 0.5, -0.5, 1.0, -1.0})
      both({.curvature_pm = share / spec.turning_radius_m, .amount = spec.step_m});
    constexpr double half = std::numbers::sqrt2 / 2;
    if (spec.sideways) {
      for (const Vec2 d : {Vec2{0, 1}, Vec2{0, -1}, Vec2{half, half}, Vec2{half, -half}})
        moves_.push_back({d, 0, spec.step_m});
      if (spec.backward)
        for (const Vec2 d : {Vec2{-half, half}, Vec2{-half, -half}}) moves_.push_back({d, 0, spec.step_m});
    }
    if (spec.turn_on_spot)
      for (const double side : {1.0, -1.0}) moves_.push_back({{0, 0}, side, math::tau / spec.headings * 2});
  }

  Result<HybridPlan> run(const Pose2& start) {
    if (!std::isfinite(add(start, 0, hybrid_none, {}, true))) return no_way(start);
    int until = spec_.max_expansions, untried = 0;
    while (!open_.empty() && expanded_ < until) {
      const std::uint32_t at = open_.pop().item();
      if (at == goal_item) return plan();
      const Node node = nodes_[at];
      if (Bin& bin = bins_[key(node.pose)]; bin.closed || bin.node != at) continue;
      else bin.closed = true;
      ++expanded_;
      if (near_goal(node.pose)) {
        offer_goal(at, {}, node.price);
        continue;
      }
      // Far from the goal the direct way is blocked more often than not: it is tried more often near it.
      if (--untried <= 0) {
        untried = static_cast<int>(std::min(20.0, node.ahead / (2 * spec_.step_m)));
        const bool first = best_at_ == hybrid_none;
        try_direct(at, node);
        // A way is known: a better one gets as much work again.
        if (first && best_at_ != hybrid_none) until = std::min(until, 2 * expanded_ + 500);
      }
      for (const Move& move : moves_) {
        // Where the search has been, the footprint needs no check.
        const Pose2 to = moved(node.pose, move, move.amount);
        if (!frame_.cell({to.x, to.y}) || bins_[key(to)].closed) continue;
        const double driven = drive(node.pose, move);
        if (std::isfinite(driven))
          add(to, node.price + change(node, move.direction_B) + driven, at, move, false);
      }
    }
    if (best_at_ != hybrid_none) return plan();
    if (!open_.empty())
      return Error{"no way from " + text(start) + " to " + text(goal_) + " was found within " +
                       std::to_string(spec_.max_expansions) + " poses",
                   "allow more, or larger steps"};
    return no_way(start);
  }

 private:
  static constexpr std::uint32_t goal_item = hybrid_none;
  struct Node {
    Pose2 pose;
    double price = 0, ahead = 0;
    std::uint32_t parent = hybrid_none;
    Move move;  ///< from the parent to here
    bool first = false;
  };
  struct Bin {
    std::uint32_t node = hybrid_none;
    bool closed = false;
  };

  static std::string text(const Pose2& pose) { return point_text({pose.x, pose.y}); }
  Error no_way(const Pose2& start) const {
    return Error{"there is no way from " + text(start) + " to " + text(goal_) + " for this robot",
                 "obstacles, or gaps too narrow for its footprint and turning radius, lie between them"};
  }
  std::uint64_t key(const Pose2& pose) const {
    // Places of 0.7 steps: a step along the diagonal leaves one.
    const Vec2 g = frame_.to_grid({pose.x, pose.y});
    const double bin = std::max(1.0, 0.7 * spec_.step_m / map_.geometry.resolution_m);
    const int heading = static_cast<int>(std::floor((pose.theta / math::tau + 1) * spec_.headings + 0.5)) %
                        spec_.headings;
    return static_cast<std::uint64_t>(g.x / bin) << 40 | static_cast<std::uint64_t>(g.y / bin) << 16 |
           static_cast<std::uint64_t>(heading);
  }
  bool near_goal(const Pose2& pose) const {
    return math::hypot(pose.x - goal_.x, pose.y - goal_.y) <= spec_.goal_tolerance_m &&
           std::abs(math::wrap_angle(pose.theta - goal_.theta)) <= spec_.goal_tolerance_rad;
  }
  /// Price of turning from one direction of travel to the next.
  double change(const Node& node, Vec2 direction) const {
    return node.first || node.move.direction_B == direction ? 0 : spec_.change_price_m;
  }
  double factor(const Move& move) const {
    double f = move.direction_B.y != 0  ? spec_.sideways_factor
               : move.direction_B.x < 0 ? spec_.backward_factor
                                        : 1;
    if (move.curvature_pm != 0) f *= spec_.arc_factor;
    return f;
  }
  /// Price of a move; infinite where the footprint touches something, or a blind move leads into the unknown.
  double drive(const Pose2& from, const Move& move) {
    scratch_.clear();
    append_poses(scratch_, from, move, spacing_m_, spacing_rad_);
    double cost = 0;
    const bool blind = known_ && is_blind(move.direction_B);
    for (const PathPose& at : scratch_) {
      if (footprint_contact(map_, frame_, footprint_, at.pose) != Contact::none) return hybrid_never;
      if (blind && !known_(at.pose)) return hybrid_never;
      cost += map_.cost[map_.geometry.index(*frame_.cell({at.pose.x, at.pose.y}))];
    }
    if (move.direction_B == Vec2{0, 0}) return move.amount * spec_.turn_price_mprad;
    const double mean = scratch_.empty() ? 0 : cost / static_cast<double>(scratch_.size());
    return move.amount * factor(move) * (1 + spec_.cost_weight * mean / 252);
  }
  CarPath car_path(const Pose2& pose) const {
    return spec_.backward ? reeds_shepp(pose, goal_, spec_.turning_radius_m,
                                        {spec_.backward_factor, spec_.change_price_m})
                          : dubins(pose, goal_, spec_.turning_radius_m);
  }
  double heuristic(const Pose2& pose) {
    double ahead = distances_.to_goal(*frame_.cell({pose.x, pose.y}));
    if (spec_.turn_on_spot) return ahead;
    // A turn takes an arc as long as this.
    ahead = std::max(ahead, spec_.turning_radius_m * std::abs(math::wrap_angle(pose.theta - goal_.theta)));
    // The turning radius matters near the goal only: further away the way over cells is as long.
    if (!spec_.sideways && math::hypot(pose.x - goal_.x, pose.y - goal_.y) < 6 * spec_.turning_radius_m)
      ahead = std::max(ahead, car_path(pose).price);
    return ahead;
  }
  double add(const Pose2& pose, double price, std::uint32_t parent, const Move& move, bool first) {
    Bin& bin = bins_[key(pose)];
    if (bin.closed || (bin.node != hybrid_none && nodes_[bin.node].price <= price)) return price;
    const double ahead = heuristic(pose);
    if (!std::isfinite(ahead)) return hybrid_never;
    bin.node = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({pose, price, ahead, parent, move, first});
    open_.push(OpenList::entry(price, ahead, bin.node));
    return price;
  }

  /// Tries moves from a node to the goal itself.
  void try_direct(std::uint32_t at, const Node& node) {
    if (!spec_.turn_on_spot) {
      const CarPath path = car_path(node.pose);
      try_moves(at, node, std::span(path.moves.data(), static_cast<std::size_t>(path.count)));
      if (!spec_.sideways) return;
    }
    const double dx = goal_.x - node.pose.x, dy = goal_.y - node.pose.y, length = math::hypot(dx, dy);
    const double course = length > 1e-9 ? math::atan2(dy, dx) : goal_.theta;
    const auto turn = [](double by) {
      return Move{{0, 0}, by < 0 ? -1.0 : 1.0, std::abs(math::wrap_angle(by))};
    };
    if (spec_.turn_on_spot)
      for (const double way : {1.0, -1.0}) {
        if (way < 0 && !spec_.backward) continue;
        const double heading = way > 0 ? course : course + math::pi;
        const Move moves[] = {turn(math::wrap_angle(heading - node.pose.theta)),
                              {{way, 0}, 0, length},
                              turn(math::wrap_angle(goal_.theta - heading))};
        try_moves(at, node, moves);
      }
    if (!spec_.sideways) return;
    const auto [s, c] = math::sincos(course - node.pose.theta);
    if (!spec_.backward && c < 0) return;
    const double off = math::wrap_angle(goal_.theta - node.pose.theta);
    const Move moves[] = {{{c, s}, 0, length}, turn(off)};
    if (spec_.turn_on_spot || std::abs(off) <= spec_.goal_tolerance_rad)
      try_moves(at, node, std::span(moves, spec_.turn_on_spot ? 2 : 1));
  }
  void try_moves(std::uint32_t at, const Node& node, std::span<const Move> moves) {
    double price = node.price;
    Node last = node;
    std::vector<Move> kept;
    for (const Move& move : moves) {
      if (!(move.amount > 1e-9)) continue;
      price += change(last, move.direction_B) + drive(last.pose, move);
      if (!(price < best_price_)) return;
      last.pose = moved(last.pose, move, move.amount);
      last.move = move;
      last.first = false;
      kept.push_back(move);
    }
    offer_goal(at, std::move(kept), price);
  }
  void offer_goal(std::uint32_t at, std::vector<Move> moves, double price) {
    if (!(price < best_price_)) return;
    best_price_ = price;
    best_at_ = at;
    best_moves_ = std::move(moves);
    open_.push(OpenList::entry(price, 0, goal_item));
  }

  HybridPlan plan() const {
    HybridPlan out;
    out.price = best_price_;
    out.expanded = static_cast<std::size_t>(expanded_);
    std::uint32_t at = best_at_;
    for (; !nodes_[at].first; at = nodes_[at].parent) out.moves.push_back(nodes_[at].move);
    std::reverse(out.moves.begin(), out.moves.end());
    out.moves.insert(out.moves.end(), best_moves_.begin(), best_moves_.end());
    out.poses.push_back({nodes_[at].pose, out.moves.empty() ? Vec2{1, 0} : out.moves.front().direction_B});
    for (const Move& move : out.moves) {
      append_poses(out.poses, Pose2(out.poses.back().pose), move, spacing_m_, spacing_rad_);
      if (move.direction_B != Vec2{0, 0}) out.length_m += move.amount;
    }
    return out;
  }

  const CostMap& map_;
  GridFrame frame_;
  const Footprint& footprint_;
  const HybridSpec& spec_;
  const std::function<bool(const Pose2&)>& known_;
  Pose2 goal_;
  HybridDistances distances_;
  double spacing_m_, spacing_rad_;
  std::vector<Move> moves_;
  std::vector<Node> nodes_;
  std::unordered_map<std::uint64_t, Bin> bins_;  // looked up, never walked through
  OpenList open_;
  std::vector<PathPose> scratch_;
  int expanded_ = 0;
  double best_price_ = hybrid_never;
  std::uint32_t best_at_ = hybrid_none;
  std::vector<Move> best_moves_;
};

Status hybrid_end(const CostMap& map, const GridFrame& frame, const Footprint& footprint, const Pose2& pose,
                  const char* name) {
  const std::string what = std::string("the ") + name + " " + point_text({pose.x, pose.y});
  if (!is_finite(pose)) return Error{what + " is not a pose", ""};
  switch (footprint_contact(map, frame, footprint, pose)) {
    case Contact::none: return {};
    case Contact::off_map: return Error{what + ": the footprint reaches off the map", ""};
    case Contact::obstacle: break;
  }
  return Error{what + ": the footprint touches an obstacle", "choose another place or heading"};
}

}  // namespace

Result<HybridPlan> plan_hybrid(const CostMap& map, const Footprint& footprint, const HybridSpec& spec,
                               const Pose2& start, const Pose2& goal,
                               const std::function<bool(const Pose2&)>& known) {
  SL_TRY(check_ranges(spec));
  SL_TRY(check_geometry(map.geometry));
  if (map.cost.size() != map.geometry.cells() || map.distance_m.size() != map.geometry.cells())
    return Error{"the cost map does not fit its size", ""};
  if (spec.step_m < 2 * map.geometry.resolution_m)
    return Error{"a step of " + number_text(spec.step_m) + " m is shorter than two cells",
                 "at least " + number_text(2 * map.geometry.resolution_m) + " m"};
  const GridFrame frame(map.geometry);
  SL_TRY(hybrid_end(map, frame, footprint, start, "start"));
  SL_TRY(hybrid_end(map, frame, footprint, goal, "goal"));
  const Pose2 from{start.x, start.y, math::wrap_angle(start.theta)},
      to{goal.x, goal.y, math::wrap_angle(goal.theta)};
  return HybridSearch(map, footprint, spec, to, *frame.cell({to.x, to.y}), known).run(from);
}

}  // namespace sandlot::navigation
