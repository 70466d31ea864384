# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of landfall-export read by other programs: extents and values equal those that h5py reads from our files.

Tests of a program that is not installed are skipped with a message. The Debian packages are gdal-bin, gmt, cloudcompare,
python3-paraview, python3-meshio and libxdmf-dev; npm fetches the LAS reader from its registry
(tests/chain/outside/package-lock.json).
"""
import functools
import glob
import json
import os
import shutil
import subprocess
import tempfile
import unittest

import h5py
import numpy as np
from PIL import Image

from harness import Chain, ToolTest, bins_of_picture, columns, read_bytes, returns_of, run, tool

OUTSIDE = os.path.join(os.environ["LANDFALL_ROOT"], "tests", "chain", "outside")
GRID = 5  # m, half width of the DEM
CHAIN = None


def setUpModule():
    global CHAIN
    CHAIN = Chain()
    unittest.addModuleCleanup(CHAIN.remove)


def program(name, package):
    if shutil.which(name) is None:
        raise unittest.SkipTest(f"{name} is not installed (Debian's {package})")
    return name


def meshio_of(path):
    try:
        import meshio  # pylint: disable=import-outside-toplevel
    except ImportError as missing:
        raise unittest.SkipTest("meshio is not installed (Debian's python3-meshio)") from missing
    return meshio.read(path)


def output_of(*command, **options):
    result = subprocess.run([str(word) for word in command], capture_output=True, timeout=300, **options)
    if result.returncode != 0:
        raise AssertionError(f"{command}: exit {result.returncode}: {result.stderr.decode()}")
    return result.stdout


class ExportTest(ToolTest):
    def export(self, source, name, *arguments):
        path = self.path(name)
        result = self.succeed("landfall-export", source, "-o", path, *arguments)
        self.assertEqual(result.stdout, "")
        self.assertEqual([entry for entry in self.entries() if entry.endswith(".part")], [])
        return path

    def rasters(self, path):
        """All bands of an image as GDAL reads them; row 0 is the top one."""
        raw = self.path("raw.img")
        output_of(program("gdal_translate", "gdal-bin"), "-q", "-of", "ENVI", "-co", "INTERLEAVE=BSQ", path, raw)
        kinds = {"1": np.uint8, "2": np.int16, "3": np.int32, "4": np.float32, "5": np.float64}
        with open(self.path("raw.hdr"), encoding="ascii") as file:
            header = dict((word.strip() for word in line.split(" = ")) for line in file if line.count(" = ") == 1)
        shape = [int(header[key]) for key in ("bands", "lines", "samples")]
        return np.fromfile(raw, kinds[header["data type"]]).reshape(shape)

    def paraview(self, *files):
        """The contents that ParaView reads from each (reader, file). It is started once for all of them, because a start takes seconds."""
        outs = [self.path(f"paraview-{i}.npz") for i in range(len(files))]
        words = [word for (reader, path), out in zip(files, outs) for word in (reader, path, out)]
        output_of(program("pvpython", "python3-paraview"), os.path.join(OUTSIDE, "read_paraview.py"), *words)
        return [dict(np.load(out)) for out in outs]

    def assert_close(self, found, expected, tolerance, what=""):
        found, expected = np.asarray(found, float), np.asarray(expected, float)
        self.assertEqual(found.shape, expected.shape, what)
        np.testing.assert_array_equal(np.isnan(found), np.isnan(expected), what)
        self.assertLessEqual(np.nanmax(np.abs(found - expected), initial=0), tolerance, what)


def xyz(points, position="est"):
    return np.stack([points[axis + "_" + position] for axis in "xyz"], axis=1)


class GeotiffTest(ExportTest):
    def bands(self, path, count):
        """All bands as GDAL reads them; row 0 is the southernmost."""
        values = self.rasters(path)
        self.assertEqual(len(values), count)
        return values[:, ::-1]

    def test_gdal_reads_every_layer_with_its_extent(self):
        program("gdalinfo", "gdal-bin")
        path = self.export(CHAIN.dem, "dem.tif", "--layers", "all")
        info = json.loads(output_of("gdalinfo", "-json", path))
        dem = columns(CHAIN.dem, "/")
        names = [band["description"] for band in info["bands"]]
        self.assertEqual(sorted(names), sorted(set(dem) - {"x", "y", "crs"}))
        self.assertEqual(names[:2], ["z_est", "count"])
        np.testing.assert_allclose(info["geoTransform"], [-GRID - 0.05, 0.1, 0, GRID + 0.05, 0, -0.1], atol=1e-12)
        self.assertEqual({(band["type"], band["noDataValue"]) for band in info["bands"]}, {("Float64", "NaN")})
        self.assertEqual(info["bands"][0]["unit"], "m")
        for name, values in zip(names, self.bands(path, len(names))):
            self.assert_close(values, dem[name], 0, name)
        self.assertIn("COG", output_of("gdalinfo", "-json", path).decode())

    def test_the_type_is_the_smallest_that_holds_all_layers(self):
        program("gdalinfo", "gdal-bin")
        evaluation = columns(CHAIN.eval, "/")
        for layers, kind in [("fail,invalid", "Int16"), ("fail,hole_id", "Int32"), ("rel_z,fail", "Float32"),
                             ("rel_z,hole_id", "Float64")]:
            path = self.export(CHAIN.eval, layers + ".tif", "--layers", layers)
            bands = json.loads(output_of("gdalinfo", "-json", path))["bands"]
            self.assertEqual([band["type"] for band in bands], [kind] * 2)
            self.assertEqual("noDataValue" in bands[0], kind.startswith("Float"))
            for name, values in zip(layers.split(","), self.bands(path, 2)):
                self.assert_close(values, evaluation[name], 0, name)

    def test_gmt_reads_extent_and_values(self):
        program("gmt", "gmt")
        path = self.export(CHAIN.dem, "dem.tif")
        words = output_of("gmt", "grdinfo", "-C", path).split()
        self.assert_close([float(word) for word in words[1:5]],
                          [-GRID - 0.05, GRID + 0.05, -GRID - 0.05, GRID + 0.05], 1e-9)
        table = np.frombuffer(output_of("gmt", "grd2xyz", path, "-bo3d")).reshape(-1, 3)
        dem = columns(CHAIN.dem, "/")
        x, y = np.meshgrid(dem["x"], dem["y"][::-1])
        self.assert_close(table[:, 0], x.ravel(), 1e-9)
        self.assert_close(table[:, 1], y.ravel(), 1e-9)
        self.assert_close(table[:, 2], dem["z_est"][::-1].ravel(), 2e-7)  # GMT stores grids as float32


class PlyTest(ExportTest):
    def test_cloudcompare_reads_coordinates_and_scalar_fields(self):
        program("CloudCompare", "cloudcompare")
        est, true = (self.export(CHAIN.scan, position + ".ply", "--position", position) for position in ("est", "true"))
        output_of("CloudCompare", "-SILENT", "-NO_TIMESTAMP", "-O", est, "-O", true, "-C_EXPORT_FMT", "ASC", "-PREC", 9, "-SEP",
                  "SPACE", "-ADD_HEADER", "-SAVE_CLOUDS", cwd=self.folder,
                  env={**os.environ, "QT_QPA_PLATFORM": "offscreen", "HOME": self.folder})
        for position, other in [("est", "true"), ("true", "est")]:
            with open(self.path(position + ".asc"), encoding="ascii") as file:
                names = file.readline().lstrip("/").split()
                table = dict(zip(names, np.loadtxt(file, ndmin=2).T))
            points = returns_of(CHAIN.scan)
            self.assertEqual(sorted(names), sorted(
                ["X", "Y", "Z", "range_true", "range_meas", "pulse", "pixel", "status"]
                + [axis + "_" + other for axis in "xyz"]))
            # CloudCompare stores coordinates and fields as float32.
            for axis in "xyz":
                self.assert_close(table[axis.upper()], points[axis + "_" + position], 1e-6)
                self.assert_close(table[axis + "_" + other], points[axis + "_" + other], 1e-6)
            self.assert_close(table["range_meas"], points["range_measured"], 1e-5)
            for name in ["pulse", "pixel", "status"]:
                self.assert_close(table[name], points[name], 0, name)

    def test_meshio_reads_every_value(self):
        points = returns_of(CHAIN.scan)
        wanted = [name for name in points if name != "status"]  # meshio does not read properties of type char
        found = meshio_of(self.export(CHAIN.scan, "scan.ply", "--columns", ",".join(wanted)))
        self.assert_close(found.points, xyz(points), 0)
        self.assertEqual(len(found.point_data), len(wanted) - 3)
        for name, values in found.point_data.items():
            column = {"range_meas": "range_measured"}.get(name.removeprefix("scalar_"), name.removeprefix("scalar_"))
            self.assert_close(values, points[column], 0, name)


class PcdTest(ExportTest):
    def cloud(self, path):
        """The header's lines and the points of a binary PCD, as its specification describes it."""
        header, body = read_bytes(path).split(b"DATA binary\n", 1)
        lines = dict(line.split(" ", 1) for line in header.decode("ascii").splitlines() if not line.startswith("#"))
        kinds = ["<" + {"F": "f", "I": "i", "U": "u"}[letter] + size
                 for letter, size in zip(lines["TYPE"].split(), lines["SIZE"].split())]
        self.assertEqual(set(lines["COUNT"].split()), {"1"})
        table = np.frombuffer(body, np.dtype(list(zip(lines["FIELDS"].split(), kinds))))
        self.assertEqual([int(lines[name]) for name in ("WIDTH", "HEIGHT", "POINTS")], [len(table), 1, len(table)])
        return table

    def test_every_value_reads_back(self):
        points = returns_of(CHAIN.scan)
        for position in ("est", "true"):
            table = self.cloud(self.export(CHAIN.scan, position + ".pcd", "--position", position))
            self.assertEqual(len(table), len(points["x_est"]))
            self.assertEqual(len(table.dtype.names), len(points))
            for name in table.dtype.names:
                column = f"{name}_{position}" if len(name) == 1 else name.removeprefix("scalar_").replace("range_meas", "range_measured")
                expected = points[column].astype(np.float32) if len(name) == 1 else points[column]
                np.testing.assert_array_equal(table[name], expected, name)

    def test_every_nth_point_of_one_column(self):
        points = returns_of(CHAIN.scan)
        table = self.cloud(self.export(CHAIN.scan, "some.pcd", "--every", 7, "--columns", "pulse"))
        np.testing.assert_array_equal(table["scalar_pulse"], points["pulse"][::7])

    def test_a_visible_rounding_is_told(self):
        far = self.path("far.h5")
        shutil.copy(CHAIN.scan, far)
        with h5py.File(far, "r+") as file:
            file["points/x_est"][...] += 1e6
        result = run("landfall-export", far, "-o", self.path("far.pcd"))
        self.assertIn("far.pcd: x, y and z are rounded to float32, by up to 31.", result.stderr)


