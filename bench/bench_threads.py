#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Times the tools and runs of draws with 1, 2, 4, 8 and 16 threads, as many as the machine has cores: speed-up and serial share.

  bench/bench_threads.py [--bin build/release/bin] [--folder DIR] [--turns 3] [--draws 12] [--landings 12] [--works NAME ...] [--threads N ...]

The scan is the paper's Example 2. A turn runs each work with each number of threads, one after the other; the best of the turns counts. The
times are those of the whole tool, and of the phase "draw" for draws, whose runs also read a scan and write maps once. The column "of processes" is
the speed-up of as many processes of one thread at once, which share nothing: what the machine allows. The serial share is that of Amdahl's law,
T(n) = T(1) (s + (1 - s) / n), by least squares of T; "idle" is the share of the threads' time in which they do not run, by their CPU time; on
a virtual machine also what the hypervisor takes. GB/s is an estimate, not a measurement, because most machines count no transfers of memory:
it divides by the wall time the bytes that the work passes at least, BYTES in this script. A copy of 256 MB by as many processes shows how much the
machine can move. Files take 1.3 GB for a while, and 0.5 GB for each further process.

Prints times as they are: measure on a machine that does nothing else.
"""
import argparse
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

from bench_draws import NOISE, PRESETS, ROOT, SIGMA_MPS, VELOCITY

STUDIES = os.path.join(ROOT, "studies")
RAYS, BINS = 12.96e6, 2001.0**2
VARY = {f"scan.{VELOCITY}{axis}": {"type": "normal", "sigma": SIGMA_MPS} for axis in range(3)}
# Sums of bins are cleared, added to and read (80 bytes each), layers of a DEM and their footprints written and read, maps of draws added to.
BYTES = {"scan-sim": 90 * RAYS, "regrid": 60 * RAYS + 400 * BINS, "dem-eval": 250 * BINS, "hazard-map": 150 * BINS,
         "verdict": 110 * RAYS + 550 * BINS, "full": 110 * RAYS + 900 * BINS, "traced": 110 * RAYS + 400 * BINS}


class Bench:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, words, threads=0, processes=1):
        """The summary of each of so many processes at once, which write files of their own and must succeed."""
        output = words.index("-o") + 1
        running = []
        for i in range(processes):
            own = [*words[:output], words[output].replace(".h5", f"-{i}.h5") if i else words[output], *words[output + 1:]]
            command = [os.path.join(self.options.bin, own[0]), *own[1:], "-O", "--json", "-t", str(threads)]
            running.append(subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True))
        printed = [process.communicate() for process in running]
        for process, (_, message) in zip(running, printed):
            if process.returncode != 0:
                sys.exit(f"{' '.join(process.args)}\nexit {process.returncode}: {message}")
        return [json.loads(text) for text, _ in printed]

    def slowest(self, words, threads, processes):
        """Its wall and CPU seconds and peak bytes."""
        parts = [(summary["phases"]["draw"] if words[0] == "monte-carlo" else summary, summary) for summary in self.run(words, threads, processes)]
        return max((part["wall_s"], part["cpu_s"], summary["peak_memory_bytes"]) for part, summary in parts)

    def config(self, name, **values):
        with open(self.path(name), "w", encoding="utf-8") as file:
            json.dump(values, file)
        return self.path(name)

    def works(self):
        """{name: words of the command}."""
        scan, terrain, dem = (self.path(name) for name in ("scan.h5", "terrain.h5", "dem.h5"))
        replayed = {"draws": self.options.draws, "scan": {"noise": NOISE}, "vary": VARY}
        traced = {"draws": self.options.draws, "scan": ["preset:paper", {"noise": NOISE}], "vary": VARY, "metrics": "verdict", "layers": False}
        over = ["monte-carlo", scan, "--terrain", terrain, "-o", self.path("draws.h5"), "-c"]
        landings = [word for name in ("landing", "landings") for word in ("-c", os.path.join(STUDIES, name + ".draws.json"))]
        return {"scan-sim": ["scan-sim", "-c", os.path.join(PRESETS, "paper.scan.json"), "--terrain", terrain, "-o", scan],
                "regrid": ["regrid", scan, "--terrain", terrain, "-o", dem],
                "dem-eval": ["dem-eval", dem, "-o", self.path("eval.h5")],
                "hazard-map": ["hazard-map", dem, "--terrain", terrain, "-o", self.path("hazards.h5")],
                "verdict": [*over, self.config("verdict.json", **replayed, metrics="verdict")],
                "full": [*over, self.config("full.json", **replayed, metrics="full")],
                "traced": ["monte-carlo", "--terrain", terrain, "-o", self.path("draws.h5"), "-c", self.config("traced.json", **traced)],
                "landings": ["monte-carlo", *landings, "--set", f"draws={self.options.landings}", "-o", self.path("draws.h5")]}

    def measure(self):
        """{work: {(threads, processes): the best of slowest()}}, with as many processes of one thread as threads."""
        works = self.works()
        best = {name: {} for name in self.options.works or works}
        self.run(["terrain-gen", "-c", os.path.join(PRESETS, "paper.terrain.json"), "-o", self.path("terrain.h5")])
        for name in ("scan-sim", "regrid"):
            self.run(works[name])
        for _ in range(self.options.turns):
            for name, rows in best.items():
                for threads in self.options.threads:
                    for key in {(threads, 1), (1, threads)}:
                        row = self.slowest(works[name], *key)
                        rows[key] = min(rows.get(key, row), row)
        return best


def copy_often(seconds):
    """Copies 256 MB again and again; bytes a second, read and written."""
    source = np.ones(1 << 25)
    target, count, begin = np.empty_like(source), 0, time.monotonic()
    while time.monotonic() - begin < seconds:
        np.copyto(target, source)
        count += 1
    return 2 * source.nbytes * count / (time.monotonic() - begin)


def copied_by(processes):
    with multiprocessing.Pool(processes) as pool:
        return sum(pool.map(copy_often, [2] * processes, chunksize=1))


def serial_share(wall):
    """The share s by least squares of {threads: seconds}, with T(1) as measured."""
    x = np.array([(1 - 1 / n) * wall[1] for n in wall])
    y = np.array([seconds - wall[1] / n for n, seconds in wall.items()])
    return max(0.0, float(x @ y / (x @ x)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=os.path.join(ROOT, "build", "release", "bin"), help="folder of the tools")
    parser.add_argument("--folder", default=None, help="where the files go for a while; default: the system's own")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--draws", type=int, default=12)
    parser.add_argument("--landings", type=int, default=12)
    parser.add_argument("--works", nargs="+", default=None, help="default: all")
    parser.add_argument("--threads", type=int, nargs="+", default=[n for n in (1, 2, 4, 8, 16) if n <= (os.cpu_count() or 1)])
    options = parser.parse_args()
    if options.threads[:1] != [1] or len(options.threads) < 2:
        sys.exit("--threads: begin with 1, and give more than one number")
    with tempfile.TemporaryDirectory(prefix="landfall-threads-", dir=options.folder) as folder:
        best = Bench(options, folder).measure()
    counts = {"verdict": options.draws, "full": options.draws, "traced": options.draws, "landings": options.landings}
    print("| work | threads | s | CPU s | speed-up | of processes | serial share | idle | peak GB | GB/s, estimated |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, rows in best.items():
        share = serial_share({threads: rows[threads, 1][0] for threads in options.threads})
        for threads in options.threads:
            wall, cpu, peak = rows[threads, 1]
            alone = rows[1, 1][0]
            moved = f"{BYTES[name] * counts.get(name, 1) / wall / 1e9:.1f}" if name in BYTES else ""
            print(f"| {name} | {threads} | {wall:.2f} | {cpu:.2f} | {alone / wall:.2f} | {threads * alone / rows[1, threads][0]:.2f} | "
                  f"{f'{100 * share:.0f} %' if threads > 1 else ''} | {100 * (1 - cpu / (threads * wall)):.1f} % | "
                  f"{peak / 1e9:.2f} | {moved} |", flush=True)
    for threads in options.threads:
        print(f"copy by {threads}: {copied_by(threads) / 1e9:.1f} GB/s")


if __name__ == "__main__":
    main()
