# SPDX-License-Identifier: GPL-3.0-or-later
"""Every system call of a run on its outputs, or on its inputs, fails once; signals that come exactly there."""
import errno
import os
import signal
import subprocess

from workshop import TASKS, Judge, no_core

HERE = os.path.dirname(os.path.abspath(__file__))
MOST_PER_TASK = 150  # of more calls a spread is taken


def build_library(folder):
    """The preloaded library, built where a compiler is."""
    library = os.path.join(folder, "failing_calls.so")
    subprocess.run([os.environ.get("CC", "cc"), "-O1", "-fPIC", "-shared", "-o", library,
                    os.path.join(HERE, "failing_calls.c"), "-ldl"], check=True)
    return library


class FailingCalls:
    """Runs tasks with the library; `kind` is write or read."""

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
        """(calls, bytes) of an undisturbed run."""
        run, log = self.run(one, 0, 0)
        if run.code != 0:
            raise RuntimeError(f"{one.label}: {run.stderr}")
        with open(log, encoding="utf-8") as file:
            return tuple(map(int, file.read().split()))


def spread(count, most):
    """At most about `most` of the numbers 1 .. count, the first and the last ones among them."""
    if count <= most:
        return list(range(1, count + 1))
    edge = most // 5
    middle = most - 2 * edge
    inner = [edge + round((i + 0.5) * (count - 2 * edge) / middle) for i in range(middle)]
    return sorted({*range(1, edge + 1), *inner, *range(count - edge + 1, count + 1)})


def try_calls(workshop, library, kind, action, *, what, ended_by=0, sticky=False, old=False, tasks=None, most=MOST_PER_TASK):
    """A Judge of a run for every call (or a spread) of every task."""
    judge, calls = Judge(workshop, what), FailingCalls(workshop, library, kind)
    for one in tasks or TASKS:
        if kind == "write" and not one.outputs:
            continue
        number, size = calls.count(one)
        judge.counts["calls"] += number
        # Half of the bytes suffices: an HDF5 file has space that is never written.
        if kind == "write" and size < sum(map(len, workshop.whole[one].values())) / 2:
            judge.broken.append(f"{what}: {one.label}: only {size} bytes went through the calls that were watched")
        for at in spread(number, most):
            run, _ = calls.run(one, at, action, old=old, sticky=sticky)
            judge.take(one, run, old=old, ended_by=ended_by, parts_may_stay=ended_by in (signal.SIGKILL, signal.SIGQUIT),
                       how=f"call {at} of {number}")
    return judge


def try_all_calls(workshop, library, most=MOST_PER_TASK):
    """The judges of the page's table."""
    def trial(kind, action, what, **options):
        return try_calls(workshop, library, kind, action, what=what, most=most, **options)
    yield trial("write", errno.ENOSPC, "no space, from one call on", sticky=True, old=True)
    yield trial("write", errno.EIO, "one call fails with EIO", old=False)
    yield trial("write", "short", "one write takes half of the bytes")
    yield trial("write", "again", "one call is interrupted (EINTR)")
    yield trial("read", errno.EIO, "one read of an input fails with EIO")
    yield trial("read", "short", "one read gives half of the bytes")
    for number in (signal.SIGTERM, signal.SIGKILL):
        yield trial("write", -number, f"{number.name} just before the call", ended_by=number, old=number == signal.SIGKILL)
