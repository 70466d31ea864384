#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Places on the map of the raster that a site was taken from: sites and their tables, landfall-info, reports."""
import csv
import io
import json
import os
import re
import subprocess
import unittest

import h5py

from harness import ChainTest, ToolTest, read_bytes

RASTER = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "rasters", "polar_stereographic.tif")
CENTER = (-53005.0, -51002.5)
HAZARD = ["--set", "limits.slope_deg=80", "--set", "lander.leg_radius_m=1.5", "--set", "limits.roughness_m=50"]
KEYS = ["easting_m", "northing_m", "latitude_deg", "longitude_deg"]


def json_of(path):
    return json.loads(read_bytes(path))


class Places(ToolTest):
    @classmethod
    def setUpClass(cls):
        cls.lidar = ["--set", "laser.scan_time_s=0.02", "--set", "trajectory.position_m=[0,0,100]", "--set", 'scanner={"type": "flash"}', "--set", "detector.ifov_rad=0.007"]

    def setUp(self):
        super().setUp()
        self.terrain = self.path("t.h5")
        self.succeed("terrain-gen", "--from", RASTER, "--center", ",".join(map(str, CENTER)), "--half-width", "10", "--resolution", "0.5", "-o", self.terrain)

    def sites(self, source=None):
        self.succeed("hazard-map", source or self.terrain, "-o", self.path("h.h5"), "-O", "--sites", self.path("s.json"), "--report", self.path("h.html"), *HAZARD)
        return json_of(self.path("s.json"))["sites"]

    def lon_lat(self, points):
        """Longitude and latitude by PROJ's program, of points of the raster's map."""
        crs = subprocess.run(["gdalsrsinfo", "-o", "proj4", RASTER], capture_output=True, text=True, check=True).stdout.strip().strip("'")
        geographic = [word for word in crs.split() if word.startswith(("+R=", "+a=", "+b=", "+ellps=", "+datum=", "+rf="))]
        text = "".join(f"{x} {y}\n" for x, y in points)
        done = subprocess.run(["gdaltransform", "-s_srs", crs, "-t_srs", " ".join(["+proj=longlat", *geographic])], input=text, capture_output=True, text=True,
                              check=True)
        return [tuple(map(float, line.split()[:2])) for line in done.stdout.splitlines()]

    def test_sites(self):
        """The easting is that of the raster: x from the site's centre."""
        sites = self.sites()
        self.assertGreater(len(sites), 1)
        for site, (longitude, latitude) in zip(sites, self.lon_lat([(site["easting_m"], site["northing_m"]) for site in sites])):
            self.assertEqual(list(site)[:7], ["rank", "x_m", "y_m", *KEYS])
            self.assertEqual((site["easting_m"], site["northing_m"]), (CENTER[0] + site["x_m"], CENTER[1] + site["y_m"]))
            self.assertAlmostEqual(site["longitude_deg"], longitude, places=6)
            self.assertAlmostEqual(site["latitude_deg"], latitude, places=6)

    def test_files_and_tables(self):
        sites = self.sites()
        with h5py.File(self.path("h.h5")) as file:
            for key in KEYS:
                column = file["sites"][key.rpartition("_")[0]]
                self.assertEqual(list(column[()]), [site[key] for site in sites])
                self.assertEqual(column.attrs["units"].decode(), {"m": "m"}.get(key[-1], "degrees_north" if key[:3] == "lat" else "degrees_east"))
        self.succeed("landfall-export", self.path("h.h5"), "-o", self.path("s.csv"), "--sites")
        rows = list(csv.DictReader(io.StringIO(read_bytes(self.path("s.csv")).decode())))
        self.assertEqual([float(row["easting_m"]) for row in rows], [site["easting_m"] for site in sites])
        table = self.succeed("hazard-map", self.terrain, "-o", self.path("h.h5"), "-O", "--table", *HAZARD).stdout
        first = sites[0]
        self.assertIn("\nsite      easting, m     northing, m   latitude, deg  longitude, deg\n", table)
        self.assertIn(f"\n   1 {first['easting_m']:15.2f} {first['northing_m']:15.2f} {first['latitude_deg']:15.7f} {first['longitude_deg']:15.7f}\n", table)
        self.assertIn('"easting_m":' + json.dumps(first["easting_m"]), read_bytes(self.path("h.html")).decode())

    def test_info(self):
        origin = json.loads(self.succeed("landfall-info", self.terrain, "--json").stdout)["crs"]["origin"]
        self.assertEqual((origin["easting_m"], origin["northing_m"]), CENTER)
        self.assertIn("  origin      easting -53005.00 m, northing -51002.50 m\n              latitude 87.", self.succeed("landfall-info", self.terrain).stdout)
        first = self.sites()[0]
        best = json.loads(self.succeed("landfall-info", self.path("h.h5"), "--json").stdout)["best_site"]
        self.assertEqual([best[key] for key in KEYS], [first[key] for key in KEYS])

    def test_the_footprint_of_a_scan_that_was_moved(self):
        other, grid = self.path("t2.h5"), ["--set", "half_width_m=4", "--set", "resolution_m=0.5"]
        self.succeed("terrain-gen", "--from", RASTER, "--center", f"{CENTER[0] + 3},{CENTER[1] - 2}", "--half-width", "10", "--resolution", "0.5", "-o", other)
        for name, terrain in {"s.h5": self.terrain, "s2.h5": other}.items():
            self.succeed("scan-sim", "--terrain", terrain, "-o", self.path(name), *self.lidar)
        self.succeed("regrid", self.path("s.h5"), self.path("s2.h5"), "-o", self.path("d.h5"), *grid)
        self.succeed("dem-eval", self.path("d.h5"), "-o", self.path("e.h5"), "--set", "region_radius_m=3", "--set", "footprint_m=2.5")
        with h5py.File(self.path("s2.h5")) as file:
            x, y = file["points/x_est"][()] + 3, file["points/y_est"][()] - 2
        inside = (abs(x - 1) < 1.25) & (abs(y + 1.5) < 1.25)
        found = json.loads(self.succeed("landfall-info", self.path("e.h5"), "--at", "1,-1.5", "--scan", self.path("s2.h5"), "--json").stdout)
        self.assertEqual(found["bins"]["return_count"], inside.sum())
        self.assertNotEqual(inside.sum(), ((abs(x - 4) < 1.25) & (abs(y - 0.5) < 1.25)).sum())

    def test_chain(self):
        """The frame of the terrain is that of the scan, the DEM and the evaluation."""
        self.succeed("scan-sim", "--terrain", self.terrain, "-o", self.path("scan.h5"), *self.lidar)
        self.succeed("regrid", self.path("scan.h5"), "--terrain", self.terrain, "-o", self.path("d.h5"), "--set", "half_width_m=8", "--set", "resolution_m=0.5")
        found = json.loads(self.succeed("landfall-info", self.path("d.h5"), "--at", "2.1,-3", "--json").stdout)
        self.assertEqual((found["x_m"], found["y_m"], found["easting_m"], found["northing_m"]), (2, -3, CENTER[0] + 2, CENTER[1] - 3))
        text = self.succeed("landfall-info", self.path("d.h5"), "--at", "2.1,-3").stdout
        self.assertRegex(text, r"\n  easting -53003\.00 m, northing -51005\.50 m\n  latitude 87\.\d{7} deg, longitude -\d+\.\d{7} deg\n")
        self.succeed("dem-eval", self.path("d.h5"), "--set", "region_radius_m=6", "--report", self.path("r.html"))
        page = read_bytes(self.path("r.html")).decode()
        for table in ("worst", "holes"):
            self.assertTrue(re.search(rf'"{table}":\[{{.*?"easting_m":-530\d\d(\.\d+)?,"northing_m":-5\d+(\.\d+)?,"latitude_deg":87\.', page), table)


class WithoutCrs(ChainTest):
    def test_nothing_changes(self):
        self.succeed("hazard-map", self.chain.dem, "-c", self.chain.config("hazard-map"), "-o", self.path("h.h5"), "--sites", self.path("s.json"))
        self.assertTrue(all(not set(site) & set(KEYS) for site in json_of(self.path("s.json"))["sites"]))
        with h5py.File(self.path("h.h5")) as file:
            self.assertNotIn("easting", file["sites"])
        self.assertNotIn("easting", self.succeed("landfall-info", self.chain.dem, "--at", "0,0").stdout)
        self.assertNotIn("origin", self.succeed("landfall-info", self.chain.dem).stdout)


if __name__ == "__main__":
    unittest.main()
