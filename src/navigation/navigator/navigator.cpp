#include "navigation/navigator/navigator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandlot::navigation {
namespace {

constexpr std::array<EnumName<Chassis>, 4> navigator_chassis{
    {{"differential", Chassis::differential},
     {"omni", Chassis::omni},
     {"car", Chassis::car},
     {"four_wheel_steer", Chassis::four_wheel_steer}}};
constexpr std::array<EnumName<NavStatus>, 6> navigator_statuses{{{"idle", NavStatus::idle},
                                                                 {"planning", NavStatus::planning},
                                                                 {"following", NavStatus::following},
                                                                 {"recovering", NavStatus::recovering},
                                                                 {"reached", NavStatus::reached},
                                                                 {"failed", NavStatus::failed}}};
constexpr double navigator_blocked_replan_s = 0.3;  ///< least time between plans because of a blocked way

constexpr double navigator_nearer_m = 0.5;  ///< way to the goal that counts as nearer

}  // namespace

std::span<const EnumName<Chassis>> enum_names(Chassis) { return navigator_chassis; }
std::span<const EnumName<NavStatus>> enum_names(NavStatus) { return navigator_statuses; }

Navigator::Navigator(const NavigatorSpec& spec, const Footprint& footprint, const Footprint& grown)
    : spec_(spec), footprint_(footprint), grown_(grown) {}

