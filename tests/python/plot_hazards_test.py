#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_hazards.py on the hazards.h5 of the small chain, changed where a test needs other values."""
import itertools
import json
import os
import shutil
import unittest
from types import SimpleNamespace

import h5py
import numpy as np

import harness
from harness.commands import run_command
from landfall.errors import DataError
from landfall.plot import maps, plot_hazards, reduction
import matplotlib.pyplot as plt
from matplotlib.colors import to_rgb


class HazardsTest(harness.ChainTest):
    def setUp(self):
        super().setUp()
        self.addCleanup(plt.close, "all")

    def made(self, *arguments):
        """hazards.h5 of the small chain with other options."""
        path = self.path("hazards.h5")
        self.succeed("hazard-map", *self.chain.inputs("hazard-map"), "-o", path, *arguments)
        return path

    def draw(self, path=None, z=None, data_only=False):
        """The panels by name."""
        axes = plot_hazards.draw(plot_hazards.Hazards(path or self.chain.hazards), z, data_only).axes
        return dict(zip(("safety", "probability", "slope", "roughness", "roc", "reliability"), axes))

    @staticmethod
    def image(ax, gid=None):
        return next(image for image in ax.images if gid is None or image.get_gid() == gid)

    @staticmethod
    def legend(ax):
        return [text.get_text() for text in ax.get_legend().get_texts()]

    @staticmethod
    def note(ax):
        return next(text.get_text().replace("\n", "; ") for text in ax.texts if text.get_gid() == "note")

    def values(self, name, path=None):
        return harness.columns(path or self.chain.hazards)[name]


class SafetyTest(HazardsTest):
    def test_the_legend_counts_the_places_of_the_region(self):
        outcome, inside = self.values("outcome"), ~np.isnan(self.values("p_touchdown"))
        bins = (np.arange(101) - 50) ** 2
        self.assertEqual(np.count_nonzero(inside), np.count_nonzero(bins + bins[:, None] < 40**2))
        names = ["hazard found", "safe found", "missed hazard", "false alarm", "unknown"]
        counts = [np.count_nonzero(inside & (outcome == value)) for value in range(5)]
        self.assertEqual(sum(counts), np.count_nonzero(inside))
        self.assertGreater(min(counts[:4]), 0)
        self.assertEqual(self.legend(self.draw()["safety"]),
                         [f"{name}: {count:,} ({100 * count / sum(counts):.3g} %)" for name, count in zip(names, counts)])

    def test_each_place_has_the_colour_of_its_outcome_and_none_is_outside_the_region(self):
        outcome, inside = self.values("outcome"), ~np.isnan(self.values("p_touchdown"))
        ax = self.draw()["safety"]
        shown = self.image(ax, "classes").get_array()
        self.assertEqual(shown.shape, (101, 101, 3))  # every bin is seen
        for value, (_, color) in plot_hazards.CLASSES["outcome"].items():
            np.testing.assert_allclose(shown[inside & (outcome == value)] - to_rgb(plot_hazards.JUDGED.get(value, color)), 0, atol=1e-12)
        np.testing.assert_allclose(shown[~inside], 1)
        alarms, missed = (image.get_array() for image in ax.images if image.get_gid() == "marks")
        for marks, value in ((alarms, 3), (missed, 2)):
            np.testing.assert_array_equal(marks[..., 3] == 1, inside & (outcome == value))
            np.testing.assert_allclose(marks[0, 0, :3], to_rgb(plot_hazards.CLASSES["outcome"][value][1]))

    def test_the_relief_shades_it(self):
        z = self.values("z_est", self.chain.dem)
        flat, shaded = (self.image(self.draw(z=heights)["safety"], "classes").get_array() for heights in (np.zeros((101, 101)), z))
        np.testing.assert_allclose(flat, self.image(self.draw()["safety"], "classes").get_array())
        self.assertGreater(np.abs(shaded - flat).max(), 0.3)

    def test_without_truth_it_is_what_the_map_says(self):
        axes = self.draw(self.made("--no-truth"))
        self.assertEqual([text.split(":")[0] for text in self.legend(axes["safety"])], ["hazard", "safe", "unknown"])
        self.assertEqual(len([image for image in axes["safety"].images if image.get_gid() == "marks"]), 0)
        self.assertIn("no truth", axes["safety"].get_title())
        self.assertEqual(len(axes), 4)


