#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""monte-carlo: seeds and samples; parts and interruptions change nothing; the maps against numpy; the verdict and refusals.
draws_equality_test.py compares each draw with the chain."""
import itertools
import json
import math
import os
import unittest

import h5py
import numpy as np

from harness import EVAL, HAZARD, SCAN, columns, config_of, read_bytes, run, with_values, write_file
from harness.draws import DISPERSED, FRACTAL, LAYERS, REQUIREMENTS, DrawsTest, draws_config

NORMAL = {"type": "normal", "mean": 0}

# Every error that a replay redraws is switched on, and its keys vary.
ERRORS = {
    "noise": {"range_sigma_m": 0.01, "range_sigma_per_m": 1e-4, "incidence_sigma_rad": 1e-4, "range_bias_m": 0.002,
              "dead_pixel_frac": 0.03, "dropout_frac": 0.05, "false_return_frac": 0.001, "false_range_m": [30, 60]},
    "pointing_error": {"time_stamp_bias_s": 1e-3, "time_stamp_sigma_s": 1e-3},
    "navigation_error": {"interval_s": 0.02,
                         "random_walk": {"position_m_per_sqrt_s": [0.01, 0.02, 0.03]},
                         "gauss_markov": {"velocity_sigma_mps": [0.05, 0.02, 0.03]}},
}
VARY = {
    "scan.noise.range_sigma_m": {"type": "uniform", "low": 0, "high": 0.02},
    "scan.noise.range_sigma_per_m": {"type": "uniform", "low": 0, "high": 2e-4},
    "scan.noise.incidence_sigma_rad": {"type": "uniform", "low": 0, "high": 2e-4},
    "scan.noise.range_bias_m": {**NORMAL, "sigma": 0.01},
    "scan.noise.dead_pixel_frac": {"type": "uniform", "low": 0, "high": 0.1},
    "scan.noise.dropout_frac": {"type": "uniform", "low": 0, "high": 0.1},
    "scan.noise.false_return_frac": {"type": "uniform", "low": 0, "high": 0.01},
    "scan.noise.false_range_m.0": {"type": "uniform", "low": 40, "high": 45},
    "scan.pointing_error.time_stamp_bias_s": {**NORMAL, "sigma": 1e-3},
    "scan.pointing_error.time_stamp_sigma_s": {"type": "uniform", "low": 0, "high": 1e-3},
    **{f"scan.navigation_error.{key}.{i}": {**NORMAL, "sigma": sigma}
       for key, sigma in [("position_m", 0.05), ("velocity_mps", 0.1), ("rpy_rad", 1e-4), ("rpy_rate_radps", 1e-3)] for i in range(3)},
    "scan.navigation_error.interval_s": {"type": "uniform", "low": 0.01, "high": 0.05},
    "scan.navigation_error.random_walk.position_m_per_sqrt_s.0": {"type": "uniform", "low": 0, "high": 0.05},
    "scan.navigation_error.gauss_markov.velocity_sigma_mps.2": {"type": "uniform", "low": 0, "high": 0.05},
    "eval.limits.relative_elevation_m": {"type": "uniform", "low": 0.04, "high": 0.3},
    "eval.limits.invalid_frac": {"type": "uniform", "low": 0, "high": 0.2},
    "eval.quantile": {"type": "uniform", "low": 0.8, "high": 1},
    "eval.footprint_m": {"type": "uniform", "low": 0.5, "high": 0.9},
}


class Seeds(DrawsTest):
    def test_seeds_share_no_random_number(self):
        """Nor do the draws of one run; the number of a draw, not its place, decides."""
        vary = {**VARY, "scan.noise.range_bias_m": {"type": "uniform", "low": -0.01, "high": 0.01}}
        rows = [self.draws(draws_config(draws=12, scan={**ERRORS, "seed": seed}, vary=vary), output=f"{seed}.h5") for seed in (1, 2)]
        for name in [*vary, "accuracy.absolute.z.mean_m", "accuracy.relative.z.max_m"]:
            self.assertEqual(len({*rows[0][name], *rows[1][name]}), 24, name)

    def test_the_draw_of_a_scan_has_no_effect(self):
        """Nor has that of the configuration, with a warning."""
        rows = self.draws(draws_config(draws=3, scan=ERRORS))
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--set", "draw=5", "-o", self.path("fifth.h5"))
        again = self.draws(draws_config(draws=3, scan=ERRORS), scan=self.path("fifth.h5"), output="again.h5")
        for name, column in rows.items():
            np.testing.assert_array_equal(again[name], column, name)
        result = run("monte-carlo", *self.arguments(draws_config(draws=1, scan={"draw": 7}), "warned.h5"))
        self.assertEqual(result.returncode, 0)
        self.assertIn("mc.json: /scan/draw has no effect", result.stderr)

    def test_list_and_samples(self):
        """A list and a column of a table, CSV or HDF5, with the same values give the same draws."""
        values = {"scan.noise.range_sigma_m": [0.01, 0.1, 0.02], "scan.navigation_error.velocity_mps.1": [0.1, -0.7, 1 / 3]}
        listed = draws_config(draws=3, vary={key: {"type": "list", "values": each} for key, each in values.items()})
        rows = self.draws(listed)
        for key, each in values.items():
            self.assertEqual(list(rows[key]), each)
        self.check_draw(listed, rows, 2, scan=self.chain.scan)
        text = "\n".join([",".join(values)] + [",".join(map(repr, row)) for row in zip(*values.values())]) + "\n"
        csv = self.config(text, "samples.csv")
        with h5py.File(self.path("samples.h5"), "w") as file:
            for key, each in values.items():
                file[key] = each
        for table in (csv, self.path("samples.h5")):
            again = self.draws(draws_config(draws=299), "--samples", table, output="again.h5")
            for name, column in rows.items():
                np.testing.assert_array_equal(again[name], column, name)
        mixed = self.draws(draws_config(vary={"scan.noise.dropout_frac": {"type": "uniform", "low": 0, "high": 0.3}}), "--samples", csv)
        self.assertEqual(len(mixed["seed"]), 3)
        self.check_draw(draws_config(), mixed, 1, scan=self.chain.scan)


class Division(DrawsTest):
    """How draws are run does not change their file."""

    CONFIG = draws_config(draws=9, scan={"noise": {"dropout_frac": 0.2}}, vary={"scan.navigation_error.velocity_mps.0": {**NORMAL, "sigma": 0.1}})

    RUNS = {"maps": CONFIG, "no maps": {**CONFIG, "layers": False},
            "hazards": draws_config(draws=4, hazard={**HAZARD, "requirements": [{"name": "missed", "metric": "missed_hazard_frac", "max": 0.1}]},
                                     metrics="verdict", vary={"scan.noise.range_sigma_m": {"type": "uniform", "low": 0, "high": 0.1}}),
                 **{f"traced, {seed} ground": draws_config(draws=5, scan=SCAN, vary=vary, metrics="verdict", terrain=FRACTAL, terrain_seed=seed)
                    for seed, vary in (("fixed", DISPERSED), ("each", {**DISPERSED, "terrain.base.0.slope_x": {**NORMAL, "sigma": 0.05}}))}}

    def whole(self, *options, config=None):
        self.draws(config or self.CONFIG, *options, output="whole.h5")
        return read_bytes(self.path("whole.h5"))

    def parts(self, cuts, config=None):
        names = []
        for first, end in itertools.pairwise(cuts):
            names.append(self.path(f"{first}-{end}.h5"))
            self.succeed("monte-carlo", *self.arguments(config or self.CONFIG, names[-1], "-O", "--draws", f"{first}:{end}"))
        return names

    def test_parts(self):
        """Merged in any order, and as the state of a run; repeat_test.py tries numbers of threads."""
        for name, config in self.RUNS.items():
            with self.subTest(name):
                whole = self.whole(config=config)
                parts = self.parts([0, 1, 3, config["draws"]], config)
                ids = {h5py.File(name).attrs["file_id"] for name in [*parts, self.path("whole.h5")]}
                self.assertEqual(len(ids), 4)
                for order in (parts, parts[::-1]):
                    self.succeed("monte-carlo", "merge", *order, "-O", "-o", self.path("merged.h5"))
                    self.assertEqual(read_bytes(self.path("merged.h5")), whole)
                self.assertEqual(read_bytes(self.parts([0, config["draws"]], config)[0]), whole)
                os.rename(parts[0], self.path(".draws.h5.state"))
                result = run("monte-carlo", *self.arguments(config, "draws.h5", "-O", "-v", "-t", 3))
                self.assertIn("resumes after 1 draws", result.stderr)
                self.assertRegex(result.stderr, r"(?s)about \d min and [1-9]\d* MB of disk for up to \d+ more draws, by the first\n.*makes 3 draws at a time on 3 threads")
                self.assertEqual(read_bytes(self.path("draws.h5")), whole)

    def test_goes_on(self):
        """A state is a part from the first draw on; one of another run, or a damaged one, is not used."""
        whole = self.whole()
        state = self.path(".draws.h5.state")
        begin, middle, other = (read_bytes(self.parts(cuts, config)[0]) for cuts, config in
                                [([0, 4], None), ([3, 5], None), ([0, 4], {**self.CONFIG, "metrics": "verdict"})])
        cases = {"first draws": (0, begin, None), "a part's first draws": (3, middle, None), "a part's": (0, middle, "another run"),
                 "other metrics": (0, other, "another run"), "a DEM": (0, read_bytes(self.chain.dem), "landfall.dem"),
                 "half a file": (0, begin[:len(begin) // 2], "begins again"), "empty": (0, b"", "begins again")}
        for name, (first, content, warning) in cases.items():
            with self.subTest(name):
                write_file(state, content)
                span = [] if first == 0 else ["--draws", f"{first}:9"]
                result = run("monte-carlo", *self.arguments(self.CONFIG, "draws.h5", "-O", "-v", *span))
                self.assertEqual(result.returncode, 0, result.stderr)
                expected = whole if first == 0 else read_bytes(self.parts([3, 9])[0])
                self.assertEqual(read_bytes(self.path("draws.h5")), expected)
                self.assertIn("resumes after" if warning is None else warning, result.stderr)
                self.assertNotIn(".draws.h5.state", self.entries())


class Results(DrawsTest):
    """The maps, the verdict and the stopping rule."""

    def test_maps(self):
        """Against numpy over the chain's DEMs. Errors are rounded to 2^-30 m."""
        config = draws_config(draws=12, scan={"noise": {"dropout_frac": 0.2}},
                          eval=with_values(EVAL, limits__relative_horizontal_m=0.025, limits__absolute_horizontal_m=0.1),
                          vary={"scan.navigation_error.velocity_mps.0": {**NORMAL, "sigma": 2},
                                "scan.noise.range_bias_m": {**NORMAL, "sigma": 0.05}})
        rows = self.draws(config)
        dems, evals = [], []
        for draw in range(12):
            self.chain_draw(config, rows, draw, scan=self.chain.scan,
                            regrid=["--uncertainty", "--range-sigma", "0.01", "--navigation-sigma", "position_m=0"])
            dems.append(columns(self.path("d.h5")))
            evals.append(columns(self.path("e.h5")))
        region = evals[0]["in_region"] == 1
        z_est = np.array([dem["z_est"] for dem in dems])
        errors = {"e_z": np.array([dem["z_true"] for dem in dems]) - z_est, "e_map": np.array([dem["z_true_map"] for dem in dems]) - z_est}
        fail = np.array([layers["fail"] for layers in evals])
        maps = columns(self.path("draws.h5"))
        np.testing.assert_array_equal(maps["in_region"] == 1, region)
        np.testing.assert_array_equal(maps["p_invalid"], np.isnan(z_est).mean(0).astype(np.float32))
        np.testing.assert_array_equal(maps["count_mean"], np.mean([dem["count"] for dem in dems], 0).astype(np.float32))
        for bit, name in [(1, "rel_x"), (2, "rel_y"), (4, "rel_z"), (8, "absolute")]:
            p = np.where(region, (fail & bit != 0).mean(0), np.nan).astype(np.float32)
            np.testing.assert_array_equal(maps["p_fail_" + name], p, name)
            self.assertTrue(((p > 0) & (p < 1)).any(), name)
        for name, layer in errors.items():
            n = (~np.isnan(layer)).sum(0)
            with np.errstate(invalid="ignore", divide="ignore"):
                mean = np.nansum(layer, 0) / n
                std = np.sqrt(np.nansum((layer - mean) ** 2, 0) / (n - 1))
            std[n < 2] = np.nan
            self.assertTrue((n == 0).any() and (n == 1).any())
            if name == "e_z":
                np.testing.assert_allclose(maps["e_z_mean"], mean, rtol=1e-6, atol=2e-9)
            np.testing.assert_allclose(maps[name + "_std"], std, rtol=1e-6, atol=3e-9)
        with h5py.File(self.path("draws.h5")) as file:
            self.assertEqual({name for name, item in file.items() if isinstance(item, h5py.Dataset) and item.ndim == 2},
                             {*LAYERS, "in_region", "z_true_map"})
            self.assertEqual(file["draws"].attrs["first_draw"], 0)

    # A draw passes if its share of empty bins, which is random, is below a random limit.
    HALF = draws_config(draws=40, eval={**EVAL, "limits": dict.fromkeys(["relative_elevation_m", "relative_horizontal_m", "absolute_horizontal_m",
                                                                      "distance_bins", "hole_bins"], 1000)},
                    scan={"noise": {"dropout_frac": 0.2}}, metrics="verdict", layers=False,
                    vary={"eval.limits.invalid_frac": {"type": "uniform", "low": 0, "high": 0.05}})

    def test_verdict(self):
        rows = self.draws(self.HALF)
        verdict = self.verdict()
        self.assertEqual([rate["requirement"] for rate in verdict["rates"]], [*REQUIREMENTS, "all"])
        for rate in verdict["rates"]:
            name = rate["requirement"]
            passed = rows["pass"] if name == "all" else rows[f"requirements.{name}.pass"]
            self.assertEqual((rate["passed"], rate["draws"]), (int(passed.sum()), 40))
            k, n, z = rate["passed"], 40, 1.959963984540054
            centre, half = k / n + z * z / (2 * n), z * math.sqrt(k * (n - k) / n**3 + z * z / (4 * n * n))
            self.assertAlmostEqual(rate["wilson_low"], (centre - half) / (1 + z * z / n), places=12)
            self.assertAlmostEqual(rate["wilson_high"], (centre + half) / (1 + z * z / n), places=12)
            low = rate["exact_lower_bound"]
            self.assertAlmostEqual(sum(math.comb(n, i) * low**i * (1 - low) ** (n - i) for i in range(k, n + 1)), 0.05, places=9)
        self.assertIn(verdict["rates"][-1]["passed"], range(5, 36))
        table = self.succeed("monte-carlo", *self.arguments(self.HALF, "draws.h5", "-O", "--table")).stdout
        self.assertEqual([line.split()[0] for line in table.splitlines()], ["requirement", *REQUIREMENTS, "all"])

    def test_verdict_file(self):
        """The verdict of the output, of a run of draws, of a part and of merge."""
        for options in ((), ("--draws", "0:20"), ("--draws", "20:40")):
            name = options[1].replace(":", "-") if options else "draws"
            self.draws(self.HALF, *options, "--verdict", self.path(name + ".json"), output=name + ".h5")
            self.assertEqual(json.loads(read_bytes(self.path(name + ".json"))), self.verdict(name + ".h5"))
        self.succeed("monte-carlo", "merge", self.path("0-20.h5"), self.path("20-40.h5"), "-o", self.path("m.h5"), "--verdict", self.path("m.json"))
        self.assertEqual(read_bytes(self.path("m.json")), read_bytes(self.path("draws.json")))
        self.assertEqual(json.loads(read_bytes(self.path("m.json")))["format"], "landfall.draws_verdict")
        self.refuse(2, "monte-carlo", *self.arguments(self.HALF, "new.h5", "--verdict", self.path("new"), "--report", self.path("new")),
                    words=["same file"], output=self.path("new.h5"))

    def test_sequential_test(self):
        """It stops where Wald's rule says, with the draws of the run without it."""
        passed = self.draws(self.HALF)["pass"]
        ends = set()
        for p0, p1, alpha, beta in [(0.99, 0.97, 0.05, 0.05), (0.5, 0.2, 0.1, 0.1), (0.9, 0.6, 0.01, 0.2), (0.2, 0.02, 0.2, 0.1),
                                    (0.51, 0.5, 0.05, 0.05)]:
            with self.subTest((p0, p1)):
                config = {**self.HALF, "stop": {"type": "sprt", "p0": p0, "p1": p1, "alpha": alpha, "beta": beta}}
                expected, ratio = "running", 0
                for count, ok in enumerate(passed, 1):
                    ratio += math.log(p1 / p0) if ok else math.log((1 - p1) / (1 - p0))
                    if ratio <= math.log(beta / (1 - alpha)):
                        expected = "accepted"
                    elif ratio >= math.log((1 - beta) / alpha):
                        expected = "rejected"
                    if expected != "running":
                        break
                rows = self.draws(config)
                np.testing.assert_array_equal(rows["pass"], passed[:count])
                verdict = self.verdict()
                self.assertEqual((verdict["sprt"], verdict["note"]), (expected, "intervals are not valid after stopping"))
                result = run("monte-carlo", *self.arguments(config, "draws.h5", "-O", "--require-pass"))
                self.assertEqual(result.returncode, 0 if expected == "accepted" else 3, result.stderr)
                ends.add(expected)
        self.assertEqual(ends, {"running", "accepted", "rejected"})
        self.refuse(2, "monte-carlo", *self.arguments(config, "part.h5", "--draws", "0:4"), words=["--draws 0:4", "sequential test"],
                    output=self.path("part.h5"))

    def test_require_pass(self):
        loose = {**self.HALF, "draws": 3, "vary": {}, "eval": with_values(self.HALF["eval"], limits__invalid_frac=1)}
        self.assertEqual(run("monte-carlo", *self.arguments(loose, "draws.h5", "--require-pass")).returncode, 0)
        self.assertEqual(run("monte-carlo", *self.arguments(self.HALF, "draws.h5", "-O", "--require-pass")).returncode, 3)