Result<Navigator> Navigator::make(const NavigatorSpec& spec, double period_s, std::optional<GridMap> map) {
  SL_TRY(check_ranges(spec));
  SL_TRY(check_ranges(spec.limits));
  SL_TRY(check_ranges(spec.obstacles));
  SL_TRY(check_ranges(spec.tracker));
  SL_TRY(check_ranges(spec.inflation));
  SL_TRY(check_ranges(spec.planner));
  SL_TRY(check_ranges(spec.recovery));
  if (!(period_s >= 0.001 && period_s <= 10))
    return Error{"a period of " + number_text(period_s) + " s", "it must lie in [0.001, 10] s"};
  GridGeometry area;
  if (map) {
    SL_TRY(check_geometry(map->geometry));
    if (map->occupancy.size() != map->geometry.cells())
      return Error{"the map has " + std::to_string(map->occupancy.size()) + " cells of data",
                   "its size says " + std::to_string(map->geometry.cells())};
    area = map->geometry;
  } else {
    const double cells = std::ceil(spec.area_m / spec.resolution_m);
    area.width = area.height = static_cast<int>(std::clamp(cells, 1.0, 1.0 + max_side));
    area.resolution_m = spec.resolution_m;
    SL_TRY(check_geometry(area));
  }
  std::vector<Vec2> corners;
  for (const auto& c : spec.footprint_m) corners.push_back({c[0], c[1]});
  SL_ASSIGN(const Footprint footprint,
            corners.empty() ? Footprint::circle(spec.radius_m) : Footprint::polygon(std::move(corners)));
  // Rollouts look at poses half a cell apart.
  SL_ASSIGN(const Footprint grown, footprint.grown(spec.margin_m + area.resolution_m / 2));

  Navigator out(spec, footprint, grown);
  out.static_ = std::move(map);
  out.area_ = area;
  out.state_.layer.resize(area.cells());
  const NavigatorLimits& l = spec.limits;
  const bool omni = spec.chassis == Chassis::omni;
  out.dwa_ = {.max_vx_mps = l.speed_mps,
              .min_vx_mps = -l.backward_mps,
              .max_vy_mps = omni ? l.sideways_mps : 0,
              .max_w_radps = l.turn_radps,
              .acceleration_mps2 = l.acceleration_mps2,
              .turn_acceleration_radps2 = l.turn_acceleration_radps2,
              .period_s = period_s,
              .horizon_s = std::max(spec.horizon_s, period_s),
              .vx_samples = omni ? 5 : 7,
              .vy_samples = 5,
              .w_samples = omni ? 7 : 15,
              .lookahead_m = spec.lookahead_m,
              .disc_clearance_m = spec.disc_clearance_m,
              .goal_tolerance_m = spec.goal_tolerance_m,
              .goal_tolerance_rad = spec.goal_tolerance_rad};
  out.pursuit_ = {.drive = spec.chassis == Chassis::car ? Drive::car : Drive::omni,
                  .speed_mps = l.speed_mps,
                  .backward_speed_mps = std::max(0.001, l.backward_mps),
                  .sideways_speed_mps = l.sideways_mps,
                  .min_speed_mps = std::min(0.05, l.speed_mps),
                  .acceleration_mps2 = l.acceleration_mps2,
                  .min_lookahead_m = std::min(0.3, spec.lookahead_m),
                  .max_lookahead_m = spec.lookahead_m,
                  .max_turn_rate_radps = l.turn_radps,
                  .turn_acceleration_radps2 = l.turn_acceleration_radps2,
                  .turning_radius_m = spec.turning_radius_m,
                  .goal_tolerance_m = spec.goal_tolerance_m,
                  .goal_tolerance_rad = spec.goal_tolerance_rad};
  const bool steered = spec.chassis == Chassis::four_wheel_steer;
  out.hybrid_ = {.turning_radius_m = spec.turning_radius_m,
                 .backward = l.backward_mps > 0,
                 .sideways = steered,
                 .turn_on_spot = steered,
                 .step_m = std::max(0.3, 2 * area.resolution_m),
                 .goal_tolerance_m = spec.goal_tolerance_m / 2,
                 .goal_tolerance_rad = spec.goal_tolerance_rad / 2,
                 .max_expansions = 20'000};
  // The window holds all that a rollout reaches.
  const double fastest = std::max({l.speed_mps, l.backward_mps, omni ? l.sideways_mps : 0.0});
  out.spec_.window_m = std::max(spec.window_m, 2 * (1.5 * fastest * out.dwa_.horizon_s +
                                                    grown.circumscribed_m() + 4 * area.resolution_m));
  return out;
}

Status Navigator::fail(Error why) {
  state_.status = NavStatus::failed;
  state_.reason = why.what + (why.fix.empty() ? "" : "; " + why.fix);
  state_.plan.clear();
  plan_.clear();
  return why;
}

Status Navigator::set_goal(const NavGoal& goal) {
  NavigatorState& s = state_;
  s.goal_x_m = goal.pose.x, s.goal_y_m = goal.pose.y;
  s.goal_theta_rad = goal.pose.theta, s.goal_heading = goal.heading;
  s.plan.clear();
  s.blocked.clear();
  plan_.clear();
  s.dwa = {}, s.pursuit = {}, s.recovery = {};
  s.failing_s = s.time_s = s.since_plan_s = 0;
  s.recoveries = s.plans = s.vain = 0;
  s.nearest_m = 1e9;
  s.plan_wanted = true;
  s.reason.clear();
  if (!is_finite(goal.pose)) {
    s.goal_x_m = s.goal_y_m = s.goal_theta_rad = 0;
    return fail(Error{"the goal is not a finite pose", "give numbers for x, y and the heading"});
  }
  s.goal_theta_rad = goal.heading ? math::wrap_angle(goal.pose.theta) : 0;
  const Vec2 p{goal.pose.x, goal.pose.y};
  if (static_ || s.placed) {
    if (Status on_map = check_goal_on_map(); !on_map) return fail(on_map.error());
    const GridFrame frame(area_);
    const auto cell = frame.cell(p);
    // Against what stands in the static map: what the laser saw may go away.
    if (static_) {
      const int reach = static_cast<int>(std::ceil(grown_.circumscribed_m() / area_.resolution_m)) + 2;
      const Cell low{std::max(0, cell->x - reach), std::max(0, cell->y - reach)},
          high{std::min(area_.width, cell->x + reach + 1), std::min(area_.height, cell->y + reach + 1)};
      GridMap part{area_, {}};
      part.geometry.width = high.x - low.x, part.geometry.height = high.y - low.y;
      const Vec2 corner = frame.to_map({double(low.x), double(low.y)});
      part.geometry.origin.x = corner.x, part.geometry.origin.y = corner.y;
      for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x)
          part.occupancy.push_back(static_->occupancy[area_.index({x, y})]);
      SL_ASSIGN(const CostMap cost, make_cost_map(part, spec_.inflation, grown_.inscribed_m()));
      if (!nearest_free_cell(cost, p, std::max(spec_.planner.goal_tolerance_m, area_.resolution_m)))
        return fail(Error{"the goal " + point_text(p) + " lies in an obstacle of the map, or too near to one",
                          "choose a free place"});
    }
  }
  s.status = NavStatus::planning;
  return {};
}

Status Navigator::check_goal_on_map() const {
  const Vec2 p{state_.goal_x_m, state_.goal_y_m};
  if (GridFrame(area_).cell(p)) return {};
  return Error{"the goal " + point_text(p) + " is off the map",
               "it covers " + number_text(area_.width * area_.resolution_m) + " x " +
                   number_text(area_.height * area_.resolution_m) + " m from " +
                   point_text({area_.origin.x, area_.origin.y})};
}

