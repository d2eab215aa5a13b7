#!/usr/bin/env python3
"""A robot that keeps away from what its laser sees, driven by a client in lockstep with the run.

    sandlot run wander.yaml --port 8765 &
    PYTHONPATH=/usr/share/sandlot/python python3 wander.py
"""
from sandlot_client import Robot


def decide(scan):
    """Forward while the way is free; else turn to the side with more room."""
    ranges = [scan["range_max"] if r is None else r for r in scan["ranges"]]  # null: nothing within range
    third = len(ranges) // 3
    right, ahead, left = (min(part) for part in (ranges[:third], ranges[third:-third], ranges[-third:]))
    if ahead > 0.8:
        return {"linear": {"x": 0.4}}
    return {"angular": {"z": 1.0 if left > right else -1.0}}


with Robot("rover", lockstep=True, deadline_s=5) as rover:
    laser = rover.subscribe("laser")
    for step in rover.steps():
        if laser.fresh():
            rover.command("drive", decide(laser.message))
