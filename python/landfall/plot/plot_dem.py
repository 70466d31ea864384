# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a DEM made by regrid: true and estimated elevation side by side, and their difference e_z."""
import os

import numpy as np

from landfall import files
from landfall.errors import DataError
from landfall.plot import captions, maps, plot_command, reduction, scales

ZOOM_WIDTH_M = 8.0
SIGN = "true - estimated"
LIMIT_OF = " of the relative error"


def add_options(parser):
    parser.add_argument("--region-radius-m", type=plot_command.positive_metres, help="default: the largest that fits")
    parser.add_argument("--footprint-m", type=plot_command.positive_metres, default=1.7, help="default 1.7")
    parser.add_argument("--limit-m", type=plot_command.positive_metres, default=0.05,
                        help="limit of the relative elevation error, marked on the scale of e_z, default 0.05")
    plot_command.add_data_only_option(parser)
    parser.set_defaults(draw_region=None)  # of an evaluation


parse = plot_command.parser_of(__doc__, {"dem": "DEM"}, add_options)


def read(path):
    """(grid, layers by name); z_true is None for a DEM without truth."""
    with files.open_landfall(path, "landfall.dem") as file:
        grid = files.read_grid(file)
        layers = {name: files.read_layer(file, grid, name) for name in ("z_est", "z_true", "count")}
    if layers["z_est"] is None:
        raise DataError(f"{path}: needs the layers x, y and z_est")
    return grid, layers


def finish_map(ax, grid, options):
    if options.draw_region is None:
        maps.draw_region(ax, options.region_radius_m or grid.half_width_m)
    else:
        options.draw_region(ax)
    maps.draw_scale_marks(ax, options.footprint_m)


def draw_elevations(ax, grid, layer, scale, options):
    """`layer`: title, elevations, and the factor of heights of the shading."""
    title, values, heights = layer
    maps.frame_map(ax, grid, title)
    maps.draw_elevations(ax, grid, values, scale, heights)
    marked = maps.mark_missing(ax, grid, values, "bins without a return")
    finish_map(ax, grid, options)
    low, high = scales.extremes(values)
    maps.note(ax, "no value anywhere" if np.isnan(low) else captions.metre_range(low, high), scale.clipping_text(), marked)


def zoom(ax, grid, center, options):
    """The window of the map about `center`, with the footprint to scale."""
    window, rows, cols = maps.zoom_window(grid, center, ZOOM_WIDTH_M)
    maps.frame_map(ax, window, f"zoom at ({center[0]:.2f}, {center[1]:.2f}) m, every bin")
    maps.draw_footprint(ax, center, options.footprint_m)
    return window, (rows, cols)


def draw_with_truth(axes, grid, layers, options):
    true, estimated = layers["z_true"], layers["z_est"]
    scale = scales.elevation_scale([true, estimated], [maps.reduced(axes[0, 0], z, reduction.shrink_mean) for z in (true, estimated)])
    heights = maps.relief_heights(axes[0, 0], true, grid)
    draw_elevations(axes[0, 0], grid, ("true elevation", true, heights), scale, options)
    draw_elevations(axes[0, 1], grid, ("estimated elevation", estimated, heights), scale, options)
    draw_error(axes[1], grid, true - estimated, options)


def draw_error(axes, grid, error, options):
    """The whole map of e_z, and every bin about the largest error."""
    scale = scales.error_scale(error, maps.reduced(axes[0], error), options.limit_m, options.data_only)
    maps.frame_map(axes[0], grid, "error e_z = true - estimated")
    maps.draw_values(axes[0], grid, error, scale, SIGN)
    marked = maps.mark_missing(axes[0], grid, error, "bins without a return")
    finish_map(axes[0], grid, options)
    maps.note(axes[0], *scale.notes(LIMIT_OF), maps.blocks_note(axes[0], error.shape), marked)
    window, bins = zoom(axes[1], grid, maps.largest_bin(grid, error), options)
    maps.draw_values(axes[1], window, error[bins], scale, SIGN)
    maps.draw_scale_marks(axes[1])
    maps.draw_zoom_frame(axes[0], window)


def draw_without_truth(axes, grid, layers, options):
    estimated = layers["z_est"]
    scale = scales.elevation_scale([estimated], [maps.reduced(axes[0, 0], estimated, reduction.shrink_mean)])
    title = "estimated elevation (this DEM has no truth layer)"
    draw_elevations(axes[0, 0], grid, (title, estimated, None), scale, options)
    window, bins = zoom(axes[0, 1], grid, maps.largest_bin(grid, estimated - scale.low), options)
    maps.draw_elevations(axes[0, 1], window, estimated[bins], scale)
    maps.draw_scale_marks(axes[0, 1])
    maps.draw_zoom_frame(axes[0, 0], window)


def figure_of(options):
    grid, layers = read(options.dem)
    has_truth = layers["z_true"] is not None
    empty = int(np.isnan(layers["z_est"]).sum())
    title = (f"{os.path.basename(options.dem)}: {grid.shape[1]} x {grid.shape[0]} bins of {captions.metres(grid.resolution_m)}, "
             f"{empty:,} without a return ({captions.percent(empty / layers['z_est'].size)})")
    figure, axes = maps.new_figure((2, 2) if has_truth else (1, 2), (14, 13 if has_truth else 6.7), title)
    (draw_with_truth if has_truth else draw_without_truth)(axes, grid, layers, options)
    return figure


main = plot_command.main_of(parse, figure_of)
