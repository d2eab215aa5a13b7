#pragma once
/// Filters of names as simulation_interfaces has them: a POSIX extended regular expression that is found anywhere in the name.
/// Written here because filters come from the network: std::regex and regcomp() take exponential time or memory for some of
/// them, and 100 lines are less than a dependency on RE2, whose linear time this matcher has too.
///
/// Known    letters, `.`, `[a-z]`, `[^a-z]`, `\.`, and `*`, `+`, `?` behind one of them; `^` at the beginning, `$` at the end.
/// Errors   alternatives, groups, counts `{2,3}` and back references are refused: matching takes time that grows with the
///          product of the lengths alone, whatever is written.
#include <bitset>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace sandlot::server {

class NameFilter {
 public:
  static Result<NameFilter> compile(std::string_view text);
  bool matches(std::string_view name) const;

 private:
  struct Part {
    std::bitset<256> letters;
    bool optional = false, repeated = false;
  };
  std::vector<Part> parts_;
  bool from_begin_ = false, to_end_ = false;
};

}  // namespace sandlot::server
