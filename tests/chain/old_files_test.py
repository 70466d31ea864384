#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of version 0.1.0, whose texts have a variable length and which have no seal, stay readable."""
import json
import os
import unittest

import h5py
from harness import ToolTest, columns
import landfall
import numpy as np

FOLDER = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "files_of_0.1.0")
KINDS = {"terrain": "terrain", "mesh": "terrain", "scan": "scan", "plan": "plan", "dem": "dem", "eval": "evaluation"}


def old(name):
    return os.path.join(FOLDER, name + ".h5")


def texts_of(path):
    """The datasets that are texts, and all attributes that are."""
    found = {}
    with h5py.File(path) as file:
        def visit(name, item):
            if isinstance(item, h5py.Dataset) and h5py.check_string_dtype(item.dtype):
                found[name] = item.asstr()[()]
        file.visititems(visit)
        found.update({name: value for name, value in file.attrs.items() if isinstance(value, str)})
    return found


class OldFiles(ToolTest):
    def test_their_texts_have_a_variable_length(self):
        for name in KINDS:
            texts = texts_of(old(name))
            self.assertLessEqual({"title", "source", "format_name", "provenance/config_json"}, set(texts), name)
            with h5py.File(old(name)) as file:
                self.assertEqual(file["provenance/config_json"].dtype.kind, "O")

    def test_landfall_info_reads_all_texts(self):
        for name, kind in KINDS.items():
            found = json.loads(self.succeed("landfall-info", "--json", old(name)).stdout)
            texts = texts_of(old(name))
            self.assertEqual((found["kind"], found["source"], found["title"]), (kind, texts["source"], texts["title"]))
            self.assertEqual(found["file_id"], texts["file_id"])

    def test_every_tool_reads_them(self):
        out = self.path("out.h5")
        for terrain in ("terrain", "mesh"):
            self.succeed("scan-sim", "--terrain", old(terrain), "-o", out, "-O", "--set", "laser.scan_time_s=0.01",
                         "--set", "scanner.pattern.half_width_m=1")
        self.succeed("regrid", old("scan"), "--terrain", old("terrain"), "-o", out, "-O", "--set", "half_width_m=1", "--set", "resolution_m=0.25")
        new, stored = columns(out, "/"), columns(old("dem"), "/")
        for name in ("x", "y", "z_est", "count"):
            np.testing.assert_array_equal(new[name], stored[name], name)
        self.succeed("dem-eval", old("dem"), "-o", out, "-O", "--set", "region_radius_m=0.5")
        np.testing.assert_array_equal(columns(out, "/")["e_z"], columns(old("eval"), "/")["e_z"])
        for name in KINDS:
            self.succeed("landfall-export", old(name), "-o", self.path("out.png" if name == "mesh" else "out.csv"), "-O")

    def test_python_opens_them(self):
        for name in ("terrain", "plan", "dem", "eval"):
            with landfall.open(old(name)) as grid:
                self.assertEqual(grid.attrs["title"], texts_of(old(name))["title"])
        with landfall.open(old("scan")) as scan:
            self.assertGreater(len(scan), 600)


if __name__ == "__main__":
    unittest.main()
