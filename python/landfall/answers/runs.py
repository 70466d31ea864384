# SPDX-License-Identifier: GPL-3.0-or-later
# Results are kept by content, and refusals only where the configuration is to blame (exit code 2). Exit code 1 may come
# from a full disk: such a row is NaN in this call and is tried again in the next one. A tool that was killed ends the
# call. What exists only during a run is in a folder whose lock a killed run loses, so that the next one removes it.
"""Runs of the tools for model.py and design.py: one DEM through the chain, or many draws of one traced scan.

Results are kept in `folder`/cache under the hash of all that they depend on: an interrupted run resumes, equal work is done
once, and the answer does not depend on what was there before.
"""
import contextlib
import copy
import fcntl
import itertools
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import weakref

from landfall import command, files, scan_keys, schema, tools
from landfall.errors import DataError, Error, printable, ToolError, UsageError
from landfall.study import results, stages
from landfall.study.model import config_path, read_config, resolved, TOOLS

STAGES = tuple(stage for stage in TOOLS if stage != "draws")
REFUSALS = (1, 2)  # exit codes of a tool that refuses its input; any other code, such as that of a killed tool, does not blame the input
NOT_JUDGED = -1  # in the column `pass` of draws
_in_memory = itertools.count(1)
LARGEST_HELD = 2**26  # bytes of a terrain that stays in memory
PART_DRAWS = 32  # of one run of monte-carlo: what is lost at most where a run is killed


def read_base(tree, folder, name, where="/base"):
    """{stage: resolved configuration}. Each is given as an object, the name of its file in `folder`, preset:NAME, or a list of these.

    All defaults are filled in by the tools, so that every key has a value. `hazard` is there only if it is given.
    """
    for stage in tree:
        if stage not in STAGES:
            raise UsageError(f"{name}: {where}/{stage}: unknown key; the stages are {', '.join(STAGES)}")
    return {stage: _read_stage(tree.get(stage, {}), stage, folder, f"{name}: {where}/{stage}") for stage in STAGES if stage != "hazard" or stage in tree}


def _read_stage(given, stage, folder, where):
    place = f"{config_path(given, stage, folder)}: " if isinstance(given, str) else where
    return resolved(stage, read_config(given, stage, folder, where), place)


def is_redrawn(key, scan):
    """Whether a key of this scan changes errors alone, so that monte-carlo redraws it over the traced rays."""
    stage, *path = key.split(".")
    return stage == "scan" and path not in (["seed"], ["draw"]) and bool(path) and scan_keys.effect_of(*path, scan=scan) == "estimate"


def needs_chain(scan):
    """Whether a scan's errors cannot be redrawn: random numbers move the beams, or the receiver needs whole waveforms."""
    receiver = scan.get("receiver", {})
    return scan_keys.is_beam_drawn(scan) or receiver.get("type") == "geiger" or receiver.get("returns") == "all"


def truth_of(scan):
    """The scan that is traced for a run of draws."""
    echoes = scan_keys.part(scan, ("echo",)) if stages.has_receiver(scan) else {}
    return {**stages.truth_config(scan), **echoes}


def locked(folder):
    """The locked file of a run's folder; None while its run holds it."""
    file = open(os.path.join(folder, "lock"), "w", encoding="utf-8")  # pylint: disable=consider-using-with
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.close()
        return None
    return file


def _close_scratch(folder, lock):
    shutil.rmtree(folder, ignore_errors=True)
    lock.close()


def is_steady(outcome):
    """Whether an outcome, a tree with "code" if a tool failed, follows from the configuration alone: a tool that ran out of memory or
    disk is checked again."""
    return outcome.get("code", 2) == 2


def add_options(parser, what):
    """The options of a program that runs many tools."""
    parser.add_argument("file", metavar="FILE", help=what)
    parser.add_argument("-o", "--out", metavar="DIR", required=True, help="folder of the results; an interrupted run resumes from it")
    parser.add_argument("--bin", metavar="DIR", help="where the tools are (default: next to this package, or on PATH)")
    parser.add_argument("-j", "--workers", metavar="N", type=int, default=1, help="runs at a time, each with one thread; 1 has all threads (1)")
    parser.add_argument("--runner", metavar="COMMAND", default="", help='command that runs each tool, as "srun -Q -n1 -c1"')


def prepare(options):
    """Checks these options, and returns the prefix of the tools."""
    if options.workers < 1:
        raise UsageError(f"--workers {options.workers}: is not >= 1")
    if options.bin:
        tools.BIN = options.bin
    return shlex.split(options.runner)


