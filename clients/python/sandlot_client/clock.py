"""Simulated time for programs: clock, estimate of the simulation's speed, interval timers, sleep_until. Standard library only.

    clock = Clock(wait=lambda s: robot.poll(s))          # anything that waits, and meanwhile calls take()
    clock.take(stamp_s, step_s, wall_s, arrival_s, restarted)   # for each message of /sandlot/step_times
    timer = clock.timer(0.1)
    while True:
        timer.wait()                                     # every 100 ms of simulated time, however fast the run is

The server sends how long its latest steps took. From them follows the speed, simulated seconds per second of the wall clock,
and from the speed the time between two messages and how long a simulated interval will take.

Speed      over the last 5, 10, 20 or 50 steps: simulated time over wall time, or the mean of the speeds of the steps. For each length of
           interval (1, 2, 4 ... 64 steps) the one of these eight is used whose predictions had the least mean relative error recently.
           Before the first interval: 1.
Time       now_s() goes on from the latest message at that speed. It never exceeds the stamp by more than the longest of the last 8
           messages covered: a run that stalls or is paused holds it there. It never goes back, unless the run is rewound.
Arrival    of a message that comes late among the last 32 the delay beyond the smallest one is removed.
Timers     fire at begin + k * period, with no drift, and plan again at each message.
Errors     a timer fires up to one message's span early or late in simulated time (a step, where each step has a message of its own). What
           cannot be foreseen stays: a step that takes much longer than those before it.
Limits     the smallest delay from server to client is not known: all times lag by it. After a pause the intervals before it still count.
Threads    none; whoever calls from several holds a lock.
Twins      clients/cpp/sandlot_client/clock.h does the same arithmetic in the same order; a test compares them.
"""

from __future__ import annotations

import math
import time
from typing import Callable, List, Optional, Sequence

__all__ = ["Clock", "IntervalTimer"]

WINDOWS = (5, 10, 20, 50)
HORIZONS = (1, 2, 4, 8, 16, 32, 64)
_KEEP = 1 / 256  # weight of the latest error of a prediction, so that the last 256 or so count
_SPANS = 8
_DELAYS = 32
_JUDGED_PER_MESSAGE = 8
_LEAST_PERIOD_S = 1e-6
_LEAST_WALL_S = 1e-9
_SHORTEST_NAP_S = 0.0005
_LONGEST_NAP_S = 0.02


def _class_of(steps: float) -> int:
    """Number of the longest horizon that is not above so many steps."""
    h = 0
    while h + 1 < len(HORIZONS) and HORIZONS[h + 1] <= steps:
        h += 1
    return h


