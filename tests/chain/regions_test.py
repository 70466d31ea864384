#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of dem-eval, hazard-map, landfall run and monte-carlo that are polygons of a file or circles of their own centre."""
import json
import os
import subprocess
import unittest

import h5py
import numpy as np

from harness import EVAL, HAZARD, SCAN, TERRAIN, ChainTest, ToolTest, read_bytes, with_values, write_file
from harness.rasters import geotiff

RASTER = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "rasters", "polar_stereographic.tif")
CENTER = np.array([-53005.0, -51002.5])
LIDAR = ["--set", "laser.scan_time_s=0.02", "--set", "trajectory.position_m=[0,0,100]", "--set", 'scanner={"type": "flash"}', "--set", "detector.ifov_rad=0.007"]
OUTER = [[-5.3, -6.2], [6.1, -4.7], [1.2, 0.3], [5.8, 6.4], [-6.7, 3.1]]
HOLE = [[-3.2, -3.1], [-1.4, -3.3], [-2.3, -0.7]]
APART = [[6.2, 1.1], [7.3, 1.2], [6.6, 2.9]]
LENIENT = ["--set", "limits.slope_deg=80", "--set", "lander.leg_radius_m=1.5", "--set", "limits.roughness_m=50"]


def ring(vertices, shift):
    moved = [[x + shift[0], y + shift[1]] for x, y in vertices]
    return [*moved, moved[0]]


