# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws two DEMs on equal grids side by side, A and B, and the difference B - A."""

import numpy as np

from landfall import files
from landfall.errors import DataError
from landfall.plot import maps, plots, reduction, scales

ZOOM_WIDTH_M = 8.0
SIGN = "B - A"
LAYERS = ["z_est", "z_true", "z_corrected", "z_true_map"]


parse = plots.parser_of("plot_compare.py", __doc__, {"dem_a": "A", "dem_b": "B"}, lambda parser: parser.add_argument(
    "--layer", default="z_est", choices=LAYERS, help="elevations to compare; default z_est"), "-compared.png")


def read(path, layer):
    with files.open_landfall(path, "landfall.dem") as file:
        grid = files.read_grid(file)
        values = files.read_layer(file, grid, layer)
    if values is None:
        raise DataError(f"{path}: has no layer {layer}")
    return grid, values


def read_both(options):
    """(grid, layer of A, layer of B)."""
    grid, a = read(options.dem_a, options.layer)
    other, b = read(options.dem_b, options.layer)
    if (grid.shape, grid.resolution_m, grid.half_width_m) != (other.shape, other.resolution_m, other.half_width_m):
        raise DataError(f"{options.dem_b}: has another grid than {options.dem_a}")
    return grid, a, b


def draw_side(ax, grid, name, values, scale):
    maps.frame_map(ax, grid, name)
    maps.draw_elevations(ax, grid, values, scale)
    maps.draw_scale_marks(ax)
    low, high = scales.extremes(values)
    empty = int(np.isnan(values).sum())
    maps.note(ax, "no value anywhere" if np.isnan(low) else plots.metre_range(low, high), scale.clipping_text(),
              f"{plots.counted(empty, 'bin')} without a value (grey)" if empty else "")


def statistics_text(difference):
    valid = difference[~np.isnan(difference)]
    if valid.size == 0:
        return "no bin has a value in both"
    nmad = 1.4826 * np.median(np.abs(valid - np.median(valid)))
    return (f"{plots.counted(valid.size, 'bin')} with both: mean {plots.metres(valid.mean())}, "
            f"standard deviation {plots.metres(valid.std())}, NMAD {plots.metres(nmad)}")


def draw_difference(axes, grid, difference):
    """The whole map, and every bin about the largest difference."""
    scale = scales.error_scale(difference, maps.reduced(axes[0], difference), data_only=True)
    maps.frame_map(axes[0], grid, "difference B - A")
    maps.draw_values(axes[0], grid, difference, scale, SIGN)
    maps.draw_scale_marks(axes[0])
    maps.note(axes[0], *scale.notes(), maps.blocks_note(axes[0], difference.shape))
    center = maps.largest_bin(grid, difference)
    window, rows, cols = maps.zoom_window(grid, center, ZOOM_WIDTH_M)
    maps.frame_map(axes[1], window, f"largest difference, at ({center[0]:.2f}, {center[1]:.2f}) m, every bin")
    maps.draw_values(axes[1], window, difference[rows, cols], scale, SIGN)
    axes[1].plot(*center, "o", markersize=14, markerfacecolor="none", markeredgecolor="black")
    maps.draw_scale_marks(axes[1])
    maps.draw_zoom_frame(axes[0], window)


def figure_of(options):
    grid, a, b = read_both(options)
    difference = b - a
    title = f"{options.layer} of two DEMs; B - A of {statistics_text(difference)}"
    figure, axes = maps.new_figure((2, 2), (14, 13), title)
    scale = scales.elevation_scale([a, b], [maps.reduced(axes[0, 0], z, reduction.shrink_mean) for z in (a, b)])
    draw_side(axes[0, 0], grid, f"A: {options.dem_a}", a, scale)
    draw_side(axes[0, 1], grid, f"B: {options.dem_b}", b, scale)
    draw_difference(axes[1], grid, difference)
    return figure


main = plots.main_of(parse, figure_of)
