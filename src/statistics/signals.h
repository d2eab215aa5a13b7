#pragma once
/// Comparison of two sampled signals: mean error in percent, and lag by cross-correlation. Figures of a step response.
///
/// Limits   both signals are sampled at the same times, the lag at a constant interval.
/// Errors   signals of different lengths or none, numbers that are not finite or beyond 1e100.
/// Source   M. Sharifi et al., Modelling and simulation of a non-holonomic omnidirectional mobile robot (the MARIO paper), sec. 4.1
///          and Table 1: percentage of the velocity error, phase lag by cross-correlation. C. H. Knapp, G. C. Carter, The
///          generalized correlation method for estimation of time delay, IEEE Trans. ASSP 24 (1976), for the method.
#include <span>
#include <vector>

#include "base/result.h"

namespace sandlot::statistics {

/// 100 mean|measured - commanded| / mean|commanded|.
/// Errors   a command that is zero throughout, in addition to those above.
Result<double> percent_error(std::span<const double> commanded, std::span<const double> measured);

struct Lag {
  double lag_s = 0;        ///< positive: the second signal follows the first one
  double correlation = 0;  ///< coefficient at the sample next to it, -1..1
};

/// Shift of `follower` against `leader` at which they correlate best.
///
///   r(k) = corr(leader[i], follower[i + k]),  |k| <= max_lag / dt
///
/// Each coefficient is Pearson's over the samples that overlap at this shift, so that neither trend nor amplitude
/// counts. A parabola through the greatest one and its neighbours gives the part of a sample; of a sinusoid of
/// angular frequency w it errs by at most dt (w dt)^2 / 24.
/// @param dt_s       interval of the samples, > 0
/// @param max_lag_s  largest shift that is tried, > 0
/// Errors   a signal that is constant; a shift that leaves fewer than 4 samples; the best shift is the largest that was
///          tried: the true one may lie beyond it.
/// Limits   a lag of a whole period of a periodic signal looks like none: keep max_lag_s below half a period.
/// Cost     O(n max_lag / dt).
Result<Lag> lag(std::span<const double> leader, std::span<const double> follower, double dt_s,
                double max_lag_s);

/// The coefficients r(k) of lag() from -k to k, its curve; errors as there, but for the best shift.
Result<std::vector<double>> lag_correlations(std::span<const double> leader, std::span<const double> follower,
                                             double dt_s, double max_lag_s);

/// How a signal follows a step of its set point.
struct StepResponse {
  double rise_s = 0;     ///< from 10 % to 90 % of the step
  double overshoot = 0;  ///< largest excess beyond the end, as a share of the step; 0: none
  double settle_s = 0;   ///< from the step until the signal stays within 2 % of it around its end
  double error = 0;      ///< signal less set point at the end of the samples, in its unit
};

/// Figures of the samples from the step on. Crossings are found between samples by straight lines.
/// @param from, to  set point before and after; different
/// @param dt_s      interval of the samples, > 0
/// Errors   fewer than 4 samples; a signal that does not reach 90 %, or has not settled at the end.
Result<StepResponse> step_response(std::span<const double> signal, double from, double to, double dt_s);

}  // namespace sandlot::statistics
