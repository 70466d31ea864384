#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_populations.py: its laws against known counts, its measured densities against a sample counted by hand,
and the populations of terrain-gen against its laws."""
import json
import os
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

from harness import BIN
from harness.commands import run_command
from landfall import files
from landfall.plot import plot_populations as populations
import matplotlib.image

COMMON = {"region": {"type": "site"}, "clear_radius_m": 0}
PATTERNS = [
    {"type": "golombek_rocks", "k": 0.1, "min_diameter_m": 0.3, "max_diameter_m": 3, "clear_radius_m": 10},
    {"type": "power_law_rocks", "model": "haworth", "min_diameter_m": 0.2,
     "region": {"type": "annulus", "inner_radius_m": 10, "outer_radius_m": 70}},
    {"type": "ice_blocks", "area_fraction": 0.02, "area_fraction_above_m": 0.3, "overlap": False},
    {"type": "craters", "model": "viper", "max_diameter_m": 40},
]


def per_hectare(pattern, *diameters):
    return 1e4 * populations.density(pattern, np.array(diameters, float))


def write_terrain(path, patterns, columns):
    """Writes the parts of a terrain file of 100 x 100 m that the script reads."""
    with h5py.File(path, "w") as file:
        file.attrs["format_name"], file.attrs["format_version"] = "landfall.terrain", "1.0"
        file.attrs["complete"] = np.int32(1)
        file["x"] = file["y"] = np.arange(-50, 51.0)
        file["provenance/config_json"] = json.dumps({"patterns": patterns})
        for name, values in columns.items():
            file[f"features/{name}"] = values


class Laws(unittest.TestCase):
    def test_counts_per_hectare(self):
        for k, small, large in ((0.02, 106, 0.02), (0.05, 804, 3.7), (0.1, 2108, 31), (0.2, 4590, 121)):
            counts = per_hectare({"type": "golombek_rocks", "k": k}, 0.3, 1)
            self.assertAlmostEqual(counts[0], small, delta=0.5)
            self.assertAlmostEqual(counts[1], large, delta=0.02 * large + 0.003)
        for model, count in (("viper", 60), ("low_blocky", 8), ("haworth", 492)):
            self.assertAlmostEqual(per_hectare({"type": "power_law_rocks", "model": model}, 0.3)[0], count, delta=0.5)
        for model, counts in (("trask", (794, 32, 8)), ("viper", (292, 13, 3.5))):
            np.testing.assert_allclose(per_hectare({"type": "craters", "model": model}, 1, 5, 10), counts, rtol=0.03)

    def test_k_of_an_area_fraction(self):
        k = populations.golombek_k({"area_fraction": 0.02, "area_fraction_above_m": 0.3})
        self.assertAlmostEqual(k * np.exp(-(1.79 + 0.152 / k) * 0.3), 0.02, places=14)

    def test_poisson_intervals_agree_with_published_tables(self):
        low, high = populations.poisson_interval([0, 1, 10, 100])
        np.testing.assert_allclose(low, [0, 0.0253, 4.795, 81.36], rtol=1e-3)
        np.testing.assert_allclose(high, [3.689, 5.572, 18.39, 121.63], rtol=1e-3)


class Samples(unittest.TestCase):
    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        self.terrain = os.path.join(folder, "terrain.h5")
        self.png = os.path.join(folder, "sizes.png")

    def samples(self):
        with files.open_landfall(self.terrain, "landfall.terrain") as file:
            return populations.read_samples(file)

    def test_counts_by_hand(self):
        pattern = {"type": "craters", "model": "trask", "min_diameter_m": 1, "max_diameter_m": 10, **COMMON}
        write_terrain(self.terrain, [{"type": "ring"}, pattern],
                      {"x": [0.0, 10, 51, 0], "y": [0.0, -50, 0, 0], "diameter": [4.0, 2, 8, 9],
                       "pattern": np.array([1, 1, 1, 0], np.int32)})  # one lies outside the site, one belongs to the ring
        (sample,) = self.samples()
        counts, densities = sample.measured([1, 2, 3, 4])
        self.assertEqual((sample.number, counts.tolist()), (1, [2, 1, 1, 0]))
        np.testing.assert_allclose(densities, [2e-4, 1e-4, 1e-4, 0])

    def test_the_area_is_where_objects_can_lie(self):
        annulus = {"type": "annulus", "x_m": 50, "y_m": 0, "inner_radius_m": 10, "outer_radius_m": 30}
        pattern = {"type": "power_law_rocks", "model": "viper", "min_diameter_m": 1, "max_diameter_m": 10, **COMMON}
        columns = {"x": [40.0], "y": [20.0], "diameter": [4.0], "pattern": np.array([0], np.int32)}
        write_terrain(self.terrain, [{**pattern, "region": annulus}], columns)
        self.assertAlmostEqual(self.samples()[0].areas_m2[0], 400 * np.pi, delta=2)  # half of the annulus is on the site
        write_terrain(self.terrain, [{**pattern, "clear_radius_m": 8}], columns)
        self.assertAlmostEqual(self.samples()[0].areas_m2[0], 1e4 - 100 * np.pi, delta=2)

    def test_terrain_gen_draws_by_these_laws(self):
        totals = np.zeros((len(PATTERNS), 2))
        for seed in range(1, 9):
            config = {"grid": {"half_width_m": 50, "resolution_m": 2}, "patterns": PATTERNS, "seed": seed}
            subprocess.run([os.path.join(BIN, "terrain-gen"), "-c", "-", "-O", "-o", self.terrain], check=True,
                           input=json.dumps(config), text=True)
            for row, sample in enumerate(self.samples()):
                self.assertEqual(sample.pattern["type"], PATTERNS[row]["type"])
                low = sample.pattern["min_diameter_m"]
                counts, densities = sample.measured([low])
                totals[row] += counts[0], counts[0] * sample.model([low])[0] / densities[0]
        for count, expected in totals:
            self.assertGreater(expected, 500)
            self.assertLess(abs(count - expected), 3.5 * np.sqrt(expected))

    def test_a_figure_of_each_pattern(self):
        config = {"grid": {"half_width_m": 50, "resolution_m": 2}, "patterns": PATTERNS}
        subprocess.run([os.path.join(BIN, "terrain-gen"), "-c", "-", "-o", self.terrain], check=True, input=json.dumps(config),
                       text=True)
        result = run_command("plot_populations", self.terrain, "-o", self.png, "--dpi", 50)
        self.assertEqual((result.returncode, result.stderr, result.stdout), (0, "", self.png + "\n"))
        picture = matplotlib.image.imread(self.png)
        self.assertEqual(picture.shape[:2], (300, 400))
        self.assertGreater(np.count_nonzero(np.ptp(picture[..., :3], axis=2) > 0.2), 200)
        self.assertEqual(run_command("plot_populations", self.terrain, "-o", self.png).returncode, 2)  # the figure exists

    def test_a_terrain_without_populations_is_refused(self):
        write_terrain(self.terrain, [], {"x": [0.0], "y": [0.0], "diameter": [4.0], "pattern": np.array([-1], np.int32)})
        result = run_command("plot_populations", self.terrain, "-o", self.png)
        self.assertEqual(result.returncode, 1)
        self.assertIn("no pattern that scatters objects", result.stderr)
        with h5py.File(self.terrain, "a") as file:
            del file["features"]
        self.assertIn("list of /features", run_command("plot_populations", self.terrain, "-o", self.png).stderr)
        self.assertFalse(os.path.exists(self.png))


if __name__ == "__main__":
    unittest.main()
