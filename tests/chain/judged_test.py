#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Verdicts need bins: a lidar with 1 m of range noise passes nowhere, and is not judged where its footprints have fewer than 5 x 5 bins."""
import json
import os
import unittest

import h5py
import numpy as np
from matplotlib.text import Text

from harness import SCAN, Chain, ChainTest, columns, read_bytes, run, with_values, write_file
from harness.commands import run_command
from harness.opencl import no_device

# pylint: disable=wrong-import-order
from landfall.plot import plot_draws as draws_figure, plot_eval as eval_figure

PLANE = {"grid": {"half_width_m": 6, "resolution_m": 0.5}, "base": {"type": "plane", "slope_x": 0.05}}
LIDAR = {key: value for key, value in with_values(SCAN, noise__range_sigma_m=1).items() if key != "navigation_error"}
JUDGED = {0.05: 35, 0.2: 9, 0.34: 5, 0.4: 5, 0.425: 5}  # posting, m: bins on an edge of a footprint of 1.7 m
UNJUDGED = {0.43: 3, 1: 1}
RELATIVE = ("relative_elevation", "relative_horizontal")
COARSEST = "0.425 m"
NO_DEVICE = no_device()


def grid_of(posting):
    return {"resolution_m": posting, "half_width_m": posting * round(4 / posting)}


