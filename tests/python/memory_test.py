#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall in memory: every array equals the dataset of the file that the tool writes, and so does each saved file."""
import gc
import json
import os
import tempfile
import threading
import unittest

import h5py
import numpy as np
import xarray

from harness import EVAL, HAZARD, REGRID, SCAN, TERRAIN, attributes, run, with_values, write_file
import landfall

RECEIVER = with_values(SCAN, receiver={"type": "leading_edge", "threshold_pe": 20, "returns": "all"}, link={"reference_pe": 500, "reference_range_m": 50})
SIGMAS = {"uncertainty": {"navigation_sigma": {"position_m": [0.05] * 3, "velocity_mps": [0.1] * 3, "rpy_rad": [2e-4] * 3, "rpy_rate_radps": [1e-3] * 3}}}
SAFE = with_values(HAZARD, limits__slope_deg=20)


def datasets(path):
    """{path: dataset's values, attributes and scales} of a file, without its history and the references of HDF5."""
    found = {}
    with h5py.File(path) as file:
        def visit(name, item):
            if isinstance(item, h5py.Dataset) and not name.startswith("provenance"):
                kept = {key: value for key, value in attributes(item).items() if key not in ("REFERENCE_LIST", "DIMENSION_LIST")}
                found[name] = (item[()], kept | {"scales": [list(scale) for scale in item.dims]})
        file.visititems(visit)
    return found


