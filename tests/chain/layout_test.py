#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The layout of the four files, dataset by dataset, and how other programs open them."""
import json
import shutil
import subprocess
import unittest

import h5py
import numpy as np

from harness import TOOLS, ChainTest, attributes

FLOAT64, FLOAT32, INT64, INT32, INT8 = "<f8", "<f4", "<i8", "<i4", "|i1"
POINTS = dict.fromkeys(["x_est", "y_est", "z_est", "x_true", "y_true", "z_true", "range_true", "range_measured"],
                       FLOAT64) | {"pulse": INT32, "pixel": INT32, "status": INT8}
POSE = ["px", "py", "pz", "qw", "qx", "qy", "qz"]
PULSES = dict.fromkeys(["t", "angle_1", "angle_2"] + [f"{name}_{which}" for which in ("true", "est") for name in POSE],
                       FLOAT64) | {"point_begin": INT64, "point_count": INT32}
DEM = dict.fromkeys(["z_est", "x_true", "y_true", "z_true", "weight_sum", "t_mean"], FLOAT64) | {"count": INT32} | \
    dict.fromkeys(["x_est_mean", "y_est_mean", "z_spread"], FLOAT32)
EVAL = dict.fromkeys(["e_x", "e_y", "e_z"], FLOAT64) | \
    dict.fromkeys(["abs_x", "abs_y", "abs_z", "rel_x", "rel_y", "rel_z", "distance_to_valid"], FLOAT32) | \
    {"invalid": INT8, "in_region": INT8, "hole_id": INT32, "fail": INT8}
HAZARDS = dict.fromkeys(["slope", "roughness", "p_touchdown", "cost", "distance_to_hazard", "slope_true", "roughness_true"], FLOAT32) | \
    dict.fromkeys(["safe", "safe_true", "outcome"], INT8)
DRAWS = dict.fromkeys(["p_invalid", "p_fail_rel_x", "p_fail_rel_y", "p_fail_rel_z", "p_fail_absolute", "e_z_mean", "e_z_std", "e_map_std",
                       "z_true_map", "count_mean"], FLOAT32) | {"in_region": INT8}
LAYERS = {"terrain-gen": {"z": FLOAT64}, "regrid": DEM, "dem-eval": EVAL, "hazard-map": HAZARDS, "monte-carlo": DRAWS}
KINDS = dict(zip(TOOLS, ["terrain", "scan", "dem", "evaluation", "hazards", "draws"]))
CHAINS = {"terrain-gen": [], "scan-sim": ["terrain-gen"], "regrid": ["terrain-gen", "scan-sim"],
          "dem-eval": ["terrain-gen", "scan-sim", "regrid"],
          "hazard-map": ["terrain-gen", "scan-sim", "regrid"], "monte-carlo": ["terrain-gen", "scan-sim"]}


def items(file):
    found = {}
    file.visititems(lambda name, item: found.__setitem__(name, item))
    return found


