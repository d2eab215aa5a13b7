#include "kinematics/wheels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "base/random.h"
#include "kinematics/ackermann.h"
#include "kinematics/kabsch.h"
#include "kinematics/skid.h"
#include "kinematics/swerve.h"

namespace sandlot::kinematics {
namespace {

void expect_motion(const PlanarMotion& got, const PlanarMotion& want, double tolerance) {
  EXPECT_NEAR(got.x, want.x, tolerance);
  EXPECT_NEAR(got.y, want.y, tolerance);
  EXPECT_NEAR(got.turn, want.turn, tolerance);
}
PlanarMotion any_motion(Stream& random) {
  const double x = random.uniform(-3, 3), y = random.uniform(-3, 3);
  return {x, y, random.uniform(-5, 5)};
}

TEST(Wheels, ForwardUndoesInverseOnAnyGeometry) {
  Stream random(1, 1, Purpose::experiment, 0);
  for (int round = 0; round < 500; ++round) {
    const int n = 3 + static_cast<int>(random.uniform() * 5);
    std::vector<Wheel> wheels;
    for (int i = 0; i < n; ++i) {
      const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), r = random.uniform(0.02, 0.3);
      const double heading = random.uniform(-math::pi, math::pi),
                   roller = random.uniform(0.3, math::pi - 0.3);
      wheels.push_back(roller_wheel(x, y, r, heading, roller));
    }
    if (!check(wheels)) continue;
    const PlanarMotion wanted = any_motion(random);
    std::vector<double> turns(wheels.size());
    wheel_turns(wheels, wanted, turns);
    const Estimate back = chassis_motion(wheels, turns);
    // check() passes conditions of up to 1e6 of the normal matrix.
    expect_motion(back.motion, wanted, 1e-8);
    EXPECT_NEAR(back.residual, 0, 1e-9);
  }
}

TEST(Wheels, MecanumHasTheSignsOfTheClosedFormAndASpinSpins) {
  // a = half the wheelbase 0.3, b = half the track 0.2, r = 0.1. At vx = 1, vy = 0.5, w = 2: (a + b) w = 1.
  const std::vector<Wheel> wheels = mecanum_wheels(0.6, 0.4, 0.1);
  ASSERT_TRUE(check(wheels));
  std::vector<double> turns(4);
  wheel_turns(wheels, {1, 0.5, 2}, turns);
  EXPECT_NEAR(turns[0], (1 - 0.5 - 1) / 0.1, 1e-12);  // FL
  EXPECT_NEAR(turns[1], (1 + 0.5 + 1) / 0.1, 1e-12);  // FR
  EXPECT_NEAR(turns[2], (1 + 0.5 - 1) / 0.1, 1e-12);  // BL
  EXPECT_NEAR(turns[3], (1 - 0.5 + 1) / 0.1, 1e-12);  // BR
  // Spin: FL -, FR +, BL -, BR +; and those speeds give that spin and nothing else.
  wheel_turns(wheels, {0, 0, 2}, turns);
  EXPECT_NEAR(turns[0], -10, 1e-12);
  EXPECT_NEAR(turns[1], 10, 1e-12);
  EXPECT_NEAR(turns[2], -10, 1e-12);
  EXPECT_NEAR(turns[3], 10, 1e-12);
  expect_motion(chassis_motion(wheels, turns).motion, {0, 0, 2}, 1e-12);
  // Four wheels, three degrees of freedom: FL + BR against FR + BL must agree; 1 rad/s too much on one of
  // them is a misfit of 0.1 m/s sin(45) along its roller, of which a quarter in each equation cannot be
  // explained.
  turns = {11, 10, 10, 10};
  EXPECT_NEAR(chassis_motion(wheels, turns).residual, 0.25 * 0.1 * std::sqrt(0.5), 1e-12);
}

TEST(Wheels, MecanumTheOtherWayRoundTurnsByTheDifference) {
  std::vector<double> turns(4);
  const std::vector<Wheel> wheels = mecanum_wheels(0.6, 0.4, 0.1, MecanumPattern::o);
  ASSERT_TRUE(check(wheels));
  wheel_turns(wheels, {0, 0, 2}, turns);
  EXPECT_NEAR(turns[0], (0.3 - 0.2) * 2 / 0.1, 1e-12);
  wheel_turns(wheels, {0, 1, 0}, turns);
  EXPECT_NEAR(turns[0], 10, 1e-12);
  // On a square chassis nothing is left.
  EXPECT_NE(
      check(mecanum_wheels(0.5, 0.5, 0.1, MecanumPattern::o)).error().what.find("cannot turn the drive"),
      std::string::npos);
}

TEST(Wheels, ThreeOmniWheelsByHand) {
  // Wheels at 60, 180, 300 degrees, distance 0.2, r = 0.05. Wheel at angle b rolls along (-sin b, cos b).
  const std::vector<Wheel> wheels = omni_wheels(3, 0.05, 0.2, math::pi / 3);
  ASSERT_TRUE(check(wheels));
  std::vector<double> turns(3);
  wheel_turns(wheels, {1, 0, 0}, turns);
  const double s = std::sqrt(0.75) / 0.05;
  EXPECT_NEAR(turns[0], -s, 1e-12);
  EXPECT_NEAR(turns[1], 0, 1e-12);
  EXPECT_NEAR(turns[2], s, 1e-12);
  wheel_turns(wheels, {0, 0, 3}, turns);
  for (const double turn : turns) EXPECT_NEAR(turn, 3 * 0.2 / 0.05, 1e-12);
}

TEST(Wheels, LeastSquaresSpreadOneSlippingWheelOverAll) {
  // Four omni wheels on a cross, each 1 m from the middle: w is the mean of their rims' speeds. One slips by
  // 0.4.
  const std::vector<Wheel> wheels = omni_wheels(4, 0.1, 1, 0);
  const std::vector<double> turns{14, 10, 10, 10};
  const Estimate e = chassis_motion(wheels, turns);
  EXPECT_NEAR(e.motion.turn, 1.1, 1e-12);
  // The wheel at (1, 0) rolls along y, against the one at (-1, 0): vy = (1.4 - 1.0) / 2.
  expect_motion(e.motion, {0, 0.2, 1.1}, 1e-12);
  // Four equations, three unknowns: the misfit is along (1, -1, 1, -1) / 2 and has the length 0.4 / 2; rms of
  // four.
  EXPECT_NEAR(e.residual, 0.2 / 2, 1e-12);
}

TEST(Wheels, WhatCannotBeBuiltOrDrivenIsRefused) {
  const auto refused = [](const std::vector<Wheel>& wheels) {
    const Status status = check(wheels);
    return status ? std::string("fine") : status.error().what;
  };
  std::vector<Wheel> wheels = omni_wheels(3, 0.05, 0.2, 0);
  EXPECT_EQ(refused(wheels), "fine");
  wheels[1].radius_m = 0;
  EXPECT_EQ(refused(wheels), "wheel 2 has a radius of 0 m");
  wheels = omni_wheels(3, 0.05, 0.2, 0);
  wheels[2].x_m = wheels[0].x_m, wheels[2].y_m = wheels[0].y_m;
  wheels[2].name = "rear";
  EXPECT_EQ(refused(wheels), "wheel 1 and 'rear' stand on the same point");
  EXPECT_EQ(check(wheels).error().fix, "move one of them: it touches the ground at (0.2, 0) m");
  EXPECT_EQ(refused({}), "a chassis without wheels does not move");
  // All rolling ahead without holding across: nothing pushes sideways.
  wheels.clear();
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0}) wheels.push_back(roller_wheel(x, y, 0.1, 0, 0.5 * math::pi));
  EXPECT_EQ(refused(wheels), "these wheels cannot move the drive sideways");
  EXPECT_TRUE(check(wheels, 0.0));  // as a skid drive they can
  // All pointing at the middle: it turns freely.
  wheels.clear();
  for (int i = 0; i < 3; ++i) {
    const double at = i * math::tau / 3;
    wheels.push_back(roller_wheel(math::cos(at), math::sin(at), 0.1, at, 0.5 * math::pi));
  }
  EXPECT_EQ(refused(wheels), "these wheels cannot turn the drive: all of them let it turn freely");
  EXPECT_EQ(refused({roller_wheel(0.1, 0, 0.1, 0, 0.001)}),
            "wheel 1 has rollers whose axes lie along the wheel's: it pushes nothing");
}

