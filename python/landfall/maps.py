# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps of bins: colour scales, panels and what is drawn on them."""
import math
from dataclasses import dataclass

import matplotlib.patheffects
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.patches import Circle, Patch, Rectangle
from matplotlib.ticker import MaxNLocator

from landfall import colors, reduction

FONT_PT = 11
NO_VALUE, MARK = colors.css(colors.NO_VALUE), colors.css(colors.MARK)
OUTLINE = [matplotlib.patheffects.withStroke(linewidth=2.6, foreground="white")]
# Okabe and Ito's palette, whose colours are distinguishable with all common forms of colour blindness.
BLUE, SKY_BLUE, VERMILION = "#0072b2", "#56b4e9", "#d55e00"

plt.rcParams.update({"font.size": FONT_PT, "axes.titlesize": FONT_PT + 1, "figure.titlesize": FONT_PT + 3,
                     "axes.linewidth": 0.8, "image.interpolation": "nearest", "image.origin": "lower"})


# Scales


@dataclass(frozen=True)
class Scale:
    """The quantity that has the colour map, its limits in metres, and the unit that its colour bar shows."""

    quantity: str
    low_m: float
    high_m: float

    @property
    def unit(self):
        largest = max(abs(self.low_m), abs(self.high_m))
        return ("m", 1.0) if largest >= 0.5 else ("cm", 100.0) if largest >= 0.01 else ("mm", 1000.0)


def finite_extremes(*layers):
    """(lowest, highest) value of all layers; (nan, nan) where there is none."""
    return (float(np.fmin.reduce([np.fmin.reduce(layer, axis=None) for layer in layers])),
            float(np.fmax.reduce([np.fmax.reduce(layer, axis=None) for layer in layers])))


def signed_scale(*layers):
    """Symmetric about 0, at least +-1 mm, so that rounding noise does not fill a panel with colour."""
    low, high = finite_extremes(*layers)
    bound = max(abs(low), abs(high), 1e-3) if np.isfinite(low) else 1e-3
    return Scale("error", -bound, bound)


def magnitude_scale(layer):
    """From 0 to the largest value, at least 1 mm."""
    high = finite_extremes(layer)[1]
    return Scale("magnitude", 0, max(high, 1e-3) if np.isfinite(high) else 1e-3)


def elevation_scale(*layers):
    low, high = finite_extremes(*layers)
    if not np.isfinite(low):
        low, high = 0.0, 1.0
    return Scale("elevation", low, max(high, low + 1e-3))


# Panels


def new_figure(rows_cols, size_in, title):
    figure, axes = plt.subplots(*rows_cols, figsize=size_in, layout="constrained", squeeze=False)
    figure.suptitle(title)
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08)
    return figure, axes


def map_extent(grid, size, cells_shape):
    """The edges of the reduced image, metres: blocks at the upper and right edge may reach past the map."""
    left, bottom = grid.x[0] - grid.resolution_m / 2, grid.y[0] - grid.resolution_m / 2
    step = size * grid.resolution_m
    return (left, left + cells_shape[1] * step, bottom, bottom + cells_shape[0] * step)


def frame_map(ax, grid, title):
    """Metres on both axes, equal aspect, the whole map."""
    half = grid.resolution_m / 2
    ax.set(title=title, xlabel="x (m)", ylabel="y (m)", aspect="equal",
           xlim=(grid.x[0] - half, grid.x[-1] + half), ylim=(grid.y[0] - half, grid.y[-1] + half))


def draw_image(ax, grid, image, size, **style):
    return ax.imshow(image, extent=map_extent(grid, size, image.shape), **style)


def draw_values(ax, grid, values, scale, cells, shrink=reduction.shrink_extreme, no_value=None):
    """A map of `values` (metres) with its colour bar; bins of `no_value` are shown enlarged."""
    size = reduction.block_size(values.shape, cells)
    unit, factor = scale.unit
    image = draw_image(ax, grid, shrink(values, size) * factor, size, vmin=scale.low_m * factor,
                       vmax=scale.high_m * factor, cmap=colors.color_map(scale.quantity))
    if no_value is not None and no_value.any():
        draw_flags(ax, grid, no_value, MARK, cells, growth=1)
    draw_color_bar(ax, image, unit)
    if np.isnan(values).all():
        notice(ax, "no value anywhere")


def draw_color_bar(ax, image, unit):
    """A colour bar exactly as high as the map."""
    bar = ax.figure.colorbar(image, cax=ax.inset_axes([1.03, 0, 0.045, 1]))
    bar.ax.set_title(unit, fontsize=FONT_PT)


def draw_flags(ax, grid, flags, color, cells, growth=2):
    """Set bins in one colour, single ones enlarged, nothing elsewhere."""
    marks, size = reduction.shrink_marks(flags, cells, growth)
    draw_image(ax, grid, np.ma.masked_equal(marks, False), size, cmap=ListedColormap([color]), zorder=2)


def draw_outside(ax, grid, inside, cells):
    """Bins outside the region, in the colour of missing values."""
    size = reduction.block_size(inside.shape, cells)
    outside = ~reduction.shrink_any(inside, size)
    draw_image(ax, grid, np.ma.masked_equal(outside, False), size, cmap=ListedColormap([NO_VALUE]))


