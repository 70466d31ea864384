# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the extension module that the tools' build makes (tools/python.cpp), and gives its names."""
import glob
import importlib.machinery
import importlib.util
import os

from landfall import tools
from landfall.errors import Error

_NAME = "landfall_engine"


FOLDER = os.path.dirname(os.path.realpath(tools.find("scan-sim")))  # of the tools that the module belongs to


def _loaded():
    beside = os.path.join(os.path.dirname(FOLDER), "lib")
    places = [os.path.join(beside, "landfall", _NAME + ".so"), *glob.glob(os.path.join(beside, "*", "landfall", _NAME + ".so"))]
    path = next(filter(os.path.exists, places), None)
    if path is None:
        raise Error(f"{places[0]}: no such module; build landfall with pybind11-dev and libpython3-dev installed")
    loader = importlib.machinery.ExtensionFileLoader(_NAME, path)
    try:
        module = importlib.util.module_from_spec(importlib.util.spec_from_file_location(_NAME, path, loader=loader))
        loader.exec_module(module)
    except ImportError as error:
        raise Error(f"{path}: cannot be loaded by this Python: {error}") from error
    return module


_module = _loaded()
File, Lidar, Surface = _module.File, _module.Lidar, _module.Surface
run, write_points, write_terrain = _module.run, _module.write_points, _module.write_terrain
