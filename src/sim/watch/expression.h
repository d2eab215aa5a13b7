#pragma once
/// Arithmetic over named values, as scenarios and the command line write it: `hypot(a.pose.x, a.pose.y) > 3 m`.
///
/// Operators   by rising precedence: or ||, and &&, not, == !=, < <= > >=, + -, * / with ! and signs, ^ (from the right).
///             Comparisons and logic give 1 or 0. Numbers may carry a unit (90 deg, 5 cm) and are then in SI.
/// Functions   functions() lists them. Constants: pi, true, false.
/// Division    a `/` belongs to an address where the longest prefix with it names something; with a blank before or
///             after, it always divides.
/// NaN         whatever it goes into is NaN: `nan < 1` is not "no".
/// Errors      compile() names the column within the expression. Texts are limited to 2000 characters, 400 parts and
///             parentheses 40 deep.
/// Cost        evaluate() calls a function per operator and allocates nothing. The same bits on every machine: all
///             mathematics is from base/math.h.
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace sandlot {

/// What the words of an expression may name.
class Names {
 public:
  virtual ~Names() = default;
  /// Length of the longest beginning of `text` that names a value; 0: none.
  virtual std::size_t match(std::string_view text) const = 0;
  /// The complaint about a word that names nothing.
  virtual Error unknown(std::string_view word) const = 0;
};

class Expression {
 public:
  /// @param place  where the text stands; goes into errors
  static Result<Expression> compile(std::string_view text, const Names& names, const Place& place = {});
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  const std::string& text() const { return text_; }
  /// The names in it, each once, in order of appearance.
  std::span<const std::string> inputs() const { return inputs_; }

  struct Evaluated {
    double value;
    bool finite;  ///< false too when finite numbers gave an infinity or NaN on the way: 1 / 0 > 3
  };
  /// @pre one number per input
  Evaluated evaluate(std::span<const double> inputs);

  /// "hypot(x, y)", with what it gives.
  struct Function {
    const char* call;
    const char* help;
  };
  static std::span<const Function> functions();
  /// True for words that cannot be names: functions, constants, `and`, `or`, `not`.
  static bool is_reserved(std::string_view word);

 private:
  struct Compiled;
  Expression(std::string text, std::vector<std::string> inputs, std::unique_ptr<Compiled> compiled);
  std::string text_;
  std::vector<std::string> inputs_;
  std::unique_ptr<Compiled> compiled_;
};

}  // namespace sandlot
