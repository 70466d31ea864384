#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bins that the paper's raster scan at full size leaves uncovered, for each way of driving the mirror.

The expected numbers come from an independent implementation of the same scene: ten cones on a 25 m ring, 40,000 pulses of
18 x 18 pixels from 500 m, 5 cm bins, 3,141,521 bins in the region. Counts on the flanks of the cones depend on rounding.
"""
import json
import os
import unittest

from harness import ROOT, ToolTest, read_bytes

STUDIES = os.path.join(ROOT, "studies", "")
# (what the pattern does, its values, bins without a return, of 3,141,521, tolerance)
PATTERNS = [("lines in one direction cover", {"direction": "unidirectional"}, 106, 8),
            ("lines in either direction cover equally", {"direction": "boustrophedon"}, 106, 8),
            ("without compensation the rim is uncovered", {"compensated": False}, 74932, 100),  # 2.4 %
            ("ramps in one direction cover", {"ramped": True}, 77, 8),
            # 3.2 %; shifting the start of a ramp by millimetres changes this count by about 300.
            ("ramps in alternating directions leave wedges", {"ramped": True, "direction": "boustrophedon"}, 100520, 300)]


class Rasters(ToolTest):
    def test_uncovered_bins(self):
        terrain, scan, dem, metrics = map(self.path, ("terrain.h5", "scan.h5", "dem.h5", "metrics.json"))
        self.succeed("terrain-gen", "-c", STUDIES + "cones.terrain.json", "-o", terrain)
        for what, pattern, expected, tolerance in PATTERNS:
            with self.subTest(what):
                values = [word for key, value in pattern.items() for word in ("--set", f"scanner.pattern.{key}={json.dumps(value)}")]
                self.succeed("scan-sim", "-c", STUDIES + "raster-200x200.scan.json", *values, "--terrain", terrain, "--compression", 0, "-o", scan, "-O")
                self.succeed("regrid", scan, "-c", STUDIES + "regrid.json", "--layers", "z_est,count", "--compression", 0, "-o", dem, "-O")
                self.succeed("dem-eval", dem, "-c", STUDIES + "evaluation.json", "--metrics-only", "--metrics", metrics, "-o", self.path("eval.h5"), "-O")
                found = json.loads(read_bytes(metrics))
                self.assertEqual(found["region"]["bin_count"], 3141521)
                self.assertAlmostEqual(found["coverage"]["invalid_count"], expected, delta=tolerance)


if __name__ == "__main__":
    unittest.main()
