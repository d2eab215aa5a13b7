#pragma once
/// sandlot_msgs of robot soccer: what a referee says and decides, how a game stands, what players hold and believe.
#include <cstdint>
#include <string>
#include <vector>

#include "messages/geometry_msgs.h"
#include "messages/std_msgs.h"

namespace sandlot::msg {

/// What holds the ball at a robot, and how well.
struct BallHandlerState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/BallHandlerState";
  Header header;
  bool engaged = false;
  double force = 0;
  std::uint64_t grips = 0;
  std::uint64_t losses = 0;
  std::string object;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"engaged", "", "Whether the ball is held."}, s.engaged);
    visit(Field{"force", "N", "Force on the ball in the latest tick."}, s.force);
    visit(Field{"grips", "1", "Times that a ball was taken so far."}, s.grips);
    visit(Field{"losses", "1", "Times that the ball tore off so far."}, s.losses);
    visit(Field{"object", "", "Name of the object that is held; empty: none."}, s.object);
  }
};

/// A word of the referee to the robots, as referee boxes of the league send it.
struct RefereeCommand {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RefereeCommand";
  Header header;
  std::uint64_t sequence = 0;
  std::string command;
  std::string team;
  std::int32_t robot = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"sequence", "1", "Number of the command in the game, from 1."}, s.sequence);
    visit(Field{"command", "", "Word of the league's referee box, such as KICKOFF."}, s.command);
    visit(Field{"team", "", "Team that it is for; empty: both."}, s.team);
    visit(Field{"robot", "1", "Number of the robot in its team that it is for; 0: none."}, s.robot);
  }
};

/// A team in a game.
struct RefereeTeam {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RefereeTeam";
  std::string name;
  std::string title;
  std::uint32_t score = 0;
  std::uint32_t robots = 0;
  std::uint32_t yellow_cards = 0;
  std::uint32_t red_cards = 0;
  bool attacks_positive_x = false;
  double possession = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the team in the scenario, such as cyan."}, s.name);
    visit(Field{"title", "", "Name of the team's software."}, s.title);
    visit(Field{"score", "1", "Number of goals scored."}, s.score);
    visit(Field{"robots", "1", "Robots that take part at present."}, s.robots);
    visit(Field{"yellow_cards", "1", "Yellow cards so far."}, s.yellow_cards);
    visit(Field{"red_cards", "1", "Red cards so far."}, s.red_cards);
    visit(Field{"attacks_positive_x", "", "Whether the team plays towards positive x at present."},
          s.attacks_positive_x);
    visit(Field{"possession", "s", "Time for which the team touched the ball last while it was in play."},
          s.possession);
  }
};

/// How a game stands.
struct RefereeState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RefereeState";
  Header header;
  std::string stage;
  std::string phase;
  std::string set_piece;
  std::string team;
  bool in_play = false;
  double clock = 0;
  double remaining = 0;
  std::vector<RefereeTeam> teams;
  std::string last_touch;
  std::uint64_t commands = 0;
  std::uint64_t decisions = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"stage", "", "Part of the game, such as first_half."}, s.stage);
    visit(Field{"phase", "", "What goes on: stopped, preparing or running."}, s.phase);
    visit(Field{"set_piece", "", "Set piece that is prepared or taken; empty: none."}, s.set_piece);
    visit(Field{"team", "", "Team that takes the set piece; empty: none."}, s.team);
    visit(Field{"in_play", "", "Whether the ball is in play."}, s.in_play);
    visit(Field{"clock", "s", "Time played of this part."}, s.clock);
    visit(Field{"remaining", "s", "Time left of this part."}, s.remaining);
    visit(Field{"teams", "", "Teams, first the one that begins at negative x."}, s.teams);
    visit(Field{"last_touch", "", "Robot that touched the ball last; empty: none."}, s.last_touch);
    visit(Field{"commands", "1", "Commands given so far."}, s.commands);
    visit(Field{"decisions", "1", "Decisions made so far."}, s.decisions);
  }
};

