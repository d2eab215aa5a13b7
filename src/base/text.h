#pragma once
/// Small text services for error messages and names.
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sandlot {

/// The candidate nearest to `word` by edit distance (case ignored), or "" when none is near enough to be a
/// plausible slip (more than a third of the letters differ).
std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// "did you mean 'x'?" or, when nothing is near, "known are: a, b, c" (at most twelve).
std::string suggestion(std::string_view word, std::span<const std::string> candidates);

/// Shortest decimal text that reads back as exactly `x`.
std::string number_text(double x);

/// At most three digits, for messages: 0.00305.
std::string short_text(double x);

/// The whole of `text`, blanks around it aside, as a number: "1", "-2.5e3", "+1", "nan", "inf"; no locale.
/// False when it is not one, or one that a double cannot hold.
bool parse_number(std::string_view text, double& out);

std::string_view trim(std::string_view text);
bool is_one_of(std::string_view text, std::initializer_list<std::string_view> candidates);
/// The part before the first '/', or all of it: "robot1" of "robot1/laser".
std::string_view first_part(std::string_view path);
/// Whether a name fits a pattern, in which each `*` stands for any letters or none.
bool fits_pattern(std::string_view name, std::string_view pattern);
bool starts_with(std::string_view text, std::string_view prefix);
std::vector<std::string_view> split(std::string_view text, char separator);

/// The form a name takes in addresses: letters, digits, '_', '-'; everything else becomes '_'.
std::string sanitised(std::string_view name);

}  // namespace sandlot
