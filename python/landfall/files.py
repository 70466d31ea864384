# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of landfall: the checks before any value is read, and their grids and metrics."""
import contextlib
import ctypes
import importlib
import json
from dataclasses import dataclass

import h5py
import numpy as np

from landfall import tools
from landfall.errors import DataError, Error

# Attributes by which HDF5 links layers to their coordinates.
DIMENSION_SCALES = ("CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST")

# The exceptions that code raises for contents that are not as expected, and h5py and the system while they are read.
UNEXPECTED = (RuntimeError, StopIteration, LookupError, ValueError, TypeError, AttributeError, ArithmeticError, MemoryError)
UNREADABLE = (OSError, *UNEXPECTED)


@contextlib.contextmanager
def naming(path):
    """Turns an exception while a file is read into one DataError that names it."""
    try:
        yield
    except UNREADABLE as error:
        raise DataError(f"{path}: {_reason(error)}") from error


@contextlib.contextmanager
def drawing(paths):
    """Turns an exception while a figure of these files is drawn into one DataError that names them: contents that each reader takes need
    not fit together. Without files, as in a figure of runs of the tools, the exception is ours."""
    try:
        yield
    except UNEXPECTED as error:
        if not paths:
            raise
        raise DataError(f"{', '.join(paths)}: cannot be drawn: {_reason(error)}") from error


def _reason(error):
    what = " ".join(str(error.args[0] if isinstance(error, KeyError) and error.args else error).split())
    return f"does not fit in memory: {what}" if isinstance(error, MemoryError) else f"cannot be read: {what or type(error).__name__}"


@contextlib.contextmanager
def open_landfall(path, format_name, check=True):
    """Opens a finished landfall file of the given format_name for reading; `check` as of open_screened().

    Errors of HDF5 and of the contents while the file is open become a DataError that names the file.
    """
    with open_screened(path, (format_name,), check) as file, naming(path):
        yield file


def open_screened(path, formats, check=True):
    """An open h5py.File of one of the formats, which the tools have checked (tools.check_files) unless `check` is false.

    Throws DataError, naming the file.
    """
    if check:
        tools.check_files(path)
    turn_off_plugins()
    with naming(path), contextlib.ExitStack() as stack:
        file = stack.enter_context(h5py.File(path, "r"))
        check_kind(file, path, formats)
        stack.pop_all()
        return file


def file_id(path):
    """The file_id of a file that tools.sound_files() found; None if it has none."""
    turn_off_plugins()
    with naming(path), h5py.File(path, "r") as file:
        return text(file.attrs.get("file_id"))


def turn_off_plugins():
    """HDF5 loads no filter from a file any more in this process. Filters that are registered already, as by hdf5plugin, remain."""
    ctypes.CDLL(h5py.h5z.__file__).H5PLset_loading_state(0)


def text(value):
    """The text of an attribute; other values are returned unchanged."""
    return value.decode(errors="replace") if isinstance(value, bytes) else value


def attributes(item):
    return {key: _plain(value) for key, value in item.attrs.items() if key not in DIMENSION_SCALES}


def _plain(value):
    value = text(value)
    return value[0] if isinstance(value, np.ndarray) and value.shape == (1,) else value


def read(dataset, key):
    """The values at a key. Errors of HDF5 become a DataError that names the file and the dataset."""
    try:
        return dataset.asstr()[key] if h5py.check_string_dtype(dataset.dtype) else dataset[key]
    except (OSError, RuntimeError, ValueError, TypeError, MemoryError) as error:  # an index out of range is the caller's
        raise DataError(f"{dataset.file.filename}: {dataset.name}: {_reason(error)}") from error


def check_kind(file, path, formats):
    found = text(file.attrs.get("format_name", ""))
    if str(found) not in formats:
        wanted = " or ".join(f"'{name}'" for name in formats)
        raise DataError(f"{path}: format_name is '{found}', expected {wanted}")
    if np.any(np.asarray(file.attrs.get("complete", 0)) != 1):
        raise DataError(f"{path}: attribute 'complete' is not 1: the file was never finished")


