/// Plans of the navigator: which way it takes, and when it leaves one for another.
#include <algorithm>
#include <cmath>

#include "navigation/navigator/navigator.h"

namespace sandlot::navigation {
namespace {

constexpr double navigator_gap_m = 0.3;  ///< distance within which places that are blocked are the same

double navigator_length(std::span<const PathPose> path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    length += math::hypot(path[i].pose.x - path[i - 1].pose.x, path[i].pose.y - path[i - 1].pose.y);
  return length;
}

}  // namespace

void Navigator::set_plan(std::vector<PathPose> path) {
  if (path.size() > NavigatorState::max_poses) path.resize(NavigatorState::max_poses);
  plan_ = std::move(path);
  state_.plan.clear();
  for (const PathPose& p : plan_)
    state_.plan.push_back({p.pose.x, p.pose.y, p.pose.theta, p.direction_B.x, p.direction_B.y});
  state_.dwa = {};
  state_.pursuit = {.speed_mps = state_.pursuit.speed_mps};
}

Result<std::vector<PathPose>> Navigator::grid_path(CostMap map, const Pose2& X) {
  const Vec2 goal{state_.goal_x_m, state_.goal_y_m};
  const auto closed = [](const BlockedPlace& b) { return b.times >= 2; };
  std::optional<Result<GridPlan>> plan;
  if (std::any_of(state_.blocked.begin(), state_.blocked.end(), closed)) {
    const GridFrame frame(map.geometry);
    std::vector<std::uint8_t> open = map.cost;
    const int reach = static_cast<int>(std::ceil(0.5 * navigator_gap_m / area_.resolution_m));
    for (const BlockedPlace& b : state_.blocked) {
      const auto cell = frame.cell({b.x_m, b.y_m});
      if (!cell || !closed(b)) continue;
      for (int y = std::max(0, cell->y - reach); y <= std::min(area_.height - 1, cell->y + reach); ++y)
        for (int x = std::max(0, cell->x - reach); x <= std::min(area_.width - 1, cell->x + reach); ++x) {
          std::uint8_t& cost = map.cost[map.geometry.index({x, y})];
          cost = std::max(cost, inscribed_cost);
        }
    }
    plan = plan_grid(map, spec_.planner, {X.x, X.y}, goal);
    // Without another way, gaps are tried again.
    if (!*plan) {
      map.cost = std::move(open);
      state_.blocked.clear();
      plan.reset();
    }
  }
  if (!plan) plan = plan_grid(map, spec_.planner, {X.x, X.y}, goal);
  if (!*plan) return plan->error();
  std::vector<PathPose> path = path_through((*plan)->points, std::max(area_.resolution_m, 0.05));
  if (path.empty()) path.push_back({{goal.x, goal.y, X.theta}});
  return path;
}

Status Navigator::make_plan(const Pose2& X) {
  ++state_.plans;
  state_.since_plan_s = 0;
  state_.plan_wanted = false;
  SL_ASSIGN(CostMap map, make_cost_map(obstacles({0, 0}, area_.width, area_.height, false), spec_.inflation,
                                       grown_.inscribed_m()));
  std::vector<PathPose> path;
  const Pose2 goal{state_.goal_x_m, state_.goal_y_m, state_.goal_theta_rad};
  if (by_dwa()) {
    SL_ASSIGN(path, grid_path(std::move(map), X));
  } else {
    // Without a heading of its own, the goal is faced as it is seen from here.
    Pose2 end = goal;
    if (!state_.goal_heading && math::hypot(goal.x - X.x, goal.y - X.y) > 1e-6)
      end.theta = math::atan2(goal.y - X.y, goal.x - X.x);
    const bool touching = footprint_contact(map, GridFrame(map.geometry), grown_, X) != Contact::none;
    SL_ASSIGN(HybridPlan plan, plan_hybrid(map, touching ? footprint_ : grown_, hybrid_, X, end,
                                           [this](const Pose2& there) { return pose_known(there); }));
    path = std::move(plan.poses);
  }
  if (state_.goal_heading && by_dwa()) {
    PathPose last = path.back();
    last.pose.theta = goal.theta;
    path.push_back(last);
  }
  // A new way for a free old one only if it is clearly shorter.
  if (!plan_.empty() && !blocked_pose() && navigator_length(path) > 0.9 * remaining(X)) return {};
  set_plan(std::move(path));
  return {};
}

std::optional<Pose2> Navigator::blocked_pose() const {
  const GridFrame frame(local_.geometry);
  const std::size_t at = by_dwa() ? state_.dwa.at : state_.pursuit.at;
  for (std::size_t i = at + 1; i < plan_.size(); ++i) {
    const Pose2& p = plan_[i].pose;
    const auto cell = frame.cell({p.x, p.y});
    if (!cell) break;
    // A rim of a cell: the robot may be as far beside its plan, and what it covers then is known.
    const bool blocked = by_dwa()
                             ? local_.cost[local_.geometry.index(*cell)] >= inscribed_cost
                             : footprint_contact(local_, frame, footprint_, p) == Contact::obstacle ||
                                   (is_blind(plan_[i].direction_B) && !pose_known(p, area_.resolution_m));
    if (blocked) return p;
  }
  return {};
}

void Navigator::note_blocked(const Pose2& at) {
  // What moves leaves again.
  for (const MovingDisc& disc : discs_)
    if (math::hypot(disc.centre_M.x - at.x, disc.centre_M.y - at.y) < disc.radius_m + navigator_gap_m) return;
  for (BlockedPlace& b : state_.blocked)
    if (math::hypot(b.x_m - at.x, b.y_m - at.y) <= navigator_gap_m) {
      ++b.times;
      return;
    }
  if (state_.blocked.size() < NavigatorState::max_blocked) state_.blocked.push_back({at.x, at.y, 1});
}

void Navigator::note_stuck() {
  const std::size_t at = state_.dwa.at;
  double along = 0;
  for (std::size_t i = at + 1; i < plan_.size() && along < spec_.lookahead_m; ++i) {
    if (footprint_contact(local_, GridFrame(local_.geometry), grown_, plan_[i].pose) != Contact::none)
      return note_blocked(plan_[i].pose);
    along += navigator_length(std::span(plan_).subspan(i - 1, 2));
  }
}

double Navigator::remaining(const Pose2& X) const {
  const std::size_t at = by_dwa() ? state_.dwa.at : state_.pursuit.at;
  if (plan_.empty() || at >= plan_.size()) return math::hypot(state_.goal_x_m - X.x, state_.goal_y_m - X.y);
  return navigator_length(std::span(plan_).subspan(at)) +
         math::hypot(plan_[at].pose.x - X.x, plan_[at].pose.y - X.y);
}

}  // namespace sandlot::navigation
