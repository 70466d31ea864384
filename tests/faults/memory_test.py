#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall in memory with arguments that nobody should pass, many times, and interrupted. LANDFALL_FUZZ_CALLS: number of calls (400)."""
import os
import random
import resource
import signal
import subprocess
import sys
import unittest

import numpy as np

from harness import REGRID, SCAN, TERRAIN
import landfall

CALLS = int(os.environ.get("LANDFALL_FUZZ_CALLS", "400"))
# Errors of the package, and those by which Python refuses a wrong call.
REFUSALS = (landfall.Error, TypeError, ValueError, OverflowError, KeyError, MemoryError)
INTERRUPTED = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell makes background processes ignore it
sys.path.insert(0, os.path.join(os.environ["LANDFALL_ROOT"], "python"))
import landfall
terrain = landfall.Terrain("preset:paper")
def progress(phase, fraction):
    if phase == "trace" and fraction > 0:
        print("traces", flush=True)
try:
    landfall.scan(["preset:paper", {"laser": {"scan_time_s": 200}, "trajectory": {"velocity_mps": [0, 0, 0]}}], terrain, progress=progress)
except KeyboardInterrupt:
    print("interrupted", flush=True)
print(len(landfall.scan(["preset:paper", {"laser": {"scan_time_s": 0.01}}], terrain)))
"""


class Values:
    """Values that a call may get, from a seed."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.terrain = landfall.Terrain(TERRAIN)
        self.scan = landfall.scan(SCAN, self.terrain)
        self.dem = landfall.grid(self.scan, self.terrain, REGRID)
        self.some = [
            None, 0, -1, 2**63, 1.5, float("nan"), float("inf"), "", "x", "preset:paper", "nowhere.h5", b"\xff", [], {}, (), object(), [[]], True,
            np.zeros(0), np.zeros((0, 3)), np.zeros((2, 2)), np.full(5, np.nan), np.zeros(3, complex), np.zeros(3, "S3"), np.zeros(3, object),
            np.zeros((4, 4))[::2, ::2], np.broadcast_to(0.0, 2**31), np.broadcast_to(np.float32(1), (2**16, 2**16)), np.ones((3, 3), bool),
            np.arange(12, dtype=np.int8).reshape(4, 3), np.frombuffer(bytes(24)), np.eye(3), [0, 0, 50], [1, 0, 0, 0], {"grid": 3}, {"a": [{}]},
            ["preset:paper", {"noise": 1}], TERRAIN, SCAN, REGRID, self.terrain, self.scan, self.dem, lambda o, d: None, lambda o, d: [1, 2],
            lambda o, d: np.zeros(len(o)), lambda o, d: 1 / 0, "\x00", "ä" * 300]

    def one(self):
        return self.random.choice(self.some)

    def call(self):
        """One call with arguments of any kind."""
        lidar = landfall.Lidar(SCAN, self.terrain)
        function = self.random.choice([
            landfall.Terrain, landfall.Terrain.from_array, landfall.Lidar, landfall.scan, landfall.grid, landfall.evaluate, landfall.hazards,
            landfall.chain, self.terrain.elevation, self.terrain.first_hit, lidar.pulse, lidar.pulses, self.dem.values, self.scan.__getitem__,
            self.dem.to_file])
        words = {name: self.one() for name in self.random.sample(["threads", "progress", "config", "resolution_m", "t_s", "uncertainty", "layers"],
                                                                 self.random.choice([0, 0, 1]))}
        return function(*(self.one() for _ in range(self.random.randint(0, 4))), **words)


class InMemory(unittest.TestCase):
    def test_calls_with_any_arguments_end_in_refusals(self):
        seed = int(os.environ.get("LANDFALL_FUZZ_SEED", "1"))
        print("seed", seed)
        values, refused = Values(seed), 0
        for _ in range(CALLS):
            try:
                values.call()
            except REFUSALS:
                refused += 1
            except ZeroDivisionError:  # of the callable
                pass
        self.assertGreater(refused, CALLS // 3)
        self.assertEqual(len(landfall.scan(SCAN, values.terrain)), len(values.scan))

    def test_results_are_freed_with_their_objects(self):
        def chain():
            terrain = landfall.Terrain(TERRAIN)
            z_est = landfall.grid(landfall.scan(SCAN, terrain), terrain, REGRID)["z_est"]
            return float(z_est.max())

        for _ in range(20):
            chain()
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        for _ in range(max(CALLS // 4, 20)):
            chain()
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 30000)

    def test_an_interrupt_ends_a_run_and_not_the_library(self):
        with subprocess.Popen([sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "traces\n")
            process.send_signal(signal.SIGINT)
            lines = [line for line in process.stdout.read().splitlines() if line != "traces"]
        self.assertEqual(process.returncode, 0)
        self.assertEqual(lines, ["interrupted", "64800"])


if __name__ == "__main__":
    unittest.main()
