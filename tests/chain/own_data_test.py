#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall-import: points and elevation models that landfall did not make, and the chain behind them."""
import json
import math
import os
import struct
import unittest

import h5py
import numpy as np

from harness import SCAN, TERRAIN, ToolTest, clouds, columns, read_bytes, run

OUTSIDE = os.path.join(os.environ.get("LANDFALL_DATA", os.path.join(os.environ["LANDFALL_ROOT"], "..", "shared", "data")), "outside")


class Imports(ToolTest):
    def imported(self, name, content, *arguments, silent=True):
        """The columns and attributes of /points."""
        done = self.succeed("landfall-import", self.write(name, content), "-o", self.path("scan.h5"), "-O", *arguments)
        self.said = done.stderr
        if silent:
            self.assertEqual(done.stderr, "")
        with h5py.File(self.path("scan.h5")) as file:
            self.assertNotIn("pulses", file)
            self.assertFalse([name for name in file["points"] if name.endswith("_true")])
            return {name: data[()] for name, data in file["points"].items()}, dict(file["points"].attrs)

    def refused(self, name, content, expected, *arguments, code=1):
        path = name if content is None else self.write(name, content)
        self.refuse(code, "landfall-import", path, "-o", self.path("bad.h5"), *arguments, words=[expected], output=self.path("bad.h5"))


UTM = ["--crs", "EPSG:32632"]
OFFSET = (548351.0, 5389938.0, 235.0)


