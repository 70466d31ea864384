# SPDX-License-Identifier: GPL-3.0-or-later
"""The overview of plot_study.py: a study's metrics side by side against one axis."""
import textwrap

import landfall_study_figures as figures
import matplotlib.pyplot as plt  # after landfall_study_figures, which chooses the backend

MOST_PANELS = 6
# Letters of a line of a panel's label.
WIDEST_LABEL = 36


def overview_figure(results, metrics, x, quantile):
    """A panel for each of the first six metrics; None of fewer than two, and where x is no number, whose names need the width."""
    shown = metrics[:MOST_PANELS]
    if x is None or not x.numeric or len(shown) < 2:
        return None
    rows = (len(shown) + 1) // 2
    figure, panels = plt.subplots(rows, 2, figsize=(10.4, 0.5 + 3.1 * rows), constrained_layout=True, squeeze=False)
    for index, (axes, metric) in enumerate(zip(panels.flat, shown)):
        draw_panel(axes, results, metric, x, quantile, with_series=index == 0)
    for axes in panels.flat[len(shown):]:
        axes.set_visible(False)
    note = figures.estimate_name(results, quantile)
    figure.suptitle(results.title + (f"\n{note}" if note else ""), fontsize=11)
    return figure


def draw_panel(axes, results, metric, x, quantile, with_series):
    """One metric. The legend names the series in one panel only, the requirement in each that has one."""
    figures.draw_series(axes, results, metric, figures.Scale(results, metric), x, quantile)
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
