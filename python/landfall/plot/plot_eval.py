# SPDX-License-Identifier: GPL-3.0-or-later
# Failing footprints in a figure have a line around them where its blocks are at most 3 % of the map. Around scattered
# ones, lines would hide the map: they are vermilion, as in the report, by their share of each pixel.
"""Draws the results of dem-eval: elevation error, coverage, accuracy and the verdict, one figure each, and for a DEM
with 1-sigma maps, how well they predict the errors.

Files written with --metrics-only have no maps: only the coverage histogram and the verdict are drawn.
"""
import json
import os

import numpy as np

from landfall import command, dictionary, files
from landfall.errors import UsageError
from landfall.plot import captions, maps, plot_command, plot_dem, scales, scores, verdict_page

LAYERS = ["e_z", "abs_x", "abs_y", "abs_z", "rel_x", "rel_y", "rel_z", "invalid", "in_region", "fail"]
ZOOM_WIDTH_M = 6.0


def parse(arguments):
    parser = command.Parser(description=__doc__)
    parser.add_argument("evaluation", metavar="EVAL.h5")
    parser.add_argument("--dem", metavar="DEM.h5", help="also draw its true and estimated elevation")
    parser.add_argument("-o", "--output", metavar="DIR|PREFIX",
                        help="a folder, made if it does not exist, or the prefix of the figures' names, "
                             "which ends with - or _ (default: EVAL-)")
    parser.add_argument("--page", metavar="PDF", help="write this page instead: verdict, margins, assumptions, files and versions")
    plot_command.add_data_only_option(parser)
    plot_command.add_output_options(parser)
    options = parser.parse_args(arguments)
    options.output = options.output or os.path.splitext(options.evaluation)[0] + "-"
    if os.path.isdir(options.output) or not options.output.endswith(("-", "_")):
        options.output = os.path.join(options.output, "")
    if options.output.endswith(".png" + os.sep) and not os.path.isdir(options.output):
        raise UsageError(f"--output {options.output[:-1]}: several figures are written; name a folder")
    return options


class Evaluation:
    """The contents of an eval.h5; layers that it does not have are None."""

    def __init__(self, path, data_only=False):
        self.data_only = data_only
        with files.open_landfall(path, "landfall.evaluation") as file:
            self.name = os.path.basename(path)
            self.grid = files.read_grid(file)
            self.metrics = files.read_metrics(file)
            self.layers = {name: files.read_layer(file, self.grid, name) for name in LAYERS}
            self.limits = read_limits(file)
            self.verdict = files.read_verdict(file) or old_verdict(self.metrics)
        self.radius_m = self.metrics.get("region/radius_m")
        self.center_m = tuple(self.metrics.get(f"region/center_{axis}_m") or 0 for axis in "xy")
        self.half_width_m = self.metrics.get("region/half_width_m")
        bins = self.metrics.get("accuracy/footprint_bins")
        self.footprint_m = None if not bins or self.grid is None else (bins - 1) * self.grid.resolution_m

    def limit_m(self, layer):
        """The limit of a layer; None if it has none or the file does not say."""
        return self.limits.get(dictionary.layer_limit(layer))

    def has(self, *names):
        return all(self.layers[name] is not None for name in names)

    def inside(self):
        return self.layers["in_region"] != 0

    def failing(self, kind):
        """The bins in which the bit of the requirement is set; none in a file without the layer."""
        flags = self.layers["fail"]
        return np.zeros(self.grid.shape, bool) if flags is None else (flags & dictionary.fail_bit(kind.replace("rel_", "relative_"))) != 0


def read_limits(file):
    """{key: metres} of the limits in the configuration that made the file."""
    try:
        limits = json.loads(file["provenance/config_json"].asstr()[()])["limits"]
        return {key: float(value) for key, value in limits.items()}
    except (KeyError, ValueError, TypeError, AttributeError):
        return {}


def draw_region(ax, evaluation):
    if evaluation.radius_m is not None:
        maps.draw_region(ax, evaluation.radius_m, evaluation.center_m)
    elif evaluation.half_width_m is not None:
        maps.draw_rectangle(ax, (-evaluation.half_width_m,) * 2, (2 * evaluation.half_width_m,) * 2)
    elif evaluation.has("in_region"):
        maps.draw_region_edge(ax, evaluation.grid, evaluation.inside())


def finish_map(ax, evaluation):
    draw_region(ax, evaluation)
    maps.draw_scale_marks(ax, evaluation.footprint_m)


# Elevation error


SIGN = "true - estimated"


