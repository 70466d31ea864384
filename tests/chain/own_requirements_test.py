#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Requirements of the user's own: verdicts, exit codes, tables and reports of dem-eval, hazard-map, landfall-info and monte-carlo."""
import json
import unittest

import h5py
import numpy as np

import monte_carlo_test as base
from harness import EVAL, HAZARD, read_bytes, run
from harness.commands import run_command

LE90 = {"name": "vertical LE90", "metric": "statistics.z.le90_m", "max": 0.5}
VALID = {"name": "valid", "metric": "statistics.valid_frac", "min": 1.01}
CORRECTED = {"name": "corrected", "metric": "statistics.z_corrected.le90_m", "max": 1}
MISSED = {"name": "missed", "metric": "missed_hazard_frac", "max": 1}
BRIER = {"name": "brier", "metric": "brier", "max": 1}
WIDE = {"relative_elevation_m": 9, "relative_horizontal_m": 9, "absolute_horizontal_m": 9, "invalid_frac": 1, "hole_bins": 10000, "distance_bins": 1000}


def at(tree, path):
    for key in path.split("."):
        tree = tree[key]
    return tree


class Own(base.DrawsTest):
    def evaluate(self, *requirements, code=0, options=("--require-pass",)):
        """metrics.json and what the tool says."""
        config = {**EVAL, "limits": WIDE, "requirements": list(requirements)}
        done = run("dem-eval", self.chain.dem, "-c", self.config(config, "e.json"), "-O", "-o", self.path("e.h5"), "--metrics", self.path("m.json"),
                   "--table", *options)
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads(read_bytes(self.path("m.json"))), done

    def map_hazards(self, *requirements, options=("--require-safe",), code=0):
        config = {**HAZARD, "requirements": list(requirements), "sites": {**HAZARD.get("sites", {}), "min_p": 0}}
        done = run("hazard-map", self.chain.dem, "-c", self.config(config, "h.json"), "-O", "-o", self.path("h.h5"), "--table",
                   "--report", self.path("h.html"), *options)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def test_verdicts_in_metrics(self):
        metrics, done = self.evaluate(LE90, VALID, code=3)
        for own in (LE90, VALID):
            found, value = metrics["own_requirements"][own["name"]], at(metrics, own["metric"])
            limit = own.get("max", own.get("min"))
            self.assertEqual(found, {"metric": own["metric"], "value": value, "limit": limit, "at_least": "min" in own,
                                     "pass": value >= limit if "min" in own else value <= limit})
        self.assertTrue(all(each["pass"] for each in metrics["requirements"].values()))
        self.assertIs(metrics["pass"], False)
        self.assertIn("missed or not judged: valid\n", done.stderr)
        rows = [line.split() for line in done.stdout.splitlines()]
        self.assertIn(["vertical", "LE90", "statistics.z.le90_m", f"{100 * at(metrics, LE90['metric']):.3g}", "cm", "50", "cm", "pass"], rows)
        self.assertIn(["all", "FAIL"], rows)

    def test_all_met(self):
        metrics, done = self.evaluate(LE90)
        self.assertIs(metrics["pass"], True)
        self.assertIn("all                                                                        pass", done.stdout)

    def test_no_requirement_changes_nothing(self):
        self.succeed("dem-eval", self.chain.dem, "-c", self.chain.config("dem-eval"), "-o", self.path("e.h5"), "--metrics", self.path("m.json"))
        self.assertEqual(read_bytes(self.path("m.json")), read_bytes(self.chain.metrics))
        self.assertNotIn("own_requirements", json.loads(read_bytes(self.path("m.json"))))

    def test_null_is_not_met(self):
        metrics, done = self.evaluate(CORRECTED, code=3)
        self.assertIsNone(metrics["own_requirements"]["corrected"]["value"])
        self.assertIs(metrics["own_requirements"]["corrected"]["pass"], False)
        self.assertIn("statistics.z_corrected.le90_m: no value", done.stdout)

    def test_evaluation_file_and_info(self):
        self.evaluate(LE90, VALID, code=0, options=())
        with h5py.File(self.path("e.h5")) as file:
            verdict = json.loads(file["verdict_json"].asstr()[()])
        self.assertEqual([row["requirement"] for row in verdict][6:], ["vertical LE90", "valid"])
        self.assertEqual([row["verdict"] for row in verdict][6:], ["pass", "FAIL"])
        self.assertRegex(self.succeed("landfall-info", self.path("e.h5")).stdout, r"valid +statistics.valid_frac [\d.]+ % +>= 101 % FAIL")
        compared = json.loads(self.succeed("landfall-info", "--compare", self.chain.eval, self.path("e.h5"), "--json").stdout)
        by_name = {each["name"]: each for each in compared["requirements"]}
        self.assertIsNone(by_name["valid"]["a"])
        self.assertIs(by_name["valid"]["b"]["pass"], False)

    def test_report(self):
        self.succeed("dem-eval", self.chain.dem, "-c", self.config({**EVAL, "requirements": [VALID]}, "e.json"), "--report", self.path("r.html"))
        page = read_bytes(self.path("r.html")).decode()
        self.assertIn('<tr data-requirement="valid"><th scope="row">valid</th>', page)
        self.assertIn("1 of 1 custom requirements missed", page)

    def test_hazards(self):
        self.map_hazards(MISSED, options=("--require-safe", "--score", self.path("s.json")))
        score = json.loads(read_bytes(self.path("s.json")))
        self.assertIs(score["pass"], True)
        self.assertEqual(score["own_requirements"], {"missed": {"metric": "missed_hazard_frac", "value": score["missed_hazard_frac"], "limit": 1,
                                                                "at_least": False, "pass": True}})
        done = self.map_hazards(MISSED, {**MISSED, "name": "none", "max": -1}, BRIER, code=3)
        self.assertIn("missed: none, brier", done.stderr)  # the map has no p_safe
        self.assertRegex(done.stdout, r"brier +brier: no value +1 +FAIL")
        self.assertRegex(self.succeed("landfall-info", self.path("h.h5")).stdout, r"none +missed_hazard_frac [\d.]+ % +-100 % +FAIL")
        self.assertIn("2 of 3 custom requirements missed", read_bytes(self.path("h.html")).decode())
        self.assertIn("FAIL", self.map_hazards(MISSED, options=("--no-truth",)).stdout)  # nothing to compare with

    def test_bad_requirements(self):
        for change, words in (({"metric": "pass"}, ["/requirements/0/metric", "is not a number"]),
                              ({"metric": "coverage.hole_size_histogram.count"}, ["/requirements/0/metric", "is not a number"]),
                              ({"max": None}, ["/requirements/0/max"])):
            self.refuse(2, "dem-eval", self.chain.dem, "-c", self.config({"requirements": [{**LE90, **change}]}, "e.json"), "--metrics-only", words=words)
        both = [LE90, {**VALID, "name": LE90["name"]}]
        self.refuse(2, "dem-eval", self.chain.dem, "-c", self.config({"requirements": both}, "e.json"), "--metrics-only", words=["/requirements/1/name"])


