#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""sensitivity.py: its indices are those of functions with known ones, and of a landfall whose response is linear."""
import copy
import csv
import json
import math
import os
import re
import signal
import subprocess
import sys
import time
import unittest
from unittest import mock

import numpy as np
from case import BASE, BIN, PYTHON, ROOT, StudyTest, read

# pylint: disable=wrong-import-order
from landfall import tools
from landfall.answers import model, sensitivity
from landfall.errors import DataError, Error, UsageError

tools.BIN = BIN
VELOCITY, POSITION, SIGMA = "scan.navigation_error.velocity_mps.0", "scan.navigation_error.position_m.0", "scan.noise.range_sigma_m"
MEAN_X = "accuracy.absolute.x.mean_m"


class Callable:
    """A model as sensitivity and the engines need it: a function of rows, with names."""

    def __init__(self, inputs, function, output="y"):
        self.inputs, self.outputs, self.function, self.failures = list(inputs), [output], function, {}

    def __call__(self, values):
        table = np.asarray(values, dtype=float)
        found = self.function(np.atleast_2d(table))[:, None]
        return found[0] if table.ndim == 1 else found


def ishigami(x):
    return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


# Closed form, a = 7 and b = 0.1.
V1, V2, V13 = 0.5 * (1 + 0.1 * math.pi ** 4 / 5) ** 2, 49 / 8, 0.01 * math.pi ** 8 * (1 / 18 - 1 / 50)
ISHIGAMI = {"first": [V1, V2, 0], "total": [V1 + V13, V2, V13]}
VARIANCE = V1 + V2 + V13


class SensitivityTest(StudyTest):
    def problem(self, groups, outputs=None, **keys):
        return sensitivity.Problem(self.write({"base": copy.deepcopy(BASE), "groups": groups, "outputs": outputs or {"y": "y"}, **keys}))

    def assert_within(self, index, expected, slack=0.0):
        self.assertLessEqual(index["low"] - slack, expected)
        self.assertGreaterEqual(index["high"] + slack, expected)
        self.assertLess(index["high"] - index["low"], 0.6)  # 1.2 would be no information


class Traced(SensitivityTest):
    def test_a_key_that_moves_beams(self):
        """Each draw traces its own rays: the mean error in x follows the navigation error, whatever the path's dispersion."""
        uniform = {"type": "uniform", "low": -0.05, "high": 0.05}
        groups = {"navigation": {POSITION: uniform}, "dispersion": {"scan.trajectory_dispersion.position_m.1": uniform}}
        problem = self.problem(groups, {MEAN_X: "x"}, size=16, traced_draws={})
        of = model.Model(problem.base, [key for _, key in problem.keys] + [model.DRAW], problem.outputs, self.path("out"), traced=problem.traced)
        with mock.patch.object(model.runs, "Scan", side_effect=AssertionError("a shared scan")):
            answer = sensitivity.analyse(problem, of)
        self.assertEqual((answer["points"], of.failures), (16, {}))
        navigation, dispersion, _ = answer["outputs"][MEAN_X]["groups"]
        self.assertGreater(navigation["total"]["value"], 0.9)
        self.assertLess(dispersion["total"]["value"], 0.1)


