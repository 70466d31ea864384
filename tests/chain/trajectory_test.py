#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Trajectories through the chain: attitude conventions, a rover, an attitude limit cycle.

The Python code of docs/reference/attitudes.md is run as printed. LANDFALL_TEST_SEED is the seed of the attitudes.
"""
import json
import os
import re
import unittest

import h5py
import numpy as np

from harness import CONFIGS, ToolTest, columns, read_bytes, returns_of
from oracle import surface
from oracle.frames import about, matrix_of_quaternion

SEED = int(os.environ.get("LANDFALL_TEST_SEED", "20240607"))
PAGE = os.path.join(os.environ["LANDFALL_ROOT"], "docs", "reference", "attitudes.md")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", read_bytes(PAGE).decode(), re.DOTALL)


DOC = {}
for source in blocks("python")[:2]:
    exec(compile(source, PAGE, "exec"), DOC)  # pylint: disable=exec-used


AXES = np.eye(3)


def tilde(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


class Conventions(ToolTest):
    """R_dem_body by the formula of each convention; scan-sim must report that attitude within 1e-12."""

    def setUp(self):
        super().setUp()
        print(f"LANDFALL_TEST_SEED={SEED}")
        self.random = np.random.default_rng(SEED)
        self.ground = self.path("ground.h5")
        self.succeed("terrain-gen", "-c", self.config({"grid": {"half_width_m": 60, "resolution_m": 1}}), "-o",
                     self.ground)
        self.positions = self.random.uniform(-3, 3, (5, 3)) + [0, 0, 50]

    def poses(self, path):
        scan = self.path("scan.h5")
        self.succeed("scan-sim", "--terrain", self.ground, "-o", scan, "-O", "--keep-misses", "-c", self.config(
            {"detector": {"rows": 1, "columns": 1}, "laser": {"pulse_rate_hz": 4, "scan_time_s": 1.25},
             "scanner": {"type": "flash"}, "trajectory": {"type": "table", "path": path}}))
        pulses = columns(scan, "pulses")
        return (np.column_stack([pulses[f"p{axis}_true"] for axis in "xyz"]),
                np.column_stack([pulses[f"q{part}_true"] for part in "wxyz"]))

    def check(self, matrices, names, attitudes):
        table = dict(zip(["t_s", "x_m", "y_m", "z_m"], [7 + np.arange(5) / 4, *self.positions.T]))
        table |= dict(zip(names, np.transpose(attitudes)))
        csv, h5 = self.path("t.csv"), self.path("t.h5")
        DOC["write_csv"](csv, **table)
        with h5py.File(h5, "w") as file:
            for name, values in table.items():
                file[name] = values
        for path in (csv, h5):
            with self.subTest(names=names, path=path):
                positions, quaternions = self.poses(path)
                np.testing.assert_allclose(positions, self.positions, rtol=0, atol=1e-12)
                for R, q in zip(matrices, quaternions):
                    np.testing.assert_allclose(matrix_of_quaternion(q), R, rtol=0, atol=1e-12)

    def test_roll_pitch_yaw(self):
        angles = self.random.uniform([-40, -40, -180], [40, 40, 180], (5, 3))
        matrices = [about(AXES[2], y) @ about(AXES[1], p) @ about(AXES[0], r) for r, p, y in np.radians(angles)]
        self.check(matrices, ["roll_deg", "pitch_deg", "yaw_deg"], angles)

    def some_matrices(self):
        angles = np.radians(self.random.uniform([-40, -40, -180], [40, 40, 180], (5, 3)))
        return [about(AXES[2], y) @ about(AXES[0], r) @ about(AXES[1], p) for r, p, y in angles]

    def test_direction_cosine_matrices(self):
        matrices = self.some_matrices()
        self.check(matrices, ["qw", "qx", "qy", "qz"], [DOC["from_dcm"](R) for R in matrices])
        in_rows = [np.array([R @ axis for axis in np.eye(3)]) for R in matrices]  # the rows are the body's axes in D
        self.check(matrices, ["qw", "qx", "qy", "qz"], [DOC["from_dcm"](C.T) for C in in_rows])

    def quaternions(self):
        """Quaternions (x, y, z, w) of small tilts, of either sign."""
        q = np.column_stack([self.random.uniform(-0.3, 0.3, (5, 2)), self.random.uniform(-1, 1, (5, 2))])
        return q / np.linalg.norm(q, axis=1)[:, None]

    def test_quaternions(self):
        q = self.quaternions()
        names = ["qw", "qx", "qy", "qz"]
        hamilton = list(matrix_of_quaternion(np.roll(q, 1, axis=1)))
        self.check(hamilton, names, [DOC["from_scalar_last"](p) for p in q])
        self.check([R.T for R in hamilton], names, [DOC["inverse"]([p[3], *p[:3]]) for p in q])
        # Shuster's matrix of a quaternion transforms DEM components into body components.
        shuster = [(w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) - 2 * w * tilde(v)
                   for v, w in ((p[:3], p[3]) for p in q)]
        self.check([A.T for A in shuster], names, [DOC["from_scalar_last"](p) for p in q])

    def test_modified_rodrigues_parameters_and_shadow_sets(self):
        q = self.quaternions()
        sigma = q[:, :3] / (1 + q[:, 3:])  # either set: |sigma| may exceed 1
        def bn(s):
            n, t = s @ s, tilde(s)
            return np.eye(3) + (8 * t @ t - 4 * (1 - n) * t) / (1 + n) ** 2
        self.check([bn(s).T for s in sigma], ["mrp_1", "mrp_2", "mrp_3"], sigma)


class Rover(ToolTest):
    def test_the_ground_ahead_is_mapped(self):
        terrain, path, scan, dem = (self.path(name) for name in ("terrain.h5", "rover.csv", "scan.h5", "dem.h5"))
        self.succeed("terrain-gen", "-c", self.config(CONFIGS["terrain-gen"]), "-o", terrain)
        DOC["rover_table"](terrain, path)
        ground = surface.of_file(terrain)
        table = np.genfromtxt(path, delimiter=",", names=True)
        np.testing.assert_allclose(ground.elevation(table["x_m"], table["y_m"]), table["z_m"], atol=1e-12)
        config = json.loads(blocks("json")[-1])
        config["trajectory"]["path"] = path
        self.succeed("scan-sim", "-c", self.config(config), "--terrain", terrain, "-o", scan)
        points, pulses = returns_of(scan), columns(scan, "pulses")
        self.assertGreater(len(points["pulse"]), 5000)
        heights = ground.elevation(points["x_true"], points["y_true"])
        self.assertLess(np.abs(heights - points["z_true"]).max(), 1e-6)
        # Every return lies in front of the lidar, within half the field of view.
        ahead = points["x_true"] - pulses["px_true"][points["pulse"]]
        aside = points["y_true"] - pulses["py_true"][points["pulse"]]
        self.assertGreater(ahead.min(), 0.3)
        self.assertLess(np.abs(np.degrees(np.arctan2(aside, ahead - 0.3))).max(), 40)
        self.succeed("regrid", scan, "--terrain", terrain, "-c", self.config(CONFIGS["regrid"]), "-o", dem)
        with h5py.File(dem) as file:
            errors = file["z_true"][()] - file["z_est"][()]
        self.assertGreater(np.isfinite(errors).sum(), 800)
        self.assertLess(np.nanmedian(np.abs(errors)), 0.02)


# The deadband is not a multiple of the drift per period, so that no switch depends on rounding.
TORQUE, INERTIA, PERIOD, DEADBAND, GAIN = 40.0, 100.0, 0.01, 1.107e-3, 0.05
FIRING = TORQUE * PERIOD / INERTIA  # rad/s


def limit_cycle(angle, rate, ticks):
    """Angles of one axis with on-off thrusters at the control times; linear interpolation errs by at most d h / 8 = 5e-6 rad."""
    angles = [angle]
    for _ in range(ticks):
        signal = angle + GAIN * rate
        change = -np.sign(signal) * FIRING if abs(signal) > DEADBAND else 0
        angle += (rate + change / 2) * PERIOD
        rate += change
        angles.append(angle)
    return np.array(angles)


class LimitCycle(ToolTest):
    """Thrusters of 40 N m on 100 kg m^2 swing the lander by 1 mrad; the estimated attitude is constant."""

    HEIGHT, RATE, LINES, HALF_WIDTH = 100.0, 5.0, 40, 9.0

    def evaluate(self, attitude):
        ground, scan, dem, judged = (self.path(name) for name in ("ground.h5", "scan.h5", "dem.h5", "eval.h5"))
        self.succeed("terrain-gen", "-c", self.config({"grid": {"half_width_m": 20, "resolution_m": 1}}), "-o", ground,
                     "-O")
        self.succeed("scan-sim", "--terrain", ground, "-o", scan, "-O", "-c", self.config(
            {"detector": {"rows": 8, "columns": 8, "ifov_rad": 0.00125},
             "laser": {"pulse_rate_hz": self.LINES**2 / 2, "scan_time_s": 2},
             "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": self.LINES, "columns": self.LINES,
                                                    "half_width_m": self.HALF_WIDTH}},
             "trajectory": {"type": "dynamics", "position_m": [0, 0, self.HEIGHT], "velocity_mps": [0, 0, -self.RATE],
                            "rpy_deg": [0, np.degrees(5e-4), 0],
                            "rate_degps": [np.degrees(FIRING / 2), -np.degrees(FIRING / 2), 0],
                            "inertia_kgm2": [INERTIA] * 3, "control_period_s": PERIOD,
                            "thrust": {"descent_rate_mps": self.RATE},
                            "attitude_control": {"deadband_deg": np.degrees(DEADBAND), "rate_gain_s": GAIN,
                                                 "torque_nm": [TORQUE] * 3}},
             "navigation_error": {"attitude": attitude}}))
        self.succeed("regrid", scan, "--terrain", ground, "-c", self.config({"resolution_m": 0.1, "half_width_m": 9}),
                     "-o", dem, "-O")
        self.succeed("dem-eval", dem, "-o", judged, "-O", "-c",
                     self.config({"region_radius_m": 8, "footprint_m": 0.7}))
        return scan, columns(dem, "/") | columns(judged, "/")

    def test_absolute_errors_follow_the_attitude(self):
        scan, layers = self.evaluate("commanded")
        pulses = columns(scan, "pulses")
        times = np.arange(201) * PERIOD
        theta_x = np.interp(pulses["t"], times, limit_cycle(0, FIRING / 2, 200))
        theta_y = np.interp(pulses["t"], times, limit_cycle(5e-4, -FIRING / 2, 200))
        np.testing.assert_allclose(2 * pulses["qx_true"], theta_x, atol=8e-6)
        self.assertGreater(np.abs(theta_x).max(), 0.99e-3)
        # The error is e = theta x (s - p), s - p = (x, y, -h), averaged over the pulses of each line.
        height = self.HEIGHT - self.RATE * pulses["t"]
        line = np.arange(len(height)) // self.LINES
        by_line = [np.bincount(line, e) / self.LINES for e in (-height * theta_y, height * theta_x)]
        line_y = np.linspace(self.HALF_WIDTH, -self.HALF_WIDTH, self.LINES)
        inside = layers["in_region"] == 1
        rows = layers["y"]
        for name, predicted in zip(("abs_x", "abs_y"), by_line):
            curve = np.interp(rows, line_y[::-1], predicted[::-1])
            smooth = np.convolve(curve, np.ones(7) / 7, "same")
            measured = np.array([np.nanmean(layers[name][i][inside[i]]) if inside[i].any() else np.nan
                                 for i in range(len(rows))])
            judged = np.isfinite(measured)
            self.assertGreater(judged.sum(), 150)
            self.assertLess(np.abs(measured - smooth)[judged].max(), 0.012, name)
            self.assertLess(np.sqrt(np.mean((measured - smooth)[judged] ** 2)), 0.005, name)
            self.assertGreater(np.abs(measured[judged]).max(), 0.09, name)  # h x 1 mrad

    def test_with_a_true_attitude_there_is_no_such_error(self):
        _, layers = self.evaluate("truth")
        inside = layers["in_region"] == 1
        for name in ("abs_x", "abs_y"):
            self.assertLess(np.nanmax(np.abs(layers[name][inside])), 0.02)


if __name__ == "__main__":
    unittest.main()
