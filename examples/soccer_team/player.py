#!/usr/bin/env python3
"""A robot of a football team: to the ball, with it towards the goal, kick. Senses at the level of objects.

The run starts it (team.yaml). Its parts, from the outside in: the loop at the end, `Player`, which knows whether the game runs and
where ball and goals were seen last, and `play`, which decides. Change `play` first.
"""
import math
import re

REACH_M = 0.42      # the ball is between the arms
OFF_M = 3.3         # from a ball that others put into play
CLOSE_M = 2.5       # robots other than the striker go to a ball this near
KICK_IMPULSE = 4.0  # N s: a ball of 0.43 kg leaves with 9 m/s
STRIKER, KEEPER = 2, 1
STAND = (0.0, 0.0, 0.0)


def play(number, ball, goal):
    """What to do.

    ball, goal: (bearing [rad], range [m]) seen from the robot, or None where it is not known
    @return (ahead [m/s], left [m/s], turn [rad/s]), whether to hold the ball, whether to kick
    """
    if number == KEEPER:
        return ((0.0, 0.0, 2.0 * ball[0]) if ball else STAND), True, False
    if ball is None:
        return (0.0, 0.0, 1.5), False, False
    bearing, distance = ball
    if number != STRIKER and distance > CLOSE_M:
        return (0.0, 0.0, 2.0 * bearing), False, False
    if goal is None:
        return (0.0, 0.0, 1.5), True, False
    aim = goal[0]
    if distance < REACH_M and abs(bearing) < 0.3:
        if abs(aim) < max(0.08, math.atan2(0.8, goal[1])):
            return (1.0, 0.0, 2.0 * aim), False, True
        return (0.2, 0.0, max(-1.2, min(1.2, 2.0 * aim))), True, False
    # From behind the ball: a point on the line from the goal through it, and around the ball where that lies in the way.
    ball_x, ball_y = distance * math.cos(bearing), distance * math.sin(bearing)
    to_x, to_y = goal[1] * math.cos(aim) - ball_x, goal[1] * math.sin(aim) - ball_y
    away = max(0.01, math.hypot(to_x, to_y))
    side = turn_to(math.atan2(to_y, to_x) - bearing)  # 0: the ball lies between robot and goal
    if abs(side) < 0.3:
        x, y = ball_x, ball_y
    else:
        x, y = ball_x - 0.7 * to_x / away, ball_y - 0.7 * to_y / away
        if abs(side) > 1.6 and distance < 1.2:
            step = 0.9 if side > 0 else -0.9  # sideways first
            x, y = x + step * math.sin(bearing), y - step * math.cos(bearing)
    gap = math.hypot(x, y)
    speed = min(2.0, 0.3 + 1.2 * gap) / max(gap, 0.01)
    return (speed * x, speed * y, 3.0 * (aim if abs(side) < 0.3 else bearing)), True, False


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
        self.running, self.keeps_off = not has_referee, False
        self.attacks_positive_x = self.team == "cyan"
        self.ball, self.goals = Memory(0.8), {"goal_cyan": Memory(1.0), "goal_magenta": Memory(1.0)}

    def learn(self, state):
        """What the referee says: whether the ball may be played, whose set piece it is, and which way the team plays."""
        self.running = state["phase"] == "running"
        takes = state["team"] == self.team and self.number == STRIKER
        self.keeps_off = state["phase"] == "preparing" and not takes
        for team in state["teams"]:
            if team["name"] == self.team:
                self.attacks_positive_x = team["attacks_positive_x"]

    def look(self, now_s, objects):
        for thing in sorted(objects, key=lambda each: -each["range"]):
            if thing["label"] == "ball":
                self.ball.see(now_s, (thing["bearing"], thing["range"]))
            elif thing["label"] in self.goals:
                self.goals[thing["label"]].see(now_s, (thing["bearing"], thing["range"]))

    def decide(self, now_s):
        ball = self.ball.at(now_s)
        if not self.running:
            if not self.keeps_off or ball is None or ball[1] > OFF_M:
                return STAND, False, False
            return (-math.cos(ball[0]), -math.sin(ball[0]), 0.0), False, False
        goal = self.goals["goal_magenta" if self.attacks_positive_x else "goal_cyan"]
        return play(self.number, ball, goal.at(now_s))


def main():
    from sandlot_client import Robot
    with Robot() as robot:
        player = Player(robot.name, has_referee="/" + robot.name + "/referee/state" in robot.topics())
        eye = robot.subscribe("eye/objects")
        state = None if player.running else robot.subscribe("referee/state")
        holds = None
        for step in robot.steps():
            if state is not None and state.fresh():
                player.learn(state.message)
            if eye.fresh():
                player.look(step.time_s, eye.message["objects"])
            (ahead, left, turn), hold, kick = player.decide(step.time_s)
            robot.command("drive", {"linear": {"x": ahead, "y": left}, "angular": {"z": turn}})
            if hold != holds:
                robot.command("handler", {"data": 1.0 if hold else 0.0})
                holds = hold
            if kick:
                robot.command("kicker", {"data": KICK_IMPULSE})


if __name__ == "__main__":
    main()
