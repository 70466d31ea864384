#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The albedo of a terrain: its layer against closed forms and GDAL's values, in all formats, and in a scan's intensity."""
import json
import os
import subprocess
import unittest

import h5py
import numpy as np

from harness import SCAN, ToolTest, read_bytes, returns_of, run, with_values

GRID = ["--half-width", "10", "--resolution", "0.5"]
ICE_AND_DUST = {"ground": {"type": "patches", "albedo": 0.9, "albedo_between": 0.2, "cover_frac": 0.4, "longest_wavelength_m": 4}}
ROCK = 'features=[{"type":"rock","diameter_m":4,"axis_ratio":1,"x_m":2,"y_m":-1}]'
# Ranges and intensities without noise: each pixel is one ray.
EXACT = {"detector": {"rows": 8, "columns": 8, "ifov_rad": 0.0011, "subpixels": 1},
         "noise": {"range_sigma_m": 0, "range_bias_m": 0, "dead_pixel_frac": 0, "dropout_frac": 0},
         "link": {"reference_pe": 1e6, "reference_range_m": 50},
         "receiver": {"type": "peak", "photon_noise": False}}


class AlbedoTest(ToolTest):
    def terrain(self, albedo, *options, name="terrain.h5"):
        """Makes a terrain and returns its x, y, z and albedo."""
        path = self.path(name)
        self.succeed("terrain-gen", "-O", "-o", path, *GRID, "--set", "albedo=" + json.dumps(albedo), *options)
        with h5py.File(path) as file:
            return [file[layer][()] for layer in ("x", "y", "z", "albedo")]


class Layer(AlbedoTest):
    def test_a_terrain_without_the_key_has_no_layer(self):
        self.succeed("terrain-gen", "-o", self.path("terrain.h5"), *GRID)
        with h5py.File(self.path("terrain.h5")) as file:
            self.assertNotIn("albedo", file)

    def test_it_is_a_layer_like_others(self):
        self.terrain(0.3)
        with h5py.File(self.path("terrain.h5")) as file:
            layer = file["albedo"]
            self.assertEqual((layer.dtype, layer.shape), (np.float32, (41, 41)))
            self.assertEqual(list(layer.attrs["actual_range"]), [np.float32(0.3)] * 2)
            self.assertTrue(np.all(layer[()] == np.float32(0.3)))
        info = json.loads(self.succeed("landfall-info", "--json", self.path("terrain.h5")).stdout)
        self.assertIn("albedo", json.dumps(info))
        self.succeed("landfall-export", self.path("terrain.h5"), "-o", self.path("albedo.tif"), "--layers", "albedo")
        value = subprocess.run(["gdallocationinfo", "-valonly", "-geoloc", self.path("albedo.tif"), "3", "4"],
                               capture_output=True, text=True, check=True).stdout
        self.assertAlmostEqual(float(value), 0.3, 6)

    def test_the_relief_is_that_without_albedo(self):
        fractal = ["--set", 'base={"type":"fractal"}', "--set", ROCK]
        self.succeed("terrain-gen", "-o", self.path("plain.h5"), *GRID, *fractal)
        z = self.terrain(ICE_AND_DUST, *fractal)[2]
        with h5py.File(self.path("plain.h5")) as file:
            self.assertTrue(np.array_equal(file["z"][()], z))

    def test_threads_and_runs_give_the_same_bytes(self):
        files = []
        for threads in ("1", "2"):
            self.terrain(ICE_AND_DUST, "-t", threads)
            files.append(read_bytes(self.path("terrain.h5")))
        self.assertEqual(files[0], files[1])

    def test_a_gradient_and_a_rock(self):
        """The rock's footprint is a disc of 2 m radius, its border excluded: there it is not above the ground."""
        x, y, z, albedo = self.terrain({"ground": {"type": "gradient", "from": 0.1, "to": 0.7, "azimuth_deg": 30, "length_m": 12},
                                        "features": {"rock": 0.05, "cone": 0.9}}, "--set", ROCK)
        x, y = np.meshgrid(x, y)
        along = x * np.cos(np.pi / 6) + y * np.sin(np.pi / 6)
        expected = 0.1 + 0.6 * np.clip(0.5 + along / 12, 0, 1)
        expected[np.hypot(x - 2, y + 1) < 2 - 1e-9] = 0.05
        np.testing.assert_allclose(albedo, expected, atol=1e-6)
        self.assertTrue(np.array_equal(z > 0, albedo == np.float32(0.05)))

    def test_other_formats_warn(self):
        for name in ("terrain.tif", "terrain.ply"):
            result = run("terrain-gen", "-o", self.path(name), *GRID, "--set", "albedo=0.3")
            self.assertEqual((result.returncode, result.stderr),
                             (0, "terrain-gen: warning: /albedo has no effect: only a .h5 or .nc terrain has that layer\n"))


