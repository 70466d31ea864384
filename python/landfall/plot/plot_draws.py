# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws draws.h5 made by monte-carlo: where bins are empty and footprints fail, the errors over the draws, the predicted
against the observed spread where the file has both, and the distribution of what decides each requirement.

A file without maps gives the distributions only.
"""
import json
import math
import os
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import LogNorm

from landfall import dictionary, files
from landfall.errors import DataError
from landfall.plot import captions, maps, plot_command, reduction, relief, scales

LAYERS = ["p_invalid", "p_missed_hazard", "p_judged_safe", "p_fail_rel_x", "p_fail_rel_y", "p_fail_rel_z", "p_fail_absolute", "e_z_mean", "e_z_std", "e_map_std", "z_sigma_abs",
          "e_map_std_over_sigma", "z_true_map", "in_region"]
TERRAIN_COLOR = "#f4f1ea"  # where a probability is 0
CLASSES = 30


parse = plot_command.parser_of(__doc__, {"draws": "DRAWS"})


class Draws:
    """The contents of a draws.h5; layers that it does not have are None."""

    def __init__(self, path):
        self.name = os.path.basename(path)
        with files.open_landfall(path, "landfall.draws") as file:
            self.grid = files.read_grid(file) if "x" in file else None
            self.layers = {name: files.read_layer(file, self.grid, name) for name in LAYERS}
            self.columns = files.Columns(file["draws"])
            self.verdict = json.loads(files.text(file["verdict_json"][()])) if "verdict_json" in file else {}
            self.config = files.read_metrics(file, "provenance/config_json")
        if self.grid is not None and self.layers["in_region"] is None:
            raise DataError(f"{path}: needs the layer in_region")

    def count(self):
        return self.columns["pass"].size

    def has_hazards(self):
        return self.layers["p_missed_hazard"] is not None


# Maps


def light_of(draws, size):
    """The shading of the true terrain in blocks of bins; 1 where the terrain varies from draw to draw."""
    truth = draws.layers["z_true_map"]
    if truth is None:
        return np.ones(reduction.shrink_mean(draws.layers["in_region"].astype(float), size).shape)
    mean, step_m = reduction.shrink_mean(truth, size), size * draws.grid.resolution_m
    return relief.light(mean, step_m, relief.factor(mean, step_m))


def draw_shaded_probability(ax, draws, values, title, quantity):
    """A probability, the largest value of each block; where it is 0, the shaded terrain. Elsewhere slopes may darken its colour only a
    little, so that it can be compared with the colour bar."""
    grid = draws.grid
    maps.frame_map(ax, grid, title)
    size = maps.block_size(ax, values.shape)
    shown = reduction.shrink_max(values, size)
    span = scales.extremes(shown)
    scale = scales.Scale("magnitude", 0.0, span[1] if span[1] > 0 else 1.0, scales.extremes(values), span, "", base="")
    image = scales.color_map("magnitude")(np.nan_to_num(shown) / scale.high)[..., :3]
    image[shown == 0] = tuple(int(TERRAIN_COLOR[k:k + 2], 16) / 255 for k in (1, 3, 5))
    light = light_of(draws, size)
    light = np.where(shown > 0, np.clip(light, 0.85, 1), light)
    image = np.clip(image * np.nan_to_num(light, nan=1)[..., None], 0, 1)
    image[np.isnan(shown)] = 200 / 255
    maps.draw_image(ax, grid, image, size, gid="shaded_probability")
    maps.draw_color_bar(ax, scale, quantity)
    largest = "no value" if np.isnan(span[1]) else "0 everywhere" if span[1] == 0 else f"at most {span[1]:.3g}"
    finish(ax, draws, largest, maps.blocks_note(ax, values.shape))


def finish(ax, draws, *notes):
    radius_m = draws.config.get("eval/region_radius_m")
    if draws.config.text("eval/region/shape") in ("square", "mask", "polygon"):
        maps.draw_region_edge(ax, draws.grid, draws.layers["in_region"] != 0)
    elif radius_m is not None:
        maps.draw_region(ax, radius_m, draws.config.get("eval/region/center_m") or (0, 0))
    maps.draw_scale_marks(ax)
    maps.note(ax, *notes)


def draw_layer(ax, draws, name, title, scale_of, shrink, rule):
    values = draws.layers[name]
    scale = scale_of(values, maps.reduced(ax, values, shrink))
    maps.frame_map(ax, draws.grid, title)
    maps.draw_values(ax, draws.grid, values, scale, name, shrink)
    finish(ax, draws, *scale.notes(), maps.blocks_note(ax, values.shape, rule))


def draw_prediction(ax, draws):
    """Number of bins by predicted and observed spread, both logarithmic."""
    predicted, observed = draws.layers["z_sigma_abs"], draws.layers["e_map_std"]
    known = (predicted > 0) & (observed > 0)
    ax.set(title="spread of the map's error: observed against predicted", xlabel="predicted: z_sigma_abs (m)", ylabel="observed: e_map_std (m)")
    ax.set_box_aspect(1)
    if not known.any():
        maps.notice(ax, "no bin has both")
        return
    x, y = predicted[known], observed[known]
    low, high = np.quantile(np.concatenate((x, y)), (0.001, 0.999)) * (0.9, 1.1)
    edges = np.geomspace(low, high, 121)
    counts = np.histogram2d(x, y, (edges, edges))[0].T
    ax.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high))
    ax.pcolormesh(edges, edges, np.where(counts > 0, counts, np.nan), cmap=scales.color_map("count"), norm=LogNorm(1, max(counts.max(), 2)), gid="bins")
    ax.plot([low, high], [low, high], color="black", linewidth=1, label="as predicted")
    ax.legend(loc="upper left", fontsize=maps.NOTE_PT)
    median = np.median(y / x)
    maps.note(ax, f"median of observed / predicted {median:.3f}", f"{np.count_nonzero(known):,} bins; darker: more")


def draw_terrain(ax, draws):
    """The shaded terrain in grey."""
    size = maps.block_size(ax, draws.layers["in_region"].shape)
    light = np.nan_to_num(light_of(draws, size), nan=1)
    maps.draw_image(ax, draws.grid, np.repeat(np.clip(0.95 * light, 0, 1)[..., None], 3, axis=-1), size, gid="ground")


def draw_chosen(ax, draws):
    """The best site of each draw over the shaded terrain."""
    maps.frame_map(ax, draws.grid, "chosen place of each draw")
    draw_terrain(ax, draws)
    x, y, safe = (draws.columns[f"site.{name}"] for name in ("x_m", "y_m", "true_safe"))
    for shown, color, marker, label in ((safe == 1, maps.BLUE, "o", "safe"), (safe == 0, maps.VERMILION, "X", "a hazard")):
        if shown.any():
            ax.scatter(x[shown], y[shown], s=28, color=color, marker=marker, alpha=0.6, linewidths=0, label=f"truly {label}: {np.count_nonzero(shown)}")
    rate = draws.verdict["hazard"]["chosen_place_safe"]
    bound = most_text(rate) or f"probability at least {rate['exact_lower_bound']:.4f} (95 %)"
    finish(ax, draws, f"truly safe in {rate['passed']} of {rate['draws']} draws: {bound}")
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="upper right", fontsize=maps.NOTE_PT)


# Distributions


def edges_of(values, limit, is_whole):
    """Edges of equally wide classes, between whole numbers for counts. Bars are wide enough to be seen next to a limit that is shown."""
    low, high = float(values.min()), float(values.max())
    minimum = max(abs(low - limit), abs(high - limit), abs(limit) / 2) / 100 if is_shown(limit, values) else 0
    minimum = minimum or abs(high) / 100 or 1e-6
    if is_whole:
        width = max(1.0, np.ceil(max((high - low + 1) / CLASSES, minimum)))
        return low - 0.5 + width * np.arange(np.ceil((high - low + 1) / width) + 1)
    width = max((high - low) / CLASSES * (1 + 1e-9), minimum)
    count = max(1.0, np.ceil((high - low) / width))
    return (low + high - count * width) / 2 + width * np.arange(count + 1)


def is_shown(limit, values):
    """Whether a diagram of the values reaches their limit, as scales of errors do."""
    return limit <= scales.LIMIT_NEAR * max(float(values.max()), 0)


@dataclass(frozen=True)
class Shown:
    """The numbers that show a requirement: its values in the draws, its limit and the name of what is measured, with a unit."""

    values: np.ndarray
    limit: float
    measured: str
    bound: str = "at most"
    is_whole: bool = False

    def limit_text(self):
        unit = next((f" {unit}" for unit in ("%", "cm") if self.measured.endswith(f"({unit})")), "")
        return f"limit: {self.bound} {self.limit:g}{unit}"


def own_shown(draws, path):
    """A requirement of the user by the metric that it names."""
    own = draws.config.get(("hazard" if path.startswith("score.") else "eval") + "/requirements")
    bound = "at least" if draws.columns[path + ".at_least"][0] == 1 else "at most"
    measured = next(each["metric"] for each in own if each["name"] == path.rpartition(".")[2])
    return Shown(draws.columns[path + ".value"], draws.columns[path + ".limit"][0], measured, bound)


def shown_by(draws, name):
    """As the report does: a requirement on lengths by the largest one, because a count of 0 footprints over the limit shows no margin; others by
    their values. The lengths are missing where draws keep the counts only or the limit varies."""
    path = dictionary.own_paths(draws.columns).get(name)
    if path:
        return own_shown(draws, path)
    requirement = dictionary.requirements()[name]
    limit = draws.config.get(f"eval/limits/{requirement.worst_limit}")
    if requirement.worst_limit.endswith("_m") and limit is not None and f"eval.limits.{requirement.worst_limit}" not in draws.columns \
            and all(metric in draws.columns for metric in requirement.worst):
        what = "95th percentile of the footprints" if requirement.worst[0].endswith("p95_m") else "worst footprint"
        return Shown(100 * np.fmax.reduce([draws.columns[metric] for metric in requirement.worst]), 100 * limit, f"{what} (cm)")
    value, limit = (draws.columns[f"requirements.{name}.{key}"] for key in ("value", "limit"))
    return Shown(requirement.factor * value, requirement.factor * limit[0], requirement.measured_in, requirement.bound, is_whole=requirement.is_whole)


def draw_distribution(ax, draws, name):
    shown = shown_by(draws, name)
    known = ~np.isnan(shown.values)
    ax.set(title=name, xlabel=shown.measured, ylabel="draws")
    if not known.any():
        maps.notice(ax, "not judged: the footprint has too few bins" if name in dictionary.requirements() else "no draw has this number")
        return
    path = dictionary.own_paths(draws.columns).get(name, f"requirements.{name}")
    values, limit, passed = shown.values[known], shown.limit, draws.columns[f"{path}.pass"][known] == 1
    edges = edges_of(values, limit, shown.is_whole)
    ax.hist([values[passed], values[~passed]], edges, stacked=True, color=[maps.BLUE, maps.VERMILION], label=["passed", "failed"])
    end = limit + (0 if not shown.is_whole else 0.5 if shown.bound == "at most" else -0.5)  # whole numbers that are equal to the limit pass
    ends = [edges[0], edges[-1], *([end] if is_shown(limit, values) else [])]
    room = edges[1] - edges[0] if len(edges) == 2 else 0.04 * (max(ends) - min(ends))  # a single bar would fill the axes
    ax.set_xlim(min(ends) - room, max(ends) + room)
    label = shown.limit_text()
    if is_shown(limit, values):
        ax.axvline(end, color="black", linestyle="--", label=label, gid="limit")
    else:
        ax.plot([], [], " ", label=f"{label} (beyond this diagram)")
    ax.yaxis.get_major_locator().set_params(integer=True)
    maps.note(ax, rate_text(draws, name))
    ax.legend(fontsize=maps.NOTE_PT)


def rate_text(draws, name):
    rate = next((rate for rate in draws.verdict.get("rates", []) if rate["requirement"] == name), None)
    if rate is None:
        return ""
    if rate.get("judged", rate["draws"]) == 0:
        return "not judged: the footprint has too few bins"
    text = f"{rate['passed']} of {rate['draws']} pass"
    if "sprt" in draws.verdict:
        return text
    bounds = most_text(rate) or f"{rate['wilson_low']:.4f} to {rate['wilson_high']:.4f} (Wilson, 95 %), at least {rate['exact_lower_bound']:.4f}"
    return f"{text}: {bounds}"


def most_text(rate):
    """The upper bound of a probability where no draw passes; empty elsewhere. A lower bound of 0 says nothing."""
    return "" if rate["passed"] else f"probability at most {rate['wilson_high']:.4f} (Wilson, 95 %)"


def draw(draws):
    """The figure: up to three rows of maps, and two of distributions."""
    names = [*dictionary.requirements(), *dictionary.own_paths(draws.columns)]
    histograms = math.ceil(len(names) / 3)
    rows = histograms + (0 if draws.grid is None else 3 if draws.has_hazards() else 2)
    title = f"{draws.name}: {captions.counted(draws.count(), 'draw')}; {rate_text(draws, 'all' if len(names) == 6 else 'all_and_own')}"
    figure, axes = maps.new_figure((rows, 3), (19, 5.2 * rows), title)
    if draws.grid is not None:
        layers, share = draws.layers, "share of the draws"
        draw_shaded_probability(axes[0, 0], draws, layers["p_invalid"], "empty bin", share)
        draw_shaded_probability(axes[0, 1], draws, layers["p_fail_rel_z"], "footprint fails: relative z", share)
        draw_shaded_probability(axes[0, 2], draws, np.fmax(layers["p_fail_rel_x"], layers["p_fail_rel_y"]), "footprint fails: relative x or y, the likelier", share)
        draw_layer(axes[1, 0], draws, "e_z_std", "spread of e_z", scales.magnitude_scale, reduction.shrink_max, "largest")
        if layers["z_sigma_abs"] is not None:
            draw_layer(axes[1, 1], draws, "e_map_std_over_sigma", "spread of the map's error, observed / predicted",
                       lambda values, shown: scales.count_scale(values, shown, "magnitude", minimum=1.0), reduction.shrink_mean, "mean")
            draw_prediction(axes[1, 2], draws)
        else:
            if layers["e_map_std"] is None:
                maps.notice(axes[1, 1], "the terrain varies: no spread of the map's error")
            else:
                draw_layer(axes[1, 1], draws, "e_map_std", "spread of the map's error", scales.magnitude_scale, reduction.shrink_max, "largest")
            draw_layer(axes[1, 2], draws, "e_z_mean", "mean of e_z", scales.error_scale, reduction.shrink_extreme, "largest")
        if draws.has_hazards():
            draw_shaded_probability(axes[2, 0], draws, layers["p_missed_hazard"], "missed hazard", share)
            draw_shaded_probability(axes[2, 1], draws, layers["p_judged_safe"], "judged safe", share)
            draw_chosen(axes[2, 2], draws)
    places = list(axes[rows - histograms:].flat)
    for name, ax in zip(names, places):
        draw_distribution(ax, draws, name)
    for ax in places[len(names):]:
        ax.axis("off")
    return figure


def figure_of(options):
    return draw(Draws(options.draws))


main = plot_command.main_of(parse, figure_of)
