#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that meet: scans, terrains, truths, masks and maps of one place or of others (docs/reference/places.md)."""
import json
import os
import subprocess
import unittest

import h5py
import numpy as np

from harness import ToolTest, columns, read_bytes
from harness.commands import run_command
from harness.rasters import geotiff
from landfall.plot import plot_compare

UTM = "EPSG:32632"
SHARED = os.path.join(os.environ["LANDFALL_ROOT"], "../shared/data/joints")
GRID = ["--set", "half_width_m=30", "--set", "resolution_m=1"]


def plane(x, y):
    return 300 + 0.1 * (x - 500000) - 0.05 * (y - 5400000)


class MeetingTest(ToolTest):
    def cloud(self, name, x, y, z=None):
        np.savetxt(self.path(name), np.column_stack([x, y, plane(x, y) if z is None else z]), "%.6f", ",", header="x,y,z", comments="")
        return self.path(name)

    def strips(self, apart=12.3):
        """Two strips of one plane; the middles of their extents are `apart` metres apart."""
        random = np.random.default_rng(3)
        x, y = random.uniform(0, 20, 3000), random.uniform(-10, 10, 3000)
        x[:4], y[:4] = [0, 20, 0, 20], [-10, -10, 10, 10]
        return self.cloud("a.csv", 500000 + x, 5400000 + y), self.cloud("b.csv", 500000 + apart + x, 5400000 + y)

    def imported(self, cloud, *options):
        scan = cloud.replace(".csv", ".h5")
        self.succeed("landfall-import", cloud, "-o", scan, "-O", *options)
        return scan

    def warnings(self, name, *arguments):
        return self.succeed(name, *arguments).stderr

    def raster(self, name, corner, size=61, crs=UTM, z=plane, cell=1.0):
        """A GeoTIFF whose pixel centres lie at corner + i cell; z of their coordinates."""
        x, y = corner[0] + cell * np.arange(size), corner[1] + cell * np.arange(size)
        values = z(*np.meshgrid(x, y))[::-1]
        if crs is not None:
            return geotiff(self.path(name), values, (x[0] - cell / 2, y[0] - cell / 2), cell, crs)
        text = self.path(name + ".asc")
        with open(text, "w", encoding="ascii") as file:
            file.write(f"ncols {size}\nnrows {size}\nxllcenter {corner[0]:.9f}\nyllcenter {corner[1]:.9f}\ncellsize {cell}\n")
            np.savetxt(file, values, "%.9f")
        return text


