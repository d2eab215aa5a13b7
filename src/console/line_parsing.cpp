#include "console/line_parsing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/text.h"
#include "base/units.h"

namespace sandlot::console {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// Where the class that begins at pattern[at] == '[' ends (its ']'), or npos when it is none.
std::size_t class_end(std::string_view pattern, std::size_t at, bool indices) {
  const std::size_t end = pattern.find(']', at + 1);
  if (end == std::string_view::npos || end == at + 1) return std::string_view::npos;
  const std::string_view inside = pattern.substr(at + 1, end - at - 1);
  const bool index = std::all_of(inside.begin(), inside.end(),
                                 [](unsigned char c) { return std::isdigit(c) != 0; });
  return indices && index ? std::string_view::npos : end;
}

bool in_class(std::string_view inside, char c) {
  const bool negated = inside.front() == '!' && inside.size() > 1;
  if (negated) inside.remove_prefix(1);
  bool found = false;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (i + 2 < inside.size() && inside[i + 1] == '-') {
      found = found || (inside[i] <= c && c <= inside[i + 2]);
      i += 2;
    } else {
      found = found || inside[i] == c;
    }
  }
  return found != negated;
}

}  // namespace

Result<std::vector<Word>> words_of(std::string_view line) {
  std::vector<Word> out;
  bool in_word = false;
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (!quote && is_blank(c)) {
      in_word = false;
      continue;
    }
    if (!in_word) out.push_back({"", i, i});
    in_word = true;
    out.back().end = i + 1;
    if (quote ? c == quote : c == '"' || c == '\'') quote = quote ? '\0' : c;
    else out.back().text += c;
  }
  if (quote) return Error{"a quote is not closed in '" + std::string(line.substr(0, 200)) + "'"};
  return out;
}

std::vector<Word> plain_words_of(std::string_view line) {
  std::vector<Word> out;
  bool in_word = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (is_blank(line[i])) {
      in_word = false;
      continue;
    }
    if (!in_word) out.push_back({"", i, i});
    in_word = true;
    out.back().end = i + 1;
    out.back().text += line[i];
  }
  return out;
}

Pattern::Pattern(std::string_view text, bool indices)
    : words_(text.size() / 64 + 1), end_(0), moves_(256 * words_, 0), star_(words_, 0), deep_(words_, 0) {
  for (std::size_t i = 0; i < text.size(); ++end_) {
    const std::size_t word = end_ / 64;
    const Bits bit = Bits{1} << end_ % 64;
    const auto lead_on = [&](std::size_t letter) { moves_[letter * words_ + word] |= bit; };
    const std::size_t end = text[i] == '[' ? class_end(text, i, indices) : std::string_view::npos;
    if (text[i] == '*') {
      const std::size_t stars = std::min(text.find_first_not_of('*', i), text.size()) - i;
      star_[word] |= bit;
      if (stars > 1) deep_[word] |= bit;
      i += stars;
    } else if (text[i] == '?') {
      for (std::size_t letter = 0; letter < 256; ++letter)
        if (letter != '/' && letter != '.') lead_on(letter);
      ++i;
    } else if (end != std::string_view::npos) {
      for (std::size_t letter = 0; letter < 256; ++letter)
        if (in_class(text.substr(i + 1, end - i - 1), static_cast<char>(letter))) lead_on(letter);
      i = end + 1;
    } else {
      lead_on(static_cast<unsigned char>(text[i]));
      ++i;
    }
  }
}

bool Pattern::fits(std::string_view name) const {
  Bits one = 0;
  std::vector<Bits> more(words_ > 1 ? words_ : 0);
  Bits* const places = words_ > 1 ? more.data() : &one;
  places[0] = 1;
  // No two stars are neighbours, so that one pass leads past all that may stand for nothing.
  const auto pass_stars = [&] {
    Bits carry = 0;
    for (std::size_t w = 0; w < words_; ++w) {
      const Bits past = places[w] & star_[w];
      places[w] |= past << 1 | carry;
      carry = past >> 63;
    }
  };
  pass_stars();
  for (const char c : name) {
    const Bits* const moves = &moves_[static_cast<unsigned char>(c) * words_];
    const std::vector<Bits>& stays = c == '/' || c == '.' ? deep_ : star_;
    Bits carry = 0;
    for (std::size_t w = 0; w < words_; ++w) {
      const Bits moved = places[w] & moves[w];
      places[w] = moved << 1 | carry | (places[w] & stays[w]);
      carry = moved >> 63;
    }
    pass_stars();
  }
  return places[end_ / 64] >> end_ % 64 & 1;
}

