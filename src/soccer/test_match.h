#pragma once
/// A match for tests of the referee: robots and a ball that are where the test puts them, without physics.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "soccer/referee.h"

namespace sandlot::soccer::test {

inline constexpr Who keeper0{0, 1}, player0{0, 2}, mate0{0, 3}, keeper1{1, 1}, player1{1, 2}, mate1{1, 3};

struct Match {
  Rules rules;
  Dimensions field;
  State state;
  Output output;
  std::vector<SeenRobot> robots;
  bool has_ball = true;
  Vec3 ball_m{0, 0, 0.11}, ball_mps;
  std::vector<BallTouch> touches;  ///< of the next tick
  std::vector<Blow> blows;
  std::vector<Word> orders;
  double dt_s = 0.1;
  std::uint64_t tick = 0;
  std::vector<Decision> decisions;  ///< all so far
  std::vector<std::string> words;   ///< "KICKOFF 0", "STOP"
  std::vector<Exclusion> exclusions;
  bool ended = false;

  /// Three robots each, in their own halves, out of each other's way.
  Match() {
    for (const Who who : {keeper0, player0, mate0, keeper1, player1, mate1}) {
      SeenRobot robot;
      robot.who = who;
      const double side = who.team == 0 ? -1 : 1;
      robot.position_m = who.number == 1 ? Vec3{side * 10.7, 0, 0}
                                         : Vec3{side * 5, who.number == 2 ? 3.0 : -3.0, 0};
      robots.push_back(robot);
    }
  }
  SeenRobot& robot(Who who) {
    for (SeenRobot& each : robots)
      if (each.who == who) return each;
    ADD_FAILURE() << "no such robot";
    return robots.front();
  }
  void put(Who who, double x, double y) { robot(who).position_m = {x, y, 0}; }

  void step() {
    Input input;
    input.dt_s = dt_s;
    input.tick = ++tick;
    input.has_ball = has_ball;
    input.ball_m = ball_m;
    input.ball_mps = ball_mps;
    input.robots = robots;
    input.touches = std::move(touches);
    input.blows = std::move(blows);
    input.words = std::move(orders);
    touches.clear(), blows.clear(), orders.clear();
    Referee(rules, field, state).step(input, output);
    for (const Decision& each : output.decisions) decisions.push_back(each);
    for (const Word& each : output.words)
      words.push_back(each.text + (each.team < 0 ? "" : " " + std::to_string(each.team)) +
                      (each.robot == 0 ? "" : " " + std::to_string(each.robot)));
    for (const Placement& each : output.placements) {
      if (!each.who) ball_m = {each.position_m.x, each.position_m.y, 0.11};
      else robot(each.who).position_m = each.position_m;
    }
    for (const Exclusion& each : output.exclusions) exclusions.push_back(each);
    ended = ended || output.ended;
  }
  void run(double time_s) {
    for (const double end = static_cast<double>(tick) * dt_s + time_s;
         static_cast<double>(tick) * dt_s < end - 1e-9;)
      step();
  }
  /// Until the set piece is started; at most a minute.
  void until_started() {
    for (int i = 0; i < 600 && state.phase != Phase::running; ++i) step();
    ASSERT_EQ(state.phase, Phase::running);
  }
  /// Until the ball is in play and another robot of the taking team has it, at a place.
  void into_play(Vec3 at = {0, 0, 0.11}) {
    until_started();
    const std::int8_t team = state.team < 0 ? std::int8_t{0} : state.team;
    touch({team, 2});
    ball_m = {state.spot_m.x, state.spot_m.y + 0.4, 0.11};
    step();
    touch({team, 3});
    step();
    ASSERT_TRUE(state.in_play);
    run(1);  // nobody holds it
    ball_m = at;
    step();
    decisions.clear();
    words.clear();
  }
  void touch(Who who) { touches.push_back({who}); }
  /// The ball leaves to a place, touched by a robot before.
  void shoot(Who who, Vec3 to) {
    touch(who);
    step();
    ball_m = to;
    step();
  }
  void order(std::string text, std::int8_t team = -1, std::int32_t number = 0) {
    orders.push_back({std::move(text), team, number});
    step();
  }
  /// The laws of the decisions so far: "goal".
  std::vector<std::string> laws() const {
    std::vector<std::string> out;
    for (const Decision& each : decisions) out.emplace_back(name_of(each.law));
    return out;
  }
  const Decision& last() const {
    static const Decision none;
    return decisions.empty() ? none : decisions.back();
  }
};

using Laws = std::vector<std::string>;

}  // namespace sandlot::soccer::test
