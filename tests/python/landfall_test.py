#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The package landfall: the result of open() for each kind of file, its refusals, and what run() passes to the tools."""
import ast
import contextlib
import json
import os
import pathlib
import pickle
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest
from concurrent import futures
from unittest import mock

import h5py
import numpy as np

from harness import ROOT, read_bytes, write_file
import landfall
from landfall import command, files, tools
from landfall.study import results

BIN = os.path.abspath(os.environ["LANDFALL_BIN"])
GRID = {"grid": {"half_width_m": 4, "resolution_m": 0.1}, "features": [{"type": "cone", "x_m": 1, "radius_m": 1, "height_m": 0.5}]}
SCAN = {"laser": {"scan_time_s": 0.02}, "noise": {"range_sigma_m": 0.01},
        "scanner": {"pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 3}}}
REGRID = {"half_width_m": 2, "resolution_m": 0.1}
PYRAMID = "v 0 0 1\nv 1 -1 0\nv 1 1 0\nv -1 0 0\nf 1 2 3\nf 1 3 4\nf 1 4 2\n"


def python(text):
    """The output of a new python3 process."""
    return subprocess.run([sys.executable, "-c", f"import sys; sys.path.insert(0, {os.path.join(ROOT, 'python')!r}); {text}"],
                          capture_output=True, text=True, check=True).stdout


def pixels(path):
    import matplotlib.image

    return matplotlib.image.imread(path)


class Chain(unittest.TestCase):
    """Base class with files of the four tools, made by run()."""

    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="landfall-python-"))
        cls.enterClassContext(mock.patch.object(tools, "BIN", BIN))
        terrain, scan, dem = (cls.path(name) for name in ("terrain.h5", "scan.h5", "dem.h5"))
        landfall.run("terrain-gen", GRID, output=terrain).close()
        landfall.run("scan-sim", SCAN, terrain=terrain, output=scan).close()
        landfall.run("regrid", REGRID, scan, terrain=terrain, output=dem).close()
        landfall.run("dem-eval", {"region_radius_m": 1.5}, dem, output=cls.path("eval.h5"), metrics=cls.path("metrics.json")).close()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def changed(self, name, change):
        """A copy of a file after change(h5py.File)."""
        path = shutil.copy(self.path(name), self.path("changed.h5"))
        with h5py.File(path, "a") as file:
            change(file)
        return path

    def refused(self, path, words, **options):
        with self.assertRaises(landfall.DataError) as context:
            landfall.open(path, **options)
        self.assertTrue(str(context.exception).startswith(f"{path}: "), context.exception)
        self.assertIn(words, str(context.exception))