class LasTest(ExportTest):
    @classmethod
    def setUpClass(cls):
        program("node", "nodejs")
        program("npm", "npm")
        cls.reader = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="landfall-las-"))
        for name in ["package.json", "package-lock.json", "read_las.js"]:
            shutil.copy(os.path.join(OUTSIDE, name), cls.reader)
        try:
            subprocess.run(["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--fetch-retries=0"], check=True,
                           cwd=cls.reader, capture_output=True, timeout=120)
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
            raise unittest.SkipTest(f"npm cannot fetch the LAS reader: {error}")

    def test_copc_reads_coordinates_times_and_classes(self):
        points = returns_of(CHAIN.scan)
        for position in ["est", "true"]:
            path = self.export(CHAIN.scan, position + ".las", "--position", position)
            found = json.loads(output_of("node", "read_las.js", path, cwd=self.reader))
            seen = np.stack([found[axis] for axis in "xyz"], axis=1)
            self.assert_close(seen, xyz(points, position), 0.501e-6)
            self.assert_close(found["bounds"], [seen.min(axis=0), seen.max(axis=0)], 1e-12)
            self.assertEqual(set(found["classification"]), {1})
            self.assertEqual(found["byReturn"], [len(seen), 0, 0, 0, 0])
            self.assertEqual(found["version"], [1, 2])
            self.assertTrue(found["software"].startswith("landfall-export "))
            np.testing.assert_array_equal(found["time"], columns(CHAIN.scan, "pulses")["t"][points["pulse"]])
            self.assertEqual(set(found["returnNumber"]) | set(found["returns"]), {1})


