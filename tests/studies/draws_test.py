#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies with runs of monte-carlo: what they share, their configurations, what is made again, their columns and figures."""
import json
import os
import re
import subprocess
import unittest

import h5py
import numpy as np
from case import BASE, BIN, FEW_FIGURES, LIMITS, RESOLUTIONS, ROOT, SIGMAS, StudyTest, read, study

# pylint: disable=wrong-import-order
from landfall.errors import UsageError
from landfall.study import figures, model, reader, results, rules, stages, table, verdicts

VELOCITY = "scan.navigation_error.velocity_mps.0"
DRAWS = {"draws": 4, "metrics": "verdict", "vary": {VELOCITY: {"type": "normal", "sigma": 0.5}}}
SPREADS = {"name": "sigma_mps", "key": f"draws.vary.{VELOCITY}.sigma", "values": [0.1, 2]}
REPEAT = {"count": 2, "draws": {"scan.navigation_error.velocity_mps": {"normal": [0.1, 0.1, 0.1]}}}
STEPS = ("terrain", "scan", "regrid", "eval", "draws")
HAZARD = {"region_radius_m": 2, "sites": {"divert_radius_m": 2}}


def draws_study(*axes, draws=None, **keys):
    tree = study(*axes, **keys)
    tree["base"]["draws"] = DRAWS if draws is None else draws
    return tree


