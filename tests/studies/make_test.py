#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makefile.studies study: only new results are built, failures do not affect other cases, and no other files are kept."""
import json
import os
import re
import unittest

import h5py
import numpy as np
from case import LIMITS, RESOLUTIONS, SIGMAS, StudyTest, read, study

GRID = (SIGMAS, RESOLUTIONS, LIMITS)


class Builds(StudyTest):
    def test_grid(self):
        """3 x 2 x 2 cases: each stage runs once, a fourth value adds only new stages, and a second call does nothing."""
        self.write(study(*GRID))
        self.make("study-results", "-j2")
        steps = ("terrain", "scan", "regrid", "eval")
        self.assertEqual([self.runs_of(step) for step in steps], [1, 4, 6, 12])  # the fourth scan is the truth
        self.assertEqual(len(self.rows()), 12)
        self.assertEqual(self.files("shared") + self.files("scratch") + self.files("scan") + self.files("dem"), [])
        first = read(self.out("results.csv"))
        before = os.stat(self.out("results.csv")).st_mtime_ns

        again = self.make("study-results", "-j2")
        self.assertIn("Nothing to be done", again.stdout)
        self.assertEqual(os.stat(self.out("results.csv")).st_mtime_ns, before)

        self.write(study({**SIGMAS, "values": [0.01, 0.02, 0.05, 0.07]}, RESOLUTIONS, LIMITS))
        self.make("study-results", "-j2")
        self.assertEqual([self.runs_of(step, since=before) for step in steps], [0, 1, 2, 4])
        self.assertEqual(len(self.rows()), 16)
        self.write(study(*GRID))
        self.make("study-results")  # the old cases are still there
        self.assertEqual(read(self.out("results.csv")), first)
        self.assertIn("Nothing to be done", self.make("study-results").stdout)

    def test_a_case_equals_the_chain_by_hand(self):
        """The chain by hand uses `sweep.py show`: one traced scan with its errors, all layers, no shared files."""
        path = self.write(study({"key": "scan.noise.dropout_frac", "values": [0, 0.2]}, RESOLUTIONS,
                                repeat={"count": 2, "draws": {"scan.navigation_error.velocity_mps": {"normal": [0.1, 0.1, 0.1]}}},
                                options={"regrid": ["--corrected"]}))
        self.make("study-results", "-j2")
        cases = json.loads(read(self.out("cases.json")))["cases"]
        self.assertEqual(len(cases), 8)
        for number in (0, 5, 7):
            folder = self.by_hand(path, number)
            self.assertEqual(read(self.out(cases[number][-1])), read(os.path.join(folder, "metrics.json")), number)

    def test_files_to_keep_can_be_requested_later(self):
        self.write(study({**SIGMAS, "values": [0.01, 0.02]}))
        self.make("study-results")
        first = read(self.out("results.csv"))
        self.make("study-results", "KEEP=dem")
        self.assertEqual(len(self.files("dem")), 2)
        with h5py.File(self.out("dem", self.files("dem")[0])) as file:
            self.assertIn("count", file)  # all layers
        self.assertEqual(read(self.out("results.csv")), first)
        self.assertIn("Nothing to be done", self.make("study-results", "KEEP=dem").stdout)
        self.make("study-results", "KEEP=dem,eval", "-j2")
        self.assertEqual((len(self.files("eval")), len(self.files("scan"))), (2, 0))
        self.assertIn("Nothing to be done", self.make("study-results", "KEEP=dem,eval").stdout)
        self.assertEqual(read(self.out("results.csv")), first)

    def test_a_failure_does_not_affect_other_cases(self):
        """The DEM of the second case is smaller than the region, so its evaluation fails; the others are made."""
        self.write(study({"key": "regrid.half_width_m", "values": [5, 2, 4]}))
        result = self.make("study-results", "-k", "-j2", code=2)
        self.assertEqual(len(self.files("metrics")), 2)
        self.assertRegex(result.stderr, r"FAILED \(exit 2\): metrics of half width 2 m; the end of \S+\.log:\n +dem-eval: .*region")
        self.assertRegex(result.stdout, r"(?m)^\[\d done, .*\] metrics of half width 5 m \(\d+\.\d s\)$")
        self.assertFalse(os.path.exists(self.out("results.csv")))
        status = self.make("study-status").stdout
        self.assertIn("2 done, 1 failed, 0 left, of 3 cases\n", status)
        self.assertRegex(status, r"(?m)^half width 2 m: exit 2 after .* s: dem-eval: ")
        self.assertIn("2 cases", self.make("study-partial").stdout)
        self.assertEqual([row["case"] for row in self.rows()], ["0", "2"])
        self.assertIn("No such file", self.sweep("collect", self.out(), code=1).stderr)

    def test_a_failure_in_one_recipe(self):
        """If one recipe makes everything that depends on a scan, the results that can be made are made and kept."""
        sigmas = {"key": "scan.noise.range_sigma_m", "linspace": [0.01, 0.17, 17]}
        self.write(study(sigmas, {"key": "regrid.half_width_m", "values": [5, 2]}, set={"scan.laser.scan_time_s": 0.05}))
        self.make("study-results", "-k", "-j2", code=2)
        self.assertEqual(len(self.files("metrics")), 17)
        status = self.make("study-status").stdout
        self.assertIn("17 done, 17 failed, 0 left, of 34 cases", status)
        self.assertRegex(status, r"(?m)^range sigma 0\.01 m, half width 2 m: exit 2 after .* s: dem-eval: ")
        log = next(name for name in self.files("log") if name.startswith("metrics-") and name.endswith(".log"))
        self.assertRegex(read(self.out("log", log)).decode(), r"\n# metrics of range sigma 0\.\d+ m\n")

    def test_cases_of_a_stage_that_failed(self):
        """All cases of a scan fail with it; a case that nothing was tried for is left."""
        self.write(study(SIGMAS, LIMITS))
        self.make("study-plan")
        config = self.out("config", "scan")
        for name in self.files("config", "scan"):
            if b'"range_sigma_m": 0.02' in read(os.path.join(config, name)):
                bad = re.search(rf"stage,dem,([0-9a-f]{{16}}),.*scan \$O/config/scan/{name} ", read(self.out("study.mk")).decode())[1]
        os.makedirs(self.out("log"), exist_ok=True)
        with open(self.out("log", f"dem-{bad}.log"), "w", encoding="utf-8") as file:
            file.write("# scan-sim\nscan-sim: no room\n# exit 1 after 0.10 s\n")
        status = self.make("study-status").stdout
        self.assertIn("0 done, 2 failed, 4 left, of 6 cases\n", status)
        self.assertRegex(status, r"(?m)^range sigma 0\.02 m \(2 cases\): exit 1 after 0\.10 s: scan-sim: no room \(")

    def test_results(self):
        """Also of axes whose names are those of a part of results.h5, or of a word of the tools."""
        self.write(study(SIGMAS, {"name": "kind", "variants": {"a": {"eval.footprint_m": 0.7}, "b": {"eval.footprint_m": 0.5}}},
                         {"key": "scan.scanner.pattern.columns", "values": [19]}, {"name": "study_json", "key": "scan.seed", "values": [1]}))
        self.make("study-results", "-j2")
        rows = self.rows()
        self.assertEqual([(row["case"], row["range_sigma_m"], row["kind"]) for row in rows[:3]],
                         [("0", "0.01", "a"), ("1", "0.01", "b"), ("2", "0.02", "a")])
        metrics = json.loads(read(self.out(json.loads(read(self.out("cases.json")))["cases"][2][-1])))
        self.assertEqual(float(rows[2]["accuracy.relative.z.max_m"]), metrics["accuracy"]["relative"]["z"]["max_m"])
        self.assertEqual(rows[2]["requirements.coverage.pass"], str(int(metrics["requirements"]["coverage"]["pass"])))
        self.assertEqual(rows[2]["pass"], str(int(metrics["pass"])))
        with h5py.File(self.out("results.h5")) as file:
            self.assertEqual(file["_columns"].asstr()[()].tolist(), list(rows[0]))
            self.assertEqual(file["kind"].asstr()[()].tolist(), ["a", "b"] * 3)
            for name, unit in (("range_sigma_m", "m"), ("columns", ""), ("study_json", ""), ("accuracy.relative.z.max_m", "m"), ("coverage.invalid_frac", "1"),
                               ("coverage.largest_hole_bins", "bins"), ("requirements.hole_size.limit", "bins")):
                self.assertEqual(file[name].attrs["units"], unit)
                np.testing.assert_array_equal(file[name][()], [float(row[name]) for row in rows])
            self.assertEqual(file.attrs["complete"], 1)
        first = [read(self.out(name)) for name in ("results.csv", "results.h5")]
        self.sweep("collect", self.out())
        self.assertEqual([read(self.out(name)) for name in ("results.csv", "results.h5")], first)


if __name__ == "__main__":
    unittest.main()
