#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every terrain feature against its formula in tests/oracle/terrain.py: the example on its page (docs/user/terrain), and variants."""
import glob
import json
import os
import re
import unittest

import h5py
import numpy as np

from harness import ToolTest, attributes, columns, config_of, read_bytes
from oracle import terrain

PAGES = os.path.join(os.environ["LANDFALL_ROOT"], "docs", "user", "terrain")
SLOPE = 0.1

# Cases that the examples on the pages do not cover: other branches of the formulas, and defaults.
VARIANTS = [
    {"type": "rock", "diameter_m": 4, "height_m": 1, "axis_ratio": 0.5},
    {"type": "crater", "diameter_m": 12, "x_m": 4.03, "y_m": 0.02},
    {"type": "crater", "diameter_m": 12, "depth_m": 3.187, "freshness": 0.25, "x_m": -13.03, "y_m": 0.02},
    {"type": "ice_block", "length_m": 2, "width_m": 5, "height_m": 1, "yaw_deg": 50},
    {"type": "ice_block", "length_m": 2, "width_m": 5, "height_m": 1, "yaw_deg": 50, "tilt_deg": -40},
    {"type": "ridge", "length_m": 1000, "width_m": 3, "height_m": 1.5, "yaw_deg": 60, "x_m": 100, "y_m": 173},
    {"type": "fracture", "length_m": 20, "width_m": 3, "depth_m": 8, "wall_slope_deg": 60, "yaw_deg": 10},
    {"type": "fracture", "length_m": 20, "throw_m": -2, "yaw_deg": 10, "taper_m": 0},
    {"type": "pit", "diameter_m": 9.99, "depth_m": 2},
    {"type": "penitente_field", "diameter_m": 20, "amplitude_m": 3, "wavelength_m": 4, "yaw_deg": 90},
]


def example(page):
    return json.loads(re.search(r"```json\n(.*?)```", read_bytes(page).decode(), re.DOTALL).group(1))


def rise_of(f):
    return np.tan(np.radians(f["wall_slope_deg"]))


def ice_block(f):
    t, width = abs(np.radians(f["tilt_deg"])), f["width_m"]
    across = width * np.cos(t) + f["height_m"] * np.sin(t)
    return f["length_m"], across, width / 2 * np.sin(t) + f["height_m"] * np.cos(t)


def crater(f):
    fresh = next(ratio for below, ratio in terrain.CRATER_DEPTHS if f["diameter_m"] < below)
    return f["diameter_m"], 0, -f["freshness"] * f.get("depth_m", fresh * f["diameter_m"])


# Length along the yaw, length across it and height of a feature, as the list of features has them.
SIZES = {
    "rock": lambda f: (f["diameter_m"], 0, f.get("height_m", f["diameter_m"] / 2)),
    "crater": crater,
    "ice_block": ice_block,
    "ridge": lambda f: (f["length_m"], 0, f["height_m"]),
    "fracture": lambda f: (f["length_m"], 0, -min(f["depth_m"], f["width_m"] / 2 * rise_of(f)) if f["depth_m"] else f["throw_m"]),
    "pit": lambda f: (f["diameter_m"], 0, -min(f["depth_m"], f["diameter_m"] / 2 * rise_of(f))),
    "penitente_field": lambda f: (f.get("diameter_m", f.get("length_m")), f.get("width_m", 0), f["amplitude_m"]),
}


