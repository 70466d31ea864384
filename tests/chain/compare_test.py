#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall-info --compare and --at against numpy, scipy and a second computation of Newcombe's interval."""
import json
import math
import os
import unittest

import h5py
import numpy as np
from scipy import stats

from harness import DRAWS, ChainTest, MonteCarloTest, columns, read_bytes, returns_of

LAYERS = ["z_est", "count", "weight_sum", "x_true", "y_true", "z_true", "z_spread"]


def newcombe(both, only_a, only_b, neither):
    """P(A) - P(B) and the interval of method 10."""
    n = both + only_a + only_b + neither
    z = stats.norm.ppf(0.975)

    def wilson(k):
        p, d = k / n, 1 + z * z / n
        half = z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        return (p + z * z / (2 * n) - half) / d, (p + z * z / (2 * n) + half) / d

    p_a, p_b = (both + only_a) / n, (both + only_b) / n
    (low_a, high_a), (low_b, high_b) = wilson(both + only_a), wilson(both + only_b)
    product = (both + only_a) * (only_b + neither) * (both + only_b) * (only_a + neither)
    top = both * neither - only_a * only_b
    phi = 0 if product == 0 else (max(top - n / 2, 0) if top > 0 else top) / math.sqrt(product)

    def side(x, y):
        return math.sqrt(x * x - 2 * phi * x * y + y * y)

    return p_a - p_b, p_a - p_b - side(p_a - low_a, high_b - p_b), p_a - p_b + side(high_a - p_a, p_b - low_b)


class Compare(ChainTest):
    def compare(self, a, b):
        return json.loads(self.succeed("landfall-info", "--compare", a, b, "--json").stdout)

    def other_dem(self):
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-o", self.path("s2.h5"), "--seed", 8, "--set", "noise.dropout_frac=0.2")
        self.succeed("regrid", self.path("s2.h5"), "--terrain", self.chain.terrain, "-c", self.chain.config("regrid"), "-o", self.path("d2.h5"))
        return self.path("d2.h5")

    def test_layers_equal_numpy(self):
        other = self.other_dem()
        found = self.compare(self.chain.dem, other)
        self.assertTrue(found["same_grid"])
        self.assertFalse(found["same_file_id"])
        by_name = {layer["layer"]: layer for layer in found["layers"]}
        a, b = columns(self.chain.dem), columns(other)
        for name in LAYERS:
            difference = b[name].astype(float) - a[name].astype(float)
            valid = difference[np.isfinite(difference)]
            median = np.median(valid)
            wanted = {"mean": valid.mean(), "std": valid.std(), "nmad": 1.4826 * np.median(np.abs(valid - median)), "p50": median,
                      "p05": np.quantile(valid, 0.05), "p95": np.quantile(valid, 0.95), "max_abs": np.abs(valid).max()}
            self.assertEqual(by_name[name]["valid_both"], valid.size, name)
            self.assertEqual(by_name[name]["only_a"], (np.isfinite(a[name]) & ~np.isfinite(b[name])).sum(), name)
            self.assertEqual(by_name[name]["only_b"], (np.isfinite(b[name]) & ~np.isfinite(a[name])).sum(), name)
            for key, value in wanted.items():
                self.assertAlmostEqual(by_name[name][key], value, delta=1e-12 * max(1, abs(value)), msg=f"{name} {key}")

    def test_sides_change_the_sign(self):
        other = self.other_dem()
        forward = {layer["layer"]: layer for layer in self.compare(self.chain.dem, other)["layers"]}
        back = {layer["layer"]: layer for layer in self.compare(other, self.chain.dem)["layers"]}
        self.assertAlmostEqual(forward["z_est"]["mean"], -back["z_est"]["mean"], delta=1e-15)
        self.assertAlmostEqual(forward["z_est"]["p05"], -back["z_est"]["p95"], delta=1e-15)
        self.assertEqual(forward["z_est"]["only_a"], back["z_est"]["only_b"])

    def test_configuration_of_all_steps(self):
        found = self.compare(self.chain.dem, self.other_dem())["configuration"]
        self.assertEqual(found, [{"tool": "scan-sim", "key": "noise.dropout_frac", "a": 0.05, "b": 0.2},
                                 {"tool": "scan-sim", "key": "seed", "a": 7, "b": 8}])

    def test_metrics_side_by_side(self):
        self.succeed("dem-eval", self.chain.dem, "-c", self.chain.config("dem-eval"), "-o", self.path("e2.h5"), "--metrics", self.path("m2.json"),
                     "--set", "limits.relative_elevation_m=9")
        found = self.compare(self.chain.eval, self.path("e2.h5"))
        a = json.loads(read_bytes(self.chain.metrics))
        b = json.loads(read_bytes(self.path("m2.json")))
        self.assertEqual({r["name"]: (r["a"], r["b"]) for r in found["requirements"]},
                         {name: (a["requirements"][name], b["requirements"][name]) for name in a["requirements"]})
        violations = next(m for m in found["metrics"] if m["metric"] == "accuracy.relative.z.violation_count")
        values = [m["accuracy"]["relative"]["z"]["violation_count"] for m in (a, b)]
        self.assertEqual([violations["a"], violations["b"], violations["difference"]], [*values, values[1] - values[0]])
        layers = {layer["layer"]: layer for layer in found["layers"]}
        self.assertEqual(layers["fail"]["differing"], (columns(self.chain.eval)["fail"] != columns(self.path("e2.h5"))["fail"]).sum())
        self.assertGreater(layers["fail"]["differing"], 0)
        self.assertEqual(layers["e_z"]["max_abs"], 0)

    def test_a_file_with_itself(self):
        for path in (self.chain.terrain, self.chain.scan, self.chain.dem, self.chain.eval, self.chain.hazards, self.chain.draws):
            found = self.compare(path, path)
            self.assertTrue(found["same_file_id"])
            self.assertEqual(found["configuration"], [])
            self.assertTrue(all(m["difference"] in (0, None) for m in found.get("metrics", [])))
            self.assertTrue(all(layer.get("max_abs", 0) in (0, None) and layer.get("differing", 0) == 0 for layer in found.get("layers", [])))
            text = self.succeed("landfall-info", "--compare", path, path).stdout
            self.assertIn("configuration: no difference", text)

    def test_other_grids_have_no_statistics(self):
        self.succeed("regrid", self.chain.scan, "--terrain", self.chain.terrain, "-o", self.path("d.h5"),
                     "--set", "resolution_m=0.2", "--set", "half_width_m=5")
        found = self.compare(self.chain.dem, self.path("d.h5"))
        self.assertFalse(found["same_grid"])
        self.assertNotIn("layers", found)
        self.assertIn("have another size", self.succeed("landfall-info", "--compare", self.chain.dem, self.path("d.h5")).stdout)


