# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that a signal meets at a random moment."""
import signal
import time

from workshop import TASKS, Judge, no_core

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGPIPE, signal.SIGXCPU, signal.SIGQUIT)


def keeps_parts(number):
    """What cannot be caught, or asks for a core with all that belongs to it, leaves the hidden file."""
    return number in (signal.SIGKILL, signal.SIGQUIT)


def as_from_a_terminal(number):
    """No core; and a shell that started this in the background has made it ignore SIGINT and SIGQUIT, which programs inherit."""
    no_core()
    if number != signal.SIGKILL:
        signal.signal(number, signal.SIG_DFL)


class Moments:
    """Random moments, uniform over a run; a task's runs are measured anew as they go."""

    def __init__(self, workshop, random):
        self.workshop, self.random = workshop, random

    def disturbed(self, one, number, old):
        """A run that gets the signal; None where it was over before."""
        self.workshop.prepare(one, old)
        process = self.workshop.start(one, old, preexec_fn=lambda: as_from_a_terminal(number))
        time.sleep(self.random.uniform(0, self.workshop.seconds[one]))
        alive = process.poll() is None
        if alive:
            process.send_signal(number)
        return self.workshop.finish(process) if alive else self.workshop.finish(process) and None


def swept(workshop, one):
    """True if the next run with the same name removes the file that a killed run left."""
    run = workshop.finish(workshop.start(one, True))
    return run.code == 0 and run.files == workshop.whole[one]


def try_signal(workshop, random, number, count, tasks=None):
    """A Judge of `count` runs over all tasks, every second one over an old output."""
    judge, moments = Judge(workshop, number.name), Moments(workshop, random)
    tasks, turn = tasks or TASKS, 0
    while judge.counts["runs"] < count and turn < 4 * count:
        one, old = tasks[turn % len(tasks)], turn // len(tasks) % 2 == 1
        turn += 1
        run = moments.disturbed(one, number, old)
        if run is None:
            continue
        judge.take(one, run, old=old, ended_by=number, parts_may_stay=keeps_parts(number))
        if run.parts and not swept(workshop, one):
            judge.broken.append(f"{number.name}: {one.label}: the next run did not sweep up {run.parts}")
    return judge


def try_stop(workshop, random, count):
    """Stopped for a moment and continued: whole."""
    judge = Judge(workshop, "SIGSTOP, then SIGCONT")
    for turn in range(count):
        one = TASKS[turn % len(TASKS)]
        workshop.prepare(one)
        process = workshop.start(one)
        time.sleep(random.uniform(0, workshop.seconds[one]))
        process.send_signal(signal.SIGSTOP)
        time.sleep(0.02)
        process.send_signal(signal.SIGCONT)
        judge.take(one, workshop.finish(process))
    return judge


def try_signals(workshop, random, kills, others):
    yield try_signal(workshop, random, signal.SIGKILL, kills)
    for number in ENDING:
        yield try_signal(workshop, random, number, others)
    yield try_stop(workshop, random, others)
