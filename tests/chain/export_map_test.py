#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall-export of scans that lie on a map: what is saved lies where it was."""
import json
import os
import struct
import subprocess
import unittest

import h5py
import numpy as np

from harness import ToolTest, clouds, read_bytes

OFFSET = (548351.0, 5389938.0, 235.0)


def read_las(path):
    """Version, WKT, scale, offset and X, Y, Z of a file of point format 0 or 1."""
    content = read_bytes(path)
    header, begin, count_of_records = struct.unpack_from("<HII", content, 94)
    size, legacy = struct.unpack_from("<HI", content, 105)
    scale, offset = (np.array(struct.unpack_from("<3d", content, at)) for at in (131, 155))
    wkt = ""
    for _ in range(count_of_records):
        user, number, length = struct.unpack_from("<16sHH", content, header + 2)
        if user.rstrip(b"\0") == b"LASF_Projection" and number == 2112:
            wkt = content[header + 54:header + 54 + length].rstrip(b"\0").decode()
        header += 54 + length
    xyz = np.array([struct.unpack_from("<3i", content, begin + i * size) for i in range(legacy)])
    return tuple(content[24:26]), wkt, scale, offset, xyz


class ExportOnAMap(ToolTest):
    def imported(self, source, *arguments, name="scan.h5"):
        self.succeed("landfall-import", "-q", source, "-o", self.path(name), "-O", "--keep-noise", *arguments)
        return self.path(name)

    def export(self, scan, name, *arguments):
        self.said = self.succeed("landfall-export", scan, "-o", self.path(name), "-O", *arguments).stderr
        return self.path(name)

    def site(self, scan):
        with h5py.File(scan) as file:
            return np.column_stack([file["points"][axis + "_est"][()] for axis in "xyz"])

    def las(self, offset=OFFSET, scale=0.001):
        return self.write("a.las", clouds.las(clouds.las_points(200), 0, offset=offset, scale=scale))

    def test_a_las_comes_back_to_its_integers(self):
        units = np.array([p["xyz"] for p in clouds.las_points(200)])
        cases = [("EPSG:32632", OFFSET, [0.001] * 3, "UTM zone 32N", None),
                 ("EPSG:32632", (548351.25, 5389938.5, 235.0), [0.001] * 3, "UTM zone 32N", "548300.5,5389900.25,200.75"),
                 ("EPSG:32632", OFFSET, [0.001] * 3, "UTM zone 32N", "0,5000000"),
                 ("EPSG:2227", (6000000.0, 2100000.0, 0.0), [0.001] * 3, "California zone 3", None),
                 ("EPSG:4326", (9.1, 48.7, 100.0), [1e-7] * 3, "WGS 84", None),
                 ("EPSG:3857", (1000000.0, 8399737.0, 100.0), [0.001] * 3, "Pseudo-Mercator", None),
                 ("+proj=longlat +R=1737400 +no_defs", (179.999, -89.0, -1000.0), [1e-7] * 3, "", None),
                 ("+proj=stere +lat_0=-90 +R=1737400 +no_defs", (12000.0, -15000.0, -1000.0), [0.001] * 3, "Stereographic", None)]
        for crs, offset, scale, words, center in cases:
            with self.subTest(crs=crs, center=center):
                source = self.las(offset, scale[0])
                scan = self.imported(source, "--crs", crs, *(["--center", center] if center else []))
                exported = self.export(scan, "b.las")
                self.assertIn("points have no times", self.said)
                version, wkt, out_scale, out_offset, xyz = read_las(exported)
                self.assertEqual(version, (1, 4))
                self.assertIn(words, wkt)
                back = (xyz * out_scale + out_offset - offset) / scale
                finest = max(1, 1e-6 / scale[2])  # of heights beside degrees, units of the source
                np.testing.assert_array_equal(np.round(back[:, :2]), units[:, :2])
                np.testing.assert_allclose(back[:, 2], units[:, 2], rtol=0, atol=finest / 2 + 1e-3)
                with h5py.File(scan) as file:
                    origin = ",".join(repr(float(file["points"].attrs["origin_" + axis])) for axis in "xyz")
                again = self.imported(exported, "--center", origin, name="again.h5")
                np.testing.assert_allclose(self.site(again), self.site(scan), atol=2e-4)

    def test_other_formats_hold_the_same_coordinates(self):
        source = self.las()
        scan = self.imported(source, "--crs", "EPSG:32632", "--center", "548351,5389938,200")
        expected = np.array([p["xyz"] for p in clouds.las_points(200)]) * 0.001 + OFFSET
        ply = self.imported(self.export(scan, "b.ply", "--columns", "status"), "--crs", "EPSG:32632", "--center", "548351,5389938", name="p.h5")
        self.assertEqual(self.said, "")
        np.testing.assert_allclose(self.site(ply), expected - (548351, 5389938, 0), atol=2e-9)
        self.assertIn(b"comment crs PROJCS[\"WGS 84 / UTM zone 32N\"", read_bytes(self.path("b.ply")))
        csv = self.imported(self.export(scan, "b.csv"), "--crs", "EPSG:32632", "--center", "548351,5389938", name="c.h5")
        self.assertEqual(self.said, "")
        np.testing.assert_allclose(self.site(csv), expected - (548351, 5389938, 0), atol=2e-9)
        header, data = read_bytes(self.export(scan, "b.pcd", "--columns", "status")).split(b"DATA binary\n")
        self.assertIn("relative to the translation of VIEWPOINT, 548351, 5389938, 200 in WGS 84 / UTM zone 32N", self.said)
        self.assertIn(b"VIEWPOINT 548351 5389938 200 1 0 0 0", header)
        table = np.frombuffer(data, [("xyz", "<f4", 3), ("status", "i1")])
        np.testing.assert_allclose(table["xyz"] + (548351.0, 5389938.0, 200.0), expected, atol=1e-5)

    def test_the_site_frame_is_there_for_the_asking(self):
        scan = self.imported(self.las(), "--crs", "EPSG:32632")
        version, wkt, scale, offset, xyz = read_las(self.export(scan, "b.las", "--frame", "site"))
        self.assertEqual((version, wkt), ((1, 2), ""))
        np.testing.assert_allclose(xyz * scale + offset, self.site(scan), atol=1e-6)
        with open(self.export(scan, "b.csv", "--frame", "site"), encoding="ascii") as file:
            self.assertTrue(file.readline().startswith("x_est_m,y_est_m,z_est_m"))

    def test_longitudes_and_latitudes_name_themselves(self):
        scan = self.imported(self.las((9.1, 48.7, 100.0), 1e-7), "--crs", "EPSG:4326")
        with open(self.export(scan, "b.csv", "--columns", "x_est,y_est"), encoding="ascii") as file:
            self.assertEqual(file.readline(), "longitude_deg,latitude_deg\n")
        self.refuse(2, "landfall-export", scan, "-o", self.path("c.csv"), "--columns", "x_est", words=["x_est and y_est", "--frame site"],
                    output=self.path("c.csv"))

    def test_a_scan_on_no_map_stays_in_its_frame(self):
        scan = self.imported(self.las())
        self.assertEqual(read_las(self.export(scan, "b.las"))[:2], ((1, 2), ""))
        self.refuse(2, "landfall-export", scan, "-o", self.path("c.las"), "--frame", "map", words=["--frame map", "has no CRS", "--crs"],
                    output=self.path("c.las"))

    def test_formats_without_a_frame_refuse_the_option(self):
        scan = self.imported(self.las(), "--crs", "EPSG:32632")
        for name in ("c.xmf", "c.png"):
            self.refuse(2, "landfall-export", scan, "-o", self.path(name), "--frame", "map", words=["--frame does not apply"], output=self.path(name))
        self.export(scan, "d.xmf")
        self.assertIn("site frame", self.said)

    def test_a_simulated_scan_lies_where_its_terrain_does(self):
        subprocess.run([os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "make_strip.py")], cwd=self.path("."), check=True)
        self.succeed("terrain-gen", "-q", "--from", self.path("reference.asc"), "-o", self.path("t.h5"), "--center", "500010,5400005")
        scan = self.path("scan.h5")
        self.succeed("scan-sim", "--terrain", self.path("t.h5"), "-o", scan, "--set", "laser.scan_time_s=0.02", "--set",
                     'scanner.pattern={"type":"line_search","rows":4,"columns":8,"half_width_m":6}')
        height = json.loads(self.succeed("landfall-info", scan, "--json", "--no-statistics").stdout)["crs"]["place"]["height_m"]
        self.assertGreater(height, 100, "the elevation of the centre became 0")
        for position in ("est", "true"):
            _, wkt, scale, offset, xyz = read_las(self.export(scan, "b.las", "--position", position))
            self.assertIn("UTM zone 32N", wkt)
            with h5py.File(scan) as file:
                points = file["points"]
                returned = np.isin(points["status"][()], (0, 6))
                expected = np.column_stack([points[f"{axis}_{position}"][()][returned] for axis in "xyz"])
            np.testing.assert_allclose(xyz * scale + offset, expected + (500010, 5400005, height), atol=1e-6)


if __name__ == "__main__":
    unittest.main()