@functools.lru_cache(maxsize=None)
def xdmf_reader():
    """A reader that uses the Xdmf project's own library, compiled once."""
    libraries = glob.glob("/usr/lib/*/xdmf/serial")
    if not libraries or not shutil.which("c++"):
        raise unittest.SkipTest("the Xdmf library is not installed (Debian's libxdmf-dev)")
    folder = tempfile.mkdtemp(prefix="landfall-xdmf-")
    unittest.addModuleCleanup(shutil.rmtree, folder)
    path = os.path.join(folder, "read_xdmf")
    output_of("c++", "-w", "-I/usr/include/libxml2", os.path.join(OUTSIDE, "read_xdmf.cpp"), "-o", path,
              "-L" + libraries[0], "-lXdmf", "-lXdmfCore")
    return path


class XdmfTest(ExportTest):
    def copied(self, source):
        """A copy in the test's folder, because an .xmf names its data by a relative path."""
        shutil.copy(source, self.folder)
        return self.path(os.path.basename(source))

    def xdmf_library(self, path):
        lines = output_of(xdmf_reader(), path).decode().splitlines()
        return {name: np.array(values, float) for name, *values in (line.split() for line in lines)}

    def scans(self):
        """(.xmf, columns of the scan, coordinates) for both positions, and for a scan in single precision."""
        single = self.path("single.h5")
        self.succeed("scan-sim", *CHAIN.inputs("scan-sim"), "--float32", "-o", single)
        for source, position in [(self.copied(CHAIN.scan), "est"), (self.path("scan.h5"), "true"), (single, "est")]:
            name = f"{position}-{os.path.basename(source)}.xmf"
            path = self.export(source, name, "--position", position)
            self.assertIn(f">{os.path.basename(source)}:/points/".encode(), read_bytes(path))
            self.assertIn(f">{name}.h5:/position<".encode(), read_bytes(path))
            points = returns_of(source)
            yield path, points, xyz(points, position)

    def test_paraview_reads_scans_and_grids(self):
        """A PLY, and each .xmf by both of its readers."""
        program("pvpython", "python3-paraview")
        scans, sources = list(self.scans()), [CHAIN.terrain, CHAIN.dem, CHAIN.eval]
        grids = [self.export(self.copied(source), os.path.basename(source) + ".xmf") for source in sources]
        by_both = [(reader, path) for path in [*(path for path, _, _ in scans), *grids] for reader in ("xdmf", "xdmf3")]
        ply, *read = self.paraview(("ply", self.export(CHAIN.scan, "scan.ply")), *by_both)
        self.assert_close(ply["points"], xyz(returns_of(CHAIN.scan)), 1e-6)  # its PLY reader gives float32
        self.check_scans(scans, read[:6])
        self.check_grids(sources, read[6:])

    def check_scans(self, scans, read):
        for found, (_, points, coordinates) in zip(read, [scan for scan in scans for _ in range(2)], strict=True):
            self.assert_close(found["points"], coordinates, 0)
            self.assertEqual(found["points"].dtype, coordinates.dtype)
            self.assert_close(found["bounds"].reshape(3, 2).T, [coordinates.min(axis=0), coordinates.max(axis=0)], 0)
            self.assertEqual(found["cells"], len(coordinates))
            for name, values in points.items():
                self.assert_close(found["field_" + name], values, 0, name)

    def test_meshio_reads_a_scan(self):
        for path, points, coordinates in self.scans():
            found = meshio_of(path)
            self.assert_close(found.points, coordinates, 0)
            self.assertEqual([(block.type, len(block.data)) for block in found.cells], [("vertex", len(coordinates))])
            self.assertEqual(set(found.point_data), set(points))
            for name, values in points.items():
                self.assert_close(found.point_data[name], values, 0, name)

    def test_the_xdmf_library_reads_a_scan(self):
        for path, points, coordinates in self.scans():
            found = self.xdmf_library(path)
            self.assert_close(found.pop("points"), coordinates.ravel(), 0)
            self.assert_close(found.pop("row"), np.arange(len(coordinates)), 0)
            self.assertEqual(set(found), set(points))
            for name, values in points.items():
                self.assert_close(found[name], values, 0, name)

    def check_grids(self, sources, read):
        for source, both in zip(sources, zip(read[::2], read[1::2], strict=True), strict=True):
            grid = columns(source, "/")
            for found in both:
                self.assert_close(found["bounds"], [grid["x"][0], grid["x"][-1], grid["y"][0], grid["y"][-1], 0, 0], 1e-9)
                for name, values in grid.items():
                    if values.ndim == 2:
                        self.assert_close(found["field_" + name], values.ravel(), 0, f"{source} {name}")

    def test_the_xdmf_library_reads_a_grid(self):
        for source in [CHAIN.terrain, CHAIN.dem, CHAIN.eval]:
            grid = columns(source, "/")
            found = self.xdmf_library(self.export(self.copied(source), os.path.basename(source) + ".xmf"))
            step = grid["x"][1] - grid["x"][0]
            self.assert_close(found.pop("origin"), [0, grid["y"][0], grid["x"][0]], 1e-12)
            self.assert_close(found.pop("step"), [step] * 3, 1e-12)
            self.assert_close(found.pop("size"), [1, len(grid["y"]), len(grid["x"])], 0)
            layers = {name: values.ravel() for name, values in grid.items() if values.ndim == 2}
            self.assertEqual(set(found), set(layers))
            for name, values in layers.items():
                self.assert_close(found[name], values, 0, name)

    def test_the_three_files_can_be_moved_together(self):
        os.mkdir(self.path("a"))
        scan = shutil.copy(CHAIN.scan, self.path("a"))
        path = self.export(scan, "a/scan.xmf")
        os.rename(self.path("a"), self.path("b"))
        self.assertFalse(os.path.exists(path))
        self.assert_close(meshio_of(self.path("b/scan.xmf")).points, xyz(returns_of(CHAIN.scan)), 0)

    def test_neither_file_is_replaced_without_overwrite(self):
        scan = self.copied(CHAIN.scan)
        path = self.export(scan, "scan.xmf")
        before = {name: read_bytes(self.path(name)) for name in self.entries()}
        self.assertEqual(set(before), {"scan.h5", "scan.xmf", "scan.xmf.h5"})
        os.remove(path)
        self.refuse(2, "landfall-export", scan, "-o", path, words=["scan.xmf.h5 exists", "-O"], output=path)
        self.export(scan, "scan.xmf", "-O")
        self.assertEqual({name: read_bytes(self.path(name)) for name in self.entries()}, before)

    def test_the_coordinates_never_replace_the_scan(self):
        scan = self.path("a.xmf.h5")
        shutil.copy(CHAIN.scan, scan)
        self.refuse(2, "landfall-export", scan, "-o", self.path("a.xmf"), "-O", words=["a.xmf.h5 is an input"],
                    output=self.path("a.xmf"))
        self.assertEqual(read_bytes(scan), read_bytes(CHAIN.scan))

    def test_a_scan_that_keeps_misses_is_refused(self):
        misses = self.path("misses.h5")
        self.succeed("scan-sim", *CHAIN.inputs("scan-sim"), "--keep-misses", "-o", misses)
        self.refuse(2, "landfall-export", misses, "-o", self.path("a.xmf"), words=["without a return", ".ply"],
                    output=self.path("a.xmf"))
        self.assertEqual(self.entries(), ["misses.h5"])


