#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every lidar component in the whole chain: each testdata/lidars/NAME.scan.json on two terrains.

A configuration names its table, NAME.csv in the same folder, without a path.
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
        os.chdir(FOLDER)  # configurations name their tables without a path

    def scan(self, name, terrain, *options):
        self.succeed("scan-sim", "-c", os.path.join(FOLDER, name + ".scan.json"), "--terrain", terrain, "-o",
                     self.path("scan.h5"), "-O", *options)
        return self.path("scan.h5")

    def test_configurations_are_found(self):
        self.assertIn("fsm-line_search", NAMES)

    def test_the_chain_gives_the_same_bytes_at_any_thread_count(self):
        for terrain_name, config in TERRAINS.items():
            terrain, dem = self.path(terrain_name + ".h5"), self.path("dem.h5")
            self.succeed("terrain-gen", "-c", self.config(config), "-o", terrain)
            for name in NAMES:
                with self.subTest(name, terrain=terrain_name):
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
                    continue  # the mean range of sub-pixels puts the point off the terrain
            with self.subTest(name):
                points = returns_of(self.scan(name, terrain))
                hit = points["status"] == 0
                heights = ground.elevation(points["x_true"][hit], points["y_true"][hit])
                self.assertLess(np.abs(heights - points["z_true"][hit]).max(), 1e-6)
                self.assertGreater(hit.sum(), 300)


if __name__ == "__main__":
    unittest.main()
