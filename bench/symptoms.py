#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the pictures of docs/user/symptoms.md: one map of a small site for each pattern of errors, with the one key that makes it.

    bench/symptoms.py -o docs/images        symptom-stripes.png, symptom-holes.png, ...

All scans are of one sloping terrain with two cones, from 100 m, and differ from a lidar without errors only in the keys shown.
"""
import argparse
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
os.environ["MPLBACKEND"] = "Agg"
# pylint: disable=wrong-import-position
import matplotlib.colors
import matplotlib.pyplot as plt
import numpy as np

import landfall
from landfall import command
from landfall.plot import scales

TERRAIN = {"grid": {"half_width_m": 9, "resolution_m": 0.1}, "base": {"slope_x": 0.25},
           "features": [{"type": "cone", "x_m": x, "y_m": y, "radius_m": 1.2, "height_m": 0.8} for x, y in ((2.5, 2), (-2, -1.5))]}
LIDAR = {"detector": {"ifov_rad": 0.0008, "roll_deg": 7.73}, "laser": {"pulse_rate_hz": 5000, "scan_time_s": 0.32},
         "scanner": {"pattern": {"type": "line_search", "rows": 40, "columns": 40, "half_width_m": 7.5}},
         "trajectory": {"position_m": [0, 0, 100], "velocity_mps": [0, 0, -5]}}
MAP = {"half_width_m": 6, "resolution_m": 0.1}
# name: (what to look for, layer of the evaluation or DEM, keys that make the pattern)
SYMPTOMS = {
    "stripes": ("empty stripes between the lines of the scan", "count", {"scanner.pattern.rows": 9}),
    "holes": ("rows and columns of empty bins", "count", {"detector.roll_deg": 0, "detector.ifov_rad": 0.0012, "scanner.pattern.rows": 8, "scanner.pattern.columns": 8}),
    "shift": ("one colour: the whole map is displaced", "abs_x", {"navigation_error.position_m": [1.2, 0, 0]}),
    "tilt": ("the error grows from one side to the other", "e_z", {"navigation_error.rpy_rad": [0.0008, 0, 0]}),
    "steps": ("bands along the lines of the scan", "e_z", {"pointing_error.jitter_sigma_rad": 0.001, "pointing_error.jitter_time_s": 0.02, "scanner.pattern.rows": 12}),
}
TITLES = {"count": "returns in each bin", "abs_x": "mean horizontal error of a footprint, x", "e_z": "elevation error, true − estimated"}


def maps_of(keys, folder):
    """The DEM and the evaluation of the lidar with these keys."""
    scan, dem, judged = (os.path.join(folder, name) for name in ("scan.h5", "dem.h5", "eval.h5"))
    terrain = os.path.join(folder, "terrain.h5")
    landfall.run("scan-sim", LIDAR, terrain=terrain, output=scan, set=keys, overwrite=True)
    landfall.run("regrid", MAP, scan, terrain=terrain, output=dem, overwrite=True)
    landfall.run("dem-eval", {"region_radius_m": 5, "footprint_m": 1.1}, dem, output=judged, overwrite=True)
    return {**layers(dem, ("count",)), **layers(judged, ("e_z", "abs_x"))}


def layers(path, names):
    with landfall.open(path) as data:
        return {name: data[name].values.astype(float) for name in names}


def draw(name, values, path):
    """The map of a layer with its colour bar, in a picture of less than 100 kB."""
    caption, layer, keys = SYMPTOMS[name]
    figure, ax = plt.subplots(figsize=(4.6, 3.9), layout="constrained")
    is_error = layer != "count"
    factor = 100 if is_error else 1
    shown = factor * values
    high = 1.5 * np.nanmax(np.abs(shown)) if layer == "abs_x" else np.nanpercentile(np.abs(shown), 98 if is_error else 99.5)
    table = matplotlib.colors.ListedColormap(np.array(scales.color_table("error" if is_error else "count")) / 255)
    table.set_bad(scales.css(scales.NO_VALUE))
    edge = MAP["half_width_m"] + MAP["resolution_m"] / 2
    image = ax.imshow(shown, origin="lower", extent=(-edge, edge, -edge, edge), cmap=table, vmin=-high if is_error else 0, vmax=high, interpolation="nearest")
    figure.colorbar(image, ax=ax, label=f"{TITLES[layer]} (cm)" if is_error else TITLES[layer])
    ax.set(xlabel="x (m)", ylabel="y (m)")
    ax.set_title(caption, fontsize=10)
    figure.supxlabel("\n".join(f"{key} = {value}" for key, value in keys.items()), fontsize=7.5, color="0.35")
    figure.savefig(path, dpi=90, metadata={"Software": None})
    plt.close(figure)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="folder of the pictures")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="landfall-symptoms-") as folder:
        landfall.run("terrain-gen", TERRAIN, output=os.path.join(folder, "terrain.h5"))
        for name, (_, layer, keys) in SYMPTOMS.items():
            path = os.path.join(options.output, f"symptom-{name}.png")
            draw(name, maps_of(keys, folder)[layer], path)
            print(path)


if __name__ == "__main__":
    command.run(main)