class Grids(Chain):
    def test_layers_have_units_names_and_the_crs_of_the_file(self):
        with landfall.open(self.path("dem.h5")) as dem, h5py.File(self.path("dem.h5")) as file:
            layers = [name for name in file if name not in ("x", "y", "crs") and isinstance(file[name], h5py.Dataset)]
            self.assertEqual(sorted(dem.data_vars), sorted(layers))
            for name in (*layers, "x", "y"):
                self.assertEqual(dem[name].attrs["units"], file[name].attrs["units"].decode())
                self.assertEqual(dem[name].attrs["long_name"], file[name].attrs["long_name"].decode())
                self.assertEqual(dem[name].dtype, file[name].dtype)
            self.assertEqual(dem["z_est"].dims, ("y", "x"))
            self.assertNotIn("grid_mapping", dem["z_est"].attrs)  # a local frame
            self.assertEqual(dem["z_est"].crs.attrs["crs_wkt"], file["crs"].attrs["crs_wkt"].decode())
            self.assertEqual(dem.attrs, files.attributes(file))
            self.assertTrue(np.isnan(dem["z_est"].encoding["_FillValue"]))
            np.testing.assert_array_equal(dem["z_est"], file["z_est"][()])

    def test_all_kinds_of_indices(self):
        with landfall.open(self.path("terrain.h5")) as terrain, h5py.File(self.path("terrain.h5")) as file:
            z = file["z"][()]
            np.testing.assert_array_equal(terrain.z[::-3, 5:2:-1], z[::-3, 5:2:-1])
            np.testing.assert_array_equal(terrain.z[[7, 3, 3], [1, 2]], z[[7, 3, 3]][:, [1, 2]])
            np.testing.assert_array_equal(terrain.z[-1], z[-1])
            self.assertAlmostEqual(float(terrain.z.sel(x=1, y=0, method="nearest")), 0.5)

    def test_values_are_read_on_access(self):
        """A damaged layer raises an error only when it is read; the message names the file and the layer."""
        def tear(file):
            del file["z_est"]
            layer = file.create_dataset("z_est", chunks=(8, 8), compression="gzip", data=np.ones((41, 41)))
            for dimension, name in enumerate("yx"):
                layer.dims[dimension].attach_scale(file[name])
            chunk = layer.id.get_chunk_info(0)
            self.torn = chunk.byte_offset, chunk.size
        path = self.changed("dem.h5", tear)
        with open(path, "r+b") as raw:
            raw.seek(self.torn[0])
            raw.write(b"\xff" * self.torn[1])
        with landfall.open(path) as dem:
            self.assertEqual(dem["z_est"][-1, -1], 1)
            self.assertEqual(dem["count"].shape, (41, 41))
            with self.assertRaisesRegex(landfall.DataError, "changed.h5: /z_est: "):
                dem["z_est"].load()

    def test_chunks_are_those_of_the_file(self):
        with landfall.run("scan-sim", SCAN, plan=True, output=self.path("plan.h5")) as plan:
            self.assertEqual(plan["count"].encoding["preferred_chunks"], {"y": 256, "x": 256})
            self.assertIn("coverage", json.loads(plan["plan_json"].item()))

    def test_draws_have_a_verdict(self):
        draws = landfall.run("monte-carlo", {"draws": 2, "regrid": REGRID, "eval": {"region_radius_m": 1.5}}, self.path("scan.h5"),
                             terrain=self.path("terrain.h5"), output=self.path("draws.h5"), verdict=self.path("verdict.json"))
        with draws:
            self.assertEqual(json.loads(draws["verdict_json"].item()), landfall.open(self.path("verdict.json")))

    def test_an_evaluation_has_metrics_and_holes(self):
        with landfall.open(self.path("eval.h5")) as evaluation:
            self.assertEqual(json.loads(evaluation["metrics_json"].item()), landfall.open(self.path("metrics.json")))
            self.assertEqual(list(evaluation["fail"].attrs["flag_masks"]), [1, 2, 4, 8, 16, 32])
        holes = landfall.open(self.path("eval.h5"), "holes")
        self.assertEqual(holes.units["first_x"], "m")

    def test_a_mesh_has_vertices_and_triangles(self):
        with landfall.run("terrain-gen", {"mesh": {"path": write_file(self.path("mesh.obj"), PYRAMID)}}, output=self.path("mesh.h5")) as mesh:
            self.assertEqual(dict(mesh.sizes), {"vertex": 4, "axis": 3, "triangle": 3, "corner": 3})
            self.assertEqual(mesh["vertices"].attrs["units"], "m")

    def test_copies_and_closing(self):
        dem = landfall.open(self.path("dem.h5"))
        copy = pickle.loads(pickle.dumps(dem))
        np.testing.assert_array_equal(copy["count"], dem.copy(deep=True)["count"])
        dem.close()
        with self.assertRaises(Exception):  # an exception of h5py: the file is closed
            dem["z_true"].load()

    def test_it_can_be_written_as_netcdf(self):
        with landfall.open(self.path("dem.h5")) as dem:
            dem.to_netcdf(self.path("dem.nc"), engine="netcdf4")
        with h5py.File(self.path("dem.nc")) as file:
            self.assertEqual(file["z_est"].attrs["units"], b"m")


