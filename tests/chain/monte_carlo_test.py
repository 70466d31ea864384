#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""monte-carlo: each draw is the chain's, bit for bit; parts, threads and interruptions change nothing; the maps against numpy."""
import itertools
import json
import math
import os
import resource
import signal
import unittest

import h5py
import numpy as np

from harness import EVAL, REGRID, SCAN, MonteCarloTest, columns, config_of, read_bytes, run, with_values

NORMAL = {"type": "normal", "mean": 0}
LAYERS = ["p_invalid", "p_fail_rel_x", "p_fail_rel_y", "p_fail_rel_z", "p_fail_absolute", "e_z_mean", "e_z_std", "e_map_std", "count_mean"]
REQUIREMENTS = ["coverage", "hole_size", "hole_distance", "relative_elevation", "relative_horizontal", "absolute_horizontal"]

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


def draws_config(**values):
    return {"draws": 6, "scan": {}, "regrid": REGRID, "eval": EVAL, "vary": {}, **values}


def set_path(config, path, value):
    *folders, key = [int(name) if name.isdigit() else name for name in path.split(".")]
    for folder in folders:
        config = config[folder]
    config[key] = value


def merged(base, changes):
    """As RFC 7396."""
    if not isinstance(changes, dict):
        return changes
    base = dict(base) if isinstance(base, dict) else {}
    return {**base, **{key: merged(base.get(key), value) for key, value in changes.items()}}


def flat(value, path=""):
    """The numbers of metrics.json by their dotted paths."""
    if isinstance(value, dict):
        return {name: number for key, inner in value.items() for name, number in flat(inner, f"{path}.{key}" if path else key).items()}
    if isinstance(value, (list, str)) or path in ("pass", "version"):
        return {}
    return {path: math.nan if value is None else float(value)}


class DrawsTest(MonteCarloTest):
    def arguments(self, config, output, *options, scan=None):
        return [scan or self.chain.scan, "--terrain", self.chain.terrain, "-c", self.config(config, "mc.json"), "-o", self.path(output),
                *options]

    def draws(self, config, *options, output="draws.h5", scan=None):
        """Makes draws; returns the rows of its draws."""
        self.succeed("monte-carlo", *self.arguments(config, output, "-O", *options, scan=scan))
        return columns(self.path(output), "draws")

    def verdict(self, output="draws.h5"):
        with h5py.File(self.path(output)) as file:
            return json.loads(file["verdict_json"].asstr()[()])

    def chain_draw(self, config, draw, values, *, scan=None, layers=False):
        """The metrics of one draw by scan-sim, regrid and dem-eval; with `layers` also their files' layers and H at the bins' centres."""
        scan = scan or self.chain.scan
        stages = {"scan": merged(config_of(scan), config["scan"]), "regrid": json.loads(json.dumps(config["regrid"])),
                  "eval": json.loads(json.dumps(config["eval"]))}
        for key, value in values.items():
            stage, path = key.split(".", 1)
            set_path(stages[stage], path, value)
        out = [self.path(name) for name in ("s.h5", "d.h5", "m.json", "e.h5")]
        self.succeed("scan-sim", "-c", self.config(stages["scan"], "s.json"), "--ranges-from", scan, "--terrain", self.chain.terrain,
                     "--set", f"draw={draw}", "-O", "-o", out[0])
        self.succeed("regrid", out[0], "--terrain", self.chain.terrain, "-c", self.config(stages["regrid"], "r.json"), "-O", "-o", out[1],
                     *(["--uncertainty", "--range-sigma", "0.01", "--navigation-sigma", "position_m=0"] if layers else []))
        self.succeed("dem-eval", out[1], "-c", self.config(stages["eval"], "e.json"), "-O", "--metrics", out[2],
                     *(["-o", out[3]] if layers else ["--metrics-only"]))
        metrics = json.loads(read_bytes(out[2]))
        return (metrics, columns(out[1]), columns(out[3])) if layers else metrics

    def check_draw(self, rows, config, draw, **options):
        values = {key: rows[key][draw] for key in rows if key.split(".")[0] in ("scan", "regrid", "eval")}
        metrics = self.chain_draw(config, draw, values, **options)
        expected = flat(metrics)
        found = {name: rows[name][draw] for name in rows if name not in values and name not in ("seed", "draw", "pass")}
        if config.get("metrics", "full") == "full":
            self.assertEqual(list(found), list(expected))
        np.testing.assert_array_equal([expected[name] for name in found], list(found.values()))
        self.assertEqual({1: True, 0: False, -1: None}[rows["pass"][draw]], metrics["pass"])


