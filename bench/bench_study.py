#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How long the planning of 5,000 cases, `make -n` on them and the start of one recipe take.

  bench/bench_study.py [--bin build/release/bin] [--cases 5000]
"""
import argparse
import json
import os
import resource
import subprocess
import tempfile
import time

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")


def timed(name, command, **options):
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, **options)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{name:<28} {wall:6.2f} s  {cpu:6.2f} s of CPU")


def write_study(folder, cases):
    """50 values of the noise, and as many draws of noise and velocity error as make up the cases."""
    tree = {"axes": [{"key": "scan.noise.range_sigma_m", "linspace": [0.001, 0.05, 50]}],
            "repeat": {"count": max(1, cases // 50),
                       "draws": {"scan.navigation_error.velocity_mps": {"normal": [0.1, 0.1, 0.1]}}}}
    path = os.path.join(folder, "many.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(tree, file)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin")
    parser.add_argument("--cases", type=int, default=5000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="landfall-bench-") as folder:
        study = write_study(folder, options.cases)
        make = ["make", "-f", "Makefile.studies", f"STUDY={study}", f"BIN={options.bin}", f"RUNS={folder}"]
        timed("plan", [*make, "study-plan"], cwd=ROOT)
        os.utime(study)
        timed("plan again, nothing new", [*make, "study-plan"], cwd=ROOT)
        timed("make -n", [*make, "-n", "study-results"], cwd=ROOT)
        timed("status", [*make, "study-status"], cwd=ROOT)
        one = os.path.join(folder, "one")
        for name in ("", "log", "metrics"):
            os.mkdir(os.path.join(one, name))
        with open(os.path.join(one, "targets.txt"), "w", encoding="utf-8"):
            pass
        made = os.path.join(one, "metrics", "x.json")
        timed("run-stage around echo", ["studies/runners/run-stage", "--study", one, "--kind", "metrics", "--id", "x", "--output", made, "--",
                                        "bash", "-c", f"echo x > {made}"], cwd=ROOT)


if __name__ == "__main__":
    main()
