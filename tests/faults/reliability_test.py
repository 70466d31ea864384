#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The trials of try_faults.py with few runs, so that they keep working, and tests of the judge itself."""
import errno
import os
import random
import shutil
import signal
import sys
import unittest

sys.dont_write_bytecode = True
# pylint: disable=wrong-import-position
import calls
import disks
import folders
import limits
import page
import resources
import signals
import surroundings
from workshop import OLD, TASKS, Judge, Run, Workshop, task

SEED = int(os.environ.get("LANDFALL_TEST_SEED", "20261122"))
BY_LABEL = {each.label: each for each in TASKS}
# Outputs written by HDF5, outputs written by GDAL, several outputs, and plain text.
FEW = [BY_LABEL[label] for label in ("terrain-gen .ply", "scan-sim", "landfall-export .tif", "dem-eval --metrics --report", "landfall-export .csv")]
TOOLS = [BY_LABEL[label] for label in ("terrain-gen .h5", "scan-sim", "regrid", "dem-eval --metrics --report")]
# Runs that take several times as long as the start of a process, so that signals arrive during the work.
LARGER = [
    task("terrain-gen .h5, larger", "terrain-gen -c {in}/terrain.json --set grid.half_width_m=40 -o {out}/a.h5", "a.h5"),
    task("terrain-gen .tif, larger", "terrain-gen -c {in}/terrain.json --set grid.half_width_m=20 -o {out}/a.tif", "a.tif"),
    task("scan-sim, larger", "scan-sim -c {in}/scan.json --set laser.pulse_rate_hz=10000 --terrain {in}/terrain.h5 -o {out}/a.h5", "a.h5"),
    task("regrid, larger", "regrid {in}/scan.h5 -c {in}/regrid.json --set half_width_m=25 -o {out}/a.h5", "a.h5"),
    task("dem-eval, larger", "dem-eval {in}/dem.h5 -c {in}/eval.json --set footprint_m=2 -o {out}/a.h5", "a.h5"),
]
SEVERAL_OUTPUTS = [BY_LABEL[label] for label in ("dem-eval --metrics --report", "landfall-export .xmf")]


def setUpModule():  # pylint: disable=invalid-name
    Reliability.workshop = Workshop(os.environ["LANDFALL_BIN"], tasks={*FEW, *TOOLS, *LARGER, *SEVERAL_OUTPUTS})
    unittest.addModuleCleanup(Reliability.workshop.remove)


class Reliability(unittest.TestCase):
    workshop = None

    @classmethod
    def setUpClass(cls):
        cls.random = random.Random(SEED)

    def check(self, judges):
        for judge in judges:
            self.assertEqual(judge.broken, [], f"seed {SEED}")
            self.assertGreater(judge.counts["runs"], 0, judge.fault)


class JudgeTest(Reliability):
    """The judge must detect violations, because otherwise the tables would mean nothing."""

    def faults(self, code, files, stderr="", old=False, ended_by=0):
        judge = Judge(self.workshop, "a test")
        return judge.faults_of(BY_LABEL["scan-sim"], Run(code, b"", stderr, files), old, ended_by, False)

    def test_it_accepts_what_is_guaranteed(self):
        whole = self.workshop.whole[BY_LABEL["scan-sim"]]
        message = "scan-sim: out of luck\n"
        self.assertEqual(self.faults(0, whole), [])
        self.assertEqual(self.faults(1, {}, message), [])
        self.assertEqual(self.faults(1, {"scan.h5": OLD}, message, old=True), [])
        self.assertEqual(self.faults(-9, {}, ended_by=9), [])

    def test_it_finds_violations(self):
        whole = self.workshop.whole[BY_LABEL["scan-sim"]]
        message = "scan-sim: out of luck\n"
        for code, files, stderr, old in [
                (1, {"scan.h5": whole["scan.h5"][:-1]}, message, False), (0, {}, "", False), (1, {}, message, True), (1, {}, "", False),
                (1, {}, message + message, False), (1, whole, message, False), (0, whole, message, False), (134, {}, message, False),
                (-6, {}, "", False), (1, {".scan.h5.0123abcd-7.part": b""}, message, False), (1, {}, "scan-sim: internal error\n", False)]:
            self.assertNotEqual(self.faults(code, files, stderr, old), [], (code, sorted(files), stderr, old))

    def test_a_table_replaces_the_one_below_its_heading(self):
        text = "## A\n\nwords\n\n| a |\n|---|\n| 1 |\n\nend\n## B\n\n| b |\n"
        self.assertEqual(page.with_table(text, "## A", ["| new |"]), "## A\n\nwords\n\n| new |\n\nend\n## B\n\n| b |\n")
        self.assertEqual(page.with_rows("## A\n| a | 1 |\n| b | 2 |\n", "## A", ["| b | 3 |", "| c | 4 |"]), "## A\n| a | 1 |\n| b | 3 |\n| c | 4 |\n")


