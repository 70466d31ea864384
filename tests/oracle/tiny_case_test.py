#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tiny case's numbers, computed a second time from the files alone, in numpy and by GMT."""
import json
import shutil
import subprocess
import unittest

import h5py
import numpy as np

from harness import CONFIGS, Chain, ChainTest, columns, config_of, returns_of
from oracle import surface


def roll_pitch_yaw(angles):
    """Rz(yaw) Ry(pitch) Rx(roll) for angles of shape (n, 3)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles).T, np.sin(angles).T
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]]).transpose(2, 0, 1)


def rotation_of_quaternion(w, x, y, z):
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)


def normalised(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def reflected(v, normal):
    return v - 2 * np.sum(v * normal, axis=-1, keepdims=True) * normal


def apply(matrices, vectors):
    return np.einsum("nij,nj->ni", matrices, vectors)


class Scan(ChainTest):
    """scan.h5 from its own ranges, poses and pixel directions (SPEC section 4)."""

    def setUp(self):
        super().setUp()
        self.config = config_of(self.chain.scan)
        self.pulses = columns(self.chain.scan, "pulses")
        self.detector = columns(self.chain.scan, "detector")
        self.points = columns(self.chain.scan, "points")
        self.t = self.pulses["t"]

    def body(self, suffix):
        position = np.column_stack([self.pulses[f"p{axis}_{suffix}"] for axis in "xyz"])
        return position, rotation_of_quaternion(*(self.pulses[f"q{axis}_{suffix}"] for axis in "wxyz"))

    def mount(self):
        rotation = roll_pitch_yaw(np.radians([self.config["mount"]["rpy_deg"]]))[0]
        return np.array(self.config["mount"]["position_m"]), rotation

    def incoming(self):
        """d0, and the resting mirror's normal."""
        twice = 2 * np.radians(self.config["scanner"]["incidence_deg"])
        azimuth = np.radians(self.config["scanner"]["fold_azimuth_deg"])
        d0 = roll_pitch_yaw(np.array([[0, 0, azimuth]]))[0] @ [0, -np.sin(twice), -np.cos(twice)]
        return d0, normalised(np.array([0, 0, 1]) - d0)

    def mirror_of_angles(self):
        d0, m0 = self.incoming()
        azimuth = np.radians(self.config["scanner"]["fold_azimuth_deg"])
        e1 = np.array([np.cos(azimuth), np.sin(azimuth), 0])
        e2 = np.cross(m0, e1)
        a1, a2 = self.pulses["angle_1"][:, None], self.pulses["angle_2"][:, None]
        return np.sin(a2) * e1 - np.sin(a1) * np.cos(a2) * e2 + np.cos(a1) * np.cos(a2) * m0

    def beams(self):
        """The direction, in L, of every row of /points."""
        _, m0 = self.incoming()
        pixels = np.column_stack([self.detector[f"direction_{axis}"] for axis in "xyz"])
        incoming = reflected(pixels, m0)[self.points["pixel"]]
        return reflected(incoming, self.mirror_of_angles()[self.points["pulse"]])

    def points_at(self, ranges, suffix):
        position, rotation = self.body(suffix)
        pulse = self.points["pulse"]
        offset, mounting = self.mount()
        in_body = offset + (ranges[:, None] * self.beams()) @ mounting.T
        return position[pulse] + apply(rotation[pulse], in_body)

    def assert_points(self, expected, suffix):
        found = np.column_stack([self.points[f"{axis}_{suffix}"] for axis in "xyz"])
        self.assertGreater(len(found), 20000)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)

    def test_estimated_points(self):
        self.assert_points(self.points_at(self.points["range_measured"], "est"), "est")

    def test_true_points(self):
        self.assert_points(self.points_at(self.points["range_true"], "true"), "true")

    def test_times_and_true_trajectory(self):
        np.testing.assert_allclose(self.t, np.arange(400) / 2000, rtol=0, atol=1e-15)
        trajectory = self.config["trajectory"]
        position, rotation = self.body("true")
        np.testing.assert_allclose(
            position, trajectory["position_m"] + np.outer(self.t, trajectory["velocity_mps"]), rtol=0, atol=1e-12)
        angles = np.radians(trajectory["rpy_deg"] + np.outer(self.t, trajectory["rpy_rate_degps"]))
        np.testing.assert_allclose(rotation, roll_pitch_yaw(angles), rtol=0, atol=1e-14)

    def test_navigation_error(self):
        error = self.config["navigation_error"]
        position, rotation = self.body("true")
        position_est, rotation_est = self.body("est")
        np.testing.assert_allclose(
            position_est, position - (error["position_m"] + np.outer(self.t, error["velocity_mps"])),
            rtol=0, atol=1e-12)
        angles = error["rpy_rad"] + np.outer(self.t, error["rpy_rate_radps"])
        np.testing.assert_allclose(rotation_est, rotation @ roll_pitch_yaw(angles), rtol=0, atol=1e-14)

    def test_line_search_aims(self):
        pattern = self.config["scanner"]["pattern"]
        k = np.arange(len(self.t))
        line, column = k // pattern["columns"], k % pattern["columns"]
        extent = pattern["half_width_m"]
        ground = np.column_stack([-extent + 2 * extent * column / (pattern["columns"] - 1),
                                  extent - 2 * extent * line / (pattern["rows"] - 1), 0 * k])
        position, rotation = self.body("true")
        offset, mounting = self.mount()
        lidar = position + rotation @ offset
        aim = normalised(apply((rotation @ mounting).transpose(0, 2, 1), ground - lidar))
        d0, _ = self.incoming()
        np.testing.assert_allclose(self.mirror_of_angles(), normalised(aim - d0), rtol=0, atol=1e-13)

    def test_pixel_directions(self):
        rows, cols = self.config["detector"]["rows"], self.config["detector"]["columns"]
        pitch, roll = self.config["detector"]["ifov_rad"], np.radians(self.config["detector"]["roll_deg"])
        a, b = np.divmod(np.arange(rows * cols), cols)
        flat = np.column_stack([(b - (cols - 1) / 2) * pitch, -((rows - 1) / 2 - a) * pitch, np.ones(rows * cols)])
        turn = np.array([[np.cos(roll), np.sin(roll), 0], [-np.sin(roll), np.cos(roll), 0], [0, 0, 1]])
        found = np.column_stack([self.detector[f"direction_{axis}"] for axis in "xyz"])
        np.testing.assert_allclose(found, normalised(flat) @ turn.T, rtol=0, atol=1e-15)

    def test_true_points_lie_on_the_terrain(self):
        height = surface.of_file(self.chain.terrain).elevation(self.points["x_true"], self.points["y_true"])
        # A ray that is s off the vertical turns a range error of 1e-6 m into at most (1 + slope s) 1e-6 m.
        np.testing.assert_allclose(self.points["z_true"], height, rtol=0, atol=2e-6)

    def test_range_errors(self):
        noise = self.config["noise"]
        error = self.points["range_measured"] - self.points["range_true"]
        count = len(error)
        # One false alarm in 1.7 million each: 5 sigma of the mean and of the standard deviation.
        self.assertAlmostEqual(error.mean(), noise["range_bias_m"], delta=5 * noise["range_sigma_m"] / count**0.5)
        self.assertAlmostEqual(error.std(), noise["range_sigma_m"],
                               delta=5 * noise["range_sigma_m"] / (2 * count)**0.5)

    def test_point_begin_and_count(self):
        begin, count = self.pulses["point_begin"], self.pulses["point_count"]
        np.testing.assert_array_equal(count, np.bincount(self.points["pulse"], minlength=len(count)))
        np.testing.assert_array_equal(begin, np.cumsum(count) - count)
        order = self.points["pulse"].astype(np.int64) * 64 + self.points["pixel"]
        self.assertTrue((np.diff(order) > 0).all())
        self.assertFalse(self.detector["dead"][self.points["pixel"]].any())


