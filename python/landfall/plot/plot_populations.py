# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws how many rocks, ice blocks and craters of which size a terrain has, against the laws they were drawn from.

The laws are those of lib/chain/terrain/populations, implemented independently: N(>D) per square metre, D in metres.
"""
import json
from dataclasses import dataclass

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

from landfall import command, files
from landfall.errors import DataError, printable
from landfall.plot import captions, plot_command

STEPS_PER_DECADE = 12
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"]  # Okabe and Ito's, for colour-blind readers
MARKERS = "osD^v<"
POWER_LAWS = {
    "power_law_rocks": {"viper": (3e-4, 2.482), "low_blocky": (1e-4, 1.75457), "haworth": (2e-3, 2.6607)},
    "craters": {"trask": (10 ** -1.1, 2.0)},
}
# How far an object reaches from its centre, in diameters.
REACH = {"golombek_rocks": 0.5, "power_law_rocks": 0.5, "craters": 0.75,
         "ice_blocks": np.hypot(0.5, 0.4 * np.cos(np.radians(15)) + 0.75 * np.sin(np.radians(15)))}
SITE_SAMPLES = 1000


# Laws and samples


def golombek_k(pattern):
    """k of a pattern: given, or that of its area fraction by bisection."""
    if "k" in pattern:
        return pattern["k"]
    low, high = 1e-9, 1.0
    for _ in range(200):
        k = (low + high) / 2
        covered = k * np.exp(-(1.79 + 0.152 / k) * pattern["area_fraction_above_m"])
        low, high = (k, high) if covered < pattern["area_fraction"] else (low, k)
    return (low + high) / 2


def golombek_density(k, diameters):
    """The integral of 4 / (pi x^2) k q exp(-q x) from each diameter on, by trapezoids in log x."""
    q = 1.79 + 0.152 / k
    diameters = np.atleast_1d(np.asarray(diameters, float))
    x = diameters[:, None] * np.exp(np.linspace(0, np.log1p(60 / (q * diameters)), 4001).T)
    density = 4 * k * q / np.pi * np.exp(-q * x) / x
    return ((density[:, 1:] + density[:, :-1]) / 2 * np.diff(np.log(x), axis=1)).sum(axis=1)  # np.trapz is gone from numpy 2.4


def viper_crater_density(diameters):
    """N(>D): the upper power law from 80 m on; below, its value at 80 m plus the number of the lower law from D to 80 m."""
    d = np.asarray(diameters, float)
    lower = 29174e-6 * (np.minimum(d, 80) ** -1.92 - 80.0 ** -1.92)
    return lower + 156228e-6 * np.maximum(d, 80) ** -2.389


def density(pattern, diameters):
    """N(>D) of a pattern of a resolved configuration."""
    kind, model = pattern["type"], pattern.get("model")
    if kind in ("golombek_rocks", "ice_blocks"):
        return golombek_density(golombek_k(pattern), diameters)
    if kind == "craters" and model == "viper":
        return viper_crater_density(diameters)
    own = (pattern.get("coefficient"), pattern.get("exponent"))
    coefficient, exponent = POWER_LAWS[kind].get(model, own)
    return coefficient * np.asarray(diameters, float) ** -exponent


def poisson_mean_where(count, probability):
    """The mean for which a Poisson number is at most `count` with this probability."""
    low, high = 0.0, count + 10 * np.sqrt(count + 1) + 10
    for _ in range(60):
        mean = (low + high) / 2
        terms = np.concatenate([[1.0], np.cumprod(mean / np.arange(1, count + 1))])
        low, high = (mean, high) if np.exp(-mean) * terms.sum() > probability else (low, mean)
    return (low + high) / 2


def poisson_interval(counts):
    """The 95 % interval of the mean of each Poisson count: exact up to 30, from there Wilson and Hilferty's."""
    n = np.asarray(counts, float)
    many = np.maximum(n, 30)
    low = many * (1 - 1 / (9 * many) - 1.96 / (3 * np.sqrt(many))) ** 3
    high = (many + 1) * (1 - 1 / (9 * (many + 1)) + 1.96 / (3 * np.sqrt(many + 1))) ** 3
    for i in np.flatnonzero(n < 30):
        count = int(n[i])
        low[i] = poisson_mean_where(count - 1, 0.975) if count else 0
        high[i] = poisson_mean_where(count, 0.025)
    return low, high


@dataclass(frozen=True)
class Sample:
    """The objects of one pattern whose centres are on the site, and the area where one of a size can lie."""

    number: int
    pattern: dict
    diameters: np.ndarray  # ascending
    areas_m2: np.ndarray   # for each of them

    def model(self, diameters):
        """Expected number per area of those of at least D, up to the pattern's greatest diameter."""
        return density(self.pattern, diameters) - density(self.pattern, [self.pattern["max_diameter_m"]])[0]

    def measured(self, diameters):
        """(count, number per area) of the objects larger than each diameter."""
        weights = np.concatenate([np.cumsum((1 / self.areas_m2)[::-1])[::-1], [0.0]])
        first = np.searchsorted(self.diameters, diameters, side="right")
        return self.diameters.size - first, weights[first]


def in_region(region, x, y):
    dx, dy = x - region.get("x_m", 0), y - region.get("y_m", 0)
    if region["type"] == "rectangle":
        return (np.abs(dx) <= region["width_m"] / 2) & (np.abs(dy) <= region["length_m"] / 2)
    if region["type"] == "disc":
        return np.hypot(dx, dy) <= region["radius_m"]
    if region["type"] == "annulus":
        return (np.hypot(dx, dy) >= region["inner_radius_m"]) & (np.hypot(dx, dy) <= region["outer_radius_m"])
    return np.ones(np.shape(x), bool)