def scale_of(ax, evaluation, name, values):
    """The scale of an error layer in a panel: that of its kind along all axes, as in the report."""
    make, kind = scales.magnitude_scale if name.startswith("rel_") else scales.error_scale, name[:-1]
    axes = [] if kind == "e_" else [(maps.reduced(ax, evaluation.layers[kind + axis]), evaluation.limit_m(kind + axis)) for axis in "xyz"]
    return make(values, maps.reduced(ax, values), evaluation.limit_m(name), evaluation.data_only, axes)


def limit_of(name):
    return {"e": f" of rel_{name[-1]}", "abs": " of the horizontal error", "rel": ""}[name.split("_")[0]]


def draw_error(evaluation):
    grid, error = evaluation.grid, evaluation.layers["e_z"]
    inside = evaluation.inside()
    within = np.where(inside, error, np.nan)
    figure, axes = maps.new_figure((1, 3), (15, 5.5), f"{evaluation.name}: elevation error e_z = {SIGN}")
    scale = scale_of(axes[0, 0], evaluation, "e_z", within)
    maps.frame_map(axes[0, 0], grid, "e_z")
    maps.draw_values(axes[0, 0], grid, error, scale, SIGN)
    marked = maps.mark_missing(axes[0, 0], grid, error, "no value", inside)
    finish_map(axes[0, 0], evaluation)
    maps.note(axes[0, 0], f"in the region {scale.range_text()}", *scale.notes(limit_of("e_z"))[1:],
              maps.blocks_note(axes[0, 0], error.shape), marked)
    window = draw_error_zoom(axes[0, 1], evaluation, within)
    maps.draw_zoom_frame(axes[0, 0], window)
    draw_error_histogram(axes[0, 2], within, scale)
    return figure


def draw_error_zoom(ax, evaluation, within):
    """Every bin about the footprint of largest relative error, less that footprint's mean as in Eq. 12."""
    grid, rel, mean = evaluation.grid, evaluation.layers["rel_z"], evaluation.layers["abs_z"]
    center = maps.largest_bin(grid, rel)
    window, rows, cols = maps.zoom_window(grid, center, ZOOM_WIDTH_M)
    row, col = (int(np.argmin(np.abs(axis - at))) for axis, at in zip((grid.y, grid.x), center[::-1]))
    deviation = within[rows, cols] - float(mean[row, col])
    maps.frame_map(ax, window, "e_z - mean of the worst footprint")
    scale = scale_of(ax, evaluation, "e_z", deviation)
    maps.draw_values(ax, window, deviation, scale, "e_z - mean")
    maps.note(ax, *scale.notes(limit_of("e_z")))
    if evaluation.footprint_m is not None:
        maps.draw_footprint(ax, center, evaluation.footprint_m)
    maps.draw_scale_marks(ax)
    return window


def draw_error_histogram(ax, within, scale):
    """Counts of the whole range of the errors, with the limit."""
    values = within[~np.isnan(within)]
    ax.set_box_aspect(1)
    end = max(scale.high, *np.abs(scale.extremes)) if values.size else scale.high
    unit, factor = captions.length_unit(end)
    ax.set(title=f"{values.size:,} valid bins", xlabel=f"e_z = {SIGN} ({unit})", ylabel="bins")
    if values.size == 0:
        maps.notice(ax, "no valid bin")
        return
    counts, _, _ = ax.hist(values * factor, bins=101, range=(-end * factor, end * factor), color=maps.BLUE)
    for place, limit in enumerate(scale.limits()):
        ax.axvline(limit * factor, color=maps.VERMILION, linestyle="--", label=None if place else scale.limit_text(limit_of("e_z"))[2:])
    if scale.limits():
        ax.legend(loc="lower center", fontsize=maps.NOTE_PT, framealpha=0.9)
    maps.scale_counts(ax, counts.max())


# Coverage


def draw_coverage(evaluation):
    has_maps = evaluation.has("invalid", "in_region", "fail")
    detail = "" if has_maps else f"\n{invalid_text(evaluation.metrics)}; this file has no maps"
    title = f"{evaluation.name}: coverage of the region{detail}"
    figure, axes = maps.new_figure((1, 3) if has_maps else (1, 1), (14, 5.7) if has_maps else (7, 5.6), title)
    if has_maps:
        draw_mask(axes[0, 0], evaluation, invalid_text(evaluation.metrics), {"invalid": (evaluation.layers["invalid"] != 0, maps.BLUE)})
        draw_hole_map(axes[0, 1], evaluation)
    draw_hole_histogram(axes[0, -1], evaluation.metrics)
    return figure


