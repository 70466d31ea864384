# SPDX-License-Identifier: GPL-3.0-or-later
"""How each case of a planned study is made, by the rules of its study.mk: the runs of tools that it depends on, their
configurations, their times, and why one failed."""
import json
import os
import re
from dataclasses import dataclass

from landfall.errors import UsageError
from landfall.study.session import inner_name, read_log
from landfall.study.stages import UPSTREAM

RULE = re.compile(r"\t\$\(call stage,([a-z]+),([0-9a-f]+),[^)]*\) (.*)")
KINDS = ("terrain", "truth", *list(UPSTREAM)[1:])
# How many files a step reads: they follow its configuration, and its output follows them.
INPUTS = {"terrain": 0, "scan": 2, "regrid": 2, "eval": 1, "hazard": 2, "draws": 2}
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
        except (LookupError, ValueError) as error:
            raise UsageError(f"{path}: no plan of a study ({error})") from error

    def _add(self, rule, recipe, steps):
        within = {}  # kind: the latest output of the recipe that has no name
        self.steps[recipe] = len(steps)
        for index, step in enumerate(steps):
            name, config, *words = map(inner_name, step.split())
            inputs = tuple(within[UPSTREAM[name]] if word == "@" else word for word in words[:INPUTS[name]] if word != "-")
            output = words[INPUTS[name]]
            if output == "@":
                output = within[name] = f"{recipe}/{index}"
            kind = "truth" if rule == "truth" and name == "scan" else name
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
            path = os.path.join(self._folder, "log", recipe)
            end, messages = read_log(path + ".log")
            self._known[recipe] = end, messages[-TAIL_LINES:], _summaries(path + ".json")
        return self._known[recipe]

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


def _summaries(path):
    """The JSON objects of a file, one after another; none if one of them is invalid."""
    decoder, found = json.JSONDecoder(), []
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            text = file.read().lstrip()
        while text:
            tree, end = decoder.raw_decode(text)
            found.append(tree)
            text = text[end:].lstrip()
    except (OSError, ValueError):
        return []
    return found
