# SPDX-License-Identifier: GPL-3.0-or-later
"""Common part of the trials: the tools on a small chain, their undisturbed results, and the check of a disturbed run."""
import collections
import dataclasses
import json
import os
import re
import resource
import shutil
import subprocess
import tempfile
import time

TERRAIN = {"grid": {"half_width_m": 6, "resolution_m": 0.1},
           "features": [{"type": "cone", "x_m": 1.5, "y_m": 0.5, "radius_m": 1, "height_m": 1.5}]}
SCAN = {"detector": {"rows": 8, "columns": 8, "ifov_rad": 0.0011},
        "laser": {"pulse_rate_hz": 2000, "scan_time_s": 0.2},
        "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 4}},
        "trajectory": {"type": "constant_velocity", "position_m": [0, 0, 50], "velocity_mps": [0, 0, -5]},
        "noise": {"range_sigma_m": 0.01}}
REGRID = {"resolution_m": 0.1, "half_width_m": 5}
EVAL = {"region_radius_m": 4, "footprint_m": 0.7}
CONFIGS = {"terrain": TERRAIN, "scan": SCAN, "regrid": REGRID, "eval": EVAL}
MAX_SECONDS = 60  # no task needs one second
HANGS = 1000  # instead of the exit code of a run that was killed after MAX_SECONDS
OLD = b"the old output\n"
PART = re.compile(r"^\.(?P<name>.+)\.[0-9a-f]{8}-\d+\.part$")


@dataclasses.dataclass(frozen=True)
class Task:
    """One way to use a tool. {in} and {out} in the arguments are the folders of inputs and outputs."""
    label: str
    arguments: tuple
    outputs: tuple = ()

    @property
    def tool(self):
        return self.arguments[0]


def task(label, line, *outputs):
    return Task(label, tuple(line.split()), outputs)


TASKS = [
    task("terrain-gen .h5", "terrain-gen -c {in}/terrain.json -o {out}/terrain.h5", "terrain.h5"),
    task("terrain-gen .tif", "terrain-gen --from {in}/terrain.h5 -o {out}/terrain.tif", "terrain.tif"),
    task("terrain-gen .ply", "terrain-gen --from {in}/terrain.h5 -o {out}/mesh.ply", "mesh.ply"),
    task("terrain-gen of a .tif", "terrain-gen --from {in}/terrain.tif -o {out}/import.h5", "import.h5"),
    task("terrain-gen of a .ply", "terrain-gen --from {in}/mesh.ply -o {out}/import.h5", "import.h5"),
    task("scan-sim", "scan-sim -c {in}/scan.json --terrain {in}/terrain.h5 -o {out}/scan.h5", "scan.h5"),
    task("scan-sim --ranges-from", "scan-sim -c {in}/scan.json --ranges-from {in}/scan.h5 --seed 2 -o {out}/draw.h5", "draw.h5"),
    task("scan-sim --plan", "scan-sim -c {in}/scan.json --plan --plan-radius 4 --plan-resolution 0.1 -o {out}/plan.h5", "plan.h5"),
    task("regrid", "regrid {in}/scan.h5 --terrain {in}/terrain.h5 -c {in}/regrid.json --uncertainty -o {out}/dem.h5", "dem.h5"),
    task("regrid --view", "regrid {in}/scan.h5 -c {in}/regrid.json -o {out}/dem.h5 --view {out}/dem.png", "dem.h5", "dem.png"),
    task("dem-eval --metrics --report", "dem-eval {in}/dem.h5 -c {in}/eval.json -o {out}/eval.h5 --metrics {out}/metrics.json "
         "--report {out}/report.html", "eval.h5", "metrics.json", "report.html"),
    *(task(f"landfall-export .{kind}", f"landfall-export {{in}}/{source} -o {{out}}/export.{kind}", f"export.{kind}")
      for kind, source in [("csv", "scan.h5"), ("las", "scan.h5 -q"), ("ply", "scan.h5"), ("tif", "dem.h5"), ("png", "eval.h5")]),
    task("landfall-export .xmf", "landfall-export {in}/scan.h5 -o {out}/export.xmf", "export.xmf.h5", "export.xmf"),
    task("landfall-export -o -", "landfall-export {in}/dem.h5 -o - --format csv"),
    task("landfall-info --json", "landfall-info {in}/scan.h5 --json"),
]


