#pragma once
/// tf2_msgs and rosgraph_msgs (Humble): the frames and the clock.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"

namespace sandlot::msg {

/// Where frames lie in one another.
struct TFMessage {
  static constexpr const char* ros_type = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"transforms", "", "Transforms between frames."}, s.transforms);
  }
};

/// Why a transform could not be had.
struct TF2Error {
  static constexpr const char* ros_type = "tf2_msgs/msg/TF2Error";
  std::uint8_t error = 0;
  std::string error_string;
  static void constants(auto&& visit) {
    visit("NO_ERROR", std::uint8_t{0});
    visit("LOOKUP_ERROR", std::uint8_t{1});
    visit("CONNECTIVITY_ERROR", std::uint8_t{2});
    visit("EXTRAPOLATION_ERROR", std::uint8_t{3});
    visit("INVALID_ARGUMENT_ERROR", std::uint8_t{4});
    visit("TIMEOUT_ERROR", std::uint8_t{5});
    visit("TRANSFORM_ERROR", std::uint8_t{6});
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"error", "1", "Kind of the error."}, s.error);
    visit(Field{"error_string", "", "Description of the error."}, s.error_string);
  }
};

/// Simulated time.
struct Clock {
  static constexpr const char* ros_type = "rosgraph_msgs/msg/Clock";
  Time clock;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"clock", "s", "Present simulated time."}, s.clock);
  }
};

}  // namespace sandlot::msg
