#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies with a hazard stage: what shares its inputs, what is made again, and its columns in the table, the figures and the report."""
import json
import os
import re
import shutil
import unittest

import h5py
from case import BIN, FEW_FIGURES, LIMITS, SIGMAS, StudyTest, read, study

# pylint: disable=wrong-import-order
from harness.commands import run_command
from landfall.errors import UsageError
from landfall.study import figures, names, reader, results, rules, stages, table, verdicts

HAZARD = {"region_radius_m": 2, "sites": {"divert_radius_m": 2}}
CLEARANCES = {"key": "hazard.limits.roughness_m", "values": [0.2, 0.3]}
FEW_SIGMAS = {**SIGMAS, "values": [0.01, 0.05]}
STEPS = ("terrain", "scan", "regrid", "eval", "hazard")


def hazard_study(*axes, hazard=None, **keys):
    tree = study(*axes, **keys)
    tree["base"]["hazard"] = HAZARD if hazard is None else hazard
    return tree


class Plans(StudyTest):
    KINDS = (*StudyTest.KINDS, "hazard")

    def test_cases_share_all_but_the_hazard_map(self):
        self.assertEqual(self.counts(hazard_study(CLEARANCES)), [1, 0, 1, 1, 1, 2])
        self.assertEqual(self.counts(hazard_study(SIGMAS, LIMITS, CLEARANCES)), [1, 1, 3, 3, 6, 6])
        self.assertEqual(self.counts(hazard_study()), [1, 0, 1, 1, 1, 1])
        self.assertEqual(self.counts(study(SIGMAS)), [1, 1, 3, 3, 3, 0])

    def test_each_stage_names_its_cases(self):
        graph = self.graph(hazard_study(SIGMAS, CLEARANCES))
        cases = stages.cases_of(graph)
        self.assertEqual([cases[identity] for identity in graph.terrain], [[0, 1, 2, 3, 4, 5]])
        self.assertEqual([cases[identity] for identity in graph.eval], [[0, 1], [2, 3], [4, 5]])
        self.assertEqual([cases[identity] for identity in graph.hazard], [[number] for number in range(6)])

    def test_keys_need_the_stage(self):
        for tree, where in ((study(CLEARANCES), "axis roughness_m"), (study(set={"hazard.limits.slope_deg": 5}), "/set/hazard.limits.slope_deg"),
                            (study(repeat={"count": 2, "draws": {"hazard.limits.slope_deg": {"uniform": [5, 10]}}}), "axis repeat"),
                            (study({"name": "a", "variants": {"x": {"scan.seed": 1}, "y": {"hazard": {}}}}), "axis a")):
            with self.assertRaisesRegex(UsageError, rf"{where}: hazard\S*: this study has no stage hazard; add it to \"base\""):
                reader.read_study(self.write(tree))

    def test_presets_and_files(self):
        self.write({"limits": {"slope_deg": 7}}, "mine")
        for base, expected in (("preset:jpl-2015", 0.353), ("mine.json", None)):
            read_study = reader.read_study(self.write(hazard_study(hazard=base)))
            self.assertEqual(read_study.base["hazard"]["limits"].get("roughness_m"), expected)
            self.assertIn(base.removeprefix("preset:")[:4], read_study.files[-1])

    def test_the_tool_checks_the_values(self):
        path = self.write(hazard_study({"key": "hazard.limits.slope_deg", "values": [10, -1]}))
        message = self.sweep("plan", path, "--out", self.out(), "--bin", BIN, code=2).stderr
        self.assertRegex(message, r"slope_deg = -1: hazard-map: .*limits/slope_deg")

    def test_a_study_without_the_stage_has_nothing_of_it(self):
        self.plan(study(SIGMAS))
        self.assertEqual(set(self.files()) & {"hazard", "score", "sites"}, set())
        self.assertEqual(read(self.out("tools.txt")).count(b"\n"), 4)
        self.assertNotIn(b"hazard", read(self.out("study.mk")))
        self.assertEqual({len(row) for row in json.loads(read(self.out("cases.json")))["cases"]}, {2})

    def test_a_dem_is_order_only_for_those_who_read_it(self):
        """The inputs of the DEM are normal prerequisites instead."""
        self.plan(hazard_study(SIGMAS))
        text = read(self.out("study.mk")).decode()
        for target in ("metrics", "score"):
            found = re.findall(rf"(?m)^\$O/{target}/\S+.*?: (.*) \| (.*)$", text)
            self.assertEqual(len(found), 3)
            for inputs, last in found:
                self.assertRegex(last, r"^\$O/shared/[0-9a-f]{16}\.dem\.h5$")
                self.assertEqual(re.findall(r"\$O/(config/\w+|\w+)/", inputs)[:3], ["config/scan", "terrain", "config/regrid"])
        self.assertEqual(text.count("$(call stage,score,"), 3)


