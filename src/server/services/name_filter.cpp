#include "server/services/name_filter.h"

#include <algorithm>
#include <cctype>
#include <memory>
#include <optional>
#include <string>

namespace sandlot::server {
namespace {

constexpr int deepest = 50, most_repeats = 255, endless = -1;

std::size_t index(char c) { return static_cast<unsigned char>(c); }

/// Part of an expression.
struct Part {
  enum class Kind : std::uint8_t { letter, sequence, choice, repeat, begin, end } kind = Kind::sequence;
  std::bitset<256> letters{};
  std::vector<std::unique_ptr<Part>> parts{};
  int least = 0, most = 0;  ///< of a repeat
};
using PartPtr = std::unique_ptr<Part>;

PartPtr make(Part::Kind kind) {
  auto out = std::make_unique<Part>();
  out->kind = kind;
  return out;
}

/// The letters of a class, such as "alpha".
bool add_class(std::string_view name, std::bitset<256>& out) {
  constexpr struct {
    std::string_view name;
    int (*has)(int);
  } classes[] = {{"alpha", std::isalpha}, {"digit", std::isdigit}, {"alnum", std::isalnum},
                 {"upper", std::isupper}, {"lower", std::islower}, {"space", std::isspace},
                 {"blank", std::isblank}, {"punct", std::ispunct}, {"xdigit", std::isxdigit},
                 {"print", std::isprint}, {"graph", std::isgraph}, {"cntrl", std::iscntrl}};
  for (const auto& each : classes) {
    if (each.name != name) continue;
    for (int c = 0; c < 128; ++c)
      if (each.has(c)) out.set(static_cast<std::size_t>(c));
    return true;
  }
  return false;
}

}  // namespace

/// Reads an expression into parts, and writes those out as states.
class NameFilter::Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Result<NameFilter> compile() {
    SL_ASSIGN(const PartPtr whole, choice(0));
    if (!text_.empty()) return Error{"')' without '(' in the filter"};
    emit(*whole);
    if (out_.states_.size() >= most_states)
      return Error{"the filter becomes longer than " + std::to_string(most_states) + " letters",
                   "smaller counts make it shorter"};
    push({State::Kind::found, 0, 0, 0});
    return std::move(out_);
  }

 private:
  Result<PartPtr> choice(int depth) {
    if (depth > deepest) return Error{"the groups of the filter are nested more than 50 deep"};
    PartPtr out = make(Part::Kind::choice);
    while (true) {
      SL_ASSIGN(PartPtr each, sequence(depth));
      out->parts.push_back(std::move(each));
      if (text_.empty() || text_.front() != '|') return out;
      text_.remove_prefix(1);
    }
  }

  Result<PartPtr> sequence(int depth) {
    PartPtr out = make(Part::Kind::sequence);
    while (!text_.empty() && text_.front() != '|' && text_.front() != ')') {
      SL_ASSIGN(PartPtr each, atom(depth));
      while (!text_.empty() && std::string_view("*+?{").find(text_.front()) != std::string_view::npos) {
        PartPtr repeated = make(Part::Kind::repeat);
        SL_TRY(read_count(*repeated));
        repeated->parts.push_back(std::move(each));
        each = std::move(repeated);
      }
      out->parts.push_back(std::move(each));
    }
    return out;
  }

  Status read_count(Part& out) {
    const char c = text_.front();
    text_.remove_prefix(1);
    out.least = c == '+' ? 1 : 0;
    out.most = c == '?' ? 1 : endless;
    if (c != '{') return {};
    const Error wrong{"a count of the filter is not {2}, {2,} or {2,3}", "255 is the largest"};
    const auto number = [&]() -> std::optional<int> {
      std::optional<int> read;
      while (!text_.empty() && text_.front() >= '0' && text_.front() <= '9' &&
             read.value_or(0) <= most_repeats) {
        read = 10 * read.value_or(0) + (text_.front() - '0');
        text_.remove_prefix(1);
      }
      return read;
    };
    const std::optional<int> least = number();
    if (!least) return wrong;
    out.least = out.most = *least;
    if (!text_.empty() && text_.front() == ',') {
      text_.remove_prefix(1);
      out.most = number().value_or(endless);
    }
    if (text_.empty() || text_.front() != '}' || out.least > most_repeats || out.most > most_repeats ||
        (out.most != endless && out.most < out.least))
      return wrong;
    text_.remove_prefix(1);
    return {};
  }

  Result<PartPtr> atom(int depth) {
    const char c = text_.front();
    if (std::string_view("*+?{").find(c) != std::string_view::npos)
      return Error{std::string("nothing stands before '") + c + "' in the filter"};
    text_.remove_prefix(1);
    if (c == '(') {
      SL_ASSIGN(PartPtr inner, choice(depth + 1));
      if (text_.empty()) return Error{"'(' without ')' in the filter"};
      text_.remove_prefix(1);
      return inner;
    }
    if (c == '^') return make(Part::Kind::begin);
    if (c == '$') return make(Part::Kind::end);
    PartPtr out = make(Part::Kind::letter);
    if (c == '.') {
      out->letters.set();
    } else if (c == '[') {
      SL_TRY(read_class(out->letters));
    } else if (c == '\\') {
      if (text_.empty()) return Error{"the filter ends with '\\'"};
      if (std::isalnum(static_cast<unsigned char>(text_.front())))
        return Error{std::string("'\\") + text_.front() + "' is not supported in filters"};
      out->letters.set(index(text_.front()));
      text_.remove_prefix(1);
    } else {
      out->letters.set(index(c));
    }
    return out;
  }