TEST(Wheels, LimitingKeepsTheDirection) {
  const std::vector<Wheel> wheels = mecanum_wheels(0.6, 0.4, 0.1);
  const PlanarMotion cut = limited(wheels, {1, 0.5, 2}, 10);  // the fastest of them 25
  expect_motion(cut, {0.4, 0.2, 0.8}, 1e-15);
  EXPECT_EQ(limited(wheels, {0.1, 0, 0}, 10), (PlanarMotion{0.1, 0, 0}));
}

TEST(Wheels, DisplacementsAreIntegratedOnExactArcs) {
  // Along y while it turns clockwise, about (2, 0): after a quarter it is at (2, 2) and looks along -y.
  const PlanarPose end = integrate({}, {0, math::pi, -math::pi / 2});
  EXPECT_NEAR(end.x_m, 2, 1e-14);
  EXPECT_NEAR(end.y_m, 2, 1e-14);
  EXPECT_NEAR(end.theta_rad, -math::pi / 2, 1e-15);
  const PlanarPose same = along_arc({1, 2, 0.3}, 0.7, 1.1), arc = integrate({1, 2, 0.3}, {0.7, 0, 1.1});
  EXPECT_NEAR(arc.x_m, same.x_m, 1e-15);
  EXPECT_NEAR(arc.y_m, same.y_m, 1e-15);
}

