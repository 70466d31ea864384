# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws where each scan pattern aims: a small scan of flat terrain for each, from 500 m at -23 m/s (docs/user/lidar)."""
import os
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

from landfall import files
from landfall.plot import plot_command

HALF_WIDTH_M = 50
SCAN_TIME_S = 2
TERRAIN = {"grid": {"half_width_m": 75, "resolution_m": 1}, "base": {"type": "plane"}}
STAR = np.array([(0, 48), (28, -39), (-46, 15), (46, 15), (-28, -39), (0, 48)])


@dataclass(frozen=True)
class Panel:
    """One pattern: its configuration, its caption, and the scan's pulses and pixels."""

    keys: dict
    caption: str
    pulses: int = 2000
    pixels: int = 1
    ifov_rad: float = 8.9e-5


PANELS = [
    Panel({"type": "line_search", "rows": 16, "columns": 16}, "rows 16, columns 16", 256),
    Panel({"type": "line_search", "rows": 16, "columns": 16, "direction": "boustrophedon", "ramped": True},
          "boustrophedon, ramped", 256),
    Panel({"type": "line_search", "rows": 16, "columns": 16, "compensated": False}, "compensated false", 256),
    Panel({"type": "spiral", "pitch_m": 5}, "radius_m 50, pitch_m 5", 1000),
    Panel({"type": "rosette", "rates_hz": [3, -4]}, "rates_hz [3, -4]: 7 petals"),
    Panel({"type": "rosette", "rates_hz": [10, 9.5]}, "rates_hz [10, 9.5]: opens and closes"),
    Panel({"type": "lissajous", "rates_hz": [4.5, 5]}, "rates_hz [4.5, 5]"),
    Panel({"type": "step_stare", "rows": 5, "columns": 5}, "rows 5, columns 5; a 12 x 12 array", 25, 12, 3.1e-3),
    Panel({"type": "stare", "aim_m": [20, -10]}, "aim_m [20, -10]; a 12 x 12 array", 1, 12, 3.1e-3),
    Panel({"type": "table", "path": "star.csv"}, "path star.csv: 6 rows"),
]


def write_star(path):
    times = np.linspace(0, SCAN_TIME_S, len(STAR))
    with open(path, "w", encoding="utf-8") as file:
        file.write("t_s,x_m,y_m\n" + "".join(f"{t},{x},{y}\n" for t, (x, y) in zip(times, STAR)))


def configuration(panel, folder):
    keys = dict(panel.keys)
    if "path" in keys:
        keys["path"] = os.path.join(folder, keys["path"])
    return {"detector": {"rows": panel.pixels, "columns": panel.pixels, "ifov_rad": panel.ifov_rad},
            "laser": {"pulse_rate_hz": panel.pulses / SCAN_TIME_S, "scan_time_s": SCAN_TIME_S},
            "scanner": {"type": "fsm", "pattern": keys}}


def scan(panel, folder, options):
    """(x, y), metres, one row per pulse and one column per pixel."""
    path = plot_command.run_tool("scan-sim", folder, "scan", configuration(panel, folder), options, "--terrain", os.path.join(folder, "terrain.h5"))
    with files.open_landfall(path, "landfall.scan") as file:
        x, y = file["points/x_true"][()], file["points/y_true"][()]
    return x.reshape(-1, panel.pixels ** 2), y.reshape(-1, panel.pixels ** 2)


def draw_aims(ax, x, y, dots):
    path = np.column_stack([x, y])
    line = LineCollection(np.stack([path[:-1], path[1:]], axis=1), cmap="viridis", linewidths=0.8)
    line.set_array(np.arange(len(path) - 1))
    ax.add_collection(line)
    if dots:
        ax.scatter(x, y, c=np.arange(len(x)), cmap="viridis", s=5, linewidths=0, zorder=3)


def draw_panel(ax, panel, x, y):
    ax.add_patch(plt.Rectangle((-HALF_WIDTH_M, -HALF_WIDTH_M), 2 * HALF_WIDTH_M, 2 * HALF_WIDTH_M, fill=False,
                               color="0.75", linewidth=0.8))
    if panel.pixels > 1:
        image = np.repeat(np.arange(len(x)), x.shape[1])  # of each point, which has a colour
        ax.scatter(x.ravel(), y.ravel(), c=image, cmap="viridis", s=0.8, linewidths=0, vmax=max(len(x) - 1, 1))
    center_x, center_y = x.mean(axis=1), y.mean(axis=1)
    if len(x) > 1:
        draw_aims(ax, center_x, center_y, len(x) <= 300)
    ax.plot(center_x[0], center_y[0], "o", color="crimson", markersize=5, zorder=4)
    ax.set_title(f"{panel.keys['type']}\n", fontsize=11, fontweight="bold", pad=3)
    ax.text(0.5, 1.03, panel.caption, transform=ax.transAxes, ha="center", fontsize=9)
    ax.set(xlim=(-56, 56), ylim=(-56, 56), aspect="equal", xticks=[-50, 0, 50], yticks=[-50, 0, 50])
    ax.tick_params(labelsize=8)


def figure_of(folder, options):
    write_star(os.path.join(folder, "star.csv"))
    plot_command.run_tool("terrain-gen", folder, "terrain", TERRAIN, options)
    columns = -(-len(PANELS) // 2)
    figure, axes = plt.subplots(2, columns, figsize=(3 * columns, 7.0), layout="constrained")
    for ax in axes.flat[len(PANELS):]:
        ax.remove()
    for ax, panel in zip(axes.flat, PANELS):
        draw_panel(ax, panel, *scan(panel, folder, options))
    for ax in axes[-1]:
        ax.set_xlabel("x, m", fontsize=9)
    for ax in axes[:, 0]:
        ax.set_ylabel("y, m", fontsize=9)
    figure.suptitle("Where the patterns aim: first pulse red, then dark to bright; the grey square is ±50 m")
    return figure


main = plot_command.main_of_tools(__doc__, figure_of)
