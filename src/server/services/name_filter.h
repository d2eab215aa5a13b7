#pragma once
/// Filters of names as simulation_interfaces has them: a POSIX extended regular expression that is found anywhere in the name.
/// Written here because filters come from the network: std::regex and regcomp() take exponential time or memory for some of
/// them, and 200 lines are less than a dependency on RE2, whose linear time this matcher has too.
///
/// Known    letters, `.`, `[a-z]`, `[^a-z]`, `[[:alpha:]]`, `\.`, groups, alternatives, `*`, `+`, `?`, `{2}`, `{2,}`, `{2,3}`, `^`, `$`.
/// Errors   back references, collating elements, and what becomes longer than most_states when counts are written out.
/// Cost     matching takes time that grows with the product of both lengths alone, whatever is written.
/// Source   K. Thompson, Regular Expression Search Algorithm (1968).
#include <bitset>
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace sandlot::server {

class NameFilter {
 public:
  static constexpr std::size_t most_letters = 1000, most_states = 5000;
  static Result<NameFilter> compile(std::string_view text);
  bool matches(std::string_view name) const;

 private:
  class Parser;
  struct State {
    enum class Kind : std::uint8_t { letter, split, begin, end, found } kind = Kind::found;
    std::uint32_t letters = 0;          ///< of a letter: index of those that fit
    std::uint32_t next = 0, other = 0;  ///< other: of a split
  };
  std::vector<State> states_;
  std::vector<std::bitset<256>> letters_;
};

}  // namespace sandlot::server
