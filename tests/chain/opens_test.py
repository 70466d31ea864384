#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The names under which other programs open a file, and what they say of it: GDAL, GMT, rasterio, rioxarray, xarray, Octave."""
import json
import os
import shutil
import subprocess
import sys
import unittest

import h5py
import netCDF4
import numpy as np

from harness import ChainTest, attributes, read_bytes, run

# Loads the packages of a program, and all engines of xarray, whose own warnings do not matter here; from then on, a warning is an error.
# It is about our file then, or about the program. What a package says of its own code later is ignored.
PREAMBLE = """import sys, warnings
warnings.simplefilter("ignore")
import {packages}
if "xarray" in sys.modules:
    sys.modules["xarray"].backends.list_engines()
warnings.simplefilter("error")
for category in (DeprecationWarning, PendingDeprecationWarning, FutureWarning, SyntaxWarning, ImportWarning):
    warnings.simplefilter("ignore", category)
warnings.filterwarnings("error", module="__main__$")
warnings.filterwarnings("ignore", "numpy.ndarray size changed")  # as numpy itself sets it when it is imported
"""
RASTERS = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "rasters")


def gmt_name(path, layer):
    """The name of a layer in GMT."""
    with netCDF4.Dataset(path) as file:
        return f"name: {file[layer].long_name} [{file[layer].units}]\n"


def texts(path):
    """{path in the file: text} of the datasets that are texts."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.update({f"/{name}": item.asstr()[()]})
                        if isinstance(item, h5py.Dataset) and item.dtype.kind == "S" else None)
    return found


def landfall_title(path):
    with h5py.File(path) as file:
        return attributes(file)["title"]


def layers(path):
    """{name: the finite values} of the layers, in the order in which they were created."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        found = {name: item[...] for name, item in file.variables.items() if item.ndim == 2}
    return {name: values[np.isfinite(values)] for name, values in found.items()}


