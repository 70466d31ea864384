#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""terrain-gen on the rasters and meshes of testdata/ and on the real ones in the folder LANDFALL_DATA: each file loads with
the values that another reader gives, or is refused with a reason, quickly and in little memory. The results are listed in
testdata/terrain-files.md.

usage: raster_files_test.py [--write]   --write updates the page
"""
import os
import re
import subprocess
import sys
import unittest

import h5py
import netCDF4
import numpy as np

import raster_readers as readers
from harness import SANITIZED, ToolTest, read_bytes, tool, without_warnings
from raster_readers import Cells, Degrees, Rotated

ROOT = os.environ["LANDFALL_ROOT"]
TESTDATA = os.path.join(ROOT, "testdata")
DATA = os.environ.get("LANDFALL_DATA", os.path.join(ROOT, "..", "shared", "data"))
TABLE = os.path.join(ROOT, "testdata", "terrain-files.md")
LIMIT_S, LIMIT_MB = (60, 5000) if SANITIZED else (2, 500)
MESHES = (".obj", ".off", ".ply", ".stl")
EXACT = ["--interpolation", "nearest", "--datum", "none"]


class Loads:
    """A raster that must load: its kind, the options for it, another reader of its values, and the pixels of its nodes."""

    def __init__(self, kind, options, values, pixels, tolerance=0):
        self.kind, self.options, self.values, self.pixels = kind, options, values, pixels
        self.tolerance = tolerance


class LoadsMesh:
    """A mesh that must load; its facets are `scale` times those of `obj`, a Wavefront OBJ of the same body."""

    def __init__(self, kind, options, scale, obj):
        self.kind, self.options, self.scale, self.obj = kind, options, scale, obj


class Refused:
    def __init__(self, kind, options=""):
        self.kind, self.options = kind, options


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


def boulder(kind, options="", scale=1):
    return LoadsMesh(kind, options, scale, os.path.join(TESTDATA, "meshes", "boulder.obj"))


def tiles(path):
    return np.hstack([readers.tiff(os.path.join(os.path.dirname(path), name)) for name in ("tile_west.tif", "tile_east.tif")])


TESTDATA_FILES = {
    "rasters/big_endian_int16.tif": Loads(
        "GeoTIFF, big-endian, int16", "--center-pixel 15,10", readers.tiff, Cells((15, 10), 1)),
    "rasters/cell.dt0": Loads(
        "DTED level 0, negative heights, a hole", "--center=9.6,43.7 --half-width 30000 --resolution 1000", readers.dted,
        Degrees((9.6, 43.7), 6378137, 1 / 120, (9, 44), 43200, 1 / 298.257223563)),
    "rasters/float16.tif": Loads("GeoTIFF, float16", "--center-pixel 10,10", readers.tiff, Cells((10, 10), 60)),
    "rasters/gmt_holes.grd": Loads(
        "netCDF, rows from the south, no CRS (degrees), holes of NaN", "--horizontal-scale 111195 --center-pixel 15,15", readers.gmt_grid,
        Cells((15, 15), 111195 / 3)),
    "rasters/grey_8bit.png": Loads(
        "PNG, 8 bit, no CRS", "--horizontal-scale 2 --vertical-scale 0.25", scaled(0.25, readers.pillow), Cells((16, 16), 2)),
    "rasters/latlon_scaled_int16.tif": Loads(
        "GeoTIFF, degrees, int16 with scale 0.5 and offset 200, holes", "--center=30,0.5 --half-width 40000 --resolution 1000",
        lambda path: 0.5 * nodata(-32768, readers.tiff)(path) + 200, Degrees((30, 0.5), 1737400, 0.05, (28, 2), 7200)),
    "rasters/mars_big_endian.vrt": Loads(
        "VRT of its own raw big-endian int16 file, degrees 0 .. 360", "--center=-133.8,18.65 --half-width 600000 --resolution 50000",
        lambda path: readers.raw(path.replace(".vrt", ".img"), ">i2", (36, 72)), Degrees((-133.8, 18.65), 3396190, 5, (2.5, 87.5), 72)),
    "rasters/mars_big_endian.img": Refused("raw, without a header"),
    "rasters/mosaic.vrt": Loads("VRT of two tiles", "--follow-links --center-pixel 20,15", tiles, Cells((20, 15), 10)),
    "rasters/nan_nodata_deflate.tif": Loads(
        "GeoTIFF, deflate, nodata NaN", "--center-pixel 6,5", readers.tiff, Cells((6, 5), 1)),
    "rasters/nodata_no_crs.asc": Loads(
        "Esri ASCII, nodata as a float, no CRS", "--horizontal-scale 1 --center-pixel 11,9", readers.ascii_grid, Cells((11, 9), 1)),
    "rasters/nonsquare_int16.tif": Loads(
        "GeoTIFF, int16, cells of 150 x 225 m", "--center-pixel 25,20", readers.tiff, Cells((25, 20), 150, 225)),
    "rasters/polar_stereographic.tif": Loads("GeoTIFF, polar stereographic, float32", "", readers.tiff, Cells((16, 16), 2.5)),
    "rasters/relief_europa_10m.tif": Loads("GeoTIFF, orthographic, float32", "", readers.tiff, Cells((52, 52), 10)),
    "rasters/relief_moon_1m.tif": Loads("GeoTIFF, polar stereographic, float32", "", readers.tiff, Cells((64, 64), 1)),
    "rasters/rotated.tif": Loads(
        "GeoTIFF, float64, turned by 53 degrees and mirrored", "--center-pixel 22,22", readers.tiff, Rotated((22, 22), (3, 4), (4, -3))),
    "rasters/south_up.tif": Loads(
        "GeoTIFF, south up, float32", "--center-pixel 25,20", readers.tiff, Cells((25, 20), 5, -5)),
    "rasters/three_bands_minus_inf.tif": Loads(
        "GeoTIFF, 3 bands, nodata -inf", "--center-pixel 12,10 --band 2", nodata(-np.inf, lambda path: readers.tiff(path)[:, :, 1]),
        Cells((12, 10), 1)),
    "rasters/tile_east.tif": Loads("GeoTIFF, int16", "--center-pixel 10,15", readers.tiff, Cells((10, 15), 10)),
    "rasters/tile_west.tif": Loads("GeoTIFF, int16", "--center-pixel 10,15", readers.tiff, Cells((10, 15), 10)),
    "rasters/vicar_int16.vic": Loads(
        "VICAR, big-endian int16, no CRS", "--horizontal-scale 1 --center-pixel 10,7", readers.vicar, Cells((10, 7), 1)),
    "meshes/boulder.obj": boulder("Wavefront OBJ", "--set mesh.scale_m=2", 2),
    "meshes/boulder.off": boulder("OFF"),
    "meshes/boulder_ascii.ply": boulder("PLY, text"),
    "meshes/boulder_ascii.stl": boulder("STL, text"),
    "meshes/boulder_big_endian.ply": boulder("PLY, binary, big-endian, float64"),
    "meshes/boulder_binary.stl": boulder("STL, binary"),
    "meshes/boulder_little_endian.ply": boulder("PLY, binary, little-endian, float32"),
    "malformed/ascii_huge.asc": Refused("Esri ASCII, 2 10^9 x 2 10^9 cells, 400 numbers"),
    "malformed/ascii_too_few.asc": Refused("Esri ASCII, truncated", "--horizontal-scale 1"),
    "malformed/bigtiff_header_only.tif": Refused("BigTIFF, 10^10 pixels, header only"),
    "malformed/dted_no_columns.dt0": Refused("DTED, headers only"),
    "malformed/dted_truncated.dt0": Refused("DTED, truncated"),
    "malformed/empty.obj": Refused("Wavefront OBJ, no bytes"),
    "malformed/empty.tif": Refused("GeoTIFF, no bytes"),
    "malformed/hdf5_truncated.h5": Refused("HDF5, truncated"),
    "malformed/netcdf_header_cut.nc": Refused("netCDF, truncated in its header"),
    "malformed/netcdf_truncated.nc": Refused("netCDF, truncated"),
    "malformed/obj_nan.obj": Refused("Wavefront OBJ, a vertex that is NaN"),
    "malformed/obj_no_area.obj": Refused("Wavefront OBJ, no facet has an area"),
    "malformed/obj_no_facet.obj": Refused("Wavefront OBJ, vertices only"),
    "malformed/obj_vertex_beyond_end.obj": Refused("Wavefront OBJ, a vertex that it lacks"),
    "malformed/obj_vertex_zero.obj": Refused("Wavefront OBJ, vertex number 0"),
    "malformed/obj_word.obj": Refused("Wavefront OBJ, a word among the numbers"),
    "malformed/off_huge_count.off": Refused("OFF, 4 10^12 vertices, header only"),
    "malformed/off_negative_count.off": Refused("OFF, -1 vertices"),
    "malformed/off_truncated.off": Refused("OFF, truncated"),
    "malformed/ply_header_cut.ply": Refused("PLY, truncated in its header"),
    "malformed/ply_huge_count.ply": Refused("PLY, 10^12 facets"),
    "malformed/ply_huge_list.ply": Refused("PLY, a facet of 2 10^9 corners"),
    "malformed/ply_no_z.ply": Refused("PLY, vertices without z"),
    "malformed/ply_truncated.ply": Refused("PLY, binary, truncated"),
    "malformed/ply_unknown_format.ply": Refused("PLY, unknown format"),
    "malformed/png_damaged.png": Refused("PNG, damaged deflate"),
    "malformed/png_truncated.png": Refused("PNG, truncated"),
    "malformed/raw_no_header.img": Refused("raw, without a header"),
    "malformed/stl_ascii_cut.stl": Refused("STL, text, truncated"),
    "malformed/stl_huge_count.stl": Refused("STL, 2^32 - 1 facets"),
    "malformed/stl_of_another_format.stl": Refused("OFF with the name of an STL"),
    "malformed/stl_truncated.stl": Refused("STL, binary, truncated"),
    "malformed/tiff_all_holes.tif": Refused("TIFF, all NaN", "--horizontal-scale 1"),
    "malformed/tiff_damaged_deflate.tif": Refused("TIFF, damaged deflate"),
    "malformed/tiff_damaged_tags.tif": Refused("GeoTIFF, damaged tags"),
    "malformed/tiff_directory_beyond_end.tif": Refused("TIFF, directory beyond the end"),
    "malformed/tiff_huge_blocks.tif": Refused("TIFF, tiles beyond 2^31 pixels"),
    "malformed/tiff_huge_image.tif": Refused("TIFF, 1.4 10^14 pixels, one strip"),
    "malformed/tiff_huge_tile.tif": Refused("TIFF, tiles that claim 256 MiB"),
    "malformed/tiff_no_columns.tif": Refused("TIFF, 0 columns"),
    "malformed/tiff_one_column.tif": Refused("TIFF, 1 x 16777215, truncated"),
    "malformed/tiff_one_pixel.tif": Refused("TIFF, 1 x 1"),
    "malformed/tiff_one_row.tif": Refused("TIFF, 20 x 1"),
    "malformed/tiff_strip_beyond_end.tif": Refused("TIFF, strip beyond the end"),
    "malformed/tiff_tile_beyond_end.tif": Refused("TIFF, tile beyond the end"),
    "malformed/tiff_truncated.tif": Refused("TIFF, truncated"),
    "malformed/tiff_unknown_compression.tif": Refused("TIFF, unknown compression"),
    "malformed/tiff_wide.tif": Refused("TIFF, 2^31 columns"),
    "malformed/vicar_truncated.vic": Refused("VICAR, truncated", "--horizontal-scale 1"),
    "malformed/vrt_cut.vrt": Refused("VRT, truncated"),
    "malformed/vrt_missing_source.vrt": Refused("VRT whose sources are missing"),
}
REAL_FILES = {
    "dem/earth_bijou_gully_5m.asc": Loads(
        "Esri ASCII, no CRS", "--horizontal-scale 1 --center-pixel 52,38", readers.ascii_grid,
        Cells((52, 38), 4.988744589)),
    "dem/earth_relief_20arcmin_holes.grd": Loads(
        "netCDF-4, no CRS (degrees), 171 holes", "--horizontal-scale 111195 --center-pixel 15,15",
        readers.gmt_grid, Cells((15, 15), 111195 / 3)),
    "dem/earth_sthelens_nodata_int16_nonsquare.dem": Loads(
        "GeoTIFF, UTM, int16, cells of 150.9 x 216 m, border of holes", "--center-pixel 32,32",
        nodata(-32767, readers.tiff), Cells((32, 32), 9810 / 65, 216)),
    "dem/europa_e26_terminator_10m.tif": Loads(
        "GeoTIFF, orthographic, float32", "", readers.tiff, Cells((256, 256), 10)),
    "dem/mars_gale_hirise_1m.tif": Loads(
        "GeoTIFF, equidistant cylindrical, float32", "--center-pixel 173,168", readers.tiff, equidistant((173, 168))),
    "dem/mars_mola_megt90n000cb.vrt": Loads(
        "VRT of a raw big-endian int16 file, degrees 0 .. 360",
        "--follow-links --center=-133.8,18.65 --half-width 300000 --resolution 10000", mola,
        Degrees((-133.8, 18.65), 3396000, 0.25, (0.125, 89.875), 1440)),
    "dem/mars_mola_megt90n000cb_be_int16.img": Refused("raw, without a header"),
    "dem/moon_apollo15_nac_2m_8bit.png": Loads(
        "PNG, 8 bit, no CRS", "--horizontal-scale 2 --vertical-scale 0.192",
        scaled(0.192, readers.pillow), Cells((128, 128), 2), 1e-12),
    "dem/moon_lola_global_int16_scale0.5_latlon.tif": Loads(
        "GeoTIFF, int16 with scale 0.5, degrees",
        "--center=-157,5.4 --half-width 300000 --resolution 10000",
        scaled(0.5, nodata(-32768, readers.pillow)),
        Degrees((-157, 5.4), 1737400, 0.3515625, (-180 + 0.17578125, 90 - 0.17578125), 1024)),
    "dem/moon_npole_2m4_80m.tif": Loads(
        "GeoTIFF, polar stereographic, float32", "", readers.tiff, Cells((16, 16), 2.426609848484849)),
    "unusual/empty_nodata.tif": Refused("GeoTIFF, 1 x 1, empty nodata tag"),
    "unusual/float16.tif": Loads(
        "GeoTIFF, float16", "--center-pixel 10,10", readers.tiff, Cells((10, 10), 60)),
    "unusual/nan32_nodata.tif": Loads(
        "GeoTIFF, nodata NaN", "--center-pixel 5,5", readers.tiff, Cells((5, 5), 1)),
    "unusual/negative_scaley.tif": Refused("GeoTIFF, 1 x 1, negative scale in y"),
    "unusual/nodata_float.asc": Loads(
        "Esri ASCII, nodata as a float, no CRS", "--horizontal-scale 1", readers.ascii_grid,
        Cells((2, 2), 60)),
    "unusual/stats_nodata_neginf.tif": Refused("GeoTIFF, 3 x 1, nodata -inf"),
    "unusual/test_nodatavalues.tif": Loads(
        "TIFF, 3 bands, nodata 0, no CRS", "--horizontal-scale 1 --center-pixel 25,25 --band 2",
        nodata(0, lambda path: readers.tiff(path)[:, :, 1]), Cells((25, 25), 1)),
    "unusual/tiff_vertcs_scale_offset.tif": Refused("GeoTIFF, 1 x 1, vertical CRS"),
    "unusual/vicar_bigendian_int16.vic": Loads(
        "VICAR, big-endian int16, no CRS", "--horizontal-scale 1 --center-pixel 2,1", readers.vicar,
        Cells((2, 1), 1)),
    "malformed/022gdeme_truncated": Refused("USGS DEM, truncated"),
    "malformed/bigtiff_header_extract.tif": Refused("BigTIFF, 10^10 pixels, header only"),
    "malformed/byte_truncated.nc": Refused("netCDF-4, truncated"),
    "malformed/byte_truncated.tif": Refused("GeoTIFF, truncated"),
    "malformed/corrupted_deflate_singlestrip.tif": Refused("TIFF, damaged deflate"),
    "malformed/corrupted_gtiff_tags.tif": Refused("GeoTIFF, damaged tags"),
    "malformed/excessive-memory-TIFFFillTile.tif": Refused("GeoTIFF, a tile that claims 256 MiB"),
    "malformed/huge-number-strips.tif": Refused("TIFF, 1.6 10^14 pixels, header only"),
    "malformed/hugeblocksize.tif": Refused("TIFF, tiles beyond 2^31 pixels"),
    "malformed/image_width_above_32bit.tif": Refused("TIFF, 2^31 columns"),
    "malformed/many_blocks_truncated.tif": Refused("TIFF, 1 x 16777215, truncated"),
    "malformed/n43_partial_cols.dt0": Refused("DTED, truncated"),
    "malformed/tiled_bad_offset.tif": Refused("TIFF, tile beyond the end"),
    "malformed/unknown_compression.tif": Refused("TIFF, unknown compression"),
    "malformed/vrt_missing_source.vrt": Refused("VRT whose source is missing"),
    "malformed/w118n033_trunc.dt1": Refused("DTED, truncated"),
    "mesh/itokawa_49152f.obj": LoadsMesh(
        "Wavefront OBJ, kilometres", "--set mesh.scale_m=1000", 1000, os.path.join(DATA, "mesh/itokawa_49152f.obj")),
}
# Options with which malformed rasters are read: none, a small and a large site, with and without a scale, at a corner. Every two of
# them occur together.
SITES = ["", "--half-width 1 --resolution 1", "--half-width 60 --resolution 0.05"]
SCALES = ["", " --horizontal-scale 1", " --horizontal-scale 1000"]
CENTERS = ["", " --center-pixel 2,2 --datum none --interpolation nearest"]
OPTIONS = [site + scale + CENTERS[(i + j) % 2] for i, site in enumerate(SITES) for j, scale in enumerate(SCALES)]
HEAD = """# How raster and mesh files load

