#pragma once
/// Stages of distances that were measured by light or sound: growing, mixed, short, multipath. Symbols as in
/// noise/additive.h; E ~ Exponential(1).
///
/// Errors   a bad spec is refused when it is read.
/// Cost     one draw per value (short, multipath: two where one occurs); no allocation.
/// Source   S. Thrun et al., Probabilistic Robotics (2005), sec. 6.3.1 (p_short; its other terms are
///          gaussian, and outliers and dropouts of noise/faults.h); C. Ye, J. Borenstein, Characterization of
///          a 2-D Laser Scanner for Mobile Robot Obstacle Negotiation (2002) (mixed pixels).
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "noise/additive.h"

namespace sandlot {

/// y = x + e std (|x| / at)^power n.   The error of a weak echo: `std` at the distance `at`, and more beyond it.
struct GrowingSpec {
  static constexpr const char* name = "growing";
  static constexpr const char* help = "Independent normal errors that grow with a power of the value.";
  double std = 0, at = 1, power = 2;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned flags = Field::tunable | Field::required;
    visit(Field{"std", "", "Standard deviation of the error at the value `at`.", 0, max_error, flags}, s.std);
    visit(Field{"at", "", "Value at which the standard deviation is `std`.", 1e-6, max_error, flags}, s.at);
    visit(Field{"power", "1", "Exponent of the value; 2 is that of distances by parallax or of an echo.", 0,
                8, Field::tunable},
          s.power);
  }
  double corrupt(double x, const NoiseSample& sample, Stream& random) const {
    const double n = random.normal();  // drawn in any case: what comes in moves nobody's numbers
    if (!std::isfinite(x)) return x;
    const double share = std::abs(x) / at;
    const double growth = power == 2 ? share * share : share > 0 || power == 0 ? math::pow(share, power) : 0;
    return x + sample.errors * std * growth * n;
  }
};

/// A beam that meets an edge returns something from both sides: where the neighbours in a scan, x before x',
/// differ by more than `jump`, with the probability e rate y = x + u (x' - x). The rate is about beam width /
/// spacing of beams. Of both beams at an edge each is drawn for. Does nothing to single values; neighbours
/// are those in the order of the scan.
struct MixedSpec {
  static constexpr const char* name = "mixed";
  static constexpr const char* help =
      "Beams of a scan that meet an edge show something between both surfaces.";
  double rate = 0, jump = 0;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned flags = Field::tunable | Field::required;
    visit(Field{"rate", "1", "Probability of an error per beam at an edge.", 0, 1, flags}, s.rate);
    visit(Field{"jump", "", "Smallest difference between neighbours that counts as an edge.", 0, max_error,
                flags},
          s.jump);
  }
  double corrupt(State&, double x, const NoiseSample&, Stream&) const { return x; }
  void corrupt(State&, std::span<float> values, const NoiseSample& sample, Stream& random) const {
    const double odds = std::min(1.0, rate * sample.errors);
    float before = values.empty() ? 0 : values.front();
    for (std::size_t i = 0; i < values.size(); ++i) {
      const float here = values[i], after = i + 1 < values.size() ? values[i + 1] : here;
      const double hit = random.uniform(), share = random.uniform();
      const auto edge = [&](float other) {
        return std::isfinite(here) && std::isfinite(other) &&
               static_cast<double>(std::abs(other - here)) > jump;
      };
      const float other = edge(before) ? before : edge(after) ? after : here;
      if (other != here && hit < odds)
        values[i] = static_cast<float>(static_cast<double>(here) + share * static_cast<double>(other - here));
      before = here;
    }
  }
};

/// With the probability e rate something in front is met: y = mean E, given that this is below x. Also where
/// nothing was met.
struct ShortSpec {
  static constexpr const char* name = "short";
  static constexpr const char* help = "Occasional objects in front of what is measured: dust, rain, people.";
  double rate = 0, mean = 1;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned flags = Field::tunable | Field::required;
    visit(Field{"rate", "1", "Probability per value that something is in front.", 0, 1, flags}, s.rate);
    visit(Field{"mean", "", "Mean distance of what is in front.", 1e-6, max_error, flags}, s.mean);
  }
  double corrupt(double x, const NoiseSample& sample, Stream& random) const {
    if (random.uniform() >= std::min(1.0, rate * sample.errors) || !(x > 0)) return x;
    // The exponential distribution cut at x; of an infinite x the whole.
    const double share = random.uniform() * (1 - math::exp(-x / mean));
    return std::min(x, -mean * math::log(1 - share));
  }
};

/// With the probability e rate the echo came by a longer way: y = x + mean E.
struct MultipathSpec {
  static constexpr const char* name = "multipath";
  static constexpr const char* help = "Occasional echoes by a longer way, as of sound from a smooth wall.";
  double rate = 0, mean = 1;
  using State = NoFields;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned flags = Field::tunable | Field::required;
    visit(Field{"rate", "1", "Probability per value of an echo by a longer way.", 0, 1, flags}, s.rate);
    visit(Field{"mean", "", "Mean of the additional distance.", 0, max_error, flags}, s.mean);
  }
  double corrupt(double x, const NoiseSample& sample, Stream& random) const {
    if (random.uniform() >= std::min(1.0, rate * sample.errors) || !std::isfinite(x)) return x;
    return x - mean * math::log(1 - random.uniform());
  }
  double variance(double) const { return rate * (2 - rate) * mean * mean; }
};

}  // namespace sandlot
