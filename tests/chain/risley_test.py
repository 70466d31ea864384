#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Risley prisms in the chain: pixels lost to total reflection, aims out of reach, and errors of the prism angles."""
import os
import unittest

import numpy as np

from harness import CONFIGS, ChainTest, columns, run

FOLDER = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "lidars")


class Risley(ChainTest):
    def setUp(self):
        super().setUp()
        self.terrain = self.path("terrain.h5")
        self.succeed("terrain-gen", "-c", self.config(CONFIGS["terrain-gen"]), "-o", self.terrain, "-O")

    def scan(self, name, *options, code=0):
        result = run("scan-sim", "-c", os.path.join(FOLDER, name + ".scan.json"), "--terrain",
                               self.terrain, "-o", self.path("scan.h5"), "-O", "--keep-misses", *options)
        self.assertEqual(result.returncode, code, result.stderr)
        return result.stderr

    def read(self):
        scan = self.path("scan.h5")
        detector = columns(scan, "detector")
        pixels = np.stack([detector["direction_" + axis].ravel() for axis in "xyz"], axis=1)
        return columns(scan, "points"), columns(scan, "pulses"), pixels

    def test_pixels_beyond_the_critical_angle_are_lost(self):
        self.scan("risley-total_reflection")
        points, pulses, pixels = self.read()
        # In prism 1 a ray has the transverse components pixel_xy / n; the exit face is tilted by the wedge towards angle_1.
        n, wedge = 1.5, np.radians(41.5)
        inside = pixels.copy() / n
        inside[:, 2] = np.sqrt(1 - inside[:, 0] ** 2 - inside[:, 1] ** 2)
        angle = pulses["angle_1"][points["pulse"]]
        normal = np.stack([np.sin(wedge) * np.cos(angle), np.sin(wedge) * np.sin(angle),
                           np.full(angle.shape, np.cos(wedge))], axis=1)
        beyond = np.arccos((normal * inside[points["pixel"]]).sum(axis=1)) > np.arcsin(1 / n)
        np.testing.assert_array_equal(points["status"] == 5, beyond)
        self.assertGreater(beyond.mean(), 0.1)
        self.assertLess(beyond.mean(), 0.9)
        self.assertTrue(np.isnan(points["x_est"][beyond]).all())
        self.assertTrue(np.isnan(points["range_true"][beyond]).all())

    def test_an_aim_out_of_reach_is_refused_with_pulse_and_angle(self):
        error = self.scan("risley-pattern", "--set", "scanner.wedge_deg=4", code=1)
        self.assertIn("pulse 0 aims", error)
        self.assertIn("the prisms reach 0 to 4.0", error)

    def test_encoder_errors_move_only_the_truth(self):
        self.scan("risley-pattern", "--set", "noise.dropout_frac=0.1")
        off, pulses_off, _ = self.read()
        self.scan("risley-pattern", "--set", "noise.dropout_frac=0.1", "--set", "scanner.encoder_sigma_rad=0")
        ideal, pulses, _ = self.read()
        np.testing.assert_array_equal(off["status"] == 2, ideal["status"] == 2)
        for angle in ("angle_1", "angle_2"):
            self.assertAlmostEqual(np.std(pulses_off[angle] - pulses[angle]) / 0.001, 1, delta=0.2)
        hit = (off["status"] == 0) & (ideal["status"] == 0)
        # The estimate uses the commanded beam: estimated points differ by range only, true points also by angle.
        moved = np.hypot(off["x_true"] - ideal["x_true"], off["y_true"] - ideal["y_true"])[hit]
        estimated = np.hypot(off["x_est"] - ideal["x_est"], off["y_est"] - ideal["y_est"])[hit]
        self.assertGreater(np.median(moved), 3 * np.median(estimated))
        self.assertLess(np.median(moved), 50 * 0.0746 * 0.001 * 3)  # 1 mrad rotates the 4.3 deg deflection of one wedge


if __name__ == "__main__":
    unittest.main()