def say_cost(line):
    """Prints what a run is about to cost, if that is known."""
    if line:
        print(printable(line), file=sys.stderr, flush=True)


def write_json(path, value):
    command.write_text(path, json.dumps(value, indent=1) + "\n")


class Progress:
    """How far a long run is: one line that is updated on a terminal, else a line for each report.

    Counts steps of a run. Steps that were found done do not enter the estimate of the time that is left."""

    def __init__(self, stream=None):
        self.stream = stream or sys.stderr
        self.live, self._lock = self.stream.isatty(), threading.Lock()
        self.begin, self.shown = time.monotonic(), False
        self.label, self.total, self.count, self.made = "", 0, 0, 0

    def start(self, label, total):
        """A part of the run with `total` steps."""
        self.label, self.total, self.count, self.made = label, total, 0, 0
        self.begin = time.monotonic()

    def step(self, made=1, found=0):
        """Steps that were made now, and such that an earlier run made."""
        with self._lock:
            self.made += made
            self.count += made + found
            self.say(f"{self.count} of {self.total} {self.label}{self._left()}")

    def _left(self):
        left = self.total - self.count
        if not self.made or left <= 0:
            return ""
        seconds = (time.monotonic() - self.begin) / self.made * left
        return f", about {seconds:.0f} s to go" if seconds < 120 else f", about {seconds / 60:.0f} min to go"

    def say(self, text):
        """A line of its own off the terminal."""
        end, self.shown = ("", True) if self.live else ("\n", False)
        text = printable(text)
        print(f"\r\033[K{text}" if self.live else text, end=end, file=self.stream, flush=True)

    def clear(self):
        if self.shown:
            print("\r\033[K", end="", file=self.stream, flush=True)
            self.shown = False


class Silent(Progress):
    """Shows nothing."""

    def say(self, text):
        pass


