#include "devices/signals/text_display/text_display.h"

#include <algorithm>

namespace sandlot::text_display {
namespace {

constexpr std::size_t most_orders = 64;

bool begins_character(char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), begins_character));
}

}  // namespace

Result<Display> Display::create(const DeviceBuild& build, Spec spec) {
  Display display{spec, {}};
  display.state.lines.reserve(static_cast<std::size_t>(spec.rows));
  display.orders = build.accept_queue<msg::String>(0, "text", most_orders);
  display.screen = build.publish<msg::String>(0, "text");
  return display;
}

void Display::print(std::string_view text) {
  std::vector<std::string>& lines = state.lines;
  const auto begin_line = [&] {
    if (lines.size() < static_cast<std::size_t>(spec.rows)) {
      lines.emplace_back();
    } else {  // the top line becomes the new one, with its memory
      std::rotate(lines.begin(), lines.begin() + 1, lines.end());
      lines.back().clear();
    }
  };
  for (const char c : text) {
    if (c == '\f') {
      lines.clear();
    } else if (c == '\n') {
      if (lines.empty()) begin_line();
      begin_line();
    } else if (static_cast<unsigned char>(c) >= ' ' && c != '\x7f') {
      if (lines.empty()) begin_line();
      const bool full = characters(lines.back()) >= static_cast<std::size_t>(spec.columns);
      if (full && begins_character(c)) begin_line();
      // Bytes that continue no character would never fill a line.
      if (lines.back().size() < 4 * static_cast<std::size_t>(spec.columns)) lines.back() += c;
    }
  }
}

void Display::actuate(PoolView<Display> pool, const Context&) {
  for (const std::uint32_t index : pool.due) {
    Display& display = pool.all[index];
    for (; !display.orders->empty(); display.orders->pop()) display.print(display.orders->front().data);
  }
}

void Display::sense(PoolView<Display> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Display& display = pool.all[index];
    std::string& shown = display.screen->message.data;
    shown.clear();
    for (std::size_t i = 0; i < display.state.lines.size(); ++i) {
      if (i > 0) shown += '\n';
      shown += display.state.lines[i];
    }
    display.screen->publish(context.now);
  }
}

bool Display::fits() const {
  return state.lines.size() <= static_cast<std::size_t>(spec.rows) &&
         std::all_of(state.lines.begin(), state.lines.end(), [&](const std::string& line) {
           return line.size() <= 4 * static_cast<std::size_t>(spec.columns);
         });
}

Result<msg::std_srvs::Trigger::Response> Display::clear(const msg::std_srvs::Trigger::Request&,
                                                        const Context&) {
  state.lines.clear();
  return msg::std_srvs::Trigger::Response{true, "the screen is empty"};
}

namespace {
constexpr LevelInfo levels[] = {
    {"text", msg::String::ros_type, msg::String::ros_type, "Lines of text."},
};
constexpr DeviceService services[] = {
    device_service<Display, msg::std_srvs::Trigger, &Display::clear>("clear", "Clears the screen."),
};
}  // namespace

constinit const Kind kind = make_kind<Display>({
    .name = "text_display",
    .help = "Small screen that shows lines of text.",
    .levels = levels,
    .services = services,
});

}  // namespace sandlot::text_display
