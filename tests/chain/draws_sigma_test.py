# SPDX-License-Identifier: GPL-3.0-or-later
"""The spread that monte-carlo observes over its draws against the one that range noise and the uncertainty map predict."""
import json
import math
import unittest

import h5py
import numpy as np

from harness import ToolTest

DRAWS = 200
RANGE_SIGMA_M = 0.02
RESOLUTION_M = 0.1
REGRID = {"resolution_m": RESOLUTION_M, "half_width_m": 2}
EVAL = {"region_radius_m": 1.5, "footprint_m": 0.5}
NO_NAVIGATION = {key: [0, 0, 0] for key in ("position_m", "velocity_mps", "rpy_rad", "rpy_rate_radps")}
# The median of the sample's standard deviation over the true one is below 1 by 1 / (3 (n - 1)); each bin's has the
# standard error 1 / sqrt(2 (n - 1)), and the median of many that times 1.2533 / sqrt(bins).
ALLOWED = 3  # standard errors: one of 370 seeds fails a comparison, and the seed is fixed


def expected(draws):
    return 1 - 1 / (3 * (draws - 1))


def scan_of(half_width_m, rows):
    """A scan of images of a raster."""
    return {"detector": {"rows": 10, "columns": 10, "ifov_rad": 0.0012, "roll_deg": 7},
            "laser": {"pulse_rate_hz": 2000, "scan_time_s": rows * rows / 2000},
            "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": rows, "columns": rows, "half_width_m": half_width_m}},
            "trajectory": {"type": "constant_velocity", "position_m": [0, 0, 100], "velocity_mps": [0, 0, 0]},
            "noise": {"range_sigma_m": RANGE_SIGMA_M}}


