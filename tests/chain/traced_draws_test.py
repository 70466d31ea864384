#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws that trace: each is terrain-gen, scan-sim, regrid, dem-eval and hazard-map with its seeds and values, bit for bit."""
import itertools
import json
import unittest

import h5py
import numpy as np

from harness import EVAL, HAZARD, REGRID, SCAN, TERRAIN, ChainTest, columns, config_of, read_bytes, run, scanner_types, with_values
from monte_carlo_test import LAYERS, flat

STAGES = ("scan", "regrid", "eval", "hazard", "terrain")
TOOL_OF = {"terrain": "terrain-gen", "scan": "scan-sim", "regrid": "regrid", "eval": "dem-eval", "hazard": "hazard-map"}
PATTERN = {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 4}
SCANNERS = {"gimbal": {"pattern": PATTERN}, "palmer": {"rate_hz": 40}, "polygon": {"facets": 12, "rate_hz": 3, "facet_tilt_sigma_rad": 1e-3},
            "risley": {"wedge_deg": [2, 2], "encoder_sigma_rad": 1e-4}, "flash": {}}
DISPERSED = {**{f"scan.trajectory_dispersion.{key}.{i}": {"type": "normal", "sigma": sigma}
                for key, sigma in (("position_m", 0.2), ("velocity_mps", 0.3), ("rpy_rad", 2e-3), ("rpy_rate_radps", 5e-3)) for i in range(3)},
             "scan.pointing_error.jitter_sigma_rad": {"type": "uniform", "low": 0, "high": 2e-4},
             "scan.navigation_error.velocity_mps.0": {"type": "normal", "sigma": 0.3},
             "scan.trajectory.velocity_mps.2": {"type": "uniform", "low": -6, "high": -4},
             "eval.quantile": {"type": "uniform", "low": 0.8, "high": 1}}
TERRAIN_KEYS = {"terrain.features.0.height_m": {"type": "uniform", "low": 0.5, "high": 2}, "terrain.base.slope_x": {"type": "normal", "sigma": 0.05}}
FRACTAL = {**TERRAIN, "base": [{"type": "plane", "slope_x": 0.03}, {"type": "fractal", "hurst_exponent": 0.7, "rms_deviation_m": 0.05, "reference_length_m": 1}]}


def draws_config(**values):
    return {"draws": 3, "scan": SCAN, "regrid": REGRID, "eval": EVAL, "terrain": TERRAIN, "vary": {}, **values}


class TracedTest(ChainTest):
    def arguments(self, config, output, *options):
        return ["-c", self.config(config, "mc.json"), "-o", self.path(output), *options]

    def draws(self, config, *options, output="draws.h5"):
        self.succeed("monte-carlo", *self.arguments(config, output, "-O", *options))
        return columns(self.path(output), "draws")

    def chain_draw(self, config, rows, draw, terrain=None):
        """The files of one draw by the tools: values and the number of the draw by --set."""
        assigned = {stage: [] for stage in STAGES}
        for key in rows:
            stage, _, path = key.partition(".")
            if stage in STAGES:
                assigned[stage] += ["--set", f"{path}={float(rows[key][draw])!r}"]
        out = {name: self.path(name) for name in ("t.h5", "s.h5", "d.h5", "m.json", "h.h5", "sites.json", "score.json")}

        def tool(stage, *arguments):
            self.succeed(TOOL_OF[stage], *arguments, "-c", self.config(config.get(stage) or {}, stage + ".json"), *assigned[stage], "-O")
        if terrain is None:
            terrain = out["t.h5"]
            tool("terrain", *(["--set", f"draw={draw}"] if config.get("terrain_seed") == "each" else []), "-o", terrain)
        tool("scan", "--terrain", terrain, "--set", f"draw={draw}", "-o", out["s.h5"])
        sigma = ["--uncertainty"] if config.get("uncertainty") else []
        tool("regrid", out["s.h5"], "--terrain", terrain, *sigma, "-o", out["d.h5"])
        tool("eval", out["d.h5"], "--metrics", out["m.json"], "--metrics-only")
        found = {**flat(json.loads(read_bytes(out["m.json"])))}
        if config.get("hazard") is not None:
            tool("hazard", out["d.h5"], "--terrain", terrain, "--sites", out["sites.json"], "--score", out["score.json"], "-o", out["h.h5"])
            score, sites = (json.loads(read_bytes(out[name])) for name in ("score.json", "sites.json"))
            found.update({name: value for name, value in flat(score, "score").items() if name != "score.version"})
            if sites["sites"]:
                found.update(flat({key: value for key, value in sites["sites"][0].items() if key != "rank"}, "site"))
        return found

    def check_draw(self, config, rows, draw, terrain=None):
        expected = self.chain_draw(config, rows, draw, terrain)
        found = {name: rows[name][draw] for name in rows
                 if name.split(".")[0] not in (*STAGES, "seed", "draw", "pass", "landing", "blind")}
        self.assertEqual(set(found), set(expected))
        for name, value in expected.items():
            np.testing.assert_array_equal(found[name], value, f"{name}, draw {draw}")


