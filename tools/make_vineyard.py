#!/usr/bin/env python3
"""Writes worlds/vineyard.sdf, vineyard_heights.png and the textures/vineyard_*.png: rolling ground with rows of vines for field robots.

    tools/make_vineyard.py [--seed N] [FOLDER]      FOLDER is worlds/ when left out, the seed 0

The ground is a sum of three waves, so that heights can be worked out by hand; the steepest place is about 12 degrees. Another seed makes another
vineyard: waves with other phases, other vines, other textures, the same places of the rows. Printed is what a scenario needs to place a robot at the
beginning of the way between two rows, (-8.5, 1.1): the height of the ground and its slope along x.

The ground's texture covers it once, at 2.3 cm a texel: grass, earth below the vines, stones. Crowns have one of three textures of leaves, turned in
one of four ways, so that no two neighbours look alike.
"""
import argparse
import math
import os
import random
import struct
import zlib

SIZE_M = 24.0
SAMPLES = 129
ROWS_Y = [-4.4, -2.2, 0.0, 2.2, 4.4]
PLANTS_X = [-6.3 + 1.4 * i for i in range(10)]
POSTS_X = [-7.0, -2.8, 1.4, 7.0]
GROUND_PX, LEAVES_PX = 1024, 256


class Vineyard:
    def __init__(self, seed):
        self.seed = seed
        rng = random.Random(f"vineyard {seed}")
        # Seed 0 has the phases that this file began with.
        self.phases = [0.0] * 4 if seed == 0 else [rng.uniform(0, 2 * math.pi) for _ in range(4)]
        self.turn = 0 if seed == 0 else seed % 97

    def height_m(self, x, y):
        """Height of the ground, above 0."""
        a, b, c, d = self.phases
        return (0.6 + 0.30 * math.sin(2 * math.pi * x / 16 + a) * math.cos(2 * math.pi * y / 22 + b)
                + 0.18 * math.cos(2 * math.pi * (x + y) / 13 + c) + 0.06 * math.sin(2 * math.pi * (x - 2 * y) / 7 + d))


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(header, rows, palette=b""):
    head = struct.pack(">IIBBBBB", *header, 0, 0, 0)
    lines = b"".join(b"\0" + row for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + (chunk(b"PLTE", palette) if palette else b"")
            + chunk(b"IDAT", zlib.compress(lines, 9)) + chunk(b"IEND", b""))


def png16(rows):
    """Bytes of a 16 bit grey PNG."""
    return png((len(rows[0]), len(rows), 16, 0), [struct.pack(f">{len(row)}H", *row) for row in rows])


def png_palette(rows, palette):
    """Bytes of a PNG of 8 bit indices."""
    return png((len(rows[0]), len(rows), 8, 3), [bytes(row) for row in rows], b"".join(bytes(c) for c in palette))


def ramp(count, dark, light):
    return [tuple(round(d + (b - d) * k / (count - 1)) for d, b in zip(dark, light)) for k in range(count)]


def noise(rng, side, cells):
    """side x side values in [0, 1], smooth between random ones on a grid of cells x cells that closes on itself."""
    grid = [[rng.random() for _ in range(cells)] for _ in range(cells)]
    places = []
    for i in range(side):
        at = i * cells / side
        t = at - int(at)
        places.append((int(at), (int(at) + 1) % cells, t * t * (3 - 2 * t)))
    out = []
    for j0, j1, b in places:
        line = [low + (high - low) * b for low, high in zip(grid[j0], grid[j1])]
        out.append([line[i0] + (line[i1] - line[i0]) * a for i0, i1, a in places])
    return out


# ---- textures

GRASS, EARTH, STONE = 16, 12, 8  # shades of each