class Runner:
    """Runs tools in `folder`. `prefix` is a command that runs another one elsewhere, such as ["srun", "-Q", "-n1", "-c1"]: the
    folder must then be shared. `threads` of each tool; 0: all cores, one tool at a time: then it runs in this process, if that can."""

    def __init__(self, folder, threads=0, prefix=()):
        self.folder, self.threads, self.prefix = os.path.abspath(folder), threads, list(prefix)
        self.engine = None if threads or prefix else _engine()
        self.cache = os.path.join(self.folder, "cache")
        os.makedirs(self.cache, exist_ok=True)
        self.scratch = self._open_scratch()
        self.version = tools.run_tool(tools.find("monte-carlo"), "--version").stdout
        self._locks, self._lock, self._terrain = {}, threading.Lock(), None

    def _open_scratch(self):
        """A folder for what exists only during this run; those of killed runs, which hold no lock, are removed."""
        with open(os.path.join(self.folder, ".lock"), "w", encoding="utf-8") as all_runs:
            fcntl.flock(all_runs, fcntl.LOCK_EX)
            for name in os.listdir(self.folder):
                path = os.path.join(self.folder, name)
                lock = locked(path) if name.startswith(".run-") else None
                if lock:
                    _close_scratch(path, lock)
            scratch = tempfile.mkdtemp(dir=self.folder, prefix=".run-")
            weakref.finalize(self, _close_scratch, scratch, locked(scratch))
        return scratch

    def run(self, tool, *arguments, config=None):
        """The text that the tool prints. Throws ToolError, or DataError if it was killed."""
        if self.engine:
            return self._run_here(tool, *arguments, config=config)
        with contextlib.ExitStack() as stack:
            if config is not None:
                file = stack.enter_context(tempfile.NamedTemporaryFile("w", dir=self.scratch, prefix="config-", suffix=".json"))
                json.dump(config, file)
                file.flush()
                arguments = (*arguments, "-c", file.name)
            words = [*self.prefix, tools.find(tool), *arguments, "-q", "-t", self.threads]
            try:
                return tools.run_tool(words[0], *words[1:], stdin=subprocess.DEVNULL).stdout
            except ToolError as error:
                if error.exit_code in REFUSALS:
                    raise ToolError(self._steady(str(error)), error.exit_code) from error
                raise DataError(f"{error}; run the same command again to continue") from error

    def _run_here(self, tool, *arguments, config):
        words = [tool, *map(str, arguments), *([] if config is None else ["-c", "-"]), "-q", "-t", "0"]
        code, message, _, printed = self.engine.run(words, "" if config is None else json.dumps(config), None)
        if code:
            raise ToolError(self._steady(f"{tool}: {message.replace('standard input', 'configuration')}"), code)
        return printed

    def _steady(self, message):
        """The message without names of files that exist only during this run."""
        message = re.sub(re.escape(self.scratch) + r"/config-\w+\.json", "configuration", message)
        return re.sub(re.escape(self.scratch) + r"/(?:\w+-\w+/)?", "", message)

    def place(self, kind, depends, extension):
        """The path at which the result of this kind is kept. Data files that a configuration names count with their size and time."""
        files = []
        for path in sorted(set(stages.data_files(depends))):
            status = os.stat(path)
            files.append([path, status.st_size, status.st_mtime_ns])
        return os.path.join(self.cache, f"{kind}-{stages.short_hash(kind, stages.canonical(depends), stages.canonical(files), self.version)}.{extension}")

    def cached(self, kind, depends, compute, is_kept=lambda result: True):
        """(compute() or its earlier result, a JSON value; whether it is the earlier one). A result that is not kept is computed again
        by the next call."""
        path = self.place(kind, depends, "json")
        if os.path.exists(path):
            return schema.read_json(path), True
        result = compute()
        if is_kept(result):
            write_json(path, result)
        return result, False

    @contextlib.contextmanager
    def alone(self, path):
        """One thread at a time makes a file."""
        with self._lock:
            lock = self._locks.setdefault(path, threading.Lock())
        with lock:
            yield

    def terrain(self, config):
        """The path of a terrain, which is kept."""
        path = self.place("terrain", config, "h5")
        with self.alone(path):
            if not os.path.exists(path):
                self.run("terrain-gen", "-o", path, "-O", config=config)
        return path

    def numbers(self, configs, with_sigma=False):
        """All numbers of one DEM, through the chain: {name of a metric: value or None}."""
        options = ["--uncertainty"] if with_sigma else []
        return self.cached("chain", [*(configs[stage] for stage in configs), *options], lambda: self._chain(configs, options))[0]

    def _chain(self, configs, options):
        terrain = self.terrain(configs["terrain"])
        if self.engine and "hazard" not in configs:
            return self._chain_here(terrain, configs, options)
        with tempfile.TemporaryDirectory(dir=self.scratch, prefix="chain-") as folder:
            scan, dem, metrics, score, sites, hazards = (os.path.join(folder, name) for name in (
                "scan.h5", "dem.h5", "metrics/m.json", "score/s.json", "sites/s.json", "hazards.h5"))
            for path in (metrics, score, sites):
                os.mkdir(os.path.dirname(path))
            self.run("scan-sim", "--terrain", terrain, "-o", scan, config=configs["scan"])
            self.run("regrid", scan, "--terrain", terrain, *options, "-o", dem, config=configs["regrid"])
            self.run("dem-eval", dem, "--metrics", metrics, "--metrics-only", config=configs["eval"])
            found = results.read_result(folder, "metrics/m.json")
            if "hazard" in configs:
                self.run("hazard-map", dem, "--terrain", terrain, "--score", score, "--sites", sites, "-o", hazards, config=configs["hazard"])
                found |= results.read_result(folder, "score/s.json")
            return results.with_own_of_score(found)

    def _chain_here(self, path, configs, options):
        """The same with files in memory."""
        held, scan, dem = self._held(path), *(self.engine.File(f"{next(_in_memory)} {name} of a model.h5") for name in ("scan", "dem"))
        terrain = held.name if held else path
        self.run("scan-sim", "--terrain", terrain, "-o", scan.name, config=configs["scan"])
        self.run("regrid", scan.name, "--terrain", terrain, *options, "-o", dem.name, config=configs["regrid"])
        summary = json.loads(self.run("dem-eval", dem.name, "--metrics-only", "--json", config=configs["eval"]))
        return results.with_own_of_score(results.flatten(summary["metrics"]))

    def _held(self, path):
        """A small terrain in memory, where the last one remains, so that it is checked and read from the disk once; None if it is large."""
        if os.path.getsize(path) > LARGEST_HELD:
            return None
        held = self._terrain  # another thread may replace it
        if held is None or held[0] != path:
            file = self.engine.File(f"{next(_in_memory)} {os.path.basename(path)}")
            file.load(path)
            held = self._terrain = path, file
        return held[1]


def _engine():
    """The library of these tools within this process; None where it is not found."""
    try:
        from landfall import engine
    except Error:
        return None
    return engine if engine.FOLDER == os.path.dirname(os.path.realpath(tools.find("monte-carlo"))) else None


