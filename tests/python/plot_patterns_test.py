#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_patterns.py, which runs the tools for each pattern and draws all of them in one figure."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

from harness.commands import run_command

ROOT = os.environ["LANDFALL_ROOT"]
BIN = os.environ["LANDFALL_BIN"]
sys.path.insert(0, os.path.join(ROOT, "python"))
sys.dont_write_bytecode = True
# pylint: disable=wrong-import-position
import matplotlib.image
import numpy as np
from landfall.plot import plot_patterns


class Picture(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.png = os.path.join(folder.name, "patterns.png")

    def test_every_pattern_is_drawn(self):
        result = run_command("plot_patterns", "-o", self.png, "--bin", BIN, "--dpi", 50)
        self.assertEqual((result.returncode, result.stderr, result.stdout), (0, "", self.png + "\n"))
        picture = matplotlib.image.imread(self.png)
        self.assertEqual(picture.shape[:2], (350, 750))
        # Each of the 2 x 5 panels has coloured curves, not only grey ones.
        for panel in [part for row in np.array_split(picture, 2) for part in np.array_split(row, 5, axis=1)]:
            self.assertGreater(np.count_nonzero(np.ptp(panel[..., :3], axis=2) > 0.2), 20)

    def test_every_type_of_the_schema_has_a_panel(self):
        schema = subprocess.run([os.path.join(BIN, "scan-sim"), "--print-schema"], capture_output=True, text=True, check=True)
        definitions = json.loads(schema.stdout)["definitions"]
        names = [choice["$ref"].split("/")[-1] for choice in definitions["pattern"]["oneOf"]]
        types = {definitions[name]["properties"]["type"]["const"] for name in names}
        self.assertEqual(types, {panel.keys["type"] for panel in plot_patterns.PANELS})

    def test_an_existing_figure_is_kept(self):
        with open(self.png, "w", encoding="utf-8") as file:
            file.write("old")
        result = run_command("plot_patterns", "-o", self.png, "--bin", BIN)
        self.assertEqual(result.returncode, 2)
        self.assertIn("exists", result.stderr)

    def test_a_missing_tool_is_named(self):
        result = run_command("plot_patterns", "-o", self.png, "--bin", "/nowhere")
        self.assertEqual(result.returncode, 1)
        self.assertIn("/nowhere/terrain-gen", result.stderr)
        self.assertFalse(os.path.exists(self.png))


if __name__ == "__main__":
    unittest.main()
