#pragma once
/// Formation: drives the robots of a team to places side by side, one behind the other or in a circle, and keeps them there.
///
/// Reads      an Odometry of each robot in the frame of the world: a ground_truth, or a drive's if all begin at the origin.
/// Orders     a Twist for a drive that can turn on the spot, each robot of the team.
/// Publishes  `arrived`, std_msgs/UInt32: how many robots stand in their places with the wanted heading.
/// Method     places by creation order. line: from left to right; column: the first in front; circle: counter-clockwise from
///            the heading, neighbours `spacing` apart. A robot turns towards its place until it is within 60 degrees, then
///            drives an arc to it (pure pursuit) and slows down with the square root of the distance; within `tolerance` it
///            turns to the heading.
/// Team       robots that come or go give the others new places.
/// Limits     no obstacles, and robots do not avoid each other.
/// Cost       one arc tangent per robot and step, no allocation.
/// Errors     not a team's controller; a robot without such an odometry or drive.
#include <array>

#include "control/controller.h"

namespace sandlot::controllers::formation {

enum class Shape : std::uint8_t { line, column, circle };

inline std::span<const EnumName<Shape>> enum_names(Shape) {
  static constexpr EnumName<Shape> names[] = {
      {"line", Shape::line}, {"column", Shape::column}, {"circle", Shape::circle}};
  return names;
}

struct Spec {
  Shape shape = Shape::line;
  std::array<double, 2> centre_m{};
  double heading_rad = 0;
  double spacing_m = 1;
  std::string odometry, drive;
  double tolerance_m = 0.05;
  double speed_mps = 0.3;
  double turn_speed_radps = 1;
  double deceleration_mps2 = 0.3;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(
        Field{
            "shape", "",
            "Shape of the formation. line: side by side; column: one behind the other; circle: on a circle.",
            0, 0, tunable},
        s.shape);
    visit(Field{"centre", "m", "Middle of the formation: x y.", -1e6, 1e6}, s.centre_m);
    visit(Field{"heading", "rad", "Heading of the robots in their places.", -1e4, 1e4, tunable},
          s.heading_rad);
    visit(Field{"spacing", "m", "Distance between neighbours.", 1e-3, 1e4, tunable}, s.spacing_m);
    visit(
        Field{"odometry", "", "Odometry of each robot to use; empty: the only one.", 0, 0, Field::none, 1000},
        s.odometry);
    visit(Field{"drive", "", "Drive of each robot to use; empty: the only one.", 0, 0, Field::none, 1000},
          s.drive);
    visit(Field{"tolerance", "m", "Distance at which a place counts as reached.", 1e-3, 100, tunable},
          s.tolerance_m);
    visit(Field{"speed", "m/s", "Speed on straight parts.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"deceleration", "m/s^2", "Braking before the place.", 0.01, 100, tunable},
          s.deceleration_mps2);
  }
};

struct Formation {
  using Spec = formation::Spec;
  using State = NoFields;
  Spec spec;
  State state;

  struct Member {
    Reading<msg::Odometry> odometry;
    Actuator<msg::Twist> drive;
  };
  std::vector<Member> members;
  Publication<msg::UInt32> arrived;

  Status init(const Description& team, Outputs& out);
  void step(const Observation& obs, Command& cmd);

  /// Place of robot i of n, in the world.
  std::array<double, 2> place(std::size_t i, std::size_t n) const;
  /// Order for a robot at X_WB with this place. @param there  set when it stands in its place with the heading
  msg::Twist order(const Pose& X_WB, std::array<double, 2> place_m, bool& there) const;
};

}  // namespace sandlot::controllers::formation
