#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well p_safe of hazard-map is calibrated: the share of truly safe places in each tenth of p, pooled over sites and draws.

  bench/bench_probability.py [--bin build/release/bin] [--folder DIR] [--sites 10] [--draws 20] [--seed 200] [--white]

A site is 30 m of fractal ground with rocks, 5 cm nodes, the roughness and the rocks of which change from site to site. A
draw is Example 2's range noise on the same rays (scan-sim --ranges-from), its DEM with a 1-sigma map (regrid --uncertainty),
and hazard-map with slope limits of 10 deg (the default) and 30 deg, where roughness decides. --white adds independent noise
to the true elevations instead, and gives its standard deviation as z_sigma_m.

Prints, for each limit, the number of places and share less mean p in each tenth, and the Brier score over that of the
decision by the limits. Ten sites and twenty draws take 16 minutes of processor time.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np

LIMITS_DEG = (10, 30)
WHITE_SIGMA_M = 0.0093  # of a bin of Example 2 with 3.2 returns
ROCKS, HURST, DEVIATION_M = (0.05, 0.08, 0.1, 0.15, 0.2), (0.8, 0.7), (0.2, 0.3, 0.4)
# 79 x 52 images of Example 2's raster: its returns per bin.
SCAN = ("-c", "preset:paper", "--set", "scanner.pattern.rows=79", "--set", "scanner.pattern.columns=52", "--set",
        "scanner.pattern.half_width_m=16", "--set", "laser.scan_time_s=0.2054")


class Bench:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        self.counts = {limit: np.zeros((3, 10)) for limit in LIMITS_DEG}  # places, sum of p, truly safe
        self.squares = {limit: np.zeros(2) for limit in LIMITS_DEG}  # of p, of the decision

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, tool, *arguments):
        command = [os.path.join(self.options.bin, tool), *map(str, arguments), "-O", "-q"]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            sys.exit(f"{' '.join(command)}\nexit {result.returncode}: {result.stderr}")

    def make_site(self, number):
        base = {"type": "fractal", "hurst_exponent": HURST[number % 2], "reference_length_m": 10, "rms_deviation_m": DEVIATION_M[number % 3]}
        rocks = [{"type": "golombek_rocks", "k": ROCKS[number % 5], "min_diameter_m": 0.1}]
        self.run("terrain-gen", "-o", self.path("terrain.h5"), "--seed", self.options.seed + number, "--set", "base=" + json.dumps(base), "--set",
                 "patterns=" + json.dumps(rocks), "--set", 'grid={"half_width_m": 17, "resolution_m": 0.05}')
        self.run("scan-sim", *SCAN, "--terrain", self.path("terrain.h5"), "-o", self.path("scan.h5"))
        self.regrid("scan.h5")

    def regrid(self, scan, *options):
        self.run("regrid", self.path(scan), "--terrain", self.path("terrain.h5"), "-o", self.path("dem.h5"), "--set", "half_width_m=15.5", *options)

    def draw(self, seed):
        """Makes dem.h5; returns what hazard-map needs to know of its noise."""
        if self.options.white:
            with h5py.File(self.path("dem.h5"), "a") as file:
                truth = file["z_true"][()]
                file["z_est"][...] = truth + np.random.default_rng(seed).normal(0, WHITE_SIGMA_M, truth.shape)
            return ["--set", f"z_sigma_m={WHITE_SIGMA_M}"]
        self.run("scan-sim", *SCAN, "--ranges-from", self.path("scan.h5"), "--terrain", self.path("terrain.h5"), "--seed", seed, "-o", self.path("drawn.h5"))
        self.regrid("drawn.h5", "--uncertainty")
        return []

    def judge(self, limit, options):
        self.run("hazard-map", self.path("dem.h5"), "-o", self.path("hazards.h5"), "--set", f"limits.slope_deg={limit}", "--set", "region_radius_m=14",
                 *options)
        with h5py.File(self.path("hazards.h5")) as file:
            p, safe, truth = (file[name][()] for name in ("p_safe", "safe", "safe_true"))
        known = np.isfinite(p) & (truth != 2)
        p, decided, truth = p[known].astype(float), safe[known] == 1, truth[known] == 1
        tenth = np.minimum((10 * p).astype(int), 9)
        self.counts[limit] += [np.bincount(tenth, weights, 10) for weights in (None, p, truth)]
        self.squares[limit] += [np.sum((p - truth) ** 2), np.count_nonzero(decided != truth)]

    def table(self):
        print("| slope limit | |", *(f"{k / 10:.1f} |" for k in range(10)), "Brier score, ratio |")
        print("|---" * 13 + "|")
        for limit, (places, p, safe) in self.counts.items():
            off = (safe - p) / np.maximum(places, 1)
            print(f"| {limit} deg | places |", *(f"{int(n):,} |" for n in places), "|")
            print("| | safe share less p |", *(f"{value:+.3f} |" for value in off), f"{self.squares[limit][0] / self.squares[limit][1]:.3f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", help="folder of the tools")
    parser.add_argument("--folder", help="where the files are made; default: a temporary folder")
    parser.add_argument("--sites", type=int, default=10)
    parser.add_argument("--draws", type=int, default=20, help="draws of noise on each site")
    parser.add_argument("--seed", type=int, default=200, help="seed of the first site")
    parser.add_argument("--white", action="store_true", help="independent noise on the true elevations, and z_sigma_m")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        bench = Bench(options, folder)
        for site in range(options.sites):
            bench.make_site(site)
            for draw in range(options.draws):
                known = bench.draw(1000 * site + draw + 1)
                for limit in LIMITS_DEG:
                    bench.judge(limit, known)
            print(f"{site + 1} of {options.sites} sites", file=sys.stderr)
        bench.table()


if __name__ == "__main__":
    main()
