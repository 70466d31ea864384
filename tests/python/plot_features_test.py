#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_features.py, which makes a terrain of each shape and draws all of them in one figure."""
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
from landfall.plot import plot_features


class Picture(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.png = os.path.join(folder.name, "features.png")

    def test_every_shape_is_drawn(self):
        result = run_command("plot_features", "-o", self.png, "--bin", BIN, "--dpi", 50)
        self.assertEqual((result.returncode, result.stderr, result.stdout), (0, "", self.png + "\n"))
        picture = matplotlib.image.imread(self.png)
        self.assertEqual(picture.shape[:2], (490, 750))
        # Each of the 2 x 5 panels has a red profile and shades of grey.
        for panel in [part for row in np.array_split(picture, 2) for part in np.array_split(row, 5, axis=1)]:
            self.assertGreater(np.count_nonzero(np.ptp(panel[..., :3], axis=2) > 0.2), 20)
            self.assertGreater(len(np.unique(panel[..., 0])), 20)

    def test_every_shape_of_the_schema_has_a_panel(self):
        schema = subprocess.run([os.path.join(BIN, "terrain-gen"), "--print-schema"], capture_output=True, text=True, check=True)
        definitions = json.loads(schema.stdout)["definitions"]
        types = {choice["$ref"].split("/")[-1] for choice in definitions["feature"]["oneOf"]}
        self.assertEqual(types, {panel.feature["type"] for panel in plot_features.PANELS})

    def test_the_cut_follows_its_direction(self):
        x = np.linspace(-2, 2, 41)
        panel = plot_features.Panel({}, 2, 30)
        s, height = plot_features.cut(panel, x, x, 3 * x[np.newaxis, :] + 5 * x[:, np.newaxis])
        np.testing.assert_allclose(height, s * (3 * np.cos(np.pi / 6) + 2.5), atol=1e-12)

    def test_an_existing_figure_is_kept(self):
        with open(self.png, "w", encoding="utf-8") as file:
            file.write("old")
        result = run_command("plot_features", "-o", self.png, "--bin", BIN)
        self.assertEqual(result.returncode, 2)
        self.assertIn("exists", result.stderr)

    def test_a_missing_tool_is_named(self):
        result = run_command("plot_features", "-o", self.png, "--bin", "/nowhere")
        self.assertEqual(result.returncode, 1)
        self.assertIn("/nowhere/terrain-gen", result.stderr)
        self.assertFalse(os.path.exists(self.png))


if __name__ == "__main__":
    unittest.main()
