#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall-import: clouds that say what they are, by the names of their columns, by their content and by their format."""
import math
import os
import struct
import unittest

import h5py
import numpy as np

from harness import ToolTest, read_bytes

SHARED = os.environ.get("LANDFALL_DATA", os.path.join(os.environ["LANDFALL_ROOT"], "..", "shared", "data"))
PLANE = [(x, y, 0.1 * x) for y in range(-10, 11, 2) for x in range(-10, 11, 2)]


class Imports(ToolTest):
    def imported(self, path, *arguments):
        """x, y, z of the points; self.points has all columns, self.said what was warned about."""
        done = self.succeed("landfall-import", path, "-o", self.path("scan.h5"), "-O", *arguments)
        self.said = done.stderr
        with h5py.File(self.path("scan.h5")) as file:
            self.points = {name: data[()] for name, data in file["points"].items()}
            self.attributes = dict(file["points"].attrs)
        return np.column_stack([self.points[axis + "_est"] for axis in "xyz"])

    def refused(self, path, *words, arguments=(), code=1):
        self.refuse(code, "landfall-import", path, "-o", self.path("bad.h5"), *arguments, words=list(words), output=self.path("bad.h5"))

    def table(self, header, rows, separator=","):
        return header + "\n" + "".join(separator.join(f"{v:.9g}" for v in row) + "\n" for row in rows)


class Units(Imports):
    def test_every_spelling_of_a_unit_gives_the_same_plane(self):
        for header, units in [("x [mm],y [mm],z [mm]", (1e-3,) * 3), ("X (km),Y (km),Elevation (ft)", (1e3, 1e3, 0.3048)), ("x_cm,y_cm,z_cm", (1e-2,) * 3),
                              ("E {m},N {mm},H <inch>", (1, 1e-3, 0.0254)), ("Points_m_XYZ:0,Points_m_XYZ:1,Points_m_XYZ:2", (1, 1, 1)),
                              ("x/yd,y/yd,z in US survey feet", (0.9144, 0.9144, 1200 / 3937)), ("e,n,u", (1, 1, 1))]:
            with self.subTest(header):
                xyz = self.imported(self.write("a.csv", self.table(header, np.array(PLANE) / units)), "--center", "0,0")
                np.testing.assert_allclose(xyz, PLANE, atol=1e-6)
                self.assertEqual("by its header" in self.said or "converted to metres" in self.said, units != (1, 1, 1), self.said)

    def test_seconds_are_made_of_other_times(self):
        self.imported(self.write("a.csv", "x,y,z,t [ms]\n0,0,0,1000\n1,1,0,1500\n"))
        np.testing.assert_allclose(self.points["t"], [1, 1.5])

    def test_columns_of_unknown_units_are_metres_if_chosen(self):
        self.imported(self.write("a.csv", "x [cubit],y [cubit],z\n1,2,3\n"), "--columns", "x=1,y=2")
        self.assertIn("metres are assumed", self.said)

    def test_the_unit_of_a_crs_and_of_the_header_agree(self):
        rows = [(500, 5400, 0.3), (500.001, 5400, 0.3)]
        path = self.write("a.csv", self.table("E [km],N [km],z [km]", rows))
        xyz = self.imported(path, "--crs", "+proj=utm +zone=32 +units=km", "--center", "500,5400")
        np.testing.assert_allclose(xyz, [(0, 0, 300), (1, 0, 300)], atol=1e-3)
        xyz = self.imported(self.write("a.csv", "E [ft],N [ft],z [m]\n6000000,2100000,1\n6000100,2100000,2\n"), "--crs", "EPSG:2227", "--center", "6000000,2100000")
        np.testing.assert_allclose(xyz, [(0, 0, 1), (100 * 1200 / 3937, 0, 2)], atol=1e-9)

    def test_a_vertical_scale_wins(self):
        xyz = self.imported(self.write("a.csv", "x,y,z [ft]\n0,0,1\n2,2,3\n"), "--vertical-scale", "2")
        np.testing.assert_allclose(xyz[:, 2], [2, 6])
        self.assertIn("gives z in ft, but --vertical-scale 2 is taken", self.said)


