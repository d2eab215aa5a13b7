#include "server/services/name_filter.h"

namespace sandlot::server {
namespace {

std::size_t index(char c) { return static_cast<unsigned char>(c); }

/// Reads what stands between brackets. @return the number of letters read, 0: it does not end
std::size_t read_class(std::string_view text, std::bitset<256>& out) {
  std::size_t i = 1;
  const bool inverted = i < text.size() && text[i] == '^';
  if (inverted) ++i;
  for (bool first = true; i < text.size() && (first || text[i] != ']'); first = false) {
    char last = text[i];
    if (i + 2 < text.size() && text[i + 1] == '-' && text[i + 2] != ']') last = text[i + 2];
    for (std::size_t c = index(text[i]); c <= index(last); ++c) out.set(c);
    i += last == text[i] ? 1 : 3;
  }
  if (i >= text.size()) return 0;
  if (inverted) out.flip();
  return i + 1;
}

}  // namespace

Result<NameFilter> NameFilter::compile(std::string_view text) {
  constexpr std::size_t most_letters = 1000;
  if (text.size() > most_letters) return Error{"the filter is longer than 1000 letters"};
  NameFilter out;
  if (!text.empty() && text.front() == '^') {
    out.from_begin_ = true;
    text.remove_prefix(1);
  }
  if (!text.empty() && text.back() == '$' && (text.size() < 2 || text[text.size() - 2] != '\\')) {
    out.to_end_ = true;
    text.remove_suffix(1);
  }
  while (!text.empty()) {
    const char c = text.front();
    if (c == '*' || c == '+' || c == '?') {
      if (out.parts_.empty()) return Error{std::string("nothing stands before '") + c + "' in the filter"};
      Part& part = out.parts_.back();
      part.optional = part.optional || c != '+';
      part.repeated = part.repeated || c != '?';
      text.remove_prefix(1);
      continue;
    }
    if (std::string_view("|(){}^$").find(c) != std::string_view::npos)
      return Error{std::string("'") + c + "' is not supported in filters", "letters, . [a-z] * + ? ^ $ are"};
    Part part;
    std::size_t read = 1;
    if (c == '.') {
      part.letters.set();
    } else if (c == '[') {
      read = read_class(text, part.letters);
      if (read == 0) return Error{"'[' without ']' in the filter"};
    } else if (c == '\\') {
      if (text.size() < 2) return Error{"the filter ends with '\\'"};
      part.letters.set(index(text[1]));
      read = 2;
    } else {
      part.letters.set(index(c));
    }
    out.parts_.push_back(part);
    text.remove_prefix(read);
  }
  return out;
}

bool NameFilter::matches(std::string_view name) const {
  // at[i]: the first i parts may have been found, ending here.
  std::vector<char> at(parts_.size() + 1), next;
  const auto skip = [&](std::vector<char>& states) {
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (states[i] && parts_[i].optional) states[i + 1] = 1;
  };
  at[0] = 1;
  skip(at);
  for (const char c : name) {
    if (at.back() && !to_end_) return true;
    next.assign(parts_.size() + 1, 0);
    next[0] = !from_begin_;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (!parts_[i].letters.test(index(c))) continue;
      if (at[i]) next[i + 1] = 1;
      if (at[i + 1] && parts_[i].repeated) next[i + 1] = 1;
    }
    skip(next);
    at.swap(next);
  }
  return at.back() != 0;
}

}  // namespace sandlot::server
