#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall.model: its numbers are those of the chain, whatever is cached, shared or run at once; engines and Dakota use it."""
import copy
import io
import json
import os
import subprocess
import sys
import unittest
from unittest import mock

import numpy as np
from case import BASE, BIN, PYTHON, ROOT, StudyTest, read

# pylint: disable=wrong-import-order
from landfall import tools
from landfall.answers import dakota, model, runs
from landfall.errors import DataError, UsageError
from landfall.study.results import flatten

tools.BIN = BIN
SIGMA, VELOCITY, POSITION, DRAW = ("scan.noise.range_sigma_m", "scan.navigation_error.velocity_mps.0", "scan.navigation_error.position_m.0",
                                   "scan.draw")
HEIGHT = "scan.trajectory.position_m.2"
LARGEST, INVALID, MEAN_X = "accuracy.relative.z.max_m", "coverage.invalid_frac", "accuracy.absolute.x.mean_m"


class ModelTest(StudyTest):
    def of(self, inputs, outputs, folder="cache", base=None, **options):
        return model.model(copy.deepcopy(base or BASE), inputs, outputs, self.path(folder), **options)

    def chain(self, configs):
        """The metrics of the tools, run by hand."""
        def tool(name, *arguments, config):
            subprocess.run([os.path.join(BIN, name), *arguments, "-c", "-", "-O", "-q"], input=json.dumps(config), text=True, check=True)
        names = [self.path(name) for name in ("t.h5", "s.h5", "d.h5", "m.json")]
        tool("terrain-gen", "-o", names[0], config=configs["terrain"])
        tool("scan-sim", "--terrain", names[0], "-o", names[1], config=configs["scan"])
        tool("regrid", names[1], "--terrain", names[0], "-o", names[2], config=configs["regrid"])
        tool("dem-eval", names[2], "--metrics", names[3], "--metrics-only", config=configs["eval"])
        return flatten(json.loads(read(names[3])))

    @staticmethod
    def with_errors(sigma=0, velocity=0, height=50, draw=0):
        configs = copy.deepcopy(BASE)
        configs["scan"] |= {"noise": {"range_sigma_m": sigma}, "navigation_error": {"velocity_mps": [velocity, 0, 0]}, "draw": draw}
        configs["scan"]["trajectory"]["position_m"] = [0, 0, height]
        return configs


class Traced(ModelTest):
    """Rows that trace their own rays, on ground that follows the draw."""

    SLOPE = "terrain.base.1.slope_x"
    OUTPUTS = [LARGEST, INVALID, MEAN_X, "pass"]
    ROWS = [[50, 7, 0.01], [50, 8, 0.02], [55, 3, 0.01], [50, 9, -0.01]]

    def base(self):
        base = self.with_errors(sigma=0.01, velocity=0.1)
        base["terrain"] = {**base["terrain"], "seed": 5, "base": [{"type": "fractal", "rms_deviation_m": 0.02, "reference_length_m": 1}, {"type": "plane"}]}
        base["scan"]["pointing_error"] = {"jitter_sigma_rad": 1e-4}
        return base

    def of_rows(self, traced, outputs=None, folder="cache", inputs=(HEIGHT, DRAW, SLOPE)):
        return self.of(list(inputs), outputs or self.OUTPUTS, base=self.base(), folder=folder, traced=traced)

    def test_rows_have_the_numbers_of_the_chain(self):
        for seeds in ("each", "fixed"):
            found = self.of_rows({"terrain_seed": seeds}, folder=seeds)(self.ROWS)
            for row, (height, draw, slope) in zip(found, self.ROWS):
                base = self.base()
                base["scan"]["trajectory"]["position_m"][2], base["scan"]["draw"] = height, draw
                base["terrain"]["base"][1]["slope_x"] = slope
                base["terrain"]["draw"] = draw if seeds == "each" else 0
                numbers = self.chain(base)
                self.assertEqual(row.tolist(), [numbers[name] for name in self.OUTPUTS])

    def test_it_is_a_function_of_the_values(self):
        of = self.of_rows({"terrain_seed": "each"})
        found = of(self.ROWS)
        alone = self.of_rows({"terrain_seed": "each"}, folder="alone")
        self.assertEqual([alone(row).tolist() for row in self.ROWS[::-1]], found.tolist()[::-1])
        with mock.patch.object(runs.Runner, "run", side_effect=AssertionError("is computed again")) as made:
            made.side_effect = lambda tool, *arguments, config=None: "" if "--check" in arguments else self.fail("is computed again")
            self.assertEqual(of(self.ROWS).tolist(), found.tolist())

    def test_keys_that_draws_do_not_vary(self):
        """Bins, whole numbers of the detector; another set of draws for each."""
        keys = ["regrid.resolution_m", "scan.detector.rows", DRAW]
        found = self.of_rows({}, inputs=keys)([[0.2, 8, 1], [0.1, 8, 2], [0.2, 6, 3]])
        for row, (resolution, rows, draw) in zip(found, [(0.2, 8, 1), (0.1, 8, 2), (0.2, 6, 3)]):
            base = self.base()
            base["regrid"]["resolution_m"], base["scan"]["detector"]["rows"], base["scan"]["draw"] = resolution, rows, draw
            numbers = self.chain(base)
            self.assertEqual(row.tolist(), [numbers[name] for name in self.OUTPUTS])

    def test_landings_and_rows_that_fail(self):
        base = {**self.base(), "hazard": {"region_radius_m": 2, "lander": {"leg_radius_m": 0.4}, "sites": {"divert_radius_m": 2}}}
        of = self.of([HEIGHT, DRAW], ["landing.safe", "blind.slope_deg", "landing.x_m"], base=base, traced={"landing": {"drift_time_s": 3}})
        found = of([[50, 1], [-3, 2], [50, 3]])
        self.assertEqual(np.isnan(found).all(axis=1).tolist(), [False, True, False])
        self.assertRegex(of.failures[1], "below the terrain")
        self.assertTrue(set(found[[0, 2], 0]) <= {0, 1} and len(set(found[[0, 2], 2])) == 2)


