#pragma once
/// Game of robot soccer as data: what a referee sees in a tick, what it remembers, and what it decides.
///
/// Teams    0 begins at negative x and attacks positive x, 1 the other way round; they change sides at half time. -1: none.
/// Robots   go by team and number, since they come and go.
/// State    plain data with field lists: a copy is a snapshot.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/vec3.h"
#include "soccer/words.h"

namespace sandlot::soccer {

/// The team that a team plays against.
inline std::int8_t other(int team) { return team == 0 ? std::int8_t{1} : std::int8_t{0}; }

/// A robot by team and number; team -1: none.
struct Who {
  std::int8_t team = -1;
  std::int32_t number = 0;
  bool operator==(const Who&) const = default;
  explicit operator bool() const { return team >= 0; }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"team", "1", "Index of the team; -1: none."}, s.team);
    visit(Field{"number", "1", "Number of the robot in its team."}, s.number);
  }
};

// ------------------------------------------------------------------------------------------------------- a tick's input

/// A robot as the referee sees it.
struct SeenRobot {
  Who who;
  Vec3 position_m, velocity_mps;
  double yaw_rad = 0, tilt_rad = 0;
  bool holds_ball = false;    ///< its ball handler has the ball
  bool out_of_order = false;  ///< its battery is empty, or the like
};
/// A robot touched the ball, in this order.
struct BallTouch {
  Who who;
};
/// Robots of two teams touched: impulse of the tick, on b.
struct Blow {
  Who a, b;
  Vec3 impulse_Ns;
};
/// A word from a person or a referee box.
struct Word {
  std::string text;  ///< STOP, "BALL 1 2"
  std::int8_t team = -1;
  std::int32_t robot = 0;
};

struct Input {
  double dt_s = 0;
  std::uint64_t tick = 0;
  bool has_ball = false;
  Vec3 ball_m, ball_mps;
  std::vector<SeenRobot> robots;  ///< by team and number
  std::vector<BallTouch> touches;
  std::vector<Blow> blows;
  std::vector<Word> words;
};

// ------------------------------------------------------------------------------------------------------------- output

/// A decision with all that a log wants to know of it.
struct Decision {
  std::uint64_t sequence = 0, tick = 0;
  Stage stage = Stage::first_half;
  double clock_s = 0;
  Law law = Law::begin;
  std::string command;
  std::int8_t team = -1;
  Who robot;
  std::string reason;
  Vec3 point_m, ball_m;
  std::array<std::uint32_t, 2> score{};
  static void fields(auto& s, auto&& visit) {
    visit(Field{"sequence", "1", "Number of the decision in the game."}, s.sequence);
    visit(Field{"tick", "1", "Tick after which it was made."}, s.tick);
    visit(Field{"stage", "", "Part of the game."}, s.stage);
    visit(Field{"clock", "s", "Time played of this part."}, s.clock_s);
    visit(Field{"rule", "", "Rule that was applied."}, s.law);
    visit(Field{"command", "", "Word that follows from it."}, s.command);
    visit(Field{"team", "1", "Team in whose favour it is."}, s.team);
    visit(Field{"robot", "", "Robot that it is about."}, s.robot);
    visit(Field{"reason", "", "Reason in words."}, s.reason);
    visit(Field{"point", "m", "Where the game goes on."}, s.point_m);
    visit(Field{"ball", "m", "Where the ball was."}, s.ball_m);
    visit(Field{"score", "1", "Goals of each team after it."}, s.score);
  }
};
/// A robot, or the ball (`who` none), that is put somewhere at rest.
struct Placement {
  Who who;
  Vec3 position_m;
  double yaw_rad = 0;
};
/// A robot whose actuators fail, or work again.
struct Exclusion {
  Who who;
  bool out = false;
};

struct Output {
  std::vector<Decision> decisions;
  std::vector<Word> words;
  std::vector<Placement> placements;
  std::vector<Exclusion> exclusions;
  bool changed = false;  ///< the state of the game is worth a message
  bool ended = false;
  void clear() {
    decisions.clear(), words.clear(), placements.clear(), exclusions.clear();
    changed = ended = false;
  }
};

