#!/usr/bin/env python3
"""A robot of a football team: to the ball, with it towards the goal, kick. Senses at the level of objects.

The run starts it (team.yaml). Its parts, from the outside in: the loop at the end, `Player`, which knows what the referee said and
where ball and goals were seen last, and `play`, which decides while the ball is in play. Change `play` first.
"""
import math
import re

REACH_M = 0.42      # the ball is between the arms
HELD = (0.0, 0.335) # where the handler holds it. The eye does not see a ball this near: the handler says that it is there
NEAR_M = 0.9        # from a ball, that only its arms should touch
ROBOT_M = 0.65      # from a robot: nearer would be pushing
SPEED_MPS = 2.8
SPEED_MPS2, TURN_RADPS2 = 2.5, 12.0  # the handler holds a ball no faster than that
TURN_RADPS = 4.0
TURN_WITH_BALL_RADPS = 2.0
OFF_M = 3.3         # from a ball that the other team puts into play
OFF_GOAL_M = 5.0    # from the goal at a penalty kick
OFF_OURS_M = 2.3    # that a team-mate puts into play
SUPPORT_M = 3.0     # from the ball: where those wait who do not run after it
SHOT_M = 12.0       # from the goal; farther away a kick need not be so exact: it is a pass to the front
AIM_FAR = 0.25      # rad
CORNER_M = 0.75     # from the middle of the goal: where shots go that pass a robot before it
KICK_IMPULSE = 4.0  # N s: a ball of 0.43 kg leaves with 9 m/s
TAP_IMPULSE = 0.8   # N s, to take a set piece: another one runs after the ball
TAKE_MPS = 0.6      # to the ball of a set piece
WAIT_M = 0.8        # from the ball, until a set piece may be taken
HOME_M = 1.0        # the keeper's distance from the middle of its goal
KEEPER_M = 1.5      # from the goal: a ball nearer belongs to the keeper
FAR_M = 20.0        # of a goal that is not seen: where the compass says
NEWS_S = 0.5        # how long what a team-mate said by radio counts
KEEPER = 1
STAND = (0.0, 0.0, 0.0)


def play(ball, goal, robots=(), rolls=(0.0, 0.0)):
    """What the robot does that has the ball, or is the nearest of its team to it.

    ball, goal, robots: (bearing [rad], range [m]) seen from the robot
    rolls: velocity of the ball, ahead and to the left of the robot [m/s]
    @return (ahead [m/s], left [m/s], turn [rad/s]), whether to hold the ball, whether to kick
    """
    bearing, distance = ball
    if distance < NEAR_M and abs(bearing) > 0.6:
        return (0.0, 0.0, limited(5.0 * bearing, TURN_RADPS)), True, False
    if distance > REACH_M or abs(bearing) > 0.3:
        ahead, left, turn = towards(ball)
        ahead, left = ahead + rolls[0], left + rolls[1]
        share = min(1.0, SPEED_MPS / max(0.01, math.hypot(ahead, left)))
        return (share * ahead, share * left, turn), True, False
    aim = free_corner(goal, robots)
    if abs(aim) < (AIM_FAR if goal[1] > SHOT_M else math.atan2(0.4, goal[1])):
        return (1.0, 0.0, 2.0 * aim), False, True
    return (0.2, 0.0, limited(3.0 * aim, TURN_WITH_BALL_RADPS)), True, False


def free_corner(goal, robots):
    """The bearing within the goal that is farthest from the robots before it; its middle where there are none."""
    def room(aim):
        return min([1.0] + [abs(turn_to(bearing - aim)) for bearing, distance in robots if distance < goal[1] + 0.5])
    side = math.atan2(CORNER_M, goal[1])
    return turn_to(max((goal[0], goal[0] + side, goal[0] - side), key=room))


def support(number, ball, home):
    """Between the ball and the own goal, each robot at a place of its own, looking at the ball."""
    ball_x, ball_y = vector(ball)
    home_x, home_y = vector(home)
    angle = math.atan2(home_y - ball_y, home_x - ball_x) + 0.8 * (number - 3.5)
    x, y = ball_x + SUPPORT_M * math.cos(angle), ball_y + SUPPORT_M * math.sin(angle)
    from_home = math.hypot(x - home_x, y - home_y)
    if from_home < SUPPORT_M:  # the goal area belongs to the keeper
        out = (SUPPORT_M - from_home) / max(0.01, from_home)
        x, y = x + out * (x - home_x), y + out * (y - home_y)
    return to_point(x, y, ball[0])