class Ishigami(SensitivityTest):
    """Through openturns_function, and through the groups of a sensitivity file."""

    ANGLE = {"type": "uniform", "low": -math.pi, "high": math.pi}

    def test_the_adaptor(self):
        module = model.openturns()
        module.RandomGenerator.SetSeed(1)
        function = model.openturns_function(Callable("abc", ishigami))
        size = 2048
        inputs = module.SobolIndicesExperiment(module.ComposedDistribution(3 * [module.Uniform(-math.pi, math.pi)]), size, False).generate()
        for kind in ("Martinez", "Saltelli", "Jansen"):
            algorithm = getattr(module, kind + "SensitivityAlgorithm")(inputs, function(inputs), size)
            algorithm.setUseAsymptoticDistribution(True)
            for name, found, interval in (("first", algorithm.getFirstOrderIndices(), algorithm.getFirstOrderIndicesInterval()),
                                          ("total", algorithm.getTotalOrderIndices(), algorithm.getTotalOrderIndicesInterval())):
                for i, expected in enumerate(ISHIGAMI[name]):
                    self.assertLessEqual(interval.getLowerBound()[i], expected / VARIANCE, (kind, name, i))
                    self.assertGreaterEqual(interval.getUpperBound()[i], expected / VARIANCE, (kind, name, i))
                    self.assertAlmostEqual(found[i], expected / VARIANCE, delta=0.1)

    def test_groups(self):
        """{x1, x3} and {x2} add up; the seed, which the function ignores, has no share."""
        problem = self.problem({"one and three": {VELOCITY: self.ANGLE, POSITION: self.ANGLE}, "two": {SIGMA: self.ANGLE}}, size=1024)
        answer = sensitivity.analyse(problem, Callable("abcd", lambda x: ishigami(x[:, [0, 2, 1]])))
        rows = {row["group"]: row for row in answer["outputs"]["y"]["groups"]}
        self.assertEqual(list(rows), ["one and three", "two", "random numbers"])
        for kind in ("first", "total"):
            self.assert_within(rows["one and three"][kind], (V1 + V13) / VARIANCE)
            self.assert_within(rows["two"][kind], V2 / VARIANCE)
            self.assert_within(rows["random numbers"][kind], 0, slack=1e-9)
        self.assert_drawn(problem, answer, rows)
        self.assertAlmostEqual(answer["outputs"]["y"]["mean"], 3.5, delta=0.2)
        self.assertAlmostEqual(answer["outputs"]["y"]["std"], math.sqrt(VARIANCE), delta=0.2)

    def assert_drawn(self, problem, answer, rows):
        """Bars of groups with an effect are filled, all intervals are inside the panel, and an output that does not vary is named."""
        problem.outputs["z"], answer["outputs"]["z"] = "never varies", {"groups": None}
        figure = sensitivity.figure_of(problem, answer)
        panel, = figure.axes
        self.assertEqual([bool(bar.get_facecolor()[3]) for bar in panel.patches], 2 * [True, True, False])
        self.assertGreaterEqual(panel.get_ylim()[1], max(row[kind]["high"] for row in rows.values() for kind in ("first", "total")))
        self.assertIn("the same in all draws: never varies", figure._suptitle.get_text())  # pylint: disable=protected-access

    def test_every_estimator(self):
        for name in sensitivity.ESTIMATORS:
            problem = self.problem({"one": {VELOCITY: self.ANGLE}, "two": {SIGMA: self.ANGLE}}, size=1024, estimator=name)
            rows = sensitivity.analyse(problem, Callable("abc", lambda x: x[:, 0] + 2 * x[:, 1]))["outputs"]["y"]["groups"]
            for row, expected in zip(rows, (0.2, 0.8, 0)):
                for kind in ("first", "total"):  # three standard errors of a correlation of 1,024 points
                    self.assertAlmostEqual(row[kind]["value"], expected, delta=0.1)


