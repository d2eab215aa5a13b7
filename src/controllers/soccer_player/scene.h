#pragma once
/// The scene from which a player decides, and what it decides.
///
/// Frame    A: that of the field, turned so that the own goal is at negative x. All places and velocities are in A.
#include "controllers/soccer_player/beliefs.h"
#include "controllers/soccer_player/keys.h"
#include "controllers/soccer_player/motion.h"

namespace sandlot::controllers::soccer_player {

struct Scene {
  const Keys* keys = nullptr;
  soccer::Dimensions field;
  Style style{};
  double now_s = 0;
  std::int32_t number = 0;
  Vec3 me, velocity;
  double yaw_rad = 0;
  Vec3 ball, ball_velocity;  ///< as the team knows it
  bool ball_known = false, holds = false, has_handler = false;
  double side = 1;          ///< of the field, across, where there is more room: the one without the ball
  Game game;                ///< its spot is in A, too
  bool open = true;         ///< the ball may be played freely
  std::vector<Mate> mates;  ///< those heard within a second
  std::vector<Moving> opponents;

  double goal_x() const { return 0.5 * field.length_m; }
  bool is_keeper() const { return number == keys->keeper; }
};

/// Speed of a ball relative to the player at which the handler can take it: over the 65 mm between where it reaches the ball and where
/// the ball touches the body it takes away 0.95 m/s at 3 N, and from a ball that has bounced off the rest.
inline constexpr double catch_mps = 1.6;

enum class Aim : std::uint8_t { none, shot, pass, dribble, push, clearance };
inline std::span<const EnumName<Aim>> enum_names(Aim) {
  static constexpr EnumName<Aim> names[] = {{"none", Aim::none}, {"shot", Aim::shot},
                                            {"pass", Aim::pass}, {"dribble", Aim::dribble},
                                            {"push", Aim::push}, {"clearance", Aim::clearance}};
  return names;
}

/// What a player remembers of what it decided. Places are in F.
struct Memory {
  Role role = Role::none;
  Aim aim = Aim::none;
  Vec3 at, held_at;
  double until_s = -1e9, held_s = -1e9, let_s = -1e9, kicked_s = -1e9, passed_s = -1e9;
  double tolerance_rad = 0.1, speed_mps = 0;
  double side = 1;
  bool held = false, taken = false;
  std::uint64_t kicks = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"role", "", "Present role."}, s.role);
    visit(Field{"aim", "", "Aim with the ball."}, s.aim);
    visit(Field{"at", "m", "Place that it aims at."}, s.at);
    visit(Field{"held_at", "m", "Place of the ball where it got it."}, s.held_at);
    visit(Field{"until", "s", "Time until which it keeps its aim."}, s.until_s);
    visit(Field{"held_since", "s", "Time when it got the ball."}, s.held_s);
    visit(Field{"let", "s", "Time when it held the ball last."}, s.let_s);
    visit(Field{"kicked", "s", "Time of its latest kick."}, s.kicked_s);
    visit(Field{"passed", "s", "Time of its latest pass."}, s.passed_s);
    visit(Field{"tolerance", "rad", "Largest error of the heading for a kick."}, s.tolerance_rad);
    visit(Field{"speed", "m/s", "Speed of the ball to kick it with."}, s.speed_mps);
    visit(Field{"side", "1", "Side of the field without the ball: 1 to the left, -1 to the right."}, s.side);
    visit(Field{"held", "", "Whether it held the ball in its latest step."}, s.held);
    visit(Field{"taken", "",
                "Whether its latest kick was a set piece, so that it may not touch the ball again."},
          s.taken);
    visit(Field{"kicks", "1", "Kicks so far."}, s.kicks);
  }
};

/// What to do in this step, in A.
struct Intent {
  const char* name = "stand";
  Vec3 target, moves_on;
  double yaw_rad = 0;
  double speed_mps = 0;     ///< at most
  double ball_room_m = 0;   ///< distance to keep from the ball on the way; 0: none
  bool keeps_clear = true;  ///< of robots
  bool rests = true;        ///< whether near the target is near enough while a set piece is prepared
  bool kick = false;        ///< as soon as the ball lies right
  bool handler = false;
};

}  // namespace sandlot::controllers::soccer_player
