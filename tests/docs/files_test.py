#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
# The tables of docs/user/files are compared with real files in both directions: every dataset in a file has a row, and
# every row a dataset.
"""Compares the pages of docs/user/files with real files: they describe every dataset and key with type and unit, and nothing else."""
import itertools
import json
import os
import re
import subprocess
import tempfile
import unittest

import h5py
import page as pages
from harness import BIN, attributes, read_bytes
from landfall import dictionary

SCAN = ["--set", "laser.scan_time_s=0.02", "--set", "noise.range_sigma_m=0.01",
        "--set", 'scanner.pattern={"type":"line_search","rows":20,"columns":20,"half_width_m":4}']
RECEIVER = ["--set", "receiver.type=peak", "--set", 'link={"reference_pe":1000,"reference_range_m":500}']
MAP = ["--set", "half_width_m=5", "--set", "resolution_m=0.1"]
DRAWS_CONFIG = ["--set", "draws=2", "--set", 'regrid={"half_width_m":5,"resolution_m":0.1}', "--set", "eval.region_radius_m=3",
            "--set", 'hazard={"region_radius_m":3}', "--set", 'vary={"scan.noise.range_sigma_m":{"type":"uniform","low":0,"high":0.02}}']
RASTER = os.path.abspath(os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "rasters", "polar_stereographic.tif"))
OWN = ["--set", 'requirements=[{"name":"NAME","metric":"statistics.z.le90_m","max":1}]']
# The commands that make the files, and the page of each; together they write every dataset.
RUNS = {
    "terrain.h5": ("terrain.md", ["terrain-gen", "--half-width", "6", "--resolution", "0.1", "--set",
                                  'features=[{"type":"cone","radius_m":1,"height_m":0.5}]', "--set", "albedo=0.5"]),
    "terrain.obj": (None, ["terrain-gen", "--half-width", "6", "--resolution", "0.5"]),
    "mesh.h5": ("terrain.md", ["terrain-gen", "--from", "terrain.obj"]),
    "scan.h5": ("scan.md", ["scan-sim", "--terrain", "terrain.h5", *SCAN]),
    "returns.h5": ("scan.md", ["scan-sim", "--terrain", "terrain.h5", *SCAN, *RECEIVER, "--set", "receiver.returns=all"]),
    "echoes.h5": ("scan.md", ["scan-sim", "--terrain", "terrain.h5", *SCAN, *RECEIVER, "--keep-echoes"]),
    "points.csv": (None, ["landfall-export", "scan.h5", "--columns", "x_est,y_est,z_est,t"]),
    "imported.h5": ("scan.md", ["landfall-import", "points.csv", "--columns", "x=x_est_m,y=y_est_m,z=z_est_m,t=t_s"]),
    "plan.h5": ("plan.md", ["scan-sim", "--plan", "--plan-radius", "5", *SCAN]),
    "dem.h5": ("dem.md", ["regrid", "scan.h5", "--terrain", "terrain.h5", "--uncertainty", "--corrected", *MAP]),
    "eval.h5": ("evaluation.md", ["dem-eval", "dem.h5", "--metrics", "metrics.json", "--set", "region_radius_m=3", *OWN]),
    "few.h5": ("evaluation.md", ["dem-eval", "dem.h5", "--metrics", "few.json", "--set", "region_radius_m=3", "--set", "footprint_m=0.3"]),
    "hazards.h5": ("hazards.md", ["hazard-map", "dem.h5", "--sites", "sites.json", "--score", "score.json", "--set", "region_radius_m=3"]),
    "moon.h5": ("terrain.md", ["terrain-gen", "--from", RASTER, "--half-width", "10", "--resolution", "0.5"]),
    "placed.h5": ("hazards.md", ["hazard-map", "moon.h5", "--set", "limits.slope_deg=80", "--set", "limits.roughness_m=50", "--set", "lander.leg_radius_m=1.5"]),
    "draws.h5": ("draws.md", ["monte-carlo", "scan.h5", "--terrain", "terrain.h5", *DRAWS_CONFIG, "--set", "sigma=true"]),
    "landed.h5": ("draws.md", ["monte-carlo", "scan.h5", "--terrain", "terrain.h5", *DRAWS_CONFIG, "--set", "landing={}"]),
    "pairs.h5": ("draws.md", ["monte-carlo", "--pair", "scan.h5:terrain.h5", "--pair", "scan.h5:terrain.h5", *DRAWS_CONFIG]),
    "unjudged.h5": ("evaluation.md", ["dem-eval", "blind.h5", "--metrics", "unjudged.json", "--set", "region_radius_m=3"]),
}
BEFORE = {"unjudged.h5": ["regrid", "scan.h5", "-o", "blind.h5", *MAP]}


def rows(name):
    """The cells of the table rows of a page, without the header rows."""
    text = pages.Page(os.path.normpath(os.path.join("docs", "user", "files", name))).prose.values()
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in text if line.startswith("| `")]


def described(name):
    """{dataset: (type, unit)} as described by a page, and for draws.h5 by that of its state."""
    found = {}
    for first, *others in rows(name) + (rows("../../reference/draws-state.md") if name == "draws.md" else []):
        for dataset in re.findall(r"`(/[^`]+)`", first):
            found[dataset] = tuple(others[:2])
    return found


