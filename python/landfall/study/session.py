# SPDX-License-Identifier: GPL-3.0-or-later
"""The progress of a study: the missing files of its folder, and the counts of the present call of make."""
import collections
import contextlib
import fcntl
import json
import os
import time

from landfall.command import write_text
from landfall.errors import UsageError
from landfall.schema import shown


# The files that hold a case's results: their folders, and what "format" says in them.
FORMATS = {"metrics": "landfall.metrics", "score": "landfall.hazard_score", "sites": "landfall.sites",
           "verdict": "landfall.draws_verdict"}
# Kinds of files that are counted; layers and sites are made together with metrics and score, draws with their verdict.
KINDS = ("terrain", "truth", "scan", "dem", "metrics", "score", "verdict")


def sites_of(score):
    """The file with the sites of a score."""
    return "sites/" + score.removeprefix("score/")


def kind_of(name):
    """One of KINDS, eval, hazard, sites or draws, by a file's name in the study's folder."""
    folder, file = name.split("/", 1)
    return file.rsplit(".", 2)[1] if folder == "shared" else folder


def inner_name(name):
    """The name of a file in the study's folder, as another file there gives it. Throws UsageError if it leads outside."""
    if os.path.isabs(name) or ".." in name.split("/"):
        raise UsageError(f"{shown(name)} is not in the study's folder")
    return name


def result_name(name, where):
    """inner_name() of a file of results, such as metrics/a.json; `where` begins the message."""
    if not isinstance(name, str) or inner_name(name).partition("/")[0] not in FORMATS:
        raise UsageError(f"{where}: {shown(name)} is not a file in one of the folders {', '.join(FORMATS)}")
    return name


def age(path):
    """Time of the last change, ns; 0 where there is no such file."""
    try:
        return os.stat(path).st_mtime_ns
    except OSError:
        return 0


def read_targets(folder):
    """targets.txt: for each of the cases' metrics, scores and verdicts, their log and the files that they are made of."""
    path = os.path.join(folder, "targets.txt")
    with open(path, encoding="utf-8", errors="surrogateescape") as file:
        targets = [[inner_name(word) for word in line.split()] for line in file]
    for number, words in enumerate(targets, 1):
        if len(words) < 2 or "/" not in words[0]:
            raise UsageError(f"{path}: line {number}: needs a file of results, its log, and the files that it is made of")
    return targets


def read_log(path):
    """(how the recipe of this log ended, "exit CODE ...", its messages); "" where it has not ended."""
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            lines = file.read().splitlines()
    except OSError:
        lines = []
    end = lines[-1][2:] if lines and lines[-1].startswith("# exit ") else ""
    return end, [line for line in lines if not line.startswith("# ")]


def name_of(folder, identity):
    """The cases that a stage is made for, by names.txt: "range noise 0.0167 m, repeat 3"; its id where that is not known."""
    try:
        with open(os.path.join(folder, "names.txt"), "rb") as file:
            text = b"\n" + file.read()
    except OSError:
        return identity
    _, key, rest = text.partition(f"\n{identity}\t".encode())
    return rest.split(b"\n", 1)[0].decode(errors="replace") if key else identity


def age_of(folder, name):
    """The age of a target; of a score, that of its sites if they are older."""
    own = age(os.path.join(folder, name))
    return min(own, age(os.path.join(folder, sites_of(name)))) if kind_of(name) == "score" else own


def missing_targets(folder):
    """Names of the files still to be made: results that are absent or older than the tools, and their missing inputs."""
    tools = age(os.path.join(folder, "tools.txt"))
    missing, known = {}, {}
    for result, _, *needs in read_targets(folder):
        if age_of(folder, result) >= tools:
            continue
        for name in (*needs, result):
            if name not in known:
                known[name] = age_of(folder, name) >= tools
            if not known[name]:
                missing[name] = True
    return list(missing)


class Session:
    """Counts of one call of make, by kind of stage. No dataclass: run-stage starts once a stage, and to import dataclasses takes 8 ms."""

    def __init__(self, id, started, todo, done=None, failed=None, seconds=None):  # pylint: disable=redefined-builtin
        self.id = id
        self.started = started
        self.todo = todo
        self.done = done or {}
        self.failed = failed or {}
        self.seconds = seconds or {}  # in which the stages that are done were made

    def add(self, kind, number, ok, seconds):
        counts = self.done if ok else self.failed
        counts[kind] = counts.get(kind, 0) + number
        if ok:
            self.seconds[kind] = self.seconds.get(kind, 0) + seconds

    def left(self, kind):
        return max(0, self.todo.get(kind, 0) - self.done.get(kind, 0) - self.failed.get(kind, 0))

    def remaining_s(self, now):
        """Estimate by the mean time of each kind and by how many ran at a time; None before anything is done."""
        done, spent = sum(self.done.values()), sum(self.seconds.values())
        if not done or spent <= 0:
            return None
        work = sum(self.left(kind) * (self.seconds[kind] / self.done[kind] if self.done.get(kind) else spent / done)
                   for kind in self.todo)
        at_a_time = max(1.0, spent / max(now - self.started, 1e-3))
        return work / at_a_time

    def line(self, now):
        left = sum(self.left(kind) for kind in self.todo)
        text = f"{sum(self.done.values())} done, {sum(self.failed.values())} failed, {left} left"
        seconds = self.remaining_s(now)
        return f"{text}, about {duration(seconds)} to go" if left and seconds is not None else text


def duration(seconds):
    """A time in words: 42 s, 3 min, 2.5 h."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"


@contextlib.contextmanager
def locked_session(folder, identity):
    """The session of this name, begun where there is none; what is changed in it is kept."""
    path = os.path.join(folder, "session.json")
    with open(os.path.join(folder, "session.lock"), "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        session = None
        with contextlib.suppress(OSError, ValueError, TypeError), open(path, encoding="utf-8") as file:
            session = Session(**json.load(file))
        if session is None or session.id != identity:
            todo = dict(collections.Counter(map(kind_of, missing_targets(folder))))
            session = Session(identity, time.time(), todo)
        yield session
        write_text(path, json.dumps(vars(session)), is_synced=False)