def sign(a, b, limit, larger_is_better=False):
    """1 if b is better; 0 for a change of at most 1 %."""
    if abs(b - a) <= 0.01 * max(abs(a), abs(b), abs(limit)):
        return 0
    return 1 if (b > a) == larger_is_better else -1


class Answer(ChainTest):
    """The words of --compare agree with the numbers of metrics.json."""

    LIMITS = {"relative_elevation": 0.05, "relative_horizontal": 0.05, "absolute_horizontal": 1, "coverage": 0.01, "hole_size": 10, "hole_distance": 1}

    def evaluated(self, name, judged=None, **noise):
        """The metrics of another lidar, whose evaluation is NAME.h5."""
        keys = [f"--set=noise.{key}={value}" for key, value in noise.items()]
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-o", self.path("s.h5"), "-O", *keys)
        self.succeed("regrid", self.path("s.h5"), "--terrain", self.chain.terrain, "-c", self.chain.config("regrid"), "-o", self.path("d.h5"), "-O")
        self.succeed("dem-eval", self.path("d.h5"), "-c", self.chain.config("dem-eval"), "-o", self.path(name + ".h5"), "-O", "--metrics", self.path("m.json"),
                     *(judged or []))
        return json.loads(read_bytes(self.path("m.json")))

    def answer(self, a, b, *arguments):
        return json.loads(self.succeed("landfall-info", "--compare", self.path(a + ".h5"), self.path(b + ".h5"), "--json", *arguments).stdout)["answer"]

    def worst(self, metrics, name):
        relative, coverage = metrics["accuracy"]["relative"], metrics["coverage"]
        return {"relative_elevation": relative["z"]["max_m"], "relative_horizontal": max(relative["x"]["max_m"], relative["y"]["max_m"]),
                "absolute_horizontal": metrics["accuracy"]["absolute"]["horizontal"]["p95_m"], "coverage": coverage["invalid_frac"],
                "hole_size": coverage["largest_hole_bins"], "hole_distance": coverage["max_distance_bins"]}[name]

    def expected(self, a, b):
        """{requirement: (change, margin)} by the rule of D468."""
        changes = {}
        for name, limit in self.LIMITS.items():
            in_a, in_b = a["requirements"][name], b["requirements"][name]
            worst = sign(self.worst(a, name), self.worst(b, name), limit)
            if in_a["pass"] != in_b["pass"]:
                changes[name] = (1 if in_b["pass"] else -1, 0)
            elif in_a["pass"]:
                changes[name] = (0, worst)
            else:
                changes[name] = (sign(in_a["value"], in_b["value"], 0, name == "absolute_horizontal") or worst, 0)
        return changes

    def check(self, answer, a, b):
        words = {1: "better", -1: "worse", 0: "same"}
        changes = self.expected(a, b)
        found = {point["name"]: (point["change"], point["margin"]) for point in answer["points"]}
        self.assertEqual(found, {name: (words[change], words[margin]) for name, (change, margin) in changes.items()})
        signs = {change for change, _ in changes.values()} - {0} or {margin for _, margin in changes.values()} - {0}
        self.assertEqual(answer["conclusion"], "mixed" if len(signs) == 2 else words[signs.pop()] if signs else "equal")
        for point in answer["points"]:
            in_a, in_b = a["requirements"][point["name"]], b["requirements"][point["name"]]
            self.assertEqual((point["a"], point["b"]), (in_a["value"], in_b["value"]))
            verdicts = ["pass" if each["pass"] else "FAIL" for each in (in_a, in_b)]
            self.assertTrue(point["text"].startswith(f"{verdicts[0]} in both" if verdicts[0] == verdicts[1] else " -> ".join(verdicts)), point["text"])
            if "worst_a_m" in point:
                shown = [f"{100 * self.worst(each, point['name']):.3g} cm" for each in (a, b)]
                self.assertIn(" -> ".join(shown), point["text"])

    def test_four_pairs(self):
        middle = self.evaluated("middle", range_sigma_m=0.03, dropout_frac=0.05)
        quiet = self.evaluated("quiet", range_sigma_m=0.003, dropout_frac=0.05)
        thin = self.evaluated("thin", range_sigma_m=0.003, dropout_frac=0.15)
        for a, b, wanted in (("middle", "quiet", "better"), ("quiet", "middle", "worse"), ("middle", "thin", "mixed"), ("quiet", "quiet", "equal")):
            answer = self.answer(a, b)
            metrics = {"middle": middle, "quiet": quiet, "thin": thin}
            with self.subTest(a=a, b=b):
                self.check(answer, metrics[a], metrics[b])
                self.assertEqual(answer["conclusion"], wanted)
                text = self.succeed("landfall-info", "--compare", self.path(a + ".h5"), self.path(b + ".h5")).stdout
                self.assertIn(f"\n{answer['sentence']}\n", text)
                self.assertTrue(all(f"  {point['name']}: {point['text']}\n" in text for point in answer["points"]))

    def test_own_requirements_and_other_rules(self):
        own = 'requirements=[{"name": "flat", "metric": "statistics.z.rmse_m", "max": 0.01}]'
        a = self.evaluated("a", ["--set", own], range_sigma_m=0.1)
        b = self.evaluated("b", ["--set", own, "--set=limits.relative_elevation_m=0.04"], range_sigma_m=0.001)
        answer = self.answer("a", "b")
        point = answer["points"][-1]
        self.assertEqual((point["name"], point["verdict_a"], point["verdict_b"]),
                         ("flat", *("pass" if m["own_requirements"]["flat"]["pass"] else "FAIL" for m in (a, b))))
        self.assertEqual(answer["notes"], ["A and B are judged by different rules: limits.relative_elevation_m"])
        self.assertTrue(answer["points"][3]["text"].endswith(", limit 5 cm -> 4 cm"), answer["points"][3])
        self.assertTrue(point["text"].endswith(", limit 1 cm"), point)

    def test_what_one_of_them_does_not_judge_is_unknown(self):
        """Neither a map without truth nor bins too coarse to judge compare."""
        self.evaluated("a", range_sigma_m=0.01)
        self.succeed("regrid", self.path("s.h5"), "-c", self.chain.config("regrid"), "-o", self.path("d2.h5"))
        for name, dem, keys in (("a", "d.h5", []), ("c", "d2.h5", []), ("e", "d2.h5", ["--set=limits.invalid_frac=1"])):
            self.succeed("dem-eval", self.path(dem), "-c", self.chain.config("dem-eval"), *keys, "-o", self.path(name + ".h5"), "-O")
        three = "relative_elevation, relative_horizontal, absolute_horizontal"
        for a, b in ("ac", "ca"):
            self.assertEqual(self.answer(a, b)["sentence"], f"whether B is better is unknown for {three}")
        self.assertEqual(self.answer("a", "e")["sentence"], f"B is better: better in coverage; worse in nothing; unknown for {three}")
        rms = "rms elevation error of the bins that both have"
        self.assertEqual(self.answer("d", "d2")["sentence"], f"whether B is better is unknown for {rms}")

    def test_dems_by_their_errors(self):
        self.evaluated("a", range_sigma_m=0.03)
        a = columns(self.path("d.h5"))
        self.succeed("landfall-info", self.path("d.h5"), "--no-statistics")
        os.replace(self.path("d.h5"), self.path("first.h5"))
        self.evaluated("b", range_sigma_m=0.003)
        b = columns(self.path("d.h5"))
        answer = self.answer("first", "d")
        error_a, error_b = a["z_true"] - a["z_est"], b["z_true"] - b["z_est"]
        both = np.isfinite(error_a) & np.isfinite(error_b)
        empty, rms = answer["points"]
        self.assertEqual((empty["a"], empty["b"]), (np.isnan(a["z_est"]).sum(), np.isnan(b["z_est"]).sum()))
        for found, error in ((rms["a"], error_a), (rms["b"], error_b)):
            self.assertAlmostEqual(found, math.sqrt(np.mean(error[both] ** 2)), delta=1e-12)
        self.assertEqual(answer["conclusion"], "better")

    def test_hazard_maps_by_missed_hazards(self):
        keys = ["--set", "limits.roughness_m=0.2"]
        self.succeed("hazard-map", self.chain.dem, "-c", self.chain.config("hazard-map"), "-o", self.path("rough.h5"), *keys)
        found = json.loads(self.succeed("landfall-info", "--compare", self.chain.hazards, self.path("rough.h5"), "--json").stdout)
        scores = {metric["metric"]: metric for metric in found["metrics"]}
        missed, alarms, unknown = found["answer"]["points"]
        for point, key in ((missed, "missed_hazard_frac"), (alarms, "false_alarm_frac"), (unknown, "counts.unknown")):
            self.assertEqual((point["a"], point["b"]), (scores[key]["a"], scores[key]["b"]))
            self.assertEqual(point["change"], {1: "better", 0: "same", -1: "worse"}[sign(point["a"], point["b"], 0)])
        self.assertEqual(found["answer"]["notes"], ["A and B are judged by different rules: limits.roughness_m"])

    def test_terrains_have_no_answer(self):
        found = json.loads(self.succeed("landfall-info", "--compare", self.chain.terrain, self.chain.terrain, "--json").stdout)
        self.assertIsNone(found["answer"])


