#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""design.py on a small lidar: what its filters refuse, that its winner passes and its neighbours do not, and that neither a kill nor
a second worker changes the answer."""
import copy
import json
import math
import os
import re
import random
import signal
import subprocess
import sys
import time
import unittest
from unittest import mock

from case import BASE, BIN, PYTHON, ROOT, StudyTest, read

# pylint: disable=wrong-import-order
from landfall import dictionary, tools
from landfall.answers import design, design_problem, design_search, runs
from landfall.errors import DataError, Error, UsageError

tools.BIN = BIN
VELOCITY = "scan.navigation_error.velocity_mps.0"
VARIABLES = {"lines": {"integer": True, "low": 8, "high": 24, "keys": ["scan.scanner.pattern.rows"]},
             "columns": {"integer": True, "low": 8, "high": 24, "keys": ["scan.scanner.pattern.columns"]},
             "pixels": {"integer": True, "low": 4, "high": 10, "keys": ["scan.detector.rows", "scan.detector.columns"]},
             "method": {"values": ["bilinear_nearest", "bilinear4"], "keys": ["regrid.method"]}}
GOOD = {"lines": 20, "columns": 20, "pixels": 8, "method": "bilinear_nearest"}


def design_file(**keys):
    base = copy.deepcopy(BASE)
    base["terrain"] = {"grid": {"half_width_m": 6, "resolution_m": 0.1}, "features": [{"type": "cone", "x_m": 1.5, "y_m": 0.5, "radius_m": 1, "height_m": 0.3}]}
    base["scan"]["noise"] = {"range_sigma_m": 0.01, "dropout_frac": 0.005}
    return {"base": base, "vary": {VELOCITY: {"type": "normal", "sigma": 0.1}}, "terrains": [{}, {"terrain.features.0.x_m": -1.23}],
            "variables": copy.deepcopy(VARIABLES), "whole_pattern": True, "probability": 0.85, "race": {"p0": 0.95, "p1": 0.7}, "proof_draws": 40,
            "search": {"candidates": 10, "seed": 3, "start": [GOOD]}, **keys}


class DesignTest(StudyTest):
    def problem(self, **keys):
        return design_problem.Problem(self.write(design_file(**keys)))

    def check_candidate(self, problem, **values):
        return design_problem.CandidateCheck(problem, runs.Runner(self.path("out")))({**GOOD, **values})

    def run_it(self, *arguments, out="out", code=0):
        result = subprocess.run([PYTHON, os.path.join(ROOT, "python", "commands", "design.py"), self.path("tiny.json"), "--out", self.path(out),
                                 "--bin", BIN, *arguments], capture_output=True, text=True, timeout=900, check=False)
        self.assertEqual(result.returncode, code, result.stderr)
        return result


class Filters(DesignTest):
    def test_geometry(self):
        """Frames of 4 x 5.5 cm with a pitch of 89 cm: no tool is run."""
        problem = self.problem()
        candidate = design_problem.CandidateCheck(problem, runs.Runner(self.path("out")))
        with mock.patch.object(candidate.runner, "run", side_effect=AssertionError):
            found = candidate({**GOOD, "lines": 10, "pixels": 4})
        self.assertEqual((found["stage"], found["passes"]), ("geometry", False))
        # 8 m / 9 less 0.0011 x 4 at 50 m - 5 m/s x 200 pulses / 2 kHz, in bins of 10 cm; the limit is 4 bins.
        self.assertAlmostEqual(math.exp(found["violation"] - 1) * 4, (8 / 9 - 0.0044 * 49.5) / 0.1, delta=1e-9)

    def test_plan(self):
        found = self.check_candidate(self.problem(), lines=15, columns=15, pixels=6)
        self.assertEqual(found["stage"], "plan")
        self.assertGreater(found["violation"], 0)

    def test_draw(self):
        """Its margins are those of monte-carlo's first draw."""
        problem = self.problem()
        found = self.check_candidate(problem)
        self.assertEqual((found["stage"], found["passes"], found["cost"]), ("draw", True, 400 * 64))
        configs = problem.configs(GOOD)
        scan = runs.Scan(runs.Runner(self.path("other")), configs, 1)
        [row] = scan.rows(problem.draws(draws=1, metrics="full", seed=3))
        self.assertEqual(found["margins"]["relative elevation"], math.log(row["accuracy.relative.z.max_m"] / 0.05))
        self.assertEqual(found["margins"]["coverage"], max(-math.log(1000), math.log(max(row["coverage.invalid_frac"], 1e-99) / 0.01)))
        self.assertEqual(found["violation"], max(found["margins"].values()))

    def test_a_candidate_that_a_tool_refuses(self):
        problem = self.problem(variables={"lines": VARIABLES["lines"], "tilt": {"low": 1, "high": 40, "keys": ["scan.scanner.max_deflection_deg"]}},
                               search={"candidates": 1})
        found = design_problem.CandidateCheck(problem, runs.Runner(self.path("out")))({"lines": 20, "tilt": 1})
        self.assertEqual((found["stage"], found["passes"]), ("error", False))
        self.assertRegex(found["reason"], "max_deflection_deg")

    def test_a_configuration_that_a_tool_refuses(self):
        for base, message in self.refused_bases():
            with self.subTest(message), self.assertRaisesRegex(Error, rf"\A{re.escape(message)}[^\n]*\Z") as caught:
                self.problem(base=base)
            self.assertEqual(caught.exception.exit_code, 2)
        self.assertRegex(self.run_it(code=2).stderr, rf"\Alandfall design: {re.escape(message)}[^\n]*\n\Z")

    def test_costs(self):
        configs = self.problem().configs({**GOOD, "lines": 10})
        self.assertEqual(configs["scan"]["laser"]["scan_time_s"], 0.1)
        for cost, expected in (({"ranges": 1}, 200 * 64), ({"pulses": 2, "pixels": 10}, 400 + 640), ({"scan_time_s": 1}, 0.1), ({"pulse_rate_hz": 1}, 2000)):
            self.assertAlmostEqual(self.problem(cost=cost).cost(configs), expected)

    def test_the_chosen_place(self):
        """The margin of hazard-map's requirement, in a draw whose best site is safe and in one without a safe place."""
        file = design_file(requirement="chosen place safe")
        file["base"]["hazard"] = {"region_radius_m": 3, "sites": {"divert_radius_m": 2, "min_p": 0.9}, "touchdown_sigma_m": 0.2}
        problem = design_problem.Problem(self.write(file))
        accepted = design_problem.Problem(self.write({**file, "requirement": "accepted place safe"}, "accepted"))
        for row, margin, passes, is_accepted in (({"site.true_safe": 1, "site.p_touchdown": 0.95}, math.log(0.5), True, True),
                                                 ({"site.true_safe": 1, "site.p_touchdown": 0.85}, math.log(1.5), True, False),
                                                 ({"site.true_safe": 0, "site.p_touchdown": 0.95}, math.log(10), False, False),
                                                 ({"site.true_safe": None, "site.p_touchdown": None}, math.log(10), False, False)):
            self.assertAlmostEqual(problem.margins(row)[design_problem.CHOSEN_PLACE_SAFE], margin, delta=1e-9)
            self.assertAlmostEqual(accepted.margins(row)[design_problem.ACCEPTED_PLACE_SAFE], margin, delta=1e-9)
            self.assertEqual((problem.passes(row), accepted.passes(row)), (passes, is_accepted))
        found = self.check_candidate(problem)
        self.assertEqual((found["stage"], found["passes"], list(found["margins"])), ("draw", True, [design_problem.CHOSEN_PLACE_SAFE]))

    def test_another_share_than_the_95th_percentile(self):
        row = {number: 1e-3 for one in dictionary.requirements().values() for number in (*one.worst, one.value) if number}
        for share, within, margin in ((0.95, 0.7, math.log(1e-3 / 0.2)), (0.6, 0.7, math.log(0.6 / 0.7)), (0.8, 0.7, math.log(0.8 / 0.7))):
            file = design_file()
            file["base"]["eval"]["limits"] = {"absolute_horizontal_frac": share, "absolute_horizontal_m": 0.2}
            problem = design_problem.Problem(self.write(file))
            self.assertAlmostEqual(problem.margins({**row, "accuracy.absolute.horizontal.within_limit_frac": within})["absolute horizontal"], margin)

    def test_one_requirement_of_its_own(self):
        """By its name: the others, and the six, do not count."""
        file = design_file(requirement="NMAD")
        file["base"]["eval"]["requirements"] = [{"name": "NMAD", "metric": "statistics.z.nmad_m", "max": 0.05},
                                                {"name": "CE90", "metric": "statistics.horizontal.ce90_m", "max": 1e-9}]
        problem = design_problem.Problem(self.write(file))
        for passed, value, other in ((1, 0.025, 0), (0, 0.1, 1)):
            row = {"own_requirements.NMAD.pass": passed, "own_requirements.NMAD.value": value, "own_requirements.CE90.pass": other, "pass": other}
            self.assertEqual((problem.passes(row), problem.margins(row)), (bool(passed), {"NMAD": math.log(value / 0.05)}))
        found = self.check_candidate(problem)
        self.assertEqual((found["stage"], found["passes"], list(found["margins"])), ("draw", True, ["NMAD"]))
        self.assertEqual((problem.draws(seed=1)["metrics"], self.problem().draws(seed=1)["metrics"]), ("full", "verdict"))
        with self.assertRaisesRegex(UsageError, r'/requirement: "NMAX" is neither one of all six, .* own: NMAD; own: CE90'):
            design_problem.Problem(self.write({**file, "requirement": "NMAX"}))

    def landing_file(self, **keys):
        """Each draw on its own terrain, which follows its seed."""
        file = design_file(requirement="safe landing", traced_draws={"terrain_seed": "each", "landing": {"drift_time_s": 1}}, terrains=[{}], **keys)
        file["base"]["terrain"] |= {"base": {"type": "fractal", "rms_deviation_m": 0.02, "reference_length_m": 1}, "seed": 4}
        file["base"]["hazard"] = {"region_radius_m": 3, "lander": {"leg_radius_m": 0.4, "body_radius_m": 0.4}, "sites": {"divert_radius_m": 2, "min_p": 0.9},
                                  "touchdown_sigma_m": 0.2}
        return design_problem.Problem(self.write(file))

    def test_a_safe_landing(self):
        """The margin follows the chosen place, a landing that is not safe counts as no chance; a draw is that of the chain on its own terrain."""
        problem = self.landing_file()
        for row, margin, passes in (({"landing.safe": 1, "site.p_touchdown": 0.95}, math.log(0.5), True),
                                    ({"landing.safe": 0, "site.p_touchdown": 0.95}, math.log(10), False),
                                    ({"landing.safe": 1, "site.p_touchdown": None}, math.log(10), True)):
            self.assertAlmostEqual(problem.margins(row)[design_problem.SAFE_LANDING], margin, delta=1e-9)
            self.assertEqual(problem.passes(row), passes)
        self.assertEqual(problem.why_not({"landing.safe": 0, "site.p_touchdown": 0.95}, {}), "the landing is not safe")
        found = self.check_candidate(problem)
        self.assertEqual((found["stage"], list(found["margins"])), ("draw", [design_problem.SAFE_LANDING]))
        search = design_search.Design(problem, self.path("out"))
        [draws] = search.scans_of(GOOD)
        rows = draws.rows(problem.draws(draws=3, seed=9))
        self.assertEqual([(row["seed"], row["draw"]) for row in rows], [(9, 0), (9, 1), (9, 2)])
        self.assertEqual(len({row["score.counts.safe_safe"] for row in rows}), 3, "the terrain varies")
        for row in rows[1:]:
            self.assertEqual(search.through_the_chain(GOOD, row)["draw"], row["draw"])
        with self.assertRaises(DataError):
            search.through_the_chain(GOOD, {**rows[1], "draw": 0})

    def test_files_that_are_refused(self):
        for keys, message in (({"requirement": "chosen place safe"}, "needs a configuration of hazard-map"),
                              ({"requirement": "safe landing", "base": {**BASE, "hazard": {}}}, "/requirement: \"safe landing\" needs /traced_draws/landing"),
                              ({"traced_draws": {"terrain_seed": "all"}}, "/traced_draws/terrain_seed"), ({"cost": {"mass": 1}}, "/cost/mass: is not one of"),
                              ({"proof_draws": 10}, "/proof_draws: 10 draws without a failure show less than 0.85; 19 are needed"),
                              ({"variables": {"a": {"keys": ["scan.seed"], "low": 2, "high": 2}}}, "/variables/a: low and high are needed, and low < high"),
                              ({"variables": {"a": {"keys": ["scan.seed"]}}}, "needs either values, or low and high"),
                              ({"variables": {"a": {"keys": ["scan.seed"], "integer": True, "low": 1.5, "high": 2}}}, "must be whole numbers"),
                              ({"variables": {"a": {"keys": ["scan.seed"], "integer": True, "values": [1, 2]}}}, "/variables/a: integer and step are for a range"),
                              ({"whole_pattern": True, "base": {**BASE, "scan": {"scanner": {"type": "flash"}}}}, "/whole_pattern: needs a scanner"),
                              ({"search": {"start": [{"lines": 1}]}}, "/search/start/0: needs a value for each of lines, columns"),
                              *(({"search": {"start": [GOOD, {**GOOD, "lines": value}]}}, f"/search/start/1/lines: {re.escape(text)} is not a whole number in .8, 24")
                                for value, text in (("preset:paper", '"preset:paper"'), (True, "true"), (9.5, "9.5"), (25, "25"), (None, "null"), ([8], "[8]"))),
                              ({"search": {"start": [{**GOOD, "method": 1}]}}, "/search/start/0/method: 1 is not one of \"bilinear_nearest\", \"bilinear4\""),
                              ({"terrains": []}, "/terrains")):
            with self.assertRaisesRegex(UsageError, message):
                self.problem(**keys)


