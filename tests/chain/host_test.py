#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The installed landfall::lidar: examples/host_simulator links it and gets the same returns as scan-sim."""
import json
import os
import shutil
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

from harness import run, write_file

BUILD = os.environ["LANDFALL_BUILD"]
EXAMPLE = os.path.join(os.environ["LANDFALL_ROOT"], "examples", "host_simulator")
# The motion of the lander in examples/host_simulator.
TRAJECTORY = {"type": "constant_velocity", "position_m": [0.5, -0.3, 50], "velocity_mps": [0.4, 0.2, -5],
              "rpy_deg": [0, 0, 0], "rpy_rate_degps": [2, 0, 0]}
CONE = {"type": "cone", "x_m": 1, "y_m": 0.5, "radius_m": 1.5, "height_m": 2}


def check(*command):
    result = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=600, check=False)
    if result.returncode:
        raise AssertionError(f"{command}: exit {result.returncode}\n{result.stdout}{result.stderr}")
    return result.stdout


class Host(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="landfall-host-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.prefix = cls.path("prefix")
        check("cmake", "--install", BUILD, "--component", "lidar", "--prefix", cls.prefix)
        cls.build(EXAMPLE, "build", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror")

    @classmethod
    def build(cls, source, name, *options):
        check("cmake", "-S", source, "-B", cls.path(name), "-DCMAKE_PREFIX_PATH=" + cls.prefix,
              "-DCMAKE_CXX_COMPILER=" + os.environ["LANDFALL_CXX"], *options)
        check("cmake", "--build", cls.path(name))

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def host(self, cone_height_m):
        check(self.path("build/host_simulator"), os.path.join(EXAMPLE, "scan.json"), self.path("returns.csv"),
              cone_height_m)
        return np.genfromtxt(self.path("returns.csv"), delimiter=",", names=True)

    def scan_sim(self, features, resolution_m):
        grid = {"half_width_m": 8, "resolution_m": resolution_m}
        for arguments in [
                ["terrain-gen", "-o", self.path("terrain.h5"), "-O",
                 "--set", "grid=" + json.dumps(grid), "--set", "features=" + json.dumps(features)],
                ["scan-sim", "-c", os.path.join(EXAMPLE, "scan.json"), "--terrain", self.path("terrain.h5"), "-o",
                 self.path("scan.h5"), "-O", "--keep-misses", "--set", "trajectory=" + json.dumps(TRAJECTORY)]]:
            result = run(*arguments)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
        with h5py.File(self.path("scan.h5")) as file:
            return {name: column[()] for name, column in file["points"].items()}

    def test_its_returns_are_those_of_scan_sim(self):
        ours, theirs = self.host(0), self.scan_sim([], 0.5)
        for name in ["pulse", "pixel", "status"]:
            np.testing.assert_array_equal(ours[name], theirs[name])
        self.assertEqual(len(ours), 400 * 24)
        self.assertLessEqual({0, 2}, set(ours["status"]))
        for name in ["range_true", "range_measured", "x_true", "y_true", "z_true", "x_est", "y_est", "z_est"]:
            np.testing.assert_array_equal(np.isnan(ours[name]), np.isnan(theirs[name]))
            self.assertLess(np.nanmax(np.abs(ours[name] - theirs[name])), 1e-9, name)
        # The error models are active: measured and estimated values differ from true ones.
        self.assertGreater(np.nanmax(np.abs(ours["range_measured"] - ours["range_true"])), 0.02)
        self.assertGreater(np.nanmax(np.abs(ours["x_est"] - ours["x_true"])), 0.02)

    def test_the_host_provides_the_scene(self):
        """The host's exact cone against terrain-gen's triangulated one."""
        ours, theirs = self.host(CONE["height_m"]), self.scan_sim([CONE], 0.02)
        hit = (ours["status"] == 0) & (theirs["status"] == 0)
        self.assertGreater(hit.mean(), 0.7)
        self.assertGreater(np.sum(ours["z_true"][hit] > 0.5), 100)
        difference = np.abs(ours["range_true"] - theirs["range_true"])[hit]
        self.assertLess(np.quantile(difference, 0.95), 0.005)
        self.assertLess(difference.max(), 0.05)

    def test_a_host_may_draw_in_any_object_of_the_archive(self):
        """As hosts did that were compiled without optimisation: the linker takes the first copy of a function of the standard library."""
        os.mkdir(self.path("whole"))
        write_file(self.path("whole/whole.cpp"), "int main() {}\n")
        with open(self.path("whole/CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write("""
                cmake_minimum_required(VERSION 3.25)
                project(whole LANGUAGES C CXX)
                find_package(landfall REQUIRED)
                add_executable(whole whole.cpp)
                target_link_libraries(whole PRIVATE $<LINK_LIBRARY:WHOLE_ARCHIVE,landfall::lidar>)
                """)
        self.build(self.path("whole"), "whole/build")

    def test_it_links_no_library_of_the_tools(self):
        needed = check("ldd", self.path("build/host_simulator"))
        for library in ["hdf5", "gdal", "gmp", "mpfr", "tbb", "xxhash"]:
            self.assertNotIn(library, needed)
        headers = os.listdir(os.path.join(self.prefix, "include", "landfall"))
        self.assertEqual(headers, ["lidar.h"])

    def test_an_error_message_reaches_the_host(self):
        write_file(self.path("bad.json"), '{"detector": {"rows": 0}}')
        result = subprocess.run([self.path("build/host_simulator"), self.path("bad.json"), self.path("none.csv")],
                                capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertIn("bad.json: /detector/rows: 0", result.stderr)


if __name__ == "__main__":
    unittest.main()