class Degrees(Imports):
    def test_names_that_say_degrees_need_a_crs(self):
        rows = [(8.7, 49.4, 100), (8.70001, 49.4, 101), (8.7, 49.40001, 102)]
        for header in ("lon,lat,elevation", "longitude_deg,latitude_deg,z", "x [deg],y [deg],z", "LONGITUDE_CENTROID,LATITUDE_CENTROID,ELEVATION_CENTROID", "Lng,Lat,h"):
            with self.subTest(header):
                path = self.write("a.csv", self.table(header, rows))
                self.refused(path, "has no CRS", "--crs EPSG:4326")
                self.refused(path, "the CRS counts in met", arguments=("--crs", "EPSG:32632"))
                xyz = self.imported(path, "--crs", "EPSG:4326", "--center", "8.7,49.4")
                self.assertAlmostEqual(xyz[1, 0], 0.7257, delta=0.001)
        ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty double longitude\nproperty double latitude\nproperty float z\nend_header\n8.7 49.4 1\n"
        self.refused(self.write("a.ply", ply), "--crs EPSG:4326")
        pcd = "VERSION 0.7\nFIELDS lon lat z\nSIZE 8 8 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n8.7 49.4 1\n"
        self.refused(self.write("a.pcd", pcd), "--crs EPSG:4326")

    def test_lvis(self):
        lines = ["# LVIS release 1", "# LVIS_LFID SHOTNUMBER TIME LONGITUDE_CENTROID LATITUDE_CENTROID ELEVATION_CENTROID LONGITUDE_LOW LATITUDE_LOW ELEVATION_LOW "
                 "LONGITUDE_HIGH LATITUDE_HIGH ELEVATION_HIGH"]
        for i in range(3):
            lines.append(f"1654935003 {1103940 + i} {42504.5 + i} 301.3 78.4 1000 {301.2 + i * 1e-5:.6f} 78.3 {1956 + i} 301.4 78.5 2000")
        path = self.write("ILVIS2.TXT", "\n".join(lines) + "\n")
        self.refused(path, "--crs EPSG:4326")
        xyz = self.imported(path, "--crs", "EPSG:4326", "--center", "301.2,78.3")
        np.testing.assert_allclose(xyz[:, 2], [1956, 1957, 1958], atol=1e-6)
        np.testing.assert_allclose(xyz[:, 0], np.arange(3) * math.radians(1e-5) * 6378137 / math.sqrt(1 - 0.00669438 * math.sin(math.radians(78.3)) ** 2)
                                   * math.cos(math.radians(78.3)), atol=1e-5)
        np.testing.assert_array_equal(self.points["t"], [42504.5, 42505.5, 42506.5])
        self.assertIn("LONGITUDE_LOW, LATITUDE_LOW, ELEVATION_LOW are taken as x, y, z", self.said)
        xyz = self.imported(path, "--crs", "EPSG:4326", "--columns", "x=LONGITUDE_CENTROID,y=LATITUDE_CENTROID,z=ELEVATION_CENTROID")
        np.testing.assert_allclose(xyz[:, 2], 1000)


class Columns(Imports):
    def test_columns_that_nothing_needs(self):
        rows = "".join(f"2026-03-05T12:00:0{i % 10}Z,{x},{y},{z},ground\n" for i, (x, y, z) in enumerate(PLANE))
        path = self.write("a.csv", "timestamp,x,y,z,classification\n" + rows)
        np.testing.assert_allclose(self.imported(path, "--center", "0,0"), PLANE, atol=1e-12)
        self.assertEqual(self.said.count("is left out: it holds text"), 2, self.said)
        self.imported(path, "--columns", "t=-, classification=-")
        self.assertNotIn("left out", self.said)

    def test_row_numbers_and_missing_values(self):
        rows = "".join(f"{i},{x},{y},{z}\n" for i, (x, y, z) in enumerate(PLANE))
        for header in (",x,y,z\n", "x,y,z\n"):
            np.testing.assert_allclose(self.imported(self.write("a.csv", header + rows), "--center", "0,0"), PLANE, atol=1e-12)
            self.assertIn("its first column has no name", self.said)
        self.imported(self.write("a.csv", "x,y,z\n1,2,NA\n3,4,5\n,6,7\n8,9,\n"))
        self.assertIn("3 points without a finite position are left out", self.said)

    def test_decimal_commas(self):
        for separator in (";", "\t", " "):
            content = self.table("", PLANE, separator)[1:].replace(".", ",")
            np.testing.assert_allclose(self.imported(self.write("a.txt", content), "--center", "0,0"), PLANE, atol=1e-12)

    def test_blanks_around_the_numbers_of_a_list(self):
        path = self.write("a.csv", self.table("x,y,z", PLANE))
        np.testing.assert_allclose(self.imported(path, "--center", " 1, 2 ,3 "), np.array(PLANE) - (1, 2, 3), atol=1e-12)


