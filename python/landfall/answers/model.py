# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D356
"""The model of landfall.model, its runs, and the engines that use it."""
import concurrent.futures
import copy
import importlib
import math
import os
import re

import numpy as np

from landfall import dictionary
from landfall.answers import runs
from landfall.errors import ToolError, UsageError
from landfall.study.model import assign, plain_numbers

SEED, DRAW = "scan.seed", "scan.draw"  # which random numbers a row has; all errors are functions of both
# The outputs that monte-carlo has without percentiles ("metrics": "verdict"), several times faster, with the same values.
DECISIVE = [number for requirement in dictionary.requirements().values() for number in requirement.value.split(" + ")]
VERDICT_NUMBERS = re.compile("|".join([r"coverage\..*|requirements\..*|own_requirements\..*|pass|score\..*|site\..*|landing\..*|blind\..*", *map(re.escape, DECISIVE)]))


def model(base, inputs, outputs, folder="landfall-model", workers=1, prefix=(), progress=None, traced=None):
    """The pipeline as a callable from a vector, or a table, of configuration values to metrics.

    base: {stage: configuration} with the stages terrain, scan, regrid, eval and hazard; a configuration is a dict, a file or
    preset:NAME. inputs: keys such as "scan.noise.range_sigma_m", or {name: key or list of keys}. outputs: numbers of metrics.json by
    their dotted paths, such as "accuracy.relative.z.max_m" or "pass", and of a base with hazard "score.*" and "site.*".
    folder: results are kept there and found again. workers: runs at a time. prefix: words of a command that runs another one, as srun.
    traced: {} has every row traced by monte-carlo without a scan; its keys are monte-carlo's terrain_seed, uncertainty and landing, which adds the
    outputs "landing.*" and "blind.*". With terrain_seed "each" the ground has the number scan.draw, and the seed terrain.seed + scan.seed -
    the base's scan.seed. Inputs scan.draw, at most 99999, repeat a row with other random numbers; consecutive ones are run together.

    The callable takes the shape (inputs,) or (rows, inputs), in the units that end the names of the keys, and returns (outputs,) or
    (rows, outputs), in the units that end those of the metrics; true is 1, a row that a tool refuses NaN, with the reason in `failures`.
    `progress`: an object with start(what, count) and clear(), or None. Raises UsageError, with stage and key, if a configuration, an input or an
    output is unknown, and ToolError if a tool is missing or killed.
    """
    return Model(runs.read_base(base, os.getcwd(), "model"), inputs, outputs, folder, workers, prefix, progress, traced)


