#!/usr/bin/env python3
"""The clearing law of src/controllers/clearing as a client in lockstep: one process drives one pusher, on whatever machine.

    sandlot run scenarios/clearing.yaml --set robots.pusher.controller=remote --port 8765 --rate max &
    PYTHONPATH=/usr/share/sandlot/python python3 clearing.py pusher1 &
    PYTHONPATH=/usr/share/sandlot/python python3 clearing.py pusher2

The run ends in the state of the built-in law, but for what the programs themselves keep. For that the law uses +, -, *, / and the
square root alone, in the order of exact.h, draws from the random number of the step, and counts time in whole nanoseconds.
"""
import argparse
import math

from sandlot_client import Robot, data_of, packet

# ------------------------------------------------------------------------------------------------- exact.h, in Python


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1])


def along(start, length, direction):
    return (start[0] + length * direction[0], start[1] + length * direction[1])


def norm(a):
    return math.sqrt(dot(a, a))


def unit(a):
    length = norm(a)
    return (a[0] / length, a[1] / length) if length > 0 else (1.0, 0.0)


def angle_of(v):
    """The angle of a vector: the arc tangent by halving twice and its power series."""
    x, y = abs(v[0]), abs(v[1])
    larger, smaller = max(x, y), min(x, y)
    if not larger > 0:
        return 0.0
    t = smaller / larger
    t = t / (1 + math.sqrt(1 + t * t))
    t = t / (1 + math.sqrt(1 + t * t))
    t2 = t * t
    total = 0.0
    for k in range(19, 1, -2):
        total = t2 * (1.0 / k - total)
    angle = 4 * (t - t * total)
    if y > x:
        angle = math.pi / 2 - angle
    if v[0] < 0:
        angle = math.pi - angle
    return -angle if v[1] < 0 else angle


def turn_between(start, to):
    return angle_of((dot(start, to), cross(start, to)))


def angle_between(start, to):
    turn = to - start
    return turn - 2 * math.pi if turn > math.pi else turn + 2 * math.pi if turn < -math.pi else turn


def draw(random, use):
    """Number in [0, 1) for one of several uses of a step's random number: splitmix64."""
    whole = (1 << 64) - 1
    z = (random + use * 0x9e3779b97f4a7c15) & whole
    z = ((z ^ (z >> 30)) * 0xbf58476d1ce4e5b9) & whole
    z = ((z ^ (z >> 27)) * 0x94d049bb133111eb) & whole
    return ((z ^ (z >> 31)) >> 11) * 2.0**-53


class Place:
    """Where a robot is, and where it looks: a unit vector."""

    def __init__(self, pose):
        p, q = pose["position"], pose["orientation"]
        x, y, z, w = q["x"], q["y"], q["z"], q["w"]
        self.at = (p["x"], p["y"])
        self.heading = unit((1 - 2 * (y * y + z * z), 2 * (x * y + w * z)))

    def sees(self, point):
        off = minus(point, self.at)
        return (dot(self.heading, off), cross(self.heading, off))


def turn_to(here, direction, speed, turn_speed):
    return (0.0, max(-turn_speed, min(3 * turn_between(here.heading, direction), turn_speed)))


def drive_along(here, direction, speed, turn_speed):
    return (speed * max(0.0, dot(here.heading, direction)), turn_to(here, direction, speed, turn_speed)[1])


def drive_to(here, point, speed, turn_speed):
    way = minus(point, here.at)
    distance = norm(way)
    if distance < 1e-6:
        return (0.0, 0.0)
    direction = unit(way)
    if dot(here.heading, direction) < 0.5:
        return turn_to(here, direction, speed, turn_speed)
    return drive_along(here, direction, max(0.2, min(distance / 0.1, 1.0)) * speed, turn_speed)


def way_around(start, to, discs):
    """discs: pairs of centre and radius."""
    aim, passed = to, None
    for _ in range(4):
        length = norm(minus(aim, start))
        if length < 1e-6:
            return aim
        straight = unit(minus(aim, start))
        nearest, nearest_m, nearest_radius_m = None, 0.0, 0.0
        for i, (centre, disc_radius) in enumerate(discs):
            if i == passed or norm(minus(centre, to)) < disc_radius:
                continue
            off = minus(centre, start)
            radius = min(disc_radius, 0.95 * norm(off))
            ahead = dot(off, straight)
            if ahead <= 0 or ahead - radius > length or abs(cross(straight, off)) >= radius:
                continue
            if nearest is None or ahead < nearest_m:
                nearest, nearest_m, nearest_radius_m = i, ahead, radius
        if nearest is None:
            return aim
        off = minus(discs[nearest][0], start)
        apart = norm(off)
        sine = (1.0 if cross(off, minus(to, start)) >= 0 else -1.0) * nearest_radius_m / apart
        cosine = math.sqrt(1 - sine * sine)
        tangent = max(math.sqrt(max(0.0, apart * apart - nearest_radius_m * nearest_radius_m)), 0.1)
        ux, uy = unit(off)
        aim = along(start, tangent, (cosine * ux - sine * uy, sine * ux + cosine * uy))
        passed = nearest
    return aim


