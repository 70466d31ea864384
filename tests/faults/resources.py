# SPDX-License-Identifier: GPL-3.0-or-later
"""Too little memory, stack, descriptors or threads."""
import resource

from folders import UNPRIVILEGED
from workshop import TASKS, Judge

STEPS = 12
MEBI = 1 << 20
LOADER = "error while loading shared libraries"


def limit(kind, value):
    return lambda: resource.setrlimit(kind, (value, value))


def starts(workshop, one, size):
    """True if the program reaches its main function with this much address space."""
    run = workshop.run(one, preexec_fn=limit(resource.RLIMIT_AS, size))
    return run.code in (0, 1, 2)


def is_whole(workshop, one, size):
    return workshop.run(one, preexec_fn=limit(resource.RLIMIT_AS, size)).code == 0


def smallest(test, low, high, step=2 * MEBI):
    """The smallest size for which the test holds, within `step`; it must hold for `high`."""
    while high - low > step:
        middle = (low + high) // 2
        low, high = (low, middle) if test(middle) else (middle, high)
    return high


def try_memory(workshop, tasks=None):
    """Address space (ulimit -v), from too little to start the program to just enough for the run."""
    judge = Judge(workshop, "a limit on memory (ulimit -v)")
    for one in tasks or TASKS:
        enough = smallest(lambda size, one=one: is_whole(workshop, one, size), MEBI, 4096 * MEBI)
        first = smallest(lambda size, one=one: starts(workshop, one, size), MEBI, enough)
        for i in range(STEPS):
            size, old = first + (enough - first) * i // (STEPS - 1), i % 2 == 1
            run = workshop.run(one, old, preexec_fn=limit(resource.RLIMIT_AS, size))
            judge.take(one, run, old=old, how=f"{size // 1024} KiB of {first // MEBI} .. {enough // MEBI} MiB")
            if run.code == 1 and "memory" not in run.stderr:
                judge.broken.append(f"{judge.fault}: {one.label}: {size // MEBI} MiB: {run.stderr.strip()}")
    return judge


def try_descriptors(workshop):
    """ulimit -n; with too few descriptors the loader itself fails, before our code runs."""
    judge = Judge(workshop, "3 to 16 file descriptors (ulimit -n)")
    for one in TASKS:
        for number in (3, 4, 5, 6, 7, 8, 12, 16):
            run = workshop.run(one, number % 2 == 1, preexec_fn=limit(resource.RLIMIT_NOFILE, number))
            if LOADER not in run.stderr:
                judge.take(one, run, old=number % 2 == 1, how=f"{number} descriptors")
    return judge


def try_stacks(workshop, tasks=None):
    judge = Judge(workshop, "a stack of 64 KiB to 1 MiB (ulimit -s)")
    for one in tasks or TASKS:
        for kibibytes in (64, 256, 1024):
            judge.take(one, workshop.run(one, preexec_fn=limit(resource.RLIMIT_STACK, kibibytes << 10)), how=f"{kibibytes} KiB")
    return judge


def try_threads(workshop):
    """ulimit -u, as a separate user: no thread besides the first can be made, or only few."""
    judge = Judge(workshop, "no further threads allowed (ulimit -u)")
    for one in TASKS:
        for number in (1, 2):
            workshop.prepare(one)
            workshop.open_to_all()
            run = workshop.finish(workshop.start(one, prefix=["prlimit", f"--nproc={number}", *UNPRIVILEGED]))
            judge.take(one, run, how=f"{number} processes and threads")
    return judge


def try_resources(workshop):
    yield try_memory(workshop)
    yield try_descriptors(workshop)
    yield try_stacks(workshop)
    yield try_threads(workshop)