class Equality(DrawsTest):
    """Draws equal the chain's."""

    def test_every_error_varied(self):
        config = draws_config(draws=12, scan=ERRORS, vary=VARY)
        rows = self.draws(config)
        self.assertEqual((set(rows["seed"]), list(rows["draw"])), ({SCAN["seed"]}, list(range(12))))
        self.assertEqual({key for key in rows if key.split(".")[0] in ("scan", "regrid", "eval")}, set(VARY))
        for key in VARY:
            self.assertEqual(len(set(rows[key])), 12, key)
        for draw in (0, 3, 11):
            with self.subTest(draw):
                self.check_draw(rows, config, draw)
        short = self.draws({**config, "metrics": "verdict"})
        self.assertGreater(len(rows), len(short))
        for name, values in short.items():
            np.testing.assert_array_equal(values, rows[name], name)
        for name in ("coverage", "hole_size", "hole_distance", "relative_elevation", "relative_horizontal", "absolute_horizontal"):
            self.assertIn(f"requirements.{name}.pass", short)
        self.assertIn(0, rows["requirements.coverage.pass"])  # both verdicts occur
        self.assertIn(1, rows["requirements.coverage.pass"])

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

    def test_sources_and_methods(self):
        """A source with its misses kept, with false returns of its own, and the other methods of regrid."""
        scan = self.path("source.h5")
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--set", "noise.dropout_frac=0.1", "--set", "noise.dead_pixel_frac=0.1",
                     "--set", "scanner.pattern.half_width_m=6", "--keep-misses", "-o", scan)
        for regrid in ({"method": "bilinear4"}, {"method": "mean"}, {"method": "median"}, {"truth_at": "centroid"}):
            with self.subTest(regrid):
                config = draws_config(draws=2, regrid={**REGRID, **regrid}, scan={"noise": {"dropout_frac": 0.02}, "seed": 90})
                rows = self.draws(config, scan=scan)
                self.assertEqual((list(rows["seed"]), list(rows["draw"])), ([90, 90], [0, 1]))
                self.check_draw(rows, config, 1, scan=scan)

    def test_list_and_samples(self):
        """A list and a column of a table, CSV or HDF5, with the same values give the same draws."""
        values = {"scan.noise.range_sigma_m": [0.01, 0.1, 0.02], "scan.navigation_error.velocity_mps.1": [0.1, -0.7, 1 / 3]}
        listed = draws_config(draws=3, vary={key: {"type": "list", "values": each} for key, each in values.items()})
        rows = self.draws(listed)
        for key, each in values.items():
            self.assertEqual(list(rows[key]), each)
        self.check_draw(rows, listed, 2)
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
        self.check_draw(mixed, draws_config(), 1)