def draw_mask(ax, evaluation, title, flags):
    """White inside the region, grey outside, and {label: (flags, colour)} on it."""
    maps.frame_map(ax, evaluation.grid, title)
    ax.set_facecolor("white")
    inside = evaluation.inside()
    maps.draw_outside(ax, evaluation.grid, inside)
    how = {name: maps.draw_marks(ax, evaluation.grid, bins, color, np.count_nonzero(inside))
           for name, (bins, color) in flags.items() if bins.any()}
    maps.legend(ax, {name: color for name, (_, color) in flags.items()})
    finish_map(ax, evaluation)
    maps.note(ax, *dict.fromkeys(how.values()))


def invalid_text(metrics):
    count, fraction = metrics.get("coverage/invalid_count"), metrics.get("coverage/invalid_frac")
    return f"{captions.counted(count, 'invalid bin')} ({captions.percent(fraction)})"


def draw_hole_map(ax, evaluation):
    holes = evaluation.metrics.get("coverage/holes_over_limit")
    far = evaluation.metrics.get("coverage/distance_over_limit_count")
    title = f"over the limits: {captions.counted(holes, 'hole')}, {captions.counted(far, 'distance')}"
    draw_mask(ax, evaluation, title, {"hole too large": (evaluation.failing("hole_size"), maps.SKY_BLUE),
                                      "too far from a valid bin": (evaluation.failing("hole_distance"), maps.VERMILION)})


def draw_hole_histogram(ax, metrics):
    sizes = metrics.get("coverage/hole_size_histogram/size_bins") or []
    counts = metrics.get("coverage/hole_size_histogram/count") or []
    largest, limit = metrics.get("coverage/largest_hole_bins"), metrics.get("requirements/hole_size/limit")
    ax.set_box_aspect(1)
    holes = captions.counted(metrics.get("coverage/hole_count"), "hole")
    ax.set(title=f"{holes}, largest {captions.counted(largest, 'bin')}",
           xlabel="hole size (bins, 8-connected)", ylabel="holes")
    if len(sizes) == 0 or len(sizes) != len(counts):
        maps.notice(ax, "no holes")
        return
    ax.bar(sizes, counts, width=0.8 if max(sizes) < 60 else 0.09 * np.asarray(sizes, float), color=maps.BLUE)
    maps.scale_counts(ax, max(counts))
    if max(sizes) >= 60:
        ax.set_xscale("log")
    if limit is not None:
        ax.axvline(limit + 0.5, color=maps.VERMILION, linestyle="--", label=f"limit {captions.counted(limit, 'bin')}")
        ax.legend(loc="upper right")


# Accuracy


def draw_accuracy(evaluation):
    title = f"{evaluation.name}: accuracy over the footprint centred on each bin, error = {SIGN}"
    figure, axes = maps.new_figure((2, 3), (15, 10.2), title)
    for column, axis in enumerate("xyz"):
        p95 = captions.metres(evaluation.metrics.get(f"accuracy/absolute/{axis}/p95_m"))
        draw_footprint_map(axes[0, column], evaluation, f"abs_{axis}", f"absolute {axis} (mean)\n95 % within {p95}")
        count, largest = (evaluation.metrics.get(f"accuracy/relative/{axis}/{key}") for key in ("violation_count", "max_m"))
        found = "not judged" if count is None else f"{captions.counted(count, 'violation')}, largest {captions.metres(largest)}"
        title = f"relative {axis}\n{found}"
        draw_footprint_map(axes[1, column], evaluation, f"rel_{axis}", title)
    return figure


def quantity_of(evaluation, name):
    """The quantity that the colours of a layer show, as in the report."""
    quantile = evaluation.metrics.get("accuracy/quantile")
    if name.startswith("abs"):
        return f"mean of {SIGN}"
    return "|e - mean|" + ("" if quantile is None else f", {100 * quantile:g} % quantile")


def mark_violations(ax, evaluation, name):
    """Marks footprints over the limit by a line or, where lines would hide the map, by a colour. Returns what it draws."""
    failing = evaluation.failing(name)
    if not failing.any():
        return ""
    if maps.outline_flags(ax, evaluation.grid, failing, "white"):
        return "white line: over the limit"
    return maps.marks_text("over the limit", maps.draw_marks(ax, evaluation.grid, failing, maps.VERMILION, 0), "vermilion")


def draw_footprint_map(ax, evaluation, name, title):
    values = evaluation.layers[name]
    scale = scale_of(ax, evaluation, name, values)
    maps.frame_map(ax, evaluation.grid, title)
    maps.draw_values(ax, evaluation.grid, values, scale, quantity_of(evaluation, name))
    missing = maps.mark_missing(ax, evaluation.grid, values, "no value", evaluation.inside()) if evaluation.has("in_region") else ""
    violations = mark_violations(ax, evaluation, name) if name.startswith("rel") else ""
    finish_map(ax, evaluation)
    maps.note(ax, *scale.notes(limit_of(name)), violations, missing)


