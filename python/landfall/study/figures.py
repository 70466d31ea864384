# SPDX-License-Identifier: GPL-3.0-or-later
# An axis that has one value for each value of x is not a separate series of a figure: the parts of a zip are one line.
"""The figures of landfall plot study."""
import math
import textwrap

import matplotlib
import matplotlib.patheffects
import matplotlib.pyplot as plt
import numpy as np

from landfall.plot.scales import color_map
from landfall.study.names import digits_of, number, titled, with_unit
from landfall.study.table import BLIND_LANDING, error_sign, is_probability, metric_label, SAFE_LANDING, wilson

# Okabe and Ito's colours, which colour-blind readers can distinguish; markers distinguish the series in print.
COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000", "#999933"]
MARKERS = "osD^vP*X"
LIMIT_COLOR = "#7F0000"
# Frames of cells in which every case passes; the orange of COLORS means failed in all reports.
PASS_COLOR = "#009E73"
FRAME = [matplotlib.patheffects.withStroke(linewidth=3.5, foreground="white")]
MAX_SERIES = len(COLORS)
# A logarithmic axis of so many values has a tick at each.
MAX_TICKS = 12
# Least distance of their labels, as a share of the axis.
CLOSEST_LABELS = 0.06
# A limit so many times the largest value is named and not drawn.
FAR_LIMIT = 30
# Margins of a linear axis from 0, below and above: marks on its edge would be cut, and a legend takes no note of a mark's size.
MARGIN = 0.05
# Columns and rows of a map whose cells have room for a number; maps of more do not grow.
WIDEST_MAP, TALLEST_MAP = 24, 30
# Limits of the overview: panels, and letters of a line of a panel's label.
MAX_PANELS, WIDEST_LABEL = 6, 36


class Scale:
    """How a metric is shown: metres as cm or mm where these suit."""

    def __init__(self, results, metric):
        self.unit, self.factor = results.units[metric], 1
        self.name, self.bound = metric_label(metric, self.unit), results.bound(metric)
        largest = largest_value(results, metric)
        if self.unit == "m" and 0 < largest < 0.5:
            self.unit, self.factor = ("cm", 100) if largest >= 0.01 else ("mm", 1000)

    def title(self):
        return titled(self.name, self.unit)

    def requirement(self, metric, limit):
        of_all = " of every footprint" if metric.startswith("accuracy.relative.") and metric.endswith("p95_m") else ""
        value, unit = limit * self.factor, self.unit
        if unit in ("cm", "mm") and limit >= 1:
            value, unit = limit, "m"
        return f"required{of_all}: {self.bound} {with_unit(value, unit)}"


def largest_value(results, metric):
    return max((abs(value) for point in results.points for value in results.values(point, metric)), default=0)


def point_name(axes, values):
    return ", ".join(f"{axis.label} {with_unit(value, axis.unit, digits_of(axis.values))}" if axis.numeric else str(value)
                     for axis, value in zip(axes, values))


def estimate_name(results, quantile):
    if results.repeats() == 1:
        return ""
    name = "median" if quantile == 0.5 else f"{100 * quantile:g}th percentile"
    return f"{name} of {results.repeats()} repeats, 95 % interval (bootstrap)"


def interval_name(metrics):
    """The interval of probabilities that runs of draws estimate; else empty."""
    return "probabilities: share of the draws, 95 % interval (Wilson)" if any(map(is_probability, metrics)) else ""


# A metric against an axis


def metric_figure(results, metric, x, quantile):
    figure, axes = plt.subplots(figsize=(7.2, 4.6), constrained_layout=True)
    scale = Scale(results, metric)
    if x is None:
        draw_distribution(axes, results, metric, scale)
    else:
        draw_series(axes, results, metric, scale, x, quantile)
    notes = [interval_name([metric]) or (estimate_name(results, quantile) if x else ""), error_sign([metric])]
    axes.set_title("\n".join(filter(None, [results.title, *notes])), fontsize=10)
    axes.grid(True, color="0.9")
    return figure


def draw_distribution(axes, results, metric, scale):
    """A figure for a study that only repeats: the share of the repeats up to each value."""
    values = np.sort(results.values(results.points[0], metric)) * scale.factor
    axes.step(np.concatenate([values[:1], values]), np.linspace(0, 1, values.size + 1), where="post", color=COLORS[0])
    limit = results.limit(metric)
    if limit is not None and values.size:
        axes.axvline(limit * scale.factor, color=LIMIT_COLOR, linestyle="--", label=scale.requirement(metric, limit))
        axes.legend(frameon=False)
    axes.set(xlabel=scale.title(), ylabel=f"share of {values.size} repeats")


