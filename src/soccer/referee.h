#pragma once
/// Referee: the game as a machine of stages, phases and set pieces, which judges a tick at a time.
///
///   stopped --stop_time--> preparing --all ready, or prepare_max--> running --a law applies--> stopped
///
/// Input    what the referee sees in a tick (game.h); words of persons and referee boxes.
/// Output   decisions, words to the robots, and who or what has to be placed or taken out.
/// Time     once per tick; all times are sums of tick lengths, so a measured clock is right, too.
/// Limits   judges by truth: no error of sight, no advantage rule, no intent.
/// Errors   a word that cannot be is a decision `refused`; a ball that is gone stops the game until it is back.
/// Cost     a few microseconds for ten robots; no allocation but for the strings of decisions.
#include "soccer/judge.h"

namespace sandlot::soccer {

class Referee {
 public:
  /// @param rules, field, state  must outlive the referee
  Referee(const Rules& rules, const Dimensions& field, State& state)
      : rules_(rules), field_(field), state_(state) {}

  /// Judges a tick. `input.robots` are all robots of both teams, those that are out of play, too; the rest is looked at
  /// without them.
  /// @param output  cleared first
  void step(Input& input, Output& output);

  /// Time left of the part or break.
  static double remaining_s(const Rules& rules, const State& state);
  static double part_s(const Rules& rules, Stage stage);

 private:
  Scene scene() const { return {rules_, field_, state_, *input_}; }
  // Output
  void decide(Law law, std::int8_t team, Who robot, std::string reason, const char* command = "");
  void say(const char* word, std::int8_t team = -1, std::int32_t robot = 0);
  // Parts of the game
  void begin_game();
  void begin_part(Stage stage);
  void end_part();
  void end_game(std::string reason);
  void next_shot();
  // Phases
  void go_to(Phase phase);
  void stop();
  void order(SetPiece piece, std::int8_t team, Vec3 place_m);
  void prepare();
  void start(bool by_time);
  void step_stopped();
  void step_preparing();
  void step_running();
  void step_taking();
  bool changes_sides(const Violation& wrong) const;
  void violated(const Violation& wrong);
  void follow(const Call& call);
  void score(const Call& call);
  void judge_play(bool again);
  // Robots
  void list_robots();
  void tend_robots();
  RobotRecord& record(Who who);
  RobotRecord* find_record(Who who);
  void send_off(RobotRecord& record, Absence absence);
  void bring_back(RobotRecord& record);
  void show_yellow(RobotRecord& record, const std::string& reason);
  Vec3 bench_m(Who who) const;
  void clear_spot();
  // Words of persons
  void take_word(const Word& word);
  bool take_robot_word(const Word& word);
  bool take_game_word(const Word& word);
  void refuse(const Word& word, const char* why);

  const Rules& rules_;
  const Dimensions& field_;
  State& state_;
  Input* input_ = nullptr;
  Output* output_ = nullptr;
};

}  // namespace sandlot::soccer
