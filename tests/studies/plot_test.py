#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Confidence intervals against closed forms, and plot_study.py on a table that the tests make."""
import csv
import dataclasses
import json
import math
import os
import tempfile
import unittest

import h5py
import numpy as np

from harness.commands import run_command
from landfall.study import crossing, figures, table, verdicts
from landfall.study.results import Table, flatten, write_h5


class Wilson(unittest.TestCase):
    def test_known_values(self):
        """From Newcombe, Statistics in Medicine 17 (1998) 857-872, table I, method 3."""
        for passed, count, low, high in ((81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0000, 0.1611),
                                         (1, 29, 0.0061, 0.1718)):
            np.testing.assert_allclose(table.wilson(passed, count), (low, high), atol=5e-5)

    def test_bounds_solve_the_equation(self):
        """At the bounds, |rate - p| = z sqrt(p (1 - p) / n)."""
        for passed, count in ((1, 3), (7, 9), (50, 100)):
            for bound in table.wilson(passed, count):
                self.assertAlmostEqual(abs(passed / count - bound),
                                       1.959963984540054 * math.sqrt(bound * (1 - bound) / count), 12)

    def test_extremes(self):
        self.assertEqual(table.wilson(0, 0), (0, 1))
        z2 = 1.959963984540054 ** 2
        for count in (1, 5, 1000):
            low, high = table.wilson(0, count)
            self.assertEqual(low, 0)
            self.assertAlmostEqual(high, z2 / (count + z2), 12)
            low, high = table.wilson(count, count)
            self.assertEqual(high, 1)
            self.assertAlmostEqual(low, count / (count + z2), 12)


