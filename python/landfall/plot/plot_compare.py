# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws two DEMs side by side, A and B, and the difference B - A on the bins that both have."""
import json
import os

import numpy as np

from landfall import dictionary, files, tools
from landfall.errors import DataError
from landfall.plot import captions, maps, plot_command, reduction, scales

ZOOM_WIDTH_M = 8.0
SIGN = "B - A"
LAYERS = [layer["name"] for layer in dictionary.layers("dem") if layer.get("axis") == "z"]


def add_options(parser):
    parser.add_argument("--layer", default="z_est", choices=LAYERS, help="elevations to compare; default z_est")
    parser.add_argument("--same-frame", action="store_true", help="take both as one frame, whatever their CRSs and centres are")
    parser.add_argument("--vertical-datum", choices=["as-is"], help="compare heights on different or unknown vertical datums as they are")


parse = plot_command.parser_of(__doc__, {"dem_a": "A", "dem_b": "B"}, add_options, "-compared.png")


def read(path, layer):
    with files.open_landfall(path, "landfall.dem") as file:
        grid = files.read_grid(file)
        values = files.read_layer(file, grid, layer)
    if values is None:
        raise DataError(f"{path}: has no layer {layer}")
    return grid, values


def place(options):
    """How B lies in the frame of A, by landfall-info --compare: the check of place is one for all tools."""
    words = ["--same-frame"] if options.same_frame else []
    words += ["--vertical-datum", options.vertical_datum] if options.vertical_datum else []
    dems = [os.path.join(".", dem) if dem.startswith("-") else dem for dem in (options.dem_a, options.dem_b)]
    return json.loads(tools.run_tool(tools.find("landfall-info"), "--compare", *dems, "--json", "--no-statistics", *words).stdout)


def cut(grid, values, first, bins):
    rows, cols = (slice(start, start + count) for start, count in zip(first, (bins["rows"], bins["columns"])))
    return type(grid)(grid.x[cols], grid.y[rows], grid.resolution_m), values[rows, cols]


def read_common(options):
    """(grid of A, layer of A, layer of B in the frame of A) on the bins in common, and lines that describe the comparison."""
    (grid_a, a), (grid_b, b) = read(options.dem_a, options.layer), read(options.dem_b, options.layer)
    placed = place(options)
    if "not_compared" in placed:
        return (grid_a, a), (grid_b, b), [f"not compared: {placed['not_compared']}"]
    bins, lines = placed["common_bins"], [f"B {said}" for said in placed["placement"]["said"]]
    if not placed["same_grid"]:
        lines.append(f"bins in common: {bins['columns']:,} x {bins['rows']:,}; A has {a.shape[1]:,} x {a.shape[0]:,}, B {b.shape[1]:,} x {b.shape[0]:,}")
    grid, a = cut(grid_a, a, bins["first_in_a"], bins)
    return (grid, a), (grid, cut(grid_b, b, bins["first_in_b"], bins)[1] + placed["placement"]["shift_m"][2]), lines


def draw_side(ax, grid, name, values, scale):
    maps.frame_map(ax, grid, name)
    maps.draw_elevations(ax, grid, values, scale)
    maps.draw_scale_marks(ax)
    low, high = scales.extremes(values)
    empty = int(np.isnan(values).sum())
    maps.note(ax, "no value anywhere" if np.isnan(low) else captions.metre_range(low, high), scale.clipping_text(),
              f"{captions.counted(empty, 'bin')} without a value (grey)" if empty else "")


def statistics_text(difference):
    valid = difference[~np.isnan(difference)]
    if valid.size == 0:
        return "no bin has a value in both"
    nmad = 1.4826 * np.median(np.abs(valid - np.median(valid)))
    return (f"{captions.counted(valid.size, 'bin')} with both: mean {captions.metres(valid.mean())}, "
            f"standard deviation {captions.metres(valid.std())}, NMAD {captions.metres(nmad)}")


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
    (grid_a, a), (grid_b, b), lines = read_common(options)
    is_compared = grid_a is grid_b
    title = f"{options.layer} of two DEMs" + (f"; B - A of {statistics_text(b - a)}" if is_compared else "")
    rows, height = (2, 13) if is_compared else (1, 7.5)
    figure, axes = maps.new_figure((rows, 2), (14, height), "\n".join([title, *lines]))
    scale = scales.elevation_scale([a, b], [maps.reduced(axes[0, 0], z, reduction.shrink_mean) for z in (a, b)])
    draw_side(axes[0, 0], grid_a, f"A: {options.dem_a}", a, scale)
    draw_side(axes[0, 1], grid_b, f"B: {options.dem_b}", b, scale)
    if is_compared:
        draw_difference(axes[1], grid_a, b - a)
    return figure


main = plot_command.main_of(parse, figure_of)