class Values(ModelTest):
    OUTPUTS = [LARGEST, INVALID, MEAN_X, "pass", "accuracy.absolute.horizontal.p95_m"]

    def expect(self, found, **values):
        numbers = self.chain(self.with_errors(**values))
        self.assertEqual(found.tolist(), [numbers[name] for name in self.OUTPUTS])

    def test_redrawn_errors_have_the_numbers_of_the_chain(self):
        found = self.of([SIGMA, VELOCITY, DRAW], self.OUTPUTS)([[0.01, 0.5, 7], [0.03, -0.2, 8], [0.02, 0, 3]])
        self.assertEqual(len({tuple(row) for row in found.tolist()}), 3)
        for row, (sigma, velocity, draw) in zip(found, [(0.01, 0.5, 7), (0.03, -0.2, 8), (0.02, 0, 3)]):
            self.expect(row, sigma=sigma, velocity=velocity, draw=draw)

    def test_keys_that_move_rays(self):
        of = self.of([SIGMA, HEIGHT], self.OUTPUTS)
        found = of([[0.01, 50], [0.01, 55], [0.02, 50]])
        for row, (sigma, height) in zip(found, [(0.01, 50), (0.01, 55), (0.02, 50)]):
            self.expect(row, sigma=sigma, height=height)

    def test_rays_that_follow_the_draw(self):
        base = self.with_errors(sigma=0.01)
        base["scan"]["pointing_error"] = {"jitter_sigma_rad": 1e-4}
        found = self.of([DRAW], self.OUTPUTS, base=base)([[2], [3]])
        for row, draw in zip(found, (2, 3)):
            base["scan"]["draw"] = draw
            numbers = self.chain(base)
            self.assertEqual(row.tolist(), [numbers[name] for name in self.OUTPUTS])

    def test_what_verdict_mode_has_is_the_same(self):
        names = [INVALID, "accuracy.relative.z.violation_count", "pass", "requirements.relative_elevation.value"]
        table = [[0.01, 1], [0.05, 2], [0.1, 3]]
        verdict = self.of([SIGMA, DRAW], names)(table)
        full = self.of([SIGMA, DRAW], [*names, LARGEST], folder="full")(table)
        self.assertTrue(model.VERDICT_NUMBERS.fullmatch(names[1]) and not model.VERDICT_NUMBERS.fullmatch(LARGEST))
        self.assertEqual(verdict.tolist(), full[:, :-1].tolist())
        self.assertGreater(np.ptp(full[:, 1]), 0)

    def test_it_is_a_function_of_the_values(self):
        """Alone or in a table, and in any order."""
        of, table = self.of([SIGMA], [LARGEST]), [[0.01], [0.03], [0.01]]
        found = of(table)
        self.assertEqual(found[0], found[2])
        self.assertEqual([of(row).tolist() for row in table], found.tolist())
        self.assertEqual(of(table[::-1]).tolist(), found[::-1].tolist())

    def test_an_input_of_several_keys(self):
        of = self.of({"pixels": ["scan.detector.rows", "scan.detector.columns"]}, [INVALID])
        base = copy.deepcopy(BASE)
        base["scan"]["detector"] |= {"rows": 5, "columns": 5}
        self.assertEqual(of([5]).tolist(), [self.chain(base)[INVALID]])

    def test_hazards(self):
        base = {**self.with_errors(), "hazard": {"region_radius_m": 2, "sites": {"divert_radius_m": 2}}}
        names = ["score.missed_hazard_frac", "site.x_m", "site.true_safe"]
        alone = self.of([SIGMA], names, base=base)([0.02])
        of = self.of([SIGMA, DRAW], names, base=base, folder="campaign")
        self.assertEqual(of([[0.02, 0], [0.02, 1]])[0].tolist(), alone.tolist())
        self.assertTrue(np.all(np.isfinite(alone)))


