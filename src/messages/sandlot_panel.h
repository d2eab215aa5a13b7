#pragma once
/// sandlot_msgs of what people look at and press on a robot: screen, keys, speaker.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// New content of a rectangle of a screen, and of its lines as text.
struct ScreenPatch {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ScreenPatch";
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> data;
  bool has_text = false;
  std::vector<std::string> lines;
  std::vector<std::string> menu;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "px", "Column of the rectangle's left edge."}, s.x);
    visit(Field{"y", "px", "Row of its upper edge."}, s.y);
    visit(Field{"width", "px", "Width; 0: the picture stays."}, s.width);
    visit(Field{"height", "px", "Height; 0: the picture stays."}, s.height);
    visit(Field{"data", "", "Pixels, red, green and blue, row by row from the top."}, s.data);
    visit(Field{"has_text", "", "Whether lines and menu are given."}, s.has_text);
    visit(Field{"lines", "", "All lines of text that the screen shows, from the top."}, s.lines);
    visit(Field{"menu", "", "Labels of the keys, from the left."}, s.menu);
  }
};

/// Text that a screen shows.
struct ScreenText {
  static constexpr const char* ros_type = "sandlot_msgs/msg/ScreenText";
  Header header;
  std::vector<std::string> lines;
  std::vector<std::string> menu;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"lines", "", "Lines from the top."}, s.lines);
    visit(Field{"menu", "", "Labels of the keys, from the left."}, s.menu);
  }
};

/// Press of a key, or of a place on the screen.
struct KeyPress {
  static constexpr const char* ros_type = "sandlot_msgs/msg/KeyPress";
  std::uint32_t key = 0;
  std::int32_t x = 0;
  std::int32_t y = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"key", "1", "Number of the key, from 1; 0: the screen was touched."}, s.key);
    visit(Field{"x", "px", "Column of the touch."}, s.x);
    visit(Field{"y", "px", "Row of the touch."}, s.y);
  }
};

/// Latest presses of a robot's keys, the oldest first.
struct KeyPresses {
  static constexpr const char* ros_type = "sandlot_msgs/msg/KeyPresses";
  Header header;
  std::uint64_t count = 0;
  std::vector<KeyPress> latest;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"count", "1", "Number of presses so far; the last one of `latest` has this number."},
          s.count);
    visit(Field{"latest", "", "Up to 16 latest presses, the oldest first."}, s.latest);
  }
};

/// Sound that a speaker shall make; ends the one before.
struct Sound {
  static constexpr const char* ros_type = "sandlot_msgs/msg/Sound";
  double frequency = 0;
  double duration = 0;
  std::string name;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"frequency", "Hz", "Pitch of a tone; 0: none."}, s.frequency);
    visit(Field{"duration", "s", "Length of the sound; 0: silence."}, s.duration);
    visit(Field{"name", "", "Name of a recording that is played; empty: a tone."}, s.name);
  }
};

/// What a speaker is doing.
struct SpeakerState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/SpeakerState";
  Header header;
  bool playing = false;
  std::uint64_t sounds = 0;
  Sound sound;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"playing", "", "Whether the latest sound lasts."}, s.playing);
    visit(Field{"sounds", "1", "Number of sounds so far."}, s.sounds);
    visit(Field{"sound", "", "The latest one."}, s.sound);
  }
};

}  // namespace sandlot::msg
