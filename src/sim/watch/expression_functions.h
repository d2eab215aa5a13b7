#pragma once
/// Functions and operators of expressions, with their rules for NaN. The grammar is in expression.cpp.
///
/// NaN     an argument that is NaN makes the result NaN: `nan < 1` is not "no".
/// Broken  an infinity or NaN computed from finite arguments. With `mark_broken` it becomes a NaN of its own kind, which
///         reaches the result of the expression unless an if() leaves it in the branch that is not taken.
/// Absent  no value at all, as of the mean of nothing: a NaN of its own kind as well, which a broken one outdoes.
#include <span>
#include <string_view>

#include "sim/watch/expression.h"

namespace sandlot {

using Apply = Expression::Apply;

struct FunctionRule {
  std::string_view name;
  int fewest, most;  ///< arguments
  Apply* apply;
};
struct OperatorRule {
  std::string_view sign;
  int precedence;  ///< higher binds tighter
  bool from_right;
  Apply* apply;
};

struct AggregateRule {
  std::string_view name;
  bool has_parameter;
  /// @param values  of the things; free to be put in order
  double (*reduce)(std::span<double> values, double parameter, bool mark_broken);
};

constexpr int lowest_precedence = 1;

/// Null where there is none of that name.
const FunctionRule* find_function(std::string_view name);
const OperatorRule* find_binary(std::string_view sign);
const OperatorRule* find_prefix(std::string_view sign);

const AggregateRule* find_aggregate(std::string_view name);

bool is_broken(double x);
bool is_absent(double x);

}  // namespace sandlot
