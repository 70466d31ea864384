# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of equal length in a file, which are read on access."""
import h5py
import numpy as np

from landfall import files
from landfall.errors import DataError, printable


class Table:
    """Columns of equal length in a file, which are read on access.

    `table["z_est"]` reads a column into a numpy array. `table[1000:2000]` is a Table of these rows and `table[["x_est", "y_est"]]`
    one of these columns, both without reading; so `table[::100]["z_est"]` reads every hundredth value. `len()` counts rows, iterating
    gives the names of the columns. A column has the shape (rows,) and the type and unit that the file gives it; positions are metres in frame D.

    `attrs`: attributes of the file and of the group. A name that is no column raises KeyError with the names that are; damaged values raise
    DataError when they are read. `close()`, or leaving a `with` block, closes the file.
    """

    def __init__(self, datasets, rows, attrs):
        self._datasets, self._rows, self.attrs = datasets, rows, attrs

    @property
    def columns(self):
        """The names of the columns, in their order."""
        return tuple(self._datasets)

    @property
    def attributes(self):
        """{column: its attributes}, with units, long_name and the meanings of flags."""
        return {name: files.attributes(dataset) for name, dataset in self._datasets.items()}

    @property
    def units(self):
        """{column: its unit}, "" without one."""
        return {name: attributes.get("units", "") for name, attributes in self.attributes.items()}

    def __len__(self):
        return len(self._rows)

    def __iter__(self):
        return iter(self._datasets)

    def __contains__(self, name):
        return name in self._datasets

    def __getitem__(self, key):
        if isinstance(key, slice):
            return Table(self._datasets, self._rows[key], self.attrs)
        if isinstance(key, (list, tuple)):
            return Table({name: self._dataset(name) for name in key}, self._rows, self.attrs)
        dataset, rows = self._dataset(key), self._rows
        if not rows:
            return np.empty(0, dataset.dtype)
        if rows.step > 0:
            return files.read(dataset, slice(rows.start, rows.stop, rows.step))
        return files.read(dataset, slice(rows[-1], rows[0] + 1, -rows.step))[::-1]

    def _dataset(self, name):
        if name not in self._datasets:
            raise KeyError(f"no column {name!r}; columns: {', '.join(self._datasets)}")
        return self._datasets[name]

    def to_pandas(self):
        """Reads all of this table into a pandas.DataFrame of the same rows and columns. Its index is the row number in the file, its attrs hold the
        units. Raises Error if pandas is missing."""
        pandas = files.package("pandas")
        index = pandas.RangeIndex(self._rows.start, self._rows.stop, self._rows.step)
        frame = pandas.DataFrame({name: self[name] for name in self}, index=index)
        frame.attrs["units"] = self.units
        return frame

    def __repr__(self):
        width = max(map(len, self.columns))
        attributes = self.attributes
        rows = [printable(f"  {name:{width}}  {'text' if dataset.dtype.kind == 'O' else dataset.dtype}  {str(attributes[name].get('units', '')):4}  "
                          f"{attributes[name].get('long_name', '')}".rstrip()) for name, dataset in self._datasets.items()]
        return "\n".join([f"<landfall Table> {len(self):,} rows, {len(rows)} columns", *rows])

    def close(self):
        """Closes the file; columns cannot be read any more."""
        next(iter(self._datasets.values())).file.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def open_table(file, group):
    """The columns of a group of an open file."""
    if group not in file or not isinstance(file[group], h5py.Group):
        raise DataError(f"{file.filename}: has no group {group}")
    members = file[group]
    names = files.read(members["_columns"], ()) if "_columns" in members else members
    columns = {name: members[name] for name in names if len(getattr(members[name], "shape", ())) == 1}
    lengths = {dataset.shape[0] for dataset in columns.values()}
    if len(lengths) != 1:
        raise DataError(f"{file.filename}: {group}: {'columns of different lengths' if lengths else 'no columns'}")
    return Table(columns, range(lengths.pop()), files.attributes(file) | files.attributes(members))
