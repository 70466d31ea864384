# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that run the tools and read their files, and the small case that the tests share."""
import functools
import gc
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

BIN = os.environ["LANDFALL_BIN"]
ROOT = os.environ["LANDFALL_ROOT"]
sys.path.insert(0, os.path.join(ROOT, "python"))  # for tests that import landfall after this module
sys.dont_write_bytecode = True
SANITIZED = bool(os.environ.get("LANDFALL_SANITIZE"))  # sanitized builds take many times the time and memory
LONGEST_S = 1200 if SANITIZED else 120
with open(os.path.join(os.path.dirname(__file__), "../../schemas/dictionary/tools.json"), encoding="utf-8") as _file:
    PROGRAMS = {row["name"]: row for row in json.load(_file)["tools"] if " " not in row["name"]}
TOOLS = [name for name, row in PROGRAMS.items() if "schema" in row]  # those of a chain

# 400 pulses of 8 x 8 pixels from 50 m: 25,600 rays on a 12 m square of relief.
TERRAIN = {
    "grid": {"half_width_m": 6, "resolution_m": 0.1},
    "base": {"type": "plane", "elevation_m": 0.25, "slope_x": 0.05, "slope_y": -0.03},
    "features": [{"type": "cone", "x_m": 1.5, "y_m": 0.5, "radius_m": 1, "height_m": 1.5},
                 {"type": "hemisphere", "x_m": -2, "y_m": -1, "radius_m": 0.8},
                 {"type": "pyramid", "x_m": -1, "y_m": 2, "base_width_m": 1.2, "height_m": 0.7, "yaw_deg": 30}],
}
SCAN = {
    "detector": {"rows": 8, "columns": 8, "ifov_rad": 0.0011, "subpixels": 1, "roll_deg": 5},
    "laser": {"pulse_rate_hz": 2000, "scan_time_s": 0.2},
    "scanner": {"type": "fsm", "incidence_deg": 20, "fold_azimuth_deg": 10,
                "pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 4}},
    "mount": {"position_m": [0.3, -0.2, -0.5], "rpy_deg": [180, 0, 0]},
    "trajectory": {"type": "constant_velocity", "position_m": [0.5, -0.3, 50], "velocity_mps": [0.4, 0.2, -5],
                   "rpy_deg": [0.5, -0.4, 20], "rpy_rate_degps": [0.3, 0.2, -1]},
    "noise": {"range_sigma_m": 0.01, "range_bias_m": 0.002, "dead_pixel_frac": 0.03, "dropout_frac": 0.05},
    "navigation_error": {"position_m": [0.02, -0.03, 0.05], "velocity_mps": [0.1, 0.05, -0.1],
                         "rpy_rad": [1e-4, -2e-4, 3e-4], "rpy_rate_radps": [1e-3, 5e-4, -1e-3]},
    "seed": 7,
}
REGRID = {"resolution_m": 0.1, "half_width_m": 5}
EVAL = {"region_radius_m": 4, "footprint_m": 0.7, "quantile": 0.95,
        "limits": {"invalid_frac": 0.01, "hole_bins": 10, "distance_bins": 1, "relative_elevation_m": 0.05,
                   "relative_horizontal_m": 0.05, "absolute_horizontal_m": 1, "absolute_horizontal_frac": 0.95}}
HAZARD = {"lander": {"leg_radius_m": 0.4, "body_radius_m": 0.5}, "region_radius_m": 4, "limits": {"slope_deg": 14, "roughness_m": 0.08},
          "touchdown_sigma_m": 0.25, "sites": {"separation_m": 1, "divert_radius_m": 3}}
DRAWS = {"draws": 2, "scan": {"noise": {"dropout_frac": 0.05}}, "regrid": REGRID, "eval": EVAL,
         "vary": {"scan.noise.range_bias_m": {"type": "normal", "mean": 0, "sigma": 0.01}}}
CONFIGS = {"terrain-gen": TERRAIN, "scan-sim": SCAN, "regrid": REGRID, "dem-eval": EVAL, "hazard-map": HAZARD, "monte-carlo": DRAWS}

# These inputs need not exist, because a wrong option or configuration is refused before any input is opened.
INPUTS = {"terrain-gen": [], "scan-sim": ["--terrain", "/nowhere/terrain.h5"], "regrid": ["/nowhere/scan.h5"],
          "dem-eval": ["/nowhere/dem.h5"], "hazard-map": ["/nowhere/dem.h5"],
          "monte-carlo": ["/nowhere/scan.h5", "--terrain", "/nowhere/terrain.h5"]}


def scanner_types():
    """The types of scanners that scan.schema.json has."""
    with open(os.path.join(os.path.dirname(__file__), "../../schemas/scan.schema.json"), encoding="utf-8") as file:
        schema = json.load(file)
    names = [choice["$ref"].rpartition("/")[2] for choice in schema["properties"]["scanner"]["oneOf"]]
    return {schema["definitions"][name]["properties"]["type"]["const"] for name in names}


def tool(name):
    return os.path.join(BIN, name)


def fork():
    """os.fork. A collection of the garbage of many imported modules, in the child, would copy each page of them: a quarter of a second."""
    gc.freeze()
    child = os.fork()
    if child:
        gc.unfreeze()
    return child


def run(name, *arguments, stdin="", **options):
    """Runs a tool without a terminal; the result has returncode, stdout and stderr (text)."""
    return subprocess.run([tool(name), *map(str, arguments)], input=stdin, capture_output=True, text=True,
                          timeout=LONGEST_S, **options)


def without_warnings(name, stderr):
    return "".join(line for line in stderr.splitlines(keepends=True) if not line.startswith(f"{name}: warning: "))


def with_values(config, **values):
    """A copy of the configuration in which a__b=c sets the key b of the object a."""
    copy = json.loads(json.dumps(config))
    for path, value in values.items():
        *folders, key = path.split("__")
        target = copy
        for folder in folders:
            target = target[folder]
        target[key] = value
    return copy


def read_bytes(path):
    with open(path, "rb") as file:
        return file.read()


def write_file(path, content):
    """Writes a text or bytes, and returns the path."""
    with open(path, "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)
    return path


def columns(path, group="/"):
    """The datasets of a group (or of the root) as arrays."""
    with h5py.File(path) as file:
        return {name: item[()] for name, item in file[group].items() if isinstance(item, h5py.Dataset) and item.shape}


def bins_of_picture(pixels, shape):
    """The pixel of each bin, south to north, of a picture of a map (rows, columns): it begins below its outline, at column 120, and is enlarged to
    600 pixels (lib/formats/picture/map_picture.cpp)."""
    rows, cols = shape
    zoom = 600 // max(rows, cols)
    top = 1 + np.flatnonzero((pixels[:, 120:120 + zoom * cols] == 30).all(axis=(1, 2)))[0]
    return pixels[top:top + zoom * rows:zoom, 120:120 + zoom * cols:zoom][::-1]


def config_of(path):
    with h5py.File(path) as file:
        return json.loads(file["provenance/config_json"].asstr()[()])


def returns_of(path):
    points = columns(path, "points")
    keep = np.isin(points["status"], [0, 6])
    return {name: values[keep] for name, values in points.items()}


def attributes(item):
    """The attributes of an h5py object; texts of fixed length as str."""
    return {name: value.decode() if isinstance(value, bytes) else value for name, value in item.attrs.items()}


def set_text(file, name, text):
    """Replaces a text, whose length is fixed, by another one."""
    del file[name]
    file[name] = text


class ToolTest(unittest.TestCase):
    """A test with its own empty folder, and checks of exit codes, outputs and messages."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="landfall-")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def config(self, value, name="config.json"):
        """Writes a configuration, given as a text or as a value, and returns its path."""
        return write_file(self.path(name), value if isinstance(value, str) else json.dumps(value))

    def write(self, name, content):
        return write_file(self.path(name), content)

    def changed(self, source, change, name="changed.h5"):
        """A copy of an HDF5 file after change(h5py.File)."""
        path = shutil.copy(source, self.path(name))
        with h5py.File(path, "r+") as file:
            change(file)
        return path

    def entries(self):
        """All names in the folder, hidden ones included."""
        return sorted(os.listdir(self.folder))

    def succeed(self, name, *arguments, **options):
        """Runs a tool that must succeed and print nothing on stderr but warnings (tests/cli/messages_test.py)."""
        result = run(name, *arguments, **options)
        self.assertEqual((result.returncode, without_warnings(name, result.stderr)), (0, ""), f"{name} {arguments}")
        return result

    def refuse(self, code, name, *arguments, words=(), output=None, **options):
        """Runs a tool that must fail with `code` and, after warnings, one line that begins with the tool's name and contains `words`."""
        result = run(name, *arguments, **options)
        self.assertEqual(result.returncode, code, f"{name} {arguments}: {result.stderr}")
        self.assertEqual(result.stdout, "", f"{name} {arguments}")
        self.check_message(name, without_warnings(name, result.stderr), words)
        if output is not None:
            self.assertFalse(os.path.exists(output), f"{output} was left behind")
        self.assertEqual([entry for entry in self.entries() if entry.endswith(".part")], [])
        return result

    def check_message(self, name, message, words):
        self.assertRegex(message, rf"\A{name}: [^\n]+\n\Z")
        self.assertNotIn("internal error", message)
        for word in words:
            self.assertIn(word, message)


class Chain:
    """The files of the small case, made once per test module in a folder that remove() deletes; `source` and `draws` when they are first
    asked for, because most tests need neither."""

    def __init__(self, **scan_values):
        self.folder = tempfile.mkdtemp(prefix="landfall-chain-")
        self.terrain, self.scan, self.dem, self.eval, self.hazards, self.metrics = map(
            self.path, ["terrain.h5", "scan.h5", "dem.h5", "eval.h5", "hazards.h5", "metrics.json"])
        for name, config in CONFIGS.items():
            with open(self.config(name), "w", encoding="utf-8") as file:
                json.dump(with_values(config, **(scan_values if name == "scan-sim" else {})), file)
        for name in TOOLS[:5]:
            self.make(name, self.arguments(name))

    @staticmethod
    def make(name, arguments):
        result = run(name, *arguments)
        if (result.returncode, result.stdout, result.stderr) != (0, "", ""):
            raise AssertionError(f"{name}: exit {result.returncode}: {result.stdout}{result.stderr}")

    @functools.cached_property
    def source(self):
        """The scan with the true range of every pixel, which draws need."""
        path = self.path("source.h5")
        self.make("scan-sim", [*self.inputs("scan-sim"), "--set", "noise.dropout_frac=0", "--set", "noise.dead_pixel_frac=0", "-o", path])
        return path

    @functools.cached_property
    def draws(self):
        path = self.path("draws.h5")
        self.make("monte-carlo", [*self.inputs("monte-carlo"), "-o", path])
        return path

    def path(self, name):
        return os.path.join(self.folder, name)

    def config(self, name):
        return self.path(name + ".json")

    def output(self, name):
        return getattr(self, dict(zip(TOOLS, ["terrain", "scan", "dem", "eval", "hazards", "draws"]))[name])

    def inputs(self, name):
        """Arguments of a tool, except its output."""
        source = [self.source] if name == "monte-carlo" else []
        return {"terrain-gen": [], "scan-sim": ["--terrain", self.terrain],
                "regrid": [self.scan, "--terrain", self.terrain],
                "dem-eval": [self.dem], "hazard-map": [self.dem],
                "monte-carlo": [*source, "--terrain", self.terrain]}[name] + ["-c", self.config(name)]

    def arguments(self, name):
        extra = ["--metrics", self.metrics] if name == "dem-eval" else []
        return self.inputs(name) + ["-o", self.output(name)] + extra

    def remove(self):
        shutil.rmtree(self.folder)


class ChainTest(ToolTest):
    """Tests that share one Chain; nothing may write into its folder."""
    CHANGES = {}  # of the Chain

    @classmethod
    def setUpClass(cls):
        cls.chain = Chain(**cls.CHANGES)
        cls.addClassCleanup(cls.chain.remove)


def as_of_0_2_0(file):
    """A draws.h5 as version 0.2.0 wrote it: draw i has the seed of the run plus i, and there are no numbers of draws."""
    file.attrs["format_version"] = "1.0"
    file["draws/seed"][...] += np.arange(len(file["draws/seed"])) + file["draws"].attrs["first_draw"]
    del file["draws/draw"]


class MonteCarloTest(ChainTest):
    """Tests of draws over the Chain's scan, which has a row for every pixel that hit."""
    CHANGES = {"noise__dropout_frac": 0, "noise__dead_pixel_frac": 0}