class Noisy(ChainTest):
    """One scan of a plane with 1 m of noise."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.terrain, cls.scan = cls.chain.path("plane.h5"), cls.chain.path("noisy.h5")
        for name, config, arguments in (("plane.json", PLANE, ["terrain-gen", "-o", cls.terrain]),
                                        ("noisy.json", LIDAR, ["scan-sim", "--terrain", cls.terrain, "--keep-misses", "-o", cls.scan])):
            Chain.make(arguments[0], [*arguments[1:], "-c", write_file(cls.chain.path(name), json.dumps(config))])

    def dem(self, posting):
        path = self.path(f"dem-{posting}.h5")
        self.succeed("regrid", self.scan, "--terrain", self.terrain, "-c", self.config(grid_of(posting), "regrid.json"), "-O", "-o", path)
        return path


class DemEval(Noisy):
    def evaluate(self, posting, *options):
        done = run("dem-eval", self.dem(posting), "--set", "region_radius_m=3", "-O", "-o", self.path("e.h5"), "--metrics", self.path("m.json"),
                   "--report", self.path("r.html"), "--table", *options)
        return json.loads(read_bytes(self.path("m.json"))) if done.returncode in (0, 3) else None, done

    def test_every_judged_posting_fails(self):
        for posting, bins in JUDGED.items():
            with self.subTest(posting):
                metrics, done = self.evaluate(posting, "--require-pass")
                self.assertEqual(done.returncode, 3)
                self.assertEqual((metrics["accuracy"]["footprint_bins"], metrics["assumptions"]["footprint_bins"]), (bins, bins))
                self.assertIs(metrics["requirements"]["relative_elevation"]["pass"], False)
                self.assertNotIn("reason", metrics["requirements"]["relative_elevation"])
                self.assertIs(metrics["pass"], False)
                self.assertNotIn("can be judged", done.stderr)

    def test_too_few_bins_are_not_judged(self):
        wide = ["--set", "limits.invalid_frac=1", "--set", "limits.hole_bins=10000", "--set", "limits.distance_bins=100"]
        for posting, bins in UNJUDGED.items():
            with self.subTest(posting):
                metrics, done = self.evaluate(posting, *wide, "--require-pass")
                self.assertEqual(done.returncode, 3)
                self.assertEqual(metrics["version"], 2)
                self.assertEqual(metrics["assumptions"]["footprint_bins"], bins)
                self.assertIsNone(metrics["pass"])
                for name in RELATIVE:
                    found = metrics["requirements"][name]
                    self.assertEqual((found["value"], found["pass"], found["reason"]), (None, None, "footprint_bins"))
                self.assertIs(metrics["requirements"]["absolute_horizontal"]["pass"], True)
                for axis in "xyz":
                    self.assertEqual(metrics["accuracy"]["relative"][axis], {"p95_m": None, "max_m": None, "violation_count": None})
                    self.assertIsNotNone(metrics["accuracy"]["absolute"][axis]["p95_m"])
                layers = columns(self.path("e.h5"))
                self.assertTrue(all(np.isnan(layers["rel_" + axis]).all() for axis in "xyz"))
                self.assertFalse(np.isnan(layers["abs_z"][layers["in_region"] == 1]).any())
                self.assertEqual(layers["fail"].max(), 0)
                self.assertEqual(done.stderr.count(COARSEST), 1, done.stderr)
                self.assertRegex(done.stderr, rf"dem-eval: warning: [^\n]*{bins} x {bins} bins[^\n]*{COARSEST}")
                self.assertIn("missed or not judged: relative_elevation, relative_horizontal", done.stderr)
                self.assertRegex(done.stdout, r"relative_elevation +[^\n]*footprint[^\n]* not judged\n")
                self.assertRegex(done.stdout, r"all +not judged\n")
                page = read_bytes(self.path("r.html")).decode()
                self.assertIn("2 of 6 not judged: the footprint has fewer than 5 x 5 bins", page)
                self.assertIn(f"{bins} x {bins} bins", page)

    def test_another_missed_requirement_fails(self):
        metrics, done = self.evaluate(1, "--set", "limits.absolute_horizontal_m=0")
        self.assertEqual(done.returncode, 0)
        self.assertIs(metrics["pass"], False)
        self.assertIsNone(metrics["requirements"]["relative_elevation"]["pass"])

    def test_own_requirement_on_a_null_number_is_missed(self):
        own = [{"name": "worst", "metric": "accuracy.relative.z.max_m", "max": 9}, {"name": "count", "metric": "accuracy.relative.z.violation_count", "max": 9}]
        metrics, _ = self.evaluate(1, "--set", "requirements=" + json.dumps(own))
        self.assertEqual([metrics["own_requirements"][each]["pass"] for each in ("worst", "count")], [False, False])
        self.assertIs(metrics["pass"], False)

    def test_quiet(self):
        _, done = self.evaluate(1, "-q")
        self.assertEqual(done.stderr, "")


WIDE = {"limits": {"invalid_frac": 1, "hole_bins": 10000, "distance_bins": 100}}


class Draws(Noisy):
    def arguments(self, posting, *options, metrics="verdict", **values):
        config = {"draws": 3, "scan": {}, "regrid": grid_of(posting), "eval": {"region_radius_m": 3, **WIDE}, "metrics": metrics, **values}
        return [self.scan, "--terrain", self.terrain, "-c", self.config(config, "mc.json"), "-O", "-o", self.path("draws.h5"),
                "--verdict", self.path("v.json"), *options]

    def rates(self, *arguments, **values):
        done = run("monte-carlo", *self.arguments(*arguments, **values))
        rates = json.loads(read_bytes(self.path("v.json")))["rates"] if done.returncode in (0, 3) else []
        return {rate["requirement"]: rate for rate in rates}, done

    def check_attribute(self, bins):
        with h5py.File(self.path("draws.h5")) as file:
            self.assertEqual(file.attrs["footprint_bins"], bins)

    def test_every_judged_posting_fails(self):
        for metrics in ("verdict", "full"):
            for posting in (0.2, 0.34, 0.425):
                with self.subTest(posting, metrics=metrics):
                    rates, done = self.rates(posting, "--require-pass", metrics=metrics)
                    self.assertEqual(done.returncode, 3)
                    self.assertNotIn("can be judged", done.stderr)
                    for name in ("relative_elevation", "all"):
                        self.assertEqual([rates[name][key] for key in ("passed", "judged", "draws")], [0, 3, 3])
                    self.check_attribute(JUDGED[posting])
                    self.assertTrue((columns(self.path("draws.h5"), "draws")["pass"] == 0).all())

    def test_too_few_bins_are_not_judged(self):
        for metrics in ("verdict", "full"):
            for posting, bins in UNJUDGED.items():
                with self.subTest(posting, metrics=metrics):
                    rates, done = self.rates(posting, "--require-pass", "--table", "--report", self.path("r.html"), metrics=metrics)
                    self.assertEqual(done.returncode, 3)
                    self.assertEqual(done.stderr.count(COARSEST), 1, done.stderr)
                    for name in (*RELATIVE, "all"):
                        self.assertEqual(rates[name], {"requirement": name, "passed": 0, "draws": 3, "wilson_low": 0, "wilson_high": 1,
                                                       "exact_lower_bound": 0, "judged": 0})
                        self.assertRegex(done.stdout, rf"{name} +0 of 3 +not judged\n")
                    self.assertEqual([rates["coverage"][key] for key in ("passed", "judged", "draws")], [3, 3, 3])
                    self.check_attribute(bins)
                    rows = columns(self.path("draws.h5"), "draws")
                    self.assertEqual(rows["pass"].dtype, np.int8)
                    self.assertEqual(rows["pass"].tolist(), [-1, -1, -1])
                    for name in RELATIVE:
                        self.assertTrue(np.isnan([rows[f"requirements.{name}.{key}"] for key in ("value", "pass")]).all())
                    self.assertTrue(np.isnan([rows[f"accuracy.relative.{axis}.violation_count"] for axis in "xyz"]).all())
                    layers = columns(self.path("draws.h5"))
                    self.assertTrue(all(np.isnan(layers["p_fail_rel_" + axis]).all() for axis in "xyz"))
                    self.assertEqual(np.nanmax(layers["p_fail_absolute"]), 0)
                    page = read_bytes(self.path("r.html")).decode()
                    self.assertIn("not judged, because the footprint has too few bins", page)
                    self.assertIn(f"footprint of {bins} x {bins} bins", page)
                    self.assertEqual(self.succeed("landfall-info", self.path("draws.h5")).returncode, 0)

    def test_another_missed_requirement_fails(self):
        rates, _ = self.rates(1, "--set", "eval.limits.absolute_horizontal_m=0")
        self.assertEqual([rates["all"][key] for key in ("passed", "judged")], [0, 3])
        self.assertEqual(columns(self.path("draws.h5"), "draws")["pass"].tolist(), [0, 0, 0])

    def test_draws_with_different_footprints(self):
        """A draw that is not judged might pass or fail: the interval holds for both."""
        rates, done = self.rates(0.2, vary={"eval.footprint_m": {"type": "list", "values": [0.5, 1.7, 0.6]}})
        self.assertRegex(done.stderr, r"draw \d: a footprint of 0\.5 m has 3 x 3 bins")
        self.assertEqual([rates["relative_elevation"][key] for key in ("passed", "judged", "draws")], [0, 1, 3])
        self.assertGreater(rates["relative_elevation"]["wilson_high"], 0.9)
        self.assertEqual(columns(self.path("draws.h5"), "draws")["pass"].tolist(), [-1, 0, -1])
        layer = columns(self.path("draws.h5"))["p_fail_rel_z"]
        self.assertEqual(np.nanmax(layer), 1)
        with h5py.File(self.path("draws.h5")) as file:
            self.assertNotIn("footprint_bins", file.attrs)

    def test_sequential_test_is_refused_before_the_first_draw(self):
        stop = {"type": "sprt", "p0": 0.9, "p1": 0.5}
        done = self.refuse(2, "monte-carlo", *self.arguments(1, stop=stop), words=["/stop", COARSEST], output=self.path("draws.h5"))
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertEqual(run("monte-carlo", *self.arguments(0.2, stop=stop)).returncode, 0)

    def test_parts_and_comparison(self):
        parts = []
        for span in ("0:1", "1:3"):
            parts.append(self.path(span.replace(":", "-") + ".h5"))
            self.succeed("monte-carlo", *self.arguments(1), "--draws", span)
            os.replace(self.path("draws.h5"), parts[-1])
        self.succeed("monte-carlo", *self.arguments(1))
        self.succeed("monte-carlo", "merge", *parts, "-o", self.path("merged.h5"))
        self.check_attribute(1)
        for name in ("pass", "requirements.relative_elevation.pass"):
            np.testing.assert_array_equal(columns(self.path("merged.h5"), "draws")[name], columns(self.path("draws.h5"), "draws")[name])
        with h5py.File(self.path("merged.h5")) as file:
            self.assertEqual(file.attrs["footprint_bins"], 1)
        pairs = json.loads(self.succeed("landfall-info", "--compare", self.path("draws.h5"), self.path("merged.h5"), "--json").stdout)["pairs"]
        pairs = {pair["name"]: pair for pair in pairs}
        for name, not_judged in (("relative_elevation", 3), ("all", 3), ("coverage", 0)):
            self.assertEqual([pairs[name][key] for key in ("both", "neither", "not_judged")], [3 - not_judged, 0, not_judged])
        self.assertRegex(self.succeed("landfall-info", "--compare", self.path("draws.h5"), self.path("merged.h5")).stdout,
                         r"relative_elevation +not judged\n")

    @unittest.skipIf(NO_DEVICE, NO_DEVICE)
    def test_device(self):
        for posting in (0.34, 0.43, 1):
            with self.subTest(posting):
                for engine in ("cpu", "opencl"):
                    self.succeed("monte-carlo", *self.arguments(posting, "--engine", engine))
                    os.replace(self.path("draws.h5"), self.path(engine + ".h5"))
                self.assertEqual(read_bytes(self.path("opencl.h5")), read_bytes(self.path("cpu.h5")))


class Figures(Noisy):
    def test_figures_say_what_is_not_judged(self):
        config = {"draws": 2, "scan": {}, "regrid": grid_of(1), "eval": {"region_radius_m": 3, **WIDE}}
        self.succeed("monte-carlo", self.scan, "--terrain", self.terrain, "-c", self.config(config), "-o", self.path("draws.h5"))
        self.succeed("dem-eval", self.dem(1), "--set", "region_radius_m=3", "-o", self.path("eval.h5"))
        for command, name in (("plot_eval", "eval.h5"), ("plot_draws", "draws.h5")):
            done = run_command(command, self.path(name), "--dpi", 50, "-o", self.path(command + {"plot_eval": "-", "plot_draws": ".png"}[command]), cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
        figure = draws_figure.draw(draws_figure.Draws(self.path("draws.h5")))
        texts = [text.get_text() for text in figure.findobj(Text)]
        self.assertEqual(sum("not judged: the footprint has too few bins" in text for text in texts), 3)
        self.assertFalse([text for text in texts if "nan" in text])
        verdict = eval_figure.draw_verdict(eval_figure.Evaluation(self.path("eval.h5")))
        self.assertIn("not judged, the footprint has too few bins", "".join(text.get_text() for text in verdict.findobj(Text)))


class Runs(Noisy):
    def test_landfall_run(self):
        chain = {"terrain": PLANE, "scan": {**LIDAR, "noise": {"range_sigma_m": 1}}, "regrid": grid_of(1), "eval": {"region_radius_m": 3, **WIDE},
                 "hazard": None}
        done = run("landfall", "run", "-c", self.config(chain, "chain.json"), "-o", self.path("run"), "--require-pass")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(done.stderr.count(COARSEST), 1, done.stderr)
        self.assertIn("not judged", done.stdout)
        self.assertIsNone(json.loads(read_bytes(self.path("run/metrics.json")))["pass"])
        done = run("landfall", "run", "-c", self.config(chain, "chain.json"), "-o", self.path("run"), "--require-pass")
        self.assertEqual(done.returncode, 3)

    def test_plan_names_the_coarsest_judged_posting(self):
        plan = ["--plan", "--plan-radius", 10, "--plan-resolution", 0.2, "-c", self.config(LIDAR, "scan.json"), "--set",
                "scanner.pattern.half_width_m=11"]
        done = self.succeed("scan-sim", *plan, "--plan-filled", 0.9)
        self.assertRegex(done.stderr, rf"\Ascan-sim: warning: the proposed posting [^\n]*{COARSEST}\n\Z")
        self.assertEqual(self.succeed("scan-sim", *plan, "--plan-filled", 0.01).stderr, "")


class Assumptions(Noisy):
    """The assumptions of a verdict, from the terrain's nodes to metrics.json."""

    def judged(self, terrain, *options, regrid=()):
        self.succeed("regrid", self.scan, "--terrain", terrain, "--same-frame", "-c", self.config(grid_of(0.2), "g.json"), "-O", "-o", self.path("d.h5"), *regrid)
        done = run("dem-eval", self.path("d.h5"), "--set", "region_radius_m=3", "--metrics", self.path("m.json"), "-O", "--table",
                   "--report", self.path("r.html"), *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(read_bytes(self.path("m.json")))["assumptions"], done

    def terrain_of(self, **config):
        self.succeed("terrain-gen", "-c", self.config({**PLANE, **config}, "t.json"), "-O", "-o", self.path("t.h5"))
        return self.path("t.h5")

    def test_returns_and_spacing(self):
        cone = [{"type": "cone", "x_m": 1, "y_m": 0, "radius_m": 1, "height_m": 1}]
        found, done = self.judged(self.terrain_of(features=cone, grid={"half_width_m": 6, "resolution_m": 0.25}))
        layers = columns(self.path("d.h5"))
        x, y = np.meshgrid(layers["x"], layers["y"])
        counts = layers["count"][(np.rint(x / 0.2) ** 2 + np.rint(y / 0.2) ** 2 < 15 ** 2) & (layers["count"] > 0)]
        self.assertEqual(found, {"footprint_bins": 9, "truth_spacing_m": 0.25, "median_returns_per_bin": np.median(counts),
                                 "single_return_frac": np.mean(counts == 1)})
        self.assertIn("Assumptions: footprint of 9 x 9 bins,\n             truth nodes every 0.25 m,\n", done.stdout)
        self.assertIn("footprint of 9 x 9 bins; truth nodes every 0.25 m; ", read_bytes(self.path("r.html")).decode())
        self.assertNotIn("nodes", done.stderr)
        found, _ = self.judged(self.path("t.h5"), regrid=["--layers", "z_est,x_true,y_true,z_true"])
        self.assertEqual(found, {"footprint_bins": 9, "truth_spacing_m": 0.25, "median_returns_per_bin": None, "single_return_frac": None})

    def test_coarse_truth_is_warned_about(self):
        for spacing, warns in ((0.25, False), (0.5, True)):
            terrain = self.terrain_of(base={"type": "fractal", "rms_deviation_m": 0.01}, grid={"half_width_m": 6, "resolution_m": spacing})
            found, done = self.judged(terrain)
            self.assertEqual(found["truth_spacing_m"], spacing)
            self.assertEqual(done.stderr.count("nodes every 0.5 m, more than a fifth of the footprint (0.34 m)"), int(warns), done.stderr)
            table = self.succeed("hazard-map", self.path("d.h5"), "--set", "lander.leg_radius_m=0.5", "--set", "region_radius_m=3", "--table",
                                 "--report", self.path("h.html"), "-O")
            self.assertIn(f"nodes every {spacing} m, farther apart than a pad is wide (0.2 m)", table.stderr)
            self.assertIn(f"truth nodes every {spacing} m", read_bytes(self.path("h.html")).decode())
            fine = self.succeed("hazard-map", self.path("d.h5"), "--set", "lander.leg_radius_m=0.5", "--set", "lander.pad_diameter_m=0.5",
                                "--set", "region_radius_m=3", "--table")
            self.assertNotIn("farther apart", fine.stderr)

    def test_planes_are_exact(self):
        for base in (PLANE["base"], [PLANE["base"], {"type": "plane", "slope_y": 0.1}]):
            found, done = self.judged(self.terrain_of(base=base))
            self.assertIsNone(found["truth_spacing_m"])
            self.assertNotIn("nodes", done.stderr + done.stdout)
        found, _ = self.judged(self.terrain_of(patterns=[{"type": "ring", "count": 2, "radius_m": 2,
                                                          "feature": {"type": "cone", "radius_m": 1, "height_m": 1}}]))
        self.assertEqual(found["truth_spacing_m"], 0.5)

    def test_draws_have_the_same(self):
        rocks = [{"type": "hemisphere", "x_m": 1, "y_m": 0, "radius_m": 0.6}]
        self.succeed("terrain-gen", "-c", self.config({**PLANE, "features": rocks}, "t.json"), "-o", self.path("t.h5"))
        config = {"draws": 1, "metrics": "full", "scan": LIDAR, "regrid": grid_of(0.2), "eval": {"region_radius_m": 3}}
        for name, more, inputs in (("a", {}, ["--terrain", self.path("t.h5")]), ("b", {"terrain": {**PLANE, "features": rocks}}, [])):
            self.succeed("monte-carlo", *inputs, "-c", self.config({**config, **more}, "mc.json"), "-o", self.path(name + ".h5"))
            rows = columns(self.path(name + ".h5"), "draws")
            self.assertEqual(rows["assumptions.truth_spacing_m"].tolist(), [0.5])
            self.assertGreater(rows["assumptions.median_returns_per_bin"][0], 1)

    def test_own_requirement_on_returns(self):
        own = [{"name": "returns", "metric": "assumptions.median_returns_per_bin", "min": 1e9}]
        _, done = self.judged(self.terrain_of(), "--set", "requirements=" + json.dumps(own))
        self.assertRegex(done.stdout, r"returns +assumptions.median_returns_per_bin [^\n]* FAIL")


if __name__ == "__main__":
    unittest.main()
