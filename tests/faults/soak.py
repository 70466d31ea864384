#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs thousands of small chains and checks that memory does not grow, nothing is left behind, and results do not change.

    tests/faults/soak.py --bin build/release/bin --chains 10000

A chain is terrain-gen, scan-sim, regrid and dem-eval. Its seed is repeated every `--seeds` chains, alternately with one thread and
with two; equal seeds must give equal bytes. The program checks exit codes, stderr, files left behind, shared memory and semaphores
of this machine, and peak memory and CPU time of each process. It prints the numbers of docs/quality/tests.md; the exit code
is 1 if one is wrong.
"""
import argparse
import collections
import hashlib
import json
import os
import shutil
import sys
import tempfile
import time

# numpy is imported only at the end, because the peak memory of a process includes that of the process that started it.

TOOLS = ("terrain-gen", "scan-sim", "regrid", "dem-eval")
CONFIGS = {
    "terrain-gen": {"grid": {"half_width_m": 3, "resolution_m": 0.1},
                    "base": {"type": "fractal", "rms_deviation_m": 0.05, "reference_length_m": 1}},
    "scan-sim": {"detector": {"rows": 8, "columns": 8, "ifov_rad": 0.0011},
                 "laser": {"pulse_rate_hz": 2000, "scan_time_s": 0.05},
                 "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": 10, "columns": 10, "half_width_m": 2}},
                 "trajectory": {"type": "constant_velocity", "position_m": [0, 0, 50], "velocity_mps": [0, 0, -5]},
                 "noise": {"range_sigma_m": 0.01}},
    "regrid": {"resolution_m": 0.1, "half_width_m": 2.5},
    "dem-eval": {"region_radius_m": 2, "footprint_m": 0.5},
}
OUTPUTS = {"terrain-gen": ["terrain.h5"], "scan-sim": ["scan.h5"], "regrid": ["dem.h5"], "dem-eval": ["eval.h5", "metrics.json"]}


class Soak:
    """One folder in which each chain overwrites the files of the previous one, and the measurements of all processes."""

    def __init__(self, options):
        self.options = options
        self.folder = tempfile.mkdtemp(prefix="landfall-soak-")
        for name, config in CONFIGS.items():
            with open(self.path(name + ".json"), "w", encoding="utf-8") as file:
                json.dump(config, file)
        self.expected = sorted([name + ".json" for name in TOOLS] + ["stderr"] + sum(OUTPUTS.values(), []))
        self.digests = {}
        self.memory_kb = {name: [] for name in TOOLS}
        self.cpu_s = {name: [] for name in TOOLS}
        self.wrong = collections.Counter()
        self.compared = 0

    def path(self, name):
        return os.path.join(self.folder, name)

    def arguments(self, name, chain):
        inputs = {"terrain-gen": [], "scan-sim": ["--terrain", self.path("terrain.h5")],
                  "regrid": [self.path("scan.h5"), "--terrain", self.path("terrain.h5")], "dem-eval": [self.path("dem.h5")]}
        seed = ["--seed", str(1 + chain % self.options.seeds)] if name in TOOLS[:2] else []
        metrics = ["--metrics", self.path("metrics.json")] if name == "dem-eval" else []
        threads = 1 + chain // self.options.seeds % 2
        return [*inputs[name], "-c", self.path(name + ".json"), "-O", "-t", str(threads), *seed, *metrics,
                "-o", self.path(OUTPUTS[name][0])]

    def run_tool(self, name, chain):
        program = os.path.join(self.options.bin, name)
        errors = self.path("stderr")
        pid = os.posix_spawn(program, [name, *self.arguments(name, chain)], os.environ, file_actions=[
            (os.POSIX_SPAWN_OPEN, 1, errors, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), (os.POSIX_SPAWN_DUP2, 1, 2)])
        _, status, usage = os.wait4(pid, 0)
        self.memory_kb[name].append(usage.ru_maxrss)
        self.cpu_s[name].append(usage.ru_utime + usage.ru_stime)
        self.wrong["exit codes"] += status != 0
        self.wrong["lines on stdout or stderr"] += os.path.getsize(errors) != 0

    def digest(self):
        digest = hashlib.blake2b(digest_size=16)
        for name in sum(OUTPUTS.values(), []):
            with open(self.path(name), "rb") as file:
                digest.update(file.read())
        return digest.digest()

    def run_chain(self, chain):
        for name in TOOLS:
            self.run_tool(name, chain)
        self.wrong["files left over or missing"] += sorted(os.listdir(self.folder)) != self.expected
        seed = chain % self.options.seeds
        first = self.digests.setdefault(seed, digest := self.digest())
        self.compared += chain >= self.options.seeds
        self.wrong["results that changed"] += first != digest


def shared_objects():
    """Names in /dev/shm (POSIX shared memory and semaphores) and lines of the System V tables."""
    names = set(os.listdir("/dev/shm")) if os.path.isdir("/dev/shm") else set()
    for table in ("shm", "sem", "msg"):
        with open(f"/proc/sysvipc/{table}", encoding="utf-8") as file:
            names.update(table + " " + " ".join(line.split()[:2]) for line in file.readlines()[1:])
    return names


def trend(values):
    """(slope, its standard error) of a straight line through the values, per 1,000."""
    import numpy as np  # pylint: disable=import-outside-toplevel
    x = np.arange(len(values)) / 1000
    slope, at_zero = np.polyfit(x, values, 1)
    residuals = values - (slope * x + at_zero)
    return slope, np.sqrt(np.sum(residuals**2) / max(1, len(values) - 2) / np.sum((x - x.mean())**2))


def rows(soak):
    """The table, with a line per tool."""
    import numpy as np  # pylint: disable=import-outside-toplevel
    lines = ["| tool | runs | peak memory, median of the first and last tenth | growth per 1,000 runs | CPU, the same medians |",
             "|---|---|---|---|---|"]
    for name in TOOLS:
        memory, cpu = np.array(soak.memory_kb[name]) / 1024, np.array(soak.cpu_s[name]) * 1000
        tenth = max(1, len(memory) // 10)
        first, last = np.median(memory[:tenth]), np.median(memory[-tenth:])
        slope, error = trend(memory)
        lines.append(f"| {name} | {len(memory):,} | {first:.1f} MB, {last:.1f} MB | {slope:+.3f} ± {error:.3f} MB | "
                     f"{np.median(cpu[:tenth]):.0f} ms, {np.median(cpu[-tenth:]):.0f} ms |")
    return lines


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folder of the tools")
    parser.add_argument("--chains", type=int, default=10000)
    parser.add_argument("--seconds", type=float, default=86400, help="stop after so long")
    parser.add_argument("--seeds", type=int, default=500, help="a seed comes again after so many chains")
    return parser.parse_args(arguments)


def main(arguments):
    soak = Soak(parse(arguments))
    before, start = shared_objects(), time.time()
    done = 0
    while done < soak.options.chains and time.time() < start + soak.options.seconds:
        soak.run_chain(done)
        done += 1
        if done % 100 == 0:
            print(f"{done} chains, {time.time() - start:.0f} s, wrong: {dict(+soak.wrong)}", file=sys.stderr, flush=True)
    left = sorted(shared_objects() - before)  # some may belong to other programs, which their names show
    soak.wrong["shared memory or semaphores left"] = len(left)
    shutil.rmtree(soak.folder)
    print(f"{done:,} chains, {4 * done:,} processes, {time.time() - start:.0f} s; "
          f"{soak.compared:,} chains compared with an earlier one of the same seed.\n")
    print("\n".join(rows(soak)) + "\n")
    for what, count in soak.wrong.items():
        print(f"{what}: {count}")
    for name in left:
        print("left:", name)
    return 1 if +soak.wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
