#!/usr/bin/env python3
"""A controller in Python: keeps away from what the laser sees. Sandlot starts it and talks lines of JSON with it."""
import json
import sys


def decide(scan):
    """Forward while the way is free; else turn to the side with more room."""
    ranges = [scan["range_max"] if r is None else r for r in scan["ranges"]]  # null: nothing within range
    third = len(ranges) // 3
    right, ahead, left = (min(part) for part in (ranges[:third], ranges[third:-third], ranges[-third:]))
    if ahead > 0.8:
        return {"linear": {"x": 0.4}}
    return {"angular": {"z": 1.0 if left > right else -1.0}}


robot = json.loads(sys.stdin.readline())  # once: what the robot has
print("driving", robot["robot"], "every", robot["period"], "s", file=sys.stderr)  # goes to Sandlot's log
for line in sys.stdin:  # one line per control step, one answer each
    readings = json.loads(line)["readings"]  # only what is new
    answer = {}
    if "laser" in readings:
        answer["orders"] = {"drive": decide(readings["laser"])}
    print(json.dumps(answer), flush=True)
