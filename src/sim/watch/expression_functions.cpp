#include "sim/watch/expression_functions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/math.h"

namespace sandlot {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t broken_bits = 0x7ff8'0000'0000'b10c;
constexpr double broken = std::bit_cast<double>(broken_bits);
constexpr std::uint64_t absent_bits = 0x7ff8'0000'0000'ab5e;
constexpr double absent = std::bit_cast<double>(absent_bits);

bool has_bits(double x, std::uint64_t bits) {
  return (std::bit_cast<std::uint64_t>(x) & ~(std::uint64_t{1} << 63)) == bits;
}

/// The NaN that results from arguments of which one is NaN.
double nan_of(const double* x, int n) {
  for (int i = 0; i < n; ++i)
    if (is_broken(x[i])) return broken;
  for (int i = 0; i < n; ++i)
    if (is_absent(x[i])) return absent;
  return nan;
}
bool any_nan(const double* x, int n) {
  for (int i = 0; i < n; ++i)
    if (std::isnan(x[i])) return true;
  return false;
}
double checked(double result, const double* x, int n, bool mark_broken) {
  if (std::isfinite(result)) return result;
  bool finite = true;
  for (int i = 0; i < n; ++i) finite = finite && std::isfinite(x[i]);
  if (mark_broken && finite) return broken;
  return std::isnan(result) ? nan : result;
}

/// The plain function F with the rules for NaN and broken numbers.
template <auto F>
double one(const double* x, int n, bool mark_broken) {
  return any_nan(x, n) ? nan_of(x, n) : checked(F(x[0]), x, n, mark_broken);
}
template <auto F>
double two(const double* x, int n, bool mark_broken) {
  return any_nan(x, n) ? nan_of(x, n) : checked(F(x[0], x[1]), x, n, mark_broken);
}
/// F between the first two arguments, then between the result and the third, and so on.
template <auto F>
double fold(const double* x, int n, bool mark_broken) {
  if (n == 1) return any_nan(x, n) ? nan_of(x, n) : x[0];
  double result = x[0];
  for (int i = 1; i < n; ++i) {
    const double pair[] = {result, x[i]};
    result = two<F>(pair, 2, mark_broken);
  }
  return result;
}

double rounded(double x) { return std::round(x); }
double floored(double x) { return std::floor(x); }
double ceiled(double x) { return std::ceil(x); }
double root(double x) { return std::sqrt(x); }
double absolute(double x) { return std::abs(x); }
double sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
double degrees(double rad) { return rad * (180 / math::pi); }
double radians(double deg) { return deg * (math::pi / 180); }
/// An infinite angle has no direction.
double wrapped(double rad) { return std::isfinite(rad) ? math::wrap_angle(rad) : nan; }
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
/// Remainder with the sign of b, as is usual for angles and clocks.
double modulo(double a, double b) {
  if (b == 0 || !std::isfinite(a)) return nan;
  if (!std::isfinite(b)) return a;
  const double rest = math::fmod(a, b);
  return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}

double clamped(const double* x, int n, bool) {
  return any_nan(x, n) ? nan_of(x, n) : smaller(larger(x[0], x[1]), x[2]);
}
/// Only the branch that is taken counts: if(x == 0, 0, 1 / x) has a value everywhere.
double choice(const double* x, int n, bool) {
  if (std::isnan(x[0])) return nan_of(x, n);
  return x[0] != 0 ? x[1] : x[2];
}
// Signs change no number into another kind, so they skip the checks.
double minus(const double* x, int, bool) { return -x[0]; }
double plus(const double* x, int, bool) { return x[0]; }

// Aggregates. In the order of the things, so that rounding is always the same.

using Values = std::span<double>;

double total(Values x) {
  double sum = 0;
  for (const double each : x) sum += each;
  return sum;
}
double count_of(Values x, double) {
  return static_cast<double>(std::count_if(x.begin(), x.end(), [](double each) { return each != 0; }));
}
double any_of(Values x, double) { return count_of(x, 0) > 0; }
double all_of(Values x, double) { return count_of(x, 0) == static_cast<double>(x.size()); }
double sum_of(Values x, double) { return total(x); }
double mean_of(Values x, double) { return x.empty() ? absent : total(x) / static_cast<double>(x.size()); }
double least_of(Values x, double) { return x.empty() ? absent : *std::min_element(x.begin(), x.end()); }
double most_of(Values x, double) { return x.empty() ? absent : *std::max_element(x.begin(), x.end()); }
/// Of the sample: divided by n - 1.
double deviation_of(Values x, double) {
  if (x.size() < 2) return absent;
  const double mean = mean_of(x, 0);
  double squares = 0;
  for (const double each : x) squares += (each - mean) * (each - mean);
  return std::sqrt(squares / static_cast<double>(x.size() - 1));
}
/// Linear between the neighbours in order: type 7 of R. J. Hyndman, Y. Fan, Sample quantiles in statistical packages (1996).
double quantile_of(Values x, double p) {
  if (x.empty()) return absent;
  std::sort(x.begin(), x.end());
  const double place = p * static_cast<double>(x.size() - 1), below = std::floor(place);
  const auto i = static_cast<std::size_t>(below);
  return i + 1 < x.size() ? x[i] + (place - below) * (x[i + 1] - x[i]) : x[i];
}
double median_of(Values x, double) { return quantile_of(x, 0.5); }

/// F with the rules for NaN and broken numbers.
template <auto F>
double aggregate(Values x, double parameter, bool mark_broken) {
  const int n = static_cast<int>(x.size());
  if (any_nan(x.data(), n)) return nan_of(x.data(), n);
  const double result = F(x, parameter);
  return is_absent(result) ? result : checked(result, x.data(), n, mark_broken);
}

constexpr AggregateRule aggregates[] = {
    {"count", false, aggregate<count_of>},   {"sum", false, aggregate<sum_of>},
    {"mean", false, aggregate<mean_of>},     {"deviation", false, aggregate<deviation_of>},
    {"min", false, aggregate<least_of>},     {"max", false, aggregate<most_of>},
    {"median", false, aggregate<median_of>}, {"quantile", true, aggregate<quantile_of>},
    {"any", false, aggregate<any_of>},       {"all", false, aggregate<all_of>},
};

constexpr int any_number = 400;

constexpr FunctionRule functions[] = {
    {"abs", 1, 1, one<absolute>},
    {"sign", 1, 1, one<sign>},
    {"sqrt", 1, 1, one<root>},
    {"pow", 2, 2, two<math::pow>},
    {"exp", 1, 1, one<math::exp>},
    {"log", 1, 1, one<math::log>},
    {"floor", 1, 1, one<floored>},
    {"ceil", 1, 1, one<ceiled>},
    {"round", 1, 1, one<rounded>},
    {"mod", 2, 2, two<modulo>},
    {"min", 1, any_number, fold<smaller>},
    {"max", 1, any_number, fold<larger>},
    {"clamp", 3, 3, clamped},
    {"hypot", 1, any_number, fold<math::hypot>},
    {"sin", 1, 1, one<math::sin>},
    {"cos", 1, 1, one<math::cos>},
    {"tan", 1, 1, one<math::tan>},
    {"asin", 1, 1, one<math::asin>},
    {"acos", 1, 1, one<math::acos>},
    {"atan", 1, 1, one<math::atan>},
    {"atan2", 2, 2, two<math::atan2>},
    {"tanh", 1, 1, one<math::tanh>},
    {"wrap", 1, 1, one<wrapped>},
    {"degrees", 1, 1, one<degrees>},
    {"radians", 1, 1, one<radians>},
    {"if", 3, 3, choice},
};

// The words `or`, `and`, `not` are read as ||, && and "not".
constexpr OperatorRule binary[] = {
    {"||", lowest_precedence, false, two<either>},
    {"&&", 2, false, two<both>},
    {"==", 3, false, two<equal>},
    {"!=", 3, false, two<unequal>},
    {"<", 4, false, two<less>},
    {"<=", 4, false, two<less_equal>},
    {">", 4, false, two<greater>},
    {">=", 4, false, two<greater_equal>},
    {"+", 5, false, two<sum>},
    {"-", 5, false, two<difference>},
    {"*", 6, false, two<product>},
    {"/", 6, false, two<quotient>},
    {"^", 7, true, two<math::pow>},
};

// A sign binds as tightly as a product: -a ^ 2 is -(a ^ 2), -a / b is (-a) / b. `not a > b` is not (a > b).
constexpr OperatorRule prefix[] = {
    {"-", 6, true, minus},
    {"+", 6, true, plus},
    {"!", 6, true, one<opposite>},
    {"not", 2, true, one<opposite>},
};

template <class Rule>
const Rule* find(std::span<const Rule> rules, std::string_view Rule::*name, std::string_view wanted) {
  for (const Rule& rule : rules)
    if (rule.*name == wanted) return &rule;
  return nullptr;
}

}  // namespace

bool is_broken(double x) { return has_bits(x, broken_bits); }
bool is_absent(double x) { return has_bits(x, absent_bits); }
double Expression::no_value() { return absent; }
double Expression::broken_value() { return broken; }

const FunctionRule* find_function(std::string_view name) {
  return find<FunctionRule>(functions, &FunctionRule::name, name);
}
const AggregateRule* find_aggregate(std::string_view name) {
  return find<AggregateRule>(aggregates, &AggregateRule::name, name);
}
const OperatorRule* find_binary(std::string_view sign) {
  return find<OperatorRule>(binary, &OperatorRule::sign, sign);
}
const OperatorRule* find_prefix(std::string_view sign) {
  return find<OperatorRule>(prefix, &OperatorRule::sign, sign);
}

}  // namespace sandlot
