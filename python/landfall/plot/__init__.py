# SPDX-License-Identifier: GPL-3.0-or-later
# The figures are those of the commands `landfall plot`: these functions give the options as their command lines would, and return the
# figure instead of writing it. A figure is closed in pyplot, so that a notebook shows it once, as the value of the cell. It is made and drawn with
# matplotlib's defaults and the package's settings, whatever a matplotlibrc or the notebook set; the notebook's settings hold for its other figures.
"""Figures of landfall's files, as matplotlib Figures: landfall.plot.dem(landfall.open("dem.h5")).

Each function takes a file as its path or as landfall.open() returned it, or a result in memory, landfall.grid(...). A dataset whose values were
changed since is refused, because the figure would not show them. Options are those of the command of the same name (landfall plot dem --limit-m 0.03:
limit_m=0.03).

Lengths are metres in the frame of the file (x to the right, y up on the map), angles degrees, `dpi` 50 to 600 pixels per inch. Every function
raises DataError, naming the file, if it is missing, damaged, of another kind or without a layer that the figure needs, and UsageError if an
option is out of its bounds.
"""
import contextlib
import importlib
import os
import tempfile
import typing

import matplotlib
import matplotlib.figure
import matplotlib.pyplot as plt
import numpy as np

from landfall import files, tools
from landfall.errors import UsageError

Source = str | os.PathLike[str] | typing.Any
Place = tuple[float, float]

__all__ = ["compare", "dem", "draws", "evaluation", "hazards", "landing", "plan", "populations", "profile", "terrain"]


class Figure(matplotlib.figure.Figure):
    """A figure that is drawn with the settings that it was made with, whoever draws it."""

    def draw(self, renderer: typing.Any) -> None:
        with _style(self.dpi):
            super().draw(renderer)

    def get_tightbbox(self, *arguments: typing.Any, **options: typing.Any) -> typing.Any:
        with _style(self.dpi):
            return super().get_tightbbox(*arguments, **options)

    def savefig(self, *arguments: typing.Any, **options: typing.Any) -> None:
        with _style(self.dpi):
            super().savefig(*arguments, **options)


def dem(source: Source, *, region_radius_m: float | None = None, footprint_m: float | None = None, limit_m: float | None = None,
        data_only: bool = False, dpi: int = 100) -> Figure:
    """True and estimated elevation of a dem.h5 side by side, and their difference e_z, all in metres; without truth only the estimate.

    `region_radius_m`: radius of the circle about the origin that is judged, by default the largest that fits. `footprint_m`: edge of a
    footprint, 1.7. `limit_m`: limit of the relative elevation error, 0.05, marked on the scale of e_z. With `data_only` the scale ends
    where the data does, even if the limit lies outside.
    """
    return _figure("plot_dem", [source], dpi, region_radius_m=region_radius_m, footprint_m=footprint_m, limit_m=limit_m, data_only=data_only)


def profile(source: Source, start: Place, end: Place, *, limit_m: float | None = None, dpi: int = 100) -> Figure:
    """Truth, estimate and error of a dem.h5 along the line from `start` to `end`, each (x, y) in metres in the frame of the DEM.

    The value is that of each bin that the line crosses; nothing is interpolated, so that a bin without a return is a gap. `limit_m`: limit of
    the relative elevation error, 0.05, drawn as lines. UsageError if both places are the same or one is outside the map.
    """
    return _figure("plot_profile", [source], dpi, **{"from": start, "to": end}, limit_m=limit_m)


def compare(a: Source, b: Source, *, layer: str | None = None, dpi: int = 100) -> Figure:
    """Two DEMs side by side, and the difference `b` - `a` in metres. DataError unless their grids are equal.

    `layer`: the elevations to compare, a layer of a dem.h5 that holds elevations; "z_est" by default.
    """
    return _figure("plot_compare", [a, b], dpi, layer=layer)


def evaluation(source: Source, figure: str | None = None, *, data_only: bool = False, dpi: int = 100) -> Figure:
    """A figure of an eval.h5: "verdict", "coverage", "elevation_error", "accuracy" or, of a DEM with 1-sigma maps, "uncertainty"; by default
    "accuracy", or the one before for a DEM that lacks the truth for it.

    Errors are true minus estimated, in centimetres. With `data_only` scales end where the data does, even if limits lie outside. UsageError,
    with the figures that there are, if the evaluation lacks what `figure` shows.
    """
    module = _module("plot_eval")
    with _drawing([source], dpi) as (path,):
        read = module.Evaluation(path, data_only)
        chosen = module.figures_of(read)
        figure = figure or next(name for name in ("accuracy", "elevation_error", "coverage") if f"{name}.png" in chosen)
        if f"{figure}.png" not in chosen:
            raise UsageError(f"figure {figure!r}: this evaluation has {', '.join(name[:-len('.png')] for name in chosen)}")
        return _closed(chosen[f"{figure}.png"](read))


def hazards(source: Source, *, dem: Source | None = None, data_only: bool = False, dpi: int = 100) -> Figure:  # pylint: disable=redefined-outer-name
    """Safe places, slope in degrees, roughness in metres, probability and landing sites of a hazards.h5; with a score also how good it is.

    `dem`: the DEM that was judged, whose relief shades the places; DataError unless its bins are those of the hazard map. With `data_only`
    scales end where the data does, even if limits lie outside.
    """
    return _figure("plot_hazards", [source], dpi, named={} if dem is None else {"--dem": dem}, data_only=data_only)


