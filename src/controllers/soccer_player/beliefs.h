#pragma once
/// What a player believes: itself, the ball, team-mates that it heard, robots that it sees, and how the game stands.
///
/// Frame    F, that of the field: origin in the middle, x along the field (soccer/field.h). z is 0.
/// Time     seconds of the run; an age is the difference to now.
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/fields.h"
#include "geometry/vec3.h"

namespace sandlot::controllers::soccer_player {

inline constexpr std::size_t most_mates = 11, most_obstacles = 16;
inline constexpr double ball_radius_m = 0.11, ball_mass_kg = 0.43, robot_radius_m = 0.26;

inline Vec3 flat(Vec3 v) { return {v.x, v.y, 0}; }
/// From the frame that is turned by the heading with this sine and cosine into the one it is turned in.
constexpr Vec3 turned(Vec3 v, double sin, double cos) {
  return {cos * v.x - sin * v.y, sin * v.x + cos * v.y, 0};
}

enum class Role : std::uint8_t { keeper, attacker, supporter, defender, sweeper, none };
inline std::span<const EnumName<Role>> enum_names(Role) {
  static constexpr EnumName<Role> names[] = {{"goalkeeper", Role::keeper},   {"attacker", Role::attacker},
                                             {"supporter", Role::supporter}, {"defender", Role::defender},
                                             {"sweeper", Role::sweeper},     {"none", Role::none}};
  return names;
}

struct Self {
  Vec3 at;  ///< [m]
  double yaw_rad = 0;
  Vec3 velocity;  ///< [m/s] in F
  double rate_radps = 0;
  double var_xx = 0, var_xy = 0, var_yy = 0, var_yaw = 0;
  double odometry_x_m = 0, odometry_y_m = 0, odometry_yaw_rad = 0;
  std::uint32_t refused = 0;
  bool known = false, yaw_known = false, moved = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"at", "m", "Believed place on the field."}, s.at);
    visit(Field{"yaw", "rad", "Believed heading."}, s.yaw_rad);
    visit(Field{"velocity", "m/s", "Velocity in the field."}, s.velocity);
    visit(Field{"rate", "rad/s", "Turning rate."}, s.rate_radps);
    visit(Field{"var_xx", "m^2", "Variance of the place along x."}, s.var_xx);
    visit(Field{"var_xy", "m^2", "Covariance of the place along x and y."}, s.var_xy);
    visit(Field{"var_yy", "m^2", "Variance of the place along y."}, s.var_yy);
    visit(Field{"var_yaw", "rad^2", "Variance of the heading."}, s.var_yaw);
    visit(Field{"odometry_x", "m", "Position along x in the last odometry."}, s.odometry_x_m);
    visit(Field{"odometry_y", "m", "Position along y in the last odometry."}, s.odometry_y_m);
    visit(Field{"odometry_yaw", "rad", "Heading in the last odometry."}, s.odometry_yaw_rad);
    visit(Field{"refused", "1", "Fixes in a row that were too far off to be believed."}, s.refused);
    visit(Field{"known", "", "Whether the place is known."}, s.known);
    visit(Field{"yaw_known", "", "Whether the heading is known."}, s.yaw_known);
    visit(Field{"moved", "", "Whether an odometry has come."}, s.moved);
  }
};

struct Ball {
  Vec3 at, velocity;  ///< [m], [m/s]
  double var_p = 0, cov_pv = 0, var_v = 0;
  double seen_s = -1e9;
  std::uint32_t refused = 0;
  bool known = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"at", "m", "Believed place of the ball."}, s.at);
    visit(Field{"velocity", "m/s", "Believed velocity of the ball."}, s.velocity);
    visit(Field{"var_p", "m^2", "Variance of the place along each axis."}, s.var_p);
    visit(Field{"cov_pv", "m^2/s", "Covariance of place and velocity along each axis."}, s.cov_pv);
    visit(Field{"var_v", "m^2/s^2", "Variance of the velocity along each axis."}, s.var_v);
    visit(Field{"seen", "s", "Time when it was seen last."}, s.seen_s);
    visit(Field{"refused", "1", "Sightings in a row that were too far off to be believed."}, s.refused);
    visit(Field{"known", "", "Whether it has been seen."}, s.known);
  }
};

