#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every lidar component on a terrain: each testdata/lidars/NAME.scan.json.

A configuration names its table, NAME.csv in the same folder, without a path.
"""
import glob
import json
import os
import unittest

import numpy as np

from harness import ChainTest, columns, read_bytes, returns_of
from oracle import surface

FOLDER = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "lidars")
NAMES = sorted(os.path.basename(path).removesuffix(".scan.json")
               for path in glob.glob(os.path.join(FOLDER, "*.scan.json")))
ERRORS = ["--set", "noise.range_sigma_m=0.01", "--set", "noise.dropout_frac=0.02", "--set",
          "navigation_error.velocity_mps=[0.1,0.05,-0.1]"]


class Components(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        os.chdir(FOLDER)  # configurations name their tables without a path

    def scan(self, name, *options):
        self.succeed("scan-sim", "-c", os.path.join(FOLDER, name + ".scan.json"), "--terrain", self.chain.terrain,
                     "-o", self.path("scan.h5"), "-O", *options)
        return self.path("scan.h5")

    def test_configurations_are_found(self):
        self.assertIn("fsm-line_search", NAMES)

    def test_the_chain_gives_the_same_bytes_at_any_thread_count(self):
        for name in NAMES:
            with self.subTest(name):
                self.assertEqual(read_bytes(self.scan(name, *ERRORS, "-t", 1)), read_bytes(self.scan(name, *ERRORS, "-t", 2)))
                self.succeed("regrid", self.path("scan.h5"), "--terrain", self.chain.terrain, "-c", self.chain.config("regrid"),
                             "-o", self.path("d.h5"), "-O")
                self.assertGreater(np.count_nonzero(columns(self.path("d.h5"))["count"]), 0)

    def test_true_points_lie_on_the_terrain(self):
        ground = surface.of_file(self.chain.terrain)
        for name in NAMES:
            with open(os.path.join(FOLDER, name + ".scan.json"), encoding="utf-8") as file:
                if json.load(file).get("detector", {}).get("subpixels", 1) > 1:
                    continue  # the mean range of sub-pixels puts the point off the terrain
            with self.subTest(name):
                points = returns_of(self.scan(name))
                hit = points["status"] == 0
                heights = ground.elevation(points["x_true"][hit], points["y_true"][hit])
                self.assertLess(np.abs(heights - points["z_true"][hit]).max(), 1e-6)
                self.assertGreater(hit.sum(), 300)


if __name__ == "__main__":
    unittest.main()