def plan(source: Source, *, dpi: int = 100) -> Figure:
    """The coverage that a scan would have, from a plan.h5 of scan-sim --plan: returns and frames per bin, when each is first seen in seconds."""
    return _figure("plot_plan", [source], dpi)


def draws(source: Source, *, dpi: int = 100) -> Figure:
    """The maps of a draws.h5, and the distributions of what decides each requirement; of a file without maps only the distributions.

    Probabilities are shares of the draws; means and spreads of the errors are metres.
    """
    return _figure("plot_draws", [source], dpi)


def landing(source: Source, *, dpi: int = 100) -> Figure:
    """The touchdowns of a draws.h5 with landings, with the lidar and without, in metres, and slope and roughness there against their limits."""
    return _figure("plot_landing", [source], dpi)


def terrain(source: Source, *, sun_azimuth_deg: float | None = None, sun_elevation_deg: float | None = None, zoom_width_m: float | None = None,
            zoom_at: Place | None = None, dpi: int = 100) -> Figure:
    """Hillshade with the objects, slopes in degrees and a zoom of a gridded terrain.h5.

    `sun_azimuth_deg`: of the light, clockwise from +y, 315; `sun_elevation_deg`: 0 to 90, 35. `zoom_width_m`: edge of the zoom, by default a
    tenth of the site; `zoom_at`: its middle (x, y), by default the steepest place.
    """
    return _figure("plot_terrain", [source], dpi, sun_azimuth_deg=sun_azimuth_deg, sun_elevation_deg=sun_elevation_deg,
                   zoom_width_m=zoom_width_m, zoom_at=zoom_at)


def populations(source: Source, *, dpi: int = 100) -> Figure:
    """How many rocks, ice blocks and craters of which size a terrain.h5 has, against the laws that they were drawn from: N(>D) per square metre,
    D in metres. DataError if no pattern of the terrain scatters objects."""
    return _figure("plot_populations", [source], dpi, output="figure.png")


def _module(name: str) -> typing.Any:
    with matplotlib.rc_context():  # modules of figures set the fonts of the commands
        return importlib.import_module(f"landfall.plot.{name}")


def _style(dpi: int) -> typing.ContextManager[None]:
    """matplotlib's defaults with the fonts and the resolution of a figure, whose caller keeps their own."""
    return plt.style.context(["default", {**_module("maps").STYLE, "figure.dpi": dpi}])


def _figure(name: str, sources: list[Source], dpi: int, named: typing.Any = None, **options: typing.Any) -> Figure:
    """`named`: {option: the source that it names}."""
    module, named = _module(name), named or {}
    words = [word for key, value in options.items() for word in tools.option_words("--" + key.replace("_", "-"), value)]
    with _drawing([*sources, *named.values()], dpi) as paths:
        words += [word for pair in zip(named, paths[len(sources):]) for word in pair]
        return _closed(module.figure_of(module.parse([*paths[:len(sources)], "--dpi", str(dpi), *words])))


@contextlib.contextmanager
def _drawing(sources: list[Source], dpi: int) -> typing.Iterator[list[str]]:
    """The paths of the sources while a figure is made of them."""
    with contextlib.ExitStack() as stack:
        paths = [_path(source, stack) for source in sources]
        stack.enter_context(_style(dpi))
        stack.enter_context(files.drawing(paths))
        yield paths


def _closed(figure: matplotlib.figure.Figure) -> Figure:
    plt.close(figure)
    figure.__class__ = Figure
    return typing.cast(Figure, figure)


def _path(source: Source, stack: contextlib.ExitStack) -> str:
    """The path of a file that is given as its path or as landfall.open returned it; of a result in memory that of a file during `stack`."""
    if isinstance(source, (str, bytes, os.PathLike)):
        return os.fsdecode(source)
    if hasattr(source, "to_file"):
        saved = os.path.join(stack.enter_context(tempfile.TemporaryDirectory(prefix="landfall-figure-")), f"{type(source).__name__.lower()}.h5")
        source.to_file(saved)
        return saved
    path = getattr(source, "encoding", {}).get("source")
    if path is None:
        raise UsageError(f"a figure needs the path of a file, what landfall.open returned for one, or a result in memory, not a {type(source).__name__}")
    _require_unchanged(source, path)
    return path


def _require_unchanged(dataset: typing.Any, path: str) -> None:
    """A figure is drawn from the file: values that were changed since it was opened would not be in it."""
    opening = importlib.import_module("landfall.opening")
    with opening.open_file(path) as original:
        for name, values in dataset.variables.items():
            if name not in original.variables:
                continue  # a figure has no use for it
            kept, is_real = original.variables[name], values.dtype.kind == "f"
            if values.shape != kept.shape or not (_is_unread(values) or np.array_equal(values.values, kept.values, equal_nan=is_real)):
                raise UsageError(f"{name} was changed since {path} was opened, and the figure shows the file; write the change to a file first")


def _is_unread(values: typing.Any) -> bool:
    """Whether xarray still reads the values from the file, in their order."""
    return type(getattr(values, "_data", None)).__name__ == "MemoryCachedArray" and not values._in_memory  # pylint: disable=protected-access
