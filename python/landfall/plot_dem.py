# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a DEM made by regrid: true and estimated elevation side by side, and their difference e_z."""
import os

import numpy as np

from landfall import command, files, maps, plots, reduction
from landfall.errors import DataError

CELLS = 620  # blocks along a panel's edge; a panel has more pixels than that at the default dpi
ZOOM_WIDTH_M = 8.0


def parse(arguments):
    parser = command.Parser(prog="plot_dem.py", description=__doc__)
    parser.add_argument("dem", metavar="DEM.h5")
    parser.add_argument("-o", "--output", metavar="PNG", help="output file (default: DEM-figure.png beside the DEM)")
    parser.add_argument("--region-radius-m", type=plots.positive_metres, help="default: the largest that fits")
    parser.add_argument("--footprint-m", type=plots.positive_metres, default=1.7, help="default 1.7")
    plots.add_output_options(parser)
    options = parser.parse_args(arguments)
    options.output = options.output or os.path.splitext(options.dem)[0] + "-figure.png"
    plots.require_png(options.output)
    return options


def read(path):
    """(grid, layers by name); z_true is None for a DEM without truth."""
    with files.open_landfall(path, "landfall.dem") as file:
        grid = files.read_grid(file)
        layers = {name: files.read_layer(file, grid, name) for name in ("z_est", "z_true", "count")}
    if layers["z_est"] is None:
        raise DataError(f"{path}: needs the layers x, y and z_est")
    return grid, layers


def draw_panel(ax, grid, values, title, scale, style):
    """One whole map with the region's circle, scale bar and footprint."""
    maps.frame_map(ax, grid, title)
    maps.draw_values(ax, grid, values, scale, CELLS, style.shrink, no_value=np.isnan(values))
    maps.draw_region(ax, style.radius_m)
    maps.draw_scale_marks(ax, style.footprint_m)


class PanelStyle:
    def __init__(self, options, grid, shrink):
        self.radius_m = options.region_radius_m or grid.half_width_m
        self.footprint_m = options.footprint_m
        self.shrink = shrink


def draw_zoom(ax, grid, values, scale, center, options):
    """Every bin around `center`, with the footprint to scale; returns the window."""
    window, rows, cols = maps.zoom_window(grid, center, ZOOM_WIDTH_M)
    maps.frame_map(ax, window, f"zoom at ({center[0]:.2f}, {center[1]:.2f}) m, every bin")
    maps.draw_values(ax, window, values[rows, cols], scale, CELLS)
    maps.draw_footprint(ax, center, options.footprint_m)
    maps.draw_scale_marks(ax)
    return window


def draw_with_truth(axes, grid, layers, options):
    true, estimated = layers["z_true"], layers["z_est"]
    error = true - estimated
    scale = maps.elevation_scale(true, estimated)
    smooth = PanelStyle(options, grid, reduction.shrink_mean)
    draw_panel(axes[0, 0], grid, true, "true elevation", scale, smooth)
    draw_panel(axes[0, 1], grid, estimated, "estimated elevation", scale, smooth)
    scale = maps.signed_scale(error)
    low, high = maps.finite_extremes(error)
    text = f": {plots.metres(low)} to {plots.metres(high)}" if np.isfinite(low) else ""
    draw_panel(axes[1, 0], grid, error, f"e_z = true - estimated{text}", scale,
               PanelStyle(options, grid, reduction.shrink_extreme))
    window = draw_zoom(axes[1, 1], grid, error, scale, maps.largest_bin(grid, error), options)
    maps.draw_zoom_frame(axes[1, 0], window)


def draw_without_truth(axes, grid, layers, options):
    estimated = layers["z_est"]
    scale = maps.elevation_scale(estimated)
    draw_panel(axes[0, 0], grid, estimated, "estimated elevation (this DEM has no truth layer)", scale,
               PanelStyle(options, grid, reduction.shrink_mean))
    highest = maps.largest_bin(grid, estimated - scale.low_m)
    window = draw_zoom(axes[0, 1], grid, estimated, scale, highest, options)
    maps.draw_zoom_frame(axes[0, 0], window)


def draw(grid, layers, options):
    has_truth = layers["z_true"] is not None
    empty = int(np.isnan(layers["z_est"]).sum())
    title = (f"{os.path.basename(options.dem)}: {grid.shape[1]} x {grid.shape[0]} bins of "
             f"{plots.metres(grid.resolution_m)}, {empty:,} without a return (shown enlarged)")
    figure, axes = maps.new_figure((2, 2) if has_truth else (1, 2), (14, 12.2 if has_truth else 6.3), title)
    (draw_with_truth if has_truth else draw_without_truth)(axes, grid, layers, options)
    return figure


def main(arguments):
    options = parse(arguments)
    command.check_outputs([options.output], options.overwrite)
    grid, layers = read(options.dem)
    plots.save({options.output: draw(grid, layers, options)}, options.dpi)
