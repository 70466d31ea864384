# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a terrain made by terrain-gen: hillshade with the objects on it, slope map, and a zoom."""
import math
import os
from dataclasses import dataclass

import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.colors import LightSource
from matplotlib.patches import Patch

from landfall import files
from landfall.errors import DataError
from landfall.plot import captions, maps, plot_command, reduction, scales

CELLS = 900  # blocks along a panel's edge
BAND_NODES = 1 << 23  # nodes held at a time: a terrain of any size is drawn in the same memory
MAX_OBJECTS = 300  # of each kind on the map of the whole site, the largest first
KIND_COLORS = ("#d55e00", "#56b4e9", "#009e73", "#e69f00", "#cc79a7", "#0072b2", "#f0e442", "#000000")


def add_options(parser):
    parser.add_argument("--sun-azimuth-deg", type=finite, default=315, help="clockwise from +y, default 315")
    parser.add_argument("--sun-elevation-deg", type=sun_elevation, default=35, help="0..90, default 35")
    parser.add_argument("--zoom-width-m", type=plot_command.positive_metres, help="default: a tenth of the site")
    parser.add_argument("--zoom-at", type=plot_command.place, metavar="X,Y", help="default: the steepest place")


parse = plot_command.parser_of(__doc__, {"terrain": "TERRAIN"}, add_options)


def finite(text):
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(text)
    return value


def sun_elevation(text):
    value = float(text)
    if not 0 < value <= 90:
        raise ValueError(text)
    return value


# Shape of the surface, at cells between four nodes


def gradient(z, resolution_m):
    """(dz/dx, dz/dy) of each cell, from its four nodes."""
    east, north = np.diff(z, axis=1), np.diff(z, axis=0)
    return ((east[:-1] + east[1:]) / (2 * resolution_m), (north[:, :-1] + north[:, 1:]) / (2 * resolution_m))


def slope_deg(dz_dx, dz_dy):
    return np.degrees(np.arctan(np.hypot(dz_dx, dz_dy)))


def shade(dz_dx, dz_dy, sun):
    """The cosine of the angle between the normal of a cell and the sun, a LightSource; 0 if the cell faces away."""
    x, y, z = sun.direction
    return np.clip((z - x * dz_dx - y * dz_dy) / np.sqrt(1 + dz_dx**2 + dz_dy**2), 0, 1)


@dataclass
class Relief:
    """The drawn layers of a whole terrain, one value per square block of `size` cells."""

    size: int
    shade: np.ndarray  # mean
    slope_deg: np.ndarray  # mean
    steepest: tuple  # (x, y) of the block that has the largest mean slope
    low_m: float
    high_m: float


