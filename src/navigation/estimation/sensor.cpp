#include "navigation/estimation/sensor.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::navigation::ekf {
namespace {

constexpr double most_value = 1e9, least_variance = 1e-18, most_variance = 1e18;

using Matrix3 = std::array<std::array<double, 3>, 3>;
using Matrix6 = std::array<std::array<double, 6>, 6>;

Matrix3 rotation_of(Quat q) {
  const Vec3 x = rotate(q, {1, 0, 0}), y = rotate(q, {0, 1, 0}), z = rotate(q, {0, 0, 1});
  return {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
}
/// [v]x M: row by row the cross product of v with the columns of M.
Matrix3 cross_columns(Vec3 v, const Matrix3& M) {
  Matrix3 out{};
  for (std::size_t j = 0; j < 3; ++j) {
    const Vec3 c = cross(v, {M[0][j], M[1][j], M[2][j]});
    out[0][j] = c.x, out[1][j] = c.y, out[2][j] = c.z;
  }
  return out;
}
/// J C J^T with J = [R U; 0 R].
Matrix6 transformed(const Matrix6& C, const Matrix3& R, const Matrix3& U) {
  Matrix6 J{}, JC{}, out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) J[i][j] = J[i + 3][j + 3] = R[i][j], J[i][j + 3] = U[i][j];
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      for (std::size_t k = 0; k < 6; ++k) JC[i][j] += J[i][k] * C[k][j];
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      for (std::size_t k = 0; k < 6; ++k) out[i][j] += JC[i][k] * J[j][k];
  return out;
}

Matrix6 square_of(const Triangle& t) {
  Matrix6 C;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) C[i][j] = t[triangle_index(i, j)];
  return C;
}
Triangle triangle_of(const Matrix6& C) {
  Triangle t;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j <= i; ++j) t[triangle_index(i, j)] = 0.5 * (C[i][j] + C[j][i]);
  return t;
}

Pose pose_of(const std::array<double, 6>& v) { return pose_from_rpy({v[0], v[1], v[2]}, {v[3], v[4], v[5]}); }
std::array<double, 6> numbers_of(const Pose& X) {
  const Vec3 rpy = rpy_from_quat(X.q);
  return {X.p.x, X.p.y, X.p.z, rpy.x, rpy.y, rpy.z};
}

bool level(const Sensor& sensor) { return sensor.mount.q == Quat{}; }
bool mounted_at_base(const Sensor& sensor) { return level(sensor) && sensor.mount.p == Vec3{}; }

bool sound(double value) { return std::abs(value) <= most_value; }  // NaN is not
bool sound_rotation(Quat q) {
  const double n = norm(q);
  return n > 0.9 && n < 1.1;
}

/// Standard deviations of a sensor's own take the place of the message's covariance.
/// @param first  index of the state that the first of the six is
void deviate(const Sensor& sensor, std::size_t first, Matrix6& C) {
  if (sensor.deviation.size() != states) return;
  for (std::size_t i = 0; i < 6 && first + i < states; ++i) {
    const double deviation = sensor.deviation[first + i];
    if (!(deviation > 0)) continue;
    for (std::size_t j = 0; j < 6; ++j) C[i][j] = C[j][i] = 0;
    C[i][i] = deviation * deviation;
  }
}

/// Whether the covariance of the chosen components is finite, symmetric (within what floats of 32 bits leave) and positive
/// definite. Rows of others become 0 when they are not finite.
/// @param may_be_zero  without the last: what is left of it in a difference is checked later
bool sound_covariance(Matrix6& C, const std::array<bool, 6>& chosen, bool may_be_zero = false) {
  std::array<double, 36> block{};
  std::size_t m = 0;
  std::array<std::size_t, 6> index{};
  for (std::size_t i = 0; i < 6; ++i)
    if (chosen[i]) index[m++] = i;
  for (std::size_t i = 0; i < m; ++i) {
    const double variance = C[index[i]][index[i]];
    if (!(variance >= (may_be_zero ? 0 : least_variance) && variance <= most_variance)) return false;
  }
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j) {
      const double a = C[index[i]][index[j]], b = C[index[j]][index[i]];
      const double size = std::sqrt(C[index[i]][index[i]] * C[index[j]][index[j]]);
      if (!(std::abs(a - b) <= 1e-6 * size) || !(std::abs(a) <= 1.000001 * size)) return false;
      block[i * m + j] = 0.5 * (a + b);
    }
  if (!may_be_zero && !positive_definite(std::span(block).first(m * m), m)) return false;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      if ((!chosen[i] || !chosen[j]) && !(std::abs(C[i][j]) <= most_variance)) C[i][j] = 0;
  return true;
}

