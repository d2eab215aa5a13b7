#include "sim/watch/expression.h"

#include <muParser.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/math.h"
#include "base/text.h"
#include "base/units.h"

namespace sandlot {
namespace {

constexpr std::size_t longest_text = 2000, most_parts = 400, deepest = 40;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What stands for a number that an operation could not make of finite ones. It is a NaN of its own kind, so that it
/// reaches the result from where it counts, and not from the branch of an if() that is not taken.
constexpr std::uint64_t broken_bits = 0x7ff8'0000'0000'b10c;
constexpr double broken = std::bit_cast<double>(broken_bits);
bool is_broken(double x) {
  return (std::bit_cast<std::uint64_t>(x) & ~(std::uint64_t{1} << 63)) == broken_bits;
}

/// Whether broken numbers are marked. Once they are found the expression is computed again without, so that a log shows
/// the infinity that there is.
thread_local bool judging = false;

template <class... Numbers>
bool any_nan(Numbers... x) {
  return (std::isnan(x) || ...);
}
template <class... Numbers>
double nan_of(Numbers... x) {
  return (is_broken(x) || ...) ? broken : nan;
}
template <class... Numbers>
double checked(double result, Numbers... from) {
  if (judging && !std::isfinite(result) && (std::isfinite(from) && ...)) return broken;
  return std::isnan(result) ? nan : result;
}
/// The function F with the rules of this language: NaN goes through, and a broken result is noticed.
template <auto F>
double one(double x) {
  return any_nan(x) ? nan_of(x) : checked(F(x), x);
}
template <auto F>
double two(double x, double y) {
  return any_nan(x, y) ? nan_of(x, y) : checked(F(x, y), x, y);
}

double rounded(double x) { return std::round(x); }
double floored(double x) { return std::floor(x); }
double ceiled(double x) { return std::ceil(x); }
double root(double x) { return std::sqrt(x); }
double absolute(double x) { return std::abs(x); }
double sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
double degrees(double rad) { return rad * (180 / math::pi); }
double radians(double deg) { return deg * (math::pi / 180); }
/// Beyond what an angle can be told apart, and for infinities, there is no answer.
double wrapped(double rad) { return std::isfinite(rad) ? math::wrap_angle(rad) : nan; }
double negative(double x) { return -x; }
double positive(double x) { return x; }
double opposite(double x) { return x == 0 ? 1 : 0; }

double sum(double a, double b) { return a + b; }
double difference(double a, double b) { return a - b; }
double product(double a, double b) { return a * b; }
double quotient(double a, double b) { return a / b; }
double less(double a, double b) { return a < b; }
double less_equal(double a, double b) { return a <= b; }
double greater(double a, double b) { return a > b; }
double greater_equal(double a, double b) { return a >= b; }
double equal(double a, double b) { return a == b; }
double unequal(double a, double b) { return a != b; }
double both(double a, double b) { return a != 0 && b != 0; }
double either(double a, double b) { return a != 0 || b != 0; }
double smaller(double a, double b) { return b < a ? b : a; }
double larger(double a, double b) { return b > a ? b : a; }
/// The remainder with the sign of b, as people expect of angles and clocks.
double modulo(double a, double b) {
  if (b == 0 || !std::isfinite(a)) return nan;
  if (!std::isfinite(b)) return a;
  const double rest = math::fmod(a, b);
  return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}

template <auto F>
double fold(const double* x, int n) {
  double result = x[0];
  for (int i = 1; i < n; ++i) result = two<F>(result, x[i]);
  return n == 1 && any_nan(x[0]) ? nan_of(x[0]) : result;
}
double clamped(double x, double low, double high) {
  return any_nan(x, low, high) ? nan_of(x, low, high) : smaller(larger(x, low), high);
}
/// Only the branch that is taken counts: if(x == 0, 0, 1 / x) has a value everywhere.
double choice(double condition, double yes, double no) {
  if (any_nan(condition)) return nan_of(condition, yes, no);
  return condition != 0 ? yes : no;
}

constexpr Expression::Function function_list[] = {
    {"abs(x)", "Absolute value."},
    {"sign(x)", "-1, 0 or 1."},
    {"sqrt(x)", "Square root."},
    {"pow(x, y)", "x to the power of y; also x ^ y."},
    {"exp(x)", "e to the power of x."},
    {"log(x)", "Natural logarithm."},
    {"floor(x)", "The whole number below."},
    {"ceil(x)", "The whole number above."},
    {"round(x)", "The nearest whole number; halves away from 0."},
    {"mod(x, y)", "Remainder of x / y with the sign of y."},
    {"min(x, ...)", "The smallest."},
    {"max(x, ...)", "The largest."},
    {"clamp(x, low, high)", "x, at least low and at most high."},
    {"hypot(x, y, ...)", "Square root of the sum of squares."},
    {"sin(x)", "Sine of an angle [rad]."},
    {"cos(x)", "Cosine."},
    {"tan(x)", "Tangent."},
    {"asin(x)", "Arc sine [rad]."},
    {"acos(x)", "Arc cosine [rad]."},
    {"atan(x)", "Arc tangent [rad]."},
    {"atan2(y, x)", "Angle of the vector (x, y) [rad]."},
    {"tanh(x)", "Hyperbolic tangent."},
    {"wrap(x)", "The angle in (-pi, pi] that is x modulo 2 pi."},
    {"degrees(x)", "From rad to degrees."},
    {"radians(x)", "From degrees to rad."},
    {"if(condition, x, y)", "x where the condition holds, else y."},
};

/// muParser with nothing of its own: its functions are those of <cmath>, whose last bits differ between machines.
class Language final : public mu::ParserBase {
 public:
  Language() {
    EnableOptimizer(false);
    EnableBuiltInOprt(false);
    Language::InitCharSets();
    Language::InitFun();
    Language::InitOprt();
  }
  void InitCharSets() override {
    DefineNameChars("0123456789_abcdefghijklmnopqrstuvwxyz");
    DefineOprtChars("+-*/^<>=!&|");
    DefineInfixOprtChars("+-!~");
  }
  void InitConst() override {}
  void InitFun() override {
    DefineFun("abs", one<absolute>);
    DefineFun("sign", one<sign>);
    DefineFun("sqrt", one<root>);
    DefineFun("pow", two<math::pow>);
    DefineFun("exp", one<math::exp>);
    DefineFun("log", one<math::log>);
    DefineFun("floor", one<floored>);
    DefineFun("ceil", one<ceiled>);
    DefineFun("round", one<rounded>);
    DefineFun("mod", two<modulo>);
    DefineFun("min", fold<smaller>);
    DefineFun("max", fold<larger>);
    DefineFun("clamp", clamped);
    DefineFun("hypot", fold<math::hypot>);
    DefineFun("sin", one<math::sin>);
    DefineFun("cos", one<math::cos>);
    DefineFun("tan", one<math::tan>);
    DefineFun("asin", one<math::asin>);
    DefineFun("acos", one<math::acos>);
    DefineFun("atan", one<math::atan>);
    DefineFun("atan2", two<math::atan2>);
    DefineFun("tanh", one<math::tanh>);
    DefineFun("wrap", one<wrapped>);
    DefineFun("degrees", one<degrees>);
    DefineFun("radians", one<radians>);
    DefineFun("if", choice);
  }
  void InitOprt() override {
    // muParser's own numbers have signs bind as tightly as products: -a ^ 2 is -(a ^ 2), -a / b is (-a) / b.
    DefineInfixOprt("-", negative, mu::prINFIX);
    DefineInfixOprt("+", positive, mu::prINFIX);
    DefineInfixOprt("!", one<opposite>, mu::prINFIX);
    DefineInfixOprt("~", one<opposite>, mu::prLAND);  // the word `not`: not a > b is not (a > b)
    DefineOprt("||", two<either>, mu::prLOR, mu::oaLEFT);
    DefineOprt("&&", two<both>, mu::prLAND, mu::oaLEFT);
    DefineOprt("==", two<equal>, mu::prLOGIC, mu::oaLEFT);
    DefineOprt("!=", two<unequal>, mu::prLOGIC, mu::oaLEFT);
    DefineOprt("<", two<less>, mu::prCMP, mu::oaLEFT);
    DefineOprt("<=", two<less_equal>, mu::prCMP, mu::oaLEFT);
    DefineOprt(">", two<greater>, mu::prCMP, mu::oaLEFT);
    DefineOprt(">=", two<greater_equal>, mu::prCMP, mu::oaLEFT);
    DefineOprt("+", two<sum>, mu::prADD_SUB, mu::oaLEFT);
    DefineOprt("-", two<difference>, mu::prADD_SUB, mu::oaLEFT);
    DefineOprt("*", two<product>, mu::prMUL_DIV, mu::oaLEFT);
    DefineOprt("/", two<quotient>, mu::prMUL_DIV, mu::oaLEFT);
    DefineOprt("^", two<math::pow>, mu::prPOW, mu::oaRIGHT);
  }
  void OnDetectVar(mu::string_type*, int&, int&) override {}
};

std::vector<std::string> function_names() {
  std::vector<std::string> names;
  for (const Expression::Function& f : function_list)
    names.emplace_back(f.call, std::string_view(f.call).find('('));
  return names;
}

bool is_function(std::string_view word) {
  static const std::vector<std::string> functions = function_names();
  return std::find(functions.begin(), functions.end(), word) != functions.end();
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)); }

