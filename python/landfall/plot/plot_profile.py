# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D243
"""Draws true and estimated elevation, and the error, along a line across a DEM made by regrid.

The profile has the value of each bin that the line crosses, at the middle of its part of the line. Nothing is interpolated, so that
a bin without a return is a gap.
"""
import math
import os
from dataclasses import dataclass

import numpy as np

from landfall.errors import UsageError
from landfall.plot import captions, maps, plot_command, plot_dem, reduction, scales

TRUE, ESTIMATED, LIMIT = maps.SKY_BLUE, maps.VERMILION, "#a3478f"  # as in the report


def add_options(parser):
    parser.add_argument("--from", dest="start", type=plot_command.place, metavar="X,Y", required=True,
                        help="first end of the line, metres in the frame of the DEM")
    parser.add_argument("--to", dest="end", type=plot_command.place, metavar="X,Y", required=True, help="other end of the line")
    parser.add_argument("--limit-m", type=plot_command.positive_metres, default=0.05,
                        help="limit of the relative elevation error, drawn as lines, default 0.05")


parse = plot_command.parser_of(__doc__, {"dem": "DEM"}, add_options, "-profile.png")


def require_inside(options, grid):
    if options.start == options.end:
        raise UsageError("--from and --to are the same point")
    for option, point in (("--from", options.start), ("--to", options.end)):
        for name, axis, value in zip("xy", (grid.x, grid.y), point):
            low, high = axis[0] - grid.resolution_m / 2, axis[-1] + grid.resolution_m / 2
            if not low <= value <= high:
                raise UsageError(f"{options.dem}: {option}: {name} = {value:g} m is outside the map, [{low:g}, {high:g}] m")


# Profiles


@dataclass(frozen=True)
class Bins:
    """The bins under a line, in order: their indices, and the distances at the middles of their parts of the line."""

    rows: np.ndarray
    cols: np.ndarray
    at_m: np.ndarray
    length_m: float

    def of(self, layer):
        return layer[self.rows, self.cols]


def bins_under(grid, start, end):
    """A line along a border between bins takes those to the right or above, at the border of the map the last ones."""
    corner = np.array([grid.x[0], grid.y[0]]) - grid.resolution_m / 2
    ends = (np.array([start, end]) - corner) / grid.resolution_m  # in bins
    step = ends[1] - ends[0]
    cuts = [np.array([0.0, 1.0])]
    for first, along in zip(ends[0], step):
        if along != 0:
            low, high = sorted((first, first + along))
            cuts.append((np.arange(math.ceil(low), math.floor(high) + 1) - first) / along)
    cuts = np.unique(np.clip(np.concatenate(cuts), 0, 1))
    middles = (cuts[:-1] + cuts[1:])[np.diff(cuts) > 1e-12] / 2
    col, row = (np.floor(ends[0] + middles[:, None] * step).astype(int)).T
    length_m = math.dist(start, end)
    return Bins(np.minimum(row, grid.y.size - 1), np.minimum(col, grid.x.size - 1), middles * length_m, length_m)


# Drawing


def draw_curve(ax, at, values, **style):
    """A line with gaps; a value between two gaps is a dot."""
    ax.plot(at, values, **style)
    gap = np.concatenate([[True], np.isnan(values), [True]])
    alone = gap[:-2] & ~gap[1:-1] & gap[2:]
    ax.plot(at[alone], values[alone], ".", color=style["color"], markersize=3 * style["linewidth"])


