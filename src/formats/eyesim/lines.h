#pragma once
/// Files of EyeSim as lines of words. `#` and `;` begin a comment; a name with blanks stands in double quotes. Lengths are in
/// mm, angles in degrees.
///
/// Errors   text that is none, more than most_lines lines, a quotation without an end.
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace sandlot::formats::eyesim {

inline constexpr std::size_t most_bytes = std::size_t{4} << 20, most_lines = 100'000;

struct Line {
  std::vector<std::string> words;  ///< at least one
  Place place;

  const std::string& keyword() const { return words.front(); }
  std::size_t arguments() const { return words.size() - 1; }
  Error error(std::string what, std::string fix = "") const;
};

Result<std::vector<Line>> lines_of(std::string_view text, const std::string& file);

/// "Wall" as "wall"; EyeSim does not mind.
std::string lower(std::string_view word);

/// A word as a number; an error names it and says what it should be.
Result<double> number_at(const Line& line, std::size_t word, const char* what);
/// All words from `first` on as numbers.
Result<std::vector<double>> numbers_from(const Line& line, std::size_t first);
bool is_number(std::string_view word);

/// Words that are not known are left out with one warning each.
void warn_unknown(const Line& line, Diagnostics& diagnostics);

inline constexpr double mm = 1e-3;
double radians(double degrees);

}  // namespace sandlot::formats::eyesim
