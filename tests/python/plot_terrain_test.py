#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of plot_terrain.py on small files that the tests make."""
import math
import os
import tempfile
import unittest

import h5py
import numpy as np

from harness.commands import run_command
from landfall import files
import matplotlib.pyplot as plt
from landfall.plot import plot_terrain

SUN = plot_terrain.LightSource(315, 35)


def make_terrain(path, nodes=61, slopes=(0.3, -0.2), objects=True):
    axis = (np.arange(nodes) - nodes // 2) * 0.5
    z = slopes[0] * axis[None, :] + slopes[1] * axis[:, None]
    with h5py.File(path, "w") as file:
        file.attrs["format_name"], file.attrs["format_version"] = "landfall.terrain", "1.0"
        file.attrs["complete"] = np.int32(1)
        file["x"], file["y"], file["z"] = axis, axis, z
        if objects:
            group = file.create_group("features")
            group["x"], group["y"], group["diameter"] = [1.0, 5, -3], [2.0, 0, 0], [0.5, 4, 2]
            kind = group.create_dataset("kind", data=np.array([3, 1, 3], np.int8))
            kind.attrs["flag_values"] = np.array([1, 3], np.int8)
            kind.attrs["flag_meanings"] = "crater rock"
    return z


class Arithmetic(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.path = os.path.join(self.folder, "t.h5")

    def relief(self):
        with h5py.File(self.path, "r") as file:
            return plot_terrain.read_relief(file["z"], files.read_grid(file), SUN)

    def test_a_plane_has_one_slope_and_one_shade(self):
        make_terrain(self.path)
        relief = self.relief()
        np.testing.assert_allclose(relief.slope_deg, math.degrees(math.atan(math.hypot(0.3, 0.2))), rtol=1e-12)
        normal = np.array([-0.3, 0.2, 1]) / math.sqrt(1 + 0.3**2 + 0.2**2)
        azimuth, elevation = math.radians(315), math.radians(35)
        sun = (math.sin(azimuth) * math.cos(elevation), math.cos(azimuth) * math.cos(elevation),
               math.sin(elevation))
        np.testing.assert_allclose(relief.shade, normal @ sun, rtol=1e-12)
        self.assertAlmostEqual(relief.high_m, 15 * 0.5)

    def test_slopes_that_face_away_from_the_sun_are_dark(self):
        self.assertEqual(plot_terrain.shade(np.array([0.0]), np.array([3.0]), plot_terrain.LightSource(0, 10))[0], 0)

    def test_bands_give_the_same_result_as_the_whole(self):
        make_terrain(self.path)
        with h5py.File(self.path, "a") as file:
            z = np.random.default_rng(4).normal(size=file["z"].shape)
            z[10:14, 3] = np.nan
            file["z"][...] = z
        whole = self.relief()
        original = plot_terrain.CELLS, plot_terrain.BAND_NODES
        self.addCleanup(lambda: vars(plot_terrain).update(CELLS=original[0], BAND_NODES=original[1]))
        plot_terrain.BAND_NODES = 5 * 61
        banded = self.relief()
        np.testing.assert_array_equal(banded.shade, whole.shade)
        np.testing.assert_array_equal(banded.slope_deg, whole.slope_deg)
        self.assertEqual(banded.steepest, whole.steepest)
        plot_terrain.CELLS = 20  # blocks of 4 cells
        slope = self.relief().slope_deg
        self.assertEqual(slope.shape, (15, 15))
        self.assertAlmostEqual(slope[8, 8], whole.slope_deg[32:36, 32:36].mean())

    def test_objects_are_sorted_by_kind_and_size(self):
        make_terrain(self.path)
        with h5py.File(self.path, "r") as file:
            objects = plot_terrain.read_objects(file)
        self.assertEqual(objects.count, 3)
        self.assertEqual(list(objects.by_kind["rock"][2]), [2, 0.5])
        self.assertEqual(list(objects.by_kind["crater"][0]), [5])


class Script(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        self.path = os.path.join(self.folder, "t.h5")

    def run_script(self, *arguments):
        return run_command("plot_terrain", *arguments)

    def test_draws_a_terrain_with_and_without_objects(self):
        for objects in (True, False):
            make_terrain(self.path, objects=objects)
            picture = os.path.join(self.folder, f"p{objects}.png")
            result = self.run_script(self.path, "-o", picture, "--dpi", "60")
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertEqual(result.stdout.strip(), picture)
            image = plt.imread(picture)[:, :, :3]
            colored = np.ptp(image[:, : image.shape[1] // 3], axis=2) > 0.2
            self.assertEqual(bool(colored.any()), objects)  # without objects the hillshade is grey

    def test_the_default_name_differs_from_that_of_landfall_export(self):
        make_terrain(self.path)
        self.assertEqual(self.run_script(self.path, "--dpi", "50").stdout.strip(), self.path.replace(".h5", "-figure.png"))

    def test_zooms_at_negative_coordinates(self):
        make_terrain(self.path)
        result = self.run_script(self.path, "--zoom-at", "-3,-4", "--dpi", "50")
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_wrong_files_and_options_are_refused(self):
        make_terrain(self.path)
        with h5py.File(self.path, "a") as file:
            del file["z"]
        result = self.run_script(self.path)
        self.assertEqual(result.returncode, 1)
        self.assertIn("needs the layers x, y and z", result.stderr)
        self.assertEqual(self.run_script(self.path, "--sun-elevation-deg", "95").returncode, 2)
        self.assertEqual(self.run_script(self.path, "--zoom-at", "3").returncode, 2)
        self.assertEqual(os.listdir(self.folder), ["t.h5"])


if __name__ == "__main__":
    unittest.main()