/// From the sensor's axes to those of B. What is chosen is chosen in B: axes that are turned are turned before the check.
bool settled(const Sensor& sensor, std::size_t first, const std::array<bool, 6>& chosen, const Matrix3& R,
             const Matrix3& U, Matrix6& C) {
  if (!level(sensor)) C = transformed(C, R, U);
  deviate(sensor, first, C);
  if (!sound_covariance(C, chosen)) return false;
  if (level(sensor) && !mounted_at_base(sensor)) C = transformed(C, R, U);
  return true;
}

std::array<bool, 6> chosen_of(const Sensor& sensor, Part part) {
  std::array<bool, 6> chosen{};
  for (std::size_t i = 0; i < 6 && first_index(part) + i < states; ++i)
    chosen[i] = sensor.config[first_index(part) + i];
  return chosen;
}
bool any(const std::array<bool, 6>& chosen) {
  return std::any_of(chosen.begin(), chosen.end(), [](bool each) { return each; });
}

Sample& next_sample(Samples& out, Part part) {
  Sample& sample = out.part[out.count++];
  sample = {};
  sample.part = part;
  return sample;
}

Matrix6 matrix_of(const std::array<double, 36>& from) {
  Matrix6 C;
  for (std::size_t i = 0; i < 36; ++i) C[i / 6][i % 6] = from[i];
  return C;
}
/// 3 x 3 into a diagonal block.
void place_block(const std::array<double, 9>& from, std::size_t at, Matrix6& C) {
  for (std::size_t i = 0; i < 9; ++i) C[at + i / 3][at + i % 3] = from[i];
}

}  // namespace

bool positive_definite(std::span<const double> matrix, std::size_t m) {
  std::array<std::array<double, 6>, 6> L{};
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix[i * m + j];
      for (std::size_t k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
      if (i == j && !(sum > 1e-12 * matrix[i * m + i] && std::isfinite(sum))) return false;
      L[i][j] = i == j ? std::sqrt(sum) : sum / L[j][j];
    }
  return true;
}

Status Sensor::check(const Node& node, const std::string& path) const {
  const auto error = [&](const char* what, const char* fix, const char* key) {
    const Node* at = node.find(key);
    return (at ? *at : node).error(what, fix, path + "/" + key);
  };
  const auto has = [&](std::size_t from, std::size_t to) {
    return std::any_of(config.begin() + static_cast<std::ptrdiff_t>(from),
                       config.begin() + static_cast<std::ptrdiff_t>(to), [](bool each) { return each; });
  };
  const bool position = kind == SensorKind::odometry || kind == SensorKind::pose || kind == SensorKind::gps;
  const bool orientation = (position && kind != SensorKind::gps) || kind == SensorKind::imu;
  const bool linear = kind == SensorKind::odometry || kind == SensorKind::twist;
  const bool rates = linear || kind == SensorKind::imu;
  if (!has(0, states)) return error("nothing is used of this sensor", "set one of the 15 to true", "config");
  if ((has(X, Roll) && !position) || (has(Roll, Vx) && !orientation) || (has(Vx, Vroll) && !linear) ||
      (has(Vroll, Ax) && !rates) || (has(Ax, states) && kind != SensorKind::imu))
    return error("sensors of this kind do not measure all of these",
                 "odometry: 1 to 12; pose: 1 to 6; twist: 7 to 12; imu: 4 to 6 and 10 to 15; gps: 1 to 3",
                 "config");
  const bool poses = (position || orientation) && kind != SensorKind::gps;
  if (differential && (!poses || !has(X, Vx)))
    return error("there are no poses to make differences of", "false", "differential");
  if (differential && kind == SensorKind::imu && has(X, Roll))
    return error("an imu has no positions", "false", "differential");
  if (!differential && (way_scale_deviation > 0 || turn_scale_deviation > 0))
    return error("only ways and turns have relative errors", "differential: true",
                 way_scale_deviation > 0 ? "way_scale_deviation" : "turn_scale_deviation");
  if (relative && (!poses || !has(X, Vx)))
    return error("there are no poses to count from the first one", "false", "relative");
  if (differential && pose_errors == PoseErrors::as_twist && kind != SensorKind::odometry)
    return error("only an odometry has a twist beside its pose", "independent or accumulated", "pose_errors");
  if (relative && differential)
    return error("differences do not depend on the first pose", "one of differential and relative",
                 "relative");
  if (!deviation.empty() && deviation.size() != states)
    return error("has not 15 numbers", "one for each component of the state, or none", "deviation");
  if (std::any_of(deviation.begin(), deviation.end(), [](double each) { return each > 0 && each < 1e-9; }))
    return error("is too small", "0 or at least 1e-9", "deviation");
  if (!(std::abs(norm(mount.q) - 1) < 1e-6))
    return error("the orientation is not a rotation", "a quaternion of length 1", "mount");
  return {};
}

