#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""terrain-gen on rasters whose geometry, units or holes other readers get wrong: right, refused with both values named, or
loaded with one warning that says what was assumed."""
import os
import sys
import unittest

import h5py
import numpy as np
import pyproj

from harness import ToolTest, run

sys.path.insert(0, os.path.join(os.environ["LANDFALL_ROOT"], "testdata"))
import foreign_rasters as foreign  # noqa: E402
import raster_formats as formats  # noqa: E402
from foreign_rasters import COLS, GX, GY, POSTING_M, ROWS, offsets, plane  # noqa: E402

MOON_M = 1737400.0
METRES = {"units": "m"}
KM = {"units": "km"}
PROJECTED = {"grid_mapping_name": "polar_stereographic", "latitude_of_projection_origin": -90.0,
             "straight_vertical_longitude_from_pole": 0.0, "scale_factor_at_projection_origin": 1.0, "false_easting": 0.0,
             "false_northing": 0.0, "semi_major_axis": MOON_M, "semi_minor_axis": MOON_M}
POLAR_WKT = pyproj.CRS(f"+proj=stere +lat_0=-90 +R={MOON_M}").to_wkt("WKT1_GDAL")


def cf(axis, unit="m"):
    return {"units": unit, "standard_name": f"projection_{axis.lower()}_coordinate", "axis": axis}


class ForeignRasters(ToolTest):
    def load(self, path, *options, warnings=(), interpolation="bilinear"):
        output = self.path("site.h5")
        result = run("terrain-gen", "--from", path, "--datum", "none", "--interpolation", interpolation, *options, "-O", "-o", output)
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), len(warnings), result.stderr)
        for line, words in zip(lines, warnings):
            self.assertTrue(line.startswith(f"terrain-gen: warning: {path}: "), line)
            for word in words:
                self.assertIn(word, line)
        with h5py.File(output) as file:
            return file["x"][()], file["y"][()], file["z"][()]

    def refused(self, path, *words, options=(), code=1):
        output = self.path("refused.h5")
        result = run("terrain-gen", "--from", path, "--datum", "none", *options, "-o", output)
        self.assertEqual(result.returncode, code, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertFalse(os.path.exists(output))

    def check_plane(self, loaded, slopes=(GX, GY), scale=1.0, tolerance=1e-6):
        x, y, z = loaded
        seen = np.isfinite(z)
        columns = np.column_stack([np.broadcast_to(x[None, :], z.shape)[seen], np.broadcast_to(y[:, None], z.shape)[seen],
                                   np.ones(seen.sum())])
        fit, *_ = np.linalg.lstsq(columns, z[seen], rcond=None)
        np.testing.assert_allclose(fit[:2], np.multiply(slopes, scale), atol=tolerance)
        return fit[2]


class Coordinates(ForeignRasters):
    """netCDF and HDF5: the coordinate variables say where the samples are."""

    def test_without_cf_attributes_in_both_directions(self):
        for attributes, options in ((METRES, ()), (None, ("--horizontal-scale", "1"))):
            for x, y in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
                path = foreign.netcdf(self.path("f.nc"), x=offsets(COLS)[::x], y=offsets(ROWS)[::y] + 1e4,
                                      z=plane(offsets(COLS)[::x], offsets(ROWS)[::y]), x_attributes=attributes, y_attributes=attributes)
                loaded = self.load(path, *options)
                self.assertAlmostEqual(loaded[0][1] - loaded[0][0], POSTING_M)
                self.check_plane(loaded)

    def test_transposed(self):
        for x_attributes, y_attributes in ((METRES, METRES), (cf("X"), cf("Y"))):
            path = foreign.netcdf(self.path("t.nc"), x_attributes=x_attributes, y_attributes=y_attributes, transposed=True)
            self.check_plane(self.load(path))

    def test_spellings_of_metres(self):
        for unit, metres in (("m", 1), ("metre", 1), ("metres", 1), ("meter", 1), ("meters", 1), ("Metre", 1), ("km", 1000),
                             ("kilometers", 1000), ("KM", 1000), ("cm", 0.01), ("100 m", 100), ("US_survey_foot", 1200 / 3937)):
            path = foreign.netcdf(self.path("u.nc"), x_attributes={"units": unit}, y_attributes={"units": unit}, spacing_m=metres,
                                  z_attributes=METRES)
            self.check_plane(self.load(path, "--resolution", str(POSTING_M * metres)), tolerance=1e-9)
        path = foreign.netcdf(self.path("u.nc"), x_attributes={"units": "cubit"}, y_attributes={"units": "cubit"})
        self.refused(path, "'cubit'", "--horizontal-scale")
        self.check_plane(self.load(path, "--horizontal-scale", "1"))

    def test_different_units_of_x_and_y(self):
        path = foreign.netcdf(self.path("u.nc"), x=offsets(COLS) / 1000, x_attributes=KM, y_attributes=METRES,
                              z=plane(offsets(COLS), offsets(ROWS)), z_attributes=METRES)
        self.check_plane(self.load(path, "--resolution", "5"), tolerance=1e-9)
        self.refused(foreign.netcdf(self.path("u.nc"), x_attributes=METRES), "contradicts itself", "x in 'm', y in ''")

    def test_kilometres_under_a_crs_in_metres(self):
        x, y, z = offsets(COLS) / 1000, offsets(ROWS) / 1000, plane(offsets(COLS), offsets(ROWS))
        for crs, warnings in ((PROJECTED, ()), ({**PROJECTED, "crs_wkt": POLAR_WKT}, [("'km'", "coordinate variables are used")]),
                              ({**PROJECTED, "spatial_ref": POLAR_WKT}, [("'km'", "spacings (5, -5) and (0.005, -0.005)")])):
            path = foreign.netcdf(self.path("km.nc"), x=x, y=y, z=z, x_attributes=cf("X", "km"), y_attributes=cf("Y", "km"), crs=crs,
                                  z_attributes=METRES)
            loaded = self.load(path, warnings=warnings)
            self.assertAlmostEqual(loaded[0][1] - loaded[0][0], POSTING_M)
            self.check_plane(loaded)

    def test_what_was_assumed_is_kept(self):
        path = foreign.netcdf(self.path("km.nc"), x=offsets(COLS) / 1000, y=offsets(ROWS) / 1000, x_attributes=cf("X", "km"),
                              y_attributes=cf("Y", "km"), crs={**PROJECTED, "crs_wkt": POLAR_WKT}, z_attributes=METRES)
        self.load(path, warnings=[("'km'",)])
        shown = run("landfall-info", self.path("site.h5"))
        self.assertIn("assumed", shown.stdout)
        self.assertIn("the coordinate variables are used", " ".join(shown.stdout.split()))

    def test_a_stale_georeference_loses_against_the_coordinates(self):
        crs = {**PROJECTED, "crs_wkt": POLAR_WKT, "spatial_ref": POLAR_WKT, "GeoTransform": "-1000 20 0 1000 0 -20"}
        path = foreign.netcdf(self.path("cut.nc"), x_attributes=cf("X"), y_attributes=cf("Y"), crs=crs)
        result = run("terrain-gen", "--from", path, "--datum", "none", "-o", self.path("site.h5"))
        self.assertEqual(result.returncode, 0, result.stderr)
        with h5py.File(self.path("site.h5")) as file:
            self.check_plane((file["x"][()], file["y"][()], file["z"][()]))

    def test_contradictory_kinds_of_units(self):
        path = foreign.netcdf(self.path("d.nc"), x_attributes=cf("X", "degrees"), y_attributes=cf("Y", "degrees"),
                              crs={**PROJECTED, "crs_wkt": POLAR_WKT})
        self.refused(path, "contradicts itself", "'degrees'")

    def test_gaps(self):
        for at in (1, COLS // 2, COLS - 2):
            x = offsets(COLS)
            x[at:] += POSTING_M
            path = foreign.netcdf(self.path("gap.nc"), x=x, x_attributes=METRES, y_attributes=METRES)
            self.refused(path, "coordinate variable 'x'", "even spacing")
        y = offsets(ROWS)
        y[5] = np.nan
        path = foreign.netcdf(self.path("gap.nc"), y=y, z=plane(offsets(COLS), offsets(ROWS)), x_attributes=cf("X"), y_attributes=cf("Y"))
        self.refused(path, "coordinate variable 'y'", "not finite")

    def test_packed_and_single_precision_coordinates(self):
        path = foreign.netcdf(self.path("p.nc"), packed=(POSTING_M / 2, 100.0), x=offsets(COLS) + 300, y=offsets(ROWS) + 300,
                              x_attributes=METRES, y_attributes=METRES)
        self.check_plane(self.load(path))
        path = foreign.netcdf(self.path("s.nc"), coordinate_type="f4", x=offsets(COLS) + 3e6, y=offsets(ROWS) + 3e6,
                              x_attributes=METRES, y_attributes=METRES, z=plane(offsets(COLS), offsets(ROWS)))
        self.check_plane(self.load(path))
        path = foreign.netcdf(self.path("s.nc"), coordinate_type="f4", x=offsets(COLS, 0.3) + 3e6, y=offsets(ROWS),
                              x_attributes=METRES, y_attributes=METRES)
        self.refused(path, "coordinate variable 'x'", "too few digits")

    def test_hdf5_with_dimension_scales(self):
        for y in (offsets(ROWS), offsets(ROWS)[::-1]):
            path = foreign.hdf5(self.path("f.h5"), y=y, attributes={"units": "km", "scale_factor": 0.001, "_FillValue": -1e5})
            self.check_plane(self.load(f'HDF5:"{path}"://z'))


class Heights(ForeignRasters):
    def values(self, **kwargs):
        return foreign.netcdf(self.path("h.nc"), x_attributes=METRES, y_attributes=METRES, **kwargs)

    def test_units_with_a_datum(self):
        for unit, scale in (("m above MSL", 1), ("metres (NAVD88)", 1), ("km above the ellipsoid", 1000), ("foot", 0.3048)):
            self.check_plane(self.load(self.values(z_attributes={"units": unit})), scale=scale, tolerance=1e-4 * scale)

    def test_downwards(self):
        for attributes in ({"units": "m", "positive": "down"}, {"units": "m", "standard_name": "depth"}, {"units": "m below MSL"}):
            path = self.values(z_attributes=attributes)
            self.check_plane(self.load(path, warnings=[("count downwards", "vertical_scale")]), scale=-1)
            self.check_plane(self.load(path, "--vertical-scale=-2"), scale=-2)

    def test_valid_ranges_in_the_units_that_they_are_meant_in(self):
        packed = {"scale_factor": 0.5, "add_offset": 10.0}
        z = np.arange(ROWS * COLS, dtype="i2").reshape(ROWS, COLS)
        meant = 0.5 * z + 10
        for limits, valid in (({"valid_range": np.array([500, 700], "i2")}, (z >= 500) & (z <= 700)),
                              ({"valid_range": np.array([260.0, 400.0])}, (meant >= 260) & (meant <= 400)),
                              ({"valid_min": np.float64(300)}, meant >= 300), ({"valid_max": np.int16(600)}, z <= 600)):
            path = self.values(z=z, z_type="i2", z_attributes={**packed, **limits})
            _, _, loaded = self.load(path, "--half-width", "50", interpolation="nearest")
            inner = valid[5:-5, 10:-10], meant[5:-5, 10:-10]
            np.testing.assert_array_equal(np.isfinite(loaded), inner[0])
            np.testing.assert_allclose(loaded[inner[0]], inner[1][inner[0]])

    def test_missing_value_beside_fill_value(self):
        z = plane(offsets(COLS), offsets(ROWS))
        z[10, 10], z[12, 12] = -1e5, -2e5
        _, _, loaded = self.load(self.values(z=z, fill=-1e5, z_attributes={"missing_value": -2e5}))
        self.assertEqual(np.isnan(loaded).sum(), 2)

    def test_pds3_units(self):
        z = plane(offsets(COLS, foreign.PDS3_POSTING_M), -offsets(ROWS, foreign.PDS3_POSTING_M))
        for unit, scale in (("KILOMETER", 1000), ("METER", 1), ("<KM>", 1000), ("M", 1)):
            path = foreign.pds3(self.path(""), f"  UNIT = {unit}\n  SCALING_FACTOR = 1\n  OFFSET = 1737.4", z)
            base = self.check_plane(self.load(path), scale=scale, tolerance=1e-4 * scale)
            self.assertAlmostEqual(base, 1737.4 * scale, delta=1e-3 * scale)
        path = foreign.pds3(self.path(""), "  SCALING_FACTOR = 0.5 <KM>", z)
        self.check_plane(self.load(path), scale=500, tolerance=0.05)
        self.refused(foreign.pds3(self.path(""), "  UNIT = KELVIN", z), "'KELVIN'", "--vertical-scale")

    def test_a_map_in_feet_whose_heights_say_nothing(self):
        keys = {1024: 1, 1025: 1, 3072: 2903}
        path = foreign.geotiff(self.path("feet.tif"), keys, (2e6, 10, 0, 5e5, 0, -10), plane(offsets(COLS), -offsets(ROWS)))
        self.load(path, warnings=[("elevations in metres are assumed", "vertical_scale")])
        self.load(path, "--vertical-scale", "0.3048")


class MapScales(ForeignRasters):
    """A plane on the ground in a map whose scale at the site is not 1."""

    def mapped(self, definition, longitude, latitude, step=1.0):
        """A GeoTIFF in a map projection of the sphere of the Moon, by GDAL's own writer."""
        import rasterio
        local = pyproj.Transformer.from_crs(f"+proj={definition} +R={MOON_M}", f"+proj=ortho +lon_0={longitude} +lat_0={latitude} +R={MOON_M}")
        x0, y0 = local.transform(0, 0, direction="INVERSE")
        cols, rows = np.meshgrid(np.arange(121) - 60, np.arange(121) - 60)
        east, north = local.transform(x0 + step * cols, y0 - step * rows)
        path = self.path("map.tif")
        with rasterio.open(path, "w", driver="GTiff", width=121, height=121, count=1, dtype="float64", crs=f"+proj={definition} +R={MOON_M}",
                           transform=rasterio.Affine(step, 0, x0 - 60.5 * step, 0, -step, y0 + 60.5 * step)) as file:
            file.write(GX * east + GY * north, 1)
        return path

    def test_slopes_are_those_of_the_ground(self):
        for definition, longitude, latitude in (
                ("eqc", 20, 60), ("merc", 20, 60), ("sinu", 175, 30), ("stere +lat_0=90 +k_0=0.994", 30, 88),
                ("eqc +lat_ts=60", 20, 5), ("lcc +lat_1=20 +lat_2=60", 70, 70), ("moll", -100, -40), ("merc", 179.9999, -70)):
            with self.subTest(definition=definition):
                path = self.mapped(definition, longitude, latitude)
                self.check_plane(self.load(path, "--half-width", "12", "--resolution", "0.5"), tolerance=2e-5)

    def test_a_true_scale_keeps_the_axes_of_the_map(self):
        path = self.mapped("stere +lat_0=90", 30, 89.5)
        x, y, z = self.load(path, "--half-width", "12", "--resolution", "0.5")
        turn = np.radians(30)  # of the map against east and north
        expected = GX * (np.cos(turn) * x[None, :] + np.sin(turn) * y[:, None]) + GY * (np.cos(turn) * y[:, None] - np.sin(turn) * x[None, :])
        np.testing.assert_allclose(z, expected, atol=5e-3)


