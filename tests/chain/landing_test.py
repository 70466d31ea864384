#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Landings of draws: touchdowns and their verdict against numpy on the true terrain, closed forms, the paired table, refusals."""
import itertools
import json
import math
import unittest

import numpy as np

from harness import EVAL, HAZARD, REGRID, SCAN, columns, read_bytes, run, with_values
from oracle import hazards
from traced_draws_test import DISPERSED, FRACTAL, TracedTest

FLAT = {"grid": {"half_width_m": 6, "resolution_m": 0.1}, "base": {"type": "plane", "elevation_m": 0}}
STILL = with_values(SCAN, noise={}, navigation_error={}, trajectory__rpy_deg=[0, 0, 0], trajectory__rpy_rate_degps=[0, 0, 0])
ARMS = ("landing", "blind")
Z95 = 1.959963984540054


def draws_config(**values):
    return {"draws": 4, "scan": STILL, "regrid": REGRID, "eval": EVAL, "hazard": HAZARD, "terrain": FLAT, "landing": {}, "vary": {},
            "metrics": "verdict", "layers": False, **values}


def normal_probability(low, high, mean, sigma):
    upto = lambda x: 0.5 * math.erfc((mean - x) / (sigma * math.sqrt(2)))
    return upto(high) - upto(low)


class LandingTest(TracedTest):
    def landings(self, config, *options):
        """The rows of the draws, and the verdict on their landings."""
        self.succeed("monte-carlo", *self.arguments(config, "draws.h5", "-O", "--verdict", self.path("v.json"), *options))
        self.verdict = json.loads(read_bytes(self.path("v.json")))
        return columns(self.path("draws.h5"), "draws"), self.verdict.get("landing")


class Judgement(LandingTest):
    def check_landings(self, config, rows, z, x, y, s):
        """Each landing against the numpy measures of its place in its yaw."""
        lander = {"legs": 4, "pad_diameter_m": 0.2, "pad_height": "max", **config["hazard"]["lander"]}
        limits = config["hazard"]["limits"]
        for draw, arm in itertools.product(range(len(rows["seed"])), ARMS):
            values = {key: rows[f"{arm}.{key}"][draw] for key in ("x_m", "y_m", "yaw_deg", "slope_deg", "roughness_m", "safe")}
            turns = [hazards.pads_at(lander, s, math.radians(values["yaw_deg"]))]
            slope, rough = hazards.measures(z, {"lander": lander, "method": "contact"}, s, turns)
            column, row = (int(np.floor(values[key] / s + 0.5)) - int(round(axis[0] / s)) for key, axis in (("x_m", x), ("y_m", y)))
            inside = 0 <= row < z.shape[0] and 0 <= column < z.shape[1]
            expected = (slope[row, column], rough[row, column]) if inside else (math.nan, math.nan)
            np.testing.assert_allclose((values["slope_deg"], values["roughness_m"]), expected, atol=1e-9, err_msg=f"{arm}, draw {draw}")
            self.assertEqual(values["safe"], expected[0] <= limits["slope_deg"] and expected[1] <= limits["roughness_m"])

    def test_touchdowns_and_their_ground(self):
        """Against the files of the chain: place of the best site, error of the last pulse, yaw and ground; for three and four legs. The two
        arms share their random numbers."""
        scan = with_values(SCAN, navigation_error={"velocity_mps": [0.5, -0.3, 0], "gauss_markov": {"position_sigma_m": [0.3, 0.3, 0.1]}},
                           pointing_error={"time_stamp_sigma_s": 1e-3})
        for legs, method in ((4, "contact"), (3, "plane")):
            config = draws_config(scan=scan, terrain=FRACTAL, vary=DISPERSED, landing={"drift_time_s": 1.5, "blind_sigma_m": 0.7},
                              hazard={**HAZARD, "method": method, "lander": {**HAZARD["lander"], "legs": legs}})
            rows, verdict = self.landings(config)
            self.chain_draw(config, rows, 2)
            pulses = columns(self.path("s.h5"), "pulses")
            for axis, number in (("x", 0), ("y", 1)):
                velocity = rows["scan.navigation_error.velocity_mps.0"][2] if number == 0 else -0.3
                error = pulses[f"p{axis}_true"][-1] - pulses[f"p{axis}_est"][-1] + 1.5 * velocity
                site = rows[f"site.{axis}_m"][2]
                unit = (rows[f"landing.{axis}_m"][2] - (0 if math.isnan(site) else site) - error) / HAZARD["touchdown_sigma_m"]
                self.assertLess(abs(unit), 4)
                self.assertAlmostEqual(rows[f"blind.{axis}_m"][2], error + 0.7 * unit, places=9)
            np.testing.assert_array_equal(rows["landing.yaw_deg"], rows["blind.yaw_deg"])
            self.assertEqual(len(set(rows["landing.yaw_deg"])), 4)
            ground = columns(self.path("t.h5"))
            self.check_landings(config, rows, ground["z"], ground["x"], ground["y"], 0.1)
            self.assertEqual(verdict["safe"]["passed"], rows["landing.safe"].sum())
        self.assertEqual(rows["landing.safe"].dtype, np.int8)

    def test_seeds_share_no_touchdown(self):
        rows = [self.landings(draws_config(scan={**STILL, "seed": seed}))[0] for seed in (1, 2)]
        for name in ("landing.x_m", "landing.y_m", "landing.yaw_deg", "blind.x_m", "blind.y_m"):
            self.assertEqual(len({*rows[0][name], *rows[1][name]}), 8, name)

    def test_over_a_traced_scan(self):
        """Landings of redrawn errors."""
        config = {key: value for key, value in draws_config(scan={}, vary={"scan.navigation_error.position_m.0": {"type": "normal", "sigma": 0.5}}).items()
                  if key != "terrain"}
        self.succeed("monte-carlo", self.chain.source, "--terrain", self.chain.terrain, *self.arguments(config, "draws.h5"))
        rows, ground = columns(self.path("draws.h5"), "draws"), columns(self.chain.terrain)
        self.check_landings(config, rows, ground["z"], ground["x"], ground["y"], 0.1)