class Draws(base.DrawsTest):
    def test_each_draw_is_that_of_the_chain(self):
        config = base.draws_config(metrics="full", eval={**EVAL, "requirements": [LE90, VALID]}, vary={"eval.requirements.0.max": {
            "type": "list", "values": 3 * [0.051, 0.053]}})
        rows = self.draws(config)
        passes = [json.loads(json.dumps(self.chain_metrics(config, rows, draw)["own_requirements"]))["vertical LE90"] for draw in range(6)]
        for key in ("value", "limit", "pass"):
            np.testing.assert_array_equal(rows[f"own_requirements.vertical LE90.{key}"], [each[key] for each in passes])
        self.assertEqual(len(set(rows["own_requirements.vertical LE90.pass"])), 2, rows["own_requirements.vertical LE90.value"])
        self.assertFalse(rows["pass"].any())  # valid is missed
        rates = {rate["requirement"]: rate["passed"] for rate in self.verdict()["rates"]}
        self.assertEqual(list(rates), [*base.REQUIREMENTS, "all", "vertical LE90", "valid", "all_and_own"])
        self.assertEqual(rates["vertical LE90"], sum(each["pass"] for each in passes))
        six = np.all([rows[f"requirements.{name}.pass"] == 1 for name in base.REQUIREMENTS], axis=0)
        self.assertEqual((rates["all"], rates["all_and_own"]), (six.sum(), 0))

    def chain_metrics(self, config, rows, draw):
        self.chain_draw(config, draw, {key: rows[key][draw] for key in config["vary"]})
        return json.loads(read_bytes(self.path("m.json")))

    def test_verdict_metrics(self):
        """The counts of `verdict` can be required; a percentile cannot."""
        holes = {"name": "holes", "metric": "coverage.hole_count", "max": 1000000}
        config = base.draws_config(metrics="verdict", eval={**EVAL, "limits": WIDE, "requirements": [holes]})
        self.draws(config, "--require-pass")
        config["eval"]["requirements"].append({**LE90, "name": "le90"})
        self.refuse(2, "monte-carlo", *self.arguments(config, "d.h5"), words=["/requirements/1/metric", 'set /metrics to "full"'])

    def test_hazards_and_parts(self):
        none = {**MISSED, "name": "none", "max": -1}
        config = base.draws_config(metrics="verdict", draws=3, eval={**EVAL, "limits": WIDE}, hazard={**HAZARD, "requirements": [MISSED, none]})
        rows = self.draws(config)
        self.assertFalse(rows["pass"].any())
        self.assertFalse(rows["score.own_requirements.none.pass"].any())
        self.assertTrue(rows["score.own_requirements.missed.pass"].all())
        self.assertEqual(run("monte-carlo", *self.arguments(config, "draws.h5", "-O", "--require-pass", "--table")).returncode, 3)
        whole = read_bytes(self.path("draws.h5"))
        for part in ("0:1", "1:3"):
            self.draws(config, "--draws", part, output=f"{part[0]}.h5")
        self.succeed("monte-carlo", "merge", self.path("0.h5"), self.path("1.h5"), "-o", self.path("draws.h5"), "-O", "--report", self.path("r.html"))
        self.assertEqual(read_bytes(self.path("draws.h5")), whole)
        page = read_bytes(self.path("r.html")).decode()
        self.assertIn("all six and own", page)
        self.assertIn('"name":"none"', page)
        config["eval"]["requirements"] = [{**none, "metric": "coverage.hole_count"}]
        self.refuse(2, "monte-carlo", *self.arguments(config, "d.h5"), words=["/hazard/requirements", '"none"'])

    def test_tampered_verdict(self):
        config = base.draws_config(draws=2, metrics="verdict", eval={**EVAL, "requirements": [{"name": "holes", "metric": "coverage.hole_count", "max": -1}]})
        self.draws(config)
        with h5py.File(self.path("draws.h5"), "r+") as file:
            file["draws/own_requirements.holes.pass"][1] = 2
        self.refuse(1, "landfall-info", "--compare", self.path("draws.h5"), self.path("draws.h5"), words=["own_requirements.holes.pass"])

    def test_figure(self):
        self.draws(base.draws_config(draws=2, metrics="full", eval={**EVAL, "requirements": [LE90, VALID]}))
        done = run_command("plot_draws", self.path("draws.h5"), "-o", self.path("f.png"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(read_bytes(self.path("f.png"))[1:4], b"PNG")


if __name__ == "__main__":
    unittest.main()
