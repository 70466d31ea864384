#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Times regrid against GMT's blockmean on the same returns, alternately, three times each.

    bench_grid_gmt.py REGRID scan.h5 [terrain.h5]

blockmean reads x, y, z and regrid's weight as raw doubles (-bi4d -Wi); regrid reads the compressed scan.
With a terrain the run that writes all ten layers is timed too. Half width 50 m, bins of 0.05 m. Needs
python3-h5py, python3-numpy and gmt; for every return 32 bytes of temporary disk.
"""
import os
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

RESOLUTION_M = 0.05
ROUNDS = 3
RETURNS = (0, 6)  # the status of returns and of false returns


def write_points(scan, path):
    with h5py.File(scan) as file:
        points = file["points"]
        kept = np.isin(points["status"][:], RETURNS)
        x, y, z = (points[name][:][kept].astype(float) for name in ("x_est", "y_est", "z_est"))
    u, v = x / RESOLUTION_M, y / RESOLUTION_M
    weight = (1 - abs(u - np.floor(u + 0.5))) * (1 - abs(v - np.floor(v + 0.5)))
    np.stack([x, y, z, weight], axis=1).tofile(path)


def seconds(command, output=None):
    begin = time.perf_counter()
    subprocess.run(command, stdout=output, check=True)
    return time.perf_counter() - begin


def main():
    regrid, scan = sys.argv[1:3]
    terrain = sys.argv[3:4]
    with tempfile.TemporaryDirectory() as folder:
        points, dem, means = (os.path.join(folder, name) for name in ("points.bin", "dem.h5", "means.txt"))
        write_points(scan, points)
        commands = {"gmt blockmean": ["gmt", "blockmean", points, "-bi4d", "-bo3d", "-Wi", "-R-50/50/-50/50",
                                      f"-I{RESOLUTION_M}"],
                    "regrid --layers z_est": [regrid, scan, "--layers", "z_est", "-o", dem]}
        if terrain:
            commands["regrid --terrain"] = [regrid, scan, "--terrain", terrain[0], "-o", dem]
        times = {name: [] for name in commands}
        for _ in range(ROUNDS):
            for name, command in commands.items():
                if os.path.exists(dem):
                    os.remove(dem)
                with open(means, "wb") as output:
                    times[name].append(seconds(command, output))
        gmt = np.median(times["gmt blockmean"])
        for name, values in times.items():
            print(f"{name}: {' '.join(f'{t:.2f}' for t in values)} s, "
                  f"blockmean / this = {gmt / np.median(values):.2f}")


if __name__ == "__main__":
    main()
