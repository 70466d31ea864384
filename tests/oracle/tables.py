# SPDX-License-Identifier: GPL-3.0-or-later
"""CSV tables with a header line, by column."""
import numpy as np


def read(path):
    with open(path, encoding="utf-8") as file:
        rows = [line.strip().split(",") for line in file if line.strip() and not line.startswith("#")]
    values = np.array(rows[1:], float)
    return {name.strip(): values[:, n] for n, name in enumerate(rows[0])}


def write(path, columns):
    with open(path, "w", encoding="utf-8") as file:
        print(",".join(columns), file=file)
        for row in zip(*columns.values()):
            print(",".join(repr(float(value)) for value in row), file=file)
