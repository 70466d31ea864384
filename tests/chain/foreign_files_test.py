#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and meshes as other programs write them, through the tools: the same content gives the same result."""
import os
import struct
import unittest

import h5py
import numpy as np

from harness import ToolTest, columns, read_bytes, run

DATA = os.path.join(os.environ.get("LANDFALL_DATA", os.path.join(os.environ["LANDFALL_ROOT"], "..", "shared", "data")), "strangers")
NAMES = ["t_s", "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps", "roll_deg", "pitch_deg", "yaw_deg"]
EPOCH = 1.4e9  # GPS seconds: float64 has steps of 2.4e-7 s there


def rows(epoch=0.0):
    """A swinging descent; its times are multiples of 2^-20 s."""
    t = np.round(np.linspace(0, 3, 11) * 2**20) / 2**20
    motion = [5 * np.sin(t), -4 + 3 * t, 300 - 23 * t, 5 * np.cos(t), 3 + 0 * t, -23 + 0 * t, 2 * t, -t, 10 * t]
    return np.column_stack([epoch + t, *motion])


def text(table, separator=",", names=NAMES, number="%.17g"):
    lines = [separator.join(names)] + [separator.join(number % value for value in row) for row in table]
    return "\n".join(lines) + "\n"


class Trajectories(ToolTest):
    def setUp(self):
        super().setUp()
        self.ground = self.path("ground.h5")
        self.succeed("terrain-gen", "-o", self.ground, "--set", "grid.half_width_m=60", "--set", "grid.resolution_m=1",
                     "--set", 'base={"type":"plane","slope_x":0.1,"slope_y":0.05}')

    def scan(self, table, name="scan.h5", **keys):
        scan = self.path(name)
        config = {"detector": {"rows": 4, "columns": 4}, "laser": {"pulse_rate_hz": 700, "scan_time_s": 0.5},
                  "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": 9, "columns": 9, "half_width_m": 20}},
                  "pointing_error": {"time_stamp_bias_s": 1e-4}, "trajectory": {"type": "table", "path": table}} | keys
        self.succeed("scan-sim", "-O", "--terrain", self.ground, "-o", scan, "-c", self.config(config))
        return scan

    def expect_same_points(self, found, expected):
        points = columns(expected, "points")
        for column, values in columns(found, "points").items():
            np.testing.assert_array_equal(values, points[column], column)

    def test_a_clock_with_large_times_changes_nothing(self):
        table, gps = self.write("t.csv", text(rows())), self.write("gps.csv", text(rows(EPOCH)))
        scans = [self.scan(table, "t.h5"), self.scan(gps, "gps.h5")]
        self.expect_same_points(scans[1], scans[0])
        k = np.arange(350)
        np.testing.assert_array_equal(columns(scans[0], "pulses")["t"], k / 700)
        np.testing.assert_array_equal(columns(scans[1], "pulses")["t"], EPOCH + k / 700)
        estimates = [self.scan(table, "te.h5", navigation_error={"table": table}),
                     self.scan(gps, "ge.h5", navigation_error={"table": gps})]
        self.expect_same_points(estimates[1], estimates[0])
        self.check_maps(scans)
        self.check_las(scans)

    def check_maps(self, scans):
        dems = []
        for scan in scans:
            dem = self.path("dem.h5")
            self.succeed("regrid", "-O", scan, "-o", dem, "--uncertainty", "--range-sigma", "0.1", "--navigation-sigma",
                         "velocity_mps=0.1,0.1,0.1", "--set", "half_width_m=20", "--set", "resolution_m=1")
            with h5py.File(dem) as file:
                self.assertEqual(file["t_mean"].dtype, np.float64)
                dems.append({name: file[name][()] for name in ("t_mean", "z_est", "z_sigma_abs")} |
                            {"epoch_s": file["t_mean"].attrs["epoch_s"]})
        self.assertEqual([dem.pop("epoch_s") for dem in dems], [0, EPOCH])
        for name, values in dems[0].items():
            np.testing.assert_array_equal(dems[1][name], values, name)
        times = dems[0]["t_mean"]
        self.assertGreater(len(np.unique(times[np.isfinite(times)])), 20)
        plans = []
        for table in ("t.csv", "gps.csv"):
            self.succeed("scan-sim", "-O", "--plan", "-o", self.path("plan.h5"), "-c", self.config(
                {"detector": {"rows": 4, "columns": 4}, "laser": {"pulse_rate_hz": 700, "scan_time_s": 0.5},
                 "trajectory": {"type": "table", "path": self.path(table)}}), "--plan-radius", "5")
            plans.append(columns(self.path("plan.h5"))["first_seen"])
        np.testing.assert_array_equal(plans[1], plans[0])

    def check_las(self, scans):
        def las(scan, *options):
            path = self.path("scan.las")
            result = run("landfall-export", "-O", scan, "-o", path, *options)
            self.assertEqual(result.returncode, 0, result.stderr)
            content = read_bytes(path)
            begin, count = struct.unpack_from("<I", content, 96)[0], struct.unpack_from("<I", content, 107)[0]
            times = [struct.unpack_from("<d", content, begin + 28 * i + 20)[0] for i in range(count)]
            return struct.unpack_from("<H", content, 6)[0], np.array(times), result.stderr

        since = columns(scans[0], "points")["pulse"] / 700
        for scan in scans:
            encoding, times, said = las(scan)
            self.assertEqual(encoding, 0)
            np.testing.assert_array_equal(times, since)
            self.assertIn("times are seconds since the first pulse; --time gps", said)
            self.assertEqual(len(said.splitlines()), 1)
            self.assertEqual(las(scan, "--time", "scan")[2], "")
        encoding, times, said = las(scans[1], "--time", "gps")
        self.assertEqual((encoding, said), (1, ""))
        np.testing.assert_array_equal(times, 4e8 + since)
        self.assertIn("January 1980", las(scans[0], "--time", "gps")[2])
        self.refuse(2, "landfall-export", scans[0], "-o", self.path("scan.ply"), "--time", "gps", words=["--time", ".ply"])

    def test_tables_of_other_programs(self):
        table = rows()
        plain = self.scan(self.write("t.csv", text(table)), "plain.h5")
        header, body = text(table, number="%.17e").split("\n", 1)
        fortran = body.replace("e", "D")
        quoted = ['"' + name + '"' for name in NAMES]
        for content in (text(table, ";"), text(table, "\t"), text(table, "  "), text(table, names=quoted),
                        text(table, names=[name.upper() for name in NAMES]), "# " + text(table, " "),
                        text(table, number="%+.17e"), text(table).replace("\n", "\r"), "\ufeff" + text(table, ";"),
                        text(table).replace(",0,", ",1e-400,"), "\n".join([header, fortran])):
            with self.subTest(content[:40]):
                self.expect_same_points(self.scan(self.write("other.csv", content)), plain)
        for shape in ((1, -1), (-1, 1)):
            for group in ("/", "/flight/"):
                with h5py.File(self.path("t.h5"), "w", userblock_size=512) as file:
                    for name, values in zip(NAMES, table.T):
                        file[group + name] = values.reshape(shape)
                self.expect_same_points(self.scan(self.path("t.h5")), plain)

    @unittest.skipUnless(os.path.isdir(DATA), "shared/data/strangers is absent")
    def test_shared_tables(self):
        plain = self.scan(os.path.join(DATA, "tr0.csv"), "plain.h5")
        for name in ("trg.csv", "caps.csv", "semi.csv", "tab.csv", "quote.csv", "col.h5", "row.h5"):
            with self.subTest(name):
                self.expect_same_points(self.scan(os.path.join(DATA, name)), plain)
        self.scan(os.path.join(DATA, "plus.csv"))  # rounded to 12 decimals


