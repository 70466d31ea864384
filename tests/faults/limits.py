# SPDX-License-Identifier: GPL-3.0-or-later
"""The limits on the size of a run: the largest accepted size, and the message for one beyond it."""
import dataclasses
import json
import os
import subprocess


@dataclasses.dataclass(frozen=True)
class Limit:
    """`largest` and `beyond` are arguments of the tool; {folder} is a folder of small inputs. Without `largest` only the refusal
    is tried, because a run at the limit takes hours or a large disk."""
    what: str
    bound: str
    tool: str
    beyond: str
    largest: str = ""
    code: int = 2


def sets(*pairs):
    return " ".join(f"--set {pair}" for pair in pairs)


LIMITS = [
    Limit("nodes of a terrain", "2^30 (32,767 x 32,767)", "terrain-gen", sets("grid.half_width_m=16384", "grid.resolution_m=1") +
          " -o {folder}/x.h5", sets("grid.half_width_m=16383", "grid.resolution_m=1") + " --check"),
    Limit("bins of a DEM", "2^30", "regrid", "{folder}/scan.h5 " + sets("half_width_m=16384", "resolution_m=1") +
          " -o {folder}/x.h5", "{folder}/scan.h5 " + sets("half_width_m=16383", "resolution_m=1") + " --check"),
    Limit("bins of a plan", "2^30", "scan-sim", "--plan --plan-radius 16384 --plan-resolution 1 -o {folder}/x.h5"),
    Limit("pulses of a scan", "2,147,483,647", "scan-sim", sets("laser.pulse_rate_hz=1e9", "laser.scan_time_s=2.147483648") + " --check",
          sets("laser.pulse_rate_hz=1e9", "laser.scan_time_s=2.147483647") + " --check"),
    Limit("rows, columns of a detector", "4,096", "scan-sim", sets("detector.rows=4097") + " --check",
          sets("detector.rows=4096", "detector.columns=1") + " --check"),
    Limit("rays of a pulse (rows x columns x subpixels^2)", "2^26", "scan-sim",
          sets("detector.rows=4096", "detector.columns=4096", "detector.subpixels=3") + " --check"),
    Limit("lines of a scan pattern, pulses of a line", "2^20", "scan-sim",
          sets("scanner.pattern.rows=1048577") + " --check", sets("scanner.pattern.rows=1048576") + " --check"),
    Limit("steps of a sampled error path", "10^6", "scan-sim",
          sets("laser.scan_time_s=1000", "navigation_error.interval_s=0.000999",
               'navigation_error.random_walk={"position_m_per_sqrt_s":[1,1,1]}') + " --check"),
    Limit("objects of a population", "10^7", "terrain-gen",
          sets('patterns=[{"type":"power_law_rocks","min_diameter_m":0.01,"max_diameter_m":1,"model":"custom","exponent":2,"coefficient":1e3}]')
          + " -o {folder}/x.h5"),
    Limit("copies on a ring", "10^6", "terrain-gen",
          sets('patterns=[{"type":"ring","count":1000001,"radius_m":1,"feature":{"type":"hemisphere","radius_m":1}}]') + " --check",
          sets('patterns=[{"type":"ring","count":1000000,"radius_m":1,"feature":{"type":"hemisphere","radius_m":1}}]') + " --check"),
    Limit("bases that are summed", "64", "terrain-gen", sets('base=[' + ','.join(['{"type":"plane"}'] * 65) + ']') + " --check",
          sets('base=[' + ','.join(['{"type":"plane"}'] * 64) + ']') + " --check"),
    Limit("seed", "2^53 - 1", "scan-sim", "--seed 9007199254740992 --check", "--seed 9007199254740991 --check"),
    Limit("levels of a configuration", "64", "terrain-gen", "-c {folder}/deep65.json --check"),
    Limit("threads", "4,096", "regrid", "{folder}/scan.h5 -t 4097 --check", "{folder}/scan.h5 -t 4096 --check"),
    Limit("points that a thread works on at a time", "2^24", "scan-sim", "--batch-points 16777217 --check",
          "--batch-points 16777216 --check"),
    Limit("cases of a study", "10^6", "sweep.py", "list {folder}/huge.json", code=2),
    Limit("bytes of an output's name", "255", "terrain-gen",
          sets("grid.half_width_m=1", "grid.resolution_m=1") + " -o {folder}/" + "n" * 253 + ".h5",
          sets("grid.half_width_m=1", "grid.resolution_m=1") + " -o {folder}/" + "n" * 252 + ".h5"),
]


def prepare(folder):
    with open(os.path.join(folder, "deep65.json"), "w", encoding="utf-8") as file:
        file.write("[" * 65 + "]" * 65)
    with open(os.path.join(folder, "huge.json"), "w", encoding="utf-8") as file:
        json.dump({"base": {}, "axes": [{"key": "scan.noise.range_sigma_m", "values": [i / 1000 for i in range(101)]},
                                        {"key": "scan.laser.scan_time_s", "values": list(range(1, 101))}],
                   "repeat": {"count": 100}}, file)


def program(binaries, tool):
    if tool.endswith(".py"):
        return ["/usr/bin/python3", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python", "commands", tool)]
    return [os.path.join(binaries, tool)]


def run(binaries, limit, arguments, folder):
    words = [word.replace("{folder}", folder) for word in arguments.split()]
    return subprocess.run([*program(binaries, limit.tool), *words], capture_output=True, text=True, timeout=300, check=False)


def try_limits(workshop):
    """The lines of the table, and the violated limits."""
    prepare(workshop.inputs)
    lines, broken = ["| quantity | maximum | message for one more |", "|---|---|---|"], []
    for limit in LIMITS:
        refused = run(workshop.binaries, limit, limit.beyond, workshop.inputs)
        message = refused.stderr.strip().replace(workshop.inputs + "/", "").replace("n" * 253, "nn..n")
        if refused.returncode != limit.code or refused.stderr.count("\n") != 1 or "internal" in message or "unknown key" in message:
            broken.append(f"{limit.what}: exit {refused.returncode}: {refused.stderr!r}")
        if limit.largest:
            taken = run(workshop.binaries, limit, limit.largest, workshop.inputs)
            if taken.returncode != 0:
                broken.append(f"{limit.what}: {limit.bound}: {taken.stderr!r}")
        lines.append(f"| {limit.what} | {limit.bound} | exit {refused.returncode}: `{message}` |")
    return lines, broken

