#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A landing site on Europa: a DEM of 12.5 m, relief below its resolution, and rocks; paper_examples_test.py has the whole chain on it.

The DEM is made from the real raster, or from the relief in testdata/rasters where that is missing.
"""
import math
import os
import subprocess
import unittest

import h5py
import numpy as np

from harness import ToolTest

RELIEF = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "rasters", "relief_europa_10m.tif")
DATA = os.environ.get("LANDFALL_DATA", os.path.join(os.environ["LANDFALL_ROOT"], "..", "shared", "data"))
EUROPA = os.path.join(DATA, "dem", "europa_e26_terminator_10m.tif")
FRACTAL = {"type": "fractal", "hurst_exponent": 0.8, "rms_deviation_m": 0.87, "reference_length_m": 10}
ROCKS = {"type": "golombek_rocks", "k": 0.05, "min_diameter_m": 0.3, "max_diameter_m": 4, "overlap": False}
ROCKS_PER_HECTARE = 804  # of at least 0.3 m, by Golombek and Rapp for k = 0.05


def fraction_of_long_waves(x, hurst):
    """The fraction of a self-affine relief's squared deviation at lag L that waves with k L < x contribute: the integral of
    (1 - J0(x)) x^(-1 - 2 H) from 0 to a small x, from two terms of J0's series, divided by the integral to infinity."""
    all_waves = math.gamma(1 - hurst) / (2 ** (2 * hurst + 1) * hurst * math.gamma(1 + hurst))
    return (x ** (2 - 2 * hurst) / (4 * (2 - 2 * hurst)) - x ** (4 - 2 * hurst) / (64 * (4 - 2 * hurst))) / all_waves


class Site(ToolTest):
    source = EUROPA if os.path.exists(EUROPA) else RELIEF

    def terrain(self, name, **parts):
        config = {"grid": {"half_width_m": 60, "resolution_m": 0.1}, **parts}
        self.succeed("terrain-gen", "-c", self.config(config, name + ".json"), "-o", self.path(name + ".h5"))
        with h5py.File(self.path(name + ".h5")) as file:
            return file["z"][()], {key: file["features"][key][()] for key in file.get("features", {})}

    def test_a_dem_with_added_relief_and_rocks(self):
        raster = self.path("europa.tif")
        subprocess.run(["gdalwarp", "-q", "-tr", "12.5", "12.5", "-r", "bilinear", self.source, raster], check=True)
        dem = {"type": "dem", "path": raster}
        smooth, _ = self.terrain("smooth", base=dem)
        rough, _ = self.terrain("rough", base=[dem, FRACTAL])
        rocky, rocks = self.terrain("rocky", base=[dem, FRACTAL], patterns=[ROCKS])
        self.check_only_short_waves(rough - smooth)
        self.check_rocks(rocky - rough, rocks)

    def check_only_short_waves(self, added):
        """The fractal adds no relief at wavelengths of 25 m and more; its deviation at a lag of 1 m follows the power law."""
        block = 250  # 25 m
        means = added[:1000, :1000].reshape(4, block, 4, block).mean(axis=(1, 3))
        self.assertLess(means.std(), 0.1 * added.std())
        deviation = math.sqrt(np.mean((added[:, 10:] - added[:, :-10]) ** 2))
        expected = 0.87 * 0.1**0.8 * math.sqrt(1 - fraction_of_long_waves(2 * math.pi / 25, 0.8))
        self.assertAlmostEqual(deviation, expected, delta=0.1 * expected)

    def check_rocks(self, lift, rocks):
        expected = ROCKS_PER_HECTARE * 1.44
        self.assertLess(abs(len(rocks["x"]) - expected), 4 * math.sqrt(expected))
        self.assertGreaterEqual(lift.min(), 0)
        covered = (lift > 0).mean()
        self.assertGreater(covered, 0.005)
        self.assertLess(covered, 0.05)
        for i in np.argsort(rocks["diameter"])[-20:]:
            row, col = round((rocks["y"][i] + 60) / 0.1), round((rocks["x"][i] + 60) / 0.1)
            self.assertGreater(lift[row, col], 0.5 * rocks["height"][i])


if __name__ == "__main__":
    unittest.main()
