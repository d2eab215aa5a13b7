#!/usr/bin/env python3
"""A robot of a football team: to the ball, with it towards the goal, kick. Senses at the level of objects.

The run starts it (team.yaml). Its parts, from the outside in: the loop at the end, `Player`, which knows what the referee said and
where ball and goals were seen last, and `play`, which decides while the ball is in play. Change `play` first.
"""
import math
import re

REACH_M = 0.42      # the ball is between the arms
OFF_M = 3.3         # from a ball that the other team puts into play
OFF_OURS_M = 2.3    # that a team-mate puts into play
CLOSE_M = 2.5       # robots other than the striker go to a ball this near
SHOT_M = 7.0        # from the goal; farther away a kick need not be so exact: it is a pass to the front
AIM_FAR = 0.25      # rad
KICK_IMPULSE = 4.0  # N s: a ball of 0.43 kg leaves with 9 m/s
TAP_IMPULSE = 0.8   # N s, to take a set piece: the striker runs after the ball
WAIT_M = 0.8        # from the ball, until a set piece may be taken
HOME_M = 1.5        # the keeper's distance from the middle of its goal
FAR_M = 20.0        # of a goal that is not seen: where the compass says
KEEPER, STRIKER, TAKER = 1, 2, 3
STAND = (0.0, 0.0, 0.0)


def play(number, ball, goal):
    """What to do.

    ball, goal: (bearing [rad], range [m]) seen from the robot; ball is None where it is not known
    @return (ahead [m/s], left [m/s], turn [rad/s]), whether to hold the ball, whether to kick
    """
    if ball is None:
        return (0.0, 0.0, 1.5), False, False
    bearing, distance = ball
    if number != STRIKER and distance > CLOSE_M:
        return (0.0, 0.0, 2.0 * bearing), False, False
    aim = goal[0]
    if distance < REACH_M and abs(bearing) < 0.3:
        if abs(aim) < (AIM_FAR if goal[1] > SHOT_M else math.atan2(0.8, goal[1])):
            return (1.0, 0.0, 2.0 * aim), False, True
        return (0.2, 0.0, max(-1.2, min(1.2, 2.0 * aim))), True, False
    return behind(ball, goal), True, False


def behind(ball, goal, gap_m=0.0):
    """To a point on the line from the goal through the ball, so far behind it, and around the ball where that lies in the way."""
    (bearing, distance), aim = ball, goal[0]
    ball_x, ball_y = distance * math.cos(bearing), distance * math.sin(bearing)
    to_x, to_y = goal[1] * math.cos(aim) - ball_x, goal[1] * math.sin(aim) - ball_y
    away = max(0.01, math.hypot(to_x, to_y))
    side = turn_to(math.atan2(to_y, to_x) - bearing)  # 0: the ball lies between robot and goal
    if abs(side) < 0.3:
        x, y = ball_x - gap_m * to_x / away, ball_y - gap_m * to_y / away
    else:
        back_m = max(0.7, gap_m)
        x, y = ball_x - back_m * to_x / away, ball_y - back_m * to_y / away
        if abs(side) > 1.6 and distance < 1.2:
            step = 0.9 if side > 0 else -0.9  # sideways first
            x, y = x + step * math.sin(bearing), y - step * math.cos(bearing)
    gap = math.hypot(x, y)
    if gap < 0.1:
        return 0.0, 0.0, 3.0 * aim
    speed = min(2.0, 0.3 + 1.2 * gap) / max(gap, 0.01)
    return speed * x, speed * y, 3.0 * (aim if abs(side) < 0.3 else bearing)


def towards(sight):
    """To what was seen there."""
    speed = min(2.0, 0.3 + sight[1])
    return speed * math.cos(sight[0]), speed * math.sin(sight[0]), 2.0 * sight[0]


def away_from(sight):
    """Straight away from what was seen there."""
    return -math.cos(sight[0]), -math.sin(sight[0]), 0.0


def turn_to(angle):
    """The same angle in [-pi, pi]."""
    return math.atan2(math.sin(angle), math.cos(angle))


class Memory:
    """The last sight of a thing; nothing after it has not been seen for a while."""

    def __init__(self, kept_s):
        self.kept_s, self.seen_s, self.sight = kept_s, -math.inf, None

    def see(self, now_s, sight):
        self.seen_s, self.sight = now_s, sight

    def at(self, now_s):
        return self.sight if now_s - self.seen_s <= self.kept_s else None


