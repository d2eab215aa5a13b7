#pragma once
/// Keys of a player.
#include <array>
#include <string>

#include "base/fields.h"
#include "perception/finder.h"
#include "soccer/field.h"

namespace sandlot::controllers::soccer_player {

enum class Play : std::uint8_t { run_and_kick, passing, dribbling, pressing };
inline std::span<const EnumName<Play>> enum_names(Play) {
  static constexpr EnumName<Play> names[] = {{"run_and_kick", Play::run_and_kick},
                                             {"passing", Play::passing},
                                             {"dribbling", Play::dribbling},
                                             {"pressing", Play::pressing}};
  return names;
}

/// Ball and robots of the league in pictures: an orange ball, shells of cyan and magenta whose lower edge is 0.19 m high.
inline perception::FinderSpec usual_vision() {
  perception::FinderSpec vision;
  for (const double hue_rad : {3.35, 5.69}) {
    perception::Target robot;
    robot.label = "robot";
    robot.form = perception::Form::standing;
    robot.colour.hue_rad = hue_rad;
    robot.size_m = 0.44;
    robot.foot_m = 0.19;
    robot.depth_m = 0.22;
    vision.targets.push_back(robot);
  }
  return vision;
}

struct Keys {
  std::string drive = "drive", eye = "eye", laser = "laser", compass = "compass", kicker = "kicker",
              chip = "chip", handler = "handler", radio = "radio", referee = "referee", battery = "battery";
  Play play = Play::passing;
  int number = 0, keeper = 1;
  std::string team;
  soccer::FieldSize size = soccer::FieldSize::m22x14;
  bool attacks_positive_x = true, holonomic = true, obeys = true;
  std::array<double, 3> start{0, 0, 0};
  bool placed = false;
  double speed_mps = 2.8, turn_speed_radps = 5, acceleration_mps2 = 2.2;
  double shot_speed_mps = 11, pass_speed_mps = 3.2, shot_range_m = 10;
  double kick_reach_m = 0.42, kick_width_m = 0.11, front_m = 0.335;
  double radio_rate_hz = 10, report_rate_hz = 10;
  perception::FinderSpec vision = usual_vision();

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    constexpr std::size_t most = 1000;
    visit(Field{"drive", "", "Drive to use.", 0, 0, Field::none, most}, s.drive);
    visit(Field{"eye", "", "Camera to use, at any of its levels.", 0, 0, Field::none, most}, s.eye);
    visit(Field{"laser", "", "Laser scanner to use, at any of its levels.", 0, 0, Field::none, most},
          s.laser);
    visit(Field{"compass", "", "Compass to use: a magnetometer at level heading.", 0, 0, Field::none, most},
          s.compass);
    visit(Field{"kicker", "", "Kicker to use.", 0, 0, Field::none, most}, s.kicker);
    visit(Field{"chip", "", "Kicker that lobs to use.", 0, 0, Field::none, most}, s.chip);
    visit(Field{"handler", "", "Ball handler to use.", 0, 0, Field::none, most}, s.handler);
    visit(Field{"radio", "", "Radio to use.", 0, 0, Field::none, most}, s.radio);
    visit(Field{"referee", "", "Link to the referee to use.", 0, 0, Field::none, most}, s.referee);
    visit(Field{"battery", "", "Battery to use.", 0, 0, Field::none, most}, s.battery);
    visit(Field{"play", "", "Way of playing."}, s.play);
    visit(Field{"number", "1", "Number in the team; 0: the digits at the end of the robot's name.", 0, 99},
          s.number);
    visit(Field{"keeper", "1", "Number of the goalkeeper; 0: none.", 0, 99}, s.keeper);
    visit(Field{"team", "", "Name of the team; empty: the robot's name without the digits at its end.", 0, 0,
                Field::none, 100},
          s.team);
    visit(Field{"size", "", "Size of the field."}, s.size);
    visit(Field{"attacks_positive_x", "",
                "Whether the team plays towards positive x until the referee says otherwise."},
          s.attacks_positive_x);
    visit(Field{"holonomic", "", "Whether the drive moves sideways."}, s.holonomic);
    visit(Field{"obeys", "", "Whether it obeys the referee, where there is one.", 0, 1, tunable}, s.obeys);
    visit(Field{"start", "", "Place and heading in which it begins: x and y in m, yaw in rad.", -1e3, 1e3},
          s.start);
    visit(Field{"placed", "", "Whether `start` is given; false: it finds its place by what it sees."},
          s.placed);
    visit(Field{"speed", "m/s", "Largest speed.", 0.01, 20, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 50, tunable}, s.turn_speed_radps);
    visit(Field{"acceleration", "m/s^2", "Deceleration that it counts on.", 0.05, 50, tunable},
          s.acceleration_mps2);
    visit(Field{"shot_speed", "m/s", "Speed of the ball in a shot at the goal.", 0.1, 20, tunable},
          s.shot_speed_mps);
    visit(Field{"pass_speed", "m/s", "Speed of the ball in the shortest pass.", 0.1, 20, tunable},
          s.pass_speed_mps);
    visit(Field{"shot_range", "m", "Distance from the goal within which it shoots.", 0, 100, tunable},
          s.shot_range_m);
    visit(
        Field{"kick_reach", "m", "Largest distance of the ball's middle, ahead, for a kick.", 0, 10, tunable},
        s.kick_reach_m);
    visit(Field{"kick_width", "m", "Largest distance of the ball's middle to the side for a kick.", 0, 10,
                tunable},
          s.kick_width_m);
    visit(Field{"front", "m", "Distance of the ball's middle when it touches the robot's front.", 0, 10,
                tunable},
          s.front_m);
    visit(Field{"radio_rate", "Hz", "Packets per second.", 0.1, 100, tunable}, s.radio_rate_hz);
    visit(Field{"report_rate", "Hz", "Messages of its state per second.", 0.1, 1000, tunable},
          s.report_rate_hz);
    visit(Field{"vision", "", "Colours and sizes to find in pictures."}, s.vision);
  }
};

/// What the ways of playing differ in.
struct Style {
  /// Factors on the worth of passes, of carrying the ball and of pushing it on.
  double passes, carries, pushes;
  bool offers;   ///< the supporter seeks a place that a pass reaches; else it has a fixed one beside the ball
  double line;   ///< depth of the defence: 0 at the goal, 1 at the ball
  int pressers;  ///< players that go for a ball of the opponents beside the attacker
  bool places;   ///< whether those without the ball take places
};
constexpr Style style_of(Play play) {
  switch (play) {
    case Play::passing: return {1.3, 1, 0.7, true, 0.45, 0, true};
    case Play::dribbling: return {0.7, 1.2, 1.3, false, 0.45, 0, true};
    case Play::pressing: return {1, 1, 1, false, 0.55, 1, true};
    case Play::run_and_kick: break;
  }
  return {0, 0, 0, false, 0.3, 0, false};
}

}  // namespace sandlot::controllers::soccer_player
