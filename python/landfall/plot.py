# SPDX-License-Identifier: GPL-3.0-or-later
# The figures are those of the commands plot_dem.py, plot_eval.py, ...: these functions give the options as their command lines would, and return
# the figure instead of writing it. A figure is closed in pyplot, so that a notebook shows it once, as the value of the cell.
"""Figures of landfall's files, as matplotlib Figures: landfall.plot.dem(landfall.open("dem.h5")).

Each function takes a file as its path or as landfall.open() returned it. A dataset whose values were changed since is refused, because the
figure would not show them. Options are those of the command of the same name (plot_dem.py --limit-m 0.03: limit_m=0.03).
"""
from __future__ import annotations

import importlib
import os
import typing

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from landfall.errors import UsageError

Source = typing.Union[str, "os.PathLike[str]", typing.Any]
Place = typing.Tuple[float, float]

__all__ = ["compare", "dem", "draws", "evaluation", "hazards", "landing", "plan", "populations", "profile", "terrain"]


def dem(source: Source, *, region_radius_m: float | None = None, footprint_m: float | None = None, limit_m: float | None = None,
        data_only: bool = False, dpi: int = 100) -> Figure:
    """True and estimated elevation of a DEM side by side, and their difference."""
    return _figure("plot_dem", [source], dpi, region_radius_m=region_radius_m, footprint_m=footprint_m, limit_m=limit_m, data_only=data_only)


def profile(source: Source, start: Place, end: Place, *, limit_m: float | None = None, dpi: int = 100) -> Figure:
    """Truth, estimate and error of a DEM along a line between two places, metres in the frame of the DEM."""
    return _figure("plot_profile", [source], dpi, **{"from": start, "to": end}, limit_m=limit_m)


def compare(a: Source, b: Source, *, layer: str | None = None, dpi: int = 100) -> Figure:
    """Two DEMs on equal grids side by side, and the difference B - A."""
    return _figure("plot_compare", [a, b], dpi, layer=layer)


def evaluation(source: Source, figure: str | None = None, *, data_only: bool = False, dpi: int = 100) -> Figure:
    """A figure of an evaluation: "verdict", "coverage", "elevation_error", "accuracy" or "uncertainty"; by default "accuracy", or the one before
    for a DEM that lacks the truth for it."""
    module = _module("plot_eval")
    path = _path(source)
    with _style(dpi):
        read = module.Evaluation(path, data_only)
        chosen = module.figures_of(read)
        figure = figure or next(name for name in ("accuracy", "elevation_error", "coverage") if f"{name}.png" in chosen)
        if f"{figure}.png" not in chosen:
            raise UsageError(f"figure {figure!r}: this evaluation has {', '.join(name[:-len('.png')] for name in chosen)}")
        return _closed(chosen[f"{figure}.png"](read))


def hazards(source: Source, *, dem: Source | None = None, data_only: bool = False, dpi: int = 100) -> Figure:  # pylint: disable=redefined-outer-name
    """Slope, roughness, safe places, touchdown probability and sites of a hazard map; with `dem`, over the relief of the map that was judged."""
    return _figure("plot_hazards", [source], dpi, dem=None if dem is None else _path(dem), data_only=data_only)


def plan(source: Source, *, dpi: int = 100) -> Figure:
    """The coverage that a scan would have (scan-sim --plan)."""
    return _figure("plot_plan", [source], dpi)


def draws(source: Source, *, dpi: int = 100) -> Figure:
    """The maps and distributions of many draws."""
    return _figure("plot_draws", [source], dpi)


def landing(source: Source, *, dpi: int = 100) -> Figure:
    """The touchdowns of draws that land, with the lidar and without."""
    return _figure("plot_landing", [source], dpi)


def terrain(source: Source, *, sun_azimuth_deg: float | None = None, sun_elevation_deg: float | None = None, zoom_width_m: float | None = None,
            zoom_at: Place | None = None, dpi: int = 100) -> Figure:
    """Hillshade, slopes and a zoom of a terrain."""
    return _figure("plot_terrain", [source], dpi, sun_azimuth_deg=sun_azimuth_deg, sun_elevation_deg=sun_elevation_deg,
                   zoom_width_m=zoom_width_m, zoom_at=zoom_at)


def populations(source: Source, *, dpi: int = 100) -> Figure:
    """The size distributions of a terrain's rocks and craters, and the laws that they follow."""
    return _figure("plot_populations", [source], dpi, output="figure.png")


def _module(name: str) -> typing.Any:
    with matplotlib.rc_context():  # modules of figures set the fonts of the commands
        return importlib.import_module(f"landfall.{name}")


def _style(dpi: int) -> typing.ContextManager[None]:
    """The fonts and the resolution of a figure, whose caller keeps their own."""
    return matplotlib.rc_context({**_module("maps").STYLE, "figure.dpi": dpi})


def _figure(name: str, sources: list[Source], dpi: int, **options: typing.Any) -> Figure:
    module = _module(name)
    words = [word for key, value in options.items() for word in _words("--" + key.replace("_", "-"), value)]
    with _style(dpi):
        return _closed(module.figure_of(module.parse([*map(_path, sources), "--dpi", str(dpi), *words])))


def _words(option: str, value: typing.Any) -> list[str]:
    if value is None or value is False:
        return []
    return [option] if value is True else [option, ",".join(map(str, value)) if isinstance(value, tuple) else str(value)]


def _closed(figure: Figure) -> Figure:
    plt.close(figure)
    return figure


def _path(source: Source) -> str:
    """The path of a file that is given as its path or as landfall.open returned it."""
    if isinstance(source, (str, bytes, os.PathLike)):
        return os.fsdecode(source)
    path = getattr(source, "encoding", {}).get("source")
    if path is None:
        raise UsageError(f"a figure needs the path of a file, or what landfall.open returned for one, not a {type(source).__name__}")
    _require_unchanged(source, path)
    return path


def _require_unchanged(dataset: typing.Any, path: str) -> None:
    """A figure is drawn from the file: values that were changed since it was opened would not be in it."""
    opening = importlib.import_module("landfall.opening")
    with opening.open_file(path) as original:
        for name, values in dataset.variables.items():
            if name not in original.variables:
                continue  # a figure has no use for it
            kept = original.variables[name]
            if values.shape != kept.shape or not (_is_unread(values) or _equal(values.values, kept.values)):
                raise UsageError(f"{name} was changed since {path} was opened, and the figure shows the file; write the change to a file first")


def _is_unread(values: typing.Any) -> bool:
    """Whether xarray still reads the values from the file, in their order."""
    return type(getattr(values, "_data", None)).__name__ == "MemoryCachedArray" and not values._in_memory  # pylint: disable=protected-access


def _equal(a: typing.Any, b: typing.Any) -> bool:
    return bool(np.array_equal(a, b, equal_nan=a.dtype.kind == "f"))
