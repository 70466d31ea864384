#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how the range that a receiver reports converges with the sub-rays of a pixel (docs/user/lidar/receiver.md).

  bench/receiver_convergence.py [--bin build/release/bin]

64 x 64 pixels of 4.4 cm at 500 m, a pulse of 1 ns and 250 photoelectrons without photon noise, over a plane of 60 degrees, rocks
and ice blocks (sharp edges). The reference has 45 x 45 sub-rays. Prints, for each receiver and number of sub-rays, the rms error in
millimetres and the share of pixels that are wrong by more than 1 cm. Of a Geiger-mode receiver, whose ranges are random, it is the error
of their mean: that of the first photoelectron of the sub-rays, which are traced as pixels.
"""
import argparse
import json
import math
import os
import subprocess
import tempfile

import h5py
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
RANGE_M = 500
SIGNAL_PE = 250
REFERENCE = 45
SUBPIXELS = [1, 3, 5, 9, 15]
TYPES = ["leading_edge", "constant_fraction", "peak", "centroid"]
PLANE = {"grid": {"half_width_m": 30, "resolution_m": 1}, "base": {"type": "plane"}}
# (name, terrain, angle between the beam and the vertical)
SCENES = [("plane of 60 deg", PLANE, 60)] + [
    (name, {"grid": {"half_width_m": 4, "resolution_m": 0.01}, "base": {"type": "plane"}, "seed": 2,
            "patterns": [{"type": pattern, "k": 0.2, "overlap": False}]}, 0)
    for name, pattern in (("rocks", "golombek_rocks"), ("ice blocks", "ice_blocks"))]

ROWS = 64
IFOV_RAD = 1.6e-3 / 18
SIGMA_M = 299792458 / 2 * 1e-9 / (2 * math.sqrt(2 * math.log(2)))
REACH = 8  # of the pulse, in sigma
BIN = 1 / 64  # of ranges, in sigma
BELOW = np.array([0.5 * math.erfc(-x / math.sqrt(2)) for x in np.arange(-REACH, REACH + BIN / 2, BIN)])


def configuration(slope_deg, subpixels, kind):
    slope = math.radians(slope_deg)
    return {"detector": {"rows": ROWS, "columns": ROWS, "ifov_rad": IFOV_RAD, "subpixels": subpixels},
            "laser": {"pulse_rate_hz": 100, "scan_time_s": 0.01},
            "scanner": {"type": "flash"},
            "trajectory": {"type": "constant_velocity", "velocity_mps": [0, 0, 0], "rpy_deg": [slope_deg, 0, 0],
                           "position_m": [0, -RANGE_M * math.sin(slope), RANGE_M * math.cos(slope)]},
            "link": {"reference_pe": SIGNAL_PE / math.cos(slope), "reference_range_m": RANGE_M},
            "receiver": {"type": kind, "threshold_pe": 50, "photon_noise": False}}


class Bench:
    def __init__(self, tools, folder):
        self.tools, self.folder = tools, folder

    def run(self, tool, config, name, *arguments):
        path = os.path.join(self.folder, name)
        with open(path + ".json", "w", encoding="utf-8") as file:
            json.dump(config, file)
        subprocess.run([os.path.join(self.tools, tool), "-q", "-c", file.name, "-o", path + ".h5", "-O", *arguments], check=True)
        return path + ".h5"

    def ranges_m(self, terrain, *case):
        scan = self.run("scan-sim", configuration(*case), "scan", "--terrain", terrain, "--keep-misses")
        with h5py.File(scan) as file:
            return file["points/range_measured"][()]

    def sub_rays(self, terrain, slope_deg, subpixels):
        """Ranges and mean photoelectrons of the sub-rays (pixels, sub-rays), from a scan with a pixel for each."""
        config = configuration(slope_deg, 1, "centroid")
        config["detector"] = {"rows": ROWS * subpixels, "columns": ROWS * subpixels, "ifov_rad": IFOV_RAD / subpixels}
        config["link"]["reference_pe"] /= subpixels**2
        config["receiver"]["threshold_pe"] = 1e-9
        with h5py.File(self.run("scan-sim", config, "scan", "--terrain", terrain, "--keep-misses")) as file:
            columns = [file["points"][name][()] for name in ("range_measured", "intensity")]
        blocks = [c.reshape(ROWS, subpixels, ROWS, subpixels).swapaxes(1, 2).reshape(ROWS**2, -1) for c in columns]
        return blocks[0], np.nan_to_num(blocks[1])

    def first_photons_m(self, *case):
        return np.array([first_photon_m(r[n > 0], n[n > 0]) for r, n in zip(*self.sub_rays(*case))])


def first_photon_m(ranges_m, signals_pe):
    """The mean range of the first photoelectron: the integral of the probability that none has come, from where all are still to come."""
    x = (ranges_m - ranges_m.min()) / SIGMA_M
    bins = np.arange(0, x.max() + BIN, BIN)  # the energy of sub-rays that lie within a bin, shared between its two ends
    low = np.minimum((x / BIN).astype(int), len(bins) - 1)
    share = x / BIN - low
    energy = np.bincount(low, signals_pe * (1 - share), len(bins) + 1) + np.bincount(low + 1, signals_pe * share, len(bins) + 1)
    expected = np.convolve(energy, BELOW)  # photoelectrons up to a position, from -REACH on
    beyond = np.cumsum(np.concatenate([energy, np.zeros(len(BELOW) - 1)])) - np.convolve(energy, np.ones(len(BELOW)))
    none = np.exp(-(expected + beyond))
    return ranges_m.min() + SIGMA_M * (-REACH + BIN * (none.sum() - 0.5))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=os.path.join(ROOT, "build", "release", "bin"))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options.bin, folder)
        for name, terrain_config, slope_deg in SCENES:
            terrain = bench.run("terrain-gen", terrain_config, "terrain")
            for kind in [*TYPES, "geiger"]:
                ranges_m = bench.first_photons_m if kind == "geiger" else lambda *case, kind=kind: bench.ranges_m(*case, kind)
                reference = ranges_m(terrain, slope_deg, REFERENCE)
                cells = []
                for subpixels in SUBPIXELS:
                    error = ranges_m(terrain, slope_deg, subpixels) - reference
                    error = error[np.isfinite(error)]
                    rms_mm = 1e3 * math.sqrt(np.mean(error ** 2))
                    cells.append(f"{subpixels} x {subpixels}: {rms_mm:.2f} mm, {100 * np.mean(np.abs(error) > 0.01):.2f} %")
                print(f"{name}, {kind}: " + "; ".join(cells), flush=True)


if __name__ == "__main__":
    main()