class Player:
    """What the robot knows of the game."""

    def __init__(self, name, has_referee=True):
        self.number = int(re.search(r"\d+$", name).group())
        self.team = name[:-len(str(self.number))]
        self.phase, self.set_piece, self.is_ours, self.in_play = "stopped" if has_referee else "running", "", False, True
        self.attacks_positive_x = self.team == "cyan"
        self.heading = 0.0
        self.ball, self.goals = Memory(0.8), {"goal_cyan": Memory(1.0), "goal_magenta": Memory(1.0)}

    def learn(self, state):
        """What the referee says: whether the ball may be played, whose set piece it is, and which way the team plays."""
        self.phase, self.set_piece, self.in_play = state["phase"], state["set_piece"], state["in_play"]
        self.is_ours = state["team"] == self.team
        for team in state["teams"]:
            if team["name"] == self.team:
                self.attacks_positive_x = team["attacks_positive_x"]

    def look(self, now_s, objects):
        for thing in sorted(objects, key=lambda each: -each["range"]):
            # The eye is high above the ball: along the ground it is nearer than its range.
            sight = thing["bearing"], thing["range"] * math.cos(thing["elevation"])
            if thing["label"] == "ball":
                self.ball.see(now_s, sight)
            elif thing["label"] in self.goals:
                self.goals[thing["label"]].see(now_s, sight)

    def decide(self, now_s):
        """@return velocity as of play(), whether to hold the ball, impulse of the kick [N s]"""
        ball = self.ball.at(now_s)
        goal, home = self.goal(now_s, self.attacks_positive_x), self.goal(now_s, not self.attacks_positive_x)
        if self.phase == "stopped":
            return STAND, False, 0.0
        if self.number == KEEPER:
            return self.keep(ball, home), True, 0.0
        if self.is_ours and self.number == TAKER and self.set_piece not in ("", "dropped_ball"):
            return self.take(ball, goal)
        if self.phase == "preparing" or not self.in_play:
            return self.keep_off(ball, goal, home), False, 0.0
        velocity, hold, kick = play(self.number, ball, goal)
        return velocity, hold, KICK_IMPULSE if kick else 0.0

    def goal(self, now_s, at_positive_x):
        """Bearing and range of a goal, by the compass where it is not seen."""
        seen = self.goals["goal_magenta" if at_positive_x else "goal_cyan"].at(now_s)
        return seen or (turn_to((0.0 if at_positive_x else math.pi) - self.heading), FAR_M)

    def keep(self, ball, home):
        """Of the goalkeeper: near its goal, towards the ball."""
        if home[1] > HOME_M:
            return towards(home)
        return (0.0, 0.0, 2.0 * ball[0]) if ball else STAND

    def take(self, ball, goal):
        """A set piece of ours: behind the ball; then a tap, and nothing more until somebody else has touched it."""
        if self.in_play:
            return STAND, False, 0.0
        if ball is None:
            return (0.0, 0.0, 1.5), False, 0.0
        if self.phase == "preparing":
            if ball[1] < WAIT_M - 0.15:
                return away_from(ball), False, 0.0
            return behind(ball, goal, WAIT_M), False, 0.0
        at_ball = ball[1] < REACH_M and abs(ball[0]) < 0.3
        return behind(ball, goal), False, TAP_IMPULSE if at_ball else 0.0

    def keep_off(self, ball, goal, home):
        """Away from a ball that is put into play; at a kick-off in the own half."""
        off_m = OFF_OURS_M if self.is_ours else OFF_M
        if ball and ball[1] < off_m:
            return away_from(ball)
        if self.is_ours and self.number == STRIKER and ball and ball[1] > off_m + 0.3:
            return towards(ball)
        if self.set_piece == "kickoff" and home[1] > goal[1] - 2.0:
            return towards(home)
        return STAND


def main():
    from sandlot_client import Robot
    with Robot() as robot:
        has_referee = "/" + robot.name + "/referee/state" in robot.topics()
        player = Player(robot.name, has_referee)
        eye, compass = robot.subscribe("eye/objects"), robot.subscribe("compass")
        state = robot.subscribe("referee/state") if has_referee else None
        holds = None
        for step in robot.steps():
            if state is not None and state.fresh():
                player.learn(state.message)
            if compass.fresh():
                player.heading = compass.message["data"]
            if eye.fresh():
                player.look(step.time_s, eye.message["objects"])
            (ahead, left, turn), hold, impulse = player.decide(step.time_s)
            robot.command("drive", {"linear": {"x": ahead, "y": left}, "angular": {"z": turn}})
            if hold != holds:
                robot.command("handler", {"data": 1.0 if hold else 0.0})
                holds = hold
            if impulse > 0:
                robot.command("kicker", {"data": impulse})


if __name__ == "__main__":
    main()
