#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Verdicts need bins: studies, designs and models of a lidar with 1 m of range noise, whose DEM passes nowhere and is not judged where footprints
have fewer than 5 x 5 bins."""
import copy
import json
import math
import os
import re
import subprocess
import unittest

import numpy as np
from case import BASE, BIN, FEW_FIGURES, PYTHON, ROOT, StudyTest, read, study

# pylint: disable=wrong-import-order
from landfall import tools
from landfall.answers import design_problem, model, runs

tools.BIN = BIN
WIDE = {"invalid_frac": 1, "hole_bins": 10000, "distance_bins": 100}
# Bins of 0.1 and 0.2 m: 9 x 9 and 5 x 5 in a footprint of 0.8 m; of 0.25 m 3 x 3, of 0.5 m one.
POSTINGS = {"key": "regrid.resolution_m", "values": [0.1, 0.2, 0.25, 0.5]}
VERDICTS = ["fail", "fail", "not judged", "not judged"]


def noisy(**keys):
    base = copy.deepcopy(BASE)
    base["terrain"] = {"grid": {"half_width_m": 6, "resolution_m": 0.5}}
    base["scan"]["noise"] = {"range_sigma_m": 1}
    base["eval"]["limits"] = WIDE
    return {**study(POSTINGS), "base": {**base, **keys}}


class Studies(StudyTest):
    def test_cases(self):
        self.write({**noisy(draws={"draws": 3, "metrics": "verdict"}), "plot": FEW_FIGURES})
        self.make("study")
        rows = self.rows()
        self.assertEqual([row["pass"] for row in rows], ["0", "0", "", ""])
        self.assertEqual([row["requirements.relative_elevation.pass"] for row in rows], ["0", "0", "", ""])
        self.assertEqual([row["assumptions.footprint_bins"] for row in rows], ["9", "5", "3", "1"])
        self.assertEqual([row["draws.all.passed_frac"] for row in rows], ["0.0", "0.0", "", ""])
        self.assertEqual([row["draws.all.exact_lower_bound"] != "" for row in rows], [True, True, False, False])
        self.assertEqual([row["draws.coverage.passed_frac"] for row in rows], ["1.0"] * 4)
        page = read(self.out("report.html")).decode()
        tree = json.loads(page.split('<script type="application/json" id="report-data">')[1].split("</script>")[0])
        self.assertEqual(next(column for column in tree["columns"] if column["name"] == "verdict")["values"], VERDICTS)
        self.assertEqual(re.findall(r"Assumptions: ([^;]*);", page), ["footprint of 1 to 9 bins on an edge"])
        rates = [line.split(",") for line in read(self.out("figures", "pass_rates.csv")).decode().splitlines()]
        self.assertEqual([float(row[0]) for row in rates[1:] if row[1] == "all"], [0.1, 0.2])  # those that are judged

    def test_only_cases_that_are_not_judged(self):
        tree = noisy()
        tree["axes"] = [{"key": "regrid.resolution_m", "values": [0.5]}]
        self.write(tree)
        self.make("study")
        self.assertEqual([row["pass"] for row in self.rows()], [""])
        self.assertTrue(os.path.exists(self.out("figures", "requirements.png")))


class Models(StudyTest):
    def test_pass_is_not_known(self):
        outputs = ["pass", "requirements.relative_elevation.pass", "accuracy.relative.z.violation_count", "accuracy.absolute.horizontal.within_limit_frac"]
        of = model.model(noisy()["base"], ["regrid.resolution_m"], outputs, self.path("cache"))
        judged, unjudged = of([[0.2], [0.5]])
        self.assertEqual(judged[:2].tolist(), [0, 0])
        self.assertGreater(judged[2], 0)
        self.assertTrue(np.isnan(unjudged[:3]).all())
        self.assertEqual(unjudged[3], 1)

    def test_rows_of_draws(self):
        """As those of the chain: the -1 of draws.h5 is no number."""
        base = noisy()["base"]
        base["regrid"]["resolution_m"] = 0.5
        of = model.model(base, ["scan.noise.range_bias_m"], ["pass", "coverage.invalid_frac"], self.path("cache"))
        found = of([[0.0], [0.1]])
        self.assertTrue(np.isnan(found[:, 0]).all())
        self.assertTrue(np.isfinite(found[:, 1]).all())
        self.assertEqual(of.failures, {})


class Designs(StudyTest):
    def problem(self, resolution_m):
        base = {key: value for key, value in noisy()["base"].items() if key != "draws"}
        base["regrid"]["resolution_m"] = resolution_m
        tree = {"base": base, "variables": {"lines": {"integer": True, "low": 18, "high": 20, "keys": ["scan.scanner.pattern.rows"]}},
                "probability": 0.8, "race": {"p0": 0.9, "p1": 0.6}, "proof_draws": 20, "search": {"candidates": 2, "seed": 3, "start": [{"lines": 20}]}}
        return design_problem.Problem(self.write(tree))

    def test_no_candidate_passes(self):
        for resolution_m, reason in ((0.2, "relative elevation is .* of its limit"),
                                     (0.5, "relative elevation is not judged: the footprint has too few bins")):
            found = design_problem.CandidateCheck(self.problem(resolution_m), runs.Runner(self.path("out")))({"lines": 20})
            self.assertEqual((found["stage"], found["passes"]), ("draw", False))
            self.assertRegex(found["reason"], reason)
            self.assertGreater(found["violation"], 0)
            self.assertFalse(any(math.isnan(margin) for margin in found["margins"].values()))

    def test_the_command_finds_no_lidar(self):
        self.problem(0.5)
        result = subprocess.run([PYTHON, os.path.join(ROOT, "python", "commands", "design.py"), self.path("tiny.json"), "--out", self.path("out"),
                                 "--bin", BIN], capture_output=True, text=True, timeout=600, check=False)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("No candidate passes.", result.stdout)
        self.assertRegex(result.stderr.splitlines()[-1], "^landfall design: .*tiny.json: no candidate passes with a probability of 0.8$")


if __name__ == "__main__":
    unittest.main()
