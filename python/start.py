#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The program that each file of commands/ is a link to. It runs the module of the package landfall that has the command's name."""
import importlib
import os
import sys

ROOMS = ("", "plot", "study", "answers")
OTHER_NAMES = {"landfall-model": "dakota"}


def main():
    os.environ["MPLBACKEND"] = "Agg"  # figures are files: no display is needed
    command, package = os.path.basename(sys.argv[0]), os.path.join(os.path.dirname(os.path.realpath(__file__)), "landfall")
    module = OTHER_NAMES.get(command, command.removesuffix(".py"))
    rooms = [room for room in ROOMS if os.path.exists(os.path.join(package, room, module + ".py"))]
    if not rooms:
        sys.exit(f"{command}: is not the name of a command of landfall")
    shared = importlib.import_module("landfall.command")
    if rooms == ["plot"] or module == "plot_study":
        shared.import_matplotlib()
    shared.run(importlib.import_module(".".join(filter(None, ("landfall", *rooms, module)))).main)


if __name__ == "__main__":
    main()
