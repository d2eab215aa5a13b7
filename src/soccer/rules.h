#pragma once
/// Rules of the league as numbers: distances, times, limits, cards and parts of the game.
///
/// Source   Middle Size League, rule book of 2023, and the automatic referees of teams; docs/soccer_rules.md says which number
///          comes from where, and which is ours.
#include "base/fields.h"

namespace sandlot::soccer {

struct Rules {
  // Parts of the game
  double half_s = 900, break_s = 300, overtime_s = 0;
  int shootout = 0, shootout_limit = 20;
  bool stop_clock = true;
  // Teams
  int players = 5, goalkeeper = 1, substitutions = 3;
  // Set pieces
  double stop_s = 2, prepare_min_s = 2, prepare_max_s = 10, prepare_kickoff_s = 20, take_s = 7,
         penalty_s = 10;
  double in_play_m = 0.2, opponents_m = 3, teammates_m = 2, dropped_ball_m = 1, tolerance_m = 0.1;
  double ready_mps = 0.15;
  int retakes = 2;
  // Goals
  bool goal_from_kickoff = false, goal_from_throw_in = false, goal_from_free_kick = false;
  bool goal_from_corner = false, goal_from_goal_kick = false, goal_from_dropped_ball = true;
  // Play
  double dribble_m = 3, touch_gap_s = 0.5, double_touch_s = 0.3, take_m = 0.5;
  double goal_area_s = 2, penalty_area_s = 10;
  int attackers = 1, defenders = 1;
  double push_Ns = 15, push_mps = 0.5;
  int pushes_per_card = 3;
  double scrum_s = 10, scrum_m = 0.3, scrum_robot_m = 0.6, stuck_s = 20;
  // Robots that leave
  double second_yellow_s = 90, repair_s = 20;
  bool repair_ends = true;
  double tilt_rad = 1;
  double bench_m = 1.6;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"half", "s", "Length of a half.", 1, 1e5, Field::tunable}, s.half_s);
    visit(Field{"break", "s", "Length of the break between parts of the game.", 0, 1e5, Field::tunable},
          s.break_s);
    visit(Field{"overtime", "s", "Length of a half of the overtime after a draw; 0: none.", 0, 1e5},
          s.overtime_s);
    visit(Field{"shootout", "1", "Penalty kicks of each team that decide a draw; 0: none.", 0, 100},
          s.shootout);
    visit(Field{"shootout_limit", "1", "Penalty kicks of each team after which a draw stands.", 1, 1000},
          s.shootout_limit);
    visit(Field{"stop_clock", "", "Whether the clock stands while the game is stopped."}, s.stop_clock);
    visit(Field{"players", "1", "Robots of a team that may take part at once.", 1, 11}, s.players);
    visit(Field{"goalkeeper", "1", "Number of the goalkeeper in the team.", 0, 99}, s.goalkeeper);
    visit(Field{"substitutions", "1", "Robots that a team may exchange in a game.", 0, 1000},
          s.substitutions);
    visit(Field{"stop_time", "s", "Time between the stop and the word for the set piece.", 0, 100}, s.stop_s);
    visit(Field{"prepare_min", "s", "Least time between the word for the set piece and the start.", 0, 100},
          s.prepare_min_s);
    visit(Field{"prepare_max", "s", "Time after which a set piece starts although robots are not ready.", 0,
                1000},
          s.prepare_max_s);
    visit(
        Field{"prepare_kickoff", "s",
              "The same of a kick-off, to which robots may come from the other side of the field.", 0, 1000},
        s.prepare_kickoff_s);
    visit(Field{"take_time", "s", "Time after which a ball that nobody moved is in play.", 0.1, 1000},
          s.take_s);
    visit(Field{"penalty_time", "s", "Time to take a penalty kick.", 0.1, 1000}, s.penalty_s);
    visit(Field{"in_play", "m", "Way of the ball after which a set piece is taken.", 0, 10}, s.in_play_m);
    visit(Field{"opponents", "m", "Distance of opponents from the ball at a set piece.", 0, 20},
          s.opponents_m);
    visit(Field{"teammates", "m", "Distance of all team-mates but the taker from the ball at a set piece.", 0,
                20},
          s.teammates_m);
    visit(Field{"dropped_ball", "m", "Distance of all robots from a dropped ball.", 0, 20}, s.dropped_ball_m);
    visit(Field{"tolerance", "m", "Tolerance of distances and halves.", 0, 1}, s.tolerance_m);
    visit(Field{"ready_speed", "m/s", "Speed below which a robot stands.", 0, 10}, s.ready_mps);
    visit(
        Field{"retakes", "1",
              "Repetitions of a set piece after violations, before it goes to the other team or on.", 0, 100},
        s.retakes);
    visit(Field{"goal_from_kickoff", "", "Whether a goal straight from a kick-off counts."},
          s.goal_from_kickoff);
    visit(Field{"goal_from_throw_in", "", "Whether a goal straight from a throw-in counts."},
          s.goal_from_throw_in);
    visit(Field{"goal_from_free_kick", "", "Whether a goal straight from a free kick counts."},
          s.goal_from_free_kick);
    visit(Field{"goal_from_corner", "", "Whether a goal straight from a corner kick counts."},
          s.goal_from_corner);
    visit(Field{"goal_from_goal_kick", "", "Whether a goal straight from a goal kick counts."},
          s.goal_from_goal_kick);
    visit(Field{"goal_from_dropped_ball", "", "Whether a goal of the first robot at a dropped ball counts."},
          s.goal_from_dropped_ball);
    visit(Field{"dribble", "m", "Way from where a robot got the ball on which it may keep it.", 0.1, 1000},
          s.dribble_m);
    visit(Field{"touch_gap", "s", "Time without a touch after which a robot has lost the ball.", 0, 100},
          s.touch_gap_s);
    visit(Field{"double_touch", "s",
                "Time without a touch after which the taker's next touch is a second one.", 0, 100},
          s.double_touch_s);
    visit(Field{"take", "m", "Way on which the taker of a set piece may push the ball.", 0, 100}, s.take_m);
    visit(Field{"goal_area_time", "s", "Time for which a field player may be in a goal area.", 0, 1000},
          s.goal_area_s);
    visit(Field{"penalty_area_time", "s",
                "Time for which too many robots of a team may be in a penalty area.", 0, 1000},
          s.penalty_area_s);
    visit(Field{"attackers", "1", "Robots of a team that may be in the other team's penalty area.", 0, 11},
          s.attackers);
    visit(Field{"defenders", "1", "Field players that may be in their own penalty area.", 0, 11},
          s.defenders);
    visit(Field{"push", "Ns", "Impulse on a robot of the other team, within about a second, that is a foul.",
                0.01, 1e6},
          s.push_Ns);
    visit(Field{"push_speed", "m/s",
                "Speed towards the other robot, and more than its own, of a robot that pushes.", 0, 100},
          s.push_mps);
    visit(Field{"pushes_per_card", "1",
                "Fouls of a robot for each of which many it is shown a yellow card; 0: never.", 0, 1000},
          s.pushes_per_card);
    visit(Field{"scrum_time", "s", "Time for which robots of two teams may block the ball.", 0.1, 1000},
          s.scrum_s);
    visit(Field{"scrum", "m", "Way within which the ball counts as blocked.", 0.01, 10}, s.scrum_m);
    visit(Field{"scrum_robot", "m", "Distance from the ball within which a robot takes part in a scrum.", 0.1,
                10},
          s.scrum_robot_m);
    visit(
        Field{"stuck_time", "s", "Time after which a ball that does not move is dropped again.", 0.1, 10000},
        s.stuck_s);
    visit(Field{"second_yellow", "s", "Time for which a robot is out after a second yellow card.", 0, 1e5},
          s.second_yellow_s);
    visit(Field{"repair", "s", "Least time for which a robot is out for repair.", 0, 1e5}, s.repair_s);
    visit(Field{"repair_ends", "", "Whether a robot comes back by itself when that time is over."},
          s.repair_ends);
    visit(Field{"tilt", "rad", "Tilt from which on a robot is taken out for repair.", 0.01, 4}, s.tilt_rad);
    visit(Field{"bench", "m", "Distance from the touch line of the places for robots that are out.", 0, 100},
          s.bench_m);
  }
};

}  // namespace sandlot::soccer
