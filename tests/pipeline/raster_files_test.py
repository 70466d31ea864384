#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every file of the folder LANDFALL_DATA through terrain-gen: loaded as other readers have it, or refused with a
reason, quickly and in little memory. docs/user/terrain-files.md is what comes out.

usage: raster_files_test.py [--write]   --write renews the table
"""
import os
import subprocess
import sys
import time
import unittest

import h5py
import numpy as np
import raster_readers as readers
from chain import SANITIZED, ToolTest, tool
from raster_readers import Cells, Degrees

ROOT = os.environ["LANDFALL_ROOT"]
DATA = os.environ.get("LANDFALL_DATA", os.path.join(ROOT, "..", "shared", "data"))
TABLE = os.path.join(ROOT, "docs", "user", "terrain-files.md")
LIMIT_S, LIMIT_MB = (60, 5000) if SANITIZED else (2, 500)
EXACT = ["--interpolation", "nearest", "--datum", "none"]


class Loads:
    """A file that must load: its kind, the options that it takes, and what another reader says of its nodes."""

    def __init__(self, kind, options, values, pixels, tolerance=0):
        self.kind, self.options, self.values, self.pixels = kind, options, values, pixels
        self.tolerance = tolerance


class LoadsMesh:
    """A mesh that must load, its points times `scale`."""

    def __init__(self, kind, options, scale):
        self.kind, self.options, self.scale = kind, options, scale


class Refused:
    def __init__(self, kind, options=""):
        self.kind, self.options = kind, options


def nodata(value, read):
    def values(path):
        found = read(path)
        return np.where(found == value, np.nan, found)
    return values


def scaled(factor, read):
    return lambda path: factor * read(path)


def mola(_):
    return readers.raw(os.path.join(DATA, "dem/mars_mola_megt90n000cb_be_int16.img"), ">i2", (720, 1440))


FILES = {
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
        "GeoTIFF, equidistant cylindrical, float32", "--center-pixel 173,168", readers.tiff,
        Cells((173, 168), 1)),
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
    "mesh/itokawa_49152f.obj": LoadsMesh("Wavefront OBJ, kilometres", "--set mesh.scale_m=1000", 1000),
}
# However a malformed file is asked for: as it is, small, large, with and without a scale, at a corner.
WAYS = [f"{site}{scale}{center}" for site in ["", "--half-width 1 --resolution 1", "--half-width 60 --resolution 0.05"]
        for scale in ["", " --horizontal-scale 1", " --horizontal-scale 1000"]
        for center in ["", " --center-pixel 2,2 --datum none --interpolation nearest"]]
HEAD = """# How raster files load

How `terrain-gen --from FILE` loads each of 36 tested files: real elevation models, and unusual and malformed files from GDAL's own tests.
`tests/pipeline/raster_files_test.py --write` produces the table. The test compares every node of the files that load with other readers (numpy
on the bytes, h5py, Pillow), and runs every malformed file in 18 ways. Seconds and MB (peak, upper bound) are from one run and vary.