class Cache(ModelTest):
    TABLE = [[0.01 + 0.001 * i, i + 1] for i in range(5)] + [[0.02, 20], [0.02, 21]]

    def test_nothing_is_run_again(self):
        first = self.of([SIGMA, DRAW], [LARGEST])(self.TABLE)
        of = self.of([SIGMA, DRAW], [LARGEST])
        with mock.patch.object(of.runner, "run", side_effect=AssertionError):
            self.assertEqual(of(self.TABLE).tolist(), first.tolist())
            with self.assertRaises(AssertionError):
                of([[0.5, 1], [0.5, 2]])

    def test_what_was_cut_off_goes_on(self):
        """Parts that are done are kept: only the others are drawn again, and the answer is that of an undisturbed run."""
        with mock.patch.object(runs, "PART_DRAWS", 2):
            expected = self.of([SIGMA, DRAW], [LARGEST], folder="whole")(self.TABLE)
            of, calls = self.of([SIGMA, DRAW], [LARGEST]), []

            def run(tool, *arguments, **options):
                calls.append(tool)
                if calls.count("monte-carlo") == 3:
                    raise KeyboardInterrupt
                return runs.Runner.run(of.runner, tool, *arguments, **options)
            with mock.patch.object(of.runner, "run", side_effect=run), self.assertRaises(KeyboardInterrupt):
                of(self.TABLE)
            of, calls = self.of([SIGMA, DRAW], [LARGEST]), []
            with mock.patch.object(of.runner, "run", side_effect=run):
                self.assertEqual(of(self.TABLE).tolist(), expected.tolist())
        self.assertIn(calls.count("monte-carlo"), (1, 2))  # of four parts: the one that was cut off, and the next if it had not begun

    def test_what_a_killed_run_left_is_removed(self):
        """Not the files of a run that continues."""
        code = f"""import os, signal
from landfall import tools
from landfall.answers import runs
tools.BIN = {BIN!r}
runner = runs.Runner({self.path("cache")!r})
os.kill(os.getpid(), signal.SIGKILL)"""
        subprocess.run([PYTHON, "-c", code], env={**os.environ, "PYTHONPATH": os.path.join(ROOT, "python")}, check=False)
        [left] = self.scratch()
        first = runs.Runner(self.path("cache"))
        second = runs.Runner(self.path("cache"))
        self.assertEqual(self.scratch(), sorted(os.path.basename(runner.scratch) for runner in (first, second)))
        self.assertNotIn(left, self.scratch())
        del first, second
        self.assertEqual(self.scratch(), [])

    def scratch(self):
        return sorted(name for name in os.listdir(self.path("cache")) if name.startswith(".run-"))

    def test_workers_do_not_change_the_answer(self):
        with mock.patch.object(runs, "PART_DRAWS", 2):
            one = self.of([SIGMA, DRAW], [LARGEST], folder="one")(self.TABLE)
            two = self.of([SIGMA, DRAW], [LARGEST], folder="two", workers=2)(self.TABLE)
        self.assertEqual(one.tolist(), two.tolist())

    def test_a_changed_data_file_counts(self):
        base = copy.deepcopy(BASE)
        base["scan"]["trajectory"] = {"type": "table", "path": self.path("poses.csv")}

        def poses(height):
            with open(self.path("poses.csv"), "w", encoding="utf-8") as file:
                file.write("t_s,x_m,y_m,z_m,qw,qx,qy,qz\n" + "".join(f"{t},0,0,{height},1,0,0,0\n" for t in (-1, 0, 1, 2)))
        poses(50)
        first = self.of([SIGMA], [LARGEST], base=base)([0.02])
        poses(51.5)
        self.assertNotEqual(self.of([SIGMA], [LARGEST], base=base)([0.02]).tolist(), first.tolist())


