#pragma once
/// Step of the estimator (ekf.h): one sample after the other, each compared with the estimate at its time.
#include "navigation/estimation/ekf.h"

namespace sandlot::navigation::ekf {

/// Greatest value and variance that a filter goes on with.
inline constexpr double most_core = 1e30;

/// What two_d_mode holds at 0.
inline constexpr std::array<bool, states> pinned_in_plane = {
    false, false, true, true, true, false, false, false, true, true, true, false, false, false, true};

struct Processed {
  Outcome outcome = Outcome::used;
  double squared_distance = 0;
  std::size_t components = 0;
};

/// Filter before the first sample.
Core first_core(const Spec& spec);
/// Variances by which the components become unsure in a second.
Vector process_noise(const Spec& spec);
/// Whether nothing has grown beyond what the next step can take without overflow.
bool sound_core(const Core& core);
/// What the datum was moved by stays known when the filter begins again, but not what it shares with the rest.
void keep_datum(const Spec& spec, const Core& from, Core& to);

/// Predicts to a sample's time, compares and corrects.
/// @pre the sample's order is after the core's
Processed process(const Spec& spec, const Vector& noise, Core& core, const Sample& sample);

}  // namespace sandlot::navigation::ekf
