/// The controller localise in a world: a kidnapped robot, other numbers of threads, snapshots, and that no truth is read.
#include <gtest/gtest.h>

#include "controllers/localise/localise.h"
#include "sim/load/load.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot::test {
namespace {

/// The flat with a rover that wanders in it, and a filter that begins all over it.
model::Setup flat(std::uint64_t seed) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.seed = seed;
  auto setup = load("scenarios/office_localise.yaml", options, diagnostics);
  EXPECT_TRUE(setup) << setup.error().text();
  return std::move(*setup);
}

double filter_value(const Simulation& simulation, const std::string& name) {
  auto found = NamedValue::find(simulation, name);
  EXPECT_TRUE(found) << name;
  return found ? found->read().value_or(NAN) : NAN;
}

struct Errors {
  double position_m, heading_rad;
  double deviation_m, deviation_rad;  ///< what the filter says of its own
};
Errors errors(const Simulation& simulation) {
  const auto* const topic = topic_cast<msg::PoseWithCovarianceStamped>(
      simulation.find_topic("/rover/localiser/amcl_pose"));
  const Pose X_MB = topic->message.pose.pose;
  const Pose truth = simulation.engine().pose(*simulation.find_instance("rover"));
  const auto& P = topic->message.pose.covariance;
  return {math::hypot(X_MB.p.x - truth.p.x, X_MB.p.y - truth.p.y),
          std::abs(math::wrap_angle(yaw_of(X_MB.q) - yaw_of(truth.q))), std::sqrt(P[0] + P[7]),
          std::sqrt(P[35])};
}

TEST(LocaliseInAWorld, GoesOnFromASnapshotToTheBitOnOneAndMoreThreads) {
  const auto whole = build(flat(1));
  advance(*whole, 333);
  const auto one = again(*whole), three = again(*whole, {.threads = 3});
  advance(*whole, 500), advance(*one, 500), advance(*three, 500);
  EXPECT_GT(filter_value(*whole, "rover/localiser.filter.counts[0]"), 5) << "scans were used";
  EXPECT_EQ(one->state_hash(), whole->state_hash());
  EXPECT_EQ(three->state_hash(), whole->state_hash());
  EXPECT_EQ(by_path(*one), by_path(*whole));
}

/// Without the device that measures the truth every estimate is the same.
TEST(LocaliseInAWorld, ReadsNoTruth) {
  const auto with = build(flat(2));
  model::Setup setup = flat(2);
  for (model::Instance& instance : setup.instances)
    for (std::size_t i = instance.devices.size(); i-- > 0;)
      if (std::as_const(instance.devices)[i].kind == "ground_truth") instance.devices.erase(i);
  const auto without = build(std::move(setup));
  ASSERT_EQ(without->find_topic("/rover/truth"), nullptr);
  const auto pose = [](const Simulation& simulation) {
    return topic_cast<msg::PoseWithCovarianceStamped>(simulation.find_topic("/rover/localiser/amcl_pose"));
  };
  for (int i = 0; i < 10; ++i) {
    advance(*with, 100), advance(*without, 100);
    ASSERT_EQ(pose(*with)->message.pose.pose, pose(*without)->message.pose.pose) << i;
    ASSERT_EQ(pose(*with)->message.pose.covariance, pose(*without)->message.pose.covariance) << i;
  }
}

/// It finds itself from anywhere in a minute, is carried to another room, and finds itself again. When it has, the error is
/// that of the map, in which a surface may be half a cell's diagonal from where it is (0.05 / sqrt(2) = 0.036 m), and five
/// of the deviations that the filter says; and that is sure of itself: 0.15 m (the scenario's sigma_hit of 0.1 m on both axes)
/// and 0.1 rad at most.
TEST(SlowLocaliseInAWorld, FindsAKidnappedRobot) {
  const Pose rooms[] = {{{10.4, 2.4, 0}, quat_from_rpy(0, 0, 1.6)},
                        {{2.6, 6.4, 0}, quat_from_rpy(0, 0, -2)},
                        {{10.6, 6.6, 0}, quat_from_rpy(0, 0, 3)},
                        {{3.6, 2.6, 0}, quat_from_rpy(0, 0, 0.4)},
                        {{5.4, 6.3, 0}, quat_from_rpy(0, 0, -1)}};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    const auto simulation = build(flat(seed));
    const auto is_found = [&] {
      const Errors e = errors(*simulation);
      std::printf("seed %d, %g s: %.3f m (%.3f), %.3f rad (%.3f)\n", static_cast<int>(seed),
                  simulation->now().s(), e.position_m, e.deviation_m, e.heading_rad, e.deviation_rad);
      EXPECT_LT(e.deviation_m, 0.15);
      EXPECT_LT(e.deviation_rad, 0.1);
      EXPECT_LT(e.position_m, 0.036 + 5 * e.deviation_m);
      EXPECT_LT(e.heading_rad, 5 * e.deviation_rad);
    };
    advance(*simulation, 6000);
    is_found();
    simulation->submit(PoseRequest{"rover", rooms[seed - 1]});
    advance(*simulation, 1);
    ASSERT_TRUE(simulation->outcomes().front().status);
    EXPECT_GT(errors(*simulation).position_m, 1) << "it does not know yet";
    advance(*simulation, 9000);
    is_found();
    EXPECT_GT(filter_value(*simulation, "rover/localiser.filter.injected"), 0)
        << "by particles from all over the map";
  }
}

}  // namespace
}  // namespace sandlot::test