class Failures(ModelTest):
    def test_a_terrain_that_names_its_raster(self):
        for name, words in [("g.h5", ["--set", "grid.half_width_m=30", "--set", "grid.resolution_m=1", "--set", "base.slope_x=0.1"]),
                            ("g.tif", ["--from", self.path("g.h5")])]:
            subprocess.run([os.path.join(BIN, "terrain-gen"), *words, "-o", self.path(name)], check=True)
        os.mkdir(self.path("sub"))
        named = {"from": "../g.tif", "center": [3, 2], "grid": {"half_width_m": 6}, "features": BASE["terrain"]["features"]}
        plain = {"base": {"type": "dem", "path": self.path("g.tif"), "center": [3, 2]}, "grid": {"half_width_m": 6, "resolution_m": 1},
                 "features": BASE["terrain"]["features"]}
        self.assertEqual(runs.read_base({"terrain": named}, self.path("sub"), "x")["terrain"], runs.resolved("terrain", plain))
        self.write(named, "sub/t")
        self.assertEqual(runs.read_base({"terrain": "sub/t.json"}, self.folder, "x")["terrain"], runs.resolved("terrain", plain))
        for wrong, words in [({"center": [1, 2]}, "x: /base/terrain/from: is needed by /center"), ({"from": 5}, "x: /base/terrain/from: 5 is not"),
                             ({"from": "g.tif", "center": 3}, "x: /base/terrain/center: 3 is not"), ({"from": "none.tif"}, "none.tif"),
                             ({"from": "g.tif", "base": {"type": "plane"}}, "terrain-gen: x: /base/terrain/base/type: ")]:
            with self.assertRaises(UsageError) as caught:
                runs.read_base({"terrain": wrong}, self.folder, "x")
            self.assertIn(words, str(caught.exception))

    def test_a_refused_row_is_nan_and_says_why(self):
        """In a run of draws and in a chain; the other rows have their values."""
        of = self.of([SIGMA, DRAW], [LARGEST])
        found = of([[0.01, 1], [-1, 2], [0.02, 3]])
        self.assertEqual(np.isnan(found[:, 0]).tolist(), [False, True, False])
        self.assertEqual(list(of.failures), [1])
        self.assertEqual(of.failures[1], "monte-carlo: configuration: draw 2: /scan: /noise/range_sigma_m: -1.0 is not in [0, 1e6]")
        self.assertEqual(found[2].tolist(), of([0.02, 3]).tolist())
        self.assertEqual(of.failures, {})
        of = self.of([HEIGHT], [LARGEST])
        self.assertTrue(np.isnan(of([-5])[0]))
        self.assertRegex(of.failures[0], "scan-sim: .*pulse 0: the lidar .* below the terrain")

    def test_no_number(self):
        of = self.of([SIGMA], [LARGEST])
        self.assertTrue(np.isnan(of([[np.nan], [0.01]])[0, 0]))
        self.assertEqual(of.failures, {0: "a value is not a finite number"})

    def test_a_killed_tool_is_not_a_result(self):
        """Nor is it kept."""
        of = self.of([SIGMA], [LARGEST], prefix=["sh", "-c", "kill -9 $$"])
        with self.assertRaisesRegex(DataError, "was killed"):
            of([0.01])
        self.assertTrue(np.isfinite(self.of([SIGMA], [LARGEST])([0.01])[0]))

    def test_a_failure_of_the_machine_is_tried_again(self):
        """Exit code 1 may come from a full disk."""
        of = self.of([HEIGHT], [LARGEST], prefix=["sh", "-c", 'case "$0" in *regrid) echo full >&2; exit 1;; *) exec "$0" "$@";; esac'])
        self.assertTrue(np.isnan(of([50])[0]))
        self.assertEqual(of.failures, {0: "full"})
        self.assertTrue(np.isfinite(self.of([HEIGHT], [LARGEST])([50])[0]))

    def test_what_is_refused_before_the_first_run(self):
        for inputs, message in ((["lidar.x"], "lidar.x: its first part is not one of terrain, scan, regrid, eval"), ([], "needs an input"),
                                (["scan.trajectory.position_m.3"], '"3" is not an index')):
            with self.assertRaisesRegex(UsageError, message):
                self.of(inputs, [LARGEST])
        with self.assertRaisesRegex(UsageError, "/base/lidar: unknown key"):
            self.of([SIGMA], [LARGEST], base={"lidar": {}})
        with self.assertRaisesRegex(UsageError, "2 values in a row; the inputs are 1"):
            self.of([SIGMA], [LARGEST])([[1, 2]])
        with self.assertRaisesRegex(UsageError, "accuracy.depth: is not a number of a DEM; they are accuracy"):
            self.of([SIGMA], ["accuracy.depth"])([0.01])