# Verdict


VERDICT = {True: "pass", False: "FAIL", None: "not judged"}
VERDICT_COLOR = {"pass": "#cfe4f2", "FAIL": "#f6c9a8", "not judged": "#e8e8e8"}


def old_verdict(metrics):
    """The rows of a file that has no sentences: bare numbers."""
    def row(requirement):
        value, limit, passed = (metrics.get(f"requirements/{requirement.name}/{key}") for key in ("value", "limit", "pass"))
        return {"requirement": requirement.name, "measured": "–" if value is None else f"{requirement.measured}: {value:g}",
                "limit": "–" if limit is None else f"{requirement.bound} {limit:g}", "verdict": VERDICT[passed]}
    return [row(requirement) for requirement in dictionary.requirements().values()]


def overall(verdicts, has_elevations, reason=None):
    """The verdict on all requirements, as dem-eval's table gives it: FAIL where one that is judged is missed."""
    if "FAIL" in verdicts:
        return "FAIL"
    if "not judged" not in verdicts:
        return "pass"
    if reason == "footprint_bins":
        return "not judged, the footprint has too few bins"
    return "not judged, the DEM has no " + ("true positions" if has_elevations else "truth")


def draw_verdict(evaluation):
    reason = next(filter(None, (evaluation.metrics.text(f"requirements/{name}/reason") for name in dictionary.requirements())), None)
    text = overall([row["verdict"] for row in evaluation.verdict], evaluation.has("e_z"), reason)
    height = 3.4 + 0.33 * (len(evaluation.verdict) - len(dictionary.requirements()))  # more rows are the user's own requirements
    figure, axes = maps.new_figure((1, 1), (11, height), f"{evaluation.name}: {text}")
    ax = axes[0, 0]
    ax.axis("off")
    table = ax.table([list(row.values()) for row in evaluation.verdict], colLabels=list(evaluation.verdict[0]),
                     colWidths=[0.22, 0.5, 0.14, 0.14], cellLoc="left", loc="center")
    style_table(table, [row["verdict"] for row in evaluation.verdict])
    return figure


def style_table(table, verdicts):
    table.auto_set_font_size(False)
    table.set_fontsize(maps.FONT_PT + 1)
    table.scale(1, 1.75)
    for (row, column), cell in table.get_celld().items():
        cell.set_edgecolor("#b0b0b0")
        if row == 0:
            cell.set_text_props(weight="bold")
        elif column == 3:
            cell.set_facecolor(VERDICT_COLOR[verdicts[row - 1]])


def figures_of(evaluation):
    """{name: drawing function} of the figures for which the file has the layers."""
    chosen = {"verdict.png": draw_verdict, "coverage.png": draw_coverage}
    if evaluation.has("e_z", "abs_z", "rel_z", "in_region"):
        chosen["elevation_error.png"] = draw_error
    if evaluation.has("abs_x", "abs_y", "abs_z", "rel_x", "rel_y", "rel_z"):
        chosen["accuracy.png"] = draw_accuracy
    if evaluation.metrics.get("uncertainty/absolute/count") is not None:
        chosen["uncertainty.png"] = lambda e: scores.draw(e.name, e.metrics)
    return chosen


def main(arguments):
    options = parse(arguments)
    if options.page:
        verdict_page.write(options.evaluation, options.page, options.overwrite)
        return
    plot_command.use_dpi(options.dpi)
    evaluation = Evaluation(options.evaluation, options.data_only)
    chosen = figures_of(evaluation)
    dem_figure = [options.output + "dem.png"] if options.dem else []
    command.check_outputs([options.output + name for name in chosen] + dem_figure, options.overwrite,
                          makes_folder=options.output.endswith(os.sep))
    with files.drawing([options.evaluation, *([options.dem] if options.dem else [])]):
        figures = {options.output + name: draw(evaluation) for name, draw in chosen.items()}
        if options.dem:
            figures[dem_figure[0]] = draw_dem(options, evaluation)
        plot_command.save(figures, options.dpi)


def draw_dem(options, evaluation):
    """The figure of landfall plot dem, with this evaluation's region and footprint."""
    dem_options = plot_dem.parse([options.dem, "-o", options.output + "dem.png"])
    dem_options.draw_region = lambda ax: draw_region(ax, evaluation)
    dem_options.limit_m = evaluation.limit_m("e_z") or dem_options.limit_m
    dem_options.data_only = evaluation.data_only
    dem_options.footprint_m = evaluation.footprint_m or dem_options.footprint_m
    return plot_dem.figure_of(dem_options)
