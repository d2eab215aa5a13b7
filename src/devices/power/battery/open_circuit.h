#pragma once
/// Open-circuit voltage of a battery over what is left in it: between the points of a list linear over the charge.
///
///   V(s) = V_k + g (s - s_k)                     s: charge left, a share of the whole; g: slope of the piece
///   w(s) = w_k + V_k (s - s_k) + g (s - s_k)^2 / 2          energy left per charge of a full battery [J/C]
///
/// A battery counts its energy; from it follow, in closed form, voltage and charge:
///
///   V = sqrt(V_k^2 + 2 g (w - w_k)),   s = s_k + 2 (w - w_k) / (V_k + V)
///
/// so that what is drained is what is stored, however the voltage falls.
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/fields.h"
#include "base/prefetch.h"

namespace sandlot::battery {

struct Point {
  double charge = 0, voltage_V = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"charge", "1", "Charge left, as a share of the whole.", 0, 1, Field::required}, s.charge);
    visit(Field{"voltage", "V", "Open-circuit voltage at this charge.", 1e-3, 1e6, Field::required},
          s.voltage_V);
  }
};

class OpenCircuit {
 public:
  OpenCircuit() = default;
  /// @pre from charge 0 to 1, ascending; at least two points
  explicit OpenCircuit(std::span<const Point> points) {
    double energy = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point& p = points[i];
      if (i > 0) energy += 0.5 * (points[i - 1].voltage_V + p.voltage_V) * (p.charge - points[i - 1].charge);
      knots_.push_back({p.charge, p.voltage_V, energy, 0});
      if (i > 0)
        knots_[i - 1].slope = (p.voltage_V - points[i - 1].voltage_V) / (p.charge - points[i - 1].charge);
    }
  }

  /// Energy of a full battery per charge of it [J/C], which is the mean of the voltage [V].
  double mean_V() const { return knots_.back().energy; }

  struct At {
    double voltage_V = 0, charge = 0;
  };
  /// @param energy  left, per charge of a full battery [J/C]
  At at(double energy) const {
    const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, energy,
                                        [](double e, const Knot& knot) { return e < knot.energy; });
    const Knot& k = *(above - 1);
    const double more = energy - k.energy;
    // Where the voltage does not fall, the root of its square is itself, to the last bit.
    const double voltage = k.slope == 0
                               ? k.voltage_V
                               : std::sqrt(std::max(0.0, k.voltage_V * k.voltage_V + 2 * k.slope * more));
    return {voltage, std::clamp(k.charge + 2 * more / (k.voltage_V + voltage), 0.0, 1.0)};
  }
  /// Energy left at a charge, per charge of a full battery [J/C].
  double energy_at(double charge) const {
    const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, charge,
                                        [](double s, const Knot& knot) { return s < knot.charge; });
    const Knot& k = *(above - 1);
    const double more = charge - k.charge;
    return k.energy + more * (k.voltage_V + 0.5 * k.slope * more);
  }

  /// Asks for its memory.
  void expect() const { prefetch(knots_.data(), knots_.size()); }

 private:
  struct Knot {
    double charge = 0, voltage_V = 0, energy = 0, slope = 0;
  };
  std::vector<Knot> knots_;
};

}  // namespace sandlot::battery
