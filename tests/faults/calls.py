# SPDX-License-Identifier: GPL-3.0-or-later
"""Failing system calls: each call on an output or an input of a run fails once, or is interrupted by a signal."""
import errno
import os
import signal
import subprocess

from workshop import TASKS, Judge, no_core

HERE = os.path.dirname(os.path.abspath(__file__))
MAX_PER_TASK = 150  # of more calls, an evenly spread selection


def build_library(folder):
    """Compiles the library to preload, and returns its path."""
    library = os.path.join(folder, "failing_calls.so")
    subprocess.run([os.environ.get("CC", "cc"), "-O1", "-fPIC", "-shared", "-o", library,
                    os.path.join(HERE, "failing_calls.c"), "-ldl"], check=True)
    return library


class FailingCalls:
    """Runs tasks with the preloaded library; `kind` is write or read."""

    def __init__(self, workshop, library, kind):
        self.workshop, self.library, self.kind = workshop, library, kind

    def run(self, one, at, action, *, old=False, sticky=False):
        log = os.path.join(self.workshop.folder, "calls")
        under = self.workshop.out if self.kind == "write" else self.workshop.inputs
        environment = {**os.environ, "LD_PRELOAD": self.library, "FAULT_UNDER": under, "FAULT_CALLS": self.kind, "FAULT_LOG": log,
                       "FAULT_AT": str(at), "FAULT_ACTION": str(action), "FAULT_STICKY": "1" if sticky else "0"}
        if os.path.exists(log):
            os.remove(log)
        run = self.workshop.run(one, old, env=environment, preexec_fn=no_core)
        return run, log

    def count(self, one):
        """The (calls, bytes) of an undisturbed run."""
        run, log = self.run(one, 0, 0)
        if run.code != 0:
            raise RuntimeError(f"{one.label}: {run.stderr}")
        with open(log, encoding="utf-8") as file:
            return tuple(map(int, file.read().split()))


def spread(count, maximum):
    """About `most` of the numbers 1 .. count or all of them, including the first and the last ones."""
    if count <= maximum:
        return list(range(1, count + 1))
    edge = maximum // 5
    middle = maximum - 2 * edge
    inner = [edge + round((i + 0.5) * (count - 2 * edge) / middle) for i in range(middle)]
    return sorted({*range(1, edge + 1), *inner, *range(count - edge + 1, count + 1)})


def try_calls(workshop, library, kind, action, *, what, ended_by=0, sticky=False, old=False, tasks=None, maximum=MAX_PER_TASK):
    """A Judge of one run for each call, or a selection of calls, of each task."""
    judge, calls = Judge(workshop, what), FailingCalls(workshop, library, kind)
    for one in tasks or TASKS:
        if kind == "write" and not one.outputs:
            continue
        number, size = calls.count(one)
        judge.counts["calls"] += number
        # Only half of the bytes is required, because an HDF5 file has space that is never written.
        if kind == "write" and size < sum(map(len, workshop.whole[one].values())) / 2:
            judge.broken.append(f"{what}: {one.label}: only {size} bytes went through the calls that were watched")
        for at in spread(number, maximum):
            run, _ = calls.run(one, at, action, old=old, sticky=sticky)
            judge.take(one, run, old=old, ended_by=ended_by, parts_may_stay=ended_by in (signal.SIGKILL, signal.SIGQUIT),
                       how=f"call {at} of {number}")
    return judge


def try_all_calls(workshop, library, maximum=MAX_PER_TASK):
    """The judges for the table of the page."""
    def trial(kind, action, what, **options):
        return try_calls(workshop, library, kind, action, what=what, maximum=maximum, **options)
    yield trial("write", errno.ENOSPC, "no space, from one call on", sticky=True, old=True)
    yield trial("write", errno.EIO, "one call fails with EIO", old=False)
    yield trial("write", "short", "one write takes half of the bytes")
    yield trial("write", "again", "one call is interrupted (EINTR)")
    yield trial("read", errno.EIO, "one read of an input fails with EIO")
    yield trial("read", "short", "one read gives half of the bytes")
    for number in (signal.SIGTERM, signal.SIGKILL):
        yield trial("write", -number, f"{number.name} just before the call", ended_by=number, old=number == signal.SIGKILL)