  /// What stands between brackets, the first of which has been read.
  Status read_class(std::bitset<256>& out) {
    const Error open{"'[' without ']' in the filter"};
    const bool inverted = !text_.empty() && text_.front() == '^';
    if (inverted) text_.remove_prefix(1);
    for (bool first = true; first || text_.empty() || text_.front() != ']'; first = false) {
      if (text_.empty()) return open;
      if (text_.size() > 1 && text_[0] == '[' &&
          std::string_view(":.=").find(text_[1]) != std::string_view::npos) {
        const std::size_t end = text_.find(":]", 2);
        if (text_[1] != ':' || end == std::string_view::npos || !add_class(text_.substr(2, end - 2), out))
          return Error{"'" + std::string(text_.substr(0, 12)) + "' is not a class of letters",
                       "[:alpha:], [:digit:], [:alnum:] ... are"};
        text_.remove_prefix(end + 2);
        continue;
      }
      const char from = text_.front();
      const bool range = text_.size() > 2 && text_[1] == '-' && text_[2] != ']';
      const char to = range ? text_[2] : from;
      if (index(to) < index(from)) return Error{"a range of the filter ends before it begins"};
      for (std::size_t each = index(from); each <= index(to); ++each) out.set(each);
      text_.remove_prefix(range ? 3 : 1);
    }
    text_.remove_prefix(1);
    if (inverted) out.flip();
    return {};
  }

  std::uint32_t here() const { return static_cast<std::uint32_t>(out_.states_.size()); }
  std::uint32_t push(State state) {
    out_.states_.push_back(state);
    return here() - 1;
  }

  /// Writes a part; what follows it comes right behind.
  void emit(const Part& part) {
    if (out_.states_.size() >= most_states) return;
    using Kind = State::Kind;
    switch (part.kind) {
      case Part::Kind::letter: {
        const auto letters = static_cast<std::uint32_t>(out_.letters_.size());
        out_.letters_.push_back(part.letters);
        push({Kind::letter, letters, here() + 1, 0});
        break;
      }
      case Part::Kind::begin: push({Kind::begin, 0, here() + 1, 0}); break;
      case Part::Kind::end: push({Kind::end, 0, here() + 1, 0}); break;
      case Part::Kind::sequence:
        for (const PartPtr& each : part.parts) emit(*each);
        break;
      case Part::Kind::choice: emit_choice(part); break;
      case Part::Kind::repeat: {
        for (int i = 0; i < part.least; ++i) emit(*part.parts.front());
        if (part.most == endless) {
          const std::uint32_t loop = push({Kind::split, 0, here() + 1, 0});
          emit(*part.parts.front());
          push({Kind::split, 0, loop, loop});
          out_.states_[loop].other = here();
        }
        std::vector<std::uint32_t> exits;
        for (int i = part.least; i < part.most; ++i) {
          exits.push_back(push({Kind::split, 0, here() + 1, 0}));
          emit(*part.parts.front());
        }
        for (const std::uint32_t each : exits) out_.states_[each].other = here();
        break;
      }
    }
  }

  void emit_choice(const Part& part) {
    std::vector<std::uint32_t> ends;
    for (std::size_t i = 0; i < part.parts.size(); ++i) {
      const bool last = i + 1 == part.parts.size();
      const std::uint32_t split = last ? 0 : push({State::Kind::split, 0, here() + 1, 0});
      emit(*part.parts[i]);
      if (last) break;
      ends.push_back(push({State::Kind::split, 0, 0, 0}));
      out_.states_[split].other = here();
    }
    for (const std::uint32_t each : ends) out_.states_[each].next = out_.states_[each].other = here();
  }

  std::string_view text_;
  NameFilter out_;
};

Result<NameFilter> NameFilter::compile(std::string_view text) {
  if (text.size() > most_letters) return Error{"the filter is longer than 1000 letters"};
  return Parser(text).compile();
}

bool NameFilter::matches(std::string_view name) const {
  std::vector<std::uint32_t> now, next, open;
  std::vector<std::size_t> entered(states_.size(),
                                   0);  // the position, from 1 on, at which a state was entered last
  bool found = false;
  // Enters a state and all that it leads to without a letter.
  const auto enter = [&](std::uint32_t state, std::size_t at, std::vector<std::uint32_t>& into) {
    open.assign(1, state);
    while (!open.empty()) {
      const std::uint32_t each = open.back();
      open.pop_back();
      if (entered[each] == at + 1) continue;
      entered[each] = at + 1;
      const State& is = states_[each];
      switch (is.kind) {
        case State::Kind::letter: into.push_back(each); break;
        case State::Kind::split:
          open.push_back(is.other);
          open.push_back(is.next);
          break;
        case State::Kind::begin:
          if (at == 0) open.push_back(is.next);
          break;
        case State::Kind::end:
          if (at == name.size()) open.push_back(is.next);
          break;
        case State::Kind::found: found = true; break;
      }
    }
  };
  for (std::size_t at = 0; at <= name.size() && !found; ++at) {
    enter(0, at, now);
    if (found || at == name.size()) break;
    next.clear();
    for (const std::uint32_t each : now)
      if (letters_[states_[each].letters].test(index(name[at]))) enter(states_[each].next, at + 1, next);
    now.swap(next);
  }
  return found;
}

}  // namespace sandlot::server