class Engines(ModelTest):
    def test_openturns(self):
        of = self.of([SIGMA, DRAW], [LARGEST, INVALID])
        function = model.openturns_function(of)
        table = [[0.01, 1], [0.03, 2]]
        self.assertEqual(np.array(function(table)).tolist(), of(table).tolist())
        self.assertEqual(list(function(table[1])), of(table[1]).tolist())
        self.assertEqual(list(function.getInputDescription()), [SIGMA, DRAW])
        self.assertEqual(list(function.getOutputDescription()), [LARGEST, INVALID])

    def test_optuna(self):
        """The coarsest bins whose footprints still pass: ask and tell with constraints, and a row that fails is pruned."""
        module = model.optuna()
        module.logging.set_verbosity(module.logging.WARNING)
        of = self.of([SIGMA], [INVALID, LARGEST])
        objective = model.optuna_objective(of, {SIGMA: (-0.01, 0.1)}, {LARGEST: 0.05})
        study = module.create_study()
        for sigma in (0.001, 0.09, -0.005):
            study.enqueue_trial({SIGMA: sigma})
        study.optimize(objective, n_trials=3)
        self.assertEqual([trial.state.name for trial in study.trials], ["COMPLETE", "COMPLETE", "PRUNED"])
        for trial, sigma in zip(study.trials, (0.001, 0.09)):
            invalid, largest = of([sigma])
            self.assertEqual(trial.value, invalid)
            np.testing.assert_allclose(trial.user_attrs["constraints"], [np.log(largest / 0.05)], rtol=1e-12)
        self.assertLess(study.trials[0].user_attrs["constraints"][0], 0)
        self.assertGreater(study.trials[1].user_attrs["constraints"][0], 0)
        with self.assertRaisesRegex(UsageError, "bounds need each input once"):
            model.optuna_objective(of, {}, {})
        with self.assertRaisesRegex(UsageError, "depth: is not an output"):
            model.optuna_objective(of, {SIGMA: (0, 1)}, {"depth": 1})

    def test_margins(self):
        self.assertEqual([model.margin(*pair) for pair in ((0.05, 0.05), (0.1, 0.05), (0, 1), (0, 0), (1, 0), (1e-9, 1))],
                         [0, np.log(2), -np.log(1000), -np.log(1000), np.log(1000), -np.log(1000)])

    def test_without_an_engine_a_message_names_its_package(self):
        for name, needs in (("openturns", model.openturns), ("optuna", model.optuna)):
            with mock.patch.dict(sys.modules, {name: None}), self.assertRaisesRegex(UsageError, f"^this needs .*apt-get install python3-{name}$"):
                needs()


class Terminal(io.StringIO):
    def isatty(self):
        return True


