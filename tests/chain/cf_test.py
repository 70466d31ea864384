#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that say Conventions = "CF-1.8" keep its rules; each test names the section of the CF conventions that it checks.

The rules are those of "CF Conformance Requirements and Recommendations 1.8" that apply to what the files hold: no time, vertical or
auxiliary coordinates, no bounds, cell methods, packing or compression by gathering. Debian 12 and npm have no CF checker.
"""
import os
import re
import shutil
import subprocess
import unittest

import netCDF4
import numpy as np
import pyproj

from harness import ChainTest, ToolTest, run

RASTERS = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "rasters")
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")
# Appendix F: the attributes that belong to a projection, besides those of the body. The false origin is optional in CF.
APPENDIX_F = {
    "albers_conical_equal_area": {"standard_parallel", "longitude_of_central_meridian", "latitude_of_projection_origin"},
    "azimuthal_equidistant": {"longitude_of_projection_origin", "latitude_of_projection_origin"},
    "lambert_azimuthal_equal_area": {"longitude_of_projection_origin", "latitude_of_projection_origin"},
    "lambert_conformal_conic": {"standard_parallel", "longitude_of_central_meridian", "latitude_of_projection_origin"},
    "mercator": {"longitude_of_projection_origin", "standard_parallel|scale_factor_at_projection_origin"},
    "orthographic": {"longitude_of_projection_origin", "latitude_of_projection_origin"},
    "polar_stereographic": {"straight_vertical_longitude_from_pole", "latitude_of_projection_origin",
                            "standard_parallel|scale_factor_at_projection_origin"},
    "sinusoidal": {"longitude_of_projection_origin"},
    "stereographic": {"longitude_of_projection_origin", "latitude_of_projection_origin", "scale_factor_at_projection_origin"},
    "transverse_mercator": {"scale_factor_at_central_meridian", "longitude_of_central_meridian", "latitude_of_projection_origin"},
}
NAMES_OF_A_CRS = {"reference_ellipsoid_name", "prime_meridian_name", "horizontal_datum_name", "geographic_crs_name"}
# The CF names of the projections of these PROJ strings; None: CF has none, and the file makes no claim.
PROJECTIONS = {
    "+proj=utm +zone=31 +datum=WGS84": ("transverse_mercator", 3, 20),
    "+proj=tmerc +lat_0=10 +lon_0=-20 +k=0.9995 +x_0=500 +y_0=-300 +R=1737400": ("transverse_mercator", -20, 10),
    "+proj=stere +lat_0=90 +lon_0=15 +k=0.994 +ellps=WGS84": ("polar_stereographic", 15, 81.11),
    "+proj=stere +lat_0=-90 +lat_ts=-70 +lon_0=40 +R=1737400": ("polar_stereographic", 40, -70),
    "+proj=ortho +lat_0=-32.5 +lon_0=-27.3 +R=1561500": ("orthographic", -27.3, -32.5),
    "+proj=lcc +lat_1=33 +lat_2=45 +lat_0=39 +lon_0=-96 +ellps=GRS80": ("lambert_conformal_conic", -96, 33),
    "+proj=lcc +lat_1=33 +lat_0=33 +lon_0=-96 +ellps=GRS80": ("lambert_conformal_conic", -96, 33),
    "+proj=lcc +lat_1=33 +lat_0=33 +lon_0=-96 +k_0=0.9995 +ellps=GRS80": (None, -96, 33),  # CF has no scale factor for a cone
    "+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-96 +ellps=GRS80": ("albers_conical_equal_area", -96, 29.5),
    "+proj=laea +lat_0=52 +lon_0=10 +ellps=GRS80": ("lambert_azimuthal_equal_area", 10, 52),
    "+proj=laea +lat_0=52 +lon_0=10 +R=3396190": ("lambert_azimuthal_equal_area", 10, 52),
    "+proj=merc +lat_ts=20 +lon_0=5 +R=3396190": ("mercator", 5, 20),
    "+proj=merc +k=0.9 +lon_0=5 +R=3396190": ("mercator", 5, 25.842),
    "+proj=sinu +lon_0=20 +R=3396190": ("sinusoidal", 20, 5),
    "+proj=aeqd +lat_0=40 +lon_0=10 +R=3396190": ("azimuthal_equidistant", 10, 40),
    "+proj=stere +lat_0=40 +lon_0=10 +k=0.99 +R=3396190": ("stereographic", 10, 51.478),
    "+proj=eqc +lat_ts=10 +R=3396190": (None, 0, 10),
    "+proj=omerc +lat_0=4 +lonc=115 +alpha=53 +k=0.99984 +ellps=evrstSS": (None, 115, 4),
}


def attributes(item):
    return {name: item.getncattr(name) for name in item.ncattrs()}


def variables(group, path="/"):
    """(path, variable) of a group and those below."""
    for name, variable in group.variables.items():
        yield path + name, variable
    for name, below in group.groups.items():
        yield from variables(below, f"{path}{name}/")


def groups(group):
    yield group
    for below in group.groups.values():
        yield from groups(below)


class Rules(ChainTest):
    """Files of the tiny chain in its local frame, a plan, DEMs with every layer, and terrains, a DEM and a hazard map on maps of bodies."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        chain, path = cls.chain, cls.chain.path
        made = {"plan.h5": ["scan-sim", "--plan", "--plan-radius", "5", "-c", chain.config("scan-sim"), "-q"],
                "all.nc": ["regrid", *chain.inputs("regrid"), "--uncertainty", "--corrected", "--navigation-sigma", "position_m=0.05"],
                "one.nc": ["regrid", *chain.inputs("regrid"), "--layers", "z_est"],
                "features.h5": ["terrain-gen", "--set", 'features=[{"type":"cone","radius_m":1,"height_m":1}]', "--half-width", "5"],
                "polar.nc": ["terrain-gen", "--from", os.path.join(RASTERS, "polar_stereographic.tif"), "--half-width", "10",
                             "--resolution", "0.5"],
                "polar_scan.h5": ["scan-sim", "--terrain", path("polar.nc"), "-c", chain.config("scan-sim")],
                "polar_dem.nc": ["regrid", path("polar_scan.h5"), "-c", chain.config("regrid"), "--terrain", path("polar.nc")],
                "hazards.nc": ["hazard-map", chain.dem, "--set", "region_radius_m=4", "--set", "z_sigma_m=0.02"],
                "polar_hazards.nc": ["hazard-map", path("polar.nc"), "--set", "lander.leg_radius_m=1.5"]}
        for name, (tool, *arguments) in made.items():
            result = run(tool, *arguments, "-o", path(name))
            if result.returncode:
                raise AssertionError(result.stderr)
        cls.paths = [chain.terrain, chain.scan, chain.dem, chain.eval, *map(path, made)]

    def files(self):
        for path in self.paths:
            with self.subTest(os.path.basename(path)), netCDF4.Dataset(path) as file:
                file.set_auto_mask(False)
                yield file

    def items(self):
        for file in self.files():
            for path, variable in variables(file):
                with self.subTest(path):
                    yield file, path, variable

    def test_2_2_data_types(self):
        """CF-1.8 knows no 64-bit integers (CF-1.9 does): only row numbers of tables, which can exceed 2^31, are."""
        allowed = {"f8", "f4", "i4", "i1"}
        for _, path, variable in self.items():
            if path not in ("/pulses/point_begin", "/holes/size_bins", "/holes/row", "/holes/column", "/features/number"):
                self.assertIn("text" if variable.dtype is str else variable.dtype.str[1:].replace("S1", "text"), allowed | {"text"})

    def test_2_3_names(self):
        for file in self.files():
            for group in groups(file):
                names = [*group.variables, *group.groups, *group.dimensions, *group.ncattrs()]
                self.assertEqual([name for name in names if not NAME.match(name)], [])
                lower = [name.lower() for name in group.variables]
                self.assertEqual(len(lower), len(set(lower)))
        for _, _, variable in self.items():
            self.assertEqual([name for name in variable.ncattrs() if not NAME.match(name) and name != "_FillValue"], [])

    def test_2_4_dimensions(self):
        for _, path, variable in self.items():
            self.assertEqual(len(set(variable.dimensions)), len(variable.dimensions))
            if len(variable.dimensions) == 2:
                self.assertEqual(variable.dimensions, ("y", "x"), path)

    def test_2_5_1_fill_value_and_actual_range(self):
        for _, path, variable in self.items():
            found = attributes(variable)
            self.assertLessEqual({"valid_min", "valid_max", "valid_range", "missing_value", "scale_factor"} & found.keys(), set())
            if "_FillValue" in found:
                self.assertEqual(np.asarray(found["_FillValue"]).dtype, variable.dtype)
            if variable.ndim != 2:
                continue
            values = variable[...]
            values = values[~np.isnan(values)] if variable.dtype.kind == "f" else values.ravel()
            self.assertEqual("actual_range" in found, values.size > 0)  # "must not be present if all values are missing"
            if values.size:
                self.assertEqual(found["actual_range"].dtype, variable.dtype)
                self.assertEqual(found["actual_range"].tolist(), [values.min(), values.max()], path)

    def test_2_6_1_conventions(self):
        for file in self.files():
            self.assertEqual(file.Conventions, "CF-1.8")

    def test_2_6_2_description(self):
        for file in self.files():
            for name in ("title", "history", "source"):
                self.assertIsInstance(file.getncattr(name), str)
            steps = file.history.splitlines()
            self.assertTrue(all(re.fullmatch(r"landfall [\w-]+ \d+\.\d+\.\d+, file_id [0-9a-f]{32}", step) for step in steps), steps)
            self.assertTrue(steps[-1].endswith(file.file_id))
        with netCDF4.Dataset(self.chain.eval) as file:
            self.assertEqual([step.split()[1] for step in file.history.splitlines()], ["terrain-gen", "scan-sim", "regrid", "dem-eval"])

    def test_2_7_groups(self):
        for file in self.files():
            for below in list(groups(file))[1:]:
                self.assertFalse({"Conventions", "external_variables"} & set(below.ncattrs()))

    def test_3_description(self):
        for _, _, variable in self.items():
            self.assertTrue(variable.long_name)

    def test_3_1_units(self):
        units = {variable.units for _, _, variable in self.items()}
        self.assertLessEqual({"m", "1", "s", "rad"}, units)
        if not shutil.which("udunits2"):
            self.skipTest("udunits2 is not installed: the units are not checked by it")
        for unit in units:
            result = subprocess.run(["udunits2", "-H", unit, "-W", ""], capture_output=True, text=True, check=False, input="")
            self.assertEqual((result.returncode, result.stderr), (0, ""), unit)

    def test_3_3_standard_names(self):
        """Only two of the table are used, both in metres."""
        for _, path, variable in self.items():
            expected = {"/x": "projection_x_coordinate", "/y": "projection_y_coordinate"}.get(path)
            self.assertEqual(attributes(variable).get("standard_name"), expected)
            if expected:
                self.assertEqual(variable.units, "m")

    def test_3_4_ancillary_variables(self):
        named = {}
        for file, path, variable in self.items():
            for name in attributes(variable).get("ancillary_variables", "").split():
                self.assertEqual(file.variables[name].dimensions, variable.dimensions)
                named.setdefault(path, set()).add(name)
        self.assertEqual(named, {"/z_est": {"count", "weight_sum", "z_spread", "z_sigma_abs", "z_sigma_rel"},
                                 "/z_corrected": {"count", "z_corrected_sigma_abs", "z_corrected_sigma_rel"}} |
                         {f"/{what}_{axis}": {"fail"} for what in ("abs", "rel") for axis in "xyz"} |
                         {f"/{what}{of}": {"safe" + of} for what in ("slope", "roughness") for of in ("", "_true")})

    def test_3_5_flags(self):
        seen = 0
        for _, path, variable in self.items():
            found = attributes(variable)
            flags = np.atleast_1d(found.get("flag_values", found.get("flag_masks", [])))
            self.assertEqual("flag_meanings" in found, flags.size > 0)
            if not flags.size:
                continue
            seen += 1
            self.assertEqual(flags.dtype, variable.dtype)
            self.assertEqual(len(set(flags.tolist())), flags.size)
            self.assertEqual(len(found["flag_meanings"].split()), flags.size, path)
            self.assertRegex(found["flag_meanings"], r"\A[\w.+@ -]+\Z")
            self.assertFalse("flag_masks" in found and 0 in flags)
        self.assertGreaterEqual(seen, 6)

    def test_4_axis(self):
        for _, path, variable in self.items():
            self.assertEqual(attributes(variable).get("axis"), {"/x": "X", "/y": "Y"}.get(path))
            self.assertNotIn("positive", variable.ncattrs())

    def test_4_4_no_time_coordinate(self):
        """A time coordinate would need a reference time; times here are seconds since the first pulse."""
        for _, path, variable in self.items():
            if variable.units == "s":
                self.assertNotEqual(variable.dimensions, (path.rpartition("/")[2],))

    def test_5_coordinates(self):
        for file, path, variable in self.items():
            self.assertNotIn("coordinates", variable.ncattrs())
            for dimension in variable.dimensions:
                coordinate = file.variables.get(dimension)
                if coordinate is not None:
                    self.assertTrue((np.diff(coordinate[...]) > 0).all(), path)
                    self.assertFalse({"_FillValue", "missing_value"} & set(coordinate.ncattrs()))

    def test_5_6_grid_mapping(self):
        mapped = set()
        for file, path, variable in self.items():
            name = attributes(variable).get("grid_mapping")
            if name is None:
                continue
            mapped.add(path)
            crs = file.variables[name]
            self.assertEqual(crs.dimensions, ())
            self.check_mapping(attributes(crs))
        self.assertLessEqual({"/z", "/z_est", "/count", "/safe", "/cost"}, mapped)

    def check_mapping(self, crs):
        self.assertIn(crs["grid_mapping_name"], APPENDIX_F)
        for alternatives in APPENDIX_F[crs["grid_mapping_name"]] | {"earth_radius|semi_major_axis", "longitude_of_prime_meridian"}:
            self.assertEqual(sum(name in crs for name in alternatives.split("|")), 1, alternatives)
        self.assertEqual("inverse_flattening" in crs, "semi_major_axis" in crs)
        self.assertIn(len(NAMES_OF_A_CRS & crs.keys()), (0, len(NAMES_OF_A_CRS)))
        texts = NAMES_OF_A_CRS | {"grid_mapping_name", "projected_crs_name", "crs_wkt", "long_name", "units"}
        for name, value in crs.items():
            self.assertEqual(isinstance(value, str), name in texts, name)

    def test_5_6_a_local_frame_has_no_grid_mapping(self):
        for path in (self.chain.terrain, self.chain.dem, self.chain.eval, self.chain.path("plan.h5"), self.chain.path("hazards.nc")):
            with netCDF4.Dataset(path) as file:
                self.assertEqual([name for name, variable in variables(file) if "grid_mapping" in variable.ncattrs()], [])
                self.assertRegex(file["crs"].crs_wkt, r"^ENGCRS\[")