// -------------------------------------------------------------------------------------------------------------- State

/// What a referee remembers of a robot.
struct RobotRecord {
  Who who;
  Absence absence = Absence::none;
  double away_s = 0;  ///< time left, or that it has been out
  std::uint32_t yellow = 0, yellows = 0, reds = 0, pushes = 0;
  double pushed_Ns = 0, goal_area_s = 0;
  Vec3 velocity_mps;  ///< in the tick before
  static void fields(auto& s, auto&& visit) {
    visit(Field{"who", "", "Robot that is remembered."}, s.who);
    visit(Field{"absence", "", "Why the robot is out."}, s.absence);
    visit(Field{"away", "s", "Time for which it has been out."}, s.away_s);
    visit(Field{"yellow", "1", "Yellow cards that count."}, s.yellow);
    visit(Field{"yellows", "1", "Yellow cards so far."}, s.yellows);
    visit(Field{"reds", "1", "Red cards."}, s.reds);
    visit(Field{"pushes", "1", "Fouls by pushing."}, s.pushes);
    visit(Field{"pushed", "Ns", "Impulse of late on robots of the other team."}, s.pushed_Ns);
    visit(Field{"goal_area", "s", "Time for which it has been in a goal area."}, s.goal_area_s);
    visit(Field{"velocity", "m/s", "Velocity in the latest tick."}, s.velocity_mps);
  }
};

struct TeamRecord {
  std::uint32_t substitutions = 0;
  std::array<double, 2> crowded_s{};  ///< too many in the penalty area at negative and positive x
  double possession_s = 0;
  std::uint32_t shots = 0, shots_in = 0;  ///< of the shoot-out
  static void fields(auto& s, auto&& visit) {
    visit(Field{"substitutions", "1", "Robots exchanged so far."}, s.substitutions);
    visit(Field{"crowded", "s", "Time with too many robots in each penalty area."}, s.crowded_s);
    visit(Field{"possession", "s", "Time for which the team touched the ball last."}, s.possession_s);
    visit(Field{"shots", "1", "Penalty kicks of the shoot-out."}, s.shots);
    visit(Field{"shots_in", "1", "Those that were goals."}, s.shots_in);
  }
};

/// Touches of the ball since the latest restart.
struct Touches {
  Who last, taker;
  double since_s = 0;         ///< since the last touch of anyone
  double taker_since_s = 0;   ///< since the last touch of the taker, while nobody else has touched
  bool others = false;        ///< somebody but the taker has touched since the restart
  Who holder;                 ///< robot that keeps the ball
  double holder_since_s = 0;  ///< since its last touch
  Vec3 got_m;                 ///< ball when the holder got it
  Vec3 taken_m;               ///< ball when the taker first touched it
  static void fields(auto& s, auto&& visit) {
    visit(Field{"last", "", "Robot that touched last."}, s.last);
    visit(Field{"taker", "", "Robot that touched first since the restart."}, s.taker);
    visit(Field{"since", "s", "Time since the last touch."}, s.since_s);
    visit(Field{"taker_since", "s", "Time since the taker's last touch."}, s.taker_since_s);
    visit(Field{"others", "", "Whether another robot has touched since the restart."}, s.others);
    visit(Field{"holder", "", "Robot that keeps the ball."}, s.holder);
    visit(Field{"holder_since", "s", "Time since its last touch."}, s.holder_since_s);
    visit(Field{"got", "m", "Ball when the holder got it."}, s.got_m);
    visit(Field{"taken", "m", "Ball when the taker first touched it."}, s.taken_m);
  }
};

/// A decision as it is kept.
struct Entry {
  std::uint64_t sequence = 0, tick = 0;
  Law law = Law::begin;
  std::int8_t team = -1;
  Who robot;
  Vec3 point_m;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"sequence", "1", "Number of the decision in the game."}, s.sequence);
    visit(Field{"tick", "1", "Tick after which it was made."}, s.tick);
    visit(Field{"rule", "", "Rule that was applied."}, s.law);
    visit(Field{"team", "1", "Team in whose favour it is."}, s.team);
    visit(Field{"robot", "", "Robot that it is about."}, s.robot);
    visit(Field{"point", "m", "Where the game goes on."}, s.point_m);
  }
};