class MarksTest(HazardsTest):
    """How marks change from enlarged ones to blocks with one and to shares."""

    def marks(self, spacing):
        _, axes = maps.new_figure((1, 1), (4, 4), "")
        flags = np.zeros((2000, 2000), bool)
        flags[1::spacing, 1::spacing] = True
        grid = plot_hazards.files.MapGrid(np.arange(2000.0), np.arange(2000.0), 1.0)
        how = maps.draw_marks(axes[0, 0], grid, flags, "#ff00ff", fill_few=True)
        size = maps.block_size(axes[0, 0], flags.shape)
        return how, self.image(axes[0, 0], "marks").get_array()[..., 3], flags, size

    def test_few_are_enlarged_more_fill_their_blocks_and_of_many_a_single_one_is_seen(self):
        for spacing, expected in ((500, "single ones enlarged"), (100, "each pixel with one"), (20, "each pixel with one, fuller with more")):
            how, opacity, flags, size = self.marks(spacing)
            self.assertEqual(how, expected)
            self.assertGreater(max(opacity.shape), reduction.WIDE_BLOCKS)
            blocks = reduction.shrink_any(flags, size)
            if how == "single ones enlarged":
                self.assertGreater(np.count_nonzero(opacity == 1), 3 * blocks.sum())
            else:
                np.testing.assert_allclose(opacity, blocks if how == "each pixel with one" else size ** (-2 / 3) * blocks)


class LimitTest(HazardsTest):
    def test_scales_reach_the_largest_values_or_beyond_the_limit(self):
        axes = self.draw()
        for name, limit, text in (("slope", 14, "▸ limit 14 deg"), ("roughness", 0.08, "▸ limit 8 cm")):
            values = self.values(name)
            low, high = self.image(axes[name]).get_clim()
            self.assertEqual(low, 0)
            known = np.sort(np.abs(values[~np.isnan(values)]))
            self.assertAlmostEqual(high, known[int(np.floor(0.995 * (known.size - 1) + 0.5))], places=6)
            self.assertGreater(high, 1.1 * limit)
            self.assertIn(text, self.note(axes[name]))

    def test_limits_are_those_of_the_configuration_and_inside_the_scale(self):
        slope, roughness = (round(1.5 * float(np.nanmax(self.values(name))), 3) for name in ("slope", "roughness"))
        path = self.made("--set", f"limits.slope_deg={slope}", "--set", f"limits.roughness_m={roughness}")
        axes, free = self.draw(path), self.draw(path, data_only=True)
        for name, limit in (("slope", slope), ("roughness", roughness)):
            self.assertAlmostEqual(self.image(axes[name]).get_clim()[1], 1.1 * limit)
            self.assertLess(self.image(free[name]).get_clim()[1], limit)
            bar = next(child for child in axes[name].child_axes)
            mark = next(line for line in bar.lines if line.get_gid() == "limit")
            self.assertAlmostEqual((mark.get_ydata()[0] if np.ndim(mark.get_ydata()) else mark.get_ydata()) / (100 if "(cm)" in bar.get_ylabel() else 1), limit)
            self.assertNotIn("white line", self.note(axes[name]))

    def test_a_line_surrounds_few_places_over_the_limit(self):
        def change(file):
            file["slope"][...] = np.where(np.isnan(file["slope"][()]), np.nan, 13)
            file["slope"][45:52, 60:67] = 15
        ax = self.draw(self.changed(self.chain.hazards, change))["slope"]
        self.assertIn("white line: over the limit", self.note(ax))
        corners = np.concatenate([path.vertices for collection in ax.collections for path in collection.get_paths()])
        x, y = ((np.arange(101) - 50) / 10)[[60, 66]], ((np.arange(101) - 50) / 10)[[45, 51]]
        np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)],
                                   [[x[0] - 0.05, y[0] - 0.05], [x[1] + 0.05, y[1] + 0.05]], atol=1e-9)

    def test_blocks_show_their_worst_place(self):
        values = np.array([[0.1, -3.0], [np.nan, 0.2]])
        self.assertEqual(reduction.shrink_max(values, 2), [[0.2]])
        self.assertEqual(reduction.shrink_min(values, 2), [[-3.0]])
        self.assertTrue(np.isnan(reduction.shrink_max(np.full((2, 2), np.nan), 2)).all())


