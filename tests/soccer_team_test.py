#!/usr/bin/env python3
"""The decisions of the Python team in examples/soccer_team: what it does with a ball, a goal and the words of the referee."""
import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "examples" / "soccer_team"))
import player


def state(phase, team="", attacks=True):
    return {"phase": phase, "team": team, "teams": [{"name": "cyan", "attacks_positive_x": attacks}]}


class SoccerTeam(unittest.TestCase):
    def seeing(self, name, ball, goal, words):
        one = player.Player(name)
        one.learn(words)
        one.look(1.0, [{"label": "ball", "bearing": ball[0], "range": ball[1]},
                       {"label": "goal_magenta", "bearing": goal[0], "range": goal[1]}])
        return one.decide(1.0)

    def test_stands_until_the_game_runs(self):
        self.assertEqual(self.seeing("cyan2", (0, 1), (0, 9), state("stopped")), (player.STAND, False, False))
        self.assertGreater(self.seeing("cyan2", (0, 1), (0, 9), state("running"))[0][0], 0.5)

    def test_kicks_only_a_ball_in_its_arms_and_at_the_goal(self):
        self.assertTrue(self.seeing("cyan2", (0, 0.35), (0.02, 9), state("running"))[2])
        self.assertFalse(self.seeing("cyan2", (0, 0.6), (0.02, 9), state("running"))[2])
        self.assertFalse(self.seeing("cyan2", (0, 0.35), (0.5, 9), state("running"))[2])

    def test_goes_around_a_ball_that_lies_behind_it(self):
        (ahead, left, _), _, kick = self.seeing("cyan2", (math.pi, 0.8), (0, 9), state("running"))
        self.assertFalse(kick)
        self.assertGreater(abs(left), 0.3, "not straight over the ball: ahead %g" % ahead)

    def test_keeps_off_the_set_pieces_of_others(self):
        self.assertLess(self.seeing("cyan2", (0, 2), (0, 9), state("preparing", "magenta"))[0][0], -0.5)
        self.assertLess(self.seeing("cyan3", (0, 2), (0, 9), state("preparing", "cyan"))[0][0], -0.5)
        self.assertEqual(self.seeing("cyan2", (0, 2), (0, 9), state("preparing", "cyan"))[0], player.STAND)

    def test_plays_the_other_way_after_half_time(self):
        one = player.Player("cyan2")
        one.learn(state("running", attacks=False))
        one.look(1.0, [{"label": "ball", "bearing": 0, "range": 0.35}, {"label": "goal_cyan", "bearing": 0, "range": 9},
                       {"label": "goal_magenta", "bearing": 2, "range": 9}])
        self.assertTrue(one.decide(1.0)[2])

    def test_forgets_a_ball_it_has_not_seen_for_long(self):
        one = player.Player("cyan2")
        one.learn(state("running"))
        one.look(1.0, [{"label": "ball", "bearing": 0, "range": 3}])
        one.look(9.0, [{"label": "goal_magenta", "bearing": 0, "range": 9}])
        self.assertEqual(one.decide(9.0)[0], (0.0, 0.0, 1.5))


if __name__ == "__main__":
    unittest.main()
