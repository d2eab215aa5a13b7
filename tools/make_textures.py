#!/usr/bin/env python3
"""Writes worlds/textures: speckle.png, bricks.png and tiles.png, pictures for surfaces that cameras should find again.

    tools/make_textures.py [FOLDER]      FOLDER is worlds/textures when left out

Each is 256 x 256 in 64 colours and repeats without a seam.
"""
import math
import pathlib
import random
import struct
import sys
import zlib

SIZE, COLOURS = 256, 64


def noise(rng, cells):
    """Smooth between random values on a grid of cells x cells that closes on itself."""
    grid = [[rng.random() for _ in range(cells)] for _ in range(cells)]

    def smooth(t):
        return t * t * (3 - 2 * t)

    def at(x, y):
        u, v = x * cells / SIZE, y * cells / SIZE
        i, j = int(u), int(v)
        a, b = smooth(u - i), smooth(v - j)
        i2, j2 = (i + 1) % cells, (j + 1) % cells
        low = grid[j][i] * (1 - a) + grid[j][i2] * a
        high = grid[j2][i] * (1 - a) + grid[j2][i2] * a
        return low * (1 - b) + high * b

    return at


def octaves(rng, *cells):
    layers = [noise(rng, c) for c in cells]
    return lambda x, y: sum(layer(x, y) for layer in layers) / len(layers)


def speckle(rng):
    coarse, fine = octaves(rng, 8, 16), octaves(rng, 32, 64, 128)
    return lambda x, y: min(1, max(0, 0.5 + 1.2 * (coarse(x, y) - 0.5) + 2.2 * (fine(x, y) - 0.5)))


def bricks(rng):
    fine, rows, columns = octaves(rng, 32, 64), 8, 4
    shade = [[rng.uniform(0.35, 0.8) for _ in range(columns)] for _ in range(rows)]

    def at(x, y):
        v = y * rows / SIZE
        u = x * columns / SIZE + 0.5 * (int(v) % 2)
        if (v % 1) < 0.1 or (u % 1) < 0.05:
            return 0.95 + 0.1 * (fine(x, y) - 0.5)
        return shade[int(v)][int(u) % columns] + 0.5 * (fine(x, y) - 0.5)

    return at


def tiles(rng):
    fine, cells = octaves(rng, 16, 64), 4
    shade = [[rng.uniform(0.3, 0.9) for _ in range(cells)] for _ in range(cells)]

    def at(x, y):
        u, v = x * cells / SIZE, y * cells / SIZE
        if (u % 1) < 0.04 or (v % 1) < 0.04:
            return 0.1
        return shade[int(v)][int(u)] + 0.4 * (fine(x, y) - 0.5)

    return at


def ramp(dark, light):
    return [tuple(round(d + (b - d) * k / (COLOURS - 1)) for d, b in zip(dark, light)) for k in range(COLOURS)]


def png(value, palette):
    raw = b""
    for y in range(SIZE):
        raw += b"\0" + bytes(min(COLOURS - 1, max(0, math.floor(value(x, y) * COLOURS))) for x in range(SIZE))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", SIZE, SIZE, 8, 3, 0, 0, 0))
            + chunk(b"PLTE", b"".join(bytes(c) for c in palette)) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "worlds/textures")
    folder.mkdir(parents=True, exist_ok=True)
    rng = random.Random(1)
    (folder / "speckle.png").write_bytes(png(speckle(rng), ramp((40, 45, 30), (215, 205, 175))))
    (folder / "bricks.png").write_bytes(png(bricks(rng), ramp((70, 25, 15), (235, 190, 165))))
    (folder / "tiles.png").write_bytes(png(tiles(rng), ramp((25, 40, 60), (225, 230, 235))))


main()
