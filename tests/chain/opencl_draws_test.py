#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""monte-carlo --engine opencl writes the bytes that the CPU writes. Skipped without an OpenCL device; pocl-opencl-icd provides one,
the CPU."""
import json
import os
import unittest

from harness import EVAL, HAZARD, REGRID, SANITIZED, MonteCarloTest, read_bytes
from harness.opencl import build_faulty_opencl, no_device

# Every error that a device draws.
ERRORS = {
    "noise": {"range_sigma_m": 0.01, "range_sigma_per_m": 1e-4, "incidence_sigma_rad": 1e-4, "range_bias_m": 0.002,
              "dead_pixel_frac": 0.03, "dropout_frac": 0.05, "false_return_frac": 0.01, "false_range_m": [30, 60]},
    "pointing_error": {"time_stamp_bias_s": 1e-3, "time_stamp_sigma_s": 1e-3},
    "navigation_error": {"interval_s": 0.02, "position_m": [0.1, -0.2, 0.05], "rpy_rad": [1e-4, 2e-4, -1e-4],
                         "random_walk": {"position_m_per_sqrt_s": [0.01, 0.02, 0.03]},
                         "gauss_markov": {"velocity_sigma_mps": [0.05, 0.02, 0.03]}},
}
VARY = {
    "scan.noise.range_sigma_m": {"type": "list", "values": [0, 0.02, 0.01, 0.03, 0.001]},
    "scan.noise.incidence_sigma_rad": {"type": "list", "values": [0, 0, 1e-4, 2e-4, 0]},
    "scan.noise.dropout_frac": {"type": "uniform", "low": 0, "high": 0.2},
    "scan.noise.false_return_frac": {"type": "list", "values": [0.01, 0, 0.02, 0, 0]},
    "scan.navigation_error.velocity_mps.0": {"type": "normal", "sigma": 0.1},
    "scan.navigation_error.rpy_rate_radps.1": {"type": "normal", "sigma": 1e-3},
}
# Rules that decide each requirement both ways, some of them varied.
JUDGED = {**VARY, "eval.quantile": {"type": "list", "values": [0.95, 1, 0.5, 0.9, 0.99]},
          "eval.limits.relative_elevation_m": {"type": "list", "values": [0.01, 0.02, 0.05, 0.5, 0]}}
RULES = (EVAL, {**EVAL, "footprint_shape": "disc"}, {**EVAL, "footprint_m": 0.1}, {"region": {"shape": "square", "half_width_m": 3}},
         {**EVAL, "limits": {"relative_horizontal_m": 0.001, "absolute_horizontal_m": 0.15, "invalid_frac": 0.2}})
# Metrics do not change how a device bins, nor maps how it judges.
RUNS = [
    *({"scan": ERRORS, "vary": VARY, "metrics": metrics} for metrics in ("verdict", "full")),
    *({"draws": 2, "scan": ERRORS, "regrid": {**REGRID, **regrid}, "metrics": metrics} for regrid, metrics in (
        ({"method": "bilinear4"}, "verdict"), ({"method": "mean"}, "full"), ({"truth_at": "centroid"}, "full"),
        ({"method": "bilinear4", "truth_at": "centroid"}, "verdict"), ({"method": "mean"}, "verdict"))),
    *({"scan": ERRORS, "vary": JUDGED, "eval": rule, "metrics": "verdict", "layers": bool(number % 2)} for number, rule in enumerate(RULES)),
    {"draws": 2, "scan": {"noise": {"dropout_frac": 0.02}}, "hazard": HAZARD, "metrics": "verdict"},
]
NO_DEVICE = no_device()


def draws_config(**values):
    return {"draws": 5, "scan": {}, "regrid": REGRID, "eval": EVAL, "vary": {}, **values}


class DeviceDraws(MonteCarloTest):
    def arguments(self, engine, config, *options, scan=None):
        return [scan or self.chain.scan, "--terrain", self.chain.terrain, "-c", self.config(config, "mc.json"), "--engine", engine,
                "-o", self.path(engine + ".h5"), "--json", "-O", *options]

    def draws(self, engine, config, *options, scan=None, **where):
        return json.loads(self.succeed("monte-carlo", *self.arguments(engine, config, *options, scan=scan), **where).stdout)

    def compare(self, engine, config, *options, scan=None, **where):
        """Makes draws on the CPU and with this engine; the files must be equal, provenance included. Returns the summary."""
        expected = self.draws("cpu", config, *options, scan=scan)
        found = self.draws(engine, config, *options, scan=scan, **where)
        self.assertEqual(read_bytes(self.path(engine + ".h5")), read_bytes(self.path("cpu.h5")))
        self.assertNotIn("device", expected)
        return found


@unittest.skipIf(NO_DEVICE, NO_DEVICE)
class SameBytes(DeviceDraws):
    def test_each_run_has_the_bytes_of_the_cpu(self):
        for values in RUNS:
            with self.subTest(**values):
                config = draws_config(**values)
                found = self.compare("opencl", config)
                self.assertEqual(found["device_draw_count"], config["draws"])
                self.assertEqual([text for text in found.get("warnings", []) if "CPU" in text], [])

    def test_a_mesh_is_judged_by_the_cpu(self):
        mesh, scan = self.path("mesh.h5"), self.path("mesh_scan.h5")
        self.write("mesh.obj", "v -20 -20 0\nv 20 -20 1\nv 20 20 0\nv -20 20 1\nf 1 2 3\nf 1 3 4\n")
        self.succeed("terrain-gen", "--from", self.path("mesh.obj"), "-o", mesh)
        self.succeed("scan-sim", *self.chain.inputs("scan-sim")[2:], "--terrain", mesh, "--keep-misses", "-o", scan)
        arguments = ["monte-carlo", scan, "--terrain", mesh, "-c", self.config(draws_config(draws=2, metrics="verdict"), "mc.json")]
        for engine in ("cpu", "opencl"):
            self.succeed(*arguments, "--engine", engine, "-o", self.path(engine + ".h5"))
        self.assertEqual(read_bytes(self.path("opencl.h5")), read_bytes(self.path("cpu.h5")))

    def test_misses_and_threads(self):
        """A scan with misses, dropouts and dead pixels of its own, far beyond the map."""
        scan = self.path("source.h5")
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--set", "noise.dropout_frac=0.1", "--set", "noise.dead_pixel_frac=0.1",
                     "--set", "scanner.pattern.half_width_m=6", "--keep-misses", "-o", scan)
        for threads in (1, 5):
            self.compare("opencl", draws_config(draws=2, scan=ERRORS), "-t", threads, scan=scan)

    def test_parts(self):
        config = draws_config(scan=ERRORS, vary=VARY)
        self.draws("cpu", config)
        for part in ("0:2", "2:5"):
            self.draws("opencl", config, "--draws", part)
            os.rename(self.path("opencl.h5"), self.path(part[0] + ".h5"))
        self.succeed("monte-carlo", "merge", self.path("2.h5"), self.path("0.h5"), "-o", self.path("merged.h5"))
        self.assertEqual(read_bytes(self.path("merged.h5")), read_bytes(self.path("cpu.h5")))

    def test_opencl_or_cpu_uses_the_device(self):
        self.assertEqual(self.compare("opencl-or-cpu", draws_config(scan=ERRORS))["device_draw_count"], 5)


@unittest.skipIf(NO_DEVICE, NO_DEVICE)
class NotOnADevice(DeviceDraws):
    CASES = [({"regrid": {**REGRID, "method": "median"}}, "/regrid/method: a device bins by bilinear_nearest, bilinear4 or mean"),
             ({"scan": {"receiver": {"timer_step_s": 1e-9}}}, "/scan/receiver: a device draws no jitter, offsets, scale or steps of the timer")]

    def test_is_refused(self):
        for values, reason in self.CASES:
            self.refuse(2, "monte-carlo", *self.arguments("opencl", draws_config(**values)), output=self.path("opencl.h5"),
                        words=[f"mc.json: draw 0: {reason}; opencl-or-cpu uses the CPU instead (--engine)"])

    def test_a_varied_key_is_refused_before_the_first_draw(self):
        vary = {"scan.receiver.timer_step_s": {"type": "list", "values": [0, 0, 0, 1e-9, 0]}}
        self.refuse(2, "monte-carlo", *self.arguments("opencl", draws_config(vary=vary)), output=self.path("opencl.h5"),
                    words=["mc.json: draw 3: /scan/receiver: a device draws no jitter"])
        found = self.compare("opencl-or-cpu", draws_config(vary=vary))
        self.assertEqual(found["device_draw_count"], 4)

    def test_the_cpu_instead(self):
        for values, reason in self.CASES:
            found = self.compare("opencl-or-cpu", draws_config(**values))
            self.assertEqual(found["warnings"], [f"{reason}; the CPU made the draws instead"])
            self.assertEqual(found["device_draw_count"], 0)


class WithoutADevice(DeviceDraws):
    def test_no_driver(self):
        nowhere = {**os.environ, "OCL_ICD_VENDORS": "/nowhere"}
        reason = "OpenCL: there is no device, or no driver of it is installed; "
        found = self.compare("opencl-or-cpu", draws_config(), env=nowhere)
        self.assertEqual(found["warnings"], [reason + "the CPU made the draws instead"])
        self.assertNotIn("device", found)
        self.refuse(1, "monte-carlo", *self.arguments("opencl", draws_config()), env=nowhere, output=self.path("opencl.h5"),
                    words=[reason + "opencl-or-cpu uses the CPU instead (--engine)"])


@unittest.skipIf(NO_DEVICE or SANITIZED, NO_DEVICE or "a sanitizer must be preloaded first")
class AFaultyDevice(DeviceDraws):
    FAULTS = [("no_doubles", 0, "OpenCL: no device can be used: faulty device has no double precision"),
              ("rounds", 0, "OpenCL: no device can be used: faulty device rounds a multiplication and an addition otherwise than the CPU"),
              ("no_compiler", 0, "OpenCL: no device can be used: faulty device cannot compile the kernels (line 1: no such type)"),
              ("no_memory:6", 0, "the OpenCL device faulty device failed to load the scan (out of memory)"),
              ("no_memory:15", 0, "the OpenCL device faulty device failed to draw errors (out of memory)"),
              ("lost:2", 0, "the OpenCL device faulty device failed to draw errors (out of resources, or the device is lost)"),
              ("lost:7", 2, "the OpenCL device faulty device failed to draw errors (out of resources, or the device is lost)")]

    # With verdicts: three reads for each draw after one of the check, then twelve for the sums of the maps.
    VERDICT_FAULTS = [("no_memory:30", 0, "the OpenCL device faulty device failed to judge a draw (out of memory)"),
                      ("lost:10", 2, "the OpenCL device faulty device failed to judge a draw (out of resources, or the device is lost)"),
                      ("lost:20", 5, "the OpenCL device faulty device failed to give the sums of its draws "
                                     "(out of resources, or the device is lost)")]

    def setUp(self):
        super().setUp()
        build_faulty_opencl(self.path("faulty_opencl.so"))
        self.faulty = {**os.environ, "LD_PRELOAD": self.path("faulty_opencl.so")}

    def test_that_works_draws(self):
        self.assertEqual(self.compare("opencl", draws_config(), env=self.faulty)["device"], "faulty device")

    def test_leaves_the_draws_to_the_cpu_or_no_file(self):
        for config, faults in (draws_config(scan=ERRORS), self.FAULTS), (draws_config(scan=ERRORS, metrics="verdict"), self.VERDICT_FAULTS):
            self.draws("cpu", config)
            for fault, made, reason in faults:
                with self.subTest(fault):
                    found = self.draws("opencl-or-cpu", config, env={**self.faulty, "FAULTY_OPENCL": fault})
                    self.assertEqual(read_bytes(self.path("opencl-or-cpu.h5")), read_bytes(self.path("cpu.h5")))
                    self.assertEqual(found["warnings"], [f"{reason}; the CPU made the draws instead"])
                    self.assertEqual(found.get("device_draw_count", 0), made)

                    self.refuse(1, "monte-carlo", *self.arguments("opencl", config), output=self.path("opencl.h5"),
                                env={**self.faulty, "FAULTY_OPENCL": fault}, words=[f"{reason}; opencl-or-cpu uses the CPU instead (--engine)"])


if __name__ == "__main__":
    unittest.main()