class CsvTest(ExportTest):
    def table(self, path):
        return np.genfromtxt(path, delimiter=",", names=True)

    def test_numpy_reads_the_same_doubles(self):
        points = returns_of(CHAIN.scan)
        table = self.table(self.export(CHAIN.scan, "scan.csv"))
        self.assertEqual(table.dtype.names, ("x_est_m", "y_est_m", "z_est_m", "x_true_m", "y_true_m", "z_true_m",
                                             "range_true_m", "range_measured_m", "pulse", "pixel", "status"))
        for name in table.dtype.names:
            np.testing.assert_array_equal(table[name], points[name.removesuffix("_m")], name)

    def test_numpy_reads_a_grid(self):
        grid = columns(CHAIN.eval, "/")
        table = self.table(self.export(CHAIN.eval, "eval.csv", "--layers", "all"))
        x, y = np.meshgrid(grid["x"], grid["y"])
        np.testing.assert_array_equal(table["x_m"], x.ravel())
        np.testing.assert_array_equal(table["y_m"], y.ravel())
        for name, values in grid.items():
            if values.ndim == 2:
                found = table[name if name in table.dtype.names else name + "_m"]
                np.testing.assert_array_equal(found.astype(values.dtype), values.ravel(), name)

    def test_gdal_counts_and_bounds(self):
        program("ogrinfo", "gdal-bin")
        points = returns_of(CHAIN.scan)
        path = self.export(CHAIN.scan, "scan.csv")
        text = output_of("ogrinfo", "-q", "-oo", "AUTODETECT_TYPE=YES", path, "-sql",
                         "SELECT COUNT(*) AS n, MIN(x_est_m) AS low, MAX(x_est_m) AS high FROM scan").decode()
        found = dict(line.strip().split(" = ") for line in text.splitlines() if " = " in line)
        self.assertEqual(int(found["n (Integer)"]), len(points["x_est"]))
        self.assert_close([float(found["low (Real)"]), float(found["high (Real)"])],
                          [points["x_est"].min(), points["x_est"].max()], 1e-12)

    def gmt_table(self, path, width):
        return np.frombuffer(output_of(program("gmt", "gmt"), "convert", "-h1", f"-bo{width}d", path)).reshape(-1, width)

    def test_gmt_reads_bounds_and_values(self):
        program("gmt", "gmt")
        points = xyz(returns_of(CHAIN.scan))
        path = self.export(CHAIN.scan, "scan.csv", "--columns", "x_est,y_est,z_est")
        words = output_of("gmt", "info", "-C", "-h1", path).split()
        expected = np.stack([points.min(axis=0), points.max(axis=0)], axis=1)
        self.assert_close([float(word) for word in words], expected.ravel(), 1e-9)
        self.assert_close(self.gmt_table(path, 3), points, 0)

    def test_gmt_reads_a_grid(self):
        grid = columns(CHAIN.dem, "/")
        x, y = np.meshgrid(grid["x"], grid["y"])
        expected = np.stack([layer.ravel() for layer in (x, y, grid["z_est"], grid["count"])], axis=1)
        self.assert_close(self.gmt_table(self.export(CHAIN.dem, "dem.csv", "--layers", "z_est,count"), 4), expected, 0)

    def test_standard_output_is_the_file(self):
        path = self.export(CHAIN.scan, "scan.csv", "--columns", "t,x_est", "-t", 1)
        result = self.succeed("landfall-export", CHAIN.scan, "-o", "-", "--format", "csv", "--columns", "t,x_est", "-t", 2)
        self.assertEqual(result.stdout.encode(), read_bytes(path))

    def test_a_closed_pipe_is_not_a_failure(self):
        with subprocess.Popen([tool("landfall-export"), CHAIN.scan, "-o", "-", "--format", "csv"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE) as process:
            self.assertTrue(process.stdout.readline().startswith(b"x_est_m,"))
            process.stdout.close()
            self.assertEqual(process.stderr.read(), b"")
            self.assertEqual(process.wait(60), 0)

    def test_a_full_disk_is_a_failure(self):
        with open("/dev/full", "wb") as full:
            result = subprocess.run([tool("landfall-export"), CHAIN.scan, "-o", "-", "--format", "csv"], stdout=full,
                                    stderr=subprocess.PIPE, timeout=60, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr, b"landfall-export: writing to standard output failed: No space left on device\n")


class PictureTest(ExportTest):
    def pixels(self, path):
        with Image.open(path) as image:
            self.assertEqual((image.format, image.mode), ("PNG", "RGB"))
            return np.asarray(image).astype(int)

    def test_every_kind_of_file_has_a_picture(self):
        plan = self.path("plan.h5")
        self.succeed("scan-sim", "-c", CHAIN.config("scan-sim"), "--plan", "--plan-radius", 5, "--plan-resolution", 0.5,
                     "-o", plan, "--json")
        for source in [CHAIN.terrain, CHAIN.scan, CHAIN.dem, CHAIN.eval, plan]:
            path = self.export(source, os.path.basename(source) + ".png")
            pixels = self.pixels(path)
            self.assertGreater(len(np.unique(pixels @ [65536, 256, 1])), 20, source)
            if shutil.which("gdal_translate"):
                bands = self.rasters(path)
                self.assertEqual(bands.dtype, np.uint8)
                np.testing.assert_array_equal(np.moveaxis(bands, 0, 2), pixels, source)

    def test_pixels_have_the_colours_of_their_bins(self):
        """Empty bins share one colour; the others are darker the more returns they hold."""
        pixels = self.pixels(self.export(CHAIN.dem, "count.png", "--layers", "count"))
        count = columns(CHAIN.dem, "/")["count"]
        inside = bins_of_picture(pixels, count.shape)
        empty = inside[count == 0]
        self.assertEqual(len(np.unique(empty, axis=0)), 1)
        # Counts are yellow to brown: the luminance decreases with the value.
        order = np.argsort(count.ravel(), kind="stable")
        light = (inside[..., :3] @ np.array([0.299, 0.587, 0.114])).ravel()[order]
        light = light[np.count_nonzero(count == 0):]
        self.assertTrue((np.diff(light) <= 0).all())


class ViewTest(ExportTest):
    def test_view_is_the_exported_picture_of_the_output(self):
        for name in ["terrain-gen", "scan-sim", "regrid", "dem-eval"]:
            output, view = self.path(name + ".h5"), self.path(name + ".png")
            self.succeed(name, *CHAIN.inputs(name), "-o", output, "--view", view)
            self.assertEqual(read_bytes(output), read_bytes(CHAIN.output(name)))
            self.assertEqual(read_bytes(view), read_bytes(self.export(output, name + "-again.png")))

    def test_pictures_need_no_gdal(self):
        """With a plugin that cannot be loaded, pictures are written, and only a GeoTIFF fails."""
        plugins = self.path("plugins")
        os.mkdir(plugins)
        self.write(os.path.join(plugins, "landfall-gdal.so"), "no library")

        def run_without_gdal(name, *arguments):
            result = subprocess.run([tool(name), *map(str, arguments)], capture_output=True, text=True, check=False,
                                    env={**os.environ, "LD_DEBUG": "files", "LANDFALL_PLUGIN_DIR": plugins})
            self.assertIn("libpng", result.stderr, "LD_DEBUG does not list the loaded libraries")
            self.assertNotIn("libgdal", result.stderr)
            return result

        dem, view, again = self.path("dem.h5"), self.path("dem.png"), self.path("again.png")
        self.assertEqual(run_without_gdal("regrid", *CHAIN.inputs("regrid"), "-o", dem, "--view", view).returncode, 0)
        self.assertEqual(run_without_gdal("landfall-export", dem, "-o", again).returncode, 0)
        self.assertEqual(read_bytes(view), read_bytes(again))
        geotiff = run_without_gdal("landfall-export", dem, "-o", self.path("dem.tif"))
        self.assertEqual(geotiff.returncode, 1)
        self.assertIn("cannot load the GDAL plugin", geotiff.stderr)

    def test_a_failed_run_writes_no_picture(self):
        scan = self.write("scan.h5", read_bytes(CHAIN.scan)[:5000])
        self.refuse(1, "regrid", scan, "-o", self.path("d.h5"), "--view", self.path("a.png"), output=self.path("a.png"))


if __name__ == "__main__":
    unittest.main()
