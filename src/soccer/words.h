#pragma once
/// Words of the game: its parts, phases, set pieces and laws, and the words of referee boxes for them.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/fields.h"

namespace sandlot::soccer {

enum class Stage : std::uint8_t {
  first_half,
  half_time,  ///< any break
  second_half,
  overtime_first,
  overtime_second,
  penalties,
  ended
};
inline std::span<const EnumName<Stage>> enum_names(Stage) {
  static constexpr EnumName<Stage> names[] = {{"first_half", Stage::first_half},
                                              {"half_time", Stage::half_time},
                                              {"second_half", Stage::second_half},
                                              {"overtime_first", Stage::overtime_first},
                                              {"overtime_second", Stage::overtime_second},
                                              {"penalties", Stage::penalties},
                                              {"ended", Stage::ended}};
  return names;
}

enum class Phase : std::uint8_t { stopped, preparing, running };
inline std::span<const EnumName<Phase>> enum_names(Phase) {
  static constexpr EnumName<Phase> names[] = {
      {"stopped", Phase::stopped}, {"preparing", Phase::preparing}, {"running", Phase::running}};
  return names;
}

enum class SetPiece : std::uint8_t {
  none,
  kickoff,
  throw_in,
  corner,
  goal_kick,
  free_kick,
  penalty,
  dropped_ball
};
inline std::span<const EnumName<SetPiece>> enum_names(SetPiece) {
  static constexpr EnumName<SetPiece> names[] = {{"", SetPiece::none},
                                                 {"kickoff", SetPiece::kickoff},
                                                 {"throw_in", SetPiece::throw_in},
                                                 {"corner", SetPiece::corner},
                                                 {"goal_kick", SetPiece::goal_kick},
                                                 {"free_kick", SetPiece::free_kick},
                                                 {"penalty", SetPiece::penalty},
                                                 {"dropped_ball", SetPiece::dropped_ball}};
  return names;
}

/// What a decision is about.
enum class Law : std::uint8_t {
  begin,
  goal,
  own_goal,
  no_goal,
  throw_in,
  corner,
  goal_kick,
  lost_ball,
  start,
  in_play,
  ball_moved,
  distance,
  not_taken,
  double_touch,
  dribble,
  goal_area,
  penalty_area,
  pushing,
  scrum,
  stuck_ball,
  yellow_card,
  second_yellow,
  red_card,
  back,
  repair,
  substitution,
  half_time,
  end,
  person,
  refused,
  too_many,
  no_goalkeeper,
  no_robots,
  cleared
};
inline std::span<const EnumName<Law>> enum_names(Law) {
  static constexpr EnumName<Law> names[] = {{"begin", Law::begin},
                                            {"goal", Law::goal},
                                            {"own_goal", Law::own_goal},
                                            {"no_goal", Law::no_goal},
                                            {"throw_in", Law::throw_in},
                                            {"corner", Law::corner},
                                            {"goal_kick", Law::goal_kick},
                                            {"lost_ball", Law::lost_ball},
                                            {"start", Law::start},
                                            {"in_play", Law::in_play},
                                            {"ball_moved", Law::ball_moved},
                                            {"distance", Law::distance},
                                            {"not_taken", Law::not_taken},
                                            {"double_touch", Law::double_touch},
                                            {"dribble", Law::dribble},
                                            {"goal_area", Law::goal_area},
                                            {"penalty_area", Law::penalty_area},
                                            {"pushing", Law::pushing},
                                            {"scrum", Law::scrum},
                                            {"stuck_ball", Law::stuck_ball},
                                            {"yellow_card", Law::yellow_card},
                                            {"second_yellow", Law::second_yellow},
                                            {"red_card", Law::red_card},
                                            {"back", Law::back},
                                            {"repair", Law::repair},
                                            {"substitution", Law::substitution},
                                            {"half_time", Law::half_time},
                                            {"end", Law::end},
                                            {"person", Law::person},
                                            {"refused", Law::refused},
                                            {"too_many", Law::too_many},
                                            {"no_goalkeeper", Law::no_goalkeeper},
                                            {"no_robots", Law::no_robots},
                                            {"cleared", Law::cleared}};
  return names;
}

/// Why a robot is out of play.
enum class Absence : std::uint8_t { none, second_yellow, red, repair, substitution, surplus };
inline std::span<const EnumName<Absence>> enum_names(Absence) {
  static constexpr EnumName<Absence> names[] = {
      {"none", Absence::none},     {"second_yellow", Absence::second_yellow}, {"red", Absence::red},
      {"repair", Absence::repair}, {"substitution", Absence::substitution},   {"surplus", Absence::surplus}};
  return names;
}

/// Word of the referee box for a set piece, such as THROWIN; empty: none.
constexpr const char* word_of(SetPiece piece) {
  switch (piece) {
    case SetPiece::kickoff: return "KICKOFF";
    case SetPiece::throw_in: return "THROWIN";
    case SetPiece::corner: return "CORNER";
    case SetPiece::goal_kick: return "GOALKICK";
    case SetPiece::free_kick: return "FREEKICK";
    case SetPiece::penalty: return "PENALTY";
    case SetPiece::dropped_ball: return "DROP_BALL";
    case SetPiece::none: break;
  }
  return "";
}
/// Set piece of a word; none where it is another word.
constexpr SetPiece piece_of(std::string_view word) {
  for (const SetPiece each : {SetPiece::kickoff, SetPiece::throw_in, SetPiece::corner, SetPiece::goal_kick,
                              SetPiece::free_kick, SetPiece::penalty, SetPiece::dropped_ball})
    if (word == word_of(each)) return each;
  return SetPiece::none;
}
/// Word that begins a part of the game.
constexpr const char* word_of(Stage stage) {
  switch (stage) {
    case Stage::first_half: return "FIRST_HALF";
    case Stage::half_time: return "HALF_TIME";
    case Stage::second_half: return "SECOND_HALF";
    case Stage::overtime_first: return "FIRST_HALF_OVERTIME";
    case Stage::overtime_second: return "SECOND_HALF_OVERTIME";
    case Stage::penalties: return "PENALTIES";
    case Stage::ended: break;
  }
  return "END_GAME";
}

}  // namespace sandlot::soccer
