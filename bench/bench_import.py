#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures time and peak memory of landfall-import: bench/bench_import.py [POINTS ...] [--bin build/release/bin] [--folder DIR]

Writes a LAS file (1.2, point format 1, 28 bytes a point: rolling terrain with noise, random intensities) of each number of points
(default 10000000), imports it with two threads, and removes both files. 100 million points take 5 GB of the disk.
"""
import argparse
import json
import os
import struct
import subprocess
import tempfile

import numpy as np

POINT = np.dtype([("xyz", "<i4", 3), ("intensity", "<u2"), ("returns", "u1"), ("class", "u1"), ("skipped", "<u4"), ("t", "<f8")])
BATCH = 1 << 16  # little memory: that of this process counts in the peak of the tool that it starts


def write_strip(path, count):
    """Lines of 1000 points, a decimetre apart on average."""
    random = np.random.default_rng(1)
    edge_m = 0.1 * count ** 0.5
    with open(path, "wb") as file:
        file.write(b"LASF" + bytes(20) + bytes([1, 2]) + b"landfall bench".ljust(64, b"\0") + bytes(4))
        file.write(struct.pack("<HIIBHI", 227, 227, 0, 1, POINT.itemsize, count) + bytes(20))
        file.write(struct.pack("<6d", *[0.001] * 3, 500000, 5400000, 0) + bytes(48))
        assert file.tell() == 227
        for begin in range(0, count, BATCH):
            i = np.arange(begin, min(begin + BATCH, count))
            points = np.zeros(len(i), POINT)
            x = i % 1000 / 1000 * edge_m + random.normal(0, 0.05, len(i))
            y = i // 1000 * 1000 / count * edge_m + random.normal(0, 0.05, len(i))
            z = 300 + 10 * np.sin(x / 50) * np.cos(y / 70) + random.normal(0, 0.03, len(i))
            points["xyz"] = np.rint(np.stack([x, y, z], axis=1) * 1000)
            points["intensity"] = random.integers(0, 65536, len(i))
            points["returns"], points["class"], points["t"] = 9, 2, 400000 + i / 1e5
            points.tofile(file)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("points", type=int, nargs="*", default=[10_000_000])
    parser.add_argument("--bin", default="build/release/bin")
    parser.add_argument("--folder")
    options = parser.parse_args()
    for count in options.points:
        with tempfile.TemporaryDirectory(dir=options.folder) as folder:
            strip = os.path.join(folder, "strip.las")
            write_strip(strip, count)
            result = subprocess.run([os.path.join(options.bin, "landfall-import"), strip, "-o", os.path.join(folder, "strip.h5"), "-q", "-t", "2", "--json"],
                                    capture_output=True, text=True, check=True)
            done = json.loads(result.stdout)
            print(f"{count:,} points, {os.path.getsize(strip) / 1e6:,.0f} MB: {done['wall_s']:.1f} s, {done['cpu_s']:.1f} s of CPU time, "
                  f"{done['peak_memory_bytes'] / 1e6:.0f} MB")


if __name__ == "__main__":
    main()