class SpreadTest(ToolTest):
    def run_draws(self, slope, scan, changes):
        """The layers of a run of draws on a plane, and the paths of its inputs."""
        terrain, source, draws = self.path("terrain.h5"), self.path("scan.h5"), self.path("draws.h5")
        self.succeed("terrain-gen", "-c", self.config({
            "grid": {"half_width_m": 14, "resolution_m": 0.5}, "base": {"type": "plane", "slope_x": slope, "slope_y": 0}}, "terrain.json"), "-o", terrain, "-O")
        self.succeed("scan-sim", "-c", self.config(scan, "scan.json"), "--terrain", terrain, "-o", source, "-O")
        config = {"draws": DRAWS, "metrics": "verdict", "sigma": True, "regrid": REGRID, "eval": EVAL, **changes}
        self.succeed("monte-carlo", source, "--terrain", terrain, "-c", self.config(config, "mc.json"), "-o", draws, "-O", cwd=self.folder)
        with h5py.File(draws) as file:
            self.resolved = json.loads(file["provenance/config_json"][()])
            return {name: file[name][()] for name in file if isinstance(file[name], h5py.Dataset) and file[name].ndim == 2}

    def sum_of_squared_weights(self):
        """sum w^2 of the normalised weights of each bin's returns, from their true positions."""
        with h5py.File(self.path("scan.h5")) as file:
            x, y = (file[f"points/{name}"][()] / RESOLUTION_M for name in ("x_true", "y_true"))
        bins = int(2 * REGRID["half_width_m"] / RESOLUTION_M + 1.5)
        col, row = (np.floor(value + 0.5).astype(int) for value in (x, y))
        w = (1 - np.abs(x - col)) * (1 - np.abs(y - row))
        first = bins // 2
        inside = (np.abs(col) <= first) & (np.abs(row) <= first)
        index = (row[inside] + first) * bins + col[inside] + first
        total, squares = (np.bincount(index, power, bins * bins) for power in (w[inside], w[inside] ** 2))
        with np.errstate(invalid="ignore"):
            return (squares / total ** 2).reshape(bins, bins)

    def check_median(self, ratio, bins):
        known = np.sort(ratio[np.isfinite(ratio)])
        self.assertGreater(known.size, bins)
        error = 1.2533 / math.sqrt(2 * (DRAWS - 1) * known.size)
        self.assertLess(abs(np.median(known) - expected(DRAWS)), ALLOWED * error, f"median {np.median(known)}, standard error {error}")
        # Beside the median, the whole distribution: its width is that of a sample's standard deviation.
        self.assertAlmostEqual(np.std(known) * math.sqrt(2 * (DRAWS - 1)), 1, delta=0.1)

    def test_range_noise_alone_on_planes(self):
        for degrees in (0, 45):
            with self.subTest(degrees=degrees):
                layers = self.run_draws(math.tan(math.radians(degrees)), scan_of(2.2, 20), {})
                with h5py.File(self.path("scan.h5")) as file:
                    z = file["pulses/pz_true"][0]
                # Rays within 1.2 degrees of the vertical: |n_z| of the bin's direction from the lidar.
                at = (np.arange(41) - 20) * RESOLUTION_M
                height = z - math.tan(math.radians(degrees)) * at[None, :]
                n_z = height / np.sqrt(height ** 2 + at[None, :] ** 2 + at[:, None] ** 2)
                predicted = RANGE_SIGMA_M * n_z * np.sqrt(self.sum_of_squared_weights())
                self.check_median(layers["e_z_std"] / predicted, 1500)

    def test_the_prediction_is_that_of_regrid(self):
        layers = self.run_draws(0.3, scan_of(2.2, 20), {"draws": 2})
        self.succeed("regrid", self.path("scan.h5"), "-c", self.config(REGRID, "regrid.json"), "--uncertainty", "--terrain",
                     self.path("terrain.h5"), "-o", self.path("dem.h5"))
        with h5py.File(self.path("dem.h5")) as file:
            np.testing.assert_array_equal(layers["z_sigma_abs"], file["z_sigma_abs"][()])
            filled = file["count"][()] > 0
            np.testing.assert_array_equal(layers["z_true_map"][filled], file["z_true_map"][()][filled])
        np.testing.assert_allclose(layers["e_map_std_over_sigma"], layers["e_map_std"] / layers["z_sigma_abs"], rtol=1e-6)

    def test_navigation_sigmas_come_from_the_varied_keys(self):
        error = "scan.navigation_error."
        self.run_draws(0.3, scan_of(2.2, 20), {"draws": 3, "vary": {
            error + "velocity_mps.2": {"type": "normal", "sigma": 0.25}, error + "position_m.0": {"type": "uniform", "low": -0.3, "high": 0.3},
            error + "rpy_rad.1": {"type": "list", "values": [0.001, 0.002, 0.003]}}})
        self.assertEqual(self.resolved["regrid"]["uncertainty"], {"range_sigma_m": RANGE_SIGMA_M, "navigation_sigma": {
            **NO_NAVIGATION, "velocity_mps": [0, 0, 0.25], "position_m": [0.6 / math.sqrt(12), 0, 0], "rpy_rad": [0, 0.001, 0]}})

    def dithered_scan(self, dither_m):
        """Aims that are random within 0.4 m and equally dense everywhere, 30 returns per bin, wherever the dither moves the map. The 16
        pixels of a pulse lie 3.7 bins apart: the returns of a bin come from as many pulses."""
        cell, pulses = 0.4, 30  # of a cell: 16 returns each in 16 bins
        cols, rows = (math.ceil(2 * (REGRID["half_width_m"] + 0.8 + reach) / cell) for reach in (0, dither_m))
        at = np.repeat(np.arange(rows * cols), pulses)
        aims = (np.stack([at % cols - cols / 2, at // cols - rows / 2]) + np.random.default_rng(7).uniform(0, 1, (2, at.size))) * cell
        aims = np.random.default_rng(8).permutation(aims, axis=1)
        self.write("aims.csv", "t_s,x_m,y_m\n" + "".join(f"{k / 20000},{x},{y}\n" for k, (x, y) in enumerate(aims.T)))
        scan = scan_of(0, 0)
        scan["detector"].update(rows=4, columns=4, ifov_rad=0.0037)
        scan["laser"] = {"pulse_rate_hz": 20000, "scan_time_s": at.size / 20000}
        scan["scanner"]["pattern"] = {"type": "table", "path": self.path("aims.csv")}
        return scan

    def test_positions_dithered_over_many_bins(self):
        """The map is moved along the contours of a slope, by another of as many bins in each draw: each draw has other returns in a bin, so
        that the spread of the map's error includes their distance to the bin's centre."""
        for degrees, draws in ((0, 100), (45, 150)):
            with self.subTest(degrees=degrees):
                dither_m = draws * RESOLUTION_M / 2
                steps = np.random.default_rng(5).permutation((np.arange(draws) + 0.5) / draws * 2 * dither_m - dither_m)
                layers = self.run_draws(math.tan(math.radians(degrees)), self.dithered_scan(dither_m), {
                    "draws": draws, "regrid": {**REGRID, "uncertainty": {"navigation_sigma": NO_NAVIGATION}},
                    "vary": {"scan.navigation_error.position_m.1": {"type": "list", "values": list(steps)}}})
                # The bins of a column meet the same strip of the ground, those of other columns do not.
                columns = np.median(layers["e_map_std_over_sigma"], axis=0)
                error = np.std(columns, ddof=1) / math.sqrt(columns.size)
                median = np.median(layers["e_map_std_over_sigma"])
                self.assertLess(error, 0.007)
                self.assertLess(abs(median - expected(draws)), ALLOWED * error, f"median {median}, standard error {error}")

    def test_range_noise_that_is_not_uniform_is_refused(self):
        self.run_draws(0.3, scan_of(2.2, 20), {"draws": 2})
        self.refuse(2, "monte-carlo", self.path("scan.h5"), "--terrain", self.path("terrain.h5"), "-c", self.path("mc.json"), "-o",
                    self.path("no.h5"),
                    "--set", "scan.noise.range_sigma_per_m=0.001", words=["has range noise that is not uniform"], output=self.path("no.h5"))


if __name__ == "__main__":
    unittest.main()
