#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A short run of the uncertainty study, which compares the sigma map with the truth, and the study's arithmetic."""
import csv
import math
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.environ["LANDFALL_ROOT"]
BIN = os.environ["LANDFALL_BIN"]
sys.path[:0] = [os.path.join(ROOT, "python"), os.path.join(ROOT, "studies", "runners")]
# pylint: disable=wrong-import-position
import h5py
from landfall.errors import UsageError
import numpy as np
import uncertainty_study as study


def run_script(name, *arguments):
    return subprocess.run([os.path.join(ROOT, "studies", "runners", name), *map(str, arguments)], capture_output=True, text=True,
                          timeout=600, check=False)


class ShortStudy(unittest.TestCase):
    """4 draws of noise and 60 of navigation errors, seed 1.

    Noise: the fraction of n independent scores within k sigma has a standard deviation of at most 0.5 / sqrt(n). The limits
    differ by at least 0.008 from the fractions of 100 draws (over 20,000 scores each): by more than 2 standard deviations
    for counts 1 and 2 of z_est on flat ground, and 5 elsewhere. The seed is fixed.
    Navigation: each map has one error, so 60 times the mean square of 60 scores is chi-square with 60 degrees of freedom;
    the mean square is outside [0.5, 1.65] for 4 of 10,000 seeds.
    """

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        result = run_script("uncertainty_study.py", "-o", cls.folder.name, "--bin", BIN, "--scenes", "flat,fractal,rocks",
                            "--noise-draws", 4, "--navigation-draws", 60)
        if (result.returncode, result.stderr) != (0, ""):
            raise AssertionError(result.stderr)
        with open(os.path.join(cls.folder.name, "zscores.csv"), encoding="utf-8") as file:
            cls.rows = list(csv.DictReader(file))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def chosen(self, **wanted):
        return [row for row in self.rows if all(row[key] == value for key, value in wanted.items())]

    def test_noise_alone_is_within_the_limits(self):
        for scene, elevation in (("flat", "z_est"), ("flat", "z_corrected"), ("fractal", "z_corrected")):
            for count in ("1", "2", "4", "all"):
                (row,) = self.chosen(scene=scene, errors="noise", elevation=elevation, count=count, slope="all")
                self.assertGreater(int(row["scores"]), 20000)
                for sigmas, (low, high) in study.LIMITS.items():
                    share = float(row[f"within_{sigmas}"])
                    self.assertTrue(low <= share <= high, f"{scene} {elevation} {count}: {share} within {sigmas}")

    def test_noise_on_the_flanks_of_rocks(self):
        for elevation in ("z_est", "z_corrected"):
            (row,) = self.chosen(scene="rocks", errors="noise", elevation=elevation, count="all", slope="above 0.7")
            self.assertGreater(int(row["scores"]), 10000)
            self.assertTrue(0.92 <= float(row["std"]) <= 1.10, row)
            self.assertTrue(0.93 <= float(row["within_2"]) <= 0.97, row)
            for count in study.FLANK_COUNTS:
                (part,) = self.chosen(scene="rocks", errors="noise", elevation=elevation, count=count, slope="above 0.7")
                rms = math.hypot(float(part["std"]), float(part["mean"]))
                self.assertTrue(0.85 <= rms <= 1.12, part)

    def test_navigation_errors_have_the_predicted_size(self):
        for scene in ("flat", "fractal"):
            for elevation in ("z_est", "z_corrected"):
                (row,) = self.chosen(scene=scene, errors="navigation", elevation=elevation, count="all", slope="all")
                mean_square = float(row["std"]) ** 2 + float(row["mean"]) ** 2
                self.assertTrue(0.5 < mean_square < 1.65, f"{scene} {elevation}: {mean_square}")

    def test_the_figure_is_written(self):
        with open(os.path.join(self.folder.name, "by-count.png"), "rb") as file:
            self.assertEqual(file.read(4), b"\x89PNG")