class ClosedForms(LandingTest):
    def test_plane_and_drift(self):
        """Flat terrain is safe. A velocity error of 0.3 m/s for 2 s moves a touchdown by 0.6 m."""
        error = {"navigation_error": {"velocity_mps": [0.3, 0, 0]}}
        rows, verdict = self.landings(draws_config(scan={**STILL, **error}, hazard={**HAZARD, "touchdown_sigma_m": 0}, landing={"drift_time_s": 2, "yaw_deg": 30}))
        np.testing.assert_allclose(rows["blind.x_m"], 0.6 + 0.3 * 399 / 2000, atol=1e-9)
        np.testing.assert_array_equal(rows["landing.yaw_deg"], 30)
        for arm in ARMS:
            np.testing.assert_array_equal(rows[f"{arm}.safe"], 1)
            np.testing.assert_allclose(rows[f"{arm}.slope_deg"], 0, atol=1e-9)
        self.assertEqual((verdict["both"], verdict["mcnemar_p"], verdict["difference"]["value"]), (4, 1, 0))

    def cliff(self, **values):
        """A hazard for a lander whose centre is between two values of x: a ridge along y beside the origin."""
        terrain = {**FLAT, "features": [{"type": "cone", "x_m": 1, "y_m": y / 2, "radius_m": 0.5, "height_m": 1} for y in range(-8, 9)]}
        return draws_config(terrain=terrain, hazard={**HAZARD, "lander": {"leg_radius_m": 0.4, "body_radius_m": 0.4}}, **values)

    def test_dispersion_is_the_integral_of_a_normal(self):
        """The edges of a strip of hazard are found by landings without dispersion; the share of safe landings is that of the erf."""
        places = [round(0.1 * i, 1) for i in range(-20, 41)]
        config = self.cliff(draws=len(places), landing={"blind_sigma_m": 0, "yaw_deg": 0},
                            vary={"scan.navigation_error.position_m.0": {"type": "list", "values": places}})
        rows, _ = self.landings(config)
        unsafe = rows["blind.x_m"][rows["blind.safe"] == 0]
        low, high = unsafe.min() - 0.05, unsafe.max() + 0.05
        self.assertTrue(0 < low < 0.6 and 1.4 < high < 2, (low, high))
        draws = 150
        rows, verdict = self.landings(self.cliff(draws=draws, landing={"blind_sigma_m": 0.8, "yaw_deg": 0}))
        p = 1 - normal_probability(low, high, 0, 0.8)
        self.assertLess(abs(verdict["blind"]["passed"] - draws * p), 4 * math.sqrt(draws * p * (1 - p)), p)

    def test_a_perfect_map_avoids_hazards(self):
        """Cones on a grid; touchdowns without dispersion are at the map's sites, and all safe, while without a lidar the share of safe
        ground decides."""
        terrain = {**FLAT, "features": [{"type": "cone", "x_m": x, "y_m": y, "radius_m": 0.4, "height_m": 1} for x in (-2, 0, 2) for y in (-2, 0, 2)]}
        hazard = {**HAZARD, "touchdown_sigma_m": 0, "lander": {"leg_radius_m": 0.4, "body_radius_m": 0.4}}
        rows, verdict = self.landings(draws_config(draws=60, terrain=terrain, hazard=hazard, landing={"blind_sigma_m": 1}))
        self.assertEqual(verdict["safe"]["passed"], 60)
        self.assertTrue(10 < verdict["blind"]["passed"] < 50)
        self.assertEqual(verdict["only_lidar"], 60 - verdict["blind"]["passed"])
        self.assertLess(verdict["mcnemar_p"], 1e-3)
        self.check_pairs(rows, verdict)

    def check_pairs(self, rows, verdict):
        """The paired table, McNemar's p by enumeration, the interval by its formula."""
        with_lidar, blind = (rows[f"{arm}.safe"] == 1 for arm in ARMS)
        a, b, c, d = (int((x & y).sum()) for x, y in ((with_lidar, blind), (with_lidar, ~blind), (~with_lidar, blind), (~with_lidar, ~blind)))
        self.assertEqual([verdict[key] for key in ("both", "only_lidar", "only_blind", "neither")], [a, b, c, d])
        exact = min(1, 2 * sum(math.comb(b + c, k) for k in range(min(b, c) + 1)) / 2**(b + c)) if b + c else 1
        self.assertAlmostEqual(verdict["mcnemar_p"], exact, places=12)
        n = a + b + c + d

        def wilson(k):
            centre, half = k + Z95**2 / 2, Z95 * math.sqrt(k * (n - k) / n + Z95**2 / 4)
            return (centre - half) / (n + Z95**2), (centre + half) / (n + Z95**2)
        p1, p2 = (a + b) / n, (a + c) / n
        (l1, u1), (l2, u2) = wilson(a + b), wilson(a + c)
        margins = (a + b) * (c + d) * (a + c) * (b + d)
        numerator = a * d - b * c
        phi = (max(numerator - n / 2, 0) if numerator > 0 else numerator) / math.sqrt(margins) if margins else 0
        low = p1 - p2 - math.sqrt((p1 - l1)**2 - 2 * phi * (p1 - l1) * (u2 - p2) + (u2 - p2)**2)
        high = p1 - p2 + math.sqrt((u1 - p1)**2 - 2 * phi * (u1 - p1) * (p2 - l2) + (p2 - l2)**2)
        for key, value in (("value", p1 - p2), ("low", low), ("high", high)):
            self.assertAlmostEqual(verdict["difference"][key], value, places=9)

    def test_beyond_the_terrain(self):
        """Counted and not safe, with a warning for each arm."""
        config = draws_config(scan=with_values(STILL, navigation_error={"velocity_mps": [0, 0.01, 0]}), landing={"drift_time_s": 2000})
        result = run("monte-carlo", *self.arguments(config, "draws.h5", "--verdict", self.path("v.json")))
        self.assertEqual(result.returncode, 0, result.stderr)
        landing = json.loads(read_bytes(self.path("v.json")))["landing"]
        self.assertEqual(landing["off_terrain"]["blind"], 4)
        self.assertEqual(landing["blind"]["passed"], 0)
        self.assertIn("4 of 4 landings without a lidar are not over the terrain", result.stderr)
        rows = columns(self.path("draws.h5"), "draws")
        self.assertTrue(np.isnan(rows["blind.slope_deg"]).all() and np.isnan(rows["blind.roughness_m"]).all())

    def test_sequential_test_of_the_landings(self):
        config = draws_config(draws=200, stop={"type": "sprt", "of": "landing", "p0": 0.9, "p1": 0.5},
                          scan=with_values(STILL, navigation_error={"position_m": [0.02, 0, 0]}), eval=with_values(EVAL, limits__absolute_horizontal_m=0.001))
        rows, verdict = self.landings(config)
        self.assertLess(len(rows["seed"]), 20)
        self.assertEqual(rows["pass"].sum(), 0)  # the requirements fail, and are not what is tested
        self.assertEqual(self.verdict["sprt"], "accepted")
        self.assertIn("not valid after stopping", verdict["note"])
        self.assertEqual(run("monte-carlo", *self.arguments(config, "draws.h5", "-O", "--require-pass")).returncode, 0)


class Refusals(LandingTest):
    def test_refusals(self):
        for changes, words in (({"hazard": None}, ["/landing", "hazard"]), ({"landing": None, "stop": {"type": "sprt", "of": "landing"}}, ["/stop/of", "landing"]),
                               ({"landing": {"drift_time_s": -1}}, ["/landing/drift_time_s"]), ({"landing": {"yaw": 3}}, ["/landing/yaw"]),
                               ({"hazard": {**HAZARD, "method": "plane", "lander": {"leg_radius_m": 0.15}}}, ["/hazard/lander/leg_radius_m", "2 bins"])):
            with self.subTest(changes):
                self.refuse(2, "monte-carlo", *self.arguments(draws_config(**changes), "draws.h5"), words=words, output=self.path("draws.h5"))


if __name__ == "__main__":
    unittest.main()