class Raster(AlbedoTest):
    def raster(self, hole=False):
        """Two bands of 60 x 60 pixels of 1 m in a projected CRS; the second holds a reflectance in percent."""
        path, text = self.path("map.tif"), self.path("map.asc")
        row, col = np.mgrid[0:60, 0:60]
        bands = [0.1 * col, np.round(50 + 30 * np.sin(0.3 * col) * np.cos(0.2 * row), 3)]
        if hole:
            bands[1][28, 33] = -1
        names = []
        for i, band in enumerate(bands):
            names.append(f"{text}{i}")
            with open(names[-1], "w", encoding="ascii") as file:
                file.write("ncols 60\nnrows 60\nxllcorner 500000\nyllcorner 4000000\ncellsize 1\nNODATA_value -1\n")
                np.savetxt(file, band, "%.3f")
        subprocess.run(["gdalbuildvrt", "-q", "-separate", self.path("map.vrt"), *names], check=True)
        subprocess.run(["gdal_translate", "-q", "-a_srs", "EPSG:32631", self.path("map.vrt"), path], check=True)
        return path

    def ground(self, **more):
        return {"ground": {"type": "raster", "path": self.path("map.tif"), "band": 2, "scale": 0.01, **more}}

    def test_nearest_nodes_have_the_values_that_gdal_reads(self):
        path = self.raster()
        x, y, _, albedo = self.terrain(self.ground(interpolation="nearest", offset=0.05, center=[500030.1, 4000030.1]))
        # Not on the edge of a pixel, where two are equally near.
        cells = [(r, c) for r in range(0, 41, 5) for c in range(0, 41, 4)]
        places = "".join(f"{500030.1 + x[c]} {4000030.1 + y[r]}\n" for r, c in cells)
        text = subprocess.run(["gdallocationinfo", "-valonly", "-geoloc", "-b", "2", path], input=places,
                              capture_output=True, text=True, check=True).stdout
        np.testing.assert_allclose([albedo[cell] for cell in cells], 0.05 + 0.01 * np.array(text.split(), float), atol=1e-6)

    def test_pixel_centres_have_the_pixels_values(self):
        path = self.raster()
        x, y, _, albedo = self.terrain(self.ground(center=[500030.5, 4000030.5]))
        band = np.array(subprocess.run(["gdal_translate", "-q", "-b", "2", "-of", "XYZ", path, "/vsistdout/"], capture_output=True,
                                       text=True, check=True).stdout.split(), float).reshape(60, 60, 3)[:, :, 2]
        # Node (0, 0) m is pixel (29, 30), and every second node is a pixel's centre.
        np.testing.assert_allclose(albedo[::2, ::2], 0.01 * band[19:40, 20:41][::-1], atol=1e-6)
        self.assertEqual((x[0], y[0]), (-10, -10))
        np.testing.assert_allclose(albedo[1, ::2], (albedo[0, ::2] + albedo[2, ::2]) / 2, atol=1e-6)

    def test_elevations_and_albedo_of_one_file(self):
        """Holes of the elevations are holes of the albedo."""
        path = self.raster(hole=True)
        base = {"type": "dem", "path": path, "band": 2, "datum": "none", "interpolation": "nearest"}
        _, _, z, albedo = self.terrain(self.ground(interpolation="nearest"), "--set", "base=" + json.dumps(base))
        self.assertTrue(np.isnan(z).any())
        np.testing.assert_allclose(albedo, 0.01 * z, atol=1e-6)
        with h5py.File(self.path("terrain.h5")) as file:
            inputs = json.loads(file["provenance/inputs_json"][()])
        self.assertEqual([entry["role"] for entry in inputs], ["raster", "raster"])

    def test_a_crop_keeps_the_albedo(self):
        whole = self.terrain(ICE_AND_DUST, "--set", ROCK, name="whole.h5")
        layer = f'NETCDF:"{self.path("whole.h5")}":'
        ground = {"type": "raster", "path": layer + "albedo", "center": [2, -1], "interpolation": "nearest"}
        self.succeed("terrain-gen", "--from", layer + "z", "-o", self.path("crop.h5"), "--half-width", "3", "--center", "2,-1",
                     "--datum", "none", "--interpolation", "nearest", "--set", "albedo=" + json.dumps({"ground": ground}))
        with h5py.File(self.path("crop.h5")) as file:
            for name, values in (("z", whole[2]), ("albedo", whole[3])):
                self.assertTrue(np.array_equal(file[name][()], values[12:25, 18:31]), name)

    def test_what_is_refused(self):
        self.raster(hole=True)
        output = self.path("out.h5")

        def refuse(code, albedo, *words):
            self.refuse(code, "terrain-gen", "-o", output, *GRID, "--set", "albedo=" + json.dumps(albedo), words=words, output=output)

        refuse(1, self.ground(), "map.tif: the albedo at (", ") m is missing; give another center")
        refuse(1, self.ground(band=1, scale=1, center=[500030, 4000030]), "map.tif: the albedo at (", ", not in [0, 1]; give /albedo/ground/scale")
        refuse(1, self.ground(center=[500005, 4000030]), "map.tif", "half_width_m")
        refuse(2, self.ground(band=3), "map.tif", "band")
        before = read_bytes(self.path("map.tif"))
        self.refuse(2, "terrain-gen", "-O", "-o", self.path("map.tif"), *GRID, "--set", "albedo=" + json.dumps(self.ground()),
                    words=["map.tif"])
        self.assertEqual(read_bytes(self.path("map.tif")), before)

    def test_a_mesh_has_none(self):
        self.succeed("terrain-gen", "-o", self.path("mesh.obj"), *GRID)
        self.refuse(2, "terrain-gen", "--from", self.path("mesh.obj"), "-o", self.path("mesh.h5"), "--set", "albedo=0.3",
                    words=["/albedo: is mutually exclusive with /mesh"], output=self.path("mesh.h5"))


