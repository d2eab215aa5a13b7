#pragma once
/// Diffusion: straight on until something is near, then away from it: a swarm that does this spreads like a gas.
///
/// Reads    a LaserScan with intensities: readings of proximity sensors, 0 nothing to 1 touching.
/// Orders   a Twist for a drive that can turn on the spot.
/// Method   The readings are summed as vectors along their sensors' directions and divided by their number. While the sum
///          is shorter than `threshold`, or points behind by more than a right angle, the robot drives straight on; else
///          it turns on the spot to the side away from the sum, and keeps to that side until it is free.
/// Limits   no random turns: what mixes the robots is meeting others and walls.
/// Cost     one look at each reading; a rotation per reading when any of them is not 0.
/// Source   the idea: obstacle avoidance by a vector of proximities as swarm robotics' examples use it, such as the
///          diffusion example of ARGoS (C. Pinciroli et al., Swarm Intelligence 6(4), 2012); the form here is our own.
#include "control/controller.h"

namespace sandlot::controllers::diffusion {

struct Spec {
  std::string proximity, drive;
  double speed_mps = 0.2;
  double turn_speed_radps = 2.0;
  double threshold = 0.01;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"proximity", "", "Proximity sensors to use; empty: the only ones.", 0, 0, Field::none, 1000},
          s.proximity);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"speed", "m/s", "Speed while nothing is in the way.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Turning rate of turning away.", 0.01, 100, tunable},
          s.turn_speed_radps);
    visit(Field{"threshold", "1", "Length of the vector of mean readings below which nothing is in the way.",
                0, 1, tunable},
          s.threshold);
  }
};

struct State {
  std::int8_t turning = 0;  ///< +1: to the left, -1: to the right, 0: straight on

  static void fields(auto& s, auto&& visit) {
    visit(Field{"turning", "1", "Direction of the turn: 1 to the left, -1 to the right, 0 straight on."},
          s.turning);
  }
};

struct Diffusion {
  using Spec = diffusion::Spec;
  using State = diffusion::State;
  Spec spec;
  State state;

  Reading<msg::LaserScan> proximity;
  Actuator<msg::Twist> drive;
  Quat q_BS;  ///< attitude of the ring on the robot

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);
};

}  // namespace sandlot::controllers::diffusion
