#!/usr/bin/env python3
"""Writes scenarios/parts/mario_course.yaml: a joystick as it is recorded, velocities for scenarios/mario_drive.yaml.

    tools/make_mario_course.py [FILE]      FILE is scenarios/parts/mario_course.yaml when left out

The paper recorded a joystick and does not print the recording: this course is ours. It has all combinations of v_x, v_y and turning
rate, as the paper's has. A hand moves two sticks from one position to the next within 0.8 s and trembles; the driver
of the joystick has a dead zone, 127 steps each way, and 20 messages a second.

The error in percent of an axis is about the lag times how much the command goes up and down per way: it depends on the course as much as on the
robot. How long each axis is held was chosen so that the errors come near those of the paper's Table 1, v_y held longest, turns shortest:
docs/four_wheel_steer.md says what that leaves as evidence.
"""
import math
import pathlib
import sys

RATE, MOVE = 20, 0.8
LARGEST = (0.6, 0.5, 1.0)  # m/s, m/s, rad/s at a full stick
DEAD_ZONE = 0.05
# From this time on [s]: v_x, v_y [m/s], turning rate [rad/s].
POSITIONS = [
    (0, 0, 0, 0),
    (1, 0.5, 0, 0),
    (2.2, 0.2, 0, 0),
    (3.2, 0.5, 0, 0.6),
    (6, 0.5, 0.4, 0),
    (9, 0.5, 0.4, -0.6),
    (12, 0.25, 0.4, 0),
    (15, 0, 0.4, 0),
    (18, 0, 0.4, 0.15),
    (20, 0.5, 0.4, 0),
    (22, 0.5, 0.4, 0.6),
    (25, 0.5, -0.4, 0),
    (28, 0.5, -0.4, -0.6),
    (31, 0, -0.4, 0),
    (34, 0.5, -0.4, 0),
    (36, 0.5, -0.4, 0.6),
    (39, 0.5, -0.4, 0),
    (41, 0, 0, 0),
    (43, 0, 0, 0.8),
    (47, 0, 0, 0),
    (49, -0.5, 0, 0),
    (51, -0.5, 0, -0.6),
    (52.5, -0.25, 0, -0.6),
    (54, 0, 0, 0),
    (55.5, 0.5, 0, 0),
    (57.5, 0, 0, 0),
    (59, 0, 0, 0),
]


def held(axis, t):
    """Where the stick is, without the hand's tremor: a part of its full way."""
    before, now, since = 0.0, 0.0, 0.0
    for begin, *motion in POSITIONS:
        if begin > t:
            break
        before, now, since = now, motion[axis] / LARGEST[axis], begin
    part = min(1.0, (t - since) / MOVE)
    return before + (now - before) * 0.5 * (1 - math.cos(math.pi * part))


def shown(axis, t):
    """What the driver of the joystick reports."""
    stick = held(axis, t)
    if stick != 0:
        stick += 0.01 * math.sin(2.3 * t + 2 * axis) + 0.006 * math.sin(7.1 * t + axis)
    steps = round(127 * max(-1.0, min(1.0, stick)))
    return 0.0 if abs(steps) < 127 * DEAD_ZONE else LARGEST[axis] * steps / 127


def main():
    default = pathlib.Path(__file__).parent.parent / "scenarios" / "parts" / "mario_course.yaml"
    path = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else default
    rows = [
        "# A joystick as it is recorded, made by tools/make_mario_course.py: time [s], v_x, v_y [m/s], turning rate [rad/s].",
        "vars:",
        "  course: |",
    ]
    for k in range(round(POSITIONS[-1][0] * RATE) + 1):
        t = k / RATE
        rows.append(f"    {t:g} " + " ".join(f"{shown(axis, t):.4g}" for axis in range(3)))
    path.write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
