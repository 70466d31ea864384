#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""terrain-gen on the rasters and meshes of testdata/ and on the real ones in the folder LANDFALL_DATA: each file loads with
the values that another reader gives, or is refused with a reason, quickly and in little memory. The tables of testdata/terrain-files.md
name the files, their options and the results.

usage: raster_files_test.py [--write]   --write updates the results
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import h5py
import netCDF4
import numpy as np

import raster_readers as readers
from harness import ROOT, SANITIZED, ToolTest, fork, read_bytes, tool, without_warnings, write_file
import landfall
from raster_readers import Cells, Degrees, Rotated

TESTDATA = os.path.join(ROOT, "testdata")
DATA = os.environ.get("LANDFALL_DATA", os.path.join(ROOT, "..", "shared", "data"))
TABLE = os.path.join(ROOT, "testdata", "terrain-files.md")
LIMIT_S, LIMIT_MB = (60, 5000) if SANITIZED else (2, 500)
MESHES = (".obj", ".off", ".ply", ".stl")
EXACT = ["--interpolation", "nearest", "--datum", "none"]

VALUES = np.arange(1, 36, dtype=np.int16).reshape(5, 7)


def nodata(value, read):
    def values(path):
        found = read(path)
        return np.where(found == value, np.nan, found)
    return values


def scaled(factor, read):
    return lambda path: factor * read(path)


def equidistant(pixel):
    """The site around a pixel of the raster of Gale, a map of degrees in metres of the equator."""
    radius, corner = 3396190.0, (8142406.5, -276455.5)
    step = np.degrees(1 / radius)
    first = np.degrees(np.array(corner) / radius)
    return Degrees((first[0] + pixel[0] * step, first[1] - pixel[1] * step), radius, step, tuple(first), 10**9)


def mola(_):
    return readers.raw(os.path.join(DATA, "dem/mars_mola_megt90n000cb_be_int16.img"), ">i2", (720, 1440))


def tiles(path):
    return np.hstack([readers.tiff(os.path.join(os.path.dirname(path), name)) for name in ("tile_west.tif", "tile_east.tif")])


