#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws that trace: each is terrain-gen, scan-sim, regrid, dem-eval and hazard-map with its seeds and values, bit for bit."""
import json
import unittest

import numpy as np

from harness import EVAL, HAZARD, REGRID, SCAN, TERRAIN, columns, config_of, scanner_types, with_values
from harness.draws import DISPERSED, FRACTAL, LAYERS, DrawsTest

PATTERN = {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 4}
SCANNERS = {"gimbal": {"pattern": PATTERN}, "palmer": {"rate_hz": 40}, "polygon": {"facets": 12, "rate_hz": 3, "facet_tilt_sigma_rad": 1e-3},
            "risley": {"wedge_deg": [2, 2], "encoder_sigma_rad": 1e-4}, "flash": {},
            "table": {"path": "sweep.csv", "mechanism": "fsm", "incidence_deg": 20}}
HEIGHT = {"terrain.features.0.height_m": {"type": "uniform", "low": 0.5, "high": 2}}
TERRAIN_KEYS = {**HEIGHT, "terrain.base.slope_x": {"type": "normal", "sigma": 0.05}}
AIM = with_values(SCAN, scanner__pattern=dict(PATTERN, aim="estimate"), navigation_error={
    "gauss_markov": {"velocity_sigma_mps": [0.2, 0.2, 0.1]}, "random_walk": {"rpy_rad_per_sqrt_s": [1e-3] * 3}})
LIGHT = {"beam": {"divergence_rad": 0.01}, "surface": {"albedo": "terrain"}, "link": {"reference_pe": 150, "reference_range_m": 50},
         "detector": {**SCAN["detector"], "subpixels": 2}}
PATCHES = {**TERRAIN, "albedo": {"ground": {"type": "patches", "albedo": 0.9, "albedo_between": 0.4, "cover_frac": 0.4,
                                            "longest_wavelength_m": 4}}}
SPIRAL = {"type": "fsm", "pattern": {"type": "spiral", "radius_m": 4, "pitch_m": 0.4}}
REACH = {"height_m": 20, "descent_mps": 4, "tilt_deg": 2, "thrust_accel_mps2": 3, "gravity_mps2": 1.3}
NONE = {"position_m": [0, 0, 0], "velocity_mps": [0, 0, 0], "rpy_rad": [0, 0, 0], "rpy_rate_radps": [0, 0, 0]}


def listed(*values):
    return {"type": "list", "values": values}


# {name: (changes of the run, the draws that are compared)}.
RUNS = {
    "everything": ({"scan": AIM, "terrain": FRACTAL, "terrain_seed": "each", "vary": {**DISPERSED, **HEIGHT}, "hazard": HAZARD}, (0, 2)),
    "one ground": ({"vary": DISPERSED}, (1,)),
    **{f"scanner {name}": ({"scan": {**SCAN, "scanner": {"type": name, **values}}, "draws": 2, "vary": {**TERRAIN_KEYS, **DISPERSED}}, (1,))
       for name, values in SCANNERS.items()},
    # Echoes of which several are reported, and a geiger mode, which no scan can be redrawn with.
    **{f"receiver {receiver['type']}": ({"scan": {**SCAN, **LIGHT, "receiver": receiver}, "terrain": PATCHES, "draws": 2,
                                         "vary": {"scan.beam.divergence_rad": {"type": "uniform", "low": 0.005, "high": 0.015}}}, (1,))
       for receiver in ({"type": "leading_edge", "threshold_pe": 30}, {"type": "centroid", "threshold_pe": 20, "returns": "all"},
                        {"type": "geiger"})},
    **{str(regrid): ({"regrid": {**REGRID, **regrid}, "draws": 1,
                      "scan": {key: value for key, value in SCAN.items() if key != "navigation_error"},
                      "vary": {"scan.navigation_error.position_m.1": listed(0.4)}}, (0,))  # an index of a default
       for regrid in ({"method": "median"}, {"method": "bilinear4"}, {"truth_at": "centroid"})},
    # Hazards have p_safe, and metrics.json judges the sigmas.
    "1-sigma maps": ({"draws": 2, "uncertainty": True, "hazard": {**HAZARD, "region_radius_m": 2},
                      "vary": {**TERRAIN_KEYS, "scan.trajectory_dispersion.position_m.0": {"type": "normal", "sigma": 0.2}},
                      "regrid": {**REGRID, "uncertainty": {"range_sigma_m": 0.01, "navigation_sigma": NONE}}}, (1,)),
    # The drift at the start of the divert varies, so that draws have other sites; also in the landing.
    "reach": ({"hazard": with_values({**HAZARD, "region_radius_m": 3}, sites__reach={**REACH, "position_m": [-1, 0]}),
               "landing": {"yaw_deg": 10},
               "vary": {"hazard.sites.reach.velocity_mps.0": listed(0.3, -0.3, 0)}}, (0, 1, 2)),
    # The period of a spiral follows the scan time of the draw.
    "a value that decides a default": ({"scan": {**SCAN, "scanner": SPIRAL}, "draws": 2,
                                        "vary": {"scan.laser.scan_time_s": listed(0.2, 0.1)}}, (1,)),
}


def draws_config(**values):
    return {"draws": 3, "scan": SCAN, "regrid": REGRID, "eval": EVAL, "terrain": TERRAIN, "vary": {}, **values}


