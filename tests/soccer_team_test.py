#!/usr/bin/env python3
"""The decisions of the Python team in examples/soccer_team: what it does with a ball, a goal and the words of the referee."""
import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "examples" / "soccer_team"))
import player


def state(phase, team="", attacks=True, set_piece="", in_play=None):
    return {"phase": phase, "team": team, "teams": [{"name": "cyan", "attacks_positive_x": attacks}],
            "set_piece": set_piece or ("free_kick" if team else ""), "in_play": phase == "running" and not team if in_play is None else in_play}


class SoccerTeam(unittest.TestCase):
    def seeing(self, name, ball, goal, words, home=None, mates=(), before=None):
        """What a robot does that sees this and hears so far the ball is from mates."""
        one = before or player.Player(name)
        one.learn(words)
        one.hear(1.0, mates)
        if ball == player.HELD:
            one.feel(1.0, True)
            ball = None
        seen = {"ball": ball, "goal_magenta": goal, "goal_cyan": home}
        one.look(1.0, [{"label": label, "bearing": at[0], "range": at[1], "elevation": 0.0} for label, at in seen.items() if at])
        return one.decide(1.0)

    def test_stands_until_the_game_runs(self):
        self.assertEqual(self.seeing("cyan2", (0, 1), (0, 9), state("stopped")), (player.STAND, False, 0.0))
        self.assertGreater(self.seeing("cyan2", (0, 1), (0, 9), state("running"))[0][0], 0.5)

    def test_kicks_only_a_ball_in_its_arms_and_at_the_goal(self):
        self.assertEqual(self.seeing("cyan2", player.HELD, (0.02, 9), state("running"))[2], player.KICK_IMPULSE)
        self.assertFalse(self.seeing("cyan2", (0, 0.6), (0.02, 9), state("running"))[2])
        self.assertFalse(self.seeing("cyan2", player.HELD, (0.5, 9), state("running"))[2])
        # 0.2 rad is good enough for a kick to the front, and wide of the goal from 6 m.
        self.assertTrue(self.seeing("cyan2", player.HELD, (0.2, 12.5), state("running"))[2])
        self.assertFalse(self.seeing("cyan2", player.HELD, (0.2, 6), state("running"))[2])

    def test_turns_to_a_ball_that_lies_behind_it_and_drives_to_one_far_away(self):
        (ahead, left, turn), hold, kick = self.seeing("cyan2", (2.5, 0.8), (0, 9), state("running"))
        self.assertEqual((ahead, left, hold, kick), (0, 0, True, 0))
        self.assertGreater(turn, 1)
        (ahead, left, turn), _, kick = self.seeing("cyan2", (2.5, 3), (0, 9), state("running"))
        self.assertAlmostEqual(math.atan2(left, ahead), 2.5)
        self.assertAlmostEqual(math.hypot(left, ahead), player.SPEED_MPS)

    def test_goes_around_the_ball_of_a_set_piece(self):
        ahead, left, _ = player.behind((math.pi, 0.8), (0, 9))
        self.assertGreater(abs(left), 0.3, "not straight over the ball: ahead %g" % ahead)

    def test_the_nearest_of_the_team_goes_and_the_others_wait_around(self):
        one = player.Player("cyan2")
        one.learn(state("running"))
        one.look(1.0, [{"label": "ball", "bearing": 0, "range": 4, "elevation": 0.0}, {"label": "goal_cyan", "bearing": math.pi, "range": 6, "elevation": 0.0}])
        self.assertEqual(one.tell(1.0), "4.00")
        goes = one.decide(1.0)
        self.assertGreater(goes[0][0], 2)
        for packet in (("magenta3", "1.0"), ("cyan3", "5.0"), ("cyan1", "0.5"), ("cyan2", "1.0"), ("cyan4", "y"), ("", "1"), ("cyan3", "")):
            one.hear(1.0, [packet])
            self.assertEqual(one.decide(1.0), goes, packet)
        one.hear(1.0, [("cyan3", "3.5")])
        (ahead, left, _), hold, kick = one.decide(1.0)
        # 3 m from the ball, at 0.8 (2 - 3.5) rad from the direction to the own goal, which is pi.
        x, y = 4 + 3 * math.cos(math.pi - 1.2), 3 * math.sin(math.pi - 1.2)
        self.assertAlmostEqual(math.atan2(left, ahead), math.atan2(y, x))
        self.assertEqual((hold, kick), (False, 0))
        # What was said a while ago counts no more.
        self.assertTrue(one.is_nearest(1.0 + player.NEWS_S, 4))

    def test_shoots_past_who_stands_before_the_goal(self):
        goal, side = (0.1, 5.0), math.atan2(player.CORNER_M, 5.0)
        self.assertAlmostEqual(player.free_corner(goal, []), 0.1)
        self.assertAlmostEqual(player.free_corner(goal, [(0.1, 7.0)]), 0.1, msg="one behind the goal is in nobody's way")
        self.assertAlmostEqual(player.free_corner(goal, [(0.12, 4.0)]), 0.1 - side)
        self.assertAlmostEqual(player.free_corner(goal, [(0.08, 4.0)]), 0.1 + side)

    def test_keeps_off_the_set_pieces_of_others(self):
        self.assertLess(self.seeing("cyan2", (0, 2), (0, 9), state("preparing", "magenta"))[0][0], -0.5)
        # Of its own team the nearest takes it; robots 2 and 3 wait near.
        def ours(name, ball):
            return self.seeing(name, ball, (0, 9), state("preparing", "cyan"), mates=[("cyan5", "0.8")])[0]
        self.assertLess(ours("cyan2", (0, 2))[0], -0.5)
        self.assertGreater(ours("cyan2", (0, 6))[0], 0.5)
        self.assertEqual(ours("cyan2", (0, 2.4)), player.STAND)
        self.assertEqual(ours("cyan4", (0, 6)), player.STAND)
        self.assertLess(self.seeing("cyan2", (0, 2), (0, 9), state("running", "magenta"))[0][0], -0.5, "it is not in play yet")

    def test_taps_its_own_set_pieces_and_leaves_the_ball_to_the_others(self):
        def takes(ball, phase, in_play=False, before=None):
            return self.seeing("cyan3", ball, (0, 9), state(phase, "cyan", in_play=in_play), before=before)
        self.assertGreater(takes((0, 2), "preparing")[0][0], 0.5)
        self.assertEqual(takes((0, player.WAIT_M), "preparing")[0][0], 0.0)
        self.assertLess(takes((0, 0.5), "preparing")[0][0], -0.5, "too near to the ball before the start")
        self.assertEqual(takes(player.HELD, "running")[2], player.TAP_IMPULSE)
        taker = player.Player("cyan3")
        self.assertEqual(takes(player.HELD, "running", before=taker)[2], player.TAP_IMPULSE)
        self.assertEqual(taker.tell(1.0), "0.34")
        self.assertEqual(takes(player.HELD, "running", in_play=True, before=taker), (player.STAND, False, 0.0))
        self.assertEqual(taker.tell(1.0), "", "the ball is not its own now")
        # As soon as another one has touched it, it plays like everybody.
        self.assertEqual(self.seeing("cyan3", player.HELD, (0, 9), state("running", "", in_play=True))[2], player.KICK_IMPULSE)

    def test_goes_to_its_own_half_for_a_kick_off(self):
        words = state("preparing", "magenta", set_piece="kickoff")
        self.assertGreater(self.seeing("cyan2", (0, 6), (math.pi, 5), words, home=(0, 17))[0][0], 1)
        self.assertEqual(self.seeing("cyan2", (0, 6), (math.pi, 17), words, home=(0, 5))[0], player.STAND)

    def test_the_keeper_stays_before_its_goal(self):
        self.assertGreater(self.seeing("cyan1", (1, 6), (math.pi, 5), state("running"), home=(0, 17))[0][0], 1)
        # A goal that is not seen is where the compass says: behind a robot that looks at the other one.
        self.assertLess(self.seeing("cyan1", (1, 6), (0, 5), state("running"))[0][0], -1)
        # On the line from the goal, 1 m to the left, to the ball: from there the ball lies to the right and ahead.
        ahead, left, turn = self.seeing("cyan1", (0, 6), (math.pi, 20), state("running"), home=(math.pi / 2, 1))[0]
        length = math.hypot(6, 1)
        self.assertAlmostEqual(math.atan2(left, ahead), math.atan2(1 - 1 / length, 6 / length))
        at_home = self.seeing("cyan1", (0, 6), (math.pi, 20), state("running"), home=(math.pi, player.HOME_M))[0]
        self.assertEqual(at_home, player.STAND)
        self.assertEqual(self.seeing("cyan1", player.HELD, (math.pi, 20), state("running"), home=(math.pi, 1))[2], player.KICK_IMPULSE)

    def test_plays_the_other_way_after_half_time(self):
        one = player.Player("cyan2")
        one.learn(state("running", attacks=False))
        one.feel(1.0, True)
        one.look(1.0, [{"label": "goal_cyan", "bearing": 0, "range": 9, "elevation": 0.0}, {"label": "goal_magenta", "bearing": 2, "range": 9, "elevation": 0.0}])
        self.assertTrue(one.decide(1.0)[2])

    def test_takes_the_distance_along_the_ground_from_an_eye_above_the_ball(self):
        one = player.Player("cyan2")
        one.learn(state("running"))
        one.look(1.0, [{"label": "ball", "bearing": 0, "range": 1.22, "elevation": -0.61}])
        self.assertAlmostEqual(one.sight_of_ball(1.0)[1], 1.0, delta=0.01)

    def test_the_ball_in_its_arms_is_felt_and_not_seen(self):
        one = player.Player("cyan2")
        one.feel(1.0, True)
        one.look(1.0, [{"label": "ball", "bearing": 2, "range": 3, "elevation": 0.0}])
        self.assertEqual(one.sight_of_ball(1.0), player.HELD)
        one.feel(1.04, False)
        bearing, distance = one.sight_of_ball(1.04)
        self.assertAlmostEqual(bearing, 0)
        self.assertAlmostEqual(distance, player.HELD[1])

    def test_follows_a_rolling_ball_while_it_moves_and_turns(self):
        # The robot turns left at 0.5 rad/s and drives ahead at 1 m/s; the ball rolls north at 1.5 m/s, 3 m east at first.
        ball, heading, x, y, dt = player.Ball(), 0.0, 0.0, 0.0, 0.04
        for k in range(100):
            now_s = k * dt
            ball.move(now_s, heading, (1.0, 0.0, 0.5))
            off_x, off_y = 3 - x, 1.5 * now_s - y
            ball.see(now_s, heading, (math.atan2(off_y, off_x) - heading, math.hypot(off_x, off_y)))
            x, y, heading = x + dt * math.cos(heading), y + dt * math.sin(heading), heading + 0.5 * dt
        ahead, left = ball.rolls(0.0)
        # It believes that a ball loses a quarter of its speed in a second. Against these 0.375 m/s2 work 2.5 per step of what
        # it sees farther away, 6 mm; of these 0.45 per step, 0.07 m/s, are missing in the speed.
        self.assertAlmostEqual(ahead, 0.0, delta=0.05)
        self.assertAlmostEqual(left, 1.5, delta=0.1)
        self.assertAlmostEqual(ball.sight(now_s, 0.0)[1], math.hypot(off_x, off_y), delta=0.05)

    def test_goes_with_a_ball_that_rolls_away(self):
        (ahead, left, _), _, _ = player.play((0, 1.0), (0, 9), rolls=(0.5, 0.3))
        still = player.play((0, 1.0), (0, 9))[0]
        self.assertAlmostEqual(ahead - still[0], 0.5)
        self.assertAlmostEqual(left - still[1], 0.3)
        self.assertAlmostEqual(math.hypot(*player.play((0, 5.0), (0, 9), rolls=(3, 1))[0][:2]), player.SPEED_MPS)

    def test_drives_around_robots_and_brakes_before_them(self):
        free = (2.0, 0.3, 0.0)
        self.assertEqual(player.past(free, [(0.0, 3.0), (2.5, 0.5)], 0.65), free, "far away, or behind it")
        ahead, left, _ = player.past(free, [(0.0, 0.65)], 0.65)
        self.assertAlmostEqual(ahead, 0.0)
        self.assertAlmostEqual(left, 2.3)
        # From the speed that is left it stops within the gap: v^2 / (2 a).
        ahead, _, _ = player.past(free, [(0.0, 1.0)], 0.65)
        self.assertLess(ahead ** 2 / (2 * player.SPEED_MPS2), 0.35)

    def test_changes_its_velocity_no_faster_than_the_handler_holds_a_ball(self):
        self.assertEqual(player.smooth((1.0, 0.0, 0.0), (1.05, 0.0, 0.1), 0.04), (1.05, 0.0, 0.1))
        ahead, left, turn = player.smooth((2.0, 0.0, 0.0), (0.0, 2.0, 4.0), 0.04)
        self.assertAlmostEqual(math.hypot(ahead - 2, left), 0.04 * player.SPEED_MPS2)
        self.assertAlmostEqual(turn, 0.04 * player.TURN_RADPS2)

    def test_forgets_a_ball_it_has_not_seen_for_long(self):
        one = player.Player("cyan2")
        one.learn(state("running"))
        one.look(1.0, [{"label": "ball", "bearing": 0, "range": 3, "elevation": 0.0}])
        one.look(9.0, [{"label": "goal_magenta", "bearing": 0, "range": 9, "elevation": 0.0}])
        self.assertEqual(one.decide(9.0)[0], (0.0, 0.0, 1.5))


if __name__ == "__main__":
    unittest.main()