def geojson(path, crs="none", shift=(0, 0), parts=((OUTER, HOLE), (APART,)), kind="MultiPolygon"):
    """`crs`: "none" for a file without a CRS, None for no member, which RFC 7946 makes longitudes and latitudes."""
    coordinates = [[ring(vertices, shift) for vertices in part] for part in parts]
    content = {"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {}, "geometry": {"type": kind, "coordinates": coordinates if kind == "MultiPolygon" else coordinates[0]}}]}
    if crs == "none":
        content["crs"] = None
    return write_file(path, json.dumps(content))


def winds(vertices, x, y):
    """Whether a ring winds around places: the sum of the angles of its edges."""
    total = np.zeros(x.shape)
    for (ax, ay), (bx, by) in zip(vertices, vertices[1:] + vertices[:1]):
        ux, uy, vx, vy = ax - x, ay - y, bx - x, by - y
        total += np.arctan2(ux * vy - uy * vx, ux * vx + uy * vy)
    return np.abs(total) > np.pi


def inside(x, y):
    x, y = np.meshgrid(x, y)
    return (winds(OUTER, x, y) & ~winds(HOLE, x, y)) | winds(APART, x, y)


def region_set(**region):
    return ["--set", "region=" + json.dumps(region)]


class OnAMap(ToolTest):
    """A DEM with the CRS of a raster."""

    def setUp(self):
        super().setUp()
        self.dem = self.path("d.h5")
        self.succeed("terrain-gen", "--from", RASTER, "--center", ",".join(map(str, CENTER)), "--half-width", "10", "--resolution", "0.5", "-o", self.path("t.h5"))
        self.succeed("scan-sim", "--terrain", self.path("t.h5"), "-o", self.path("scan.h5"), *LIDAR)
        self.succeed("regrid", self.path("scan.h5"), "--terrain", self.path("t.h5"), "-o", self.dem, "--set", "half_width_m=8", "--set", "resolution_m=0.5")

    def ogr(self, *arguments):
        subprocess.run(["ogr2ogr", *arguments], check=True, capture_output=True)

    def test_a_polygon_in_any_frame(self):
        with h5py.File(self.dem) as file:
            expected = inside(file["x"][()], file["y"][()])
        crs = self.path("map.wkt")
        with open(crs, "w", encoding="utf-8") as file:
            subprocess.run(["gdalsrsinfo", "-o", "wkt2", RASTER], stdout=file, check=True)
        on_map = geojson(self.path("map.geojson"), shift=CENTER)
        geographic = subprocess.run(["gdalsrsinfo", "-o", "proj4", RASTER], capture_output=True, text=True, check=True).stdout.strip().strip("'")
        geographic = "+proj=longlat " + " ".join(word for word in geographic.split() if word.startswith(("+R=", "+a=", "+b=", "+ellps=", "+datum=", "+rf=")))
        self.ogr("-f", "GPKG", "-a_srs", crs, "-nln", "safe", self.path("map.gpkg"), on_map)
        self.ogr("-t_srs", geographic, self.path("degrees.shp"), self.path("map.gpkg"))
        files = {"x and y": geojson(self.path("xy.geojson")), "easting": self.path("map.gpkg"), "degrees": self.path("degrees.shp")}
        for name, path in files.items():
            with self.subTest(name):
                region = region_set(shape="polygon", path=path, **({"layer": "safe"} if name == "easting" else {}))
                result = self.succeed("dem-eval", self.dem, *region, "-o", self.path("e.h5"), "-O", "--metrics", self.path("m.json"), "--report", self.path("r.html"), "--table")
                with h5py.File(self.path("e.h5")) as file:
                    np.testing.assert_array_equal(file["in_region"][()] != 0, expected)
                metrics = json.loads(read_bytes(self.path("m.json")))
                self.assertEqual(metrics["region"], {"radius_m": None, "bin_count": int(expected.sum()), "shape": "polygon", "half_width_m": None,
                                                     "center_x_m": None, "center_y_m": None})
                self.assertIn(f"Region: {expected.sum():,} bins in the polygon;", result.stdout)
                assumed = "has no CRS: its coordinates are x and y of the DEM frame"
                self.assertEqual(assumed in result.stderr, name == "x and y", result.stderr)
                self.assertIn('"shape":"polygon"', read_bytes(self.path("r.html")).decode())
                self.assertIn("polygon", self.succeed("landfall-info", self.path("e.h5")).stdout)
                self.succeed("hazard-map", self.path("t.h5"), *region, *LENIENT, "-o", self.path("h.h5"), "-O", "--report", self.path("h.html"))
                with h5py.File(self.path("h.h5")) as file:
                    np.testing.assert_array_equal(~np.isnan(file["p_touchdown"][()]), inside(file["x"][()], file["y"][()]))
                self.assertIn("Places are the bins in the polygon;", read_bytes(self.path("h.html")).decode())

    def test_a_shift_between_datums_is_said(self):
        dem = self.path("utm.h5")
        self.succeed("landfall-import", geotiff(self.path("utm.tif"), np.zeros((5, 5)), (500000, 5400000)), "-o", dem)
        square = [((500001, 5400001), (500004, 5400001), (500004, 5400004), (500001, 5400004))]
        on_map = geojson(self.path("utm.geojson"), parts=[square])
        said = {}
        for crs in ("EPSG:32632", "EPSG:25832", "EPSG:31467", "EPSG:32631"):
            path = self.path(f"{crs[5:]}.gpkg")
            self.ogr("-s_srs", "EPSG:32632", "-t_srs", crs, path, on_map)
            said[crs] = self.succeed("dem-eval", dem, *region_set(shape="polygon", path=path), "-o", self.path("e.h5"), "-O").stderr
        shift = "31467.gpkg: the shift between the datums Deutsches_Hauptdreiecksnetz and WGS_1984 is the best of the grids that PROJ finds"
        self.assertEqual({crs: shift in text for crs, text in said.items()},
                         {"EPSG:32632": False, "EPSG:25832": False, "EPSG:31467": True, "EPSG:32631": False}, said)
        self.assertEqual([text.count("datums") for text in said.values()], [0, 0, 1, 0])

    def test_files_that_are_refused(self):
        def refuse(path, *words, code=1, **more):
            for tool in ("dem-eval", "hazard-map"):
                self.refuse(code, tool, self.dem, *region_set(shape="polygon", path=path, **more), "-o", self.path("e.h5"), words=words, output=self.path("e.h5"))

        refuse(geojson(self.path("crs.geojson"), crs=None), "crs.geojson", "WGS 84", '"crs": null')
        refuse(geojson(self.path("cross.geojson"), parts=[[[[0, 0], [4, 4], [4, 0], [0, 3]]]]), "cross.geojson: the polygon crosses itself", code=2)
        refuse(geojson(self.path("flat.geojson"), parts=[[[[0, 0], [4, 4], [2, 2]]]]), "flat.geojson: the polygon is empty", code=2)
        square, inner, outer, apart = ([[-r + d, -r + d], [r + d, -r + d], [r + d, r + d], [-r + d, r + d]] for r, d in ((3, 0), (1, 0), (4, 0), (1, 6)))
        for name, rings, reason in (("outside", [square, apart], "Hole lies outside shell at or near point 5 5"),
                                    ("around", [square, outer], "Hole lies outside shell at or near point -4 -4"),
                                    ("nested", [square, inner, [[-.5, -.5], [.5, -.5], [0, .5]]], "Holes are nested at or near point -0.5 -0.5"),
                                    ("touching", [[[-1, -1], [0, 0], [1, -1], [1, 1], [0, 0], [-1, 1]]], "Ring Self-intersection at or near point 0 0")):
            refuse(geojson(self.path(name + ".geojson"), parts=[rings]), f"{name}.geojson: its polygon is not valid: {reason}")
        refuse(geojson(self.path("huge.geojson"), parts=[[[[-1e308, -1e308], [1e308, -1e308], [0, 1e308]]]]), "huge.geojson: the polygon has a vertex at -1e+308, -1e+308 m", code=2)
        world = [[-180, -90], [180, -90], [180, 90], [-180, 90]]
        refuse(geojson(self.path("world.geojson"), crs=None, parts=[[world]]), "world.geojson: ", "the DEM frame")
        self.ogr("-a_srs", "EPSG:4978", self.path("centric.gpkg"), geojson(self.path("xyz.geojson")))
        refuse(self.path("centric.gpkg"), "centric.gpkg: its CRS is geocentric, not a map")
        refuse(self.lines(), "holds a LINESTRING; only polygons")
        refuse(self.empty(), "empty.geojson: holds no polygon")
        self.ogr("-f", "GPKG", "-nln", "one", self.path("two.gpkg"), geojson(self.path("xy.geojson")))
        self.ogr("-f", "GPKG", "-update", "-nln", "two", self.path("two.gpkg"), self.path("xy.geojson"))
        refuse(self.path("two.gpkg"), "has several layers; choose one by layer: one, two")
        refuse(self.path("two.gpkg"), "has no layer 'three'; its layers: one, two", layer="three")
        far = geojson(self.path("far.geojson"), shift=(4, 0))
        self.refuse(2, "dem-eval", self.dem, *region_set(shape="polygon", path=far), "--table", words=["far.geojson: the polygon reaches beyond the map", "the map covers x -8.25 to 8.25"])

    def lines(self):
        return self.config({"type": "LineString", "coordinates": OUTER, "crs": None}, "line.geojson")

    def empty(self):
        return self.config({"type": "FeatureCollection", "features": [], "crs": None}, "empty.geojson")


class InTheFrame(ChainTest):
    """Regions of the configuration, on a DEM without a map."""

    def judged(self, *arguments):
        self.succeed("dem-eval", self.chain.dem, "-c", self.chain.config("dem-eval"), "-o", self.path("e.h5"), "-O", "--metrics", self.path("m.json"), *arguments)
        with h5py.File(self.path("e.h5")) as file:
            return file["x"][()], file["y"][()], file["in_region"][()] != 0

    def test_a_circle_of_its_own_centre(self):
        x, y, region = self.judged(*region_set(center_m=[0.75, -0.5]), "--set", "region_radius_m=3")
        distance = np.hypot(*np.meshgrid(x - 0.75, y + 0.5))
        decided = np.abs(distance - 3) > 1e-9
        np.testing.assert_array_equal(region[decided], (distance < 3)[decided])
        found = json.loads(read_bytes(self.path("m.json")))["region"]
        self.assertEqual((found["shape"], found["radius_m"], found["center_x_m"], found["center_y_m"]), ("circle", 3, 0.75, -0.5))
        hazard = [self.chain.dem, "-c", self.chain.config("hazard-map"), "--set", "region_radius_m=3"]
        self.succeed("hazard-map", *hazard, *region_set(center_m=[3, 0]), "-o", self.path("h.h5"))
        with h5py.File(self.path("h.h5")) as file:
            np.testing.assert_array_equal(~np.isnan(file["p_touchdown"][()]), np.hypot(*np.meshgrid(x - 3, y)) < 3 - 1e-9)

    def test_vertices(self):
        triangle = [[-3.05, -2.05], [3.05, -2.05], [0.02, 3.05]]
        x, y, region = self.judged(*region_set(shape="polygon", vertices=triangle))
        np.testing.assert_array_equal(region, winds(triangle, *np.meshgrid(x, y)))
        self.succeed("hazard-map", self.chain.dem, "-c", self.chain.config("hazard-map"), *region_set(shape="polygon", vertices=triangle), "-o", self.path("h.h5"))
        plot = os.path.join(os.environ["LANDFALL_ROOT"], "python", "commands", "plot_hazards.py")
        subprocess.run(["/usr/bin/python3", plot, self.path("h.h5"), "-o", self.path("h.png"), "--dpi", "50"], check=True)

    def test_one_region_for_the_chain_and_its_draws(self):
        region = {"shape": "polygon", "vertices": [[-3, -2], [3, -2], [0, 3]]}
        config = {"area": {"half_width_m": 5, "resolution_m": 0.1, "region": region},
                  "terrain": {key: value for key, value in TERRAIN.items() if key != "grid"}, "scan": with_values(SCAN, noise={}),
                  "eval": {key: value for key, value in EVAL.items() if key != "region_radius_m"},
                  "hazard": {key: value for key, value in HAZARD.items() if key != "region_radius_m"}}
        self.write("chain.json", json.dumps(config))
        self.succeed("landfall", "run", "-c", self.path("chain.json"), "-o", self.path("out"))
        bins = json.loads(read_bytes(self.path("out/metrics.json")))["region"]["bin_count"]
        with h5py.File(self.path("out/hazards.h5")) as file:
            self.assertEqual(np.count_nonzero(~np.isnan(file["p_touchdown"][()])), bins)
        self.succeed("monte-carlo", "-c", self.path("chain.json"), "--set", "draws=1", "--set", "metrics=full", "-o", self.path("draws.h5"))
        with h5py.File(self.path("draws.h5")) as file, h5py.File(self.path("out/hazards.h5")) as hazards:
            self.assertEqual(file["draws/region.bin_count"][0], bins)
            score = json.loads(hazards["score_json"].asstr()[()])
            self.assertEqual(file["draws/score.missed_hazard_frac"][0], score["missed_hazard_frac"])
            self.assertGreater(score["missed_hazard_frac"], 0)


class Rectangles(ChainTest):
    """DEMs that are rectangles about a centre of their own: the same bins as those of the chain's DEM."""

    AREA = ["--set", "resolution_m=0.1", "--set", "half_width_m=[3, 1.5]", "--set", "center_m=[1.2, -0.7]"]

    def setUp(self):
        super().setUp()
        self.dem = self.path("r.h5")
        self.succeed("regrid", self.chain.scan, "--terrain", self.chain.terrain, "-o", self.dem, *self.AREA)

    def test_the_bins_are_those_of_a_larger_dem(self):
        with h5py.File(self.dem) as file, h5py.File(self.chain.dem) as whole:
            x, y = file["x"][()], file["y"][()]
            np.testing.assert_allclose([x[0], x[-1], y[0], y[-1]], [-1.8, 4.2, -2.2, 0.8], atol=1e-12)
            self.assertEqual((x.size, y.size), (61, 31))
            rows, cols = (np.searchsorted(whole[axis][()], values - 1e-6) for axis, values in (("y", y), ("x", x)))
            for layer in ("z_est", "z_true", "x_true", "y_true", "count"):
                np.testing.assert_array_equal(file[layer][()], whole[layer][rows[0]:rows[-1] + 1, cols[0]:cols[-1] + 1], layer)

    def test_what_reads_them(self):
        circle = ["--set", 'region={"center_m": [1.2, -0.7]}', "--set", "region_radius_m=1.5"]
        self.succeed("dem-eval", self.dem, "-c", self.chain.config("dem-eval"), *circle, "-o", self.path("e.h5"), "--report", self.path("r.html"), "--metrics", self.path("m.json"))
        self.refuse(2, "dem-eval", self.dem, "--set", "region_radius_m=2", "--table", words=["/region_radius_m: 2 does not fit the DEM: the largest that fits is 0.9"])
        with h5py.File(self.path("e.h5")) as file:
            distance = np.hypot(*np.meshgrid(file["x"][()] - 1.2, file["y"][()] + 0.7))
            np.testing.assert_array_equal(file["in_region"][()] != 0, distance < 1.5 - 1e-9)
        self.succeed("hazard-map", self.dem, "--terrain", self.chain.terrain, "-c", self.chain.config("hazard-map"), *circle, "-o", self.path("h.h5"), "--report", self.path("h.html"))
        self.assertIn("61 x 31", self.succeed("landfall-info", self.dem).stdout)
        at = json.loads(self.succeed("landfall-info", self.dem, "--at", "1.21,-0.68", "--json").stdout)
        np.testing.assert_allclose((at["x_m"], at["y_m"]), (1.2, -0.7), atol=1e-12)
        self.succeed("landfall-export", self.dem, "-o", self.path("d.tif"), "--layers", "z_est")
        shown = json.loads(subprocess.run(["gdalinfo", "-json", self.path("d.tif")], check=True, capture_output=True, text=True).stdout)
        self.assertEqual(shown["size"], [61, 31])
        np.testing.assert_allclose(shown["cornerCoordinates"]["upperLeft"], [-1.85, 0.85], atol=1e-9)
        draws = {"draws": 1, "metrics": "full", "regrid": {"resolution_m": 0.1, "half_width_m": [3, 1.5], "center_m": [1.2, -0.7]},
                 "eval": {**EVAL, "region_radius_m": 1.5, "region": {"center_m": [1.2, -0.7]}}}
        self.succeed("scan-sim", "-c", self.chain.config("scan-sim"), "--terrain", self.chain.terrain, "--keep-misses", "-o", self.path("s.h5"))
        self.succeed("monte-carlo", self.path("s.h5"), "--terrain", self.chain.terrain, "-c", self.config(draws), "-o", self.path("draws.h5"), "--seed", 7)
        metrics = json.loads(read_bytes(self.path("m.json")))
        with h5py.File(self.path("draws.h5")) as file:
            self.assertEqual(file["draws/region.bin_count"][0], metrics["region"]["bin_count"])
            self.assertEqual(file["draws/accuracy.relative.z.max_m"][0], metrics["accuracy"]["relative"]["z"]["max_m"])

    def test_areas_that_are_refused(self):
        for values, words in ((["half_width_m=[3, 1.55]"], ["half_width_m 1.55 is not a whole multiple (1 to 2^28) of resolution_m 0.1"]),
                              (["half_width_m=[3, 0]"], ["half_width_m"]), (["half_width_m=[3, 1, 1]"], ["half_width_m"]),
                              (["center_m=[0.05, 0]"], ["center_m 0.05 is not a whole multiple"]), (["center_m=[1]"], ["center_m"]),
                              (["half_width_m=[20000, 2000]"], ["more than 2^30"])):
            settings = [word for value in ["resolution_m=0.1", *values] for word in ("--set", value)]
            self.refuse(2, "regrid", self.chain.scan, "-o", self.path("x.h5"), *settings, words=words, output=self.path("x.h5"))


if __name__ == "__main__":
    unittest.main()
