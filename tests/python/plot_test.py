#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_dem.py and plot_eval.py on small files that the tests make."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

PYTHON = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python")
sys.path.insert(0, PYTHON)
sys.dont_write_bytecode = True

from landfall import files, maps, plots, reduction
import matplotlib.pyplot as plt

BINS = 41
RESOLUTION_M = 0.5
RADIUS_M = 9.0
PICTURES = ["accuracy", "coverage", "elevation_error", "verdict"]


def start_file(path, format_name, complete=1):
    file = h5py.File(path, "w")
    file.attrs["format_name"] = format_name
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


class ScriptTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def call(self, script, *arguments):
        command = [sys.executable, os.path.join(PYTHON, "commands", script), *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=False, cwd=self.folder)

    def expect_success(self, script, *arguments):
        done = self.call(script, *arguments)
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

    def expect_picture(self, name, minimum_width_px=1000):
        image = plt.imread(self.path(name))
        self.assertGreaterEqual(image.shape[1], minimum_width_px)
        self.assertGreater(image[..., :3].std(), 0.03, f"{name} is nearly blank")
        self.assertEqual([f for f in os.listdir(self.folder) if f.endswith(".tmp")], [])


class PlotDemTest(ScriptTest):
    def test_the_default_figure_is_beside_the_dem(self):
        make_dem(self.path("dem.h5"))
        self.assertEqual(self.expect_success("plot_dem.py", self.path("dem.h5")), [self.path("dem-figure.png")])
        self.expect_picture("dem-figure.png", 2000)

    def test_dpi_sets_the_size(self):
        make_dem(self.path("dem.h5"))
        self.expect_success("plot_dem.py", "dem.h5", "--dpi", "100", "-o", "small.png")
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
            with open(self.path(name), "rb") as file:
                pictures.append(file.read())
        self.assertEqual(*pictures)

    def test_existing_figure_is_kept_without_overwrite(self):
        make_dem(self.path("dem.h5"))
        with open(self.path("dem-figure.png"), "w", encoding="utf-8") as file:
            file.write("mine")
        self.expect_failure(2, "output dem-figure.png exists", "plot_dem.py", "dem.h5")
        with open(self.path("dem-figure.png"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "mine")
        self.expect_success("plot_dem.py", "dem.h5", "-O")
        self.expect_picture("dem-figure.png")

    def test_data_errors(self):
        self.expect_failure(1, "dem.h5: no such file", "plot_dem.py", "dem.h5")
        with open(self.path("text.h5"), "w", encoding="utf-8") as file:
            file.write("not HDF5")
        self.expect_failure(1, "text.h5: not a readable HDF5 file", "plot_dem.py", "text.h5")
        make_evaluation(self.path("eval.h5"))
        self.expect_failure(1, "expected 'landfall.dem'", "plot_dem.py", "eval.h5")
        make_dem(self.path("unfinished.h5"), complete=0)
        self.expect_failure(1, "never finished", "plot_dem.py", "unfinished.h5")
        with start_file(self.path("bare.h5"), "landfall.dem"):
            pass
        self.expect_failure(1, "z_est", "plot_dem.py", "bare.h5")

    def test_truncated_file(self):
        make_dem(self.path("dem.h5"))
        with open(self.path("dem.h5"), "r+b") as file:
            file.truncate(os.path.getsize(self.path("dem.h5")) // 2)
        self.expect_failure(1, "dem.h5: not a readable HDF5 file", "plot_dem.py", "dem.h5")

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


class PlotEvalTest(ScriptTest):
    def expect_pictures(self, prefix, names):
        self.assertEqual(sorted(os.path.basename(f) for f in os.listdir(self.folder) if f.endswith(".png")),
                         sorted(f"{prefix}{name}.png" for name in names))
        for name in names:
            self.expect_picture(f"{prefix}{name}.png")

    def test_draws_all_figures(self):
        make_evaluation(self.path("eval.h5"))
        self.expect_success("plot_eval.py", "eval.h5")
        self.expect_pictures("eval-", PICTURES)

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
        self.expect_success("plot_eval.py", "eval.h5", "-o", self.path("new/"))
        self.assertEqual(sorted(os.listdir(self.path("new"))), sorted(f"{name}.png" for name in PICTURES))
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
        with open(self.path("eval-verdict.png"), "w", encoding="utf-8") as file:
            file.write("mine")
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


class ReductionTest(unittest.TestCase):
    def test_extreme_keeps_the_sign_and_single_values(self):
        values = np.zeros((7, 9))
        values[6, 8] = -3
        values[0, :3] = [1, -2, np.nan]
        reduced = reduction.shrink_extreme(values, 3)
        self.assertEqual(reduced.shape, (3, 3))
        self.assertEqual((reduced[0, 0], reduced[2, 2], reduced[1, 1]), (-2, -3, 0))

    def test_blocks_without_a_value_stay_empty(self):
        values = np.full((4, 4), np.nan)
        values[0, 0], values[1, 1] = 1, 2
        for name, expected in (("shrink_extreme", 2), ("shrink_mean", 1.5)):
            reduced = getattr(reduction, name)(values, 2)
            self.assertEqual(reduced[0, 0], expected)
            self.assertTrue(np.isnan(reduced[0, 1]) and np.isnan(reduced[1, 1]))

    def test_a_single_flag_stays_visible_anywhere(self):
        for row, col in ((0, 0), (1000, 1001), (2000, 2000)):
            flags = np.zeros((2001, 2001), bool)
            flags[row, col] = True
            marks, size = reduction.shrink_marks(flags, 400)
            self.assertTrue(marks[row // size, col // size])
            self.assertLessEqual(max(marks.shape), 400)
            self.assertGreaterEqual(marks.sum(), 9)

    def test_enlarge_makes_squares(self):
        flags = np.zeros((9, 9), bool)
        flags[4, 3] = True
        expected = np.zeros((9, 9), bool)
        expected[2:7, 1:6] = True
        np.testing.assert_array_equal(reduction.enlarge(flags, 2), expected)
        np.testing.assert_array_equal(reduction.enlarge(flags, 0), flags)


class ScaleTest(unittest.TestCase):
    def test_signed_scales_are_symmetric(self):
        scale = maps.signed_scale(np.array([[-0.03, 0.1], [np.nan, 0]]))
        self.assertEqual((scale.low_m, scale.high_m, scale.unit[0]), (-0.1, 0.1, "cm"))

    def test_rounding_noise_gets_no_colour(self):
        scale = maps.signed_scale(np.array([[1e-13, -1e-13]]))
        self.assertEqual(scale.high_m, 1e-3)

    def test_scale_bar_lengths(self):
        for span, length in ((20.0, 20.0), (19.9, 10.0), (0.7, 0.5), (4.9, 2.0)):
            self.assertAlmostEqual(maps.round_length_m(span), length)

    def test_lengths_are_written_with_a_fitting_unit(self):
        for value, text in ((1.381, "1.38 m"), (0.0831, "8.31 cm"), (-0.0026, "-2.6 mm"), (0.0, "0 mm"),
                            (1e-13, "< 1 µm"), (None, "–")):
            self.assertEqual(plots.metres(value), text)


class ZoomTest(unittest.TestCase):
    def setUp(self):
        centers = np.arange(-10, 11) * 1.0
        self.grid = files.MapGrid(centers, centers, 1.0)

    def test_the_window_stays_inside_the_map(self):
        window, rows, cols = maps.zoom_window(self.grid, (10.0, 0.0), 4.0)
        self.assertEqual((window.x[0], window.x[-1], window.y[0], window.y[-1]), (6, 10, -2, 2))
        self.assertEqual((rows, cols), (slice(8, 13), slice(16, 21)))

    def test_largest_bin(self):
        values = np.full((21, 21), np.nan)
        self.assertEqual(maps.largest_bin(self.grid, values), (0.0, 0.0))
        values[3, 15], values[4, 4] = -2, 1
        self.assertEqual(maps.largest_bin(self.grid, values), (5.0, -7.0))


if __name__ == "__main__":
    unittest.main()
