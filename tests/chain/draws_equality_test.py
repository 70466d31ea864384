#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Each draw over a scan is the chain's, bit for bit (traced_draws_test.py has draws that trace, opencl_draws_test.py those of a device);
`verdict` decides as `full`; P(invalid) is that of dropouts."""
import itertools
import json
import math
import os
import unittest

import h5py
import numpy as np

from harness import REGRID, SCAN, ToolTest, columns, config_of, read_bytes, with_values
from harness.draws import REQUIREMENTS, DrawsTest, draws_config, merged
from monte_carlo_test import ERRORS, VARY

STUDIES = os.path.join(os.environ["LANDFALL_ROOT"], "studies")
SCENES = 24
PASSES = [f"requirements.{name}.pass" for name in REQUIREMENTS]
# The numbers of a scan's configuration that --ranges-from redraws; the rest of these sections moves the rays.
REDRAWN = ("noise", "pointing_error", "navigation_error")
RAYS = tuple(f"pointing_error.{key}" for key in ("jitter_", "mirror_time_", "misalignment_rpy_rad"))
COMMANDED = with_values(ERRORS, navigation_error__attitude="commanded")
LIGHT = {"detector": {"subpixels": 2}, "beam": {"divergence_rad": 0.01}, "surface": {"albedo": 0.5},
         "link": {"reference_pe": 150, "reference_range_m": 50, "background_pe": 3}}
LOSSES = {"noise": {"dropout_frac": 0.1, "dead_pixel_frac": 0.1}, "scanner": {"pattern": {"half_width_m": 6}}}
TIMING = {f"scan.receiver.{key}": {"type": "uniform", "low": 0, "high": high} for key, high in [
    ("jitter_sigma_s", 1e-10), ("pixel_offset_sigma_m", 0.02), ("clock_scale_ppm", 20), ("timer_step_s", 5e-10)]}
# {name: (changes of the scan that is redrawn, which then has its misses and echoes; the run; what varies beside every key of the errors,
# or None if nothing varies; the draws that are compared)}.
REDRAWS = {
    "every error": ({}, {"draws": 70, "scan": COMMANDED, "layers": False}, {}, (0, 7, 69)),
    **{kind: ({**LIGHT, "receiver": {"type": kind, "threshold_pe": 40, "jitter_sigma_s": 1e-11}},
              {"draws": 9, "scan": COMMANDED, "layers": False},
              TIMING, (0, 8)) for kind in ("leading_edge", "constant_fraction", "peak", "centroid")},
    **{str(regrid): (LOSSES, {"draws": 2, "scan": {"noise": {"dropout_frac": 0.02}, "seed": 90}, "regrid": {**REGRID, **regrid}},
                     None, (1,))
       for regrid in ({"method": "bilinear4"}, {"method": "mean"}, {"method": "median"}, {"truth_at": "centroid"})},
}


def leaves(value, path):
    """The paths of the numbers of a configuration, as keys of `vary`."""
    if isinstance(value, dict):
        inner = value.items()
    elif isinstance(value, list):
        inner = enumerate(value)
    else:
        return [] if isinstance(value, str) else [path]
    return [leaf for key, each in inner for leaf in leaves(each, f"{path}.{key}")]


class Redraws(DrawsTest):
    def every_key(self):
        """VARY, and a uniform distribution for each other number that can be redrawn."""
        config = config_of(self.chain.scan)
        keys = [key for name in REDRAWN for key in leaves(merged(config[name], ERRORS[name]), name) if not key.startswith(RAYS)]
        vary = {f"scan.{key}": {"type": "uniform", "low": 0, "high": 1e-3} for key in keys}
        for key in vary:
            if key.endswith(("_time_s", "interval_s")):
                vary[key] = {"type": "uniform", "low": 0.01, "high": 0.05}
        self.assertLessEqual({key for key in VARY if key.startswith("scan.")}, set(vary))
        return {**vary, **VARY, "scan.noise.false_range_m.1": {"type": "uniform", "low": 50, "high": 60}}

    def source(self, changes):
        echoes = ["--keep-echoes"] if "receiver" in changes else []
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-c", self.config(changes, "changes.json"), "--keep-misses", *echoes, "-O",
                     "-o", self.path("source.h5"))
        return self.path("source.h5")

    def test_each_draw_is_that_of_the_chain(self):
        for name, (changes, values, varied, draws) in REDRAWS.items():
            with self.subTest(name):
                scan = self.source(changes) if changes else self.chain.scan
                config = draws_config(**values, vary={} if varied is None else {**self.every_key(), **varied})
                rows = self.draws(config, scan=scan)
                self.assertEqual((set(rows["seed"]), list(rows["draw"])),
                                 ({values["scan"].get("seed", SCAN["seed"])}, list(range(values["draws"]))))
                self.assertEqual({key for key in rows if key.split(".")[0] in ("scan", "regrid", "eval")}, set(config["vary"]))
                self.assertEqual([key for key in config["vary"] if len(set(rows[key])) < values["draws"]], [])
                for draw in draws:
                    self.check_draw(config, rows, draw, scan=scan)


class Verdicts(ToolTest):
    """`verdict` and `full` have the same seeds, values, verdicts and counts; `full` has more columns."""

    def scene(self, terrain, scan):
        """Makes terrain.h5 and scan.h5."""
        self.succeed("terrain-gen", "-c", self.config(terrain, "terrain.json"), "-o", self.path("terrain.h5"), "-O")
        self.succeed("scan-sim", "-c", self.config(scan, "scan.json"), "--terrain", self.path("terrain.h5"),
                     "-o", self.path("scan.h5"), "-O")

    def check_verdicts(self, config):
        """Returns the columns of `full`."""
        rows = {}
        for metrics in ("full", "verdict"):
            name = self.path(f"{metrics}.h5")
            self.succeed("monte-carlo", self.path("scan.h5"), "--terrain", self.path("terrain.h5"), "-c",
                         self.config({"layers": False, **config, "metrics": metrics}, "mc.json"), "-o", name, "-O")
            rows[metrics] = columns(name, "draws")
        self.assertLess(set(rows["verdict"]), set(rows["full"]))
        self.assertLessEqual({*PASSES, *(f"requirements.{name}.value" for name in REQUIREMENTS), "coverage.invalid_count",
                              *(f"accuracy.relative.{axis}.violation_count" for axis in "xyz"), "pass", "seed", "draw"}, set(rows["verdict"]))
        for name, values in rows["verdict"].items():
            np.testing.assert_array_equal(values, rows["full"][name], f"{name}, {config}")
        return rows["full"]

    def site_scan(self):
        """A map of 14 m in bins of 5 cm."""
        return {"detector": {"rows": 18, "columns": 18, "ifov_rad": 8.888888888888889e-5, "roll_deg": 7.73},
                "laser": {"pulse_rate_hz": 20000, "scan_time_s": 0.042},
                "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": 35, "columns": 24, "half_width_m": 7.1}},
                "trajectory": {"type": "constant_velocity", "position_m": [0, 0, 500], "velocity_mps": [0, 0, -23]}}

    def test_cones_and_a_rocky_site(self):
        errors = {"noise": {"range_sigma_m": 0.0167, "dropout_frac": 0.01, "dead_pixel_frac": 0.01}}
        cones = merged(json.loads(read_bytes(os.path.join(STUDIES, "cones.terrain.json"))), {"grid": {"half_width_m": 9}})
        cones["patterns"][0]["radius_m"] = 4
        rocks = merged(json.loads(read_bytes(os.path.join(STUDIES, "europa-rocks.terrain.json"))), {"grid": {"half_width_m": 9}})
        for name, terrain, limits in [("cones", cones, {"low": 0.02, "high": 0.15}), ("rocks", rocks, {"low": 0.02, "high": 0.036})]:
            with self.subTest(name):
                self.scene(terrain, self.site_scan())
                rows = self.check_verdicts({
                    "draws": 10, "scan": errors, "regrid": {"half_width_m": 7}, "eval": {"region_radius_m": 5.5},
                    "vary": {"scan.navigation_error.velocity_mps.0": {"type": "normal", "sigma": 0.3},
                             "eval.limits.relative_elevation_m": {"type": "uniform", **limits}}})
                counts = rows["accuracy.relative.z.violation_count"]
                self.assertGreater(len(set(counts)), 3, counts)
                self.assertEqual(set(rows["requirements.relative_elevation.pass"]), {0, 1}, counts)

    def test_random_scenes(self):
        """Both verdicts of every requirement occur, requirements that are not judged, and every method and shape."""
        random, seen = np.random.default_rng(20), {name: set() for name in (*PASSES, "method", "shape", "region")}
        for number in range(SCENES):
            terrain, scan, config = random_scene(random)
            with self.subTest(number, terrain=terrain, scan=scan, config=config):
                self.scene(terrain, scan)
                rows = self.check_verdicts(config)
                for name in PASSES:
                    seen[name] |= {None if math.isnan(value) else value for value in rows[name]}
                seen["method"].add(config["regrid"]["method"])
                seen["shape"].add(config["eval"]["footprint_shape"])
                seen["region"].add(config["eval"]["region"]["shape"])
        judged_or_not = dict.fromkeys((f"requirements.{name}.pass" for name in ("relative_elevation", "relative_horizontal")), 3)
        self.assertEqual({name: len(values) for name, values in seen.items()},
                         {**dict.fromkeys(PASSES, 2), **judged_or_not, "method": 6, "shape": 2, "region": 2})


def random_scene(random):
    """Terrain, scan and run of 2 draws: 25,600 rays or fewer."""
    def pick(*values):
        return values[random.integers(len(values))]

    def between(low, high):
        return float(random.uniform(low, high))

    def about(low, high):
        return math.exp(between(math.log(low), math.log(high)))

    terrain = {"grid": {"half_width_m": 6, "resolution_m": 0.1},
               "base": pick({"type": "plane", "slope_x": between(-0.4, 0.4), "slope_y": between(-0.4, 0.4)},
                            {"type": "fractal", "rms_deviation_m": between(0.01, 0.3)}),
               "features": [{"type": "cone", "x_m": between(-4, 4), "y_m": between(-4, 4), "radius_m": between(0.3, 1.5),
                             "height_m": between(0.1, 2)} for _ in range(random.integers(4))],
               "seed": int(random.integers(1000))}
    scan = with_values(SCAN, detector__roll_deg=between(0, 45), scanner__incidence_deg=between(0, 30), noise={}, navigation_error={},
                       scanner__pattern__half_width_m=between(3, 5), laser__scan_time_s=between(0.1, 0.2), seed=int(random.integers(1000)))
    limits = {"invalid_frac": about(0.001, 0.5), "hole_bins": int(about(1, 200)), "distance_bins": about(1, 10),
              "relative_elevation_m": about(0.01, 0.8), "relative_horizontal_m": about(0.005, 0.2),
              "absolute_horizontal_m": about(0.01, 0.5), "absolute_horizontal_frac": between(0.5, 1)}
    judged = {"region_radius_m": between(2, 4), "footprint_m": between(0.35, 1.5), "footprint_shape": pick("square", "disc"),
              "region": pick({"shape": "circle"}, {"shape": "square", "half_width_m": between(1.5, 3.5)}),
              "quantile": pick(0, 0.5, 0.95, 1, between(0, 1)), "limits": limits}
    noise = {"range_sigma_m": about(0.001, 0.1), "dropout_frac": pick(0, 0.02, 0.3), "dead_pixel_frac": pick(0, 0.05),
             "false_return_frac": pick(0, 0.002), "false_range_m": [40, 60]}
    config = {"draws": 2, "scan": {"noise": noise, "navigation_error": {"velocity_mps": random.normal(0, 0.2, 3).tolist()}}, "eval": judged,
              "regrid": {"half_width_m": 5, "resolution_m": pick(0.0625, 0.1, 0.2), "truth_at": pick("bin_center", "centroid"),
                         "method": pick("bilinear_nearest", "bilinear4", "mean", "min", "max", "median")}}
    return terrain, scan, config


class Dropouts(ToolTest):
    """A bin is invalid if all its returns are lost. Without other errors a return reaches the same bins in every draw."""

    DRAWS = 100
    RESOLUTION_M = 0.025
    HALF_BINS = 80
    ALLOWED = 1e-3  # probability that any bin of a run of draws is outside its bounds; the seed is fixed

    def setUp(self):
        super().setUp()
        self.succeed("terrain-gen", "-c", self.config({"grid": {"half_width_m": 4, "resolution_m": 0.5}}), "-o", self.path("terrain.h5"))
        self.succeed("scan-sim", "--terrain", self.path("terrain.h5"), "-o", self.path("scan.h5"), "-c", self.config({
            "detector": {"rows": 10, "columns": 10, "ifov_rad": 0.0012, "roll_deg": 7},
            "laser": {"pulse_rate_hz": 2000, "scan_time_s": 0.2},
            "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 2.2}},
            "trajectory": {"type": "constant_velocity", "position_m": [0, 0, 100], "velocity_mps": [0, 0, 0]}}))

    def invalid(self, method, noise):
        """The draws in which each bin is invalid."""
        self.succeed("monte-carlo", self.path("scan.h5"), "--terrain", self.path("terrain.h5"), "-o", self.path("draws.h5"), "-O", "-c",
                     self.config({"draws": self.DRAWS, "metrics": "verdict", "scan": {"noise": noise}, "eval": {"region_radius_m": 1.8, "footprint_m": 0.3},
                                  "regrid": {"half_width_m": 2, "resolution_m": self.RESOLUTION_M, "method": method}}))
        with h5py.File(self.path("draws.h5")) as file:
            share = file["p_invalid"][()].astype(float) * self.DRAWS
        np.testing.assert_allclose(share, np.round(share), atol=1e-4)
        return np.round(share).astype(int)

    def reached(self, method):
        """(bin, pixel) of every return and bin that it reaches, the bin as an index of the map."""
        points = columns(self.path("scan.h5"), "points")
        self.assertTrue((points["status"] == 0).all())
        x, y = (points[name] / self.RESOLUTION_M for name in ("x_true", "y_true"))
        first = np.floor([x, y] if method == "bilinear4" else [x + 0.5, y + 0.5]).astype(int)
        width = 2 * self.HALF_BINS + 1
        bins, pixels = [], []
        for step in itertools.product(range(2 if method == "bilinear4" else 1), repeat=2):
            col, row = first + np.array(step)[:, None] + self.HALF_BINS
            inside = (col >= 0) & (row >= 0) & (col < width) & (row < width)
            bins.append((row * width + col)[inside])
            pixels.append(points["pixel"][inside])
        return np.concatenate(bins), np.concatenate(pixels)

    def check_every_bin(self, invalid, probability):
        """Each bin's number of draws is within the exact bounds of its binomial distribution, with ALLOWED shared by all bins and
        sides, which holds for dependent bins too."""
        tail, draws = self.ALLOWED / invalid.size / 2, self.DRAWS
        k = np.arange(draws + 1)
        choose = np.array([math.lgamma(draws + 1) - math.lgamma(i + 1) - math.lgamma(draws - i + 1) for i in k])
        for p in np.unique(probability[probability < 1]):
            mass = np.exp(choose + k * math.log(p) + (draws - k) * math.log1p(-p))
            low = np.searchsorted(np.cumsum(mass), tail)
            high = draws - np.searchsorted(np.cumsum(mass[::-1]), tail)
            found = invalid[probability == p]
            self.assertTrue((low <= found.min()) and (found.max() <= high), f"p {p}: {found.min()} .. {found.max()}, not {low} .. {high}")
        self.assertTrue((invalid[probability == 1] == draws).all())

    def check_sums(self, invalid, probability):
        """Independent bins with the same probability: the sum, and the sum of squares, within four standard deviations."""
        for p in np.unique(probability[probability < 1]):
            found = invalid[probability == p]
            variance = self.DRAWS * p * (1 - p)
            if found.size * variance < 25:
                continue
            self.assertLess(abs(found.sum() - found.size * self.DRAWS * p), 4 * math.sqrt(found.size * variance), f"p {p}")
            scatter = ((found - self.DRAWS * p) ** 2).sum() / variance
            self.assertLess(abs(scatter - found.size), 4 * math.sqrt(found.size * (2 + (1 - 6 * p * (1 - p)) / variance)), f"p {p}")
            self.compared += found.size

    def test_dropouts(self):
        """d^n for n returns. With bilinear4 a return reaches 2 x 2 bins, so that only every second bin is independent."""
        for method, dropout, step in [("bilinear_nearest", 0.2, 1), ("bilinear4", 0.5, 2)]:
            with self.subTest(method):
                invalid = self.invalid(method, {"dropout_frac": dropout})
                bins, _ = self.reached(method)
                probability = dropout ** np.bincount(bins, minlength=invalid.size).astype(float).reshape(invalid.shape)
                self.check_every_bin(invalid, probability)
                self.compared = 0
                self.check_sums(invalid[::step, ::step], probability[::step, ::step])
                self.assertGreater(self.compared, 5000)

    def test_dropouts_and_dead_pixels(self):
        """A pixel that is dead, with probability f, loses its n returns in a bin together: f + (1 - f) d^n, multiplied over the pixels."""
        dropout, dead = 0.1, 0.2
        invalid = self.invalid("bilinear_nearest", {"dropout_frac": dropout, "dead_pixel_frac": dead})
        returns = np.zeros((invalid.size, 100))
        np.add.at(returns, self.reached("bilinear_nearest"), 1)
        probability = np.prod(np.where(returns > 0, dead + (1 - dead) * dropout**returns, 1), 1).round(12).reshape(invalid.shape)
        self.assertGreaterEqual(np.unique(probability).size, 5)
        self.check_every_bin(invalid, probability)


if __name__ == "__main__":
    unittest.main()
