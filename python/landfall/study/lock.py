# SPDX-License-Identifier: GPL-3.0-or-later
"""One process at a time works in a study's folder. Its file `lock` says which: process, host, since when, command.

The file is read and written under flock, which NFS passes between machines unless it is mounted with nolock. The process
itself need not hold anything open: whether it still runs is looked up by its number and start time. That works on its own
machine only; a lock of another machine is never taken over.
"""
import contextlib
import fcntl
import json
import os
import select
import socket
import subprocess
import sys
import time

from landfall.errors import UsageError

NAME = "lock"
# study-status and other short calls hold the lock for a moment.
PATIENCE_S = 2
POLL_S = 0.05


def take(folder, pid, patience_s=PATIENCE_S):
    """Enters process `pid` as the holder, in place of one that has ended. Throws UsageError, naming the holder, where it runs."""
    os.makedirs(folder, exist_ok=True)
    end = time.monotonic() + patience_s
    while True:
        with _opened(folder) as file:
            found = _read(file)
            if not found or not _may_run(found):
                _write(file, holder(pid))
                return
            if _is_visible(found) and found["pid"] == pid:
                return
        if time.monotonic() >= end:
            raise UsageError(_refusal(folder, found))
        time.sleep(POLL_S)


def free(folder, pid):
    """Removes the lock if process `pid` holds it, and the folder if that is then empty."""
    with contextlib.suppress(FileNotFoundError):
        with _opened(folder, os.O_RDWR) as file:
            if _read(file).get("pid") == pid:
                os.unlink(os.path.join(folder, NAME))
    with contextlib.suppress(OSError):
        os.rmdir(folder)


@contextlib.contextmanager
def held(folder):
    """Holds the lock; a process that the holder has started, as make starts sweep.py, works under its lock."""
    if _is_ancestor(_peek(folder)):
        yield
        return
    take(folder, os.getpid())
    try:
        yield
    finally:
        free(folder, os.getpid())


def free_after(folder, pid):
    """Starts a process in the background that frees the lock when process `pid` has ended, however it ends."""
    subprocess.Popen([sys.executable, os.path.abspath(sys.argv[0]), "free", os.path.abspath(folder), str(pid)], cwd="/", stdin=subprocess.DEVNULL,
                     stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)


def wait_for(pid):
    """Returns when the process has ended."""
    try:
        descriptor = os.pidfd_open(pid)
    except ProcessLookupError:
        return
    except (AttributeError, OSError):  # Linux before 5.3
        started = _started(pid)
        while started and _started(pid) == started:
            time.sleep(1)
        return
    select.select([descriptor], [], [])
    os.close(descriptor)


# Holders


def holder(pid):
    """What tells a process from all others, and what a message says of it."""
    return {"pid": pid, "host": socket.gethostname(), "machine": _line("/etc/machine-id"), "boot": _line("/proc/sys/kernel/random/boot_id"),
            "namespace": _namespace(), "started": _started(pid), "since": time.strftime("%F %T"), "command": _command(pid)}


def _may_run(found):
    """False only where this machine can see that the process has ended."""
    if not _is_visible(found):
        # An earlier boot of this machine: its processes have ended.
        here = found.get("host") == socket.gethostname() and found.get("machine") == _line("/etc/machine-id") != ""
        return not here or found.get("boot") == _line("/proc/sys/kernel/random/boot_id")
    return _started(found["pid"]) == found.get("started")


def _is_visible(found):
    """Whether the process would be found by its number: the same kernel since it booted, the same container."""
    return (found.get("boot"), found.get("namespace")) == (_line("/proc/sys/kernel/random/boot_id"), _namespace())


def _is_ancestor(found):
    if not found or not _is_visible(found) or not _may_run(found):
        return False
    pid = os.getpid()
    while pid > 0 and pid != found["pid"]:
        pid = int((_status(pid) or ["", "0"])[1])
    return pid == found["pid"]


def _refusal(folder, found):
    text = f"{folder} is in use: process {found['pid']} on {found.get('host')} since {found.get('since')} ({found.get('command')}); "
    if _is_visible(found):
        return text + "wait for it or end it"
    return text + f"this machine cannot see whether it still runs: if it does not, remove {os.path.join(folder, NAME)}"


def _status(pid):
    """The fields of /proc/PID/stat after the name, [state, parent, ...]; None where there is no such process."""
    text = _line(f"/proc/{pid}/stat")
    return text.rpartition(")")[2].split() or None


def _started(pid):
    """The start of a process in clock ticks after the boot; None where it has ended."""
    fields = _status(pid)
    return int(fields[19]) if fields and fields[0] not in "ZX" else None


def _namespace():
    """The container's own numbers of processes."""
    with contextlib.suppress(OSError):
        return os.readlink("/proc/self/ns/pid")
    return ""


def _command(pid):
    words = _line(f"/proc/{pid}/cmdline").rstrip("\0").replace("\0", " ")
    return "".join(character if character.isprintable() else "?" for character in words)[:200]


def _line(path):
    """The text of a file of one line; empty where it cannot be read."""
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read().rstrip("\n")
    except OSError:
        return ""


# The file


@contextlib.contextmanager
def _opened(folder, flags=os.O_RDWR | os.O_CREAT):
    """The file under flock, and the one of this name: not one that its holder has just removed."""
    path = os.path.join(folder, NAME)
    while True:
        with open(os.open(path, flags, 0o666), "r+b") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            if _is_at(path, file):
                yield file
                return


def _is_at(path, file):
    with contextlib.suppress(FileNotFoundError):
        return os.path.samestat(os.stat(path), os.fstat(file.fileno()))
    return False


def _peek(folder):
    with contextlib.suppress(OSError):
        with open(os.path.join(folder, NAME), "rb") as file:
            return _read(file)
    return {}


def _read(file):
    """The holder; {} where the file is empty or damaged, as a crash leaves it."""
    try:
        tree = json.loads(file.read())
    except ValueError:
        return {}
    return tree if isinstance(tree, dict) and isinstance(tree.get("pid"), int) else {}


def _write(file, tree):
    file.seek(0)
    file.truncate()
    file.write(json.dumps(tree).encode())
    file.flush()
    os.fsync(file.fileno())
