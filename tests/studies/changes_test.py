#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which changes make Makefile.studies build again, and how it checks that a stage made its outputs."""
import os
import pty
import re
import stat
import subprocess
import unittest

from case import BIN, ROOT, SIGMAS, StudyTest, study
from harness import write_file


class Changes(StudyTest):
    """The inputs of a study: its files, data files and the tools."""

    def test_base_files_and_data_files(self):
        tree = study(SIGMAS)
        self.write(tree["base"]["scan"], "scan")
        tree["base"]["scan"] = "scan.json"
        tree["set"] = {"scan.trajectory": {"type": "table", "path": "waypoints.csv"}}
        self.write_trajectory(50)
        self.write(tree)
        self.make("study-results", "-j2")
        first = self.rows()
        self.age_by(86400)  # as if made while the clock was a day ahead
        self.write({**study()["base"]["scan"], "seed": 9}, "scan")
        self.make("study-results", "-j2")
        second = self.rows()
        self.assertNotEqual([row["statistics.z.mean_m"] for row in first], [row["statistics.z.mean_m"] for row in second])
        before = os.stat(self.out("results.csv")).st_mtime_ns
        self.write_trajectory(51)
        self.make("study-results", "-j2")
        self.assertEqual([self.runs_of(step, since=before) for step in ("terrain", "scan")], [0, 4])

    def age_by(self, seconds):
        for where, _, names in os.walk(self.path("runs")):
            for path in (os.path.join(where, name) for name in names):
                os.utime(path, (os.stat(path).st_mtime + seconds,) * 2)

    def write_trajectory(self, height):
        rows = "".join(f"{t},0,0,{height - t},1,0,0,0\n" for t in (0, 0.1, 0.2, 0.3))
        write_file(self.path("waypoints.csv"), "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n" + rows)

    def tools_of(self, version):
        """A folder with tools that report another version but work the same."""
        folder = self.path("bin-" + version)
        os.mkdir(folder)
        for tool in ("terrain-gen", "scan-sim", "regrid", "dem-eval", "landfall-info"):
            answer = f'[[ "$1" != --version ]] || {{ echo "landfall {tool} {version}"; exit; }}'
            os.chmod(write_file(os.path.join(folder, tool), f'#!/bin/bash\n{answer}\nexec {BIN}/{tool} "$@"\n'), 0o755)
        return folder

    def test_a_new_version_of_the_tools_builds_all_again(self):
        self.write(study(SIGMAS))
        first, second = self.tools_of("1"), self.tools_of("2")
        self.make("study-results", "-j2", f"BIN={first}")
        before = os.stat(self.out("results.csv")).st_mtime_ns
        for tool in os.listdir(first):
            os.utime(os.path.join(first, tool))  # as if built again with the same version
        self.assertEqual(self.make("study-results", f"BIN={first}").stdout.count("run-stage"), 0)
        self.assertEqual(os.stat(self.out("results.csv")).st_mtime_ns, before)
        self.make("study-results", "-j2", f"BIN={second}")
        self.assertEqual([self.runs_of(step, since=before) for step in ("terrain", "scan", "eval")], [1, 4, 3])

    def test_a_bad_study_stops_make(self):
        self.write(study(SIGMAS))
        self.make("study-plan")
        self.write(study({**SIGMAS, "values": []}))
        result = self.make("study-results", code=2)
        self.assertIn("/axes/0/values: an array of 0 elements; expected at least 1", result.stderr)

    def test_without_a_study(self):
        result = subprocess.run(["make", "-C", ROOT, "-f", "Makefile.studies", "study"], capture_output=True, text=True,
                                env=self.environment(), check=False)
        self.assertEqual(result.returncode, 2)
        self.assertIn("STUDY=noise", result.stderr)