class Layout(ChainTest):
    def test_root_attributes(self):
        ids = set()
        for name, kind in KINDS.items():
            with h5py.File(self.chain.output(name)) as file:
                found = attributes(file)
                self.assertEqual(found["Conventions"], "CF-1.8")
                self.assertEqual(found["format_name"], f"landfall.{kind}")
                self.assertRegex(found["format_version"], r"^[12]\.\d+$")
                self.assertRegex(found["file_id"], r"^[0-9a-f]{32}$")
                self.assertEqual(found["complete"], 1)
                self.assertRegex(found["source"], rf"^landfall {name} \d+\.\d+\.\d+ \(git .+\)$")
                self.assertTrue(found["title"])
                self.assertEqual(len(found["history"].splitlines()), len(CHAINS[name]) + 1)
                ids.add(found["file_id"])
        self.assertEqual(len(ids), 6)

    def test_provenance(self):
        for name, steps in CHAINS.items():
            with h5py.File(self.chain.output(name)) as file:
                texts = {key: json.loads(item.asstr()[()]) for key, item in file["provenance"].items()}
                self.assertEqual(set(texts), {"config_json", "inputs_json", "chain_json"})
                self.assertEqual([step["tool"] for step in texts["chain_json"]], steps)
                with open(self.chain.config(name), encoding="utf-8") as given:
                    for key, value in json.load(given).items():
                        if not isinstance(value, (dict, list)):
                            self.assertEqual(texts["config_json"][key], value)
                upstream = {step["file_id"] for step in texts["chain_json"]}
                self.assertLessEqual({entry["file_id"] for entry in texts["inputs_json"]}, upstream)

    def test_units_and_long_name_on_every_dataset(self):
        for name in TOOLS:
            with h5py.File(self.chain.output(name)) as file:
                for key, item in items(file).items():
                    if isinstance(item, h5py.Dataset):
                        self.assertTrue(item.attrs.get("units"), f"{name}: {key} has no units")
                        self.assertTrue(item.attrs.get("long_name"), f"{name}: {key} has no long_name")

    def test_only_portable_types_and_no_links_or_times(self):
        for name in TOOLS:
            with h5py.File(self.chain.output(name)) as file:
                for key, item in items(file).items():
                    self.assertIsInstance(item.parent.get(item.name.rpartition("/")[2], getlink=True), h5py.HardLink)
                    self.assertNotIn("coordinates", item.attrs)
                    if not isinstance(item, h5py.Dataset):
                        continue
                    self.assertEqual(h5py.h5g.get_objinfo(item.id).mtime, 0, key)
                    text = h5py.check_string_dtype(item.dtype)
                    kind = "text" if text else item.dtype.str
                    self.assertIn(kind, [FLOAT64, FLOAT32, INT64, INT32, INT8, "text"], key)

    def check_grid(self, file, expected, shape, level=1):
        layers = {key: item for key, item in file.items() if isinstance(item, h5py.Dataset) and item.ndim == 2}
        self.assertEqual({key: item.dtype.str for key, item in layers.items()}, expected)
        for key, item in layers.items():
            self.assertEqual(item.shape, shape)
            self.assertEqual(item.chunks, tuple(min(256, size) for size in shape))
            self.assertEqual((item.shuffle, item.compression, item.compression_opts), (True, "gzip", level), key)
            self.assertEqual(item.dims[0][0], file["y"])
            self.assertEqual(item.dims[1][0], file["x"])
            self.assertNotIn("grid_mapping", item.attrs)  # a local frame
            if item.dtype.kind == "f":
                self.assertEqual(item.attrs["_FillValue"].dtype, item.dtype)
                self.assertTrue(np.isnan(item.attrs["_FillValue"]).all())
                self.assertTrue(np.isnan(item.fillvalue))
            else:
                self.assertNotIn("_FillValue", item.attrs)

    def test_grids(self):
        for name, expected in LAYERS.items():
            half = 60 if name == "terrain-gen" else 50
            with h5py.File(self.chain.output(name)) as file:
                self.check_grid(file, expected, (2 * half + 1, 2 * half + 1))
                for axis in "xy":
                    self.assertTrue(h5py.h5ds.is_scale(file[axis].id))
                    self.assertEqual(file[axis].dtype.str, FLOAT64)
                    np.testing.assert_allclose(file[axis], np.arange(-half, half + 1) * 0.1, rtol=0, atol=1e-15)
                self.assertEqual(file["crs"].shape, ())
                self.assertRegex(attributes(file["crs"])["crs_wkt"], r"^[A-Z_]+\[")

    def test_large_grids_have_chunks_of_256_x_256(self):
        self.succeed("terrain-gen", "-o", self.path("t.h5"), "--set", "grid.half_width_m=20", "--set",
                     "grid.resolution_m=0.1")
        with h5py.File(self.path("t.h5")) as file:
            self.assertEqual(file["z"].chunks, (256, 256))

    def check_table(self, group, expected, rows):
        self.assertEqual({key: item.dtype.str for key, item in group.items()}, expected)
        for key, item in group.items():
            self.assertEqual(item.shape, (rows,), key)
            self.assertEqual(item.chunks, (rows,), key)  # of longer tables 65,536
            self.assertEqual((item.shuffle, item.compression, item.compression_opts), (True, "gzip", 1), key)

    def test_scan_tables(self):
        with h5py.File(self.chain.scan) as file:
            counts = {key: int(file["points"].attrs[key])
                      for key in ["return_count", "miss_count", "dropout_count", "dead_count"]}
            self.assertEqual(sum(counts.values()), 400 * 64)
            self.check_table(file["points"], POINTS, counts["return_count"])
            self.check_table(file["pulses"], PULSES, 400)
            self.check_table(file["detector"], {"direction_x": FLOAT64, "direction_y": FLOAT64,
                                                "direction_z": FLOAT64, "dead": INT8}, 64)

    def test_float32_scan(self):
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--float32", "-o", self.path("s.h5"))
        with h5py.File(self.path("s.h5")) as file, h5py.File(self.chain.scan) as plain:
            for key, item in file["points"].items():
                self.assertEqual(item.dtype.str, POINTS[key].replace(FLOAT64, FLOAT32))
                np.testing.assert_array_equal(item[()], plain["points"][key][()].astype(item.dtype))

    def test_evaluation_has_holes_and_metrics(self):
        with h5py.File(self.chain.eval) as file, open(self.chain.metrics, encoding="utf-8") as metrics:
            self.assertEqual(json.loads(file["metrics_json"].asstr()[()]), json.load(metrics))
            self.assertEqual(len(file["holes/id"]), json.loads(file["metrics_json"].asstr()[()])["coverage"]["hole_count"])

    def test_metrics_only_file_has_metrics_and_no_layer(self):
        self.succeed("dem-eval", *self.chain.inputs("dem-eval"), "--metrics-only", "-o", self.path("e.h5"))
        with h5py.File(self.path("e.h5")) as file, h5py.File(self.chain.eval) as full:
            self.assertEqual([key for key, item in file.items()
                              if isinstance(item, h5py.Dataset) and item.ndim == 2], [])
            self.assertEqual(file["metrics_json"][()], full["metrics_json"][()])

    def test_fewer_layers_and_no_terrain(self):
        self.succeed("regrid", *self.chain.inputs("regrid"), "--layers", "z_est,count", "-o", self.path("d.h5"))
        with h5py.File(self.path("d.h5")) as file:
            self.check_grid(file, {"z_est": FLOAT64, "count": INT32}, (101, 101))
        self.succeed("regrid", self.chain.scan, "-c", self.chain.config("regrid"), "-o", self.path("n.h5"))
        with h5py.File(self.path("n.h5")) as file, h5py.File(self.chain.dem) as dem:
            self.check_grid(file, {key: kind for key, kind in DEM.items() if key != "z_true"}, (101, 101))
            np.testing.assert_array_equal(file["x_true"][()], dem["x_true"][()])


