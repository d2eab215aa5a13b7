#include "navigation/localisation/plane_fit.h"

#include <algorithm>
#include <cmath>

namespace sandlot::navigation {

void PlaneFit::clear() { *this = PlaneFit(length_); }

void PlaneFit::add(Vec2 n, Vec2 r, double error, double weight) {
  const Eigen::Vector3d slope(n.x, n.y, (n.y * r.x - n.x * r.y) / length_);
  normal_ += weight * slope * slope.transpose();
  right_ -= weight * error * slope;
  squares_ += weight * error * error;
  weight_ += weight;
  ++points_;
}

double PlaneFit::rms() const { return weight_ > 0 ? std::sqrt(squares_ / weight_) : 0; }

PlaneFit::Step PlaneFit::solve(double weakest) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(normal_);
  Eigen::Vector3d change = Eigen::Vector3d::Zero();
  Step out;
  for (int i = 0; i < 3; ++i) {
    const double strength = solver.eigenvalues()(i);
    if (!(strength > weakest * std::max(1.0, solver.eigenvalues()(2)))) continue;
    const Eigen::Vector3d axis = solver.eigenvectors().col(i);
    change += axis * (axis.dot(right_) / strength);
    ++out.observable;
  }
  out.x = change(0), out.y = change(1), out.theta = change(2) / length_;
  return out;
}

Covariance3 PlaneFit::covariance(double deviation, double weakest) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(normal_);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const double strength = solver.eigenvalues()(i);
    const bool known = strength > weakest * std::max(1.0, solver.eigenvalues()(2));
    const Eigen::Vector3d axis = solver.eigenvectors().col(i);
    sum += (known ? deviation * deviation / strength : unknown_variance) * axis * axis.transpose();
  }
  const double scale[3] = {1, 1, 1 / length_};
  Covariance3 out{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out[static_cast<std::size_t>(3 * r + c)] = sum(r, c) * scale[r] * scale[c];
  return out;
}

}  // namespace sandlot::navigation
