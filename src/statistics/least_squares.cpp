#include "statistics/least_squares.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "base/math.h"

namespace sandlot::statistics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Points = std::vector<std::vector<double>>;

constexpr double unlimited = std::numeric_limits<double>::infinity();
/// Smallest singular value of the scaled Jacobian, relative to the largest, that differences of runs can resolve.
constexpr double singular = 1e-6;
/// Steps of differences that are tried, of the scaled parameters.
constexpr std::array steps{1e-6, 1e-4, 1e-3, 1e-2, 5e-2};

Status check(const std::vector<FitParameter>& parameters) {
  if (parameters.empty()) return Error{"a fit needs at least one parameter"};
  for (const FitParameter& p : parameters) {
    if (!std::isfinite(p.low) || !std::isfinite(p.high) || !(p.low < p.high))
      return Error{"the lower bound of a parameter must be below its upper one"};
    if (p.logarithmic && p.low <= 0) return Error{"a logarithmic parameter needs bounds above 0"};
    if (!(p.start >= p.low && p.start <= p.high)) return Error{"a parameter must start within its bounds"};
  }
  return {};
}

double value_at(const FitParameter& p, double u) {
  if (u <= 0) return p.low;
  if (u >= 1) return p.high;
  return p.logarithmic ? p.low * math::exp(u * math::log(p.high / p.low)) : p.low + u * (p.high - p.low);
}
double scaled(const FitParameter& p, double x) {
  return p.logarithmic ? math::log(x / p.low) / math::log(p.high / p.low) : (x - p.low) / (p.high - p.low);
}

/// Halton's number in (0, 1) of a base.
double halton(int index, int base) {
  double out = 0, part = 1;
  for (int i = index; i > 0; i /= base) {
    part /= base;
    out += part * (i % base);
  }
  return out;
}
int prime(std::size_t index) {
  int found = 2;
  for (int candidate = 2;; ++candidate) {
    bool is_prime = true;
    for (int d = 2; d * d <= candidate; ++d) is_prime = is_prime && candidate % d != 0;
    if (!is_prime) continue;
    found = candidate;
    if (index-- == 0) return found;
  }
}

class Search {
 public:
  Search(const std::vector<FitParameter>& parameters, const LeastSquaresOptions& options,
         const Evaluate& evaluate)
      : parameters_(parameters), options_(options), evaluate_(evaluate) {}

  Result<LeastSquares> run();

 private:
  Index count() const { return static_cast<Index>(parameters_.size()); }
  int left() const { return options_.most_evaluations - out_.evaluations; }
  std::vector<std::optional<VectorXd>> at(const std::vector<VectorXd>& points);
  Status begin();
  /// Points of a difference of one parameter.
  struct Probe {
    std::array<VectorXd, 2> points;
    double step = 0;  ///< to the first point
    bool central = false;
  };
  Probe probe(Index i, double step) const;
  void choose_steps();
  bool jacobian();
  bool improve();
  std::vector<Index> moving(const VectorXd& gradient) const;
  void finish();

  const std::vector<FitParameter>& parameters_;
  const LeastSquaresOptions& options_;
  const Evaluate& evaluate_;
  LeastSquares out_;
  VectorXd u_, r_;
  MatrixXd J_;  ///< of the point u_
  VectorXd h_;  ///< steps of differences
  double damping_ = 1e-3;
};

std::vector<std::optional<VectorXd>> Search::at(const std::vector<VectorXd>& points) {
  Points values;
  for (const VectorXd& u : points) {
    values.emplace_back();
    for (Index i = 0; i < count(); ++i)
      values.back().push_back(value_at(parameters_[static_cast<std::size_t>(i)], u[i]));
  }
  out_.evaluations += static_cast<int>(points.size());
  std::vector<std::optional<VectorXd>> found;
  for (const auto& residuals : evaluate_(values)) {
    found.emplace_back();
    if (residuals) {
      const VectorXd r = Eigen::Map<const VectorXd>(residuals->data(), static_cast<Index>(residuals->size()));
      if (r.allFinite() && (r_.size() == 0 || r.size() == r_.size())) found.back() = r;
    }
    if (!found.back()) ++out_.failed;
  }
  found.resize(points.size());
  return found;
}