class GlobalRasters(ForeignRasters):
    """Longitudes close around the body, and beyond a pole lies the other side."""

    def world(self, first_longitude, grid_registered=False):
        """Heights of a plane through the Moon's centre: smooth everywhere, poles and seam included."""
        step = 0.5
        shift = 0 if grid_registered else step / 2
        lon = np.radians(first_longitude + shift + step * np.arange(round(360 / step) + (1 if grid_registered else 0)))
        lat = np.radians(90 - shift - step * np.arange(round(180 / step) + (1 if grid_registered else 0)))
        z = self.height(lon[None, :], lat[:, None])
        edge = step / 2 if grid_registered else 0
        return foreign.geotiff(self.path("world.tif"), formats.sphere(MOON_M), (first_longitude - edge, step, 0, 90 + edge, 0, -step), z)

    @staticmethod
    def height(lon, lat):
        return 1000 * (np.cos(lat) * np.cos(lon) + 2 * np.cos(lat) * np.sin(lon) + 3 * np.sin(lat))

    def test_sites_at_the_seam_and_at_the_poles(self):
        for first, registered in ((-180, False), (0, False), (-180, True)):
            path = self.world(first, registered)
            for center in ("180,10", "-180,-35", "0.1,0", "359.9,60", "30,89.9", "-100,-90", "75,90", "10,88"):
                with self.subTest(first=first, registered=registered, center=center):
                    lon0, lat0 = (float(value) for value in center.split(","))
                    x, y, z = self.load(path, f"--center={center}", "--half-width", "60000", "--resolution", "5000", interpolation="bicubic")
                    ortho = pyproj.Proj(proj="ortho", lon_0=lon0, lat_0=lat0, R=MOON_M)
                    lon, lat = ortho(*np.meshgrid(x, y), inverse=True)
                    np.testing.assert_allclose(z, self.height(np.radians(lon), np.radians(lat)), atol=0.5)

    def test_a_raster_that_ends_before_the_pole_is_refused_there(self):
        z = np.zeros((100, 720)) + np.arange(100)[:, None]
        path = foreign.geotiff(self.path("belt.tif"), formats.sphere(MOON_M), (-180, 0.5, 0, 80, 0, -0.5), z)
        self.refused(path, "does not lie inside", options=("--center=0,79.9", "--half-width", "60000", "--resolution", "5000"))