How `terrain-gen --from FILE` loads the small files of [this folder](README.md) and 36 others: real elevation models, and unusual and
malformed files from GDAL's own tests. `tests/chain/raster_files_test.py --write` writes the tables. The test compares every node of the files that
load with other readers (numpy on the bytes, ncdump, Pillow), and runs every malformed raster in 9 ways. Seconds and MB (peak, upper bound) are from one
run and vary.
"""
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
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = self.code = os.waitstatus_to_exitcode(status)
        self.seconds = usage.ru_utime + usage.ru_stime  # of the processor, which no other load lengthens
        self.megabytes = usage.ru_maxrss * 1024 / 1e6


def sections():
    """{title: text} of the page's sections; the head of the page has an empty title."""
    with open(TABLE, encoding="utf-8") as file:
        head, *rest = re.split(r"^## (.*)\n", file.read(), flags=re.M)
    return {"": head.rstrip() + "\n"} | {title: text.rstrip() + "\n" for title, text in zip(rest[::2], rest[1::2])}


def read_table(title):
    """The rows of a section's table, without its header."""
    return sections()[title].removeprefix(COLUMNS).splitlines()


def write_table(title, rows):
    tables = {**sections(), "": HEAD, title: COLUMNS + "".join(rows)}
    with open(TABLE, "w", encoding="utf-8") as file:
        file.write("\n".join((f"## {name}\n" if name else "") + text for name, text in tables.items()))


