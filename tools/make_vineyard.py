#!/usr/bin/env python3
"""Writes worlds/vineyard.sdf and worlds/vineyard_heights.png: rolling ground with rows of vines for field robots.

    tools/make_vineyard.py [FOLDER]      FOLDER is worlds/ when left out

The ground is a sum of three waves, so that heights can be worked out by hand; the steepest place is about 9 degrees.
"""
import math
import os
import struct
import sys
import zlib

SIZE_M = 24.0
SAMPLES = 129
ROWS_Y = [-4.4, -2.2, 0.0, 2.2, 4.4]
PLANTS_X = [-6.3 + 1.4 * i for i in range(10)]


def height_m(x, y):
    """Height of the ground, above 0."""
    return (0.6 + 0.30 * math.sin(2 * math.pi * x / 16) * math.cos(2 * math.pi * y / 22)
            + 0.18 * math.cos(2 * math.pi * (x + y) / 13) + 0.06 * math.sin(2 * math.pi * (x - 2 * y) / 7))


def png16(rows):
    """Bytes of a 16 bit grey PNG."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + struct.pack(f">{len(row)}H", *row) for row in rows)
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 16, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")


def heights():
    """Of the pixels, from the upper left corner: x grows to the right, y upwards."""
    step = SIZE_M / (SAMPLES - 1)
    return [[height_m(-SIZE_M / 2 + i * step, SIZE_M / 2 - j * step) for i in range(SAMPLES)] for j in range(SAMPLES)]


def solid(kind, name, pose, shape, colour):
    return f"""        <{kind} name="{name}">
          <pose>{pose}</pose>
          <geometry>{shape}</geometry>
{colour}        </{kind}>
"""


def colour(rgb):
    return f"          <material><diffuse>{rgb} 1</diffuse></material>\n"


def plant(row, number, x, y):
    # A little unlike its neighbours, in a way that is the same every time.
    lean = 0.05 * math.sin(3.7 * row + 2.3 * number)
    wide = 0.46 + 0.06 * math.sin(1.9 * row + 5.1 * number)
    trunk = "<cylinder><radius>0.035</radius><length>1.0</length></cylinder>"
    crown = f"<ellipsoid><radii>{wide:.3f} 0.22 0.38</radii></ellipsoid>"
    return f"""    <model name="vine_{row}_{number}">
      <static>true</static>
      <pose>{x:.2f} {y:.2f} {height_m(x, y) - 0.1:.3f} {lean:.3f} 0 0</pose>
      <link name="link">
{solid("collision", "trunk", "0 0 0.5 0 0 0", trunk, "")}{solid("collision", "crown", "0 0 1.15 0 0 0", crown, "")}\
{solid("visual", "trunk", "0 0 0.5 0 0 0", trunk, colour("0.35 0.25 0.16"))}\
{solid("visual", "crown", "0 0 1.15 0 0 0", crown, colour(f"{0.20 + 0.08 * wide:.2f} 0.45 0.16"))}      </link>
    </model>
"""


def world(top_m):
    ground = (f"<heightmap><uri>vineyard_heights.png</uri><size>{SIZE_M:g} {SIZE_M:g} {top_m:.6f}</size>"
              "<pos>0 0 0</pos></heightmap>")
    plants = "".join(plant(r, i, x, y) for r, y in enumerate(ROWS_Y) for i, x in enumerate(PLANTS_X))
    return f"""<?xml version="1.0"?>
<!-- Written by tools/make_vineyard.py: {len(ROWS_Y)} rows of {len(PLANTS_X)} vines on rolling ground. -->
<sdf version="1.9">
  <world name="vineyard">
    <physics type="ode"><max_step_size>0.005</max_step_size></physics>
    <light name="sun" type="directional">
      <cast_shadows>true</cast_shadows>
      <diffuse>0.95 0.92 0.85 1</diffuse>
      <direction>-0.5 0.2 -0.85</direction>
    </light>
    <model name="ground">
      <static>true</static>
      <link name="link">
        <collision name="terrain">
          <geometry>{ground}</geometry>
          <surface><friction><ode><mu>0.9</mu><mu2>0.9</mu2></ode></friction></surface>
        </collision>
        <visual name="terrain">
          <geometry>{ground}</geometry>
          <material><diffuse>0.55 0.47 0.33 1</diffuse></material>
        </visual>
      </link>
    </model>
{plants}  </world>
</sdf>
"""


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "worlds")
    rows = heights()
    top_m = max(max(row) for row in rows)  # the brightest pixel stands for <size>'s z
    with open(os.path.join(folder, "vineyard_heights.png"), "wb") as file:
        file.write(png16([[round(65535 * h / top_m) for h in row] for row in rows]))
    with open(os.path.join(folder, "vineyard.sdf"), "w", encoding="utf-8") as file:
        file.write(world(top_m))


if __name__ == "__main__":
    main()
