# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders that are removed or not writable, outputs that are replaced by a folder, and several writers of one output."""
import os
import shutil
import subprocess
import time

from workshop import TASKS, Judge, files_of

WRITING = [each for each in TASKS if each.outputs]
OWN_NUMBERS = ["unshare", "--pid", "--fork", "--kill-child", "--mount-proc"]
UNPRIVILEGED = ["setpriv", "--reuid=54321", "--regid=54321", "--clear-groups"]


def can_unshare():
    return subprocess.run([*OWN_NUMBERS, "true"], capture_output=True, check=False).returncode == 0


def run_with_action(workshop, random, one, old, action):
    """A run during which `action` is called at a random time."""
    workshop.prepare(one, old)
    process = workshop.start(one, old)
    time.sleep(random.uniform(0, workshop.seconds[one]))
    action(one)
    return workshop.finish(process)


def try_removed_folders(workshop, random, count, tasks=None):
    """The output folder is removed during the run, which must fail properly unless it had already ended."""
    judge = Judge(workshop, "the output's folder is removed")
    tasks = tasks or WRITING
    for turn in range(count):
        one = tasks[turn % len(tasks)]
        run = run_with_action(workshop, random, one, False, lambda _: shutil.rmtree(workshop.out, ignore_errors=True))
        # If the run had already ended, its files were removed with the folder.
        if run.code == 0:
            run.files = workshop.whole[one]
        judge.take(one, run)
    return judge


def make_folders(workshop):
    def action(one):
        for name in one.outputs:
            path = os.path.join(workshop.out, name)
            if os.path.isfile(path):
                os.remove(path)
            os.mkdir(path)
    return action


def try_becoming_a_folder(workshop, random, count):
    judge = Judge(workshop, "a folder with the output's name is created during the run")
    for turn in range(count):
        one, old = WRITING[turn % len(WRITING)], turn // len(WRITING) % 2 == 1
        run = run_with_action(workshop, random, one, old, make_folders(workshop))
        if run.code != 0:
            run.files = {name: data for name, data in run.files.items() if data != "a folder"}
            judge.take(one, run)
        elif run.stderr:
            judge.take(one, run)
    return judge


def try_read_only(workshop):
    """Runs as a user who has no write permission for the folder."""
    judge = Judge(workshop, "a folder without write permission")
    for one in WRITING:
        for old in (False, True):
            workshop.prepare(one, old)
            os.chmod(workshop.out, 0o555)
            run = workshop.finish(workshop.start(one, old, prefix=UNPRIVILEGED))
            os.chmod(workshop.out, 0o755)
            judge.take(one, run, old=old)
    return judge


def race(workshop, tasks, old, prefix=()):
    """Starts one process per task at the same time; returns (code, stderr) of each, and the files at the end."""
    workshop.prepare(tasks[0], old)
    processes = [workshop.start(one, old, prefix=prefix) for one in tasks]
    ends = [process.communicate(timeout=120) for process in processes]
    return [(process.returncode, stderr.decode()) for process, (_, stderr) in zip(processes, ends)], files_of(workshop.out)


def judge_race(judge, tasks, ends, files, old):
    """Each process must succeed or be refused because the output exists; the output is complete, and no other file is left."""
    one, faults = tasks[0], []
    wholes = [judge.workshop.whole[each] for each in tasks]
    for name in one.outputs:
        if not any(files.get(name) == whole.get(name) for whole in wholes):
            faults.append("the output is not one of the complete files")
    if set(files) != set(one.outputs):
        faults.append(f"left behind: {sorted(set(files) - set(one.outputs))}")
    done = sum(code == 0 for code, _ in ends)
    # With several outputs, each of two runs may write one of them and be refused the other.
    if old and done != len(ends) or not old and done != 1 and len(one.outputs) == 1:
        faults.append(f"{done} of {len(ends)} succeeded")
    for code, message in ends:
        if code not in (0, 2) or (code == 2 and message.count("\n") != 1) or (code == 0 and message):
            faults.append(f"exit {code}: {message!r}")
    judge.counts.update(runs=len(ends), whole=done, refused=len(ends) - done)
    judge.messages.update(judge.plain(message) for _, message in ends if message)
    if faults:
        judge.broken.append(f"{judge.fault}: {[each.label for each in tasks]}{' -O' if old else ''}: {'; '.join(faults)}")
        print("BROKEN", judge.broken[-1], flush=True)


def try_races(workshop, rounds):
    """Two and eight writers of one output, of one tool and of two."""
    judge = Judge(workshop, "two and eight processes write one output")
    for _ in range(rounds):
        for one in WRITING:
            for number in (2, 8):
                for old in (False, True):
                    judge_race(judge, [one] * number, *race(workshop, [one] * number, old), old)
    return judge



def try_containers(workshop, rounds):
    """The same in separate process namespaces, like containers that share a folder: each writer is process 1."""
    judge = Judge(workshop, "two containers write one output, both as process 1")
    if can_unshare():
        for _ in range(rounds):
            for one in WRITING:
                judge_race(judge, [one] * 2, *race(workshop, [one] * 2, True, OWN_NUMBERS), True)
    return judge


def try_folders(workshop, random, count, rounds):
    yield try_removed_folders(workshop, random, count)
    yield try_becoming_a_folder(workshop, random, count)
    yield try_read_only(workshop)
    yield try_races(workshop, rounds)
    yield try_containers(workshop, rounds)
