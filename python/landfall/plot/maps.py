# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps of bins: panels, colour bars and marks."""
import math

import matplotlib.patheffects
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize, to_rgba
from matplotlib.patches import Circle, Patch, Rectangle
from matplotlib.ticker import MaxNLocator

from landfall.errors import printable_lines
from landfall.plot import reduction, relief, scales

FONT_PT, NOTE_PT, NOTE_LETTERS_PER_IN = 11, 9, 11
MAP_SHARE = 0.62      # of the width of a column of panels that a map fills, at least
ABOVE_FRAME = 2.6     # a frame has 2.5 and would hide marks on the border of a map
MAX_OUTLINED = 0.03  # of the blocks of a map: more lines would hide it
NO_VALUE, MARK = scales.css(scales.NO_VALUE), scales.css(scales.MARK)
OUTLINE = [matplotlib.patheffects.withStroke(linewidth=2.6, foreground="white")]
# Okabe and Ito's palette, whose colours are distinguishable with all common forms of colour blindness.
BLUE, SKY_BLUE, VERMILION = "#0072b2", "#56b4e9", "#d55e00"

STYLE = {"font.size": FONT_PT, "axes.titlesize": FONT_PT + 1, "figure.titlesize": FONT_PT + 3,
         "axes.linewidth": 0.8, "image.interpolation": "nearest", "image.origin": "lower"}
plt.rcParams.update(STYLE)


# Panels


def new_figure(rows_cols, size_in, title, **ratios):
    figure, axes = plt.subplots(*rows_cols, figsize=size_in, layout="constrained", squeeze=False, **ratios)
    figure.suptitle(printable_lines(title), parse_math=False)  # it holds the name of a file
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08)
    return figure, axes


def block_size(ax, shape):
    """The edge, in bins, of the blocks in which a panel shows a map of this shape."""
    columns = ax.get_subplotspec().get_gridspec().ncols
    return reduction.block_size(shape, int(MAP_SHARE * ax.figure.get_figwidth() * ax.figure.dpi / columns))


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


def note(ax, *texts):
    """Texts between the title and the map, as many on a line as fit its width; empty ones are left out."""
    figure_width_in = ax.figure.get_figwidth() / ax.get_subplotspec().get_gridspec().ncols
    lines = [""]
    for text in filter(None, texts):
        joined = f"{lines[-1]}; {text}" if lines[-1] else text
        if len(joined) > NOTE_LETTERS_PER_IN * figure_width_in and lines[-1]:
            lines.append(text)
        else:
            lines[-1] = joined
    ax.set_title(ax.get_title(), pad=6 + NOTE_PT * 1.35 * len(lines))
    ax.annotate("\n".join(lines), (0.5, 1), (0, 4), "axes fraction", textcoords="offset points", ha="center", va="bottom",
                fontsize=NOTE_PT, linespacing=1.2, gid="note").set_in_layout(False)


def blocks_note(ax, shape, rule="largest"):
    size = block_size(ax, shape)
    return "" if size == 1 else f"{rule} of each {size} x {size} bins"


def draw_values(ax, grid, values, scale, quantity="", shrink=reduction.shrink_extreme):
    """A map of values with its colour bar; `shrink` reduces a block of bins to one value."""
    size = block_size(ax, values.shape)
    draw_image(ax, grid, shrink(values, size), size, cmap=scales.color_map(scale.colors), vmin=scale.low, vmax=scale.high)
    draw_color_bar(ax, scale, quantity)


def reduced(ax, values, shrink=reduction.shrink_extreme):
    """The values that a panel shows."""
    return shrink(values, block_size(ax, values.shape))


def relief_heights(ax, values, grid):
    """The factor of heights of a shaded map; see relief.factor."""
    size = block_size(ax, values.shape)
    return relief.factor(reduction.shrink_mean(values, size), size * grid.resolution_m)


def draw_elevations(ax, grid, values, scale, heights=None):
    """A shaded map of elevations with its colour bar, greyer the fewer bins of a block have a value."""
    size = block_size(ax, values.shape)
    step_m = size * grid.resolution_m
    mean, missing = reduction.shrink_mean(values, size), reduction.shrink_share(np.isnan(values), size)
    heights = relief.factor(mean, step_m) if heights is None else heights
    draw_image(ax, grid, relief.image(mean, step_m, scale, heights, missing), size)
    draw_color_bar(ax, scale, "elevation")


def draw_color_bar(ax, scale, quantity=""):
    """A colour bar exactly as high as the map: the limit of an error is a triangle and a line, and an end beyond which values lie
    is pointed."""
    unit, factor = scale.unit
    image = ScalarMappable(Normalize(scale.low * factor, scale.high * factor), scales.color_map(scale.colors))
    bar = ax.figure.colorbar(image, cax=ax.inset_axes([1.045, 0, 0.045, 1]), extend=scale.extend, extendfrac=0.03)
    label = quantity + (f" ({unit})" if unit and quantity else unit)
    bar.set_label(label, fontsize=NOTE_PT + 1)
    for limit in scale.limits():
        bar.ax.axhline(limit * factor, color="white", linewidth=3)
        bar.ax.axhline(limit * factor, color="black", linewidth=1.4)
        bar.ax.plot(-0.28, limit * factor, marker=">", color="black", markersize=6, markeredgewidth=0, clip_on=False,
                    transform=bar.ax.get_yaxis_transform(), gid="limit")