void Navigator::cancel() {
  state_.status = NavStatus::idle;
  state_.reason.clear();
  state_.plan.clear();
  plan_.clear();
}

bool Navigator::restore(NavigatorState state) {
  if (state.layer.trust.size() != area_.cells() || state.layer.free.size() != area_.cells() ||
      state.plan.size() > NavigatorState::max_poses)
    return false;
  state_ = std::move(state);
  if (!static_ && state_.placed) area_.origin = {state_.area_x_m, state_.area_y_m, 0};
  plan_.clear();
  for (const PlanPose& p : state_.plan) plan_.push_back({{p.x_m, p.y_m, p.theta_rad}, {p.dx, p.dy}});
  return true;
}

void Navigator::place_area(const Pose2& X) {
  if (!static_) {
    area_.origin = {X.x - area_.width * area_.resolution_m / 2, X.y - area_.height * area_.resolution_m / 2,
                    0};
    state_.area_x_m = area_.origin.x, state_.area_y_m = area_.origin.y;
  }
  state_.placed = true;
}

void Navigator::observe(const NavigatorInput& in, const Pose2& X) {
  // Where the robot was when the scan was taken.
  const PlanarTwist v = in.velocity.value_or(
      PlanarTwist{state_.last_vx_mps, state_.last_vy_mps, state_.last_w_radps});
  const double age = std::clamp(in.scan_age_s, 0.0, 1.0);
  const Pose2 then = driven(X, v, -age);
  mark_scan(spec_.obstacles, area_, state_.layer, *in.scan, in.X_BL, then, footprint_.inscribed_m());
  take_echoes(*in.scan, in.X_BL, then, spec_.obstacles.max_range_m, echoes_);
  update(spec_.tracker, state_.tracker, echoes_);
}

GridMap Navigator::obstacles(Cell corner, int width, int height, bool with_moving) const {
  const GridFrame frame(area_);
  GridMap out{area_, {}};
  out.geometry.width = width, out.geometry.height = height;
  const Vec2 origin = frame.to_map({double(corner.x), double(corner.y)});
  out.geometry.origin.x = origin.x, out.geometry.origin.y = origin.y;
  out.occupancy.resize(out.geometry.cells());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (state_.layer.trust[area_.index({corner.x + x, corner.y + y})] > 0)
        out.occupancy[out.geometry.index({x, y})] = 100;
  // What moves will not be there any more when the robot comes by.
  if (!with_moving) {
    const GridFrame part(out.geometry);
    for (const MovingDisc& disc : discs_) {
      const Vec2 g = part.to_grid(disc.centre_M);
      const double reach = disc.radius_m / area_.resolution_m + 1.5;
      for (int y = std::max(0, int(std::floor(std::clamp(g.y - reach, -1.0, 1e6))));
           y <= std::min(height - 1, int(std::clamp(g.y + reach, -1.0, 1e6))); ++y)
        for (int x = std::max(0, int(std::floor(std::clamp(g.x - reach, -1.0, 1e6))));
             x <= std::min(width - 1, int(std::clamp(g.x + reach, -1.0, 1e6))); ++x)
          if (math::hypot(x + 0.5 - g.x, y + 0.5 - g.y) <= reach)
            out.occupancy[out.geometry.index({x, y})] = 0;
    }
  }
  if (static_)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::int8_t known = static_->occupancy[area_.index({corner.x + x, corner.y + y})];
        std::int8_t& cell = out.occupancy[out.geometry.index({x, y})];
        if (cell == 0) cell = known;
      }
  return out;
}

Status Navigator::rebuild_local(const Pose2& X) {
  const GridFrame frame(area_);
  const auto cell = frame.cell({X.x, X.y});
  if (!cell) return Error{"the robot at " + point_text({X.x, X.y}) + " is off the map", ""};
  const int half = static_cast<int>(std::min(spec_.window_m / 2 / area_.resolution_m, double{max_side})) + 1;
  const Cell low{std::max(0, cell->x - half), std::max(0, cell->y - half)},
      high{std::min(area_.width, cell->x + half + 1), std::min(area_.height, cell->y + half + 1)};
  SL_ASSIGN(local_, make_cost_map(obstacles(low, high.x - low.x, high.y - low.y, true), spec_.inflation,
                                  grown_.inscribed_m()));
  return {};
}