class Equality(TracedTest):
    """One draw of each run through the chain."""

    def test_everything_drawn(self):
        """Ground, path, attitude, jitter, aim from an estimate with random errors, noise."""
        scan = with_values(SCAN, scanner__pattern=dict(PATTERN, aim="estimate"),
                           navigation_error={"gauss_markov": {"velocity_sigma_mps": [0.2, 0.2, 0.1]}, "random_walk": {"rpy_rad_per_sqrt_s": [1e-3] * 3}})
        config = draws_config(scan=scan, terrain=FRACTAL, terrain_seed="each", vary={**DISPERSED, "terrain.features.0.height_m": TERRAIN_KEYS["terrain.features.0.height_m"]},
                          hazard=HAZARD)
        rows = self.draws(config)
        self.assertEqual((list(rows["seed"]), list(rows["draw"])), ([7, 7, 7], [0, 1, 2]))
        for key in config["vary"]:
            self.assertEqual(len(set(rows[key])), 3, key)
        for draw in (0, 2):
            self.check_draw(config, rows, draw)
        layers = columns(self.path("draws.h5"))
        self.assertEqual({*LAYERS, "in_region", "p_judged_safe", "p_missed_hazard"} - set(layers), {"e_map_std"})
        self.assertNotIn("z_true_map", layers)
        short = self.draws({**config, "metrics": "verdict"})
        self.assertLess(set(short), set(rows))
        for name, values in short.items():
            np.testing.assert_array_equal(values, rows[name], name)

    def test_a_terrain_file_and_a_fixed_ground(self):
        """All draws have one terrain, so that the maps of it exist."""
        config = draws_config(vary=DISPERSED)
        rows = self.draws(config)
        self.check_draw(config, rows, 1)
        self.assertLessEqual({*LAYERS, "z_true_map"}, set(columns(self.path("draws.h5"))))
        from_file = {key: value for key, value in config.items() if key != "terrain"}
        again = self.draws(from_file, "--terrain", self.chain.terrain, output="file.h5")
        for name, values in rows.items():
            np.testing.assert_array_equal(again[name], values, name)

    def test_all_scanners(self):
        with open(self.path("sweep.csv"), "w", encoding="utf-8") as file:
            file.write("t_s,angle_1_rad,angle_2_rad\n0,-0.05,0.02\n1,0.05,0.01\n2,0.04,-0.03\n")
        scanners = {**SCANNERS, "table": {"path": self.path("sweep.csv"), "mechanism": "fsm", "incidence_deg": 20}}
        self.assertEqual({*scanners, "fsm"}, scanner_types())  # the fsm is that of the other tests
        for name, values in scanners.items():
            with self.subTest(name):
                scan = {**SCAN, "scanner": {"type": name, **values}}
                config = draws_config(scan=scan, draws=2, vary={**TERRAIN_KEYS, **DISPERSED})
                self.check_draw(config, self.draws(config), 1)
        self.assertEqual(config_of(self.path("draws.h5"))["scan"]["scanner"]["path"], "sweep.csv", "files must not reveal folders")

    def test_receivers(self):
        """An albedo of the ground, echoes of which several are reported, and a geiger mode, which no scan can be redrawn with."""
        light = {"beam": {"divergence_rad": 0.01}, "surface": {"albedo": "terrain"}, "link": {"reference_pe": 150, "reference_range_m": 50},
                 "detector": {**SCAN["detector"], "subpixels": 2}}
        terrain = {**TERRAIN, "albedo": {"ground": {"type": "patches", "albedo": 0.9, "albedo_between": 0.4, "cover_frac": 0.4, "longest_wavelength_m": 4}}}
        for receiver in ({"type": "leading_edge", "threshold_pe": 30}, {"type": "centroid", "threshold_pe": 20, "returns": "all"}, {"type": "geiger"}):
            with self.subTest(receiver):
                config = draws_config(scan={**SCAN, **light, "receiver": receiver}, terrain=terrain, draws=2,
                                  vary={"scan.beam.divergence_rad": {"type": "uniform", "low": 0.005, "high": 0.015}})
                self.check_draw(config, self.draws(config), 1)

    def test_methods_and_index_of_a_default(self):
        for regrid in ({"method": "median"}, {"method": "bilinear4"}, {"truth_at": "centroid"}):
            with self.subTest(regrid):
                config = draws_config(regrid={**REGRID, **regrid}, draws=1, scan={key: value for key, value in SCAN.items() if key != "navigation_error"},
                                  vary={"scan.navigation_error.position_m.1": {"type": "list", "values": [0.4]}})
                rows = self.draws(config)
                self.assertEqual(rows["scan.navigation_error.position_m.1"][0], 0.4)
                self.check_draw(config, rows, 0)

    def test_one_sigma_maps(self):
        """Hazards have p_safe, and metrics.json judges the sigmas."""
        none = {"position_m": [0, 0, 0], "velocity_mps": [0, 0, 0], "rpy_rad": [0, 0, 0], "rpy_rate_radps": [0, 0, 0]}
        config = draws_config(draws=2, uncertainty=True, hazard={**HAZARD, "region_radius_m": 2}, vary={**TERRAIN_KEYS, "scan.trajectory_dispersion.position_m.0": {"type": "normal", "sigma": 0.2}},
                          regrid={**REGRID, "uncertainty": {"range_sigma_m": 0.01, "navigation_sigma": none}})
        rows = self.draws(config)
        self.check_draw(config, rows, 1)
        self.assertIn("uncertainty.absolute.within_1_sigma_frac", rows)
        self.assertFalse(np.isnan(rows["site.p_safe"]).all())

    def test_places_within_reach(self):
        """The drift at the start of the divert varies, so that draws have other sites; also in the landing."""
        reach = {"height_m": 20, "descent_mps": 4, "position_m": [-1, 0], "tilt_deg": 2, "thrust_accel_mps2": 3, "gravity_mps2": 1.3}
        config = draws_config(hazard=with_values({**HAZARD, "region_radius_m": 3}, sites__reach=reach), landing={"yaw_deg": 10},
                          vary={"hazard.sites.reach.velocity_mps.0": {"type": "list", "values": [0.3, -0.3, 0]}})
        rows = self.draws(config)
        for draw in range(3):
            self.check_draw(config, rows, draw)
        self.assertGreater(rows["site.x_m"][0], rows["site.x_m"][1])

    def test_a_value_that_decides_a_default(self):
        """The period of a spiral follows the scan time of the draw."""
        scan = {**SCAN, "scanner": {"type": "fsm", "pattern": {"type": "spiral", "radius_m": 4, "pitch_m": 0.4}}}
        config = draws_config(scan=scan, draws=2, vary={"scan.laser.scan_time_s": {"type": "list", "values": [0.2, 0.1]}})
        self.check_draw(config, self.draws(config), 1)

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