bool is_pattern(std::string_view text, bool indices) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '*' || text[i] == '?') return true;
    if (text[i] == '[' && class_end(text, i, indices) != std::string_view::npos) return true;
  }
  return false;
}

Result<double> take_quantity(std::span<const std::string>& words, const char* name, const char* unit) {
  if (words.empty()) return Error{std::string(name) + " is missing", std::string("a number in ") + unit};
  std::string text = words.front();
  std::size_t taken = 1;
  double number = 0;
  // "90 deg" as two words: the second is not a number, so it can only be the unit of the first.
  if (words.size() > 1 && parse_number(text, number) && !words[1].empty() &&
      (std::isalpha(static_cast<unsigned char>(words[1].front())) || words[1] == "%") &&
      parse_quantity(text + " " + words[1], unit)) {
    text += " " + words[1];
    taken = 2;
  }
  auto value = parse_quantity(text, unit);
  if (!value) return Error{std::string(name) + ": " + value.error().what, value.error().fix};
  if (!std::isfinite(*value) || std::abs(*value) > 1e9)
    return Error{std::string(name) + ": must be in [-1e9, 1e9] " + unit + ", is " + number_text(*value)};
  words = words.subspan(taken);
  return *value;
}

Result<Color> read_color(std::string_view text) {
  struct Named {
    const char* name;
    Color color;
  };
  static constexpr Named named[] = {
      {"red", {0.8f, 0.1f, 0.1f, 1}},
      {"green", {0.1f, 0.6f, 0.1f, 1}},
      {"blue", {0.1f, 0.2f, 0.8f, 1}},
      {"yellow", {0.9f, 0.8f, 0.1f, 1}},
      {"orange", {0.9f, 0.4f, 0.05f, 1}},
      {"purple", {0.5f, 0.1f, 0.6f, 1}},
      {"white", {1, 1, 1, 1}},
      {"grey", {0.5f, 0.5f, 0.5f, 1}},
      {"gray", {0.5f, 0.5f, 0.5f, 1}},
      {"black", {0.05f, 0.05f, 0.05f, 1}},
      {"brown", {0.4f, 0.25f, 0.1f, 1}},
      {"pink", {0.9f, 0.5f, 0.6f, 1}},
  };
  std::vector<std::string> names;
  for (const Named& each : named) {
    if (text == each.name) return each.color;
    names.emplace_back(each.name);
  }
  const Error wrong{"'" + std::string(text.substr(0, 40)) + "' is not a colour",
                    "write #rrggbb, red,green,blue from 0 to 1, or a name: " + suggestion(text, names)};
  float parts[4] = {0, 0, 0, 1};
  if (!text.empty() && text.front() == '#') {
    if (text.size() != 7) return wrong;
    for (std::size_t i = 0; i < 6; ++i) {
      const char c = text[1 + i];
      if (!std::isxdigit(static_cast<unsigned char>(c))) return wrong;
      const int digit = c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10;
      parts[i / 2] += static_cast<float>(digit) * (i % 2 ? 1.0f : 16.0f) / 255.0f;
    }
    return Color{parts[0], parts[1], parts[2], 1};
  }
  const auto pieces = split(text, ',');
  if (pieces.size() != 3 && pieces.size() != 4) return wrong;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    double number = 0;
    if (!parse_number(pieces[i], number) || !(number >= 0 && number <= 1)) return wrong;
    parts[i] = static_cast<float>(number);
  }
  return Color{parts[0], parts[1], parts[2], parts[3]};
}

std::string readable(double value) {
  constexpr double exact = 9007199254740992.0;  // 2^53
  if (!std::isfinite(value) || (value == std::floor(value) && std::abs(value) < exact))
    return number_text(value + 0.0);
  if (std::abs(value) < 1000 || std::abs(value) >= exact) return fmt::format("{:.6g}", value);
  return number_text(std::round(value * 1000) / 1000);
}

std::string with_unit(double value, std::string_view unit) {
  std::string text = readable(value);
  if (!unit.empty() && unit != "1") text.append(" ").append(unit);
  return text;
}

}  // namespace sandlot::console
