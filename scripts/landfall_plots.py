# SPDX-License-Identifier: GPL-3.0-or-later
"""What the plot scripts share: reading landfall's HDF5 files, writing pictures, errors and exit codes.

Exit codes are those of the tools: 0 done, 1 data or I/O failed, 2 usage or output exists.
"""
import argparse
import contextlib
import json
import os
import subprocess
import sys
from dataclasses import dataclass

import h5py
import landfall_hdf5
import numpy as np


class DataError(Exception):
    """A file is missing, unreadable, of the wrong kind, or cannot be written: exit 1."""

    exit_code = 1


class UsageError(Exception):
    """A bad option, or an output that exists: exit 2."""

    exit_code = 2


class Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one line."""

    def error(self, message):
        raise UsageError(f"{message} (see --help)")


def run(main):
    """Calls main(arguments) and exits with its code; errors become one line on stderr."""
    try:
        main(sys.argv[1:])
    except (DataError, UsageError) as error:
        print(f"{os.path.basename(sys.argv[0])}: {error}", file=sys.stderr)
        sys.exit(error.exit_code)


def run_tool(tool, *arguments):
    """Runs a program; what it says on stderr becomes a DataError where it fails."""
    try:
        result = subprocess.run([tool, *map(str, arguments)], capture_output=True, text=True, check=False)
    except OSError as error:
        raise DataError(f"{tool}: {error.strerror}") from error
    if result.returncode != 0:
        raise DataError(result.stderr.strip())


def add_output_options(parser):
    parser.add_argument("-O", "--overwrite", action="store_true", help="replace existing pictures")
    parser.add_argument("--dpi", type=dots_per_inch, default=150, help="50..600, default 150")


def require_png(path):
    if not path.endswith(".png"):
        raise UsageError(f"--output {path}: the name must end in .png")


def dots_per_inch(text):
    value = int(text)
    if not 50 <= value <= 600:
        raise argparse.ArgumentTypeError(f"{value} is not in [50, 600]")
    return value


def positive_metres(text):
    value = float(text)
    if not (np.isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"{text} is not a positive length")
    return value


# Input


@contextlib.contextmanager
def open_landfall(path, format_name):
    """Opens a finished landfall file of the given format_name for reading.

    Whatever HDF5 reports while the file is open is a DataError naming the file.
    """
    if not os.path.exists(path):
        raise DataError(f"{path}: no such file")
    try:
        with h5py.File(path, "r") as file:
            landfall_hdf5.require_self_contained(file)
            check_kind(file, path, format_name)
            yield file
    except landfall_hdf5.ForeignFileError as error:
        raise DataError(f"{path}: {error}") from error
    except (OSError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise DataError(f"{path}: not a readable HDF5 file ({reason})") from error


def check_kind(file, path, format_name):
    found = file.attrs.get("format_name", "")
    found = found.decode() if isinstance(found, bytes) else str(found)
    if found != format_name:
        raise DataError(f"{path}: format_name is '{found}', expected '{format_name}'")
    if np.any(np.asarray(file.attrs.get("complete", 0)) != 1):
        raise DataError(f"{path}: attribute 'complete' is not 1: the file was never finished")


@dataclass(frozen=True)
class MapGrid:
    """Where the bins lie: ascending bin centres, metres, frame D."""

    x: np.ndarray
    y: np.ndarray
    resolution_m: float

    @property
    def shape(self):
        return (self.y.size, self.x.size)

    @property
    def half_width_m(self):
        """The largest circle about the origin whose bins all lie in the map."""
        return float(min(-self.x[0], self.x[-1], -self.y[0], self.y[-1]))


def read_grid(file):
    """The file's grid, or None where it has no x and y."""
    if "x" not in file or "y" not in file:
        return None
    x, y = np.asarray(file["x"][()], float), np.asarray(file["y"][()], float)
    if x.ndim != 1 or y.ndim != 1 or x.size < 2 or y.size < 2:
        raise DataError(f"{file.filename}: x and y must be lists of at least 2 bin centres")
    step = (x[-1] - x[0]) / (x.size - 1)
    regular = np.allclose(np.diff(x), step, rtol=1e-6) and np.allclose(np.diff(y), step, rtol=1e-6)
    if not (step > 0 and regular):
        raise DataError(f"{file.filename}: x and y must ascend in equal steps")
    return MapGrid(x, y, float(step))