class Division(TracedTest):
    """How draws are run does not change their file."""

    def test_threads_parts_and_a_state(self):
        for vary, seed in ((DISPERSED, "fixed"), ({**DISPERSED, "terrain.base.0.slope_x": TERRAIN_KEYS["terrain.base.slope_x"]}, "each")):
            config = draws_config(draws=5, vary=vary, metrics="verdict", terrain=FRACTAL, terrain_seed=seed)
            self.draws(config, "-t", 1)
            whole = read_bytes(self.path("draws.h5"))
            self.draws(config, "-t", 3)
            self.assertEqual(read_bytes(self.path("draws.h5")), whole)
            parts = []
            for first, end in itertools.pairwise([0, 1, 3, 5]):
                parts.append(self.path(f"{first}.h5"))
                self.draws(config, "--draws", f"{first}:{end}", output=f"{first}.h5")
            self.succeed("monte-carlo", "merge", *parts[::-1], "-O", "-o", self.path("merged.h5"))
            self.assertEqual(read_bytes(self.path("merged.h5")), whole)
            with open(self.path(".draws.h5.state"), "wb") as file:
                file.write(read_bytes(parts[0]))
            result = run("monte-carlo", *self.arguments(config, "draws.h5", "-O", "-v"))
            self.assertIn("after 1 draws", result.stderr)
            self.assertEqual(read_bytes(self.path("draws.h5")), whole)

    def test_sequential(self):
        config = draws_config(draws=100, metrics="verdict", layers=False, eval={**EVAL, "limits": dict.fromkeys(EVAL["limits"], 1000)},
                          stop={"type": "sprt", "p0": 0.9, "p1": 0.5})
        config["eval"]["limits"].update(invalid_frac=1, absolute_horizontal_frac=0)
        rows = self.draws(config)
        self.assertLess(len(rows["seed"]), 10)
        self.assertEqual(json.loads(self.verdict())["sprt"], "accepted")

    def verdict(self):
        with h5py.File(self.path("draws.h5")) as file:
            return file["verdict_json"].asstr()[()]


