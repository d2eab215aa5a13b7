#pragma once
/// Sequence: orders at set times: step responses, demonstrations, robots that play a part.
///
/// Reads    nothing.
/// Orders   to the devices it names: a number is a Float64 (joint motors: angle, speed or effort by their level), a list
///          [forward, left, turn] a Twist in m/s and rad/s for a drive. Lists may be shorter; the rest is 0. The words true
///          and false are a Bool (grippers); for a device that takes a String, any text is one (voice); for one
///          that takes a RadioPacket, a text is a packet for all and {to: name, data: text} one for a robot or a team. For a
///          heading drive a list is [speed, heading]. A map is a piece of way for a drive (sandlot_msgs/DriveManeuver):
///          {maneuver: curve, distance: 1 m, angle: 90 deg, speed: 0.2}.
/// Time     an order is given in the first control step not before its time. With `repeat` the list begins again every
///          so many seconds, counted from the start; orders at or after the end of a round are never given.
/// Limits   open loop: it does not look whether anything came of it.
/// Cost     nothing between orders.
/// Errors   a device that is not there or takes neither message; times that run backwards.
#include <array>
#include <variant>

#include "control/controller.h"

namespace sandlot::controllers::sequence {

struct Step {
  double at_s = 0;
  Node orders;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"at", "s", "Time of the commands, from the start of a round.", 0, 1e9, Field::required},
          s.at_s);
    visit(Field{"orders", "",
                "Map of commands: device -> number, true, false, text, [forward, left, turn] or {maneuver: "
                "turn, ...}.",
                0, 0, Field::required},
          s.orders);
  }
};

struct Spec {
  Node steps;  ///< list of Steps
  double repeat_s = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"steps", "", "Commands in order of time: a list of {at, orders}.", 0, 0, Field::required},
          s.steps);
    visit(Field{"repeat", "s", "Length of a round; 0: one round only.", 0, 1e9}, s.repeat_s);
  }
};

struct State {
  std::uint32_t next = 0;   ///< index of the order to give next in this round
  std::uint64_t round = 0;  ///< rounds completed

  static void fields(auto& s, auto&& visit) {
    visit(Field{"next", "1", "Index of the next command."}, s.next);
    visit(Field{"round", "1", "Number of completed rounds."}, s.round);
  }
};

struct Sequence {
  using Spec = sequence::Spec;
  using State = sequence::State;
  Spec spec;
  State state;

  struct Number {
    Actuator<msg::Float64> to;
    msg::Float64 value;
  };
  struct Switch {
    Actuator<msg::Bool> to;
    msg::Bool value;
  };
  struct Words {
    Actuator<msg::String> to;
    msg::String value;
  };
  struct Packet {
    Actuator<msg::RadioPacket> to;
    msg::RadioPacket value;
  };
  struct Motion {
    Actuator<msg::Twist> to;
    msg::Twist value;
  };
  struct Course {
    Actuator<msg::SpeedHeading> to;
    msg::SpeedHeading value;
  };
  struct Way {
    Actuator<msg::DriveManeuver> to;
    msg::DriveManeuver value;
  };
  struct Order {
    double at_s;
    std::variant<Number, Switch, Words, Packet, Motion, Course, Way> what;
  };
  std::vector<Order> orders;

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);
};

}  // namespace sandlot::controllers::sequence
