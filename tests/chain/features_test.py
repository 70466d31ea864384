#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every terrain feature against its formula in numpy: the example on its page (docs/user/terrain), and variants."""
import glob
import json
import os
import re
import unittest

import h5py
import numpy as np

from harness import ToolTest, attributes, columns, read_bytes

PAGES = os.path.join(os.environ["LANDFALL_ROOT"], "docs", "user", "terrain")
PENITENTE_STREAM = 20
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
    with open(page, encoding="utf-8") as file:
        return json.loads(re.search(r"```json\n(.*?)```", file.read(), re.DOTALL).group(1))


def smooth(inside, width):
    t = np.clip(inside / width, 0, 1) if width > 0 else 1.0
    return t * t * (3 - 2 * t)


def rock(f, u, v):
    a = f["diameter_m"] / 2
    q = 1 - (u / a) ** 2 - (v / (f["axis_ratio"] * a)) ** 2
    height = f.get("height_m", a)
    return np.where(q >= 0, height * np.sqrt(np.maximum(q, 0)), np.nan), (2 * a, height)


def crater(f, u, v):
    d = f["diameter_m"]
    x = 2 * np.hypot(u, v) / d
    fresh = [ratio for start, ratio in [(0, .10), (10, .11), (40, .13), (100, .15), (200, .17), (400, .21)] if d >= start][-1]
    depth = f.get("depth_m", fresh * d)
    rim = min(0.036822095, depth / d * 0.036 / 0.196)
    inner = np.maximum(rim / 0.036822095 * np.polyval([-0.039499407, 0.083116795, 0.227533882, -0.228809953], x), rim - depth / d)
    outer = rim / 0.036822095 * np.polyval([0.01505647, 0.01844746, -0.187050452, 0.188253307], x)
    z = np.select([x <= 0.98, x <= 1.02, x <= 1.5], [inner, rim, outer], np.nan)
    return f["freshness"] * d * z, (d, -f["freshness"] * depth)


def ice_block(f, u, v):
    """The top of a rectangle tilted about the middle of its bottom edge: the minimum of its upper half-planes."""
    t = np.radians(f["tilt_deg"])
    width, height = f["width_m"], f["height_m"]
    corners = np.array([(a * np.cos(t) - b * np.sin(t), a * np.sin(t) + b * np.cos(t))
                        for a in (-width / 2, width / 2) for b in (0, height)])
    top = (height + v * np.sin(t)) / np.cos(t)
    if t != 0:
        side = (width / 2 - np.sign(t) * v * np.cos(t)) / abs(np.sin(t))
        top = np.minimum(top, side)
    inside = (abs(u) <= f["length_m"] / 2) & (v >= corners[:, 0].min()) & (v <= corners[:, 0].max())
    span = np.ptp(corners[:, 0])
    return np.where(inside, top, np.nan), (max(f["length_m"], span), corners[:, 1].max(), span > f["length_m"])


def ridge(f, u, v):
    half = f["length_m"] / 2
    d = abs(abs(v) - f["spacing_m"] / 2)
    z = f["height_m"] * 2 ** -((2 * d / f["width_m"]) ** 2) * smooth(half - abs(u), f.get("taper_m", half / 5))
    return np.where((abs(u) <= half) & (d <= 3 * f["width_m"]), z, np.nan), (2 * half, f["height_m"])


def fracture(f, u, v):
    half, width, depth, throw = f["length_m"] / 2, f["width_m"], f["depth_m"], f["throw_m"]
    rise, fade = np.tan(np.radians(f["wall_slope_deg"])), f.get("fade_m", half)
    trough = -np.clip((width / 2 - abs(v)) * rise, 0, depth)
    cliff = np.sign(throw) * np.clip(v * rise, 0, abs(throw)) * smooth(fade - v, fade)
    z = (trough + cliff) * smooth(half - abs(u), f.get("taper_m", half / 5))
    return np.where(abs(u) <= half, z, 0), (2 * half, -min(depth, width / 2 * rise) if depth else throw)


def pit(f, u, v):
    inside = f["diameter_m"] / 2 - np.hypot(u, v)
    rise = np.tan(np.radians(f["wall_slope_deg"]))
    return -np.clip(inside * rise, 0, f["depth_m"]), (f["diameter_m"], -min(f["depth_m"], f["diameter_m"] / 2 * rise))