def result_cells(row):
    """The cells of a row, without the measured ones."""
    return [cell.strip() for cell in row.split("|")[:-3]]


class Folder:
    """The files of one folder, and the section of the page that lists them."""

    data, title, files = "", "", {}

    def run_file(self, name, options, output="site.h5"):
        path = self.path(output)
        result = Run("--from", os.path.join(self.data, name), "-O", "-o", path, *options.split())
        return result, path

    def check_refused(self, name, options):
        """Checks that a file is refused; returns the run, and the reason without the start of the message."""
        result, path = self.run_file(name, options)
        message = f"{name} {options}: {result.stderr}"
        self.assertIn(result.code, (1, 2), message)
        start = f"terrain-gen: {os.path.join(self.data, name)}: "
        self.assertTrue(result.stderr.startswith(start), message)
        self.assertRegex(result.stderr, r"\A[^\n]+\n\Z")
        self.assertEqual(self.entries(), [], message)
        self.assertFalse(os.path.exists(path))
        self.assertLess(result.seconds, LIMIT_S, message)
        self.assertLess(result.megabytes, LIMIT_MB, message)
        return result, result.stderr[len(start):].strip().replace(self.data + os.sep, "")

    def check_loaded(self, name, case):
        """Compares every node with the other reader; returns the run and a description of the nodes."""
        result, path = self.run_file(name, " ".join([case.options, *EXACT]))
        self.assertEqual((result.code, result.stderr), (0, ""), name)
        with h5py.File(path) as file:
            x, y, z = (file[key][()] for key in "xyz")
        os.remove(path)
        expected, sure = readers.nearest_nodes(case.values(os.path.join(self.data, name)), case.pixels, x, y)
        self.assertGreater(sure.mean(), 0.9, name)
        np.testing.assert_array_equal(np.isnan(z)[sure], np.isnan(expected)[sure], name)
        np.testing.assert_allclose(z[sure], expected[sure], rtol=case.tolerance, atol=0, err_msg=name)
        holes = np.isnan(z).sum()
        return result, f"{len(x)} x {len(y)} nodes of {x[1] - x[0]:.6g} m" + (f", {holes} hole" + "s" * (holes > 1) if holes else "")

    def check_mesh(self, name, case):
        """Compares every corner of every facet with the Wavefront OBJ."""
        result, path = self.run_file(name, case.options)
        self.assertEqual((result.code, result.stderr), (0, ""), name)
        with h5py.File(path) as file:
            vertices, triangles = (file["mesh"][key][()] for key in ("vertices", "triangles"))
        os.remove(path)
        np.testing.assert_array_equal(vertices[triangles], case.scale * readers.obj_facets(case.obj))
        return result, f"{len(vertices)} vertices, {len(triangles)} triangles"

    def row(self, name, case):
        if isinstance(case, Refused):
            result, why = self.check_refused(name, case.options)
            cells = [name, case.kind, f"refused (exit {result.code})", why]
        else:
            result, what = self.check_mesh(name, case) if isinstance(case, LoadsMesh) else self.check_loaded(name, case)
            cells = [name, case.kind, "loads: " + what, f"`{case.options}`" if case.options else "as it is"]
        return "| " + " | ".join([*cells, f"{result.seconds:.2f}", f"{result.megabytes:.0f}"]) + " |\n"

    def test_every_file_loads_or_is_refused_as_the_table_says(self):
        rows = [self.row(name, case) for name, case in self.files.items()]
        if "--write" in sys.argv:
            write_table(self.title, rows)
        self.assertEqual(sections()[""], HEAD, "--write updates the page")
        old = read_table(self.title)
        for before, now in zip(old, rows, strict=True):
            self.assertEqual(result_cells(before), result_cells(now.strip()), "--write updates the table")

    def test_the_table_has_every_file(self):
        found = {os.path.join(folder, name) for folder in {os.path.dirname(name) for name in self.files}
                 for name in os.listdir(os.path.join(self.data, folder))}
        self.assertEqual(found, set(self.files))

    def test_malformed_rasters_are_refused_with_any_options(self):
        for name in self.files:
            if name.startswith("malformed") and not name.endswith(MESHES):
                for options in OPTIONS:
                    self.check_refused(name, options)


class Testdata(Folder, ToolTest):
    data, title, files = TESTDATA, "Files of this project", TESTDATA_FILES

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
                with open(path, "wb") as file:
                    file.write(whole[:size])
                self.refuse(1, "terrain-gen", *self.arguments(path, "z", output), words=[path, f"holds {size} of the", "truncated"],
                            output=output)


@unittest.skipUnless(os.path.isdir(os.path.join(DATA, "dem")), f"no real rasters: {os.path.join(DATA, 'dem')} (LANDFALL_DATA)")
class RealFiles(Folder, ToolTest):
    data, title, files = DATA, "Real files, and those of GDAL's own tests", REAL_FILES

    def test_known_numbers_of_holes(self):
        grid = readers.gmt_grid(os.path.join(DATA, "dem/earth_relief_20arcmin_holes.grd"))
        self.assertEqual(np.isnan(grid).sum(), 171)
        border = readers.tiff(os.path.join(DATA, "dem/earth_sthelens_nodata_int16_nonsquare.dem")) == -32767
        self.assertAlmostEqual(100 * border.mean(), 2.27, delta=0.005)


if __name__ == "__main__":
    unittest.main(argv=[argument for argument in sys.argv if argument != "--write"])