class Scans(MeetingTest):
    def check_strips(self, *crs):
        a, b = self.strips()
        together = self.imported(self.cloud("both.csv", *np.concatenate([np.loadtxt(f, delimiter=",", skiprows=1) for f in (a, b)]).T),
                                 *crs, "--center", "500010,5400000")
        self.succeed("regrid", together, "-o", self.path("one.h5"), *GRID)
        scans = self.imported(a, *crs, "--center", "500010,5400000"), self.imported(b, *crs, "--center", "500022.3,5400000")
        said = self.warnings("regrid", *scans, "-o", self.path("two.h5"), *GRID)
        self.assertIn("b.h5: is moved by (12.3, 0, 0) m into the frame of", said)
        self.assertEqual(said.count("\n"), 1, said)
        one, two = columns(self.path("one.h5")), columns(self.path("two.h5"))
        np.testing.assert_array_equal(one["count"], two["count"])
        np.testing.assert_allclose(two["z_est"], one["z_est"], rtol=0, atol=1e-9)
        self.assertLess(np.nanmax(two["z_spread"]), 0.06)
        return said

    def test_strips_of_one_map_equal_one_import_of_both(self):
        self.assertIn("on the same map", self.check_strips("--crs", UTM))

    def test_strips_without_a_crs(self):
        self.assertIn("neither has a CRS", self.check_strips())

    def test_default_centres_differ_too(self):
        scans = [self.imported(strip, "--crs", UTM) for strip in self.strips(12)]
        self.warnings("regrid", *scans, "-o", self.path("d.h5"), *GRID)
        self.assertLess(np.nanmax(columns(self.path("d.h5"))["z_spread"]), 0.06)

    def test_heights_of_the_centres(self):
        a, b = self.strips(0)
        scans = self.imported(a, "--crs", UTM, "--center", "500010,5400000,300"), self.imported(b, "--crs", UTM, "--center", "500010,5400000,310")
        self.assertIn("(0, 0, 10) m", self.warnings("regrid", *scans, "-o", self.path("d.h5"), *GRID))
        self.assertLess(np.nanmax(columns(self.path("d.h5"))["z_spread"]), 0.06)

    def test_same_frame_takes_coordinates_as_they_are(self):
        scans = [self.imported(strip, "--crs", UTM) for strip in self.strips(12)]
        self.assertEqual(self.warnings("regrid", *scans, "--same-frame", "-o", self.path("d.h5"), *GRID), "")
        self.assertGreater(np.nanmax(columns(self.path("d.h5"))["z_spread"]), 0.4)

    def reprojected(self, crs):
        """The message of regrid about a strip and of the same points in another CRS; the DEMs of the strip and of both."""
        a, _ = self.strips()
        done = subprocess.run(["gdaltransform", "-s_srs", UTM, "-t_srs", crs, "-output_xy"], check=True, capture_output=True, text=True,
                              input=read_bytes(a).decode().partition("\n")[2].replace(",", " "))
        x, y = np.array([line.split() for line in done.stdout.splitlines()], float).T
        west = self.cloud("west.csv", x, y, np.loadtxt(a, delimiter=",", skiprows=1)[:, 2])
        scans = self.imported(a, "--crs", UTM), self.imported(west, "--crs", crs)
        said = self.warnings("regrid", *scans, "-o", self.path("two.h5"), *GRID)
        self.assertIn("west.h5: is reprojected", said)
        self.succeed("regrid", scans[0], "-o", self.path("one.h5"), *GRID)
        return said, columns(self.path("one.h5")), columns(self.path("two.h5"))

    def test_another_zone_is_reprojected(self):
        said, one, two = self.reprojected("EPSG:32631")
        self.assertNotIn("datum", said)
        self.assertEqual(two["count"].sum(), 2 * one["count"].sum())
        self.assertLess(np.nanmax(np.abs(two["z_est"] - one["z_est"])), 1e-3)

    def test_a_shift_between_datums_is_said(self):
        said, _, _ = self.reprojected("EPSG:31467")
        self.assertIn("west.h5: the shift between the datums Deutsches_Hauptdreiecksnetz and WGS_1984 is the best of", said)

    def test_a_crs_on_one_side_only(self):
        a, b = self.strips()
        self.refuse(1, "regrid", self.imported(a), self.imported(b, "--crs", UTM), "-o", self.path("d.h5"), *GRID,
                    words=["b.h5: has a CRS, but", "a.h5 has none", "--crs", "--same-frame"], output=self.path("d.h5"))

    def test_datums_of_the_heights(self):
        a, b = self.strips()
        scans = self.imported(a, "--crs", "EPSG:32632+3855"), self.imported(b, "--crs", "EPSG:32632+5773")
        self.refuse(1, "regrid", *scans, "-o", self.path("d.h5"), *GRID, words=["EGM96 geoid", "EGM2008 geoid", "--vertical-datum as-is"],
                    output=self.path("d.h5"))
        self.succeed("regrid", *scans, "-o", self.path("d.h5"), *GRID, "--vertical-datum", "as-is")


