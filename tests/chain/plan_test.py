#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""scan-sim --plan against counts from a traced scan of flat terrain."""
import json
import os
import subprocess
import unittest

import h5py
import numpy as np

from harness import CONFIGS, ChainTest, attributes, columns, with_values

# The scan reaches 6 m from the origin, and the region 5 m, so that some returns lie outside the region.
SCAN = with_values(CONFIGS["scan-sim"], scanner__pattern__half_width_m=6)
REGION = ["--plan-radius", 5, "--plan-resolution", 0.1]


def filled_share(count, region, k):
    """The share of blocks of k x k bins about the origin, wholly in the region, that have a return; None if there are fewer than 100."""
    half = count.shape[0] // 2
    found = []
    starts = [start + half for start in range(-half, half + 1) if (start + k // 2) % k == 0 and start + k - 1 <= half]
    for row in starts:
        for column in starts:
            block = slice(row, row + k), slice(column, column + k)
            if region[block].all():
                found.append(count[block].any())
    return np.mean(found) if len(found) >= 100 else None


class Plan(ChainTest):
    def plan(self, *options):
        return self.succeed("scan-sim", "-c", self.config(SCAN), "--plan", *REGION, *options)

    def test_counts_are_those_of_a_traced_scan(self):
        flat = self.path("flat.h5")
        self.succeed("terrain-gen", "-o", flat, "--set", 'grid={"half_width_m":20,"resolution_m":1}')
        self.succeed("scan-sim", "-c", self.config(SCAN), "--terrain", flat, "-o", self.path("scan.h5"), "--keep-misses")
        self.plan("-o", self.path("plan.h5"))
        layers = columns(self.path("plan.h5"), "/")
        points, pulses = columns(self.path("scan.h5"), "points"), columns(self.path("scan.h5"), "pulses")
        returned = points["status"] == 0
        col, row = (np.floor(points[name][returned] / 0.1 + 0.5).astype(int) + 50 for name in ("x_true", "y_true"))
        pulse = points["pulse"][returned]
        kept = (col >= 0) & (col <= 100) & (row >= 0) & (row <= 100)
        count, frames = np.zeros((101, 101), int), np.zeros((101, 101), int)
        np.add.at(count, (row[kept], col[kept]), 1)
        of_pulse = np.unique(np.stack([pulse, row, col])[:, kept], axis=1)
        np.add.at(frames, tuple(of_pulse[1:]), 1)
        np.testing.assert_array_equal(layers["count"], count)
        np.testing.assert_array_equal(layers["frames"], frames)
        first = np.full((101, 101), np.inf)
        np.minimum.at(first, (row[kept], col[kept]), pulses["t"][pulse[kept]])
        np.testing.assert_array_equal(layers["first_seen"],
                                      np.where(count > 0, first, np.nan).astype(np.float32))
        self.check_numbers(layers, count, frames, pulse, row, col)

    def check_numbers(self, layers, count, frames, pulse, row, col):
        with h5py.File(self.path("plan.h5")) as file:
            plan = json.loads(file["plan_json"].asstr()[()])
            self.assertEqual((attributes(file)["format_name"], file.attrs["complete"]), ("landfall.plan", 1))
        y, x = np.mgrid[-50:51, -50:51]
        region = x ** 2 + y ** 2 < 50 ** 2
        np.testing.assert_array_equal(layers["in_region"], region)
        self.assertEqual(plan["region"], {"radius_m": 5, "resolution_m": 0.1, "bin_count": int(region.sum())})
        self.assertEqual(plan["coverage"]["uncovered_count"], int((count[region] == 0).sum()))
        self.assertGreater(plan["coverage"]["uncovered_count"], 0)
        np.testing.assert_array_equal(layers["hole_id"] > 0, (count == 0) & region)
        self.assertAlmostEqual(plan["returns_per_bin"]["mean"], count[region].mean(), delta=1e-12)
        self.assertAlmostEqual(plan["frames_per_bin"]["overlap_frac"], (frames[region] > 1).mean(), delta=1e-12)
        inside = np.hypot(row - 50, col - 50) < 50
        per_pulse = np.stack([np.bincount(pulse, minlength=400), np.bincount(pulse, inside, minlength=400)])
        self.assertEqual([plan["time"][kind]["pulse_count"] for kind in
                          ("in_region", "partly_in_region", "off_region", "blanked", "total")],
                         [int((per_pulse[0] == per_pulse[1]).sum()),
                          int(((per_pulse[1] > 0) & (per_pulse[1] < per_pulse[0])).sum()),
                          int((per_pulse[1] == 0).sum()), 0, 400])
        self.assertAlmostEqual(plan["time"]["total"]["time_s"], 0.2)

    def test_it_prints_a_table_or_json(self):
        text = self.plan().stdout
        for words in ("frame in the region", "uncovered:", "Per bin of the region"):
            self.assertIn(words, text)
        self.assertEqual(self.entries(), ["config.json"])
        summary = json.loads(self.plan("--json").stdout)
        self.assertEqual(summary["plan"]["time"]["total"]["pulse_count"], 400)
        self.assertIn("plan", summary["phases"])

    def test_the_proposed_posting_is_that_of_a_scan(self):
        """Against blocks counted one by one, and against the DEM of a traced scan."""
        exact = with_values(SCAN, laser__scan_time_s=0.05, navigation_error={}, noise__range_sigma_m=0, noise__range_bias_m=0)
        plan = ["scan-sim", "-c", self.config(exact), "--plan", "--plan-radius", 5, "--plan-resolution", 0.05]
        self.succeed(*plan, "-o", self.path("plan.h5"))
        layers = columns(self.path("plan.h5"), "/")
        shares = {k: share for k in range(1, 9) if (share := filled_share(layers["count"], layers["in_region"], k))}
        odd = next(k for k in (7, 5, 3) if k in shares and shares[k] > max(shares[finer] for finer in range(1, k)))
        for wanted, k in ((shares[odd], odd), (shares[1] + 1e-9, min(k for k in shares if shares[k] > shares[1])), (0, 1)):
            posting = json.loads(self.succeed(*plan, "--json", "--plan-filled", wanted).stdout)["plan"]["posting"]
            self.assertAlmostEqual(posting["posting_m"], 0.05 * k, delta=1e-12)
            self.assertEqual((posting["wanted_frac"], posting["filled_frac"]), (wanted, shares[k]))
        inside = layers["in_region"] != 0
        self.assertAlmostEqual(posting["returns_per_m2"], layers["count"][inside].sum() / (inside.sum() * 0.05 ** 2), delta=1e-9)
        self.assertAlmostEqual(self.share_of_a_dem(exact, 0.05 * odd), shares[odd], delta=1e-12)
        self.assertIn("no posting fills 100 % of its bins", self.succeed(*plan, "--plan-filled", 1).stdout)
        self.refuse(2, "scan-sim", "--plan", "--plan-filled", 1.5, words=["--plan-filled", "1.5"])

    def share_of_a_dem(self, config, resolution_m):
        """The share of filled bins of a DEM of flat terrain, of those that lie wholly in bins of 5 cm of the plan's region."""
        flat, half_bins = self.path("flat.h5"), int(5 / resolution_m) + 1
        self.succeed("terrain-gen", "-o", flat, "--set", 'grid={"half_width_m":20,"resolution_m":1}')
        self.succeed("scan-sim", "-c", self.config(config), "--terrain", flat, "-o", self.path("scan.h5"))
        self.succeed("regrid", self.path("scan.h5"), "-o", self.path("d.h5"), "--layers", "z_est,count", "--set", f"resolution_m={resolution_m:.10g}",
                     "--set", f"half_width_m={half_bins * resolution_m:.10g}")
        with h5py.File(self.path("d.h5")) as file:
            x, y = np.meshgrid(np.abs(file["x"][()]), np.abs(file["y"][()]))
            edge = resolution_m / 2 - 0.025
            return (file["count"][()] > 0)[np.hypot(x + edge, y + edge) < 5 - 1e-9].mean()

    def test_a_plan_of_too_many_bins_is_refused(self):
        self.refuse(2, "scan-sim", "--plan", "--plan-resolution", 1e-6, words=["2^30"])

    def test_a_lander_below_the_ground_is_refused_by_pulse(self):
        # From 2.49 m at 5 m/s the lander meets the ground after 0.498 s, at any horizontal position.
        for x_m in (0, -4000):
            self.refuse(1, "scan-sim", "--plan", "--set", 'scanner={"type":"flash"}', "--set", "laser.pulse_rate_hz=100",
                        "--set", f"trajectory.position_m=[{x_m},0,2.49]", "--set", "trajectory.velocity_mps=[0,0,-5]",
                        words=["pulse 50:", "below the terrain"])

    def test_the_figure(self):
        self.plan("-o", self.path("plan.h5"))
        script = os.path.join(os.environ["LANDFALL_ROOT"], "python", "commands", "plot_plan.py")
        subprocess.run(["/usr/bin/python3", script, self.path("plan.h5"), "--dpi", "50"], check=True,
                       capture_output=True)
        with open(self.path("plan-figure.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")


if __name__ == "__main__":
    unittest.main()
