#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall-info --compare and --at against numpy, scipy and a second computation of Newcombe's interval."""
import json
import math
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
        self.assertIn("McNemar", self.succeed("landfall-info", "--compare", self.path("a.h5"), self.path("b.h5")).stdout)

    def test_other_seeds_are_not_paired(self):
        self.draw("a.h5", DRAWS["eval"], 0.1)
        self.draw("b.h5", DRAWS["eval"], 0.1, seed=99)
        found = json.loads(self.succeed("landfall-info", "--compare", self.path("a.h5"), self.path("b.h5"), "--json").stdout)
        self.assertEqual(found["draws"], {"a": 24, "b": 24, "common": 0})
        self.assertNotIn("pairs", found)


if __name__ == "__main__":
    unittest.main()