def keys(name):
    """The keys of metrics.md, with their braces expanded."""
    found = set()
    for first, *_ in rows(name):
        for key in re.findall(r"`([\w.{},]+)`", first):
            parts = [part[1:-1].split(",") if part.startswith("{") else [part] for part in re.split(r"(\{[^}]*\})", key)]
            found |= {"".join(choice) for choice in itertools.product(*parts)}
    return found


def leaves(tree, path=""):
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from leaves(value, f"{path}{key}.")
        else:
            yield path + key


def entry_of(name, kind, units):
    """The entry of a dataset, or of the group of columns that a page describes together; the names of these tell their units."""
    if name.startswith("/draws/") and name not in ("/draws/seed", "/draws/draw", "/draws/pair", "/draws/pass"):
        first = name.removeprefix("/draws/").split(".")[0]
        if first in ("landing", "blind"):
            return {name: (kind, units if name.endswith(".safe") else "of its name")}
        group = {"scan": "KEY", "score": "score.KEY", "site": "site.KEY"}.get(first, "METRIC")
        return {f"/draws/{group}": (kind, "of its name")}
    return {name: (kind, units)}


def datasets(path):
    """{dataset: (type, unit)} of a file."""
    found = {}
    with h5py.File(path) as file:
        def visit(name, item):
            if isinstance(item, h5py.Dataset):
                kind = "text" if item.dtype.kind in "OS" else item.dtype.name
                found.update(entry_of("/" + name, kind, attributes(item)["units"]))
        file.visititems(visit)
    return found


class Files(unittest.TestCase):
    maxDiff = None
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="landfall-files-"))
        for name, (_, command) in RUNS.items():
            for tool, *arguments in filter(None, [BEFORE.get(name), [*command, "-o", name]]):
                subprocess.run([os.path.join(BIN, tool), *arguments], cwd=cls.folder, check=True, capture_output=True, timeout=120)

    def path(self, name):
        return os.path.join(self.folder, name)

    def test_every_dataset_of_a_file_is_described(self):
        for name, (page, _) in RUNS.items():
            if page:
                with self.subTest(name):
                    on_page = described("README.md") | described(page)
                    self.assertEqual({key: on_page.get(key) for key in datasets(self.path(name))}, datasets(self.path(name)))

    def test_every_described_dataset_is_in_a_file(self):
        for page in {page for page, _ in RUNS.values() if page}:
            with self.subTest(page):
                there = set().union(*(datasets(self.path(name)) for name, (of, _) in RUNS.items() if of == page))
                self.assertEqual(sorted(set(described(page)) - there), [])

    def test_every_layer_has_a_place_in_the_list(self):
        """Each layer of each file has its words in schemas/dictionary/layers.json."""
        words = {(layer["file"], layer["name"]): layer for layer in dictionary.table("layers")["layers"]}
        found = set()
        for name in RUNS:
            if name.endswith(".h5"):
                with h5py.File(self.path(name)) as file:
                    kind = attributes(file)["format_name"].removeprefix("landfall.")
                    layers = {key: attributes(item) for key, item in file.items() if isinstance(item, h5py.Dataset) and item.ndim == 2}
                for key, shown in layers.items():
                    self.assertEqual(shown["units"], words[kind, key]["unit"], (name, key))
                    if key != "fail":
                        self.assertEqual(shown.get("flag_meanings"), words[kind, key].get("flag_meanings"), (name, key))
                    found.add((kind, key))
        self.assertEqual(set(words) - found, set(), "words of layers that no file has")

    def test_root_attributes(self):
        text = "\n".join(pages.Page("docs/user/files/README.md").prose.values())
        for name, (page, _) in RUNS.items():
            if page:
                with h5py.File(self.path(name)) as file:
                    self.assertEqual([key for key in file.attrs if f"`{key}`" not in text], [])
                    self.assertIn(f"`{attributes(file)['format_name'].removeprefix('landfall')}`", text.replace("`landfall.", "`."))

    def test_attributes_of_points(self):
        text = "\n".join(pages.Page("docs/user/files/scan.md").prose.values())
        with h5py.File(self.path("returns.h5")) as file:
            self.assertEqual([key for key in file["points"].attrs if f"`{key}`" not in text], [])
            for value, meaning in enumerate(attributes(file["points/status"])["flag_meanings"].split()):
                self.assertIn(f"{value} {meaning.replace('_', ' ')}", text)

    def test_metrics(self):
        found = set()
        for name in ("metrics.json", "few.json"):  # of a footprint with few bins, which has reasons
            found |= set(leaves(json.loads(read_bytes(self.path(name)))))
        self.assertEqual(keys("metrics.md"), found)
        with open(self.path("unjudged.json"), encoding="utf-8") as file:
            self.assertLessEqual({key for key in leaves(json.load(file)) if "." in key} - {"accuracy.absolute", "accuracy.relative"},
                                 keys("metrics.md") | {"statistics.x", "statistics.y", "statistics.z", "statistics.horizontal"})


if __name__ == "__main__":
    unittest.main()
