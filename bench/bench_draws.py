#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Times runs of monte-carlo, `verdict` and `full`, against the chain of the tools, in turns, with their peak memory.

  bench/bench_draws.py [--bin build/release/bin] [--folder DIR] [--draws 30] [--chain 3] [--turns 3] [--threads 2]

The scan is the paper's Example 2 with range noise, dropouts, dead pixels and three varied velocity errors. A turn runs
a run of draws of each kind and makes --chain draws by scan-sim --ranges-from, regrid and dem-eval --metrics-only. The time
of a run of draws is that of the whole program by its draws, reading the scan and writing the maps included. Prints each
turn, and medians. Files take 1.3 GB for a while.

Prints times as they are: measure on a machine that does nothing else.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PRESETS = os.path.join(ROOT, "studies", "presets")
NOISE = {"range_sigma_m": 0.016666666666666666, "dropout_frac": 0.01, "dead_pixel_frac": 0.01}
VELOCITY = "navigation_error.velocity_mps."
SIGMA_MPS = 0.1


class Bench:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, tool, *arguments):
        """Runs a tool that must succeed; its seconds and its peak memory in bytes."""
        command = [os.path.join(self.options.bin, tool), *map(str, arguments), "-O", "-t", str(self.options.threads)]
        begin = time.monotonic()
        with tempfile.TemporaryFile() as errors, subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            if process.returncode != 0:
                errors.seek(0)
                sys.exit(f"{' '.join(command)}\nexit {process.returncode}: {errors.read().decode()}")
        return time.monotonic() - begin, usage.ru_maxrss * 1024

    def prepare(self):
        self.run("terrain-gen", "-c", os.path.join(PRESETS, "paper.terrain.json"), "-o", self.path("terrain.h5"))
        self.run("scan-sim", "-c", os.path.join(PRESETS, "paper.scan.json"), "--terrain", self.path("terrain.h5"), "-o", self.path("scan.h5"))

    def run_draws(self, metrics):
        """Seconds a draw, peak memory."""
        vary = {f"scan.{VELOCITY}{axis}": {"type": "normal", "sigma": SIGMA_MPS} for axis in range(3)}
        with open(self.path("mc.json"), "w", encoding="utf-8") as file:
            json.dump({"draws": self.options.draws, "metrics": metrics, "scan": {"noise": NOISE}, "vary": vary}, file)
        seconds, peak = self.run("monte-carlo", self.path("scan.h5"), "--terrain", self.path("terrain.h5"), "-c", self.path("mc.json"),
                                 "-o", self.path("draws.h5"))
        return seconds / self.options.draws, peak

    def chain(self):
        """The same for draws by the tools, each with other values."""
        errors = [word for key, value in NOISE.items() for word in ("--set", f"noise.{key}={value!r}")]
        seconds, peaks = 0.0, []
        for draw in range(self.options.chain):
            values = [word for axis in range(3) for word in ("--set", f"{VELOCITY}{axis}={SIGMA_MPS * (draw - axis)!r}")]
            for command in (["scan-sim", "-c", os.path.join(PRESETS, "paper.scan.json"), *errors, *values, "--set", f"draw={draw}", "--ranges-from",
                             self.path("scan.h5"), "-o", self.path("drawn.h5")],
                            ["regrid", self.path("drawn.h5"), "--terrain", self.path("terrain.h5"), "-o", self.path("dem.h5")],
                            ["dem-eval", self.path("dem.h5"), "--metrics-only", "--metrics", self.path("metrics.json")]):
                took, peak = self.run(*command)
                seconds += took
                peaks.append(peak)
        return seconds / self.options.chain, max(peaks)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=os.path.join(ROOT, "build", "release", "bin"), help="folder of the tools")
    parser.add_argument("--folder", default=None, help="where the files go for a while; default: the system's own")
    parser.add_argument("--draws", type=int, default=30, help="of a campaign")
    parser.add_argument("--chain", type=int, default=3, help="draws by the tools in a turn")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="landfall-draws-", dir=options.folder) as folder:
        bench = Bench(options, folder)
        bench.prepare()
        ways = {"verdict": lambda: bench.run_draws("verdict"), "full": lambda: bench.run_draws("full"), "chain": bench.chain}
        rows = {way: [] for way in ways}
        print("                s a draw  draws/s  peak GB")
        for _ in range(options.turns):
            for way, measure in ways.items():
                rows[way].append(measure())
                print_row(way, rows[way][-1:])
        for way, row in rows.items():
            print_row("median " + way, row)
        chain = statistics.median(seconds for seconds, _ in rows["chain"])
        for way in ("verdict", "full"):
            print(f"chain / {way}: {chain / statistics.median(seconds for seconds, _ in rows[way]):.1f}")


def print_row(label, row):
    seconds = statistics.median(seconds for seconds, _ in row)
    print(f"{label:15} {seconds:6.2f} {1 / seconds:8.2f} {max(peak for _, peak in row) / 1e9:8.2f}", flush=True)


if __name__ == "__main__":
    main()
