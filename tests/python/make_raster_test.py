#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""make_raster.py: the georeference of its GeoTIFF, and the craters drawn from its seed."""
import json
import os
import subprocess
import tempfile
import unittest

import numpy as np

from harness import ROOT
from landfall import make_raster

SCRIPT = os.path.join(ROOT, "python", "commands", "make_raster.py")


def run(*arguments):
    return subprocess.run([SCRIPT, *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False)


class MakeRaster(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.path = os.path.join(self.folder, "site.tif")

    def test_size_extent_and_crs(self):
        self.assertEqual(run("-o", self.path, "--cells", 101, "--posting", 5, "--center", 1000, -2000).returncode, 0)
        info = json.loads(subprocess.run(["gdalinfo", "-json", self.path], capture_output=True, text=True, check=True).stdout)
        self.assertEqual(info["size"], [101, 101])
        np.testing.assert_allclose(info["geoTransform"], [1000 - 252.5, 5, 0, -2000 + 252.5, 0, -5])
        self.assertIn("1737400", info["coordinateSystem"]["wkt"])
        self.assertEqual(info["bands"][0]["type"], "Float32")

    def test_rows_go_from_north_to_south(self):
        self.assertEqual(run("-o", self.path, "--cells", 41).returncode, 0)
        values = subprocess.run(["gdallocationinfo", "-valonly", self.path, "3", "7"], capture_output=True, text=True, check=True)
        offsets = (np.arange(41) - 20) * 2.0
        z = make_raster.elevations(3800 + offsets, 3380 - offsets, 1)
        self.assertAlmostEqual(float(values.stdout), z[7, 3], delta=2e-4)

    def test_a_crater_is_a_bowl_with_a_rim(self):
        np.testing.assert_allclose(make_raster.crater(np.array([0, 5, 10]), 10), [-2, 0.4, 0.4 / 8])

    def test_seeds_differ_and_repeat(self):
        x = np.arange(10.0)
        self.assertTrue((make_raster.elevations(x, x, 1) == make_raster.elevations(x, x, 1)).all())
        self.assertTrue((make_raster.elevations(x, x, 1) != make_raster.elevations(x, x, 2)).any())

    def test_refusals(self):
        with open(self.path, "w", encoding="ascii"):
            pass
        for arguments in (["-o", self.path], ["-o", self.path + "2", "--cells", 1], ["-o", self.path + "2", "--posting", 0],
                          ["-o", self.path + "2", "--center", "nan", 0], ["-o", self.path + "2", "--posting", 1e-300]):
            result = run(*arguments)
            self.assertNotEqual(result.returncode, 0)
            self.assertRegex(result.stderr, r"\Alandfall make-raster: [^\n]+\n\Z")


if __name__ == "__main__":
    unittest.main()