def ground_texture(vineyard):
    """Indices of the ground's texture, from the upper left corner: x grows to the right, y upwards."""
    rng = random.Random(f"ground {vineyard.seed}")
    side = GROUND_PX
    blades = [rng.random() for _ in range(side * side)]
    tufts, patches, edge = noise(rng, side, side // 3), noise(rng, side, 96), noise(rng, side, 160)
    out = []
    for j in range(side):
        y = SIZE_M * (0.5 - (j + 0.5) / side)
        from_row = min(abs(y - row) for row in ROWS_Y)
        line = []
        for i in range(side):
            fine = 0.5 * blades[j * side + i] + 0.5 * tufts[j][i]
            bare = from_row < 0.2 + 0.3 * edge[j][i] or patches[j][i] > 0.82
            shade = min(0.999, max(0, 0.5 + 1.25 * (fine - 0.5) + 0.6 * (patches[j][i] - 0.5)))
            line.append(GRASS + int(shade * EARTH) if bare else int(shade * GRASS))
        out.append(line)
    for _ in range(1600):  # stones, half of them below the vines
        x, y = rng.uniform(-SIZE_M / 2, SIZE_M / 2), rng.uniform(-SIZE_M / 2, SIZE_M / 2)
        if rng.random() < 0.5:
            y = rng.choice(ROWS_Y) + rng.gauss(0, 0.2)
        radius, shade = rng.uniform(0.8, 2.6), rng.randrange(2, STONE)
        u, v = (x / SIZE_M + 0.5) * side, (0.5 - y / SIZE_M) * side
        for j in range(int(v - radius), int(v + radius) + 1):
            for i in range(int(u - radius), int(u + radius) + 1):
                if 0 <= i < side and 0 <= j < side and (i + 0.5 - u) ** 2 + (j + 0.5 - v) ** 2 < radius ** 2:
                    lower = (j + 0.5 - v) > 0.3 * radius  # its own shadow
                    out[j][i] = GRASS + EARTH + (0 if lower else shade)
    return out, ramp(GRASS, (34, 52, 20), (150, 168, 92)) + ramp(EARTH, (66, 50, 34), (176, 148, 112)) + \
        ramp(STONE, (60, 58, 54), (226, 222, 212))


def leaves_texture(vineyard, number):
    """Leaves over the dark inside of a crown, some of them turned or dry."""
    rng = random.Random(f"leaves {vineyard.seed} {number}")
    side, shades = LEAVES_PX, 24
    out = [[0] * side for _ in range(side)]
    for _ in range(900):
        u, v, turn = rng.uniform(0, side), rng.uniform(0, side), rng.uniform(0, math.pi)
        long, wide, shade = rng.uniform(5, 10), rng.uniform(3, 6), rng.randrange(3, shades)
        c, s = math.cos(turn), math.sin(turn)
        for j in range(int(v - long), int(v + long) + 1):
            for i in range(int(u - long), int(u + long) + 1):
                a, b = c * (i - u) + s * (j - v), c * (j - v) - s * (i - u)
                if (a / long) ** 2 + (b / wide) ** 2 < 1:
                    rib = abs(b) < 0.6
                    out[j % side][i % side] = min(shades - 1, max(0, shade + (3 if rib else -2 if b < 0 else 0)))
    return out, ramp(shades, (16, 34, 14), (156, 196, 84))


def bark_texture(vineyard):
    rng = random.Random(f"bark {vineyard.seed}")
    side, shades = 64, 24
    coarse, fine = noise(rng, side, 8), noise(rng, side, 32)
    out = [[int(min(0.999, max(0, 0.5 + 1.4 * (coarse[j // 2][i] - 0.5) + 1.6 * (fine[j][i] - 0.5))) * shades)
            for i in range(side)] for j in range(side)]
    return out, ramp(shades, (44, 32, 22), (170, 138, 104))


# ---- world

def solid(kind, name, pose, shape, colour):
    return f"""        <{kind} name="{name}">
          <pose>{pose}</pose>
          <geometry>{shape}</geometry>
{colour}        </{kind}>
"""


def material(rgb, texture):
    return (f"          <material><diffuse>{rgb} 1</diffuse><pbr><metal><albedo_map>textures/vineyard_{texture}.png</albedo_map></metal></pbr>"
            "</material>\n")


def plant(vineyard, row, number, x, y):
    # A little unlike its neighbours, in a way that is the same every time.
    lean = 0.05 * math.sin(3.7 * row + 2.3 * number + vineyard.turn)
    wide = 0.46 + 0.06 * math.sin(1.9 * row + 5.1 * number + vineyard.turn)
    trunk = "<cylinder><radius>0.035</radius><length>1.0</length></cylinder>"
    crown = f"<ellipsoid><radii>{wide:.3f} 0.22 0.38</radii></ellipsoid>"
    # Half turns leave the shape as it is and change what is seen of the texture.
    look = (5 * row + 7 * number + row * number) % 12
    turned = ["0 0 0", "0 0 3.14159265", "3.14159265 0 0", "0 3.14159265 0"][look // 3]
    light = 0.72 + 0.4 * wide + 0.04 * math.sin(2.9 * row + 1.3 * number)
    return f"""    <model name="vine_{row}_{number}">
      <static>true</static>
      <pose>{x:.2f} {y:.2f} {vineyard.height_m(x, y) - 0.1:.3f} {lean:.3f} 0 0</pose>
      <link name="link">
{solid("collision", "trunk", "0 0 0.5 0 0 0", trunk, "")}{solid("collision", "crown", "0 0 1.15 0 0 0", crown, "")}\
{solid("visual", "trunk", "0 0 0.5 0 0 0", trunk, material("1 1 1", "bark"))}\
{solid("visual", "crown", "0 0 1.15 " + turned, crown, material(f"{light:.2f} {light:.2f} {light:.2f}", f"leaves_{1 + look % 3}"))}\
      </link>
    </model>
"""


def posts(vineyard):
    shape = "<cylinder><radius>0.045</radius><length>1.7</length></cylinder>"
    out = ""
    for row, y in enumerate(ROWS_Y):
        for number, x in enumerate(POSTS_X):
            pose = f"{x:.2f} {y:.2f} {vineyard.height_m(x, y) + 0.7:.3f} 0 0 0"
            name = f"post_{row}_{number}"
            out += solid("collision", name, pose, shape, "") + solid("visual", name, pose, shape, material("1 1 0.95", "bark"))
    return out


def world(vineyard, top_m):
    ground = (f"<heightmap><uri>vineyard_heights.png</uri><size>{SIZE_M:g} {SIZE_M:g} {top_m:.6f}</size>"
              "<pos>0 0 0</pos></heightmap>")
    plants = "".join(plant(vineyard, r, i, x, y) for r, y in enumerate(ROWS_Y) for i, x in enumerate(PLANTS_X))
    return f"""<?xml version="1.0"?>
<!-- Written by tools/make_vineyard.py, seed {vineyard.seed}: {len(ROWS_Y)} rows of {len(PLANTS_X)} vines and {len(POSTS_X)} posts on rolling ground. -->
<sdf version="1.9">
  <world name="vineyard">
    <physics type="ode"><max_step_size>0.005</max_step_size></physics>
    <spherical_coordinates>
      <surface_model>EARTH_WGS84</surface_model>
      <latitude_deg>-41.51</latitude_deg><longitude_deg>173.86</longitude_deg><elevation>20</elevation><heading_deg>0</heading_deg>
    </spherical_coordinates>
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
{material("1 1 1", "ground")}        </visual>
{posts(vineyard)}      </link>
    </model>
{plants}  </world>
</sdf>
"""


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=0, help="vineyard to make, 0: the one in worlds/")
    parser.add_argument("folder", nargs="?", default=os.path.join(here, "..", "worlds"))
    given = parser.parse_args()
    vineyard = Vineyard(given.seed)
    step = SIZE_M / (SAMPLES - 1)
    rows = [[vineyard.height_m(-SIZE_M / 2 + i * step, SIZE_M / 2 - j * step) for i in range(SAMPLES)] for j in range(SAMPLES)]
    lowest, top_m = min(map(min, rows)), max(map(max, rows))  # the brightest pixel stands for <size>'s z
    assert lowest >= 0
    os.makedirs(os.path.join(given.folder, "textures"), exist_ok=True)

    def write(name, data):
        with open(os.path.join(given.folder, name), "wb") as file:
            file.write(data)

    write("vineyard_heights.png", png16([[round(65535 * h / top_m) for h in row] for row in rows]))
    write("vineyard.sdf", world(vineyard, top_m).encode())
    write("textures/vineyard_ground.png", png_palette(*ground_texture(vineyard)))
    for number in (1, 2, 3):
        write(f"textures/vineyard_leaves_{number}.png", png_palette(*leaves_texture(vineyard, number)))
    write("textures/vineyard_bark.png", png_palette(*bark_texture(vineyard)))
    x, y = -8.5, 1.1
    slope = (vineyard.height_m(x + 0.3, y) - vineyard.height_m(x - 0.3, y)) / 0.6
    print(f"height {vineyard.height_m(x, y):.3f} slope {slope:.3f}")


if __name__ == "__main__":
    main()