NavigatorStep Navigator::step(const NavigatorInput& in) {
  NavigatorStep out;
  NavigatorState& s = state_;
  const auto finish = [&](const PlanarTwist& command) {
    s.last_vx_mps = command.vx_mps, s.last_vy_mps = command.vy_mps, s.last_w_radps = command.w_radps;
    out.command = command;
    out.status = s.status;
    out.feedback.navigation_time_s = s.time_s;
    out.feedback.number_of_recoveries = s.recoveries;
    return out;
  };
  local_plan_.clear();
  decay(spec_.obstacles, s.layer, in.dt_s);
  predict(spec_.tracker, s.tracker, in.dt_s);
  const bool active = s.status == NavStatus::planning || s.status == NavStatus::following ||
                      s.status == NavStatus::recovering;
  if (active) s.time_s += in.dt_s;
  const bool known = in.X_MB && is_finite(*in.X_MB) && in.pose_std_m <= spec_.max_pose_std_m;
  if (active && s.time_s > spec_.time_limit_s) {
    (void)fail(Error{"the goal was not reached within " + number_text(spec_.time_limit_s) + " s",
                     known ? s.reason : "the pose is not known well enough"});
    return finish({});
  }
  if (!known) {
    if (active) s.reason = in.X_MB ? "the pose is not certain enough" : "there is no pose";
    return finish({});
  }
  const Pose2 X = *in.X_MB;
  if (!s.placed) {
    place_area(X);
    if (Status on_map = check_goal_on_map(); active && !on_map) {
      (void)fail(on_map.error());
      return finish({});
    }
  }
  mark_driven(X);
  if (in.scan) observe(in, X);
  moving_discs(s.tracker, discs_);
  if (!active) {
    if (local_.cost.empty()) (void)rebuild_local(X);
    return finish({});
  }
  if (Status local = rebuild_local(X); !local) {
    (void)fail(local.error());
    return finish({});
  }
  const PlanarTwist velocity = in.velocity.value_or(
      PlanarTwist{s.last_vx_mps, s.last_vy_mps, s.last_w_radps});

  // Plans: wanted, at the rate, or because the way is blocked.
  s.since_plan_s += in.dt_s;
  bool failing = false;
  if (s.recovery.stage == RecoveryStage::watching) {
    const auto block = blocked_pose();
    const bool blocked = plan_.empty() || block;
    const bool hybrid = !by_dwa();
    if (s.plan_wanted || (blocked && s.since_plan_s >= navigator_blocked_replan_s) ||
        (!hybrid && s.since_plan_s * spec_.plan_rate_hz >= 1)) {
      if (block) note_blocked(*block);
      const std::uint32_t before = s.plans;
      const Status planned = make_plan(X);
      out.new_plan = planned && s.plans != before;
      if (!planned) {
        s.reason = planned.error().what;
        // An old way that is free still leads on.
        if (blocked) plan_.clear(), s.plan.clear();
      } else {
        s.reason.clear();
      }
    }
    failing = plan_.empty();
  }

  PlanarTwist command;
  const Footprint outline = fitting_footprint(X);
  if (s.recovery.stage == RecoveryStage::watching && !plan_.empty()) {
    bool arrived = false;
    if (by_dwa()) {
      DwaSpec dwa = dwa_;
      if (!s.goal_heading) dwa.goal_tolerance_rad = math::pi;
      DwaStep step = choose_velocity(dwa, s.dwa, local_, outline, plan_, X, velocity, discs_);
      // Not blindly backwards or to the side: it turns there first.
      if ((step.command.vx_mps < 0 || step.command.vy_mps != 0) && !motion_known(X, step.command)) {
        dwa.min_vx_mps = dwa.max_vy_mps = 0;
        step = choose_velocity(dwa, s.dwa, local_, outline, plan_, X, velocity, discs_);
      }
      arrived = step.status == Driving::arrived;
      command = within_limits(step.command);
      if (step.status == Driving::blocked) failing = true, s.reason = "no velocity is free of contacts";
      if (step.status == Driving::lost)
        failing = s.plan_wanted = true, s.reason = "the robot has left its plan";
    } else {
      const bool touching = footprint_contact(local_, GridFrame(local_.geometry), footprint_, X) !=
                            Contact::none;
      const Footprint& checked = touching ? outline : footprint_;
      const PursuitState before = s.pursuit;
      PursuitStep step = pursue(pursuit_, s.pursuit, plan_, X, &local_, in.dt_s);
      // The way to the point pursued cuts corners of the plan: where that would touch something, a nearer one is pursued.
      if (!command_safe(checked, X, step.command)) {
        PursuitSpec near = pursuit_;
        near.min_lookahead_m = near.max_lookahead_m = std::max(0.1, 2 * area_.resolution_m);
        PursuitState state = before;
        const PursuitStep nearer = pursue(near, state, plan_, X, &local_, in.dt_s);
        if (command_safe(checked, X, nearer.command)) step = nearer, s.pursuit = state;
      }
      arrived = step.status == Following::arrived;
      command = step.command;
      if (step.status == Following::missed || step.status == Following::lost)
        failing = s.plan_wanted = true, s.reason = "the robot has left its plan";
      // What the plan crossed blindly may have gone out of memory, or the robot off its plan.
      const bool blind = command.vx_mps < 0 || std::abs(command.vy_mps) > std::abs(command.vx_mps);
      if (blind && !motion_known(X, command, area_.resolution_m)) {
        command = {};
        failing = s.plan_wanted = true;
        s.pursuit.speed_mps = 0;
        s.reason = "it is not known whether the way backward or sideways is free";
      }
      for (int k = 0; k < 3 && !command_safe(checked, X, command); ++k) {
        command = {command.vx_mps / 2, command.vy_mps / 2, command.w_radps / 2};
        if (k < 2) continue;
        command = {};
        failing = true;
        s.pursuit.speed_mps = 0;
        s.reason = "an obstacle is in the way";
      }
    }
    if (arrived) {
      s.status = NavStatus::reached;
      s.reason.clear();
      return finish({});
    }
  }

  // Recovery: after `patience` without a way or a velocity, or without progress.
  s.failing_s = failing ? s.failing_s + in.dt_s : 0;
  const std::int32_t round = s.recovery.round;
  const bool can_turn = spec_.chassis != Chassis::car;
  RecoverySpec recovery = spec_.recovery;
  if (!can_turn) recovery.turn_rad = 0;
  recovery.turn_radps = std::min(recovery.turn_radps, spec_.limits.turn_radps);
  const RecoveryStep step = recover(recovery, s.recovery, local_, outline, X, s.failing_s > spec_.patience_s,
                                    in.dt_s, [this](const Pose2& there) { return pose_known(there); });
  if (s.recovery.round > round) {
    ++s.recoveries, ++s.vain, s.failing_s = 0;
    note_stuck();
  }
  // A robot that backs up and comes again moves on, but to no end.
  if (const double rest = remaining(X); !plan_.empty() && rest < s.nearest_m - navigator_nearer_m)
    s.nearest_m = rest, s.vain = 0;
  // What is at arm's length may be out of sight, and the robot backs up next.
  if (step.clear_map)
    clear_near(area_, s.layer, {X.x, X.y}, spec_.window_m / 2,
               grown_.circumscribed_m() + recovery.back_up_m + 2 * area_.resolution_m);
  if (step.plan_again) {
    s.plan_wanted = true;
    // What leads a car to the same place again is no way, though it looks free.
    if (!by_dwa()) plan_.clear(), s.plan.clear();
  }
  if (step.stage == RecoveryStage::given_up || s.vain > 2 * static_cast<std::uint32_t>(recovery.rounds)) {
    (void)fail(Error{s.reason.empty() ? "the robot gets no further" : s.reason,
                     "given up after " + std::to_string(s.recoveries) + " recoveries"});
    return finish({});
  }
  if (step.stage != RecoveryStage::watching || step.plan_again)
    command = nears_disc(X, step.command) ? PlanarTwist{} : step.command;
  s.status = step.stage != RecoveryStage::watching ? NavStatus::recovering
             : plan_.empty()                       ? NavStatus::planning
                                                   : NavStatus::following;

  const double speed = math::hypot(command.vx_mps, command.vy_mps), share = std::min(1.0, in.dt_s / 3);
  s.speed_mps += share * (speed - s.speed_mps);
  out.feedback.distance_remaining_m = remaining(X);
  out.feedback.estimated_time_remaining_s = out.feedback.distance_remaining_m /
                                            std::max(s.speed_mps, 0.1 * spec_.limits.speed_mps);
  for (int k = 1; k <= 16; ++k) local_plan_.push_back(driven(X, command, dwa_.horizon_s * k / 16));
  return finish(command);
}

}  // namespace sandlot::navigation
