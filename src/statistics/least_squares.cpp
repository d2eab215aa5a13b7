#include "statistics/least_squares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/math.h"
#include "statistics/dense.h"
#include "statistics/quantiles.h"

namespace sandlot::statistics {
namespace {

using Numbers = std::vector<double>;
using Points = std::vector<Numbers>;

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

bool all_finite(const Numbers& x) {
  return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
}
/// a + scale b
Numbers sum(Numbers a, double scale, const Numbers& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += scale * b[i];
  return a;
}
/// The symmetric matrix of the products of each two columns.
Dense products(const std::vector<const Numbers*>& columns) {
  Dense out(columns.size(), columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) out(i, j) = out(j, i) = dot(*columns[i], *columns[j]);
  return out;
}

class Search {
 public:
  Search(const std::vector<FitParameter>& parameters, const LeastSquaresOptions& options,
         const Evaluate& evaluate)
      : parameters_(parameters), options_(options), evaluate_(evaluate) {}

  Result<LeastSquares> run();

 private:
  std::size_t count() const { return parameters_.size(); }
  int left() const { return options_.most_evaluations - out_.evaluations; }
  /// Whether so many more evaluations are allowed.
  bool left(std::size_t evaluations) const {
    return left() > 0 && static_cast<std::size_t>(left()) >= evaluations;
  }
  std::vector<std::optional<Numbers>> at(const Points& points);
  Status begin();
  /// Points of a difference of one parameter.
  struct Probe {
    std::array<Numbers, 2> points;
    double step = 0;  ///< to the first point
    bool central = false;
  };
  Probe probe(std::size_t i, double step) const;
  void choose_steps();
  bool jacobian();
  bool improve();
  std::vector<std::size_t> moving(const Numbers& gradient) const;
  void finish();

  const std::vector<FitParameter>& parameters_;
  const LeastSquaresOptions& options_;
  const Evaluate& evaluate_;
  LeastSquares out_;
  Numbers u_, r_;
  Points J_;   ///< columns, of the point u_
  Numbers h_;  ///< steps of differences
  double damping_ = 1e-3;
};

std::vector<std::optional<Numbers>> Search::at(const Points& points) {
  Points values;
  for (const Numbers& u : points) {
    values.emplace_back();
    for (std::size_t i = 0; i < count(); ++i) values.back().push_back(value_at(parameters_[i], u[i]));
  }
  out_.evaluations += static_cast<int>(points.size());
  std::vector<std::optional<Numbers>> found = evaluate_(values);
  for (auto& r : found) {
    if (r && !(all_finite(*r) && (r_.empty() || r->size() == r_.size()))) r.reset();
    if (!r) ++out_.failed;
  }
  found.resize(points.size());
  return found;
}

/// Evaluates the start and the points of the screening; the search begins at the best.
Status Search::begin() {
  Points points(1);
  for (const FitParameter& p : parameters_) points[0].push_back(scaled(p, p.start));
  for (int k = 1; k <= std::min(options_.screening, options_.most_evaluations - 1); ++k) {
    points.emplace_back();
    for (std::size_t i = 0; i < count(); ++i) points.back().push_back(halton(k, prime(i)));
  }
  const auto found = at(points);
  if (found[0]) out_.first = *found[0];
  double best = unlimited;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!found[k] || !(squared_norm(*found[k]) < best)) continue;
    best = squared_norm(*found[k]);
    u_ = points[k];
    r_ = *found[k];
  }
  if (r_.empty()) return Error{"no point can be evaluated, neither the start nor one of the screening"};
  if (r_.size() < count())
    return Error{"there are fewer residuals than parameters", "compare more values, or fit fewer parameters"};
  return {};
}

/// Points of a difference about u_: to both sides, or twice to one where a bound is near.
Search::Probe Search::probe(std::size_t i, double step) const {
  Probe out{{u_, u_}, step, u_[i] - step >= 0 && u_[i] + step <= 1};
  if (!out.central && u_[i] + 2 * step > 1) out.step = -step;
  out.points[0][i] += out.step;
  out.points[1][i] += out.central ? -out.step : 2 * out.step;
  return out;
}