class Misses(ChainTest):
    """--keep-misses: a row per pixel and pulse, and the returns are those of the plain file."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # Narrow terrain: some rays pass it.
        cls.options = ["--set", "scanner.pattern.half_width_m=8", "--terrain", cls.chain.terrain, "-c",
                       cls.chain.config("scan-sim")]

    def setUp(self):
        super().setUp()
        self.plain, self.full = self.path("plain.h5"), self.path("full.h5")
        self.succeed("scan-sim", *self.options, "-o", self.plain)
        self.succeed("scan-sim", *self.options, "-o", self.full, "--keep-misses")

    def test_rows_statuses_and_counts(self):
        full, plain = columns(self.full, "points"), columns(self.plain, "points")
        self.assertEqual(len(full["status"]), 400 * 64)
        np.testing.assert_array_equal(full["pulse"], np.repeat(np.arange(400), 64))
        np.testing.assert_array_equal(full["pixel"], np.tile(np.arange(64), 400))
        for name, values in plain.items():
            np.testing.assert_array_equal(full[name][full["status"] == 0], values, name)
        with h5py.File(self.full) as file, h5py.File(self.plain) as other:
            for code, key in enumerate(["return_count", "miss_count", "dropout_count", "dead_count"]):
                self.assertEqual(file["points"].attrs[key], (full["status"] == code).sum())
                self.assertEqual(other["points"].attrs[key], file["points"].attrs[key])
                self.assertGreater(file["points"].attrs[key], 0, key)

    def test_the_first_status_that_applies(self):
        full, dead = columns(self.full, "points"), columns(self.full, "detector")["dead"]
        np.testing.assert_array_equal(full["status"] == 3, dead[full["pixel"]] == 1)
        alive = full["status"] != 3
        np.testing.assert_array_equal((full["status"] == 1)[alive], np.isnan(full["range_true"])[alive])
        # Dropped and dead pixels keep the truth and measure nothing.
        self.assertTrue(np.isfinite(full["range_true"][full["status"] == 2]).all())
        self.assertTrue(np.isfinite(full["range_true"][full["status"] == 3]).any())
        np.testing.assert_array_equal(np.isfinite(full["range_measured"]), full["status"] == 0)
        np.testing.assert_array_equal(np.isfinite(full["x_est"]), full["status"] == 0)

    def test_pulses(self):
        full, plain = columns(self.full, "pulses"), columns(self.plain, "pulses")
        for name in set(full) - {"point_begin", "point_count"}:
            np.testing.assert_array_equal(full[name], plain[name], name)
        self.assertTrue((full["point_count"] == 64).all())
        np.testing.assert_array_equal(full["point_begin"], 64 * np.arange(400))
        points = columns(self.plain, "points")
        np.testing.assert_array_equal(plain["point_count"], np.bincount(points["pulse"], minlength=400))

    def test_regrid_makes_the_same_layers(self):
        for source in ("plain", "full"):
            self.succeed("regrid", self.path(f"{source}.h5"), "--terrain", self.chain.terrain, "-c",
                         self.chain.config("regrid"), "-o", self.path(f"{source}-dem.h5"))
        plain, full = (columns(self.path(f"{source}-dem.h5"), "/") for source in ("plain", "full"))
        self.assertEqual(set(plain), set(full))
        for name, values in plain.items():
            self.assertEqual(values.tobytes(), full[name].tobytes(), name)


class Bins:
    """Weighted sums per bin by np.add.at, which adds in row order (Eqs. 8-9)."""

    def __init__(self, points, times, resolution_m, half_width_m):
        half = round(half_width_m / resolution_m)
        self.size = 2 * half + 1
        self.centers = np.arange(-half, half + 1) * resolution_m
        col, row = (np.floor(points[f"{axis}_est"] / resolution_m + 0.5).astype(int) for axis in "xy")
        inside = (abs(col) <= half) & (abs(row) <= half)
        self.points = {name: values[inside] for name, values in points.items()}
        self.points["t"] = times[inside]
        self.col, self.row = col[inside] + half, row[inside] + half
        p, q = (abs(self.points[f"{axis}_est"] - self.centers[bins]) / resolution_m
                for axis, bins in [("x", self.col), ("y", self.row)])
        self.weights = (1 - p) * (1 - q)

    def sum(self, values):
        total = np.zeros((self.size, self.size))
        np.add.at(total, (self.row, self.col), values)
        return total

    def mean(self, values):
        with np.errstate(invalid="ignore"):
            return self.sum(self.weights * values) / self.sum(self.weights)


class Dem(ChainTest):
    """dem.h5 from scan.h5 and terrain.h5 (SPEC section 5)."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        points = returns_of(cls.chain.scan)
        times = columns(cls.chain.scan, "pulses")["t"][points["pulse"]]
        cls.bins = Bins(points, times, 0.1, 5)
        cls.layers = columns(cls.chain.dem, "/")

    def assert_layer(self, name, expected, **tolerance):
        self.assertGreater(np.isfinite(expected).sum(), 3000)
        np.testing.assert_allclose(self.layers[name], expected, err_msg=name, **tolerance)

    def test_count_weights_and_elevation(self):
        np.testing.assert_array_equal(self.layers["count"], self.bins.sum(1))
        empty = self.layers["count"] == 0
        self.assertGreater(empty.sum(), 1000)
        for name, layer in self.layers.items():
            if layer.ndim == 2 and name != "count":
                self.assertTrue(np.isnan(layer[empty]).all(), name)
        weights = self.bins.sum(self.bins.weights)
        self.assert_layer("weight_sum", np.where(empty, np.nan, weights), rtol=1e-13)
        self.assert_layer("z_est", self.bins.mean(self.bins.points["z_est"]), rtol=0, atol=1e-13)

    def test_true_places(self):
        for axis in "xy":
            self.assert_layer(f"{axis}_true", self.bins.mean(self.bins.points[f"{axis}_true"]), rtol=0, atol=1e-12)

    def test_true_elevation_under_the_bin_centres_true_place(self):
        dx, dy = (self.bins.mean(self.bins.points[f"{axis}_true"] - self.bins.points[f"{axis}_est"])
                  for axis in "xy")
        height = surface.of_file(self.chain.terrain).elevation(self.bins.centers[None, :] + dx,
                                                       self.bins.centers[:, None] + dy)
        self.assert_layer("z_true", height, rtol=0, atol=1e-11)

    def test_true_elevation_at_the_centroid(self):
        self.succeed("regrid", *self.chain.inputs("regrid"), "--truth-at", "centroid", "-o", self.path("dem.h5"))
        layers = columns(self.path("dem.h5"), "/")
        height = surface.of_file(self.chain.terrain).elevation(layers["x_true"], layers["y_true"])
        np.testing.assert_allclose(layers["z_true"], height, rtol=0, atol=1e-11)
        self.assertGreater(np.nanmax(abs(layers["z_true"] - self.layers["z_true"])), 1e-3)

    def map_by(self, method):
        self.succeed("regrid", *self.chain.inputs("regrid"), "--method", method, "-o", self.path("dem.h5"), "-O")
        return columns(self.path("dem.h5"), "/")

    def test_methods_of_one_bin(self):
        """mean, min, max and median of the returns of each bin, bin by bin."""
        points = self.bins.points
        place = [np.floor(points[f"{axis}_est"] / 0.1 + 0.5).astype(int) + 50 for axis in "xy"]
        inside = np.all([(0 <= p) & (p < 101) for p in place], axis=0)
        bin_of_point = place[1] * 101 + place[0]
        order = np.flatnonzero(inside)[np.argsort(bin_of_point[inside], kind="stable")]
        numbers, begins = np.unique(bin_of_point[order], return_index=True)
        groups = np.split(order, begins[1:])
        for method, choose in (("mean", lambda z: slice(None)), ("min", np.argmin), ("max", np.argmax),
                               ("median", lambda z: np.argsort(z, kind="stable")[[(len(z) - 1) // 2, len(z) // 2]])):
            layers = self.map_by(method)
            np.testing.assert_array_equal(layers["count"], self.bins.sum(1), err_msg=method)
            for layer, column in (("z_est", "z_est"), ("x_true", "x_true"), ("y_true", "y_true")):
                expected = np.full(101 * 101, np.nan)
                expected[numbers] = [points[column][group][choose(points["z_est"][group])].mean() for group in groups]
                np.testing.assert_allclose(layers[layer].ravel(), expected, rtol=0, atol=1e-12,
                                           err_msg=f"{method} {layer}")

    def test_bilinear4(self):
        points, sums = self.bins.points, np.zeros((3, 103, 103))
        u, v = (points[f"{axis}_est"] / 0.1 + 51 for axis in "xy")  # a ring of bins more
        for dy in (0, 1):
            for dx in (0, 1):
                col, row = np.floor(u).astype(int) + dx, np.floor(v).astype(int) + dy
                weight = (1 - abs(u - col)) * (1 - abs(v - row))
                kept = (0 <= col) & (col < 103) & (0 <= row) & (row < 103) & (weight > 0)
                for target, value in zip(sums, (np.ones_like(u), weight, weight * points["z_est"])):
                    np.add.at(target, (row[kept], col[kept]), value[kept])
        count, weights, z = sums[:, 1:-1, 1:-1]
        layers = self.map_by("bilinear4")
        # A point within rounding of a centre may count at the next one with a weight of 1e-13.
        self.assertLess((layers["count"] != count).mean(), 1e-3)
        held = weights > 1e-9
        np.testing.assert_allclose(layers["weight_sum"][held], weights[held], rtol=1e-9)
        np.testing.assert_allclose(layers["z_est"][held], (z / np.where(held, weights, 1))[held], rtol=0, atol=1e-9)
        self.assertGreater(held.sum(), self.bins.sum(1).astype(bool).sum())

    def test_float32_layers(self):
        mean, points = self.bins.mean, self.bins.points
        for name, expected in [("x_est_mean", mean(points["x_est"])), ("y_est_mean", mean(points["y_est"])),
                               ("t_mean", mean(points["t"]))]:
            self.assert_layer(name, expected.astype(np.float32), rtol=2e-7, atol=1e-9)
        residual = points["z_est"] - mean(points["z_est"])[self.bins.row, self.bins.col]
        self.assert_layer("z_spread", np.sqrt(mean(residual**2)), rtol=1e-6, atol=1e-9)

    def test_two_scans_add_up(self):
        second = Chain(seed=8, trajectory__position_m=[0.7, 0.1, 52])
        self.addCleanup(second.remove)
        self.succeed("regrid", self.chain.scan, second.scan, "--terrain", self.chain.terrain, "-c",
                     self.chain.config("regrid"), "-o", self.path("dem.h5"))
        merged = columns(self.path("dem.h5"), "/")
        scans = [returns_of(self.chain.scan), returns_of(second.scan)]
        points = {name: np.concatenate([scan[name] for scan in scans]) for name in scans[0]}
        times = np.concatenate([columns(path, "pulses")["t"][scan["pulse"]]
                                for path, scan in zip([self.chain.scan, second.scan], scans)])
        bins = Bins(points, times, 0.1, 5)
        np.testing.assert_array_equal(merged["count"], bins.sum(1))
        self.assertEqual(merged["count"].sum(), self.layers["count"].sum() + columns(second.dem, "/")["count"].sum())
        np.testing.assert_allclose(merged["z_est"], bins.mean(points["z_est"]), rtol=0, atol=1e-13)
        np.testing.assert_allclose(merged["x_true"], bins.mean(points["x_true"]), rtol=0, atol=1e-12)
        np.testing.assert_allclose(np.nan_to_num(merged["weight_sum"]),
                                   sum(np.nan_to_num(columns(dem, "/")["weight_sum"])
                                       for dem in (self.chain.dem, second.dem)), rtol=1e-13)

    @unittest.skipUnless(shutil.which("gmt"), "GMT is not installed")
    def test_gmt_blockmean_agrees(self):
        points = self.bins.points
        rows = np.column_stack([points["x_est"], points["y_est"], points["z_est"], self.bins.weights])
        result = subprocess.run(
            ["gmt", "blockmean", "-bi4d", "-bo4d", "-W", "-C", "-R-5/5/-5/5", "-I0.1"],
            input=rows.astype("<f8").tobytes(), capture_output=True, check=True, cwd=self.folder, timeout=60)
        x, y, z, weight = np.frombuffer(result.stdout, "<f8").reshape(-1, 4).T
        col, row = (np.rint(v / 0.1).astype(int) + 50 for v in (x, y))
        self.assertEqual(len(z), (self.layers["count"] > 0).sum())
        np.testing.assert_allclose(self.layers["z_est"][row, col], z, rtol=1e-12)
        np.testing.assert_allclose(self.layers["weight_sum"][row, col], weight, rtol=1e-12)


def flood_fill(invalid):
    """8-connected components, numbered by first bin in row-major order."""
    ids, count = np.zeros(invalid.shape, int), 0
    for start in zip(*np.nonzero(invalid)):
        if ids[start]:
            continue
        count += 1
        stack = [start]
        while stack:
            row, col = stack.pop()
            if not (0 <= row < ids.shape[0] and 0 <= col < ids.shape[1]) or not invalid[row, col] or ids[row, col]:
                continue
            ids[row, col] = count
            stack += [(row + i, col + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return ids


class Evaluation(ChainTest):
    """eval.h5 and metrics.json from dem.h5 (SPEC section 6), with limits that the tiny case misses."""

    LIMITS = {"invalid_frac": 0.05, "hole_bins": 1, "distance_bins": 0.5, "relative_elevation_m": 0.03,
              "relative_horizontal_m": 0.042, "absolute_horizontal_m": 0.045, "absolute_horizontal_frac": 0.9}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dem = columns(cls.chain.dem, "/")
        half = 50
        i, j = np.meshgrid(np.arange(-half, half + 1), np.arange(-half, half + 1))
        cls.region = i * i + j * j < 40 * 40
        cls.invalid = cls.region & np.isnan(cls.dem["z_est"])
        cls.holes = flood_fill(cls.invalid)
        cls.distance = cls.distances()
        cls.errors = {"x": cls.dem["x_true"] - cls.dem["x"][None, :], "y": cls.dem["y_true"] - cls.dem["y"][:, None],
                      "z": cls.dem["z_true"] - cls.dem["z_est"]}
        cls.footprints = {axis: cls.windows(error) for axis, error in cls.errors.items()}

    @classmethod
    def distances(cls):
        valid = np.argwhere(~np.isnan(cls.dem["z_est"]))
        result = np.zeros(cls.region.shape)
        for row, col in np.argwhere(cls.invalid):
            result[row, col] = np.sqrt(((valid - [row, col])**2).sum(axis=1).min())
        return result

    @classmethod
    def windows(cls, error):
        """Mean and 95th percentile of |e - mean| over 7 x 7 bins, of the region's bins."""
        absolute, relative = np.full(error.shape, np.nan), np.full(error.shape, np.nan)
        for row, col in np.argwhere(cls.region):
            values = error[max(row - 3, 0):row + 4, max(col - 3, 0):col + 4]
            values = values[~np.isnan(values)]
            if values.size:
                absolute[row, col] = values.mean()
                relative[row, col] = np.quantile(abs(values - values.mean()), 0.95)
        return absolute, relative

    def setUp(self):
        super().setUp()
        sets = [part for key, value in self.LIMITS.items() for part in ("--set", f"limits.{key}={value}")]
        text = self.succeed("dem-eval", *self.chain.inputs("dem-eval"), *sets, "-o", self.path("eval.h5"),
                            "--json").stdout

        self.metrics = json.loads(text)["metrics"]
        self.layers = columns(self.path("eval.h5"), "/")

    def test_coverage_layers(self):
        self.assertEqual(self.region.sum(), self.metrics["region"]["bin_count"])
        self.assertGreater(self.invalid.sum(), 50)
        np.testing.assert_array_equal(self.layers["in_region"], self.region)
        np.testing.assert_array_equal(self.layers["invalid"], self.invalid)
        np.testing.assert_array_equal(self.layers["hole_id"], self.holes)
        np.testing.assert_array_equal(self.layers["distance_to_valid"][self.region],
                                      self.distance[self.region].astype(np.float32))

    def test_coverage_metrics(self):
        sizes = np.bincount(self.holes.ravel())[1:]
        coverage = self.metrics["coverage"]
        values, counts = np.unique(sizes, return_counts=True)
        self.assertEqual(coverage, {
            "invalid_count": self.invalid.sum(), "invalid_frac": self.invalid.sum() / self.region.sum(),
            "hole_count": len(sizes), "largest_hole_bins": sizes.max(), "holes_over_limit": (sizes > 1).sum(),
            "max_distance_bins": self.distance.max(), "distance_over_limit_count": (self.distance > 0.5).sum(),
            "hole_size_histogram": {"size_bins": values.tolist(), "count": counts.tolist()}})

    def test_holes_table(self):
        holes = columns(self.path("eval.h5"), "holes")
        sizes = np.bincount(self.holes.ravel())[1:]
        np.testing.assert_array_equal(holes["id"], np.arange(1, len(sizes) + 1))
        np.testing.assert_array_equal(holes["size_bins"], sizes)
        firsts = np.array([np.argwhere(self.holes == number)[0] for number in holes["id"]])
        np.testing.assert_array_equal(np.column_stack([holes["row"], holes["column"]]), firsts)

    def test_error_layers(self):
        for axis, error in self.errors.items():
            absolute, relative = self.footprints[axis]
            inside = self.region
            np.testing.assert_allclose(self.layers[f"e_{axis}"][inside], error[inside], rtol=0, atol=1e-15)
            np.testing.assert_allclose(self.layers[f"abs_{axis}"][inside], absolute[inside], rtol=2e-7, atol=1e-12)
            np.testing.assert_allclose(self.layers[f"rel_{axis}"][inside], relative[inside], rtol=2e-7, atol=1e-12)

    def test_accuracy_metrics(self):
        accuracy = self.metrics["accuracy"]
        self.assertEqual((accuracy["footprint_bins"], accuracy["quantile"]), (7, 0.95))
        for axis in "xyz":
            absolute, relative = (values[np.isfinite(values)] for values in self.footprints[axis])
            limit = self.LIMITS["relative_elevation_m" if axis == "z" else "relative_horizontal_m"]
            self.assert_numbers(accuracy["absolute"][axis], {
                "p95_m": np.quantile(abs(absolute), 0.95), "mean_m": absolute.mean(), "max_m": abs(absolute).max()})
            self.assert_numbers(accuracy["relative"][axis], {
                "p95_m": np.quantile(relative, 0.95), "max_m": relative.max(),
                "violation_count": (relative > limit).sum()})
        horizontal = np.hypot(self.footprints["x"][0], self.footprints["y"][0])
        horizontal = horizontal[np.isfinite(horizontal)]
        self.assert_numbers(accuracy["absolute"]["horizontal"], {
            "p95_m": np.quantile(horizontal, 0.95), "within_limit_frac": (horizontal <= 0.045).mean()})

    @staticmethod
    def statistics(error):
        median = np.median(error)
        return {"count": error.size, "mean_m": error.mean(), "std_m": error.std(),
                "rmse_m": np.sqrt((error**2).mean()), "median_m": median,
                "nmad_m": 1.4826 * np.median(abs(error - median)), "le90_m": np.quantile(abs(error), 0.9),
                "p95_m": np.quantile(abs(error), 0.95)}

    def valid(self, error):
        return error[self.region & ~np.isnan(error)]

    def test_statistics(self):
        statistics = self.metrics["statistics"]
        self.assertEqual(set(statistics), {"valid_frac", "x", "y", "z", "horizontal"})
        self.assertAlmostEqual(statistics["valid_frac"], 1 - self.invalid.sum() / self.region.sum(), places=15)
        for axis in "xyz":
            self.assert_numbers(statistics[axis], self.statistics(self.valid(self.errors[axis])))
        horizontal = self.valid(np.hypot(self.errors["x"], self.errors["y"]))
        self.assert_numbers(statistics["horizontal"], {
            "count": horizontal.size, "ce90_m": np.quantile(horizontal, 0.9),
            "rmse_m": np.sqrt((horizontal**2).mean())})

    def extended_dem(self, layers):
        """The chain's DEM with more layers."""
        shutil.copy(self.chain.dem, self.path("more.h5"))
        with h5py.File(self.path("more.h5"), "r+") as file:
            for name, values in layers.items():
                file[name] = values
        return self.path("more.h5")

    def evaluated(self, dem):
        text = self.succeed("dem-eval", dem, "-c", self.chain.config("dem-eval"), "--metrics-only").stdout
        return json.loads(text)

    def test_corrected_elevation(self):
        corrected = self.dem["z_est"] + 0.01 * np.sin(np.arange(101))
        plain = self.evaluated(self.chain.dem)
        for dtype in (np.float64, np.float32):
            metrics = self.evaluated(self.extended_dem({"z_corrected": corrected.astype(dtype)}))
            error = self.dem["z_true"] - corrected.astype(dtype)
            self.assert_numbers(metrics["statistics"].pop("z_corrected"), self.statistics(self.valid(error)))
            absolute, relative = (values[np.isfinite(values)] for values in self.windows(error))
            self.assert_numbers(metrics["accuracy"]["absolute"].pop("z_corrected"), {
                "p95_m": np.quantile(abs(absolute), 0.95), "mean_m": absolute.mean(), "max_m": abs(absolute).max()})
            self.assert_numbers(metrics["accuracy"]["relative"].pop("z_corrected"), {
                "p95_m": np.quantile(relative, 0.95), "max_m": relative.max(),
                "violation_count": (relative > 0.05).sum()})
            self.assertEqual(metrics, plain)

    def test_uncertainty(self):
        true = self.dem["z_true"] + 0.002
        sigma = (0.01 * 2**np.sin(np.arange(101)[:, None] + np.arange(101))).astype(np.float32)
        sigma[40:43, 40:43] = np.nan
        dem = self.extended_dem({"z_true_map": true, "z_sigma_abs": sigma, "z_sigma_rel": 0.7 * sigma})
        error = true - self.dem["z_est"]
        uncertainty = self.evaluated(dem)["uncertainty"]
        self.check_scores(uncertainty["absolute"], error, sigma.astype(float))
        mean, _ = self.windows(error)
        self.check_scores(uncertainty["relative"], error - mean, (0.7 * sigma).astype(np.float32).astype(float))
        self.assertIsNone(self.metrics["uncertainty"])

    def check_scores(self, found, error, sigma):
        known = self.region & ~np.isnan(error)
        used = known & (sigma > 0)
        self.assertEqual((found["count"], found["left_out_count"]), (used.sum(), known.sum() - used.sum()))
        scores, counts = (error / sigma)[used], self.dem["count"][used]
        self.assert_close(found["mean"], scores.mean())
        self.assert_close(found["std"], scores.std())
        self.assert_close(found["within_2_sigma_frac"], (abs(scores) <= 2).mean())
        by_count = found["by_count"]
        self.assertEqual(by_count["count"], np.unique(counts).tolist())
        self.assertEqual(by_count["bins"], [(counts == n).sum() for n in by_count["count"]])
        self.assert_close(by_count["std"], [scores[counts == n].std() for n in by_count["count"]])
        self.assert_close(by_count["within_1_sigma_frac"],
                          [(abs(scores[counts == n]) <= 1).mean() for n in by_count["count"]])
        step = np.floor(4 * np.log2(sigma[used]))
        of_step = [step == k for k in np.unique(step)]
        reliability = found["reliability"]
        self.assertEqual(reliability["bins"], [mask.sum() for mask in of_step])
        self.assert_close(reliability["sigma_m"], [np.sqrt((sigma[used][m]**2).mean()) for m in of_step])
        self.assert_close(reliability["rmse_m"], [np.sqrt((error[used][m]**2).mean()) for m in of_step])
        shares = found["within_k_sigma"]
        self.assertEqual(shares["k"], np.arange(0.25, 4.1, 0.25).tolist())
        self.assert_close(shares["frac"], [(abs(scores) <= k).mean() for k in shares["k"]])

    @staticmethod
    def assert_close(found, expected):
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)

    def assert_numbers(self, found, expected):
        self.assertEqual(set(found), set(expected))
        for key, value in expected.items():
            np.testing.assert_allclose(found[key], value, rtol=1e-12, atol=1e-15, err_msg=key)

    def test_requirements(self):
        coverage, accuracy = self.metrics["coverage"], self.metrics["accuracy"]
        relative = accuracy["relative"]
        values = {"coverage": (coverage["invalid_frac"], 0.05),
                  "hole_size": (coverage["largest_hole_bins"], 1),
                  "hole_distance": (coverage["max_distance_bins"], 0.5),
                  "relative_elevation": (relative["z"]["violation_count"], 0),
                  "relative_horizontal": (relative["x"]["violation_count"] + relative["y"]["violation_count"], 0),
                  "absolute_horizontal": (accuracy["absolute"]["horizontal"]["within_limit_frac"], 0.9)}
        for name, (value, limit) in values.items():
            found = self.metrics["requirements"][name]
            passed = value >= limit if name == "absolute_horizontal" else value <= limit
            self.assertEqual((found["value"], found["limit"], found["pass"]), (value, limit, passed), name)
        verdicts = [entry["pass"] for entry in self.metrics["requirements"].values()]
        self.assertIn(True, verdicts)
        self.assertIn(False, verdicts)
        self.assertIs(self.metrics["pass"], False)

    def test_fail_flags(self):
        flags = np.zeros(self.region.shape, int)
        for bit, axis in [(1, "x"), (2, "y"), (4, "z")]:
            limit = self.LIMITS["relative_elevation_m" if axis == "z" else "relative_horizontal_m"]
            flags += bit * (np.nan_to_num(self.footprints[axis][1]) > limit)
        flags += 8 * (np.nan_to_num(np.hypot(self.footprints["x"][0], self.footprints["y"][0])) > 0.045)
        sizes = np.bincount(self.holes.ravel())
        flags += 16 * ((self.holes > 0) & (sizes[self.holes] > 1))
        flags += 32 * (self.distance > 0.5)
        for bit in (1, 2, 4, 8, 16, 32):
            self.assertTrue((flags & bit).any(), f"the case shows no flag {bit}")
        np.testing.assert_array_equal(self.layers["fail"], flags)


if __name__ == "__main__":
    unittest.main()