class At(ChainTest):
    def at(self, x, y, *arguments, dem=None):
        return json.loads(self.succeed("landfall-info", dem or self.chain.dem, "--at", f"{x},{y}", "--json", *arguments).stdout)

    def test_the_returns_make_the_elevation(self):
        points, layers = returns_of(self.chain.scan), columns(self.chain.dem)
        with h5py.File(self.chain.scan) as file:
            times = file["pulses/t"][()]
        column, row = np.floor(points["x_est"] / 0.1 + 0.5).astype(int), np.floor(points["y_est"] / 0.1 + 0.5).astype(int)
        checked = 0
        for i, j in [(0, 0), (7, -12), (-31, 18), (-50, 50), (20, 20), (39, -39)]:
            found = self.at(i * 0.1 + 0.04, j * 0.1 - 0.04, "--scan", self.chain.scan)
            self.assertEqual((found["column"], found["row"]), (i + 50, j + 50))
            inside = np.flatnonzero((column == i) & (row == j))
            returns = found["returns"]
            self.assertEqual([r["pulse"] for r in returns], points["pulse"][inside].tolist())
            self.assertEqual([r["pixel"] for r in returns], points["pixel"][inside].tolist())
            self.assertEqual([r["range_measured_m"] for r in returns], points["range_measured"][inside].tolist())
            for name, value in found["layers"].items():
                stored = layers[name][j + 50, i + 50]
                self.assertTrue(value == stored or (value is None and not np.isfinite(stored)), name)
            if not returns:
                continue
            checked += 1
            self.assertAlmostEqual(sum(r["share"] for r in returns), 1, delta=1e-12)
            self.assertAlmostEqual(sum(r["share"] * r["z_est_m"] for r in returns), found["layers"]["z_est"], delta=1e-12)
            self.assertAlmostEqual(sum(r["weight"] for r in returns), found["layers"]["weight_sum"], delta=1e-12)
            for r in returns:
                self.assertAlmostEqual(r["t_s"], times[r["pulse"]] - times[0], delta=1e-12)
        self.assertGreaterEqual(checked, 3)

    def test_a_scan_that_was_moved(self):
        """The returns of a scan about another centre on the same map lie, and count, where regrid put them."""
        grid = ["--set", "half_width_m=2", "--set", "resolution_m=0.5"]
        points = [(0.1, 0.2, 5), (0.9, 0.1, 6), (-0.1, 0.1, 7), (1.1, 0.9, 8)]
        for name, centre in {"a": (500000, 5200000), "b": (500001, 5199999)}.items():
            self.write(name + ".xyz", "".join(f"{500000 + x} {5200000 + y} {z}\n" for x, y, z in points))
            self.succeed("landfall-import", self.path(name + ".xyz"), "-o", self.path(name + ".h5"), "--crs", "EPSG:32632", "--center", f"{centre[0]},{centre[1]}")
        self.succeed("regrid", self.path("a.h5"), self.path("b.h5"), "-o", self.path("d.h5"), *grid)
        both = [self.at(1, 0, "--scan", self.path(name + ".h5"), dem=self.path("d.h5")) for name in "ab"]
        self.assertEqual([[r["z_est_m"] for r in found["returns"]] for found in both], [[6], [6]])
        self.assertEqual(both[0]["layers"]["count"], 2)
        self.assertAlmostEqual(both[1]["returns"][0]["x_est_m"], 0.9, delta=1e-9)
        self.assertAlmostEqual(both[1]["returns"][0]["share"], 0.5, delta=1e-6)
        self.succeed("regrid", self.path("a.h5"), self.path("b.h5"), "-o", self.path("same.h5"), "--same-frame", *grid)
        self.assertEqual(self.at(0, 1, "--scan", self.path("b.h5"), dem=self.path("same.h5"))["returns"][0]["z_est_m"], 6)

    def test_methods_without_weights(self):
        self.succeed("regrid", self.chain.scan, "-c", self.chain.config("regrid"), "-o", self.path("max.h5"), "--method", "max")
        returns = self.at(0, 0, "--scan", self.chain.scan, dem=self.path("max.h5"))["returns"]
        self.assertTrue(returns and all(r["weight"] is None and r["share"] is None for r in returns))

    def test_text(self):
        text = self.succeed("landfall-info", self.chain.dem, "--at", "0,0", "--scan", self.chain.scan).stdout
        self.assertIn("the bin at x 0 m, y 0 m (row 50, column 50; 0.1 m wide)", text)
        self.assertIn("z_est", text)
        self.assertIn("returns in it; ranges and z_est in metres", text)


