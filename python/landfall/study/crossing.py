# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D292
"""At which value of one metric another one exceeds a level: how large may an error be before more than 1 % of the hazards are missed?"""
import math
import statistics
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np

from landfall.study.figures import COLORS, LIMIT_COLOR, MARKERS, Scale, point_name
from landfall.study.names import number, with_unit

TICKS = [0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100]
HEAD = ["metric", "level", "against", "repeats", "median", "least", "largest"]


@dataclass(frozen=True)
class Crossing:
    """Over the repeats; -inf where the metric exceeds the level everywhere, inf where it does nowhere."""

    median: float
    minimum: float
    maximum: float


def crossing_of(curve, level):
    """The point at which a curve of (against, metric) first exceeds the level: linear between neighbours, -inf if its first value does, inf if none."""
    points = sorted(point for point in curve if all(map(math.isfinite, point)))
    if points and points[0][1] > level:
        return -math.inf
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if y1 > level:
            return x0 + (x1 - x0) * (level - y0) / (y1 - y0)
    return math.inf


def series_of(results, x):
    """{values of the axes other than x: its points}."""
    kept = [index for index, axis in enumerate(results.axes) if axis is not x]
    found = {}
    for point in results.points:
        found.setdefault(tuple(point.values[index] for index in kept), []).append(point)
    return found


def pairs_of(results, point, names):
    """A row for each repeat of a point, in order; NaN where a number is not known."""
    columns = [results.columns[name] for name in names]
    return np.array([[math.nan if column[row] is None else column[row] for column in columns] for row in point.rows], float)


def crossings_of(results, points, metric, spec):
    """The Crossing of one series."""
    repeats, curves = results.columns.get("repeat"), {}
    for point in points:
        for row, pair in zip(point.rows, pairs_of(results, point, (spec["against"], metric))):
            curves.setdefault(repeats[row] if repeats else 1, []).append(tuple(pair))
    values = sorted(crossing_of(curve, spec["level"]) for curve in curves.values())
    return Crossing(statistics.median_low(values), values[0], values[-1])


def rows(results, x, spec):
    """The columns of crossings.csv, after the values of the axes other than x."""
    made = []
    for metric in spec["metrics"]:
        for key, points in series_of(results, x).items():
            found = crossings_of(results, points, metric, spec)
            made.append([*key, metric, spec["level"], spec["against"], results.repeats(), found.median, found.minimum, found.maximum])
    return made


def crossing_figure(results, x, spec):
    """A panel for each metric, a line for each combination of the axes other than x."""
    metrics, across = spec["metrics"], Scale(results, spec["against"])
    figure, panels = plt.subplots(1, len(metrics), figsize=(0.6 + 5.2 * len(metrics), 5.2), sharey=True, constrained_layout=True, squeeze=False)
    for axes, metric in zip(panels[0], metrics):
        draw_panel(axes, results, x, spec, metric, across)
    panels[0][0].set_ylabel("share [%]")
    panels[0][0].set_yscale("symlog", linthresh=10 * spec["level"], linscale=0.5)
    panels[0][0].set_ylim(-2 * spec["level"], 1.4 * max(axes.dataLim.y1 for axes in panels[0]))
    low, high = panels[0][0].get_ylim()
    ticks = [tick for tick in TICKS if low <= tick <= high and (tick == 0 or tick >= 10 * spec["level"])]
    panels[0][0].set_yticks(ticks, map(number, ticks))
    panels[0][0].minorticks_off()
    repeats = results.repeats()
    note = f"lines: median of {repeats} repeats, small marks: each; dotted: where they exceed {number(100 * spec['level'])} %, median and range" \
        if repeats > 1 else f"dotted: where a line exceeds {number(100 * spec['level'])} %"
    figure.suptitle(f"{results.title}\n{note}", fontsize=10)
    return figure


def draw_panel(axes, results, x, spec, metric, across):
    others = [axis for axis in results.axes if axis is not x]
    level = spec["level"]
    for index, (key, points) in enumerate(series_of(results, x).items()):
        pairs = [pairs_of(results, point, (spec["against"], metric)) * (across.factor, 100) for point in points]
        found = crossings_of(results, points, metric, spec)
        style = {"color": COLORS[index % len(COLORS)], "marker": MARKERS[index % len(MARKERS)]}
        axes.plot(*np.array([np.median(repeats, axis=0) for repeats in pairs]).T, markersize=6, linewidth=1.5,
                  label=f"{point_name(others, key) or 'all'}: {crossing_text(found, across)}", **style)
        if results.repeats() > 1:
            axes.plot(*np.concatenate(pairs).T, linestyle="none", markersize=3, alpha=0.5, **style)
        if math.isfinite(found.median):
            axes.axvline(found.median * across.factor, color=style["color"], linestyle=":", linewidth=1.4)
        if math.isfinite(found.minimum) and math.isfinite(found.maximum):
            axes.axvspan(found.minimum * across.factor, found.maximum * across.factor, color=style["color"], alpha=0.12, linewidth=0)
    axes.axhline(100 * level, color=LIMIT_COLOR, linestyle="--", linewidth=1.2)
    axes.set_title(Scale(results, metric).name, fontsize=9)
    axes.set_xlabel(across.title(), fontsize=9)
    axes.grid(True, color="0.9")
    axes.legend(frameon=True, framealpha=0.9, edgecolor="none", fontsize=8)


def crossing_text(found, across):
    """ "3.2 cm (2.9 to 3.5)"."""
    if not math.isfinite(found.median):
        return "exceeds it everywhere" if found.median < 0 else "exceeds it nowhere"
    text = with_unit(found.median * across.factor, across.unit, 2)
    if found.minimum == found.maximum:
        return text
    return f"{text} ({bound(found.minimum, across)} to {bound(found.maximum, across)})"


def bound(value, across):
    return number(value * across.factor, 2) if math.isfinite(value) else "everywhere" if value < 0 else "nowhere"
