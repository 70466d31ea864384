#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges regrid's uncertainty map against the truth: z-scores of many draws on 10 m maps (docs/quality/uncertainty.md).

Each scene is scanned once; every draw takes new errors (scan-sim --ranges-from), grids them with --uncertainty
--corrected, and divides z_true_map - z_est by its sigma. Writes zscores.csv and two figures into the output folder.
"""
import argparse
import csv
import json
import math
import multiprocessing
import os
import sys
import tempfile

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # pylint: disable=wrong-import-position,wrong-import-order

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "python"))
from landfall import command, tools  # pylint: disable=wrong-import-position
from landfall.errors import UsageError  # pylint: disable=wrong-import-position

RANGE_SIGMA_M = 0.05 / 3
NAVIGATION_SIGMA = {"position_m": [0.1, 0.1, 0.05], "velocity_mps": [0.1, 0.1, 0.1],
                    "rpy_rad": [1e-4, 1e-4, 1e-4], "rpy_rate_radps": [1e-4, 1e-4, 1e-4]}
TERRAIN_HALF_WIDTH_M, MAP_HALF_WIDTH_M = 6.5, 5
# Bins, nodes and pixels on the ground. A navigation error is common to a whole map: there the number of draws counts, not that
# of bins, and coarser bins of coarser pixels (the same returns per bin) make a draw cheaper.
STEP_M = {"noise": 0.05, "navigation": 0.1}
SCENES = {
    "flat": {},
    "cones": {"features": [{"type": "cone", "x_m": x, "y_m": y, "radius_m": 1.5, "height_m": 5}
                           for x, y in ((-2.5, -2.5), (2.5, -2), (0, 2.5))]},
    "fractal": {"base": {"type": "fractal", "hurst_exponent": 0.8, "rms_deviation_m": 0.87,
                         "reference_length_m": 10}},
    "rocks": {"patterns": [{"type": "golombek_rocks", "k": 0.2}]},
}
COUNTS = range(1, 8)
SLOPES = {"below 0.1": (0, 0.1), "0.1-0.7": (0.1, 0.7), "above 0.7": (0.7, math.inf)}  # of the true terrain
FLANK = "above 0.7"
FLANK_COUNTS = {"1": (1, 1), "2-3": (2, 3), "4-6": (4, 6), "7+": (7, math.inf)}
# The elevation and its sigma.
PRODUCTS = {"noise": [("z_est", "z_sigma_rel"), ("z_corrected", "z_corrected_sigma_rel")],
            "navigation": [("z_est", "z_sigma_abs"), ("z_corrected", "z_corrected_sigma_abs")]}
LIMITS = {1: (0.66, 0.71), 2: (0.94, 0.97)}


def parse(arguments):
    parser = command.Parser(prog="uncertainty_study.py", description=__doc__,
                            formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", metavar="DIR", required=True)
    parser.add_argument("--bin", metavar="DIR", default="build/release/bin", help="where the tools are")
    parser.add_argument("--dem", metavar="RASTER", help="a real DEM, for the scene of the same name")
    parser.add_argument("--scenes", default=None, help="only these, comma-separated")
    parser.add_argument("--noise-draws", type=int, default=100)
    parser.add_argument("--navigation-draws", type=int, default=2500)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--plot-only", action="store_true", help="draw the figures from an earlier zscores.csv")
    options = parser.parse_args(arguments)
    options.scenes = chosen_scenes(options)
    return options


def chosen_scenes(options):
    scenes = dict(SCENES)
    if options.dem:
        scenes["dem"] = {"base": {"type": "dem", "path": os.path.abspath(options.dem)}}
    names = options.scenes.split(",") if options.scenes else list(scenes)
    for name in names:
        if name not in scenes:
            raise UsageError(f"--scenes: '{name}' is none of {', '.join(scenes)}")
    return {name: scenes[name] for name in names}


# The paper's geometry over 10 m: 20 x 20 images from 500 m, over the 2 s of the descent.
def scan_config(step_m):
    pixels = round(18 * 0.05 / step_m)
    return {"detector": {"rows": pixels, "columns": pixels, "ifov_rad": 1.6e-3 / pixels},
            "laser": {"pulse_rate_hz": 200, "scan_time_s": 2},
            "scanner": {"type": "fsm",
                        "pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 5.2}}}


# Draws


class Tally:
    """Sums over z-scores, by the number of returns in the bin and by the slope of the terrain."""

    def __init__(self):
        # {(count, slope): (n, z, z^2, |z| <= 1, |z| <= 2)}
        self.sums = {key: np.zeros(5) for key in [*((count, "all") for count in [*COUNTS, "all"]), *(("all", slope) for slope in SLOPES),
                                                  *((count, FLANK) for count in FLANK_COUNTS)]}

    def add(self, z, count, slope):
        finite = np.isfinite(z)
        z, count, slope = z[finite], count[finite], slope[finite]
        terms = np.stack([np.ones_like(z), z, z * z, np.abs(z) <= 1, np.abs(z) <= 2])
        self.sums["all", "all"] += terms.sum(1)
        for number in COUNTS:
            self.sums[number, "all"] += terms[:, count == number].sum(1)
        for name, (low, high) in SLOPES.items():
            self.sums["all", name] += terms[:, (slope >= low) & (slope < high)].sum(1)
        for name, (low, high) in FLANK_COUNTS.items():
            self.sums[name, FLANK] += terms[:, (slope >= SLOPES[FLANK][0]) & (count >= low) & (count <= high)].sum(1)

    def merge(self, other):
        for key, sums in other.sums.items():
            self.sums[key] += sums


class Study:
    """One scene and kind of errors in a folder of its own, scanned without errors."""

    def __init__(self, name, kind, options, folder):
        self.name, self.kind, self.bin, self.seed = name, kind, os.path.abspath(options.bin), options.seed
        self.folder = os.path.join(folder, f"{name}-{kind}")
        os.makedirs(self.folder)
        step = STEP_M[kind]
        self.write_config("terrain", {"grid": {"half_width_m": TERRAIN_HALF_WIDTH_M, "resolution_m": step},
                                      **options.scenes[name]})
        self.write_config("scan", scan_config(step))
        self.write_config("regrid", {"half_width_m": MAP_HALF_WIDTH_M, "resolution_m": step})
        self.tool("terrain-gen", "-c", self.path("terrain.json"), "-o", self.path("terrain.h5"))
        self.tool("scan-sim", "-c", self.path("scan.json"), "--terrain", self.path("terrain.h5"), "-o",
                  self.path("true.h5"))
        self.truth, self.slope = self.terrain_under_bins()

    def path(self, name):
        return os.path.join(self.folder, name)

    def write_config(self, name, value):
        with open(self.path(name + ".json"), "w", encoding="utf-8") as file:
            json.dump(value, file)

    def tool(self, name, *arguments):
        tools.run_tool(os.path.join(self.bin, name), *arguments)

    def terrain_under_bins(self):
        """H(X, Y) and its slope by central differences: the terrain's nodes are the bin centres."""
        margin = round((TERRAIN_HALF_WIDTH_M - MAP_HALF_WIDTH_M) / STEP_M[self.kind])
        with h5py.File(self.path("terrain.h5")) as file:
            z = file["z"][()]
        slope = np.hypot(*np.gradient(z, STEP_M[self.kind]))
        return tuple(layer[margin:-margin, margin:-margin] for layer in (z, slope))

    def draw(self, number):
        """z-scores of one draw: {elevation: Tally}."""
        prefix = self.path(f"{os.getpid()}-")
        errors = ["--set", f"noise.range_sigma_m={RANGE_SIGMA_M}"]
        sigmas = []
        if self.kind == "navigation":
            random = np.random.default_rng([self.seed, number])
            for key, sigma in NAVIGATION_SIGMA.items():
                errors += ["--set", f"navigation_error.{key}={list(random.normal(0, sigma))}"]
                sigmas += ["--navigation-sigma", f"{key}={','.join(map(str, sigma))}"]
        pairs = PRODUCTS[self.kind]
        self.tool("scan-sim", "-c", self.path("scan.json"), "--ranges-from", self.path("true.h5"), "--seed",
                  self.seed * 1000000 + number, *errors, "--compression", 0, "-t", 1, "-O", "-o", prefix + "scan.h5")
        self.tool("regrid", prefix + "scan.h5", "-c", self.path("regrid.json"), "--uncertainty", "--corrected",
                  *sigmas, "--layers", ",".join(["count", *(name for pair in pairs for name in pair)]),
                  "--compression", 0, "-t", 1, "-O", "-o", prefix + "dem.h5")
        tallies = {}
        with h5py.File(prefix + "dem.h5") as file:
            count = file["count"][()]
            for elevation, sigma in pairs:
                with np.errstate(invalid="ignore"):
                    z = (self.truth - file[elevation][()]) / file[sigma][()]
                tallies[elevation] = Tally()
                tallies[elevation].add(z, count, self.slope)
        return tallies


