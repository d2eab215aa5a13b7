#!/usr/bin/env python3
"""A whole team by one connection: its robots form a line abreast while they drive.

    sandlot run team.yaml --port 8765 &
    PYTHONPATH=/usr/share/sandlot/python python3 team.py
"""
from sandlot_client import Team

with Team("red", lockstep=True, deadline_s=5) as team:
    for robot in team.robots.values():
        robot.subscribe("truth")
    for step in team.steps():
        x = {name: robot.value("truth.pose.pose.position.x") for name, robot in team.robots.items()}
        total = 0.0
        for each in x.values():  # not sum(), which rounds in another way from Python 3.12 on
            total += each
        mean = total / len(x)
        for name, robot in team.robots.items():
            robot.command("drive", {"linear": {"x": min(0.6, max(0.0, 0.3 + mean - x[name]))}})