def draw_elevations(ax, bins, layers):
    if layers["z_true"] is not None:
        draw_curve(ax, bins.at_m, bins.of(layers["z_true"]), color=TRUE, linewidth=4.5, label="true elevation z_true")
    draw_curve(ax, bins.at_m, bins.of(layers["z_est"]), color=ESTIMATED, linewidth=1.4, label="estimated elevation z_est")
    ax.set(ylabel="elevation (m)", xlim=(0, bins.length_m))
    ax.grid(True, color="#e0e0e0", linewidth=0.6)
    empty = int(np.isnan(bins.of(layers["z_est"])).sum())
    gaps = f", {empty:,} of them without a return" if empty else ""
    truth = "" if layers["z_true"] is not None else "; this DEM has no truth layer"
    ax.set_title(f"{captions.counted(bins.at_m.size, 'bin')} along {bins.length_m:.2f} m{gaps}{truth}")
    ax.legend(fontsize=maps.NOTE_PT, framealpha=0.9)


def draw_error(ax, bins, error, limit_m):
    known = error[~np.isnan(error)]
    end = max(1.15 * limit_m, 1e-3, 1.06 * np.abs(known).max(initial=0))
    unit, factor = captions.length_unit(end)
    draw_curve(ax, bins.at_m, error * factor, color="black", linewidth=1.1)
    for place, limit in enumerate((limit_m, -limit_m)):
        ax.axhline(limit * factor, color=LIMIT, linestyle="--", linewidth=1.5,
                   label=None if place else f"limit ±{captions.metres(limit_m)} of the relative error")
    ax.set(ylabel=f"{plot_dem.SIGN} ({unit})", xlim=(0, bins.length_m), ylim=(-end * factor, end * factor),
           title=f"error e_z: {error_text(known, limit_m)}")
    ax.grid(True, color="#e0e0e0", linewidth=0.6)
    ax.legend(loc="upper right", fontsize=maps.NOTE_PT, framealpha=0.9)


def error_text(known, limit_m):
    if known.size == 0:
        return "no value on the line"
    largest = float(known[np.argmax(np.abs(known))])
    beyond = int((np.abs(known) > limit_m).sum())
    return (f"largest {captions.metres(largest)}, root mean square {captions.metres(float(np.sqrt(np.mean(known**2))))}, "
            f"{captions.counted(beyond, 'bin')} beyond ±{captions.metres(limit_m)}")


def draw_map(ax, grid, estimated, options):
    """The estimated elevation with the line on it."""
    scale = scales.elevation_scale([estimated], [maps.reduced(ax, estimated, reduction.shrink_mean)])
    maps.frame_map(ax, grid, "estimated elevation")
    maps.draw_elevations(ax, grid, estimated, scale)
    maps.note(ax, scale.range_text(), scale.clipping_text())
    x, y = zip(options.start, options.end)
    for color, width in (("white", 3.6), ("black", 1.6)):
        ax.plot(x, y, color=color, linewidth=width, gid="line")
    ax.plot(x[0], y[0], "o", markersize=7, markerfacecolor="white", markeredgecolor="black", gid="start")
    maps.draw_scale_marks(ax)


def draw(grid, layers, options):
    has_truth = layers["z_true"] is not None
    bins = bins_under(grid, options.start, options.end)
    ends = " to ".join("({:.6g}, {:.6g})".format(*point) for point in (options.start, options.end))
    title = f"{os.path.basename(options.dem)}: profile from {ends} m"
    figure, axes = maps.new_figure((2 if has_truth else 1, 2), (16, 7.4 if has_truth else 5.6), title, width_ratios=[1.7, 1])
    draw_elevations(axes[0, 0], bins, layers)
    if has_truth:
        draw_error(axes[1, 0], bins, bins.of(layers["z_true"]) - bins.of(layers["z_est"]), options.limit_m)
    axes[-1, 0].set_xlabel("distance along the line (m), from the circle; the value of each bin, none interpolated")
    place = axes[0, 1].get_gridspec()[:, 1]
    for ax in axes[:, 1]:
        ax.remove()
    draw_map(figure.add_subplot(place), grid, layers["z_est"], options)
    return figure


def figure_of(options):
    grid, layers = plot_dem.read(options.dem)
    require_inside(options, grid)
    return draw(grid, layers, options)


main = plot_command.main_of(parse, figure_of)
