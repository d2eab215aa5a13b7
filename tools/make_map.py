#!/usr/bin/env python3
"""Draws the map that a laser would make of an SDF world: a PGM picture and a YAML file, as map_server of ROS reads them.

    tools/make_map.py worlds/indoor.sdf --height 0.25 --inside 1.6 4.65 worlds/maps/indoor

writes worlds/maps/indoor.yaml and .pgm. Cut at the height are the collisions (boxes, cylinders and spheres, at any pose) of all static models.
A cell is occupied when one of 5 x 5 points in it lies within a shape, so that thin legs show. With --inside, cells that a point could not reach from
there are unknown, such as what lies outside the walls; without it, all that is not occupied is free.

Left out, with a warning: other shapes than these, models of <include>, models within models, poses that are relative to another frame or are quaternions.
A plane is ground, not an obstacle.
"""
import argparse
import math
import os
import sys
import xml.etree.ElementTree as ET

OCCUPIED, FREE, UNKNOWN = 0, 254, 205
POINTS = 5  # a side of a cell
MOST_CELLS = 2**26  # that a map of Sandlot may have


class Wrong(Exception):
    """A mistake of the user: what is wrong and what would be right."""


def numbers(text, count, label):
    try:
        values = [float(word) for word in (text or "").split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise Wrong(f"{label} is '{(text or '').strip()}'; {count} number{'s' if count > 1 else ''} would be right")
    return values


def turn(roll, pitch, yaw):
    """Rotation matrix of SDF's roll, pitch and yaw."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    return ((cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
            (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
            (-sp, cp * sr, cp * cr))


def times(a, b):
    """a then b, each a rotation and a translation."""
    (R, p), (Q, q) = a, b
    return (tuple(tuple(sum(R[i][k] * Q[k][j] for k in range(3)) for j in range(3)) for i in range(3)),
            tuple(p[i] + sum(R[i][k] * q[k] for k in range(3)) for i in range(3)))


IDENTITY = (turn(0, 0, 0), (0.0, 0.0, 0.0))


class World:
    """Shapes of the static models: what they are, their size, their pose, and half the size of the upright box about it that holds them."""

    def __init__(self, path):
        self.shapes, self.left_out = [], []
        try:
            root = ET.parse(path).getroot()
        except OSError as error:
            raise Wrong(f"{path}: {error.strerror}") from None
        except ET.ParseError as error:
            raise Wrong(f"{path}:{error.position[0]}: this is not XML ({error}); an SDF world would be right") from None
        worlds = list(root.iter("world"))
        if not worlds:
            raise Wrong(f"{path}: there is no <world> in <{root.tag}>; an SDF world would be right")
        for world in worlds:
            self.left_out += [f"include of {each.findtext('uri')}" for each in world.findall("include")]
            for model in world.findall("model"):
                self.add_model(model, IDENTITY, model.get("name"))

    def pose(self, element, name):
        pose = element.find("pose")
        if pose is None:
            return IDENTITY
        if pose.get("relative_to"):
            self.left_out.append(f"{name}: its pose is relative to {pose.get('relative_to')}")
            return None
        if pose.get("rotation_format", "euler_rpy") != "euler_rpy":
            self.left_out.append(f"{name}: its pose is a {pose.get('rotation_format')}")
            return None
        x, y, z, *angles = numbers(pose.text, 6, f"{name}: <pose>")
        if pose.get("degrees") in ("true", "1"):
            angles = map(math.radians, angles)
        return turn(*angles), (x, y, z)

    def add_model(self, model, parent, name):
        if (model.findtext("static") or "").strip() not in ("true", "1"):
            return
        at = self.pose(model, name)
        if at is None:
            return
        at = times(parent, at)
        self.left_out += [f"{name}/{each.get('name')}: a model within a model" for each in model.findall("model")]
        for link in model.findall("link"):
            of_link = self.pose(link, f"{name}/{link.get('name')}")
            for collision in link.findall("collision") if of_link else []:
                label = f"{name}/{link.get('name')}/{collision.get('name')}"
                of_shape = self.pose(collision, label)
                if of_shape:
                    shape = collision.find("geometry/*")
                    if shape is None:
                        raise Wrong(f"{label}: no shape in <geometry>; a <box> would be right")
                    self.add_shape(shape, times(times(at, of_link), of_shape), label)

    def add_shape(self, shape, pose, label):
        if shape.tag == "box":
            size = [x / 2 for x in numbers(shape.findtext("size"), 3, f"{label}: <size>")]
        elif shape.tag == "cylinder":
            size = [*numbers(shape.findtext("radius"), 1, f"{label}: <radius>"), numbers(shape.findtext("length"), 1, f"{label}: <length>")[0] / 2]
        elif shape.tag == "sphere":
            size = numbers(shape.findtext("radius"), 1, f"{label}: <radius>")
        else:
            if shape.tag != "plane":
                self.left_out.append(f"{label}: a {shape.tag}")
            return
        sides = {"box": size, "cylinder": [size[0], *size], "sphere": size * 3}[shape.tag]
        reach = [sum(abs(row[j]) * sides[j] for j in range(3)) for row in pose[0]]
        self.shapes.append((shape.tag, size, pose, reach))


def within(shape, x, y, z):
    kind, size, (R, p), _ = shape
    d = (x - p[0], y - p[1], z - p[2])
    a, b, c = (sum(R[i][j] * d[i] for i in range(3)) for j in range(3))
    if kind == "box":
        return abs(a) <= size[0] and abs(b) <= size[1] and abs(c) <= size[2]
    if kind == "cylinder":
        return math.hypot(a, b) <= size[0] and abs(c) <= size[1]
    return math.hypot(a, b, c) <= size[0]


def draw(shapes, height, resolution, margin):
    """Rows of pixels from the lowest y upwards, and the lower left corner."""
    cut = [s for s in shapes if abs(s[2][1][2] - height) <= s[3][2]]
    if not cut:
        raise Wrong(f"no static shape reaches the height {height} m; give another --height")
    # Corners on multiples of the resolution: two maps of a world lie on one grid.
    low = [math.floor(min(s[2][1][i] - s[3][i] for s in cut) / resolution) for i in range(2)]
    high = [math.ceil(max(s[2][1][i] + s[3][i] for s in cut) / resolution) for i in range(2)]
    if (high[0] - low[0] + 2 * margin / resolution) * (high[1] - low[1] + 2 * margin / resolution) > MOST_CELLS:
        raise Wrong(f"the map would have {high[0] - low[0]} x {high[1] - low[1]} cells, of at most {MOST_CELLS}; give a larger --resolution")
    rows = [bytearray([FREE]) * (high[0] - low[0]) for _ in range(high[1] - low[1])]
    step = resolution / POINTS
    for shape in cut:
        (x, y, _), reach = shape[2][1], shape[3]
        for row in range(math.floor((y - reach[1]) / resolution), math.ceil((y + reach[1]) / resolution)):
            for column in range(math.floor((x - reach[0]) / resolution), math.ceil((x + reach[0]) / resolution)):
                if rows[row - low[1]][column - low[0]] == FREE and any(
                        within(shape, column * resolution + (i + 0.5) * step, row * resolution + (j + 0.5) * step, height)
                        for i in range(POINTS) for j in range(POINTS)):
                    rows[row - low[1]][column - low[0]] = OCCUPIED
    return trimmed(rows, low, round(margin / resolution))


def trimmed(rows, low, margin):
    """The part that has something in it, and a margin about it."""
    used = [i for i, row in enumerate(rows) if OCCUPIED in row]
    columns = [i for i in range(len(rows[0])) if any(row[i] == OCCUPIED for row in rows)]
    if not used:
        raise Wrong("nothing is cut at this height; give another --height")
    empty = bytes([FREE]) * (columns[-1] - columns[0] + 1 + 2 * margin)
    side = bytes([FREE]) * margin
    body = [bytearray(side + row[columns[0]:columns[-1] + 1] + side) for row in rows[used[0]:used[-1] + 1]]
    return ([bytearray(empty) for _ in range(margin)] + body + [bytearray(empty) for _ in range(margin)],
            (low[0] + columns[0] - margin, low[1] + used[0] - margin))


def hide_unreached(rows, start):
    """Makes free cells that no way of free neighbours leads to unknown."""
    width, height = len(rows[0]), len(rows)
    column, row = start
    if not (0 <= column < width and 0 <= row < height and rows[row][column] == FREE):
        raise Wrong("the point --inside is off the map or within a shape")
    reached, todo = {start}, [start]
    while todo:
        x, y = todo.pop()
        for cell in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
            if 0 <= cell[0] < width and 0 <= cell[1] < height and cell not in reached and rows[cell[1]][cell[0]] == FREE:
                reached.add(cell)
                todo.append(cell)
    for y, line in enumerate(rows):
        for x, pixel in enumerate(line):
            if pixel == FREE and (x, y) not in reached:
                line[x] = UNKNOWN


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("world", help="SDF file")
    parser.add_argument("out", help="path of the map, without .yaml")
    parser.add_argument("--height", type=float, default=0.25, help="of the cut above 0 [m]; 0.25")
    parser.add_argument("--resolution", type=float, default=0.05, help="side of a cell [m]; 0.05")
    parser.add_argument("--margin", type=float, default=0.1, help="free room about what is drawn [m]; 0.1")
    parser.add_argument("--inside", type=float, nargs=2, metavar=("X", "Y"), help="point from which the free cells are reached")
    options = parser.parse_args()
    if not all(map(math.isfinite, [options.height, options.resolution, options.margin, *(options.inside or [])])):
        raise Wrong("a number among the options is not finite")
    if options.resolution <= 0 or options.margin < 0:
        raise Wrong("--resolution must be above 0, --margin not below")
    world = World(options.world)
    for each in world.left_out:
        print(f"make_map: left out: {each}", file=sys.stderr)
    rows, low = draw(world.shapes, options.height, options.resolution, options.margin)
    if options.inside:
        hide_unreached(rows, tuple(math.floor(x / options.resolution) - corner for x, corner in zip(options.inside, low)))
    name = os.path.basename(options.out)
    if os.path.dirname(options.out):
        os.makedirs(os.path.dirname(options.out), exist_ok=True)
    with open(options.out + ".pgm", "wb") as file:
        file.write(f"P5\n{len(rows[0])} {len(rows)}\n255\n".encode() + b"".join(reversed(rows)))
    corner = [f"{x * options.resolution:.10g}" for x in low]
    with open(options.out + ".yaml", "w", encoding="utf-8") as file:
        file.write(f"# {os.path.basename(options.world)} at a height of {options.height:g} m, by tools/make_map.py\n"
                   f"image: {name}.pgm\nresolution: {options.resolution:g}\norigin: [{corner[0]}, {corner[1]}, 0]\n"
                   "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")
    print(f"{options.out}.yaml: {len(rows[0])} x {len(rows)} cells")


if __name__ == "__main__":
    try:
        main()
    except (Wrong, OSError) as wrong:
        print(f"make_map: {wrong}", file=sys.stderr)
        sys.exit(2)
