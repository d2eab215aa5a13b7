#pragma once
/// sandlot_msgs: words between robots.
#include <string>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// A word that was heard.
struct Heard {
  static constexpr const char* ros_type = "sandlot_msgs/msg/Heard";
  std::string text;
  Time stamp;
  double level = 0;
  Vec3 direction;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"text", "", "What was said."}, s.text);
    visit(Field{"stamp", "s", "Time of arrival."}, s.stamp);
    visit(Field{"level", "dB", "Level at the ear."}, s.level);
    visit(Field{"direction", "1", "Unit vector towards where it came from, in the frame of the ear."},
          s.direction);
  }
};

/// All words heard since the sample before.
struct HeardArray {
  static constexpr const char* ros_type = "sandlot_msgs/msg/HeardArray";
  Header header;
  std::vector<Heard> words;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"words", "", "Words in the order of their arrival."}, s.words);
  }
};

}  // namespace sandlot::msg