def outline_flags(ax, grid, flags, color, cells):
    """A line around set bins, so that what lies below stays visible."""
    if not flags.any():
        return
    marks, size = reduction.shrink_marks(flags, cells)
    left, right, bottom, top = map_extent(grid, size, marks.shape)
    half = size * grid.resolution_m / 2
    x = np.linspace(left + half, right - half, marks.shape[1])
    y = np.linspace(bottom + half, top - half, marks.shape[0])
    ax.contour(x, y, marks, levels=[0.5], colors=color, linewidths=0.9)


def notice(ax, text):
    ax.text(0.5, 0.5, text, transform=ax.transAxes, ha="center", va="center", wrap=True,
            bbox={"facecolor": "white", "edgecolor": "#808080", "boxstyle": "round"})


def draw_region(ax, radius_m):
    """The circle of the mapped region about the intended landing site."""
    ax.add_patch(Circle((0, 0), radius_m, fill=False, edgecolor="black", linewidth=1.0, path_effects=OUTLINE))


def draw_square_region(ax, half_width_m):
    """The square of the mapped region about the intended landing site."""
    draw_rectangle(ax, (-half_width_m, -half_width_m), (2 * half_width_m, 2 * half_width_m))


def round_length_m(span_m):
    """The largest of 1, 2, 5 times a power of ten that is at most span_m."""
    power = 10.0 ** math.floor(math.log10(span_m))
    return max(m * power for m in (1, 2, 5) if m * power <= span_m * (1 + 1e-9))


def draw_scale_marks(ax, footprint_m=None):
    """A scale bar in the lower left corner and, above it, the footprint to the same scale."""
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    width, height = right - left, top - bottom
    length = round_length_m(0.2 * width)
    x, y = left + 0.03 * width, bottom + 0.03 * height
    ax.plot([x, x + length], [y, y], color="black", linewidth=3, solid_capstyle="butt", path_effects=OUTLINE)
    label(ax, (x, y + 0.012 * height), f"{length:g} m")
    if footprint_m is not None and footprint_m < 0.35 * width:
        y += 0.075 * height
        draw_footprint(ax, (x + footprint_m / 2, y + footprint_m / 2), footprint_m)
        beside = (x + footprint_m + 0.012 * width, y + footprint_m / 2)
        label(ax, beside, f"footprint {footprint_m:.2g} m", "center")


def label(ax, position, text, va="bottom"):
    ax.text(*position, text, fontsize=FONT_PT - 2, va=va,
            bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0})


def draw_footprint(ax, center, footprint_m):
    corner = (center[0] - footprint_m / 2, center[1] - footprint_m / 2)
    draw_rectangle(ax, corner, (footprint_m, footprint_m))


def draw_rectangle(ax, corner, size):
    style = {"fill": False, "edgecolor": "black", "linewidth": 1.1, "zorder": 3, "path_effects": OUTLINE}
    ax.add_patch(Rectangle(corner, *size, **style))


def zoom_window(grid, center, width_m):
    """(grid, row slice, column slice) of the bins within width_m/2 of `center`, moved to lie in the map."""
    def cut(axis, at):
        n = min(axis.size, max(2, round(width_m / grid.resolution_m) + 1))
        first = int(np.clip(np.searchsorted(axis, at) - n // 2, 0, axis.size - n))
        return slice(first, first + n)

    cols, rows = cut(grid.x, center[0]), cut(grid.y, center[1])
    return type(grid)(grid.x[cols], grid.y[rows], grid.resolution_m), rows, cols


def largest_bin(grid, values):
    """(x, y) of the bin of largest magnitude; the middle of the map if it has no values."""
    magnitude = np.where(np.isnan(values), -1, np.abs(values))
    row, col = np.unravel_index(int(np.argmax(magnitude)), values.shape)
    if magnitude[row, col] < 0:
        row, col = values.shape[0] // 2, values.shape[1] // 2
    return float(grid.x[col]), float(grid.y[row])


def bin_at(grid, center):
    """(row, column) of the bin whose centre is nearest."""
    return int(np.argmin(np.abs(grid.y - center[1]))), int(np.argmin(np.abs(grid.x - center[0])))


def draw_zoom_frame(ax, window):
    """The frame of a zoom panel on the whole map."""
    half = window.resolution_m / 2
    corner = (window.x[0] - half, window.y[0] - half)
    size = (window.x[-1] - window.x[0] + 2 * half, window.y[-1] - window.y[0] + 2 * half)
    draw_rectangle(ax, corner, size)


def scale_counts(ax, largest):
    """A logarithmic axis for large counts, else an axis with integer ticks."""
    if largest > 20:
        ax.set_yscale("log")
        ax.set_ylim(0.5, 2 * largest)
    else:
        ax.yaxis.set_major_locator(MaxNLocator(integer=True))


def legend(ax, entries):
    """A legend of filled patches, {label: colour}, below the map."""
    ax.legend(handles=[Patch(facecolor=c, edgecolor="#606060", label=t) for t, c in entries.items()],
              loc="upper center", bbox_to_anchor=(0.5, -0.13), ncol=len(entries), frameon=False)
