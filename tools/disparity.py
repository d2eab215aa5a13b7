#!/usr/bin/env python3
"""Draws the disparity of a rectified stereo pair, as a colour picture: what a program sees that matches blocks of pixels.

    tools/disparity.py LEFT.png RIGHT.png OUT.png [MOST]      MOST pixels of disparity are tried, 64 when left out

Sums of absolute differences over 9 x 9 pixels, the best shift to a fraction of a pixel by a parabola. Black: no shift is clearly the best, or
the right picture's best match is another place. Pictures as sandlot writes them: PNG, 8 bit, RGB or grey.
"""
import math
import struct
import sys
import zlib

RADIUS = 4


def read(path):
    """(width, height, rows of grey)"""
    data = open(path, "rb").read()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    step = {0: 1, 2: 3}[colour]
    raw, rows, before = zlib.decompress(packed), [], bytearray(width * step)
    for y in range(height):
        begin = y * (width * step + 1)
        how, line = raw[begin], bytearray(raw[begin + 1:begin + 1 + width * step])
        for i in range(len(line)):
            a = line[i - step] if i >= step else 0
            b, c = before[i], before[i - step] if i >= step else 0
            if how == 1:
                line[i] = (line[i] + a) & 255
            elif how == 2:
                line[i] = (line[i] + b) & 255
            elif how == 3:
                line[i] = (line[i] + (a + b) // 2) & 255
            elif how == 4:
                p = a + b - c
                nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
                line[i] = (line[i] + nearest) & 255
        before = line
        rows.append([sum(line[x * step:x * step + step]) // step for x in range(width)])
    return width, height, rows


def costs(left, right, width, height, shift):
    """Of each pixel: the sum of differences around it when the right picture is shifted so far."""
    n = 2 * RADIUS + 1
    across = []
    for y in range(height):
        l, r = left[y], right[y]
        d = [abs(l[x] - r[x - shift]) if x >= shift else 255 for x in range(width)]
        total, line = sum(d[:n]), [0] * width
        for x in range(RADIUS, width - RADIUS):
            line[x] = total
            if x + RADIUS + 1 < width:
                total += d[x + RADIUS + 1] - d[x - RADIUS]
        across.append(line)
    out = [[0] * width for _ in range(height)]
    for x in range(width):
        total = sum(across[y][x] for y in range(n))
        for y in range(RADIUS, height - RADIUS):
            out[y][x] = total
            if y + RADIUS + 1 < height:
                total += across[y + RADIUS + 1][x] - across[y - RADIUS][x]
    return out


def colour(t):
    stops = [(13, 13, 77), (77, 26, 128), (191, 38, 102), (242, 115, 51), (255, 242, 89)]
    at = min(max(t, 0), 1) * (len(stops) - 1)
    i = min(int(at), len(stops) - 2)
    return bytes(round(a + (b - a) * (at - i)) for a, b in zip(stops[i], stops[i + 1]))


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def main():
    width, height, left = read(sys.argv[1])
    _, _, right = read(sys.argv[2])
    most = int(sys.argv[4]) if len(sys.argv) > 4 else 64
    volume = [costs(left, right, width, height, shift) for shift in range(most + 1)]
    found = {}
    for y in range(RADIUS, height - RADIUS):
        best_right = {}
        for x in range(RADIUS, width - RADIUS):
            for shift in range(min(most, x - RADIUS) + 1):
                c = volume[shift][y][x]
                if c < best_right.get(x - shift, (1 << 30, 0))[0]:
                    best_right[x - shift] = (c, shift)
        for x in range(RADIUS, width - RADIUS):
            line = [volume[shift][y][x] for shift in range(min(most, x - RADIUS) + 1)]
            k = min(range(len(line)), key=line.__getitem__)
            if k in (0, len(line) - 1) or abs(best_right[x - k][1] - k) > 1:
                continue
            a, b, c = line[k - 1], line[k], line[k + 1]
            others = [v for i, v in enumerate(line) if abs(i - k) > 1]
            if a + c - 2 * b <= 0 or (others and b > 0.9 * min(others)):
                continue
            found[x, y] = k + 0.5 * (a - c) / (a + c - 2 * b)
    low = math.log(min(found.values())) if found else 0
    high = math.log(max(found.values())) if found else 1
    raw = b""
    for y in range(height):
        raw += b"\0"
        for x in range(width):
            d = found.get((x, y))
            raw += b"\0\0\0" if d is None else colour((math.log(d) - low) / max(high - low, 1e-9))
    with open(sys.argv[3], "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                  + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))
    print(f"{len(found)} of {width * height} pixels have a disparity, "
          f"{min(found.values(), default=0):.1f} to {max(found.values(), default=0):.1f} pixels")


main()
