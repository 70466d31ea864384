# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a command of the package landfall, which is in the folder beside this one."""
import importlib
import os
import sys


def start(module):
    """Calls main(arguments) of the package's module."""
    os.environ["MPLBACKEND"] = "Agg"  # figures are files: no display is needed
    sys.path[0] = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
    main = importlib.import_module(f"landfall.{module}").main
    importlib.import_module("landfall.command").run(main)
