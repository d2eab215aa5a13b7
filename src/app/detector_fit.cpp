#include "app/detector_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::app {
namespace {

/// Least squares with parameters >= 0: the best of all choices of parameters that are 0. For up to three of
/// them that is quick.
Eigen::VectorXd fit_not_negative(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values,
                                 const Eigen::VectorXd& weights) {
  const Eigen::Index n = columns.cols();
  const Eigen::MatrixXd normal = columns.transpose() * weights.asDiagonal() * columns;
  const Eigen::VectorXd right = columns.transpose() * weights.asDiagonal() * values;
  Eigen::VectorXd best = Eigen::VectorXd::Zero(n);
  double best_gain = 0;
  for (unsigned chosen = 1; chosen < 1u << n; ++chosen) {
    std::vector<Eigen::Index> at;
    for (Eigen::Index i = 0; i < n; ++i)
      if (chosen >> i & 1) at.push_back(i);
    const Eigen::MatrixXd part = normal(at, at);
    const Eigen::VectorXd b = right(at);
    const auto solver = part.colPivHouseholderQr();
    if (solver.rank() < part.rows()) continue;
    const Eigen::VectorXd x = solver.solve(b);
    if (!(x.minCoeff() >= 0)) continue;
    const double gain = b.dot(x);  // by so much less than with all of them 0
    if (gain <= best_gain) continue;
    best_gain = gain;
    best.setZero();
    for (std::size_t i = 0; i < at.size(); ++i) best(at[i]) = x(static_cast<Eigen::Index>(i));
  }
  return best;
}

}  // namespace

DetectorFit fit_detector(std::span<const Sighted> sighted, int ghosts, double seconds) {
  DetectorFit fit;
  if (seconds > 0) fit.ghost_rate_hz = ghosts / seconds;
  if (sighted.empty()) return fit;
  fit.nearest_m = fit.farthest_m = sighted[0].range_m;
  std::vector<const Sighted*> found;  // with its own label: of the others it is less sure what they are
  int confused = 0;
  for (const Sighted& s : sighted) {
    fit.nearest_m = std::min(fit.nearest_m, s.range_m);
    fit.farthest_m = std::max(fit.farthest_m, s.range_m);
    if (s.found && !s.confused) found.push_back(&s);
    confused += s.confused;
  }

  const auto all = static_cast<Eigen::Index>(sighted.size());
  Eigen::MatrixXd columns(all, 3);
  Eigen::VectorXd missed(all), weights = Eigen::VectorXd::Ones(all);
  for (Eigen::Index i = 0; i < all; ++i) {
    const Sighted& s = sighted[static_cast<std::size_t>(i)];
    columns.row(i) << 1, s.range_m, std::max(0.0, 1 - s.visible);
    missed(i) = s.found ? 0 : 1;
  }
  Eigen::VectorXd rates = Eigen::VectorXd::Zero(3);
  for (int round = 0; round < 20; ++round) {
    rates = fit_not_negative(columns, missed, weights);
    // Not below half a miss in all: where none is expected a single one would count without bound.
    const double least = 0.5 / static_cast<double>(all);
    for (Eigen::Index i = 0; i < all; ++i) {
      const double p = std::clamp(columns.row(i).dot(rates), least, 1 - least);
      weights(i) = 1 / (p * (1 - p));
    }
  }
  fit.miss_rate = std::min(1.0, rates(0));
  fit.miss_rate_per_m = std::min(1.0, rates(1));
  fit.miss_rate_hidden = std::min(1.0, rates(2));
  if (confused > 0)
    fit.confusion = confused / static_cast<double>(found.size() + static_cast<std::size_t>(confused));
  if (found.empty()) return fit;

  const auto seen = static_cast<Eigen::Index>(found.size());
  Eigen::MatrixXd ranges(seen, 2);
  Eigen::VectorXd off(seen), trust = Eigen::VectorXd::Ones(seen);
  double bearings = 0;
  for (Eigen::Index i = 0; i < seen; ++i) {
    const Sighted& s = *found[static_cast<std::size_t>(i)];
    ranges.row(i) << 1, s.range_m;
    off(i) = std::abs(s.range_error_m) * std::sqrt(math::pi / 2);
    bearings += s.bearing_error_rad * s.bearing_error_rad;
    fit.bearing_mean_rad += s.bearing_error_rad / static_cast<double>(seen);
    fit.range_mean_m += s.range_error_m / static_cast<double>(seen);
  }
  fit.bearing_std_rad = std::sqrt(bearings / static_cast<double>(seen));
  Eigen::VectorXd deviation = Eigen::VectorXd::Zero(2);
  for (int round = 0; round < 20; ++round) {
    deviation = fit_not_negative(ranges, off, trust);
    for (Eigen::Index i = 0; i < seen; ++i) {
      const double sigma = std::max(1e-6, ranges.row(i).dot(deviation));
      trust(i) = 1 / (sigma * sigma);
    }
  }
  fit.range_std_m = deviation(0);
  fit.range_std_per_m = deviation(1);
  return fit;
}

}  // namespace sandlot::app
