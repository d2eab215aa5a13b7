#!/usr/bin/env python3
"""Two robots that agree by radio where to meet. One process each:

    sandlot run radio_pair.yaml --port 8765 &
    export PYTHONPATH=/usr/share/sandlot/python
    python3 radio_pair.py red & python3 radio_pair.py blue

Each draws a place between the two, and a rank, and sends both in every step: packets get lost. The place of the higher rank is it.
"""
import sys

from sandlot_client import Robot, data_of, packet

name = sys.argv[1] if len(sys.argv) > 1 else "red"
other = "blue" if name == "red" else "red"
begin, direction = (-2.0, 1.0) if name == "red" else (2.0, -1.0)

with Robot(name, lockstep=True, deadline_s=5) as robot:
    radio = robot.subscribe("radio")
    odometry = robot.subscribe("drive")
    mine = heard = None  # rank and place
    for step in robot.steps():
        if mine is None:
            mine = (step.uniform(0), 3 * step.uniform(1) - 1.5)
        robot.command("radio", packet("%r %r" % mine, to=other))
        if radio.fresh():
            for each in radio.message["packets"]:
                heard = tuple(float(number) for number in data_of(each).decode().split())
        if heard is None:
            continue
        place = max(mine, heard)[1]
        left = direction * (place - begin) - odometry.value("pose.pose.position.x")
        robot.command("drive", {"linear": {"x": min(0.4, max(-0.4, left))}})