class Truths(MeetingTest):
    def errors(self, dem):
        layers = columns(dem)
        return layers["z_true"] - layers["z_est"]

    def check_scan(self, crs, *options):
        a, _ = self.strips()
        corner = (499970.5, 5399965.5)
        truth = self.raster("truth.tif", corner, 81, crs)
        scan = self.imported(a, *(["--crs", crs] if crs else []))
        self.warnings("terrain-gen", "--from", truth, "-o", self.path("t.h5"), "-O", *options, *([] if crs else ["--horizontal-scale", "1"]))
        said = self.warnings("regrid", scan, "--terrain", self.path("t.h5"), "-o", self.path("d.h5"), "-O", *GRID)
        errors = self.errors(self.path("d.h5"))
        self.assertLess(np.nanmax(np.abs(errors)), 0.08, said)
        self.assertLess(abs(np.nanmean(errors)), 0.005, said)
        return said

    def test_a_scan_and_a_terrain_of_another_centre(self):
        for crs in (UTM, None):
            with self.subTest(crs=crs):
                self.assertIn("t.h5: is moved by (0.5, 5.5, 0) m", self.check_scan(crs, "--datum", "none"))

    def test_a_terrain_whose_centre_became_the_height_0(self):
        self.assertRegex(self.check_scan(UTM), r"t.h5: is moved by \(0.5, 5.5, 300.77\d*\) m")

    def test_a_scan_and_the_terrain_of_another_place(self):
        a, _ = self.strips()
        self.warnings("terrain-gen", "--from", self.raster("far.tif", (600000, 5400000)), "-o", self.path("far.h5"))
        self.refuse(1, "regrid", self.imported(a, "--crs", UTM), "--terrain", self.path("far.h5"), "-o", self.path("d.h5"), *GRID,
                    words=["far.h5: has no elevation at any bin with a return"], output=self.path("d.h5"))
        self.refuse(1, "regrid", self.imported(a), "--terrain", self.path("far.h5"), "-o", self.path("e.h5"), *GRID,
                    words=["far.h5: has a CRS", "a.h5 has none"], output=self.path("e.h5"))

    def test_a_raster_and_its_truth_on_other_vertical_datums(self):
        dem, truth = (self.raster(f"{name}.tif", (500000, 5400000), 31, f"EPSG:32632+{vertical}") for name, vertical in (("d", 3855), ("t", 5773)))
        self.refuse(1, "landfall-import", dem, "--truth", truth, "-o", self.path("d.h5"), words=["t.tif", "EGM96", "EGM2008"])
        self.assertEqual(self.warnings("landfall-import", dem, "--truth", truth, "-o", self.path("d.h5"), "--vertical-datum", "as-is"), "")
        plain = self.raster("plain.tif", (500000, 5400000), 31)
        self.assertIn("vertical datum of", self.warnings("landfall-import", dem, "--truth", plain, "-o", self.path("e.h5")))

    def test_hazard_map_moves_the_terrain_too(self):
        dem = self.raster("dem.tif", (500000, 5400000), 31)
        terrain = self.raster("truth.tif", (499990, 5399980), 81)
        self.warnings("terrain-gen", "--from", terrain, "-o", self.path("t.h5"), "--datum", "none")
        self.warnings("landfall-import", dem, "--truth", terrain, "-o", self.path("d.h5"))
        with h5py.File(self.path("d.h5"), "r+") as file:
            file["z_est"][15, 15] = file["z_true"][15, 15] = np.nan
        said = self.warnings("hazard-map", self.path("d.h5"), "--terrain", self.path("t.h5"), "-o", self.path("h.h5"), "--set", "region_radius_m=8",
                             "--set", 'lander={"leg_radius_m":3,"body_radius_m":3,"pad_diameter_m":1}')
        self.assertIn("t.h5: is moved by (15, 5, 0) m", said)


class Masks(MeetingTest):
    def dems(self, apart, crs=UTM):
        """A DEM and another one whose centre is `apart` metres to the east; pixels of 1 m."""
        for name, x in (("a", 500000), ("b", 500000 + apart)):
            self.warnings("landfall-import", self.raster(f"{name}.tif", (x, 5400000), 31, crs), "--truth", self.path(f"{name}.tif"),
                          "-o", self.path(f"{name}.h5"))
        with h5py.File(self.path("b.h5"), "r+") as file:
            file["inside"] = np.zeros((31, 31), np.int8)
            file["inside"][10:20, 5:15] = 1
        return self.path("a.h5"), self.path("b.h5")

    def region(self, dem, mask, *options):
        region = json.dumps({"shape": "mask", "path": mask, "layer": "inside"})
        return ["dem-eval", dem, "--set", "region=" + region, "--set", "footprint_m=5", "-o", self.path("e.h5"), "-O", *options]

    def test_a_mask_of_another_centre_is_moved_by_whole_bins(self):
        a, b = self.dems(4)
        self.assertIn("b.h5: is moved by (4, 0, 0) m", self.warnings(*self.region(a, b)))
        inside = columns(self.path("e.h5"))["in_region"]
        expected = np.zeros((31, 31))
        expected[10:20, 9:19] = 1
        np.testing.assert_array_equal(inside, expected)

    def test_a_mask_whose_bins_fall_between(self):
        a, b = self.dems(4.5)
        self.refuse(1, *self.region(a, b), words=["b.h5: /x differs from the DEM's by no whole number of bins"])
        self.succeed(*self.region(a, b, "--same-frame"))

    def test_a_mask_of_another_map(self):
        a, _ = self.dems(0)
        self.warnings("landfall-import", self.raster("c.tif", (500000, 5400000), 31, "EPSG:32633"), "-o", self.path("c.h5"))
        self.refuse(1, *self.region(a, self.path("c.h5")), words=["no layer /inside"])
        with h5py.File(self.path("c.h5"), "r+") as file:
            file["inside"] = np.ones((31, 31), np.int8)
        self.refuse(1, *self.region(a, self.path("c.h5")), words=["c.h5: its frame is another one", "gdalwarp -t_srs", "--same-frame"])