Outcome to_samples(const Sensor& sensor, const msg::Odometry& odometry, Samples& out) {
  const bool by_twist = sensor.differential && sensor.pose_errors == PoseErrors::as_twist;
  msg::PoseWithCovariance pose = odometry.pose;
  if (by_twist) {
    pose.covariance = {};
    for (std::size_t i = 0; i < 6; ++i) pose.covariance[7 * i] = 1;
  }
  const Outcome posed = to_samples(sensor, pose, out);
  if (posed != Outcome::queued && posed != Outcome::unmeasured) return posed;
  if (by_twist && posed == Outcome::queued) {
    // Errors of the movement, about B at its end: they come from S as those of the twist do.
    Matrix6 C = matrix_of(odometry.twist.covariance);
    const Matrix3 R = rotation_of(normalised(sensor.mount.q));
    const Matrix3 arm = cross_columns(sensor.mount.p, R);
    if (!level(sensor)) C = transformed(C, R, arm);
    deviate(sensor, Vx, C);
    if (!sound_covariance(C, chosen_of(sensor, Part::pose), true)) return Outcome::bad_covariance;
    if (level(sensor) && !mounted_at_base(sensor)) C = transformed(C, R, arm);
    out.part[out.count - 1].covariance = triangle_of(C);
  }
  const Outcome moving = to_samples(sensor, odometry.twist, out);
  if (moving != Outcome::queued && moving != Outcome::unmeasured) return moving;
  return out.count ? Outcome::queued : Outcome::unmeasured;
}

Outcome to_samples(const Sensor& sensor, const msg::PoseWithCovariance& pose, Samples& out) {
  const std::array<bool, 6> chosen = chosen_of(sensor, Part::pose);
  if (!any(chosen)) return Outcome::unmeasured;
  const bool turns = chosen[3] || chosen[4] || chosen[5] || sensor.differential || sensor.relative ||
                     !mounted_at_base(sensor);
  const bool moves = chosen[0] || chosen[1] || chosen[2];
  if (turns && !sound_rotation(pose.pose.q)) return Outcome::bad_value;
  for (std::size_t i = 0; i < 3; ++i)
    if ((chosen[i] || (moves && turns)) && !sound(pose.pose.p[i])) return Outcome::bad_value;

  Pose pose_W{{}, turns ? normalised(pose.pose.q) : Quat{}};
  for (std::size_t i = 0; i < 3; ++i) pose_W.p[i] = sound(pose.pose.p[i]) ? pose.pose.p[i] : 0;
  Matrix6 C = matrix_of(pose.covariance);
  deviate(sensor, Index::X, C);
  if (!sound_covariance(C, chosen, sensor.differential)) return Outcome::bad_covariance;
  if (!mounted_at_base(sensor)) {
    const Pose X_WB = pose_W * inverse(sensor.mount);
    // The origin of B lies at the end of an arm that turns with the sensor: p_B = p_S + arm, and arm += turn x arm.
    Matrix3 U = cross_columns(X_WB.p - pose_W.p, rotation_of({}));
    for (auto& row : U)
      for (double& each : row) each = -each;
    C = transformed(C, rotation_of({}), U);
    pose_W = X_WB;
  }
  Sample& sample = next_sample(out, Part::pose);
  sample.value = numbers_of(pose_W);
  sample.covariance = triangle_of(C);
  return Outcome::queued;
}

