#include "sim/watch/expression.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "base/math.h"
#include "base/text.h"
#include "base/units.h"
#include "sim/watch/expression_functions.h"

namespace sandlot {
namespace {

constexpr std::size_t longest_text = 2000, most_tokens = 400, deepest = 40;

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
    {"cos(x)", "Cosine of an angle [rad]."},
    {"tan(x)", "Tangent of an angle [rad]."},
    {"asin(x)", "Arc sine [rad]."},
    {"acos(x)", "Arc cosine [rad]."},
    {"atan(x)", "Arc tangent [rad]."},
    {"atan2(y, x)", "Angle of the vector (x, y) [rad]."},
    {"tanh(x)", "Hyperbolic tangent."},
    {"wrap(x)", "The angle in (-pi, pi] that is x modulo 2 pi."},
    {"degrees(x)", "From rad to degrees."},
    {"radians(x)", "From degrees to rad."},
    {"if(condition, x, y)", "x where the condition holds, else y."},
    {"count(x where c)",
     "Number of things, such as robot*, for which x holds; `where c` takes some of them only."},
    {"sum(x where c)", "Sum over things: sum(box*.pose.x)."},
    {"mean(x where c)", "Mean over things."},
    {"deviation(x where c)", "Standard deviation over things, by n - 1."},
    {"min(x where c)", "The smallest of a value of things."},
    {"max(x where c)", "The largest of a value of things."},
    {"median(x where c)", "The value that half of the things are below."},
    {"quantile(x where c, p)", "The value that the part p of the things is below, p from 0 to 1."},
    {"any(x where c)", "1 where x holds of one of the things."},
    {"all(x where c)", "1 where x holds of every one of the things."},
};

std::vector<std::string> function_names() {
  std::vector<std::string> names;
  for (const Expression::Function& f : function_list)
    names.emplace_back(f.call, std::string_view(f.call).find('('));
  return names;
}

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)); }
bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)); }

struct Token {
  enum class Kind { end, number, name, pattern, function, where, sign, open, close, comma } kind = Kind::end;
  std::size_t at = 0;  ///< column in the text, from 0
  double number = 0;
  std::string_view text;  ///< name, pattern, function, sign: || for `or`, && for `and`
};

/// Splits the text into tokens. Needs the names, because an address may contain / - and [.
class Lexer {
 public:
  Lexer(std::string_view source, const Names& names) : source_(source), names_(names) {}

  const Token& token() const { return token_; }

  /// Reads the next token.
  Status advance() {
    while (at_ < source_.size() && is_space(source_[at_])) ++at_;
    after_value_ = token_.kind == Token::Kind::number || token_.kind == Token::Kind::name ||
                   token_.kind == Token::Kind::pattern || token_.kind == Token::Kind::close;
    token_ = {Token::Kind::end, at_, 0, {}};
    if (at_ == source_.size()) return {};
    if (++tokens_ > most_tokens) return error(at_, "it has more than 400 parts");
    const char c = source_[at_];
    if (c == '(' && ++depth_ > deepest) return error(at_, "parentheses are more than 40 deep");
    if (c == ')' && depth_-- == 0) return error(at_, "this ')' closes nothing");
    if (is_digit(c) || (c == '.' && at_ + 1 < source_.size() && is_digit(source_[at_ + 1]))) return number();
    if (c == '*' && !after_value_) {
      if (const std::size_t length = pattern(source_.substr(at_))) return take(Token::Kind::pattern, length);
    }
    return is_letter(c) ? word() : sign();
  }

  Error error(std::size_t column, const std::string& what, const std::string& fix = "") const {
    return {"expression '" + std::string(source_.substr(0, 80)) + (source_.size() > 80 ? "..." : "") +
                "', column " + std::to_string(column + 1) + ": " + what,
            fix};
  }

