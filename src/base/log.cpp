#include "base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <mutex>

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

std::mutex listener_mutex;
std::function<void(Level, std::string_view)> listener;

void notify(Level level, std::string_view text) {
  const std::lock_guard lock(listener_mutex);
  if (listener) listener(level, text);
}

}  // namespace

void set_listener(std::function<void(Level, std::string_view)> heard_by) {
  const std::lock_guard lock(listener_mutex);
  listener = std::move(heard_by);
}

void set_level(Level level) {
  switch (level) {
    case Level::quiet: logger().set_level(spdlog::level::err); break;
    case Level::warning: logger().set_level(spdlog::level::warn); break;
    case Level::info: logger().set_level(spdlog::level::info); break;
    case Level::debug: logger().set_level(spdlog::level::debug); break;
  }
}

void info(std::string_view text) {
  logger().info("{}", text);
  notify(Level::info, text);
}
void warning(std::string_view text) {
  logger().warn("{}", text);
  notify(Level::warning, text);
}
void debug(std::string_view text) {
  logger().debug("{}", text);
  notify(Level::debug, text);
}

}  // namespace sandlot::log