/// What muParser is given instead of what the user wrote: names become v0, v1 ..., numbers c0, c1 ...
struct Translation {
  std::string text;
  std::vector<std::size_t> column;  ///< per character of `text`: where it comes from, from 0
  std::vector<std::string> inputs;
  std::vector<double> constants;
};

class Translator {
 public:
  Translator(std::string_view source, const Names& names) : source_(source), names_(names) {}

  Result<Translation> run() {
    if (source_.size() > longest_text) return at(0, "it is longer than 2000 characters");
    std::size_t depth = 0, parts = 0;
    while (true) {
      while (at_ < source_.size() && std::isspace(static_cast<unsigned char>(source_[at_]))) ++at_;
      if (at_ == source_.size()) break;
      if (++parts > most_parts) return at(at_, "it has more than 400 parts");
      const char c = source_[at_];
      if (c == '(' && ++depth > deepest) return at(at_, "parentheses are more than 40 deep");
      if (c == ')' && depth-- == 0) return at(at_, "this ')' closes nothing");
      if (is_digit(c) || (c == '.' && at_ + 1 < source_.size() && is_digit(source_[at_ + 1])))
        SL_TRY(number());
      else if (is_letter(c)) SL_TRY(word());
      else SL_TRY(sign());
    }
    if (out_.text.empty()) return at(0, "it is empty");
    return std::move(out_);
  }