class Formats(Imports):
    GRID = "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n4 5 6\n7 8 9\n"

    def test_the_content_decides_between_points_and_pixels(self):
        points = "//X Y Z Intensity\n" + "".join(f"{x} {y} {z} 5\n" for x, y, z in PLANE)
        for name in ("cloud.asc", "cloud", "cloud.grd"):
            np.testing.assert_allclose(self.imported(self.write(name, points), "--center", "0,0"), PLANE, atol=1e-12)
        for name in ("grid.asc", "grid.txt", "grid.xyz"):
            self.succeed("landfall-import", self.write(name, self.GRID), "-o", self.path("dem.h5"), "-O")
            with h5py.File(self.path("dem.h5")) as file:
                self.assertEqual(file["z_est"].shape, (3, 3))

    def test_ptx(self):
        turned = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 200 300 1\n"
        header = "100 200 300\n0 1 0\n-1 0 0\n0 0 1\n" + turned
        content = "2\n2\n" + header + "1 0 0 0.5\n0 2 0 0.25\n0 0 0 0.5\n1 2 3 1\n" + "1\n1\n" + header + "5 0 -1 0.75\n"
        xyz = self.imported(self.write("a.ptx", content), "--center", "100,200,300")
        np.testing.assert_allclose(xyz, [(0, 1, 0), (-2, 0, 0), (-2, 1, 3), (0, 5, -1)], atol=1e-12)
        np.testing.assert_allclose(self.points["intensity"], [0.5, 0.25, 1, 0.75])
        self.assertIn("1 points without a finite position are left out", self.said)
        self.refused(self.write("a.ptx", content[:-12]), "line 24", "ends before the points")

    def qfit(self, path):
        """Longitude, latitude, height, GPS time of day and reflected pulse of each shot, by an own decoder."""
        content = read_bytes(path)
        order = ">" if content[:3] == b"\0\0\0" else "<"
        length, = struct.unpack_from(order + "i", content, 0)
        begin, = struct.unpack_from(order + "i", content, length + 4)
        shots = np.frombuffer(content[begin:], order + "i4").reshape(-1, length // 4).astype(float)
        shots = shots[shots[:, 1:4].any(axis=1)]  # the others have no position
        clock = shots[:, -1]
        return shots[:, 2] / 1e6, shots[:, 1] / 1e6, shots[:, 3] / 1e3, clock // 1e7 * 3600 + clock // 1e5 % 100 * 60 + clock % 1e5 / 1e3, shots[:, 5]

    def check_qfit(self, path, said=""):
        lon, lat, height, t, pulse = self.qfit(path)
        xyz = self.imported(path)
        np.testing.assert_allclose(xyz[:, 2], height, atol=1e-9)
        np.testing.assert_array_equal(self.points["intensity"], pulse)
        np.testing.assert_allclose(self.points["t"], t, atol=1e-9)
        self.assertIn(said, self.said)
        self.assertEqual(self.said.count("warning"), 1 if said else 0, self.said)
        a, e2 = 6378137, (2 - 1 / 298.257223563) / 298.257223563

        def ecef(lon, lat):
            lon, lat = np.radians(lon), np.radians(lat)
            normal = a / np.sqrt(1 - e2 * np.sin(lat) ** 2)
            return np.array([normal * np.cos(lat) * np.cos(lon), normal * np.cos(lat) * np.sin(lon), normal * (1 - e2) * np.sin(lat)])

        center = self.attributes["origin_x"], self.attributes["origin_y"]
        offset = ecef(lon, lat).T - ecef(*center)
        lam, phi = np.radians(center)
        east = offset @ [-math.sin(lam), math.cos(lam), 0]
        north = offset @ [-math.sin(phi) * math.cos(lam), -math.sin(phi) * math.sin(lam), math.cos(phi)]
        np.testing.assert_allclose(xyz[:, 0], east, atol=1e-6)
        np.testing.assert_allclose(xyz[:, 1], north, atol=1e-6)

    def test_qfit(self):
        random = np.random.default_rng(4)
        for words in (10, 12, 14):
            for order in "><":
                with self.subTest(words=words, order=order):
                    shots = np.full((50, words), 7, order + "i4")
                    shots[:, 0] = np.arange(50)
                    shots[:, 1] = 59205160 + random.integers(-500, 500, 50)
                    shots[:, 2] = 221826822 + random.integers(-500, 500, 50)
                    shots[:, 3] = random.integers(-40000, 40000, 50)
                    shots[:, 5] = random.integers(0, 4000, 50)
                    shots[:, -1] = 232325407 + np.arange(50)
                    head = struct.pack(order + "i", 4 * words).ljust(4 * words) + struct.pack(order + "ii", -9000008, 12 * words).ljust(4 * words, b"\0") + \
                        struct.pack(order + "i", -9000001).ljust(4 * words, b"x")
                    path = self.write("a.qi", head + shots.tobytes())
                    self.check_qfit(path)
                    self.refused(self.write("cut.qi", head + shots.tobytes()[:-1]), "ends within a record")

    def test_real_files(self):
        for name in ("atm_10-word.qi", "atm_14-word.qi"):
            path = os.path.join(SHARED, "truth", name)
            if not os.path.exists(path):
                self.skipTest(f"{path} is not there")
            self.check_qfit(path, "72 points without a finite position" if name == "atm_14-word.qi" else "")


if __name__ == "__main__":
    unittest.main()
