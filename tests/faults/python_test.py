#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged files in Python: landfall.open and every plot command refuse a file with one landfall.Error, or show what the intact file holds.

Files are tried in child processes, so that a signal ends a child alone. LANDFALL_TEST_LONG=1 tries 2,000 bits of files with their
seal and 500 of files without it (docs/quality/tests.md); LANDFALL_TEST_SEED chooses others.
"""
import collections
import contextlib
import glob
import hashlib
import json
import os
import random
import resource
import shutil
import signal
import sys
import traceback
import unittest

import h5py
import matplotlib
import numpy as np

from harness import EVAL, HAZARD, REGRID, ROOT, SCAN, TERRAIN, ChainTest, fork, read_bytes, write_file
from harness.commands import run_command
from hdf5_test import metadata_places, seal_begin

matplotlib.use("Agg")
import landfall
from landfall import errors, grids
from landfall.plot import (plot_compare, plot_dem, plot_draws, plot_eval, plot_hazards, plot_landing, plot_plan, plot_populations, plot_profile,
                           plot_terrain)
from landfall.study import plot_study, results
from landfall.table import Table
from matplotlib import pyplot

del grids  # imported here once, not in every child
IS_LONG = bool(os.environ.get("LANDFALL_TEST_LONG"))
SEALED, UNSEALED = (2000, 500) if IS_LONG else (36, 9)
SEED = int(os.environ.get("LANDFALL_TEST_SEED", "1"))
HOSTILE = os.path.join(ROOT, "..", "shared", "data", "hostile")
MEMORY_BYTES, LONGEST_S, TASKS_OF_A_CHILD = 6 << 30, 120, 20
GROUPS = {"terrain": ["features"], "populations": ["features"], "scan": ["pulses", "detector"], "evaluation": ["holes"], "hazards": ["sites"],
          "draws": ["draws"], "landings": ["draws"]}
ROCKS = {"grid": {"half_width_m": 6, "resolution_m": 0.2}, "seed": 3, "patterns": [
    {"type": "golombek_rocks", "k": 0.2, "min_diameter_m": 0.2, "max_diameter_m": 2, "clear_radius_m": 0, "region": {"type": "site"}}]}
LANDINGS = {"draws": 6, "metrics": "verdict", "scan": {**SCAN, "navigation_error": {}}, "regrid": REGRID, "eval": EVAL, "terrain": TERRAIN,
            "hazard": HAZARD, "landing": {}, "vary": {"scan.noise.range_bias_m": {"type": "normal", "mean": 0, "sigma": 0.01}}}
PLOTS = {"terrain": [plot_terrain], "mesh": [plot_terrain], "populations": [plot_populations], "dem": [plot_dem, plot_profile, plot_compare],
         "evaluation": [plot_eval], "hazards": [plot_hazards], "plan": [plot_plan], "draws": [plot_draws], "landings": [plot_landing],
         "results": [plot_study]}


def contents(opened):
    """All that landfall.open gives: attributes, names, types and values."""
    if isinstance(opened, Table):
        return [repr(opened), repr(sorted(map(repr, opened.attrs.items()))), repr(opened.attributes),
                *((name, opened[name].dtype, opened[name].tobytes()) for name in opened)]
    return [repr(opened.attrs), repr(opened.encoding.get("source")),
            *((name, repr(layer.attrs), layer.dims, layer.dtype, layer.values.tobytes()) for name, layer in opened.variables.items())]


def open_all(path, kind):
    """A hash of the contents of a file, or the error that refuses it."""
    found = []
    for group in (None, *GROUPS.get(kind, [])):
        with landfall.open(path, group) as opened:
            found += contents(opened)
    return hashlib.sha256(repr(found).encode()).hexdigest()


def draw(path, plot, folder):
    """A hash of the figures that a plot command writes."""
    for figure in glob.glob(os.path.join(folder, "*")):  # of a command that then failed
        os.remove(figure)
    name = os.path.join(folder, {plot_eval: "f-", plot_study: ""}.get(plot, "f.png"))
    more = {plot_profile: ["--from=-2,-1.5", "--to=2,1.5"], plot_compare: [path]}.get(plot, [])
    plot.main([path, *more, "-O", "--dpi", "50", "-o", name])
    return hashlib.sha256(b"".join(map(read_bytes, sorted(glob.glob(os.path.join(folder, "*")))))).hexdigest()


def outcome(task):
    """("right", hash), ("refused", message) or ("traceback", text) of a task."""
    try:
        return "right", task()
    except errors.Error as error:
        return "refused", str(error)
    except BaseException:  # pylint: disable=broad-exception-caught
        return "traceback", traceback.format_exc()


def in_child(*tasks):
    """The outcomes of tasks, in order, in a child process; of one that ends the child ("signal", number), without those after it."""
    reading, writing = os.pipe()
    child = fork()
    if not child:
        with contextlib.suppress(BaseException):
            os.close(reading)
            resource.setrlimit(resource.RLIMIT_CPU, (LONGEST_S * len(tasks),) * 2)
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, 1)
            os.dup2(null, 2)
            with os.fdopen(writing, "w", encoding="utf-8") as pipe:
                for task in tasks:
                    print(json.dumps(outcome(task)), file=pipe, flush=True)
                    pyplot.close("all")
            os._exit(0)
        os._exit(9)
    os.close(writing)
    with os.fdopen(reading, encoding="utf-8") as pipe:
        outcomes = [tuple(json.loads(line)) for line in pipe]
    _, status = os.waitpid(child, 0)
    end = os.waitstatus_to_exitcode(status)
    return outcomes + [("signal", end)] if end else outcomes


def outcomes_of(tasks):
    """The outcome of each task. Many share a child, in which Python copies whatever it touches; what ends a child leaves the rest to another one."""
    found = []
    while len(found) < len(tasks):
        found += in_child(*tasks[len(found):len(found) + TASKS_OF_A_CHILD])
    return found


def write_results(path):
    """The results.h5 of a study with a campaign's rates, a text axis and repeats."""
    axes = [{"name": name, "label": name, "unit": unit, "log": False, "numeric": name != "kind", "role": "repeat" if name == "repeat" else "axis"}
            for name, unit in (("sigma_m", "m"), ("kind", ""), ("repeat", "1"))]
    points = [(sigma, kind, repeat) for sigma in (0.01, 0.02, 0.04) for kind in ("FSM", "flash") for repeat in (1, 2)]
    rows = [(number, list(point), {"pass": int(point[0] < 0.03), "accuracy.relative.z.max_m": 2.5 * point[0] + point[2] / 1000, "coverage.invalid_frac": None,
                                   "requirements.relative_z.value": 2.5 * point[0], "requirements.relative_z.limit": 0.05,
                                   "requirements.relative_z.pass": int(point[0] < 0.03)}) for number, point in enumerate(points)]
    cases = {"title": "T", "plot": {}, "axes": axes, "cases": [], "limits": {"relative_elevation_m": 0.05}}
    results.write_h5(results.Table(cases, rows), path, "test")