  Error at(std::size_t column, const std::string& what, const std::string& fix = "") const {
    return {"expression '" + std::string(source_.substr(0, 80)) + (source_.size() > 80 ? "..." : "") +
                "', column " + std::to_string(column + 1) + ": " + what,
            fix};
  }

 private:
  void put(std::string_view text) {
    out_.text += text;
    out_.text += ' ';
    out_.column.resize(out_.text.size(), at_);
  }
  void put_number(double x) {
    put("c" + std::to_string(out_.constants.size()));
    out_.constants.push_back(x);
  }
  std::string_view word_at(std::size_t begin) const {
    std::size_t end = begin;
    while (end < source_.size() && (is_letter(source_[end]) || is_digit(source_[end]))) ++end;
    return source_.substr(begin, end - begin);
  }

  Status number() {
    std::size_t end = at_;
    while (end < source_.size() && (is_digit(source_[end]) || source_[end] == '.')) ++end;
    if (end < source_.size() && (source_[end] == 'e' || source_[end] == 'E')) {
      std::size_t power = end + 1;
      if (power < source_.size() && (source_[power] == '+' || source_[power] == '-')) ++power;
      if (power < source_.size() && is_digit(source_[power])) {
        end = power;
        while (end < source_.size() && is_digit(source_[end])) ++end;
      }
    }
    const std::string_view digits = source_.substr(at_, end - at_);
    double value = 0;
    if (!parse_number(digits, value) || !std::isfinite(value))
      return at(at_, "'" + std::string(digits.substr(0, 40)) + "' is no number");
    std::size_t unit = end;
    while (unit < source_.size() && source_[unit] == ' ') ++unit;
    std::string_view name = word_at(unit);
    if (unit < source_.size() && source_[unit] == '%') name = source_.substr(unit, 1);
    if (!name.empty() && name != "and" && name != "or") {
      bool known = false;
      // The longest spelling first: m/s^2, m/s, m.
      for (const std::string_view more : {"/s^2", "/s", "/h", ""}) {
        const std::string_view spelt = source_.substr(unit, name.size() + more.size());
        if (spelt.substr(name.size()) != more) continue;
        for (const char* const si : {"m", "rad", "s", "kg", "Hz", "m/s", "rad/s", "m/s^2", "rad/s^2", "N",
                                     "Nm", "W", "J", "V", "A", "ohm", "1"}) {
          const auto quantity = parse_quantity(std::string(digits) + " " + std::string(spelt), si);
          if (known || !quantity) continue;
          known = true;
          value = *quantity;
          end = unit + spelt.size();
        }
        if (known) break;
      }
      if (!known)
        return at(unit, "'" + std::string(name.substr(0, 40)) + "' is no unit",
                  "an operator is missing, or a unit such as m, cm, deg, m/s is misspelt");
    }
    put_number(value);
    at_ = end;
    return {};
  }

