#pragma once
/// Log: warnings and notes to people on standard error while the program works, never results.
#include <functional>
#include <string_view>

namespace sandlot::log {

enum class Level { quiet, warning, info, debug };

void set_level(Level level);
void info(std::string_view text);
void warning(std::string_view text);
void debug(std::string_view text);

/// Also receives every entry, whatever the level, on the thread that logs it; must not log itself. Empty: no
/// receiver.
void set_listener(std::function<void(Level, std::string_view)> listener);

}  // namespace sandlot::log
