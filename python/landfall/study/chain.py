# SPDX-License-Identifier: GPL-3.0-or-later
"""How each case of a planned study is made, by the rules of its study.mk: the runs of tools that it depends on, their
configurations, their times, and why one failed."""
import json
import os
import re
from dataclasses import dataclass

from landfall.errors import UsageError
from landfall.study.session import inner_name

RULE = re.compile(r"\t\$\(call stage,([a-z]+),([0-9a-f]+),[^)]*\) (.*)")
KINDS = ("terrain", "truth", "scan", "regrid", "eval", "hazard", "draws")
OPTIONS = ("--corrected", "--uncertainty")
TAIL_LINES = 20


@dataclass(frozen=True)
class Run:
    """One run of a tool: a step of a recipe."""

    kind: str  # of KINDS
    config: str  # a file's name, relative to the study's folder
    output: str  # relative to the study's folder, too; for a temporary file of a recipe, a unique name
    recipe: str  # KIND-ID, which names the log
    index: int  # its place among the recipe's steps
    inputs: tuple  # outputs of other runs
    options: tuple = ()  # of the study: --corrected, --uncertainty


class Chains:
    """All runs of a study, from study.mk. Throws UsageError where the folder has none, or one that this does not understand."""

    def __init__(self, folder):
        path = os.path.join(folder, "study.mk")
        self._of = {}  # output: Run
        self.steps = {}  # recipe: number of steps
        try:
            with open(path, encoding="utf-8") as file:
                rules = [match.groups() for match in map(RULE.match, file) if match]
            for kind, identity, steps in rules:
                self._add(kind, f"{kind}-{identity}", steps.replace("$O/", "").split(" + "))
        except OSError as error:
            raise UsageError(f"{path}: {error.strerror}") from error
        except ValueError as error:
            raise UsageError(f"{path}: no plan of a study ({error})") from error

    def _add(self, rule, recipe, steps):
        within = {}  # scan, dem: the latest of the recipe
        self.steps[recipe] = len(steps)
        for index, step in enumerate(steps):
            name, config, *words = map(inner_name, step.split())
            if name == "terrain":
                kind, inputs, output = name, (), words[0]
            elif name == "scan":
                terrain, ranges, output = words[:3]
                kind = "truth" if rule == "truth" else "scan"
                inputs = (terrain,) if ranges == "-" else (terrain, ranges)
            elif name == "regrid":
                scan, terrain, output = words[:3]
                kind, inputs = name, (within["scan"] if scan == "@" else scan, terrain)
            elif name == "hazard":
                dem, terrain, output = words[:3]
                kind, inputs = name, (within["dem"] if dem == "@" else dem, terrain)
            elif name == "draws":
                truth, terrain, output = words[:3]
                kind, inputs = name, tuple(file for file in (truth, terrain) if file != "-")
            else:
                dem, output = words[:2]
                kind, inputs = name, (within["dem"] if dem == "@" else dem,)
            if output == "@":
                output = f"{recipe}/{index}"
                within["scan" if kind == "scan" else "dem"] = output
            self._of[output] = Run(kind, config, output, recipe, index, inputs, tuple(word for word in words if word in OPTIONS))

    def of(self, results):
        """The runs that the files of a case's results are made by, each once, in the order in which they can be run."""
        runs, pending = {}, [*results]
        while pending:
            output = pending.pop()
            run = self._of.get(output)
            if run is None:
                raise UsageError(f"study.mk: no rule makes {output}")
            runs[run.output] = run
            pending.extend(run.inputs)
        return tuple(sorted(runs.values(), key=lambda run: KINDS.index(run.kind)))


class Logs:
    """The logs of a study's runs; each file is read once."""

    def __init__(self, folder, chains):
        self._folder, self._chains, self._known = folder, chains, {}

    def _read(self, recipe):
        """(exit, tail, summaries) of a recipe; exit is "" where it has not ended."""
        if recipe not in self._known:
            text = _text(self._path(recipe))
            lines = text.splitlines()
            last = lines[-1] if lines and lines[-1].startswith("# exit ") else ""
            tail = [line for line in lines if not line.startswith("# ")][-TAIL_LINES:]
            self._known[recipe] = last[2:], tail, _summaries(_text(self._path(recipe)[:-4] + ".json"))
        return self._known[recipe]

    def _path(self, recipe):
        return os.path.join(self._folder, "log", recipe + ".log")

    def summary(self, run):
        """The tool's summary; None where it is not known, as of every run of a recipe that failed or was not run."""
        end, _, summaries = self._read(run.recipe)
        known = end.startswith("exit 0 ") and len(summaries) == self._chains.steps[run.recipe]
        return summaries[run.index] if known else None

    def failure(self, runs):
        """(name of the log, how its recipe ended, last lines) of the first of the runs that failed; None where none has."""
        for run in runs:
            end, tail, _ = self._read(run.recipe)
            if end and not end.startswith("exit 0 "):
                return f"log/{run.recipe}.log", end, tail
        return None


def _text(path):
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read()
    except OSError:
        return ""


def _summaries(text):
    """The JSON objects of a text, one after another; none if one of them is invalid."""
    decoder, found, at = json.JSONDecoder(), [], 0
    try:
        while text[at:].strip():
            at += len(text[at:]) - len(text[at:].lstrip())
            tree, at = decoder.raw_decode(text, at)
            found.append(tree)
    except ValueError:
        return []
    return found