/// Chooses for each parameter the step of its differences: the one whose second difference is the smallest part of its first. Where steps
/// are large that part is curvature; where they are small it is what residuals with jumps, as those of quantised sensors, do by chance.
void Search::choose_steps() {
  if (!left(count() * (2 * steps.size() + 2) + 1)) return;
  Points points;
  for (std::size_t i = 0; i < count(); ++i)
    for (const double step : steps)
      for (const Numbers& point : probe(i, step).points) points.push_back(point);
  const auto found = at(points);
  for (std::size_t i = 0; i < count(); ++i) {
    double best = unlimited;
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const auto index = 2 * (i * steps.size() + k);
      const auto &one = found[index], &other = found[index + 1];
      if (!one || !other) continue;
      const bool central = probe(i, steps[k]).central;
      double first = 0, second = 0;  // squares of their lengths
      for (std::size_t m = 0; m < r_.size(); ++m) {
        const double to = (*one)[m], beyond = (*other)[m], here = r_[m];
        const double difference = central ? (to - beyond) / 2 : to - here;
        const double bend = central ? to + beyond - 2 * here : beyond - 2 * to + here;
        first += difference * difference;
        second += bend * bend;
      }
      if (!(first > 0) || !(std::sqrt(second) < best * std::sqrt(first))) continue;
      best = std::sqrt(second / first);
      h_[i] = steps[k];
    }
  }
}

/// Differences at u_. False: no evaluations are left, or a column cannot be had.
bool Search::jacobian() {
  if (!left(count())) return false;
  const bool both = left(2 * count() + 1);
  Points points;
  for (std::size_t i = 0; i < count(); ++i) {
    const Probe each = probe(i, h_[i]);
    points.push_back(each.points[0]);
    if (both && each.central) points.push_back(each.points[1]);
  }
  const auto found = at(points);
  J_.assign(count(), {});
  std::size_t next = 0;
  const auto slope = [](const Numbers& to, const Numbers& from, double step) {
    Numbers out = sum(to, -1, from);
    for (double& x : out) x /= step;
    return out;
  };
  for (std::size_t i = 0; i < count(); ++i) {
    const Probe each = probe(i, h_[i]);
    const bool two = both && each.central;
    const auto& one = found[next];
    const auto* const other = two ? &found[next + 1] : nullptr;
    next += two ? 2 : 1;
    if (one && other && *other) J_[i] = slope(*one, **other, 2 * each.step);
    else if (one) J_[i] = slope(*one, r_, each.step);
    else if (other && *other) J_[i] = slope(r_, **other, each.step);
    else return false;
  }
  return true;
}

/// Parameters that a step may change: not those without effect, nor those held by a bound.
std::vector<std::size_t> Search::moving(const Numbers& gradient) const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < count(); ++i) {
    const bool held = (u_[i] <= 0 && gradient[i] > 0) || (u_[i] >= 1 && gradient[i] < 0);
    if (!held && squared_norm(J_[i]) > 0) out.push_back(i);
  }
  return out;
}