/// Evaluates the start and the points of the screening; the search begins at the best.
Status Search::begin() {
  std::vector<VectorXd> points(1, VectorXd(count()));
  for (Index i = 0; i < count(); ++i) {
    const FitParameter& p = parameters_[static_cast<std::size_t>(i)];
    points[0][i] = scaled(p, p.start);
  }
  for (int k = 1; k <= std::min(options_.screening, options_.most_evaluations - 1); ++k) {
    points.emplace_back(count());
    for (Index i = 0; i < count(); ++i) points.back()[i] = halton(k, prime(static_cast<std::size_t>(i)));
  }
  const auto found = at(points);
  if (found[0]) out_.first.assign(found[0]->data(), found[0]->data() + found[0]->size());
  double best = unlimited;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!found[k] || !(found[k]->squaredNorm() < best)) continue;
    best = found[k]->squaredNorm();
    u_ = points[k];
    r_ = *found[k];
  }
  if (r_.size() == 0) return Error{"no point can be evaluated, neither the start nor one of the screening"};
  if (r_.size() < count())
    return Error{"there are fewer residuals than parameters", "compare more values, or fit fewer parameters"};
  return {};
}

/// Points of a difference about u_: to both sides, or twice to one where a bound is near.
Search::Probe Search::probe(Index i, double step) const {
  Probe out{{u_, u_}, step, u_[i] - step >= 0 && u_[i] + step <= 1};
  if (!out.central && u_[i] + 2 * step > 1) out.step = -step;
  out.points[0][i] += out.step;
  out.points[1][i] += out.central ? -out.step : 2 * out.step;
  return out;
}

/// Chooses for each parameter the step of its differences: the one whose second difference is the smallest part of its first. Where steps
/// are large that part is curvature; where they are small it is what residuals with jumps, as those of quantised sensors, do by chance.
void Search::choose_steps() {
  if (left() < count() * (2 * static_cast<Index>(steps.size()) + 2) + 1) return;
  std::vector<VectorXd> points;
  for (Index i = 0; i < count(); ++i)
    for (const double step : steps)
      for (const VectorXd& point : probe(i, step).points) points.push_back(point);
  const auto found = at(points);
  for (Index i = 0; i < count(); ++i) {
    double best = unlimited;
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const auto index = 2 * (static_cast<std::size_t>(i) * steps.size() + k);
      const auto &one = found[index], &other = found[index + 1];
      if (!one || !other) continue;
      const bool central = probe(i, steps[k]).central;
      const VectorXd first = central ? VectorXd((*one - *other) / 2) : VectorXd(*one - r_);
      const VectorXd second = central ? VectorXd(*one + *other - 2 * r_) : VectorXd(*other - 2 * *one + r_);
      if (!(first.norm() > 0) || !(second.norm() < best * first.norm())) continue;
      best = second.norm() / first.norm();
      h_[i] = steps[k];
    }
  }
}

/// Differences at u_. False: no evaluations are left, or a column cannot be had.
bool Search::jacobian() {
  if (left() < count()) return false;
  const bool both = left() > 2 * count();
  std::vector<VectorXd> points;
  for (Index i = 0; i < count(); ++i) {
    const Probe each = probe(i, h_[i]);
    points.push_back(each.points[0]);
    if (both && each.central) points.push_back(each.points[1]);
  }
  const auto found = at(points);
  J_.resize(r_.size(), count());
  std::size_t next = 0;
  for (Index i = 0; i < count(); ++i) {
    const Probe each = probe(i, h_[i]);
    const bool two = both && each.central;
    const auto& one = found[next];
    const auto* const other = two ? &found[next + 1] : nullptr;
    next += two ? 2 : 1;
    if (one && other && *other) J_.col(i) = (*one - **other) / (2 * each.step);
    else if (one) J_.col(i) = (*one - r_) / each.step;
    else if (other && *other) J_.col(i) = (r_ - **other) / each.step;
    else return false;
  }
  return true;
}

/// Parameters that a step may change: not those without effect, nor those held by a bound.
std::vector<Index> Search::moving(const VectorXd& gradient) const {
  std::vector<Index> out;
  for (Index i = 0; i < count(); ++i) {
    const bool held = (u_[i] <= 0 && gradient[i] > 0) || (u_[i] >= 1 && gradient[i] < 0);
    if (!held && J_.col(i).squaredNorm() > 0) out.push_back(i);
  }
  return out;
}

/// One step downhill. False: the search has ended.
bool Search::improve() {
  const VectorXd gradient = J_.transpose() * r_;
  const std::vector<Index> free = moving(gradient);
  if (free.empty() || r_.squaredNorm() == 0) {
    out_.converged = true;
    return false;
  }
  const MatrixXd J = J_(Eigen::all, free);
  const MatrixXd JJ = J.transpose() * J;
  for (; left() > 0; damping_ *= 8) {
    if (damping_ > 1e12) {
      out_.converged = true;  // no smaller step goes downhill either
      return false;
    }
    MatrixXd A = JJ;
    A.diagonal() *= 1 + damping_;
    VectorXd step = -A.ldlt().solve(gradient(free));
    if (!step.allFinite()) continue;
    step = step.cwiseMax(-options_.largest_step).cwiseMin(options_.largest_step);
    VectorXd next = u_;
    for (std::size_t i = 0; i < free.size(); ++i)
      next[free[i]] = std::clamp(u_[free[i]] + step[static_cast<Index>(i)], 0.0, 1.0);
    const auto found = at({next})[0];
    if (!found || !(found->squaredNorm() < r_.squaredNorm())) continue;
    const double gain = 1 - found->squaredNorm() / r_.squaredNorm();
    u_ = next;
    r_ = *found;
    damping_ = std::max(damping_ / 8, 1e-12);
    out_.converged = gain < options_.tolerance;
    return !out_.converged;
  }
  return false;
}