def series_along(results, x):
    """(the other axes, [(their values, [(place along x, point)])] in the order of the cases)."""
    column = results.axes.index(x)
    others = [axis for axis in results.axes if axis is not x and not results.follows(axis, x)]
    places = [results.axes.index(axis) for axis in others]
    series = {}
    for point in results.points:
        series.setdefault(tuple(point.values[at] for at in places), []).append(point)
    place = {value: value if x.numeric else index for index, value in enumerate(x.values)}
    return others, [(key, sorted(((place[point.values[column]], point) for point in points), key=lambda entry: entry[0])) for key, points in series.items()]


def draw_series(axes, results, metric, scale, x, quantile):
    others, series = series_along(results, x)
    shown = series if len(series) <= MAX_SERIES else spread(series, MAX_SERIES)
    for index, (key, placed) in enumerate(shown):
        if not x.numeric:  # side by side
            placed = [(at + 0.08 * (index - (len(shown) - 1) / 2), point) for at, point in placed]
        draw_line(axes, results, metric, scale, placed, quantile, index, point_name(others, key), x.numeric)
    if len(shown) <= 3:
        show_all(axes, len(shown))
    draw_limit(axes, results, metric, scale)
    finish_x(axes, x)
    finish_y(axes, results, metric, scale)
    if others:
        title = f"{len(shown)} of {len(series)} series" if len(shown) < len(series) else None
        axes.legend(frameon=False, fontsize=8, title=title, bbox_to_anchor=(1.01, 1), loc="upper left")
    elif results.limit(metric) is not None:
        axes.legend(frameon=False, fontsize=8)


def show_all(axes, count):
    """Earlier series wider than later ones, so that one under another of the same values is still seen."""
    for below, line in enumerate(reversed([line for line in axes.get_lines() if line.get_label()[:1] != "_"][:count])):
        line.set_markersize(5 + 3 * below)
        line.set_linewidth(1.4 + 1.6 * below)


def spread(items, count):
    """`count` entries from first to last."""
    return [items[round(i * (len(items) - 1) / (count - 1))] for i in range(count)]


def draw_line(axes, results, metric, scale, placed, quantile, index, label, joined, color=None, estimates=None):
    """One series: estimates with their intervals, and faint dots for the repeats. Points of an axis without numbers are not joined."""
    at = [position for position, _ in placed]
    estimates = np.array(estimates or [results.estimate(point, metric, quantile) for _, point in placed]) * scale.factor
    style = {"color": color or COLORS[index % len(COLORS)], "marker": MARKERS[index % len(MARKERS)], "markersize": 5}
    axes.plot(at, estimates[:, 0], linestyle="-" if joined else "none", linewidth=1.4, label=label or None, **style)
    if np.isfinite(estimates[:, 1]).any():
        if joined:
            axes.fill_between(at, estimates[:, 1], estimates[:, 2], color=style["color"], alpha=0.2, linewidth=0)
        else:
            axes.vlines(at, estimates[:, 1], estimates[:, 2], color=style["color"], linewidth=2, alpha=0.5)
    for position, point in placed if results.repeats() <= 200 else []:
        values = results.values(point, metric) * scale.factor
        if values.size > 1:
            axes.plot(np.full(values.size, position), values, ".", color=style["color"], markersize=3, alpha=0.4)


def draw_limit(axes, results, metric, scale):
    """A dashed line; where it would flatten what is measured, only its name."""
    limit = results.limit(metric)
    if limit is None:
        return
    largest = largest_value(results, metric)
    if 0 < largest < limit / FAR_LIMIT:
        axes.plot([], [], " ", label=scale.requirement(metric, limit) + " (far above)")
    else:
        axes.axhline(limit * scale.factor, color=LIMIT_COLOR, linestyle="--", linewidth=1.2,
                     label=scale.requirement(metric, limit))


def finish_x(axes, x):
    axes.set_xlabel(titled(x.label, x.unit))
    if not x.numeric:
        axes.set_xlim(-0.5, len(x.values) - 0.5)
        axes.set_xticks(range(len(x.values)), x.values, rotation=0 if sum(map(len, x.values)) < 60 else 30,
                        ha="center" if sum(map(len, x.values)) < 60 else "right")
    elif x.log and min(x.values) > 0:
        axes.set_xscale("log")
        if len(x.values) <= MAX_TICKS:
            axes.set_xticks(sorted(x.values), tick_labels(sorted(x.values)))
            axes.minorticks_off()


def tick_labels(values):
    """Labels of ascending values on a logarithmic axis: none where it would run into the one before."""
    labels, last = [], -math.inf
    for value in values:
        at = math.log(value) / (math.log(values[-1] / values[0]) or 1)
        shown = at - last >= CLOSEST_LABELS
        labels.append(number(value) if shown else "")
        last = at if shown else last
    return labels


