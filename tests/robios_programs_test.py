"""The programs in examples/robios, each in its world: what the robot has done in the end, by the true poses, and what the program printed."""
import collections
import csv
import json
import math
import os
import re
import subprocess
import tempfile
import unittest

import sandbox

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SANDLOT = os.path.abspath(os.environ.get("SANDLOT_BIN", os.path.join(ROOT, "build/release/sandlot")))
FOLDER = os.path.join(ROOT, "examples/robios")


class Run:
    """A run of a scenario in examples/robios to its end.

    printed  lines of each robot's program
    rows     poses (x, y, yaw) [m, rad] of each robot, 20 per second
    """

    def __init__(self, scenario, robots, duration_s, *arguments, values=(), stop_when=""):
        with tempfile.TemporaryDirectory() as folder:
            log = os.path.join(folder, "log.csv")
            names = [f"{robot}.pose.{part}" for robot in robots for part in ("x", "y", "yaw")] + list(values)
            command = [SANDLOT, "run", os.path.join(FOLDER, scenario), "--duration", f"{duration_s}s", "--json", "--log", log,
                       "--log-values", ",".join(names), "--log-rate", "20 Hz", *arguments]
            if stop_when:
                command += ["--stop-when", stop_when]
            done = subprocess.run(command, capture_output=True, text=True, timeout=300)
            if done.returncode != 0:
                raise AssertionError(f"{done.returncode}: {done.stderr}")
            self.summary = json.loads(done.stdout)
            with open(log, newline="") as file:
                self.table = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
        self.printed = collections.defaultdict(list)
        for robot, line in re.findall(r"^info: (\w+)/controller: (.*)$", done.stderr, re.M):
            self.printed[robot].append(line)
        self.robots = list(robots)

    def lines(self, robot=None):
        """What the program of a robot printed."""
        return self.printed[robot or self.robots[0]]

    def path(self, robot=None):
        at = 1 + 3 * self.robots.index(robot or self.robots[0])
        return [tuple(row[at:at + 3]) for row in self.table]

    def times(self):
        return [row[0] for row in self.table]

    def value(self, index):
        """Column of a further value."""
        return [row[1 + 3 * len(self.robots) + index] for row in self.table]


def ended(*robots):
    return " and ".join(f"{robot}/controller.ended > 0" for robot in robots)


def way(path):
    return sum(math.dist(a[:2], b[:2]) for a, b in zip(path, path[1:]))


def to_segment(x, y, wall):
    x1, y1, x2, y2 = wall
    t = ((x - x1) * (x2 - x1) + (y - y1) * (y2 - y1)) / ((x2 - x1) ** 2 + (y2 - y1) ** 2)
    t = min(1.0, max(0.0, t))
    return math.hypot(x - x1 - t * (x2 - x1), y - y1 - t * (y2 - y1))


def walls_of(world):
    """The four first numbers of each wall line of a .wld file [m]; without frames."""
    with open(os.path.join(FOLDER, world)) as file:
        return [[float(word) / 1000 for word in line.split()[:4]] for line in file if re.match(r"\d", line)]


def angle_between(a, b):
    return abs(math.remainder(a - b, 2 * math.pi))


