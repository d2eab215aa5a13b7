#pragma once
/// Footballer: plays for a team; the nearest to the ball attacks, the others cover their goal.
///
/// Reads    an ObjectPoseArray in the frame of the world, in which the robot finds itself by its name, its team by its own label and
///          the ball by its label (overhead_camera).
///          With `kicker`, the KickerState of that device.
/// Orders   a Twist for a drive that can turn on the spot; with `kicker`, a Float64: the impulse of a kick [N s].
/// Method   roles    each compares its distance to the place behind the ball with those of its team-mates; the shortest attacks.
///          aim      of five points across the mouth of the goal the one whose straight way from the ball has the most room beside
///                   opponents, up to 0.3 m; between equals the one nearer to the middle.
///          attack   goes around to the place behind the ball, as seen from the aim, and drives through the ball towards the aim. A
///                   ball whose back cannot be reached, for a wall, is hit from where the robot is.
///          kick     when the kicker is ready, the ball lies in front, and the straight line from the ball along the heading
///                   crosses the mouth of the goal. A ball whose back cannot be reached is kicked away from the wall in any
///                   direction that is more than 60 degrees off the own goal.
///          cover    stands on the line between the ball and the own goal.
/// Limits   no passes; no rules of fair play; the field is a rectangle about the origin, and the mouth of the goal is at right angles
///          to the line between both goals. The aim takes opponents where they are now and the ball as at rest.
/// Cost     the number of players, no allocation once its list has grown.
/// Errors   no camera, drive or kicker of these names.
#include <array>

#include "control/controller.h"
#include "control/steering.h"

namespace sandlot::controllers::footballer {

struct Spec {
  std::string camera, drive, kicker;
  std::string ball = "ball";
  std::array<double, 2> goal_m{3, 0}, own_goal_m{-3, 0};
  std::array<double, 2> field_m{6, 4};
  double speed_mps = 0.6;
  double turn_speed_radps = 4;
  double behind_m = 0.3;
  double goal_width_m = 1;
  double kick_reach_m = 0.25;
  double impulse_Ns = 0.6;
  double cover = 0.35;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"camera", "", "Camera above the field to use; empty: the only one.", 0, 0, Field::none, 1000},
          s.camera);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"kicker", "", "Kicker to use; empty: none, the ball is pushed.", 0, 0, Field::none, 1000},
          s.kicker);
    visit(Field{"ball", "", "Label of the ball.", 0, 0, Field::none, 100}, s.ball);
    visit(Field{"goal", "m", "Middle of the goal to score in: x y.", -1e6, 1e6}, s.goal_m);
    visit(Field{"own_goal", "m", "Middle of the own goal: x y.", -1e6, 1e6}, s.own_goal_m);
    visit(
        Field{"field", "m", "Size of the field about the origin along x and y, between its walls.", 0.1, 1e6},
        s.field_m);
    visit(Field{"speed", "m/s", "Driving speed.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"behind", "m", "Distance of the place behind the ball from the ball.", 0.01, 100, tunable},
          s.behind_m);
    visit(Field{"goal_width", "m", "Width of the mouth of the goal to score in.", 0.01, 1e6, tunable},
          s.goal_width_m);
    visit(Field{"kick_reach", "m", "Largest distance of the ball's middle, ahead, for a kick.", 0, 100,
                tunable},
          s.kick_reach_m);
    visit(Field{"impulse", "N s", "Impulse of a kick.", 0, 1000, tunable}, s.impulse_Ns);
    visit(Field{"cover", "1", "Place of a covering robot between the own goal (0) and the ball (1).", 0, 1,
                tunable},
          s.cover);
  }
};

struct State {
  bool attacks = false;
  std::uint32_t kicks = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"attacks", "", "Whether it attacks."}, s.attacks);
    visit(Field{"kicks", "1", "Kicks ordered so far."}, s.kicks);
  }
};

struct Footballer {
  using Spec = footballer::Spec;
  using State = footballer::State;
  Spec spec;
  State state;

  std::string name;
  Reading<msg::ObjectPoseArray> camera;
  Actuator<msg::Twist> drive;
  Actuator<msg::Float64> kicker;
  Reading<msg::KickerState> kicker_state;
  std::vector<steering::Disc> discs;  ///< scratch

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);

  /// Whether no team-mate is nearer to the place.
  bool nearest(const msg::ObjectPoseArray& world, const msg::ObjectPose& self, Vec3 place) const;
  /// The point of the goal to play the ball to.
  Vec3 aim(const msg::ObjectPoseArray& world, const msg::ObjectPose& self, Vec3 ball) const;
  /// Whether a ball that moves straight along a heading crosses the mouth of the goal.
  bool scores(Vec3 ball, double heading_rad) const;

 private:
  steering::Limits limits() const { return {spec.speed_mps, spec.turn_speed_radps}; }
  Vec3 way(const msg::ObjectPoseArray& world, const Pose& X_WB, Vec3 to);
  /// Unit vector along the mouth of the goal, to the left of who plays towards it.
  Vec3 mouth() const;
  /// Whether to kick now.
  bool kicks(const Observation& obs, const Pose& X_WB, Vec3 ball, Vec3 behind) const;
  /// Whether a place is too near to a wall for a robot.
  bool blocked(Vec3 place) const;
  msg::Twist attack(const msg::ObjectPoseArray& world, const Pose& X_WB, Vec3 ball, Vec3 target, Vec3 behind);
  msg::Twist cover(const msg::ObjectPoseArray& world, const Pose& X_WB, Vec3 ball);
};

extern const ControllerKind kind;

}  // namespace sandlot::controllers::footballer
