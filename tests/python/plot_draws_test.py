#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_draws.py on draws over the small chain."""
import json
import os
import shutil
import unittest

import h5py
import numpy as np

import harness
from harness.commands import run_command
from landfall import dictionary
from landfall.plot import plot_draws, scales
import matplotlib.pyplot as plt

DRAWS_CONFIG = {"draws": 6, "metrics": "full", "sigma": True, "regrid": {**harness.REGRID, "uncertainty": {"navigation_sigma": {}}},
            "eval": harness.with_values(harness.EVAL, limits__relative_elevation_m=0.12, limits__invalid_frac=0.04),
            "vary": {"scan.noise.range_sigma_m": {"type": "uniform", "low": 0.005, "high": 0.08}}}


class DrawsTest(harness.ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = cls.chain.folder
        scan = os.path.join(folder, "traced.h5")
        cls.draws = os.path.join(folder, "campaign.h5")
        with open(os.path.join(folder, "mc.json"), "w", encoding="utf-8") as file:
            json.dump(DRAWS_CONFIG, file)
        for arguments in (["scan-sim", *cls.chain.inputs("scan-sim"), "--keep-misses", "-o", scan],
                          ["monte-carlo", scan, "--terrain", cls.chain.terrain, "-c", file.name, "-o", cls.draws]):
            done = harness.run(*arguments)
            if done.returncode != 0:
                raise AssertionError(done.stderr)

    def setUp(self):
        super().setUp()
        self.addCleanup(plt.close, "all")

    def values(self, name):
        with h5py.File(self.draws) as file:
            return file[name][()]

    @staticmethod
    def panels(path):
        """The panels by their title, without colour bars."""
        return {ax.get_title(): ax for ax in plot_draws.draw(plot_draws.Draws(path)).axes if ax.get_title()}

    def test_probabilities_over_the_ground(self):
        p = self.values("p_fail_rel_z")
        self.assertTrue(0 < np.nanmax(p) and np.nanmin(p) == 0 and np.isnan(p).any(), "the case must have all three")
        image = next(image for image in self.panels(self.draws)["footprint fails: relative z"].images if image.get_gid() == "shaded_probability").get_array()
        self.assertEqual(image.shape[:2], p.shape)
        np.testing.assert_allclose(image[np.isnan(p)], 200 / 255)
        # The ground has one hue in any light; failures have those of the colour map.
        ground = image[p == 0] / image[p == 0][:, :1]
        unclipped = (image[p == 0] < 1).all(axis=1) & (image[p == 0] > 0.05).all(axis=1)
        np.testing.assert_allclose(ground[unclipped], np.broadcast_to(np.array([0xf4, 0xf1, 0xea]) / 0xf4, ground[unclipped].shape), atol=1e-6)
        self.assertGreater(np.abs(image[p > 0] / image[p > 0].max(axis=1, keepdims=True) - np.array([0xf4, 0xf1, 0xea]) / 0xf4).max(axis=1).min(), 0.05)

    def test_slopes_hardly_darken_probabilities(self):
        """So that a colour on the shaded side of a rock can be compared with the colour bar."""
        p = self.values("p_fail_rel_z")
        image = next(image for image in self.panels(self.draws)["footprint fails: relative z"].images if image.get_gid() == "shaded_probability").get_array()
        colors = plot_draws.scales.color_map("magnitude")(p[p > 0] / np.nanmax(p))[:, :3]
        shares = (image[p > 0] / colors)[colors > 0.02]
        self.assertGreaterEqual(shares.min(), 0.85 - 1e-6)
        self.assertLessEqual(shares.max(), 1 + 1e-6)

    def test_equal_values_do_not_fill_the_axes(self):
        ax = self.panels(self.draws)["hole_distance"]
        value, limit = (self.values(f"draws/requirements.hole_distance.{key}") for key in ("value", "limit"))
        self.assertEqual((np.ptp(value), limit[0]), (0, 1), "the case must have one value")
        ends = [value[0] - 0.5, value[0] + 0.5, *([1] if 1 <= scales.LIMIT_NEAR * value[0] else [])]
        self.assertEqual(ax.get_xlim(), (min(ends) - 1, max(ends) + 1))

    def test_distributions_have_all_draws_and_the_limit(self):
        panels = self.panels(self.draws)
        for name, requirement in dictionary.requirements().items():
            ax = panels[name]
            heights = [bar.get_height() for bars in ax.containers for bar in bars]
            passed = self.values(f"draws/requirements.{name}.pass")
            self.assertEqual([sum(bar.get_height() for bar in bars) for bars in ax.containers], [np.sum(passed == 1), np.sum(passed == 0)], name)
            self.assertEqual(sum(heights), 6)
            self.check_limit(ax, requirement)
            note = next(text.get_text() for text in ax.texts if text.get_gid() == "note")
            self.assertRegex(note, f"{np.sum(passed == 1)} of 6 pass: " + ("0.*, at least 0" if np.any(passed == 1) else r"probability at most 0.3903 \(W"), name)

    def check_limit(self, ax, requirement):
        """A requirement on lengths is shown by the largest one in cm, not by a count; a limit far away is named and not drawn."""
        is_length, factor = requirement.worst_limit.endswith("_m"), requirement.factor
        values = 100 * np.max([self.values(f"draws/{metric}") for metric in requirement.worst], axis=0) if is_length else \
            factor * self.values(f"draws/requirements.{requirement.name}.value")
        limit = 100 * plot_draws.Draws(self.draws).config.get(f"eval/limits/{requirement.worst_limit}") if is_length else \
            factor * self.values(f"draws/requirements.{requirement.name}.limit")[0]
        self.assertEqual("(cm)" in ax.get_xlabel(), is_length)
        low, high = ax.get_xlim()
        self.assertTrue(low < values.min() and values.max() < high, requirement.name)
        drawn = [line.get_xdata()[0] for line in ax.lines if line.get_gid() == "limit"]
        end = limit + (0.5 if requirement.is_whole and not is_length else 0)  # beyond the bar of values that are equal to it
        self.assertEqual(drawn, [end] if limit <= scales.LIMIT_NEAR * values.max() else [])
        text = next(text.get_text() for text in ax.get_legend().get_texts() if text.get_text().startswith("limit"))
        unit = " %" if "(%)" in ax.get_xlabel() else " cm" if is_length else ""
        self.assertRegex(text, f"limit: at (most|least) {limit:g}{unit}" + ("$" if drawn else r" \(beyond this diagram"))

    def test_observed_against_predicted(self):
        ax = self.panels(self.draws)["spread of the map's error: observed against predicted"]
        sigma, std = self.values("z_sigma_abs"), self.values("e_map_std")
        known = (sigma > 0) & (std > 0)
        note = next(text.get_text() for text in ax.texts if text.get_gid() == "note")
        self.assertIn(f"{np.median(std[known] / sigma[known]):.3f}", note)
        self.assertIn(f"{np.count_nonzero(known):,} bins", note)
        counts = next(mesh for mesh in ax.collections if mesh.get_gid() == "bins").get_array()
        self.assertGreater(counts.sum(), 0.99 * np.count_nonzero(known))

    def test_files_without_prediction_or_maps(self):
        def remove(names):
            def change(file):
                for name in names:
                    del file[name]
            return change
        panels = self.panels(self.changed(self.draws, remove(["z_sigma_abs", "e_map_std_over_sigma"])))
        self.assertIn("mean of e_z", panels)
        self.assertNotIn("spread of the map's error: observed against predicted", panels)
        layers = [*(name for name in plot_draws.LAYERS if name not in ("p_missed_hazard", "p_judged_safe")), "count_mean", "x", "y"]
        self.assertEqual(list(self.panels(self.changed(self.draws, remove(layers)))), list(dictionary.requirements()))
        self.assertEqual(list(self.panels(self.changed(self.draws, remove(["z_true_map"])))), list(self.panels(self.draws)))  # of terrains that vary

    def test_hazards(self):
        """Each chosen place, by its truth; one of six is made a hazard, and one draw has none."""
        config = {**DRAWS_CONFIG, "sigma": False, "hazard": harness.HAZARD}
        done = harness.run("monte-carlo", os.path.join(self.chain.folder, "traced.h5"), "--terrain", self.chain.terrain,
                           "-c", self.config(config, "mc.json"), "-o", self.path("hazards.h5"))
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(self.path("hazards.h5"), "r+") as file:
            x, y, safe = (file[f"draws/site.{name}"] for name in ("x_m", "y_m", "true_safe"))
            safe[...] = [1, 1, 0, 1, 1, np.nan]
            x[5] = y[5] = np.nan
            sites = np.stack((x[()], y[()]), axis=-1)
        panels = self.panels(self.path("hazards.h5"))
        for title in ("missed hazard", "judged safe"):
            self.assertTrue(any(image.get_gid() == "shaded_probability" for image in panels[title].images), title)
        points = {drawn.get_label(): np.asarray(drawn.get_offsets()) for drawn in panels["chosen place of each draw"].collections
                  if str(drawn.get_label()).startswith("truly")}
        self.assertEqual(set(points), {"truly safe: 4", "truly a hazard: 1"})
        np.testing.assert_array_equal(points["truly safe: 4"], sites[[0, 1, 3, 4]])
        np.testing.assert_array_equal(points["truly a hazard: 1"], sites[[2]])

    def test_bars_are_seen_beside_the_limit(self):
        for values, limit, is_whole in (([1, 1.0001, 1.001], 4, False), ([3000, 3007], 0, True), ([2, 2], 2, False), ([0, 0], 0, True)):
            edges = plot_draws.edges_of(np.array(values), limit, is_whole)
            self.assertEqual(np.histogram(values, edges)[0].sum(), len(values))
            reach = max(edges[-1], limit) - min(edges[0], limit)
            self.assertGreaterEqual(np.diff(edges).min(), 0.009 * reach, (values, limit))

    def test_the_command(self):
        shutil.copy(self.draws, self.path("draws.h5"))
        run = lambda *arguments: run_command("plot_draws", *arguments, cwd=self.folder)
        done = run("draws.h5", "--dpi", "50")
        self.assertEqual((done.returncode, done.stderr, done.stdout), (0, "", "draws-figure.png\n"))
        self.assertEqual(plt.imread(self.path("draws-figure.png")).shape[1], 950)
        done = run("draws.h5")
        self.assertEqual(done.returncode, 2)
        self.assertIn("draws-figure.png exists; use -O", done.stderr)
        done = run(self.chain.dem, "-o", "a.png")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("dem.h5: format_name is 'landfall.dem', expected 'landfall.draws'", done.stderr)


if __name__ == "__main__":
    unittest.main()