class SitesTest(HazardsTest):
    def test_numbers_and_places_of_the_sites_and_the_divert_circle(self):
        path = self.made("--set", "z_sigma_m=0.02")
        ax = self.draw(path)["probability"]
        sites = harness.columns(path, "sites")
        self.assertGreater(sites["rank"].size, 1)
        places = [(line.get_xdata()[0], line.get_ydata()[0]) for line in ax.lines if line.get_gid() == "site"]
        self.assertEqual(places, list(zip(sites["x"], sites["y"])))
        self.assertLessEqual({str(rank) for rank in sites["rank"]}, {text.get_text() for text in ax.texts})
        listed = [f"{rank}: ({x:.2f}, {y:.2f}) m, p_touchdown {p:.4f}".replace("-0.00", "0.00") + ("" if true else ", true hazard")
                  for rank, x, y, p, true in zip(*(sites[name] for name in ("rank", "x", "y", "p_touchdown", "true_safe")))]
        self.assertEqual(self.legend(ax), [*listed, "divert radius 3 m"])
        without = self.legend(self.draw()["probability"])
        self.assertRegex(without[0], r"^1: \(-?\d+\.\d\d, -?\d+\.\d\d\) m, cost 0\.\d{4}", "without a 1-sigma there is no probability")
        circle = next(patch for patch in ax.patches if patch.get_gid() == "divert")
        self.assertEqual((circle.center, circle.radius), ((0, 0), 3))

    def test_the_border_of_the_places_within_reach(self):
        """It surrounds the bins that have a cost, in place of the circle."""
        for reach in ([[-1, -2], [2, -1], [0.5, 1.5]], {"height_m": 20, "descent_mps": 4, "tilt_deg": 2, "thrust_accel_mps2": 3, "gravity_mps2": 1.3}):
            path = self.made("--set", f"sites.reach={json.dumps(reach)}", "-O")
            ax = self.draw(path)["probability"]
            self.assertEqual(self.legend(ax)[-1], "border of the places within reach")
            self.assertFalse([patch for patch in ax.patches if patch.get_gid() == "divert"])
            known = np.argwhere(~np.isnan(self.values("cost", path)))
            corners = np.concatenate([line.vertices for collection in ax.collections for line in collection.get_paths()])
            x = (np.arange(101) - 50) / 10
            for column, axis in ((1, 0), (0, 1)):
                self.assertAlmostEqual(corners[:, axis].min(), x[known[:, column].min()] - 0.05)
                self.assertAlmostEqual(corners[:, axis].max(), x[known[:, column].max()] + 0.05)

    def test_the_layer_is_p_touchdown_or_p_safe(self):
        for name, path in (("p_touchdown", self.chain.hazards), ("p_safe", self.made("--set", "z_sigma_m=0.02"))):
            ax = self.draw(path)["probability"]
            self.assertEqual(self.image(ax).get_clim(), (0, 1))
            np.testing.assert_array_equal(self.image(ax).get_array().filled(np.nan), self.values(name, path))
            self.assertEqual(ax.child_axes[0].get_ylabel(), name)

    def test_a_site_that_is_a_hazard_and_many_sites(self):
        def change(file):
            file["sites/true_safe"][0] = 0
        self.assertTrue(self.legend(self.draw(self.changed(self.chain.hazards, change))["probability"])[0].endswith(", true hazard"))
        ax = self.draw(self.made("--set", "sites.count=9", "--set", "sites.separation_m=0.5"))["probability"]
        self.assertEqual(self.legend(ax)[6], "and 3 more sites")

    def test_no_site(self):
        path = self.made("--set", "limits.slope_deg=0.001")
        self.assertEqual(self.legend(self.draw(path)["probability"]), ["no landing site", "divert radius 3 m"])