class Opens(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        chain = cls.chain
        cls.plan, cls.one, cls.gap = map(chain.path, ["plan.nc", "one.nc", "gap.h5"])
        for tool, *arguments in (["scan-sim", "--plan", "--plan-radius", "5", "-c", chain.config("scan-sim"), "-q", "-o", cls.plan],
                                 ["regrid", *chain.inputs("regrid"), "--layers", "z_est", "-o", cls.one],
                                 # One pulse at the corner of the scan: no bin of the small map is filled.
                                 ["scan-sim", *chain.inputs("scan-sim"), "--set", "laser.scan_time_s=0.0005", "-o", chain.path("pulse.h5")],
                                 ["regrid", chain.path("pulse.h5"), "--terrain", chain.terrain, "-q", "-o", cls.gap,
                                  "--set", "half_width_m=0.5", "--set", "resolution_m=0.1"]):
            result = run(tool, *arguments)
            if result.returncode:
                raise AssertionError(result.stderr)
        cls.grids = [chain.terrain, chain.dem, chain.eval, cls.plan, cls.one, cls.gap, chain.hazards]

    def output_of(self, *command):
        if not shutil.which(command[0]):
            self.skipTest(f"{command[0]} is not installed")
        result = subprocess.run(command, capture_output=True, text=True, timeout=100, cwd=self.folder, check=False)
        self.assertEqual((result.returncode, result.stderr), (0, ""), f"{command}: {result.stdout}")
        return result.stdout

    def info(self, path):
        return json.loads(self.succeed("landfall-info", path, "--json", "--no-statistics").stdout)

    def python(self, program, *arguments):
        """Runs a program, which begins with its imports; a warning is an error (PREAMBLE)."""
        program = PREAMBLE.format(packages=program.split("\n", 1)[0].removeprefix("import ")) + program
        result = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True,
                                timeout=100, cwd=self.folder, check=False)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return result.stdout.strip()

    def test_the_elevation_comes_first(self):
        for path, first in ((self.chain.terrain, "z"), (self.chain.dem, "z_est"), (self.one, "z_est"), (self.plan, "count"),
                            (self.chain.hazards, "slope")):
            with self.subTest(path):
                self.assertEqual(next(iter(layers(path))), first)
                self.assertIn(gmt_name(path, first), self.output_of("gmt", "grdinfo", path))
        subdatasets = self.output_of("gdalinfo", f"NETCDF:{self.chain.dem}")
        self.assertIn(f'SUBDATASET_1_NAME=NETCDF:"{self.chain.dem}":z_est\n', subdatasets)

    def test_gmt_shows_extent_and_range_of_every_layer(self):
        for path in self.grids:
            shown = self.output_of("gmt", "grdinfo", "-C", "--FORMAT_FLOAT_OUT=%.17g", *(f"{path}?{layer}" for layer in layers(path)))
            for (layer, values), line in zip(layers(path).items(), shown.splitlines(), strict=True):
                with self.subTest(f"{path} {layer}"):
                    fields = line.split("\t")
                    found = [float(field) for field in fields[5:7]]
                    np.testing.assert_allclose(found, [values.min(), values.max()] if values.size else [0, 0], rtol=1e-15, atol=0)
                    if path == self.chain.dem:
                        np.testing.assert_allclose([float(v) for v in (*fields[1:5], *fields[7:11])], [-5, 5, -5, 5, 0.1, 0.1, 101, 101],
                                                   atol=1e-9)

    def test_a_layer_of_nan_has_no_range(self):
        """CF-1.8 forbids one; GMT then shows 0 to 0."""
        with h5py.File(self.gap) as file:
            self.assertTrue(np.isnan(file["z_est"]).all() and np.isnan(file["t_mean"]).all())
            self.assertEqual([name for name, item in file.items() if "actual_range" in item.attrs], ["count"])

    def test_landfall_info_prints_the_names_that_gdal_and_gmt_open(self):
        expected = {self.chain.terrain: "z", self.chain.dem: "z_est", self.chain.eval: "e_z", self.plan: "count", self.one: "z_est",
                    self.chain.hazards: "slope"}
        for path, layer in expected.items():
            with self.subTest(path):
                names = self.info(path)["opens_as"]
                self.assertEqual(names, {"gdal": f'NETCDF:"{path}":{layer}', "gmt": f"{path}?{layer}"})
                text = self.succeed("landfall-info", path, "--no-statistics").stdout
                self.assertIn(f"  GDAL, QGIS  {names['gdal']}\n  GMT         {names['gmt']}\n", text)
                info = json.loads(self.output_of("gdalinfo", "-json", names["gdal"]))
                self.assertEqual(info["bands"][0]["metadata"][""]["NETCDF_VARNAME"], layer)
                self.assertIn(gmt_name(path, layer), self.output_of("gmt", "grdinfo", names["gmt"]))

    def test_a_path_with_a_double_quote_has_no_name_for_gdal(self):
        path = os.path.join(self.path('a"b'), "one.h5")
        os.mkdir(os.path.dirname(path))
        shutil.copy(self.one, path)
        self.assertEqual(self.info(path)["opens_as"], {"gdal": None, "gmt": f"{path}?z_est"})
        self.assertIn("  GDAL, QGIS  GDAL opens no layer of a file whose path has a double quote; rename it\n",
                      self.succeed("landfall-info", path, "--no-statistics").stdout)

    def test_a_file_without_a_grid_has_no_such_names(self):
        self.assertNotIn("opens_as", self.info(self.chain.scan))
        self.succeed("dem-eval", *self.chain.inputs("dem-eval"), "--metrics-only", "-o", self.path("e.h5"))
        self.assertNotIn("opens_as", self.info(self.path("e.h5")))

    def test_gdal_opens_a_netcdf_name_without_a_layer(self):
        info = json.loads(self.output_of("gdalinfo", "-json", self.one))
        self.assertEqual((info["driverShortName"], info["size"]), ("netCDF", [101, 101]))
        np.testing.assert_allclose(info["geoTransform"], [-5.05, 0.1, 0, 5.05, 0, -0.1], atol=1e-12)
        self.assertEqual((info["bands"][0]["unit"], info["bands"][0]["noDataValue"]), ("m", "NaN"))

    def test_every_grid_may_be_called_nc(self):
        terrain, scan, dem, evaluation, hazards = map(self.path, ["t.nc", "s.h5", "d.nc", "e.nc", "h.nc"])
        self.succeed("terrain-gen", *self.chain.inputs("terrain-gen"), "-o", terrain)
        self.succeed("scan-sim", "-c", self.chain.config("scan-sim"), "--terrain", terrain, "-o", scan)
        self.succeed("regrid", scan, "-c", self.chain.config("regrid"), "--terrain", terrain, "-o", dem)
        self.succeed("dem-eval", dem, "-c", self.chain.config("dem-eval"), "-o", evaluation)
        self.succeed("hazard-map", dem, "-c", self.chain.config("hazard-map"), "-o", hazards)
        self.succeed("terrain-gen", "--from", terrain, "-o", self.path("t.tif"))
        for made, known in ((terrain, self.chain.terrain), (dem, self.chain.dem), (evaluation, self.chain.eval), (hazards, self.chain.hazards)):
            self.assertEqual(read_bytes(made), read_bytes(known))  # the name changes nothing

    def test_a_mesh_may_not(self):
        self.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.refuse(2, "terrain-gen", "--from", self.path("m.obj"), "-o", self.path("m.nc"), words=["grids", ".h5"],
                    output=self.path("m.nc"))

    def test_warnings_about_our_files_count_and_those_of_packages_about_themselves_do_not(self):
        self.write("noisy.py", "import warnings\nwarnings.warn('at import')\ndef read(): warnings.warn('the file has no frame')\n"
                               "def old(): warnings.warn('an old function', DeprecationWarning)\n")
        self.assertEqual(self.python("import noisy\nnoisy.old()\nprint(1)"), "1")
        for ours in ("noisy.read()", "import warnings; warnings.warn('x', DeprecationWarning)"):
            with self.assertRaises(AssertionError):
                self.python(f"import noisy\n{ours}")

    def test_rasterio(self):
        program = """import rasterio, sys
for name in sys.argv[1:]:
    with rasterio.open(name) as layer:
        print(layer.driver, layer.width, *[round(v, 9) for v in layer.transform[:6]], layer.nodata, layer.read(1).shape)"""
        names = [self.info(path)["opens_as"]["gdal"] for path in (self.chain.dem, self.chain.hazards)]
        found = self.python(program, *names, self.one).splitlines()
        self.assertEqual(found, ["netCDF 101 0.1 0.0 -5.05 0.0 -0.1 5.05 nan (101, 101)"] * 3)

    def on_a_map(self):
        """A terrain on a map of the Moon."""
        path = self.path("moon.nc")
        self.succeed("terrain-gen", "--from", os.path.join(RASTERS, "polar_stereographic.tif"), "--half-width", "10", "-o", path,
                     "--resolution", "0.5")
        return path

    def test_rioxarray_reads_layer_and_frame_and_xarray_with_it(self):
        program = """import rioxarray, sys, xarray
layer = rioxarray.open_rasterio(sys.argv[1], masked=True)
print(layer.rio.crs.to_dict()["proj"], layer.rio.bounds(), layer.shape, layer.attrs["units"])
with xarray.open_dataset(sys.argv[1], engine="netcdf4", decode_coords="all") as file:
    print(list(file.data_vars), file.rio.crs.to_dict()["proj"], file.z.rio.bounds())"""
        self.assertEqual(self.python(program, self.on_a_map()).splitlines(), ["stere (-10.25, -10.25, 10.25, 10.25) (1, 41, 41) m",
                                                                              "['z'] stere (-10.25, -10.25, 10.25, 10.25)"])

    def test_rows_of_a_scan_have_a_named_dimension(self):
        with h5py.File(self.chain.scan) as file:
            for group, dimension in (("points", "point"), ("pulses", "pulse"), ("detector", "pixel")):
                scale = file[dimension]
                for name, column in file[group].items():
                    self.assertEqual([column.dims[0][0], column.shape], [scale, scale.shape], name)
                self.assertEqual(scale.id.get_storage_size(), 0)
        with netCDF4.Dataset(self.chain.scan) as file:
            self.assertEqual(sorted(file.dimensions), ["pixel", "point", "pulse"])
            self.assertEqual({item.dimensions for item in file["points"].variables.values()}, {("point",)})
            self.assertEqual(list(file.variables), ["crs"])
        program = """import sys, xarray
with xarray.open_dataset(sys.argv[1], group="points", engine="netcdf4") as points:
    print(*points.z_est.dims, points.z_est.size, float(points.z_est[3]))"""
        with h5py.File(self.chain.scan) as file:
            z = file["points/z_est"]
            self.assertEqual(self.python(program, self.chain.scan), f"point {z.size} {float(z[3])!r}")

    def octave(self, program):
        if not shutil.which("octave"):
            self.skipTest("octave is not installed (150 MB); tried by hand, see docs/user/files/README.md")
        result = subprocess.run(["octave", "--no-gui", "--quiet", "--norc", "--eval", program + "fflush(stdout);"],
                                capture_output=True, text=True, timeout=100, check=False)
        # Octave 7.3 may fail to exit in order without a terminal, whatever it ran.
        errors = [line for line in result.stderr.splitlines() if "while preparing to exit" not in line]
        self.assertEqual((result.returncode, errors), (0, []))
        return result.stdout

    def test_octave_loads_what_is_named(self):
        found = self.octave(f"""s = load('{self.chain.scan}', 'points'); d = load('{self.chain.dem}', 'x', 'z_est');
printf('%d %.17g %d %.17g\\n', numel(s.points.z_est), s.points.z_est(4), columns(d.z_est), d.z_est(61, 41));""").split()
        with h5py.File(self.chain.scan) as scan, h5py.File(self.chain.dem) as dem:
            z = scan["points/z_est"]
            self.assertEqual([float(word) for word in found], [z.size, z[3], 101, dem["z_est"][40, 60]])

    def test_octave_loads_whole_files(self):
        for path in (*self.grids, self.chain.scan):
            with self.subTest(path):
                found = self.octave(f"f = load('{path}'); printf('%s', f.provenance.config_json);")
                self.assertEqual(found, texts(path)["/provenance/config_json"])

    def test_netcdf_reads_every_text(self):
        for path in (*self.grids, self.chain.scan):
            with self.subTest(path), netCDF4.Dataset(path) as file:
                wanted = texts(path)
                self.assertIn("/provenance/inputs_json", wanted)
                for name, text in wanted.items():
                    self.assertEqual(file[name][...], text, name)
                self.assertEqual(file.title, landfall_title(path))
                self.output_of("ncdump", path)

    def test_xarray_reads_layers_sites_and_texts(self):
        program = """import sys, xarray
with xarray.open_dataset(sys.argv[1], engine="netcdf4") as file:
    print(*file.safe.dims, int((file.safe == 1).sum()), file.safe.attrs["flag_meanings"])
with xarray.open_dataset(sys.argv[1], group="sites", engine="netcdf4") as sites:
    print(*sites["rank"].values, float(sites["x"][0]))
with xarray.open_dataset(sys.argv[2], group="provenance", engine="netcdf4") as provenance:
    print(str(provenance.config_json.values), provenance.attrs["tool"], type(provenance.attrs["tool"]) is str)"""
        with h5py.File(self.chain.hazards) as file:
            expected = [f"y x {(file['safe'][()] == 1).sum()} hazard safe unknown",
                        " ".join(map(str, [*file["sites/rank"][()], float(file["sites/x"][0])])),
                        *(texts(self.chain.dem)["/provenance/config_json"] + " regrid True").splitlines()]
        self.assertEqual(self.python(program, self.chain.hazards, self.chain.dem).splitlines(), expected)

    def test_h5py_gives_bytes(self):
        with h5py.File(self.chain.dem) as file:
            self.assertEqual(file.attrs["format_name"], b"landfall.dem")
            self.assertEqual(json.loads(file["provenance/config_json"][()])["resolution_m"], 0.1)
            self.assertIn('"resolution_m"', file["provenance/config_json"].asstr()[()])


if __name__ == "__main__":
    unittest.main()