class Statistics(unittest.TestCase):
    def test_failures_allowed(self):
        """The table of docs/reference/statistics.md."""
        self.assertEqual([design_problem.draws_needed(0.99, failures) for failures in range(5)], [299, 473, 628, 773, 913])
        self.assertEqual([design_problem.failures_allowed(0.99, draws) for draws in (298, 299, 472, 473, 913)], [-1, 0, 0, 1, 4])

    def test_the_rate_of_passes(self):
        """Closed form without failures; the bound that failures_allowed() judges by; Wilson's interval as R's prop.test gives it."""
        self.assertAlmostEqual(design_problem.rate_of("x", [True] * 473)["exact_lower_bound"], 0.05 ** (1 / 473), delta=1e-12)
        for failures, reaches in ((1, True), (2, False)):
            rate = design_problem.rate_of("x", [True] * (473 - failures) + [False] * failures)
            self.assertEqual(rate["exact_lower_bound"] >= 0.99, reaches)
        rate = design_problem.rate_of("x", [True] * 99 + [False])
        self.assertEqual((rate["passed"], rate["draws"]), (99, 100))
        self.assertAlmostEqual(rate["wilson_low"], 0.9455, delta=5e-5)
        self.assertAlmostEqual(rate["wilson_high"], 0.9982, delta=5e-5)
        self.assertEqual(design_problem.rate_of("x", [False] * 10)["exact_lower_bound"], 0)
        self.assertAlmostEqual(design_problem.rate_of("x", [True] + [False] * 472)["exact_lower_bound"], 1 - 0.95 ** (1 / 473), delta=1e-14)

    def test_the_sequential_test(self):
        """Straight passes as in the table of docs/reference/statistics.md, and a limit that is reached exactly (D305)."""
        for p0, p1, passes in ((0.99, 0.97, 145), (0.995, 0.99, 585), (0.95, 0.9, 55)):
            rule = {"p0": p0, "p1": p1, "alpha": 0.05, "beta": 0.05}
            self.assertEqual(design_search.sprt([True] * 2000, **rule), (True, passes))
            self.assertEqual(design_search.sprt([True] * (passes - 1), **rule), (None, passes - 1))
        self.assertEqual(design_search.sprt([False] * 9, p0=0.99, p1=0.97, alpha=0.05, beta=0.05), (False, 3))
        self.assertEqual(design_search.sprt([True] * 9, p0=0.9, p1=0.1, alpha=0.1, beta=0.1), (True, 1))

    def test_pareto(self):
        def candidates(*points):
            return [{"stage": "draw", "cost": cost, "margins": dict(enumerate(margins))} for cost, *margins in points]
        front = design_search.pareto([*candidates((3, -1), (1, 2), (2, 0), (2, -0.5), (4, -0.7), (1.5, 3)), {"stage": "plan", "cost": 0, "margins": {}}])
        self.assertEqual([(candidate["cost"], candidate["margins"][0]) for candidate in front], [(1, 2), (2, -0.5), (3, -1)])
        front = design_search.pareto(candidates((1, 0, -0.1), (2, -0.4, 0), (3, -0.2, 0), (4, -0.3, -0.3)))
        self.assertEqual([candidate["cost"] for candidate in front], [1, 2, 4])
        order = design_search.by_fronts(candidates((3, -1), (1, -0.2), (2, -0.1), (2.5, -0.15), (4, -0.9)))
        self.assertEqual([candidate["cost"] for candidate in order], [1, 3, 2, 2.5, 4])


