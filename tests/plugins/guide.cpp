/// What a page draws, from a program that knows no more than its keys: a map, a plan, particles and estimates; and a reader of goals. With
/// `bad` they are what no page can draw.
#include "control/plugin.h"

#include <limits>
#include <string>

#include "base/math.h"
#include "messages/diagnostic_msgs.h"

namespace {

namespace msg = sandlot::msg;
using sandlot::Field;

/// Map: `side` cells of 5 cm a side about the world's origin, with a wall around, a ramp of costs and a corner that is unknown. Plan: from
/// the robot's beginning 2 m ahead and 1 m to the left, in `odom`. Particles about (1, 1) in `map`. Estimate: at (2, 1) in `odom`, with
/// deviations of 0.5 m along the diagonal and 0.1 m across.
struct Guide {
  struct Spec {
    int side = 80;
    double period_s = 1;
    bool bad = false;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"side", "1", "Cells of a side of the map.", 0, 20000}, s.side);
      visit(Field{"period", "s", "Between two maps.", 0.01, 1e6}, s.period_s);
      visit(Field{"bad", "", "Publish what cannot be drawn.", 0, 1, Field::tunable}, s.bad);
    }
  };
  struct State {
    double x = 0, y = 0, yaw = 0, first_x = 0, next_s = 0;
    std::int64_t goals = 0, firsts = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"x", "m", "Of the last goal."}, s.x);
      visit(Field{"y", "m", "Of the last goal."}, s.y);
      visit(Field{"yaw", "rad", "Of the last goal."}, s.yaw);
      visit(Field{"first_x", "m", "Of the last initial pose."}, s.first_x);
      visit(Field{"next", "s", "When the next map is due."}, s.next_s);
      visit(Field{"goals", "1", "Goals so far."}, s.goals);
      visit(Field{"firsts", "1", "Initial poses so far."}, s.firsts);
    }
  };
  Spec spec;
  State state;
  sandlot::Subscription<msg::PoseStamped> goal;
  sandlot::Subscription<msg::PoseWithCovarianceStamped> first;
  sandlot::Publication<msg::OccupancyGrid> map;
  sandlot::Publication<msg::Path> plan;
  sandlot::Publication<msg::PoseArray> particles;
  sandlot::Publication<msg::Odometry> estimate;
  sandlot::Publication<msg::PoseWithCovarianceStamped> fix;
  sandlot::Publication<msg::DiagnosticStatus> status;

  sandlot::Status init(const sandlot::Description&, sandlot::Outputs& out) {
    goal = out.subscribe<msg::PoseStamped>("goal_pose");
    first = out.subscribe<msg::PoseWithCovarianceStamped>("initialpose");
    map = out.publish<msg::OccupancyGrid>("map");
    plan = out.publish<msg::Path>("plan");
    particles = out.publish<msg::PoseArray>("particles");
    estimate = out.publish<msg::Odometry>("estimate");
    fix = out.publish<msg::PoseWithCovarianceStamped>("fix");
    status = out.publish<msg::DiagnosticStatus>("status");
    return {};
  }

  void step(const sandlot::Observation& obs, sandlot::Command& cmd) {
    if (const auto got = obs.get(goal); got.fresh) {
      const auto& q = got.message.pose.q;
      state.x = got.message.pose.p.x;
      state.y = got.message.pose.p.y;
      state.yaw = 2 * sandlot::math::atan2(q.z, q.w);
      ++state.goals;
      msg::DiagnosticStatus refusal;
      refusal.level = msg::DiagnosticStatus::error;
      refusal.message = "failed: goal " + std::to_string(state.goals) + " is in a wall";
      cmd.publish(status, refusal);
    }
    if (const auto got = obs.get(first); got.fresh) {
      state.first_x = got.message.pose.pose.p.x;
      ++state.firsts;
    }
    const double now_s = obs.now().s();
    if (now_s < state.next_s) return;
    state.next_s = now_s + spec.period_s;
    const sandlot::msg::Header in_map{obs.now(), "map"}, in_odom{obs.now(), "odom"};
    cmd.publish(map, made_map(in_map, static_cast<int>(now_s / spec.period_s)));
    msg::Path way;
    way.header = in_odom;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}}) {
      way.poses.emplace_back().header = in_odom;
      way.poses.back().pose.p = {x, y, 0};
    }
    if (spec.bad) way.poses[1].pose.p.x = std::numeric_limits<double>::quiet_NaN();
    cmd.publish(plan, way);
    msg::PoseArray cloud;
    cloud.header = in_map;
    for (int i = 0; i < 200; ++i)
      cloud.poses.push_back({{1 + 0.02 * (i % 15 - 7), 1 + 0.02 * (i / 15 - 7), 0},
                             sandlot::quat_from_axis_angle({0, 0, 1}, 0.05 * (i % 7 - 3))});
    if (spec.bad) cloud.poses[3].p.y = std::numeric_limits<double>::infinity();
    cmd.publish(particles, cloud);
    msg::Odometry here;
    here.header = in_odom;
    here.pose.pose.p = {2, 1, 0};
    here.pose.covariance[0] = here.pose.covariance[7] = 0.13;  // (0.25 + 0.01) / 2
    here.pose.covariance[1] = here.pose.covariance[6] = 0.12;  // (0.25 - 0.01) / 2
    here.pose.covariance[35] = 0.04;
    if (spec.bad) here.pose.covariance[0] = std::numeric_limits<double>::quiet_NaN();
    cmd.publish(estimate, here);
    msg::PoseWithCovarianceStamped found;
    found.header = in_map;
    found.pose.pose.p = {1, 1, 0};
    found.pose.covariance[0] = found.pose.covariance[7] = spec.bad ? -0.01 : 0.01;
    cmd.publish(fix, found);
  }

  /// @param turn  moves one block, so that each map differs from the last one
  msg::OccupancyGrid made_map(const msg::Header& header, int turn) const {
    msg::OccupancyGrid made;
    made.header = header;
    const auto side = static_cast<std::uint32_t>(spec.bad ? 0 : spec.side);
    made.info = {{}, 0.05f, side, side, {{-0.025 * side, -0.025 * side, 0}, {}}};
    made.data.resize(std::size_t{side} * side);
    const auto n = static_cast<int>(side);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const bool wall = x == 0 || y == 0 || x == n - 1 || y == n - 1;
        const bool block = y == n / 2 && x == turn % std::max(n, 1);
        const bool unknown = x > 3 * n / 4 && y > 3 * n / 4, ramp = y < n / 4;
        std::int8_t& occupied = made.data[static_cast<std::size_t>(y * n + x)];
        if (ramp) occupied = static_cast<std::int8_t>(99 * x / n);
        if (unknown) occupied = -1;
        if (wall || block) occupied = 100;
      }
    return made;
  }
};

constexpr sandlot::ControllerKind guide = sandlot::make_controller<Guide>(
    {.name = "guide", .help = "Publishes a map, a plan and estimates; reads goals."});

}  // namespace

SANDLOT_PLUGIN("test_guide", &guide)