| file | what it is | outcome | how, or why not | s | MB |
|---|---|---|---|---|---|
"""


class Run:
    """One run of terrain-gen, timed; its peak memory is an upper bound (it includes that of the fork)."""

    def __init__(self, *arguments):
        start = time.perf_counter()
        with subprocess.Popen([tool("terrain-gen"), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as process:
            self.stderr = process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = self.code = os.waitstatus_to_exitcode(status)
        self.seconds = time.perf_counter() - start
        self.megabytes = usage.ru_maxrss * 1024 / 1e6


def words_of(row):
    """A row of the table without its measured cells."""
    return [cell.strip() for cell in row.split("|")[:-3]]


@unittest.skipUnless(os.path.isdir(os.path.join(DATA, "malformed")), f"no rasters in {DATA} (LANDFALL_DATA)")
class RasterFiles(ToolTest):
    def run_file(self, name, options, output="site.h5"):
        path = self.path(output)
        result = Run("--from", os.path.join(DATA, name), "-O", "-o", path, *options.split())
        return result, path

    def check_refused(self, name, options):
        """The reason, without what stands before it in the message."""
        result, path = self.run_file(name, options)
        message = f"{name} {options}: {result.stderr}"
        self.assertIn(result.code, (1, 2), message)
        start = f"terrain-gen: {os.path.join(DATA, name)}: "
        self.assertTrue(result.stderr.startswith(start), message)
        self.assertRegex(result.stderr, r"\A[^\n]+\n\Z")
        self.assertEqual(self.entries(), [], message)
        self.assertFalse(os.path.exists(path))
        self.assertLess(result.seconds, LIMIT_S, message)
        self.assertLess(result.megabytes, LIMIT_MB, message)
        return result, result.stderr[len(start):].strip().replace(DATA + os.sep, "")

    def check_loaded(self, name, case):
        """Compares every node with the other reader's, and says what there is."""
        result, path = self.run_file(name, " ".join([case.options, *EXACT]))
        self.assertEqual((result.code, result.stderr), (0, ""), name)
        with h5py.File(path) as file:
            x, y, z = (file[key][()] for key in "xyz")
        os.remove(path)
        expected, sure = readers.nearest_nodes(case.values(os.path.join(DATA, name)), case.pixels, x, y)
        self.assertGreater(sure.mean(), 0.9, name)
        np.testing.assert_array_equal(np.isnan(z)[sure], np.isnan(expected)[sure], name)
        np.testing.assert_allclose(z[sure], expected[sure], rtol=case.tolerance, atol=0, err_msg=name)
        holes = np.isnan(z).sum()
        return result, f"{len(x)} x {len(y)} nodes of {x[1] - x[0]:.6g} m" + (f", {holes} holes" if holes else "")

    def check_mesh(self, name, case):
        """Compares every corner of every facet with the lines of the file."""
        result, path = self.run_file(name, case.options)
        self.assertEqual((result.code, result.stderr), (0, ""), name)
        with h5py.File(path) as file:
            vertices, triangles = (file["mesh"][key][()] for key in ("vertices", "triangles"))
        os.remove(path)
        np.testing.assert_array_equal(vertices[triangles], case.scale * readers.obj_facets(os.path.join(DATA, name)))
        return result, f"{len(vertices)} vertices, {len(triangles)} triangles"

    def row(self, name, case):
        if isinstance(case, LoadsMesh):
            result, what = self.check_mesh(name, case)
            cells = [name, case.kind, "loads: " + what, f"`{case.options}`"]
        elif isinstance(case, Loads):
            result, what = self.check_loaded(name, case)
            cells = [name, case.kind, "loads: " + what, f"`{case.options}`" if case.options else "as it is"]
        else:
            result, why = self.check_refused(name, case.options)
            cells = [name, case.kind, f"refused (exit {result.code})", why]
        return "| " + " | ".join([*cells, f"{result.seconds:.2f}", f"{result.megabytes:.0f}"]) + " |\n"

    def test_every_file_loads_or_is_refused_as_the_table_says(self):
        rows = [self.row(name, case) for name, case in FILES.items()]
        if "--write" in sys.argv:
            with open(TABLE, "w", encoding="utf-8") as file:
                file.write(HEAD + "".join(rows))
        with open(TABLE, encoding="utf-8") as file:
            text = file.read()
        self.assertTrue(text.startswith(HEAD), "the table's head; --write renews it")
        for old, new in zip(text[len(HEAD):].splitlines(), rows, strict=True):
            self.assertEqual(words_of(old), words_of(new.strip()), "--write renews the table")

    def test_the_table_has_every_file(self):
        found = {os.path.join(folder, name) for folder in ["dem", "unusual", "malformed", "mesh"]
                 for name in os.listdir(os.path.join(DATA, folder))}
        self.assertEqual(found, set(FILES))

    def test_known_numbers_of_holes(self):
        grid = readers.gmt_grid(os.path.join(DATA, "dem/earth_relief_20arcmin_holes.grd"))
        self.assertEqual(np.isnan(grid).sum(), 171)
        border = readers.tiff(os.path.join(DATA, "dem/earth_sthelens_nodata_int16_nonsquare.dem")) == -32767
        self.assertAlmostEqual(100 * border.mean(), 2.27, delta=0.005)

    def test_malformed_files_are_refused_however_they_are_asked_for(self):
        for name in FILES:
            for way in WAYS if name.startswith("malformed") else []:
                self.check_refused(name, way)


if __name__ == "__main__":
    unittest.main(argv=[argument for argument in sys.argv if argument != "--write"])