class Plans(StudyTest):
    KINDS = (*StudyTest.KINDS, "draws")

    def configs(self, tree):
        graph = self.graph(tree)
        return [json.loads(graph.configs["draws", stage.config_id]) for stage in graph.draws.values()]

    def test_draws_need_their_own_truth(self):
        self.assertEqual(self.counts(draws_study()), [1, 1, 1, 1, 1, 1])
        self.assertEqual(self.counts(study()), [1, 0, 1, 1, 1, 0])

    def test_keys_that_vary_draws(self):
        """Their own keys, and errors, bins and limits of the case; not what only hazard-map reads."""
        self.assertEqual(self.counts(draws_study(SPREADS)), [1, 1, 1, 1, 1, 2])
        self.assertEqual(self.counts(draws_study(SIGMAS)), [1, 1, 3, 3, 3, 3])
        self.assertEqual(self.counts(draws_study(RESOLUTIONS, LIMITS)), [1, 1, 1, 2, 4, 4])
        self.assertEqual(self.counts(draws_study({"key": "scan.trajectory.position_m.2", "values": [50, 60]})), [1, 2, 2, 2, 2, 2])
        tree = draws_study({"key": "hazard.limits.roughness_m", "values": [0.2, 0.3]})
        tree["base"]["hazard"] = HAZARD
        self.assertEqual(self.counts(tree), [1, 1, 1, 1, 1, 1])

    def test_repeats_share_draws(self):
        """Their seeds would draw the same numbers again."""
        tree = draws_study(SIGMAS, repeat=REPEAT)
        self.assertEqual(self.counts(tree), [1, 1, 6, 6, 6, 3])
        self.assertEqual([config["scan"] for config in self.configs(tree)], [{"noise": {"range_sigma_m": sigma}} for sigma in SIGMAS["values"]])
        graph = self.graph(tree)
        cases = stages.cases_of(graph)
        self.assertEqual([cases[identity] for identity in graph.draws], [[0, 1], [2, 3], [4, 5]])
        self.assertEqual(cases[next(iter(graph.truth))], [0, 1, 2, 3, 4, 5])

    def test_the_configuration(self):
        """Errors of the scan without what moves its beams; regrid and eval of the case."""
        scan = {**BASE["scan"], "seed": 7, "noise": {"dropout_frac": 0.1},
                "pointing_error": {"misalignment_rpy_rad": [0, 0, 1e-4], "time_stamp_bias_s": 1e-5}}
        tree = draws_study(SPREADS, {**RESOLUTIONS, "values": [0.2]})
        tree["base"]["scan"] = scan
        [first, second] = self.configs(tree)
        self.assertEqual(first["scan"], {"seed": 7, "noise": {"dropout_frac": 0.1}, "pointing_error": {"time_stamp_bias_s": 1e-5}})
        self.assertEqual((first["regrid"], first["eval"]), ({**BASE["regrid"], "resolution_m": 0.2}, BASE["eval"]))
        self.assertEqual({key: first[key] for key in ("draws", "metrics")}, {"draws": 4, "metrics": "verdict"})
        self.assertEqual([config["vary"][VELOCITY] for config in (first, second)], [{"type": "normal", "sigma": sigma} for sigma in (0.1, 2)])

    def test_keys_with_dots(self):
        for key, path in ((f"draws.vary.{VELOCITY}.sigma", ["vary", VELOCITY, "sigma"]), (f"draws.vary.{VELOCITY}", ["vary", VELOCITY]),
                          ("draws.vary", ["vary"]), ("draws.draws", ["draws"]), ("draws.hazard.limits.slope_deg", ["hazard", "limits", "slope_deg"]),
                          ("draws.vary.scan.seed.values", ["vary", "scan.seed", "values"]), ("scan.noise.range_sigma_m", ["noise", "range_sigma_m"])):
            self.assertEqual(model.path_of(key), path)
        uniform = {"type": "uniform", "low": -1, "high": 1}
        tree = draws_study({"name": "kind", "variants": {"normal": {f"draws.vary.{VELOCITY}.mean": 0.1}, "uniform": {f"draws.vary.{VELOCITY}": uniform}}})
        self.assertEqual([config["vary"][VELOCITY] for config in self.configs(tree)], [{**DRAWS["vary"][VELOCITY], "mean": 0.1}, uniform])

    def test_keys_of_the_case_are_refused(self):
        for stage in ("scan", "regrid", "eval"):
            for tree in (draws_study(draws={**DRAWS, stage: {}}), draws_study(set={f"draws.{stage}.seed": 1})):
                with self.assertRaisesRegex(UsageError, rf"tiny\.json: draws\.{stage}: draws have the {stage} of their case; set {stage} itself"):
                    self.graph(tree)

    def test_keys_need_the_stage(self):
        with self.assertRaisesRegex(UsageError, r"axis sigma_mps: draws\S*: this study has no stage draws; add it to \"base\""):
            reader.read_study(self.write(study(SPREADS)))

    def test_the_tool_checks_the_values(self):
        for axis, message in (({**SPREADS, "values": [0.1, -1]}, r"sigma_mps = -1: monte-carlo: .*velocity_mps"),
                              ({"key": "draws.draws", "values": [0]}, r"the first case: monte-carlo: .*draws")):
            path = self.write(draws_study(axis))
            self.assertRegex(self.sweep("plan", path, "--out", self.out(), "--bin", BIN, code=2).stderr, message)

    def test_a_study_without_the_stage_has_nothing_of_it(self):
        self.plan(study(SIGMAS))
        self.assertEqual(set(self.files()) & {"draws", "verdict"}, set())
        self.assertNotIn(b"monte-carlo", read(self.out("tools.txt")))
        self.assertNotIn(b"draws", read(self.out("study.mk")))

    def test_the_rules(self):
        """The truth is order-only: what changes it changes the run's other inputs too."""
        self.plan(draws_study(SPREADS), "--keep", "draws")
        rule = r"(?m)^\$O/verdict/(\S+)\.json \$O/draws/\1\.h5 &: (.*) \| \$O/truth/[0-9a-f]{16}\.h5$"
        found = re.findall(rule, read(self.out("study.mk")).decode())
        self.assertEqual(len(found), 2)
        for _, inputs in found:
            self.assertRegex(inputs, r"^\$O/config/draws/[0-9a-f]{16}\.json \$O/terrain/[0-9a-f]{16}\.h5 \$O/tools\.txt$")
        self.assertEqual(len({case[-1] for case in json.loads(read(self.out("cases.json")))["cases"]}), 2)


class Numbers(unittest.TestCase):
    RATE = {"passed": 3, "draws": 4, "wilson_low": 0.3, "wilson_high": 0.95, "exact_lower_bound": 0.25}

    def verdict(self, **keys):
        return {"format": "landfall.draws_verdict", "confidence": 0.95, "rates": [{"requirement": "all", **self.RATE}], **keys}

    def test_columns(self):
        self.assertEqual(results.draws_numbers(self.verdict()),
                         {**{f"draws.all.{key}": value for key, value in self.RATE.items()}, "draws.all.passed_frac": 0.75})

    def test_hazards(self):
        found = results.draws_numbers(self.verdict(hazard={"draws_with_site": 4, "missed_hazard_frac_mean": None, "chosen_place_safe":
                                                              {"requirement": "chosen_place_safe", **self.RATE}}))
        self.assertEqual(found["draws.hazard.chosen_place_safe.wilson_high"], 0.95)
        self.assertEqual((found["draws.hazard.draws_with_site"], found["draws.hazard.missed_hazard_frac_mean"]), (4, None))

    def test_a_sequential_test_leaves_no_interval(self):
        for sprt, accepted in (("accepted", 1), ("rejected", 0), ("running", None)):
            self.assertEqual(results.draws_numbers(self.verdict(sprt=sprt, note="")),
                             {"draws.all.passed": 3, "draws.all.draws": 4, "draws.all.passed_frac": 0.75, "draws.accepted": accepted})


