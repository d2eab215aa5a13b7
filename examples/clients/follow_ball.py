#!/usr/bin/env python3
"""A robot that looks for a ball, drives to it and pushes it on, by what its camera reports at the level of objects.

    sandlot run follow_ball.yaml --port 8765 &
    PYTHONPATH=/usr/share/sandlot/python python3 follow_ball.py
"""
from sandlot_client import Robot


def decide(objects):
    """Turn until the ball is in sight; then towards it, the faster the straighter."""
    balls = [each for each in objects if each["label"] == "ball"]
    if not balls:
        return {"angular": {"z": 0.8}}
    bearing = balls[0]["bearing"]
    return {"linear": {"x": 0.5 if abs(bearing) < 0.2 else 0.1}, "angular": {"z": 2.5 * bearing}}


with Robot("rover", lockstep=True, deadline_s=5) as rover:
    eye = rover.subscribe("eye/objects")
    for step in rover.steps():
        if eye.fresh():
            rover.command("drive", decide(eye.message["objects"]))