class Sample(SensitivityTest):
    GROUPS = {"velocity": {VELOCITY: {"type": "normal", "mean": 1, "sigma": 0.5}}, "noise": {SIGMA: {"type": "uniform", "low": 0.01, "high": 0.03}}}

    def test_the_design(self):
        problem = self.problem(self.GROUPS, size=64, seed=10)
        table = problem.design()
        first, second, *others = table.reshape(5, 64, 3)
        self.assertEqual(problem.draw_count(), len(table))
        self.assertEqual((first[:, 2].tolist(), second[:, 2].tolist()), (list(range(64)), list(range(64, 128))))
        for column, frozen in enumerate(others):
            for i in range(3):
                self.assertEqual(frozen[:, i].tolist(), (second if i == column else first)[:, i].tolist())
        self.assertAlmostEqual(first[:, 0].mean(), 1, delta=0.1)
        self.assertAlmostEqual(first[:, 0].std(), 0.5, delta=0.1)
        self.assertTrue(np.all((first[:, 1] >= 0.01) & (first[:, 1] <= 0.03)))
        self.assertLess(abs(np.corrcoef(first[:, 0], second[:, 0])[0, 1]), 0.2)
        self.assertEqual(problem.design().tolist(), table.tolist())

    def test_the_base_samples_are_independent(self):
        """With as many keys and as few points as in studies/example-2.sensitivity.json."""
        groups = {f"group {axis}": {f"scan.navigation_error.{name}.{axis}": {"type": "normal", "sigma": 1}
                                    for name in ("position_m", "velocity_mps", "rpy_rad", "rpy_rate_radps")} for axis in range(3)}
        first, second = self.problem(groups, size=96).design().reshape(6, 96, 13)[:2, :, :-1]
        correlations = np.corrcoef(first.T, second.T)[:12, 12:]
        self.assertLess(np.abs(correlations).max(), 4 / math.sqrt(96))
        self.assertLess(abs(correlations.mean()), 4 / math.sqrt(144 * 96))

    def test_points_with_failures_are_left_out(self):
        problem = self.problem(self.GROUPS, size=64)
        seeds = problem.design()[:, 2]

        def function(x):
            return np.where(x[:, 2] == seeds[3], np.nan, x[:, 0])
        of = Callable("abc", function)
        of.failures = {3: "a reason"}
        answer = sensitivity.analyse(problem, of)
        self.assertEqual((answer["points"], answer["points_left_out"], answer["failures"]), (63, 1, ["a reason"]))
        self.assertAlmostEqual(answer["outputs"]["y"]["groups"][0]["first"]["value"], 1, delta=1e-9)
        self.assertIn("1 of 64 points left out, because a draw failed or a metric has no value: a reason", sensitivity.text_of(problem, answer))
        with self.assertRaisesRegex(DataError, "only 0 of 64 points have all their numbers, 16 are needed; a reason"):
            of = Callable("abc", lambda x: x[:, 0] * np.nan)
            of.failures = {0: "a reason"}
            sensitivity.analyse(problem, of)

    def test_an_output_that_does_not_vary(self):
        problem = self.problem(self.GROUPS, size=16)
        answer = sensitivity.analyse(problem, Callable("abc", lambda x: 0 * x[:, 0]))
        self.assertIsNone(answer["outputs"]["y"]["groups"])
        self.assertIn("the same in all draws", sensitivity.text_of(problem, answer))

    def test_files_that_are_refused(self):
        normal = {"type": "normal", "sigma": 1}
        for groups, message in (({"a": {VELOCITY: {"type": "normal", "sigma": 0}}}, f"/groups/a/{VELOCITY}/sigma: 0 is not > 0"),
                                ({"a": {VELOCITY: {"type": "uniform", "low": 2, "high": 1}}}, "/low: 2 is not < high, 1"),
                                ({"a": {VELOCITY: {"type": "uniform", "high": 1}}}, f'/groups/a/{VELOCITY}: needs the key "low", because its type is uniform'),
                                ({"a": {VELOCITY: {"type": "uniform", "low": -1}}}, f'/groups/a/{VELOCITY}: needs the key "high"'),
                                ({"a": {VELOCITY: {"type": "normal", "mean": 1}}}, f'/groups/a/{VELOCITY}: needs the key "sigma"'),
                                ({"a": {VELOCITY: {**normal, "high": 1}}}, "/high: is not a key of the type normal, which has mean, sigma"),
                                ({"a": {VELOCITY: normal}, "b": {VELOCITY: normal}}, "is given twice"),
                                ({"a": {"scan.seed": normal}}, 'is the key of the group "random numbers"'),
                                ({"random numbers": {VELOCITY: normal}}, "this group is always there"),
                                ({"a": {}}, "/groups/a: is empty")):
            with self.assertRaisesRegex(UsageError, message):
                self.problem(groups)


