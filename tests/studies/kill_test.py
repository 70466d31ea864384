#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A study is killed at random times (make or its tools) and resumed: it gives the same bytes as an undisturbed one."""
import os
import random
import shlex
import signal
import subprocess
import time
import unittest

from case import LIMITS, ROOT, SIGMAS, StudyTest, read, study

SEED = int(os.environ.get("LANDFALL_TEST_SEED", "20240607"))
KILLS = 20
TOOLS = ("terrain-gen", "scan-sim", "regrid", "dem-eval", "monte-carlo", "study-chain", "run-stage")


def processes(word):
    """{pid: words of the command line} of the processes whose command line contains `word`, without zombies."""
    found = {}
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = read(f"/proc/{pid}/cmdline").decode(errors="replace").split("\0")
        except OSError:
            continue
        if any(word in part for part in command):
            found[int(pid)] = command
    return found


class Kills(StudyTest):
    def setUp(self):
        super().setUp()
        self.random = random.Random(SEED)

    def running(self):
        """The processes of this test's make and its recipes."""
        return [pid for pid, command in processes(self.folder).items()
                if any(os.path.basename(part) in TOOLS for part in command[:3])]

    def kill_tool(self):
        running = self.running()
        for pid in [self.random.choice(running)] if running else []:
            try:
                os.kill(pid, signal.SIGKILL)
                return True
            except ProcessLookupError:
                pass
        return False

    def make_with_kills(self, goal):
        """Runs make, and kills it or its tools soon after the start; returns (kills, exit code)."""
        make = subprocess.Popen(self.make_command(goal, "-k", "-j2"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=self.environment())
        kills = 0
        for _ in range(self.random.randint(1, 3)):
            time.sleep(self.random.uniform(0.05, 0.5))
            if make.poll() is None and self.random.random() < 0.5:
                make.kill()
                kills += 1
            else:
                kills += self.kill_tool()
            if make.poll() is not None:
                break
        return kills, make.wait()

    def test_results_equal_an_undisturbed_run(self):
        tree = study(SIGMAS, LIMITS)
        tree["base"]["draws"] = {"draws": 2, "metrics": "verdict"}
        self.write(tree)
        self.make("study-results", "-j2", runs="undisturbed")
        kills = 0
        for attempt in range(12 * KILLS):
            more, code = self.make_with_kills("study-results")
            kills += more
            if kills >= KILLS:
                break
            if code == 0:  # all is built: remove some files, and build again
                self.remove_some()
        self.assertGreaterEqual(kills, KILLS, f"seed {SEED}, {attempt} calls")
        self.wait_for_orphans()  # an orphan of a killed make may hold the lock for as long as a loaded machine needs
        self.make("study-results", "-j2")
        for name in ("results.csv", "results.h5"):
            self.assertEqual(read(self.out(name)), read(self.out(name, runs="undisturbed")), f"{name}, seed {SEED}")
        for folder in ("metrics", "verdict"):
            self.assertEqual(self.files(folder), self.files(folder, runs="undisturbed"))
        for folder in ("metrics", "verdict", "terrain", "truth"):
            for name in self.files(folder, runs="undisturbed"):
                self.assertEqual(read(self.out(folder, name)), read(self.out(folder, name, runs="undisturbed")), name)
        self.assertEqual(self.files("shared"), [])

    def remove_some(self):
        for folder in ("metrics", "verdict", "terrain", "truth"):
            for name in self.files(folder):
                if self.random.random() < 0.7:
                    os.remove(self.out(folder, name))

    def wait_for_orphans(self):
        """Waits until the processes that a killed make has left have ended, and the make under the lock, which it ends."""
        for _ in range(3000):
            if not self.running():
                break
            time.sleep(0.1)
        self.assertEqual(self.running(), [])
        if os.path.exists(self.out() + ".lock"):
            subprocess.run(["flock", "-w", "300", self.out() + ".lock", "true"], check=True)

    def stage(self, name, script, *options):
        """(folder, command line) of a stage whose shell script makes metrics/m.json from a shared file, which nobody else needs."""
        folder = self.path(name)
        for part in ("shared", "readers", "log", "metrics"):
            os.makedirs(os.path.join(folder, part))
        for file, text in {"shared/a.dem.h5": "a", "readers/a.dem.h5": "metrics/m.json", "tools.txt": "",
                           "targets.txt": "metrics/m.json log/metrics-m.log shared/a.dem.h5\n"}.items():
            with open(os.path.join(folder, file), "w", encoding="utf-8") as output:
                output.write(text)
        metrics, shared = os.path.join(folder, "metrics", "m.json"), os.path.join(folder, "shared", "a.dem.h5")
        return folder, [os.path.join(ROOT, "studies", "runners", "run-stage"), "--study", folder, "--kind", "metrics", "--id", "m",
                        "--output", metrics, "--drop", shared, *options, "--", "bash", "-c", script.format(metrics=shlex.quote(metrics))]

    def wait_for(self, path, process):
        """Waits for a file that a running process makes."""
        while not os.path.exists(path):
            self.assertTrue(process.poll() is None or os.path.exists(path))
            time.sleep(0.01)

    def run_stage(self, kill):
        folder, stage = self.stage("kill" if kill else "live", "sleep 0.5; echo 1 > {metrics}")
        make = subprocess.Popen(["sh", "-c", shlex.join(stage) + " & wait"], stdout=subprocess.DEVNULL)
        if kill:
            self.wait_for(os.path.join(folder, "log", "metrics-m.log"), make)
            make.kill()
        make.wait()
        self.wait_for_orphans()
        self.assertTrue(os.path.exists(os.path.join(folder, "metrics", "m.json")))
        return os.path.exists(os.path.join(folder, "shared", "a.dem.h5"))

    def test_a_command_that_does_not_end_is_told_again(self):
        script = "told=0; trap 'told=$((told + 1))' TERM; echo > {metrics}; until ((told == 3)); do sleep 0.01; done; exit 5"
        folder, stage = self.stage("told", script, "--end-again", "0.2")
        process = subprocess.Popen(stage, stderr=subprocess.DEVNULL)
        self.wait_for(os.path.join(folder, "metrics", "m.json"), process)
        process.terminate()
        self.assertEqual(process.wait(), 128 + signal.SIGTERM)

    def test_only_the_recipe_of_a_running_make_removes_shared_files(self):
        """A recipe that outlives its make keeps shared files, because the next make may use them."""
        self.assertFalse(self.run_stage(kill=False))
        self.assertTrue(self.run_stage(kill=True))

    def test_interrupted_by_the_keyboard(self):
        """SIGINT to the whole group, as a terminal sends it: all end, no file is incomplete, and the rest is made later."""
        self.write(study(SIGMAS, LIMITS))
        make = subprocess.Popen(self.make_command("study-results", "-j2"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                env=self.environment(), start_new_session=True)
        while not (os.path.isdir(self.out("shared")) and self.files("shared")) and make.poll() is None:
            time.sleep(0.02)
        os.killpg(make.pid, signal.SIGINT)
        self.assertNotEqual(make.wait(timeout=30), 0)
        self.wait_for_orphans()
        self.make("study-results", "-j2")
        self.assertEqual(self.files("shared") + self.files("scratch"), [])

    def test_temporary_files_are_swept(self):
        self.write(study())
        self.make("study-results")
        os.makedirs(self.out("figures"), exist_ok=True)
        ended, alive = 2 ** 22 + 1, os.getpid()  # above the kernel's largest number of a process
        for name in ("figures/overview.png.{}.tmp", "figures/.percentiles.csv.{}.part", ".results.csv.{}.part", "config/scan/.a.json.{}.part"):
            for pid in (ended, alive):
                with open(self.out(name.format(pid)), "w", encoding="utf-8"):
                    pass
        self.make("study-results")
        left = [name for _, _, names in os.walk(self.out()) for name in names if name.endswith((".tmp", ".part"))]
        self.assertEqual(sorted(left), sorted([f"overview.png.{alive}.tmp", f".percentiles.csv.{alive}.part", f".results.csv.{alive}.part",
                                               f".a.json.{alive}.part"]))


if __name__ == "__main__":
    unittest.main()