def draw_marks(ax, grid, flags, color, region_bins=None, fill_few=False):
    """Marks set bins, nothing elsewhere: single ones enlarged while they are few, otherwise the opacity is their share of a block.

    With `fill_few`, blocks with a set bin are filled before that, while they are less than 1 % of the map, and the opacity of others is the
    cube root of their share: thin edges on ground of any colour are seen.

    Returns its text in the legend, empty if bins are drawn as they are.
    """
    size = block_size(ax, flags.shape)
    marks = reduction.enlarged_marks(flags, size, flags.size if region_bins is None else region_bins)
    how = "single ones enlarged" if marks is not None and flags.any() and max(marks.shape) > reduction.WIDE_BLOCKS else ""
    if marks is None:
        marks, how = reduction.shrink_any(flags, size), "each pixel with one"
        if not fill_few or marks.sum() >= reduction.MAX_MARKED * marks.size:
            share = reduction.shrink_share(flags, size)
            marks, how = (np.cbrt(share), "each pixel with one, fuller with more") if fill_few else (share, "share of each pixel")
        how = how if size > 1 else ""
    image = np.empty((*marks.shape, 4))
    image[...] = to_rgba(color)
    image[..., 3] = marks
    draw_image(ax, grid, image, size, zorder=ABOVE_FRAME, gid="marks")
    return how


def draw_outside(ax, grid, inside):
    """Bins outside the region, in the colour of missing values."""
    size = block_size(ax, inside.shape)
    outside = ~reduction.shrink_any(inside, size)
    draw_image(ax, grid, np.ma.masked_equal(outside, False), size, cmap=ListedColormap([NO_VALUE]))


def marks_text(name, how, color="magenta"):
    """The meaning of marks: 'magenta: bins without a return, single ones enlarged'."""
    return f"{color}: {name}" + (f", {how}" if how else "")


def mark_missing(ax, grid, values, name, inside=None):
    """Marks bins without a value, of the whole map or of those inside, where they are few; many of them are grey. Returns what shows them."""
    inside = np.ones(values.shape, bool) if inside is None else inside
    missing, count = np.isnan(values) & inside, np.count_nonzero(inside)
    if not missing.any():
        return ""
    if np.count_nonzero(missing) >= reduction.MAX_MARKED * count:
        return marks_text(name, "", "grey")
    return marks_text(name, draw_marks(ax, grid, missing, MARK, count))


def outline_flags(ax, grid, flags, color):
    """A line around blocks with set bins, so that what lies below stays visible. Draws nothing and returns False where lines would
    hide the map."""
    size = block_size(ax, flags.shape)
    marks = reduction.shrink_any(flags, size)
    if not marks.any() or np.count_nonzero(marks & ~inner(marks)) > MAX_OUTLINED * marks.size:
        return False
    left, right, bottom, top = map_extent(grid, size, marks.shape)
    half = size * grid.resolution_m / 2
    x = np.linspace(left + half, right - half, marks.shape[1])
    y = np.linspace(bottom + half, top - half, marks.shape[0])
    for line, width in (("black", 2.2), (color, 1.1)):
        ax.contour(x, y, marks, levels=[0.5], colors=line, linewidths=width)
    return True


def inner(marks):
    """The marks whose four neighbours are marked."""
    padded = np.pad(marks, 1)
    return marks & padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:]


def notice(ax, text):
    """A sentence in place of a diagram."""
    ax.set_axis_off()
    ax.text(0.5, 0.5, text, transform=ax.transAxes, ha="center", va="center", wrap=True,
            bbox={"facecolor": "white", "edgecolor": "#808080", "boxstyle": "round"})


def draw_region(ax, radius_m, center_m=(0, 0)):
    """The circle of the mapped region, by default about the intended landing site."""
    ax.add_patch(Circle(center_m, radius_m, fill=False, edgecolor="black", linewidth=1.0, path_effects=OUTLINE))


def draw_region_edge(ax, grid, inside):
    """The border of a region of any shape."""
    if inside.any() and not inside.all():
        for color, width in (("white", 2.5), ("black", 1.0)):
            ax.contour(grid.x, grid.y, inside.astype(float), levels=[0.5], colors=color, linewidths=width)


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


def legend(ax, entries, columns=None):
    """A legend of filled patches, {label: colour}, below the map; in one row unless `columns` are given."""
    ax.legend(handles=[Patch(facecolor=c, edgecolor="#606060", label=t) for t, c in entries.items()],
              loc="upper center", bbox_to_anchor=(0.5, -0.13), ncol=columns or len(entries), frameon=False)