class Sequential(DesignTest):
    def test_it_stops_where_monte_carlo_does(self):
        """At the same draw with the same decision, for limits that few, half and most of the draws meet."""
        file = design_file(terrains=[{}], race={"p0": 0.6, "p1": 0.3})
        decisions = set()
        for limit in (0.0145, 0.0165, 0.018):
            file["base"]["eval"]["limits"] = {"relative_elevation_m": limit}
            problem = design_problem.Problem(self.write(file))
            search = design_search.Design(problem, self.path("out"))
            race = search.race({"values": GOOD, "cost": 1})["race"]
            verdict = self.path("verdict.json")
            configs = problem.configs(GOOD)
            scan = runs.Scan(search.runner, configs, 1)
            scan.make_draws(problem.draws(draws=design_search.MAX_DRAWS, seed=design_search.RACE_SEED,
                                        stop={"type": "sprt", "p0": 0.6, "p1": 0.3, "alpha": 0.05, "beta": 0.05}),
                          self.path("draws.h5"), "--verdict", verdict)
            tree = json.loads(read(verdict))
            rate = next(rate for rate in tree["rates"] if rate["requirement"] == "all")
            self.assertEqual((race["accepted"], race["terrains"][0]), (tree["sprt"] == "accepted", {"passed": rate["passed"], "draws": rate["draws"]}))
            decisions.add(race["accepted"])
        self.assertEqual(decisions, {True, False})

    def test_the_one_before_an_improvement_is_proved_if_the_proof_of_the_improved_one_fails(self):
        def of(cost):
            return {"values": {"lines": cost}, "cost": cost, "passes": True, "stage": "draw", "margins": {"all": cost}}

        search, proved = design_search.Design(self.problem(), self.path("out")), []

        def prove(candidate):
            proved.append(candidate["cost"])
            return [{"exact_lower_bound": float(candidate["cost"] == 5)}]

        with mock.patch.multiple(search, search=lambda: [of(5), of(6)], race=lambda candidate: {**candidate, "race": {"accepted": True}}, prove=prove,
                                 check_candidate=lambda values: {}, improve=lambda found, raced: [(found, ["of 5"]), (of(4), ["of 4"]), (of(3), ["of 3"])]):
            answer = search.run()
        self.assertEqual((proved, answer["winner"]["cost"], answer["neighbours"]), ([3, 4, 5], 5, ["of 5"]))

    def test_a_draw_that_the_chain_contradicts_ends_the_run(self):
        problem = self.problem()
        search = design_search.Design(problem, self.path("out"))
        scan = runs.Scan(search.runner, problem.configs(GOOD), 1)
        [row] = scan.rows(problem.draws(draws=1, seed=7))
        self.assertEqual(search.through_the_chain(GOOD, row)["seed"], 7)
        with self.assertRaisesRegex(DataError, "coverage.invalid_count of draw 0 of the seed 7 is -1, and"):
            search.through_the_chain(GOOD, {**row, "coverage.invalid_count": -1})

    def test_seeds_never_meet(self):
        """The draws of the search, the tests and the proofs, by what monte-carlo is given."""
        problem = self.problem(search={"candidates": 4, "seed": 3, "start": [GOOD]})
        search, seeds = design_search.Design(problem, self.path("out")), {}
        make_draws = runs.Scan.make_draws

        def spy(scan, draws, output, *arguments):
            kind = {1: "search", design_search.MAX_DRAWS: "test"}.get(draws["draws"], "proof")
            seeds.setdefault(kind, set()).add(draws["scan"]["seed"])
            return make_draws(scan, draws, output, *arguments)
        with mock.patch.object(runs.Scan, "make_draws", spy):
            answer = search.run()
        self.assertIsNotNone(answer["winner"])
        self.assertEqual(set(seeds), {"search", "test", "proof"})
        self.assertEqual([a & b for a, b in ((seeds["search"], seeds["test"]), (seeds["search"], seeds["proof"]), (seeds["test"], seeds["proof"]))], [set()] * 3)