class ScoreTest(HazardsTest):
    def score(self, path):
        with h5py.File(path) as file:
            return json.loads(file["score_json"][()])

    def test_the_roc_curve_in_percent(self):
        ax, score = self.draw()["roc"], self.score(self.chain.hazards)
        curve = next(line for line in ax.lines if line.get_gid() == "roc")
        np.testing.assert_allclose(curve.get_xdata(), 100 * np.array(score["roc"]["false_alarm_frac"]))
        np.testing.assert_allclose(curve.get_ydata(), 100 * np.array(score["roc"]["missed_hazard_frac"]))
        limit = next(line for line in ax.lines if line.get_gid() == "limit")
        np.testing.assert_allclose([limit.get_xdata(), limit.get_ydata()],
                                   [[100 * score["false_alarm_frac"]], [100 * score["missed_hazard_frac"]]])
        self.assertIn("limit 8 cm", self.legend(ax)[1])
        for axis, values in ((ax.get_xlim(), curve.get_xdata()), (ax.get_ylim(), curve.get_ydata())):
            self.assertTrue(axis[0] < values.min() and values.max() < axis[1])

    def test_reliability_and_brier_score(self):
        path = self.made("--set", "z_sigma_m=0.02")
        ax, score = self.draw(path)["reliability"], self.score(path)
        line = next(line for line in ax.lines if line.get_gid() == "reliability")
        expected = score["reliability"]["safe_frac"]
        np.testing.assert_allclose(line.get_ydata(), [share for share in expected if share is not None])
        self.assertIn(f"{score['brier']:.3g}", ax.get_title())
        self.assertIn(f"{score['reliability']['count'][-1]:,}", [text.get_text() for text in ax.texts])
        self.assertIn("no p_safe", self.draw()["reliability"].texts[0].get_text())

    def test_labels_do_not_overlap(self):
        """Nor where the first points are close, as in Example 2, or all are at one height."""
        low = np.arange(10) / 10
        for share, expected in (([0, 0.01, 0.03, 0.11, 0.23, 0.33, 0.4, 0.71, 0.79, 1], 9), (0 * low, 5), (0 * low + 1, 10), (low + 0.05, 10)):
            score = {"p_low": low, "p_high": low + 0.1, "count": 10 * [1234567], "safe_frac": share}
            figure, axes = maps.new_figure((3, 2), (14, 20.5), "")
            plot_hazards.draw_reliability(axes[2, 1], SimpleNamespace(score={f"reliability/{name}": list(values) for name, values in score.items()}))
            figure.canvas.draw()
            boxes = [text.get_window_extent() for text in axes[2, 1].texts]
            self.assertFalse([pair for pair in itertools.combinations(boxes, 2) if pair[0].overlaps(pair[1])])
            self.assertEqual(len(boxes), expected)

    def test_a_truth_without_hazards(self):
        path = self.made("--set", "limits.slope_deg=80", "--set", "limits.roughness_m=5")
        self.assertIsNone(self.score(path)["missed_hazard_frac"])
        self.assertIn("no hazard", self.draw(path)["roc"].texts[0].get_text())


class CommandTest(HazardsTest):
    def run_script(self, *arguments):
        return run_command("plot_hazards", *arguments, cwd=self.folder)

    def test_draws_beside_the_map(self):
        shutil.copy(self.chain.hazards, self.path("hazards.h5"))
        done = self.run_script("hazards.h5", "--dem", self.chain.dem, "--dpi", "60")
        self.assertEqual((done.returncode, done.stderr, done.stdout), (0, "", "hazards-figure.png\n"))
        self.assertEqual(plt.imread(self.path("hazards-figure.png")).shape[1], 840)
        done = self.run_script("hazards.h5", "--dpi", "60")
        self.assertEqual(done.returncode, 2)
        self.assertIn("hazards-figure.png exists; use -O", done.stderr)

    def test_files_that_are_refused(self):
        def narrow(file):
            for name in ("x", "y"):
                file[name][...] = 2 * file[name][()]
        wide = self.changed(self.chain.dem, narrow, "wide.h5")
        broken = self.changed(self.chain.hazards, lambda file: harness.set_text(file, "provenance/config_json", "{"))
        for arguments, message in (((self.chain.dem,), "dem.h5: format_name is 'landfall.dem', expected 'landfall.hazards'"),
                                   (("none.h5",), "none.h5: no such file"),
                                   ((self.chain.hazards, "--dem", wide), "wide.h5: its bins are not those of the hazard map"),
                                   ((self.chain.hazards, "--dem", self.chain.eval), "expected 'landfall.dem'"),
                                   ((broken,), "changed.h5: /provenance/config_json is not JSON")):
            done = self.run_script(*arguments, "-o", "a.png")
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1), done.stderr)
            self.assertIn(message, done.stderr)
            self.assertFalse(os.path.exists(self.path("a.png")))
        self.assertEqual(self.run_script(self.chain.hazards, "-o", "a.jpg").returncode, 2)

    def test_a_layer_that_is_missing(self):
        def remove(file):
            del file["slope"]
        with self.assertRaisesRegex(DataError, "needs the layer slope"):
            plot_hazards.Hazards(self.changed(self.chain.hazards, remove))


if __name__ == "__main__":
    unittest.main()
