#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws how many rocks, ice blocks and craters of which size a terrain has, against the laws they were drawn from."""
import landfall_plots as lp
import landfall_populations as populations
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # pylint: disable=wrong-import-position,wrong-import-order

STEPS_PER_DECADE = 12
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"]  # Okabe and Ito's, for all eyes
MARKERS = "osD^v<"


def parse(arguments):
    parser = lp.Parser(prog="plot_populations.py", description=__doc__)
    parser.add_argument("terrain", metavar="TERRAIN", help="terrain.h5 of terrain-gen")
    parser.add_argument("-o", "--output", metavar="PNG", required=True)
    lp.add_output_options(parser)
    options = parser.parse_args(arguments)
    lp.require_png(options.output)
    return options


def title_of(sample):
    """Pattern number, type, and the keys that say which law it is."""
    keys = sample.pattern
    law = keys.get("model") or f"k = {populations.golombek_k(keys):.3g}"
    if law in ("custom", "production"):
        law += f", {keys['coefficient']:g} D^-{keys['exponent']:g}"
    return f"{sample.number}: {keys['type']}, {law} ({lp.counted(sample.diameters.size, 'object')})"


def diameters_of(pattern):
    low, high = pattern["min_diameter_m"], pattern["max_diameter_m"]
    steps = max(int(STEPS_PER_DECADE * np.log10(high / low)), 2)
    return low * (high / low) ** (np.arange(steps) / steps)


def draw_sample(ax, sample, style):
    colour, marker = style
    low, high = sample.pattern["min_diameter_m"], sample.pattern["max_diameter_m"]
    curve = np.geomspace(low, high * 0.999, 300)
    ax.plot(curve, sample.model(curve), color=colour, linewidth=1.2, label=title_of(sample))
    diameters = diameters_of(sample.pattern)
    counts, densities = sample.measured(diameters)
    seen = counts > 0
    diameters, counts, densities = diameters[seen], counts[seen], densities[seen]
    bounds = [densities * bound / counts for bound in populations.poisson_interval(counts)]
    ax.errorbar(diameters, densities, [densities - bounds[0], bounds[1] - densities], fmt=marker, color=colour,
                markersize=4, elinewidth=1, capsize=2, markerfacecolor="white")
    return densities


def limit_axes(ax, samples, densities):
    """From a little below the least that was measured: a law cut at its greatest diameter falls to 0 there."""
    ax.set_xscale("log")
    ax.set_yscale("log")
    least = min([d.min() for d in densities if d.size] + [s.model([s.pattern["min_diameter_m"]])[0] for s in samples])
    ax.set_ylim(bottom=least / 30)


def draw(samples, name):
    figure, ax = plt.subplots(figsize=(8, 6), layout="constrained")
    styles = [(COLOURS[i % len(COLOURS)], MARKERS[i % len(MARKERS)]) for i in range(len(samples))]
    densities = [draw_sample(ax, sample, style) for sample, style in zip(samples, styles)]
    limit_axes(ax, samples, densities)
    ax.set_xlabel("diameter D, m")
    ax.set_ylabel("larger than D, per m²")
    ax.secondary_yaxis("right", functions=(lambda n: 1e4 * n, lambda n: 1e-4 * n)).set_ylabel("per hectare")
    ax.grid(True, which="major", color="0.85", linewidth=0.8)
    ax.xaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
    ax.xaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    ax.legend(fontsize=9, title="lines: law; marks: terrain, 95 % Poisson intervals", title_fontsize=9, loc="upper right")
    ax.set_title(f"Sizes of the objects of {name}")
    return figure


def main(arguments):
    options = parse(arguments)
    lp.check_outputs([options.output], options.overwrite)
    with lp.open_landfall(options.terrain, "landfall.terrain") as file:
        samples = populations.read_samples(file)
    lp.save({options.output: draw(samples, options.terrain.rsplit("/", 1)[-1])}, options.dpi)


if __name__ == "__main__":
    lp.run(main)
