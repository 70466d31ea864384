#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a command of schemas/dictionary/tools.json that is a module of the package landfall: start.py 'plot dem' ARGUMENTS, as `landfall plot dem`
does. In a clone each file of commands/ is a link to this program, which then runs the module of the link's name."""
import importlib.util
import json
import os
import sys

HERE = os.path.dirname(os.path.realpath(__file__))


def commands():
    with open(os.path.join(HERE, "..", "schemas", "dictionary", "tools.json"), encoding="utf-8") as file:
        return [row for row in json.load(file)["tools"] if "module" in row]


def row_of(called, arguments):
    """The row of the command, and the arguments of its module."""
    if called == "start.py":
        found = [row for row in commands() if arguments[:1] == [row["command"]]]
        arguments = [*(found[0]["module"].split()[1:] if found else []), *arguments[1:]]
    else:
        name = called.removesuffix(".py")
        found = [row for row in commands() if name in (row["name"].replace(" ", "-"), row["module"].split()[0].rsplit(".", 1)[-1])]
    if not found:
        sys.exit(f"{called}: {' '.join(sys.argv[1:2])} is not a command of landfall in Python")
    return found[0], arguments


def main():
    os.environ["MPLBACKEND"] = "Agg"  # figures are files: no display is needed
    row, arguments = row_of(os.path.basename(sys.argv[0]), sys.argv[1:])
    module, *words = row["module"].split()
    name = " ".join(row["name"].split()[:-1] if words else row["name"].split())  # landfall study, whose list, show and prune are one module
    sys.argv = [name, *arguments]
    shared = importlib.import_module("landfall.command")
    try:
        if ".plot_" in module:
            shared.import_matplotlib()
        command = importlib.import_module(f"landfall.{module}")
    except ModuleNotFoundError as error:
        modules = sorted({error.name, "h5py", "matplotlib", "numpy"})
        missing = [f"python3-{module}" for module in modules if module == error.name or importlib.util.find_spec(module) is None]
        sys.exit(f"{name}: {sys.executable} has no module {error.name}; apt-get install {' '.join(missing)}")
    shared.run(command.main)


if __name__ == "__main__":
    main()
