#pragma once
/// Functions and operators of expressions, with their rules for NaN. The grammar is in expression.cpp.
///
/// NaN     an argument that is NaN makes the result NaN: `nan < 1` is not "no".
/// Broken  an infinity or NaN computed from finite arguments. With `mark_broken` it becomes a NaN of its own kind, which
///         reaches the result of the expression unless an if() leaves it in the branch that is not taken.
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

constexpr int lowest_precedence = 1;

/// Null where there is none of that name.
const FunctionRule* find_function(std::string_view name);
const OperatorRule* find_binary(std::string_view sign);
const OperatorRule* find_prefix(std::string_view sign);

bool is_broken(double x);

}  // namespace sandlot