class Results(StudyTest):
    def test_a_case_equals_monte_carlo_by_hand(self):
        hazard = {**DRAWS, "hazard": HAZARD}
        path = self.write(draws_study(SIGMAS, SPREADS, draws=hazard))
        self.make("study-results", "-j2")
        self.assertEqual([self.runs_of(step) for step in STEPS], [1, 4, 3, 3, 6])
        self.assertEqual(self.files("shared") + self.files("scratch") + self.files("draws"), [])
        cases = json.loads(read(self.out("cases.json")))["cases"]
        for number in (0, 5):
            folder = self.by_hand(path, number)
            self.assertEqual(read(self.out(cases[number][-1])), read(os.path.join(folder, "verdict.json")))
            self.assertEqual(read(self.out(cases[number][-2])), read(os.path.join(folder, "metrics.json")))
        self.check_chain(folder)
        self.check_row(self.rows()[5], json.loads(read(self.out(cases[5][-1]))))

    def check_chain(self, folder):
        """A draw of the run by hand equals the chain with the case's own errors and the values of the draw."""
        with h5py.File(os.path.join(folder, "draws.h5")) as file:
            rows = {name: column[()] for name, column in file["draws"].items()}
        commands = ["scan-sim -c scan.json --ranges-from truth.h5 --terrain terrain.h5 -o drawn.h5 "
                    f"--set draw={rows['draw'][2]} --set navigation_error.velocity_mps='[{float(rows[VELOCITY][2])!r},0,0]'",
                    "regrid drawn.h5 -c regrid.json --terrain terrain.h5 -o drawn-dem.h5",
                    "dem-eval drawn-dem.h5 -c eval.json --metrics-only --metrics drawn.json"]
        subprocess.run(["bash", "-ec", "\n".join(commands)], cwd=folder, check=True, env={**os.environ, "PATH": BIN + ":" + os.environ["PATH"]})
        metrics = json.loads(read(os.path.join(folder, "drawn.json")))
        self.assertEqual(rows["coverage.invalid_count"][2], metrics["coverage"]["invalid_count"])
        self.assertEqual(rows["requirements.relative_elevation.value"][2], metrics["requirements"]["relative_elevation"]["value"])
        self.assertEqual(rows["pass"][2], metrics["pass"])

    def check_row(self, row, verdict):
        for rate in verdict["rates"]:
            for key in ("passed", "draws", "wilson_low", "wilson_high", "exact_lower_bound"):
                self.assertEqual(float(row[f"draws.{rate['requirement']}.{key}"]), rate[key])
            self.assertEqual(float(row[f"draws.{rate['requirement']}.passed_frac"]), rate["passed"] / rate["draws"])
        self.assertEqual({float(row[f"draws.{rate['requirement']}.draws"]) for rate in verdict["rates"]}, {4})
        self.assertEqual(int(row["draws.hazard.draws_with_site"]), verdict["hazard"]["draws_with_site"])
        self.assertEqual(int(row["draws.hazard.chosen_place_safe.passed"]), verdict["hazard"]["chosen_place_safe"]["passed"])
        with h5py.File(self.out("results.h5")) as file:
            self.assertEqual(file["draws.coverage.passed"].attrs["units"], "1")

    def test_kept_draws_and_grouped_scans_give_the_same_verdicts(self):
        self.write(draws_study(SPREADS))
        self.make("study-results", "KEEP=draws")
        self.assertEqual([os.path.splitext(name)[0] for name in self.files("draws")], [os.path.splitext(name)[0] for name in self.files("verdict")])
        for name in self.files("draws"):
            with h5py.File(self.out("draws", name)) as file:
                self.assertIn("p_invalid", file)
                self.assertEqual(json.loads(file["verdict_json"].asstr()[()]), json.loads(read(self.out("verdict", name[:-3] + ".json"))))
        many = {"key": "scan.noise.range_sigma_m", "linspace": [0.01, 0.17, rules.MAX_SHARED + 1]}
        self.write(draws_study(many, {**LIMITS, "values": [0.04, 0.05]}, SPREADS, draws={**DRAWS, "draws": 1}), "many")
        self.plan(json.loads(read(self.path("many.json"))), name="many")
        text = read(self.out("study.mk", study_name="many")).decode()
        self.assertEqual([text.count(f"call stage,{kind},") for kind in ("metrics", "verdict")], [17, 68])

    def test_a_failure(self):
        """Beams that the seed moves cannot be redrawn; metrics are still made."""
        self.write(draws_study({"key": "scan.pointing_error.jitter_sigma_rad", "values": [0, 1e-4]}, plot=FEW_FIGURES))
        result = self.make("study-results", "-k", code=2)
        self.assertRegex(result.stderr, r"FAILED \(exit \d\): verdict of jitter sigma \S+ rad; the end of \S+\.log:\n +monte-carlo: ")
        self.assertEqual((len(self.files("metrics")), len(self.files("verdict"))), (2, 1))
        self.assertRegex(self.make("study-status").stdout, r"(?m)^1 done, 1 failed, 0 left, of 2 cases\n.*: monte-carlo: ")
        self.make("study-partial")
        self.assertRegex(read(self.out("report.html")).decode(), r"log/verdict-[0-9a-f]{16}\.log")