@dataclasses.dataclass
class Run:
    """How a run ended, and the files in the folder of outputs."""
    code: int
    stdout: bytes
    stderr: str
    files: dict

    @property
    def parts(self):
        return sorted(name for name in self.files if PART.match(name))


def files_of(folder):
    """{name: bytes, or a word for entries that are not files} of a folder; empty if the folder does not exist."""
    found = {}
    for entry in os.scandir(folder) if os.path.isdir(folder) else []:
        if entry.is_file(follow_symlinks=False):
            with open(entry.path, "rb") as file:
                found[entry.name] = file.read()
        else:
            found[entry.name] = "a folder" if entry.is_dir() else "a link"
    return found


class Workshop:
    """Inputs in `in`, outputs in `out` (new for each run), and the results and the time of each task when undisturbed."""

    rounds = 3  # of each undisturbed run, for the time of which signals make use

    def __init__(self, binaries, threads=2, tasks=None):
        self.binaries = os.path.abspath(binaries)
        self.threads = threads
        self.folder = tempfile.mkdtemp(prefix="landfall-faults-")
        os.chmod(self.folder, 0o755)
        self.inputs, self.out = os.path.join(self.folder, "in"), os.path.join(self.folder, "out")
        os.mkdir(self.inputs)
        for name, config in CONFIGS.items():
            with open(os.path.join(self.inputs, name + ".json"), "w", encoding="utf-8") as file:
                json.dump(config, file)
        self.make_inputs()
        self.whole, self.stdout, self.seconds = {}, {}, {}
        for one in tasks or TASKS:
            self.record_undisturbed(one)

    def make_inputs(self):
        for label in ("terrain-gen .h5", "terrain-gen .tif", "terrain-gen .ply", "scan-sim", "regrid", "dem-eval --metrics --report"):
            one = next(each for each in TASKS if each.label == label)
            run = self.run(one)
            if run.code != 0:
                raise RuntimeError(f"{label}: {run.stderr}")
            shutil.copy(os.path.join(self.out, one.outputs[0]), self.inputs)

    def record_undisturbed(self, one):
        times = []
        for _ in range(self.rounds):
            start = time.perf_counter()
            run = self.run(one)
            times.append(time.perf_counter() - start)
        if (run.code, run.stderr, sorted(run.files)) != (0, "", sorted(one.outputs)):
            raise RuntimeError(f"{one.label}: exit {run.code}: {run.stderr} {sorted(run.files)}")
        self.whole[one], self.stdout[one], self.seconds[one] = run.files, run.stdout, sorted(times)[len(times) // 2]

    def command(self, one, old=False):
        words = [word.replace("{in}", self.inputs).replace("{out}", self.out) for word in one.arguments]
        return [os.path.join(self.binaries, words[0]), *words[1:], "-t", str(self.threads), *(["-O"] if old and one.outputs else [])]

    def prepare(self, one, old=False):
        """Makes an empty folder of outputs, or one with an old file for each output."""
        if os.path.isdir(self.out):
            for entry in os.scandir(self.out):
                shutil.rmtree(entry.path) if entry.is_dir(follow_symlinks=False) else os.remove(entry.path)
        else:
            os.mkdir(self.out)
        for name in one.outputs if old else ():
            with open(os.path.join(self.out, name), "wb") as file:
                file.write(OLD)

    def start(self, one, old=False, prefix=(), **options):
        options = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "cwd": self.folder, **options}
        return subprocess.Popen([*prefix, *self.command(one, old)], **options)

    def finish(self, process):
        try:
            stdout, stderr = process.communicate(timeout=MAX_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            return Run(HANGS, b"", "hangs", files_of(self.out))
        return Run(process.returncode, stdout or b"", (stderr or b"").decode(errors="replace"), files_of(self.out))

    def run(self, one, old=False, **options):
        self.prepare(one, old)
        return self.finish(self.start(one, old, **options))

    def open_to_all(self):
        """Allows any user to write to the folder of outputs."""
        os.chmod(self.out, 0o777)

    def remove(self):
        shutil.rmtree(self.folder)


def no_core():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def is_one_message(one, text):
    return re.fullmatch(rf"{one.tool}: [^\n]+\n", text) is not None and "internal error" not in text


class Judge:
    """Checks runs of one kind of fault against the guarantees, and counts how they ended."""

    def __init__(self, workshop, fault):
        self.workshop = workshop
        self.fault = fault
        self.counts = collections.Counter()
        self.broken = []
        self.messages = collections.Counter()

    def states(self, one, run, old):
        """The state of each output: new, old or none; anything else violates a guarantee and is described in words."""
        def state(name):
            content = run.files.get(name)
            if content == self.workshop.whole[one][name]:
                return "new"
            if content is None:
                return "none" if not old else "LOST"
            return "old" if old and content == OLD else "PARTIAL"
        return [state(name) for name in one.outputs]

    def faults_of(self, one, run, old, ended_by, parts_may_stay):
        states = self.states(one, run, old)
        faults = [f"an output is {state}" for state in set(states) & {"LOST", "PARTIAL"}]
        faults += [f"left behind: {name}" for name in set(run.files) - set(one.outputs)
                   if not (parts_may_stay and PART.match(name) and PART.match(name)["name"] in one.outputs)]
        if run.code == 0:
            faults += [f"exit 0, but an output is {state}" for state in set(states) - {"new"}]
            faults += ["stderr is not empty"] if run.stderr else []
            faults += ["stdout is incomplete"] if run.stdout != self.workshop.stdout[one] else []
        elif run.code in (1, 2):
            faults += [] if is_one_message(one, run.stderr) else ["not one message"]
            faults += ["exit 1 or 2, but an output is new"] if "new" in states[self.renamed_before(one, run):] else []
        elif run.code == -ended_by:
            faults += [] if run.stderr in ("", f"{one.tool}: interrupted, no output was written\n") else ["not one message"]
            if run.stderr and "new" in states:
                faults.append("says that no output was written, but one is new")
            elif len(set(states[self.renamed_before(one, run):])) > 1 and not parts_may_stay:
                faults.append("some outputs are new, others not")
        else:
            faults.append("a wrong exit code")
        return faults

    @staticmethod
    def renamed_before(one, run):
        """How many outputs may be new although the run failed."""
        if run.stderr.endswith("writing to standard output failed\n"):
            return len(one.outputs)
        if "--view" in one.arguments:  # the picture is made from the output, which is already complete
            return 1
        # Several outputs are renamed one after the other.
        return len(one.outputs) - 1 if "renaming failed" in run.stderr else 0

    def take(self, one, run, *, old=False, ended_by=0, parts_may_stay=False, how=""):
        """Counts a run and returns whether it kept all guarantees."""
        faults = self.faults_of(one, run, old, ended_by, parts_may_stay)
        self.counts["runs"] += 1
        self.counts["whole" if run.code == 0 else "refused" if run.code in (1, 2) else "ended"] += 1
        self.counts["parts"] += bool(run.parts)
        if run.stderr:
            self.messages[self.plain(run.stderr)] += 1
        if faults:
            self.broken.append(f"{self.fault}: {one.label}{' -O' if old else ''} {how}: {'; '.join(sorted(faults))} "
                               f"(exit {run.code}, {sorted(run.files)}, {run.stderr!r})")
            print("BROKEN", self.broken[-1], flush=True)
        return not faults

    def plain(self, message):
        text = message.replace(self.workshop.inputs, "IN").replace(self.workshop.out, "OUT").replace(self.workshop.folder, "FOLDER")
        return re.sub(r"\.[0-9a-f]{8}-\d+\.part", ".PLACE-PID.part", text.strip())