class Bootstrap(unittest.TestCase):
    def test_median_of_odd_numbers(self):
        """The median of a resample is at most the i-th of n values with the probability P(Bin(n, i/n) > n/2)."""
        for count in (11, 25, 51):
            values = np.arange(1, count + 1, dtype=float)
            at_most = [sum(math.comb(count, k) * (i / count) ** k * (1 - i / count) ** (count - k)
                           for k in range(count // 2 + 1, count + 1)) for i in range(1, count + 1)]
            # With 4,000 resamples, 4 standard errors of a probability of 0.025 are 0.01.
            low, high = table.bootstrap(np.random.RandomState(3).permutation(values), 0.5)
            for bound, probability in ((low, 0.025), (high, 0.975)):
                self.assertGreater(at_most[round(bound) - 1], probability - 0.01)
                self.assertLess(at_most[round(bound) - 2], probability + 0.01)

    def test_extremes(self):
        self.assertTrue(all(map(math.isnan, table.bootstrap([3], 0.5))))
        self.assertEqual(table.bootstrap([3, 3, 3], 0.9), (3, 3))
        low, high = table.bootstrap([1, 2], 1)  # the larger of two draws is 2 with probability 3/4
        self.assertEqual((low, high), (1, 2))

    def test_it_is_reproducible(self):
        values = np.random.RandomState(1).normal(size=30)
        self.assertEqual(table.bootstrap(values, 0.95), table.bootstrap(values, 0.95))

    def test_coverage_of_the_true_median(self):
        """300 samples of 25 normal numbers: about 95 % of the intervals contain 0 (these order statistics cover exactly 0.957)."""
        random = np.random.RandomState(7)
        covered = sum(low <= 0 <= high for low, high in
                   (table.bootstrap(random.normal(size=25), 0.5, seed) for seed in range(300)))
        self.assertTrue(0.90 <= covered / 300 <= 0.99, covered)


AXES = [{"name": "sigma_m", "label": "noise", "unit": "m", "log": False, "numeric": True, "role": "axis"},
        {"name": "loss_frac", "label": "losses", "unit": "1", "log": False, "numeric": True, "role": "axis"},
        {"name": "kind", "label": "kind", "unit": "", "log": False, "numeric": False, "role": "axis"},
        {"name": "lines", "label": "lines", "unit": "", "log": False, "numeric": True, "role": "axis"},
        {"name": "repeat", "label": "repeat", "unit": "", "log": False, "numeric": True, "role": "repeat"}]


def metrics(sigma, loss, repeat, judged=True):
    """Metrics that are easy to check: the error in z grows with sigma, and by 1 mm with each repeat."""
    largest = 2 * sigma + 0.001 * repeat + loss
    requirement = {name: {"value": 0, "limit": 0, "pass": True if judged else None} for name in table.REQUIREMENTS}
    requirement["relative_elevation"] = {"value": int(1e5 * max(0, largest - 0.05)), "limit": 0,
                                         "pass": (largest <= 0.05) if judged else None}
    return {"pass": largest <= 0.05 if judged else None, "accuracy": {"relative": {"z": {"max_m": largest}}},
            "coverage": {"invalid_frac": loss}, "requirements": requirement}


class PlotTest(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.addCleanup(figures.plt.close, "all")

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def table(self, names, judged=True, repeats=(1, 2, 3), limits=None, **plot):
        """Writes results.h5 with these axes and returns its path. `lines` varies with sigma_m, as in a zip."""
        values = {"sigma_m": (0.0, 0.01, 0.02), "loss_frac": (0, 0.5), "kind": ("FSM", "flash"), "repeat": repeats}
        lines = {0.0: 7, 0.01: 9, 0.02: 8}
        axes = [axis for axis in AXES if axis["name"] in names]
        points = [[]]
        for axis in axes:
            points = [[*point, value] for point in points
                      for value in (values[axis["name"]] if axis["name"] in values else [lines[point[0]]])]
        rows = []
        for number, point in enumerate(points):
            at = dict(zip([axis["name"] for axis in axes], point))
            tree = metrics(at.get("sigma_m", 0.01), at.get("loss_frac", 0), at.get("repeat", 1), judged)
            rows.append((number, point, flatten(tree)))
        cases = {"title": "T", "plot": plot, "axes": axes, "cases": [],
                 "limits": {"relative_elevation_m": 0.05} if limits is None else limits}
        write_h5(Table(cases, rows), self.path("results.h5"), "test")
        return self.path("results.h5")

    def plot(self, *arguments, code=0):
        result = run_command("plot_study", *arguments, "--dpi", "50")
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def results(self, *names, **options):
        with h5py.File(self.table(names, **options)) as file:
            return table.Results(file)


class Plots(PlotTest):
    def test_files_and_numbers(self):
        self.plot(self.table(("sigma_m", "loss_frac", "repeat")), "-o", self.path("f"), "--metrics",
                  "accuracy.relative.z.max_m,coverage.invalid_frac")
        self.assertEqual(sorted(os.listdir(self.path("f"))),
                         ["accuracy.relative.z.max_m-map.png", "accuracy.relative.z.max_m.png", "coverage.invalid_frac-map.png",
                          "coverage.invalid_frac.png", "overview.png", "pass_rates.csv", "percentiles.csv", "requirements.png",
                          "shares.png"])
        with open(self.path("f", "pass_rates.csv"), encoding="utf-8") as file:
            rows = {(row["sigma_m"], row["loss_frac"], row["requirement"]): row for row in csv.DictReader(file)}
        self.assertEqual(len(rows), 6 * 7)
        for key, passed in ((("0.02", "0.0", "relative_elevation"), "3"), (("0.02", "0.5", "all"), "0"), (("0.02", "0.5", "coverage"), "3")):
            self.assertEqual((rows[key]["passed"], rows[key]["count"]), (passed, "3"))
        with open(self.path("f", "percentiles.csv"), encoding="utf-8") as file:
            first = next(csv.DictReader(file))
        self.assertEqual((first["metric"], first["count"], first["percentile"]), ("accuracy.relative.z.max_m", "3", "50.0"))
        self.assertAlmostEqual(float(first["value"]), 0.002)
        self.assertAlmostEqual(float(first["low_95"]), 0.001)
        self.assertAlmostEqual(float(first["high_95"]), 0.003)

    def test_the_median_and_the_requirement_are_drawn(self):
        results = self.results("sigma_m", "repeat")
        figure = figures.metric_figure(results, "accuracy.relative.z.max_m", results.axes[0], 0.5)
        (axes,) = figure.axes
        line = axes.get_lines()[0]
        np.testing.assert_allclose(line.get_xdata(), [0, 0.01, 0.02])
        np.testing.assert_allclose(line.get_ydata(), [0.2, 2.2, 4.2])  # cm
        dashed = [entry for entry in axes.get_lines() if entry.get_linestyle() == "--"]
        np.testing.assert_allclose(dashed[0].get_ydata(), [5, 5])
        self.assertEqual(dashed[0].get_label(), "required: at most 5 cm")
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("noise [m]", "relative elevation error, largest [cm]"))

    def test_a_limit_that_differs_between_cases_is_not_drawn(self):
        results = self.results("sigma_m", limits={})
        figure = figures.metric_figure(results, "accuracy.relative.z.max_m", results.axes[0], 0.5)
        self.assertFalse([line for line in figure.axes[0].get_lines() if line.get_linestyle() == "--"])

    def test_fractions_of_the_limits(self):
        results = self.results("sigma_m", "repeat")
        (point,) = [point for point in results.points if point.values == (0.02,)]
        self.assertAlmostEqual(results.share_of_limit(point, "relative_elevation", 0.5), 0.042 / 0.05)
        self.assertAlmostEqual(results.share_of_limit(point, "relative_elevation", 1), 0.043 / 0.05)
        for unknown in ("absolute_horizontal", "coverage"):  # the first has no metric, the second a limit of 0
            self.assertTrue(math.isnan(results.share_of_limit(point, unknown, 0.5)))
        texts = [text.get_text() for text in verdicts.shares_figure(results, 0.5).axes[0].texts]
        self.assertIn("84 %", texts)

    def test_metrics_by_the_share_of_their_limits(self):
        """0.043 m of 0.05 m, half of the bins where none is allowed, what has no limit, and last what never changes."""
        results = self.results("sigma_m", "loss_frac", "repeat")
        largest, count = "accuracy.relative.z.max_m", "requirements.relative_elevation.value"
        results.columns["statistics.z.mean_m"] = list(range(len(results.columns["case"])))
        results.columns["coverage.largest_hole_bins"] = [9] * len(results.columns["case"])
        self.assertAlmostEqual(results.share_used(largest), 0.543 / 0.05)
        self.assertAlmostEqual(results.share_used(count), 0.543 / 0.05)  # that of its requirement: its own limit is 0
        self.assertTrue(math.isnan(results.share_used("statistics.z.mean_m")))
        for values in ([0.001, 0.02, 0.01], [0.001, -0.02, float("nan")]):
            results.columns["accuracy.relative.x.max_m"] = (values * 9)[:len(results.columns["case"])]
            results.limits["relative_horizontal_m"] = 0.1
            self.assertAlmostEqual(results.share_used("accuracy.relative.x.max_m"), 0.2)
            self.assertEqual(results.by_use(["coverage.largest_hole_bins", "statistics.z.mean_m", "accuracy.relative.x.max_m", largest]),
                             [largest, "accuracy.relative.x.max_m", "statistics.z.mean_m", "coverage.largest_hole_bins"])
        names = ["coverage.invalid_frac", largest]
        self.table(("sigma_m", "repeat"), metrics=names)
        for arguments, order in (([], names[::-1]), (["--metrics", ",".join(names)], names)):
            self.plot(self.path("results.h5"), "-O", "-o", self.path("f"), *arguments)
            with open(self.path("f", "percentiles.csv"), encoding="utf-8") as file:
                self.assertEqual(list(dict.fromkeys(row["metric"] for row in csv.DictReader(file))), order)

    def test_the_sign_of_errors_is_stated(self):
        results = self.results("sigma_m", "loss_frac", "repeat")
        errors, shares = "accuracy.relative.z.max_m", "coverage.invalid_frac"
        sign = "error = true - estimated, absolute value"
        for metric, text in ((errors, sign), (shares, "")):
            figure = figures.metric_figure(results, metric, results.axes[0], 0.5)
            self.assertEqual(figure.axes[0].get_title().split("\n")[2:], [text] if text else [])
            figure = figures.map_figure(results, metric, (results.axes[0], results.axes[1]), 0.5)
            self.assertEqual(figure.axes[1].get_ylabel().split("\n")[1:], [text] if text else [])
        self.assertIn(sign, figures.overview_figure(results, [errors, shares], results.axes[0], 0.5)._suptitle.get_text())
        self.assertEqual(table.error_sign(["statistics.z.mean_m", errors]), "error = true - estimated")

    def test_a_map_has_the_limit_on_its_scale(self):
        """At most 43 mm are measured; a requirement far above is only named."""
        for limit, drawn in ((0.05, True), (0.01, True), (1.4, False)):
            results = self.results("sigma_m", "repeat", limits={"relative_elevation_m": limit})
            results.axes.append(dataclasses.replace(results.axes[0], name="b", values=(0,)))
            results.points = [dataclasses.replace(point, values=(*point.values, 0)) for point in results.points]
            axes, bar = figures.map_figure(results, "accuracy.relative.z.max_m", tuple(results.axes), 0.5).axes
            (image,) = axes.get_images()
            low, high = sorted([0.2, 4.2, 100 * limit])[::2] if drawn else (0.2, 4.2)  # cm
            np.testing.assert_allclose([image.norm.vmin, image.norm.vmax], [low, high])
            self.assertEqual([line.get_ydata()[0] for line in bar.get_lines()], [100 * limit] if drawn else [])

    def test_a_map_of_equal_values_has_no_scale(self):
        """It would show numbers on both sides of the only one. Frames of passing cells have no colour that means failed elsewhere."""
        results = self.results("sigma_m", "loss_frac", "repeat")
        results.columns["coverage.invalid_frac"] = [0.0] * len(results.columns["case"])
        figure = figures.map_figure(results, "coverage.invalid_frac", tuple(results.axes), 0.5)
        self.assertEqual(len(figure.axes), 1)
        self.assertIn(": 0 everywhere", figure.axes[0].get_title())
        frames = figure.axes[0].patches
        self.assertGreater(len(frames), 0)
        for frame in frames:
            np.testing.assert_allclose(frame.get_edgecolor()[:3], (0, 0x9E / 255, 0x73 / 255))

    def test_no_unit_twice(self):
        for metric, unit, label in (("statistics.z.mean_m", "m", "statistics.z.mean"), ("region.bin_count", "1", "region.bin_count"),
                                    ("accuracy.relative.z.max_m", "m", "relative elevation error, largest")):
            self.assertEqual(table.metric_label(metric, unit), label)

    def test_series_and_kinds(self):
        results = self.results("sigma_m", "kind", "repeat")
        figure = figures.metric_figure(results, "accuracy.relative.z.max_m", results.axes[0], 0.5)
        labels = figure.axes[0].get_legend_handles_labels()[1]
        self.assertEqual(labels, ["FSM", "flash", "required: at most 5 cm"])
        figure = figures.metric_figure(results, "accuracy.relative.z.max_m", results.axes[1], 0.5)
        self.assertEqual([text.get_text() for text in figure.axes[0].get_xticklabels()], ["FSM", "flash"])
        self.assertEqual(figure.axes[0].get_lines()[0].get_linestyle(), "None")
        self.assertIsNone(figures.map_axes(results, results.axes[0]))

    def test_zipped_axes_are_one_line(self):
        results = self.results("sigma_m", "lines", "repeat")
        sigma, lines = results.axes
        self.assertTrue(results.follows(lines, sigma) and results.follows(sigma, lines))
        for x, at in ((sigma, [0, 0.01, 0.02]), (lines, [7, 8, 9])):
            (axes,) = figures.metric_figure(results, "accuracy.relative.z.max_m", x, 0.5).axes
            np.testing.assert_allclose(axes.get_lines()[0].get_xdata(), at)
            self.assertIsNone(figures.map_axes(results, x))
        crossed = self.results("sigma_m", "kind", "lines", "repeat")
        sigma, kind, lines = crossed.axes
        self.assertTrue(crossed.follows(lines, sigma))
        self.assertFalse(crossed.follows(kind, sigma) or crossed.follows(sigma, kind))

    def test_a_limit_far_above_the_values_is_only_in_the_legend(self):
        for limit, drawn in ((1.2, True), (1.3, False)):  # 28 and 30.2 times the largest value, 4.3 cm
            results = self.results("sigma_m", "repeat", limits={"relative_elevation_m": limit})
            (axes,) = figures.metric_figure(results, "accuracy.relative.z.max_m", results.axes[0], 0.5).axes
            label = axes.get_legend_handles_labels()[1][-1]
            self.assertEqual(label, f"required: at most {limit} m" + ("" if drawn else " (far above)"))
            self.assertEqual(any(line.get_linestyle() == "--" for line in axes.get_lines()), drawn)
            self.assertEqual(axes.get_ylim()[1] > 100, drawn)

    def test_ticks_of_a_logarithmic_axis(self):
        self.assertEqual(figures.tick_labels([1, 10, 100]), ["1", "10", "100"])
        # The distance of 450 and 475 is 0.045 of the axis, too little for two labels; that of 450 and 500 is 0.088.
        self.assertEqual(figures.tick_labels([300, 450, 475, 500, 1000]), ["300", "450", "", "500", "1,000"])
        self.assertEqual(figures.tick_labels([3]), ["3"])

    def test_scales(self):
        """Logarithmic only if half of the values would otherwise be hard to read."""
        results = self.results("sigma_m", "repeat")
        for values, scale in (([1e-4, 0.1, 0.2], "linear"), ([1e-4, 2e-4, 0.2], "log"), ([0, 2e-4, 0.2], "symlog")):
            for point, value in zip(results.points, values):
                for row in point.rows:
                    results.columns["accuracy.relative.z.max_m"][row] = value
            (axes,) = figures.metric_figure(results, "accuracy.relative.z.max_m", results.axes[0], 0.5).axes
            self.assertEqual(axes.get_yscale(), scale, values)

    def test_marks_are_complete_and_not_hidden(self):
        """Marks lie completely inside the axes, also if all values are equal, and outside the legend."""
        results = self.results("sigma_m", "repeat")
        metric = "accuracy.relative.z.max_m"
        for value in (0, 0.001, 0.03, 0.05):
            results.columns[metric] = [value] * len(results.columns[metric])
            figure = figures.overview_figure(results, [metric, "coverage.invalid_frac"], results.axes[0], 0.5)
            figure.canvas.draw()
            axes = figure.axes[0]
            line, box, legend = axes.get_lines()[0], axes.get_window_extent(), axes.get_legend().get_window_extent()
            radius = figure.dpi / 72 * line.get_markersize() / 2
            for x, y in axes.transData.transform(line.get_xydata()):
                self.assertTrue(box.y0 + radius < y < box.y1 - radius, value)
                self.assertFalse(legend.x0 - radius < x < legend.x1 + radius and legend.y0 - radius < y < legend.y1 + radius, value)

    def test_a_requirement_above_a_symlog_scale_is_visible(self):
        results = self.results("sigma_m", "repeat")
        for value, point in zip((0, 1e-5, 0.004), results.points):
            for row in point.rows:
                results.columns["accuracy.relative.z.max_m"][row] = value
        (axes,) = figures.metric_figure(results, "accuracy.relative.z.max_m", results.axes[0], 0.5).axes
        self.assertEqual(axes.get_yscale(), "symlog")
        self.assertGreater(axes.get_ylim()[1], 50)  # mm

    def test_equal_series_are_both_visible(self):
        results = self.results("sigma_m", "kind", "repeat")  # the kind changes nothing
        (axes,) = figures.metric_figure(results, "accuracy.relative.z.max_m", results.axes[0], 0.5).axes
        below, above = [line for line in axes.get_lines() if line.get_label() in ("FSM", "flash")]
        np.testing.assert_array_equal(below.get_ydata(), above.get_ydata())
        self.assertGreater(below.get_linewidth(), above.get_linewidth())
        self.assertGreater(below.get_markersize(), above.get_markersize())

    def test_a_map_of_many_values_has_no_numbers(self):
        results = self.results("sigma_m", "loss_frac", "repeat")
        sigma, loss = results.axes
        small = figures.map_figure(results, "coverage.invalid_frac", (sigma, loss), 0.5)
        self.assertEqual(len(small.axes[0].texts), 6)
        many = tuple(index / 1000 for index in range(100))
        wide = dataclasses.replace(sigma, values=many)
        results.axes = [wide, loss]
        results.points = [dataclasses.replace(results.points[0], values=(value, share)) for value in many for share in loss.values]
        figure = figures.map_figure(results, "coverage.invalid_frac", (wide, loss), 0.5)
        self.assertLess(figure.get_figwidth(), 21)
        axes = figure.axes[0]
        self.assertEqual((len(axes.texts), len(axes.get_xticks())), (0, 20))
        self.assertEqual([axes.get_xlim(), axes.get_ylim()], [(-0.5, 99.5), (-0.5, 1.5)])
        outlines = [path for collection in axes.collections for path in collection.get_paths()]
        self.assertEqual(len(outlines), 1)  # all cases pass: one outline around the whole map
        np.testing.assert_allclose([outlines[0].vertices.min(axis=0), outlines[0].vertices.max(axis=0)], [[-0.5, -0.5], [99.5, 1.5]])

    def test_overview(self):
        results = self.results("sigma_m", "loss_frac", "repeat")
        metrics_of_two = ["accuracy.relative.z.max_m", "coverage.invalid_frac", "requirements.relative_elevation.value"]
        figure = figures.overview_figure(results, metrics_of_two, results.axes[0], 0.5)
        shown = [axes for axes in figure.axes if axes.get_visible()]
        self.assertEqual(len(shown), 3)
        np.testing.assert_allclose(shown[0].get_lines()[0].get_ydata(), [0.002, 0.022, 0.042])  # in m, because the values reach 0.5
        names = [[text.get_text() for text in axes.get_legend().get_texts()] if axes.get_legend() else [] for axes in shown]
        self.assertEqual(names[0], ["losses 0", "losses 0.5", "required: at most 0.05 m"])
        self.assertTrue(all(name.startswith("required") for name in names[1] + names[2]))
        by_kind = self.results("kind", "repeat")
        self.assertIsNone(figures.overview_figure(by_kind, metrics_of_two, by_kind.axes[0], 0.5))
        self.assertIsNone(figures.overview_figure(results, metrics_of_two[:1], results.axes[0], 0.5))

    def test_only_repeats(self):
        self.plot(self.table(("repeat",)), "-o", self.path("f"), "--metrics", "accuracy.relative.z.max_m")
        self.assertIn("accuracy.relative.z.max_m.png", os.listdir(self.path("f")))

    def test_cases_that_are_not_judged(self):
        table = self.table(("sigma_m",), judged=False)
        self.plot(table, "-o", self.path("f"), "--metrics", "accuracy.relative.z.max_m")
        with open(self.path("f", "pass_rates.csv"), encoding="utf-8") as file:
            self.assertEqual(len(file.readlines()), 1)

    def test_the_study_chooses_metrics_and_axis(self):
        self.plot(self.table(("sigma_m", "kind"), metrics=["coverage.invalid_frac"], x="kind"), "-o", self.path("f"))
        self.assertEqual(sorted(name for name in os.listdir(self.path("f")) if name.endswith(".png")),
                         ["coverage.invalid_frac.png", "requirements.png", "shares.png"])

    def test_the_same_bytes(self):
        table = self.table(("sigma_m", "loss_frac", "repeat"))
        for name in ("a", "b"):
            self.plot(table, "-o", self.path(name), "--metrics", "accuracy.relative.z.max_m")
        for name in os.listdir(self.path("a")):
            with open(self.path("a", name), "rb") as first, open(self.path("b", name), "rb") as second:
                self.assertEqual(first.read(), second.read(), name)

    def test_refusals(self):
        table = self.table(("sigma_m",))
        for arguments, code, word in (
                ([table, "--metrics", "nope"], 2, "'nope' is not a metric"), ([table, "--metrics", "sigma_m"], 2, "not a metric"),
                ([table, "--x", "nope"], 2, "'nope' is not one of sigma_m"), ([table, "--percentile", "101"], 2, "[0, 100]"),
                ([self.path("none.h5")], 1, "no such file")):
            message = self.plot(*arguments, "-o", self.path("f"), code=code).stderr
            self.assertIn(word, message)
            self.assertFalse(os.path.exists(self.path("f")))
        self.plot(table, "-o", self.path("f"), "--metrics", "coverage.invalid_frac")
        again = self.plot(table, "-o", self.path("f"), "--metrics", "coverage.invalid_frac", code=2).stderr
        self.assertIn("output " + self.path("f", "percentiles.csv") + " exists; use -O to overwrite it", again)
        nowhere = self.plot(table, "-o", self.path("no", "where"), code=2).stderr
        self.assertIn(f"folder {self.path('no', 'where')} does not exist", nowhere)
        os.remove(self.path("f", "pass_rates.csv"))
        os.mkfifo(self.path("f", "pass_rates.csv"))
        pipe = self.plot(table, "-o", self.path("f"), "-O", code=2).stderr
        self.assertIn("output " + self.path("f", "pass_rates.csv") + " is not a regular file", pipe)
        with h5py.File(table, "r+") as file:
            file["_study_json"][()] = json.dumps({"title": "T"})
        self.assertIn("no table of a study", self.plot(table, "-o", self.path("g"), code=1).stderr)


class Crossings(PlotTest):
    SPEC = {"metrics": ["accuracy.relative.z.max_m", "coverage.invalid_frac"], "against": "accuracy.relative.z.max_m", "level": 0.03}

    def test_where_a_curve_exceeds_a_level(self):
        """Linear between neighbours, at the first excess, whatever the order of the points and what is not known."""
        curve = [(1, 0.0), (3, 0.02), (2, 0.005), (4, 0.001), (5, 0.5)]
        for points in (curve, curve[::-1], [*curve, (2.5, math.nan), (math.nan, 9)]):
            self.assertAlmostEqual(crossing.crossing_of(points, 0.01), 2 + 0.005 / 0.015, 12)
            self.assertAlmostEqual(crossing.crossing_of(points, 0.02), 4 + 0.019 / 0.499, 12)  # 0.02 itself does not exceed it
        self.assertEqual(crossing.crossing_of(curve, 0.6), math.inf)
        self.assertEqual(crossing.crossing_of(curve, -1), -math.inf)
        self.assertEqual(crossing.crossing_of([], 0.01), math.inf)

    def test_table_and_figure(self):
        """The largest error of a repeat is 2 sigma + 1 mm r: it exceeds 3 cm at 3 cm; losses do nowhere, or everywhere."""
        self.plot(self.table(("sigma_m", "loss_frac", "repeat"), crossing=self.SPEC), "-o", self.path("f"))
        with open(self.path("f", "crossings.csv"), encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
        self.assertEqual(rows[0], ["loss_frac", *crossing.HEAD])
        self.assertEqual([row[1:5] for row in rows[1:3]], [["accuracy.relative.z.max_m", "0.03", "accuracy.relative.z.max_m", "3"]] * 2)
        np.testing.assert_allclose([float(cell) for cell in rows[1][5:]], [0.03] * 3, rtol=1e-12)
        self.assertEqual([row[5:] for row in rows[2:]], [["-inf"] * 3, ["inf"] * 3, ["-inf"] * 3])
        self.assertIn("crossing.png", os.listdir(self.path("f")))

    def test_legend_and_repeats(self):
        """The median and the range of the repeats; partial tables too."""
        results = self.results("sigma_m", "repeat", crossing=self.SPEC)
        column = results.columns["coverage.invalid_frac"]
        for row, (sigma, repeat) in enumerate(zip(results.columns["sigma_m"], results.columns["repeat"])):
            column[row] = sigma * (1.5 + 0.4 * repeat)
        column[-1] = None
        figure = crossing.crossing_figure(results, results.axes[0], {**self.SPEC, "metrics": ["coverage.invalid_frac"]})
        (label,) = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
        # In repeat r, e = 2 sigma + 0.001 r, and the metric is 0.03 at sigma = 0.03 / (1.5 + 0.4 r).
        first, second = (2 * 0.03 / (1.5 + 0.4 * r) + 0.001 * r for r in (1, 2))
        self.assertEqual(label, f"all: {100 * max(first, second):.2g} cm ({100 * min(first, second):.2g} to nowhere)")
        found = crossing.crossings_of(results, results.points, "coverage.invalid_frac", self.SPEC)
        np.testing.assert_allclose((found.minimum, found.median), sorted((second, first)), rtol=1e-9)
        self.assertEqual(found.maximum, math.inf)
        self.assertEqual(figure.axes[0].get_xlabel(), "relative elevation error, largest [cm]")

    def test_an_unknown_metric(self):
        for spec in ({**self.SPEC, "metrics": ["nope"]}, {**self.SPEC, "against": "sigma_m"}):
            message = self.plot(self.table(("sigma_m",), crossing=spec), "-o", self.path("f"), code=2).stderr
            self.assertRegex(message, r"results\.h5: plot\.crossing: '(nope|sigma_m)' is not a metric")


if __name__ == "__main__":
    unittest.main()