class Tables(Chain):
    def test_columns_rows_and_units(self):
        with landfall.open(self.path("scan.h5")) as scan, h5py.File(self.path("scan.h5")) as file:
            points = {name: column[()] for name, column in file["points"].items()}
            self.assertEqual(scan.columns, tuple(points))
            self.assertEqual(list(scan), list(points))
            self.assertEqual(len(scan), len(points["pulse"]))
            self.assertIn("z_est", scan)
            self.assertEqual((scan.units["z_est"], scan.units["status"]), ("m", "1"))
            self.assertEqual(list(scan.attributes["status"]["flag_values"])[:2], [0, 1])
            self.assertEqual(scan.attrs["format_name"], "landfall.scan")
            self.assertEqual(scan.attrs["return_count"], len(scan))
            for rows in (slice(None), slice(10, 20), slice(-5, None), slice(3, 100, 7), slice(None, None, -1), slice(90, 10, -9),
                         slice(5, 5)):
                part = scan[rows]
                self.assertEqual(len(part), len(points["z_est"][rows]))
                np.testing.assert_array_equal(part["z_est"], points["z_est"][rows])
            np.testing.assert_array_equal(scan[10:100][::-2][3:]["pulse"], points["pulse"][10:100][::-2][3:])
            self.assertEqual(scan[["x_est", "pulse"]].columns, ("x_est", "pulse"))
            for name in ("z", 7):
                with self.assertRaisesRegex(KeyError, "no column"):
                    scan[name]  # pylint: disable=pointless-statement
            self.assertRegex(repr(scan), r"(?m)^<landfall Table> 129,600 rows, 11 columns\n(?s:.*)^  z_est +float64 +m +estimated z")

    def test_pandas_on_request(self):
        with landfall.open(self.path("scan.h5")) as scan:
            frame = scan[1000:2000:10][["pulse", "z_est"]].to_pandas()
            self.assertEqual(list(frame.columns), ["pulse", "z_est"])
            self.assertEqual((frame.index[0], frame.index[-1], len(frame)), (1000, 1990, 100))
            np.testing.assert_array_equal(frame["z_est"], scan["z_est"][1000:2000:10])
            self.assertEqual(frame.attrs["units"], {"pulse": "1", "z_est": "m"})

    def test_other_groups(self):
        pulses = landfall.open(self.path("scan.h5"), "pulses")
        self.assertEqual((len(pulses), pulses.units["t"]), (400, "s"))
        self.assertEqual(list(landfall.open(self.path("terrain.h5"), "features")["diameter"]), [2])

    def test_a_large_table_is_read_in_part(self):
        """One row in a thousand is read, of 12,960,000 rows of 11 columns, 1 GB."""
        path, rows = self.path("large.h5"), 12_960_000
        with h5py.File(path, "w") as file:
            file.attrs.update({"format_name": "landfall.scan", "format_version": "1.0", "complete": 1})
            for name in "abcdefghijk":
                column = file.create_dataset(f"points/{name}", (rows,), "f8", chunks=(65536,), compression="gzip", fillvalue=2.5)
                column.attrs["units"] = "m"
        peak = python(f"""import resource, landfall
scan = landfall.open({path!r})
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
part = scan[::1000].to_pandas()
assert len(scan) == {rows} and part.shape == ({rows // 1000}, 11) and (part == 2.5).all(axis=None), part
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)""")
        self.assertLess(int(peak), 200_000)  # kB, including pandas; one complete column would take 104,000

    def test_the_results_of_a_study(self):
        cases = {"title": "t", "axes": [{"name": "kind", "unit": ""}], "cases": []}
        rows = [(number, [kind], {"pass": 1, "accuracy.relative.z.max_m": number / 10}) for number, kind in enumerate("ab")]
        results.write_h5(results.Table(cases, rows), self.path("results.h5"), "test")
        table = landfall.open(self.path("results.h5"))
        self.assertEqual(table.columns, ("case", "kind", "pass", "accuracy.relative.z.max_m"))
        self.assertEqual(list(table["kind"]), ["a", "b"])
        self.assertEqual(table.units["accuracy.relative.z.max_m"], "m")
        self.assertEqual(table.to_pandas()["accuracy.relative.z.max_m"][1], 0.1)