def behind(ball, goal, gap_m=0.0):
    """To a point on the line from the goal through the ball, so far behind it, and around the ball where that lies in the way."""
    (bearing, distance), aim = ball, goal[0]
    ball_x, ball_y = vector(ball)
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
    if math.hypot(x, y) < 0.1:
        return 0.0, 0.0, limited(3.0 * aim, TURN_RADPS)
    return to_point(x, y, aim if abs(side) < 0.3 else bearing)


def to_point(x, y, look):
    """To a point in the robot's frame, turning to where it looks [rad]."""
    gap = math.hypot(x, y)
    if gap < 0.1:
        return 0.0, 0.0, limited(3.0 * look, TURN_RADPS)
    speed = min(SPEED_MPS, 0.2 + braking(gap)) / gap
    return speed * x, speed * y, limited(3.0 * look, TURN_RADPS)


def towards(sight):
    """To what was seen there, so that it ends up between the arms."""
    gap = max(0.1, sight[1] - HELD[1])
    return to_point(*vector((sight[0], gap)), sight[0])


def away_from(sight):
    """Straight away from what was seen there."""
    return -math.cos(sight[0]), -math.sin(sight[0]), 0.0


def braking(gap_m):
    """The speed from which it stops within the gap."""
    return math.sqrt(max(0.0, 1.4 * SPEED_MPS2 * gap_m))


def past(velocity, things, gap_m):
    """The velocity, but around things (bearing, range) that it would bring nearer than gap_m."""
    ahead, left, turn = velocity
    for bearing, distance in things:
        x, y = math.cos(bearing), math.sin(bearing)
        too_fast = ahead * x + left * y - braking(distance - gap_m)
        if too_fast > 0:
            side = too_fast if left * x - ahead * y > 0 else -too_fast
            ahead, left = ahead - too_fast * x - side * y, left - too_fast * y + side * x
    return ahead, left, turn


def smooth(before, velocity, seconds):
    """The velocity, as near as the accelerations allow."""
    ahead, left, turn = (x - y for x, y in zip(velocity, before))
    most = SPEED_MPS2 * seconds
    share = min(1.0, most / max(1e-9, math.hypot(ahead, left)))
    return before[0] + share * ahead, before[1] + share * left, before[2] + limited(turn, TURN_RADPS2 * seconds)


def vector(sight):
    return sight[1] * math.cos(sight[0]), sight[1] * math.sin(sight[0])


def apart(one, other):
    """Distance of two things seen [m]."""
    (x, y), (u, v) = vector(one), vector(other)
    return math.hypot(x - u, y - v)


def turned(x, y, angle):
    return x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle)


def limited(x, most):
    return max(-most, min(most, x))


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


class Ball:
    """Where the ball is and how it rolls, from noisy sights of it. Offsets from the robot along the axes of the compass."""
    KEPT_S = 1.0  # without a sight

    def __init__(self):
        self.seen_s, self.at_s = -math.inf, 0.0
        self.x = self.y = self.vx = self.vy = 0.0

    def move(self, now_s, heading, velocity):
        """Time goes on, in which the robot has moved at (ahead, left, turn)."""
        dt, self.at_s = now_s - self.at_s, now_s
        east, north = turned(velocity[0], velocity[1], heading)
        self.x += (self.vx - east) * dt
        self.y += (self.vy - north) * dt
        slower = max(0.0, 1.0 - 0.25 * dt)
        self.vx, self.vy = slower * self.vx, slower * self.vy

    def see(self, now_s, heading, sight):
        x, y = turned(*vector(sight), heading)
        if now_s - self.seen_s > self.KEPT_S or math.hypot(x - self.x, y - self.y) > 0.5 + 0.2 * sight[1]:
            self.x, self.y, self.vx, self.vy = x, y, 0.0, 0.0
        else:
            self.vx, self.vy = self.vx + 2.5 * (x - self.x), self.vy + 2.5 * (y - self.y)
            self.x, self.y = self.x + 0.45 * (x - self.x), self.y + 0.45 * (y - self.y)
        self.seen_s = now_s

    def sight(self, now_s, heading):
        """Bearing and range; None where it has not been seen for a while."""
        if now_s - self.seen_s > self.KEPT_S:
            return None
        return turn_to(math.atan2(self.y, self.x) - heading), math.hypot(self.x, self.y)

    def rolls(self, heading):
        """Its velocity in the robot's frame [m/s]."""
        return turned(self.vx, self.vy, -heading)


