#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""monte-carlo killed, interrupted, and on a full disk: what was done is kept, and the file has the bytes of an undisturbed run."""
import contextlib
import errno
import itertools
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

from harness import EVAL, LONGEST_S, REGRID, MonteCarloTest, read_bytes, tool

sys.dont_write_bytecode = True
# pylint: disable=wrong-import-position
import calls
import disks

SEED = int(os.environ.get("LANDFALL_TEST_SEED", "20261123"))
KILLS = 20
DRAWS = 60
PARTS = [0, 15, 25, 50, DRAWS]
# 30 s between states become some draws.
FAST = "300"


@unittest.skipUnless(shutil.which(os.environ.get("CC", "cc")), "no C compiler")
class DrawsFaultsTest(MonteCarloTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.library = calls.build_library(cls.chain.folder)
        started = subprocess.run([tool("monte-carlo"), "--version"], env={**os.environ, "LD_PRELOAD": cls.library}, capture_output=True,
                                 text=True, check=False)
        if "runtime does not come first" in started.stderr:
            raise unittest.SkipTest("sanitizers must be preloaded themselves")

    def setUp(self):
        super().setUp()
        self.random = random.Random(SEED)
        self.mc = self.config({"draws": DRAWS, "scan": {"noise": {"dropout_frac": 0.2}}, "regrid": {**REGRID, "resolution_m": 0.2}, "eval": EVAL,
                               "vary": {"scan.navigation_error.velocity_mps.0": {"type": "normal", "sigma": 0.1}}}, "mc.json")
        os.mkdir(self.path("out"))

    def out(self, name="draws.h5"):
        return self.path(os.path.join("out", name))

    def arguments(self, *options, output="draws.h5"):
        return [self.chain.scan, "--terrain", self.chain.terrain, "-c", self.mc, "-v", "-o", self.out(output), *options]

    def start(self, *options, output="draws.h5", **environment):
        """With a clock of durations that runs fast, unless the environment says otherwise, and a clock of the day that jumps by a day at each look."""
        environment = {**os.environ, "LD_PRELOAD": self.library, "FAULT_SPEED": FAST, "FAULT_CLOCK": "~43200", **environment}
        return subprocess.Popen([tool("monte-carlo"), *self.arguments(*options, output=output)], env=environment, stderr=subprocess.PIPE,
                                text=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))

    @staticmethod
    def finish(process):
        """The exit code and the messages."""
        message = process.communicate(timeout=LONGEST_S)[1]
        return process.returncode, message

    def undisturbed(self, *options, speed="1"):
        """The bytes of the file, and how long it took to make: with a fast clock a run writes a state after every draw."""
        begun = time.monotonic()
        code, message = self.finish(self.start(*options, output="whole.h5", FAULT_SPEED=speed))
        self.assertEqual(code, 0, message)
        seconds = time.monotonic() - begun
        whole = read_bytes(self.out("whole.h5"))
        os.remove(self.out("whole.h5"))
        return whole, seconds

    def entries_out(self):
        return sorted(os.listdir(self.path("out")))

    @staticmethod
    def draws_before(message):
        """How many draws of earlier runs a run began with."""
        found = re.search(r"resumes after (\d+) draws", message)
        return int(found[1]) if found else 0

    def finish_undisturbed(self, whole):
        """Runs to the end, and compares; returns how many draws there were before."""
        code, message = self.finish(self.start(FAULT_SPEED="1"))
        self.assertEqual(code, 0, message)
        self.assertEqual(read_bytes(self.out()), whole)
        self.assertEqual(self.entries_out(), ["draws.h5"])
        os.remove(self.out())
        return self.draws_before(message)


