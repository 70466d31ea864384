#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every component of a lidar runs in the chain: each testdata/lidars/NAME.scan.json on two terrains.

A file beside it, NAME.csv, is a table that the configuration names by its bare name.
"""
import glob
import json
import os
import unittest

import numpy as np

from harness import CONFIGS, ChainTest, read_bytes, returns_of
from oracle import surface

FOLDER = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "lidars")
NAMES = sorted(os.path.basename(path).removesuffix(".scan.json")
               for path in glob.glob(os.path.join(FOLDER, "*.scan.json")))
TERRAINS = {"relief": CONFIGS["terrain-gen"],
            "fractal": {"grid": {"half_width_m": 8, "resolution_m": 0.1},
                        "base": {"type": "fractal", "hurst_exponent": 0.8, "rms_deviation_m": 0.2, "reference_length_m": 2}}}
ERRORS = ["--set", "noise.range_sigma_m=0.01", "--set", "noise.dropout_frac=0.02", "--set",
          "navigation_error.velocity_mps=[0.1,0.05,-0.1]"]


class Components(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        os.chdir(FOLDER)  # where the tables are that the configurations name

    def scan(self, name, terrain, *options):
        self.succeed("scan-sim", "-c", os.path.join(FOLDER, name + ".scan.json"), "--terrain", terrain, "-o",
                     self.path("scan.h5"), "-O", *options)
        return self.path("scan.h5")

    def test_they_are_found(self):
        self.assertIn("fsm-line_search", NAMES)

    def test_the_chain_runs_and_threads_change_no_byte(self):
        for place, config in TERRAINS.items():
            terrain, dem = self.path(place + ".h5"), self.path("dem.h5")
            self.succeed("terrain-gen", "-c", self.config(config), "-o", terrain)
            for name in NAMES:
                with self.subTest(name, terrain=place):
                    one = read_bytes(self.scan(name, terrain, *ERRORS, "-t", 1))
                    self.assertEqual(one, read_bytes(self.scan(name, terrain, *ERRORS, "-t", 2)))
                    self.succeed("regrid", self.path("scan.h5"), "--terrain", terrain, "-c",
                                 self.config(CONFIGS["regrid"]), "-o", dem, "-O")
                    self.succeed("dem-eval", dem, "-c", self.config(CONFIGS["dem-eval"]), "-o",
                                 self.path("eval.h5"), "-O", "--metrics", self.path("metrics.json"))
                    with open(self.path("metrics.json"), encoding="utf-8") as file:
                        self.assertGreater(json.load(file)["region"]["bin_count"], 0)

    def test_true_points_lie_on_the_terrain(self):
        terrain = self.path("ground.h5")
        self.succeed("terrain-gen", "-c", self.config(TERRAINS["relief"]), "-o", terrain)
        ground = surface.of_file(terrain)
        for name in NAMES:
            with open(os.path.join(FOLDER, name + ".scan.json"), encoding="utf-8") as file:
                if json.load(file).get("detector", {}).get("subpixels", 1) > 1:
                    continue  # the point lies on the centre ray at a mean range
            with self.subTest(name):
                points = returns_of(self.scan(name, terrain))
                hit = points["status"] == 0
                heights = ground.elevation(points["x_true"][hit], points["y_true"][hit])
                self.assertLess(np.abs(heights - points["z_true"][hit]).max(), 1e-6)
                self.assertGreater(hit.sum(), 300)


if __name__ == "__main__":
    unittest.main()
