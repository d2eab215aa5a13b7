#include "kinematics/wheels.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/math.h"
#include "base/text.h"

namespace sandlot::kinematics {
namespace {

double plane_dot(Direction a, Direction b) { return a.x * b.x + a.y * b.y; }

/// One equation  d . u(p) = value,  of the unknown motion.
struct Row {
  double x, y, turn, value;
};

Row row(Direction d, double x_m, double y_m, double value) {
  return {d.x, d.y, d.y * x_m - d.x * y_m, value};
}

/// Calls visit(row) for each equation; `turns` may be empty (then the values are 0).
template <class Visit>
void for_each_row(std::span<const Wheel> wheels, std::span<const double> turns,
                  std::optional<double> pivot_x_m, Visit&& visit) {
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const Wheel& w = wheels[i];
    if (!w.counted) continue;
    const double rim = turns.empty() ? 0 : w.radius_m * turns[i];
    if (w.ordinary) {
      visit(row(w.along, w.x_m, w.y_m, rim));
      visit(row({-w.along.y, w.along.x}, w.x_m, w.y_m, 0));
    } else {
      visit(row(w.grip, w.x_m, w.y_m, rim * plane_dot(w.grip, w.along)));
    }
  }
  if (pivot_x_m) visit(row({0, 1}, *pivot_x_m, 0, 0));
}

std::string called(const Wheel& wheel, std::size_t index) {
  return *wheel.name ? "'" + std::string(wheel.name) + "'" : "wheel " + std::to_string(index + 1);
}

}  // namespace

Direction direction(double angle_rad) {
  const auto [s, c] = math::sincos(angle_rad);
  return {c, s};
}

Wheel ordinary_wheel(double x_m, double y_m, double radius_m, double heading_rad) {
  const Direction along = direction(heading_rad);
  return {.x_m = x_m, .y_m = y_m, .radius_m = radius_m, .along = along, .grip = along};
}

Wheel roller_wheel(double x_m, double y_m, double radius_m, double heading_rad, double roller_rad) {
  Wheel wheel = ordinary_wheel(x_m, y_m, radius_m, heading_rad);
  // The wheel's axis points along heading + 90 degrees.
  wheel.grip = direction(heading_rad + 0.5 * math::pi - roller_rad);
  wheel.ordinary = false;
  return wheel;
}

double wheel_turn(const Wheel& wheel, const PlanarMotion& motion) {
  const Direction u = motion_of_point(motion, wheel.x_m, wheel.y_m);
  if (wheel.ordinary) return plane_dot(wheel.along, u) / wheel.radius_m;
  return plane_dot(wheel.grip, u) / (wheel.radius_m * plane_dot(wheel.grip, wheel.along));
}

void wheel_turns(std::span<const Wheel> wheels, const PlanarMotion& motion, std::span<double> turns) {
  SL_CHECK(turns.size() == wheels.size());
  for (std::size_t i = 0; i < wheels.size(); ++i) turns[i] = wheel_turn(wheels[i], motion);
}

Estimate chassis_motion(std::span<const Wheel> wheels, std::span<const double> turns,
                        std::optional<double> pivot_x_m) {
  SL_CHECK(turns.size() == wheels.size());
  // Normal equations, solved by Cholesky's L L^T.
  double xx = 0, xy = 0, xt = 0, yy = 0, yt = 0, tt = 0, bx = 0, by = 0, bt = 0;
  for_each_row(wheels, turns, pivot_x_m, [&](const Row& r) {
    xx += r.x * r.x, xy += r.x * r.y, xt += r.x * r.turn;
    yy += r.y * r.y, yt += r.y * r.turn, tt += r.turn * r.turn;
    bx += r.x * r.value, by += r.y * r.value, bt += r.turn * r.value;
  });
  // check() has seen to it that no pivot is zero; a sum of squares that rounding makes negative is none
  // either.
  const double a = std::sqrt(std::max(xx, 1e-300)), b = xy / a, c = xt / a;
  const double d = std::sqrt(std::max(yy - b * b, 1e-300)), e = (yt - b * c) / d;
  const double f = std::sqrt(std::max(tt - c * c - e * e, 1e-300));
  const double z1 = bx / a, z2 = (by - b * z1) / d, z3 = (bt - c * z1 - e * z2) / f;
  Estimate out;
  out.motion.turn = z3 / f;
  out.motion.y = (z2 - e * out.motion.turn) / d;
  out.motion.x = (z1 - b * out.motion.y - c * out.motion.turn) / a;
  double squares = 0;
  int rows = 0;
  for_each_row(wheels, turns, pivot_x_m, [&](const Row& r) {
    const double miss = r.x * out.motion.x + r.y * out.motion.y + r.turn * out.motion.turn - r.value;
    squares += miss * miss;
    ++rows;
  });
  out.residual = rows > 0 ? std::sqrt(squares / rows) : 0;
  return out;
}

