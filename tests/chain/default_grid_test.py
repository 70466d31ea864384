#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The grid that regrid chooses for imported points (tests/unit/chain/gridding/posting_test.cpp has the search)."""
import json
import os
import subprocess
import unittest

import h5py
import numpy as np

from harness import ToolTest, config_of, run


class DefaultGrid(ToolTest):
    def setUp(self):
        super().setUp()
        subprocess.run([os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "make_strip.py"), self.folder], check=True)
        self.strip = self.imported("strip.las")
        self.dem = self.path("dem.h5")

    def imported(self, name, *arguments):
        self.succeed("landfall-import", "-q", self.path(name), "-o", self.path(name + ".h5"), *arguments)
        return self.path(name + ".h5")

    def points(self, name, *columns):
        np.savetxt(self.path(name), np.column_stack(columns), fmt="%.6f", delimiter=",", header="x,y,z", comments="")
        return self.imported(name, "--center", "0,0")

    def regrid(self, *arguments):
        done = self.succeed("regrid", *arguments, "-o", self.dem, "-O")
        self.assertLessEqual(done.stderr.count("\n"), 1)
        self.said = done.stderr
        with h5py.File(self.dem) as file:
            return {key: file[key][()] for key in ("x", "y", "count")}

    def grid(self):
        config = config_of(self.dem)
        return config["resolution_m"], config["half_width_m"]

    def test_extent_and_finest_posting_are_chosen_and_said(self):
        dem = self.regrid(self.strip)
        self.assertEqual(self.grid(), (0.5, 24))
        self.assertRegex(self.said, r"regrid: warning: .*strip\.las\.h5: no complete grid is given: half_width_m 24(\.0)?, the extent of the points; "
                         r"resolution_m 0\.5, the finest of 1, 2, 5 x 10\^k m that leaves at most 5 % of the bins between them empty \([0-9.]+ %\)\n")
        self.assertLess(np.mean(dem["count"] == 0), 0.05)
        summary = json.loads(self.succeed("regrid", self.strip, "-o", self.dem, "-O", "-q", "--json").stdout)
        self.assertEqual((len(summary["warnings"]), summary["outside_count"]), (1, 0))
        printed = json.loads(self.succeed("regrid", self.strip, "--print-config").stdout)
        self.assertEqual((printed["resolution_m"], printed["half_width_m"]), (0.5, 24))

    def test_what_is_given_stays(self):
        self.regrid(self.strip, "--set", "resolution_m=0.3")
        self.assertEqual(self.grid(), (0.3, 24))
        self.regrid(self.strip, "--set", "half_width_m=5")
        self.assertEqual(self.grid(), (0.5, 5))
        self.regrid(self.strip, "--set", "half_width_m=[6,3]", "--set", "center_m=[-9,-5]")
        self.assertEqual(self.grid(), (0.5, [6, 3]))
        self.regrid(self.strip, "--set", "half_width_m=5", "--set", "resolution_m=0.5")
        self.assertEqual(self.said, "")
        self.refuse(2, "regrid", self.strip, "-o", self.path("no.h5"), "--set", "half_width_m=0.7", words=["half_width_m", "resolution_m"],
                    output=self.path("no.h5"))

    def test_the_grid_reaches_the_farthest_point_on_each_axis(self):
        step = np.arange(40) * 0.2
        x, y = (part.ravel() for part in np.meshgrid(step + 3, step[:10]))
        dem = self.regrid(self.points("far.csv", x, y, 0 * x))
        self.assertEqual(self.grid(), (0.2, [10.8, 1.8]))
        self.assertEqual(dem["count"].sum(), x.size)

    def test_several_scans_count_together(self):
        x, y = (part.ravel() for part in np.meshgrid(np.arange(20.0), np.arange(20.0)))
        west, east = self.points("w.csv", x - 20, y - 10, 0 * x), self.points("e.csv", x, y - 10, 0 * x)
        self.regrid(west, east)
        self.assertEqual(self.grid(), (1, [20, 10]))

    def test_a_poor_posting_has_a_better_one_proposed(self):
        self.regrid(self.strip, "--set", "half_width_m=24", "--set", "resolution_m=0.05")
        self.assertIn("more than half of the bins between the points are empty: resolution_m 0.5 would leave at most 5 % empty", self.said)
        self.regrid(self.strip, "--set", "half_width_m=100", "--set", "resolution_m=0.5")
        self.assertEqual(self.said, "")

    def test_points_without_an_extent_are_refused(self):
        self.refuse(2, "regrid", self.points("one.csv", [1.0], [2.0], [3.0]), "-o", self.dem, words=["lie on one point", "half_width_m"], output=self.dem)

    def test_points_far_from_the_origin_need_a_centre(self):
        with h5py.File(self.strip) as file:
            columns = [file["points"][axis + "_est"][()] for axis in "xyz"]
        far = self.points("far.csv", columns[0] + 500000, columns[1] + 5400000, columns[2])
        self.refuse(2, "regrid", far, "-o", self.dem, words=["more than 2^30", "center_m"], output=self.dem)
        self.regrid(far, "--set", "center_m=[500000,5400000]")
        self.assertEqual(self.grid(), (0.5, 24))

    def test_other_scans_keep_their_defaults(self):
        self.succeed("terrain-gen", "-o", self.path("t.h5"), "--set", "grid.half_width_m=8", "--set", "grid.resolution_m=0.5")
        self.succeed("scan-sim", "--terrain", self.path("t.h5"), "-o", self.path("s.h5"), "--set", "laser.scan_time_s=0.02", "--set",
                     'scanner.pattern={"type":"line_search","rows":4,"columns":8,"half_width_m":6}')
        self.assertEqual(json.loads(self.succeed("regrid", self.path("s.h5"), "--print-config").stdout)["half_width_m"], 50)
        self.succeed("regrid", "--check", self.path("none.h5"))
        self.assertEqual(run("regrid", self.path("none.h5"), "-o", self.dem).returncode, 1)


if __name__ == "__main__":
    unittest.main()