class Rasters(MeetingTest):
    def test_rasters_of_a_terrain_share_the_site_of_the_first(self):
        big, small = self.raster("big.tif", (499900, 5399900), 201), self.raster("small.tif", (499980, 5399990), 61)
        config = {"grid": {"half_width_m": 10, "resolution_m": 1},
                  "base": [{"type": "dem", "path": big, "datum": "none"}, {"type": "dem", "path": small, "datum": "none", "vertical_scale": 0.5}]}
        said = self.warnings("terrain-gen", "-c", self.config(config), "-o", self.path("t.h5"))
        self.assertIn("small.tif: is moved by (10, 20, 0) m into the frame of", said)
        x, y = np.meshgrid(np.arange(-10, 11), np.arange(-10, 11))
        np.testing.assert_allclose(columns(self.path("t.h5"))["z"], 1.5 * plane(500000 + x, 5400000 + y), atol=1e-6)

    def test_rasters_of_two_maps(self):
        rasters = self.raster("a.tif", (499900, 5399900), 201), self.raster("b.tif", (58800, 5416200), 201, "EPSG:32633")
        base = json.dumps([{"type": "dem", "path": path, "datum": "none"} for path in rasters])
        grid = ["--set", "grid.half_width_m=10", "--set", "grid.resolution_m=1", "-o", self.path("t.h5")]
        self.refuse(1, "terrain-gen", "--set", "base=" + base, *grid, words=["b.tif: its frame is another one", "+proj=utm +zone=32"],
                    output=self.path("t.h5"))
        self.succeed("terrain-gen", "--set", "base=" + base, *grid, "--same-frame")


class GivenCrs(MeetingTest):
    def test_a_raster_without_a_crs_gets_one(self):
        text, named = self.raster("none", (500000, 5400000), crs=None), self.raster("utm.tif", (500000, 5400000))
        for name, options in (("a", [text, "--crs", UTM]), ("b", [named])):
            self.warnings("terrain-gen", "--from", *options, "-o", self.path(f"{name}.h5"))
            self.warnings("landfall-import", *options, "-o", self.path(f"{name}.dem.h5"))
        for end in (".h5", ".dem.h5"):
            found = json.loads(self.succeed("landfall-info", "--compare", self.path("a" + end), self.path("b" + end), "--json").stdout)
            self.assertEqual((found["same_grid"], found["placement"]["said"], found["a"]["place"]), (True, [], found["b"]["place"]))

    def test_a_crs_that_contradicts_the_raster_is_used_with_a_warning(self):
        raster = self.raster("utm.tif", (500000, 5400000))
        for arguments in (["terrain-gen", "--from", raster], ["landfall-import", raster]):
            said = self.warnings(*arguments, "--crs", "EPSG:32633", "-o", self.path("a.h5"), "-O")
            self.assertIn("its CRS is WGS 84 / UTM zone 32N, but crs gives WGS 84 / UTM zone 33N, which is used", said)
            self.assertEqual(said.count("CRS"), 1)
            self.refuse(2, *arguments, "--crs", "EPSG:x", "-o", self.path("b.h5"), words=["utm.tif: crs: 'EPSG:x' is not a CRS"])