/// Covariance, intervals and correlations from the last Jacobian.
void Search::finish() {
  const auto n = static_cast<std::size_t>(count());
  out_.last.assign(r_.data(), r_.data() + r_.size());
  out_.parameters.resize(n);
  out_.correlation.assign(n, std::vector<double>(n, 0));
  std::vector<Index> free;
  for (std::size_t i = 0; i < n; ++i) {
    FittedParameter& p = out_.parameters[i];
    const auto k = static_cast<Index>(i);
    p.value = p.low = p.high = value_at(parameters_[i], u_[k]);
    p.at_low = u_[k] <= 0;
    p.at_high = u_[k] >= 1;
    p.without_effect = J_.size() > 0 && J_.col(k).squaredNorm() == 0;
    if (J_.size() > 0 && !p.at_low && !p.at_high && !p.without_effect) free.push_back(k);
  }
  if (free.empty()) return;
  MatrixXd J = J_(Eigen::all, free);
  const VectorXd length = J.colwise().norm();
  J = J * length.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(J.transpose() * J);
  const VectorXd values = eigen.eigenvalues().cwiseMax(0);
  const double largest = values.maxCoeff();
  out_.condition = values.minCoeff() > 0 ? std::sqrt(largest / values.minCoeff()) : unlimited;
  const auto freedom = static_cast<double>(r_.size()) - static_cast<double>(free.size());
  // A direction that changes nothing makes the parameters in it undetermined; the others keep their intervals.
  MatrixXd covariance = MatrixXd::Zero(count(), count()).topLeftCorner(values.size(), values.size());
  VectorXd lost = VectorXd::Zero(values.size());
  for (Index k = 0; k < values.size(); ++k) {
    const VectorXd direction = eigen.eigenvectors().col(k);
    covariance += direction * direction.transpose() / std::max(values[k], largest * singular * singular);
    if (values[k] < largest * singular * singular) lost = lost.cwiseMax(direction.cwiseAbs());
  }
  const double variance = freedom > 0 ? r_.squaredNorm() / freedom : unlimited;
  const double t = freedom > 0 ? boost::math::quantile(boost::math::students_t(freedom), 0.975) : unlimited;
  for (Index i = 0; i < values.size(); ++i) {
    const auto k = static_cast<std::size_t>(free[static_cast<std::size_t>(i)]);
    const FitParameter& p = parameters_[k];
    FittedParameter& fitted = out_.parameters[k];
    fitted.undetermined = lost[i] > 1e-3 || freedom <= 0;
    const double half = fitted.undetermined ? unlimited
                                            : t * std::sqrt(variance * covariance(i, i)) / length[i];
    const double u = u_[free[static_cast<std::size_t>(i)]];
    const auto unbounded = [&](double v) {
      return p.logarithmic ? p.low * math::exp(v * math::log(p.high / p.low)) : p.low + v * (p.high - p.low);
    };
    fitted.low = unbounded(u - half);
    fitted.high = unbounded(u + half);
    for (Index j = 0; j < values.size(); ++j)
      out_.correlation[k][static_cast<std::size_t>(free[static_cast<std::size_t>(j)])] =
          covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
  }
}

Result<LeastSquares> Search::run() {
  SL_TRY(check(parameters_));
  if (options_.most_evaluations < 1 + static_cast<int>(parameters_.size()))
    return Error{"the evaluations do not suffice for one step",
                 "allow more of them than there are parameters"};
  SL_TRY(begin());
  h_ = VectorXd::Constant(count(), 1e-3);
  // Where the search has come to rest other steps may serve better: once more, until that gains nothing.
  constexpr int most_passes = 4;
  for (int pass = 0; pass < most_passes; ++pass) {
    const double before = r_.squaredNorm();
    choose_steps();
    damping_ = 1e-3;
    out_.converged = false;
    while (jacobian() && improve()) {}
    if (pass > 0 && !(r_.squaredNorm() < before * (1 - options_.tolerance))) break;
  }
  jacobian();
  finish();
  return std::move(out_);
}

}  // namespace

Result<LeastSquares> least_squares(const std::vector<FitParameter>& parameters,
                                   const LeastSquaresOptions& options, const Evaluate& evaluate) {
  return Search(parameters, options, evaluate).run();
}

}  // namespace sandlot::statistics