class Refusals(Chain):
    def test_files_that_are_not_of_landfall(self):
        self.refused(self.path("none.h5"), "no such file")
        self.refused(self.folder, "is a directory")
        self.refused(write_file(self.path("note.txt"), "nothing"), "neither an HDF5 file nor JSON")
        self.refused(write_file(self.path("other.json"), '{"format": "other"}'), '"format" is not one of landfall.metrics')
        self.refused(self.changed("dem.h5", lambda file: file.attrs.modify("format_name", "other")), "is a other file")

    def test_damaged_and_unfinished_files(self):
        self.refused(self.changed("dem.h5", lambda file: file.attrs.modify("complete", 0)), "is incomplete")
        with open(self.path("dem.h5"), "rb") as whole, open(self.path("short.h5"), "wb") as file:
            file.write(whole.read()[:20000])
        self.refused(self.path("short.h5"), "truncated or damaged")

    def test_links_to_other_files(self):
        target = self.path("target")
        os.mkfifo(target)  # opening it would block
        self.addCleanup(os.remove, target)
        for name, kind in (("dem.h5", "z_est"), ("scan.h5", "points/z_est")):
            def link(file, kind=kind):
                del file[kind]
                file[kind] = h5py.ExternalLink(target, "/z")
            self.refused(self.changed(name, link), f"/{kind} is a link to another file, {target}")

    def test_a_filter_loads_no_plug_in(self):
        """Neither with the check, which refuses the filter, nor without it. 32001 is Blosc's filter."""
        folder = tempfile.mkdtemp(dir=self.folder)
        library, loaded = os.path.join(folder, "libblosc.so"), os.path.join(folder, "loaded")
        subprocess.run(["cc", "-shared", "-fPIC", "-x", "c", "-", "-o", library], text=True, check=True, input=f"""#include <fcntl.h>
__attribute__((constructor)) static void mark(void) {{ open("{loaded}", O_CREAT | O_WRONLY, 0600); }}""")

        def filtered(file):
            properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            properties.set_chunk((4,))
            properties.set_filter(32001, h5py.h5z.FLAG_OPTIONAL, (2,))
            space = h5py.h5s.create_simple((4,))
            h5py.h5d.create(file.id, b"extra", h5py.h5t.IEEE_F64LE, space, properties).write_direct_chunk((0,), b"12345678")
        path = self.changed("scan.h5", filtered)
        self.refused(path, "/extra is stored by filter 32001")
        read = f"import h5py; h5py.File({path!r})['extra'][()]"
        with mock.patch.dict(os.environ, {"HDF5_PLUGIN_PATH": folder}):
            python(f"import contextlib\nwith contextlib.suppress(OSError):\n  {read}")
            self.assertTrue(os.path.exists(loaded))  # without landfall the library is loaded
            os.remove(loaded)
            python(f"import landfall, contextlib\nscan = landfall.open({path!r}, check=False)\nwith contextlib.suppress(OSError):\n  {read}")
        self.assertFalse(os.path.exists(loaded))

    def test_a_missing_tool_leaves_no_file_unchecked(self):
        with mock.patch.object(tools, "BIN", self.folder), mock.patch.dict(os.environ, {"PATH": "/nowhere"}):
            with self.assertRaisesRegex(landfall.Error, "dem.h5: cannot be checked: .*landfall-info: no such program.*LANDFALL_BIN"):
                landfall.open(self.path("dem.h5"))
            landfall.open(self.path("dem.h5"), check=False).close()

    def test_a_name_that_begins_with_a_dash(self):
        shutil.copy(self.path("dem.h5"), self.path("-O.h5"))
        with contextlib.chdir(self.folder):
            landfall.open("-O.h5").close()

    def test_messages_can_be_printed(self):
        for name, shown in (("no\x1b[31m.h5", "no\\u001b[31m.h5"), ("a\u202e5h.", "a\\u202e5h."), ("a\nb", "a\\u000ab"), ("\udcff", "\\xff"),
                            ("Höhe.h5", "Höhe.h5")):
            for error in (landfall.DataError(name), landfall.UsageError(name)):
                self.assertEqual(str(error), shown)
        self.assertEqual(str(landfall.ToolError("a: \x1b\nb", 2)), "a: \\u001b\nb")
        with self.assertRaises(landfall.DataError) as context:
            landfall.open(self.path("no\x1b[31m.h5"))
        self.assertEqual(str(context.exception), self.path("no\\u001b[31m.h5") + ": no such file")

    def test_groups_and_columns(self):
        self.refused(self.path("scan.h5"), "has no group holes", group="holes")
        self.refused(self.path("scan.h5"), "has no group points/z_est", group="points/z_est")
        self.refused(self.path("dem.h5"), "provenance: no columns", group="provenance")

        def shorten(file):
            del file["points/z_est"]
            file["points/z_est"] = np.zeros(3)
        self.refused(self.changed("scan.h5", shorten), "points: columns of different lengths")

    def test_a_missing_package_is_named(self):
        for package, use in (("xarray", lambda: landfall.open(self.path("dem.h5"))),
                             ("pandas", lambda: landfall.open(self.path("scan.h5")).to_pandas())):
            with mock.patch.dict(sys.modules, {package: None}), \
                    self.assertRaisesRegex(landfall.Error, f"^the Python package {package} is missing: apt-get install python3-{package}$"):
                use()

    def test_the_import_loads_no_other_package(self):
        heavy = "h5py", "numpy", "matplotlib", "xarray", "pandas", "json", "subprocess"
        self.assertEqual(python(f"import landfall; print([name for name in {heavy} if name in sys.modules])"), "[]\n")
        self.assertNotIn("xarray", python(f"import landfall; landfall.open({self.path('scan.h5')!r}); print(*sys.modules)").split())


