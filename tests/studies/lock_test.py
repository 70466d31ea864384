#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""One make at a time in a study's folder: who holds the lock, when it is free, and what works without it."""
import os
import re
import signal
import socket
import subprocess
import time
import unittest

from case import BIN, StudyTest, read, study
from harness import write_file

TOOLS = ("terrain-gen", "scan-sim", "regrid", "dem-eval", "landfall-info")
PATIENCE_S = 300  # no test takes this long; a busy machine may take a while


def children_of(pid):
    try:
        return [int(child) for child in read(f"/proc/{pid}/task/{pid}/children").split()]
    except (FileNotFoundError, ProcessLookupError):  # it has ended
        return []


def processes_under(pid):
    """The process, its children and theirs."""
    return [pid] + [one for child in children_of(pid) for one in processes_under(child)]


def is_running(pid):
    try:
        return b") Z " not in read(f"/proc/{pid}/stat")
    except FileNotFoundError:
        return False


class Makes(StudyTest):
    """Two calls of make for one study; the first is stopped within the recipe of its only case."""

    def slow_tools(self):
        """A folder of tools whose regrid waits for the file `go`."""
        folder = self.path("bin")
        os.mkdir(folder)
        for tool in TOOLS:
            wait = f"[[ $1 == --* ]] || until [[ -e {self.path('go')} ]]; do sleep 0.05; done\n" if tool == "regrid" else ""
            os.chmod(write_file(os.path.join(folder, tool), f'#!/bin/bash\n{wait}exec {BIN}/{tool} "$@"\n'), 0o755)
        return folder

    def start(self):
        """A make that waits in regrid, with its scan in scratch."""
        self.write(study())
        tools = self.slow_tools()
        process = subprocess.Popen(self.make_command("study-results", f"BIN={tools}", "-j2"), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True, env=self.environment(), start_new_session=True)
        self.addCleanup(self.finish, process)
        while not (os.path.isdir(self.out("scratch")) and any("scan.h5" in files for _, _, files in os.walk(self.out("scratch")))):
            self.assertIsNone(process.poll())
            time.sleep(0.02)
        return process, f"BIN={tools}"

    def holder(self):
        """The process that the lock names."""
        return int(re.match(r"process (\d+) on ", read(self.out() + ".lock").decode())[1])

    def finish(self, process):
        """Ends the first make; returns (exit code, what it printed)."""
        write_file(self.path("go"), "")
        output, _ = process.communicate(timeout=PATIENCE_S)
        return process.returncode, output

    def wait_until_ended(self, pids):
        deadline = time.monotonic() + PATIENCE_S
        while any(is_running(pid) for pid in pids):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)

    def test_the_second_make_names_the_first(self):
        first, tools = self.start()
        self.assertIn(self.holder(), processes_under(first.pid))
        for goal in ("study-results", "study-clean"):
            result = self.make(goal, tools, code=2)
            self.assertRegex(result.stderr, rf"(?m)^\S+/studies/tiny is in use: process {self.holder()} on "
                             rf"{socket.gethostname()} since \S+ \S+ \(make .*study-results\); wait for it or end it$")
            self.assertNotIn("[", result.stdout)  # no stage was run
        code, output = self.finish(first)
        self.assertEqual(code, 0, output)
        self.assertNotIn("jobserver", output)
        self.assertEqual(len(self.rows()), 1)

    def test_what_reads_only_works_beside_a_make(self):
        first, tools = self.start()
        self.assertIn("0 done, 0 failed, 1 left", self.make("study-status", tools).stdout)
        refused = self.sweep("prune", self.out(), code=2).stderr
        self.assertRegex(refused, rf"^\S+/studies/tiny is in use: process {self.holder()} on ")
        again = self.sweep("plan", self.path("tiny.json"), "--out", self.out(), "--bin", BIN, code=2).stderr
        self.assertIn(f"process {self.holder()} on ", again)
        self.assertEqual(self.finish(first)[0], 0)
        self.sweep("prune", self.out())

    def test_a_make_that_is_killed_ends_with_all_that_it_started(self):
        first, tools = self.start()
        started = processes_under(first.pid)
        os.kill(first.pid, signal.SIGKILL)
        self.wait_until_ended(started)
        self.finish(first)
        self.make("study-results", tools)
        self.assertEqual(len(self.rows()), 1)

    def test_what_outlives_a_killed_make_holds_no_lock(self):
        """The process that the lock names is killed; its recipe, which waits in regrid, is an orphan."""
        first, tools = self.start()
        holder = self.holder()
        (recipe,) = children_of(holder)
        os.kill(holder, signal.SIGKILL)
        self.assertNotEqual(first.wait(), 0)
        self.assertTrue(is_running(recipe))
        self.assertIn("files written", self.sweep("plan", self.path("tiny.json"), "--out", self.out(), "--bin", tools[4:]).stdout)
        self.assertTrue(is_running(recipe))
        self.finish(first)
        self.wait_until_ended([recipe])
        self.make("study-results", tools)
        self.assertEqual(len(self.rows()), 1)

    def test_an_ended_study_has_freed_its_lock(self):
        """landfall study ends what outlives make, here a call of the shell that make does not end."""
        self.write(study())
        begun = f'[[ " $* " == *" begin "* ]] && {{ echo $$ > {self.path("began")}; exec sleep 1000; }}'
        slow = write_file(self.path("slow-python"), f'#!/bin/bash\n{begun}\nexec /usr/bin/python3 "$@"\n')
        os.chmod(slow, 0o755)
        for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
            process = subprocess.Popen([f"{BIN}/landfall", "study", "tiny.json", f"PYTHON={slow}"], cwd=self.folder, env=self.environment(),
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            deadline = time.monotonic() + PATIENCE_S
            while not (os.path.exists(self.path("began")) and read(self.path("began"))):
                self.assertIsNone(process.poll())
                self.assertLess(time.monotonic(), deadline)
                time.sleep(0.02)
            process.send_signal(number)
            self.assertEqual(process.wait(PATIENCE_S), -number)
            self.assertFalse(is_running(int(read(self.path("began")))))
            os.remove(self.path("began"))
            subprocess.run(["flock", "-n", self.path("runs/studies/tiny.lock"), "true"], check=True)

    def test_messages_of_make_escape_names(self):
        name = "e\x1b[31m\u202e\x07"
        self.write("{}", name)
        result = subprocess.run([f"{BIN}/landfall", "study", name + ".json"], cwd=self.folder, env=self.environment(), capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 2)
        for text in (result.stdout, result.stderr):
            self.assertNotRegex(text, "[\x1b\x07\u202e]")

    def test_two_studies_at_once(self):
        first, _ = self.start()
        self.write(study(), "other")
        self.make("study-results", study_name="other")
        self.assertEqual(len(self.rows(study_name="other")), 1)
        self.assertIsNone(first.poll())
        self.assertEqual(self.finish(first)[0], 0)

    def test_a_study_that_is_refused_leaves_no_folder(self):
        self.write(study({"key": "scan.seed", "values": []}))
        self.make("study-results", code=2)
        self.assertFalse(os.path.exists(self.out()))

    def test_clean_removes_the_folder(self):
        self.write(study())
        self.make("study-plan")
        self.make("study-clean")
        self.assertEqual(os.listdir(os.path.dirname(self.out())), ["tiny.lock"])


if __name__ == "__main__":
    unittest.main()
