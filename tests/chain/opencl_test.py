#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""scan-sim --engine opencl writes the bytes that the engine heightfield writes. Skipped without an OpenCL device; pocl-opencl-icd
provides one, the CPU."""
import json
import os
import unittest

from harness import SANITIZED, SCAN, TERRAIN, ToolTest, read_bytes, with_values
from harness.opencl import build_faulty_opencl, no_device

GRID = {"half_width_m": 6, "resolution_m": 0.1}
CONES = {"grid": GRID, "features": [
    {"type": "cone", "x_m": 2 * x, "y_m": 2 * y, "radius_m": 0.6, "height_m": 2} for x in (-1, 0, 1) for y in (-1, 0.3, 1)]}
RELIEF = {"grid": GRID, "base": {"type": "fractal", "hurst_exponent": 0.6, "rms_deviation_m": 0.5, "reference_length_m": 8}, "seed": 3}
RECEIVER = with_values(SCAN, detector__subpixels=3, beam={}, surface={"albedo": 0.6},
                       link={"reference_pe": 100, "reference_range_m": 50},
                       receiver={"type": "leading_edge", "threshold_pe": 5})
NO_DEVICE = no_device()


class OpenClTest(ToolTest):
    def terrain(self, config):
        self.succeed("terrain-gen", "-c", self.config(config), "-O", "-o", self.path("terrain.h5"))
        return self.path("terrain.h5")

    def scan(self, engine, scan, terrain, *options, **where):
        result = self.succeed("scan-sim", "-c", self.config(scan), "--terrain", terrain, "--engine", engine, "--json", "-O", "-o",
                              self.path(engine + ".h5"), *options, **where)
        return json.loads(result.stdout)


@unittest.skipIf(NO_DEVICE, NO_DEVICE)
class SameBytes(OpenClTest):
    def compare(self, scan, terrain, *options):
        """Scans with both engines; returns the counts of opencl."""
        expected = self.scan("heightfield", scan, terrain, *options)
        found = self.scan("opencl", scan, terrain, *options)
        self.assertEqual(read_bytes(self.path("opencl.h5")), read_bytes(self.path("heightfield.h5")))
        self.assertEqual((expected["engine"], found["engine"]), ("heightfield", "opencl"))
        self.assertNotIn("device", expected)
        self.assertEqual(found["device_ray_count"], found["ray_count"])
        self.assertLess(found["undecided_ray_count"], 0.05 * found["ray_count"])
        return found

    def test_cones_relief_and_features(self):
        for terrain in (CONES, RELIEF, TERRAIN):
            self.compare(SCAN, self.terrain(terrain))

    def test_from_the_side(self):
        side = with_values(SCAN, trajectory__position_m=[-70, 3, 60], trajectory__rpy_deg=[0, -48, 0], trajectory__velocity_mps=[0, 0, 0],
                           scanner={"type": "flash"}, detector__ifov_rad=0.02)
        self.compare(side, self.terrain(RELIEF), "--keep-misses")

    def test_subpixels_and_receivers(self):
        terrain = self.terrain(RELIEF)
        self.compare(with_values(SCAN, detector__subpixels=4), terrain)
        for options in ([], ["--keep-echoes", "--keep-misses"]):
            self.compare(RECEIVER, terrain, *options)
        self.compare(with_values(RECEIVER, receiver__returns="all", receiver__type="constant_fraction"), terrain)

    def test_any_threads_and_batches(self):
        terrain = self.terrain(CONES)
        for options in (["-t", "1"], ["-t", "7", "--batch-points", "100"], ["-t", "2", "--batch-points", "200000"]):
            self.compare(with_values(SCAN, detector__subpixels=2), terrain, *options)

    def test_holes(self):
        """A raster of which a tenth is nodata."""
        rows = [" ".join("-9" if (31 * row + 17 * col) % 10 == 0 else f"{0.1 * ((row * col) % 7):g}" for col in range(60))
                for row in range(60)]
        with open(self.path("dem.asc"), "w", encoding="utf-8") as file:
            file.write("ncols 60\nnrows 60\nxllcorner 0\nyllcorner 0\ncellsize 0.25\nNODATA_value -9\n" + "\n".join(rows) + "\n")
        terrain = self.path("terrain.h5")
        self.succeed("terrain-gen", "--from", self.path("dem.asc"), "--horizontal-scale", "1", "-O", "-o", terrain, "--set",
                     "grid.half_width_m=6", "--set", "grid.resolution_m=0.2", "--datum", "none")
        found = self.compare(SCAN, terrain, "--keep-misses")
        self.assertGreater(found["miss_count"], 100)

    def test_opencl_or_cpu_uses_the_device(self):
        terrain = self.terrain(CONES)
        self.assertEqual(self.scan("opencl-or-cpu", SCAN, terrain)["engine"], "opencl")
        self.scan("heightfield", SCAN, terrain)
        self.assertEqual(read_bytes(self.path("opencl-or-cpu.h5")), read_bytes(self.path("heightfield.h5")))

    def test_auto_never_does(self):
        found = self.scan("auto", SCAN, self.terrain(CONES))
        self.assertEqual(found["engine"], "heightfield")
        self.assertNotIn("device", found)


class CpuInstead(OpenClTest):
    """The fall-back of opencl-or-cpu; tests/cli/catalogue.json has the messages of --engine opencl."""

    def expect_the_cpu(self, reason, **environment):
        terrain = self.terrain(CONES)
        self.scan("heightfield", SCAN, terrain)
        found = self.scan("opencl-or-cpu", SCAN, terrain, "--batch-points", 3200, env={**os.environ, **environment})
        self.assertEqual(found["warnings"], [f"{reason}; the CPU traced the rays instead"])
        self.assertEqual(read_bytes(self.path("opencl-or-cpu.h5")), read_bytes(self.path("heightfield.h5")))
        return found


class WithoutADevice(CpuInstead):
    def test_no_driver(self):
        found = self.expect_the_cpu("OpenCL: there is no device, or no driver of it is installed", OCL_ICD_VENDORS="/nowhere")
        self.assertEqual(found["engine"], "heightfield")
        self.assertNotIn("device", found)

    def test_no_library(self):
        os.mkdir(self.path("lib"))
        with open(self.path("lib/libOpenCL.so.1"), "w", encoding="utf-8") as file:
            file.write("no library")
        found = self.expect_the_cpu(f"cannot load the OpenCL plugin: {self.path('lib/libOpenCL.so.1')}: file too short; install "
                                    "ocl-icd-libopencl1 and the OpenCL driver of the device", LD_LIBRARY_PATH=self.path("lib"))
        self.assertEqual(found["engine"], "heightfield")

    def test_a_mesh(self):
        terrain = self.terrain({"mesh": {"path": os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "meshes", "boulder.obj")}})
        self.refuse(2, "scan-sim", "-c", self.config(SCAN), "--terrain", terrain, "--engine", "opencl", "-o", self.path("o.h5"),
                    words=["is a mesh, which the engine opencl cannot trace; use cgal or auto (--engine)"], output=self.path("o.h5"))


@unittest.skipIf(NO_DEVICE or SANITIZED, NO_DEVICE or "a sanitizer must be preloaded first")
class AFaultyDevice(CpuInstead):
    def setUp(self):
        super().setUp()
        build_faulty_opencl(self.path("faulty_opencl.so"))
        self.faulty = {"LD_PRELOAD": self.path("faulty_opencl.so")}

    def test_that_works_traces(self):
        found = self.scan("opencl", SCAN, self.terrain(CONES), env={**os.environ, **self.faulty})
        self.assertEqual((found["engine"], found["device"]), ("opencl", "faulty device"))

    def test_that_cannot_be_used(self):
        for fault, reason in [("no_doubles", "OpenCL: no device can be used: faulty device has no double precision"),
                              ("rounds", "OpenCL: no device can be used: faulty device rounds a multiplication and an addition otherwise than the CPU"),
                              ("no_compiler", "OpenCL: no device can be used: faulty device cannot compile the kernels (line 1: no such type)"),
                              ("no_memory:4", "the OpenCL device faulty device failed to load the terrain (out of memory)")]:
            self.assertEqual(self.expect_the_cpu(reason, FAULTY_OPENCL=fault, **self.faulty)["engine"], "heightfield")

    def test_that_is_lost_in_the_middle(self):
        for at in (2, 4):  # the first read checks the arithmetic
            found = self.expect_the_cpu("the OpenCL device faulty device failed to trace rays (out of resources, or the device is lost)",
                                        FAULTY_OPENCL=f"lost:{at}", **self.faulty)
            self.assertEqual((found["engine"], found["device"]), ("opencl", "faulty device"))
            self.assertLess(found["device_ray_count"], found["ray_count"])
        self.assertGreater(found["device_ray_count"], 0)

    def test_that_is_lost_leaves_no_file(self):
        terrain = self.terrain(CONES)
        for threads in ("1", "7"):
            self.refuse(1, "scan-sim", "-c", self.config(SCAN), "--terrain", terrain, "--engine", "opencl", "-o", self.path("o.h5"), "-t", threads,
                        env={**os.environ, **self.faulty, "FAULTY_OPENCL": "lost:3"}, output=self.path("o.h5"), words=[
                            "the OpenCL device faulty device failed to trace rays (out of resources, or the device is lost); opencl-or-cpu "
                            "uses the CPU instead (--engine)"])


if __name__ == "__main__":
    unittest.main()