def finish_y(axes, results, metric, scale):
    """Logarithmic where values differ by more than a hundred and half of them would be hard to read on a linear axis; linear near 0
    where that is among them or required."""
    values = np.concatenate([results.values(point, metric) for point in results.points]) * scale.factor
    axes.set_ylabel(scale.title())
    if is_probability(metric):
        axes.set_ylim(-MARGIN, 1 + MARGIN)
        return
    positive = values[values > 0]
    if values.size == 0 or values.min() < 0:
        return
    drawn = axes.dataLim.y1  # with the requirement and the intervals
    if positive.size == 0 or values.max() / positive.min() <= 100 or values.max() < 20 * np.median(values):
        top = (1 + MARGIN) * drawn or axes.get_ylim()[1]
        axes.set_ylim(-MARGIN * top, top)
    elif positive.size < values.size or results.limit(metric) == 0:
        axes.set_yscale("symlog", linthresh=positive.min())
        axes.set_ylim(-0.2 * positive.min(), 2 * max(positive.max(), drawn))
    else:
        axes.set_yscale("log")


# Landings with the lidar and without


def blind_together(results, series):
    """[(share, low, high)] of the safe landings without a lidar along x, the share of all series; None where the intervals of two series do not
    overlap, because then they differ in more than the lidar. The interval is that of one series: with the seeds of a study, all have the same terrains."""
    estimates = []
    if len({tuple(at for at, _ in placed) for _, placed in series}) > 1:
        return None
    for column in zip(*(placed for _, placed in series)):
        passed, draws, low, high = np.array([results.draws_rate(point, "landing.blind") for _, point in column], float).T
        if not np.max(low) <= np.min(high):
            return None
        share = passed.sum() / draws.sum()
        estimates.append((share, *wilson(share * draws.min(), draws.min())))
    return estimates


def landings_figure(results, x, quantile):
    """P(safe landing) of both arms against x; one line without a lidar where the series differ in the lidar alone. None for a study without landings."""
    if x is None or not {SAFE_LANDING, BLIND_LANDING} <= set(results.columns):
        return None
    figure, axes = plt.subplots(figsize=(7.2, 4.6), constrained_layout=True)
    scale = Scale(results, SAFE_LANDING)
    draw_series(axes, results, SAFE_LANDING, scale, x, quantile)
    others, series = series_along(results, x)
    together = blind_together(results, series)
    for index, (key, placed) in enumerate(series[:1] if together else series):
        name = "" if together else point_name(others, key)
        draw_line(axes, results, BLIND_LANDING, scale, placed, quantile, index, "without a lidar" + (f", {name}" if name else ""), x.numeric,
                  color=("0.35", "0.55", "0.7")[index % 3], estimates=together)
    axes.set_ylabel("probability of a safe landing")
    axes.set_title(f"{results.title}\n{interval_name([SAFE_LANDING])}", fontsize=10)
    axes.grid(True, color="0.9")
    if not others:
        axes.get_lines()[0].set_label("with the lidar")
    axes.legend(frameon=False, fontsize=8, bbox_to_anchor=(1.01, 1), loc="upper left")
    return figure


# A metric over two axes


def map_axes(results, x):
    """The two axes of a map: x and another numeric axis that is independent of x, if there is no third axis; else None."""
    numeric = [axis for axis in results.axes if axis.numeric and len(axis.values) > 1]
    if len(results.axes) != 2 or len(numeric) != 2 or x not in numeric or results.follows(numeric[0], numeric[1]):
        return None
    return x, next(axis for axis in numeric if axis is not x)


def map_figure(results, metric, pair, quantile):
    x, y = pair
    columns, rows = sorted(x.values), sorted(y.values)
    scale = Scale(results, metric)
    values = np.full((len(rows), len(columns)), np.nan)
    rates = {}
    order = [results.axes.index(x), results.axes.index(y)]
    for point in results.points:
        at = rows.index(point.values[order[1]]), columns.index(point.values[order[0]])
        values[at] = results.estimate(point, metric, quantile)[0] * scale.factor
        rates[at] = results.pass_rate(point, "all")
    wide, tall = min(max(5, len(columns)), WIDEST_MAP), min(max(4, len(rows)), TALLEST_MAP)
    figure, axes = plt.subplots(figsize=(2.6 + 0.75 * wide, 2.0 + 0.5 * tall), constrained_layout=True)
    limit = results.limit(metric)
    far = limit is None or limit * scale.factor > FAR_LIMIT * np.nanmax(values, initial=0)
    image = axes.imshow(values, origin="lower", aspect="auto", cmap=color_map("magnitude"), norm=map_norm(values, None if far else limit * scale.factor))
    is_flat = image.norm.vmin == image.norm.vmax
    if not is_flat:
        bar = figure.colorbar(image, ax=axes, label="\n".join(filter(None, [scale.title(), error_sign([metric])])))
        if not far:
            bar.ax.axhline(limit * scale.factor, color=LIMIT_COLOR, linewidth=2.5)
    if len(columns) <= WIDEST_MAP and len(rows) <= TALLEST_MAP:
        write_cells(axes, values, rates, image)
    else:
        frame_region(axes, values.shape, rates)
    axes.set_xticks(*map_ticks(columns, WIDEST_MAP))
    axes.set_yticks(*map_ticks(rows, TALLEST_MAP))
    axes.set(xlabel=titled(x.label, x.unit), ylabel=titled(y.label, y.unit))
    notes = [f"{scale.title()}: {number(image.norm.vmin)} everywhere" if is_flat else "", estimate_name(results, quantile).split(",")[0], scale.requirement(metric, limit) if limit is not None else "",
             "framed: every case passes all requirements"]
    axes.set_title(results.title + "\n" + "; ".join(note for note in notes if note), fontsize=9)
    return figure