class Model:
    """See model(). `base` is resolved (runs.read_base)."""

    def __init__(self, base, inputs, outputs, folder, workers=1, prefix=(), progress=None, traced=None):
        named = inputs if isinstance(inputs, dict) else {key: key for key in inputs}
        self.inputs = {name: [keys] if isinstance(keys, str) else list(keys) for name, keys in named.items()}
        self.base, self.outputs, self.workers, self.progress, self.traced = base, list(outputs), workers, progress or runs.Silent(), traced
        if not self.inputs or not self.outputs:
            raise UsageError("model: needs an input and an output")
        self.failures = {}
        self.runner = runs.Runner(folder, 0 if workers == 1 else 1, prefix)
        set_values(copy.deepcopy(base), {key: 0 for keys in self.inputs.values() for key in keys})

    def __call__(self, values):
        """A vector of metrics for a vector of values, a table (rows x outputs) for a table (rows x inputs).

        A function of the values alone: equal rows have equal random numbers, unless scan.draw or scan.seed is an input. A row that a tool
        refuses is NaN, and failures[i] says why; so is a metric that a DEM does not have.
        """
        table = np.asarray(values, dtype=float)
        is_vector = table.ndim == 1
        table = np.atleast_2d(table)
        if table.shape[1] != len(self.inputs):
            raise UsageError(f"model: {table.shape[1]} values in a row; the inputs are {len(self.inputs)}: {', '.join(self.inputs)}")
        self.failures = {}
        found = self._run(self._rows_of(table))
        results = np.full((len(table), len(self.outputs)), np.nan)
        for i, numbers in enumerate(found):
            if "error" in numbers:
                self.failures[i] = numbers["error"]
                continue
            missing = [name for name in self.outputs if name not in numbers]
            if missing:
                raise UsageError(f"model: {missing[0]}: is not a number of a DEM; they are {', '.join(sorted(numbers))}")
            results[i] = [math.nan if numbers[name] is None else numbers[name] for name in self.outputs]
        return results[0] if is_vector else results

    def _rows_of(self, table):
        """[{key: value}]"""
        return [{key: plain_numbers(float(value)) for keys, value in zip(self.inputs.values(), row) for key in keys} for row in table]

    def tasks_of(self, table):
        """The runs of tools that the rows of a table need, in order."""
        return list(self._tasks(dict(enumerate(self._rows_of(table)))))

    def _run(self, rows):
        """For each row, {key: value}, its numbers, or {"error": why there are none}."""
        found = [None if all(map(math.isfinite, row.values())) else {"error": "a value is not a finite number"} for row in rows]
        tasks = list(self._tasks({number: row for number, row in enumerate(rows) if found[number] is None}))
        self.progress.start("draws", len(rows))
        with Workers(self.workers) as threads:
            for numbers, outcome in threads.map(lambda task: (task.numbers, task()), tasks):
                for number, result in zip(numbers, outcome):
                    found[number] = result
        self.progress.clear()
        return found

    def _drawn(self, rows):
        """The keys of which the draws of one run may have different values."""
        row = next(iter(rows.values()), {})
        if self.traced is None:
            return {key for key in row if runs.is_redrawn(key, self.base["scan"])}
        whole = runs.TracedDraws(self.runner, self.base, self.traced)
        return {key for key, value in row.items() if key not in (SEED, DRAW) and whole.varies(key, value)}

    def _configs(self, values):
        return set_values(copy.deepcopy(self.base), values)

    def _tasks(self, rows):
        """Rows, by their number, that differ in drawn keys only share a run of draws, in parts of consecutive draws: over one traced scan, unless each
        draw traces its own rays. Rows that cannot go through the chain."""
        drawn, groups = self._drawn(rows), {}
        for number, row in rows.items():
            fixed = tuple((key, value) for key, value in row.items() if key not in drawn and key not in (SEED, DRAW))
            groups.setdefault(fixed, []).append(number)
        for fixed, numbers in groups.items():
            is_alone = self.traced is None and len(numbers) == 1
            configs = None if is_alone else self._configs(dict(fixed))
            if is_alone or (self.traced is None and runs.needs_chain(configs["scan"])):
                for number in numbers:
                    yield _Chain(self, [number], self._configs(rows[number]))
                continue
            parts = list(_parts(numbers, [tuple(rows[number].get(key, configs["scan"][key.split(".")[1]]) for key in (SEED, DRAW)) for number in numbers]))
            draws = runs.Scan(self.runner, configs, len(parts)) if self.traced is None else runs.TracedDraws(self.runner, configs, self.traced)
            for part, seed, draw in parts:
                samples = [{key: value for key, value in rows[number].items() if key in drawn} for number in part]
                yield _DrawnRows(self, part, draws, samples, (seed, draw))


def _parts(numbers, keys):
    """(numbers of rows, seed, first draw): consecutive draws of a seed, few enough that little is lost where a run is cut off. `keys`: (seed, draw)."""
    part, first = [], None
    for number, (seed, draw) in zip(numbers, keys):
        if part and ((seed, draw) != (first[0], first[1] + len(part)) or len(part) == runs.PART_DRAWS):
            yield (part, *first)
            part = []
        if not part:
            first = seed, draw
        part.append(number)
    yield (part, *first)


class _Task:
    """Makes the results of some rows, or finds them. Calling it gives them; only refusals of a configuration are kept as results."""

    def __call__(self):
        try:
            result, is_found = self.runner.cached(self.kind, self.depends, self.make, lambda rows: all(map(runs.is_steady, rows)))
        finally:
            self.end()
        self.progress.step(*((0, len(result)) if is_found else (len(result), 0)))
        return result

    def end(self):
        pass


class _Chain(_Task):
    """A row that shares its rays with no other one."""
    is_chain = True

    def __init__(self, of, numbers, configs):
        self.numbers, self.runner, self.progress, self.configs = numbers, of.runner, of.progress, configs
        self.kind, self.depends = "row", configs

    def make_some(self, _number):
        """As make(), with errors."""
        return self.runner.numbers(self.configs)

    def make(self):
        try:
            return [self.runner.numbers(self.configs)]
        except ToolError as error:
            return [{"error": str(error), "code": error.exit_code}]