 private:
  Status take(Token::Kind kind, std::size_t length) {
    token_.kind = kind;
    token_.text = source_.substr(at_, length);
    at_ += length;
    return {};
  }
  Status take_number(double number, std::size_t length) {
    token_.number = number;
    return take(Token::Kind::number, length);
  }
  /// Letters and digits from `begin` on.
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
      return error(at_, "'" + std::string(digits.substr(0, 40)) + "' is not a number");
    std::size_t unit = end;
    while (unit < source_.size() && source_[unit] == ' ') ++unit;
    std::string_view name = word_at(unit);
    if (unit < source_.size() && source_[unit] == '%') name = source_.substr(unit, 1);
    if (!name.empty() && name != "and" && name != "or" && name != "where") {
      bool known = false;
      // The longest spelling wins: m/s^2, m/s, m.
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
        return error(unit, "'" + std::string(name.substr(0, 40)) + "' is not a unit",
                     "an operator is missing, or a unit such as m, cm, deg, m/s is misspelt");
    }
    return take_number(value, end - at_);
  }

  Status word() {
    const std::string_view rest = source_.substr(at_);
    const std::string_view plain = word_at(at_);
    const bool is_operator = plain == "and" || plain == "or" || plain == "not";
    std::size_t open = at_ + plain.size();
    while (open < source_.size() && source_[open] == ' ') ++open;
    if (open < source_.size() && source_[open] == '(' && !is_operator) {
      if (find_function(plain) || find_aggregate(plain)) return take(Token::Kind::function, plain.size());
      return error(at_, "there is no function '" + std::string(plain.substr(0, 40)) + "'",
                   suggestion(plain, function_names()));
    }
    // Before one of these a reserved word may be the beginning of an address.
    const char next = plain.size() < rest.size() ? rest[plain.size()] : ' ';
    if (next != '.' && next != '/' && next != '-' && next != '[') {
      if (is_operator) {
        SL_TRY(take(Token::Kind::sign, plain.size()));
        if (plain != "not") token_.text = plain == "and" ? "&&" : "||";
        return {};
      }
      if (plain == "true" || plain == "false") return take_number(plain == "true", plain.size());
      if (plain == "pi") return take_number(math::pi, plain.size());
      if (plain == "where" && after_value_) return take(Token::Kind::where, plain.size());
      return name(rest);
    }
    if (plain == "pi" && names_.match(rest) == 0) return take_number(math::pi, plain.size());  // pi/2
    return name(rest);
  }

  /// The length of a value of several things at the beginning of `rest`; 0: a `*` in it multiplies.
  std::size_t pattern(std::string_view rest) const {
    const std::size_t star = rest.find_first_of("*./ ");
    if (star == std::string_view::npos || rest[star] != '*') return 0;
    if (star > 0 && names_.match(rest.substr(0, star)) == star) return 0;
    return names_.match_pattern(rest);
  }

  Status name(std::string_view rest) {
    if (const std::size_t length = pattern(rest)) return take(Token::Kind::pattern, length);
    const std::size_t length = names_.match(rest);
    if (length == 0) {
      std::size_t end = 0;
      while (end < rest.size() &&
             (is_letter(rest[end]) || is_digit(rest[end]) || rest[end] == '.' || rest[end] == '/' ||
              rest[end] == '[' || rest[end] == ']' ||
              (rest[end] == '*' && rest.find('.') != std::string_view::npos && rest.find('.') > end)))
        ++end;
      const std::string_view plain = word_at(at_);
      if (plain.size() == end && (find_function(plain) || find_aggregate(plain)))
        return error(at_, "'" + std::string(plain) + "' is a function", "its values go in parentheses");
      const Error unknown = names_.unknown(rest.substr(0, std::min<std::size_t>(end, 200)));
      return error(at_, unknown.what, unknown.fix);
    }
    return take(Token::Kind::name, length);
  }

  Status sign() {
    const std::string_view pair = source_.substr(at_, 2);
    const char c = source_[at_];
    if (pair.size() == 2 && find_binary(pair)) return take(Token::Kind::sign, 2);
    if (find_binary(pair.substr(0, 1)) || find_prefix(pair.substr(0, 1))) return take(Token::Kind::sign, 1);
    if (c == '(') return take(Token::Kind::open, 1);
    if (c == ')') return take(Token::Kind::close, 1);
    if (c == ',') return take(Token::Kind::comma, 1);
    if (c == '=') return error(at_, "'=' is not an operator", "to compare write ==");
    if (c == '&' || c == '|')
      return error(at_, std::string("'") + c + "' is not an operator", "write and, or");
    if (c == '%') return error(at_, "'%' is not an operator", "write mod(a, b)");
    const bool printable = c > ' ' && c < 127;
    return error(at_, printable ? std::string("'") + c + "' has no meaning here" : "a strange character");
  }

  std::string_view source_;
  const Names& names_;
  std::size_t at_ = 0, tokens_ = 0, depth_ = 0;
  bool after_value_ = false;  ///< where a `*` multiplies
  Token token_;
};

}  // namespace

