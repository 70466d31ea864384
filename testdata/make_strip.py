#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes an airborne strip and the surface under it: strip.las (LAS 1.2, point format 1, UTM 32 N) and reference.asc with its .prj.

usage: make_strip.py [FOLDER]     FOLDER: the current folder

The ground is a field with a slope of 3 % and two mounds; the strip has 40 points per square metre, noise of 2 cm and a hole. The same bytes on any machine.
"""
import pathlib
import struct
import sys

import numpy as np

EAST, NORTH = 500000.0, 5400000.0  # of the middle
HALF_M = 24
POINTS_PER_M2 = 40
STEP_M = 0.5  # of the reference
PRJ = ('PROJCS["WGS_1984_UTM_Zone_32N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],'
       'UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],'
       'PARAMETER["Central_Meridian",9.0],PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]]')


def height(x, y):
    """The ground, metres, at x, y from the middle."""
    mounds = sum(h / (1 + ((x - cx) ** 2 + (y - cy) ** 2) / r**2) for cx, cy, r, h in ((6, 4, 2, 1.2), (-9, -5, 3, 0.8)))
    return 312.5 + 0.03 * x + mounds


def noise(count, number):
    """Sums of 12 equal deviates of a linear congruential generator, about normal: numpy's own may change."""
    state = (np.arange(12 * count, dtype=np.uint64) + np.uint64(1)) * np.uint64(6364136223846793005 + 2 * number)
    state ^= state >> np.uint64(33)
    state *= np.uint64(0xFF51AFD7ED558CCD)
    state ^= state >> np.uint64(33)
    uniform = (state >> np.uint64(11)).astype(float) / 2**53
    return uniform.reshape(count, 12).sum(axis=1) - 6, uniform[:count], uniform[-count:]


def strip():
    count = POINTS_PER_M2 * (2 * HALF_M) ** 2
    normal, u, v = noise(count, 1)
    x, y = (2 * u - 1) * HALF_M, (2 * v - 1) * HALF_M
    keep = np.hypot(x + 2, y - 12) > 2.0  # a pond without returns
    z = height(x, y) + 0.02 * normal
    order = np.argsort(y[keep], kind="stable")
    table = np.column_stack([x, y, z])[keep][order]
    stored = np.round((table + [0, 0, -300]) / 0.001).astype(np.int32)
    keys = struct.pack("<16H", 1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 32632, 3076, 0, 1, 9001)
    record = struct.pack("<H16sHH32s", 0, b"LASF_Projection", 34735, len(keys), b"") + keys
    low, high = stored.min(axis=0) * 0.001, stored.max(axis=0) * 0.001
    offset = (EAST, NORTH, 300.0)
    head = b"LASF" + struct.pack("<HH16sBB32s32s", 0, 0, b"", 1, 2, b"testdata", b"make_strip.py") + struct.pack(
        "<HHHIIBHI5I", 0, 0, 227, 227 + len(record), 1, 1, 28, len(stored), len(stored), 0, 0, 0, 0)
    head += struct.pack("<6d", 0.001, 0.001, 0.001, *offset)
    head += struct.pack("<6d", *(value + offset[k] for k in range(3) for value in (high[k], low[k])))
    points = np.zeros(len(stored), [("xyz", "<i4", 3), ("intensity", "<u2"), ("returns", "u1"), ("class", "u1"), ("rest", "u1", 4), ("t", "<f8")])
    points["xyz"], points["intensity"], points["returns"], points["class"] = stored, 500, 9, 2
    points["t"] = 302400 + np.arange(len(stored)) / 2**17
    return head + record + points.tobytes()


def reference():
    half = round((HALF_M + 2) / STEP_M)
    nodes = np.arange(-half, half + 1) * STEP_M
    head = (f"ncols {len(nodes)}\nnrows {len(nodes)}\nxllcenter {EAST + nodes[0]}\nyllcenter {NORTH + nodes[0]}\ncellsize {STEP_M}\nNODATA_value -9999\n")
    return head + "".join(" ".join(f"{value:.4f}" for value in height(nodes, y)) + "\n" for y in nodes[::-1])


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    (folder / "strip.las").write_bytes(strip())
    (folder / "reference.asc").write_text(reference(), encoding="ascii")
    (folder / "reference.prj").write_text(PRJ, encoding="ascii")


if __name__ == "__main__":
    main()
