# SPDX-License-Identifier: GPL-3.0-or-later
# Metrics are ordered by the largest share of a limit that any case uses. A metric that counts violations has the share
# of the errors that it counts: its own limit is 0.
"""The tables of landfall plot study: which requirements each point of a study meets, and how much of their limits it uses."""
import math
import textwrap

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

from landfall.study import figures
from landfall.study.names import number
from landfall.study.table import is_probability, PASSED, REQUIREMENTS

MAX_ROWS = 60
REQUIREMENT_NAMES = {**{name: "\n".join(name.split("_")) for name in REQUIREMENTS}, "all": "all"}
HAZARD_NAMES = {"score.missed_hazard_frac": "missed\nhazards", "score.false_alarm_frac": "false\nalarms", "score.true_hazard_frac": "true\nhazards",
                "score.judged_hazard_frac": "hazards\non the map", "score.unknown_frac": "unknown\nplaces",
                "site.p_touchdown": "touchdown\non site 1"}
DRAWS_NAMES = {**REQUIREMENT_NAMES, "hazard.chosen_place_safe": "chosen place\nsafe", "landing.safe": "safe\nlanding",
                  "landing.blind": "landing\nblind"}
BAR_COLOR = "#9DC3E6"


def requirements_figure(results):
    """Pass rates."""
    note = "requirements met" if results.repeats() == 1 else \
        "share of repeats that meet each requirement, 95 % interval (Wilson)"
    return table_figure(results, [*results.requirements(), "all"], note,
                        lambda axes, row, column, point, name: draw_rate(axes, row, column, *results.pass_rate(point, name)))


def shares_figure(results, quantile):
    """How much of each limit is used; of an error budget, each term's share."""
    repeats = results.repeats()
    note = "share of each requirement's limit that is used" + (f", {figures.estimate_name(results, quantile).split(',')[0]}" if repeats > 1 else "")
    return table_figure(results, results.requirements(), note, lambda axes, row, column, point, name: draw_share(
        axes, row, column, results.share_of_limit(point, name, quantile)))


def draws_figure(results):
    """How many draws of each point's run meet each requirement; None for a study without runs of draws."""
    names = [column.removeprefix("draws.").removesuffix(PASSED) for column in results.columns if is_probability(column)]
    if not names:
        return None
    interval = ", 95 % interval (Wilson)" if "draws.all.wilson_low" in results.columns else ""
    return table_figure(results, names, f"draws that meet each requirement{interval}", lambda axes, row, column, point, name: draw_shares_of_draws(
        axes, row, column, results.values(point, f"draws.{name}{PASSED}"), results.draws_rate(point, name)))


def hazards_figure(results, quantile):
    """The score and the best site of each point; None for a study without hazard maps."""
    names = [name for name in HAZARD_NAMES if name in results.columns]
    if not any(name.startswith("score.") for name in names):
        return None
    largest = {name: figures.largest_value(results, name) for name in names}
    note = "shares: missed of the true hazards, false alarms of the truly safe places, unknown of the region;\n" \
        "hazards of the known places; touchdown: probability; bars: relative to the largest of the column"
    if results.repeats() > 1:
        note += f"; {figures.estimate_name(results, quantile).split(',', maxsplit=1)[0]}"
    return table_figure(results, names, note, lambda axes, row, column, point, name: draw_value(
        axes, row, column, results.estimate(point, name, quantile)[0], largest[name]))


def table_figure(results, names, note, draw_cell):
    """A row for each point, a column for each requirement."""
    points = results.points if len(results.points) <= MAX_ROWS else figures.spread(results.points, MAX_ROWS)
    labels = [figures.point_name(results.axes, point.values) or "all cases" for point in points]
    left = 0.4 + 0.075 * max(len(label) for label in labels)
    height = 1.3 + 0.36 * len(points)
    figure, axes = plt.subplots(figsize=(left + max(7.6, 1.08 * len(names)), height), constrained_layout=True)
    for row, point in enumerate(points):
        for column, name in enumerate(names):
            draw_cell(axes, row, column, point, name)
    axes.set(xlim=(-0.5, len(names) - 0.5), ylim=(len(points) - 0.5, -0.5))
    known = {**DRAWS_NAMES, **HAZARD_NAMES}  # those of the user's own requirements are their names on short lines
    axes.set_xticks(range(len(names)), [known.get(name) or textwrap.fill(name.replace("_", " "), 12) for name in names], fontsize=9)
    axes.set_yticks(range(len(points)), labels, fontsize=8)
    axes.tick_params(length=0, labeltop=True, labelbottom=False)
    for side in axes.spines.values():
        side.set_visible(False)
    if len(points) < len(results.points):
        note += f"; {len(points)} of {len(results.points)} points"
    axes.set_title(f"{results.title}\n{note}", fontsize=10)
    return figure


def draw_rate(axes, row, column, passed, count, low, high):
    if count == 0:
        color, text = "0.9", "not judged"
    elif count == 1:
        color, text = rate_color(passed), "✓ pass" if passed else "✗ fail"
    else:
        color, text = rate_color(passed / count), f"{passed}/{count}  [{100 * low:.0f}, {100 * high:.0f}] %"
    draw_cell_of(axes, row, column, color, 1, text)


def draw_shares_of_draws(axes, row, column, shares, rate):
    """The smallest and the largest share of several terrains at one point."""
    if len(set(shares)) > 1:
        draw_cell_of(axes, row, column, rate_color(np.median(shares)), 1, f"{number(100 * min(shares))} to {number(100 * max(shares))} %")
    elif len(shares) and math.isnan(rate[2]):
        draw_cell_of(axes, row, column, rate_color(shares[0]), 1, f"{rate[0]:.0f}/{rate[1]:.0f}")
    else:
        draw_rate(axes, row, column, *(map(int, rate[:2]) if len(shares) else (0, 0)), *rate[2:])


def draw_share(axes, row, column, share):
    """A bar as long as the share, of another colour where it is over the limit."""
    if math.isnan(share):
        draw_cell_of(axes, row, column, "0.9", 1, "not known")
        return
    draw_cell_of(axes, row, column, "0.94", 1, "")
    text = f"{share:,.0f} times" if share >= 9.95 else f"{100 * share:.0f} %" if share >= 0.095 or share == 0 else f"{100 * share:.1g} %"
    draw_cell_of(axes, row, column, rate_color(share <= 1), min(share, 1), text)


def draw_value(axes, row, column, value, largest):
    """A share in per cent, with a bar as long as its share of the largest."""
    draw_cell_of(axes, row, column, "0.94", 1, "not known" if math.isnan(value) else "")
    if not math.isnan(value):
        draw_cell_of(axes, row, column, BAR_COLOR, value / largest if largest else 0, f"{number(100 * value)} %")


def draw_cell_of(axes, row, column, color, width, text):
    axes.add_patch(matplotlib.patches.Rectangle((column - 0.48, row - 0.44), 0.96 * width, 0.88, color=color, linewidth=0))
    axes.text(column, row, text, ha="center", va="center", fontsize=7.5)


def rate_color(rate):
    """From orange (never) over grey to blue (always), light enough for black text."""
    low, middle, high = (np.array(matplotlib.colors.to_rgb(color)) for color in ("#F4B183", "#F2F2F2", "#9DC3E6"))
    return tuple(low + (middle - low) * 2 * rate) if rate < 0.5 else tuple(middle + (high - middle) * (2 * rate - 1))
