#pragma once
/// Expression: arithmetic over named values in scenarios and on the command line, `hypot(a.pose.x, a.pose.y) > 3 m`.
///
/// Operators   by rising precedence: or ||, and &&, not, == !=, < <= > >=, + -, * / with ! and signs, ^ (from the right).
///             Comparisons and logic give 1 or 0. Numbers may carry a unit (90 deg, 5 cm) and are then in SI.
/// Functions   functions() lists them. Constants: pi, true, false.
/// Division    a `/` belongs to an address where the longest prefix with it names something; with a blank before or
///             after, it always divides.
/// NaN         makes every result that depends on it NaN: `nan < 1` is not "no".
/// Errors      compile() names the column within the expression. Limits: 2000 characters, 400 tokens, parentheses 40
///             deep.
/// Cost        evaluate() calls a function per operator and allocates nothing. The same bits on every machine: all
///             mathematics is from base/math.h.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace sandlot {

/// Values that an expression may name.
class Names {
 public:
  virtual ~Names() = default;
  /// Length of the longest prefix of `text` that names a value; 0: none.
  virtual std::size_t match(std::string_view text) const = 0;
  /// The error for a word that names nothing.
  virtual Error unknown(std::string_view word) const = 0;
};

class Expression {
 public:
  /// @param place  of the text in its file; goes into errors
  static Result<Expression> compile(std::string_view text, const Names& names, const Place& place = {});

  const std::string& text() const { return text_; }
  /// Names in the text, each once, in order of appearance.
  std::span<const std::string> inputs() const { return inputs_; }

  struct Evaluated {
    double value;
    bool finite;  ///< false also when a step made an infinity or NaN of finite numbers: 1 / 0 > 3
  };
  /// @pre one number per input
  Evaluated evaluate(std::span<const double> inputs);

  /// A function as help shows it: "hypot(x, y, ...)" and its result.
  struct Function {
    const char* call;
    const char* help;
  };
  static std::span<const Function> functions();
  /// True for words that cannot be names: functions, constants, `and`, `or`, `not`.
  static bool is_reserved(std::string_view word);

  /// A function or operator of `count` arguments. `mark_broken`: see expression_functions.h.
  using Apply = double(const double* arguments, int count, bool mark_broken);

 private:
  class Parser;
  /// One step of the evaluation on a stack: a constant or an input is pushed; a call replaces its arguments by its result.
  struct Node {
    enum class Kind : std::uint8_t { constant, input, call } kind;
    int index = 0;  ///< input: which; call: number of arguments
    double constant = 0;
    Apply* apply = nullptr;
  };
  Expression() = default;
  double run(std::span<const double> inputs, bool mark_broken);

  std::string text_;
  std::vector<std::string> inputs_;
  std::vector<Node> nodes_;  ///< in order of evaluation
  std::vector<double> stack_;
};

}  // namespace sandlot
