#include "soccer/referee.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "soccer/areas.h"
#include "soccer/last_touch.h"

namespace sandlot::soccer {
namespace {

bool finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool plays(Stage stage) { return stage != Stage::half_time && stage != Stage::ended; }

}  // namespace

bool State::fits() const {
  const auto known = [](std::int8_t each) { return each >= -1 && each <= 1; };
  const auto sound = [&](const Who& who) { return known(who.team); };
  if (retakes < 0 || retakes > 10000 || !known(team) || first_kickoff < 0 || first_kickoff > 1) return false;
  if (robots.size() > most_robots || entries.size() > most_entries) return false;
  for (const RobotRecord& each : robots)
    if (!each.who || !sound(each.who) || !finite(each.velocity_mps)) return false;
  for (std::size_t i = 1; i < robots.size(); ++i)
    if (std::pair(robots[i - 1].who.team, robots[i - 1].who.number) >=
        std::pair(robots[i].who.team, robots[i].who.number))
      return false;
  for (const Entry& each : entries)
    if (!known(each.team) || !sound(each.robot)) return false;
  return sound(touches.last) && sound(touches.taker) && sound(touches.holder) && finite(ball_m) &&
         finite(spot_m) && finite(anchor_m) && finite(touches.got_m) && finite(touches.taken_m);
}

double Referee::part_s(const Rules& rules, Stage stage) {
  switch (stage) {
    case Stage::first_half:
    case Stage::second_half: return rules.half_s;
    case Stage::half_time: return rules.break_s;
    case Stage::overtime_first:
    case Stage::overtime_second: return rules.overtime_s;
    case Stage::penalties:
    case Stage::ended: break;
  }
  return 0;
}

double Referee::remaining_s(const Rules& rules, const State& state) {
  return std::max(0.0, part_s(rules, state.stage) - state.clock_s);
}

// ----------------------------------------------------------------------------------------------------------- output

void Referee::decide(Law law, std::int8_t team, Who robot, std::string reason, const char* command) {
  Decision& made = output_->decisions.emplace_back();
  made.sequence = ++state_.decisions;
  made.tick = input_->tick;
  made.stage = state_.stage;
  made.clock_s = state_.clock_s;
  made.law = law;
  made.command = command;
  made.team = team;
  made.robot = robot;
  made.reason = std::move(reason);
  made.point_m = state_.spot_m;
  made.ball_m = input_->has_ball ? input_->ball_m : Vec3{};
  made.score = state_.score;
  if (state_.entries.size() == most_entries) state_.entries.erase(state_.entries.begin());
  state_.entries.push_back({made.sequence, made.tick, law, team, robot, made.point_m});
  output_->changed = true;
}

void Referee::say(const char* word, std::int8_t team, std::int32_t robot) {
  output_->words.push_back({word, team, robot});
  ++state_.words;
  output_->changed = true;
}

// ------------------------------------------------------------------------------------------------ parts of the game

void Referee::begin_game() {
  state_.begun = true;
  int count[2] = {}, keepers[2] = {};
  for (const SeenRobot& each : input_->robots) {
    RobotRecord& known = record(each.who);
    const std::size_t team = each.who.team == 0 ? 0 : 1;
    if (++count[team] > rules_.players) {
      send_off(known, Absence::surplus);
      decide(Law::too_many, other(each.who.team), each.who, "the team has more robots than may take part");
      continue;
    }
    keepers[team] += each.who.number == rules_.goalkeeper;
  }
  for (const std::int8_t team : {std::int8_t{0}, std::int8_t{1}}) {
    const std::size_t t = team == 0 ? 0 : 1;
    if (count[t] == 0) decide(Law::no_robots, team, {}, "the team has no robot");
    else if (keepers[t] == 0) decide(Law::no_goalkeeper, team, {}, "the team has no goalkeeper");
  }
  begin_part(Stage::first_half);
}

void Referee::begin_part(Stage stage) {
  state_.stage = stage;
  state_.clock_s = 0;
  state_.waits_for_person = false;
  const bool second = stage == Stage::second_half || stage == Stage::overtime_second;
  state_.swapped = second;
  say(word_of(stage));
  if (stage == Stage::penalties) {
    decide(Law::begin, -1, {}, "penalty kicks decide", word_of(stage));
    return next_shot();
  }
  const std::int8_t team = second ? other(state_.first_kickoff) : state_.first_kickoff;
  order(SetPiece::kickoff, team, {});
  decide(Law::begin, team, {}, std::string("begin of ") + name_of(stage), word_of(stage));
}

void Referee::end_part() {
  const bool draw = state_.score[0] == state_.score[1];
  Stage next = Stage::ended;
  switch (state_.stage) {
    case Stage::first_half: next = Stage::second_half; break;
    case Stage::overtime_first: next = Stage::overtime_second; break;
    case Stage::second_half:
      if (draw && rules_.overtime_s > 0) next = Stage::overtime_first;
      else if (draw && rules_.shootout > 0) next = Stage::penalties;
      break;
    case Stage::overtime_second:
      if (draw && rules_.shootout > 0) next = Stage::penalties;
      break;
    case Stage::half_time:
    case Stage::penalties:
    case Stage::ended: break;
  }
  if (next == Stage::ended) return end_game("the time is over");
  stop();
  state_.piece = SetPiece::none;
  say(state_.stage == Stage::first_half ? "HALF_TIME" : "END_PART");
  decide(Law::half_time, -1, {}, std::string("end of ") + name_of(state_.stage), "HALF_TIME");
  state_.stage = Stage::half_time;
  state_.next_stage = next;
  state_.clock_s = 0;
}

void Referee::end_game(std::string reason) {
  stop();
  state_.piece = SetPiece::none;
  state_.team = -1;
  say("END_GAME");
  state_.stage = Stage::ended;
  decide(Law::end, -1, {}, std::move(reason), "END_GAME");
  output_->ended = true;
}

/// The teams shoot in turn at the goal that team 0 attacks in the first half, team 0 at the other one. It ends when a team
/// cannot be caught, or after equal numbers of shots beyond the planned ones.
void Referee::next_shot() {
  const TeamRecord &a = state_.teams[0], &b = state_.teams[1];
  const auto planned = static_cast<std::uint32_t>(rules_.shootout);
  const auto left = [&](const TeamRecord& team) { return team.shots < planned ? planned - team.shots : 0; };
  const bool even = a.shots == b.shots;
  const bool decided = a.shots_in > b.shots_in + left(b) || b.shots_in > a.shots_in + left(a);
  const bool planned_over = a.shots >= planned && b.shots >= planned;
  if ((!planned_over && decided) || (planned_over && even && a.shots_in != b.shots_in))
    return end_game("decided by penalty kicks");
  if (even && a.shots >= static_cast<std::uint32_t>(std::max(rules_.shootout_limit, rules_.shootout)))
    return end_game("a draw after penalty kicks");
  order(SetPiece::penalty, even ? state_.first_kickoff : other(state_.first_kickoff), {});
}

// ------------------------------------------------------------------------------------------------------------ phases

void Referee::go_to(Phase phase) {
  state_.phase = phase;
  state_.phase_s = 0;
  state_.anchor_s = 0;
  output_->changed = true;
}

void Referee::stop() {
  if (state_.phase != Phase::stopped) say("STOP");
  state_.in_play = false;
  go_to(Phase::stopped);
  for (RobotRecord& each : state_.robots) each.goal_area_s = 0, each.pushed_Ns = 0;
  for (TeamRecord& each : state_.teams) each.crowded_s = {};
}

/// Stops the game and plans a set piece.
void Referee::order(SetPiece piece, std::int8_t team, Vec3 place_m) {
  stop();
  state_.piece = piece;
  state_.team = piece == SetPiece::dropped_ball ? std::int8_t{-1} : team;
  state_.retakes = 0;
  state_.spot_m = spot_of(scene(), piece, state_.team, place_m);
}

/// Puts robots that stand on the spot beside it, each to the nearest place of twelve around that is free.
void Referee::clear_spot() {
  constexpr double clear_m = 0.5, away_m = 0.85, robot_m = 0.6;
  constexpr int directions = 12;
  for (SeenRobot& each : input_->robots) {
    const Vec3 from_spot{each.position_m.x - state_.spot_m.x, each.position_m.y - state_.spot_m.y, 0};
    if (norm(from_spot) >= clear_m) continue;
    double nearest_m = 1e9;
    std::optional<Vec3> best;
    for (int i = 0; i < directions; ++i) {
      const double angle = math::tau * i / directions;
      const Vec3 to{state_.spot_m.x + away_m * math::cos(angle), state_.spot_m.y + away_m * math::sin(angle),
                    each.position_m.z};
      const bool taken = std::any_of(input_->robots.begin(), input_->robots.end(), [&](const SeenRobot& one) {
        return !(one.who == each.who) &&
               norm(Vec3{one.position_m.x - to.x, one.position_m.y - to.y, 0}) < robot_m;
      });
      const double way_m = norm(Vec3{to.x - each.position_m.x, to.y - each.position_m.y, 0});
      if (!taken && way_m < nearest_m - 1e-9) nearest_m = way_m, best = to;
    }
    if (!best) continue;
    each.position_m = *best;
    output_->placements.push_back({each.who, *best, each.yaw_rad});
    decide(Law::cleared, each.who.team, each.who, "stood on the spot of the set piece");
  }
}

void Referee::prepare() {
  clear_spot();
  output_->placements.push_back({{}, state_.spot_m, 0});
  forget_touches(state_.touches, true);
  go_to(Phase::preparing);
  say(word_of(state_.piece), state_.team);
}

void Referee::start(bool by_time) {
  say("START");
  forget_touches(state_.touches, false);
  decide(Law::start, state_.team, {}, by_time ? "the time to prepare is over" : "all robots are ready",
         "START");
  go_to(Phase::running);
  state_.in_play = state_.piece == SetPiece::dropped_ball;
}

void Referee::step(Input& input, Output& output) {
  output.clear();
  input_ = &input;
  output_ = &output;
  if (!finite(input.ball_m) || !finite(input.ball_mps)) input.has_ball = false;
  list_robots();
  if (!state_.begun) begin_game();
  state_.phase_s += input.dt_s;
  for (const Word& word : input.words) take_word(word);
  tend_robots();
  if (state_.stage == Stage::half_time) {
    state_.clock_s += input.dt_s;
    if (state_.clock_s >= rules_.break_s) begin_part(state_.next_stage);
  } else if (plays(state_.stage)) {
    const bool clock_runs = state_.phase == Phase::running || !rules_.stop_clock;
    if (clock_runs) state_.clock_s += input.dt_s;
    switch (state_.phase) {
      case Phase::stopped: step_stopped(); break;
      case Phase::preparing: step_preparing(); break;
      case Phase::running: step_running(); break;
    }
    const bool timed = plays(state_.stage) && state_.stage != Stage::penalties;
    if (timed && state_.clock_s >= part_s(rules_, state_.stage)) end_part();
  }
  state_.ball_known = input.has_ball;
  if (input.has_ball) state_.ball_m = input.ball_m;
  for (RobotRecord& each : state_.robots)
    if (const SeenRobot* const robot = scene().find(each.who)) each.velocity_mps = robot->velocity_mps;
}

void Referee::step_stopped() {
  if (state_.waits_for_person || state_.piece == SetPiece::none || state_.phase_s < rules_.stop_s) return;
  if (input_->has_ball) prepare();
}

void Referee::step_preparing() {
  if (!input_->has_ball) {
    order(state_.piece, state_.team, state_.spot_m);
    return decide(Law::lost_ball, state_.team, {}, "the ball is gone");
  }
  follow_touches(state_.touches, rules_, *input_, false);
  // The ball needs two ticks to be where it was put.
  constexpr double settle_s = 0.5;
  const Vec3 way{input_->ball_m.x - state_.spot_m.x, input_->ball_m.y - state_.spot_m.y, 0};
  if (state_.phase_s > settle_s && norm(way) > rules_.in_play_m) {
    const Who by = state_.touches.since_s < state_.phase_s ? state_.touches.last : Who{};
    const bool once_more = state_.retakes < rules_.retakes;
    if (by && once_more) return violated({by, "moved the ball before the start"});
    if (by) return start(true);
    output_->placements.push_back({{}, state_.spot_m, 0});  // it rolled by itself
    return decide(Law::ball_moved, state_.team, {}, "the ball rolled from its spot");
  }
  if (state_.waits_for_person || state_.phase_s < rules_.prepare_min_s) return;
  const Violation wrong = violation(scene(), false);
  if (!wrong.who && all_stand(scene())) return start(false);
  const bool kickoff = state_.piece == SetPiece::kickoff;
  if (state_.phase_s < (kickoff ? rules_.prepare_kickoff_s : rules_.prepare_max_s)) return;
  if (wrong.who && (state_.retakes < rules_.retakes || changes_sides(wrong))) return violated(wrong);
  start(true);
}

/// Whether the set piece goes to the other team now: it has been repeated often enough, and its own team is to blame.
bool Referee::changes_sides(const Violation& wrong) const {
  const bool can = state_.piece != SetPiece::kickoff && state_.piece != SetPiece::dropped_ball &&
                   state_.stage != Stage::penalties;
  return can && state_.retakes == rules_.retakes && wrong.who.team == state_.team;
}

/// A set piece is repeated so many times; then it goes to the other team if the one that takes it is to blame, and else it is
/// taken all the same. It changes sides once.
void Referee::violated(const Violation& wrong) {
  const bool changes = changes_sides(wrong);
  const std::int32_t retakes = state_.retakes + 1;
  if (changes) order(SetPiece::free_kick, other(state_.team), state_.spot_m);
  else stop();
  state_.retakes = retakes;
  const bool moved = std::string_view(wrong.what).starts_with("moved");
  decide(moved ? Law::ball_moved : Law::distance, state_.team, wrong.who, wrong.what, word_of(state_.piece));
}

void Referee::step_running() {
  if (!input_->has_ball) {
    order(SetPiece::dropped_ball, -1, {});
    return decide(Law::lost_ball, -1, {}, "the ball is gone", "DROP_BALL");
  }
  const bool counts_taker = state_.piece != SetPiece::none;
  const bool again = follow_touches(state_.touches, rules_, *input_, counts_taker);
  if (state_.touches.last && state_.in_play)
    state_.teams[state_.touches.last.team == 0 ? 0 : 1].possession_s += input_->dt_s;
  if (!state_.in_play) step_taking();
  if (state_.phase != Phase::running || !plays(state_.stage)) return;
  judge_play(again);
}

/// The set piece is being taken: until the ball has moved, or the time is over.
void Referee::step_taking() {
  const Vec3 way{input_->ball_m.x - state_.spot_m.x, input_->ball_m.y - state_.spot_m.y, 0};
  const Touches& touches = state_.touches;
  const bool is_penalty = state_.piece == SetPiece::penalty;
  const bool by_other = touches.last && state_.team >= 0 && touches.last.team != state_.team;
  if (by_other && state_.retakes < rules_.retakes)
    return violated({touches.last, "moved the ball of the other team's set piece"});
  if (norm(way) > rules_.in_play_m) {
    state_.in_play = true;
    if (!touches.taker &&
        state_.team >= 0) {  // a kicker moved it, without a touch: the nearest robot took it
      state_.touches.taker = nearest_taker(scene());
      state_.touches.taken_m = state_.spot_m;
      state_.touches.last = state_.touches.taker;
    }
    output_->changed = true;
    return decide(Law::in_play, state_.team, touches.taker, "the ball has moved");
  }
  if (const Violation wrong = violation(scene(), true); wrong.who && state_.retakes < rules_.retakes)
    return violated(wrong);
  if (state_.phase_s < (is_penalty ? rules_.penalty_s : rules_.take_s)) return;
  if (is_penalty && state_.stage != Stage::penalties) {
    const std::int8_t team = other(state_.team);
    order(SetPiece::goal_kick, team, state_.spot_m);
    return decide(Law::not_taken, team, {}, "the penalty kick was not taken in time", "GOALKICK");
  }
  if (is_penalty) return;  // judge_play ends the shot
  state_.in_play = true;
  state_.piece = SetPiece::none;
  decide(Law::not_taken, state_.team, {}, "the set piece was not taken in time: any robot may play");
}

void Referee::judge_play(bool again) {
  const Scene now = scene();
  if (state_.stage == Stage::penalties) {
    const auto out = judge_ball_out(now);
    const bool in = out && (out->law == Law::goal || out->law == Law::own_goal);
    const bool over = state_.phase_s >= rules_.penalty_s || (out && !in);
    if (!in && !over) return;
    TeamRecord& team = state_.teams[state_.team == 0 ? 0 : 1];
    ++team.shots;
    team.shots_in += in;
    const std::int8_t shooter = state_.team;
    stop();
    if (in) say("GOAL", shooter);
    decide(in ? Law::goal : Law::no_goal, shooter, state_.touches.last,
           in ? "penalty kick of the shoot-out" : "the penalty kick was no goal", in ? "GOAL" : "");
    return next_shot();
  }
  if (const auto call = judge_ball_out(now)) return follow(*call);
  if (!state_.in_play) return;
  if (const auto call = judge_double_touch(now, again)) return follow(*call);
  // Once another robot has the ball, how it was set does not matter.
  if (state_.touches.others) state_.piece = SetPiece::none, state_.team = -1;
  if (const auto call = judge_dribble(now)) return follow(*call);
  follow_areas(now, state_);
  follow_pushes(now, state_);
  follow_ball(now, state_);
  if (const auto call = judge_pushing(now)) {
    RobotRecord& pusher = record(call->robot);
    follow(*call);
    if (++pusher.pushes;
        rules_.pushes_per_card > 0 && pusher.pushes % static_cast<std::uint32_t>(rules_.pushes_per_card) == 0)
      show_yellow(pusher, "pushed again");
    return;
  }
  if (const auto call = judge_goal_area(now)) return follow(*call);
  if (const auto call = judge_penalty_area(now)) return follow(*call);
  if (const auto call = judge_blocked_ball(now)) return follow(*call);
}

void Referee::follow(const Call& call) {
  if (call.law == Law::goal || call.law == Law::own_goal) return score(call);
  order(call.piece, call.team, call.place_m);
  decide(call.law, call.team, call.robot, call.reason, word_of(call.piece));
}

void Referee::score(const Call& call) {
  const std::int8_t scorer = other(call.team);
  ++state_.score[scorer == 0 ? 0 : 1];
  order(SetPiece::kickoff, call.team, {});
  say("GOAL", scorer);
  decide(call.law, scorer, call.robot, call.reason, "GOAL");
}

}  // namespace sandlot::soccer