class Scan(AlbedoTest):
    def intensity(self, albedo, name):
        config = self.config({**with_values(SCAN, navigation_error={}), **EXACT, "surface": {"albedo": albedo}}, name + ".json")
        self.succeed("scan-sim", "-c", config, "--terrain", self.path("terrain.h5"), "-o", self.path(name + ".h5"))
        return returns_of(self.path(name + ".h5"))

    def test_intensity_is_proportional_to_the_albedo_of_the_nearest_node(self):
        x, y, _, albedo = self.terrain(ICE_AND_DUST, "--set", ROCK)
        white, real = self.intensity(1, "white"), self.intensity("terrain", "real")
        self.assertTrue(np.array_equal(white["x_true"], real["x_true"]))
        col = np.floor(real["x_true"] / 0.5 + 0.5).astype(int) + 20
        row = np.floor(real["y_true"] / 0.5 + 0.5).astype(int) + 20
        near = albedo[row, col]
        self.assertEqual(set(near), {np.float32(0.2), np.float32(0.9)})
        np.testing.assert_allclose(real["intensity"] / white["intensity"], near, rtol=1e-6)
        self.assertEqual((x[0], y[0]), (-10, -10))

    def test_a_large_terrain_is_loaded_in_part(self):
        """The nodes of a terrain above 2^24 nodes have the albedo of a small one."""
        gradient = {"ground": {"type": "gradient", "from": 0.1, "to": 0.9, "length_m": 9, "azimuth_deg": 20}}
        self.terrain(gradient)
        small = self.intensity("terrain", "small")
        self.succeed("terrain-gen", "-O", "-o", self.path("terrain.h5"), "--half-width", "1024.5", "--resolution", "0.5", "--compression", "1",
                     "--set", "albedo=" + json.dumps(gradient))
        large = self.intensity("terrain", "large")
        os.remove(self.path("terrain.h5"))
        self.assertTrue(np.array_equal(small["pixel"], large["pixel"]))
        np.testing.assert_allclose(large["intensity"], small["intensity"], rtol=1e-6)

    def test_an_albedo_out_of_bounds_is_refused(self):
        self.terrain(0.5)
        with h5py.File(self.path("terrain.h5"), "r+") as file:
            file["albedo"][20, 20] = 1.5
        config = self.config({**SCAN, **EXACT, "surface": {"albedo": "terrain"}})
        self.refuse(1, "scan-sim", "-c", config, "--terrain", self.path("terrain.h5"), "-o", self.path("scan.h5"),
                    words=["terrain.h5: /albedo[20, 20] = 1.5 is not in [0, 1]"], output=self.path("scan.h5"))


if __name__ == "__main__":
    unittest.main()