class Repeats(StudyTest):
    """The stages that are made again of a study that make has run."""

    @classmethod
    def setUpClass(cls):
        cls.shared = cls.made(draws_study(SPREADS), "study-results", "-j2")

    def test_another_value_runs_only_its_draws(self):
        self.copy(self.shared)
        self.assertEqual(self.stages_of(self.shared.output), ["metrics", "terrain", "truth", "verdict", "verdict"])
        first = read(self.out("results.csv"))
        self.write(draws_study({**SPREADS, "values": [0.1, 1, 2]}))
        self.assertEqual(self.stages_of(self.make("study-results")), ["verdict"])
        self.write(draws_study(SPREADS))
        self.assertEqual(self.stages_of(self.make("study-results")), [])
        self.assertEqual(read(self.out("results.csv")), first)
        self.assertRegex(self.sweep("prune", self.out()).stdout, r"\A[1-9]\d* files removed, ")
        self.assertEqual(len(self.files("verdict")), 2)
        self.assertIn("Nothing to be done", self.make("study-results").stdout)

    def test_files_that_are_lost(self):
        self.copy(self.shared)
        whole = {name: read(self.out("verdict", name)) for name in self.files("verdict")}
        os.remove(self.out("verdict", min(whole)))
        self.assertIn("1 done, 0 failed, 1 left, of 2 cases", self.make("study-status").stdout)
        self.assertEqual(self.stages_of(self.make("study-results")), ["verdict"])
        self.assertEqual({name: read(self.out("verdict", name)) for name in whole}, whole)

    def test_killed_draws_resume(self):
        """study-chain gives the draws that nobody keeps a name that is the same the next time, and removes them."""
        self.copy(self.shared)
        line = next(line for line in read(self.out("study.mk")).decode().splitlines() if "call stage,verdict," in line)
        config, truth, terrain, verdict = (self.out(word[3:]) for word in line.split(") draws ")[1].split()[:4])
        scratch, expected = self.path("scratch"), json.loads(read(verdict))
        os.mkdir(scratch)
        self.assertEqual(expected["rates"][0]["passed"], 4)
        # The state of a killed run is a part; one whose draws say something else shows that it was used.
        state = os.path.join(scratch, ".one-draws.h5.state")
        subprocess.run([os.path.join(BIN, "monte-carlo"), truth, "-c", config, "--terrain", terrain, "-o", self.path("part.h5"),
                        "--set", "layers=false", "--draws", "0:2"], check=True, capture_output=True)
        with h5py.File(self.path("part.h5"), "r+") as file:
            for column in ("requirements.coverage.pass", "pass"):
                file["draws/" + column][:] = 0
        os.rename(self.path("part.h5"), state)
        chain = [os.path.join(ROOT, "studies", "runners", "study-chain"), BIN, "1", scratch, "one", "draws", config, truth, terrain]
        for passed in (2, 4):
            subprocess.run([*chain, self.path("verdict.json"), "@"], check=True, capture_output=True)
            self.assertEqual(json.loads(read(self.path("verdict.json")))["rates"][0]["passed"], passed)
            self.assertEqual(os.listdir(scratch), [])


