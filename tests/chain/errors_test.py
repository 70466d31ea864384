#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""All error models at once: the same bytes at any number of threads, and none changes the random draws of another."""
import copy
import json
import unittest

import h5py
import numpy as np

from harness import ChainTest, columns, config_of, read_bytes

SCAN = {
    "detector": {"rows": 4, "columns": 6, "ifov_rad": 0.0022},
    "laser": {"pulse_rate_hz": 2000, "scan_time_s": 0.2},
    # Wider than the terrain, so that there are misses.
    "scanner": {"type": "fsm", "encoder_sigma_rad": 2e-4,
                "pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 12}},
    "trajectory": {"type": "constant_velocity", "position_m": [0.5, -0.3, 50], "velocity_mps": [0.4, 0.2, -5]},
    # False returns are nearer than all true ones, so that the rows that they replace do not depend on ranges.
    "noise": {"range_sigma_m": 0.01, "range_sigma_per_m": 1e-4, "incidence_sigma_rad": 6e-4, "range_bias_m": 0.02,
              "dead_pixel_frac": 0.3, "dropout_frac": 0.1, "false_return_frac": 0.1, "false_range_m": [5, 40]},
    "pointing_error": {"misalignment_rpy_rad": [1e-3, -2e-3, 1e-3], "jitter_sigma_rad": [2e-4, 1e-4], "jitter_time_s": 0.005,
                       "time_stamp_bias_s": 0.002, "time_stamp_sigma_s": 1e-4, "mirror_time_bias_s": 2e-5,
                       "mirror_time_sigma_s": 1e-5},
    "navigation_error": {"position_m": [0.1, 0, 0], "velocity_mps": [0.1, 0.2, 0.3], "rpy_rad": [1e-4, 0, 0],
                         "rpy_rate_radps": [0, 1e-4, 0],
                         "random_walk": {"position_m_per_sqrt_s": [0.02, 0.02, 0.02],
                                         "velocity_mps_per_sqrt_s": [0.1, 0.1, 0.1],
                                         "rpy_rad_per_sqrt_s": [1e-4, 1e-4, 1e-4]},
                         "gauss_markov": {"position_sigma_m": [0.05, 0.05, 0.02], "position_time_s": 0.5,
                                          "velocity_sigma_mps": [0.1, 0.1, 0.1], "velocity_time_s": 2,
                                          "rpy_sigma_rad": [1e-4, 1e-4, 1e-4], "rpy_time_s": 0.1}},
    "seed": 3,
}
OFF = {"noise.range_sigma_m": 0, "noise.range_sigma_per_m": 0, "noise.incidence_sigma_rad": 0,
       "noise.dead_pixel_frac": 0, "noise.dropout_frac": 0, "noise.false_return_frac": 0,
       "scanner.encoder_sigma_rad": 0, "pointing_error.jitter_sigma_rad": 0, "pointing_error.time_stamp_sigma_s": 0,
       "pointing_error.mirror_time_sigma_s": 0,
       "navigation_error.random_walk": {}, "navigation_error.gauss_markov": {}}
RANGE_NOISE = ["noise.range_sigma_m", "noise.range_sigma_per_m", "noise.incidence_sigma_rad"]
TRUTH = ["x_true", "y_true", "z_true", "range_true"]
POSITION = ["px_est", "py_est", "pz_est"]
ESTIMATE = [*POSITION, "qw_est", "qx_est", "qy_est", "qz_est"]


def scan_config(off=()):
    config = copy.deepcopy(SCAN)
    for path in off:
        group, key = path.split(".")
        config[group][key] = OFF[path]
    return config


class Scan:
    """The columns of a scan made with --keep-misses."""

    def __init__(self, path):
        self.points, self.pulses = columns(path, "points"), columns(path, "pulses")
        self.status = self.points["status"]

    def position_error(self):
        return np.array([self.pulses[f"p{axis}_true"] - self.pulses[f"p{axis}_est"] for axis in "xyz"])


def same(a, b, names, rows=slice(None)):
    return all(np.array_equal(a[name][rows], b[name][rows], equal_nan=True) for name in names)


class Errors(ChainTest):
    def scan(self, name, config, *options):
        path = self.path(name)
        self.succeed("scan-sim", "-c", self.config(config), "--terrain", self.chain.terrain, "-O", "-o", path, *options)
        return path

    def without(self, *off):
        return Scan(self.scan("some.h5", scan_config(off), "--keep-misses"))

    def test_every_status_occurs_and_is_counted(self):
        path = self.scan("all.h5", SCAN, "--keep-misses")
        status = columns(path, "points")["status"]
        with h5py.File(path) as file:
            for code, name in ((0, "return"), (1, "miss"), (2, "dropout"), (3, "dead"), (6, "false_return")):
                self.assertGreater((status == code).sum(), 20, name)
                self.assertEqual(file["points"].attrs[name + "_count"], (status == code).sum())

    def test_regrid_accepts_false_returns(self):
        scan, dem = self.scan("scan.h5", SCAN), self.path("dem.h5")
        self.succeed("regrid", scan, "--terrain", self.chain.terrain, "-c", self.chain.config("regrid"), "-O", "-o", dem)
        points = columns(scan, "points")
        self.assertTrue(np.isfinite(np.array([points[name] for name in ("x_true", "y_true", "z_true")])).all())
        missed = np.isnan(points["range_true"])
        self.assertGreater(missed.sum(), 5)
        self.assertTrue((points["status"][missed] == 6).all())

    def test_a_plan_with_all_errors(self):
        result = json.loads(self.succeed("scan-sim", "--plan", "-c", self.config(SCAN), "--json").stdout)
        self.assertGreater(result["plan"]["returns"]["count"], 1000)

    def test_range_noise_changes_only_the_measured_range_of_returns(self):
        every, some = self.without(), self.without(*RANGE_NOISE)
        self.assertTrue(same(every.points, some.points, [*TRUTH, "status"]))
        self.assertTrue(same(every.points, some.points, ["range_measured"], every.status != 0))
        self.assertTrue(same(every.pulses, some.pulses, every.pulses))
        hit = every.status == 0
        self.assertTrue((every.points["range_measured"] != some.points["range_measured"])[hit].all())

    def test_both_range_noise_terms_scale_the_same_draws(self):
        sigma, per_metre = self.without(*RANGE_NOISE[1:]), self.without(RANGE_NOISE[0], RANGE_NOISE[2])
        hit = sigma.status == 0
        unit = [(scan.points["range_measured"] - scan.points["range_true"] - 0.02)[hit] for scan in (sigma, per_metre)]
        np.testing.assert_allclose(unit[0] / 0.01, unit[1] / (1e-4 * sigma.points["range_true"][hit]), atol=1e-9)

    def test_losses_change_only_the_rows_that_they_replace(self):
        every = self.without()
        for key, code in (("noise.dropout_frac", 2), ("noise.dead_pixel_frac", 3), ("noise.false_return_frac", 6)):
            some = self.without(key)
            taken = every.status == code
            self.assertGreater(taken.sum(), 20, key)
            self.assertTrue(same(every.points, some.points, every.points, ~taken), key)
            self.assertFalse((some.status == code).any(), key)
            self.assertTrue(same(every.pulses, some.pulses, every.pulses), key)

    def test_jitter_and_the_mirror_clock_move_true_beams_and_change_no_draw(self):
        every = self.without(*RANGE_NOISE[1:])
        angles = {"angle_1", "angle_2"}
        for key, moved in (("pointing_error.jitter_sigma_rad", set()), ("pointing_error.mirror_time_sigma_s", angles)):
            some = self.without(*RANGE_NOISE[1:], key)
            self.assertTrue(same(every.pulses, some.pulses, set(every.pulses) - moved), key)
            self.assertEqual(any((every.pulses[name] != some.pulses[name]).any() for name in moved), bool(moved), key)
            struck = ~np.isnan(every.points["range_true"]) & ~np.isnan(some.points["range_true"])
            self.assertGreater((every.points["range_true"] != some.points["range_true"])[struck].mean(), 0.9, key)
            self.assertTrue((every.status == some.status)[struck].all(), key)
            hit = struck & (every.status == 0)
            noise = [(scan.points["range_measured"] - scan.points["range_true"])[hit] for scan in (every, some)]
            np.testing.assert_allclose(noise[0], noise[1], atol=1e-12)

    def test_time_stamps_and_navigation_move_only_the_estimate(self):
        every = self.without()
        for key in ("pointing_error.time_stamp_sigma_s", "navigation_error.random_walk", "navigation_error.gauss_markov"):
            some = self.without(key)
            self.assertTrue(same(every.points, some.points, [*TRUTH, "status", "range_measured", "pulse", "pixel"]), key)
            self.assertTrue(same(every.pulses, some.pulses, set(every.pulses) - set(ESTIMATE)), key)
            self.assertFalse(same(every.pulses, some.pulses, POSITION), key)

    def test_random_walk_and_gauss_markov_errors_add_up(self):
        stamps = "pointing_error.time_stamp_sigma_s"
        walk, markov = "navigation_error.random_walk", "navigation_error.gauss_markov"
        both, no_walk, no_markov, neither = (self.without(stamps, *off).position_error()
                                             for off in ((), (walk,), (markov,), (walk, markov)))
        np.testing.assert_allclose(both - no_walk, no_markov - neither, atol=1e-12)
        self.assertGreater(np.abs(both - no_walk).max(), 1e-3)

    def test_estimated_poses_from_a_table(self):
        """A table of estimated poses, here the true ones, is accepted; one that is too short is refused."""
        config = scan_config(OFF)
        config["noise"], config["pointing_error"] = {}, {}
        rows = [f"{t},{0.5 + 0.4 * t},{-0.3 + 0.2 * t},{50 - 5 * t},1,0,0,0" for t in (0, 0.1, 0.2)]
        for name, count in (("nav.csv", 3), ("short.csv", 2)):
            self.write(name, "\n".join(["t_s,x_m,y_m,z_m,qw,qx,qy,qz", *rows[:count]]) + "\n")
        config["navigation_error"] = {"table": self.path("nav.csv")}
        with_table = Scan(self.scan("table.h5", config, "--keep-misses"))
        self.assertEqual(config_of(self.path("table.h5"))["navigation_error"]["table"], "nav.csv")
        for est in POSITION:
            np.testing.assert_allclose(with_table.pulses[est], with_table.pulses[est.replace("est", "true")], atol=1e-12)
        config["navigation_error"] = {}
        self.scan("source.h5", config, "--keep-misses")
        config["navigation_error"] = {"table": self.path("nav.csv")}
        self.scan("replayed.h5", config, "--keep-misses", "--ranges-from", self.path("source.h5"))
        self.assertEqual(read_bytes(self.path("table.h5")), read_bytes(self.path("replayed.h5")))
        config["navigation_error"] = {"table": self.path("short.csv")}
        self.refuse(1, "scan-sim", "-c", self.config(config), "--terrain", self.chain.terrain, "-o", self.path("no.h5"),
                    words=["short.csv", "navigation table"], output=self.path("no.h5"))


if __name__ == "__main__":
    unittest.main()
