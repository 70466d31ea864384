#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`landfall run` is killed just before each output gets its name: the next run continues, without -O."""
import contextlib
import os
import shutil
import signal
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
# pylint: disable=wrong-import-position
import calls
from harness import EVAL, HAZARD, SCAN, TERRAIN, ToolTest, read_bytes, run, write_file

CHAIN = {"area": {"half_width_m": 5, "resolution_m": 0.1, "region_radius_m": 4},
         "terrain": {key: value for key, value in TERRAIN.items() if key != "grid"}, "scan": SCAN, "eval": {"footprint_m": EVAL["footprint_m"]},
         "hazard": {"lander": HAZARD["lander"], "limits": HAZARD["limits"]}}
SEED = ["--set", "scan.seed=8"]


@unittest.skipUnless(shutil.which(os.environ.get("CC", "cc")), "no C compiler")
@unittest.skipIf(os.environ.get("LANDFALL_SANITIZE"), "sanitizers must be preloaded themselves")
class Chain(ToolTest):
    def setUp(self):
        super().setUp()
        self.library = calls.build_library(self.folder)
        self.config(CHAIN, "chain.json")

    def chain(self, *more, **options):
        return run("landfall", "run", "-c", "chain.json", "-o", "out", *more, cwd=self.folder, **options)

    def disturbed(self, at, action, *more):
        return self.chain(*more, env={**os.environ, "LD_PRELOAD": self.library, "FAULT_UNDER": "out/", "FAULT_CALLS": "name", "FAULT_AT": str(at),
                                      "FAULT_ACTION": str(action), "FAULT_LOG": self.path("calls")})

    def files(self):
        return {name: read_bytes(self.path("out/" + name)) for name in os.listdir(self.path("out"))}

    def check(self, restore, *more):
        """Kills the run before each of its names; restore() makes the folder that it begins with."""
        restore()
        undisturbed = self.disturbed(0, 0, *more)
        self.assertEqual(undisturbed.returncode, 0)
        whole, count = self.files(), int(read_bytes(self.path("calls")).split()[0])
        self.assertGreater(count, len(whole))
        for at in range(1, count + 1):
            restore()
            killed = self.disturbed(at, -signal.SIGKILL, *more)
            self.assertEqual(killed.returncode, -signal.SIGKILL)
            self.assertEqual(killed.stderr.splitlines()[-1], "landfall run: killed, as when memory runs out; the same command continues")
            result = self.chain(*more)
            self.assertEqual((result.returncode, result.stdout), (0, undisturbed.stdout), f"killed before name {at} of {count}: {result.stderr}")
            self.assertEqual(self.files(), whole, f"killed before name {at} of {count}")

    def test_the_next_run_continues(self):
        self.check(lambda: shutil.rmtree(self.path("out"), ignore_errors=True))

    def test_an_interrupt_while_outputs_get_names_ends_the_run_before_its_next_stage(self):
        whole = self.disturbed(0, 0).stdout
        count, last = int(read_bytes(self.path("calls")).split()[0]), 0
        for at in range(1, count + 1):
            shutil.rmtree(self.path("out"))
            code = self.disturbed(at, -signal.SIGINT).returncode
            self.assertIn(code, (-signal.SIGINT, 0), f"interrupted before name {at} of {count}")
            last += code == 0
            self.assertEqual([name for name in os.listdir(self.path("out")) if name.startswith(".") and name.endswith(".part")], [])
            self.assertEqual(self.chain().stdout, whole, f"interrupted before name {at} of {count}")
        self.assertLess(last, count // 2)  # the names of the last stage

    def test_the_next_run_of_an_edited_chain_continues(self):
        self.assertEqual(self.chain().returncode, 0)
        os.rename(self.path("out"), self.path("first"))
        def restore():
            shutil.rmtree(self.path("out"), ignore_errors=True)
            shutil.copytree(self.path("first"), self.path("out"))
        self.check(restore, *SEED)

    def test_a_file_of_another_origin_is_still_kept(self):
        """One that took the name of an output after the kill."""
        self.assertEqual(self.disturbed(0, 0).returncode, 0)
        for at in range(1, int(read_bytes(self.path("calls")).split()[0]) + 1):
            shutil.rmtree(self.path("out"))
            self.disturbed(at, -signal.SIGKILL)
            for name in ("metrics.json", "report.html", "sites.json"):
                self.write("out/" + name, "mine\n")
            result = self.chain()
            self.assertEqual((result.returncode, "landfall run did not make it; use -O" in result.stderr), (2, True), result.stderr)
            self.assertEqual(read_bytes(self.path("out/metrics.json")), b"mine\n")


class Memory(ToolTest):
    GROUPS = (("/sys/fs/cgroup/memory", "memory.limit_in_bytes"), ("/sys/fs/cgroup", "memory.max"))  # versions 1 and 2

    def group(self, size):
        """The folder of a control group with so many bytes of memory; skips the test where none can be made."""
        for root, limit in self.GROUPS:
            folder = os.path.join(root, f"landfall-test-{os.getpid()}")
            with contextlib.suppress(OSError, subprocess.SubprocessError):
                os.mkdir(folder)
                self.addCleanup(os.rmdir, folder)
                with open(os.path.join(folder, limit), "r+", encoding="ascii") as file:
                    file.write(str(size))
                subprocess.run(["true"], check=True, preexec_fn=lambda folder=folder: self.enter(folder))
                return folder
        raise unittest.SkipTest("no control group of memory can be made")

    @staticmethod
    def enter(group):
        write_file(os.path.join(group, "cgroup.procs"), "0")

    @unittest.skipIf(os.environ.get("LANDFALL_SANITIZE"), "sanitizers need more memory")
    def test_a_run_that_a_control_group_kills_is_named(self):
        group = self.group(40 << 20)
        result = run("landfall", "run", "-c", "preset:paper", "-o", self.path("out"), "--set", "regrid.resolution_m=0.1",
                     preexec_fn=lambda: self.enter(group))
        self.assertEqual(result.returncode, -signal.SIGKILL, result.stderr)
        self.assertEqual(result.stderr.splitlines()[-1], "landfall run: killed, as when memory runs out; the same command continues")


if __name__ == "__main__":
    unittest.main()
