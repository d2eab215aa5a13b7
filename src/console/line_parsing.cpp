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

bool fits(std::string_view pattern, std::string_view name, bool indices) {
  // The reachable places in the pattern, letter by letter of the name: linear in both, whatever the pattern.
  std::vector<bool> now(pattern.size() + 1, false), next(pattern.size() + 1, false);
  const auto pass_stars = [&](std::vector<bool>& places) {
    for (std::size_t p = 0; p < pattern.size(); ++p)
      if (places[p] && pattern[p] == '*') {
        places[p + 1] = true;
        if (p + 1 < pattern.size() && pattern[p + 1] == '*') places[p + 2] = true;
      }
  };
  now[0] = true;
  pass_stars(now);
  for (const char c : name) {
    std::fill(next.begin(), next.end(), false);
    for (std::size_t p = 0; p < pattern.size(); ++p) {
      if (!now[p]) continue;
      if (pattern[p] == '*') {
        const bool both = (p + 1 < pattern.size() && pattern[p + 1] == '*') ||
                          (p > 0 && pattern[p - 1] == '*');
        if (both || (c != '/' && c != '.')) next[p] = true;
      } else if (pattern[p] == '?') {
        if (c != '/' && c != '.') next[p + 1] = true;
      } else if (const std::size_t end = pattern[p] == '[' ? class_end(pattern, p, indices)
                                                           : std::string_view::npos;
                 end != std::string_view::npos) {
        if (in_class(pattern.substr(p + 1, end - p - 1), c)) next[end + 1] = true;
      } else if (pattern[p] == c) {
        next[p + 1] = true;
      }
    }
    pass_stars(next);
    now.swap(next);
  }
  return now[pattern.size()];
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
  // "90 deg" as two words: the second is no number, so it can only be the unit of the first.
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
  const Error wrong{"'" + std::string(text.substr(0, 40)) + "' is no colour",
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
