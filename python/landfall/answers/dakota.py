# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the model of a file for Dakota (https://dakota.sandia.gov): reads its parameters file, writes its results file.

docs/user/studies/model.md has an input file of Dakota.
"""
import os
import re

import numpy as np

from landfall import command, schema, tools
from landfall.answers import model, runs
from landfall.errors import DataError, printable

# { DAKOTA_VARS = 3 }, { velocity = 1.5e-01 }; a value may be in quotation marks.
APREPRO = re.compile(r'\{\s*(\S+)\s*=\s*"?([^"{}]*?)"?\s*\}')
KEYS = ("base", "inputs", "outputs")


def read_parameters(path):
    """({variable: number}, [(name of a function, its requested values)]) of a file in Dakota's standard or APREPRO format."""
    try:
        with open(path, encoding="utf-8") as file:
            lines = [line.strip() for line in file]
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{path}: {getattr(error, 'strerror', None) or 'is not a text'}") from error
    pairs = [_pair(path, number, line) for number, line in enumerate(lines, 1) if line]
    counts = ("DAKOTA_VARS", "DAKOTA_FNS") if any(line.startswith("{") for line in lines) else ("variables", "functions")
    variables = {name: _number(path, name, value) for name, value in _part(path, pairs, counts[0])}
    functions = [(name.removeprefix("DAKOTA_").split(":", 1)[-1], int(_number(path, name, value))) for name, value in _part(path, pairs, counts[1])]
    return variables, functions


def _pair(path, number, line):
    """(name, value as text) of a line."""
    found = APREPRO.fullmatch(line)
    if found:
        return found[1], found[2]
    words = line.split(maxsplit=1)
    if line.startswith("{") or len(words) != 2:
        raise DataError(f"{path}: line {number}: \"{line}\" is neither \"VALUE NAME\" nor \"{{ NAME = VALUE }}\"")
    return words[1], words[0]


def _part(path, pairs, count_name):
    """The pairs that follow the line with their number."""
    at = next((i for i, (name, _) in enumerate(pairs) if name == count_name), None)
    if at is None:
        raise DataError(f"{path}: has no line with the number of {count_name}")
    count = int(_number(path, count_name, pairs[at][1]))
    found = pairs[at + 1:at + 1 + count]
    if len(found) < count:
        raise DataError(f"{path}: ends after {len(found)} of {count} {count_name}")
    return found


def _number(path, name, text):
    try:
        return float(text)
    except ValueError as error:
        raise DataError(f"{path}: {name}: \"{text}\" is not a number") from error


def read_model(path, folder, workers=1):
    """The model of a file {"base": ..., "inputs": ..., "outputs": ...}."""
    tree = schema.read_json(path)
    keys = dict.fromkeys((*KEYS, "$comment"), {})
    schema.check(tree, {"type": "object", "required": KEYS, "properties": keys, "additionalProperties": False}, path)
    return model.Model(runs.read_base(tree["base"], os.path.dirname(os.path.abspath(path)), path), tree["inputs"], tree["outputs"], folder, workers)


def results_text(of, found, functions):
    """Dakota's results file: a line per function, or the word by which an evaluation fails."""
    if of.failures or not np.all(np.isfinite(found)):
        return "fail\n"
    return "".join(f"{value:.17g} {label}\n" for value, (label, asked) in zip(found, functions) if asked)


def main(arguments):
    parser = command.Parser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("parameters", metavar="PARAMS", help="Dakota's parameters file, standard or APREPRO format")
    parser.add_argument("results", metavar="RESULTS", help="Dakota's results file")
    parser.add_argument("--model", metavar="FILE", default="model.json", help="base, inputs and outputs (model.json)")
    parser.add_argument("--folder", metavar="DIR", default="landfall-model", help="where results are kept and found again (landfall-model)")
    parser.add_argument("--bin", metavar="DIR", help="where the tools are (default: next to this package, or on PATH)")
    options = parser.parse_args(arguments)
    if options.bin:
        tools.BIN = options.bin
    of = read_model(options.model, options.folder)
    values, functions = read_parameters(options.parameters)
    for name in of.inputs:
        if name not in values:
            raise DataError(f"{options.parameters}: has no variable {name}, an input of {options.model}")
    if len(functions) != len(of.outputs):
        raise DataError(f"{options.parameters}: asks for {len(functions)} functions, {options.model} has {len(of.outputs)} outputs")
    if any(asked not in (0, 1) for _, asked in functions):
        raise DataError(f"{options.parameters}: asks for derivatives, which landfall does not have; use numerical_gradients")
    found = of([values[name] for name in of.inputs])
    text = results_text(of, found, functions)
    command.write_text(options.results, text)
    for why in of.failures.values():
        print(printable(f"landfall model: {options.parameters}: {why}"), file=os.sys.stderr)
