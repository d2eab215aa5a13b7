#pragma once
/// Differences between two worlds, value by value, by the addresses of sim/watch/values.h.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/world/simulation.h"

namespace sandlot::record {

struct ValueDifference {
  std::string address;  ///< "rover/laser.state.bias"
  std::string unit;
  std::optional<double> a, b;  ///< nothing: there is no such value on that side
  std::size_t more =
      0;  ///< further elements of the same list that differ: of a list the first one stands here

  /// "rover.pose.x 0.31 m against 0.29 m"
  std::string text() const;
};

struct ValueDifferences {
  std::vector<ValueDifference> first;  ///< in the order of `parts`, then of the addresses
  std::size_t count = 0;               ///< of all values
  std::size_t entries = 0;             ///< of all of which `first` holds the first: a list counts once
};

/// Compares the values of the entities, devices and programs named in `parts`, bit by bit (two NaN are the same).
/// @param most  so many entries are kept; all are counted
ValueDifferences differing_values(const Simulation& a, const Simulation& b,
                                  std::span<const std::string> parts, std::size_t most);

/// In what the two were built from: name, engine, seed, step, things and robots, each a sentence "seed: 1 against 2".
std::vector<std::string> differing_setups(const Simulation& a, const Simulation& b);

}  // namespace sandlot::record
