#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_features.py, plot_patterns.py and plot_receiver.py, which run the tools for each kind and draw all kinds in one figure."""
import json
import os
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

from harness import BIN, write_file
from harness.commands import run_command
import matplotlib.image
import numpy as np
from landfall.plot import plot_features, plot_patterns, plot_receiver


def schema_of(tool):
    return json.loads(subprocess.run([os.path.join(BIN, tool), "--print-schema"], capture_output=True, text=True, check=True).stdout)


class Picture(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.png = os.path.join(folder, "figure.png")

    def expect_ten_panels(self, command, height):
        """Draws 2 x 5 panels with coloured curves, not only grey ones, and returns them."""
        result = run_command(command, "-o", self.png, "--bin", BIN, "--dpi", 50)
        self.assertEqual((result.returncode, result.stderr, result.stdout), (0, "", self.png + "\n"))
        picture = matplotlib.image.imread(self.png)
        self.assertEqual(picture.shape[:2], (height, 750))
        panels = [part for row in np.array_split(picture, 2) for part in np.array_split(row, 5, axis=1)]
        for panel in panels:
            self.assertGreater(np.count_nonzero(np.ptp(panel[..., :3], axis=2) > 0.2), 20)
        return panels

    def test_every_shape_is_drawn(self):
        for panel in self.expect_ten_panels("plot_features", 490):
            self.assertGreater(len(np.unique(panel[..., 0])), 20)  # shades of grey

    def test_every_pattern_is_drawn(self):
        self.expect_ten_panels("plot_patterns", 350)

    def test_the_animation_shows_every_pattern_and_scanner_at_work(self):
        path = self.png.replace(".png", ".svg")
        done = run_command("plot_patterns", "--animate", "-o", path, "--bin", BIN)
        self.assertEqual((done.returncode, done.stderr, done.stdout), (0, "", path + "\n"))
        self.assertLess(os.path.getsize(path), 300_000)
        name = "{http://www.w3.org/2000/svg}"
        groups = xml.etree.ElementTree.parse(path).getroot().findall(name + "g")
        panels = [*plot_patterns.PANELS, *plot_patterns.SCANNERS]
        self.assertEqual([group.find(name + "text").text for group in groups], [panel.keys["type"] for panel in panels])
        for panel, group in zip(panels, groups):
            moves = [dict(element.attrib) for element in group.iter() if element.tag in (name + "animate", name + "animateMotion")]
            self.assertEqual(len(moves), 0 if panel.pulses == 1 else 2, panel.keys)
            for move in moves:
                times = [float(time) for time in move["keyTimes"].split(";")]
                values = [float(value) for value in move.get("keyPoints", move.get("values")).split(";")]
                self.assertEqual((len(values), times[0], times[-1], times), (len(times), 0, 1, sorted(times)))
                self.assertEqual(sorted([values[0], values[-1]]), [0, 1])
        scanners = {choice["$ref"].split("/")[-1] for choice in schema_of("scan-sim")["properties"]["scanner"]["oneOf"]}
        self.assertLessEqual({panel.keys["type"] for panel in plot_patterns.SCANNERS}, scanners)

    def test_every_type_of_the_schemas_has_a_panel(self):
        shapes = {choice["$ref"].split("/")[-1] for choice in schema_of("terrain-gen")["definitions"]["feature"]["oneOf"]}
        self.assertEqual(shapes, {panel.feature["type"] for panel in plot_features.PANELS})
        scan = schema_of("scan-sim")
        names = [choice["$ref"].split("/")[-1] for choice in scan["definitions"]["pattern"]["oneOf"]]
        patterns = {scan["definitions"][name]["properties"]["type"]["const"] for name in names}
        self.assertEqual(patterns, {panel.keys["type"] for panel in plot_patterns.PANELS})
        receivers = set(scan["properties"]["receiver"]["properties"]["type"]["enum"])
        self.assertEqual(receivers - {"none"}, {kind for kind, *_ in plot_receiver.RECEIVERS})

    def test_the_cut_follows_its_direction(self):
        x = np.linspace(-2, 2, 41)
        panel = plot_features.Panel({}, 2, 30)
        s, height = plot_features.cut(panel, x, x, 3 * x[np.newaxis, :] + 5 * x[:, np.newaxis])
        np.testing.assert_allclose(height, s * (3 * np.cos(np.pi / 6) + 2.5), atol=1e-12)

    def test_a_missing_tool_is_named(self):
        for command in ("plot_features", "plot_patterns"):
            result = run_command(command, "-o", self.png, "--bin", "/nowhere")
            self.assertEqual(result.returncode, 1)
            self.assertIn("/nowhere/terrain-gen", result.stderr)
            self.assertFalse(os.path.exists(self.png))

    def test_an_existing_figure_is_kept(self):
        write_file(self.png, "old")
        for command in ("plot_features", "plot_patterns", "plot_receiver"):
            result = run_command(command, "-o", self.png, "--bin", BIN)
            self.assertEqual(result.returncode, 2)
            self.assertIn("exists", result.stderr)


if __name__ == "__main__":
    unittest.main()
