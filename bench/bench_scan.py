#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Times whole scan-sim runs with 1, 10 and 100 times the pulses, in one table with their peak memory.

  bench/bench_scan.py [--bin build/release/bin] [--folder DIR] [--detector 18] [--factors 1 10 100] [--threads N] [--pairs N]

The scan is the paper's Example 2 (studies/paper-like.scan.json, sigma 5/3 cm) with a detector of N x N pixels over the
same field of view; more pulses come from a higher pulse rate, so that the scan stays the same. Beside each run stand
what a plain dd of its file takes, the wall time over 2 s + dd, and the redraw of its errors by --ranges-from, with
the ratio of the two runs' CPU times. --pairs N traces and redraws in turns and prints medians, that of the ratio
pair by pair. Files are deleted as soon as they are measured: at 18 x 18 pixels a factor of 1 takes 1 GB, of 10 10 GB.

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
SCAN = os.path.join(ROOT, "studies", "paper-like.scan.json")
TERRAIN = os.path.join(ROOT, "studies", "presets", "paper.terrain.json")
FIELD_OF_VIEW = 1.6e-3  # rad, edge to edge
PULSE_RATE_HZ = 20000
SCAN_TIME_S = 2


def run(*arguments):
    """Runs a command that must succeed; its stdout."""
    result = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{arguments[0]} failed ({result.returncode}): {result.stderr.strip()}")
    return result.stdout


def summary(tool, *arguments):
    return json.loads(run(tool, *arguments, "-O", "--json"))


def dd_seconds(path):
    """A plain copy of the bytes, into a new file."""
    copy = path + ".copy"
    begin = time.monotonic()
    run("dd", f"if={path}", f"of={copy}", "bs=1M", "status=none")
    seconds = time.monotonic() - begin
    os.remove(copy)
    return seconds


def scan_options(detector, factor):
    return ["-c", SCAN, "--set", f"detector.rows={detector}", "--set", f"detector.columns={detector}",
            "--set", f"detector.ifov_rad={FIELD_OF_VIEW / detector!r}", "--set", "noise.range_sigma_m=0.016666666666666666",
            "--set", f"laser.pulse_rate_hz={PULSE_RATE_HZ * factor}", "--set", f"laser.scan_time_s={SCAN_TIME_S}"]


def measure(scan_sim, folder, options, threads, pairs):
    scan, redrawn = os.path.join(folder, "scan.h5"), os.path.join(folder, "redrawn.h5")
    row = {"traced": [], "redrawn": []}
    for _ in range(pairs):
        row["traced"].append(summary(scan_sim, *options, "--terrain", os.path.join(folder, "terrain.h5"), "-o", scan,
                                     "-t", threads))
        row["redrawn"].append(summary(scan_sim, *options, "--seed", "2", "--ranges-from", scan, "-o", redrawn,
                                      "-t", threads))
    row |= {"bytes": os.path.getsize(scan), "dd_s": dd_seconds(scan)}
    os.remove(scan)
    os.remove(redrawn)
    return row


def median(runs, key):
    return statistics.median(run[key] for run in runs)


def print_row(detector, factor, row):
    traced, redrawn = row["traced"], row["redrawn"]
    wall = median(traced, "wall_s")
    ratio = statistics.median(old["cpu_s"] / new["cpu_s"] for old, new in zip(traced, redrawn))
    print(f"{detector:3} x {detector:<3} {traced[0]['pulse_count']:9} {traced[0]['ray_count'] / 1e6:8.2f} "
          f"{wall:7.2f} {median(traced, 'cpu_s'):7.2f} {median(traced, 'rays_per_s') / 1e6:7.2f} "
          f"{median(traced, 'real_time_factor'):6.2f} {median(traced, 'peak_memory_bytes') / 1e6:6.0f} "
          f"{row['bytes'] / 1e6:8.0f} {row['dd_s']:6.2f} {wall / (SCAN_TIME_S + row['dd_s']):6.2f} "
          f"{median(redrawn, 'wall_s'):8.2f} {median(redrawn, 'cpu_s'):7.2f} "
          f"{median(redrawn, 'peak_memory_bytes') / 1e6:6.0f} {ratio:6.2f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=os.path.join(ROOT, "build", "release", "bin"), help="folder of the tools")
    parser.add_argument("--folder", default=None, help="where the files go for a while; default: the system's own")
    parser.add_argument("--detector", type=int, default=18, help="pixels along one side")
    parser.add_argument("--factors", type=int, nargs="+", default=[1, 10], help="times the pulses of Example 2")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--pairs", type=int, default=1, help="traced and redrawn runs of each, in turns")
    options = parser.parse_args()
    scan_sim = os.path.join(options.bin, "scan-sim")
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        summary(os.path.join(options.bin, "terrain-gen"), "-c", TERRAIN, "-o", os.path.join(folder, "terrain.h5"))
        print("detector     pulses   M rays  wall s   CPU s M ray/s   x r.t.    MB  file MB   dd s /(2+dd) redraw s   CPU s     MB  ratio")
        for factor in options.factors:
            print_row(options.detector, factor,
                      measure(scan_sim, folder, scan_options(options.detector, factor), options.threads,
                              options.pairs))


if __name__ == "__main__":
    main()
