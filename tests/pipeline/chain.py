# SPDX-License-Identifier: GPL-3.0-or-later
"""The tiny case of tests/cli/tools.py, read back from its files by h5py alone."""
import json
import os
import sys

import h5py
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
# pylint: disable=wrong-import-position,unused-import
from tools import CONFIGS, SANITIZED, TOOLS, Chain, ChainTest, ToolTest, read_bytes, run, tool, with_values


def columns(path, group):
    """The datasets of a group (or of the root) as arrays."""
    with h5py.File(path) as file:
        return {name: item[()] for name, item in file[group].items()
                if isinstance(item, h5py.Dataset) and item.shape}


def config_of(path):
    with h5py.File(path) as file:
        return json.loads(file["provenance/config_json"].asstr()[()])


def returns_of(path):
    points = columns(path, "points")
    keep = np.isin(points["status"], [0, 6])
    return {name: values[keep] for name, values in points.items()}


class Surface:
    """H(x, y): the triangulated surface of a terrain file, cells split from (i + 1, j) to (i, j + 1)."""

    def __init__(self, path):
        grid = columns(path, "/")
        self.x, self.y, self.z = grid["x"], grid["y"], grid["z"]

    def elevation(self, x, y):
        step = self.x[1] - self.x[0]
        u, v = (x - self.x[0]) / step, (y - self.y[0]) / step
        inside = (u >= 0) & (v >= 0) & (u <= len(self.x) - 1) & (v <= len(self.y) - 1)
        i = np.clip(np.floor(np.where(inside, u, 0)).astype(int), 0, len(self.x) - 2)
        j = np.clip(np.floor(np.where(inside, v, 0)).astype(int), 0, len(self.y) - 2)
        p, q = u - i, v - j
        z00, z10, z01, z11 = (self.z[j + dj, i + di] for dj, di in [(0, 0), (0, 1), (1, 0), (1, 1)])
        lower = z00 + p * (z10 - z00) + q * (z01 - z00)
        upper = z11 + (1 - p) * (z01 - z11) + (1 - q) * (z10 - z11)
        return np.where(inside, np.where(p + q <= 1, lower, upper), np.nan)
