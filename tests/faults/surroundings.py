# SPDX-License-Identifier: GPL-3.0-or-later
"""Unusual environments: other locales and clocks, no home, no current folder, closed standard streams."""
import os
import shutil
import subprocess

from workshop import TASKS, Judge


def comma_locale(workshop):
    """Makes a locale with a decimal comma; None if the sources of locales are not installed."""
    folder = os.path.join(workshop.folder, "locale")
    os.makedirs(folder, exist_ok=True)
    made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", os.path.join(folder, "de_DE.UTF-8")], capture_output=True,
                          check=False)
    return {"LOCPATH": folder, "LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"} if made.returncode == 0 else None


def try_environment(workshop, what, changes, dropped=(), tasks=None):
    judge = Judge(workshop, what)
    environment = {key: value for key, value in os.environ.items() if key not in dropped} | changes
    for one in tasks or TASKS:
        judge.take(one, workshop.run(one, env=environment))
    return judge


def closing(*descriptors):
    def close():
        for descriptor in descriptors:
            os.close(descriptor)
    return close


def try_closed(workshop, what, *descriptors, verbose=False, tasks=None):
    """Closed standard streams: no file of the run may get their descriptor and be written to by mistake."""
    judge = Judge(workshop, what)
    for one in tasks or TASKS:
        workshop.prepare(one)
        process = subprocess.Popen([*workshop.command(one), *(["-v", "--progress"] if verbose else [])], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=closing(*descriptors))
        run = workshop.finish(process)
        if run.code == 1 and 2 in descriptors:  # the message is lost
            run.stderr = f"{one.tool}: writing to standard output failed\n"
        if run.code == 0 and one.outputs:
            run.stdout = workshop.stdout[one]
        judge.take(one, run)
    return judge


def try_no_folder(workshop):
    """The current folder is removed; all paths are absolute."""
    judge = Judge(workshop, "the current folder was removed")
    for one in TASKS:
        gone = os.path.join(workshop.folder, "gone")
        os.mkdir(gone)
        def enter_and_remove(gone=gone):
            os.chdir(gone)
            os.rmdir(gone)
        workshop.prepare(one)
        process = subprocess.Popen(workshop.command(one), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   preexec_fn=enter_and_remove)
        judge.take(one, workshop.finish(process))
        shutil.rmtree(gone, ignore_errors=True)
    return judge


def try_surroundings(workshop, library):
    comma = comma_locale(workshop)
    if comma:
        yield try_environment(workshop, "a locale with a decimal comma (de_DE)", comma)
    yield try_environment(workshop, "another time zone (TZ)", {"TZ": "Pacific/Chatham"})
    for what, seconds in (("behind", -10**9), ("ahead", 10**9)):
        yield try_environment(workshop, f"a clock that is 30 years {what}", {"LD_PRELOAD": library, "FAULT_CLOCK": str(seconds)})
    yield try_environment(workshop, "no HOME, no TMPDIR, no PATH", {}, ("HOME", "TMPDIR", "PATH"))
    yield try_environment(workshop, "a TMPDIR that does not exist", {"TMPDIR": "/nowhere"})
    yield try_no_folder(workshop)
    yield try_closed(workshop, "standard input closed", 0)
    yield try_closed(workshop, "standard output closed", 1)
    yield try_closed(workshop, "standard error closed", 2)
    yield try_closed(workshop, "all three closed, with -v --progress", 0, 1, 2, verbose=True)
