# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws every shape of a terrain (docs/user/terrain): seen from above, lit from the north-west, and cut along the dashed line."""
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LightSource

from landfall import files
from landfall.plot import plot_command

RESOLUTION_M = 0.05


@dataclass(frozen=True)
class Panel:
    """One object at the centre of flat terrain; its cut runs at `cut_deg` from +x."""

    feature: dict
    half_width_m: float = 6
    cut_deg: float = 0


PANELS = [
    Panel({"type": "cone", "radius_m": 3, "height_m": 4}),
    Panel({"type": "hemisphere", "radius_m": 3}),
    Panel({"type": "pyramid", "base_width_m": 5, "height_m": 3, "yaw_deg": 20}, cut_deg=20),
    Panel({"type": "rock", "diameter_m": 6, "yaw_deg": 30}, cut_deg=30),
    Panel({"type": "ice_block", "length_m": 6, "width_m": 4, "height_m": 2.5, "yaw_deg": 30, "tilt_deg": 15}, cut_deg=120),
    Panel({"type": "crater", "diameter_m": 12}, 12),
    Panel({"type": "pit", "diameter_m": 8, "depth_m": 4, "wall_slope_deg": 75}),
    Panel({"type": "fracture", "length_m": 40, "width_m": 4, "depth_m": 3, "throw_m": 2, "fade_m": 14,
           "wall_slope_deg": 70, "yaw_deg": 20}, 24, 110),
    Panel({"type": "ridge", "length_m": 50, "width_m": 5, "height_m": 3, "spacing_m": 7, "taper_m": 15, "yaw_deg": 30},
          24, 120),
    Panel({"type": "penitente_field", "length_m": 40, "width_m": 36, "amplitude_m": 3, "wavelength_m": 7.5, "wobble_m": 2},
          24, 90),
]


def terrain(panel, folder, options):
    """x and y of the nodes, metres, and the elevations, one row per y."""
    resolution_m = RESOLUTION_M if panel.half_width_m <= 12 else 2 * RESOLUTION_M
    config = {"grid": {"half_width_m": panel.half_width_m, "resolution_m": resolution_m}, "features": [panel.feature]}
    with files.open_landfall(plot_command.run_tool("terrain-gen", folder, "terrain", config, options), "landfall.terrain") as file:
        return file["x"][()], file["y"][()], file["z"][()]


def cut(panel, x, y, z):
    """Distance along the cut and elevation, bilinear between the nodes."""
    s = np.linspace(-panel.half_width_m, panel.half_width_m, 4 * len(x))
    angle = np.radians(panel.cut_deg)
    u = (s * np.cos(angle) - x[0]) / (x[1] - x[0])
    v = (s * np.sin(angle) - y[0]) / (y[1] - y[0])
    col, row = (np.clip(np.floor(w).astype(int), 0, len(x) - 2) for w in (u, v))
    p, q = u - col, v - row
    south = (1 - p) * z[row, col] + p * z[row, col + 1]
    north = (1 - p) * z[row + 1, col] + p * z[row + 1, col + 1]
    return s, (1 - q) * south + q * north


def draw_panel(above, beside, panel, x, y, z):
    half = panel.half_width_m
    # Row 0 is the southernmost, but hillshade expects the northernmost first; hence the sign of dy.
    shade = LightSource(azdeg=315, altdeg=35).hillshade(z, dx=x[1] - x[0], dy=y[0] - y[1], fraction=1)
    above.imshow(shade, origin="lower", extent=(x[0], x[-1], y[0], y[-1]), cmap="gray", vmin=0, vmax=1)
    end = half * np.array([np.cos(np.radians(panel.cut_deg)), np.sin(np.radians(panel.cut_deg))])
    above.plot([-end[0], end[0]], [-end[1], end[1]], "--", color="crimson", linewidth=0.9)
    above.set_title(panel.feature["type"], fontsize=11, fontweight="bold")
    above.set(xticks=[-half, 0, half], yticks=[-half, 0, half])
    s, height = cut(panel, x, y, z)
    beside.axhline(0, color="0.7", linewidth=0.7)
    beside.plot(s, height, color="crimson", linewidth=1.2)
    margin = 0.1 * np.ptp(height)
    beside.set(xlim=(-half, half), ylim=(height.min() - margin, height.max() + margin), xticks=[-half, 0, half])
    for ax in (above, beside):
        ax.tick_params(labelsize=8)


def figure_of(folder, options):
    figure, axes = plt.subplots(4, 5, figsize=(15, 9.8), layout="constrained", height_ratios=[3, 1.3, 3, 1.3])
    for number, panel in enumerate(PANELS):
        row, col = 2 * (number // 5), number % 5
        draw_panel(axes[row, col], axes[row + 1, col], panel, *terrain(panel, folder, options))
    for row in range(4):
        axes[row, 0].set_ylabel("y, m" if row % 2 == 0 else "height, m", fontsize=9)
    for ax in axes[-1]:
        ax.set_xlabel("along the cut, m", fontsize=9)
    figure.suptitle("The shapes on flat terrain, lit from the north-west, and a cut along the dashed line (heights not to the scale of lengths)")
    return figure


main = plot_command.main_of_tools(__doc__, figure_of)