# How another reader than GDAL sees the rasters that load: its values, the pixels of the site's nodes, a relative tolerance.
READERS = {
    "rasters/big_endian_int16.tif": (readers.tiff, Cells((15, 10), 1)),
    "rasters/cell.dt0": (readers.dted, Degrees((9.6, 43.7), 6378137, 1 / 120, (9, 44), 43200, 1 / 298.257223563)),
    "rasters/float16.tif": (readers.tiff, Cells((10, 10), 60)),
    "rasters/gmt_holes.grd": (readers.gmt_grid, Cells((15, 15), 111195 / 3)),
    "rasters/grey_8bit.png": (scaled(0.25, readers.pillow), Cells((16, 16), 2)),
    "rasters/latlon_scaled_int16.tif": (lambda path: 0.5 * nodata(-32768, readers.tiff)(path) + 200,
                                        Degrees((30, 0.5), 1737400, 0.05, (28, 2), 7200)),
    "rasters/mars_big_endian.vrt": (lambda path: readers.raw(path.replace(".vrt", ".img"), ">i2", (36, 72)),
                                    Degrees((-133.8, 18.65), 3396190, 5, (2.5, 87.5), 72)),
    "rasters/mosaic.vrt": (tiles, Cells((20, 15), 10)),
    "rasters/nan_nodata_deflate.tif": (readers.tiff, Cells((6, 5), 1)),
    "rasters/nodata_no_crs.asc": (readers.ascii_grid, Cells((11, 9), 1)),
    "rasters/nonsquare_int16.tif": (readers.tiff, Cells((25, 20), 150, 225)),
    "rasters/polar_stereographic.tif": (readers.tiff, Cells((16, 16), 2.5)),
    "rasters/relief_europa_10m.tif": (readers.tiff, Cells((52, 52), 10)),
    "rasters/relief_moon_1m.tif": (readers.tiff, Cells((64, 64), 1)),
    "rasters/rotated.tif": (readers.tiff, Rotated((22, 22), (3, 4), (4, -3))),
    "rasters/south_up.tif": (readers.tiff, Cells((25, 20), 5, -5)),
    "rasters/three_bands_minus_inf.tif": (nodata(-np.inf, lambda path: readers.tiff(path)[:, :, 1]), Cells((12, 10), 1)),
    "rasters/tile_east.tif": (readers.tiff, Cells((10, 15), 10)),
    "rasters/tile_west.tif": (readers.tiff, Cells((10, 15), 10)),
    "rasters/vicar_int16.vic": (readers.vicar, Cells((10, 7), 1)),
    "dem/earth_bijou_gully_5m.asc": (readers.ascii_grid, Cells((52, 38), 4.988744589)),
    "dem/earth_relief_20arcmin_holes.grd": (readers.gmt_grid, Cells((15, 15), 111195 / 3)),
    "dem/earth_sthelens_nodata_int16_nonsquare.dem": (nodata(-32767, readers.tiff), Cells((32, 32), 9810 / 65, 216)),
    "dem/europa_e26_terminator_10m.tif": (readers.tiff, Cells((256, 256), 10)),
    "dem/mars_gale_hirise_1m.tif": (readers.tiff, equidistant((173, 168))),
    "dem/mars_mola_megt90n000cb.vrt": (mola, Degrees((-133.8, 18.65), 3396000, 0.25, (0.125, 89.875), 1440)),
    "dem/moon_apollo15_nac_2m_8bit.png": (scaled(0.192, readers.pillow), Cells((128, 128), 2), 1e-12),
    "dem/moon_lola_global_int16_scale0.5_latlon.tif": (scaled(0.5, nodata(-32768, readers.pillow)), Degrees(
        (-157, 5.4), 1737400, 0.3515625, (-180 + 0.17578125, 90 - 0.17578125), 1024)),
    "dem/moon_npole_2m4_80m.tif": (readers.tiff, Cells((16, 16), 2.426609848484849)),
    "unusual/float16.tif": (readers.tiff, Cells((10, 10), 60)),
    "unusual/nan32_nodata.tif": (readers.tiff, Cells((5, 5), 1)),
    "unusual/nodata_float.asc": (readers.ascii_grid, Cells((2, 2), 60)),
    "unusual/test_nodatavalues.tif": (nodata(0, lambda path: readers.tiff(path)[:, :, 1]), Cells((25, 25), 1)),
    "unusual/vicar_bigendian_int16.vic": (readers.vicar, Cells((2, 1), 1)),
}
# Values with which malformed rasters are read: no grid, a small and a large site; with and without a scale. Each file takes every one of
# both, in other pairs than the file before it; every second pair is at a corner.
SITES = [{}, {"grid": {"half_width_m": 1, "resolution_m": 1}}, {"grid": {"half_width_m": 60, "resolution_m": 0.05}}]
SCALES = [{}, {"horizontal_scale_m": 1}, {"horizontal_scale_m": 1000}]
CORNER = {"center_pixel": [2, 2], "datum": "none", "interpolation": "nearest"}
COLUMNS = """
| file | what it is | outcome | how, or why not | s | MB |
|---|---|---|---|---|---|
"""