class Las(Imports):
    def test_every_version_and_point_format_reads_back_to_the_last_unit(self):
        points = clouds.las_points()
        units = np.array([p["xyz"] for p in points])
        for minor, formats in {0: (0, 1), 1: (0, 1), 2: (0, 1, 2, 3), 3: range(6), 4: range(11)}.items():
            for fmt in formats:
                with self.subTest(minor=minor, fmt=fmt):
                    data, attributes = self.imported("a.las", clouds.las(points, fmt, minor, offset=OFFSET, extra=3), *UTM, "--keep-noise")
                    center = [attributes["origin_" + axis] for axis in "xyz"]
                    for k, axis in enumerate("xyz"):
                        back = (data[axis + "_est"] + center[k] - OFFSET[k]) / 0.001
                        np.testing.assert_array_equal(np.round(back), units[:, k])
                        self.assertLess(np.abs(back - np.round(back)).max(), 1e-3)
                    np.testing.assert_array_equal(data["intensity"], [p["intensity"] for p in points])
                    np.testing.assert_array_equal(data["return_number"], [p["return"] for p in points])
                    np.testing.assert_array_equal(data["status"], [6 if p["class"] == 7 else 0 for p in points])
                    self.assertEqual("t" in data, fmt in clouds.LAS_TIMED)
                    if "t" in data:
                        np.testing.assert_array_equal(data["t"], [p["t"] for p in points])
                    self.assertEqual(attributes["imported_from"], f"LAS 1.{minor}, point format {fmt}".encode())

    def test_the_middle_of_the_extent_rounded_to_a_metre_is_the_origin(self):
        points = clouds.las_points()
        xyz = np.array([p["xyz"] for p in points]) * 0.001 + OFFSET
        _, attributes = self.imported("a.las", clouds.las(points, offset=OFFSET), *UTM, "--keep-noise")
        middle = np.round((xyz.min(axis=0) + xyz.max(axis=0)) / 2)
        self.assertEqual([attributes["origin_x"], attributes["origin_y"], attributes["origin_z"]], [middle[0], middle[1], 0])

    def test_a_given_center_is_the_origin_of_all_three_axes(self):
        points = clouds.las_points(40)
        data, _ = self.imported("a.las", clouds.las(points, offset=OFFSET), *UTM, "--keep-noise", "--center", "548300.5,5389900.25,200")
        xyz = np.array([p["xyz"] for p in points]) * 0.001 + OFFSET
        for k, axis in enumerate("xyz"):
            np.testing.assert_allclose(data[axis + "_est"], xyz[:, k] - (548300.5, 5389900.25, 200)[k], atol=1e-9)

    def test_noise_and_withheld_points_are_left_out_and_counted(self):
        points = clouds.las_points(300)
        for p in points[:40]:
            p["withheld"] = 1
        for i, p in enumerate(points[40:]):
            p["class"] = (1, 2, 7, 18, 12)[i % 5]  # 12 is overlap, which is no noise
        for fmt, minor in ((1, 2), (6, 4)):
            content = clouds.las(points, fmt, minor)
            data, attributes = self.imported("a.las", content, *UTM, silent=False)
            self.assertEqual((len(data["x_est"]), attributes["false_return_count"]), (156, 0))
            self.assertEqual(self.said.splitlines(), [f"landfall-import: warning: {self.path('a.las')}: 104 points that it marks as noise and 40 points that it "
                                                      "marks as withheld are left out (--keep-noise keeps them as false returns)"])
            data, attributes = self.imported("a.las", content, *UTM, "--keep-noise")
            self.assertEqual((len(data["x_est"]), attributes["false_return_count"]), (300, 144))
            np.testing.assert_array_equal(data["status"], [6 if p["withheld"] or p["class"] in (7, 18) else 0 for p in points])
        for p in points:
            p["class"] = 7
        self.refused("a.las", clouds.las(points), "has no points: 260 points that it marks as noise and 40", *UTM)

    def test_first_and_last_returns_alone(self):
        points = clouds.las_points(300)
        for i, p in enumerate(points):
            p.update({"return": 1 + i % 3, "of": 1 + i % 3 + i % 2, "class": 2})
        for fmt, minor in ((1, 2), (6, 4)):
            content = clouds.las(points, fmt, minor, offset=OFFSET)
            for option, kept in (("--first-only", [p["return"] == 1 for p in points]), ("--last-only", [p["return"] == p["of"] for p in points])):
                data, _ = self.imported("a.las", content, *UTM, option, "--center", "548351,5389938", silent=False)
                np.testing.assert_array_equal(np.round(data["x_est"] * 1000), np.array([p["xyz"][0] for p in points])[kept])
                self.assertIn(f"{300 - sum(kept)} points that are not {option[2:-5]} returns are left out", self.said)
        self.refused("a.las", content, "mutually exclusive", "--first-only", "--last-only", code=2)
        rows = "0,0,1,1,2\n1,0,1,2,2\n2,0,1,1,1\n"
        data, _ = self.imported("a.csv", "x,y,z,ReturnNumber,NumberOfReturns\n" + rows, "--center", "0,0", "--last-only", silent=False)
        np.testing.assert_array_equal(data["x_est"], [1, 2])
        self.refused("a.csv", "x,y,z,return_number,other\n" + rows, "a.csv has no column number_of_returns", "--last-only", code=2)
        self.refused("a.csv", "x,y,z,other,number_of_returns\n" + rows, "a.csv has no column return_number", "--first-only", code=2)

    def test_a_header_that_contradicts_the_points_is_refused(self):
        points = clouds.las_points(50)
        low, high = np.min([p["xyz"] for p in points], axis=0) * 0.001, np.max([p["xyz"] for p in points], axis=0) * 0.001
        true = np.column_stack([high, low]).ravel()  # max x, min x, max y, ...
        for shift, expected in ((-0.002, ""), (-0.005, "but its header declares"), (-2, None)):
            for edge, sign in ((0, 1), (3, -1), (4, 1)):
                box = true.copy()
                box[edge] += sign * shift
                with self.subTest(shift=shift, edge=edge):
                    content = clouds.las(points, box=box)
                    if expected is None:
                        self.refused("a.las", content, "its header or its points are damaged", *UTM, "--keep-noise")
                    else:
                        self.imported("a.las", content, *UTM, "--keep-noise", silent=not expected)
                        self.assertIn(expected, self.said)
        self.imported("a.las", clouds.las(points, box=[0.0] * 6), *UTM, "--keep-noise", silent=False)
        self.assertIn("the extent in its header is all zero", self.said)

    def test_bytes_behind_the_points(self):
        points = clouds.las_points(20)
        self.imported("a.las", clouds.las(points) + bytes(41), *UTM, "--keep-noise", silent=False)
        self.assertIn("has 41 bytes that belong to nothing that its header declares", self.said)

    def test_the_crs_of_the_file_is_kept(self):
        keys = struct.pack("<16H", 1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 32632, 3076, 0, 1, 9001)
        points = clouds.las_points(40)
        for record in (clouds.las_vlr("LASF_Projection", 34735, keys),):
            self.imported("a.las", clouds.las(points, offset=OFFSET, records=[record]), "--keep-noise")
            with h5py.File(self.path("scan.h5")) as file:
                self.assertIn("landfall site frame", file["crs"].attrs["crs_wkt"].decode())
                self.assertIn("Transverse Mercator", file["crs"].attrs["crs_wkt"].decode())

    def test_a_short_name_of_the_crs_is_kept(self):
        keys = struct.pack("<24H", 1, 1, 0, 5, 1024, 0, 1, 1, 1026, 34737, 3, 0, 2048, 0, 1, 4326, 3072, 0, 1, 32767, 3074, 0, 1, 16032)
        records = [clouds.las_vlr("LASF_Projection", 34735, keys), clouds.las_vlr("LASF_Projection", 34737, b"ab|\0")]
        path = self.write("a.las", clouds.las(clouds.las_points(40), offset=OFFSET, records=records))
        self.assertEqual(json.loads(self.succeed("landfall-import", path, "-o", self.path("scan.h5"), "-q", "--json").stdout)["crs"], "ab")

    def test_feet_become_metres(self):
        foot = 1200 / 3937
        points = [{**p, "xyz": xyz} for p, xyz in zip(clouds.las_points(3), [(0, 0, 0), (100000, 0, 5000), (0, 100000, 0)])]
        data, _ = self.imported("a.las", clouds.las(points, offset=(6000000.0, 2100000.0, 0.0)), "--crs", "EPSG:2227", "--center",
                                "6000000,2100000", silent=False)
        np.testing.assert_allclose(data["x_est"], [0, 100 * foot, 0], atol=1e-9)
        np.testing.assert_allclose(data["z_est"], [0, 5, 0], atol=1e-9)
        self.assertIn("the unit of its heights is not declared", self.said)
        data, _ = self.imported("a.las", clouds.las(points, offset=(6000000.0, 2100000.0, 0.0)), "--crs", "EPSG:2227", "--vertical-scale", str(foot))
        np.testing.assert_allclose(data["z_est"], [0, 5 * foot, 0], atol=1e-9)

    def test_a_map_whose_scale_is_not_one_gives_ground_distances(self):
        data, _ = self.imported("m.csv", "x,y,z\n1000000,8399737.89,1\n1000010,8399737.89,2\n", "--crs", "EPSG:3857")  # 60 degrees north: scale 2
        self.assertAlmostEqual(data["x_est"][1] - data["x_est"][0], 5.0, delta=0.02)

    def test_real_files(self):
        files = [("riegl_fwf_2535pt_UTM.las", 2535, True), ("laspy_vegetation_1_3.las", 10683, False), ("leeward_points.las", 1325, True)]
        for name, count, has_crs in files:
            path = os.path.join(OUTSIDE, name)
            if not os.path.exists(path):
                self.skipTest(f"{path} is not there")
            done = self.succeed("landfall-import", path, "-o", self.path("real.h5"), "-O")
            self.assertEqual("has no CRS" in done.stderr, not has_crs)
            content = read_bytes(path)
            begin, = struct.unpack_from("<I", content, 96)
            size, = struct.unpack_from("<H", content, 105)
            scale = struct.unpack_from("<3d", content, 131)
            offset = struct.unpack_from("<3d", content, 155)
            with h5py.File(self.path("real.h5")) as file:
                points = file["points"]
                self.assertEqual(len(points["x_est"]), count)
                for k, axis in enumerate("xyz"):
                    stored = np.array([struct.unpack_from("<i", content, begin + i * size + 4 * k)[0] for i in range(count)])
                    back = (points[axis + "_est"][()] + points.attrs["origin_" + axis] - offset[k]) / scale[k]
                    np.testing.assert_array_equal(np.round(back), stored)