@unittest.skipUnless(shutil.which("gdal_translate"), "gdal-bin is not installed")
class GridMappings(ToolTest):
    """The parameters of /crs give the projection that its WKT gives, by PROJ."""

    def test_parameters_and_wkt_give_the_same_coordinates(self):
        for projection, (expected, longitude, latitude) in PROJECTIONS.items():
            with self.subTest(projection):
                raster, terrain = self.path("map.tif"), self.path("terrain.nc")
                x, y = pyproj.Proj(projection)(longitude, latitude)
                corners = [f"{value:.3f}" for value in (x - 30, y + 30, x + 30, y - 30)]
                subprocess.run(["gdal_translate", "-q", "-a_srs", projection, "-a_ullr", *corners,
                                os.path.join(RASTERS, "three_bands_minus_inf.tif"), raster, "-b", "2"], check=True, capture_output=True)
                self.succeed("terrain-gen", "--from", raster, "-o", terrain, "-O", "--half-width", "4", "--resolution", "1")
                with netCDF4.Dataset(terrain) as file:
                    self.assertEqual(file["z"].grid_mapping, "crs")  # a reader of WKT finds the frame in any case
                    self.assertEqual(getattr(file, "Conventions", None), "CF-1.8" if expected else None)
                    crs = attributes(file["crs"])
                self.assertEqual(crs.get("grid_mapping_name"), expected)
                if expected is None:
                    self.assertEqual(set(crs), {"units", "long_name", "crs_wkt"})
                    continue
                by_wkt = pyproj.CRS.from_wkt(crs["crs_wkt"])
                by_parameters = pyproj.CRS.from_cf({name: value for name, value in crs.items() if name != "crs_wkt"})
                for x, y in ((0, 0), (3000, -2000), (-500, 7000)):
                    ground = pyproj.Proj(by_wkt)(x, y, inverse=True)
                    np.testing.assert_allclose(pyproj.Proj(by_parameters)(*ground), pyproj.Proj(by_wkt)(*ground), rtol=0, atol=1e-6)


if __name__ == "__main__":
    unittest.main()