class Run:
    """One run of terrain-gen with its time on the processor and an upper bound of its peak memory (it includes that of the fork)."""

    def __init__(self, *arguments):
        with subprocess.Popen([tool("terrain-gen"), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as process:
            self.stderr = without_warnings("terrain-gen", process.stderr.read())
            process.returncode = self.wait_for(process.pid)

    def wait_for(self, process):
        _, status, usage = os.wait4(process, 0)
        self.code = os.waitstatus_to_exitcode(status)
        self.seconds = usage.ru_utime + usage.ru_stime  # of the processor, which no other load lengthens
        self.megabytes = usage.ru_maxrss * 1024 / 1e6
        return self.code


class Forked(Run):
    """A terrain in memory, in a fork of this process, which need not load GDAL again."""

    def __init__(self, config):  # pylint: disable=super-init-not-called
        with tempfile.TemporaryFile("w+", encoding="utf-8") as said:
            process = fork()
            if process == 0:
                code = 86
                try:
                    landfall.Terrain(config)
                except landfall.Error as error:
                    print("terrain-gen:", error, file=said, flush=True)
                    code = error.exit_code
                finally:
                    os._exit(code)
            self.wait_for(process)
            said.seek(0)
            self.stderr = said.read()


def sections():
    """{title: text} of the page's sections; the head of the page has an empty title."""
    head, *rest = re.split(r"^## (.*)\n", read_bytes(TABLE).decode(), flags=re.M)
    return {"": head.rstrip() + "\n"} | {title: text.rstrip() + "\n" for title, text in zip(rest[::2], rest[1::2])}


def read_table(title):
    """The cells of the rows of a section's table."""
    return [line[2:-2].split(" | ") for line in sections()[title].removeprefix(COLUMNS).splitlines()]


def write_table(title, rows):
    tables = {**sections(), title: COLUMNS + "".join(f"| {' | '.join(cells)} |\n" for cells in rows)}
    write_file(TABLE, "\n".join((f"## {name}\n" if name else "") + text for name, text in tables.items()))


class Folder:
    """The files of one folder, and the section of the page that lists them."""

    data, title = "", ""

    def run_file(self, name, options, output="site.h5"):
        path = self.path(output)
        result = Run("--from", os.path.join(self.data, name), "-O", "-o", path, *options.split())
        return result, path

    def check_refused(self, name, options, result):
        """Checks that a file is refused; returns the reason without the start of the message."""
        message = f"{name} {options}: {result.stderr}"
        self.assertIn(result.code, (1, 2), message)
        start = f"terrain-gen: {os.path.join(self.data, name)}: "
        self.assertTrue(result.stderr.startswith(start), message)
        self.assertRegex(result.stderr, r"\A[^\n]+\n\Z")
        self.assertEqual(self.entries(), [], message)
        self.assertLess(result.seconds, LIMIT_S, message)
        self.assertLess(result.megabytes, LIMIT_MB, message)
        return result.stderr[len(start):].strip().replace(self.data + os.sep, "")

    def check_loaded(self, name, options):
        """Compares every node with the other reader; returns the run and a description of the nodes."""
        values, pixels, *tolerance = READERS[name]
        result, path = self.run_file(name, " ".join([options, *EXACT]))
        self.assertEqual((result.code, result.stderr), (0, ""), name)
        with h5py.File(path) as file:
            x, y, z = (file[key][()] for key in "xyz")
        os.remove(path)
        expected, sure = readers.nearest_nodes(values(os.path.join(self.data, name)), pixels, x, y)
        self.assertGreater(sure.mean(), 0.9, name)
        np.testing.assert_array_equal(np.isnan(z)[sure], np.isnan(expected)[sure], name)
        np.testing.assert_allclose(z[sure], expected[sure], rtol=sum(tolerance), atol=0, err_msg=name)
        holes = np.isnan(z).sum()
        return result, f"{len(x)} x {len(y)} nodes of {x[1] - x[0]:.6g} m" + (f", {holes} hole" + "s" * (holes > 1) if holes else "")

    def check_mesh(self, name, options):
        """Compares every corner of every facet with the Wavefront OBJ of the body, times its scale."""
        result, path = self.run_file(name, options)
        self.assertEqual((result.code, result.stderr), (0, ""), name)
        with h5py.File(path) as file:
            vertices, triangles = (file["mesh"][key][()] for key in ("vertices", "triangles"))
        os.remove(path)
        obj = os.path.join(self.data, re.sub(r"boulder.*", "boulder.obj", name))
        np.testing.assert_array_equal(vertices[triangles], float(options.partition("scale_m=")[2] or 1) * readers.obj_facets(obj))
        return result, f"{len(vertices)} vertices, {len(triangles)} triangles"

    def row(self, name, kind, outcome, how, *_):
        """The cells of a row as they are now."""
        options = "".join(re.findall(r"^`([^`]+)`", how))
        if outcome.startswith("refused"):
            result, _ = self.run_file(name, options)
            why = self.check_refused(name, options, result)
            cells = [f"refused (exit {result.code})", f"`{options}`: {why}" if options else why]
        else:
            result, what = self.check_mesh(name, options) if name.endswith(MESHES) else self.check_loaded(name, options)
            cells = ["loads: " + what, f"`{options}`" if options else "as it is"]
        return [name, kind, *cells, f"{result.seconds:.2f}", f"{result.megabytes:.0f}"]

    def test_every_file_loads_or_is_refused_as_the_table_says(self):
        before = read_table(self.title)
        rows = [self.row(*cells) for cells in before]
        if "--write" in sys.argv:
            write_table(self.title, rows)
        self.assertEqual([cells[:4] for cells in before], [cells[:4] for cells in rows], "--write updates the table")

    def test_the_table_has_every_file(self):
        listed = [name for name, *_ in read_table(self.title)]
        found = {os.path.join(folder, name) for folder in {os.path.dirname(name) for name in listed}
                 for name in os.listdir(os.path.join(self.data, folder))}
        self.assertEqual(sorted(found), sorted(listed))

    def test_malformed_rasters_are_refused_with_any_options(self):
        names = [name for name, *_ in read_table(self.title) if name.startswith("malformed") and not name.endswith(MESHES)]
        landfall.Terrain({"base": {"type": "dem", "path": os.path.join(TESTDATA, "rasters", "relief_moon_1m.tif")}})  # loads GDAL
        for number, name in enumerate(names):
            for i, site in enumerate(SITES):
                j = (i + number) % len(SCALES)
                base = {"type": "dem", "path": os.path.join(self.data, name), **SCALES[j], **(CORNER if (i + j) % 2 else {})}
                self.check_refused(name, {"base": base, **site}, Forked({"base": base, **site}))


class Testdata(Folder, ToolTest):
    data, title = TESTDATA, "Files of this project"

    def test_the_boulder_is_closed(self):
        facets = readers.obj_facets(os.path.join(TESTDATA, "meshes", "boulder.obj"))
        edges = np.sort(np.unique(facets.reshape(-1, 3), axis=0, return_inverse=True)[1].reshape(-1, 3)[:, [[0, 1], [1, 2], [2, 0]]])
        self.assertEqual(facets.shape, (320, 3, 3))
        self.assertEqual(set(np.unique(edges.reshape(-1, 2), axis=0, return_counts=True)[1]), {2})


class ClassicNetcdf(ToolTest):
    """The netCDF library reads the missing end of a truncated file in these formats as zeros."""

    def write(self, name, form):
        """Writes grids with and without a record dimension, whose sizes need padding."""
        with netCDF4.Dataset(self.path(name), "w", format=form) as file:
            file.history = "made by a test"
            for dimension, length in {"time": None, "lat": 5, "lon": 7}.items():
                file.createDimension(dimension, length)
            for axis in ("lat", "lon"):
                file.createVariable(axis, "f8", (axis,))[:] = np.arange(len(file.dimensions[axis]))
            file.createVariable("z", "i2", ("lat", "lon"))[:] = VALUES
            for layer in ("in_records", "last"):
                file.createVariable(layer, "i2", ("time", "lat", "lon"))[:] = np.stack([VALUES, 2 * VALUES])
        return self.path(name)

    def arguments(self, path, layer, output):
        return ["--from", f'NETCDF:"{path}":{layer}', "-O", "-o", output, "--horizontal-scale", "1", *EXACT]

    def test_whole_files_load_and_truncated_ones_are_refused(self):
        output = self.path("out.h5")
        for form in ("NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET"):
            path = self.write(form + ".nc", form)
            for layer in ("z", "in_records"):
                self.succeed("terrain-gen", *self.arguments(path, layer, output))
                with h5py.File(output) as file:
                    np.testing.assert_array_equal(file["z"][()], VALUES[:, 1:-1], form)
            os.remove(output)
            whole = read_bytes(path)
            # 35 values of 2 bytes end with 2 bytes of padding, so the smallest cut, of 3 bytes, damages the last value.
            for size in (len(whole) - 3, len(whole) - 100, len(whole) // 2):
                write_file(path, whole[:size])
                self.refuse(1, "terrain-gen", *self.arguments(path, "z", output), words=[path, f"holds {size} of the", "truncated"],
                            output=output)


@unittest.skipUnless(os.path.isdir(os.path.join(DATA, "dem")), f"no real rasters: {os.path.join(DATA, 'dem')} (LANDFALL_DATA)")
class RealFiles(Folder, ToolTest):
    data, title = DATA, "Real files, and those of GDAL's own tests"

    def test_known_numbers_of_holes(self):
        grid = readers.gmt_grid(os.path.join(DATA, "dem/earth_relief_20arcmin_holes.grd"))
        self.assertEqual(np.isnan(grid).sum(), 171)
        border = readers.tiff(os.path.join(DATA, "dem/earth_sthelens_nodata_int16_nonsquare.dem")) == -32767
        self.assertAlmostEqual(100 * border.mean(), 2.27, delta=0.005)


if __name__ == "__main__":
    unittest.main(argv=[argument for argument in sys.argv if argument != "--write"])
