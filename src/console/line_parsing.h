#pragma once
/// The words of a console line, and what people write as one: addresses with wild cards, quantities, colours.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "geometry/color.h"

namespace sandlot::console {

struct Word {
  std::string text;
  std::size_t begin = 0, end = 0;  ///< where it stands in the line
};

/// Words parted by blanks; "..." and '...' keep blanks. Errors: a quote that is not closed.
Result<std::vector<Word>> words_of(std::string_view line);
/// The same without quotes, for lines whose rest is taken as it stands.
std::vector<Word> plain_words_of(std::string_view line);

/// Pattern of names: * stands for any letters but / and ., ** for any at all, ? for one, [ab] or [a-c] for one of these
/// ([!ab]: none of these). In paths of values "[3]" is an index: letters in brackets that are digits alone stand for
/// themselves when `indices`.
/// Cost  2 KB to make for up to 64 places; then a name costs three operations per letter, whatever the pattern.
class Pattern {
 public:
  explicit Pattern(std::string_view text, bool indices = false);
  bool fits(std::string_view name) const;

 private:
  // The places in a pattern that a name has led to are bits, 64 in a word; a letter moves all of them at once.
  using Bits = std::uint64_t;
  std::size_t words_;              ///< that hold all places
  std::size_t end_;                ///< place behind the last
  std::vector<Bits> moves_;        ///< for each letter, the places that it leads one further
  std::vector<Bits> star_, deep_;  ///< places of * and **, and of ** alone
};
inline bool fits(std::string_view pattern, std::string_view name, bool indices = false) {
  return Pattern(pattern, indices).fits(name);
}
/// Whether there is a wild card in it.
bool is_pattern(std::string_view text, bool indices = false);

/// A number with its unit from the front of `words`, which may be two words ("90 deg"); takes them away.
/// @param name  what the number is, for the error: "X"
Result<double> take_quantity(std::span<const std::string>& words, const char* name, const char* unit);

/// "red", "#ff8000" or "1,0.5,0[,1]".
Result<Color> read_color(std::string_view text);

/// A number as people read it: to six significant digits, but no coarser than thousandths; whole numbers are exact. Answers
/// that programs read (--json) have all digits.
std::string readable(double value);
/// The same with its unit: "0.02 m", "3".
std::string with_unit(double value, std::string_view unit);

}  // namespace sandlot::console
