#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall-info --compare of two scans against scipy, and with scans whose differences are known."""
import json
import unittest

import h5py
import numpy as np
from scipy import stats
from scipy.spatial.distance import cdist

from harness import ChainTest, read_bytes

MOUNT_ERROR = {"pointing_error": {"misalignment_rpy_rad": [0.002, -0.002, 0]}}


def ks(a, b):
    return stats.ks_2samp(a[np.isfinite(a)], b[np.isfinite(b)]).statistic


def returns(path):
    """x, y, z (n, 3) and range of the returns of a scan, in their order."""
    with h5py.File(path) as file:
        points = file["points"]
        kept = np.isin(points["status"][()], (0, 6))
        read = lambda name: points[name][()][kept]
        return np.stack([read(f"{axis}_est") for axis in "xyz"], -1), read("range_measured"), read("range_measured") - read("range_true")


class Likeness(ChainTest):
    def scan(self, name, **values):
        config = json.loads(read_bytes(self.chain.config("scan-sim")))
        for key, value in values.items():
            config[key] = {**config[key], **value} if isinstance(value, dict) and key in config else value
        self.succeed("scan-sim", "-c", self.config(config, name + ".json"), "--terrain", self.chain.terrain, "-o", self.path(name + ".h5"))
        return self.path(name + ".h5")

    def imported(self, name, points, header="x,y,z,t", *arguments):
        np.savetxt(self.path(name + ".csv"), points, delimiter=",", header=header, comments="", fmt="%.17g")
        self.succeed("landfall-import", self.path(name + ".csv"), "-o", self.path(name + ".h5"), "--center", "0,0,0", *arguments)
        return self.path(name + ".h5")

    def compare(self, a, b, *arguments):
        """The comparison, and its statistics by name."""
        found = json.loads(self.succeed("landfall-info", "--compare", a, b, "--json", *arguments).stdout)
        return found, {one["name"]: one for one in found["likeness"]["statistics"]}

    def differing(self, by_name):
        return {name for name, one in by_name.items() if one["differs"]}

    def test_distances_equal_scipys(self):
        other = self.scan("other", seed=8, noise={"range_sigma_m": 0.03, "dropout_frac": 0.3})
        found, by_name = self.compare(self.chain.scan, other)
        (a, range_a, error_a), (b, range_b, error_b) = returns(self.chain.scan), returns(other)
        self.assertEqual(found["likeness"]["returns"], {"a": len(a), "b": len(b)})
        s = found["likeness"]["posting_m"]
        bins = [np.floor(points[:, :2] / s + 0.5).astype(int) for points in (a, b)]
        _, number = np.unique(np.concatenate(bins), axis=0, return_inverse=True)
        counts = [np.bincount(part, minlength=number.max() + 1) for part in np.split(number.ravel(), [len(a)])]
        along = [np.hypot(*np.diff(points[:, :2], axis=0).T) for points in (a, b)]
        wanted = {"density": ks(*counts), "density_map": 1 - np.corrcoef(*counts)[0, 1], "coverage": np.mean((counts[0] == 0) != (counts[1] == 0)),
                  "spacing_along": ks(*along), "range_measured": ks(range_a, range_b), "range_error": ks(error_a, error_b)}
        for name, value in wanted.items():
            self.assertAlmostEqual(by_name[name]["distance"], value, delta=1e-12, msg=name)
        for name, values in {"density": [c[c > 0].mean() for c in counts], "spacing_along": [np.median(d) for d in along],
                             "range_measured": [np.median(range_a), np.median(range_b)]}.items():
            np.testing.assert_allclose([by_name[name][side] for side in "ab"], values, rtol=1e-12, err_msg=name)
        self.assertLessEqual({"range_error", "density", "spacing_across"}, self.differing(by_name))
        for name, one in by_name.items():
            if one["p"] is not None:
                self.assertEqual(one["differs"], one["p"] <= 0.01, name)
                self.assertEqual(one["differs"], one["distance"] > one["chance"], name)

    def test_positions_elevations_and_intensity_of_imported_points(self):
        """Two planes 7 cm apart, whose heights are known at any place; positions as few as all are compared."""
        random = np.random.default_rng(5)

        def plane(count):
            places = random.uniform(-20, 20, (count, 2))
            in_lines = places[np.lexsort((places[:, 0], np.floor(places[:, 1])))]
            return in_lines @ np.array([[1, 0, 0.2], [0, 1, -0.1]])

        a, b = plane(1500), plane(1200) + [0, 0, 0.07]
        columns = lambda points, gain: np.column_stack([points, np.arange(len(points)), gain * random.uniform(1, 9, len(points)).round()])
        rows = columns(a, 10), columns(b, 20)
        paths = [self.imported(name, points, "x,y,z,t,intensity") for name, points in zip("ab", rows)]
        found, by_name = self.compare(*paths)
        energy = 2 * cdist(a, b).mean() - cdist(a, a).mean() - cdist(b, b).mean()
        self.assertAlmostEqual(by_name["position"]["distance"], np.sqrt(energy), delta=1e-9)
        self.assertAlmostEqual(by_name["elevation"]["distance"], 0.07, delta=1e-9)
        self.assertLess(by_name["elevation_spread"]["distance"], 1e-9)
        relative = [points[:, 4] / np.median(points[:, 4]) for points in rows]
        self.assertAlmostEqual(by_name["intensity"]["distance"], ks(*relative), delta=1e-12)
        self.assertEqual([by_name["intensity"][side] for side in "ab"], [np.median(points[:, 4]) for points in rows])
        self.assertTrue(by_name["elevation"]["differs"])
        self.assertEqual(found["likeness"]["not_in_both"], [])

    def test_a_scan_is_like_itself_and_like_another_seed(self):
        _, by_name = self.compare(self.chain.scan, self.chain.scan)
        self.assertEqual({one["distance"] for one in by_name.values()}, {0})
        scans = [self.scan(f"seed{seed}", seed=seed, noise={"dead_pixel_frac": 0}) for seed in (7, 8)]
        found, by_name = self.compare(*scans)
        self.assertEqual((found["answer"]["conclusion"], self.differing(by_name)), ("alike", set()))

    def test_a_mount_error_and_a_field_of_view_are_seen(self):
        scans = [self.scan(name, seed=seed, noise={"dead_pixel_frac": 0}, **more)
                 for name, seed, more in (("a", 7, {}), ("b", 8, {}), ("mount", 8, MOUNT_ERROR), ("wide", 8, {"detector": {"ifov_rad": 0.0022}}))]
        near, far = (self.compare(scans[0], other)[1] for other in scans[1:3])
        self.assertLessEqual({"elevation", "shift", "tilt"}, self.differing(far))
        for name in ("elevation", "shift", "tilt", "position", "elevation_spread"):
            self.assertGreater(far[name]["distance"], near[name]["distance"], name)
        self.assertFalse(far["range_error"]["differs"] or far["spacing_across"]["differs"])
        found, by_name = self.compare(scans[0], scans[3])
        self.assertAlmostEqual(by_name["spacing_along"]["b"] / by_name["spacing_along"]["a"], 2, delta=0.1)
        self.assertTrue(by_name["spacing_along"]["differs"])
        text = self.succeed("landfall-info", "--compare", scans[0], scans[3]).stdout
        self.assertIn(found["answer"]["sentence"], text)
        for point in found["answer"]["points"]:
            self.assertIn(f"  {point['name']}: {point['text']}\n", text)

    def test_scans_that_do_not_meet_are_not_compared(self):
        points = np.column_stack([np.random.default_rng(1).uniform(0, 9, (200, 3)), np.arange(200)])
        here = self.imported("here", points)
        there = self.imported("there", points + [100, 0, 0, 0])
        few = self.imported("few", points[:50])
        mapped = self.imported("mapped", points, "x,y,z,t", "--crs", "EPSG:32632")
        for other, reason in ((there, "no ground in common"), (few, "fewer than 100 returns"), (mapped, "has a CRS")):
            found = json.loads(self.succeed("landfall-info", "--compare", here, other, "--json").stdout)
            self.assertIn(reason, found["not_compared"])
            self.assertNotIn("likeness", found)
            self.assertIn(f"returns are not compared: {found['not_compared']}", self.succeed("landfall-info", "--compare", here, other).stdout)
        self.assertIn("likeness", json.loads(self.succeed("landfall-info", "--compare", here, mapped, "--json", "--same-frame").stdout))
        found = json.loads(self.succeed("landfall-info", "--compare", here, here, "--json", "--no-statistics").stdout)
        self.assertEqual((found["answer"], "likeness" in found), (None, False))
        self.refuse(2, "landfall-info", "--compare", here, self.chain.dem, words=["two files of one kind"])

    def test_long_scans_are_compared_in_a_square(self):
        """A scan that is three times as long as wide."""
        rows = np.column_stack([np.arange(20000) / 1e5, np.random.default_rng(2).uniform([-5, -1.7], [5, 1.7], (20000, 2))])
        np.savetxt(self.path("aims.csv"), rows, delimiter=",", header="t_s,x_m,y_m", comments="")
        long = self.scan("long", laser={"pulse_rate_hz": 100000}, noise={"dropout_frac": 0},
                         scanner={"pattern": {"type": "table", "path": self.path("aims.csv")}})
        found, by_name = self.compare(long, long, "--report", self.path("page.html"))
        counts = found["likeness"]["returns"]
        self.assertEqual(counts["a"], counts["b"])
        self.assertTrue(2**18 < counts["a"] <= 2**20, counts)
        self.assertIn("are compared", found["answer"]["notes"][-1])
        self.assertEqual({one["distance"] for one in by_name.values()}, {0})
        self.assertIn("count B - A", read_bytes(self.path("page.html")).decode())


if __name__ == "__main__":
    unittest.main()
