#pragma once
/// Soccer player: the software of one robot of a team in the Middle Size League, the same at every level of its sensors.
///
/// Reads    drive: Odometry. eye: Image with CameraInfo, ObjectArray or ObjectPoseArray, whichever is active: ball, robots, goals
///          (labels `ball`, `robot`, and those that begin with `goal`). laser: LaserScan or LineSegmentArray for robots near by,
///          PoseWithCovarianceStamped for its own place. compass: Float64, the heading. kicker: KickerState. handler:
///          BallHandlerState. radio: packets of team-mates. referee: RefereeState, RefereeCommand. battery: BatteryState.
/// Orders   a Twist; kicks [N s]; the handler on or off; packets to the team.
/// Output   sandlot_msgs/PlayerState on its topic `state`, at `report_rate`.
/// Needs    the drive. Devices that the robot lacks are done without: no referee, it plays always; no handler, it pushes; no
///          radio, each plays for itself. A device that is named other than by default must be there.
/// Parts    localisation.h, tracking.h, packet.h, game.h, roles.h, play.h, motion.h.
/// Limits   one ball, on the ground; opponents are robots that are no team-mates that were heard. No passes by lobs.
/// Cost     a few microseconds per step, in pictures that of perception/finder.h; no allocation once lists have grown.
/// Errors   no drive; a device of that name is not there; `start` without numbers.
#include <optional>

#include "control/controller.h"
#include "controllers/soccer_player/play.h"
#include "messages/line_segments.h"
#include "perception/finder.h"

namespace sandlot::controllers::soccer_player {

struct State {
  Self self;
  Ball ball;
  std::vector<Mate> mates;
  std::vector<Obstacle> robots;
  Game game;
  Memory memory;
  double stepped_s = 0, sent_s = -1e9, reported_s = -1e9, matched_s = -1e9;
  double cost_s = 50;
  Vec3 ordered_mps;  ///< velocity in F
  double ordered_radps = 0;
  bool begun = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"self", "", "Believed motion of the robot."}, s.self);
    visit(Field{"ball", "", "Believed motion of the ball."}, s.ball);
    visit(Field{"mates", "", "Team-mates that were heard."}, s.mates);
    visit(Field{"robots", "", "Robots that were seen."}, s.robots);
    visit(Field{"game", "", "State of the game."}, s.game);
    visit(Field{"memory", "", "Decisions that are kept."}, s.memory);
    visit(Field{"stepped", "s", "Time of the latest step."}, s.stepped_s);
    visit(Field{"sent", "s", "Time of the latest packet."}, s.sent_s);
    visit(Field{"matched", "s", "Time when a scan was held against the goals last."}, s.matched_s);
    visit(Field{"reported", "s", "Time of the latest report."}, s.reported_s);
    visit(Field{"cost", "s", "Time that it takes to get the ball."}, s.cost_s);
    visit(Field{"ordered", "m/s", "Velocity in the field that was ordered."}, s.ordered_mps);
    visit(Field{"ordered_rate", "rad/s", "Turning rate that was ordered."}, s.ordered_radps);
    visit(Field{"begun", "", "Whether it has made a step."}, s.begun);
  }
};

struct SoccerPlayer {
  using Spec = Keys;
  using State = soccer_player::State;
  Spec spec;
  State state;

  Status init(const Description& robot, Outputs& out);
  void step(const Observation& obs, Command& cmd);
  bool fits() const;

 private:
  Status find_devices(const Description& robot, Outputs& out);
  void sense_self(const Observation& obs);
  void see_objects(const Observation& obs);
  void see_picture(const Observation& obs);
  void scan(const Observation& obs);
  void match_goals(const msg::LaserScan& scan);
  void see(std::string_view label, Vec3 at_B, double range_m);
  void see_other(Vec3 at_F, double std_m);
  void hear(const Observation& obs);
  void follow_game(const Observation& obs);
  void fill_scene(const Observation& obs);
  bool is_free_again() const;
  Vec3 gentle(Vec3 velocity) const;
  void act(const Observation& obs, const Task& task, Command& cmd);
  void kick(const Observation& obs, Command& cmd);
  void tell(const Task& task, Vec3 target, Command& cmd);
  void report(const Observation& obs, const Task& task, const Intent& intent, Command& cmd);
  Vec3 to_field(Vec3 at_B) const;
  /// Between F and A, both ways.
  Vec3 flip(Vec3 v) const { return state.game.positive ? v : -v; }

  std::string team_;
  std::int32_t number_ = 0;
  soccer::Dimensions field_;
  Style style_{};
  Actuator<msg::Twist> drive_;
  std::optional<Reading<msg::Odometry>> odometry_;
  std::optional<Reading<msg::Image>> image_;
  std::optional<Reading<msg::CameraInfo>> info_;
  std::optional<Reading<msg::ObjectArray>> objects_;
  std::optional<Reading<msg::ObjectPoseArray>> poses_;
  std::optional<Reading<msg::LaserScan>> ranges_;
  std::optional<Reading<msg::LineSegmentArray>> segments_;
  std::optional<Reading<msg::PoseWithCovarianceStamped>> pose_;
  std::optional<Reading<msg::Float64>> compass_;
  std::optional<Reading<msg::KickerState>> kicker_state_;
  std::optional<Reading<msg::BallHandlerState>> handler_state_;
  std::optional<Reading<msg::RadioReceptionArray>> packets_;
  std::optional<Reading<msg::RefereeState>> referee_;
  std::optional<Reading<msg::RefereeCommand>> words_;
  std::optional<Reading<msg::BatteryState>> battery_;
  std::optional<Actuator<msg::Float64>> kicker_, handler_;
  std::optional<Actuator<msg::RadioPacket>> radio_;
  std::optional<Publication<msg::PlayerState>> report_;
  Pose X_BE_, X_BL_;  ///< eye and laser on the robot

  // Scratch of a step, and what follows from the specification and the camera.
  double now_s_ = 0;
  double dt_s_ = 0, sin_ = 0, cos_ = 1;
  bool holds_ = false;
  Scene scene_;
  std::vector<Moving> discs_;
  perception::Finder finder_;
  msg::CameraInfo known_;
  std::vector<perception::Found> found_;
  msg::RadioPacket packet_;
  msg::PlayerState out_;
};

extern const ControllerKind kind;

}  // namespace sandlot::controllers::soccer_player