class Meshes(ToolTest):
    @unittest.skipUnless(os.path.isdir(DATA), "shared/data/strangers is absent")
    def test_shared_meshes(self):
        for name, facets in (("multi.stl", 24), ("binsolid.stl", 12), ("mixed.ply", 14), ("strips.ply", 2)):
            with self.subTest(name):
                self.succeed("terrain-gen", "-O", "--from", os.path.join(DATA, name), "-o", self.path("m.h5"))
                with h5py.File(self.path("m.h5")) as file:
                    self.assertEqual(len(file["mesh/triangles"]), facets)

    def test_shape_models_and_other_elements(self):
        shape = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        for content in (shape, shape.replace("\n", "\r"), shape.replace("\n", "\r\n")):
            self.succeed("terrain-gen", "-O", "--from", self.write("shape.tab", content), "-o", self.path("m.h5"))
        ply = ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
               "property list uchar int vertex_indices\nelement camera 1\nproperty float f\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n5\n")
        self.write("m.ply", ply)
        result = run("terrain-gen", "-O", "--from", self.path("m.ply"), "-o", self.path("m.h5"))
        self.assertEqual(result.returncode, 0)
        self.assertIn("element 'camera' (1) is not read", result.stderr)


if __name__ == "__main__":
    unittest.main()
