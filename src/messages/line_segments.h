#pragma once
/// sandlot_msgs: straight pieces of what a scanner sees.
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// A straight piece.
struct LineSegment {
  static constexpr const char* ros_type = "sandlot_msgs/msg/LineSegment";
  Point start;
  Point end;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"start", "m", "Right end of the segment, as the scanner sees it."}, s.start);
    visit(Field{"end", "m", "Left end of the segment, as the scanner sees it."}, s.end);
  }
};

/// All straight pieces that a scanner sees.
struct LineSegmentArray {
  static constexpr const char* ros_type = "sandlot_msgs/msg/LineSegmentArray";
  Header header;
  std::vector<LineSegment> segments;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"segments", "m", "Segments in order from right to left."}, s.segments);
  }
};

}  // namespace sandlot::msg