Status check(std::span<const Wheel> wheels, std::optional<double> pivot_x_m) {
  if (wheels.empty()) return Error{"a chassis without wheels does not move", ""};
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const Wheel& w = wheels[i];
    if (!(w.radius_m > 0) || !std::isfinite(w.radius_m))
      return Error{called(w, i) + " has a radius of " + short_text(w.radius_m) + " m", "give it a size"};
    if (!w.ordinary && std::abs(plane_dot(w.grip, w.along)) < 0.02)
      return Error{called(w, i) + " has rollers whose axes lie along the wheel's: it pushes nothing",
                   "their angle is 90 deg for an omni wheel, 45 or -45 deg for a Mecanum wheel"};
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(w.x_m - wheels[j].x_m) + std::abs(w.y_m - wheels[j].y_m) < 1e-6)
        return Error{called(wheels[j], j) + " and " + called(w, i) + " stand on the same point",
                     "move one of them: it touches the ground at (" + short_text(w.x_m) + ", " +
                         short_text(w.y_m) + ") m"};
  }
  // Normal equations with the turn in units of the mean distance, so that its size does not depend on that of
  // the robot.
  double squares = 0, rows = 0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (const Wheel& w : wheels) squares += w.x_m * w.x_m + w.y_m * w.y_m;
  const double distance = std::max(1e-6, std::sqrt(squares / static_cast<double>(wheels.size())));
  for_each_row(wheels, {}, pivot_x_m, [&](const Row& r) {
    const Eigen::Vector3d a(r.x, r.y, r.turn / distance);
    normal += a * a.transpose();
    ++rows;
  });
  if (rows == 0) return Error{"none of the wheels has a motor or an encoder", ""};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(normal / rows);
  if (eigen.eigenvalues()[0] > 1e-6) return {};
  const Eigen::Vector3d free = eigen.eigenvectors().col(0).cwiseAbs();
  if (free[2] >= std::max(free[0], free[1]))
    return Error{
        "these wheels cannot turn the drive: all of them let it turn freely",
        "point wheels or rollers past the middle; of Mecanum wheels exchange those on the left with those "
        "on the right"};
  return Error{
      std::string("these wheels cannot move the drive ") + (free[0] > free[1] ? "forward" : "sideways"),
      "all of them hold along the same direction: turn one, or add one at another angle"};
}

PlanarPose integrate(PlanarPose from, const PlanarMotion& d) {
  const double half = 0.5 * d.turn;
  // sin(h)/h; below 1e-4 its series 1 - h^2/6 is exact to h^4/120 < 1e-18.
  const double sinc = std::abs(half) < 1e-4 ? 1 - half * half / 6 : math::sin(half) / half;
  const auto [s, c] = math::sincos(from.theta_rad + half);
  return {from.x_m + sinc * (c * d.x - s * d.y), from.y_m + sinc * (s * d.x + c * d.y),
          from.theta_rad + d.turn};
}

PlanarMotion limited(std::span<const Wheel> wheels, const PlanarMotion& motion, double max_turn) {
  double fastest = 0;
  for (const Wheel& wheel : wheels) fastest = std::max(fastest, std::abs(wheel_turn(wheel, motion)));
  if (!(fastest > max_turn)) return motion;
  const double scale = max_turn / fastest;
  return {scale * motion.x, scale * motion.y, scale * motion.turn};
}

std::vector<Wheel> omni_wheels(int n, double radius_m, double distance_m, double first_rad) {
  SL_CHECK(n > 0);
  std::vector<Wheel> wheels;
  for (int i = 0; i < n; ++i) {
    const double at = first_rad + i * math::tau / n;
    const Direction out = direction(at);
    wheels.push_back(
        roller_wheel(distance_m * out.x, distance_m * out.y, radius_m, at + 0.5 * math::pi, 0.5 * math::pi));
  }
  return wheels;
}

std::vector<Wheel> mecanum_wheels(double wheelbase_m, double track_m, double radius_m,
                                  MecanumPattern pattern) {
  std::vector<Wheel> wheels;
  for (const double x : {0.5, -0.5})
    for (const double y : {0.5, -0.5}) {
      const double side = (x * y > 0 ? -1 : 1) * (pattern == MecanumPattern::x ? 1 : -1);
      wheels.push_back(roller_wheel(x * wheelbase_m, y * track_m, radius_m, 0, side * 0.25 * math::pi));
    }
  return wheels;
}

}  // namespace sandlot::kinematics