def in_two_threads(work):
    """Runs work(1) and work(2) at a time."""
    threads = [threading.Thread(target=work, args=(number,)) for number in (1, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


class Case:
    """The stages of one case by the tools, in files, and in memory."""

    def __init__(self, folder, scan=SCAN, terrain=TERRAIN, regrid=(), **options):
        self.folder = folder
        self.files = {name: os.path.join(folder, f"{name}.h5") for name in ("terrain", "scan", "dem", "eval", "hazards")}
        flags = ["--" + name for name in options]
        self.tool("terrain-gen", terrain, "-o", self.files["terrain"])
        self.tool("scan-sim", scan, "--terrain", self.files["terrain"], "-o", self.files["scan"])
        self.tool("regrid", REGRID | dict(regrid), self.files["scan"], "--terrain", self.files["terrain"], "-o", self.files["dem"], *flags)
        self.tool("dem-eval", EVAL, self.files["dem"], "-o", self.files["eval"])
        self.tool("hazard-map", SAFE, self.files["dem"], "--terrain", self.files["terrain"], "-o", self.files["hazards"])
        self.terrain = landfall.Terrain(terrain)
        self.scan = landfall.scan(scan, self.terrain)
        self.dem = landfall.grid(self.scan, self.terrain, REGRID | dict(regrid), **options)
        self.eval = landfall.evaluate(self.dem, EVAL)
        self.hazards = landfall.hazards(self.dem, SAFE, terrain=self.terrain)

    @staticmethod
    def tool(name, config, *arguments):
        done = run(name, "-c", "-", *arguments, stdin=json.dumps(config))
        if done.returncode != 0:
            raise AssertionError(done.stderr)


class InMemory(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory(prefix="landfall-memory-"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def assert_same_datasets(self, saved, expected):
        found, wanted = datasets(saved), datasets(expected)
        self.assertEqual(list(found), list(wanted))
        for name, (values, kept) in wanted.items():
            np.testing.assert_array_equal(found[name][0], values, name)
            self.assertEqual(found[name][0].dtype, values.dtype, name)
            self.assertEqual({key: str(value) for key, value in found[name][1].items()}, {key: str(value) for key, value in kept.items()}, name)

    def check(self, case):
        for stage, path in case.files.items():
            result = getattr(case, stage)
            for name, (values, _) in datasets(path).items():
                group, _, column = name.rpartition("/")
                if not values.shape or stage == "terrain" or group in ("holes", "detector") or (stage == "scan" and not group):
                    continue
                table = result if not group else {"points": case.scan.points, "pulses": case.scan.pulses, "sites": case.hazards.sites}.get(group)
                if table is not None and column in table:
                    found = np.asarray(table[column])
                    np.testing.assert_array_equal(found, values, name)
                    self.assertEqual(found.dtype, values.dtype, name)
            saved = self.path(f"saved-{stage}.h5")
            result.to_file(saved)
            result.to_file(saved, overwrite=True)
            self.assert_same_datasets(saved, path)
            self.assertEqual(run("landfall-info", "--check", saved).returncode, 0)
        if case.terrain.z is not None:
            np.testing.assert_array_equal(case.terrain.z, datasets(case.files["terrain"])["z"][0])

    def test_each_stage_equals_the_files_of_the_tools(self):
        for number, (name, options) in enumerate({
                "errors": {}, "uncertainty": {"uncertainty": True, "corrected": True, "regrid": SIGMAS}, "receiver": {"scan": RECEIVER},
                "median": {"regrid": {"method": "median"}},
                "mesh": {"terrain": {"mesh": {"path": self.mesh()}}}}.items()):
            with self.subTest(name), tempfile.TemporaryDirectory(prefix="landfall-memory-") as folder:
                self.folder = folder
                self.check(Case(folder, **options))

    def mesh(self):
        return write_file(os.path.join(self.folder, "ramp.obj"), "v -9 -9 0\nv 9 -9 0.5\nv 9 9 1\nv -9 9 0.3\nf 1 2 3\nf 1 3 4\n")

    def test_a_chain_equals_its_stages(self):
        chain = landfall.chain({"terrain": TERRAIN, "scan": SCAN, "regrid": REGRID, "eval": EVAL, "hazard": HAZARD})
        case = Case(self.folder)
        for name, (values, _) in datasets(case.files["dem"]).items():
            if values.ndim == 2:
                np.testing.assert_array_equal(np.asarray(chain.dem[name]), values, name)
        self.assertEqual(chain.evaluation.metrics, case.eval.metrics)
        self.assertIsNotNone(chain.hazards)

    def test_points_equal_their_import(self):
        random = np.random.default_rng(5)
        x, y, z = random.uniform(-2, 2, (3, 5000))
        text = self.path("points.xyz")
        np.savetxt(text, np.column_stack((x, y, z)), fmt="%.17g")
        self.assertEqual(run("landfall-import", text, "-o", self.path("scan.h5"), "--center", "0,0").returncode, 0)
        self.assertEqual(run("regrid", self.path("scan.h5"), "-o", self.path("dem.h5"), "--set", "half_width_m=2", "--set", "resolution_m=0.1").returncode, 0)
        dem = landfall.grid(x, y, z, config={"half_width_m": 2, "resolution_m": 0.1})
        for name in ("z_est", "count"):
            np.testing.assert_array_equal(np.asarray(dem[name]), datasets(self.path("dem.h5"))[name][0])
        wide = np.repeat(np.stack((x, y, z)), 2, axis=1)[:, ::2]
        self.assertFalse(wide.flags.c_contiguous)
        again = landfall.grid(*wide, config={"half_width_m": 2, "resolution_m": 0.1})
        np.testing.assert_array_equal(again.values("z_est"), dem.values("z_est"))

    def test_terrains_answer(self):
        terrain = landfall.Terrain(TERRAIN)
        x, y = np.linspace(-5, 5, 7), np.linspace(-4, 4, 7)
        z = terrain.elevation(x, y)
        origins, down = np.column_stack((x, y, np.full(7, 40.0))), np.tile([0.0, 0.0, -1.0], (7, 1))
        np.testing.assert_allclose(40 - terrain.first_hit(origins, down), z, atol=1e-9)
        self.assertTrue(np.isnan(terrain.elevation(1e3, 0)))
        again = landfall.Terrain.from_array(terrain.z, 0.1)
        np.testing.assert_array_equal(again.elevation(x, y), z)
        again.to_file(self.path("again.h5"))
        np.testing.assert_array_equal(landfall.Terrain(self.path("again.h5")).elevation(x, y), z)

    def test_an_array_has_the_site_of_points_at_the_same_place(self):
        points = self.path("points.xyz")
        for crs, place in {"EPSG:32632": (500123.5, 5200456.25), "EPSG:4326": (9.25, 47.5)}.items():
            np.savetxt(points, [[*place, 0]], fmt="%.17g")
            imported = self.path("scan.h5")
            self.assertEqual(run("landfall-import", points, "-o", imported, "-O", "--crs", crs, "--center", f"{place[0]},{place[1]}").returncode, 0)
            landfall.Terrain.from_array(np.zeros((4, 4)), 1, crs=crs, center=place).to_file(self.path("placed.h5"), overwrite=True)
            with h5py.File(imported) as expected, h5py.File(self.path("placed.h5")) as found:
                self.assertEqual(found["crs"].attrs["crs_wkt"], expected["crs"].attrs["crs_wkt"])

    @staticmethod
    def raster(y=(0, 1, 2)):
        coordinates = {name: (name, list(values), {"units": "m"}) for name, values in {"y": y, "x": (0, 1, 2)}.items()}
        return xarray.DataArray(np.arange(9.0).reshape(3, 3), dims=("y", "x"), coords=coordinates)

    def test_arrays_of_other_packages(self):
        """Masked elevations are holes; the coordinates of an xarray agree with the order of its rows."""
        masked = landfall.Terrain.from_array(np.ma.masked_equal([[0, 1, 2], [3, -9999, 5], [6, 7, 8]], -9999), 1)
        np.testing.assert_array_equal(masked.z, [[0, 1, 2], [3, np.nan, 5], [6, 7, 8]])
        self.assertEqual(landfall.Terrain.from_array(self.raster(), 1).elevation(0, 1), 7)

    def test_a_raster_becomes_a_terrain(self):
        raster = os.path.join(os.environ["LANDFALL_ROOT"], "testdata/rasters/relief_europa_10m.tif")
        config = {"base": {"type": "dem", "path": raster}, "grid": {"half_width_m": 20, "resolution_m": 1}}
        terrain = landfall.Terrain(config)
        self.assertEqual(run("terrain-gen", "-c", "-", "-o", self.path("raster.h5"), stdin=json.dumps(config)).returncode, 0)
        np.testing.assert_array_equal(terrain.z, datasets(self.path("raster.h5"))["z"][0])

    def test_a_lidar_equals_the_scan(self):
        terrain = landfall.Terrain(TERRAIN)
        scan = landfall.scan(SCAN, terrain, keep_misses=True)
        pulses = scan.pulses
        attitude = np.column_stack([pulses[f"q{axis}_true"] for axis in "wxyz"])
        position = np.column_stack([pulses[f"p{axis}_true"] for axis in "xyz"])
        lidar = landfall.Lidar(SCAN, terrain)
        records = lidar.pulses(np.arange(len(position)), position, attitude)
        for field, column in (("range_measured_m", "range_measured"), ("range_true_m", "range_true"), ("status", "status")):
            np.testing.assert_allclose(records[field].reshape(-1), scan[column], rtol=0, atol=1e-9, err_msg=field)
        np.testing.assert_allclose(records["estimated_m"][..., 2].reshape(-1), scan["z_est"], rtol=0, atol=1e-9)
        traced = landfall.Lidar(SCAN, terrain.first_hit)
        one = traced.pulse(3, position[3], attitude[3])
        for field in one.dtype.names:
            np.testing.assert_array_equal(one[field], records[3][field], field)
        masked = landfall.Lidar(SCAN, lambda origins, directions: np.ma.array(np.full(len(origins), 40.0), mask=True))
        self.assertTrue((masked.pulse(3, position[3], attitude[3])["status"] != 0).all())

    def test_arrays_outlive_their_results(self):
        z = landfall.Terrain(TERRAIN).z
        gc.collect()
        self.assertTrue(np.isfinite(z).all())
        with self.assertRaises(ValueError):
            z[0, 0] = 1

    def test_bad_input_is_refused_in_the_words_of_the_tools(self):
        terrain = landfall.Terrain(TERRAIN)
        huge = np.broadcast_to(0.0, 2**31)
        for text, call in {
                "/grid/half_width_m": lambda: landfall.Terrain({"grid": {"half_width_m": -1}}),
                "more than 2^31 - 1": lambda: landfall.grid(huge, huge, huge),
                "real numbers are expected": lambda: landfall.grid(*np.array([["a"], ["b"], ["c"]])),
                "1 dimensions are expected": lambda: landfall.grid(np.zeros((2, 2)), [1], [1]),
                "have 2, 1 and 1 values": lambda: landfall.grid([1, 2], [1], [1]),
                "is not finite": lambda: landfall.grid([np.nan, 0], [1, 0], [1, 0]),
                "(N, 3) is expected": lambda: terrain.first_hit(np.zeros((2, 2)), np.zeros((2, 2))),
                "unit vectors": lambda: terrain.first_hit(np.zeros((2, 3)), np.zeros((2, 3))),
                "crs and center belong together": lambda: landfall.Terrain.from_array(np.zeros((4, 4)), 1, crs="EPSG:32632"),
                "two finite numbers": lambda: landfall.Terrain.from_array(np.zeros((4, 4)), 1, crs="EPSG:32632", center=[1, np.nan]),
                "is geocentric": lambda: landfall.Terrain.from_array(np.zeros((4, 4)), 1, crs="EPSG:4978", center=[9, 47]),
                "'EPSG:1' is not a CRS": lambda: landfall.Terrain.from_array(np.zeros((4, 4)), 1, crs="EPSG:1", center=[9, 47]),
                "2 x 2 elevations": lambda: landfall.Terrain.from_array(np.zeros((1, 1)), 1),
                "not of type ndarray": lambda: landfall.evaluate(np.zeros((9, 9))),
                "a number is expected": lambda: landfall.Terrain.from_array(np.zeros((4, 4)), None),
                'a text such as "EPSG:32632" is expected': lambda: landfall.Terrain.from_array(np.zeros((4, 4)), 1, crs=32632, center=[5e5, 5e6]),
                "coordinate y does not increase": lambda: landfall.Terrain.from_array(self.raster(y=[2, 1, 0]), 1),
                "transpose it": lambda: landfall.Terrain.from_array(self.raster().transpose(), 1),
                "coordinate y has steps of 1 m": lambda: landfall.Terrain.from_array(self.raster(), 2),
                "a text holds a null character": lambda: landfall.evaluate("dem.h5\0"),
                "weight: no gridding": lambda: landfall.grid([1], [1], [1], weight=[1]),
                "resolution_m is missing": lambda: landfall.hazards(np.zeros((9, 9))),
                "not in [0, 4096]": lambda: landfall.Terrain(TERRAIN, threads=-1),
                "terrain's ranges: real numbers": lambda: landfall.Lidar(SCAN, lambda o, d: ["a"] * len(o)).pulse(0, [0, 0, 50], [1, 0, 0, 0]),
                "estimate: a pair": lambda: landfall.Lidar(SCAN, landfall.Terrain(TERRAIN)).pulse(0, [0, 0, 50], [1, 0, 0, 0], estimate=[]),
                "returned 1 ranges of 64": lambda: landfall.Lidar(SCAN, lambda o, d: [1.0]).pulse(0, [0, 0, 50], [1, 0, 0, 0]),
        }.items():
            with self.subTest(text), self.assertRaises(landfall.UsageError) as caught:
                call()
            self.assertIn(text, str(caught.exception))
        with self.assertRaisesRegex(landfall.DataError, "missing.h5"):
            landfall.scan(SCAN, self.path("missing.h5"))
        with self.assertRaisesRegex(ZeroDivisionError, "division"):
            landfall.Lidar(SCAN, lambda o, d: 1 / 0).pulse(0, [0, 0, 50], [1, 0, 0, 0])

    def test_threads_and_progress(self):
        terrain, found = landfall.Terrain(TERRAIN), {}
        def scan(number):
            found[number] = landfall.scan(SCAN, terrain, threads=number)["z_est"]
        in_two_threads(scan)
        np.testing.assert_array_equal(found[1], found[2])
        self.assertEqual(os.listdir(self.folder), [])

    def test_threads_run_side_by_side(self):
        """Each of two runs waits within its progress until the other has come as far."""
        terrain, meeting, found = landfall.Terrain(TERRAIN), threading.Barrier(2, timeout=300), {}
        long = with_values(SCAN, detector__rows=64, detector__columns=64)
        def scan(number):
            once = iter([meeting.wait])
            found[number] = landfall.scan(long, terrain, progress=lambda phase, fraction: next(once, int)())["z_est"]
        in_two_threads(scan)
        np.testing.assert_array_equal(found[1], found[2])

    def test_a_saved_file_is_not_replaced(self):
        terrain = landfall.Terrain(TERRAIN)
        terrain.to_file(self.path("t.h5"))
        with self.assertRaisesRegex(landfall.UsageError, "exists"):
            terrain.to_file(self.path("t.h5"))
        terrain.to_file(self.path("t.h5"), overwrite=True)


if __name__ == "__main__":
    unittest.main()