@unittest.skipUnless(shutil.which(os.environ.get("CC", "cc")), "no C compiler")
class Calls(Reliability):
    """Trials with a preloaded library, and others that sanitizers do not support."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.library = calls.build_library(cls.workshop.folder)
        run = cls.workshop.run(FEW[0], env={**os.environ, "LD_PRELOAD": cls.library})
        if "runtime does not come first" in run.stderr:
            raise unittest.SkipTest("sanitizers must be preloaded themselves")

    def try_calls(self, kind, action, what, maximum=3, tasks=None, **options):
        self.check([calls.try_calls(self.workshop, self.library, kind, action, what=what, tasks=tasks or FEW, maximum=maximum, **options)])

    def test_a_full_disk_from_one_call_on(self):
        self.try_calls("write", errno.ENOSPC, "ENOSPC", sticky=True, old=True)

    def test_partial_and_interrupted_calls(self):
        self.try_calls("write", "short", "short writes")
        self.try_calls("write", "again", "EINTR")

    def test_a_signal_during_each_of_the_last_calls(self):
        """They include the calls that rename the output."""
        self.try_calls("write", -signal.SIGTERM, "SIGTERM", maximum=20, ended_by=signal.SIGTERM)

    def test_no_output_is_renamed_before_all_are_on_the_disk(self):
        """The last calls include those that flush the outputs to the disk."""
        self.try_calls("write", errno.EIO, "EIO", maximum=30, tasks=SEVERAL_OUTPUTS)

    @unittest.skipIf(os.environ.get("LANDFALL_SANITIZE"), "sanitizers need a larger stack")
    def test_a_small_stack_is_enough(self):
        self.check([resources.try_stacks(self.workshop, [BY_LABEL["scan-sim"]])])

    def test_a_clock_that_jumps_changes_nothing(self):
        judge = surroundings.try_environment(self.workshop, "a clock that jumps", {"LD_PRELOAD": self.library, "FAULT_CLOCK": "~1000000000"},
                                             tasks=FEW)
        self.check([judge])


class OtherFaults(Reliability):
    def test_signals(self):
        self.check([signals.try_signal(self.workshop, self.random, number, 4, FEW) for number in (signal.SIGKILL, signal.SIGPIPE)])

    def test_signals_during_larger_runs(self):
        judges = [signals.try_signal(self.workshop, self.random, number, count, LARGER)
                  for number, count in ((signal.SIGKILL, 50), (signal.SIGTERM, 30), (signal.SIGINT, 10))]
        self.check(judges)
        for judge in judges:
            self.assertGreater(judge.counts["ended"], judge.counts["runs"] / 2, f"{judge.fault}, seed {SEED}")

    def check_out_of_room(self, judge, reason):
        self.check([judge])
        for message in judge.messages:
            self.assertRegex(message, rf"OUT/.*{reason}", judge.fault)
        self.assertGreaterEqual(judge.counts["refused"], 8 * len(TOOLS))

    def test_limits_on_the_size_of_files(self):
        self.check_out_of_room(disks.try_file_limits(self.workshop, TOOLS), "File too large")

    def need_small_disks(self):
        if not disks.can_mount(self.workshop.out):
            self.skipTest("no rights to mount a small disk")

    def test_full_disks(self):
        self.need_small_disks()
        self.check_out_of_room(disks.try_full_disks(self.workshop, TOOLS), "No space left on device")

    def test_no_output_is_left_if_metrics_cannot_be_written(self):
        self.need_small_disks()
        small = os.path.join(self.workshop.inputs, "small")
        with disks.small_disk(small, 4):
            with open(os.path.join(small, "ballast"), "wb") as file:
                file.write(bytes(4096))
            run = self.workshop.run(task("dem-eval, metrics elsewhere", "dem-eval {in}/dem.h5 -c {in}/eval.json -o {out}/eval.h5 "
                                         "--metrics {in}/small/metrics.json", "eval.h5"))
            self.assertEqual((run.code, run.files, os.listdir(small)), (1, {}, ["ballast"]), run.stderr)
        self.assertRegex(run.stderr, r"\Adem-eval: [^\n]*small/metrics.json[^\n]*\n\Z")

    def test_folders_that_are_removed(self):
        self.check([folders.try_removed_folders(self.workshop, self.random, 4, FEW)])

    @unittest.skipUnless(folders.can_unshare(), "no rights for a process namespace")
    def test_two_containers_write_one_output(self):
        judge = Judge(self.workshop, "two containers")
        for one in FEW:
            folders.judge_race(judge, [one] * 2, *folders.race(self.workshop, [one] * 2, True, folders.OWN_NUMBERS), True)
        self.check([judge])

    def test_closed_standard_streams(self):
        self.check([surroundings.try_closed(self.workshop, "stderr closed", 2, verbose=True, tasks=FEW),
                    surroundings.try_closed(self.workshop, "stdout closed", 1, tasks=FEW)])

    def test_limits(self):
        _, broken = limits.try_limits(self.workshop)
        self.assertEqual(broken, [])


if __name__ == "__main__":
    unittest.main()