Outcome to_samples(const Sensor& sensor, const msg::TwistWithCovariance& twist, Samples& out) {
  const std::array<bool, 6> chosen = chosen_of(sensor, Part::twist);
  if (!any(chosen)) return Outcome::unmeasured;
  const bool all = !mounted_at_base(sensor);
  Vec3 linear, angular;
  for (std::size_t i = 0; i < 3; ++i) {
    const double v = twist.twist.linear[i], w = twist.twist.angular[i];
    if (((chosen[i] || all) && !sound(v)) || ((chosen[3 + i] || all) && !sound(w))) return Outcome::bad_value;
    linear[i] = sound(v) ? v : 0, angular[i] = sound(w) ? w : 0;
  }
  Matrix6 C = matrix_of(twist.covariance);
  // v_S = v_B + w x arm
  const Quat q_BS = normalised(sensor.mount.q);
  const Matrix3 R = rotation_of(q_BS), arm = cross_columns(sensor.mount.p, R);
  if (!settled(sensor, Vx, chosen, R, arm, C)) return Outcome::bad_covariance;
  if (all) {
    angular = rotate(q_BS, angular);
    linear = rotate(q_BS, linear) + cross(sensor.mount.p, angular);
  }
  Sample& sample = next_sample(out, Part::twist);
  sample.value = {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z};
  sample.covariance = triangle_of(C);
  return Outcome::queued;
}

Outcome to_samples(const Sensor& sensor, const msg::Imu& imu, double gravity, Samples& out) {
  // By REP 145 a covariance that begins with -1 says that the value is not there.
  const bool oriented = imu.orientation_covariance[0] != -1;
  const Quat q_BS = normalised(sensor.mount.q);
  const Matrix3 R = rotation_of(q_BS);
  if (any(chosen_of(sensor, Part::pose)) && oriented) {
    if (!sound_rotation(imu.orientation)) return Outcome::bad_value;
    Matrix6 C{};
    place_block(imu.orientation_covariance, 3, C);
    deviate(sensor, Index::X, C);
    if (!sound_covariance(C, chosen_of(sensor, Part::pose), sensor.differential))
      return Outcome::bad_covariance;
    Sample& sample = next_sample(out, Part::pose);
    sample.value = numbers_of({{}, normalised(imu.orientation) * conjugate(q_BS)});
    sample.covariance = triangle_of(C);
  }
  const auto vector = [&](Part part, Vec3 v, const std::array<double, 9>& covariance) {
    const std::array<bool, 6> chosen = chosen_of(sensor, part);
    if (!any(chosen) || covariance[0] == -1) return Outcome::queued;
    const std::size_t at = part == Part::twist ? 3 : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!sound(v[i]) && (chosen[at + i] || !level(sensor))) return Outcome::bad_value;
      if (!sound(v[i])) v[i] = 0;
    }
    Matrix6 C{};
    place_block(covariance, at, C);
    if (!settled(sensor, first_index(part), chosen, R, Matrix3{}, C)) return Outcome::bad_covariance;
    v = rotate(q_BS, v);
    Sample& sample = next_sample(out, part);
    for (std::size_t i = 0; i < 3; ++i) sample.value[at + i] = v[i];
    sample.covariance = triangle_of(C);
    if (part != Part::acceleration || !sensor.remove_gravitational_acceleration) return Outcome::queued;
    // Its own orientation knows the slope that a filter of the plane does not. Without one the estimate's serves.
    sample.holds_gravity = !(oriented && sound_rotation(imu.orientation));
    if (sample.holds_gravity) return Outcome::queued;
    const Quat q_WB = normalised(imu.orientation) * conjugate(q_BS);
    const Vec3 up_B = rotate_inverse(q_WB, {0, 0, gravity});
    for (std::size_t i = 0; i < 3; ++i) sample.value[i] -= up_B[i];
    return Outcome::queued;
  };
  if (const Outcome o = vector(Part::twist, imu.angular_velocity, imu.angular_velocity_covariance);
      o != Outcome::queued)
    return o;
  if (const Outcome o = vector(Part::acceleration, imu.linear_acceleration,
                               imu.linear_acceleration_covariance);
      o != Outcome::queued)
    return o;
  return out.count ? Outcome::queued : Outcome::unmeasured;
}

Outcome usable_fix(const Sensor& sensor, const msg::NavSatFix& fix) {
  if (fix.status.status < 0) return Outcome::unmeasured;
  if (!(std::abs(fix.latitude) <= 90) || !(std::abs(fix.longitude) <= 360)) return Outcome::bad_value;
  const bool has_altitude = fix.altitude >= -1e5 && fix.altitude <= 1e6;
  if (!has_altitude && (sensor.config[Z] || !std::isnan(fix.altitude))) return Outcome::bad_value;
  Samples samples;
  return to_samples(sensor, fix, {}, samples);
}