class Refusals(TracedTest):
    def refused(self, config, *options, words, code=2):
        self.refuse(code, "monte-carlo", *self.arguments(config, "draws.h5", *options), words=words, output=self.path("draws.h5"))

    def test_keys(self):
        uniform = {"type": "uniform", "low": 1, "high": 2}
        for key, words in {"scan.seed": "the same in all draws", "scan.draw": "number of the draw", "terrain.draw": "/terrain_seed", "regrid.resolution_m": "bins",
                           "eval.region_radius_m": "bins", "hazard.region_radius_m": "bins", "terrain.grid.resolution_m": "grid of the terrain",
                           "landing.drift_time_s": "the same in all draws", "scan.noise.nothing": "unknown key of scan",
                           "hazard.limits.slope_deg": "no section hazard", "other.key": "first part"}.items():
            self.refused(draws_config(vary={key: uniform}), words=[key, words])
        self.refused(draws_config(vary={"scan.noise.dropout_frac": {"type": "list", "values": [0, 0.1, 1.5]}}), words=["draw 2", "/noise/dropout_frac"])

    def test_a_divert_that_cannot_be_flown(self):
        reach = {"height_m": 20, "descent_mps": 4, "tilt_deg": 2, "thrust_accel_mps2": 3, "gravity_mps2": 1.3}
        config = draws_config(hazard=with_values(HAZARD, sites__reach=reach),
                          vary={"hazard.sites.reach.thrust_accel_mps2": {"type": "list", "values": [3, 2, 1.6]}})
        self.refused(config, words=["mc.json: draw 2: /hazard: /sites/reach/thrust_accel_mps2: 1.6"])

    def test_terrains(self):
        self.refused(draws_config(), "--terrain", self.chain.terrain, words=["--terrain", "section terrain", "one of them"])
        self.refused(draws_config(terrain=None), words=["--terrain", "section terrain"])
        self.refused(draws_config(terrain=None, terrain_seed="each"), "--terrain", self.chain.terrain, words=["/terrain_seed"])
        self.refused(draws_config(sigma=True, vary=TERRAIN_KEYS), words=["/sigma", "terrain varies"])
        self.refused(draws_config(terrain="europa"), words=["/terrain", "preset:NAME"])
        self.refused(draws_config(terrain="preset:nowhere"), words=["/terrain", "no such preset"])
        self.refused(draws_config(), "--engine", "opencl", words=["--engine opencl", "without a scan"])
        self.refused(draws_config(uncertainty=True, regrid={**REGRID, "method": "median"}), words=["/uncertainty", "bilinear_nearest"])

    def test_over_a_scan(self):
        """Sections for draws that trace, and a key that moves the beams: the message says what to do."""
        over = {"draws": 2, "regrid": REGRID, "eval": EVAL}
        for changes, words in (({"terrain": TERRAIN}, "/terrain"), ({"terrain_seed": "each"}, "/terrain_seed"), ({"uncertainty": True}, "/uncertainty"),
                               ({"vary": {"scan.trajectory_dispersion.position_m.0": {"type": "normal", "sigma": 1}}}, "trajectory_dispersion")):
            self.refuse(2, "monte-carlo", self.chain.source, "--terrain", self.chain.terrain, "-c", self.config({**over, **changes}, "mc.json"),
                        "-o", self.path("draws.h5"), words=[words, "leave out the scan"])

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

    def test_a_path_below_the_ground(self):
        """The third draw begins under it; which of its pulses is named depends on the threads."""
        heights = {"scan.trajectory_dispersion.position_m.2": {"type": "list", "values": [0, 5, -80]}}
        self.refused(draws_config(vary=heights), code=1, words=["draw 2", "pulse ", "below the terrain"])


if __name__ == "__main__":
    unittest.main()