def read_relief(layer, grid, sun):
    """Reads the terrain band by band."""
    size = max(1, math.ceil(max(grid.shape) / CELLS))
    step = max(1, BAND_NODES // (grid.shape[1] * size)) * size
    shades, slopes = [], []
    low, high = np.inf, -np.inf
    for row in range(0, grid.shape[0] - 1, step):
        z = layer[row:min(row + step + 1, grid.shape[0])]
        if np.isfinite(z).any():
            low, high = min(low, np.nanmin(z)), max(high, np.nanmax(z))
        dz_dx, dz_dy = gradient(z, grid.resolution_m)
        shades.append(reduction.shrink_mean(shade(dz_dx, dz_dy, sun), size))
        slopes.append(reduction.shrink_mean(slope_deg(dz_dx, dz_dy), size))
    slope = np.concatenate(slopes)
    row, col = np.unravel_index(int(np.argmax(np.where(np.isnan(slope), -1, slope))), slope.shape)
    steepest = tuple(float(axis[0] + (at + 0.5) * size * grid.resolution_m)
                     for axis, at in ((grid.x, col), (grid.y, row)))
    return Relief(size, np.concatenate(shades), slope, steepest, low, high)


# Objects


@dataclass
class Objects:
    """/features, the objects of one kind together: {kind: (x, y, diameter)}, metres, the largest first."""

    by_kind: dict

    @property
    def count(self):
        return sum(x.size for x, _, _ in self.by_kind.values())


def read_objects(file):
    if "features" not in file:
        return Objects({})
    group = file["features"]
    try:
        x, y, diameter, kind = (files.numbers(group, name)[()] for name in ("x", "y", "diameter", "kind"))
        meanings = group["kind"].attrs["flag_meanings"]
        meanings = (meanings.decode() if isinstance(meanings, bytes) else str(meanings)).split()
        values = np.atleast_1d(group["kind"].attrs["flag_values"])
    except KeyError as error:
        raise DataError(f"{file.filename}: /features is not an object list ({error})") from error
    by_kind = {}
    for value, meaning in zip(values, meanings):
        own = np.flatnonzero(kind == value)
        if own.size:
            own = own[np.argsort(-diameter[own], kind="stable")]
            by_kind[meaning] = (x[own], y[own], diameter[own])
    return Objects(by_kind)


def kind_colors(objects):
    return dict(zip(objects.by_kind, KIND_COLORS * (1 + len(objects.by_kind) // len(KIND_COLORS))))


def draw_objects(ax, objects, max_count=None):
    """A circle for each object that shows in the panel, at most the `most` largest of each kind."""
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    for kind, color in kind_colors(objects).items():
        x, y, diameter = (column[:max_count] for column in objects.by_kind[kind])
        shows = ((x + diameter / 2 > left) & (x - diameter / 2 < right) & (y + diameter / 2 > bottom)
                 & (y - diameter / 2 < top))
        x, y, diameter = x[shows], y[shows], diameter[shows]
        ax.add_collection(EllipseCollection(diameter, diameter, np.zeros_like(diameter), units="x",
                                            offsets=np.column_stack([x, y]), transOffset=ax.transData,
                                            facecolors="none", edgecolors=color, linewidths=1))


def object_legend(ax, objects):
    """Kinds and counts below the map."""
    entries = []
    for kind, color in kind_colors(objects).items():
        count = objects.by_kind[kind][0].size
        largest = f", the {MAX_OBJECTS} largest drawn" if count > MAX_OBJECTS else ""
        entries.append(Patch(facecolor="none", edgecolor=color, linewidth=1.5,
                             label=f"{kind.replace('_', ' ')} ({count:,}{largest})"))
    if entries:
        ax.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, -0.11), ncol=min(3, len(entries)),
                  frameon=False)


# Panels


def node_frame(ax, grid, title):
    ax.set(title=title, xlabel="x (m)", ylabel="y (m)", aspect="equal", xlim=(grid.x[0], grid.x[-1]),
           ylim=(grid.y[0], grid.y[-1]))


def draw_cells(ax, grid, image, size, **style):
    """An image whose blocks of cells begin at the first node."""
    step = size * grid.resolution_m
    rows, cols = image.shape
    extent = (grid.x[0], grid.x[0] + cols * step, grid.y[0], grid.y[0] + rows * step)
    ax.set_facecolor(maps.NO_VALUE)
    return ax.imshow(np.ma.masked_invalid(image), extent=extent, interpolation="antialiased", **style)


def draw_hillshade(ax, grid, image, size):
    draw_cells(ax, grid, image, size, cmap="gray", vmin=0, vmax=1)


def draw_slope(ax, grid, relief):
    scale = scales.count_scale(relief.slope_deg, relief.slope_deg, "magnitude", "deg", 1e-3)
    draw_cells(ax, grid, relief.slope_deg, relief.size, cmap=scales.color_map("magnitude"), vmin=0, vmax=scale.high)
    maps.draw_color_bar(ax, scale, "slope")
    maps.note(ax, *scale.notes())


def draw_zoom(ax, grid, layer, objects, options, relief):
    site_m = min(grid.x[-1] - grid.x[0], grid.y[-1] - grid.y[0])
    center = options.zoom_at or relief.steepest
    window, rows, cols = maps.zoom_window(grid, center, options.zoom_width_m or site_m / 10)
    node_frame(ax, window, f"zoom at ({center[0]:.4g}, {center[1]:.4g}) m, every cell")
    sun = LightSource(options.sun_azimuth_deg, options.sun_elevation_deg)
    draw_hillshade(ax, window, shade(*gradient(layer[rows, cols], grid.resolution_m), sun), 1)
    draw_objects(ax, objects)
    maps.draw_scale_marks(ax)
    return window


def figure_of(options):
    with files.open_landfall(options.terrain, "landfall.terrain") as file:
        grid = files.read_grid(file)
        if grid is None or "z" not in file or files.numbers(file, "z").shape != grid.shape:
            raise DataError(f"{options.terrain}: needs the layers x, y and z of a gridded terrain")
        relief = read_relief(files.numbers(file, "z"), grid, LightSource(options.sun_azimuth_deg, options.sun_elevation_deg))
        objects = read_objects(file)
        figure, axes = maps.new_figure((1, 3), (20.5, 7.4), title(grid, relief, objects, options))
        node_frame(axes[0, 0], grid, "hillshade" + (" and objects" if objects.count else ""))
        draw_hillshade(axes[0, 0], grid, relief.shade, relief.size)
        draw_objects(axes[0, 0], objects, MAX_OBJECTS)
        maps.draw_scale_marks(axes[0, 0])
        object_legend(axes[0, 0], objects)
        over = f", mean over {captions.metres(relief.size * grid.resolution_m)}" if relief.size > 1 else ""
        node_frame(axes[0, 1], grid, f"slope of cells of {captions.metres(grid.resolution_m)}{over}")
        draw_slope(axes[0, 1], grid, relief)
        window = draw_zoom(axes[0, 2], grid, file["z"], objects, options, relief)
        for ax in axes[0, :2]:
            maps.draw_rectangle(ax, (window.x[0], window.y[0]),
                                (window.x[-1] - window.x[0], window.y[-1] - window.y[0]))
        return figure


def title(grid, relief, objects, options):
    heights = f", {relief.low_m:.3g} to {relief.high_m:.3g} m high" if np.isfinite(relief.low_m) else ""
    return (f"{os.path.basename(options.terrain)}: {grid.shape[1]:,} x {grid.shape[0]:,} nodes of "
            f"{captions.metres(grid.resolution_m)}{heights}"
            + (f", {captions.counted(objects.count, 'object')}" if objects.count else ""))


main = plot_command.main_of(parse, figure_of)
