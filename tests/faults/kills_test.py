#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that are killed, interrupted or out of room leave no output, and an old one untouched (SPEC section 1)."""
import os
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

import h5py

from harness import TOOLS, ChainTest, read_bytes, run, tool

SEED = int(os.environ.get("LANDFALL_TEST_SEED", "20240607"))
# Larger runs of each tool, 0.2 .. 1 s, so that there is a middle to be killed in.
LARGER = {"terrain-gen": ["--set", "grid.half_width_m=120"],
          "scan-sim": ["--set", "laser.pulse_rate_hz=40000"],
          "regrid": ["--set", "half_width_m=60"],
          "dem-eval": ["--set", "footprint_m=3"]}
OLD = b"the old output"


def mount_tmpfs(folder, size):
    """False where this user may not mount."""
    return shutil.which("mount") and subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder], capture_output=True,
        check=False).returncode == 0


class Faults(ChainTest):
    def setUp(self):
        super().setUp()
        self.output = self.path("out.h5")
        self.random = random.Random(SEED)

    def arguments(self, name, *more):
        return [*self.chain.inputs(name), *LARGER[name], "-o", self.output, *more]

    def put_old_output(self):
        with open(self.output, "wb") as file:
            file.write(OLD)

    def start(self, name, *more):
        return subprocess.Popen([tool(name), *self.arguments(name, *more)], stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True)

    def duration(self, name):
        start = time.perf_counter()
        self.succeed(name, *self.arguments(name, "-O"))
        os.remove(self.output)
        return time.perf_counter() - start

    def signalled_runs(self, name, number, count, *more):
        """Runs the tool `count` times, each signalled at a random moment; yields those that it ended."""
        whole, ended = self.duration(name), 0
        if "-O" in more:
            self.put_old_output()
        for _ in range(5 * count):
            if ended == count:
                return
            process = self.start(name, *more)
            time.sleep(self.random.uniform(0.005, 0.95 * whole))
            process.send_signal(number)
            stdout, stderr = process.communicate(timeout=60)
            if process.returncode == -number:
                ended += 1
                yield stdout, stderr
                continue
            whole = max(0.02, 0.7 * whole)  # it was over before: the first, measured run was a slow one
            if "-O" in more:
                self.put_old_output()
            elif os.path.exists(self.output):
                os.remove(self.output)
        if ended < count:
            self.fail(f"{name}: only {ended} of {5 * count} runs were ended (seed {SEED})")

    def check_none_or_whole(self, name):
        """Nothing stops a kill that comes when the output has just got its name: it is whole then."""
        if not os.path.exists(self.output):
            return
        with h5py.File(self.output) as file:
            self.assertEqual(file.attrs["complete"], 1, f"{name}, seed {SEED}")
        os.remove(self.output)

    def test_killed_leaves_no_output(self):
        for name in TOOLS:
            for _ in self.signalled_runs(name, signal.SIGKILL, 5):
                self.check_none_or_whole(name)

    def test_killed_leaves_the_old_output_untouched(self):
        for name in TOOLS:
            for _ in self.signalled_runs(name, signal.SIGKILL, 5, "-O"):
                if read_bytes(self.output) != OLD:
                    self.check_none_or_whole(name)
                    self.put_old_output()
            os.remove(self.output)

    def test_the_next_run_sweeps_up_after_a_killed_one(self):
        for name in TOOLS:
            for _ in self.signalled_runs(name, signal.SIGKILL, 2):
                pass
            self.succeed(name, *self.arguments(name, "-O"))
            self.assertEqual(self.entries(), ["out.h5"])
            os.remove(self.output)

    def test_interrupted_leaves_nothing_and_ends_by_the_signal(self):
        for name in TOOLS:
            for number in (signal.SIGTERM, signal.SIGINT):
                for stdout, stderr in self.signalled_runs(name, number, 2):
                    self.assertEqual(self.entries(), [], f"{name}, seed {SEED}")
                    self.assertEqual(stdout, "")
                    self.assertIn(stderr, ("", f"{name}: interrupted, no output was written\n"))

    def test_interrupted_leaves_the_old_output_untouched(self):
        for name in TOOLS:
            for _ in self.signalled_runs(name, signal.SIGTERM, 2, "-O"):
                self.assertEqual(self.entries(), ["out.h5"])
                self.assertEqual(read_bytes(self.output), OLD)
            os.remove(self.output)

    def check_out_of_room(self, name, result, reason, kept):
        self.assertEqual(result.returncode, 1, f"{name}: {result.stderr}")
        self.assertEqual(result.stdout, "")
        self.check_message(name, result.stderr, [reason, self.output])
        self.assertEqual(self.entries(), kept)

    def test_a_limit_on_the_file_size(self):
        for name in TOOLS:
            size = os.path.getsize(self.chain.output(name))
            for limit in (100, 5000, size // 2, size - 100):
                for old in (False, True):
                    if old:
                        self.put_old_output()
                    result = run(name, *self.chain.inputs(name), "-o", self.output, *(["-O"] if old else []),
                                 preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE,
                                                                                   (limit, limit)))
                    self.check_out_of_room(name, result, "File too large", ["out.h5"] if old else [])
                    if old:
                        self.assertEqual(read_bytes(self.output), OLD)
                        os.remove(self.output)

    def test_a_full_disk(self):
        mount = self.path("small")
        os.mkdir(mount)
        if not mount_tmpfs(mount, "24k"):
            self.skipTest("mounting a small tmpfs is not permitted here")
        self.addCleanup(subprocess.run, ["umount", mount], check=True)
        self.output = os.path.join(mount, "out.h5")
        for name in TOOLS:
            self.put_old_output()
            result = run(name, *self.chain.inputs(name), "-o", self.output, "-O")
            self.assertEqual(result.returncode, 1, f"{name}: {result.stderr}")
            self.check_message(name, result.stderr, ["No space left on device", self.output])
            self.assertEqual(os.listdir(mount), ["out.h5"])
            self.assertEqual(read_bytes(self.output), OLD)

    def test_metrics_that_cannot_be_written_take_the_layers_with_them(self):
        mount = self.path("small")
        os.mkdir(mount)
        if not mount_tmpfs(mount, "4k"):
            self.skipTest("mounting a small tmpfs is not permitted here")
        self.addCleanup(subprocess.run, ["umount", mount], check=True)
        with open(os.path.join(mount, "ballast"), "wb") as file:
            file.write(bytes(4096))
        metrics = os.path.join(mount, "metrics.json")
        result = run("dem-eval", *self.chain.inputs("dem-eval"), "-o", self.output, "--metrics", metrics)
        self.assertEqual(result.returncode, 1)
        self.check_message("dem-eval", result.stderr, [metrics])
        self.assertEqual((self.entries(), os.listdir(mount)), (["small"], ["ballast"]))


if __name__ == "__main__":
    unittest.main()
