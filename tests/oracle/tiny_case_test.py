#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The small case of tests/harness compared with this package, within tighter bounds than random cases, and with GMT."""
import json
import shutil
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

from harness import EVAL, REGRID, SCAN, TERRAIN, ToolTest, columns, config_of, read_bytes, with_values
from oracle import comparison, regrid, surface
from oracle.ledger import Ledger

# The case meets some of these limits and misses others.
LIMITS = {"invalid_frac": 0.05, "hole_bins": 1, "distance_bins": 0.5, "relative_elevation_m": 0.03,
          "relative_horizontal_m": 0.042, "absolute_horizontal_m": 0.045, "absolute_horizontal_frac": 0.9}
CASE = {"terrain": TERRAIN, "scan": SCAN, "regrid": REGRID, "eval": {**EVAL, "limits": LIMITS},
        "options": {"keep_misses": False, "float32": False, "truth": True, "uncertainty": False, "corrected": False}}
# (absolute, relative) bounds by the prefix of a quantity's name.
BOUNDS = {"pulses: t": (1e-15, 0), "pulses: angle": (1e-13, 0), "pulses: p": (1e-12, 0), "pulses: q": (1e-14, 0),
          "detector: direction": (1e-15, 0), "dem: weight_sum (bilinear_nearest)": (0, 1e-13),
          "dem: z_est (bilinear_nearest)": (1e-13, 0), "dem: z_est (bilinear4)": (1e-9, 0), "dem: z_est": (1e-12, 0),
          "dem: x_true": (1e-12, 0), "dem: y_true": (1e-12, 0), "dem: z_true": (1e-11, 0), "dem: z_spread": (1e-9, 1e-6),
          "eval: e_": (1e-15, 0), "eval: abs_": (1e-12, 6e-8), "eval: rel_": (1e-12, 6e-8), "metrics: coverage": (0, 0),
          "metrics: requirements": (0, 0), "metrics: statistics.valid_frac": (5e-16, 0), "metrics: uncertainty": (1e-12, 1e-9),
          "metrics": (1e-15, 1e-12)}


class TinyCase(ToolTest):
    """The four tools run once; each test gets copies of their files in its working folder."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.files = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="landfall-oracle-"))
        with comparison.inside(cls.files):
            comparison.run_chain(CASE)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.files, self.folder, dirs_exist_ok=True)
        self.enterContext(comparison.inside(self.folder))
        self.enterContext(np.errstate(divide="ignore", invalid="ignore"))
        self.ground, self.ledger = surface.of_file("terrain.h5"), Ledger(BOUNDS)

    def assert_agreement(self):
        self.assertEqual(self.ledger.failures, [])

    def test_every_number(self):
        comparison.check(CASE, self.ledger)
        self.assert_agreement()

    def test_the_case_covers_all_flags_and_verdicts(self):
        """The comparison covers empty bins, every flag, and requirements that are met and missed."""
        count = columns("dem.h5")["count"]
        self.assertGreater((count == 0).sum(), 1000)
        self.assertGreater((count > 0).sum(), 3000)
        self.assertGreater(columns("eval.h5")["invalid"].sum(), 50)
        self.assertGreater(len(columns("scan.h5", "points")["status"]), 20000)
        for bit in (1, 2, 4, 8, 16, 32):
            self.assertTrue((columns("eval.h5")["fail"] & bit).any(), f"no flag {bit}")
        metrics = json.loads(read_bytes("metrics.json"))
        self.assertEqual({entry["pass"] for entry in metrics["requirements"].values()}, {True, False})
        self.assertIs(metrics["pass"], False)

    def check_map(self, *options, scans=("scan.h5",)):
        self.succeed("regrid", *scans, "--terrain", "terrain.h5", "-c", "regrid.json", *options, "-o", "dem.h5", "-O")
        comparison.check_dem(CASE, self.ledger, self.ground, scans)

    def test_two_scans_add_up(self):
        second = self.config(with_values(SCAN, seed=8, trajectory__position_m=[0.7, 0.1, 52]))
        self.succeed("scan-sim", "-c", second, "--terrain", "terrain.h5", "-o", "second.h5")
        alone = columns("dem.h5")["count"].sum()
        self.check_map(scans=("scan.h5", "second.h5"))
        self.assert_agreement()
        self.assertGreater(columns("dem.h5")["count"].sum(), 1.9 * alone)

    @unittest.skipUnless(shutil.which("gmt"), "GMT is not installed")
    def test_gmt_blockmean_agrees(self):
        points, _ = comparison.returns("scan.h5")
        bins, layers = regrid.Bins(points, config_of("dem.h5")), columns("dem.h5")
        rows = np.column_stack([*(points[f"{axis}_est"][bins.of] for axis in "xyz"), bins.weight])
        result = subprocess.run(["gmt", "blockmean", "-bi4d", "-bo4d", "-W", "-C", "-R-5/5/-5/5", "-I0.1"],
                                input=rows.astype("<f8").tobytes(), capture_output=True, check=True, timeout=60)
        x, y, z, weight = np.frombuffer(result.stdout, "<f8").reshape(-1, 4).T
        col, row = (np.rint(v / 0.1).astype(int) + 50 for v in (x, y))
        self.assertEqual(len(z), (layers["count"] > 0).sum())
        np.testing.assert_allclose(layers["z_est"][row, col], z, rtol=1e-12)
        np.testing.assert_allclose(layers["weight_sum"][row, col], weight, rtol=1e-12)

    def evaluated(self, layers):
        """Metrics of the DEM with these layers added, after a comparison with this package."""
        with h5py.File("dem.h5", "r+") as file:
            for name, values in layers.items():
                if name in file:
                    del file[name]
                file[name] = values
        inputs = ["dem.h5", "-c", "eval.json"]
        result = self.succeed("dem-eval", *inputs, "-o", "eval.h5", "-O", "--metrics", "metrics.json", "--json")
        comparison.check_evaluation(CASE, self.ledger)
        self.assert_agreement()
        metrics = json.loads(read_bytes("metrics.json"))
        self.assertEqual(json.loads(result.stdout)["metrics"], metrics)
        self.assertEqual(json.loads(self.succeed("dem-eval", *inputs, "--metrics-only").stdout), metrics)
        return metrics

    def test_corrected_elevation(self):
        """z_corrected is judged in addition to z_est, in either precision, and changes no other number."""
        plain = json.loads(read_bytes("metrics.json"))
        corrected = columns("dem.h5")["z_est"] + 0.01 * np.sin(np.arange(101))
        for dtype in (np.float64, np.float32):
            metrics = self.evaluated({"z_corrected": corrected.astype(dtype)})
            for part in (metrics["statistics"], metrics["accuracy"]["absolute"], metrics["accuracy"]["relative"]):
                self.assertTrue(part.pop("z_corrected"))
            self.assertEqual(metrics, plain)

    def test_uncertainty(self):
        sigma = (0.01 * 2**np.sin(np.arange(101)[:, None] + np.arange(101))).astype(np.float32)
        sigma[40:43, 40:43] = np.nan
        metrics = self.evaluated({"z_true_map": columns("dem.h5")["z_true"] + 0.002, "z_sigma_abs": sigma,
                                  "z_sigma_rel": 0.7 * sigma})
        self.assertGreater(metrics["uncertainty"]["absolute"]["left_out_count"], 0)


if __name__ == "__main__":
    unittest.main()
