#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_landing.py, and of plot_draws.py, on draws that trace and land."""
import json
import os
import unittest

import numpy as np

import harness
from landfall.errors import DataError
from landfall.plot import plot_draws, plot_landing
import matplotlib.pyplot as plt

TERRAIN = {**harness.TERRAIN, "base": {"type": "plane", "elevation_m": 0}}
DRAWS_CONFIG = {"draws": 12, "metrics": "verdict", "scan": {**harness.SCAN, "navigation_error": {}}, "regrid": harness.REGRID, "eval": harness.EVAL, "terrain": TERRAIN,
            "hazard": {**harness.HAZARD, "touchdown_sigma_m": 0.8}, "landing": {"drift_time_s": 2000},
            "vary": {"terrain.features.0.x_m": {"type": "uniform", "low": -3, "high": 3}, "scan.navigation_error.velocity_mps.1": {"type": "list", "values": [0] * 6 + [0.01] * 3 + [0.0005] * 3}}}


class LandingTest(harness.ToolTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.addClassCleanup(plt.close, "all")

    def draws(self, name="draws.h5", **changes):
        self.succeed("monte-carlo", "-c", self.config({**DRAWS_CONFIG, **changes}), "-O", "-o", self.path(name))
        return self.path(name)

    @staticmethod
    def points(ax, gid):
        found = [item for item in ax.collections if item.get_gid() == gid]
        return len(found[0].get_offsets()) if found else 0

    def test_touchdowns_and_margins(self):
        """Every landing is a mark of its kind; the curves of the margins end at 1."""
        draws = plot_landing.Draws(self.draws())
        axes = plot_landing.draw(draws).axes
        for ax, arm in zip(axes, plot_landing.ARMS):
            safe, ground = draws.columns[f"{arm}.safe"] == 1, ~np.isnan(draws.columns[f"{arm}.slope_deg"])
            self.assertTrue((~ground).any() and ground.any(), arm)
            for gid, expected in (("safe", safe), ("not-safe", ~safe & ground), ("over-no-terrain", ~ground)):
                self.assertEqual(self.points(ax, f"{arm}-{gid}"), np.count_nonzero(expected), gid)
        curves = {line.get_gid(): line for ax in axes for line in ax.lines if line.get_gid() in plot_landing.ARMS}
        self.assertEqual(set(curves), set(plot_landing.ARMS))
        for line in curves.values():
            self.assertEqual(line.get_ydata()[-1], 1)
        landing = draws.verdict["landing"]
        text = next(item for ax in axes for item in ax.texts if item.get_gid() == "pairs").get_text()
        self.assertIn(f"only with the lidar: {landing['only_lidar']}", text)

    def test_the_border_of_the_places_within_reach(self):
        """The line is that of the configuration, and on it the distance to one of both centres is the radius."""
        polygon = [[-1, -2], [2, -1], [0.5, 1.5]]
        divert = {"height_m": 20, "descent_mps": 4, "velocity_mps": [0.3, -0.1], "position_m": [-1.5, 0.5], "tilt_deg": 2, "thrust_accel_mps2": 3,
                  "gravity_mps2": 1.3}
        for reach in (polygon, divert):
            hazard = {**DRAWS_CONFIG["hazard"], "sites": {**DRAWS_CONFIG["hazard"]["sites"], "reach": reach}}
            draws = plot_landing.Draws(self.draws(draws=2, hazard=hazard, vary={}))
            ax = plot_landing.draw(draws).axes[0]
            line = np.column_stack(next(line for line in ax.lines if line.get_gid() == "reach").get_data())
            self.assertEqual(line[0].tolist(), line[-1].tolist())
            if reach is polygon:
                self.assertEqual(line[:-1].tolist(), polygon)
                continue
            self.succeed("terrain-gen", "-O", "-o", self.path("t.h5"), "-c", self.config(TERRAIN, "t.json"))
            self.succeed("hazard-map", "-O", self.path("t.h5"), "-c", self.config({**hazard, "region_radius_m": 50}, "h.json"), "-o", self.path("h.h5"))
            layers = harness.columns(self.path("h.h5"))
            columns, rows = np.nonzero(~np.isnan(layers["cost"]))[::-1]
            s = layers["x"][1] - layers["x"][0]
            for values, axis in ((layers["x"][columns], 0), (layers["y"][rows], 1)):
                self.assertTrue(0 <= values.min() - line[:, axis].min() < s and 0 <= line[:, axis].max() - values.max() < s, (values, line))

    def test_files(self):
        """With and without maps; the figure of the draws too, although its terrain varies."""
        for layers in (True, False):
            path = self.draws(layers=layers)
            for module, name in ((plot_landing, "landing"), (plot_draws, "draws")):
                output = self.path(f"{name}-{layers}.png")
                module.main([path, "-o", output])
                self.assertGreater(os.path.getsize(output), 10000)

    def test_without_landings(self):
        path = self.draws(landing=None)
        with self.assertRaisesRegex(DataError, "landing"):
            plot_landing.main([path, "-o", self.path("x.png")])
        self.assertFalse(os.path.exists(self.path("x.png")))

    def test_report(self):
        """The page has both rates, and its data the touchdowns and the commands of the chain."""
        self.succeed("monte-carlo", "-c", self.config(DRAWS_CONFIG), "-o", self.path("draws.h5"), "--report", self.path("report.html"), "--verdict", self.path("v.json"))
        page = harness.read_bytes(self.path("report.html")).decode()
        verdict = json.loads(harness.read_bytes(self.path("v.json")))["landing"]
        for requirement, rate in (("landing_safe", verdict["safe"]), ("blind_safe", verdict["blind"])):
            row = page.split(f'data-requirement="{requirement}"')[1].split("</tr>")[0]
            self.assertIn(f"{rate['passed']} of {rate['draws']}", row)
        self.assertIn('"traces":true', page.replace(" ", ""))


if __name__ == "__main__":
    unittest.main()
