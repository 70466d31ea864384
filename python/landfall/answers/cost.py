# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of a run of many draws before it starts: a trial of two of them, multiplied by their number.

The trial leaves the terrain and the traced scan for the run.
"""
import os
import time

from landfall.errors import ToolError
from landfall.study import rules
from landfall.study.cost import duration, TRIAL_DRAWS
from landfall.study.names import counted


def seconds_of(work, *arguments):
    begin = time.monotonic()
    work(*arguments)
    return time.monotonic() - begin


def trial(draws, make_some):
    """(seconds of what the draws share, seconds of a draw); make_some(number) makes draws."""
    draws.terrain()
    return seconds_of(draws.make_shared), seconds_of(make_some, TRIAL_DRAWS) / TRIAL_DRAWS


def text(what, seconds, workers, disk):
    return f"cost: about {duration(seconds / workers)} for {what}, with {counted(workers, 'run')} at a time; {disk}"


def unknown_text(error):
    return f"cost: unknown, because the first draw fails: {str(error).splitlines()[-1]}"


def disk_text(runner, configs, terrains, scans):
    """The files on the disk besides results."""
    size = terrains * os.path.getsize(runner.terrain(configs["terrain"]))
    return (f"on the disk: {counted(terrains, 'terrain')}, {rules.size_text(size)}, and up to {counted(scans, 'scan')} at a time, each about "
            f"{rules.size_text(rules.rays_of(configs['scan']) * rules.BYTES_PER_RAY)}")


def text_of_rows(of, values):
    """The cost of the rows of a Model in one line; empty where an earlier run has made some of them."""
    tasks = of.tasks_of(values)
    if any(os.path.exists(of.runner.place(task.kind, task.depends, "json")) for task in tasks):
        return ""
    chains, drawn = ([task for task in tasks if task.is_chain == is_chain] for is_chain in (True, False))
    seconds, parts = 0.0, []
    try:
        if drawn:
            shared, each = trial(drawn[0].scan, drawn[0].make_some)
            scans, count = len({id(task.scan) for task in drawn}), sum(len(task.numbers) for task in drawn)
            seconds += scans * shared + count * each
            parts.append(f"{counted(count, 'draw')} ({duration(each)} each)" + (f" over {counted(scans, 'scan')} ({duration(shared)} each)" if scans > 1 else ""))
        if chains:
            of.runner.terrain(of.base["terrain"])
            each = seconds_of(chains[0].make_some, 1)
            seconds += len(chains) * each
            parts.append(f"{counted(len(chains), 'draw')} with rays of its own ({duration(each)} each)")
    except ToolError as error:
        return unknown_text(error)
    disk = "no files besides results" if of.traced is not None else disk_text(of.runner, of.base, 1, of.workers)
    return text(" and ".join(parts), seconds, of.workers, disk)


def text_of_design(design):
    """The cost of the search and of one proof in one line, by the base; empty where an earlier run has made some of it."""
    problem, runner = design.problem, design.runner
    if any(name.startswith("look-") for name in os.listdir(runner.cache)):
        return ""
    configs = problem.configs({})
    scan = problem.scan_of(runner, configs)
    try:
        shared, each = trial(scan, lambda number: scan.rows(problem.draws(draws=number, seed=problem.seed)))
    except ToolError as error:
        return unknown_text(error)
    terrains = len(problem.terrains)
    seconds = problem.candidates * (shared + each) + terrains * (shared + problem.proof_draws * each)
    what = (f"{counted(problem.candidates, 'candidate')} ({duration(shared + each)} each, as the base) and {problem.proof_draws} fresh draws"
            + (f" on each of {terrains} terrains" if terrains > 1 else "") + f" ({duration(each)} each), besides sequential tests")
    disk = "no files besides results" if problem.traced is not None else disk_text(runner, configs, terrains, design.workers)
    return text(what, seconds, design.workers, disk)