class Axes(Imports):
    GROUND = [(x * 0.5, y * 0.5, math.sin(x / 9) * math.cos(y / 7)) for x in range(40) for y in range(40)]

    def text(self, order, head=""):
        return head + "x,y,z\n" + "".join(",".join(f"{row[k] if k >= 0 else -row[-k - 1]:.6f}" for k in order) + "\n" for row in self.GROUND)

    def test_y_up_is_turned(self):
        expected, _ = self.imported("a.csv", self.text((0, 1, 2)), "--center", "0,0", silent=False)
        self.assertNotIn("--up", self.said)
        turned, _ = self.imported("b.csv", self.text((0, 2, -2)), "--center", "0,0", "--up", "y", silent=False)  # (x, z, -y)
        self.assertNotIn("--up y", self.said)
        for name in ("x_est", "y_est", "z_est"):
            np.testing.assert_allclose(turned[name], expected[name], atol=1e-9)

    def test_points_on_edge_and_comments_are_said(self):
        self.imported("a.csv", self.text((0, 2, 1)), silent=False)
        self.assertIn("it stands on edge like a wall, far longer in x and z than in y: if its y is up, --up y turns it", self.said)
        self.imported("a.csv", self.text((0, 2, 1)), "--up", "z", silent=False)
        self.assertNotIn("--up", self.said)
        for head, expected in (("# up_axis Y\n", "its comment '# up_axis Y' says that y is up"), ("# offset 500000 5400000 300\n", "is not applied")):
            self.imported("a.csv", self.text((0, 1, 2), head), silent=False)
            self.assertIn(expected, self.said)
        points = np.array(self.GROUND, "f4").view([(a, "f4") for a in "xyz"]).ravel()
        self.imported("a.ply", clouds.ply(points).replace(b"comment by a test", b"comment y up; offset 1 2 3"), silent=False)
        self.assertIn("'comment y up; offset 1 2 3' says that y is up", self.said)
        self.assertIn("'comment y up; offset 1 2 3' is not applied", self.said)

    def test_latitude_first(self):
        xyz = [(390000000 + i % 20, -834000000 + i // 20, i) for i in range(400)]
        points = [{**p, "xyz": at, "class": 2} for p, at in zip(clouds.las_points(400), xyz)]
        content = clouds.las(points, scale=1e-7)
        swapped = clouds.las([{**p, "xyz": (p["xyz"][1], p["xyz"][0], p["xyz"][2])} for p in points], scale=1e-7)
        expected, _ = self.imported("b.las", swapped, "--crs", "EPSG:4326", silent=False)
        data, attributes = self.imported("a.las", content, "--crs", "EPSG:4326", "--axis-order", "yx", silent=False)
        np.testing.assert_array_equal(data["x_est"], expected["x_est"])
        np.testing.assert_array_equal(data["y_est"], expected["y_est"])
        self.assertAlmostEqual(attributes["origin_x"], -83.4, places=4)

    def test_a_crs_that_contradicts_the_file_is_said(self):
        keys = struct.pack("<16H", 1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 32632, 3076, 0, 1, 9001)
        content = clouds.las(clouds.las_points(40), offset=OFFSET, records=[clouds.las_vlr("LASF_Projection", 34735, keys)])
        self.imported("a.las", content, "--crs", "EPSG:32632", "--keep-noise")
        self.imported("a.las", content, "--crs", "EPSG:32633", "--keep-noise", silent=False)
        self.assertEqual(self.said.count("warning"), 1)
        self.assertIn("its CRS is WGS 84 / UTM zone 32N, but --crs gives WGS 84 / UTM zone 33N, which is used", self.said)


class Times(Imports):
    NS = [1770000000000000001, 1770000000000000002, 1770000000100000001]

    def test_the_unit_is_asked_for_and_keeps_all_digits(self):
        content = "x,y,z,timestamp\n" + "".join(f"{i},0,0,{t}\n" for i, t in enumerate(self.NS))
        data, attributes = self.imported("a.csv", content, "--time-unit", "ns", silent=False)
        np.testing.assert_array_equal(data["t"], [0, 1e-9, 0.1])
        self.assertEqual(attributes["first_t_s"], 0)
        with h5py.File(self.path("scan.h5")) as file:
            self.assertIn("since 1770000000000000001 ns", file["points/t"].attrs["long_name"].decode())

    def test_more_than_a_day_is_said(self):
        points = np.zeros(9, [("x", "f4"), ("y", "f4"), ("z", "f4"), ("t", "u4")])
        points["t"] = np.arange(9) * 12500000
        self.imported("a.pcd", clouds.pcd(points), silent=False)
        self.assertIn("its times span 100000000 s, which is more than a day", self.said)
        data, _ = self.imported("a.pcd", clouds.pcd(points), "--time-unit", "ns", silent=False)
        np.testing.assert_array_equal(data["t"], np.arange(9) / 80)
        self.assertNotIn("a day", self.said)
        self.imported("a.las", clouds.las([{**p, "t": i * 1e6, "class": 2} for i, p in enumerate(clouds.las_points(9))], 1), *UTM)


class Precision(Imports):
    def test_steps_are_said(self):
        random = np.random.default_rng(4)
        x, y = random.uniform(0, 30, (2, 2000))
        xyz = np.column_stack([500000 + x, 5400000 + y, 300 + np.sin(x) * np.cos(y)])
        names = [(a, "f4") for a in "xyz"]
        single = np.array(xyz, "f4").view(names).ravel()
        for name, content in (("a.ply", clouds.ply(single)), ("a.pcd", clouds.pcd(single, "binary_compressed")), ("a.xyz", "".join("%g %g %g\n" % tuple(row) for row in xyz)),
                              ("a.las", clouds.las([{**p, "xyz": tuple(np.rint(row / 0.5).astype(int)), "class": 2} for p, row in zip(clouds.las_points(2000), xyz)], scale=0.5))):
            with self.subTest(name):
                self.imported(name, content, silent=False)
                self.assertRegex(self.said, r"y moves in steps of (0.5|10): more than a tenth of the spacing of its points, 0\.\d+")
        for name, content in (("b.xyz", "".join("%.2f %.2f %.2f\n" % tuple(row) for row in xyz)), ("b.ply", clouds.ply(np.array(xyz - (500000, 5400000, 0), "f4").view(names).ravel())),
                              ("c.xyz", "".join(f"{500000 + i % 64} {5400000 + i // 64} {300 + i % 7}\n" for i in range(4096)))):
            with self.subTest(name):
                self.imported(name, content, silent=False)
                self.assertNotIn("steps", self.said)

    def test_a_scan_of_landfall_has_no_steps(self):
        self.succeed("terrain-gen", "-c", self.config(TERRAIN, "t.json"), "-o", self.path("t.h5"))
        self.succeed("scan-sim", "-c", self.config(SCAN, "s.json"), "--terrain", self.path("t.h5"), "-o", self.path("s.h5"), "-q")
        self.succeed("landfall-export", self.path("s.h5"), "-o", self.path("s.ply"))
        said = self.succeed("landfall-import", self.path("s.ply"), "-o", self.path("again.h5")).stderr
        self.assertNotIn("steps", said)
        self.assertNotIn("--up", said)


def table(count=300, seed=2):
    random = np.random.default_rng(seed)
    kinds = [("x", "f4"), ("y", "f4"), ("z", "f4"), ("rgb", "u4"), ("intensity", "f4"), ("return_number", "u1"), ("gps_time", "f8"), ("pulse", "i4")]
    data = np.zeros(count, kinds)
    for axis in "xyz":
        data[axis] = random.uniform(-30, 30, count)
    data["rgb"] = 7
    data["intensity"] = random.integers(0, 50, count)
    data["return_number"] = random.integers(1, 4, count)
    data["gps_time"] = np.arange(count) / 64
    data["pulse"] = np.arange(count) // 3
    return data


class PcdAndPly(Imports):
    def check(self, data, expected):
        for name, column in (("x_est", "x"), ("y_est", "y"), ("z_est", "z"), ("intensity", "intensity"), ("return_number", "return_number"),
                             ("t", "gps_time"), ("pulse", "pulse")):
            np.testing.assert_array_equal(data[name], expected[column].astype(data[name].dtype), name)

    def test_pcd_in_its_three_forms(self):
        expected = table()
        for form in ("ascii", "binary", "binary_compressed"):
            with self.subTest(form):
                data, attributes = self.imported("a.pcd", clouds.pcd(expected, form), "--center", "0,0", silent=False)
                self.check(data, expected)
                self.assertEqual(self.said.count("warning"), 1)  # no CRS
                self.assertEqual(attributes["imported_from"].decode(), "PCD, " + form)

    def test_points_of_pcd_without_a_position_are_left_out(self):
        expected = table()
        expected["x"][5] = np.nan
        data, _ = self.imported("a.pcd", clouds.pcd(expected, "binary_compressed"), "--center", "0,0", silent=False)
        self.check(data, np.delete(expected, 5))
        self.assertIn("1 points without a finite position are left out", self.said)

    def test_a_viewpoint_is_said_to_be_ignored(self):
        self.imported("a.pcd", clouds.pcd(table(), "ascii", "VIEWPOINT 1 2 3 1 0 0 0"), silent=False)
        self.assertIn("its VIEWPOINT is ignored", self.said)

    def test_ply_in_its_three_forms(self):
        expected = table()
        for form in ("ascii", "binary_little_endian", "binary_big_endian"):
            for faces in (0, 3):
                with self.subTest(form=form, faces=faces):
                    data, _ = self.imported("a.ply", clouds.ply(expected, form, faces), "--center", "0,0", silent=False)
                    self.check(data, expected)
                    self.assertEqual("3 face" in self.said, faces == 3)


class Text(Imports):
    POINTS = [(10.5, 20.25, 1.5), (11.5, 21.25, 2.5), (12.5, 22.25, 3.5)]

    def check(self, name, content, *arguments, silent=False, warned=("has no CRS",)):
        data, attributes = self.imported(name, content, "--center", "10,20", *arguments, silent=silent)
        np.testing.assert_array_equal(np.column_stack([data["x_est"], data["y_est"], data["z_est"]]), np.array(self.POINTS) - [10, 20, 0])
        self.assertEqual(self.said.count("warning"), len(warned), self.said)
        for text in warned:
            self.assertIn(text, self.said)
        return data, attributes

    def rows(self, separator, end="\n", form="{}"):
        return end.join(separator.join(form.format(v) for v in row) for row in self.POINTS) + end

    def test_dialects(self):
        self.check("a.csv", "E;N;H\r\n" + self.rows(";", "\r\n"))
        self.check("a.txt", "\ufeff" + self.rows("\t"), warned=("has no CRS", "has no header"))
        self.check("a.xyz", "\n" + self.rows(" ") + "\n# end\n\n", warned=("has no CRS", "has no header"))
        self.check("a.pts", "3\n" + self.rows(" "), warned=("has no CRS", "has no header"))
        self.check("a.csv", "x,y,z\n" + self.rows(",")[:-1])
        self.check("a.csv", "x,y,z\n1e1,2e1,nan\n" + self.rows(","), warned=("has no CRS", "1 points without a finite position"))

    def test_columns_are_chosen_by_name_and_by_number(self):
        swapped = "\n".join(f"{z},{y},{x},{i}" for i, (x, y, z) in enumerate(self.POINTS)) + "\n"
        for arguments in (("--columns", "x=c,y=b,z=a,pulse=d"), ("--columns", "x=3,y=2,z=1,pulse=4")):
            data, _ = self.check("a.csv", "a,b,c,d\n" + swapped, *arguments)
            np.testing.assert_array_equal(data["pulse"], [0, 1, 2])
        data, _ = self.check("a.csv", swapped, "--columns", "x=3,y=2,z=1,t=4")
        np.testing.assert_array_equal(data["t"], [0, 1, 2])

    def test_helios(self):
        lines = "".join(f"{x:.4f} {y:.4f} {z:.4f} {100.5 + i} 0.0000 {1 + i % 2} 2 {i // 2} 3 0 {0.5 + i}\n" for i, (x, y, z) in enumerate(self.POINTS))
        data, attributes = self.check("leg000_points.xyz", lines)
        self.assertEqual(attributes["imported_from"], b"HELIOS++ xyz")
        np.testing.assert_array_equal(data["intensity"], [100.5, 101.5, 102.5])
        np.testing.assert_array_equal(data["return_number"], [1, 2, 1])
        np.testing.assert_array_equal(data["pulse"], [0, 0, 1])
        np.testing.assert_array_equal(data["t"], [0.5, 1.5, 2.5])
        self.assertEqual(attributes["first_t_s"], 0.5)


class Chain(Imports):
    """Points sampled on a known terrain, gridded and judged without true positions."""

    def setUp(self):
        super().setUp()
        self.terrain = self.path("terrain.h5")
        self.succeed("terrain-gen", "-o", self.terrain, "--set", "grid.half_width_m=12", "--set", "grid.resolution_m=0.25",
                     "--set", 'base={"type":"plane","slope_x":0.1,"slope_y":-0.05}')
        random = np.random.default_rng(5)
        x, y = random.uniform(-11, 11, (2, 40000))
        z = 0.1 * x - 0.05 * y + random.normal(0, 0.01, 40000)
        rows = np.column_stack([x, y, z, np.arange(40000) / 1000, np.arange(40000) // 4])
        self.scan = self.path("points.h5")
        self.succeed("landfall-import", self.write("points.csv", "x,y,z,t,pulse\n" + "\n".join(",".join(f"{v:.6f}" for v in row[:4]) + f",{row[4]:.0f}" for row in rows)),
                     "-o", self.scan, "--center", "0,0", "-q")
        self.dem = self.path("dem.h5")
        self.grid = ("--set", "half_width_m=10", "--set", "resolution_m=0.25")

    def regrid(self, *arguments):
        return self.succeed("regrid", self.scan, "-o", self.dem, "-O", *self.grid, *arguments)

    def evaluate(self, *arguments):
        self.succeed("dem-eval", self.dem, "-o", self.path("eval.h5"), "-O", "--metrics", self.path("metrics.json"), "--set", "region_radius_m=8", *arguments)
        return json.loads(read_bytes(self.path("metrics.json")))

    def test_regrid_takes_the_truth_at_the_centre_of_the_bin(self):
        self.regrid("--terrain", self.terrain)
        with h5py.File(self.dem) as file:
            self.assertNotIn("x_true", file)
            self.assertNotIn("y_true", file)
            x, y = np.meshgrid(file["x"][()], file["y"][()])
            z_true = file["z_true"][()]
            np.testing.assert_array_equal(np.isnan(z_true), file["count"][()] == 0)
            self.assertLess(np.nanmax(np.abs(z_true - (0.1 * x - 0.05 * y))), 1e-9)
            self.assertEqual(file["z_true"].attrs["long_name"], b"true elevation at the bin centre")
            self.assertLess(np.nanmax(np.abs(file["t_mean"][()])), 40)
            count = int(file["count"][()].sum())
        points = columns(self.scan, "points")
        bins = np.floor(np.stack([points["x_est"], points["y_est"]]) / 0.25 + 0.5)
        self.assertEqual(count, int(np.all(np.abs(bins) <= 40, axis=0).sum()))

    def test_only_what_is_known_is_judged(self):
        self.regrid("--terrain", self.terrain)
        metrics = self.evaluate()
        self.assertIs(metrics["requirements"]["relative_elevation"]["pass"], True)
        for name in ("relative_horizontal", "absolute_horizontal"):
            self.assertIsNone(metrics["requirements"][name]["pass"])
            self.assertIsNone(metrics["requirements"][name]["value"])
        self.assertIsNone(metrics["pass"])
        self.assertIsNone(metrics["accuracy"]["relative"]["x"]["violation_count"])
        self.assertEqual(metrics["accuracy"]["relative"]["z"]["violation_count"], 0)
        self.assertIsNone(metrics["accuracy"]["absolute"]["horizontal"]["within_limit_frac"])
        with h5py.File(self.path("eval.h5")) as file:
            self.assertIn("rel_z", file)
            self.assertNotIn("rel_x", file)
        result = self.succeed("dem-eval", self.dem, "--table", "--set", "region_radius_m=8")
        self.assertRegex(result.stdout, "relative_horizontal +no true positions to compare with .* not judged")
        metrics = self.evaluate("--set", "limits.relative_elevation_m=0.001")
        self.assertIs(metrics["pass"], False)
        self.assertEqual(run("dem-eval", self.dem, "--metrics-only", "--require-pass", "--set", "region_radius_m=8").returncode, 3)

    def test_without_a_terrain_only_the_coverage_is_judged(self):
        self.regrid()
        metrics = self.evaluate("--set", "limits.invalid_frac=0", "--set", "limits.hole_bins=0")
        self.assertIsNone(metrics["pass"])
        self.assertIsNone(metrics["accuracy"]["quantile"])

    def test_reports_hazards_and_exports_say_where_the_data_come_from(self):
        self.regrid("--terrain", self.terrain)
        self.evaluate("--report", self.path("report.html"))
        self.assertIn("imported from points.csv (text with a header)", read_bytes(self.path("report.html")).decode())
        self.succeed("hazard-map", self.dem, "--terrain", self.terrain, "-o", self.path("hazards.h5"), "--report", self.path("hazards.html"),
                     "--score", self.path("score.json"))
        self.assertIn("points.csv", read_bytes(self.path("hazards.html")).decode())
        shown = self.succeed("landfall-info", self.scan).stdout
        self.assertIn("text with a header, origin at 0, 0, 0", shown)
        self.assertIn("40000, one per point", shown)
        for extension in ("csv", "ply", "las", "xmf", "png"):
            self.succeed("landfall-export", self.scan, "-o", self.path("points." + extension), *(["--time", "scan"] if extension == "las" else []), "-O")
        for extension in ("ply", "las", "csv"):
            self.succeed("landfall-import", self.path("points." + extension), "-o", self.path("again.h5"), "--center", "0,0", "-O", "-q")
            with h5py.File(self.scan) as a, h5py.File(self.path("again.h5")) as b:
                for name in ("x_est", "y_est", "z_est"):
                    np.testing.assert_allclose(a["points"][name][()], b["points"][name][()], atol=0.51e-6)

    def test_a_bin_and_a_comparison(self):
        self.regrid("--terrain", self.terrain)
        result = json.loads(self.succeed("landfall-info", self.dem, "--at", "1,2", "--scan", self.scan, "--json").stdout)
        text = json.dumps(result)
        self.assertIn('"range_true_m": null', text)
        self.assertIn('"pixel": null', text)
        self.assertNotIn('"t_s": null', text)
        other = self.path("other.h5")
        self.succeed("regrid", self.scan, "-o", other, *self.grid, "--method", "mean")
        self.succeed("landfall-info", "--compare", self.dem, other, "--json")
        self.succeed("landfall-info", "--compare", self.scan, self.scan)

    def test_what_an_imported_scan_cannot_give_is_refused(self):
        self.refuse(2, "regrid", self.scan, "-o", self.path("x.h5"), *self.grid, "--layers", "z_est,x_true",
                    words=["x_true needs scans with true points"], output=self.path("x.h5"))

    def test_points_without_times_give_no_mean_time(self):
        self.succeed("landfall-import", self.write("p.csv", "x,y,z\n-0.5,-0.5,1\n0.5,0,2\n"), "-o", self.path("p.h5"), "-q")
        with h5py.File(self.path("p.h5")) as file:
            self.assertEqual(str(file["points"].attrs["origin_x"]), "0.0")
        self.succeed("regrid", self.path("p.h5"), "-o", self.dem, "-O", *self.grid)
        with h5py.File(self.dem) as file:
            self.assertNotIn("t_mean", file)
        self.assertEqual(self.succeed("landfall-export", self.path("p.h5"), "-o", self.path("p.las")).stderr.count("its points have no times"), 1)
        self.succeed("landfall-import", self.path("p.las"), "-o", self.path("again.h5"), "-q", "--center", "0,0")
        self.assertEqual(columns(self.path("again.h5"), "points")["z_est"].tolist(), [1, 2])
        with h5py.File(self.path("again.h5")) as file:
            self.assertEqual(file["points"].attrs["imported_from"], b"LAS 1.2, point format 0")

    def test_what_las_cannot_hold_is_said(self):
        self.succeed("landfall-import", self.write("p.csv", "x,y,z,return_number,intensity\n0,0,1,1,0.25\n1,1,2,6,70000\n"), "-o", self.path("p.h5"), "-q")
        said = self.succeed("landfall-export", self.path("p.h5"), "-o", self.path("p.las")).stderr
        self.assertIn("intensities are rounded to integers of 0 to 65535", said)
        self.assertIn("numbers of returns above 5 are written as 5", said)


class Rasters(Imports):
    """Elevation models as ESRI grids, which need no library to write."""

    PRJ = ('PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
           'UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],'
           'PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]]')

    DEGREES = 'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]'

    def grid(self, name, values, west, south, step, prj=PRJ):
        """`values` from north to south; west and south are the centres of the first pixels."""
        rows = "".join(" ".join("-9999" if np.isnan(v) else repr(float(v)) for v in row) + "\n" for row in values)
        path = self.write(name + ".asc", f"ncols {values.shape[1]}\nnrows {values.shape[0]}\nxllcenter {west}\nyllcenter {south}\ncellsize {step}\nNODATA_value -9999\n" + rows)
        if prj:
            self.write(name + ".prj", prj)
        return path

    def setUp(self):
        super().setUp()
        self.values = np.arange(21 * 31, dtype=float).reshape(21, 31) / 64 + 100
        self.values[3, 4] = np.nan
        self.dem = self.grid("dem", self.values, 500000, 5400000, 0.5)
        self.out = self.path("dem.h5")

    def imported_dem(self, *arguments):
        return self.succeed("landfall-import", *arguments, "-o", self.out, "-O").stderr

    def test_pixels_become_bins_of_a_rectangular_grid(self):
        self.assertEqual(self.imported_dem(self.dem), "")
        with h5py.File(self.out) as file:
            np.testing.assert_array_equal(file["z_est"][()], self.values[::-1])
            np.testing.assert_array_equal(file["count"][()], ~np.isnan(self.values[::-1]))
            np.testing.assert_allclose(file["x"][()], (np.arange(31) - 15) * 0.5, atol=1e-12)
            np.testing.assert_allclose(file["y"][()], (np.arange(21) - 10) * 0.5, atol=1e-12)
            self.assertNotIn("z_true", file)
            self.assertIn("Transverse Mercator", file["crs"].attrs["crs_wkt"].decode())
        self.succeed("dem-eval", self.out, "--table", "--set", "region_radius_m=5", "--set", "footprint_m=1")
        self.succeed("hazard-map", self.out, "-o", self.path("h.h5"), "--set", "region_radius_m=4", "--set", "lander.leg_radius_m=1", "--set",
                     "lander.body_radius_m=1")

    def test_the_center_moves_to_the_nearest_pixel(self):
        self.imported_dem(self.dem, "--center", "500002.2,5400001.6")
        with h5py.File(self.out) as file:
            self.assertEqual((file["x"][0], file["y"][0]), (-2.0, -1.5))

    def test_a_truth_raster_on_another_grid_is_interpolated_bilinearly(self):
        north, east = np.meshgrid(np.arange(60) * 0.3 - 3, np.arange(80) * 0.3 - 3, indexing="ij")
        truth = self.grid("truth", (50 + 2 * east - north)[::-1], 499997, 5399997, 0.3)
        self.assertEqual(self.imported_dem(self.dem, "--truth", truth), "")
        with h5py.File(self.out) as file:
            x, y = np.meshgrid(file["x"][()] + 7.5, file["y"][()] + 5)
            np.testing.assert_allclose(file["z_true"][()], 50 + 2 * x - y, atol=1e-6)
            self.assertEqual(file["z_true"].attrs["comment"], b"bilinear interpolation of truth.asc")
            row, col = np.argwhere((np.abs(file["y"][()] - 2) < 0.1)[:, None] & (np.abs(file["x"][()] - 1) < 0.1))[0]
            z_true = file["z_true"][row, col]
        at = json.loads(self.succeed("landfall-info", self.out, "--at", "1,2", "--json").stdout)
        self.assertIn(repr(float(z_true)), json.dumps(at))
        self.assertIn("\nz_true, m              651        0 ", self.succeed("landfall-info", "--compare", self.out, self.out).stdout)
        self.succeed("dem-eval", self.out, "--metrics", self.path("m.json"), "--set", "region_radius_m=4", "--set", "footprint_m=2.5")
        metrics = json.loads(read_bytes(self.path("m.json")))
        self.assertIs(metrics["pass"], False)
        self.assertIsNone(metrics["requirements"]["relative_horizontal"]["pass"])

    def test_a_truth_in_degrees_is_reprojected(self):
        step = 2e-6
        rows, cols = 60, 90
        lat0, lon0 = 48.753, 9.0 - 4e-6  # the meridian arc of 5,400,000 m / 0.9996 ends at 48.753013 degrees
        truth = self.grid("truth", np.tile(np.arange(cols, dtype=float), (rows, 1)), lon0, lat0, step, prj=self.DEGREES)
        self.imported_dem(self.grid("small", self.values[:5, :9], 500000, 5400000, 0.5), "--truth", truth)
        with h5py.File(self.out) as file:
            z = file["z_true"][()]
            self.assertEqual(file["z_true"].attrs["comment"], b"bilinear interpolation of truth.asc, reprojected by GDAL")
        phi, e2 = math.radians(48.7528), (2 - 1 / 298.257223563) / 298.257223563
        metres = math.radians(step) * 6378137 / math.sqrt(1 - e2 * math.sin(phi) ** 2) * math.cos(phi) * 0.9996
        np.testing.assert_allclose(z, np.tile(2 + np.arange(9) * 0.5 / metres, (5, 1)), atol=1e-3)

    def test_the_truth_of_a_terrain(self):
        terrain = self.path("t.h5")
        north, east = np.meshgrid(np.arange(60) * 0.5 - 10, np.arange(80) * 0.5 - 10, indexing="ij")
        ground = self.grid("ground", (10 + east + 2 * north)[::-1], 499990, 5399990, 0.5)
        self.succeed("terrain-gen", "--from", ground, "-o", terrain, "--center", "500007.5,5400005", "--datum", "none", "--half-width", "8", "--resolution", "0.5")
        self.imported_dem(self.dem, "--terrain", terrain)
        with h5py.File(self.out) as file:
            x, y = np.meshgrid(file["x"][()] + 7.5, file["y"][()] + 5)
            np.testing.assert_allclose(file["z_true"][()], 10 + x + 2 * y, atol=1e-6)
        moved = self.imported_dem(self.dem, "--terrain", terrain, "--center", "500008,5400005")
        self.assertIn("t.h5: is moved by (-0.5, 0, 0) m", moved)
        with h5py.File(self.out) as file:
            x, y = np.meshgrid(file["x"][()] + 8, file["y"][()] + 5)
            np.testing.assert_allclose(file["z_true"][()][:, 1:], (10 + x + 2 * y)[:, 1:], atol=1e-6)
        self.imported_dem(self.dem, "--terrain", terrain, "--center", "500008,5400005", "--other-terrain")

    def test_a_truth_of_a_part(self):
        part = self.grid("part", self.values[:, :20], 500000, 5400000, 0.5)
        self.assertRegex(self.imported_dem(self.dem, "--truth", part), r"has no value at 231 of 650 bins with an elevation")

    def test_a_raster_without_a_crs_is_in_metres(self):
        plain = self.grid("plain", self.values, 100, 200, 2, prj=None)
        self.assertIn("are taken as metres", self.imported_dem(plain))
        with h5py.File(self.out) as file:
            self.assertEqual(file["x"][1] - file["x"][0], 2)


if __name__ == "__main__":
    unittest.main()
