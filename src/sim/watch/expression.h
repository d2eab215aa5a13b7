#pragma once
/// Expression: arithmetic over named values in scenarios and on the command line, `hypot(a.pose.x, a.pose.y) > 3 m`.
///
/// Operators   by rising precedence: or ||, and &&, not, == !=, < <= > >=, + -, * / with ! and signs, ^ (from the right).
///             Comparisons and logic give 1 or 0. Numbers may carry a unit (90 deg, 5 cm) and are then in SI.
/// Functions   functions() lists them. Constants: pi, true, false.
/// Division    a `/` belongs to an address where the longest prefix with it names something; with a blank before or
///             after, it always divides.
/// Aggregates  over things whose names fit a pattern: mean(red*.pose.x), count(box*.pose.x > 2 where box*.pose.y > 0). The `*`
///             stands for any letters, in the name of a robot or object alone. What a thing has no value for passes it over.
///             Within each other, the first pattern belongs to the outermost: mean(min(abs(red*.pose.x - blue*.pose.x))) is, on
///             average over the reds, how near the nearest blue is.
/// NaN         makes every result that depends on it NaN: `nan < 1` is not "no".
/// Errors      compile() names the column within the expression. Limits: 2000 characters, 400 tokens, parentheses 40 deep,
///             aggregates three deep.
/// Cost        evaluate() calls a function per operator and allocates nothing once tables have their size; aggregates within each
///             other cost the product of their things. The same bits on every machine: all mathematics is from base/math.h.
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
  /// Likewise of a value of several things: "red*.pose.x". None where these names know no patterns.
  virtual std::size_t match_pattern(std::string_view) const { return 0; }
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

  /// Things of an aggregate and what it reads of each.
  struct Pattern {
    std::string things;              ///< "red*"
    std::vector<std::string> reads;  ///< what follows the name: ".pose.x", "/laser.range_min"
  };
  /// Those of all aggregates, an outer one before those within it.
  std::span<const Pattern> patterns() const { return patterns_; }
  /// How deep aggregates lie within each other: 0 none, 1 side by side. Their cost is the product of their things.
  int nesting() const { return nesting_; }
  static constexpr int most_nesting = 3;
  /// The values of a pattern: for each of its things the reads in order, no_value() where there is none.
  struct Table {
    std::size_t things = 0;
    std::span<const double> values;
  };

  struct Evaluated {
    double value;
    bool finite;          ///< false also when a step made an infinity or NaN of finite numbers: 1 / 0 > 3
    bool absent = false;  ///< no value, as of the mean of nothing
    bool broken = false;  ///< not finite because a step made it so, not because an input was
  };
  /// @pre one number per input, one table per pattern
  Evaluated evaluate(std::span<const double> inputs, std::span<const Table> tables = {});
  /// NaNs of their own kinds. A broken input makes what depends on it broken.
  static double no_value();
  static double broken_value();

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
    enum class Kind : std::uint8_t { constant, input, call, aggregate } kind;
    int index = 0;  ///< input, aggregate: which; call: number of arguments
    double constant = 0;
    Apply* apply = nullptr;
  };
  Expression() = default;
  struct Aggregate;
  double run(std::span<const double> inputs, std::span<const Table> tables, bool mark_broken);

  std::string text_;
  std::vector<std::string> inputs_;
  std::vector<Node> nodes_;  ///< in order of evaluation
  std::vector<double> stack_;
  std::vector<Aggregate> aggregates_;
  std::vector<Pattern> patterns_;
  int nesting_ = 0;
};

/// A value of each thing of a pattern, made one number.
struct Expression::Aggregate {
  using Reduce = double(std::span<double> values, double parameter, bool mark_broken);
  /// Where an input of a part comes from.
  struct Source {
    bool own;  ///< a read of the pattern; else an input of the expression around
    int index;
  };
  struct Part {
    Expression expression;
    std::vector<Source> sources;
    std::vector<double> inputs;
  };
  double over(std::span<const double> around, std::span<const Table> tables, bool mark_broken);
  /// The part's value for one thing; no_value() when it lacks one.
  static double of(Part& part, std::span<const double> thing, std::span<const double> around,
                   std::span<const Table> tables, bool mark_broken);

  Reduce* reduce = nullptr;
  double parameter = 0;
  std::size_t pattern = 0;
  Part value;
  std::vector<Part> where;  ///< one or none
  std::vector<double> values;
};

}  // namespace sandlot
