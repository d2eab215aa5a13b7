#pragma once
/// sandlot_msgs of drives: a piece of way at a time, as RoBIOS has it.
#include <cstdint>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// Piece of way that a drive covers by itself; another one, or a speed, ends it at once.
struct DriveManeuver {
  static constexpr const char* ros_type = "sandlot_msgs/msg/DriveManeuver";
  static constexpr std::uint8_t straight = 0, turn = 1, curve = 2, to_point = 3, stop = 4;
  static void constants(auto&& visit) {
    visit("STRAIGHT", straight);
    visit("TURN", turn);
    visit("CURVE", curve);
    visit("TO_POINT", to_point);
    visit("STOP", stop);
  }
  std::uint8_t kind = straight;
  double distance = 0;
  double angle = 0;
  double x = 0;
  double y = 0;
  double speed = 0;
  double turning_rate = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"kind", "", "STRAIGHT, TURN on the spot, CURVE, TO_POINT or STOP."}, s.kind);
    visit(Field{"distance", "m", "Length of the way; negative: backwards. STRAIGHT and CURVE."}, s.distance);
    visit(Field{"angle", "rad", "Change of heading, counter-clockwise. TURN and CURVE."}, s.angle);
    visit(Field{"x", "m", "Goal, forward from where the robot is now. TO_POINT."}, s.x);
    visit(Field{"y", "m", "Goal, to the left from where the robot is now. TO_POINT."}, s.y);
    visit(Field{"speed", "m/s", "Speed along the way; 0: the drive's largest."}, s.speed);
    visit(Field{"turning_rate", "rad/s", "Turning rate of TURN; 0: the drive's largest."}, s.turning_rate);
  }
};

/// Progress of a drive on its piece of way.
struct DriveProgress {
  static constexpr const char* ros_type = "sandlot_msgs/msg/DriveProgress";
  Header header;
  std::uint64_t maneuvers = 0;
  std::uint8_t kind = DriveManeuver::stop;
  bool done = true;
  double remaining_distance = 0;
  double remaining_angle = 0;
  std::vector<std::uint32_t> stalled;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"maneuvers", "1", "Number of pieces of way begun so far."}, s.maneuvers);
    visit(Field{"kind", "", "Kind of the latest one, a constant of DriveManeuver."}, s.kind);
    visit(Field{"done", "", "Whether it is covered or was ended; true while the drive keeps a speed."},
          s.done);
    visit(Field{"remaining_distance", "m", "Way left; negative: backwards."}, s.remaining_distance);
    visit(Field{"remaining_angle", "rad", "Change of heading left, counter-clockwise."}, s.remaining_angle);
    visit(Field{"stalled", "1",
                "Numbers of the motors that are driven and do not turn, from 1, in the order of the wheels."},
          s.stalled);
  }
};

}  // namespace sandlot::msg