/// Pratt parser: one function per level of nesting, a table of precedences, nodes in order of evaluation. Recursion is
/// bounded by the number of tokens.
///
/// Each part of an aggregate is an expression of its own. It takes what its things do not have from the inputs of the expression
/// around it, those in turn from theirs, so that the addresses in the text are the inputs of the outermost.
class Expression::Parser {
 public:
  Parser(std::string_view text, const Names& names) : lexer_(text, names) {}

  Result<Expression> parse(std::string_view text) {
    if (text.size() > longest_text) return lexer_.error(0, "it is longer than 2000 characters");
    SL_TRY(lexer_.advance());
    if (at(Token::Kind::end)) return lexer_.error(0, "it is empty");
    levels_.emplace_back();
    SL_TRY(value(lowest_precedence));
    if (at(Token::Kind::comma)) return fail("it holds several expressions", "keep one of them");
    if (!at(Token::Kind::end)) return fail(misplaced());
    SL_TRY(finish());
    Expression out = std::move(level().part.expression);
    out.text_ = text;
    out.patterns_ = std::move(patterns_);
    out.nesting_ = nesting_;
    return out;
  }

 private:
  using Kind = Node::Kind;
  using Source = Aggregate::Source;
  /// An expression that is being read.
  struct Level {
    Aggregate::Part part;
    int aggregate = -1;              ///< place in open_ of that which it is a part of
    std::size_t held = 0, most = 0;  ///< values on the stack now, and at most
  };

  bool at(Token::Kind kind) const { return lexer_.token().kind == kind; }
  const OperatorRule* binary() const {
    return at(Token::Kind::sign) ? find_binary(lexer_.token().text) : nullptr;
  }
  const OperatorRule* prefix() const {
    return at(Token::Kind::sign) ? find_prefix(lexer_.token().text) : nullptr;
  }
  Error fail(const std::string& what, const std::string& fix = "") const {
    return lexer_.error(lexer_.token().at, what, fix);
  }
  /// The error for a token behind a complete value.
  std::string misplaced() const {
    if (at(Token::Kind::where)) return "'where' belongs into an aggregate, as in count(x where c)";
    return at(Token::Kind::open) ? "this parenthesis does not belong here"
                                 : "an operator is missing before this";
  }
  Level& level() { return levels_.back(); }
  Expression& out() { return level().part.expression; }

  /// A node that takes `arguments` values from the stack and leaves one.
  void emit(const Node& node, std::size_t arguments) {
    out().nodes_.push_back(node);
    level().held += 1 - arguments;
    level().most = std::max(level().most, level().held);
  }
  void emit_call(Apply* apply, int arguments) {
    emit({Kind::call, arguments, 0, apply}, static_cast<std::size_t>(arguments));
  }

