# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws where each scan pattern aims: a small scan of flat terrain for each, from 500 m at -23 m/s (docs/user/lidar). With --animate, an SVG in
which the patterns, and the scanners that have none, move at a quarter of their speed."""
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
    """One pattern, or a scanner without one: its configuration, its caption, and the scan's pulses and pixels."""

    keys: dict
    caption: str
    pulses: int = 2000
    pixels: int = 1
    ifov_rad: float = 8.9e-5

    def scanner(self, folder):
        keys = dict(self.keys)
        if "path" in keys:
            keys["path"] = os.path.join(folder, keys["path"])
        return keys if keys["type"] in ("palmer", "polygon", "risley") else {"type": "fsm", "pattern": keys}


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
# The scanners that follow no pattern of the ground, which the animation has too.
SCANNERS = [
    Panel({"type": "palmer", "tilt_deg": 2, "incidence_deg": 45, "rate_hz": 1}, "tilted mirror on a motor, 1 turn/s", 600),
    Panel({"type": "polygon", "facets": 36, "rate_hz": 0.4, "duty_frac": 0.5, "frame_amplitude_deg": 5, "frame_rate_hz": 0.5}, "36 facets and a frame mirror", 1200),
    Panel({"type": "risley", "index": 1.51, "wedge_deg": 4, "rates_hz": [4, -2.3]}, "two prisms, 4 and -2.3 turns/s", 1200),
]


def write_star(path):
    times = np.linspace(0, SCAN_TIME_S, len(STAR))
    with open(path, "w", encoding="utf-8") as file:
        file.write("t_s,x_m,y_m\n" + "".join(f"{t},{x},{y}\n" for t, (x, y) in zip(times, STAR)))


def configuration(panel, folder):
    return {"detector": {"rows": panel.pixels, "columns": panel.pixels, "ifov_rad": panel.ifov_rad},
            "laser": {"pulse_rate_hz": panel.pulses / SCAN_TIME_S, "scan_time_s": SCAN_TIME_S},
            "scanner": panel.scanner(folder)}


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


def prepare(folder, options):
    write_star(os.path.join(folder, "star.csv"))
    plot_command.run_tool("terrain-gen", folder, "terrain", TERRAIN, options)


def figure_of(folder, options):
    prepare(folder, options)
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


# Animation

CELL_px, ACROSS, SLOWER = 180, 5, 4  # the edge of a panel, panels in a row, and how many times slower than the scan
PIXELS_PER_M = 1.4
MAX_KEYS = 60                        # places of the beam that are given with their time


def drawn_shares(x, y):
    """(times, shares of the length of the path that are drawn by then), both from 0 to 1."""
    lengths = np.append(0, np.cumsum(np.hypot(np.diff(x), np.diff(y))))
    chosen = np.unique(np.linspace(0, len(x) - 1, min(len(x), MAX_KEYS)).round().astype(int))
    return chosen / max(len(x) - 1, 1), lengths[chosen] / (lengths[-1] or 1)


def animated_panel(panel, number, x, y):
    """A group of an SVG: the path of the beam, which grows with time, and the area that its pixels see."""
    center_x, center_y = x.mean(axis=1), y.mean(axis=1)
    times, shares = drawn_shares(center_x, center_y)
    keys, parts = ";".join(f"{t:.3g}" for t in times), ";".join(f"{share:.4g}" for share in shares)
    places = " ".join(f"{PIXELS_PER_M * a:.1f},{-PIXELS_PER_M * b:.1f}" for a, b in zip(center_x, center_y))
    size = max(5.0, PIXELS_PER_M * np.ptp(x[0]), PIXELS_PER_M * np.ptp(y[0])) if panel.pixels > 1 else 5.0
    clock = f'dur="{SLOWER * SCAN_TIME_S}s" repeatCount="indefinite" calcMode="linear" keyTimes="{keys}"'
    left, top = CELL_px * (number % ACROSS + 0.5), CELL_px * (1.15 * (number // ACROSS) + 0.5) + 50
    lines = [f'<g transform="translate({left:g} {top:g})">',
             f'<text y="-96" font-weight="bold">{panel.keys["type"]}</text><text y="-81" font-size="9">{panel.caption}</text>',
             f'<rect x="{-PIXELS_PER_M * HALF_WIDTH_M:g}" y="{-PIXELS_PER_M * HALF_WIDTH_M:g}" width="{2 * PIXELS_PER_M * HALF_WIDTH_M:g}" '
             f'height="{2 * PIXELS_PER_M * HALF_WIDTH_M:g}" fill="none" stroke="#bbb"/>']
    if len(x) == 1:
        return "".join([*lines, f'<rect x="{PIXELS_PER_M * center_x[0] - size / 2:.1f}" y="{-PIXELS_PER_M * center_y[0] - size / 2:.1f}" width="{size:.1f}" '
                        f'height="{size:.1f}" fill="#d55e00" fill-opacity=".7"/></g>'])
    lines += [f'<path id="p{number}" d="M{places}" fill="none" stroke="#0072b2" stroke-width=".9" pathLength="1" stroke-dasharray="1 1">',
              f'<animate attributeName="stroke-dashoffset" values="{";".join(f"{1 - share:.4g}" for share in shares)}" {clock}/></path>',
              f'<rect x="{-size / 2:.1f}" y="{-size / 2:.1f}" width="{size:.1f}" height="{size:.1f}" fill="#d55e00" fill-opacity=".7">',
              f'<animateMotion keyPoints="{parts}" {clock}><mpath href="#p{number}"/></animateMotion></rect></g>']
    return "".join(lines)


def animation_of(folder, options):
    prepare(folder, options)
    panels = [*PANELS, *SCANNERS]
    height = 1.15 * CELL_px * -(-len(panels) // ACROSS) + 20
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {CELL_px * ACROSS} {height:g}" font-family="sans-serif" font-size="12" text-anchor="middle">'
            f'<rect width="100%" height="100%" fill="#fff"/><text x="{CELL_px * ACROSS / 2:g}" y="20" font-size="14">Where the beam goes in {SCAN_TIME_S} s, '
            f'{SLOWER} times slower; orange: what the lidar sees at a time; grey: 100 m x 100 m</text>')
    return "\n".join([head, *(animated_panel(panel, number, *scan(panel, folder, options)) for number, panel in enumerate(panels)), "</svg>\n"])


main = plot_command.main_of_tools(__doc__, figure_of, animation_of)