class Readers(ChainTest):
    """Other programs open the files as the pages of docs/user/files say."""

    def output_of(self, *command):
        if not shutil.which(command[0]):
            self.skipTest(f"{command[0]} is not installed")
        result = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=self.folder, check=False)
        self.assertEqual(result.returncode, 0, f"{command}: {result.stderr}")
        return result.stdout

    def test_gdalinfo_opens_every_layer_georeferenced(self):
        for path, layers in [(self.chain.terrain, ["z"]), (self.chain.dem, DEM), (self.chain.eval, EVAL)]:
            half = 6.05 if path == self.chain.terrain else 5.05
            for layer in layers:
                info = json.loads(self.output_of("gdalinfo", "-json", f'NETCDF:"{path}":{layer}'))
                np.testing.assert_allclose(info["cornerCoordinates"]["upperLeft"], [-half, half], atol=1e-9)
                np.testing.assert_allclose(info["cornerCoordinates"]["lowerRight"], [half, -half], atol=1e-9)
                np.testing.assert_allclose(np.array(info["geoTransform"])[[1, 5]], [0.1, -0.1], atol=1e-12)
                self.assertNotIn("coordinateSystem", info, layer)  # a local frame

    def test_gdal_reads_the_values_north_up(self):
        x, y = 1.5, 0.5  # the top of the cone
        if not shutil.which("gdallocationinfo"):
            self.skipTest("gdallocationinfo is not installed")
        text = self.output_of("gdallocationinfo", "-valonly", "-geoloc", f'NETCDF:"{self.chain.terrain}":z',
                              str(x), str(y))
        with h5py.File(self.chain.terrain) as file:
            self.assertAlmostEqual(float(text), file["z"][60 + 5, 60 + 15], places=6)

    def test_uncompressed_files_open_too(self):
        """Their chunks are zlib streams, for the checksum."""
        path = self.path("plain.h5")
        self.succeed("regrid", *self.chain.inputs("regrid"), "--compression", "0", "-o", path)
        command = ["gdallocationinfo", "-valonly", "-geoloc", f'NETCDF:"{path}":z_est', "0.5", "0.5"]
        with h5py.File(path) as file, h5py.File(self.chain.dem) as dem:
            self.assertTrue(all(file[layer].compression == "gzip" and file[layer].compression_opts == 0 and not file[layer].shuffle for layer in DEM))
            values = {layer: dem[layer][()] for layer in DEM}
            for layer, expected in values.items():
                np.testing.assert_array_equal(file[layer][()], expected)
        self.assertAlmostEqual(float(self.output_of(*command)), values["z_est"][50 + 5, 50 + 5], places=6)
        points = self.output_of("gmt", "grd2xyz", f"{path}?z_est", "-s").split()
        np.testing.assert_allclose([float(z) for z in points[2::3]], values["z_est"][::-1][np.isfinite(values["z_est"][::-1])])
        self.assertIn("z_est =", self.output_of("ncdump", "-v", "z_est", path))
        try:
            import xarray  # pylint: disable=import-outside-toplevel
        except ImportError:
            self.skipTest("xarray is not installed")
        with xarray.open_dataset(path, engine="netcdf4") as file:
            for layer, expected in values.items():
                np.testing.assert_array_equal(file[layer].values.astype(expected.dtype), expected)


if __name__ == "__main__":
    unittest.main()
