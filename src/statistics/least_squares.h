#pragma once
/// Nonlinear least squares within bounds: Levenberg-Marquardt with differences whose steps suit the residuals.
///
///   minimise |r(x)|^2, low <= x <= high
///
/// Method   x is scaled to [0, 1] by its bounds, by their logarithm where `logarithmic`. A parameter at a bound whose gradient
///          points outwards is held there for the step. Marquardt's damping by the diagonal of J'J. A screening comes first: the
///          starting point and points of a Halton sequence; the best of them is where the search begins. Differences are central; the step of
///          each parameter is the one of five at which the second difference is the smallest part of the first, so that residuals with
///          jumps, as those of quantised sensors, are seen at the scale of the whole. Chosen anew where the search rests.
/// Result   covariance s^2 (J'J)^-1 of the parameters that are free, s^2 = |r|^2 / (n - free); 95 % intervals are Student's,
///          cut off at nothing. Parameters at a bound, and those that change no residual, are not free.
/// Errors   no parameter, bounds that are not low < high, a logarithm of what is not positive, a start outside, no point that can
///          be evaluated, fewer residuals than parameters.
/// Limits   finds the minimum near the best point of the screening, which need not be the least one. Intervals are those of the
///          linearised model with independent errors of one size.
/// Source   D. W. Marquardt, An Algorithm for Least-Squares Estimation of Nonlinear Parameters, SIAM J. 11 (1963).
///          J. H. Halton, On the efficiency of certain quasi-random sequences, Numer. Math. 2 (1960).
#include <functional>
#include <optional>
#include <vector>

#include "base/result.h"

namespace sandlot::statistics {

struct FitParameter {
  double start = 0, low = 0, high = 1;
  bool logarithmic = false;
};

struct LeastSquaresOptions {
  int most_evaluations = 200;  ///< never exceeded
  int screening = 0;           ///< points tried before the search, in addition to the start
  double largest_step = 0.25;  ///< of a scaled parameter in one iteration
  double tolerance = 1e-7;     ///< relative decrease of the sum of squares that ends the search
};

struct FittedParameter {
  double value = 0, low = 0, high = 0;  ///< with its 95 % interval; both are the value where it is not free
  bool at_low = false, at_high = false;
  bool without_effect = false;  ///< no residual changes with it
  bool undetermined =
      false;  ///< free, but the residuals do not tell it apart from others: the interval is infinite
};

struct LeastSquares {
  std::vector<FittedParameter> parameters;
  std::vector<double> first,
      last;  ///< residuals at the start (empty: it could not be evaluated) and at the end
  std::vector<std::vector<double>> correlation;  ///< of each two parameters; 0 where one is not free
  double condition = 1;                          ///< ratio of singular values of J with columns of length 1
  int evaluations = 0, failed = 0;
  bool converged = false;
};

/// Residuals at each of several points, in their order; no value: that point cannot be evaluated. Residuals that are not finite
/// count as such. The points of one call may be evaluated at a time.
using Evaluate =
    std::function<std::vector<std::optional<std::vector<double>>>(const std::vector<std::vector<double>>&)>;

Result<LeastSquares> least_squares(const std::vector<FitParameter>& parameters,
                                   const LeastSquaresOptions& options, const Evaluate& evaluate);

}  // namespace sandlot::statistics