def map_norm(values, limit):
    """From the least to the largest of the values and of the requirement."""
    finite = np.append(values[np.isfinite(values)], [] if limit is None else limit)
    if finite.size and finite.min() > 0 and finite.max() / finite.min() > 100:
        return matplotlib.colors.LogNorm(finite.min(), finite.max())
    return matplotlib.colors.Normalize(finite.min(), finite.max()) if finite.size else None


def map_ticks(values, max_count):
    """Places and labels; of many values every so many."""
    places = range(0, len(values), -(-len(values) // max_count))
    return places, [number(values[place]) for place in places]


def frame_region(axes, shape, rates):
    """The outline of the cells in which every case passes, where they are too small for a frame each."""
    passed = np.zeros((shape[0] + 2, shape[1] + 2))
    for (row, column), (met, count, _, _) in rates.items():
        passed[row + 1, column + 1] = count > 0 and met == count
    if passed.any():
        axes.contour(range(-1, shape[1] + 1), range(-1, shape[0] + 1), passed, [0.5], colors=PASS_COLOR, linewidths=1.5)
        axes.set(xlim=(-0.5, shape[1] - 0.5), ylim=(-0.5, shape[0] - 0.5))


def write_cells(axes, values, rates, image):
    for (row, column), value in np.ndenumerate(values):
        if math.isnan(value):
            axes.text(column, row, "–", ha="center", va="center", fontsize=8)
            continue
        dark = image.norm(value) < 0.5
        if values.size <= 400:
            axes.text(column, row, number(value), ha="center", va="center", fontsize=8, color="white" if dark else "black")
        passed, count, _, _ = rates[row, column]
        if count and passed == count:
            axes.add_patch(matplotlib.patches.Rectangle((column - 0.46, row - 0.46), 0.92, 0.92, fill=False,
                                                        edgecolor=PASS_COLOR, linewidth=2, path_effects=FRAME))


# Metrics side by side


def overview_figure(results, metrics, x, quantile):
    """A panel for each of the first six metrics; None for fewer than two metrics, and if x is not numeric, because its labels need the width."""
    shown = metrics[:MAX_PANELS]
    if x is None or not x.numeric or len(shown) < 2:
        return None
    rows = (len(shown) + 1) // 2
    figure, panels = plt.subplots(rows, 2, figsize=(10.4, 0.5 + 3.1 * rows), constrained_layout=True, squeeze=False)
    for index, (axes, metric) in enumerate(zip(panels.flat, shown)):
        draw_panel(axes, results, metric, x, quantile, with_series=index == 0)
    for axes in panels.flat[len(shown):]:
        axes.set_visible(False)
    notes = ["; ".join(filter(None, [estimate_name(results, quantile), interval_name(shown), error_sign(shown)]))]
    figure.suptitle("\n".join(filter(None, [results.title, *notes])), fontsize=11)
    return figure


def draw_panel(axes, results, metric, x, quantile, with_series):
    """One metric. The legend names the series in one panel only, the requirement in each that has one."""
    draw_series(axes, results, metric, Scale(results, metric), x, quantile)
    axes.grid(True, color="0.9")
    axes.xaxis.label.set_size(9)
    axes.set_ylabel(textwrap.fill(axes.get_ylabel(), WIDEST_LABEL), fontsize=9)
    axes.tick_params(labelsize=8)
    if axes.get_legend():
        axes.get_legend().remove()
    entries = [(handle, label) for handle, label in zip(*axes.get_legend_handles_labels())
               if with_series or label.startswith("required")]
    if entries:
        axes.legend(*zip(*entries), frameon=True, framealpha=0.8, edgecolor="none", fontsize=8)
