#include "sim/watch/expression.h"

#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "base/math.h"

namespace sandlot {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Names with every sign that could be an operator too.
struct Few final : Names {
  std::map<std::string, double> values{{"a.x", 3},  {"b.x", 4},   {"gap", 2},      {"r/laser.ranges[3]", 10},
                                       {"r.x", 12}, {"far", inf}, {"my-bot.x", 5}, {"none", std::nan("")}};
  std::size_t match(std::string_view text) const override {
    std::size_t best = 0;
    for (const auto& [name, value] : values)
      if (text.substr(0, name.size()) == name) best = std::max(best, name.size());
    return best;
  }
  /// Rows of x, y and a range that only some have.
  static constexpr double gone = -99;
  std::map<std::string, std::vector<std::vector<double>>> things{
      {"t*", {{1, 2, gone}, {2, 0, 5}, {3, 4, 7}, {6, 1, gone}}},
      {"u*", {{2.5, 0, 1}, {5, 0, 1}}},
      {"zero*", {}}};
  static int column(std::string_view read) {
    return read == ".x" ? 0 : read == ".y" ? 1 : read == "/laser.d" ? 2 : -1;
  }
  std::size_t match_pattern(std::string_view text) const override {
    for (const auto& [name, rows] : things)
      for (const std::string_view read : {".x", ".y", "/laser.d"})
        if (text.substr(0, name.size()) == name && text.substr(name.size(), read.size()) == read)
          return name.size() + read.size();
    return 0;
  }
  Error unknown(std::string_view word) const override { return {"there is no '" + std::string(word) + "'"}; }
};

Expression::Evaluated result(const std::string& text) {
  const Few names;
  auto expression = Expression::compile(text, names);
  EXPECT_TRUE(expression) << (expression ? "" : expression.error().text());
  if (!expression) return {std::nan(""), false};
  std::vector<double> inputs;
  for (const std::string& input : expression->inputs()) inputs.push_back(names.values.at(input));
  std::vector<std::vector<double>> numbers;
  std::vector<Expression::Table> tables;
  for (const Expression::Pattern& pattern : expression->patterns()) {
    numbers.emplace_back();
    for (const auto& row : names.things.at(pattern.things))
      for (const std::string& read : pattern.reads) {
        const double x = row[static_cast<std::size_t>(Few::column(read))];
        numbers.back().push_back(x == Few::gone ? Expression::no_value() : x);
      }
  }
  for (std::size_t i = 0; i < numbers.size(); ++i)
    tables.push_back({names.things.at(expression->patterns()[i].things).size(), numbers[i]});
  return expression->evaluate(inputs, tables);
}
double value(const std::string& text) { return result(text).value; }
std::string complaint(const std::string& text) {
  auto expression = Expression::compile(text, Few());
  return expression ? "" : expression.error().what + "; " + expression.error().fix;
}

TEST(Expression, PrecedenceIsThatOfMathematics) {
  const std::map<std::string, double> expected{{"1 + 2 * 3", 7},
                                               {"(1 + 2) * 3", 9},
                                               {"8 / 4 / 2", 1},
                                               {"1 - 2 - 3", -4},
                                               {"2 ^ 3 ^ 2", 512},
                                               {"-2 ^ 2", -4},
                                               {"2 ^ -1", 0.5},
                                               {"-a.x / b.x", -0.75},
                                               {"1 - -1", 2},
                                               {"2 * -3", -6},
                                               {"1 < 2 == 3 > 2", 1},
                                               {"1 or 0 and 0", 1},
                                               {"not 1 > 2", 1},
                                               {"!1 > 2", 0},
                                               {"not 0 and 0", 0},
                                               {"1 + 1 == 2", 1},
                                               {"a.x<-3", 0},
                                               {"3 != 3", 0},
                                               {"3 >= 3 && 3 <= 3", 1},
                                               {"0 || 0", 0},
                                               {"true + false", 1},
                                               {"(a.x > 2) * 5", 5},
                                               {"if(a.x > 5, 10, 20)", 20}};
  for (const auto& [text, number] : expected) EXPECT_EQ(value(text), number) << text;
}

TEST(Expression, FunctionsAreOurs) {
  const std::map<std::string, double> expected{{"sin(0.3)", math::sin(0.3)},
                                               {"cos(0.3)", math::cos(0.3)},
                                               {"tan(0.3)", math::tan(0.3)},
                                               {"asin(0.3)", math::asin(0.3)},
                                               {"acos(0.3)", math::acos(0.3)},
                                               {"atan(0.3)", math::atan(0.3)},
                                               {"atan2(1, 2)", math::atan2(1, 2)},
                                               {"exp(0.3)", math::exp(0.3)},
                                               {"log(0.3)", math::log(0.3)},
                                               {"tanh(0.3)", math::tanh(0.3)},
                                               {"2.5 ^ 1.5", math::pow(2.5, 1.5)},
                                               {"pow(2.5, 1.5)", math::pow(2.5, 1.5)},
                                               {"hypot(a.x, b.x)", 5},
                                               {"hypot(2, 3, 6)", 7},
                                               {"sqrt(16)", 4},
                                               {"abs(-2)", 2},
                                               {"sign(-2)", -1},
                                               {"sign(0)", 0},
                                               {"floor(-1.5)", -2},
                                               {"ceil(-1.5)", -1},
                                               {"round(2.5)", 3},
                                               {"mod(-1, 3)", 2},
                                               {"mod(7, -3)", -2},
                                               {"mod(6, 3)", 0},
                                               {"min(4, a.x, 7)", 3},
                                               {"max(4, a.x, 7)", 7},
                                               {"min(5)", 5},
                                               {"clamp(9, 0, 5)", 5},
                                               {"clamp(-9, 0, 5)", 0},
                                               {"wrap(3 * pi)", math::wrap_angle(3 * math::pi)},
                                               {"degrees(pi)", 180},
                                               {"radians(180)", math::pi}};
  for (const auto& [text, number] : expected) EXPECT_EQ(value(text), number) << text;
  // None is left untested.
  for (const Expression::Function& f : Expression::functions()) {
    const std::string name(f.call, std::string_view(f.call).find('(') + 1);
    // Those of things have a test of their own, as does if().
    bool tested = name == "if(" || std::string_view(f.call).find("where") != std::string_view::npos;
    for (const auto& [text, number] : expected) tested = tested || text.substr(0, name.size()) == name;
    EXPECT_TRUE(tested) << name;
  }
}

TEST(Expression, NumbersCarryUnits) {
  EXPECT_EQ(value("90 deg"), math::pi / 2);
  EXPECT_EQ(value("5cm + 2 m"), 2.05);
  EXPECT_EQ(value("36 km/h"), 36 * (1 / 3.6));
  EXPECT_EQ(value("2 m/s^2 * 3"), 6);
  EXPECT_EQ(value("50 % * 2"), 1);
  EXPECT_EQ(value("1e3 - .5"), 999.5);
  EXPECT_EQ(value("3 and 1"), 1);
}

TEST(Expression, ASlashBelongsToTheLongestName) {
  EXPECT_EQ(value("r/laser.ranges[3]"), 10);
  EXPECT_EQ(value("r/laser.ranges[3]/2"), 5);
  EXPECT_EQ(value("gap/r.x"), 2.0 / 12);
  EXPECT_EQ(value("r.x/gap"), 6);
  EXPECT_EQ(value("pi/2"), math::pi / 2);
  EXPECT_EQ(value("my-bot.x-1"), 4);
  EXPECT_EQ(value("gap-gap"), 0);
}

TEST(Expression, InputsAreListedOnce) {
  const auto expression = Expression::compile("b.x + a.x * b.x", Few());
  ASSERT_TRUE(expression);
  EXPECT_EQ(std::vector<std::string>(expression->inputs().begin(), expression->inputs().end()),
            (std::vector<std::string>{"b.x", "a.x"}));
}

TEST(Expression, AggregatesGoOverThings) {
  const std::map<std::string, double> expected{
      {"count(t*.x > 1.5)", 3},
      {"count(t*.x > 1.5 where t*.y > 0.5)", 2},
      {"sum(t*.x)", 12},
      {"mean(t*.x)", 3},
      {"2*mean(t*.x)*2", 12},
      {"deviation(t*.x)", std::sqrt((4.0 + 1 + 0 + 9) / 3)},
      {"min(t*.x)", 1},
      {"max(t*.x where t*.y != 1)", 3},
      {"max(-t*.x)", -1},
      {"median(t*.x)", 2.5},
      {"quantile(t*.x, 0)", 1},
      {"quantile(t*.x, 1)", 6},
      {"quantile(t*.x, 0.9)", 3 + 0.7 * 3},
      {"quantile(t*.x where t*.x < 5, 0.5)", 2},
      {"any(t*.x > 5)", 1},
      {"any(t*.x > 7)", 0},
      {"all(t*.x > 0)", 1},
      {"all(t*.x > 1)", 0},
      {"sum(t*/laser.d)", 12},  // of those that have one
      {"count(t*/laser.d > 0)", 2},
      {"all(t*/laser.d > 1)", 1},
      {"mean(t*.x where t*/laser.d > 5)", 3},
      {"sum(hypot(t*.x - a.x, t*.y))", std::sqrt(8.0) + 1 + 4 + std::sqrt(10.0)},
      {"sum(t*.x * gap) + b.x", 28},
      {"sum(max(t*.x, a.x))", 3 + 3 + 3 + 6},
      {"max(mean(t*.x), mean(u*.x))", 3.75},
      {"count(zero*.x > 0) + sum(zero*.x) + any(zero*.x)", 0},
      {"all(zero*.x)", 1},
      {"a.x*count(t*.x > 2)", 6},
      {"sum(min(abs(t*.x - u*.x)))", 1.5 + 0.5 + 0.5 + 1},  // how far each t is from the nearest u
      {"max(min(abs(t*.x - u*.x)) where t*.y > 0)", 1.5},
      {"mean(count(t*.x > u*.x where t*.y < 3))", (0.0 + 0 + 0 + 2) / 4},  // over t, which comes first
      {"mean(count(u*.x < t*.x where t*.y < 3))", (1.0 + 1) / 2},          // over u
      {"count(min(abs(t*.x - u*.x + gap - gap) where u*.x > a.x) < 2.5)", 2},
  };
  for (const auto& [text, number] : expected) EXPECT_DOUBLE_EQ(value(text), number) << text;
  for (const char* const text : {"mean(zero*.x)", "min(zero*.x)", "deviation(t*.x where t*.x > 5)",
                                 "1 + max(zero*.x)", "mean(zero*.x) > 3", "if(mean(zero*.x) > 3, 1, 2)"})
    EXPECT_TRUE(result(text).absent) << text;
  EXPECT_EQ(result("if(count(zero*.x) == 0, 7, mean(zero*.x))").value, 7);
  EXPECT_FALSE(result("1 / count(zero*.x) > 3").finite);
  EXPECT_FALSE(result("sum(1 / (t*.x - 1))").finite);
  EXPECT_FALSE(result("count(1 / (t*.x - 1) > 0)").finite);
  EXPECT_EQ(value("count(1 / (t*.x - 1) > 0 where t*.x != 1)"), 3);
  EXPECT_FALSE(result("count(none > t*.x)").finite);
}

TEST(Expression, AggregatesListWhatTheyReadOnce) {
  const auto expression = Expression::compile(
      "mean(min(t*.x - u*.x + b.x) where t*.y > a.x) + sum(t*.x) + b.x", Few());
  ASSERT_TRUE(expression);
  EXPECT_EQ(std::vector<std::string>(expression->inputs().begin(), expression->inputs().end()),
            (std::vector<std::string>{"b.x", "a.x"}));
  ASSERT_EQ(expression->patterns().size(), 3u);
  EXPECT_EQ(expression->patterns()[0].things, "t*");
  EXPECT_EQ(expression->patterns()[0].reads, (std::vector<std::string>{".x", ".y"}));
  EXPECT_EQ(expression->patterns()[1].things, "u*");
  EXPECT_EQ(expression->patterns()[2].things, "t*");
}

TEST(Expression, AggregatesSayWhatIsWrongWithThem) {
  const std::vector<std::pair<const char*, const char*>> expected{
      {"t*.x > 1", "column 1: 't*.x' is a value of several things"},
      {"max(t*.x, 1)", "column 5: 't*.x' is a value of several things"},
      {"count(a.x > 1)", "column 1: 'count' goes over no things of its own"},
      {"mean(t*.x - mean(t*.x))",
       "the first pattern belongs to the aggregate around it; give what is in here a name"},
      {"mean(t*.x - u*.x)", "'u*.x' is of other things than t*"},
      {"mean(t*.x, 1)", "'mean' of things takes one value"},
      {"quantile(t*.x)", "a number from 0 to 1 is missing"},
      {"quantile(t*.x, 2)", "here belongs a number from 0 to 1"},
      {"quantile(t*.x, a.x)", "here belongs a number from 0 to 1"},
      {"min(a.x where b.x)", "'where' belongs into an aggregate"},
      {"a.x where b.x", "'where' belongs into an aggregate"},
      {"mean(where t*.x)", "there is no 'where'"},
      {"mean()", "this parenthesis"},
      {"mean(t*.x", "a ')' is missing"},
      {"mean(z*.x)", "there is no 'z*.x'"},
      {"mean", "'mean' is a function"},
      {"sum(t*.x * (1/0))", "not a finite number"},
      {"count(t*.x where 1/0)", "not a finite number"},
      {"sum(sum(sum(sum(t*.x - u*.x))))", "aggregates are more than 3 deep"},
      {"t*", "column 1: there is no 't'"}};
  for (const auto& [text, words] : expected)
    EXPECT_NE(complaint(text).find(words), std::string::npos) << text << " -> " << complaint(text);
}

TEST(Expression, NothingUndefinedPassesForAnAnswer) {
  EXPECT_FALSE(result("1 / (a.x - 3) > 5").finite);  // inf > 5 would be a yes
  EXPECT_FALSE(result("none < 1").finite);
  EXPECT_FALSE(result("none == none or 1").finite);
  EXPECT_FALSE(result("min(none, 1)").finite);
  EXPECT_FALSE(result("min(none)").finite);
  EXPECT_FALSE(result("if(none, 1, 2)").finite);
  EXPECT_FALSE(result("none ^ 0").finite);
  EXPECT_FALSE(result("mod(a.x, gap - 2)").finite);
  EXPECT_FALSE(result("log(a.x - 3) < 0").finite);
  // The branch that is not taken does not count: this is how to guard a division.
  EXPECT_TRUE(result("if(a.x == 3, 0, 1 / (a.x - 3)) < 1").finite);
  EXPECT_EQ(result("if(a.x == 3, 7, 1 / (a.x - 3))").value, 7);
  EXPECT_EQ(result("if(a.x == 3, 7, none)").value, 7);
  EXPECT_FALSE(result("if(a.x == 3, 1 / (a.x - 3), 0) > 1").finite);
  EXPECT_FALSE(result("max(1, -(1 / (a.x - 3)))").finite);
  // A measured infinity (nothing in range) is a number to compare with.
  EXPECT_TRUE(result("far > 5").finite);
  EXPECT_EQ(value("min(far, 5)"), 5);
  EXPECT_FALSE(result("far").finite);
}

TEST(Expression, ErrorsNameTheColumn) {
  const std::vector<std::pair<const char*, const char*>> expected{
      {"a.x + ", "column 7: it ends where a value belongs"},
      {"((1)", "column 5: a ')' is missing"},
      {"1)", "column 2: this ')' closes nothing"},
      {"a.x b.x", "column 5: an operator is missing"},
      {"a.x = 3", "column 5: '=' is not an operator; to compare write =="},
      {"1 + foo(2)", "column 5: there is no function 'foo'"},
      {"1 + squrt(2)", "did you mean 'sqrt'?"},
      {"zap.x", "column 1: there is no 'zap.x'"},
      {"1 + zap/zip.x * 2", "column 5: there is no 'zap/zip.x'"},
      {"1 + sin", "column 5: 'sin' is a function"},
      {"sin(1, 2)", "too many values"},
      {"atan2(1)", "too few values"},
      {"max(1,,2)", "column 7: a ','"},
      {"1, 2", "several expressions"},
      {"3 fortnights", "column 3: 'fortnights' is not a unit"},
      {"1e999", "is not a number"},
      {"1.2.3", "is not a number"},
      {"a.x ? 1 : 2", "column 5: '?' has no meaning"},
      {"a.x & 1", "write and, or"},
      {"", "it is empty"},
      {"   ", "it is empty"},
      {"()", "parenthesis"},
      {"1/0", "not a finite number"},
      {"a.x + 0 * (1/0)", "not a finite number"},
      {"sqrt(0 - 1) > a.x", "not a finite number"},
      {"\x01", "a strange character"}};
  for (const auto& [text, words] : expected)
    EXPECT_NE(complaint(text).find(words), std::string::npos) << text << " -> " << complaint(text);
}

TEST(Expression, DepthAndLengthAreLimited) {
  EXPECT_EQ(value(std::string(40, '(') + "1" + std::string(40, ')')), 1);
  EXPECT_NE(complaint(std::string(41, '(') + "1" + std::string(41, ')')).find("deep"), std::string::npos);
  std::string sum = "1";
  for (int i = 0; i < 199; ++i) sum += "+1";
  EXPECT_EQ(value(sum), 200);
  EXPECT_NE(complaint(sum + "+1+1").find("parts"), std::string::npos);
  EXPECT_NE(complaint(std::string(3000, ' ') + "1").find("2000"), std::string::npos);
  EXPECT_FALSE(complaint(std::string(390, '-') + "1").empty());
}

TEST(Expression, ErrorsCarryThePlace) {
  Place place;
  place.file = std::make_shared<const std::string>("run.yaml");
  place.line = 7;
  place.column = 9;
  const auto expression = Expression::compile("1 +", Few(), place);
  ASSERT_FALSE(expression);
  EXPECT_EQ(expression.error().text().substr(0, 13), "run.yaml:7:9:");
}

}  // namespace
}  // namespace sandlot