class Run(DesignTest):
    def check_answer(self, out, text):
        """The files of a run, and what it prints."""
        answer = json.loads(read(self.path(out, "design.json")))
        winner, problem = answer["winner"], design_problem.Problem(self.path("tiny.json"))
        self.assertEqual(answer["cost_frac"], problem.cost(problem.configs(winner["values"])) / (400 * 64))
        self.assertLess(answer["cost_frac"], 1)
        for rate in winner["proof"]:
            self.assertEqual(rate["draws"], 40)
            self.assertGreaterEqual(rate["exact_lower_bound"], 0.85)
        self.assertEqual(winner["chain"]["seed"], winner["proof"][0]["first_seed"])
        self.assertGreater(winner["chain"]["numbers"], 20)
        for candidate in answer["neighbours"]:
            self.assertLessEqual(candidate["cost"], winner["cost"])
            self.assertTrue(candidate["cost"] == winner["cost"] or not candidate.get("race", {}).get("accepted"), candidate)
        self.assertTrue(any(candidate["cost"] < winner["cost"] for candidate in answer["neighbours"]))
        self.assertEqual(answer["active"], max(winner["margins"], key=winner["margins"].get))
        for expected in ("Winner:", "active", "Neighbours that cost no more", "fresh draws pass"):
            self.assertIn(expected, text)
        page = read(self.path(out, "report.html")).decode()
        self.assertIn(f"{100 * answer['cost_frac']:.1f} % of the base", page)
        self.assertEqual(len(read(self.path(out, "candidates.csv")).decode().splitlines()), 11)
        self.assertTrue(read(self.path(out, "design.png")).startswith(b"\x89PNG"))

    def test_the_answer_whole_killed_and_of_two_workers(self):
        """A run that is killed again and again, at any time, and the recipe with two workers have the bytes of an undisturbed one."""
        self.write(design_file())
        result = self.run_it(out="whole")
        self.check_answer("whole", result.stdout)
        self.assertRegex(result.stderr, r"\Acost: about \S+ \S+ for 10 candidates \(\S+ s each, as the base\) and 40 fresh draws on each of 2 terrains \(.*on the disk: 2 terrains, 1 MB")
        generator, kills = random.Random(int(os.environ.get("LANDFALL_TEST_SEED", "1"))), 0
        command = [PYTHON, os.path.join(ROOT, "python", "commands", "design.py"), self.path("tiny.json"), "--out", self.path("killed"), "--bin", BIN]
        for _ in range(2):
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
            end = time.monotonic() + generator.uniform(1, 5)
            while process.poll() is None and time.monotonic() < end:
                time.sleep(0.05)
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                kills += 1
            process.wait()
        self.assertGreater(kills, 0)
        self.assertNotIn("cost: ", self.run_it(out="killed").stderr)
        self.assertIn("Winner:", self.make("design", "-j2").stdout)
        for name in ("design.json", "candidates.csv", "report.html", "design.png"):
            for out in ("killed", "runs/design/tiny"):
                self.assertEqual(read(self.path(out, name)), read(self.path("whole", name)), (out, name))

    def test_without_optuna_a_message_names_its_package(self):
        self.write(design_file())
        with mock.patch.dict(sys.modules, {"optuna": None}), self.assertRaisesRegex(UsageError, "apt-get install python3-optuna$"):
            design.main([self.path("tiny.json"), "--out", self.path("out")])
        with self.assertRaisesRegex(UsageError, "none.json"):
            design.main([self.path("none.json"), "--out", self.path("out")])
        self.assertFalse(os.path.exists(self.path("out")))


if __name__ == "__main__":
    unittest.main()
