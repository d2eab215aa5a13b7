#pragma once
/// What the program says to people while it works: warnings and notes on standard error, never results.
#include <functional>
#include <string_view>

namespace sandlot::log {

enum class Level { quiet, warning, info, debug };

void set_level(Level level);
void info(std::string_view text);
void warning(std::string_view text);
void debug(std::string_view text);

/// Hears what is said as well, whatever the level; from the thread that says it. Empty: nobody does. It must say nothing itself.
void set_listener(std::function<void(Level, std::string_view)> listener);

}  // namespace sandlot::log
