#pragma once
/// What the program says to people while it works: warnings and notes on standard error, never results.
#include <string_view>

namespace sandlot::log {

enum class Level { quiet, warning, info, debug };

void set_level(Level level);
void info(std::string_view text);
void warning(std::string_view text);
void debug(std::string_view text);

}  // namespace sandlot::log