TEST(SkidSteering, ForwardUndoesInverseAndTheTrackRatioStretchesTheTurn) {
  const Skid skid{.radius_m = 0.1, .track_m = 0.5, .track_ratio = 1.6, .pivot_x_m = 0.1};
  // w = 1: the sides run at 0.4 m/s, not at 0.25.
  EXPECT_NEAR(skid.inverse({0, 0, 1}).right_radps, 4, 1e-14);
  expect_motion(skid.forward(skid.inverse({0.7, 0, -1.5})), {0.7, 0.15, -1.5}, 1e-14);
  // The same as wheels that hold along alone, x T apart.
  std::vector<Wheel> wheels;
  for (const double x : {0.2, -0.2})
    for (const double y : {0.4, -0.4}) wheels.push_back(roller_wheel(x, y, 0.1, 0, 0.5 * math::pi));
  std::vector<double> turns(4);
  wheel_turns(wheels, {0.7, 0, -1.5}, turns);
  EXPECT_NEAR(turns[0], skid.inverse({0.7, 0, -1.5}).left_radps, 1e-12);
  expect_motion(chassis_motion(wheels, turns, 0.1).motion, {0.7, 0.15, -1.5}, 1e-12);
}

TEST(SkidSteering, TheTrackRatioOfIsotropicFriction) {
  // Four wheels: 1 + (L / T)^2. Wheels on the axle: no slip.
  const double ahead[] = {0.2, -0.2};
  EXPECT_NEAR(track_ratio(ahead, 0.5), 1 + 0.16 / 0.25, 1e-12);
  const double axle[] = {0.0};
  EXPECT_EQ(track_ratio(axle, 0.5), 1);
  // Six wheels: the moments of friction vanish at the ratio found, computed here from the forces themselves.
  const double six[] = {0.3, 0.05, -0.3};
  const double ratio = track_ratio(six, 0.5), w = 1, rim = 0.5 * ratio * 0.5 * w;
  double moment = 0;
  for (const double x : six) {
    const double along = rim - w * 0.25, across = -w * x;  // slip of the tread on the ground, right side
    const double speed = std::sqrt(along * along + across * across);
    moment += (0.25 * along + x * across) / speed;
  }
  EXPECT_NEAR(moment, 0, 1e-9);
  EXPECT_GT(ratio, 1.2);
}

TEST(AckermannSteering, InnerAndOuterWheelPointAtOneCentre) {
  const Ackermann car{.wheelbase_m = 1, .track_m = 0.6, .max_steering_rad = 0.6};
  // Centre at (0, 2): the left wheel's pin (1, 0.3) is 1.7 from it across, the right one's 2.3.
  const SteeringAngles angles = car.wheels(0.5);
  EXPECT_NEAR(math::tan(angles.left_rad), 1 / 1.7, 1e-14);
  EXPECT_NEAR(math::tan(angles.right_rad), 1 / 2.3, 1e-14);
  EXPECT_NEAR(math::tan(car.steering(0.5)), 1 / 2.0, 1e-14);
  EXPECT_NEAR(car.curvature(angles), 0.5, 1e-14);
  EXPECT_NEAR(car.curvature_of_bicycle(car.steering(-0.4)), -0.4, 1e-14);
  // To the right it is mirrored.
  EXPECT_NEAR(car.wheels(-0.5).right_rad, -angles.left_rad, 1e-14);
  // The tightest turn: the inner wheel at its stop.
  EXPECT_NEAR(car.wheels(car.max_curvature()).left_rad, 0.6, 1e-14);
  expect_motion(car.possible({-2, 1, 100}), {-2, 0, 2 * car.max_curvature()}, 1e-14);
  expect_motion(car.possible({0, 0, 1}), {0, 0, 0}, 0);
}