class Maze:
    """Cells of a .maz file: neighbours that no wall separates. Row 0 is at the bottom."""

    def __init__(self, file):
        with open(os.path.join(FOLDER, file)) as text:
            rows = text.read().splitlines()
        self.cell_m = float(rows.pop()) / 1000
        rows.pop(0)  # the wall on top
        rows.reverse()
        self.neighbours = collections.defaultdict(set)
        self.start = next((row.upper().index("S") // 2, i) for i, row in enumerate(rows) if "S" in row.upper())
        for i, row in enumerate(rows):
            for column in range(len(row) // 2):
                if row[2 * column + 2] != "|":
                    self.join((column, i), (column + 1, i))
                if i > 0 and row[2 * column + 1] not in "_S":
                    self.join((column, i), (column, i - 1))

    def join(self, a, b):
        self.neighbours[a].add(b)
        self.neighbours[b].add(a)

    def distances(self):
        out, queue = {self.start: 0}, collections.deque([self.start])
        while queue:
            cell = queue.popleft()
            for each in self.neighbours[cell]:
                if each not in out:
                    out[each] = out[cell] + 1
                    queue.append(each)
        return out

    def middle(self, cell):
        return tuple((n + 0.5) * self.cell_m for n in cell)


class Programs(unittest.TestCase):
    def setUp(self):
        sandbox.skip_without(self)

    def near(self, pose, x, y, tolerance_m, yaw=None, tolerance_rad=0.05):
        self.assertLess(math.hypot(pose[0] - x, pose[1] - y), tolerance_m, f"{pose} is not at {x} {y}")
        if yaw is not None:
            self.assertLess(angle_between(pose[2], yaw), tolerance_rad, pose)

    def test_wander_keeps_moving_and_touches_nothing(self):
        run = Run("wander.sim", ["LabBot"], 60)
        self.assertGreater(way(run.path()), 60 * 0.25 * 0.4)  # 40 % of the time at its speed, the rest for turns
        # The walls' faces stand 5 mm inside; the robot's corners are 114 mm from its middle: it can always turn.
        self.assertGreater(min(to_segment(x, y, wall) for x, y, _ in run.path() for wall in walls_of("arena.wld")), 0.119)
        self.assertGreater(len(run.lines()), 5)
        # Everywhere in the room: the middle of the way lies near the middle of the room.
        self.assertGreater(max(x for x, _, _ in run.path()) - min(x for x, _, _ in run.path()), 1.5)

    def test_wall_follow_keeps_its_distance(self):
        run = Run("wall_follow.sim", ["LabBot"], 130)
        walls = walls_of("wall_follow.wld")
        # 15 +- 5 cm from the robot's side, which is 70 mm from its middle, to the face, 5 mm from the wall's middle.
        gaps = [min(to_segment(x, y, wall) for wall in walls) - 0.075 for x, y, _ in run.path()]
        self.assertGreater(min(gaps), 0.10)
        self.assertLess(max(gaps), 0.20)
        self.assertAlmostEqual(sum(gaps) / len(gaps), 0.15, delta=0.01)
        # Two rounds but for the last corners: five inner ones and an outer one each.
        self.assertEqual([line for line in run.lines() if "outer" in line], ["outer corner 2", "outer corner 8"])
        self.assertGreater(way(run.path()), 12)

    def test_curves_end_where_they_began(self):
        run = Run("curve.sim", ["LabBot"], 60, stop_when=ended("LabBot"))
        figures = [re.fullmatch(r"(\w+): x (-?\d+) mm, y (-?\d+) mm, (-?\d+) degrees", line).groups() for line in run.lines()]
        self.assertEqual([figure[0] for figure in figures], ["eight", "square", "point", "back"])
        expected = [(0, 0, 0), (0, 0, 0), (400, 300, math.degrees(2 * math.atan2(300, 400))), (0, 0, 180)]
        for figure, (x, y, phi) in zip(figures, expected):
            self.assertLess(math.hypot(float(figure[1]) - x, float(figure[2]) - y), 15, figure)
            self.assertLess(angle_between(math.radians(float(figure[3])), math.radians(phi)), math.radians(2.1), figure)
        self.near(run.path()[-1], 1.5, 1.2, 0.02, math.pi)
        # Circles of 300 mm to both sides.
        half = [pose for time, pose in zip(run.times(), run.path()) if time < 2 * 2 * math.pi]
        self.assertLess(abs(max(y for _, y, _ in half) - 1.8), 0.01)
        self.assertLess(abs(min(y for _, y, _ in half) - 0.6), 0.01)

    def test_ping_pong_counts_to_a_hundred(self):
        run = Run("pingpong.sim", ["S4", "S4_2"], 60, stop_when=ended("S4", "S4_2"))
        for robot in run.robots:
            lines = run.lines(robot)
            self.assertEqual(len(lines), 1, lines)
            ball, ms = map(int, re.fullmatch(r"ball (\d+), (\d+) ms a way", lines[0]).groups())
            self.assertEqual(ball, 100)
            # Sent at the end of a slot of 50 ms, received at the end of the next one.
            self.assertGreaterEqual(ms, 50)
            self.assertLess(ms, 55)
        # 0.2 s until the first one, 100 ways of 50 ms, and two slots for begin and end.
        self.assertAlmostEqual(run.times()[-1], 0.2 + 100 * 0.05 + 2 * 0.05, delta=0.026)

    def test_cooperative_tasks_run_in_this_order(self):
        with tempfile.TemporaryDirectory() as folder:
            run = Run("tasks_cooperative.sim", ["LabBot"], 40, "--program-logs", folder, stop_when=ended("LabBot"))
            with open(os.path.join(folder, "LabBot.controller.log")) as file:
                self.assertEqual(file.read().splitlines(), run.lines())
        self.assertEqual(run.lines(), ["side 1", "side 2", "corner 1", "side 3", "corner 2", "side 4", "corner 3", "end", "corner 4"])
        self.near(run.path()[-1], 1.2, 0.9, 0.02, 0)

    def test_preemptive_tasks_run_in_this_order(self):
        run = Run("tasks_preemptive.sim", ["LabBot"], 40, stop_when=ended("LabBot"))
        trace = [line for line in run.lines() if "adder" not in line]
        self.assertEqual(trace, ["side 1", "corner 1", "side 2", "corner 2", "side 3", "corner 3", "side 4", "corner 4", "end",
                                 "sum 4000 of 4000"])
        self.assertEqual(sorted(line for line in run.lines() if "adder" in line), ["adder 1 has ended", "adder 2 has ended"])
        self.near(run.path()[-1], 1.2, 0.9, 0.02, 0)

    def test_additions_are_lost_without_a_semaphore(self):
        run = Run("tasks_preemptive.sim", ["LabBot"], 40, "--set", "robots.LabBot.controller.flags=[-DNO_LOCK]",
                  stop_when=ended("LabBot"))
        lost = re.fullmatch(r"sum (\d+) of 4000", run.lines()[-1])
        self.assertLess(int(lost[1]), 4000)
        self.assertGreaterEqual(int(lost[1]), 2000)

    def test_mecanum_wheels_drive_a_square_without_a_turn(self):
        run = Run("mecanum.sim", ["Omni"], 20, stop_when=ended("Omni"))
        # 30 % of 1400 degrees/s on wheels of 40 mm: 0.293 m/s, 2 s each.
        side = 0.3 * math.radians(1400) * 0.04 * 2
        square = [pose for time, pose in zip(run.times(), run.path()) if time < 8.4]
        self.assertLess(max(angle_between(yaw, 0) for _, _, yaw in square), 0.02)
        self.assertAlmostEqual(max(x for x, _, _ in square), 1.2 + side, delta=0.03)
        self.assertAlmostEqual(max(y for _, y, _ in square), 0.9 + side, delta=0.03)
        self.near(square[-1], 1.2, 0.9, 0.03)
        turned = sum(math.remainder(b[2] - a[2], 2 * math.pi) for a, b in zip(run.path(), run.path()[1:]))
        # v / (half length + half width of the wheels' rectangle), about 4 s.
        self.assertGreater(turned, 3)
        self.near(run.path()[-1], 1.2, 0.9, 0.03)

    def test_maze_is_explored_and_the_shortest_way_driven(self):
        maze = Maze("maze.maz")
        distances = maze.distances()
        longest = max(distances.values())
        goals = [cell for cell, steps in distances.items() if steps == longest]
        run = Run("maze.sim", ["LabBot"], 400, stop_when=ended("LabBot"))
        self.assertEqual(run.lines(), [f"explored {len(distances)} cells", f"the way to the goal has {longest} cells", "goal", "home"])
        home = maze.middle(maze.start)
        self.near(run.path()[-1], *home, 0.04, math.pi / 2, 0.1)
        # The way back is the last one from the goal on, and not longer than it must be (+ the turns' arcs and corrections).
        near_goal = [i for i, pose in enumerate(run.path()) for goal in goals if math.dist(pose[:2], maze.middle(goal)) < 0.04]
        self.assertTrue(near_goal)
        self.assertLess(way(run.path()[near_goal[-1]:]), longest * maze.cell_m * 1.05)

    def test_distbug_reaches_the_goal_out_of_a_trap(self):
        run = Run("distbug.sim", ["S4"], 120, stop_when=ended("S4"))
        self.assertEqual(run.lines()[-1], "at the goal")
        self.assertGreaterEqual(len(run.lines()), 3)  # it has followed something and left it
        self.near(run.path()[-1], 3.7, 1.5, 0.1)

    def test_distbug_finds_out_that_there_is_no_way(self):
        run = Run("distbug_closed.sim", ["S4"], 120, stop_when=ended("S4"))
        self.assertEqual(run.lines()[-1], "cannot be reached")
        self.assertEqual(len(run.lines()), 2)

    def test_ball_is_found(self):
        run = Run("ball.yaml", ["labbot"], 40, values=("ball.pose.x", "ball.pose.y"), stop_when=ended("labbot"))
        self.assertEqual(run.lines()[0], "seen")
        self.assertIn("found", run.lines()[-1])
        x, y, yaw = run.path()[-1]
        away = math.hypot(run.value(0)[-1] - x, run.value(1)[-1] - y)
        # 90 mm to the sensor, 60 mm, 50 mm to the ball's middle.
        self.assertLess(away, 0.23)
        self.assertLess(angle_between(yaw, math.atan2(run.value(1)[-1] - y, run.value(0)[-1] - x)), 0.2)
        self.assertLess(math.hypot(run.value(0)[-1] - 0.6, run.value(1)[-1] - 1.9), 0.02, "the ball was pushed away")

    def test_soccer_has_goals(self):
        robots = ["blue_1", "blue_2", "yellow_1", "yellow_2"]
        run = Run("soccer.yaml", robots, 180, values=("rules/goals.scored[0]", "rules/goals.scored[1]"),
                  stop_when="rules/goals.scored[0] + rules/goals.scored[1] > 0")
        self.assertGreater(run.value(0)[-1] + run.value(1)[-1], 0)

    def test_four_robots_with_cameras_run_the_same_on_any_threads(self):
        robots = ["LabBot", "LabBot_2", "S4", "S4_2"]
        runs = [Run("four.sim", robots, 8, "--threads", threads) for threads in ("1", "1", "2", "4")]
        self.assertEqual(len({run.summary["state_hash"] for run in runs}), 1)
        for run in runs:
            self.assertEqual(run.printed, runs[0].printed)
        for robot in robots:
            self.assertGreaterEqual(len(runs[0].lines(robot)), 1)

    def test_four_robots_with_cameras_are_faster_than_real_time(self):
        off = [word for robot in ("LabBot", "LabBot_2", "S4", "S4_2")
               for word in ("--set", f"robots.{robot}.controller.delays=off")]
        run = Run("four.sim", ["LabBot"], 20, *off)
        self.assertLess(run.summary["wall_seconds"], 20)

    def test_twenty_robots_with_cameras(self):
        robots = ["LabBot"] + [f"LabBot_{i}" for i in range(2, 11)] + ["S4"] + [f"S4_{i}" for i in range(2, 11)]
        run = Run("twenty.sim", robots, 10, values=[f"{robot}/controller.ended" for robot in robots])
        for i, robot in enumerate(robots):
            self.assertEqual(run.value(i)[-1], 0, robot)
            self.assertGreaterEqual(len(run.lines(robot)), 2, robot)  # 40 pictures at least
            self.assertGreater(way(run.path(robot)), 0.3, robot)


if __name__ == "__main__":
    unittest.main()