inline constexpr std::size_t most_entries = 256, most_robots = 64;

struct State {
  bool begun = false, swapped = false, in_play = false, waits_for_person = false;
  Stage stage = Stage::first_half, next_stage = Stage::first_half;
  Phase phase = Phase::stopped;
  SetPiece piece = SetPiece::none;  ///< that is next, prepared or taken
  std::int8_t team = -1;            ///< that takes it
  std::int8_t first_kickoff = 0;
  std::int32_t retakes = 0;
  Vec3 spot_m;
  double clock_s = 0, phase_s = 0;  ///< of the part; since the phase began
  bool ball_known = false;
  Vec3 ball_m;    ///< in the tick before
  Vec3 anchor_m;  ///< from where the ball has not gone far
  double anchor_s = 0;
  std::array<std::uint32_t, 2> score{};
  std::array<TeamRecord, 2> teams{};
  Touches touches;
  std::vector<RobotRecord> robots;  ///< by team and number
  std::uint64_t decisions = 0, words = 0;
  std::vector<Entry> entries;  ///< the latest decisions, oldest first

  static void fields(auto& s, auto&& visit) {
    visit(Field{"begun", "", "Whether the game has begun."}, s.begun);
    visit(Field{"swapped", "", "Whether the teams have changed sides."}, s.swapped);
    visit(Field{"in_play", "", "Whether the ball is in play."}, s.in_play);
    visit(Field{"waits", "", "Whether a person has stopped the game."}, s.waits_for_person);
    visit(Field{"stage", "", "Part of the game."}, s.stage);
    visit(Field{"next_stage", "", "Part that follows the break."}, s.next_stage);
    visit(Field{"phase", "", "Phase of the game."}, s.phase);
    visit(Field{"set_piece", "", "Set piece that is next, prepared or taken."}, s.piece);
    visit(Field{"team", "1", "Team that takes it."}, s.team);
    visit(Field{"first_kickoff", "1", "Team that had the first kick-off."}, s.first_kickoff);
    visit(Field{"retakes", "1", "Repetitions of the set piece."}, s.retakes);
    visit(Field{"spot", "m", "Spot of the set piece."}, s.spot_m);
    visit(Field{"clock", "s", "Time played of this part."}, s.clock_s);
    visit(Field{"phase_time", "s", "Time since the phase began."}, s.phase_s);
    visit(Field{"ball_known", "", "Whether the ball was there in the latest tick."}, s.ball_known);
    visit(Field{"ball", "m", "Ball in the latest tick."}, s.ball_m);
    visit(Field{"anchor", "m", "Place from which the ball has not gone far."}, s.anchor_m);
    visit(Field{"anchor_time", "s", "Time for which it has been there."}, s.anchor_s);
    visit(Field{"score", "1", "Goals of each team."}, s.score);
    visit(Field{"teams", "", "Records of both teams."}, s.teams);
    visit(Field{"touches", "", "Touches of the ball."}, s.touches);
    visit(Field{"robots", "", "Robots that have taken part."}, s.robots);
    visit(Field{"decisions", "1", "Decisions so far."}, s.decisions);
    visit(Field{"words", "1", "Words so far."}, s.words);
    visit(Field{"entries", "", "Latest decisions."}, s.entries);
  }
  /// +1: the team attacks positive x.
  int attacks(int of_team) const { return (of_team == 0) != swapped ? 1 : -1; }
  /// Side of the team's own goal.
  int own_side(int of_team) const { return -attacks(of_team); }
  /// Team whose goal is on a side.
  std::int8_t defender(int side) const { return own_side(0) == side ? std::int8_t{0} : std::int8_t{1}; }
  /// Whether the numbers of a snapshot can be.
  bool fits() const;
};

}  // namespace sandlot::soccer