class Results(StudyTest):
    def test_a_case_equals_the_chain_by_hand(self):
        path = self.write(hazard_study(SIGMAS, CLEARANCES))
        self.make("study-results", "-j2")
        self.assertEqual([self.runs_of(step) for step in STEPS], [1, 4, 3, 3, 6])
        self.assertEqual(self.files("shared") + self.files("scratch") + self.files("hazard"), [])
        cases = json.loads(read(self.out("cases.json")))["cases"]
        for number in (0, 3):
            folder = self.by_hand(path, number)
            metrics, score = cases[number][-2:]
            for stored, made in ((metrics, "metrics"), (score, "score"), ("sites/" + os.path.basename(score), "sites")):
                self.assertEqual(read(self.out(stored)), read(os.path.join(folder, made + ".json")), (number, made))
        self.check_row(self.rows()[3], cases[3][-1])

    def check_row(self, row, score_name):
        score = json.loads(read(self.out(score_name)))
        site = json.loads(read(self.out("sites", os.path.basename(score_name))))["sites"][0]
        counts = score["counts"]
        hazards = counts["safe_hazard"] + counts["hazard_hazard"]
        self.assertGreater(hazards, 0)
        self.assertEqual(int(row["score.counts.safe_safe"]), counts["safe_safe"])
        self.assertEqual(float(row["score.missed_hazard_frac"]), counts["safe_hazard"] / hazards)
        self.assertEqual(float(row["score.true_hazard_frac"]), hazards / (sum(counts.values()) - counts["unknown"]))
        self.assertEqual(float(row["score.unknown_frac"]), counts["unknown"] / sum(counts.values()))
        limits = score["roc"]["roughness_limit_m"]
        for margin in results.MARGINS:
            at = min(range(len(limits)), key=lambda i: abs(limits[i] - 0.3 * (1 - margin / 100)))  # pylint: disable=cell-var-from-loop
            self.assertAlmostEqual(limits[at], 0.3 * (1 - margin / 100), 9)
            for key in ("missed_hazard_frac", "false_alarm_frac"):
                self.assertEqual(float(row[f"score.margin_{margin}_percent.{key}"]), score["roc"][key][at])
        for key in ("x_m", "z_m", "cost", "p_touchdown", "slope_deg", "roughness_m"):
            self.assertEqual(float(row["site." + key]), site[key])
        self.assertEqual(row["site.true_safe"], str(int(site["true_safe"])))
        self.assertNotIn("site.rank", row)
        with h5py.File(self.out("results.h5")) as file:
            for name, unit in (("score.missed_hazard_frac", "1"), ("score.filled_truth_bins", "bins"), ("site.slope_deg", "deg"),
                               ("site.roughness_m", "m"), ("site.p_touchdown", "1")):
                self.assertEqual(file[name].attrs["units"], unit)

    def test_a_case_without_a_safe_place(self):
        """Its columns of the best site are empty."""
        self.write(hazard_study({"key": "hazard.limits.slope_deg", "values": [10, 0.001]}, set={"scan.noise.range_sigma_m": 0.01}))
        self.make("study-results")
        first, second = self.rows()
        self.assertGreater(float(first["site.p_touchdown"]), 0)
        self.assertEqual({second[name] for name in second if name.startswith("site.")}, {""})
        self.assertEqual(second["score.judged_hazard_frac"], "1.0")

    def test_a_case_with_nothing_to_judge_is_a_row(self):
        """The worst lidar of a study leaves no place that can be judged: its metrics are in the table, its score is empty, and make continues."""
        tree = hazard_study({"key": "scan.noise.dropout_frac", "values": [0, 0.99]}, set={"hazard.hole_fill_bins": 0, "hazard.region_radius_m": 1}, plot=FEW_FIGURES)
        self.write(tree)
        self.make("study", "KEEP=hazard")
        first, second = self.rows()
        self.assertEqual((first["score.remark"], second["score.remark"]), ("", "nothing to judge"))
        self.assertGreater(float(second["coverage.invalid_frac"]), 0.5)
        self.assertEqual({second[name] for name in second if name.startswith("site.")}, {""})
        for name in ("missed_hazard_frac", "false_alarm_frac", "judged_hazard_frac", "margin_10_percent.missed_hazard_frac"):
            self.assertEqual(second["score." + name], "", name)
        self.assertEqual(second["score.unknown_frac"], "1.0")
        self.assertEqual(second["score.counts.unknown"], str(sum(int(first[name]) for name in first if name.startswith("score.counts."))))
        self.assertNotEqual(first["score.judged_hazard_frac"], "")
        with h5py.File(self.out("results.h5")) as file:
            self.assertEqual(list(file["score.remark"].asstr()), ["", "nothing to judge"])
        self.assertIn("\n2 done, 0 failed, 0 left, of 2 cases\n", self.make("study-status").stdout)
        self.assertIn("nothing to judge", read(self.out("report.html")).decode())

    def test_a_region_off_the_map_still_ends_the_study(self):
        self.write(hazard_study(set={"hazard.region": {"shape": "polygon", "vertices": [[90, 0], [99, 0], [90, 9]]}}))
        result = self.make("study-results", code=2)
        self.assertRegex(result.stderr, r"hazard-map: .*nothing to judge: no bin of the map lies in the polygon")

    def test_many_scans_and_kept_files_give_the_same_results(self):
        many = {"key": "scan.noise.range_sigma_m", "linspace": [0.01, 0.17, rules.MAX_SHARED + 1]}
        self.write(hazard_study(many, CLEARANCES))
        progress = self.make("study-results", "-j2").stdout
        self.assertIn(f"[{2 + 3 * (rules.MAX_SHARED + 1)} done, 0 failed, 0 left]", progress)
        self.assertEqual([self.runs_of(step) for step in STEPS], [1, 18, 17, 17, 34])
        self.write(hazard_study({**many, "linspace": [0.01, 0.02, 2]}, CLEARANCES), "few")
        self.make("study-results", "-j2", "KEEP=all", study_name="few")
        self.assertEqual([len(self.files(kind, study_name="few")) for kind in ("scan", "dem", "eval", "hazard", "score", "sites", "metrics", "shared")],
                         [2, 2, 2, 4, 4, 4, 2, 0])
        self.assertEqual(read(self.out("results.csv")).splitlines()[:5], read(self.out("results.csv", study_name="few")).splitlines())
        for layers, numbers in (("hazard", "score"), ("eval", "metrics")):
            for name in self.files(layers, study_name="few"):
                with h5py.File(self.out(layers, name, study_name="few")) as file:
                    self.assertEqual(json.loads(file[numbers + "_json"].asstr()[()]),
                                     json.loads(read(self.out(numbers, name[:-3] + ".json", study_name="few"))))


