# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall from Python: opens its files and runs its tools (docs/user/python.md).

    import landfall
    dem = landfall.open("dem.h5")                     # an xarray.Dataset
    scan = landfall.open("scan.h5")                   # a Table of 12.96 million returns, on disk
    plan = landfall.run("scan-sim", "flash-256", plan=True, output="plan.h5")

Figures are commands: plot_dem.py, plot_eval.py, ... Importing the package loads no other package.
"""
from landfall.errors import DataError, Error, ToolError, UsageError

__all__ = ["DataError", "Error", "ToolError", "UsageError", "open", "run"]


def open(path, group=None, check=True):  # pylint: disable=redefined-builtin
    """Opens a file that landfall made. Values are read on access.

    A terrain, DEM, evaluation, hazard map or plan is an xarray.Dataset: layers over y and x with units and long names, and the coordinate
    reference system as `crs`. A scan, or the results of a study, is a landfall.table.Table. metrics.json, sites.json, score.json and the
    verdict of a campaign are dicts. With `group` the columns of that group are a Table: "pulses" of a scan, "features" of a terrain, "holes" of an
    evaluation, "sites" of a hazard map.

    Throws DataError, naming the file, if it is missing, damaged, unfinished, not landfall's, or refers to other files: it runs
    `landfall-info --check`, some 50 ms for a file of any size. check=False opens a file that you trust without this. Damaged values
    throw DataError when they are read. Closing the result, or leaving a `with` block of it, closes the file.

    HDF5 loads no filter plug-ins in this process from then on.
    """
    from landfall import opening  # here, because loading h5py and numpy takes time

    return opening.open_file(path, group, check)


def run(tool, config=None, *inputs, output=None, **options):
    """Runs a tool: run("scan-sim", config, terrain="terrain.h5", output="scan.h5").

    `config` is a dict, the path of a JSON file, or the name of a preset. `inputs` are files that the tool takes without an
    option: scans of regrid, the DEM of dem-eval. Each option is one of the tool's, without dashes: keep_misses=True,
    layers=["z_est", "count"], set={"noise.range_sigma_m": 0.02}, overwrite=True; None and False leave it out.

    Returns the opened output; the path of an output in another program's format; without an output, what the tool printed. The
    tool's warnings go to stderr. Throws ToolError with the tool's message and exit code if it fails.
    """
    from landfall import tools

    result = tools.run(tool, config, inputs, output, options)
    if output is None:
        return result
    from landfall import opening

    return opening.open_file(result) if opening.h5py.is_hdf5(result) else result
