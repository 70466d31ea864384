# SPDX-License-Identifier: GPL-3.0-or-later
"""Base class of the generators of random configurations."""
import os

import numpy as np

from oracle import tables

DURATION_S = 0.12  # of a scan


class Drawing:
    """Draws random numbers, and writes tables to a folder, where configurations name them without a path."""

    def __init__(self, seed, folder):
        self.rng = np.random.default_rng(seed)
        self.folder = folder

    def between(self, low, high, count=None):
        values = self.rng.uniform(low, high, count)
        return float(values) if count is None else [float(value) for value in values]

    def whole(self, low, high):
        return int(self.rng.integers(low, high + 1))

    def chance(self, probability):
        return bool(self.rng.random() < probability)

    def one_of(self, values):
        return values[self.whole(0, len(values) - 1)]

    def table(self, name, columns):
        tables.write(os.path.join(self.folder, name), columns)
        return name