class Refusals(DrawsTest):
    """Each message names file, key and value; nothing is written."""

    def refuse_draws(self, code, words, *options, scan=None, **values):
        self.refuse(code, "monte-carlo", *self.arguments(draws_config(**values), "draws.h5", *options, scan=scan), words=words,
                    output=self.path("draws.h5"))
        self.assertEqual([entry for entry in self.entries() if "draws.h5" in entry], [])

    def test_varied_keys(self):
        rays, echoes, bins = "changes the rays", "changes the echoes", "changes the bins"
        for key, word in {"scan.detector.rows": rays, "scan.laser.scan_time_s": rays, "scan.scanner.encoder_sigma_rad": rays,
                          "scan.mount.position_m.0": rays, "scan.trajectory.velocity_mps.2": rays,
                          "scan.pointing_error.jitter_sigma_rad": rays, "scan.pointing_error.misalignment_rpy_rad.0": rays,
                          "scan.pointing_error.jitter_time_s": rays, "scan.pointing_error.mirror_time_bias_s": rays, "scan.pointing_error.mirror_time_sigma_s": rays,
                          "scan.link.reference_pe": echoes, "scan.link.background_pe": echoes, "scan.beam.divergence_rad": echoes,
                          "scan.surface.albedo": echoes, "scan.receiver.threshold_pe": echoes, "scan.receiver.pulse_fwhm_s": echoes,
                          "scan.seed": "the same in all draws", "scan.draw": "number of the draw", "regrid.resolution_m": bins, "regrid.half_width_m": bins,
                          "eval.region_radius_m": bins, "eval.region.half_width_m": bins, "scan.nothing": "unknown key of scan",
                          "scan.noise.range_sigma_m.0": "unknown key", "scan.navigation_error.velocity_mps.3": "unknown key",
                          "scan.noise~3": "unknown key", "scan..": "unknown key", "scan": "unknown key", "": "unknown key",
                          "dem.x": "its first part is scan, regrid or eval", "scan.noise": "is not a number",
                          "scan.navigation_error.velocity_mps": "velocity_mps.0", "regrid.method": "is not a number"}.items():
            self.refuse_draws(2, ["mc.json", f"/vary/{key}", word], vary={key: {**NORMAL, "sigma": 1}})
        dropout = "scan.noise.dropout_frac"
        self.refuse_draws(2, ["draw 1: /scan: /noise/dropout_frac"], vary={dropout: {"type": "list", "values": [0, -1, 0, 0, 0, 0]}})
        self.refuse_draws(2, [f"/vary/{dropout}/values", "2 values", "6 draws"], vary={dropout: {"type": "list", "values": [0, 0]}})
        self.refuse_draws(2, [f"/vary/{dropout}/high", "0.1"], vary={dropout: {"type": "uniform", "low": 0.2, "high": 0.1}})

    def test_check_needs_no_scan(self):
        """--check, and an element of an array that is only a default, in both tools."""
        self.succeed("monte-carlo", "--check", "--set", "scan.navigation_error.velocity_mps.0=0.1", "--set", "scan.detector.rows=3")
        for assignment, word in [("regrid.foo=1", "/foo"), ("scan.noize=1", "noize"), ("scan.noise.dropout_frac=2", "dropout_frac"),
                                 ('vary={"eval.x": {"type": "normal", "sigma": 1}}', "/vary/eval.x")]:
            self.refuse(2, "monte-carlo", "--check", "--set", assignment, words=[word])
        shown = json.loads(self.succeed("scan-sim", "--print-config", "--set", "navigation_error.velocity_mps.0=0.1").stdout)
        self.assertEqual(shown["navigation_error"]["velocity_mps"], [0.1, 0, 0])
        config = {**draws_config(draws=1), "scan": {}}
        self.draws(config, "--set", "scan.navigation_error.velocity_mps.1=0.5")
        velocity = SCAN["navigation_error"]["velocity_mps"]
        self.assertEqual(config_of(self.path("draws.h5"))["scan"]["navigation_error"]["velocity_mps"], [velocity[0], 0.5, velocity[2]])

    def test_scans(self):
        scan = self.path("other.h5")
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--set", "pointing_error.jitter_sigma_rad=1e-4", "-o", scan)
        self.refuse_draws(2, ["other.h5", "/pointing_error/jitter_sigma_rad"], scan=scan)
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-O", "-o", scan)
        with h5py.File(scan, "a") as file:
            del file["points/range_true"]
        self.refuse_draws(1, ["other.h5", "/points/range_true"], scan=scan)


if __name__ == "__main__":
    unittest.main()