class Runs(Chain):
    def stub(self, text):
        """A tool that writes its arguments and standard input to a file, and then runs the given commands."""
        folder = tempfile.mkdtemp(dir=self.folder)
        path = write_file(os.path.join(folder, "scan-sim"), f"#!/bin/bash\n{{ printf '%s\\n' \"$@\"; echo --; cat; }} > '{folder}/got'\n{text}\n")
        os.chmod(path, 0o755)
        return folder

    def passed_to_tool(self, *arguments, **options):
        """The (arguments, standard input) that a tool gets."""
        folder = self.stub("exit 0")
        with mock.patch.object(tools, "BIN", folder):
            landfall.run("scan-sim", *arguments, **options)
        words, _, text = read_bytes(os.path.join(folder, "got")).decode().partition("--\n")
        return words.splitlines(), text

    def test_options(self):
        self.assertEqual(self.passed_to_tool(None, "a.h5", "b.h5", keep_misses=True, threads=2, layers=["z_est", "count"], plan=False, seed=None,
                                     set={"noise.range_sigma_m": 0.1, "mount": {"rpy_deg": [0, 0, 0]}, "scanner.type": "fsm"})[0],
                         ["a.h5", "b.h5", "--keep-misses", "--threads", "2", "--layers", "z_est,count", "--set", "noise.range_sigma_m=0.1",
                          "--set", 'mount={"rpy_deg": [0, 0, 0]}', "--set", 'scanner.type="fsm"'])

    def test_configurations(self):
        self.assertEqual(self.passed_to_tool({"seed": np.int32(2), "t": np.array([0.5])}), (["-c", "-"], '{"seed": 2, "t": [0.5]}'))
        self.assertEqual(self.passed_to_tool("paper"), (["-c", "preset:paper"], ""))
        with self.assertRaisesRegex(landfall.ToolError, "preset:papers: there is no such preset; did you mean preset:paper"):
            landfall.run("scan-sim", "papers")
        for path in ("missing.json", self.path("terrain.h5"), "folder/paper", "preset:paper"):
            self.assertEqual(self.passed_to_tool(path)[0], ["-c", path])
        with landfall.run("scan-sim", "flash-256", plan=True, output=self.path("flash.h5"), set={"laser.scan_time_s": 0.1}) as plan:
            self.assertEqual(plan.attrs["format_name"], "landfall.plan")

    def test_the_chain_is_a_command_too(self):
        for name in ("landfall run", "landfall-run"):
            resolved = json.loads(landfall.run(name, {"scan": ["preset:paper", {"seed": 7}]}, print_config=True))
            self.assertEqual(resolved["scan"]["seed"], 7)

    def test_several_configurations_are_merged_in_order(self):
        words, text = self.passed_to_tool(["paper", {"seed": 2}, "mine.json"])
        self.assertEqual((words, text), (["-c", "preset:paper", "-c", "-", "-c", "mine.json"], '{"seed": 2}'))
        merged = landfall.run("scan-sim", ["paper", {"noise": {"range_sigma_m": 0.5}}, {"noise": {"range_sigma_m": 0.03}}, {"noise": {"dropout_frac": 0.1}}],
                              print_config=True)
        noise = json.loads(merged)["noise"]
        self.assertEqual((noise["range_sigma_m"], noise["dropout_frac"]), (0.03, 0.1))
        with self.assertRaises(landfall.ToolError) as context:
            landfall.run("scan-sim", ["paper", {}, {"zzzzzzzz": 1}], check=True)
        self.assertIn("scan-sim: preset:paper + configuration 2 + configuration 3: /zzzzzzzz: unknown key", str(context.exception))
        with self.assertRaisesRegex(landfall.ToolError, r"\Aregrid: the configuration: /resolution_m: -1 is not in \(0, 1e9\]\Z"):
            landfall.run("regrid", {"resolution_m": -1}, check=True)

    def test_every_error_is_of_the_package(self):
        for words, call in [("a configuration is a dict, the path of a JSON file or the name of a preset, not of type int", lambda: landfall.run("scan-sim", 3)),
                            ("an input is a path, not of type list", lambda: landfall.run("regrid", None, ["a.h5"], output="x.h5")),
                            ("output is a path, not of type int", lambda: landfall.run("regrid", None, "a.h5", output=3)),
                            ("a value of type set, which JSON does not have", lambda: landfall.run("scan-sim", {"seed": {1}}))]:
            with self.assertRaisesRegex(landfall.UsageError, words):
                call()

    def test_the_numbers_of_a_judge_are_a_dict(self):
        config, dem = {"region_radius_m": 1.5}, self.path("dem.h5")
        printed = landfall.run("dem-eval", config, dem, metrics_only=True)
        written = landfall.run("dem-eval", config, dem, metrics_only=True, metrics=self.path("again.json"))
        self.assertEqual(printed, written)
        self.assertEqual(printed["accuracy"], landfall.open(self.path("metrics.json"))["accuracy"])
        sites = landfall.run("hazard-map", {"region_radius_m": 1.2, "sites": {"divert_radius_m": 1}}, dem, sites=self.path("sites.json"))
        self.assertEqual(sites["format"], "landfall.sites")

    def test_the_result_is_opened(self):
        with landfall.open(self.path("scan.h5")) as scan:
            self.assertGreater(scan["z_est"].std(), 0.009)
        self.assertIn("dem", landfall.run("landfall-info", None, self.path("dem.h5")))
        points = self.path("points.csv")
        self.assertEqual(landfall.run("landfall-export", None, self.path("scan.h5"), output=points, columns=["pulse", "z_est"]), points)
        self.assertTrue(os.path.exists(points))

    def test_a_failure_has_the_tool_s_message_and_exit_code(self):
        for code, words, call in [
                (1, "regrid: none.h5: ", lambda: landfall.run("regrid", None, "none.h5", output=self.path("x.h5"))),
                (2, 'did you mean "half_width_m"', lambda: landfall.run("regrid", {"half_width": 5}, "a.h5", output=self.path("x.h5"))),
                (2, "exists", lambda: landfall.run("terrain-gen", GRID, output=self.path("dem.h5"))),
                (3, "missed or not judged", lambda: landfall.run("dem-eval", {"region_radius_m": 1.5, "limits": {"relative_elevation_m": 0}},
                                                                  self.path("dem.h5"), output=self.path("y.h5"), require_pass=True))]:
            with self.assertRaises(landfall.ToolError) as context:
                call()
            self.assertIn(words, str(context.exception))
            self.assertEqual(context.exception.exit_code, code)

    def test_warnings_reach_standard_error(self):
        folder = self.stub("echo 'scan-sim: warning: so' >&2; echo text")
        with mock.patch.object(tools, "BIN", folder), mock.patch("sys.stderr") as stream:
            self.assertEqual(landfall.run("scan-sim"), "text\n")
        stream.write.assert_called_with("scan-sim: warning: so\n")

    def test_tools_are_found_beside_the_package_and_on_path(self):
        beside, elsewhere = self.stub("exit 0"), self.stub("exit 0")
        with mock.patch.dict(os.environ, PATH=elsewhere), mock.patch.object(tools, "BIN", beside):
            self.assertEqual(tools.find("scan-sim"), os.path.join(beside, "scan-sim"))
            self.assertEqual(tools.find("scan-sim", elsewhere), os.path.join(elsewhere, "scan-sim"))
            with mock.patch.object(tools, "BIN", "/nowhere"):
                self.assertEqual(tools.find("scan-sim"), os.path.join(elsewhere, "scan-sim"))
                with self.assertRaisesRegex(landfall.ToolError, "/nowhere/regrid: no such program, and none on PATH"):
                    landfall.run("regrid")


