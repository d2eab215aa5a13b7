#include "devices/panel/screen/screen.h"

#include <algorithm>
#include <cmath>

namespace sandlot::screen {
namespace {

constexpr std::size_t most_patches = 64;
constexpr std::size_t most_lines = 200, most_labels = 16, most_line_bytes = 400;

/// Takes over at most `most` texts, each cut at a character, without a new allocation where the old ones had room.
void take_texts(const std::vector<std::string>& from, std::size_t most, std::vector<std::string>& to) {
  to.resize(std::min(from.size(), most));
  for (std::size_t i = 0; i < to.size(); ++i) {
    std::size_t size = std::min(from[i].size(), most_line_bytes);
    while (size > 0 && size < from[i].size() && (static_cast<unsigned char>(from[i][size]) & 0xc0) == 0x80)
      --size;
    to[i].assign(from[i], 0, size);
  }
}

bool fit(const std::vector<std::string>& texts, std::size_t most) {
  return texts.size() <= most && std::all_of(texts.begin(), texts.end(), [](const std::string& text) {
           return text.size() <= most_line_bytes;
         });
}

}  // namespace

Result<Screen> Screen::create(const DeviceBuild& build, Spec spec) {
  Screen screen{spec, {}};
  screen.patches = build.accept_queue<msg::ScreenPatch>(0, "pixels", most_patches);
  screen.image = build.publish<msg::Image>(0, "pixels");
  screen.text = build.publish<msg::ScreenText>(0, "text");
  msg::Image& image = screen.image->message;
  image.header.frame_id = screen.text->message.header.frame_id = build.frame_id();
  image.width = static_cast<std::uint32_t>(spec.width_px);
  image.height = static_cast<std::uint32_t>(spec.height_px);
  image.step = 3 * image.width;
  image.encoding = "rgb8";
  return screen;
}

void Screen::draw(const msg::ScreenPatch& patch) {
  ++state.taken;
  // The product of two 32-bit numbers has room in 64 bits; three times it may not.
  const std::uint64_t area = std::uint64_t{patch.width} * patch.height;
  const auto width = static_cast<std::uint32_t>(spec.width_px);
  const auto height = static_cast<std::uint32_t>(spec.height_px);
  const bool is_inside = area == 0 || (patch.x < width && patch.width <= width - patch.x &&
                                       patch.y < height && patch.height <= height - patch.y);
  if (!is_inside || patch.data.size() % 3 != 0 || patch.data.size() / 3 != area) {
    ++state.refused;
    return;
  }
  if (patch.has_text) {
    take_texts(patch.lines, most_lines, state.lines);
    take_texts(patch.menu, most_labels, state.menu);
    ++state.written;
  }
  if (area == 0) return;
  if (state.pixels.empty()) fill(state.pixels);
  for (std::size_t row = 0; row < patch.height; ++row) {
    const auto from = patch.data.begin() + static_cast<std::ptrdiff_t>(3 * row * patch.width);
    const std::size_t to = 3 * ((patch.y + row) * width + patch.x);
    std::copy_n(from, 3 * std::size_t{patch.width}, state.pixels.begin() + static_cast<std::ptrdiff_t>(to));
  }
  ++state.drawn;
}

void Screen::actuate(PoolView<Screen> pool, const Context&) {
  for (const std::uint32_t index : pool.due) {
    Screen& screen = pool.all[index];
    for (; !screen.patches->empty(); screen.patches->pop()) screen.draw(screen.patches->front());
  }
}

void Screen::fill(std::vector<std::uint8_t>& pixels) const {
  pixels.resize(bytes());
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<std::uint8_t>(std::lround(255 * spec.background[i % 3]));
}

void Screen::publish_picture(Time now) {
  if (state.pixels.empty()) fill(image->message.data);
  else image->message.data = state.pixels;
  image->publish(now);
  state.pictures = state.drawn;
  state.picture_at = now;
}

void Screen::sense(PoolView<Screen> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Screen& screen = pool.all[index];
    State& state = screen.state;
    const auto is_due = [&](std::uint64_t change, std::uint64_t published, Time at) {
      return change != published ||
             (change > 0 && screen.spec.repeat_s > 0 && (context.now - at).s() >= screen.spec.repeat_s);
    };
    if (is_due(state.drawn, state.pictures, state.picture_at)) screen.publish_picture(context.now);
    if (is_due(state.written, state.texts, state.text_at)) {
      screen.text->message.lines = state.lines;
      screen.text->message.menu = state.menu;
      screen.text->publish(context.now);
      state.texts = state.written;
      state.text_at = context.now;
    }
  }
}

bool Screen::fits() const {
  return (state.pixels.empty() || state.pixels.size() == bytes()) && fit(state.lines, most_lines) &&
         fit(state.menu, most_labels);
}

Result<msg::std_srvs::Trigger::Response> Screen::clear(const msg::std_srvs::Trigger::Request&,
                                                       const Context&) {
  state.pixels.clear();
  state.lines.clear();
  state.menu.clear();
  ++state.drawn;
  ++state.written;
  return msg::std_srvs::Trigger::Response{true, "the screen is empty"};
}

namespace {
constexpr LevelInfo levels[] = {
    {"pixels", msg::Image::ros_type, msg::ScreenPatch::ros_type, "Picture and text of the screen."},
};
constexpr DeviceService services[] = {
    device_service<Screen, msg::std_srvs::Trigger, &Screen::clear>("clear", "Empties the screen."),
};
}  // namespace

constinit const Kind kind = make_kind<Screen>({
    .name = "screen",
    .help = "Colour LCD that a program draws on and people look at.",
    .levels = levels,
    .services = services,
});

}  // namespace sandlot::screen
