#!/usr/bin/env python3
"""Drives the rover of @NAME@.yaml: forward while the way is free, else it turns to the side with more room."""
from sandlot_client import Robot, numbers


def decide(scan):
    """A command for the drive by a laser scan: 271 ranges from -135 to 135 degrees."""
    ranges = numbers(scan["ranges"], missing=scan["range_max"])
    right, ahead, left = min(ranges[45:115]), min(ranges[115:156]), min(ranges[156:226])
    if ahead > 0.6:
        return {"linear": {"x": 0.4}}
    return {"angular": {"z": 1.0 if left > right else -1.0}}


def main():
    with Robot("rover", lockstep=True, deadline_s=5) as rover:
        laser = rover.subscribe("laser")
        for step in rover.steps():
            if laser.fresh():
                rover.command("drive", decide(laser.message))


if __name__ == "__main__":
    main()