class Player:
    """What the robot knows of the game."""

    def __init__(self, name, has_referee=True):
        self.number = int(re.search(r"\d+$", name).group())
        self.team = name[:-len(str(self.number))]
        self.phase, self.set_piece, self.is_ours, self.in_play = "stopped" if has_referee else "running", "", False, True
        self.attacks_positive_x = self.team == "cyan"
        self.heading = 0.0
        self.ball, self.goals = Ball(), {"goal_cyan": Memory(1.0), "goal_magenta": Memory(1.0)}
        self.robots, self.holds, self.took = [], False, False
        self.news = {}  # by number of a team-mate: when it spoke, and how far it was from the ball

    def learn(self, state):
        """What the referee says: whether the ball may be played, whose set piece it is, and which way the team plays."""
        self.phase, self.set_piece, self.in_play = state["phase"], state["set_piece"], state["in_play"]
        self.is_ours = state["team"] == self.team
        self.took = self.took and self.phase == "running" and self.set_piece != ""
        for team in state["teams"]:
            if team["name"] == self.team:
                self.attacks_positive_x = team["attacks_positive_x"]

    def tell(self, now_s):
        """What the others of the team should know: how far the ball is. Nothing where it is not seen, or may not be played."""
        ball = self.sight_of_ball(now_s)
        return "%.2f" % ball[1] if ball and not self.has_taken() else ""

    def hear(self, now_s, packets):
        """Everybody hears everybody: what is not from a team-mate is passed over."""
        for sender, text in packets:
            if not re.fullmatch(self.team + r"\d+", sender):
                continue
            try:
                self.news[int(sender[len(self.team):])] = now_s, float(text)
            except ValueError:
                pass

    def is_nearest(self, now_s, distance):
        return all((distance, self.number) < (other, number) for number, (heard_s, other) in self.news.items()
                   if now_s - heard_s < NEWS_S and number not in (KEEPER, self.number))

    def has_taken(self):
        """Whether it has played a set piece and may not touch the ball again before another robot has."""
        return self.took and self.in_play

    def sight_of_ball(self, now_s):
        return HELD if self.holds else self.ball.sight(now_s, self.heading)

    def feel(self, now_s, engaged):
        """What the handler says: whether it has the ball."""
        self.holds = engaged
        if engaged:
            self.ball.see(now_s, self.heading, HELD)

    def look(self, now_s, objects):
        self.robots = [(each["bearing"], each["range"] * math.cos(each["elevation"])) for each in objects if each["label"] == "robot"]
        for thing in sorted(objects, key=lambda each: -each["range"]):
            # The eye is high above the ball: along the ground it is nearer than its range.
            sight = thing["bearing"], thing["range"] * math.cos(thing["elevation"])
            if thing["label"] == "ball" and not self.holds:
                self.ball.see(now_s, self.heading, sight)
            elif thing["label"] in self.goals:
                self.goals[thing["label"]].see(now_s, sight)

    def decide(self, now_s):
        """@return velocity as of play(), whether to hold the ball, impulse of the kick [N s]"""
        ball = self.sight_of_ball(now_s)
        goal, home = self.goal(now_s, self.attacks_positive_x), self.goal(now_s, not self.attacks_positive_x)
        if self.phase == "stopped":
            return STAND, False, 0.0
        takes = self.is_ours and self.set_piece not in ("", "dropped_ball") and not self.in_play
        if takes and self.number != KEEPER and (ball is None or self.is_nearest(now_s, ball[1])):
            velocity, hold, impulse = self.take(ball, goal)
        elif self.phase == "preparing" or not self.in_play:
            velocity, hold, impulse = self.wait(ball, goal, home), False, 0.0
        elif self.number == KEEPER:
            velocity, hold, impulse = self.keep(ball, home), True, KICK_IMPULSE if ball == HELD else 0.0
        elif self.has_taken():
            velocity, hold, impulse = STAND, False, 0.0
        elif ball is None:
            velocity, hold, impulse = (0.0, 0.0, 1.5), False, 0.0
        elif self.is_nearest(now_s, ball[1]) and apart(ball, home) > KEEPER_M:
            velocity, hold, kick = play(ball, goal, self.robots, self.ball.rolls(self.heading))
            impulse = KICK_IMPULSE if kick else 0.0
        else:
            velocity, hold, impulse = support(self.number, ball, home), False, 0.0
        return past(velocity, self.robots, ROBOT_M), hold, impulse

    def goal(self, now_s, at_positive_x):
        """Bearing and range of a goal, by the compass where it is not seen."""
        seen = self.goals["goal_magenta" if at_positive_x else "goal_cyan"].at(now_s)
        return seen or (turn_to((0.0 if at_positive_x else math.pi) - self.heading), FAR_M)

    def keep(self, ball, home):
        """Of the goalkeeper: before its goal, on the line to the ball."""
        if ball is None:
            return towards(home) if home[1] > 1.5 * HOME_M else STAND
        ball_x, ball_y = vector(ball)
        home_x, home_y = vector(home)
        away = max(0.01, math.hypot(ball_x - home_x, ball_y - home_y))
        return to_point(home_x + HOME_M * (ball_x - home_x) / away, home_y + HOME_M * (ball_y - home_y) / away, ball[0])

    def take(self, ball, goal):
        """A set piece of ours: behind the ball; when the game runs, to it, and a tap."""
        if ball is None:
            return (0.0, 0.0, 1.5), False, 0.0
        if self.phase == "preparing":
            velocity = away_from(ball) if ball[1] < WAIT_M - 0.15 else behind(ball, goal, WAIT_M)
            return past(velocity, [ball], WAIT_M - 0.2), False, 0.0
        self.took = self.took or self.holds
        ahead, left, turn = behind(ball, goal)
        share = min(1.0, TAKE_MPS / max(0.01, math.hypot(ahead, left)))
        return (share * ahead, share * left, turn), not self.holds, TAP_IMPULSE if self.holds else 0.0

    def wait(self, ball, goal, home):
        """Away from a ball that is put into play; at a kick-off in the own half, at a penalty kick far from the goal."""
        if self.number == KEEPER:
            velocity, off_m = self.keep(ball, home), WAIT_M
        else:
            off_m = OFF_OURS_M if self.is_ours else OFF_M
            velocity = STAND
            if self.is_ours and self.number <= 3 and ball and ball[1] > off_m + 0.3:
                velocity = towards(ball)
            if self.set_piece == "kickoff" and home[1] > goal[1] - 2.0:
                velocity = towards(home)
            elif self.set_piece == "penalty" and min(home[1], goal[1]) < OFF_GOAL_M:
                velocity = away_from(home if home[1] < goal[1] else goal)
            elif ball and ball[1] < off_m:
                velocity = away_from(ball)
        return past(velocity, [ball], off_m) if ball else velocity