def read_layer(file, grid, name):
    """A layer as an array in which whatever is not finite is NaN, or None where the file does not have it."""
    if grid is None or name not in file:
        return None
    values = file[name][()]
    if values.shape != grid.shape:
        raise DataError(f"{file.filename}: {name} has shape {values.shape}, x and y say {grid.shape}")
    if values.dtype.kind == "f" and np.isinf(values).any():
        values[np.isinf(values)] = np.nan
    return values


def read_metrics(file):
    """/metrics_json as a Metrics."""
    if "metrics_json" not in file:
        raise DataError(f"{file.filename}: no /metrics_json")
    text = file["metrics_json"][()]
    try:
        return Metrics(json.loads(text))
    except (ValueError, TypeError) as error:
        raise DataError(f"{file.filename}: /metrics_json is not JSON ({error})") from error


class Metrics:
    """metrics.json. Values that are absent or null (a DEM without truth) are None."""

    def __init__(self, tree):
        if not isinstance(tree, dict):
            raise ValueError("not an object")
        self._tree = tree

    def get(self, path):
        """The value at a path such as 'coverage/hole_count'."""
        node = self._tree
        for key in path.split("/"):
            node = node.get(key) if isinstance(node, dict) else None
        if isinstance(node, (str, dict)):
            raise DataError(f"/metrics_json: {path} is not a number")
        return node


# Text


def metres(value):
    """A length with a unit that suits it: 1.2 mm, 8.3 cm, 1.38 m; a dash where it is not known."""
    if value is None:
        return "–"
    if 0 < abs(value) < 1e-6:
        return "< 1 µm"
    unit, factor = ("m", 1) if abs(value) >= 0.5 else ("cm", 100) if abs(value) >= 0.01 else ("mm", 1000)
    return f"{value * factor:.3g} {unit}"


def number(value):
    """A count or a fractional number; a dash where it is not known."""
    return "–" if value is None else f"{value:,.4g}" if isinstance(value, float) else f"{value:,}"


def counted(value, noun):
    return f"{number(value)} {noun}" + ("" if value == 1 else "s")


def bins(value):
    return counted(value, "bin")


def percent(fraction):
    return "–" if fraction is None else f"{100 * fraction:.3g} %"


# Output


def check_outputs(paths, overwrite, makes_folder=False):
    """Refuses in the tools' words, before any work, what could not be written at the end. With makes_folder, save() may make one folder."""
    for path in paths:
        folder = os.path.dirname(path) or "."
        is_new = os.path.isdir(os.path.dirname(folder) or ".") and not os.path.exists(folder)
        if not os.path.isdir(folder) and not (makes_folder and is_new):
            raise UsageError(f"output {path}: folder {folder} does not exist")
        if os.path.isdir(path):
            raise UsageError(f"output {path} is a directory")
        if os.path.exists(path) and not os.path.isfile(path):
            raise UsageError(f"output {path} is no regular file")
        if os.path.lexists(path) and not overwrite:
            raise UsageError(f"output {path} exists; use -O to overwrite it")


def save(figures, dpi):
    """Writes {path: figure} and prints the paths.

    All are written under temporary names first, so that a failure leaves no picture half written.
    """
    temporary = {path: f"{path}.{os.getpid()}.tmp" for path in figures}
    try:
        for path, figure in figures.items():
            os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
            figure.savefig(temporary[path], format="png", dpi=dpi, metadata={"Software": None})
        for path in figures:
            os.replace(temporary[path], path)
            print(path)
    except OSError as error:
        raise DataError(f"cannot write {error.filename or ''}: {error.strerror or error}") from error
    finally:
        for name in temporary.values():
            with contextlib.suppress(FileNotFoundError):
                os.remove(name)