class Clock:
    """Clock of simulated time, fed with step times.

    wall: the wall clock that arrival_s is measured with.
    wait: waits up to so many seconds and takes messages meanwhile; may return early.
    windows: numbers of steps to average over, of which the best is used.
    """

    def __init__(
        self,
        wall: Callable[[], float] = time.monotonic,
        wait: Callable[[float], object] = time.sleep,
        windows: Sequence[int] = WINDOWS,
    ) -> None:
        self._wall = wall
        self._wait = wait
        self._windows = tuple(windows)
        self._history = max(self._windows) + HORIZONS[-1] + 1
        # Sums of simulated time, wall time and speed over the intervals known, oldest first.
        self._sim_sums: List[float] = [0.0]
        self._wall_sums: List[float] = [0.0]
        self._speed_sums: List[float] = [0.0]
        self._errors = [[0.0] * (2 * len(self._windows)) for _ in HORIZONS]
        self._best = [0] * len(HORIZONS)
        self._stamp_s = 0.0
        self._step_s = 0.0
        self._steps = 1  # of the latest message
        self._spans: List[float] = []
        self._server_s = 0.0
        self._delays: List[float] = []
        self._anchor_s = 0.0
        self._shown_s = -math.inf
        self.messages = 0
        self.rewinds = 0

    # ---------------------------------------------------------------------------------------------------- messages

    def take(
        self,
        stamp_s: float,
        step_s: float,
        wall_s_list: Sequence[float],
        arrival_s: Optional[float] = None,
        restarted: bool = False,
    ) -> None:
        """Takes a message of step times. arrival_s: when it came, by the wall clock; None: now."""
        arrival_s = self._wall() if arrival_s is None else arrival_s
        steps = len(wall_s_list) + (1 if restarted else 0)
        span_s = steps * step_s
        follows = self.messages > 0 and not restarted
        if self.messages > 0 and stamp_s < self._stamp_s:
            self.rewinds += 1
            self._shown_s = -math.inf
            follows = False
        elif abs(stamp_s - self._stamp_s - span_s) > 0.5 * step_s:
            follows = False  # messages were lost
        count = len(wall_s_list)
        stride = count // _JUDGED_PER_MESSAGE + 1
        for i in range(max(0, count - self._history), count):
            self._add(step_s, max(wall_s_list[i], _LEAST_WALL_S))
            if (count - 1 - i) % stride == 0:
                self._judge(_class_of(steps))
        for wall_s in wall_s_list:
            self._server_s += wall_s
        if not follows:
            self._server_s = 0.0
            self._delays.clear()
        self._delays = self._delays[-(_DELAYS - 1) :] + [arrival_s - self._server_s]
        self._spans = self._spans[-(_SPANS - 1) :] + [span_s]
        self._anchor_s = self._server_s + min(self._delays)
        self._stamp_s, self._step_s, self._steps = stamp_s, step_s, max(steps, 1)
        self.messages += 1

    def _add(self, step_s: float, wall_s: float) -> None:
        self._sim_sums.append(self._sim_sums[-1] + step_s)
        self._wall_sums.append(self._wall_sums[-1] + wall_s)
        self._speed_sums.append(self._speed_sums[-1] + step_s / wall_s)
        if len(self._sim_sums) > 4 * self._history:
            for sums in (self._sim_sums, self._wall_sums, self._speed_sums):
                del sums[: -self._history]

    def _judge(self, of_message: int) -> None:
        """Compares what each estimate predicted for the latest steps with what they took.

        of_message: horizon of the steps between two messages. What lasts no longer is planned no more, and a clock that is ahead waits there
        as long as one that is behind lags.
        """
        last = len(self._sim_sums) - 1
        for h, steps in enumerate(HORIZONS):
            then = last - steps
            if then < 1:
                break
            sim_s = self._sim_sums[last] - self._sim_sums[then]
            took_s = self._wall_sums[last] - self._wall_sums[then]
            best = 0
            errors = self._errors[h]
            for i in range(len(errors)):
                ratio = sim_s / self._estimate(i, then) / took_s
                error = abs(ratio - 1) if h > of_message or ratio < 1 else 1 - 1 / ratio
                errors[i] += _KEEP * (error - errors[i])
                if errors[i] < errors[best]:
                    best = i
            self._best[h] = best

    def _estimate(self, number: int, last: int) -> float:
        """Speed by the intervals up to `last`, as many as the window holds or as there are.

        Even numbers: simulated time over wall time; odd ones: mean of the speeds of the steps.
        """
        first = max(0, last - self._windows[number // 2])
        if number % 2 == 1:
            return (self._speed_sums[last] - self._speed_sums[first]) / (last - first)
        return (self._sim_sums[last] - self._sim_sums[first]) / (self._wall_sums[last] - self._wall_sums[first])

    # ------------------------------------------------------------------------------------------------------- time

    def speed(self, interval_s: float = 0.0) -> float:
        """Simulated seconds per second of the wall clock, as they will be over the next interval of simulated time."""
        last = len(self._sim_sums) - 1
        if last == 0:
            return 1.0
        steps = max(float(self._steps), interval_s / self._step_s if self._step_s > 0 else 0.0)
        return self._estimate(self._best[_class_of(steps)], last)

    def now_s(self) -> float:
        """Simulated time now; 0 before the first message."""
        if self.messages == 0:
            return 0.0
        passed_s = (self._wall() - self._anchor_s) * self.speed()
        now_s = self._stamp_s + min(max(passed_s, 0.0), max(self._spans))
        self._shown_s = max(self._shown_s, now_s)
        return self._shown_s

    def wall_s_until(self, time_s: float) -> float:
        """Wall time until a simulated time is reached, as far as can be foreseen now; 0: it is there."""
        if time_s <= self.now_s():
            return 0.0
        ahead_s = time_s - self._stamp_s
        return max(0.0, self._anchor_s + ahead_s / self.speed(ahead_s) - self._wall())

    def sleep_until(self, time_s: float, timeout_s: Optional[float] = None) -> bool:
        """Waits until a simulated time is reached. timeout_s: of wall time; False: it was not reached by then."""
        begin_s = self._wall()
        rewinds = self.rewinds
        while self.now_s() < time_s - 1e-9 and self.rewinds == rewinds:
            left_s = min(max(self.wall_s_until(time_s), _SHORTEST_NAP_S), _LONGEST_NAP_S)
            if timeout_s is not None:
                still_s = begin_s + timeout_s - self._wall()
                if still_s <= 0:
                    return False
                left_s = min(left_s, still_s)
            self._wait(left_s)
        return self.rewinds == rewinds

    def timer(self, period_s: float) -> "IntervalTimer":
        """A timer that fires every so many simulated seconds, from now on."""
        return IntervalTimer(self, period_s)


class IntervalTimer:
    """Timer of simulated time, at begin + k * period. After a rewind it begins again there."""

    def __init__(self, clock: Clock, period_s: float) -> None:
        if not (_LEAST_PERIOD_S <= period_s < math.inf):
            raise ValueError("a period is a number of seconds, at least a millionth, not %r" % period_s)
        self._clock = clock
        self.period_s = period_s
        self._restart()

    def _restart(self) -> None:
        self._rewinds, self._begun = self._clock.rewinds, self._clock.messages > 0
        self._begin_s = self._clock.now_s()
        self._count = 1

    @property
    def next_s(self) -> float:
        """Simulated time of the next firing."""
        return self._begin_s + self._count * self.period_s

    def wall_s_left(self) -> float:
        """Wall time until the next firing, as planned now."""
        return self._clock.wall_s_until(self.next_s)

    def poll(self) -> int:
        """How many periods have ended since it was last asked; does not wait."""
        if self._rewinds != self._clock.rewinds or (not self._begun and self._clock.messages > 0):
            self._restart()
        now_s = self._clock.now_s() + 1e-9
        if now_s < self.next_s:
            return 0
        ended = int((now_s - self._begin_s) / self.period_s) - self._count + 1
        ended = max(ended, 1)
        self._count += ended
        return ended

    def wait(self, timeout_s: Optional[float] = None) -> int:
        """Waits for the next firing. 0: it did not come within the timeout; above 1: so many have passed meanwhile."""
        begin_s = self._clock._wall()
        while True:
            ended = self.poll()
            if ended > 0:
                return ended
            still_s = None if timeout_s is None else begin_s + timeout_s - self._clock._wall()
            if still_s is not None and still_s <= 0:
                return 0
            self._clock.sleep_until(self.next_s, still_s)
