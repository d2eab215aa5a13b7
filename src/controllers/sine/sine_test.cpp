#include "controllers/sine/sine.h"

#include <gtest/gtest.h>

namespace sandlot::controllers::sine {
namespace {

Description three_motors() {
  Description robot;
  robot.robot = "snake";
  const char* const number = msg::Float64::ros_type;
  robot.actuators = {{"a", "", number, 0, {}}, {"a", "position", number, 1, {}},
                     {"b", "", number, 2, {}}, {"drive", "", msg::Twist::ros_type, 3, {}},
                     {"c", "", number, 4, {}}, {"c", "velocity", number, 5, {}}};
  return robot;
}

/// (slot, value) of what it orders at a time.
std::vector<std::pair<std::uint32_t, double>> orders_at(Sine& controller, double now_s) {
  const Observation obs(Time::from_s(now_s), {}, {}, Stream(1, 2, Purpose::controller, 3));
  Command cmd;
  controller.step(obs, cmd);
  std::vector<std::pair<std::uint32_t, double>> given;
  for (const Command::Order& order : cmd.orders()) {
    ByteReader r(cmd.bytes(order));
    msg::Float64 number;
    read(r, number);
    given.emplace_back(order.slot, number.data);
  }
  return given;
}

TEST(Sine, EachMotorFollowsTheOneBeforeIt) {
  Sine controller;
  controller.spec.period_s = 2;
  controller.spec.amplitude = 0.5;
  controller.spec.phase_shift_rad = math::pi / 2;
  controller.spec.offsets = {0, 1, 0};
  controller.spec.amplitudes = {1, 1, -2};
  ASSERT_TRUE(static_cast<bool>(controller.init(three_motors())));
  for (const double t : {5.0, 5.1, 5.75, 6.5, 9.2}) {  // its time starts at 5 s
    const auto given = orders_at(controller, t);
    ASSERT_EQ(given.size(), 3u);
    const double phase = math::pi * (t - 5);
    EXPECT_EQ(given[0].first, 0u) << "the entry that follows the active level";
    EXPECT_NEAR(given[0].second, 0.5 * math::sin(phase), 1e-12);
    EXPECT_EQ(given[1].first, 2u);
    EXPECT_NEAR(given[1].second, 1 + 0.5 * math::sin(phase - math::pi / 2), 1e-12);
    EXPECT_EQ(given[2].first, 4u);
    EXPECT_NEAR(given[2].second, -1.0 * math::sin(phase - math::pi), 1e-12);
  }
}

TEST(Sine, ANewPeriodGoesOnFromThePhaseOfNow) {
  Sine controller;
  controller.spec.period_s = 4;
  controller.spec.motors = {"b"};
  ASSERT_TRUE(static_cast<bool>(controller.init(three_motors())));
  (void)orders_at(controller, 0);
  EXPECT_NEAR(orders_at(controller, 1)[0].second, 1, 1e-12);  // a quarter
  controller.spec.period_s = 8;
  EXPECT_NEAR(orders_at(controller, 3)[0].second, 0, 1e-12);  // and another one, now of 8 s
}

TEST(Sine, OtherShapes) {
  Sine controller;
  controller.spec.period_s = 1;
  controller.spec.motors = {"a", "c"};
  controller.spec.phases_rad = {0, math::pi};
  controller.spec.phase_shift_rad = 0;
  controller.spec.shape = Shape::triangle;
  ASSERT_TRUE(static_cast<bool>(controller.init(three_motors())));
  const double triangle[] = {0, 0.5, 1, 0.5, 0, -0.5, -1, -0.5};  // every eighth of a period
  for (int k = 0; k < 8; ++k) {
    const auto given = orders_at(controller, k / 8.0);
    EXPECT_NEAR(given[0].second, triangle[k], 1e-12) << k;
    EXPECT_NEAR(given[1].second, -triangle[k], 1e-12) << k;
  }
  controller.spec.shape = Shape::pulse;
  controller.spec.width = 0.2;
  EXPECT_EQ(orders_at(controller, 1.1)[0].second, 1);
  EXPECT_EQ(orders_at(controller, 1.3)[0].second, -1);
}

TEST(Sine, RefusesWhatItCannotMove) {
  const auto complaint = [](const Spec& spec, const Description& robot) {
    Sine controller;
    controller.spec = spec;
    const Status ready = controller.init(robot);
    return ready ? "" : ready.error().path + ": " + ready.error().what;
  };
  EXPECT_NE(complaint({.motors = {"a", "x"}}, three_motors()).find("/motors: "), std::string::npos);
  EXPECT_NE(complaint({.motors = {"drive"}}, three_motors()).find("/motors: "), std::string::npos);
  EXPECT_EQ(complaint({.offsets = {1, 2}}, three_motors()), "/offsets: 'offsets' has 2 values for 3 motors");
  EXPECT_EQ(complaint({}, {}), ": robot '' has no device that takes a number");
}

}  // namespace
}  // namespace sandlot::controllers::sine
