#!/usr/bin/env python3
"""Writes worlds/playground.sdf: a fenced yard with things to push, a bridge, a turnstile and a row of pendulums.

    tools/make_playground.py [FILE]      FILE is worlds/playground.sdf when left out

The pendulums swing 18, 19, ... 26 times in 40 s, so that they fall out of step and come together again.
"""
import math
import sys

ORANGE, BLUE, YELLOW = "0.86 0.38 0.12", "0.13 0.42 0.72", "0.95 0.74 0.17"
GREEN, PLUM, TEAL, RED = "0.25 0.58 0.33", "0.55 0.28 0.52", "0.1 0.55 0.55", "0.78 0.18 0.16"
WOOD, DARK, SAND, GROUND = "0.72 0.55 0.36", "0.2 0.22 0.26", "0.87 0.78 0.58", "0.5 0.56 0.47"
COLOURS = [ORANGE, BLUE, YELLOW, GREEN, PLUM, TEAL, RED]
GRAVITY = 9.81


def box(x, y, z):
    return f"<box><size>{x:g} {y:g} {z:g}</size></box>"


def cylinder(r, length):
    return f"<cylinder><radius>{r:g}</radius><length>{length:g}</length></cylinder>"


def sphere(r):
    return f"<sphere><radius>{r:g}</radius></sphere>"


def pose(*numbers):
    return "<pose>" + " ".join(f"{n:.5g}" for n in (*numbers, *[0] * (6 - len(numbers)))) + "</pose>"


def part(name, shape, rgb, at=(0, 0, 0), solid=True, surface=""):
    """A visual and, if it is solid, the same as collision."""
    out = ""
    if solid:
        out += f'        <collision name="{name}">{pose(*at)}<geometry>{shape}</geometry>{surface}</collision>\n'
    return out + (f'        <visual name="{name}">{pose(*at)}<geometry>{shape}</geometry>\n'
                  f'          <material><diffuse>{rgb} 1</diffuse><specular>0.15 0.15 0.15 1</specular></material></visual>\n')


def inertial(mass, ixx, iyy, izz):
    return (f"        <inertial><mass>{mass:.4g}</mass><inertia><ixx>{ixx:.4g}</ixx><ixy>0</ixy><ixz>0</ixz>"
            f"<iyy>{iyy:.4g}</iyy><iyz>0</iyz><izz>{izz:.4g}</izz></inertia></inertial>\n")


def of_box(m, x, y, z):
    return inertial(m, m * (y * y + z * z) / 12, m * (x * x + z * z) / 12, m * (x * x + y * y) / 12)


def of_sphere(m, r):
    return inertial(m, *[0.4 * m * r * r] * 3)


def of_cylinder(m, r, h):
    side = m * (3 * r * r + h * h) / 12
    return inertial(m, side, side, m * r * r / 2)


def model(name, at, content, static=False):
    fixed = "      <static>true</static>\n" if static else ""
    return f'    <model name="{name}">\n{fixed}      {pose(*at)}\n{content}    </model>\n'


def link(content, name="link", at=(0, 0, 0)):
    return f'      <link name="{name}">\n        {pose(*at)}\n{content}      </link>\n'


def thing(name, at, mass_properties, shape, rgb, surface=""):
    return model(name, at, link(mass_properties + part("shape", shape, rgb, surface=surface)))


def fence():
    out = ""
    for name, at, size in (("north", (0, 6, 0.2), (16.2, 0.2, 0.4)), ("south", (0, -6, 0.2), (16.2, 0.2, 0.4)),
                           ("east", (8, 0, 0.2), (0.2, 11.8, 0.4)), ("west", (-8, 0, 0.2), (0.2, 11.8, 0.4))):
        out += part(name, box(*size), WOOD, at)
    return model("fence", (0, 0, 0), link(out), static=True)


def bridge():
    """Up, along and down again in x: ramps of 10 degrees to a deck 0.22 m up."""
    angle, height, width, thick = math.radians(10), 0.22, 1.1, 0.06
    run = height / math.tan(angle)
    slope = height / math.sin(angle)
    # The upper face of a ramp begins on the ground: its middle lies half a thickness below that face.
    lift = height / 2 - thick / 2 * math.cos(angle)
    shift = thick / 2 * math.sin(angle)
    out = part("up", box(slope, width, thick), TEAL, (-0.6 - run / 2 + shift, 0, lift, 0, -angle, 0))
    out += part("deck", box(1.2, width, height), DARK, (0, 0, height / 2))
    out += part("down", box(slope, width, thick), TEAL, (0.6 + run / 2 - shift, 0, lift, 0, angle, 0))
    return model("bridge", (-3.4, 4.6, 0), link(out), static=True)


def turnstile():
    """Four arms that turn about a post when somebody pushes them."""
    arms = inertial(2, 0.35, 0.35, 0.7)
    for i in range(4):
        a = i * math.pi / 2
        arms += part(f"arm{i}", box(1.0, 0.06, 0.12), COLOURS[i],
                     (0.55 * math.cos(a), 0.55 * math.sin(a), 0, 0, 0, a))
    post = part("post", cylinder(0.06, 0.6), DARK, (0, 0, 0.3))
    joint = ('      <joint name="hinge" type="revolute"><parent>post</parent><child>arms</child>\n'
             "        <axis><xyz>0 0 1</xyz><dynamics><damping>0.3</damping></dynamics></axis></joint>\n"
             '      <joint name="foot" type="fixed"><parent>world</parent><child>post</child></joint>\n')
    return model("turnstile", (5.6, -2.2, 0),
                 link(inertial(5, 0.2, 0.2, 0.01) + post, "post") + link(arms, "arms", (0, 0, 0.26)) + joint)