class Fills(ForeignRasters):
    def holed(self, value, kind="float64", count=1, relief=1.0):
        z = relief * plane(offsets(COLS), -offsets(ROWS))
        z = np.round(z).astype(kind) if np.dtype(kind).kind == "i" else z.astype(kind)
        z.ravel()[500:500 + count] = value
        return foreign.geotiff(self.path("fill.tif"), formats.polar_stereographic(MOON_M), (0, 5, 0, 0, 0, -5), z)

    def test_numbers_among_the_rest_are_elevations(self):
        self.load(self.holed(-9999, "float64", 1, 2000))      # the ground reaches below it
        self.load(self.holed(5, "float64", 40))

    def test_zeros_around_the_ground(self):
        ground = plane(offsets(COLS), offsets(ROWS))
        for relief in (0.5, 1.5):  # from 0 to the lowest ground; farther than its own relief they are fills
            z = ground - ground.min() + relief * np.ptp(ground)
            z[:3], z[-3:], z[:, :3], z[:, -3:] = 0, 0, 0, 0
            path = foreign.geotiff(self.path("zero.tif"), formats.polar_stereographic(MOON_M), (0, 5, 0, 0, 0, -5), z)
            if relief < 1:
                self.load(path, warnings=[("samples of 0 fill the border", "nodata 0")])
            else:
                self.refused(path, "samples are 0, which looks like an undeclared fill value", "--nodata")
            _, _, holed = self.load(path, "--nodata", "0")
            self.assertGreater(np.nanmin(holed), 0)
        flat = foreign.geotiff(self.path("zero.tif"), formats.polar_stereographic(MOON_M), (0, 5, 0, 0, 0, -5), z * 0)
        self.load(flat)


if __name__ == "__main__":
    unittest.main()