  /// Ends an expression.
  Status finish() {
    out().stack_.resize(level().most);
    level().part.inputs.resize(out().inputs_.size());
    // With every input NaN, whatever depends on one is NaN: what breaks now is made of constants alone.
    const std::vector<double> unknown(out().inputs_.size(), std::numeric_limits<double>::quiet_NaN());
    if (is_broken(out().run(unknown, {}, true)))
      return lexer_.error(0, "a part of it that is all constants is not a finite number",
                          "is it a division by 0?");
    return {};
  }

  /// An operand and all operators behind it of this precedence or higher.
  Status value(int precedence) {
    SL_TRY(operand());
    for (const OperatorRule* rule = binary(); rule && rule->precedence >= precedence; rule = binary()) {
      SL_TRY(lexer_.advance());
      SL_TRY(value(rule->precedence + (rule->from_right ? 0 : 1)));
      emit_call(rule->apply, 2);
    }
    return {};
  }

  Status operand() {
    switch (lexer_.token().kind) {
      case Token::Kind::number:
        emit({Kind::constant, 0, lexer_.token().number, nullptr}, 0);
        return lexer_.advance();
      case Token::Kind::name: {
        const std::string name(lexer_.token().text);
        emit({Kind::input, input(levels_.size() - 1, name, -1, ""), 0, nullptr}, 0);
        return lexer_.advance();
      }
      case Token::Kind::pattern: return value_of_things();
      case Token::Kind::function: return call();
      case Token::Kind::open:
        SL_TRY(lexer_.advance());
        SL_TRY(value(lowest_precedence));
        if (at(Token::Kind::comma)) return fail("a ',' outside of a function's values");
        return close();
      case Token::Kind::sign: {
        const OperatorRule* const rule = prefix();
        if (!rule) break;
        SL_TRY(lexer_.advance());
        if (prefix()) break;  // two signs in a row are more often a slip than meant
        SL_TRY(value(rule->precedence + 1));
        emit_call(rule->apply, 1);
        return {};
      }
      case Token::Kind::where: return fail(misplaced());
      case Token::Kind::close: return fail("this parenthesis does not belong here");
      case Token::Kind::comma: return fail("a ',' that separates no values");
      case Token::Kind::end: return fail("it ends where a value belongs");
    }
    return fail("an operator where a value belongs");
  }

  /// The input of an expression for an address. @param owner  the aggregate that reads it of each of its things, by `read`; -1:
  /// none, it is one value
  int input(std::size_t at_level, const std::string& name, int owner, const std::string& read) {
    Level& l = levels_[at_level];
    std::vector<std::string>& inputs = l.part.expression.inputs_;
    const auto known = std::find(inputs.begin(), inputs.end(), name);
    const int index = static_cast<int>(known - inputs.begin());
    if (known != inputs.end()) return index;
    inputs.push_back(name);
    if (at_level == 0) return index;
    if (l.aggregate == owner) {
      std::vector<std::string>& reads = patterns_[open_[static_cast<std::size_t>(owner)]].reads;
      const auto place = std::find(reads.begin(), reads.end(), read);
      const Source source{true, static_cast<int>(place - reads.begin())};
      if (place == reads.end()) reads.push_back(read);
      l.part.sources.push_back(source);
    } else {
      const Source source{false, input(at_level - 1, name, owner, read)};
      levels_[at_level].part.sources.push_back(source);
    }
    return index;
  }

  Status value_of_things() {
    const std::string name(lexer_.token().text);
    const std::size_t cut = name.find_first_of("./");
    const std::string things = name.substr(0, cut);
    if (open_.empty())
      return fail("'" + name + "' is a value of several things",
                  "say what of them: mean(" + name +
                      "), max(...), count(... > 0); a product has blanks around its *");
    std::size_t owner = 0;
    while (owner < open_.size() && !patterns_[open_[owner]].things.empty() &&
           patterns_[open_[owner]].things != things)
      ++owner;
    if (owner == open_.size())
      return fail("'" + name + "' is of other things than " + patterns_[open_.back()].things,
                  "an aggregate goes over the things of one pattern; one within it may go over others");
    patterns_[open_[owner]].things = things;
    emit(
        {Kind::input, input(levels_.size() - 1, name, static_cast<int>(owner), name.substr(cut)), 0, nullptr},
        0);
    return lexer_.advance();
  }