  Status word() {
    const std::string_view rest = source_.substr(at_);
    const std::string_view plain = word_at(at_);
    const char next = plain.size() < rest.size() ? rest[plain.size()] : ' ';
    std::size_t open = at_ + plain.size();
    while (open < source_.size() && source_[open] == ' ') ++open;
    if (open < source_.size() && source_[open] == '(' && plain != "and" && plain != "or" && plain != "not") {
      if (!is_function(plain))
        return at(at_, "there is no function '" + std::string(plain.substr(0, 40)) + "'",
                  suggestion(plain, function_names()));
      put(plain);
      out_.text.pop_back();  // muParser knows a function by the parenthesis right behind it
      out_.column.pop_back();
      at_ += plain.size();
      return {};
    }
    if (next != '.' && next != '/' && next != '-' && next != '[') {
      if (plain == "and") put("&&");
      else if (plain == "or") put("||");
      else if (plain == "not") put("~");
      else if (plain == "pi") put_number(math::pi);
      else if (plain == "true" || plain == "false") put_number(plain == "true");
      else return name(rest);
      at_ += plain.size();
      return {};
    }
    if (const std::size_t length = names_.match(rest); length == 0 && plain == "pi") {
      put_number(math::pi);  // pi/2
      at_ += plain.size();
      return {};
    }
    return name(rest);
  }

  Status name(std::string_view rest) {
    const std::size_t length = names_.match(rest);
    if (length == 0) {
      std::size_t end = 0;
      while (end < rest.size() && (is_letter(rest[end]) || is_digit(rest[end]) || rest[end] == '.' ||
                                   rest[end] == '/' || rest[end] == '[' || rest[end] == ']'))
        ++end;
      const std::string_view plain = word_at(at_);
      if (plain.size() == end && is_function(plain))
        return at(at_, "'" + std::string(plain) + "' is a function", "its values go in parentheses");
      const Error unknown = names_.unknown(rest.substr(0, std::min<std::size_t>(end, 200)));
      return at(at_, unknown.what, unknown.fix);
    }
    const std::string found(rest.substr(0, length));
    const auto known = std::find(out_.inputs.begin(), out_.inputs.end(), found);
    put("v" + std::to_string(known - out_.inputs.begin()));
    if (known == out_.inputs.end()) out_.inputs.push_back(found);
    at_ += length;
    return {};
  }

  Status sign() {
    const std::string_view pair = source_.substr(at_, 2);
    for (const std::string_view known : {"<=", ">=", "==", "!=", "&&", "||"})
      if (pair == known) {
        put(pair);
        at_ += 2;
        return {};
      }
    const char c = source_[at_];
    if (std::string_view("+-*/^<>!(),").find(c) != std::string_view::npos) {
      put(source_.substr(at_, 1));
      ++at_;
      return {};
    }
    if (c == '=') return at(at_, "'=' is no operator", "to compare write ==");
    if (c == '&' || c == '|') return at(at_, std::string("'") + c + "' is no operator", "write and, or");
    if (c == '%') return at(at_, "'%' is no operator", "write mod(a, b)");
    const bool printable = c > ' ' && c < 127;
    return at(at_, printable ? std::string("'") + c + "' has no meaning here" : "a strange character");
  }