class _DrawnRows(_Task):
    """Rows over one traced scan, which are consecutive draws of a seed. `first`: (seed, number of the first draw)."""
    is_chain = False

    def __init__(self, of, numbers, scan, samples, first):
        self.numbers, self.runner, self.progress, self.scan, self.samples, self.first = numbers, of.runner, of.progress, scan, samples, first
        needed = [*of.outputs, *(own["metric"] for own in scan.configs["eval"].get("requirements", []))]
        self.metrics = "verdict" if all(VERDICT_NUMBERS.fullmatch(name) for name in needed) else "full"
        self.kind, self.depends = "rows", [*scan.depends, samples, first, self.metrics]

    def make(self):
        return self._rows(self.samples, *self.first)

    def make_some(self, number):
        """Makes some of the draws, and keeps none; with errors."""
        seed, draw = self.first
        self.scan.rows({"metrics": self.metrics, "draws": number, "scan": {"seed": seed}})

    def _rows(self, samples, seed, draw):
        end, keys = draw + len(samples), list(samples[0])
        changes = {"metrics": self.metrics, "draws": end, "scan": {"seed": seed}}
        table = (keys, [list(row.values()) for row in [samples[0]] * draw + samples])  # a row for each draw from 0 on
        try:
            return self.scan.rows(changes, *(["--draws", f"{draw}:{end}"] if draw else []), samples=table if keys else None)
        except ToolError as error:
            if len(samples) == 1:
                return [{"error": str(error), "code": error.exit_code}]
            half = len(samples) // 2  # a row that is refused ends the whole run
            return self._rows(samples[:half], seed, draw) + self._rows(samples[half:], seed, draw + half)

    def end(self):
        self.scan.done()


class Workers(concurrent.futures.ThreadPoolExecutor):
    """A thread pool that starts nothing new after an error or Ctrl-C."""

    def __exit__(self, kind, value, trace):
        self.shutdown(wait=True, cancel_futures=kind is not None)
        return False


def set_values(configs, values):
    """The configurations with {key "stage.a.b": value} set in them. Throws UsageError with the key."""
    for key, value in values.items():
        stage = key.split(".", 1)[0]
        if stage not in configs or "." not in key:
            raise UsageError(f"{key}: its first part is not one of {', '.join(configs)}")
        try:
            configs[stage] = assign(configs[stage], key, plain_numbers(value))
        except KeyError as error:
            raise UsageError(f"{key}: {error.args[0]}") from error
    return configs


# Engines


def openturns():
    return _engine("OpenTURNS")


def optuna():
    return _engine("Optuna")


def _engine(name):
    """The module, or UsageError that names its package."""
    try:
        return importlib.import_module(name.lower())
    except ImportError as error:
        raise UsageError(f"this needs {name}; install it with: apt-get install python3-{name.lower()}") from error


def openturns_function(of):
    """An openturns.Function of a callable like model(): a sample (rows x inputs) is one table, so that its rows run together.

    Inputs and outputs have the names and units of the model's. Raises UsageError if OpenTURNS is missing.
    """
    function = openturns().PythonFunction(len(of.inputs), len(of.outputs), func=lambda x: of(np.asarray(x)),
                                          func_sample=lambda sample: of(np.asarray(sample)))
    function.setInputDescription(list(of.inputs))
    function.setOutputDescription(list(of.outputs))
    return function


def margin(value, limit):
    """ln(value/limit): below 0 a requirement is met. Of a value of 0, and of a limit of 0 that is missed, it is as of a factor of 1000."""
    largest = math.log(1000)
    if not value > 0:
        return -largest
    return max(-largest, math.log(value / limit)) if limit > 0 else largest


def optuna_objective(of, bounds, constraints=None):
    """objective(trial) for Optuna: the first output of a callable like model().

    bounds: {input: (low, high)}, whole numbers if both are int, or {input: [values]}. constraints: {output: limit}; the margins
    ln(value/limit) are in trial.user_attrs["constraints"], for a sampler's constraints_func; limits have the units of the outputs. A row that
    fails prunes the trial. Raises UsageError if Optuna is missing, a constraint is no output, or bounds does not name each input once.
    """
    module = optuna()
    unknown = [name for name in constraints or {} if name not in of.outputs]
    if unknown or set(bounds) != set(of.inputs):
        raise UsageError(f"optuna_objective: {unknown[0]}: is not an output" if unknown else "optuna_objective: bounds need each input once")

    def objective(trial):
        values = dict(zip(of.outputs, of([suggest(trial, name, bounds[name]) for name in of.inputs])))
        if of.failures:
            raise module.TrialPruned(of.failures[0])
        margins = [margin(values[name], limit) for name, limit in (constraints or {}).items()]
        if not math.isfinite(values[of.outputs[0]]) or not all(math.isfinite(values[name]) for name in constraints or {}):
            raise module.TrialPruned("a metric has no value")
        trial.set_user_attr("constraints", margins)
        return float(values[of.outputs[0]])

    return objective


def suggest(trial, name, bounds):
    """A value of Optuna's: of a list one of its values, of a pair a number between."""
    if isinstance(bounds, list):
        return trial.suggest_categorical(name, bounds)
    if all(isinstance(bound, int) for bound in bounds):
        return trial.suggest_int(name, *bounds)
    return trial.suggest_float(name, *bounds)
