#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a landing map Risley prisms cover: four constant rates and a steered spiral (docs/user/lidar/risley-coverage.md).

The paper's lidar and descent over flat ground. Prints the table and draws the covered bins.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # pylint: disable=wrong-import-position,wrong-import-order
from matplotlib.colors import LinearSegmentedColormap  # pylint: disable=wrong-import-position,wrong-import-order

# n = 1.5, PTTP: 6.4 degrees at most. The edge of the map, 50 m, is 6.285 degrees off nadir at the end, 454 m high.
WEDGE_DEG = 6.3668
RADIUS_M = 50
CASES = [("100 / -61.8 Hz", {"rates_hz": [100, -61.8], "phases_deg": [0, 180]}),
         ("80 / -79 Hz", {"rates_hz": [80, -79], "phases_deg": [0, 180]}),
         ("100 / 99.5 Hz", {"rates_hz": [100, 99.5], "phases_deg": [0, 180]}),
         ("100 / -99.5 Hz", {"rates_hz": [100, -99.5], "phases_deg": [0, 180]}),
         ("steered spiral", {"pattern": {"type": "spiral", "radius_m": RADIUS_M + 0.25, "pitch_m": 0.5}})]


def run(options, tool, *arguments):
    subprocess.run([os.path.join(options.bin, tool), *map(str, arguments), "-q", "-O"], check=True)


def measure(options, folder, scanner):
    """The metrics of one scan, and which of its bins hold a return."""
    scan, dem, metrics = (os.path.join(folder, name) for name in ("scan.h5", "dem.h5", "metrics.json"))
    config = {"scanner": {"type": "risley", "wedge_deg": WEDGE_DEG, **scanner}}
    with open(os.path.join(folder, "scan.json"), "w", encoding="utf-8") as file:
        json.dump(config, file)
    run(options, "scan-sim", "-c", file.name, "--terrain", os.path.join(folder, "terrain.h5"), "-o", scan, "--float32")
    run(options, "regrid", scan, "--layers", "z_est,count", "-o", dem)
    run(options, "dem-eval", dem, "--metrics-only", "--metrics", metrics)
    with open(metrics, encoding="utf-8") as file:
        result = json.load(file)
    with h5py.File(dem) as file:
        return result, file["count"][()] > 0, file["x"][()]


def draw(ax, name, result, covered, x):
    """Redder the more bins of a block of 4 x 4 are uncovered; white outside the map."""
    cells = len(x) // 4 * 4
    whole = covered[:cells, :cells].reshape(cells // 4, 4, cells // 4, 4).mean(axis=(1, 3))
    centre = x[:cells].reshape(-1, 4).mean(axis=1)
    whole[np.hypot(centre[:, None], centre[None, :]) > RADIUS_M] = np.nan
    colors = LinearSegmentedColormap.from_list("covered", ["#d7301f", "#eef3f7"])
    ax.imshow(whole, origin="lower", extent=[x[0], x[-1]] * 2, cmap=colors, vmin=0, vmax=1, interpolation="antialiased")
    ax.add_patch(plt.Circle((0, 0), RADIUS_M, fill=False, color="black", linewidth=0.6))
    ax.set_title(f"{name}\n{100 * result['coverage']['invalid_frac']:.2f} % uncovered", fontsize=10)
    ax.set_xticks([-50, 0, 50])
    ax.set_yticks([-50, 0, 50])
    ax.set_xlabel("x (m)")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", metavar="PNG", required=True)
    parser.add_argument("--bin", metavar="DIR", default="build/release/bin", help="where the tools are")
    options = parser.parse_args()
    figure, axes = plt.subplots(1, len(CASES), figsize=(15, 3.6), sharey=True, layout="constrained")
    print("| case | uncovered | bins | largest hole, bins | holes over 10 bins | requirement, 1 % |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        run(options, "terrain-gen", "-o", os.path.join(folder, "terrain.h5"))
        for ax, (name, scanner) in zip(axes, CASES):
            result, covered, x = measure(options, folder, scanner)
            coverage = result["coverage"]
            print(f"| {name} | {100 * coverage['invalid_frac']:.2f} % | {coverage['invalid_count']:,} | "
                  f"{coverage['largest_hole_bins']:,} | {coverage['holes_over_limit']:,} | "
                  f"{'met' if result['requirements']['coverage']['pass'] else 'missed'} |", flush=True)
            draw(ax, name, result, covered, x)
    axes[0].set_ylabel("y (m)")
    figure.savefig(options.output, dpi=110)


if __name__ == "__main__":
    sys.exit(main())
