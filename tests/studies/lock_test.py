#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""One make at a time in a study's folder: who holds the lock, when it is free, and what works without it."""
import json
import os
import signal
import socket
import subprocess
import time
import unittest

from case import BIN, StudyTest, read, study

# pylint: disable=wrong-import-order
from landfall.errors import UsageError
from landfall.study import lock

TOOLS = ("terrain-gen", "scan-sim", "regrid", "dem-eval")
PATIENCE_S = 300  # no test takes this long; a busy machine may take a while


def processes_under(pid):
    """The process, its children and theirs."""
    children = read(f"/proc/{pid}/task/{pid}/children").split()
    return [pid] + [one for child in children for one in processes_under(int(child))]


class Makes(StudyTest):
    """Two calls of make for one study; the first is stopped within the recipe of its only case."""

    def slow_tools(self):
        """A folder of tools whose regrid waits for the file `go`."""
        folder = self.path("bin")
        os.mkdir(folder)
        for tool in TOOLS:
            wait = f"[[ $1 == --* ]] || until [[ -e {self.path('go')} ]]; do sleep 0.05; done\n" if tool == "regrid" else ""
            with open(os.path.join(folder, tool), "w", encoding="utf-8") as file:
                file.write(f'#!/bin/bash\n{wait}exec {BIN}/{tool} "$@"\n')
            os.chmod(file.name, 0o755)
        return folder

    def start(self):
        """A make that waits in regrid, with its scan in scratch."""
        self.write(study())
        tools = self.slow_tools()
        process = subprocess.Popen(self.make_command("study-results", f"BIN={tools}"), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True, env=self.environment(), start_new_session=True)
        self.addCleanup(self.finish, process)
        while not (os.path.isdir(self.out("scratch")) and any("scan.h5" in files for _, _, files in os.walk(self.out("scratch")))):
            self.assertIsNone(process.poll())
            time.sleep(0.02)
        return process, f"BIN={tools}"

    def finish(self, process):
        """Ends the first make; returns (exit code, what it printed)."""
        with open(self.path("go"), "w", encoding="utf-8"):
            pass
        output, _ = process.communicate(timeout=PATIENCE_S)
        return process.returncode, output

    def wait_until_gone(self, path):
        """What a process in the background removes soon, however busy the machine is."""
        deadline = time.monotonic() + PATIENCE_S
        while os.path.exists(path):
            self.assertLess(time.monotonic(), deadline, f"{path} is still there")
            time.sleep(0.05)

    def test_the_second_make_names_the_first(self):
        first, tools = self.start()
        for goal in ("study-results", "study-clean"):
            result = self.make(goal, tools, code=2)
            self.assertRegex(result.stderr, rf"\*\*\* \S+/studies/tiny is in use: process {first.pid} on "
                             rf"{socket.gethostname()} since \S+ \S+ \(make .*study-results.*\); wait for it or end it\.")
            self.assertNotIn("[", result.stdout)  # no stage was run
        code, output = self.finish(first)
        self.assertEqual(code, 0, output)
        self.assertEqual(len(self.rows()), 1)
        self.wait_until_gone(self.out("lock"))

    def test_what_reads_only_works_beside_a_make(self):
        first, tools = self.start()
        self.assertIn("0 done, 0 failed, 1 left", self.make("study-status", tools).stdout)
        refused = self.sweep("prune", self.out(), code=2).stderr
        self.assertRegex(refused, rf"^sweep.py: \S+/studies/tiny is in use: process {first.pid} on ")
        again = self.sweep("plan", self.path("tiny.json"), "--out", self.out(), "--bin", BIN, code=2).stderr
        self.assertIn(f"process {first.pid} on ", again)
        self.assertEqual(self.finish(first)[0], 0)

    def test_a_make_that_was_killed_leaves_no_lock(self):
        first, tools = self.start()
        for pid in processes_under(first.pid):  # an orphan would work beside the next make
            os.kill(pid, signal.SIGKILL)
        self.finish(first)
        self.wait_until_gone(self.out("lock"))
        self.make("study-results", tools)
        self.assertEqual(len(self.rows()), 1)

    def test_a_study_that_is_refused_leaves_no_folder(self):
        self.write(study({"key": "scan.seed", "list": []}))
        self.make("study-results", code=2)
        self.wait_until_gone(self.out())

    def test_clean_removes_the_folder(self):
        self.write(study())
        self.make("study-plan")
        self.make("study-clean")
        self.assertEqual(os.listdir(os.path.dirname(self.out())), [])


