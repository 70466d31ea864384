#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies and runs of draws on a local Slurm cluster of four nodes: the same bytes as a local run, also if a node is lost."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

from case import BASE, BIN, LIMITS, RESOLUTIONS, ROOT, SIGMAS, StudyTest, read, study
from harness import EVAL, LONGEST_S, REGRID, Chain, run, write_file

sys.path.insert(0, os.path.join(ROOT, "tests", "faults"))
import calls  # pylint: disable=wrong-import-position

PATH = os.environ["PATH"] + ":/usr/sbin:/sbin"
HAS_SLURM = all(shutil.which(name, path=PATH) for name in ("slurmctld", "slurmd", "munged", "sbatch"))
SLURM_LOCAL = os.path.join(ROOT, "studies", "runners", "slurm-local")


def slurm_local(*arguments, **options):
    return subprocess.run([SLURM_LOCAL, *arguments], capture_output=True, text=True, timeout=120, check=False, **options)


@unittest.skipUnless(HAS_SLURM, "slurm-wlm and munge are not installed")
class OnSlurm(StudyTest):
    @classmethod
    def setUpClass(cls):
        # The folder needs a short name, because it holds sockets.
        cls.slurm = os.path.join(tempfile.mkdtemp(prefix="slurm-"), "d")
        started = slurm_local("start", "-N", "4", "--timeout", "5", "--dir", cls.slurm)
        if "cgroup" in started.stderr:  # in a bare chroot or a locked container
            raise unittest.SkipTest("slurmd finds no cgroups that it can use at /sys/fs/cgroup")
        if started.returncode != 0:
            raise AssertionError(started.stderr)
        cls.export = started.stdout.strip()

    @classmethod
    def tearDownClass(cls):
        slurm_local("stop", "--dir", cls.slurm)
        shutil.rmtree(os.path.dirname(cls.slurm))

    def environment(self):
        return {**super().environment(), "SLURM_CONF": os.path.join(self.slurm, "slurm.conf")}

    def check_same(self, runs):
        for name in ("results.csv", "results.h5"):
            self.assertEqual(read(self.out(name, runs=runs)), read(self.out(name, runs="local")), f"{runs}: {name}")
        for folder in ("terrain", "truth", "metrics"):
            self.assertEqual(self.files(folder, runs=runs), self.files(folder, runs="local"))
            for name in self.files(folder, runs="local"):
                self.assertEqual(read(self.out(folder, name, runs=runs)), read(self.out(folder, name, runs="local")),
                                 f"{runs}: {folder}/{name}")

    def test_8_cases(self):
        """srun gives the same bytes as a local run; so does the batch runner when a busy node is lost."""
        self.assertEqual(self.export, f"export SLURM_CONF={self.slurm}/slurm.conf")
        self.write(study({**SIGMAS, "values": [0.01, 0.02]}, RESOLUTIONS, LIMITS))
        self.make("study-results", "-j2", runs="local")
        self.assertEqual(len(self.rows(runs="local")), 8)
        self.make("study-results", "-j4", "RUNNER=srun -Q -n1 -c1", runs="srun")
        self.check_same("srun")
        self.lose_a_node()
        self.check_same("batch")

    def test_sensitivity(self):
        """The recipes sensitivity and design run their tools by RUNNER: the bytes of a local run."""
        velocity = {"scan.navigation_error.velocity_mps.0": {"type": "normal", "sigma": 0.3}}
        noise = {"scan.noise.range_sigma_m": {"type": "uniform", "low": 0.01, "high": 0.02}}
        self.write({"base": BASE, "groups": {"velocity": velocity, "noise": noise}, "outputs": {"accuracy.relative.z.max_m": "largest"}, "size": 16})
        self.make("sensitivity", "-j2", runs="local")
        for runs, runner in (("srun", "srun -Q -n1 -c1"), ("batch", "studies/runners/slurm-batch")):
            self.make("sensitivity", "-j4", f"RUNNER={runner}", runs=runs)
            for name in ("sensitivity.json", "report.html"):
                self.assertEqual(read(self.path(runs, "sensitivity", "tiny", name)), read(self.path("local", "sensitivity", "tiny", name)), (runs, name))

    # The first job on n1 that begins after the common files are made, stops itself: it is there until its node is lost.
    HOLD = """#!/bin/sh
if [ "$SLURMD_NODENAME" = n1 ] && ls "$COMMON"/* >/dev/null 2>&1 && mkdir "$HELD" 2>/dev/null; then kill -STOP $$; fi
exec "$@"
"""

    def lose_a_node(self):
        hold, held = write_file(self.path("hold"), self.HOLD), self.path("held")
        os.chmod(hold, 0o755)
        command = self.make_command("study-results", "-j4", f"RUNNER=studies/runners/slurm-batch {hold}", runs="batch")
        with open(self.path("batch.log"), "w", encoding="utf-8") as log:
            make = subprocess.Popen(command, stdout=log, stderr=log, env={**self.environment(), "HELD": held, "COMMON": self.out("truth", runs="batch")})
        self.wait_for(lambda: os.path.exists(held), "no job on n1")
        lost = self.squeue("-w", "n1", "-t", "running", "-o", "%i")
        self.assertNotEqual(lost, "")
        self.assertEqual(slurm_local("lose", "n1", "--dir", self.slurm).returncode, 0)

        def is_done():
            self.start_again(lost)
            return make.poll() is not None

        self.wait_for(is_done, "the study does not end", longest_s=300, pause_s=0.5)
        self.assertEqual(make.returncode, 0, read(self.path("batch.log")).decode())

    def squeue(self, *arguments):
        return subprocess.run(["squeue", "-h", *arguments], capture_output=True, text=True, env=self.environment(), check=False).stdout.strip()

    def start_again(self, job):
        """Starts a job that lost its node now: Slurm waits two minutes."""
        subprocess.run(["scontrol", "update", f"JobId={job}", "StartTime=now"], capture_output=True, env=self.environment(), check=False)

    def test_ending_the_batch_runner_cancels_its_job(self):
        process = subprocess.Popen([os.path.join(ROOT, "studies", "runners", "slurm-batch"), "sleep", "300"], cwd=self.folder, env=self.environment())
        while not self.batch_jobs():
            time.sleep(0.1)
        process.terminate()
        self.assertEqual(process.wait(timeout=30), 143)
        for _ in range(100):
            if not self.batch_jobs():
                break
            time.sleep(0.1)
        self.assertEqual(self.batch_jobs(), "")
        self.assertEqual(os.listdir(self.folder), [])

    # Part 2 stops itself the first time, in the midst of its draws; its clock runs fast, so that it writes states before.
    DRAWS_CONFIG = """#!/bin/sh
#SBATCH --array=0-3 --requeue --exclude=n1 --open-mode=append -o part%a.log
[ "$SLURM_ARRAY_TASK_ID" != 2 ] || [ "$SLURM_RESTART_COUNT" ] ||
  export LD_PRELOAD="$PWD/failing_calls.so" FAULT_UNDER="$PWD" FAULT_CALLS=write FAULT_AT=500 FAULT_ACTION=-19 FAULT_SPEED=300
A=$((SLURM_ARRAY_TASK_ID * 60)); B=$((A + 60))
monte-carlo scan.h5 --terrain terrain.h5 -c mc.json -v -t 1 --draws $A:$B -o part$SLURM_ARRAY_TASK_ID.h5
"""

    def test_draws_as_an_array(self):
        """The parts of a run of draws, one of which resumes after its node is lost, merged to the undivided run."""
        chain = Chain(noise__dropout_frac=0, noise__dead_pixel_frac=0)
        self.addCleanup(chain.remove)
        calls.build_library(self.folder)
        for name in ("scan.h5", "terrain.h5"):
            shutil.move(chain.path(name), self.path(name))
        for name, text in (("parts.sh", self.DRAWS_CONFIG),
                           ("mc.json", json.dumps({"draws": 240, "regrid": REGRID, "eval": EVAL,
                                                   "vary": {"scan.noise.dropout_frac": {"type": "uniform", "low": 0, "high": 0.3}}}))):
            write_file(self.path(name), text)
        environment = {**self.environment(), "PATH": BIN + ":" + os.environ["PATH"]}
        job = subprocess.run(["sbatch", "--parsable", "parts.sh"], cwd=self.folder, env=environment, capture_output=True, text=True, check=True).stdout.strip()
        self.wait_for(lambda: os.path.exists(self.path(".part2.h5.state")), "part 2 writes no state")
        node = self.squeue("-j", f"{job}_2", "-o", "%N")
        self.assertEqual(slurm_local("lose", node, "--dir", self.slurm).returncode, 0)

        def all_parts_are_made():
            self.start_again(f"{job}_2")
            return all(os.path.exists(self.path(f"part{i}.h5")) for i in range(4))

        self.wait_for(all_parts_are_made, "not all parts are made", longest_s=300, pause_s=0.5)
        self.assertRegex(read(self.path("part2.log")), rb"resumes after [1-9]\d* draws")
        whole = ["scan.h5", "--terrain", "terrain.h5", "-c", "mc.json", "-o", "whole.h5"]
        for arguments in (["merge", *(f"part{i}.h5" for i in range(4)), "-o", "merged.h5"], whole):
            result = run("monte-carlo", *arguments, cwd=self.folder)
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(read(self.path("merged.h5")), read(self.path("whole.h5")))

    def wait_for(self, condition, message, longest_s=LONGEST_S, pause_s=0.05):
        end = time.monotonic() + longest_s
        while not condition():
            self.assertLess(time.monotonic(), end, f"{message}: {sorted(os.listdir(self.folder))}")
            time.sleep(pause_s)

    def batch_jobs(self):
        """The numbers of the batch runner's jobs that are running or pending."""
        return self.squeue("-n", "landfall", "-t", "running,pending", "-o", "%i")

    def test_the_batch_runner_returns_exit_code_and_messages(self):
        """In folders whose names have meanings for shells and Slurm, with such words and variables."""
        words = ["out  put", "a\nb", "$(touch hacked)", "`touch hacked`", "'", '"', "--help", "%j", "*", "\\", ""]
        for name in ("plain", "-a %j $(touch hacked)\n'b\";", "b\\a%j"):
            folder = self.path(name)
            os.mkdir(folder)
            result = subprocess.run([os.path.join(ROOT, "studies", "runners", "slurm-batch"), "bash", "-c",
                                     'printf "<%s>" "$@" "$HOSTILE"; echo oops >&2; exit 3', "bash", *words], capture_output=True, text=True, cwd=folder,
                                    env={**self.environment(), "HOSTILE": "\n$(touch hacked)"}, timeout=60, check=False)
            given = "".join(f"<{word}>" for word in (*words, "\n$(touch hacked)"))
            self.assertEqual((result.returncode, result.stdout, result.stderr), (3, given, "oops\n"), name)
            self.assertEqual(os.listdir(folder), [])
            os.rmdir(folder)
        refused = subprocess.run([os.path.join(ROOT, "studies", "runners", "slurm-batch"), "true"], capture_output=True, text=True, timeout=60,
                                 cwd=self.folder, env={**self.environment(), "SLURM_BATCH_OPTIONS": "-p nowhere"}, check=False)
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn("invalid partition", refused.stderr)
        self.assertEqual(os.listdir(self.folder), [])