class Traced(StudyTest):
    """Campaigns whose draws trace their own rays, with landings."""

    HEIGHTS = {"name": "height_m", "key": "terrain.features.0.height_m", "values": [0.1, 1.5]}
    LANDING = {**DRAWS, "terrain_seed": "each", "landing": {"drift_time_s": 1}, "hazard": {**HAZARD, "lander": {"leg_radius_m": 0.4}}}

    def traced(self, *axes, draws=None, **keys):
        tree = draws_study(*axes, draws=draws or self.LANDING, trace_draws=True, **keys)
        tree["base"]["terrain"] = {**tree["base"]["terrain"], "base": {"type": "fractal", "rms_deviation_m": 0.02, "reference_length_m": 1}}
        return tree

    def test_the_configuration(self):
        """All stages of the case, also what moves beams and makes the ground; no truth, whatever the errors."""
        tree = self.traced(self.HEIGHTS, SPREADS)
        tree["base"]["scan"] = {**BASE["scan"], "pointing_error": {"jitter_sigma_rad": 1e-4}}
        graph = self.graph(tree)
        self.assertEqual([len(graph.truth), len(graph.terrain), len(graph.draws)], [0, 2, 4])
        configs = [json.loads(graph.configs["draws", stage.config_id]) for stage in graph.draws.values()]
        self.assertEqual([config["terrain"]["features"][0]["height_m"] for config in configs], [0.1, 0.1, 1.5, 1.5])
        self.assertEqual(configs[0]["scan"], tree["base"]["scan"])
        self.assertEqual([config["vary"][VELOCITY]["sigma"] for config in configs], [0.1, 2] * 2)
        for changes, message in (({"draws": {**DRAWS, "terrain": {}}}, r"draws\.terrain: draws have the terrain of their case"),):
            with self.assertRaisesRegex(UsageError, message):
                self.graph(self.traced(**changes))
        with self.assertRaisesRegex(UsageError, r"/trace_draws: needs draws"):
            reader.read_study(self.write(study(trace_draws=True)))

    def test_a_case_equals_monte_carlo_by_hand(self):
        path = self.write(self.traced(self.HEIGHTS, plot=FEW_FIGURES))
        self.make("study", "-j2")
        cases = json.loads(read(self.out("cases.json")))["cases"]
        folder = self.by_hand(path, 1)
        verdict = read(self.out(cases[1][-1]))
        self.assertEqual(verdict, read(os.path.join(folder, "verdict.json")))
        landing, row = json.loads(verdict)["landing"], self.rows()[1]
        for arm in ("safe", "blind"):
            self.assertEqual([float(row[f"draws.landing.{arm}.{key}"]) for key in ("passed", "draws", "passed_frac", "wilson_low")],
                             [landing[arm]["passed"], 4, landing[arm]["passed"] / 4, landing[arm]["wilson_low"]])
        self.assertEqual([float(row[f"draws.landing.{key}"]) for key in ("both", "difference.value", "difference.high", "mcnemar_p")],
                         [landing["both"], landing["difference"]["value"], landing["difference"]["high"], landing["mcnemar_p"]])
        self.check_figure()
        tree = json.loads(re.search(r'id="report-data">(.*?)</script>', read(self.out("report.html")).decode(), re.S)[1])
        self.assertEqual([tree["runs"][run][0] for run in tree["caseRuns"][0]], ["terrain", "scan", "regrid", "eval", "draws"])

    def check_figure(self):
        """A line for each arm, with the shares of the runs of draws."""
        self.assertIn("landings.png", self.files("figures"))
        with h5py.File(self.out("results.h5")) as file:
            read_results = table.Results(file)
        figure = figures.landings_figure(read_results, read_results.axes[0], 0.5)
        self.addCleanup(figures.plt.close, figure)
        lines = {line.get_label(): list(line.get_ydata()) for line in figure.axes[0].get_lines()}
        for label, arm in (("with the lidar", "safe"), ("without a lidar", "blind")):
            self.assertEqual(lines[label], [float(row[f"draws.landing.{arm}.passed_frac"]) for row in self.rows()])

    def test_a_sequential_test_of_landings(self):
        stop = {"type": "sprt", "of": "landing", "p0": 0.9, "p1": 0.3, "alpha": 0.2, "beta": 0.2}
        self.write(self.traced(draws={**self.LANDING, "draws": 20, "stop": stop}))
        self.make("study-results")
        [row] = self.rows()
        self.assertIn(row["draws.accepted"], ("0", "1"))
        self.assertNotIn("draws.landing.safe.wilson_low", row)
        self.assertIn("draws.landing.difference.value", row)