class Compared(MeetingTest):
    def dems(self, *corners, crs=UTM, z=plane):
        for name, corner in zip("ab", corners):
            self.warnings("landfall-import", self.raster(f"{name}.tif", corner, 31, crs, z), "-o", self.path(f"{name}.h5"))
        return self.path("a.h5"), self.path("b.h5")

    def compare(self, *arguments):
        return json.loads(self.succeed("landfall-info", "--compare", *arguments, "--json").stdout)

    def test_common_bins_of_two_centres(self):
        found = self.compare(*self.dems((500000, 5400000), (500003, 5399998)))
        self.assertEqual(found["placement"]["shift_m"], [3, -2, 0])
        self.assertEqual([found["common_bins"][key] for key in ("rows", "columns", "first_in_a", "first_in_b")], [29, 28, [0, 3], [2, 0]])
        self.assertFalse(found["same_grid"])
        layer = next(layer for layer in found["layers"] if layer["layer"] == "z_est")
        self.assertEqual(layer["valid_both"], 29 * 28)
        self.assertLess(layer["max_abs"], 1e-9)
        self.assertEqual(found["b"]["place"]["center"], [500018, 5400013])
        text = self.succeed("landfall-info", "--compare", self.path("a.h5"), self.path("b.h5")).stdout
        for words in ("B centre 500018, 5400013 of WGS 84 / UTM zone 32N", "B is moved by (3, -2, 0) m", "bins in common: 28 x 29"):
            self.assertIn(words, text)

    def test_maps_that_do_not_meet_have_no_statistics(self):
        for corner, crs, reason in (((500000.5, 5400000), UTM, "fall between"), ((600000, 5400000), UTM, "no bin in common"),
                                    ((500000, 4000000), "EPSG:32634", "its frame is another one")):
            with self.subTest(reason=reason):
                a, _ = self.dems((500000, 5400000))
                self.warnings("landfall-import", self.raster("b.tif", corner, 31, crs), "-o", self.path("b.h5"), "-O")
                found = self.compare(a, self.path("b.h5"))
                self.assertIn(reason, found["not_compared"])
                self.assertNotIn("layers", found)
                os.remove(a)

    def test_same_frame_compares_coordinates(self):
        found = self.compare(*self.dems((500000, 5400000), (600000, 5400000)), "--same-frame")
        self.assertTrue(found["same_grid"])

    def figure(self, *options):
        done = run_command("plot_compare", self.path("a.h5"), self.path("b.h5"), "-o", self.path("c.png"), "-O", "--dpi", 50, *options)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return self.path("c.png")

    def test_figures_of_maps_that_meet_and_of_others(self):
        def relief(x, y):
            return 5 * np.sin(x / 5) * np.cos(y / 7)

        self.dems((500000, 5400000), (500006, 5399996), z=relief)
        options = plot_compare.parse([self.path("a.h5"), self.path("b.h5")])
        (grid, a), (_, b), lines = plot_compare.read_common(options)
        self.assertEqual((grid.shape, grid.x[0], grid.y[-1]), ((27, 25), -9, 11))
        np.testing.assert_allclose(a, b, atol=1e-9)
        self.assertIn("moved by (6, -4, 0) m", lines[0])
        compared = os.path.getsize(self.figure())
        self.warnings("landfall-import", self.raster("b.tif", (600000, 5400000), 31), "-o", self.path("b.h5"), "-O")
        self.assertIn("no bin in common", plot_compare.read_common(options)[2][0])
        self.assertLess(os.path.getsize(self.figure()), compared)

    def test_heights_are_moved_too(self):
        for name, datum in (("a", "none"), ("b", "center")):
            self.warnings("terrain-gen", "--from", self.raster("t.tif", (500000, 5400000), 31), "--datum", datum, "-o", self.path(f"{name}.h5"))
        found = self.compare(self.path("a.h5"), self.path("b.h5"))
        self.assertLess(found["layers"][0]["max_abs"], 1e-9)
        self.assertAlmostEqual(found["placement"]["shift_m"][2], plane(500015, 5400015), places=9)


@unittest.skipUnless(os.path.isdir(SHARED), f"{SHARED} is missing")
class SharedJoints(MeetingTest):
    def shared(self, name):
        return os.path.join(SHARED, name)

    def test_two_strips(self):
        for end in ("", "_crs"):
            scans = []
            for name in ("strip_a", "strip_b"):
                scans.append(self.path(name + end + ".h5"))
                self.warnings("landfall-import", self.shared(name + end + ".las"), "-o", scans[-1])
            self.assertIn("is moved by (12, ", self.warnings("regrid", *scans, "-o", self.path(f"d{end}.h5"), *GRID))
            self.assertLess(np.nanmax(columns(self.path(f"d{end}.h5"))["z_spread"]), 0.1)

    def test_two_places_of_one_relief(self):
        for name in ("place1", "place2"):
            self.warnings("landfall-import", self.shared(name + ".asc"), "-o", self.path(name + ".h5"))
        found = json.loads(self.succeed("landfall-info", "--compare", self.path("place1.h5"), self.path("place2.h5"), "--json").stdout)
        self.assertIn("no bin in common", found["not_compared"])

    def test_a_truth_of_another_centre(self):
        self.warnings("landfall-import", self.shared("strip_a.las"), "-o", self.path("s.h5"))
        self.warnings("terrain-gen", "--from", self.shared("ref_nocrs.asc"), "--horizontal-scale", "1", "--datum", "none", "-o", self.path("t.h5"))
        self.assertIn("is moved by", self.warnings("regrid", self.path("s.h5"), "--terrain", self.path("t.h5"), "-o", self.path("d.h5"), *GRID))
        layers = columns(self.path("d.h5"))
        self.assertLess(abs(np.nanmean(layers["z_true"] - layers["z_est"])), 0.03)

    def test_vertical_datums(self):
        self.refuse(1, "landfall-import", self.shared("dem_egm.tif"), "--truth", self.shared("truth_ell.tif"), "-o", self.path("d.h5"),
                    words=["EGM96", "EGM2008"])


if __name__ == "__main__":
    unittest.main()