def areas_m2(pattern, grid, diameters):
    """The area of the region on the site in which objects of each diameter do not reach into the clear circle."""
    x, y = [a[0] + (a[-1] - a[0]) * (np.arange(SITE_SAMPLES) + 0.5) / SITE_SAMPLES for a in (grid.x, grid.y)]
    x, y = np.meshgrid(x, y)
    cell_m2 = (grid.x[-1] - grid.x[0]) * (grid.y[-1] - grid.y[0]) / SITE_SAMPLES ** 2
    distances = np.sort(np.hypot(x, y)[in_region(pattern["region"], x, y)])
    if pattern["clear_radius_m"] == 0:
        return np.full(diameters.shape, distances.size * cell_m2)
    nearest = pattern["clear_radius_m"] + REACH[pattern["type"]] * diameters
    return cell_m2 * np.maximum(distances.size - np.searchsorted(distances, nearest), 1)


def read_samples(file):
    """A Sample for each population of a terrain file, in the order of the patterns."""
    grid = files.read_grid(file)
    if grid is None or "features" not in file:
        raise DataError(f"{file.filename}: has no grid with a list of /features")
    try:
        config = json.loads(file["provenance/config_json"][()])
        x, y, diameter, pattern = (files.numbers(file, f"features/{name}")[()] for name in ("x", "y", "diameter", "pattern"))
    except (KeyError, ValueError) as error:
        raise DataError(f"{file.filename}: {error}") from error
    on_site = (x >= grid.x[0]) & (x <= grid.x[-1]) & (y >= grid.y[0]) & (y <= grid.y[-1])
    samples = []
    for number, keys in enumerate(config.get("patterns", [])):
        if keys["type"] in REACH:
            own = np.sort(diameter[on_site & (pattern == number)])
            samples.append(Sample(number, keys, own, areas_m2(keys, grid, own)))
    if not samples:
        raise DataError(f"{file.filename}: has no pattern that scatters objects")
    return samples


# Drawing


def parse(arguments):
    parser = command.Parser(description=__doc__)
    parser.add_argument("terrain", metavar="TERRAIN", help="terrain.h5 of terrain-gen")
    parser.add_argument("-o", "--output", metavar="PNG", required=True)
    plot_command.add_output_options(parser)
    options = parser.parse_args(arguments)
    options.sources = [options.terrain]
    plot_command.require_png(options.output)
    return options


def title_of(sample):
    """Pattern number, type, and the keys that identify its law."""
    keys = sample.pattern
    law = keys.get("model") or f"k = {golombek_k(keys):.3g}"
    if law in ("custom", "production"):
        law += f", {keys['coefficient']:g} D^-{keys['exponent']:g}"
    return f"{sample.number}: {keys['type']}, {law} ({captions.counted(sample.diameters.size, 'object')})"


def draw_sample(ax, sample, style):
    colour, marker = style
    low, high = sample.pattern["min_diameter_m"], sample.pattern["max_diameter_m"]
    curve = np.geomspace(low, high * 0.999, 300)
    ax.plot(curve, sample.model(curve), color=colour, linewidth=1.2, label=title_of(sample))
    steps = max(int(STEPS_PER_DECADE * np.log10(high / low)), 2)
    diameters = low * (high / low) ** (np.arange(steps) / steps)
    counts, densities = sample.measured(diameters)
    seen = counts > 0
    diameters, counts, densities = diameters[seen], counts[seen], densities[seen]
    bounds = [densities * bound / counts for bound in poisson_interval(counts)]
    ax.errorbar(diameters, densities, [densities - bounds[0], bounds[1] - densities], fmt=marker, color=colour,
                markersize=4, elinewidth=1, capsize=2, markerfacecolor="white")
    return densities


def limit_axes(ax, samples, densities):
    """Limits the axis to values near the measured ones, because a law falls to 0 at its largest diameter."""
    minimum = min([d.min() for d in densities if d.size] + [s.model([s.pattern["min_diameter_m"]])[0] for s in samples])
    ax.set(xscale="log", yscale="log")
    ax.set_ylim(bottom=minimum / 30)


def figure_of(options):
    with files.open_landfall(options.terrain, "landfall.terrain") as file:
        samples = read_samples(file)
    figure, ax = plt.subplots(figsize=(8, 6), layout="constrained")
    styles = [(COLOURS[i % len(COLOURS)], MARKERS[i % len(MARKERS)]) for i in range(len(samples))]
    densities = [draw_sample(ax, sample, style) for sample, style in zip(samples, styles)]
    limit_axes(ax, samples, densities)
    ax.set(xlabel="diameter D, m", ylabel="larger than D, per m²")
    ax.secondary_yaxis("right", functions=(lambda n: 1e4 * n, lambda n: 1e-4 * n)).set_ylabel("per hectare")
    ax.grid(True, which="major", color="0.85", linewidth=0.8)
    ax.xaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
    ax.xaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    ax.legend(fontsize=9, title="lines: law; marks: terrain, 95 % Poisson intervals", title_fontsize=9, loc="upper right")
    ax.set_title(printable(f"Sizes of the objects of {options.terrain.rsplit('/', 1)[-1]}"), parse_math=False)
    return figure


main = plot_command.main_of(parse, figure_of)
