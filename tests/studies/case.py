# SPDX-License-Identifier: GPL-3.0-or-later
"""Base class of the study tests: a study with 25,600 rays per scan, and functions that run it."""
import copy
import csv
import io
import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from unittest import mock

from harness.commands import run_command

ROOT = os.environ["LANDFALL_ROOT"]
BIN = os.path.abspath(os.environ["LANDFALL_BIN"])
PYTHON = "/usr/bin/python3"

from landfall.study import reader, stages

# 400 pulses of 8 x 8 pixels from 50 m on a 12 m square with a cone.
BASE = {
    "terrain": {"grid": {"half_width_m": 6, "resolution_m": 0.1},
                "features": [{"type": "cone", "x_m": 1.5, "y_m": 0.5, "radius_m": 1, "height_m": 1.5}]},
    "scan": {"detector": {"rows": 8, "columns": 8, "ifov_rad": 0.0011},
             "laser": {"pulse_rate_hz": 2000, "scan_time_s": 0.2},
             "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 4}},
             "trajectory": {"type": "constant_velocity", "position_m": [0, 0, 50], "velocity_mps": [0, 0, -5]}},
    "regrid": {"half_width_m": 5, "resolution_m": 0.1},
    "eval": {"region_radius_m": 3.5, "footprint_m": 0.8},
}
SIGMAS = {"key": "scan.noise.range_sigma_m", "values": [0.01, 0.02, 0.05]}
RESOLUTIONS = {"key": "regrid.resolution_m", "values": [0.1, 0.2]}
FEW_FIGURES = {"metrics": ["accuracy.relative.z.max_m"]}  # of five metrics they take longer than a small study
LIMITS = {"key": "eval.limits.relative_elevation_m", "values": [0.05, 0.1]}


def study(*axes, **keys):
    """The tree of a study file."""
    return {"base": copy.deepcopy(BASE), "axes": [copy.deepcopy(axis) for axis in axes], **keys}


def read(path):
    with open(path, "rb") as file:
        return file.read()


class StudyTest(unittest.TestCase):
    """A test with its own folder for studies and their results."""

    def stages_of(self, result):
        """The stages that make has run."""
        return sorted(re.findall(r"(?m)^\[\d+ done, .*\] (\w+) ", result.stdout))

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="landfall-study-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    @classmethod
    def made(cls, tree, *goals, code=0):
        """A study that make has run, in a folder that lasts as long as the tests; copy() copies it into a test's own folder."""
        test = cls("setUp")
        StudyTest.setUp(test)
        unittest.addModuleCleanup(test.doCleanups)
        test.write(tree)
        test.output = test.make(*goals, code=code)
        return test

    def copy(self, made):
        shutil.copytree(made.folder, self.folder, dirs_exist_ok=True)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, tree, name="tiny"):
        path = self.path(name + ".json")
        with open(path, "w", encoding="utf-8") as file:
            file.write(tree if isinstance(tree, str) else json.dumps(tree))
        return path

    def refused_bases(self):
        """Bases of tiny.json with a configuration that its tool refuses, each with the message: an object is named by its section, a file by its name."""
        wrong, tiny = {"noise": {"range_sigma_m": -1}}, self.path("tiny.json")
        lidar = self.write(wrong, "lidar")
        for changes, message in (({"scan": wrong}, f"scan-sim: {tiny}: /base/scan/noise/range_sigma_m: -1 is not in [0, 1e6]"),
                                 ({"scan": "lidar.json"}, f"scan-sim: {lidar}: /noise/range_sigma_m: -1 is not in [0, 1e6]"),
                                 ({"eval": {"regoin": 1}}, f"dem-eval: {tiny}: /base/eval/regoin: unknown key"),
                                 ({"terrain": {"from": 5}}, f"{tiny}: /base/terrain/from: 5 is not the name")):
            yield {**copy.deepcopy(BASE), **changes}, message

    def out(self, *names, study_name="tiny", runs="runs"):
        return self.path(runs, "studies", study_name, *names)

    def make_command(self, *arguments, study_name="tiny", runs="runs"):
        return ["make", "-C", ROOT, "-f", "Makefile.studies", f"STUDY={self.path(study_name + '.json')}", f"BIN={BIN}",
                f"RUNS={self.path(runs)}", *arguments]

    @staticmethod
    def environment():
        """The environment without the variables of an outer make."""
        return {key: value for key, value in os.environ.items() if not key.startswith(("MAKE", "MFLAGS"))}

    def make(self, *arguments, code=0, **names):
        result = subprocess.run(self.make_command(*arguments, **names), capture_output=True, text=True, timeout=600,
                                env=self.environment(), check=False)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def sweep(self, *arguments, code=0):
        result = run_command("sweep", *arguments, cwd=ROOT)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def plan(self, tree, *options, name="tiny"):
        """Plans a study and returns its folder."""
        self.plan_file(self.write(tree, name), *options, name=name)
        return self.out(study_name=name)

    def plan_file(self, path, *options, name):
        """Under the lock, as make has it: sweep.py would start again to take it."""
        with mock.patch.dict(os.environ, STUDY_LOCK=self.out(study_name=name)):
            return self.sweep("plan", path, "--out", self.out(study_name=name), "--bin", BIN, *options)

    def by_hand(self, path, number):
        """Runs a case with the commands that `show` prints, and returns the folder of its files."""
        folder = self.path(f"by-hand-{number}")
        os.mkdir(folder)
        subprocess.run(["bash", "-c", self.sweep("show", path, number).stdout], cwd=folder, check=True,
                       env={**os.environ, "PATH": BIN + ":" + os.environ["PATH"]})
        return folder

    def graph(self, tree):
        return stages.build(reader.read_study(self.write(tree)))

    KINDS = ("terrain", "truth", "scan", "regrid", "eval")

    def counts(self, tree):
        """How many stages of each of KINDS a study has."""
        graph = self.graph(tree)
        return [len(getattr(graph, kind)) for kind in self.KINDS]

    def files(self, *names, **where):
        """The names in a folder of the study."""
        return sorted(os.listdir(self.out(*names, **where)))

    def rows(self, **where):
        return list(csv.DictReader(io.StringIO(read(self.out("results.csv", **where)).decode())))

    def runs_of(self, tool_step, since=0):
        """How often study-chain ran a step, according to the logs that are newer than `since`."""
        count = 0
        for name in self.files("log"):
            path = self.out("log", name)
            if name.endswith(".log") and os.stat(path).st_mtime_ns > since:
                command = read(path).decode().split("\n", 1)[0]
                # Steps are given as STEP CONFIG ..., so the path of a configuration follows the name.
                count += command.count(f" {tool_step} {self.out('config')}")
        return count