  Status call() {
    const std::size_t column = lexer_.token().at;
    const std::string name(lexer_.token().text);
    SL_TRY(lexer_.advance());  // to the parenthesis: the lexer looked ahead
    SL_TRY(lexer_.advance());
    if (const AggregateRule* const rule = find_aggregate(name);
        rule && (!find_function(name) || goes_over_things()))
      return aggregate(*rule, column);
    int count = 0;
    while (count > 0 || !at(Token::Kind::close)) {
      SL_TRY(value(lowest_precedence));
      ++count;
      if (!at(Token::Kind::comma)) break;
      SL_TRY(lexer_.advance());
    }
    SL_TRY(close());
    const FunctionRule& function = *find_function(name);
    if (count < function.fewest) return lexer_.error(column, "too few values for the function");
    if (count > function.most) return lexer_.error(column, "too many values for the function");
    emit_call(function.apply, count);
    return {};
  }

  /// Whether min() or max() is one of things: of one value, with a pattern in it.
  bool goes_over_things() const {
    Lexer ahead = lexer_;
    bool things = false;
    for (int depth = 0;;) {
      const Token::Kind kind = ahead.token().kind;
      if (kind == Token::Kind::end || (kind == Token::Kind::close && depth-- == 0)) return things;
      if (kind == Token::Kind::open) ++depth;
      if (kind == Token::Kind::comma && depth == 0) return false;
      things = things || kind == Token::Kind::pattern;
      if (!ahead.advance()) return false;
    }
  }

  Result<Aggregate::Part> part() {
    levels_.emplace_back().aggregate = static_cast<int>(open_.size()) - 1;
    SL_TRY(value(lowest_precedence));
    SL_TRY(finish());
    Aggregate::Part read = std::move(level().part);
    levels_.pop_back();
    return read;
  }

  Status aggregate(const AggregateRule& rule, std::size_t column) {
    const std::string name(rule.name);
    Aggregate a;
    a.reduce = rule.reduce;
    a.pattern = patterns_.size();
    open_.push_back(a.pattern);
    nesting_ = std::max(nesting_, static_cast<int>(open_.size()));
    if (nesting_ > most_nesting) return lexer_.error(column, "aggregates are more than 3 deep");
    patterns_.emplace_back();
    SL_ASSIGN(a.value, part());
    if (at(Token::Kind::where)) {
      SL_TRY(lexer_.advance());
      SL_ASSIGN(Aggregate::Part condition, part());
      a.where.push_back(std::move(condition));
    }
    if (patterns_[a.pattern].things.empty() && open_.size() > 1)
      return lexer_.error(
          column, "'" + name + "' goes over no things of its own",
          "the first pattern belongs to the aggregate around it; give what is in here a name under "
          "values, and use that");
    if (patterns_[a.pattern].things.empty())
      return lexer_.error(column, "'" + name + "' goes over no things of its own",
                          "name some by a * in a name: " + name + "(robot*.pose.x)");
    if (rule.has_parameter) {
      if (!at(Token::Kind::comma))
        return fail("a number from 0 to 1 is missing", "write " + name + "(robot*.pose.x, 0.9)");
      SL_TRY(lexer_.advance());
      a.parameter = lexer_.token().number;
      if (!at(Token::Kind::number) || !(a.parameter >= 0 && a.parameter <= 1))
        return fail("here belongs a number from 0 to 1");
      SL_TRY(lexer_.advance());
    }
    if (at(Token::Kind::comma)) return fail("'" + name + "' of things takes one value");
    SL_TRY(close());
    open_.pop_back();
    out().aggregates_.push_back(std::move(a));
    emit({Kind::aggregate, static_cast<int>(out().aggregates_.size()) - 1, 0, nullptr}, 0);
    return {};
  }