class Holders(StudyTest):
    """The file `lock`, as other processes and machines leave it."""

    def setUp(self):
        super().setUp()
        self.sleeper = subprocess.Popen(["sleep", "600"])
        self.addCleanup(self.sleeper.wait)
        self.addCleanup(self.sleeper.kill)
        while not lock.holder(self.sleeper.pid)["command"]:  # Popen returns a moment before the new program has its arguments
            time.sleep(0.01)

    def leave(self, text=None, **changes):
        """Writes a lock of a process that runs, with changes."""
        if text is None:
            text = json.dumps({**lock.holder(self.sleeper.pid), **changes})
        with open(self.path("lock"), "w", encoding="utf-8") as file:
            file.write(text)

    def take(self):
        lock.take(self.folder, os.getpid(), patience_s=0)
        self.assertEqual(json.loads(read(self.path("lock")))["pid"], os.getpid())

    def refused(self):
        before = read(self.path("lock"))
        with self.assertRaises(UsageError) as context:
            lock.take(self.folder, os.getpid(), patience_s=0)
        self.assertEqual(read(self.path("lock")), before)
        return str(context.exception)

    def test_a_living_process_keeps_it(self):
        self.leave()
        self.assertRegex(self.refused(), rf"process {self.sleeper.pid} on \S+ since \S+ \S+ \(sleep 600\); wait for it or end it$")

    def test_it_is_taken_from_a_process_that_has_ended(self):
        self.leave()
        self.sleeper.kill()
        self.sleeper.wait()
        self.take()

    def test_a_number_that_another_process_has_now(self):
        self.leave(started=lock.holder(self.sleeper.pid)["started"] - 1)
        self.take()

    def test_an_earlier_boot_of_this_machine(self):
        self.leave(boot="00000000-0000-0000-0000-000000000000", pid=1)
        self.take()

    def test_another_machine_keeps_it(self):
        """Whether its process runs cannot be seen from here."""
        for changes in ({"host": "elsewhere", "boot": "0", "machine": "0"}, {"boot": "0", "machine": "0"}, {"namespace": "pid:[1]"}):
            self.leave(**changes)
            self.assertIn(f"this machine cannot see whether it still runs: if it does not, remove {self.path('lock')}", self.refused())

    def test_a_damaged_lock_is_no_lock(self):
        for text in ("", "{", "[]", "{}", '{"pid": "x"}', "\0" * 100):
            self.leave(text)
            self.take()

    def test_it_waits_a_little(self):
        """study-status and the end of a make hold it for a moment."""
        self.leave()
        started = time.monotonic()
        killer = subprocess.Popen(["bash", "-c", f"sleep 0.5; kill {self.sleeper.pid}"])
        while True:  # the process is ours to reap
            try:
                lock.take(self.folder, os.getpid(), patience_s=0.1)
                break
            except UsageError:
                self.sleeper.poll()
        killer.wait()
        self.assertLess(time.monotonic() - started, PATIENCE_S)

    def test_only_its_holder_frees_it(self):
        self.leave()
        lock.free(self.folder, os.getpid())
        self.assertTrue(os.path.exists(self.path("lock")))
        lock.free(self.folder, self.sleeper.pid)
        self.assertFalse(os.path.exists(self.path("lock")))

    def test_a_child_of_the_holder_works_under_its_lock(self):
        self.leave(**lock.holder(os.getpid()))
        before = read(self.path("lock"))
        with lock.held(self.folder):
            self.assertEqual(read(self.path("lock")), before)
        self.assertEqual(read(self.path("lock")), before)

    def test_of_many_that_try_at_once_one_gets_it(self):
        self.leave(started=0)  # of a process that has ended
        script = ("import os, sys, time\nfrom landfall.study import lock\n"
                  "lock.take(sys.argv[1], os.getpid(), patience_s=0)\nprint('got it', flush=True)\ntime.sleep(600)\n")
        environment = {**os.environ, "PYTHONPATH": os.path.join(os.environ["LANDFALL_ROOT"], "python")}
        tries = [subprocess.Popen(["/usr/bin/python3", "-c", script, self.folder], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                  env=environment) for _ in range(8)]
        deadline = time.monotonic() + 60
        while sum(process.poll() is None for process in tries) > 1 and time.monotonic() < deadline:
            time.sleep(0.05)
        (winner,) = [process for process in tries if process.poll() is None]
        self.assertEqual(winner.stdout.readline(), "got it\n")
        self.assertEqual(json.loads(read(self.path("lock")))["pid"], winner.pid)
        winner.send_signal(signal.SIGKILL)
        for process in tries:
            process.wait()
            process.stdout.close()


if __name__ == "__main__":
    unittest.main()
