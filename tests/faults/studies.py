# SPDX-License-Identifier: GPL-3.0-or-later
"""A complete study with a fault; it is then resumed, and must give the same bytes as an undisturbed one."""
import contextlib
import json
import os
import shutil
import signal
import subprocess
import time

import disks
from workshop import EVAL, PART, REGRID, SCAN, TERRAIN, Judge

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
STUDY = {"base": {"terrain": TERRAIN, "scan": SCAN, "regrid": REGRID, "eval": EVAL},
         "axes": [{"key": "scan.noise.range_sigma_m", "values": [0.01, 0.02]}, {"key": "regrid.resolution_m", "values": [0.1, 0.2]}]}
RESULTS = ("results.csv", "results.h5")


def restore_sigint():
    """Undoes that a shell makes background processes ignore SIGINT."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class Study:
    """A study of four cases with its results in `folder`."""

    def __init__(self, workshop, folder):
        self.workshop, self.folder = workshop, folder
        self.file = os.path.join(workshop.folder, "tiny.json")
        with open(self.file, "w", encoding="utf-8") as file:
            json.dump(STUDY, file)

    def start(self):
        environment = {key: value for key, value in os.environ.items() if not key.startswith(("MAKE", "MFLAGS"))}
        return subprocess.Popen(["make", "-C", ROOT, "-f", "Makefile.studies", f"STUDY={self.file}", f"BIN={self.workshop.binaries}",
                                 f"RUNS={self.folder}", "-k", "-j2", "study-results"], stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, env=environment, start_new_session=True,
                                preexec_fn=restore_sigint)

    def make(self):
        process = self.start()
        output, _ = process.communicate(timeout=300)
        return process.returncode, output

    def results(self):
        """{name: bytes} of the collected results that exist."""
        found = {}
        for name in RESULTS:
            with contextlib.suppress(FileNotFoundError):
                with open(os.path.join(self.folder, "studies", "tiny", name), "rb") as file:
                    found[name] = file.read()
        return found

    def hidden_files(self):
        return [name for _, _, names in os.walk(self.folder) for name in names if PART.match(name) or name.endswith(".part")]

    def remove(self):
        shutil.rmtree(self.folder, ignore_errors=True)


class Trials:
    def __init__(self, workshop, random):
        self.random = random
        self.study = Study(workshop, os.path.join(workshop.folder, "runs"))
        start = time.time()
        code, output = self.study.make()
        self.seconds, self.whole = time.time() - start, self.study.results()
        if code != 0 or sorted(self.whole) != sorted(RESULTS):
            raise RuntimeError(output)

    def judge(self, judge, code, how):
        """After the fault, existing results must be complete; after resuming, all must exist, and no hidden file may be left."""
        faults = [f"{name} is incomplete or different" for name, data in self.study.results().items() if data != self.whole[name]]
        judge.counts["parts"] += bool(self.study.hidden_files())
        again, output = self.study.make()
        faults += [f"resumed: exit {again}: {output[-300:]}"] if again else []
        faults += ["resumed: different results"] if self.study.results() != self.whole else []
        faults += [f"resumed: left behind {self.study.hidden_files()}"] if self.study.hidden_files() else []
        judge.counts.update(runs=1, whole=int(code == 0), refused=int(code > 0), ended=int(code < 0))
        if faults:
            judge.broken.append(f"{judge.fault}: {how}: {'; '.join(faults)}")
            print("BROKEN", judge.broken[-1], flush=True)

    def signalled(self, workshop, number, count):
        """Sends the signal to the whole process group, as a terminal or a batch system does."""
        judge = Judge(workshop, f"make study, {number.name} to all its processes")
        for _ in range(count):
            self.study.remove()
            process, moment = self.study.start(), self.random.uniform(0, self.seconds)
            time.sleep(moment)
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, number)
            process.communicate(timeout=300)
            self.judge(judge, process.returncode, f"after {moment:.2f} s")
        return judge

    def on_full_disks(self, workshop, count):
        """The disk is too small; the study is resumed on a larger one with the same files."""
        judge = Judge(workshop, "make study on a full disk (tmpfs)")
        if not disks.can_mount(self.study.folder):
            return judge
        for i in range(count):
            self.study.remove()
            with disks.small_disk(self.study.folder, 64 + 3000 * i // count):
                code, _ = self.study.make()
                subprocess.run(["mount", "-o", "remount,size=64m", self.study.folder], check=True)
                self.judge(judge, code, f"{64 + 3000 * i // count} KiB")
        return judge


def try_studies(workshop, random, count):
    trials = Trials(workshop, random)
    for number in (signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        yield trials.signalled(workshop, number, count)
    yield trials.on_full_disks(workshop, count)