class Rates:
    """Results of which only the landings without a lidar are known: {point: (passed, draws)}."""

    def __init__(self, **rates):
        self.rates = rates

    def draws_rate(self, point, _):
        return (*self.rates[point], *table.wilson(*self.rates[point]))


class WithoutALidar(unittest.TestCase):
    SERIES = [("a", [(1, "a1"), (2, "a2")]), ("b", [(1, "b1"), (2, "b2")])]

    def test_series_that_differ_in_the_lidar_alone_are_one_line_with_the_interval_of_one(self):
        together = figures.blind_together(Rates(a1=(80, 100), b1=(84, 100), a2=(50, 100), b2=(60, 100)), self.SERIES)
        np.testing.assert_allclose(together, [(0.82, *table.wilson(82, 100)), (0.55, *table.wilson(55, 100))], rtol=1e-12)

    def test_series_that_differ_in_the_terrain_too_stay_apart(self):
        self.assertIsNone(figures.blind_together(Rates(a1=(80, 100), b1=(84, 100), a2=(20, 100), b2=(60, 100)), self.SERIES))


class Pages(StudyTest):
    def test_figures_and_report(self):
        names = ["draws.all.passed_frac", "draws.relative_horizontal.passed_frac"]
        self.write(draws_study(SPREADS, plot={"metrics": names}, repeat=REPEAT))
        self.make("study", "-j2")
        self.assertLessEqual({f"{name}.png" for name in names} | {"overview.png", "campaigns.png"}, set(self.files("figures")))
        page = read(self.out("report.html")).decode()
        self.assertIn('id="figure-campaigns"', page)
        self.assertIn("<td>monte-carlo</td>", page)
        tree = json.loads(re.search(r'id="report-data">(.*?)</script>', page, re.S)[1])
        self.assertEqual([tree["runs"][run][0] for run in tree["caseRuns"][0]], ["terrain", "truth", "scan", "regrid", "eval", "draws"])
        self.assertEqual(tree["configs"]["draws"]["base"]["vary"], {VELOCITY: {"type": "normal", "sigma": 0.1}})
        with h5py.File(self.out("results.h5")) as file:
            read_results = table.Results(file)
        row = self.rows()[0]
        point = read_results.points[0]
        self.assertEqual(len(point.rows), 2)
        expected = [float(row[f"draws.all.{key}"]) for key in ("passed_frac", "wilson_low", "wilson_high")]
        self.assertEqual(read_results.estimate(point, names[0], 0.5), tuple(expected))
        self.assertEqual(tuple(expected)[1:], table.wilson(int(row["draws.all.passed"]), 4))
        figure = verdicts.draws_figure(read_results)
        self.addCleanup(figures.plt.close, figure)
        shown = {text.get_text() for text in figure.axes[0].texts}
        self.assertIn(f"{row['draws.all.passed']}/4  [{100 * expected[1]:.0f}, {100 * expected[2]:.0f}] %", shown)

    def test_a_sequential_test(self):
        """Its figure has no intervals."""
        stop = {"type": "sprt", "p0": 0.9, "p1": 0.3, "alpha": 0.2, "beta": 0.2}
        self.write(draws_study(draws={**DRAWS, "draws": 20, "stop": stop}))
        self.make("study-results")
        [row] = self.rows()
        self.assertIn(row["draws.accepted"], ("0", "1"))
        self.assertNotIn("draws.all.wilson_low", row)
        with h5py.File(self.out("results.h5")) as file:
            figure = verdicts.draws_figure(table.Results(file))
        self.addCleanup(figures.plt.close, figure)
        self.assertIn(f"{row['draws.all.passed']}/{row['draws.all.draws']}", {text.get_text() for text in figure.axes[0].texts})


if __name__ == "__main__":
    unittest.main()
