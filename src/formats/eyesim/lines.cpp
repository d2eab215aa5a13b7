#include "formats/eyesim/lines.h"

#include <cmath>
#include <utility>

#include "base/math.h"
#include "base/text.h"
#include "files/text.h"

namespace sandlot::formats::eyesim {
namespace {

/// Farther away nothing is of use, and numbers keep their digits.
constexpr double largest = 1e9;

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

Status split_words(std::string_view text, Line& line) {
  std::size_t at = 0;
  while (at < text.size()) {
    const char c = text[at];
    if (is_blank(c)) {
      ++at;
    } else if (c == '#' || c == ';') {
      break;
    } else if (c == '"') {
      const std::size_t end = text.find('"', at + 1);
      if (end == std::string_view::npos) return line.error("a name has no closing quotation mark");
      line.words.emplace_back(text.substr(at + 1, end - at - 1));
      at = end + 1;
    } else {
      std::size_t end = at;
      while (end < text.size() && !is_blank(text[end]) && text[end] != '#' && text[end] != ';') ++end;
      line.words.emplace_back(text.substr(at, end - at));
      at = end;
    }
  }
  return {};
}

}  // namespace

Error Line::error(std::string what, std::string fix) const {
  return {std::move(what), std::move(fix), place};
}

Result<std::vector<Line>> lines_of(std::string_view text, const std::string& file) {
  SL_TRY(check_text(text, file));
  std::vector<Line> out;
  const auto name = std::make_shared<const std::string>(file);
  int number = 0;
  for (const std::string_view each : split(text, '\n')) {
    Line line;
    line.place = place_in(name, ++number);
    if (static_cast<std::size_t>(number) > most_lines)
      return line.error("the file has more than " + std::to_string(most_lines) + " lines");
    SL_TRY(split_words(each, line));
    if (!line.words.empty()) out.push_back(std::move(line));
  }
  return out;
}

std::string lower(std::string_view word) {
  std::string out(word);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

bool is_number(std::string_view word) {
  double number = 0;
  return parse_number(word, number) && std::isfinite(number);
}

Result<double> number_at(const Line& line, std::size_t word, const char* what) {
  double number = 0;
  if (word >= line.words.size()) return line.error("'" + line.keyword().substr(0, 40) + "' lacks " + what);
  const std::string& text = line.words[word];
  if (!parse_number(text, number) || !(std::abs(number) <= largest))
    return line.error("'" + text.substr(0, 40) + "' is not a number for " + what, "give one within 1e9");
  return number;
}

Result<std::vector<double>> numbers_from(const Line& line, std::size_t first) {
  std::vector<double> out;
  for (std::size_t i = first; i < line.words.size(); ++i) {
    SL_ASSIGN(const double number, number_at(line, i, "this place"));
    out.push_back(number);
  }
  return out;
}

void warn_unknown(const Line& line, Diagnostics& diagnostics) {
  diagnostics.warn(line.error("'" + line.keyword().substr(0, 40) + "' is not known and left out"));
}

double radians(double degrees) { return degrees * (math::pi / 180); }

}  // namespace sandlot::formats::eyesim
