#include "navigation/visual_odometry/rigid.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::navigation::vo {
namespace {

Eigen::Matrix3d rigid_rotation(Quat q) { return Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix(); }

}  // namespace

Eigen::Matrix3d small_turn(const Eigen::Vector3d& turn) {
  return Eigen::Quaterniond(1, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z())
      .normalized()
      .toRotationMatrix();
}

void Rigid::move(const Eigen::Vector3d& translation, const Eigen::Vector3d& turn) {
  const Eigen::Matrix3d by = small_turn(turn);
  R = by * R;
  t = by * t + translation;
}

Rigid optical_motion(const Pose& X_KS) {
  const Pose X_SK = inverse(X_KS);
  const Pose X_10{rotate_inverse(q_S_optical, X_SK.p), conjugate(q_S_optical) * X_SK.q * q_S_optical};
  Rigid out;
  out.R = rigid_rotation(normalised(X_10.q));
  out.t << X_10.p.x, X_10.p.y, X_10.p.z;
  return out;
}

Pose motion_of_S(const Rigid& X_10) {
  Eigen::Quaterniond q(X_10.R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const Pose X_SK{rotate(q_S_optical, {X_10.t.x(), X_10.t.y(), X_10.t.z()}),
                  q_S_optical * Quat{q.w(), q.x(), q.y(), q.z()} * conjugate(q_S_optical)};
  return inverse(X_SK);
}

Covariance errors_of_S(const Eigen::Matrix<double, 6, 6>& optical) {
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = rigid_rotation(q_S_optical);
  const Eigen::Matrix<double, 6, 6> turned = turn * optical * turn.transpose();
  Covariance out;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      out[static_cast<std::size_t>(6 * i + j)] = 0.5 * (turned(i, j) + turned(j, i));
  return out;
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void draw_distinct(Stream& random, std::uint32_t count, std::span<std::uint32_t> index) {
  for (std::size_t i = 0; i < index.size();) {
    index[i] = random.below(count);
    if (std::find(index.begin(), index.begin() + static_cast<std::ptrdiff_t>(i), index[i]) ==
        index.begin() + static_cast<std::ptrdiff_t>(i))
      ++i;
  }
}

void RansacEnd::found(double share) {
  double all_good = 1;
  for (int i = 0; i < sample_size_; ++i) all_good *= share;
  // ln 0.0001 = -9.21
  const double needed = all_good < 1e-6 ? most_ : all_good > 0.999 ? 1 : -9.21 / math::log(1 - all_good);
  const int done = most_ - left_;
  left_ = std::min(left_,
                   std::max(static_cast<int>(std::min<double>(most_, std::ceil(needed))), least_) - done);
}

}  // namespace sandlot::navigation::vo