class MadeStudy(StudyTest):
    """The table, figures and report of one study that make has run, with requirements of the user's own, on a DEM and on its hazards."""

    LE90 = {"name": "le90", "metric": "statistics.z.le90_m", "max": 0.03}
    SAFE = {"name": "safe", "metric": "counts.safe_safe", "min": 1e6}
    METRICS = ["score.missed_hazard_frac", "site.p_touchdown"]

    @classmethod
    def setUpClass(cls):
        tree = hazard_study(FEW_SIGMAS, CLEARANCES, hazard={**HAZARD, "requirements": [cls.SAFE]}, plot={"metrics": cls.METRICS})
        tree["base"]["eval"]["requirements"] = [cls.LE90]
        cls.shared = cls.made(tree, "study", "-j2")

    def setUp(self):
        self.folder = self.shared.folder

    def test_own_requirements(self):
        rows = self.rows()
        for row in rows:
            self.assertEqual(row["own_requirements.le90.value"], row["statistics.z.le90_m"])
            self.assertEqual(int(row["own_requirements.le90.pass"]), float(row["statistics.z.le90_m"]) <= 0.03)
            self.assertEqual((row["score.own_requirements.safe.pass"], row["pass"]), ("0", "0"))
        self.assertEqual({row["own_requirements.le90.pass"] for row in rows}, {"0", "1"})
        with h5py.File(self.out("results.h5")) as file:
            self.assertEqual(file["own_requirements.le90.limit"].attrs["units"], "m")
            found = table.Results(file)
        self.assertEqual(found.requirements()[6:], ["le90", "safe"])
        self.assertEqual((found.limit("statistics.z.le90_m"), found.bound("statistics.z.le90_m")), (0.03, "at most"))
        self.assertEqual((found.limit("score.counts.safe_safe"), found.bound("score.counts.safe_safe")), (1e6, "at least"))
        point = found.points[0]
        self.assertAlmostEqual(found.share_of_limit(point, "le90", 0.5), float(rows[0]["statistics.z.le90_m"]) / 0.03, places=12)
        self.assertAlmostEqual(found.share_of_limit(point, "safe", 0.5), 1e6 / int(rows[0]["score.counts.safe_safe"]), places=9)
        rates = read(self.out("figures", "pass_rates.csv")).decode()
        self.assertRegex(rates, r"0\.01,0\.2,le90,1,1,")
        self.assertRegex(rates, r"0\.01,0\.2,safe,0,1,")
        page = read(self.out("report.html")).decode()
        self.assertIn('"requirements":["coverage"', page.replace(" ", ""))
        self.assertRegex(page, r"relative elevation, safe|\"safe\"")

    def test_figures_and_report(self):
        self.assertLessEqual({f"{metric}.png" for metric in self.METRICS} | {"overview.png"}, set(self.files("figures")))
        page = read(self.out("report.html")).decode()
        tree = json.loads(re.search(r'id="report-data">(.*?)</script>', page, re.S)[1])
        columns = {column["name"]: column for column in tree["columns"]}
        self.assertTrue(all(columns[metric]["first"] for metric in self.METRICS))
        self.assertEqual(columns["score.missed_hazard_frac"]["label"], "missed hazards, share of the true hazards")
        self.assertEqual(columns["score.missed_hazard_frac"]["values"],
                         [float(f"{float(row['score.missed_hazard_frac']):.7g}") for row in self.rows()])
        self.assertEqual(tree["configs"]["hazard"]["base"], {**HAZARD, "requirements": [self.SAFE], "limits": {"roughness_m": 0.2}})
        kinds = [tree["runs"][run][0] for run in tree["caseRuns"][0]]
        self.assertEqual(kinds, ["terrain", "truth", "scan", "regrid", "eval", "hazard"])
        self.assertIn("<td>hazard-map</td>", page)

    def test_the_default_metrics_have_the_score(self):
        shutil.copy(self.out("results.h5"), self.path("default.h5"))
        with h5py.File(self.path("default.h5"), "r+") as file:
            file["_study_json"][()] = json.dumps({**json.loads(file["_study_json"].asstr()[()]), "plot": {}})
        self.assertEqual(run_command("plot_study", self.path("default.h5"), "-o", self.path("f"), "--dpi", 50).returncode, 0)
        self.assertLessEqual({"score.missed_hazard_frac.png", "score.false_alarm_frac.png", "hazards.png"}, set(os.listdir(self.path("f"))))
        with h5py.File(self.out("results.h5")) as file:
            read_results = table.Results(file)
        figure = verdicts.hazards_figure(read_results, 0.5)
        self.addCleanup(figures.plt.close, figure)
        shown = {text.get_text() for text in figure.axes[0].texts}
        for row in self.rows():
            for name in ("score.missed_hazard_frac", "score.false_alarm_frac", "site.p_touchdown"):
                self.assertIn(f"{names.number(100 * float(row[name]))} %", shown)
        # The bar of the largest value has the width of its cell.
        self.assertAlmostEqual(max(patch.get_width() for patch in figure.axes[0].patches), 0.96, 12)


