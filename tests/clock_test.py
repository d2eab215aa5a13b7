"""The clock for clients in Python on a trace of a real run. `clock_test.py --write` makes tests/clock/expected.csv again, which holds its twin
in C++ to the same answers."""
import os
import sys
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
FOLDER = os.path.join(ROOT, "tests/clock")
sys.path.insert(0, os.path.join(ROOT, "clients/python"))
from sandlot_client.clock import Clock  # noqa: E402


def trace(name):
    """Simulated times and wall times of the steps."""
    with open(os.path.join(FOLDER, name + ".csv")) as file:
        rows = [line.strip().split(",") for line in file if line[0] != "#"][1:]
    return [(float(row[0]), float(row[2])) for row in rows]


def answers():
    """Of a clock that gets a message of one step and one of two steps in turn."""
    steps = trace("field_images")
    now = 0.0
    clock = Clock(wall=lambda: now)
    timer = clock.timer(0.07)
    for i in range(0, len(steps) - 3, 3):
        now += steps[i][1]
        clock.take(steps[i][0], 0.001, [steps[i][1]], now)
        now += steps[i + 1][1]
        now += steps[i + 2][1]
        clock.take(steps[i + 2][0], 0.001, [steps[i + 1][1], steps[i + 2][1]], now)
        came, now = now, now + 0.4 * steps[i + 3][1]
        yield (clock.now_s(), clock.speed(), clock.speed(0.1), clock.wall_s_until(steps[i + 2][0] + 0.05), timer.poll())
        now = came


class Run:
    """A run whose steps of 10 ms take so long each; messages arrive at once."""

    def __init__(self):
        self.now, self.stamp = 100.0, 5.0
        self.clock = Clock(wall=lambda: self.now)
        self.clock.take(self.stamp, 0.01, [], self.now, True)

    def steps(self, count, each):
        for _ in range(count):
            self.now += each
            self.stamp += 0.01
            self.clock.take(self.stamp, 0.01, [each], self.now)


class ClockTest(unittest.TestCase):
    def test_it_answers_as_it_did_for_its_twin(self):
        with open(os.path.join(FOLDER, "expected.csv")) as file:
            expected = [[float(x) for x in line.split(",")] for line in file]
        ours = list(answers())
        self.assertEqual(len(ours), len(expected))
        for mine, theirs in zip(ours, expected):
            for a, b in zip(mine, theirs):
                self.assertAlmostEqual(a, b, delta=1e-9 * max(1, abs(b)))

    def test_it_is_exact_at_a_constant_speed(self):
        run = Run()
        run.steps(100, 0.005)
        self.assertAlmostEqual(run.clock.speed(), 2, places=9)
        run.now += 0.002
        self.assertAlmostEqual(run.clock.now_s(), 6.004, places=9)
        self.assertAlmostEqual(run.clock.wall_s_until(6.1), 0.048, places=9)
        run.now += 1  # a run that stalls
        self.assertAlmostEqual(run.clock.now_s(), 6.01, places=9)

    def test_it_follows_another_speed_within_its_shortest_window(self):
        run = Run()
        run.steps(100, 0.005)
        run.steps(5, 0.02)
        self.assertAlmostEqual(run.clock.speed(), 0.5, places=9)

    def test_many_steps_in_a_message_cost_little(self):
        run = Run()
        run.clock.take(run.stamp + 1000, 0.01, [1e-6] * 100_000, run.now)
        self.assertAlmostEqual(run.clock.speed(), 1e4, delta=1e-3)
        self.assertLess(len(run.clock._sim_sums), 1000)

    def test_a_period_is_positive(self):
        for period in (0, -1, 1e-300, float("nan"), float("inf")):
            with self.assertRaises(ValueError):
                Run().clock.timer(period)


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        with open(os.path.join(FOLDER, "expected.csv"), "w") as out:
            for row in answers():
                out.write(",".join("%.12g" % x for x in row) + "\n")
    else:
        unittest.main()
