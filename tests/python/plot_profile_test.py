#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_profile.py on small DEMs that the tests make."""
import math
import os
import tempfile
import unittest

import h5py
import numpy as np

from harness.commands import run_command
from landfall import files
from landfall.errors import UsageError
from landfall.plot import plot_dem, plot_profile
import matplotlib.pyplot as plt

RESOLUTION_M = 0.5
X, Y = (np.arange(61) - 30) * RESOLUTION_M, (np.arange(41) - 20) * RESOLUTION_M + 100  # 30.5 x 20.5 m about (0, 100)
GRID = files.MapGrid(X, Y, RESOLUTION_M)
SLOPE_X, SLOPE_Y = 0.3, -0.2


def plane(x, y):
    return 7 + SLOPE_X * x + SLOPE_Y * y


def make_dem(path, truth=True, empty=()):
    true = plane(X[None, :], Y[:, None])
    estimated = true - 0.02
    estimated[20, 30:] -= 0.06  # the row y = 100 from x = 0 on: an error of 8 cm
    for row, col in empty:
        true[row, col] = estimated[row, col] = np.nan
    with h5py.File(path, "w") as file:
        file.attrs.update({"format_name": "landfall.dem", "format_version": "1.0", "complete": np.int32(1)})
        file["x"], file["y"], file["z_est"] = X, Y, estimated
        if truth:
            file["z_true"] = true


class BinsUnderTest(unittest.TestCase):
    """The bins under a line, against closed forms of a tilted plane and a search in small steps."""

    def test_along_a_row_through_bin_centres_the_profile_is_the_plane(self):
        bins = plot_profile.bins_under(GRID, (-10, 98), (10, 98))
        z = bins.of(plane(X[None, :], Y[:, None]))
        # The first and the last bin are half covered: the middles of their parts are a quarter of a bin from their centres.
        np.testing.assert_allclose(bins.at_m[1:-1], np.arange(1, 40) * RESOLUTION_M)
        np.testing.assert_allclose(z[1:-1], plane(-10 + bins.at_m[1:-1], 98))
        np.testing.assert_allclose(bins.at_m[[0, -1]], [0.125, 19.875])
        np.testing.assert_allclose(z[[0, -1]], plane(np.array([-10, 10]), 98))
        self.assertEqual(bins.length_m, 20)

    def test_across_the_bins_the_profile_is_the_plane_at_their_centres(self):
        start, end = (-14.9, 91.3), (13.7, 108.8)
        bins = plot_profile.bins_under(GRID, start, end)
        z = bins.of(plane(X[None, :], Y[:, None]))
        share = bins.at_m / bins.length_m
        x, y = start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])
        np.testing.assert_allclose(z, plane(X[bins.cols], Y[bins.rows]), rtol=1e-12)
        half = RESOLUTION_M / 2
        self.assertLessEqual(np.abs(z - plane(x, y)).max(), half * (abs(SLOPE_X) + abs(SLOPE_Y)))
        self.assertLessEqual(np.abs(X[bins.cols] - x).max(), half)
        self.assertLessEqual(np.abs(Y[bins.rows] - y).max(), half)
        self.assertEqual(bins.length_m, math.hypot(28.6, 17.5))

    def test_every_bin_of_random_lines_once_and_in_order(self):
        generator = np.random.default_rng(5)
        for _ in range(20):
            start, end = (tuple(generator.uniform((-15.25, 89.75), (15.25, 110.25))) for _ in range(2))
            bins = plot_profile.bins_under(GRID, start, end)
            share = np.linspace(0, 1, 200001)
            points = [np.array(start)[k] + share * (end[k] - start[k]) for k in (0, 1)]
            col, row = (np.round((p - a[0]) / RESOLUTION_M).astype(int) for p, a in zip(points, (X, Y)))
            first = np.flatnonzero(np.append(True, (np.diff(row) != 0) | (np.diff(col) != 0)))
            stepped, found = list(zip(row[first], col[first])), list(zip(bins.rows, bins.cols))
            # Steps of 0.2 mm may miss a corner of a bin, and no more.
            self.assertTrue(set(stepped) <= set(found))
            self.assertLessEqual(len(found) - len(stepped), 1)
            self.assertEqual([bin for bin in found if bin in stepped], stepped)
            self.assertTrue((np.diff(bins.at_m) > 0).all())

    def test_back_and_forth(self):
        there = plot_profile.bins_under(GRID, (-3.1, 95.2), (8.3, 104.9))
        back = plot_profile.bins_under(GRID, (8.3, 104.9), (-3.1, 95.2))
        np.testing.assert_array_equal(there.rows, back.rows[::-1])
        np.testing.assert_allclose(there.at_m, there.length_m - back.at_m[::-1])

    def test_the_borders_of_the_map_belong_to_its_last_bins(self):
        for start, end, rows, cols in (((-15.25, 110.25), (15.25, 110.25), {40}, set(range(61))),
                                       ((15.25, 89.75), (15.25, 110.25), set(range(41)), {60}),
                                       ((-15.25, 89.75), (15.25, 89.75), {0}, set(range(61)))):
            bins = plot_profile.bins_under(GRID, start, end)
            self.assertEqual((set(bins.rows), set(bins.cols)), (rows, cols))

    def test_a_line_within_a_bin(self):
        bins = plot_profile.bins_under(GRID, (0.1, 100.1), (0.2, 100.1))
        self.assertEqual((list(bins.rows), list(bins.cols)), ([20], [30]))
        self.assertAlmostEqual(bins.at_m[0], 0.05)


