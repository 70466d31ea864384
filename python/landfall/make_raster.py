# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a GeoTIFF of a cratered plain, for trying landfall without real data. Needs gdal_translate (gdal-bin).

Elevations in metres on a polar stereographic map of the Moon's south pole, float32, without rocks.
"""
import argparse
import os
import tempfile

import numpy as np

from landfall import command, tools
from landfall.errors import UsageError

CRATERS_PER_KM2 = 1500
SMALLEST_M, LARGEST_M = 6, 40
# The distance at which a rim has a thousandth of its height, in crater radii.
REACH_RADII = 10
CRS = "+proj=stere +lat_0=-90 +lon_0=0 +k=1 +x_0=0 +y_0=0 +R=1737400 +units=m +no_defs"


def crater(distance_m, diameter_m):
    """Depth of a fifth of the diameter, with a rim whose height falls off with the third power of the distance."""
    depth_m, rim_m, r = 0.2 * diameter_m, 0.04 * diameter_m, distance_m / (diameter_m / 2)
    bowl = (depth_m + rim_m) * r**2 - depth_m
    return np.where(r < 1, bowl, rim_m * np.maximum(r, 1)**-3)


def elevations(x, y, seed):
    """A gentle slope with long swells and craters, N(>D) ~ D^-2, metres about -1200 m; shape (y, x)."""
    random = np.random.RandomState(seed)
    x, y = x - x.mean(), (y - y.mean())[:, None]
    width_m = x[-1] - x[0]
    z = -1200 + 0.03 * x + 2 * np.sin(x / 45) * np.cos(y / 60)
    for _ in range(max(1, round(CRATERS_PER_KM2 * width_m**2 / 1e6))):
        diameter_m = min(SMALLEST_M * random.uniform() ** -0.5, LARGEST_M)
        at_x, at_y = random.uniform(-width_m / 2, width_m / 2, 2)
        rows = np.abs(y[:, 0] - at_y) < REACH_RADII * diameter_m / 2
        columns = np.abs(x - at_x) < REACH_RADII * diameter_m / 2
        z[np.ix_(rows, columns)] += crater(np.hypot(x[columns] - at_x, y[rows] - at_y), diameter_m)
    return z


def write(path, z, west_m, north_m, posting_m):
    """Writes a GeoTIFF with gdal_translate, from a raw file with an ENVI header; row 0 of `z` is the northernmost."""
    rows, columns = z.shape
    with tempfile.TemporaryDirectory() as folder:
        raw = os.path.join(folder, "z.raw")
        z.astype("<f4").tofile(raw)
        with open(os.path.join(folder, "z.hdr"), "w", encoding="ascii") as header:
            header.write(f"ENVI\nsamples = {columns}\nlines = {rows}\nbands = 1\ndata type = 4\nbyte order = 0\n")
        edges = [west_m, north_m, west_m + columns * posting_m, north_m - rows * posting_m]
        tools.run_tool("gdal_translate", "-q", "-of", "GTiff", "-a_srs", CRS, "-a_ullr", *edges, raw, path)


def main(arguments):
    parser = command.Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", required=True, metavar="FILE.tif")
    parser.add_argument("--posting", type=float, default=2, metavar="M", help="edge of a cell, m (2)")
    parser.add_argument("--cells", type=int, default=257, metavar="N", help="cells along each edge (257)")
    parser.add_argument("--center", type=float, nargs=2, default=[3800, 3380], metavar=("X", "Y"), help="on the map, m (3800 3380)")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    if options.cells < 2 or not options.posting > 0 or not np.isfinite([options.posting, *options.center]).all() or not 0 <= options.seed < 2**32:
        raise UsageError("--cells must be at least 2, --posting above 0, --center finite, --seed in 0 .. 4294967295")
    command.check_outputs([options.output], overwrite=False)
    offsets = (np.arange(options.cells) - (options.cells - 1) / 2) * options.posting
    x, y = options.center[0] + offsets, options.center[1] - offsets
    if not np.allclose((np.diff(x), -np.diff(y)), options.posting, 1e-6, 0):
        raise UsageError(f"--posting {options.posting:g}: is lost in the digits of --center {options.center[0]:g} {options.center[1]:g}")
    half_m = options.cells * options.posting / 2
    write(options.output, elevations(x, y, options.seed), options.center[0] - half_m, options.center[1] + half_m, options.posting)