@dataclass(frozen=True)
class MapGrid:
    """The bins of a map: ascending bin centres in metres, frame D."""

    x: np.ndarray
    y: np.ndarray
    resolution_m: float

    @property
    def shape(self):
        return (self.y.size, self.x.size)

    @property
    def half_width_m(self):
        """The radius of the largest circle about the origin whose bins are all in the map."""
        return float(min(-self.x[0], self.x[-1], -self.y[0], self.y[-1]))


def numbers(group, name):
    """A dataset of real numbers. Throws DataError for any other, as of text or of complex numbers."""
    item = group[name]
    if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "biuf":
        raise DataError(f"{item.file.filename}: {item.name} does not hold real numbers")
    return item


class Columns(dict):
    """{name: values} of the columns of a group. A column that is missing is a DataError."""

    def __init__(self, group):
        super().__init__((name, numbers(group, name)[()]) for name in group)
        self._group = f"{group.file.filename}: {group.name}"
        for name, values in self.items():
            if values.ndim != 1 or values.size != next(iter(self.values())).size:
                raise DataError(f"{self._group}: its columns are not of equal length: {name} has shape {values.shape}")

    def __missing__(self, name):
        raise DataError(f"{self._group} has no column {name}")


def read_grid(file):
    """The grid of the file, or None if it has no x and y."""
    if "x" not in file or "y" not in file:
        return None
    x, y = (np.asarray(numbers(file, name)[()], float) for name in ("x", "y"))
    if x.ndim != 1 or y.ndim != 1 or x.size < 2 or y.size < 2:
        raise DataError(f"{file.filename}: x and y must be lists of at least 2 bin centres")
    step = (x[-1] - x[0]) / (x.size - 1)
    regular = np.allclose(np.diff(x), step, rtol=1e-6) and np.allclose(np.diff(y), step, rtol=1e-6)
    if not (step > 0 and regular):
        raise DataError(f"{file.filename}: x and y must ascend in equal steps")
    return MapGrid(x, y, float(step))


def read_layer(file, grid, name):
    """A layer as an array with NaN for all values that are not finite; None if the file does not have the layer."""
    if grid is None or name not in file:
        return None
    values = numbers(file, name)[()]
    if values.shape != grid.shape:
        raise DataError(f"{file.filename}: {name} has shape {values.shape}; x and y need {grid.shape}")
    if values.dtype.kind == "f" and np.isinf(values).any():
        values[np.isinf(values)] = np.nan
    return values


def read_metrics(file, name="metrics_json"):
    """A text of the file that holds a JSON object, as a Metrics."""
    return _read_json(file, name, lambda tree: Metrics(tree, name))


def read_verdict(file):
    """/verdict_json of an eval.h5: a dict of texts for each requirement; None in a file that has none."""
    def checked(rows):
        if not all([*map(type, row.values())] == [str] * 4 for row in rows):
            raise ValueError("not a list of texts")
        return rows
    return _read_json(file, "verdict_json", checked) if "verdict_json" in file else None


def _read_json(file, name, parsed):
    if name not in file:
        raise DataError(f"{file.filename}: no /{name}")
    text = file[name][()]
    try:
        return parsed(json.loads(text))
    except (ValueError, TypeError, AttributeError) as error:
        raise DataError(f"{file.filename}: /{name} is not JSON ({error})") from error


class Metrics:
    """metrics.json or the like. Values that are absent or null (a DEM without truth) are None."""

    def __init__(self, tree, name="metrics_json"):
        if not isinstance(tree, dict):
            raise ValueError("not an object")
        self._tree, self._name = tree, name

    def _node(self, path):
        node = self._tree
        for key in path.split("/"):
            node = node.get(key) if isinstance(node, dict) else None
        return node

    def get(self, path):
        """The value at a path such as 'coverage/hole_count'."""
        node = self._node(path)
        if isinstance(node, (str, dict)):
            raise DataError(f"/{self._name}: {path} is not a number")
        return node

    def text(self, path):
        """The text at a path."""
        node = self._node(path)
        if not isinstance(node, (str, type(None))):
            raise DataError(f"/{self._name}: {path} is not a text")
        return node


def package(name):
    """Imports a package that only some commands need; if it is missing, the error names the Debian package."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise Error(f"the Python package {name} is missing: apt-get install python3-{name}") from error