class Figures(Chain):
    def test_a_file_its_path_and_the_command_have_one_figure(self):
        path, png = self.path("dem.h5"), self.path("dem.png")
        subprocess.run([os.path.join(ROOT, "python", "commands", "plot_dem.py"), path, "-o", png, "-O", "--dpi", "100", "--limit-m", "0.03"], check=True,
                       capture_output=True)
        expected = pixels(png)
        with landfall.open(path) as dem:
            for source in (path, pathlib.Path(path), dem):
                figure = landfall.plot.dem(source, limit_m=0.03)
                figure.savefig(self.path("again.png"), dpi=100)
                np.testing.assert_array_equal(pixels(self.path("again.png")), expected)

    def test_each_kind_of_file(self):
        import matplotlib.pyplot as plt

        path = self.path("dem.h5")
        hazards = self.path("hazards.h5")
        landfall.run("hazard-map", {"region_radius_m": 1.2, "sites": {"divert_radius_m": 1}}, path, output=hazards, overwrite=True)
        before = dict(plt.rcParams)
        figures = [landfall.plot.terrain(self.path("terrain.h5")), landfall.plot.profile(path, (0, 0), (1, 1)), landfall.plot.compare(path, path),
                   landfall.plot.hazards(hazards, dem=path),
                   *(landfall.plot.evaluation(self.path("eval.h5"), name) for name in ("verdict", "coverage", "elevation_error", "accuracy"))]
        self.assertEqual({type(figure).__name__ for figure in figures}, {"Figure"})
        self.assertEqual((dict(plt.rcParams), plt.get_fignums()), (before, []), "a figure leaves pyplot as it is")

    def test_data_of_other_programs(self):
        """Imported points and a rectangular raster have no truth, poses or pulses."""
        points, raster = self.path("points.csv"), self.path("own.asc")
        x, y = np.random.default_rng(1).uniform(-2, 2, (2, 4000))
        np.savetxt(points, np.column_stack([x, y, x / 8]), delimiter=",", header="x,y,z", comments="")
        with open(raster, "w", encoding="ascii") as file:
            file.write("ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 0.2\n")
            np.savetxt(file, np.arange(600).reshape(20, 30) / 1e4)
        scan = self.path("imported.h5")
        with landfall.run("landfall-import", None, points, output=scan, center="0,0", quiet=True) as table:
            self.assertEqual((table.columns, len(table)), (("x_est", "y_est", "z_est", "status"), 4000))
        with self.assertRaisesRegex(landfall.DataError, "has no group pulses"):
            landfall.open(scan, group="pulses")
        name, evaluation, hazards = (self.path(f"own{part}.h5") for part in ("", "-eval", "-hazards"))
        landfall.run("landfall-import", None, raster, output=name, quiet=True).close()
        landfall.run("dem-eval", {"region_radius_m": 1.2, "footprint_m": 0.6}, name, output=evaluation).close()
        landfall.run("hazard-map", {"region_radius_m": 1, "lander": {"leg_radius_m": 0.4, "body_radius_m": 0.5}}, name, output=hazards).close()
        figures = [landfall.plot.dem(name), landfall.plot.profile(name, (-1, 0), (1, 0.5)), landfall.plot.compare(name, name),
                   landfall.plot.evaluation(evaluation), landfall.plot.hazards(hazards, dem=name)]
        self.assertEqual({type(figure).__name__ for figure in figures}, {"Figure"})

    def test_the_verdict_of_a_figure_is_that_of_the_table(self):
        from landfall.plot import plot_eval

        for verdicts, has_elevations, expected in ((["pass", "FAIL", "not judged"], False, "FAIL"), (["pass", "pass"], True, "pass"),
                                                   (["pass", "not judged"], False, "not judged, the DEM has no truth"),
                                                   (["pass", "not judged"], True, "not judged, the DEM has no true positions")):
            self.assertEqual(plot_eval.overall(verdicts, has_elevations), expected)

    def test_what_a_figure_would_not_show_is_refused(self):
        with landfall.open(self.path("dem.h5")) as dem:
            dem["z_est"] = dem.z_est + 1
            with self.assertRaisesRegex(landfall.UsageError, "z_est was changed since .*dem.h5 was opened"):
                landfall.plot.dem(dem)
        with landfall.open(self.path("dem.h5")) as dem:
            dem.z_est.load()
            landfall.plot.dem(dem)
            with self.assertRaisesRegex(landfall.UsageError, "was changed"):
                landfall.plot.dem(dem.isel(x=slice(5, None)))
        for words, call in [("not a dict", lambda: landfall.plot.dem({})), ("--limit-m: -1 is not a positive length", lambda: landfall.plot.dem("d.h5", limit_m=-1)),
                            ("this evaluation has verdict, coverage", lambda: landfall.plot.evaluation(self.path("eval.h5"), "all"))]:
            with self.assertRaisesRegex(landfall.UsageError, words):
                call()


