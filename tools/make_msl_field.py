#!/usr/bin/env python3
"""Writes the football field of the Middle Size League: worlds/msl_field.sdf with msl_field.obj, .mtl and .png beside it.

    tools/make_msl_field.py [FOLDER]      FOLDER is worlds when left out

Numbers: rule book of 2023, table of fields, the one of 22 x 14 m, measured to the outside of lines. The field lies on a carpet that
reaches BORDER further; boards stand around it. The lines are a texture of 1 cm to a pixel whose edges are true to a fraction of
that, because each pixel is as white as the share of it that is line; far away renderers filter them.
"""
import math
import pathlib
import struct
import sys
import zlib

LENGTH, WIDTH = 22.0, 14.0
PENALTY_WIDTH, PENALTY_DEPTH = 6.9, 2.25
GOAL_WIDTH, GOAL_DEPTH = 3.9, 0.75
CORNER_RADIUS, CIRCLE = 0.75, 4.0
PENALTY_MARK, MARK = 3.6, 0.15
LINE, BORDER = 0.125, 1.0
TEXEL = 0.01
GREEN, WHITE = (38, 110, 48), (240, 240, 236)

size_x, size_y = LENGTH + 2 * BORDER, WIDTH + 2 * BORDER
columns, rows = round(size_x / TEXEL), round(size_y / TEXEL)
share = [bytearray(columns) for _ in range(rows)]  # of line, 255: all; row 0 is at +y


def column(x):
    return (x + size_x / 2) / TEXEL


def row(y):
    return (size_y / 2 - y) / TEXEL


def overlaps(low, high):
    """(pixel, share of it) of an interval in pixels."""
    for i in range(math.floor(low), math.ceil(high)):
        part = min(high, i + 1) - max(low, i)
        if part > 1e-9:
            yield i, part


def rectangle(x0, x1, y0, y1):
    for j, part_y in overlaps(row(y1), row(y0)):
        for i, part_x in overlaps(column(x0), column(x1)):
            share[j][i] = max(share[j][i], round(255 * part_x * part_y))


def ring(cx, cy, inner, outer, kept=lambda x, y: True):
    """What lies between two radii, and where `kept` says so."""
    for j in range(math.floor(row(cy + outer)) - 1, math.ceil(row(cy - outer)) + 1):
        for i in range(math.floor(column(cx - outer)) - 1, math.ceil(column(cx + outer)) + 1):
            x, y = (i + 0.5) * TEXEL - size_x / 2, size_y / 2 - (j + 0.5) * TEXEL
            r = math.hypot(x - cx, y - cy)
            part = min(1.0, max(0.0, min(outer - r, r - inner) / TEXEL + 0.5))
            if part > 0 and kept(x, y):
                share[j][i] = max(share[j][i], round(255 * part))


def frame(x0, x1, y0, y1):
    """The lines inside the edge of a rectangle."""
    rectangle(x0, x1, y0, y0 + LINE)
    rectangle(x0, x1, y1 - LINE, y1)
    rectangle(x0, x0 + LINE, y0, y1)
    rectangle(x1 - LINE, x1, y0, y1)


def draw():
    half_x, half_y = LENGTH / 2, WIDTH / 2
    frame(-half_x, half_x, -half_y, half_y)
    rectangle(-LINE / 2, LINE / 2, -half_y, half_y)
    ring(0, 0, CIRCLE / 2 - LINE, CIRCLE / 2)
    ring(0, 0, -1, MARK / 2)
    for side in (-1, 1):
        for wide, deep in ((PENALTY_WIDTH, PENALTY_DEPTH), (GOAL_WIDTH, GOAL_DEPTH)):
            x = sorted((side * half_x, side * (half_x - deep)))
            frame(*x, -wide / 2, wide / 2)
        ring(side * (half_x - PENALTY_MARK), 0, -1, MARK / 2)
        for other in (-1, 1):
            ring(side * half_x, other * half_y, CORNER_RADIUS - LINE, CORNER_RADIUS,
                 lambda x, y: abs(x) < half_x and abs(y) < half_y)


def png():
    palette = [tuple(round(g + (w - g) * k / 255) for g, w in zip(GREEN, WHITE)) for k in range(256)]

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    raw = b"".join(b"\0" + bytes(line) for line in share)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 3, 0, 0, 0))
            + chunk(b"PLTE", b"".join(bytes(c) for c in palette)) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def boards():
    out, thick, high = "", 0.05, 0.1
    x, y = size_x / 2 + thick / 2, size_y / 2 + thick / 2
    for name, at, box in (("north", (0, y), (size_x + 2 * thick, thick)), ("south", (0, -y), (size_x + 2 * thick, thick)),
                          ("east", (x, 0), (thick, size_y)), ("west", (-x, 0), (thick, size_y))):
        shape = (f"<pose>{at[0]:g} {at[1]:g} {high / 2:g} 0 0 0</pose><geometry><box><size>{box[0]:g} {box[1]:g} {high:g}</size></box>"
                 "</geometry>")
        out += (f'        <collision name="{name}">{shape}</collision>\n        <visual name="{name}">{shape}\n'
                "          <material><diffuse>0.25 0.26 0.28 1</diffuse></material></visual>\n")
    return out


SDF = """<?xml version="1.0"?>
<!-- A football field of the Middle Size League, 22 x 14 m, made by tools/make_msl_field.py. x along it, origin in its middle.
     Goals, ball and robots come from scenarios/msl_field.yaml. -->
<sdf version="1.9" xmlns:sandlot="urn:sandlot:sdf">
  <world name="msl_field">
    <gravity>0 0 -9.81</gravity>
    <scene><ambient>0.5 0.5 0.5 1</ambient><background>0.72 0.76 0.8 1</background></scene>
    <light name="sun" type="directional"><pose>0 0 12 0 0 0</pose><cast_shadows>true</cast_shadows>
      <diffuse>0.75 0.74 0.7 1</diffuse><specular>0.4 0.4 0.4 1</specular><direction>-0.35 0.45 -0.82</direction></light>
    <model name="ground">
      <static>true</static>
      <link name="link">
        <collision name="ground"><geometry><plane><normal>0 0 1</normal></plane></geometry></collision>
        <!-- the floor of the hall, a little below the carpet -->
        <visual name="floor"><pose>0 0 -0.01 0 0 0</pose><geometry><plane><normal>0 0 1</normal><size>80 80</size></plane></geometry>
          <material><diffuse>0.62 0.52 0.4 1</diffuse></material></visual>
        <visual name="carpet"><geometry><mesh><uri>msl_field.obj</uri></mesh></geometry></visual>
      </link>
    </model>
    <model name="boards">
      <static>true</static>
      <link name="link">
%s      </link>
    </model>
  </world>
</sdf>
"""


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "worlds")
    draw()
    (folder / "msl_field.png").write_bytes(png())
    x, y = size_x / 2, size_y / 2
    (folder / "msl_field.obj").write_text(
        "# The carpet of msl_field.sdf, made by tools/make_msl_field.py.\nmtllib msl_field.mtl\no carpet\n"
        f"v {-x:g} {-y:g} 0\nv {x:g} {-y:g} 0\nv {x:g} {y:g} 0\nv {-x:g} {y:g} 0\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl carpet\nf 1/1 2/2 3/3 4/4\n")
    (folder / "msl_field.mtl").write_text("newmtl carpet\nKd 1 1 1\nmap_Kd msl_field.png\n")
    (folder / "msl_field.sdf").write_text(SDF % boards())


main()
