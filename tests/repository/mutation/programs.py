# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs googletest programs with one mutant enabled, or records which mutants each of their tests reaches."""
import math
import os
import signal
import subprocess
import tempfile
import threading

QUICK_S = 0.3  # tests run in groups; the first takes at most this long, and each next one is longer
GROWTH = 6
PATIENCE = 5  # a run that takes this many times as long as usual is considered to hang
GRACE_S = 2.0
IDLE = 20


def measured(command, environment, limit_s):
    """(exit status, processor time in seconds). The status is None after `limit_s` of processor time, or IDLE times as long in
    real time; all processes of the command are then killed. Processor time is limited, so that the load of the machine does
    not decide which mutants are killed and which tests are excluded."""
    limited = ["/bin/sh", "-c", f'ulimit -t {math.ceil(limit_s)} && exec "$@"', "sh", *command]
    process = subprocess.Popen(limited, env={**os.environ, **environment}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               start_new_session=True)
    timer = threading.Timer(IDLE * limit_s, os.killpg, (process.pid, signal.SIGKILL))
    timer.start()
    _, status, usage = os.wait4(process.pid, 0)
    timer.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    hangs = process.returncode in (-signal.SIGKILL, -signal.SIGXCPU)
    return None if hangs else process.returncode, usage.ru_utime + usage.ru_stime


def run(command, environment, limit_s):
    return measured(command, environment, limit_s)[0]


def tests_of(program):
    """The names (Suite.test) of all tests of a program."""
    output = subprocess.run([program, "--gtest_list_tests"], check=True, capture_output=True, text=True).stdout
    tests, suite = [], ""
    for line in output.splitlines():
        name = line.split("#")[0].rstrip()
        if name.endswith(".") and not name.startswith(" "):
            suite = name
        elif name.startswith("  "):
            tests.append(suite + name.strip())
    return tests


def trace(command, limit_s=600, environment=None):
    """The mutants that the command reaches, and its time; None if it fails without a mutant or takes too long."""
    with tempfile.TemporaryDirectory() as scratch:
        path = os.path.join(scratch, "trace")
        status, elapsed = measured(command, {**(environment or {}), "LANDFALL_MUTANT_TRACE": path}, limit_s)
        if status != 0:
            return None
        if not os.path.exists(path):
            return {"seconds": elapsed, "reached": []}
        with open(path, encoding="utf-8") as file:
            return {"seconds": elapsed, "reached": sorted({int(line) for line in file})}


def groups_of(tests, traces):
    """Groups of tests of one program, the fastest tests first; each next group may take longer."""
    groups, most = [], QUICK_S
    for test in sorted(tests, key=lambda t: traces[t]["seconds"]):
        program = test.split(":")[0]
        group = next((g for g in groups if g["program"] == program and g["most"] == most), None)
        if group is None or (group["tests"] and group["seconds"] + traces[test]["seconds"] > most):
            if group is not None:
                most *= GROWTH
            group = {"program": program, "tests": [], "seconds": 0, "most": most}
            groups.append(group)
        group["tests"].append(test.split(":", 1)[1])
        group["seconds"] += traces[test]["seconds"]
    return groups


def killer(mutant, tests, traces, folder):
    """The test that kills the mutant: "program: failed" or "program: hangs"; "" if it survives `tests`."""
    for group in groups_of(tests, traces):
        command = [os.path.join(folder, group["program"]), "--gtest_fail_fast", "--gtest_brief=1",
                   "--gtest_filter=" + ":".join(group["tests"])]
        status = run(command, {"LANDFALL_MUTANT": str(mutant)}, GRACE_S + PATIENCE * group["seconds"])
        if status != 0:
            return f"{group['program']}: {'hangs' if status is None else 'fails'}"
    return ""