class Draws(MonteCarloTest):
    def draw(self, name, judged, dropout, **scan):
        config = self.config({**DRAWS, "draws": 24, "metrics": "verdict", "layers": False, "eval": judged,
                              "scan": {"noise": {"dropout_frac": dropout}, **scan}}, name + ".json")
        self.succeed("monte-carlo", self.chain.source, "--terrain", self.chain.terrain, "-c", config, "-O", "-o", self.path(name))

    def draw_both(self, invalid_frac):
        judged = {**DRAWS["eval"], "limits": {"invalid_frac": invalid_frac, "relative_elevation_m": 9, "relative_horizontal_m": 9,
                                              "hole_bins": 10**6, "distance_bins": 10**6}}
        self.draw("a.h5", judged, 0.30)
        self.draw("b.h5", judged, 0.31)

    def test_pairs(self):
        self.draw_both(0.6)
        with h5py.File(self.path("a.h5")) as a, h5py.File(self.path("b.h5")) as b:
            middle = float(np.median(np.concatenate([f["draws/coverage.invalid_frac"][()] for f in (a, b)])))
        self.draw_both(middle)  # a limit that about half of the draws pass
        found = json.loads(self.succeed("landfall-info", "--compare", self.path("a.h5"), self.path("b.h5"), "--json").stdout)
        self.assertEqual((found["draws"], found["differing_keys"]), ({"a": 24, "b": 24, "common": 24}, []))
        a, b = columns(self.path("a.h5"), "draws"), columns(self.path("b.h5"), "draws")
        pairs = {pair["name"]: pair for pair in found["pairs"]}
        for name, column in {"coverage": "requirements.coverage.pass", "hole_size": "requirements.hole_size.pass", "all": "pass"}.items():
            in_a, in_b = a[column] == 1, b[column] == 1
            counts = [int(x.sum()) for x in (in_a & in_b, in_a & ~in_b, in_b & ~in_a, ~in_a & ~in_b)]
            self.assertEqual([pairs[name][key] for key in ("both", "only_a", "only_b", "neither")], counts)
            p = stats.binomtest(counts[1], counts[1] + counts[2]).pvalue if counts[1] + counts[2] else 1
            self.assertAlmostEqual(pairs[name]["mcnemar_p"], p, delta=1e-12)
            value, low, high = newcombe(counts[0], counts[2], counts[1], counts[3])  # P(B) - P(A)
            self.assertAlmostEqual(pairs[name]["difference"]["value"], value, delta=1e-12)
            self.assertAlmostEqual(pairs[name]["difference"]["low"], low, delta=1e-12)
            self.assertAlmostEqual(pairs[name]["difference"]["high"], high, delta=1e-12)
        self.assertGreater(pairs["coverage"]["only_a"] + pairs["coverage"]["only_b"], 0)
        for point in found["answer"]["points"]:
            pair = pairs[point["name"]]
            self.assertEqual((point["a"], point["b"]), (pair["both"] + pair["only_a"], pair["both"] + pair["only_b"]))
            change = "better" if pair["only_b"] > pair["only_a"] else "worse"
            if pair["mcnemar_p"] >= 0.05:  # draws that differ, but too few, do not show that B equals A
                change = "unknown" if pair["only_a"] + pair["only_b"] else "same"
            self.assertEqual(point["change"], change)
        changes = {point["name"]: point["change"] for point in found["answer"]["points"]}
        unknown = ", ".join(name for name, change in changes.items() if change == "unknown")
        if not {"better", "worse"} & set(changes.values()):
            self.assertEqual(found["answer"]["sentence"], f"whether B is better is unknown for {unknown}")
        self.assertEqual(found["answer"]["notes"], [])
        self.draw("c.h5", {**DRAWS["eval"], "limits": {"invalid_frac": 0.5}}, 0.3)
        found = json.loads(self.succeed("landfall-info", "--compare", self.path("a.h5"), self.path("c.h5"), "--json").stdout)
        self.assertIn("A and B are judged by different rules: eval.limits.", "".join(found["answer"]["notes"]))
        self.assertIn("McNemar", self.succeed("landfall-info", "--compare", self.path("a.h5"), self.path("b.h5")).stdout)

    def test_other_seeds_are_not_paired(self):
        self.draw("a.h5", DRAWS["eval"], 0.1)
        self.draw("b.h5", DRAWS["eval"], 0.1, seed=99)
        found = json.loads(self.succeed("landfall-info", "--compare", self.path("a.h5"), self.path("b.h5"), "--json").stdout)
        self.assertEqual(found["draws"], {"a": 24, "b": 24, "common": 0})
        self.assertNotIn("pairs", found)
        self.assertEqual(found["answer"]["conclusion"], "unknown")


if __name__ == "__main__":
    unittest.main()