class Outputs(StudyTest):
    """run-stage checks the files of a stage, not only exit codes."""

    def runner(self, text):
        path = write_file(self.path("runner"), "#!/bin/bash\n" + text)
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
        return f"RUNNER={path}"

    def test_a_runner_that_exits_0_without_output(self):
        self.write(study())
        result = self.make("study-results", self.runner("exit 0\n"), "STAGE_PATIENCE=0", code=2)
        self.assertRegex(result.stderr, r"run-stage: \S+/terrain/[0-9a-f]{16}\.h5: the command exited 0 and did not make it")

    def test_a_command_that_is_killed(self):
        self.write(study())
        result = self.make("study-results", self.runner("kill -KILL $$\n"), code=2)
        self.assertRegex(result.stderr, r"FAILED \(exit 137\): terrain of [^\n]*\n    run-stage: a command was killed \(SIGKILL\), as when memory runs out")
        result = subprocess.run([f"{BIN}/landfall", "study", "results", self.path("tiny.json"), self.runner("kill -KILL $PPID\n")], capture_output=True,
                                text=True, env=self.environment(), cwd=self.folder, check=False)  # its parent, run-stage
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"\Amake[^\n]*: \*\*\* \[[^\n]*/terrain/[0-9a-f]{16}\.h5\] Killed, as when memory runs out; the same command continues\n\Z")

    @unittest.skipUnless(os.geteuid() == 0, "only root can be another user")
    def test_no_further_process_allowed(self):
        """A limit on the processes of a user (ulimit -u), which root does not have."""
        self.write(study())
        os.chmod(self.folder, 0o777)
        user = ["setpriv", "--reuid=54321", "--regid=54321", "--clear-groups"]
        make = {"capture_output": True, "text": True, "env": self.environment(), "check": False}
        if subprocess.run([*user, f"{BIN}/terrain-gen", "--version"], **make).returncode != 0:
            self.skipTest("other users cannot start the tools")
        result = subprocess.run([*user, "prlimit", "--nproc=1", *self.make_command("study-results")], **make)
        self.assertEqual((result.returncode, os.path.exists(self.out("results.csv"))), (2, False), result.stderr)
        self.assertIn("Resource temporarily unavailable", result.stderr)
        self.assertNotIn("Traceback", result.stderr)
        result = subprocess.run([*user, *self.make_command("study-results")], **make)
        self.assertEqual((result.returncode, len(self.rows())), (0, 1), result.stderr)

    def test_old_outputs_do_not_count(self):
        self.write(study())
        self.make("study-results")
        later = os.stat(self.out("results.csv")).st_mtime_ns + 10 ** 10
        os.utime(self.out("tools.txt"), ns=(later, later))
        result = self.make("study-results", self.runner("exit 0\n"), "STAGE_PATIENCE=0", code=2)
        self.assertIn("did not make it", result.stderr)

    def test_an_output_that_appears_late(self):
        self.write(study())
        self.make("study-results", self.runner('(sleep 1; "$@") >/dev/null 2>&1 &\n'))
        self.assertEqual(len(self.rows()), 1)

    def test_a_missing_runner(self):
        self.write(study())
        result = self.make("study-results", "RUNNER=/nowhere/srun", code=2)
        self.assertIn("/nowhere/srun: No such file", result.stderr)

    def test_progress_on_a_terminal(self):
        """One line that is overwritten, with the remaining number of stages."""
        self.write(study(SIGMAS))
        master, slave = pty.openpty()
        make = subprocess.Popen(self.make_command("study-results"), stdout=slave, stderr=slave, env=self.environment())
        os.close(slave)
        text = ""
        while True:
            try:
                text += os.read(master, 65536).decode()
            except OSError:  # the other end is closed
                break
        os.close(master)
        self.assertEqual(make.wait(), 0)
        counts = re.findall(r"\r\x1b\[K(\d+) done, 0 failed, (\d+) left(, about \S+ \w+ to go)?", text)
        self.assertEqual([(int(done), int(left)) for done, left, _ in counts], [(n, 5 - n) for n in range(1, 6)])
        self.assertTrue(all(to_go for *_, to_go in counts[:-1]))
        self.assertIn("5 done, 0 failed, 0 left\r\n", text)

    def test_progress_off_a_terminal(self):
        self.write(study(SIGMAS))
        lines = [line for line in self.make("study-results").stdout.splitlines() if line.startswith("[")]
        self.assertEqual([re.match(r"\[(\d+) done, 0 failed, (\d+) left", line).groups() for line in lines],
                         [(str(n), str(5 - n)) for n in range(1, 6)])


if __name__ == "__main__":
    unittest.main()