/// A robot as a referee saw it when a decision was made.
struct RefereePlayer {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RefereePlayer";
  std::string name;
  std::string team;
  std::int32_t number = 0;
  double x = 0;
  double y = 0;
  double yaw = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the robot."}, s.name);
    visit(Field{"team", "", "Team of the robot."}, s.team);
    visit(Field{"number", "1", "Number of the robot in its team."}, s.number);
    visit(Field{"x", "m", "Place of the robot along the field."}, s.x);
    visit(Field{"y", "m", "Place of the robot across the field."}, s.y);
    visit(Field{"yaw", "rad", "Heading of the robot, counter-clockwise from x."}, s.yaw);
  }
};

/// A decision of a referee: the rule, the reason, and the scene in which it was made.
struct RefereeDecision {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RefereeDecision";
  Header header;
  std::uint64_t sequence = 0;
  std::uint64_t tick = 0;
  std::string stage;
  double clock = 0;
  std::string rule;
  std::string command;
  std::string team;
  std::string robot;
  std::string reason;
  Vec3 point;
  Vec3 ball;
  std::vector<std::uint32_t> score;
  std::vector<RefereePlayer> players;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"sequence", "1", "Number of the decision in the game, from 1."}, s.sequence);
    visit(Field{"tick", "1", "Tick after which it was made."}, s.tick);
    visit(Field{"stage", "", "Part of the game, such as first_half."}, s.stage);
    visit(Field{"clock", "s", "Time played of this part."}, s.clock);
    visit(Field{"rule", "", "Rule that was applied, such as throw_in."}, s.rule);
    visit(Field{"command", "", "Word of the referee box that follows from it; empty: none."}, s.command);
    visit(Field{"team", "", "Team in whose favour it is, or that it is about; empty: none."}, s.team);
    visit(Field{"robot", "", "Robot that it is about; empty: none."}, s.robot);
    visit(Field{"reason", "", "Reason in words."}, s.reason);
    visit(Field{"point", "m", "Where the game goes on, on the ground."}, s.point);
    visit(Field{"ball", "m", "Where the ball was."}, s.ball);
    visit(Field{"score", "1", "Goals of each team after it."}, s.score);
    visit(Field{"players", "", "Robots at that moment."}, s.players);
  }
};

/// What a player of a team believes and intends.
struct PlayerState {
  static constexpr const char* ros_type = "sandlot_msgs/msg/PlayerState";
  Header header;
  std::int32_t number = 0;
  std::string role;
  std::string intention;
  Vec3 pose;
  double pose_std = 0;
  Vec3 velocity;
  Vec3 target;
  Vec3 ball;
  Vec3 ball_velocity;
  double ball_confidence = 0;
  bool ball_engaged = false;
  std::vector<Vec3> obstacles;
  double battery = 0;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"number", "1", "Number of the robot in its team."}, s.number);
    visit(Field{"role", "", "Present role, such as goalkeeper."}, s.role);
    visit(Field{"intention", "", "What the player is doing, such as pass."}, s.intention);
    visit(Field{"pose", "", "Believed place on the field and heading: x and y in m, yaw in rad."}, s.pose);
    visit(Field{"pose_std", "m", "Standard deviation of the believed place."}, s.pose_std);
    visit(Field{"velocity", "", "Velocity in the field: x and y in m/s, yaw rate in rad/s."}, s.velocity);
    visit(Field{"target", "", "Place that it goes to, and heading there: x and y in m, yaw in rad."},
          s.target);
    visit(Field{"ball", "m", "Believed place of the ball."}, s.ball);
    visit(Field{"ball_velocity", "m/s", "Believed velocity of the ball."}, s.ball_velocity);
    visit(Field{"ball_confidence", "1", "Confidence in the ball, from 0 to 1."}, s.ball_confidence);
    visit(Field{"ball_engaged", "", "Whether the robot holds the ball."}, s.ball_engaged);
    visit(Field{"obstacles", "m", "Places of other robots that it knows of."}, s.obstacles);
    visit(Field{"battery", "1", "Charge of the battery, from 0 to 1."}, s.battery);
  }
};

}  // namespace sandlot::msg