TEST(Swerve, FourModesOfTheModelBasedController) {
  const double a = 0.21;  // wheels at (+-a, +-a)
  EXPECT_EQ(steering_mode({}), SteeringMode::stop);
  EXPECT_EQ(wheel_motion({}, a, a).speed_mps, 0);
  // Crab: all parallel.
  EXPECT_EQ(steering_mode({0.3, 0.3, 0}), SteeringMode::crab);
  EXPECT_FALSE(centre_of_rotation({0.3, 0.3, 0}));
  for (const double x : {a, -a})
    EXPECT_NEAR(wheel_motion({0.3, 0.3, 0}, x, a).steering_rad, math::pi / 4, 1e-14);
  // Spin: FL at (a, a) moves along (-1, 1), at speed w |W|.
  EXPECT_EQ(steering_mode({0, 0, 2}), SteeringMode::spin);
  const WheelMotion spin = wheel_motion({0, 0, 2}, a, a);
  EXPECT_NEAR(spin.steering_rad, 0.75 * math::pi, 1e-14);
  EXPECT_NEAR(spin.speed_mps, 2 * a * std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(spin.slip_rad, 0.75 * math::pi, 1e-14);
  // Turn about (-vy, vx) / w = (-0.2, 0.5): each wheel moves across the line to that centre.
  const PlanarMotion turn{1, 0.4, 2};
  EXPECT_EQ(steering_mode(turn), SteeringMode::turn);
  const auto centre = centre_of_rotation(turn);
  ASSERT_TRUE(centre);
  EXPECT_NEAR(centre->x, -0.2, 1e-15);
  EXPECT_NEAR(centre->y, 0.5, 1e-15);
  const WheelMotion wheel = wheel_motion(turn, -a, a);
  const double rx = -a - centre->x, ry = a - centre->y;
  EXPECT_NEAR(wheel.speed_mps, 2 * std::sqrt(rx * rx + ry * ry), 1e-14);
  EXPECT_NEAR(math::cos(wheel.steering_rad) * rx + math::sin(wheel.steering_rad) * ry, 0, 1e-14);
}

TEST(Swerve, AccelerationOfAWheelIsTheChangeOfItsVelocity) {
  // The body turns by w dt meanwhile, so the velocity after it is R(w dt) (v + dv) in the frame before it.
  const PlanarMotion v{0.8, -0.3, 1.2}, change{0.5, 0.7, -2};
  const double x = 0.21, y = -0.2, dt = 1e-6;
  const Direction a = wheel_acceleration(v, change, x, y);
  const auto velocity_at = [&](double t) {
    const PlanarMotion now{v.x + change.x * t, v.y + change.y * t, v.turn + change.turn * t};
    const Direction u = motion_of_point(now, x, y);
    const auto [s, c] = math::sincos(v.turn * t + 0.5 * change.turn * t * t);
    return Direction{c * u.x - s * u.y, s * u.x + c * u.y};
  };
  // Central difference: error of order dt^2 plus rounding 1e-16 / dt.
  EXPECT_NEAR(a.x, (velocity_at(dt).x - velocity_at(-dt).x) / (2 * dt), 1e-8);
  EXPECT_NEAR(a.y, (velocity_at(dt).y - velocity_at(-dt).y) / (2 * dt), 1e-8);
}

TEST(Swerve, SteersTheShortWayAndDoesNotTremble) {
  const SteeringLimits free;
  // From 0 to 150 degrees: 30 degrees the other way, rolling backward.
  Steering s = steer_towards(math::pi * 150 / 180, {0, false}, free);
  EXPECT_NEAR(s.angle_rad, -math::pi / 6, 1e-12);
  EXPECT_TRUE(s.backward);
  // A joint that has turned twice stays there.
  s = steer_towards(0.1, {2 * math::tau, false}, free);
  EXPECT_NEAR(s.angle_rad, 2 * math::tau + 0.1, 1e-12);
  // Just across: from 0, 92 degrees forward or -88 backward. Within the hysteresis (0.1 rad) it keeps the way
  // it rolls.
  s = steer_towards(math::pi * 92 / 180, {0, false}, free);
  EXPECT_FALSE(s.backward);
  s = steer_towards(math::pi * 97 / 180, {0, false}, free);
  EXPECT_TRUE(s.backward);
  // With a servo of +-90 degrees every direction is in reach, one way or the other.
  const SteeringLimits servo{-math::pi / 2, math::pi / 2, 0.1};
  for (int i = -180; i <= 180; i += 5) {
    const double direction = i * math::pi / 180;
    s = steer_towards(direction, {1.4, false}, servo);
    EXPECT_LE(std::abs(s.angle_rad), math::pi / 2 + 1e-12);
    EXPECT_NEAR(math::cos(s.angle_rad + (s.backward ? math::pi : 0) - direction), 1, 1e-12) << i;
  }
  // One of +-30 degrees cannot: it takes the end that is nearer.
  s = steer_towards(1.2, {0, false}, {-math::pi / 6, math::pi / 6, 0.1});
  EXPECT_NEAR(s.angle_rad, math::pi / 6, 1e-12);
  EXPECT_FALSE(s.backward);
}

TEST(Kabsch, FindsAKnownMotion) {
  Stream random(2, 1, Purpose::experiment, 0);
  for (int round = 0; round < 100; ++round) {
    const double turn = random.uniform(-3, 3), x = random.uniform(-5, 5), y = random.uniform(-5, 5);
    std::vector<Direction> before, after;
    for (int i = 0; i < 5; ++i) {
      const double px = random.uniform(-1, 1), py = random.uniform(-1, 1);
      before.push_back({px, py});
      const auto [s, c] = math::sincos(turn);
      after.push_back({c * px - s * py + x, s * px + c * py + y});
    }
    const RigidFit fit = kabsch(before, after);
    EXPECT_NEAR(fit.turn_rad, turn, 1e-12);
    EXPECT_NEAR(fit.x_m, x, 1e-12);
    EXPECT_NEAR(fit.y_m, y, 1e-12);
    EXPECT_NEAR(fit.rmsd_m, 0, 1e-13);
  }
}

TEST(Kabsch, RolledWheelsFollowAllFourModesAndNoticeSlip) {
  const auto steered = [](const PlanarMotion& motion) {
    std::vector<Wheel> wheels;
    for (const double x : {0.21, -0.21})
      for (const double y : {0.21, -0.21})
        wheels.push_back(ordinary_wheel(x, y, 0.075, wheel_motion(motion, x, y).steering_rad));
    return wheels;
  };
  // A step of each mode with up to 0.1 rad: what remains is of the order of 0.1^7.
  for (const PlanarMotion& step : {PlanarMotion{}, PlanarMotion{0.02, 0.01, 0}, PlanarMotion{0, 0, 0.1},
                                   PlanarMotion{0.03, -0.02, 0.1}}) {
    const std::vector<Wheel> wheels = steered(step);
    std::vector<double> turns(4);
    wheel_turns(wheels, step, turns);
    const Estimate e = rolled(wheels, turns);
    expect_motion(e.motion, step, 1e-7);
    EXPECT_NEAR(e.residual, 0, 0.21 * 1e-7);
    expect_motion(chassis_motion(wheels, turns).motion, step, 1e-14);
  }
  // Straight ahead, one wheel spins 8 mm too far: the mean goes 2 mm too far, and it turns by
  // sum p x d / sum |p|^2 = 0.21 * 0.008 / (8 * 0.21^2) to the side away from it.
  const std::vector<Wheel> wheels = steered({1, 0, 0});
  std::vector<double> turns(4);
  wheel_turns(wheels, {0.01, 0, 0}, turns);
  turns[1] += 0.008 / 0.075;  // front right
  const Estimate slip = rolled(wheels, turns);
  const double turn = 0.008 / (8 * 0.21);
  EXPECT_NEAR(slip.motion.x, 0.012, 1e-6);  // the turn shortens the chords by its square
  EXPECT_NEAR(slip.motion.turn, turn, 2e-4);
  // The slip d as a vector in eight coordinates, less its parts in the mean (d^2 / 4) and in the turn (turn^2
  // sum |p|^2).
  const double rest = 0.008 * 0.008 * (1 - 0.25) - turn * turn * 8 * 0.21 * 0.21;
  EXPECT_NEAR(slip.residual, std::sqrt(rest / 4), 2e-4);
}

}  // namespace
}  // namespace sandlot::kinematics
