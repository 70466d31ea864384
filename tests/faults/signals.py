# SPDX-License-Identifier: GPL-3.0-or-later
"""Signals at random times during a run."""
import signal
import time

from workshop import TASKS, Judge, no_core

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGPIPE, signal.SIGXCPU, signal.SIGQUIT)


def leaves_hidden_file(number):
    """SIGKILL cannot be caught, and SIGQUIT asks for a core dump, so both leave the hidden file."""
    return number in (signal.SIGKILL, signal.SIGQUIT)


def reset_signals(number):
    """Disables core dumps, and undoes that a shell makes background processes ignore SIGINT and SIGQUIT."""
    no_core()
    if number != signal.SIGKILL:
        signal.signal(number, signal.SIG_DFL)


class RandomTimes:
    """Random times, uniform over the duration of a run, which is measured again during the trials."""

    def __init__(self, workshop, random):
        self.workshop, self.random = workshop, random

    def disturbed(self, one, number, old):
        """A run that receives the signal; None if it had ended before."""
        self.workshop.prepare(one, old)
        process = self.workshop.start(one, old, preexec_fn=lambda: reset_signals(number))
        time.sleep(self.random.uniform(0, self.workshop.seconds[one]))
        alive = process.poll() is None
        if alive:
            process.send_signal(number)
        return self.workshop.finish(process) if alive else self.workshop.finish(process) and None


def is_cleaned_up(workshop, one):
    """True if the next run with the same output removes the hidden file of the killed run."""
    run = workshop.finish(workshop.start(one, True))
    return run.code == 0 and run.files == workshop.whole[one]


def try_signal(workshop, random, number, count, tasks=None):
    """A Judge of `count` runs over all tasks, every second one over an old output."""
    judge, random_times = Judge(workshop, number.name), RandomTimes(workshop, random)
    tasks, turn = tasks or TASKS, 0
    while judge.counts["runs"] < count and turn < 4 * count:
        one, old = tasks[turn % len(tasks)], turn // len(tasks) % 2 == 1
        turn += 1
        run = random_times.disturbed(one, number, old)
        if run is None:
            continue
        judge.take(one, run, old=old, ended_by=number, parts_may_stay=leaves_hidden_file(number))
        if run.parts and not is_cleaned_up(workshop, one):
            judge.broken.append(f"{number.name}: {one.label}: the next run did not remove {run.parts}")
    return judge


def try_stop(workshop, random, count):
    """Runs that are stopped for a moment and continued; their outputs must be complete."""
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