class Arithmetic(unittest.TestCase):
    def test_tally_by_hand(self):
        tally = study.Tally()
        tally.add(np.array([0.5, -1.5, 2.5, np.nan, 1.0]), np.array([1, 1, 2, 2, 9]), np.array([0, 0.7, 0.09, 0.1, 2]))
        rows = list(study.rows_of("flat", "noise", 1, {"z_est": tally}))
        self.assertEqual([(row["count"], row["slope"], row["scores"]) for row in rows],
                         [(1, "all", 2), (2, "all", 1), ("all", "all", 4), ("all", "below 0.1", 2), ("all", "above 0.7", 2),
                          ("1", "above 0.7", 1), ("7+", "above 0.7", 1)])
        self.assertEqual((rows[0]["mean"], rows[0]["std"], rows[0]["within_1"], rows[0]["within_2"]), (-0.5, 1, 0.5, 1))
        self.assertEqual((rows[2]["within_1"], rows[2]["within_2"]), (0.5, 0.75))

    def test_unknown_scene(self):
        with self.assertRaises(UsageError):
            study.parse(["-o", "x", "--scenes", "flat,moon"])

    def test_a_failing_tool_is_reported(self):
        with tempfile.TemporaryDirectory() as folder:
            result = run_script("uncertainty_study.py", "-o", folder, "--bin", BIN, "--dem", "/nowhere.tif", "--scenes",
                                "dem", "--noise-draws", 1, "--navigation-draws", 0)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"\Auncertainty_study.py: terrain-gen: [^\n]*/nowhere.tif[^\n]*\n\Z")


class CorrectedStudy(unittest.TestCase):
    """A cone 4 m wide, without noise: the corrected map has a tenth of the error."""

    def test_the_correction_removes_most_of_the_error(self):
        with tempfile.TemporaryDirectory() as folder:
            path = lambda name: os.path.join(folder, name)  # pylint: disable=unnecessary-lambda-assignment
            for name, arguments in (
                    ("terrain-gen", ["--set", "grid.half_width_m=3", "--set", "grid.resolution_m=0.05", "--set",
                                     'features=[{"type": "cone", "x_m": 0, "y_m": 0, "radius_m": 2, "height_m": 6}]',
                                     "-o", path("t.h5")]),
                    ("scan-sim", ["--terrain", path("t.h5"), "--set", "laser.pulse_rate_hz=50", "--set",
                                  "scanner.pattern.rows=10", "--set", "scanner.pattern.columns=10", "--set",
                                  "scanner.pattern.half_width_m=2.5", "-o", path("s.h5")]),
                    ("regrid", [path("s.h5"), "--terrain", path("t.h5"), "--set", "half_width_m=2.5", "--corrected", "-o",
                                path("d.h5")])):
                subprocess.run([os.path.join(BIN, name), *arguments], check=True)
            with open(path("eval.json"), "w", encoding="utf-8") as file:
                file.write('{"region_radius_m": 2}')
            result = run_script("corrected_study.py", path("d.h5"), "-o", path("out"), "--bin", BIN, "--config",
                                path("eval.json"))
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            with open(path("out/corrected.csv"), encoding="utf-8") as file:
                before, after = csv.DictReader(file)
            with h5py.File(path("d.h5")) as file:
                on_cone = file["z_true"][()] > 0
                error = (file["z_true"][()] - file["z_est"][()])[on_cone & (file["count"][()] > 0)]
            self.assertEqual(int(before["bins"]), error.size)
            self.assertAlmostEqual(float(before["rms_m"]), np.sqrt(np.mean(error ** 2)), delta=1e-5)
            self.assertGreater(int(before["failing_footprints"]), 100)
            self.assertEqual(int(after["failing_footprints"]), 0)
            self.assertLess(float(after["rms_m"]), 0.25 * float(before["rms_m"]))

    def test_a_dem_without_the_layer(self):
        with tempfile.TemporaryDirectory() as folder:
            result = run_script("corrected_study.py", os.path.join(folder, "none.h5"), "-o", folder, "--bin", BIN)
        self.assertEqual(result.returncode, 1)
        self.assertIn("none.h5", result.stderr)


if __name__ == "__main__":
    unittest.main()