def worker(job):
    study, number = job
    return study.draw(number)


def run_draws(study, draws, processes):
    totals = {elevation: Tally() for elevation, _ in PRODUCTS[study.kind]}
    with multiprocessing.Pool(processes) as pool:
        jobs = ((study, number) for number in range(draws))
        for done, tallies in enumerate(pool.imap_unordered(worker, jobs, chunksize=4), 1):
            for elevation, tally in tallies.items():
                totals[elevation].merge(tally)
            if sys.stderr.isatty():
                print(f"\r{study.name} {study.kind}: {done}/{draws}", end="", file=sys.stderr)
    return totals


# Table


def rows_of(scene, kind, draws, totals):
    for elevation, tally in totals.items():
        for (count, slope), (n, z, z2, one, two) in tally.sums.items():
            if n > 0:
                yield {"scene": scene, "errors": kind, "draws": draws, "elevation": elevation, "count": count,
                       "slope": slope, "scores": int(n), "mean": round(z / n, 4),
                       "std": round(math.sqrt(max(0, z2 / n - (z / n) ** 2)), 4),
                       "within_1": round(one / n, 4), "within_2": round(two / n, 4)}


def write_table(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


# Pictures


STYLES = {"z_est": {"marker": "o", "ms": 6, "mfc": "none", "color": "tab:orange"},
          "z_corrected": {"marker": ".", "ms": 6, "color": "tab:blue"}}
TITLES = {"noise": "range noise alone", "navigation": "with navigation errors"}
SHOWN = {1: (61, 76), 2: (90.5, 99.5)}  # per cent


def plot_by_count(path, rows):
    """Two low panels per scene and kind of errors, the shares within 2 and within 1 sigma."""
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    panels = [(kind, sigmas) for kind in PRODUCTS if any(row["errors"] == kind for row in rows) for sigmas in (2, 1)]
    figure, axes = plt.subplots(len(panels), len(scenes), figsize=(2.5 * len(scenes) + 0.8, 1.55 * len(panels) + 0.5),
                                sharex=True, sharey="row", squeeze=False, layout="constrained")
    for line, (kind, sigmas) in zip(axes, panels):
        line[0].set_ylabel(f"within {sigmas} sigma [%]", fontsize=9)
        for axis, scene in zip(line, scenes):
            draw_shares(axis, [row for row in rows if (row["scene"], row["errors"]) == (scene, kind)], sigmas)
            if sigmas == 2:
                axis.set_title(f"{scene}: {TITLES[kind]}", fontsize=9)
    for axis in axes[-1]:
        axis.set_xlabel("returns in the bin", fontsize=9)
    axes[1][0].legend(loc="lower center", ncol=3, fontsize=6.5, frameon=False, columnspacing=1, handletextpad=0.5)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_shares(axis, rows, sigmas):
    low, high = LIMITS[sigmas]
    axis.axhspan(100 * low, 100 * high, color="0.87", lw=0, label="limits")
    for elevation, style in STYLES.items():
        chosen = [row for row in rows if row["elevation"] == elevation and row["count"] != "all" and row["slope"] == "all"]
        axis.plot([int(row["count"]) for row in chosen], [100 * float(row[f"within_{sigmas}"]) for row in chosen],
                  lw=1, label=elevation, **style)
    axis.set_ylim(*SHOWN[sigmas])
    axis.set_xticks(list(COUNTS))
    axis.tick_params(labelsize=8)


def main(arguments):
    options = parse(arguments)
    os.makedirs(options.output, exist_ok=True)
    table = os.path.join(options.output, "zscores.csv")
    if not options.plot_only:
        write_table(table, study_rows(options))
    with open(table, encoding="utf-8") as file:
        plot_by_count(os.path.join(options.output, "by-count.png"), list(csv.DictReader(file)))


def study_rows(options):
    rows = []
    with tempfile.TemporaryDirectory(prefix="landfall-uncertainty-") as folder:
        for kind, draws in (("noise", options.noise_draws), ("navigation", options.navigation_draws)):
            for name in options.scenes if draws > 0 else []:
                study = Study(name, kind, options, folder)
                rows += rows_of(name, kind, draws, run_draws(study, draws, options.processes))
    return rows


if __name__ == "__main__":
    command.run(main)