class Outputs(unittest.TestCase):
    def test_a_file_is_on_the_disk_before_it_has_its_name(self):
        calls = []
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(os, "fsync", lambda _: calls.append("synced")), \
                mock.patch.object(os, "replace", lambda *_: calls.append("named")):
            command.write_whole(os.path.join(folder, "a.txt"), lambda name: pathlib.Path(name).write_text("text", encoding="utf-8"))
            self.assertEqual(os.listdir(folder), [])
        self.assertEqual(calls, ["synced", "named"])

    def test_threads_that_write_one_file(self):
        """Both have written before either renames."""
        both = threading.Barrier(2, timeout=60)

        def write_to(name):
            pathlib.Path(name).write_text("text", encoding="utf-8")
            both.wait()
        with tempfile.TemporaryDirectory() as folder, futures.ThreadPoolExecutor(2) as pool:
            path = os.path.join(folder, "a.txt")
            for written in [pool.submit(command.write_whole, path, write_to) for _ in range(2)]:
                written.result()
            self.assertEqual((os.listdir(folder), pathlib.Path(path).read_text(encoding="utf-8")), (["a.txt"], "text"))


def imports(path):
    """The modules of landfall that a file imports, also within functions, as names of modules."""
    nodes = list(ast.walk(ast.parse(read_bytes(path).decode())))
    plain = [name.name for node in nodes if isinstance(node, ast.Import) for name in node.names]
    members = [(node.module, f"{node.module}.{name.name}") for node in nodes if isinstance(node, ast.ImportFrom) for name in node.names]
    return {name for name in [*plain, *(name for pair in members for name in pair)] if name.startswith("landfall")}


