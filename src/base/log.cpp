#include "base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace sandlot::log {
namespace {

spdlog::logger& logger() {
  static const auto instance = [] {
    auto made = spdlog::stderr_color_mt("sandlot");
    made->set_pattern("%^%l:%$ %v");
    return made;
  }();
  return *instance;
}

}  // namespace

void set_level(Level level) {
  switch (level) {
    case Level::quiet: logger().set_level(spdlog::level::err); break;
    case Level::warning: logger().set_level(spdlog::level::warn); break;
    case Level::info: logger().set_level(spdlog::level::info); break;
    case Level::debug: logger().set_level(spdlog::level::debug); break;
  }
}

void info(std::string_view text) { logger().info("{}", text); }
void warning(std::string_view text) { logger().warn("{}", text); }
void debug(std::string_view text) { logger().debug("{}", text); }

}  // namespace sandlot::log