class Features(ToolTest):
    def terrain(self, config, *options):
        self.succeed("terrain-gen", "-c", self.config(config), "-o", self.path("terrain.h5"), "-O", *options)
        return self.path("terrain.h5")

    def check(self, config):
        path = self.terrain(config)
        grid, resolved = columns(path, "/"), config_of(path)
        with np.errstate(invalid="ignore"):
            expected = terrain.elevations(resolved)
        self.assertGreater(np.count_nonzero(expected != SLOPE * grid["x"] + np.zeros(expected.shape)), 300)
        self.assertLess(np.abs(grid["z"] - expected).max(), 1e-9)
        self.check_list(path, columns(path, "features"), resolved["features"][0])

    def check_list(self, path, listed, feature):
        along, across, height = SIZES[feature["type"]](feature)
        yaw = np.radians(feature.get("yaw_deg", 0)) + (np.pi / 2 if across > along else 0)
        expected = {"x": feature["x_m"], "y": feature["y_m"], "diameter": max(along, across), "height": height, "yaw": yaw,
                    "pattern": -1, "number": 0}
        for name, value in expected.items():
            self.assertEqual(len(listed[name]), 1)
            self.assertAlmostEqual(listed[name][0], value, delta=1e-12)
        with h5py.File(path) as file:
            kind = file["features/kind"]
            meanings = attributes(kind)["flag_meanings"].split()
            self.assertEqual(meanings[kind[0]], feature["type"])
            self.assertEqual(list(kind.attrs["flag_values"]), list(range(len(meanings))))
            for column in file["features"].values():
                self.assertIn("units", column.attrs)
                self.assertIn("long_name", column.attrs)

    def test_every_shape_of_the_schema_has_a_page_with_an_example(self):
        pages = {os.path.basename(page)[len("feature-"):-len(".md")] for page in glob.glob(os.path.join(PAGES, "feature-*.md"))}
        self.assertEqual(pages, set(SIZES))
        schema = json.loads(self.succeed("terrain-gen", "--print-schema").stdout)
        types = {ref["$ref"].rsplit("/", 1)[1] for ref in schema["definitions"]["feature"]["oneOf"]}
        self.assertEqual(types, pages | {"cone", "hemisphere", "pyramid"})

    def test_examples_follow_the_formula(self):
        for name in SIZES:
            with self.subTest(name):
                config = example(os.path.join(PAGES, f"feature-{name}.md"))
                self.assertEqual(config["features"][0]["type"], name)
                self.check(config)

    def test_variants_follow_the_formula(self):
        for feature in VARIANTS:
            with self.subTest(feature):
                self.check({"grid": {"half_width_m": 12, "resolution_m": 0.1}, "base": {"type": "plane", "slope_x": SLOPE},
                            "features": [feature]})

    def test_the_list_has_all_features_in_order(self):
        rocks = {"type": "ring", "count": 5, "radius_m": 6, "feature": {"type": "rock", "diameter_m": 1}}
        craters = {"type": "ring", "count": 4, "radius_m": 12, "feature": {"type": "crater", "diameter_m": 2}}
        config = {"grid": {"half_width_m": 10, "resolution_m": 0.1}, "base": {"type": "plane", "slope_x": SLOPE},
                  "features": [{"type": "cone", "radius_m": 1, "height_m": 2, "x_m": 3}, {"type": "pit", "diameter_m": 2, "depth_m": 1}],
                  "patterns": [rocks, craters]}
        result = self.succeed("terrain-gen", "-c", self.config(config), "-o", self.path("a.h5"), "--json", "-t", 1)
        listed = columns(self.path("a.h5"), "features")
        self.assertEqual(listed["pattern"].tolist(), [-1] * 2 + [0] * 5 + [1] * 4)
        self.assertEqual(listed["number"].tolist(), [0, 1, *range(5), *range(4)])
        angles = 2 * np.pi * np.arange(5) / 5
        np.testing.assert_allclose(listed["x"][2:7], 6 * np.cos(angles), atol=1e-12)
        np.testing.assert_allclose(listed["ground"][2:7], SLOPE * 6 * np.cos(angles), atol=1e-12)
        self.assertTrue(np.isnan(listed["ground"][7:]).all())  # outside the grid
        self.assertEqual(listed["ground"][1], -1)
        counts = json.loads(result.stdout)
        self.assertEqual(counts["feature_count"], 11)
        self.assertEqual(counts["feature_count_by_kind"], {"cone": 1, "pit": 1, "rock": 5, "crater": 4})
        self.succeed("terrain-gen", "-c", self.config(config), "-o", self.path("b.h5"), "-t", 2)
        self.assertEqual(read_bytes(self.path("a.h5")), read_bytes(self.path("b.h5")))

    def test_without_features_there_is_no_group(self):
        with h5py.File(self.terrain({"grid": {"half_width_m": 2, "resolution_m": 1}})) as file:
            self.assertNotIn("features", file)


if __name__ == "__main__":
    unittest.main()