  std::string_view source_;
  const Names& names_;
  std::size_t at_ = 0;
  Translation out_;
};

/// muParser's complaint in our words.
std::string complaint(const mu::ParserError& error) {
  switch (error.GetCode()) {
    case mu::ecUNEXPECTED_OPERATOR: return "an operator where a value belongs";
    case mu::ecUNASSIGNABLE_TOKEN: return "this does not belong here";
    case mu::ecUNEXPECTED_EOF: return "it ends where a value belongs";
    case mu::ecUNEXPECTED_ARG_SEP: return "a ',' that separates no values";
    case mu::ecUNEXPECTED_VAL:
    case mu::ecUNEXPECTED_VAR:
    case mu::ecUNEXPECTED_FUN: return "an operator is missing before this";
    case mu::ecUNEXPECTED_PARENS: return "this parenthesis does not belong here";
    case mu::ecMISSING_PARENS: return "a ')' is missing";
    case mu::ecTOO_MANY_PARAMS: return "too many values for the function";
    case mu::ecTOO_FEW_PARAMS: return "too few values for the function";
    default: return "it cannot be understood";
  }
}

}  // namespace

struct Expression::Compiled {
  Language parser;
  std::vector<double> slots;
};

Expression::Expression(std::string text, std::vector<std::string> inputs, std::unique_ptr<Compiled> compiled)
    : text_(std::move(text)), inputs_(std::move(inputs)), compiled_(std::move(compiled)) {}
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

Result<Expression> Expression::compile(std::string_view text, const Names& names, const Place& place) {
  const auto placed = [&](Error error) {
    error.place = place;
    return error;
  };
  Translator translator(text, names);
  auto translation = translator.run();
  if (!translation) return placed(std::move(translation.error()));
  auto compiled = std::make_unique<Compiled>();
  compiled->slots.assign(translation->inputs.size(), nan);
  try {
    for (std::size_t i = 0; i < translation->inputs.size(); ++i)
      compiled->parser.DefineVar("v" + std::to_string(i), &compiled->slots[i]);
    for (std::size_t i = 0; i < translation->constants.size(); ++i)
      compiled->parser.DefineConst("c" + std::to_string(i), translation->constants[i]);
    compiled->parser.SetExpr(translation->text);
    // With every input NaN, whatever depends on one is NaN: what breaks now is made of constants alone.
    judging = true;
    const double judged = compiled->parser.Eval();
    judging = false;
    if (is_broken(judged))
      return placed(translator.at(0, "a part of it that is all constants is no finite number",
                                  "is it a division by 0?"));
    if (compiled->parser.GetNumResults() != 1)
      return placed(translator.at(0, "it holds several expressions", "keep one of them"));
  } catch (const mu::ParserError& error) {
    judging = false;
    const std::size_t position = static_cast<std::size_t>(std::max(error.GetPos(), 0));
    const std::size_t column = position < translation->column.size() ? translation->column[position]
                                                                     : text.size();
    return placed(translator.at(column, complaint(error)));
  }
  return Expression(std::string(text), std::move(translation->inputs), std::move(compiled));
}

Expression::Evaluated Expression::evaluate(std::span<const double> inputs) {
  SL_CHECK(inputs.size() == compiled_->slots.size());
  std::copy(inputs.begin(), inputs.end(), compiled_->slots.begin());
  judging = true;
  const double value = compiled_->parser.Eval();
  judging = false;
  if (std::isfinite(value)) return {value, true};
  return {compiled_->parser.Eval(), false};
}

std::span<const Expression::Function> Expression::functions() { return function_list; }

bool Expression::is_reserved(std::string_view word) {
  if (is_function(word)) return true;
  for (const std::string_view other : {"and", "or", "not", "pi", "true", "false", "sim", "values"})
    if (word == other) return true;
  return false;
}

}  // namespace sandlot