def modules_and_imports():
    """{module: the modules that it imports}, without the package itself, whose functions import what they call."""
    modules = {}
    for folder, _, names in os.walk(os.path.join(ROOT, "python", "landfall")):
        for name in names:
            path = os.path.join(folder, name)
            module = os.path.relpath(path, os.path.join(ROOT, "python"))[:-3].replace(os.sep, ".").removesuffix(".__init__")
            if name.endswith(".py") and module != "landfall":
                modules[module] = imports(path)
    return {module: found & modules.keys() for module, found in modules.items()}


class Modules(unittest.TestCase):
    ROOMS = ["landfall", "landfall.plot", "landfall.study", "landfall.answers"]

    def test_no_module_imports_itself_through_others(self):
        left = modules_and_imports()
        self.assertGreater(len(left), 40)
        while ready := [module for module, found in left.items() if not found & left.keys()]:
            for module in ready:
                del left[module]
        self.assertEqual(sorted(left), [], "these import each other in a circle")

    def test_rooms_import_those_above_them(self):
        """landfall.model is the public name of the room answers."""
        found = modules_and_imports()
        self.assertEqual(found.pop("landfall.model"), {"landfall.answers.model"})
        arrows = {(self.room(module), self.room(other)) for module, others in found.items() for other in others}
        self.assertIn(("landfall.answers", "landfall.study"), arrows)
        self.assertEqual([arrow for arrow in arrows if self.ROOMS.index(arrow[0]) < self.ROOMS.index(arrow[1])], [])

    def room(self, module):
        return module if module in self.ROOMS else module.rpartition(".")[0]


if __name__ == "__main__":
    unittest.main()
