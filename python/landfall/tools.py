# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the tools and their data, and runs the tools."""
import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile

from landfall.errors import DataError, printable, ToolError, UsageError

# Holds schemas/ and studies/: the folder share of a package that pip installed; else the folder above python/, a clone or PREFIX/share/landfall.
_HERE = os.path.dirname(os.path.realpath(__file__))
SHARE = os.path.join(_HERE, "share") if os.path.isdir(os.path.join(_HERE, "share")) else os.path.dirname(os.path.dirname(_HERE))
IS_CLONE = os.path.exists(os.path.join(SHARE, "CMakeLists.txt"))
BIN = os.path.abspath(os.environ.get("LANDFALL_BIN") or os.path.join(SHARE, "build/release/bin" if IS_CLONE else "../../bin"))


def find(tool, folder=None):
    """The path of a tool: in the given folder, else in $LANDFALL_BIN or the installation of this package, else on PATH."""
    path = os.path.join(folder or BIN, tool)
    found = path if os.access(path, os.X_OK) else None if folder else shutil.which(tool)
    if found is None:
        raise ToolError(f"{path}: no such program" + ("" if folder else ", and none on PATH"))
    return found


def run_tool(path, *arguments, **options):
    """Runs a program and returns its output. Throws ToolError with its message if it fails."""
    try:
        result = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True, check=False, **options)
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror}") from error
    if result.returncode != 0:
        how = "was killed (SIGKILL), as when memory runs out" if result.returncode == -signal.SIGKILL else f"exit code {result.returncode}"
        raise ToolError(result.stderr.strip() or f"{path}: {how}", result.returncode)
    return result


@contextlib.contextmanager
def naming_input(where):
    """The message of a tool that gets a configuration on standard input names `where` it comes from instead, as "study.json: /base/scan"."""
    def place(found):
        return printable(where + "/" if found.group(1) else where.removesuffix(": ") + ": ")
    try:
        yield
    except ToolError as error:
        raise ToolError(re.sub("standard input: (/?)", place, str(error)), error.exit_code) from error


def check_files(*paths):
    """Throws DataError unless each file is one that the tools open: the check of landfall-info --check, by which a file that could crash
    HDF5, load a program or lead to another file is refused before HDF5 reads it. Costs some 50 ms and reads no values."""
    for first in range(0, len(paths), 500):
        names = [os.path.join(".", path) if path.startswith("-") else path for path in map(os.fspath, paths[first:first + 500])]
        try:
            run_tool(find("landfall-info"), "--check", "-q", *names)
        except ToolError as error:
            refusal = str(error).removeprefix("landfall-info: ")
            if error.exit_code == 1 and refusal != str(error):
                raise DataError(refusal) from error
            raise ToolError(f"{names[0]}: cannot be checked: {error}; set LANDFALL_BIN to the folder of landfall's tools") from error


def seal_file(path):
    """Adds the tools' seal to a file of landfall that Python wrote, so that any damage to it shows."""
    run_tool(find("landfall-info"), "--seal", "-q", path)


def sound_files(paths):
    """The files that check_files() accepts."""
    try:
        if paths:
            check_files(*paths)
        return paths
    except DataError:
        half = len(paths) // 2
        return [*sound_files(paths[:half]), *sound_files(paths[half:])] if half else []


def run(tool, config, inputs, output, options):
    """Runs a tool as landfall.run does. Returns (the path of its output or None, its printed text)."""
    with tempfile.TemporaryDirectory(prefix="landfall-configs-") as folder:
        arguments, standard_input, names = config_words(config, folder)
        arguments = [*(_path(name, "an input") for name in inputs), *arguments]
        for name, value in options.items():
            arguments += option_words("--" + name.replace("_", "-"), value)
        if output is not None:
            arguments += ["-o", _path(output, "output")]
        try:
            program, *words = tool.replace("landfall-run", "landfall run").split()
            done = run_tool(find(program), *words, *arguments, input=standard_input)
        except ToolError as error:
            message = str(error)
            for name, where in names.items():
                message = message.replace(name, where)
            raise ToolError(message, error.exit_code) from error
    sys.stderr.write(done.stderr)
    return None if output is None else os.fspath(output), done.stdout


def config_words(config, folder):
    """The -c arguments of one configuration or of several that are merged in order, the text of standard input: the first dict, and names of dicts
    in messages. Other dicts are written to files in `folder`."""
    arguments, standard_input, names = [], "", {}
    several = isinstance(config, (list, tuple)) and len(config) > 1
    for number, one in enumerate(config if isinstance(config, (list, tuple)) else [] if config is None else [config], 1):
        if not isinstance(one, dict):
            name = _config_name(_path(one, "a configuration", "a dict, the path of a JSON file or the name of a preset"))
        elif not standard_input:
            name, standard_input = "-", _json(one)
            names["standard input"] = f"configuration {number}" if several else "the configuration"
        else:
            name = os.path.join(folder, f"configuration-{number}.json")
            with open(name, "w", encoding="utf-8") as file:
                file.write(_json(one))
            names[name] = f"configuration {number}"
        arguments += ["-c", name]
    return arguments, standard_input, names


def _path(value, what, expected="a path"):
    try:
        return os.fsdecode(value)
    except TypeError as error:
        raise UsageError(f"{what} is {expected}, not of type {type(value).__name__}") from error


def _json(value):
    """The JSON of a value that may hold numpy's numbers and arrays."""
    def plain(inner):
        if not hasattr(inner, "tolist"):
            raise UsageError(f"a configuration holds a value of type {type(inner).__name__}, which JSON does not have")
        return inner.tolist()
    return json.dumps(value, default=plain)


def _config_name(name):
    """The argument of -c: the path of a file, or a preset, whose name may lack the "preset:"."""
    is_file = os.path.exists(name) or os.path.basename(name) != name or name.endswith(".json")
    return name if is_file or name.startswith("preset:") else "preset:" + name


def option_words(name, value):
    """The words of a command line that give an option this value; none for None and False."""
    if value is None or value is False:
        return []
    if value is True:
        return [name]
    if isinstance(value, dict):
        return [word for key, inner in value.items() for word in (name, f"{key}={_json(inner)}")]
    return [name, ",".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)]
