/// Referee, continued: robots that come, are sent off, repaired and exchanged, and the words of persons.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "soccer/areas.h"
#include "soccer/referee.h"

namespace sandlot::soccer {

// ----------------------------------------------------------------------------------------------------------- robots

RobotRecord* Referee::find_record(Who who) {
  for (RobotRecord& each : state_.robots)
    if (each.who == who) return &each;
  return nullptr;
}

RobotRecord& Referee::record(Who who) {
  const auto place = std::lower_bound(
      state_.robots.begin(), state_.robots.end(), who, [](const RobotRecord& a, Who b) {
        return std::pair(a.who.team, a.who.number) < std::pair(b.team, b.number);
      });
  if (place != state_.robots.end() && place->who == who) return *place;
  RobotRecord made;
  made.who = who;
  return *state_.robots.insert(place, made);
}

/// Knows robots that are new, and leaves those that are out of play out of the scene.
void Referee::list_robots() {
  auto& robots = input_->robots;
  const auto is_broken = [](const SeenRobot& each) {
    return !std::isfinite(norm(each.position_m)) || !std::isfinite(norm(each.velocity_mps));
  };
  std::erase_if(robots, is_broken);
  for (const SeenRobot& each : robots) {
    if (find_record(each.who) || state_.robots.size() == most_robots) continue;
    record(each.who);
    if (!state_.begun) continue;
    const auto same = std::count_if(state_.robots.begin(), state_.robots.end(), [&](const RobotRecord& one) {
      return one.who.team == each.who.team && one.absence == Absence::none && scene().find(one.who);
    });
    if (same <= rules_.players) continue;
    send_off(record(each.who), Absence::surplus);
    decide(Law::too_many, other(each.who.team), each.who, "the team has more robots than may take part");
  }
}

Vec3 Referee::bench_m(Who who) const {
  constexpr double between_m = 0.9;
  const double x = state_.own_side(who.team) * (1 + between_m * (1 + who.number % 16));
  const double y = width_half_m(field_) + rules_.bench_m;
  return {x, who.team == 0 ? -y : y, 0};
}

void Referee::send_off(RobotRecord& robot, Absence absence) {
  robot.absence = absence;
  robot.away_s = 0;
  robot.goal_area_s = robot.pushed_Ns = 0;
  output_->exclusions.push_back({robot.who, true});
  output_->placements.push_back({robot.who, bench_m(robot.who), 0});
}

/// To the touch line of its own half.
void Referee::bring_back(RobotRecord& robot) {
  robot.absence = Absence::none;
  robot.away_s = 0;
  Vec3 place = bench_m(robot.who);
  place.y = (place.y < 0 ? -1 : 1) * (width_half_m(field_) - 0.4);
  output_->exclusions.push_back({robot.who, false});
  output_->placements.push_back({robot.who, place, 0});
}

void Referee::show_yellow(RobotRecord& robot, const std::string& reason) {
  ++robot.yellows;
  const bool second = ++robot.yellow > 1;
  say(second ? "DOUBLE_YELLOW" : "YELLOW_CARD", robot.who.team, robot.who.number);
  if (second) {
    robot.yellow = 0;
    send_off(robot, Absence::second_yellow);
  }
  decide(second ? Law::second_yellow : Law::yellow_card, other(robot.who.team), robot.who, reason,
         second ? "DOUBLE_YELLOW" : "YELLOW_CARD");
}

void Referee::tend_robots() {
  for (RobotRecord& each : state_.robots) {
    const SeenRobot* const robot = scene().find(each.who);
    if (each.absence == Absence::none) {
      if (!robot || !(robot->out_of_order || robot->tilt_rad > rules_.tilt_rad)) continue;
      say("REPAIR", each.who.team, each.who.number);
      send_off(each, Absence::repair);
      decide(Law::repair, each.who.team, each.who, "the robot is out of order", "REPAIR");
      continue;
    }
    each.away_s += input_->dt_s;
    const bool over = (each.absence == Absence::second_yellow && each.away_s >= rules_.second_yellow_s) ||
                      (each.absence == Absence::repair && rules_.repair_ends &&
                       each.away_s >= rules_.repair_s) ||
                      (each.absence == Absence::substitution && each.away_s >= rules_.repair_s);
    if (!over || !robot || robot->out_of_order) continue;
    bring_back(each);
    say("REPAIR_END", each.who.team, each.who.number);
    decide(Law::back, each.who.team, each.who, "its time is over", "REPAIR_END");
  }
  auto& robots = input_->robots;
  std::erase_if(robots, [&](const SeenRobot& each) {
    const RobotRecord* const known = find_record(each.who);
    return !known || known->absence != Absence::none;
  });
  const auto is_out = [&](Who who) { return !scene().find(who); };
  std::erase_if(input_->touches, [&](const BallTouch& each) { return is_out(each.who); });
  std::erase_if(input_->blows, [&](const Blow& each) { return is_out(each.a) || is_out(each.b); });
}

// -------------------------------------------------------------------------------------------------- words of persons

void Referee::refuse(const Word& word, const char* why) {
  decide(Law::refused, word.team, {word.team, word.robot}, "'" + word.text.substr(0, 40) + "': " + why);
}

void Referee::take_word(const Word& word) {
  const bool team_fits = word.team >= -1 && word.team <= 1;
  if (!team_fits) return refuse({word.text, -1, word.robot}, "there is no such team");
  if (state_.stage == Stage::ended) return refuse(word, "the game is over");
  if (take_game_word(word) || take_robot_word(word)) return;
  refuse(word, "there is no such word");
}

/// @return false: it is another word
bool Referee::take_game_word(const Word& word) {
  const std::string& text = word.text;
  const auto noted = [&](const char* reason) { decide(Law::person, word.team, {}, reason, text.c_str()); };
  if (text == "STOP") {
    stop();
    if (state_.piece == SetPiece::none && state_.stage != Stage::half_time)
      order(SetPiece::dropped_ball, -1, input_->ball_m);
    state_.waits_for_person = true;
    noted("a person stopped the game");
  } else if (text == "START") {
    if (state_.stage == Stage::half_time) begin_part(state_.next_stage);
    state_.waits_for_person = false;
    if (state_.phase == Phase::preparing) {
      noted("a person started the game");
      start(false);
    } else if (state_.phase == Phase::stopped) {
      state_.phase_s = rules_.stop_s;  // the set piece that waits comes at once
      noted("a person lets the game go on");
    }
  } else if (const SetPiece piece = piece_of(text); piece != SetPiece::none) {
    if (state_.stage == Stage::half_time) return refuse(word, "it is half time"), true;
    if (piece != SetPiece::dropped_ball && word.team < 0) return refuse(word, "it needs a team"), true;
    order(piece, word.team, input_->has_ball ? input_->ball_m : Vec3{});
    state_.waits_for_person = false;
    noted("a person ordered a set piece");
  } else if (text == "GOAL" || text == "SUBGOAL") {
    if (word.team < 0) return refuse(word, "it needs a team"), true;
    std::uint32_t& score = state_.score[word.team == 0 ? 0 : 1];
    if (text == "GOAL") ++score;
    else if (score > 0) --score;
    say(text == "GOAL" ? "GOAL" : "SUBGOAL", word.team);
    if (text == "GOAL" && state_.stage != Stage::half_time) order(SetPiece::kickoff, other(word.team), {});
    noted("a person changed the score");
  } else if (text == "HALF_TIME" || text == "END_PART") {
    if (state_.stage == Stage::half_time) return refuse(word, "it is half time"), true;
    noted("a person ended the part");
    end_part();
  } else if (text == "END_GAME") {
    end_game("a person ended the game");
  } else if (text == "PARK") {
    say("PARK", word.team);
    noted("a person parks the robots");
  } else if (text.starts_with("BALL ")) {
    const std::string_view place = std::string_view(text).substr(5);
    const std::size_t blank = std::min(place.find(' '), place.size());
    double x = 0, y = 0;
    const bool read = parse_number(place.substr(0, blank), x) && blank < place.size() &&
                      parse_number(place.substr(blank + 1), y);
    if (!read || !(std::abs(x) <= length_half_m(field_) + 1) || !(std::abs(y) <= width_half_m(field_) + 1))
      return refuse(word, "it needs a place on the field, such as BALL 1 2"), true;
    output_->placements.push_back({{}, {x, y, 0}, 0});
    state_.ball_m = {x, y, 0};
    state_.ball_known = false;
    noted("a person put the ball");
  } else {
    return false;
  }
  return true;
}

bool Referee::take_robot_word(const Word& word) {
  const std::string& text = word.text;
  if (text != "YELLOW_CARD" && text != "RED_CARD" && text != "REPAIR" && text != "REPAIR_END" &&
      text != "SUBSTITUTION")
    return false;
  RobotRecord* const robot = find_record({word.team, word.robot});
  if (!robot) return refuse(word, "there is no such robot"), true;
  if (text == "REPAIR_END") {
    const bool on_repair = robot->absence == Absence::repair;
    if (!on_repair || robot->away_s < rules_.repair_s)
      return refuse(word, on_repair ? "its time is not over" : "it is not out for repair"), true;
    bring_back(*robot);
    say("REPAIR_END", word.team, word.robot);
    decide(Law::back, word.team, robot->who, "a person lets it back", "REPAIR_END");
    return true;
  }
  if (robot->absence != Absence::none) return refuse(word, "it is out of play"), true;
  if (text == "YELLOW_CARD") {
    show_yellow(*robot, "a person showed the card");
  } else if (text == "RED_CARD") {
    ++robot->reds;
    say("RED_CARD", word.team, word.robot);
    send_off(*robot, Absence::red);
    decide(Law::red_card, other(word.team), robot->who, "a person showed the card", "RED_CARD");
  } else if (text == "REPAIR") {
    say("REPAIR", word.team, word.robot);
    send_off(*robot, Absence::repair);
    decide(Law::repair, word.team, robot->who, "asked for", "REPAIR");
  } else {
    TeamRecord& team = state_.teams[word.team == 0 ? 0 : 1];
    if (team.substitutions >= static_cast<std::uint32_t>(rules_.substitutions))
      return refuse(word, "the team has no substitution left"), true;
    if (state_.phase == Phase::running) return refuse(word, "the game must be stopped"), true;
    ++team.substitutions;
    robot->yellow = 0;
    say("SUBSTITUTION", word.team, word.robot);
    send_off(*robot, Absence::substitution);
    decide(Law::substitution, word.team, robot->who, "asked for", "SUBSTITUTION");
  }
  return true;
}

}  // namespace sandlot::soccer