class Landfall(SensitivityTest):
    """A velocity error v and a position error p move the map by p + v t: the mean error over the footprints is linear in both."""

    def file(self, **keys):
        groups = {"velocity": {VELOCITY: {"type": "normal", "sigma": 0.3}}, "position": {POSITION: {"type": "normal", "sigma": 0.02}}}
        return self.write({"base": copy.deepcopy(BASE), "groups": groups, "outputs": {MEAN_X: "mean error in x"}, "size": 64, **keys})

    def run_it(self, *arguments, out="out", code=0, **options):
        result = subprocess.run([PYTHON, os.path.join(ROOT, "python", "commands", "sensitivity.py"), self.path("tiny.json"), "--out", self.path(out),
                                 "--bin", BIN, *arguments], capture_output=True, text=True, timeout=600, check=False, **options)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def test_a_linear_response(self):
        self.file()
        result = self.run_it()
        self.assertRegex(result.stderr, r"\Acost: about \S+ \S+ for 320 draws \(\S+ s each\), with 1 run at a time; on the disk: 1 terrain, 1 MB, and up to 1 scan")
        answer = json.loads(read(self.path("out", "sensitivity.json")))
        rows = {row["group"]: row for row in answer["outputs"][MEAN_X]["groups"]}
        # 400 pulses at 2 kHz cover a square that is symmetric about the judged disc: its mean time is half of the scan.
        time_s = 399 / 2 / 2000
        velocity, position = (0.3 * time_s) ** 2, 0.02 ** 2
        for kind in ("first", "total"):
            self.assert_within(rows["velocity"][kind], velocity / (velocity + position), slack=0.01)
            self.assert_within(rows["position"][kind], position / (velocity + position), slack=0.01)
            self.assert_within(rows["random numbers"][kind], 0, slack=0.02)
        self.assertAlmostEqual(answer["outputs"][MEAN_X]["std"], math.sqrt(velocity + position), delta=0.006)
        self.assertIn("320 draws, 3 groups", result.stdout)
        table = list(csv.DictReader(read(self.path("out", "sensitivity.csv")).decode().splitlines()))
        self.assertEqual([(row["group"], float(row["first_value"])) for row in table], [(name, row["first"]["value"]) for name, row in rows.items()])
        self.assertTrue(read(self.path("out", "sensitivity.png")).startswith(b"\x89PNG"))
        page = read(self.path("out", "report.html")).decode()
        self.assertIn(f"{rows['velocity']['first']['value']:.3f}", page)
        self.assertNotRegex(page, r"(src|href)=.?http")

    def test_a_configuration_that_a_tool_refuses(self):
        for base, message in self.refused_bases():
            with self.subTest(message), self.assertRaisesRegex(Error, rf"\A{re.escape(message)}[^\n]*\Z") as caught:
                sensitivity.Problem(self.file(base=base))
            self.assertEqual(caught.exception.exit_code, 2)
        self.assertRegex(self.run_it(code=2).stderr, rf"\Alandfall sensitivity: {re.escape(message)}[^\n]*\n\Z")

    def test_killed_and_resumed_and_two_workers(self):
        """Each gives the bytes of an undisturbed run; what was done is not done again. The two workers are of the recipe, with a runner."""
        self.file(size=40)
        whole = self.run_it(out="whole")
        process = subprocess.Popen([PYTHON, os.path.join(ROOT, "python", "commands", "sensitivity.py"), self.path("tiny.json"), "--out",
                                    self.path("killed"), "--bin", BIN], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline and not self.parts("killed"):
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
        process.wait()
        before = self.parts("killed")
        self.assertTrue(0 < len(before) < len(self.parts("whole")), before)
        times = {name: os.stat(self.path("killed", "cache", name)).st_mtime_ns for name in before}
        resumed = self.run_it(out="killed")
        self.assertEqual({name: os.stat(self.path("killed", "cache", name)).st_mtime_ns for name in before}, times)
        with open(self.path("runner"), "w", encoding="utf-8") as file:
            file.write(f'#!/bin/sh\necho "$1" >> {self.path("ran")}\nexec "$@"\n')
        os.chmod(self.path("runner"), 0o755)
        self.assertIn("200 draws, 3 groups", self.make("sensitivity", "-j2", f"RUNNER={self.path('runner')}").stdout)
        self.assertIn("monte-carlo", read(self.path("ran")).decode())
        for name in ("sensitivity.json", "sensitivity.csv", "report.html", "sensitivity.png"):
            for out in ("killed", "runs/sensitivity/tiny"):
                self.assertEqual(read(self.path(out, name)), read(self.path("whole", name)), (out, name))
        self.assertNotIn("cost: ", resumed.stderr)
        self.assertEqual(resumed.stdout.replace("/killed/", "/whole/"), whole.stdout)

    def parts(self, out):
        folder = self.path(out, "cache")
        return sorted(name for name in os.listdir(folder) if name.startswith("rows-")) if os.path.isdir(folder) else []

    def test_the_recipe(self):
        self.file(size=16)
        for jobs, workers in (([], "1"), (["-j3"], "3")):
            plan = self.make("-n", "sensitivity", "RUNNER=srun -n1", *jobs).stdout
            self.assertRegex(plan.replace("\\\n", ""), rf'sensitivity.py {self.path("tiny.json")} --out {self.path("runs")}/sensitivity/tiny .*-j {workers} --runner "srun -n1"')
        result = self.make("sensitivity", "STUDY=", code=2)
        self.assertIn("Say which study", result.stderr)

    def test_without_openturns_a_message_names_its_package(self):
        self.file()
        with mock.patch.dict(sys.modules, {"openturns": None}), self.assertRaisesRegex(UsageError, "apt-get install python3-openturns$"):
            sensitivity.main([self.path("tiny.json"), "--out", self.path("out")])
        self.assertFalse(os.path.exists(self.path("out")))


if __name__ == "__main__":
    unittest.main()