class Repeats(StudyTest):
    """The stages that are made again."""

    @classmethod
    def setUpClass(cls):
        cls.shared = cls.made(hazard_study(CLEARANCES), "study-results")

    def test_another_limit_runs_only_hazard_map(self):
        self.write(hazard_study(FEW_SIGMAS, CLEARANCES))
        self.make("study-results", "-j2", "KEEP=dem")
        first, rows = read(self.out("results.csv")), self.rows()
        self.write(hazard_study(FEW_SIGMAS, {**CLEARANCES, "values": [0.2, 0.3, 0.4]}))
        self.assertEqual(self.stages_of(self.make("study-results", "-j2", "KEEP=dem")), ["score"] * 2)
        self.assertEqual([row["score.counts.safe_safe"] for row in self.rows() if row["roughness_m"] != "0.4"],
                         [row["score.counts.safe_safe"] for row in rows])
        self.write(hazard_study(FEW_SIGMAS, CLEARANCES))
        self.assertEqual(self.stages_of(self.make("study-results", "KEEP=dem")), [])
        self.assertEqual(read(self.out("results.csv")), first)

    def test_another_configuration_without_kept_dems(self):
        """The DEM is made for it again, and nothing else that reads the DEM."""
        self.copy(self.shared)
        self.write(hazard_study(CLEARANCES, hazard={**HAZARD, "touchdown_sigma_m": 0.5}))
        self.assertEqual(self.stages_of(self.make("study-results", "-j2")), ["dem", "score", "score"])
        self.assertEqual(self.files("shared"), [])
        self.assertIn("Nothing to be done", self.make("study-results").stdout)

    def test_files_that_are_lost(self):
        self.copy(self.shared)
        whole = {f"{folder}/{name}": read(self.out(folder, name)) for folder in ("score", "sites") for name in self.files(folder)}
        for name in (min(whole), max(whole)):
            with self.subTest(name=name):
                os.remove(self.out(name))
                self.assertIn("1 done, 0 failed, 1 left, of 2 cases", self.make("study-status").stdout)
                self.assertEqual(len(self.partial_rows()), 1)
                self.assertEqual(self.stages_of(self.make("study-results")), ["dem", "score"])
                self.assertEqual({name: read(self.out(name)) for name in whole}, whole)
        self.assertIn("Nothing to be done", self.make("study-results").stdout)

    def partial_rows(self):
        """The table of the finished cases; the whole one is made again by the next make."""
        self.sweep("collect", "--partial", self.out())
        rows = self.rows()
        os.remove(self.out("results.csv"))
        return rows

    def test_prune_keeps_what_the_plan_names(self):
        self.copy(self.shared)
        results_before = read(self.out("results.csv"))
        self.write(hazard_study({**CLEARANCES, "values": [0.2]}))
        self.make("study-results")
        self.assertRegex(self.sweep("prune", self.out()).stdout, r"\A[1-9]\d* files removed, ")
        self.assertEqual([len(self.files(*folder)) for folder in (["score"], ["sites"], ["metrics"], ["config", "hazard"])], [1, 1, 1, 1])
        self.assertIn("Nothing to be done", self.make("study-results").stdout)
        self.write(hazard_study(CLEARANCES))
        self.make("study-results")
        self.assertEqual(read(self.out("results.csv")), results_before)

    def test_a_failure(self):
        """Legs shorter than two bins are refused when hazard-map sees the DEM; metrics are still made."""
        self.write(hazard_study({"key": "hazard.lander.leg_radius_m", "values": [0.85, 0.15]}, plot=FEW_FIGURES))
        result = self.make("study-results", "-k", code=2)
        self.assertRegex(result.stderr, r"FAILED \(exit 2\): score of leg radius 0\.15 m; the end of \S+\.log:\n +hazard-map: .*leg_radius_m")
        self.assertEqual(len(self.files("metrics")), 1)
        status = self.make("study-status").stdout
        self.assertIn("1 done, 1 failed, 0 left, of 2 cases\n", status)
        self.assertRegex(status, r"(?m)^leg radius 0\.15 m: exit 2 after .* s: hazard-map: ")
        self.make("study-partial")
        self.assertRegex(read(self.out("report.html")).decode(), r"log/score-[0-9a-f]{16}\.log")


if __name__ == "__main__":
    unittest.main()
