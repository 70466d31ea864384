#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of rasters and clouds of other tools: the horizon of a site, the seam of longitudes, body-fixed points, one lattice of DEM
and truth, bands of colours, and undeclared fill values."""
import json
import os
import subprocess
import unittest

import h5py
import numpy as np

from harness import ToolTest, read_bytes
from harness.rasters import geotiff

JOINTS = os.path.join(os.environ.get("LANDFALL_DATA", os.path.join(os.environ["LANDFALL_ROOT"], "..", "shared", "data")), "joints")
MOON_M = 1737400.0
MOON = f"+proj=longlat +R={MOON_M} +no_defs"
EARTH = (6378137.0, 1 / 298.257223563)
WGS84 = "EPSG:4326"


def geographic(unit, size):
    """WGS 84 in another unit of angles."""
    return ('GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
            f'UNIT["{unit}",{size!r}]]')


def body_fixed(lon, lat, h, a, f=0.0):
    lon, lat = np.radians(lon), np.radians(lat)
    e2 = f * (2 - f)
    normal = a / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    axis = (normal + h) * np.cos(lat)
    return np.column_stack([axis * np.cos(lon), axis * np.sin(lon), (normal * (1 - e2) + h) * np.sin(lat)])


class Frames(ToolTest):
    def table(self, name, points, header="x,y,z"):
        path = self.path(name)
        np.savetxt(path, points, "%.17g", ",", header=header, comments="")
        return path

    def imported(self, path, *arguments):
        """x_est, y_est, z_est and the origin."""
        self.said = self.succeed("landfall-import", path, "-o", self.path("scan.h5"), "-O", *arguments).stderr
        with h5py.File(self.path("scan.h5")) as file:
            points = file["points"]
            return (np.column_stack([points[axis + "_est"][()] for axis in "xyz"]),
                    np.array([points.attrs["origin_" + axis] for axis in "xyz"]))

    def refused(self, path, *words, arguments=(), code=1):
        self.refuse(code, "landfall-import", path, "-o", self.path("bad.h5"), *arguments, words=words, output=self.path("bad.h5"))

    def raster(self, name, values, corner=(500000, 5400000), **more):
        return geotiff(self.path(name + ".tif"), np.asarray(values, float), corner, **more)

    def bins(self, path="dem.h5"):
        with h5py.File(self.path(path)) as file:
            return file["z_est"][()], file["z_true"][()] if "z_true" in file else None


class Horizon(Frames):
    """A point 90 degrees or more from the centre has no place on the plane that touches the body there."""

    def setUp(self):
        super().setUp()
        lon, lat = np.meshgrid(np.arange(-180, 180, 7.5), np.arange(-87.5, 90, 12.5))
        self.lon, self.lat = lon.ravel(), lat.ravel()
        self.facing = np.cos(np.radians(self.lat)) * np.cos(np.radians(self.lon))

    def check(self, path, *arguments):
        points, _ = self.imported(path, *arguments)
        seen = self.facing > 1e-9
        self.assertEqual(len(points), seen.sum())
        self.assertIn(f"{np.sum(~seen)} of {len(seen)} points lie beyond the horizon of the site", self.said)
        lon, lat = np.radians(self.lon[seen]), np.radians(self.lat[seen])
        np.testing.assert_allclose(points[:, 0], MOON_M * np.cos(lat) * np.sin(lon), atol=1e-5)
        np.testing.assert_allclose(points[:, 1], MOON_M * np.sin(lat), atol=1e-5)

    def test_points_beyond_it_are_left_out_and_counted(self):
        height = 10 * np.arange(len(self.lon)) % 97
        self.check(self.table("far.csv", np.column_stack([self.lon, self.lat, height]), "lon,lat,z"), "--crs", MOON, "--center", "0,0")
        xyz = body_fixed(self.lon, self.lat, height, MOON_M)
        self.check(self.table("xyz.csv", xyz), "--crs", f"+proj=geocent +R={MOON_M}", "--center", "0,0")

    def test_a_map_that_is_projected_point_by_point_has_one_too(self):
        """Equidistant cylindrical, true at latitude 60: not at the centre."""
        x = MOON_M * np.radians(self.lon) / 2
        path = self.table("map.csv", np.column_stack([x, MOON_M * np.radians(self.lat), np.arange(len(x)) % 31]))
        self.check(path, "--crs", f"+proj=eqc +lat_ts=60 +R={MOON_M}", "--center", "0,0")

    def test_a_centre_that_sees_no_point_is_refused(self):
        path = self.table("far.csv", [[170, 1, 2], [-170, 1, 3], [90, 0, 4]], "lon,lat,z")
        self.refused(path, "all 3 points lie beyond the horizon", "--center", arguments=["--crs", MOON, "--center", "0,0"])

    def test_a_polygon_beyond_it_is_refused_by_name(self):
        self.raster("dem", 100 + np.arange(25).reshape(5, 5) / 7, crs=f"+proj=ortho +lat_0=0 +lon_0=0 +R={MOON_M}", corner=(0, 0))
        self.succeed("landfall-import", self.path("dem.tif"), "-o", self.path("dem.h5"))
        square = [[170, -1], [175, -1], [175, 1], [170, 1], [170, -1]]
        self.write("far.csv", 'id,WKT\n1,"POLYGON((' + ", ".join(f"{x} {y}" for x, y in square) + '))"\n')
        subprocess.run(["ogr2ogr", "-q", "-f", "GPKG", "-a_srs", MOON, "-oo", "GEOM_POSSIBLE_NAMES=WKT", self.path("far.gpkg"), self.path("far.csv")], check=True)
        self.refuse(1, "dem-eval", self.path("dem.h5"), "--table", "--set", "region=" + json.dumps({"shape": "polygon", "path": self.path("far.gpkg")}),
                    words=["far.gpkg", "no place in the DEM frame"])

    def test_a_raster_site_beyond_the_limb_is_refused(self):
        """A small body all around: half its width is its radius."""
        path = self.raster("globe", np.add.outer(np.arange(90) % 7, np.arange(180) % 11), corner=(-180, -90), cell=2.0, crs="+proj=longlat +R=500")
        self.refuse(1, "terrain-gen", "--from", path, "--center", "10,20", "--half-width", "400", "--resolution", "10", "-o", self.path("t.h5"),
                    words=["does not lie inside the raster"], output=self.path("t.h5"))
        self.succeed("terrain-gen", "--from", path, "--center", "10,20", "--half-width", "300", "--resolution", "10", "-o", self.path("t.h5"))


class Seam(Frames):
    """Clouds on both sides of longitude 180, or of 0 written as 0 to 360, have their middle there."""

    def setUp(self):
        super().setUp()
        east, self.lat = (part.ravel() for part in np.meshgrid(np.linspace(-0.01, 0.01, 41), np.linspace(10, 10.01, 21)))
        self.east = east
        self.z = 100 + 1e4 * east + 0.2 * np.arange(len(east)) % 5
        self.expected = self.placed(east, WGS84, 0, 1.0)
        self.assertAlmostEqual(self.center[0], 0, delta=1e-9)

    def placed(self, lon, crs, middle, unit):
        """The points with longitudes in degrees, written in `unit` per degree; checks the centre."""
        path = self.table("seam.csv", np.column_stack([lon * unit, self.lat * unit, self.z]), "lon,lat,z")
        points, self.center = self.imported(path, "--crs", crs)
        self.assertAlmostEqual(self.center[0], middle * unit, delta=1e-5 * unit)
        return points

    def test_degrees_gradians_and_radians(self):
        turned = (self.east + 360) % 360 - 180
        for crs, unit in [(WGS84, 1.0), (geographic("grad", np.pi / 200), 10 / 9), (geographic("radian", 1.0), np.pi / 180)]:
            for lon, middle in [(turned, 180), (self.east + 180, 180), (self.east % 360, 0), (self.east - 180, -180)]:
                with self.subTest(crs=crs, middle=middle, first=lon[0]):
                    points = self.placed(lon, crs, middle, unit)
                    offset = points - self.expected
                    # The centres are rounded, in gradians and radians not to the same point.
                    tolerance = 1e-6 if unit == 1.0 else 0.5
                    np.testing.assert_allclose(offset - offset[0], 0, atol=1e-6 if unit == 1.0 else 1e-4)
                    np.testing.assert_allclose(offset[0], 0, atol=tolerance)
                    self.assertEqual(self.said, "")

    def test_maps_that_end_at_the_seam(self):
        """Web Mercator, whose scale is not 1; equidistant cylindrical and sinusoidal maps on and off the equator."""
        turned = np.radians((self.east + 360) % 360 - 180)
        for name, shift in [("EPSG:3857", 0), ("+proj=eqc +R=6371000", 0), ("+proj=eqc +R=6371000", -10), ("+proj=sinu +R=6371000", 0),
                            ("+proj=sinu +R=6371000", -10)]:
            with self.subTest(name, shift=shift):
                maps = {}
                for side, lon in (("seam", np.degrees(turned)), ("middle", self.east)):
                    text = "\n".join(f"{x!r} {y!r}" for x, y in zip(lon.tolist(), (self.lat + shift).tolist()))
                    done = subprocess.run(["gdaltransform", "-output_xy", "-s_srs", f"+proj=longlat {name.split()[-1] if '+R' in name else '+datum=WGS84'}",
                                           "-t_srs", name], input=text, capture_output=True, text=True, check=True)
                    xy = np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])
                    points, center = self.imported(self.table(side + ".csv", np.column_stack([xy, self.z])), "--crs", name)
                    maps[side] = points - points[0]
                    self.assertLess(np.abs(points[:, 0]).max(), 1200)
                np.testing.assert_allclose(maps["seam"][:, 2], maps["middle"][:, 2], atol=1e-9)
                radius = np.linalg.norm(maps["seam"][:, :2], axis=1)  # the middle may lie on the map's own axes
                np.testing.assert_allclose(radius, np.linalg.norm(maps["middle"][:, :2], axis=1), rtol=2e-3, atol=1e-3)

    def test_a_given_centre_on_the_other_side(self):
        turned = (self.east + 360) % 360 - 180
        path = self.table("seam.csv", np.column_stack([turned, self.lat, self.z]), "lon,lat,z")
        for lon in (180, -180, 540):
            points, _ = self.imported(path, "--crs", WGS84, "--center", f"{lon},10.005")
            np.testing.assert_allclose(points[:, :2], self.expected[:, :2], atol=1e-6)

    def test_a_truth_raster_written_from_0_to_360(self):
        """A DEM just west of Greenwich, its truth in degrees east of it."""
        row, col = np.mgrid[0:20, 0:20]
        dem = self.raster("dem", 100 + row / 8, crs="+proj=ortho +lat_0=0 +lon_0=-0.01 +R=6371000", corner=(-10, -10))
        truth = self.raster("truth", 100 + np.arange(40)[:, None] / 16 + np.zeros((40, 60)), crs="+proj=longlat +R=6371000", corner=(359.9897, -0.0001),
                            cell=1e-5)
        self.succeed("landfall-import", dem, "--truth", truth, "-o", self.path("dem.h5"))
        self.assertTrue(np.isfinite(self.bins()[1]).all())


class BodyFixed(Frames):
    """x, y, z from the centre of the body, as ECEF and altimeters give them."""

    def setUp(self):
        super().setUp()
        random = np.random.default_rng(57)
        self.lon, self.lat = 9.1 + 0.01 * random.random(500), 48.7 + 0.01 * random.random(500)
        self.h = 300 + 20 * random.random(500)

    def test_they_give_the_scan_of_longitudes_latitudes_and_heights(self):
        for geographic_crs, geocentric, (a, f) in [(WGS84, "EPSG:4978", EARTH), (MOON, f"+proj=geocent +R={MOON_M}", (MOON_M, 0)),
                                                   ("+proj=longlat +a=10000 +b=9000", "+proj=geocent +a=10000 +b=9000", (1e4, 0.1))]:
            for center in (["--center", "9.104,48.7035,310"], []):
                with self.subTest(geocentric, center=center):
                    ground = self.table("ground.csv", np.column_stack([self.lon, self.lat, self.h]), "lon,lat,z")
                    expected, origin = self.imported(ground, "--crs", geographic_crs, *center)
                    self.assertEqual(self.said, "")
                    xyz = self.table("xyz.csv", body_fixed(self.lon, self.lat, self.h, a, f))
                    points, found = self.imported(xyz, "--crs", geocentric, *center)
                    self.assertEqual(self.said, "")
                    np.testing.assert_allclose(points, expected, atol=1e-6)
                    np.testing.assert_array_equal(found, origin)
                    with h5py.File(self.path("scan.h5")) as file:
                        self.assertIn("Orthographic", file["crs"].attrs["crs_wkt"].decode())

    def test_across_the_seam(self):
        lon = (self.lon - 9.105 + 360) % 360 - 180
        points, origin = self.imported(self.table("xyz.csv", body_fixed(lon, self.lat, self.h, *EARTH)), "--crs", "EPSG:4978")
        self.assertAlmostEqual(abs(origin[0]), 180, delta=1e-3)
        self.assertLess(np.abs(points[:, :2]).max(), 700)

    def test_what_does_not_fit_is_refused(self):
        path = self.table("xyz.csv", body_fixed(self.lon, self.lat, self.h, *EARTH))
        self.refused(path, "--vertical-scale", arguments=["--crs", "EPSG:4978", "--vertical-scale", "2"], code=2)
        self.refused(path, "beyond a pole", '"+proj=geocent +a=6378137 +b=6356752.3', arguments=["--crs", WGS84])


class Lattice(Frames):
    """On one lattice of DEM and truth no truth is lost beside a hole, and nothing is interpolated."""

    def test_rounded_georeferences(self):
        random = np.random.default_rng(3)
        for corner, cell in [((431000.13, 5012345.67), 500.000000000000057), ((500000.1, 5400000.7), 0.3), ((499123.37, 5400123.11), 0.01)]:
            with self.subTest(cell=cell):
                dem = 100 + random.random((30, 40))
                truth = dem + random.random((30, 40)) / 8
                truth[10:20, 12:22] = np.nan
                paths = [self.raster("dem", dem, corner=corner, cell=cell),
                         self.raster("truth", np.pad(truth, 3, mode="edge"), corner=(corner[0] - 3 * cell, corner[1] - 3 * cell), cell=cell)]
                said = self.succeed("landfall-import", paths[0], "--truth", paths[1], "-o", self.path("dem.h5"), "-O").stderr
                np.testing.assert_array_equal(self.bins()[1], truth[::-1])
                self.assertIn("has no value at 100 of 1200 bins", said)

    def test_terrain_gen_takes_nodes_on_pixel_centres(self):
        values = 100 + np.random.default_rng(5).random((21, 21))
        values[8:11, 13] = np.nan
        path = self.raster("site", values, corner=(500000.13, 5012345.67), cell=0.3)
        for method in ("bilinear", "bicubic"):
            self.succeed("terrain-gen", "--from", path, "--datum", "none", "--interpolation", method, "--half-width", "2.1", "--resolution", "0.3",
                         "-o", self.path("t.h5"), "-O")
            with h5py.File(self.path("t.h5")) as file:
                np.testing.assert_array_equal(file["z"][()], values[::-1][3:-3, 3:-3])

    def test_the_published_statistics_of_demcompare(self):
        """Its own difference of two DEMs, SEC against REF: n 10,167, mean -3.40256, NMAD 10.59014."""
        sec, ref = (os.path.join(JOINTS, f"demcompare_reproj_coreg_{name}.tif") for name in ("SEC", "REF"))
        if not os.path.exists(ref):
            self.skipTest(f"no published pair: {ref}")
        self.succeed("landfall-import", sec, "--truth", ref, "-o", self.path("dem.h5"))
        z, truth = self.bins()
        difference = (z - truth)[np.isfinite(z - truth)]
        self.assertEqual(len(difference), 10167)
        self.assertAlmostEqual(abs(difference.mean()), 3.40256, places=5)
        self.assertAlmostEqual(1.4826 * np.median(np.abs(difference - np.median(difference))), 10.59014, places=4)


class Colours(Frames):
    def setUp(self):
        super().setUp()
        header = b"P6\n40 40\n255\n"
        self.write("picture.ppm", header + (np.arange(40 * 40 * 3) % 251).astype(np.uint8).tobytes())
        self.picture = self.path("picture.tif")
        self.translate("-a_srs", "EPSG:32632", "-a_ullr", "500000", "5400040", "500040", "5400000", self.path("picture.ppm"), self.picture)

    def translate(self, *arguments):
        subprocess.run(["gdal_translate", "-q", *arguments], check=True)

    def test_a_colour_is_not_an_elevation_unless_its_band_is_given(self):
        site = ["--half-width", "8", "--resolution", "1", "-o", self.path("t.h5"), "-O"]
        self.refused(self.picture, "band 1 is a colour (Red)", "(--band)")
        self.refuse(1, "terrain-gen", "--from", self.picture, *site, words=["band 1 is a colour (Red)", "(--band)"], output=self.path("t.h5"))
        for band in ("1", "2", "3"):
            self.succeed("landfall-import", self.picture, "-o", self.path("dem.h5"), "-O", "--band", band)
            z, _ = self.bins()
            self.assertEqual(z[-1, 0], int(band) - 1)
            self.succeed("terrain-gen", "--from", self.picture, "--band", band, *site)
        config = {"base": {"type": "dem", "path": self.picture, "band": 1}, "grid": {"half_width_m": 8, "resolution_m": 1}}
        self.succeed("terrain-gen", "-c", self.config(config), "-o", self.path("t.h5"), "-O")
        del config["base"]["band"]
        self.refuse(1, "terrain-gen", "-c", self.config(config), "-o", self.path("u.h5"), words=["is a colour"], output=self.path("u.h5"))

    def test_palettes_and_truths(self):
        vrt = self.path("palette.vrt")
        self.translate("-b", "1", "-of", "VRT", self.picture, vrt)
        text = read_bytes(vrt).decode()
        table = '<ColorInterp>Palette</ColorInterp><ColorTable><Entry c1="1" c2="2" c3="3" c4="255"/></ColorTable>'
        start, end = text.index("<ColorInterp>"), text.index("</ColorInterp>") + len("</ColorInterp>")
        self.translate(self.write(vrt, text[:start] + table + text[end:]), self.path("palette.tif"))
        self.refused(self.path("palette.tif"), "is a colour (Palette)")
        grey = self.path("grey.tif")
        self.translate("-b", "1", "-colorinterp", "gray", self.picture, grey)
        self.succeed("landfall-import", grey, "-o", self.path("dem.h5"))
        self.refused(grey, "picture.tif: band 1 is a colour", arguments=["--truth", self.picture])
        self.refused(grey, "band 4 is not in 1..1", arguments=["--band", "4"], code=2)

    def test_an_albedo_may_be_a_picture(self):
        albedo = {"ground": {"type": "raster", "path": self.picture, "scale": 1 / 255}}
        self.succeed("terrain-gen", "--set", "grid.half_width_m=5", "--set", "grid.resolution_m=1", "--set", "albedo=" + json.dumps(albedo),
                     "-o", self.path("t.h5"))


class Fills(Frames):
    """One value, repeated exactly, at an end and farther from all others than these are from each other."""

    VALUES = (-10000, -99999.9, -100000, 1e10, -88888, -9999.9, -9998, 99999.99, -3276.8, -12345, -32000, 8888, -1e5)
    SAMPLES = ((-9999, "float64"), (-32768, "int16"), (-32767, "float32"), (-99999, "int32"), (9999, "float32"), (1e6, "float64"),
               (-3.4e38, "float32"), (-3.4028234663852886e38, "float32"), (3.4e38, "float64"), (32767, "int16"), (-2147483647, "int32"),
               (-99999.9, "float64"), (-3276.8, "float64"))

    def setUp(self):
        super().setUp()
        row, col = np.mgrid[0:31, 0:31]
        self.values = 100 + row + 2 * col + np.sin(row * col)
        self.hole = (row - 15) ** 2 + (col - 15) ** 2 < 20

    def filled(self, value):
        return np.where(self.hole, value, self.values)

    def test_rasters(self):
        site = ["--half-width", "10", "--resolution", "1", "-o", self.path("t.h5"), "-O"]
        plain = self.raster("plain", self.values)
        for number, (value, kind) in enumerate(self.SAMPLES):
            with self.subTest(value, kind=kind):
                path = self.raster("dem", self.filled(value), kind=kind)
                value = float(np.dtype(kind).type(value))
                words = [f"{self.hole.sum()} of 961 samples are", "(--nodata)"]
                self.refused(path, *words)
                self.succeed("landfall-import", path, "-o", self.path("dem.h5"), "-O", "--nodata", repr(value))
                np.testing.assert_array_equal(np.isnan(self.bins()[0]), self.hole[::-1])
                if number > 3:  # each kind once; all readers of rasters look for fills alike
                    continue
                self.refuse(1, "terrain-gen", "--from", path, *site, words=words, output=self.path("t.h5"))
                self.refused(plain, "dem.tif", *words, arguments=["--truth", path])
                self.succeed("landfall-import", path, "-o", self.path("dem.h5"), "-O", "--nodata", "none")
                self.assertEqual((self.bins()[0] == value).sum(), self.hole.sum())

    def test_two_fills(self):
        values = self.filled(-12345)
        values[0, :3] = -88888
        path = self.raster("dem", values)
        self.refused(path, "samples are -88888 or -12345", "nodata -88888,-12345", "(--nodata)")
        self.succeed("landfall-import", path, "-o", self.path("dem.h5"), "-O", "--nodata", "-12345,-88888")
        self.assertEqual(np.isnan(self.bins()[0]).sum(), self.hole.sum() + 3)
        self.succeed("terrain-gen", "--from", path, "--half-width", "10", "--resolution", "1", "--nodata", "-12345,-88888", "--datum", "none",
                     "-o", self.path("t.h5"))

    def test_terrain_that_is_no_fill(self):
        """A lake at the lowest level, and a lonely peak."""
        lake = np.where(self.hole, 98, np.round(self.values))
        self.succeed("landfall-import", self.raster("lake", lake, kind="int16"), "-o", self.path("dem.h5"), "-O")
        peak = self.values.copy()
        peak[4, 5] = 5000
        self.succeed("landfall-import", self.raster("peak", peak), "-o", self.path("dem.h5"), "-O")

    def test_heights_of_clouds(self):
        row, col = np.mgrid[0:31, 0:31]
        utm = ["--crs", "EPSG:32632"]
        for value in (*self.VALUES, -9999, -32768):
            with self.subTest(value):
                path = self.table("grid.csv", np.column_stack([500000 + col.ravel(), 5400000 + row.ravel(), self.filled(value).ravel()]))
                self.refused(path, f"{self.hole.sum()} of 961 points have z", "--nodata", arguments=utm)
                points, _ = self.imported(path, *utm, "--nodata", repr(value))
                self.assertEqual(len(points), 961 - self.hole.sum())
                self.assertIn(f"{self.hole.sum()} points with a z of --nodata are left out", self.said)
        points, _ = self.imported(path, *utm, "--nodata", "none")
        self.assertEqual(len(points), 961)

    def test_a_position_that_many_points_share(self):
        """No return as 0, 0, 0 among points around it: neither x nor z is apart."""
        random = np.random.default_rng(8)
        for count, shared, is_refused in [(1500, 300, True), (1500, 16, True), (1500, 15, False), (400, 9, False), (300000, 3100, True)]:
            with self.subTest(shared=shared):
                points = np.concatenate([random.normal(size=(count, 3)), np.zeros((shared, 3))])
                path = self.table("zeros.csv", random.permutation(points))
                if not is_refused:
                    self.imported(path)
                    continue
                self.refused(path, "points share the position 0, 0, 0", "--nodata 0")
                self.assertEqual(len(self.imported(path, "--nodata", "0")[0]), count)
                self.assertEqual(len(self.imported(path, "--nodata", "none")[0]), count + shared)

    def test_options_that_do_not_fit(self):
        path = self.table("few.csv", [[0, 0, 0], [1, 1, 1]])
        self.refused(path, "--band is for rasters", arguments=["--band", "1"], code=2)
        self.refused(path, "--nodata: 'x' is not a number", arguments=["--nodata", "x"], code=2)


class Large(Frames):
    def test_a_raster_that_is_too_large_names_the_command_that_cuts_it(self):
        path = self.path("sparse.tif")
        subprocess.run(["gdal_create", "-q", "-outsize", "60000", "60000", "-ot", "Float32", "-co", "SPARSE_OK=TRUE", "-co", "TILED=YES", "-a_srs",
                        "EPSG:32632", "-a_ullr", "500000", "5460000", "560000", "5400000", path], check=True)
        self.refused(path, "60,000 x 60,000 pixels", "gdal_translate -projwin")


if __name__ == "__main__":
    unittest.main()
