# SPDX-License-Identifier: GPL-3.0-or-later
# Python lets the tools check a file. `landfall.open` and the Python commands run `landfall-info --check`, which opens
# the file as every tool does, before h5py opens it. A second implementation of lib/store/hdf5/guard/metadata_check.h,
# lib/store/hdf5/guard/file_screening.h and lib/store/hdf5/guard/file_seal.h in Python would differ from the first one
# sooner or later. The price is one process for each file. Where the program is not found, the file is refused: a check
# that is silently left out is none. `check=False` leaves it out for a file that the caller trusts.
#
# HDF5 loads no plug-in in a Python process from the first `landfall.open` on, not only for the file that is opened:
# HDF5 has one switch for a process, and looks for a filter when values are read, long after the file is opened. Filters
# that a program registers itself (hdf5plugin) remain.
"""landfall.open: a file as an xarray.Dataset, a Table or a dict."""
import contextlib
import json
import os

import h5py

from landfall import files, schema
from landfall.errors import DataError, UsageError
from landfall.table import open_table

GRIDS = ("landfall.terrain", "landfall.dem", "landfall.evaluation", "landfall.plan", "landfall.hazards", "landfall.draws")
# The JSON files of the tools.
TREES = ("landfall.metrics", "landfall.sites", "landfall.hazard_score", "landfall.draws_verdict")
# The groups that hold the columns of the other files.
TABLES = {"landfall.scan": "points", "landfall.results": "/"}


def open_file(path, group=None, check=True):
    """See landfall.open."""
    path = os.fspath(path)
    if group is None and os.path.isfile(path) and not h5py.is_hdf5(path):
        return read_tree(path)
    with files.naming(path), contextlib.ExitStack() as on_failure:
        file = on_failure.enter_context(files.open_screened(path, (*GRIDS, *TABLES), check))
        group = group or TABLES.get(files.text(file.attrs["format_name"]))
        if group:
            opened = open_table(file, group)
        else:
            files.package("xarray")
            from landfall import grids  # here, because it needs xarray
            opened = grids.open_grid(grids.Source(path, GRIDS, check, file))
        on_failure.pop_all()
        return opened


def result_of_run(path, printed, options):
    """See landfall.run: the output of a tool, or the first of its JSON files, or what it printed."""
    if path is not None:
        return open_file(path) if h5py.is_hdf5(path) else path
    for name in ("metrics", "sites", "score"):
        if options.get(name):
            return read_tree(options[name])
    return json.loads(printed) if options.get("metrics_only") and printed.startswith("{") else printed


def read_tree(path):
    """metrics.json, sites.json, score.json or verdict.json as a dict."""
    try:
        tree = schema.read_json(path)
    except UsageError as error:
        raise DataError(f"{path}: neither an HDF5 file nor JSON of landfall") from error
    if not isinstance(tree, dict) or tree.get("format") not in TREES:
        raise DataError(f"{path}: \"format\" is not one of {', '.join(TREES)}")
    return tree
