#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_dem.py, plot_eval.py and plot_plan.py on small files that the tests make."""
import json
import os
import subprocess
import unittest

import h5py
import numpy as np

from harness import ROOT, ToolTest, read_bytes
from harness.commands import run_command
from landfall import dictionary, files
from landfall.plot import maps, plot_command, plot_compare, plot_dem, plot_eval, plot_plan, scales
import matplotlib.pyplot as plt

BINS = 41
RESOLUTION_M = 0.5
RADIUS_M = 9.0
PICTURES = ["accuracy", "coverage", "elevation_error", "verdict"]


def start_file(path, format_name, complete=1):
    file = h5py.File(path, "w")
    file.attrs["format_name"], file.attrs["format_version"] = format_name, "1.0"
    file.attrs["complete"] = np.int32(complete)
    centers = (np.arange(BINS) - BINS // 2) * RESOLUTION_M
    file["x"], file["y"] = centers, centers
    return file


def elevations(empty_bins):
    x = np.linspace(-1, 1, BINS)
    true = 2 * np.exp(-4 * (x[:, None] ** 2 + x[None, :] ** 2))
    estimated = true + 0.01 * np.sin(40 * x)
    for row, col in empty_bins:
        true[row, col] = estimated[row, col] = np.nan
    return true, estimated


def make_dem(path, truth=True, empty_bins=((22, 25),), **attributes):
    true, estimated = elevations(empty_bins)
    with start_file(path, "landfall.dem", **attributes) as file:
        file["z_est"] = estimated
        if truth:
            file["z_true"] = true


def make_metrics(invalid, judged=True):
    def requirement(value, limit):
        return {"value": value if judged else None, "limit": limit, "pass": True if judged else None}

    axis = {"p95_m": 0.01, "mean_m": 0.0, "max_m": 0.02, "violation_count": 3}
    accuracy = {"footprint_bins": 5, "quantile": 0.95, "absolute": {a: axis for a in "xyz"},
                "relative": {a: axis for a in "xyz"}}
    histogram = {"size_bins": [1] if invalid else [], "count": [invalid] if invalid else []}
    return {"format": "landfall.metrics", "version": 1, "pass": True if judged else None,
            "region": {"radius_m": RADIUS_M, "bin_count": 1009},
            "coverage": {"invalid_count": invalid, "invalid_frac": invalid / 1009, "hole_count": invalid,
                         "largest_hole_bins": min(invalid, 1), "holes_over_limit": 0, "max_distance_bins": 1,
                         "distance_over_limit_count": 0, "hole_size_histogram": histogram},
            "accuracy": accuracy if judged else None,
            "requirements": {"coverage": {"value": 0.001, "limit": 0.01, "pass": True},
                             "hole_size": {"value": 1, "limit": 10, "pass": True},
                             "hole_distance": {"value": 1.0, "limit": 1, "pass": True},
                             "relative_elevation": requirement(0, 0),
                             "relative_horizontal": requirement(0, 0),
                             "absolute_horizontal": requirement(1.0, 0.95)}}


def coverage_layers(estimated):
    x = np.arange(BINS) - BINS // 2
    inside = x[:, None] ** 2 + x[None, :] ** 2 < (RADIUS_M / RESOLUTION_M) ** 2
    invalid = np.isnan(estimated) & inside
    return {"in_region": inside.astype(np.int8), "invalid": invalid.astype(np.int8),
            "fail": np.where(invalid, 32, 0).astype(np.int8)}


def make_evaluation(path, empty_bins=((22, 25),), truth=True, layers=True):
    true, estimated = elevations(empty_bins)
    with start_file(path, "landfall.evaluation") as file:
        file["metrics_json"] = json.dumps(make_metrics(len(empty_bins), truth))
        for name, values in (coverage_layers(estimated) if layers else {}).items():
            file[name] = values
        if layers and truth:
            for axis in "xyz":
                file[f"e_{axis}"] = true - estimated
                file[f"abs_{axis}"] = (true - estimated).astype(np.float32)
                file[f"rel_{axis}"] = np.abs(true - estimated).astype(np.float32)


class ScriptTest(ToolTest):
    def call(self, script, *arguments):
        return run_command(script.removesuffix(".py"), *arguments, cwd=self.folder)

    def expect_success(self, script, *arguments, dpi=50):
        """Figures are coarse, for speed; without `dpi` as users have them."""
        done = self.call(script, *arguments, *(["--dpi", dpi] if dpi else []))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout.split()

    def expect_failure(self, code, message, script, *arguments):
        """Expects one line on stderr that contains the message, nothing on stdout, and no new file."""
        before = sorted(os.listdir(self.folder))
        done = self.call(script, *arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(message, done.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def expect_picture(self, name, minimum_width_px=333):
        image = plt.imread(self.path(name))
        self.assertGreaterEqual(image.shape[1], minimum_width_px)
        self.assertGreater(image[..., :3].std(), 0.03, f"{name} is nearly blank")
        self.assertEqual([f for f in os.listdir(self.folder) if f.endswith(".tmp")], [])


class PlotCompareTest(ScriptTest):
    def test_two_dems(self):
        make_dem(self.path("a.h5"))
        make_dem(self.path("b.h5"), empty_bins=[(3, 4)])
        self.assertEqual(self.expect_success("plot_compare.py", "a.h5", "b.h5"), ["b-compared.png"])
        self.expect_picture("b-compared.png", 666)

    def test_the_statistics_are_those_of_the_difference(self):
        difference = np.array([[1.0, 2.0], [np.nan, 6.0]])
        self.assertEqual(plot_compare.statistics_text(difference),
                         "3 bins with both: mean 3 m, standard deviation 2.16 m, NMAD 1.48 m")
        self.assertEqual(plot_compare.statistics_text(np.full((2, 2), np.nan)), "no bin has a value in both")

    def test_no_bin_in_both(self):
        make_dem(self.path("a.h5"))
        make_dem(self.path("b.h5"), empty_bins=[(row, col) for row in range(BINS) for col in range(BINS)])
        self.expect_success("plot_compare.py", "a.h5", "b.h5", "-o", "c.png")
        self.expect_picture("c.png")

    def test_refusals(self):
        make_dem(self.path("a.h5"))
        make_dem(self.path("b.h5"), truth=False)
        self.expect_failure(1, "b.h5: has no layer z_true", "plot_compare.py", "a.h5", "b.h5", "--layer", "z_true")
        self.expect_failure(2, "count", "plot_compare.py", "a.h5", "b.h5", "--layer", "count")
        self.expect_failure(1, "c.h5: no such file", "plot_compare.py", "a.h5", "c.h5")


class PlotDemTest(ScriptTest):
    def test_the_default_figure_is_beside_the_dem(self):
        make_dem(self.path("dem.h5"))
        self.assertEqual(self.expect_success("plot_dem.py", self.path("dem.h5"), dpi=None), [self.path("dem-figure.png")])
        self.expect_picture("dem-figure.png", 2000)

    def test_dpi_sets_the_size(self):
        make_dem(self.path("dem.h5"))
        self.expect_success("plot_dem.py", "dem.h5", "-o", "small.png", dpi=100)
        self.assertEqual(plt.imread(self.path("small.png")).shape[1], 1400)

    def test_dem_without_truth(self):
        make_dem(self.path("dem.h5"), truth=False)
        self.expect_success("plot_dem.py", "dem.h5")
        self.expect_picture("dem-figure.png")

    def test_dem_without_any_value(self):
        everywhere = [(row, col) for row in range(BINS) for col in range(BINS)]
        make_dem(self.path("dem.h5"), empty_bins=everywhere)
        self.expect_success("plot_dem.py", "dem.h5")
        self.expect_picture("dem-figure.png")

    def test_the_same_file_gives_the_same_figure(self):
        make_dem(self.path("dem.h5"))
        pictures = []
        for name in ("a.png", "b.png"):
            self.expect_success("plot_dem.py", "dem.h5", "-o", name)
            pictures.append(read_bytes(self.path(name)))
        self.assertEqual(*pictures)

    def test_existing_figure_is_kept_without_overwrite(self):
        make_dem(self.path("dem.h5"))
        self.write("dem-figure.png", "mine")
        self.expect_failure(2, "output dem-figure.png exists", "plot_dem.py", "dem.h5")
        self.assertEqual(read_bytes(self.path("dem-figure.png")).decode(), "mine")
        self.expect_success("plot_dem.py", "dem.h5", "-O")
        self.expect_picture("dem-figure.png")

    def test_data_errors(self):
        self.expect_failure(1, "dem.h5: no such file", "plot_dem.py", "dem.h5")
        self.write("text.h5", "not HDF5")
        self.expect_failure(1, "text.h5: is not an HDF5 file", "plot_dem.py", "text.h5")
        make_evaluation(self.path("eval.h5"))
        self.expect_failure(1, "expected 'landfall.dem'", "plot_dem.py", "eval.h5")
        make_dem(self.path("unfinished.h5"), complete=0)
        self.expect_failure(1, "is incomplete", "plot_dem.py", "unfinished.h5")
        with start_file(self.path("bare.h5"), "landfall.dem"):
            pass
        self.expect_failure(1, "z_est", "plot_dem.py", "bare.h5")

    def test_truncated_file(self):
        make_dem(self.path("dem.h5"))
        with open(self.path("dem.h5"), "r+b") as file:
            file.truncate(os.path.getsize(self.path("dem.h5")) // 2)
        self.expect_failure(1, "dem.h5: is an HDF5 file that is truncated or damaged", "plot_dem.py", "dem.h5")

    def test_layer_of_another_shape(self):
        with start_file(self.path("dem.h5"), "landfall.dem") as file:
            file["z_est"] = np.zeros((3, 4))
        self.expect_failure(1, "z_est has shape (3, 4)", "plot_dem.py", "dem.h5")

    def test_usage_errors(self):
        make_dem(self.path("dem.h5"))
        self.expect_failure(2, "required", "plot_dem.py")
        self.expect_failure(2, "--colour", "plot_dem.py", "dem.h5", "--colour")
        self.expect_failure(2, "not in [50, 600]", "plot_dem.py", "dem.h5", "--dpi", "5")
        self.expect_failure(2, "positive length", "plot_dem.py", "dem.h5", "--footprint-m", "-1")
        self.expect_failure(2, ".png", "plot_dem.py", "dem.h5", "-o", "dem.jpg")
        self.expect_failure(2, "folder missing does not exist", "plot_dem.py", "dem.h5", "-o", "missing/dem.png")

    def test_all_missing_packages_are_named_at_once(self):
        words = ["/usr/bin/python3", "-S", os.path.join(ROOT, "python", "start.py"), "plot dem"]
        result = subprocess.run(words, capture_output=True, text=True, check=False)
        self.assertEqual((result.returncode, result.stderr), (1, "landfall plot dem: /usr/bin/python3 has no module matplotlib; "
                                                              "apt-get install python3-h5py python3-matplotlib python3-numpy\n"))


class PlotEvalTest(ScriptTest):
    def expect_pictures(self, prefix, names, minimum_width_px=333):
        self.assertEqual(sorted(os.path.basename(f) for f in os.listdir(self.folder) if f.endswith(".png")),
                         sorted(f"{prefix}{name}.png" for name in names))
        for name in names:
            self.expect_picture(f"{prefix}{name}.png", minimum_width_px)

    def test_draws_all_figures(self):
        make_evaluation(self.path("eval.h5"))
        self.expect_success("plot_eval.py", "eval.h5", dpi=None)
        self.expect_pictures("eval-", PICTURES, 1000)

    def test_uncertainty(self):
        make_evaluation(self.path("eval.h5"))
        scores = {"count": 900, "std": 1.1, "within_1_sigma_frac": 0.66, "within_2_sigma_frac": 0.93,
                  "reliability": {"sigma_m": [0.01, 0.012, 0.02], "rmse_m": [0.012, 0.0, 0.021], "bins": [800, 1, 99]},
                  "within_k_sigma": {"k": [0.5, 1, 2], "frac": [0.3, 0.66, 0.93]}}
        empty = {"count": 0, "reliability": {"sigma_m": [], "rmse_m": [], "bins": []},
                 "within_k_sigma": {"k": [], "frac": []}}
        with h5py.File(self.path("eval.h5"), "r+") as file:
            metrics = json.loads(file["metrics_json"][()])
            del file["metrics_json"]
            file["metrics_json"] = json.dumps(metrics | {"uncertainty": {"absolute": scores, "relative": empty}})
        self.expect_success("plot_eval.py", "eval.h5")
        self.expect_pictures("eval-", PICTURES + ["uncertainty"])

    def test_square_region(self):
        make_evaluation(self.path("eval.h5"))
        with h5py.File(self.path("eval.h5"), "r+") as file:
            metrics = json.loads(file["metrics_json"][()])
            del file["metrics_json"]
            file["metrics_json"] = json.dumps(metrics | {"region": {"radius_m": None, "bin_count": 9,
                                                                    "half_width_m": 0.5}})
        self.expect_success("plot_eval.py", "eval.h5")
        self.expect_pictures("eval-", PICTURES)

    def test_prefix_and_dem(self):
        make_evaluation(self.path("eval.h5"))
        make_dem(self.path("dem.h5"))
        self.expect_success("plot_eval.py", "eval.h5", "--dem", "dem.h5", "-o", "case_")
        self.expect_pictures("case_", PICTURES + ["dem"])

    def test_folder(self):
        make_evaluation(self.path("eval.h5"))
        written = self.expect_success("plot_eval.py", "eval.h5", "-o", self.folder)
        self.assertEqual(sorted(written), sorted(self.path(f"{name}.png") for name in PICTURES))
        self.expect_pictures("", PICTURES)

    def test_a_folder_that_does_not_exist_yet(self):
        make_evaluation(self.path("eval.h5"))
        for folder in ("new/", "other"):
            self.expect_success("plot_eval.py", "eval.h5", "-o", self.path(folder))
            self.assertEqual(sorted(os.listdir(self.path(folder))), sorted(f"{name}.png" for name in PICTURES))
        self.expect_failure(2, "several figures are written; name a folder", "plot_eval.py", "eval.h5", "-o", "a.png")
        self.expect_failure(2, "does not exist", "plot_eval.py", "eval.h5", "-o", self.path("a/b/"))

    def test_no_holes(self):
        make_evaluation(self.path("eval.h5"), empty_bins=())
        self.expect_success("plot_eval.py", "eval.h5")
        self.expect_pictures("eval-", PICTURES)

    def test_no_values(self):
        make_evaluation(self.path("eval.h5"), [(row, col) for row in range(BINS) for col in range(BINS)])
        self.expect_success("plot_eval.py", "eval.h5")
        self.expect_pictures("eval-", PICTURES)

    def test_dem_without_truth(self):
        make_evaluation(self.path("eval.h5"), truth=False)
        self.expect_success("plot_eval.py", "eval.h5")
        self.expect_pictures("eval-", ["coverage", "verdict"])

    def test_metrics_only(self):
        make_evaluation(self.path("eval.h5"), layers=False)
        with h5py.File(self.path("eval.h5"), "r+") as file:
            del file["x"], file["y"]
        self.expect_success("plot_eval.py", "eval.h5")
        self.expect_pictures("eval-", ["coverage", "verdict"])

    def test_one_existing_figure_prevents_all(self):
        make_evaluation(self.path("eval.h5"))
        self.write("eval-verdict.png", "mine")
        self.expect_failure(2, "output eval-verdict.png exists", "plot_eval.py", "eval.h5")
        self.expect_success("plot_eval.py", "eval.h5", "--overwrite")
        self.expect_pictures("eval-", PICTURES)

    def test_errors(self):
        self.expect_failure(1, "eval.h5: no such file", "plot_eval.py", "eval.h5")
        make_dem(self.path("dem.h5"))
        self.expect_failure(1, "expected 'landfall.evaluation'", "plot_eval.py", "dem.h5")
        make_evaluation(self.path("eval.h5"))
        self.expect_failure(1, "none.h5: no such file", "plot_eval.py", "eval.h5", "--dem", "none.h5")
        with h5py.File(self.path("eval.h5"), "r+") as file:
            del file["metrics_json"]
            file["metrics_json"] = "{"
        self.expect_failure(1, "/metrics_json is not JSON", "plot_eval.py", "eval.h5")


def notes_of(ax):
    return next(text.get_text() for text in ax.texts if text.get_gid() == "note").replace("\n", "; ")


def bar_of(ax):
    """The axes of a map's colour bar."""
    return next(child for child in ax.child_axes)


def limits_of(ax):
    """The places of the limit's triangles on the colour bar, in its unit."""
    return sorted(float(line.get_ydata()[0]) for line in bar_of(ax).lines if line.get_gid() == "limit")


def marks_of(ax):
    """The opacity of the marks on a map."""
    return next(image.get_array()[..., 3] for image in ax.images if image.get_gid() == "marks")


def map_named(figure, title):
    return next(ax for ax in figure.axes if ax.get_title().startswith(title))


class FigureTest(ScriptTest):
    """The contents of the figures, as numbers and words."""

    def tearDown(self):
        plt.close("all")

    def dem_figure(self, *arguments, **style):
        make_dem(self.path("dem.h5"), **style)
        options = plot_dem.parse([self.path("dem.h5"), *arguments])
        return plot_dem.figure_of(options)

    def eval_figure(self, draw, limits=True, data_only=False, **style):
        make_evaluation(self.path("eval.h5"), **style)
        if limits:
            with h5py.File(self.path("eval.h5"), "r+") as file:
                file["provenance/config_json"] = json.dumps({"limits": {
                    "relative_elevation_m": 0.02, "relative_horizontal_m": 0.008, "absolute_horizontal_m": 1}})
        return draw(plot_eval.Evaluation(self.path("eval.h5"), data_only))

    def test_the_error_of_a_dem(self):
        error = map_named(self.dem_figure("--limit-m", "0.03"), "error e_z = true - estimated")
        self.assertEqual(limits_of(error), [-3, 3])
        self.assertEqual(bar_of(error).get_ylabel(), "true - estimated (cm)")
        np.testing.assert_allclose(bar_of(error).get_ylim(), [-3.3, 3.3])
        np.testing.assert_allclose(error.images[0].get_clim(), [-0.033, 0.033])
        self.assertEqual(notes_of(error), "-9.92 to 9.92 mm; ▸ limit ±3 cm of the relative error; magenta: bins without a return")

    def test_the_limit_of_a_dem_is_an_option(self):
        error = map_named(self.dem_figure("--limit-m", "0.008"), "error")
        self.assertEqual(limits_of(error), [-8, 8])
        for far in ((), ("--limit-m", "0.02", "--data-only")):
            error = map_named(self.dem_figure(*far), "error")
            self.assertEqual((limits_of(error), bar_of(error).get_ylabel()), ([], "true - estimated (mm)"))

    def test_true_and_estimated_elevation_share_their_colours(self):
        figure = self.dem_figure()
        bars = [bar_of(map_named(figure, name)) for name in ("true elevation", "estimated elevation")]
        self.assertEqual(bars[0].get_ylim(), bars[1].get_ylim())
        self.assertEqual(bars[0].get_ylabel(), "elevation (m)")
        image = map_named(figure, "estimated elevation").images[0].get_array()
        self.assertEqual(image.shape, (BINS, BINS, 3))  # shaded colours, not values
        east, west = image[20, 26].sum(), image[20, 14].sum()
        self.assertGreater(west, 1.2 * east)  # the hill's western flank faces the light

    def test_many_empty_bins_are_grey_and_few_are_marked(self):
        figure = self.dem_figure(empty_bins=[(row, 5) for row in range(3, 19)])
        self.assertEqual(marks_of(map_named(figure, "error")).sum(), 16)
        figure = self.dem_figure(empty_bins=[(row, 5) for row in range(3, 20)])
        for name in ("error", "estimated"):
            ax = map_named(figure, name)
            self.assertEqual([image.get_gid() for image in ax.images], [None])
            self.assertIn("grey: bins without a return", notes_of(ax))
        np.testing.assert_allclose(map_named(figure, "estimated").images[0].get_array()[4, 5] * 255, scales.NO_VALUE)

    def test_each_map_of_the_accuracy_has_its_limit(self):
        figure = self.eval_figure(plot_eval.draw_accuracy)
        for name, limits, label in (("absolute x", [], "mean of true - estimated (mm)"),
                                    ("absolute z", [], "mean of true - estimated (mm)"),
                                    ("relative x", [0.8], "|e - mean|, 95 % quantile (cm)"),
                                    ("relative z", [2], "|e - mean|, 95 % quantile (cm)")):
            ax = map_named(figure, name)
            np.testing.assert_allclose(limits_of(ax), limits)
            self.assertEqual(bar_of(ax).get_ylabel(), label)
        self.assertIn("▸ limit ±1 m of the horizontal error", notes_of(map_named(figure, "absolute y")))
        self.assertEqual(map_named(figure, "absolute x").images[0].cmap.name, "error")
        self.assertEqual(map_named(figure, "relative x").images[0].cmap.name, "magnitude")

    def test_an_evaluation_without_its_configuration_has_no_limits(self):
        figure = self.eval_figure(plot_eval.draw_accuracy, limits=False)
        self.assertEqual(limits_of(map_named(figure, "relative z")), [])
        self.assertNotIn("limit", notes_of(map_named(figure, "relative z")))

    def test_violations_are_outlined_or_coloured(self):
        def draw(evaluation):
            evaluation.layers["fail"] = np.where(failing, dictionary.fail_bit("relative_z"), 0).astype(np.int8)
            return plot_eval.draw_accuracy(evaluation)

        failing = np.zeros((BINS, BINS), bool)
        failing[20:23, 20:23] = True
        ax = map_named(self.eval_figure(draw), "relative z")
        self.assertIn("white line: over the limit", notes_of(ax))
        failing[5:36:2, 5:36:2] = True
        figure = self.eval_figure(draw)
        ax = map_named(figure, "relative z")
        self.assertIn("vermilion: over the limit", notes_of(ax))
        marks = [image.get_array()[..., 3] for image in ax.images if image.get_gid() == "marks"]  # missing values, violations
        np.testing.assert_array_equal(marks[-1], failing)
        self.assertNotIn("over the limit", notes_of(map_named(figure, "relative x")))

    def test_x_y_and_z_of_one_kind_have_one_scale(self):
        for kind, data_only in (("absolute", False), ("relative", False), ("relative", True)):
            figure = self.eval_figure(plot_eval.draw_accuracy, data_only=data_only)
            ends = {map_named(figure, f"{kind} {axis}").images[0].get_clim() for axis in "xyz"}
            self.assertEqual(len(ends), 1, ends)
        self.assertEqual(limits_of(map_named(figure, "relative z")), [])

    def test_the_histogram_of_errors_shows_the_limits(self):
        ax = map_named(self.eval_figure(plot_eval.draw_error), "1,00")
        self.assertEqual(ax.get_xlabel(), "e_z = true - estimated (cm)")
        self.assertEqual(sorted(line.get_xdata()[0] for line in ax.lines), [-2, 2])

    def test_lines_are_drawn_only_around_few_groups(self):
        ax = plt.figure().add_subplot()
        centers = np.arange(100.0)
        grid = files.MapGrid(centers, centers, 1.0)
        flags = np.zeros((100, 100), bool)
        flags[20:40, 20:40] = True
        self.assertTrue(maps.outline_flags(ax, grid, flags, "white"))
        flags[::3, ::3] = True
        self.assertFalse(maps.outline_flags(ax, grid, flags, "white"))

    def test_a_map_has_no_more_blocks_than_pixels(self):
        self.addCleanup(plot_command.use_dpi, 100)
        values = np.zeros((2001, 2001))
        values[1000, 1777] = 0.07
        grid = files.MapGrid(np.arange(2001) * 0.05, np.arange(2001) * 0.05, 0.05)
        for dpi, size in ((50, 10), (150, 4), (600, 1)):
            plot_command.use_dpi(dpi)
            figure, axes = maps.new_figure((2, 2), (14, 13), "")
            ax = axes[0, 0]
            self.assertEqual(maps.block_size(ax, values.shape), size)
            maps.frame_map(ax, grid, "")
            maps.draw_values(ax, grid, values, scales.error_scale(values, maps.reduced(ax, values)), "error")
            figure.draw_without_rendering()
            self.assertLessEqual(ax.images[0].get_array().shape[1], ax.get_window_extent().width)
            self.assertEqual(ax.images[0].get_array().max(), 0.07)
            plt.close(figure)

    def marks(self, flags, region_bins):
        """(what the legend says, opacity) of marks on a map."""
        ax = plt.figure().add_subplot()
        grid = files.MapGrid(np.arange(flags.shape[1]) * 1.0, np.arange(flags.shape[0]) * 1.0, 1.0)
        return maps.draw_marks(ax, grid, flags, maps.MARK, region_bins), marks_of(ax)

    def test_marks_of_a_tenth_of_the_map_cover_a_tenth_of_it(self):
        flags = np.random.default_rng(3).random((1200, 1200)) < 0.1
        how, opacity = self.marks(flags, flags.size)
        self.assertEqual(how, "share of each pixel")
        self.assertAlmostEqual(opacity.mean(), flags.mean())
        self.assertEqual(self.marks(flags[:100, :100], 10000)[0], "")  # each bin has a pixel

    def test_few_marks_are_enlarged_and_the_legend_says_so(self):
        flags = np.zeros((1200, 1200), bool)
        flags[600, 600] = True
        how, opacity = self.marks(flags, flags.size)
        self.assertEqual((how, opacity.sum()), ("single ones enlarged", 9))
        self.assertEqual(self.marks(flags[590:690, 590:690], 10000)[0], "")

    def test_a_plan_marks_what_is_uncovered(self):
        centers = (np.arange(601) - 300) * 0.1
        count = np.full((601, 601), 2)
        count[::4, ::4] = 0
        inside = np.ones((601, 601), np.int8)
        seen = np.where(count > 0, 1.5, np.nan)
        grid = files.MapGrid(centers, centers, 0.1)
        ax = plt.figure(figsize=(12, 12)).add_subplot()
        how = plot_plan.draw_map(ax, grid, np.where(count > 0, count, np.nan), ("returns per bin", "returns", {}),
                                 {"count": count, "in_region": inside, "first_seen": seen}, 20)
        self.assertEqual(how, "")  # each bin has a pixel, and is not enlarged
        self.assertEqual(marks_of(ax).sum(), 151 ** 2)
        self.assertEqual(notes_of(ax), "2 to 2")
        np.testing.assert_allclose(ax.images[0].get_clim(), [0, 2])


if __name__ == "__main__":
    unittest.main()
