# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall from Python: opens its files, runs its tools and draws its figures (docs/user/python.md).

    import landfall
    dem = landfall.open("dem.h5")                     # an xarray.Dataset
    scan = landfall.open("scan.h5")                   # a Table of 12.96 million returns, on disk
    plan = landfall.run("scan-sim", "flash-256", plan=True, output="plan.h5")
    landfall.plot.dem(dem)                            # a matplotlib Figure

Importing the package loads no other package.
"""
import importlib
import os
import typing

from landfall.errors import DataError, Error, ToolError, UsageError

if typing.TYPE_CHECKING:
    from landfall import model, plot
    from landfall.memory import chain, evaluate, grid, hazards, Lidar, scan, Terrain

__all__ = ["chain", "DataError", "Error", "evaluate", "grid", "hazards", "Lidar", "model", "open", "plot", "run", "scan", "Terrain", "ToolError", "UsageError"]
_IN_MEMORY = ("chain", "evaluate", "grid", "hazards", "Lidar", "scan", "Terrain")

Path = str | os.PathLike[str]
Config = typing.Mapping[str, typing.Any] | Path


def __getattr__(name: str) -> typing.Any:
    """Imports landfall.plot, landfall.model and landfall.memory when they are first used, because loading matplotlib and numpy takes time."""
    if name in ("model", "plot"):
        return importlib.import_module(f"landfall.{name}")
    if name in _IN_MEMORY:
        return getattr(importlib.import_module("landfall.memory"), name)
    raise AttributeError(f"module 'landfall' has no attribute {name!r}")


def open(path: Path, group: str | None = None, check: bool = True) -> typing.Any:  # pylint: disable=redefined-builtin
    """Opens a file that landfall made. Values are read on access.

    A terrain, DEM, evaluation, hazard map, plan or the maps of draws.h5 are an xarray.Dataset: layers of shape (y, x) with `units` and `long_name`,
    row 0 the southernmost, x and y in metres in frame D (x to the right, y up on the map), and the coordinate reference system as `crs`. A mesh
    terrain has `vertices` (V, 3), metres, and `triangles` (F, 3), rows of the vertices. A scan, or the results of a study, is a
    landfall.table.Table. metrics.json, sites.json, score.json and the verdict of a run of draws are dicts, whose keys end in their units. With
    `group` the columns of that group are a Table: "pulses" of a scan, "features" of a terrain, "holes" of an evaluation, "sites" of a hazard map,
    "draws" of draws.h5.

    Raises DataError, naming the file, if it is missing, damaged, unfinished, not landfall's, or refers to other files, or has no such group: it
    runs `landfall-info --check`, some 50 ms for a file of any size. check=False opens a file that you trust without this. Damaged values
    raise DataError when they are read. Raises Error if xarray, which grids need, is missing. Closing the result, or leaving a `with` block of it,
    closes the file.

    HDF5 loads no filter plug-ins in this process from then on.
    """
    from landfall import opening  # here, because loading h5py and numpy takes time

    return opening.open_file(path, group, check)


def run(tool: str, config: Config | typing.Sequence[Config] | None = None, *inputs: Path, output: Path | None = None,
        **options: typing.Any) -> typing.Any:
    """Runs a tool: run("scan-sim", config, terrain="terrain.h5", output="scan.h5"). run("landfall run", config, output="site") runs the whole chain into
    a folder, whose path it returns; landfall.chain runs it in memory.

    `config` is a dict, the path of a JSON file, or the name of a preset, or a list of these, which are merged in order as several -c are:
    ["preset:paper", {"noise": {"range_sigma_m": 0.02}}]. `inputs` are files that the tool takes without an option: scans of regrid, the DEM of
    dem-eval. Each option is one of the tool's, without dashes: keep_misses=True, layers=["z_est", "count"],
    set={"noise.range_sigma_m": 0.02}, overwrite=True; None and False leave it out.

    Returns the opened output; the path of an output in another program's format. Without an output: the opened file of `metrics`, `sites` or
    `score` (a dict), the metrics of metrics_only=True (a dict), or else what the tool printed. The tool's warnings go to stderr. Units are those
    that end the names of keys and options.

    Raises ToolError with the tool's message and exit code if it fails or is missing, UsageError if an argument has a type that no tool takes, and
    what open() raises for the output.
    """
    from landfall import opening, tools

    path, printed = tools.run(tool, config, inputs, output, options)
    return opening.result_of_run(path, printed, options)