class FigureTest(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.addCleanup(plt.close, "all")
        self.dem = os.path.join(self.folder, "dem.h5")

    def draw(self, *arguments, **style):
        make_dem(self.dem, **style)
        options = plot_profile.parse([self.dem, *arguments])
        grid, layers = plot_dem.read(options.dem)
        plot_profile.require_inside(options, grid)
        return plot_profile.draw(grid, layers, options).axes

    def test_elevations_and_error_of_the_plane(self):
        elevations, error, inset = self.draw("--from", "-10,100", "--to", "10,100")
        true, _, estimated, _ = (line.get_ydata() for line in elevations.lines)
        # From centre to centre, with a half bin at each end.
        np.testing.assert_allclose(true, plane(np.arange(-10, 10.1, RESOLUTION_M), 100))
        np.testing.assert_allclose(true - estimated, np.where(np.arange(41) >= 20, 0.08, 0.02))
        np.testing.assert_allclose(error.lines[0].get_ydata(), np.where(np.arange(41) >= 20, 8, 2))
        self.assertEqual([line.get_ydata()[0] for line in error.lines[2:]], [5, -5])
        self.assertEqual(error.get_ylabel(), "true - estimated (cm)")
        rms = math.sqrt((20 * 4 + 21 * 64) / 41)
        self.assertEqual(error.get_title(), f"error e_z: largest 8 cm, root mean square {rms:.3g} cm, 21 bins beyond ±5 cm")
        self.assertEqual(elevations.get_title(), "41 bins along 20.00 m")
        line = next(line for line in inset.lines if line.get_gid() == "line")
        self.assertEqual((list(line.get_xdata()), list(line.get_ydata())), ([-10, 10], [100, 100]))

    def test_the_limit_is_an_option_and_always_in_the_diagram(self):
        _, error, _ = self.draw("--from", "-10,98", "--to", "10,98", "--limit-m", "0.2")
        self.assertEqual([line.get_ydata()[0] for line in error.lines[2:]], [20, -20])
        np.testing.assert_allclose(error.get_ylim(), [-23, 23])
        self.assertIn("limit ±20 cm of the relative error", [text.get_text() for text in error.get_legend().get_texts()])
        self.assertIn("0 bins beyond", error.get_title())

    def test_bins_without_a_return_are_gaps_and_what_is_alone_is_a_dot(self):
        elevations, error, _ = self.draw("--from", "-10,98", "--to", "10,98", empty=[(16, 20), (16, 22)])
        values = error.lines[0].get_ydata()
        self.assertEqual(list(np.flatnonzero(np.isnan(values))), [10, 12])
        np.testing.assert_allclose(error.lines[1].get_ydata(), [2])  # cm
        np.testing.assert_allclose(error.lines[1].get_xdata(), [5.5])
        self.assertEqual(elevations.get_title(), "41 bins along 20.00 m, 2 of them without a return")

    def test_a_line_without_any_value(self):
        _, error, _ = self.draw("--from", "-10,98", "--to", "10,98", empty=[(16, col) for col in range(61)])
        self.assertEqual(error.get_title(), "error e_z: no value on the line")

    def test_without_truth_only_the_estimate(self):
        axes = self.draw("--from", "-10,98", "--to", "10,98", truth=False)
        self.assertEqual(len(axes), 2)
        self.assertEqual([text.get_text() for text in axes[0].get_legend().get_texts()], ["estimated elevation z_est"])
        self.assertIn("this DEM has no truth layer", axes[0].get_title())

    def test_ends_outside_the_map(self):
        for arguments, message in ((("--from", "-15.3,100", "--to", "0,100"), "--from: x = -15.3 m is outside the map, [-15.25, 15.25] m"),
                                   (("--from", "0,100", "--to", "0,89.7"), "--to: y = 89.7 m is outside the map, [89.75, 110.25] m")):
            with self.assertRaises(UsageError) as caught:
                self.draw(*arguments)
            self.assertEqual(str(caught.exception), f"{self.dem}: {message}")
        self.draw("--from", "-15.25,89.75", "--to", "15.25,110.25")  # from corner to corner


class ScriptTest(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.dem = os.path.join(self.folder, "dem.h5")
        make_dem(self.dem)

    def run_script(self, *arguments):
        return run_command("plot_profile", *arguments, cwd=self.folder)

    def test_draws_beside_the_dem(self):
        done = self.run_script(self.dem, "--from", "-5,95", "--to", "5,-.5e2", "--dpi", "60")
        self.assertEqual(done.returncode, 2)
        done = self.run_script(self.dem, "--from", "-5,95", "--to", "5,105", "--dpi", "60")
        self.assertEqual((done.returncode, done.stderr, done.stdout), (0, "", self.dem.replace("dem.h5", "dem-profile.png\n")))
        self.assertEqual(plt.imread(done.stdout.strip()).shape[1], 960)

    def test_usage_errors(self):
        for arguments, message in ((("--to", "1,100"), "required: --from"),
                                   (("--from", "1", "--to", "1,100"), "--from: '1' is not X,Y in metres"),
                                   (("--from", "1,nan", "--to", "1,100"), "--from: '1,nan' is not X,Y in metres"),
                                   (("--from", "1,100", "--to", "1,100"), "--from and --to are the same point"),
                                   (("--from", "1,100", "--to", "99,100"), "dem.h5: --to: x = 99 m is outside the map"),
                                   (("--from", "1,100", "--to", "1,105", "-o", "a.jpg"), "must end in .png"),
                                   (("--from", "1,100", "--to", "1,105", "-o", "no/a.png"), "folder no does not exist")):
            done = self.run_script(self.dem, *arguments)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
            self.assertIn(message, done.stderr)
        self.assertEqual(os.listdir(self.folder), ["dem.h5"])


if __name__ == "__main__":
    unittest.main()
