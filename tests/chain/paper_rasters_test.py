#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bins that the paper's raster scan at full size leaves uncovered, for each way of driving the mirror.

The expected numbers come from an independent implementation of the same scene: ten cones on a 25 m ring, 40,000 pulses of
18 x 18 pixels from 500 m, 5 cm bins, 3,141,521 bins in the region. Counts on the flanks of the cones depend on rounding.
"""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["LANDFALL_ROOT"])
BIN = pathlib.Path(os.environ["LANDFALL_BIN"])
STUDIES = ROOT / "studies"


class Rasters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="landfall-rasters-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.run_tool("terrain-gen", "-c", STUDIES / "cones.terrain.json", "-o", cls.folder / "terrain.h5")

    @staticmethod
    def run_tool(name, *arguments):
        result = subprocess.run([BIN / name, *map(str, arguments)], capture_output=True, text=True, check=False)
        if result.returncode != 0:
            raise AssertionError(f"{name}: {result.stderr}")

    def invalid_bins(self, **pattern):
        scan, dem, metrics = (self.folder / name for name in ("scan.h5", "dem.h5", "metrics.json"))
        values = [value for key, value in pattern.items()
                  for value in ("--set", f"scanner.pattern.{key}={json.dumps(value)}")]
        self.run_tool("scan-sim", "-c", STUDIES / "raster-200x200.scan.json", *values, "--terrain",
                      self.folder / "terrain.h5", "--compression", "0", "-o", scan, "-O")
        self.run_tool("regrid", scan, "-c", STUDIES / "regrid.json", "--layers", "z_est,count", "--compression", "0", "-o", dem, "-O")
        self.run_tool("dem-eval", dem, "-c", STUDIES / "evaluation.json", "--metrics-only", "--metrics", metrics, "-o",
                      self.folder / "eval.h5", "-O")
        found = json.loads(metrics.read_text(encoding="utf-8"))
        self.assertEqual(found["region"]["bin_count"], 3141521)
        return found["coverage"]["invalid_count"]

    def test_lines_in_either_direction_cover_equally(self):
        for direction in ("unidirectional", "boustrophedon"):
            self.assertAlmostEqual(self.invalid_bins(direction=direction), 106, delta=8)

    def test_without_compensation_the_rim_is_uncovered(self):
        self.assertAlmostEqual(self.invalid_bins(compensated=False), 74932, delta=100)  # 2.4 %

    def test_ramps_in_one_direction_cover(self):
        self.assertAlmostEqual(self.invalid_bins(ramped=True), 77, delta=8)

    def test_ramps_in_alternating_directions_leave_wedges(self):
        # Shifting the start of a ramp by millimetres changes this count by about 300.
        self.assertAlmostEqual(self.invalid_bins(ramped=True, direction="boustrophedon"), 100520, delta=300)  # 3.2 %


if __name__ == "__main__":
    unittest.main()