  Status close() {
    if (at(Token::Kind::end)) return fail("a ')' is missing");
    if (!at(Token::Kind::close)) return fail(misplaced());
    return lexer_.advance();
  }

  Lexer lexer_;
  std::vector<Level> levels_;      ///< from the whole to the part that is being read
  std::vector<std::size_t> open_;  ///< patterns of the aggregates around it
  std::vector<Pattern> patterns_;
  int nesting_ = 0;
};

Result<Expression> Expression::compile(std::string_view text, const Names& names, const Place& place) {
  auto expression = Parser(text, names).parse(text);
  if (!expression) expression.error().place = place;
  return expression;
}

double Expression::run(std::span<const double> inputs, std::span<const Table> tables, bool mark_broken) {
  double* top = stack_.data();  // one behind the last value
  for (const Node& node : nodes_) {
    switch (node.kind) {
      case Node::Kind::constant: *top++ = node.constant; break;
      case Node::Kind::input: *top++ = inputs[static_cast<std::size_t>(node.index)]; break;
      case Node::Kind::call:
        top -= node.index;
        *top = node.apply(top, node.index, mark_broken);
        ++top;
        break;
      case Node::Kind::aggregate:
        *top++ = aggregates_[static_cast<std::size_t>(node.index)].over(inputs, tables, mark_broken);
        break;
    }
  }
  return stack_.front();
}

double Expression::Aggregate::of(Part& part, std::span<const double> thing, std::span<const double> around,
                                 std::span<const Table> tables, bool mark_broken) {
  for (std::size_t i = 0; i < part.sources.size(); ++i) {
    const auto index = static_cast<std::size_t>(part.sources[i].index);
    part.inputs[i] = part.sources[i].own ? thing[index] : around[index];
    if (is_absent(part.inputs[i])) return part.inputs[i];
  }
  return part.expression.run(part.inputs, tables, mark_broken);
}

double Expression::Aggregate::over(std::span<const double> around, std::span<const Table> tables,
                                   bool mark_broken) {
  if (tables.empty()) return std::numeric_limits<double>::quiet_NaN();  // nothing is known yet
  const Table& table = tables[pattern];
  const std::size_t reads = table.things > 0 ? table.values.size() / table.things : 0;
  values.clear();
  for (std::size_t i = 0; i < table.things; ++i) {
    const auto thing = table.values.subspan(i * reads, reads);
    if (!where.empty()) {
      const double taken = of(where.front(), thing, around, tables, mark_broken);
      if (taken == 0 || is_absent(taken)) continue;
      if (std::isnan(taken)) return taken;
    }
    const double value_of_thing = of(value, thing, around, tables, mark_broken);
    if (!is_absent(value_of_thing)) values.push_back(value_of_thing);
  }
  return reduce(values, parameter, mark_broken);
}

Expression::Evaluated Expression::evaluate(std::span<const double> inputs, std::span<const Table> tables) {
  SL_CHECK(inputs.size() == inputs_.size() && tables.size() == patterns_.size());
  const double value = run(inputs, tables, true);
  if (std::isfinite(value)) return {value, true};
  if (is_absent(value)) return {value, true, true};
  // Again without the marks, so that a log shows the infinity.
  return {run(inputs, tables, false), false, false, is_broken(value)};
}

std::span<const Expression::Function> Expression::functions() { return function_list; }

bool Expression::is_reserved(std::string_view word) {
  if (find_function(word)) return true;
  for (const std::string_view other : {"and", "or", "not", "pi", "true", "false", "sim", "values"})
    if (word == other) return true;
  return false;
}

}  // namespace sandlot