class Draws:
    """Draws of monte-carlo; make_draws() of a subclass makes their file, which depends on the values of `depends`."""

    def rows(self, draws, *arguments, samples=None):
        """The numbers of each draw: [{name: value, None where it has none}]. `samples` are (keys, rows of values)."""
        with tempfile.TemporaryDirectory(dir=self.runner.scratch, prefix="draws-") as folder:
            if samples is not None:
                table = os.path.join(folder, "samples.csv")
                rows = [samples[0], *([repr(float(value)) for value in values] for values in samples[1])]
                command.write_text(table, command.csv_text(rows), is_synced=False)
                arguments = (*arguments, "--samples", table)
            path = os.path.join(folder, "draws.h5")
            self.make_draws(draws, path, *arguments)
            return rows_of(path, check=False)  # nobody else wrote it

    def terrain(self):
        """Makes the terrain that draws share."""

    def make_shared(self):
        """Makes the rays that draws share."""


class TracedDraws(Draws):
    """Draws that trace their own rays. `traced` are keys of monte-carlo's configuration: terrain_seed, uncertainty, landing."""

    def __init__(self, runner, configs, traced):
        self.runner, self.configs, self.traced, self.depends = runner, configs, traced, [configs, traced]

    def make_draws(self, draws, output, *arguments):
        """Writes `output`, the draws with monte-carlo's configuration `draws`."""
        self.runner.run("monte-carlo", "-o", output, "-O", *arguments, config=self.config(draws))

    def config(self, draws):
        """The configuration of monte-carlo. Where each draw has its own terrain, the ground follows the scan's seed, so that draws with fresh
        seeds have fresh terrains."""
        configs = copy.deepcopy(self.configs)
        seed = draws.get("scan", {}).get("seed", configs["scan"]["seed"])
        if self.traced.get("terrain_seed") == "each" and "seed" in configs["terrain"]:
            configs["terrain"]["seed"] += seed - configs["scan"]["seed"]
        configs["scan"]["seed"] = seed
        return {"layers": False, "hazard": None, **configs, **self.traced, **{key: value for key, value in draws.items() if key != "scan"}}

    def varies(self, key, value):
        """Whether draws may have different values of this key."""
        draws = {"draws": 1, "vary": {key: {"type": "list", "values": [value]}}}
        try:
            self.runner.run("monte-carlo", "--check", config=self.config(draws))
        except ToolError:
            return False
        return True

    def done(self):
        """As of a Scan: nothing is kept."""


class Scan(Draws):
    """A scan that is traced without errors when the first user needs it, and removed after the last one."""

    def __init__(self, runner, configs, users):
        self.runner, self.configs, self.users, self.depends = runner, configs, users, [configs]
        truth = truth_of(configs["scan"])
        self.place = os.path.join(runner.scratch, os.path.basename(runner.place("scan", [configs["terrain"], truth], "h5")))
        self._truth, self._lock = truth, threading.Lock()

    def terrain(self):
        return self.runner.terrain(self.configs["terrain"])

    def make_shared(self):
        return self.path()

    def path(self):
        terrain = self.terrain()
        with self.runner.alone(self.place):
            if not os.path.exists(self.place):
                echoes = ["--keep-echoes"] if stages.has_receiver(self.configs["scan"]) else []
                self.runner.run("scan-sim", "--terrain", terrain, "-o", self.place, "-O", *echoes, config=self._truth)
        return self.place

    def done(self):
        """To be called once by each user."""
        with self._lock:
            self.users -= 1
            if self.users == 0 and os.path.exists(self.place):
                os.remove(self.place)

    def make_draws(self, draws, output, *arguments):
        """Writes `output`, the draws over the scan with monte-carlo's configuration `draws`."""
        configs = self.configs
        config = {"layers": False, "regrid": configs["regrid"], "eval": configs["eval"], "hazard": configs.get("hazard"), **draws}
        config["scan"] = {**stages.errors_config(configs["scan"]), **draws.get("scan", {})}
        terrain, scan = self.terrain(), self.path()
        self.runner.run("monte-carlo", scan, "--terrain", terrain, "-o", output, "-O", *arguments, config=config)


def rows_of(path, check=True):
    """The rows of a file of draws: [{name: value, None where it has none}]; `check` as of open_screened()."""
    with files.open_landfall(path, "landfall.draws", check) as file:
        columns = {name: values.tolist() for name, values in files.Columns(file["draws"]).items()}
    columns["pass"] = [None if value == NOT_JUDGED else value for value in columns["pass"]]
    names = list(columns)
    return [{name: None if value != value else value for name, value in zip(names, values)} for values in zip(*columns.values())]
