#include "navigation/visual_odometry/rigid.h"

namespace sandlot::navigation::vo {
namespace {

Eigen::Matrix3d rigid_rotation(Quat q) { return Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix(); }

}  // namespace

SmallMatrix solve_symmetric(const SmallMatrix& A, const SmallMatrix& B, double* rcond) {
  const Eigen::LDLT<SmallMatrix> solver(A);
  if (rcond) *rcond = solver.rcond();
  return solver.solve(B);
}

SmallMatrix inverse_symmetric(const SmallMatrix& A) {
  return solve_symmetric(A, SmallMatrix::Identity(A.rows(), A.cols()));
}

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

}  // namespace sandlot::navigation::vo
