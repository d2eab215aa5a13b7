#!/usr/bin/env python3
"""The law of tests/plugins/striker.cpp as a program in lockstep: the same sums, so that both give the same run."""
from sandlot_client import Robot


def clamp(value, most):
    return min(most, max(-most, value))


with Robot() as robot:
    eye, referee = robot.subscribe("eye/objects"), robot.subscribe("referee/state")
    ball, runs = None, False
    for step in robot.steps():
        if referee.fresh():
            runs = referee.message["phase"] == "running"
        if eye.fresh():
            for thing in eye.message["objects"]:
                if thing["label"] == "ball":
                    ball = thing["position"]
        x, y, turn = 0.0, 0.0, 0.0
        if runs and ball:
            x, y, turn = clamp(0.3 * ball["x"], 2.0), clamp(0.3 * ball["y"], 2.0), clamp(3.0 * ball["y"], 3.0)
        robot.command("drive", {"linear": {"x": x, "y": y}, "angular": {"z": turn}})
        if runs and ball and 0 < ball["x"] < 0.45 and -0.15 < ball["y"] < 0.15:
            robot.command("kicker", {"data": 2.5})
