#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A terrain with more nodes than are loaded at once: its scans and DEMs equal those of the part that they need; a wrong range is refused."""
import json
import shutil
import unittest

import h5py
import numpy as np

from harness import SANITIZED, ToolTest, columns, read_bytes

# 4201 x 4201 nodes: more than the 2^24 up to which scan-sim and regrid load all nodes.
TERRAIN = {"grid": {"half_width_m": 105, "resolution_m": 0.05},
           "base": {"type": "plane", "elevation_m": 2, "slope_x": 0.03, "slope_y": -0.02},
           "patterns": [{"type": "ring", "count": 12, "radius_m": 20, "feature": {"type": "cone", "radius_m": 3,
                                                                                  "height_m": 4}},
                        {"type": "ring", "count": 40, "radius_m": 95, "feature": {"type": "hemisphere", "radius_m": 4}}]}
SCAN = {"laser": {"pulse_rate_hz": 2000, "scan_time_s": 0.2},
        "scanner": {"type": "fsm", "incidence_deg": 0,
                    "pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 22}},
        "trajectory": {"type": "constant_velocity", "position_m": [5, -3, 300], "velocity_mps": [0, 0, -20]},
        "noise": {"range_sigma_m": 0.01}, "seed": 3}
REGRID = {"resolution_m": 0.1, "half_width_m": 25}


class LargeTerrain(ToolTest):
    def scanned(self, terrain, *options):
        """(JSON summary, points, DEM layers) of a scan of this terrain."""
        name = terrain.rsplit(".", 1)[0]
        config, grid = self.config(SCAN, "scan.json"), self.config(REGRID, "regrid.json")
        scan, dem = self.path(name + "_scan.h5"), self.path(name + "_dem.h5")
        summary = self.succeed("scan-sim", "-O", "-c", config, "--terrain", self.path(terrain), "-o", scan, "--json", *options)
        self.succeed("regrid", "-O", scan, "-c", grid, "--terrain", self.path(terrain), "-o", dem)
        return json.loads(summary.stdout), columns(scan, "points"), columns(dem, "/")

    def check_same(self, found, expected):
        for part, other in zip(found[1:], expected[1:], strict=True):
            self.assertEqual(part.keys(), other.keys())
            for name in part:
                np.testing.assert_allclose(part[name], other[name], rtol=0, atol=1e-9, err_msg=name)

    def cropped(self, name, nodes):
        """Writes the middle of the large terrain to a separate file, small enough to be loaded completely."""
        shutil.copy(self.path("large.h5"), self.path(name))
        with h5py.File(self.path(name), "a") as file:
            x, z = file["x"][()], file["z"][()]
            first = (x.size - nodes) // 2
            part = slice(first, first + nodes)
            for key in ("x", "y", "z"):
                del file[key]
            file["x"], file["y"], file["z"] = x[part], x[part], z[part, part]

    def rewritten(self, name, change):
        self.changed(self.path("large.h5"), change, name)

    def test_results_do_not_depend_on_the_loaded_part(self):
        self.succeed("terrain-gen", "-c", self.config(TERRAIN), "-o", self.path("large.h5"))
        large = self.scanned("large.h5")
        self.cropped("middle.h5", 1401)
        self.check_same(large, self.scanned("middle.h5"))
        if not SANITIZED:
            self.assertLess(large[0]["peak_memory_bytes"], 4201**2 * 16)  # all nodes and their pyramid would take more

        def without_range(file):
            del file["z"].attrs["actual_range"]

        def contiguous(file):
            z = file["z"][()]
            del file["z"]
            file["z"] = z  # without chunks and without actual_range

        for name, change in (("no_range.h5", without_range), ("contiguous.h5", contiguous)):
            self.rewritten(name, change)
            self.check_same(self.scanned(name), large)
        cone = ["--set", "trajectory.position_m=[18,0,300]", "--set", "scanner.pattern.half_width_m=4"]  # the engine takes a second per 10 m x 10 m
        self.check_same(self.scanned("large.h5", *cone, "--engine", "cgal"), self.scanned("large.h5", *cone))
        one = self.path("one.h5")
        scan = ["-c", self.config(SCAN, "scan.json"), "--terrain", self.path("large.h5")]
        self.succeed("scan-sim", *scan, "-t", "1", "-o", one)
        self.succeed("scan-sim", *scan, "-t", "7", "-o", self.path("seven.h5"))
        self.assertEqual(read_bytes(one), read_bytes(self.path("seven.h5")))

        def wrong(file):
            file["z"].attrs["actual_range"] = np.array([0.0, 2.5])

        self.rewritten("wrong.h5", wrong)
        self.refuse(1, "scan-sim", "-c", self.config(SCAN, "scan.json"), "--terrain", self.path("wrong.h5"), "-o",
                    self.path("scan.h5"), words=["wrong.h5", "actual_range"], output=self.path("scan.h5"))


if __name__ == "__main__":
    unittest.main()