/// One step downhill. False: the search has ended.
bool Search::improve() {
  Numbers gradient;
  for (const Numbers& column : J_) gradient.push_back(dot(column, r_));
  const std::vector<std::size_t> free = moving(gradient);
  if (free.empty() || squared_norm(r_) == 0) {
    out_.converged = true;
    return false;
  }
  std::vector<const Numbers*> J;
  Numbers right;
  for (const std::size_t i : free) J.push_back(&J_[i]), right.push_back(-gradient[i]);
  const Dense JJ = products(J);
  for (; left() > 0; damping_ *= 8) {
    if (damping_ > 1e12) {
      out_.converged = true;  // no smaller step goes downhill either
      return false;
    }
    Dense A = JJ;
    for (std::size_t i = 0; i < free.size(); ++i) A(i, i) *= 1 + damping_;
    const Numbers step = Factors(std::move(A)).solve(right);
    if (!all_finite(step)) continue;
    Numbers next = u_;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const double most = options_.largest_step;
      next[free[i]] = std::clamp(u_[free[i]] + std::clamp(step[i], -most, most), 0.0, 1.0);
    }
    const auto found = at({next})[0];
    if (!found || !(squared_norm(*found) < squared_norm(r_))) continue;
    const double gain = 1 - squared_norm(*found) / squared_norm(r_);
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
  out_.last = r_;
  out_.parameters.resize(count());
  out_.correlation.assign(count(), Numbers(count(), 0));
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < count(); ++i) {
    FittedParameter& p = out_.parameters[i];
    p.value = p.low = p.high = value_at(parameters_[i], u_[i]);
    p.at_low = u_[i] <= 0;
    p.at_high = u_[i] >= 1;
    p.without_effect = !J_.empty() && squared_norm(J_[i]) == 0;
    if (!J_.empty() && !p.at_low && !p.at_high && !p.without_effect) free.push_back(i);
  }
  if (free.empty()) return;
  // Columns of length 1.
  Points J;
  Numbers length;
  std::vector<const Numbers*> columns;
  for (const std::size_t i : free) {
    length.push_back(std::sqrt(squared_norm(J_[i])));
    J.push_back(J_[i]);
    for (double& x : J.back()) x *= 1 / length.back();
  }
  for (const Numbers& column : J) columns.push_back(&column);
  EigenPairs eigen = eigen_pairs(products(columns));
  Numbers& values = eigen.values;
  for (double& value : values) value = std::max(value, 0.0);
  const std::size_t n = free.size();
  const double largest = values.back(), floor = largest * singular * singular;
  out_.condition = values.front() > 0 ? std::sqrt(largest / values.front()) : unlimited;
  const auto freedom = static_cast<double>(r_.size()) - static_cast<double>(n);
  // A direction that changes nothing makes the parameters in it undetermined; the others keep their intervals.
  Dense covariance(n, n);
  Numbers lost(n, 0);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j)
        covariance(i, j) += eigen.vectors(i, k) * eigen.vectors(j, k) / std::max(values[k], floor);
      if (values[k] < floor) lost[i] = std::max(lost[i], std::abs(eigen.vectors(i, k)));
    }
  const double variance = freedom > 0 ? squared_norm(r_) / freedom : unlimited;
  const double t = freedom > 0 ? students_t_quantile(0.975, freedom) : unlimited;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = free[i];
    const FitParameter& p = parameters_[k];
    FittedParameter& fitted = out_.parameters[k];
    fitted.undetermined = lost[i] > 1e-3 || freedom <= 0;
    const double half = fitted.undetermined ? unlimited
                                            : t * std::sqrt(variance * covariance(i, i)) / length[i];
    const auto unbounded = [&](double v) {
      return p.logarithmic ? p.low * math::exp(v * math::log(p.high / p.low)) : p.low + v * (p.high - p.low);
    };
    fitted.low = unbounded(u_[k] - half);
    fitted.high = unbounded(u_[k] + half);
    for (std::size_t j = 0; j < n; ++j)
      out_.correlation[k][free[j]] = covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
  }
}

Result<LeastSquares> Search::run() {
  SL_TRY(check(parameters_));
  if (options_.most_evaluations < 1 + static_cast<int>(parameters_.size()))
    return Error{"the evaluations do not suffice for one step",
                 "allow more of them than there are parameters"};
  SL_TRY(begin());
  h_.assign(count(), 1e-3);
  // Where the search has come to rest other steps may serve better: once more, until that gains nothing.
  constexpr int most_passes = 4;
  for (int pass = 0; pass < most_passes; ++pass) {
    const double before = squared_norm(r_);
    choose_steps();
    damping_ = 1e-3;
    out_.converged = false;
    while (jacobian() && improve()) {}
    if (pass > 0 && !(squared_norm(r_) < before * (1 - options_.tolerance))) break;
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