def lattice_value(seed, i, j):
    """Philox4x64-10 of the key (seed, stream) and the counter (i, j, 0, 0), as a uniform number in [-1, 1)."""
    counter = (i % 2 ** 64) + ((j % 2 ** 64) << 64)
    philox = np.random.Philox(counter=(counter - 1) % 2 ** 256, key=seed + (PENITENTE_STREAM << 64))
    return 2 * (int(philox.random_raw()) >> 11) * 2.0 ** -53 - 1


def noise(f, u, v):
    length = f.get("wobble_length_m", 2 * f["wavelength_m"])
    u, v = u / length, v / length
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    table = np.array([[lattice_value(f["seed"], a, b) for b in range(int(j.min()), int(j.max()) + 2)]
                      for a in range(int(i.min()), int(i.max()) + 2)])
    i0, j0 = i - i.min(), j - j.min()
    p, q = smooth(u - i, 1), smooth(v - j, 1)
    south = table[i0, j0] * (1 - p) + table[i0 + 1, j0] * p
    north = table[i0, j0 + 1] * (1 - p) + table[i0 + 1, j0 + 1] * p
    return south * (1 - q) + north * q


def penitente_field(f, u, v):
    if "diameter_m" in f:
        extents = (f["diameter_m"], f["diameter_m"])
        inside = [f["diameter_m"] / 2 - np.hypot(u, v)]
    else:
        extents = (f["length_m"], f["width_m"])
        inside = [extents[0] / 2 - abs(u), extents[1] / 2 - abs(v)]
    width = f.get("edge_m", min(f["wavelength_m"], min(extents) / 2))
    waves = (v + f["wobble_m"] * noise(f, u, v)) / f["wavelength_m"]
    z = f["amplitude_m"] * (1 - abs(2 * (waves - np.floor(waves)) - 1)) ** f["exponent"]
    for distance in inside:
        z = np.where(distance >= 0, z * smooth(distance, width), np.nan)
    return z, (max(extents), f["amplitude_m"], extents[1] > extents[0])


FORMULAS = {formula.__name__: formula for formula in (rock, crater, ice_block, ridge, fracture, pit, penitente_field)}
STANDING = ("rock", "ice_block")


class Features(ToolTest):
    def terrain(self, config, *options):
        self.succeed("terrain-gen", "-c", self.config(config), "-o", self.path("terrain.h5"), "-O", *options)
        return self.path("terrain.h5")

    def resolved(self, path):
        with h5py.File(path) as file:
            return json.loads(file["provenance/config_json"].asstr()[()])

    def check(self, config):
        path = self.terrain(config)
        grid, listed = columns(path, "/"), columns(path, "features")
        feature = self.resolved(path)["features"][0]
        yaw = np.radians(feature.get("yaw_deg", 0))
        x, y = np.meshgrid(grid["x"], grid["y"])
        dx, dy = x - feature["x_m"], y - feature["y_m"]
        relief, size = FORMULAS[feature["type"]](feature, np.cos(yaw) * dx + np.sin(yaw) * dy,
                                                 np.cos(yaw) * dy - np.sin(yaw) * dx)
        ground = SLOPE * x
        if feature["type"] in STANDING:
            expected = np.fmax(ground, SLOPE * feature["x_m"] + relief)
        else:
            expected = ground + np.nan_to_num(relief)
        self.assertGreater(np.count_nonzero(expected != ground), 300)
        self.assertLess(np.abs(grid["z"] - expected).max(), 1e-9)
        self.check_list(path, listed, feature, size, yaw)

    def check_list(self, path, listed, feature, size, yaw):
        across = np.pi / 2 if len(size) > 2 and size[2] else 0
        expected = {"x": feature["x_m"], "y": feature["y_m"], "diameter": size[0], "height": size[1], "yaw": yaw + across,
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
        self.assertEqual(pages, set(FORMULAS))
        schema = json.loads(self.succeed("terrain-gen", "--print-schema").stdout)
        types = {ref["$ref"].rsplit("/", 1)[1] for ref in schema["definitions"]["feature"]["oneOf"]}
        self.assertEqual(types, pages | {"cone", "hemisphere", "pyramid"})

    def test_examples_follow_the_formula(self):
        for name in FORMULAS:
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