/// A team-mate as its latest packet said.
struct Mate {
  std::int32_t number = 0;
  Role role = Role::none;
  Vec3 at, velocity, target, ball, ball_velocity;
  double ball_std_m = 0, ball_seen_s = -1e9;
  double cost_s = 1e9;
  double heard_s = -1e9;
  bool holds = false, ball_known = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"number", "1", "Number in the team."}, s.number);
    visit(Field{"role", "", "Role that it told."}, s.role);
    visit(Field{"at", "m", "Place that it told."}, s.at);
    visit(Field{"velocity", "m/s", "Velocity that it told."}, s.velocity);
    visit(Field{"target", "m", "Place that it goes to."}, s.target);
    visit(Field{"ball", "m", "Place of the ball that it told."}, s.ball);
    visit(Field{"ball_velocity", "m/s", "Velocity of the ball that it told."}, s.ball_velocity);
    visit(Field{"ball_std", "m", "Standard deviation of the ball's place."}, s.ball_std_m);
    visit(Field{"ball_seen", "s", "Time when it saw the ball last."}, s.ball_seen_s);
    visit(Field{"cost", "s", "Time that it takes to get the ball."}, s.cost_s);
    visit(Field{"heard", "s", "Time when it was heard last."}, s.heard_s);
    visit(Field{"holds", "", "Whether it holds the ball."}, s.holds);
    visit(Field{"ball_known", "", "Whether it knows where the ball is."}, s.ball_known);
  }
};

/// A robot that was seen, of either team.
struct Obstacle {
  Vec3 at, velocity;
  double var_p = 0.01, cov_pv = 0, var_v = 1;
  double seen_s = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"at", "m", "Place of the robot."}, s.at);
    visit(Field{"velocity", "m/s", "Velocity of the robot."}, s.velocity);
    visit(Field{"var_p", "m^2", "Variance of the place along each axis."}, s.var_p);
    visit(Field{"cov_pv", "m^2/s", "Covariance of place and velocity along each axis."}, s.cov_pv);
    visit(Field{"var_v", "m^2/s^2", "Variance of the velocity along each axis."}, s.var_v);
    visit(Field{"seen", "s", "Time when it was seen last."}, s.seen_s);
  }
};

enum class Phase : std::uint8_t { stopped, preparing, running };
inline std::span<const EnumName<Phase>> enum_names(Phase) {
  static constexpr EnumName<Phase> names[] = {
      {"stopped", Phase::stopped}, {"preparing", Phase::preparing}, {"running", Phase::running}};
  return names;
}
enum class Piece : std::uint8_t {
  none,
  kickoff,
  throw_in,
  corner,
  goal_kick,
  free_kick,
  penalty,
  dropped_ball
};
inline std::span<const EnumName<Piece>> enum_names(Piece) {
  static constexpr EnumName<Piece> names[] = {
      {"none", Piece::none},       {"kickoff", Piece::kickoff},          {"throw_in", Piece::throw_in},
      {"corner", Piece::corner},   {"goal_kick", Piece::goal_kick},      {"free_kick", Piece::free_kick},
      {"penalty", Piece::penalty}, {"dropped_ball", Piece::dropped_ball}};
  return names;
}
enum class Whose : std::uint8_t { nobodys, ours, theirs };
inline std::span<const EnumName<Whose>> enum_names(Whose) {
  static constexpr EnumName<Whose> names[] = {
      {"nobodys", Whose::nobodys}, {"ours", Whose::ours}, {"theirs", Whose::theirs}};
  return names;
}

/// How the game stands, from the referee's words. Without a referee it runs all the time.
struct Game {
  Phase phase = Phase::running;
  Piece piece = Piece::none;
  Whose whose = Whose::nobodys;
  double since_s = 0;
  std::uint64_t sequence = 0;
  Vec3 spot;
  bool positive = true, out = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"phase", "", "Phase of the game."}, s.phase);
    visit(Field{"piece", "", "Set piece that is prepared or taken."}, s.piece);
    visit(Field{"whose", "", "Team that takes the set piece."}, s.whose);
    visit(Field{"since", "s", "Time since when phase and set piece are what they are."}, s.since_s);
    visit(Field{"sequence", "1", "Number of the latest command that was heard."}, s.sequence);
    visit(Field{"spot", "m", "Place of the ball when play was allowed to go on."}, s.spot);
    visit(Field{"positive", "", "Whether the team plays towards positive x."}, s.positive);
    visit(Field{"out", "", "Whether the robot has to stay out of the game."}, s.out);
  }
};

}  // namespace sandlot::controllers::soccer_player