class ProgressTest(unittest.TestCase):
    def test_one_line_on_a_terminal(self):
        """Updated in place, with the time that is left by what was made now, and removed at the end."""
        stream = Terminal()
        with mock.patch("time.monotonic", side_effect=[0, 0, 30]):
            shown = runs.Progress(stream)
            shown.start("draws", 100)
            shown.step(0, 40)
            self.assertEqual(stream.getvalue(), "\r\033[K40 of 100 draws")
            shown.step(10)
        self.assertTrue(stream.getvalue().endswith("\r\033[K50 of 100 draws, about 150 s to go".replace("150 s", "2 min")), stream.getvalue())
        shown.clear()
        self.assertTrue(stream.getvalue().endswith("go\r\033[K"))
        self.assertNotIn("\n", stream.getvalue())

    def test_lines_elsewhere(self):
        stream = io.StringIO()
        shown = runs.Progress(stream)
        shown.start("draws", 2)
        shown.step(0, 1)
        shown.step(0, 1)
        shown.clear()
        self.assertEqual(stream.getvalue(), "1 of 2 draws\n2 of 2 draws\n")


STANDARD = """\
{:>40} variables
{:>40} sigma
{:>40} draw
                                       2 functions
                                       1 ASV_1:largest
                                       1 ASV_2:invalid
                                       2 derivative_variables
                                       1 DVV_1:sigma
                                       2 DVV_2:draw
                                       0 analysis_components
                                       1 eval_id
"""
APREPRO = """\
{{ DAKOTA_VARS = {} }}
{{ sigma = {} }}
{{ draw = {} }}
{{ DAKOTA_FNS = 2 }}
{{ ASV_1:largest = 1 }}
{{ ASV_2:invalid = 0 }}
{{ DAKOTA_DER_VARS = 0 }}
{{ DAKOTA_AN_COMPS = 0 }}
{{ DAKOTA_EVAL_ID = "1" }}
"""


class Dakota(ModelTest):
    def setUp(self):
        super().setUp()
        self.write({"base": BASE, "inputs": {"sigma": SIGMA, "draw": DRAW}, "outputs": [LARGEST, INVALID]}, "model")

    def run_model(self, text, code=0, message=""):
        with open(self.path("params.in"), "w", encoding="utf-8") as file:
            file.write(text)
        result = subprocess.run([PYTHON, os.path.join(ROOT, "python", "commands", "landfall-model"), "params.in", "results.out", "--bin", BIN],
                                cwd=self.folder, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertRegex(result.stderr, rf"\A{message}")
        return read(self.path("results.out")).decode() if os.path.exists(self.path("results.out")) else None

    def test_standard_and_aprepro(self):
        largest, invalid = self.of([SIGMA, DRAW], [LARGEST, INVALID])([0.02, 5])
        self.assertEqual(self.run_model(STANDARD.format(2, "2.0000000000000000e-02", 5)), f"{largest:.17g} largest\n{invalid:.17g} invalid\n")
        self.assertEqual(self.run_model(APREPRO.format(2, 0.02, 5)), f"{largest:.17g} largest\n")

    def test_a_row_that_fails(self):
        """Dakota sees the word fail, a person the reason."""
        self.assertEqual(self.run_model(STANDARD.format(2, -1, 5), message="landfall model: params.in: .*range_sigma_m"), "fail\n")

    def test_files_that_are_refused(self):
        good = STANDARD.format(2, 0.02, 5)
        for text, message in ((good.replace("2 functions", "1 functions").replace("1 ASV_2:invalid\n", ""), "asks for 1 functions, .* has 2 outputs"),
                              (good.replace("1 ASV_1", "3 ASV_1"), "asks for derivatives.*numerical_gradients"),
                              (good.replace("sigma", "sigmoid"), "has no variable sigma"),
                              (good.replace(" variables", " things"), "no line with the number of variables"),
                              (good.replace("0.02", "two"), 'sigma: "two" is not a number'),
                              (good.split("functions")[0] + "functions\n", "ends after 0 of 2 functions"),
                              ("nonsense\n", 'line 1: "nonsense" is neither')):
            self.assertIsNone(self.run_model(text, code=1, message=f"landfall model: params.in: .*{message}"))
        os.remove(self.path("params.in"))
        with self.assertRaisesRegex(DataError, "No such file"):
            dakota.read_parameters(self.path("params.in"))
        self.write({"base": BASE, "inputs": {"sigma": SIGMA}}, "model")
        self.run_model(good, code=2, message='landfall model: model.json: /: needs the key "outputs"')


if __name__ == "__main__":
    unittest.main()