# ------------------------------------------------------------------------------------------------------------ the law

CHOOSE, APPROACH, PUSH, BACK_OFF = range(4)
STANDS = (0.0, 0.0)
TO_SEND, TO_WAIT = 1, 2  # uses of random numbers


def ns(seconds):
    return int(seconds * 1e9 + 0.5)


def at(thing):
    return (thing["pose"]["position"]["x"], thing["pose"]["position"]["y"])


def find(world, name):
    return next((thing for thing in world["objects"] if thing["name"] == name), None)


def parse(data):
    """(object, bid) of b"box3 1250"; None for anything else, such as what bit errors have made of it."""
    thing, blank, digits = data.partition(b" ")
    if not blank or not digits.isdigit() or int(digits) >= 1 << 32:
        return None
    return thing.decode("utf-8", "replace"), int(digits)


class Clearing:
    """The five steps of the paper, see src/controllers/clearing/clearing.h, which also says what the numbers mean."""

    objects, margin, speed, push_speed, turn_speed = "box", 0.1, 0.4, 0.25, 2.5
    standoff, reach, zone, zone_angle = 0.34, 0.48, 0.09, 0.7
    object_clearance, robot_clearance, patience = 0.26, 0.36, 20.0

    def __init__(self, name, destination, radius):
        self.name, self.destination, self.radius = name, destination, radius
        self.phase, self.object = CHOOSE, ""
        self.nearest, self.progress, self.patience_now = 0.0, 0, 0.0
        self.backing_until = 0
        self.stood, self.stood_since = (0.0, 0.0, 0.0), 0
        self.left_alone, self.left_alone_until = "", 0
        self.sent_object, self.resend = "", 0
        self.claims = {}
        self.delivered = 0

    def step(self, now, random, world, packets):
        """Returns the speeds ordered, ahead and of turning, and the text to send, if any. packets: that came since the step before."""
        me = find(world, self.name)
        if not me:
            return STANDS, None
        self.now, self.random, self.world, self.here = now, random, world, Place(me["pose"])
        self.receive(packets)
        motion = self.decide()
        return motion, self.claim()

    def receive(self, packets):
        for each in packets:
            claim = parse(data_of(each))
            if each["from"] == self.name or not claim or (claim[0] and not find(self.world, claim[0])):
                continue
            if each["from"] in self.claims or len(self.claims) < 64:
                self.claims[each["from"]] = (*claim, self.now)

    def claim(self):
        if self.object == self.sent_object and self.now < self.resend:
            return None
        thing = find(self.world, self.object)
        self.sent_object = self.object
        self.resend = self.now + ns(0.2 + (0.6 - 0.2) * draw(self.random, TO_SEND))
        return "%s %d" % (self.object, self.bid(thing) if thing else 0)

    def outside(self, thing):
        return norm(minus(at(thing), self.destination)) - max(0.0, self.radius - self.margin)

    def bid(self, thing):
        if self.phase == PUSH:
            return 0
        return 1 + int(1000 * min(norm(minus(at(thing), self.here.at)), 1e6))

    def taken(self, name, bid):
        return any(thing == name and self.now - received < ns(2) and
                   (other < bid or (other == bid and robot < self.name))
                   for robot, (thing, other, received) in self.claims.items())

    def in_zone(self, thing):
        x, y = self.here.sees(at(thing))
        turn = turn_between(self.here.heading, minus(self.destination, at(thing)))
        return 0 < x < self.reach and abs(y) < self.zone and abs(turn) < self.zone_angle

    def choose(self):
        best, best_bid = None, 0
        for thing in self.world["objects"]:
            name = thing["name"]
            if thing["label"] != self.objects or not name or self.outside(thing) <= 0:
                continue
            if name == self.left_alone and self.now < self.left_alone_until:
                continue
            bid = self.bid(thing)
            if (best is None or bid < best_bid) and not self.taken(name, bid):
                best, best_bid = thing, bid
        if best:
            self.object, self.phase = best["name"], APPROACH
            self.nearest, self.progress = self.outside(best), self.now
            self.patience_now = self.patience * (0.75 + 0.5 * draw(self.random, TO_WAIT))
        return best

    def back_off(self):
        self.phase = BACK_OFF
        self.backing_until = self.stood_since = self.now + ns(0.9)
        return STANDS

    def jammed(self):
        place, heading = self.here.at, angle_of(self.here.heading)
        moved = (norm(minus(place, self.stood[:2])) > 0.06 or
                 abs(angle_between(self.stood[2], heading)) > 0.35)
        if moved or self.phase in (CHOOSE, BACK_OFF):
            self.stood, self.stood_since = (*place, heading), self.now
        return self.now - self.stood_since > ns(3)

    def approach(self, thing):
        here, there = self.here, at(thing)
        to_goal = unit(minus(self.destination, there))
        off = minus(there, here.at)
        ahead, beside = dot(off, to_goal), abs(cross(to_goal, off))
        if ahead > 0 and beside < 0.05 and ahead < self.standoff + 2 * 0.05:
            if abs(turn_between(here.heading, to_goal)) > 0.12:
                return turn_to(here, to_goal, self.speed, self.turn_speed)
            self.phase = PUSH
            return self.push(thing)
        behind = minus(there, (self.standoff * to_goal[0], self.standoff * to_goal[1]))
        discs = [(at(each), self.object_clearance if each["label"] == self.objects else self.robot_clearance)
                 for each in self.world["objects"] if each["name"] != self.name]
        return drive_to(here, way_around(here.at, behind, discs), self.speed, self.turn_speed)

    def push(self, thing):
        goal = turn_between(self.here.heading, minus(self.destination, self.here.at))
        side = angle_of(self.here.sees(at(thing)))
        widest = self.push_speed / 0.35
        return (self.push_speed, max(-widest, min(1.5 * goal + 2.5 * side, widest)))

    def wait(self):
        nearest, nearest_m = None, 0.6
        for other in self.world["objects"]:
            apart = norm(minus(at(other), self.here.at))
            if other["name"] != self.name and other["label"] != self.objects and apart < nearest_m:
                nearest, nearest_m = other, apart
        if not nearest:
            return STANDS
        return drive_along(self.here, unit(minus(self.here.at, at(nearest))), 0.5 * self.speed, self.turn_speed)

    def decide(self):
        if self.phase == BACK_OFF:
            if self.now < self.backing_until:
                return (-0.25, 0.0)
            self.phase = APPROACH if self.object else CHOOSE
        if self.jammed():
            return self.back_off()
        thing = find(self.world, self.object) if self.object else None
        if thing and (self.taken(self.object, self.bid(thing)) or self.outside(thing) <= 0):
            pushed, done = self.phase == PUSH, not self.taken(self.object, self.bid(thing))
            self.delivered += pushed and done
            self.object, self.phase, thing = "", CHOOSE, None
            if pushed:
                return self.back_off()
        if thing and self.outside(thing) < self.nearest - 0.05:
            self.nearest, self.progress = self.outside(thing), self.now
        patient = self.now - self.progress <= ns(self.patience_now)
        if thing and not patient:
            self.left_alone, self.left_alone_until = self.object, self.now + ns(self.patience_now)
            self.object = ""
            return self.back_off()
        if not thing and self.object and patient:
            return STANDS  # it is not in this picture
        if not thing:
            self.object, self.phase = "", CHOOSE
            thing = self.choose()
        if not thing:
            return self.wait()
        if self.phase == PUSH and not self.in_zone(thing):
            return self.back_off()
        return self.push(thing) if self.phase == PUSH else self.approach(thing)


def main():
    arguments = argparse.ArgumentParser(description="Pushes boxes into a disc, in agreement with team-mates by radio.")
    arguments.add_argument("robot")
    arguments.add_argument("--destination", nargs=2, type=float, default=(1.6, 0.0), metavar=("X", "Y"))
    arguments.add_argument("--radius", type=float, default=0.6)
    arguments.add_argument("--deadline", type=float, default=5, help="longest time for an answer [s]")
    given = arguments.parse_args()
    law = Clearing(given.robot, tuple(given.destination), given.radius)
    with Robot(given.robot, lockstep=True, deadline_s=given.deadline) as robot:
        camera, radio = robot.subscribe("camera"), robot.subscribe("radio")
        for step in robot.steps():
            packets = radio.message["packets"] if radio.fresh() else []
            motion, text = STANDS, None
            if camera.message:
                motion, text = law.step(step.time_ns, step.random, camera.message, packets)
            robot.command("drive", {"linear": {"x": motion[0]}, "angular": {"z": motion[1]}})
            if text is not None:
                robot.command("radio", packet(text.encode()))
    print("%s has brought %d boxes" % (given.robot, law.delivered))


if __name__ == "__main__":
    main()