class Equality(DrawsTest):
    def test_each_draw_is_that_of_the_chain(self):
        self.config("t_s,angle_1_rad,angle_2_rad\n0,-0.02,0.02\n0.1,0.02,0.01\n0.3,-0.02,-0.03\n", "sweep.csv")
        checks = {"everything": self.check_everything, "one ground": self.check_one_ground, "scanner table": self.check_table,
                  "1-sigma maps": self.check_sigmas, "reach": self.check_sites}
        self.assertEqual({*SCANNERS, "fsm"}, scanner_types())
        for name, (values, draws) in RUNS.items():
            with self.subTest(name):
                config = draws_config(**values)
                if name == "scanner table":
                    config = with_values(config, scan__scanner__path=self.path("sweep.csv"))
                rows = self.draws(config)
                self.assertEqual((list(rows["seed"]), list(rows["draw"])), ([7] * config["draws"], list(range(config["draws"]))))
                self.assertEqual([key for key in config["vary"] if len(set(rows[key])) < config["draws"]], [])
                self.assertLess(rows["coverage.invalid_frac"].max(), 1)
                for draw in draws:
                    self.check_draw(config, rows, draw)
                checks.get(name, lambda *_: None)(config, rows)

    def check_everything(self, config, rows):
        layers = columns(self.path("draws.h5"))
        self.assertEqual({*LAYERS, "in_region", "p_judged_safe", "p_missed_hazard"} - set(layers), {"e_map_std"})
        self.assertNotIn("z_true_map", layers)
        short = self.draws({**config, "metrics": "verdict"})
        self.assertLess(set(short), set(rows))
        for name, values in short.items():
            np.testing.assert_array_equal(values, rows[name], name)

    def check_one_ground(self, config, rows):
        """All draws have one ground, so that the maps of it exist; a file of it gives the same."""
        self.assertLessEqual({*LAYERS, "z_true_map"}, set(columns(self.path("draws.h5"))))
        from_file = {key: value for key, value in config.items() if key != "terrain"}
        again = self.draws(from_file, "--terrain", self.chain.terrain, output="file.h5", scan=False)
        for name, values in rows.items():
            np.testing.assert_array_equal(again[name], values, name)

    def check_table(self, *_):
        self.assertEqual(config_of(self.path("draws.h5"))["scan"]["scanner"]["path"], "sweep.csv", "files must not reveal folders")

    def check_sigmas(self, _, rows):
        self.assertIn("uncertainty.absolute.within_1_sigma_frac", rows)
        self.assertFalse(np.isnan(rows["site.p_safe"]).all())

    def check_sites(self, _, rows):
        self.assertGreater(rows["site.x_m"][0], rows["site.x_m"][1])

    def test_sections(self):
        """A preset, a list that merges in order, --set of an element, --seed."""
        whole = self.succeed("monte-carlo", "-c", self.config({"scan": "preset:paper", "hazard": ["preset:jpl-2015", {"region_radius_m": 3}]}), "--terrain", "x",
                             "--set", "scan.navigation_error.velocity_mps.1=0.5", "--seed", 9, "--print-config").stdout
        config = json.loads(whole)
        self.assertEqual(config["scan"]["seed"], 9)
        self.assertEqual(config["hazard"]["region_radius_m"], 3)
        self.assertEqual(config["hazard"]["lander"]["legs"], 4)
        rows = self.draws(draws_config(draws=1), "--set", "scan.navigation_error.velocity_mps.1=0.5", "--seed", 11)
        self.assertEqual(list(rows["seed"]), [11])


class Refusals(DrawsTest):
    def refused(self, config, words):
        self.refuse(2, "monte-carlo", *self.arguments(config, "draws.h5"), words=words, output=self.path("draws.h5"))

    def test_keys(self):
        uniform = {"type": "uniform", "low": 1, "high": 2}
        for key, words in {"scan.draw": "number of the draw", "terrain.draw": "/terrain_seed", "hazard.region_radius_m": "bins",
                           "terrain.grid.resolution_m": "grid of the terrain", "landing.drift_time_s": "the same in all draws", "other.key": "first part"}.items():
            self.refused(draws_config(vary={key: uniform}), words=[key, words])

    def test_a_preset_that_is_not_there(self):
        self.refused(draws_config(terrain="preset:nowhere"), words=["/terrain", "no such preset"])

    def test_aim_from_an_estimate(self):
        pattern = dict(PATTERN, aim="estimate")
        self.refused(draws_config(scan=with_values(SCAN, scanner__pattern=dict(pattern, compensated=False))), words=["/scanner/pattern/aim", "compensated"])
        scan = self.path("aimed.h5")
        self.succeed("scan-sim", "-c", self.config(with_values(SCAN, scanner__pattern=pattern, noise={})), "--terrain", self.chain.terrain, "-o", scan)
        over = [scan, "--terrain", self.chain.terrain, "-o", self.path("draws.h5"), "-c"]
        noise, errors = ({"draws": 2, "regrid": REGRID, "eval": EVAL, "vary": {f"scan.{key}": {"type": "uniform", "low": 0, "high": 0.1}}}
                         for key in ("noise.range_sigma_m", "navigation_error.position_m.0"))
        self.succeed("monte-carlo", *over, self.config(noise, "mc.json"))
        self.refuse(2, "monte-carlo", *over, self.config(errors, "mc.json"), "-O", words=["navigation_error.position_m.0", "leave out the scan"])


if __name__ == "__main__":
    unittest.main()