def pendulums():
    count, top, gap, r = 9, 1.7, 0.26, 0.085
    half = (count + 1) / 2 * gap
    frame = part("bar", box(2 * half, 0.06, 0.06), DARK, (0, 0, top))
    for side in (-1, 1):
        for leg in (-1, 1):
            # Legs lean together at the top.
            lean = math.atan2(0.45, top)
            frame += part(f"leg{side}{leg}".replace("-", "m"), cylinder(0.025, math.hypot(top, 0.45)), DARK,
                          (side * half, leg * 0.225, top / 2, leg * lean, 0, 0))
    out = link(inertial(20, 5, 5, 5) + frame, "frame")
    out += '      <joint name="foot" type="fixed"><parent>world</parent><child>frame</child></joint>\n'
    mass = 1.0
    for i in range(count):
        period = 40 / (26 - i)
        # The rod weighs nothing: (I + m l^2) / (m g l) = (T / 2 pi)^2 with I of the ball.
        q, ball = (period / (2 * math.pi)) ** 2 * GRAVITY, 0.4 * r * r
        length = (q + math.sqrt(q * q - 4 * ball)) / 2
        x = (i - (count - 1) / 2) * gap
        begin = 0.35
        # The link's origin is the ball's centre; it hangs `length` below the bar, turned about it.
        content = of_sphere(mass, r) + part("ball", sphere(r), COLOURS[i % len(COLOURS)])
        content += part("rod", cylinder(0.008, length), "0.8 0.8 0.8", (0, 0, length / 2), solid=False)
        out += link(content, f"ball{i}", (x, length * math.sin(begin), top - length * math.cos(begin), begin, 0, 0))
        out += (f'      <joint name="string{i}" type="revolute">{pose(0, 0, length)}<parent>frame</parent>'
                f"<child>ball{i}</child>\n        <axis><xyz>1 0 0</xyz></axis></joint>\n")
    return model("pendulums", (1.2, 4.9, 0), out)


def pyramid():
    size, out, n = (0.3, 0.24, 0.24), "", 0
    for row in range(4):
        for i in range(4 - row):
            x = (i - (3 - row) / 2) * 0.33
            out += thing(f"block{n}", (-5.4 + x, -4.0, 0.12 + 0.2405 * row), of_box(1.2, *size), box(*size),
                         COLOURS[n % len(COLOURS)])
            n += 1
    return out


def toys():
    # A ball that rolls loses energy, else it would never rest.
    rolling = "<surface><friction><ode><mu>0.6</mu><mu2>0.6</mu2></ode></friction><bounce><restitution_coefficient>0.5</restitution_coefficient></bounce></surface>"
    out = ""
    for i, (x, y, r) in enumerate(((0.9, -1.4, 0.2), (0.2, 0.6, 0.16), (1.0, -0.5, 0.24), (-0.4, -2.4, 0.18), (2.3, -3.6, 0.2))):
        out += thing(f"ball{i}", (x, y, r), of_sphere(0.3, r), sphere(r), COLOURS[(2 * i + 1) % len(COLOURS)], rolling)
    for i, (x, y, size, yaw) in enumerate(((-3.0, -1.2, 0.4, 0.3), (2.4, 1.4, 0.36, 0.9), (-6.4, 0.6, 0.44, 0.1), (3.4, -4.6, 0.4, 0.5),
                                           (-2.0, 1.6, 0.36, 1.2))):
        out += thing(f"crate{i}", (x, y, size / 2, 0, 0, yaw), of_box(1.5, size, size, size), box(size, size, size),
                     COLOURS[i % len(COLOURS)])
    for i, (x, y) in enumerate(((-0.6, -4.6), (0.4, -4.9), (-0.1, -4.2))):
        out += thing(f"drum{i}", (x, y, 0.25), of_cylinder(2, 0.18, 0.5), cylinder(0.18, 0.5), COLOURS[(i + 4) % len(COLOURS)])
    return out


def world():
    ground = link('        <collision name="ground"><geometry><plane><normal>0 0 1</normal></plane></geometry></collision>\n'
                  '        <visual name="ground"><geometry><plane><normal>0 0 1</normal><size>60 60</size></plane></geometry>\n'
                  f"          <material><diffuse>{GROUND} 1</diffuse></material></visual>\n"
                  + part("yard", box(16, 12, 0.004), SAND, (0, 0, 0.001), solid=False)
                  + part("ring", cylinder(1.3, 0.004), BLUE, (0, -0.4, 0.0025), solid=False)
                  + part("disc", cylinder(1.1, 0.004), "0.9 0.88 0.8", (0, -0.4, 0.004), solid=False))
    return ('<?xml version="1.0"?>\n'
            "<!-- A fenced yard of 16 x 12 m to play in, made by tools/make_playground.py. scenarios/yard.yaml puts robots into it. -->\n"
            '<sdf version="1.9">\n  <world name="playground">\n    <gravity>0 0 -9.81</gravity>\n'
            "    <scene><ambient>0.55 0.57 0.6 1</ambient><background>0.6 0.75 0.9 1</background></scene>\n"
            '    <light name="sun" type="directional"><pose>0 0 12 0 0 0</pose><cast_shadows>true</cast_shadows>'
            "<diffuse>0.95 0.92 0.85 1</diffuse><direction>-0.45 0.35 -0.85</direction></light>\n"
            + model("ground", (0, 0, 0), ground, static=True) + fence() + bridge() + turnstile() + pendulums() + pyramid() + toys()
            + "  </world>\n</sdf>\n")


if __name__ == "__main__":
    with open(sys.argv[1] if len(sys.argv) > 1 else "worlds/playground.sdf", "w", encoding="utf-8") as out:
        out.write(world())
