# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws hazards.h5 made by hazard-map: safe places compared with the truth, slope, roughness, and the probability with
the landing sites; with a score, also the ROC curve and how reliable p_safe is."""
import dataclasses
import os

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from landfall import dictionary, files
from landfall.errors import DataError
from landfall.plot import captions, maps, plot_command, reduction, relief, scales

LAYERS = ["slope", "roughness", "safe", "p_safe", "p_touchdown", "cost", "outcome"]
MAX_LISTED = 6  # sites in the legend
# Sizes as shares of a square diagram: a point of its text, the width of a letter, the height of a line and the radius of a dot.
POINT, LETTER, LINE, DOT = 1 / 360, 0.0145, 0.026, 0.011
# {value: (name, colour)} of each layer. Marked values are few if the DEM is good, and are drawn on top of the judgement.
CLASSES = {layer: dict(sorted(dictionary.place_classes(layer).items())) for layer in ("safe", "outcome")}
HAZARD_COLOR, SAFE_COLOR = (CLASSES["safe"][value][1] for value in (0, 1))
JUDGED = {2: SAFE_COLOR, 3: HAZARD_COLOR}  # what the map said where it was wrong
MARKED = (3, 2)


def add_options(parser):
    parser.add_argument("--dem", metavar="DEM.h5", help="the DEM that was judged: its relief shades the first panel")
    plot_command.add_data_only_option(parser)


parse = plot_command.parser_of(__doc__, {"hazards": "HAZARDS"}, add_options)


class Hazards:
    """The contents of a hazards.h5; layers and a score that it does not have are None."""

    def __init__(self, path):
        self.name = os.path.basename(path)
        with files.open_landfall(path, "landfall.hazards") as file:
            self.grid = files.read_grid(file)
            self.layers = {name: files.read_layer(file, self.grid, name) for name in LAYERS}
            self.config = files.read_metrics(file, "provenance/config_json")
            self.score = files.read_metrics(file, "score_json") if "score_json" in file else None
            self.sites = files.Columns(file["sites"]) if "sites" in file else {}
        missing = [name for name in ("slope", "roughness", "safe", "p_touchdown") if self.layers[name] is None]
        if missing:
            raise DataError(f"{path}: needs the layer {missing[0]}")

    def inside(self):
        """The region: only there p_touchdown has values."""
        return ~np.isnan(self.layers["p_touchdown"])


def read_elevations(path, grid):
    """z_est of a DEM with the same bins."""
    with files.open_landfall(path, "landfall.dem") as file:
        own = files.read_grid(file)
        z = files.read_layer(file, own, "z_est")
    if z is None:
        raise DataError(f"{path}: needs the layers x, y and z_est")
    if own.shape != grid.shape or not (np.allclose(own.x, grid.x) and np.allclose(own.y, grid.y)):
        raise DataError(f"{path}: its bins are not those of the hazard map")
    return z


def frame(ax, hazards, title):
    maps.frame_map(ax, hazards.grid, title)
    radius_m = hazards.config.get("region_radius_m")
    if hazards.config.text("region/shape") in ("mask", "polygon"):
        maps.draw_region_edge(ax, hazards.grid, hazards.inside())
    elif radius_m is not None:
        maps.draw_region(ax, radius_m, hazards.config.get("region/center_m") or (0, 0))


# Safe places


def draw_safety(ax, hazards, z):
    """The outcome, or without truth the judgement, shaded by the relief; wrong places are marked on top."""
    name = "safe" if hazards.layers["outcome"] is None else "outcome"
    values, inside, classes = hazards.layers[name], hazards.inside(), CLASSES[name]
    frame(ax, hazards, "safe places compared with the truth" if name == "outcome" else "safe places (no truth to compare with)")
    size = maps.block_size(ax, values.shape)
    image = np.ones((*reduction.shrink_any(inside, size).shape, 3))
    for value, (_, color) in classes.items():
        share = reduction.shrink_share((values == value) & inside, size)
        image -= share[..., None] * (1 - np.array(to_rgb(JUDGED.get(value, color) if name == "outcome" else color)))
    maps.draw_image(ax, hazards.grid, image if z is None else shaded(hazards.grid, image, z, size), size, gid="classes")
    counts = {value: np.count_nonzero((values == value) & inside) for value in classes}
    how = {}
    for value in MARKED if name == "outcome" else ():
        if counts[value]:
            text, color = classes[value]
            manner = maps.draw_marks(ax, hazards.grid, (values == value) & inside, color, np.count_nonzero(inside), fill_few=True)
            how.setdefault(manner, []).append(text)
    total = np.count_nonzero(inside)
    maps.legend(ax, {f"{text}: {counts[value]:,} ({captions.percent(counts[value] / total if total else None)})": color
                     for value, (text, color) in classes.items()}, 2)
    maps.draw_scale_marks(ax)
    maps.note(ax, *(f"{', '.join(texts)}: {manner}" for manner, texts in how.items() if manner))


def shaded(grid, image, z, size):
    """Colours times the light on the relief; level terrain keeps its colour."""
    step_m = size * grid.resolution_m
    mean = reduction.shrink_mean(z, size)
    return np.clip(image * relief.light(mean, step_m, relief.factor(mean, step_m))[..., None], 0, 1)


# Slope, roughness, probability


def draw_limited(ax, hazards, name, base, limit_key, data_only):
    """A layer with a limit: the largest value of each block, and a line around the places over the limit."""
    values, limit = hazards.layers[name], hazards.config.get(limit_key)
    scale = dataclasses.replace(scales.magnitude_scale(values, maps.reduced(ax, values, reduction.shrink_max), limit, data_only), base=base)
    frame(ax, hazards, f"{name} under the lander")
    maps.draw_values(ax, hazards.grid, values, scale, name, reduction.shrink_max)
    over = limit is not None and maps.outline_flags(ax, hazards.grid, values > limit, "white")
    maps.draw_scale_marks(ax)
    maps.note(ax, *scale.notes(), maps.blocks_note(ax, values.shape), "white line: over the limit" if over else "")


def draw_probability(ax, hazards):
    """p_safe, or without it p_touchdown, with the landing sites and the circle in which they are looked for."""
    name = "p_touchdown" if hazards.layers["p_safe"] is None else "p_safe"
    values = hazards.layers[name]
    shown = maps.reduced(ax, values, reduction.shrink_min)
    scale = scales.Scale("magnitude", 0.0, 1.0, scales.extremes(values), scales.extremes(shown), "", base="")
    what = "probability that the place is safe" if name == "p_safe" else "share of touchdowns that meet places judged safe"
    frame(ax, hazards, f"{what}, and landing sites")
    maps.draw_values(ax, hazards.grid, values, scale, name, reduction.shrink_min)
    maps.draw_scale_marks(ax)
    maps.note(ax, scale.range_text(), maps.blocks_note(ax, values.shape, "smallest"))
    handles = [*draw_sites(ax, hazards), *draw_reach(ax, hazards)]
    ax.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncol=2, frameon=False, handletextpad=0.4,
              columnspacing=1, fontsize=maps.NOTE_PT + 1)


def draw_reach(ax, hazards):
    """The border of the places among which sites are looked for: the circle, or the end of the cost. Returns its entries in the legend."""
    radius_m, cost = hazards.config.get("sites/divert_radius_m"), hazards.layers["cost"]
    has_reach = hazards.config.get("sites/reach/height_m") is not None or hazards.config.get("sites/reach") is not None
    if has_reach and cost is not None:
        maps.outline_flags(ax, hazards.grid, ~np.isnan(cost), "white")
        return [Line2D([], [], color="black", label="border of the places within reach")]
    if radius_m is None:
        return []
    ax.add_patch(Circle((0, 0), radius_m, fill=False, edgecolor="black", linewidth=1.4, linestyle="--", path_effects=maps.OUTLINE, gid="divert"))
    return [Line2D([], [], color="black", linestyle="--", label=f"divert radius {captions.metres(float(radius_m))}")]


def draw_sites(ax, hazards):
    """Numbers at the landing sites. Returns their entries in the legend."""
    sites, handles = hazards.sites, []
    count = len(sites.get("rank", ()))
    for row in range(count):
        rank, wrong = int(sites["rank"][row]), "true_safe" in sites and sites["true_safe"][row] == 0
        style = {"marker": "o", "markersize": 13, "markerfacecolor": "#ffb080" if wrong else "white", "markeredgecolor": "black"}
        place = float(sites["x"][row]), float(sites["y"][row])
        ax.plot(*place, linestyle="none", zorder=5 + (count - row) / count, gid="site", **style)
        ax.text(*place, str(rank), fontsize=maps.NOTE_PT, ha="center", va="center_baseline", zorder=5 + (count - row) / count)
        if row < MAX_LISTED:
            prefix = "≥ " if "p_capped" in sites and sites["p_capped"][row] and sites["p_touchdown"][row] >= sites["p_safe"][row] - 1e-6 else ""
            merit = f"cost {sites['cost'][row]:.4f}" if hazards.layers["p_safe"] is None else f"p_touchdown {prefix}{sites['p_touchdown'][row]:.4f}"
            x_m, y_m = (round(axis, 2) + 0.0 for axis in place)  # no -0.00
            text = f"({x_m:.2f}, {y_m:.2f}) m, {merit}" + (", true hazard" if wrong else "")
            handles.append(Line2D([], [], linestyle="none", label=f"{rank}: {text}", **{**style, "markersize": 8}))
    if count > MAX_LISTED:
        handles.append(Line2D([], [], linestyle="none", label=f"and {count - MAX_LISTED} more sites"))
    return handles or [Line2D([], [], linestyle="none", label="no landing site")]


# Score


def percents(score, path):
    return 100 * np.asarray(score.get(path) or [], float)  # null is NaN


def draw_roc(ax, hazards):
    """Missed hazards against false alarms, a point for each roughness limit of the map."""
    missed, alarms = percents(hazards.score, "roc/missed_hazard_frac"), percents(hazards.score, "roc/false_alarm_frac")
    limits = percents(hazards.score, "roc/roughness_limit_m") / 100
    ax.set(title="ROC: other roughness limits of the map", xlabel="false alarms (% of the truly safe places)",
           ylabel="missed hazards (% of the true hazards)")
    ax.set_box_aspect(1)
    known = ~np.isnan(missed + alarms)
    if not known.any():
        maps.notice(ax, "the truth has no hazard, or no safe place")
        return
    missed, alarms, limits = missed[known], alarms[known], limits[known]
    ax.plot(alarms, missed, color=maps.BLUE, marker="o", markersize=5, linewidth=1, gid="roc", label="other limits")
    set_percent_axes(ax, alarms, missed)
    limit = hazards.config.get("limits/roughness_m")
    at = None if limit is None else int(np.argmin(np.abs(limits - limit)))
    if at is not None and np.isclose(limits[at], limit):
        ax.plot(alarms[at], missed[at], linestyle="none", marker="o", markersize=10, color=maps.VERMILION, gid="limit",
                label=f"limit {captions.metres(float(limit))}: {missed[at]:.3g} % missed,\n{alarms[at]:.3g} % false alarms")
    label_limits(ax, alarms, missed, limits)
    ax.legend(loc="upper right", fontsize=maps.NOTE_PT, framealpha=0.9)


def set_percent_axes(ax, alarms, missed):
    """Logarithmic, because good maps are near 0 in both, but with 0 on them."""
    for name, values in (("x", alarms), ("y", missed)):
        minimum = np.min(values[values > 0], initial=1)
        threshold = 10.0 ** np.floor(np.log10(minimum))
        getattr(ax, f"set_{name}scale")("symlog", linthresh=threshold, linscale=0.5)
        getattr(ax, f"set_{name}lim")(-0.2 * threshold, 400)
        axis = getattr(ax, f"{name}axis")
        axis.set_ticks([0, *10.0 ** np.arange(np.log10(threshold), 2.1)])
        axis.set_major_formatter(lambda value, _: f"{value:g}")
    ax.grid(True, color="#e0e0e0", linewidth=0.6)
    ax.set_axisbelow(True)


def label_limits(ax, alarms, missed, limits):
    """The limit next to each point, and one label for points at one place."""
    places = shares_of(ax, alarms, missed)
    same = [limits[np.hypot(*(places - at).T) < 0.01] for at in places]
    texts = [captions.metre_range(each[0], each[-1]) if each.size > 1 else captions.metres(float(each[0])) for each in same]
    firsts = [number for number, text in enumerate(texts) if text not in texts[:number]]
    around = [((dx, dy), "left" if dx > 0 else "right", "bottom" if dy > 0 else "top") for dx, dy in ((5, 5), (-5, 5), (5, -5), (-5, -5))]
    label_points(ax, alarms[firsts], missed[firsts], [texts[number] for number in firsts], lambda x, y: around, "roc label")


def shares_of(ax, x, y):
    """Places of points as shares of the diagram."""
    return ax.transAxes.inverted().transform(ax.transData.transform(np.column_stack((x, y))))


def label_points(ax, x, y, texts, around, gid):
    """A text next to each point, at the first of the places around(x, y), which are (offset in points, ha, va), where it meets no other text, no
    other point and no edge; no text where each place does."""
    dots, labelled = shares_of(ax, x, y), []
    for number, (at, text) in enumerate(zip(dots, texts)):
        others = np.delete(dots, number, axis=0)
        taken = [*labelled, *np.hstack((others - DOT, others + DOT)), (-1, -1, 0, 2), (1, -1, 2, 2), (-1, -1, 2, 0), (-1, 1, 2, 2)]
        for offset, ha, va in around(x[number], y[number]):
            size = np.array((LETTER * len(text), LINE))
            corner = at + POINT * np.array(offset) - size * ({"left": 0, "center": 0.5, "right": 1}[ha], {"bottom": 0, "center": 0.5, "top": 1}[va])
            box = (*corner, *(corner + size))
            if not any(box[0] < other[2] and other[0] < box[2] and box[1] < other[3] and other[1] < box[3] for other in taken):
                labelled.append(box)
                ax.annotate(text, (x[number], y[number]), offset, textcoords="offset points", ha=ha, va=va, fontsize=maps.NOTE_PT, gid=gid,
                            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6})
                break


def draw_reliability(ax, hazards):
    """The share of truly safe places among those with nearly equal p_safe."""
    brier = hazards.score.get("brier")
    ax.set(title="reliability of p_safe" + ("" if brier is None else f": Brier score {brier:.3g}"), xlabel="p_safe, middle of each class",
           ylabel="share of truly safe places", xlim=(-0.02, 1.02), ylim=(-0.02, 1.08))
    ax.set_box_aspect(1)
    low, high, count, share = (np.asarray(hazards.score.get(f"reliability/{key}") or [], float)
                               for key in ("p_low", "p_high", "count", "safe_frac"))
    known = ~np.isnan(share)
    if not known.any():
        maps.notice(ax, "this map has no p_safe (regrid --uncertainty, or z_sigma_m)")
        return
    middle, share, count = ((low + high) / 2)[known], share[known], count[known]
    ax.plot([0, 1], [0, 1], color="black", linewidth=1, label="perfectly calibrated")
    ax.plot(middle, share, color=maps.BLUE, marker="o", linewidth=1, gid="reliability", label="found; number of places")
    above, right, below, left = ((0, 7), "center", "bottom"), ((7, -2), "left", "center"), ((0, -7), "center", "top"), ((-7, 2), "right", "center")
    corners = [((-3, 7), "left", "bottom"), ((3, -7), "right", "top")]
    label_points(ax, middle, share, [f"{places:,.0f}" for places in count],
                 lambda x, y: [above, left, right, below, *corners] if y > x else [right, below, *corners, left, above], "count")
    ax.grid(True, color="#e0e0e0", linewidth=0.6)
    ax.legend(loc="lower right" if np.max(share[middle < 0.5], initial=0) > 0.85 else "upper left", fontsize=maps.NOTE_PT)


def draw(hazards, z=None, data_only=False):
    scored = hazards.score is not None
    grid, places = hazards.grid, np.count_nonzero(hazards.inside())
    title = f"{hazards.name}: {places:,} places, bins of {captions.metres(grid.resolution_m)}"
    figure, axes = maps.new_figure((3 if scored else 2, 2), (14, 20.5 if scored else 14.4), title)
    draw_safety(axes[0, 0], hazards, z)
    draw_probability(axes[0, 1], hazards)
    draw_limited(axes[1, 0], hazards, "slope", "deg", "limits/slope_deg", data_only)
    draw_limited(axes[1, 1], hazards, "roughness", "m", "limits/roughness_m", data_only)
    if scored:
        draw_roc(axes[2, 0], hazards)
        draw_reliability(axes[2, 1], hazards)
    return figure


def figure_of(options):
    hazards = Hazards(options.hazards)
    z = None if options.dem is None else read_elevations(options.dem, hazards.grid)
    return draw(hazards, z, options.data_only)


main = plot_command.main_of(parse, figure_of)