def main():
    from sandlot_client import Robot, data_of, packet
    with Robot() as robot:
        has_referee = "/" + robot.name + "/referee/state" in robot.topics()
        player = Player(robot.name, has_referee)
        eye, compass = robot.subscribe("eye/objects"), robot.subscribe("compass")
        handler = robot.subscribe("handler")
        radio, spoken_s = robot.subscribe("radio"), 0.0
        state = robot.subscribe("referee/state") if has_referee else None
        holds, velocity, before_s = None, STAND, 0.0
        for step in robot.steps():
            now_s = step.time_s
            player.ball.move(now_s, player.heading, velocity)
            if radio.fresh():
                player.hear(now_s, [(each["from"], data_of(each).decode("ascii", "ignore")) for each in radio.message["packets"]])
            if state is not None and state.fresh():
                player.learn(state.message)
            if compass.fresh():
                player.heading = compass.message["data"]
            if handler.fresh():
                player.feel(now_s, handler.message["engaged"])
            if eye.fresh():
                player.look(now_s, eye.message["objects"])
            wanted, hold, impulse = player.decide(now_s)
            velocity, before_s = smooth(velocity, wanted, now_s - before_s), now_s
            ahead, left, turn = velocity
            robot.command("drive", {"linear": {"x": ahead, "y": left}, "angular": {"z": turn}})
            if hold != holds:
                robot.command("handler", {"data": 1.0 if hold else 0.0})
                holds = hold
            if impulse > 0:
                robot.command("kicker", {"data": impulse})
            news = player.tell(now_s)
            if news and now_s - spoken_s > 0.19:
                robot.command("radio", packet(news.encode()))
                spoken_s = now_s


if __name__ == "__main__":
    main()