class Division(DrawsTest):
    """How draws are run does not change their file."""

    CONFIG = draws_config(draws=9, scan={"noise": {"dropout_frac": 0.2}}, vary={"scan.navigation_error.velocity_mps.0": {**NORMAL, "sigma": 0.1}})

    def whole(self, *options, config=None):
        self.draws(config or self.CONFIG, *options, output="whole.h5")
        return read_bytes(self.path("whole.h5"))

    def parts(self, cuts, config=None):
        names = []
        for first, end in itertools.pairwise(cuts):
            names.append(self.path(f"{first}-{end}.h5"))
            self.succeed("monte-carlo", *self.arguments(config or self.CONFIG, names[-1], "-O", "--draws", f"{first}:{end}"))
        return names

    def test_threads(self):
        for metrics in ("full", "verdict"):
            config = {**self.CONFIG, "metrics": metrics}
            self.assertEqual(len({self.whole("-t", threads, config=config) for threads in (1, 2, 7)}), 1)

    def test_parts(self):
        """Merged in any order; without layers too."""
        for layers in (True, False):
            config = {**self.CONFIG, "layers": layers}
            whole = self.whole(config=config)
            parts = self.parts([0, 2, 3, 7, 9], config)
            ids = {h5py.File(name).attrs["file_id"] for name in [*parts, self.path("whole.h5")]}
            self.assertEqual(len(ids), 5)
            for order in (parts, parts[::-1]):
                self.succeed("monte-carlo", "merge", *order, "-O", "-o", self.path("merged.h5"))
                self.assertEqual(read_bytes(self.path("merged.h5")), whole)
            self.assertEqual(read_bytes(self.parts([0, 9], config)[0]), whole)

    def test_parts_that_do_not_fit(self):
        parts = self.parts([0, 2, 5, 9])
        out = ["-o", self.path("merged.h5")]
        overlapping = self.parts([4, 9])
        other = self.parts([5, 9], {**self.CONFIG, "metrics": "verdict"})
        self.refuse(2, "monte-carlo", "merge", *parts[:2], *overlapping, *out, words=["4-9.h5 (draws 4:9): overlaps ", "2-5.h5 (draws 2:5)"])
        self.refuse(2, "monte-carlo", "merge", parts[0], parts[0], *out, words=["overlaps"])
        self.refuse(2, "monte-carlo", "merge", parts[0], parts[1], *out, words=["2-5.h5", "draws 5:9 are missing"])
        self.refuse(2, "monte-carlo", "merge", parts[1], parts[0], *other, *out, words=["is not a part of the same run as"])
        parts = self.parts([0, 2, 5, 9])
        self.refuse(2, "monte-carlo", "merge", parts[0], parts[2], *out, words=["5-9.h5", "draws 2:5 are missing"])
        self.refuse(2, "monte-carlo", "merge", *parts[1:], *out, words=["2-5.h5", "draws 0:2 are missing"])
        self.refuse(1, "monte-carlo", "merge", parts[0], self.chain.dem, *out, words=["dem.h5", "landfall.dem"])
        self.refuse(1, "monte-carlo", "merge", parts[0], self.path("none.h5"), *out, words=["none.h5"])
        self.refuse(2, "monte-carlo", "merge", *out, words=["parts"])

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
                with open(state, "wb") as file:
                    file.write(content)
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
        chain = [self.chain_draw(config, i, {key: rows[key][i] for key in config["vary"]}, layers=True) for i in range(12)]
        dems, evals = [dem for _, dem, _ in chain], [layers for *_, layers in chain]
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
        for options, words in ((("--verdict", "-"), "--verdict needs a file; --json prints it"),
                               (("--verdict", self.path("m.json")), "m.json"), (("--verdict", self.chain.scan, "-O"), self.chain.scan),
                               (("--verdict", self.path("new"), "--report", self.path("new")), "same file")):
            self.refuse(2, "monte-carlo", *self.arguments(self.HALF, "new.h5", *options), words=[words], output=self.path("new.h5"))

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

    def test_configurations(self):
        self.refuse_draws(2, ["/draws: 0 "], draws=0)
        self.refuse_draws(2, ["/eval/region_radius_m: 50", "5.1"], eval={**EVAL, "region_radius_m": 50})
        self.refuse_draws(2, ["/scan/navigation_error/velocity_mps/3", "array of 3"], "--set", "scan.navigation_error.velocity_mps.3=1")
        self.refuse_draws(2, ["/detector/rows differs"], "--set", "scan.detector.rows=9")
        self.refuse_draws(2, ["/pointing_error/jitter_sigma_rad differs"], "--set", "scan.pointing_error.jitter_sigma_rad=0.001")
        self.refuse_draws(2, ["/stop/p1: 0.6"], stop={"type": "sprt", "p0": 0.5, "p1": 0.6})
        self.refuse_draws(2, ["--draws 0:7", "6 draws"], "--draws", "0:7")
        for text in ("3:2", "x", "-1:2", "1", "1:2:3", "2:2"):
            self.refuse_draws(2, [f"--draws {text}", "A:B"], f"--draws={text}")

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

    def test_samples(self):
        key = "scan.noise.dropout_frac"
        for code, word, text in [(1, "is empty", ""), (1, "no row", f"{key}\n"), (1, "'x'", f"{key}\nx\n"), (1, "row 1", f"{key}\nnan\n"),
                                 (1, "given twice", f"{key},{key}\n0,0\n"), (2, "foo: unknown key", "foo\n1\n"),
                                 (2, "t: unknown key", f"{key},t\n0,0\n"), (1, "1e999", f"{key}\n1e999\n"),
                                 (1, "line 3", f"{key}\n0\n0,1\n"), (2, "changes the rays", "scan.detector.rows\n8\n")]:
            samples = self.config(text, "samples.csv")
            self.refuse_draws(code, ["samples.csv", word], "--samples", samples)
        self.refuse_draws(1, ["none.csv"], "--samples", self.path("none.csv"))
        samples = self.config(f"{key}\n0.1\n", "samples.csv")
        self.refuse_draws(2, [f"/vary/{key}", "samples"], "--samples", samples, vary={key: {**NORMAL, "sigma": 1}})

    def test_scans(self):
        for options, code, word in [(["--set", "noise.dropout_frac=0.1"], 2, "--keep-misses"), (["--float32"], 2, "single precision"),
                                    (["--set", "pointing_error.jitter_sigma_rad=1e-4"], 2, "/pointing_error/jitter_sigma_rad")]:
            scan = self.path("other.h5")
            self.succeed("scan-sim", *self.chain.inputs("scan-sim"), *options, "-O", "-o", scan)
            self.refuse_draws(code, ["other.h5", word], scan=scan)
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-O", "-o", scan)
        with h5py.File(scan, "a") as file:
            del file["points/range_true"]
        self.refuse_draws(1, ["other.h5", "/points/range_true"], scan=scan)
        self.refuse_draws(1, ["dem.h5", "landfall.scan"], scan=self.chain.dem)
        terrain = self.path("terrain.h5")
        self.succeed("terrain-gen", "-c", self.chain.config("terrain-gen"), "--set", "base.elevation_m=1", "-o", terrain)
        self.refuse(2, "monte-carlo", self.chain.scan, "--terrain", terrain, "-c", self.config(draws_config()), "-o", self.path("draws.h5"),
                    words=["scan.h5", "terrain"], output=self.path("draws.h5"))

    def test_a_full_disk_keeps_the_state(self):
        """The finished draws are there after the output could not be written."""
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        self.draws(draws_config(), output="whole.h5")
        self.draws(draws_config(), "--draws", "0:4", output="part.h5")
        os.rename(self.path("part.h5"), self.path(".draws.h5.state"))
        self.refuse(1, "monte-carlo", *self.arguments(draws_config(), "draws.h5"), words=["draws.h5"], output=self.path("draws.h5"),
                    preexec_fn=limit)
        self.assertIn("resumes after 4 draws", run("monte-carlo", *self.arguments(draws_config(), "draws.h5", "-v")).stderr)
        self.assertEqual(read_bytes(self.path("draws.h5")), read_bytes(self.path("whole.h5")))


if __name__ == "__main__":
    unittest.main()