class SlurmLocal(StudyTest):
    def test_wrong_arguments(self):
        for arguments, word in ((["frob"], "start"), (["start", "-N", "0"], "-N: 0 is not an integer in [1, 256]"),
                                (["start", "-N"], "-N needs a value"), (["start", "--nodes", "3"], "unknown option --nodes"),
                                (["lose"], "lose needs a node"), (["start", "--dir", self.path("a b")], "a name of letters, digits")):
            result = slurm_local(*arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertIn(word, result.stderr)

    def test_a_folder_of_other_files_is_not_touched(self):
        self.write("{}")
        for command in ("stop", "status"):
            result = slurm_local(command, "--dir", self.folder)
            self.assertEqual((result.returncode, os.listdir(self.folder)), (1, ["tiny.json"]))
        if HAS_SLURM:
            self.assertIn("is not empty", slurm_local("start", "--dir", self.folder).stderr)
            self.assertEqual(os.listdir(self.folder), ["tiny.json"])

    def test_missing_packages_are_named(self):
        """PATH has no Slurm commands, and the folders that the script adds to it have no sinfo."""
        os.mkdir(self.path("bin"))
        for name in ("id", "realpath"):
            os.symlink(shutil.which(name), self.path("bin", name))
        result = slurm_local("start", "--dir", self.path("d"), env={"PATH": self.path("bin")})
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"missing Debian packages: slurm-wlm( munge)? \(apt-get install")
        self.assertFalse(os.path.exists(self.path("d")))


if __name__ == "__main__":
    unittest.main()
