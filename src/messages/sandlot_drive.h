#pragma once
/// sandlot_msgs of drives: a piece of way at a time, as RoBIOS has it; states of chassis with steered wheels.
#include <cstdint>
#include <vector>

#include "messages/geometry_msgs.h"
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

/// Set points and measurements of a wheel that is driven and steered.
struct SteeredWheelState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/SteeredWheelState";
  double steering_target = 0;
  double steering = 0;
  double rate_target = 0;
  double rate = 0;
  double slip_angle = 0;
  double lateral_slip = 0;
  Vec3 acceleration;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"steering_target", "rad", "Set point of the steering angle."}, s.steering_target);
    visit(Field{"steering", "rad", "Measured steering angle."}, s.steering);
    visit(Field{"rate_target", "rad/s", "Set point of the wheel's rotation."}, s.rate_target);
    visit(Field{"rate", "rad/s", "Measured rotation of the wheel."}, s.rate);
    visit(
        Field{"slip_angle", "rad", "Angle between the measured motion of the wheel and the robot's x axis."},
        s.slip_angle);
    visit(Field{"lateral_slip", "rad",
                "Angle from the heading of the wheel to its measured motion; 0 for a wheel that rolls."},
          s.lateral_slip);
    visit(Field{"acceleration", "m/s^2", "Acceleration of the wheel that its set points mean, in the robot."},
          s.acceleration);
  }
};

/// State of a controller of a chassis whose wheels are each driven and steered.
struct FourWheelSteerState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/FourWheelSteerState";
  static constexpr std::uint8_t stop = 0, crab = 1, spin = 2, turn = 3;
  static constexpr std::uint8_t standing = 0, steering = 1, driving = 2, braking = 3;
  static void constants(auto&& visit) {
    visit("STOP", stop);
    visit("CRAB", crab);
    visit("SPIN", spin);
    visit("TURN", turn);
    visit("STANDING", standing);
    visit("STEERING", steering);
    visit("DRIVING", driving);
    visit("BRAKING", braking);
  }
  Header header;
  std::uint8_t mode = stop;
  std::uint8_t phase = standing;
  bool reachable = true;
  double scale = 1;
  Twist target;
  double steering_error = 0;
  bool turns = false;
  Vec3 centre;
  std::vector<SteeredWheelState> wheels;
  double residual = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"mode", "", "Mode of steering by the command: STOP, CRAB, SPIN on the spot or TURN."},
          s.mode);
    visit(Field{"phase", "", "Phase of the transition: STANDING, STEERING, DRIVING or BRAKING."}, s.phase);
    visit(
        Field{"reachable", "", "Whether the steering angles that the command needs are within their range."},
        s.reachable);
    visit(Field{"scale", "1", "Part of the command that the largest wheel speed allows."}, s.scale);
    visit(Field{"target", "", "Velocity that the wheels are set for."}, s.target);
    visit(Field{"steering_error", "rad", "Largest difference between set and measured steering angles."},
          s.steering_error);
    visit(Field{"turns", "", "Whether the target has a centre of rotation."}, s.turns);
    visit(Field{"centre", "m", "Centre of rotation in the robot, where it turns."}, s.centre);
    visit(Field{"wheels", "", "State of each wheel."}, s.wheels);
    visit(Field{"residual", "m",
                "Root mean square distance that the latest step of the odometry leaves: slip."},
          s.residual);
  }
};

}  // namespace sandlot::msg