class EachKind(ChainTest):
    """A file of each kind, the figures of which many commands draw."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        chain = cls.chain
        cls.files = {"terrain": chain.terrain, "scan": chain.scan, "dem": chain.dem, "evaluation": chain.eval, "hazards": chain.hazards,
                     "draws": chain.draws, "mesh": chain.path("mesh.h5"), "plan": chain.path("plan.h5"), "populations": chain.path("rocks.h5"),
                     "landings": chain.path("landings.h5"), "results": chain.path("results.h5")}
        write_file(chain.path("m.obj"), "v 0 0 0\nv 9 0 0\nv 0 9 1\nf 1 2 3\n")
        for name, config in (("rocks", ROCKS), ("landings", LANDINGS)):
            write_file(chain.path(name + ".json"), json.dumps(config))
        for name, *arguments in (["terrain-gen", "--from", chain.path("m.obj"), "-o", cls.files["mesh"]],
                                 ["terrain-gen", "-c", chain.path("rocks.json"), "-o", cls.files["populations"]],
                                 ["monte-carlo", "-c", chain.path("landings.json"), "-o", cls.files["landings"]],
                                 ["scan-sim", "--plan", "--plan-radius", "5", "-c", chain.config("scan-sim"), "-q", "-o", cls.files["plan"]]):
            landfall.tools.run_tool(landfall.tools.find(name), *arguments)
        write_results(cls.files["results"])

    def setUp(self):
        super().setUp()
        self.damaged, self.figures = self.path("damaged.h5"), self.path("figures")
        os.mkdir(self.figures)

    def reader(self, kind, content, plot=None):
        """A task: writes a file, and opens or draws it."""
        def task():
            self.write(self.damaged, content)
            return draw(self.damaged, plot, self.figures) if plot else open_all(self.damaged, kind)
        return task


class DamagedFiles(EachKind):
    def attack(self, count, is_sealed, with_plots=True):
        """Flips `count` bits, half of them in metadata. Returns what was tried, kind, plot (None: open) and outcome of each reading."""
        choose, tried, tasks = random.Random(f"{SEED} {is_sealed}"), [], []
        intact = {kind: read_bytes(path) for kind, path in self.files.items()}
        places = {kind: metadata_places(path) for kind, path in self.files.items()}
        for number in range(count):
            kind = list(self.files)[number % len(self.files)]
            content = bytearray(intact[kind][:None if is_sealed else seal_begin(intact[kind])])
            at = choose.choice(places[kind]) if choose.random() < 0.5 or not is_sealed else choose.randrange(len(content))
            bit = choose.randrange(8)
            content[at] ^= 1 << bit
            for plot in (None, *PLOTS.get(kind, []))[:None if with_plots else 1]:
                tried.append(({"kind": kind, "reader": plot and plot.__name__, "at": at, "bit": bit}, kind, plot))
                tasks.append(self.reader(kind, content, plot))
        outcomes = outcomes_of(tasks)
        print(f"{count} bits, {'sealed' if is_sealed else 'unsealed'}: {dict(collections.Counter(what for what, _ in outcomes))}", file=sys.stderr)
        return [(*one, found) for one, found in zip(tried, outcomes)]

    def test_a_bit_of_a_file_with_its_seal(self):
        """Refused, or the same contents and figures: a bit in a layer that a figure does not show changes nothing of it."""
        outcomes = self.attack(SEALED, True)
        accepted = list(dict.fromkeys((kind, plot) for _, kind, plot, found in outcomes if found[0] != "refused"))
        intact = dict(zip(accepted, outcomes_of([self.reader(kind, read_bytes(self.files[kind]), plot) for kind, plot in accepted])))
        refused = 0
        for tried, kind, plot, found in outcomes:
            refused += found[0] == "refused"
            with self.subTest(**tried):
                if found[0] == "refused":
                    self.assertRegex(found[1], r"\A[^\n]*damaged\.h5[^\n]*\Z")
                else:
                    self.assertEqual(found, intact[kind, plot])
        self.assertGreater(refused, SEALED)

    def test_a_bit_of_the_metadata_of_a_file_without_its_seal(self):
        """Other contents cannot be recognised there, but no bit ends Python."""
        for tried, _, _, found in self.attack(UNSEALED, False, with_plots=IS_LONG):
            with self.subTest(**tried):
                self.assertNotEqual(found[0], "signal", found[1])

    def test_a_bit_of_the_results_of_a_study(self):
        """Each is refused: its values have no checksums of their own."""
        choose, content, places, tasks = random.Random(SEED), read_bytes(self.files["results"]), [], []
        for _ in range(400 if IS_LONG else 20):
            at, damaged = choose.randrange(len(content)), bytearray(content)
            damaged[at] ^= 1 << choose.randrange(8)
            places.append(at)
            tasks.append(self.reader("results", damaged))
        (what, text), *outcomes = outcomes_of([self.reader("results", content), *tasks])
        self.assertEqual(what, "right", text)
        for at, (what, text) in zip(places, outcomes):
            with self.subTest(at=at):
                self.assertEqual(what, "refused", text)

    def test_the_outcomes_are_told_apart(self):
        """Checks the attack itself: a signal, a traceback, and other contents."""
        self.assertEqual(outcomes_of([lambda: 1, lambda: os.kill(os.getpid(), signal.SIGSEGV), lambda: 2]), [("right", 1), ("signal", -signal.SIGSEGV), ("right", 2)])
        self.assertEqual(in_child(lambda: {}["x"])[0][0], "traceback")
        self.write(self.damaged, read_bytes(self.files["dem"]))
        before = in_child(lambda: open_all(self.damaged, "dem"))[0]
        self.assertEqual(before[0], "right")
        with h5py.File(self.damaged, "a") as file:
            file["z_est"].attrs["units"] = "km"
        after = in_child(lambda: open_all(self.damaged, "dem"))[0]
        self.assertEqual(after[0], "right")
        self.assertNotEqual(after, before)


class OddFiles(ChainTest):
    """Valid HDF5 that no plot can show: one message each."""

    def expect(self, kind, source, change, words):
        result = run_command(f"plot_{kind}", self.changed(source, change, "odd.h5"), "-O", "-o", self.path("f.png"))
        self.assertEqual((result.returncode, result.stdout), (1, ""), result.stderr)
        self.assertRegex(result.stderr, r"\Alandfall plot \w+: [^\n]+\n\Z")
        self.assertIn(words, result.stderr)

    @staticmethod
    def replaced(name, **form):
        def change(file):
            del file[name]
            file.create_dataset(name, **form)
        return change

    def test_layers_that_are_not_real_numbers(self):
        for kind, source, name in (("dem", self.chain.dem, "z_est"), ("terrain", self.chain.terrain, "z"), ("dem", self.chain.dem, "x"),
                                   ("hazards", self.chain.hazards, "sites/x"), ("draws", self.chain.draws, "draws/pass")):
            with h5py.File(source) as file:
                shape = file[name].shape
            for form in ({"data": np.zeros(shape, complex)}, {"data": np.full(shape, b"text")}, {"data": "text"}):
                self.expect(kind, source, self.replaced(name, **form), "does not hold real numbers")

    def test_a_layer_that_claims_more_than_is_stored(self):
        huge = {"shape": (1 << 20, 1 << 20), "chunks": (256, 256), "dtype": "f8"}
        self.expect("dem", self.chain.dem, self.replaced("z_est", **huge), "/z_est declares more values")

    def test_columns_that_are_missing_or_scalar(self):
        name = "draws/requirements.coverage.value"
        self.expect("draws", self.chain.draws, lambda file: file.__delitem__(name), "/draws has no column requirements.coverage.value")
        self.expect("draws", self.chain.draws, self.replaced(name, data=1.5), "columns are not of equal length")
        self.expect("hazards", self.chain.hazards, self.replaced("sites/x", data=1.5), "columns are not of equal length")
        write_results(self.path("results.h5"))
        self.expect("study", self.path("results.h5"), self.replaced("accuracy.relative.z.max_m", data=1.5), "has shape ()")

    def test_a_layer_of_whole_numbers(self):
        whole = lambda file: self.replaced("z_est", data=np.ones(file["z_est"].shape, int))(file)
        path = self.changed(self.chain.dem, whole, "whole.h5")
        for command, *line in (["plot_dem"], ["plot_profile", "--from=-2,-1.5", "--to=2,1.5"]):
            result = run_command(command, path, "-O", "-o", self.path("f.png"), *line)
            self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_contents_that_do_not_fit_together(self):
        """Each part is read; only the figure shows that they contradict each other."""
        def change(file):
            for key in ("value", "limit", "pass", "at_least"):
                file[f"draws/own_requirements.a.{key}"] = np.ones(file["draws/pass"].shape)
        self.expect("draws", self.chain.draws, change, "odd.h5: cannot be drawn: ")

    def test_groups_in_place_of_layers(self):
        def change(file):
            del file["z_est"]
            file.create_group("z_est")
        self.expect("dem", self.chain.dem, change, "z_est does not hold real numbers")

    def test_names_are_printed_without_control_characters(self):
        result = run_command("plot_dem", "no\x1b[31m\u202e.h5")
        self.assertEqual((result.returncode, result.stderr), (1, "landfall plot dem: no\\u001b[31m\\u202e.h5: no such file\n"))
        path = shutil.copy(self.chain.dem, self.path("a\x1b[31m $x^$.h5"))
        self.assertEqual(run_command("plot_dem", path).stdout, self.path("a\\u001b[31m $x^$-figure.png") + "\n")


@unittest.skipUnless(os.path.isdir(HOSTILE), "needs the files of shared/data/hostile")
class HostileFiles(ChainTest):
    KINDS = {"dem": "dem", "hazards": "hazards", "uid": "hazards", "eval": "evaluation", "plan": "plan", "draws": "draws", "info": "hazards", "echo": "scan"}
    # The faults of these are in their values or texts, which the tools look at.
    RIGHT = {"dem-inf.h5", "dem-sigma-0.05.h5", "dem-sigma-10pct-nan.h5", "dem-sigma-negative.h5", "evil_dem.h5", "info-slow-bomb.h5"}

    def test_each_is_refused_or_read_by_open_and_the_commands_of_its_kind(self):
        figures = self.path("figures")
        os.mkdir(figures)
        tried, tasks = [], []
        for path in sorted(glob.glob(os.path.join(HOSTILE, "*.h5"))):
            name = os.path.basename(path)
            kind = next(kind for word, kind in self.KINDS.items() if word in name)
            for plot in (None, *PLOTS.get(kind, [])):
                tried.append((name, plot))
                tasks.append(lambda path=path, plot=plot: draw(path, plot, figures) if plot else open_all(path, None))
        for (name, plot), (what, text) in zip(tried, outcomes_of(tasks)):
            with self.subTest(name=name, plot=plot):
                self.assertEqual(what, "right" if name in self.RIGHT else "refused", text)


if __name__ == "__main__":
    unittest.main()
