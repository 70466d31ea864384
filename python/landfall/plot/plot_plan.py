# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a plan made by scan-sim --plan: returns and frames per bin, when each bin is seen, and the time budget."""
import json
import os

import numpy as np

from landfall import files
from landfall.errors import DataError
from landfall.plot import captions, maps, plot_command, reduction, scales

BUDGET = [("in_region", "frame in the region", "#0072b2"),
          ("partly_in_region", "partly in the region", "#56b4e9"),
          ("off_region", "outside the region", "#e69f00"),
          ("blanked", "blanked", "#999999")]
UNCOVERED = maps.MARK


parse = plot_command.parser_of(__doc__, {"plan": "PLAN"})


def read(path):
    """(grid, layers by name, the plan in numbers)."""
    with files.open_landfall(path, "landfall.plan") as file:
        grid = files.read_grid(file)
        layers = {name: files.read_layer(file, grid, name) for name in ("count", "frames", "first_seen", "in_region")}
        if "plan_json" not in file or any(layer is None for layer in layers.values()):
            raise DataError(f"{path}: needs count, frames, first_seen, in_region and plan_json")
        return grid, layers, json.loads(file["plan_json"].asstr()[()])


def draw_map(ax, grid, values, style, layers, radius_m):
    """`values` where known, in the region and around it; bins of the region that nothing covers are marked.

    Returns how the marks are drawn.
    """
    title, quantity, scale_style = style
    maps.frame_map(ax, grid, title)
    scale = scales.count_scale(values, maps.reduced(ax, values, reduction.shrink_mean), **scale_style)
    maps.draw_values(ax, grid, values, scale, quantity, reduction.shrink_mean)
    inside = layers["in_region"] != 0
    how = maps.draw_marks(ax, grid, (layers["count"] == 0) & inside, UNCOVERED, np.count_nonzero(inside))
    maps.draw_region(ax, radius_m)
    maps.note(ax, *scale.notes(), maps.blocks_note(ax, values.shape, "mean"))
    return how


def draw_budget(ax, plan):
    """One bar for the time of the scan, with its parts in the legend."""
    left = 0.0
    for key, name, color in BUDGET:
        part = plan["time"][key]
        ax.barh([0], [part["time_s"]], left=left, color=color, edgecolor="white",
                label=f"{name}: {part['time_s']:.4g} s, {captions.percent(part['frac'])}")
        left += part["time_s"]
    ax.set(title=f"{plan['time']['total']['pulse_count']:,} pulses in {left:.4g} s", xlabel="time spent (s)", yticks=[],
           xlim=(0, left), ylim=(-1.2, 0.6))
    ax.legend(loc="lower center", ncol=2, frameon=False)


def draw_histogram(ax, plan, layers):
    inside = layers["in_region"] != 0
    values = layers["count"][inside].astype(int)
    shares = np.bincount(values) / values.size
    colors = [UNCOVERED] + ["#0072b2"] * (len(shares) - 1)
    ax.bar(np.arange(len(shares)), 100 * shares, color=colors)
    spread = plan["returns_per_bin"]
    ax.set(title=f"returns per bin of the region: mean {spread['mean']:.3g}, median {spread['median']}",
           xlabel="returns", ylabel="bins (%)", xlim=(-0.6, max(1, np.quantile(values, 0.9995)) + 0.6))
    ax.grid(axis="y", alpha=0.3)


def figure_of(options):
    grid, layers, plan = read(options.plan)
    coverage, frames = plan["coverage"], plan["frames_per_bin"]
    title = (f"{os.path.basename(options.plan)}: {captions.percent(coverage['uncovered_frac'])} of the region uncovered "
             f"({captions.counted(coverage['uncovered_count'], 'bin')} in {captions.counted(coverage['hole_count'], 'hole')}), "
             f"{captions.percent(frames['overlap_frac'])} seen by more than one frame")
    figure, axes = maps.new_figure((2, 3), (18.5, 11.2), title)
    radius_m = plan["region"]["radius_m"]
    known = {name: np.where(layers["count"] > 0, layers[name], np.nan) for name in ("count", "frames")}
    seen_style = {"colors": "magnitude", "base": "s", "minimum": 1e-9}
    how = [draw_map(ax, grid, values, style, layers, radius_m) for ax, values, style in
           ((axes[0, 0], known["count"], ("returns per bin", "returns", {})),
            (axes[0, 1], known["frames"], ("frames per bin (overlap)", "frames", {})),
            (axes[0, 2], layers["first_seen"], ("when each bin is first seen", "first seen", seen_style)))][0]
    draw_histogram(axes[1, 0], plan, layers)
    grid_spec = axes[1, 1].get_gridspec()
    axes[1, 1].remove()
    axes[1, 2].remove()
    draw_budget(figure.add_subplot(grid_spec[1, 1:]), plan)
    if coverage["uncovered_count"]:
        maps.legend(axes[0, 0], {f"uncovered ({how})" if how else "uncovered": UNCOVERED})
    return figure


main = plot_command.main_of(parse, figure_of)
