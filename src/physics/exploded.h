#pragma once
/// Errors of an engine about a body with whose state no step can be made.
#include <cmath>
#include <string>

#include "base/result.h"
#include "base/text.h"

namespace sandlot {

/// Remedy in those errors.
inline constexpr const char* remedy = "a smaller time step, or less extreme masses, forces and speeds";

/// @param body  instance/link
inline Error not_finite(const std::string& body) {
  return {"the state of '" + body + "' is no longer finite", remedy};
}

struct Excess {
  double is, most;
};
/// @param speed, spin  [m/s], [rad/s], of which one is too large
inline Error exploded(const std::string& body, Excess speed, Excess spin) {
  const bool runs = speed.is > speed.most;
  return {"'" + body + "' has exploded: it " +
              (runs ? "moves at " + number_text(std::round(speed.is)) + " m/s, above max_speed, " +
                          number_text(speed.most) + " m/s"
                    : "turns at " + number_text(std::round(spin.is)) + " rad/s, above max_spin, " +
                          number_text(spin.most) + " rad/s"),
          std::string(remedy) + "; if it is meant to be that fast, raise physics." +
              (runs ? "max_speed" : "max_spin")};
}

}  // namespace sandlot
