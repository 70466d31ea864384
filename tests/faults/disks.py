# SPDX-License-Identifier: GPL-3.0-or-later
"""Small disks (tmpfs), and limits on the size of files."""
import contextlib
import os
import resource
import signal
import subprocess

from workshop import TASKS, Judge

SIZES = 5  # per task, evenly spaced from almost nothing to almost enough


@contextlib.contextmanager
def small_disk(folder, kibibytes):
    """Mounts a tmpfs on the folder; raises CalledProcessError if this user has no right to mount."""
    os.makedirs(folder, exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kibibytes}k,mode=0777", "tmpfs", folder], check=True, capture_output=True)
    try:
        yield
    finally:
        subprocess.run(["umount", folder], check=True)


def can_mount(folder):
    try:
        with small_disk(folder, 64):
            return True
    except (OSError, subprocess.CalledProcessError):
        return False


def sizes(largest, step):
    return sorted({max(step, largest * i // SIZES // step * step) for i in range(SIZES)})


def try_full_disks(workshop, tasks=None):
    """Disks that are too small for the outputs, with and without an old output, and one that is just large enough."""
    judge = Judge(workshop, "a full disk (tmpfs)")
    if not can_mount(workshop.out):
        return judge
    for one in filter(lambda each: each.outputs, tasks or TASKS):
        need = sum(len(data) + 4096 for data in workshop.whole[one].values())
        for kibibytes in sizes(need // 1024, 4):
            for old in (False, True):
                with small_disk(workshop.out, kibibytes + (4 * len(one.outputs) if old else 0)):
                    judge.take(one, workshop.run(one, old), old=old, how=f"{kibibytes} KiB")
    return judge


def limit_files(size):
    def apply():
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)  # Python ignores it
    return apply


def try_file_limits(workshop, tasks=None):
    judge = Judge(workshop, "a limit on the size of files (ulimit -f)")
    for one in filter(lambda each: each.outputs, tasks or TASKS):
        for size in sizes(max(map(len, workshop.whole[one].values())), 512):
            for old in (False, True):
                judge.take(one, workshop.run(one, old, preexec_fn=limit_files(size)), old=old, how=f"{size} bytes")
    return judge


def try_full_stdout(workshop):
    """Standard output is /dev/full, to which every write fails."""
    judge = Judge(workshop, "a full standard output (/dev/full)")
    for one in filter(lambda each: not each.outputs, TASKS):
        with open("/dev/full", "wb") as full:
            run = workshop.run(one, stdout=full)
        judge.take(one, run)
    return judge


def try_disks(workshop):
    yield try_full_disks(workshop)
    yield try_file_limits(workshop)
    yield try_full_stdout(workshop)