class Killed(DrawsFaultsTest):
    def finish_with_kills(self, seconds, *options, output):
        """Runs until the output is complete, killed at random times; returns (kills, runs that resumed another one)."""
        kills = resumed = 0
        while True:
            process = self.start(*options, output=output)
            time.sleep(self.random.uniform(0, seconds))
            process.kill()
            code, message = self.finish(process)
            resumed += self.draws_before(message) > 0
            if code == 0:
                return kills, resumed
            self.assertEqual(code, -signal.SIGKILL, message)
            kills += 1
            if os.path.exists(self.out(output)):  # killed after its output was complete
                with contextlib.suppress(FileNotFoundError):
                    os.remove(self.out(f".{output}.state"))
                return kills, resumed

    def test_killed_at_random(self):
        """The undivided campaign and four parts, on 1, 2 and 7 threads."""
        whole, seconds = self.undisturbed(speed=FAST)
        kills = resumed = 0
        for turn, threads in zip(range(KILLS), itertools.cycle((1, 2, 7))):
            if kills >= KILLS and turn >= 3 and resumed >= KILLS // 4:  # a busy machine may resume seldom
                break
            jobs = [("draws.h5", [])] + [(f"part{first}.h5", ["--draws", f"{first}:{end}"]) for first, end in itertools.pairwise(PARTS)]
            for output, options in jobs:
                more = self.finish_with_kills(0.7 * seconds, "-t", str(threads), *options, output=output)
                kills, resumed = kills + more[0], resumed + more[1]
            self.assertEqual(self.entries_out(), sorted(output for output, _ in jobs))
            parts = [self.out(output) for output, _ in jobs[1:]]
            self.random.shuffle(parts)
            self.succeed("monte-carlo", "merge", *parts, "-o", self.out("merged.h5"))
            for name in ("draws.h5", "merged.h5"):
                self.assertEqual(read_bytes(self.out(name)), whole, f"{name}, seed {SEED}")
            for name in self.entries_out():
                os.remove(self.out(name))
        self.assertGreaterEqual(kills, KILLS, f"seed {SEED}")
        self.assertGreaterEqual(resumed, KILLS // 4, f"seed {SEED}")


class Interrupted(DrawsFaultsTest):
    def interrupt(self, number, wait, **environment):
        """Sends a signal after a wait of its own; returns how many draws were kept, None if the run ended first."""
        process = self.start(**environment)
        try:
            wait(process)
            process.send_signal(number)
            code, message = self.finish(process)
        finally:
            process.kill()
        if code == 0:
            os.remove(self.out())
            return None
        self.assertEqual(code, -number, message)
        self.assertIn("monte-carlo: interrupted, no output was written\n", message)
        kept = re.search(rf"(\d+) of {DRAWS} draws are kept; run the same command again to continue", message)
        self.assertEqual(self.entries_out(), [".draws.h5.state"] if kept else [])
        return int(kept[1]) if kept else 0

    def wait_for_the_draws(self, process):
        while "read took" not in process.stderr.readline():
            self.assertIsNone(process.poll())

    def test_an_interrupted_run_keeps_its_draws(self):
        """Before the first 30 s are over."""
        whole, seconds = self.undisturbed()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU):
            def wait(process):
                self.wait_for_the_draws(process)
                time.sleep(self.random.uniform(0.1, 0.3) * seconds)
            tries = (self.interrupt(number, wait, FAULT_SPEED="1") for _ in range(50))  # on a busy machine some come too early or too late
            kept = next(filter(None, tries), 0)
            self.assertGreater(kept, 0, f"seed {SEED}")
            self.assertEqual(self.finish_undisturbed(whole), kept)

    def test_after_a_state_was_written(self):
        whole, _ = self.undisturbed()

        def wait(process):
            while not os.path.exists(self.out(".draws.h5.state")):
                self.assertIsNone(process.poll())
                time.sleep(0.001)
        kept = self.interrupt(signal.SIGTERM, wait)
        self.assertEqual(self.finish_undisturbed(whole), kept)

    def test_before_the_draws(self):
        def wait(process):
            while "writes" not in process.stderr.readline():
                self.assertIsNone(process.poll())
        self.assertEqual(self.interrupt(signal.SIGTERM, wait, FAULT_SPEED="1"), 0)


class FullDisk(DrawsFaultsTest):
    def check_failure(self, code, message):
        self.assertEqual(code, 1, message)
        self.assertRegex(message.splitlines()[-1], r"\Amonte-carlo: .*/out/[^ ]*: .*No space left on device")
        self.assertIn(self.entries_out(), ([], [".draws.h5.state"]))

    def test_full_from_one_call_on(self):
        """The disk is full when a state is written, or the output."""
        whole, _ = self.undisturbed()
        log = self.path("calls")
        fault = {"FAULT_UNDER": self.path("out"), "FAULT_CALLS": "write", "FAULT_ACTION": str(errno.ENOSPC), "FAULT_STICKY": "1"}
        self.finish(self.start(FAULT_LOG=log, **fault))
        os.remove(self.out())
        count = int(read_bytes(log).decode().split()[0])
        before = []
        for i in range(6):
            code, message = self.finish(self.start(FAULT_AT=str(1 + i * count // 8), **fault))
            if code == 0:  # fewer states were written, because their number depends on the load
                self.assertEqual(read_bytes(self.out()), whole)
                os.remove(self.out())
                continue
            self.check_failure(code, message)
            before.append(self.finish_undisturbed(whole))
        self.assertEqual(before[0], 0)
        self.assertGreater(max(before), 0, before)

    def test_a_small_disk(self):
        folder = self.path("out")
        if not disks.can_mount(folder):
            self.skipTest("no right to mount")
        whole, _ = self.undisturbed()
        with disks.small_disk(folder, 4096):
            process = self.start()
            while not os.path.exists(self.out(".draws.h5.state")):
                self.assertIsNone(process.poll())
                time.sleep(0.001)
            with open(self.out("ballast"), "wb", buffering=0) as ballast:
                try:
                    while True:
                        ballast.write(bytes(4096))
                except OSError as error:
                    self.assertEqual(error.errno, errno.ENOSPC)
            code, message = self.finish(process)
            os.remove(self.out("ballast"))
            self.check_failure(code, message)
            self.assertGreater(self.finish_undisturbed(whole), 0)


if __name__ == "__main__":
    unittest.main()