geodesy::Geodetic place_of(const msg::NavSatFix& fix, double altitude_m) {
  constexpr double deg = math::pi / 180;
  return {fix.latitude * deg, fix.longitude * deg, std::isnan(fix.altitude) ? altitude_m : fix.altitude};
}

Outcome to_samples(const Sensor& sensor, const msg::NavSatFix& fix, const Datum& datum, Samples& out) {
  Matrix6 C{};
  if (fix.position_covariance_type != msg::NavSatFix::covariance_unknown)
    place_block(fix.position_covariance, 0, C);
  // From east and north to the axes of W.
  if (datum.yaw_rad != 0)
    C = transformed(C, rotation_of(quat_from_axis_angle({0, 0, 1}, -datum.yaw_rad)), Matrix3{});
  deviate(sensor, Index::X, C);
  if (!sound_covariance(C, chosen_of(sensor, Part::pose))) return Outcome::bad_covariance;
  const Vec3 p = to_world(datum, place_of(fix, datum.altitude_m));
  Sample& sample = next_sample(out, Part::pose);
  sample.value = {p.x, p.y, p.z, 0, 0, 0};
  sample.covariance = triangle_of(C);
  return Outcome::queued;
}

Vec3 turn_vector(Quat q) {
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const Vec3 axis{q.x, q.y, q.z};
  const double s = norm(axis);
  return (s > 1e-12 ? 2 * math::atan2(s, q.w) / s : 2) * axis;
}

Movement movement(const Sample& from, const Sample& to, PoseErrors errors, double dt_s) {
  const Pose a = pose_of(from.value), b = pose_of(to.value);
  const Quat q_AW = conjugate(a.q);
  Movement out{{rotate(q_AW, b.p - a.p), normalised(q_AW * b.q)}};
  Matrix6 C = square_of(to.covariance);
  if (errors == PoseErrors::as_twist) {
    for (auto& row : C)
      for (double& each : row) each *= dt_s * dt_s;
    out.covariance = triangle_of(transformed(C, rotation_of(out.X_AB.q), Matrix3{}));
    return out;
  }
  // Errors of a: moves, and turns of the way. d = b - a - turn_a x way = b - [I, -[way]x] a
  Matrix3 U = cross_columns(b.p - a.p, rotation_of({}));
  for (auto& row : U)
    for (double& each : row) each = -each;
  const Matrix6 of_a = transformed(square_of(from.covariance), rotation_of({}), U);
  const double sign = errors == PoseErrors::independent ? 1 : -1;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) C[i][j] += sign * of_a[i][j];
  out.covariance = triangle_of(transformed(C, rotation_of(q_AW), Matrix3{}));
  return out;
}

void difference(const Sample& from, const Sample& to, PoseErrors errors, double dt_s, Sample& out) {
  const Movement moved = movement(from, to, errors, dt_s);
  const Quat turn = moved.X_AB.q.w < 0
                        ? Quat{-moved.X_AB.q.w, -moved.X_AB.q.x, -moved.X_AB.q.y, -moved.X_AB.q.z}
                        : moved.X_AB.q;
  const Vec3 w_B = turn_vector(turn) / dt_s;
  // Along an arc the chord points where B looked half way.
  const Quat middle = normalised(Quat{1 + turn.w, turn.x, turn.y, turn.z});
  const Vec3 v_B = rotate_inverse(middle, moved.X_AB.p) / dt_s;
  out = to;
  out.part = Part::twist;
  out.value = {v_B.x, v_B.y, v_B.z, w_B.x, w_B.y, w_B.z};
  Matrix6 C = square_of(moved.covariance);
  for (auto& row : C)
    for (double& each : row) each /= dt_s * dt_s;
  out.covariance = triangle_of(transformed(C, rotation_of(conjugate(middle)), Matrix3{}));
}

void make_relative(const std::array<double, 6>& first, Sample& sample) {
  const Pose X_WF = pose_of(first);
  sample.value = numbers_of(inverse(X_WF) * pose_of(sample.value));
  sample.covariance = triangle_of(
      transformed(square_of(sample.covariance), rotation_of(conjugate(X_WF.q)), Matrix3{}));
}

}  // namespace sandlot::navigation::ekf
